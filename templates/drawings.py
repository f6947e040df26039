"""Drawings of a plan for Graphviz, which does the layout: `drawings.py graph` or `drawings.py lifetimes` reads the JSON that
gen/print/emit_plan.c writes, and prints the drawing. `diptych-gen --graph` and `--lifetimes` call it.

The graph has a box for each pass, in order of execution: its barriers, its dispatch or draw, the resources that it writes, and
their readers. Arrows lead from a pass to the passes that use its results. The lifetimes are one table: a column for each pass, a row
for each resource, filled during its lifetime; rows grouped by slot of memory. Below it: the barriers between resources that share
memory."""
import html
import io
import json
import sys
from collections.abc import Iterable

# Fill colours that differ in grey print, too; those of lifetimes are darker, for contrast with white.
IMAGE, BUFFER = "#d9e6f4", "#fbf4dc"
ALIVE_IMAGE, ALIVE_BUFFER, ALIVE_HISTORY = "#9db8d6", "#e3cf8e", "#b8b8b8"
TABLE = 'border="0" cellborder="1" cellspacing="0" cellpadding="0"'
BREAK = '<br align="left"/>'
# How often each invisible arrow that keeps the order of execution is repeated. Graphviz minimizes crossings, so many of them
# push the visible arrows to the side, away from between the boxes.
REPEATS = 20
# Words for the bits of enum dt_stage and enum dt_access; an entry of several bits comes before those of one.
STAGES = {1: "compute", 2: "vertex", 4: "fragment", 8: "colour", 16: "depth", 128: "clear"}
ACCESSES = {3: "storage read and write", 1: "storage read", 2: "storage write", 4: "texture read", 8: "uniform read",
            48: "colour attachment", 32: "colour attachment", 192: "depth attachment", 128: "depth attachment",
            256: "indirect arguments", 512: "index buffer", 1024: "clear"}
SHADER_STAGES, SHADER_ACCESSES = 7, 15

# ---- Words ----


def size_of(count: int) -> str:
    for unit, name in ((1 << 20, "MiB"), (1 << 10, "KiB")):
        if count >= unit:
            return f"{count / unit:.1f} {name}"
    return f"{count} B"


def extent(resource: dict) -> str:
    """rgba16f 256×256×8, Vpl[256]"""
    if not resource["image"]:
        return f"{resource['type']}[{resource['size'][0]}]"
    mips = f", {resource['mips']} mips" if resource["mips"] > 1 else ""
    return f"{resource['type']} {'×'.join(map(str, resource['size']))}{mips}"


def words(names: dict[int, str], mask: int) -> list[str]:
    found = []
    for bits, name in names.items():
        if mask & bits == bits:
            found.append(name)
            mask &= ~bits
    return found


def accesses(kinds: int, stages: int) -> str:
    text = ""
    if not kinds or kinds & SHADER_ACCESSES:
        text = "/".join(words(STAGES, stages & SHADER_STAGES if kinds else stages)) + (" " if kinds else " change of layout")
    return text + ", ".join(words(ACCESSES, kinds))


def waiting(barrier: dict) -> str:
    """compute storage write, clear → compute storage read"""
    return f"{accesses(*barrier['from'])} → {accesses(*barrier['to'])}{'' if barrier['writes'] else ' (execution only)'}"


def begin(plan: dict) -> None:
    print(f'digraph "{plan["name"]}" {{\n'
          '  graph [charset="UTF-8", fontname="Helvetica", labeljust=l, nodesep=0.07,\n'
          "         ranksep=0.1, fontsize=7];\n"
          '  node [shape=plain, fontname="Helvetica", fontsize=7];\n'
          "  edge [arrowsize=0.5];")


# ---- The graph ----


def node(kind: str, step: dict) -> str:
    return f"{kind}_{step['name'].replace('.', '_')}"


def condition(step: dict) -> str:
    return html.escape(step["when"], quote=False)


