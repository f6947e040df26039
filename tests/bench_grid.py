"""Measures ssvp's shading over tiles, VPLs and clusters, for `ninja bench-grid`. Prints the time relative to plain C, and
relative to the best choice of storage and loop for the ranges of VPLs. One row per point and backend, then the worst. Asserts
nothing, as times need a quiet machine.

usage: bench_grid.py BUILD"""
import json
import math
import os
import subprocess
import sys
import tempfile

# Pixels of a tile per side, VPLs of each bounce, clusters.
POINTS = [(8, 64, 1), (8, 2048, 64), (4, 256, 8), (4, 2048, 8), (2, 256, 8), (2, 512, 32), (2, 2048, 8), (1, 64, 1), (1, 256, 8),
          (1, 2048, 64)]
CHOICES = [(storage, loop) for storage in ("shared", "uniform", "buffer") for loop in ("unroll", "roll")]
RANGES = ["first_range", "second_range"]
# (VPLs per pixel at most, frame size): shade must take milliseconds, so that the fixed cost of a dispatch does not count.
SIZES = [(64, "640x360"), (256, "320x180"), (math.inf, "160x90")]


def measure(build, point, choice, folder):
    """Ratios to plain C by backend; empty if the choice is not possible, for example because a block is too large."""
    tile, vpls, clusters = point
    sets = [f"tile=[{tile},{tile}]", f"first_vpls={vpls}", f"second_vpls={vpls}", f"clusters={clusters}", "rsm_size=256",
            "map_size=64"]
    for name in RANGES if choice else []:
        sets += [f"passes.shade.ranges.{name}.storage={choice[0]}", f"passes.shade.ranges.{name}.loop={choice[1]}"]
    path = os.path.join(folder, "bench.json")
    size = next(size for most, size in SIZES if vpls / tile**2 <= most)
    command = [f"{build}/diptych", "bench", "--scene", "scenes/cornell.yaml", "--size", size, "--frames", "5", "--json", path]
    done = subprocess.run(command + [word for item in sets for word in ("--set", item)], capture_output=True, text=True)
    if done.returncode:
        if not choice:
            sys.exit(done.stderr)
        return {}
    with open(path) as file:
        result = json.load(file)
    limit = next(row["limit"]["ms"]["p5"] for row in result["passes"] if row["pass"] == "shade")
    # Compares the fastest frames, as other load on the machine only adds time.
    return {side["side"]: row["ms"]["p5"] / limit for side in result["sides"] for row in side["passes"] if row["pass"] == "shade"}


def main():
    build = sys.argv[1]
    worst = {"times plain C": (0, ""), "times the best choice": (0, "")}
    print(f"{'tile':>4} {'VPLs':>5} {'clusters':>8}  {'backend':8} {'x plain C':>9}  {'x best':>6}  best choice")
    with tempfile.TemporaryDirectory() as folder:
        for point in POINTS:
            own = measure(build, point, None, folder)
            others = {choice: measure(build, point, choice, folder) for choice in CHOICES}
            for name, ratio in own.items():
                best = min(CHOICES, key=lambda choice: others[choice].get(name, math.inf))
                lead = ratio / others[best].get(name, math.inf)
                row = f"{point[0]:4} {point[1]:5} {point[2]:8}  {name:8}"
                print(f"{row} {ratio:9.2f}  {lead:6.2f}  {' '.join(best)}", flush=True)
                worst["times plain C"] = max(worst["times plain C"], (ratio, row))
                worst["times the best choice"] = max(worst["times the best choice"], (lead, row))
    for what, (ratio, row) in worst.items():
        print(f"worst: {ratio:.2f} {what}: {' '.join(row.split())}")


main()
