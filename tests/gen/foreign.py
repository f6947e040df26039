"""Whole shaders go the road of our bodies: stages match by name, wrong ones are told at their place, --sanitize checks them, and a
module of SPIR-V gives the bits of its GLSL, whoever optimized it. Prints TAP; called by foreign_test.sh.

    SEED=N FORMS=N foreign.py SIDE...     the seed of the sample of shaders in forms, and its size; names for --backend,
                                          the second also fast"""
import json
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile

import bodies
import corpus

FILES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "foreign")
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


def left(side):
    """What each pass leaves on that side."""
    done = diptych("render", "--spec", "a.yaml", "--backend", side, "--dump", "dump")
    if done.returncode:
        return [done.stdout]
    with open("dump/manifest.json", encoding="utf-8") as file:
        names = [entry["file"] for entry in json.load(file)["entries"]]
    found = []
    for name in names:
        with open("dump/" + name, "rb") as file:
            found.append(file.read())
    return found


def agrees(want, kind="f"):
    """Why it does not: both backends leave the same bits, and the first 16 bytes of the last pass are `want`."""
    gl, vk = left("gl"), left("vk")
    if isinstance(vk[-1], str) or gl != vk:
        return ["gl and vk differ", *(text for text in gl + vk if isinstance(text, str))]
    got = list(struct.unpack("<4" + kind, vk[-1][:16]))
    return [] if got == want else [f"{got}, not {want}"]


def told(words, *options):
    """Why it is not: an error, or with --sanitize a finding, has the words."""
    done = diptych("compare", "--spec", "a.yaml", *options)
    return [] if done.returncode and words in done.stdout else [done.stdout]


def draw(vertex, fragment, version=450):
    put("a.vert", f"#version {version}\n" + vertex)
    put("a.frag", f"#version {version}\n" + fragment)
    put("a.yaml", DRAW.format(files="a.vert, a.frag"))


def compute(text, local="[8, 1, 1]", head="", kind="uint"):
    put("a.comp", "#version 450\n" + text)
    put("a.yaml", COMPUTE.format(local=local, head=head, kind=kind, file="a.comp"))


VERTEX = "{} void main() {{{{ {} {{}} }}}}\n".format("{}", CORNERS)
FRAGMENT = "out vec4 color;\n{} void main() {{ color = {}; }}\n"


STRUCTS = """out vec4 color;
struct Light { vec3 at; float power; };
struct Material { sampler2D a; float x; bool on; sampler2D b[2]; vec3 y; Light light; float z; };
uniform Material m;
uniform float last; uniform bool lit = true;
void main() { color = vec4(m.x, m.y.y, m.light.power, m.z) + last + (lit && m.on ? gl_FragCoord.y : 9) + texture(m.a, vec2(0.5)) + texture(m.b[1], vec2(0.5)); }
"""


