"""Small dumps for tests/app/dumps_test.sh, made without diptych: dumps.py FOLDER."""
import json, os, struct, sys, zlib
import numpy as np

os.chdir(sys.argv[1])
rng = np.random.default_rng(1)
depth, radiance, bins = rng.random((6, 8), np.float32), rng.random((6, 8, 3), np.float32) + 1, np.arange(9, dtype=np.uint32)


def arrays(folder, **named):
    os.makedirs(folder)
    for k, (name, array) in enumerate(named.items()):
        np.save(f"{folder}/{k:02d}.{name.replace('__', '.')}.npy", array)


def entry(array, **more):
    return {"pass": "light", "resource": "radiance", "file": "x.raw", "kind": "image", "format": "rgba32f", "width": 8, "height": 6, **more}


def manifest(folder, data, *entries, **more):
    os.makedirs(folder)
    np.ascontiguousarray(data).tofile(f"{folder}/x.raw")
    json.dump({"version": 1, "entries": entries, **more}, open(f"{folder}/manifest.json", "w"))


def png(path, a):
    def chunk(t, d): return struct.pack(">I", len(d)) + t + d + struct.pack(">I", zlib.crc32(t + d))
    raw = b"".join(b"\0" + row.tobytes() for row in a)
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", a.shape[1], a.shape[0], 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def up(a, n): return (a.view(np.uint32) + np.uint32(n)).view(np.float32)


arrays("plain", gbuffer__depth=depth, light__radiance=radiance, count__bins=bins)
arrays("late", gbuffer__depth=depth, light__radiance=radiance[::-1], count__bins=bins + 1)
arrays("more", gbuffer__depth=depth, light__radiance=radiance, light__bloom=radiance, count__bins=bins)
arrays("ulp", gbuffer__depth=up(depth, 1), light__radiance=radiance, count__bins=bins)
arrays("ulp9", gbuffer__depth=depth, light__radiance=up(radiance, 9), count__bins=bins)
holes = depth.copy(); holes[1, 1:3] = np.nan; holes[2, 2] = np.inf
arrays("nan", gbuffer__depth=holes)
signs = np.zeros((6, 8), np.float32)
arrays("zeros", a__b=signs)
arrays("minus", a__b=-signs)
more_holes = holes.copy(); more_holes[4, 4] = np.nan
arrays("nan2", gbuffer__depth=more_holes)
arrays("size", a__b=depth.reshape(1, 6, 8, 1))
arrays("size2", a__b=depth[:, :4].reshape(1, 6, 4, 1))
arrays("half", a__b=depth[::2, ::2].reshape(1, 3, 4, 1))
arrays("alone", other__thing=depth)

rgba = np.concatenate([radiance - 1, np.ones((6, 8, 1), np.float32)], 2)
manifest("wide", rgba, entry(rgba, resource="display"))
os.makedirs("narrow"); png("narrow/light.display.png", np.rint((radiance - 1) * 255).astype(np.uint8))
for name, first in ("on_time", 1), ("late_by_one", 0):  # the same pass again, without numbers of frames
    manifest(name, rgba ** (first + 1), entry(0), entry(0, file="y.raw"))
    (rgba ** (first + 2))[::(-1) ** first].tofile(f"{name}/y.raw")
manifest("top", rgba, entry(rgba, origin="top"))
manifest("bottom", rgba[::-1], entry(rgba), origin="bottom")

# The same in formats that one side packs: codes, stencil behind 24 bits and behind a float, samples.
codes = np.arange(48, dtype=np.uint32).reshape(6, 8) * 349000 + 5
colour = np.rint((radiance - 1) * 255).astype(np.uint8)
stencil, finite = (codes % 7).astype(np.uint32), codes & 0x7fdffbff  # no exponent of ones
bgra = np.concatenate([colour[:, :, ::-1], np.full((6, 8, 1), 255, np.uint8)], 2)
for side, more, other in ("dense", 0, 0), ("dense2", 0, 0), ("dense_depth", 2, 0), ("dense_stencil", 0, 1):
    os.makedirs(side)
    files = {"rgb": (colour, "rgb8"), "zs": (codes + more | stencil + other << 24, "d24s8"), "z": (codes, "d24"), "fs": (np.stack([depth.view(np.uint32), stencil], -1), "d32fs8"),
             "d16": ((codes >> 8).astype(np.uint16), "d16"), "r11": (finite, "r11g11b10"), "ms": (np.stack([codes] * 4), "rgba8")}
    if side != "dense":
        files |= {"rgb": (bgra, "bgra8"), "z": ((codes / 16777215).astype(np.float32), "d32f"), "r11": (finite, "r11g11b10f")}
    for name, (a, _) in files.items():
        np.ascontiguousarray(a).tofile(f"{side}/{name}.raw")
    json.dump({"entries": [{**entry(0), "resource": name, "file": name + ".raw", "format": format, **({"samples": 4} if name == "ms" else {})} for name, (_, format) in files.items()]},
              open(f"{side}/manifest.json", "w"))
