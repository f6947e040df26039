"""Checks for tests/graph_test.sh: `graph.py SPEC GRAPH.dot PLAIN LIFETIMES.dot` holds both drawings against the spec itself,
read with another YAML library: who reads and writes what, and when. PLAIN is what `dot -Tplain` made of the first."""
import html
import re
import sys

import yaml


def fail(text):
    sys.exit(f"graph.py: {text}")


def names(accesses):
    return {access if isinstance(access, str) else access["name"] for access in accesses or []}


def uses(spec):
    """(pass, resource) -> set of r and w, as the spec has them; what the scene has is not drawn with lines."""
    found = {}
    for step in spec["passes"]:
        reads = names(step.get("reads")) | names(step.get("updates"))
        reads |= {step[key] for key in ("indirect", "indices") if key in step}
        for name in reads:
            if not name.startswith("scene_"):
                found.setdefault((step["name"], name), set()).add("r")
        for name in names(step.get("writes")) | names(step.get("updates")):
            found.setdefault((step["name"], name), set()).add("w")
    return found


def boxes(plain):
    """name -> (left, bottom, right, top) in points."""
    found = {}
    for line in plain.splitlines():
        node = re.match(r'node ([pdw]_\w+) (\S+) (\S+) (\S+) (\S+) ', line)
        if node:
            x, y, width, height = (72 * float(number) for number in node.groups()[1:])
            found[node.group(1)] = (x - width / 2, y - height / 2, x + width / 2, y + height / 2)
    return found


def check_boxes(spec, found):
    for step in spec["passes"]:
        if ("p_" + step["name"] in found) == ("d_" + step["name"] in found) and "when" not in step:
            fail(f"pass {step['name']} is not drawn once")
    placed = sorted(found.items())
    for i, (a, (left, bottom, right, top)) in enumerate(placed):
        for b, other in placed[i + 1:]:
            if left < other[2] - 1 and other[0] < right - 1 and bottom < other[3] - 1 and other[1] < top - 1:
                fail(f"{a} and {b} overlap")
    column = [box for name, box in found.items() if name.startswith("p_")]
    if max(box[0] for box in column) - min(box[0] for box in column) > 8:
        fail("the passes are no column: some text is wider than was planned")


def check_lines(dot, drawn, known):
    """Every read is a line; a first write is the table's place, a later one is a line as well."""
    lines = set()
    for line in dot.splitlines():
        found = re.match(r"  //((?: \w+)+?)((?: (?:->|<-) \w+)*)$", line)
        if found:
            for arrow, step in re.findall(r"(->|<-) (\w+)", found.group(2)):
                lines |= {(step, name) for name in found.group(1).split()}
    tables = {}
    for step, label in re.findall(r'"w_(\w+)" \[.*?label=<(.*)>\];', dot):
        for name in re.findall(r"&nbsp;(\w+)(?:<font[^>]*><i>[^<]*</i></font>)?</td>", label):
            tables[name] = step
    for (step, name), kinds in known.items():
        if step not in drawn:
            continue
        if tables.get(name) != step and (step, name) not in lines:
            fail(f"{step} {kinds} {name}: no line")
    for step, name in lines:
        if (step, name) not in known:
            fail(f"a line joins {step} and {name}, which have nothing to do with each other")


def check_lifetimes(text, drawn, known, resources):
    rows = re.findall(r"&nbsp;(\w+)(?: <i>\(unused\)</i>)?</td>(.*?)</tr>", text)
    if sorted(name for name, _ in rows) != sorted(resources):
        fail(f"rows {sorted(name for name, _ in rows)} are not the resources")
    for name, cells in rows:
        cells = [re.sub(r"<[^>]*>", "", cell) for cell in re.findall(r"<td [^>]*>.*?</td>|<td border=\"0\"></td>", cells)]
        letters = cells[-len(drawn):]
        wanted = ["".join(sorted(known.get((step, name), ""))).replace("rw", "u") for step in drawn]
        if letters != wanted:
            fail(f"{name}: {letters}, by the spec {wanted}")


def check_slots(text):
    """What shares memory is never alive in the same pass."""
    for slot in text.split("<hr/>")[1:-1]:
        alive = set()
        for row in re.findall(r"&nbsp;\w+(?: <i>\(unused\)</i>)?</td>(.*?)</tr>", slot):
            cells = re.findall(r"<td (border=\"0\"|bgcolor)[^>]*>[^<]*</td>", row)
            filled = {i for i, cell in enumerate(cells) if cell == "bgcolor"}
            if filled & alive:
                fail(f"two residents of one memory are alive at once: {html.unescape(slot)}")
            alive |= filled


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        spec = yaml.safe_load(file)
    dot, plain, lifetimes = (open(path, encoding="utf-8").read() for path in sys.argv[2:5])
    known = uses(spec)
    found = boxes(plain)
    drawn = re.findall(r'"p_(\w+)" \[', dot)
    check_boxes(spec, found)
    check_lines(dot, set(drawn), known)
    check_lifetimes(lifetimes, drawn, known, [*spec.get("buffers", {}), *spec.get("images", {})])
    check_slots(lifetimes)


main()
