"""Compares diptych.py with the command line and with known numbers. Called by python_test.sh, with the folder of the build in
DIPTYCH_BUILD."""
import ctypes
import json
import os
import re
import signal
import struct
import subprocess
import sys
import threading
import time
import warnings

import numpy
import pytest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.environ["DIPTYCH_BUILD"]
sys.path.insert(0, os.environ.get("DIPTYCH_MODULE", ROOT + "/app/python"))
import diptych  # noqa: E402: from the path above

SCENE = ROOT + "/scenes/cornell.yaml"
SIZE = (24, 16)
BACKENDS = ("gl", "vk")

NEGATIVE = """
pipeline: negative
params: {white: {value: 1.0, min: 0.0, max: 2.0, live: true}, baked: {value: 1}}
structs: {Pair: {weight: float, at: vec3, ends: "vec3[2]", number: uint}}
buffers:
  pairs: {of: Pair, count: 3, input: true}
  seen: {of: Pair, count: 3}
  frames: {of: uint, count: 1, history: true}
images:
  photo: {input: true, format: rgba8, size: frame}
  picture: {format: rgba8, size: frame}
passes:
  - {name: invert, dispatch: picture, reads: [photo], writes: [picture], shader: negative.glsl}
  - {name: copy, dispatch: 3, reads: [pairs], writes: [seen], shader: copy.glsl}
  - {name: count, dispatch: 1, updates: [frames], shader: count.glsl}
output: {display: picture}
"""
BODIES = {
    "negative.glsl": """void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, picture_size())))
        picture_store(p, vec4(white - photo(p).rgb, 1.0));
}
""",
    "copy.glsl": """void main()
{
    uint i = uint(invocation().x);
    if (i < 3u) {
        seen[i].weight = pairs[i].weight;
        seen[i].at = pairs[i].at;
        seen[i].ends[0] = pairs[i].ends[1];
        seen[i].ends[1] = pairs[i].ends[0];
        seen[i].number = pairs[i].number;
    }
}
""",
    "count.glsl": "void main()\n{\n    if (invocation().x == 0)\n        frames[0] = frames[0] + uint(baked);\n}\n",
}


@pytest.fixture(name="negative")
def fixture_negative(tmp_path):
    for name, text in BODIES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    path = tmp_path / "negative.yaml"
    path.write_text(NEGATIVE, encoding="utf-8")
    return path


def photo():
    """Another code in each channel of each texel."""
    count = SIZE[0] * SIZE[1] * 4
    return (numpy.arange(count) % 251).astype("u1").reshape(SIZE[1], SIZE[0], 4)


def pairs(pipeline):
    """Numbers for a struct, in its dtype."""
    array = numpy.zeros(3, pipeline.read("pairs").dtype)
    array["weight"] = [0.5, 1.5, 2.5]
    array["at"] = numpy.arange(9).reshape(3, 3)
    array["ends"]["value"] = numpy.arange(18).reshape(3, 2, 3) + 100
    array["number"] = [7, 8, 2**32 - 1]
    return array


def not_finite(pipeline):
    array = pairs(pipeline)
    array["weight"][1] = numpy.nan
    return array


def open_negative(spec, backend="vk", **more):
    pipeline = diptych.open(spec, backend=backend, size=SIZE, debug=True, inputs={"photo": photo()}, **more)
    pipeline.write("pairs", pairs(pipeline))
    return pipeline


