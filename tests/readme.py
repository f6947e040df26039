"""Replays README's section "When the backends disagree": every line there that begins with `$ ` is run, in order,
in a folder with the project's names in it, and what stands below it must come out: the same lines in the same
order, with any numbers in them, since drivers round differently. Lines may be left out, and the end of one, for
which `…` stands. TAP; called by
readme_test.sh with the project's folder, that of the executables and one to work in."""

import os
import re
import shutil
import subprocess
import sys

ROOT, BUILD, WORK = sys.argv[1:]
SECTION = "## When the backends disagree"


def transcripts(text):
    """(command, lines below it) from the section's code blocks."""
    section = text.split(SECTION, 1)[1].split("\n## ", 1)[0]
    steps = []
    for block in re.findall(r"^```\n(.*?)^```$", section, re.M | re.S):
        for line in block.splitlines():
            if line.startswith("$ "):
                steps.append((line[2:], []))
            elif steps and line.strip():
                steps[-1][1].append(line)
    return steps


def without_numbers(line):
    return re.sub(r"\s+", " ", re.sub(r"-?(0x[0-9a-f]+|\d[\d.]*(e[+-]?\d+)?)", "#", line)).strip()


def is_line(expected, found):
    if expected.endswith("…"):
        return without_numbers(found).startswith(without_numbers(expected[:-1]))
    return without_numbers(found) == without_numbers(expected)


def missing(expected, found):
    """The first of the expected lines that does not follow those before it, or None."""
    rest = iter(found)
    for line in expected:
        if not any(is_line(line, other) for other in rest):
            return line
    return None


def main():
    for name in ("scenes", "templates"):
        shutil.copytree(f"{ROOT}/{name}", f"{WORK}/project/{name}")
    os.symlink(BUILD, f"{WORK}/project/build")
    with open(f"{ROOT}/README.md", encoding="utf-8") as file:
        steps = transcripts(file.read())
    good = len(steps) >= 4
    print(f"{'ok' if good else 'not ok'} 1 - the section has its commands: {len(steps)}")
    for number, (command, expected) in enumerate(steps, 2):
        run = subprocess.run(["bash", "-c", command], cwd=f"{WORK}/project", capture_output=True, text=True,
                             check=False)
        lost = missing(expected, run.stdout.splitlines())
        good &= lost is None
        print(f"{'ok' if lost is None else 'not ok'} {number} - $ {command}")
        if lost is not None:
            print(f"# not in its place: {lost}")
            print("\n".join("# " + line for line in (run.stdout + run.stderr).splitlines()))
    print(f"1..{len(steps) + 1}")
    return 0 if good else 1


sys.exit(main())
