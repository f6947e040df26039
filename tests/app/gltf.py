"""glTF files against what the specification of glTF 2.0 and of its extensions says of them. Fixtures live in a temporary folder;
scene-print tells what a scene holds. Prints TAP; called by gltf_test.sh."""
import base64
import ctypes
import json
import os
import subprocess
import sys

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/app/python", ROOT + "/tests/gen"]
import bodies  # noqa: E402: from the paths above
from diptych.png import encode_png  # noqa: E402

PROBE = os.path.join(os.environ.get("DIPTYCH_BUILD", ROOT + "/build"), "tests/scene-print")
CAMERA = "camera: {eye: [0, 0, 5], target: [0, 0, 0], fov_y: 40}\n"
SUN = "light: {kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1]}\n"
VERTEX = np.dtype([("position", "f4", 3), ("normal", "f4", 3), ("uv", "f4", 2), ("material", "u4"), ("triangle", "u4")])
MATERIAL = np.dtype([("albedo", "f4", 3), ("texture", "i4"), ("emission", "f4", 3), ("alpha_cutoff", "f4")])
VIEW = np.dtype([("view", "f4", (4, 4)), ("projection", "f4", (4, 4)), ("view_projection", "f4", (4, 4)),
                 ("inverse_view_projection", "f4", (4, 4)), ("position", "f4", 3), ("near_plane", "f4"), ("direction", "f4", 3),
                 ("far_plane", "f4")])
LIGHT = np.dtype([("position", "f4", 3), ("kind", "i4"), ("direction", "f4", 3), ("area", "f4"), ("color", "f4", 3), ("cos_inner", "f4"),
                  ("cos_outer", "f4"), ("padding", "f4", 3)])
FRAME = np.dtype([("camera", VIEW), ("light_view", VIEW), ("light", LIGHT), ("scene_center", "f4", 3), ("scene_radius", "f4"),
                  ("width", "u4"), ("height", "u4"), ("index", "u4"), ("triangle_count", "u4"), ("previous_camera", VIEW),
                  ("jitter", "f4", 2), ("time", "f4"), ("first", "u4")])
OBJECT = np.dtype([("transform", "f4", (4, 4)), ("inverse", "f4", (4, 4)), ("center", "f4", 3), ("radius", "f4"),
                   ("first_index", "u4"), ("index_count", "u4"), ("material", "u4"), ("mesh", "u4")])


def holds(truth, what):
    if not np.all(truth):
        raise AssertionError(str(what))


class Scene:
    """What scene-print tells of a scene file, with frames of 200 x 100 pixels."""

    def __init__(self, path, *meshes_and_motion):
        run = subprocess.run([PROBE, path, *meshes_and_motion], stdout=subprocess.PIPE, check=True)
        line, rest = run.stdout.split(b"\n", 1)
        self.__dict__.update(json.loads(line.decode(errors="replace")))
        self.told = "".join(text + "\n" for level, text in self.messages if level in ("warning", "error"))
        parts = {"vertices": VERTEX, "indices": np.dtype("u4"), "materials": MATERIAL, "objects": OBJECT, "frames": FRAME}
        for name, kind in parts.items():
            count = getattr(self, name)
            setattr(self, name, np.frombuffer(rest, kind, count))
            rest = rest[count * kind.itemsize:]
        self.texels, self.camera, self.low, self.high = (np.frombuffer(part, kind) for part, kind in (
            (rest[:-64], "u1"), (rest[-64:-24], "f4"), (rest[-24:-12], "f4"), (rest[-12:], "f4")))

    def count(self, level):
        return sum(found == level for found, _ in self.messages)


def put(name, content):
    with open(name, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())


def try_mesh(name, keys=""):
    put("scene.yaml", f"mesh: {name}\n{keys}{CAMERA}{SUN}")
    return Scene("scene.yaml")


def load(name="a.gltf", keys="", quiet=True):
    scene = try_mesh(name, keys)
    holds(scene.loaded and not (quiet and scene.told), scene.told)
    return scene


def refused(text, name="a.gltf"):
    """The file must fail, with one error that has this text."""
    scene = try_mesh(name)
    holds(not scene.loaded and text in scene.told and scene.count("error") == 1, f"no '{text}' in\n{scene.told}")


CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "f4")
SIZES = {"f4": 5126, "u1": 5121, "i1": 5120, "u2": 5123, "i2": 5122}


