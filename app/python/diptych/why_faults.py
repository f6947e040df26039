"""The table of faults that `why` tries: what one renderer does and the other does not.

A fault predicts one copy, `to`, from the other, `from`, at points of the picture: arrays z, y, x, of a buffer the element in x. A
number that it cannot know is NaN."""
from __future__ import annotations

from dataclasses import dataclass
import itertools
from typing import Any, Callable

import numpy as np

Array = Any  # of numpy
Point = tuple[Array, Array, Array]


@dataclass(eq=False)
class Fault:
    """`words` follow "equal"; {from} and {to} are the copies' names, {0} and so on what `fit` has found. One of `at`, `map` and `mark` is
    there: numbers of `to` by points of `from`; by the same numbers of `from`; what share of the differing elements the fault leaves,
    by looking at both copies, None: it does not apply."""
    name: str
    words: str
    at: Callable[..., Array] | None = None
    map: Callable[..., Array] | None = None
    mark: Callable[..., float | None] | None = None
    p: tuple[Any, ...] = ()
    fit: Callable[..., list[tuple[Any, ...]]] | None = None  # all parameters to try
    applies: str = ""  # a key of TRAITS
    loses: Callable[..., bool] | None = None  # whether what it throws away is what `to` truly lacks
    sided: bool = True  # not the same from either copy
    found: int = 0  # numbers of p that are measured, not chosen
    leaves: float = 0.05  # of the differing elements, the share that may be elsewhere


TRAITS: dict[str, Callable[[Any], bool]] = {  # of a pair, without which a fault makes no sense
    "": lambda pair: True,
    "image": lambda pair: pair.image and pair.h > 1,
    "close": lambda pair: pair.image and pair.h > 1 and pair.closeness > 0.3,  # texels stay where they are
    "buffer": lambda pair: not pair.image,
    "square": lambda pair: pair.image and pair.w == pair.h > 1,
    "layers": lambda pair: pair.image and pair.d > 1,
    "cube": lambda pair: pair.image and pair.d % 6 == 0,
    "colour": lambda pair: pair.image and 3 <= pair.c <= 4,
    "alpha": lambda pair: pair.image and pair.c == 4,
    "two": lambda pair: pair.c == 2,
    "several": lambda pair: 1 < pair.c <= 4,
    "three": lambda pair: 3 <= pair.c <= 4,
    "reals": lambda pair: not pair.integer,
    "depth": lambda pair: pair.image and pair.c == 1 and not pair.integer,
    "matrices": lambda pair: 2 < pair.c == pair.w if pair.image else bool((pair.transposed() != np.arange(pair.c)).any()),
    "matrices4": lambda pair: not pair.image and pair.c % 16 == 0,
    **{f"relative{which}": lambda pair, which=which: which in pair.relatives for which in range(4)}}  # type: ignore[misc]


# ---- Places: numbers of another texel ------------------------------------------------------------


def shifts(pair: Any, points: Any, target: Any) -> list[tuple[float, ...]]:
    """The steps at the peaks of the phase correlation, over the edge and not; of a buffer, all short ones."""
    if not pair.image:
        return [(float(step), 0., 0.) for step in (1, -1, 2, -2, 3, -3, 4, -4, 8, -8, 16, -16)]
    return [(x, y, 0.) for x, y in pair.peaks()]


def mean_of(columns: tuple[int, ...], rows: tuple[int, ...]) -> Callable[..., Array]:
    """Of the neighbours at those steps; of a border, NaN."""
    return lambda pair, p, z, y, x: sum(pair.get(z, y + j, x + i) for j in rows for i in columns) / (len(rows) * len(columns))


