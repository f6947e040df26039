"""GLSL and SPIR-V that the generator makes of bodies. What glslang gets is compared with tests/gen/golden/glsl_*, and pieces of it
with what the reference promises. All cases are passes of one spec. Prints TAP; called by glsl_test.sh. UPDATE=1 writes the goldens
anew; look at the difference before it is kept."""
import array
import json
import os
import re
import subprocess

import bodies

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
GEN = os.path.join(os.environ.get("DIPTYCH_BUILD", ROOT + "/build"), "diptych-gen")
GOLDENS = ROOT + "/tests/gen/golden/glsl_"

HEAD = """pipeline: small
params:
  nearest: 3
  exposure: {value: 1.0, live: true}
  later: {value: 3, uniform: true}
constants: {half_width: frame.width / 2}
structs:
  Light2: {position: vec3, kind: uint, normal: vec3, flux: vec3}
  Cell: {position: vec3, normal: vec3}
  Wide: {kind: uint, filler: "float[2000]"}
samplers:
  points: {kind: hammersley, count: 64, map: concentric_disk}
  polar: {kind: hammersley, count: 64, map: polar_disk}
  square: {kind: hammersley, count: 64}
  shadow: {kind: filter, filter: linear, compare: true}
  plain: {kind: filter}
metrics: {apart: {position: 0.6, normal: 0.4}}
interleaves: {tile: {x: 4, y: 2}}
buffers:
  lights: {of: Light2, count: 40, history: true}
  many: {of: Light2, count: 4000, history: true}
  wide: {of: Wide, count: 40, history: true}
  cells: {of: Cell, count: "ceil_div(frame.width, 8)", history: true}
images:
  normals: {format: rgba16f, size: frame, history: true}
  shadows: {format: d32f, size: [64, 64], layers: 4, history: true}
  result: {format: rgba32f, size: frame, history: true}
  depth: {format: d32f, size: frame, history: true}
  display: {format: rgba8_srgb, size: frame, history: true}
  color: {format: rgba16f, size: [64, 64], layers: 4}
"""
SHADE = """void main()
{
    ivec2 p = interleave_pixel();
    vec3 n = normals(p).xyz;
    vec3 sum = vec3(0.0);
    for (Light2 v : subset) {
        sum += v.flux * max(dot(n, v.position), 0.0) * float(subset_index + 1);
    }
    sum += vec3(points(0), float(points_count)) * exposure;
    int k = nearest % cells_count;
    sum.x += apart(cells[k].position, cells[k].normal, n, n) + apart(lights[k], cells[k]);
    sum.y += shadows_compare(vec3(0.5, 0.5, 1.0), sum.z) + float(half_width);
    result_store(p, vec4(sum, float(tile_class(p) + result_size().x)));
}
"""
SCENE = """#ifdef VERTEX
layout(location = 0) out vec3 normal;
void main()
{
    normal = vertex_normal;
    gl_Layer = gl_InstanceIndex;
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
    gl_ClipDistance[0] = dot(vertex_normal, view.direction);
}
#else
layout(location = 0) in vec3 normal;
void main()
{
    color = scene_texture(normal.xy, scene_materials[0].texture_layer);
}
#endif
"""
TONE = "void main()\n{\n    display = result(ivec2(gl_FragCoord.xy)) * depth_sample(gl_FragCoord.xy);\n}\n"
STORE = "void main() { for (Light2 v : subset) { result_store(ivec2(v.kind), vec4(0)); } }"
FADD, FDIV, TIMES_SCALAR, PRODUCTS, LOOP_MERGE, DECORATE = 129, 136, 142, (144, 145, 146), 246, 71
NO_CONTRACTION, DONT_UNROLL = 42, 2


def holds(truth, what):
    if not truth:
        raise AssertionError(str(what))


# ---- Passes: (name, body, keys) -----------------------------------------------------------------


def compute(name, body, reads=(), **keys):
    return name, body, {"dispatch": "result", "reads": list(reads), "updates": ["result"], **keys}


def draw(name, body, reads=("result",), **keys):
    return name, body, {"draw": "fullscreen", "reads": list(reads), "updates": ["display"], **keys}


def over(name, body, of="many", count=5, **part):
    """A pass with the range `subset`."""
    return compute(name, body, [of], ranges={"subset": {"of": of, "count": count, **part}})


def shade(name, body, words=(), **keys):
    """The pass of SHADE; `words` are others for what it accesses."""
    names = dict(zip(("normals", "lights", "shadows", "cells", "result"), words))

    def access(name, **more):
        return {"name": name, **({"as": names[name]} if names else {}), **more}
    return name, body, {
        "interleave": "tile", "uses": ["points", "apart", "tile"],
        "reads": [access("normals"), access("lights"), access("shadows", sampler="shadow")],
        "updates": [access("cells"), access("result")],
        "ranges": {"subset": {"of": "lights", "count": 5, "first": "interleave_class() * 5", "storage": "shared"}}, **keys}


