"""Replays a capture of RenderDoc: `python3 -m diptych.rdc.replay CAPTURE FOLDER DRAWS`, a process that `compare` starts, as a rule in a
sandbox. Leaves FOLDER/frame.json, one raw file per content, and small.npz, small pictures that passes are matched by.

A pass is a run of draws into the same targets, a dispatch, a copy, or a chain of mips. DRAWS is the number of a pass whose draws
are passes of their own, or empty. A failure is told on stderr; the process then ends with os._exit, since RenderDoc hangs in exit."""
from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
import time
from typing import Any, Callable, Iterator, NoReturn

import numpy as np
import renderdoc as rd

from . import state as rdc_state
from .texels import small_picture, texels_of

Json = dict[str, Any]
FLAGS = rd.ActionFlags
COPIES = FLAGS.Copy | FLAGS.Resolve | FLAGS.GenMips
SHOWN = FLAGS.Drawcall | FLAGS.Dispatch | FLAGS.Clear | FLAGS.BeginPass | FLAGS.EndPass | COPIES
NULL = int(rd.ResourceId.Null())
MOST_BYTES = 1 << 30   # of one content
MOST_ALL_DRAWS = 64    # draws of a frame, up to which state is read at each
SECONDS_OF_PROGRESS = 5.0
SERVERS: list[subprocess.Popen[bytes]] = []  # of X


def leave(status: int) -> NoReturn:
    for server in SERVERS:
        server.kill()
    os._exit(status)


def fail(text: str) -> NoReturn:
    print(text, file=sys.stderr, flush=True)
    leave(2)


def name_of(text: str) -> str:
    return re.sub(r"\W+", "_", text).strip("_")


# ---- Passes --------------------------------------------------------------------------------------


class Pass:
    """Events `first` to `last`; `targets`: ids of colours, and of depth at the end; 0: none."""

    def __init__(self, number: int, kind: str, targets: tuple[int, ...], where: list[str], action: Any):
        self.number, self.kind, self.targets, self.where = number, kind, targets, where
        self.first = self.last = action.eventId
        self.draws: list[Any] = []

    def add(self, action: Any) -> None:
        self.draws.append(action)
        self.last = action.eventId


def leaves(actions: Any, file: Any, where: list[str]) -> Iterator[tuple[Any, list[str]]]:
    """Actions with the names of the markers around them."""
    inside = FLAGS.PassBoundary | FLAGS.CmdList | FLAGS.CommandBufferBoundary
    for action in actions:
        if action.children:
            marker = bool(action.flags & FLAGS.PushMarker) and not action.flags & inside
            name = [action.customName or action.GetName(file)] if marker else []
            yield from leaves(action.children, file, where + name)
        if action.flags & SHOWN:
            yield action, where


def binds_framebuffer(action: Any, file: Any) -> bool:
    """Whether OpenGL's state of targets was changed since the action before: mips of one texture are passes of their own."""
    names = (file.chunks[event.chunkIndex].name for event in action.events if event.chunkIndex != rd.APIEvent.NoChunk)
    return any(name.startswith(("glBindFramebuffer", "glFramebufferTexture", "glNamedFramebufferTexture")) for name in names)


