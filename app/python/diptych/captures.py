"""`diptych compare A.rdc B.rdc...`: replays captures of RenderDoc, each in a sandbox of its own, matches their passes, tells how state
and uniforms differ, and has `compare` judge what the passes left, as dumps of two renderers."""
from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from . import rdc_differ
from .capture import renderdoc
from .console import Console, printable, write
from .rdc_match import Matcher, Pair, Side
from .verbs import HERE

Json = dict[str, Any]
LIMITS = {resource.RLIMIT_AS: 16 << 30, resource.RLIMIT_CPU: 1800, resource.RLIMIT_FSIZE: 4 << 30}  # of a replay
SECONDS = 900
READ = ["/usr", "/lib", "/lib64", "/bin", "/etc/vulkan", "/etc/glvnd", "/etc/ld.so.cache", "/etc/alternatives", "/etc/drirc", "/sys"]
LAVAPIPE = ["/usr/share/vulkan/icd.d/" + name for name in ("lvp_icd.x86_64.json", "lvp_icd.json", "lvp_icd.aarch64.json")]
LABELS = {"OpenGL": "gl", "Vulkan": "vk"}

# ---- Replays -------------------------------------------------------------------------------------


def software() -> dict[str, str]:
    """A replay is Mesa's on the CPU."""
    driver = next(filter(os.path.exists, LAVAPIPE), "")
    return {"LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe", "VK_DRIVER_FILES": driver, "VK_ICD_FILENAMES": driver}


def sandbox(capture: str, folder: str, package: list[str]) -> list[str]:
    words = ["bwrap", "--unshare-all", "--die-with-parent", "--proc", "/proc", "--dev", "/dev", "--tmpfs", "/tmp", "--clearenv"]
    for path in [*READ, *package, capture]:
        words += ["--ro-bind-try", path, path]
    words += ["--bind", folder, folder, "--chdir", folder]
    for name, value in {"HOME": "/tmp", "PATH": "/usr/bin:/bin", "PYTHONPATH": ":".join(package), **software()}.items():
        words += ["--setenv", name, value]
    return words


def confines() -> bool:
    """Whether there can be a sandbox."""
    words = ["bwrap", "--unshare-all", "--ro-bind", "/", "/", "--proc", "/proc", "--dev", "/dev", "/bin/true"]
    return bool(shutil.which("bwrap")) and subprocess.run(words, capture_output=True, check=False).returncode == 0


def limit() -> None:
    for kind, most in LIMITS.items():
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


class Replays:
    """Processes of rdc.py."""

    def __init__(self, console: Console, confined: bool):
        self.console, self.confined = console, confined
        self.running: list[subprocess.Popen[str]] = []

    def __enter__(self) -> "Replays":
        return self

    def __exit__(self, *_: Any) -> None:
        for process in self.running:
            process.kill()

    def run(self, capture: str, folder: str, draws: str) -> str:
        """Why it failed, or nothing."""
        path = os.path.realpath(capture)
        package = [os.path.dirname(HERE), *filter(None, os.environ.get("PYTHONPATH", "").split(":"))]
        words = ["/usr/bin/python3", "-m", "diptych.rdc", path, folder, draws]
        words = sandbox(path, folder, package) + words if self.confined else words
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                   errors="replace", preexec_fn=limit)
        self.running.append(process)
        last = ""
        for line in process.stderr or ():
            if line.startswith("replay: "):
                self.console.info(f"{capture}: {line.removeprefix('replay: ').rstrip()}")
            last = line.rstrip() or last
        status = process.wait()
        if status in (-signal.SIGXCPU, 128 + signal.SIGXCPU):
            return "the replay took more than its time"
        if status < 0 or status > 128:
            return f"the replay was ended by signal {-status if status < 0 else status - 128}: the capture is damaged, or asks too much"
        done = not status and os.path.exists(os.path.join(folder, "frame.json"))
        return "" if done else last or "cannot be replayed"

    def all(self, captures: list[str], folders: list[str], draws: list[str]) -> list[Side]:
        with ThreadPoolExecutor(2) as pool:
            done = [pool.submit(self.run, *job) for job in zip(captures, folders, draws)]
            try:
                failed = [item.result(SECONDS) for item in done]
            except BaseException:
                self.__exit__()
                raise
        for capture, reason in zip(captures, failed):
            if reason:
                self.console.error(f"{capture}: {reason}")
        if any(failed):
            self.console.fail("nothing was compared")
        return [self.side(capture, folder) for capture, folder in zip(captures, folders)]

    def side(self, capture: str, folder: str) -> Side:
        with open(os.path.join(folder, "frame.json"), encoding="utf-8") as file:
            frame = json.load(file)
        source = f"{capture} ({frame['api']}, RenderDoc {frame['renderdoc']}{frame['device'] and ', captured on ' + frame['device']})"
        side = Side(folder, LABELS.get(frame["api"], frame["api"]), source, frame)
        side.read_small()
        self.console.info(f"{capture}: {len(side.passes)} passes, {frame['bytes'] / 1e6:.1f} MB")
        for note in frame["notes"]:
            self.console.warning(f"{capture}: {note}")
        return side


