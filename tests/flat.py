"""A spec with its includes written out, for tests that look into specs: sections of included files behind the spec's own,
passes in their places, paths relative to the spec."""
import os

import yaml


def beside(path, name):
    return os.path.normpath(os.path.join(os.path.dirname(path), name))


def load(path):
    """The tree, and whether it had includes."""
    documents = {}

    def read(file):
        if file in documents:
            return []
        with open(beside(path, file), encoding="utf-8") as text:
            document = documents[file] = yaml.safe_load(text)
        passes = []
        for name in document.pop("include", []):
            passes += read(beside(file, name))
        for entry in document.pop("passes", []):
            if "include" in entry:
                passes += read(beside(file, entry["include"]))
                continue
            entry.update({key: beside(file, entry[key]) for key in ("shader", "limit") if key in entry})
            passes.append(entry)
        return passes

    passes = read(os.path.basename(path))
    spec, *others = documents.values()
    for document in others:
        for section, content in document.items():
            if isinstance(content, dict):
                spec.setdefault(section, {}).update(content)
            elif isinstance(content, list):
                spec.setdefault(section, []).extend(content)
    spec["passes"] = passes
    return spec, bool(others)
