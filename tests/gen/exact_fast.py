"""Exact mode beside fast mode on equal inputs. build/equal-inputs gives each pass in fast mode what the exact passes before it
left. Both results must be near: floats within 0.1 %, integers equal, but for a tiny share of elements. REASONS and FUNCTIONS
have the exceptions. OpenGL and Vulkan share a fault of exact mode, so `compare` cannot find it; this test can. Prints TAP;
called by exact_fast_test.sh.

    exact_fast.py [--long] BUILD"""
import fnmatch
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, ROOT + "/app/python")
import diptych  # noqa: E402: from the path above

NEAR = 1e-3  # relative; one unit in the last place of a half is at most 2^-10 of it
FLOOR = 1e-3  # of a field's root mean square: smaller numbers count as so large
TINY = 2e-4  # share of elements that need no reason
CLEAR = 1e30  # clear value of maps of distances

# (pipeline, pass, resource): what bounds the exceptions, and why. `share`: of elements beyond NEAR; `most`: largest difference,
# absolute, of integers and codes in units.
REASONS = {
    ("*", "tonemap", "display"): {"share": 0.02, "most": 1, "why": "rounds to codes of 8 bits"},
    ("post", "bright", "glow"): {
        "share": 0.3,
        "most": 0.002,
        "why": "fast mode has the driver's filter, of few bits; less the threshold, little is left",
    },
    ("post", "grading", "graded"): {"share": 0.6, "most": 2, "why": "the driver's filter of codes, of few bits"},
    ("post", "smooth_edges", "display"): {
        "share": 0.1,
        "outliers": 2e-3,
        "most": 1,
        "why": "the driver's filter; rows == columns decides whether an edge runs along x",
    },
    ("*", "*.map.test", "*.map.masks"): {
        "share": 1e-5,
        "why": "a triangle is as far from the centre of a texel as rasterizers may snap",
    },
    ("*", "*.map", "*.number"): {"share": 1e-4, "why": "the edge of two triangles meets the centre of a texel"},
    ("*", "maps", "map_triangle"): {"share": 1e-4, "why": "as *.map; or two surfaces are equally far"},
}

# tests/specs/arithmetic.yaml and exact.yaml: the precision that Vulkan demands of fast functions, twice, since
# exact ones err, too; relative. Errors add up in functions that others make: those have NEAR.
FUNCTIONS = {
    ("arithmetic", "evaluate", "functions.quotient*"): {"near": 6e-7, "why": "2.5 ulp"},
    ("arithmetic", "evaluate", "functions.*sqrt"): {"near": 5e-7, "why": "2 ulp"},
    ("arithmetic", "evaluate", "functions.exp*"): {"near": 5e-5, "why": "3 + 2 |x| ulp"},
    ("arithmetic", "evaluate", "functions.log*"): {"near": 5e-5, "why": "2^-21 from 0.5 to 2, else 3 ulp"},
    ("arithmetic", "evaluate", "functions.pow"): {"near": 5e-4, "why": "exp2(y log2(x))"},
    ("exact", "place", "places.compared"): {"share": 0.6, "why": "0.1 * a * 0.3 == 0.1 * 0.3 * a, where drivers regroup"},
    ("exact", "place", "places.decided"): {"share": 0.6, "why": "as places.compared"},
}
SPECIAL = {"exact": 256}  # elements of special values, whose results GLSL leaves open


# ---- Dumps -------------------------------------------------------------------------------------------


class Dump:
    def __init__(self, folder):
        self.folder = folder
        with open(folder + "/manifest.json", encoding="utf-8") as file:
            self.entries = json.load(file)["entries"]

    def fields(self, entry):
        """{FIELD: array of elements and their numbers}; without a struct, the field is ''."""
        with open(f"{self.folder}/{entry['file']}", "rb") as file:
            data = file.read()
        if entry["kind"] == "image":
            dtype, channels = diptych._texel_dtype(entry)  # pylint: disable=protected-access
            return {"": np.frombuffer(data, dtype).reshape(-1, channels)}
        dtype = diptych._fields_dtype(entry["fields"], entry["stride"])  # pylint: disable=protected-access
        array = np.frombuffer(data, dtype)
        plain = not entry["fields"][0]["name"]
        return {"" if plain else name: self.numbers(array[name]) for name in dtype.names}

    @staticmethod
    def numbers(array):
        while array.dtype.names:
            array = array[array.dtype.names[0]]
        return array.reshape(len(array), -1)