GOLDEN = (
    shade("shade", SHADE),
    ("scene", SCENE, {"draw": "scene", "view": "light", "clip_distances": 1, "layers": 4,
                      "reads": ["scene_textures", "scene_materials"], "writes": ["color"]}),
    draw("tone", TONE, ["result", {"name": "depth", "sampler": "plain"}]))

STORE = "void main() { for (Light2 v : subset) { result_store(ivec2(v.kind), vec4(0)); } }\n"
WIDE = STORE.replace("Light2", "Wide")
TRANSFORMS = """void main()
{
    vec4 v = result(ivec2(0));
    mat4x3 m = mat4x3(v.xyz, v.yzw, v.zwx, v.wxy);
    mat3x4 n = transpose(m);
    display = (n * m) * v + n * (m * v) + (v.xyz * m) * (n * m);
}
"""
ARITHMETIC = {
    "add": "void main() { display = result(ivec2(0)) * 2.0 + 1.0; }\n",
    "products": TRANSFORMS,
    "quotients": "void main() { mat2 m = mat2(result(ivec2(0))); display = vec4((m / m)[0], (1.0 / m)[1]); }\n",
    "quotient": "void main() { mat4x3 m = mat4x3(result(ivec2(0)).x); display = (m / 7.0)[0].xyzz; }\n",
}
WORDS = "surface", "heap", "darkness", "places", "sum_of"
RANGES = (  # of five elements; expected: copies of the body, barriers
    ("whole", "many", "shared", "unroll", 5, 1), ("parts", "wide", "shared", "unroll", 5, 6),
    ("rolled", "many", "shared", "roll", 1, 1), ("rolled_parts", "wide", "shared", "roll", 2, 4),
    ("in_place", "many", "buffer", "roll", 1, 0), ("in_place_unrolled", "many", "buffer", "unroll", 5, 0))
LOOPS = {  # statements: for each loop, whether the driver must not unroll it
    "sum += near(i);": "1",
    "sum += float(i) * exposure;": "0",
    "sum += near(i); for (int i = 0; i < 4; i++) sum += float(i);": "10",
    "for (int k = 0; k < 4; k++) sum += near(i + k);": "10",
    "{ kept[i] = near(i); sum += kept[i]; }": "0",
    "{ kept[1] = near(i); sum += kept[1]; }": "1",
}
LOOP = """vec4 near(int i) { return result(ivec2(i)) * result(ivec2(0, i)) + result(ivec2(i, 0)); }
void main() { vec4 sum = vec4(0.0), kept[4]; for (int i = 0; i < 4; i++) %s display = sum; }
"""
BY_WORDS = """void main() { %sfor (Light2 v : subset) { result_store(ivec2(v.kind), vec4(v.flux, v.position.x)); } }
"""


def renamed(text):
    for old, new in zip(("normals", "lights", "shadows", "cells", "result"), WORDS):
        text = text.replace(old, new)
    return text


def all_passes():
    yield from GOLDEN
    for name, body in ARITHMETIC.items():
        yield draw(name, body)
        yield draw(name + "_fast", body, exactness="fast")
    for storage in "shared", "buffer":
        for words in (), WORDS:
            name, body, keys = shade(f"words_{storage}" + "_other" * bool(words), renamed(SHADE) if words else SHADE, words, exactness="fast")
            keys["ranges"]["subset"].update(storage=storage, loop="unroll")
            yield name, body, keys
    for points in "points", "polar", "square":
        for call in ["(1)", "_map(vec2(0.5))"][:1 + (points != "square")]:
            yield compute(points + call[:4].strip("(1)"), f"void main() {{ result_store(ivec2(0), {points}{call}.xyxy); }}\n", uses=[points])
    for name, of, storage, loop, _, _ in RANGES:
        yield over("range_" + name, WIDE if of == "wide" else STORE, of, storage=storage, loop=loop)
    yield over("counted", STORE, count="later + 2", storage="buffer", loop="roll")
    yield over("first", STORE.replace("for", "int start = nearest; for"), first="start", storage="shared")
    yield over("by_words", BY_WORDS % "", "lights", storage="shared")
    yield over("by_elements", BY_WORDS % "result_store(ivec2(9), lights[3].flux.xxxx); ", "lights", storage="shared")
    yield over("taken", "void take(Light2 l) { result_store(ivec2(0), vec4(l.flux, 1)); }\n"
               "void main() { for (Light2 v : subset) { take(v); } }\n", storage="shared")
    for i, statement in enumerate(LOOPS):
        yield draw(f"loop{i}", LOOP % statement)
    # a global variable that is `precise`: glslang declares it inside a function, where it may not be
    yield draw("global", "precise float total = 0.5, other;\nvoid add(float a) { other = a; total += a * other; }\n"
               "void main() { add(2.0); display = result(ivec2(0)) * total; }\n")


