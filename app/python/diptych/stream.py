"""What the C program sends to measure: see app/truth/hand_over.h."""
from __future__ import annotations

import json
import math
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from .console import Console, Failure


def read_array(stream: BinaryIO, shape: tuple[int, ...], dtype: npt.DTypeLike) -> np.ndarray:
    size = np.dtype(dtype).itemsize * math.prod(shape)
    data = stream.read(size)
    if len(data) < size:  # its reason stands on stderr
        raise Failure
    return np.frombuffer(data, dtype).reshape(shape)


def read_picture(stream: BinaryIO, console: Console) -> np.ndarray:
    """(height, width, 4). No width: it cannot be read, and errors follow, which were printed."""
    width, height = map(int, read_array(stream, (2,), np.uint32))
    if not width:
        console.errors += json.loads(stream.read())
        raise Failure
    return read_array(stream, (height, width, 4), np.float32)
