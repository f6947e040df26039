"""`diptych report --collect DIR`: one page of what the `run` of a bundle left in a folder: devices, verdicts and times. Of each run,
a pipeline in a scene, it has RUN.bench.json by bench and, with two devices or more, RUN.json by compare. The folder may come from
anyone: no link is followed, and names are plain. Needs Python alone, since a machine with a bundle may have no more."""
from __future__ import annotations

import json
import math
import os
import re
from typing import Any

from . import page
from .console import Console

TEXT_BYTES, JSON_BYTES = 1 << 20, 64 << 20  # at most


def read_text(console: Console, folder: str, name: str, most: int = TEXT_BYTES) -> str:
    """Of a file that anyone may have put there; "" where it is not there."""
    path = os.path.join(folder, name)
    if os.path.islink(path):
        console.fail(f"{path}: cannot be read: is a symbolic link, which a folder of others may not have")
    if not os.path.exists(path):
        return ""
    with open(path, "rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        console.fail(f"{path}: cannot be read: is larger than {most >> 20} MiB")
    return re.sub(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", "\ufffd", data.decode("utf-8", "replace"))


def read_result(console: Console, folder: str, name: str) -> dict[str, Any]:
    text = read_text(console, folder, name, JSON_BYTES)
    try:
        result = json.loads(text or "{}")
    except (ValueError, RecursionError):
        result = None
    if not isinstance(result, dict):
        console.fail(f"{os.path.join(folder, name)}: is no JSON object")
    return result


def words(value: Any) -> str:
    return value if isinstance(value, str) else ""


def members(value: Any, name: str) -> list[dict[str, Any]]:
    """The objects of a list; a file may hold anything."""
    found = value.get(name) if isinstance(value, dict) else None
    return [item for item in found if isinstance(item, dict)] if isinstance(found, list) else []


def first_error(result: dict[str, Any]) -> str:
    return next((words(e.get("message")) for e in members(result, "errors") if e.get("severity") == "error"), "")


def verdict(pair: dict[str, Any]) -> dict[str, Any]:
    sides = pair.get("sides")
    names = [words(side) for side in sides[:2]] if isinstance(sides, list) else []
    first, second = (names + ["", ""])[:2]
    places = (pair.get("guilty"), pair.get("first_break"), pair.get("not_finite"))
    place: dict[str, Any] = next((p for p in places if isinstance(p, dict)), {})
    return {"first": first, "second": second, "agree": pair.get("agree") is True, "pass": words(place.get("pass")),
            "resource": words(place.get("resource"))}


def cell(side: dict[str, Any]) -> dict[str, str]:
    from .report import number_text

    frame = side.get("frame_ms")
    values = {name: frame.get(name) if isinstance(frame, dict) else None for name in ("median", "p5", "p95")}
    return {name: number_text(float(v) if isinstance(v, (int, float)) else math.nan) for name, v in values.items()}


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    folder = request["dir"]
    runs = sorted(found[1] for name in os.listdir(folder) if (found := re.fullmatch(r"([\w-][\w.-]*)\.bench\.json", name, re.ASCII)))
    if not runs:
        console.fail(f"{folder}: holds no results; name the folder that a bundle's `run` left")
    path = os.path.join(folder, "index.html")
    if os.path.islink(path):
        console.fail(f"{path}: is a symbolic link, which a folder of others may not have")
    data: dict[str, Any] = {name: read_text(console, folder, name + ".txt") for name in ("version", "machine", "refused")}
    sides: list[dict[str, str]] = []
    times, verdicts = [], []
    for run in runs:
        bench, compare = read_result(console, folder, run + ".bench.json"), read_result(console, folder, run + ".json")
        times.append({"run": run, "reason": first_error(bench), "times": list(map(cell, members(bench, "sides")))})
        sides = sides or [{"label": words(side.get("side")), "device": words(side.get("device")), "driver": words(side.get("driver"))}
                          for side in members(bench, "sides")]
        if compare:
            pairs = members(compare, "pairs") or ([compare] if "sides" in compare else [])
            verdicts.append({"run": run, "reason": first_error(compare), "verdicts": list(map(verdict, pairs))})
    data.update({"sides": sides, "times_of": times, "verdicts_of": verdicts})
    page.write_page(os.path.join(request["templates"], "report/collect.html"), path, data)
    print(path)
    return 0, {}
