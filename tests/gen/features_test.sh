#!/usr/bin/env bash
# tests/specs/features.yaml uses every feature of the language, and runs on both backends without a line of C. A control: compare
# finds and names a mip that is wrong in one backend.
. "$(dirname "$0")/../lib/tap.sh"
specs=$root/tests/specs
scene=$root/scenes/cornell.yaml

for size in 40x24 17x9 1x1; do
    check "features agree at $size, validation silent" \
        "$diptych" compare --scene "$scene" --spec "$specs/features.yaml" --size $size --frames 3 --debug
done
check "features agree with the conditional pass skipped" \
    "$diptych" compare --scene "$scene" --spec "$specs/features.yaml" --size 17x9 --set blur=false --debug
check "features agree with OpenGL fed GLSL text, from OSMesa" \
    "$diptych" compare --scene "$scene" --spec "$specs/features.yaml" --size 17x9 --glsl --context osmesa

laced() { # backend: places of pixels in classes and in split order are what the reference says
    "$diptych" render --scene "$scene" --spec "$specs/features.yaml" --size 17x9 --backend "$1" --dump "$work/lace_$1" &&
        /usr/bin/python3 -c 'import struct, sys; d = open(sys.argv[1], "rb").read(); assert struct.unpack(f"<{len(d) // 4}f", d)[3::4] == (1,) * 153' \
            "$work/lace_$1"/*.lacing.laced.raw
}
for backend in gl vk; do
    check "interleaved pixels know their class and place, $backend" laced $backend
done

for shrink in true false; do
    check "mips agree with shrink=$shrink" \
        "$diptych" compare --scene "$scene" --spec "$specs/mips.yaml" --size 17x9 --frames 2 --set shrink=$shrink --debug
done
skipped_mips() { # backend: a skipped pass clears only its own mip; pixel (0, 0) shows the smallest mip
    local dump=$work/mips_$1
    "$diptych" render --scene "$scene" --spec "$specs/mips.yaml" --size 17x9 --set shrink=false \
        --backend "$1" --dump "$dump" &&
        cmp "$dump"/*.fill.pyramid.raw "$dump"/*.halve.pyramid.raw &&
        cmp "$dump"/*.halve.pyramid.mip1.raw "$dump"/*.quarter.pyramid.mip1.raw &&
        cmp "$dump"/*.slot_0.resources.raw "$dump"/*.slot_1.resources.raw &&
        [ "$(od -An -tu1 -N4 "$dump"/*.show.picture.raw | xargs)" = "64 128 191 8" ]
}
for backend in gl vk; do
    check "a skipped dispatch clears its own mip alone, $backend" skipped_mips $backend
done

# One image, several names: mips of a bloom in place, layers of an array with history.
check "mips and layers under names of their own agree, validation silent" \
    "$diptych" compare --scene "$scene" --spec "$specs/bloom.yaml" --size 8x8 --frames 3 --debug --backend gl,vk,gl+glsl
in_place() { # backend: mips are means of mips, and sums of filtered ones; in the first frame all layers are mip 2
    local dump=$work/bloom_$1
    "$diptych" render --scene "$scene" --spec "$specs/bloom.yaml" --size 8x8 --backend "$1" --dump "$dump" &&
        /usr/bin/python3 - "$dump" <<'END'
import glob, struct, sys
def image(name, width, height):
    data = open(glob.glob(f"{sys.argv[1]}/*.{name}.raw")[0], "rb").read()
    numbers = struct.unpack(f"<{len(data) // 2}e", data)
    texels = [numbers[i : i + 4] for i in range(0, len(numbers), 4)]
    assert len(texels) % (width * height) == 0, name
    return [texels[i : i + width * height] for i in range(0, len(texels), width * height)]
def near(a, b):
    return all(abs(x - y) <= 0.003 * max(abs(x), abs(y)) for x, y in zip(a, b))
glow, trail = image("up_2.glow.mip2", 16, 12)[0], image("keep.trail", 16, 12)
assert trail == [glow] * 3 and any(any(texel) for texel in glow)
finer, coarser = image("down_twice.glow", 64, 48)[0], image("down_twice.glow.mip3", 8, 6)[0]
for y in range(6):
    for x in range(8):
        block = [finer[64 * (8 * y + j) + 8 * x + i] for j in range(8) for i in range(8)]
        assert near(coarser[8 * y + x], [sum(t[c] for t in block) / 64 for c in range(4)]), (x, y)
# The middle of four texels of a coarser mip: weights 9, 3, 3, 1 of 16.
before, after, added = image("up_2.glow.mip1", 32, 24)[0], image("up_1.glow.mip1", 32, 24)[0], glow
for y in range(1, 23):
    for x in range(1, 31):
        i, j, di, dj = x // 2, y // 2, 1 if x % 2 else -1, 1 if y % 2 else -1
        up = [(9 * added[16 * j + i][c] + 3 * added[16 * j + i + di][c] + 3 * added[16 * (j + dj) + i][c]
               + added[16 * (j + dj) + i + di][c]) / 16 for c in range(4)]
        assert near(after[32 * y + x], [b + u / 2 for b, u in zip(before[32 * y + x], up)]), (x, y)
END
}
for backend in gl vk; do
    check "a bloom in place adds filtered mips to mips, and layers to layers, $backend" in_place $backend
done

# Passes of included files run in their places: each appends its digit. --set reaches the files.
appended() { # number option...
    local want=$1
    shift
    "$diptych" render --scene "$scene" --spec "$specs/parts.yaml" --size 4x4 --backend vk --dump "$work/parts" "$@" &&
        [ "$(od -An -tu4 "$work"/parts/*.four.number.raw | xargs)" = "$want" ]
}
check "an included file's passes come first, or in the place of their entry" appended 1234
check "... and values there are set by their path, or a parameter's name" appended 1574 --set passes.three.defines.DIGIT=7 --set second=5
check_status 1 "... or are refused by an assertion there" appended 1 --set third=10
check "... also with OpenGL" "$diptych" compare --scene "$scene" --spec "$specs/parts.yaml" --size 4x4 --backend gl,vk,gl+glsl
check "the files are known to a dump" grep -q '"parts/third.yaml"' "$work/parts/manifest.json"

# Three instances of a triangle: two side by side, one behind the camera.
/usr/bin/python3 - "$work" <<'PYTHON'
import json, struct, sys
with open(f"{sys.argv[1]}/triangle.bin", "wb") as file:
    file.write(struct.pack("9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
nodes = [{"mesh": 0, "translation": [-2, 0, 0]}, {"mesh": 0, "translation": [1, -1, 0], "scale": [1, 2, 1]},
         {"mesh": 0, "translation": [0, 0, 20]}]
with open(f"{sys.argv[1]}/instances.gltf", "w") as file:
    json.dump({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}], "nodes": nodes,
               "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
               "buffers": [{"uri": "triangle.bin", "byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
               "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                              "min": [0, 0, 0], "max": [1, 1, 0]}]}, file)
PYTHON
cat >"$work/instances.yaml" <<'SCENE'
mesh: instances.gltf
camera: {eye: [0, 0, 5], target: [0, 0, 0], fov_y: 60}
light: {kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1]}
SCENE
objects=(--scene "$work/instances.yaml" --spec "$specs/objects.yaml" --size 160x120)
check "objects are the same on both backends" "$diptych" compare "${objects[@]}" --backend gl,vk,gl+glsl --debug
instances() {
    "$diptych" render "${objects[@]}" --backend vk --dump "$work/objects" || return
    /usr/bin/python3 - "$work/objects" <<'PYTHON'
import array, struct, sys
read = lambda name: open(f"{sys.argv[1]}/{name}.raw", "rb").read()
draws = [struct.unpack_from("5I", read("00.cull.draws"), 20 * i) for i in range(4)]
count, *meshes, triangles = struct.unpack("5I", read("00.cull.told"))
print(draws, count, meshes, triangles)
assert count == 3 and meshes == [0, 0, 0]
(first, second, behind, none), drawn = draws, sum(draw[0] for draw in draws)
assert first[2] == 0 and second[2] == first[0] == 3 and behind[0] == none[0] == 0 and drawn < 3 * triangles
labels, local = array.array("I", read("01.see.label")), array.array("f", read("01.see.local"))
seen = [0, 0]
for i, label in enumerate(labels):
    if label == 99:
        continue
    seen[label] += 1
    x, y, z, w = local[4 * i:4 * i + 4]
    assert (i % 160 >= 80) == (label == 1), i
    assert w == 1 and abs(z) < 1e-5 and min(x, y, 1 - x - y) > -1e-5, (x, y, z)
print(seen)
# 120 texels are 2 * 5 * tan(30 degrees) high; the second is twice the first
area = 0.5 * (120 / 5.7735) ** 2
assert abs(seen[0] - area) < 0.1 * area and abs(seen[1] - 2 * area) < 0.1 * area
PYTHON
}
check "... each with its triangles, its place and its mesh" instances

# A fault in a texel of a mip above 0 that no later pass reads. (bisect_test.sh has faults in buffers, images and layers.)
mkdir -p "$work/mip"
cp "$specs"/mips* "$work/mip/"
cd "$work" || exit 1
sed -i 's/pyramid(p \* 2)/pyramid(p * 2)\n#ifdef VULKAN\n    + (p == ivec2(4, 6) ? vec4(0.5) : vec4(0.0))\n#endif\n    /' mip/mips_halve.glsl
check_status 1 "a fault in mip 1 is found" \
    "$diptych" compare --scene "$scene" --spec "$work/mip/mips.yaml" --size 17x9 --json "$work/mip.json"
cp "$work/output" "$work/table"
check "... its pass and mip are named on the last line" \
    bash -c "tail -n 1 '$work/table' | grep -Fx 'guilty: pass halve (shader mips_halve.glsl): resource pyramid mip 1, in frame 0' || { cat '$work/table'; false; }"
check "... the texel in the table, where the mip alone differs, and no pass that leaves it as it is" \
    bash -c "grep -E '^halve +pyramid mip 1 +1024 +1 +DIFFERS .*\(4, 6\)' '$work/table' && [ \$(grep -c DIFFERS '$work/table') = 1 ]"
check "... and both in the JSON" \
    bash -c "tr -d ' \t\n' <'$work/mip.json' | grep -F '\"first_break\":{\"pass\":\"halve\",\"resource\":\"pyramid\",\"mip\":1,\"frame\":0}'"
check_status 2 "a compare that cannot run says so by its status" \
    "$diptych" compare --scene "$work/absent.yaml" --spec "$specs/features.yaml" --size 17x9
finish
