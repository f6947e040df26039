"""Doors of `import`: what a careless or hostile author may give. A table: files, exit status, words of the message or of the spec.
Nothing is left beside the output folder, and what is imported checks. `import_doors.py DIPTYCH DIPTYCH_GEN TEMPLATES FOLDER`: a third of
the cases, as SEED draws; with DIPTYCH_LONG all."""
import os, random, shutil, struct, subprocess, sys, zlib

DIPTYCH, GEN, TEMPLATES, WORK = map(os.path.abspath, sys.argv[1:5])
Files = dict[str, str | bytes]
CASES: list[tuple[str, Files, int, str]] = []


def case(what: str, files: Files, status: int, words: str = "") -> None:
    CASES.append((what, files, status, words))


def png() -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)) + \
        chunk(b"IDAT", zlib.compress(b"\0abc")) + chunk(b"IEND", b"")


def fragment(declarations: str, value: str = "vec4(1)", output: str = "layout(location = 0) out vec4 shown;") -> str:
    return f"#version 450\n{declarations}\n{output}\nvoid main() {{ {output.split()[-1].rstrip(';').split('[')[0]} = {value}; }}\n"


def slang(fragment_lines: str = "", value: str = "texture(Source, at)", head: str = "") -> str:
    return f"""#version 450
{head}
layout(push_constant) uniform Push {{ vec4 SourceSize; float strength; }} push;
layout(set = 0, binding = 0) uniform Block {{ mat4 MVP; }} block;
#pragma stage vertex
layout(location = 0) in vec4 Position; layout(location = 1) in vec2 TexCoord; layout(location = 0) out vec2 at;
void main() {{ gl_Position = block.MVP * Position; at = TexCoord; }}
#pragma stage fragment
layout(location = 0) in vec2 at; layout(location = 0) out vec4 shown; layout(set = 0, binding = 2) uniform sampler2D Source;
{fragment_lines}
void main() {{ shown = {value}; }}
"""


def preset(lines: str = "", shader: str = slang(), first: str = "") -> Files:
    return {"a.slangp": f"{first}shaders = 1\nshader0 = s.slang\n{lines}", "s.slang": shader, "t.png": png()}


# ---- Names ----------------------------------------------------------------------------------------------------------

for name in ("../up", "a/b", "..", "a:b", "a b", "C:\\\\a", "-", "é"):
    case(f"a picture named {name}", preset(f'textures = "{name}"\n{name} = t.png\n'), 1,
         "is named in no line" if name == "a b" else "a name of a picture is letters, digits and _")
case("a picture that is listed twice", preset("textures = t;u;t\nt = t.png\nu = t.png\n"), 1, "a.slangp:3: textures = t;u;t: a picture stands twice")
case("a picture named picture is not the test card", preset("textures = picture\npicture = t.png\n"), 0, 'file: "lut_picture.png"')
case("a picture whose ending is a path", preset("textures = t\nt = d.x/t\n") | {"d.x/t": png()}, 0, 'file: "lut_t"')
case("an alias of any kind", preset('alias0 = "../x: {y"\n'), 0, '"../x: {y"')
case("a shader with blanks in its name", {"my shader.frag": fragment("")}, 0, '"my_shader.frag"')
case("a file that is included, of an odd name", {"a.frag": fragment('#include "x y.inc"'), "x y.inc": "\n"}, 1, "is no name for a file")
case("... of a folder that only looks like one", {"a.frag": fragment('#include ".../x.inc"'), ".../x.inc": "\n"}, 1, "is no name for a file")
case("... of a folder above", {"sub/a.frag": fragment('#include "x.inc"', "X"), "include/x.inc": "#define X vec4(1)\n"}, 0, 'shader: "a.frag"')
case("... of an absolute path", {"a.frag": fragment('#include "/etc/passwd"')}, 1, "a.frag:2:")
case("... above all folders", {"sub/a.frag": fragment(f'#include "{"../" * 30}x.inc"')}, 1, "a.frag:2:")
case("an address of a buffer", {"a.comp": "#version 450\n#extension GL_EXT_buffer_reference : require\nlayout(buffer_reference) buffer R { uint n; };\n"
     "layout(binding = 0) buffer B { R there; };\nvoid main() { there.n = 1u; }\n"}, 1, "the shader uses addresses of buffers, which OpenGL does not have")