points = np.arange(60, dtype=np.float32).reshape(20, 3)
buffer = {"pass": "upload", "resource": "points", "file": "x.raw", "kind": "buffer", "count": 20, "fields": [{"name": "at", "type": "vec3", "offset": 0}]}
manifest("std140", np.pad(points, ((0, 0), (0, 1)), constant_values=7), {**buffer, "stride": 16})
manifest("packed", points, {**buffer, "stride": 12})
fields = [{"name": "weight", "type": "float", "offset": 0}, {"name": "count", "type": "uint", "offset": 4}]
mixed = np.array([(0.5, 3)] * 20, "f4,u4")
manifest("integers", mixed, {**buffer, "stride": 8, "fields": fields})
mixed["f1"][3] = 4
manifest("other_integers", mixed, {**buffer, "stride": 8, "fields": fields})

# Triangle numbers of two halves, and a picture that differs beside their edge alone, or elsewhere too.
ids = np.where(np.arange(8) < 4, 1, 2).astype(np.uint32) * np.ones((6, 1), np.uint32)
edge = depth.copy(); edge[2, 4] += 1
elsewhere = edge.copy(); elsewhere[2, 7] += 1
for name, picture in ("drawn", depth), ("at_edge", edge), ("elsewhere", elsewhere), ("turned", depth[::-1]):
    arrays(name, draw__ids=ids, draw__picture=picture)
flags, distance = np.zeros(9, np.uint32), np.linspace(0, 1, 9).astype(np.float32)
arrays("flags", cull__visible=flags, cull__distance=distance)
flipped = flags.copy(); flipped[1] = 1
arrays("flipped", cull__visible=flipped, cull__distance=distance)
speck = radiance.copy(); speck[0, 0] += 1
arrays("speck", gbuffer__depth=depth, light__radiance=speck, count__bins=bins)
for name, text in {"raster": "picture: {raster: 3%}", "flips": "visible: {flips: 2, margin: distance}", "no_margin": "visible: {flips: 2, margin: distence}",
                   "image": "radiance: {image: {max: 1/255, outliers: 4%}}", "two": "radiance: {ulp: 1, abs: 1}", "share": "radiance: {raster: 300%}"}.items():
    open(name + ".yaml", "w").write(text + "\n")
# Three runs of each side: the second has noise of 1 ulp, and is 0.001 away; later noise grows, then the difference.
for name, noise, away in ("gl", 0, 0), ("vk", 1, 1e-3), ("noisy", 400, 1e-3), ("far", 1, 0.1):
    for k in range(3):
        arrays(f"runs/{name}/{k}", gbuffer__depth=depth, light__radiance=up(radiance, noise * k) + np.float32(away))

# Runs of two versions of one backend: codes, counts, few texels far off, rounding.
for version in range(2):
    for k in range(2):
        folder = f"versions/{version}/{k}"
        os.makedirs(folder)
        codes = np.full((20, 60, 4), 100, np.uint8); codes[3, 3 + k] += 1 + 4 * version
        counts = np.arange(50, dtype=np.uint32); counts[: 3 * version] += 1
        far = np.tile(radiance[:, :, :1], (20, 20, 1))[:100, :100, 0].copy() + np.float32(1e-4 * k); far[7, 7] += np.float32(version)
        near = up(depth, 5 * version)
        entries = []
        for name, a, more in (("codes", codes, {"format": "rgba8"}), ("far", far, {"format": "r32f"}), ("near", near, {"format": "r32f"}),
                              ("counts", counts, {"kind": "buffer", "count": 50, "stride": 4, "fields": [{"name": "", "type": "uint", "offset": 0}]})):
            a.tofile(f"{folder}/{name}.raw")
            entries.append({"pass": "p", "resource": name, "file": name + ".raw", "kind": "image", "width": a.shape[1] if a.ndim > 1 else 1, "height": a.shape[0], **more})
        json.dump({"version": 1, "backend": "gl", "entries": entries}, open(f"{folder}/manifest.json", "w"))

open("loose.yaml", "w").write("default: exact\nlight.radiance: {rel: 1e-5}\n")
open("wrong.yaml", "w").write("default: exact\nradience: {rel: 1e-5}\n")

manifest("no_entries", rgba)
open("no_entries/manifest.json", "w").write('{"entries": 3}')
manifest("no_format", rgba, entry(rgba, format="rgb9"))
manifest("no_file", rgba, entry(rgba, file="y.raw"))
manifest("outside", rgba, entry(rgba, file="../plain/00.gbuffer.depth.npy"))
manifest("long", rgba, entry(rgba, height=7))
manifest("fields", points, {**buffer, "stride": 8})
manifest("version", rgba, entry(rgba), version=2)
os.makedirs("nothing")
os.makedirs("link"); os.symlink("../plain/00.gbuffer.depth.npy", "link/gbuffer.depth.npy")
os.makedirs("fortran"); np.save("fortran/gbuffer.depth.npy", np.asfortranarray(depth))
arrays("short", gbuffer__depth=depth)
os.truncate("short/00.gbuffer.depth.npy", 200)
arrays("bool16", gbuffer__depth=depth > 0.5)
header = open("bool16/00.gbuffer.depth.npy", "rb").read().replace(b"|b1", b"<b2")
open("bool16/00.gbuffer.depth.npy", "wb").write(header)

big = rng.random((1024, 1024), np.float32)
arrays("big", a__b=big)
arrays("other_big", a__b=rng.random((1024, 1024), np.float32))
