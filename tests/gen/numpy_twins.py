"""Passes of shipped pipelines again in NumPy, with 32-bit floats on the CPU: exact mode gives the same bits. Each twin reads
what earlier passes left. Its results are compared with those of OpenGL and of Vulkan, bit by bit. Twins use + - * / and
sqrt of NumPy, and the fixed polynomials of templates/glsl. Prints TAP; called by numpy_twins_test.sh."""
import os
import sys
import tempfile

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/app/python", ROOT + "/tests/gen"]
import bodies  # noqa: E402: from the paths above
import diptych  # noqa: E402

F, U, I = np.float32, np.uint32, np.int32
SCENE = ROOT + "/scenes/cornell.yaml"


# ---- GLSL ------------------------------------------------------------------------------------------


def bits(x):
    return np.asarray(x, F).view(U)


def floats(x):
    return np.asarray(x, U).view(F)


def maximum(x, y):
    return np.where(x < y, y, x)


def minimum(x, y):
    return np.where(y < x, y, x)


def clamp(x, low, high):
    return minimum(maximum(x, F(low)), F(high))


def dot(a, b):
    """Of the first three components, from left to right."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def half(x):
    """What a half holds of x: nearest, ties to even; beyond its largest value that value."""
    return clamp(x, -65504, 65504).astype(np.float16)


def unorm8(x):
    return np.rint(clamp(x, 0, 1) * F(255)).astype(np.uint8)


# ---- templates/glsl/approximate.glsl ----------------------------------------------------------------


def reciprocal_estimate(y):
    """approximate_reciprocal_estimate"""
    r = floats(U(0x7EB50500) - bits(y))
    d = y * r
    return r * (F(4.17971835) - d * (F(5.82303075) - d * F(2.70399363)))


def root_estimate(x):
    """approximate_root_estimate"""
    r = floats(U(0x5F200000) - (bits(x) >> U(1)))
    d = x * r * r
    return r * (F(2.102354969) - d * (F(1.760928667) - d * F(0.6631531635)))


def approximate_reciprocal(y):
    """Of normal numbers."""
    r = reciprocal_estimate(y)
    return r + r * (F(1) - y * r)


def approximate_inversesqrt(x):
    """Of positive normal numbers."""
    r = root_estimate(x)
    error = F(1) - x * r * r
    return r + r * (F(0.5) * error)


# ---- templates/shared/estimate.glsl, srgb.glsl, space.glsl -------------------------------------------


def reciprocal_close(x):
    r = reciprocal_estimate(x)
    return r + r * (F(1) - x * r)


def sqrt_estimate(x):
    return x * root_estimate(x)


def srgb(x):
    root = sqrt_estimate(sqrt_estimate(x))
    code = root * (F(1.1226856) - root * (F(0.33550491) - root * F(0.081330878)))
    code = root * (F(0.19613398) + code) - F(0.064611241)
    return np.where(x <= F(0.0031308), F(12.92) * x, code)


def unit_or(v, otherwise):
    square = dot(v, v)
    return v * approximate_inversesqrt(square) if square > F(1e-24) else otherwise


# ---- templates/glsl/exact.glsl: exact_log, exact_exp -------------------------------------------------


def polynomial(x, *factors):
    """Horner's scheme, from the highest power on."""
    p = F(factors[0])
    for factor in factors[1:]:
        p = p * x + F(factor)
    return p


def log(x):
    """Of positive normal numbers."""
    above = bits(x) - U(0x3F3504F3)
    n = (above.view(I) >> 23).astype(F)
    t = floats((above & U(0x7FFFFF)) + U(0x3F3504F3)) - F(1)
    z = t * t
    p = polynomial(t, 7.0376836292e-2, -1.1514610310e-1, 1.1676998740e-1, -1.2420140846e-1, 1.4249322787e-1,
                   -1.6668057665e-1, 2.0000714765e-1, -2.4999993993e-1, 3.3333331174e-1)  # fmt: skip
    rest = t * z * p - F(0.5) * z
    return (rest - n * F(2.12194440e-4)) + t + n * F(0.693359375)