CHOSEN = """out vec4 color;
struct Near { sampler2D c; float g; };
struct Material { Near n; float x; };
uniform Material m[3];
struct Bare { sampler2D d; };
uniform Bare bare[2];
uniform int k;
float wide(sampler2D one) { return textureSize(one, 0).x; }
float near(Near n) { return textureSize(n.c, 0).x + texture(n.c, vec2(0.5)).x + n.g; }
float whole(Material one) { return near(one.n) + one.x; }
void main() { color = vec4(whole(m[1]) + whole(m[k]) + wide(bare[k - 1].d)); }
"""


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
    tap.result("an input that nobody writes", told("a.frag:4:9: error: 'far' : the fragment stage reads `far`, which the") + told("does not write; the vertex stage is /"))
    draw(near, FRAGMENT.format("in vec3 near;", "near.xyzz"))
    tap.result("... or with another type", told("another type than the vertex stage writes"))
    draw(VERTEX.format("noperspective out vec2 near;", "near = vec2(1);"), FRAGMENT.format("in vec2 near;", "near.xyxy"), 430)
    tap.result("... or interpolated otherwise, before GLSL 4.40", told("the vertex stage alone has `near` noperspective"))
    draw(near, "#extension GL_EXT_terminate_invocation : require\nin vec2 near; out vec4 color;\n"
         "void main() { color = near.xyxy; if (gl_FragCoord.x < 1) terminateInvocation; }\n")
    tap.result("a terminated invocation stores nothing", agrees([0, 0, 0, 0]))
    draw(near, "#extension GL_EXT_debug_printf : require\nin vec2 near; out vec4 color;\n"
         "void main() { color = near.xyxy; gl_SampleMask[0] = int(gl_FragCoord.x) * 2 + 4; debugPrintfEXT(\"%d\", 1); }\n")
    tap.result("nor one without a sample", agrees([0, 0, 0, 0]))
    draw(near, "#extension GL_EXT_demote_to_helper_invocation : require\nin vec2 near; out vec4 color;\n"
         "void main() { color = near.xyxy; if (gl_FragCoord.x < 1) demote; color += dFdx(gl_FragCoord.x); }\n")
    tap.result("... nor a demoted one, whose derivatives count", agrees([0, 0, 0, 0]))
    done = diptych("compare", "--spec", "a.yaml", "--sanitize")
    tap.result("... sanitized", [done.stdout] if done.returncode else [])
    put("a.frag", "#version 450\nout vec4 color; uniform float width; uniform vec2 size;\n"
        "void main() { color.rg = size; if (gl_FragCoord.x < 4) color.b = width; else color = vec4(9); }\n")
    with open("a.yaml", "a", encoding="utf-8") as spec:
        spec.write("params: {width: {value: 2, type: float, live: true}}\nvalues: {size: \"vec2(frame.width, width)\"}\n")
    tap.result("what a shader leaves unwritten is zero; a parameter has the name of a frame's member", agrees([8, 2, 2, 0]))
    draw(near, STRUCTS, 330)
    put("a.yaml", DRAW.format(files="a.frag").replace("writes: [color]", "writes: [color], reads: [{name: m_a, sampler: s}, {name: m_b_1, sampler: s}]")
        .replace("images: {", "samplers: {s: {kind: filter, filter: nearest, wrap: clamp}}\nimages: {m_a: {format: rgba8, size: [4, 4], history: true}, m_b_1: {format: rgba8, size: [4, 4], history: true}, ") +
        'values: {m_on: "uint(1u)", m_x: "float(2)", m_y: "vec3(3, 4, 5)", m_light_power: "float(6)", m_z: "float(7)", last: "float(0.5)"}\n')
    tap.result("textures in structs are textures, the rest of the struct numbers", agrees([3, 5, 7, 8]))
    draw(near, CHOSEN, 330)
    names = ["m_n_c_0", "m_n_c_1", "m_n_c_2", "bare_d_0", "bare_d_1"]
    put("a.yaml", DRAW.format(files="a.frag").replace("writes: [color]", f"writes: [color], reads: [{', '.join(f'{{name: {name}, sampler: s}}' for name in names)}]")
        .replace("images: {", "samplers: {s: {kind: filter, filter: nearest, wrap: clamp}}\nimages: {" + "".join(
            f"{name}: {{format: rgba8, size: [{2 << at}, 2], history: true}}, " for at, name in enumerate(names))) +
        'values: {m_n_g: "float[3](1, 2, 4)", m_x: "float[3](16, 32, 64)", k: "int(2)"}\n')
    tap.result("... passed to functions, chosen by an index", agrees([146, 146, 146, 146]))
    put("a.frag", "#version 330\n" + CHOSEN.replace("sampler2D c", "sampler2D c[2]").replace("n.c", "n.c[1]"))
    tap.result("... but not in arrays of both", told("a texture is in arrays of arrays of structs"))
    draw(near, FRAGMENT.format("layout(location = 3) in vec2 near;", "near.xyxy"))
    tap.result("... or elsewhere", told("reads location 3, which the vertex stage does not write"))
    draw(VERTEX.format("out vec2 near; out vec2 far;", "near = far = vec2(1);"),
         FRAGMENT.format("layout(location = 1) in vec2 near; layout(location = 0) in vec2 far;", "vec4(near, far)"))
    tap.result("... or where the fragment stage alone says", told("reads location 1, which the vertex stage does not write"))
    for kind in ("struct S { vec2 a; vec2 b; }; %s S s;", "%s S { vec2 a; vec2 b; } s;"):
        draw(VERTEX.format(kind % "out", "s.a = s.b = vec2(1);"), FRAGMENT.format((kind % "in").replace("vec2 a; vec2 b", "vec2 b; vec2 a"), "vec4(s.a, s.b)"))
        tap.result("... or with members in another order", told("another type than the vertex stage writes"))
    for other, check in ((";", lambda: agrees([0.5, 0.5, 0.5, 1])), ("= 1;", lambda: told("initialize the uniform `k` with different values"))):
        draw(VERTEX.format("uniform float k = 0.5; out vec2 near;", "near = vec2(k);"), FRAGMENT.format("in vec2 near; uniform float k" + other, "vec4(near, k, 1)"))
        tap.result(f"an initializer of one stage, and k{other} in the other", check())