def coarse(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """p: columns and rows of a block, and 0: its mean; 1, 2: its first or last texel."""
    bx, by = int(p[0]), int(p[1])
    x, y = x // bx * bx, y // by * by
    if p[2]:
        return pair.get(z, y + (by - 1 if p[2] > 1 else 0), x + (bx - 1 if p[2] > 1 else 0))
    return sum(pair.get(z, y + j, x + i) for j in range(by) for i in range(bx)) / (bx * by)


def linear(numbers: Callable[..., Array], v: Array, u: Array) -> Array:
    """Between four, by row and column, whose middles are at .5."""
    j, i = (np.floor(place - 0.5).astype(int) for place in (v, u))
    b, a = ((place - 0.5 - low)[:, None] for place, low in ((v, j), (u, i)))
    first, second = (numbers(row, i) * (1 - a) + numbers(row, i + 1) * a for row in (j, j + 1))
    return first * (1 - b) + second * b


def smooth(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """Between the middles of blocks. p: as above; the blocks' means or first texels."""
    bx, by = int(p[0]), int(p[1])
    return linear(lambda j, i: coarse(pair, p, z, np.clip(j, 0, pair.h // by - 1) * by, np.clip(i, 0, pair.w // bx - 1) * bx),
                  (y + 0.5) / by, (x + 0.5) / bx)


def varied_in_blocks(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """Else `from` has lower resolution already, and the mean is that of noise."""
    first, last = (coarse(pair, (*p[:2], end), *pair.all) for end in (1, 2))
    return bool(pair.question.loud(first, last).mean() > 0.1)


def scaled(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """p: the factor; where the picture stands still, 0 to 1 of width and height; 0: the nearest texel by its corner, 1: by its
    middle, 2: linear; 0: both axes, 1: x, 2: y."""
    scale, mode, axis = p[0], int(p[3]), p[4]
    middle = 0. if mode == 0 else 0.5
    u, v = x + middle, y + middle
    if axis != 2:
        u = (u - p[1] * pair.w) / scale + p[1] * pair.w
    if axis != 1:
        v = (v - p[2] * pair.h) / scale + p[2] * pair.h
    if mode < 2:
        return pair.get(z, np.floor(v + 1e-9).astype(int), np.floor(u + 1e-9).astype(int))
    return linear(lambda j, i: pair.get(z, j, i), v, u)


def scales(pair: Any, points: Any, target: Any) -> list[tuple[float, ...]]:
    """Those at which `to` follows best."""
    few = pair.question.glance
    places, sought = [axis[few] for axis in points], target[few].mean(1)
    found = []
    for scale in (2, 0.5, 1.5, 2 / 3, 3, 1 / 3, 4, 0.25, 1.25, 0.8, 4 / 3, 0.75):
        for *anchor, axis in ((0., 0., 0), (0., 1., 0), (0.5, 0.5, 0), (0., 0., 1), (0.5, 0., 1), (0., 0., 2), (0., 1., 2), (0., 0.5, 2)):
            value = scaled(pair, (scale, *anchor, 1., axis), *places).mean(1)
            known = np.isfinite(value) & np.isfinite(sought)
            if known.sum() > 16:
                found.append((-abs(float(np.corrcoef(value[known], sought[known])[0, 1])), (scale, *anchor), axis))
    return [(*p, float(mode), axis) for _, p, axis in sorted(found)[:3] for mode in range(3)]


def of_relative(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """Frames have one size; of a mip the texel that lies there."""
    other = pair.relatives[int(p[0])]
    if pair.image:
        x, y = x * other.w // pair.w, y * other.h // pair.h
    return other.get(z, y, x)


def pitched(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """Rows p[2] bytes apart, where `to` has them side by side."""
    return pair.words(((z * pair.h * pair.w * pair.stride) + y * p[2])[:, None] + pair.byte(x))


def pitches(pair: Any, points: Any, target: Any) -> list[tuple[float, ...]]:
    """At which a few texels of `to` stand in `from`."""
    row, below = pair.w * pair.stride, np.flatnonzero(points[1])
    few = below[np.linspace(0, len(below) - 1, min(len(below), 24)).astype(int)]
    pitch = row + np.arange(1, min(row, 4096) + 1)
    values = pitched(pair, (0, 0, np.repeat(pitch, len(few))), *(np.tile(axis[few], len(pitch)) for axis in points))
    near = (np.abs(values - np.tile(target[few], (len(pitch), 1))) <= 0.02 * pair.range).all(1).reshape(len(pitch), -1)
    return [(float(pitch[i]) / pair.stride, float(pair.w), int(pitch[i])) for i in np.argsort(-near.sum(1))[:2]]


def repacked(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """`to` has p[0] bytes for each thing that has p[1] in `from`."""
    byte, (into, out) = pair.byte(x), p
    return pair.words(np.where(byte % into < out, byte // into * out + byte % into, -1))


def transposed(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    if not pair.image:
        return pair.get(z, y, x)[:, pair.transposed()]
    channels = np.stack([pair.get(z, y, np.full_like(x, channel)) for channel in range(pair.c)], -1)
    return channels[np.arange(len(x)), np.minimum(x, pair.c - 1)]


def matrix_row(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """p: the step between the rows of a column, 1, or 4 if the matrix is by rows; the row; 1: negated, else z is 0..1 against -1..1."""
    step, row = int(p[0]), int(p[1])
    values = pair.get(z, y, x)
    cells = np.nonzero(np.arange(pair.c) % 16 // step % 4 == row)[0]
    values[:, cells] = -values[:, cells] if p[2] else (values[:, cells] + values[:, cells + step]) / 2
    return values


# ---- Channels: maps of whole texels --------------------------------------------------------------


UNITS = dict(zip("rgba1", np.eye(5)))
TERMS = {**UNITS, "0": np.zeros(5), "luma": np.array([0.2126, 0.7152, 0.0722, 0, 0]), **{f"-{term}": -UNITS[term] for term in "rgb"},
         **{f"1-{term}": UNITS["1"] - UNITS[term] for term in "rgba"}}


def mixed(p: Any, v: Array) -> Array:
    """p: of each channel of `to`, the factors of r, g, b, a and 1."""
    c = v.shape[1]
    return np.concatenate([v, np.zeros((len(v), 4 - c)), np.ones((len(v), 1))], 1) @ np.array(p[:c]).T


def lacks(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """The combinations of channels that are lost are constant in `to`, and not in `from`."""
    u, sizes, _ = np.linalg.svd(np.array(p)[:pair.c, :pair.c])
    lost = u[:, sizes < 1e-6]
    return bool((np.ptp(target @ lost, 0) <= 2 * pair.step).all() and (np.ptp(value @ lost, 0) > 10 * pair.step).all())


def luma(kr: float, kb: float) -> Array:
    kg = 1 - kr - kb
    return np.array([[kr, kg, kb], [-kr / 2 / (1 - kb), -kg / 2 / (1 - kb), 0.5], [0.5, -kg / 2 / (1 - kr), -kb / 2 / (1 - kr)]])


LUMAS = {"BT.601": luma(0.299, 0.114), "BT.709": luma(0.2126, 0.0722), "BT.2020": luma(0.2627, 0.0593)}
MATRICES = [*((f"as if {{to}} was encoded with {one} and decoded with {other}, {{from}} not", np.linalg.inv(LUMAS[other]) @ LUMAS[one], 0.)
              for one in LUMAS for other in LUMAS if one != other),
            *((f"if {{to}} has the limited range of video in {name}",
               np.linalg.inv(m) @ np.diag([219 / 255, 224 / 255, 224 / 255]) @ m, 16 / 255) for name, m in LUMAS.items())]


# ---- Maps: each number by itself -----------------------------------------------------------------


WORDS = [("float", "f4"), ("half", "f2"), ("uint", "u4"), ("int", "i4"), ("uint16", "u2"), ("int16", "i2")]


def ulp(values: Array, fraction: int, least: int) -> Array:
    """The steps of floats of so many bits of fraction, where they have these values."""
    _, exponent = np.frexp(np.fmax(np.abs(values), 2. ** least))
    return np.ldexp(1., exponent - 1 - fraction)


def to_srgb(p: Any, v: Array) -> Array:
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)


def to_light(p: Any, v: Array) -> Array:
    return np.where(v <= 0.04045, v / 12.92, ((np.maximum(v, 0) + 0.055) / 1.055) ** 2.4)


def power(p: Any, v: Array) -> Array:
    return np.maximum(v, 0) ** p[0]


def line(p: Any, v: Array) -> Array:
    return p[0] * v + p[1]


def stored(p: Any, v: Array) -> Array:
    """In codes of p[0] steps (565: of its bits), or floats of p[0] bits of fraction and p[2] as the least exponent; p[1]: cut off."""
    to_whole: Any = np.trunc if p[1] else np.rint
    if len(p) < 3:
        steps = np.array((31, 63, 31, 255))[:v.shape[-1]] if p[0] == 565 else p[0]
        return to_whole(v * steps) / steps
    unit = ulp(v, *p[::2])
    return to_whole(v / unit) * unit


def out_of_range(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """All that `to` has is inside, and a part of `from` is not."""
    return bool(((target >= p[0]) & (target <= p[1])).all() and ((value < p[0]) | (value > p[1])).mean() > 0.01)


def on_grid(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """All numbers of `to` are on the coarser grid, and few of `from` are."""
    code = 0.502 / 255 if pair.kind == "unorm8" else 0
    exact, other = (np.abs(stored((p[0], 0, *p[2:]), v) - v) <= 2e-7 * np.abs(v) + code for v in (target, value))
    changed = ~(value == target)
    return bool(exact.mean() > 0.995 and other[changed].mean() < 0.5 and len(np.unique(target[changed])) > 8)


# Fits take usable numbers of `from` and of `to` that differ.


def settled(values: Array) -> float:
    """The mean of those near most; NaN of few."""
    apart = np.abs(values - np.median(values)) if len(values) >= 4 else np.zeros(0)
    return float(values[apart <= 3 * np.median(apart)].mean()) if len(apart) else np.nan


def usable(pair: Any, v: Array, target: Array) -> tuple[Array, Array]:
    """Numbers that are finite and at no end of a code's range."""
    keep = np.isfinite(v) & np.isfinite(target)
    if pair.one:
        keep &= (v > 0) & (v < 1) & (target > 0) & (target < 1)
    return v[keep], target[keep]


def line_of(v: Array, target: Array) -> list[tuple[float, ...]]:
    """Through most points, then by least squares of those near it."""
    order = np.argsort(v, kind="stable")
    v, target, half = v[order], target[order], len(v) // 2
    wide = v[half:2 * half] - v[:half] > 0.05 * np.ptp(v) if half else np.zeros(0, bool)
    if wide.sum() < 4:
        return []
    slope = np.median((target[half:2 * half] - target[:half])[wide] / (v[half:2 * half] - v[:half])[wide])
    offset = np.median(target - slope * v)
    for _ in range(4):
        apart = np.abs(target - slope * v - offset)
        near = apart <= max(3 * np.median(apart), 1e-12)
        if near.sum() < 6 or np.ptp(v[near]) == 0:
            break
        slope, offset = (float(number) for number in np.polyfit(v[near], target[near], 1))
    return [(slope, offset)] if np.isfinite(slope + offset) and abs(slope) > 1e-6 else []


def fit_power(pair: Any, v: Array, target: Array) -> list[tuple[float, ...]]:
    keep = (v > 0.02) & (v < 0.98) & (target > 0.001) & (target < 0.999)
    exponent = settled(np.log(target[keep]) / np.log(v[keep]))
    return [(exponent,)] if 0.1 < exponent < 10 else []


def slope_of(pair: Any, z: Array, y: Array, x: Array) -> Array:
    """The larger of both axes. NaN where the surface bends or ends."""
    here, axes = pair.get(z, y, x), []
    for j, i in ((0, 1), (1, 0)):
        before, behind = (pair.get(z, y + n * j, x + n * i) for n in (-1, 1))
        step = np.abs(behind - before) / 2
        axes.append(np.where(np.abs(behind - 2 * here + before) <= 0.05 * step + 1e-5 * pair.range, step, np.nan))
    return np.maximum(*axes)


def biased(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    depth = pair.get(z, y, x)
    return np.where((depth == 0) | (depth == 1), depth, depth + p[0] * slope_of(pair, z, y, x) + p[1])  # a clear is not biased


def fit_bias(pair: Any, points: Point, target: Array) -> list[tuple[float, ...]]:
    """Factors of a polygon offset are small numbers; one plane proves no bias."""
    slopes, error = slope_of(pair, *points).ravel(), (target - pair.get(*points)).ravel()
    known = np.isfinite(slopes)
    least, middle, most = np.quantile(slopes[known], (0.1, 0.5, 0.9)) if known.any() else (0, 0, 0)
    fits = line_of(slopes[known], error[known]) if most - least > 0.1 * middle else []
    return [p for p in fits if 0.01 < abs(p[0]) < 100]


# ---- Where it shows ------------------------------------------------------------------------------


def border(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """p: columns from the left, rows from the first, and from the other ends."""
    return (x < p[0]) | (y < p[1]) | (x >= pair.w - p[2]) | (y >= pair.h - p[3])


def ends_with_tiles(pair: Any, p: Any) -> bool:
    """`to` has one value there, from the very end of the last tile on, along x and y each."""
    places = [(at, size, size // p[0] * p[0]) for at, size in zip(pair.differing[:0:-1], (pair.w, pair.h))]
    firsts = [at[np.all([other < end for other, _, end in places if other is not at and pair.h > 1], 0)].min(initial=size) == end
              for at, size, end in places if size % p[0]]
    return all(firsts) and most_of(pair.differing_to)[1] > 0.9


def only(where: Callable[..., Array], fill: float = 0.3, most: float = 0.02,
         holds: Callable[..., bool] | None = None) -> Callable[..., float | None]:
    """But for `most`, all differences lie there, it is a small part of the whole, and a fair share of it differs."""
    def mark(pair: Any, p: Any) -> float | None:
        inside = where(pair, p, *pair.differing)
        share = max(float(where(pair, p, *pair.all).mean()), 1 / pair.question.elements)
        proved = share <= 0.6 and pair.share * inside.mean() >= fill * share and len(inside) * -np.log2(share) >= 25
        return float(1 - inside.mean()) if proved and inside.mean() >= 1 - most and (not holds or holds(pair, p)) else None
    return mark


def rows_of(values: Array) -> Array:
    return np.ascontiguousarray(values).view(np.dtype((np.void, values.itemsize * values.shape[1]))).ravel()


def most_of(values: Array) -> tuple[Array, float]:
    """The row that occurs most often, and its share."""
    _, index, counts = np.unique(rows_of(values), return_index=True, return_counts=True)
    best = counts.argmax()
    return values[index[best]], float(counts[best] / len(values))


PATTERNS = [*(bytes([byte]) for byte in bytes.fromhex("cdccfeabaaa55a55ddfdbd7fba")),
            *(bytes.fromhex(word) for word in ("efbeadde", "0df0adba", "bebafeca", "0df0feca"))]


def no_pattern(pair: Any, p: Any) -> float | None:
    z, y, x = pair.differing
    raw = np.frombuffer(pair.target.raw, np.uint8, pair.d * pair.h * pair.w * pair.stride)
    raw = raw.reshape(-1, pair.stride)[(z * pair.h + y) * pair.w + x]
    same = np.zeros(len(raw), bool)
    for word in PATTERNS if len(raw) > 1 else []:
        if pair.stride % len(word) == 0:
            same |= (raw.reshape(len(raw), -1, len(word)) == np.frombuffer(word, np.uint8)).all((1, 2))
    return float(1 - same.mean())


def cleared(pair: Any, p: Any) -> float | None:
    """Where they differ, `from` has one value and `to` many; both have it elsewhere, or it covers much."""
    if len(pair.differing_to) < 8:
        return None
    ground, share = most_of(pair.differing_from)
    middle = np.median(pair.differing_to, 0)
    common = [~pair.question.loud(ground, values) for values in (pair.all_from, pair.all_to)]
    seen = pair.share > 0.2 or (common[0] & common[1]).mean() > 0.01
    return 1 - share if seen and pair.question.loud(middle, pair.differing_to).mean() > 0.5 else None


def not_inverted(pair: Any, p: Any) -> float | None:
    """What is background in one copy is covered in the other."""
    ground, share = most_of(pair.all_from)
    if not 0.02 < share < 0.98:
        return None
    a, b = (pair.all_from == ground).all(1), (pair.all_to == ground).all(1)
    return float((a == b).mean())


def other_order(pair: Any, p: Any) -> float | None:
    if pair.image or not 4 <= pair.w <= 4 << 20:
        return None
    a, b = (np.sort(rows_of(side.get(*[np.zeros(pair.w, int)] * 2, np.arange(pair.w)))) for side in (pair, pair.target))
    return float((a != b).mean() / pair.share) if len(np.unique(a)) > 3 else None


def not_tiles(pair: Any, p: Any) -> float | None:
    """The share of tiles with a difference that do not differ as a whole; what differs ends at borders of tiles."""
    tile = int(p[0])
    a, b = pair.crops(512)
    h, w = (size // tile * tile for size in a.shape[:2])
    if w < 3 * tile or h < 2 * tile or pair.share > 0.6:
        return None
    whole = pair.question.beyond(*(crop.reshape(-1, pair.c) for crop in (a, b))).reshape(a.shape[:2])[:h, :w]
    shares = whole.reshape(h // tile, tile, w // tile, tile).mean((1, 3))
    full = shares[shares > 0] > 0.9
    ends = [np.nonzero(np.diff(whole, axis=axis))[axis] + 1 for axis in (0, 1)]
    luck = sum(len(np.unique(places)) for places in ends) * np.log2(tile)  # a box may end there by chance, not many
    return float(1 - full.mean()) if luck >= 20 and (np.concatenate(ends) % tile == 0).mean() > 0.7 else None


def lines_of(pair: Any, axis: int) -> tuple[Array, Array]:
    """Of some columns (axis 0) or rows (1) of the layer that differs most, from end to end: where `to` moves on from the texel before,
    and where both differ."""
    size, others = (pair.h, pair.w) if axis == 0 else (pair.w, pair.h)
    few = np.linspace(0, others - 1, min(others, 48)).astype(int)
    across, along = (a.ravel() for a in np.meshgrid(few, np.arange(size), indexing="ij"))
    points = np.full(across.size, np.bincount(pair.differing[0]).argmax()), *((along, across) if axis == 0 else (across, along))
    to = pair.target.get(*points)
    moves, differs = (pair.question.loud(other, to).reshape(-1, size).mean(0) for other in (np.roll(to, 1, 0), pair.get(*points)))
    return moves, differs


def stills(pair: Any, points: Any, target: Any) -> list[tuple[float, ...]]:
    """The box behind whose sides `to` repeats its texels, up to where both are the same."""
    box = []
    for axis in (1, 0):
        moves, differs = (np.flatnonzero(share > least) for share, least in zip(lines_of(pair, axis), (0.15, 0.02)))
        low, high = moves[moves > 0][[0, -1]] if (moves > 0).any() else np.array((1, 0))
        first, last = max(differs[differs < low - 1], default=-1), min(differs[differs > high], default=(pair.w, pair.h)[1 - axis])
        box.append((first + 1, last - 1))
    sides = tuple(int(side) for side in (*box[0], *box[1]))
    return [sides] if sides != (0, pair.w - 1, 0, pair.h - 1) else []


def is_still(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """Outside lies more than one colour, and a part of it differs."""
    there, share = (np.mean((x < p[0]) | (x > p[1]) | (y < p[2]) | (y > p[3])) for _, y, x in (pair.differing, pair.all))
    varied = pair.question.loud(np.median(pair.differing_to, 0), pair.differing_to).mean()
    return bool(varied > 0.5 and share <= 0.9 and pair.share * there >= 0.2 * share)


def not_dithered(pair: Any, p: Any) -> float | None:
    """Low bits alone differ, and the difference is itself negated where it is moved, or turned in y, x or both."""
    if not pair.one or not pair.image:
        return None
    a, b = pair.crops(256)
    error = (b - a)[:, :, np.abs(b - a).sum((0, 1)).argmax()]  # of the channel that differs most
    if not error.any() or np.abs(error).max() > 2.01 * pair.step:
        return None
    if max(np.count_nonzero(np.diff(error, axis=axis)) for axis in (0, 1)) < 0.1 * error.size:  # flat, as no pattern is
        return None
    error = error - error.mean()
    product = np.fft.irfft2(np.fft.rfft2(error) * np.conj(np.fft.rfft2(error[::p[1], ::p[0]])), error.shape)
    return 0. if product.min() < min(-0.42, -12 / np.sqrt(error.size)) * (error ** 2).sum() else None


def not_tested(pair: Any, p: Any) -> float | None:
    """Alpha of `to` is 0 or 1, by a threshold of that of `from`; or it has the levels of a few samples."""
    a, b = pair.differing_from[:, 3], pair.differing_to[:, 3]
    end = 2 * pair.step + 1e-3
    for levels in (1, 2, 4, 8):
        coarse_one, fine_one = (np.abs(alpha * levels - np.rint(alpha * levels)) <= end * levels for alpha in (b, a))
        part, covered = ~fine_one & coarse_one & (np.abs(b - a) * levels < (0.75 if levels > 1 else 1)), b > 0.5
        if part.mean() > 0.95 and 0.05 < covered[part].mean() < 0.95 and (
                levels > 1 or np.quantile(a[part & covered], 0.05) >= np.quantile(a[part & ~covered], 0.95) - 0.05):
            return float(1 - part.mean())
    return None


def across_edges(pair: Any, points: Point) -> tuple[Array, Array]:
    """The steps to the neighbours in `from`; whether one is large."""
    z, y, x = points
    ring = np.stack([pair.get(z, y + j, x + i) for j in (-1, 0, 1) for i in (-1, 0, 1) if (i, j) != (0, 0)])
    across = ring - pair.get(z, y, x)
    return across, np.abs(across).max(2) > 0.1 * pair.range


def softened(pair: Any) -> float:
    """Of how many that differ is `to` a mix of `from` and of one neighbour across an edge."""
    across, steep = across_edges(pair, pair.differing)
    moved = pair.differing_to - pair.differing_from
    part = (across * moved).sum(2) / np.maximum((across ** 2).sum(2), 1e-30)
    off = np.abs(part[..., None] * across - moved).max(2)
    mixes = (off <= 0.3 * np.abs(moved).max(1) + 1.01 * pair.step) & (part < 0.95) & (part > 0) & steep
    return float(mixes.any(0).mean())


def is_antialiased(pair: Any, p: Any) -> bool:
    """`to` has edges softer, and not `from`: its bright side gets darker, its dark side brighter."""
    softer, sharper = (softened(side) for side in sorted(pair.question.pairs, key=lambda other: other is not pair))
    brighter = (pair.differing_to - pair.differing_from).sum(1) > 0
    return bool(pair.share <= 0.2 and softer > max(2 * sharper, 0.7) and 0.1 < brighter.mean() < 0.9)


# ---- The table -----------------------------------------------------------------------------------


def channels(name: str, words: str, terms: str, applies: str = "", sided: bool = True) -> Fault:
    p = tuple(TERMS[term] for term in terms.split())
    lost = lacks if np.linalg.matrix_rank(np.array(p)[:, :len(p)]) < len(p) else None
    return Fault(name, "with " + words, map=mixed, p=p, applies=applies or "colour", loses=lost, sided=sided)


def grid(name: str, words: str, *p: float) -> Fault:
    return Fault(name, "if {from} is " + words, map=stored, p=p, applies="colour" if p[0] == 565 else "reals", loses=on_grid)


BLOCKS = {**{(side, side): f"{side}x{side} texels" for side in (2, 4, 3, 6)}, (2, 1): "2 columns", (1, 2): "2 rows"}
ENDS = {(0, 0, 0, 1): "in the last row alone", (0, 1, 0, 0): "in the first row alone",
        (0, 0, 1, 0): "in the last column (or element) alone",
        (1, 0, 0, 0): "in the first column (or element) alone",
        (0, 0, 1, 1): "in the last row and column alone: an odd size is rounded down",
        (1, 1, 1, 1): "at the border alone: clamp, wrap or border colour",
        (2, 2, 2, 2): "in the two texels at the border: clamp, wrap or border colour"}

PLACES = [
    *(Fault(name, "after " + words, applies="image", sided=False, p=p,
            at=lambda pair, p, z, y, x: pair.get(z, pair.h - 1 - y if p[1] else y, pair.w - 1 - x if p[0] else x)) for name, words, p in (
        ("flip_y", "a flip in y: OpenGL's row 0 is the bottom", (0, 1)), ("mirror_x", "a mirror in x", (1, 0)),
        ("turn", "half a turn: x and y run backwards", (1, 1)))),
    Fault("reversed", "with the elements in reverse order", applies="buffer", sided=False,
          at=lambda pair, p, z, y, x: pair.get(z, y, pair.w - 1 - x)),
    Fault("axes", "with x and y in each other's place", applies="square", sided=False,
          at=lambda pair, p, z, y, x: pair.get(z, x, y)),
    Fault("quarter_turn", "after a quarter turn of {from}", applies="square",
          at=lambda pair, p, z, y, x: pair.get(z, x, pair.w - 1 - y)),
    *(Fault(name, words, at=of_relative, p=(i,), applies=f"relative{i}") for i, (name, words) in enumerate((
        ("frame", "one frame late: {to} has the frame before of {from}"),
        ("frame", "one frame early: {to} has the frame after of {from}"),
        ("mip", "one mip off: {to} has the finer mip of {from}"),
        ("mip", "one mip off: {to} has the coarser mip of {from}")))),
    Fault("layer", "with another layer: {to} has in each that of {from} which is {2} behind", applies="layers",
          at=lambda pair, p, z, y, x: pair.get(z + p[2], y, x),
          fit=lambda pair, *_: [(0, 0, step) for step in range(max(1 - pair.d, -8), min(pair.d, 9)) if step]),
    Fault("layers_reversed", "with the layers in reverse order", applies="layers", sided=False,
          at=lambda pair, p, z, y, x: pair.get(pair.d - 1 - z, y, x)),
    *(Fault("faces", f"with {words} swapped", p=p, applies="cube", sided=False,
            at=lambda pair, p, z, y, x: pair.get(np.where(np.isin(z % 6 // 2, p), z ^ 1, z), y, x))
      for p, words in (((0,), "the faces +x and -x"), ((1,), "the faces +y and -y"), ((2,), "the faces +z and -z"),
                       ((0, 1, 2), "opposite faces of the cube"))),
    Fault("shift", "after a shift of {0} texels (or elements) in x and {1} in y", fit=shifts, found=2,
          at=lambda pair, p, z, y, x: pair.get(z, y + int(p[1]), x + int(p[0]))),
    Fault("roll", "after {0} texels in x and {1} in y, round the edge", applies="image",
          fit=lambda pair, *_: [(pair.w // 2, 0), (0, pair.h // 2), (pair.w // 2, pair.h // 2)],
          at=lambda pair, p, z, y, x: pair.get(z, (y + p[1]) % pair.h, (x + p[0]) % pair.w)),
    *(Fault("half_texel_" + ("x" if x and not y else "y" if y and not x else "xy"),
            "after half a texel in " + ("x" if not y else "y" if not x else "x and y") + ": centres are at .5",
            at=mean_of((0, x) if x else (0,), (0, y) if y else (0,)), applies="close")
      for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1))),
    Fault("pitch", "if rows of a pitch of {0} texels were read as {1}: {from} has the padding of rows in it", at=pitched, fit=pitches,
          found=1, applies="image"),
    Fault("scale", "at {0} times the scale of {from} about {1}", at=scaled, fit=scales, applies="image", found=1),
    *(Fault("nearest", f"where {{to}} filters and {{from}} repeats {words}: nearest against linear", at=smooth, p=(*size, 1),
            applies="close") for size, words in BLOCKS.items()),
    *(Fault("half_rate", f"if {{to}} has means of {words}: lower resolution", at=coarse, p=(*size, 0), applies="close",
            loses=varied_in_blocks) for size, words in BLOCKS.items()),
    *(Fault("half_rate", f"if {{to}} repeats one texel of {words}: nearest, lower resolution", at=coarse, p=(*size, last), applies="close")
      for size, words in BLOCKS.items() for last in (1, 2)),
    *(Fault("half_rate", f"if {{to}} has means of {words}, filtered: lower resolution, or a coarser mip", at=smooth, p=(*size, 0),
            applies="close", loses=varied_in_blocks) for size, words in BLOCKS.items()),
    Fault("blurred", "if {from} is filtered by 3x3 texels, as {to} is", at=mean_of((-1, 0, 1), (-1, 0, 1)), applies="close"),
    Fault("transposed", "after each matrix is transposed (rows against columns)", at=transposed, applies="matrices", sided=False),
    *(Fault(name, f"{words}{order}", at=matrix_row, p=(step, *p), applies="matrices4", sided=not p[1])
      for name, words, p in (("matrix_y", "with the y row of each matrix negated (Vulkan's y points down)", (1, 1)),
                             ("matrix_z", "if the z row of each matrix of {from} goes from -1..1 to 0..1", (2, 0)))
      for step, order in ((1, ""), (4, ", by rows"))),
    Fault("layout", "with {0} bytes in {to} for each {1} in {from} (std140, std430 or packed)", at=repacked, applies="buffer",
          fit=lambda pair, *_: [*itertools.permutations((4, 8, 12, 16), 2),
                                *((pair.stride, stride) for stride in range(4, 4 * pair.stride + 1, 4) if stride != pair.stride)]),
    Fault("moved", "if all lies {0} bytes later", at=lambda pair, p, z, y, x: pair.words(pair.byte(x) + p[0]), applies="buffer",
          fit=lambda pair, *_: [(byte,) for byte in (4, 16) if byte % pair.stride]),
    Fault("smear", "if {to} repeats its texels outside of x {0} to {1}, y {2} to {3}: clamped there, or at the end of a texture that "
          "{from} wraps", at=lambda pair, p, z, y, x: pair.get(z, np.clip(y, p[2], p[3]), np.clip(x, p[0], p[1])),
          fit=stills, found=1, applies="image", loses=is_still),
    Fault("depth_bias", "with an error in proportion to the slope of depth: {0} slope + {1} (depth bias)", at=biased, fit=fit_bias,
          found=2, applies="depth"),
]

TURNS = PLACES[:3]
AFTER_TURN = [fault for fault in PLACES if fault.name in ("shift", "scale", "half_rate") or fault.name.startswith("half_texel")]

CHANNELS = [
    channels("red_blue", "red and blue swapped (RGBA against BGRA)", "b g r a"),
    *(channels("channels", "the channels in the order " + ", ".join(order).removesuffix(", a"), " ".join(order),
               "colour" if order[3] == "a" else "alpha")
      for order in itertools.permutations("rgba") if "".join(order) not in ("rgba", "bgra")),
    channels("channels", "both channels swapped", "g r", "two", False),
    channels("grey", "the first channel of {from} in all of {to}", "r r r a"),
    channels("grey", "the luminance of {from} in all channels of {to}", "luma luma luma a"),
    channels("alpha_lost", "alpha 1 in {to}", "r g b 1", "alpha"),
    channels("alpha_lost", "alpha 0 in {to}", "r g b 0", "alpha"),
    *(channels("channel_lost", f"{words} 0 in {{to}}", f"{terms} a") for words, terms in (
        ("red", "0 g b"), ("green", "r 0 b"), ("blue", "r g 0"), ("green and blue", "r 0 0"), ("red and blue", "0 g 0"),
        ("red and green", "0 0 b"))),
    channels("alpha_inverted", "alpha inverted", "r g b 1-a", "alpha", False),
    *(channels(name, f"{words} {terms.split()[channel]}", terms, applies, False) for name, channel, words, terms, applies in (
        ("channel_inverted", 0, "red as", "1-r g b a", "colour"),
        ("channel_inverted", 1, "green (of normal maps) as", "r 1-g b a", "colour"),
        ("channel_inverted", 2, "blue as", "r g 1-b a", "colour"), ("channel_negated", 0, "x (red) as", "-r g b a", "several"),
        ("channel_negated", 1, "y (green) as", "r -g b a", "several"),
        ("channel_negated", 2, "the other handedness: z (blue) as", "r g -b a", "three"))),
    *(Fault("matrix", words, map=mixed, p=(*((*row, 0, offset) for row in rows), TERMS["a"]), applies="colour")
      for words, rows, offset in MATRICES),
    Fault("premultiplied", "if {from} is multiplied by alpha, as {to} is", applies="alpha",
          map=lambda p, v: np.concatenate([v[:, :3] * v[:, 3:], v[:, 3:]], 1)),
]

GRIDS: list[tuple[Any, ...]] = [
    ("integer", "whole numbers", 1), ("half", "half floats", 10, -14), ("float11", "floats of 11 bits (r11g11b10f)", 6, -14),
    ("bfloat16", "bfloat16", 7, -126), ("float19", "10 bits of fraction (TF32)", 10, -126), ("snorm16", "16-bit signed codes", 32767),
    *((f"unorm{bits}", f"{bits}-bit codes", 2. ** bits - 1) for bits in (4, 5, 8, 10, 16)), ("unorm565", "codes of 5, 6 and 5 bits", 565)]

MAPS = [
    Fault("srgb", "if {to} is decoded from sRGB once: {from} has one encoding less", map=to_srgb, applies="reals"),
    Fault("srgb", "if {from} is decoded from sRGB once: {to} has one encoding less", map=to_light, applies="reals"),
    Fault("gamma", "if {to} is decoded from a gamma of 2.2", map=power, p=(1 / 2.2,), applies="reals"),
    Fault("gamma", "if {from} is decoded from a gamma of 2.2", map=power, p=(2.2,), applies="reals"),
    Fault("srgb_gamma", "with a gamma of 2.2 in {to} against sRGB in {from}", applies="reals",
          map=lambda p, v: to_light(p, v) ** (1 / 2.2)),
    Fault("square", "if {from} is squared, as {to} is", map=power, p=(2,), applies="reals"),
    Fault("depth_range", "after z * 2 - 1 of {from} (0..1 against -1..1)", map=line, p=(2, -1), applies="reals"),
    Fault("depth_range", "after (z + 1) / 2 of {from} (-1..1 against 0..1)", map=line, p=(0.5, 0.5), applies="reals"),
    Fault("depth_reversed", "after 1 - z (reversed depth, or inverted)", map=line, p=(-1, 1), applies="reals", sided=False),
    Fault("depth_reversed", "after 1 - 2 z of {from} (reversed, 0..1 against -1..1)", map=line, p=(-2, 1), applies="reals"),
    Fault("depth_reversed", "after (1 - z) / 2 of {from} (reversed, -1..1 against 0..1)", map=line, p=(-0.5, 0.5), applies="reals"),
    Fault("negated", "with the sign turned", map=line, p=(-1, 0), sided=False),
    Fault("byte_codes", "if {to} has codes of 0..255 for 0..1", map=line, p=(255, 0)),
    Fault("limited_range", "if {to} has the limited range of video (16..235)", map=line, p=(219 / 255, 16 / 255), applies="reals"),
    Fault("limited_range", "if {from} has the limited range of video (16..235)", map=line, p=(255 / 219, -16 / 219), applies="reals"),
    Fault("clamped", "if {from} is clamped to 0..1, as {to} is", p=(0, 1), applies="reals", loses=out_of_range,
          map=lambda p, v: np.clip(v, *p)),
    Fault("clamped", "if what is negative in {from} is 0, as in {to}", p=(0, np.inf), loses=out_of_range,
          map=lambda p, v: np.clip(v, *p)),
    Fault("absolute", "if {to} has magnitudes without the sign", map=lambda p, v: np.abs(v), p=(0, np.inf), loses=out_of_range),
    Fault("reciprocal", "after 1 / v", map=lambda p, v: 1 / v, applies="reals", sided=False),
    Fault("tone", "if {to} has v / (1 + v) (tone mapped)", map=lambda p, v: v / (1 + v), applies="reals"),
    Fault("logarithm", "if {to} has log2 of {from}", map=lambda p, v: np.log2(v), applies="reals"),
    Fault("logarithm", "if {to} has ln of {from}", map=lambda p, v: np.log(v), applies="reals"),
    Fault("depth_linear", "if {from} is hyperbolic depth and {to} linear: 1 / {to} is {0} {from} + {1}",
          map=lambda p, v: 1 / line(p, v), found=2, applies="reals",
          fit=lambda pair, v, target: line_of(v[target != 0], 1 / target[target != 0])),
    Fault("byte_order", "with the bytes of each number in the other order",
          map=lambda p, v: v.astype(WORDS[p[0]][1]).byteswap().astype(np.float64),
          fit=lambda pair, *_: [(i,) for i, (kind, _) in enumerate(WORDS) if kind == pair.kind]),
    *(Fault("wrapped", f"if {{to}} keeps {bits} bits of {{from}}", map=lambda p, v: v % (p[1] + 1), p=(0, 2 ** bits - 1),
            loses=out_of_range) for bits in (8, 16)),
    *(grid(name, f"{word} to {words}", bits, cut, *least)
      for name, words, bits, *least in GRIDS for cut, word in ((0, "rounded"), (1, "cut"))),
    Fault("factor", "with a factor of {0} on {from}", map=line, found=1,
          fit=lambda pair, v, target: [(settled((target / v)[np.abs(v) > 0.1 * pair.range]), 0.)]),
    Fault("offset", "with {1} added to {from}", map=line, found=1, fit=lambda pair, v, target: [(1., settled(target - v))]),
    Fault("affine", "with {0} v + {1} of {from}", map=line, found=2, applies="reals",
          fit=lambda pair, *both: [p for p in line_of(*both) if abs(p[0] - 1) > 1e-5 and abs(p[1]) > 1e-5 * pair.range]),
    Fault("power", "with {from} to the power of {0}", map=power, fit=fit_power, found=1, applies="reals"),
]

SHOWN_FIRST = [
    *(Fault("dither", f"by 1 code, as dithering does; the pattern is {words}", mark=not_dithered, p=p, sided=False) for words, p in (
        ("turned in y", (1, -1)), ("turned in x", (-1, 1)), ("turned in x and y", (-1, -1)), ("moved", (1, 1)))),
    Fault("nan", "where {to} is NaN or infinite", mark=lambda pair, p: np.isfinite(pair.differing_to).all(1).mean()),
    Fault("uninitialised", "where {to} has the pattern of memory that nothing has written", mark=no_pattern),
]

SHOWN = [
    Fault("order", "in the order of elements alone: the same are in both", mark=other_order, sided=False),
    Fault("coverage", "by coverage: what is background in one is drawn in the other (winding, culling or depth test)", mark=not_inverted),
    *(Fault("border", words, mark=only(border), p=p, sided=False) for p, words in ENDS.items()),
    *(Fault("rest", f"behind the last whole {word}, where {{to}} has one value: the dispatch is too small", p=(tile,),
            mark=only(lambda pair, p, z, y, x: (x >= pair.w // p[0] * p[0]) | (pair.image & (y >= pair.h // p[0] * p[0])),
                      holds=ends_with_tiles))
      for tile, word in ((8, "tile of 8"), (16, "tile of 16"), (32, "tile of 32"), (64, "group of 64"))),
    *(Fault("tile_edges", f"at the edges of tiles of {tile} alone", sided=False, p=(tile,), mark=only(
        lambda pair, p, z, y, x: (x % p[0] % (p[0] - 1) == 0) | (pair.image & (y % p[0] % (p[0] - 1) == 0)), 0.1))
      for tile in (64, 32, 16, 8)),
    Fault("alpha_edges", "only where alpha lies between the levels of {to}: {to} has alpha to coverage, or an alpha test",
          mark=not_tested, applies="alpha"),
]

SHOWN_LAST = [  # they fit much
    Fault("layer_alone", "in layer {0} alone", mark=only(lambda pair, p, z, y, x: z == p[0], 0), applies="layers", sided=False,
          fit=lambda pair, *_: [(int(np.bincount(pair.differing[0]).argmax()),)]),
    *(Fault("tiles", f"in whole tiles of {tile}x{tile}", mark=not_tiles, p=(tile,), sided=False, applies="image") for tile in (32, 16, 8)),
    Fault("edges", "at edges alone, where {to} lies between its neighbours: {to} is multisampled or filtered, {from} is not",
          mark=only(lambda pair, p, z, y, x: across_edges(pair, (z, y, x))[1].any(0), 0.05, holds=is_antialiased, most=0.15), leaves=0.15,
          applies="image"),
    Fault("clear", "where {from} has one value, as a clear leaves it: {to} has more drawn there, or lacks the clear", mark=cleared),
]


def phrase(fault: Fault, p: Any, labels: dict[str, str]) -> str:
    """The words of a fault with its numbers."""
    if fault.name == "shift":
        steps = [f"{abs(step):g} texel{'s' if abs(step) > 1 else ''} (or elements) in {axis}" if axis == "x"
                 else f"{abs(step):g} texel{'s' if abs(step) > 1 else ''} in y"
                 for step, axis in zip(p, "xy") if step]
        return "after a shift of " + " and ".join(steps)
    numbers: list[Any] = [f"{number:.6g}" if isinstance(number, (int, float)) else number for number in p]
    if fault.name == "scale":
        row = "the last row" if p[2] else "row 0"
        numbers[1] = "the centre" if 0.5 in p[1:3] else ("the corner of " + row, "the left edge", row)[p[4]]
        return fault.words.format(*numbers, **labels).replace("the scale of", "the scale " + ("of", "in x of", "in y of")[p[4]])
    return fault.words.format(*numbers, **labels)
