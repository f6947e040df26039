"""`diptych metrics`: how far a picture, or each of several, is from its reference, as numbers, JSON and
error maps. The C program has looked at the options and hands the pictures over."""
from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np

from .console import Console, write
from .flip import (MOST_PIXELS_PER_DEGREE, PIXELS_PER_DEGREE, clamp, find_exposures, flip_hdr,
                   flip_ldr, luminance_of)
from .png import encode_png
from .stream import read_picture

# Names in JSON, in order, and titles in tables.
TITLES = {
    "relative_mse": "relative MSE",
    "smape": "SMAPE",
    "flip": "FLIP",
    "ratio": "mean / reference",
    "darker": "darker than 1/5",
    "brighter": "brighter than 5 times",
    "rmse": "RMSE",
    "psnr": "PSNR, dB",
    "mean_absolute": "mean absolute error",
    "mean_test": "mean",
    "mean_reference": "mean of the reference",
}
# of the values of a FLIP map
QUANTILES = {"median": 0.5, "p95": 0.95, "p99": 0.99, "max": 1.0}

Numbers = dict[str, float]

# ---- Measures ------------------------------------------------------------------------------------


def errors_of(reference: np.ndarray, test: np.ndarray) -> Numbers:
    """Over all three channels of all pixels that are finite in both; shares are of these pixels.

    ratio       of the means; NaN or infinite for a black reference
    darker      share of pixels whose luminance is below a fifth of the reference's
    brighter    share above five times; a pixel that is black in both counts in neither
    smape       mean of |test - reference| / (|test| + |reference| + 0.01), 0 to 1: the symmetric mean
                absolute percentage error of Vogels et al., SIGGRAPH 2018, with their constant. Half
                as bright weighs as much as twice as bright.
    relative_mse    mean of (test - reference)2 / (reference2 + 0.01): Rousselle, Knaus, Zwicker,
                SIGGRAPH Asia 2011, with the constant that makes black count; relative to the exposed
                image. A pixel that is too dark adds 1 at most.
    psnr        dB, for a peak of 1; infinite for equal images"""
    finite = np.isfinite(reference).all(axis=2) & np.isfinite(test).all(axis=2)
    right, given = (picture[finite].astype(np.float64) for picture in (reference, test))
    if not finite.any():
        right = given = np.zeros((1, 3))
    light, shown = luminance_of(right), luminance_of(given)
    apart = np.abs(given - right)
    square = float((apart**2).mean())
    means = float(given.mean()), float(right.mean())
    return {
        "relative_mse": float((apart**2 / (right**2 + 0.01)).mean()),
        "smape": float((apart / (np.abs(given) + np.abs(right) + 0.01)).mean()),
        "ratio": means[0] / means[1] if means[1] else math.inf * means[0],
        "darker": float((5 * shown < light).mean()),
        "brighter": float((shown > 5 * light).mean()),
        "rmse": math.sqrt(square),
        "psnr": -10 * math.log10(square) if square else math.inf,
        "mean_absolute": float(apart.mean()),
        "mean_test": means[0],
        "mean_reference": means[1],
        "not_finite": float(np.count_nonzero(~finite)),
    }


def distribution_of(values: np.ndarray) -> Numbers:
    quantiles = np.quantile(values.astype(np.float64), list(QUANTILES.values()))
    return {"mean": float(values.mean(dtype=np.float64)), **dict(zip(QUANTILES, map(float, quantiles)))}


def exposure_of(picture: np.ndarray) -> float:
    """The factor that takes the log-average luminance to 0.18, where pixels that are black or not
    finite do not count: Reinhard et al., SIGGRAPH 2002, equations 1 and 2. 1 for a black image."""
    light = luminance_of(picture)
    light = light[np.isfinite(light) & (light > 0)]
    return 0.18 / math.exp(np.log(light).mean()) if len(light) else 1.0


def tone_map(picture: np.ndarray) -> np.ndarray:
    """Reinhard et al., equation 4, on luminance, with white at 4, as the shipped pipelines do; 0..1,
    linear."""
    light = luminance_of(picture)[..., None]
    return clamp((1 + light / 16) / (1 + light) * picture).astype(np.float32)