def document(*arrays, node=None, primitive=None, accessors=None, views=None, buffer=None, **top):
    """One triangle in one node; each array has a view and an accessor, the first the positions. Returns the glTF and its bytes.
    `views` and `accessors` replace those of the arrays, `buffer` the place of the bytes; `top` is more of the file."""
    arrays = [np.asarray(array) for array in arrays or (CORNERS,)]
    data, made_views, made_accessors = b"", [], []
    for i, array in enumerate(arrays):
        made_views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        kind = "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}"
        made_accessors.append({"bufferView": i, "componentType": SIZES[array.dtype.str[1:]], "count": len(array), "type": kind})
        data += array.tobytes() + bytes(-array.nbytes % 4)
    return {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, **(node or {})}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, **(primitive or {})}]}],
            "accessors": made_accessors if accessors is None else accessors,
            "bufferViews": made_views if views is None else views,
            "buffers": [{"byteLength": len(data), **({"uri": "a.bin"} if buffer is None else buffer)}], **top}, data


def put_gltf(*arrays, **more):
    tree, data = document(*arrays, **more)
    put("a.bin", data)
    put("a.gltf", json.dumps(tree))
    return tree


def uv_at(scene):
    """Texture coordinates of the three corners."""
    return np.array([scene.vertices["uv"][np.abs(scene.vertices["position"] - corner).max(1) < 1e-4][0] for corner in CORNERS])


def near(found, expected, absolute=1e-6):
    holds(np.abs(np.asarray(found, float) - expected) <= absolute, f"{found}, not {expected}")


# ---- Numbers ----------------------------------------------------------------------------------------


def test_normalized_integers_become_fractions():
    """Section 3.6.2.2: f = c / 255, c / 65535, max(c / 127, -1), max(c / 32767, -1)."""
    for kind, codes, expected in (("u1", [255, 51, 0, 255, 102, 0], [1, 0.2, 0, 1, 0.4, 0]),
                                  ("i1", [-128, 127, -127, 0, 0, 0], [-1, 1, -1, 0, 0, 0]),
                                  ("u2", [65535, 13107, 0, 39321, 0, 0], [1, 0.2, 0, 0.6, 0, 0]),
                                  ("i2", [-32768, 32767, -32767, 7, 0, 0], [-32768, 32767, -32767, 7, 0, 0])):
        rows = np.zeros((3, 4 // np.dtype(kind).itemsize), kind)  # elements begin at multiples of four bytes
        rows[:, :2] = np.reshape(codes, (3, 2))
        tree = put_gltf(CORNERS, rows, primitive={"attributes": {"POSITION": 0, "TEXCOORD_0": 1}},
                        extensionsRequired=["KHR_mesh_quantization"] if kind == "i2" else [])
        tree["accessors"][1].update(type="VEC2", normalized=kind != "i2")
        tree["bufferViews"][1]["byteStride"] = 4
        put("a.gltf", json.dumps(tree))
        near(uv_at(load()), np.reshape(expected, (3, 2)))


def test_sparse_accessors_replace_elements():
    """Elements of zeros, two of which are replaced; indices of bytes."""
    for at, text in (([1, 3], None), ([1, 4], "accessors[0].sparse: its index 1 is 4; indices grow, below the count of 4"),
                     ([1, 1], "accessors[0].sparse: its index 1 is 1; indices grow")):
        sparse = {"count": 2, "indices": {"bufferView": 0, "componentType": 5123}, "values": {"bufferView": 1}}
        put_gltf(np.array(at, "u2"), np.array([[2, 0, 0], [0, 2, 0]], "f4"), np.array([0, 1, 3], "u1"), primitive={"indices": 1},
                 accessors=[{"componentType": 5126, "count": 4, "type": "VEC3", "sparse": sparse},
                            {"bufferView": 2, "componentType": 5121, "count": 3, "type": "SCALAR"}])
        if text:
            refused(text)
        else:
            scene = load()
            holds(len(scene.indices) == 3 and (scene.high[:2] == 2).all(), "the replaced corners")


def test_strips_and_fans_keep_their_front():
    """Section 3.7.2.1: strip {i, i + 1 + i % 2, i + 2 - i % 2}, fan {i + 1, i + 2, 0}. All face +z."""
    for mode, corners in (5, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]), (6, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]):
        put_gltf(np.array(corners, "f4"), primitive={"mode": mode})
        scene = load()
        holds(len(scene.indices) == 6 and (scene.vertices["normal"][:, 2] > 0.999).all(), f"mode {mode}")


