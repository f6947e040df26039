"""Random pipelines: `--check` says yes exactly when they build, and every resource has the same bits on every side. Prints TAP.

    random_pipelines.py [--seed N] [--pipelines N] [--only K] [--all-sides] BUILD SIDE...

Pipeline K of a seed is always the same. Without --all-sides, each pipeline leaves out one of the sides behind the first, in turn.
Bodies hash what they read and store numbers of the hash: integers, and floats by exact arithmetic. A body indexes within the sizes
that the generator gives it, so a mutated spec that passes the check has the same bits, too. One process renders all; sides are
compared after each frame."""
import argparse
import copy
import json
import os
import random
import shutil
import subprocess
import sys
import warnings

import bodies

FRAMES = 3
SCALARS = ("uint", "int", "float")
TYPES = SCALARS + ("uvec2", "ivec2", "vec2", "uvec3", "ivec3", "vec3", "uvec4", "ivec4", "vec4")
FIELDS = TYPES + ("mat4",)
FLOATS = ("r8", "rg8", "rgba8", "r16f", "rg16f", "rgba16f", "r32f", "rg32f", "rgba32f", "r16", "rg16", "rgba16", "r16_snorm",
          "rg16_snorm", "rgba16_snorm", "r11g11b10f", "rgb10a2")
INTEGERS = ("r32ui", "rg32ui", "rgba32ui", "r8ui", "rg8ui", "rgba8ui", "r16ui", "rg16ui", "rgba16ui", "r32i", "rg32i", "rgba32i",
            "r8i", "rg8i", "rgba8i", "r16i", "rg16i", "rgba16i")
HEAD = """uint mixed(uint h, uint v)
{
    h = (h ^ v) * 0x9e3779b1u;
    return h ^ h >> 15;
}
uint part(uint h, uint number)
{
    return (h + number) * 0x85ebca6bu;
}
float near_one(uint h)
{
    return float(h >> 16) * (1.0 / 65536.0) + 0.25;
}
"""


def prefix(image):
    """Of vec4 and image2D for its format."""
    return "u" if image["format"].endswith("ui") else "i" if image["format"][-1] == "i" else ""


def components(kind):
    return int(kind[-1]) if kind[-1].isdigit() else 1


def scalar(kind):
    return {"u": "uint", "i": "int", "v": "float", "f": "float", "b": "bool", "m": "float"}[kind[0]]


def hash_value(kind, value):
    """Statements that mix a value into h."""
    if kind == "mat4":
        return hash_value("vec4", f"({value}[0] + 2.0 * {value}[1])") + hash_value("vec4", f"({value}[2] + 2.0 * {value}[3])")
    code = {"uint": "{}", "int": "uint({})", "float": "floatBitsToUint({})", "bool": "uint({})"}[scalar(kind)]
    parts = [value] if components(kind) == 1 else [f"{value}.{'xyzw'[i]}" for i in range(components(kind))]
    return f"h = mixed(h, {' ^ '.join(f'{code.format(part)} * {2 * i + 1}u' for i, part in enumerate(parts))}); "


def make_value(kind, seed):
    """An expression of the type from `seed`, an expression of uint."""
    if kind == "mat4":
        return f"mat4({', '.join(make_value('vec4', f'part({seed}, {i + 4}u)') for i in range(4))})"
    one = {"uint": "{}", "int": "int({})", "float": "near_one({})", "bool": "({} & 1u) == 1u"}[scalar(kind)]
    parts = [one.format(f"part({seed}, {i}u)") for i in range(components(kind))]
    return parts[0] if len(parts) == 1 else f"{kind}({', '.join(parts)})"


