"""`diptych bench`: medians of the times that the C program has measured (app/measure/bench.c), as tables and JSON. Each backend is
beside the device's own rates: the best of templates/machine.yaml."""
from __future__ import annotations

import math
from typing import Any

from .console import Console

Json = dict[str, Any]
COLUMN = 9  # letters of a number


def quantile(values: list[float], q: float) -> float:
    """Of a sorted list, linear between neighbours, type 7 of Hyndman and Fan (1996), as NumPy has it."""
    place = (len(values) - 1) * q
    below = math.floor(place)
    return values[below] + (values[min(below + 1, len(values) - 1)] - values[below]) * (place - below)


def spread(values: list[float | None]) -> Json | None:
    """None: a pass that did not run."""
    known = sorted(value for value in values if value is not None)
    names = {"median": 0.5, "p5": 0.05, "p95": 0.95}
    return {**{name: quantile(known, q) for name, q in names.items()}, "count": len(known)} if known else None


def passes_of(lane: Json) -> list[Json | None]:
    return [spread(list(times)) for times in zip(*lane["pass_ms"])]


def quotient(a: float, b: float | None) -> float | None:
    return a / b if b else None


class Side:
    def __init__(self, request: Json, told: Json):
        self.label, self.device = told["side"], told["device"]
        whole, timed = told["whole"], told["passes"]
        self.frame, self.record = spread(whole["frame_ms"]), spread(whole["record_ms"])
        self.passes = passes_of(timed)
        rates = [moved / ms["median"] for moved, ms in zip(request["machine"], passes_of(told["machine"])) if ms]
        self.rate = max(rates, default=None)  # bytes per millisecond
        bytes_moved = [entry["bytes_read"] + entry["bytes_written"] for entry in request["passes"]]
        self.json = {"side": self.label, "device": self.device, "driver": told["driver"], "frame_ms": self.frame,
                     "timed_frame_ms": spread(timed["frame_ms"]), "record_ms": self.record,
                     "machine": {"gb_s": self.rate and self.rate * 1e-6},
                     "passes": [{"pass": entry["pass"], "ms": ms, "gb_s": ms and moved / ms["median"] * 1e-6,
                                 "floor_ms": quotient(moved, self.rate)}
                                for entry, ms, moved in zip(request["passes"], self.passes, bytes_moved)]}


# ---- Tables --------------------------------------------------------------------------------------


def cell(value: float | None, digits: int) -> str:
    return f"  {'-' if value is None else f'{value:.{digits}f}':>{COLUMN}}"


def times(ms: Json | None) -> str:
    """Digits by size: 123, 1.23, 0.1234."""
    ms = ms or dict.fromkeys(("median", "p5", "p95"))
    digits = 4 if ms["median"] is None or ms["median"] < 1 else 2 if ms["median"] < 100 else 0
    return "".join(cell(ms[key], digits) for key in ("median", "p5", "p95"))


def print_times(sides: list[Side], names: list[str], width: int) -> None:
    print(f"{'milliseconds':<{width}}" + "".join(f"  {side.label:>{COLUMN}}  {'p5':>{COLUMN}}  {'p95':>{COLUMN}}" for side in sides))
    for number, name in enumerate(names):
        print(f"{name:<{width}}" + "".join(times(side.passes[number]) for side in sides))
    sums = [cell(sum(ms["median"] for ms in side.passes if ms), 2) + " " * (2 * COLUMN + 4) for side in sides]
    print(f"{'sum of passes':<{width}}" + "".join(sums))
    print(f"{'frame':<{width}}" + "".join(times(side.frame) for side in sides))


def print_rates(sides: list[Side], request: Json, width: int) -> None:
    """With every resource counted whole and once, and the pass's time divided by its lower bound. Below 1: the pass reads only
    parts of a resource."""
    print(f"{'resources once':<{width}}  {'MB':>{COLUMN}}"
          + "".join(f"  {side.label:>{COLUMN - 5}} GB/s  {'x floor':>{COLUMN}}" for side in sides))
    for number, entry in enumerate(request["passes"]):
        line = f"{entry['pass']:<{width}}" + cell((entry["bytes_read"] + entry["bytes_written"]) * 1e-6, 3)
        for side in sides:
            told = side.json["passes"][number]
            line += cell(told["gb_s"], 2) + cell(quotient(told["ms"]["median"], told["floor_ms"]) if told["ms"] else None, 1)
        print(line)
    print(f"{'copy':<{width}}  {'':{COLUMN}}" + "".join(cell(side.json["machine"]["gb_s"], 2) + f"  {'':{COLUMN}}" for side in sides))
    print(f"{'memcpy':<{width}}  {'':{COLUMN}}" + cell(request["memcpy_gb_s"], 2))


def main(_console: Console, request: Json) -> tuple[int, Json]:
    copies = spread(request.pop("copy_ms"))
    request["memcpy_gb_s"] = copies and request["copy_bytes"] / copies["median"] * 1e-6
    sides = [Side(request, told) for told in request["sides"]]
    names = [entry["pass"] for entry in request["passes"]]
    width = max(len("copy, arithmetic"), *map(len, names))
    print(f"{request['pipeline']}, {request.get('scene', 'no scene')} at {request['width']}x{request['height']}, "
          f"{request['frames']} frames after {request['warmup']}, in turn")
    for side in sides:
        print(f"{side.label}: {side.device}")
    print()
    print_times(sides, names, width)
    print()
    print_rates(sides, request, width)
    print()
    for side in sides:
        if side.record:
            print(f"{side.label}: recording a frame takes {side.record['median'] * 1e3:.1f} us of CPU time")
    keys = ("pipeline", "width", "height", "frames", "warmup", "memcpy_gb_s", "passes")
    return 0, {**{key: request[key] for key in keys}, "scene": request.get("scene"), "sets": request.get("set", []),
               "sides": [side.json for side in sides]}
