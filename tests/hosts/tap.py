"""Leaves with diptych.tap what tests/hosts/examples/tap_gl.c has left: tap.py DUMP FOLDER."""
import json, os, sys
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "app", "python"))
import diptych

dump, folder = sys.argv[1:]
files = {(e["pass"], e["resource"]): e["file"] for e in json.load(open(f"{dump}/manifest.json"))["entries"]}
read = lambda key, dtype, *shape: np.fromfile(f"{dump}/{files[key]}", dtype).reshape(*shape)
camera = np.dtype([("position", "<f4", 3), ("exposure", "<f4"), ("id", "<u4")])

with diptych.tap(folder, "python") as tap:
    tap.image("upload", "albedo", read(("upload", "albedo"), np.uint8, 63, 96, 4)[::-1], origin="top")
    tap.buffer("upload", "cameras", read(("upload", "cameras"), camera, -1))
    tap.image("downsample", "small", read(("downsample", "small"), np.float16, 21, 32, 4), origin="bottom")

try:
    with diptych.tap(folder + "2", "python") as tap:
        tap.image("p", "r", np.zeros((1, 2, 2, 7), np.float32))
except diptych.Error as error:
    assert "7 channels" in str(error), error
    assert not os.path.exists(folder + "2/manifest.json")
else:
    sys.exit("7 channels were taken")