# ---- Matching ------------------------------------------------------------------------------------


def described(item: Json) -> str:
    sizes = {f"{entry['width']}x{entry['height']}" if entry["kind"] == "image" else f"{entry['count']} words" for entry in item["entries"]}
    where = item["where"] and f" {item['where'][-1]}"
    return f"{item['index']:02d} {item['kind']} {'+'.join(sorted(sizes))}{where or ''}"


def pass_names(passes: list[Json]) -> list[str]:
    names = []
    for number, item in enumerate(passes):
        entry = item["entries"][0]
        size = f"{entry['width']}x{entry['height']}" if entry["kind"] == "image" else str(entry["count"])
        names.append(f"{number:02d}_{item['kind']}_{size}")
    return names


def write_match(path: str, sides: tuple[Side, Side], pairs: list[Pair], names: list[str]) -> None:
    rows = [{"pass": names[pair.first], "first": sides[0].passes[pair.first]["index"],
             "second": sides[1].passes[pair.second]["index"], "rows": "opposite" if pair.turned else "same"}
            for pair in pairs if pair.first is not None and pair.second is not None]
    write(path, json.dumps({"version": 1, "passes": rows}, indent=1))


def read_match(console: Console, path: str, matcher: Matcher) -> list[Pair]:
    """The pairs of a file, whose rows may have been changed by hand."""
    try:
        with open(path, encoding="utf-8") as file:
            rows = [(int(row["first"]), int(row["second"]), row["rows"]) for row in json.load(file)["passes"]]
    except (ValueError, KeyError, TypeError) as error:
        console.fail(f"{path}: is no matching of passes, as --match writes it: {error}")
    places = [{item["index"]: at for at, item in enumerate(side)} for side in matcher.passes]
    pairs = []
    for first, second, rows_are in rows:
        if first not in places[0] or second not in places[1] or rows_are not in ("same", "opposite"):
            console.fail(f"{path}: passes {first} and {second}, rows {rows_are}: no such passes, or \"rows\" is not "
                         "\"same\" or \"opposite\"")
        pairs.append(Pair(places[0].pop(first), places[1].pop(second)))
    pairs += [Pair(at, None) for at in places[0].values()] + [Pair(None, at) for at in places[1].values()]
    pairs = matcher.fill(pairs)
    for pair, row in zip(pairs, rows):
        pair.turned = row[2] == "opposite"
    return pairs


# ---- Dumps ---------------------------------------------------------------------------------------


class Dump:
    """A folder that `compare A B` reads."""

    def __init__(self, side: Side, folder: str):
        self.side, self.folder = side, folder
        self.entries: list[Json] = []
        os.makedirs(folder)

    def add(self, entry: Json, name: str, slot: str, origin: str, about: str = "") -> None:
        keys = ("kind", "file", "mip", "width", "height", "layers", "format", "samples", "stride", "count", "fields")
        item = {"pass": name, "resource": slot, **{key: entry[key] for key in keys if key in entry}}
        if entry["kind"] == "image":
            item["origin"] = origin
        if about:
            item["about"] = about
        path = os.path.join(self.folder, entry["file"])
        if not os.path.exists(path):
            os.link(os.path.join(self.side.folder, entry["file"]), path)
        self.entries.append(item)

    def end(self) -> None:
        manifest = {"version": 1, "backend": self.side.label, "device": self.side.frame["device"], "source": self.side.source,
                    "entries": self.entries}
        write(os.path.join(self.folder, "manifest.json"), json.dumps(manifest))


def slots(pair: Pair) -> list[str]:
    """Names of a pair's contents, each once."""
    names: list[str] = []
    for entry, other in pair.contents:
        label = entry["label"] if entry["label"] == other["label"] else ""
        screen = (entry["screen"] or other["screen"]) and entry["resource"] == "color0"
        name = "screen" if screen else label or entry["resource"]
        names.append(name if name not in names or entry.get("mip") else f"{name}_{len(names)}")
    return names


def opposite(origin: str) -> str:
    return "top" if origin == "bottom" else "bottom"


def add_pair(dumps: list[Dump], pair: Pair, name: str, about: str) -> None:
    origin = "bottom" if dumps[0].side.label == "gl" else "top"
    origins = origin, opposite(origin) if pair.turned else origin
    for entry, other in pair.inputs:
        rows = origin, opposite(origin) if entry["turned"] == other["file"] != entry["file"] else origin
        for dump, item, where in zip(dumps, (entry, other), rows):
            dump.add(item, f"{name}_inputs", entry["resource"], where)
    for (entry, other), slot in zip(pair.contents, slots(pair)):
        for dump, item, where in zip(dumps, (entry, other), origins):
            dump.add(item, name, slot, where, about)


