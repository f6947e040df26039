"""Why two copies of a resource differ: tries the faults of why_faults.py, and names one that the evidence holds. The C program
hands over both copies (app/theirs/why.c); the answer goes to stdout.

Each rule of evidence is a function here. Faults are found on one half of the differing elements and confirmed on the other; what is
counted and told is of all elements, or of an even sample above four million."""
from __future__ import annotations

import itertools
import json
import math
from copy import copy as copy_of
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Iterator, Sequence

import numpy as np

from .console import Console
from .why_faults import (AFTER_TURN, CHANNELS, MAPS, PLACES, SHOWN, SHOWN_FIRST, SHOWN_LAST, TRAITS, TURNS, Array, Fault, Point, most_of,
                         phrase, rows_of, ulp, usable)

MOST_SAMPLES, MOST_COUNTED, CHUNK, FEW = 1500, 4 << 20, 1 << 16, 8
NAME_BITS, NUMBER_BITS, DOUBT_BITS = 9, 20, 16  # of a fault's name, of a number that is measured; what must be earned above both
BEYOND = 50  # times the range: errors that are larger, and NaN
FLOATS = {"float": (23, -126, 64), "half": (10, -14, 8), "b10f": (5, -14, 4)}  # bits of fraction, least exponent, ulp of noise
OTHER_FLOATS = 6, -14, 4
KINDS: dict[str, tuple[str, int, int, int]] = {  # of formats.h: type of the bytes, shift, bits, code of 1.0
    "unorm8": ("<u1", 0, 8, 255), "unorm16": ("<u2", 0, 16, 65535), "unorm24": ("<u4", 0, 24, (1 << 24) - 1),
    "snorm16": ("<i2", 0, 16, 32767),
    "half": ("<f2", 0, 16, 0), "float": ("<f4", 0, 32, 0), "r11f": ("<u4", 0, 11, 0), "g11f": ("<u4", 11, 11, 0),
    "b10f": ("<u4", 22, 10, 0),
    "r10": ("<u4", 0, 10, 1023), "g10": ("<u4", 10, 10, 1023), "b10": ("<u4", 20, 10, 1023), "a2": ("<u4", 30, 2, 3),
    "uint": ("<u4", 0, 32, 0), "int": ("<i4", 0, 32, 0),
    "uint8": ("<u1", 0, 8, 0), "int8": ("<i1", 0, 8, 0), "uint16": ("<u2", 0, 16, 0), "int16": ("<i2", 0, 16, 0)}

Chosen = tuple[Fault, tuple[Any, ...]]  # a fault and its parameters
Side = tuple[int, int]  # from and to
Box = tuple[Side, Side, Side]  # layers, rows, columns


def reals(codes: Array, one: int) -> Array:
    values = codes.astype(np.float64)
    return np.maximum(values / one, -1) if one else values


# ---- Copies --------------------------------------------------------------------------------------


class Copy:
    """Numbers of one copy, read where they are asked for. `c` of its components count."""

    def __init__(self, raw: Array, extent: list[int], stride: int, components: list[dict[str, Any]], is_image: bool):
        self.raw, self.stride, self.components, self.c = raw, stride, components, len(components)
        self.w, self.h, self.d = extent if is_image else [extent[0], 1, 1]
        kinds, places = [component["kind"] for component in components], [component["offset"] for component in components]
        types = [KINDS[kind][0] for kind in kinds]
        self.table = np.frombuffer(raw, np.dtype({"names": [f"f{i}" for i in range(self.c)], "formats": types, "offsets": places,
                                                  "itemsize": stride}))

    def column(self, at: Array, i: int) -> Array:
        _, shift, bits, one = KINDS[self.components[i]["kind"]]
        values = self.table[f"f{i}"][at]
        if bits < 8 * values.itemsize:
            values = values >> shift & (1 << bits) - 1
        if self.components[i]["kind"] in ("r11f", "g11f", "b10f"):
            values = (values << 15 - bits).astype("<u2").view("<f2")
        return reals(values, one)

    def get(self, z: Array, y: Array, x: Array) -> Array:
        """A row of numbers for each point; outside the copy NaN."""
        inside = (x >= 0) & (x < self.w) & (y >= 0) & (y < self.h) & (z >= 0) & (z < self.d)
        at = np.where(inside, (z * self.h + y) * self.w + x, 0)
        return np.where(inside[:, None], np.stack([self.column(at, i) for i in range(self.c)], -1), np.nan)