case("... of no file", {"a.frag": fragment('\n#include "x.inc"')}, 1, "a.frag:3:")
case("a sparse texture", {"a.frag": fragment("#extension GL_ARB_sparse_texture2 : require\nuniform sampler2D t;\nvec4 c;",
     "vec4(sparseTextureARB(t, vec2(0.5), c))")}, 1, "the shader uses sparse textures, which OpenGL")

# ---- Tables, counts, sizes ---------------------------------------------------------------------------------------------

case("an array of outputs", {"a.frag": fragment("", "vec4(1)", "layout(location = 0) out vec4 shown[2];").replace("shown =", "shown[1] =")}, 1,
     "a.frag:3:31: error: the output `shown` is an array")
for layout, words in (("location = 8", "has a location above 7"), ("location = 1", "has location 1, but no output has 0"), ("location = 0, index = 1", "or is a second source of blending")):
    case(f"an output at {layout}", {"a.frag": fragment("", output=f"layout({layout}) out vec4 shown;")}, 1, f": error: the output `shown` {words}" if "index" not in layout else words)
case("an input that is a struct", {"a.frag": fragment("struct S { vec4 a; };\nlayout(location = 0) in S given;", "given.a")}, 0, 'given_a: "vec4(gl_FragCoord')
case("... a block", {"a.frag": fragment("layout(location = 0) in S { vec4 a; } given;", "given.a")}, 0, '  a: "vec4(gl_FragCoord')
case("a draw of depth alone", {"a.frag": "#version 450\nvoid main() { gl_FragDepth = 0.5; }\n"}, 0, "depth: {format: d32f, size: frame}")
case("an image that a fragment shader stores in", {"a.frag": fragment("layout(binding = 0, r32ui) uniform uimage2D i;", "vec4(imageAtomicAdd(i, ivec2(0), 1u))")}, 0, "updates: [{name: i, stores: true}]")
case("an array of 17 textures", {"a.frag": fragment("layout(binding = 0) uniform sampler2D t[17];", "texture(t[int(gl_FragCoord.x)], vec2(0))")}, 1, "a.frag:2:39: error: `t` is an array of more than 16, or by an index")
case("a constant of another type keeps its value", {"a.frag": fragment("layout(constant_id = 0) const double n = 3.0LF;", "vec4(float(n))")}, 0, "shown: {")
case("a length by a constant", {"a.comp": "#version 450\nlayout(constant_id = 0) const int N = 5;\nlayout(binding = 0) buffer B { uint sums[N + 1]; };\nvoid main() { sums[0] = N; }\n"}, 0, "updates: [B]\n    shader:")
case("a texture and a sampler that a function takes", {"a.frag": fragment("uniform texture2D near;\nuniform sampler by;\n"
     "vec4 of(texture2D t, sampler s) { if (gl_FragCoord.x < 2) return vec4(0); return texture(sampler2D(t, s), vec2(0.5)); }", "of(near, by)")}, 0, ", sampler: soft")
case("two uniforms of one name", {"a.frag": fragment("layout(binding = 0) uniform A { vec4 c; } a;\nlayout(push_constant) uniform P { float c; } p;", "a.c * p.c")}, 1,
     "error: two uniforms have the name `c`, and other types")
case("two names of one buffer", {"a.comp": "#version 450\nlayout(binding = 1) buffer A { uint a[]; };\nlayout(binding = 1) readonly buffer B { uvec4 b[]; };\nvoid main() { a[0] = b[1].x; }\n"}, 1,
     "a.comp:3:37: error: `B` is the resource that `A` is, by its binding")
case("what a shader reads is a guess", {"a.comp": "#version 450\nlayout(binding = 0, r32ui) uniform uimage2D i;\nvoid main() { imageStore(i, ivec2(gl_GlobalInvocationID), imageLoad(i, ivec2(0))); }\n"}, 0,
     "updates: [i]\n    allow: {content: ")
for shape, words in (("samplerCubeArray", "size: [64, 64], cube: true, layers: 6"), ("sampler1D", "a.frag:2:19: error: `t` is sampler1D, which specs do not have"), ("samplerBuffer", "t: {of: vec4, count: ")):
    case(f"a {shape}", {"a.frag": fragment(f"uniform {shape} t;", "vec4(textureSize(t" + ", 0" * (shape[7] != "B") + ").x)")}, int("error" in words), words)
