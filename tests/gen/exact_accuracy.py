"""Results of tests/specs/exact.yaml and arithmetic.yaml against double and long double precision. The same bits on both backends are
not enough, since a replacement could be wrong in both. templates/glsl/exact.glsl states the bounds of the replaced functions, or its
order of operations implies them, in units U of rounding. Prints TAP; called by exact_accuracy_test.sh."""
import functools
import os
import sys

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/app/python", ROOT + "/tests/gen"]
import bodies  # noqa: E402: from the paths above
import diptych  # noqa: E402

U = 2.0**-24
SPECIAL = 256  # cases before are pairs of special values
LEAST, MOST = 2.0**-126, float(np.finfo("f4").max)


@functools.cache
def results(backend):
    with diptych.open(ROOT + "/tests/specs/exact.yaml", backend, size=(9, 5), scene=ROOT + "/scenes/cornell.yaml") as pipeline:
        return pipeline.render("inputs", "geometry", "angles", "products", "row_products", "elementary")


def cases(backend, name):
    """Vectors a, b and s of each case in double precision, and what a pass made of them."""
    left = results(backend)
    return *(left["inputs"][key][SPECIAL:].astype(float) for key in "abs"), left[name][SPECIAL:]


def ulp(x):
    """Distance of neighbouring floats at x."""
    x = np.maximum(np.abs(x).astype("f4"), np.float32(LEAST))
    return np.nextafter(x, np.float32(np.inf)).astype(float) - x


def expect(what, value, expected, bound):
    value, expected, bound = np.broadcast_arrays(value, expected, bound)
    wrong = np.argwhere(~(np.abs(value - expected) <= bound))
    if len(wrong):
        place = tuple(wrong[0])
        raise AssertionError(f"{what} of case {place}: {value[place]:.9g}, expected {expected[place]:.9g} within {bound[place]:.3g}")


def expect_ulp(what, value, expected, ulps):
    expect(what, value, expected, ulps * ulp(expected))


def expect_sum(what, value, x, y):
    """The sum of the products of x and y along the last axis."""
    products = x * y
    expect(what, value, products.sum(-1), products.shape[-1] * U * 1.01 * np.abs(products).sum(-1))


def dot(x, y):
    return (x * y).sum(-1, keepdims=True)


def test_lengths_are_exact_to_rounding(backend):
    a, b, _, found = cases(backend, "geometry")
    for n in range(1, 5):
        expect_sum(f"dot of {n}", found["dots"][:, n - 1], a[:, :n], b[:, :n])
        expect_ulp(f"length of {n}", found["lengths"][:, n - 1], np.linalg.norm(a[:, :n], axis=1), 3)
        expect_ulp(f"distance of {n}", found["distances"][:, n - 1], np.linalg.norm((a - b)[:, :n], axis=1), 4)


def test_vectors_are_exact_to_rounding(backend):
    a, b, s, found = cases(backend, "geometry")
    expect_ulp("normalize", found["unit"], a / np.sqrt(dot(a, a)), 6)
    for name, t in ("mixed", s), ("mixed_evenly", s[:, :1]):
        expect(name, found[name], a * (1 - t) + b * t, 4 * U * (np.abs(a * (1 - t)) + np.abs(b * t)))
    expect("reflect", found["mirrored"], a - 2 * dot(s, a) * s, 8 * U * (np.abs(a) + 2 * dot(np.abs(s), np.abs(a)) * np.abs(s)))
    side = dot(s, b)
    sure = (np.abs(side) > 8 * U * dot(np.abs(s), np.abs(b)))[:, 0]
    expect("faceforward", found["forward"][sure], np.where(side < 0, a, -a)[sure], 0)
    p, q = a[:, [1, 2, 0]] * b[:, [2, 0, 1]], a[:, [2, 0, 1]] * b[:, [1, 2, 0]]
    expect("cross", found["crossed"], p - q, 4 * U * (np.abs(p) + np.abs(q)))


def test_refraction_follows_snell(backend):
    """The components along the surface scale by eta, and the direction stays unit."""
    a, b, s, found = cases(backend, "geometry")
    incident, normal, eta = a / np.sqrt(dot(a, a)), b / np.sqrt(dot(b, b)), 0.75 + 0.25 * s[:, :1]
    cosine = dot(incident, normal)
    k = 1 - eta * eta * (1 - cosine * cosine)
    bent = np.where(k < 0, 0, eta * incident - (eta * cosine + np.sqrt(np.maximum(k, 0))) * normal)
    judged = (np.abs(k) >= 0.01)[:, 0]  # the root has no bound near zero
    expect("refract", found["bent"][judged], bent[judged], np.where(k < 0, 0, 64 * U)[judged])


def test_angles_are_within_four_units(backend):
    a, b, s, found = cases(backend, "angles")
    for name, expected in (("arc_sine", np.arcsin(s)), ("arc_cosine", np.arccos(s)), ("arc_tangent", np.arctan(a)),
                           ("arc_tangent2", np.arctan2(a, b))):
        expect_ulp(name, found[name], expected, 4)


def test_angles_of_special_values(backend):
    """At 0, 1, -1 and infinity arc functions have a value of their own, quadrant by quadrant. -0 counts as 0."""
    left = results(backend)
    y, x, z = (left["inputs"][key][:SPECIAL].astype(float) for key in "abs")
    found = left["angles"][:SPECIAL]
    expect("asin", found["arc_sine"], np.arcsin(z), 4 * U)
    expect("acos", found["arc_cosine"], np.arccos(z), 8 * U)
    expect("atan", found["arc_tangent"], np.arctan(y), 4 * U)
    judged = np.isin(np.abs(y), (0, 1)) & np.isin(np.abs(x), (0, 1))
    expect("atan2", found["arc_tangent2"][judged], np.arctan2(y + 0.0, x + 0.0)[judged], 8 * U)
    if judged.sum() <= 16:
        raise AssertionError(f"{judged.sum()} angles")


