"""Writes specs that are far larger than any real one into a folder: `hostile.py FOLDER`. See hostile_test.sh."""
import os
import struct
import sys
import zlib

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
spec("errors", lines(10000, "  p{0}: {{value: 1, min: 2}}\n"))
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
body("sum", value="float(invocation().x)" + " + 1.0" * 100000)


# ---- Scenes: see hostile_test.sh ----

SCENE = """mesh: {mesh}
camera: {{eye: [0, 0, 5], target: [0, 0, 0], fov_y: 40}}
light: {{kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1]}}
"""


def scene(name, mtl, before=""):
    put(name + ".mtl", mtl)
    put(name + ".obj", before or f"mtllib {name}.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n")
    put(name + ".yaml", SCENE.format(mesh=name + ".obj"))


def png(name, size):
    """Writes a black picture with one bit a pixel."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    packer = zlib.compressobj(9)
    data = b"".join(packer.compress(bytes(1 + (size + 7) // 8)) for _ in range(size)) + packer.flush()
    with open(os.path.join(sys.argv[1], name), "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 1, 0, 0, 0, 0))
                   + chunk(b"IDAT", data) + chunk(b"IEND", b""))


scene("early_map", "map_Kd a.png\n")
scene("pipe_map", "newmtl m\nmap_Kd pipe\n")
scene("huge_map", "newmtl m\nmap_Kd huge.png\n")
scene("pipe_mtl", "", "mtllib pipe\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
png("huge.png", 30000)
# Each node has the next one twice: 2 to the 24th nodes.
NODE = '<node id="n{0}"><instance_node url="#n{1}"/><instance_node url="#n{1}"/></node>'
put("doubling.dae", '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>'
    "<library_nodes>" + "".join(NODE.format(i, i + 1) for i in range(24)) + '<node id="n24"/></library_nodes>'
    '<library_visual_scenes><visual_scene id="s"><node><instance_node url="#n0"/></node></visual_scene></library_visual_scenes>'
    '<scene><instance_visual_scene url="#s"/></scene></COLLADA>')
put("doubling_nodes.yaml", SCENE.format(mesh="doubling.dae"))
put("zero_mesh.yaml", SCENE.format(mesh="/dev/zero"))
