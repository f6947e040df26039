"""Draws random valid variations of specs, what no body can notice or every body must support, and compares both backends on each.

    variations.py [--seed N] [--memory MIB] [--input NAME=FILE] [--scene FILE]... BUILD WORK SPEC=COUNT...

Drawn are parameters, formats, samplers, metrics, workgroups, ranges, targets, the order of passes, sizes and numbers of frames.
A draw that `--check` refuses, or whose resources take too much memory, is repeated. TAP; the seed, and the command of a variation
that fails, are printed. Called by variations_test.sh."""

import argparse
import collections
import json
import os
import random
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import flat

# Every shipped pipeline together must draw each of these.
KINDS = ("parameter", "end of a range", "format", "map", "metric", "local", "storage", "loop", "order", "target", "fast",
         "one texel wide", "several frames")
MOST_ATTEMPTS = 100


def choices(build):
    """The words of a key, by section and key."""
    run = subprocess.run([f"{build}/diptych-gen", "--schema"], capture_output=True, text=True, check=True)
    defined = json.loads(run.stdout)["$defs"]
    return {(section, key): item["allOf"][0].get("enum", []) for section in ("spec", "sampler", "metric", "range")
            for key, item in defined[section]["properties"].items() if "allOf" in item}


def names(accesses):
    return {item if isinstance(item, str) else item["name"] for item in accesses}


def touches(entry):
    """What a pass uses, and what it writes."""
    writes = names(entry.get("writes", [])) | names(entry.get("updates", []))
    return writes | names(entry.get("reads", [])) | {entry[key] for key in ("indirect", "indices") if key in entry}, writes


