"""The table of faults that `why` tries: what one renderer does and the other does not.

A fault predicts one copy, `to`, from the other, `from`, at points of the picture: arrays z, y, x, of a buffer the element in x. A
number that it cannot know is NaN."""
from __future__ import annotations

from dataclasses import dataclass, replace
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
    p: tuple[float, ...] = ()
    fit: Callable[..., list[tuple[float, ...]]] | None = None  # all parameters to try
    applies: str = ""  # a key of TRAITS
    loses: Callable[..., bool] | None = None  # whether what it throws away is what `to` truly lacks
    sided: bool = True  # not the same from either copy
    found: int = 0  # numbers of p that are measured, not chosen
    names: int = 1  # of faults in it
    fills: bool = False  # outside of `from` lies one colour
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
    "matrices": lambda pair: pair.c > 2 and pair.w == pair.c if pair.image else bool((pair.transposed() != np.arange(pair.c)).any()),
    "matrices4": lambda pair: not pair.image and pair.c % 16 == 0,
    "long": lambda pair: not pair.image and pair.stride > 4,
    "odd": lambda pair: not pair.image and 16 % pair.stride,
    **{f"relative{which}": lambda pair, which=which: which in pair.relatives for which in range(4)}}  # type: ignore[misc]


# ---- Places: numbers of another texel ------------------------------------------------------------


