"""Rewrites of a pipeline that must not change a bit of its results. Each rewrite takes a Pipeline: a spec and the text of its
GLSL bodies. It changes the Pipeline in place, and notes the new places of the original's resources. The comment above each
rewrite says why nothing may change. metamorphic.py applies the rewrites and compares."""
import copy
import json
import os
import re

import yaml

import flat

SECTIONS = ("params", "constants", "structs", "buffers", "images", "samplers", "metrics", "interleaves")

# Suffixes of the words that a declared name defines in bodies.
SUFFIXES = ("_sample_lod", "_class_size", "_count", "_size", "_store", "_sample", "_compare", "_tile", "_map",
            "_classes", "_class", "_split", "_gather")

WORD = r"[A-Za-z_]\w*"
INDEX = r"(?:[^][]|\[[^]]*\])*"   # an element's index, with or without brackets in it
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]+"([^"]+)"[^\n]*\n', re.M)


class Pipeline:
    """A spec as a tree, its bodies by path, and the places to which a rewrite has moved the original's content."""

    def __init__(self, path):
        self.file = os.path.basename(path)
        self.spec, included = flat.load(path)
        with open(path, encoding="utf-8") as file:
            self.original_text = file.read()
        if included:
            self.original_text = yaml.safe_dump(self.spec, sort_keys=False, width=110)
        self.text = None   # the spec's text, if a rewrite changes the text itself; else `write` writes the tree
        self.bodies = {}
        for entry in self.passes():
            self.join(os.path.dirname(path), entry)
            self.load(os.path.dirname(path), entry["shader"])
        self.settings = {}   # --set of parameters
        self.pass_names = {}   # name in the original -> name here; without names that stay
        self.names = {}        # the same for resources
        self.fields = {}       # (resource, field) of the original -> (resource, field) here
        self.longer = False    # buffers may have more elements at their end than the original's
        self.wider = False     # texels may have more channels
        self.same_output = False   # the generator must write the very same files

    def join(self, folder, entry):
        """Joins a body of several files to one file."""
        if isinstance(entry["shader"], list):
            path = f"{entry['name']}_joined.glsl"
            self.bodies[path] = "".join(f'#include "{name}"\n' for name in entry["shader"])
            for name in entry["shader"]:
                self.load(folder, name)
            entry["shader"] = path

    def load(self, folder, path):
        if path in self.bodies:
            return
        with open(os.path.join(folder, path), encoding="utf-8") as file:
            self.bodies[path] = file.read()
        for included in INCLUDE.findall(self.bodies[path]):
            self.load(folder, flat.beside(path, included))

    def visible(self):
        """The whole input of the generator, in its order."""
        return json.dumps([self.text or self.original_text, self.spec, self.bodies, self.settings])

    def passes(self):
        return self.spec["passes"]

    def section(self, name):
        return self.spec.get(name, {})

    def resources(self):
        return {**self.section("buffers"), **self.section("images")}

    def write(self, folder):
        """Returns the spec's path."""
        spec = self.text or yaml.dump(self.spec, Dumper=yaml.SafeDumper, sort_keys=False, width=110)
        for path, text in {self.file: spec, **self.bodies}.items():
            os.makedirs(os.path.dirname(os.path.join(folder, path)), exist_ok=True)
            with open(os.path.join(folder, path), "w", encoding="utf-8", newline="") as file:
                file.write(text)
        return os.path.join(folder, self.file)




# ---- Reading and editing specs and GLSL ----

def names_of(access):
    return [entry if isinstance(entry, str) else entry["name"] for entry in access or []]


def reads(entry):
    """Resources that the pass reads, including indirect arguments and indices."""
    return names_of(entry.get("reads")) + [entry[key] for key in ("indirect", "indices") if key in entry]


def changes(entry):
    return names_of(entry.get("writes")) + names_of(entry.get("updates"))


def uses_resource(entry, name):
    return name in reads(entry) + changes(entry)


def replace_access(entry, old, new):
    """Puts the name `new` wherever the pass accesses `old`."""
    for key in ("reads", "writes", "updates"):
        if key in entry:
            entry[key] = [new if access == old else
                          {**access, "name": new} if isinstance(access, dict) and access["name"] == old else access
                          for access in entry[key]]
    for part in entry.get("ranges", {}).values():
        part["of"] = new if part["of"] == old else part["of"]


def as_list(value):
    return value if isinstance(value, list) else [value]


def replace_words(text, words):
    """Replaces whole words that are not members (as in `frame.width`): words that are declared, and words made from
    these by a suffix, as `vpls_count`."""
    def replace(found):
        word = found.group()
        if word in words:
            return words[word]
        for suffix in SUFFIXES:
            if word.endswith(suffix) and word[:-len(suffix)] in words:
                return words[word[:-len(suffix)]] + suffix
        return word
    return re.sub(rf"(?<![\w.]){WORD}", replace, text)


def expression(text):
    """A spec's integer expression as GLSL."""
    text = replace_words(str(text), {"frame": "frame"})
    text = re.sub(r"\bframe\.(width|height)\b", r"int(frame.\1)", text)
    return calls(text, "ceil_div", lambda a, b: f"((({a}) + ({b}) - 1) / ({b}))")


