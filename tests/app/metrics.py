"""For measures_test.sh: image metrics against closed forms, published colours, and a second FLIP that is
written from the papers in another way: every filter as one two-dimensional sum, all in double
precision."""
from math import ceil, exp, hypot, inf, isnan, log2, log10, nan, pi, sqrt

import numpy as np

from diptych import flip, metrics

WIDTH, HEIGHT = 29, 23
DENSITY = flip.PIXELS_PER_DEGREE


def near(got, right, most):
    assert np.all(np.abs(np.asarray(got, float) - right) <= most), (got, right)


def filled(*rgb):
    return np.full((HEIGHT, WIDTH, 3), rgb, np.float32)


def noise():
    random = np.random.default_rng(7)
    reference = random.random((HEIGHT, WIDTH, 3), np.float32)
    test = reference + 0.3 * (random.random((HEIGHT, WIDTH, 3), np.float32) - 0.5)
    return reference, np.clip(test, 0, 1)


# ---- FLIP, written a second time ---------------------------------------------------------------

# The paper's transforms with the usual rounded constants of sRGB and D65.
WHITE = np.array([0.95047, 1, 1.08883])
TO_XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
                   [0.0193339, 0.1191920, 0.9503041]])
TO_RGB = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                   [0.0556434, -0.2040259, 1.0572252]])


def to_hunt_lab(rgb):
    t = rgb @ TO_XYZ.T / WHITE
    x, y, z = np.moveaxis(np.where(t > 0.008856451679, t ** (1 / 3), 7.787037037 * t + 16 / 116), -1, 0)
    light = 116 * y - 16
    return np.stack([light, 5 * (x - y) * light, 2 * (y - z) * light], axis=-1)


def distance(a, b):
    apart = a - b
    return np.abs(apart[..., 0]) + np.hypot(apart[..., 1], apart[..., 2])


def ycxcz(picture):
    x, y, z = np.moveaxis(picture.astype(float) @ TO_XYZ.T / WHITE, -1, 0)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def sum_of(plane, weight, radius):
    """The sum of weight(dx, dy) times the neighbours, and that of the positive and negative weights."""
    height, width = plane.shape
    padded = np.pad(plane, radius, "edge")
    total, sides = [0.0, 0.0], [0.0, 0.0]
    for dy in range(-radius, radius + 1):
        for dx in range(-radius, radius + 1):
            w = weight(dx, dy)
            part = padded[radius + dy:radius + dy + height, radius + dx:radius + dx + width]
            total[w < 0] = total[w < 0] + w * part
            sides[w < 0] += abs(w)
    return total, sides


def filtered(picture, density):
    def gauss(a, b):
        return lambda x, y: a * sqrt(pi / b) * exp(-pi * pi * (x * x + y * y) / density**2 / b)

    blue = gauss(34.1, 0.04), gauss(13.5, 0.025)
    weights = (gauss(1, 0.0047), gauss(1, 0.0053), lambda x, y: blue[0](x, y) + blue[1](x, y))
    radius = ceil(3 * sqrt(0.04 / (2 * pi * pi)) * density)
    color = []
    for plane, weight in zip(ycxcz(picture), weights):
        total, sides = sum_of(plane, weight, radius)
        color.append(total[0] / sides[0])
    y = (color[0] + 16) / 116
    xyz = np.stack([y + color[1] / 500, y, y - color[2] / 200], axis=-1)
    return to_hunt_lab(np.clip((xyz * WHITE) @ TO_RGB.T, 0, 1))


def strength(picture, density, order):
    """The length of the responses to edges (1) or points (2) along x and y."""
    sd = 0.5 * 0.082 * density
    light = (ycxcz(picture)[0] + 16) / 116
    responses = []
    for axis in range(2):
        def weight(x, y):
            along = (x, y)[axis]
            shape = -along if order == 1 else along * along / (sd * sd) - 1
            return exp(-(x * x + y * y) / (2 * sd * sd)) * shape

        total, sides = sum_of(light, weight, ceil(3 * sd))
        responses.append(total[0] / sides[0] + total[1] / sides[1])
    return np.hypot(*responses)


def remap(apart):
    most = distance(*to_hunt_lab(np.array([[0.0, 1, 0], [0, 0, 1]])))**0.7
    value = apart**0.7
    return np.where(value < 0.4 * most, 0.95 / (0.4 * most) * value,
                    0.95 + (value - 0.4 * most) / (0.6 * most) * 0.05)


