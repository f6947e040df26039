"""`diptych sweep`, and the grid of measurements that it shares with report.py: at each point, a scene with some values set, whether
the backends agree, the times of all passes, and errors against a path-traced reference or against the last point of the x axis."""
from __future__ import annotations

import csv
import dataclasses
import io
import itertools
import json
import math
import os
import re
import shlex
from typing import Any, Iterator

from . import page, plots
from .console import Console, write
from .metrics import TITLES
from .workflow import NO_SCENE, Scene, Workflow, plain

MOST_POINTS = 100000
MEASURES = ("agree", "time", "error", "own")


@dataclasses.dataclass(frozen=True)
class Number:
    """A number of `diptych metrics`; `path` in its JSON. `share`: from 0 to 1, so that a plot begins at 0."""

    name: str
    title: str
    path: str
    share: bool = False


# The headlines, which stand in tables and plots, come first. Names and titles are those of metrics.py.
HEADLINES = [Number(name, TITLES[name], path, path in ("hdr.darker", "hdr.brighter")) for name, path in (
    ("relative_mse", "hdr.relative_mse"), ("smape", "hdr.smape"), ("flip", "ldr.flip.mean"), ("ratio", "hdr.ratio"),
    ("darker", "hdr.darker"), ("brighter", "hdr.brighter"))]
NUMBERS = HEADLINES + [Number(name, name, path) for name, path in (
    ("rmse", "hdr.rmse"), ("psnr", "ldr.psnr"), ("mean_absolute", "hdr.mean_absolute"), ("mean_test", "hdr.mean_test"),
    ("mean_reference", "hdr.mean_reference"))]
SPREAD = {"": "median", "_p5": "p5", "_p95": "p95"}


# ---- A grid of measurements ------------------------------------------------------------------------


@dataclasses.dataclass
class Point:
    """`values` by column; `sets`: those and others, PATH=VALUE. `last`: index of the point that `own` compares with."""

    scene: Scene
    size: str
    values: dict[str, str]
    sets: list[str]
    measures: set[str]
    reference: str = ""
    last: int = 0
    number: int = 0

    @property
    def stem(self) -> str:
        """Its files' names, without an ending."""
        name = plain("_".join([self.size] + [f"{path}_{value}" for path, value in self.values.items()]))
        return f"{self.scene.folder}/{name if len(name) < 150 else self.number}"


