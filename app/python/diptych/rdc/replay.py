"""Replays a capture of RenderDoc: `python3 -m diptych.rdc.replay CAPTURE FOLDER DRAWS`, a process that
`compare` starts, as a rule in a sandbox. Leaves FOLDER/frame.json, one raw file per content, and small.npz,
small pictures that passes are matched by.

A pass is a run of draws into the same targets, a dispatch, a copy, or a chain of mips; labels of the program
part a run. DRAWS, like 17-58, are the events of a pass whose draws are passes of their own, or empty.
RenderDoc replays from the frame's start to each event that is asked for. So a child of this process (with a
fourth argument) reads state, where Mesa draws nothing, and ends before this process opens the capture. Opening
draws the frame once: this process reads what is whole then, and stops only where contents are about to be
overwritten. Cheap frames need no child. A failure is told on stderr; the process then ends with os._exit,
since RenderDoc hangs in exit."""
from __future__ import annotations

import hashlib
import json
import math
import os
import re
import subprocess
import sys
import time
from typing import Any, Callable, Iterator, NoReturn

import numpy as np
import renderdoc as rd

from . import state as rdc_state
from .texels import hashes_of, names_of, small_picture, texels_of

Json = dict[str, Any]
FLAGS = rd.ActionFlags
COPIES = FLAGS.Copy | FLAGS.Resolve | FLAGS.GenMips
SHOWN = FLAGS.Drawcall | FLAGS.Dispatch | FLAGS.Clear | FLAGS.BeginPass | FLAGS.EndPass | COPIES
NULL = int(rd.ResourceId.Null())
MOST_BYTES = 1 << 30   # of one content
MOST_LOOKS = 64        # draws of a frame at which state is read, beside the last of each pass
MOST_STOPS = 8         # with contents that are discarded
SECONDS_OF_LOOKS = 4.0  # of a processor, above which a child looks
LARGE = 64 << 20       # bytes of a capture, above which a child looks, too
GL_LINEAR, GL_COLOR, CLEARED = 0x2601, 0x1800, {"colour": 0x4000, "depth": 0x100, "stencil": 0x400}  # bits of glClear
VK_CLEARS, VK_DEPTHS = 1, range(124, 131)  # VK_ATTACHMENT_LOAD_OP_CLEAR, formats
NEVER, OPENED = 1 << 62, (1 << 62) - 1  # events: none; the end of the frame, as opening leaves it
SECONDS_OF_PROGRESS = 5.0
WRITES = ("Target", "Clear", "Discard", "GenMips", "Copy", "Resolve", "CPUWrite", "StreamOut", "RWResource")  # in names of usages
STARTED: list[subprocess.Popen[bytes]] = []  # a server of X, and the child


def leave(status: int) -> NoReturn:
    for process in STARTED:
        process.kill()
    os._exit(status)


def fail(text: str) -> NoReturn:
    print(text, file=sys.stderr, flush=True)
    leave(2)


def progress(items: list[Any], what: str) -> Iterator[Any]:
    """The items; how many are done is told now and then."""
    told = time.monotonic()
    for done, item in enumerate(items):
        if time.monotonic() - told > SECONDS_OF_PROGRESS:
            told = time.monotonic()
            print(f"replay: {done} of {len(items)} {what}", file=sys.stderr, flush=True)
        yield item


# ---- Passes --------------------------------------------------------------------------------------


class Pass:
    """Events `first` to `last`; `targets`: ids of colours, and of depth at the end; 0: none. `keys`: of each draw, what Calls tells."""

    def __init__(self, run: int, kind: str, targets: tuple[int, ...], where: list[str], action: Any):
        self.run, self.kind, self.targets, self.where = run, kind, targets, where
        self.first = self.last = action.eventId
        self.draws: list[Any] = []
        self.clears: dict[str, list[float]] = {}
        self.region: list[list[float]] = []
        self.keys: list[tuple[int, int]] = []

    def add(self, action: Any, keys: tuple[int, int]) -> None:
        self.draws.append(action)
        self.keys.append(keys)
        self.last = action.eventId


def leaves(actions: Any, file: Any, where: list[str]) -> Iterator[tuple[Any, list[str]]]:
    """Actions with the names of the markers around them."""
    inside = FLAGS.PassBoundary | FLAGS.CmdList | FLAGS.CommandBufferBoundary
    for action in actions:
        if not action.flags & SHOWN:
            yield action, where
        if action.children:
            marker = bool(action.flags & FLAGS.PushMarker) and not action.flags & inside
            name = [action.customName or action.GetName(file)] if marker else []
            yield from leaves(action.children, file, where + name)
        if action.flags & SHOWN:
            yield action, where


