"""oracle.py [TEXT]: stages of templates/ssvp.yaml against their definition, in double precision in NumPy: sampling patterns, VPLs,
clusters, second-bounce flux, interleaving, shading, tone mapping. SEED draws the backend of each test, since parity_test.sh shows
that both leave the same bits; long runs take both. Shares no code with the shaders; formulas and names of quantities are the
papers'. Prints TAP; called by oracle_test.sh. TEXT: only tests with it in their names."""
import functools
import os
import sys
import tempfile

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/app/python", ROOT + "/tests/gen"]
import bodies  # noqa: E402: from the paths above
import diptych  # noqa: E402
import gltf  # noqa: E402

RSM_SIZE, MAP_SIZE, FIRST_VPLS, SECOND_VPLS, CLUSTERS = 128, 64, 256, 256, 8
# The smallest sizes that keep the shape of the stages; a metric scale that the test knows.
SMALL = {"rsm_size": RSM_SIZE, "map_size": MAP_SIZE, "map_triangles": 10000, "cull_triangles": 16384, "second_vpls": SECOND_VPLS,
         "metrics.vpl_distance.scale": 0.5}
SPOT, DIRECTIONAL = (f"{ROOT}/tests/specs/{name}.yaml" for name in ("spot", "directional"))
LIGHT, TARGET = np.array([0.15, 0.5, 0.2]), np.array([0.556, 0.3, 0.35])  # of spot.yaml
WHITE, RED, GREEN = np.array([[0.725, 0.71, 0.68], [0.63, 0.065, 0.05], [0.14, 0.45, 0.091]])  # of cornell.mtl


def play(backend, *take, scene=SPOT, frames=1, **sets):
    """What the passes of the last frame of ssvp left."""
    with diptych.open(ROOT + "/templates/ssvp.yaml", backend, scene=scene, size=(50, 38), sets={**SMALL, **sets}) as pipeline:
        for _ in range(frames):
            left = pipeline.render(*take)
    return left


USUAL = ("vpls", "rsm_position", "rsm_triangle", "first.nearest", "second_vpl", "first.views", "first.reach", "radiance", "display")


@functools.cache
def usual(backend):
    """The same for several tests: with defaults, in the light of a spot."""
    return play(backend, *USUAL)


def near(value, expected, relative=0.0, absolute=0.0):
    value, expected = np.broadcast_arrays(np.asarray(value, float), np.asarray(expected, float))
    wrong = np.argwhere(~(np.abs(value - expected) <= absolute + relative * np.abs(expected)))
    if len(wrong):
        place = tuple(wrong[0])
        raise AssertionError(f"{len(wrong)} of {value.size} are off; {place}: {value[place]:.9g}, expected {expected[place]:.9g}")


def holds(truth, what):
    if not np.all(truth):
        raise AssertionError(what)


def dot(a, b):
    return (np.asarray(a, float) * b).sum(-1)


def length(a):
    return np.sqrt(dot(a, a))


# ---- Patterns ---------------------------------------------------------------------------------------


def radical_inverse(k):
    """van der Corput, base 2, digit by digit."""
    return sum((np.asarray(k) >> i & 1) * 0.5 ** (i + 1) for i in range(32))


def concentric(u, v):
    """Shirley, Chiu 1997, by the four triangles of the square."""
    a, b = 2 * np.asarray(u, float) - 1, 2 * np.asarray(v, float) - 1
    with np.errstate(all="ignore"):
        sides = [(a > -b) & (a > b), (a > -b) & (a <= b), (a <= -b) & (a < b)]
        r = np.select(sides, [a, b, -a], -b)
        phi = np.where(r == 0, 0, np.pi / 4 * np.select(sides, [b / a, 2 - a / b, 4 + b / a], 6 - a / b))
    return np.stack((r * np.cos(phi), r * np.sin(phi)), -1)


def hammersley_texels(n, size):
    """Columns and rows of n samples of a square image."""
    k = np.arange(n)
    return (k / n * size).astype(int), (radical_inverse(k) * size).astype(int)


