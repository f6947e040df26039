"""What RenderDoc tells of OpenGL's and of Vulkan's state at an event, under the same words, for replay.py."""
from __future__ import annotations

import math
import os
import re
from typing import Any, Iterator

import numpy as np
import renderdoc as rd

from .texels import texels_of, values_of

Json = dict[str, Any]
STAGES = {"dispatch": [rd.ShaderStage.Compute], "draw": [rd.ShaderStage.Vertex, rd.ShaderStage.Geometry, rd.ShaderStage.Pixel]}
CHANNELS = ["red", "green", "blue", "alpha"]
MOST_UNIFORMS = 1024  # of a block
MOST_BLOCKS = 32  # of a stage, on Zink
ZINK = re.compile(r"(uniform_\d+|ubos)@\d+|(?:gfx|cs)_pushconst")  # blocks that Mesa makes
MOST_VERTICES = 1 << 28  # bytes of an attribute


def word(value: Any) -> str:
    return str(getattr(value, "name", value)).lower()


def stages(state: Any, kind: str) -> Iterator[tuple[Any, Any]]:
    for stage in STAGES.get(kind, []):
        reflection = state.GetShaderReflection(stage)
        if reflection is not None:
            yield stage, reflection


def placed(places: Any, resources: Any) -> Iterator[tuple[Any, Any]]:
    """A shader's resources, each with its place."""
    return ((places[resource.bindPoint], resource) for resource in resources if resource.bindPoint < len(places))


def bindings(control: Any, state: Any, kind: str, gl: bool) -> Iterator[tuple[str, int, bool]]:
    """Name, resource, and whether shaders may store in it. RenderDoc 1.24 has no right list of OpenGL's storage buffers here."""
    storage = list(control.GetGLPipelineState().shaderStorageBuffers) if gl else []
    for stage, reflection in stages(state, kind):
        mapping = state.GetBindpointMapping(stage)
        for stores, bound, places, resources in (
                (False, state.GetReadOnlyResources(stage, False), mapping.readOnlyResources, reflection.readOnlyResources),
                (True, state.GetReadWriteResources(stage, False), mapping.readWriteResources, reflection.readWriteResources)):
            for place, resource in placed(places, resources):
                if gl and not resource.isTexture and place.bind < len(storage):
                    yield resource.name, int(storage[place.bind].resourceId), stores
                    continue
                for array in bound:
                    if place.used and (array.bindPoint.bind, array.bindPoint.bindset) == (place.bind, place.bindset):
                        yield from ((resource.name, int(item.resourceId), stores) for item in array.resources if int(item.resourceId))


def spans(control: Any, kind: str, gl: bool) -> Iterator[tuple[int, tuple[int, int]]]:
    """Start and size of each buffer that is bound for a shader; 0: all behind the start."""
    own = control.GetGLPipelineState() if gl else control.GetVulkanPipelineState()
    sets = () if gl else (own.compute if kind == "dispatch" else own.graphics).descriptorSets
    for item in own.shaderStorageBuffers if gl else ():
        yield int(item.resourceId), (item.byteOffset, item.byteSize)
    for item in (bound for place in sets for binding in place.bindings for bound in binding.binds):
        yield int(item.resourceResourceId), (item.byteOffset, item.byteSize)


def shaders(state: Any, kind: str) -> Iterator[tuple[str, str, bytes, str]]:
    """Stage, entry point, code, and how a file of it ends."""
    for stage, reflection in stages(state, kind):
        end = "glsl" if word(reflection.encoding) == "glsl" else "spv"
        yield word(stage), reflection.entryPoint, bytes(reflection.rawBytes), f".{word(stage)}.{end}"


def restarts(state: Any, indices: np.ndarray) -> np.ndarray:
    """Which of them restart a primitive. RenderDoc tells that index as one of 32 bits."""
    return (indices == state.GetRestartIndex() & np.iinfo(indices.dtype).max) & state.IsRestartEnabled()


