"""Prints each name that functions or structs have in three files or more, as `FILE:LINE: error: ...`, and fails on one:
a backtrace and a search by name should lead to one place.

Called by `ninja check`, in the project's folder, with the C and C++ files to read. The runtimes mirror each other: a file of each
counts once. Verbs of the tables (verbs.def) are named as there. The layout is clang-format's: a definition begins in the first column,
and so does its brace."""
import collections
import re
import sys

FUNCTION = re.compile(r"(\w+)\s*\((?!\()")
STRUCT = re.compile(r"(?:typedef |static |const |extern )*((?:struct|union|enum) \w+)(?: : \w+)? ?\{")
MOST = 2


def count(places):
    mirrored = [sum(path.startswith(folder) for path in places) for folder in ("runtime_gl/", "runtime_vk/")]
    return len(places) - min(mirrored)


def definitions(lines):
    """Yields the line number and the name of each function, struct, union and enum that these lines define."""
    head = 0  # the first line of what may be a head
    for number, line in enumerate(lines):
        if line == "{":
            text = " ".join(lines[head:number])
            name = FUNCTION.search(re.sub(r"__attribute__\(\(.*?\)\)|VKAPI_\w+|DT_\w+\(\w+\)", "", text))
            if name and not text.startswith(("extern", "namespace")):
                yield head, name[1]
        elif STRUCT.match(line):
            yield number, STRUCT.match(line)[1]
        if not line or line[0] in "#}/ *{" and not (line[0] == " " and number > head) or line.endswith((";", "*/")):
            head = number + 1


def main():
    verbs = set(re.findall(r"DT_VERB\(\w+, (\w+)", open("templates/c/verbs.def", encoding="utf-8").read()))
    found = collections.defaultdict(dict)
    for path in sys.argv[1:]:
        if path.startswith("tests/"):
            continue
        with open(path, encoding="utf-8") as file:
            for number, name in definitions(file.read().split("\n")):
                found[name].setdefault(path, number + 1)
    wrong = {name: places for name, places in found.items() if count(places) > MOST and name not in verbs | {"main"}}
    for name, places in sorted(wrong.items()):
        for path, line in places.items():
            print(f"{path}:{line}: error: {name}: {len(places)} files define this name; rename all but {MOST}")
    return 1 if wrong else 0


sys.exit(main())
