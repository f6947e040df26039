"""Runs the commands of every README in a copy of the project, and compares what they print. TAP.

A fenced block says by its first line what the test does with it:

    ```sh             runs the block with bash; every command must succeed
    ```sh no-test     runs the block with programs that read their options and do nothing else
    ```console        runs the line behind each `$ `; the lines below must be printed, in this order
    ```yaml FILE      every line stands in FILE
    ```yaml workflow  the steps that run diptych succeed
    ```python         left to python_test.py

`<!-- before: COMMAND -->` in the line before a block runs COMMAND first, and gives the block a copy of the project of its own.

What is printed: lines may be left out, and `…` stands for the end of a line. Numbers, but not those of a source line
(`FILE:LINE:COLUMN: error`), may have another value, since drivers round differently and machines differ in speed.

Beside the blocks: links lead to files, names of files in `backticks` exist, `ninja TARGET` is a target, a quoted verdict
(`guilty: …`) is one that a block prints, and README.md keeps its length.

Frames of 480x270 have a fifth of each side here, with the same words.

Called by readme_test.sh with the project's folder, that of the executables and one to work in."""

import os
import re
import shutil
import subprocess
import sys

import yaml

ROOT, BUILD, WORK = sys.argv[1:]
READMES = ("README.md", "scenes/README.md", "templates/README.md", "templates/ssvp/README.md")
MOST_WORDS = 1500
# Stubs that no-test blocks call in place of the programs: they check options and targets, and make nothing.
STUBS = {
    "build/diptych": f'exec {BUILD}/diptych "$@" --help',
    "build/diptych-gen": f'exec {BUILD}/diptych-gen "$@" --help',
    "bootstrap": f"""sed 's/#.*//' {ROOT}/bootstrap | grep -qE "^$1\\) " """,
    "bin/ninja": f'cd {ROOT} && exec ninja -t query "$@"',
    "bin/sudo": 'exec "$@"',
}
FILE = re.compile(r"[\w.-]+(/[\w.-]+)+|\w[\w-]*\.(yaml|json|glsl|py|sh|ninja|[ch])")
count = failed = 0


def result(good, description, *lines):
    global count, failed
    count += 1
    failed += not good
    print(f"{'ok' if good else 'not ok'} {count} - {description}")
    if not good:
        print("\n".join("# " + line for text in lines for line in str(text).splitlines()[-30:]))


class Block:
    """A fenced block: the words of its first line, its text, the command before it, and where it stands."""

    def __init__(self, readme, match, text):
        self.readme = readme
        self.before, info, self.text = match.groups()
        self.kind, *self.words = info.split() or [""]
        self.place = f"{readme}:{text.count(chr(10), 0, match.start(2)) + 1}"

    def steps(self):
        """(command, lines below it) of a console block."""
        steps = []
        for line in self.text.splitlines():
            if line.startswith("$ "):
                steps.append((line[2:], []))
            elif line.strip():
                steps[-1][1].append(line)
        return steps


def blocks_of(readme, text):
    pattern = re.compile(r"^(?:<!-- before: (.*) -->\n)?```([^\n]*)\n(.*?)^```$", re.M | re.S)
    return [Block(readme, match, text) for match in pattern.finditer(text)]


# ---- Folders ----


def copy_project(name):
    """Copies the files that commands read to a folder where commands may write; links the programs and outputs of the build. ssvp
    has fewer VPLs there, which drivers compile sooner; its lines and columns stay."""
    folder = f"{WORK}/{name}"
    for part in ("scenes", "templates", "tests/app/import"):
        shutil.copytree(f"{ROOT}/{part}", f"{folder}/{part}")
    with open(f"{folder}/templates/ssvp.yaml", "r+", encoding="utf-8") as file:
        text = re.sub(r"(first_vpls: +{value: )256|(second_vpls: +{value: )176", r"\g<1>\g<2> 32", file.read())
        file.seek(0)
        file.write(re.sub(r"(map_size: +{value: )256", r"\g<1> 64", text))
    os.mkdir(f"{folder}/build")
    for part in ("diptych", "diptych-gen", "scenes"):
        os.symlink(f"{BUILD if part != 'scenes' else ROOT + '/build'}/{part}", f"{folder}/build/{part}")
    return folder


def stub_project():
    folder = f"{WORK}/stubs"
    for name, command in STUBS.items():
        path = f"{folder}/{name}"
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"#!/bin/bash\n{command}\n")
        os.chmod(path, 0o755)
    return folder


def bash(command, folder, **environment):
    return subprocess.run(["bash", "-ec", command.replace("--size 480x270", "--size 96x54")], cwd=folder, capture_output=True, text=True, check=False,
                          stdin=subprocess.DEVNULL, env={**os.environ, **environment})


# ---- What is printed ----


def without_numbers(line):
    if re.match(r"[\w./-]+:\d+:\d+: (error|warning): | *\d+ \| ", line):
        return line.rstrip()
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


