"""FLIP: how different two images look when one flips between them, per pixel.

Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: FLIP: A Difference Evaluator for
Alternating Images, High Performance Graphics 2020 (LDR); Andersson, Nilsson, Shirley,
Akenine-Moller: Visualizing Errors in Rendered High Dynamic Range Images, Eurographics 2021 (HDR).
Names and constants are the papers'.

Pictures are arrays of (height, width, 3), linear RGB (Rec. 709), float32. All filters are sums of
Gaussians or their derivatives, so they run along rows, then along columns; beyond its border an
image repeats its last pixel."""
from __future__ import annotations

from math import ceil, exp2, log2, pi, sqrt

import numpy as np

Planes = list[np.ndarray]  # of one color: three of (height, width)

# Of a 0.7 m wide monitor with 3840 pixels seen from 0.7 m, the papers' default.
PIXELS_PER_DEGREE = 67.02064327658226
MOST_PIXELS_PER_DEGREE = 4096.0

# ---- Colour --------------------------------------------------------------------------------------

# Linear Rec. 709 to CIE XYZ, exact for primaries and white point D65 as given by sRGB; relative to the
# white point, which is what (1, 1, 1) maps to.
XYZ = np.array([[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
                [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
                [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]])
XYZ /= XYZ.sum(axis=1, keepdims=True)


def mix(matrix: np.ndarray, planes: Planes) -> Planes:
    return [float(a) * planes[0] + float(b) * planes[1] + float(c) * planes[2] for a, b, c in matrix]


def ycxcz_of(rgb: Planes) -> Planes:
    """The opponent space of the filters: luminance, red-green, blue-yellow, all linear."""
    x, y, z = mix(XYZ, rgb)
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)]


def rgb_of_ycxcz(color: Planes) -> Planes:
    y = (color[0] + 16) / 116
    return mix(np.linalg.inv(XYZ), [y + color[1] / 500, y, y - color[2] / 200])


def lab_curve(value: np.ndarray) -> np.ndarray:
    delta = 6 / 29
    return np.where(value > delta**3, np.cbrt(value), value / (3 * delta**2) + 4 / 29)


def hunt_lab_of(rgb: Planes) -> Planes:
    """L*a*b* with the chroma scaled by lightness: dark colours look less colourful (Hunt)."""
    x, y, z = (lab_curve(plane) for plane in mix(XYZ, rgb))
    lightness = 116 * y - 16
    return [lightness, 5 * lightness * (x - y), 2 * lightness * (y - z)]


def hyab(a: Planes, b: Planes) -> np.ndarray:
    return np.abs(a[0] - b[0]) + np.hypot(a[1] - b[1], a[2] - b[2])


def clamp(plane: np.ndarray) -> np.ndarray:
    return np.fmin(np.fmax(plane, 0), 1)  # NaN counts as 0


# ---- Filters -------------------------------------------------------------------------------------


def gauss(radius: int, variance: float) -> np.ndarray:
    x = np.arange(-radius, radius + 1)
    return np.exp(-x * x / (2 * variance))


def derivative(radius: int, variance: float, order: int) -> np.ndarray:
    """First or second derivative of a Gaussian; positive weights sum to 1, negative ones to -1."""
    x = np.arange(-radius, radius + 1)
    kernel = (-x if order == 1 else x * x / variance - 1) * gauss(radius, variance)
    positive, negative = kernel[kernel > 0].sum(), -kernel[kernel < 0].sum()
    return kernel / np.where(kernel < 0, negative, positive)


def convolve(plane: np.ndarray, kernel: np.ndarray, axis: int) -> np.ndarray:
    """Along an axis, in blocks of rows, which stay in the cache."""
    radius, rows = len(kernel) // 2, 32
    out = np.empty_like(plane)
    beyond = ((radius, radius), (0, 0))
    padded = np.pad(plane, beyond if axis == 0 else beyond[::-1], "edge")
    for top in range(0, len(plane), rows):
        sums = out[top:top + rows]
        height, width = sums.shape
        term = np.empty_like(sums)
        sums[:] = 0
        for i, weight in enumerate(map(float, kernel)):
            y, x = (top + i, 0) if axis == 0 else (top, i)
            sums += np.multiply(padded[y:y + height, x:x + width], weight, out=term)
    return out


def convolve_both(plane: np.ndarray, along_rows: np.ndarray, along_columns: np.ndarray) -> np.ndarray:
    return convolve(convolve(plane, along_rows, 1), along_columns, 0)


# Contrast sensitivity in the frequency domain is a sum of exponentials with parameters a and b; in the
# spatial domain, Gaussians of variance b / (2 pi^2) degrees squared.
LUMINANCE, RED_GREEN, BLUE_YELLOW = [(1.0, 0.0047)], [(1.0, 0.0053)], [(34.1, 0.04), (13.5, 0.025)]
WIDEST = 0.04