class Grid:
    """`pictured`: the sides whose pictures are measured. `passes`: those that any run has times of."""

    def __init__(self, flow: Workflow, columns: list[str], points: list[Point], pictured: list[str]):
        self.flow, self.columns, self.points, self.pictured = flow, columns, points, pictured
        self.measures = set().union(*(point.measures for point in points))
        self.every_frame = bool(flow.request.get("every_frame"))
        self.passes: list[str] = []
        for number, point in enumerate(points):
            point.number = number

    def file(self, point: Point, what: str, side: str = "") -> str:
        return f"{point.stem}{'_' if side else ''}{plain(side)}.{what}.json"

    def plan(self) -> None:
        """Adds the runs of all points; errors of their own come last, when all pictures are planned."""
        flow = self.flow
        for point in self.points:
            words = [*flow.scene_words(point.scene), "--size", point.size, *flow.spec_words(point.sets)]
            frames = [] if self.flow.console.verb == "report" else flow.option_words("frames")
            for side in self.pictured if point.measures & {"error", "own"} else []:
                self.plan_picture(point, side, [*words, *frames])
            if "time" in point.measures:
                flow.add("bench", point.stem, [*words, *flow.option_words("backend", "frames", "warmup")], point.scene, part="Times")
            if "agree" in point.measures:
                given = flow.option_words("backend", "device", "context", "glsl", "debug")
                flow.add("compare", point.stem, [*words, *given, *frames], point.scene, then=" || [ $? = 1 ]")
        for point in self.points:
            for side in self.pictured if "own" in point.measures and self.points[point.last] is not point else []:
                pictures = [self.file(p, "render", side) for p in (self.points[point.last], point)]
                reference, test = (file.removesuffix("json") + "exr" for file in pictures)
                words = ["--reference", flow.path(reference), "--test", flow.pattern(test), "--flip", "ldr"]
                flow.add("metrics", f"{point.stem}_{plain(side)}", words, point.scene, needs=pictures, rule="own",
                         part="Errors of the sweep")

    def plan_picture(self, point: Point, side: str, words: list[str]) -> None:
        flow, name = self.flow, f"{point.stem}_{plain(side)}"
        words = [*words, "--backend", side, *flow.option_words("show")]
        test = flow.pattern(name + ("_%03d.exr" if self.every_frame else ".render.exr"))
        picture = flow.add("render", name, [*words, "-o", test], point.scene, rule="frames" if self.every_frame else "",
                           part="Errors of the sweep")
        if "error" in point.measures:
            reference = flow.path(point.reference.removesuffix(".json") + ".exr")
            frames = flow.option_words("frames") if self.every_frame else []
            flow.add("metrics", name, ["--reference", reference, "--test", test, *frames, "--flip", "ldr"], point.scene,
                     needs=[picture, point.reference], part="Errors of the sweep")

    # ---- What was measured -----------------------------------------------------------------------

    def numbers(self, point: Point, side: str) -> dict[str, float]:
        """By the names of the columns that the grid has; NaN where there is none."""
        found: dict[str, float] = {}
        if "time" in self.measures:
            frame = self.bench(point, side).get("frame_ms") or {}
            found.update({"frame_ms" + end: frame.get(of, math.nan) for end, of in SPREAD.items()})
        for measure, what, before in (("error", "metrics", ""), ("own", "own", "own_")):
            for number in NUMBERS if measure in self.measures else []:
                file = self.file(point, what, side)
                found[before + number.name] = self.flow.number(file, number.path)
                if self.every_frame and measure == "error":
                    found[number.name + "_standard_error"] = self.flow.number(file, "standard_errors." + number.path)
        return found

    def bench(self, point: Point, side: str) -> dict[str, Any]:
        sides = (self.flow.result(self.file(point, "bench")) or {}).get("sides", [])
        return next((item for item, label in zip(sides, self.flow.sides) if label == side), {})

    def pass_ms(self, point: Point, side: str) -> dict[str, dict[str, float]]:
        return {item["pass"]: item.get("ms") or {} for item in self.bench(point, side).get("passes", [])}

    def agreement(self, point: Point) -> str:
        result = self.flow.result(self.file(point, "compare"))
        return "" if not result else "no" if result["exit_status"] else "yes"

    def reason(self, point: Point, side: str) -> str | None:
        """Why a row is incomplete, or None."""
        files = [self.file(point, "bench"), *(self.file(point, what, side) for what in ("metrics", "own", "render", "frames")),
                 self.file(point, "compare")]
        return next(filter(None, map(self.flow.reason, files)), None)

    def rows(self) -> Iterator[tuple[Point, str]]:
        """A point has no row of a side that nothing of it is measured on."""
        for point in self.points:
            for side in self.flow.sides:
                if side in self.pictured or point.measures & {"time", "agree"}:
                    yield point, side

    def read(self) -> None:
        for point in self.points:
            for name in self.pass_ms(point, self.flow.sides[0]):
                if name not in self.passes:
                    self.passes.append(name)

    def json(self) -> list[dict[str, Any]]:
        """A row for each point and side, as --json has it."""
        rows = []
        for point, side in self.rows():
            width, height = map(int, point.size.split("x"))
            reason, agree = self.reason(point, side), self.agreement(point)
            row: dict[str, Any] = {"scene": point.scene.path, "backend": side, "width": width, "height": height,
                                   "values": point.values, "status": "failed" if reason else "done"}
            row.update({"reason": reason} if reason else {})
            row.update({"agree": agree} if agree else {})
            row.update({name: value for name, value in self.numbers(point, side).items() if math.isfinite(value)})
            if "time" in point.measures:
                times = self.pass_ms(point, side)
                row["passes"] = {name: times[name]["median"] for name in self.passes if "median" in times.get(name, {})}
            rows.append(row)
        return rows

    def write_csv(self) -> None:
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        agrees = "agree" in self.measures
        for first, (point, side) in enumerate(self.rows()):
            numbers, times, reason = self.numbers(point, side), self.pass_ms(point, side), self.reason(point, side)
            if not first:
                table.writerow(["scene", "backend", "width", "height", *self.columns, "status", "reason", *["agree"] * agrees, *numbers,
                                *(f"{name}_ms{end}" for name in self.passes for end in SPREAD)])
            values = [*numbers.values(), *(times.get(name, {}).get(of, math.nan) for name in self.passes for of in SPREAD.values())]
            table.writerow([point.scene.name, side, *point.size.split("x"), *point.values.values(), "failed" if reason else "done",
                            reason or "", *[self.agreement(point)] * agrees, *(f"{v:.6g}" if math.isfinite(v) else "" for v in values)])
        write(self.flow.path("rows.csv"), text.getvalue())


