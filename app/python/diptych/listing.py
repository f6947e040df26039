"""`diptych list`: what a pipeline has, which the C program hands over (app/measure/cost.c)."""
from __future__ import annotations

from typing import Any

from .console import Console

Json = dict[str, Any]


def value_text(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    return str(value).lower() if isinstance(value, bool) else f"{value:.9g}"


def range_text(param: Json) -> str:
    words = [("from ", "min"), ("to ", "max")]
    found = [word + value_text(param[key]) for word, key in words if key in param]
    return " ".join(found) if len(found) < 2 else " ".join(found).removeprefix("from ")


def params(listed: Json, width: int) -> list[str]:
    return [f"  {param['name']:<{width}}  {param['type']:<5}  {value_text(param['value']):<9}  {range_text(param):<14}  "
            f"{'live' if param['live'] else '':<4}  {param['doc']}" for param in listed["params"]]


def resources(listed: Json, width: int) -> list[str]:
    lines = []
    for resource in listed["resources"]:
        fields = resource.get("fields", [])
        kind, form, shape = resource.get("shape"), resource.get("format"), str(resource.get("count"))
        if fields:
            kind, form = "buffer", "struct" if fields[0]["name"] else fields[0]["type"]
        else:
            shape = f"{resource['width']}x{resource['height']}" + (f"x{resource['layers']}" if resource["layered"] else "")
            shape += f", {resource['mips']} mips" if resource["mips"] > 1 else ""
        use = "input" if resource["input"] else "history" if resource["history"] else ""
        lines.append(f"  {resource['name']:<{width}}  {kind:<6}  {form:<10}  {shape:<14}  {use:<7}  {resource['doc']}")
        if form == "struct":
            inside = [f"{field['name']}: {field['type']}" + (f"[{field['array_count']}]" if "array_count" in field else "")
                      for field in fields]
            lines.append(f"  {'':{width}}  {{{', '.join(inside)}}}")
    return lines


def passes(listed: Json, width: int) -> list[str]:
    lines = []
    for entry in listed["passes"]:
        call = " ".join(map(str, (entry["kind"], *entry["arguments"].values())))
        lines.append(f"  {entry['name']:<{width}}  {call:<24}  {entry.get('shader', ''):<30}  {entry['doc']}")
        lines += [f"  {'':{width}}  {word:<6} {', '.join(entry[word])}" for word in ("reads", "writes") if entry[word]]
    return lines


def main(_console: Console, request: Json) -> tuple[int, Json]:
    listed: Json = request["list"]
    width = max(len(item["name"]) for key in ("params", "resources", "passes") for item in listed[key])
    lines = [listed["pipeline"] + (f": {listed['doc']}" if listed["doc"] else ""), "",
             f"{len(listed['params'])} parameters", *params(listed, width), "",
             f"{len(listed['resources'])} resources, at {listed['width']}x{listed['height']}", *resources(listed, width), "",
             f"{len(listed['passes'])} passes, in order of execution", *passes(listed, width)]
    print("\n".join(line.rstrip(" ") for line in lines))
    return 0, listed