# ---- What the generator writes ------------------------------------------------------------------


def generate(folder, passes, *sets):
    os.makedirs(folder)
    for name, body, _ in passes:
        with open(f"{folder}/{name}.glsl", "w", encoding="utf-8") as file:
            file.write(body)
    with open(f"{folder}/small.yaml", "w", encoding="utf-8") as file:
        file.write(HEAD + "passes:\n")
        file.writelines(f"  - {json.dumps({'name': name, **keys, 'shader': name + '.glsl'})}\n" for name, _, keys in passes)
    options = [word for item in sets for word in ("--set", item)]
    return subprocess.run([GEN, "small.yaml", "-o", "out", *options], cwd=folder, capture_output=True, text=True, check=False)


def text_of(name, run="software", backend="vk", stage="comp"):
    with open(f"{run}/out/{backend}/small.{name}.{stage}", encoding="utf-8") as file:
        return file.read()


def opcodes(name, run="software", backend="vk"):
    """Each instruction of a fragment shader: its opcode, and its words."""
    with open(f"{run}/out/{backend}/small.{name}.frag.spv", "rb") as file:
        words = array.array("I", file.read())
    at = 5
    while at < len(words):
        length = words[at] >> 16
        yield words[at] & 0xffff, words[at + 1:at + length]
        at += length


def count(text, what):
    return text.replace(" ", "").count(what.replace(" ", ""))


# ---- Tests --------------------------------------------------------------------------------------


def test_all_is_generated():
    for target, names in ("software", ""), ("gpu", "loop|range_"):
        run = generate(target, [made for made in all_passes() if re.match(names, made[0])], "target=" + target)
        holds(run.returncode == 0, run.stderr)


def test_goldens():
    for name in "shade.comp", "scene.vert", "scene.frag", "tone.vert", "tone.frag":
        found = text_of(*name.split(".")[:1], stage=name.split(".")[1])
        if os.environ.get("UPDATE"):
            with open(GOLDENS + name, "w", encoding="utf-8") as file:
                file.write(found)
        with open(GOLDENS + name, encoding="utf-8") as file:
            wanted = file.read()
        # glslang's preprocessor, which a body with ranges goes through, sets blanks otherwise in each version
        for a, b in zip(found.split("\n"), wanted.split("\n"), strict=True):
            holds(a.replace(" ", "") == b.replace(" ", ""), f"{name}: {a}")


def test_exact_arithmetic_is_not_contracted():
    for name, most in ("add", 2), ("add_fast", 0):
        found = list(opcodes(name))
        holds(sum(code in (FADD, TIMES_SCALAR) for code, _ in found) == 2, name)
        holds(sum(code == DECORATE and words[1] == NO_CONTRACTION for code, words in found) == most, name)


def test_products_with_matrices_are_written_out():
    """They have an order of their own in each driver."""
    for backend in "gl", "vk":
        for name, most in ("products", 0), ("products_fast", 7):
            holds(sum(code in PRODUCTS for code, _ in opcodes(name, backend=backend)) == most, f"{name} {backend}")


def test_matrices_are_divided_without_a_driver():
    for name in "quotients", "quotient":
        for fast in "", "_fast":
            holds(any(code == FDIV for code, _ in opcodes(name + fast)) == bool(fast), name + fast)


def test_other_words_change_nothing_else():
    for storage in "shared", "buffer":
        for backend in "gl", "vk":
            plain, other = (text_of(f"words_{storage}{end}", backend=backend) for end in ("", "_other"))
            plain, other = (re.sub("#line .*", "", text[text.index("binding = 0"):]) for text in (plain, other))
            holds("heap[" in other and other == renamed(plain), f"{storage} {backend}")


def test_disks_alone_have_a_map():
    for name, calls in ("points", "concentric_disk(u)"), ("polar", "polar_disk(u)"), ("square", None):
        holds("_map(" not in text_of(name), name)
        if calls:
            text = text_of(name + "_map")
            holds(f"vec2 {name}_map(vec2 u)\n{{\n    return {calls}" in text and f"vec2 {name}(int k)" not in text, name)


