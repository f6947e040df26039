"""Whole shaders go the road of our bodies: stages match by name, wrong ones are told at their place, --sanitize checks them.
Prints TAP; called by foreign_test.sh."""
import json
import os
import struct
import subprocess
import tempfile

import bodies

BUILD = os.path.abspath(os.environ.get("DIPTYCH_BUILD", "build"))
COMPUTE = """pipeline: tried
{head}
buffers: {{Sums: {{of: {kind}, count: 8}}}}
passes:
  - {{name: run, dispatch: 8, local: {local}, writes: [Sums], shader: {file}}}
"""
DRAW = """pipeline: tried
images: {{color: {{format: rgba32f, size: frame}}}}
passes:
  - {{name: run, draw: fullscreen, shader: [{files}], writes: [color]}}
"""
CORNERS = "gl_Position = vec4((gl_VertexIndex << 2 & 4) - 1, (2 * gl_VertexIndex & 4) - 1, 0, 1);"


def put(name, text):
    with open(name, "w", encoding="utf-8") as out:
        out.write(text)


def diptych(*words):
    return bodies.limited([BUILD + "/diptych", *words, "--size", "8x8"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def numbers(kind="f"):
    """The first 16 bytes of what the pass leaves with Vulkan."""
    done = diptych("render", "--spec", "a.yaml", "--backend", "vk", "--dump", "dump")
    if done.returncode:
        return [done.stdout]
    with open("dump/manifest.json", encoding="utf-8") as file:
        name = json.load(file)["entries"][-1]["file"]
    with open("dump/" + name, "rb") as file:
        return list(struct.unpack("<4" + kind, file.read(16)))


def agrees(want, kind="f"):
    """Why it does not: both backends leave the same bits, and Vulkan `want`."""
    done = diptych("compare", "--spec", "a.yaml")
    got = numbers(kind)
    return ([done.stdout] if done.returncode else []) + ([] if got == want else [f"{got}, not {want}"])


def told(words, *options):
    """Why it is not: an error, or with --sanitize a finding, has the words."""
    done = diptych("compare", "--spec", "a.yaml", *options)
    return [] if done.returncode and words in done.stdout else [done.stdout]


def draw(vertex, fragment):
    put("a.vert", "#version 450\n" + vertex)
    put("a.frag", "#version 450\n" + fragment)
    put("a.yaml", DRAW.format(files="a.vert, a.frag"))


def compute(text, local="[8, 1, 1]", head="", kind="uint"):
    put("a.comp", "#version 450\n" + text)
    put("a.yaml", COMPUTE.format(local=local, head=head, kind=kind, file="a.comp"))


VERTEX = "{} void main() {{{{ {} {{}} }}}}\n".format("{}", CORNERS)
FRAGMENT = "out vec4 color;\n{} void main() {{ color = {}; }}\n"


def stages(tap):
    draw(VERTEX.format("out vec2 far; out vec2 near;", "near = vec2(0.5, 0.25); far = vec2(2, 4);"),
         FRAGMENT.format("in vec2 near; in vec2 far;", "vec4(near, far)"))
    tap.result("varyings match by name, not by order", agrees([0.5, 0.25, 2, 4]))
    draw(VERTEX.format("out mat2 turn; out float unread; out Pair { vec2 a; vec2 b; } first; out float last;",
                       "turn = mat2(1, 2, 3, 4); unread = 9; first.a = vec2(5); first.b = vec2(6); last = 7;"),
         FRAGMENT.format("in float last; in Pair { vec2 a; vec2 b; } second; in mat2 turn; in vec4 nobody;",
                         "vec4(turn[1], second.b.x, last)"))
    tap.result("matrices, blocks, and what nobody reads or writes", agrees([3, 4, 6, 7]))
    draw(VERTEX.format("layout(location = 2) out vec2 here; out vec3 there;", "here = vec2(1, 2); there = vec3(3);"),
         FRAGMENT.format("layout(location = 2) in vec2 named_otherwise; in vec3 there;", "vec4(named_otherwise, there.xy)"))
    tap.result("a location counts before a name", agrees([1, 2, 3, 3]))
    near = VERTEX.format("out vec2 near;", "near = vec2(1);")
    draw(near, FRAGMENT.format("in vec2 near;\nin vec4 far;", "far + near.xyxy"))
    tap.result("an input that nobody writes", told("a.frag:4:9: error: 'far' : the fragment stage reads `far`, which"))
    draw(near, FRAGMENT.format("in vec3 near;", "near.xyzz"))
    tap.result("... or with another type", told("another type than the vertex stage writes"))
    draw(near, FRAGMENT.format("layout(location = 3) in vec2 near;", "near.xyxy"))
    tap.result("... or elsewhere", told("reads location 3, which the vertex stage does not write"))


def sanitized(tap):
    compute("layout(local_size_x = 8) in;\nlayout(std430) buffer Sums { uint sums[]; };\n"
            "void main() { sums[gl_GlobalInvocationID.x + gl_WorkGroupSize.y] = 3u; }\n")
    tap.result("an index of a compute shader", told("a.comp:4:", "--sanitize"))
    tap.result("... is found in its invocation", told("index 8 of `sums`, which has 8 elements\n  pass run, invocation (7, 0, 0), 1 time", "--sanitize"))


def main():
    tap = bodies.Tap()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        stages(tap)
        sanitized(tap)
        os.chdir("/")
    tap.finish()


if __name__ == "__main__":
    main()
