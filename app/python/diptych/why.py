"""Why two copies of a resource differ: tries the faults of why_faults.py, and names one that the evidence holds. The C program
hands over both copies (app/theirs/why.c); the answer goes to stdout.

Each rule of evidence is a function here. Faults are found on one half of the differing elements and confirmed on the other; what is
counted and told is of all elements, or of an even sample above four million."""
from __future__ import annotations

import itertools
import json
import math
from copy import copy as copy_of
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Iterator, Sequence

import numpy as np

from .console import Console
from .why_faults import AFTER_TURN, CHANNELS, MAPS, PLACES, SHOWN, TRAITS, Array, Fault, Point, most_of, phrase, rows_of

MOST_SAMPLES, MOST_COUNTED, CHUNK, FEW = 1500, 4 << 20, 1 << 16, 8
NAME_BITS, NUMBER_BITS, DOUBT_BITS = 9, 20, 16  # of a fault's name, of a number that is measured; what must be earned above both
BEYOND = 50  # times the range: errors that are larger, and NaN
ULP_NOISE = {"float": 64, "half": 8}
FRACTION = {"float": 23, "half": 10, "b10f": 5}  # bits, of other packed floats 6
KINDS: dict[str, tuple[str, int, int, int]] = {  # type of the bytes, shift, bits, code of 1.0
    "unorm8": ("<u1", 0, 8, 255), "unorm16": ("<u2", 0, 16, 65535), "unorm24": ("<u4", 0, 24, (1 << 24) - 1),
    "snorm16": ("<i2", 0, 16, 32767),
    "half": ("<f2", 0, 16, 0), "float": ("<f4", 0, 32, 0), "r11f": ("<u4", 0, 11, 0), "g11f": ("<u4", 11, 11, 0),
    "b10f": ("<u4", 22, 10, 0),
    "r10": ("<u4", 0, 10, 1023), "g10": ("<u4", 10, 10, 1023), "b10": ("<u4", 20, 10, 1023), "a2": ("<u4", 30, 2, 3),
    "uint": ("<u4", 0, 32, 0), "int": ("<i4", 0, 32, 0),
    "uint8": ("<u1", 0, 8, 0), "int8": ("<i1", 0, 8, 0), "uint16": ("<u2", 0, 16, 0), "int16": ("<i2", 0, 16, 0)}  # as enum number_kind

Box = tuple[tuple[int, int], tuple[int, int], tuple[int, int]]  # from and to of layers, rows, columns


def is_integer(kind: str) -> bool:
    return "int" in kind


# ---- Copies --------------------------------------------------------------------------------------


class Copy:
    """Numbers of one copy, read where they are asked for. `c` of its components count."""

    def __init__(self, raw: Array, extent: list[int], stride: int, components: list[dict[str, Any]], is_image: bool):
        self.raw, self.stride, self.components, self.c = raw, stride, components, len(components)
        self.w, self.h, self.d = extent if is_image else [extent[0], 1, 1]
        self.turn: tuple[float, ...] = (0, 0)  # whether x and y run backwards
        kinds, places = [component["kind"] for component in components], [component["offset"] for component in components]
        types = [KINDS[kind][0] for kind in kinds]
        self.table = np.frombuffer(raw, np.dtype({"names": [f"f{i}" for i in range(self.c)], "formats": types, "offsets": places,
                                                  "itemsize": stride}))
        size = np.dtype(types[0]).itemsize
        self.dense = len(set(kinds)) == 1 and places == list(range(0, stride, size)) and KINDS[kinds[0]][2] == 8 * size
        self.flat = np.frombuffer(raw, types[0]).reshape(-1, self.c) if self.dense else None

    def column(self, at: Array, i: int) -> Array:
        _, shift, bits, one = KINDS[self.components[i]["kind"]]
        values = self.table[f"f{i}"][at]
        if bits < 8 * values.itemsize:
            values = values >> shift & (1 << bits) - 1
        if self.components[i]["kind"] in ("r11f", "g11f", "b10f"):
            values = (values << 15 - bits).astype("<u2").view("<f2")
        values = values.astype(np.float64)
        return np.maximum(values / one, -1) if one else values

    def values(self, at: Array) -> Array:
        if self.flat is None:
            return np.stack([self.column(at, i) for i in range(self.c)], -1)
        values = self.flat[at][:, :self.c].astype(np.float64)
        one = KINDS[self.components[0]["kind"]][3]
        return np.maximum(values / one, -1) if one else values

    def get(self, z: Array, y: Array, x: Array) -> Array:
        """A row of numbers for each point; outside the copy NaN."""
        x, y = (size - 1 - at if turn else at for size, at, turn in zip((self.w, self.h), (x, y), self.turn))
        inside = (x >= 0) & (x < self.w) & (y >= 0) & (y < self.h) & (z >= 0) & (z < self.d)
        if inside.all():
            return self.values((z * self.h + y) * self.w + x)
        out = np.full((len(inside), self.c), np.nan)
        out[inside] = self.values(((z * self.h + y) * self.w + x)[inside])
        return out


