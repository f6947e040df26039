"""Texels of RenderDoc's formats as those of a dump (templates/dump.schema.json), and small pictures of them, for replay.py."""
from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import renderdoc as rd

MOST_SIDE = 64  # of a small picture


@dataclass
class Texels:
    format: str
    rows: np.ndarray  # height, width and bytes of a texel, or one number


TYPES = rd.ResourceFormatType
KINDS = rd.CompType
SUFFIXES = {KINDS.UNorm: "", KINDS.UNormSRGB: "", KINDS.Typeless: "", KINDS.SNorm: "_snorm", KINDS.Float: "f", KINDS.UInt: "ui",
            KINDS.SInt: "i", KINDS.UScaled: "ui", KINDS.SScaled: "i"}
ONE = 0x3f800000  # a float
DEPTHS = {2: ("d16", "<u2"), 3: ("d24", "<u4"), 4: ("d32f", "<f4")}
NUMBERS = {"": "u", "_snorm": "i", "f": "f", "ui": "u", "i": "i"}
# Texels of 16 bits that a dump has no format of: bits of red, green, blue and alpha, from the lowest.
SHORT = {TYPES.R5G6B5: (5, 6, 5, 0), TYPES.R5G5B5A1: (5, 5, 5, 1), TYPES.R4G4B4A4: (4, 4, 4, 4)}


def regular(form: Any, raw: bytes, width: int, height: int) -> Texels | None:
    """Three channels get a fourth, 1, where a dump has no format of three; snorm8 becomes snorm16."""
    size, count = form.compByteWidth, form.compCount
    suffix = SUFFIXES.get(form.compType)
    if suffix is None or size not in (1, 2, 4) or (size == 1 and suffix == "f") or (size == 4 and suffix in ("", "_snorm")):
        return None
    rows = np.frombuffer(raw, f"<{NUMBERS[suffix]}{size}", width * height * count).reshape(height, width, count)
    srgb = "_srgb" if form.compType == KINDS.UNormSRGB and count > 2 else ""
    if size == 1 and not suffix and count > 2:
        if form.BGRAOrder() and count == 3:
            rows = np.ascontiguousarray(rows[..., ::-1])
        return Texels(("bgra8" if form.BGRAOrder() else "rgba8" if count == 4 else "rgb8") + srgb, rows)
    if size == 1 and suffix == "_snorm":
        rows, size = np.rint(np.clip(rows / 127, -1, 1) * 32767).astype("<i2"), 2
    if count == 3:
        one = {"": np.iinfo("u2").max, "_snorm": np.iinfo("i2").max}.get(suffix, 1)
        rows = np.concatenate([rows, np.full_like(rows[..., :1], one)], -1)
    return Texels(("r", "rg", "rgba", "rgba")[count - 1] + str(8 * size) + suffix, rows)


def short(bits: tuple[int, ...], raw: bytes, width: int, height: int) -> Texels:
    codes = np.frombuffer(raw, "<u2", width * height).reshape(height, width).astype("u4")
    channels, low = [], 0
    for count in bits:
        top = (1 << count) - 1
        channels.append(np.rint((codes >> low & top) * (255 / top)) if top else np.full(codes.shape, 255))
        low += count
    return Texels("rgba8", np.stack(channels, -1).astype("u1"))


def texels_of(form: Any, raw: bytes, width: int, height: int, gl: bool) -> Texels | None:
    """None: there is no content, or no such format in a dump."""
    def words() -> np.ndarray:
        return np.frombuffer(raw, "<u4", width * height).reshape(height, width, 1)

    kind = form.type
    if not raw:
        return None
    if kind == TYPES.Regular and form.compType == KINDS.Depth:
        name, number = DEPTHS[form.compByteWidth]
        if name == "d32f" and words().max() > ONE:  # OpenGL also has depth of 32 bits that is no float
            return Texels("d24", words() >> 8)
        return Texels(name, np.frombuffer(raw, number, width * height).reshape(height, width, 1))
    if kind == TYPES.Regular:
        return regular(form, raw, width, height)
    if kind == TYPES.D24S8:  # OpenGL has stencil in the low bits
        return Texels("d24s8", words() >> 8 | (words() & 255) << 24 if gl else words())
    if kind == TYPES.D32S8 and len(raw) >= 8 * width * height:
        return Texels("d32fs8", np.frombuffer(raw, "<u8", width * height).reshape(height, width, 1))
    if kind in (TYPES.S8, TYPES.A8):
        return Texels("r8ui" if kind == TYPES.S8 else "r8", np.frombuffer(raw, "u1", width * height).reshape(height, width, 1))
    if kind == TYPES.R10G10B10A2 and form.compType == KINDS.UNorm:
        codes = words()
        swapped = (codes & 0xc00ffc00) | (codes & 0x3ff) << 20 | codes >> 20 & 0x3ff
        return Texels("rgb10a2", swapped if form.BGRAOrder() else codes)
    if kind == TYPES.R11G11B10:
        return Texels("r11g11b10f", words())
    return short(SHORT[kind], raw, width, height) if kind in SHORT else None


