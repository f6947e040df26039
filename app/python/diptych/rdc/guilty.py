"""The guilty pass alone, for compare.py: what alone.py took out of a capture becomes a spec by `diptych import`, which both of our
backends run. What they leave is held against what the program left: only a replay that shows its picture proves something."""
from __future__ import annotations

import json
import os
import re
import subprocess
from typing import Any, Callable

import numpy as np

from .differ import common
from .left import Unreadable, loaded, own
from .texels import NUMBERS, four

Json = dict[str, Any]
Done = subprocess.CompletedProcess[str]
Run = Callable[[str, list[str]], Done]            # a command of diptych, in a folder
BACKENDS = {"gl": "gl+glsl", "vk": "vk"}          # text is what programs give OpenGL
PART = 0.1         # of the difference of the sides, up to which a replay counts as equal
HALF_CODE = 0.002  # of 8 bits
FILL = """void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    filled = texels[p.y * WIDTH + p.x];
}
"""


class Refused(Exception):
    """Why there is no spec."""


def modern(code: str) -> str:
    """A fragment shader of GLSL before 1.40, which may use what later versions lack, as one of 3.30."""
    version = re.search(r"^\s*#version\s+(\d+).*$", code, re.M)
    if version and int(version[1]) > 130:
        return code
    code = re.sub(r"^\s*#define\s+in\s+varying\s*$", "", code[version.end() if version else 0:], flags=re.M)
    for name, other in (("gl_FragColor", "alone_color"), ("varying", "in"), ("texture(?:[123]D|Cube)((?:Proj)?(?:Lod)?)", r"texture\1")):
        code = re.sub(rf"\b{name}\b", other, code)
    return "#version 330\n" + ("out vec4 alone_color;\n" if "alone_color" in code else "") + code


def marked(rows: np.ndarray) -> np.ndarray:
    """Other numbers than these, of the same format."""
    return np.where(rows < 0.5, rows + np.float32(128 / 255), rows - np.float32(128 / 255)) if rows.dtype.kind == "f" else rows ^ 1


def numbers(text: str) -> Any:
    """The value of a parameter, of its constructor."""
    words = text[text.index("(") + 1:-1].split(", ")
    values = [json.loads(word.rstrip("u")) for word in words]
    return values if len(values) > 1 else values[0]


# ---- The spec ------------------------------------------------------------------------------------