def calls(text, name, replace):
    """Rewrites every call of a function from its arguments, inner ones first."""
    at = 0
    while True:
        found = re.compile(rf"(?<![\w.]){name}\s*\(").search(text, at)
        if not found:
            return text
        arguments, depth, begin, end = [], 1, found.end(), found.end()
        while depth:
            depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(text[end], 0)
            if depth == 0 or (depth == 1 and text[end] == ","):
                arguments.append(calls(text[begin:end].strip(), name, replace))
                begin = end + 1
            end += 1
        new = replace(*arguments)
        text = text[:found.start()] + new + text[end:]
        at = found.start() + len(new)


def paste_includes(pipeline, path):
    return INCLUDE.sub(lambda found: paste_includes(pipeline, flat.beside(path, found.group(1))) + "\n",
                       pipeline.bodies[path])


def body_per_pass(pipeline):
    """Gives every pass a body of its own, with its includes pasted in, so that it can be edited alone."""
    bodies = {}
    for entry in pipeline.passes():
        path = f"of_{entry['name']}.glsl"
        bodies[path] = paste_includes(pipeline, entry["shader"])
        entry["shader"] = path
    pipeline.bodies = bodies


def accesses(entry):
    return [access for key in ("reads", "writes", "updates") for access in entry.get(key, [])]


def own_names(pipeline):
    """Replaces names in bodies that passes list with `as` by the resources' own names."""
    for entry in pipeline.passes():
        words = {access["as"]: access["name"] for access in accesses(entry) if "as" in access}
        if not words:
            continue
        path = f"named_{entry['name']}.glsl"
        pipeline.bodies[path] = replace_words(paste_includes(pipeline, entry["shader"]), words)
        entry["shader"] = path
        for key in ("reads", "writes", "updates"):
            plain = [{part: value for part, value in access.items() if part != "as"} if "as" in access else access
                     for access in entry.get(key, [])]
            entry[key] = [access["name"] if isinstance(access, dict) and len(access) == 1 else access
                          for access in plain]


def edit_bodies(pipeline, edit):
    pipeline.bodies = {path: edit(text) for path, text in pipeline.bodies.items()}


def argument_structs(pipeline):
    """Structs whose layout the graphics API dictates: arguments of indirect draws and dispatches."""
    return {pipeline.spec["buffers"][entry["indirect"]]["of"] for entry in pipeline.passes() if "indirect" in entry}


def image_of_targets(pipeline):
    return {name for entry in pipeline.passes() if "draw" in entry for name in changes(entry)}


def is_filtered(pipeline, name):
    return any(isinstance(access, dict) and access["name"] == name and "sampler" in access
               for entry in pipeline.passes() for access in entry.get("reads", []))


def only_called(pipeline, name):
    """Whether the bodies use the image only in calls, never in `#define SOURCE name`."""
    return not any(re.search(rf"(?<![\w.]){name}\b(?!\s*\()", text) for text in pipeline.bodies.values())


# ---- The rewrites ----

REWRITES = {}


def rewrite(description, *specs):
    """Registers a rewrite for the specs that it can change; a short run uses only the first of these."""
    def register(function):
        REWRITES[description] = (function, specs)
        return function
    return register


# The spec has the values that the original gets from the command line. All rewrites that render do the same.
@rewrite("values set in the spec", "ssvp", "rsm")
def values_set_in_spec(pipeline):
    values_in_spec(pipeline)
    pipeline.same_output = True


# Overrides of different values are independent.
@rewrite("overrides in another order", "rsm", "ssvp")
def overrides_backwards(pipeline):
    pipeline.settings = dict(reversed(pipeline.settings.items()))
    pipeline.same_output = True


def values_in_spec(pipeline):
    for name, value in pipeline.settings.items():
        pipeline.spec["params"][name]["value"] = value
    pipeline.settings = {}


# Names have no meaning: their length, alphabetical order and resemblance to other names do not matter.
@rewrite("everything renamed", "ssvp", "rsm", "features", "mips")
def rename_everything(pipeline):
    declared = [name for section in SECTIONS for name in pipeline.section(section)]
    declared += [name for entry in pipeline.passes() for name in entry.get("ranges", {})]
    words = {name: f"{chr(ord('z') - i % 26)}{i}" for i, name in enumerate(sorted(declared))}
    fields = sorted({field for fields in pipeline.section("structs").values() for field in fields})
    members = {field: f"q{len(fields) - i}" for i, field in enumerate(fields) if not re.fullmatch("[xyzw]+", field)}
    passes = {entry["name"]: f"pass_{chr(ord('z') - i % 26)}{i}" for i, entry in enumerate(pipeline.passes())}

    def rename(node, key=None):
        if isinstance(node, dict):
            return {name: rename(value, name) for name, value in node.items()}
        if isinstance(node, list):
            return [rename(value, key) for value in node]
        return replace_words(node, words) if isinstance(node, str) and key not in ("doc", "shader") else node

    def rename_body(text):
        own = r"(?:frame|view|camera|m|seen)(?:\.\w+)*"   # structs that the generator or a body declares
        text = re.sub(rf"(?<![\w.])({own})|\.({WORD})",
                      lambda found: found.group(1) or "." + members.get(found.group(2), found.group(2)), text)
        return replace_words(text, words)

    spec = rename(pipeline.spec)
    for section in SECTIONS + ("contracts",):
        spec[section] = {words.get(name, name): value for name, value in spec.get(section, {}).items()}
    spec["structs"] = {name: {members.get(field, field): kind for field, kind in fields.items()}
                       for name, fields in spec["structs"].items()}
    for metric in spec["metrics"].values():
        metric.update(position_field=members.get("position", "position"),
                      normal_field=members.get("normal", "normal"))
    for entry, original in zip(spec["passes"], pipeline.passes()):
        entry["name"] = passes[original["name"]]
        if "draw" in entry:
            entry["draw"] = original["draw"]
        if "ranges" in entry:
            entry["ranges"] = {words[name]: value for name, value in entry["ranges"].items()}
    spec["pipeline"] = "other"
    edit_bodies(pipeline, lambda text: "".join(
        line if INCLUDE.match(line) else rename_body(line) for line in text.splitlines(keepends=True)))
    for buffer, declaration in pipeline.section("buffers").items():
        for field in pipeline.section("structs").get(declaration["of"], {}):
            pipeline.fields[buffer, field] = (words[buffer], members.get(field, field))
    pipeline.names, pipeline.pass_names, pipeline.spec = words, passes, spec


