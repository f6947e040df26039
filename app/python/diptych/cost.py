"""`diptych cost`: what a frame costs on a GPU, without one: the figures of its compiler, which the C program asks
(app/measure/cost.c), and arithmetic."""
from __future__ import annotations

import json
import math
from typing import Any, NamedTuple

from .console import Console

Json = dict[str, Any]
UNKNOWN = """\
Bounds by arithmetic. Not known: rasterization, caches, hidden latency, how passes overlap; turns of loops that neither
constants nor parameters tell.
waves: most on a SIMD, and what keeps them from being more. started: waves of a frame. ms: they keep all SIMDs busy;
wave ms: one of each stage; bytes ms: all that is read and written, once, at the memory's rate. !: more than the instruction cache."""

# In the JSON, the names that drivers give: RADV's first, then those of others. Figures of one kind are added.
FIGURES = {
    "vgprs": ("VGPRs", "Register Count"),  # NVIDIA
    "waves": ("Subgroups per SIMD",),  # at most; RADV counts a wave of 64 on RDNA as two
    "spills": ("Spilled VGPRs", "Spilled SGPRs", "Spill Count"),
    "scratch": ("Scratch size",),  # bytes
    "code": ("Code size", "Code Size"),  # bytes; NVK
    "lds": ("LDS size",),  # bytes
    "instructions": ("Instructions", "Instruction Count", "Instruction count"),  # Intel, Turnip; NVK
    "cycles": ("Inverse Throughput",),  # of a SIMD for each wave, if all its units are kept busy
    "latency": ("Latency",),  # cycles from a wave's begin to its end
}

# AMD's, as app/measure/cost_run.c names them. Compute units, boost clock and memory: AMD's product pages. SIMDs of a compute unit: 4 of
# 16 lanes in GCN, 2 of 32 in RDNA. Registers, their steps, waves and instruction cache: AMD's instruction set manuals ("Vega" 2017,
# "RDNA" 2020, "RDNA 2" 2020, "RDNA3" 2023) and the whitepapers "GCN Architecture" (2012) and "RDNA Architecture" (2019).
# vgprs: of a SIMD for waves of 64, given in steps of granularity. most_waves: of a SIMD, as RADV counts them: of 32 on RDNA.
CHIP = ("name", "families", "product", "simds", "ghz", "gb_s", "code_kib", "vgprs", "granularity", "most_waves")
CHIPS: list[Json] = [dict(zip(CHIP, row)) for row in (
    ("polaris10", ("POLARIS10",), "Radeon RX 480", 36 * 4, 1.266, 256, 32, 256, 4, 8),
    ("vega10", ("VEGA10",), "Radeon RX Vega 64", 64 * 4, 1.546, 484, 32, 256, 4, 10),
    ("navi10", ("NAVI10",), "Radeon RX 5700 XT", 40 * 2, 1.905, 448, 32, 512, 4, 40),
    ("navi21", ("NAVI21",), "Radeon RX 6900 XT", 80 * 2, 2.25, 512, 32, 512, 8, 32),
    ("gfx1100", ("GFX1100", "NAVI31"), "Radeon RX 7900 XTX", 96 * 2, 2.5, 960, 32, 768, 12, 32))]
GROUP_SIMDS = 4  # share a workgroup and its LDS


class Work(NamedTuple):
    """How much a pass runs in one frame. Open: arguments that a shader or a scene gives."""

    kind: str
    runs: bool
    open: bool
    groups: int
    local: int  # invocations of a workgroup
    vertices: int  # each index once
    pixels: int  # of the draw's area and all layers, each once
    bytes: float  # that it reads and writes, each once


def work_of(entry: Json, indices: int | None) -> Work:
    kind, call, more = entry["kind"], entry["arguments"], entry["work"]
    layers = call.get("layers", 0)
    vertices = {"draw scene": indices, "draw fullscreen": 3, "draw vertices": call.get("vertices", 0) * call.get("instances", 0)}.get(kind)
    groups = call["x"] * call["y"] * call["z"] if kind == "dispatch" else 0
    is_open = "arguments" in call or (kind == "draw scene" and indices is None)
    return Work(kind, more["runs"], is_open, groups, more["local"], (vertices or 0) * layers, more["pixels"] * layers, more["bytes"])


def started(work: Work, stage: Json) -> int | None:
    """Waves that a stage starts in a frame; None: not known."""
    if not work.runs:
        return 0
    if stage["stage"] == "fragment":
        return math.ceil(work.pixels / stage["subgroup"])
    if work.open:
        return None
    compute = stage["stage"] == "compute"
    return work.groups * math.ceil(work.local / stage["subgroup"]) if compute else math.ceil(work.vertices / stage["subgroup"])