class Maker:
    """Makes one spec and its bodies. written: what later passes may read, {(name, mip)}. names: of the passes."""

    def __init__(self, source):
        self.source = source
        self.spec = {"pipeline": "random", "params": {}, "constants": {}, "structs": {}, "buffers": {}, "images": {},
                     "samplers": {}, "groups": {}, "passes": []}
        self.bodies, self.written, self.stored, self.names, self.results, self.count = {}, set(), set(), [], [], 0

    def chance(self, share):
        return self.source.random() < share

    def pick(self, choices):
        return self.source.choice(list(choices))

    # Declarations.
    def number(self, low, high):
        """An expression of about this size: a literal, a parameter, a constant, or something of these."""
        value = self.source.randint(low, high)
        params = [name for name, param in self.spec["params"].items() if name[0] == "n"]
        roll = self.source.random()
        if roll < 0.5 or not params:
            return value
        name = self.pick(params)
        if roll < 0.7:
            return f"{name} + {value}"
        if roll < 0.8:
            self.spec["constants"][f"k{len(self.spec['constants'])}"] = f"max({value}, 2 * {name})"
            return f"k{len(self.spec['constants']) - 1}"
        return self.pick([f"frame.width / {self.pick([1, 2, 3])} + 1", f"ceil_div(frame.height * {name}, 4) + 1"])

    def params(self):
        for i in range(self.source.randint(1, 3)):
            self.spec["params"][f"n{i}"] = {"value": self.source.randint(1, 9), "min": 1, "max": 64} | self.pick([{}, {}, {"uniform": True}])
        for i in range(self.source.randint(0, 3)):
            value = self.pick([self.source.randint(0, 9), self.source.randint(0, 64) / 4, True, [1, 2, 3], [0.5, 2.5]])
            self.spec["params"][f"p{i}"] = {"value": value} | self.pick([{}, {"uniform": True}, {"live": True}])
        for i in range(self.source.randint(0, 2)):
            self.spec["params"][f"on{i}"] = {"value": self.chance(0.7)} | self.pick([{}, {"live": True}])

    def resources(self):
        for i in range(self.source.randint(0, 2)):
            fields = {}
            for k in range(self.source.randint(1, 5)):
                fields[f"f{k}"] = self.pick(FIELDS) + self.pick(["", "", "", f"[{self.source.randint(1, 3)}]"])
            self.spec["structs"][f"S{i}"] = fields
        for i in range(self.source.randint(2, 5)):
            kind = self.pick(list(self.spec["structs"]) + ["vec4", "uvec4"] if self.chance(0.6) else TYPES)
            self.spec["buffers"][f"b{i}"] = {"of": kind, "count": self.number(1, 80)} | self.lasting()
        for i in range(self.source.randint(2, 5)):
            self.spec["images"][f"i{i}"] = self.image()
        if self.chance(0.4):
            like = self.pick([image for image in self.spec["images"].values() if not layers_of(image)] or [{"size": "frame"}])
            self.spec["images"]["depth"] = {"format": "d32f", "size": like["size"]} | self.lasting()
        self.spec["samplers"]["soft"] = {"kind": "filter", "filter": self.pick(["nearest", "linear"]),
                                         "mip_filter": self.pick(["nearest", "linear"]),
                                         "wrap": self.pick(["clamp", "repeat", "mirror", "border"])}
        if self.chance(0.3):
            self.spec["structs"]["Groups"] = {"x": "uint", "y": "uint", "z": "uint"}
            self.spec["buffers"]["groups"] = {"of": "Groups", "count": 1}
            made = {"name": "prepare", "dispatch": 1, "writes": ["groups"], "shader": "prepare.glsl"}
            self.put(made, "void main()\n{\n    if (invocation().x == 0)\n        groups[0] = Groups(3u, 1u, 2u);\n}\n")
            self.stores([("groups", 0)])

    def lasting(self):
        return self.pick([{}, {}, {}, {"history": True}, {"keep": True}])

    def image(self):
        image = {"format": self.pick(FLOATS + INTEGERS), "size": "frame" if self.chance(0.4) else [self.number(1, 20), self.number(1, 12)]}
        roll = self.source.random()
        if roll < 0.1:
            image["size"] = [self.source.randint(1, 9), self.source.randint(1, 9), self.source.randint(1, 5)]
        elif roll < 0.2:
            image |= {"size": [self.number(4, 4)] * 2, "cube": True} | self.pick([{}, {"layers": 12}])
        elif roll < 0.4:
            image["layers"] = self.pick([1, 2, 3, "n0"])
        if image["size"] != "frame" and roll > 0.1 and self.chance(0.4):
            image |= {"size": [self.source.randint(4, 20), self.source.randint(4, 20)], "mips": self.source.randint(2, 3)}
            image |= {"size": [image["size"][0]] * 2} if image.get("cube") else {}
        if self.chance(0.2):
            image["clear"] = self.pick([1, 0, [1, 0, 1, 0][:max(1, channels(image))]])
        return image | self.lasting()

    # Bodies.
    def texel(self, name, image, word):
        """Statements that mix a texel into h."""
        kind = "float" if image["format"] == "d32f" else f"{prefix(image)}vec4"
        where = "ivec2(h >> 3 & 31u, h >> 9 & 15u)"
        if image.get("layer") is None and (layers := layers_of(image)):
            size = f"{word}_size()"
            layers = f"{size}.z" if len(image["size"]) == 3 else layers
            where = f"ivec3(min({where}, {size}.xy - 1), min(int(h >> 14 & 7u), {layers} - 1))"
        else:
            where = f"min({where}, {word}_size() - 1)"
        return f"    {{ {kind} v = {word}({where}); {hash_value(kind, 'v')}}}\n"

    def element(self, kind, value):
        fields = self.spec["structs"].get(kind)
        if not fields:
            return hash_value(kind, value)
        text = ""
        for name, field in fields.items():
            kind, _, count = field.rstrip("]").partition("[")
            text += "".join(hash_value(kind, f"{value}.{name}[{i}]") for i in range(int(count))) if count else \
                hash_value(kind, f"{value}.{name}")
        return text

    def store_element(self, kind, value, seed):
        fields = self.spec["structs"].get(kind)
        if not fields:
            return f"{value} = {make_value(kind, seed)}; "
        text = ""
        for name, field in fields.items():
            kind, _, count = field.rstrip("]").partition("[")
            for i in range(int(count or 1)):
                text += f"{value}.{name}{f'[{i}]' if count else ''} = {make_value(kind, f'part({seed}, {i + 7}u)')}; "
        return text

    def readable(self, without):
        """{NAME: [mip]} of what was written or has history."""
        found = {}
        for name, mip in sorted(self.written):
            if name not in without:
                found.setdefault(name, []).append(mip)
        return found

    def reads(self, without, fragment=False):
        """The key `reads`, and statements of a body that mix what it reads into h."""
        found, text, keys = self.readable(without), "", []
        for name in self.source.sample(sorted(found), min(len(found), self.source.randint(0, 3))):
            if name in self.spec["buffers"]:
                keys.append(name)
                mix = self.element(self.spec["buffers"][name]["of"], f"{name}[at]")
                text += f"    {{ int at = min(int(h >> 4 & 63u), {name}_count - 1); {mix}}}\n"
                continue
            image, mip = dict(self.spec["images"][name]), self.pick(found[name])
            access, word = {"name": name}, name
            if "mips" in image:
                access |= {"mip": mip, "as": f"m_{name}"}
                word = f"m_{name}"
            if isinstance(layers := layers_of(image), int) and layers and len(image["size"]) != 3 and self.chance(0.3):
                access["layer"] = image["layer"] = self.source.randrange(layers)
            layered = image.get("layer") is None and layers_of(image)
            flat = not image.get("cube") and (image["size"] == "frame" or len(image["size"]) == 2)
            if not prefix(image) and image["format"] != "d32f" and (flat or not layered) and self.chance(0.3):
                access["sampler"] = "soft"
                where = "vec3(near_one(h), near_one(h >> 3), float(h >> 9 & 1u))" if layered else "vec2(near_one(h), near_one(h >> 3))"
                call = f"{word}_sample({where})"
                if "mip" in access and len(found[name]) == image["mips"] and "layer" not in access:
                    del access["mip"]
                    call = f"{word}_sample_lod({where}, 2.0 * near_one(h >> 5) - 0.25)"
                text += f"    {{ vec4 v = {call}; {hash_value('vec4', 'v')}}}\n"
            else:
                text += self.texel(name, image, word)
            keys.append(access if len(access) > 1 or self.chance(0.3) else name)
        return keys, text

    def values(self, text="    uint h = {}u;\n"):
        """Statements that begin h: with parameters, constants and the frame."""
        text = text.format(self.source.randint(1, 10**9))
        for name, param in self.spec["params"].items():
            if self.chance(0.5):
                value = param["value"]
                kind = "bool" if isinstance(value, bool) else "int" if isinstance(value, int) else "float" if isinstance(value, float) \
                    else f"{'ivec' if isinstance(value[0], int) else 'vec'}{len(value)}"
                text += f"    {hash_value(kind, name)}\n"
        for name in self.spec["constants"]:
            text += f"    h = mixed(h, uint({name}));\n" if self.chance(0.3) else ""
        if self.chance(0.2):
            exact = ("sqrt(near_one(h))", "near_one(h) / near_one(h >> 3)", "dot(vec2(near_one(h)), vec2(3.0, 0.7))")
            text += f"    {hash_value('float', self.pick(exact))}\n"
        return text + ("    h = mixed(h, frame.index);\n" if self.chance(0.3) else "")

    def new_pass(self, **keys):
        self.count += 1
        made = {"name": f"pass{self.count}", **keys, "shader": f"pass{self.count}.glsl"}
        switches = [name for name in self.spec["params"] if name.startswith("on")]
        if switches and self.names and self.chance(0.25):
            made["when"] = self.pick(switches)
        return made

    def targets(self, count):
        """Resources to write, with a mip: {name: mip}."""
        names = self.source.sample(sorted({*self.spec["buffers"], *self.spec["images"]} - {"depth", "groups"}), count)
        return {name: self.source.randrange(self.spec["images"].get(name, {}).get("mips", 1)) for name in names}

    def put(self, made, text, passes=()):
        """Adds a pass and its body."""
        self.bodies[made["shader"]] = text
        if any(isinstance(access, dict) for access in made.get("writes", [])) and not self.spec["params"].get(made.get("when"), {}).get("live"):
            made.pop("when", None)  # for good, which leaves a mip without content
        if self.names and self.chance(0.1):
            made["after"] = [self.pick(self.names)]
        self.names += passes or [made["name"]]
        self.spec["passes"].append({key: value for key, value in made.items() if value not in ([], {})})

    def access(self, name, mip):
        image = self.spec["images"].get(name, {})
        return {"name": name, "mip": mip} if "mips" in image else name

    def stores(self, places):
        for place in places:
            self.written.add(place)
            self.stored.add(place)

    def add_dispatch(self):
        targets = self.targets(self.source.randint(1, 3))
        updates = {name: self.chance(0.5) for name, mip in targets.items() if (name, mip) in self.written}
        reads, text = self.reads(targets)
        extent = self.extent(targets)
        made = self.new_pass(**extent, reads=reads + (["groups"] if "indirect" in extent and "groups" not in reads else []),
                             writes=[self.access(name, mip) for name, mip in targets.items() if name not in updates],
                             updates=[self.access(name, mip) for name, mip in targets.items() if name in updates])
        text = self.values() + "    ivec3 size = dispatch_size(), me = invocation();\n" \
            "    int first = me.x + size.x * (me.y + size.y * me.z), step = size.x * size.y * size.z;\n" \
            "    bool inside = all(lessThan(me, size));\n    h = mixed(h, uint(first));\n" + text
        if self.chance(0.2):
            made["defines"] = {"SHIFT": self.pick([self.source.randint(1, 9), "n0", "2 * n0 - 1"])}
            text += "    h = mixed(h, uint(SHIFT));\n#if SHIFT > 4\n    h += 3u;\n#endif\n"
        text += self.add_ranges(made)
        for name, mip in targets.items():
            self.stores([(name, mip)])
            text += self.store(name, updates.get(name, False), made.get("dispatch") == name and mip == 0)
        self.put(made, HEAD + f"void main()\n{{\n{text}}}\n")

    def extent(self, targets):
        """The keys of a dispatch."""
        name = next(iter(targets))
        roll = self.source.random()
        if roll < 0.6 and name in self.spec["images"]:
            return {"dispatch": name} | self.pick([{}, {"local": [4, 4]}, {"local": [16, 2, 1]}])
        if "groups" in self.spec["buffers"] and roll < 0.65:
            return {"indirect": "groups", "local": self.pick([8, [4, 2, 1]])}
        if roll < 0.7:
            return {"dispatch": self.number(1, 100)} | self.pick([{}, {"local": 32}, {"local": [8, 2, 2]}])
        if roll < 0.9:
            return {"dispatch": [self.number(1, 12), self.number(1, 9)] + self.pick([[], [2]])}
        return {"groups": self.source.randint(1, 4)} | self.pick([{}, {"local": 16}])

    def add_ranges(self, made):
        """Loops over ranges of the buffers that the pass reads, or of one more."""
        text = ""
        free = [name for name, _ in self.written if name in self.spec["buffers"] and not uses(made, name)]
        if free and self.chance(0.3):
            made["reads"].append(self.pick(sorted(free)))
        for name in made["reads"]:
            if not isinstance(name, str) or name not in self.spec["buffers"] or name == "groups" or not self.chance(0.6):
                continue
            kind = self.spec["buffers"][name]["of"]
            count = self.pick([1, 2, 5, 40 if self.chance(0.2) else 9, "n0"])
            storages = ["auto", "auto", "shared", "buffer"] + (["uniform"] if kind in ("vec4", "uvec4", "ivec4") else [])
            made.setdefault("ranges", {})[f"r_{name}"] = {
                "of": name, "count": count, "storage": self.pick(storages),
                "loop": self.pick(["auto", "unroll", "roll"])}
            if not isinstance(self.spec["buffers"][name]["count"], int) or count == "n0" or count > self.spec["buffers"][name]["count"]:
                self.spec["buffers"][name]["count"] = self.source.randint(64, 100)
            if self.chance(0.4):
                made["ranges"][f"r_{name}"]["first"] = f"{name}_count - {64 if count == 'n0' else count}"
            text += f"    for ({kind} e : r_{name}) {{ {self.element(kind, 'e')}}}\n"
        return text

    def store(self, name, update, direct):
        """A loop that stores to every element or texel."""
        if name in self.spec["buffers"]:
            kind = self.spec["buffers"][name]["of"]
            old = self.element(kind, f"{name}[i]").replace("h = mixed(h", "g = mixed(g") if update else ""
            return f"    for (int i = first; inside && i < {name}_count; i += step) {{ uint g = mixed(h, uint(i)); {old}" \
                f"{self.store_element(kind, f'{name}[i]', 'g')}}}\n"
        image = self.spec["images"][name]
        layers = layers_of(image)
        count = f"{name}_size().x * {name}_size().y"
        place = f"ivec2(i % {name}_size().x, i / {name}_size().x)"
        if layers:
            layers = f"{name}_size().z" if len(image["size"]) == 3 else layers
            place = f"ivec3(i % {name}_size().x, i / {name}_size().x % {name}_size().y, i / ({count}))"
            count = f"{count} * {layers}"
        kind = f"{prefix(image)}vec4"
        old = f"{kind} v = {name}({place}); {hash_value(kind, 'v')}".replace("h = mixed(h", "g = mixed(g") if update else ""
        if direct and not layers:
            old = old.replace(place, "me.xy")
            return f"    if (all(lessThan(me.xy, {name}_size()))) {{ uint g = h; {old}{name}_store(me.xy, {make_value(kind, 'g')}); }}\n"
        return f"    for (int i = first; inside && i < {count}; i += step) {{ uint g = mixed(h, uint(i)); {old}" \
            f"{name}_store({place}, {make_value(kind, 'g')}); }}\n"

    def add_draw(self, fullscreen):
        names = [name for name, image in self.spec["images"].items() if not layers_of(image) and name != "depth"]
        if not names:
            return
        image = self.spec["images"][first := self.pick(names)]
        mip = self.source.randrange(image.get("mips", 1))
        names = [name for name in names if name == first or (mip == 0 and self.spec["images"][name]["size"] == image["size"])]
        names = self.source.sample(names, self.source.randint(1, min(4, len(names))))
        color = list(names)
        if mip == 0 and self.spec["images"].get("depth", {}).get("size") == image["size"] and self.chance(0.6):
            names.append("depth")
        targets = {name: mip for name in names}
        updates = [name for name in names if (name, mip) in self.written]
        reads, text = self.reads(targets)
        made = self.new_pass(draw="fullscreen" if fullscreen else {"vertices": 6, "instances": self.pick([1, 3, "n0"])}, reads=reads,
                             writes=[self.access(name, mip) for name in names if name not in updates],
                             updates=[self.access(name, mip) for name in names if name in updates])
        text = self.values() + "    h = mixed(h, uint(gl_FragCoord.x) + 4096u * uint(gl_FragCoord.y));\n" + \
            ("" if fullscreen else "    h = mixed(h, number);\n") + text
        self.stores(targets.items())
        text += "".join(f"    {name} = {make_value(prefix(self.spec['images'][name]) + 'vec4', f'mixed(h, {i}u)')};\n"
                        for i, name in enumerate(color))
        if fullscreen:
            if self.chance(0.2):
                made["scissor"] = [1, 0, self.source.randint(1, 9), 4]
            self.put(made, HEAD + f"void main()\n{{\n{text}}}\n")
            return
        if self.chance(0.4) and all(self.spec["images"][name]["format"].endswith(("32f", "i")) for name in color):
            made["blend"] = "max" if not any(prefix(self.spec["images"][name]) for name in color) else "off"
        self.put(made, HEAD + self.rectangles(image, mip).replace("@", text))

    def rectangles(self, image, mip):
        """A body whose vertices are corners of texels, so that no edge meets the centre of a texel."""
        for axis in range(2):
            size = f"frame.{('width', 'height')[axis]}" if image["size"] == "frame" else image["size"][axis]
            self.spec["constants"][f"{'wh'[axis]}{self.count}"] = f"({size}) >> {mip}"
        return "#ifdef VERTEX\nlayout(location = 0) flat out uint number;\nvoid main()\n{\n" \
            "    const ivec2 corners[6] = ivec2[](ivec2(0), ivec2(1, 0), ivec2(0, 1), ivec2(0, 1), ivec2(1, 0), ivec2(1));\n" \
            "    number = uint(gl_InstanceIndex);\n" \
            "    vec2 texel = vec2(ivec2(gl_InstanceIndex * 3, gl_InstanceIndex * 5) % 13 + corners[gl_VertexIndex] * 7);\n" \
            f"    gl_Position = vec4(texel / vec2(w{self.count}, h{self.count}) * 2.0 - 1.0, 0.25 * float(gl_InstanceIndex % 4), 1.0);\n}}\n#else\n" \
            "layout(location = 0) flat in uint number;\nvoid main()\n{\n@}\n#endif\n"

    def add_group(self):
        """A group of two passes, used twice on buffers of one type."""
        kinds = {}
        for name, _ in sorted(self.written):
            if name in self.spec["buffers"]:
                kinds.setdefault(self.spec["buffers"][name]["of"], []).append(name)
        if not kinds or "g" in self.spec["groups"]:
            return
        kind = self.pick(sorted(kinds))
        first = {"name": "take", "dispatch": "size", "reads": ["list"], "writes": ["some"], "shader": "take.glsl"}
        second = {"name": "turn", "dispatch": 16, "reads": ["some"], "writes": ["result"], "shader": "turn.glsl"}
        self.spec["groups"]["g"] = {"args": ["list", "size"], "constants": {"half_size": "size / 2 + 1"},
                                    "buffers": {"some": {"of": kind, "count": "half_size"}, "result": {"of": "uint", "count": 16}},
                                    "passes": [first, second]}
        self.bodies["take.glsl"] = HEAD + "void main()\n{\n    int i = invocation().x;\n    uint h = uint(size);\n" \
            f"    if (i < some_count) {{ {self.element(kind, 'list[i % list_count]')}{self.store_element(kind, 'some[i]', 'h')}}}\n}}\n"
        self.bodies["turn.glsl"] = HEAD + "void main()\n{\n    uint h = uint(half_size), i = uint(invocation().x);\n" \
            f"    {self.element(kind, 'some[int(i) % some_count]')}\n    if (i < 16u)\n        result[i] = mixed(h, i);\n}}\n"
        use = {"group": "g", "as": "one", "with": {"list": self.pick(kinds[kind]), "size": self.number(2, 30)}}
        again = {"group": "g", "as": "more", "repeat": "k in 0 .. 1", "with": {"list": self.pick(kinds[kind]), "size": "3 * (k + 1)"}}
        self.spec["passes"] += [use, again]
        self.results = [f"{name}.result" for name in ("one", "more.0", "more.1")]

    def add_repeat(self):
        """A pass for each mip, from the one before."""
        names = [name for name, image in self.spec["images"].items()
                 if "mips" in image and (name, 0) in self.written and not layers_of(image)]
        if not names:
            return
        name = self.pick(names)
        image = self.spec["images"][name]
        kind = f"{prefix(image)}vec4"
        if any((name, mip) in self.written for mip in range(1, image["mips"])):
            return
        made = self.new_pass(repeat=f"k in 1 .. {image['mips'] - 1}", dispatch=[image["size"][0], image["size"][1]],
                             reads=[{"name": name, "mip": "k - 1", "as": "finer"}], writes=[{"name": name, "mip": "k", "as": "coarser"}])
        text = "    ivec2 p = invocation().xy;\n    uint h = uint(k);\n" \
            f"    {kind} v = finer(min(2 * p, finer_size() - 1));\n    {hash_value(kind, 'v')}\n" \
            f"    if (all(lessThan(p, coarser_size())))\n        coarser_store(p, {make_value(kind, 'h')});\n"
        self.stores((name, mip) for mip in range(1, image["mips"]))
        self.put(made, HEAD + f"void main()\n{{\n{text}}}\n", [f"{made['name']}.{k}" for k in range(1, image["mips"])])

    def add_atomics(self):
        names = [name for name, image in self.spec["images"].items() if image["format"] in ("r32ui", "r32i") and (name, 0) in self.written
                 and not layers_of(image)]
        names += [name for name, buffer in self.spec["buffers"].items() if buffer["of"] in ("uint", "int") and (name, 0) in self.written]
        if not names:
            return
        name = self.pick(names)
        word, kind = self.pick(["Add", "Min", "Max", "Xor", "Or", "And"]), "int"
        if name in self.spec["buffers"]:
            kind = self.spec["buffers"][name]["of"]
            call = f"atomic{word}({name}[int(h >> 8) % {name}_count], {kind}(h))"
        else:
            kind = "uint" if prefix(self.spec["images"][name]) == "u" else "int"
            call = f"{name}_atomic{word}(ivec2(h >> 4 & 0xffffu, h >> 9 & 0xffffu) % {name}_size(), {kind}(h))"
        made = self.new_pass(dispatch=self.source.randint(1, 200), updates=[self.access(name, 0)])
        self.put(made, HEAD + f"void main()\n{{\n{self.values()}    h = mixed(h, uint(invocation().x));\n    {call};\n}}\n")

    def make(self):
        self.params()
        self.resources()
        for kind in ("buffers", "images"):
            for name, item in self.spec[kind].items():
                if item.get("history"):
                    self.written |= {(name, mip) for mip in range(item.get("mips", 1))}
        steps = [self.add_dispatch] * 4 + [lambda: self.add_draw(True), lambda: self.add_draw(False), self.add_group, self.add_repeat,
                                           self.add_atomics]
        self.add_dispatch()
        for _ in range(self.source.randint(1, 4)):
            self.pick(steps)()
        return {key: value for key, value in self.spec.items() if value or key == "passes"}, self.bodies


