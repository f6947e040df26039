"""Verbs of the program diptych as functions."""
from __future__ import annotations

import json
import os
import subprocess
import tempfile
from typing import Any

HERE = os.path.dirname(os.path.realpath(__file__))


def program() -> str:
    """The program that belongs to this package: installed four folders above, or in the project's build folder."""
    above = os.path.join(HERE, "..", "..", "..")
    paths = [os.path.join(above, folder, "diptych") for folder in ("../bin", "build")]
    return next(filter(os.path.isfile, paths), "diptych")


def run(verb: str, *, failed: int = 2, **options: Any) -> dict[str, Any]:
    """Runs a verb; its --json. Options have their names with _ for -: a list is an option that is repeated, True one without a
    value; `output` is -o. Raises an error where it could not run, with what it told."""
    words = [program(), verb]
    for name, value in options.items():
        flag = "-o" if name == "output" else "--" + name.replace("_", "-")
        for item in value if isinstance(value, (list, tuple)) else [value] if value not in (None, False) else []:
            words += [flag] if item is True else [flag, str(item)]
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "told.json")
        done = subprocess.run([*words, "--json", path], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              text=True, check=False)
        if done.returncode >= failed or not os.path.exists(path):
            raise RuntimeError(done.stderr)
        with open(path, encoding="utf-8") as file:
            result: dict[str, Any] = json.load(file)
    return result


def sweep(output: str, grid: dict[str, list[Any]] | None = None, **options: Any) -> Any:
    """`diptych sweep` into a folder: its rows, a pandas.DataFrame where pandas is there, else a list of dicts. A run that failed has
    a row with its reason.

    diptych.sweep("measured", {"clusters": [4, 8]}, spec="ssvp", scene="cornell", measure="time,error", size="480x270")"""
    rows = [f"{path}={','.join(map(str, values))}" for path, values in (grid or {}).items()]
    result = run("sweep", failed=3, output=output, grid=rows, **options)
    table = result.get("rows", result.get("runs"))
    if table is None:
        raise RuntimeError("\n".join(error["message"] for error in result["errors"]))
    try:
        import pandas
    except ImportError:
        return table
    return pandas.DataFrame(table)