# ---- Blocks ----


def run_console(block, folder):
    """Runs its commands one by one; returns the lines that they print."""
    printed = []
    for command, expected in block.steps():
        run = bash(command, folder)
        lines = (run.stdout + run.stderr).splitlines()
        lost = missing(expected, lines)
        result(lost is None and run.returncode in ((0, 1) if expected else (0,)), f"{block.place}: $ {command}",
               f"not in its place: {lost}; exit status {run.returncode}", *lines)
        printed += lines
    return printed


def run_script(block, folder, stubs):
    environment = {}
    if block.words == ["no-test"]:
        folder = stubs
        environment = {"PATH": f"{stubs}/bin:{os.environ['PATH']}"}
    run = bash(block.text, folder, **environment)
    first = block.text.splitlines()[0]
    result(run.returncode == 0 and "diptych: error:" not in run.stderr,
           f"{block.place}: {'options of ' if block.words else ''}{first}", f"exit status {run.returncode}",
           run.stdout, run.stderr)


def check_quote(block, path):
    with open(f"{ROOT}/{path}", encoding="utf-8") as file:
        lines = {line.strip() for line in file}
    strange = [line for line in block.text.splitlines() if line.strip() not in lines]
    result(not strange, f"{block.place}: lines of {path}", *strange)


def run_workflow(block, folder):
    jobs = yaml.safe_load(block.text)["jobs"].values()
    commands = [step["run"] for job in jobs for step in job["steps"] if step.get("run", "").startswith("diptych ")]
    result(commands, f"{block.place}: runs diptych")
    for command in commands:
        run = bash(command, folder, PATH=f"{folder}/build:{os.environ['PATH']}")
        result(run.returncode == 0, f"{block.place}: {command}", f"exit status {run.returncode}", run.stdout, run.stderr)


def run_block(block, folder, stubs):
    """Runs or checks a block; returns the lines that a console block prints."""
    if block.before:
        folder = copy_project(f"own{count}")
        run = bash(block.before, folder)
        result(run.returncode == 0, f"{block.place}: before it, {block.before}", run.stderr)
    if block.kind == "console" and not block.words:
        return run_console(block, folder)
    if block.kind == "sh" and block.words in ([], ["no-test"]):
        run_script(block, folder, stubs)
    elif block.kind == "yaml" and block.words == ["workflow"]:
        run_workflow(block, folder)
    elif block.kind == "yaml" and len(block.words) == 1:
        check_quote(block, block.words[0])
    elif block.kind != "python":  # python_test.py runs those
        result(False, f"{block.place}: a block of a kind that the test knows", f"```{block.kind} {block.words}")
    return []


# ---- The text between them ----


def check_text(readme, text, printed):
    prose = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    here = os.path.dirname(f"{ROOT}/{readme}")
    links = re.findall(r"\]\(([^)#:]+)\)", prose)
    lost = [link for link in links if not os.path.exists(f"{here}/{link}")]
    result(not lost, f"{readme}: links lead to files", *lost)
    quoted = re.findall(r"`([^`\n]+)`", prose)
    names = {name for name in quoted if FILE.fullmatch(name.rstrip("/")) and not re.search("NAME|DIR|^build/|^[A-Z]+/", name)}
    lost = [name for name in names if not any(os.path.exists(f"{folder}/{name}") for folder in (ROOT, here))]
    result(not set(lost) - MADE, f"{readme}: files that it names exist", *sorted(set(lost) - MADE))
    targets = sorted({name[6:] for name in quoted if re.fullmatch(r"ninja [\w-]+", name)})
    if targets:
        run = bash("ninja -t query " + " ".join(targets), ROOT)
        result(run.returncode == 0, f"{readme}: targets of ninja: {' '.join(targets)}", run.stderr)
    verdicts = [line.strip() for line in prose.splitlines() if line.startswith("    guilty: ")]
    if verdicts:
        result(all(missing([line], printed) is None for line in verdicts), f"{readme}: the verdict that it quotes", *verdicts)


# Files in backticks that commands write, and that are no part of the project.
MADE = {"summary.json", "ssvp.c", "ssvp_vk_shaders.c", "ssvp_gl_shaders.c"}


def main():
    folder, stubs = copy_project("project"), stub_project()
    for readme in READMES:
        with open(f"{ROOT}/{readme}", encoding="utf-8") as file:
            text = file.read()
        blocks = blocks_of(readme, text)
        result(len(blocks) > 1, f"{readme} has commands")
        printed = []
        for block in blocks:
            printed += run_block(block, folder, stubs)
        check_text(readme, text, printed)
        if readme == READMES[0]:
            words = len(text.split())
            result(words <= MOST_WORDS, f"{readme} has at most {MOST_WORDS} words: {words}")
    print(f"1..{count}")
    return 1 if failed else 0


sys.exit(main())
