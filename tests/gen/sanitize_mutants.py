#!/usr/bin/env python3
"""sanitize_mutants.py BUILD FOLDER [long]: leaves out each check of --sanitize in turn, and expects bodies of sanitize.py to miss a
finding. Conditions of templates/glsl/sanitize.glsl become false, in a copy of the templates beside a copy of the program. Rows of
the tables in gen/spirv/sanitize.c and cases of its switch go, in a program that is compiled from it, linked as `build` was, and
told by MUTANT which. Checks of memory and quads are left out as MEMORY says. Without `long`: a sixth of MEMORY, by SEED."""
import json
import os
import re
import shutil
import subprocess
import sys

import sanitize

# Never called by a body of ours: texel buffers and 1D images are the generator's, whose indices are right.
NEVER = {"diptych_texel(const int p", "diptych_safe"}
# Bodies beside those of sanitize.py, of overloads and of parts of conditions.
MORE = [
    ("r = taps[uint(i) / 4u];", "taps", "index 8 of `taps`, which has 8 elements", 32),
    ("r = float(bitfieldExtract(i, i - 1, 1));", "bitfieldExtract", "1 bits from bit -1 of 32", 0),
    ("r = float(bitfieldExtract(i, 0, i - 1));", "bitfieldExtract", "-1 bits from bit 0 of 32", 0),
    ("r = float(bitfieldExtract(uint(i), i, 8));", "bitfieldExtract", "8 bits from bit 25 of 32", 25),
    ("r = float(clamp(uint(i), 40u, uint(i)));", "clamp", "clamp from 40 to 0", 0),
    ("r = float(7u >> uint(i));", ">> uint", "a shift by 32 of 32 bits", 32),
    ("r = degrees(x * 1e36);", "degrees", "`degrees` of finite numbers makes inf", 6),
    ("r = acosh(x);", "acosh", "acosh(0)", 0),
    ("r = mix(uintBitsToFloat(0x7fc00000u), x, 0.5);", "mix", "mix of a NaN", 0),
    ("r = mix(x, 0.5, uintBitsToFloat(0x7fc00000u));", "mix", "mix of a NaN", 0),
    ("r = normalize(x);", "normalize", "normalize of zero", 0),
    ("r = normalize(vec2(x)).x;", "normalize", "normalize of zero", 0),
    ("r = normalize(vec4(x)).x;", "normalize", "normalize of zero", 0),
    ("r = max(x, uintBitsToFloat(0x7fc00000u));", "max", "nan goes into `max`", 0),
    ("r = clamp(x, uintBitsToFloat(0x7fc00000u), 1.0);", "clamp", "nan goes into `clamp`", 0),
    ("r = clamp(x, 0.0, uintBitsToFloat(0x7fc00000u));", "clamp", "nan goes into `clamp`", 0),
    ("r = float(rem(7, i - 3));", "rem", "7 % 0", 3, "#extension GL_EXT_spirv_intrinsics : require\nspirv_instruction(id = 138) int rem(int a, int b);\n"),
    ("r = float(float16_t(x * 2e3));", "float16_t", "float16_t makes infinity of 66000", 33, "#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require\n"),
    *((f"r = unpack{pack}(pack{pack}({vector}(i < 9 ? x : nan))).x;", f"pack{pack}", f"pack{pack} of a NaN", 9, sanitize.NAN)
      for pack, vector in (("Snorm4x8", "vec4"), ("Unorm2x16", "vec2"), ("Snorm2x16", "vec2"))),
    ("r = log2(x);", "log2", "log2(0)", 0),
    ("r = (x + 1e38) + 3.1e38;", "+ 3.1", "`+` of finite numbers makes inf", 0),
    ("r = (x - 3.3e38) - 3.1e38;", "- 3.1", "`-` of finite numbers makes -inf", 0),
    ("r = mod(x, x);", "mod", "`mod` of finite numbers makes", 0),
    ("r = (vec2(x) * 1e38).x;", "* 1e38", "`*` of finite numbers makes inf", 4),
    ("r = (mat2(x) * 1e38)[0].x;", "* 1e38", "`*` of finite numbers makes inf", 4),
    ("r = (mat2(x) * vec2(1e38)).x;", "* vec2", "`*` of finite numbers makes inf", 4),
    ("r = (vec2(1e38) * mat2(x)).x;", "* mat2", "`*` of finite numbers makes inf", 4),
    ("r = (mat2(1e38) * mat2(x))[0].x;", "* mat2", "`*` of finite numbers makes inf", 4),
    ("r = outerProduct(vec2(1e38), vec2(x))[0].x;", "outerProduct", "`outerProduct` of finite numbers makes inf", 4),
    ("r = exp2(x * 4.0);", "exp2", "`exp2` of finite numbers makes inf", 32),
    ("r = sinh(x * 2.0);", "sinh", "`sinh` of finite numbers makes inf", 45),
    ("r = cosh(x * 2.0);", "cosh", "`cosh` of finite numbers makes inf", 45),
    ("r = length(vec2(x, 3e38));", "length", "`length` of finite numbers makes inf", 0),
    ("r = distance(vec2(x, 3e38), vec2(0.0));", "distance", "`distance` of finite numbers makes inf", 0),
    ("r = cross(vec3(x * 1e30, 3e38, 3e38), vec3(2.0, 3.0, 4.0)).x;", "cross", "`cross` of finite numbers makes inf", 0),
    ("r = reflect(vec2(x, 3e38), vec2(9.0)).x;", "reflect", "`reflect` of finite numbers makes", 0),
    ("r = refract(vec2(x), vec2(0.0, 1.0), 1e38).x;", "refract", "`refract` of finite numbers makes", 1),
    ("r = fma(x, 1e38, 1.0);", "fma", "`fma` of finite numbers makes inf", 4),
    ("r = determinant(mat2(x * 1e20, 0.0, 0.0, 1e20));", "determinant", "`determinant` of finite numbers makes inf", 1),
    ("vec3 v = vec3(x); v[i / 16] = 1.0; r = v.x;", "v[i", "index 3 of `v`, which has 3 elements", 48),
    ("r = vec3(x, 1.0, 2.0)[i / 16];", "vec3", "index 3 of `a vector`, which has 3 elements", 48),
    ("stack_atomicAdd(ivec3(0, 0, i / 32 + 1), 1u); r = 1.0;", "stack_atomicAdd", "texel (0, 0, 2) of `stack`, which has 4 x 4 texels", 32),
]
# What the message of a check has that is no row of the tables.
TOLD = {"index": "index", "mip": "mip ", "texel": "texel", "made": "makes", "assigned": "value", "turn": "turns", "dropped": "goes into"}