def hashes_of(rows: np.ndarray) -> list[bytes]:
    return [hashlib.sha256(row.data).digest() for row in np.ascontiguousarray(rows)]


def names_of(layers: list[list[bytes]]) -> tuple[str, str]:
    """Of files, made of the hashes of the rows: in this order, and with those of each layer in the opposite one."""
    orders = (b"".join(line for layer in layers for line in layer[::step]) for step in (1, -1))
    same, turned = (hashlib.sha256(order).hexdigest()[:24] + ".raw" for order in orders)
    return same, turned


# ---- Small pictures ------------------------------------------------------------------------------

# Of packed formats: first bit and bits of each channel.
PACKED = {"rgb10a2": ((0, 10), (10, 10), (20, 10), (30, 2)), "r11g11b10f": ((0, 11), (11, 11), (22, 10)), "d24": ((0, 24),),
          "d24s8": ((0, 24),)}


def values_of(name: str, rows: np.ndarray) -> np.ndarray:
    """Numbers as shaders see them, but for sRGB, which stays codes. Red comes first."""
    if name == "d32fs8":
        rows = rows.astype("<u8").view("<f4")[..., ::2]
    if name == "r11g11b10f":  # floats of 16 bits without a sign and the last bits
        return np.stack([(rows[..., 0] >> low << 15 - bits & 0x7fff).astype("<u2").view("<f2") for low, bits in PACKED[name]], -1)
    if name in PACKED:
        return np.stack([(rows[..., 0] >> low & (1 << bits) - 1) / np.float32((1 << bits) - 1) for low, bits in PACKED[name]], -1)
    if rows.dtype.kind == "f" or re.search(r"(ui|i)$", name):
        return rows
    numbers = np.maximum(rows / np.float32(np.iinfo(rows.dtype).max), np.float32(-1))
    return numbers[..., [2, 1, 0, *range(3, rows.shape[-1])]] if name.startswith("bgra") else numbers


def doubled_depth(name: str, raw: np.ndarray) -> np.ndarray:
    """2 z - 1 of every texel; bytes."""
    if name in ("d32f", "d32fs8"):
        words = raw.view("<f4").copy()
        words[::2 if name == "d32fs8" else 1] = 2 * words[::2 if name == "d32fs8" else 1] - 1
        return words.view("u1")
    codes, top = raw.view("<u2" if name == "d16" else "<u4"), (1 << (16 if name == "d16" else 24)) - 1
    depth = np.maximum(2 * (codes & top).astype("i8") - top, 0)
    return (codes & ~np.array(top, codes.dtype) | depth.astype(codes.dtype)).view("u1")


def four(name: str, rows: np.ndarray) -> np.ndarray:
    """Numbers as shaders see them, four of each texel."""
    numbers = values_of(name, rows)
    if name.endswith("_srgb"):
        light = np.where(numbers <= 0.04045, numbers / 12.92, ((numbers + 0.055) / 1.055) ** 2.4)
        numbers = np.concatenate([light[..., :3], numbers[..., 3:]], -1)
    whole = np.zeros((*numbers.shape[:2], 4), {"f": "<f4", "u": "<u4", "i": "<i4"}[numbers.dtype.kind])
    whole[..., 3] = 1
    whole[..., :numbers.shape[-1]] = numbers
    return whole


def bounds(size: int) -> np.ndarray:
    """Starts of at most MOST_SIDE parts, the same from both ends."""
    count = min(size, MOST_SIDE)
    ends = np.floor(np.arange(count + 1) * size / count + 0.5).astype(int)
    half = (count + 1) // 2
    ends[count - half + 1:] = size - ends[half - 1::-1][:half]
    return ends[:-1]


def small_picture(name: str, rows: np.ndarray) -> np.ndarray:
    """Means of parts of the picture, at most MOST_SIDE on a side: numbers of about 0 to 1; codes of small floats keep their order.
    Red comes first."""
    numbers = values_of(name, rows) if name in PACKED or name == "d32fs8" else rows
    height, width, count = numbers.shape
    above, left = ([*bounds(size), size] for size in (height, width))
    flat = numbers.reshape(height, width * count)
    lines = np.stack([flat[low:high].sum(0, dtype="f4") for low, high in zip(above, above[1:])]).reshape(-1, width, count)
    lengths = np.multiply.outer(np.diff(above), np.diff(left))[..., None]
    means = (np.add.reduceat(lines, left[:-1], 1) / lengths).astype("f4")
    if numbers.dtype.kind == "f" or re.search(r"(ui|i)$", name):
        return np.nan_to_num(means, posinf=0, neginf=0)
    means /= np.iinfo(rows.dtype).max
    return means[..., [2, 1, 0, *range(3, count)]] if name.startswith("bgra") else means