def channels(image):
    name = image["format"]
    return 3 if name == "r11g11b10f" else 4 if name.startswith("rgb") else 2 if name.startswith("rg") else 1


def layers_of(image):
    """Layers of an image or its depth; 0: neither."""
    if image["size"] != "frame" and len(image["size"]) == 3:
        return image["size"][2]
    return image.get("layers", 6 if image.get("cube") else 0)


def uses(made, name):
    return any(name in (access, isinstance(access, dict) and access["name"])
               for key in ("reads", "writes", "updates") for access in made[key])


# ---- Mutations ----------------------------------------------------------------------------------

def nodes(item, found):
    """All maps and lists of a spec."""
    if isinstance(item, (dict, list)) and item:
        found.append(item)
        for value in item.values() if isinstance(item, dict) else item:
            nodes(value, found)
    return found


def mutate(spec, source):
    """Changes one place of a spec, which may or may not stay valid."""
    place = source.choice(nodes({key: value for key, value in spec.items() if key not in ("pipeline", "samplers")}, []))
    key = source.choice(list(place) if isinstance(place, dict) else range(len(place)))
    old = place[key]
    others = [*spec["buffers"], *spec["images"]]
    if isinstance(old, bool):
        place[key] = not old
    elif isinstance(old, int):
        place[key] = source.choice([0, -1, old + 1, 2 * old, 4000])
    elif isinstance(old, str) and old in others:
        place[key] = source.choice(others)
    elif isinstance(old, str) and old in FLOATS + INTEGERS:
        place[key] = source.choice(FLOATS + INTEGERS + ("d32f",))
    elif isinstance(old, str) and old in TYPES:
        place[key] = source.choice(TYPES)
    elif isinstance(place, list) and len(place) > 1 and source.random() < 0.5:
        place[key], place[key - 1] = place[key - 1], old
    elif isinstance(place, dict) and key in ("reads", "updates", "writes") and source.random() < 0.5:
        place[source.choice(("reads", "updates", "writes"))] = place.pop(key)
    elif place is not spec:
        del place[key]