BINDS_FRAMEBUFFER = ("glBindFramebuffer", "glFramebufferTexture", "glNamedFramebufferTexture")
PLACES = {"cap", "index", "target", "buf", "drawbuffer", "face", "unit", "texunit", "pname", "sampler", "pipelineBindPoint", "firstSet"}
# Calls that set no state, and those that set no more than samplers.
NO_STATE = re.compile("Uniform|Data$|Storage|Image|Mipmap|Vertex|Draw|Clear|Marker|Debug|Label|IndexBuffer|PushConstants|Framebuffer|"
                      "RenderPass|Barrier|Sync|Wait|Query|Flush|^(?!gl|vkCmd)")
SAMPLING = re.compile("BindTexture|BindBuffer|DescriptorSets|Sampler|TexParameter|TextureParameter")


def bits(item: Any) -> Any:
    """The value of an argument, to be held against others."""
    count = item.NumChildren()
    return tuple(bits(item.GetChild(at)) for at in range(count)) if count else item.data.basic.u


def region_of(chunk: Any) -> list[list[float]]:
    """Corners of what a blit reads and of what it writes, and whether it filters."""
    words = child(chunk, "pBlitImageInfo") if chunk.name.startswith("vkCmdBlitImage2") else chunk
    parts = children(child(words, "pRegions"))[:1] if chunk.name.startswith("vkCmdBlitImage") else []
    corners = [sum((numbers(corner)[:2] for corner in children(child(part, name))), []) for part in parts for name in ("srcOffsets", "dstOffsets")]
    if chunk.name.startswith("glBlit"):
        corners = [[number(child(chunk, side + name)) for name in ("X0", "Y0", "X1", "Y1")] for side in ("src", "dst")]
    return [*corners, [float(child(words, "filter").data.basic.u in (1, GL_LINEAR))]] if corners else []


class Calls:
    """What a frame's calls have set: draws of equal state are looked at once. `region`: of the last blit."""

    def __init__(self, file: Any):
        self.file, self.unit, self.clears = file, 0, Clears(file)
        self.region: list[list[float]] = []
        self.state: dict[Any, Any] = {}
        self.sampling: dict[Any, Any] = {}

    def add(self, action: Any) -> bool:
        """Whether the targets of OpenGL were set anew."""
        bound, self.clears.now, self.region = False, {}, []
        for event in action.events:
            if event.chunkIndex == rd.APIEvent.NoChunk:
                continue
            chunk = self.file.chunks[event.chunkIndex]
            bound |= chunk.name.startswith(BINDS_FRAMEBUFFER)
            self.clears.add(chunk)
            self.region = region_of(chunk) or self.region
            if chunk.name == "glActiveTexture":
                self.unit = bits(chunk)
            elif not NO_STATE.search(chunk.name):
                sampling = SAMPLING.search(chunk.name)
                name = chunk.name.replace("Enable", "").replace("Disable", "")
                arguments = children(chunk)
                place = tuple(bits(item) for item in arguments if item.name in PLACES)
                value = (chunk.name, *map(bits, arguments))
                (self.sampling if sampling else self.state)[(name, place, sampling and self.unit)] = value
        return bound

    def keys(self) -> tuple[int, int]:
        """Of the state, and of what is sampled with it."""
        return hash(frozenset(self.state.items())), hash(frozenset(self.sampling.items()))


def children(chunk: Any) -> list[Any]:
    return [chunk.GetChild(at) for at in range(chunk.NumChildren())]


def child(chunk: Any, *names: str) -> Any:
    for name in names:
        chunk = chunk.FindChild(name)
    return chunk


def number(item: Any) -> float:
    return float(item.data.basic.d if item.type.basetype == rd.SDBasic.Float else item.data.basic.u)


def numbers(chunk: Any) -> list[float]:
    return [number(item) for item in children(chunk) if item.type.basetype in (rd.SDBasic.Float, rd.SDBasic.UnsignedInteger, rd.SDBasic.SignedInteger)]


def colour(at: int) -> str:
    return f"colour {at}" if at else "colour"


