"""Scenes, meshes, textures, cameras, lights and motions against facts from outside: published measurements, formulas, invariants of
closed surfaces. Fixtures live in a temporary folder; scene-print tells what a scene holds. Prints TAP; called by scenes_test.sh."""
import json
import os
import struct
import sys
import zlib

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/app/python", ROOT + "/tests/gen"]
import bodies  # noqa: E402: from the paths above
from diptych.png import encode_png  # noqa: E402
from gltf import CAMERA, CORNERS, SUN, Scene, document, holds, load, near, put, refused  # noqa: E402

SPOT = "light: {kind: spot, position: [0, 2, 0], target: [0, 0, 0], cone: [25, 35], intensity: [1, 1, 1]}\n"
BOX = ("v 0 0 0\nv 4 0 0\nv 4 1 0\nv 0 1 0\nv 0 0 3\nv 4 0 3\nv 4 1 3\nv 0 1 3\n"
       "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n")


def corners_of(scene):
    """Positions, by triangle and corner."""
    return scene.vertices["position"][scene.indices].reshape(-1, 3, 3).astype(float)


def area_vectors(corners):
    """Twice the areas, along the faces' normals."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def lengths(v):
    return np.sqrt((v * v).sum(-1))


def albedo_of(scene):
    """Of each triangle."""
    return scene.materials["albedo"][scene.vertices["material"][scene.indices[::3]]]


def material_of(scene, triangle):
    return scene.materials[scene.vertices["material"][scene.indices[3 * triangle]]]


def yaml_scene(text, *more):
    put("scene.yaml", text)
    scene = Scene("scene.yaml", *more)
    holds(scene.loaded, scene.told)
    return scene


# ---- Meshes -----------------------------------------------------------------------------------------


def test_a_box_is_closed_and_faces_outwards():
    """In a closed surface without T-junctions every edge from p to q has exactly one partner from q to p."""
    put("box.obj", BOX)
    scene = load("box.obj")
    corners = corners_of(scene)
    edges = [(tuple(a + 0.0), tuple(b + 0.0)) for triangle in corners for a, b in zip(triangle, np.roll(triangle, -1, 0))]
    holds(len(set(edges)) == len(edges) == 36 and all((b, a) in set(edges) for a, b in edges), "closed")
    vectors, normals = area_vectors(corners), scene.vertices["normal"][scene.indices].reshape(-1, 3, 3)
    near(lengths(vectors).sum() / 2, 2 * (4 * 1 + 4 * 3 + 1 * 3), 1e-4)
    holds((vectors * (corners[:, 0] - [2, 0.5, 1.5])).sum(1) > 0, "outwards")
    near((normals * (vectors / lengths(vectors)[:, None])[:, None]).sum(-1), 1, 1e-4)
    holds(scene.vertices["triangle"][scene.indices[::3]] == np.arange(12), "numbers")
    near(scene.frames[0]["scene_radius"], np.sqrt(16 + 1 + 9) / 2, 1e-5)
    holds((scene.source, scene.degenerate) == (12, 0), "counts")


def test_odd_obj_is_read_and_triangles_without_area_are_dropped():
    """Tabs, carriage returns and negative indices as the archive's Cornell Boxes have them."""
    put("odd.obj", "# odd\r\nv\t0 0 0\r\nv\t1  0 0   \r\nv\t1 1 0\r\nv\t0 1 0\r\nf -4 -3 -2 -1\r\n"
        "v 0.5 0 0\r\nf 1 2 2\r\nf 1 5 2\r\nf 1 2 4\r\n")
    scene = load("odd.obj", "scale: 2\n")
    holds((scene.source, scene.degenerate, len(scene.indices), scene.count("info")) == (5, 2, 9, 1), "counts")
    holds((*scene.high[:2], scene.low[0]) == (2, 2, 0), "bounds")
    near(lengths(scene.vertices["normal"]), 1, 1e-5)


def test_wrong_indices_have_a_line():
    for face, text in (("f 1 2 9", "vertex 9, and the file has 3"), ("f 3 2 -4", "vertex -4, and the file has 3"),
                       ("f 0 1 2", "vertex 0, and the file has 3"), ("f 1/1 2/2 3/1", "texture coordinate 2, and the file has 1"),
                       ("f 1//1 2//7 3//1", "normal 7, and the file has 1")):
        put("i.obj", f"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n{face}\n")
        refused(f"i.obj:6: error: a face has the {text}", "i.obj")
    put("i.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")
    refused("i.ply: a face has the index 7, and there are 3 vertices", "i.ply")