def run(*command):
    return subprocess.run([BUILD + "/" + command[0], *command[1:]], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("backend", BACKENDS)
def test_arrays_in_and_out(negative, backend):
    with open_negative(negative, backend) as pipeline:
        found = pipeline.render("picture", "seen", "photo")
        assert (found["photo"] == photo()).all()
        assert (found["picture"][..., :3] == 255 - photo()[..., :3]).all() and (found["picture"][..., 3] == 255).all()
        given = pairs(pipeline)
        for name in ("weight", "at", "number"):
            assert (found["seen"][name] == given[name]).all()
        assert (found["seen"]["ends"]["value"] == given["ends"]["value"][:, ::-1]).all()
        pipeline.write("photo", 255 - photo())
        assert (pipeline.render("picture")["picture"][..., :3] == photo()[..., :3]).all()


def test_live_parameters_and_frames(negative):
    with open_negative(negative, sets={"white": 2}) as pipeline:
        assert pipeline.render("picture")["picture"].min() == 255
        pipeline.set(white=numpy.float32(0))
        assert pipeline.render("picture")["picture"][..., :3].max() == 0
        values = {param["name"]: param["value"] for param in pipeline.description["params"]}
        assert values == {"white": 0, "baked": 1}
        assert pipeline.read("frames").tolist() == [2]
        pipeline.render()
        assert pipeline.read("frames").tolist() == [3]


def read_field(data, stride, count, field):
    """The numbers of one field of a dump; struct unpacks them as the manifest says."""
    code, size = {"float": ("f", 1), "int": ("i", 1), "uint": ("I", 1), "bool": ("I", 1), "mat4": ("f", 16)}.get(
        field["type"]
    ) or ({"v": "f", "i": "i", "u": "I"}[field["type"][0]], int(field["type"][-1]))
    return [
        list(struct.unpack_from(f"<{size}{code}", data, i * stride + field["offset"] + k * field.get("array_stride", 0)))
        for i in range(count)
        for k in range(field.get("array_count", 1))
    ]


@pytest.mark.parametrize("spec", ["layouts", "formats", "shapes"])
def test_types_are_those_of_a_dump(spec, tmp_path):
    path = f"{ROOT}/tests/specs/{spec}.yaml"
    if not os.path.exists(path):
        pytest.fail(f"{path} is not there")
    options = ["--spec", path, "--size", "%dx%d" % SIZE, "--backend", "vk", "--scene", SCENE]
    assert run("diptych", "render", *options, "--dump", tmp_path / "dump").returncode == 0
    manifest = json.loads((tmp_path / "dump/manifest.json").read_text(encoding="utf-8"))
    last = {(entry["resource"], entry.get("mip", 0)): entry for entry in manifest["entries"]}
    with diptych.open(path, scene=SCENE, size=SIZE) as pipeline:
        found = pipeline.render(*last)
    for key, entry in last.items():
        data = (tmp_path / "dump" / entry["file"]).read_bytes()
        if entry["kind"] == "image":
            assert found[key].tobytes() == data, key
            continue
        for field in entry["fields"]:
            numbers = found[key][field["name"]] if field["name"] else found[key]
            numbers = numbers["value"] if numbers.dtype.names else numbers
            wanted = numpy.array(read_field(data, entry["stride"], entry["count"], field), numbers.dtype)
            assert numbers.tobytes() == wanted.tobytes(), (key, field)


def test_formats_have_their_shapes():
    with diptych.open(ROOT + "/tests/specs/shapes.yaml", scene=SCENE, size=SIZE) as pipeline:
        found = pipeline.render("fog", ("fog", 1), ("sky", 1), "probes")
    shapes = [array.shape for array in found.values()]
    assert shapes == [(5, 6, 8, 4), (2, 3, 4, 4), (6, 4, 4, 4), (12, 4, 4, 4)]
    assert [array.dtype for array in found.values()] == ["f2", "f2", "f2", "u1"]
    kinds = {"rgba8ui": "u1", "rg8i": "i1", "r16": "u2", "r16_snorm": "i2", "rgba32i": "i4", "r11g11b10f": "u4", "rgb10a2": "u4"}
    with diptych.open(ROOT + "/tests/specs/formats.yaml", scene=SCENE, size=SIZE) as pipeline:
        found = pipeline.render(*("of_" + name for name in kinds))
    assert {name[3:]: array.dtype.str[1:] for name, array in found.items()} == kinds
    assert found["of_rgba8ui"].shape == (12, 20, 4) and found["of_rgb10a2"].shape == (12, 20)


def test_compare(negative):
    with open_negative(negative, "gl") as gl, open_negative(negative, "vk") as vk:
        same = diptych.compare(gl, vk)
        assert same and [r["resource"] for r in same.results] == ["picture", "seen", "frames"]
        vk.set(white=0)
        other = diptych.compare(gl, vk)
        assert not other and [r["verdict"] for r in other.results] == ["DIFFERS", "equal", "equal"]
        assert other.results[0]["differing"] == (photo()[..., :3] != 255).any(axis=2).sum()
        assert "invert  picture" in str(other)
        vk.render()
        with pytest.raises(diptych.Error, match="different numbers of frames"):
            diptych.compare(gl, vk)


def test_command_line_agrees_with_compare(tmp_path):
    spec = ROOT + "/templates/rsm.yaml"
    options = {"scene": SCENE, "size": SIZE, "sets": {"rsm_size": 16, "samples": 4}}
    with diptych.open(spec, "gl", **options) as gl, diptych.open(spec, "gl+glsl", **options) as text:
        mine = diptych.compare(gl, text)
    sets = [word for name, value in options["sets"].items() for word in ("--set", f"{name}={value}")]
    run("diptych", "compare", "--spec", spec, "--scene", SCENE, "--size", "%dx%d" % SIZE, "--backend", "gl,gl+glsl",
        "--json", tmp_path / "theirs.json", *sets)  # fmt: skip
    theirs = json.loads((tmp_path / "theirs.json").read_text(encoding="utf-8"))
    assert mine.agree == theirs["agree"] and len(mine.results) == len(theirs["results"]) > 10
    assert all(own.items() <= other.items() for own, other in zip(mine.results, theirs["results"]))


def test_pass_by_pass(negative):
    seen = []
    with open_negative(negative) as pipeline:

        def look(name):
            seen.append(name)
            if name == "invert":
                assert (pipeline.read("picture")[..., 3] == 255).all()
                with pytest.raises(diptych.Error, match="read seen: other passes may reuse its memory"):
                    pipeline.read("seen")

        pipeline.render(after_pass=look)
        assert seen == ["invert", "copy", "count"]

        def stop(name):
            raise KeyError(name)

        with pytest.raises(KeyError, match="invert"):
            pipeline.render(after_pass=stop)
        assert (pipeline.render("picture")["picture"][..., :3] == 255 - photo()[..., :3]).all()
        assert pipeline.read("frames").tolist() == [1]  # it began anew


@pytest.mark.parametrize("verb", ["close", "render", "resize", "write", "set"])
def test_a_frame_is_not_disturbed(negative, verb):
    calls = {
        "close": lambda pipeline: pipeline.close(),
        "render": lambda pipeline: pipeline.render(),
        "resize": lambda pipeline: pipeline.resize(8, 8),
        "write": lambda pipeline: pipeline.write("photo", photo()),
        "set": lambda pipeline: pipeline.set(baked=2),
    }
    with open_negative(negative) as pipeline:
        with pytest.raises(diptych.Error, match=verb + ": a frame is being rendered"):
            pipeline.render(after_pass=lambda name: calls[verb](pipeline))
        pipeline.render()


def test_resize(negative):
    with open_negative(negative, "gl") as pipeline:
        pipeline.render()
        pipeline.resize(9, 5)
        with pytest.raises(diptych.Error, match="photo has no content"):
            pipeline.render()
        pipeline.write("photo", photo()[:5, :9])
        found = pipeline.render("picture", "frames", "seen")
        assert (found["picture"][..., :3] == 255 - photo()[:5, :9, :3]).all()
        assert found["frames"].tolist() == [1] and (found["seen"]["weight"] == [0.5, 1.5, 2.5]).all()


def test_a_resize_that_fails_changes_nothing(negative):
    with open_negative(negative, "gl") as pipeline:
        with pytest.raises(diptych.Error, match="choose another size"):
            pipeline.resize(60000, 60000)
        assert (pipeline.render("picture")["picture"][..., :3] == 255 - photo()[..., :3]).all()
        with pytest.raises(diptych.Error, match="compare: a player with itself"):
            diptych.compare(pipeline, pipeline)
    with pytest.raises(diptych.Error, match="size 0x4: must be from 1x1"):
        diptych.open(negative, size=(0, 4))


def test_resize_keeps_history(negative):
    with open_negative(negative, "gl", keep_history=True) as pipeline:
        pipeline.render()
        pipeline.resize(9, 5)
        pipeline.write("photo", photo()[:5, :9])
        assert pipeline.render("frames")["frames"].tolist() == [2]


def test_set_of_baked_parameters(negative):
    with open_negative(negative) as pipeline:
        pipeline.set(white=0)
        pipeline.set(baked=3)
        found = pipeline.render("frames", "picture")
        assert found["frames"].tolist() == [3] and found["picture"][..., :3].max() == 0
        with pytest.raises(diptych.Error):
            pipeline.set(baked="none")
        assert pipeline.render("frames")["frames"].tolist() == [6]


@pytest.mark.parametrize("backend", BACKENDS)
def test_undefined_behaviour(tmp_path, backend):
    spec = tmp_path / "roots.yaml"
    spec.write_text("pipeline: roots\nbuffers: {roots: {of: float, count: 8}}\n"
                    "passes: [{name: root, dispatch: 8, writes: [roots], shader: root.glsl}]\n")
    (tmp_path / "root.glsl").write_text("void main() { int i = invocation().x;\n"
                                        "    if (i < 8) roots[i] = sqrt(float(i) - 2.0); }\n")
    with diptych.open(spec, backend=backend, size=SIZE, sanitize=True) as pipeline:
        pipeline.render()
        pipeline.render()
        found, = pipeline.undefined
        assert (found["line"], found["message"], found["invocation"], found["count"]) == (2, "sqrt(-2)", [0, 0, 0], 4)
    with diptych.open(spec, backend=backend, size=SIZE, sanitize="index,loop") as pipeline:
        pipeline.render()
        assert pipeline.undefined == []
    with diptych.open(spec, backend=backend, size=SIZE) as pipeline:
        with pytest.raises(diptych.Error, match="without `sanitize`"):
            pipeline.undefined


def test_camera_and_timings():
    spec = ROOT + "/templates/rsm.yaml"
    with diptych.open(spec, scene=SCENE, size=SIZE, sets={"rsm_size": 16, "samples": 4}, timing=True) as pipeline:
        there = pipeline.render("gbuffer_depth")["gbuffer_depth"]
        pipeline.camera((0.278, 0.273, -0.8), (0.278, 0.273, 0), fov_y=39.3)
        assert (pipeline.render("gbuffer_depth")["gbuffer_depth"] == there).all()
        pipeline.camera((0.278, 0.273, -0.6), (0.278, 0.273, 0))
        assert (pipeline.render("gbuffer_depth")["gbuffer_depth"] != there).any()
        assert list(pipeline.timings) == [entry["name"] for entry in pipeline.description["passes"]]
        assert all(ms is None or 0 <= ms < 60000 for ms in pipeline.timings.values())


def test_png(negative, tmp_path):
    with open_negative(negative) as pipeline:
        assert pipeline._repr_png_() is None  # pylint: disable=protected-access
        pipeline.render()
        data = pipeline.png()
        assert data == pipeline._repr_png_()  # pylint: disable=protected-access
        (tmp_path / "a.png").write_bytes(data)
        with pytest.raises(diptych.Error, match="png frames: it is no plain image"):
            pipeline.png("frames")
    with diptych.open(negative, inputs={"photo": tmp_path / "a.png"}) as again:
        assert (again.read("photo")[..., :3] == 255 - photo()[..., :3]).all()


def test_open_in_threads(negative):
    found = []

    def play():
        with open_negative(negative, "gl") as pipeline:
            found.append(pipeline.render("frames")["frames"].tolist())

    threads = [threading.Thread(target=play) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [[1]] * 4


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_child_ends(negative, backend):
    with open_negative(negative, backend) as pipeline:
        pipeline.render()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python 3.12 warns of a driver's threads
            child = os.fork()
        if child == 0:
            try:
                pipeline.render()
            except diptych.Error as error:
                pipeline.close()
                del pipeline
                os._exit(7 if "another process" in str(error) else 1)
            os._exit(1)
        for _ in range(30000):  # machines may be busy
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                break
            time.sleep(0.01)
        else:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            pytest.fail("the child hangs")
        assert os.waitstatus_to_exitcode(status) == 7
        pipeline.render()


def test_errors_are_those_of_the_generator(tmp_path):
    bad = ROOT + "/tests/bad/sampler_wrong.yaml"
    with pytest.raises(diptych.Error) as caught:
        diptych.open(bad)
    assert str(caught.value) == run("diptych-gen", bad, "--check").stderr.rstrip("\n")
    with pytest.raises(diptych.Error, match="no such file|No such file"):
        diptych.open(tmp_path / "none.yaml")


def test_warnings_are_warnings(negative):
    negative.write_text(NEGATIVE.replace("baked:", "idle: {value: 1}, baked:"), encoding="utf-8")
    with pytest.warns(UserWarning, match=r"negative.yaml:3:\d+: warning: the parameter `idle` is not used"):
        open_negative(negative).close()


def test_errors_name_the_thing(negative):
    with open_negative(negative) as pipeline:
        for reason, call in {
            'set whit: negative has no such parameter; did you mean "white"': lambda: pipeline.set(whit=1),
            "white=9: must be of type float, from 0 to 2": lambda: pipeline.set(white=9),
            "read pictur: negative has no such resource": lambda: pipeline.render("pictur"),
            "read picture: no frame was rendered": lambda: pipeline.read("picture"),
            "read photo: no pass wrote mip 3": lambda: pipeline.read("photo", 3),
            "write picture: it is no input": lambda: pipeline.write("picture", photo()),
            "write phot: negative has no such resource": lambda: pipeline.write("phot", photo()),
            r"write photo: the array has the shape \(2, 2\), not \(16, 24, 4\)": lambda: pipeline.write(
                "photo", numpy.zeros((2, 2))
            ),
            "write photo: it has no mip 7": lambda: pipeline.write("photo", numpy.zeros((1, 1, 4), "u1"), 7),
            "mip 4294967296: must be from 0": lambda: pipeline.read("photo", 2**32),
            r"write pairs: \[1\] has a number in weight that is not finite": lambda: pipeline.write("pairs", not_finite(pipeline)),
            "size 4294967304: must be from 0": lambda: pipeline.resize(2**32 + 8, 4),
            "size 0x4: must be from 1x1": lambda: pipeline.resize(0, 4),
            "size 1.5: must be an integer": lambda: pipeline.resize(1.5, 4),
            "camera: the target is away": lambda: pipeline.camera((0, 0, 0), (0, 1, 0)),
            "camera: eye, target and up have three": lambda: pipeline.camera((0, 0), (0, 0, 1)),
            "has a NUL": lambda: pipeline.read("photo\0s"),
            "timings": lambda: pipeline.timings,
            "baked=2.5": lambda: pipeline.set(baked=2.5),
            "write photo: Cannot cast": lambda: pipeline.write("photo", photo() / 255),
            "write pairs: the array has the type": lambda: pipeline.write("pairs", numpy.zeros(3)),
        }.items():
            with pytest.raises(diptych.Error, match=reason):
                call()
        pipeline.close()
        with pytest.raises(diptych.Error, match="closed"):
            pipeline.render()
    for reason, options in {
        "unknown backend": {"backend": "metal"},
        "no Vulkan device is called": {"backend": "vk@nobody"},
        "must be from 1x1 to": {"size": (100000, 1)},
        "size 0x5|size 4294967295x5": {"size": (0, 5)},
        "size 4294967304: must be": {"size": (2**32 + 8, 5)},
        "input phot=a.png: negative has no such input": {"inputs": {"phot": "a.png"}},
        "whit": {"sets": {"whit": 1}},
    }.items():
        with pytest.raises(diptych.Error, match=reason):
            diptych.open(negative, **options)
    with diptych.open(negative, size=SIZE) as pipeline, pytest.raises(diptych.Error, match="pairs has no content"):
        pipeline.render()


def test_files_are_inputs_too(tmp_path):
    spec = ROOT + "/tests/specs/outside.yaml"
    picture = ROOT + "/tests/specs/outside_grade.png"
    numpy.save(tmp_path / "weights.npy", numpy.array([[1, 0.5, 0.25], [0, 0.5, 0.75]], "f4"))
    by_file = {"photo": picture, "weights": tmp_path / "weights.npy"}
    with diptych.open(spec, inputs=by_file) as first:
        found = first.render("picture", "photo")
        size = found["photo"].shape[1::-1]
        by_array = {"photo": found["photo"], "weights": numpy.load(tmp_path / "weights.npy")}
        with diptych.open(spec, "gl", size=size, inputs=by_array) as second:
            assert (second.render("picture")["picture"] == found["picture"]).all()
    assert len(numpy.unique(found["picture"])) > 10


def test_readme_example(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    with open(ROOT + "/templates/README.md", encoding="utf-8") as file:
        example = re.search(r"```python\n(.*?)```", file.read(), re.DOTALL)[1]
    exec(example, {})  # pylint: disable=exec-used
    assert len(example.splitlines()) <= 12 and len(capsys.readouterr().out.splitlines()) == 2


def test_several_at_once_keep_apart(negative):
    opened = [open_negative(negative, backend) for backend in ("gl", "vk", "gl", "osmesa")]
    for number, pipeline in enumerate(opened):
        pipeline.set(white=number % 2)
    pictures = [pipeline.render("picture")["picture"] for pipeline in opened]
    assert (pictures[0] == pictures[2]).all() and (pictures[1] == pictures[3]).all()
    opened[0].close()
    assert (opened[2].render("picture")["picture"] == pictures[2]).all()


LITTLE_MEMORY = """import resource, sys, diptych
play = diptych.open  # loads the library
used = int(open("/proc/self/statm", encoding="ascii").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (int(sys.argv[2]) << 20), resource.RLIM_INFINITY))
try:
    play(sys.argv[1], size=(16, 8))
except diptych.Error as error:
    print("told:", error)
"""


@pytest.mark.parametrize("megabytes", [4, 8, 12, 16, 20, 24])
def test_little_memory_ends_no_host(tmp_path, megabytes):
    spec = tmp_path / "little.yaml"
    spec.write_text("pipeline: little\nimages:\n  grey: {format: r32f, size: [8, 8]}\npasses:\n"
                    "  - {name: fill, dispatch: 1, writes: [grey], shader: fill.glsl}\n", encoding="utf-8")
    body = "".join(f"float f{i}(float x) {{ return sin(x + {megabytes}.{i}); }}\n" for i in range(3000))  # in no cache
    (tmp_path / "fill.glsl").write_text(body + "void main() { grey_store(ivec2(0), vec4(f7(2.0))); }\n", encoding="utf-8")
    done = subprocess.run([sys.executable, "-c", LITTLE_MEMORY, spec, str(megabytes)], capture_output=True, text=True,
                          check=False, timeout=300, env={**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(diptych.__file__))})
    if "cannot allocate memory for thread-local data" in done.stderr:
        pytest.skip("glibc ends a process that has no memory for a thread")
    assert done.returncode == 0, done.stderr
    assert "out of memory" in done.stdout


@pytest.mark.parametrize("verb, arguments", [
    ("set", (None, b"1")), ("set", (b"white", None)), ("write", (None, 0, b"1234", 4)), ("write", (b"photo", 0, None, 4)),
    ("read", (None, 0, ctypes.byref(ctypes.create_string_buffer(64)))), ("read", (b"picture", 0, None)), ("camera", (None, None, None)),
    ("timings", (None,)), ("compare", (None,)), ("describe", ()), ("render", (None, None)), ("resize", (0, 0)), ("undefined", ())])
def test_null_is_refused(negative, verb, arguments):
    library = ctypes.CDLL(diptych._library._name)  # types of arguments are not checked
    function = getattr(library, "dt_play_" + verb)
    assert not library.dt_play_open(None) and not function(None, *arguments) & 0xff
    if None in arguments and verb not in ("render", "compare"):
        with open_negative(negative) as pipeline:
            with pytest.raises(diptych.Error, match=f"{verb}: a pointer is NULL"):
                pipeline._check(function(ctypes.c_void_p(pipeline._player), *arguments) & 0xff)


ENVIRONMENT = """import ctypes, sys, diptych
getenv = ctypes.CDLL(None).getenv
getenv.restype = ctypes.c_char_p
names = b"GALLIUM_DRIVER", b"LIBGL_ALWAYS_SOFTWARE", b"NODEVICE_SELECT", b"VK_LAYER_SYNCVAL_SHADER_ACCESSES_HEURISTIC"
before = [getenv(name) for name in names]
for backend in "vk", "gl", "zink":
    try:
        diptych.open(sys.argv[1], backend, size=(16, 8), debug=True).close()
    except diptych.Error as error:
        print(backend, error)
print([getenv(name) for name in names] == before)
"""


def test_the_environment_is_the_hosts(negative):
    settings = ("GALLIUM_DRIVER", "VK_LAYER_SYNCVAL_SHADER_ACCESSES_HEURISTIC")
    done = subprocess.run([sys.executable, "-c", ENVIRONMENT, negative], capture_output=True, text=True, check=True,
                          env={**{name: value for name, value in os.environ.items() if name not in settings},
                               "PYTHONPATH": os.path.dirname(os.path.dirname(diptych.__file__))})
    assert re.fullmatch("zink .*set GALLIUM_DRIVER=zink.*\nTrue\n", done.stdout, re.DOTALL), done.stdout


def test_python_keeps_its_signals(negative):
    with open_negative(negative), pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        signal.sigtimedwait([], 1)


def test_quantiles_are_those_of_numpy():
    from diptych import bench
    for values in ([5, 1, 3], [3, 1, 4, 2], [7.0], [index * 8 % 21 * 10 for index in range(21)]):
        found = bench.spread(values + [None])
        assert found == {"count": len(values), **{name: pytest.approx(numpy.quantile(values, q), abs=1e-12)
                                                  for name, q in (("p5", 0.05), ("median", 0.5), ("p95", 0.95))}}
    assert bench.spread([None, None]) is None


FILLED = {"name": '<a> & "b"', "count": 3, "none": [], "no": False, "list": [{"name": "x"}, {"words": ["p", "q"]}], "inner": {"count": 4}}


@pytest.mark.parametrize("template, text", [  # as the specification of mustache says for the same tags
    ("{{name}}, {{count}}", "&lt;a&gt; &amp; &quot;b&quot;, 3"),
    ("{{#list}}[{{count}}]{{/list}}", "[3][3]"),
    ("{{#list}}{{#@rest}}, {{/@rest}}{{#words}}{{.}}{{^@rest}}+{{/@rest}}{{/words}}{{/list}}", ", p+q"),
    ("{{#none}}a{{/none}}{{^none}}b{{/none}}{{#absent}}{{absent}}{{/absent}}", "b"),
    ("{{#no}}a{{/no}}{{^no}}b{{/no}}{{#inner}}{{count}}{{/inner}}{{count}}", "b43"),
    ("a\n  {{#inner}}\n  b\n  {{/inner}}\nc\n", "a\n  b\nc\n"),
    ("a { b } {c}", "a { b } {c}"),
    ("{{>beside}}{{#inner}}{{>beside}}{{/inner}}{{#no}}{{>beside}}{{/no}}", "<3><4>"),
    ("a\n{{absent}}", "no text or number `absent`"),
    ("{{#list}}a", "not closed: the section `list`"),
    ("a\n\n{{/list}}", "no section is open of the name `list`"),
    ("{{#list}}{{/lisd}}{{/list}}", "no section is open of the name `lisd`"),
])
def test_templates_are_filled(tmp_path, template, text):
    from diptych import page
    (tmp_path / "beside").write_text("<{{count}}>")
    try:
        filled = "".join(page.fill(page.parts(template), [(FILLED, None)], str(tmp_path)))
    except ValueError as error:
        filled = str(error)
    assert filled == text