for name, lines in (("demotion of invocations that write buffers or images, or ask for helpers", "GL_EXT_demote_to_helper_invocation : require\nbuffer B { float b[]; };\nvoid f() { demote; b[0] = 1; }"), ("views", "GL_EXT_multiview : require\nint f() { return gl_ViewIndex; }"),
                    ("stencil references", "GL_ARB_shader_stencil_export : require\nvoid f() { gl_FragStencilRefARB = 1; }"), ("interlocks", "GL_ARB_fragment_shader_interlock : require\n"
                    "layout(pixel_interlock_ordered) in;\nvoid f() {}"), ("SPV_AMD_shader_trinary_minmax", "GL_AMD_shader_trinary_minmax : require\nfloat f() { return min3(gl_FragCoord.x, 2.0, 3.0); }"), ("pixel_center_integer", "all : warn\nlayout(pixel_center_integer) in vec4 gl_FragCoord;\nvec4 f() { return gl_FragCoord; }")):
    case(f"what passes have not: {name}", {"a.frag": fragment(f"#extension {lines}").replace("main() {", "main() { f();")}, 1, f"the shader uses {name}, which ")
case("an input that is interpolated elsewhere", {"a.frag": fragment("layout(location = 0) in vec4 at;", "interpolateAtOffset(at, vec2(0.25))")}, 0, "at: ")
for version in ("# version 450", "/* #version 120 */ #version 450", "// C:\\shaders\\a.frag\n#version 450"):
    case(f"a shader that begins with {version}", {"a.frag": fragment("").replace("#version 450", version)}, 0)
case("... without it", {"a.frag": fragment("").replace("#version 450", "")}, 1, "a.frag:1:1: error: a shader begins with #version")
case("... with a byte of 0", {"a.frag": fragment("") + "\0"}, 1, "a.frag: has a byte of 0")
case("a format that specs have not", {"a.comp": "#version 450\nlayout(rgba8_snorm) uniform image2D sn;\nvoid main() { imageStore(sn, ivec2(0), vec4(0)); }"}, 1, "`sn` is of the format rgba8_snorm, which specs do not have")
case("a double in a struct of a block", {"a.frag": fragment("struct S { vec4 a; double d; };\nlayout(binding = 0) uniform B { S own; };", "own.a + float(own.d)")}, 1, "`own_d` has no value in a spec: its type")
case("... an array", {"a.frag": fragment("layout(location = 0) in vec2 given[3];", "vec4(given[2], 0, 1)")}, 0, "vec2[3](vec2(1), vec2(1), vec2(1))")
case("... a whole number", {"a.frag": fragment("layout(location = 0) flat in uvec3 given;", "vec4(given, 1)")}, 0, "uvec3(1)")
for length in (5000, 400_000_000, 2_147_483_647):
    case(f"a uniform of {length} numbers", {"a.frag": fragment(f"uniform float w[{length}];", "vec4(w[3])")}, 1, "a.frag:2:15: error: the uniform `w` is too long")
case("an array whose length is a constant", {"a.frag": fragment("layout(constant_id = 0) const int n = 3;\nuniform B { float w[n]; };", "vec4(w[2])")}, 0, "float[3](")
case("a buffer of 8 GB", {"a.comp": "#version 450\nlayout(local_size_x = 64) in;\nlayout(binding = 0) buffer B { float w[2000000000]; };\nvoid main() { w[3] = 1; }\n"}, 1,
     "a.comp:3:28: error: the buffer `B` has more than 1 GiB")
case("... of structs of arrays", {"a.comp": "#version 450\nlayout(local_size_x = 64) in;\nstruct S { vec4 a[65536]; };\nlayout(binding = 0) buffer B { S w[65536]; };\nvoid main() { w[3].a[0].x = 1; }\n"}, 1,
     "the buffer `B` has more than 1 GiB")
case("a buffer of a million vectors", {"a.comp": "#version 450\nlayout(local_size_x = 64) in;\nlayout(binding = 0) buffer B { vec4 w[1000000]; };\nvoid main() { w[3].x = 1; }\n"}, 0, "count: 1000000,")
case("an array of an invocation's own of 1 GB", {"a.frag": fragment("float own[268435456];", "vec4(own[int(gl_FragCoord.x)])")}, 1, "the variables of an invocation hold 268435456 numbers")
case("600 uniforms in both stages", {"a.vert": "#version 450\n" + "".join(f"uniform float u{i};\n" for i in range(600)) + "void main() { gl_Position = vec4(" +
     "+".join(f"u{i}" for i in range(600)) + "); }\n", "b.frag": fragment("".join(f"uniform float u{i};\n" for i in range(600)), "vec4(" + "+".join(f"u{i}" for i in range(600)) + ")")}, 0, "u599:")
