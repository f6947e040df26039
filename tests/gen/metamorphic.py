"""Metamorphic tests: renders a pipeline and a rewrite of it that must not change a bit. Compares every resource after every pass
with its counterpart, field by field. Prints TAP.

    metamorphic.py [--all] [--only TEXT] [--seed N] BUILD

BUILD is the folder of the executables. Without --all, tries rewrites on one pipeline and one backend, which the seed draws: many
together, and each of those alone only if they fail; of the others, the seed draws half. With --all, tries each alone on every pipeline that it fits, and on
both backends."""
import argparse
import json
import os
import random
import shutil
import subprocess
import sys

import bodies
import metamorphic_rewrites as rewrites
from bodies import Failure

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCENE = os.path.join(ROOT, "scenes/cornell.yaml")
BACKENDS = ("gl", "vk")
PIPELINES = {
    "ssvp": ("templates/ssvp.yaml", {"first_vpls": 24, "second_vpls": 30, "clusters": 3, "second_clusters": 2,
                                     "kmeans_iterations": 3, "rsm_size": 32, "map_size": 32, "map_triangles": 300,
                                     "cull_triangles": 1024, "tile": [3, 2]}),
    "rsm": ("templates/rsm.yaml", {"samples": 8, "rsm_size": 32, "tile": [3, 2]}),
    "features": ("tests/specs/features.yaml", {}),
    "mips": ("tests/specs/mips.yaml", {}),
}


class Workshop:
    """Renders pipelines into dumps below one folder."""

    def __init__(self, build, seed):
        self.build = os.path.abspath(build)
        self.seed = seed
        self.folder = os.path.join(self.build, "tests/metamorphic")
        self.originals = {}
        self.generated = {}

    def run(self, *command):
        done = bodies.limited(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode != 0:
            raise Failure(f"{' '.join(command)}\nexit status {done.returncode}\n{done.stdout}")

    def backends(self, description):
        """Those that try a rewrite: all, or with a seed one of them."""
        return BACKENDS if self.seed is None else (random.Random(f"{self.seed}/{description}").choice(BACKENDS),)

    def render(self, name, spec, settings, backend):
        """The dump of the third frame."""
        folder = os.path.join(self.folder, name, backend)
        self.run(os.path.join(self.build, "diptych"), "render", "--scene", SCENE, "--spec", spec, "--backend",
                 backend, "--size", "19x11", "--frames", "3", "--dump", folder, *overrides(settings))
        return Dump(folder)

    def original(self, name, backend):
        if (name, backend) not in self.originals:
            path, settings = PIPELINES[name]
            self.originals[name, backend] = self.render(f"{name}/original", os.path.join(ROOT, path), settings, backend)
        return self.originals[name, backend]

    def generate(self, spec, settings, folder):
        folder = os.path.join(self.folder, folder)
        shutil.rmtree(folder, ignore_errors=True)
        self.run(os.path.join(self.build, "diptych-gen"), spec, "-o", folder, *overrides(settings))
        return folder

    def generated_original(self, name):
        if name not in self.generated:
            path, settings = PIPELINES[name]
            flat = rewrites.Pipeline(os.path.join(ROOT, path)).write(os.path.join(self.folder, name, "original/spec"))
            self.generated[name] = self.generate(flat, settings, f"{name}/original/generated")
        return self.generated[name]


def overrides(settings):
    return [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]


class Dump:
    """What `render --dump` wrote: entries by pass, resource and mip."""

    def __init__(self, folder):
        self.folder = folder
        with open(os.path.join(folder, "manifest.json"), encoding="utf-8") as file:
            entries = json.load(file)["entries"]
        self.entries = {(entry["pass"], entry["resource"], entry.get("mip", 0)): entry for entry in entries}

    def data(self, entry):
        with open(os.path.join(self.folder, entry["file"]), "rb") as file:
            return file.read()


NUMBERS = {"float": 1, "int": 1, "uint": 1, "bool": 1, "mat4": 16, **{
    f"{prefix}vec{n}": n for prefix in ("", "i", "u") for n in (2, 3, 4)}}


def field_size(entry, field):
    return entry["stride"] if field is None else 4 * NUMBERS[field["type"]]


def field_bytes(entry, data, field, count):
    """The bytes of one field in the first `count` elements, without the bytes between. `field` is None for the texels
    of an image."""
    stride, size, offset = entry["stride"], field_size(entry, field), field["offset"] if field else 0
    if field and field.get("array_count"):
        raise Failure(f"{entry['resource']}.{field['name']}: an array; teach field_bytes to read it")
    if size == stride:
        return data[:count * stride]
    return b"".join(data[i * stride + offset:i * stride + offset + size] for i in range(count))


def element_count(entry):
    return entry["count"] if entry["kind"] == "buffer" else entry["width"] * entry["height"] * entry["layers"]


def compare_field(where, first, second):
    """`first` and `second`: entry, its data, field. Returns the number of bytes that were compared."""
    count, size = element_count(first[0]), field_size(first[0], first[2])
    a, b = field_bytes(*first, count), field_bytes(*second, count)
    if a == b and len(a) == count * size:
        return len(a)
    place = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b))) // size
    raise Failure(f"{where}, element {place} of {count}: {a[place * size:(place + 1) * size].hex()} became "
                  f"{b[place * size:(place + 1) * size].hex()}")


def narrow(entry, data, stride):
    """The first `stride` bytes of every texel: the channels of the narrower format."""
    texels = (data[i:i + stride] for i in range(0, len(data), entry["stride"]))
    return {**entry, "stride": stride}, b"".join(texels)


