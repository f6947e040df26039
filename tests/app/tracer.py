"""`reference` against results that need no tracer: closed forms of radiometry, rates of convergence, invariances, and the direct light
of a pipeline. Scenes are glTF files, made here quad by quad; sums of samples are read from checkpoints. tracer_test.c has the
sequences. Prints TAP; called by tracer_test.sh."""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/app/python", ROOT + "/tests/gen"]
import bodies  # noqa: E402: from the paths above
import diptych  # noqa: E402
import gltf  # noqa: E402
from diptych.png import encode_png  # noqa: E402

PROGRAM = os.path.join(os.environ.get("DIPTYCH_BUILD", ROOT + "/build"), "diptych")
IRRADIANCE = ("--quantity", "irradiance")


def holds(truth, what):
    if not np.all(truth):
        raise AssertionError(str(what))


def near(found, expected, tolerance, what):
    found, expected = np.broadcast_arrays(np.asarray(found, float), np.asarray(expected, float))
    wrong = np.argwhere(~(np.abs(found - expected) <= tolerance))
    if len(wrong):
        place = tuple(wrong[0])
        raise AssertionError(f"{what} {place}: {found[place]:.9g}, expected {expected[place]:.9g} within {tolerance:.2g}")


# ---- Scenes -----------------------------------------------------------------------------------------


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


class Stage:
    """A scene that grows by quads. Albedos are white, the light is dark."""

    def __init__(self, *materials):
        self.quads, self.materials = [], materials or ({},)
        self.sun([0, -1, 0], [0, 0, 0])

    def quad(self, a, u, v, material=0, normal=None):
        """The parallelogram a, a + u, a + u + v, a + v, with texture coordinates from 0 to 1 along u and v."""
        a, u, v = (np.asarray(x, float) for x in (a, u, v))
        self.quads.append((np.array([a, a + u, a + v, a + u + v]), unit(np.cross(u, v)) if normal is None else normal, material))
        return self

    def cube(self, low, side, material=0):
        for axis in range(3):
            for end in 0, 1:
                a, (u, v) = np.array(low, float), np.roll(np.eye(3), -axis - 1, 0)[:2] * side
                a[axis] += end * side
                self.quad(a, u, v, material)
        return self

    def floor(self, half, **more):
        return self.quad([-half, 0, half], [2 * half, 0, 0], [0, 0, -2 * half], **more).look([0.3, 2, 1.5], [0.1, 0, -0.2], 0.7)

    def look(self, eye, target, fov_y, up=(0, 1, 0)):
        self.eye, self.target, self.fov_y, self.up = (np.array(x, float) for x in (eye, target, fov_y, up))
        return self

    def sun(self, direction, irradiance, **more):
        self.light = {"kind": "directional", "direction": list(direction), "irradiance": list(irradiance), **more}
        return self

    def spot(self, position, direction, cone, intensity):
        target = np.add(position, direction)
        self.light = {"kind": "spot", "position": list(position), "target": list(target), "cone": list(np.degrees(cone)),
                      "intensity": list(intensity)}
        return self

    def rays(self, width, height):
        """Unit vectors through the centres of pixels, row 0 at the top."""
        ahead = unit(self.target - self.eye)
        right = unit(np.cross(ahead, self.up))
        y, x = (1 - 2 * (np.arange(height) + 0.5) / height)[:, None, None], (2 * (np.arange(width) + 0.5) / width - 1)[:, None]
        tangent = np.tan(self.fov_y / 2)
        rays = ahead + tangent * (y * np.cross(right, ahead) + x * width / height * right)
        return rays / np.linalg.norm(rays, axis=-1, keepdims=True)

    def floor_points(self, width, height):
        rays = self.rays(width, height)
        return self.eye - rays * (self.eye[1] / rays[..., 1:2])

    def write(self):
        arrays, primitives = [], []
        for material in range(len(self.materials)):
            quads = [quad for quad in self.quads if quad[2] == material]
            if not quads:
                continue
            first = len(arrays)
            arrays += [np.concatenate([corners for corners, _, _ in quads]).astype("f4"),
                       np.repeat([normal for _, normal, _ in quads], 4, 0).astype("f4"),
                       np.tile(np.array([[0, 0], [1, 0], [0, 1], [1, 1]], "f4"), (len(quads), 1)),
                       (4 * np.arange(len(quads))[:, None] + [0, 1, 3, 0, 3, 2]).astype("u2").reshape(-1)]
            attributes = {"POSITION": first, "NORMAL": first + 1, "TEXCOORD_0": first + 2}
            primitives.append({"attributes": attributes, "indices": first + 3, "material": material})
        tree, data = gltf.document(*arrays, meshes=[{"primitives": primitives}], materials=[*self.materials], textures=[{"source": 0}],
                                   images=[{"uri": "texture.png"}])
        gltf.put("a.bin", data)
        gltf.put("a.gltf", json.dumps(tree))
        camera = {"eye": list(self.eye), "target": list(self.target), "up": list(self.up), "fov_y": float(np.degrees(self.fov_y))}
        gltf.put("scene.yaml", json.dumps({"mesh": "a.gltf", "camera": camera, "light": self.light}))