# The name of a resource in a body matters only to that body and its pass.
@rewrite("bodies call resources by their names", "ssvp", "features")
def names_in_bodies(pipeline):
    own_names(pipeline)


@rewrite("every pass with words of its own for resources", "features", "rsm", "ssvp", "mips")
def other_words(pipeline):
    own_names(pipeline)
    body_per_pass(pipeline)
    for entry in pipeline.passes():
        listed = [name for name in names_of(accesses(entry)) if name in pipeline.resources()]
        words = {name: f"word_{i}_of_{entry['name']}" for i, name in enumerate(dict.fromkeys(listed))}
        for key in ("reads", "writes", "updates"):
            entry[key] = [access if name not in words else
                          {**(access if isinstance(access, dict) else {"name": name}), "as": words[name]}
                          for access, name in zip(entry.get(key, []), names_of(entry.get(key)))]
        for part in entry.get("ranges", {}).values():
            if "first" in part:
                part["first"] = replace_words(part["first"], words)
        pipeline.bodies[entry["shader"]] = replace_words(pipeline.bodies[entry["shader"]], words)


# Passes that share no resource that one of them changes may run in any order.
@rewrite("independent passes in another order", "rsm", "ssvp", "features", "mips")
def reorder_passes(pipeline):
    left, order = pipeline.passes(), []

    def depends(later, earlier):
        return (set(changes(earlier)) & set(reads(later) + changes(later)) or
                set(changes(later)) & set(reads(earlier)) or earlier["name"] in later.get("after", []))

    while left:
        ready = [entry for i, entry in enumerate(left) if not any(depends(entry, other) for other in left[:i])]
        order.append(ready[-1])
        left = [entry for entry in left if entry is not ready[-1]]
    pipeline.spec["passes"] = order


# Reads and writes decide the order of passes, and their places in the list do not. One exception: a pass listed before the
# writer of a history resource reads the last frame's content, so `after` keeps that order. Not ssvp, where updates of one
# resource run in the order of the list.
@rewrite("passes listed backwards", "features", "rsm")
def passes_backwards(pipeline):
    for i, entry in enumerate(pipeline.passes()):
        kept = [name for name in reads(entry) if pipeline.resources().get(name, {}).get("history")]
        after = [earlier["name"] for earlier in pipeline.passes()[:i] if set(kept) & set(changes(earlier))]
        if after:
            entry["after"] = entry.get("after", []) + after
    pipeline.passes().reverse()


# Declarations are a set, and so are the reads, writes and uses of a pass: their order decides bindings and offsets, but not
# content.
@rewrite("declarations and lists backwards", "ssvp", "rsm", "features", "mips")
def declarations_backwards(pipeline):
    for section in SECTIONS:
        if section in pipeline.spec:
            pipeline.spec[section] = dict(reversed(pipeline.spec[section].items()))
    for i, entry in enumerate(pipeline.passes()):
        for key in ("reads", "writes", "updates", "uses"):
            if key in entry:
                entry[key] = entry[key][::-1]
        pipeline.passes()[i] = dict(reversed(entry.items()))
    pipeline.spec = dict(reversed(pipeline.spec.items()))


def first_number(pipeline, name):
    """GLSL: some float from a resource."""
    if name in pipeline.section("images"):
        image = pipeline.spec["images"][name]
        texel = f"{name}({'ivec3' if 'layers' in image else 'ivec2'}(0))"
        return texel if image["format"] == "d32f" else f"float({texel}.x)"
    kind, path = pipeline.spec["buffers"][name]["of"], f"{name}[0]"
    if kind in pipeline.section("structs"):
        field, kind = next(iter(pipeline.spec["structs"][kind].items()))
        path += "." + field
    return f"float({path}{'.x' if 'vec' in kind else ''})"