class Clears:
    """What a frame's calls clear to, as far as they tell: `colour` of the first target, `colour 1` of the next."""

    def __init__(self, file: Any):
        self.own: dict[str, list[float]] = {}  # in OpenGL's state, first that before the frame
        for begin in [chunk.FindChild("state") for chunk in file.chunks if chunk.name == "Internal::Beginning of Capture"]:
            for key in CLEARED if begin else ():
                item = begin.FindChild(f"GL_{key.replace('colour', 'color').upper()}_CLEAR_VALUE")
                self.own.update({key: numbers(item) or [number(item)]} if item else {})
        self.now: dict[str, list[float]] = {}  # by the current action
        self.attachments = {int(child(chunk, "RenderPass").AsResourceId()): child(chunk, "CreateInfo")
                            for chunk in file.chunks if chunk.name.startswith("vkCreateRenderPass")}

    def add(self, chunk: Any) -> None:
        if re.fullmatch("glClear(Color|Depthf?|Stencil)", chunk.name):
            self.own[chunk.name[7:].rstrip("f").lower().replace("color", "colour")] = numbers(chunk)
        elif chunk.name == "glClear":
            mask = child(chunk, "mask").data.basic.u
            self.now |= {key: self.own[key] for key, bit in CLEARED.items() if mask & bit and key in self.own}
        elif re.match("glClear(Buffer|NamedFramebuffer)[fiu]", chunk.name):
            kind, values = child(chunk, "buffer").data.basic.u, chunk.FindChild("value")
            key = {GL_COLOR: colour(child(chunk, "drawbuffer").data.basic.u), GL_COLOR + 2: "stencil"}.get(kind, "depth")
            self.now |= {item.name: [number(item)] for item in children(chunk) if item.name in CLEARED}
            self.now |= {key: numbers(values)} if values and values.NumChildren() else {}
        elif chunk.name.startswith("vkCmdBeginRendering"):
            begin = child(chunk, "pRenderingInfo")
            places = [("depth", child(begin, "pDepthAttachment")), ("stencil", child(begin, "pStencilAttachment"))]
            places += [(colour(at), item) for at, item in enumerate(children(child(begin, "pColorAttachments")))]
            for key, item in places:
                if item.NumChildren() and child(item, "loadOp").data.basic.u == VK_CLEARS:
                    self.vulkan(key, child(item, "clearValue"))
        elif chunk.name.startswith("vkCmdBeginRenderPass"):
            self.render_pass(child(chunk, "RenderPassBegin"))
        elif chunk.name == "vkCmdClearColorImage":
            self.now["colour"] = numbers(child(chunk, "Color", "float32"))
        elif chunk.name == "vkCmdClearAttachments":
            for item in children(child(chunk, "pAttachments")):
                mask = child(item, "aspectMask").data.basic.u
                for key, bit in ((colour(child(item, "colorAttachment").data.basic.u), 1), ("depth", 2), ("stencil", 4)):
                    if mask & bit:
                        self.vulkan(key, child(item, "clearValue"))

    def render_pass(self, begin: Any) -> None:
        info, values = self.attachments.get(int(child(begin, "renderPass").AsResourceId())), children(child(begin, "pClearValues"))
        passes = children(child(info, "pSubpasses")) if info else []
        attachments = children(child(info, "pAttachments")) if info else []
        places = [child(item, "attachment").data.basic.u for item in children(child(passes[0], "pColorAttachments"))] if passes else []
        for at, (attachment, value) in enumerate(zip(attachments, values)):
            depth = child(attachment, "format").data.basic.u in VK_DEPTHS
            for key, load in (("depth", "loadOp"), ("stencil", "stencilLoadOp")) if depth else ((colour(at), "loadOp"),):
                key = key if depth else colour(places.index(at)) if at in places else ""
                if key and child(attachment, load).data.basic.u == VK_CLEARS:
                    self.vulkan(key, value)

    def vulkan(self, key: str, value: Any) -> None:
        self.now[key] = numbers(child(value, "color", "float32")) if key.startswith("colour") else [number(child(value, "depthStencil", key))]