def add_reference(flow: Workflow, scene: Scene, name: str, size: str, words: list[str], part: str = "") -> str:
    """Path-traces a scene; returns the run's file. The film is of its settings alone: others cannot go on with it."""
    words = [*flow.scene_words(scene), "--size", size, *words, *flow.option_words("spp", "noise")]
    stem = f"{scene.folder}/{name}"
    film = flow.path(stem + plain("_".join(words[len(flow.scene_words(scene)):])) + ".film")
    return flow.add("reference", stem, [*words, "-o", flow.path(stem + ".reference.exr"), "--checkpoint", film], scene, part=part,
                    then=f" && rm -f {shlex.quote(film)}")


# ---- The verb --------------------------------------------------------------------------------------


def axis(row: str, console: Console) -> tuple[str, list[str]]:
    """Path and values of --grid PATH=V1,V2,...; commas in brackets separate nothing."""
    path, equals, rest = row.partition("=")
    if not path or not equals or not rest:
        console.fail(f"--grid {row}: must be PATH=V1,V2,..., like clusters=4,8")
    values, depth = [""], 0
    for letter in rest:
        depth += (letter in "[{") - (letter in "]}")
        if letter == "," and depth <= 0:
            values.append("")
        else:
            values[-1] += letter
    return path, values


def check(request: dict[str, Any], measures: list[str], console: Console) -> None:
    errors = {"error", "own"} & set(measures)
    alone = measures == ["agree"]
    wrong = [
        (not set(measures) <= set(MEASURES), f"--measure {request.get('measure')}: must be some of {','.join(MEASURES)}"),
        (alone and not request.get("grid"), "give --grid PATH=V1,V2,..."),
        (not alone and any(request.get(name) for name in ("device", "context", "glsl", "debug")),
         "--device, --context, --glsl and --debug go with --measure agree alone; --backend takes gl+glsl, osmesa, zink and vk@DEVICE"),
        (not request.get("scene") and "error" in measures, "--measure error needs at least one --scene FILE"),
        (request.get("show") and not errors, "--show goes with --measure error or own"),
        (request.get("every_frame") and ("error" not in measures or "own" in measures or request.get("frames", 1) < 2),
         "--every-frame goes with --measure error, without own, and needs two --frames at least"),
        (request.get("warmup") and "time" not in measures, "--warmup goes with --measure time"),
    ]
    for is_wrong, why in wrong:
        if is_wrong:
            console.fail(f"sweep: {why}; see diptych sweep --help")