def sanitized(tap):
    compute("layout(local_size_x = 8) in;\nlayout(std430) buffer Sums { uint sums[]; };\n"
            "void main() { sums[gl_GlobalInvocationID.x + gl_WorkGroupSize.y] = 3u; }\n")
    tap.result("an index of a compute shader", told("a.comp:4:", "--sanitize"))
    tap.result("... is found in its invocation", told("index 8 of `Sums`, which has 8 elements\n  pass run, invocation (7, 0, 0), 1 time", "--sanitize"))
    compute("layout(local_size_x = 8) in;\nlayout(std430) buffer Sums { uint sums[]; };\nshared uint part[9];\n"
            "void main() { part[gl_LocalInvocationIndex] = 1u; barrier(); sums[gl_LocalInvocationIndex] = part[gl_LocalInvocationIndex + 1u]; }\n",
            '[8, 1, 1], allow: {content: "the host fills the buffers"}')
    tap.result("... what is allowed of buffers is not allowed of shared variables", told("element 8 of `part` was never written", "--sanitize=content"))
    compute("layout(local_size_x = 8) in;\nlayout(std430) buffer Sums { uint sums[]; };\nvoid main()\n{\n" +
            "".join(f"    sums[{k}] = {k + 1}u / gl_LocalInvocationIndex;\n" for k in range(8)) + "}\n")
    found = diptych("compare", "--spec", "a.yaml", "--sanitize=arithmetic").stdout
    good = found.count("undefined: ") == 5 and "\n3 findings of other operations had no room" in found
    tap.result("lines that look alike take no room from each other; what had none is counted", [] if good else [found])
    for index, word in ((0, ""), (1, "`near` is read before it has a value"), (2, "`gl_ClipDistance` is not written")):
        draw(VERTEX.format("out vec2 near; out float gl_ClipDistance[2];", f"gl_ClipDistance[0] = 1; if (gl_VertexIndex != {index} || {index} == 0) near = vec2(1); if ({index} < 2) gl_ClipDistance[1] = 1;".replace("!= 2", "!= 9")),
             FRAGMENT.format("in vec2 near;", "near.xyxy"))
        found = diptych("compare", "--spec", "a.yaml", "--sanitize").stdout
        tap.result(f"what one vertex does not write: {word or 'nothing'}", [] if found.count("undefined: ") == bool(word) and word in found else [found])
    for members, word in (("pair[1].a = pair[1].b = ", ""), ("pair[1].a = ", "`pair` is read before it has a value")):
        draw(VERTEX.format("out Pair { vec2 a; vec2 b; } pair[2]; layout(location = 9, component = 0) out vec2 low; layout(location = 9, component = 2) out float high;",
                           f"low = pair[0].a = pair[0].b = {members}vec2(high = 1);"),
             FRAGMENT.format("in Pair { vec2 a; vec2 b; } pair[2]; layout(location = 9) in vec2 low; layout(location = 9, component = 2) in float high;",
                             "vec4(pair[0].a, low.x + high, pair[1].b.x)"))
        done = diptych("compare", "--spec", "a.yaml", "--sanitize", "--backend", "gl,vk,gl+glsl")
        good = word in done.stdout and done.stdout.count("undefined: ") == bool(word) == done.returncode
        tap.result(f"arrays of blocks, parts of a location, {word or 'no finding'}", [] if good else [done.stdout])


def modules(tap):
    """Of the shader as GLSL, as a module, and as one without names."""
    compute("#pragma use_vulkan_memory_model\nlayout(local_size_x_id = 5, local_size_y = 2) in;\nlayout(constant_id = 3) const double scale = 2.5LF;\n"
            "layout(constant_id = 5) const uint width = 1;\nshared uint part[gl_WorkGroupSize.x * gl_WorkGroupSize.y];\n"
            "layout(std430, binding = 1) buffer Sums { float sums[]; };\nvoid main()\n{\n    part[gl_LocalInvocationIndex] = gl_WorkGroupSize.x;\n"
            "    barrier();\n    sums[gl_LocalInvocationIndex] = float(scale) + part[gl_WorkGroupSize.x * gl_WorkGroupSize.y - 1u] + part.length() * 16\n        + float(double(gl_LocalInvocationIndex) * 0.0);\n}\n",
            "[2, 2, 1]", "params: {scale: {value: 0.5}, width: {value: 2, type: uint}}", "float")
    bodies.run("glslangValidator", "-V", "a.comp", "-o", "named.spv")
    bodies.run("spirv-opt", "--strip-debug", "named.spv", "-o", "bare.spv")
    with open("a.yaml", encoding="utf-8") as file:
        spec = file.read().replace("dispatch: 8", "dispatch: [2, 2]").replace("count: 8", "count: 4")
    for file, names in (("a.comp", {}), ("named.spv", {}), ("bare.spv", {"scale:": "constant_3:", "width:": "constant_5:",
                                                                          "writes: [Sums]": "writes: [{name: Sums, as: binding_1}]"})):
        text = spec.replace("a.comp", file)
        for old, new in names.items():
            text = text.replace(old, new)
        put("a.yaml", text)
        tap.result(f"constants and sizes of specialization, {file}", agrees([66.5] * 4))
    for value, words in (("2.5, type: float", "has a type without the value 2.5"), ("-1", "has a type without the value -1"), ("2, live: true", "that is neither live nor uniform")):
        put("a.yaml", spec.replace("a.comp", "named.spv").replace("{value: 2, type: uint}", f"{{value: {value}}}"))
        tap.result(f"a constant without a value of its type: {value}", told(words))
    put("a.yaml", spec.replace("a.comp", "named.spv").replace("count: 4", "count: 2"))
    with open("named.txt", "w", encoding="utf-8") as out:
        subprocess.run(["spirv-dis", "named.spv"], stdout=out, check=True)
    with open("named.txt", encoding="utf-8") as file:
        places = [f"named.spv:{number}:" for number, line in enumerate(file, 1) if "OpAccessChain %_ptr_Uniform_float" in line]
    tap.result("a finding has the line of spirv-dis", told(f"{places[0]}", "--sanitize"))


