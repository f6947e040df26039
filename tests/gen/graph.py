"""Checks for tests/gen/graph_test.sh: `graph.py SPEC GRAPH.dot PLAIN LIFETIMES.dot` compares both drawings with the spec, read
with another YAML library: the reads, writes, order and waits of all passes. PLAIN is the output of `dot -Tplain` for the first
drawing, with the places of boxes and arrows."""
import html
import itertools
import re
import sys

import flat


def fail(text):
    sys.exit(f"graph.py: {text}")


def names(accesses):
    return {access if isinstance(access, str) else access["name"] for access in accesses or []}


def uses(spec):
    """(pass, resource) -> set of r and w, from the spec; without the scene's resources, which have no lines in the drawing."""
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


def writer(drawn, known, place, name, history):
    """The place of the last writer before `place`: an earlier pass, or for a history that is read, a pass of the last frame."""
    earlier = range(place - 1, -1, -1)
    later = range(len(drawn) - 1, place, -1) if history and "r" in known[drawn[place], name] else ()
    return next((other for other in (*earlier, *later) if "w" in known.get((drawn[other], name), "")), None)


def nodes(dot):
    """name -> label, of passes that run (p_) and of those left out (d_)."""
    return dict(re.findall(r"^  ([pd]_\w+) \[.*?label=<(.*?)>\];$", dot, re.MULTILINE | re.DOTALL))


def listed(text):
    return [name for name in re.findall(r"\w+", re.sub(r"<[^>]*>|&nbsp;", " ", text))]


def check_passes(spec, found):
    """Each pass is drawn once, with its number in order of execution; a pass that is left out has a condition."""
    drawn = [name[2:] for name in found if name.startswith("p_")]
    for step in spec["passes"]:
        if ("p_" + step["name"] in found) == ("d_" + step["name"] in found):
            fail(f"pass {step['name']} is not drawn once")
        if "d_" + step["name"] in found and "when" not in step:
            fail(f"pass {step['name']} is left out without a condition")
    if len(found) != len(spec["passes"]):
        fail(f"{sorted(found)} are not the passes")
    for number, name in enumerate(drawn, 1):
        if f"<b>&nbsp;{number}&nbsp;&nbsp;{name}</b>" not in found["p_" + name]:
            fail(f"pass {name} is not number {number}")
    return drawn


def check_reads(label, step, known):
    """A pass names all resources that it reads, at a bar or without a wait; returns the resources that it waits for."""
    bars = [set(listed(bar.rsplit(":", 1)[0])) for bar in re.findall(r'<font color="white">(.*?)</font>', label)]
    waited = set().union(*bars)
    if len(waited) != sum(map(len, bars)):
        fail(f"{step} waits twice for one resource")
    free = re.search(r"&nbsp;reads (.*?)</td>", label)
    named = waited | {name for name in listed(free.group(1) if free else "") if not name.startswith("scene_")}
    for (user, name), kinds in known.items():
        if user == step and kinds == {"r"} and name not in named:
            fail(f"{step} does not say that it reads {name}")
    for name in named:
        if (step, name) not in known:
            fail(f"{step} names {name}, which it does not use")
    return waited


def check_writes(label, place, drawn, known, histories):
    """One row for each resource that a pass writes, with the numbers of the passes that read the resource."""
    rows = re.findall(r'<tr><td width="\d+" align="left" [^>]*>&nbsp;(\w+)(.*?)</td>.*&nbsp;(?:→ )?([\d, ]*)</td></tr>', label)
    written = {name for (step, name), kinds in known.items() if step == drawn[place] and "w" in kinds}
    if sorted(name for name, _, _ in rows) != sorted(written):
        fail(f"{drawn[place]} writes {sorted(written)}, not {rows}")
    for name, notes, readers in rows:
        wanted = [str(i + 1) for i, step in enumerate(drawn) if "r" in known.get((step, name), "")
                  and writer(drawn, known, i, name, name in histories) == place]
        if re.findall(r"\d+", readers) != wanted:
            fail(f"what {drawn[place]} writes to {name} is read by {wanted}, not {readers}")
        if ("<i>updated</i>" in notes) != ("r" in known[drawn[place], name]) or ("<i>history</i>" in notes) != (name in histories):
            fail(f"{name} in {drawn[place]}: {notes}")


def check_waits(waits, drawn, known):
    """A pass waits for a resource if the last user in the frame wrote it, or if the pass writes a resource used before."""
    for place, step in enumerate(drawn):
        for (user, name), kinds in known.items():
            before = [known[other, name] for other in drawn[:place] if (other, name) in known]
            if user == step and before and ("w" in before[-1] or "w" in kinds) and name not in waits[step]:
                fail(f"{step} does not wait for {name}")


