#!/usr/bin/env python3
"""sanitize_mutants.py BUILD FOLDER [long]: leaves out each check of --sanitize in turn, and expects sanitize.py to miss a
finding. Conditions of templates/glsl/sanitize.glsl become false, by a copy of the templates beside a copy of the program; rows of
the table in gen/spirv/sanitize.c go, and cases of its switch, by a program that is compiled again, from `build`. Else: some
conditions, on the bodies about integers."""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys

import sanitize

# Never called by a body of ours: texel buffers and 1D images are the generator's, whose indices are right.
NEVER = {"diptych_texel(const int p"}
# Bodies beside those of sanitize.py, of overloads and of parts of conditions.
MORE = [
    ("r = taps[uint(i) / 4u];", "taps", "index 8 of `taps`, which has 8 elements", 32),
    ("r = float(bitfieldExtract(i, i - 1, 1));", "bitfieldExtract", "1 bits from bit -1 of 32", 0),
    ("r = float(bitfieldExtract(i, 0, i - 1));", "bitfieldExtract", "-1 bits from bit 0 of 32", 0),
    ("r = float(clamp(uint(i), 40u, uint(i)));", "clamp", "clamp from 40 to 0", 0),
    ("r = float(7u >> uint(i));", ">> uint", "a shift by 32 of 32 bits", 32),
    ("r = acosh(x);", "acosh", "acosh(0)", 0),
    ("r = mix(uintBitsToFloat(0x7fc00000u), x, 0.5);", "mix", "mix of a NaN", 0),
    ("r = mix(x, 0.5, uintBitsToFloat(0x7fc00000u));", "mix", "mix of a NaN", 0),
    ("r = normalize(x);", "normalize", "normalize of zero", 0),
    ("r = normalize(vec2(x)).x;", "normalize", "normalize of zero", 0),
    ("r = normalize(vec4(x)).x;", "normalize", "normalize of zero", 0),
]


def argument(text, start):
    """The end of the argument that begins there."""
    depth = 0
    for at in range(start, len(text)):
        depth += text[at] in "(["
        depth -= text[at] in ")]"
        if depth < 0 or (depth == 0 and text[at] == ","):
            return at
    raise ValueError(text[start:])


def conditions(text):
    """(name, text with one condition false)"""
    for call in re.finditer(r"\n(?:bool|void) (diptych_\w+\([^\n]*)\n{(.*?)\n}", text, re.S):
        if any(call[1].startswith(never) for never in NEVER) or call[1].startswith(("diptych_told", "diptych_note")):
            continue
        for found in re.finditer(r"diptych_(?:told|note)\(", call[2]):
            start = call.start(2) + found.end()
            yield call[1], start, argument(text, start)
        for found in re.finditer(r"any\(bvec[234]\(", call[2]):
            start = call.start(2) + found.end()
            while text[start - 1] != ")":
                end = argument(text, start)
                yield call[1], start, end
                start = end + 1 + (text[end] == "," and text[end + 1] == " ")


def table_rows(text):
    for found in re.finditer(r"    {(SpvOp|GLSLstd450)\w+, [^{}]*},\n", text):
        yield found[0].strip(), found.start(), found.end(), ""
    switch = text.index("static void put_before(")
    for found in re.finditer(r"    case SpvOp\w+:\n", text[switch : text.index("default", switch)]):
        yield found[0].strip(), switch + found.start(), switch + found.end(), ""


def run(program, spec, output):
    options = ["--size", "16x16", "--backend", "gl", "--dump", output + ".dump", "--sanitize", "--json", output]
    result = subprocess.run([program, "render", "--spec", spec, *options], capture_output=True, text=True, check=False)
    if result.returncode not in (0, 1) or not os.path.exists(output):
        sys.exit(f"{program}: {result.stderr}")
    with open(output, encoding="utf-8") as file:
        return json.load(file)["undefined"]


def told(findings):
    return {(f["pass"], f["line"], f["column"], f["message"], tuple(f["invocation"])) for f in findings}


def command_of(target):
    lines = subprocess.run(["ninja", "-t", "commands", target], capture_output=True, text=True, check=True).stdout
    return lines.strip().split("\n")[-1]


class Bench:
    def __init__(self, build, folder):
        self.folder = folder
        self.program = os.path.join(folder, "build", "diptych")
        os.makedirs(os.path.dirname(self.program))
        shutil.copytree("templates", os.path.join(folder, "templates"))
        shutil.copy(os.path.join(build, "diptych"), self.program)
        sanitize.make(folder)
        self.spec = os.path.join(folder, "wrong.yaml")
        self.wanted = told(run(self.program, self.spec, os.path.join(folder, "all.json")))
        self.survivors = []

    def judge(self, name):
        found = told(run(self.program, self.spec, os.path.join(self.folder, "mutant.json")))
        if found == self.wanted:
            self.survivors.append(name)
            print("survives:", name)

    def templates(self, names=""):
        path = os.path.join(self.folder, "templates/glsl/sanitize.glsl")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        mutants = [row for row in conditions(text) if re.match(names, row[0])]
        for name, start, end in mutants:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text[:start] + "false" + text[end:])
            self.judge(f"{name}: {text[start:end]}")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return len(mutants)

    def tables(self):
        with open("gen/spirv/sanitize.c", encoding="utf-8") as file:
            text = file.read()
        source, thing = os.path.join(self.folder, "sanitize.c"), os.path.join(self.folder, "sanitize_spirv.o")
        library = os.path.join(self.folder, "gen.a")
        compile_it = command_of("build/obj/gen/sanitize_spirv.o")
        compile_it = compile_it.replace("gen/spirv/sanitize.c", "-Igen/spirv -Wno-unused " + source)
        compile_it = compile_it.replace("build/obj/gen/sanitize_spirv.o", thing)
        link = command_of("build/diptych").replace("build/obj/gen.a", library)
        link = link.replace("-o build/diptych", "-o " + shlex.quote(self.program)).replace("-MF build/diptych.d", "-MF /dev/null")
        mutants = list(table_rows(text))
        for name, start, end, instead in mutants:
            with open(source, "w", encoding="utf-8") as file:
                file.write(text[:start] + instead + text[end:])
            shutil.copy("build/obj/gen.a", library)
            subprocess.run(f"{compile_it} && ar r {library} {thing} 2>/dev/null && {link}", shell=True, check=True)
            self.judge(name)
        return len(mutants)


def main(build, folder, form):
    if form != "long":
        names = [row[0] for row in sanitize.WRONG]
        first, last = names.index("r = float(7 / (i - 3));"), names.index("r = float(int(x * 1e8));")
        sanitize.WRONG[:] = sanitize.WRONG[first:last]
    else:
        sanitize.WRONG += MORE
    bench = Bench(os.path.realpath(build), folder)
    count = bench.templates() + bench.tables() if form == "long" else bench.templates("diptych_(modulo|shift)")
    print(f"{count} mutants, {len(bench.survivors)} survive")
    return bool(bench.survivors) or not count


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
