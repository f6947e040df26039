"""Injects faults: compare must name exactly the pass, the resource and the frame of each. Every pass of two small pipelines, which
have each kind of pass, gets one fault; backend and kind change from pass to pass. With DIPTYCH_LONG, every pass of these and of the
shipped pipelines gets every kind in both backends. The log names the injected fault, the last line the found one, independently.
TAP; called by fault_test.sh with the command, the project's folder and a folder to work in."""

import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

DIPTYCH, ROOT, WORK = sys.argv[1:]
CHANGES = ("bit", "texel", "sign")
KINDS = (*CHANGES, "missing")
SMALL = ["--scene", f"{ROOT}/scenes/cornell.yaml", "--size", "16x16", "--set", "rsm_size=16"]
SSVP = SMALL + ["--spec", f"{ROOT}/templates/ssvp.yaml", "--set", "tile=[2,2]", "--set", "first_vpls=16",
                "--set", "second_vpls=16", "--set", "clusters=2", "--set", "map_size=16",
                # the list has room for one of two maps, so no draw is empty
                "--set", "second_clusters=2", "--set", "map_triangles=300", "--set", "cull_triangles=1024"]
FEATURES = ["--scene", f"{ROOT}/scenes/cornell.yaml", "--size", "17x9", "--spec", f"{ROOT}/tests/specs/features.yaml"]
MIPS = ["--size", "17x9", "--spec", f"{ROOT}/tests/specs/mips.yaml"]
RSM = SMALL + ["--spec", f"{ROOT}/templates/rsm.yaml", "--set", "samples=4"]
TAA = SMALL + ["--spec", f"{ROOT}/templates/taa.yaml", "--frames", "2"]
POST = ["--spec", f"{ROOT}/templates/post.yaml", "--input", f"photo={ROOT}/templates/post/table.png"]
CLUSTERED = SMALL + ["--spec", f"{ROOT}/templates/clustered.yaml", "--set", "first_vpls=16", "--set", "clusters=2",
                     "--set", "tile=[2,2]", "--set", "map_size=16", "--set", "map_triangles=300"]
DEEP = SMALL + ["--spec", f"{ROOT}/templates/deep.yaml", "--set", "samples=4"]
SSDO = SMALL + ["--spec", f"{ROOT}/templates/ssdo.yaml", "--set", "samples=4"]

results = []


def report(good, description, reasons=()):
    results.append(good)
    print(f"{'ok' if good else 'not ok'} {len(results)} - {description}")
    for reason in reasons:
        print("\n".join("# " + line for line in reason.splitlines()))
    sys.stdout.flush()


def compare(options):
    return subprocess.run([DIPTYCH, "compare", *options], capture_output=True, text=True, check=False)


def passes_of(options):
    """The passes, in order, if a comparison agrees."""
    path = f"{WORK}/passes.json"
    run = compare(options)
    if run.returncode != 0:
        return [], run.stdout + run.stderr
    spec = options[options.index("--spec") + 1]
    subprocess.run([DIPTYCH, "list", "--spec", spec, "--json", path], capture_output=True, check=True)
    with open(path, encoding="utf-8") as file:
        return [row["name"] for row in json.load(file)["passes"]], ""


def is_named(fault, options):
    """Injects one fault; returns (resource, None), or (None, reason) if compare does not name the fault."""
    side, name, kind = re.split("[:@]", fault)[:3]
    frame = fault.split("@")[1] if "@" in fault else "0"
    run = compare([*options, "--fault", fault])
    told = re.search(rf"^diptych: {side}: fault in pass {re.escape(name)}, frame {frame}: ([\w.]+)", run.stderr, re.M)
    last = run.stdout.rstrip("\n").rsplit("\n", 1)[-1]
    named = re.fullmatch(r"guilty: pass ([\w.]+) \(shader [\w/]+\.glsl\): resource ([\w.]+)(?: mip \d+)?, in frame (\d+)", last)
    good = (run.returncode == 1 and told and named and named[1] == name and named[3] == frame
            and (kind == "missing" or named[2] == told[1]))
    return (named[2], None) if good else (None, f"{fault}: exit status {run.returncode}: {last}\n{run.stderr}")


