"""`diptych flicker`: how much pictures of the same surfaces change from one frame to the next, while
camera and light move, compared with the reference's change. The C program finds the surface of each
pixel by rays into the scene, so the pictures may come from any pipeline.

Be E(t, p) what pixel p shows in frame t, of irradiance in W/m2 per channel, and x(t, p) the point of
the scene at its centre. The pixel of frame t + 1 is compared where that point was seen before:

  D(p) = E(t + 1, p) - E(t, q),   q = project(t, x(t + 1, p)),   E(t, q) bilinear

A pixel next to q counts as another surface, and p is left out, where it lies outside the picture,
shows the background, turns its normal away by more than an angle whose cosine is 0.9, or lies off the
tangent plane of x(t + 1, p) by more than 0.005 of the depth of it. That leaves out what came into
view, and the edges; light that moves over a surface is compared.

  change    = mean over p and channels of |D(p)|              W/m2 per frame
  flicker   = mean over p and channels of |D(p) - D'(p)|      W/m2 per frame

with D' of the reference: what the pictures change beyond, short of, or elsewhere than the truth does.
With blocks, D and D' are first averaged over the compared pixels of every square of `block` x `block`
pixels, and the mean is over these, each weighted by its number of pixels: noise of the reference,
which is another in every pixel, becomes `block` times smaller, and what wanders over whole surfaces
stays."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np

from .console import Console
from .stream import read_array, read_picture

LEAST_COSINE = 0.9  # of two normals of one surface
MOST_OFF_PLANE = 0.005  # relative to the depth
LEAST_WEIGHT = 1e-3  # of a neighbour that counts; above rounding errors

# A surface point, row 0 at the top. depth: along the view; 0: background. normal: unit, as
# interpolated; plane: unit, of the triangle.
POINT = np.dtype([("position", "f4", 3), ("depth", "f4"), ("normal", "f4", 3), ("plane", "f4", 3)])


@dataclass
class Frame:
    points: np.ndarray  # of POINT
    view_projection: np.ndarray  # clip space as in struct dt_view, by columns
    pictures: list[np.ndarray]  # the test, and the reference if there is one


@dataclass
class Change:
    """Between two frames, see above. Numbers of both pictures: the test, the reference."""
    surfaces: int  # pixels that show a surface
    compared: int  # of these, those visible before, with finite values; 0: all below is 0
    means: list[float]  # of the compared pixels in the later frame, W/m2
    changes: list[float]
    flicker: float


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("...i,...i", a, b, dtype=np.float64)


def is_same_surface(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    off = np.abs(dot(a["plane"], b["position"] - a["position"]))
    return ((b["depth"] > 0) & (dot(a["normal"], b["normal"]) > LEAST_COSINE) &
            (off < MOST_OFF_PLANE * a["depth"].astype(np.float64)))


def reproject(before: Frame, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where the points were visible; four pixels of the frame for each, and their weights, which sum to
    1 there and interpolate the value at the point."""
    height, width = points.shape
    matrix = before.view_projection.astype(np.float64)
    clip = points["position"] @ matrix[:3] + matrix[3]
    x = (0.5 + 0.5 * clip[..., 0] / clip[..., 3]) * width - 0.5
    y = (0.5 - 0.5 * clip[..., 1] / clip[..., 3]) * height - 0.5
    seen = (points["depth"] > 0) & (clip[..., 3] > 0) & (np.abs(x) < 1e9) & (np.abs(y) < 1e9)
    pixels, weights = [], []
    for i in range(4):
        column, row = np.floor(x) + (i & 1), np.floor(y) + (i >> 1)
        weight = (1 - np.abs(x - column)) * (1 - np.abs(y - row))
        counts = weight >= LEAST_WEIGHT
        inside = (column >= 0) & (row >= 0) & (column < width) & (row < height)
        pixel = np.where(inside & seen, row * width + column, 0).astype(np.intp)
        same = is_same_surface(points, before.points.ravel()[pixel])
        seen = seen & (~counts | (inside & same))
        pixels.append(pixel)
        weights.append(np.where(counts, weight, 0))
    all_weights = np.stack(weights)
    return seen, np.stack(pixels), all_weights / all_weights.sum(axis=0)


