"""The bodies of tests/gen/corpus: GLSL as people write it, each with the results that the rules of GLSL and IEEE 754 give. Prints TAP.

    corpus.py [--only TEXT] BUILD SIDE...

BUILD is the folder of the executables, a SIDE a name for --backend. Comments at the start of a body say what is expected:
    // expect: VALUE...       the float32 results, in order
    // tolerance: ulp N       how far they may be off; without this line all bits count
    // fast: skip             exactness: fast may differ
A body in tests/gen/corpus/refused has a line `// refused: TEXT...` for each part of the message instead."""
import argparse
import os
import re
import shutil

import bodies

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CORPUS = os.path.join(ROOT, "tests/gen/corpus")


class Body:
    """A body with its expectations."""

    def __init__(self, file):
        self.name = os.path.basename(file)[:-len(".glsl")]
        self.file = os.path.relpath(file, ROOT)
        with open(file, encoding="utf-8") as text:
            marks = re.findall(r"^// (expect|tolerance|fast|refused): (.*)$", text.read(), re.MULTILINE)
        self.refused = [value for key, value in marks if key == "refused"]
        marks = dict(marks)
        self.expected = [bodies.as_bits(float(word)) for word in marks.get("expect", "").split()]
        self.ulp = int(marks.get("tolerance", "ulp 0").removeprefix("ulp "))
        self.fast = marks.get("fast") != "skip"

    def wrong(self, seen, side, right):
        """Lines about results for which `right(seen, expected)` does not hold; both as bits."""
        return [f"{self.file}: result[{i}] on {side}: expected {bodies.as_float(want):.9g} ({want:#010x}), "
                f"seen {bodies.as_float(got):.9g} ({got:#010x})"
                for i, (want, got) in enumerate(zip(self.expected, seen)) if not right(got, want)]


def read(folder, only):
    files = sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.endswith(".glsl"))
    return {body.name: body for body in map(Body, files) if only in body.name}


class Corpus:
    """The corpus on one build."""

    def __init__(self, build, only, tap):
        folder = os.path.join(os.path.abspath(build), "tests/gen/corpus")
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(CORPUS, folder)
        self.tap = tap
        self.all = read(CORPUS, only)
        self.refused = read(os.path.join(CORPUS, "refused"), only)
        self.bodies = bodies.Bodies(build, folder, {name: len(body.expected) for name, body in self.all.items()})

    def accepted(self, exactness):
        """The names that compile; reports the others."""
        names = list(self.all)
        failed = bodies.guilty(names, lambda some: self.bodies.check(some, exactness))
        self.tap.result(f"{len(names)} bodies compile, {exactness}",
                        [f"{self.all[name].file}: refused\n{text}" for name, text in failed.items()])
        return [name for name in names if name not in failed]

    def rendered(self, names, side, exactness):
        """Results of the bodies that a backend runs, and a reason for each of the others."""
        try:
            return self.bodies.render(names, side, exactness), []
        except bodies.Failure:
            failed = bodies.guilty(names, lambda some: self.bodies.render(some, side, exactness))
        reasons = [f"{self.all[name].file}: does not run on {side}\n{text}" for name, text in failed.items()]
        names = [name for name in names if name not in failed]
        return self.bodies.render(names, side, exactness) if names else {}, reasons

    def test_exact(self, sides):
        names = self.accepted("exact")
        results = {}
        for side in sides:
            results[side], reasons = self.rendered(names, side, "exact")
            for name, seen in results[side].items():
                body = self.all[name]
                reasons += body.wrong(seen, side, lambda got, want, body=body: got == want or bodies.ulp(got, want) <= body.ulp > 0)
            self.tap.result(f"exact results are as GLSL's rules give them, on {side}", reasons)
        first = results[sides[0]]
        for side in sides[1:]:
            self.tap.result(f"{side} has the bits of {sides[0]}", [
                f"{self.all[name].file}: {sides[0]} {[bodies.as_float(bits) for bits in first[name]]}, "
                f"{side} {[bodies.as_float(bits) for bits in seen]}"
                for name, seen in results[side].items() if name in first and seen != first[name]])

    def test_fast(self, side):
        names = [name for name in self.accepted("fast") if self.all[name].fast]
        results, reasons = self.rendered(names, side, "fast")
        for name, seen in results.items():
            reasons += self.all[name].wrong(
                seen, side, lambda got, want: bodies.near(bodies.as_float(got), bodies.as_float(want)))
        self.tap.result(f"fast results are near the exact ones, on {side}", reasons)

    def test_refused(self):
        self.bodies.counts = {f"refused/{name}": 1 for name in self.refused}
        for name, body in self.refused.items():
            spec = os.path.join(self.bodies.folder, "refused.yaml")
            with open(spec, "w", encoding="utf-8") as out:
                out.write(bodies.HEAD.format(name="refused") + "buffers: {made: {of: float, count: 1}}\npasses:\n  - {name: make, "
                          f"dispatch: 1, local: 1, writes: [{{name: made, as: result}}], shader: refused/{name}.glsl}}\n")
            try:
                bodies.run(os.path.join(self.bodies.build, "diptych-gen"), spec, "--check")
                reasons = [f"{body.file}: accepted"]
            except bodies.Failure as failure:
                reasons = [f"{body.file}: no {text!r} in\n{failure}" for text in body.refused if text not in str(failure)]
            self.tap.result(f"{name} is refused with its reason", reasons)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", default="", help="test only bodies whose names contain this")
    parser.add_argument("build")
    parser.add_argument("sides", nargs="+")
    arguments = parser.parse_args()
    tap = bodies.Tap()
    corpus = Corpus(arguments.build, arguments.only, tap)
    if corpus.all:
        corpus.test_exact(arguments.sides)
        corpus.test_fast(next(side for side in arguments.sides if side.startswith("vk")))
    corpus.test_refused()
    tap.finish()


if __name__ == "__main__":
    main()
