"""Structs of tests/specs/layouts.yaml: what shaders fill by field lies where the manifest's fields say, where std430 says, and where
the generated C structs have it; shaders see the live block that C fills. Prints TAP; called by layout_test.sh."""
import os
import subprocess
import sys
import tempfile

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/app/python", ROOT + "/tests/gen"]
import bodies  # noqa: E402: from the paths above
import diptych  # noqa: E402

SPEC = ROOT + "/tests/specs/layouts.yaml"
GEN = os.path.join(os.environ.get("DIPTYCH_BUILD", ROOT + "/build"), "diptych-gen")
STRUCTS = {"tight": "Tight", "holes": "Holes", "arrays": "Arrays", "matrices": "Matrix"}


def render(backend):
    with diptych.open(SPEC, backend, size=(8, 8), sets={"gain": 1.5}) as pipeline:
        strides = {item["name"]: item["stride"] for item in pipeline.description["resources"]}
        return {**pipeline.render(*STRUCTS, "scalars", "vectors", "seen"), "strides": strides}


def holds(truth, what):
    if not np.all(truth):
        raise AssertionError(what)


def test_fields_have_the_values_that_shaders_store(backend):
    """100 * element + a running number."""
    left = render(backend)
    for name in *STRUCTS, "scalars", "vectors":
        rows = left[name]
        fields = [rows[field] for field in rows.dtype.names] if rows.dtype.names else [rows]
        fields = [field["value"] if field.dtype.names else field for field in fields]  # vec3 in an array
        found = np.concatenate([field.reshape(3, -1) for field in fields], 1)
        holds(found == 100 * np.arange(3)[:, None] + 1 + np.arange(found.shape[1]), f"{name}: {found}")
    # OpenGL 4.6 core, 7.6.2.2, rules 3 and 4
    holds((left["strides"]["scalars"], left["strides"]["vectors"]) == (4, 16), "strides")


def test_structs_in_c_have_the_same_places(backend):
    left = render(backend)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([GEN, SPEC, "-o", folder], check=True, stdout=subprocess.DEVNULL)
        with open(folder + "/places.c", "w", encoding="utf-8") as file:
            file.write('#include <stddef.h>\n#include "layouts.h"\n')
            for name, struct in {**STRUCTS, "seen": "Seen"}.items():
                kind = left[name].dtype
                file.write(f'_Static_assert(sizeof(struct layouts_{struct}) == {kind.itemsize}, "");\n')
                file.writelines(f'_Static_assert(offsetof(struct layouts_{struct}, {field}) == {at}, "");\n'
                                f'_Static_assert(sizeof(((struct layouts_{struct} *)0)->{field}) == {what.itemsize}, "");\n'
                                for field, (what, at) in kind.fields.items())
        told = subprocess.run(["cc", "-std=c11", "-fsyntax-only", f"-I{ROOT}/templates/c", folder + "/places.c"], capture_output=True,
                              text=True, check=False)
    holds(told.returncode == 0, told.stderr)


def test_shaders_see_the_live_block(backend):
    seen = render(backend)["seen"][0]
    for name, value in {"gain": 1.5, "tint": (0.25, 0.5, 0.75), "steps": 7, "grid": (3, 5), "flag": 1}.items():
        holds(seen[name] == value, f"{name}: {seen[name]}")


if __name__ == "__main__":
    bodies.run_tests(globals(), ("gl", "vk"), errors=(AssertionError, OSError, subprocess.CalledProcessError, diptych.Error))
