"""Pipelines of diptych, played by the library libdiptych_play. The package's names come from here; see diptych_play.h."""
import ctypes
import json
import operator
import os
import sysconfig
import threading
import warnings

import numpy

from .png import encode_png

__all__ = ["Error", "Pipeline", "Comparison", "open", "compare"]


class Error(Exception):
    """A call failed; the text is that of the command line, for a wrong spec with places and carets."""


# ---- diptych_play.h ----------------------------------------------------------------------------

_LOG = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p)
_AFTER_PASS = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_uint32)
_WARNING, _ERROR = 2, 3


class _Log(ctypes.Structure):
    _fields_ = [("message", _LOG), ("user", ctypes.c_void_p)]


class _Options(ctypes.Structure):
    _fields_ = [
        ("log", _Log),
        ("spec", ctypes.c_char_p),
        ("backend", ctypes.c_char_p),
        ("scene", ctypes.c_char_p),
        ("meshes", ctypes.c_char_p),
        ("sets", ctypes.POINTER(ctypes.c_char_p)),
        ("set_count", ctypes.c_uint32),
        ("inputs", ctypes.POINTER(ctypes.c_char_p)),
        ("input_count", ctypes.c_uint32),
        ("width", ctypes.c_uint32),
        ("height", ctypes.c_uint32),
        ("debug", ctypes.c_bool),
        ("timing", ctypes.c_bool),
        ("keep_history", ctypes.c_bool),
        ("sanitize", ctypes.c_char_p),
    ]


class _Bytes(ctypes.Structure):
    _fields_ = [("data", ctypes.c_void_p), ("size", ctypes.c_size_t), ("extent", ctypes.c_uint32 * 3)]


def _load():
    """The library: installed three folders above this file, or in TRIPLET there, or in the project's build folder."""
    above = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "..")
    triplet = sysconfig.get_config_var("MULTIARCH") or ""
    paths = [os.path.join(above, folder, "libdiptych_play.so") for folder in ("", triplet, "build")]
    library = ctypes.CDLL(next(filter(os.path.exists, paths), "libdiptych_play.so"))
    text, player, u32, real = ctypes.c_char_p, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_float
    for name, result, *arguments in (
        ("open", player, ctypes.POINTER(_Options)),
        ("close", None, player),
        ("describe", text, player),
        ("set", ctypes.c_bool, player, text, text),
        ("write", ctypes.c_bool, player, text, u32, ctypes.c_void_p, ctypes.c_size_t),
        ("render", ctypes.c_bool, player, _AFTER_PASS, ctypes.c_void_p),
        ("read", ctypes.c_bool, player, text, u32, ctypes.POINTER(_Bytes)),
        ("resize", ctypes.c_bool, player, u32, u32),
        ("camera", ctypes.c_bool, player, real * 3, real * 3, real * 3, real),
        ("timings", ctypes.c_bool, player, ctypes.POINTER(ctypes.c_double)),
        ("undefined", ctypes.c_void_p, player),
        ("compare", ctypes.c_void_p, player, player),
    ):
        function = getattr(library, "dt_play_" + name)
        function.restype, function.argtypes = result, arguments
    return library


_library = _load()
_opening = threading.Lock()  # dt_play_open and dt_play_close are for one thread at a time
_free = ctypes.CDLL(None).free
_free.restype, _free.argtypes = None, [ctypes.c_void_p]


# ---- Types -------------------------------------------------------------------------------------

_SCALARS = {"float": "f4", "int": "i4", "uint": "u4", "bool": "u4"}
_VECTORS = {"vec": "f4", "ivec": "i4", "uvec": "u4"}


def _type_dtype(name):
    if name in _SCALARS:
        return numpy.dtype("<" + _SCALARS[name])
    if name == "mat4":
        return numpy.dtype(("<f4", (4, 4)))
    return numpy.dtype(("<" + _VECTORS[name[:-1]], (int(name[-1]),)))


def _fields_dtype(fields, stride):
    """A vector of three takes the room of four, as do elements of arrays with padding between them."""
    types = [_type_dtype(field["type"]) for field in fields]
    for i, field in enumerate(fields):
        if "array_count" not in field:
            continue
        if field["array_stride"] != types[i].itemsize:
            names = {"names": ["value"], "formats": [types[i]], "itemsize": field["array_stride"]}
            types[i] = numpy.dtype(names)
        types[i] = numpy.dtype((types[i], (field["array_count"],)))
    if not fields[0]["name"]:
        fields = [dict(fields[0], name="value")]
    return numpy.dtype(
        {
            "names": [field["name"] for field in fields],
            "formats": types,
            "offsets": [field["offset"] for field in fields],
            "itemsize": stride,
        }
    )