def sum_known(values: list[float | None]) -> float | None:
    return None if None in values else sum(value for value in values if value is not None)


def turned(told: Json, name: str) -> float:
    """A figure with loops that turn as often as constants and parameters tell. RADV's compiler takes 8 turns for a loop, 4 for one in
    another, 2 for each further in. What a loop of one turn around it adds tells its share; of that, a loop in it adds its own."""
    total, inlined, loops = told["figures"][name], told.get("inlined", {}), told.get("loops", ())
    kept = [number for number, loop in enumerate(loops) if name in loop.get("wrapped", ())]
    chains: dict[int, list[int]] = {}  # of loops that the compiler keeps: the loop and those around it, the outermost first
    for number in kept:
        chain, inner = [number], -1
        while inner != number:
            inner, number = number, loops[number]["around"]
            chain += [number] if number in kept and number != inner else []
        chains[chain[0]] = chain[::-1]
    own: dict[int, float] = {}  # of a loop without those in it
    more = 0.0  # that the turns which are known add
    for number in sorted(kept, key=lambda number: -len(chains[number])):
        inside = sum(value * (1 if len(chains[other]) > 1 else 3) for other, value in own.items() if number in chains[other])
        own[number] = max(0.0, loops[number]["wrapped"][name] - inlined[name] - inside) / (1 if len(chains[number]) > 1 else 3)
        known = [loops[loop]["turns"] / {0: 8, 1: 4}.get(depth, 2) for depth, loop in enumerate(chains[number]) if loops[loop]["turns"]]
        more += own[number] * (math.prod(known) - 1)
    # A loop in another hides less latency: shares may exceed the whole.
    return total + more * min(1.0, total / max(1.0, sum(own.values())))


def chip_of(device: str) -> Json | None:
    """The chip that a driver names in its device's name."""
    return next((chip for chip in CHIPS if any(f"RADV {name})" in device for name in chip["families"])), None)