def test_mips_hold_what_their_passes_wrote(backend):
    """tests/specs/mips.yaml: fill writes (x / 64, y / 64, 0.5, 1), halve takes every second texel, quarter every second of those
    from (1, 1) on. All are exact in rgba16f."""
    with diptych.open(ROOT + "/tests/specs/mips.yaml", backend, scene=SPOT, size=(9, 7)) as pipeline:
        left = pipeline.render(*(("pyramid", mip) for mip in range(3)))
        for mip, factor, start in (0, 1, 0), (1, 2, 0), (2, 4, 2):
            texels, size = left["pyramid", mip], 64 >> mip
            place = (factor * np.arange(size) + start) / 64
            holds(texels.shape == (size, size, 4), f"mip {mip}: {texels.shape}")
            holds(texels == np.stack(np.broadcast_arrays(place, place[:, None], 0.5, 1), -1), f"mip {mip}")


def test_sampling_patterns_and_metric_follow_their_formulas(backend):
    with diptych.open(ROOT + "/tests/specs/features.yaml", backend, scene=SPOT, size=(9, 7), sets={"bins": 37}) as pipeline:
        points = pipeline.render("histogram")["histogram"]
    u, v = np.arange(37) / 37, radical_inverse(np.arange(37))
    near(points["square"][:, 0], u, absolute=1e-7)
    holds(points["square"][:, 1] == v, "a dyadic fraction is exact")
    near(points["polar"], np.stack((np.cos(2 * np.pi * v), np.sin(2 * np.pi * v)), 1) * np.sqrt(u)[:, None], absolute=1e-6)
    near(points["concentric"], concentric(u, v), absolute=2e-6)
    apart = np.sqrt((u - 0.25) ** 2 + (v - 0.5) ** 2 + 0.75**2)
    near(points["apart"], 0.6 * apart / 2 + 0.4 * (1 - 0.8), absolute=1e-6)


def shift_of_frame(frame):
    """Roberts 2018: multiples of 1 / g and 1 / g2, with g the root of g3 = g + 1."""
    return np.array([frame / 1.32471795724474602596, frame / 1.32471795724474602596**2]) % 1


def count_at(vpls, positions):
    """VPLs at the position that the map has at their sample. On the border of two texels float and double may differ."""
    return np.sum(length(vpls["position"] - positions[:, :3]) < 1e-6)