def _texel_dtype(image):
    """The dtype of the numbers of a texel, and how many there are."""
    dtype = numpy.dtype(image["number"]).newbyteorder("<")
    return dtype, image["stride"] // dtype.itemsize


def _extent(resource, mip):
    """As dt_play_read tells it: elements, or width, height, and layers or depth."""
    if resource["kind"] == "buffer":
        return (resource["count"],)
    shrinks = {"width": mip, "height": mip, "layers": mip if resource["shape"] == "3D" else 0}
    return tuple(max(resource[key] >> by, 1) for key, by in shrinks.items())


def _layout(resource, extent):
    """dtype and shape of the bytes of a buffer or of a mip."""
    if resource["kind"] == "buffer":
        return _fields_dtype(resource["fields"], resource["stride"]), (extent[0],)
    dtype, channels = _texel_dtype(resource)
    shape = (extent[1], extent[0])
    if resource["layered"]:
        shape = (extent[2],) + shape
    return dtype, shape + ((channels,) if channels > 1 else ())


def _plain(array, resource):
    """The numbers themselves of a buffer without a struct."""
    plain = resource["kind"] == "buffer" and not resource["fields"][0]["name"]
    return array["value"] if plain else array


class Text(str):
    """A value in the words of --set."""


def _value(value):
    """A number, bool or list as --set reads it."""
    return value if isinstance(value, Text) else json.dumps(numpy.asarray(value).tolist())


def _u32(what, value):
    """An unsigned integer of 32 bits: ctypes would drop the bits above."""
    try:
        value = operator.index(value)
    except TypeError:
        raise Error(f"{what} {value}: must be an integer") from None
    if not 0 <= value < 2**32:
        raise Error(f"{what} {value}: must be from 0 to {2**32 - 1}")
    return value


def _text(text):
    """Bytes of a name or path for C, where a NUL would end it."""
    text = os.fsencode(text)
    if b"\0" in text:
        raise Error(f"{text!r}: has a NUL")
    return text


# ---- Pipelines ---------------------------------------------------------------------------------


