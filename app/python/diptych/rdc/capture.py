"""`diptych capture`: runs a program under RenderDoc and keeps one frame of it. No keyboard and no window of RenderDoc are needed."""
from __future__ import annotations

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from typing import Any, Callable, Iterator

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


def variables(command: list[str], settings: list[str]) -> dict[str, str]:
    """libsixel of mpv calls other functions than RenderDoc's of the same names, unless the library is there first."""
    found = dict(setting.split("=", 1) for setting in settings)
    return {"LD_PRELOAD": "libstb.so.0", **found} if os.path.basename(command[0]) == "mpv" else found


def zink(settings: dict[str, str]) -> dict[str, str]:
    """The environment of a program whose OpenGL Zink draws with Vulkan, which alone is captured then, or none. Without the first variable,
    Zink on lavapipe shows its pictures past Vulkan."""
    found = {**os.environ, **settings}
    names = "MESA_LOADER_DRIVER_OVERRIDE", "GALLIUM_DRIVER"
    return {**found, names[0]: "zink", "ENABLE_VULKAN_RENDERDOC_CAPTURE": "1"} if any(found.get(name) == "zink" for name in names) else {}


def stat(pid: int) -> tuple[str, int]:
    """Of a process, its state and its parent."""
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
            words = file.read().rsplit(")", 1)[1].split()
        return words[0], int(words[1])
    except (OSError, ValueError, IndexError):
        return "Z", 0


def is_ours(pid: int) -> bool:
    while pid > 1 and pid != os.getpid():
        pid = stat(pid)[1]
    return pid == os.getpid()


def is_wrapper(program: str) -> bool:
    """Whether it is a script of a shell, which starts the program in its own place."""
    with open(program, "rb") as file:
        return bool(re.match(rb"#!.*\b(ba|da)?sh\b", file.readline(128)))


class Run:
    """A program under RenderDoc; `control` is the connection to it."""

    def __init__(self, console: Console, rd: Any, command: list[str], settings: list[str], path: str):
        self.console, self.rd, self.name = console, rd, command[0]
        program, own = shutil.which(command[0]), variables(command, settings)
        environment = zink(own)
        self.control: Any = None
        self.process: subprocess.Popen[bytes] | None = None
        self.pid = 0
        if not program:
            console.fail(f"{command[0]}: no such program")
        if environment:
            self.process = subprocess.Popen([program, *command[1:]], env={**environment, "RENDERDOC_CAPFILE": path}, start_new_session=True)
            self.pid, self.anew = self.process.pid, True
            self.connect(self.targets)
            return
        options = rd.GetDefaultCaptureOptions()
        options.delayForDebugger = 0
        options.hookIntoChildren = self.anew = is_wrapper(program)
        changes = [rd.EnvironmentModification(rd.EnvMod.Append if name == "LD_PRELOAD" else rd.EnvMod.Set, rd.EnvSep.Platform, name, value)
                   for name, value in own.items()]
        begun = rd.ExecuteAndInject(program, os.getcwd(), " ".join(map(shlex.quote, command[1:])), changes, path, options, False)
        if not begun.ident:
            console.fail(f"{command[0]}: cannot be started under RenderDoc: {begun.result}")
        self.connect(lambda: iter([begun.ident]))
        self.pid = self.control.GetPID()

    def alive(self) -> bool:
        return not self.pid or (stat(self.pid)[0] != "Z" if not self.process else self.process.poll() is None)

    def connect(self, targets: Callable[[], Iterator[int]]) -> None:
        """Programs of others keep their connections, and are let go at once."""
        end = time.monotonic() + CONNECTING
        while time.monotonic() < end and self.alive():
            for target in targets():
                control = self.rd.CreateTargetControl("", target, "diptych", False)
                if control and control.Connected() and is_ours(control.GetPID()):
                    self.control = control
                    return
                if control:
                    control.Shutdown()
            time.sleep(0.02)
        self.console.fail(f"{self.name}: ended, or did not answer RenderDoc in {CONNECTING:g} s; does it run without it?")

    def targets(self) -> Iterator[int]:
        """All programs that RenderDoc is in."""
        target = self.rd.EnumerateRemoteTargets("", 0)
        while target:
            yield target
            target = self.rd.EnumerateRemoteTargets("", target)

    def connected(self) -> bool:
        """The driver loads RenderDoc with each instance of Vulkan, and lets it go; a wrapper becomes its program."""
        if self.anew and not self.control.Connected() and self.alive():
            self.connect(self.targets)
        return bool(self.control.Connected())

    def wait(self, frame: int, after: float) -> str:
        """The path of the capture."""
        kinds, start = self.rd.TargetControlMessageType, time.monotonic()
        apis: dict[str, bool] = {}    # and whether a window shows its pictures
        refused: dict[str, str] = {}  # by API, why RenderDoc cannot capture a window that shows its pictures
        asked: Any = None
        triggered: Any = None
        while self.connected() and time.monotonic() - start < WAITING:
            if frame and asked is not self.control:
                asked = self.control
                asked.QueueCapture(frame, 1)
            message = self.control.ReceiveMessage(None)
            if message.type == kinds.RegisterAPI:
                use = message.apiUse
                apis[use.name] = use.presenting or apis.get(use.name, False)
                if use.presenting:
                    why = " ".join(use.supportMessage.split()).replace(": - ", ": ").replace(" - ", ", ")
                    refused = {} if use.supported else {use.name: why}
            elif message.type == kinds.NewCapture:
                return str(message.newCapture.path)
            if refused and time.monotonic() - start > after + GRACE:
                api, why = refused.popitem()
                self.console.fail(f"{self.name}: RenderDoc cannot capture its {api}: {why or 'an old context'}; has it an option for a "
                                  "newer version, or for a core profile? --env MESA_LOADER_DRIVER_OVERRIDE=zink captures it as Vulkan")
            if not frame and triggered is not self.control and time.monotonic() - start > after:
                triggered = self.control
                self.control.TriggerCapture(1)
        seen = f"it used {', '.join(sorted(apis))}" if apis else "it used neither OpenGL nor Vulkan"
        seen += "" if any(apis.values()) or not apis else ", and showed no picture"
        if self.control.Connected():
            why = "does it draw that many frames?" if apis or not self.anew else "is it a script? name the program that it starts"
            self.console.fail(f"{self.name}: no frame was captured in {WAITING:g} s: {seen}; {why}")
        self.console.fail(f"{self.name}: ended before its frame was captured: {seen}; "
                          f"{'try another --frame, or --after' if apis else 'does it run without RenderDoc?'}")

    def end(self) -> None:
        kill = os.killpg if self.process else os.kill
        for number, seconds in ((signal.SIGTERM, ENDING), (signal.SIGKILL, 0.0)):
            try:
                kill(self.pid, number)
                limit = time.monotonic() + seconds
                while time.monotonic() < limit and not (self.process and self.process.poll() is not None):
                    kill(self.pid, 0)
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
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # the program ends with us
        try:
            path = run.wait(request.get("frame", 0), request.get("after", 3.0))
        finally:
            run.end()
        os.replace(path, output)
    console.info(f"{request['output']}: {os.path.getsize(output) / 1e6:.1f} MB")
    return 0, {"bytes": os.path.getsize(output)}