def test_wrong_numbers_are_named():
    put_gltf(CORNERS, np.array([0, 1, 77], "u2"), primitive={"indices": 1})
    refused("a.gltf: accessors[1]: its index 2 is 77, and there are 3 vertices")
    put_gltf(np.where(CORNERS == [1, 0, 0], [np.inf, 0, 0], CORNERS).astype("f4"))
    refused("vertex 1 of mesh 0 has a number that is not finite")
    view, accessor = {"buffer": 0, "byteLength": 36}, {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    for more, text in (
            ({"primitive": {"attributes": {"POSITION": 0, "NORMAL": 7}}}, "meshes[0].NORMAL: there is no accessors[7]; the file has 1"),
            ({"views": [{**view, "byteOffset": 4}]}, "bufferViews[0]: bytes 4 to 40 lie outside of buffers[0], which has 36"),
            ({"views": [{**view, "byteOffset": -4}]}, "bufferViews[0].byteOffset: -4 is no whole number from 0"),
            ({"views": [{**view, "byteLength": 35}]}, "accessors[0].count: 3 elements do not fit into bufferViews[0]"),
            ({"views": [{**view, "byteStride": 8}]}, "bufferViews[0].byteStride: 8 is less than an element of accessors[0]"),
            ({"accessors": [{**accessor, "componentType": 5124}]},
             "accessors[0].componentType: 5124, with this `type`, is not supported"),
            ({"accessors": [{**accessor, "type": "VEC2"}]}, "accessors[0].type: has 2 components, and 3 are needed"),
            ({"accessors": [{**accessor, "count": 1 << 32}]}, "accessors[0].count: 4294967296 is no whole number"),
            ({"node": {"rotation": [0, 0, 1]}}, "nodes[0].rotation: is no array of 4 numbers"),
            ({"primitive": {"mode": 9}}, "meshes[0].primitives.mode: 9 is none of 0 to 6"),
            ({"scene": 1}, "scenes[0].scene: there is no scenes[1]; the file has 1"),
            ({"materials": 7}, "`materials` is no array")):
        put_gltf(**more)
        refused(text)
    put("a.gltf", json.dumps(put_gltf())[:-1] + ",}")
    refused("a.gltf:1:")


# ---- Textures ---------------------------------------------------------------------------------------


def texel(red):
    """A picture of one texel."""
    return encode_png(np.array([[[red, 2, 3]]], "u1"))


def textured(**info):
    return {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, **info}}}


