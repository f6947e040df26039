"""The outline of a report: a YAML file beside the spec, checked by templates/report.schema.json, which describes its keys."""
from __future__ import annotations

import difflib
import json
import os
import sys
from typing import Any, Iterator

from .console import Console, Failure

# What a schema's word demands, as a message says it.
TYPES = {"object": "mapping", "array": "sequence", "string": "text", "integer": "whole number", "number": "finite number"}


class Checker:
    """Reports what is wrong, each at its place in the file."""

    def __init__(self, console: Console, path: str):
        self.console, self.path = console, path
        self.found: list[tuple[int, int, int, str]] = []  # line and column from 1, length, message
        with open(path, encoding="utf-8") as file:
            self.text = file.read()

    def tell(self, mark: Any, length: int, text: str) -> None:
        self.found.append((mark.line + 1, mark.column + 1, length, text))

    def finish(self) -> None:
        """Fails with all errors, in the order of the file."""
        lines = self.text.splitlines() + [""]
        for number, column, length, text in sorted(self.found):
            line = lines[number - 1]
            head, caret = f"{number:5} | {line}", "^" + "~" * (min(length, len(line) - column + 1) - 1)
            print(f"{self.path}:{number}:{column}: error: {text}\n{head}\n{'|':>7} {' ' * (column - 1)}{caret}", file=sys.stderr)
            self.console.errors.append({"severity": "error", "message": text, "file": self.path, "line": number, "column": column,
                                        "length": length})
        if self.found:
            raise Failure

    def at(self, root: Any, path: list[Any], key: bool = False) -> Any:
        """The node that a path leads to; `key`: that of its name."""
        node = root
        for index, step in enumerate(path):
            if isinstance(step, int):
                node = node.value[step]
            else:
                name, value = next(pair for pair in node.value if pair[0].value == step)
                node = name if key and index == len(path) - 1 else value
        return node

    def error(self, root: Any, error: Any) -> None:
        """An error of jsonschema, in the words of the other readers of files."""
        path, schema = list(error.absolute_path), error.schema
        name = next((step for step in reversed(path) if isinstance(step, str)), "")
        node = self.at(root, path)
        if error.validator == "additionalProperties":
            known = list(schema["properties"])
            for key in [key for key in error.instance if key not in known]:
                near = difflib.get_close_matches(key, known, 1)
                place = self.at(root, [*path, key], key=True)
                self.tell(place.start_mark, len(key), f"unknown key `{key}`" + (f"; did you mean `{near[0]}`?" if near else ""))
            return
        if error.validator == "required":
            for key in [key for key in error.validator_value if key not in error.instance]:
                owner = f"`{name}`" if name and not isinstance(path[-1], int) else "an item" if path else "the outline"
                place = self.at(root, path, key=True) if path and isinstance(path[-1], str) else node
                self.tell(place.start_mark, len(name) or 1, f"{owner} lacks the key `{key}`")
            return
        if error.validator == "minItems":
            node = self.at(root, path, key=True)
        told = {
            "type": f"`{name}` takes a {TYPES.get(str(error.validator_value), str(error.validator_value))}",
            "pattern": f"`{name}` must be " + ("WIDTHxHEIGHT, like 192x108" if name == "size" else "valid as a file name"),
            "enum": f"`{name}` takes " + " or ".join(f"`{word}`" for word in schema.get("enum", [])),
            "minItems": f"`{name}` takes a list of one thing at least",
        }
        between = f"`{name}` is out of range: it lies between {schema.get('minimum')} and {schema.get('maximum')}"
        self.tell(node.start_mark, 1, told.get(error.validator, between if "imum" in error.validator else f"`{name}`: {error.message}"))


def lists_of_the_sweep(outline: dict[str, Any]) -> Iterator[tuple[list[Any], int, bool]]:
    """What has a number for each value of the sweep: its path, how many, and whether fewer will do."""
    published = outline.get("published") or {}
    if "total" in published:
        yield ["published", "total"], len(published["total"]), False
    for stage, numbers in (published.get("stages") or {}).items():
        yield ["published", "stages", stage], len(numbers), False
    if "own_error" in published:
        yield ["published", "own_error", "values"], len(published["own_error"].get("values", [])), True


def read_outline(console: Console, path: str, templates: str) -> dict[str, Any]:
    import jsonschema
    import yaml  # type: ignore[import]

    if not os.path.exists(path):
        console.fail(f"{path}: cannot be read: No such file or directory; it says what a report of this spec shows, see "
                     "templates/ssvp/report.yaml; --outline names another")
    checker = Checker(console, path)
    try:
        root, outline = yaml.compose(checker.text, yaml.SafeLoader), yaml.safe_load(checker.text)
    except yaml.MarkedYAMLError as error:
        checker.tell(error.problem_mark or error.context_mark, 1, error.problem or "this is no YAML")
        checker.finish()
    if not isinstance(outline, dict):
        console.fail(f"{path}: a report outline file is a mapping with the keys `pictures`, `sweep` and `reference`")
    with open(os.path.join(templates, "report.schema.json"), encoding="utf-8") as file:
        schema = json.load(file)
    for wrong in jsonschema.Draft202012Validator(schema).iter_errors(outline):
        checker.error(root, wrong)
    if not checker.found:
        count = len(outline["sweep"]["values"])
        for where, numbers, fewer in lists_of_the_sweep(outline):
            if numbers > count or numbers < count and not fewer:
                how = "no more numbers than" if fewer else "as many numbers as"
                checker.tell(checker.at(root, where).start_mark, 1, f"`{where[-1]}` takes {how} the sweep has values")
        motion = outline.get("motion") or {}
        if motion and motion.get("from_bounce", 1) > outline["reference"]["bounces"]:
            place = checker.at(root, ["motion", "from_bounce"] if "from_bounce" in motion else ["reference", "bounces"])
            checker.tell(place.start_mark, 1, "`from_bounce` of `motion` (default: 1) must be at most `bounces` of `reference`")
    checker.finish()
    return outline