class Grouping:
    """Makes passes of actions in order."""

    def __init__(self, frame: "Frame", each_draw: range):
        self.textures, self.buffers, self.calls, self.each_draw = frame.textures, frame.buffers, Calls(frame.file), each_draw
        # Targets that the action does not tell: of glGenerateMipmap, and what the end of a render pass resolves into.
        self.untold = {use.eventId: number for number, texture in frame.textures.items()
                       for use in frame.control.GetUsage(texture.resourceId)
                       if use.usage in (rd.ResourceUsage.GenMips, rd.ResourceUsage.ResolveDst)}
        self.passes: list[Pass] = []
        self.current: Pass | None = None
        self.runs = 0
        self.render_pass: tuple[int, ...] | None = None
        self.without_target = 0
        self.cleared: dict[str, tuple[set[int], list[float]]] = {}  # targets, and the values
        self.bound = False

    def close(self) -> None:
        if self.current:
            self.passes.append(self.current)
        self.current = None

    def alone(self, kind: str, targets: tuple[int, ...], where: list[str], action: Any, same_run: bool = False) -> None:
        self.close()
        self.runs += not same_run
        self.current = Pass(self.runs, kind, targets, where, action)
        self.current.add(action, self.calls.keys())

    def draw(self, action: Any, where: list[str]) -> None:
        targets = (*map(int, action.outputs), int(action.depthOut))
        if not any(targets) and self.render_pass:  # RenderDoc 1.24 tells none of draws in secondary command buffers
            targets = self.render_pass
        if not any(targets):
            self.without_target += 1
            return
        current = self.current
        same_run = not self.bound and current is not None and (current.kind, current.targets) == ("draw", targets)
        if current and same_run and current.where == where and action.eventId not in self.each_draw:
            current.add(action, self.calls.keys())
        else:
            self.alone("draw", targets, where, action, same_run)
        own = {key: self.cleared.pop(key)[1] for key in list(self.cleared) if self.cleared[key][0] & set(targets)}
        if self.current and len(self.current.draws) == 1:
            self.current.clears = own
        self.bound = False

    def copy(self, action: Any, where: list[str]) -> None:
        target, source = int(action.copyDestination) or self.untold.get(action.eventId, 0), int(action.copySource)
        if target not in self.textures or source in self.buffers:  # an upload: the input of its reader
            return
        mips = bool(action.flags & FLAGS.GenMips) or (source == target and self.textures[target].mips > 1)
        samples = source in self.textures and self.textures[source].msSamp > 1  # RenderDoc calls all blits so
        kind = "mips" if mips else "copy" if not action.flags & FLAGS.Resolve else "resolve" if samples else "blit"
        if mips and self.current and (self.current.kind, self.current.targets) == ("mips", (target, NULL)):
            self.current.add(action, self.calls.keys())
        else:
            self.alone(kind, (target, NULL), where, action)
            if self.current and self.calls.region and kind in ("blit", "resolve"):
                heights = [self.textures[item].height if item in self.textures else 0 for item in (source, target)]
                self.current.region = [*self.calls.region, [float(height) for height in heights]]

    def add(self, action: Any, where: list[str]) -> None:
        flags = action.flags
        if flags & FLAGS.BeginPass:
            self.render_pass = (*map(int, action.outputs), int(action.depthOut))
        if flags & FLAGS.EndPass:
            self.render_pass = None
        self.bound |= self.calls.add(action) and self.current is not None and self.current.kind == "draw"
        into = {int(action.copyDestination), *map(int, action.outputs), int(action.depthOut)} - {NULL}
        self.cleared |= {key: (into, value) for key, value in self.calls.clears.now.items()}
        cleared = bool(flags & FLAGS.Clear) and self.current and int(action.copyDestination) in self.current.targets
        if flags & (FLAGS.BeginPass | FLAGS.EndPass) or cleared:
            self.close()
            if flags & FLAGS.EndPass and action.eventId in self.untold:
                self.alone("resolve", (self.untold[action.eventId], NULL), where, action)
        elif flags & FLAGS.Drawcall:
            self.draw(action, where)
        elif flags & FLAGS.Dispatch:
            self.alone("dispatch", (), where, action)
        elif flags & COPIES:
            self.copy(action, where)


# ---- Contents ------------------------------------------------------------------------------------


def shared_memory(file: Any, resources: dict[int, Any]) -> dict[int, set[int]]:
    """Resources whose memory overlaps, as far as Vulkan's binds and OpenGL's views tell."""
    ranges: dict[int, list[tuple[int, int, int]]] = {}
    same: dict[int, set[int]] = {}

    def number(chunk: Any, name: str) -> int:
        found = chunk.FindChild(name)
        return 0 if found is None else int(found.AsResourceId()) if found.type.basetype == rd.SDBasic.Resource else found.AsInt()

    for chunk in file.chunks:
        if chunk.name.startswith(("vkBindImageMemory", "vkBindBufferMemory")):
            several = chunk.FindChild("pBindInfos")
            for bind in [chunk] if several is None else children(several):
                resource, offset = number(bind, "image") or number(bind, "buffer"), number(bind, "memoryOffset")
                if resource in resources:
                    size = getattr(resources[resource], "byteSize", 0) or resources[resource].length
                    ranges.setdefault(number(bind, "memory"), []).append((offset, offset + size, resource))
        elif chunk.name.startswith("glTextureView"):
            views = ranges.setdefault(-number(chunk, "origtexture"), [(0, 1, number(chunk, "origtexture"))])
            views.append((0, 1, number(chunk, "texture")))
    for items in ranges.values():
        for low, high, resource in items:
            same.setdefault(resource, set()).update(other for start, end, other in items if start < high and low < end)
    return same