def streams(control: Any, action: Any) -> Iterator[tuple[str, np.ndarray]]:
    """What a draw takes of index and vertex buffers: indices, -1 for those that restart a primitive, and the numbers of each attribute, a
    row per vertex or instance."""
    def read(bound: Any, start: int, count: int, stride: int) -> bytes:
        size = count * stride if count * stride <= MOST_VERTICES else 0
        data = bytes(control.GetBufferData(bound.resourceId, start, size)) if size > 0 <= start and int(bound.resourceId) else b""
        return data + bytes(size - len(data))

    state = control.GetPipelineState()
    first, count, index, buffers = action.vertexOffset, action.numIndices, state.GetIBuffer(), state.GetVBuffers()
    size = index.byteStride
    if action.flags & rd.ActionFlags.Indexed and 0 < count * size <= MOST_VERTICES:
        indices = np.frombuffer(read(index, index.byteOffset + action.indexOffset * size, count, size), f"<u{size}")
        restarted = restarts(state, indices)
        least = int(indices[~restarted].min()) if not restarted.all() else 0  # a base may be in the indices, or in the draw
        yield "indices", np.where(restarted, -1, indices.astype("i8") - least)[:, None]
        indices = indices[~restarted]
        first, count = (int(indices.min()) + action.baseVertex, int(np.ptp(indices)) + 1) if len(indices) else (0, 0)
    for item in state.GetVertexInputs():
        regular = item.format.type == rd.ResourceFormatType.Regular
        if not item.used or item.genericEnabled or item.vertexBuffer >= len(buffers) or not regular:
            continue
        bound, width = buffers[item.vertexBuffer], item.format.compByteWidth * item.format.compCount
        rate, stride = max(1, item.instanceRate), max(bound.byteStride, width, 1)
        place, rows = (action.instanceOffset, -(-action.numInstances // rate)) if item.perInstance else (first, count)
        place, rows = (place, rows) if bound.byteStride else (0, 1)
        data = read(bound, bound.byteOffset + item.byteOffset + place * stride, rows, stride)
        data = np.frombuffer(data, "u1").reshape(-1, stride)[:, :width].tobytes()
        texels = texels_of(item.format, data, rows, 1, True)
        if texels:
            yield item.name, values_of(texels.format, texels.rows)[0]


# ---- Uniforms ------------------------------------------------------------------------------------


def flatten(variables: Any, constants: Any, prefix: str, found: dict[str, list[Any]]) -> None:
    """In the order of their offsets, which `constants` has of the same variables. A matrix whose rows lie one after the other in memory
    stands with its number of columns."""
    pairs = list(zip(variables, constants)) if len(constants) == len(variables) else [(variable, None) for variable in variables]
    for variable, constant in sorted(pairs, key=lambda pair: pair[1].byteOffset if pair[1] else 0):
        if len(found) == MOST_UNIFORMS:
            return
        name = prefix + variable.name
        if len(variable.members):
            first = variable.members[0].name
            array = first in ("[0]", f"{variable.name}[0]")
            members = constant.type.members if constant and not array else []
            flatten(variable.members, members, name + "." if not array else name if first == "[0]" else prefix, found)
            continue
        count = max(1, variable.rows) * max(1, variable.columns)
        kind = word(variable.type)
        values = {"float": variable.value.f32v, "double": variable.value.f64v, "sint": variable.value.s32v}.get(kind, variable.value.u32v)
        found[name] = list(values[:count])
        if variable.rows > 1 and variable.RowMajor():
            found[name] = [found[name], variable.columns]


def offsets(constants: Any, start: int, prefix: str) -> Iterator[tuple[str, list[int]]]:
    """Where the numbers of the variables of a block lie, in bytes, by the names and in the order of flatten()."""
    for constant in constants:
        kind, at = constant.type, start + constant.byteOffset
        for element in range(max(1, kind.elements)):
            name = prefix + constant.name + (f"[{element}]" if kind.elements > 1 else "")
            first = at + element * kind.arrayByteStride
            if len(kind.members):
                yield from offsets(kind.members, first, name + ".")
                continue
            across, down = (4, kind.matrixByteStride) if kind.RowMajor() else (kind.matrixByteStride, 4)
            yield name, [first + row * (down if kind.rows > 1 else 0) + column * (across if kind.rows > 1 else 4)
                         for row in range(max(1, kind.rows)) for column in range(max(1, kind.columns))]


def blocks(control: Any, state: Any, kind: str, stage: Any, reflection: Any) -> Iterator[tuple[Any, Any]]:
    """A shader's blocks that are bound, each with its values."""
    pipeline = state.GetComputePipelineObject() if kind == "dispatch" else state.GetGraphicsPipelineObject()
    for index, block in enumerate(reflection.constantBlocks):
        bound = state.GetConstantBuffer(stage, index, 0)
        if not block.bufferBacked or int(bound.resourceId):
            yield block, control.GetCBufferVariableContents(pipeline, reflection.resourceId, stage, reflection.entryPoint, index,
                                                            bound.resourceId, bound.byteOffset, bound.byteSize)


def zink_blocks(control: Any, state: Any, stage: Any, reflection: Any) -> Iterator[tuple[Any, list[np.ndarray]]]:
    """Arrays of blocks that Zink makes of OpenGL's uniforms: of those without a block, and of a stage's blocks in their order. With the
    words of each block."""
    for index, block in enumerate(reflection.constantBlocks):
        parts: list[np.ndarray] = []
        while (ZINK.fullmatch(block.name) or [""] * 2)[1] and len(parts) < MOST_BLOCKS:
            bound = state.GetConstantBuffer(stage, index, len(parts))
            if not int(bound.resourceId):
                break
            size = min(block.byteSize, bound.byteSize or block.byteSize, 4 * MOST_UNIFORMS)
            data = bytes(control.GetBufferData(bound.resourceId, bound.byteOffset, size)) if size else b""
            parts.append(np.frombuffer(data[:len(data) & ~3], "u4"))
        if parts:
            yield block, parts


def words_of(*shader: Any) -> dict[str, list[Any]]:
    """The words of Zink's blocks, by names of our own."""
    found = {}
    for block, parts in zink_blocks(*shader):
        for at, words in enumerate(parts, 1):
            name = block.name.split("@")[0] + (f"_{at}" if block.name.startswith("ubos") else "")
            found.update({f"{word(shader[2])} {name}[{place}]": [number] for place, number in enumerate(numbers(words))})
    return found


def uniforms(control: Any, state: Any, kind: str) -> Json:
    """By name, without those of the blocks; `loose`: of each stage of OpenGL, those without a block, in the order of their locations;
    `laid`: where the numbers of those in blocks lie. Of OpenGL's, Zink keeps words, in that order, but no names."""
    found: dict[str, list[Any]] = {}
    loose: dict[str, list[str]] = {}
    laid: dict[str, list[Json]] = {}
    for stage, reflection in stages(state, kind):
        for block, values in blocks(control, state, kind, stage, reflection):
            own: dict[str, list[Any]] = {}
            if not block.compileConstants and not ZINK.fullmatch(block.name):
                flatten(values, block.variables, "", own)
            if block.name == "$Globals" and not block.bufferBacked and not any(word(value.type) == "double" for value in values):
                loose[word(stage)] = [*own]
            if block.bufferBacked and own:
                laid.setdefault(word(stage), []).append({name: places for name, places in offsets(block.variables, 0, "") if name in own})
            found.update(own)
        found.update(words_of(control, state, stage, reflection))
    return {"uniforms": found, "loose": loose, "laid": laid}


def numbers(words: np.ndarray) -> list[Any]:
    """Words as floats, where these are of a usual size."""
    reals = words.view("f4")
    usual = (np.abs(reals) > 1e-15) & (np.abs(reals) < 1e15)
    return [float(real) if is_usual else int(whole) for real, whole, is_usual in zip(reals, words, usual)]


# ---- State ---------------------------------------------------------------------------------------


def blend(item: Any, constant: Any) -> str:
    def equation(part: Any) -> str:
        return f"{word(part.operation)}({word(part.source)}, {word(part.destination)})"

    mask = "".join(name for bit, name in enumerate("rgba") if item.writeMask >> bit & 1) or "nothing"
    equations = [equation(part) for part in (item.colorBlend, item.alphaBlend)]
    how = f"colour {equations[0]}, alpha {equations[1]}" if item.enabled and equations != 2 * ["add(one, zero)"] else "off"
    how += f", constant {' '.join(f'{value:g}' for value in constant)}" if "factor" in how else ""
    how += f", logic {word(item.logicOperation)}" if item.logicOperationEnabled else ""
    return f"{how}; writes {mask}"


def stencil(face: Any) -> str:
    operations = map(word, (face.failOperation, face.depthFailOperation, face.passOperation))
    masks = face.compareMask & 0xff, face.writeMask & 0xff
    return f"{word(face.function)} {face.reference} & {masks[0]:#x}, {'/'.join(operations)}, writes {masks[1]:#x}"


def order(seen: Any, form: Any) -> list[str]:
    """In which the channels of a texture of colours are read; a fixed 0 or 1 stands for a channel that the format of the API lacks."""
    read = [word(getattr(seen.swizzle, name)) for name in CHANNELS]
    return [name if told in ("zero", "one") or not form or form.compCount < 3 else told for name, told in zip(CHANNELS, read)]


def sampler(item: Any, seen: Any, addresses: list[str], texture: Any, form: Any) -> str:
    """Vulkan has no word for a sampler without mips: programs forbid all but the first level."""
    chosen, count = item.filter, texture.mips if texture else 1
    minify, magnify, between = (word(way).replace("anisotropic", "linear") for way in (chosen.minify, chosen.magnify, chosen.mip))
    mips = "nofilter" if item.maxLOD < 0.5 else between
    text = f"{minify}/{magnify}{f', mips {mips}' if count > 1 else ''}, {'/'.join(addresses)}"
    text += f", border {' '.join(f'{value:g}' for value in item.borderColor)}" if "clampborder" in addresses else ""
    text += f", compare {word(item.compareFunction)}" if word(chosen.filter) == "comparison" else ""
    text += f", anisotropy {item.maxAnisotropy:g}" if item.maxAnisotropy > 1 else ""
    levels = seen.firstMip + max(0, item.minLOD), last_level(item, seen, count) if mips != "nofilter" else count - 1
    text += f", levels {levels[0]:g} to {levels[1]:g}" if levels != (0, count - 1) or (mips != "nofilter" and count > 1) else ""
    bias = getattr(item, "mipBias", 0) or getattr(item, "mipLODBias", 0)
    text += f", bias {bias:g}" if bias and count > 1 else ""
    channels = order(seen, form)
    text += f", channels {'/'.join(channels)}" if channels != CHANNELS else ""
    return text + (", sRGB" if form and form.compType == rd.CompType.UNormSRGB else "")


def last_level(item: Any, seen: Any, count: int) -> float:
    """The smallest one of `count` that is sampled."""
    last = min(count, seen.firstMip + seen.numMips) - 1 if seen.numMips > 0 else count - 1
    return seen.firstMip if item.maxLOD < 0.5 or word(item.filter.mip) == "nofilter" else min(last, seen.firstMip + item.maxLOD)


def last_levels(control: Any, state: Any, kind: str, gl: bool, textures: dict[int, Any]) -> Iterator[tuple[int, int]]:
    """Of each texture that is sampled."""
    for stage, _ in stages(state, kind):
        for _, _, number, seen, item, _ in bound_textures(control, state, stage, gl):
            if number in textures:
                yield number, math.ceil(last_level(item, seen, textures[number].mips))


def bound_at(sets: Any, place: Any) -> Any:
    bindings = sets[place.bindset].bindings if place.bindset < len(sets) else []
    return next(iter(bindings[place.bind].binds), None) if place.bind < len(bindings) else None


def sampler_of(state: Any, stage: Any, sets: Any, name: str) -> Any:
    """That of a texture without its own, as HLSL has them: the only one, or the one whose name begins with the most of the same letters."""
    mapping, found = state.GetBindpointMapping(stage), state.GetShaderReflection(stage).samplers
    named = [(len(os.path.commonprefix([name, item.name])), -at, place)
             for at, (place, item) in enumerate(placed(mapping.samplers, found)) if place.used]
    return bound_at(sets, max(named)[2]) if named and (len(named) == 1 or max(named)[0]) else None


def bound_textures(control: Any, state: Any, stage: Any, gl: bool) -> Iterator[tuple[Any, Any, int, Any, Any, tuple[Any, ...]]]:
    """What the shader calls it, its place, the texture and how it is seen, the sampler and its addresses."""
    own = control.GetGLPipelineState() if gl else control.GetVulkanPipelineState()
    sets: Any = None if gl else (own.compute if stage == rd.ShaderStage.Compute else own.graphics).descriptorSets
    read = state.GetShaderReflection(stage).readOnlyResources
    for place, resource in placed(state.GetBindpointMapping(stage).readOnlyResources, read):
        if not place.used or not resource.isTexture:
            continue
        if gl and place.bind < len(own.samplers) and int(own.textures[place.bind].resourceId):
            item, seen = own.samplers[place.bind], own.textures[place.bind]
            yield resource, place, int(seen.resourceId), seen, item, (item.addressS, item.addressT, item.addressR)
        elif not gl:
            seen = bound_at(sets, place)
            item = seen if seen and int(seen.samplerResourceId) else sampler_of(state, stage, sets, resource.name)
            if seen and item:
                yield resource, place, int(seen.resourceResourceId), seen, item, (item.addressU, item.addressV, item.addressW)


def samplers(control: Any, state: Any, kind: str, gl: bool, textures: dict[int, Any]) -> dict[str, str]:
    """By the name of the texture in the shader."""
    found = {}
    for stage, _ in stages(state, kind):
        for resource, _, number, seen, item, addresses in bound_textures(control, state, stage, gl):
            texture = textures.get(number)
            names = list(map(word, addresses))[:texture.dimension if texture else 2]
            form = getattr(seen, "viewFormat", texture and texture.format)
            found[resource.name] = sampler(item, seen, names, texture, form)
    return found


def rectangle(item: Any) -> list[float]:
    return [item.x, item.y, item.width, item.height]


def fixed(control: Any, gl: bool) -> Json:
    if gl:
        own = control.GetGLPipelineState()
        raster, depth = own.rasterizer.state, own.depthState
        tested, written, stenciled = depth.depthEnable, depth.depthWrites, own.stencilState.stencilEnable
        faces, biased = own.stencilState, True
        clamps, clamp, discards = raster.depthClamp, raster.offsetClamp, own.vertexProcessing.discard
    else:
        own = control.GetVulkanPipelineState()
        raster, depth = own.rasterizer, own.depthStencil
        tested, written, stenciled = depth.depthTestEnable, depth.depthWriteEnable, depth.stencilTestEnable
        faces, biased = depth, raster.depthBiasEnable
        clamps, clamp, discards = raster.depthClampEnable, raster.depthBiasClamp, raster.rasterizerDiscardEnable
    offset = [raster.depthBias, raster.slopeScaledDepthBias, clamp] if biased else [0, 0, 0]
    return {"depth test": word(depth.depthFunction) if tested else "off", "depth writes": "on" if tested and written else "off",
            "depth clamp": "on" if clamps else "off", "rasterizer discard": "on" if discards else "off",
            "cull": word(raster.cullMode), "front": "ccw" if raster.frontCCW else "cw",
            "fill": word(raster.fillMode), "polygon offset": offset,
            "stencil front": stencil(faces.frontFace) if stenciled else "off",
            "stencil back": stencil(faces.backFace) if stenciled else "off"}


def channels(form: Any, encodes: bool) -> str:
    """Numbers and bits of a format; the order of channels and a missing alpha are not told. `encodes`: what is written in sRGB."""
    if form.type != rd.ResourceFormatType.Regular:
        return word(form.type)
    kind = form.compType if encodes or form.compType != rd.CompType.UNormSRGB else rd.CompType.UNorm
    return f"{8 * form.compByteWidth} bits {word(kind)}"


def coverage(own: Any, gl: bool, samples: int) -> Json:
    """Of several samples; of one, all this has no effect."""
    if gl:
        raster = own.rasterizer.state
        alpha, mask = raster.alphaToCoverage, raster.sampleMaskValue if raster.sampleMask else ~0
        rate = raster.minSampleShadingRate if raster.sampleShading else 0
    else:
        raster = own.multisample
        alpha, mask = own.colorBlend.alphaToCoverageEnable, raster.sampleMask
        rate = raster.minSampleShading if raster.sampleShadingEnable else 0
    several = {"alpha to coverage": "on" if alpha else "off", "sample mask": f"{mask & (1 << samples) - 1:#x}", "sample shading": rate}
    return {"samples": samples, **(several if samples > 1 else {})}


def drawing(control: Any, state: Any, gl: bool, textures: dict[int, Any]) -> Json:
    own = control.GetGLPipelineState() if gl else control.GetVulkanPipelineState()
    encodes, blends = (own.framebuffer.framebufferSRGB, own.framebuffer.blendState) if gl else (True, own.colorBlend)
    bound = [*state.GetOutputTargets(), state.GetDepthTarget()]
    sizes = [textures[int(item.resourceId)] for item in bound if int(item.resourceId) in textures]
    height = max(1, sizes[0].height >> max(0, next(item.firstMip for item in bound if int(item.resourceId)))) if sizes else 0
    viewport, scissor, tests = state.GetViewport(0), state.GetScissor(0), fixed(control, gl)
    depth = textures.get(int(bound[-1].resourceId))
    if not depth:
        tests.update({"depth test": "off", "depth writes": "off"})
    if not depth or depth.format.type == rd.ResourceFormatType.Regular:
        tests.update({"stencil front": "off", "stencil back": "off"})
    colours = [item for item in sizes if item is not depth]
    uses = any(tests[key] != "off" for key in ("depth test", "stencil front", "stencil back"))
    form = {"depth format": channels(depth.format, encodes)} if depth and uses else {}
    return {**tests, **form, **coverage(own, gl, max((item.msSamp for item in sizes), default=1)), "height": height,
            "viewport": rectangle(viewport), "depth range": [viewport.minDepth, viewport.maxDepth],
            "scissor": rectangle(scissor) if scissor.enabled else [], "topology": word(state.GetPrimitiveTopology()),
            **({"flat values": "of the last vertex" if own.vertexInput.provokingVertexLast else "of the first vertex"} if gl else {}),
            "formats": [channels(item.format, encodes) for item in colours],
            "blend": [blend(item, blends.blendFactor) for item in list(state.GetColorBlends())[:len(colours)]]}


def state_of(control: Any, gl: bool, kind: str, textures: dict[int, Any]) -> Json:
    state = control.GetPipelineState()
    return {"state": drawing(control, state, gl, textures) if kind == "draw" else {},
            "samplers": samplers(control, state, kind, gl, textures), **uniforms(control, state, kind)}


def device_of(file: Any) -> str:
    """Where the program ran, if the capture tells, and whether Zink drew its OpenGL."""
    found = {chunk.name: item for chunk in file.chunks for name in ("deviceName", "EngineName")
             if chunk.name in ("vkEnumeratePhysicalDevices", "vkCreateInstance") for item in [chunk.FindChildRecursively(name)] if item}
    zink = "vkCreateInstance" in found and found["vkCreateInstance"].AsString() == "mesa zink"
    device = str(found["vkEnumeratePhysicalDevices"].AsString()) if "vkEnumeratePhysicalDevices" in found else ""
    return device + " by Zink" * zink
