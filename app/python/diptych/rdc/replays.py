"""Starts replay.py and alone.py in a sandbox, for compare.py: one after the other, since a replay of a large frame holds it four
times over, and its driver takes all processors."""
from __future__ import annotations

import os
import resource
import signal
import subprocess
from threading import Timer

from ..console import Console
from ..sandbox import sandbox
from ..verbs import HERE

LIMITS = {resource.RLIMIT_AS: 16 << 30, resource.RLIMIT_CPU: 1800, resource.RLIMIT_FSIZE: 4 << 30}  # of a replay
SECONDS = 900
LAVAPIPE = ["/usr/share/vulkan/icd.d/" + name for name in ("lvp_icd.x86_64.json", "lvp_icd.json", "lvp_icd.aarch64.json")]


def on_mesa(read: list[str], folder: str, package: list[str]) -> list[str]:
    """In it, a replay is Mesa's on the CPU. RenderDoc makes OpenGL's programs anew at each event: /tmp keeps what the driver compiled."""
    driver = next(filter(os.path.exists, LAVAPIPE), "")
    variables = {"HOME": "/tmp", "PATH": "/usr/bin:/bin", "PYTHONPATH": ":".join(package), "XDG_CACHE_HOME": "/tmp",
                 "LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe", "VK_DRIVER_FILES": driver, "VK_ICD_FILENAMES": driver}
    return [*sandbox([*package, *read], variables), "--bind", folder, folder, "--chdir", folder]


def limit() -> None:
    for kind, most in LIMITS.items():
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def replay(console: Console, confined: bool, module: str, capture: str, folder: str, argument: str, again: bool = True) -> str:
    """Runs a module of this package on the capture. Why it failed, or nothing. A driver may crash by chance, so there is a second try."""
    path = os.path.realpath(capture)
    package = [os.path.dirname(HERE), *filter(None, os.environ.get("PYTHONPATH", "").split(":"))]
    words = ["/usr/bin/python3", "-m", f"diptych.rdc.{module}", path, folder, argument]
    words = on_mesa([path], folder, package) + words if confined else words
    process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               errors="replace", preexec_fn=limit)
    late, last = Timer(SECONDS, process.send_signal, [signal.SIGXCPU]), ""
    late.start()
    try:
        for line in process.stderr or ():
            if line.startswith("replay: "):
                console.info(f"{capture}: {line.removeprefix('replay: ').rstrip()}")
            last = line.rstrip() or last
        status = process.wait()
    finally:
        late.cancel()
        process.kill()
    if status in (-signal.SIGXCPU, 128 + signal.SIGXCPU):
        return "the replay took more than its time"
    if status in (-signal.SIGSEGV, 128 + signal.SIGSEGV) and again:
        return replay(console, confined, module, capture, folder, argument, False)
    if status < 0 or status > 128:
        return f"the replay was ended by signal {-status if status < 0 else status - 128}: the capture is damaged, or asks too much"
    done = not status and os.path.exists(os.path.join(folder, "frame.json"))
    return "" if done else last or "cannot be replayed"