def turned(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    return pair.get(z, pair.h - 1 - y if p[1] else y, pair.w - 1 - x if p[0] else x)


def shifts(pair: Any, points: Any, target: Any) -> list[tuple[float, ...]]:
    """The steps at the peaks of the phase correlation, over the edge and not; of a buffer, all short ones."""
    if not pair.image:
        return [(float(step), 0., 0.) for step in (1, -1, 2, -2, 3, -3, 4, -4, 8, -8, 16, -16)]
    return [(x, y, 0.) for x, y in pair.peaks()]


def mean_of(columns: tuple[int, ...], rows: tuple[int, ...], tent: bool = False) -> Callable[..., Array]:
    """Of the neighbours at those steps; of a border, NaN."""
    steps = [(i, j, (2 - abs(i)) * (2 - abs(j)) if tent else 1) for j in rows for i in columns]
    return lambda pair, p, z, y, x: sum(w * pair.get(z, y + j, x + i) for i, j, w in steps) / sum(w for *_, w in steps)


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
    return (numbers(j, i) * (1 - a) + numbers(j, i + 1) * a) * (1 - b) + (numbers(j + 1, i) * (1 - a) + numbers(j + 1, i + 1) * a) * b


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
    middle, 2: linear."""
    scale, mode = p[0], int(p[3])
    middle = 0. if mode == 0 else 0.5
    u = (x + middle - p[1] * pair.w) / scale + p[1] * pair.w
    v = (y + middle - p[2] * pair.h) / scale + p[2] * pair.h
    if mode < 2:
        return pair.get(z, np.floor(v + 1e-9).astype(int), np.floor(u + 1e-9).astype(int))
    return linear(lambda j, i: pair.get(z, j, i), v, u)


def scales(pair: Any, points: Any, target: Any) -> list[tuple[float, ...]]:
    """Those at which `to` follows best."""
    few = pair.question.glance
    places, sought = [axis[few] for axis in points], target[few].mean(1)
    found = []
    for scale in (2, 0.5, 1.5, 2 / 3, 3, 1 / 3, 4, 0.25, 1.25, 0.8, 4 / 3, 0.75):
        for anchor in ((0., 0.), (0., 1.), (0.5, 0.5)):
            value = scaled(pair, (scale, *anchor, 1.), *places).mean(1)
            known = np.isfinite(value) & np.isfinite(sought)
            if known.sum() > 16:
                found.append((-abs(float(np.corrcoef(value[known], sought[known])[0, 1])), (scale, *anchor)))
    return [(*p, float(mode)) for _, p in sorted(found)[:3] for mode in range(3)]


def of_relative(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """Frames have one size; of a mip the texel that lies there."""
    other = pair.relatives[int(p[0])]
    if pair.image:
        x, y = x * other.w // pair.w, y * other.h // pair.h
    return other.get(z, y, x)


# ---- Pitch and layout: numbers of another byte ----------------------------------------------------


def pitched(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """Rows p[2] numbers apart, where `to` has them side by side."""
    row = pair.w * pair.c
    number = (y * p[2] + x * pair.c).astype(int)[:, None] + np.arange(pair.c)
    inside = (number >= 0) & (number < row * pair.h)
    number = np.where(inside, number, 0)
    values = pair.get(np.repeat(z, pair.c), (number // row).ravel(), (number % row // pair.c).ravel())
    return np.where(inside, values[np.arange(len(values)), (number % pair.c).ravel()].reshape(number.shape), np.nan)


def pitches(pair: Any, points: Any, target: Any) -> list[tuple[float, ...]]:
    """At which a few texels of `to` stand in `from`."""
    row, below = pair.w * pair.c, np.flatnonzero(points[1])
    few = below[np.linspace(0, len(below) - 1, min(len(below), 24)).astype(int)]
    pitch = row + np.arange(1, min(row, 1024) + 1)
    values = pitched(pair, (0, 0, np.repeat(pitch, len(few))), *(np.tile(axis[few], len(pitch)) for axis in points))
    near = (np.abs(values - np.tile(target[few], (len(pitch), 1))) <= 0.02 * pair.range).all(1).reshape(len(pitch), -1)
    return [(float(pitch[i]) / pair.c, float(pair.w), float(pitch[i])) for i in np.argsort(-near.sum(1))[:2]]


def repacked(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """`to` has p[0] bytes for each thing that has p[1] in `from`."""
    byte = pair.byte(x)
    into, out = int(p[0]), int(p[1])
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


def ordered(p: Any, v: Array) -> Array:
    """p: the channel of `from` that each of `to` has; 4: 0, 5: 1."""
    more = np.concatenate([v, np.ones((len(v), 4 - v.shape[1])), np.zeros((len(v), 1)), np.ones((len(v), 1))], 1)
    return more[:, [int(i) for i in p[:v.shape[1]]]]


def grey(p: Any, v: Array) -> Array:
    one = v[:, :3] @ np.array([0.2126, 0.7152, 0.0722]) if p[0] else v[:, 0]
    return np.concatenate([np.repeat(one[:, None], 3, 1), v[:, 3:]], 1)


def one_channel(p: Any, v: Array) -> Array:
    """Channel p[0] is -v or 1 - v."""
    v = v.copy()
    v[:, int(p[0])] = (0 if p[1] else 1) - v[:, int(p[0])]
    return v


def constant_there(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """What `to` should have lost is the same number everywhere in it, and not in `from`."""
    gone = [i for i, channel in enumerate(p[:target.shape[1]]) if channel > 3]
    return bool((np.ptp(target[:, gone], 0) == 0).all() and (np.ptp(value[:, gone], 0) > 0).all())


def is_grey(pair: Any, p: Any, value: Array, target: Array) -> bool:
    return bool((np.ptp(target[:, :3], 1) <= pair.step).all() and (np.ptp(value[:, :3], 1) > pair.step).mean() > 0.1)


def luma(kr: float, kb: float) -> Array:
    kg = 1 - kr - kb
    return np.array([[kr, kg, kb], [-kr / 2 / (1 - kb), -kg / 2 / (1 - kb), 0.5], [0.5, -kg / 2 / (1 - kr), -kb / 2 / (1 - kr)]])


LUMAS = {"BT.601": luma(0.299, 0.114), "BT.709": luma(0.2126, 0.0722), "BT.2020": luma(0.2627, 0.0593)}
MATRICES = [*((f"as if {{to}} was encoded with {one} and decoded with {other}, {{from}} not", np.linalg.inv(LUMAS[other]) @ LUMAS[one], 0.)
              for one in LUMAS for other in LUMAS if one != other),
            *((f"if {{to}} has the limited range of video in {name}",
               np.linalg.inv(m) @ np.diag([219 / 255, 224 / 255, 224 / 255]) @ m, 16 / 255) for name, m in LUMAS.items())]


def matrix(p: Any, v: Array) -> Array:
    _, rows, offset = MATRICES[int(p[0])]
    return np.concatenate([v[:, :3] @ rows.T + offset, v[:, 3:]], 1)


# ---- Maps: each number by itself -----------------------------------------------------------------


WORDS = [("float", "f4"), ("half", "f2"), ("uint", "u4"), ("int", "i4"), ("uint16", "u2"), ("int16", "i2")]


def to_srgb(p: Any, v: Array) -> Array:
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)


def to_light(p: Any, v: Array) -> Array:
    return np.where(v <= 0.04045, v / 12.92, ((np.maximum(v, 0) + 0.055) / 1.055) ** 2.4)


def power(p: Any, v: Array) -> Array:
    return np.maximum(v, 0) ** p[0]


def line(p: Any, v: Array) -> Array:
    return p[0] * v + p[1]


def stored(p: Any, v: Array) -> Array:
    """In codes of p[0] steps, or floats of p[0] bits of fraction and p[2] as the least exponent; p[1]: cut off."""
    to_whole: Any = np.trunc if p[1] else np.rint
    if len(p) < 3:
        return to_whole(v * p[0]) / p[0]
    _, exponent = np.frexp(v)
    unit = np.ldexp(1.0, np.maximum(exponent - 1, int(p[2])) - int(p[0]))
    return to_whole(v / unit) * unit


def other_bytes(p: Any, v: Array) -> Array:
    return v.astype(WORDS[int(p[0])][1]).byteswap().astype(np.float64)


def out_of_range(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """All that `to` has is inside, and a part of `from` is not."""
    return bool(((target >= p[0]) & (target <= p[1])).all() and ((value < p[0]) | (value > p[1])).mean() > 0.01)


def on_grid(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """All numbers of `to` are on the coarser grid, and few of `from` are."""
    exact, other = (np.abs(stored((p[0], 0, *p[2:]), v) - v) <= 2e-7 * np.abs(v) for v in (target, value))
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
        centre, rise = v[near].mean(), target[near].mean()
        slope = float(((v[near] - centre) * (target[near] - rise)).sum() / ((v[near] - centre) ** 2).sum())
        offset = float(rise - slope * centre)
    return [(slope, offset)] if np.isfinite(slope + offset) and abs(slope) > 1e-6 else []


def fit_power(pair: Any, v: Array, target: Array) -> list[tuple[float, ...]]:
    keep = (v > 0.02) & (v < 0.98) & (target > 0.001) & (target < 0.999)
    exponent = settled(np.log(target[keep]) / np.log(v[keep]))
    return [(exponent,)] if 0.1 < exponent < 10 else []


# ---- Depth bias ----------------------------------------------------------------------------------


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
    """Factors of a polygon offset are small numbers."""
    slope, error = slope_of(pair, *points).ravel(), (target - pair.get(*points)).ravel()
    return [p for p in line_of(slope[np.isfinite(slope)], error[np.isfinite(slope)]) if 0.01 < abs(p[0]) < 100]


def has_slopes(pair: Any, p: Any, value: Array, target: Array) -> bool:
    """One plane proves no bias."""
    least, middle, most = np.nanquantile(slope_of(pair, *pair.all), (0.1, 0.5, 0.9))
    return bool(most - least > 0.1 * middle)


# ---- Where it shows ------------------------------------------------------------------------------


def border(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    """p: columns from the left, rows from the first, and from the other ends."""
    return (x < p[0]) | (y < p[1]) | (x >= pair.w - p[2]) | (y >= pair.h - p[3])


def behind_tiles(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    return (x >= pair.w // p[0] * p[0]) | (pair.image & (y >= pair.h // p[0] * p[0]))


def ends_with_tiles(pair: Any, p: Any) -> bool:
    """`to` has one value there, from the very end of the last tile on, along x and y each."""
    places = [(at, size, size // p[0] * p[0]) for at, size in zip(pair.differing[:0:-1], (pair.w, pair.h))]
    firsts = [at[np.all([other < end for other, _, end in places if other is not at and pair.h > 1], 0)].min(initial=size) == end
              for at, size, end in places if size % p[0]]
    return all(firsts) and most_of(pair.differing_to)[1] > 0.9


def tile_edge(pair: Any, p: Any, z: Array, y: Array, x: Array) -> Array:
    return (x % p[0] % (p[0] - 1) == 0) | (pair.image & (y % p[0] % (p[0] - 1) == 0))


def only(where: Callable[..., Array], fill: float = 0.3, most: float = 0.02,
         holds: Callable[..., bool] | None = None) -> Callable[..., float | None]:
    """But for `most`, all differences lie there, it is a small part of the whole, and a fair share of it differs."""
    def mark(pair: Any, p: Any) -> float | None:
        inside = where(pair, p, *pair.differing)
        share = max(float(where(pair, p, *pair.all).mean()), 1 / pair.question.elements)
        pair.vague = 0.3 * share
        proved = share <= 0.6 and pair.share * inside.mean() >= fill * share and len(inside) * -np.log2(share) >= 25
        return float(1 - inside.mean()) if proved and inside.mean() >= 1 - most and (not holds or holds(pair, p)) else None
    return mark


# ---- What both copies show together ---------------------------------------------------------------


def rows_of(values: Array) -> Array:
    return np.ascontiguousarray(values).view(np.dtype((np.void, values.itemsize * values.shape[1]))).ravel()


def most_of(values: Array) -> tuple[Array, float]:
    """The row that occurs most often, and its share."""
    _, index, counts = np.unique(rows_of(values), return_index=True, return_counts=True)
    best = counts.argmax()
    return values[index[best]], float(counts[best] / len(values))


PATTERNS = [bytes.fromhex(word) for word in ("efbeadde", "0df0adba", "bebafeca", "0df0feca")]
FILLS = bytes.fromhex("cdccfeabaaa55a55ddfdbd7fba")


def no_pattern(pair: Any, p: Any) -> float | None:
    raw = pair.raw_to()
    if len(raw) < 2:
        return None
    same = (raw == raw[:, :1]).all(1) & np.isin(raw[:, 0], np.frombuffer(FILLS, np.uint8))
    if raw.shape[1] % 4 == 0:
        for word in PATTERNS:
            same |= (raw.reshape(len(raw), -1, 4) == np.frombuffer(word, np.uint8)).all((1, 2))
    return float(1 - same.mean())


def not_in_layer(pair: Any, p: Any) -> float:
    layer = np.bincount(pair.differing[0]).argmax()
    pair.told = (layer,)
    return float((pair.differing[0] != layer).mean())


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
    return float((a != b).mean()) if len(np.unique(a)) > 3 else None


def not_tiles(pair: Any, p: Any) -> float | None:
    """The share of tiles with a difference that do not differ as a whole; what differs ends at borders of tiles."""
    tile = int(p[0])
    if pair.d > 1 or pair.w < 3 * tile or pair.h < 2 * tile or pair.w * pair.h > 1 << 22:
        return None
    whole = pair.mask()[:pair.h // tile * tile, :pair.w // tile * tile]
    shares = whole.reshape(pair.h // tile, tile, pair.w // tile, tile).mean((1, 3))
    full = shares[shares > 0] > 0.9
    ends = [np.nonzero(np.diff(whole, axis=axis))[axis] + 1 for axis in (0, 1)]
    luck = sum(len(np.unique(places)) for places in ends) * np.log2(tile)  # a box may end there by chance, not many
    return float(1 - full.mean()) if luck >= 20 and (np.concatenate(ends) % tile == 0).mean() > 0.7 else None


def lines_of(pair: Any, side: Any, axis: int) -> Array:
    """Some columns (axis 0) or rows (1) of the layer that differs most, from end to end: which, where, channel."""
    size, others = (pair.h, pair.w) if axis == 0 else (pair.w, pair.h)
    across, along = np.meshgrid(np.linspace(0, others - 1, min(others, 48)).astype(int), np.arange(size), indexing="ij")
    y, x = (along, across) if axis == 0 else (across, along)
    z = np.full(y.size, np.bincount(pair.differing[0]).argmax())
    return side.get(z, y.ravel(), x.ravel()).reshape(*y.shape, -1)


def still_ends(pair: Any, axis: int) -> tuple[int, int]:
    """The last lines at both ends of `to` behind which it repeats them; an end is at least three texels."""
    lines = lines_of(pair, pair.target, axis)
    size = lines.shape[1]
    steps = pair.near(lines[:, 1:].reshape(-1, pair.c), lines[:, :-1].reshape(-1, pair.c)).reshape(len(lines), -1).mean(0)
    moves = np.flatnonzero(steps < 0.85)
    low, high = (int(moves[0]), int(moves[-1]) + 1) if len(moves) else (0, size - 1)
    return low if low > 2 else 0, high if high < size - 3 else size - 1


def goes_round(lines: Array, edge: int, width: int) -> bool:
    """Behind the edge they come again after that width alone, or there is a seam, and their start follows on their end."""
    flat, first = np.nan_to_num(lines.mean(2)), edge + 1
    count, behind = flat.shape[1] - first, flat[:, first:]
    same = np.array([np.corrcoef(behind.ravel(), flat[:, first - lag:][:, :count].ravel())[0, 1] for lag in range(1, first)])
    again = 1 + np.flatnonzero((same > 0.85) & (same > np.minimum.accumulate(np.fmin(same, 1)) + 0.3))
    if len(again) and np.abs(again - width).max() <= 2:
        return True
    steps = np.abs(np.diff(lines, axis=1)).mean((0, 2))
    joint = min(np.abs(lines[:, 0] - lines[:, other]).mean() for other in (-1, first))
    return bool(steps[edge] > 1.5 * np.quantile(steps, 0.9) and joint <= 0.6 * steps[edge])


def not_clamped(pair: Any, p: Any) -> float | None:
    """Behind lines of x or y, `to` repeats its texels, and most of it differs there. p: `from` wraps."""
    if not len(pair.differing_to) or pair.w * pair.h > 1 << 24:
        return None
    if pair.near(np.median(pair.differing_to, 0), pair.differing_to).mean() >= 0.5:  # one colour, not texels again
        return None
    inner, words, wraps = list(pair.differing), [], False
    beyond, here = np.zeros(len(inner[0]), bool), np.zeros(len(pair.all[0]), bool)
    for axis, place, texts in ((0, 2, ("left of column", "right of column")), (1, 1, ("before row", "behind row"))):
        ends, lines = still_ends(pair, 1 - axis), lines_of(pair, pair, 1 - axis)
        for text, edge, turn in zip(texts, ends, (-1, 1)):
            at = turn * pair.differing[place]
            there = at > turn * edge
            if there.mean() > 0.02:
                edge = turn * int(at[there].min() - 1)  # texels may be still before, where none differ
                words.append(f"{text} {edge}")
                inner[place], beyond = np.where(there, edge, inner[place]), beyond | there
                here |= turn * pair.all[place] > turn * edge
                wraps |= goes_round(lines[:, ::turn], edge if turn > 0 else len(lines[0]) - 1 - edge, ends[1] - ends[0] + 1)
    pair.told = (" and ".join(words),)
    share = np.mean(here)
    if not words or share > 0.9 or pair.question.share * np.mean(beyond) < 0.2 * share or wraps < p[0]:
        return None
    return float(1 - (beyond & pair.near(pair.target.get(*inner), pair.differing_to)).mean())


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
    for words, again in (("turned in y", error[::-1]), ("turned in x", error[:, ::-1]), ("turned in x and y", error[::-1, ::-1]),
                         ("moved", error)):
        product = np.fft.irfft2(np.fft.rfft2(error) * np.conj(np.fft.rfft2(again)), error.shape)
        if product.min() < min(-0.42, -12 / np.sqrt(error.size)) * (error ** 2).sum():
            pair.told = (words,)
            return 0.
    return None


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


def at_edge(pair: Any, p: Any, *points: Array) -> Array:
    return across_edges(pair, points)[1].any(0)  # type: ignore[arg-type]


def is_antialiased(pair: Any, p: Any) -> bool:
    """`to` has edges softer, and not `from`: its bright side gets darker, its dark side brighter."""
    softer, sharper = (softened(side) for side in sorted(pair.question.pairs, key=lambda other: other is not pair))
    brighter = (pair.differing_to - pair.differing_from).sum(1) > 0
    return bool(pair.share <= 0.2 and softer > max(2 * sharper, 0.7) and 0.1 < brighter.mean() < 0.9)


# ---- The table -----------------------------------------------------------------------------------


def channels(name: str, words: str, *order: float) -> Fault:
    lost = constant_there if max(order) > 3 else None
    return Fault(name, words, map=ordered, p=order, applies="colour" if order[3] == 3 else "alpha", loses=lost)


def after_turn(turn: Fault, fault: Fault) -> Fault:
    """Two faults of place in a row; an image's alone."""
    def at(pair: Any, p: Any, *points: Array) -> Array:
        return fault.at(pair.turned(turn.p), p, *points)  # type: ignore[misc]

    def fit(pair: Any, points: Any, target: Any) -> list[tuple[float, ...]]:
        pair = pair.turned(turn.p)
        return [] if not pair.has(fault.applies) else fault.fit(pair, points, target) if fault.fit else [fault.p]

    return replace(fault, name=turn.name, words=f"{turn.words}, and {fault.words}", at=at, fit=fit, applies="image", names=2,
                   loses=fault.loses and (lambda pair, p, *both: fault.loses(pair.turned(turn.p), p, *both)))  # type: ignore[misc]


def grid(name: str, words: str, *p: float) -> Fault:
    return Fault(name, "if {from} is " + words, map=stored, p=p, applies="reals", loses=on_grid)


BLOCKS = {(2, 2): "2x2 texels", (4, 4): "4x4 texels", (3, 3): "3x3 texels", (6, 6): "6x6 texels", (2, 1): "2 columns", (1, 2): "2 rows"}
ENDS = {(0, 0, 0, 1): "in the last row alone", (0, 1, 0, 0): "in the first row alone",
        (0, 0, 1, 0): "in the last column (or element) alone",
        (1, 0, 0, 0): "in the first column (or element) alone",
        (0, 0, 1, 1): "in the last row and column alone: an odd size is rounded down",
        (1, 1, 1, 1): "at the border alone: clamp, wrap or border colour",
        (2, 2, 2, 2): "in the two texels at the border: clamp, wrap or border colour"}

PLACES = [
    *(Fault(name, "after " + words, at=turned, p=p, applies="image", sided=False) for name, words, p in (
        ("flip_y", "a flip in y: OpenGL's row 0 is the bottom", (0, 1)), ("mirror_x", "a mirror in x", (1, 0)),
        ("turn", "half a turn: x and y run backwards", (1, 1)))),
    Fault("reversed", "with the elements in reverse order", at=turned, p=(1, 0), applies="buffer", sided=False),
    Fault("axes", "with x and y in each other's place", applies="square", sided=False,
          at=lambda pair, p, z, y, x: pair.get(z, x, y)),
    Fault("quarter_turn", "after a quarter turn of {from}", applies="square",
          at=lambda pair, p, z, y, x: pair.get(z, x, pair.w - 1 - y)),
    Fault("frame", "one frame late: {to} has the frame before of {from}", at=of_relative, p=(0,), applies="relative0"),
    Fault("frame", "one frame early: {to} has the frame after of {from}", at=of_relative, p=(1,), applies="relative1"),
    Fault("layer", "with another layer: {to} has in each that of {from} which is {2} behind", applies="layers",
          at=lambda pair, p, z, y, x: pair.get(z + p[2], y, x),
          fit=lambda pair, *_: [(0, 0, step) for step in range(max(1 - pair.d, -8), min(pair.d, 9)) if step]),
    Fault("layers_reversed", "with the layers in reverse order", applies="layers", sided=False,
          at=lambda pair, p, z, y, x: pair.get(pair.d - 1 - z, y, x)),
    *(Fault("faces", f"with {words} swapped", at=lambda pair, p, z, y, x: pair.get(np.where(np.isin(z % 6 // 2, p), z ^ 1, z), y, x), p=p,
            applies="cube", sided=False)
      for p, words in (((0,), "the faces +x and -x"), ((1,), "the faces +y and -y"), ((2,), "the faces +z and -z"),
                       ((0, 1, 2), "opposite faces of the cube"))),
    Fault("mip", "one mip off: {to} has the finer mip of {from}", at=of_relative, p=(2,), applies="relative2"),
    Fault("mip", "one mip off: {to} has the coarser mip of {from}", at=of_relative, p=(3,), applies="relative3"),
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
    Fault("scale", "at {0} times the scale of {from} about {1}", at=scaled, fit=scales, applies="image", found=1, fills=True),
    *(Fault("nearest", f"where {{to}} filters and {{from}} repeats {words}: nearest against linear", at=smooth, p=(*size, 1),
            applies="close") for size, words in BLOCKS.items()),
    *(Fault("half_rate", f"if {{to}} has means of {words}: lower resolution", at=coarse, p=(*size, 0), applies="close",
            loses=varied_in_blocks) for size, words in BLOCKS.items()),
    *(Fault("half_rate", f"if {{to}} repeats one texel of {words}: nearest, lower resolution", at=coarse, p=(*size, last), applies="close")
      for size, words in BLOCKS.items() for last in (1, 2)),
    *(Fault("half_rate", f"if {{to}} has means of {words}, filtered: lower resolution, or a coarser mip", at=smooth, p=(*size, 0),
            applies="close", loses=varied_in_blocks) for size, words in BLOCKS.items()),
    Fault("blurred", "if {from} is filtered by 3x3 texels, as {to} is", at=mean_of((-1, 0, 1), (-1, 0, 1)), applies="close"),
    Fault("blurred", "if {from} is filtered by a 3x3 tent, as {to} is", at=mean_of((-1, 0, 1), (-1, 0, 1), True), p=(2, 2), applies="close",
          loses=varied_in_blocks),
    Fault("transposed", "after each matrix is transposed (rows against columns)", at=transposed, applies="matrices", sided=False),
    *(Fault(name, f"{words}{order}", at=matrix_row, p=(step, *p), applies="matrices4", sided=not p[1])
      for name, words, p in (("matrix_y", "with the y row of each matrix negated (Vulkan's y points down)", (1, 1)),
                             ("matrix_z", "if the z row of each matrix of {from} goes from -1..1 to 0..1", (2, 0)))
      for step, order in ((1, ""), (4, ", by rows"))),
    *(Fault("layout", f"with {words} (std140, std430 or packed): {into} bytes each in {{to}}, {out} in {{from}}", at=repacked,
            p=(into, out), applies="buffer") for into, out, words in (
        (12, 16, "vec3 of 12 against 16 bytes"), (4, 16, "numbers of 4 against 16 bytes"), (8, 16, "vec2 of 8 against 16 bytes"),
        (16, 12, "vec3 of 16 against 12 bytes"), (16, 4, "numbers of 16 against 4 bytes"), (16, 8, "vec2 of 16 against 8 bytes"))),
    Fault("stride", "with elements of {1} bytes against {0} (std140, std430 or packed)", at=repacked, found=1, applies="buffer",
          fit=lambda pair, *_: [(pair.stride, stride) for stride in range(4, 4 * pair.stride + 1, 4) if stride != pair.stride]),
    Fault("moved", "if all lies one number (4 bytes) later", at=lambda pair, p, z, y, x: pair.words(pair.byte(x) + 4), applies="long"),
    Fault("moved", "if all lies 16 bytes later", at=lambda pair, p, z, y, x: pair.words(pair.byte(x) + 16), applies="odd"),
    Fault("depth_bias", "with an error in proportion to the slope of depth: {0} slope + {1} (depth bias)", at=biased, fit=fit_bias,
          found=2, applies="depth", loses=has_slopes),
]

AFTER_TURN = [after_turn(turn, fault) for turn in PLACES[:3] for fault in PLACES
              if fault.name in ("shift", "scale", "half_rate") or fault.name.startswith("half_texel")]

CHANNELS = [
    channels("red_blue", "with red and blue swapped (RGBA against BGRA)", 2, 1, 0, 3),
    *(channels("channels", f"with {words}", *order) for words, order in (
        ("red and green swapped", (1, 0, 2, 3)), ("green and blue swapped", (0, 2, 1, 3)),
        ("the channels in the order g, b, r", (1, 2, 0, 3)), ("the channels in the order b, r, g", (2, 0, 1, 3)),
        ("the channels in the order a, r, g, b", (3, 0, 1, 2)), ("the channels in the order a, b, g, r", (3, 2, 1, 0)),
        ("the channels in the order g, b, a, r", (1, 2, 3, 0)))),
    Fault("channels", "with both channels swapped", map=ordered, p=(1, 0), applies="two", sided=False),
    Fault("grey", "if {to} has the first channel of {from} in all", map=grey, p=(0,), applies="colour", loses=is_grey),
    Fault("grey", "if {to} has the luminance of {from} in all channels", map=grey, p=(1,), applies="colour", loses=is_grey),
    channels("alpha_lost", "if alpha is 1 in {to}", 0, 1, 2, 5),
    channels("alpha_lost", "if alpha is 0 in {to}", 0, 1, 2, 4),
    *(channels("channel_lost", f"if {words} 0 in {{to}}", *order, 3) for words, order in (
        ("red is", (4, 1, 2)), ("green is", (0, 4, 2)), ("blue is", (0, 1, 4)), ("green and blue are", (0, 4, 4)),
        ("red and blue are", (4, 1, 4)), ("red and green are", (4, 4, 2)))),
    Fault("premultiplied", "if {from} is multiplied by alpha, as {to} is", applies="alpha",
          map=lambda p, v: np.concatenate([v[:, :3] * v[:, 3:], v[:, 3:]], 1)),
    Fault("alpha_inverted", "with alpha inverted", map=one_channel, p=(3, 0), applies="alpha", sided=False),
    *(Fault("channel_inverted", words, map=one_channel, p=(i, 0), applies="colour", sided=False)
      for i, words in enumerate(("with red as 1 - r", "with green as 1 - g (normal maps)", "with blue as 1 - b"))),
    Fault("channel_negated", "with x (red) negated", map=one_channel, p=(0, 1), applies="several", sided=False),
    Fault("channel_negated", "with y (green) negated", map=one_channel, p=(1, 1), applies="several", sided=False),
    Fault("channel_negated", "with z (blue) negated: the other handedness", map=one_channel, p=(2, 1), applies="three", sided=False),
    *(Fault("matrix", words, map=matrix, p=(i,), applies="colour") for i, (words, *_) in enumerate(MATRICES)),
]

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
    Fault("byte_order", "with the bytes of each number in the other order", map=other_bytes,
          fit=lambda pair, *_: [(i,) for i, (kind, _) in enumerate(WORDS) if kind == pair.kind]),
    *(Fault("wrapped", f"if {{to}} keeps {bits} bits of {{from}}", map=lambda p, v: v % (p[1] + 1), p=(0, 2 ** bits - 1),
            loses=out_of_range) for bits in (8, 16)),
    grid("integer", "rounded to whole numbers", 1, 0),
    grid("integer", "cut to whole numbers", 1, 1),
    grid("half", "rounded to half floats", 10, 0, -14),
    grid("half", "cut to half floats", 10, 1, -14),
    *(grid(f"unorm{bits}", f"{words} to {bits}-bit codes{more}", 2. ** bits - 1, cut)
      for bits in (8, 10, 16) for cut, words, more in ((0, "rounded", ""), (1, "cut down", ", not rounded"))),
    grid("snorm16", "rounded to 16-bit signed codes", 32767, 0),
    grid("float11", "rounded to floats of 11 bits (r11g11b10f)", 6, 0, -14),
    grid("float11", "cut to floats of 11 bits (r11g11b10f)", 6, 1, -14),
    grid("bfloat16", "rounded to bfloat16", 7, 0, -126),
    grid("bfloat16", "cut to bfloat16", 7, 1, -126),
    grid("float19", "rounded to 10 bits of fraction (TF32)", 10, 0, -126),
    Fault("factor", "with a factor of {0} on {from}", map=line, found=1,
          fit=lambda pair, v, target: [(settled((target / v)[np.abs(v) > 0.1 * pair.range]), 0.)]),
    Fault("offset", "with {1} added to {from}", map=line, found=1, fit=lambda pair, v, target: [(1., settled(target - v))]),
    Fault("affine", "with {0} v + {1} of {from}", map=line, found=2, applies="reals",
          fit=lambda pair, *both: [p for p in line_of(*both) if abs(p[0] - 1) > 1e-5 and abs(p[1]) > 1e-5 * pair.range]),
    Fault("power", "with {from} to the power of {0}", map=power, fit=fit_power, found=1, applies="reals"),
]

SHOWN_FIRST = [
    Fault("dither", "by 1 code, as dithering does; the pattern is {0}", mark=not_dithered, sided=False),
    Fault("nan", "where {to} is NaN or infinite", mark=lambda pair, p: np.isfinite(pair.differing_to).all(1).mean()),
    Fault("uninitialised", "where {to} has the pattern of memory that nothing has written", mark=no_pattern),
]

SHOWN = [
    Fault("order", "in the order of elements alone: the same are in both", mark=other_order, sided=False),
    Fault("coverage", "by coverage: what is background in one is drawn in the other (winding, culling or depth test)", mark=not_inverted),
    Fault("wrap", "{0}, where {to} repeats its texels (clamped) and {from} goes on with its other end (wrapped)", mark=not_clamped, p=(1,),
          leaves=0.15, applies="image"),
    Fault("smear", "{0} alone, where {to} repeats its texels: clamped inside, or at the end of a texture that {from} wraps",
          applies="image", mark=not_clamped, p=(0,), leaves=0.15),
    *(Fault("border", words, mark=only(border), p=p, sided=False) for p, words in ENDS.items()),
    *(Fault("rest", f"behind the last whole {word}, where {{to}} has one value: the dispatch is too small", p=(tile,),
            mark=only(behind_tiles, holds=ends_with_tiles))
      for tile, word in ((8, "tile of 8"), (16, "tile of 16"), (32, "tile of 32"), (64, "group of 64"))),
    *(Fault("tile_edges", f"at the edges of tiles of {tile} alone", mark=only(tile_edge, 0.1), p=(tile,), sided=False)
      for tile in (64, 32, 16, 8)),
    *(Fault("tiles", f"in whole tiles of {tile}x{tile}", mark=not_tiles, p=(tile,), sided=False, applies="image") for tile in (32, 16, 8)),
    Fault("clear", "where {from} has one value, as a clear leaves it: {to} has more drawn there, or lacks the clear", mark=cleared),
    Fault("layer_alone", "in layer {0} alone", mark=not_in_layer, applies="layers", sided=False),
    Fault("edges", "at edges alone, where {to} lies between its neighbours: {to} is multisampled or filtered, {from} is not",
          mark=only(at_edge, 0.05, holds=is_antialiased, most=0.15), leaves=0.15, applies="image"),
    Fault("alpha_edges", "only where alpha lies between the levels of {to}: {to} has alpha to coverage, or an alpha test",
          mark=not_tested, applies="alpha"),
]


def phrase(fault: Fault, p: Any, labels: dict[str, str]) -> str:
    """The words of a fault with its numbers."""
    if fault.name == "shift":
        steps = [f"{abs(step):g} texel{'s' if abs(step) > 1 else ''} (or elements) in {axis}" if axis == "x"
                 else f"{abs(step):g} texel{'s' if abs(step) > 1 else ''} in y"
                 for step, axis in zip(p, "xy") if step]
        return "after a shift of " + " and ".join(steps)
    numbers: list[Any] = [number if isinstance(number, str) else f"{number:.6g}" for number in p]
    if fault.fills:
        numbers[1] = "the centre" if p[1] else "the corner of " + ("the last row" if p[2] else "row 0")
    text = fault.words
    for key, value in [*labels.items(), *((str(i), number) for i, number in enumerate(numbers))]:
        text = text.replace("{" + key + "}", value)
    return text