def test_material_chooses_texture_coordinates():
    """The set that the material names, through its transform: scale, then turn counter-clockwise, then move. The second example of
    KHR_texture_transform takes the lower left quadrant, turned."""
    put("a b.png", texel(1))
    sets = CORNERS, np.array([[0, 0], [1, 0], [0, 1]], "f4"), np.array([[0.5, 0.25], [3, 4], [-1, 0]], "f4")
    files = {"textures": [{"source": 0}], "images": [{"uri": "a%20b.png"}]}
    for info, transform, expected in (
            ({}, None, [[0, 0], [1, 0], [0, 1]]),
            ({"texCoord": 1}, None, [[0.5, 0.25], [3, 4], [-1, 0]]),
            ({}, {"offset": [0.25, 0.5], "scale": [0.5, 2]}, [[0.25, 0.5], [0.75, 0.5], [0.25, 2.5]]),
            ({}, {"offset": [0, 1], "rotation": 1.57079632679, "scale": [0.5, 0.5]}, [[0, 1], [0, 0.5], [0.5, 1]]),
            ({"texCoord": 0}, {"texCoord": 1, "scale": [2, 1]}, [[1, 0.25], [6, 4], [-2, 0]])):
        info = {**info, **({"extensions": {"KHR_texture_transform": transform}} if transform else {})}
        put_gltf(*sets, primitive={"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 2}, "material": 0},
                 materials=[textured(**info)], **files)
        near(uv_at(load()), expected)
    put_gltf(primitive={"material": 0}, materials=[textured(texCoord=1)], **files)
    refused("the texture of materials[0] needs TEXCOORD_1")


def told_once(*texts):
    """It loads, with these warnings and no more."""
    scene = load(quiet=False)
    for text in texts:
        holds(text in scene.told, f"not told: {text}")
    holds(scene.count("warning") == len(texts), scene.told)


def test_more_is_told():
    """What scenes do not keep of samplers and materials is told, each once."""
    put("a.png", texel(1))
    files = {"textures": [{"source": 0, "sampler": 0}], "images": [{"uri": "a.png"}]}
    put_gltf(materials=[textured(), textured()], samplers=[{"wrapS": 33071, "wrapT": 10497, "magFilter": 9728}], **files)
    told_once("a.gltf: `wrapS` CLAMP_TO_EDGE of a sampler is not supported",
              "a.gltf: `magFilter` NEAREST of a sampler is not supported")
    factor = {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}}
    put_gltf(materials=[{"alphaMode": "MASK", "normalTexture": {"index": 0}, **factor}, {"alphaMode": "BLEND"},
                        {"pbrMetallicRoughness": {"baseColorFactor": [5, 1, 1, 1]}}],
             textures=[{"source": 0}], images=files["images"], animations=[{"channels": [], "samplers": []}])
    told_once("`normalTexture` is not supported", "the alpha of `baseColorFactor` is not supported",
              "`alphaMode` BLEND is not supported; materials without texture are opaque",
              "materials[2].baseColorFactor: 5 is not from 0 to 1", "animations are not supported")
    put_gltf(materials=[{"emissiveFactor": [0, -1, 0]}])
    refused("materials[0].emissiveFactor: -1 is negative")


def test_embedded_pictures_are_layers():
    """Pictures in a data URI and in a buffer view; equal ones are one layer."""
    uri = {"uri": "data:image/png;base64," + base64.b64encode(texel(255)).decode()}
    picture = np.frombuffer(texel(7), "u1")
    put_gltf(CORNERS, picture, textures=[{"source": i} for i in range(3)], images=[uri, {"bufferView": 1, "mimeType": "image/png"}, uri],
             materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(3)])
    scene = load()
    layer = scene.materials["texture"][:3]
    holds(scene.layers == 2 and layer[0] == layer[2], "layers")
    holds(scene.texels[4 * layer[:2]] == [255, 7], "texels")