LATER = """layout(local_size_x = 1) in;
struct Pair { vec2 a[2]; float b; };
layout(std140, binding = 2) buffer From { Pair from[2]; };
layout(std430, binding = 3) buffer To { Pair to[2]; };
layout(std430, binding = 1) buffer Sums { float sums[]; };
void main()
{
    Pair own = from[1];
    own.a[1] = vec2(-7.5, 7.5) + own.b;
    to[0] = own;
    vec2 rest = mod(to[0].a[1], vec2(2.0));
    for (int k = 0; k < 4; k++)
        sums[k] = float[](rest.x, rest.y, to[0].b, own.a[1].x)[k];
}
"""
TEXELS = """RWTexture2D<float4> color;
[numthreads(1, 1, 1)] void main(uint3 at : SV_DispatchThreadID) { color[at.xy] = color[at.xy + 1] + fmod(-7.5, float(2 + at.z)); }
"""


def later(tap):
    """What no GLSL becomes: copies between layouts (SPIR-V 1.4), a remainder with the sign of the first, coordinates that are uints."""
    compute(LATER, "1", kind="float")
    bodies.run("glslangValidator", "-V", "--target-env", "vulkan1.2", "a.comp", "-o", "a.spv")
    bodies.run("spirv-dis", "a.spv", "-o", "a.txt")
    with open("a.txt", encoding="utf-8") as file:
        text = file.read()
    put("a.txt", text.replace("OpFMod", "OpFRem"))
    bodies.run("spirv-as", "--target-env", "spv1.5", "a.txt", "-o", "a.spv")
    put("a.yaml", COMPUTE.format(local=1, head="", kind="float", file="a.spv").replace("{Sums: {of: float, count: 8}", "{From: {of: float, count: 24, history: true}, To: {of: float, count: 10, history: true}, Sums: {of: float, count: 4}")
        .replace("dispatch: 8", "dispatch: 1").replace("writes: [Sums]", "writes: [To, Sums], reads: [From]"))
    tap.result(f"{text.count('OpCopyLogical')} copies between layouts, a remainder", agrees([-1.5, 1.5, 0, -7.5]) + [] if "OpCopyLogical" in text else ["no copy"])
    put("a.hlsl", TEXELS)
    bodies.run("glslangValidator", "-D", "-V", "-e", "main", "-S", "comp", "a.hlsl", "-o", "a.spv")
    put("a.yaml", DRAW.replace("frame}", "frame, history: true}").format(files="a.spv").replace("draw: fullscreen", "dispatch: color, local: 1").replace("writes", "updates"))
    tap.result("texels by uints, sanitized", told("texel (8, 1) of `color`, which has 8 x 8 texels", "--sanitize=index"))


WIDTHS = """#extension GL_EXT_shader_explicit_arithmetic_types : require
layout(local_size_x = 8) in;
struct Light { bvec2 on; vec2 at[2]; };
uniform Light lights[2] = Light[](Light(bvec2(true, false), vec2[](vec2(1), vec2(2))), Light(bvec2(false, true), vec2[](vec2(3), vec2(4, 5))));
layout(std140, binding = 3) uniform Push { f16vec2 half_; int8_t byte; u16vec2 both; } push;
layout(std430) buffer Sums { uint sums[]; };
void main()
{
    uint i = min(gl_GlobalInvocationID.x, 3u);
    uint64_t three = uint64_t(0xffffffffu) * 3ul, half_ = uint64_t(float(three) / 4.0);
    uint all[4] = uint[](uint(three), uint(half_ >> 30), uint(lights[1].at[1].y) * 100u + uint(lights[1].on.y && !lights[0].on.y), uint(int(push.byte) + int(push.both.y)));
    sums[gl_GlobalInvocationID.x] = all[i] + uint(three >> (i * 16u)) + uint(push.half_.y * 4.0hf);
}
"""