def srgb_decode(code: np.ndarray) -> np.ndarray:
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055)**2.4)


def srgb_encode(light: np.ndarray) -> np.ndarray:
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light**(1 / 2.4) - 0.055)


def magma(errors: np.ndarray) -> np.ndarray:
    """Errors of 0..1 as colours of the magma map (Smith, van der Walt: black over purple and orange to
    pale yellow)."""
    stops = np.array([(0, 0, 4), (28, 16, 68), (79, 18, 123), (129, 37, 129), (181, 54, 122),
                      (229, 80, 100), (251, 135, 97), (254, 194, 135), (252, 253, 191)])
    at = 8 * clamp(errors)
    channels = [np.interp(at, np.arange(9), stops[:, channel]) for channel in range(3)]
    return (np.stack(channels, axis=-1) + 0.5).astype(np.uint8)


# ---- The run -------------------------------------------------------------------------------------


@dataclass
class Picture:
    """HDR metrics are of the image times the exposure, LDR metrics of the same after tone mapping."""
    exposed: np.ndarray
    mapped: np.ndarray


class Run:
    def __init__(self, console: Console, request: dict[str, Any]):
        self.console, self.request = console, request
        self.hdr: bool = request["hdr"]  # the files hold linear light, not 8-bit codes
        self.density: float = request.get("pixels_per_degree", PIXELS_PER_DEGREE)
        self.exposure: float = request.get("exposure", 0.0) if self.hdr else 1.0
        self.maps: dict[str, np.ndarray] = {}  # of the last picture

    def read(self, stream: BinaryIO, is_reference: bool) -> Picture:
        texels = read_picture(stream, self.console)[..., :3]
        if not self.hdr:
            light = srgb_decode(texels)
            return Picture(light, light)
        if is_reference and not self.exposure:
            self.exposure = exposure_of(texels)
        exposed = (self.exposure * texels.astype(np.float64)).astype(np.float32)
        return Picture(exposed, tone_map(exposed))

    def measure(self, reference: Picture, test: Picture) -> dict[str, Numbers]:
        """Numbers of the linear picture, of the tone-mapped one, and of either's FLIP; NaN where it is
        not measured."""
        found = {"hdr": errors_of(reference.exposed, test.exposed),
                 "ldr": errors_of(reference.mapped, test.mapped)}
        self.maps["ldr"] = flip_ldr(reference.mapped, test.mapped, self.density)
        if self.takes_hdr_flip():
            self.maps["hdr"] = flip_hdr(reference.exposed, test.exposed, self.density,
                                        self.exposures)
        for kind in ("hdr", "ldr"):
            values = self.maps.get(kind, np.full((1, 1), np.nan, np.float32))
            found[kind + "_flip"] = distribution_of(values)
            found[kind]["flip"] = found[kind + "_flip"]["mean"]
        return found

    def takes_hdr_flip(self) -> bool:
        """Takes ten times as long as everything else."""
        return self.hdr and self.request.get("flip") != "ldr"

    def measure_all(self, stream: BinaryIO) -> list[dict[str, Numbers]]:
        self.reference, found = self.read(stream, True), []
        height, width = self.reference.mapped.shape[:2]
        if self.takes_hdr_flip():
            self.exposures = find_exposures(self.reference.exposed)
        for path in self.request["pictures"]:
            self.test = self.read(stream, False)
            own_height, own_width = self.test.mapped.shape[:2]
            if (own_width, own_height) != (width, height):
                self.console.fail(f"{self.request['reference']} has {width}x{height} pixels and {path} "
                                  f"has {own_width}x{own_height}; render both at one --size")
            found.append(self.measure(self.reference, self.test))
        return found

    def write_maps(self) -> None:
        folder = self.request["output"]
        os.makedirs(folder, exist_ok=True)
        pictures = {f"flip_{kind}": magma(errors) for kind, errors in self.maps.items()}
        for name, picture in (("reference", self.reference), ("test", self.test)):
            codes = 255 * clamp(srgb_encode(picture.mapped)) + 0.5
            pictures[name] = codes.astype(np.uint8)
        for name, codes in pictures.items():
            write(os.path.join(folder, f"{name}.png"), encode_png(codes))


