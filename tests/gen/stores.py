#!/usr/bin/env python3
"""For stores_test.sh: `make FOLDER` writes values.npy and fractions.npy; `check DUMP FOLDER` decodes the codes that
tests/specs/stores.yaml stored. Each must equal the nearest code, ties to even, which Python's own arithmetic gives. What the spec then
read must equal code / most, as near as floats come."""
import glob, itertools, math, struct, sys

COUNT = 96000


def single(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def beside(x):
    """x and its neighbours among floats."""
    bits = struct.unpack("<I", struct.pack("<f", x))[0]
    return [struct.unpack("<f", struct.pack("<I", b))[0] for b in (bits - 1, bits, bits + 1)]


def halves():
    return [struct.unpack("<e", struct.pack("<H", bits))[0] for bits in range(0x7C00)] + [65536.0]


def write(path, numbers):
    numbers = (numbers + [0.0] * COUNT)[:COUNT]
    head = "{'descr': '<f4', 'fortran_order': False, 'shape': (%d,), }" % COUNT
    head += " " * (-(len(head) + 11) % 64) + "\n"
    with open(path, "wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode())
        file.write(struct.pack("<%df" % COUNT, *numbers))


def make(folder):
    grid = halves()
    values = [v for a, b in zip(grid, grid[1:]) for v in beside((a + b) / 2)]
    values = [-v if i % 5 == 4 else v for i, v in enumerate(values)] + [1e-9, 7e4, 1e9, 3e38] + [struct.unpack("<f", struct.pack("<I", b))[0] for b in range(0x8000, 0x12000, 0x1000)]
    write(folder + "/values.npy", values)
    codes = itertools.chain(*(((k + 0.5) / most for k in range(0, most, step))
                              for most, step in ((255, 1), (1023, 1), (3, 1), (32767, 5), (65535, 5))))
    fractions = [v for x in codes for v in beside(x)]
    fractions += [-0.2 + 1.4 * i / 30000 for i in range(30000)] + [0.0, 1.0, -0.0, -1.0, -2.0, 2.0]
    write(folder + "/fractions.npy", fractions)


def read(path):
    data = open(path, "rb").read()
    return struct.unpack("<%df" % COUNT, data[-4 * COUNT:])


def nearest(x, bits):
    """The nearest float with 5 bits of exponent and `bits` of mantissa, for x >= 0; the exponent has no upper limit."""
    exponent = max(math.frexp(x)[1] - 1, -14) if x else -14
    return math.ldexp(round(math.ldexp(x, bits - exponent)), exponent - bits)  # round: ties to even


def half(x):
    return math.copysign(min(nearest(abs(x), 10), 65504.0), x)


def small(x, bits):
    most = 65024.0 if bits == 6 else 64512.0
    return min(nearest(x, bits), most) if x > 0 else 0.0


def small_value(code, bits):
    exponent, mantissa = code >> bits, code & (1 << bits) - 1
    return math.ldexp(mantissa + ((1 << bits) if exponent else 0), max(exponent, 1) - 15 - bits)


def unorm(x, most):
    return round(single(min(max(x, 0.0), 1.0) * most))


def expect(name, found, wanted, inputs):
    wrong = [(x, f, w) for x, f, w in zip(inputs, found, wanted) if f != w]
    assert len(found) == COUNT, name
    assert not wrong, f"{name}: {len(wrong)} wrong, the first (input, found, nearest): {wrong[:4]}"


def check(dump, folder):
    values, fractions = read(folder + "/values.npy"), read(folder + "/fractions.npy")

    def load(name, code):
        return struct.unpack(f"<{COUNT}{code}", open(glob.glob(f"{dump}/*.{name}.raw")[0], "rb").read()[:])

    expect("r16f", load("store.half_stored", "e"), [half(x) for x in values], values)
    drawn = open(glob.glob(f"{dump}/??.draw.half_drawn.raw")[0], "rb").read()
    expect("rgba16f", struct.unpack(f"<{4 * COUNT}e", drawn)[2::4], [half(x) for x in values], values)
    for name in ("store.packed_stored", "draw.packed_drawn"):
        codes = load(name, "I")
        expect(name, [small_value(c & 0x7FF, 6) for c in codes], [small(x, 6) for x in values], values)
        expect(name, [small_value(c >> 22, 5) for c in codes], [small(x, 5) for x in values], values)
    for name in ("store.unorm8_stored", "draw.unorm8_drawn"):
        expect(name, [c & 255 for c in load(name, "I")], [unorm(x, 255) for x in fractions], fractions)
    for name in ("store.unorm10_stored", "draw.unorm10_drawn"):
        codes = load(name, "I")
        expect(name, [c & 1023 for c in codes], [unorm(x, 1023) for x in fractions], fractions)
        expect(name, [c >> 30 for c in codes], [unorm(x, 3) for x in fractions], fractions)
    expect("r16", load("store.unorm16_stored", "H"), [unorm(x, 65535) for x in fractions], fractions)
    snorm = [int(math.copysign(unorm(abs(x), 32767), x)) for x in fractions]
    bits = struct.unpack(f"<{COUNT}I", struct.pack(f"<{COUNT}f", *values))
    signed = struct.unpack(f"<{COUNT}i", struct.pack(f"<{COUNT}f", *values))
    for name, code, wanted in (("store.bytes_stored", "B", [min(x, 255) for x in bits]),
                               ("store.shorts_stored", "h", [min(max(x, -32768), 32767) for x in signed]),
                               ("draw.bytes_drawn", "b", [min(max(x, -128), 127) for x in signed]),
                               ("draw.shorts_drawn", "H", [min(x, 65535) for x in bits])):
        expect(name, load(name, code), wanted, values)
    expect("r16_snorm", load("store.snorm16_stored", "h"), snorm, fractions)


    codes = load("store.unorm10_stored", "I")
    columns = [[single(c / most) for c in column] for column, most in (
        ([c & 255 for c in load("store.unorm8_stored", "I")], 255), ([c & 1023 for c in codes], 1023), ([c >> 30 for c in codes], 3),
        (load("store.unorm16_stored", "H"), 65535))]
    signed_values = [single(max(c, -32767) / 32767) for c in load("store.snorm16_stored", "h")]

    def texels(name, channels):
        return list(struct.iter_unpack(f"<{channels}f", open(f"{dump}/{name}.raw", "rb").read()))

    expect("texels", texels("02.fetch.fetched", 4), list(zip(*columns)), fractions)
    expect("texels of an image that is stored", texels("03.load.loaded", 4), list(zip(*columns)), fractions)
    expect("signed texels", texels("03.load.shorts", 2), list(zip(signed_values, signed_values)), fractions)
    expect("sampled texels", texels("02.fetch.sampled", 2), list(zip(columns[0], signed_values)), fractions)
    for name in ("unorm8", "unorm10", "unorm16", "snorm16"):
        expect(name + ", stored again", load(f"load.{name}_stored", "H" if "16" in name else "I"), load(f"store.{name}_stored", "H" if "16" in name else "I"), fractions)


def own(dump):
    """What the shaders of stores_test.sh left that declare everything themselves."""
    def load(name, code):
        return list(struct.iter_unpack("<" + code, open(f"{dump}/{name}.raw", "rb").read()))

    columns = range(256)
    assert [c[0] for c in load("00.fill.codes", "4B")] == list(columns)
    shorts = [min(max(x * 257 - 32768, -32767), 32767) for x in columns]
    assert [c[0] for c in load("00.fill.shorts", "h")] == shorts
    wanted = [(single(x / 255), single(s / 32767)) for x, s in zip(columns, shorts)]
    assert load("01.look.read", "2f") == wanted, load("01.look.read", "2f")
    half = single(0.5 / 255)
    wanted = [(64, 64) if x + 0.5 > 200 else (unorm(single(single(x / 255) + half), 255), 0) for x in columns]
    assert load("02.draw.halves", "2B") == wanted, load("02.draw.halves", "2B")


if __name__ == "__main__":
    {"make": make, "check": check, "own": own}[sys.argv[1]](*sys.argv[2:])
