"""Writes specs that are far larger than any real one into a folder: `hostile.py FOLDER`. See hostile_test.sh."""
import os
import sys

BASE = """pipeline: big
params:
{params}
{more}
images: {{picture: {{format: rgba8, size: frame}}}}
passes:
  - {{name: fill, dispatch: picture, writes: [picture], shader: {shader}}}
output: {{display: picture}}
"""
BODY = "void main() {{ ivec2 p = ivec2(invocation().xy); {work} picture_store(p, vec4({value})); }}\n"


def put(name, text):
    with open(os.path.join(sys.argv[1], name), "w", encoding="utf-8") as file:
        file.write(text)


def spec(name, params="  a: 1\n", more="", shader="fill.glsl"):
    put(name + ".yaml", BASE.format(params=params, more=more, shader=shader))


def body(name, work="", value="1.0", before=""):
    put(name + ".glsl", before + BODY.format(work=work, value=value))
    spec(name, shader=name + ".glsl")


def lines(count, line):
    return "".join(line.format(i) for i in range(count))


def constants(items):
    return "constants:\n" + items


body("fill")
spec("parameters", lines(5000, "  p{0}: {0}\n"))
spec("duplicates", lines(5000, "  a: 1\n"))
spec("errors", lines(20000, "  p{0}: {{value: 1, min: 2}}\n"))
spec("name", "  " + "a" * 1000000 + ": 1\n")
spec("doc", more='doc: "' + "x y " * 2500000 + '"')
spec("terms", more=constants('  c: "' + "1+" * 100000 + '1"'))
spec("nesting", more=constants('  c: "' + "(" * 100000 + "1" + ")" * 100000 + '"'))
spec("doubling", more=constants("  c0: frame.width\n" + "".join(f"  c{i + 1}: c{i} + c{i}\n" for i in range(60))))
spec("chain", more=constants("".join(f"  c{i}: c{i + 1} + 1\n" for i in range(2000)) + "  c2000: 1\n"))
passes = [f"  - {{name: p{i}, dispatch: i{i}, reads: [{{name: i{i - 1}, as: old}}], writes: [{{name: i{i}, as: picture}}], "
          "shader: copy.glsl}\n" for i in range(1, 1000)]
put("copy.glsl", BODY.format(work="", value="old(p).xyz, 1.0"))
put("passes.yaml", "pipeline: big\nimages:\n" + lines(1000, "  i{0}: {{format: rgba8, size: frame}}\n") + "passes:\n"
    "  - {name: p0, dispatch: i0, writes: [{name: i0, as: picture}], shader: fill.glsl}\n" + "".join(passes)
    + "output: {display: i999}\n")
body("macros", value="A25", work="float x = 1.0;",
     before="#define A0 x+x\n" + "".join(f"#define A{i + 1} A{i}+A{i}\n" for i in range(25)))
body("cases", value="y", work="float y = 0.0; switch (p.x) {\n" + lines(20000, "case {0}: y = {0}.0; break;\n") + "}")
body("braces", work="{" * 20000 + "}" * 20000)
