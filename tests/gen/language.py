"""Checks for tests/gen/language_test.sh:

`files FILE...`: each file names its schema as yaml-language-server reads it, and is valid by that schema.
`misspelled FILE...`: the schema refuses the file with any one of its keys misspelled.
`reference SCHEMA FILE`: every section of the reference has the keys of the schema, with examples that the schema accepts.
`keys SCHEMA... -- SOURCE...`: the schemas have the keys of the reader's tables in C.
`used SCHEMA FILE...`: the specs use every key of the schema.
`body REFERENCE SPEC`: the bodies beside the spec use every name in the reference's chapter on bodies. The chapter lists every
name that the generator's C and templates/glsl supply."""
import copy
import functools
import glob
import json
import os
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
    jsonschema.Draft202012Validator.check_schema(schema)
    for anchor, key, example in rows(markdown):
        definition = schema["$defs"][anchor]
        found.setdefault(anchor, set()).add(key)
        part = definition["additionalProperties"] if key == "NAME" else definition["properties"][key]
        value = yaml.safe_load(example)
        jsonschema.Draft202012Validator({"$defs": schema["$defs"], **part}).validate(value)
    for anchor, definition in schema["$defs"].items():
        if anchor in ("NAME", "REFERENCE", "EXPR"):
            continue
        keys = set(definition["properties"])
        if definition["additionalProperties"]:
            keys.add("NAME")
        if keys != found.get(anchor):
            sys.exit(f"section {anchor}: schema has {sorted(keys)}, reference has {sorted(found.get(anchor, []))}")


def without_comments(text):
    return re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.S)


def supplied_names():
    """Names that bodies may use: arguments of glsl_uses in the emitters, names that are taken because the generator declares
    them, and definitions of templates/glsl. Leaves out names for the generator's own use."""
    own = {"NAME", "NAME_quads", "NAME_at", "NAME_length", "NAME_texels", "utextureBuffer", "Frame", "Live", "tile_gather_axis", "approximate_root_value", "metric_length", "f"}
    names = set()
    for path in glob.glob("gen/*/*.c"):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        names |= {name.replace("%s", "NAME") for name in re.findall(r'glsl_uses\(glsl, "([^"]*)"', text) if name != "%.*s"}
        declared = re.search(r"taken_words =(.*?);", text, re.S)
        names |= set(re.findall(r"\w+", declared.group(1))) if declared else set()
    for path in glob.glob("templates/glsl/*.glsl"):
        with open(path, encoding="utf-8") as file:
            text = without_comments(file.read())
        if not path.endswith(("cells.glsl", "quads.glsl", "exact.glsl", "filter.glsl", "sanitize.glsl", "shadow.glsl", "values.glsl")):
            names |= set(re.findall(r"^\w+ (\w+)\(", text, re.M)) | set(re.findall(r"^struct (\w+)", text, re.M))
            for members in re.findall(r"^    (?:View|Light|vec3|mat4|float|u?int) ([\w, ]+);$", text, re.M):
                names |= set(members.split(", ")) if "struct" in text else set()
    assert len(names) > 80 and {"NAME_size", "vertex_uv", "tile_split", "cos_outer", "invocation"} <= names, names
    return names - own


def check_body(markdown, path):
    chapter = markdown[markdown.index('<a id="body"></a>'):]
    listed = re.findall(r"^\| `([^`]+)` \|", chapter, re.M)
    components = re.findall(r"^\| `SceneVertex.*", chapter, re.M)  # px, py, pz stand in one row
    words = set(re.findall(r"\w+", " ".join(listed + components)))
    missing = sorted(name for name in supplied_names() if name not in words)
    if missing:
        sys.exit(f"the chapter does not list {missing}")
    with open(path, encoding="utf-8") as file:
        spec = yaml.safe_load(file)
    declared = "|".join(name for key in ("buffers", "images", "samplers", "metrics") for name in spec[key])
    bodies = ""
    for shader in {entry["shader"] for entry in spec["passes"]}:
        with open(os.path.join(os.path.dirname(path), shader), encoding="utf-8") as file:
            bodies += without_comments(file.read())
    for name in listed:
        call = re.sub(r"^(?:[iu]?vec\d|float|u?int|View|\w*sampler\w+|Scene\w+) ", "", name)
        if call.startswith("for "):
            pattern = r"for \(\w+ \w+ : \w+\)"
        elif re.match(r"NAME\b", call):
            pattern = rf"\b(?:{declared})" + (re.escape(call[4]) if call[4:] else " = ")
        elif "." in call:
            pattern = r"\." + call.split(".")[1] + r"\b"
        else:
            pattern = r"\b" + re.match(r"\w+", call).group().replace("NAME", r"\w+") + r"\b"
        if not re.search(pattern, bodies):
            sys.exit(f"no body of {path} uses {name}")
    assert len(listed) > 80, listed


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def misspelled(value, fixed=False):
    """Yields the value with one key misspelled, for every key of the language; names that the file chooses stay."""
    if isinstance(value, list):
        for i, item in enumerate(value):
            for wrong in misspelled(item):
                yield value[:i] + [wrong] + value[i + 1:]
    if not isinstance(value, dict):
        return
    for key, item in value.items():
        if not fixed:
            yield {name + "x" * (name == key): other for name, other in value.items()}
        named = key in NAMED and not fixed
        for wrong in misspelled(item, named):
            yield {**value, key: wrong}