# Resources that no live pass reads change nothing, although they take part in lifetimes, memory and barriers. Each dead pass
# reads up to five resources that earlier passes write.
@rewrite("dead passes and resources", "rsm", "ssvp", "features", "mips")
def dead_passes(pipeline):
    spec, passes, alive = pipeline.spec, [], []
    spec["params"]["dead_weight"] = {"value": 0.5, "live": True}
    spec.setdefault("constants", {})["dead_count"] = "5 * 3"
    spec.setdefault("structs", {})["Dead"] = {"weights": "float[3]", "turn": "mat4", "last": "uint"}
    spec["buffers"]["dead_unused"] = {"of": "Dead", "count": "dead_count"}
    spec["samplers"]["dead_filter"] = {"kind": "filter", "filter": "linear"}
    for i, entry in enumerate(pipeline.passes()):
        passes.append(entry)
        alive += [name for name in changes(entry) if name not in alive]
        seen = alive[-5:]
        draws = i % 3 == 1
        name, image, body = f"dead_{i}", f"dead_image_{i}", f"dead_{i}.glsl"
        spec["images"][image] = {"format": "rgba16f", "size": ["5", "3"]}
        passes.append({"name": name, "reads": seen, "writes": [image], "shader": body,
                       **({"draw": "fullscreen"} if draws else {"dispatch": image})})
        value = "vec4(" + " + ".join(["dead_weight"] + [first_number(pipeline, other) for other in seen]) + ")"
        store = f"{image} = {value};" if draws else f"{image}_store(invocation().xy, {value});"
        inside = "" if draws else f"    if (any(greaterThanEqual(invocation().xy, {image}_size())))\n        return;\n"
        pipeline.bodies[body] = f"void main()\n{{\n{inside}    {store}\n}}\n"
    spec["passes"] = passes


# An element's fields have the same values in one buffer or in two.
@rewrite("two buffers merged into one of structs", "ssvp", "features")
def merge_buffers(pipeline):
    own_names(pipeline)
    buffers = pipeline.spec["buffers"]
    keep, join = ("vpls", "first_labels") if "vpls" in buffers else ("histogram", "marks")
    first, second = buffers.pop(keep), buffers.pop(join)
    structure = pipeline.spec["structs"][first["of"]]
    pipeline.spec["structs"]["Merged"] = {"joined": second["of"], **structure}
    buffers["merged"] = {"of": "Merged", "count": first["count"]}
    for entry in pipeline.passes():
        names = [name for name in (keep, join) if uses_resource(entry, name)]
        mode = "writes" if keep in changes(entry) else "updates" if join in changes(entry) else "reads"
        for key in ("reads", "writes", "updates"):
            entry[key] = [access for access in entry.get(key, []) if access not in names]
        entry[mode] += ["merged"] if names else []
    edit_bodies(pipeline, lambda text: re.sub(rf"(?<![\w.]){join}\[({INDEX})\]", r"merged[\1].joined",
                                              replace_words(text, {keep: "merged"})))
    pipeline.fields.update({(keep, field): ("merged", field) for field in structure})
    pipeline.fields[join, ""] = ("merged", "joined")
    pipeline.names = {keep: "merged", join: "merged"}


def split_buffer(pipeline, buffer):
    declaration = pipeline.spec["buffers"].pop(buffer)
    fields = pipeline.spec["structs"][declaration["of"]]
    for field, kind in fields.items():
        pipeline.spec["buffers"][f"{buffer}_{field}"] = {**declaration, "of": kind}
        pipeline.fields[buffer, field] = (f"{buffer}_{field}", "")
    for entry in pipeline.passes():
        for key in ("reads", "writes", "updates"):
            if buffer in entry.get(key, []):
                entry[key].remove(buffer)
                entry[key] += [f"{buffer}_{field}" for field in fields]
    edit_bodies(pipeline, lambda text: re.sub(
        rf"(?<![\w.]){buffer}\[({INDEX})\]\.({WORD})", rf"{buffer}_\2[\1]",
        re.sub(rf"(?<![\w.]){buffer}_count\b", f"{buffer}_{next(iter(fields))}_count", text)))


# The inverse: every field in a buffer of its own.
@rewrite("buffers of structs split", "ssvp", "rsm", "features")
def split_buffers(pipeline):
    own_names(pipeline)
    if "taps" in pipeline.spec["buffers"]:
        ranges_as_loops(pipeline)   # a range runs over whole elements
        edit_bodies(pipeline, lambda text: text.replace("Tap tap = taps[(0) + element];", "").replace(
            "tap.", "taps[element]."))
    for buffer in ("first_centres", "vpls", "second_vpl", "taps", "histogram"):
        if buffer in pipeline.spec["buffers"]:
            split_buffer(pipeline, buffer)


def restructure(pipeline, change):
    structs, dictated = pipeline.section("structs"), argument_structs(pipeline)
    pipeline.spec["structs"] = {name: fields if name in dictated else change(fields) for name, fields in structs.items()}


# Unused fields change only the offsets of the others.
@rewrite("structs padded with unused fields", "rsm", "ssvp", "features")
def pad_structs(pipeline):
    kinds = ["float", "vec3", "float[3]", "mat4", "uint", "ivec2"]

    def pad(fields):
        padded = {"unused": "vec2"}
        for i, (name, kind) in enumerate(fields.items()):
            padded.update({name: kind, f"unused_{i}": kinds[i % len(kinds)]})
        return padded
    restructure(pipeline, pad)


