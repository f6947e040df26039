"""Pages: fills the templates of templates/report, as app/console/fill.h describes them."""
from __future__ import annotations

import html
import os
import re
from typing import Any, Iterator

from .console import write

TAG = re.compile(r"(?m)^ *\{\{([#^/])([^}]+)\}\} *\n|\{\{([#^/>]?)([^}]+)\}\}")


def lookup(scopes: list[Any], name: str) -> Any:
    if name == ".":
        return scopes[-1][0]
    if name == "@rest":
        return next(index for _, index in reversed(scopes) if index is not None) > 0
    for value, _ in reversed(scopes):
        if isinstance(value, dict) and name in value:
            return value[name]
    return None


def parts(text: str) -> list[Any]:
    """A tree of texts, (kind, name) slots and (kind, name, parts) sections."""
    stack: list[list[Any]] = [[]]
    at = 0
    for tag in TAG.finditer(text):
        kind, name = (tag[1], tag[2]) if tag[1] else (tag[3], tag[4])
        stack[-1].append(text[at:tag.start()])
        at = tag.end()
        if kind and kind in "#^":
            stack[-1].append((kind, name, []))
            stack.append(stack[-1][-1][2])
        elif kind == "/":
            stack.pop()
        else:
            stack[-1].append((kind, name))
    stack[-1].append(text[at:])
    return stack[0]


def fill(tree: list[Any], scopes: list[Any], folder: str) -> Iterator[str]:
    for part in tree:
        if isinstance(part, str):
            yield part
            continue
        kind, name, *inside = part
        if kind == ">":
            yield from fill(read(os.path.join(folder, name)), scopes, folder)
            continue
        value = lookup(scopes, name)
        items: list[tuple[Any, Any]] = [(None, value)] if value or value == {} else []
        if isinstance(value, list):
            items = list(enumerate(value))
        if kind == "#":
            for index, item in items:
                yield from fill(inside[0], [*scopes, (item, index)], folder)
        elif kind == "^":
            yield from () if items else fill(inside[0], scopes, folder)
        else:
            yield html.escape(f"{value:.15g}" if isinstance(value, (int, float)) else str(value))


def read(path: str) -> list[Any]:
    with open(path, encoding="utf-8") as file:
        return parts(file.read())


def write_page(template: str, path: str, data: dict[str, Any]) -> None:
    folder = os.path.dirname(template)
    write(path, "".join(fill(read(template), [(data, None)], folder)))
