#!/usr/bin/env bash
# Draws, tests/specs/particles.yaml: the backends agree, and every texel of the targets equals the result of a rasterizer of
# axis-aligned squares and of the blend formulas. Formats of few bits, tests/specs/formats.yaml: dispatches and draws write
# the right code for each number. TAP.
. "$(dirname "$0")/../lib/tap.sh"
spec=$root/tests/specs/particles.yaml

for size in 40x24 17x9 1x1; do
    check "draws agree at $size, validation silent" "$diptych" compare --spec "$spec" --size $size --debug --backend gl,vk,gl+glsl
done
check "draws agree without instances, in a viewport beyond the targets" \
    "$diptych" compare --spec "$spec" --size 40x24 --debug --set alive=0 --set shift=60

drawn() { # backend alive shift
    rm -rf "${work:?}/$1"
    "$diptych" render --spec "$spec" --size 40x24 --backend "$1" --set "alive=$2" --set "shift=$3" \
        --dump "$work/$1" -o "$work/$1.png" && /usr/bin/python3 - "$work/$1" "$2" "$3" <<'PYTHON'
import glob, struct, sys
alive, shift = int(sys.argv[2]), int(sys.argv[3])
texels = [(i % 40, i // 40) for i in range(960)]
def image(name, channels=4, code="f"):
    data = open(glob.glob(f"{sys.argv[1]}/*.{name}.raw")[0], "rb").read()
    values = struct.unpack(f"<{len(data) // 4}{code}", data)
    return [values[i : i + channels] for i in range(0, len(values), channels)]
def check(name, found, want):
    for (x, y), texel in zip(texels, found):
        assert texel == tuple(want(x, y)), (name, x, y, texel, want(x, y))
# One layer of blending: s, d, their alphas, the channel.
modes = {
    "over": lambda s, d, sa, da, c: s * (1 if c == 3 else sa) + d * (1 - sa),
    "premultiplied": lambda s, d, sa, da, c: s + d * (1 - sa),
    "added": lambda s, d, sa, da, c: s + d,
    "least": lambda s, d, sa, da, c: min(s, d),
    "largest": lambda s, d, sa, da, c: max(s, d),
    "multiplied": lambda s, d, sa, da, c: s * d,
    "mixed": lambda s, d, sa, da, c: da * sa if c == 3 else d * (1 - s) - s * da,
}
def blend(mode, src, dst):
    return [modes[mode](s, d, src[3], dst[3], c) for c, (s, d) in enumerate(zip(src, dst))]
def fullscreen(mode, x, y):
    dst = [(n & 15) / 16 for n in (x, y, x + y, 3 * x + y)]
    src = [(n & 15) / 16 for n in (5 * x, 3 * y, x ^ y, 7 * x + y)]
    if mode == "largest": # drawn with the mask rb over a clear value of -1
        dst[1] = dst[3] = -1
    result = blend(mode, src, dst)
    if mode == "added": # with the mask rga
        result[2] = dst[2]
    return result
def billboards(mode, x, y):
    color = fullscreen(mode, x, y)
    for i in range(alive):
        left, low, size = i * 5 % 17, i * 7 % 11, 3 + i % 5
        if left <= x < left + size and low <= y < low + size:
            color = blend(mode, [n / 4 for n in (i & 3, i + 1 & 3, i // 2 & 3, 1 + i % 3)], color)
    return color
for mode in modes:
    check(mode, image(f"blend.{mode}"), lambda x, y: fullscreen(mode, x, y))
    if mode != "mixed":
        check(mode, image(f"billboards.{mode}"), lambda x, y: billboards(mode, x, y))
check("tally", image("blend.tally", code="I"), lambda x, y: (x, y, 100, 100))
# Two triangles of instances 0 to 2, and one of instance 5, which centres on the diagonal belong to.
def counted(x, y):
    if not (shift <= x < shift + 20 and 2 <= y < 14 and 4 <= x and y < 8):
        return [0]
    u, v = (x - shift + 0.5) / 20, (y - 2 + 0.5) / 12
    return [6 + (6 if u + v < 1 else 0)]
found = image("count.counted", 1)
for (x, y), (value,) in zip(texels, found):
    on_diagonal = abs((x - shift + 0.5) / 20 + (y - 1.5) / 12 - 1) < 1e-6
    assert [value] == counted(x, y) or (on_diagonal and value in (6, 12)), ("counted", x, y, value)
def depth(x, y): # of one depth, 2^-24 is the unit of the bias
    return 0.5 + (4 * 2**-24 if 4 <= min(x, y) and max(x, y) < 10 else -4 * 2**-24 if max(x, y) < 6 else 0)
check("depth", image("farther.ground_depth", 1), lambda x, y: [depth(x, y)])
def near(a, b):
    assert all(abs(m - n) < 2e-6 for m, n in zip(a, b)), (a, b)
marks = image("strokes.marks")
for (x, y), texel in zip(texels, marks):
    if y in (0, 3, 6) and 1 <= x <= 10:
        assert texel == (0.25,) * 4, ("stroke", x, y, texel)
    elif abs(x - 10) <= 1 and abs(y - 7) <= 1: # a point of 3 texels: the origin is its first row
        near(texel, ((x - 9 + 0.5) / 3, (y - 6 + 0.5) / 3, 1, 0.5))
    elif (x, y) == (30, 20): # a varying of a fullscreen draw
        near(texel, (30.5 / 40, 20.5 / 24, 0, 1))
PYTHON
}
for backend in gl vk; do
    check "every texel is what its formula says, $backend" drawn $backend 9 3
    check "... and with other live parameters" drawn $backend 12 -4
done

# Between the passes of the last frame `render` looks at images. The frame before is recorded whole: its draws, which must set
# their areas one after the other, are in the history.
cat >"$work/areas.yaml" <<'EOF'
pipeline: areas
images:
  kept: {format: rgba8, size: [16, 16], history: true}
  small: {format: rgba8, size: [9, 9]}
  picture: {format: rgba8, size: [16, 16]}
passes:
  - {name: show, dispatch: picture, reads: [kept], writes: [picture], shader: picture.glsl}
  - {name: fill, draw: fullscreen, writes: [kept], shader: kept.glsl}
  - {name: in_scissor, draw: fullscreen, scissor: [2, 3, 5, 6], updates: [kept], blend: add, shader: kept.glsl}
  - {name: in_small, draw: fullscreen, writes: [small], shader: small.glsl}
  - {name: in_viewport, draw: fullscreen, viewport: [4, 4, 5, 6], updates: [kept], blend: add, shader: kept.glsl}
  - {name: in_all, draw: fullscreen, updates: [kept], blend: add, shader: kept.glsl}
output: {display: picture}
EOF
echo 'void main() { picture_store(invocation().xy, kept(invocation().xy)); }' >"$work/picture.glsl"
for target in kept small; do
    echo "void main() { $target = vec4(0.25, gl_FragCoord.xy / 64.0, 1.0); }" >"$work/$target.glsl"
done
whole() {
    local backend
    for backend in gl vk; do
        "$diptych" render --spec "$work/areas.yaml" --size 16x16 --frames 2 --backend "$backend" -o "$work/$backend.png" || return
    done
    cmp "$work/gl.png" "$work/vk.png"
}
check "draws of a frame that is recorded whole have their areas" whole

formats=$root/tests/specs/formats.yaml
check "formats of few bits agree, validation silent" "$diptych" compare --spec "$formats" --size 20x12 --debug --backend gl,vk,gl+glsl
coded() { # backend
    rm -rf "${work:?}/$1"
    "$diptych" render --spec "$formats" --size 20x12 --backend "$1" --dump "$work/$1" -o "$work/$1.png" --show of_rgba16_snorm &&
        /usr/bin/python3 - "$work/$1" <<'PYTHON'
import glob, re, struct, sys
codes = {"": "H", "_snorm": "h", "8ui": "B", "16ui": "H", "8i": "b", "16i": "h", "32i": "i"}
def stored(ending, n):
    return ([1000 * n, n, n + 1, 7] if ending == "" else [250 * n - 10000, n, -n, 7] if ending == "_snorm"
            else [n, n + 1, n + 2, n + 3] if ending.endswith("ui") else [n - 50, -49, -48, -47])
def drawn(ending): # 2.0 is clamped to 1.0
    first = {"8ui": 200, "16ui": 60000, "8i": -100, "16i": -30000, "32i": -2000000000}
    return ([13107, 26214, 65535, 65535] if ending == "" else [-6553, 13107, 32767, 32767] if ending == "_snorm"
            else [first[ending], 1, 2, 3] if ending.endswith("ui") else [first[ending], -1, -2, 3])
count = 0
for pass_name, in_draw in ("store", False), ("draw", True):
    for name, widths in ("r11g11b10f", (11, 11, 10)), ("rgb10a2", (10, 10, 10, 2)):
        data = open(glob.glob(f"{sys.argv[1]}/*.{pass_name}_*.of_{name}.raw")[0], "rb").read()
        for i, (word,) in enumerate(struct.iter_unpack("<I", data)):
            x, y = i % 20, i // 20
            n = x + 3 * y
            inside = in_draw and 2 <= x < 7 and 1 <= y < 7
            if name == "rgb10a2":
                want = [409, 0, 1023, 3] if inside else [10 * n, n, 1023 - n, n % 4]
            else: # the upper bits of a half, without its sign
                want = [struct.unpack("<H", struct.pack("<e", value))[0] >> 15 - width
                        for value, width in zip([0.25, 0, 1.5] if inside else [n, n / 2, n % 32], widths)]
            found = [word >> sum(widths[:c]) & (1 << width) - 1 for c, width in enumerate(widths)]
            assert found == want, (name, x, y, found, want)
        count += 1
    for file in glob.glob(f"{sys.argv[1]}/*.{pass_name}_*.of_*.raw"):
        if "of_r11g" in file or "of_rgb1" in file:
            continue
        channels, ending = re.search(r"\.of_(r|rg|rgba)(?:16)?(|_snorm|8ui|16ui|8i|16i|32i|ui|i)\.raw$", file).groups()
        ending = "16" + ending if ending in ("ui", "i") else ending
        data = open(file, "rb").read()
        found = struct.unpack(f"<{len(data) // struct.calcsize(codes[ending])}{codes[ending]}", data)
        for i in range(240):
            x, y, size = i % 20, i // 20, len(channels)
            inside = in_draw and 2 <= x < 7 and 1 <= y < 7
            want = drawn(ending) if inside else stored(ending, x + 3 * y)
            assert list(found[i * size : (i + 1) * size]) == want[:size], (file, x, y, found[i * size : (i + 1) * size], want)
        count += 1
assert count == 44, count
PYTHON
}
for backend in gl vk; do
    check "every texel has the code of its number, $backend" coded $backend
done

# Culling, tests/specs/cull.yaml: draws of the lists of kept triangles give the pictures of draws of the whole scene.
kept=$root/tests/specs/cull.yaml
check "culled draws agree, validation silent" \
    "$diptych" compare --spec "$kept" --scene "$root/scenes/atrium.yaml" --size 48x27 --debug --backend gl,vk,gl+glsl
check "--set reaches what a draw keeps" "$build/diptych-gen" --check "$kept" --set passes.slice.cull.room=5 --set "passes.slice.test.local=[64,1,1]"
culled() { # backend
    local room
    for room in 45000 300000 1; do
        rm -rf "${work:?}/$room"
        "$diptych" render --spec "$kept" --scene "$root/scenes/atrium.yaml" --size 48x27 --backend "$1" --set "room=$room" \
            --dump "$work/$room" -o "$work/$room.png" || return
    done
    /usr/bin/python3 - "$work" <<'PYTHON'
import glob, struct, sys
def words(room, name, code="I"):
    data = open(glob.glob(f"{sys.argv[1]}/{room}/*.{name}.raw")[0], "rb").read()
    return struct.unpack(f"<{len(data) // 4}{code}", data)
drawn = lambda room, name: words(room, name)[::5] # the number of indices of each draw
assert words(45000, "whole.full") == words(45000, "part.seen") and words(45000, "whole.full_depth") == words(45000, "part.whole.seen_depth")
assert words(45000, "whole_lit.lit_full") == words(45000, "part_lit.3.lit")
assert 0 < drawn(45000, "part_lit.3.draws")[0] != drawn(45000, "part.draws")[0]
scene = max(drawn(1, "slice.whole_draws"))
assert 0 < drawn(45000, "part.draws")[0] < scene and not drawn(45000, "part.whole_draws")[0], scene
assert words(45000, "slice.whole.slices") == words(300000, "slice.whole.slices") == words(1, "slice.whole.slices")
assert len(set(words(1, "slice.whole.slices"))) > 100
assert drawn(300000, "slice.whole_draws") == (0, 0, 0) and drawn(300000, "slice.draws")[2] == 0 # nothing is so high
assert all(0 < n < scene for n in drawn(300000, "slice.draws")[:2]), drawn(300000, "slice.draws")
assert drawn(1, "slice.draws") == (0, 0, 0) and drawn(1, "slice.whole_draws")[:2] == (scene, scene)
assert sorted(drawn(45000, "slice.whole_draws")) != sorted(drawn(45000, "slice.draws"))
PYTHON
}
for backend in gl vk; do
    check "lists of kept triangles draw what the scene draws, $backend" culled $backend
done

# Clear values become the nearest code, a half the even one, on every driver.
cleared() { # backend [option...]
    rm -rf "${work:?}/cleared"
    "$diptych" render --spec "$root/tests/specs/clears.yaml" --size 4x4 --backend "$@" --dump "$work/cleared" -o "$work/cleared.png" &&
        /usr/bin/python3 - "$work/cleared" "$#" <<'PYTHON'
import glob, struct, sys
def codes(name, code):
    data = open(glob.glob(f"{sys.argv[1]}/*.{name}.raw")[0], "rb").read()
    found = struct.unpack(f"<{len(data) // struct.calcsize(code)}{code}", data)
    count = len(found) // 16
    assert found == found[:count] * 16, (name, found)
    return list(found[:count])
half = lambda value: struct.unpack("<H", struct.pack("<e", value))[0]
unorm = lambda value, most: round(min(max(value, -1), 1) * most)
def srgb(value):
    return unorm(12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055, 255)
def small_float(value, bits): # positive, normal
    mantissa, exponent = value.hex()[4:].split("p")
    return (int(exponent) + 15 << bits) + round(int(mantissa, 16) / (1 << 4 * len(mantissa) - bits))
def check(name, found, want):
    assert found == want, (name, found, want)
check("halves", codes("halves", "H"), [half(v) for v in (0.1, 0.3, 0.7, -1.1)])
check("small", codes("small", "H"), [half(v) for v in (1e-7, 3.1e-5, 65503, 65504)])
check("bytes", codes("bytes", "B"), [unorm(v, 255) for v in (0.1, 0.3, 0.7, 1.5)])
check("tens", codes("tens", "I"), [unorm(0.1, 1023) | unorm(0.3, 1023) << 10 | unorm(0.7, 1023) << 20 | unorm(0.6, 3) << 30])
check("eleven", codes("eleven", "I"), [small_float(0.1, 6) | small_float(0.3, 6) << 11 | small_float(0.7, 5) << 22])
check("coded", codes("coded", "B"), [srgb(0.1), srgb(0.3), srgb(0.002), unorm(0.7, 255)])
assert all(abs(found - want) < 0.002 for found, want in zip(codes("seen", "f"), (0.1, 0.3, 0.1, 0.3)))
if sys.argv[2] == "1":
    check("wide", codes("wide", "H"), [unorm(v, 65535) for v in (0.1, 0.3, 0.7, 0.9)])
    check("negative", codes("negative", "h"), [unorm(v, 32767) for v in (0.1, -0.3, 0.7, -2)])
PYTHON
}
. "$root/tests/lib/drivers.sh"
for backend in gl vk@llvmpipe; do
    check "clear values are rounded to the format, $backend" cleared $backend
done
if [ ${#strangers[@]} -gt 0 ]; then # it has no 16-bit codes
    check "... on ${strangers[0]}" cleared "${strangers[0]}" --set images.wide.format=rgba8 --set images.negative.format=rgba8
else
    skip "... on another driver" "$no_strangers"
fi
# Fragments store in images that are no targets: two draws' counts, and what a discarded fragment does not store.
stored() { # backend
    "$diptych" render --spec "$root/tests/specs/marks.yaml" --size 8x8 --backend "$1" --dump "$work/marks" && /usr/bin/python3 - "$work/marks" <<'PYTHON'
import glob, sys
import numpy as np
marks, tint = (np.fromfile(glob.glob(f"{sys.argv[1]}/*store.{name}.raw")[0], kind) for name, kind in (("marks", "u4"), ("tint", "f2")))
y, x = np.mgrid[0:24, 0:32]
left = x % 3 != 1
assert (marks.reshape(12, 16) == 5 + 2 * (x * left).reshape(12, 2, 16, 2).sum((1, 3))).all()
assert (tint.reshape(24, 32, 4) == np.where(left[..., None], np.stack([x, y, 0 * x + 0.25, 0 * x + 1], -1), 0.25)).all()
PYTHON
}
for backend in gl gl+glsl vk ${strangers[0]:+"${strangers[0]}"}; do
    check "fragments store in images, $backend" stored "$backend"
done
check "... and validation is silent" "$diptych" compare --spec "$root/tests/specs/marks.yaml" --size 8x8 --debug

finish