doubling: Files = {f"x{i}.inc": f'#include "x{i + 1}.inc"\n' * 2 for i in range(26)} | {"x26.inc": "\n"}
case("files that include two others each", {"a.frag": fragment('#include "x0.inc"')} | doubling, 1, "more than 4096 files")
case("... in a preset", preset(shader=slang('#include "x0.inc"')) | doubling, 1, "more than 4096 files are included")
case("... of much text", {"a.frag": fragment('#include "b.inc"\n' * 40), "b.inc": "//" + "x" * 1_000_000 + "\n"}, 1, "more than 16 MiB")
case("a file that includes itself", {"a.frag": fragment('#include "b.inc"'), "b.inc": '#include "b.inc"\n'}, 1, "b.inc")
case("a preset of much text", preset(shader=slang('#include "b.inc"\n' * 40)) | {"b.inc": "//" + "x" * 1_000_000 + "\n"}, 1, "more than 16 MiB")
case("a shader of 17 MB", {"a.frag": fragment("/*" + "x" * 17_000_000 + "*/")}, 1, "a.frag: cannot be read")
for sign in ("+", ",", "*"):
    case(f"60,000 operands of {sign}", {"a.frag": fragment("in float x;", f"vec4(({sign.join(['x'] * 60000)}))")}, 1, "a.frag")
case("100,000 brackets", {"a.frag": fragment("in float x;", "vec4(" + "(" * 100_000 + "x" + ")" * 100_000 + ")")}, 1, "a.frag")

# ---- Numbers --------------------------------------------------------------------------------------------------------

for number in ("1.0 / 0.0", "0.0 / 0.0", "-1e38 * 10"):
    case(f"a constant {number}", {"a.frag": fragment(f"layout(constant_id = 0) const float n = {number};", "vec4(n)")}, 1, "a.frag:2:37: error: the constant `n` is not finite")
for number in ("nan", "inf", "-inf", "1e39", "x"):
    head = f'#pragma parameter strength "s" {number} 0.0 1.0 0.1'
    case(f"a parameter {number}", preset(shader=slang("", "vec4(push.strength)", head)), 1, "s.slang:2: INITIAL")
    head = head.replace(number, "0.5")
    case(f"... of the preset", preset(f"strength = {number}\n", slang("", "vec4(push.strength)", head)), 1, f"a.slangp:3: strength = {number}: a parameter is a finite number")
case("a parameter without a description", preset(shader=slang("", "vec4(push.strength)", '#pragma parameter strength "" 0.5 0.0 1.0')), 0, "strength: {value: 0.5")
for scale in ("85899.34593", "4294967297", "18446744073709551617", "0", "-1", "nan", "1e5", "0.0000001"):
    case(f"a scale {scale}", preset(f"scale_type0 = source\nscale0 = {scale}\n"), 1, f"a.slangp:4: scale0 = {scale}: a scale is a number above 0, at most 1000")
for side in ("-5", "0", "99999999999999", "x"):
    case(f"an absolute size {side}", preset(f"scale_type0 = absolute\nscale0 = {side}\n"), 1, "a.slangp:4:")
case("a scale of many digits", preset("scale_type0 = source\nscale0 = 1.333333333333333333333\n"), 0, "* 13333 + 5000) / 10000")
for history in (65, 1000, 4294967297):
    case(f"frame {history} before", preset(shader=slang(f"layout(set = 0, binding = 3) uniform sampler2D OriginalHistory{history};",
         f"texture(OriginalHistory{history}, at)")), 1, f"s.slang:10:48: error: the texture `OriginalHistory{history}` is more than 64 frames old")
for count in ("0", "129", "-1", "99999999999999999999"):
    case(f"{count} shaders", {"a.slangp": f"shaders = {count}\nshader0 = s.slang\n"}, 1, "a preset has 1 to 128 passes")

# ---- Presets --------------------------------------------------------------------------------------------------------