def matte(r, g=None, b=None, **more):
    return {"pbrMetallicRoughness": {"baseColorFactor": [r, r if g is None else g, r if b is None else b, 1]}, **more}


class Film:
    """What `reference` made: its sums, and the mean of each pixel."""

    def __init__(self, path, width, height):
        with open(path, "rb") as file:
            self.bytes = file.read()
        _, _, samples, rest = self.bytes.split(b"\n", 3)
        sums = np.frombuffer(rest[:-8], float).reshape(2, height, width, 3)
        self.samples, self.sums, self.pixels = int(samples), sums, sums.sum(0) / int(samples)
        self.mean = self.pixels.mean()


def run(*words):
    return subprocess.run([PROGRAM, "reference", "--scene", "scene.yaml", "-o", "a.exr", *map(str, words)], capture_output=True, text=True,
                          check=False)


def trace(stage, spp, *words, size=(48, 48), film="film", bounces=0, first=0):
    """With a fresh film."""
    stage.write()
    if os.path.exists(film):
        os.remove(film)
    done = run("--size", f"{size[0]}x{size[1]}", "--spp", spp, "--bounces", bounces, "--from-bounce", first, "--filter", "centre",
               "--checkpoint", film, "--json", "a.json", *words)
    holds(done.returncode == 0, done.stderr)
    return Film(film, *size)


# ---- White furnace ----------------------------------------------------------------------------------


def test_white_furnace():
    """In a closed room whose walls all emit e and reflect a, radiance is e (1 + a + a^2 + ...) everywhere, with one term for each
    allowed bounce, one for the emission towards the eye and one for direct light. The room is turned, so that no wall lies along an
    axis, and stands where coordinates are a hundred times its size. Every path finds the same, unless light leaks, or chance ends it."""
    axes, corner, e = np.array([[2, 1, 2], [-2, 2, 1], [-1, -2, 2.0]]), np.array([300, 100, -200.0]), 2
    eye = corner + axes.sum(0) / 2
    many = {"bounces": "unlimited"}
    for a, keys, words, want, tolerance in (
            (0.5, {"bounces": 0}, (), e * 1.5, 2e-4), (0.5, {"bounces": 3}, (), e * (1 - 0.5**5) / 0.5, 2e-4),
            (0.5, {"first": 2, "bounces": 3}, (), e * (0.5**3 + 0.5**4), 2e-4), (0.5, {"bounces": 1}, IRRADIANCE, np.pi * e * 1.5, 2e-4),
            (0.5, {"bounces": 2}, ("--filter", "box"), e * (1 - 0.5**4) / 0.5, 2e-4), (0.5, many, (), e / 0.5, 4e-3),
            (0.8, many, ("--sampler", "random"), e / (1 - 0.8), 8e-3)):
        room = Stage(matte(a, emissiveFactor=[1, 1, 1], extensions={"KHR_materials_emissive_strength": {"emissiveStrength": e}}))
        for i in range(3):
            for end in 0, 1:
                room.quad(corner + end * axes[i], axes[(i + 1) % 3], axes[(i + 2) % 3])
        room.look(eye, eye + axes[0] + 0.3 * axes[1] + 0.2 * axes[2], 1.5, axes[1])
        near(trace(room, 64, "--emission", *words, **keys).mean, want, tolerance * want, f"{keys} {words}")