def add_alone(dump: Dump, item: Json, label: str) -> None:
    for entry in item["entries"]:
        dump.add(entry, f"only_in_{label}_{item['index']:02d}_{item['kind']}", entry["resource"], "top")


# ---- What is told --------------------------------------------------------------------------------


def tell(sides: tuple[Side, Side], pairs: list[Pair], names: list[str], found: dict[str, list[str]],
         clocks: dict[str, list[str]]) -> None:
    labels = [side.label for side in sides] if sides[0].label != sides[1].label else ["first", "second"]
    moments = [f"{text} (pass {name})" for name, texts in clocks.items() for text in texts]
    if moments:
        print(f"not the same moment: {printable(moments[0])}\n  what moves differs for this reason; hold the frame still: a fixed "
              "step of time, a pause, or another --frame of one capture")
    rows = []
    for pair in pairs:
        if pair.first is not None and pair.second is not None:
            name = names[pair.first]
            rows.append((name, *(described(side.passes[at]) for side, at in zip(sides, (pair.first, pair.second))),
                         "opposite" if pair.turned else "same", str(len(found.get(name, [])) or "-")))
    heads = ("pass", *labels, "rows", "state differs")
    widths = [max(map(len, column)) for column in zip(heads, *rows)] if rows else [0] * 5
    for row in (heads, *rows):
        print("  ".join(printable(text).ljust(width) for text, width in zip(row, widths)).rstrip())
    for pair in pairs:
        if pair.first is None or pair.second is None:
            side, at = (0, pair.first) if pair.first is not None else (1, pair.second)
            print(f"only in {labels[side]}: {printable(described(sides[side].passes[at or 0]))}")
    places: dict[str, list[str]] = {}
    for name, texts in found.items():
        for text in texts:
            places.setdefault(text, []).append(name)
    for text, where in places.items():
        print(f"state: {', '.join(where[:3])}{f' and {len(where) - 3} more' if len(where) > 3 else ''}: {printable(text)}")
    print(flush=True)


def state_of(sides: tuple[Side, Side], pairs: list[Pair], names: list[str]) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    found: dict[str, list[str]] = {}
    clocks: dict[str, list[str]] = {}
    across = sides[0].label != sides[1].label
    for pair in pairs:
        if pair.first is None or pair.second is None:
            continue
        texts, moved = rdc_differ.differences(sides[0].passes[pair.first], sides[1].passes[pair.second], pair.turned, across)
        for into, items in ((found, texts), (clocks, moved)):
            if items:
                into[names[pair.first]] = items
    return found, clocks


# ---- The verb ------------------------------------------------------------------------------------