class Pipeline:
    """A pipeline with a device of its own; see open(). Use it from one thread, in the process that opened it."""

    def __init__(self, spec, backend, scene, size, sets, inputs, meshes, debug, timing, keep_history, sanitize):
        self._player, self._process, self._rendering = None, os.getpid(), False
        self._messages, self._given, self._view = [], {}, None
        self._sets, self._size = dict(sets), size
        self._log = _LOG(lambda user, level, text: self._messages.append((level, text.decode(errors="replace"))))
        files = {name: value for name, value in inputs.items() if isinstance(value, (str, os.PathLike))}
        self._paths = [_text(f"{name}={os.fspath(path)}") for name, path in files.items()]
        self._options = {
            "log": _Log(self._log, None),
            "spec": _text(spec),
            "backend": _text(backend),
            "scene": _text(scene) if scene else None,
            "meshes": _text(meshes) if meshes else None,
            "input_count": len(files),
            "debug": debug,
            "timing": timing,
            "keep_history": keep_history,
            "sanitize": _text("" if sanitize is True else sanitize) if sanitize else None,
        }
        self._player = self._start(self._sets)
        for name, value in inputs.items():
            if name not in files:
                self.write(name, value)

    def _start(self, sets):
        """Another player, with these values of parameters."""
        texts = [_text(f"{name}={_value(value)}") for name, value in sets.items()]
        options = _Options(
            sets=(ctypes.c_char_p * len(texts))(*texts),
            set_count=len(texts),
            inputs=(ctypes.c_char_p * len(self._paths))(*self._paths),
            **self._options,
        )
        if self._size is not None:
            options.width, options.height = (_u32("size", number) for number in self._size)
            if not (options.width and options.height):
                raise Error(f"size {options.width}x{options.height}: must be from 1x1")
        with _opening:
            player = _library.dt_play_open(ctypes.byref(options))
        return self._check(player)

    def _check(self, result):
        """Raises the errors of the last call; warns of its warnings."""
        messages, self._messages[:] = list(self._messages), []
        if not result:
            raise Error("\n".join(text for level, text in messages if level == _ERROR) or "out of memory")
        for level, text in messages:
            if level == _WARNING:
                warnings.warn(text, stacklevel=4)
        return result

    @property
    def description(self):
        """What `diptych list --json` tells, with backend and device; parameters have their present values."""
        return json.loads(self._check(_library.dt_play_describe(self._handle())))

    def _handle(self):
        if not self._player:
            raise Error("the pipeline is closed")
        return self._player

    def _idle(self, verb):
        if self._rendering:
            raise Error(f"{verb}: a frame is being rendered")

    def _resource(self, name):
        found = [item for item in self.description["resources"] if item["name"] == name]
        return found[0] if found else None

    def set(self, **params):
        """Sets parameters, from the next frame on: set(exposure=0.5, sky=[0, 0, 1]). One that is not live
        plans the pipeline again and begins anew with frame 0."""
        live = {param["name"]: param["live"] for param in self.description["params"]}
        if any(not live.get(name, True) for name in params):
            self._replace({**self._sets, **params})
            return
        for name, value in params.items():
            self._check(_library.dt_play_set(self._handle(), _text(name), _text(_value(value))))
            self._sets[name] = value

    def _replace(self, sets):
        """Goes on with another player. After an error all is as it was."""
        self._idle("set")
        old, given = self._player, dict(self._given)
        self._player = self._start(sets)
        try:
            for (name, mip), array in given.items():
                self.write(name, array, mip)
            if self._view:
                self.camera(*self._view)
        except Error:
            old, self._player = self._player, old
            raise
        finally:
            with _opening:
                _library.dt_play_close(old)
        self._sets = sets

    def resize(self, width, height):
        """Gives frames from the next one on another size; resources with `history` begin as zero, unless
        `keep_history` has kept them, and inputs whose size follows the frame need new content."""
        size = _u32("size", width), _u32("size", height)
        try:
            self._check(_library.dt_play_resize(self._handle(), *size))
        except Error:
            for (name, mip), array in [] if self._rendering else self._given.items():
                self.write(name, array, mip)
            raise
        self._size = size
        for name, mip in list(self._given):
            if _layout(self._resource(name), _extent(self._resource(name), mip))[1] != self._given[name, mip].shape:
                del self._given[name, mip]

    def camera(self, eye, target, up=(0, 1, 0), fov_y=40):
        """Moves the camera from the next frame on, in the scene's units; fov_y in degrees."""
        places = [numpy.asarray(place, "f4") for place in (eye, target, up)]
        if any(place.shape != (3,) for place in places):
            raise Error("camera: eye, target and up have three numbers each")
        three = [(ctypes.c_float * 3)(*place) for place in places]
        self._check(_library.dt_play_camera(self._handle(), *three, fov_y))
        self._view = (tuple(eye), tuple(target), tuple(up), fov_y)

    def write(self, name, array, mip=0):
        """Gives an input its content, which stays. The array has the shape that read gives, and numbers
        that the resource's type holds without loss of kind: float64 for float32, but no floats for codes."""
        resource = self._resource(name)
        data = b""  # of an unknown name, which the library refuses
        if resource:
            dtype, shape = _layout(resource, _extent(resource, _u32("mip", mip)))
            data = numpy.zeros(shape, dtype)
            inside = _plain(data, resource)
            array = numpy.asarray(array)
            if array.shape != inside.shape:
                raise Error(f"write {name}: the array has the shape {array.shape}, not {inside.shape}")
            if array.dtype.names != inside.dtype.names:
                raise Error(f"write {name}: the array has the type {array.dtype}, not {inside.dtype}")
            try:
                numpy.copyto(inside, array, casting="same_kind")
            except TypeError as error:
                raise Error(f"write {name}: {error}") from None
            data = data.tobytes()
        self._check(_library.dt_play_write(self._handle(), _text(name), _u32("mip", mip), data, len(data)))
        self._given[name, mip] = numpy.array(array)

    def read(self, name, mip=0):
        """The content of a resource: after a frame, of outputs, inputs and resources with `keep` or
        `history`; within after_pass, also of what the pass wrote."""
        content = _Bytes()
        self._check(_library.dt_play_read(self._handle(), _text(name), _u32("mip", mip), ctypes.byref(content)))
        resource = self._resource(name)
        dtype, shape = _layout(resource, content.extent)
        try:
            array = numpy.frombuffer(ctypes.string_at(content.data, content.size), dtype)
        finally:
            _free(content.data)
        return _plain(array.reshape(shape), resource).copy()

    def render(self, *take, after_pass=None):
        """Renders the next frame. Returns {NAME: array} of the resources to take, each as the last pass that
        writes it leaves it; (NAME, MIP) takes another mip than 0. after_pass(NAME) is called after each
        pass, and may set live parameters and read; its exception ends the frame, and the next one begins
        anew."""
        self._idle("render")
        passes = self.description["passes"] if take or after_pass else []
        taken, raised, last = {}, [], {}
        for item in take:  # inputs have no writer
            name = item if isinstance(item, str) else item[0]
            writers = [i for i, entry in enumerate(passes) if name in entry["writes"]]
            last.setdefault(writers[-1] if writers else None, []).append(item)

        def take_all(number):
            for item in last.get(number, []):
                taken[item] = self.read(*([item] if isinstance(item, str) else item))

        def after(_, number):
            try:
                if after_pass:
                    after_pass(passes[number]["name"])
                take_all(number)
            except BaseException as error:  # of any kind: it cannot go through the library
                raised.append(error)
            return not raised

        take_all(None)
        watch = _AFTER_PASS(after) if take or after_pass else _AFTER_PASS()
        self._rendering = True
        try:
            good = _library.dt_play_render(self._handle(), watch, None)
        finally:
            self._rendering = False
        if raised:
            self._messages.clear()
            raise raised[0]
        self._check(good)
        return taken

    @property
    def timings(self):
        """{PASS: milliseconds} of the last frame, for a pipeline opened with timing=True; None: skipped."""
        names = [entry["name"] for entry in self.description["passes"]]
        found = (ctypes.c_double * len(names))()
        self._check(_library.dt_play_timings(self._handle(), found))
        return {name: None if ms != ms else ms for name, ms in zip(names, found)}

    @property
    def undefined(self):
        """Undefined behaviour that the frames so far have shown, of a pipeline opened with sanitize=True: dicts with
        file, line, column, kind, message, pass, invocation, count and frame."""
        text = self._check(_library.dt_play_undefined(self._handle()))
        try:
            return json.loads(ctypes.string_at(text))
        finally:
            _free(text)

    def png(self, name=None):
        """PNG of the last frame, as bytes: of an image that read gives, of 8 bit codes; by default of the
        output `display`."""
        name = name or self.description["output"].get("display")
        if not name:
            raise Error("png: the spec has no output `display`; name an image")
        array = self.read(name)
        if array.dtype != "u1" or array.ndim - len(array.shape[2:]) != 2 or array.ndim > 3:
            raise Error(f"png {name}: it is no plain image of 8 bit codes")
        return encode_png(array[::-1])

    def _repr_png_(self):
        """What notebooks show."""
        try:
            return self.png()
        except Error:
            return None

    def close(self):
        """Closes the device; the pipeline cannot be used afterwards."""
        self._idle("close")
        player, self._player = self._player, None
        if player and self._process == os.getpid():  # a child of fork() has no part in the device
            with _opening:
                _library.dt_play_close(player)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        self.close()


