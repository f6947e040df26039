"""`diptych compare A.rdc B.rdc...`: replays captures of RenderDoc, each in a sandbox of its own, matches their passes, tells how state
and uniforms differ, and has `compare` judge what the passes left, as dumps of two renderers."""
from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from contextlib import suppress
from typing import Any, Iterator

import numpy as np

from . import differ, guilty
from .capture import renderdoc
from ..console import Console, printable, write
from ..sandbox import confines
from .left import TAKEN, Unreadable, frame_of, read
from .match import Matcher, Pair, Side, numbers_of
from .replays import SECONDS, limit, on_mesa, replay
from .texels import doubled_depth, hashes_of, names_of

Json = dict[str, Any]
MOST_BESIDE = 8  # texts of state
MOST_ALONE = 8   # passes that one side has
LABELS = {"OpenGL": "gl", "Vulkan": "vk"}

# ---- Matching ------------------------------------------------------------------------------------


def size_of(entry: Json) -> str:
    return f"{entry['width']}x{entry['height']}" if entry["kind"] == "image" else f"{entry['count']} words"


def described(item: Json) -> str:
    where = item["where"] and f" {item['where'][-1]}"
    sizes = map(size_of, item["entries"][:1] if item["kind"] == "mips" else item["entries"])
    return f"{item['index']:02d} {item['kind']} {'+'.join(sorted(set(sizes)))}{where or ''}"


def pass_names(passes: list[Json]) -> list[str]:
    sizes = [size_of(item["entries"][0]).removesuffix(" words") for item in passes]
    return [f"{number:02d}_{item['kind']}_{size}" for number, (item, size) in enumerate(zip(passes, sizes))]


def write_match(path: str, sides: tuple[Side, Side], pairs: list[Pair], names: list[str]) -> None:
    rows = [{"pass": names[pair.first], "first": sides[0].passes[pair.first]["index"],
             "second": sides[1].passes[pair.second]["index"], "rows": "opposite" if pair.turned else "same"} for pair in pairs if pair.both]
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
    pairs += [Pair(at, -1) for at in places[0].values()] + [Pair(-1, at) for at in places[1].values()]
    pairs = matcher.fill(pairs)
    for pair, row in zip(pairs, rows):
        pair.turned = row[2] == "opposite"
    return pairs


# ---- Dumps ---------------------------------------------------------------------------------------


class Dump:
    """A folder that `compare A B` reads."""

    def __init__(self, side: Side, folder: str, doubled: bool = False):
        self.side, self.folder, self.doubled = side, folder, doubled
        self.entries: list[Json] = []
        os.makedirs(folder)

    def add(self, entry: Json, name: str, slot: str, origin: str, about: str = "") -> None:
        keys = ("mip", "kind", "file", "width", "height", "layers", "format", "samples", "stride", "count", "fields")
        item = {"pass": name, "resource": slot, **{key: entry[key] for key in keys[entry["kind"] == "buffer":] if key in entry}}
        if entry["kind"] == "image":
            item["origin"] = origin
        if about:
            item["about"] = about
        path = os.path.join(self.folder, entry["file"])
        if not os.path.exists(path) and self.doubled and entry["kind"] == "image" and entry["format"].startswith("d"):
            doubled_depth(entry["format"], np.fromfile(os.path.join(self.side.folder, entry["file"]), "u1")).tofile(path)
        elif not os.path.exists(path):
            os.link(os.path.join(self.side.folder, entry["file"]), path)
        self.entries.append(item)

    def end(self) -> None:
        manifest = {"version": 1, "backend": self.side.label, "device": self.side.frame["device"], "source": self.side.source,
                    "entries": self.entries}
        write(os.path.join(self.folder, "manifest.json"), json.dumps(manifest))


def slots(entries: list[Json]) -> list[str]:
    """Names of contents, each once; all levels of a texture have one."""
    names: list[str] = []
    known: dict[int, str] = {}
    for entry in entries:
        name = "screen" if entry["screen"] and entry["resource"] == "color0" else entry["label"] or entry["resource"]
        name = f"{name}_{len(known)}" if name in known.values() else name
        names.append(known.setdefault(entry["id"], name))
    return names


def origin_of(side: Side) -> str:
    """Where row 0 is, if the other side is not found to have it elsewhere."""
    return "bottom" if side.label == "gl" else "top"


def shown(inputs: list[Json]) -> list[Json]:
    """Of the smaller levels of textures, those that differ."""
    return [entry for entry in inputs if not entry.get("mip") or entry.get("differs")]


