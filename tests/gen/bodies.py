"""Specs of many bodies, one pass each, whose results are a few floats. corpus.py and random_glsl.py write, check and render them.

A body is compute GLSL for one invocation. It reads the live parameters one, two, three and half_ (1, 2, 3, 0.5) and stores to
`result[i]`."""
import json
import os
import random
import re
import resource
import shutil
import struct
import subprocess
import tempfile

SECONDS = 240  # of processor time, for each process of a command
HEAD = """pipeline: {name}
params:
  one: {{value: 1.0, live: true}}
  two: {{value: 2.0, live: true}}
  three: {{value: 3.0, live: true}}
  half_: {{value: 0.5, live: true}}
"""


class Failure(Exception):
    """A command that failed, with its output."""


def limited(command, seconds=SECONDS, **more):
    """subprocess.run with limits: on a busy machine the time on the wall says nothing, so that limit is for commands that wait
    for something that does not come. Raises Failure after it."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    try:
        return subprocess.run(command, stdin=subprocess.DEVNULL, check=False, encoding="utf-8", errors="replace", preexec_fn=limit,
                              timeout=20 * seconds, **more)
    except subprocess.TimeoutExpired:
        raise Failure(f"{' '.join(command)}\nnot done after {20 * seconds} s") from None


def run(*command):
    done = limited(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != 0:
        raise Failure(f"{' '.join(command)}\nexit status {done.returncode}\n{done.stdout}")


class Bodies:
    """Bodies in one folder, NAME.glsl each, with the number of their results: {name: count}."""

    def __init__(self, build, folder, counts):
        self.build = os.path.abspath(build)
        self.folder = folder
        self.counts = counts

    def spec(self, names, file):
        """Writes a spec of these bodies beside them."""
        lines = [HEAD.format(name=file), "buffers:\n"]
        lines += [f"  out_{name}: {{of: float, count: {self.counts[name]}}}\n" for name in names]
        lines.append("passes:\n")
        lines += [f"  - {{name: {name}, dispatch: 1, local: 1, writes: [{{name: out_{name}, as: result}}], "
                  f"shader: {name}.glsl}}\n" for name in names]
        path = os.path.join(self.folder, f"{file}.yaml")
        with open(path, "w", encoding="utf-8") as out:
            out.writelines(lines)
        return path

    def check(self, names, exactness):
        """Raises Failure if a body is refused."""
        run(os.path.join(self.build, "diptych-gen"), self.spec(names, "checked"), "--check", "--set", f"exactness={exactness}")

    def render(self, names, side, exactness):
        """{name: [bits of each result]} from one backend. Raises Failure."""
        dump = os.path.join(self.folder, "dump")
        shutil.rmtree(dump, ignore_errors=True)
        run(os.path.join(self.build, "diptych"), "render", "--spec", self.spec(names, "rendered"), "--backend", side, "--size",
            "16x16", "--dump", dump, "--set", f"exactness={exactness}")
        with open(os.path.join(dump, "manifest.json"), encoding="utf-8") as file:
            entries = json.load(file)["entries"]
        found = {}
        for entry in entries:
            count = self.counts[entry["pass"]]
            with open(os.path.join(dump, entry["file"]), "rb") as file:
                found[entry["pass"]] = struct.unpack(f"{count}I", file.read(4 * count))
        return found


def ends_alike(name, errors, attempt):
    """Whether this name alone fails with the same errors."""
    try:
        attempt([name])
    except Failure as failure:
        return errors == [line for line in str(failure).splitlines() if "error" in line.lower()]
    return False


def guilty(names, attempt, whole=True):
    """The names that make `attempt(names)` raise Failure, each with its reason: {name: text}. Takes those that the errors name,
    tries the others again, and halves the list where the errors name none.
    Where both ends fail as the `whole` does, as without a device, blames all."""
    if not names:
        return {}
    try:
        attempt(names)
        return {}
    except Failure as failure:
        errors = [line for line in str(failure).splitlines() if "error" in line.lower()] or [str(failure)]
    if len(names) == 1:
        return {names[0]: "\n".join(errors)}
    named = {name: "\n".join(lines) for name in names
             if (lines := [line for line in errors if re.search(rf"\b(pass {name}|{name}\.glsl)\b", line)])}
    if named:
        return {**named, **guilty([name for name in names if name not in named], attempt)}
    if whole and all(ends_alike(name, errors, attempt) for name in (names[0], names[-1])):
        return {name: "\n".join(errors) for name in names}
    middle = len(names) // 2
    return {**guilty(names[:middle], attempt, False), **guilty(names[middle:], attempt, False)}


def as_float(bits):
    return struct.unpack("f", struct.pack("I", bits))[0]


def as_bits(value):
    return struct.unpack("I", struct.pack("f", value))[0]


def near(seen, want):
    """Whether a result of fast mode is that of exact mode but for rounding."""
    return abs(seen - want) <= 1e-3 * max(abs(want), 1e-3)


def ulp(a, b):
    """Steps from one float to another, both as bits."""
    def place(bits):
        return bits if bits < 0x80000000 else 0x80000000 - bits
    return abs(place(a) - place(b))


class Tap:
    """Prints TAP, and the reasons of failed tests."""

    def __init__(self):
        self.count = self.failed = 0

    def result(self, description, reasons=()):
        self.count += 1
        if reasons:
            self.failed += 1
        print(f"{'not ok' if reasons else 'ok'} {self.count} - {description}", flush=True)
        for reason in reasons:
            print("\n".join(f"# {line}" for line in reason.splitlines()), flush=True)

    def skip(self, description, reason):
        self.count += 1
        print(f"ok {self.count} - {description} # SKIP {reason}")

    def finish(self):
        print(f"1..{self.count}")
        raise SystemExit(self.failed != 0)


def run_tests(names, sides, chosen="", errors=(AssertionError, OSError, ValueError, subprocess.CalledProcessError), drawn=False):
    """Runs every test_NAME of a module for each side; where there are none, `sides` is (None,). A test that raises fails. If
    `drawn`, SEED draws one side for each test; long runs take all."""
    tap = Tap()
    drawn, seed = drawn and not os.environ.get("DIPTYCH_LONG"), os.environ.get("SEED", str(random.randrange(32768)))
    if drawn:
        print(f"# SEED={seed}")
    for name, test in list(names.items()):
        of_test = (random.Random(seed + name).choice(sides),) if drawn else sides
        for side in of_test if name.startswith("test_") and chosen in name else ():
            reasons = []
            try:
                test(*([side] if side else []))
            except errors as error:
                reasons = [str(error)]
            tap.result((f"{side}: " if side else "") + name[5:].replace("_", " "), reasons)
    tap.finish()


def run_in_folder(names, chosen=""):
    """run_tests once, in a temporary folder."""
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        try:
            run_tests(names, (None,), chosen)
        finally:
            os.chdir(before)