def check_arrows(dot, drawn, known, histories):
    """Arrows go from the writer of a resource to its users, and nowhere else; an arrow is heavy if the user also writes."""
    wanted = {}
    for place, step in enumerate(drawn):
        for (user, name), kinds in known.items():
            source = writer(drawn, known, place, name, name in histories) if user == step else None
            if source is not None:
                wanted[drawn[source], step] = wanted.get((drawn[source], step), set()) | kinds
    arrows = {}
    for tail, head, style in re.findall(r"^  p_(\w+) -> p_(\w+) \[(.*)\];$", dot, re.MULTILINE):
        pair = (head, tail) if "dir=back" in style else (tail, head)
        if ("style=dashed" in style) != (drawn.index(pair[0]) > drawn.index(pair[1])) or pair in arrows:
            fail(f"the arrow {pair} is drawn as {style}")
        arrows[pair] = "penwidth=1.4" in style
    by_spec = {pair: "w" in kinds for pair, kinds in wanted.items()}
    if arrows != by_spec:
        fail(f"arrows that differ from the spec's, True: heavy: {sorted(arrows.items() ^ by_spec.items())}")


def points(numbers):
    """Points along the cubic Bezier curves of an edge."""
    ends = list(zip(numbers[::2], numbers[1::2]))
    for a, b, c, d in (ends[i:i + 4] for i in range(0, len(ends) - 1, 3)):
        for t in (i / 16 for i in range(17)):
            yield tuple((1 - t) ** 3 * a[k] + 3 * t * (1 - t) ** 2 * b[k] + 3 * t * t * (1 - t) * c[k] + t ** 3 * d[k] for k in (0, 1))


def check_places(plain, drawn):
    """Passes go down the page, boxes do not overlap, arrows do not cross boxes. At most two pages wide: text keeps half its size."""
    found, edge = {}, 0.03
    width = float(re.search(r"^graph \S+ (\S+)", plain).group(1))
    for name, *numbers in re.findall(r"^node (\w+) (\S+) (\S+) (\S+) (\S+) ", plain, re.MULTILINE):
        x, y, w, h = map(float, numbers)
        found[name] = (x - w / 2 + edge, y - h / 2 + edge, x + w / 2 - edge, y + h / 2 - edge)
    if width > 2 * 8.27:
        fail(f"{width} inches are wider than two pages")
    column = [found["p_" + name] for name in drawn]
    if any(upper[1] <= lower[3] for upper, lower in zip(column, column[1:])):
        fail("the passes do not go down the page in order of execution")
    for (a, one), (b, other) in itertools.combinations(sorted(found.items()), 2):
        if one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]:
            fail(f"{a} and {b} overlap")
    for tail, head, numbers in re.findall(r"^edge (\w+) (\w+) \d+ ([-\d. e]+) (?:solid|dashed) ", plain, re.MULTILINE):
        for x, y in points([float(number) for number in numbers.split()]):
            for name, (left, bottom, right, top) in found.items():
                if left < x < right and bottom < y < top:
                    fail(f"the arrow between {tail} and {head} runs through {name}")


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
    """Resources that share memory are never alive in the same pass."""
    for slot in text.split("<hr/>")[1:-1]:
        alive = set()
        for row in re.findall(r"&nbsp;\w+(?: <i>\(unused\)</i>)?</td>(.*?)</tr>", slot):
            cells = re.findall(r"<td (border=\"0\"|bgcolor)[^>]*>[^<]*</td>", row)
            filled = {i for i, cell in enumerate(cells) if cell == "bgcolor"}
            if filled & alive:
                fail(f"two residents of one memory are alive at once: {html.unescape(slot)}")
            alive |= filled


def main():
    spec, _ = flat.load(sys.argv[1])
    dot, plain, lifetimes = (re.sub(r"(?<=\w)\.(?=[a-z])", "_", open(path, encoding="utf-8").read())   # names as flat.py has them
                             for path in sys.argv[2:5])
    known = uses(spec)
    resources = {**spec.get("buffers", {}), **spec.get("images", {})}
    histories = {name for name, resource in resources.items() if resource.get("history")}
    found = nodes(dot)
    drawn = check_passes(spec, found)
    waits = {step: check_reads(found["p_" + step], step, known) for step in drawn}
    for place, step in enumerate(drawn):
        check_writes(found["p_" + step], place, drawn, known, histories)
    check_waits(waits, drawn, known)
    check_arrows(dot, drawn, known, histories)
    check_places(plain, drawn)
    check_lifetimes(lifetimes, drawn, known, resources)
    check_slots(lifetimes)


main()