class Comparison:
    def __init__(self, console: Console, request: Json, folder: str):
        self.console, self.request, self.folder = console, request, folder
        runs = int(request.get("measure", 0))
        self.groups = [item.split(",") if runs else [item] for item in request.pop("a_b")]
        for group in self.groups:
            if runs and len(group) != runs:
                console.fail(f"--measure {runs} needs {runs} captures of each side, like a1.rdc,a2.rdc; {','.join(group)} has {len(group)}")
            for name in group:
                if not name.endswith(".rdc") or not os.path.isfile(name):
                    console.fail(f"{name}: is no file like FRAME.rdc; captures are compared with captures")
        self.match, self.draws, self.save = (request.pop(key, None) for key in ("match", "draws", "save"))
        if (self.match or self.draws or self.save) and (runs or len(self.groups) > 2):
            console.fail("--match, --draws and --save take two captures")
        self.json = request.pop("json", None)
        self.pairs: list[Pair] = []
        self.names: list[str] = []

    def replay(self, draws: list[str], name: str) -> list[Side]:
        captures = [capture for group in self.groups for capture in group]
        folders = [os.path.join(self.folder, f"{name}{index}") for index in range(len(captures))]
        for folder in folders:
            os.mkdir(folder)
        confined = not self.request.get("trust") and confines()
        if not confined and not self.request.get("trust"):
            self.console.warning("the captures are replayed without a sandbox: bubblewrap is not installed, or the kernel allows it none; "
                                 "--trust says that they may")
        with Replays(self.console, confined) as replays:
            return replays.all(captures, folders, draws or [""] * len(captures))

    def pair_sides(self, first: Side, second: Side) -> list[Pair]:
        matcher = Matcher(first, second)
        if self.match and os.path.exists(self.match) and not self.draws:
            return read_match(self.console, self.match, matcher)
        return matcher.match()

    def dump(self, sides: list[Side]) -> list[str]:
        """Folders of the dumps; all sides are matched with the first."""
        runs = len(self.groups[0])
        self.names = pass_names(sides[0].passes)
        words, made = [], []
        for index, side in enumerate(sides):
            path = os.path.join(self.folder, "dumps", str(index // runs), *([str(index)] if runs > 1 else []))
            made.append(Dump(side, path))
            if index % runs == 0:
                words.append(os.path.join(self.folder, "dumps", str(index // runs)))
        for index, side in enumerate(sides[1:], 1):
            pairs = self.pair_sides(sides[0], side)
            found, clocks = state_of((sides[0], side), pairs, self.names)
            first = made[0] if index == 1 else Dump(sides[0], os.path.join(self.folder, f"again{index}"))
            for pair in pairs:
                if pair.first is not None and pair.second is not None:
                    name = self.names[pair.first]
                    add_pair([first, made[index]], pair, name, "; ".join(found.get(name, [])))
                else:
                    at, dump = (pair.first, first) if pair.first is not None else (pair.second, made[index])
                    add_alone(dump, dump.side.passes[at or 0], "first" if pair.second is None else "second")
            if index == runs:
                self.pairs, self.found, self.clocks = pairs, found, clocks
                if self.match and not self.draws and not os.path.exists(self.match):
                    write_match(self.match, (sides[0], side), pairs, self.names)
                tell((sides[0], side), pairs, self.names, found, clocks)
        for dump in made:
            dump.end()
        return words

    def compare(self, folders: list[str]) -> int:
        told = self.json or os.path.join(self.folder, "told.json")
        words = [self.request["program"], "compare", *folders, "--json", told]
        for key in ("contracts", "measure", "write_contracts", "pictures", "html", "junit", "run"):
            if key in self.request:
                words += ["--" + key.replace("_", "-"), str(self.request[key])]
        return subprocess.run(words, stdin=subprocess.DEVNULL, check=False).returncode

    def conclude(self, sides: list[Side]) -> None:
        """State beside the first difference, and in --json."""
        path = self.json or os.path.join(self.folder, "told.json")
        with open(path, encoding="utf-8") as file:
            told = json.load(file)
        guilty = (told.get("guilty") or (told.get("pairs") or [{}])[0].get("guilty") or {}).get("pass", "")
        guilty = guilty.removesuffix("_inputs")
        for text in self.found.get(guilty, []):
            print(f"beside it, in the state of {guilty}: {printable(text)}")
        if self.json:
            told["captures"] = {"state": self.found, "moments": self.clocks,
                                "matched": [[self.names[pair.first], sides[1].passes[pair.second]["index"]] for pair in self.pairs
                                            if pair.first is not None and pair.second is not None]}
            write(path, json.dumps(told, indent=1))
        if self.save and guilty in self.names:
            self.save_pass(sides, self.names.index(guilty))

    def save_pass(self, sides: list[Side], at: int) -> None:
        pair = next(pair for pair in self.pairs if pair.first == at)
        for side, label, index in zip(sides, ("first", "second"), (pair.first, pair.second)):
            item, folder = side.passes[index or 0], os.path.join(self.save, label)
            os.makedirs(folder, exist_ok=True)
            for shader in item["shaders"]:
                shutil.copy(os.path.join(side.folder, shader["file"]), os.path.join(folder, shader["file"].split(".", 1)[1]))
            dump = Dump(side, os.path.join(folder, "contents"))
            for entry in [*item["inputs"], *item["entries"]]:
                dump.add(entry, self.names[at], entry["resource"], "bottom" if side.label == "gl" else "top")
            dump.end()
        print(f"{self.save}: shaders and contents of {self.names[at]}")

    def each_draw(self, sides: list[Side]) -> list[Side]:
        """Replays once more: the draws of one pass."""
        pairs, names = self.pair_sides(*sides), pass_names(sides[0].passes)
        for pair in pairs:
            if pair.first is not None and pair.second is not None and self.draws in (names[pair.first], names[pair.first].split("_")[0]):
                wanted = [str(side.passes[at]["index"]) for side, at in zip(sides, (pair.first, pair.second))]
                return self.replay(wanted, "draws")
        self.console.fail(f"--draws {self.draws}: no pass that both have is called so; there are {', '.join(names)}")


def main(console: Console, request: Json) -> tuple[int, Json]:
    renderdoc(console)
    with tempfile.TemporaryDirectory(prefix="diptych-") as folder:
        comparison = Comparison(console, request, folder)
        sides = comparison.replay([], "frame")
        if comparison.draws:
            sides = comparison.each_draw(sides)
        status = comparison.compare(comparison.dump(sides))
        if status < 2:
            comparison.conclude(sides)
    sys.stdout.flush()
    return status, {}
