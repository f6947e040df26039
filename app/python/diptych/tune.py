"""`diptych tune`: finds the fastest of the choices that a spec leaves to the generator and that change no bit: sizes of
workgroups, and storage and loops of ranges. Coordinate descent, in all passes at once: a round changes one value in every
pass, frames with and without the changes take turns, and each pass keeps its change if that made it faster. At the end, the
results of all passes are compared with those of the spec as it is. The program lists the choices; see app/measure/runs.c."""
from __future__ import annotations

import json
import multiprocessing
import os
import subprocess
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from statistics import median
from typing import Any, Protocol

from .console import Console, write

DEFAULT_FRAMES, WARMUP, SWEEPS, PROVEN_FRAMES = 9, 2, 2, 2
# A change is kept if the median of its ratios is at most this, and five of six are below 1: of nine without
# a difference eight would be in 2 % of all trials.
MOST_RATIO = 0.97
LEAST_SHARE = 0.01  # a pass with a smaller share of the frame is left as it is
ENOUGH_WAVES = 8  # of a SIMD, to hide latency

Sets = dict[str, str]  # of --set, by path


class Refused(Exception):
    """The generator or the device does not take a change; the text says why."""


@dataclass
class Choice:
    """One value of one path. Milliseconds are medians; None: not measured."""

    number: int  # of the pass
    name: str  # of the pass
    set: str  # PATH=VALUE
    turn: int  # its number among those of the pass
    before: float | None = None
    after: float | None = None
    ratio: float | None = None
    refused: str | None = None
    kept: bool = False

    @property
    def path(self) -> str:
        return self.set.partition("=")[0]

    def tell(self) -> None:
        if self.refused is not None:
            result = "refused: " + self.refused.partition("\n")[0]
        else:
            result = f"{self.before:9.3f} {self.after:9.3f} {self.ratio:6.2f}" + ("  kept" if self.kept else "")
        print(f"{self.name:<20} {self.set:<56} {result}", flush=True)


class Judge(Protocol):
    device: str  # what is tuned for; known after `whole`

    def renew(self, now: Sets) -> None:
        """Goes on from these settings, what is kept among them."""

    def passes(self) -> list[float]:
        """Milliseconds of each pass; NaN: not known."""

    def judge(self, trial: Sets, choices: list[Choice]) -> list[Choice]:
        """Fills in the numbers of choices that the trial has all of; returns those that are better."""

    def whole(self, first: Sets) -> tuple[float, float, float]:
        """Milliseconds of the frame with the first settings and with those that are kept, and their ratio; prints them."""


def run_program(request: dict[str, Any], verb: str, sets: Sets, *words: str) -> None:
    """Runs the verb with the pipeline of the request and these settings."""
    own = [(key, request[key]) for key in ("spec", "size", "scene", "scenes") if key in request]
    own += [("input", item) for item in request.get("input", [])] + [("set", f"{path}={value}") for path, value in sets.items()]
    run = subprocess.run([request["program"], verb, *words, *(word for key, value in own for word in (f"--{key}", value))],
                         capture_output=True, text=True, check=False)
    if run.returncode:
        raise Refused(run.stderr.strip().removeprefix("diptych: error: ") or f"exit status {run.returncode}")


# ---- Times of a device -----------------------------------------------------------------------------

Frames = list[list[float]]  # by frame, then by pass


def backend_of(request: dict[str, Any]) -> str:
    """The side as the library names it."""
    name = request.get("backend", "vk")
    if name == "vk" and "device" in request:
        name += "@" + request["device"]
    if name == "gl" and request.get("context") in ("zink", "osmesa"):
        name = request["context"]
    return name + ("+glsl" if request.get("glsl") and not name.startswith("vk") and "+" not in name else "")


def run_frames(request: dict[str, Any], both: tuple[Sets, Sets], timing: bool) -> tuple[str, list[Frames]]:
    """Device and times of two pipelines whose frames take turns. Without `timing`, of whole frames."""
    from . import play
    backend = backend_of(request)
    if backend.startswith("zink"):  # on the CPU's Vulkan driver, unless the user says LIBGL_ALWAYS_SOFTWARE=0
        os.environ.update(GALLIUM_DRIVER="zink", NODEVICE_SELECT="1")
        os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")
    width, height = map(int, request["size"].split("x"))
    inputs = dict(item.split("=", 1) for item in request.get("input", []))
    pipelines = [play.open(request["spec"], backend, request.get("scene"), (width, height),
                           {path: play.Text(value) for path, value in sets.items()}, inputs, request.get("scenes"),
                           timing=timing) for sets in both]
    frames: list[Frames] = [[], []]
    for frame in range(WARMUP + request["frames"]):
        for pipeline, times in zip(pipelines, frames):
            start = time.perf_counter()
            pipeline.render()
            whole = 1000 * (time.perf_counter() - start)
            if frame >= WARMUP:
                times.append([float("nan") if ms is None else ms for ms in pipeline.timings.values()] if timing else [whole])
    return pipelines[0].description["device"], frames