def test_materials_are_those_of_the_file():
    factor = {"pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 0.75, 1]}}
    strength = {"extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}}
    put_gltf(primitive={"material": 1}, extensionsRequired=["KHR_materials_emissive_strength"],
             materials=[{}, {"emissiveFactor": [1, 0.5, 0], "doubleSided": True, **strength, **factor}])
    scene = load()
    material = scene.materials[scene.vertices["material"][0]]
    holds(material["albedo"] == [0.25, 0.5, 0.75], "albedo")
    holds(material["emission"] == [4, 2, 0], "emission")
    put_gltf()  # section 3.7.2.1: the default material is white
    scene = load()
    holds(scene.materials[scene.vertices["material"][0]]["albedo"] == 1, "white")


# ---- Extensions -------------------------------------------------------------------------------------


def test_unknown_extensions_are_named():
    put_gltf(extensionsUsed=["EXT_none"], extensionsRequired=["EXT_none"])
    refused("a.gltf: it requires the extension EXT_none, which is not supported")
    put_gltf(extensionsUsed=["EXT_none", "EXT_none"])
    told_once("a.gltf: the extension EXT_none is not supported")


def test_meshopt_views_are_decompressed():
    """Positions and indices as meshoptimizer's encoders write them; the buffers of the views do not exist, as the extension allows."""
    library, indices = ctypes.CDLL("libmeshoptimizer.so.2d"), np.array([0, 1, 2], "u4")
    vertex, index = library.meshopt_encodeVertexBuffer, library.meshopt_encodeIndexBuffer
    vertex.restype = index.restype = ctypes.c_size_t
    library.meshopt_encodeIndexVersion(1)

    def packed(encode, array, *sizes):
        room = ctypes.create_string_buffer(512)
        count = encode(room, ctypes.c_size_t(512), array.ctypes.data_as(ctypes.c_void_p), *map(ctypes.c_size_t, sizes))
        return room.raw[:count]

    first, second = packed(vertex, CORNERS, 3, 12), packed(index, indices, 3)

    def put_packed(first, stride):
        views = [{"buffer": 0, "byteLength": len(first), "byteStride": stride, "mode": "ATTRIBUTES", "count": 3},
                 {"buffer": 0, "byteOffset": len(first), "byteLength": len(second), "byteStride": 2, "mode": "TRIANGLES", "count": 3}]
        tree = put_gltf(CORNERS, np.array([0, 1, 2], "u2"), primitive={"indices": 1}, extensionsRequired=["EXT_meshopt_compression"],
                        views=[{"buffer": 1, "byteLength": length, "extensions": {"EXT_meshopt_compression": view}}
                               for length, view in zip((36, 6), views)])
        tree["buffers"] = [{"uri": "a.bin", "byteLength": len(first + second)}, {"byteLength": 42}]
        put("a.bin", first + second)
        put("a.gltf", json.dumps(tree))

    put_packed(first, 12)
    scene = load()
    holds(len(scene.indices) == 3 and (scene.high[:2] == 1).all(), "the triangle")
    put_packed(b"\0" + first[1:], 12)
    refused("bufferViews[0].EXT_meshopt_compression: cannot be decompressed")
    put_packed(first, 13)
    refused("3 times 13 bytes of mode `ATTRIBUTES`")


# ---- Nodes and containers ---------------------------------------------------------------------------


def test_nodes_have_a_matrix_or_its_parts():
    """A matrix, and what makes the same of translation, rotation and scale: x to y, doubled, and 3 to the right."""
    for node in ({"matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 3, 0, 0, 1]},
                 {"translation": [3, 0, 0], "rotation": [0, 0, 0.70710678, 0.70710678], "scale": [2, 2, 2]}):
        put_gltf(node=node)
        scene = load()
        near([scene.low, scene.high], [[1, 0, 0], [3, 2, 0]], 1e-5)


def test_nodes_are_trees():
    """Section 3.5.2: the hierarchy is strict trees, and a scene names roots."""
    mesh = {"mesh": 0}
    for roots, nodes, text in (
            ([0], [{"children": [1, 1]}, mesh], "nodes[1] is a child of nodes[0] already"),
            ([0], [{"children": [1, 2]}, {"children": [2]}, mesh],
             "nodes[1].children: nodes[2] is a child of nodes[0] already; nodes are trees"),
            ([0], [{"children": [1]}, {"children": [0]}], "nodes[0] is no root"),
            ([0, 0], [mesh, {}], "nodes[0]: stands twice in the scene"),
            ([0, 9], [mesh], "there is no nodes[9]; the file has 1")):
        put_gltf(scenes=[{"nodes": roots}], nodes=nodes, meshes=[{"primitives": []}])
        refused(text)


def test_many_triangles_are_refused_before_they_are_made():
    """Two hundred nodes with a mesh of a million triangles, which needs no byte of a buffer."""
    put_gltf(scenes=[{"nodes": list(range(199))}], nodes=[{"mesh": 0}] * 199,
             accessors=[{"componentType": 5126, "count": 3000000, "type": "VEC3"}])
    refused("199000000 triangles are too many")


def glb(version):
    tree, data = document(buffer={})
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    words = np.array([0x46546C67, version, 28 + len(text) + len(data), len(text), 0x4E4F534A], "<u4")
    return words.tobytes() + text + np.array([len(data), 0x004E4942], "<u4").tobytes() + data


def test_containers_are_read():
    for name in "a.glb", "a.odd":  # by its name, by its first bytes
        put(name, glb(2))
        holds(len(load(name).indices) == 3, name)
    put("old.glb", glb(1))
    refused("it is glTF 1; glTF 2 is supported", "old.glb")
    put("a.glb", glb(2)[:300])
    refused("it is cut off", "a.glb")
    start = "data:application/octet-stream;base64,"
    code = base64.b64encode(CORNERS.tobytes()).decode()
    put_gltf(buffer={"uri": start + code})
    near(load().high, [1, 1, 0], 0)
    put_gltf(buffer={"uri": start + code[:4] + "!" + code[5:]})
    refused("buffers[0].uri: the character 5 of the data is no base64")
    put("a.gltf", '{"asset":{"version":"1.0"}}')
    refused("it is glTF 1.0; glTF 2.0 is supported")


if __name__ == "__main__":
    bodies.run_in_folder(globals())
