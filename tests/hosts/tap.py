"""Leaves as .npy files what tests/hosts/examples/tap_gl.c has left: tap.py DUMP FOLDER."""
import json, os, sys
import numpy as np

dump, folder = sys.argv[1:]
files = {(e["pass"], e["resource"]): e["file"] for e in json.load(open(f"{dump}/manifest.json"))["entries"]}
camera = np.dtype([("position", "<f4", 3), ("exposure", "<f4"), ("id", "<u4")])
os.makedirs(folder)
for name, dtype, *shape in ("upload.albedo", np.uint8, 63, 96, 4), ("upload.cameras", camera, -1), ("downsample.small", np.float16, 21, 32, 4):
    np.save(f"{folder}/{name}.npy", np.fromfile(f"{dump}/{files[tuple(name.split('.'))]}", dtype).reshape(shape))