# File, what is left out, what stands there instead, and a part of the message that then is missed.
MEMORY = [
    ("cells", "min(diptych_meets(before, me), min(diptych_meets(first, me), diptych_meets(last, me)))", "diptych_last", "touched"),
    ("cells", "diptych_meets(before, me)", "diptych_last", "`result` is also|`out_|`stack`"),
    ("cells", "diptych_meets(diptych_upside_down(diptych_cells[cell + 1u]), me)", "diptych_last", "touched"),
    ("cells", "access >> 22 == (diptych_epoch & 1023u)", "false", "`scratch` is also"),
    ("cells", "bvec2(foreign,", "bvec2(false,", "39, 0, 0|40, 0, 0"),
    ("cells", "| (path ^ path >> 10 ^ path >> 20) << 22", "", "barrier"),
    ("cells", "bvec3(other == 0u,", "bvec3(true,", "barrier"),
    ("cells", "content == 0u ?", "false ?", "`scratch` was never"),
    ("shadow", "bvec3(beside, written == diptych_now()", "bvec3(true, written == diptych_now()", "never written in"),
    ("shadow", "mix(diptych_marked, mark, diptych_marked == 0u)", "0u", "never written"),
    ("quads", "any(notEqual(vec2(dFdxFine(own), dFdyFine(own)), vec2(0.0)))", "false", "quad"),
    ("quads", "dFdxFine(own)", "0.0", "quad"),
    ("quads", "dFdyFine(own)", "0.0", "quad"),
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


def parts(function, text, begin, end):
    for found in re.finditer(r"any\(bvec[234]\(", text[begin:end]):
        start = begin + found.end()
        while text[start - 1] != ")":
            end = argument(text, start)
            yield function, start, end
            start = end + 1 + (text[end] == "," and text[end + 1] == " ")


def conditions(text):
    """(function, begin, end) of each condition, and of the parts that `any` joins."""
    for call in re.finditer(r"\n(?:bool|void|u?int) (diptych_\w+\([^\n]*)\n{(.*?)\n}", text, re.S):
        if any(call[1].startswith(never) for never in NEVER) or call[1].startswith(("diptych_told", "diptych_note")):
            continue
        for found in re.finditer(r"diptych_(?:told|note)\(", call[2]):
            start = call.start(2) + found.end()
            yield call[1], start, argument(text, start)
        yield from parts(call[1], text, call.start(2), call.end(2))
    for row in re.finditer(r"\nDIPTYCH_\w+\((\w+), (?:(?:u?int|float|vec\d), )?(?=.*[<>=])", text):
        end = argument(text, row.end())
        yield f"diptych_{row[1]}", row.end(), end
        yield from parts(f"diptych_{row[1]}", text, row.end(), end)


def table_rows(text):
    """(number, function or None, word) of each row."""
    rows = re.findall(r'    {((?:SpvOp|GLSLstd450)\w+), (?:"(\w+)"|NULL), "([^"]+)", "[^"]*", \d, \d,\s+\w+},', text)
    return [(number, function or None, word) for number, function, word in rows]


def run(program, spec, output, kinds, **environment):
    options = ["--size", "16x16", "--backend", "vk@llvmpipe", "--dump", output + ".dump", "--sanitize=" + kinds, "--json", output]
    result = subprocess.run([program, "render", "--spec", spec, *options], capture_output=True, text=True, check=False,
                            env={**os.environ, **environment})
    if result.returncode not in (0, 1) or "error:" in result.stderr:
        sys.exit(f"{program}: {result.stderr}")
    with open(output, encoding="utf-8") as file:
        return {(f["pass"], f["line"], f["column"], f["message"], *f["invocation"]) for f in json.load(file)["undefined"]}


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
        with open("gen/spirv/sanitize.c", encoding="utf-8") as file:
            self.source = file.read()
        self.rows, self.survivors, self.count, self.known = sanitize.WRONG + MORE, [], 0, {}
        self.kinds = "index,arithmetic,loop,variable"

    def judge(self, name, suits, **environment):
        """Runs the bodies that suit, by their row, with the mutant and without."""
        bodies = {f"w{i}": sanitize.wrong_body(row) for i, row in enumerate(self.rows) if suits(row)}
        table = "wrong_draw" if self.rows is sanitize.WRONG_DRAW else "wrong"
        self.count += 1
        if not bodies or self.findings(self.program, table, bodies, **environment) == self.whole(table, bodies):
            self.survivors.append(name)
            print("survives:", name)

    def findings(self, program, table, bodies, **environment):
        sanitize.write_spec(self.folder, table, bodies)
        spec, output = os.path.join(self.folder, table + ".yaml"), os.path.join(self.folder, "found.json")
        return run(program, spec, output, self.kinds, **environment)

    def whole(self, table, bodies):
        """What the bodies have without a mutant; each of them runs once."""
        new = {name: text for name, text in bodies.items() if (self.kinds, text) not in self.known}
        found = self.findings(os.path.join(self.build, "diptych"), table, new) if new else set()
        for name, text in new.items():
            self.known[self.kinds, text] = {finding[1:] for finding in found if finding[0] == name}
        return {(name, *finding) for name, text in bodies.items() for finding in self.known[self.kinds, text]}

    def templates(self):
        path = os.path.join(self.folder, "templates/glsl/sanitize.glsl")
        words = {}
        for _, function, word in table_rows(self.source):
            words.setdefault(function, []).append(word)
        with open(path, encoding="utf-8") as file:
            text = file.read()
        for name, start, end in conditions(text):
            function = re.match(r"diptych_(\w+)", name)[1]
            with open(path, "w", encoding="utf-8") as file:
                file.write(text[:start] + "false" + text[end:])
            told, own = TOLD.get(function), words.get(function, [])
            self.judge(f"{name}: {text[start:end]}", lambda row: told in row[2] if told else any(word in row[0] for word in own))
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def memory(self, rows):
        self.kinds = "content,race,flow"
        for name, old, new, told in rows:
            path = os.path.join(self.folder, f"templates/glsl/{name}.glsl")
            with open(path, encoding="utf-8") as file:
                text = file.read()
            assert old in text, old
            with open(path, "w", encoding="utf-8") as file:
                file.write(text.replace(old, new))
            self.rows = sanitize.WRONG_DRAW if name == "quads" else sanitize.WRONG_MEMORY
            self.judge(f"{name}: {old}", lambda row, told=told: re.search(told, row[2]))
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        self.rows, self.kinds = sanitize.WRONG + MORE, "index,arithmetic,loop,variable"

    def compile(self):
        """A program that leaves out what MUTANT names."""
        out = "static bool is_out(const char *name)\n{\n    return getenv(\"MUTANT\") && !strcmp(getenv(\"MUTANT\"), name);\n}\n\n"
        text = self.source.replace("struct check {\n", out + "struct check {\n    const char *own;\n", 1)
        text = re.sub(r"    {((?:SpvOp|GLSLstd450)\w+),", r'    {"\1", \1,', text)
        text = text.replace("if (list[i].number == number)", "if (list[i].number == number && !is_out(list[i].own))", 1)
        begin = text.index("static bool put_before(")
        cases = re.sub(r"case (SpvOp\w+):\n", r'case \1:\n        if (is_out("case \1"))\n            return false;\n        goto \1;\n    \1:\n', text[begin : text.index("default", begin)])
        path, thing, library = (os.path.join(self.folder, name) for name in ("sanitize.c", "sanitize_spirv.o", "gen.a"))
        with open(path, "w", encoding="utf-8") as file:
            file.write(text[:begin] + cases + text[text.index("default", begin) :])
        compile_it = command_of("build/obj/gen/sanitize_spirv.o").replace("build/obj/gen/sanitize_spirv.o", thing)
        compile_it = compile_it.replace("gen/spirv/sanitize.c", "-Igen/spirv -Wno-unused -Wno-implicit-fallthrough " + path)
        link = command_of("build/diptych").replace("build/obj/gen.a", library)
        link = link.replace("-o build/diptych", "-o " + self.program).replace("-MF build/diptych.d", "-MF /dev/null")
        shutil.copy("build/obj/gen.a", library)
        subprocess.run(f"{compile_it} && ar r {library} {thing} && {link}", shell=True, check=True)

    def tables(self):
        self.compile()
        for number, _, word in table_rows(self.source):
            self.judge(number, lambda row: word in row[0] + row[2], MUTANT=number)
        begin = self.source.index("static bool put_before(")
        for case in re.findall(r"case (SpvOp\w+):\n", self.source[begin : self.source.index("default", begin)]):
            self.judge(case, lambda row: "index" in row[2] or "texel" in row[2], MUTANT="case " + case)


def main(build, folder, form=""):
    bench = Bench(build, folder)
    bench.build = os.path.realpath(build)
    if form:
        bench.templates()
        bench.memory(MEMORY)
        bench.tables()
    else:
        bench.memory(MEMORY[int(os.environ["SEED"]) % 6 :: 6])
    print(f"{bench.count} mutants, {len(bench.survivors)} survive")
    return bool(bench.survivors) or not bench.count


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
