"""Flattens a spec, for tests that look into specs: expands included files, groups, repeats and culling in their places.
Paths become relative to the spec; `second.views` becomes second_views, as in bodies and in C."""
import copy
import os
import re

import yaml

NAME = re.compile(r"[A-Za-z_]\w*(?:\.\w+)*")
REFERENCES = ("indirect", "indices", "interleave")
EXPRESSIONS = ("count", "size", "layers", "mips", "mip", "layer", "when", "groups", "dispatch", "local", "gpu_local", "viewport", "scissor",
               "value", "that")
CULL = "cull/cull.yaml"


def beside(path, name):
    return os.path.normpath(os.path.join(os.path.dirname(path), name))


class Scope:
    """The meaning of names in an instance: `words` has texts of arguments and numbers, `own` the names that it declares."""

    def __init__(self, words, own, prefix="", suffix="", outer=None):
        self.words, self.own, self.prefix, self.suffix, self.outer = words, own, prefix, suffix, outer

    def full(self, name):
        first, dot, rest = name.partition(".")
        return f"{self.prefix}{first}{self.suffix}{dot}{rest}"

    def name(self, name):
        first, dot, rest = name.partition(".")
        if first in self.words:
            return self.words[first] + dot + rest
        if first in self.own:
            return self.full(name)
        return self.outer.name(name) if self.outer else name

    def expression(self, value):
        if isinstance(value, list):
            return [self.expression(item) for item in value]
        if not isinstance(value, str):
            return value
        def replace(found):
            text = self.name(found.group())
            return text if NAME.fullmatch(text) or text.isdigit() or text == value else f"({text})"
        return NAME.sub(replace, value)

    def all_words(self):
        return {**(self.outer.all_words() if self.outer else {}), **self.words,
                **{name: self.full(name) for name in self.own.get("constants", ())}}


class Names(dict):
    """Names that a scope declares, by section."""

    def __contains__(self, name):
        return any(name in names for names in self.values())


FILE = Scope({}, Names())


def pass_names(passes):
    return [name for entry in passes for name in (entry.get("name"), entry.get("as", entry.get("group"))) if name] + [
        name for entry in passes for name in pass_names(entry.get("passes", []))]


def access(scope, entry):
    entry = {"name": entry} if isinstance(entry, str) else dict(entry)
    written, entry["name"] = entry["name"], scope.name(entry["name"])
    if "as" not in entry and (written != entry["name"] or "." in written):
        entry["as"] = written.replace(".", "_")
    for key in ("mip", "layer"):
        if key in entry:
            entry[key] = scope.expression(entry[key])
    return entry["name"] if list(entry) == ["name"] else entry


def instance_of(scope, entry):
    """A copy of a pass or a resource of an instance, with the names that are valid outside the instance."""
    entry = copy.deepcopy(entry)
    for key, value in entry.items():
        if key in ("reads", "writes", "updates"):
            entry[key] = [access(scope, item) for item in value]
        elif key in REFERENCES:
            entry[key] = scope.name(value)
        elif key in ("uses", "after"):
            entry[key] = [scope.name(name) for name in value]
        elif key in EXPRESSIONS and value != "frame":
            entry[key] = scope.expression(value)
        elif key == "ranges":
            entry[key] = {name: {**item, "of": scope.name(item["of"]), "count": scope.expression(item["count"])}
                          for name, item in value.items()}
        elif key == "defines":
            entry[key] = {name: scope.expression(item) for name, item in value.items()}
    return entry