def widths(tap):
    """Numbers of 8, 16 and 64 bits, and initializers of structs. With `three` = 0x2fffffffd."""
    compute(WIDTHS, head='params: {half_: {value: [0, 0.25], live: true}}\nvalues: {byte: int(-3), both: "uvec2(1, 40000)"}')
    tap.result("shifts of 64 bits, conversions, values of 16 and 8 bits, initializers of arrays of structs",
               agrees([0xfffffffb, 0x30003, 504, 39998], "I"))
    done = diptych("compare", "--spec", "a.yaml", "--sanitize", "--debug")
    tap.result("... sanitized", [] if not done.returncode else [done.stdout])
    if "vk@SwiftShader" in sys.argv:
        tap.result("... of a device that has not all of them", told("missing shaderFloat16", "--backend", "gl,vk@SwiftShader"))
    compute("#extension GL_EXT_shader_explicit_arithmetic_types : require\n#extension GL_EXT_shader_16bit_storage : require\n"
            "layout(local_size_x = 8) in; buffer Sums { i16vec2 sums[]; };\n"
            "void main() { uint i = gl_GlobalInvocationID.x; sums[i / 2][i % 2] = int16_t(i + 1); }\n")
    put("a.yaml", COMPUTE.format(local=8, head="", kind="uint", file="a.comp").replace("count: 8", "count: 4"))
    tap.result("halves of words", agrees([0x20001, 0x40003, 0x60005, 0x80007], "I"))
    done = diptych("compare", "--spec", "a.yaml", "--sanitize=race")
    tap.result("... are no race", [] if not done.returncode else [done.stdout])
    compute("#extension GL_EXT_shader_explicit_arithmetic_types : require\nlayout(local_size_x = 8) in; buffer Sums { uint sums[]; };\n"
            "void main() { uint i = gl_GlobalInvocationID.x; sums[i] = packFloat2x16(f16vec2(vec2(1, float(i) * 2e4))); }\n")
    tap.result("... are halves that are infinite", told("float16_t makes infinity of 80000", "--sanitize"))
    compute("layout(local_size_x = 8) in; layout(binding = 0, offset = 4) uniform atomic_uint n; void main() { atomicCounterIncrement(n); }\n")
    put("a.yaml", COMPUTE.format(local=8, head="", kind="uint", file="a.comp").replace("count: 8", "count: 8, history: true")
        .replace("writes: [Sums]", "updates: [{name: Sums, as: gl_AtomicCounterBlock_0}]"))
    tap.result("an atomic counter", agrees([0, 8, 0, 0], "I"))
    compute("layout(local_size_x = 8) in; layout(r32ui) uniform uimageBuffer Sums; uniform usamplerBuffer From;\n"
            "void main() { int i = int(gl_GlobalInvocationID.x); imageStore(Sums, i, uvec4(i * 3 + imageSize(Sums), 9, 9, 9)); imageAtomicAdd(Sums, i, 1u);\n"
            "uvec4 own = imageLoad(Sums, i); imageStore(Sums, i, own + own.w * 100u + own.yyyy + texelFetch(From, i).wwww + textureSize(From) * 1000u); }\n")
    put("a.yaml", COMPUTE.format(local=8, head="", kind="uint", file="a.comp").replace("buffers: {", "buffers: {From: {of: uvec4, count: 8, history: true}, ").replace("writes", "reads: [From], writes"))
    tap.result("texel buffers", agrees([8109, 8112, 8115, 8118], "I"))


LOOPS = """layout(local_size_x = 8) in;
layout(location = 0) uniform int turns;
layout(std430) buffer Sums { float sums[]; };
float walk(float x) { for (int i = 0; i < turns; i++) x = sin(x) + cos(x) + pow(x * x + 1.0, 0.25); return x; }
float idle(float x) { %s return x; }
void main() { float x = 0.5; %s sums[gl_GlobalInvocationID.x] = x; }
"""


def large(tap):
    """What CPU drivers compile for hours, or never: 28 loops behind each other; many operations."""
    head = "params: {turns: {value: 0, type: int, live: true}}"
    compute(LOOPS % ("", 28 * "x = walk(x); "), head=head, kind="float")
    tap.result("28 loops behind each other compile", agrees([0.5] * 4))
    setting = {key: os.environ.pop(key) for key in ["GALLIVM_PERF"] if key in os.environ}
    for mode, words in ((1, "are not optimized"), (0, "of a branch that a global decides go")):
        compute(f"float mode = {mode};\n" + LOOPS % (1000 * "x = abs(x); ", "if (mode > 0.5) {" + 100 * "idle(x); " + "} x += float(turns);"), head=head, kind="float")
        side = "vk@none" if mode and not os.environ.get("DIPTYCH_LONG") else "vk"  # no device: the driver compiles them for 6 s
        done = diptych("render", "--spec", "a.yaml", "--backend", side, "--dump", "dump")
        good = ("GALLIVM_PERF=nopt" in done.stdout) == bool(mode) and bool(done.returncode) == (side != "vk")
        tap.result(f"100,000 operations {words}", [] if good else [done.stdout])
    os.environ.update(setting)


