"""PNG files."""
from __future__ import annotations

import struct
import zlib

import numpy as np


def encode_png(array: np.ndarray) -> bytes:
    """Bytes of (height, width) or (height, width, channels); row 0 is the top."""
    height, width, *channels = array.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    color = {(): 0, (2,): 4, (3,): 2, (4,): 6}[tuple(channels)]  # grey, grey with alpha, RGB, RGBA
    rows = b"".join(b"\0" + row.tobytes() for row in array)
    head = struct.pack(">IIBBBBB", width, height, 8, color, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