class Grouping:
    """Makes passes of actions in order."""

    def __init__(self, textures: dict[int, Any], buffers: dict[int, Any], file: Any, each_draw: int):
        self.textures, self.buffers, self.file, self.each_draw = textures, buffers, file, each_draw
        self.passes: list[Pass] = []
        self.current: Pass | None = None
        self.count = 0
        self.render_pass: tuple[int, ...] | None = None
        self.without_target = 0
        self.bound = False

    def close(self) -> None:
        if self.current:
            self.passes.append(self.current)
        self.current = None

    def alone(self, kind: str, targets: tuple[int, ...], where: list[str], action: Any) -> None:
        self.close()
        self.current = Pass(self.count, kind, targets, where, action)
        self.current.add(action)
        self.count += 1

    def draw(self, action: Any, where: list[str]) -> None:
        targets = (*map(int, action.outputs), int(action.depthOut))
        if not any(targets) and self.render_pass:  # RenderDoc 1.24 tells none of draws in secondary command buffers
            targets = self.render_pass
        if not any(targets):
            self.without_target += 1
            return
        current = self.current
        changed = self.bound or not current or (current.kind, current.targets, current.where) != ("draw", targets, where)
        if changed:
            self.alone("draw", targets, where, action)
        elif current and current.number == self.each_draw:
            self.count -= 1  # a pass of its own, with the number of the whole
            self.alone("draw", targets, where, action)
        elif current:
            current.add(action)
        self.bound = False

    def copy(self, action: Any, where: list[str]) -> None:
        target, source = int(action.copyDestination), int(action.copySource)
        if target not in self.textures or source in self.buffers:  # an upload: the input of its reader
            return
        mips = bool(action.flags & FLAGS.GenMips) or (source == target and self.textures[target].mips > 1)
        kind = "mips" if mips else "resolve" if action.flags & FLAGS.Resolve else "copy"
        if mips and self.current and (self.current.kind, self.current.targets) == ("mips", (target, NULL)):
            self.current.add(action)
        else:
            self.alone(kind, (target, NULL), where, action)

    def add(self, action: Any, where: list[str]) -> None:
        flags = action.flags
        if flags & FLAGS.BeginPass:
            self.render_pass = (*map(int, action.outputs), int(action.depthOut))
        if flags & FLAGS.EndPass:
            self.render_pass = None
        if self.current and self.current.kind == "draw" and binds_framebuffer(action, self.file):
            self.bound = True
        cleared = bool(flags & FLAGS.Clear) and self.current and int(action.copyDestination) in self.current.targets
        if flags & (FLAGS.BeginPass | FLAGS.EndPass) or cleared:
            self.close()
        elif flags & FLAGS.Drawcall:
            self.draw(action, where)
        elif flags & FLAGS.Dispatch:
            self.alone("dispatch", (), where, action)
        elif flags & COPIES:
            self.copy(action, where)


# ---- Contents ------------------------------------------------------------------------------------


class Frame:
    """An open capture, and what is written of it."""

    def __init__(self, control: Any, folder: str):
        self.control, self.folder = control, folder
        self.gl = control.GetAPIProperties().pipelineType == rd.GraphicsAPI.OpenGL
        self.textures = {int(item.resourceId): item for item in control.GetTextures()}
        self.buffers = {int(item.resourceId): item for item in control.GetBuffers()}
        self.labels = {int(item.resourceId): item.name for item in control.GetResources() if not item.autogeneratedName}
        self.written: set[int] = set()
        self.seen: set[int] = set()
        self.notes: list[str] = []
        self.small: dict[str, np.ndarray] = {}
        self.bytes = 0

    def keep(self, data: bytes, suffix: str = ".raw") -> str:
        """The name of the file, which is made of the content's hash: equal contents are one file."""
        name = hashlib.blake2b(data, digest_size=12).hexdigest() + suffix
        path = os.path.join(self.folder, name)
        if not os.path.exists(path):
            with open(path, "wb") as file:
                file.write(data)
            self.bytes += len(data)
        return name

    def label(self, resource: int) -> str:
        text = self.labels.get(resource, "")
        return "" if "/" in text or text.startswith("Backbuffer") else name_of(text)

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
        hashes, first = [hashlib.blake2b(digest_size=12) for _ in range(2)], None
        draft = os.path.join(self.folder, "draft")
        with open(draft, "wb") as file:
            for raw in self.layers(texture, mip):
                texels = texels_of(texture.format, raw, width, height, self.gl)
                if texels is None:
                    self.notes.append(f"{slot}: no content of the format {texture.format.Name()}, left out")
                    return None
                first = first or texels
                rows = np.ascontiguousarray(texels.rows)
                file.write(rows.data)
                lines = [hashlib.blake2b(row.data, digest_size=12).digest() for row in rows]
                hashes[0].update(b"".join(lines))
                hashes[1].update(b"".join(reversed(lines)))
        name, turned = (item.hexdigest() + ".raw" for item in hashes)
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

    def buffer(self, resource: int, slot: str) -> Json | None:
        buffer = self.buffers[resource]
        data = bytes(self.control.GetBufferData(buffer.resourceId, 0, 0)) if buffer.length <= MOST_BYTES else b""
        data = data[:len(data) & ~3]
        if not data:
            return None
        name = self.keep(data)
        self.small.setdefault(name, np.frombuffer(data[:16384], "<u4").astype("f4"))
        return {"kind": "buffer", "resource": slot, "file": name, "turned": name, "stride": 4, "count": len(data) // 4,
                "fields": [{"name": "", "type": "uint", "offset": 0}], "label": self.label(resource), "screen": False, "id": resource}

    def content(self, resource: int, slot: str, mip: int = 0) -> Json | None:
        slot = slot or self.label(resource) or "content"
        return self.image(resource, slot, mip) if resource in self.textures else self.buffer(resource, slot)

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

    def read(self, made: Pass, index: int, all_draws: bool) -> Json:
        events = [action.eventId for action in made.draws] if all_draws and made.kind == "draw" else []
        states = []
        for event in [*events[:-1], made.last]:
            self.control.SetFrameEvent(event, False)
            if made.kind in ("draw", "dispatch"):
                states.append(rdc_state.state_of(self.control, self.gl, made.kind, self.textures))
        state = self.control.GetPipelineState()
        bindings = list(rdc_state.bindings(state, made.kind))
        stored = [(name, resource, 0) for name, resource, stores in bindings if stores]
        wanted: dict[tuple[int, int], str] = {}
        for slot, resource, mip in [*self.targets(made, state), *stored]:
            wanted.setdefault((resource, mip), slot)
        entries = [self.content(resource, slot, mip) for (resource, mip), slot in wanted.items()]
        outputs = {resource for resource, _ in wanted}
        inputs = []
        known = self.written | self.seen | outputs
        for name, resource, stores in bindings:
            if not stores and resource not in known | self.seen and resource in {**self.textures, **self.buffers}:
                self.seen.add(resource)
                inputs.append(self.content(resource, name))
        self.written |= outputs
        shaders = [{"stage": stage, "entry": entry, "file": self.keep(code, suffix)}
                   for stage, entry, code, suffix in rdc_state.shaders(state, made.kind)]
        counts = [[action.numIndices, action.numInstances] for action in made.draws]
        return {"index": index, "kind": made.kind, "where": made.where, "first": made.first, "last": made.last,
                "draws": len(made.draws), "counts": counts, "entries": [entry for entry in entries if entry],
                "inputs": [entry for entry in inputs if entry], "states": states, "shaders": shaders}