def differences(exact, fast):
    """Of each number: absolute, and relative. Any difference of integers is infinite."""
    if exact.dtype.kind != "f":
        apart = np.abs(exact.astype(np.int64) - fast.astype(np.int64))
        return apart, np.where(apart > 0, np.inf, 0)
    a, b = exact.astype(np.float64), fast.astype(np.float64)
    usual = a[np.isfinite(a) & (np.abs(a) < CLEAR)]
    floor = FLOOR * np.sqrt(np.mean(usual**2)) if usual.size else 0
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0, np.abs(a - b))
        apart = np.where(np.isnan(apart), np.inf, apart)
        size = np.maximum(np.maximum(np.abs(a), np.abs(b)), max(floor, np.finfo(np.float32).tiny))
        return apart, np.where(np.isinf(apart), np.inf, apart / size)


def reason_of(pipeline, step, resource, field):
    place = (pipeline, step, f"{resource}.{field}" if field else resource)
    for pattern, reason in {**REASONS, **FUNCTIONS}.items():
        if all(fnmatch.fnmatchcase(name, part) for name, part in zip(place, pattern)):
            return reason
    return {}


def judge(pipeline, entry, name, exact, fast):
    """(whether bits differ, what is wrong, or nothing)"""
    first = SPECIAL.get(pipeline, 0)
    apart, relative = differences(exact[first:], fast[first:])
    reason = reason_of(pipeline, entry["pass"], entry["resource"], name)
    near = reason.get("near", NEAR)
    beyond = (relative > near).any(1)
    outliers = (apart > reason.get("most", np.inf)).any(1)
    wrong = [f"{flags.sum()} of {len(flags)} elements {text}, at most {allowed:g} of them may" for flags, allowed, text in (
        (beyond, reason.get("share", TINY if exact.dtype.kind == "f" else 0), f"are beyond {near:g}"),
        (outliers, reason.get("outliers", 0), f"are more than {reason.get('most')} apart"),
    ) if flags.sum() > allowed * len(flags)]  # fmt: skip
    if wrong:
        at = np.unravel_index((apart if outliers.any() else relative).argmax(), apart.shape)
        place = f"{entry['pass']}: {entry['resource']}{'.' + name if name else ''}[{first + at[0]}], number {at[1]}"
        wrong.append(f"{place}: exact {exact[first:][at]!r}, fast {fast[first:][at]!r}")
    return (apart > 0).any(), "; ".join(wrong)


# ---- Runs --------------------------------------------------------------------------------------------


def compare(build, templates, pipeline, backend, options):
    """([what is wrong], the number of resources with other bits)"""
    with tempfile.TemporaryDirectory() as folder:
        spec = f"{'tests/specs' if pipeline in ('arithmetic', 'exact') else templates}/{pipeline}.yaml"
        command = [build + "/equal-inputs", "--spec", spec, "--backend", backend, "--dump", folder + "/dump", *options]
        done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=ROOT)
        if done.returncode:
            return [f"{' '.join(command)}: exit status {done.returncode}", done.stderr], 0
        exact, fast = Dump(folder + "/dump/exact"), Dump(folder + "/dump/fast")
        wrong, differing = [], 0
        for entry in exact.entries:
            numbers = exact.fields(entry), fast.fields(entry)
            for name in numbers[0]:
                other, text = judge(pipeline, entry, name, numbers[0][name], numbers[1][name])
                differing += other
                wrong += [text] if text else []
        return wrong, differing