# keys below these are names that the file chooses
NAMED = {"params", "constants", "structs", "buffers", "images", "samplers", "metrics", "interleaves", "ranges", "defines", "contracts"}


@functools.cache
def validator_of(path):
    schema = load(path)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def check_file(path):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    found = re.match(r"# yaml-language-server: \$schema=(\S+)\n", text)
    if not found:
        sys.exit(f"{path}: its first line names no schema")
    validator = validator_of(os.path.normpath(os.path.join(os.path.dirname(path), found.group(1))))
    value = yaml.safe_load(text)
    for error in validator.iter_errors(value):
        sys.exit(f"{path}: {error.message}")
    return validator, value


def check_misspelled(path):
    validator, value = check_file(path)
    value = copy.deepcopy(value)
    for name in ("structs", "published"):  # all keys below these are names
        value.pop(name, None)
    for wrong in misspelled(value):
        if validator.is_valid(wrong):
            sys.exit(f"{path}: the schema accepts a misspelled key: {wrong}")


def properties(schema):
    found = set(schema.get("properties", {})) if isinstance(schema, dict) else set()
    for part in schema.values() if isinstance(schema, dict) else schema:
        if isinstance(part, (dict, list)):
            found |= properties(part)
    return found


def used_keys(value, part, definitions):
    """(section, key) of every map in the value, which is valid by this part of the schema."""
    for inner in part.get("allOf", []) + part.get("anyOf", []):
        yield from used_keys(value, inner, definitions)
    for item in value if isinstance(value, list) else []:
        yield from used_keys(item, part.get("items", {}), definitions)
    section = part.get("$ref", "").rsplit("/", 1)[-1]
    definition = definitions.get(section, {})
    if not isinstance(value, dict) or "properties" not in definition:
        return
    if not jsonschema.Draft202012Validator({"$defs": definitions, **part}).is_valid(value):
        return   # the element is of another kind
    for key, item in value.items():
        known = key in definition["properties"]
        yield section, key if known else "NAME"
        yield from used_keys(item, definition["properties"][key] if known else definition["additionalProperties"], definitions)


def check_used(schema_path, paths):
    schema = load(schema_path)
    definitions = schema["$defs"]
    unused = {(section, key) for section, definition in definitions.items() if "properties" in definition
              for key in [*definition["properties"], *["NAME"] * bool(definition["additionalProperties"])]}
    for path in paths:
        with open(path, encoding="utf-8") as file:
            value = yaml.safe_load(file)
        if "pipeline" not in value:   # a file to include
            value = {"pipeline": "included", "passes": [], **value}
        unused -= set(used_keys(value, {"$ref": schema["$ref"]}, definitions))
    if unused:
        sys.exit("no spec uses " + ", ".join(f"{section}.{key}" for section, key in sorted(unused)))


def check_keys(schemas, sources):
    known = set().union(*(properties(load(path)) for path in schemas))
    read = set()
    for path in sources:
        with open(path, encoding="utf-8") as file:
            read |= set(re.findall(r'(?:KEY_OF_NUMBERS\(|\.name = )"(\w+)"', file.read()))
    if known not in (read, read - {"scene", "motion"}):  # the tables also contain the names of both kinds of files
        sys.exit(f"only the schemas have {sorted(known - read)}, only the reader has {sorted(read - known)}")


def main():
    arguments = sys.argv[2:]
    if sys.argv[1] == "files":
        for path in arguments:
            check_file(path)
    elif sys.argv[1] == "misspelled":
        for path in arguments:
            check_misspelled(path)
    elif sys.argv[1] == "used":
        check_used(arguments[0], arguments[1:])
    elif sys.argv[1] == "keys":
        check_keys(arguments[:arguments.index("--")], arguments[arguments.index("--") + 1:])
    elif sys.argv[1] == "body":
        with open(arguments[0], encoding="utf-8") as file:
            check_body(file.read(), arguments[1])
    else:
        with open(arguments[1], encoding="utf-8") as file:
            check_reference(load(arguments[0]), file.read())


main()
