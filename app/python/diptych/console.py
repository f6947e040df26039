"""Messages on stderr, worded as those of the C program, and the file of --json."""
from __future__ import annotations

import json
import os
import re
import sys
from typing import Any, NoReturn

FORMAT = 1  # of the JSON of every verb


class Failure(Exception):
    """The verb cannot go on; the message was printed."""


def printable(text: str) -> str:
    """What a terminal could take for a command, and bytes that are no UTF-8, are written \\xNN."""
    return re.sub(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\udc80-\udcff]", lambda found: f"\\x{ord(found[0]) & 255:02x}", text)


class Console:
    """Of one verb. `errors` are for --json: those that the C program has told come first."""

    def __init__(self, verb: str, errors: list[dict[str, Any]]):
        self.verb, self.errors = verb, errors

    def _tell(self, severity: str, text: str) -> None:
        text = printable(text)
        print(f"diptych: {severity}: {text}", file=sys.stderr)
        self.errors.append({"severity": severity, "message": text})

    def warning(self, text: str) -> None:
        self._tell("warning", text)

    def error(self, text: str) -> None:
        self._tell("error", text)

    def fail(self, text: str) -> NoReturn:
        self.error(text)
        raise Failure

    def info(self, text: str) -> None:
        if "DIPTYCH_QUIET" not in os.environ:
            print(f"diptych: {text}", file=sys.stderr)

    def write_json(self, path: str, status: int, result: dict[str, Any]) -> None:
        head = {"verb": self.verb, "format": FORMAT, "exit_status": status, "errors": self.errors}
        write(path, json.dumps({**head, **result}, indent=1))


def write(path: str, content: str | bytes) -> None:
    """Writes a file whole or not at all; a pipe or a device, such as /dev/stdout, is written to."""
    is_stream = os.path.exists(path) and not os.path.isfile(path)
    draft = path if is_stream else f"{path}.diptych-tmp-{os.getpid()}"
    try:
        with open(draft, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode(errors="replace"))
        if not is_stream:
            os.replace(draft, path)
    except BaseException:
        if os.path.exists(draft) and not is_stream:
            os.unlink(draft)
        raise