class Costs:
    """What one compiler makes of all passes. Times are milliseconds, lower bounds; None: not known."""

    def __init__(self, request: Json, gpu: Json):
        self.gpu, listed = gpu, request["list"]
        self.chip: Json | None = next((chip for chip in CHIPS if chip["name"] == gpu["chip"]), None) or chip_of(gpu["device"])
        self.name: str = self.chip["name"] if self.chip else gpu["device"]
        self.passes: list[str] = [entry["name"] for entry in listed["passes"]]
        self.size: int = listed["width"] * listed["height"]
        self.work = [work_of(entry, request.get("indices")) for entry in listed["passes"]]
        self.measured: list[float | None] | None = None

    def stages(self, number: int) -> list[Json]:
        return [self.stage(number, stage) for stage in self.gpu["stages"] if stage["pass"] == number]

    def stage(self, number: int, told: Json) -> Json:
        stage = {"stage": told["stage"], "subgroup": told["subgroup"]}
        for key, names in FIGURES.items():
            found = [turned(told, name) if key in ("cycles", "latency") else told["figures"][name]
                     for name in names if name in told["figures"]]
            stage[key] = sum(found) if found else None
        return {**stage, "limit": self.limit(self.work[number], stage), "started": started(self.work[number], stage)}

    def limit(self, work: Work, stage: Json) -> str:
        """What keeps the waves of a SIMD below their number."""
        chip, waves = self.chip, stage["waves"]
        if not chip or waves is None or stage["vgprs"] is None:
            return ""
        unit = 2 if chip["most_waves"] > 10 else 1  # RADV counts waves of 32 where a chip has them: twice as many
        narrow = 2 if stage["subgroup"] == 32 else 1
        step = chip["granularity"] * narrow
        registers = math.ceil(stage["vgprs"] / step) * step
        most = chip["vgprs"] * narrow // registers / narrow * unit if registers else math.inf
        if stage["stage"] == "compute":
            group = math.ceil(work.local / stage["subgroup"]) / GROUP_SIMDS / narrow * unit
            if 0 < group <= waves and waves // group * group < waves:
                return "group"
        return "" if waves >= chip["most_waves"] else "LDS" if waves < most else "registers"

    def is_large(self, stage: Json) -> bool:
        return self.chip is not None and stage["code"] is not None and stage["code"] > self.chip["code_kib"] * 1024

    def times(self, number: int) -> dict[str, float | None]:
        """Of arithmetic: all waves, SIMDs kept busy; of one wave of each stage; of bytes at the memory's rate; the largest."""
        if not self.chip:
            return dict.fromkeys(("arithmetic_ms", "wave_ms", "bytes_ms", "bound_ms"))
        work, cycles = self.work[number], self.chip["ghz"] * 1e6
        stages = self.stages(number) if work.runs else []
        busy = [None if None in (s["started"], s["cycles"]) else s["started"] * s["cycles"] / self.chip["simds"] / cycles for s in stages]
        arithmetic = sum_known(busy)
        wave = sum_known([None if s["latency"] is None else s["latency"] / cycles for s in stages])
        memory = work.bytes / (self.chip["gb_s"] * 1e6) if work.runs else 0
        bound = None if arithmetic is None else max(arithmetic, wave or 0, memory)
        return {"arithmetic_ms": arithmetic, "wave_ms": wave, "bytes_ms": memory, "bound_ms": bound}

    def covers_frame(self, work: Work) -> bool:
        """Whether it computes or fills every pixel of the frame at least; drawn scenes do not count, which their triangles cost."""
        filled = {"dispatch": work.groups * work.local, "draw fullscreen": work.pixels}.get(work.kind, 0)
        return work.runs and filled >= self.size

    def sums(self) -> Json:
        times = [self.times(number) for number in range(len(self.passes))]
        covers = [self.covers_frame(work) for work in self.work]
        return {"pixel_ms": sum_known([time["arithmetic_ms"] for time, all_of in zip(times, covers) if all_of]),
                "other_wave_ms": sum(time["wave_ms"] or 0 for time, all_of in zip(times, covers) if not all_of),
                "bound_ms": sum(time["bound_ms"] or 0 for time in times),
                "open_passes": sum(time["bound_ms"] is None for time in times)}

    def json(self) -> Json:
        root = {"gpu": self.name, "device": self.gpu["device"], "driver": self.gpu["driver"]}
        if self.chip:
            root["chip"] = {key: self.chip[key] for key in ("product", "simds", "ghz", "gb_s", "code_kib")}
            root.update(self.sums())
        root["passes"] = [{"pass": name, "bytes": self.work[number].bytes, **self.times(number),
                           **({"measured_ms": self.measured[number]} if self.measured else {}), "stages": self.stages(number)}
                          for number, name in enumerate(self.passes)]
        return root

    def take_times(self, console: Console, path: str) -> None:
        """The times that `bench --json` measured on this device, or on one with this chip."""
        sides = read(console, path).get("sides", [])
        side = next((side for side in sides if side["device"] == self.gpu["device"]
                     or (self.chip and chip_of(side["device"]) == self.chip)), None)
        if side is None:
            console.fail(f"{path}: has no times of {self.gpu['device']}")
        found = {entry["pass"]: (entry["ms"] or {}).get("median") for entry in side["passes"]}
        self.measured = [found.get(name) for name in self.passes]


def read(console: Console, path: str) -> Json:
    try:
        with open(path, encoding="utf-8") as file:
            root = json.load(file)
    except ValueError:
        console.fail(f"{path}: is not JSON")
    return root if isinstance(root, dict) else {}


# ---- Tables --------------------------------------------------------------------------------------

COLUMNS = {"vgprs": 5, "waves": 5, "limit": -9, "spills": 6, "code": 7, "lds": 6, "instructions": 6, "cycles": 7, "latency": 8,
           "started": 8}
HEADS = {"vgprs": "VGPRs", "lds": "LDS", "instructions": "instr"}


def cell(value: Any, width: int, digits: int = 0) -> str:
    if isinstance(value, str):
        return f"{value:<{-width}}" if width < 0 else f"{value:>{width}}"
    return f"{'-' if value is None else f'{value:.{digits}f}':>{width}}"