def test_loops_over_ranges_have_the_shape_that_the_plan_says():
    for name, _, storage, loop, copies, barriers in RANGES:
        text = text_of("range_" + name)
        found = count(text, "result_store(ivec2(v.kind)"), count(text, "barrier();"), count(text, "shared "), count(text, "shared uint subset_kind[")
        holds(found == (copies, barriers, *[storage == "shared"] * 2), f"{name}: {found}")
        holds((loop == "unroll" and storage == "shared") <= ("for (" not in text), name)
    text = text_of("range_parts", "gpu")  # a loop over full blocks of two, then the last
    holds((count(text, "result_store(ivec2(v.kind)"), count(text, "for (")) == (3, 1), text)
    text = text_of("range_rolled", "gpu")  # a loop with four per turn, then the last
    for piece, times in (("result_store(ivec2(v.kind)", 5), ("for (int subset_k = 0; subset_k < 4;", 1),
                         ("subset_kind[(subset_k + 3)]", 1), ("subset_kind[4]", 1)):
        holds(count(text, piece) == times, piece)


def test_a_number_of_elements_can_be_read_at_run_time():
    text = text_of("counted")
    for piece in "int subset_count = later + 2;", "subset_index < subset_count;", "result_store(ivec2(v.kind)":
        holds(count(text, piece) == 1, piece)
    generate("seven", [made for made in all_passes() if made[0] == "counted"], "later=5")
    holds(re.sub("#line .*", "", text_of("counted", "seven")) == re.sub("#line .*", "", text), "no literal")


def test_a_copy_follows_its_first_element():
    text = text_of("first")
    start = text[text.index("int start = nearest;"):]
    holds("int subset_first = start;" in start and count(start, "barrier();") == 2, start)


def test_elements_of_uniform_blocks_are_copied_by_words():
    """Of 16 bytes. A Light2 has three: position and kind share the first. The flux of the second light is in the sixth."""
    text = text_of("by_words")
    for piece in ("shared uint subset_words[60];", "if (gl_LocalInvocationIndex < 60u)", "v.kind = uint(subset_words[3]);",
                  *(f"v.{name} = vec3(" + ", ".join(f"uintBitsToFloat(subset_words[{first + i}])" for i in range(3)) + ");"
                    for name, first in (("position", 0), ("flux", 20)))):
        holds(count(text, piece) == 1, piece)
    holds("v.normal" not in text and count(text, "barrier();") == 1, text)
    # OpenGL takes one block for a binding: elements, where the body reads one by its index
    text = text_of("by_elements")
    holds("_quads" not in text and count(text, "uniform lights_block") == 1, text)
    holds("subset_flux[i] = lights[subset_first + i].flux;" in text, text)


def test_whole_elements_are_copied_for_functions():
    holds("shared Light2 subset_cache[5];" in text_of("taken"), "the cache")


def test_long_loops_stay_loops():
    """On CPU drivers, with many reads in each turn. The driver decides about an inner loop, since its limit counts the turns of
    both, and about one whose counter indexes a local array."""
    for i, wanted in enumerate(LOOPS.values()):
        for run in "software", "gpu":
            for backend in "gl", "vk":
                found = "".join("01"[bool(words[2] & DONT_UNROLL)] for code, words in opcodes(f"loop{i}", run, backend) if code == LOOP_MERGE)
                holds(found == (wanted if run == "software" else "0" * len(wanted)), f"loop{i} {run} {backend}: {found}")


def test_wrong_uses_of_ranges_have_one_error_each():
    cases = ("for (Light2 v : subset) { if (v.kind > 0u) break; }", "for (Light2 v : subset) { if (v.kind > 0u) continue; }",
             "for (Light2 v : subset) { return; }", "if (true) { for (Light2 v : subset) { } }", "for (Light2 v : subsett) { }",
             "for (Cell v : subset) { }", "for (Light2 v : subset) ;")
    passes = [over(f"wrong{i}", f"void main() {{ {case} }}\n") for i, case in enumerate(cases)]
    passes.append(over(f"wrong{len(cases)}", "void f() { for (Light2 v : subset) { } } void main() { f(); }\n"))
    told = generate("wrong", passes).stderr
    found = re.findall(r"^(wrong\d)\.glsl.*: error: ", told, re.M)
    holds(sorted(found) == [name for name, _, _ in passes], told)


def test_errors_of_the_compiler_have_the_authors_place():
    told = generate("place", [over("place", "#ifdef FRAGMENT\nnonsense\n#endif\nvoid main()\n{\n    int a = wrong;\n}\n")]).stderr
    holds("place.glsl:6:13: error: 'wrong' : undeclared identifier" in told, told)


if __name__ == "__main__":
    bodies.run_in_folder(globals())
