"""Splits the error of indirect light by cause: each picture replaces one more approximation by its exact form. Errors are against a
path-traced reference.

usage: /usr/bin/python3 tests/app/causes.py BUILD SCENE.yaml REFERENCE.exr

REFERENCE.exr: 192x108 pixels of `reference --from-bounce 1 --quantity irradiance`. Prints a row of a Markdown table for each of MEASURES.
tests/app/quality.py calls this for its scenes."""
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "app", "python"))
import diptych  # noqa: E402: from the path above

SIZE = ["--size", "192x108"]
INDIRECT = ["--from-bounce", "1", "--quantity", "irradiance"]
MEASURES = ("relative_mse", "flip", "ratio")
COLUMNS = ("shipped", "one class, no filter", "rays to eyes", "rays to VPLs", "small disks", "8,192 VPLs")
# Of --vpls of `reference`; ClassVpl of ssvp.yaml has them, too.
FIELDS = [("position", "<f4", 3), ("normal", "<f4", 3), ("flux", "<f4", 3), ("disk", "<f4"), ("eye", "<f4", 3), ("near_square", "<f4")]


def run(build: str, *words: str) -> dict:
    """The JSON that a verb of diptych writes."""
    with tempfile.NamedTemporaryFile() as told:
        command = [f"{build}/diptych", *words, "--json", told.name]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode:
            raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
        with open(told.name, encoding="utf-8") as file:
            return json.load(file)


def errors(build: str, reference: str, test: str, *words: str) -> dict:
    return run(build, "metrics", "--reference", reference, "--test", test, "--exposure", "1", "--flip", "ldr", *words)


def render(*sets: str) -> None:
    """Renders frame 16 with these parameters into a.exr."""
    given = [word for value in sets for word in ("--set", value)]
    run(build, "render", "--spec", spec, "--scene", scene, "--backend", "vk", *SIZE, "--frames", "16", "--show", "indirect", *given, "-o",
        "a.exr")


def vpls(frames: int, **sets: int) -> numpy.ndarray:
    """The VPLs of both bounces in these frames, with the flux of their mean. The frame's size does not matter to them."""
    found = []
    with diptych.open(spec, scene=scene, size=(16, 16), sets=sets) as pipeline:
        for _ in range(frames):
            for shading in pipeline.render("first.shading", "second.shading").values():
                lit = numpy.zeros(len(shading), FIELDS)
                for name, *_ in FIELDS:
                    lit[name] = shading[name]
                lit["flux"] /= frames
                found.append(lit[lit["flux"].sum(1) > 0])
    return numpy.concatenate(found)


def trace(lights: numpy.ndarray, exact: bool = True, disk: float = 1) -> None:
    """exact: rays lead to the VPLs themselves, a millimetre over their surface."""
    lights = lights.copy()
    lights["disk"] *= disk
    if exact:
        lights["eye"] = lights["position"] + lights["normal"] * 0.001
        lights["near_square"] = 0
    numpy.save("vpls.npy", lights)
    run(build, "reference", "--scene", scene, *SIZE, *INDIRECT, "--spp", "1", "--vpls", "vpls.npy", "-o", "a.exr")


def table() -> None:
    rows: dict[str, list[str]] = {measure: [] for measure in MEASURES}
    lights = vpls(16)
    pictures: list[Callable[[], None]] = [
        render,
        lambda: render("tile=[1, 1]", "denoise_radius=0"),
        lambda: trace(lights, exact=False),
        lambda: trace(lights),
        lambda: trace(lights, disk=1 / 16),
        lambda: trace(vpls(2, first_vpls=2048, second_vpls=2048)),
    ]
    for picture in pictures:
        picture()
        told = errors(build, reference, "a.exr")
        values = {**told["hdr"], "flip": told["ldr"]["flip"]["mean"]}
        for measure in MEASURES:
            rows[measure].append(f"{values[measure]:.4f}")
    name = os.path.basename(scene).removesuffix(".yaml")
    for measure in MEASURES:
        print(f"| {name} | `{measure}` | {' | '.join(rows[measure])} |", flush=True)


if __name__ == "__main__":
    spec = os.path.abspath("templates/ssvp.yaml")
    build, scene, reference = (os.path.abspath(path) for path in sys.argv[1:4])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        table()