bom = "\ufeff"
case("a preset behind a byte order mark", preset(first=bom), 0)
case("... its shader", preset(shader=bom + slang()), 0)
case("... a shader alone", {"a.frag": bom + fragment("")}, 0)
case("a preset without shaders", {"a.slangp": "x = 1\n"}, 1, "a.slangp: this preset has no `shaders`")
case("a preset that refers to itself", {"a.slangp": '#reference "a.slangp"\n'}, 1, "a.slangp:1: presets refer to each other")
case("presets that refer to two others each", {f"{'abcdefghijklm'[i]}.slangp": f'#reference "{"abcdefghijklm"[i + 1]}.slangp"\n' * 2 for i in range(12)} |
     {"m.slangp": "x = 1\n"}, 1, "presets refer to each other")
case("a reference to no file", {"a.slangp": '#reference "b.slangp"\n'}, 1, "a.slangp:1: this reference cannot be used: there is no")
case("a reference by the driver's name", preset() | {"a.slangp": '#reference "b-$VID-DRV$.slangp"\n', "b-vulkan.slangp": "shaders = 1\nshader0 = s.$VID-DRV-SHADER-EXT$\n"}, 0)
case("... that is in the file's name", preset() | {"a.slangp": '#reference "b-$SCREEN-ORIENT$.slangp"\n', "b-$SCREEN-ORIENT$.slangp": "shaders = 1\nshader0 = s.slang\n"}, 0)
case("a key that is misspelled", preset("scale_type_0 = source\n"), 0, "a.slangp:3: `scale_type_0` is no key of a preset and no parameter of its shaders; did you mean `scale_type0`?")
case("a key that stands twice, beside a comment and before a reference: the first counts", {"a.slangp": 'scale_type0 = source#viewport\nscale0 = 3.0\nscale0 = 2.0\n#reference "b.slangp"\n',
     "b.slangp": "shaders = 1\nshader0 = s.slang\nscale0 = 4.0\n", "s.slang": slang()}, 0, "pass0_width: Original.width * 3\n")
case("a key of a pass that is not there", preset("wrap_mode7 = repeat\n"), 0)

# ---- Workgroups, uniforms ---------------------------------------------------------------------------------------------

for local in ("local_size_x = 1", "local_size_x_id = 0", "local_size_x = 1, local_size_y = 4"):
    case(f"a workgroup of {local}", {"a.comp": f"#version 450\nlayout({local}) in;\nlayout(binding = 0) buffer B {{ uint w[]; }};\nvoid main() {{ w[gl_GlobalInvocationID.x] = 1; }}\n"}, 0,
         "dispatch: 65535 ")
for entry in ("fill", "main"):
    case(f"... an entry point of HLSL, {entry}, that its attribute tells", {"a.hlsl": f"RWStructuredBuffer<uint> w;\n[numthreads(4, 1, 1)]\nvoid {entry}(uint i : SV_DispatchThreadID) {{ w[i] = i; }}\n"}, 0,
         "local: [4, 1, 1]")
case("... that its semantics tell, in two files", {"a.hlsl": "float4 main(uint i : SV_VertexID) : SV_Position { return i; }\n", "b.hlsl": "float4 main() : SV_Target { return 1; }\n"}, 0,
     'shader: ["a.hlsl.vert.spv", "b.hlsl.frag.spv"]')
case("... but not what links them", {"a.hlsl": "float4 VS(uint i : SV_VertexID, out float x : WIDTH) : SV_Position { return x = i; }\n"
     "float4 PS(float y : TEXCOORD1) : SV_Target { return y; }\n"}, 1, "the pixel shader reads TEXCOORD1, which the vertex shader does not write")
case("a name that C reserves, beside the name that it becomes", {"a.frag": fragment("uniform sampler2D _TEX, TEX;\nlayout(constant_id = 1) const float SIZE_MAX = 0.5;",
     "texture(_TEX, vec2(SIZE_MAX)) + texture(TEX, vec2(0.5))", "layout(location = 0) out vec4 _GLF_color;")}, 0,
     "reads: [{name: TEXp, sampler: soft, as: _TEX}, {name: TEX, sampler: soft}]\n    writes: [{name: GLF_color, as: _GLF_color}]")
case("operations of subgroups", {"a.comp": "#version 450\n#extension GL_KHR_shader_subgroup_vote : require\nlayout(local_size_x = 4) in;\nlayout(binding = 0) buffer B { uint w[]; };\n"
     "void main() { w[gl_LocalInvocationIndex] = uint(subgroupAny(w[0] == 0)); }\n"}, 0, "dispatch: [4, 1, 1]  # one workgroup: none knows which it is\n    local: [4, 1, 1]\n    updates: [B]\n    exactness: fast")
