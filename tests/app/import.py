"""Holds what imported specs compute against NumPy. import.py table FOLDER: the pictures that tests/app/import needs. import.py chain DUMP
GAIN FRAMES: a dump of chain.slangp. import.py sums DUMP, import.py pair DUMP, import.py meant DUMP: of the shaders."""
import json, os, struct, sys, zlib
import numpy as np

WIDTH, HEIGHT = 8, 6
rng = np.random.default_rng(1)
picture = rng.integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)
table = np.array([[[9, 51, 3], [1, 2, 3]]], np.uint8)


def png(path, a):
    def chunk(t, d): return struct.pack(">I", len(d)) + t + d + struct.pack(">I", zlib.crc32(t + d))
    raw = b"".join(b"\0" + row.tobytes() for row in a)
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", a.shape[1], a.shape[0], 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def load(folder, of_pass, name):
    for e in json.load(open(f"{folder}/manifest.json"))["entries"]:
        if (e["pass"], e["resource"]) == (of_pass, name):
            kind = {"rgba8": np.uint8, "rgba16f": np.float16, "rgba32f": np.float32}.get(e.get("format"), np.uint32)
            a = np.fromfile(f"{folder}/{e['file']}", kind)
            return a if e["kind"] == "buffer" else a.reshape(e["height"], e["width"], -1)
    sys.exit(f"no {name} after {of_pass}")


def near(what, got, want, most):
    error = np.abs(np.asarray(got, float) - want).max()
    print(f"{what}: largest error {error}, allowed {most}")
    if not error <= most:
        sys.exit(1)


def chain(dump, gain, frames):
    gain, frames, p = float(gain), int(frames), picture / 255.0
    wide = np.repeat(np.repeat(p * gain, 2, 0), 2, 1)
    near("wide, row 0 on top", load(dump, "draw0", "pass0")[..., :3], wide, 1e-3)
    mixed = load(dump, "draw1", "pass1") / 255.0
    height, width = mixed.shape[:2]
    ys, xs = np.arange(height) * HEIGHT // height, np.arange(width) * WIDTH // width
    red = p[np.ix_(ys, xs)][..., 0]
    near("look-up", mixed[..., 0], red * gain * 51 / 255, 1 / 255)
    near("feedback", mixed[..., 1], red * gain * (frames > 1), 1 / 255)
    near("history", mixed[..., 2], red * (frames > 2), 1 / 255)
    near("frame counter", mixed[..., 3], (frames - 1) % 2 / 255, 1e-6)
    near("a size with mips", load(dump, "draw2", "pass2").shape, [16, 32, 4], 0)
    near("mips", load(dump, "draw3", "pass3") / 255.0, load(dump, "draw2", "pass2").mean((0, 1)) / 255.0, 2 / 255)


def sums(dump):
    target = load(dump, "run", "target")
    height, width = target.shape[:2]
    near("target", target[..., :2], np.stack(np.meshgrid(np.arange(width), np.arange(height)), 2) * [0.5, 2.0], 0)
    near("weights and loose", target[..., 2], 1.25, 0)
    near("bool", target[..., 3], 2, 0)
    near("sums", load(dump, "run", "Sums")[:4], 5 * width * height // 4, 0)


def pair(dump):
    color = load(dump, "run", "color")
    near("picture", color[..., :3], picture, 0)
    near("place", color[..., 3] / 255.0, ((np.arange(HEIGHT) + 0.5) / HEIGHT)[:, None], 0.51 / 255)


def meant(dump):
    near("fmod, %, ldexp select, shift and length of HLSL, globals, atomics", load(dump, "run", "meant").view(np.float32)[:9], [-1.5, -1, 8, 7.5, 9, 213, 0.25, 8, 18], 0)


if sys.argv[1] == "table":
    png(os.path.join(sys.argv[2], "table.png"), table)
    png(os.path.join(sys.argv[2], "picture.png"), picture)
else:
    {"chain": chain, "sums": sums, "pair": pair, "meant": meant}[sys.argv[1]](*sys.argv[2:])