class Pair:
    """Both copies, of which `source` is the one that a fault predicts from; what faults may look at."""

    def __init__(self, copies: list[Copy], side: int, relatives: dict[int, Copy], question: Question):
        self.source, self.target, self.relatives, self.question = copies[side], copies[1 - side], relatives, question
        self.w, self.h, self.d, self.c, self.stride = self.target.w, self.target.h, self.target.d, self.target.c, self.target.stride
        self.image, self.kind, self.one, self.integer = question.image, question.kind, question.one, is_integer(question.kind)
        self.step = 1.01 / self.one if self.one else 1e-6 * question.range if not self.integer else 0
        self.range, self.share, self.get, self.told = question.range, question.share, self.source.get, ()
        self.hope = 0.  # the error that a promising fault leaves at a glance

    def set_points(self, differing: Point, others: Point) -> None:
        self.differing, self.all = differing, others
        self.differing_from, self.differing_to = self.get(*differing), self.target.get(*differing)
        self.all_from, self.all_to = self.get(*others), self.target.get(*others)

    def other(self) -> Copy:
        return self.target

    def turned(self, turn: tuple[float, ...]) -> Pair:
        """The same with its source turned."""
        pair = copy_of(self)
        pair.source = copy_of(self.source)
        pair.source.turn, pair.get = turn, pair.source.get
        return pair

    def has(self, trait: str) -> bool:
        return bool(TRAITS[trait](self))

    def near(self, a: Array, b: Array) -> Array:
        """Whether rows are the same but for noise in both."""
        return ~self.question.loud(a, b) | (self.question.error(a, b).max(1) * self.one < 2.5 if self.one else False)

    def byte(self, x: Array) -> Array:
        return (x * self.stride)[:, None] + np.array([component["offset"] for component in self.target.components[:self.c]])

    def words(self, byte: Array) -> Array:
        whole = np.frombuffer(self.source.raw[:len(self.source.raw) // 4 * 4], "<u4")
        inside = (byte >= 0) & (byte + 4 <= 4 * len(whole)) & (byte % 4 == 0)
        bits = whole[np.where(inside, byte // 4, 0)]
        values = np.stack([bits[:, i].view(KINDS[component["kind"]][0]).astype(np.float64) if KINDS[component["kind"]][2] == 32
                           else np.full(len(bits), np.nan)
                           for i, component in enumerate(self.target.components[:self.c])], -1)
        return np.where(inside, values, np.nan)

    def transposed(self) -> Array:
        side = 4 if self.c % 16 == 0 else 3 if self.c % 9 == 0 else 1
        return np.arange(self.c).reshape(-1, side, side).transpose(0, 2, 1).ravel() if side > 1 and not self.image else np.arange(self.c)

    def raw_to(self) -> Array:
        z, y, x = self.differing
        whole = np.frombuffer(self.target.raw, np.uint8)
        return whole[:len(whole) // self.stride * self.stride].reshape(-1, self.stride)[(z * self.h + y) * self.w + x]

    def mask(self) -> Array:
        """Which texels differ beyond the contract, of one layer."""
        found, chosen = np.zeros(self.h * self.w, bool), self.question.chosen
        found[slice(None) if chosen is None else chosen] = np.concatenate([beyond for _, beyond, _ in self.question.chunks(1)])
        return found.reshape(self.h, self.w)

    def crops(self, most: int) -> tuple[Array, Array]:
        """The middle of the box, in its first layer, of both."""
        (z, _), *sides = self.question.box
        h, w = (min(high - low, most) for low, high in sides)
        y, x = (a.ravel() for a in np.mgrid[tuple(slice((low + high - n) // 2, (low + high - n) // 2 + n)
                                                  for (low, high), n in zip(sides, (h, w)))])
        a, b = (np.clip(np.nan_to_num(side.get(0 * x + z, y, x)), -1e6, 1e6).reshape(h, w, self.c) for side in (self.source, self.target))
        return a, b

    def error_crop(self) -> Array:
        """Of the channel that differs most."""
        a, b = self.crops(256)
        return (b - a)[:, :, np.abs(b - a).sum((0, 1)).argmax()]

    def peaks(self) -> list[tuple[float, float]]:
        """Steps by which `to` seems moved, by phase and by plain correlation."""
        a, b = (crop[:, :, :3].mean(2) for crop in self.crops(192 if self.question.box_bits else 512))
        cross = np.fft.rfft2(a - a.mean()) * np.conj(np.fft.rfft2(b - b.mean()))
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
        self.one, self.integers = KINDS[self.kind][3], np.array([is_integer(component["kind"]) for component in components])
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

    def look(self) -> None:
        """Samples what is in the box."""
        random = np.random.default_rng(1)
        self.elements = math.prod(high - low for low, high in self.box)
        if self.excused is not None:
            self.chosen = None
            self.chosen = np.flatnonzero(self.counts(self.points(np.arange(self.elements))))
            self.elements = len(self.chosen)
        others = self.some(random, self.elements)
        self.before, self.counted, differing, self.errors = self.sample(random)
        self.pairs = [Pair(self.copies, side, {which: copy for (of, which), copy in self.relatives.items() if of == side}, self)
                      for side in (0, 1)]
        self.glance = np.sort(random.permutation(len(differing))[:256])
        for pair in self.pairs:
            pair.set_points(self.points(differing), others)
            pair.hope = np.median(self.error(pair.differing_from, pair.differing_to)[self.glance].max(1)) / 5 if len(differing) else 0.
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
        wrong = ~(apart <= 0) & ~(want == got) & ~(np.isnan(want) & np.isnan(got))
        if kind == "ulp":
            far = apart * self.one > bound + 1e-3 if self.one else self.ulps(want, got) > bound
            exact = self.integers[:want.shape[1]] if bound <= 1 else np.zeros(want.shape[1], bool)
            wrong &= ~(~far & ~exact)
        elif kind in ("abs", "image"):
            wrong &= ~(apart <= bound * (1 + 1e-9))
        elif kind == "rel":
            wrong &= ~(apart <= bound * size)
        elif kind == "of_exact":  # a code or step of a small float is nothing
            step = apart * self.one <= 1 + 1e-3 if self.one else (self.ulps(want, got) <= 1) & (self.kind != "float")
            wrong &= ~((apart <= 2 * bound * np.fmax(size, 1e-3)) | (step & ~self.integers[:want.shape[1]]))
        return wrong.any(1)

    def allowed(self) -> float:
        """How many elements may break the contract."""
        outliers = self.outliers * self.elements
        return float({"flips": self.bound, "image": outliers, "of_exact": 2 * outliers}.get(self.contract, 0))

    def loud(self, want: Array, got: Array) -> Array:
        """Where noise lies on all, a fault of a part is still more than that."""
        apart = self.error(want, got)
        if self.one or is_integer(self.kind):
            return apart.max(1) * max(self.one, 1) > 1.5
        return (apart > ULP_NOISE.get(self.kind, 4) * self.ulp(want, got)).any(1)

    def ulp(self, want: Array, got: Array) -> Array:
        """Of the larger one, or of a hundredth of the range."""
        _, exponent = np.frexp(np.fmax(np.fmax(np.abs(want), np.abs(got)), 0.01 * self.range))
        return np.ldexp(1., exponent - 1 - FRACTION.get(self.kind, 6))

    def ulps(self, want: Array, got: Array) -> Array:
        """Floats between both; of integers, their distance."""
        if is_integer(self.kind):
            return np.abs(want - got)
        if self.kind in ("half", "float"):
            float_type, integer, top = (np.float16, np.int16, 0x8000) if self.kind == "half" else (np.float32, np.int32, 1 << 31)
            a, b = (v.astype(float_type).view(integer).astype(np.int64) for v in (want, got))
            return np.abs(np.where(a < 0, -(a + top), a) - np.where(b < 0, -(b + top), b)).astype(float)
        _, exponent = np.frexp(np.fmax(np.abs(want), np.abs(got)))
        return np.abs(want - got) / np.ldexp(1., np.maximum(exponent - 1, -14) - FRACTION.get(self.kind, 6))

    def rounded(self, values: Array) -> Array:
        """As far as the format holds them."""
        if self.one:
            return np.rint(np.clip(values, -1 if self.kind == "snorm16" else 0, 1) * self.one) / self.one
        kinds = {"half": np.float16, "float": np.float32}
        return values.astype(kinds[self.kind]).astype(np.float64) if self.kind in kinds else values

    def hits(self, source: Array, want: Array, got: Array) -> Array:
        """Where a fault makes the error a tenth, or less than a code."""
        before, after = self.error(source, got).max(1), self.error(want, got).max(1)
        return after <= np.fmax(before / 10, 1.01 / self.one if self.one else 0)

    def bits(self, error: Array, got: Array) -> Array:
        """What it takes to write the errors of each row down, in the smallest steps of its numbers."""
        size = np.fmax(np.abs(np.nan_to_num(got)), 1e-3 * self.range)
        unit = 1 / self.one if self.one else 1. if is_integer(self.kind) else size * 2. ** (-1 - FRACTION.get(self.kind, 6))
        return np.where(error <= 2 * unit, 0, np.log2(1 + error / unit)).sum(1)

    def chunks(self, step: int) -> Iterator[tuple[Array, Array, Array]]:
        """All elements, one in `step`; whether they are beyond, and by more than rounding."""
        for start in range(0, self.elements, CHUNK * step):
            at = np.arange(start, min(start + CHUNK * step, self.elements), step)
            points = self.points(at)
            a, b = (copy.get(*points) for copy in self.copies)
            yield at, self.beyond(a, b), self.loud(a, b)

    def stride(self) -> int:
        return (self.elements // self.most + 1) | 1

    def sample(self, random: Any) -> tuple[int, int, Array, Array]:
        """How many elements are beyond, and beyond noise if these are not too few; a sample of them, and of the errors of all."""
        sets, count, most = [np.zeros((2, 0))] * 2, 0, 0  # each with a random number, of which the least are kept
        for at, beyond, loud in self.chunks(self.stride()):
            count, most = count + int(beyond.sum()), most + int((beyond & loud).sum())
            for i, chosen in enumerate((beyond & loud, beyond)):
                more = np.concatenate([sets[i], [random.random(np.count_nonzero(chosen)), at[chosen]]], 1)
                sets[i] = more[:, np.argsort(more[0])[:MOST_SAMPLES]]
        self.are_loud = most >= FEW
        counted = min((most if self.are_loud else count) * self.stride(), self.elements)
        self.share = counted / max(self.elements, 1)
        at = np.arange(0, self.elements, max(1, self.elements // 20000))
        points = self.points(at)
        errors = self.error(*(copy.get(*points) for copy in self.copies)).max(1) if len(at) else np.zeros(1)
        return min(count * self.stride(), self.elements), counted, np.sort(sets[not self.are_loud][1].astype(int)), errors


# ---- Rules of evidence ---------------------------------------------------------------------------


def placed_values(faults: list[tuple[Fault, tuple[float, ...]]], pair: Pair, points: Point) -> Array:
    """What a fault of place makes, if the first one is such. Outside a picture that was drawn smaller lies one colour."""
    fault, p = faults[0] if faults else (None, ())
    if not fault or not fault.at:
        return pair.get(*points)
    values = fault.at(pair, p, *points)
    unknown = np.isnan(values).all(1)
    if fault.fills and unknown.sum() > 8:
        colour, share = most_of(pair.target.get(*points)[unknown])
        values = np.where(unknown[:, None], colour, values) if share > 0.95 else values
    return values


@dataclass
class Trial:
    """Faults in a row that may explain the pair: of place, of channels, of numbers; and what they leave."""
    faults: list[tuple[Fault, tuple[float, ...]]]
    side: int
    only: tuple[int, ...]  # channels that maps change; none: all
    choices: int = 1  # parameters that were tried
    left: float = 1.
    falls: bool = False
    bits: float = math.inf
    errors: tuple[float, float] = (0., 0.)  # medians before and after
    after: int = 0

    def model_bits(self) -> float:
        bits = sum(NAME_BITS * fault.names + NUMBER_BITS * fault.found for fault, _ in self.faults)
        return bits + math.log2(self.choices) + len(self.only)

    def predict(self, pair: Pair, points: Point) -> Array:
        return self.rest(pair, placed_values(self.faults, pair, points), self.faults)

    def rest(self, pair: Pair, values: Array, faults: list[tuple[Fault, tuple[float, ...]]]) -> Array:
        known = np.isfinite(values).all(1)
        for fault, p in faults:
            if fault.map is None:
                continue
            new = fault.map(p, values)
            if self.only and fault in MAPS:
                kept = [i for i in range(pair.c) if i not in self.only]
                new[:, kept] = values[:, kept]
            values = new
        values = pair.question.rounded(values)
        values[known[:, None] & np.isnan(values)] = np.inf  # a map without a value there is wrong, not unknown
        return values


def falls(before: Array, after: Array, fall: float) -> bool:
    """The whole distribution of errors is so much less, than that of one value for all, too; none if `before` is empty."""
    return bool(fall and len(before) and all(np.quantile(after, share) <= np.quantile(before, share) / fall for share in (0.5, 0.99)))


def least_fall(question: Question, trial: Trial) -> float:
    """By ten; where a number was fitted by more, and codes must be within the contract then. Integers are equal or not."""
    fitted = any(fault.found and fault.map for fault, _ in trial.faults)
    return 0 if is_integer(question.kind) or fitted and question.one else 30 if fitted else 10


def loses_nothing(pair: Pair, trial: Trial, value: Array, target: Array) -> bool:
    """What a fault throws away is what `to` truly lacks."""
    return all(fault.loses is None or fault.loses(pair, p, value, target) for fault, p in trial.faults)


def distinct(trial: Trial, pair: Pair, points: Point, target: Array, chosen: Array) -> Array:
    """Of the chosen rows, one of each kind: few distinct values prove little, whatever their number. A fault of place is proved by
    neighbourhoods, one of numbers by what it makes, or by what it throws away."""
    z, y, x = (axis[chosen] for axis in points)
    if trial.faults[0][0].at and pair.image:
        parts = [target[chosen], pair.target.get(z, y, np.minimum(x + 1, pair.w - 1)), pair.target.get(z, np.minimum(y + 1, pair.h - 1), x)]
    else:
        parts = [target[chosen], *([pair.get(z, y, x)] if any(fault.loses for fault, _ in trial.faults) else [])]
    _, first = np.unique(rows_of(np.concatenate(parts, 1)), return_index=True)
    return np.flatnonzero(chosen)[first]


def is_no_luck(trial: Trial, saved: Array, bits: float, few: int) -> bool:
    """What the fault saves, on elements on which it was not found, is more than what it takes to describe it; in a part, four times.
    A few kinds of elements prove nothing."""
    least = (trial.model_bits() + DOUBT_BITS + bits) * (4 if bits else 1)
    return bool(np.count_nonzero(saved > 0) >= (2 * FEW if bits else few) and saved.sum() >= least)


def is_promising(pair: Pair, want: Array) -> bool:
    """A glance at few elements: most faults are far off."""
    question, glance = pair.question, pair.question.glance
    got = pair.differing_to[glance]
    unknown = np.isnan(want)
    known = ~unknown.all(1)
    if known.mean() < 0.2:
        return False
    want = np.where(unknown, got, want)
    after = question.error(want, got).max(1)[known]
    fall = [2 * np.count_nonzero(after <= share * pair.hope) >= len(after) for share in (1, 4)]
    return bool(fall[0] or (fall[1] and question.beyond(want, got)[known].mean() <= 0.25))


def judge(pair: Pair, trial: Trial, want: Array, want_all: Array) -> bool:
    """All rules, on samples. Fills what the trial leaves."""
    question, got = pair.question, pair.differing_to
    unknown = np.isnan(want).all(1)
    if unknown.mean() > 0.75:
        return False
    missing = np.isnan(want) & ~unknown[:, None]
    want = np.where(missing, got, want)
    before, after = question.error(pair.differing_from, got), question.error(want, got)
    wrong = question.beyond(want, got) & ~unknown
    worst = [error.max(1) for error in (before, after)]
    middle = np.median(got, 0)
    constant, varied = np.fmin(worst[0], question.error(middle, got).max(1)), question.loud(middle + 0 * got, got)
    for rows in (question.first_half & ~unknown, ~question.first_half & ~unknown, ~unknown):
        if not rows.any():
            return False
        trial.left, trial.falls = float(wrong[rows].mean()), falls(constant[rows & varied], worst[1][rows], least_fall(question, trial))
        if trial.left > 0.1 and not trial.falls:  # at least nine tenths are within the contract, or the errors fall
            return False
    lost = np.isnan(want_all).any(1)
    broken = question.beyond(want_all, pair.all_to) & ~question.broken_before & ~lost
    if trial.left > 0.1:  # nearer, not equal: what was equal may be off by rounding, too
        broken &= question.error(want_all, pair.all_to).max(1) > np.median(worst[0]) / 1000
    broken |= question.loud(want_all, pair.all_to) & ~question.loud_before & ~lost
    if broken.mean() > 0.1 * question.share:
        return False
    chosen = distinct(trial, pair, pair.differing, got, ~question.first_half & ~unknown)
    saved = (question.bits(before, got) - question.bits(after, got))[chosen]
    fitted = sum(fault.found for fault, _ in trial.faults)
    residual = float(question.bits(np.where(unknown[:, None], before, after), got).sum())
    trial.bits = residual * (1 + 0.1 * fitted) + trial.model_bits() + 100 * broken.sum()
    trial.errors = float(np.median(worst[0][~unknown])), float(np.median(worst[1][~unknown]))
    if trial.faults[0][0].at and (question.box_bits or trial.faults[0][0].names > 1) and varied[~unknown].mean() < 0.5:
        return False  # one value in most of it: any place of the other copy may have it
    fixed = any(fault.map and fault.sided and not fault.found for fault, _ in trial.faults)  # not measured, nor its own inverse
    few = FEW if pair.image and not fixed else 2
    if any(fault.map and not fault.loses for fault, _ in trial.faults) and len(np.unique(rows_of(got[chosen]))) < few:
        return False  # a map is not proved by neighbourhoods
    return is_no_luck(trial, saved, question.box_bits, few) and loses_nothing(pair, trial, pair.all_from, pair.all_to)


def noise_of(question: Question) -> str | None:
    """A few ulp or codes, of both signs: rounding, never a cause."""
    pair = question.pairs[0]
    a, b = pair.differing_from, pair.differing_to
    if is_integer(question.kind) or len(a) < 2 or not np.isfinite(a).all() or not np.isfinite(b).all():
        return None
    error = b - a
    up = float((error[error != 0] > 0).mean())
    if question.one:
        most, unit = float(np.abs(error).max() * question.one), "code"
        small = most <= 2.01
    else:
        most, unit = float(np.quantile((np.abs(error) / question.ulp(a, b)).max(1), 0.99)), "ulp"
        small = most <= ULP_NOISE.get(question.kind, 4)
    if not small or not (0.1 <= up <= 0.9 or most <= 4):
        return None
    count = max(1, round(most))
    return f"rounding noise of {count} {unit}{'s' if unit == 'code' and count > 1 else ''}; no systematic cause"


# ---- Search --------------------------------------------------------------------------------------


def ranks(values: Array) -> Array:
    """Of each column, without its mean, of length 1. Equal numbers have one rank."""
    order = np.stack([np.searchsorted(column, own) + np.searchsorted(column, own, "right")
                      for column, own in zip(np.sort(values, 0).T, values.T)], 1).astype(float)
    order -= order.mean(0)
    return order / np.maximum(np.sqrt((order ** 2).sum(0)), 1e-9)


def follows(values: Array, target: Array) -> float:
    """How far the channels of `to` that vary follow the same ones, all upwards or all downwards."""
    known = np.isfinite(values).all(1) & np.isfinite(target).all(1)
    varied = np.ptp(target[known], 0) > 0 if known.any() else np.zeros(1, bool)
    if known.sum() < 32 or not varied.any():
        return 0.
    return abs(float((ranks(target[known][:, varied]) * ranks(values[known][:, varied])).sum(0).mean()))


def related(values: Array, target: Array) -> tuple[float, tuple[float, ...]]:
    """How far each channel of `to` follows some channel in order, whatever map is between; and the best order of channels."""
    known = np.isfinite(values).all(1) & np.isfinite(target).all(1)
    if known.sum() < 32:
        return 0., ()
    tie = np.abs(ranks(target[known]).T @ ranks(values[known]))
    if tie.shape[0] > 4:
        return float(np.diag(tie).mean()), ()
    c = len(tie)
    best = max(itertools.permutations(range(c)), key=lambda order: sum(tie[i, order[i]] for i in range(c))
               + 1e-6 * sum(i == k for i, k in enumerate(order)))
    return float(np.mean([tie[i, best[i]] for i in range(c)])), tuple(float(i) for i in best)


class Placed:
    """A fault of place, or none, with its numbers at samples: at a few of those that differ, at all of them, at others."""

    def __init__(self, faults: list[tuple[Fault, tuple[float, ...]]], pair: Pair, side: int, choices: int = 1):
        self.faults, self.pair, self.side, self.choices = faults, pair, side, choices
        z, y, x = pair.differing
        self.glance = placed_values(faults, pair, (z[pair.question.glance], y[pair.question.glance], x[pair.question.glance]))

    @cached_property
    def differing(self) -> Array:
        return placed_values(self.faults, self.pair, self.pair.differing)

    @cached_property
    def others(self) -> Array:
        return placed_values(self.faults, self.pair, self.pair.all)


def places(question: Question, faults: list[Fault]) -> Iterator[Placed]:
    for side, pair in enumerate(question.pairs):
        for fault in faults:
            if not pair.has(fault.applies) or (side and not fault.sided):
                continue
            choices = fault.fit(pair, pair.differing, pair.differing_to) if fault.fit else [fault.p]
            for p in choices:
                yield Placed([(fault, p)], pair, side, len(choices))


class Search:
    def __init__(self, question: Question):
        self.question = question
        self.best: Trial | None = None
        self.partial: list[tuple[int, int, Trial]] = []  # faults that explain a few

    def attempt(self, placed: Placed, more: list[tuple[Fault, tuple[float, ...]]], only: tuple[int, ...] = ()) -> None:
        pair, trial = placed.pair, Trial([*placed.faults, *more], placed.side, only, placed.choices)
        if not trial.faults:
            return
        glance, rows = trial.rest(pair, placed.glance, more), self.question.glance
        if is_promising(pair, glance):
            want, want_all = trial.rest(pair, placed.differing, more), trial.rest(pair, placed.others, more)
            if judge(pair, trial, want, want_all):
                if self.best is None or trial.bits < self.best.bits - 0.5:
                    self.best = trial
                return
        hits = np.count_nonzero(self.question.hits(pair.differing_from[rows], glance, pair.differing_to[rows]))
        if hits >= 5 and not any(fault.found and fault.map for fault, _ in trial.faults):
            self.partial.append((hits, -len(self.partial), trial))

    def fits(self) -> Trial | None:
        """Faults alone whose numbers are measured."""
        for side, pair in enumerate(self.question.pairs):
            self.maps_on(Placed([], pair, side), [], True)
            for fault in PLACES:
                if fault.name in LOCAL and pair.has(fault.applies) and fault.fit:
                    for p in fault.fit(pair, pair.differing, pair.differing_to):
                        self.attempt(Placed([(fault, p)], pair, side), [])
        return self.best

    def maps_on(self, placed: Placed, before: list[tuple[Fault, tuple[float, ...]]], fitted: bool = False) -> None:
        """On all channels, on colours alone, on those alone that differ."""
        pair, question = placed.pair, self.question
        values, rows = placed.differing, question.first_half
        for fault, p in before:
            values = fault.map(p, values)  # type: ignore[misc]
        for only in dict.fromkeys([(), (0, 1, 2) if pair.image and pair.c == 4 else (), question.touched]):
            count = list(only) or list(range(min(3, pair.c) if pair.image else pair.c))
            v, target = values[rows][:, count].ravel(), pair.differing_to[rows][:, count].ravel()
            for fault in MAPS:
                if pair.has(fault.applies) and (fault.fit or not fitted):
                    for p in fault.fit(pair, v, target) if fault.fit else [fault.p]:
                        self.attempt(placed, [*before, (fault, p)], only)

    def run(self) -> Trial | None:
        """First one fault of each kind, then faults of numbers and channels where those of place come nearest."""
        kept: list[tuple[float, tuple[float, ...], Placed]] = []
        for placed in [*(Placed([], pair, side) for side, pair in enumerate(self.question.pairs)), *places(self.question, PLACES)]:
            self.attempt(placed, [])
            kept.append((*related(placed.glance, placed.pair.differing_to[self.question.glance]), placed))
        plain = kept[:2]
        for _, _, placed in plain:
            self.channels_on(placed, ())
            self.maps_on(placed, [])
        if self.best and self.best.left <= 0.1:
            return self.best
        near = [item for item in sorted(kept[2:], key=lambda item: -item[0]) if item[0] > 0.7][:8]
        for _, order, placed in [*plain, *near]:
            if placed.faults:
                self.channels_on(placed, order)
                self.maps_on(placed, [])
            for before in self.orders(placed, order):
                self.maps_on(placed, before)
        if not self.best and self.question.image:
            for placed in places(self.question, AFTER_TURN):
                self.attempt(placed, [])
        return self.best

    def orders(self, placed: Placed, order: tuple[float, ...]) -> Iterator[list[tuple[Fault, tuple[float, ...]]]]:
        """Faults of channels after which a map may hold."""
        pair, target = placed.pair, placed.pair.differing_to[placed.pair.question.glance]
        least = 0.1 + 0.9 * follows(placed.glance, target)
        for fault in CHANNELS:
            is_order = fault.map is CHANNELS[0].map
            if pair.has(fault.applies) and (order and fault.p[:pair.c] == order if is_order else not placed.faults
                                            and follows(fault.map(fault.p, placed.glance), target) > least):  # type: ignore[misc]
                yield [(fault, fault.p)]

    def channels_on(self, placed: Placed, order: tuple[float, ...]) -> None:
        for fault in CHANNELS:
            if placed.pair.has(fault.applies):
                self.attempt(placed, [(fault, fault.p)])


# ---- Answers -------------------------------------------------------------------------------------


def holds(question: Question, trial: Trial) -> bool:
    """What the samples say is so of all elements."""
    return trial.after <= (1 if trial.falls else 0.1) * question.before


def count_left(question: Question, trial: Trial) -> int:
    """Of all elements, those that the faults leave beyond the contract. Unknown ones stay as they were."""
    pair, left, step = question.pairs[trial.side], 0, question.stride()
    for start in range(0, question.elements, CHUNK * step):
        points = question.points(np.arange(start, min(start + CHUNK * step, question.elements), step))
        want, got = trial.predict(pair, points), pair.target.get(*points)
        unknown = np.isnan(want)
        left += int(question.beyond(np.where(unknown, got, want), got).sum())
    return min(left * step, question.elements)


def describe(question: Question, trial: Trial) -> dict[str, Any]:
    labels = {"from": question.labels[trial.side], "to": question.labels[1 - trial.side]}
    words = ", and ".join(phrase(fault, p, labels) for fault, p in trial.faults)
    if trial.only and trial.only != (0, 1, 2):
        words += f", in {' and '.join(CHANNEL_NAMES[i] for i in trial.only)} alone"
    exact = question.contract in ("exact", "flips", "raster")
    head = "far nearer"
    if trial.after == 0:
        head = "equal (to a code)" if question.one and not exact else "equal"
    elif trial.after <= question.allowed():
        head = "within the contract"
    elif trial.after <= 0.1 * question.before:
        head = "nearly equal"
    counts = f"{question.before} {'differs' if question.before == 1 else 'differ'} before, {trial.after} after"
    if head == "far nearer":
        counts += f"; median error {trial.errors[0]:.2g} before, {trial.errors[1]:.2g} after"
    return {"name": name_of(trial), "text": f"{head} {words} ({counts})", "before": question.before, "after": trial.after}


def name_of(trial: Trial) -> str:
    fault, p = trial.faults[0]
    if fault.name != "shift":
        return fault.name
    x, y = abs(p[0]), abs(p[1])
    return "layer" if p[2] else "shift_xy" if x and y else f"shift_{'2' if max(x, y) == 2 else ''}{'x' if x else 'y'}"


def shown(question: Question, names: tuple[str, ...] = ()) -> dict[str, Any] | None:
    """A place where all differences are, or what both copies show together."""
    best: tuple[float, dict[str, Any]] | None = None
    for fault in SHOWN:
        for pair in question.pairs[:2 if fault.sided else 1]:
            if not pair.has(fault.applies) or (names and fault.name not in names) or (not names and fault.name in FIRST):
                continue
            pair.told = ()
            if fault.mark:
                left, cost = fault.mark(pair, fault.p), VAGUE.get(fault.name, 0.05)
            else:
                left, cost = is_place(question, pair, fault)
            if left is None or left > (fault.leaves if fault.mark else 0.02):
                continue
            if best is None or left + cost < best[0]:
                labels = {"from": question.labels[question.pairs.index(pair)], "to": question.labels[1 - question.pairs.index(pair)]}
                after = math.ceil(left * question.before)
                counts = f"{question.before} {'breaks' if question.before == 1 else 'break'} the contract, {after} of them elsewhere"
                words = phrase(fault, pair.told or fault.p, labels)
                best = left + cost, {"name": fault.name, "text": f"differs {words} ({counts})", "before": question.before, "after": after}
    return best[1] if best else None


def is_place(question: Question, pair: Pair, fault: Fault) -> tuple[float | None, float]:
    """All differences lie there, it is a small part of the whole, and a fair share of it differs."""
    inside = fault.where(pair, fault.p, *pair.differing)  # type: ignore[misc]
    share = max(float(fault.where(pair, fault.p, *pair.all).mean()), 1 / question.elements)  # type: ignore[misc]
    filled = question.share * float(inside.mean()) / share
    lost = fault.loses is None or fault.loses(pair, fault.p, pair.differing_from, pair.differing_to)
    if (share > 0.6 or filled < (0.1 if fault.name == "tile_edges" else 0.3) or not lost
            or len(inside) * -math.log2(share) < NAME_BITS + DOUBT_BITS):
        return None, 0
    return float(1 - inside.mean()), 0.3 * share


CHANNEL_NAMES = ("red", "green", "blue", "alpha")
LOOKS, LEAST_SHARE, LEAST_PIECE = 50, 0.01, 32  # of pieces: boxes that are tried, and what is told
LOCAL = ("shift", "depth_bias")  # faults of place whose numbers are measured in a part
FIRST = ("nan", "uninitialised", "dither")
VAGUE = {"clear": 0.2, "tiles": 0.16, "edges": 0.05, "layer_alone": 0.05}  # places that fit much


def percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share > 0.095 else f"{100 * share:.2g} %"


def size_of(question: Question) -> str:
    """How large the differences are, for the head of the verdict."""
    values = np.concatenate([pair.all_from for pair in question.pairs])
    values = values[np.isfinite(values)]
    span = 1. if question.one else float(np.quantile(values, 0.99) - np.quantile(values, 0.01)) if len(values) else 0.
    span = span or float(np.abs(values).max(initial=0)) or 1.
    mean, large = (float(v) / span for v in (question.errors.mean(), np.quantile(question.errors, 0.99)))
    return f"mean {percent(mean)} of the range, {'visible' if large >= 1.5 / 255 else 'hardly visible'}"


# ---- Pieces --------------------------------------------------------------------------------------


def best_runs(weights: Array) -> tuple[Array, Array, Array]:
    """Of each row the run with the largest sum: its sum, start and end; of equal ones the shortest."""
    sums = np.concatenate([np.zeros((len(weights), 1)), np.cumsum(weights, 1)], 1)
    gains = sums - np.minimum.accumulate(sums, 1)
    ends, rows = gains.argmax(1), np.arange(len(weights))
    before = np.where(np.arange(sums.shape[1]) <= ends[:, None], sums, np.inf)
    return gains[rows, ends], sums.shape[1] - 1 - before[:, ::-1].argmin(1), ends


def best_rectangle(weights: Array) -> tuple[float, tuple[int, int, int, int]]:
    """Its sum; first and last row, first and last column, the last ones excluded."""
    sums, best = np.concatenate([np.zeros((1, weights.shape[1])), np.cumsum(weights, 0)]), (0., (0, 0, 0, 0))
    for top in range(len(weights)):
        gains, starts, ends = best_runs(sums[top + 1:] - sums[top])
        at = int(gains.argmax())
        if gains[at] > best[0]:
            best = float(gains[at]), (top, top + 1 + at, int(starts[at]), int(ends[at]))
    return best


class Chart:
    """Where a trial explains what differs, and where it does not, in these rows and columns of one layer."""

    def __init__(self, question: Question, trial: Trial, z: int, rows: Sequence[int], columns: Sequence[int]):
        self.rows, self.columns, pair = rows, columns, question.pairs[trial.side]
        y, x = (axis.ravel() for axis in np.meshgrid(rows, columns, indexing="ij"))
        points, shape = (np.full_like(x, z), y, x), (len(rows), len(columns))
        source, got, want = pair.get(*points), pair.target.get(*points), trial.predict(pair, points)
        differs = question.counts(points) & question.beyond(source, got) & (~question.are_loud | question.loud(source, got))
        known = ~np.isnan(want).any(1)
        good = question.hits(source, want, got) & known
        self.hits, self.differs = (good & differs).reshape(shape), differs.reshape(shape)
        misses = np.where(differs, ~good, question.loud(want, got)) & known
        self.weights = np.where(self.hits, 1., 0) - 9 * misses.reshape(shape)

    def box(self) -> tuple[float, tuple[int, int], tuple[int, int]]:
        """The best rectangle in the picture's rows and columns."""
        cell = -(-len(self.rows) // 32)
        starts = range(0, len(self.rows), cell)
        gain, (top, bottom, left, right) = best_rectangle(np.add.reduceat(self.weights, starts, 0))
        _, first, last = best_runs(self.weights[:, left:right].sum(1)[None])
        if not gain:
            return 0., (0, 0), (0, 0)
        return gain, (self.rows[first[0]], self.rows[last[0] - 1] + 1), (self.columns[left], self.columns[right - 1] + 1)


def chart_of(question: Question, trial: Trial, z: int, rows: tuple[int, int], columns: tuple[int, int]) -> Chart:
    steps = (-(-(high - low) // 256) for low, high in (rows, columns))
    return Chart(question, trial, z, *(range(*side, step) for side, step in zip((rows, columns), steps)))


def has_sharp_sides(question: Question, trial: Trial, box: Box) -> bool:
    """Right outside, the fault explains no more: a part of a surface that only looks so has no straight sides."""
    (z, _), (top, bottom), (left, right) = box
    _, h, w = question.extent[::-1]
    wide, high = max(2, (right - left) // 16), max(2, (bottom - top) // 16)
    for rows, columns in (((max(0, top - high), top), (left, right)), ((bottom, min(h, bottom + high)), (left, right)),
                          ((top, bottom), (max(0, left - wide), left)), ((top, bottom), (right, min(w, right + wide)))):
        if rows[0] < rows[1] and columns[0] < columns[1]:
            chart = chart_of(question, trial, z, rows, columns)
            if chart.hits.sum() > 0.5 * max(4, (chart.weights != 0).sum()):
                return False
    return True


def piece_of(question: Question, trial: Trial) -> Piece | None:
    """What the trial explains, if that is a box: judged there by all rules."""
    d, h, w = question.extent[::-1]
    charts = [chart_of(question, trial, z, (0, h), (0, w)) for z in range(0, d, -(-d // 8))]
    z, (gain, rows, columns) = max(enumerate(chart.box() for chart in charts), key=lambda item: item[1][0])
    if gain < FEW:
        return None
    if max(h, w) > 256:  # to the texel
        few = [range(low, high, -(-(high - low) // 64)) for low, high in (rows, columns)]
        wide = [range(max(0, low - size // 128), min(size, high + size // 128)) for (low, high), size in ((rows, h), (columns, w))]
        rows = Chart(question, trial, z * -(-d // 8), wide[0], few[1]).box()[1]
        columns = Chart(question, trial, z * -(-d // 8), few[0], wide[1]).box()[2]
    box = ((z * -(-d // 8), z * -(-d // 8) + 1), rows, columns)
    part = question.within(box, MOST_COUNTED >> 4)
    pair = part.pairs[trial.side]
    if part.before < LEAST_PIECE or not judge(pair, trial, *(trial.predict(pair, points) for points in (pair.differing, pair.all))):
        return None
    trial.after = count_left(part, trial)
    return Piece(part, trial) if holds(part, trial) and has_sharp_sides(question, trial, box) else None


@dataclass
class Piece:
    part: Question
    trial: Trial

    def share(self, whole: Question) -> float:
        return (1 if self.trial.falls else 1 - self.trial.left) * self.part.counted / whole.counted

    def contains(self, box: Box) -> bool:
        return all(low <= other_low and other_high <= high for (low, high), (other_low, other_high) in zip(self.part.box, box))

    def overlaps(self, other: Piece) -> bool:
        return all(low < other_high and other_low < high for (low, high), (other_low, other_high) in zip(self.part.box, other.part.box))

    def told(self, whole: Question) -> dict[str, Any]:
        names = [f"{name} {low}" + f" to {high - 1}" * (high - 1 > low)
                 for name, (low, high), size in zip(("layer", "y", "x"), self.part.box, whole.extent[::-1]) if size > 1]
        reason = describe(self.part, self.trial)
        share = self.share(whole)
        return {**reason, "share": share, "text": f"{percent(share)}, in {', '.join(names)}: {reason['text']}"}


def pieces(question: Question, search: Search) -> list[Piece]:
    """Faults that explain a part, then fits in cells of the picture; of those that overlap, the largest."""
    found: list[Piece] = []
    trials = [trial for _, _, trial in sorted(search.partial, key=lambda item: item[:2])[:-11:-1]]
    for box in [None, *cells(question)]:
        if box:
            part = question.within(box, MOST_COUNTED >> 8)
            trial = Search(part).fits() if part.before >= 2 * FEW and not any(piece.contains(box) for piece in found) else None
            trials = [trial] if trial else []
        found += [piece for piece in (piece_of(question, trial) for trial in trials) if piece]
    chosen: list[Piece] = []
    for piece in sorted(found, key=lambda piece: (-round(piece.share(question), 2), piece.trial.bits)):
        if piece.share(question) >= LEAST_SHARE and not any(piece.overlaps(other) for other in chosen):
            chosen.append(piece)
    return chosen


def cells(question: Question) -> Iterator[Box]:
    """The box of all that differs, and its parts."""
    sides = [(int(axis.min()), int(axis.max()) + 1) for axis in question.pairs[0].differing]
    parts = [[(low + i * (high - low) // 6, low + (i + 1) * (high - low) // 6) for i in range(6)] for low, high in sides[1:]]
    for layer in range(*sides[0], -(-(sides[0][1] - sides[0][0]) // 8)):
        yield (layer, layer + 1), sides[1], sides[2]
        yield from (((layer, layer + 1), rows, columns) for rows in parts[0] for columns in parts[1]
                    if rows[0] < rows[1] and columns[0] < columns[1])


def answer(question: Question) -> dict[str, Any]:
    result: dict[str, Any] = {"why": [], "noise": False, "size": size_of(question)}
    if not question.before:
        return result
    first = shown(question, FIRST)
    noise = None if first else noise_of(question)
    if noise and not question.one:
        return {**result, "why_not": noise, "noise": True}
    search = Search(question)
    trial = search.run() if not first and question.before >= FEW else None
    if trial:
        trial.after = count_left(question, trial)
    reason = first or (describe(question, trial) if trial and holds(question, trial) else None) or shown(question)
    if reason and reason["name"] not in VAGUE:
        return {**result, "why": [reason]}
    parts = pieces(question, search) if question.before >= 2 * FEW and not noise else []
    if parts:
        left = 1 - sum(piece.share(question) for piece in parts)
        rest = {"why_not": "the rest has no simple cause"} if left > 0.01 else {}
        return {**result, "why": [piece.told(question) for piece in parts], **rest}
    if reason:
        return {**result, "why": [reason]}
    return {**result, "why_not": noise or "no simple cause", "noise": bool(noise)}


def ask(request: dict[str, Any], raws: list[Array], relatives: dict[tuple[int, int], tuple[Array, list[int]]],
        edges: Array | None = None) -> dict[str, Any]:
    with np.errstate(all="ignore"):
        return answer(Question(request, raws, relatives, edges))


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    """All content is in one file."""
    content, answers, kinds = np.memmap(request["content"], np.uint8, "r"), [], list(KINDS)

    def taken(place: list[int]) -> Array:
        return content[place[0]:place[0] + place[1]]

    for question in request["questions"]:
        question["components"] = [{"kind": kinds[kind], "offset": offset} for kind, offset in question["components"]]
        relatives = {(item["side"], item["which"]): (taken(item["file"]), item["extent"]) for item in question["relatives"]}
        edges = taken(question["edges"]) > 0 if "edges" in question else None
        answers.append(ask(question, [taken(place) for place in question["files"]], relatives, edges))
        if request["until_loud"] and not answers[-1]["noise"]:
            break
    print(json.dumps(answers))
    return 0, {}