def test_material_libraries_are_found():
    """Materials that cannot be read are not left out."""
    put("l.obj", "mtllib k.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n")
    refused("k.mtl: not found; ", "l.obj")
    put("l.mtl", "newmtl a\nKd 1 0 0\n")  # assimp tries the name of the mesh
    scene = load("l.obj", quiet=False)
    holds("k.mtl: not found; " in scene.told and material_of(scene, 0)["albedo"][1] == 0, scene.told)
    os.mkdir("k.mtl")
    refused("k.mtl: Is a directory", "l.obj")
    os.rmdir("k.mtl")
    put("k.mtl", "new".encode("utf-16"))
    refused("k.mtl: UTF-16 text", "l.obj")


def test_texture_coordinates_of_corners_are_told():
    put("c.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
        "3 0 1 2 6 0 0 1 0 0 1\n")
    scene = load("c.ply", quiet=False)
    holds("c.ply: texture coordinates of corners" in scene.told and scene.count("warning") == 1, scene.told)


def test_vertex_colours_are_told_once():
    put("v.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0 0 1 1 1 1\ng a\nf 1 2 3\ng b\nf 1 2 4\n")
    scene = load("v.obj", quiet=False)
    holds("v.obj: vertex colours are not supported" in scene.told and scene.count("warning") == 1, scene.told)


def test_refused_models_are_named():
    for name, start, text in (("w.obj", b"\xfe\xff", "; the file is UTF-16 text"), ("w.obj", "<!DOCTYPE html>", "; the file is a web page"),
                              ("w.obj", "version https://git-lfs.github.com/spec/v1\n", "the file is a pointer of Git LFS"),
                              ("w.ply", b"\x1f\x8b\b", "; the file is compressed by gzip"), ("w.gltf", "", "; the file is empty")):
        put(name, start)
        refused(text, name)


def put_gltf(name, **more):
    tree, data = document(CORNERS, buffer={"uri": "t.bin"}, **more)
    put("t.bin", data)
    put(name, json.dumps(tree))