# Bodies access fields by name, so the order of fields does not matter.
@rewrite("fields of structs backwards", "features", "ssvp", "rsm")
def fields_backwards(pipeline):
    restructure(pipeline, lambda fields: dict(reversed(fields.items())))


# A constant equals its expression.
# Not ssvp: a comparison in a constant is a number, but in GLSL it is none.
@rewrite("constants inlined", "rsm", "features")
def inline_constants(pipeline):
    constants = {name: f"({value['value'] if isinstance(value, dict) else value})"
                 for name, value in pipeline.spec.pop("constants").items()}

    def inline(text):
        while (inlined := re.sub(rf"(?<![\w.]){WORD}", lambda word: constants.get(word.group(), word.group()),
                                 text)) != text:
            text = inlined
        return text

    def walk(node, key=None):
        if isinstance(node, dict):
            return {name: walk(value, name) for name, value in node.items()}
        if isinstance(node, list):
            return [walk(value, key) for value in node]
        if not isinstance(node, str) or key in ("doc", "shader", "message"):
            return node
        return expression(inline(node)) if key == "first" else inline(node)   # a range's first element is GLSL

    pipeline.spec = {key: walk(value, key) for key, value in pipeline.spec.items()}
    edit_bodies(pipeline, lambda text: re.sub(
        rf"(?<![\w.]){WORD}",
        lambda word: expression(inline(word.group())) if word.group() in constants else word.group(), text))


# Integer expressions are exact: x, x + 0, min(x, x), 3 * x / 3 and c ? x : x are equal. A condition equals its double negation.
@rewrite("expressions replaced by equal ones", "ssvp", "rsm", "features", "mips")
def equal_expressions(pipeline):
    forms = ["({0}) + 0", "min({0}, {0})", "3 * ({0}) / 3", "1 < 2 ? ({0}) : ({0}) + 1", "-(0 - ({0}))",
             "ceil_div(2 * ({0}), 2)"]
    used = 0

    def equal(value):
        nonlocal used
        used += 1
        return forms[used % len(forms)].format(value)

    spec = pipeline.spec
    for section, keys in (("buffers", ["count"]), ("images", ["layers"]), ("samplers", ["count"]),
                          ("interleaves", ["x", "y"])):
        for declaration in pipeline.section(section).values():
            for key in set(keys) & set(declaration):
                declaration[key] = equal(declaration[key])
    for image in pipeline.section("images").values():
        size = ["frame.width", "frame.height"] if image["size"] == "frame" else image["size"]
        image["size"] = [equal(value) for value in size]
    for entry in pipeline.passes():
        for key in ("dispatch", "groups", "local", "gpu_local"):
            if key in entry and str(entry[key]) not in spec["images"]:
                entry[key] = [equal(value) for value in as_list(entry[key])]
        if "when" in entry:
            entry["when"] = f"!!({entry['when']})"
        for part in entry.get("ranges", {}).values():
            part["count"] = equal(part["count"])
    for name, value in pipeline.section("constants").items():
        spec["constants"][name] = {**value, "value": equal(value["value"])} if isinstance(value, dict) else equal(value)


# A parameter has the same value as a literal and as an input of the frame. denoise_normal is an exception: bodies subtract it
# from 1.0, and glslang computes with constants in double precision, for both backends alike.
@rewrite("live parameters baked", "rsm", "ssvp", "features", "mips")
def bake_live(pipeline):
    for name, param in pipeline.spec["params"].items():
        if isinstance(param, dict) and name != "denoise_normal":
            param.pop("live", None)


@rewrite("uniform parameters baked", "rsm", "ssvp")
def bake_uniform(pipeline):
    for param in pipeline.section("params").values():
        if isinstance(param, dict):
            param.pop("uniform", None)


# Only parameters of ssvp that are not the length of an array.
@rewrite("baked parameters made uniform", "ssvp")
def make_uniform(pipeline):
    for name in ("second_by_flux", "cull_triangles"):
        pipeline.spec["params"][name]["uniform"] = True


# The inverse, for a parameter that decides no count and no size.
@rewrite("baked parameter made live", "ssvp")
def make_live(pipeline):
    iterations = pipeline.spec["params"]["kmeans_iterations"]
    del iterations["uniform"]   # a parameter cannot be both uniform and live
    iterations["live"] = True


def place_ranges(pipeline, storage, loop):
    for entry in pipeline.passes():
        for part in entry.get("ranges", {}).values():
            part.update(storage=storage, loop=loop)


# The storage of a range's elements and the form of its loop change only the time.
@rewrite("ranges rolled over a uniform block", "ssvp", "features")
def ranges_uniform(pipeline):
    place_ranges(pipeline, "uniform", "roll")


@rewrite("ranges unrolled over a storage buffer", "ssvp", "rsm", "features")
def ranges_buffer(pipeline):
    place_ranges(pipeline, "buffer", "unroll")


@rewrite("ranges rolled over shared memory", "ssvp", "features", "rsm")
def ranges_shared(pipeline):
    place_ranges(pipeline, "shared", "roll")


@rewrite("planned for a GPU", "ssvp", "rsm", "features")
def plan_for_gpu(pipeline):
    pipeline.spec["target"] = "gpu"