case("a workgroup by the number of another constant", {"a.comp": "#version 450\nlayout(local_size_x_id = 0) in;\nlayout(constant_id = 0) const uint N = 3;\nlayout(binding = 0) buffer B { uint w[]; };\n"
     "void main() { w[gl_GlobalInvocationID.x] = N; }\n"}, 0, "local: [3, 1, 1]")
case("... of a draw", {"a.frag": fragment("#extension GL_KHR_shader_subgroup_vote : require", "vec4(subgroupAny(gl_FragCoord.x < 1))")}, 1, "only a dispatch can have subgroup operations")
case("a stage as a part of a name, a parameter and a constant that are one name in C", {"a.fragment.frag": fragment("uniform uint value;\nlayout(constant_id = 1) const uint VALUE = 2u;", "vec4(value + VALUE)")}, 0,
     'VALUE: {value: 2, type: uint}  # of specialization\nimages:')
case("a buffer of structs has one for each invocation", {"a.comp": "#version 450\nlayout(local_size_x = 8) in;\nstruct S { vec4 a; vec4 b; };\nlayout(binding = 0) buffer B { uint n; S s[]; };\n"
     "void main() { s[gl_GlobalInvocationID.x].b = vec4(n); }\n"}, 0, "count: 524288,")
case("what OpenGL's SPIR-V has not", {"a.comp": "#version 450\n#extension GL_EXT_shared_memory_block : require\nlayout(local_size_x = 4) in;\nlayout(binding = 0) buffer B { uint w[]; };\n"
     "shared S { uint s[]; } s;\nvoid main() { s.s[0] = 1; w[0] = s.s[0]; }\n".replace("s[];", "s[4];")}, 1, "a.comp:5: `shared block` needs a later SPIR-V than OpenGL takes")
case("more textures in structs than a pass can have", {"a.frag": fragment("struct S { sampler2D t; };\nuniform S s[40];", " + ".join(f"texture(s[{i}].t, vec2(0.5))" for i in range(40)))}, 1,
     "has 40 textures; a pass can have 16")
case("names of HLSL that are words of GLSL", {"a.hlsl": "Texture2D<float4> input;\nRWStructuredBuffer<float4> output, buffer;\n[numthreads(1, 1, 1)]\nvoid main() { buffer[0] = output[0] = input[uint2(0, 0)]; }\n"}, 0,
     "updates: [{name: p_buffer, as: buffer}, {name: p_output, as: output}]")
case("a counter of HLSL", {"a.hlsl": "AppendStructuredBuffer<uint> a;\n[numthreads(1, 1, 1)]\nvoid main() { a.Append(1); }\n"}, 0, "updates: [a, a_at_count]")
case("a matrix of integers", {"a.hlsl": "RWStructuredBuffer<int> a;\n[numthreads(1, 1, 1)]\nvoid main() {\n    int2x2 m = 1;\n    a[0] = m[0][0];\n}\n"}, 1,
     "a.hlsl:3:1: error: a matrix of integers or bools, which SPIR-V has not")
case("a module that glslang makes wrong", {"a.hlsl": "RWStructuredBuffer<float2> a;\n[numthreads(1, 1, 1)]\nvoid main() { float2x2 m = 1; a[0] = m._m00_m11; }\n"}, 1,
     "a.hlsl:1:1: error: glslang makes no valid module of this HLSL: spirv-val says: ")
for what, shader, words in (("... by the last function", "struct S { float2 a; };\nfloat half_of(float x) { return x / 2; }\nfloat4 Shade(S s : PLACE) : COLOR0\n{ return half_of(s.a.x); }\n", "shader: "),
                            ("... of names of numbers alone", "int4 main() : SV_TARGET { return 1; }\n", "format: rgba32i"),
                            ("... of a function that returns nothing at times", "float4 main(float x : X) : SV_Target { while (x > 0) return x; }\n", "format: rgba8"),
                            ("a structure between layouts, a buffer as an argument", "struct S { float3 a; float b; };\nStructuredBuffer<S> s;\nRWStructuredBuffer<uint4> w;\n"
                             "float of(StructuredBuffer<S> t, RWStructuredBuffer<uint4> u, int i) { u[i] = i; return t[i].b; }\n"
                             "float4 main() : SV_Target { S own = s[1]; return of(s, w, 2) + own.b; }\n", "reads: [s]")):
    case(f"HLSL {what}", {"a.frag": shader}, 0, words)
