"""Prints the tables of templates/ssvp/README.md as Markdown: errors of indirect irradiance and whole pictures, energy, flicker, and cost.

usage: /usr/bin/python3 tests/app/quality.py BUILD FOLDER [--spec SPEC] [--set PATH=VALUE]...

References stay in FOLDER for the next run. DIPTYCH_SCENES names the folder of the paper's scenes; without it they are left out. Takes
an hour on two processors, a quarter of it where the references are there. A frame alone: mean of eight frames without history and
limit of outliers, with shifted patterns, and its standard error. Else: the last of 16 frames."""
import argparse
import os
import statistics
import subprocess
import sys

from causes import COLUMNS, INDIRECT, SIZE, __file__ as causes, errors, run

ERRORS = ("relative_mse", "smape", "flip", "ratio", "darker", "brighter")
MORE = ("whole `flip`", "energy", "flicker", "… last five")
ALONE = ("accumulate=0", "denoise_outlier=0")
LIGHT, CAMERA = "the light moves", "the camera moves"
MOTIONS = {"cornell": {"cornell_light": LIGHT, "cornell_walk": CAMERA}, "atrium": {"atrium_sun": LIGHT, "atrium_walk": CAMERA}}
PAPER = ("sponza", "sibenik", "conference")
FRAMES, STILL, MOVING = 16, 768, 192  # frames of a motion; samples per pixel for errors, and for flicker


def scene(name, motion=None):
    return ["--scene", f"scenes/{name}.yaml"] + (["--motion", f"scenes/{motion}.yaml"] if motion else [])


def truth(name, motion, frame, samples, whole=False):
    path = f"{options.folder}/{motion or name}.{samples}.{frame:02d}{'.whole' * whole}.exr"
    if not os.path.exists(path):
        place = [*scene(name, motion), *(["--frame", str(frame)] if motion else [])]
        run(options.build, "reference", *place, *SIZE, *([] if whole else INDIRECT), "--spp", str(samples), "-o", f"{path}.part.exr")
        os.rename(f"{path}.part.exr", path)
    return path


def render(name, motion, frames, *sets, kind="ours", show=("--show", "indirect")):
    """Pattern of the pictures of all frames."""
    path = f"{options.folder}/{kind}.%02d.exr"
    given = [x for value in (*options.set, *sets) for x in ("--set", value)]
    run(options.build, "render", "--spec", options.spec, *scene(name, motion), "--backend", "vk", *SIZE, "--frames", str(frames),
        *show, *given, "-o", path)
    return path


def row(name, what, told, *more):
    values = {**told["hdr"], "flip": told["ldr"]["flip"]["mean"]}
    spread = told.get("standard_errors")
    spread = spread and {**spread["hdr"], "flip": spread["ldr"]["flip"]["mean"]}
    cells = [f"{values[key]:.4f}" + (f" ± {spread[key]:.4f}" if spread else "") for key in ERRORS]
    print(f"| {' | '.join([name, what, *cells, *more, *[''] * (len(MORE) - len(more))])} |", flush=True)


def whole_flip(name, motion):
    """FLIP of the picture with direct light, and albedo."""
    ours = render(name, motion, FRAMES, kind="whole", show=())
    told = run(options.build, "metrics", "--reference", truth(name, motion, FRAMES - 1 if motion else 0, STILL, True),
               "--test", ours % (FRAMES - 1), "--flip", "ldr")
    return f"{told['ldr']['flip']['mean']:.4f}"


def energy(name, motion, told):
    """Light of the last frame, divided by the mean of 16 frames alone, each as a share of the reference at its moment."""
    alone = render(name, motion, FRAMES, *ALONE, kind="alone")
    truths = [truth(name, motion, frame, MOVING) if motion else truth(name, None, 0, STILL) for frame in range(FRAMES)]
    shares = [errors(options.build, truths[frame], alone % frame)["hdr"]["ratio"] for frame in range(FRAMES)]
    return f"{told['hdr']['ratio'] / statistics.mean(shares):.3f}"


def measure(name):
    still = truth(name, None, 0, STILL)
    alone = render(name, None, 8, *ALONE)
    row(name, "a frame alone", errors(options.build, still, alone, "--frames", "8"))
    ours = render(name, None, FRAMES)
    told = errors(options.build, still, ours % (FRAMES - 1))
    row(name, "still", told, whole_flip(name, None), energy(name, None, told))
    for motion, title in MOTIONS.get(name, {}).items():
        last = truth(name, motion, FRAMES - 1, STILL)
        for frame in range(FRAMES):
            truth(name, motion, frame, MOVING)
        ours = render(name, motion, FRAMES)
        change = run(options.build, "flicker", *scene(name, motion), "--test", ours, "--reference",
                   f"{options.folder}/{motion}.{MOVING}.%02d.exr", "--block", "8")
        steps = [step["relative_flicker"] for step in change["per_frame"]]
        told = errors(options.build, last, ours % (FRAMES - 1))
        row(name, title, told, whole_flip(name, motion), energy(name, motion, told),
            f"{100 * change['relative_flicker']:.1f} %", f"{100 * sum(steps[-5:]) / 5:.1f} %")


def cost():
    """Bounds on a GPU with the mean over frames and without, and the share of the frame's time here."""
    for sets in ((), ALONE):
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
print("| scene | 16 frames | `" + "` | `".join(ERRORS) + "` | " + " | ".join(MORE) + " |")
print("|---" * (len(ERRORS) + len(MORE) + 2) + "|")
places = ("cornell", "atrium", *(PAPER if os.environ.get("DIPTYCH_SCENES") else ()))
for place in places:
    measure(place)
print("| scene | error | " + " | ".join(COLUMNS) + " |\n" + "|---" * (len(COLUMNS) + 2) + "|", flush=True)
for place in places:
    subprocess.run([sys.executable, causes, options.build, f"scenes/{place}.yaml", truth(place, None, 0, STILL)], check=True)
cost()
