"""`diptych capture`: runs a program under RenderDoc and keeps one frame of it. No keyboard and no window of RenderDoc are needed."""
from __future__ import annotations

import os
import shlex
import shutil
import signal
import tempfile
import time
from typing import Any

from ..console import Console

Json = dict[str, Any]
CONNECTING, WAITING, GRACE, ENDING = 10.0, 120.0, 5.0, 3.0  # seconds
INSTALL = "needs RenderDoc; install the packages renderdoc and python3-renderdoc, or put upstream's renderdoc.so on PYTHONPATH"


def renderdoc(console: Console) -> Any:
    try:
        import renderdoc as module
    except ImportError:
        console.fail(f"{console.verb}: {INSTALL}")
    return module


def variables(rd: Any, command: list[str], settings: list[str]) -> list[Any]:
    """libsixel of mpv calls other functions than RenderDoc's of the same names, unless the library is there first."""
    if os.path.basename(command[0]) == "mpv" and not any(setting.startswith("LD_PRELOAD=") for setting in settings):
        settings = [*settings, "LD_PRELOAD=libstb.so.0"]
    pairs = (setting.split("=", 1) for setting in settings)
    return [rd.EnvironmentModification(rd.EnvMod.Append if name == "LD_PRELOAD" else rd.EnvMod.Set, rd.EnvSep.Platform, name, value)
            for name, value in pairs]


class Run:
    """A program under RenderDoc; `control` is the connection to it."""

    def __init__(self, console: Console, rd: Any, command: list[str], settings: list[str], path: str):
        self.console, self.rd = console, rd
        program = shutil.which(command[0])
        if not program:
            console.fail(f"{command[0]}: no such program")
        options = rd.GetDefaultCaptureOptions()
        options.delayForDebugger = 0
        arguments = " ".join(map(shlex.quote, command[1:]))
        begun = rd.ExecuteAndInject(program, os.getcwd(), arguments, variables(rd, command, settings), path, options, False)
        if not begun.ident:
            console.fail(f"{command[0]}: cannot be started under RenderDoc: {begun.result}")
        self.name, end = command[0], time.monotonic() + CONNECTING
        self.control: Any = None
        while not self.control and time.monotonic() < end:
            self.control = rd.CreateTargetControl("", begun.ident, "diptych", True)
            if self.control is None or not self.control.Connected():
                self.control = None
                time.sleep(0.02)
        if not self.control:
            console.fail(f"{self.name}: ended, or did not answer RenderDoc in {CONNECTING:g} s; does it run without it?")
        self.pid = self.control.GetPID()

    def wait(self, frame: int, after: float) -> str:
        """The path of the capture."""
        kinds, start = self.rd.TargetControlMessageType, time.monotonic()
        apis: dict[str, bool] = {}    # and whether a window shows its pictures
        refused: dict[str, str] = {}  # by API, why RenderDoc cannot capture a window that shows its pictures
        if frame:
            self.control.QueueCapture(frame, 1)
        triggered = bool(frame)
        while self.control.Connected() and time.monotonic() - start < WAITING:
            message = self.control.ReceiveMessage(None)
            if message.type == kinds.RegisterAPI:
                use = message.apiUse
                apis[use.name] = use.presenting or apis.get(use.name, False)
                if use.presenting:
                    why = " ".join(use.supportMessage.split()).replace(": - ", ": ").replace(" - ", ", ")
                    refused = {} if use.supported else {use.name: why}
            elif message.type == kinds.NewCapture:
                return str(message.newCapture.path)
            elif message.type == kinds.Disconnected:
                break
            if refused and time.monotonic() - start > after + GRACE:
                api, why = refused.popitem()
                self.console.fail(f"{self.name}: RenderDoc cannot capture its {api}: {why}; has it an option for a newer version, "
                                  "or for a core profile?")
            if not triggered and time.monotonic() - start > after:
                triggered = True
                self.control.TriggerCapture(1)
        seen = f"it used {', '.join(sorted(apis))}" if apis else "it used neither OpenGL nor Vulkan"
        seen += "" if any(apis.values()) or not apis else ", and showed no picture"
        if self.control.Connected():
            self.console.fail(f"{self.name}: no frame was captured in {WAITING:g} s: {seen}; does it draw that many frames?")
        self.console.fail(f"{self.name}: ended before its frame was captured: {seen}; try another --frame, or --after")

    def end(self) -> None:
        for number, seconds in ((signal.SIGTERM, ENDING), (signal.SIGKILL, 0.0)):
            try:
                os.kill(self.pid, number)
                limit = time.monotonic() + seconds
                while time.monotonic() < limit:
                    os.kill(self.pid, 0)
                    if self.control.Connected():
                        self.control.ReceiveMessage(None)
                    time.sleep(0.02)
            except OSError:
                return


def main(console: Console, request: Json) -> tuple[int, Json]:
    rd, output = renderdoc(console), os.path.abspath(request["output"])
    if os.path.isdir(output) or not os.access(os.path.dirname(output), os.W_OK):
        console.fail(f"{request['output']}: cannot be written: it is a folder, or in no such folder, or no right to write there")
    with tempfile.TemporaryDirectory(dir=os.path.dirname(output), prefix=".capture-") as folder:
        run = Run(console, rd, request["command"], request.get("env", []), os.path.join(folder, "frame"))
        try:
            path = run.wait(request.get("frame", 0), request.get("after", 3.0))
        finally:
            run.end()
        os.replace(path, output)
    console.info(f"{request['output']}: {os.path.getsize(output) / 1e6:.1f} MB")
    return 0, {"bytes": os.path.getsize(output)}