class Flattening:
    def __init__(self, path):
        self.path, self.documents, self.expanded = path, {}, False
        self.templates = os.path.dirname(path)

    def read(self, file):
        """The passes of a file; none if the file was read before."""
        if file in self.documents:
            return []
        with open(beside(self.path, file), encoding="utf-8") as text:
            document = self.documents[file] = yaml.safe_load(text)
        passes = []
        for name in document.pop("include", []):
            passes += self.read(beside(file, name))
        for group in document.get("groups", {}).values():
            self.place(file, group["passes"])
        for entry in document.pop("passes", []):
            if "include" in entry:
                passes += self.read(beside(file, entry["include"]))
            else:
                self.place(file, [entry])
                passes.append(entry)
        return passes

    def place(self, file, passes):
        """Makes paths relative to the spec; paths below the templates stay."""
        def of(name):
            return beside(file, name) if os.path.exists(beside(self.path, beside(file, name))) else name
        for entry in passes:
            if isinstance(entry.get("shader"), str):
                entry["shader"] = of(entry["shader"])
            self.place(file, entry.get("passes", []))

    def expand(self, scope, passes, spec):
        """The passes with all instances expanded; adds the declarations of the instances to the spec."""
        out = []
        for entry in passes:
            self.expanded |= any(key in entry for key in ("repeat", "group")) or isinstance(entry.get("cull"), dict)
            if "repeat" in entry:
                out += self.repeat(scope, dict(entry), spec)
            elif "group" in entry:
                out += self.group(scope, entry, spec)
            elif isinstance(entry.get("cull"), dict):
                out += self.cull(scope, dict(entry), spec)
            else:
                own = instance_of(scope, entry)
                own["name"] = scope.full(entry["name"])
                if isinstance(own["shader"], list):
                    own["shader"] = [scope.name(name) if name in scope.words else name for name in own["shader"]]
                own["words"] = scope.all_words()
                out.append(own)
        return out

    def repeat(self, scope, entry, spec):
        name, first, last = re.fullmatch(r"(\w+) in (.*?)\s*\.\.\s*(.*)", entry.pop("repeat")).groups()
        values = {**{key: value["value"] if isinstance(value, dict) else value for key, value in spec["params"].items()}}
        passes, out = entry.get("passes", [entry]), []
        for k in range(eval(scope.expression(first), {}, values), eval(scope.expression(last), {}, values) + 1):
            inner = Scope({name: str(k)}, Names(passes=pass_names(passes)), scope.prefix, f"{scope.suffix}.{k}", scope)
            out += self.expand(inner, passes, spec)
        return out

    def group(self, scope, entry, spec):
        group = next(document["groups"][entry["group"]] for document in self.documents.values()
                     if entry["group"] in document.get("groups", {}))
        prefix = scope.full(entry.get("as", entry["group"])) + "."
        words = {name: str(scope.expression(value)) for name, value in entry.get("with", {}).items()}
        sections = ("constants", "buffers", "images")
        inner = Scope(words, Names({section: list(group.get(section, {})) for section in sections},
                                   passes=pass_names(group["passes"])), prefix)
        for section in sections:
            for name, item in group.get(section, {}).items():
                item = instance_of(inner, item) if isinstance(item, dict) else inner.expression(item)
                spec.setdefault(section, {})[prefix + name] = item
        return self.expand(inner, group["passes"], spec)

    def cull(self, scope, entry, spec):
        self.read(os.path.relpath(os.path.join(self.templates, CULL), os.path.dirname(self.path)))
        cull, name = entry.pop("cull"), entry["name"]
        frustum = "cull/light_frustum.glsl" if entry.get("view") == "light" else "cull/frustum.glsl"
        keep = frustum if cull["keep"] == "frustum" else cull["keep"]
        words = {"keep": keep, "cull_room": cull.get("room", 1048576), "cull_most": cull.get("most", 1048576),
                 "cull_when": entry.get("when", 1)}
        if "each" in cull:
            words.update(each=cull["each"], cull_layers=entry.get("layers", 1), cull_again=cull.get("again", 0))
        if "faces" in cull:
            entry["cull"] = cull["faces"]
        draws = Scope({"whole": "0"}, Names(passes=[name]), scope.prefix, scope.suffix, scope)
        rest = Scope({"whole": "1"}, Names(), scope.prefix, scope.suffix + ".whole", draws)
        whole = {**entry, "indirect": name + ".whole_draws", "updates": entry.get("updates", []) + entry.get("writes", [])}
        whole.pop("writes", None)
        return (self.group(draws, {"group": "cull_each" if "each" in cull else "cull", "as": name, "with": words}, spec) +
                self.expand(draws, [{**entry, "indirect": name + ".draws", "indices": name + ".indices"}], spec) +
                self.expand(rest, [whole], spec))

    def bodies(self, entry):
        """The text of a pass's body and of its includes."""
        texts, names = [], entry["shader"] if isinstance(entry["shader"], list) else [entry["shader"]]
        for name in names:
            for folder in (os.path.dirname(self.path), self.templates, "templates"):
                if os.path.exists(os.path.join(folder, name)):
                    with open(os.path.join(folder, name), encoding="utf-8") as file:
                        text = file.read()
                    texts.append(text)
                    names = names + [beside(name, found) for found in re.findall(r'#include "([^"]+)"', text)]
                    texts += [self.bodies({"shader": beside(name, found)}) for found in
                              re.findall(r'#include "([^"]+)"', text)]
                    break
        return "\n".join(texts)

    def define_words(self, entry):
        """Adds macros for the instance's arguments, constants and numbers that the body of a pass uses."""
        words = entry.pop("words", {})
        text = re.sub(r"/\*.*?\*/|//[^\n]*", " ", self.bodies(entry), flags=re.S) if words else ""
        for word, value in words.items():
            declared = re.search(rf"\b(float|u?int|vec\d|out \w+)\s+{word}\b", text)
            number = not str(value).endswith(".glsl") and (not NAME.fullmatch(str(value)) or value in self.values)
            if number and not declared and re.search(rf"(?<![\w.]){word}\b", text):
                entry.setdefault("defines", {})[word] = value

    def spec(self):
        passes = self.read(os.path.basename(self.path))
        spec, *others = list(self.documents.values())
        spec["passes"] = self.expand(FILE, passes, spec)
        others = list(self.documents.values())[1:]
        for document in others:
            for section, content in document.items():
                if isinstance(content, dict):
                    spec.setdefault(section, {}).update(content)
                elif isinstance(content, list):
                    spec.setdefault(section, []).extend(content)
        spec.pop("groups", None)
        self.values = {*spec.get("params", {}), *spec.get("constants", {})}
        for entry in spec["passes"]:
            self.define_words(entry)
        return without_dots(spec), bool(others) or self.expanded


def without_dots(spec):
    dotted = {name for section in ("constants", "buffers", "images") for name in spec.get(section, {}) if "." in name}
    dotted |= {entry["name"] for entry in spec["passes"] if "." in entry["name"]}

    def change(value):
        if isinstance(value, dict):
            return {change(key): change(item) for key, item in value.items()}
        if isinstance(value, list):
            return [change(item) for item in value]
        return NAME.sub(lambda found: found.group().replace(".", "_") if found.group() in dotted else found.group(),
                        value) if isinstance(value, str) else value
    return change(spec)


def load(path):
    """The tree, and whether it differs from the file."""
    return Flattening(path).spec()