case("... whose stage the end of its name tells, without a dot", {"shadePS.hlsl": "float4 Shade(float2 s : PLACE) : COLOR0 { return s.x; }\n"}, 0, "shadePS.hlsl.frag.spv")

case("initializers of uniforms, beside what Vulkan alone has", {"a.frag": fragment("uniform float a = 0.5;\nuniform vec3 b = vec3(0.25, 0.5, 1);\nuniform uvec2 c = uvec2(3u, 4000000000u);\n"
     "layout(push_constant, std430) uniform P { vec4 d; };\nlayout(set = 1, binding = 2) uniform Q { vec4 e; };", "vec4(a * b, c.x + c.y) + d + e")}, 0, """  a: {value: 0.5, type: float, live: true}
  b: {value: [0.25, 0.5, 1], type: vec3, live: true}
  c: {value: [3, 4000000000], type: uvec2, live: true}
""")
for value, status, words in ((";", 0, "  k: {value: 0.5"), ("= 1;", 1, "two uniforms have the name `k`, and other types or initializers")):
    case(f"... of one stage, and k{value} in the other", {"a.vert": "#version 450\nuniform float k = 0.5;\nvoid main() { gl_Position = vec4(k); }\n", "b.frag": fragment(f"uniform float k{value}", "vec4(k)")}, status, words)
case("... of those that no parameter can be", {"a.frag": fragment("uniform mat2 a = mat2(1, 0.5, 0.25, 2);\nuniform float b[2] = float[](1, 2);\nuniform bool c = true;",
     "vec4(a[1], b[1], c)")}, 0, "  c: {value: 1, type: uint, live: true}")
case("... of the members of a struct", {"a.frag": fragment("struct T { int k; };\nstruct S { vec2 a; T b; };\nuniform S s = S(vec2(0.5, 2), T(7));", "vec4(s.a, s.b.k, 1)")}, 0,
     "  s_a: {value: [0.5, 2], type: vec2, live: true}\n  s_b_k: {value: 7, type: int, live: true}")
case("a uniform that is named like a size", {"a.frag": fragment("uniform vec3 iResolution;\nuniform vec2 u_screen_size, texelSize;", "vec4(iResolution / u_screen_size.xyy, texelSize)")}, 0,
     'iResolution: "vec3(frame.width, frame.height, 1)"  # a guess\n  u_screen_size: "vec2(frame.width, frame.height)"  # a guess\n  texelSize: "vec2(1.0 / frame.width, 1.0 / frame.height)"')
case("a texture that is compared", {"a.frag": fragment("uniform sampler2DShadow shadow;", "vec4(texture(shadow, vec3(0.5)))")}, 0, "shadow: {format: d32f")
case("... its sampler", {"a.frag": fragment("uniform sampler2DShadow shadow;", "vec4(texture(shadow, vec3(0.5)))")}, 0, "shadow_: {kind: filter, filter: linear, compare: true,")
case("a texture that one sampler compares, another reads", {"a.frag": fragment("uniform texture2D near;\nuniform samplerShadow by;\nuniform sampler plain;",
     "vec4(texture(sampler2DShadow(near, by), vec3(0.5)) + texture(sampler2D(near, plain), vec2(0.5)))")}, 0, "{name: near_by, sampler: shadow}, {name: near_plain, sampler: soft}")

# ---- Specs that read such shaders -------------------------------------------------------------------------------------


def spec(shader: str, image: str = "d32f", sampler: str = "filter: nearest") -> Files:
    return {"a.yaml": f"""pipeline: a
images: {{near: {{format: {image}, size: [4, 4], history: true}}, shown: {{format: rgba8, size: frame}}}}
samplers: {{by: {{kind: filter, {sampler}}}}}
passes:
  - {{name: run, draw: fullscreen, reads: [{{name: near, sampler: by}}], writes: [shown], shader: a.glsl}}
""", "a.glsl": shader}