def test_patterns_are_shifted_unless_reused(backend):
    """Without reuse the third frame's are: on the square, and on the disk in the square of the radius and in the angle."""
    left = play(backend, "vpls", "second_vpl", "rsm_position", *MAP, frames=3, reuse_pattern=0, second_by_flux=0)
    shift, k, n = shift_of_frame(2), np.arange(SECOND_VPLS), SECOND_VPLS // CLUSTERS
    square = np.stack((np.arange(FIRST_VPLS) / FIRST_VPLS, radical_inverse(np.arange(FIRST_VPLS))))
    columns, rows = ((square + shift[:, None]) % 1 * RSM_SIZE).astype(int)
    count = count_at(left["vpls"], left["rsm_position"][rows, columns])
    holds(count >= FIRST_VPLS * 98 // 100, f"{count} VPLs are at shifted samples")
    columns, rows = (square * RSM_SIZE).astype(int)
    count = count_at(left["vpls"], left["rsm_position"][rows, columns])
    holds(count <= FIRST_VPLS // 4, f"{count} VPLs are at samples that are not shifted")
    p = concentric(k % n / n, radical_inverse(k % n))
    radius, angle = np.sqrt((dot(p, p) + shift[0]) % 1), np.arctan2(p[:, 1], p[:, 0]) + 2 * np.pi * shift[1]
    columns, rows = map_texels(np.stack((radius * np.cos(angle), radius * np.sin(angle)), 1))
    count = count_at(left["second_vpl"], map_positions(left)[k // n, rows, columns])
    holds(count >= SECOND_VPLS * 98 // 100, f"{count} second VPLs are at shifted samples")


# ---- First bounce -----------------------------------------------------------------------------------


def spot_share(x):
    """Solid angle and falloff by hand: a sample is (2 tan outer)^2 / N of the image plane at distance 1."""
    axis, to = TARGET - LIGHT, x - LIGHT
    cosine = dot(axis, to) / (length(axis) * length(to))
    inner, outer = np.cos(np.radians((20, 40)))
    t = np.clip((cosine - outer) / (inner - outer), 0, 1)
    return t * t * (3 - 2 * t) * (2 * np.tan(np.radians(40))) ** 2 / FIRST_VPLS * cosine**3


def test_first_vpls_are_texels_of_the_map(backend):
    left = usual(backend)
    vpls, positions, triangles = left["vpls"], left["rsm_position"], left["rsm_triangle"]
    columns, rows = hammersley_texels(FIRST_VPLS, RSM_SIZE)
    x = positions[rows, columns].astype(float)
    holds(vpls["position"] == x[:, :3], "positions are those of the texels")
    share = np.where(x[:, 3] > 0, spot_share(x[:, :3]), 0)
    lit, intensity = share > 1e-9, np.array([2, 3, 4])
    holds(vpls["flux"][~lit] < 1e-9, "what the light does not reach is dark")
    rho = vpls["flux"][lit] / (intensity * share[lit, None])
    nearest = np.abs(rho[:, None] - (WHITE, RED, GREEN)).sum(2).argmin(1)
    near(rho, np.array([WHITE, RED, GREEN])[nearest], relative=1e-4)
    holds(FIRST_VPLS // 2 <= lit.sum(), "most are lit")
    # The normal has length 1, faces the light, and is perpendicular to the triangle: texels beside show its plane.
    normal = vpls["normal"]
    near(dot(normal, normal)[lit], 1, relative=1e-5)
    holds(dot(normal, LIGHT - x[:, :3])[lit] > 0, "normals face the light")
    for right, up in (-1, 0), (0, -1), (1, 0), (0, 1):
        column, row = np.clip(columns + right, 0, RSM_SIZE - 1), np.clip(rows + up, 0, RSM_SIZE - 1)
        along = positions[row, column, :3].astype(float) - x[:, :3]
        same = lit & (triangles[row, column] == triangles[rows, columns]) & (length(along) > 0)
        near(dot(along, normal)[same] / length(along)[same], 0, absolute=1e-3)


def test_directional_flux_is_irradiance_times_area(backend):
    """All flux that parallel light brings onto the box's roof: irradiance times the roof's area."""
    flux = play(backend, "vpls", scene=DIRECTIONAL)["vpls"]["flux"]
    near(flux.astype(float).sum(0), np.array([5, 6, 7]) * WHITE * 0.556 * 0.5592, relative=0.03)


def test_first_vpls_stand_for_the_surface_of_their_texels(backend):
    """RSM_SIZE^2 / FIRST_VPLS texels like its own, where the texels beside lie in the plane of its normal."""
    left = usual(backend)
    vpls, positions = left["vpls"], left["rsm_position"].astype(float)
    columns, rows = hammersley_texels(FIRST_VPLS, RSM_SIZE)
    inside = (columns < RSM_SIZE - 1) & (rows < RSM_SIZE - 1) & (vpls["flux"][:, 0] > 0)
    vpls, columns, rows = vpls[inside], columns[inside], rows[inside]
    at, right, up = positions[rows, columns], positions[rows, columns + 1], positions[rows + 1, columns]
    u, v = right[:, :3] - at[:, :3], up[:, :3] - at[:, :3]
    flat = (np.abs(dot(u, vpls["normal"])) <= 1e-3 * length(u)) & (np.abs(dot(v, vpls["normal"])) <= 1e-3 * length(v))
    flat &= (at[:, 3] > 0) & (right[:, 3] > 0) & (up[:, 3] > 0)
    holds(flat.sum() > FIRST_VPLS // 4, f"{flat.sum()} could be judged")
    near(vpls["area"][flat], (length(np.cross(u, v)) * RSM_SIZE * RSM_SIZE / FIRST_VPLS)[flat], relative=0.1)


# ---- Clusters ---------------------------------------------------------------------------------------


def test_clusters_are_those_of_kmeans(backend):
    """Each label is the argmin over the centres, its margin the difference to the next best; each mean is that of its members.
    Frame 3 starts from frame 2's means."""
    left = play(backend, "vpls", "first.labels", "first.margins", "first.centres", frames=3)
    vpls, labels, margins, centres = left["vpls"], left["first.labels"], left["first.margins"], left["first.centres"]
    lives = vpls["flux"].sum(1) > 0
    holds((labels[~lives] == -1) & (margins[~lives] == -1), "VPLs without flux have no label")
    vpls, labels, margins = vpls[lives], labels[lives], margins[lives]
    apart = length(vpls["position"][:, None] - centres["position"].astype(float))
    agreement = dot(vpls["normal"][:, None].astype(float), centres["normal"])
    distance = 0.6 * apart / 0.5 + 0.4 * (1 - np.maximum(agreement, 0))
    own = np.take_along_axis(distance, labels[:, None], 1)[:, 0]
    holds(own <= distance.min(1) + 1e-6, "labels are nearest")
    np.put_along_axis(distance, labels[:, None], np.inf, 1)
    near(margins, distance.min(1) - own, absolute=2e-6)
    for c, centre in enumerate(centres):
        members = vpls[labels == c]
        holds(len(members) == centre["members"], f"cluster {c} has {len(members)} members")
        if len(members):
            near(centre["mean"], members["position"].astype(float).mean(0), relative=1e-5, absolute=1e-6)
            normal = members["normal"].astype(float).sum(0)
            if length(normal) > 0.02 * len(members):
                near(centre["mean_normal"], normal / length(normal), relative=1e-4, absolute=1e-5)


def test_clusters_begin_anew_unless_reused(backend):
    """In a still scene, k-means that begins anew ends in every frame as in the first. From the last centres it goes on."""
    once, anew, on = (play(backend, "first.centres", kmeans_iterations=1, **more)["first.centres"]["mean"]
                      for more in ({}, {"frames": 3, "reuse_centres": 0, "reuse_pattern": 1}, {"frames": 3, "reuse_pattern": 1}))
    holds(anew == once, "anew")
    holds((on != once).any(), "goes on")


# ---- Maps and the second bounce ---------------------------------------------------------------------

MAP = ("first.views", "first.reach")


def map_positions(left):
    """Surfaces in the maps of clusters: positions, and 1 on a surface, else 0. A texel's ray is (p, sqrt(2) (1 - max |p|)) in the
    frame of the map (Cigolle et al. 2014); the map has the distance along it. In the first frame, these are the first of the
    maps that are kept."""
    views, reach = left["first.views"], left["first.reach"].astype(float)[:CLUSTERS]
    p = (2 * np.arange(reach.shape[-1]) + 1) / reach.shape[-1] - 1
    x, y = np.broadcast_arrays(p, p[:, None])
    local = np.stack((x, y, np.sqrt(2) * (1 - np.maximum(np.abs(x), np.abs(y)))), -1)
    frame = np.stack((views["tangent"], views["bitangent"], views["normal"]), 1).astype(float)
    surface = reach < 1e29
    ray = np.einsum("yxi,cij->cyxj", local, frame) * np.where(surface, reach, 0)[..., None]
    return np.concatenate((views["position"][:, None, None] + ray, surface[..., None]), -1)


def map_texels(disk):
    """Columns and rows of the map's texels in the directions that points of the unit disk have in paraboloid projection."""
    edge = 2 * np.abs(disk).max(-1)
    reach = edge + (1 - dot(disk, disk)) / np.sqrt(2)
    return np.clip((disk / reach[:, None] + 0.5) * MAP_SIZE, 0, MAP_SIZE - 1).astype(int).T


def test_second_bounce_flux_is_as_derived(backend):
    """Phi_2 = rho Phi_C 4 (1 - r^2) / ((1 + r^2)^3 N), with rho from the texel under the disk point, and Phi_C the flux of the
    VPLs that use the map. By flux, VPL k stands at (k + 1/2) / N of the sum of the clusters' powers; else all have equal shares."""
    k = np.arange(SECOND_VPLS)
    for by_flux in 1, 0:
        left = usual(backend) if by_flux else play(backend, "vpls", "first.nearest", "second_vpl", *MAP, second_by_flux=0)
        vpls, eyes, second = left["vpls"], left["first.nearest"], left["second_vpl"]
        holds((eyes >= -1) & (eyes < CLUSTERS), "eyes are views")
        flux = np.stack([vpls["flux"][eyes == c].astype(float).sum(0) for c in range(CLUSTERS)])
        power, n = flux.sum(1), SECOND_VPLS // CLUSTERS
        cluster, number, u, v = k // n, np.full(SECOND_VPLS, n), k % n / n, radical_inverse(k % n)
        if by_flux:
            ends, place = np.cumsum(power), (k + 0.5) / SECOND_VPLS * power.sum()
            cluster = np.searchsorted(ends, place)
            number = SECOND_VPLS * power[cluster] / power.sum()
            u, v = (place - (ends - power)[cluster]) / power[cluster], radical_inverse(k)
        point = concentric(u, v)
        s = np.minimum(dot(point, point), 1)
        weight = 4 * (1 - s) / ((1 + s) ** 3 * number)
        near(weight.sum() / CLUSTERS, 1, relative=0.1 if by_flux else 0.03)  # the integral over the disk; 32 points come near
        columns, rows = map_texels(point)
        x = map_positions(left)[cluster, rows, columns]
        same = length(second["position"] - x[:, :3]) <= 1e-6  # on the border of two texels float and double may differ
        holds(same.sum() >= SECOND_VPLS * 97 // 100, f"{same.sum()} are at their texels")
        side = np.abs(second["normal"][:, 0]) > 0.9  # red and green are the side walls
        rho = np.select([(side & (x[:, 0] > 0.54))[:, None], (side & (x[:, 0] < 0.001))[:, None]], [RED, GREEN], WHITE)
        expected = np.where(x[:, 3:] > 0, rho * flux[cluster] * weight[:, None], 0)
        near(second["flux"][same], expected[same], relative=1e-3, absolute=1e-9)
        total = second["flux"][same].astype(float).sum() / flux.sum()
        holds(0.1 < total < 1, f"the second bounce has {total} of the first")


def write_ball(folder):
    """A ball with bumps, seen from within: 9,400 triangles, none of which lie in one plane and overlap. Equal depths would go to
    the triangle that is drawn first."""
    around, down = 80, 60
    theta, phi = np.meshgrid(np.pi * np.arange(down + 1) / down, 2 * np.pi * np.arange(around) / around, indexing="ij")
    r = 1 + 0.15 * np.sin(7 * theta) * np.sin(5 * phi)
    points = np.stack((r * np.sin(theta) * np.cos(phi), r * np.cos(theta), r * np.sin(theta) * np.sin(phi)), -1).reshape(-1, 3)
    v, u = (array.ravel() for array in np.meshgrid(np.arange(down), np.arange(around), indexing="ij"))
    a, b = v * around + u + 1, v * around + (u + 1) % around + 1
    faces = np.stack((a, b, b + around, a, b + around, a + around), 1).reshape(-1, 3)
    with open(folder + "/ball.obj", "w", encoding="utf-8") as file:
        file.writelines("v {:.6f} {:.6f} {:.6f}\n".format(*point) for point in points)
        file.writelines("f {} {} {}\n".format(*face) for face in faces)
    with open(folder + "/ball.yaml", "w", encoding="utf-8") as file:
        file.write("mesh: ball.obj\ncamera: {eye: [0, 0, 0.3], target: [0, 0, -1], fov_y: 60}\n"
                   "light: {kind: spot, position: [0, 0.1, 0], target: [1, 0.3, 0.2], cone: [30, 40], intensity: [9, 9, 9]}\n")


def test_culling_changes_no_texel(backend):
    """A map draws the whole scene, or a list of the triangles that can show in it; it shows the same either way, and second-bounce
    VPLs find the same surface. The whole scene is drawn where culling removes too few triangles or the list finds no room."""
    shown, lists = ("first.reach", "second_vpl", "second.reach"), ("first.map.draws", "first.map.whole_draws")
    with tempfile.TemporaryDirectory() as folder:
        write_ball(folder)
        whole, some, all_listed = (play(backend, *shown, *lists, scene=folder + "/ball.yaml", **sets)
                                   for sets in ({"cull_triangles": 1}, {"map_triangles": 3000}, {}))
    for left in some, all_listed:
        holds([(left[name] == whole[name]).all() for name in shown], "the same is shown")
    listed, drawn = (np.array([left[name]["index_count"].sum() for left in (whole, some, all_listed)]) for name in lists)
    holds(listed[0] == 0 < drawn[0] and listed[1] > 0 < drawn[1] and drawn[2] == 0, f"{listed} listed, {drawn} drawn")
    holds(listed[2] < drawn[0], "the list is shorter")


# ---- Shading ----------------------------------------------------------------------------------------


def test_second_bounce_irradiance_is_the_sum_of_its_class(backend):
    """Without visibility, the second bounce adds to a pixel the sum over its class of (Phi/pi) cos cos / (d^2 + disk cos), times
    the number of classes."""
    for softness in 0, 1:
        first = play(backend, "irradiance", bounces=1, second_clusters=0, softness=softness)["irradiance"].astype(float)
        left = play(backend, "irradiance", "gbuffer_position", "gbuffer_normal", "second.shading", bounces=2, second_clusters=0,
                    softness=softness)
        both, x, n = (left[name].astype(float) for name in ("irradiance", "gbuffer_position", "gbuffer_normal"))
        height, width = x.shape[:2]
        pixel_class = np.arange(width) % 4 + 4 * (np.arange(height)[:, None] % 4)
        vpls = left["second.shading"].reshape(16, -1)[pixel_class]  # of each pixel
        w = x[..., None, :3] - vpls["position"]
        square, leaving = dot(w, w), np.maximum(dot(w, vpls["normal"]), 0)
        arriving = np.maximum(-dot(w, n[..., None, :3]), 0)
        with np.errstate(all="ignore"):
            terms = vpls["flux"][..., 1] / np.pi * leaving * arriving
            terms = terms / (square * (square + vpls["disk"] * leaving / np.sqrt(square)))
        total = np.where(square > 0, terms, 0).sum(-1)
        # near a VPL the term diverges, and half floats overflow
        judged = (x[..., 3] > 0) & (np.minimum(square.min(-1), 1) >= 1e-4)
        holds(judged.sum() > 1000, f"{judged.sum()} pixels")
        off = np.abs(both[..., 1] - first[..., 1] - 16 * total)
        holds((off <= 2e-3 * 16 * total + 2e-3 * (first[..., 1] + both[..., 1]) + 1e-5)[judged], f"off by {off[judged].max()}")


def reach_of(origins, rays, triangles):
    """How often each ray reaches to the first triangle (Moeller, Trumbore 1997); infinity: it hits none."""
    a, edges = triangles[:, 0], triangles[:, 1:] - triangles[:, :1]
    normal, t = np.cross(edges[:, 0], edges[:, 1]), origins[:, None] - a
    with np.errstate(all="ignore"):
        scale = -1 / (rays @ normal.T)
        across = np.cross(t, rays[:, None])
        u, v, reach = dot(across, edges[:, 1]) * scale, -dot(across, edges[:, 0]) * scale, dot(t, normal) * scale
        return np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (reach > 0), reach, np.inf).min(1)


def test_maps_show_what_rays_hit_first(backend):
    """500 texels, which the R2 sequence spreads over all maps that are kept in three frames; with 8 per frame, those of one look into
    too few directions. The ray of reach 1 through a texel's centre is that of Cigolle et al. 2014."""
    left = play(backend, *(f"{bounce}.{name}" for bounce in ("first", "second") for name in ("eyes", "reach")), frames=3)
    scene = gltf.Scene(SPOT)
    triangles = scene.vertices["position"][scene.indices.reshape(-1, 3)].astype(float)
    for bounce in "first", "second":
        eyes, maps = left[bounce + ".eyes"], left[bounce + ".reach"]
        k = np.arange(2000)
        k = k[eyes["used"][k % len(eyes)] != 0][:500]
        eye, texel = k % len(eyes), (np.outer((0.7548776662, 0.5698402910), k) % 1 * MAP_SIZE).astype(int)
        p = (2 * texel + 1) / MAP_SIZE - 1
        axes = [eyes[name][eye].astype(float) for name in ("tangent", "bitangent", "normal")]
        rays = sum(axis * part[:, None] for axis, part in zip(axes, (*p, np.sqrt(2) * (1 - np.abs(p).max(0)))))
        reach = reach_of(eyes["position"][eye].astype(float), rays, triangles)
        found = maps[eye, texel[1], texel[0]].astype(float).reshape(len(k), -1)[:, 0]
        right = np.where(np.isinf(reach), found > 1e29, np.abs(found - reach) <= 1e-3 * reach)
        holds(len(k) == 500 and (~right).sum() <= 2, f"{bounce}: {(~right).sum()} of {len(k)} texels are wrong")


def test_display_is_reinhards_curve_of_radiance(backend):
    """Reinhard et al. 2002, Equations 1, 2 and 4 on luminance, IEC 61966-2-1, with the defaults a = 0.18, white = 4."""
    left = usual(backend)
    radiance = left["radiance"].astype(float)
    luminance, surface = radiance[..., :3] @ (0.2126, 0.7152, 0.0722), radiance[..., 3] > 0
    holds(surface.sum() > 1000, "surfaces are seen")
    scale = 0.18 / np.exp(np.log(0.001 + luminance[surface]).mean())
    s = luminance * scale
    v = np.minimum(radiance[..., :3] * (scale * (1 + s / 16) / (1 + s))[..., None], 1)
    v = np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)
    near(left["display"][..., :3], v * 255, absolute=0.52)


if __name__ == "__main__":
    bodies.run_tests(globals(), ("gl", "vk"), "".join(sys.argv[1:]), (AssertionError, diptych.Error), drawn=True)