def exp(x):
    """Of numbers within 87 of zero."""
    n = np.rint(x * F(1.44269504))
    r = x - n * F(0.693359375)
    r = r + n * F(2.12194440e-4)
    p = polynomial(r, 1.3941379554e-3, 8.36333528e-3, 4.16663723e-2, 1.66665760e-1, 0.5)
    p = p * (r * r) + r + F(1)
    return np.ldexp(p, n.astype(I))


# ---- templates/shared/denoise_axis.glsl, denoise_rows.glsl, denoise_columns.glsl ---------------------


def without_outlier(params, source):
    """without_outlier: the light of each pixel, limited by that of its class around it."""
    height, width = source.shape[:2]
    light = source[..., :3].astype(F)
    total = light[..., 0] + light[..., 1] + light[..., 2]
    brightest = np.zeros((height, width), F)
    wide, high = params["tile"]
    for y, x in [(y, x) for y in (-high, 0, high) for x in (-wide, 0, wide) if y or x]:
        beside = total[np.clip(np.arange(height) + y, 0, height - 1)][:, np.clip(np.arange(width) + x, 0, width - 1)]
        brightest = maximum(brightest, beside)
    limit = F(params["denoise_outlier"]) * brightest
    limited = light * (limit * reciprocal_close(np.where(total > 0, total, F(1))))[..., None]
    return np.where(((limit > 0) & (total > limit))[..., None], limited, light)


def filter_axis(params, source, position, normal, axis, own):
    """axis: 1 along rows, 0 along columns; own: light of the pixel itself. filter_axis, and the store as half."""
    centre, n = position, normal[..., :3].astype(F)
    radius = max(params["denoise_radius"] * params["tile"][1 - axis], 1)
    length = source.shape[axis]
    place = np.arange(length).reshape((1, -1) if axis else (-1, 1))
    inverse_depth = reciprocal_close(F(params["denoise_plane"]) * maximum(centre[..., 3], F(1e-12)))
    inverse_normal = reciprocal_close(F(1) - F(params["denoise_normal"]))
    weights = np.where(centre[..., 3] > 0, F(radius), F(0))
    total = own * weights[..., None]
    for i in (i for i in range(1 - radius, radius) if i):
        inside = (place + i >= 0) & (place + i < length)
        q = np.clip(np.arange(length) + i, 0, length - 1)
        x, nq, light = (array.take(q, axis) for array in (position, n, source[..., :3].astype(F)))
        off_plane = np.abs(dot(n, x[..., :3] - centre[..., :3])) * inverse_depth
        alike = (dot(n, nq) - F(params["denoise_normal"])) * inverse_normal
        weight = clamp(alike, 0, 1) * clamp(F(2) - off_plane, 0, 1)
        weight = weight * np.where(x[..., 3] > 0, F(radius - abs(i)), F(0))
        total = np.where(inside[..., None], total + light * weight[..., None], total)
        weights = np.where(inside, weights + weight, weights)
    light = np.where((weights > 0)[..., None], total * reciprocal_close(weights)[..., None], F(0))
    return half(np.concatenate((light, np.ones_like(light[..., :1])), 2))


def denoise(params, left):
    guides = left["gbuffer_position"], left["gbuffer_normal"]
    light, rows = left["irradiance"], left["irradiance_rows"]
    yield "denoise_rows", "irradiance_rows", filter_axis(params, light, *guides, 1, without_outlier(params, light))
    yield "denoise_columns", "indirect", filter_axis(params, rows, *guides, 0, rows[..., :3].astype(F))


# ---- templates/shared/luminance_tiles.glsl, luminance_mean.glsl, tonemap.glsl ------------------------

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], F)


def tree(values):
    """Sums of the last axis, a power of two: the upper half is added to the lower half."""
    while values.shape[-1] > 1:
        middle = values.shape[-1] // 2
        values = values[..., :middle] + values[..., middle:]
    return values[..., 0]