def try_frames(*arguments: Any) -> tuple[bool, Any]:
    try:
        return True, run_frames(*arguments)
    except Exception as error:  # the library's class is not loaded on the other side
        return False, str(error)


def measure(*arguments: Any) -> tuple[str, list[Frames]]:
    """run_frames in a process of its own, which a driver may crash."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("fork")) as pool:
        try:
            good, result = pool.submit(try_frames, *arguments).result()
        except BrokenProcessPool:
            good, result = False, "the process that rendered was ended by a signal"
    if not good:
        raise Refused(result)
    return result


class Times:
    """Judges changes by frames that take turns."""

    def __init__(self, request: dict[str, Any]):
        self.request, self.device = request, ""
        self.now: Sets = {}

    def renew(self, now: Sets) -> None:
        self.now = now

    def passes(self) -> list[float]:
        frames = measure(self.request, (self.now, self.now), True)[1][0]
        return [median(times) for times in zip(*frames)]

    def judge(self, trial: Sets, choices: list[Choice]) -> list[Choice]:
        first, second = measure(self.request, (self.now, trial), True)[1]
        better = []
        for choice in choices:
            before, after = ([times[choice.number] for times in frames] for frames in (first, second))
            ratios = [b / a if a else float("nan") for a, b in zip(before, after)]
            choice.before, choice.after, ratio = median(before), median(after), median(ratios)
            choice.ratio = ratio
            if ratio <= MOST_RATIO and 6 * sum(one < 1 for one in ratios) >= 5 * len(ratios):
                better.append(choice)
        return better

    def whole(self, first: Sets) -> tuple[float, float, float]:
        """Without timestamps, which can slow a frame down."""
        self.device, frames = measure(self.request, (first, self.now), False)
        before, after = ([times[0] for times in each] for each in frames)
        was, now, ratio = median(before), median(after), median([b / a for a, b in zip(before, after)])
        print(f"frame: {was:.3f} ms before, {now:.3f} after, {ratio:.3f} of it, medians of {len(before)} frames in turn")
        return was, now, ratio


# ---- Estimates for a chip --------------------------------------------------------------------------


class Estimates:
    """Judges changes by the figures of a GPU's compiler, as `cost` has them."""

    def __init__(self, request: dict[str, Any]):
        self.request, self.device = request, ""
        self.was: dict[str, Any] = {}

    def ask(self, sets: Sets) -> dict[str, Any]:
        with tempfile.TemporaryDirectory() as folder:
            run_program(self.request, "cost", sets, "--gpu", self.request["gpu"], "--json", f"{folder}/cost.json")
            with open(f"{folder}/cost.json", encoding="utf-8") as file:
                return dict(json.load(file)["gpus"][0])

    def renew(self, now: Sets) -> None:
        self.was = self.ask(now)

    def ms(self, figures: dict[str, Any], number: int) -> float:
        """Of arithmetic, or of one wave if that is more. Where its count is not known, of one wave on each SIMD."""
        entry = figures["passes"][number]
        if entry["arithmetic_ms"] is None:
            return sum(stage["cycles"] for stage in entry["stages"]) / (figures["chip"]["ghz"] * 1e6)
        return max(entry["arithmetic_ms"], entry["wave_ms"] or 0)

    def passes(self) -> list[float]:
        return [self.ms(self.was, number) for number in range(len(self.was["passes"]))]

    def has_price(self, found: dict[str, Any], number: int) -> bool:
        """Whether a change costs what cycles do not show: spills, waves, an instruction cache."""
        was, now = (figures["passes"][number]["stages"] for figures in (self.was, found))
        spills, code = ([sum(stage[key] for stage in stages) for stages in (was, now)] for key in ("spills", "code"))
        waves = [min((stage["waves"] for stage in stages), default=ENOUGH_WAVES) for stages in (was, now)]
        return (spills[1] > spills[0] or (waves[1] < ENOUGH_WAVES and waves[1] < waves[0])
                or (code[1] > found["chip"]["code_kib"] * 1024 and code[1] > code[0]))

    def judge(self, trial: Sets, choices: list[Choice]) -> list[Choice]:
        found, better = self.ask(trial), []
        for choice in choices:
            choice.before, choice.after = self.ms(self.was, choice.number), self.ms(found, choice.number)
            choice.ratio = choice.after / choice.before
            if choice.ratio <= MOST_RATIO and not self.has_price(found, choice.number):
                better.append(choice)
        return better

    def whole(self, first: Sets) -> tuple[float, float, float]:
        was, now = (sum(self.ms(figures, i) for i in range(len(figures["passes"]))) for figures in (self.ask(first), self.was))
        self.device = self.was["chip"]["product"]
        print(f"estimates of all passes, one after another: {was:.3f} ms before, {now:.3f} after, {now / was:.3f} of it")
        return was, now, now / was


# ---- The search ------------------------------------------------------------------------------------