# A range is the run of elements that a plain loop visits.
@rewrite("ranges written as plain loops", "rsm", "ssvp", "features")
def ranges_as_loops(pipeline):
    own_names(pipeline)
    body_per_pass(pipeline)
    for entry in pipeline.passes():
        for name, part in entry.pop("ranges", {}).items():
            head = (rf"for (int element = 0; element < {expression(part['count'])}; ++element) {{ "
                    rf"\1 \2 = {part['of']}[({part.get('first', 0)}) + element];")
            text = pipeline.bodies[entry["shader"]]
            pipeline.bodies[entry["shader"]] = re.sub(rf"for \(({WORD}) ({WORD}) : {name}\) {{", head, text)


# Every invocation does its own work, in workgroups of any size. Only for passes that dispatch by invocations, and whose bodies
# skip or clamp invocations beyond the last one.
@rewrite("other workgroups", "rsm", "ssvp", "features")
def other_workgroups(pipeline):
    for i, entry in enumerate(pipeline.passes()):
        if not {"dispatch", "interleave"} & set(entry) or entry["name"] == "remember":
            continue
        flat = "interleave" in entry or entry["dispatch"] in pipeline.spec["images"]
        entry["local"] = [[16, 4], [4, 2], [1, 8]][i % 3] if flat else [96, 37, 63][i % 3]


# A dispatch by invocations equals a dispatch by the number of groups that hold these invocations.
@rewrite("dispatches written as groups", "features", "ssvp", "rsm")
def dispatch_groups(pipeline):
    for entry in pipeline.passes():
        if "dispatch" not in entry:
            continue
        size = entry.pop("dispatch")
        image = pipeline.spec["images"].get(size)
        size = as_list(size) if not image else (
            ["frame.width", "frame.height"] if image["size"] == "frame" else image["size"])
        local = as_list(entry.get("local", [8, 8] if len(size) > 1 else 64))
        entry["local"] = local
        entry["groups"] = [f"ceil_div({n}, {local[i] if i < len(local) else 1})" for i, n in enumerate(size)]


# An array of one layer holds what an image holds. (rsm has no image that qualifies.)
@rewrite("images made arrays of one layer", "features", "ssvp")
def make_layered(pipeline):
    own_names(pipeline)
    output = pipeline.spec["output"].values()
    chosen = [name for name, image in pipeline.spec["images"].items()
              if "layers" not in image and name not in output and name not in image_of_targets(pipeline)
              and not is_filtered(pipeline, name) and only_called(pipeline, name)]
    for name in chosen:
        pipeline.spec["images"][name]["layers"] = 1

        def add_layer(text, name=name):
            text = calls(text, name, lambda p: f"{name}(ivec3({p}, 0))")
            return calls(text, f"{name}_store", lambda p, *value: f"{name}_store(ivec3({p}, 0), {', '.join(value)})")
        edit_bodies(pipeline, add_layer)


# Elements behind the last used element do not matter. Not for arguments of indirect draws, whose elements are all in use.
@rewrite("buffers longer than needed", "rsm", "ssvp", "features")
def longer(pipeline):
    own_names(pipeline)
    for name, buffer in pipeline.spec["buffers"].items():
        counted = any(f"{name}_count" in text for text in pipeline.bodies.values())
        if not counted and all(name != entry.get("indirect") for entry in pipeline.passes()):
            buffer["count"] = f"({buffer['count']}) + 5"
    pipeline.longer = True


# A pass that writes a resource anew in every frame does not see the content of the last frame.
@rewrite("history that nobody looks at", "rsm", "ssvp", "features", "mips")
def more_history(pipeline):
    for resource in list(pipeline.spec["buffers"].values()) + list(pipeline.spec["images"].values()):
        resource["history"] = True


# Texel accesses and targets use the largest mip; the other mips do not matter.
@rewrite("mips that nobody looks at", "rsm", "ssvp", "features")
def more_mips(pipeline):
    for name, image in pipeline.spec["images"].items():
        if image["size"] != "frame" and "frame" not in str(image["size"]) and not is_filtered(pipeline, name):
            image["mips"] = 3


# An unused channel changes nothing in the others, which keep their type.
@rewrite("formats with more channels", "features", "ssvp")
def wider_formats(pipeline):
    wide = {"r32f": "rgba32f", "r32ui": "rg32ui"}
    for image in pipeline.spec["images"].values():
        image["format"] = wide.get(image["format"], image["format"])
    pipeline.wider = True