class Faults:
    """Counts injected and found faults."""

    def __init__(self):
        self.injected = self.found = self.passes = 0
        self.resources = set()
        self.pool = ThreadPoolExecutor(2)

    def inject(self, faults, options):
        """Returns a reason for each fault that was not found."""
        outcomes = list(self.pool.map(lambda fault: is_named(fault, options), faults))
        self.injected += len(outcomes)
        self.found += sum(why is None for _, why in outcomes)
        self.resources |= {resource for resource, why in outcomes if why is None}
        return [why for _, why in outcomes if why]

    def every_kind(self, name, options):
        seed = self.injected
        faults = [f"{side}:{name}:{kind}:{seed + i}" for i, (side, kind) in
                  enumerate((side, kind) for side in ("gl", "vk") for kind in KINDS)]
        if not os.environ.get("DIPTYCH_LONG"):   # one fault: sides alternate, and each side goes through the kinds
            kind = self.passes // 2 % len(KINDS)
            faults = [faults[self.passes % 2 * len(KINDS) + kind]]
            self.passes += 1
        return self.inject(faults, options)


def main():
    faults = Faults()
    pipelines = [("features", FEATURES), ("mips", MIPS)]
    if os.environ.get("DIPTYCH_LONG"):
        pipelines += [("ssvp", SSVP), ("rsm", RSM), ("taa", TAA), ("post", POST), ("ssdo", SSDO), ("deep", DEEP), ("clustered", CLUSTERED)]
    for title, options in pipelines:
        names, why = passes_of(options)
        report(names, f"{title} agrees without a fault", [why] if why else [])
        for name in names:
            reasons = faults.every_kind(name, options)
            report(not reasons, f"{title}, pass {name}: all faults are found", reasons)
    # A skipped pass clears its outputs, and compare checks the cleared content. (Not the kind `missing`: without the clear the
    # content may be right by chance, as zeros of another resource in the same memory.)
    cleared = [f"{side}:blur:{kind}:7" for kind in CHANGES for side in ("gl", "vk")]
    reasons = faults.inject(cleared if os.environ.get("DIPTYCH_LONG") else cleared[:2], [*FEATURES, "--set", "blur=false"])
    report(not reasons, "in what a skipped pass has cleared", reasons)
    # History: the first frames are right, so compare must name a later frame. Without its last run, `follow` may leave the same.
    history = [f"{side}:{name}:{kind}:9@{frame}" for side in ("gl", "vk") for frame in (1, 2)
               for name, kinds in (("follow", CHANGES), ("remember", KINDS)) for kind in kinds]
    if not os.environ.get("DIPTYCH_LONG"):
        history = ["gl:follow:texel:9@2", "vk:follow:sign:9@1", "gl:remember:missing:2@2", "vk:remember:texel:2@2"]
    reasons = faults.inject(history, [*FEATURES, "--frames", "3"])
    report(not reasons, "in later frames of three, in passes with history", reasons)
    # compare checks resources that no pass reads, too
    unread = {"gbuffer_depth", "shown"}
    for seed in range(1008, 1068):   # with the present rsm, the first seed hits the depths
        if unread <= faults.resources:
            break
        faults.inject([f"vk:gbuffer_triangles:bit:{seed}"], RSM)
    report(unread <= faults.resources, "in resources that nothing reads: " + ", ".join(sorted(unread)))
    report(faults.injected == faults.found > (250 if os.environ.get("DIPTYCH_LONG") else 23), "all of them")
    print(f"# counted: {faults.injected} faults injected, {faults.found} found")
    print(f"1..{len(results)}")
    return 0 if all(results) else 1


sys.exit(main())