def options_of(scene, size, sets, *more):
    return [*(["--scene", f"scenes/{scene}.yaml", "--size", size] if scene else []), *more,
            *(word for name, value in sets.items() for word in ("--set", f"{name}={value}"))]  # fmt: skip


def runs(long):
    """(pipeline, scene, backends, options); SEED draws three of the pipelines with a scene."""
    seed = os.environ.get("SEED") or random.randrange(1000)
    print(f"# seed {seed}")
    drawn = random.Random(seed).sample(("rsm", "ssvp", "clustered", "instant_radiosity", "deep", "ssdo", "taa"), 3)
    gl, vk, both = ("gl",), ("vk@llvmpipe",), ("gl", "vk@llvmpipe")
    size = "160x90" if long else "72x40"
    rsm = {"rsm_size": 128 if long else 64}
    maps = dict(rsm, map_size=64 if long else 32)
    many = dict(maps, first_vpls=64 if long else 24)
    # The default 0.5 puts taps on borders of texels, where rounding picks one of two texels.
    gather = dict(rsm, gather_radius=0.37)
    for scene in ("cornell", "atrium") if long else ("cornell",):
        motion = ("--frames", "3", "--motion", f"scenes/{scene}_walk.yaml")
        for pipeline, backends, sets, more in (
            ("rsm", gl, gather, ()), ("ssvp", vk, maps, ()), ("clustered", gl, maps, ()),
            ("instant_radiosity", vk, many, ()), ("deep", gl, rsm, ()), ("ssdo", vk, rsm, ()), ("taa", gl, rsm, motion),
        ):  # fmt: skip
            if long or pipeline in drawn:
                yield pipeline, scene, both if long else backends, options_of(scene, size, sets, *more)
    yield "post", None, both, options_of(None, None, {}, "--input", "photo=templates/pictures/post.png")
    yield "arithmetic", None, both, options_of(None, None, {"finite": "true"}, "--size", "8x8")
    yield "exact", "cornell", both, options_of("cornell", "9x5", {})
    yield "machine", None, both if long else vk, options_of(None, None, {"copy_side": 64, "side": 64}, "--size", "8x8")


# ---- NaN, infinity and zeros -------------------------------------------------------------------------


def chosen(x, y):
    """What tests/specs/nan.glsl leaves by IEEE 754-2019. NumPy leaves open which zero is less."""

    def least(a, b):
        return np.where((a == 0) & (b == 0), np.where(np.signbit(a), a, b), np.fmin(a, b))

    def most(a, b):
        return np.where((a == 0) & (b == 0), np.where(np.signbit(a), b, a), np.fmax(a, b))

    def inside(low, high):
        return least(most(x, np.float32(low)), np.float32(high))

    zero, one, tests = np.zeros_like(x), np.ones_like(x), (x < y, x <= y, x > y, x >= y, x == y, x != y, ~(x < y), ~(x >= y),
            np.isnan(x), np.isinf(x), np.isnan(x), ~(x >= y), (x < y) | (x > y))  # fmt: skip
    away, far = np.abs(y), least(most(x * np.float32(1.5e9), np.float32(-2147483648)), np.float32(2147483520))
    t = least(most((x + one) * np.float32(0.5), zero), one)
    return {"least": least(x, y), "most": most(x, y), "inside": least(most(x, -zero), np.abs(y)), "at_least": most(x, zero),
            "at_most": least(x, zero), "unit": inside(0, 1), "between": inside(-1, 0.5), "same_least": least(x, y),
            "ends": np.stack([least(most(x, -zero), y), least(most(x, one * np.float32(0.5)), zero)], 1),
            "same_most": most(x, -one), "same_inside": inside(0, 1), "stepped": np.where(y < x, zero, one),
            "eased": t * t * (3 - 2 * t), "mixed": x * np.float32(0.5) + y * np.float32(0.5), "picked": np.where(x < y, x, y),
            "proven": np.stack([most(np.abs(x), away), least(np.abs(x), away), most(x * x, away),
                                least(most(one * np.float32(0.5), x), one * 2)], 1),
            "whole": np.stack([far.astype(np.int32), np.where(x < y, 1, 2147483647).astype(np.int32)], 1),
            "written": np.stack([x * zero, x + zero, zero - x, x * zero + y * one], 1),
            "scaled": np.stack([x * -zero, y * 2, x * zero], 1), "shares": np.stack([x * one + y * zero, x * zero + y * one], 1),
            "compared": sum(test.astype(np.uint32) << k for k, test in enumerate(tests))}  # fmt: skip