class Graph:
    def __init__(self, plan: dict):
        self.plan, self.passes, self.resources = plan, plan["passes"], plan["resources"]

    def find_writer(self, resource: int, place: int) -> int | None:
        """Place of the pass that last wrote any mip of the resource before the pass at `place` uses it. A result after `place`: in
        the previous frame. None: unused, or first written here."""
        reads = resource in self.passes[place]["reads"]
        if not reads and resource not in self.passes[place]["writes"]:
            return None
        for other in (*range(place - 1, -1, -1), *range(len(self.passes) - 1, place, -1)):
            if resource in self.passes[other]["writes"]:
                return other if other < place or (self.resources[resource]["history"] and reads) else None
        return None

    @staticmethod
    def bars(step: dict) -> dict[str, list[int]]:
        """Resources that the pass waits for, by the accesses; not an image's first touch in a frame, which only changes the layout,
        nor the barriers between resources that share memory."""
        found: dict[str, list[int]] = {}
        for barrier in step["barriers"]:
            if barrier["from"][1] and barrier["alias"] < 0:
                found.setdefault(json.dumps([barrier["from"], barrier["to"], barrier["writes"]]), []).append(barrier["resource"])
        return found

    def print_bar(self, accesses_of: str, waited: list[int]) -> None:
        (source, target, writes), text = json.loads(accesses_of), ""
        for i, resource in enumerate(waited):
            text += (", " if i % 3 else f",{BREAK}&nbsp;" if i else "") + self.resources[resource]["name"]
        print('<tr><td colspan="2" align="left" border="1" color="white" bgcolor="#484848"><font color="white">&nbsp;'
              f"{text}: {waiting({'from': source, 'to': target, 'writes': writes})}</font></td></tr>")

    @staticmethod
    def work(step: dict) -> str:
        def product(size: list[int]) -> str:
            return "×".join(map(str, size[:3 if size[2] > 1 else 2 if size[1] > 1 else 1]))
        if step["kind"] == "dispatch":
            if step["indirect"]:
                return f"dispatch by arguments, workgroups of {product(step['local'])}"
            one = step["groups"] == [1, 1, 1]
            return f"dispatch {product(step['groups'])} workgroup{'' if one else 's'} of {product(step['local'])}"
        scene, layers = step["kind"] == "scene", step["layers"]
        text = {"scene": "draw of the scene", "fullscreen": "draw, fullscreen"}.get(step["kind"], f"draw of {step['topology']}")
        if scene and step["view"] and not layers:
            text += f" from the {step['view']}"
        if layers:
            text += f", {layers} {'instances' if scene else 'layers'}"
        return text + (" by arguments" if step["indirect"] else "")

    def print_written(self, place: int, index: int) -> None:
        resource, plan = self.resources[index], self.plan
        cell = f'bgcolor="{IMAGE if resource["image"] else BUFFER}">&nbsp;'
        notes = [note for note, holds in (
            ("updated", index in self.passes[place]["reads"]), ("input", resource["input"]),
            ("history", resource["history"] and not resource["input"]), ("linear output", plan["linear"] == resource["name"]),
            ("display output", plan["display"] == resource["name"])) if holds]
        readers = [str(i + 1) for i, step in enumerate(self.passes)
                   if index in step["reads"] and self.find_writer(index, i) == place]
        print(f'<tr><td width="125" align="left" {cell}{resource["name"]}{"".join(f" <i>{note}</i>" for note in notes)}</td>'
              f'<td width="82" align="left" {cell}{extent(resource)}</td>'
              f'<td width="38" align="right" {cell}{size_of(resource["bytes"])}&nbsp;</td>'
              f'<td width="80" align="left" {cell}{"→ " if readers else ""}{", ".join(readers)}</td></tr>')

    def print_pass(self, place: int) -> None:
        step = self.passes[place]
        bars = self.bars(step)
        print(f'  {node("p", step)} [label=<<table {TABLE}><tr><td width="370" style="{"dashed" if step["when"] is not None else "solid"}">'
              '<table border="0" cellborder="0" cellspacing="0" cellpadding="0">')
        for accesses_of, waited in bars.items():
            self.print_bar(accesses_of, waited)
        when = ""
        if step["when"] is not None:
            when = f"&nbsp;&nbsp;{'' if step['runs'] else 'SKIPPED by default: '}when {condition(step)}"
        print(f'<tr><td colspan="2" align="left" height="13"><font point-size="9"><b>&nbsp;{place + 1}&nbsp;&nbsp;{step["name"]}</b></font>'
              f"{when}</td></tr>\n<tr><td align=\"left\">&nbsp;{self.work(step)}</td><td></td></tr>")
        waited_for = {resource for waited in bars.values() for resource in waited}
        free = [self.resources[i]["name"] for i in step["reads"] if i not in step["writes"] and i not in waited_for]
        if step["scene"] or free:
            print(f'<tr><td colspan="2" align="left">&nbsp;reads {", ".join(step["scene"] + free)}</td></tr>')
        print("</table></td>", end="")
        if step["writes"]:
            print(f'<td border="0"><table {TABLE}>')
            for index in step["writes"]:
                self.print_written(place, index)
            print("</table></td>", end="")
        print("</tr></table>>];")

    def print_caption(self) -> None:
        plan = self.plan
        unused = [resource["name"] for resource in self.resources if resource["first"] < 0]
        print(f'  labelloc=t;\n  label=<<font point-size="9"><b>{plan["name"]}</b> at {"x".join(map(str, plan["frame"]))}: '
              f"{len(self.passes)} passes in order of execution, {len(self.resources)} resources; "
              f"{size_of(plan['transients'])} of transients in {size_of(plan['aliased'])}</font>{BREAK}"
              "Left: a pass; dashed: runs only when its condition holds. "
              f"Right: what it writes, and which passes read that; blue: images, yellow: buffers.{BREAK}"
              "Arrow: from the pass that wrote last to one that reads; heavy: to one that writes again; dashed: to the next frame."
              f"{BREAK}Dark bar: Vulkan's barrier, earlier accesses → those that wait; "
              f"what is read without one waits for nothing new. GL: bits of glMemoryBarrier.{BREAK}"
              f"{'Unused here: ' + ', '.join(unused) + BREAK if unused else ''}>;")

    def print_dropped(self, dropped: list[dict], line: float) -> Iterable[str]:
        """Draws dropped passes before the next executed pass that stands behind them in the spec; gives their nodes."""
        while dropped and dropped[0]["line"] <= line:
            step = dropped.pop(0)
            print(f'  {node("d", step)} [shape=box, style=dashed, color="#909090", fontcolor="#505050", height=0.1, '
                  f'margin="0.05,0.04", label=<<b>{step["name"]}</b>&nbsp; left out: when {condition(step)}>];')
            yield node("d", step)

    def print_arrow(self, tail: int, head: int) -> None:
        """One arrow for all resources that one pass wrote and the other uses. It is drawn downwards even to the next frame; then its
        head is at the upper end."""
        used = [i for i in range(len(self.resources)) if self.find_writer(i, head) == tail]
        if used:
            heavy = any(i in self.passes[head]["writes"] for i in used)
            upper, lower = (node("p", self.passes[i]) for i in sorted((tail, head)))
            print(f"  {upper} -> {lower} [penwidth={'1.4' if heavy else '0.7'}{'' if tail < head else ', style=dashed, dir=back'}];")

    def print(self) -> None:
        column: list[str] = []
        dropped = list(self.plan["dropped"])
        begin(self.plan)
        self.print_caption()
        for place, step in enumerate(self.passes):
            column += self.print_dropped(dropped, step["line"])
            self.print_pass(place)
            column.append(node("p", step))
        column += self.print_dropped(dropped, float("inf"))
        print("  edge [style=invis, weight=100];")
        for _ in range(REPEATS):
            print(f"  {' -> '.join(column)};")
        print("  edge [style=solid, weight=1];")
        for tail in range(len(self.passes)):
            for head in range(len(self.passes)):
                self.print_arrow(tail, head)
        print("}")