class Spec:
    """What `import` wrote, while it gets what the capture has in place of its guesses; `made`: the pass of alone.py."""

    def __init__(self, made: Json, source: str, folder: str):
        import yaml  # type: ignore[import]

        self.made, self.source, self.folder = made, source, folder
        self.path = os.path.join(folder, os.path.basename(folder) + ".yaml")
        with open(self.path, encoding="utf-8") as file:
            self.all: Json = yaml.safe_load(file)
        self.run, self.fills = self.all["passes"][0], []  # type: Json, list[Json]
        self.targets: dict[str, Json] = {}
        self.images()
        self.values()
        self.all.update(exactness="fast", passes=[*self.fills, self.run])
        self.all.pop("output", None)
        texts = {"alone.vert": made.get("vert", ""), "fill.glsl": FILL,
                 os.path.basename(self.path): "# By `diptych compare`: one draw or dispatch of a captured frame, with what it read.\n"
                 + yaml.safe_dump(self.all, sort_keys=False, default_flow_style=None, width=120)}
        for name, text in texts.items():
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)

    def load(self, name: str) -> np.ndarray:
        return np.asarray(loaded(self.source, name))

    def buffer(self, name: str, rows: np.ndarray) -> str:
        """One with a file."""
        kind = {"f": "vec4", "u": "uvec4", "i": "ivec4"}[rows.dtype.kind]
        np.save(os.path.join(self.folder, name + ".npy"), np.ascontiguousarray(rows.reshape(-1, 4)))
        self.all.setdefault("buffers", {})[name] = {"of": kind, "file": name + ".npy"}
        return name

    def image(self, name: str, form: str, levels: list[np.ndarray]) -> None:
        """One that passes of our own fill first."""
        mips: Json = {"mips": len(levels)} if len(levels) > 1 else {}
        self.all["images"][name] = {"format": form, "size": list(levels[0].shape[1::-1]), **mips}
        for mip, rows in enumerate(levels):
            data = self.buffer(f"texels_{len(self.fills)}", rows)
            self.fills.append({"name": f"fill_{len(self.fills)}", "draw": "fullscreen", "exactness": "exact",
                               "reads": [{"name": data, "as": "texels"}],
                               "writes": [{"name": name, "as": "filled", **({"mip": mip} if mips else {})}],
                               "defines": {"WIDTH": rows.shape[1]}, "shader": "fill.glsl"})

    def named(self, name: str, items: list[Json]) -> Json:
        """What the capture has for a name of the spec: that of the shader, or the place."""
        found = next((item for item in items if name in (item["name"], item["place"])), items[0] if len(items) == 1 else None)
        if not found or name not in self.all["images"]:
            raise Refused(f"the capture has no {name}, or it is a buffer")
        return found

    def images(self) -> None:
        made, samplers = self.made, {}  # type: Json, Json
        for read in self.run.get("reads", []):
            name = read if isinstance(read, str) else read["name"]
            item = self.named(name, made["textures"] if isinstance(read, dict) else made["targets"])
            self.image(name, item["format"], [self.load(file) for file in item.get("levels", [item.get("before")])])
            if isinstance(read, dict):
                read["sampler"] = f"sampler_{len(samplers)}"
                samplers[read["sampler"]] = item["sampler"]
        names = [item if isinstance(item, str) else item["name"] for item in self.run.pop("writes", []) + self.run.pop("updates", [])]
        if len(names) > len(made["targets"]):
            raise Refused("its shader writes to more targets than it has")
        for name, target in zip(names, made["targets"]):  # those of a draw are in the order of their locations
            self.targets[name] = target = self.named(name, made["targets"]) if "vert" not in made else target
            before = self.load(target["before"])
            if target["before"] == target["after"] and not target.get("blend"):
                target["marked"] = before  # else a shader that does nothing would show the picture
                before = marked(before)
            self.image(name, target["format"], [before])
        self.run["updates"] = [{"name": name, **({"blend": target["blend"]} if target.get("blend") else {})}
                               for name, target in self.targets.items()]
        self.all["samplers"] = samplers
        self.run.pop("dispatch", None)
        self.run.update(made["pass"])
        if "vert" in made:
            self.buffer("vertices_alone", self.load(made["vertices"]))
            self.run.setdefault("reads", []).append({"name": "vertices_alone", "as": "VerticesAlone"})
            self.run["shader"] = ["alone.vert", self.run["shader"]]
        if "depth" in made:
            before = self.load(made["depth"]["before"])[..., 0]
            if before.min() < before.max():  # no spec can fill it
                made["left"].append("depth test")
                self.run = {key: value for key, value in self.run.items() if not key.startswith("depth")}
            else:
                self.all["images"]["depth_alone"] = {"format": "d32f", "size": list(before.shape[::-1]), "clear": float(before.flat[0])}
                self.run["writes"] = ["depth_alone"]
                self.targets["depth_alone"] = made["depth"]

    def values(self) -> None:
        """Of uniforms; what a fragment shader gets from vertices has values already."""
        outs = re.findall(r"(?:location = (\d+)\) )?(?:flat )?out \w+ (\w+);", self.made.get("vert", ""))
        values, known = self.all.get("values", {}), self.made["values"]
        for location, name in outs:
            values.pop(name, values.pop(f"input_{location}", None))
        for name in [*values, *self.all.get("params", {})]:
            if name not in known:
                raise Refused(f"the capture has no value of {name}")
        self.all["values"] = {name: known[name] for name in values}
        for name, item in self.all.get("params", {}).items():
            item["value"] = numbers(known[name])


# ---- The run -------------------------------------------------------------------------------------


class Alone:
    """One side's guilty pass; `why`: the reason why it is not replayed. `own`: what the program left, `ours`: what each backend left."""

    def __init__(self, label: str, made: Json, source: str, folder: str, run: Run):
        self.label, self.made, self.source, self.folder, self.why = label, made, source, folder, made.get("why", "")
        self.own: list[np.ndarray] = []
        self.ours: dict[str, list[np.ndarray]] = {}
        try:
            if not self.why:
                self.replay(run)
        except (Refused, Unreadable, subprocess.TimeoutExpired) as reason:
            self.why = str(reason)

    def call(self, run: Run, words: list[str]) -> None:
        done = run(os.path.dirname(self.folder), words)
        if done.returncode:
            errors = [line.split("error: ", 1)[1] for line in done.stderr.splitlines() if "error: " in line]
            raise Refused(f"{words[0]}: {errors[0] if errors else f'exit status {done.returncode}'}")

    def replay(self, run: Run) -> None:
        shader = self.folder + "." + self.made["shader"].split(".", 1)[1]
        os.rename(own(self.source, self.made["shader"]), shader)
        if shader.endswith(".frag"):
            with open(shader, "r+", encoding="utf-8", errors="replace") as file:
                code = modern(file.read())
                file.seek(0)
                file.write(code)
                file.truncate()
        self.call(run, ["import", shader, "-o", self.folder])
        spec = Spec(self.made, self.source, self.folder)
        self.own = [spec.load(target["after"]) for target in spec.targets.values()]
        for backend, option in BACKENDS.items():
            dump = f"{self.folder}.{backend}"
            self.call(run, ["render", "--spec", spec.path, "--backend", option, "--dump", dump])
            with open(os.path.join(dump, "manifest.json"), encoding="utf-8") as file:
                entries = {item["resource"]: item for item in json.load(file)["entries"] if item["pass"] == "run"}
            self.ours[backend] = [self.result(entries[name], dump, target) for name, target in spec.targets.items()]

    def result(self, entry: Json, dump: str, target: Json) -> np.ndarray:
        form = "r32f" if entry["format"] == "d32f" else entry["format"]
        found = re.fullmatch(r"[rgba]+(8|16|32)(?:_srgb)?(_snorm|f|ui|i|)", form)
        raw = np.fromfile(os.path.join(dump, entry["file"]), f"<{NUMBERS[found[2]]}{int(found[1]) // 8}" if found else "<u4")
        rows = four(form, raw.reshape(entry["height"], entry["width"], -1))
        before = target.get("marked")
        if before is not None:  # what is marked yet was not drawn; if that is all, the program has drawn nothing, or it proves nothing
            left = np.abs(rows - marked(before)).max(-1) < HALF_CODE
            if not left.all() or not np.ptp(before, (0, 1)).any():
                rows[left] = before[left]
        return rows