def dump_first(matches: "list[Matched]", folder: str) -> None:
    """All passes under the names that both sides have. Of those without a partner, some show one content."""
    side, alone = matches[0].sides[0], matches[0] if len(matches) == 1 else None
    dump = Dump(side, folder, alone is not None and alone.doubled and side.label == "gl")
    about = alone.state if alone else {}
    partners = {pair.first for matched in matches for pair in matched.pairs if pair.both}
    without = [at for at in range(len(side.passes)) if at not in partners][:MOST_ALONE]
    for at, (name, item) in enumerate(zip(matches[0].names, side.passes)):
        both = ((f"{name}_inputs", shown(item["inputs"])), (name, item["entries"]))
        for place, entries in both if at in partners else ((name, item["entries"][:1]),) if at in without else ():
            for entry, slot in zip(entries, slots(entries)):
                dump.add(entry, place, slot, origin_of(side), "; ".join(about.get(place, [])))
    dump.end()


def dump_other(matched: "Matched", folder: str) -> None:
    dump, own = Dump(matched.sides[1], folder, matched.doubled and matched.sides[1].label == "gl"), origin_of(matched.sides[0])
    origins = [own, "bottom" if own == "top" else "top"]
    for item in matched.alone(dump.side)[:MOST_ALONE]:
        entry = item["entries"][0]
        dump.add(entry, f"only_in_{dump.side.label}_{item['index']:02d}_{item['kind']}", entry["resource"], "top")
    for pair, item, _ in matched.both():
        name, contents = matched.names[pair.first], [(*both, pair.turned) for both in pair.contents]
        for place, entries, found in ((f"{name}_inputs", shown(item["inputs"]), pair.inputs), (name, item["entries"], contents)):
            named = {id(entry): slot for entry, slot in zip(entries, slots(entries))}
            for entry, other, turned in found:
                if id(entry) in named:
                    dump.add(other, place, named[id(entry)], origins[turned])
    dump.end()


# ---- What is told --------------------------------------------------------------------------------


def drop_alpha(sides: tuple[Side, Side], entries: tuple[Json, Json]) -> None:
    """Where the window of one side has no alpha, the other's is left out, since a window shows none."""
    forms = [entry.get("format", "").split("_")[0] for entry in entries]
    if not all(entry["screen"] for entry in entries) or sorted(forms) not in (["bgra8", "rgb8"], ["rgb8", "rgba8"]):
        return
    (side, entry), form = next((both, form) for both, form in zip(zip(sides, entries), forms) if form != "rgb8")
    texels = np.fromfile(os.path.join(side.folder, entry["file"]), "u1").reshape(-1, entry["width"], 4)
    rows = np.ascontiguousarray(texels[..., 2::-1] if form == "bgra8" else texels[..., :3])
    entry["file"], entry["turned"] = names_of([hashes_of(rows)])
    entry["format"] = entry["format"].replace(form, "rgb8")
    rows.tofile(os.path.join(side.folder, entry["file"]))