class Pair:
    """Both copies, of which `source` is the one that a fault predicts from; what faults may look at."""

    def __init__(self, question: Question, side: int, differing: Point, others: Point):
        self.source, self.target, self.question, self.side = question.copies[side], question.copies[1 - side], question, side
        self.labels = {"from": question.labels[side], "to": question.labels[1 - side]}
        self.relatives = {which: copy for (of, which), copy in question.relatives.items() if of == side}
        self.w, self.h, self.d, self.c, self.stride = self.target.w, self.target.h, self.target.d, self.target.c, self.target.stride
        self.image, self.kind, self.one, self.integer = question.image, question.kind, question.one, question.integer
        self.step = 1.01 / self.one if self.one else 1e-6 * question.range if not self.integer else 0
        self.range, self.share, self.get = question.range, question.share, self.source.get
        self.differing, self.all = differing, others
        self.differing_from, self.differing_to = self.get(*differing), self.target.get(*differing)
        self.all_from, self.all_to = self.get(*others), self.target.get(*others)
        self.glance: Point = tuple(axis[question.glance] for axis in differing)  # type: ignore[assignment]
        self.glance_to = self.differing_to[question.glance]
        error = question.error(self.differing_from[question.glance], self.glance_to).max(1)
        self.hope = np.median(error) / 5 if len(error) else 0.  # the error that a promising fault leaves at a glance
        self.tenth = question.tenth(error)

    def after(self, fault: Fault, p: tuple[Any, ...]) -> Pair:
        """The same with a fault of place in its source."""
        pair = copy_of(self)
        pair.get = lambda *points: fault.at(self, p, *points)  # type: ignore[misc]
        pair.__dict__.pop("closeness", None)
        return pair

    @cached_property
    def closeness(self) -> float:
        """How far `to` follows `from` in any order of channels."""
        return related(self.get(*self.glance), self.glance_to)

    def has(self, trait: str) -> bool:
        return bool(TRAITS[trait](self))

    def byte(self, x: Array) -> Array:
        return (x * self.stride)[:, None] + np.array([component["offset"] for component in self.target.components[:self.c]])

    def words(self, byte: Array) -> Array:
        """Numbers at any byte; those of packed texels and what lies outside are NaN."""
        kinds = [KINDS[component["kind"]] for component in self.target.components[:self.c]]
        size = np.dtype(kinds[0][0]).itemsize
        whole = self.source.raw[:len(self.source.raw) // size * size]
        inside = (byte >= 0) & (byte + size <= len(whole)) & (byte % size == 0) & [kind[2] == 8 * size for kind in kinds]
        at = np.where(inside, byte // size, 0).T
        return np.where(inside, np.stack([reals(whole.view(kind[0])[own], kind[3]) for kind, own in zip(kinds, at)], -1), np.nan)

    def transposed(self) -> Array:
        side = 4 if self.c % 16 == 0 else 3 if self.c % 9 == 0 else 1
        cells = np.arange(self.c)
        return cells if self.image else cells.reshape(-1, side, side).transpose(0, 2, 1).ravel()

    def crops(self, most: int) -> tuple[Array, Array]:
        """The middle of the box, from a whole tile on, in its first layer, of both."""
        (z, _), *sides = self.question.box
        y, x = np.mgrid[tuple(slice(low + (high - low - n) // 2 // 32 * 32, low + (high - low - n) // 2 // 32 * 32 + n)
                              for low, high in sides for n in [min(high - low, most)])]
        a, b = (np.clip(np.nan_to_num(get(0 * x.ravel() + z, y.ravel(), x.ravel())), -1e6, 1e6).reshape(*x.shape, self.c)
                for get in (self.get, self.target.get))
        return a, b

    def peaks(self) -> list[tuple[float, float]]:
        """Steps by which `to` seems moved, by phase and by plain correlation."""
        a, b = (crop[:, :, :3].mean(2) for crop in self.crops(192 if self.question.box_bits else 512))
        window = np.outer(*(np.hanning(n + 2)[1:-1] for n in a.shape))  # borders stand still
        cross = np.fft.rfft2(window * (a - a.mean())) * np.conj(np.fft.rfft2(window * (b - b.mean())))
        found: dict[tuple[float, float], None] = {}
        for spectrum in (cross / np.maximum(np.abs(cross), 1e-12), cross):
            surface = np.fft.irfft2(spectrum, a.shape)
            for at in np.argpartition(surface, -3, axis=None)[-3:]:
                y, x = np.unravel_index(at, a.shape)
                found[float(x - a.shape[1] * (2 * x > a.shape[1])), float(y - a.shape[0] * (2 * y > a.shape[0]))] = None
        found.pop((0., 0.), None)
        return list(found)


# ---- The question --------------------------------------------------------------------------------


class Question:
    """Two copies, their contract, and samples of the elements that differ beyond it."""

    def __init__(self, request: dict[str, Any], raws: list[Array], relatives: dict[tuple[int, int], tuple[Array, list[int]]],
                 edges: Array | None):
        components, stride, self.image = request["components"], request["stride"], request["image"]
        self.contract, self.labels, self.kind = request["contract"], request["labels"], components[0]["kind"]
        self.bound, self.outliers = request.get("tolerance", 0), request.get("outliers", 0)
        self.one, self.integers = KINDS[self.kind][3], np.array(["int" in component["kind"] for component in components])
        self.integer, self.floats = bool(self.integers[0]), FLOATS.get(self.kind, OTHER_FLOATS)
        self.copies = [Copy(raw, request["extent"], stride, components, self.image) for raw in raws]
        w, h, d = self.extent = self.copies[0].w, self.copies[0].h, self.copies[0].d
        self.box, self.box_bits, self.range, self.most = ((0, d), (0, h), (0, w)), 0., 1., MOST_COUNTED
        self.excused, self.coverage = edges, request.get("coverage", False)
        self.chosen: Any = None
        self.relatives = {key: Copy(raw, extent, stride, components, self.image) for key, (raw, extent) in relatives.items()}
        both = [copy.get(*self.some(np.random.default_rng(1), d * h * w)) for copy in self.copies]
        if self.image and len(components) == 4 and all((values[:, 3] == 1).all() for values in both):
            for copy in [*self.copies, *self.relatives.values()]:  # an artificial fourth channel tells nothing
                copy.c = 3
        sizes = np.abs(np.concatenate(both)[:, :self.copies[0].c])
        sizes = sizes[np.isfinite(sizes) & (sizes < 1e30)]
        self.range = float(sizes.mean()) if len(sizes) and sizes.any() else 1.
        self.look()
        self.whole = self.counted  # of parts, too

    def look(self) -> None:
        """Samples what is in the box."""
        random = np.random.default_rng(1)
        self.elements = math.prod(high - low for low, high in self.box)
        if self.excused is not None:
            self.chosen = None
            self.chosen = np.flatnonzero(self.counts(self.points(np.arange(self.elements))))
            self.elements = len(self.chosen)
        others = self.some(random, self.elements)
        self.before, self.counted, differing = self.sample(random)
        self.glance = np.sort(random.permutation(len(differing))[:256])
        self.pairs = [Pair(self, side, self.points(differing), others) for side in (0, 1)]
        self.first_half = random.permutation(len(differing)) % 2 == 0
        both = self.pairs[0].all_from, self.pairs[0].all_to
        self.broken_before, self.loud_before = self.beyond(*both), self.loud(*both)
        wrong = [(self.loud if self.are_loud else self.beyond)(self.pairs[0].differing_from[:, i:i + 1],
                                                               self.pairs[0].differing_to[:, i:i + 1]).mean() > 0.02
                 for i in range(self.copies[0].c if self.image and len(differing) else 0)]
        self.touched = tuple(int(i) for i in np.flatnonzero(wrong)) if not all(wrong) else ()

    def within(self, box: Box, most: int) -> Question:
        """The same of a part, of which so many elements are counted. A box costs bits, as many as it takes to tell it from others."""
        part = copy_of(self)
        part.box, part.most, part.box_bits = box, most, 2 * sum(math.log2(size) for size in self.extent) + math.log2(LOOKS)
        part.look()
        return part

    def some(self, random: Any, count: int) -> Point:
        return self.points(random.integers(0, count, MOST_SAMPLES) if count > MOST_SAMPLES else np.arange(count))

    def points(self, elements: Array) -> Point:
        """Elements are counted in the box."""
        elements = elements if self.chosen is None else self.chosen[elements]
        (z, _), (y, rows), (x, columns) = self.box
        w, h = columns - x, rows - y
        return z + elements // (w * h), y + elements // w % h, x + elements % w

    def counts(self, points: Point) -> Array:
        """Not what `raster` allows: at edges, and of depth, what is covered in both copies."""
        z, y, x = points
        if self.excused is None:
            return np.ones(len(x), bool)
        covered = self.coverage & np.concatenate([copy.get(*points) != 1 for copy in self.copies], 1).all(1)
        return ~self.excused[(z * self.extent[1] + y) * self.extent[0] + x] & ~covered

    def error(self, want: Array, got: Array) -> Array:
        """Of each number; what is NaN in one is far off."""
        apart = np.abs(want - got)
        apart[(want == got) | (np.isnan(want) & np.isnan(got))] = 0
        return np.where(apart <= BEYOND * self.range, apart, BEYOND * self.range)

    def beyond(self, want: Array, got: Array) -> Array:
        """The same yardstick before and after: whether a number of each row breaks the contract."""
        kind, bound = self.contract, self.bound
        apart, size = np.abs(want - got), np.fmax(np.abs(want), np.abs(got))
        fine = np.zeros(apart.shape, bool)
        if kind == "ulp":
            fine = self.ulps(want, got) <= bound + 1e-3
            fine &= ~self.integers[:want.shape[1]] | (bound > 1)
        elif kind in ("abs", "image"):
            fine = apart <= bound * (1 + 1e-9)
        elif kind == "rel":
            fine = apart <= bound * size
        elif kind == "of_exact":  # a code or step of a small float is nothing
            step = (self.ulps(want, got) <= 1 + 1e-3) & (self.kind != "float")
            fine = (apart <= 2 * bound * np.fmax(size, 1e-3)) | (step & ~self.integers[:want.shape[1]])
        return ~(fine | (want == got) | (np.isnan(want) & np.isnan(got))).all(1)

    def loud(self, want: Array, got: Array) -> Array:
        """Where noise lies on all, a fault of a part is still more than that."""
        return (self.steps(want, got) > (1.5 if self.one or self.integer else self.floats[2])).any(1)

    def steps(self, want: Array, got: Array) -> Array:
        """Errors in codes, of integers in ones, of floats in ulp: of the larger one, or of a hundredth of the range."""
        size = np.fmax(np.fmax(np.abs(want), np.abs(got)), 0.01 * self.range)
        return self.error(want, got) * max(self.one, 1) / (1 if self.one or self.integer else ulp(size, *self.floats[:2]))

    def ulps(self, want: Array, got: Array) -> Array:
        """Codes or floats between both, of integers their distance."""
        apart = np.abs(want - got)
        step = ulp(np.fmin(np.abs(want), np.abs(got)), *self.floats[:2])
        return apart * self.one if self.one else apart if self.integer else apart / step

    def rounded(self, values: Array) -> Array:
        """As far as the format holds them."""
        if self.one:
            return np.rint(np.clip(values, -1 if self.kind == "snorm16" else 0, 1) * self.one) / self.one
        kinds = {"half": np.float16, "float": np.float32}
        return values.astype(kinds[self.kind]).astype(np.float64) if self.kind in kinds else values

    def tenth(self, error: Array) -> Array:
        """Of the error, or a code: a fault that leaves less makes good."""
        return np.fmax(error / 10, 1.01 / self.one if self.one else 0)

    def bits(self, error: Array, got: Array) -> Array:
        """What it takes to write the errors of each row down, in the smallest steps of its numbers."""
        size = np.fmax(np.abs(np.nan_to_num(got)), 1e-3 * self.range)
        unit = 1 / self.one if self.one else 1. if self.integer else size * 2. ** (-1 - self.floats[0])
        return np.where(error <= 2 * unit, 0, np.log2(1 + error / unit)).sum(1)

    def chunks(self, step: int) -> Iterator[tuple[Array, Point]]:
        """All elements, one in `step`."""
        for start in range(0, self.elements, CHUNK * step):
            at = np.arange(start, min(start + CHUNK * step, self.elements), step)
            yield at, self.points(at)

    def stride(self) -> int:
        return (self.elements // self.most + 1) | 1

    def sample(self, random: Any) -> tuple[int, int, Array]:
        """How many elements are beyond, and beyond noise if these are not too few; a sample of them."""
        kept, count, most = np.zeros((2, 0)), 0, 0  # with random numbers, of which the least are kept: those of noise last
        for at, points in self.chunks(self.stride()):
            both = [copy.get(*points) for copy in self.copies]
            beyond, loud = self.beyond(*both), self.loud(*both)
            count, most = count + int(beyond.sum()), most + int((beyond & loud).sum())
            kept = np.concatenate([kept, [random.random(np.count_nonzero(beyond)) + ~loud[beyond], at[beyond]]], 1)
            kept = kept[:, np.argsort(kept[0])[:MOST_SAMPLES]]
        self.are_loud = most >= FEW
        counted = min((most if self.are_loud else count) * self.stride(), self.elements)
        self.share = counted / max(self.elements, 1)
        return min(count * self.stride(), self.elements), counted, np.sort(kept[1, kept[0] < 2 - self.are_loud].astype(int))


# ---- Rules of evidence ---------------------------------------------------------------------------


@dataclass(eq=False)
class Trial:
    """Faults in a row that may explain the pair: of place, of channels, of numbers; and what they leave."""
    pair: Pair
    faults: list[Chosen]
    choices: int = 1  # parameters that were tried
    only: tuple[int, ...] = ()  # channels that maps change; none: all
    values: dict[str, Array] = field(default_factory=dict)  # by the pair's samples, after the faults of place
    inside: bool = False  # it holds for the elements alone that differ
    left: float = 1.
    falls: bool = False
    bits: float = math.inf
    errors: tuple[float, float] = (0., 0.)  # medians before and after
    after: int = 0

    def plus(self, fault: Fault, p: tuple[Any, ...], only: tuple[int, ...] = ()) -> Trial:
        """With a map more."""
        return Trial(self.pair, [*self.faults, (fault, p)], self.choices, only, self.values)

    def on(self, question: Question) -> Trial:
        """The same of a part, or of the whole."""
        return Trial(question.pairs[self.pair.side], self.faults, self.choices, self.only)

    def share(self) -> float:
        """Of all that differs, what it explains."""
        return (1 if self.falls else 1 - self.left) * self.pair.question.counted / self.pair.question.whole

    def fitted(self) -> int:
        return sum(fault.found for fault, _ in self.faults)

    def model_bits(self) -> float:
        return sum(NAME_BITS + NUMBER_BITS * fault.found for fault, _ in self.faults) + math.log2(self.choices) + len(self.only)

    def steps(self) -> Iterator[tuple[Pair, Fault, tuple[Any, ...]]]:
        """The faults, each with the pair that those before it leave."""
        pair = self.pair
        for fault, p in self.faults:
            yield pair, fault, p
            pair = pair.after(fault, p) if fault.at else pair

    def placed(self, points: Point) -> Array:
        """Outside a picture that was drawn smaller lies one colour."""
        last = [step for step in self.steps() if step[1].at][-1:]
        if not last:
            return self.pair.get(*points)
        pair, fault, p = last[0]
        values = fault.at(pair, p, *points)  # type: ignore[misc]
        unknown = np.isnan(values).all(1)
        if fault.name == "scale" and unknown.sum() > 8:
            colour, share = most_of(pair.target.get(*points)[unknown])
            values = np.where(unknown[:, None], colour, values) if share > 0.95 else values
        return values

    def at(self, samples: str) -> Array:
        """What it makes of the pair's points of that name."""
        if samples not in self.values:
            self.values[samples] = self.placed(getattr(self.pair, samples))
        return self.mapped(self.values[samples])

    def predict(self, points: Point) -> Array:
        return self.mapped(self.placed(points))

    def mapped(self, values: Array) -> Array:
        known = np.isfinite(values).all(1)
        for fault, p in self.faults:
            if fault.map:
                new = fault.map(p, values)
                if self.only and fault in MAPS:
                    kept = [i for i in range(self.pair.c) if i not in self.only]
                    new[:, kept] = values[:, kept]
                values = new
        values = self.pair.question.rounded(values)
        values[known[:, None] & np.isnan(values)] = np.inf  # a map without a value there is wrong, not unknown
        return values


class Evidence:
    """What a trial makes of samples: of elements that differ, and of any. Rows that it does not know are left out."""

    def __init__(self, trial: Trial):
        pair, want = trial.pair, trial.at("differing")
        question, got = pair.question, pair.differing_to
        self.pair, self.trial, self.question, self.got = pair, trial, question, got
        self.known = ~np.isnan(want).all(1)
        want = np.where(np.isnan(want) & self.known[:, None], got, want)
        self.before, self.after = question.error(pair.differing_from, got), question.error(want, got)
        self.worst = [error.max(1) for error in (self.before, self.after)]
        self.wrong = question.beyond(want, got) & self.known
        middle = np.median(got, 0)
        self.constant = np.fmin(self.worst[0], question.error(middle, got).max(1))
        self.varied = question.loud(middle + 0 * got, got)
        self.want_all, self.part = trial.at("all"), question.box_bits > 0
        if self.part and trial.faults[0][0].at:  # where rows are flat, any texel fits
            z, y, x = pair.differing
            self.constant = np.fmin(self.constant, question.error(pair.target.get(z, y, np.maximum(x - 1, 0)), got).max(1))
        self.fitted = trial.fitted()
        self.is_fitted_map = any(fault.found and fault.map for fault, _ in trial.faults)

    @cached_property
    def distinct(self) -> Array:
        """Of the second half one row of each kind: few distinct values prove little, whatever their number. A fault of place is proved
        by neighbourhoods, one of numbers by what it makes, or by what it throws away."""
        pair, chosen = self.pair, ~self.question.first_half & self.known
        z, y, x = (axis[chosen] for axis in pair.differing)
        parts = [self.got[chosen]]
        if self.trial.faults[0][0].at and pair.image:
            right, below = np.minimum(x + 1, pair.w - 1), np.minimum(y + 1, pair.h - 1)
            parts += [pair.target.get(z, y, right), pair.target.get(z, below, x)]
        elif any(fault.loses for fault, _ in self.trial.faults):
            parts.append(pair.get(z, y, x))
        rows = np.concatenate(parts, 1)
        if not self.question.integers.any():  # noise makes no kinds
            step = 1e-3 * np.subtract(*np.quantile(rows, (0.9, 0.1), axis=0)) if len(rows) else np.zeros(1)
            rows = np.where(step > 0, np.rint(rows / step), rows)
        _, first = np.unique(rows_of(rows), return_index=True)
        return np.flatnonzero(chosen)[first]


def explains(e: Evidence) -> bool:
    """On both halves, nine tenths are within the contract, or the errors fall."""
    for rows in (e.question.first_half & e.known, ~e.question.first_half & e.known, e.known):
        if rows.mean() < 0.1:
            return False
        e.trial.left, e.trial.falls = float(e.wrong[rows].mean()), falls(e, rows)
        if e.trial.left > 0.1 and not e.trial.falls:
            return False
    return True


def falls(e: Evidence, rows: Array) -> bool:
    """Median and 99th percentile of the errors fall by ten, against those of one value for all, too; by more for each number that was
    fitted, in a part by far more, and codes must be within the contract then. Integers are equal or not."""
    if e.question.integer or not (rows & e.varied).any() or (e.is_fitted_map and e.question.one):
        return False
    before, after = (np.sort(errors)[[len(errors) // 2, int(0.99 * (len(errors) - 1))]]
                     for errors in (e.constant[rows & e.varied], e.worst[1][rows]))
    return bool((after <= before / (30 ** e.fitted if e.is_fitted_map else 10) / (20 if e.part else 1)).all())


def spoils_nothing(e: Evidence) -> bool:
    """What is within the contract stays so; a part of the elements that differ says nothing of others."""
    question, pair = e.question, e.pair
    lost = np.isnan(e.want_all).any(1)
    spoilt = question.beyond(e.want_all, pair.all_to) & ~question.broken_before
    if e.trial.left > 0.1:  # nearer, not equal: what was equal may be off by rounding, too
        spoilt &= question.error(e.want_all, pair.all_to).max(1) > np.median(e.worst[0]) / 1000
    spoilt |= question.loud(e.want_all, pair.all_to) & ~question.loud_before
    e.trial.bits += 100 * np.count_nonzero(spoilt & ~lost)
    return bool((spoilt & ~lost).mean() <= 0.1 * question.share)


def is_varied(e: Evidence) -> bool:
    """One value in most of it: any place of the other copy may have it. A map is not proved by neighbourhoods."""
    places = sum(bool(fault.at) for fault, _ in e.trial.faults)
    if places > 1 - e.part and e.varied[e.known].mean() < 0.5:
        return False
    is_map = any(fault.map and not fault.loses for fault, _ in e.trial.faults)
    moved = (e.pair.differing_from != e.got).any(0)  # what is equal in both copies proves nothing
    return not is_map or len(np.unique(rows_of(e.got[e.distinct][:, moved]))) >= least_kinds(e)


def least_kinds(e: Evidence) -> int:
    """A few kinds of elements prove nothing, but where the fault is neither measured nor its own inverse."""
    fixed = any(fault.map and fault.sided and not fault.found for fault, _ in e.trial.faults)
    return FEW if e.pair.image and not fixed else 2


def is_no_luck(e: Evidence) -> bool:
    """What the fault saves, on elements on which it was not found, is more than what it takes to describe it; in a part, four times."""
    question, part, chosen = e.question, e.part or e.trial.inside, e.distinct
    saved = (question.bits(e.before, e.got) - question.bits(e.after, e.got))[chosen]
    least = (e.trial.model_bits() + DOUBT_BITS + question.box_bits) * (4 if part else 1)
    return bool(np.count_nonzero(saved > 0) >= (2 * FEW if part else least_kinds(e)) and saved.sum() >= least)


def loses_nothing(e: Evidence) -> bool:
    """What a fault throws away is what `to` truly lacks."""
    return all(fault.loses is None or fault.loses(pair, p, e.pair.all_from, e.pair.all_to) for pair, fault, p in e.trial.steps())


def is_solid(e: Evidence) -> bool:
    """A fault that holds where they differ alone, as in one object: they lie side by side, and one number at most is measured. In a
    part it shows what to look for."""
    if e.part or e.fitted > 1:
        return e.part
    z, y, x = e.pair.differing
    beside = [(z, np.clip(y + j, 0, e.pair.h - 1), np.clip(x + i, 0, e.pair.w - 1)) for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    return bool(np.mean([e.question.beyond(*(copy.get(*points) for copy in e.question.copies)) for points in beside]) > 0.85)


def judge(trial: Trial) -> bool:
    """All rules, on samples. Fills what the trial leaves."""
    e, pair = Evidence(trial), trial.pair
    if not explains(e):
        return False
    residual = float(pair.question.bits(np.where(e.known[:, None], e.after, e.before), e.got).sum())
    trial.bits = residual * (1 + 0.1 * e.fitted) + trial.model_bits()
    trial.errors = float(np.median(e.worst[0][e.known])), float(np.median(e.worst[1][e.known]))
    trial.inside = not spoils_nothing(e)
    return (not trial.inside or is_solid(e)) and is_varied(e) and is_no_luck(e) and loses_nothing(e)


def is_one_way(question: Question, error: Array) -> bool:
    """Whether codes of a channel err one way, by two or in most elements: rounding errs both ways, or keeps half of them."""
    for channel in error.T * question.one:
        wrong = channel[channel != 0]
        most = question.share * len(wrong) > 0.6 * len(channel) or np.abs(wrong).max(initial=0) > 1.5
        if len(wrong) >= 64 and most and max((wrong > 0).mean(), (wrong < 0).mean()) > 0.95:
            return True
    return False


def noise_of(question: Question) -> str | None:
    """A few ulp or codes, of both signs: rounding, never a cause."""
    pair = question.pairs[0]
    a, b = pair.differing_from, pair.differing_to
    if question.integer or len(a) < 2 or not np.isfinite(a).all() or not np.isfinite(b).all():
        return None
    error = b - a
    up, count = float((error[error != 0] > 0).mean()), len(a) if question.one else math.ceil(0.99 * len(a))
    most, unit = float(np.sort(question.steps(a, b).max(1))[count - 1]), "code" if question.one else "ulp"
    if most > (2.01 if question.one else question.floats[2]) or not (0.1 <= up <= 0.9 or most <= 4):
        return None
    if question.one and is_one_way(question, error):
        return None
    count = max(1, round(most))
    return f"rounding noise of {count} {unit}{'s' if unit == 'code' and count > 1 else ''}; no systematic cause"


# ---- Search --------------------------------------------------------------------------------------


def ties(values: Array, target: Array) -> Array:
    """How far each channel of `to`, in rows, follows each of `from` in order, whatever map is between: correlations of ranks."""
    known, ranks = np.isfinite(values).all(1) & np.isfinite(target).all(1), []
    if known.sum() < 32:
        return np.zeros((target.shape[1], values.shape[1]))
    for own in (target[known], values[known]):
        order = np.stack([np.searchsorted(column, numbers) + np.searchsorted(column, numbers, "right")
                          for column, numbers in zip(np.sort(own, 0).T, own.T)], 1).astype(float)
        order -= order.mean(0)
        ranks.append(order / np.maximum(np.sqrt((order ** 2).sum(0)), 1e-9))
    return ranks[0].T @ ranks[1]


def follows(values: Array, target: Array) -> float:
    """How far the channels of `to` that vary follow the same ones, all upwards or all downwards."""
    tie, varied = np.diag(ties(values, target)), np.ptp(target, 0) > 0
    return abs(float(tie[varied].mean())) if varied.any() else 0.


def related(values: Array, target: Array) -> float:
    """How far each channel of `to` follows some channel."""
    return float(np.abs(ties(values, target)).max(1).mean())


def trials(pairs: Sequence[Pair], faults: list[Fault]) -> Iterator[Trial]:
    """Each fault alone, with all its parameters."""
    for pair in pairs:
        for fault in faults:
            if pair.has(fault.applies) and (fault.sided or pair.side == 0):
                choices = fault.fit(pair, pair.differing, pair.differing_to) if fault.fit else [fault.p]
                for p in choices:
                    yield Trial(pair, [(fault, p)], len(choices))


class Search:
    def __init__(self, question: Question):
        self.question = question
        self.best: Trial | None = None
        self.inside: Trial | None = None  # the best that holds where they differ alone
        self.partial: list[tuple[int, Trial]] = []  # faults that explain a few

    def attempt(self, trial: Trial) -> None:
        promising, hits = self.glance(trial)
        if promising and judge(trial):
            other = self.inside if trial.inside else self.best
            if other is None or trial.bits < other.bits - 0.5:
                self.best, self.inside = (self.best, trial) if trial.inside else (trial, self.inside)
        elif hits >= 5 and not any(fault.found and fault.map for fault, _ in trial.faults):
            self.partial.append((hits, trial))

    def glance(self, trial: Trial) -> tuple[bool, int]:
        """At few elements: most faults are far off. Counts those whose error falls."""
        pair, question, got, want = trial.pair, self.question, trial.pair.glance_to, trial.at("glance")
        unknown = np.isnan(want)
        known = ~unknown.all(1)
        want = np.where(unknown, got, want)
        after = question.error(want, got).max(1)
        hits = np.count_nonzero((after <= pair.tenth) & ~unknown.any(1))
        after = after[known]
        if known.mean() < 0.2 or 2 * np.count_nonzero(after <= 4 * pair.hope) < len(after):
            return False, hits
        near = 2 * np.count_nonzero(after <= pair.hope) >= len(after)
        return bool(near or question.beyond(want, got)[known].mean() <= 0.25), hits

    def fits(self) -> Trial | None:
        """Faults alone whose numbers are measured."""
        for pair in self.question.pairs:
            self.maps_on(Trial(pair, []), True)
        for trial in trials(self.question.pairs, [fault for fault in PLACES if fault.name in LOCAL]):
            self.attempt(trial)
        return self.best or self.inside

    def maps_on(self, before: Trial, fitted: bool = False) -> None:
        """On all channels, on colours alone, on those alone that differ. Most maps keep the order of numbers."""
        pair, question, values = before.pair, self.question, before.at("differing")
        alone, rows = not (fitted or before.faults), question.first_half  # alone it may hold in a part
        for only in dict.fromkeys([(), (0, 1, 2) if pair.image and pair.c == 4 else (), question.touched]):
            count = list(only) or list(range(min(3, pair.c) if pair.image else pair.c))
            v, target = values[rows][:, count], pair.differing_to[rows][:, count]
            own = usable(pair, v.ravel(), target.ravel())
            ordered = alone or len(v) < 64 or follows(v[:256], target[:256]) > 0.4
            for fault in MAPS:
                fits = ordered or fault.loses or fault.name in UNORDERED
                if fits and pair.has(fault.applies) and (fault.fit or not fitted):
                    for p in fault.fit(pair, *own) if fault.fit else [fault.p]:
                        self.attempt(before.plus(fault, p, only))

    def run(self) -> Trial | None:
        """First one fault of each kind, then faults of numbers and channels where those of place come nearest."""
        plain = [Trial(pair, []) for pair in self.question.pairs]
        near: list[tuple[float, int, Trial]] = []
        closeness = related(plain[0].at("glance"), plain[0].pair.glance_to)
        for trial in trials(self.question.pairs, PLACES):
            self.attempt(trial)
            closer = related(trial.at("glance"), trial.pair.glance_to)
            if closer > max(0.7, 0.5 + 0.5 * closeness):  # than without a fault of place
                near.append((-closer, len(near), trial))
        more: list[Trial] = []
        for before in plain:
            self.maps_on(before)
            more += self.channels_on(before)
        if self.best and self.best.left <= 0.1:
            return self.best
        for *_, before in sorted(near)[:8]:
            self.maps_on(before)
            more += self.channels_on(before)
        for before in more:
            self.maps_on(before)
        for pair, turn in itertools.product(self.question.pairs, () if self.best else TURNS):
            for trial in trials([pair.after(turn, turn.p)], AFTER_TURN) if pair.has(turn.applies) else ():
                self.attempt(Trial(pair, [(turn, turn.p), *trial.faults], trial.choices))
        return self.best

    def channels_on(self, before: Trial) -> list[Trial]:
        """Those after which a map may hold."""
        pair, target, values = before.pair, before.pair.glance_to, before.at("glance")
        least = 0.1 + 0.9 * follows(values, target)
        more: list[tuple[float, int, Trial]] = []
        for fault in CHANNELS:
            if pair.has(fault.applies):
                trial = before.plus(fault, fault.p)
                self.attempt(trial)
                more.append((-follows(trial.at("glance"), target), len(more), trial))
        return [trial for closeness, _, trial in sorted(more)[:2] if -closeness > least]


# ---- Answers -------------------------------------------------------------------------------------


def holds(trial: Trial) -> bool:
    """What the samples say is so of all elements: counts those left beyond the contract. Unknown ones stay as they were."""
    pair, question, left = trial.pair, trial.pair.question, 0
    step = question.stride()
    for _, points in question.chunks(step):
        want, got = trial.predict(points), pair.target.get(*points)
        unknown = np.isnan(want)
        wrong = question.beyond(np.where(unknown, got, want), got)
        left += int((wrong & question.beyond(pair.get(*points), got) if trial.inside else wrong).sum())
    trial.after = min(left * step, question.elements)
    return trial.after <= (1 if trial.falls else 0.1) * question.before


def reason_of(trial: Trial) -> dict[str, Any]:
    """In words, with what is left; of a part, with its share."""
    question = trial.pair.question
    words = ", and ".join(phrase(fault, p, trial.pair.labels) for fault, p in trial.faults)
    if trial.only and trial.only != (0, 1, 2):
        words += f", in {' and '.join(CHANNEL_NAMES[i] for i in trial.only)} alone"
    exact, outliers = question.contract in ("exact", "flips", "raster"), question.outliers * question.elements
    head = "far nearer"
    if trial.after == 0:
        head = "equal (to a code)" if question.one and not exact else "equal"
    elif trial.after <= {"flips": question.bound, "image": outliers, "of_exact": 2 * outliers}.get(question.contract, 0):
        head = "within the contract"
    elif trial.after <= 0.1 * question.before:
        head = "nearly equal"
    counts = f"{question.before} {'differs' if question.before == 1 else 'differ'} before, {trial.after} after"
    if head == "far nearer":
        counts += f"; median error {trial.errors[0]:.2g} before, {trial.errors[1]:.2g} after"
    reason = {"name": trial.faults[0][0].name, "text": f"{head} {words} ({counts})", "before": question.before,
              "after": trial.after}
    if trial.inside or question.box_bits:
        names = [f"{name} {low}" + f" to {high - 1}" * (high - 1 > low)
                 for name, (low, high), size in zip(("layer", "y", "x"), question.box, question.extent[::-1]) if size > 1]
        place = "where they differ alone" if trial.inside else f"in {', '.join(names)}"
        reason |= {"share": trial.share(), "text": f"{percent(trial.share())}, {place}: {reason['text']}"}
    return reason


def shown(question: Question, faults: list[Fault]) -> list[dict[str, Any]]:
    """The first place where all differences are, or what both copies show together."""
    for fault in faults:
        for trial in trials(question.pairs, [fault]):
            (_, p), pair = trial.faults[0], trial.pair
            left = fault.mark(pair, p)  # type: ignore[misc]
            if left is not None and left <= fault.leaves:
                after = math.ceil(left * question.before)
                counts = f"{question.before} {'breaks' if question.before == 1 else 'break'} the contract, {after} of them elsewhere"
                return [{"name": fault.name, "text": f"differs {phrase(fault, p, pair.labels)} ({counts})", "before": question.before,
                         "after": after}]
    return []


CHANNEL_NAMES = ("red", "green", "blue", "alpha")
LOOKS, LEAST_PIECE = 50, 32  # of pieces: boxes that are tried, and what is told
LEAST_SHARE, PLAIN_SHARE, MEASURED_SHARE = 0.01, 0.03, 0.1  # if most is explained; else without and with numbers that are measured
UNORDERED = ("byte_order", "reciprocal")  # maps that keep no order, and lose nothing
LOCAL = ("shift", "depth_bias")  # faults of place whose numbers are measured in a part


def percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share > 0.095 else f"{100 * share:.2g} %"


def size_of(question: Question) -> str:
    """How large the differences are, for the head of the verdict."""
    values = np.concatenate([pair.all_from for pair in question.pairs])
    values = values[np.isfinite(values)]
    span = 1. if question.one else float(np.quantile(values, 0.99) - np.quantile(values, 0.01)) if len(values) else 0.
    span = span or float(np.abs(values).max(initial=0)) or 1.
    points = question.points(np.arange(0, question.elements, max(1, question.elements // 20000)))
    errors = question.error(*(copy.get(*points) for copy in question.copies)).max(1) if question.elements else np.zeros(1)
    mean, large = (float(v) / span for v in (errors.mean(), np.quantile(errors, 0.99)))
    return f"mean {percent(mean)} of the range, {'visible' if large >= 1.5 / 255 else 'hardly visible'}"


# ---- Pieces --------------------------------------------------------------------------------------


def some_of(low: int, high: int, most: int = 256) -> range:
    return range(low, high, -(-(high - low) // most))


def weights_of(trial: Trial, z: int, rows: Sequence[int], columns: Sequence[int]) -> Array:
    """Where a trial explains what differs, and where it does not, in these rows and columns of one layer."""
    pair, question = trial.pair, trial.pair.question
    y, x = (axis.ravel() for axis in np.meshgrid(rows, columns, indexing="ij"))
    points = np.full_like(x, z), y, x
    source, got, want = pair.get(*points), pair.target.get(*points), trial.predict(points)
    differs = question.counts(points) & question.beyond(source, got) & (~question.are_loud | question.loud(source, got))
    known = ~np.isnan(want).any(1)
    before, after = (question.error(values, got).max(1) for values in (source, want))
    good = known & (after <= question.tenth(before))
    misses = np.where(differs, ~good, question.loud(want, got)) & known
    return (np.where(good & differs, 1., 0) - 9 * misses).reshape(len(rows), len(columns))


def best_run(weights: Array) -> slice:
    """With the largest sum; of equal ones the shortest."""
    sums = np.concatenate([[0], np.cumsum(weights)])
    end = int((sums - np.minimum.accumulate(sums)).argmax())
    return slice(end - int(sums[end::-1].argmin()), end)


def best_box(trial: Trial, z: int, *sides: Sequence[int]) -> tuple[float, Side, Side, int]:
    """The rectangle of those rows and columns where the trial explains most, grown from a cell where it does."""
    weights = weights_of(trial, z, *sides)
    starts = [np.arange(0, size, -(-size // 12)) for size in weights.shape]
    cells = np.add.reduceat(np.add.reduceat(weights, starts[0], 0), starts[1], 1)
    first = starts[0][cells.argmax() // len(starts[1])]
    runs = [slice(first, first + -(-len(weights) // 12)), slice(0)]
    for _ in range(3):
        runs[1] = best_run(weights[runs[0]].sum(0))
        runs[0] = best_run(weights[:, runs[1]].sum(1))
    gain = float(weights[tuple(runs)].sum())
    places = [(side[run.start], side[run.stop - 1] + 1) if gain > 0 else (0, 0) for side, run in zip(sides, runs)]
    return gain, places[0], places[1], z


def has_sharp_sides(trial: Trial, box: Box) -> bool:
    """Right outside, the fault explains no more: a part of a surface that only looks so has no straight sides."""
    (z, _), *sides = box
    for axis, ((low, high), size) in enumerate(zip(sides, trial.pair.question.extent[1::-1])):
        wide = max(2, (high - low) // 16)
        for strip in ((max(0, low - wide), low), (high, min(size, high + wide))):
            if strip[0] < strip[1]:
                weights = weights_of(trial, z, *(some_of(*side) for side in sides[:axis] + [strip] + sides[axis + 1:]))
                if (weights > 0).sum() > 0.5 * max(4, (weights != 0).sum()):
                    return False
    return True


def piece_of(trial: Trial) -> Trial | None:
    """What the trial explains, if that is a box: judged there by all rules."""
    question = trial.pair.question
    w, h, d = question.extent
    gain, rows, columns, z = max(best_box(trial, z, some_of(0, h), some_of(0, w)) for z in some_of(0, d, 8))
    if gain < FEW:
        return None
    if max(h, w) > 256:  # to the texel
        few = [some_of(low, high, 64) for low, high in (rows, columns)]
        wide = [range(max(0, low - size // 128), min(size, high + size // 128)) for (low, high), size in ((rows, h), (columns, w))]
        rows, columns = best_box(trial, z, wide[0], few[1])[1], best_box(trial, z, few[0], wide[1])[2]
    box = ((z, z + 1), rows, columns)
    if any(high - low < min(FEW, size) for (low, high), size in ((rows, h), (columns, w))):  # a line looks like much
        return None
    piece = trial.on(question.within(box, MOST_COUNTED >> 4))
    found = piece.pair.question.before >= LEAST_PIECE and judge(piece) and not piece.inside and holds(piece)
    return piece if found and has_sharp_sides(trial, box) else None


def overlap(box: Box, other: Box) -> bool:
    return all(low < other_high and other_low < high for (low, high), (other_low, other_high) in zip(box, other))


def pieces(question: Question, search: Search) -> list[Trial]:
    """Faults that explain a part, then fits in cells of the picture; of those that overlap, the largest."""
    found = [piece_of(trial) for _, trial in sorted(search.partial, key=lambda item: -item[0])[:10]]
    for box in cells(question):
        if not any(piece and overlap(piece.pair.question.box, box) for piece in found):
            part = question.within(box, MOST_COUNTED >> 8)
            trial = Search(part).fits() if part.before >= 2 * FEW else None
            found.append(trial and piece_of(trial.on(question)))
    chosen: list[Trial] = []
    for piece in sorted(filter(None, found), key=lambda piece: (-round(piece.share(), 2), piece.bits)):
        if piece.share() >= LEAST_SHARE and not any(overlap(piece.pair.question.box, other.pair.question.box) for other in chosen):
            chosen.append(piece)
    told = sum(piece.share() for piece in chosen)
    measured = 1. if question.one else MEASURED_SHARE  # any change of light nearly is a factor on few codes
    return [piece for piece in chosen if told > 0.5 or piece.share() >= (measured if piece.fitted() else PLAIN_SHARE)]


def cells(question: Question) -> Iterator[Box]:
    """The box of all that differs, and its parts."""
    layers, *sides = ((int(axis.min()), int(axis.max()) + 1) for axis in question.pairs[0].differing)
    parts = [[(low + i * (high - low) // 6, low + (i + 1) * (high - low) // 6) for i in range(6)] for low, high in sides]
    for layer in some_of(*layers, 8):
        for rows, columns in [tuple(sides), *itertools.product(*parts)]:
            if rows[0] < rows[1] and columns[0] < columns[1]:
                yield (layer, layer + 1), rows, columns


def answer(question: Question) -> dict[str, Any]:
    result: dict[str, Any] = {"why": [], "noise": False, "size": size_of(question)}
    if not question.before:
        return result
    why, search = shown(question, SHOWN_FIRST), Search(question)
    noise = None if why else noise_of(question)
    if noise and not question.one:
        return {**result, "why_not": noise, "noise": True}
    trial = search.run() if not why and question.before >= FEW else None
    why = [reason_of(trial)] if trial and holds(trial) else why or shown(question, SHOWN)
    if not why and search.inside and holds(search.inside):
        parts = [search.inside]
    else:
        parts = pieces(question, search) if not why and not noise and question.before >= 2 * FEW else []
    if parts:
        left = 1 - sum(piece.share() for piece in parts)
        result["why"] = [reason_of(piece) for piece in parts]
        return {**result, "why_not": "the rest has no simple cause"} if left > 0.01 else result
    why = why or shown(question, SHOWN_LAST)
    return {**result, "why": why, **({} if why else {"why_not": noise or "no simple cause", "noise": bool(noise)})}


def ask(request: dict[str, Any], raws: list[Array], relatives: dict[tuple[int, int], tuple[Array, list[int]]],
        edges: Array | None = None) -> dict[str, Any]:
    with np.errstate(all="ignore"):
        return answer(Question(request, raws, relatives, edges))


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    """All content is in one file."""
    content, answers = np.memmap(request["content"], np.uint8, "r"), []

    def taken(place: list[int]) -> Array:
        return content[place[0]:place[0] + place[1]]

    for question in request["questions"]:
        relatives = {(item["side"], item["which"]): (taken(item["file"]), item["extent"]) for item in question["relatives"]}
        edges = taken(question["edges"]) > 0 if "edges" in question else None
        answers.append(ask(question, [taken(place) for place in question["files"]], relatives, edges))
        if request["until_loud"] and not answers[-1]["noise"]:
            break
    print(json.dumps(answers))
    return 0, {}