def filter_sensitivity(plane: np.ndarray, sensitivity: list[tuple[float, float]],
                       density: float) -> np.ndarray:
    """The weights of the sum are those of the two-dimensional, truncated Gaussians, since the whole
    filter sums to 1."""
    radius = ceil(3 * sqrt(WIDEST / (2 * pi**2)) * density)
    kernels = [gauss(radius, b / (2 * pi**2) * density**2) for _, b in sensitivity]
    weights = [a * sqrt(pi / b) * kernel.sum()**2 for (a, b), kernel in zip(sensitivity, kernels)]
    out = np.zeros_like(plane)
    for weight, kernel in zip(weights, kernels):
        kernel /= kernel.sum()
        out += float(weight / sum(weights)) * convolve_both(plane, kernel, kernel)
    return out


# ---- The two halves of the metric ----------------------------------------------------------------


def detect(luminance: np.ndarray, density: float) -> Planes:
    """Strength of edges (first derivative) and points (second): length of the response along both
    axes. The detector's width is 0.082 degrees from peak to trough."""
    deviation = 0.5 * 0.082 * density
    radius, found = ceil(3 * deviation), []
    smooth = gauss(radius, deviation**2)
    smooth /= smooth.sum()
    for order in (1, 2):
        sharp = derivative(radius, deviation**2, order)
        found.append(np.hypot(convolve_both(luminance, sharp, smooth),
                              convolve_both(luminance, smooth, sharp)))
    return [strength / 116 for strength in found]  # of (Y + 16) / 116, which is linear in light


def color_error(distance: np.ndarray) -> np.ndarray:
    """Distances up to p_c of the largest one, that of green and blue, take up p_t of the range."""
    exponent, p_c, p_t = 0.7, 0.4, 0.95
    green, blue = (hunt_lab_of([np.array(c) for c in rgb]) for rgb in ((0., 1., 0.), (0., 0., 1.)))
    most = float(hyab(green, blue)**exponent)
    error, knee = distance**exponent, p_c * most
    return np.where(error < knee, p_t / knee * error,
                    p_t + (error - knee) / (most - knee) * (1 - p_t))


def flip_ldr(reference: np.ndarray, test: np.ndarray, density: float) -> np.ndarray:
    """Values of 0 to 1 per pixel. Values of the images outside 0..1 are clamped. density: pixels per
    degree, 1 to MOST_PIXELS_PER_DEGREE."""
    colors, features = [], []
    for picture in (reference, test):
        planes = ycxcz_of([clamp(picture[..., channel]) for channel in range(3)])
        features.append(detect(planes[0], density))
        seen = [filter_sensitivity(plane, sensitivity, density)
                for plane, sensitivity in zip(planes, (LUMINANCE, RED_GREEN, BLUE_YELLOW))]
        colors.append(hunt_lab_of([clamp(plane) for plane in rgb_of_ycxcz(seen)]))
    edges, points = (np.abs(a - b) for a, b in zip(*features))
    exponent = 1 - np.sqrt(sqrt(0.5) * np.maximum(edges, points))  # q_f = 0.5
    return color_error(hyab(*colors))**exponent


# ---- High dynamic range --------------------------------------------------------------------------

# Narkowicz's fit of the ACES curve, with its pre-exposure of 0.6 folded in:
# (k0 x2 + k1 x) / (k2 x2 + k3 x + k4).
ACES = (0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14)


def aces_curve(x: np.ndarray) -> np.ndarray:
    x = np.fmin(np.fmax(x, 0), 1e6)  # from there on it is 1
    return clamp((ACES[0] * x + ACES[1]) * x / ((ACES[2] * x + ACES[3]) * x + ACES[4]))


def aces_inverse(y: float) -> float:
    a, b, c = ACES[0] - ACES[2] * y, ACES[1] - ACES[3] * y, -ACES[4] * y
    return (-b + sqrt(b * b - 4 * a * c)) / (2 * a)


def luminance_of(picture: np.ndarray) -> np.ndarray:
    return picture.astype(np.float64) @ (0.2126, 0.7152, 0.0722)


def find_exposures(reference: np.ndarray) -> tuple[float, float, int]:
    """First, last and number of the exposures, in stops, that the HDR version looks at: from where the
    brightest pixel of the reference is nearly white to where its median is."""
    luminance = luminance_of(reference)
    luminance[~(np.isfinite(luminance) & (luminance > 0))] = 0
    brightest = float(luminance.max())
    if brightest == 0:
        return 0.0, 0.0, 1
    nearly_white = aces_inverse(0.85)
    median = max(float(np.median(luminance)), brightest * 2**-24)  # mostly black images
    start, stop = log2(nearly_white / brightest), log2(nearly_white / median)
    return start, stop, max(ceil(stop - start), 2)


def flip_hdr(reference: np.ndarray, test: np.ndarray, density: float,
             exposures: tuple[float, float, int]) -> np.ndarray:
    """The largest LDR error over all exposures under the ACES curve. Negative values count as
    black."""
    errors = np.zeros(reference.shape[:2], np.float32)
    for stops in np.linspace(*exposures):
        scale = exp2(stops)
        left, right = (aces_curve(scale * picture) for picture in (reference, test))
        errors = np.maximum(errors, flip_ldr(left, right, density))
    return errors