LIGHTS = """layout(local_size_x = 8) in;
struct Light { vec3 color; float range; vec2 box[2]; };
struct Room { Light lights[3]; mat2x3 turn; bool lit; };
layout(std140, row_major, binding = 0) uniform Block { mat3x2 m; Room room; int grid[2][3]; layout(column_major) mat2 c; Light unused; } block[2];
layout(push_constant) uniform Push { Light own; } push;
layout(std430, binding = 1) buffer Sums { float sums[]; };
void main()
{
    uint i = gl_GlobalInvocationID.x;
    Light own = push.own;
    float all[8] = float[](block[0].m[2][1] + block[1].room.turn[1][2], block[0].room.lights[i & 1].range + block[0].room.lights[2].box[i & 1].y,
                           own.color.z * 100 + own.range * 10 + own.box[1].x, block[1].grid[1][2] + (block[1].room.lit ? 10 : 20) + block[0].c[0][1], 0, 0, 0, 0);
    sums[i] = all[i];
}
"""
LIGHT_VALUES = """params: {own_range: {value: 4, type: float, live: true}}
values:
  m: mat3x2[2](mat3x2(1, 2, 3, 4, 5, 6), mat3x2(0))
  room_lights_range: float[2][3](float[3](10, 20, 30), float[3](0, 0, 0))
  room_lights_box: vec2[2][3][2](vec2[3][2](vec2[2](vec2(0), vec2(0)), vec2[2](vec2(0), vec2(0)), vec2[2](vec2(0), vec2(0, 0.125))), \
vec2[3][2](vec2[2](vec2(0), vec2(0)), vec2[2](vec2(0), vec2(0)), vec2[2](vec2(0), vec2(0))))
  room_turn: mat2x3[2](mat2x3(0), mat2x3(1, 2, 3, 4, 5, 6))
  room_lit: uint[2](0u, 1u)
  grid: int[2][2][3](int[2][3](int[3](0, 0, 0), int[3](0, 0, 0)), int[2][3](int[3](1, 2, 3), int[3](4, 5, 6)))
  c: mat2[2](mat2(1, 2, 3, 4), mat2(0))
  own_color: vec3(1, 2, 3)
  own_box: vec2[2](vec2(1), vec2(5))
"""
LIGHT_NAMES = {"own": "push_0", "room": "Block_1", "m:": "Block_0:", "grid": "Block_2", "c:": "Block_3:", "_lights_range": "_0_1", "_lights_box": "_0_2",
               "_turn": "_1", "_lit": "_2", "_range": "_1", "_color": "_0", "_box": "_2", "Block": "binding_0", "[Sums]": "[{name: Sums, as: binding_1}]"}


def members(tap):
    """Structs and arrays in blocks, with matrices of both orders, have a value for each member."""
    compute(LIGHTS, head=LIGHT_VALUES, kind="float")
    with open("a.yaml", encoding="utf-8") as file:
        spec = file.read()
    bodies.run("glslangValidator", "-V", "a.comp", "-o", "named.spv")
    bodies.run("spirv-opt", "--strip-debug", "-O", "named.spv", "-o", "bare.spv")
    for file in ("a.comp", "named.spv", "bare.spv"):
        text = spec
        for old, new in LIGHT_NAMES.items() if file == "bare.spv" else ():
            text = re.sub(rf"(?<![a-z]){re.escape(old)}", new, text)
        put("a.yaml", text.replace("a.comp", file))
        tap.result(f"members of structs and arrays in blocks, {file}", agrees([12, 20.125, 345, 18]))
    compute("struct A { float b_c; }; struct B { float c; }; uniform A a; uniform B a_b;\nbuffer Sums { float sums[]; };\nlayout(local_size_x = 8) in;\n"
            "void main() { sums[gl_GlobalInvocationID.x] = a.b_c + a_b.c; }\n", head='values: {a_b_c: "float(1)"}', kind="float")
    tap.result("... of one name in a spec", told("two members of the shader's uniforms have the name `a_b_c` in a spec"))


SHAPES_SPEC = """pipeline: tried
images:
  one: {format: rgba32f, size: [8, 8]}
  two: {format: rgba32f, size: [16, 8]}
  color: {format: rgba32f, size: frame}
samplers: {hard: {kind: filter, filter: nearest, wrap: clamp}}
passes:
  - {name: fill, dispatch: two, writes: [one, two], shader: fill.glsl}
  - name: run
    draw: fullscreen
    reads: [{name: one, as: kept}, ONEunder}, TWOmany}, ONEmaps_0}, TWOmaps_1}, TWOmaps_2}, PAIRS]
    writes: [color]
    shader: FILE
""".replace("ONE", "{name: one, sampler: hard, as: ").replace("TWO", "{name: two, sampler: hard, as: ")
FILL = "void main() { ivec2 p = invocation().xy; if (p.x < 8) one_store(p, vec4(1 + p.x, 2, 0, 0)); two_store(p, vec4(3 + p.x, 4, 0, 0)); }\n"


