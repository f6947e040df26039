"""Prints the tables of templates/ssvp/README.md as Markdown: errors of indirect irradiance, flicker, and cost.

usage: /usr/bin/python3 tests/app/quality.py BUILD FOLDER [--spec SPEC] [--set PATH=VALUE]...

References stay in FOLDER for the next run. DIPTYCH_SCENES names the folder of the paper's scenes; without it they are left out. Takes
an hour on two processors, a quarter of it where the references are there. A frame alone: mean of eight frames without history, with
shifted patterns, and its standard error. Else: the last of 16 frames."""
import argparse
import os
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)) + "/../../templates/ssvp")
from causes import COLUMNS, INDIRECT, SIZE, __file__ as causes, errors, run  # noqa: E402: from the path above

ERRORS = ("relative_mse", "smape", "flip", "ratio", "darker", "brighter")
LIGHT, CAMERA = "the light moves", "the camera moves"
MOTIONS = {"cornell": {"cornell_light": LIGHT, "cornell_walk": CAMERA}, "atrium": {"atrium_sun": LIGHT, "atrium_walk": CAMERA}}
PAPER = ("sponza", "sibenik", "conference")
FRAMES, STILL, MOVING = 16, 768, 192  # frames of a motion; samples per pixel for errors, and for flicker


def scene(name, motion=None):
    return ["--scene", f"scenes/{name}.yaml"] + (["--motion", f"scenes/{motion}.yaml"] if motion else [])


def truth(name, motion, frame, samples):
    path = f"{options.folder}/{motion or name}.{samples}.{frame:02d}.exr"
    if not os.path.exists(path):
        place = [*scene(name, motion), *(["--frame", str(frame)] if motion else [])]
        run(options.build, "reference", *place, *SIZE, *INDIRECT, "--spp", str(samples), "-o", f"{path}.part.exr")
        os.rename(f"{path}.part.exr", path)
    return path


def render(name, motion, frames, *sets):
    """Pattern of the pictures of all frames."""
    path = f"{options.folder}/ours.%02d.exr"
    given = [x for value in (*options.set, *sets) for x in ("--set", value)]
    run(options.build, "render", "--spec", options.spec, *scene(name, motion), "--backend", "vk", *SIZE, "--frames", str(frames),
        "--show", "indirect", *given, "-o", path)
    return path


def row(name, what, told, flicker="|"):
    values = {**told["hdr"], "flip": told["ldr"]["flip"]["mean"]}
    spread = told.get("standard_errors")
    spread = spread and {**spread["hdr"], "flip": spread["ldr"]["flip"]["mean"]}
    cells = [f"{values[key]:.4f}" + (f" ± {spread[key]:.4f}" if spread else "") for key in ERRORS]
    print(f"| {name} | {what} | {' | '.join(cells)} | {flicker} |", flush=True)


def measure(name):
    still = truth(name, None, 0, STILL)
    alone = render(name, None, 8, "accumulate=0")
    row(name, "a frame alone", errors(options.build, still, alone, "--frames", "8"))
    row(name, "still", errors(options.build, still, render(name, None, FRAMES) % (FRAMES - 1)))
    for motion, title in MOTIONS.get(name, {}).items():
        last = truth(name, motion, FRAMES - 1, STILL)
        for frame in range(FRAMES):
            truth(name, motion, frame, MOVING)
        ours = render(name, motion, FRAMES)
        told = run(options.build, "flicker", *scene(name, motion), "--test", ours, "--reference",
                   f"{options.folder}/{motion}.{MOVING}.%02d.exr", "--block", "8")
        steps = [step["relative_flicker"] for step in told["per_frame"]]
        row(name, title, errors(options.build, last, ours % (FRAMES - 1)),
            f"{100 * told['relative_flicker']:.1f} % | {100 * sum(steps[-5:]) / 5:.1f} %")


def cost():
    """Bounds on a GPU with the mean over frames and without, and the share of the frame's time here."""
    for sets in ((), ("accumulate=0",)):
        given = [x for value in (*options.set, *sets) for x in ("--set", value)]
        command = [f"{options.build}/diptych", "cost", "--spec", options.spec, "--gpu", "navi21", *given]
        text = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
        print(*sets, *[line for line in text.splitlines() if line.startswith("passes of every pixel")])


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build")
parser.add_argument("folder")
parser.add_argument("--spec", default="templates/ssvp.yaml")
parser.add_argument("--set", action="append", default=[])
options = parser.parse_args()
os.makedirs(options.folder, exist_ok=True)
print("| scene | 16 frames | `" + "` | `".join(ERRORS) + "` | flicker | … last five |")
print("|---" * (len(ERRORS) + 4) + "|")
places = ("cornell", "atrium", *(PAPER if os.environ.get("DIPTYCH_SCENES") else ()))
for place in places:
    measure(place)
print("| scene | error | " + " | ".join(COLUMNS) + " |\n" + "|---" * (len(COLUMNS) + 2) + "|", flush=True)
for place in places:
    subprocess.run([sys.executable, causes, options.build, f"scenes/{place}.yaml", truth(place, None, 0, STILL)], check=True)
cost()