# Interleaved shading runs in place, or on sub-images that another pass gathers: a pixel sees the same VPLs.
@rewrite("shaded on split images and gathered", "ssvp")
def split_and_gather(pipeline):
    body_per_pass(pipeline)
    images, passes = pipeline.spec["images"], pipeline.passes()
    shade = next(entry for entry in passes if entry["name"] == "shade")
    moved = {name: f"split_{name}" for name in ("gbuffer_position", "gbuffer_normal", "irradiance")}
    for old, new in moved.items():
        images[new] = dict(images[old])
        replace_access(shade, old, new)
    text = replace_words(pipeline.bodies[shade["shader"]], moved)
    text = re.sub(r"    if \(all\(equal\(p / pattern_tile.*\n    ", "", text) # every pixel of a split image is one of the class
    pipeline.bodies[shade["shader"]] = text.replace("interleave_pixel()", "interleave_split()")
    guard = "    ivec2 p = invocation().xy, size = irradiance_size(), q = pattern_split(p, size);\n" \
            "    if (any(greaterThanEqual(p, size)))\n        return;\n"
    pipeline.bodies["split.glsl"] = "void main()\n{\n" + guard.replace("irradiance", "gbuffer_position") + \
        "    split_gbuffer_position_store(q, gbuffer_position(p));\n" \
        "    split_gbuffer_normal_store(q, gbuffer_normal(p));\n}\n"
    pipeline.bodies["gather.glsl"] = "void main()\n{\n" + guard + \
        "    irradiance_store(p, split_irradiance(q));\n}\n"
    same = {"when": shade["when"], "uses": ["pattern"]}
    at = passes.index(shade)
    passes.insert(at + 1, {"name": "gather", "dispatch": "irradiance", "reads": ["split_irradiance"],
                           "writes": ["irradiance"], "shader": "gather.glsl", **same})
    passes.insert(at, {"name": "split", "dispatch": "gbuffer_position",
                       "reads": ["gbuffer_position", "gbuffer_normal"],
                       "writes": ["split_gbuffer_position", "split_gbuffer_normal"], "shader": "split.glsl", **same})
    pipeline.pass_names["shade"] = "gather"


# A copy equals its original: later passes read a copy of each resource that a single pass makes.
@rewrite("copies handed on in place of the originals", "rsm", "ssvp", "features")
def copies(pipeline):
    body_per_pass(pipeline)
    output, passes = pipeline.spec["output"].values(), []
    renamed = {}
    for entry in pipeline.passes():
        words = {name: renamed[name] for name in names_of(entry.get("reads")) if name in renamed}
        for old, new in words.items():
            replace_access(entry, old, new)
        pipeline.bodies[entry["shader"]] = replace_words(pipeline.bodies[entry["shader"]], words)
        passes.append(entry)
        for name in names_of(entry.get("writes")):
            makers = [other for other in pipeline.passes() if name in changes(other)]
            image = pipeline.spec["images"].get(name, {})
            if len(makers) > 1 or name in output or image.get("format") == "d32f" or any(
                    name in (other.get("indirect"), other.get("indices")) for other in pipeline.passes()):
                continue
            renamed[name] = f"{name}_copy"
            passes.append(copy_pass(pipeline, name))
    pipeline.spec["passes"] = passes


def copy_pass(pipeline, name):
    image = pipeline.spec["images"].get(name)
    body = f"copy_{name}.glsl"
    if image:
        pipeline.spec["images"][f"{name}_copy"] = dict(image)
        position = "invocation()" if "layers" in image else "invocation().xy"
        guard = f"any(greaterThanEqual(invocation().xy, {name}_size()))"
        work = f"{name}_copy_store({position}, {name}({position}));"
        size = ["frame.width", "frame.height"] if image["size"] == "frame" else list(image["size"])
        size += [image["layers"]] if "layers" in image else []
    else:
        buffer = pipeline.spec["buffers"][name]
        pipeline.spec["buffers"][f"{name}_copy"] = dict(buffer)
        guard = f"invocation().x >= {name}_count"
        work = f"{name}_copy[invocation().x] = {name}[invocation().x];"
        size = buffer["count"]
    pipeline.bodies[body] = f"void main()\n{{\n    if ({guard})\n        return;\n    {work}\n}}\n"
    return {"name": f"copy_{name}", "dispatch": size, "reads": [name], "writes": [f"{name}_copy"], "shader": body}


# Passes already run after those that are listed before them.
@rewrite("order said by `after` too", "features", "ssvp", "rsm", "mips")
def redundant_after(pipeline):
    for i, entry in enumerate(pipeline.passes()):
        entry["after"] = [earlier["name"] for earlier in pipeline.passes()[:i]]
    pipeline.same_output = True


# A condition that always holds changes nothing.
@rewrite("every pass under a condition that holds", "rsm", "ssvp", "features", "mips")
def redundant_when(pipeline):
    pipeline.spec["params"]["always"] = {"value": 3, "live": True}
    for entry in pipeline.passes():
        entry["when"] = f"always == 3 && ({entry.get('when', 'true')})"


# The metric by its formula in the reference: position * |pa - pb| / scale + normal * (1 - max(na.nb, 0)), with the length of metric.glsl.
@rewrite("metrics written out in the bodies", "ssvp", "features")
def metrics_by_hand(pipeline):
    body_per_pass(pipeline)
    for name, metric in pipeline.spec.pop("metrics").items():
        position, normal = (weight if isinstance(weight, str) else float(weight)  # a parameter's name, or a number
                            for weight in (metric["position"], metric["normal"]))
        scale = metric.get("scale", "scene_radius")
        formula = (f"float {name}(vec3 pa, vec3 na, vec3 pb, vec3 nb)\n{{\n"
                   "    float square = approximate_max(dot(pa - pb, pa - pb), 1.17549435e-38);\n"
                   "    float r = approximate_root_estimate(square);\n"
                   "    float apart = square * r + square * r * (0.5 * (1.0 - square * r * r));\n"
                   f"    return {position} * approximate_reciprocal("
                   f"{'frame.scene_radius' if scale == 'scene_radius' else float(scale)}) * apart + "
                   f"{normal} * (1.0 - max(dot(na, nb), 0.0));\n}}\n")
        for entry in pipeline.passes():
            if name in entry.get("uses", []):
                entry["uses"].remove(name)
                pipeline.bodies[entry["shader"]] = formula + pipeline.bodies[entry["shader"]]