# ---- Tests --------------------------------------------------------------------------------------

def bits(array):
    """Its bytes without padding, which a copy may change."""
    return b"".join(bits(array[name]) for name in array.dtype.names) if array.dtype.names else array.tobytes()


class Pipeline:
    """A pipeline in a folder of its own."""

    def __init__(self, arguments, number):
        self.source = random.Random(f"{arguments.seed}/{number}")
        self.number = number
        self.build, self.sides = os.path.abspath(arguments.build), list(arguments.sides)
        if not arguments.all_sides and len(self.sides) > 2:
            del self.sides[1 + number // 3 % (len(self.sides) - 1)]
        self.folder = os.path.join(self.build, f"tests/random_pipelines/{arguments.seed}", str(number))
        self.path = os.path.join(self.folder, "spec.yaml")
        maker = Maker(self.source)
        self.spec, texts = maker.make()
        self.mutated = number % 3 == 2
        self.wanted = [] if self.mutated else [*sorted(maker.stored), *maker.results]
        if self.mutated:
            self.spec = copy.deepcopy(self.spec)  # one list may stand in two places
            mutate(self.spec, self.source)
        self.size = (self.source.randint(8, 70), self.source.randint(8, 40))
        os.makedirs(self.folder)
        for name, text in (texts | {"spec.yaml": json.dumps(self.spec, indent=1)}).items():
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write(text)

    def check(self):
        """The errors of --check, "": none."""
        done = bodies.limited([self.build + "/diptych-gen", self.path, "--check", "--cache", self.build + "/cache"], capture_output=True)
        if done.returncode not in (0, 1):
            raise bodies.Failure(f"--check ends with {done.returncode}\n{done.stderr}")
        return done.stderr if done.returncode else ""

    def frames(self, diptych, side, live, **sets):
        """What every resource holds behind its last writer, frame by frame: [{NAME or (NAME, MIP): array}]. live: values of live
        parameters for each frame."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with diptych.open(self.path, side, size=self.size, sets=sets) as pipeline:
                found, written = [], {name for entry in pipeline.description["passes"] for name in entry["writes"]}
                wanted = [item for item in self.wanted if (item if isinstance(item, str) else item[0]) in written]
                for values in live:
                    pipeline.set(**values)
                    found.append(pipeline.render(*wanted))
                return found

    def live(self):
        """Values of the live parameters for each frame."""
        params = [name for name, param in self.spec["params"].items() if isinstance(param, dict) and param.get("live")]
        switches = [name for name in params if isinstance(self.spec["params"][name].get("value"), bool)]
        return [{name: self.source.random() < 0.5 for name in switches if frame} for frame in range(FRAMES)]

    def test(self, diptych):
        """Reasons why the pipeline is not as it should be."""
        live, refused, results = self.live(), self.check(), {}
        if refused and not self.mutated:
            return [f"is refused\n{refused}"]
        keep = {f"{kind}.{name}.keep": True for kind in ("buffers", "images") for name in self.spec.get(kind, {})}
        for side, sets in [(side, {}) for side in self.sides] + ([] if refused or self.number % 2 else [(self.sides[-1], keep)]):
            label = side + (" with keep" if sets else "")
            few = self.mutated and side != self.sides[self.number % len(self.sides)]
            try:
                results[label] = self.frames(diptych, side, [] if few else live, **sets)
            except diptych.Error as error:
                if not refused and "the device does not support" not in str(error):
                    return [f"--check says yes, {label} says no\n{error}"]
        if refused:
            return [f"--check says no, {side} says yes\n{refused}" for side in results]
        good = [side for side in self.sides if side in results]
        return [] if self.mutated else self.differences(results) + (self.poisoned(good) if self.number % 10 == 0 else [])

    def poisoned(self, sides):
        """Reasons of the command line, which fills the memory of each side with another byte, and asks the validation layers."""
        try:
            bodies.run(self.build + "/diptych", "compare", "--spec", self.path, "--size", f"{self.size[0]}x{self.size[1]}", "--frames",
                       str(FRAMES), "--backend", ",".join(sides), "--debug")
        except bodies.Failure as failure:
            return [str(failure)]
        return []

    def differences(self, results):
        first, *others = results
        return [f"frame {frame}: {name} differs between {first} and {other}"
                for other in others for frame in range(FRAMES)
                for name, array in results[first][frame].items() if bits(array) != bits(results[other][frame][name])]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pipelines", type=int, default=100)
    parser.add_argument("--only", type=int)
    parser.add_argument("--all-sides", action="store_true")
    parser.add_argument("build")
    parser.add_argument("sides", nargs="+")
    arguments = parser.parse_args()
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    sys.path.insert(0, os.path.join(root, "app/python"))
    import diptych  # pylint: disable=import-outside-toplevel
    tap = bodies.Tap()
    print(f"# seed {arguments.seed}, {arguments.pipelines} pipelines", flush=True)
    shutil.rmtree(os.path.join(os.path.abspath(arguments.build), f"tests/random_pipelines/{arguments.seed}"), ignore_errors=True)
    reasons = []
    for number in range(arguments.pipelines) if arguments.only is None else [arguments.only]:
        pipeline = Pipeline(arguments, number)
        try:
            found = pipeline.test(diptych)
        except bodies.Failure as failure:
            found = [str(failure)]
        reasons += [f"{pipeline.path} at {pipeline.size[0]}x{pipeline.size[1]}: {reason}" for reason in found[:3]]
    tap.result(f"{arguments.pipelines} random pipelines have the same bits on {' '.join(arguments.sides)}", reasons[:20])
    tap.finish()


if __name__ == "__main__":
    main()
