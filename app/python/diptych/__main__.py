"""`python3 -m diptych VERB`, started by the program diptych: the verbs that Python does. The request, JSON on stdin, has the
options under their names; see app/console/python.h."""
from __future__ import annotations

import importlib
import json
import os
import signal
import sys
import traceback
from typing import Any

from .console import Console, Failure

# A verb's module has `main(console, request)`, which returns the exit status and the members of --json.
# The number is the exit status of a failure.
VERBS: dict[str, tuple[str, int]] = {
    "bench": ("bench", 1),
    "capture": ("rdc.capture", 1),
    "compare": ("rdc.compare", 2),  # of captures
    "comparison": ("comparison", 2),  # for compare
    "cost": ("cost", 2),
    "flicker": ("flicker", 1),
    "list": ("listing", 1),
    "measured": ("measured", 2),  # for compare
    "metrics": ("metrics", 1),
    "replay": ("sandbox", 2),
    "report": ("report", 2),
    "sweep": ("grid", 2),
    "tune": ("tune", 1),
    "why": ("why", 1),  # for compare and view
}


def interrupted(number: int, _frame: Any) -> None:
    print("diptych: interrupted, nothing half-written is left", file=sys.stderr)
    raise SystemExit(128 + number)


def main() -> int:
    verb = sys.argv[1]
    module, failed = VERBS[verb]
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, interrupted)
    request = json.loads(sys.stdin.buffer.read().decode(errors="surrogateescape"))
    console = Console(verb, request.pop("errors"))
    status, result = failed, {}
    try:
        status, result = importlib.import_module("." + module, __package__).main(console, request)
    except Failure:
        pass
    except ModuleNotFoundError as error:
        console.error(f"{verb}: needs the Python package {error.name}; install python3-{error.name}")
    except OSError as error:
        if not error.filename:  # standard output
            raise
        console.error(f"{error.filename}: {error.strerror}")
    except Exception as error:  # ours: never told as the user's
        traceback.print_exc()
        console.error(f"{verb}: internal error: {type(error).__name__}: {error}")
    if "json" in request:
        console.write_json(request["json"], status, result)
    sys.stdout.flush()
    return status


if __name__ == "__main__":
    try:
        sys.exit(main())
    except OSError as error:
        if not isinstance(error, BrokenPipeError):
            print("diptych: error: standard output cannot be written", file=sys.stderr)
        os._exit(2)
