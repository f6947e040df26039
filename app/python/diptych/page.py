"""Pages: fills the templates of templates/report from JSON.

    {{name}}               the text or number of that name, escaped for HTML
    {{#name}}...{{/name}}  once for each item of a list; once inside an object, or when a value is true or a text that is not empty;
                           else left out
    {{^name}}...{{/name}}  where the former leaves out
    {{.}}                  the item itself, in a list of texts
    {{>FILE}}              another template, beside this one, filled with the same
    {{#@rest}}...{{/@rest}}  in all items of a list but the first

A name is looked up in the innermost object that has it. A section's tag that stands alone on its line leaves no line."""
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
            if not stack or stack[-1][-1][1] != name:
                raise ValueError(f"no section is open of the name `{name}`")
        else:
            stack[-1].append((kind, name))
    stack[-1].append(text[at:])
    if len(stack) > 1:
        raise ValueError(f"not closed: the section `{stack[-2][-1][1]}`")
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
        elif value is None:
            raise ValueError(f"no text or number `{name}`")
        else:
            yield html.escape(f"{value:.15g}" if isinstance(value, (int, float)) else str(value))


def read(path: str) -> list[Any]:
    with open(path, encoding="utf-8") as file:
        return parts(file.read())


def write_page(template: str, path: str, data: dict[str, Any]) -> None:
    folder = os.path.dirname(template)
    write(path, "".join(fill(read(template), [(data, None)], folder)))