class Draw:
    """One attempt. `sets` are the overrides so far, `kinds` what was drawn."""

    def __init__(self, specs, spec, number, attempt):
        self.specs, self.spec, self.attempt = specs, spec, attempt
        self.random = random.Random(f"{specs.seed} {spec} {number} {attempt}")
        self.sets, self.kinds = [], collections.Counter()
        if spec not in specs.trees:
            specs.trees[spec] = flat.load(f"{specs.templates}/{spec}.yaml")[0]
        self.tree = specs.trees[spec]

    def one_in(self, count):
        return self.random.randrange(count) == 0

    def add(self, kind, path, value):
        self.sets.append(f"{path}={value}")
        self.kinds[kind] += 1

    def word(self, kind, path, section, key):
        self.add(kind, path, self.random.choice(self.specs.words[section, key]))

    def list(self):
        """The model with the overrides so far; None: it is refused."""
        path = f"{self.specs.work}/list.json"
        size = [] if self.spec in self.specs.given_sizes else ["--size", f"{self.size[0]}x{self.size[1]}"]
        run = self.specs.run("diptych", "list", "--spec", self.spec, *size, *self.specs.inputs, *self.options(), "--json", path)
        if run.returncode:
            return None
        with open(path, encoding="utf-8") as file:
            return json.load(file)

    def options(self):
        return [word for item in self.sets for word in ("--set", item)]

    def frame(self):
        kind, tile = self.random.randrange(8), self.tree["params"].get("tile", {}).get("value", [8, 8])
        sides = [1 if kind in (0, i + 1) else tile[i] * self.random.randint(1, 6) if kind == 3
                 else self.random.randint(2, 64) if kind == 4 else self.random.randint(97, 112) if kind == 5
                 else 2 * self.random.randrange(32) + 1 for i in range(2)]
        self.size = sides
        self.kinds["one texel wide"] += 1 in sides

    def number(self, param, former):
        """The minimum, the maximum, one between, or the former; the more often a draw was refused, which takes too much memory
        nearly always, the more minima."""
        least, most = param["min"], param["max"]
        if self.random.randrange(1 + self.attempt):
            return least
        between = (self.random.uniform(least, most) if param["type"] in ("float", "vec2", "vec3", "vec4")
                   else min(int(most), int(least) + self.random.randrange(1 << self.random.randint(0, 24))))
        return self.random.choice((least, most, between, former))

    def params(self, listed):
        for param in listed["params"]:
            if param["type"] == "bool":
                self.add("parameter", param["name"], self.random.choice(("true", "false")))
            elif param.get("min") is not None and param.get("max") is not None:
                former = param["value"] if isinstance(param["value"], list) else [param["value"]]
                values = [self.number(param, value) for value in former]
                self.kinds["end of a range"] += any(value in (param["min"], param["max"]) for value in values)
                real = param["type"][0] in "fv"
                texts = [f"{float(value):.4g}" if real else str(value) for value in values]
                if values != former:
                    self.add("parameter", param["name"], texts[0] if len(texts) == 1 else f"[{','.join(texts)}]")

    def details(self, listed):
        full = {item["name"].replace(".", "_"): item["name"] for item in listed["passes"]}
        if self.one_in(4):
            self.word("target", "target", "spec", "target")
        for item in listed["resources"]:
            channels = re.match(r"(r|rg|rgba)(16f|32f|8|16)$", item.get("format", ""))
            if channels and not item["input"] and item["name"] != listed["output"].get("display") and self.one_in(6):
                self.add("format", f"images.{item['name']}.format", channels[1] + self.random.choice(("16f", "32f")))
        for name, item in self.tree.get("samplers", {}).items():
            if item.get("map", "square") != "square" and self.one_in(2):
                self.add("map", f"samplers.{name}.map", self.random.choice(("polar_disk", "concentric_disk")))
            for key in ("filter", "mip_filter") if item.get("kind") == "filter" else ():
                if self.one_in(2):
                    self.word("filter", f"samplers.{name}.{key}", "sampler", key)
        for name in self.tree.get("metrics", {}):
            if self.one_in(2) or not self.specs.kinds["metric"]:  # few specs have one
                self.word("metric", f"metrics.{name}.normal_term", "metric", "normal_term")
                self.add("metric", f"metrics.{name}.scale", f"{self.random.uniform(0.1, 10):.1f}")
        for entry in self.tree["passes"]:
            if entry["name"] in full:  # other values may leave out passes of the defaults
                self.pass_details(entry, full[entry["name"]])

    def pass_details(self, entry, name):
        if "dispatch" in entry and "local" not in entry and self.one_in(3):
            width, height = self.random.choice((1, 3, 8, 16, 32, 64, 128)), self.random.choice((1, 2, 3, 4, 8))
            plane = isinstance(entry["dispatch"], list) or entry["dispatch"] in self.tree.get("images", {})
            self.add("local", f"passes.{name}.local", f"[{width},{height}]" if plane else width)
        for part in entry.get("ranges", {}):
            for key in ("storage", "loop"):
                if self.one_in(2):
                    self.word(key, f"passes.{name}.ranges.{part}.{key}", "range", key)

    def order(self, listed):
        """Another order of the passes, in which what one writes and another uses keeps its order."""
        entries = {entry["name"]: entry for entry in self.tree["passes"]}
        left = [name for name in (item["name"].replace(".", "_") for item in listed["passes"]) if name in entries]
        full, former, last = {item["name"].replace(".", "_"): item["name"] for item in listed["passes"]}, list(left), None

        def follows(later, earlier):
            uses, writes = touches(entries[later])
            earlier_uses, earlier_writes = touches(entries[earlier])
            after = {name.replace(".", "_") for name in entries[later].get("after", [])}
            return writes & earlier_uses or uses & earlier_writes or earlier in after
        order = []
        while left:
            ready = [name for i, name in enumerate(left) if not any(follows(name, other) for other in left[:i])]
            order.append(self.random.choice(ready))
            left.remove(order[-1])
        for name in order if order != former else ():
            if last:
                after = [full[last], *(other for other in entries[name].get("after", []) if other != full[last])]
                self.add("order", f"passes.{full[name]}.after", f"[{','.join(after)}]")
            last = name

    def memory(self, listed):
        return sum(item["stride"] * (item["count"] if item["kind"] == "buffer" else item["width"] * item["height"] * item["layers"])
                   for item in listed["resources"])

    def all(self):
        """Whether the draw is valid."""
        self.size = [64, 64]
        if self.spec not in self.specs.defaults:
            self.specs.defaults[self.spec] = self.list()
        self.params(self.specs.defaults[self.spec])
        self.frame()
        listed = self.list()
        if not listed or self.memory(listed) > self.specs.memory << 20:
            return False
        history = any(item["history"] for item in listed["resources"])
        self.frames = self.random.randint(1, 3) if history else 1 + self.one_in(4)
        self.kinds["several frames"] += self.frames > 1
        self.details(listed)
        if self.one_in(3):
            self.order(listed)
        return self.specs.run("diptych-gen", self.spec, "--check", *self.options()).returncode == 0


