#!/usr/bin/env python3
"""Checks the table in templates/README.md of the shipped pipelines' needs of a Vulkan device, by `diptych-gen --needs` of each.
usage: needs.py DIPTYCH-GEN README SPEC... Fails if the README has another table; with UPDATE set, writes the table there."""
import os
import re
import subprocess
import sys

gen, readme, *specs = sys.argv[1:]
rows = {}  # need -> the smallest value that is enough, cells of the profiles, specs
for spec in specs:
    table = subprocess.run([gen, spec, "--needs"], check=True, capture_output=True, text=True).stdout
    for line in table.splitlines()[2:]:
        need, _, cells = line[2:].split(" | ", 2)
        name, _, least = need.partition(": ")
        row = rows.setdefault(name, [-1, "", []])
        if int(least or 0) > row[0]:
            row[:2] = int(least or 0), cells
        row[2].append(os.path.basename(spec).removesuffix(".yaml"))
wanted = "| need | specs | Roadmap 2022 | Android baseline 2022 | MoltenVK |\n|---|---|---|---|---|\n"
for name, (least, cells, by) in rows.items():
    named = "all" if len(by) == len(specs) else ", ".join(f"`{spec}`" for spec in by)
    wanted += f"| {name}{f': {least}' if least else ''} | {named} | {cells}\n"
text = open(readme, encoding="utf-8").read()
updated = re.sub(r"\| need \| specs .*\n(\|.*\n)+", lambda _: wanted, text)
if os.environ.get("UPDATE"):
    open(readme, "w", encoding="utf-8").write(updated)
elif updated != text or wanted not in text:
    sys.exit(f"{readme} should have this table; UPDATE=1 writes it:\n{wanted}")
