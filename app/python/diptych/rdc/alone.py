"""One draw or dispatch of a capture with all that it takes, for guilty.py: `python3 -m diptych.rdc.alone CAPTURE FOLDER EVENT`, a
process like replay.py. Leaves FOLDER/frame.json with one pass in the words of specs, shader, and arrays of four numbers per texel
or vertex; or `why`, the reason why that cannot be told."""
from __future__ import annotations

import io
import json
import os
import re
from typing import Any, Callable

import numpy as np
import renderdoc as rd

from . import state as rdc_state
from .replay import Frame, leaves, open_file, replayed, run
from .state import word
from .texels import four, texels_of

Json = dict[str, Any]
MOST_VERTICES, MOST_TEXELS = 1 << 16, 1 << 24
LISTS: dict[str, Callable[[int], list[int]]] = {
    "trianglelist": lambda at: [3 * at, 3 * at + 1, 3 * at + 2], "trianglefan": lambda at: [0, at + 1, at + 2],
    "trianglestrip": lambda at: [at, at + 1 + at % 2, at + 2 - at % 2]}
TYPES = {"float": ("", "float", ""), "uint": ("u", "uint", "floatBitsToUint"), "sint": ("i", "int", "floatBitsToInt")}
WRAPS = {"wrap": "repeat", "mirror": "mirror", "clampedge": "clamp"}
TESTS = {"less": "less", "lessequal": "less_equal", "greater": "greater", "alwaystrue": "always"}


class Untold(Exception):
    """Why it cannot be replayed alone."""