class Frame:
    """An open capture, and what is written of it."""

    def __init__(self, control: Any, folder: str):
        self.control, self.folder, self.file = control, folder, control.GetStructuredFile()
        self.gl = control.GetAPIProperties().pipelineType == rd.GraphicsAPI.OpenGL
        self.textures = {int(item.resourceId): item for item in control.GetTextures()}
        self.buffers = {int(item.resourceId): item for item in control.GetBuffers()}
        self.labels = {int(item.resourceId): item.name for item in control.GetResources() if not item.autogeneratedName}
        self.opened = True  # and no event is replayed
        # RenderDoc 1.24 reads samples from lavapipe once, and dies at an event behind.
        self.samples = self.gl or control.GetAPIProperties().vendor != rd.GPUVendor.Software
        self.notes: list[str] = []
        self.small: dict[str, np.ndarray] = {}
        self.bytes = 0

    def keep(self, data: bytes, suffix: str = ".raw") -> str:
        """The name of the file, which is made of the content's hash: equal contents are one file."""
        name = hashlib.sha256(data).hexdigest()[:24] + suffix
        path = os.path.join(self.folder, name)
        if not os.path.exists(path):
            with open(path, "wb") as file:
                file.write(data)
            self.bytes += len(data)
        return name

    def label(self, resource: int) -> str:
        text = self.labels.get(resource, "")
        return "" if "/" in text or text.startswith("Backbuffer") else re.sub(r"\W+", "_", text).strip("_")

    def layers(self, texture: Any, mip: int) -> Iterator[bytes]:
        depth = max(1, texture.depth >> mip)
        for layer in range(texture.arraysize):
            for sample in range(max(1, texture.msSamp)):
                raw = bytes(self.control.GetTextureData(texture.resourceId, rd.Subresource(mip, layer, sample)))
                size = len(raw) // depth
                yield from (raw[at * size:(at + 1) * size] for at in range(depth))

    def image(self, resource: int, slot: str, mip: int) -> Json | None:
        texture = self.textures[resource]
        width, height = max(1, texture.width >> mip), max(1, texture.height >> mip)
        count = max(1, texture.depth >> mip) * texture.arraysize
        if texture.byteSize > MOST_BYTES:
            self.notes.append(f"{slot}: {texture.byteSize >> 20} MiB, left out")
            return None
        hashes, first = [], None  # type: list[list[bytes]], Any
        draft = os.path.join(self.folder, "draft")
        with open(draft, "wb") as file:
            for raw in self.layers(texture, mip):
                texels = texels_of(texture.format, raw, width, height, self.gl)
                if texels is None:  # of blocks, say: bytes tell whether it is the same
                    words = self.words(b"".join(self.layers(texture, mip)), resource, slot)
                    return words and {**words, "mip": mip}
                first = first or texels
                rows = np.ascontiguousarray(texels.rows)
                file.write(rows.data)
                hashes.append(hashes_of(rows))
        name, turned = names_of(hashes)
        if not first:
            return None
        if name not in self.small:
            self.small[name] = small_picture(first.format, first.rows)
            self.bytes += os.path.getsize(draft)
            os.rename(draft, os.path.join(self.folder, name))
        screen = bool(texture.creationFlags & rd.TextureCategory.SwapBuffer)
        entry = {"kind": "image", "resource": slot, "file": name, "mip": mip, "width": width, "height": height, "layers": count,
                 "format": first.format, "turned": turned, "label": self.label(resource), "screen": screen, "id": resource}
        return {**entry, "samples": texture.msSamp} if texture.msSamp > 1 else entry

    def buffer(self, resource: int, slot: str, span: list[int]) -> Json | None:
        """The part that the shader sees."""
        start, buffer = span[0], self.buffers[resource]
        size = min(span[1] or buffer.length, buffer.length - start)
        data = bytes(self.control.GetBufferData(buffer.resourceId, start, size)) if 0 < size <= MOST_BYTES else b""
        return self.words(data, resource, slot)

    def words(self, data: bytes, resource: int, slot: str) -> Json | None:
        data = data[:len(data) & ~3]
        if not data:
            return None
        name = self.keep(data)
        self.small.setdefault(name, np.frombuffer(data[:16384], "<u4").astype("f4"))
        return {"kind": "buffer", "resource": slot, "file": name, "turned": name, "stride": 4, "count": len(data) // 4,
                "fields": [{"name": "", "type": "uint", "offset": 0}], "label": self.label(resource), "screen": False, "id": resource}

    def content(self, resource: int, slot: str, mip: int, span: list[int]) -> Json | None:
        slot = slot or self.label(resource) or "content"
        return self.image(resource, slot, mip) if resource in self.textures else self.buffer(resource, slot, span)

    # ---- When ------------------------------------------------------------------------------------

    def fate(self, resource: int, after: int, same: dict[int, set[int]]) -> tuple[int, bool]:
        """The event that next writes it, and whether it is discarded with nobody having read it. Opening a capture discards nothing."""
        known = {**self.textures, **self.buffers}
        used = sorted((use.eventId, use.usage.name) for item in {resource} | same.get(resource, set()) if item in known
                      for use in self.control.GetUsage(known[item].resourceId) if use.eventId > after and use.usage.name != "Barrier")
        written = [(event, usage) for event, usage in used if any(word in usage for word in WRITES) and not usage.endswith("Src")]
        if not written or (self.opened and all(usage == "Discard" for _, usage in written)):
            return NEVER, False
        return written[0][0], used[0][1] == "Discard"

    def stops(self, looked: list[Json]) -> dict[int, list[tuple[list[Any], int]]]:
        """As few events as there can be, with the contents to read there: a pass's list, and a place in it. What is discarded unread is
        left out where it needs many."""
        same, jobs = shared_memory(self.file, {**self.textures, **self.buffers}), []
        for item in looked:
            for key in ("entries", "inputs"):
                jobs += [(*self.fate(what["id"], item["last"], same), item, key, at) for at, what in enumerate(item[key])]
        jobs.sort(key=lambda job: job[0])
        chosen: list[int] = []
        for discards in (True, False):
            if not discards and len(chosen) <= MOST_STOPS:
                break
            chosen = [-1]
            for end, discarded, item, *_ in jobs:
                if chosen[-1] < item["last"] and (discards or not discarded):
                    last = max(other["last"] for other in looked if other["last"] < end)
                    chosen.append(OPENED if self.opened and end == NEVER else last)
        found: dict[int, list[tuple[list[Any], int]]] = {OPENED: []}
        left_out = {}  # type: dict[str, set[int]]
        for end, _, item, key, at in jobs:
            stop = next((event for event in reversed(chosen) if item["last"] <= event < end), None)
            texture = self.textures.get(item[key][at]["id"])
            if stop is None or (texture and texture.msSamp > 1 and not self.samples):  # there is what samples are resolved into
                why = "single samples, which end RenderDoc on lavapipe" if stop else "what they discard themselves, as a rule depth"
                left_out.setdefault(why, set()).add(item["index"])
                item["left_out"].append(item[key][at]["slot"])
                item[key][at] = None
            else:
                found.setdefault(stop, []).append((item[key], at))
        self.notes += [f"of {len(passes)} passes, {why}, is left out" for why, passes in left_out.items()]
        return found

    def read(self, looked: list[Json]) -> None:
        """Puts contents in the places of those that are wanted."""
        at_event = OPENED
        for event, wanted, at in progress([(event, *job) for event, jobs in self.stops(looked).items() for job in jobs], "contents"):
            if event != at_event:
                self.control.SetFrameEvent(event, False)
                at_event = event
            wanted[at] = self.content(*(wanted[at][key] for key in ("id", "slot", "mip", "span")))
        for item in looked:
            for key in ("entries", "inputs"):
                item[key] = [content for content in item[key] if content]

    # ---- A pass ----------------------------------------------------------------------------------

    def targets(self, made: Pass, state: Any) -> Iterator[tuple[str, int, int]]:
        """Slot, resource and mip."""
        if made.kind == "mips":
            yield from (("color0", made.targets[0], mip) for mip in range(self.textures[made.targets[0]].mips))
            return
        bound = [*state.GetOutputTargets(), state.GetDepthTarget()] if made.kind == "draw" else []
        mips = {int(item.resourceId): item.firstMip for item in bound}
        for at, resource in enumerate(made.targets):
            if resource in self.textures:
                slot = "depth" if at == len(made.targets) - 1 else f"color{at}"
                yield slot, resource, mips.get(resource, 0)

    def look(self, made: Pass, index: int, chosen: list[int], known: set[int]) -> Json:
        """State of a pass, and which contents are to be read; `chosen`: of each draw, that one which is looked at for its state; `known`:
        resources that passes before wrote or read."""
        states, wanted, inputs = [], {}, {}  # type: list[Json], dict[tuple[int, int], str], dict[int, str]
        levels: dict[int, int] = {}
        spans: dict[int, set[tuple[int, int]]] = {}
        for at in sorted(set(chosen) - {-1}):
            self.control.SetFrameEvent(made.draws[at].eventId, False)
            if made.kind in ("draw", "dispatch"):
                own = rdc_state.state_of(self.control, self.gl, made.kind, self.textures)
                streams = rdc_state.streams(self.control, made.draws[at]) if made.kind == "draw" else ()
                kept = {name: [self.keep(rows.astype("<f4").tobytes()), rows.shape[1]] for name, rows in streams}
                states.append({"draw": at, **own, "streams": kept})
            state = self.control.GetPipelineState()
            bindings = list(rdc_state.bindings(self.control, state, made.kind, self.gl))
            for slot, resource, mip in [*self.targets(made, state), *((name, item, 0) for name, item, stores in bindings if stores)]:
                wanted.setdefault((resource, mip), slot)
            for name, resource, stores in bindings:
                if not stores and (resource in self.textures or resource in self.buffers):
                    inputs.setdefault(resource, name)
            for resource, span in rdc_state.spans(self.control, made.kind, self.gl):
                spans.setdefault(resource, set()).add(span)
            for resource, last in rdc_state.last_levels(self.control, state, made.kind, self.gl, self.textures):
                levels[resource] = max(last, levels.get(resource, 0))
        if made.kind == "draw" and any(made.targets[:-1]) and -1 not in chosen and not any("depth format" in item["state"] for item in states):
            wanted = {key: slot for key, slot in wanted.items() if key[0] != made.targets[-1]}  # no draw uses it
        seen = {resource: list(*found) for resource, found in spans.items() if len(found) == 1}
        known |= {resource for resource, _ in wanted}
        reads = {name: resource for resource, name in inputs.items() if resource in known}
        inputs = {resource: name for resource, name in inputs.items() if resource not in known}
        known.update(inputs)
        shaders = [{"stage": stage, "entry": entry, "file": self.keep(code, suffix)}
                   for stage, entry, code, suffix in rdc_state.shaders(state, made.kind)]
        counts = [list(action.dispatchDimension) if made.kind == "dispatch" else [action.numIndices, action.numInstances]
                  for action in made.draws]
        return {"index": index, "run": made.run, "kind": made.kind, "where": made.where, "first": made.first, "last": made.last,
                "draws": len(made.draws), "counts": counts, "states": states, "chosen": chosen, "shaders": shaders, "left_out": [],
                "clears": made.clears, "region": made.region, "reads": reads,
                "entries": [{"id": resource, "mip": mip, "slot": slot, "span": seen.get(resource, [0, 0])}
                            for (resource, mip), slot in wanted.items()],
                "inputs": [{"id": resource, "mip": mip, "slot": name, "span": seen.get(resource, [0, 0])}
                           for resource, name in inputs.items() for mip in range(levels.get(resource, 0) + 1)]}

    def look_at(self, passes: list[Pass], most: float = math.inf) -> list[Json]:
        """Nothing, if it takes too many seconds of a processor."""
        chosen, self.opened, end = choose(passes), False, time.process_time() + most
        known: set[int] = set()
        looked: list[Json] = []
        for made in progress(passes, "passes"):
            looked.append(self.look(made, len(looked), chosen[len(looked)], known))
            if time.process_time() > end:
                return []
        return looked


