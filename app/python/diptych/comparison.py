"""The page and JUnit's XML of `compare`: fills templates/report/compare.html and junit.xml from what the C program hands over
(app/result/sheet_json.c)."""
from __future__ import annotations

import math
import os
from typing import Any

from .console import Console, printable
from .page import write_page

Json = dict[str, Any]


def texts(value: Any, xml: bool = False) -> Any:
    """With texts in place of numbers, of which 0 would be left out as nothing. XML has no control characters."""
    if isinstance(value, dict):
        return {key: texts(item, xml) for key, item in value.items()}
    if isinstance(value, list):
        return [texts(item, xml) for item in value]
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return f"{value:.9g}"
    return printable(value).replace("\n", " ").replace("\t", " ") if xml and isinstance(value, str) else value


# ---- The page ------------------------------------------------------------------------------------


def bin_name(index: int, last: int) -> str:
    """Of floats, ulp; other numbers have codes."""
    low = 2 ** max(index - 1, 0)
    names = {0: "0 and -0", 1: "1", last: "NaN or Inf"}
    return names.get(index, f"{low} to {2 * low - 1}")


def histogram(bins: list[int]) -> list[Json]:
    """Bars are logarithmic, so that one number among millions is seen."""
    held = [index for index, numbers in enumerate(bins) if numbers]
    return [{"bin": bin_name(index, len(bins) - 1), "numbers": bins[index],
             "percent": round(100 * math.log2(bins[index] + 1) / math.log2(max(bins) + 1))}
            for index in (range(held[0], held[-1] + 1) if held else ())]


def row_view(rows: list[Json], number: int) -> Json:
    row, more = rows[number], rows[number]["page"]
    before = rows[number - 1]["page"]["title"] if number else None
    view = {"elements": "-", "differing": "-", "inputs": "", **row, **more, "row": number, "bins": histogram(more.get("bins", [])),
            "opens_pass": more["title"] != before, "equal": row["verdict"] == "equal"}
    if more.get("files"):
        files = zip(("first_file", "second_file", "difference_file"), [*more["files"], "", ""])
        view["shown"] = {**dict(files), **{key: more[key] for key in ("across", "down", "layer", "amplification") if key in more}}
    return view


def pair_view(pair: Json, number: int, spec: str) -> Json:
    """Reasons are those of all resources of the guilty pass, with their names; of a spec, of the guilty one alone."""
    rows = pair["rows"][pair["early"]:]
    reasons = [("" if spec else row["page"]["name"] + ": ") + reason["text"] for row in pair["rows"] for reason in row.get("why", [])]
    return {**pair, "pair": number, "first": pair["devices"][0]["label"], "second": pair["devices"][1]["label"],
            "why": [{"text": reason} for reason in reasons], "results": [row_view(rows, index) for index in range(len(rows))]}


def page_data(request: Json) -> Json:
    pairs = request["pairs"]
    devices = [pairs[0]["devices"][0], *(pair["devices"][1] for pair in pairs)]
    return {**request, "pipeline": request["pipeline"] or "Dumps", "devices": devices,
            "pairs": [pair_view(pair, number, request["pipeline"]) for number, pair in enumerate(pairs)]}


# ---- JUnit ---------------------------------------------------------------------------------------


def row_case(row: Json) -> Json:
    case, more = {"pass": row["page"]["title"], "name": row["page"]["name"]}, row["page"]
    if row["verdict"] not in ("DIFFERS", "not finite"):
        return {**case, "skipped": more["largest"]} if row["verdict"] == "alone" else case
    differ = f"{row['differing']} of {row['elements']} differ; " if "elements" in row else ""
    count = "both agree; " if row["verdict"] == "not finite" else differ
    reasons = [reason["text"] for reason in row.get("why", [])]
    return {**case, "failure": "; ".join([count + more["largest"], *filter(None, [more["remark"]]), *reasons])}


def suites(request: Json) -> list[Json]:
    found: list[Json] = []

    def add(title: str, cases: list[Json], fine: tuple[str, str] = ("", ""), devices: list[Json] | None = None) -> None:
        """A suite without cases has one that passes."""
        cases = cases or [{"pass": fine[0], "name": fine[1]}]
        found.append({"name": request["pipeline"] + (request["pipeline"] and ": ") + title, "tests": len(cases), "cases": cases,
                      "failures": sum("failure" in case for case in cases), "properties": devices or []})

    for pair in request["pairs"]:
        first, second = pair["devices"]
        add(f"{second['label']} against {first['label']}", [row_case(row) for row in pair["rows"]], devices=pair["devices"])
    if "golden" in request:
        add("golden", [{"pass": item["pass"], "name": item["resource"], "failure": item["is"]} for item in request["golden"]["differing"]],
            ("golden", "all resources are as kept"))
    if request.get("repeated"):
        several = [item for item in request.get("elsewhere", []) if "distinct" in item]
        add("repeated runs", [{"pass": "repeat", "name": item["pass"], "failure": item["message"]} for item in several],
            ("repeat", "all runs are equal"))
    if "sanitized" in request:
        add("undefined behaviour", [{"pass": item["pass"], "name": f"{item['file']}:{item['line']}:{item['column']}",
                                     "failure": item["message"]} for item in request["sanitized"]["undefined"]],
            ("sanitize", "nothing undefined"))
    return found


def main(_console: Console, request: Json) -> tuple[int, Json]:
    folder = os.path.join(request["templates"], "report")
    if "html" in request:
        write_page(os.path.join(folder, "compare.html"), os.path.join(request["html"], "index.html"), texts(page_data(request)))
    if "junit" in request:
        write_page(os.path.join(folder, "junit.xml"), request["junit"], texts({"suites": suites(request)}, xml=True))
    return 0, {}