class Taken:
    """What is taken out of the capture; arrays are files."""

    def __init__(self, frame: Frame, action: Any):
        self.frame, self.action, self.control = frame, action, frame.control
        self.kind = "dispatch" if action.flags & rd.ActionFlags.Dispatch else "draw"
        self.control.SetFrameEvent(action.eventId, True)
        self.state = self.control.GetPipelineState()
        self.stage = rdc_state.STAGES[self.kind][-1]
        self.shader = self.state.GetShaderReflection(self.stage)
        self.files: list[Json] = []
        if self.shader is None:
            raise Untold("it has no shader of its own: fixed function, or depth alone")

    def keep(self, rows: np.ndarray) -> str:
        stream = io.BytesIO()
        np.save(stream, np.ascontiguousarray(rows))
        self.files.append({"file": self.frame.keep(stream.getvalue(), ".npy")})
        return str(self.files[-1]["file"])

    def texels(self, resource: int, name: str, mip: int) -> tuple[str, np.ndarray]:
        """The format that a spec has for it, and its numbers."""
        info = self.frame.textures.get(resource)
        if info is None or info.dimension != 2 or info.arraysize > 1 or info.msSamp > 1 or info.cubemap:
            raise Untold(f"{name} is a buffer, or has one or three dimensions, layers or samples")
        width, height = max(1, info.width >> mip), max(1, info.height >> mip)
        if width * height > MOST_TEXELS:
            raise Untold(f"{name} has more than {MOST_TEXELS} texels")
        found = texels_of(info.format, next(self.frame.layers(info, mip)), width, height, self.frame.gl)
        if found is None:
            raise Untold(f"{name} has texels of the format {info.format.Name()}")
        form = "r32f" if found.format.startswith("d") else found.format.replace("bgra", "rgba").replace("rgb8", "rgba8")
        return form, four(found.format, found.rows)

    # ---- Values ----------------------------------------------------------------------------------

    def collect(self, variables: Any, prefix: str, place: str, found: dict[str, str]) -> None:
        """By the names that a spec has for them: those of the shader, and those by place."""
        for at, variable in enumerate(variables):
            name, number = prefix + variable.name, f"{place}_{at}"
            if len(variable.members) and not variable.members[0].name.startswith("["):
                self.collect(variable.members, name + "_", number, found)
            else:
                found[name] = found[number] = literal(variable)
                found.setdefault(variable.name, found[name])  # of a block that has a name

    def values(self) -> dict[str, str]:
        places = self.state.GetBindpointMapping(self.stage).constantBlocks
        found: dict[str, str] = {}
        for block, values in rdc_state.blocks(self.control, self.state, self.kind, self.stage, self.shader):
            self.collect(values, "", place_of(places[block.bindPoint]) if block.bindPoint < len(places) else "", found)
        for block, parts in rdc_state.zink_blocks(self.control, self.state, self.stage, self.shader):
            size = block.byteSize // 4
            rows = [f"uint[{size}]({', '.join(f'{number}u' for number in [*words, *[0] * (size - len(words))])})" for words in parts]
            found[f"struct_{block.name.replace('@', '_at_')}_0"] = f"uint[{len(rows)}][{size}]({', '.join(rows)})"
        return found

    # ---- Textures --------------------------------------------------------------------------------

    def textures(self) -> list[Json]:
        made = []
        bound = rdc_state.bound_textures(self.control, self.state, self.stage, self.frame.gl)
        for resource, place, number, seen, item, addresses in bound:
            info, chosen = self.frame.textures.get(number), item.filter
            mips = item.maxLOD >= 0.5 and word(chosen.mip) != "nofilter"
            count = max(1, min(seen.numMips, info.mips - seen.firstMip)) if info and mips else 1
            levels = [self.texels(number, resource.name, mip) for mip in range(seen.firstMip, seen.firstMip + count)]
            wraps = {word(address) for address in addresses[:2]}
            if any(word(getattr(seen.swizzle, name)) != name for name in rdc_state.CHANNELS):
                raise Untold(f"{resource.name} has its channels in another order")
            if (word(chosen.filter) == "comparison" or len(wraps) > 1 or not wraps <= WRAPS.keys()
                    or (count > 1 and chosen.minify != chosen.magnify)):
                raise Untold(f"{resource.name} is sampled as no spec can")
            sampler = {"kind": "filter", "wrap": WRAPS[wraps.pop()],
                       "filter": "nearest" if word(chosen.magnify) == "point" else "linear",
                       "mip_filter": "linear" if word(chosen.mip) == "linear" else "nearest",
                       "anisotropy": max(1, item.maxAnisotropy)}
            made.append({"name": resource.name, "place": place_of(place), "format": levels[0][0], "sampler": sampler,
                         "levels": [self.keep(rows) for _, rows in levels]})
        return made

    # ---- A draw ----------------------------------------------------------------------------------

    def order(self, mesh: Any) -> np.ndarray:
        """Of the vertices of a list of triangles."""
        shape = word(mesh.topology)
        if shape not in LISTS or not int(mesh.vertexResourceId) or not 3 <= mesh.numIndices <= MOST_VERTICES:
            raise Untold(f"its vertices cannot be read: {mesh.numIndices}, {shape}")
        count = mesh.numIndices // 3 if shape == "trianglelist" else mesh.numIndices - 2
        order = np.array([LISTS[shape](at) for at in range(count)]).ravel()
        if not int(mesh.indexResourceId):
            return order
        size = mesh.indexByteStride
        raw = bytes(self.control.GetBufferData(mesh.indexResourceId, mesh.indexByteOffset, mesh.numIndices * size))
        indices = np.frombuffer(raw, f"<u{size}")
        if rdc_state.restarts(self.state, indices).any():
            raise Untold("its indices restart primitives")
        return indices[order].astype(int) + mesh.baseVertex

    def outputs(self) -> dict[Any, int]:
        """Where each output of the vertex shader stands among the words behind the position."""
        at, found = 4, {}
        aligned = self.state.HasAlignedPostVSData(rd.MeshDataStage.VSOut)
        for item in self.state.GetShaderReflection(rd.ShaderStage.Vertex).outputSignature:
            if word(item.systemValue) == "position":
                continue
            unit = (4 if item.compCount > 2 else item.compCount) if aligned else 1
            at = -(-at // unit) * unit
            if word(item.systemValue) == "undefined":
                found[self.key(item)] = at
            at += item.compCount
        return found

    def key(self, item: Any) -> Any:
        """What an output and an input of two shaders have in common."""
        return item.varName if self.frame.gl else item.regIndex

    def vertices(self) -> tuple[np.ndarray, list[Any]]:
        """Behind the vertex shader: of each vertex of a list of triangles, its position and what the fragment shader reads."""
        if self.state.GetShaderReflection(rd.ShaderStage.Geometry) or self.state.IsTessellationEnabled() or self.action.numInstances > 1:
            raise Untold("it has a geometry shader, tessellation or instances")
        mesh = self.control.GetPostVSData(0, 0, rd.MeshDataStage.VSOut)
        order, outputs, stride = self.order(mesh), self.outputs(), mesh.vertexByteStride
        raw = bytes(self.control.GetBufferData(mesh.vertexResourceId, mesh.vertexByteOffset, 0))
        words = np.frombuffer(raw[:len(raw) // stride * stride], "<f4").reshape(-1, stride // 4)[order]
        read = [item for item in self.shader.inputSignature if word(item.systemValue) == "undefined"]
        rows = np.zeros((len(words), 1 + len(read), 4), "<f4")
        rows[:, 0] = words[:, :4]
        for column, item in enumerate(read, 1):
            start = outputs.get(self.key(item))
            if start is None or word(item.varType) not in TYPES:
                raise Untold(f"the vertex shader does not write {item.varName}, or it is {word(item.varType)}")
            rows[:, column, :item.compCount] = words[:, start:start + item.compCount]
        return rows, read

    def rectangles(self, fixed: Json) -> Json:
        """Viewport, scissor and cull of the pass."""
        viewport, scissor = self.state.GetViewport(0), self.state.GetScissor(0)
        y = viewport.y + min(0, viewport.height)
        made: Json = {"viewport": list(map(int, (viewport.x, y, viewport.width, abs(viewport.height))))}
        if fixed["cull"] in ("front", "back"):  # a spec's front is counter-clockwise as rows go up; Vulkan's go down
            same = (fixed["front"] == "ccw") == self.frame.gl
            made["cull"] = fixed["cull"] if same else {"front": "back", "back": "front"}[fixed["cull"]]
        if scissor.enabled:
            made["scissor"] = list(map(int, rdc_state.rectangle(scissor)))
        return made

    def drawn(self) -> Json:
        """In the clip space of a spec: that of Vulkan, with rows that go up."""
        fixed, target, viewport = rdc_state.fixed(self.control, self.frame.gl), self.state.GetDepthTarget(), self.state.GetViewport(0)
        clip = self.control.GetGLPipelineState().vertexProcessing if self.frame.gl else None
        rows, read = self.vertices()
        places = rows[:, 0]
        made: Json = {"left": ["stencil test"] if fixed["stencil front"] != "off" else [],
                      "pass": {"draw": {"vertices": len(rows)}, **self.rectangles(fixed)}}
        if viewport.height < 0 or (clip and not clip.clipOriginLowerLeft):
            places[:, 1] *= -1
        if clip and clip.clipNegativeOneToOne:
            places[:, 2] = (places[:, 2] + places[:, 3]) / 2
        if int(target.resourceId) and fixed["depth test"] in TESTS:
            made["depth"] = {"id": int(target.resourceId), "mip": target.firstMip, "name": "depth"}
            places[:, 2] = places[:, 2] * (viewport.maxDepth - viewport.minDepth) + places[:, 3] * viewport.minDepth
            made["pass"].update(depth=TESTS[fixed["depth test"]], depth_write=fixed["depth writes"] == "on")
            if any(fixed["polygon offset"][:2]):
                made["pass"]["depth_bias"] = dict(zip(("constant", "slope"), fixed["polygon offset"]))
        else:
            places[:, 2] = places[:, 3] / 2
            made["left"] += ["depth test"] if int(target.resourceId) and fixed["depth test"] != "off" else []
        blends = list(self.state.GetColorBlends())
        made["targets"] = [{"name": f"color{slot}", "place": "", "id": int(item.resourceId), "mip": item.firstMip,
                            "blend": factors(blends[min(slot, len(blends) - 1)])}
                           for slot, item in enumerate(self.state.GetOutputTargets()) if int(item.resourceId)]
        return {**made, "vertices": self.keep(rows.reshape(-1, 4)), "vert": vertex_shader(read, self.frame.gl, bytes(self.shader.rawBytes))}

    # ---- Either ----------------------------------------------------------------------------------

    def dispatched(self) -> Json:
        stored = [{"name": name, "place": "", "id": resource, "mip": 0} for name, resource in self.stored()]
        return {"pass": {"groups": list(self.action.dispatchDimension)}, "targets": stored, "left": []}

    def stored(self) -> list[tuple[str, int]]:
        bindings = rdc_state.bindings(self.control, self.state, self.kind, self.frame.gl)
        return [(name, resource) for name, resource, stores in bindings if stores]

    def all(self) -> Json:
        if self.kind == "draw" and self.stored():
            raise Untold("it draws, and stores in buffers or images")
        code, end = bytes(self.shader.rawBytes), ".comp" if self.kind == "dispatch" else ".frag"
        made: Json = {"textures": self.textures(), "values": self.values(),
                      "shader": self.frame.keep(code, end + (".spv" if code[:4] == b"\x03\x02#\x07" else ""))}
        made |= self.dispatched() if self.kind == "dispatch" else self.drawn()
        for key in ("after", "before"):
            for target in [*made["targets"], *([made["depth"]] if "depth" in made else [])]:
                target["format"], rows = self.texels(target["id"], target["name"], target["mip"])
                target[key] = self.keep(rows)
            self.control.SetFrameEvent(self.action.eventId - 1, False)
        return {**made, "inputs": [*self.files, {"file": made["shader"]}]}


def literal(variable: Any) -> str:
    """A constructor of GLSL."""
    if len(variable.members):
        items = [literal(member) for member in variable.members]
        return f"{items[0].split('(')[0]}[{len(items)}]({', '.join(items)})"
    kind, rows, columns = word(variable.type), max(1, variable.rows), max(1, variable.columns)
    values = {"float": variable.value.f32v, "sint": variable.value.s32v}.get(kind, variable.value.u32v)
    numbers = [values[row * columns + column] for column in range(columns) for row in range(rows)]
    letter, name = {"bool": ("b", "bool")}.get(kind) or TYPES.get(kind, ("", ""))[:2]
    if not name or not np.isfinite(numbers).all():
        raise Untold(f"the uniform {variable.name} is of the type {kind}, or not finite")
    texts = [str(bool(value)).lower() if kind == "bool" else f"{value!r}{letter.replace('i', '')}" for value in numbers]
    matrix = f"mat{columns}" if rows == columns else f"mat{columns}x{rows}"
    return f"{matrix if rows > 1 else f'{letter}vec{columns}' if columns > 1 else name}({', '.join(texts)})"


def place_of(place: Any) -> str:
    """The name that a spec has for a resource without a name."""
    return f"set_{place.bindset}_binding_{place.bind}" if place.bindset > 0 else f"binding_{place.bind}"


def factors(item: Any) -> Json | None:
    """How a target blends, in a spec's words; None: not at all."""
    if item.writeMask & 15 != 15:
        raise Untold("it writes some channels alone")
    made: dict[str, str] = {}
    for prefix, part in (("", item.colorBlend), ("alpha_", item.alphaBlend)):
        for key, value in (("src", part.source), ("dst", part.destination), ("op", part.operation)):
            text = word(value).replace("inv", "one_minus_").replace("alpha", "_alpha").replace("col", "_color")
            if "factor" in text and item.enabled:
                raise Untold("it blends with a constant")
            made[prefix + key] = {"reversedsubtract": "reverse_subtract", "minimum": "min", "maximum": "max"}.get(text, text)
        if made[prefix + "op"] in ("min", "max"):
            del made[prefix + "src"], made[prefix + "dst"]
    return made if item.enabled else None


def vertex_shader(read: list[Any], gl: bool, code: bytes) -> str:
    """Hands on what the program's left: in OpenGL's GLSL by name, where the fragment shader gives no location."""
    outs, lines, each = [], [], 1 + len(read)
    for at, item in enumerate(read, 1):
        letter, kind, cast = TYPES[word(item.varType)]
        kind = kind if item.compCount == 1 else f"{letter}vec{item.compCount}"
        own = re.search(r"location\s*=\s*(\d+)\s*\)[^;]*\b" + re.escape(item.varName) + r"\s*;", code.decode(errors="replace"))
        place = f"layout(location = {own[1] if own else item.regIndex}) " if own or not gl else ""
        outs.append(f"{place}{'flat ' if letter else ''}out {kind} {item.varName};")
        lines.append(f"    {item.varName} = {cast}(vertices_alone[{each} * gl_VertexIndex + {at}].{'xyzw'[:item.compCount]});")
    return "\n".join(["#version 450", "layout(std430) readonly buffer VerticesAlone { vec4 vertices_alone[]; };", *outs, "void main()", "{",
                      f"    gl_Position = vertices_alone[{each} * gl_VertexIndex];", *lines, "}", ""])


def main(path: str, folder: str, event: str) -> None:
    capture = open_file(path)
    control = replayed(capture)
    actions = {action.eventId: action for action, _ in leaves(control.GetRootActions(), control.GetStructuredFile(), [])}
    made: Json = {"inputs": []}
    try:
        made = Taken(Frame(control, folder), actions[int(event)]).all()
    except Untold as reason:
        made["why"] = str(reason)
    np.savez(os.path.join(folder, "small.npz"))
    with open(os.path.join(folder, "frame.json"), "w", encoding="utf-8") as file:
        json.dump({"api": str(capture.DriverName()), "passes": [{"entries": [], "shaders": [], **made}]}, file)


if __name__ == "__main__":
    run(main)