def shapes(tap):
    """Input attachments, samples, arrays of textures and samplers, images that a fragment shader only reads."""
    put("fill.glsl", FILL)
    bodies.run("glslangValidator", "-V", "shapes.frag", "-o", "a.spv")
    pairs = ", ".join(f"{{name: {'two' if t else 'one'}, sampler: hard, as: loose_{t}_nearest_{s}}}" for t in (0, 1) for s in (0, 1))
    for file in ("shapes.frag", "a.spv"):
        put("a.yaml", SHAPES_SPEC.replace("PAIRS", pairs).replace("FILE", file))
        tap.result(f"shapes of textures, {file}", agrees([9, 20, 49, 22]))
    done = diptych("compare", "--spec", "a.yaml", "--sanitize")
    found = sorted(set(re.findall("undefined: (.*)", done.stdout)))
    tap.result("... sanitized: indices that the arrays have not", [] if found == [
        f"index {count} of `{name}`, which has {count} elements" for count, name in ((2, "loose"), (2, "nearest"), (3, "maps"))] else [done.stdout])
    put("a.comp", "#version 450\nlayout(local_size_x = 1) in;\nlayout(rgba32f) coherent uniform image2D maps[2];\n"
        "void main() { imageStore(maps[0], ivec2(0), vec4(1)); imageStore(maps[1], ivec2(0), vec4(2)); }\n")
    put("a.yaml", COMPUTE.format(local=1, head="images: {x: {format: rgba32f, size: [1, 1]}, y: {format: rgba32f, size: [1, 1]}}", kind="float",
        file="a.comp").replace("writes: [Sums]", "writes: [{name: x, as: maps_0}, {name: y, as: maps_1}]").replace("buffers: {Sums: {of: float, count: 8}}\n", ""))
    bodies.run(BUILD + "/diptych-gen", "a.yaml", "-o", "out")
    bodies.run("spirv-dis", "out/vk/tried.run.comp.spv", "-o", "listing")
    with open("listing", encoding="utf-8") as file:
        kept = file.read().count(" Coherent")
    tap.result("elements of an array have its decorations", [] if kept == 2 else [f"{kept} are coherent"])
    deep = "[1]" * 100
    put("a.comp", f"#version 450\nlayout(local_size_x = 1) in;\nlayout(std430) buffer B {{ float v{deep}; }} many[2];\n"
        f"void main() {{ many[1].v{'[0]' * 100} = 2.0; many[0].v{'[0]' * 100} = 1.0; }}\n")
    bodies.run("glslangValidator", "-V", "--amb", "a.comp", "-o", "a.spv")
    put("a.yaml", COMPUTE.format(local=1, head="", kind="float", file="a.spv").replace("Sums: {of: float, count: 8}", "x: {of: float, count: 1}, y: {of: float, count: 1}")
        .replace("writes: [Sums]", "writes: [{name: x, as: many_0}, {name: y, as: many_1}]").replace("dispatch: 8", "dispatch: 1"))
    tap.result("a buffer of an array by a hundred indices", [] if diptych("compare", "--spec", "a.yaml").returncode == 0 else ["differs"])


# What others make of a shader: the last command of each has the module `plain` and writes `made`.
GLSLANG = "glslangValidator -V {name}.comp -o plain.spv"
FORMS = {"glsl": [], "plain": [GLSLANG, "cp plain.spv {name}.spv"],
         "fast": [GLSLANG, "spirv-opt -O plain.spv -o {name}.spv"],
         "small": [GLSLANG, "spirv-opt -Os plain.spv -o {name}.spv"],
         "version": ["glslangValidator -V --target-env spirv1.5 {name}.comp -o plain.spv", "spirv-opt --upgrade-memory-model plain.spv -o {name}.spv"],
         "debug": ["glslangValidator -V -g {name}.comp -o {name}.spv"],
         "stripped": [GLSLANG, "spirv-opt --strip-debug -O plain.spv -o {name}.spv"],
         "shaderc": [GLSLANG, "glslc -O {name}.comp -o {name}.spv"],
         "shaderc, small": [GLSLANG, "glslc -Os -g {name}.comp -o {name}.spv"]}
WHOLE = """#version 450
layout(local_size_x = 1) in;
layout(std140, binding = 0) uniform Numbers {{ float one; float two; float three; float half_; }};
layout(std430, binding = 1) buffer Results {{ float result[]; }};
"""


# spirv-opt divides by a constant as it likes, and makes an undefined value of no `return`; a module lacks the generator's macros.
OPTIMIZED = re.compile("quotient|division|folding|no_return|version_macros|continued_directive")


class Forms(bodies.Bodies):
    """Bodies of the corpus as whole shaders, each in a form."""

    def __init__(self, folder, counts, forms):
        super().__init__(BUILD, folder, counts)
        self.forms = forms

    def spec(self, names, file):
        lines = [bodies.HEAD.format(name=file), "buffers:\n"]
        lines += [f"  out_{name}: {{of: float, count: {self.counts[name]}}}\n" for name in names]
        lines.append("passes:\n")
        for name in names:
            stripped = self.forms[name] in ("stripped", "shaderc")
            values = ", values: {binding_0_0: float(one), binding_0_1: float(two), binding_0_2: float(three), binding_0_3: float(half_)}" if stripped else ""
            lines.append(f"  - {{name: {name}, dispatch: 1, local: 1, writes: [{{name: out_{name}, as: "
                         f"{'binding_1' if stripped else 'Results'}}}], shader: {name}"
                         f".{'comp' if self.forms[name] == 'glsl' else 'spv'}{values}}}\n")
        path = os.path.join(self.folder, f"{file}.yaml")
        with open(path, "w", encoding="utf-8") as out:
            out.writelines(lines)
        return path