# ---- Lifetimes ----


def lives(resource: dict, place: int) -> bool:
    return resource["first"] >= 0 and resource["first"] <= place <= resource["last"]


def lifetime_row(plan: dict, index: int) -> str:
    resource, steps = plan["resources"][index], plan["passes"]
    fill = ALIVE_HISTORY if resource["history"] else ALIVE_IMAGE if resource["image"] else ALIVE_BUFFER
    unused = " <i>(unused)</i>" if resource["first"] < 0 else ""
    text = (f'<td border="0" align="left" height="13">&nbsp;{resource["name"]}{unused}</td><td border="0" align="left">&nbsp;'
            f'{extent(resource)}&nbsp;</td><td border="0" align="right">{size_of(resource["bytes"])}&nbsp;</td>')
    for place, step in enumerate(steps):
        if not lives(resource, place):
            text += '<td border="0"></td>'
            continue
        left = "L" if not place or not lives(resource, place - 1) else ""
        right = "R" if place + 1 == len(steps) or not lives(resource, place + 1) else ""
        letter = {(True, True): "u", (True, False): "r", (False, True): "w"}.get((index in step["reads"], index in step["writes"]), "")
        text += f'<td bgcolor="{fill}" sides="TB{left}{right}">{letter}</td>'
    return text + "</tr>"