def average(found: list[dict[str, Numbers]]) -> tuple[dict[str, Numbers], dict[str, Numbers]]:
    """Means over the pictures and, of two and more, the standard errors of these means."""
    means: dict[str, Numbers] = {}
    errors: dict[str, Numbers] = {}
    for kind, numbers in found[0].items():
        for name in numbers:
            values = np.array([one[kind][name] for one in found])
            spread = values.std(ddof=1) / math.sqrt(len(values)) if len(values) > 1 else 0.0
            means.setdefault(kind, {})[name] = float(values.mean())
            errors.setdefault(kind, {})[name] = float(spread)
    return means, errors


# ---- Output --------------------------------------------------------------------------------------


def plain(value: float) -> float | None:
    """null for what is not finite: the PSNR of equal images."""
    return value if math.isfinite(value) else None


def kind_json(numbers: dict[str, Numbers], kind: str) -> dict[str, Any]:
    flip = numbers[kind + "_flip"]
    root: dict[str, Any] = {name: plain(numbers[kind][name]) for name in [*TITLES, "not_finite"]}
    if root["flip"] is not None:
        root["flip"] = dict(flip)
    return root


def all_json(run: Run, means: dict[str, Numbers], errors: dict[str, Numbers]) -> dict[str, Any]:
    request = run.request
    height, width = run.reference.mapped.shape[:2]

    def both(numbers: dict[str, Numbers]) -> dict[str, Any]:
        return {"ldr": kind_json(numbers, "ldr"),
                "hdr": kind_json(numbers, "hdr") if run.hdr else None}

    root = {"reference": request["reference"], "test": request["test"],
            "pictures": len(request["pictures"]), "width": width, "height": height,
            "exposure": run.exposure, "pixels_per_degree": run.density, **both(means)}
    if run.takes_hdr_flip():
        names = ("start_exposure", "stop_exposure", "exposures")
        root["hdr"]["flip"].update(zip(names, run.exposures))
    if root["pictures"] > 1:
        root["standard_errors"] = both(errors)
    return root


def print_all(run: Run, means: dict[str, Numbers], errors: dict[str, Numbers]) -> None:
    height, width = run.reference.mapped.shape[:2]
    count = len(run.request["pictures"])
    print(f"{width}x{height} pixels, exposure {run.exposure:.6g}, {run.density:.4g} pixels per degree")
    if count > 1:
        print(f"{count} pictures: mean and its standard error")
    linear = f"  {'linear':>11}" + " " * (11 if count > 1 else 0) if run.hdr else ""
    print(f"\n{'':24}{linear}  {'tone-mapped':>11}")
    rows = [(title, "", name) for name, title in TITLES.items()]
    rows += [("FLIP, 95th percentile", "_flip", "p95"), ("FLIP, largest", "_flip", "max")]
    for title, part, name in rows:
        line = f"{title:24}"
        for kind in ("hdr", "ldr") if run.hdr else ("ldr",):
            mean, error = means[kind + part][name], errors[kind + part][name]
            line += f"  {'-' if math.isnan(mean) else f'{mean:.5f}':>11}"
            if count > 1:
                line += f" ± {error:<8.2g}" if math.isfinite(error) else " " * 11
        print(line)
    if means["hdr"]["not_finite"] > 0:
        print(f"left out: {means['hdr']['not_finite']:.6g} pixels that are NaN or Inf")


def main(console: Console, request: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    np.seterr(all="ignore")  # pixels may be NaN or Inf, references black
    run = Run(console, request)
    if not 1 <= run.density <= MOST_PIXELS_PER_DEGREE:
        console.fail(f"--pixels-per-degree: must be from 1 to {MOST_PIXELS_PER_DEGREE:g}")
    with open(request["stream"], "rb") as stream:
        found = run.measure_all(stream)
    if "output" in request:
        run.write_maps()
    means, errors = average(found)
    print_all(run, means, errors)
    return 0, all_json(run, means, errors)