def test_flip_equals_its_two_dimensional_form():
    reference, test = noise()
    for density in (12, 31.5):
        feature = [np.abs(strength(reference, density, order) - strength(test, density, order))
                   for order in (1, 2)]
        color = remap(distance(filtered(reference, density), filtered(test, density)))
        expected = color**(1 - np.sqrt(np.maximum(*feature) / sqrt(2)))
        assert expected.max() > 0.2  # there was something to see
        # rounded constants here, single precision there
        near(flip.flip_ldr(reference, test, density), expected, 2e-4)


# ---- FLIP in closed form -----------------------------------------------------------------------

# L*a*b* of sRGB's primaries as published for D65 (Lindbloom).
LAB_GREEN, LAB_BLUE = (87.7347, -86.1827, 83.1793), (32.2970, 79.1875, -107.8602)


def largest_distance():
    green, blue = ((light, a * light / 100, b * light / 100) for light, a, b in (LAB_GREEN, LAB_BLUE))
    return abs(green[0] - blue[0]) + hypot(green[1] - blue[1], green[2] - blue[2])


def test_flip_of_plain_colours():
    near(flip.flip_ldr(filled(0, 1, 0), filled(0, 0, 1), DENSITY), 1, 1e-4)
    # Black and white differ in lightness alone, by 100.
    most, value = largest_distance()**0.7, 100**0.7
    black = filled(0, 0, 0)
    near(flip.flip_ldr(black, filled(1, 1, 1), DENSITY),
         0.95 + (value - 0.4 * most) / (0.6 * most) * 0.05, 1e-4)
    grey = 49.496**0.7  # L* of 18 % grey; of black, 0. Below the knee.
    assert grey < 0.4 * most
    near(flip.flip_ldr(black, filled(0.18, 0.18, 0.18), DENSITY), 0.95 * grey / (0.4 * most), 1e-4)


def test_flip_of_equal_images_is_zero_and_it_is_symmetric():
    reference, test = noise()
    assert not flip.flip_ldr(reference, reference, DENSITY).any()
    assert not flip.flip_hdr(test, test, DENSITY, flip.find_exposures(test)).any()
    assert np.array_equal(flip.flip_ldr(reference, test, DENSITY), flip.flip_ldr(test, reference, DENSITY))


def nearly_white():
    """The x where the ACES fit reaches 0.85, by bisection. The fit is (2.51 s2 + 0.03 s) / (2.43 s2 +
    0.59 s + 0.14) with s = 0.6 x."""
    low, high = 0.0, 100.0
    for _ in range(200):
        x = 0.5 * (low + high)
        s = 0.6 * x
        if s * (2.51 * s + 0.03) / (s * (2.43 * s + 0.59) + 0.14) < 0.85:
            low = x
        else:
            high = x
    return low


def test_hdr_exposures_span_median_to_brightest():
    reference = filled(0.25, 0.25, 0.25)
    reference[0, 0] = 10  # one bright pixel
    start, stop, count = flip.find_exposures(reference)
    near(start, log2(nearly_white() / 10), 1e-5)
    near(stop, log2(nearly_white() / 0.25), 1e-5)
    assert count == 6  # ceil(log2(40))
    assert flip.find_exposures(filled(0, 0, 0)) == (0, 0, 1)


def test_hdr_sees_into_the_dark():
    """HDR FLIP finds a difference that only a long exposure shows. Light that no screen could show does
    not make the result NaN."""
    reference, test = filled(0.001, 0.001, 0.001), filled(0.002, 0.002, 0.002)
    reference[0, 0] = test[0, 0] = 1e4
    dark = flip.flip_ldr(reference, test, DENSITY)[-1, -1]
    errors = flip.flip_hdr(reference, test, DENSITY, flip.find_exposures(reference))
    assert errors[-1, -1] > 3 * dark and np.all((errors >= 0) & (errors <= 1))


# ---- The other metrics -------------------------------------------------------------------------


def test_errors_of_two_constants():
    reference, test = filled(0.5, 0.5, 0.5), filled(0.6, 0.4, 0.5)
    right = {"mean_absolute": 0.2 / 3, "rmse": sqrt(0.02 / 3), "relative_mse": 0.02 / 3 / (0.25 + 0.01),
             "psnr": 10 * log10(3 / 0.02), "mean_test": 0.5, "not_finite": 0}
    errors = metrics.errors_of(reference, test)
    for name, value in right.items():
        near(errors[name], value, 1e-4 if name == "psnr" else 1e-7)
    test[0, 1, 1], reference[0, 3, 0] = nan, inf
    errors = metrics.errors_of(reference, test)
    assert errors["not_finite"] == 2
    near(errors["mean_absolute"], 0.2 / 3, 1e-7)
    errors = metrics.errors_of(test, test)
    assert errors["rmse"] == 0 and errors["psnr"] == inf


