#!/usr/bin/env bash
# 3D images and cube maps, tests/specs/shapes.yaml: the backends agree, every texel equals its formula, and replay runs a guilty
# pass over them. Atomic functions of images, tests/specs/atomics.yaml: the results equal a count in Python. TAP.
. "$(dirname "$0")/../lib/tap.sh"
spec=$root/tests/specs/shapes.yaml

check "3D images and cubes agree, two frames, validation silent" \
    "$diptych" compare --spec "$spec" --size 64x48 --frames 2 --debug --backend gl,vk,gl+glsl

right() { # backend
    rm -rf "$work/dump"
    "$diptych" render --spec "$spec" --size 64x48 --backend "$1" --dump "$work/dump" -o "$work/picture.png" &&
        /usr/bin/python3 - "$work/dump" <<'PYTHON'
import glob, itertools, struct, sys

def load(name, code, size, channels):
    data = open(glob.glob(f"{sys.argv[1]}/??.{name}.raw")[0], "rb").read()
    numbers = struct.unpack(f"<{len(data) // struct.calcsize(code)}{code}", data)
    texels = {}
    for i, (z, y, x) in enumerate(itertools.product(*(range(n) for n in reversed(size)))):
        texels[x, y, z] = numbers[i * channels : (i + 1) * channels]
    assert len(numbers) == len(texels) * channels, name
    return texels

def near(found, wanted, error):
    assert all(abs(a - b) <= error for a, b in zip(found, wanted)), (found, wanted)

fog = load("fill_fog.fog", "e", (8, 6, 5), 4)
for (x, y, z), texel in fog.items():
    near(texel, (x / 8, y / 6, z / 5, (x ^ y ^ z) & 1), 0.001)
half = load("halve_fog.fog.mip1", "e", (4, 3, 2), 4)
for (x, y, z), texel in half.items():
    at = 2.5 * (z + 0.5) - 0.5 # between two slices
    pairs = [(int(at), 1 - at % 1), (int(at) + 1, at % 1)]
    block = [(fog[2 * x + i, 2 * y + j, k], 0.25 * w) for i in (0, 1) for j in (0, 1) for k, w in pairs]
    near(texel, [sum(w * t[c] for t, w in block) for c in range(4)], 0.01)
for (x, _, _), texel in load("halve_again.fog.mip2", "e", (2, 1, 1), 4).items():
    near(texel, [sum(half[2 * x + i, j, k][c] for i in (0, 1) for j in (0, 1) for k in (0, 1)) / 8 for c in range(4)], 0.001)
for (x, y, z), texel in load("grow.lookup", "f", (3, 3, 3), 1).items():
    assert texel == (x + 3 * y + 9 * z + 1,)

sky = load("mark_face.sky", "e", (8, 8, 6), 4)
for (x, y, face), texel in sky.items():
    assert texel == ((9,) * 4 if face == 3 and 2 <= x < 5 and 2 <= y < 5 else (face / 8, x / 8, y / 8, 1)), (x, y, face, texel)
# Sampled by the direction through its centre, a texel of the next mip is the mean of four of its face.
for (x, y, face), texel in load("halve_sky.sky.mip1", "e", (4, 4, 6), 4).items():
    block = [sky[2 * x + i, 2 * y + j, face] for i in (0, 1) for j in (0, 1)]
    near(texel, [sum(t[c] for t in block) / 4 for c in range(4)], 0.01)
for (x, y, face), texel in load("draw_sky.depths", "f", (8, 8, 6), 1).items():
    assert texel == ((face + 1) / 8,)
for (x, y, layer), texel in load("fill_probes.probes", "B", (4, 4, 12), 4).items():
    source = sky[2 * x, 2 * y, layer % 6]
    near(texel, [*(255 * s / 16 for s in source[:3]), 255 * layer / 12], 0.51)
for (x, y, layer), texel in load("draw_probes.probe_depths", "f", (4, 4, 12), 1).items():
    assert texel == (layer / 16,)
sizes = [texel for _, texel in sorted(load("measure.sizes", "i", (6, 1, 1), 4).items())]
assert sizes[:4] == [(8, 6, 5, 0), (8, 8, 8, 8), (4, 4, 0, 0), (6, 12, 10, 16)], sizes
near(sizes[4], (87, 83, 80, 0), 1)
# On an edge +x and +z count alike: (0 + 4) / 16, and texels 0 and 7 of their rows, rows 3 and 4.
near(sizes[5], (250, 437.5, 437.5, 1000), 4)
# Beyond the edge lies the border, on the edge half of it; a format has its own channels alone.
edges = [texel for _, texel in sorted(load("cross_edges.edges", "f", (6, 1, 1), 4).items())]
near(edges[3], (0.5, 0.5, 0.5, 0.5), 0.002)
assert edges[:3] + edges[4:] == [(0, 0, 0, 0), (0, 0, 0, 1), (1, 1, 1, 1), (1, 0, 0, 1), (1, 0, 0, 0)], edges
PYTHON
}
for backend in gl vk; do
    check "every texel is what its formula says, $backend" right $backend
done

for fault in halve_fog fill_probes; do
    check_status 1 "a fault in $fault is found" "$planted" compare --spec "$spec" --size 64x48 --fault vk:$fault:texel:1 \
        --bisect "$work/$fault"
    check "... and replayed" "$diptych" replay "$work/$fault" --backend gl
done

spec=$root/tests/specs/atomics.yaml
counted() { # backend
    rm -rf "$work/dump"
    "$diptych" render --spec "$spec" --size 8x6 --backend "$1" --dump "$work/dump" -o "$work/picture.png" &&
        /usr/bin/python3 - "$work/dump" <<'PYTHON'
import functools, glob, operator, struct, sys

def load(name, code):
    return [n for n, in struct.iter_unpack(f"<{code}", open(glob.glob(f"{sys.argv[1]}/??.count.{name}.raw")[0], "rb").read())]

tally, ends = load("tally", "I"), load("ends", "i")
for column in range(8):
    mine = range(column, 1000, 8)
    bits = [1 << (i >> 3 & 31) for i in mine if i < 100]
    wanted = [len(mine), min(mine), max(mine), 0xffffffff & ~functools.reduce(operator.or_, bits),
              functools.reduce(operator.or_, bits), functools.reduce(operator.xor, [(i << (i >> 3 & 31)) & 0xffffffff for i in mine])]
    assert tally[column::8] == wanted + [column * (column < 4)], (column, tally[column::8], wanted)
assert load("cells", "I") == [sum(range(i, 1000, 8)) for i in range(8)] + [0, 1, 2, 3]
assert ends[::4] == [-max(range(i, 1000, 6)) if i < 3 else max(range(i, 1000, 6)) for i in range(6)], ends
assert load("once", "I") == [7, 5, 9, 5 + 5 + 5 + 5, 3]
PYTHON
}
for threads in 1 8; do
    check "atomic functions of images agree, $threads threads" \
        env LP_NUM_THREADS=$threads "$diptych" compare --spec "$spec" --size 8x6
done
check "... validation silent" \
    "$diptych" compare --spec "$spec" --size 8x6 --debug --backend gl,vk,gl+glsl
for backend in gl vk; do
    check "... and with counting, $backend" counted $backend
done
finish