def luminance_tiles(params, radiance):
    height, width = radiance.shape[:2]
    tiles_y, tiles_x = -(-height // 32), -(-width // 32)
    lane = np.arange(64)
    first_y = np.arange(tiles_y)[:, None, None] * 32 + lane // 8
    first_x = np.arange(tiles_x)[None, :, None] * 32 + lane % 8
    logs = surfaces = np.zeros((tiles_y, tiles_x, 64), F)
    for i in range(16):
        y, x = np.broadcast_arrays(first_y + 8 * (i // 4), first_x + 8 * (i % 4))
        colour = radiance[np.minimum(y, height - 1), np.minimum(x, width - 1)]
        counts = (x < width) & (y < height) & (colour[..., 3] > 0)
        logarithm = log(F(params["luminance_delta"]) + dot(colour, LUMINANCE))
        logs = logs + np.where(counts, logarithm, F(0))
        surfaces = surfaces + np.where(counts, F(1), F(0))
    return np.stack((tree(logs), tree(surfaces)), 2).reshape(-1, 2)


def luminance_mean(params, tiles):
    lanes = np.zeros((2, 256), F)
    for first in range(0, len(tiles), 256):
        run = tiles[first : first + 256]
        lanes[:, : len(run)] = lanes[:, : len(run)] + run.T
    logs, surfaces = tree(lanes)
    return np.array([F(params["exposure"]) / exp(logs / maximum(surfaces, F(1)))], F)


def tonemap(params, radiance, scale):
    colour = radiance[..., :3] * scale[0]
    luminance = dot(colour, LUMINANCE)
    whitest = reciprocal_close(F(params["white"]) * F(params["white"]))
    factor = (F(1) + luminance * whitest) * reciprocal_close(F(1) + luminance)
    colour = clamp(colour * factor[..., None], 0, 1)
    codes = np.floor(srgb(colour) * F(255) + F(0.5))
    light = codes * F(1 / 255)  # glslang divides in double
    return unorm8(np.concatenate((light, np.ones_like(light[..., :1])), 2))


def tone(params, left):
    yield "luminance", "luminance_tiles", luminance_tiles(params, left["radiance"])
    yield "average", "luminance_scale", luminance_mean(params, left["luminance_tiles"])
    yield "tonemap", "display", tonemap(params, left["radiance"], left["luminance_scale"])


# ---- templates/glsl/metric.glsl, templates/ssvp/lloyd.glsl -------------------------------------------


class Metric:
    """metric_one_minus_dot of points, scale: of the scene, m"""

    def __init__(self, params, points, scale):
        self.points = points
        self.metre = F(params["position_weight"]) * approximate_reciprocal(F(scale))
        self.normal_weight = F(params["normal_weight"])

    def distance(self, position, normal):
        d = self.points["position"] - position
        square = maximum(dot(d, d), F(1.17549435e-38))
        r = root_estimate(square)
        apart = square * r
        apart = apart + apart * (F(0.5) * (F(1) - apart * r))
        agreement = maximum(dot(self.points["normal"], normal), F(0))
        return self.metre * apart + self.normal_weight * (F(1) - agreement)


class Lloyd:
    """k-means: names are those of the GLSL."""

    def __init__(self, params, points, centres, scale):
        self.points, self.radius = points, F(scale)
        self.metric = Metric(params, points, scale)
        self.one = minimum(F(536870912) * approximate_reciprocal(F(len(points))), F(1048576))
        flux = points["flux"]
        self.power = flux[:, 0] + flux[:, 1] + flux[:, 2]
        self.lives = self.power > 0
        self.count = len(centres)
        self.centre_position = np.zeros((self.count, 3), F)
        self.centre_normal = np.zeros((self.count, 3), F)
        for c in range(self.count):
            self.seed(c, centres[c], params["reuse_centres"])
        for i in range(params["kmeans_iterations"]):
            if i > 0:
                self.centre_position, self.centre_normal = self.mean_position, self.mean_normal
            self.assign()
            self.mean_position, self.mean_normal = self.centre_position.copy(), self.centre_normal.copy()
            self.members = [self.average(c) for c in range(self.count)]
            self.reseed_empty()

    def seed(self, c, centre, reuse):
        living = np.flatnonzero(self.lives)
        wanted = (2 * c + 1) * len(living) // (2 * self.count)
        chosen = living[wanted] if wanted < len(living) else 0
        seen = reuse == 1 and centre["seen"] != 0
        normal = unit_or(self.points["normal"][chosen], np.array([0, 0, 1], F))
        self.centre_position[c] = centre["mean"] if seen else self.points["position"][chosen]
        self.centre_normal[c] = centre["mean_normal"] if seen else normal

    def assign(self):
        distances = np.stack([self.metric.distance(*centre) for centre in zip(self.centre_position, self.centre_normal)], 1)
        nearest = distances.argmin(1)  # ties: the lowest index
        order = np.sort(distances, 1)
        self.label = np.where(self.lives, nearest, -1).astype(I)
        self.apart = np.where(self.lives, order[:, 0], F(-1))
        self.margins = np.full(len(self.points), F(-1))
        if self.count > 1:
            self.margins = np.where(self.lives, order[:, 1] - order[:, 0], F(-1))

    def average(self, c):
        members = np.flatnonzero(self.label == c)
        if not len(members):
            return 0
        scale = self.one * approximate_reciprocal(self.radius)
        position = np.rint((self.points["position"][members] - self.centre_position[c]) * scale).astype(I).sum(0)
        normal = np.rint(self.points["normal"][members] * self.one).astype(I).sum(0)
        normal = normal.astype(F) * approximate_reciprocal(self.one)
        brightest = members[self.power[members].argmax()]
        count = F(len(members))
        if dot(normal, normal) < F(1e-4) * count * count:
            normal = self.points["normal"][brightest]
        mean = position.astype(F) * (self.radius * approximate_reciprocal(self.one * count))
        self.mean_position[c] = self.centre_position[c] + mean
        self.mean_normal[c] = unit_or(normal, self.centre_normal[c])
        return len(members)

    def reseed_empty(self):
        for c in range(self.count):
            if not self.members[c] and self.apart.max() > 0:
                first = self.apart.argmax()
                self.mean_position[c] = self.points["position"][first]
                self.mean_normal[c] = unit_or(self.points["normal"][first], self.centre_normal[c])
                self.apart[first] = F(-1)


def lloyd(params, left, names, scale):
    """names: of the resources that the pass calls points, centres, labels and margins, and of the pass."""
    before = left["before"][names["centres"]]
    found = Lloyd(params, left[names["points"]], before, scale)
    yield names["pass"], names["labels"], found.label
    yield names["pass"], names["margins"], found.margins
    centres = np.zeros_like(left[names["centres"]])
    centres["position"], centres["normal"] = found.centre_position, found.centre_normal
    centres["members"], centres["seen"] = found.members, 1 if sum(found.members) else 0
    centres["mean"], centres["mean_normal"] = found.mean_position, found.mean_normal
    yield names["pass"], names["centres"], centres


# ---- templates/ssvp/views.glsl, keep_numbers.glsl, nearest_eyes.glsl, sum_light.glsl, pack_vpls.glsl, classes.glsl ----------------------


def further_light(params, points):
    arriving = leaving = F(0)
    for point in points if params["further_bounces"] == 1 else ():
        arriving = arriving + point["arriving"]
        leaving = leaving + (point["flux"][0] + point["flux"][1] + point["flux"][2])
    return F(1) / (F(1) - minimum(leaving / arriving, F(0.9))) if arriving > 0 else F(1)


def place(params, left, group, scale):
    """Member and area of each view; the rest of it as found."""
    points, labels, centres = left["vpls" if group == "first" else "second_vpl"], left[group + ".labels"], left[group + ".centres"]
    views, metric = left[group + ".views"].copy(), Metric(params, points, scale)
    turned = np.arange(len(points), dtype=np.uint32) * np.uint32(2654435769) + np.uint32(left["frame"]) * np.uint32(3242174889)
    random = (turned >> np.uint32(8)).astype(F) * F(1 / 16777216)
    kept = len(left[group + ".eyes"]) > len(views) and params["reuse_pattern"] == 0 and left["frame"] > 0
    for c in range(len(views)):
        rank = random if kept else metric.distance(centres["mean"][c], centres["mean_normal"][c])
        members, area = np.flatnonzero(labels == c), F(0)
        for k in members:
            area = area + points["area"][k]
        views["member"][c] = members[rank[members].argmin()] if len(members) else -1  # ties: the lowest index
        views["area"][c] = area
    yield group + ".place", group + ".views", views


def keep_numbers(left):
    kept, drawn = left["before"]["kept_numbers"].copy(), left["first.drawn"]
    first = left["frame"] % (len(kept) // len(drawn)) * len(drawn)
    kept[first:first + len(drawn)] = drawn
    yield "keep_numbers", "kept_numbers", kept


def find_eyes(params, left, group, scale):
    points, labels, eyes = left["vpls" if group == "first" else "second_vpl"], left[group + ".labels"], left[group + ".eyes"]
    nearest = labels.copy()
    if len(eyes) > len(left[group + ".views"]):
        metric = Metric(params, points, scale)
        used = np.flatnonzero(eyes["used"])
        apart = np.stack([metric.distance(eyes["position"][e], eyes["normal"][e]) for e in used], 1)
        nearest = np.where(labels >= 0, used[apart.argmin(1)], labels).astype(I)  # ties: the lowest index
    yield group + ".find_eyes", group + ".nearest", nearest


def sum_light(left):
    points, nearest, eyes = left["vpls"], left["first.nearest"], left["first.eyes"].copy()
    for e in range(len(eyes)):
        flux, area = np.zeros(3, F), F(0)
        for k in np.flatnonzero(nearest == e):
            flux, area = flux + points["flux"][k], area + points["area"][k]
        eyes["flux"][e], eyes["power"][e], eyes["area"][e] = flux, flux[0] + flux[1] + flux[2], area
    yield "sum_light", "first.eyes", eyes


def pack(params, left, group):
    points = left["vpls" if group == "first" else "second_vpl"]
    nearest, eyes = left[group + ".nearest"], left[group + ".eyes"]
    shading = np.zeros_like(left[group + ".shading"])
    classes = params["tile"][0] * params["tile"][1]
    class_points = len(shading) // classes
    slot = np.arange(len(shading))
    c, j = slot // class_points, slot % class_points
    wanted = j * classes + (j + c) % classes
    k = np.minimum(wanted, len(points) - 1)
    e = np.maximum(nearest[k], 0)
    shading["position"], shading["normal"] = points["position"][k], points["normal"][k]
    shading["disk"] = F(params["softness"]) * points["area"][k] / F(3.14159265359)
    off = points["position"][k] - eyes["position"][e]
    shading["near_square"] = F(params["visibility_near"]) * F(params["visibility_near"]) * dot(off, off)
    flux = points["flux"][k] * further_light(params, points)
    shading["flux"] = np.where((wanted < len(points))[:, None], flux, F(0))
    shading["layer"], shading["eye"] = e, eyes["position"][e]
    shading["tangent"], shading["bitangent"], shading["axis"] = (eyes[name][e] for name in ("tangent", "bitangent", "normal"))
    yield group + ".pack", group + ".shading", shading


# ---- Pipelines ---------------------------------------------------------------------------------------


def scene_radius():
    """frame.scene_radius, as a pass sees it."""
    with tempfile.TemporaryDirectory() as folder:
        with open(folder + "/radius.yaml", "w", encoding="utf-8") as file:
            file.write("pipeline: radius\nbuffers: {radius: {of: float, count: 1, keep: true}}\npasses:\n"
                       "  - {name: ask, dispatch: 1, reads: [scene_indices], writes: [radius], shader: radius.glsl}\n")  # fmt: skip
        with open(folder + "/radius.glsl", "w", encoding="utf-8") as file:
            file.write("void main()\n{\n    if (scene_indices[0] >= 0u && invocation().x == 0)\n"
                       "        radius[0] = frame.scene_radius;\n}\n")  # fmt: skip
        with diptych.open(folder + "/radius.yaml", scene=SCENE, size=(1, 1)) as pipeline:
            return pipeline.render("radius")["radius"][0]


def twins_of_rsm(params, left):
    yield from denoise(params, left)
    yield from tone(params, left)


def twins_of_ssvp(params, left):
    radius = scene_radius()
    for group, points in (("first", "vpls"), ("second", "second_vpl")):
        names = {name: f"{group}.{name}" for name in ("centres", "labels", "margins")}
        names.update({"points": points, "pass": group + ".kmeans"})
        yield from lloyd(params, left, names, radius)
        yield from place(params, left, group, radius)
        yield from find_eyes(params, left, group, radius)
        yield from pack(params, left, group)
    yield from keep_numbers(left)
    yield from sum_light(left)
    yield from twins_of_rsm(params, left)


RSM = ("irradiance", "irradiance_rows", "indirect", "gbuffer_position", "gbuffer_normal", "radiance", "luminance_tiles",
       "luminance_scale", "display")  # fmt: skip
GROUP = ("labels", "margins", "centres", "views", "eyes", "nearest", "shading")
SSVP = RSM + ("vpls", "second_vpl", "first.drawn", "kept_numbers") + tuple(f"{group}.{name}" for group in ("first", "second") for name in GROUP)
SMALL = {"rsm_size": 128, "map_size": 32}
# Frame, parameters, and frames: from the second on, k-means goes on from the last one's centres.
RUNS = {
    "rsm": (twins_of_rsm, RSM, (
        ((160, 90), {"rsm_size": 128}, 1),
        ((77, 45), {"rsm_size": 64, "tile": [3, 5], "denoise_radius": 2, "denoise_normal": 0.3, "denoise_plane": 0.05,
                    "exposure": 0.7, "white": 1.3, "luminance_delta": 0.02}, 1),
    )),
    "ssvp": (twins_of_ssvp, SSVP, (
        ((64, 36), SMALL, 2),
        ((41, 83), dict(SMALL, first_vpls=100, second_vpls=231, clusters=7, second_clusters=5, tile=[3, 2],
                        kmeans_iterations=9, position_weight=1.7, normal_weight=0.35, softness=0.3, visibility_near=1.9,
                        further_bounces=1), 3),
        ((64, 36), dict(SMALL, kept_maps=4, first_vpls=64, clusters=4, second_clusters=2), 2),
    )),
}  # fmt: skip


def same(found, wanted):
    """Elements that differ in a bit, as text: how many, and the first one."""
    if found.dtype.names:
        parts = {name: same(found[name], wanted[name]) for name in found.dtype.names}
        return "; ".join(f"{name}: {text}" for name, text in parts.items() if text)
    if found.shape != wanted.shape or found.dtype != wanted.dtype:
        return f"{found.dtype}{found.shape} and {wanted.dtype}{wanted.shape}"
    unsigned = f"u{found.dtype.itemsize}"
    differing = np.argwhere(np.ascontiguousarray(found).view(unsigned) != np.ascontiguousarray(wanted).view(unsigned))
    if not len(differing):
        return ""
    place = tuple(differing[0])
    return f"{len(differing)} of {found.size} numbers differ, first {place}: {found[place]!r}, twin {wanted[place]!r}"


def play(name, backend, size, sets, frames):
    """Parameters, and what each pass of the last frame left."""
    spec = f"{ROOT}/templates/{name}.yaml"
    _, take, _ = RUNS[name]
    with diptych.open(spec, backend, scene=SCENE, size=size, sets=sets) as pipeline:
        before = {}
        for frame in range(frames):
            left = pipeline.render(*take)
            history = {key: value for key, value in left.items() if key.endswith("centres") or key == "kept_numbers"}
            left.update(frame=frame, before=before or {key: np.zeros_like(value) for key, value in history.items()})
            before = history
        params = {param["name"]: param["value"] for param in pipeline.description["params"]}
    return params, left


def differing(name, backend, size, sets, frames):
    """(PASS, RESOURCE, what differs or nothing) of each twin."""
    params, left = play(name, backend, size, sets, frames)
    with np.errstate(all="ignore"):
        for place, resource, wanted in RUNS[name][0](params, left):
            text = same(left[resource], wanted)
            trivial = wanted.size > 1 and len(np.unique(wanted)) == 1
            yield place, resource, f"all are {wanted[0]}" if trivial else text


def main():
    tap = bodies.Tap()
    for name, (_, _, runs) in RUNS.items():
        for size, sets, frames in runs:
            for backend in ("gl", "vk"):
                for place, resource, text in differing(name, backend, size, sets, frames):
                    told = f"{name} {size[0]}x{size[1]}, {backend}, {place}: {resource} has the bits of its twin"
                    tap.result(told, [text] if text else [])
    # A control: the device's own functions and roundings have other bits.
    size, sets, frames = RUNS["rsm"][2][0]
    fast = [resource for _, resource, text in differing("rsm", "vk", size, dict(sets, exactness="fast"), frames) if text]
    missing = {"indirect", "luminance_tiles", "luminance_scale"} - set(fast)
    tap.result("fast mode has other bits", sorted(missing))
    tap.finish()


if __name__ == "__main__":
    main()
