"""Reads what replay.py and alone.py left in a folder, for compare.py and guilty.py. A capture may have taken its replay over, and left
anything: what is not as it should be is Unreadable, and no fault of ours."""
from __future__ import annotations

import json
import os
import zipfile
import zlib
from typing import Any, Callable

import numpy as np

Json = dict[str, Any]
FAULTS = (OSError, ValueError, TypeError, EOFError, RecursionError, MemoryError, NotImplementedError, zipfile.BadZipFile, zlib.error)
# What frame.json has: members by name, each as a value of its type; a list as its item. Other members may stand beside.
ENTRY = {"kind": "", "file": "", "turned": "", "resource": "", "label": "", "screen": False, "id": 0}
IMAGE = {**ENTRY, "mip": 0, "width": 0, "height": 0, "layers": 0, "format": ""}
BUFFER = {**ENTRY, "stride": 0, "count": 0, "fields": [{"name": "", "type": "", "offset": 0}]}
STATE: Json = {"draw": 0, "state": {}, "samplers": {}, "uniforms": {}, "loose": {}, "laid": {}, "streams": {}}
PASS = {"index": 0, "run": 0, "kind": "", "first": 0, "last": 0, "draws": 0, "where": [""], "counts": [[0]], "chosen": [0],
        "left_out": [""], "clears": {}, "region": [[0.0]], "reads": {},
        "shaders": [{"stage": "", "entry": "", "file": ""}], "states": [STATE],
        "entries": [ENTRY], "inputs": [ENTRY]}
FRAME = {"api": "", "renderdoc": "", "device": "", "samples": False, "bytes": 0, "notes": [""], "passes": [PASS]}
TAKEN = {"passes": [{"inputs": [{"file": ""}]}]}  # by alone.py


class Unreadable(Exception):
    """What is wrong, in words."""


def fits(value: Any, shape: Any) -> bool:
    if isinstance(shape, dict):
        return isinstance(value, dict) and all(key in value and fits(value[key], item) for key, item in shape.items())
    if isinstance(shape, list):
        return isinstance(value, list) and all(fits(item, shape[0]) for item in value)
    return isinstance(value, type(shape))


def own(folder: str, name: str) -> str:
    """The path of a file that the replay names: one that it wrote, and no other."""
    path = os.path.join(folder, name)
    if os.path.basename(name) != name or os.path.islink(path) or not os.path.isfile(path):
        raise Unreadable("its replay names files that it did not write")
    return path


def loaded(folder: str, name: str, load: Callable[[Any], Any] = np.load) -> Any:
    try:
        with open(own(folder, name), "rb") as file:
            return load(file)
    except FAULTS as error:
        raise Unreadable(f"what its replay left cannot be read: {type(error).__name__}: {error}") from None


def read(folder: str, shape: Json) -> Json:
    """frame.json, if it has this shape."""
    frame: Json = loaded(folder, "frame.json", json.load)
    if not fits(frame, shape):
        raise Unreadable("what its replay left is no frame")
    return frame


def frame_of(folder: str) -> Json:
    """What replay.py left, with the small pictures as `small`."""
    frame = read(folder, FRAME)
    frame["small"] = loaded(folder, "small.npz", lambda file: dict(np.load(file)))
    for made in frame["passes"]:
        entries = [*made["entries"], *made["inputs"]]
        streams = [stream for state in made["states"] for stream in state["streams"].values()]
        whole = [fits(entry, IMAGE if entry["kind"] == "image" else BUFFER) and entry["file"] in frame["small"] for entry in entries]
        if not all(whole) or not fits([stream[:1] for stream in streams], [[""]]):
            raise Unreadable("what its replay left is no frame")
        for name in [item["file"] for item in entries + made["shaders"]] + [stream[0] for stream in streams]:
            own(folder, name)
    return frame