# ---- Rewrites of the text alone ----

# The path of a body does not matter.
@rewrite("bodies moved to other folders", "rsm", "ssvp", "features", "mips")
def move_bodies(pipeline):
    pipeline.bodies = {os.path.join("far away/from here", path): text for path, text in pipeline.bodies.items()}
    for entry in pipeline.passes():
        entry["shader"] = os.path.join("far away/from here", entry["shader"])


# An include equals its text.
@rewrite("includes pasted in", "ssvp", "rsm")
def includes_pasted(pipeline):
    body_per_pass(pipeline)


# Comments and white space have no meaning, even where they look like code.
@rewrite("bodies full of comments, with other line ends", "rsm", "ssvp", "features", "mips")
def comments_in_bodies(pipeline):
    nothing = '/* } for (Vpl v : nothing) { vpls[0]; "*/'

    def disturb(text):
        text = re.sub(r"/\*.*?\*/", lambda comment: "\n" * comment.group().count("\n") + " ", text, flags=re.S)
        gaps = r" (?=\S)|\b(?=[(\[])|(?<=\.)(?=[a-z])"   # before words, before brackets, behind points
        lines = [line if line.lstrip().startswith("#") else
                 re.sub(gaps, f" {nothing}\t", line.split("//")[0]) + " // \\ labels[0] = 1; } #endif"
                 for line in text.splitlines()]
        return "\r\n".join(lines) + "\r\n"
    edit_bodies(pipeline, lambda text: disturb(text))


# Two specs that parse to the same tree give the same files.
@rewrite("spec written as JSON", "rsm", "ssvp", "features", "mips")
def as_json(pipeline):
    pipeline.text = json.dumps(pipeline.spec, indent=3)
    pipeline.same_output = True


class Anchors(yaml.SafeDumper):
    """Block style with strings in quotes, and an anchor for every node that occurs twice."""

    def represent_quoted(self, text):
        return self.represent_scalar("tag:yaml.org,2002:str", text, style='"')


Anchors.add_representer(str, Anchors.represent_quoted)


@rewrite("spec written with anchors, quotes, comments and other key order", "features", "ssvp", "rsm", "mips")
def other_yaml(pipeline):
    known = {}

    def share(node):
        if isinstance(node, dict):
            node = {key: share(value) for key, value in node.items()}
        elif isinstance(node, list):
            node = [share(value) for value in node]
        else:
            return node
        return known.setdefault(repr(node), node)

    spec = dict(reversed(pipeline.spec.items()))   # the order of sections has no meaning
    spec["passes"] = [dict(reversed(entry.items())) for entry in spec["passes"]]
    text = yaml.dump(share(spec), Dumper=Anchors, sort_keys=False, width=10000, indent=3)
    lines = [line + ("   # : { [" if re.search(r"[\w\]]$", line) else "") for line in text.splitlines()]
    pipeline.text = "%YAML 1.2\n---\n# {\n" + "\n\n".join(lines) + "\n...\n"
    pipeline.same_output = True


# Rewrites that a short run applies together, one after the other. They change different things: none undoes another, or
# replaces the part that another changes.
TOGETHER = (
    ("rsm", (reorder_passes, longer, other_workgroups, inline_constants, move_bodies, comments_in_bodies)),
    ("rsm", (pad_structs, bake_live, more_mips)),
    ("rsm", (bake_uniform, more_history)),
    ("ssvp", (declarations_backwards, equal_expressions, ranges_uniform)),
    ("ssvp", (includes_pasted, make_live, ranges_buffer)),
    ("ssvp", (names_in_bodies, make_uniform, plan_for_gpu)),
    ("ssvp", (metrics_by_hand, ranges_shared)),
    ("ssvp", (merge_buffers, split_and_gather)),
    ("features", (passes_backwards, dispatch_groups, wider_formats)),
    ("features", (fields_backwards, make_layered)),
)


# ---- Controls: changes that must be noticed ----

def other_metric(pipeline):
    pipeline.spec["metrics"]["vpl_distance"]["normal"] = 4.0


def last_bit(pipeline):
    body_per_pass(pipeline)
    pipeline.bodies["of_mark.glsl"] = pipeline.bodies["of_mark.glsl"].replace(
        "+ uint(i);", "+ (i == 5 ? uint(i) ^ 1u : uint(i));")


def no_change(pipeline):
    pipeline.spec = copy.deepcopy(pipeline.spec)


CONTROLS = {
    "a metric's weight": (other_metric, "ssvp"),
    "the last bit of one element": (last_bit, "features"),
    "nothing": (no_change, "rsm"),
}


def apply(functions, path, settings):
    """The rewritten pipeline of a file; None if a rewrite changed nothing in the generator's input."""
    pipeline = Pipeline(path)
    pipeline.settings = dict(settings)
    if not {values_set_in_spec, overrides_backwards, as_json, other_yaml} & set(functions):
        values_in_spec(pipeline)
    for function in functions:
        before = pipeline.visible()
        function(pipeline)
        if pipeline.visible() == before:
            return None
    return pipeline