def print_costs(costs: Costs, listed: Json) -> None:
    width = max(len("pass"), *map(len, costs.passes))
    print(f"{listed['pipeline']}, {listed['width']}x{listed['height']}, {costs.chip['product'] if costs.chip else 'unknown chip'}: "
          f"{costs.gpu['device']}; {costs.gpu['driver']}")
    heads = [cell(HEADS.get(key, key), size) for key, size in COLUMNS.items()]
    heads += [f"{head:>8}" for head in ("ms", "wave ms", "bytes ms", *(("measured",) if costs.measured else ()))]
    print(f"{'pass':<{width}} {'stage':<8}", *heads)
    for number, name in enumerate(costs.passes):
        stages = costs.stages(number)
        for stage in stages:
            words = [cell(stage[key], size) for key, size in COLUMNS.items()]
            words[4] = cell(stage["code"], 6) + ("!" if costs.is_large(stage) else " ")
            if stage is stages[-1] and costs.chip:
                words += [cell(time, 8, 4) for time in list(costs.times(number).values())[:3]]
            if stage is stages[-1] and costs.measured:
                words.append(cell(costs.measured[number], 8, 4))
            print(f"{name if stage is stages[0] else '':<{width}} {stage['stage']:<8}", *words)
    sums = costs.sums()
    if costs.chip:
        print(f"passes of every pixel: {cell(sums['pixel_ms'], 0, 3)} ms; one wave of each other pass: "
              f"{sums['other_wave_ms']:.3f} ms; all, by the larger bound: {sums['bound_ms']:.3f} ms")
        if sums["open_passes"]:
            print(f"{sums['open_passes']} passes are not in this sum: a shader or a scene says how often they run")
    print()


# ---- Against an earlier one ----------------------------------------------------------------------

# Figures that may be worse, and whether they are when they grow (1) or shrink (-1).
COMPARED = {"cycles": 1, "waves": -1, "spills": 1, "instructions": 0, "vgprs": 0, "code": 0, "lds": 0, "latency": 0}


def stage_against(name: str, old: Json, new: Json, limit: float) -> bool:
    """Prints what has changed; whether it is worse beyond the limit."""
    told, worse = "", False
    for key, sign in COMPARED.items():
        was, now = old.get(key), new[key]
        if was is None or now is None or was == now:
            continue
        told += f" {key} {was:.0f} -> {now:.0f}" + (f" ({(now - was) / was * 100:+.1f} %)" if was > 0 else "")
        worse |= sign * now > sign * was * (1 + sign * limit)
    if told:
        print(f"  {name}, {new['stage']}:{told}" + ("  WORSE" if worse else ""))
    return worse


def gpu_against(old: Json, new: Json, limit: float) -> int:
    """How many passes are worse beyond the limit."""
    print(f"{new['gpu']}, against the earlier figures:")
    if old["driver"] != new["driver"]:
        print(f"  another driver, whose compiler may differ: {old['driver']}, now {new['driver']}")
    before, now = ({entry["pass"]: entry["stages"] for entry in figures["passes"]} for figures in (old, new))
    worse = 0
    for name, stages in now.items():
        if name not in before:
            print(f"  {name}: new")
        known = {stage["stage"]: stage for stage in before.get(name, [])}
        worse += any([stage_against(name, known[stage["stage"]], stage, limit) for stage in stages if stage["stage"] in known])
    for name in before:
        if name not in now:
            print(f"  {name}: gone")
    if old.get("pixel_ms") is not None and new.get("pixel_ms") is not None:
        print(f"  passes of every pixel: {old['pixel_ms']:.3f} -> {new['pixel_ms']:.3f} ms")
    print(f"  {worse} passes are worse by more than {limit * 100:.3g} %")
    return worse


def against(console: Console, path: str, now: Json, limit: float) -> int:
    earlier = read(console, path)
    if "gpus" not in earlier or "pipeline" not in earlier:
        console.fail(f"{path}: not a file that `cost --json` wrote")
    if earlier["pipeline"] != now["pipeline"]:
        console.fail(f"{path}: of the pipeline {earlier['pipeline']}, not of {now['pipeline']}")
    worse = 0
    for gpu in now["gpus"]:
        old = next((other for other in earlier["gpus"] if other.get("gpu") == gpu["gpu"]), None)
        if old is None:
            console.fail(f"{path}: has no figures of {gpu['gpu']}")
        try:
            worse += gpu_against(old, gpu, limit)
        except (AttributeError, KeyError, TypeError):
            console.fail(f"{path}: not a file that `cost --json` wrote")
    return worse


def main(console: Console, request: Json) -> tuple[int, Json]:
    listed, worse = request["list"], 0
    all_costs = [Costs(request, gpu) for gpu in request["gpus"]]
    for costs in all_costs:
        if "bench" in request:
            costs.take_times(console, request["bench"])
    for costs in all_costs:
        print_costs(costs, listed)
    print(UNKNOWN)
    result = {"pipeline": listed["pipeline"], "scene": request.get("scene", ""), "sets": request.get("set", []),
              "width": listed["width"], "height": listed["height"], "gpus": [costs.json() for costs in all_costs]}
    if "against" in request:
        worse = against(console, request["against"], result, request["limit"])
    return 1 if worse else 0, result
