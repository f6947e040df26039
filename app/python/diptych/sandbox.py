"""What runs shaders of others runs in bubblewrap: it reads the files that drivers need and those that are named, and has no network and
no variables but those that are given. `main` is `diptych replay`: the program runs itself in it."""
from __future__ import annotations

import json
import os
import shutil
import subprocess
from typing import Any, Iterable

from .console import Console, write

READ = ["/usr", "/lib", "/lib64", "/bin", "/etc/vulkan", "/etc/glvnd", "/etc/ld.so.cache", "/etc/alternatives", "/etc/drirc", "/sys"]
DEVICES = ["/dev/dri", "/dev/kfd", "/dev/nvidia0", "/dev/nvidiactl", "/dev/nvidia-uvm", "/dev/nvidia-modeset"]
VARIABLES = ("MESA_", "LIBGL_", "GALLIUM_", "LP_", "VK_", "LVP_", "DIPTYCH_", "LC_", "LANG", "ASAN_")  # that a replay keeps
OPTIONS = ("backend", "device", "context", "glsl", "debug", "sanitize")


def sandbox(read: Iterable[str], variables: dict[str, str]) -> list[str]:
    """The words before a command."""
    words = ["bwrap", "--unshare-all", "--die-with-parent", "--proc", "/proc", "--dev", "/dev", "--tmpfs", "/tmp", "--clearenv"]
    for path in [*READ, *read]:
        words += ["--ro-bind-try", path, path]
    for name, value in variables.items():
        words += ["--setenv", name, value]
    return words


def confines() -> bool:
    """Whether the kernel allows it."""
    words = ["bwrap", "--unshare-all", "--ro-bind", "/", "/", "--proc", "/proc", "--dev", "/dev", "/bin/true"]
    return bool(shutil.which("bwrap")) and subprocess.run(words, capture_output=True, check=False).returncode == 0


def of_drivers() -> list[str]:
    """Folders with the files that the user names to Vulkan's loader."""
    names = [name for variable in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES") for name in os.environ.get(variable, "").split(":")]
    return [os.path.dirname(os.path.realpath(name)) for name in names if os.path.exists(name)]


def confined(own: list[str]) -> list[str]:
    """On this machine's drivers and devices. The working folder is there, and empty."""
    here, kept = os.getcwd(), {name: value for name, value in os.environ.items() if name.startswith(VARIABLES)}
    words = sandbox(["/opt", *of_drivers(), *own], {"HOME": "/tmp", **kept})
    for device in DEVICES:
        words += ["--dev-bind-try", device, device]
    return [*words, "--dir", here, "--chdir", here]


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    folder, program = request["dir"], os.path.realpath(request["program"])
    words = [program, "replay", folder, "--trust"]
    for name in (name for name in OPTIONS if name in request):
        words.append(f"--{name}" if request[name] in (True, "") else f"--{name}={request[name]}")
    told, path = os.memfd_create("told"), request.pop("json", None)
    words += [f"--json=/proc/self/fd/{told}"] if path else []
    if confines():
        words = [*confined([os.path.dirname(program), request["templates"], os.path.realpath(folder)]), *words]
    else:
        why = "the kernel allows bubblewrap none" if shutil.which("bwrap") else "bubblewrap is not installed"
        console.warning(f"{folder}: its shaders run without a sandbox: {why}; --trust says that they may")
    status = subprocess.run(words, stdin=subprocess.DEVNULL, pass_fds=[told], check=False).returncode
    if status < 0:
        console.error(f"{words[0]} was ended by signal {-status}")
        status = 2
    if path:
        text = os.pread(told, os.fstat(told).st_size, 0)
        if text and console.errors:
            result = json.loads(text)
            text = json.dumps({**result, "errors": console.errors + result["errors"]}, indent=1).encode()
        write(path, text)
    return status, {}
