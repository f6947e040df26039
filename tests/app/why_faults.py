#!/usr/bin/env python3
"""Plants faults in dumps made with NumPy alone, and holds that `diptych compare A B` names them first.

    why_faults.py DIPTYCH FOLDER      prints those that are not named, and "N of M named first"
"""
import json, os, subprocess, sys
import numpy as np

W, H = 90, 61
y, x = np.mgrid[0:H, 0:W].astype(np.float32)
rng = np.random.default_rng(3)
f32, f16, u8 = np.float32, np.float16, np.uint8


def picture(channels=3, w=W, h=H, seed=0):
    """Smooth shapes with edges and some noise, 0..1."""
    r = np.random.default_rng(seed)
    v, u = np.mgrid[0:h, 0:w].astype(f32)
    planes = [(0.5 + 0.4 * np.sin(u / (4 + k) + seed) * np.cos(v / (6 + 2 * k))) * (0.6 + 0.4 * ((u + 2 * v) // 17 % 2)) for k in range(channels)]
    a = np.stack(planes, -1) * 0.9 + 0.08 * r.random((h, w, channels), f32)
    return np.clip(a, 0.002, 0.998).astype(f32)


light = picture() * 3
display = (picture() * 255 + 0.5).astype(u8)
rgba = picture(4)
depth = (1 / (1 + x / 20 + y / 9)).astype(f32)
normal = picture(3, seed=4) * 2 - 1
ids = (x // 7 + 13 * (y // 5)).astype(np.uint32)
layers = np.stack([picture(4, 24, 20, k) for k in range(6)])
bones = rng.random((40, 4, 4), f32)
cells = rng.random((200,), f32)
points = rng.random((120, 3), f32)
background = np.where((x - 40) ** 2 + (y - 30) ** 2 < 400, depth, 1).astype(f32)


def srgb(v): return np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)
def code(v): return (np.clip(v, 0, 1) * 255 + 0.5).astype(u8)
def edge(a, mask, value): b = a.copy(); b[mask] = value; return b
def box2(a): h, w = a.shape[0] // 2 * 2, a.shape[1] // 2 * 2; m = a[:h, :w].reshape(h // 2, 2, w // 2, 2, -1).mean((1, 3)); b = a.copy(); b[:h, :w] = np.repeat(np.repeat(m, 2, 0), 2, 1).reshape(h, w, -1); return b.astype(a.dtype)


def pitched(a, pitch):
    wide = np.zeros((a.shape[0], pitch) + a.shape[2:], a.dtype)
    wide[:, :a.shape[1]] = a
    return wide.reshape(-1, *a.shape[2:])[:a.shape[0] * a.shape[1]].reshape(a.shape)


def skewed(a, pad):
    """RGB rows padded to bytes, read without the padding."""
    rows = a.reshape(a.shape[0], -1)
    wide = np.zeros((rows.shape[0], rows.shape[1] + pad), a.dtype)
    wide[:, :rows.shape[1]] = rows
    return wide.ravel()[:a.size].reshape(a.shape)


def bfloat(a): return (a.view(np.uint32) + 0x7fff + (a.view(np.uint32) >> 16 & 1) & 0xffff0000).view(f32)
def half_texel(a, axis): return ((a.astype(f32) + np.roll(a, -1, axis).astype(f32)) / 2).astype(a.dtype)
def projection(m): b = m.copy(); b[:, :, 2] = (m[:, :, 2] + m[:, :, 3]) / 2; return b


noise = rng.random((H, W), f32)
tile = (x // 16 + y // 16).astype(int) % 4 == 0
twice = np.concatenate([points, np.zeros((120, 1), f32)], 1)
near, far = 0.1, 50.0
linear = (near + (far - near) * picture(1)[:, :, 0] ** 2).astype(f32)
hyperbolic = (far / (far - near) - far * near / (far - near) / linear).astype(f32)
cleared = edge(light, (x > 30) & (y > 20) & (x < 70), 0)

# name of the fault, first side, second side
FAULTS = [
    ("flip_y", display, display[::-1]), ("flip_y", depth, depth[::-1]), ("flip_y", layers, layers[:, ::-1]),
    ("mirror_x", light, light[:, ::-1]), ("turn", light, light[::-1, ::-1]),
    ("axes", picture(3, 64, 64), picture(3, 64, 64).transpose(1, 0, 2).copy()),
    ("quarter_turn", picture(3, 64, 64), np.rot90(picture(3, 64, 64)).copy()),
    ("reversed", cells, cells[::-1].copy()),
    ("layer", layers, np.roll(layers, 1, 0)), ("layers_reversed", layers, layers[::-1]), ("faces", layers, layers[[0, 1, 3, 2, 4, 5]]),
    ("shift_x", light, np.roll(light, 1, 1)), ("shift_x", display, np.roll(display, -1, 1)), ("shift_y", light, np.roll(light, 1, 0)),
    ("shift_xy", light, np.roll(light, (1, 1), (0, 1))), ("shift_2x", depth, np.roll(depth, 2, 1)), ("shift_x", cells, np.roll(cells, 1)),
    ("half_texel_x", light, half_texel(light, 1)), ("half_texel_y", display, half_texel(display, 0)), ("half_texel_xy", light, half_texel(half_texel(light, 0), 1)),
    ("roll", picture(2, 64, 64), np.roll(picture(2, 64, 64), (32, 32), (0, 1))),
    ("pitch", display, pitched(display, 128)), ("pitch", light, pitched(light, 96)), ("pitch", display, skewed(display, 2)), ("pitch", depth, pitched(depth, 256)),
    ("red_blue", display, display[:, :, ::-1].copy()), ("red_blue", rgba, rgba[:, :, [2, 1, 0, 3]]), ("channels", rgba, rgba[:, :, [3, 0, 1, 2]]),
    ("channels", display, display[:, :, [1, 0, 2]]), ("channels", picture(2), picture(2)[:, :, ::-1].copy()), ("grey", light, np.repeat(light[:, :, :1], 3, 2)),
    ("alpha_lost", rgba, np.concatenate([rgba[:, :, :3], np.ones((H, W, 1), f32)], 2)), ("premultiplied", rgba, np.concatenate([rgba[:, :, :3] * rgba[:, :, 3:], rgba[:, :, 3:]], 2)),
    ("premultiplied", code(rgba), code(np.concatenate([rgba[:, :, :3] * rgba[:, :, 3:], rgba[:, :, 3:]], 2))), ("alpha_inverted", rgba, np.concatenate([rgba[:, :, :3], 1 - rgba[:, :, 3:]], 2)),
    ("channel_negated", normal, normal * np.array([1, -1, 1], f32)), ("channel_negated", points - 0.5, (points - 0.5) * np.array([1, 1, -1], f32)),
    ("channel_inverted", display, np.stack([display[:, :, 0], 255 - display[:, :, 1], display[:, :, 2]], -1)),
    ("transposed", bones, bones.transpose(0, 2, 1).copy()), ("transposed", bones[:, :3, :3].copy(), bones[:, :3, :3].transpose(0, 2, 1).copy()),
    ("matrix_y", bones, bones * np.array([1, -1, 1, 1], f32)), ("matrix_z", bones, projection(bones)),
    ("layout", twice.ravel(), np.concatenate([points.ravel(), np.zeros(120, f32)])), ("layout", np.concatenate([cells, np.zeros(600, f32)]), np.stack([cells] + [np.zeros(200, f32)] * 3, -1).ravel()),
    ("stride", points, np.pad(points, ((0, 0), (0, 2))).ravel()[:360].reshape(120, 3)),
    ("srgb", light / 3, srgb(light / 3)), ("srgb", display, code(srgb(display / 255))), ("srgb", code(srgb(srgb(rgba))), code(srgb(rgba))), ("gamma", light, (light ** (1 / 2.2)).astype(f32)),
    ("depth_range", depth, depth * 2 - 1), ("depth_reversed", depth, 1 - depth), ("depth_reversed", depth, 1 - 2 * depth), ("depth_linear", linear, hyperbolic), ("negated", -linear, linear),
    ("half", light, light.astype(f16).astype(f32)), ("unorm8", rgba, np.rint(rgba * 255) / f32(255)), ("unorm8", rgba, np.floor(rgba * 255) / f32(255)), ("unorm10", rgba, np.rint(rgba * 1023) / f32(1023)),
    ("unorm16", rgba, np.rint(rgba * 65535) / f32(65535)), ("bfloat16", light, bfloat(light)), ("clamped", light, np.minimum(light, 1)), ("clamped", normal, np.maximum(normal, 0)),
    ("factor", light, light * f32(0.31831)), ("factor", code(rgba), code(rgba * 0.7)), ("offset", light, light + f32(0.05)), ("tone", light, light / (1 + light)), ("integer", light * 9, np.rint(light * 9)),
    ("half_rate", light, box2(light)), ("byte_order", cells, cells.byteswap()), ("wrapped", ids * 3, ids * 3 % 256),
    ("order", points, points[rng.permutation(120)]), ("nan", light, edge(light, noise < 0.02, np.nan)), ("uninitialised", cells, edge(cells, slice(50, 90), np.uint32(0xcdcdcdcd).view(f32))),
    ("uninitialised", ids, edge(ids, noise < 0.1, 0xdeadbeef)), ("coverage", background, np.where(background == 1, f32(0.5) + depth / 3, 1).astype(f32)),
    ("border", light, edge(light, y == H - 1, 0.1)), ("border", ids, edge(ids, (x == W - 1) | (y == H - 1), 0)), ("border", display, edge(display, (x == 0) | (y == 0) | (x == W - 1) | (y == H - 1), 7)),
    ("border", depth, edge(depth, x == 0, 0.9)), ("rest", ids, edge(ids, (x >= 80) | (y >= 48), 0)), ("tile_edges", light, edge(light, (x % 16 == 0) & (noise < 0.7), 0.3)),
    ("tile_edges", depth, edge(depth, ((x % 32 == 0) | (y % 32 == 0)), 0.3)), ("tiles", light, np.where(tile[:, :, None], light * f32(0.3) + noise[:, :, None], light)), ("clear", cleared, np.where(cleared == 0, picture(3, seed=9), cleared)),
    ("flip_y", display, display[::-1, :, ::-1]), ("mirror_x", light / 3, srgb(light / 3)[:, ::-1]), ("flip_y", depth, (1 - depth)[::-1]),
    ("srgb", rgba, np.concatenate([srgb(rgba[:, :, :3]), rgba[:, :, 3:]], 2)), ("srgb", code(rgba), code(np.concatenate([srgb(rgba[:, :, :3]), rgba[:, :, 3:]], 2))),
    ("factor", rgba, rgba * np.array([2, 2, 2, 1], f32)), ("factor", display, code(display / f32(255) * 2)), ("offset", ids, ids + 5), ("tone", rgba * 4, np.concatenate([rgba[:, :, :3] * 4 / (1 + rgba[:, :, :3] * 4), rgba[:, :, 3:] * 4], 2)),
    ("layer_alone", layers, edge(layers, 5, 0.25 + layers[5] * layers[4])),
]


def frames(folder, late):
    """A manifest with three frames, and mips; one side shows the frame before."""
    os.makedirs(folder)
    entries = []
    for frame in range(3):
        name = f"history.{frame}.raw"
        picture(4, seed=5 + frame - late).tofile(f"{folder}/{name}")
        entries.append({"pass": "taa", "resource": "history", "frame": frame, "file": name, "kind": "image", "format": "rgba32f", "width": W, "height": H})
    json.dump({"version": 1, "entries": entries}, open(f"{folder}/manifest.json", "w"))


def mips(folder, off):
    os.makedirs(folder)
    chain, entries = [picture(4, 64, 64)], []
    for mip in range(3):
        chain.append(chain[-1].reshape(32 >> mip, 2, 32 >> mip, 2, 4).mean((1, 3)).astype(f32))
    for mip in range(3):
        a = chain[mip]
        if off and mip == 1:
            a = np.repeat(np.repeat(chain[2], 2, 0), 2, 1)
        a.tofile(f"{folder}/m{mip}.raw")
        entries.append({"pass": "chain", "resource": "bloom", "mip": mip, "file": f"m{mip}.raw", "kind": "image", "format": "rgba32f", "width": 64 >> mip, "height": 64 >> mip, "layers": 1, "stride": 16})
    json.dump({"entries": entries}, open(f"{folder}/manifest.json", "w"))


def pair(folder, a, b):
    for side, array in (("a", a), ("b", b)):
        os.makedirs(f"{folder}/{side}")
        np.save(f"{folder}/{side}/00.first.same.npy", depth)
        np.save(f"{folder}/{side}/01.second.result.npy", np.ascontiguousarray(array))


def ask(diptych, folder):
    done = subprocess.run([diptych, "compare", f"{folder}/a", f"{folder}/b", "--json", f"{folder}/json"], capture_output=True, text=True)
    if done.returncode != 1:
        return done.stdout + done.stderr, []
    result = json.load(open(f"{folder}/json"))
    guilty = result["guilty"]
    if "fault" in folder and (guilty["pass"], guilty["resource"]) != ("second", "result"):
        return f"guilty {guilty}", []
    return done.stdout, [w["name"] for r in result["results"] for w in r.get("why", [])]


def main(diptych, out):
    named = 0
    plants = []
    for k, (name, a, b) in enumerate(FAULTS):
        pair(f"{out}/fault{k}", a, b)
        plants.append((name, f"{out}/fault{k}"))
    for name, make in (("frame", frames), ("mip", mips)):
        for side in "ab":
            make(f"{out}/{name}/{side}", side == "b")
        plants.append((name, f"{out}/{name}"))
    for name, folder in plants:
        text, names = ask(diptych, folder)
        if names[:1] == [name]:
            named += 1
        else:
            print(f"{folder}: {name} is told as {names}\n" + "\n".join(l for l in text.split("\n") if l.startswith(("why", "or ", "dip", "sec")))[:600])
    print(f"{named} of {len(plants)} named first")
    return named * 10 < len(plants) * 9


sys.exit(main(*sys.argv[1:]))
