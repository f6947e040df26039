"""Joins PNG files of one size and type into an animated PNG, without decoding them.

usage: /usr/bin/python3 animate.py MILLISECONDS PNG... >ANIMATED

It shows the pictures in their order, then back to the first, and repeats."""
import struct
import sys
import zlib

HEAD = b"\x89PNG\r\n\x1a\n"


def chunks(path):
    with open(path, "rb") as file:
        data = file.read()
    at = len(HEAD)
    while at < len(data):
        length = struct.unpack_from(">I", data, at)[0]
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += length + 12


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


delay, paths = int(sys.argv[1]), sys.argv[2:]
pictures = [list(chunks(path)) for path in paths + paths[-2:0:-1]]
heads = {dict(picture)[b"IHDR"] for picture in pictures}
if len(heads) != 1:
    sys.exit("the pictures have several sizes or types")
head = heads.pop()
out = [HEAD, chunk(b"IHDR", head), chunk(b"acTL", struct.pack(">2I", len(pictures), 0))]
sequence = 0
for index, picture in enumerate(pictures):
    out.append(chunk(b"fcTL", struct.pack(">I8s2I2H2B", sequence, head[:8], 0, 0, delay, 1000, 0, 0)))
    sequence += 1
    for kind, data in picture:
        if kind == b"IDAT" and index:
            out.append(chunk(b"fdAT", struct.pack(">I", sequence) + data))
            sequence += 1
        elif kind == b"IDAT":
            out.append(chunk(kind, data))
sys.stdout.buffer.write(b"".join(out) + chunk(b"IEND", b""))