class Sweep:
    """`axes`: values by path, in the order of --grid; `x`: that of the plots."""

    def __init__(self, console: Console, request: dict[str, Any]):
        self.console, self.request = console, request
        self.measures = str(request.get("measure", "agree")).split(",")
        check(request, self.measures, console)
        self.axes = dict(axis(row, console) for row in request.get("grid", []))
        self.x: str = str(request.get("x") or next(iter(self.axes), ""))
        if self.x not in self.axes and request.get("x"):
            console.fail(f"--x {self.x}: must be the path of a --grid")
        self.flow = Workflow(console, request)
        self.drawings: list[dict[str, str]] = []

    def alone(self) -> bool:
        return self.measures == ["agree"]

    def plan(self) -> Grid:
        request, flow = self.request, self.flow
        if not request.get("collect"):
            flow.needs_programs(["yaml"] + ["matplotlib"] * (not self.alone()))
        product = itertools.islice(itertools.product(*self.axes.values()), MOST_POINTS + 1)
        combinations = [dict(zip(self.axes, values)) for values in product]
        scenes = flow.find_scenes(request["scene"]) if request.get("scene") else [NO_SCENE]
        flow.check_spec([f"{path}={value}" for path, value in combinations[0].items()])
        fills = request.get("input") and flow.size != "1920x1080"
        sizes = request.get("size") or [flow.size if fills or not self.alone() else "64x64"]
        for size in sizes:
            if not re.fullmatch("[1-9][0-9]{0,4}x[1-9][0-9]{0,4}", size):
                self.console.fail(f"--size {size}: must be WIDTHxHEIGHT, like 1280x720")
        if len(combinations) * len(scenes) * len(sizes) > MOST_POINTS:
            self.console.fail(f"the grid has more than {MOST_POINTS} points; give fewer values")
        flow.make_folder()
        points = [Point(scene, size, values, [f"{path}={value}" for path, value in values.items()], set(self.measures))
                  for scene in scenes if scene.mesh is not None for size in sizes for values in combinations]
        self.set_last(points)
        for point in points if "error" in self.measures else []:
            point.reference = f"{point.scene.folder}/{point.size}.reference.json"
            if point.reference not in flow.runs:
                add_reference(flow, point.scene, point.size, point.size, flow.option_words("from-bounce", "bounces", "quantity"))
        grid = Grid(flow, list(self.axes), points, flow.sides if {"error", "own"} & set(self.measures) else [])
        grid.plan()
        return grid

    def set_last(self, points: list[Point]) -> None:
        """Along the x axis."""
        stride, count = 1, len(self.axes.get(self.x, [""]))
        for path, values in reversed(self.axes.items()):
            if path == self.x:
                break
            stride *= len(values)
        for number, point in enumerate(points):
            point.last = number + (count - 1 - number // stride % count) * stride

    # ---- Plots -----------------------------------------------------------------------------------

    def line_title(self, point: Point, side: str) -> str:
        words = [point.scene.name] + [point.size] * (len(self.request.get("size", [])) > 1)
        words += [f"{path} {value}" for path, value in point.values.items() if path != self.x and len(self.axes[path]) > 1]
        return ", ".join([*words, side])

    def draw(self, grid: Grid, name: str, label: str, from_zero: bool = False) -> None:
        """A line for each side and each combination of the other values."""
        values = self.axes[self.x]
        groups: dict[int, list[Point]] = {}
        for point in grid.points:
            groups.setdefault(point.last, []).append(point)
        lines, sides = [], self.flow.sides
        for number, points in enumerate(groups.values()):
            for index, side in enumerate(sides):
                numbers = [grid.numbers(point, side) for point in points]
                line = plots.Line(self.line_title(points[0], side),
                                  list(zip(plots.places(values), [n.get(name, math.nan) for n in numbers])))
                line.colour, line.dash = (index, number) if len(sides) > 1 else (number, index)
                if name == "frame_ms":
                    line.bars = [(n.get("frame_ms_p5", math.nan), n.get("frame_ms_p95", math.nan)) for n in numbers]
                lines.append(line)
        if plots.draw(plots.Plot(self.x, label, values, lines, from_zero, beside=True), self.flow.folder, name):
            self.drawings.append({"file": name + ".svg", "title": label})

    def draw_all(self, grid: Grid) -> None:
        self.draw(grid, "frame_ms", "milliseconds per frame")
        self.draw(grid, "own_relative_mse", "relative MSE against the last value")
        for number in HEADLINES:
            self.draw(grid, number.name, number.title, number.share)

    # ---- What is printed -------------------------------------------------------------------------

    def print_rows(self, grid: Grid, rows: list[dict[str, Any]]) -> int:
        """A table in Markdown; returns the number of incomplete rows."""
        names = ["frame_ms"] * ("time" in self.measures) + [n.name for n in HEADLINES if "error" in self.measures]
        names += ["own_relative_mse"] * ("own" in self.measures)
        width = 17 if grid.every_frame else 12
        heads = [f"{'scene':10}", f"{'backend':7}", f"{'size':>9}", *self.axes, *(f"{name:>{width}}" for name in names)]
        print("| " + " | ".join(heads) + " |\n|" + "---|" * len(heads))
        for (point, side), row in zip(grid.rows(), rows):
            cells = [f"{point.scene.name:10}", f"{side:7}", f"{point.size:>9}"]
            cells += [f"{value:>{len(path)}}" for path, value in point.values.items()]
            for name in names:
                error, value = row.get(name + "_standard_error"), row.get(name)
                number = f"{value or 0:12.5g}" if error is None else f"{value:8.4f} \u00b1 {error:.4f}"
                cells.append(f"{'-':>{width}}" if value is None else number)
            print("| " + " | ".join(cells) + " |" + (" " + row["reason"] if "reason" in row else ""))
        failed = [row["status"] for row in rows].count("failed")
        print(f"\n{len(rows)} rows in {self.flow.folder}/rows.csv: {len(rows) - failed} done, {failed} failed")
        return failed

    def measured(self, grid: Grid) -> tuple[int, dict[str, Any]]:
        """Rows, plots and page of --measure."""
        grid.read()
        grid.write_csv()
        if self.axes:
            self.draw_all(grid)
        rows = grid.json()
        failed = self.print_rows(grid, rows)
        write_sweep_page(self.flow, rows, self.drawings, "rows.csv")
        self.flow.tell_missing()
        differs = any(row.get("agree") == "no" for row in rows)
        result = {"spec": self.flow.spec, "folder": self.flow.folder, "csv": "rows.csv", "failed": failed, "rows": rows}
        return 2 if failed else 1 if differs else 0, result

    def compared(self, grid: Grid) -> tuple[int, dict[str, Any]]:
        """Summary and page of comparisons alone."""
        runs = [self.comparison(grid, point) for point in grid.points]
        totals = {verdict: sum(run["verdict"] == verdict for run in runs) for verdict in ("agree", "differ", "failed", "not run")}
        result = {**totals, "runs": runs}
        write(self.flow.path("summary.json"), json.dumps(result, indent=1))
        heads = ["run", "verdict", "seconds", "scene", "width", "height", "frames", "sets", "pass", "resource", "error"]
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerows([heads, *([" ".join(v) if isinstance(v := run.get(head, ""), list) else v for head in heads] for run in runs)])
        write(self.flow.path("summary.csv"), text.getvalue())
        write_sweep_page(self.flow, runs, [], "summary.csv")
        print_comparisons(runs, totals)
        return 2 if totals["failed"] or totals["not run"] else 1 if totals["differ"] else 0, result

    def comparison(self, grid: Grid, point: Point) -> dict[str, Any]:
        flow, file = self.flow, grid.file(point, "compare")
        width, height = map(int, point.size.split("x"))
        result, log = flow.result(file), flow.log(file)
        seconds = next((float(line.split()[1]) for line in reversed(log) if re.fullmatch(r"seconds [0-9.]+", line)), 0.0)
        run: dict[str, Any] = {
            "scene": point.scene.path, "width": width, "height": height, "frames": self.request.get("frames", 1), "exact": True,
            "sets": point.sets + self.request.get("set", []), "command": flow.runs[file].command.removesuffix(" || [ $? = 1 ]"),
            "run": point.number + 1, "verdict": "not run", "seconds": seconds}
        if result:
            run["verdict"] = "differ" if result["exit_status"] else "agree"
            run.update({key: place[key] for place in [find_place(result) or {}] for key in ("pass", "resource") if key in place})
        elif any("error: " in line for line in log):
            run.update({"verdict": "failed", "error": flow.reason(file)})
        return run


def find_place(result: dict[str, Any]) -> dict[str, Any] | None:
    """The guilty pass of a comparison, or the first that broke or left NaN; of several pairs, the first that has one."""
    for place in (result.get("guilty"), result.get("first_break"), result.get("not_finite"), *map(find_place, result.get("pairs", []))):
        if isinstance(place, dict):
            return place
    return None


def print_comparisons(runs: list[dict[str, Any]], totals: dict[str, int]) -> None:
    print(f"{'run':>5}  {'verdict':10} {'seconds':>8}  {'scene':18} {'size':>9} {'frames':>6}  settings")
    for run in runs:
        settings, scene = " ".join(run["sets"]), os.path.basename(run["scene"])
        print(f"{run['run']:5}  {run['verdict']:10} {run['seconds']:8.2f}  {scene:18} {run['width']}x{run['height']:<6} {run['frames']:6}  "
              + settings[:60] + "..." * (len(settings) > 60))
    for run in runs:
        if run["verdict"] == "differ":
            print(f"\nrun {run['run']}: pass {run.get('pass', 'unknown')}, resource {run.get('resource', 'unknown')}\n  {run['command']}")
        elif run["verdict"] == "failed":
            print(f"\nrun {run['run']}: {run['error']}\n  {run['command']}")
    seconds = sum(run["seconds"] for run in runs)
    told = [f"{count} {name}" for name, count in totals.items() if count or name in ("agree", "differ")]
    print(f"\n{len(runs)} runs, {seconds:.1f} s of work: {', '.join(told)}")


def write_sweep_page(flow: Workflow, rows: list[dict[str, Any]], drawings: list[dict[str, str]], table: str) -> None:
    """All members of the rows, whatever they are, but the command, which stands below for what is not as it should be."""
    def text(value: Any) -> str:
        if isinstance(value, (dict, list)):
            return " ".join(map(text, value.values() if isinstance(value, dict) else value))
        return ("yes" if value else "no") if isinstance(value, bool) else f"{value:.6g}" if isinstance(value, float) else str(value)

    def count(**members: str) -> int:
        return sum(any(row.get(name) in values.split(",") for name, values in members.items()) for row in rows)

    heads = list(dict.fromkeys(name for row in rows for name in row if name != "command"))
    differ, agree = count(verdict="differ", agree="no"), count(verdict="agree", agree="yes")
    failed = count(verdict="failed,not run", status="failed")
    verdicts = [(differ, "differ", "differ"), (failed, "differ", "could not run"),
                (0 if differ or failed or agree else count(status="done"), "agree", "measured"), (agree, "agree", "agree")]
    shown, cases = [], []
    for row in rows:
        good = row.get("verdict") == "agree" or row.get("agree") == "yes"
        bad = row.get("verdict") in ("differ", "failed") or row.get("agree") == "no"
        cells = [{"text": text(row.get(head, "")), "word": not isinstance(row.get(head), (int, float)) or isinstance(row[head], bool)}
                 for head in heads]
        shown.append({"class": "agree" if good else "differ" if bad else "", "cells": cells})
        if bad and "command" in row:
            cases.append({"run": row["run"], "command": row["command"]})
    data = {"folder": os.path.basename(flow.folder), "csv": table, "rows": shown, "cases": cases, "plots": drawings, "heads": heads,
            "verdicts": [{"class": kind, "text": f"{number} of {len(rows)} {what}"} for number, kind, what in verdicts if number]}
    page.write_page(os.path.join(flow.templates, "report/sweep.html"), flow.path("index.html"), data)


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    if request.get("collect"):
        former = Workflow(console, request).former()
        if former.get("verb") != "sweep":
            console.fail(f"{request['output']}: is no folder of diptych sweep")
        own = ("output", "collect", "json", "program", "templates")
        request = {**former["request"], **{name: request[name] for name in own if name in request}}
    sweep = Sweep(console, request)
    grid = sweep.plan()
    if not request.get("collect"):
        sweep.flow.run(request.get("jobs") or ((os.cpu_count() or 1) if sweep.alone() else 1))
    return sweep.compared(grid) if sweep.alone() else sweep.measured(grid)