def bits_of(array):
    """NaN has one value here."""
    return np.where(array != array, np.float32(np.nan), array).astype(array.dtype).view(np.uint32).reshape(len(array), -1)


def choices(build, backend, exactness):
    """[fields that are not those of IEEE 754]. Fast mode may choose either zero."""
    with tempfile.TemporaryDirectory() as folder:
        command = [build + "/diptych", "render", "--spec", "tests/specs/nan.yaml", "--size", "8x8", "--backend", backend, "--dump",
                   folder, "--set", "exactness=" + exactness]  # fmt: skip
        subprocess.run(command, check=True, capture_output=True, cwd=ROOT)
        dump = Dump(folder)
        fields = dump.fields(dump.entries[0])
    with np.errstate(invalid="ignore"):
        wanted = chosen(*(fields[name][:, 0] for name in "xy"))
    fast = exactness == "fast"
    for name in ("written", "scaled", "shares") if fast else ():
        wanted[name] = fields[name]
    wanted["whole"] = np.where([True, not fast], wanted["whole"], fields["whole"])  # fast mode leaves what is out of range to the driver
    return [name for name, array in wanted.items() if (bits_of(fields[name] + fast * 0) != bits_of(array + fast * 0)).any()]


def finds_fault(build):
    """A control: composite errs by 0.3 % in exact mode."""
    options = options_of("cornell", "72x40", {"rsm_size": 64, "gather_radius": 0.37})
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(ROOT + "/templates", folder + "/templates")
        path = folder + "/templates/shared/composite.glsl"
        with open(path, encoding="utf-8") as file:
            body = file.read()
        place = "    radiance_store("
        fault = "#ifdef EXACT\n    irradiance *= p.x > 30 ? 1.003 : 1.0;\n#endif\n"
        with open(path, "w", encoding="utf-8") as file:
            file.write(body.replace(place, fault + place))
        wrong, _ = compare(build, folder + "/templates", "rsm", "vk@llvmpipe", options)
        return fault not in body and len(wrong) == 1 and "composite: radiance[" in wrong[0], wrong


def main():
    long, build = "--long" in sys.argv, os.path.abspath(sys.argv[-1])
    count = failures = 0

    def tell(good, description, notes):
        nonlocal count, failures
        count += 1
        failures += not good
        print(f"{'' if good else 'not '}ok {count} - {description}")
        for line in [] if good else "\n".join(notes).splitlines():
            print("# " + line)
        sys.stdout.flush()

    for pipeline, scene, backends, options in runs(long):
        for backend in backends:
            wrong, differing = compare(build, "templates", pipeline, backend, options)
            told = f"{pipeline}{', ' + scene if scene else ''}, {backend}: exact is near fast, pass by pass"
            tell(not wrong, told, wrong)
            if not wrong and pipeline != "machine":  # which has + and * alone
                tell(differing, "... and not the same", [])
    for backend in ["gl", "vk@llvmpipe", *os.environ.get("STRANGERS", "").split()]:
        tell(not (wrong := choices(build, backend, "exact")), f"{backend}: NaN, infinity and zeros are those of IEEE 754", wrong)
    for backend in ("gl", "vk@llvmpipe"):
        tell(not (wrong := choices(build, backend, "fast")), f"... and but for zeros those of Mesa's drivers, {backend}", wrong)
    found, notes = finds_fault(build)
    tell(found, "a fault of one exact pass is found, and named", notes)
    print(f"1..{count}")
    return failures != 0


if __name__ == "__main__":
    sys.exit(main())
