"""`diptych report`: one page on a pipeline: pictures beside their reference, errors, times, and published numbers. Other verbs do
the work (workflow.py); plots and the page are made of their results alone. outline.py says what it shows."""
from __future__ import annotations

import csv
import datetime
import io
import math
import os
import shlex
import subprocess
import urllib.parse
from typing import Any

from . import collect, page, plots
from .console import Console, write
from .grid import HEADLINES, Grid, Number, Point, add_reference
from .outline import read_outline
from .workflow import Scene, Workflow, plain

NOISE_FRAMES = 3  # of a motion, traced a second time with other noise
PARTS = ("Pictures", "Errors of the sweep", "Temporal coherence", "Times", "Comparison of the backends")


def number_text(value: float) -> str:
    """With as many digits as a reader needs; a dash for NaN."""
    size = abs(value)
    if math.isnan(value):
        return "\u2013"
    if size >= 100 or (size >= 2 and value == math.floor(value)):
        return f"{value:.0f}"
    if size >= 1 or size == 0:
        return f"{value:.1f}" if size >= 10 else f"{value:.2f}"
    return f"{value:#.3g}" if size >= 0.001 else f"{value:.1e}"


class Report:
    def __init__(self, console: Console, request: dict[str, Any]):
        self.console, self.request = console, request
        self.flow = flow = Workflow(console, request)
        flow.needs_programs(["yaml", "jsonschema", "matplotlib"])
        spec = os.path.realpath(flow.spec_words()[1])
        path = os.path.realpath(request.get("outline") or os.path.splitext(spec)[0] + "/report.yaml")
        self.outline_path, self.outline = path, read_outline(console, path, flow.templates)
        self.pictures: list[dict[str, Any]] = self.outline["pictures"]
        self.motion: dict[str, Any] = self.outline.get("motion") or {}
        self.published: dict[str, Any] = self.outline.get("published") or {}
        self.parameter: str = self.outline["sweep"]["parameter"]
        self.values = [value if isinstance(value, str) else f"{value:.9g}" for value in self.outline["sweep"]["values"]]
        given = request.get("scene")
        self.all_scenes = flow.find_scenes(given) if given else flow.find_scenes(self.outline.get("scenes", []), os.path.dirname(path))
        self.scenes = [scene for scene in self.all_scenes if scene.mesh]
        flow.check_spec([])
        flow.make_folder()
        self.grid = self.plan()

    # ---- The runs --------------------------------------------------------------------------------

    def plan(self) -> Grid:
        bounces = str(self.outline["reference"]["bounces"])
        points: list[Point] = []
        for scene in self.scenes:
            for picture in self.pictures:
                for value in self.values:
                    last = len(points) // len(self.values) * len(self.values) + len(self.values) - 1
                    measures = {"error", "own"} | ({"time"} if picture is self.pictures[-1] else set())
                    points.append(Point(scene, self.flow.size, {"picture": picture["name"], self.parameter: value},
                                        [*picture["set"], f"{self.parameter}={value}"], measures,
                                        f"{scene.folder}/reference.reference.json", last))
        for scene in self.scenes:
            self.plan_pictures(scene, bounces)
        grid = Grid(self.flow, ["picture", self.parameter], points, self.flow.sides[:1])
        grid.plan()
        for scene in self.scenes:
            for motion in self.motions(scene):
                self.plan_motion(scene, motion, bounces)
            if len(self.flow.sides) > 1:
                words = [*self.flow.scene_words(scene), "--size", self.flow.size, *self.flow.spec_words()]
                words += self.flow.option_words("backend")
                self.flow.add("compare", f"{scene.folder}/all", words, scene, part=PARTS[4], then=" || [ $? = 1 ]")
        return grid

    def plan_pictures(self, scene: Scene, bounces: str) -> None:
        """The reference, once more with other noise, and each picture with its maps of errors."""
        flow, folder = self.flow, scene.folder
        first = add_reference(flow, scene, "reference", flow.size, ["--bounces", bounces], PARTS[0])
        again = add_reference(flow, scene, "again", flow.size, ["--bounces", bounces, "--seed", "2"], PARTS[0])
        reference = flow.path(f"{folder}/reference.reference.exr")
        flow.add("metrics", f"{folder}/noise", ["--reference", reference, "--test", flow.pattern(f"{folder}/again.reference.exr"),
                 "--flip", "ldr"], scene, needs=[again, first], part=PARTS[0])
        for picture in self.pictures:
            name = f"{folder}/{plain(picture['name'])}"
            words = [*flow.scene_words(scene), "--size", flow.size, *flow.spec_words(picture["set"]), "--backend", flow.sides[0]]
            drawn = flow.add("render", name, [*words, "-o", flow.pattern(name + ".render.exr")], scene, part=PARTS[0])
            flow.add("metrics", name, ["--reference", reference, "--test", flow.pattern(name + ".render.exr"), "-o", flow.path(name),
                     "--flip", "ldr"], scene, needs=[drawn, first], part=PARTS[0])

    def motions(self, scene: Scene) -> list[dict[str, Any]]:
        return [motion for motion in self.motion.get("of", []) if motion["scene"] == scene.name]

    def motion_stem(self, scene: Scene, motion: dict[str, Any], name: str) -> str:
        return f"{scene.folder}/{plain(motion['name'])}/{plain(name)}"

    def light(self) -> tuple[str, int]:
        """What the references of motions show, from so many bounces on."""
        return self.motion.get("quantity", "irradiance"), self.motion.get("from_bounce", 1)

    def plan_motion(self, scene: Scene, motion: dict[str, Any], bounces: str) -> None:
        flow, frames, settings = self.flow, self.motion["frames"], self.motion
        file = os.path.join(os.path.dirname(self.outline_path), motion["file"])
        moved = [*flow.scene_words(scene), "--motion", file]
        quantity, first = self.light()

        def traced(name: str, count: int, seed: str) -> list[str]:
            runs = []
            for frame in range(count):
                stem = f"{self.motion_stem(scene, motion, name)}_{frame:03}"
                words = ["--size", settings["size"], "--frame", str(frame), "--from-bounce", str(first), "--bounces", bounces,
                         "--quantity", quantity, "--spp", str(settings["spp"]), "--seed", seed, "-o", flow.path(stem + ".reference.exr")]
                runs.append(flow.add("reference", stem, [*moved, *words], scene, needs=[file], part=PARTS[2]))
            return runs

        def flicker(name: str, count: int, needs: list[str], ending: str) -> None:
            stem = self.motion_stem(scene, motion, name)
            patterns = ["--test", flow.pattern(stem + "_%03d" + ending),
                        "--reference", flow.pattern(self.motion_stem(scene, motion, "reference") + "_%03d.reference.exr")]
            flow.add("flicker", stem, [*moved, "--frames", str(count), "--block", str(settings["block"]), *patterns], scene,
                     needs=[*needs, *reference, file], part=PARTS[2])

        reference = traced("reference", frames, "1")
        count = min(NOISE_FRAMES, frames)
        flicker("noise", count, traced("noise", count, "2"), ".reference.exr")
        for run in settings["runs"]:
            stem = self.motion_stem(scene, motion, run["name"])
            words = [*moved, "--size", settings["size"], "--frames", str(frames), *flow.spec_words(run["set"]), "--backend",
                     flow.sides[0], "--show", settings["show"], "-o", flow.pattern(stem + "_%03d.exr")]
            drawn = flow.add("render", stem, words, scene, needs=[file], rule="frames", part=PARTS[2])
            flicker(run["name"], frames, [drawn], ".exr")

    def command(self) -> str:
        """That makes this report."""
        flow = self.flow
        words = [flow.program, "report", *(word for scene in self.all_scenes for word in ("--scene", scene.path))]
        words += ["--scenes", os.path.abspath(flow.meshes)] if flow.meshes else []
        words += ["--size", flow.size, *flow.spec_words(), *flow.option_words("backend"), "--outline", self.outline_path]
        return shlex.join([*words, *flow.option_words("spp", "noise", "frames", "warmup"), "-o", flow.folder])

    # ---- Numbers ---------------------------------------------------------------------------------

    def point(self, scene: Scene, picture: dict[str, Any], value: int) -> Point:
        place = self.scenes.index(scene) * len(self.pictures) + self.pictures.index(picture)
        return self.grid.points[place * len(self.values) + value]

    def cell(self, file: str, path: str, percent: bool = False) -> dict[str, str]:
        """A number with the file and the place in it that it comes from."""
        value = self.flow.number(file, path) * (100 if percent else 1)
        return {"from": f"{file}#{path}", "text": number_text(value) + ("\u00a0%" if percent and not math.isnan(value) else "")}

    def headlines(self, file: str) -> list[dict[str, str]]:
        return [{**self.cell(file, number.path), "what": number.title} for number in HEADLINES]

    def error_tables(self) -> list[dict[str, Any]]:
        tables = [(number.title, "metrics", number.path) for number in HEADLINES]
        tables.append(("relative MSE against the same picture of the last column", "own", "hdr.relative_mse"))

        def row(scene: Scene, picture: dict[str, Any], what: str, path: str) -> dict[str, Any]:
            files = [self.grid.file(self.point(scene, picture, i), what, self.flow.sides[0]) for i in range(len(self.values))]
            return {"scene": scene.name, "picture": picture["title"], "cells": [self.cell(file, path) for file in files]}

        return [{"caption": caption, "groups": [{"rows": [row(scene, picture, what, path) for picture in self.pictures]}
                                                for scene in self.scenes]} for caption, what, path in tables]

    def times(self, scene: Scene, side: str, passes: set[str] | None) -> list[float]:
        """At each value, of a stage, the sum of its passes' medians; None: the whole frame."""
        found = []
        for i in range(len(self.values)):
            point = self.point(scene, self.pictures[-1], i)
            if passes is None:
                found.append(self.grid.numbers(point, side)["frame_ms"])
                continue
            times = [ms["median"] for name, ms in self.grid.pass_ms(point, side).items() if name in passes and "median" in ms]
            found.append(sum(times) if times else math.nan)
        return found

    def stage(self, scene: Scene, name: str, doc: str, passes: set[str] | None, published: list[float] | None) -> dict[str, Any]:
        """A line for each backend, one for what was published, and each backend divided by it."""
        times = {side: self.times(scene, side, passes) for side in self.flow.sides}
        by = self.published.get("by", "")
        lines = [(side, False, ms) for side, ms in times.items()]
        if published:
            lines.append((by, True, published))
            lines += [(f"{side} / {by}", True, [a / b if b else math.nan for a, b in zip(ms, published)]) for side, ms in times.items()]
        return {"stage": name, "doc": doc, "line_count": len(lines),
                "lines": [{"label": label, "is_published": told, "cells": list(map(number_text, ms))} for label, told, ms in lines]}

    def stages(self, scene: Scene) -> list[dict[str, Any]]:
        published = self.published_of(scene)
        stages = self.outline.get("stages", [])
        named = {name for stage in stages for name in stage["passes"]}
        rows = [self.stage(scene, stage["name"], stage.get("doc", ""), set(stage["passes"]),
                           (published.get("stages") or {}).get(stage["name"])) for stage in stages]
        rows.append(self.stage(scene, "Other passes", "", set(self.grid.passes) - named, None))
        rows.append(self.stage(scene, "Whole frame", "without timestamps", None, published.get("total")))
        return rows

    def published_of(self, scene: Scene) -> dict[str, Any]:
        return self.published if self.published.get("scene") == scene.name else {}

    def told(self, published: dict[str, Any]) -> dict[str, str] | None:
        return {key: published.get(key, "") for key in ("by", "device", "size")} if published else None

    # ---- Plots -----------------------------------------------------------------------------------

    def draw(self, name: str, plot: plots.Plot) -> dict[str, Any] | None:
        """What the page has of a plot: nothing where nothing is to be seen."""
        os.makedirs(self.flow.path("plots"), exist_ok=True)
        if not plots.draw(plot, self.flow.path("plots"), name):
            return None
        return {"file": link(f"plots/{name}.svg"), "pixels": plot.height()}

    def over_values(self, label: str, lines: list[plots.Line], **more: Any) -> plots.Plot:
        return plots.Plot(self.parameter, label, self.values, lines, **more)

    def points_of(self, numbers: list[float]) -> list[tuple[float, float]]:
        return list(zip(plots.places(self.values), numbers))

    def plot_errors(self, name: str, label: str, number: Number | None) -> dict[str, Any] | None:
        """A line for each picture of a scene: colours tell scenes apart, dashes all pictures but the last."""
        column, lines = number.name if number else "own_relative_mse", []
        for colour, scene in enumerate(self.scenes):
            for dash, picture in enumerate(reversed(self.pictures)):
                points = [self.point(scene, picture, i) for i in range(len(self.values))]
                errors = [self.grid.numbers(point, self.flow.sides[0])[column] for point in points]
                if any(map(math.isfinite, errors)):
                    lines.append(plots.Line(f"{scene.name}, {picture['title']}", self.points_of(errors), colour, dash))
        is_ratio = bool(number and number.name == "ratio")
        noises = [self.flow.number(f"{scene.folder}/noise.metrics.json", number.path) for scene in self.scenes] if number else []
        noise = max([max(n, 1 / n) if is_ratio and n > 0 else n for n in noises if math.isfinite(n)], default=0)
        share = bool(number and number.share)
        return self.draw(name, self.over_values(label, lines, from_zero=share, noise=noise, noise_is_ratio=is_ratio))

    def plot_times(self, scene: Scene) -> dict[str, Any] | None:
        lines = []
        for index, side in enumerate(self.flow.sides):
            numbers = [self.grid.numbers(self.point(scene, self.pictures[-1], i), side) for i in range(len(self.values))]
            bars = [(n["frame_ms_p5"], n["frame_ms_p95"]) for n in numbers]
            lines.append(plots.Line(side, self.points_of([n["frame_ms"] for n in numbers]), index, 0, bars))
        total = self.published_of(scene).get("total")
        if total and any(math.isfinite(y) for line in lines for _, y in line.points):
            lines.append(plots.Line(f"{self.published.get('by', '')} (other hardware)", self.points_of(total), 5, 1))
        return self.draw(f"times_{scene.folder}", self.over_values("milliseconds per frame", lines))

    def changes(self, scene: Scene, motion: dict[str, Any], run: dict[str, Any], name: str) -> list[float]:
        """Per cent, of each step from frame to frame."""
        frames = (self.flow.result(self.motion_stem(scene, motion, run["name"]) + ".flicker.json") or {}).get("per_frame", [])
        found = [100 * frame[name] if isinstance(frame.get(name), (int, float)) else math.nan for frame in frames]
        return found or [math.nan] * (self.motion["frames"] - 1)

    def reference_changes(self, scene: Scene, motion: dict[str, Any]) -> list[float]:
        """From any run that has a result."""
        found = [self.changes(scene, motion, run, "relative_change_reference") for run in self.motion["runs"]]
        return next((steps for steps in found if math.isfinite(steps[0])), found[0])

    def plot_motion(self, scene: Scene, motion: dict[str, Any], kind: str) -> dict[str, Any] | None:
        """A line for each run, and the reference's change. The CSV has all of both plots: a row for each step, in per cent."""
        name, truth, runs = f"{kind}_{scene.folder}_{plain(motion['name'])}", self.reference_changes(scene, motion), self.motion["runs"]
        lines = [plots.Line(run["title"], list(enumerate(self.changes(scene, motion, run, f"relative_{kind}"), 1)), i % 5)
                 for i, run in enumerate(runs)]
        lines += [plots.Line("the reference", list(enumerate(truth, 1)), 5, 1)] * (kind == "change")
        return self.draw(name, plots.Plot("frame", f"{kind} per frame, %", [], lines, from_zero=True))

    def write_changes(self, scene: Scene, motion: dict[str, Any]) -> None:
        text, columns = io.StringIO(), {"reference": self.reference_changes(scene, motion)}
        for run in self.motion["runs"]:
            columns[run["name"]] = self.changes(scene, motion, run, "relative_change")
            columns[run["name"] + "_flicker"] = self.changes(scene, motion, run, "relative_flicker")
        table = csv.writer(text, lineterminator="\n")
        table.writerow(["frame", *columns])
        for step, row in enumerate(zip(*columns.values()), 1):
            table.writerow([step, *("" if math.isnan(value) else f"{value:.6g}" for value in row)])
        write(self.flow.path(f"plots/motion_{scene.folder}_{plain(motion['name'])}.csv"), text.getvalue())

    # ---- The page --------------------------------------------------------------------------------

    def image(self, scene: Scene, name: str, part: str) -> str:
        return link(f"{scene.folder}/{plain(name)}/{part}.png")

    def measured(self, scene: Scene, picture: dict[str, Any]) -> str:
        return f"{scene.folder}/{plain(picture['name'])}.metrics.json"

    def scene_part(self, number: int, scene: Scene) -> dict[str, Any]:
        flow, last = self.flow, self.pictures[-1]
        pictures = []
        for picture in self.pictures:
            file = self.measured(scene, picture)
            there = flow.result(file) is not None
            pictures.append({"picture": picture["title"], "errors": self.headlines(file), "reason": flow.reason(file),
                             "file": self.image(scene, picture["name"], "test") if there else ""})
        item: dict[str, Any] = {"id": number, "scene": scene.name, "pictures": pictures, "plot_times": self.plot_times(scene),
                                "scene_published": self.told(self.published_of(scene)), "stages": self.stages(scene)}
        compared = flow.result(f"{scene.folder}/all.compare.json") if len(flow.sides) > 1 else None
        broken = next((compared[key] for key in ("first_break", "not_finite") if compared and compared.get(key)), None)
        item["agree"] = compared is not None and broken is None
        item["guilty"] = (compared["guilty"] or broken)["pass"] if compared and broken else ""
        if flow.result(self.measured(scene, last)):
            self.add_reference_part(item, scene)
        item["parts"] = [{"part": part, "commands": commands} for part in PARTS
                         if (commands := [run.command for run in flow.runs.values() if run.scene is scene and run.part == part])]
        return item

    def add_reference_part(self, item: dict[str, Any], scene: Scene) -> None:
        """The reference, the FLIP map of the last picture, and any two pictures on each other."""
        last, file = self.pictures[-1], self.measured(scene, self.pictures[-1])
        traced = f"{scene.folder}/reference.reference.json"
        title = self.outline["reference"].get("title", "Reference")
        reference = self.image(scene, last["name"], "reference")
        item["reference"] = {"title": title, "file": reference, "samples": self.cell(traced, "samples"),
                             "noise": number_text(100 * self.flow.number(traced, "noise"))}
        item["map"] = {"picture": last["title"], "file": self.image(scene, last["name"], "flip_ldr"),
                       "p95": self.cell(file, "ldr.flip.p95"), "worst": self.cell(file, "ldr.flip.max")}
        choices = [{"file": self.image(scene, picture["name"], "test"), "title": picture["title"], "left": picture is last, "right": False}
                   for picture in self.pictures if self.flow.result(self.measured(scene, picture))]
        choices.append({"file": reference, "title": title, "left": False, "right": True})
        item["shown"] = {"choices": choices, "first_file": self.image(scene, last["name"], "test"), "second_file": reference}

    def motion_parts(self) -> dict[str, Any] | None:
        def row(scene: Scene, motion: dict[str, Any], name: str, title: str) -> dict[str, Any]:
            file = self.motion_stem(scene, motion, name) + ".flicker.json"
            paths = ("relative_change", "relative_change_reference", "relative_excess", "relative_flicker")
            return {"run": title, "cells": [self.cell(file, path, percent=True) for path in paths]}

        found = []
        for scene in self.scenes:
            for motion in self.motions(scene):
                rows = [row(scene, motion, run["name"], run["title"]) for run in self.motion["runs"]]
                rows.append(row(scene, motion, "noise", "The reference, other noise"))
                found.append({"scene": scene.name, "motion_title": motion["title"], "rows": rows,
                              "plot_change": self.plot_motion(scene, motion, "change"),
                              "plot_flicker": self.plot_motion(scene, motion, "flicker")})
                self.write_changes(scene, motion)
        quantity, first = self.light()
        light = f"{quantity} from bounce {first} on" if first > 1 else ("indirect " if first else "") + quantity
        return {**self.motion, "light": light, "list": found} if found else None

    def devices(self) -> list[dict[str, str]]:
        """Of the first run that has told them."""
        points = [self.point(scene, self.pictures[-1], i) for scene in self.scenes for i in range(len(self.values))]
        found = []
        for side in self.flow.sides:
            told: dict[str, Any] = next(filter(None, (self.grid.bench(point, side) for point in points)), {})
            device = told.get("device", "not known: no run of bench succeeded")
            found.append({"label": side, "device": device, "driver": told.get("driver", "")})
        return found

    def head(self) -> dict[str, Any]:
        flow, missing = self.flow, self.flow.missing()
        width, height = flow.size.split("x")
        reason = {"count": len(missing), "of": len(flow.runs), "reason": flow.reason(missing[0])} if missing else None
        with open(flow.spec, encoding="utf-8") as file:
            spec_text = file.read()
        return {"title": self.outline.get("title") or os.path.basename(flow.spec), "source": self.outline.get("source", ""),
                "spec": flow.spec, "spec_text": spec_text, "overrides": self.request.get("set", []), "width": width, "height": height,
                "parameter": self.parameter, "values": self.values, "version": self.request["version"], "commit": commit(flow.program),
                "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d"), "devices": self.devices(),
                "processor": processor(), "left_out": [scene.name for scene in self.all_scenes if not scene.mesh], "missing": reason,
                "motion": bool(self.motion), "picture_count": len(self.pictures), "command": self.command()}

    def published_parts(self) -> dict[str, Any]:
        """What was published, when its scene is in the report."""
        published: dict[str, Any] = next(filter(None, map(self.published_of, self.scenes)), {})
        by, error = published.get("by", ""), published.get("own_error") or {}
        figures = published.get("figures") or {}
        parts: dict[str, Any] = {f"figures_{name}": {"by": by, "figures": words} for name, words in figures.items()}
        parts["published"] = self.told(published)
        points = [{"error": f"{number:g}", "value": value} for number, value in zip(error.get("values", []), self.values)]
        if points:
            parts["published_error"] = {"scene": published["scene"], "by": by, "metric": error.get("metric", ""), "points": points}
        return parts

    def write_page(self) -> None:
        self.grid.read()
        self.grid.write_csv()
        data = {**self.head(), **self.published_parts(), "error_tables": self.error_tables(), "motions": self.motion_parts(),
                "scenes": [self.scene_part(*item) for item in enumerate(self.scenes)],
                "headlines": [{"what": n.title, "plot": self.plot_errors(n.name, n.title, n)} for n in HEADLINES],
                "plot_own_errors": self.plot_errors("own_errors", "relative MSE against the last value", None)}
        page.write_page(os.path.join(self.flow.templates, "report/report.html"), self.flow.path("index.html"), data)


def link(path: str) -> str:
    return urllib.parse.quote(path)


def commit(program: str) -> str:
    """That diptych was built from, where that is a checkout."""
    try:
        words = ["git", "-C", os.path.dirname(program), "describe", "--always", "--dirty"]
        return subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


def processor() -> dict[str, Any] | None:
    """As Linux names it; software drivers run on it."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return {"name": names[0], "count": len(names)} if names else None


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    if "dir" in request and request.get("collect"):
        return collect.main(console, request)
    if "dir" in request or "output" not in request:
        console.fail(f"report: {'DIR goes with --collect' if 'dir' in request else '-o DIR is missing'}; see diptych report --help")
    report = Report(console, request)
    if request.get("collect"):
        report.flow.write()
    else:
        report.flow.run(request.get("jobs", 1))
    report.flow.tell_missing()
    report.write_page()
    missing = len(report.flow.missing())
    print(f"{report.flow.folder}/index.html")
    return 1 if missing and not request.get("collect") else 0, {
        "spec": report.flow.spec, "folder": report.flow.folder, "page": "index.html", "scenes": [scene.path for scene in report.scenes],
        "steps": len(report.flow.runs), "failures": missing}