def test_gltf_nodes_are_flattened():
    """A mirror turns the winding; the front must stay +z."""
    put_gltf("t.gltf", nodes=[{"translation": [10, 0, 0], "children": [1]}, {"scale": [-2, 3, 1], "mesh": 0}], primitive={"material": 0},
             materials=[{"pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 0.75, 1]}}])
    scene = load("t.gltf")
    holds((*scene.low[:1], *scene.high[:2], len(scene.indices), len(scene.objects)) == (8, 10, 3, 3, 1), "bounds and counts")
    holds(area_vectors(corners_of(scene))[0, 2] > 0 and (scene.vertices["normal"][:, 2] > 0.999).all(), "front")
    one = scene.objects[0]
    near((one["transform"][0, :3], one["transform"][3, :3], one["inverse"][3, :3], one["center"]),
         [[-2, 0, 0], [10, 0, 0], [5, 0, 0], [9, 1.5, 0]], 1e-5)
    near(one["radius"], np.hypot(1, 1.5), 1e-5)
    holds((one["first_index"], one["index_count"], one["mesh"]) == (0, 3, 0), "places")
    holds(scene.materials[one["material"]]["albedo"] == [0.25, 0.5, 0.75], "albedo")


def put_viewed_gltf():
    """A camera below a moved node; a bulb, a lamp and a sun below one that turns z to x."""
    def light(name, number, **more):
        return {"name": name, "extensions": {"KHR_lights_punctual": {"light": number}}, **more}
    lights = [{"type": "point"}, {"type": "spot", "intensity": 683, "color": [1, 0.5, 0.25],
                                  "spot": {"innerConeAngle": 0.3, "outerConeAngle": 0.6}}, {"type": "directional", "intensity": 1366}]
    put_gltf("v.gltf", scenes=[{"nodes": [0, 2]}], cameras=[{"type": "perspective", "perspective": {
        "yfov": 0.8, "aspectRatio": 1.5, "znear": 0.1}}], extensionsUsed=["KHR_lights_punctual"],
        extensions={"KHR_lights_punctual": {"lights": lights}}, nodes=[
            {"mesh": 0, "translation": [10, 0, 0], "children": [1]}, {"name": "eye", "camera": 0, "translation": [1, 2, 3]},
            {"rotation": [0, 0.7071068, 0, 0.7071068], "children": [3, 4, 5]}, light("bulb", 0), light("lamp", 1, translation=[0, 0, 1]),
            light("sun", 2)])


def test_gltf_brings_camera_and_light():
    put_viewed_gltf()
    scene = yaml_scene("mesh: v.gltf\nscale: 2\n")
    holds(scene.count("info") == 2, "tells which")
    near(scene.camera, [22, 4, 6, 22, 4, 5, 0, 1, 0, 0.8], 1e-5)
    light = scene.frames[0]["light"]  # the bulb is passed over
    near((light["position"], light["direction"], light["color"]), [[2, 0, 0], [-1, 0, 0], [1, 0.5, 0.25]], 1e-5)  # 683 lm/W
    holds(light["kind"] == 1, "a spot")
    near(light["cos_outer"], np.cos(0.6), 1e-5)
    scene = yaml_scene("mesh: v.gltf\nlight: sun\n" + CAMERA)
    light = scene.frames[0]["light"]
    near((scene.camera[:3], light["direction"], light["color"]), [[0, 0, 5], [-1, 0, 0], [2, 2, 2]], 1e-5)
    holds(light["kind"] == 0 and 0 < light["area"] < 1, "its view covers the scene")


# ---- Textures ---------------------------------------------------------------------------------------

TEXTURED = ("mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\n"
            "usemtl c\nf 1/1 2/2 3/3\n")


def put_checker(name, alpha_of_black):
    white = np.add.outer(np.arange(4), np.arange(4)) % 2 == 1
    texels = np.where(white[..., None], 255, [0, 0, 0, alpha_of_black]).astype("u1")
    put(name, encode_png(texels))


def textured(mtl, keys="", quiet=True):
    put("t.obj", TEXTURED)
    put("t.mtl", mtl)
    return load("t.obj", keys, quiet)


def test_textures_fill_the_array():
    """Kd 0 beside a map is white. Half of white light is sRGB code 188; behind holes nothing dark bleeds in, and coverage is a half.
    The obj file counts v from below; row 0 of the texels is the top."""
    put_checker("opaque.png", 255)
    put_checker("holes.png", 0)
    scene = textured("newmtl a\nKd 0 0 0\nmap_Kd opaque.png\nnewmtl b\nKd 0.5 0.5 0.5\nmap_Kd holes.png\n"
                     "newmtl c\nKd 0.1 0.2 0.3\nmap_Kd none.png\n", quiet=False)
    holds((scene.layers, scene.width, scene.mips) == (2, 4, 3), "the array")
    a, b, c = (material_of(scene, i) for i in range(3))
    holds(a["albedo"][0] == 1 and a["texture"] >= 0 and a["alpha_cutoff"] == 0, "opaque")
    holds(b["albedo"][0] == 0.5 and b["texture"] >= 0 and b["alpha_cutoff"] == 0.5, "with holes")
    holds(c["albedo"][2] == np.float32(0.3) and c["texture"] == -1 and c["alpha_cutoff"] == 0, "without a file")
    holds(scene.count("warning") == 1 and "none.png" in scene.told, scene.told)
    mip1, mip2 = scene.texels[2 * 64:], scene.texels[2 * (64 + 16):]
    found = mip1[16 * a["texture"]], mip2[4 * a["texture"]], *mip2[4 * b["texture"]:][[0, 3]]
    holds(found == (188, 188, 255, 128), f"mips: {found}")
    holds(scene.vertices["uv"][scene.indices[0], 1] == 1, "v")


def test_textures_keep_their_numbers():
    """Grey codes of linear light, as the file says."""
    gamma = b"gAMA" + struct.pack(">I", 100000)
    whole = encode_png(np.array([[10, 200]], "u1"))
    put("linear.png", whole[:33] + struct.pack(">I", 4) + gamma + struct.pack(">I", zlib.crc32(gamma)) + whole[33:])
    scene = textured("newmtl a\nmap_Kd linear.png\nnewmtl b\nnewmtl c\n", "texture_size: 2\n", quiet=False)
    holds("linear.png: its colour space is linear; its numbers are taken as sRGB codes" in scene.told, scene.told)
    holds(scene.count("warning") == 1 and tuple(scene.texels[[0, 4]]) == (10, 200), "codes")


def test_an_opacity_map_becomes_alpha():
    put_checker("opaque.png", 255)
    scene = textured("newmtl a\nKd 1 1 1\nmap_Kd opaque.png\nmap_d opaque.png\nnewmtl b\nnewmtl c\n", "texture_size: 4\n")
    texels = scene.texels[:64].reshape(-1, 4)
    holds(scene.layers == 1 and material_of(scene, 0)["alpha_cutoff"] == 0.5 and (texels[:, 3] == texels[:, 0]).all(), "alpha")


def test_textures_have_a_budget():
    """One file by three names, of which one is a link, is one layer; what takes too much memory or time is refused before a texture is
    read."""
    mtl = "newmtl a\nmap_Kd opaque.png\nnewmtl b\nmap_Kd ././opaque.png\nnewmtl c\nmap_Kd link.png\n"
    put_checker("opaque.png", 255)
    os.symlink("opaque.png", "link.png")
    scene = textured(mtl, "texture_size: 8\n")
    holds(scene.layers == 1 and material_of(scene, 0)["texture"] == material_of(scene, 2)["texture"], "one layer")
    for count, text in (25, "26 textures of 4096x4096 take 2218 MiB; 2048 is the limit"), (9, "for 10 layers of 4096x4096, in files of "):
        put("t.mtl", mtl + "".join(f"newmtl m{i}\nmap_Kd none{i}.png\n" for i in range(count)))
        refused(text, "t.obj\ntexture_size: 4096")
    put("t.mtl", "".join(f"newmtl {name}\nmap_Kd {name}.pgm\n" for name in "abc"))
    for name in "abc":
        put(name + ".pgm", "P5 8000 8000 255\n")
    refused("the scene's textures have 192000000 pixels", "t.obj")


# ---- Shipped scenes ---------------------------------------------------------------------------------


def test_the_cornell_box_has_the_published_measures():
    scene = Scene(ROOT + "/scenes/cornell.yaml")
    holds((scene.layers, scene.width, scene.source) == (1, 1, 30) and (scene.texels == 255).all(), "one white texel")
    near(scene.high[:2], [0.556, 0.5488], 1e-6)
    vectors, red = area_vectors(corners_of(scene)), albedo_of(scene)[:, 0]
    # the tops of the blocks by the shoelace formula
    tops = 0.5 * abs((130 - 240) * (225 - 114) - (82 - 290) * (65 - 272)) + 0.5 * abs((423 - 314) * (296 - 406) - (265 - 472) * (247 - 456))
    for albedo, normal, published in ((0.725, [0, 1, 0], 0.5 * (552.8 + 549.6) * 559.2 + tops), (0.725, [0, -1, 0], 556 * 559.2),
                                      (0.725, [0, 0, -1], 0.5 * (549.6 + 556) * 548.8), (0.14, [1, 0, 0], 559.2 * 548.8)):
        chosen = (np.abs(red - albedo) < 1e-4) & (vectors @ normal > 0.999 * lengths(vectors))
        near(lengths(vectors[chosen]).sum() / 2 * 1e6, published, 1e-4 * published)


def test_the_atrium_is_heavy_and_faces_outward():
    """Closed solids that face outward enclose a positive volume."""
    scene = Scene(ROOT + "/scenes/atrium.yaml")
    holds(scene.loaded and scene.source > 100000 and scene.degenerate == 0, scene.told)
    corners, normals = corners_of(scene), scene.vertices["normal"][scene.indices].reshape(-1, 3, 3)
    near(lengths(normals), 1, 1e-5)
    vectors = area_vectors(corners)
    holds((normals * vectors[:, None]).sum(-1) > 0, "normals")
    holds((corners[:, 0] * vectors).sum() > 0, "volume")


# ---- Frames -----------------------------------------------------------------------------------------


def project(matrix, points):
    """matrix: by columns."""
    points = np.asarray(points, float)
    clip = points @ matrix[:3].astype(float) + matrix[3]
    return clip[..., :3] / clip[..., 3:]


def has_its_inverse(view):
    x, y = np.meshgrid([-0.9, 0, 0.9], [-0.7, 0, 0.7])
    places = np.stack((x, y, np.full_like(x, 0.5)), -1)
    near(project(view["view_projection"], project(view["inverse_view_projection"], places)), places, 1e-4)


def test_the_camera_projects_known_points():
    """y is up, and the world's -x is to the right: red on the left, green on the right."""
    scene = Scene(ROOT + "/scenes/cornell.yaml")
    frame = scene.frames[0]  # of 200 x 100
    camera, reach = frame["camera"], 0.8 * np.tan(np.radians(39.3 / 2))
    found = project(camera["view_projection"], [[0.278, 0.273, 0], [0.278 - reach, 0.273 + reach, 0],
                                                [0.278, 0.273, camera["near_plane"] - 0.8], [0.278, 0.273, camera["far_plane"] - 0.8]])
    near(found[:2, :2], [[0, 0], [0.5, 1]], 1e-5)
    near(found[2:, 2], [0, 1], 1e-4)
    seen, red = project(camera["view_projection"], corners_of(scene)), albedo_of(scene)[:, 0]
    holds((seen[..., 2] >= 0) & (seen[..., 2] <= 1), "depths")
    holds(((seen[..., 0] < 0) == (red > 0.5)[:, None])[red < 0.7], "sides")
    has_its_inverse(camera)
    has_its_inverse(frame["light_view"])
    holds((frame["width"], frame["height"], frame["index"]) == (0, 0, 0), "the rest")


def test_a_spot_views_its_cone():
    """A point on the rim of the outer cone lies on the circle of radius 1 about the view's axis."""
    frame = Scene(ROOT + "/scenes/cornell.yaml").frames[0]
    light, width = frame["light"], np.tan(np.radians(35))
    near(light["area"], 4 * width**2, 1e-5)
    near((light["cos_inner"], light["cos_outer"]), np.cos(np.radians([25, 35])), 1e-6)
    axis = light["direction"].astype(float)
    side = np.cross(axis, [0, 0, 1])
    rim = light["position"] + 0.2 * (axis + width * side / lengths(side))
    near(np.hypot(*project(frame["light_view"]["view_projection"], rim)[:2]), 1, 1e-5)


def test_a_suns_view_holds_the_scene():
    """From straight above the box shows 4 x 3; a thin margin is allowed."""
    put("box.obj", BOX)
    scene = yaml_scene("mesh: box.obj\n" + CAMERA + "light: {kind: directional, direction: [0, -2, 0], irradiance: [1, 2, 3]}\n")
    frame = scene.frames[0]
    holds(12 <= frame["light"]["area"] < 12 * 1.04, "area")
    near(frame["light"]["direction"][1], -1, 1e-6)
    seen = project(frame["light_view"]["view_projection"], corners_of(scene))
    holds((np.abs(seen[..., :2]) < 1).all() and ((seen[..., 2] > 0) & (seen[..., 2] < 1)).all(), "all is seen")
    has_its_inverse(frame["light_view"])


def test_an_opening_bounds_a_suns_view():
    """Light that falls aslant sees a hole of 1 x 0.5 foreshortened: 0.5 times the cosine."""
    put("box.obj", BOX)
    frame = yaml_scene("mesh: box.obj\n" + CAMERA + "light: {kind: directional, direction: [1, -1, 0], irradiance: [1, 2, 3],\n"
                       "  opening_min: [1, 0.5, 1], opening_max: [2, 0.5, 1.5]}\n").frames[0]
    margin = 2 * 0.005 * frame["scene_radius"]
    near(frame["light"]["area"], (np.sqrt(0.5) + margin) * (0.5 + margin), 1e-4)


# ---- Diagnostics ------------------------------------------------------------------------------------


def wrong(scene, name, *lines):
    holds(scene.count("error") == 1, scene.told)
    for line in lines:
        holds(f"{name}:{line}" in scene.told, f"no line '{line}' in\n{scene.told}")


def test_wrong_scene_files_are_told_in_one_run():
    put("box.obj", BOX)
    put_viewed_gltf()
    box, sun = "mesh: box.obj\n" + CAMERA, "light: {kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1],\n"
    for text, *lines in (
            ("mesh: box.obj\nscal: 2\ncamera: {eye: [0, x, 1.0], target: [0, 1]}\nlight: {kind: spot, position: [0, 0, 0], "
             "direction: [0,1,0], cone: [25, 95], intensity: [1, 1, 1]}\ntexture_size: 300\n",
             "2:1: error: unknown key `scal`; did you mean `scale`?\n    2 | scal: 2\n      | ^~~~",
             "3:19: error: `eye` takes a finite number here\n", "3:37: error: `target` takes a sequence of 3 numbers\n",
             "3:1: error: camera lacks the key `fov_y`\n", "4:73: error: `cone` is out of range: it lies between 0 and 85\n",
             "5:15: error: `texture_size` must be a power of two\n"),
            (box + "light: {kind: lamp}\n", "3:15: error: `kind` of a light is `directional` or `spot`"),
            (box + sun + "  opening_min: [0, 0, 0]}\n", "3:1: error: `opening_min` and `opening_max` go together"),
            (box + sun + "  opening_min: [0, 2, 0], opening_max: [1, 1, 1]}\n",
             "4:17: error: `opening_min` must not lie above `opening_max`"),
            (CAMERA, "1:1: error: the scene lacks the key `mesh`"),
            ("mesh: box.obj\nlight: [1]\n" + CAMERA, "2:9: error: `light` takes a mapping or a name"),
            ("mesh: box.obj\n" + box + SUN, "2:1: error: the key `mesh` stands twice", "1:1: note: first here"),
            ("mesh: box.obj\ncamera: {eye: [1, 1, 1], target: [1, 1, 1], fov_y: 30}\n" + SUN,
             "2:35: error: `target` is where `eye` is; move one of them"),
            ("- 1\n", "1:3: error: a scene file is a mapping"), (b"mesh: \xff\n", "1:7: error: the byte 0xff is no UTF-8 text\n"),
            ("a: &a [*a]\n", "1:8: error: aliases add more than"), ("", "1:1: error: YAML: the file has no content"),
            (box, "1:7: error: the scene lacks the key `light`, and no light"),
            ("mesh: v.gltf\ncamera: ey\n", "2:9: error: no camera `ey` in "),
            ("mesh: v.gltf\nlight: bulb\n", "2:8: error: the light `bulb` of ")):
        put("bad.yaml", text)
        scene = Scene("bad.yaml")
        holds(not scene.loaded and len(scene.vertices) == 0, text)
        wrong(scene, "bad.yaml", *lines)


def test_meshes_are_looked_for_below_the_scenes_folder():
    put("lost.yaml", "mesh: sponza/sponza.obj\n" + CAMERA + SUN)
    scene = Scene("lost.yaml", "/no/where")
    wrong(scene, "lost.yaml", "1:7: error:")
    for word in "sponza/sponza.obj", "/no/where/sponza/sponza.obj", "folder of scenes", "DIPTYCH_SCENES", "casual-effects.com/data":
        holds(word in scene.told, scene.told)
    os.mkdir("meshes")
    put("meshes/other.obj", BOX)
    holds(yaml_scene("mesh: other.obj\n" + CAMERA + SUN, "meshes").source == 12, "found")


# ---- Motions ----------------------------------------------------------------------------------------


def moving(light, motion):
    """A box with this light, and its frames, with one behind the last key."""
    put("box.obj", BOX)
    put("motion.yaml", motion)
    put("scene.yaml", "mesh: box.obj\n" + CAMERA + light)
    return Scene("scene.yaml", "", "motion.yaml")


def test_splines_are_those_of_the_paper():
    """Catmull and Rom's spline through evenly spaced points is 0.5 ((-t + 2t2 - t3) p0 + (2 - 5t2 + 3t3) p1 + (t + 4t2 - 3t3) p2 +
    (-t2 + t3) p3). Through points on a line in time, the spline is that line at any spacing."""
    frames = moving(SUN, "keys:\n  - {at: 0, camera: {eye: [1, 0, 5], fov_y: 40}}\n  - {at: 4, camera: {eye: [2, 0, 5], fov_y: 44}}\n"
                    "  - {at: 8, camera: {eye: [7, 0, 5]}}\n  - {at: 12, camera: {eye: [-3, 0, 5], fov_y: 52}}\n").frames
    holds(len(frames) == 13 + 1, "frames")
    t = np.arange(5) / 4
    x = 0.5 * ((-t + 2 * t**2 - t**3) * 1 + (2 - 5 * t**2 + 3 * t**3) * 2 + (t + 4 * t**2 - 3 * t**3) * 7 + (-t**2 + t**3) * -3)
    eyes = frames["camera"]["position"]
    near(eyes[4:9, 0], x, 1e-6)
    holds((eyes[:, 2] == 5).all() and (eyes[12:, 0] == -3).all(), "eyes")
    near(1 / frames["camera"]["projection"][:13, 1, 1], np.tan(np.radians(40 + np.arange(13)) / 2), 1e-6)


def test_lines_and_seconds():
    frames = moving(SUN, "interpolation: linear\nframes_per_second: 10\nkeys:\n"
                    "  - {at: 0.1, light: {direction: [0, -2, 0], irradiance: [1, 2, 3]}}\n"
                    "  - {at: 0.3, light: {direction: [2, -2, 0]}}\n  - {at: 0.5, light: {irradiance: [5, 2, 7]}}\n").frames
    holds(len(frames) == 6 + 1, "frames")
    light = frames["light"]
    near(light["direction"][[0, 2, 4], :2], [[0, -1], [1 / np.sqrt(5), -2 / np.sqrt(5)], [np.sqrt(0.5), -np.sqrt(0.5)]], 1e-6)
    near(light["color"][2, :2], [2, 2], 1e-6)
    holds((frames["camera"]["position"] == [0, 0, 5]).all(), "the scene's, to the bit")


def test_a_moving_spot_keeps_its_target():
    """The light view follows. The first frame is that of the scene without a motion."""
    scene = moving(SPOT, "keys: [{at: 0, light: {position: [0, 2, 0]}},\n       {at: 2, light: {position: [2, 2, 0]}}]\n")
    last = scene.frames[2]
    near((last["light"]["direction"][0], last["light_view"]["direction"][1]), [-np.sqrt(0.5)] * 2, 1e-6)
    holds(last["light_view"]["position"][0] == last["light"]["position"][0] == 2, "position")
    holds(last["index"] == 2 and last["time"] == np.float32(2) / np.float32(60), "time")
    holds(scene.frames[0].tobytes() == Scene("scene.yaml").frames[0].tobytes(), "the first frame")


def test_wrong_motion_files_are_told_in_one_run():
    """Values that are right at every key may be wrong between two keys."""
    for text, *lines in (
            ("interpolation: cubic\nkeys:\n  - {at: 1, camera: {eyes: [0, 0, 1]}}\n  - {at: 1, camera: {fov_y: 180}}\n"
             "  - {light: {cone: [1, 2]}}\n  - 7\n",
             "1:16: error: `interpolation` is `catmull_rom` or `linear`\n",
             "3:22: error: unknown key `eyes`; did you mean `eye`?\n    3 |   - {at: 1, camera: {eyes:",
             "4:10: error: `at` must grow from keyframe to keyframe\n",
             "4:29: error: `fov_y` is out of range: it lies between 1 and 170\n", "5:6: error: the keyframe lacks the key `at`\n",
             "6:5: error: a keyframe is a mapping with `at`, `camera` and `light`\n"),
            ("interpolation: linear\n", "1:1: error: the motion lacks the key `keys`"),
            ("keys: [{at: 3}]\n", "1:1: error: no keyframe moves `camera` or `light`"),
            ("keys: [{at: 3, light: {kind: spot}}]\n", "1:24: error: unknown key `kind`"),
            ("keys: [{at: 3, light: {target: [1, 0, 0]}}, {at: 4, light: {direction: [1, 0, 0]}}]\n",
             "1:1: error: a motion moves either `target` or `direction` of a light"),
            ("keys: [{at: 0, camera: {target: [0, 0, 3]}}, {at: 4, camera: {target: [0, 0, 7]}}]\n",
             "1:34: error: in frame 2, `target` is where `eye` is; move one of them\n"),
            ("keys:\n  - {at: 0, light: {cone: [2, 20]}}\n  - {at: 4, light: {cone: [0, 80]}}\n  - {at: 8, light: {cone: [0, 80]}}\n"
             "  - {at: 12, light: {cone: [2, 20]}}\n", "3:28: error: in frame 5, `cone` is out of range: it lies between 0 and 85\n")):
        scene = moving(SPOT, text)
        holds(scene.loaded and len(scene.frames) == 0, text)
        wrong(scene, "motion.yaml", *lines)


if __name__ == "__main__":
    bodies.run_in_folder(globals(), "".join(sys.argv[1:]))