compared = fragment("uniform sampler2DShadow near;", "vec4(texture(near, vec3(0.5)))")
case("depths that are compared by a plain sampler", spec(compared), 1, "a.yaml:5:")
case("... as colour", spec(compared, "rgba8"), 1, "`near` compares depths: read an image of format d32f by a sampler with compare: true")
case("... by a sampler that compares", spec(compared, sampler="filter: linear, compare: true"), 0, "1 passes")
case("a plain texture by a sampler that compares", spec(fragment("uniform sampler2D near;", "texture(near, vec2(0.5))"), sampler="filter: linear, compare: true"), 1,
     "`near` is read by a sampler that compares depths")
case("a uniform without a parameter, but an initializer", spec(fragment("uniform sampler2D near;\nuniform float gain = 0.5;", "gain * texture(near, vec2(0.5))")), 0, "1 passes")
case("... without either", spec(fragment("uniform sampler2D near;\nuniform float gain;", "gain * texture(near, vec2(0.5))")), 1, "the shader reads `gain`, which has no value")
for image, shape, words in (("rgba8", "usampler2D", "sampler2D"), ("r32ui", "sampler2D", "usampler2D"), ("rgba8", "sampler2DArray", "sampler2D"), ("rgba8, cube: true", "sampler2D", "samplerCube")):
    case(f"an image of {image} as {shape}", spec(fragment(f"uniform {shape} near;", f"vec4(texture(near, vec{2 + ('Array' in shape)}(0.5)))"), image), 1, f"`near` is {shape}, but the pass binds what is {words}")
case("a target of other numbers", spec(fragment("uniform sampler2D near;", "uvec4(texture(near, vec2(0.5)))", "layout(location = 0) out uvec4 shown;"), "rgba8"), 1, "`shown` holds uints, but its target floats")
many = "".join(f"uniform float u{i};\n" for i in range(1500))
values = "values:\n" + "".join(f'  u{i}: "float(1)"\n' for i in range(1500))
case("a whole shader of 1,500 uniforms", {name: text + values * (name == "a.yaml") for name, text in
     spec(fragment("uniform sampler2D near;\n" + many, "texture(near, vec2(" + "+".join(f"u{i}" for i in range(1500)) + "))")).items()}, 0, "1 passes")
truncated = struct.pack("<5I", 0x07230203, 0x10000, 0, 100, 0)
for what, module in (("no instruction", truncated), ("an instruction of no length", truncated + bytes(8)), ("an instruction that leads out", truncated + struct.pack("<2I", 0xffff0005, 1))):
    case(f"a module of {what}", spec("") | {"a.glsl": module}, 1, "spirv-val says: ")


def run(number: int, what: str, files: Files, status: int, words: str) -> bool:
    folder = f"{WORK}/{number}/in"
    for name, content in files.items():
        os.makedirs(os.path.dirname(f"{folder}/{name}"), exist_ok=True)
        with open(f"{folder}/{name}", "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
    before = sorted(os.listdir(folder))
    given = [name for name in files if name.endswith((".vert", ".frag", ".comp", ".hlsl"))] or ["a.slangp"]
    command = [GEN, "a.yaml", "--check", "--limit", "10", "--templates", TEMPLATES] if "a.yaml" in files else [DIPTYCH, "import", *given, "-o", "../out"]
    done = subprocess.run(["timeout", "60", *command], cwd=folder, capture_output=True, text=True, errors="replace")
    said = done.stderr + done.stdout
    spec = next((f"{WORK}/{number}/out/{name}" for name in os.listdir(f"{WORK}/{number}/out") if name.endswith(".yaml")), "") if not done.returncode and "a.yaml" not in files else ""
    if spec:  # import has checked it
        said += open(spec).read()
    good = done.returncode == status and words in said and sorted(os.listdir(folder)) == before and \
        sorted(os.listdir(f"{WORK}/{number}")) == ["in"] + ["out"] * bool(spec)
    if not good:
        print(f"# status {done.returncode}, expected {status} and `{words}`\n# " + said[:1500].replace("\n", "\n# "))
    shutil.rmtree(f"{WORK}/{number}")
    return good


seed = int(os.environ.get("SEED", random.SystemRandom().randrange(1 << 20)))
drawn = CASES if os.environ.get("DIPTYCH_LONG") else random.Random(seed).sample(CASES, len(CASES) // 3)
failed = [case[0] for number, case in enumerate(drawn) if not run(number, *case)]
print(f"{len(drawn)} of {len(CASES)} cases, seed {seed}, failed: {failed}")
sys.exit(bool(failed))