def open(spec, backend="vk", scene=None, size=None, sets={}, inputs={}, meshes=None, debug=False, timing=False,
         keep_history=False, sanitize=False):
    """Reads a spec and opens a device, as the command line does.

    backend: "gl", "vk", "vk@DEVICE", "gl+glsl". size: (width, height) of the frame; by default that of an
    input file, else 1920x1080. sets: {PATH: VALUE} of --set. inputs: {NAME: array, or path of a file}.
    meshes: folder of the scene's meshes. debug: validation messages are errors. timing: for `timings`.
    keep_history: resize keeps that of resources whose size is the same.
    sanitize: for `undefined`; True, or kinds as --sanitize takes them."""
    return Pipeline(spec, backend, scene, size, sets, inputs, meshes, debug, timing, keep_history, sanitize)


# ---- Compare -----------------------------------------------------------------------------------


class Comparison:
    """agree: whether all resources are within their contracts. results: a dict for each resource after each
    pass, as `diptych compare --json` has it."""

    def __init__(self, agree, results):
        self.agree, self.results = agree, results

    def __str__(self):
        rows = [(r["pass"], r["resource"], str(r["differing"]), r["verdict"]) for r in self.results]
        rows = [("pass", "resource", "differing", "verdict")] + rows
        widths = [max(map(len, column)) for column in zip(*rows)]
        return "\n".join("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)

    def __bool__(self):
        return self.agree


def compare(a, b):
    """Renders the next frame of two pipelines and compares every resource after every pass, under the
    contracts of the spec. Both come from one spec, size and number of frames; live parameters may differ."""
    text = _library.dt_play_compare(a._handle(), b._handle())
    if not text and not any(level == _ERROR for level, _ in a._messages):
        b._check(text)
    a._check(text)
    try:
        result = json.loads(ctypes.string_at(text))
    finally:
        _free(text)
    return Comparison(result["agree"], result["results"])
