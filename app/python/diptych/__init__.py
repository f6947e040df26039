"""Pipelines of diptych, with resources as NumPy arrays.

    import diptych

    vk = diptych.open("templates/rsm.yaml", scene="scenes/cornell.yaml", size=(320, 180))
    gl = diptych.open("templates/rsm.yaml", scene="scenes/cornell.yaml", size=(320, 180), backend="gl")
    frame = vk.render("indirect", "rsm_position")
    frame["indirect"].shape                        # (180, 320, 4)
    print(diptych.compare(gl, vk))
    rows = diptych.sweep("folder", {"samples": [8, 16]}, spec="rsm", scene="cornell")

Images are arrays of (height, width), with layers or depth in front and channels behind where there are
several; row 0 is the bottom of the picture. Texels are numbers of the format: codes of unorm and snorm,
float16 of half, one uint32 of a packed format. Buffers are arrays of scalars, vectors, or of a structured dtype
as std430 lays it out: columns of a matrix are rows of the array, and elements of an array with padding between
them have one field, `value`. This is the content of `diptych render --dump`."""
from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .verbs import run, sweep

if TYPE_CHECKING:
    from .play import Comparison, Error, Pipeline, compare, open  # noqa: A004

__all__ = ["Error", "Pipeline", "Comparison", "open", "compare", "run", "sweep"]


def __getattr__(name: str) -> Any:
    """Loads NumPy and the library with the first name: what plans many runs needs neither."""
    if name not in __all__ and (not name.startswith("_") or name.startswith("__")):
        raise AttributeError(name)  # also asked for a module before it is imported
    return getattr(importlib.import_module(".play", __name__), name)
