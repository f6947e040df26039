"""Checks for tests/language.sh: `spec SCHEMA FILE` validates a spec; `reference SCHEMA FILE` holds the reference's tables
against the schema: the same keys in every section, and examples that the schema accepts."""
import json
import re
import sys

import jsonschema
import yaml


def rows(markdown):
    """(anchor, key, example) of every row of every section's table."""
    anchor = None
    for line in markdown.splitlines():
        found = re.match(r'<a id="(\w+)"></a>', line)
        if found:
            anchor = found.group(1)
        cells = re.split(r"(?<!\\)\|", line)
        if line.startswith("| `") and len(cells) == 7:
            key, example = cells[1].strip().strip("`"), cells[5].strip()[1:-1].replace("\\|", "|")
            yield anchor, key, example


def check_reference(schema, markdown):
    found = {}
    for anchor, key, example in rows(markdown):
        definition = schema["$defs"][anchor]
        found.setdefault(anchor, set()).add(key)
        part = definition["additionalProperties"] if key == "NAME" else definition["properties"][key]
        value = yaml.safe_load(example)
        jsonschema.validate(value, {"$defs": schema["$defs"], **part})
    for anchor, definition in schema["$defs"].items():
        if anchor in ("NAME", "EXPR"):
            continue
        keys = set(definition["properties"])
        if definition["additionalProperties"]:
            keys.add("NAME")
        if keys != found.get(anchor):
            sys.exit(f"section {anchor}: schema has {sorted(keys)}, reference has {sorted(found.get(anchor, []))}")


def main():
    with open(sys.argv[2], encoding="utf-8") as file:
        schema = json.load(file)
    with open(sys.argv[3], encoding="utf-8") as file:
        text = file.read()
    if sys.argv[1] == "spec":
        jsonschema.validate(yaml.safe_load(text), schema)
    else:
        check_reference(schema, text)


main()