# ---- A patch under a light --------------------------------------------------------------------------


def test_patch_under_a_directional_light():
    """Radiance is albedo / pi E cos(theta), from either side of the floor."""
    for normal in [0, 1, 0], [0, -1, 0]:
        stage = Stage(matte(0.25, 0.5, 1)).floor(4, normal=normal).sun([0.6, -0.48, 0.64], [3, 5, 7])
        near(trace(stage, 1, size=(17, 11), bounces=2).pixels, np.array([0.25 * 3, 0.5 * 5, 7]) / np.pi * 0.48, 1e-6, "radiance")


def test_patch_under_a_spot_light():
    """Irradiance is I s(theta) cos(theta') / d^2, with s one inside the inner cone, zero outside the outer, and a smooth step of the
    cosine between; every pixel at its own centre."""
    position, axis, inner, outer = np.array([0.2, 1.5, -0.3]), np.array([0.28, -0.96, 0]), 0.2, 0.45
    stage = Stage().floor(4).spot(position, axis, (inner, outer), [10, 20, 30])
    away = stage.floor_points(40, 30) - position
    distance = np.linalg.norm(away, axis=-1)
    t = np.clip((away @ axis / distance - np.cos(outer)) / (np.cos(inner) - np.cos(outer)), 0, 1)
    step = t * t * (3 - 2 * t)
    near(trace(stage, 1, *IRRADIANCE, size=(40, 30)).pixels[..., 1], 20 * step * position[1] / distance**3, 5e-5 * 20, "spot")
    holds(min((step == 1).sum(), (step == 0).sum(), ((step > 0) & (step < 1)).sum()) > 20, "all parts are seen")


def test_shadow_and_opening():
    """The light falls straight down, on the floor between `low` and `high` alone: under the gap of a roof, or under its opening."""
    low, high = -0.21, 0.34
    roof = Stage().floor(4).quad([high, 3, -4], [4, 0, 0], [0, 0, 8]).quad([low - 4, 3, -4], [4, 0, 0], [0, 0, 8])
    for stage, more, margin in ((roof, {}, 1e-4), (Stage().floor(4), {"opening_min": [low, -9, -9], "opening_max": [high, 9, 9]},
                                                   0.0051 * np.hypot(4, 4))):  # of the light's view
        stage.sun([0, -1, 0], [1, 1, 1], **more)
        x = stage.floor_points(40, 30)[..., 0]
        found = trace(stage, 1, *IRRADIANCE, size=(40, 30)).pixels[..., 0]
        inside, outside = (x > low + margin) & (x < high - margin), (x < low - margin) | (x > high + margin)
        near(found[inside], 1, 1e-6, "light")
        near(found[outside], 0, 1e-6, "shadow")
        holds(min(inside.sum(), outside.sum()) > 100, "both are seen")


# ---- Form factors and energy ------------------------------------------------------------------------


def squares(parallel, albedo=1):
    """Unit squares, the second of which emits 1: parallel at the distance 1, or with a common edge. The camera between them sees the
    first one, exactly."""
    stage = Stage(matte(albedo), matte(0, emissiveFactor=[1, 1, 1])).quad([0, 0, 0], [1, 0, 0], [0, 0, 1])
    stage.quad(*([[0, 1, 0], [1, 0, 0]] if parallel else [[0, 0, 0], [0, 1, 0]]), [0, 0, 1], 1)
    return stage.look([0.5, 0.5, 0.5], [0.5, 0, 0.5], np.pi / 2, [0, 0, -1])


def test_form_factors_of_squares():
    """The mean irradiance of the first square is pi F (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-11 and
    C-14, for unit squares). The same by light that is reflected once: a floor of albedo 0.5 under a light from straight above, which does
    not reach the wall on the floor's edge."""
    for parallel, want in (False, 0.2000438), (True, 0.1998249):
        near(trace(squares(parallel), 256, "--emission", *IRRADIANCE).mean / np.pi, want, 3e-3 * want, f"parallel {parallel}")
    stage = squares(False, 0.5).look([0.5, 0.5, 0.5], [0, 0.5, 0.5], np.pi / 2).sun([0, -1, 0], [3, 3, 3])
    near(trace(stage, 256, *IRRADIANCE, bounces=1, first=1).mean / (0.5 * 3), 0.2000438, 3e-3 * 0.2, "first bounce")


