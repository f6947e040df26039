"""Which passes of two captured frames belong together, and which of their resources; for compare.py. Names are no keys: labels stand
on one side only, and runs of one program differ in the order of passes.

The pass that leaves the presented picture anchors. Passes with equal contents, in either order of rows, match whatever their order;
the others by size, class of format, kind and place."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .differ import bare

Json = dict[str, Any]
NEAR = 0.01        # distance of contents that count as equal
ALIKE = 0.5        # ... as inputs of one shape that no name tells apart
TURNED = 0.02      # least difference of distances that votes for an order of rows
LEAST_SCORE = 2.0


@dataclass
class Side:
    """A replayed frame; `folder` holds what replay.py wrote."""

    folder: str
    label: str
    source: str
    frame: Json

    @property
    def passes(self) -> list[Json]:
        return [item for item in self.frame["passes"] if item["entries"]]

    def labels(self) -> set[str]:
        return {name for item in self.frame["passes"] for name in item["where"]}

    def join(self, labels: set[str]) -> None:
        """Of a run of draws into the same targets, parts that other labels part become one pass."""
        joined: list[Json] = []
        before = None
        for item in self.frame["passes"]:
            place = item["run"], [name for name in item["where"] if name in labels]
            if place == before:
                add_part(joined[-1], item)
            else:
                joined.append(item)
            before = place
        self.frame["passes"] = joined

    def leave_samples(self) -> None:
        """A pass of which nothing else is read has what its samples are resolved into next, so that its state is compared."""
        for item, after in zip(self.frame["passes"], [*self.frame["passes"][1:], {"kind": ""}]):
            item["entries"] = [entry for entry in item["entries"] if "samples" not in entry]
            if not item["entries"] and (item["kind"], after["kind"]) == ("draw", "resolve"):
                item.update(entries=after["entries"], left_out=[])
                after["entries"] = []


def add_part(whole: Json, part: Json) -> None:
    """The second is of the same run, and follows."""
    for state in part["states"]:
        state["draw"] += whole["draws"]
    whole["chosen"] += [at + whole["draws"] if at >= 0 else -1 for at in part["chosen"]]
    names = [item["where"][-1].split(" to ")[end] if item["where"] else "no label" for item, end in ((whole, 0), (part, -1))]
    whole["where"] = [" to ".join(names)]
    entries = {(entry["id"], entry.get("mip")): entry for item in (whole, part) for entry in item["entries"]}
    whole.update({key: whole[key] + part[key] for key in ("draws", "counts", "states", "inputs", "left_out")},
                 reads={**whole["reads"], **part["reads"]}, last=part["last"], shaders=part["shaders"], entries=list(entries.values()))


@dataclass
class Pair:
    """Indices of two passes; -1: only the other side has it. `contents`: entries of both; `inputs` likewise."""

    first: int
    second: int
    contents: list[tuple[Json, Json]] = field(default_factory=list)
    inputs: list[tuple[Json, Json, bool]] = field(default_factory=list)  # and whether rows are in the opposite order
    turned: bool = False  # rows of the second are in the opposite order

    @property
    def both(self) -> bool:
        return min(self.first, self.second) >= 0


def numbers_of(entry: Json) -> str:
    form = entry.get("format", "")
    return "depth" if form.startswith("d") else "integer" if form.endswith("i") else "colour"


def same_shape(first: Json, second: Json) -> bool:
    if first["kind"] != second["kind"] or first.get("mip", 0) != second.get("mip", 0):
        return False
    if first["kind"] == "buffer":
        return bool(first["count"] == second["count"])
    keys = ("width", "height", "layers", "samples")
    return numbers_of(first) == numbers_of(second) and all(first.get(key) == second.get(key) for key in keys)


def pair_up(firsts: list[Json], seconds: list[Json]) -> list[tuple[Json, Json]]:
    """Those of one shape: of one name first, then in order."""
    free = list(seconds)
    pairs: list[tuple[Json, Json]] = []
    for by_name in (True, False):
        for entry in firsts:
            if any(entry is taken for taken, _ in pairs):
                continue
            for other in free:
                if same_shape(entry, other) and (not by_name or entry["resource"] == other["resource"]):
                    pairs.append((entry, other))
                    free.remove(other)
                    break
    return sorted(pairs, key=lambda pair: firsts.index(pair[0]))


def distance(first: np.ndarray, second: np.ndarray) -> float:
    """0 equal to 1 nothing in common."""
    if first.ndim == 3 == second.ndim and first.shape[:2] == second.shape[:2]:
        count = min(first.shape[-1], second.shape[-1], 3)
        first, second = first[..., :count], second[..., :count]
    if first.shape != second.shape:
        return 1.0
    scale = sum(float(np.abs(item - np.median(item)).mean()) for item in (first, second)) + 1e-9
    return float(min(1.0, np.abs(first - second).mean() / scale))


class Matcher:
    def __init__(self, first: Side, second: Side):
        self.sides, self.passes = (first, second), (first.passes, second.passes)
        self.known: dict[tuple[str, str], tuple[float, float]] = {}

    def distances(self, entry: Json, other: Json) -> tuple[float, float]:
        """With rows in the same order, and in the opposite one."""
        if entry["file"] == other["file"]:
            turned = 0.0 if entry["turned"] == other["file"] else 1.0
            return 0.0, turned
        if entry["turned"] == other["file"]:
            return 1.0, 0.0
        key = entry["file"], other["file"]
        if key not in self.known:
            first, second = self.sides[0].frame["small"][key[0]], self.sides[1].frame["small"][key[1]]
            self.known[key] = distance(first, second), distance(first[::-1], second) if first.ndim == 3 else 1.0
        return self.known[key]

    def score(self, first: Json, second: Json) -> tuple[int, float]:
        """1 for equal contents, and how well two passes fit."""
        entries = first["entries"], second["entries"]
        pairs = pair_up(*entries)
        screens = [any(entry["screen"] for entry in side) for side in entries]
        mips = first["kind"] == "mips" == second["kind"]
        if not pairs or (mips and not same_shape(entries[0][0], entries[1][0])):
            return 0, -1.0
        apart = [min(self.distances(*pair)) for pair in pairs]
        colours = [gap for gap, pair in zip(apart, pairs) if numbers_of(pair[0]) == "colour"] or apart  # depth has conventions
        score = len(pairs) / max(map(len, entries)) + 4 * (1 - sum(colours) / len(colours))
        score += 0.5 * (first["kind"] == second["kind"]) + sum(0.25 * (first[key] == second[key]) for key in ("draws", "counts"))
        if first["where"] and second["where"]:
            score += 1.0 if first["where"][-1] == second["where"][-1] else -0.5
        textures = [{bare(name) for state in item["states"] for name in state["samplers"]} for item in (first, second)]
        score += 1.0 * bool(textures[0] & textures[1])
        if screens[0] != screens[1]:
            score -= 1.5
        elif screens[0]:
            score += 0.5
        return int(max(colours) < NEAR), score

    def match(self) -> list[Pair]:
        """In the order of the first side's passes; those without a partner stand behind."""
        sizes = [max(1, len(side) - 1) for side in self.passes]
        order = []
        for i, first in enumerate(self.passes[0]):
            for k, second in enumerate(self.passes[1]):
                equal, score = self.score(first, second)
                away = abs(i / sizes[0] - k / sizes[1])
                if score > LEAST_SCORE:
                    order.append((equal, score - (0.01 if equal else 3.0) * away, -i, -k))
        free = [set(range(len(side))) for side in self.passes]
        pairs = []
        for _, _, i, k in self.anchor() + sorted(order, reverse=True):
            if -i in free[0] and -k in free[1]:
                pairs.append(Pair(-i, -k))
                free[0].discard(-i)
                free[1].discard(-k)
        for i in sorted(free[0]):  # nothing in common, but shape, kind and place: a pass that draws nothing on one side
            for k in sorted(free[1]):
                first, second = self.passes[0][i], self.passes[1][k]
                count = len(pair_up(first["entries"], second["entries"]))
                beside = all((pair.first < i) == (pair.second < k) for pair in pairs)
                if beside and first["kind"] == second["kind"] and count == len(first["entries"]) == len(second["entries"]):
                    pairs.append(Pair(i, k))
                    free[0].discard(i)
                    free[1].discard(k)
                    break
        pairs.sort(key=lambda pair: pair.first)
        pairs += [Pair(i, -1) for i in sorted(free[0])] + [Pair(-1, k) for k in sorted(free[1])]
        return self.fill(pairs)

    def anchor(self) -> list[tuple[int, float, int, int]]:
        """The last passes that leave the window's picture."""
        last = [[index for index, item in enumerate(side) if any(entry["screen"] for entry in item["entries"])] for side in self.passes]
        if not all(last):
            return []
        first, second = last[0][-1], last[1][-1]
        return [(1, 0.0, -first, -second)] if pair_up(self.passes[0][first]["entries"], self.passes[1][second]["entries"]) else []

    # ---- Conventions -----------------------------------------------------------------------------

    def doubled_depth(self, pairs: list[Pair]) -> bool:
        """Whether most depth of OpenGL is z / 2 + 1 / 2 of Vulkan's: a program that uses half of OpenGL's clip space."""
        votes = []
        for entry, other in (contents for pair in pairs for contents in pair.contents if numbers_of(contents[0]) == "depth"):
            values = [side.frame["small"][item["file"]][..., 0] for side, item in zip(self.sides, (entry, other))]
            own, theirs = values if self.sides[0].label == "gl" else reversed(values)
            theirs = min((theirs, theirs[::-1]), key=lambda rows: float(np.abs(own - rows).sum()))
            gaps = [float(np.abs(rows - theirs).sum()) for rows in (own, 2 * own - 1)]
            votes += [gaps[1] < gaps[0] / 10] if max(gaps) > TURNED else []
        return self.sides[0].label != self.sides[1].label and 2 * sum(votes) > len(votes)

    # ---- Rows and inputs -------------------------------------------------------------------------

    def majority(self, pairs: list[Pair], across: bool) -> dict[str, bool]:
        """Of each kind of pass, whether the targets that are no window's have opposite rows: one that is alone stays a fault. So does
        the only one of its kind, but across APIs, or where others are turned, too."""
        votes: dict[str, int] = {}
        for pair in pairs:
            kind = self.passes[0][pair.first]["kind"]
            for entry, other in pair.contents:
                same, turned = self.distances(entry, other)
                if entry["kind"] == "image" and not entry["screen"] and not other["screen"] and abs(same - turned) > TURNED:
                    votes[kind] = votes.get(kind, 0) + (1 if turned < same else -1)
        least = 0 if across or sum(votes.values()) > 2 else 1
        return {kind: count > least for kind, count in votes.items()}

    def fill(self, pairs: list[Pair]) -> list[Pair]:
        both = [pair for pair in pairs if pair.both]
        for pair in both:
            first, second = self.passes[0][pair.first], self.passes[1][pair.second]
            pair.contents = pair_up(first["entries"], second["entries"])
        across = self.sides[0].frame["api"] != self.sides[1].frame["api"]
        turned = self.majority(both, across)
        for pair in both:
            screen = any(entry["screen"] for contents in pair.contents for entry in contents)
            pair.turned = across if screen else turned.get(self.passes[0][pair.first]["kind"], False)
        self.pair_inputs(both)
        return pairs

    def pair_inputs(self, pairs: list[Pair]) -> None:
        """Of matched passes: of a name that each has once; then of equal contents, also of another pass; then the only ones of a shape that
        are left, and those that look alike."""
        free = [[entry for item in side for entry in item["inputs"]] for side in self.passes]
        partners: dict[int, int] = {}

        def left(side: int, entries: list[Json], like: Json) -> list[Json]:
            return [item for item in entries if same_shape(like, item) and any(item is other for other in free[side])]

        for last in (False, True):
            for pair in pairs:
                first, second = self.passes[0][pair.first]["inputs"], self.passes[1][pair.second]["inputs"]
                names = [[bare(entry["resource"]) for entry in side if not entry.get("mip")] for side in (first, second)]
                for entry in [item for item in first if any(item is other for other in free[0])]:
                    if entry.get("mip"):  # one of the texture whose first level is paired
                        found = [other for other in left(1, free[1], entry) if other["id"] == partners.get(entry["id"])]
                    elif not last:
                        name, files = bare(entry["resource"]), (entry["file"], entry["turned"])
                        found = [other for other in left(1, second, entry) if bare(other["resource"]) == name
                                 and names[0].count(name) == 1 == names[1].count(name)]
                        found += [other for other in left(1, free[1], entry) if other["file"] in files]
                    else:
                        found = left(1, second, entry)
                        if not len(found) == 1 == len(left(0, first, entry)):
                            apart = [(min(self.distances(entry, other)), at) for at, other in enumerate(found) if other["kind"] == "image"]
                            found = [found[at] for gap, at in sorted(apart) if gap < ALIKE]
                    if found:
                        partners[entry["id"]] = found[0]["id"]
                        same, turned = self.distances(entry, found[0])
                        pair.inputs.append((entry, found[0], entry["kind"] == "image" and same - turned > TURNED))
                        free = [[item for item in side if item is not taken] for side, taken in zip(free, (entry, found[0]))]