class Specs:
    def __init__(self, arguments):
        self.seed, self.memory, self.build, self.work = arguments.seed, arguments.memory, arguments.build, arguments.work
        self.scenes, self.inputs = arguments.scene, [word for item in arguments.input for word in ("--input", item)]
        self.templates = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "templates")
        self.words, self.kinds, self.redrawn = choices(self.build), collections.Counter(), 0
        self.given_sizes = ("post",)   # by an input
        self.trees, self.defaults = {}, {}   # by spec

    def run(self, tool, *words):
        return subprocess.run([f"{self.build}/{tool}", *words], capture_output=True, text=True, check=False)

    def draw(self, spec, number):
        for attempt in range(MOST_ATTEMPTS):
            draw = Draw(self, spec, number, attempt)
            if draw.all():
                self.kinds += draw.kinds
                return draw
            self.redrawn += 1
        raise SystemExit(f"{spec}: no valid variation in {MOST_ATTEMPTS} draws")

    def commands(self, spec, number, draw):
        """Arguments of the comparisons, and whether they must agree. One in eight also runs fast."""
        size = [] if spec in self.given_sizes else ["--size", f"{draw.size[0]}x{draw.size[1]}"]
        scene = ["--scene", self.scenes[number % len(self.scenes)]] if self.scenes and not self.inputs else []
        common = ["compare", "--spec", spec, *scene, *self.inputs, *size, "--frames", str(draw.frames), *draw.options()]
        if draw.one_in(8) or not self.kinds["fast"]:
            self.kinds["fast"] += 1
            yield [*common, "--set", "exactness=fast"], False
        yield common, True

    def compare(self, words, exact):
        """A reason why this is wrong, or None. A fast pipeline may differ."""
        run = self.run("diptych", *words)
        if run.returncode == 0 or (run.returncode == 1 and not exact and "error" not in run.stderr):
            return None
        return f"diptych {' '.join(words)}\nexit status {run.returncode}: {run.stdout.strip().splitlines()[-1:]}\n{run.stderr}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--memory", type=int, default=12)
    parser.add_argument("--scene", action="append", default=[])
    parser.add_argument("--input", action="append", default=[])
    parser.add_argument("--kinds", action="store_true", help="each kind must have been drawn")
    parser.add_argument("build")
    parser.add_argument("work")
    parser.add_argument("specs", nargs="+")
    arguments = parser.parse_args()
    specs, results = Specs(arguments), []

    def report(good, text, reasons=()):
        results.append(good)
        print("ok" if good else "not ok", text)
        for reason in reasons:
            print("\n".join("# " + line for line in reason.splitlines()))
        sys.stdout.flush()
    with ThreadPoolExecutor(2) as pool:
        for item in arguments.specs:
            spec, count = item.split("=")
            draws = (specs.draw(spec, number) for number in range(int(count)))
            runs = [pool.submit(specs.compare, *command) for number, draw in enumerate(draws)
                    for command in specs.commands(spec, number, draw)]
            reasons = [reason for reason in (run.result() for run in runs) if reason]
            report(not reasons, f"- {count} variations of {spec} with seed {specs.seed}: all that are exact agree", reasons)
    if arguments.kinds:
        missing = [kind for kind in KINDS if not specs.kinds[kind]]
        report(not missing, "- every kind of setting is drawn", [f"never: {', '.join(missing)}"] if missing else [])
    print(f"# drawn with seed {specs.seed}, {specs.redrawn} refused: " + ", ".join(f"{kind} {n}" for kind, n in specs.kinds.items()))
    return 0 if all(results) else 1


sys.exit(main())