class Matched:
    """Two sides, their passes in pairs, and how the state of each pass differs, by its name; `clocks`: what tells of another moment."""

    def __init__(self, sides: tuple[Side, Side], pairs: list[Pair], names: list[str]):
        self.sides, self.pairs, self.names, self.doubled = sides, pairs, names, Matcher(*sides).doubled_depth(pairs)
        self.labels = [side.label for side in sides] if sides[0].label != sides[1].label else ["first", "second"]
        self.state: dict[str, list[str]] = {}
        self.clocks: dict[str, list[str]] = {}
        self.draws: dict[str, list[int]] = {}  # those whose state was compared, and all
        self.ported = len({(side.label, side.frame["device"].endswith("by Zink")) for side in sides}) > 1
        sources = [self.sources(side, [pair.second if at else pair.first for pair in pairs if pair.both]) for at, side in enumerate(sides)]
        for pair, first, second in self.both():
            for item, other in ((first, second), (second, first)):  # what one side left out is not asked of the other
                item["entries"] = [entry for entry in item["entries"] if entry["resource"] not in other["left_out"]]
            for contents in pair.contents:
                drop_alpha(sides, contents)
            for entry, other, _ in pair.inputs:
                entry["differs"] = entry.get("differs") or other["file"] not in (entry["file"], entry["turned"])
            folders, draws = [side.folder for side in sides], max(first["draws"], second["draws"])
            how = pair.turned, sides[0].label != sides[1].label, self.ported
            texts, moved, compared = differ.differences(first, second, folders, *how)
            read = differ.common(sources[0][pair.first], sources[1][pair.second])
            texts += [f"{name}: the picture of {one} against that of {other}" for name, one, other in read if one != other]
            if first["kind"] == second["kind"] == "draw":
                self.draws[names[pair.first]] = [compared, draws]
            for into, items in ((self.state, texts), (self.clocks, moved)):
                if items:
                    into[names[pair.first]] = items

    def sources(self, side: Side, matched: list[int]) -> list[dict[str, str]]:
        """Of each pass, the textures that it reads and the passes of both sides that they are of, by the first side's name."""
        found, last = [], {}  # type: list[dict[str, str]], dict[str, str]
        names = dict(zip(matched, (self.names[pair.first] for pair in self.pairs if pair.both)))
        for at, item in enumerate(side.passes):
            found.append({name: last[str(resource)] for name, resource in item["reads"].items() if last.get(str(resource))})
            last.update({str(entry["id"]): names.get(at, "") for entry in item["entries"]})
        return found

    def both(self) -> Iterator[tuple[Pair, Json, Json]]:
        for pair in self.pairs:
            if pair.both:
                yield pair, self.sides[0].passes[pair.first], self.sides[1].passes[pair.second]

    def alone(self, side: Side) -> list[Json]:
        """Passes that the other side lacks."""
        places = [pair.first if side is self.sides[0] else pair.second for pair in self.pairs if not pair.both]
        return [side.passes[at] for at in places if at >= 0]

    def tell(self) -> None:
        for name, texts in list(self.clocks.items())[:1]:
            print(f"not the same moment: {printable(texts[0])} (pass {name})\n  what moves differs for this reason; hold the frame still: "
                  "a fixed step of time, a pause, or another --frame of one capture")
        rows = [("pass", *self.labels, "rows", "state differs")]
        for pair, first, second in self.both():
            name = self.names[pair.first]
            rows.append((name, described(first), described(second), "opposite" if pair.turned else "same",
                         str(len(self.state.get(name, [])) or "-")))
        widths = [max(map(len, column)) for column in zip(*rows)]
        for row in rows:
            print("  ".join(printable(text).ljust(width) for text, width in zip(row, widths)).rstrip())
        for side, label in zip(self.sides, self.labels):
            alone = [described(item) for item in self.alone(side)]
            more = [f"{len(alone) - MOST_ALONE} more passes"] if len(alone) > MOST_ALONE else []
            for text in alone[:MOST_ALONE] + more:
                print(f"only in {label}: {printable(text)}")
        if self.doubled:
            print("depth of gl is compared as 2 z - 1: it uses half of OpenGL's clip space, where vk uses all of Vulkan's")
        equal = {self.names[pair.first] for pair, _, _ in self.both() if pair.contents and all(
            other["file"] in (entry["file"], entry["turned"]) for entry, other in pair.contents
            if numbers_of(entry) != "depth" or {numbers_of(one) for one, _ in pair.contents} == {"depth"})}
        places: dict[tuple[bool, str], list[str]] = {}
        for name, texts in self.state.items():
            for text in texts:
                places.setdefault((name in equal, text), []).append(name)
        for (without, text), names in sorted(places.items()):
            where = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
            print(f"state{', without effect' if without else ''}: {where}: {printable(text)}")
        print(flush=True)

    def json(self) -> Json:
        return {"state": self.state, "moments": self.clocks, "draws": self.draws,
                "matched": [[self.names[pair.first], first["index"], second["index"]] for pair, first, second in self.both()]}

    def draws_text(self) -> str:
        compared, draws = (sum(counts) for counts in zip((0, 0), *self.draws.values()))
        parts = [f"{some} of {most} in {name}" for name, (some, most) in self.draws.items() if some < most]
        more = f" and {len(parts) - 3} more passes" if len(parts) > 3 else ""
        where = f": {', '.join(parts[:3])}{more}; --draws compares all of a pass" if parts else ""
        return f"state of {compared} of {draws} draws compared{where}"

    def save(self, name: str, path: str) -> None:
        """Shaders, inputs and results of a pass, of both sides."""
        items = next(items for pair, *items in self.both() if self.names[pair.first] == name)
        for side, label, item in zip(self.sides, ("first", "second"), items):
            dump = Dump(side, os.path.join(path, label))
            for shader in item["shaders"]:
                shutil.copy(os.path.join(side.folder, shader["file"]), os.path.join(dump.folder, shader["file"].split(".", 1)[1]))
            for entry in [*item["inputs"], *item["entries"]]:
                dump.add(entry, name, entry["resource"], origin_of(side))
            dump.end()
        print(f"{path}: shaders, inputs and results of {name}")