def test_energy_of_each_bounce_in_a_closed_box():
    """In a closed cube of albedo a that holds a spot light of flux P, the k-th bounce brings the walls a^k P, wherever it lands. Six
    square views from the centre show the walls evenly."""
    inner, outer, side = 0.4, 0.7, 2
    stage = Stage(matte(0.75)).cube([-1, -1, -1], side).spot([0.3, 0.5, -0.4], [0.48, -0.6, 0.64], (inner, outer), [5, 5, 5])
    flux = 5 * 2 * np.pi * (1 - np.cos(inner) + (np.cos(inner) - np.cos(outer)) / 2)  # the mean of a smooth step is one half
    for k in range(4):
        total = 0
        for face in range(6):
            axes = np.roll(np.eye(3), -(face // 2), 0)
            stage.look([0, 0, 0], axes[0] * (1 if face % 2 else -1), np.pi / 2, axes[1])
            total += trace(stage, 64 if k else 1, *IRRADIANCE, bounces=k, first=k).mean * side * side
        near(total / flux, 0.75**k, 4e-3 * 0.75**k, f"flux of bounce {k}")


def test_hidden_surfaces_stay_dark():
    """First, a screen hides a plane from the spot and from the floor that the spot lights. Then a plane has nothing over it; its
    normals lean so far that half of their directions hit the plane itself."""
    for leaning in False, True:
        stage = Stage(matte(1, emissiveFactor=[1, 0, 0])).floor(1, normal=[0.96, 0.28, 0] if leaning else None)
        stage.spot([0, 0.6, 0], [0, -1, 0], (0.5, 0.9), [1, 1, 1])
        for y in () if leaning else (0.75, 1):  # the screen, and the plane behind it
            stage.quad([-4, y, -4], [8, 0, 0], [0, 0, 8])
        stage.look([0, 0.9, 0], [0, 0 if leaning else 1, 0], 0.8, [1, 0, 0])
        holds((trace(stage, 1, *IRRADIANCE, size=(16, 16)).mean > 0) == leaning, f"direct, leaning {leaning}")
        words = (*IRRADIANCE, *(["--emission"] if leaning else []))
        holds(trace(stage, 64, *words, size=(16, 16), bounces=1, first=1).mean == 0, f"reflected, leaning {leaning}")


def test_virtual_point_lights():
    """Irradiance is flux / pi cos cos / (d^2 + disk cos) where a light is seen: from outside the shadow of a screen; with an eye under
    the floor, within a distance; with an eye over a roof, everywhere, since the light is nearer than the roof."""
    stage = Stage().floor(2).quad([0.1, 0.5, -2], [2, 0, 0], [0, 0, 4]).quad([-9, 2.5, -9], [18, 0, 0], [0, 0, 18])
    x = stage.look([0, 0.4, 0], [0, 0, 0], 1.5, [0, 0, -1]).floor_points(40, 40)
    square = (x**2).sum(-1) + 1
    three = [(name, "<f4", 3) for name in ("position", "normal", "flux", "eye")]
    fields = [*three[:3], ("disk", "<f4"), three[3], ("near_square", "<f4")]
    for eye, near_square, disk, seen in (1, 0, 0, x[..., 0] < 0.2), (-1, 1.1, 0.25, square < 1.1), (3, 1e-9, 0, True):
        np.save("vpl.npy", np.array([0, 1, 0, 0, -1, 0, 2, 3, 4, disk, 0, eye, 0, near_square], "<f4").view(fields))
        found = trace(stage, 1, *IRRADIANCE, "--vpls", "vpl.npy", size=(40, 40), bounces=1, first=1).pixels[..., 1]
        near(found, np.where(seen, 3 / np.pi / (square**2 + disk * square**0.5), 0), 1e-4, f"eye {eye}")


# ---- Convergence ------------------------------------------------------------------------------------


def corner_factor(a, b):
    """From a surface element to a parallel rectangle a x b whose corner lies over it at the distance 1 (Howell, B-3)."""
    p, q = np.sqrt(1 + a * a), np.sqrt(1 + b * b)
    return (a / p * np.arctan(b / p) + b / q * np.arctan(a / q)) / (2 * np.pi)


def test_convergence_rate():
    """Parallel squares, against the form factor of every pixel's own point: the slope of the line through (log N, log error). The
    film's own estimate of the noise is right for independent numbers, and not too low for Sobol points."""
    x = (np.arange(48) + 0.5) / 48
    want = np.pi * sum(corner_factor(a, b[:, None]) for a in (x, 1 - x) for b in (x, 1 - x))
    errors = {}
    for sampler in "random", "sobol":
        found = []
        for spp in 16, 64, 256, 1024:
            film = trace(squares(True), spp, "--emission", *IRRADIANCE, "--sampler", sampler)
            found.append(np.sqrt(((film.pixels[..., 0] - want) ** 2).mean()) / want.mean())
            with open("a.json", encoding="utf-8") as file:
                guess = json.load(file)["noise"] / found[-1]
            holds(abs(guess - 1) < 0.08 if sampler == "random" else 0.98 < guess < 1.8, f"noise of {spp} {sampler}: {guess}")
        errors[sampler] = np.array(found)
    slopes = {sampler: np.polyfit(np.log([16, 64, 256, 1024]), np.log(found), 1)[0] for sampler, found in errors.items()}
    near(slopes["random"], -0.5, 0.02, "rate of independent numbers")
    holds(slopes["sobol"] < -0.65 and errors["sobol"][-1] < errors["random"][-1] / 4, slopes)


# ---- The same bits ----------------------------------------------------------------------------------


def gallery(size=1):
    stage = Stage(matte(1, 0.5, 1), matte(1, 1, 0.25)).cube([-size] * 3, 2 * size)
    stage.cube([-0.2 * size, -size, -0.3 * size], 0.6 * size, 1)
    stage.spot(size * (0.8 - 0.3 * np.arange(3)), size * np.array([-0.64, -0.48, 0.6]), (0.5, 0.6), size * size * np.arange(1, 4.0))
    return stage.look([-0.7 * size, 0.3 * size, 0.9 * size], [0.1 * size, -0.2 * size, 0], 1.1)


def traced_gallery(spp, *words, size=1, **keys):
    return trace(gallery(size), spp, "--filter", "box", *words, bounces="unlimited", **{"size": (53, 37), **keys})


def test_threads_leave_no_trace():
    films = [traced_gallery(13, "--threads", threads).bytes for threads in (1, 2, 8)]
    holds(films[0] == films[1] == films[2], "threads")
    holds((traced_gallery(13, "--seed", 2).sums != traced_gallery(13).sums).any(), "the seed changes the film")


def test_scale_leaves_no_trace():
    """Lengths scale by a power of two, intensities by its square: the tracer has no length of its own."""
    large, small = (traced_gallery(8, size=size, film=f"film{i}").sums for i, size in enumerate((1, 2.0**-10)))
    holds((large == small).all() and (large > 0).any(), "scale")


def test_resumed_is_uninterrupted():
    whole = traced_gallery(24, film="whole").bytes
    traced_gallery(1, film="parts")
    for spp in 2, 7, 16, 24:
        done = run("--size", "53x37", "--spp", spp, "--bounces", "unlimited", "--filter", "box", "--checkpoint", "parts")
        holds(done.returncode == 0, done.stderr)
    holds(Film("parts", 53, 37).bytes == whole, "in parts")


def test_other_checkpoints_are_refused():
    def refused(text, path="film", size="3x2", seed=1):
        done = run("--size", size, "--spp", 9, "--seed", seed, "--bounces", 0, "--filter", "centre", "--checkpoint", path)
        holds(done.returncode == 1 and done.stderr.count("error:") == 1 and text in done.stderr and path in done.stderr, done.stderr)
    whole = trace(Stage().floor(1), 1, size=(3, 2)).bytes
    refused("is a checkpoint with other settings", seed=2)
    refused("is a checkpoint with other settings", size="4x2")
    refused("cannot be written", "/")
    for damaged in whole[:-40] + bytes([whole[-40] ^ 1]) + whole[-39:], whole[:5], whole[:-8] + b"12345678":
        gltf.put("film", damaged)
        refused("damaged")


# ---- Materials --------------------------------------------------------------------------------------

TEXTURED = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}


def test_textures():
    """A texture of 2 x 2 codes on a floor one unit wide. At the texels' centres it has their colour in linear light, half way between
    two of them their mean. The texture repeats. Radiance under pi is the albedo."""
    gltf.put("texture.png", encode_png(np.array([[[0, 188, 255], [255, 188, 255]], [[255, 188, 0], [255, 188, 0]]], "u1")))
    half = 0.50288653  # code 188, by the formula of IEC 61966-2-1
    for u, v, rgb in ((0.25, 0.25, (0, half, 1)), (0.75, 0.25, (1, half, 1)), (0.25, 0.75, (1, half, 0)), (0.5, 0.25, (0.5, half, 1)),
                      (0.75, 0.5, (1, half, 0.5)), (0, 0.25, (0.5, half, 1)), (0.5, 0.5, (0.75, half, 0.5))):
        stage = Stage(TEXTURED).floor(0.5).sun([0, -1, 0], [np.pi] * 3)
        x, z = u - 0.5 + 1e-6, 0.5 - v
        stage.look([x, 3, z], [x, 0, z], 0.1, [0, 0, -1])
        near(trace(stage, 1, size=(1, 1)).pixels[0, 0], rgb, 2e-5, f"texel at {u} {v}")


def test_holes():
    """Rays and light pass a curtain only through the holes of its texture."""
    texels = np.full((2, 2, 4), 255, "u1")
    texels[0, 0, 3] = 0  # u and v below a half
    gltf.put("texture.png", encode_png(texels))
    curtain = {**TEXTURED, "alphaMode": "MASK"}
    stage = Stage(matte(0.5), curtain).floor(0.5).quad([-0.5, 1, 0.5], [1, 0, 0], [0, 0, -1], 1).sun([0, -1, 0], [np.pi] * 3)
    stage.look([0, 21, 0], [0, 0, 0], 2 * np.arctan(0.5 / 20), [0, 0, -1])  # of the curtain; u grows to the right, v to the top
    near(trace(stage, 1, size=(2, 2)).pixels[..., 0], [[1, 1], [0.5, 1]], 1e-5, "from above")
    stage.look([0, 0.9, 0], [0, 0, 0], 2 * np.arctan(0.5 / 0.9), [0, 0, -1])
    near(trace(stage, 1, size=(2, 2)).pixels[..., 0], [[0, 0], [0.5, 0]], 1e-5, "from below")


# ---- The pipeline -----------------------------------------------------------------------------------


def test_direct_light_is_that_of_the_pipeline():
    """Two ways to the same number that share the scene and nothing else. The pipeline stores normals and albedo as half floats (a
    relative error of 5e-4 each), filters the border of a shadow over three texels of its map, and lets no light through the two texels
    around a silhouette: all but a few pixels, on borders of shadows, agree to 2e-3, and the mean to 3e-3."""
    for name, odd in ("cornell", 0.02), ("atrium", 0.06):
        scene = f"{ROOT}/scenes/{name}.yaml"
        with diptych.open(ROOT + "/templates/ssvp.yaml", scene=scene, size=(64, 64), sets={"bounces": 0}) as pipeline:
            shown = pipeline.render("radiance")["radiance"][::-1, :, :3].astype(float)
        if os.path.exists("film"):
            os.remove("film")
        done = run("--scene", scene, "--size", "64x64", "--bounces", 0, "--spp", 1, "--checkpoint", "film")
        holds(done.returncode == 0, done.stderr)
        traced = Film("film", 64, 64).pixels
        off, lit = (np.abs(shown - traced) > 2e-3 * traced).mean(), (traced > 0).mean()
        print(f"# {name}: ratio of means {shown.sum() / traced.sum():.5f}, {off:.4f} of the numbers off, {lit:.3f} lit")
        holds(abs(shown.sum() / traced.sum() - 1) < 3e-3 and off < odd and lit > 0.05, name)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        gltf.put("texture.png", encode_png(np.full((1, 1, 3), 255, "u1")))
        try:
            bodies.run_tests(globals(), (None,), "".join(sys.argv[1:]))
        finally:
            os.chdir(ROOT)