def compare_entry(original, rewritten, entry, pipeline):
    """Compares one entry of the original's dump with its counterpart; returns the number of bytes."""
    mip = entry.get("mip", 0)
    pass_name, whole = entry["pass"].replace(".", "_"), entry["resource"].replace(".", "_")   # flat.py has no dots
    pass_name = pipeline.pass_names.get(pass_name, pass_name)
    fields = entry.get("fields", [None])
    compared = 0
    for field in fields:
        name = field and field["name"]
        resource, new_name = pipeline.fields.get((whole, name), (pipeline.names.get(whole, whole), name))
        where = f"{entry['pass']}: {entry['resource']}{'.' + name if name else ''}"
        other = rewritten.entries.get((pass_name, resource, mip))
        if other is None:
            raise Failure(f"{where}: the rewritten pipeline has no {pass_name}: {resource} mip {mip}")
        fitting = element_count(other) == element_count(entry) or (
            pipeline.longer and element_count(other) > element_count(entry))
        same_size = all(other.get(key) == entry.get(key) for key in ("kind", "width", "height"))
        if not fitting or not same_size:
            raise Failure(f"{where}: another size: {entry} became {other}")
        data = rewritten.data(other)
        if pipeline.wider and field is None:
            other, data = narrow(other, data, entry["stride"])
        new_field = field and next((item for item in other["fields"] if item["name"] == new_name), None)
        if field and (new_field is None or new_field["type"] != field["type"]):
            raise Failure(f"{where}: {resource} has no {new_name} of this type")
        compared += compare_field(where, (entry, original.data(entry), field), (other, data, new_field))
    return compared


def same_files(first, second):
    done = subprocess.run(["diff", "-r", first, second], check=False, stdout=subprocess.PIPE, encoding="utf-8")
    if done.returncode != 0:
        raise Failure(done.stdout)
    return sum(len(files) for _, _, files in os.walk(first))


def try_rewrite(workshop, name, description, *functions):
    """Returns a summary of the comparison; raises Failure on a difference."""
    path, settings = PIPELINES[name]
    path = os.path.join(ROOT, path)
    pipeline = rewrites.apply(functions, path, settings)
    if pipeline is None:
        raise Failure("the rewrite changed nothing")
    folder = f"{name}/{'_'.join(description.replace(',', '').replace('`', '').split())}"
    shutil.rmtree(os.path.join(workshop.folder, folder), ignore_errors=True)
    spec = pipeline.write(os.path.join(workshop.folder, folder, "spec"))
    if pipeline.same_output:
        generated = workshop.generate(spec, pipeline.settings, folder + "/generated")
        return f"{same_files(workshop.generated_original(name), generated)} generated files"
    resources = compared = 0
    backends = workshop.backends(description)
    for backend in backends:
        original = workshop.original(name, backend)
        rewritten = workshop.render(folder, spec, pipeline.settings, backend)
        for entry in original.entries.values():
            try:
                compared += compare_entry(original, rewritten, entry, pipeline)
            except Failure as failure:
                raise Failure(f"{backend}: {failure}") from None
            resources += 1
    if not compared:
        raise Failure("nothing was compared")
    return f"{resources} resources, {compared} bytes on {' and '.join(backends)}"


class Report:
    """Prints TAP."""

    def __init__(self):
        self.count = self.failed = 0

    def tell(self, good, description, found):
        self.count += 1
        self.failed += not good
        print(f"{'ok' if good else 'not ok'} {self.count} - {description}{': ' + found if good else ''}")
        print("" if good else "".join(f"# {line}\n" for line in found.splitlines()[:30]), end="", flush=True)


def try_together(workshop, report):
    """Tries groups of rewrites and reports the results. Returns those that change nothing; the caller tries the others alone."""
    descriptions = {function: description for description, (function, _) in rewrites.REWRITES.items()}
    fine = set()
    for name, functions in rewrites.TOGETHER:
        listed = [descriptions[function] for function in functions]
        try:
            found = try_rewrite(workshop, name, " and ".join(listed), *functions)
        except Failure as failure:
            report.tell(False, f"{name}: {', '.join(listed)}, together", str(failure))
        else:
            fine.update(functions)
            for description in listed:
                report.tell(True, f"{name}: {description}", f"{found}, together with {len(listed) - 1} more")
    return fine


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--seed", type=int)
    parser.add_argument("build")
    arguments = parser.parse_args()
    workshop, report = Workshop(arguments.build, None if arguments.all else arguments.seed), Report()
    print("" if arguments.seed is None else f"# seed {arguments.seed}\n", end="", flush=True)
    fine = set() if arguments.all or arguments.only else try_together(workshop, report)
    for description, (function, names) in rewrites.REWRITES.items():
        drawn = arguments.all or arguments.only or random.Random(f"{description}/{arguments.seed}").random() < 0.5
        if arguments.only not in description or function in fine or not drawn:
            continue
        for name in names if arguments.all else names[:1]:
            try:
                report.tell(True, f"{name}: {description}", try_rewrite(workshop, name, description, function))
            except Failure as failure:
                report.tell(False, f"{name}: {description}", str(failure))
    for description, (function, name) in rewrites.CONTROLS.items():
        if arguments.only not in description:
            continue
        try:
            found, noticed = try_rewrite(workshop, name, description, function), False
        except Failure as failure:
            found, noticed = str(failure).splitlines()[0], True
        report.tell(noticed, f"{name}: a change of {description} is noticed", found)
    print(f"1..{report.count}")
    sys.exit(1 if report.failed or not report.count else 0)


main()