def forms(tap):
    seed = int(os.environ.get("SEED", random.SystemRandom().randrange(1 << 20)))
    count = int(os.environ.get("FORMS", "60" if os.environ.get("DIPTYCH_LONG") else "12"))
    print(f"# seed {seed}")
    if not shutil.which("glslc"):
        tap.skip("forms by shaderc", "glslc is not installed")
        FORMS.pop("shaderc"), FORMS.pop("shaderc, small")
    chance = random.Random(seed)
    every = {name: body for name, body in corpus.read(corpus.CORPUS, "").items() if not OPTIMIZED.search(name)}
    drawn = {}
    # spirv-opt makes a value of the last turn of do_while that is used behind the loop
    for name, form in [("do_while", "fast")] + [(name, chance.choice(list(FORMS))) for name in chance.sample(sorted(every), len(every))]:
        with open(os.path.join(corpus.CORPUS, name + ".glsl"), encoding="utf-8") as file:
            put(name + ".comp", WHOLE.format() + "#line 1\n" + file.read())
        try:
            for command in [GLSLANG] + FORMS[form]:
                bodies.run(*command.format(name=name).split())
        except bodies.Failure:
            continue  # a body that needs what the generator declares
        drawn[name] = form
        if len(drawn) == count:
            break
    tap.result(f"{len(drawn)} shaders in {len(FORMS)} forms", [] if len(drawn) == count else ["too few"])
    made = Forms(os.getcwd(), {name: len(every[name].expected) for name in drawn}, drawn)
    for side, exactness in [(side, "exact") for side in sys.argv[1:]] + [(sys.argv[2], "fast")]:
        chosen = list(drawn)[:len(drawn) if "@Swift" not in side or os.environ.get("DIPTYCH_LONG") else 4]  # it keeps nothing it compiled
        try:
            results, reasons = made.render(chosen, side, exactness), []
        except bodies.Failure:
            failed = bodies.guilty(chosen, lambda some, side=side, exactness=exactness: made.render(some, side, exactness))
            reasons = [f"{name}, {drawn[name]}: {text}" for name, text in failed.items()]
            results = made.render([name for name in chosen if name not in failed], side, exactness)
        for name, seen in results.items():
            body = every[name]
            reasons += [f"{drawn[name]}: {text}" for text in body.wrong(seen, side, lambda got, want, body=body: (
                got == want or bodies.ulp(got, want) <= body.ulp > 0 or (
                    exactness == "fast" and (not body.fast or bodies.near(bodies.as_float(got), bodies.as_float(want))))))]
        tap.result(f"they compute what GLSL says, on {side}, {exactness}", reasons)
    made.spec(list(drawn)[:3], "a")
    done = diptych("compare", "--spec", "a.yaml", "--sanitize")
    tap.result("some of them agree when sanitized", [] if f"resources of {min(len(drawn), 3)} passes agree" in done.stdout else [done.stdout])


HLSL_SPEC = """pipeline: tried
params: {room_tint: {value: [0.5, 0.5, 0.5, 0.5], live: true}}
images:
  white: {format: rgba8, size: [4, 4]}
  color: {format: rgba32f, size: frame}
samplers: {soft: {kind: filter, filter: linear, wrap: clamp}}
values: {room_turn: "mat2x3(0, 0, 0, 0, 0, 1)"}
passes:
  - {name: fill, dispatch: white, writes: [white], shader: fill.glsl}
  - name: run
    draw: {vertices: 3}
    reads: [{name: white, as: photo_soft, sampler: soft}, {name: white, as: photo_hard, sampler: soft}]
    writes: [color]
    shader: [v.spv, f.spv]
"""


def hlsl(tap):
    put("fill.glsl", "void main() { if (invocation().x < 4 && invocation().y < 4) white_store(invocation().xy, vec4(1)); }\n")
    put("a.yaml", HLSL_SPEC)
    for form, more in (("HLSL", []), ("... that spirv-opt has not seen", ["-Od"])):
        for stage in ("vert", "frag"):
            bodies.run("glslangValidator", *more, "-D", "-V", "-e", "main", "-S", stage, f"{stage[0]}.hlsl", "-o", f"{stage[0]}.spv")
        tap.result(f"{form}: textures by two samplers, names that GLSL does not have", agrees([14.5625, 14.5625, 14.5, 14.5]))
    tap.result("... sanitized", [] if diptych("compare", "--spec", "a.yaml", "--sanitize").returncode == 0 else ["findings"])


def main():
    tap = bodies.Tap()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        shutil.copytree(FILES, ".", dirs_exist_ok=True)
        if shutil.which("spirv-opt"):
            forms(tap)
            hlsl(tap)
            modules(tap)
            later(tap)
            members(tap)
            shapes(tap)
        else:
            tap.skip("forms of modules", "spirv-opt is not installed")
        stages(tap)
        widths(tap)
        sanitized(tap)
        large(tap)
        os.chdir("/")
    tap.finish()


if __name__ == "__main__":
    main()