def print_slots(plan: dict) -> None:
    resources, count = plan["resources"], len(plan["passes"])
    for slot in range(1 + max((resource["slot"] for resource in resources), default=-1)):
        rows = sorted((i for i, resource in enumerate(resources) if resource["slot"] == slot), key=lambda i: resources[i]["first"])
        if not rows:
            continue
        largest = max((resources[i] for i in sorted(rows)), key=lambda resource: resource["bytes"])
        print(f'<hr/><tr><td border="0" rowspan="{len(rows)}" align="left"><b>{size_of(largest["bytes"])}</b>'
              f"{' history' if largest['history'] else ''}&nbsp;</td>", end="")
        print("\n<tr>".join(lifetime_row(plan, i) for i in rows))
    print('<hr/><tr><td border="0" colspan="4" align="right" height="13">transients alive, MiB&nbsp;</td>', end="")
    for place in range(count):
        alive = sum(resource["bytes"] for resource in resources if lives(resource, place) and not resource["history"])
        print(f'<td border="0">{alive / (1 << 20):.0f}</td>', end="")
    print("</tr>\n</table>>];")


def lifetimes_title(plan: dict) -> str:
    resources, whole = plan["resources"], plan["transients"]
    saved = whole - plan["aliased"]
    kept = sum(resource["bytes"] for resource in resources if resource["history"])
    unused = sum(resource["bytes"] for resource in resources if resource["first"] < 0)
    return (f'<font point-size="9"><b>{plan["name"]}</b> at {"x".join(map(str, plan["frame"]))}: transients of {size_of(whole)}'
            f"{f', {size_of(unused)} of them unused,' if unused else ''} in {size_of(plan['aliased'])} of memory; {size_of(saved)}"
            f" ({100 * saved / whole if whole else 0:.0f} %) saved"
            f"{f'; kept from frame to frame: {size_of(kept)}' if kept else ''}</font>{BREAK}")


def print_lifetimes(plan: dict) -> None:
    resources, steps = plan["resources"], plan["passes"]
    begin(plan)
    print(f'  lifetimes [label=<<table {TABLE}>\n<tr><td border="0" align="left"><b>memory</b></td>'
          '<td border="0" colspan="3" align="right">pass&nbsp;</td>', end="")
    print("".join(f'<td border="0" width="20"><b>{place + 1}</b></td>' for place in range(len(steps))) + "</tr>")
    print_slots(plan)
    names = "".join(f"{', ' if place % 8 else f',{BREAK}' if place else ''}<b>{place + 1}</b> {step['name']}"
                    for place, step in enumerate(steps))
    shares = "".join(f"{resource['name']} in that of {resources[resource['share']]['name']}{BREAK}"
                     for resource in resources if resource["share"] >= 0)
    handovers = "".join(
        f"<b>{place + 1}</b> {resources[barrier['resource']]['name']} after {resources[barrier['alias']]['name']}: "
        f"{waiting(barrier)}{BREAK}" for place, step in enumerate(steps) for barrier in step["barriers"] if barrier["alias"] >= 0)
    print(f'  label=<<font point-size="7">{lifetimes_title(plan)}{names}{BREAK}Filled: alive (blue: images, yellow: buffers, grey: '
          f"history); w: written, r: read, u: updated. Outputs live to the end of the frame.{BREAK}"
          f"{f'OpenGL{chr(39)}s textures that images share:{BREAK}{shares}' if shares else ''}"
          f"{f'Vulkan{chr(39)}s barriers where memory changes hands:{BREAK}{handovers}' if handovers else ''}</font>>;\n}}")


def main() -> None:
    sys.stdout = io.TextIOWrapper(sys.stdout.buffer, encoding="utf-8")
    plan = json.load(sys.stdin.buffer)
    if sys.argv[1] == "graph":
        Graph(plan).print()
    else:
        print_lifetimes(plan)


main()