def change_of(before: Frame, now: Frame, block: int) -> Change:
    height, width = now.points.shape
    compared, pixels, weights = reproject(before, now.points)
    differences = []
    for old, new in zip(before.pictures, now.pictures):
        taps = old.reshape(-1, 3)[pixels].astype(np.float64)
        taps[weights == 0] = 0
        difference = new - np.einsum("khw,khwc->hwc", weights, taps)
        compared = compared & np.isfinite(difference).all(axis=2)
        differences.append(difference)
    places = np.arange(height)[:, None] // block * (width // block + 1) + np.arange(width) // block
    blocks = [np.stack([np.bincount(places[compared], difference[compared][:, channel])
                        for channel in range(3)]) for difference in differences]
    numbers = max(3 * int(np.count_nonzero(compared)), 1)
    return Change(
        surfaces=int(np.count_nonzero(now.points["depth"] > 0)),
        compared=int(np.count_nonzero(compared)),
        means=[float(new[compared].sum(dtype=np.float64)) / numbers for new in now.pictures],
        changes=[float(np.abs(sums).sum()) / numbers for sums in blocks],
        flicker=float(np.abs(blocks[0] - blocks[-1]).sum()) / numbers)


def mean_of(changes: list[Change]) -> Change:
    """The means over all pixels of some pairs of frames."""
    weights = [change.compared for change in changes]
    pixels = max(sum(weights), 1)

    def mean(values: list[float]) -> float:
        return sum(weight * value for weight, value in zip(weights, values)) / pixels

    return Change(surfaces=sum(change.surfaces for change in changes), compared=sum(weights),
                  means=[mean(list(values)) for values in zip(*(c.means for c in changes))],
                  changes=[mean(list(values)) for values in zip(*(c.changes for c in changes))],
                  flicker=mean([change.flicker for change in changes]))


# ---- The verb ------------------------------------------------------------------------------------


def read_frame(stream: BinaryIO, console: Console, request: dict[str, Any]) -> Frame:
    pictures = [read_picture(stream, console)[..., :3]]
    if "reference" in request:
        pictures.append(read_picture(stream, console)[..., :3])
    matrix = read_array(stream, (4, 4), np.float32)
    return Frame(read_array(stream, pictures[0].shape[:2], POINT), matrix, pictures)


def numbers_of(change: Change) -> dict[str, Any]:
    """Relative ones are to the reference's mean, or without one, the pictures' own: comparable between
    scenes."""
    def relative(value: float) -> float | None:
        return value / change.means[-1] if change.means[-1] > 0 else None

    numbers: dict[str, Any] = {
        "surfaces": change.surfaces, "compared": change.compared, "mean": change.means[0],
        "change": change.changes[0], "relative_change": relative(change.changes[0])}
    if len(change.means) > 1:
        excess = change.changes[0] - change.changes[1]
        numbers.update({
            "mean_reference": change.means[1], "change_reference": change.changes[1],
            "relative_change_reference": relative(change.changes[1]),
            "excess": excess, "relative_excess": relative(excess),
            "flicker": change.flicker, "relative_flicker": relative(change.flicker)})
    return numbers


def print_change(name: str, numbers: dict[str, Any]) -> None:
    def percent(key: str, width: int = 7, digits: int = 3) -> str:
        value = numbers[key]
        return f"{math.nan if value is None else 100 * value:{width}.{digits}f} %"

    numbers["seen"] = numbers["compared"] / max(numbers["surfaces"], 1)
    line = f"{name:6}  {percent('seen', 8, 1)}  {numbers['mean']:9.5f}  {percent('relative_change')}"
    if "flicker" in numbers:
        keys = ("relative_change_reference", "relative_excess", "relative_flicker")
        line += f"  {numbers['mean_reference']:9.5f}  " + "  ".join(map(percent, keys))
    print(line)


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    np.seterr(all="ignore")  # pixels may be NaN or Inf
    block, changes = request.get("block", 1), []
    with open(request["stream"], "rb") as stream:
        before = read_frame(stream, console, request)
        for _ in range(1, request["frames"]):
            now = read_frame(stream, console, request)
            changes.append(change_of(before, now, block))
            before = now
    head = f"{'frame':6}  {'compared':>10}  {'mean':>9}  {'change':>9}"
    if "reference" in request:
        head += "".join(f"  {name:>9}" for name in ("reference", "its chg.", "excess", "flicker"))
    print(head)
    rows = [numbers_of(change) for change in changes]
    whole = numbers_of(mean_of(changes))
    for i, numbers in enumerate(rows, 1):
        print_change(str(i), dict(numbers))
    print_change("all", dict(whole))
    given = {key: request[key] for key in ("scene", "motion", "test", "reference") if key in request}
    per_frame = [{"frame": i, **numbers} for i, numbers in enumerate(rows, 1)]
    return 0, {**given, "frames": request["frames"], "block": block, **whole, "per_frame": per_frame}