# ---- The process ---------------------------------------------------------------------------------


def start_screen() -> None:
    """OpenGL is replayed on an X server of its own, where there is none."""
    if os.environ.get("DISPLAY"):
        return
    reading, writing = os.pipe()
    try:
        SERVERS.append(subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", "64x64x24", "-nolisten", "tcp"],
                                        pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
    except OSError:
        fail("a capture of OpenGL is replayed on an X server; install the package xvfb")
    os.close(writing)
    os.environ["DISPLAY"] = ":" + os.read(reading, 16).decode().strip()


def open_capture(path: str) -> tuple[Any, str]:
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
    result, control = capture.OpenCapture(rd.ReplayOptions(), None)
    if result != rd.ResultCode.Succeeded:
        fail(f"cannot be replayed: {result.Message()}")
    return control, driver


def main(path: str, folder: str, each_draw: str) -> None:
    control, driver = open_capture(path)
    frame = Frame(control, folder)
    grouping = Grouping(frame.textures, frame.buffers, control.GetStructuredFile(), int(each_draw or -1))
    for action, where in leaves(control.GetRootActions(), control.GetStructuredFile(), []):
        grouping.add(action, where)
    grouping.close()
    passes = [made for made in grouping.passes if not each_draw or made.number == int(each_draw)]
    all_draws = sum(len(made.draws) for made in passes) <= MOST_ALL_DRAWS
    told, read = time.monotonic(), []
    for index, made in enumerate(passes):
        read.append(frame.read(made, index, all_draws))
        if time.monotonic() - told > SECONDS_OF_PROGRESS:
            told = time.monotonic()
            print(f"replay: pass {index + 1} of {len(passes)}", file=sys.stderr, flush=True)
    if grouping.without_target:
        frame.notes.append(f"{grouping.without_target} draws without a target, left out")
    np.savez(os.path.join(folder, "small.npz"), **frame.small)
    with open(os.path.join(folder, "frame.json"), "w", encoding="utf-8") as file:
        json.dump({"api": driver, "renderdoc": rd.GetVersionString(), "passes": read, "notes": frame.notes, "bytes": frame.bytes,
                   "device": rdc_state.device_of(control.GetStructuredFile())}, file)


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