# ---- The verb ------------------------------------------------------------------------------------


class Comparison:
    def __init__(self, console: Console, request: Json, folder: str):
        self.console, self.request, self.folder = console, request, folder
        runs = int(request.get("measure", 0))
        self.groups = [item.split(",") if runs else [item] for item in request["a_b"]]
        for group in self.groups:
            if runs and len(group) != runs:
                console.fail(f"--measure {runs} needs {runs} captures of each side, like a1.rdc,a2.rdc; {','.join(group)} has {len(group)}")
            for name in group:
                if not name.endswith(".rdc") or not os.path.isfile(name):
                    console.fail(f"{name}: is no file like FRAME.rdc; captures are compared with captures")
        self.match, self.draws, self.save = (request.get(key) for key in ("match", "draws", "save"))
        if (self.match or self.draws or self.save) and (runs or len(self.groups) > 2):
            console.fail("--match, --draws and --save take two captures")
        if self.save and os.path.exists(self.save):
            console.fail(f"{self.save}: is there; --save writes a new folder")
        self.told = request.get("json", os.path.join(folder, "told.json"))
        self.matched: list[Matched] = []
        self.confined = not request.get("trust") and confines()
        if not self.confined and not request.get("trust"):
            console.warning("the captures are replayed without a sandbox: bubblewrap is not installed, or the kernel allows it none; "
                            "--trust says that they may")

    def replay(self, draws: list[str], name: str) -> list[Side]:
        captures = [capture for group in self.groups for capture in group]
        sides = []
        for index, capture in enumerate(captures):
            folder = os.path.join(self.folder, f"{name}{index}")
            os.mkdir(folder)
            why = replay(self.console, self.confined, "replay", capture, folder, draws[index] if draws else "")
            if why:
                self.console.fail(f"{capture}: {why}")
            sides.append(self.side(capture, folder))
        for side in sides if not draws else ():
            side.join(set.intersection(*(other.labels() for other in sides)))
        return sides

    def side(self, capture: str, folder: str) -> Side:
        try:
            frame = frame_of(folder)
        except Unreadable as reason:
            self.console.fail(f"{capture}: {reason}")
        source = f"{capture} ({frame['api']}, RenderDoc {frame['renderdoc']}{frame['device'] and ', captured on ' + frame['device']})"
        side = Side(folder, LABELS.get(frame["api"], frame["api"]), source, frame)
        self.console.info(f"{capture}: {len(side.passes)} passes, {frame['bytes'] / 1e6:.1f} MB")
        for note in frame["notes"]:
            self.console.warning(f"{capture}: {note}")
        return side

    def each_draw(self, sides: list[Side]) -> list[Side]:
        """Replays once more: the draws of one pass."""
        names = pass_names(sides[0].passes)
        for pair in Matcher(*sides).match():
            if pair.both and self.draws in (names[pair.first], names[pair.first].split("_")[0]):
                wanted = [side.passes[at] for side, at in zip(sides, (pair.first, pair.second))]
                return self.replay([f"{item['first']}-{item['last']}" for item in wanted], "draws")
        self.console.fail(f"--draws {self.draws}: no pass that both have is called so; there are {', '.join(names)}")

    def pair_sides(self, first: Side, second: Side, names: list[str]) -> list[Pair]:
        matcher = Matcher(first, second)
        if not self.match or self.draws:
            return matcher.match()
        if os.path.exists(self.match):
            return read_match(self.console, self.match, matcher)
        pairs = matcher.match()
        write_match(self.match, (first, second), pairs, names)
        return pairs

    def dump(self, sides: list[Side]) -> list[str]:
        """Folders of the dumps. All sides, and all runs of them, are matched with the first."""
        runs = len(self.groups[0])
        for side in sides if not all(side.frame["samples"] for side in sides) else ():
            side.leave_samples()
        names = pass_names(sides[0].passes)
        folders = [os.path.join(self.folder, "dumps", str(index // runs), str(index % runs)) for index in range(len(sides))]
        matches = [Matched((sides[0], side), self.pair_sides(sides[0], side, names), names) for side in sides[1:]]
        for index, (side, matched) in enumerate(zip(sides[1:], matches), 1):
            dump_other(matched, folders[index])
            if index % runs == 0:
                self.matched.append(matched)
                matched.tell()
            if not any(pair.both for pair in matched.pairs):
                self.console.fail(f"{side.source}: no pass fits one of {sides[0].source}; have both windows one size?")
        dump_first(matches, folders[0])
        return [os.path.dirname(folder) if runs > 1 else folder for folder in folders[::runs]]

    def compare(self, folders: list[str]) -> int:
        self.request.pop("json", None)  # that process writes it
        words = [self.request["program"], "compare", *folders, "--json", self.told]
        for key in ("contracts", "measure", "write_contracts", "pictures", "html", "junit", "run"):
            if key in self.request:
                words += ["--" + key.replace("_", "-"), str(self.request[key])]
        return subprocess.run(words, stdin=subprocess.DEVNULL, check=False).returncode

    # ---- The guilty pass alone -------------------------------------------------------------------

    def run_alone(self, folder: str, words: list[str]) -> guilty.Done:
        """A command of diptych, on what came out of a capture and lies in the folder."""
        program = os.path.realpath(self.request["program"])
        confine = on_mesa([os.path.dirname(program), self.request["templates"]], folder, []) if self.confined else []
        return subprocess.run([*confine, program, *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                              timeout=SECONDS, check=False, preexec_fn=limit)

    def alone(self, matched: Matched, name: str) -> str:
        """What a replay of the pass alone proves."""
        pair, *items = next(both for both in matched.both() if matched.names[both[0].first] == name)

        def made(side: int) -> guilty.Alone:
            item = items[side]
            if item["kind"] not in ("draw", "dispatch") or item["draws"] != 1:
                why = f"it is {item['draws']} draws: --draws {name.split('_')[0]} tells which of them differs"
                why = why if item["kind"] == "draw" else "it is a " + item["kind"]
                return guilty.Alone(matched.labels[side], {"why": why}, "", "", self.run_alone)
            folder = os.path.join(self.folder, f"alone{side}")
            os.mkdir(folder)
            taken = os.path.join(folder, "taken")
            os.mkdir(taken)
            why = replay(self.console, self.confined, "alone", self.groups[side][0], taken, str(item["last"]))
            found = {"why": why} if why else read(taken, TAKEN)["passes"][0]
            return guilty.Alone(matched.labels[side], found, taken, os.path.join(folder, "alone"), self.run_alone)

        sides = [made(0), made(1)]
        for side, label in zip(sides, ("first", "second")):
            if self.save and not side.why:
                shutil.copytree(side.folder, os.path.join(self.save, label, "alone"))
        return guilty.verdict(sides, matched.ported, pair.turned, matched.state.get(name, []))

    def conclude(self) -> None:
        """State beside the first difference, and in --json."""
        with open(self.told, encoding="utf-8") as file:
            told = json.load(file)
        for matched, outcome in zip(self.matched, told.get("pairs", [told])):
            blamed = outcome.get("guilty") or {}
            pass_name = (blamed.get("beyond_noise") or blamed).get("pass", "").removesuffix("_inputs")
            beside = matched.state.get(pass_name, [])
            for text in beside[:MOST_BESIDE] + ([f"{len(beside) - MOST_BESIDE} more, above"] if len(beside) > MOST_BESIDE else []):
                print(f"beside it, in the state of {pass_name}: {printable(text)}")
            print(matched.draws_text())
            if self.save and pass_name in matched.names:
                matched.save(pass_name, self.save)
            outcome["captures"] = matched.json()
            if len(self.matched) == 1 and self.groups[0][1:] == [] and pass_name in matched.names:
                outcome["captures"]["alone"] = self.alone(matched, pass_name)
                print(printable(outcome["captures"]["alone"]))
        write(self.told, json.dumps(told, indent=1))


def main(console: Console, request: Json) -> tuple[int, Json]:
    renderdoc(console)
    status = 2
    try:
        with tempfile.TemporaryDirectory(prefix="diptych-") as folder:
            comparison = Comparison(console, request, folder)
            sides = comparison.replay([], "frame")
            if comparison.draws:
                sides = comparison.each_draw(sides)
            status = comparison.compare(comparison.dump(sides))
            if status < 2:
                comparison.conclude()
    finally:
        for key in ("html", "pictures") if status > 1 else ():
            with suppress(OSError):  # what was made for nothing
                os.rmdir(request[key] if key in request else "")
    sys.stdout.flush()
    return status, {}