def test_darkness_shows():
    """Worked out by hand, pixel by pixel. A pixel that is NaN or Inf in either picture counts in
    not_finite alone."""
    right = [(1, 1, 1), (0, 0, 0), (0, 0, 0), (2, 2, 2), (0, 1, 0), (1, 0, 0), (1, nan, 1), (1, 1, 1)]
    given = [(.125,) * 3, (0, 0, 0), (.0625,) * 3, (16,) * 3, (0, 0, 1), (0, 0, 1), (0, 0, 0), (0, inf, 0)]
    reference, test = (np.array([row], np.float32) for row in (right, given))
    errors = metrics.errors_of(reference, test)
    assert errors["not_finite"] == 2
    # darker: an eighth, and green that became blue, 0.7152 to 0.0722; not red that became blue, a third
    near(errors["darker"], 2 / 6, 1e-12)
    near(errors["brighter"], 2 / 6, 1e-12)  # black that is lit, and eight times
    near(errors["ratio"], (3 * 16.1875 + 2) / (3 * 3 + 2), 1e-12)
    near(errors["smape"], (3 * (.875 / 1.135 + .0625 / .0725 + 14 / 18.01) + 4 / 1.01) / 18, 1e-12)
    swapped = metrics.errors_of(test, reference)
    near(swapped["smape"], errors["smape"], 1e-15)
    near(swapped["ratio"] * errors["ratio"], 1, 1e-12)
    assert swapped["darker"] == errors["brighter"] and swapped["brighter"] == errors["darker"]


def test_too_dark_counts_as_too_bright():
    """One picture is 6.25 times too dark, the other 6.25 times too bright. For relative MSE, the first
    error is less than a twentieth of the second. The symmetric error is the same for both."""
    reference = filled(100, 100, 100)
    dark = metrics.errors_of(reference, filled(16, 16, 16))
    bright = metrics.errors_of(reference, filled(625, 625, 625))
    near(dark["smape"], bright["smape"], 1e-3)
    assert dark["relative_mse"] < 1 and bright["relative_mse"] > 20 * dark["relative_mse"]
    shares = [errors[name] for errors in (dark, bright) for name in ("darker", "brighter")]
    assert shares == [1, 0, 0, 1]


def test_a_black_reference_has_no_ratio():
    black, no_number = filled(0, 0, 0), filled(nan, 0, 0)
    errors = metrics.errors_of(black, black)
    assert isnan(errors["ratio"])
    assert errors["smape"] == errors["darker"] == errors["brighter"] == 0
    errors = metrics.errors_of(black, no_number)
    assert errors["not_finite"] == WIDTH * HEIGHT and errors["smape"] == errors["relative_mse"] == 0


def test_distributions():
    values = np.array([[(i * 37) % 100 + 1 for i in range(100)]], np.float32)  # 1 to 100
    right = {"mean": 50.5, "median": 50.5, "p95": 95.05, "p99": 99.01, "max": 100}
    found = metrics.distribution_of(values)
    assert list(found) == list(right)
    near(list(found.values()), list(right.values()), 1e-5)


def test_tone_mapping_follows_reinhard():
    picture = filled(2, 2, 2)
    picture[0, 1] = 0  # black does not count
    near(metrics.exposure_of(picture), 0.09, 1e-6)
    mapped = metrics.tone_map(0.5 * picture)
    near(mapped[0, 0], (1 + 1 / 16) / 2, 1e-6)
    assert not mapped[0, 1].any()
    near(metrics.tone_map(2 * picture)[0, 0], 1, 1e-6)  # 4 is white
    assert metrics.exposure_of(filled(0, 0, 0)) == 1


def test_magma_is_black_to_pale_and_grows_lighter():
    rgb = metrics.magma(np.array([*np.linspace(0, 1, 101), nan], np.float32))
    light = rgb[:-1] @ (0.2126, 0.7152, 0.0722)
    assert np.all(np.diff(light) > 0)
    assert rgb[-2].tolist() == [252, 253, 191] and rgb[-1].tolist() == [0, 0, 4]