class Search:
    def __init__(self, judge: Judge, choices: list[Choice], given: Sets):
        self.judge, self.choices, self.given = judge, choices, given
        self.kept: dict[str, Choice] = {}  # by path

    def sets(self, *more: Choice) -> Sets:
        return {**self.given, **{choice.path: choice.set.partition("=")[2] for choice in (*self.kept.values(), *more)}}

    def drop_small_passes(self) -> None:
        passes = self.judge.passes()
        total = sum(ms for ms in passes if ms == ms)
        self.choices = [choice for choice in self.choices if passes[choice.number] >= LEAST_SHARE * total]

    def attempt(self, choices: list[Choice]) -> None:
        """Changes of different passes at once. What the generator or the device refuses is found by halves."""
        try:
            better = self.judge.judge(self.sets(*choices), choices)
        except Refused as refusal:
            if len(choices) == 1:
                choices[0].refused = str(refusal)
                choices[0].tell()
                return
            self.attempt(choices[:len(choices) // 2])
            self.attempt(choices[len(choices) // 2:])
            return
        for choice in better:
            if choice.path in self.kept:
                self.kept[choice.path].kept = False
            self.kept[choice.path], choice.kept = choice, True
        for choice in choices:
            choice.tell()
        if better:
            self.judge.renew(self.sets())

    def run(self) -> None:
        """Each pass changes one value in a round; the next round begins with what was kept. Passes that have kept
        something are searched again."""
        for sweep in range(SWEEPS):
            found = 0
            for turn in range(max((choice.turn + 1 for choice in self.choices), default=0)):
                again = {choice.number for choice in self.kept.values()}
                tried = [choice for choice in self.choices if choice.turn == turn and not choice.kept
                         and choice.refused is None and (sweep == 0 or choice.number in again)]
                if tried:
                    self.attempt(tried)
                found += sum(choice.kept for choice in tried)
            if not found:
                return

    def forget(self) -> None:
        for choice in self.kept.values():
            choice.kept = False
        self.kept = {}


def prove(console: Console, request: dict[str, Any], first: Sets, now: Sets) -> None:
    """Every resource after every pass, with the choices and without."""
    rows: list[dict[str, Any]] = []
    side = ["--backend", request.get("backend", "vk"), *(["--glsl"] if request.get("glsl") else [])]
    side += [word for key in ("device", "context") if key in request for word in (f"--{key}", request[key])]
    for frames in range(1, PROVEN_FRAMES + 1):
        with tempfile.TemporaryDirectory(prefix="tune-", dir=os.path.dirname(request["output"]) or ".") as folder:
            for name, sets in (("before", first), ("after", now)):
                run_program(request, "render", sets, "--frames", str(frames), "--dump", f"{folder}/{name}", *side)
            subprocess.run([request["program"], "compare", f"{folder}/before", f"{folder}/after", "--json", f"{folder}/json"],
                           stdout=subprocess.DEVNULL, check=False)
            with open(f"{folder}/json", encoding="utf-8") as file:
                rows = json.load(file)["results"]
        for row in rows:
            if row["differing"]:
                console.fail(f"{row['resource']} differs after pass {row['pass']}: a choice changes bits, which none should; the "
                             "spec is not exact on this device")
    print(f"all {len(rows)} resources of {len(request['passes'])} passes have the same bits as before, in {PROVEN_FRAMES} frames")


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    request.setdefault("frames", DEFAULT_FRAMES)
    given = dict(item.split("=", 1) for item in request.get("set", []))
    choices: list[Choice] = []
    for number, text in request["choices"]:
        turn = sum(choice.number == number for choice in choices)
        choices.append(Choice(number, request["passes"][number], text, turn))
    judge: Judge = Times(request)
    if "gpu" in request:
        judge = Estimates(request)
    search = Search(judge, choices, given)
    try:
        judge.renew(given)
        search.drop_small_passes()
        print(f"{'pass':<20} {'change':<56} {'ms before':>9} {'after':>9} {'ratio':>6}")
        search.run()
        prove(console, request, given, search.sets())
        before, after, ratio = judge.whole(given)
    except Refused as refusal:
        console.fail(str(refusal))
    if search.kept and ratio >= 1 and "gpu" not in request:  # noise has kept them
        print("no faster: nothing is kept; give more --frames, or a quieter machine")
        search.forget()
    told = f"a frame takes {ratio:.3f} of its time" if search.kept else "nothing was faster"
    write(request["output"], "".join(
        [f"# For --with. By diptych tune: {request['pipeline']} on {judge.device}, {request['size']} pixels: {told}.\n",
         *(f"- {choice.set}\n" for choice in search.kept.values())]))

    def tried(choice: Choice) -> dict[str, Any]:
        entry = {"pass": choice.name, "set": choice.set, "before_ms": choice.before, "after_ms": choice.after,
                 "ratio": choice.ratio, "kept": choice.kept}
        return entry if choice.refused is None else {**entry, "refused": choice.refused}
    return 0, {"pipeline": request["pipeline"], "device": judge.device, "before_ms": before, "after_ms": after, "ratio": ratio,
               "tried": [tried(choice) for choice in search.choices]}