def choose(passes: list[Pass]) -> list[list[int]]:
    """Of each draw of each pass, that draw of the pass which is looked at for its state, or -1: the last; then one of each state, then
    those that sample with other textures, then others, in order."""
    order, looked = [], [{len(made.draws) - 1} for made in passes]
    for index, made in enumerate(passes):
        seen: set[Any] = set()
        for at, keys in enumerate(made.keys if made.kind in ("draw", "dispatch") else []):
            order.append((2 - (keys not in seen) - (keys[0] not in seen), at & (at - 1) != 0, index, at))
            seen |= {keys, keys[0]}
    for *_, index, at in sorted(order)[:MOST_LOOKS]:
        looked[index].add(at)
    chosen = []
    for made, own in zip(passes, looked):
        first: dict[int, int] = {}
        for at in sorted(own):
            first.setdefault(made.keys[at][0], at)
        chosen.append([at if at in own else first.get(keys[0], -1) for at, keys in enumerate(made.keys)])
    return chosen


# ---- The process ---------------------------------------------------------------------------------


def start_screen() -> None:
    """OpenGL is replayed on an X server of its own, where there is none."""
    if os.environ.get("DISPLAY"):
        return
    reading, writing = os.pipe()
    try:
        STARTED.append(subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", "64x64x24", "-nolisten", "tcp"],
                                        pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
    except OSError:
        fail("a capture of OpenGL is replayed on an X server; install the package xvfb")
    os.close(writing)
    os.environ["DISPLAY"] = ":" + os.read(reading, 16).decode().strip()


def open_file(path: str) -> Any:
    rd.InitialiseReplay(rd.GlobalEnvironment(), [])
    capture = rd.OpenCaptureFile()
    result = capture.OpenFile(path, "", None)
    if result != rd.ResultCode.Succeeded:
        fail(f"is no whole capture of RenderDoc: {result.Message()}")
    driver = str(capture.DriverName())
    if driver == "OpenGL":
        start_screen()
    if driver not in ("OpenGL", "Vulkan"):
        fail(f"is a capture of {driver}; those of OpenGL and Vulkan are read")
    return capture


def replayed(capture: Any, level: Any = rd.ReplayOptimisationLevel.Balanced) -> Any:
    options = rd.ReplayOptions()
    options.optimisation = level
    result, control = capture.OpenCapture(options, None)
    if result != rd.ResultCode.Succeeded:
        fail(f"cannot be replayed: {result.Message()}")
    return control


def grouped(frame: Frame, each_draw: str) -> tuple[list[Pass], list[str]]:
    """Passes, and what is to be said of them."""
    first, last = map(int, each_draw.split("-")) if each_draw else (0, -1)
    grouping = Grouping(frame, range(first, last + 1))
    for action, where in leaves(frame.control.GetRootActions(), frame.file, []):
        grouping.add(action, where)
    grouping.close()
    notes = [f"{grouping.without_target} draws without a target, left out"] if grouping.without_target else []
    return [made for made in grouping.passes if not each_draw or first <= made.first <= made.last <= last], notes


def look(path: str, folder: str, each_draw: str) -> None:
    """The child: leaves looked.json."""
    frame = Frame(replayed(open_file(path), rd.ReplayOptimisationLevel.Fastest), folder)
    with open(os.path.join(folder, "looked.json"), "w", encoding="utf-8") as output:
        output.write(json.dumps(frame.look_at(grouped(frame, each_draw)[0])))


def looked_by_child(words: list[str]) -> list[Json]:
    child = subprocess.Popen([sys.executable, "-m", "diptych.rdc.replay", *words, "look"], env={**os.environ, "LP_NO_RAST": "1"},
                             stdout=subprocess.DEVNULL)
    STARTED.append(child)
    if child.wait():
        leave(child.returncode if child.returncode > 0 else 128 - child.returncode)
    with open(os.path.join(words[1], "looked.json"), encoding="utf-8") as stored:
        looked: list[Json] = json.load(stored)
    return looked


def main(path: str, folder: str, each_draw: str, child: str = "") -> None:
    if child:
        return look(path, folder, each_draw)
    capture = open_file(path)
    large = sum(capture.GetSectionProperties(at).uncompressedSize for at in range(capture.GetSectionCount())) > LARGE
    looked = looked_by_child([path, folder, each_draw]) if large else None
    frame = Frame(replayed(capture), folder)
    passes, notes = grouped(frame, each_draw)
    looked = looked or frame.look_at(passes, SECONDS_OF_LOOKS) or looked_by_child([path, folder, each_draw])
    frame.read(looked)
    np.savez(os.path.join(folder, "small.npz"), **frame.small)
    with open(os.path.join(folder, "frame.json"), "w", encoding="utf-8") as output:
        output.write(json.dumps({  # dump() takes ten times as long
            "api": str(capture.DriverName()), "renderdoc": rd.GetVersionString(), "device": rdc_state.device_of(frame.file),
            "passes": looked, "notes": frame.notes + notes, "samples": frame.samples, "bytes": frame.bytes}))


def run(work: Callable[..., None]) -> NoReturn:
    """The process, also of alone.py."""
    try:
        work(*sys.argv[1:])
        leave(0)
    except MemoryError:
        fail("needs more memory than the replay is given")
    except Exception as error:
        fail(f"cannot be read: {type(error).__name__}: {error}")


if __name__ == "__main__":
    run(main)