# ---- The verdict ---------------------------------------------------------------------------------


def distances(first: list[np.ndarray], second: list[np.ndarray]) -> np.ndarray:
    """Of each target, the sum of the differences. NaN in both is equal."""
    if [rows.shape for rows in first] != [rows.shape for rows in second]:
        return np.full(len(first), np.inf)
    return np.array([np.where(np.isnan(one) & np.isnan(other), 0, np.nan_to_num(np.abs(one.astype("f8") - other), nan=1.0)).sum()
                     for one, other in zip(first, second)])


def near(first: list[np.ndarray], second: list[np.ndarray], whole: np.ndarray) -> bool:
    """Whether they are apart by a part of what the sides are, in each target that differs."""
    return bool((distances(first, second) <= PART * whole)[whole > 0].all())


def count_text(first: list[np.ndarray], second: list[np.ndarray]) -> str:
    gaps = np.concatenate([np.abs(one.astype("f8") - other).max(-1).ravel() for one, other in zip(first, second)])
    return f"{np.count_nonzero(gaps)} of {gaps.size} texels, by up to {gaps.max():.3g}"


def other_textures(sides: list[Alone]) -> list[str]:
    """Which textures of one name differ, in either order of rows, by more than the last bits of small floats."""
    def equal(first: list[np.ndarray], second: list[np.ndarray]) -> bool:
        return [rows.shape for rows in first] == [rows.shape for rows in second] and all(
            np.allclose(one, other, rtol=2e-3, atol=1e-6, equal_nan=True) for one, other in zip(first, second))

    textures = [{item["name"]: [loaded(side.source, file) for file in item["levels"]] for item in side.made["textures"]}
                for side in sides]
    return [f"texture {name}" for name, own, other in common(*textures)
            if not equal(own, other) and not equal(own, [rows[::-1] for rows in other])]


def verdict(sides: list[Alone], across: bool, turned: bool, state: list[str]) -> str:
    """What the replays prove, in a line. `state`: how that of the passes differs."""
    good = [side for side in sides if not side.why]
    if not good:
        return "alone: not replayed: " + "; ".join(dict.fromkeys(f"{side.label}: {side.why}" for side in sides))
    whole = np.array([np.abs(rows.astype("f8") - np.median(rows, (0, 1))).sum() for rows in good[0].own])
    if len(good) == 2 and len(sides[0].own) == len(sides[1].own):
        whole = distances(sides[0].own, [rows[::-1] for rows in sides[1].own] if turned else sides[1].own)
    if not whole.any():
        return "alone: not judged: what this pass draws is equal"
    for side in good:
        gaps = {backend: distances(rows, side.own).sum() for backend, rows in side.ours.items()}
        nearer = min(gaps, key=lambda backend: gaps[backend])
        if not near(side.ours[nearer], side.own, whole):
            left = f"; it has no {' and no '.join(side.made['left'])}" if side.made["left"] else ""
            return (f"alone: the replay alone does not show the picture of {side.label}: "
                    f"{count_text(side.ours[nearer], side.own)} differ{left}")
        first, second = side.ours.values()
        if not near(first, second, whole):
            return (f"alone, with equal inputs, gl and vk differ, too: {count_text(first, second)}, with the shader of "
                    f"{side.label}; {nearer} shows its picture: the cause is how the shader is compiled and run")
    head = f"alone, with equal inputs, gl and vk agree, and show the picture of {' and '.join(side.label for side in good)}: "
    if len(good) < 2:
        other = next(side for side in sides if side.why)
        return head + f"the API is not the cause; {other.label} is not replayed: {other.why}"
    code = not across and sides[0].made["shader"] != sides[1].made["shader"]
    found = other_textures(sides) + [text.split(": ")[0] for text in state if not text.endswith("--save")]
    if not found and not across and sides[0].made.get("vertices") != sides[1].made.get("vertices"):
        found = ["vertices"]  # those of two APIs follow other conventions
    if not found and (across or code):
        rest = "the order of rows, the vertices or the code of the shaders" if across else "the code of the shader"
        return head + f"the cause is {rest}: nothing else is seen to differ"
    found += ["its code"] if code else []
    doubt = ", or its code is not the same" if across else ""
    return head + f"the cause is outside the shader{doubt}" + (f"; what differs: {', '.join(found)}" if found else "")