def test_products_are_exact_to_rounding(backend):
    a, b, s, found = cases(backend, "products")
    columns = np.stack((a, b, s, a[:, ::-1]), 1)  # of the matrix that the passes make
    rows = columns.transpose(0, 2, 1)
    for name, height, width in ("mat4_vec", 4, 4), ("mat4x3_vec", 3, 4), ("mat3_vec", 3, 3), ("mat2_vec", 2, 2):
        expect_sum(name, found[name], rows[:, :height, :width], s[:, None, :width])
    found = results(backend)["row_products"][SPECIAL:]
    for name, count, height in ("vec_mat4", 4, 4), ("vec_mat4x3", 4, 3), ("vec_mat3", 3, 3), ("vec_mat2", 2, 2):
        expect_sum(name, found[name], columns[:, :count, :height], s[:, None, :height])
    other = np.stack((s[:, [1, 2, 3, 0]], b[:, [2, 3, 0, 1]], a[:, [1, 0, 3, 2]], s), 1)
    expect_sum("mat4_mat4", found["mat4_mat4"].reshape(-1, 4, 4), rows[:, None, :, :], other[:, :, None, :])


def test_steps_are_exact_to_rounding(backend):
    a, b, s, found = cases(backend, "elementary")
    steps, x, y = found["steps"], a[:, 0], b[:, 0]
    whole = y * np.floor(x / y)
    sure = np.abs(x / y - np.round(x / y)) > 3 * ulp(x / y)  # else floor may fall either way
    expect("mod", steps[sure, 0], (x - whole)[sure], (2 * U * (np.abs(x) + np.abs(whole)))[sure])
    expect("fract", steps[:, 1], a[:, 1] - np.floor(a[:, 1]), U)
    for k, low, high in (0, -0.75, 0.5), (1, -1, 2):
        t = np.clip((s[:, k] - low) / (high - low), 0, 1)
        expect("smoothstep", steps[:, 2 + k], t * t * (3 - 2 * t), 16 * U)


FUNCTIONS = (  # fields of the result and of the arguments; the function; error in units in the last place
    ("quotient", "x y", np.divide, 2), ("quotient_whole", "x", lambda x: x / -100, 0.5),
    ("quotient_part", "x", lambda x: x / 0.375, 0.5), ("sqrt", "x", np.sqrt, 2), ("inversesqrt", "x", lambda x: 1 / np.sqrt(x), 2),
    ("sin", "angle", np.sin, 4), ("cos", "angle", np.cos, 4), ("tan", "angle", np.tan, 4), ("asin", "unit", np.arcsin, 4),
    ("acos", "unit", np.arccos, 4), ("atan", "x", np.arctan, 4), ("atan2", "angle unit", np.arctan2, 4), ("exp", "exponent", np.exp, 4),
    ("exp2", "exponent", np.exp2, 4), ("log", "x", np.log, 4), ("log2", "x", np.log2, 4),
    ("pow", "x unit", lambda x, y: np.abs(x) ** y, 2), ("sinh", "exponent", np.sinh, 4), ("cosh", "exponent", np.cosh, 4),
    ("tanh", "exponent", np.tanh, 4), ("asinh", "x", np.arcsinh, 4), ("acosh", "above_one", np.arccosh, 4),
    ("atanh", "unit", np.arctanh, 4),
    # templates/shared/estimate.glsl: 3e-6, 2e-7 and 2e-5, relative
    ("reciprocal", "above_one", lambda x: 1 / x, 3e-6 / U), ("close", "above_one", lambda x: 1 / x, 2e-7 / U),
    ("root", "above_one", np.sqrt, 2e-5 / U))


def error_of(value, expected):
    """In units in the last place. 0 where both are NaN or both denormal, and for an infinity beyond the largest float."""
    size = np.abs(expected)
    error = np.abs(value - expected) / ulp(np.minimum(size, 2.0**127).astype(float))
    small, both = size < LEAST, np.isnan(value) & np.isnan(expected)
    error = np.where(small, np.where(np.abs(value) <= LEAST, 0, np.inf), error)
    right = np.isinf(value) & ((value > 0) == (expected > 0)) & (size > MOST * (1 - 4 * U))
    return np.where(both | right, 0, np.where(np.isnan(error), np.inf, error))


def test_functions_are_within_their_bounds(backend):
    with diptych.open(ROOT + "/tests/specs/arithmetic.yaml", backend, size=(9, 5), scene=ROOT + "/scenes/cornell.yaml") as pipeline:
        left = pipeline.render("arguments", "functions")
    for name, fields, function, most in FUNCTIONS:
        arguments = [left["arguments"][field].astype(np.longdouble) for field in fields.split()]
        value = left["functions"][name].astype(np.longdouble)
        if name == "tan":
            arguments, value = [arguments[0][np.abs(arguments[0]) <= 8192]], value[np.abs(arguments[0]) <= 8192]
        error = error_of(value, function(*arguments))
        print(f"# {name:11} {error.max():.2f} ulp, at most {most:g}")
        if error.max() > most:
            raise AssertionError(f"{name}: {error.max():.3g} ulp at {[argument[error.argmax()] for argument in arguments]}")


if __name__ == "__main__":
    np.seterr(all="ignore")
    bodies.run_tests(globals(), ("gl", "vk"))
