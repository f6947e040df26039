#!/usr/bin/env python3
"""Makes and reads the files of outside_test.sh without diptych: PNG, OpenEXR, HDR and .npy. Computes the expected results of the
pipeline tests/specs/outside.yaml."""
import json
import math
import struct
import sys
import zlib

WIDTH, HEIGHT = 45, 21  # odd, for mips


def write_png(path, width, height, texel, before=()):
    """8 bit RGB; texel(x, y) is three codes, row 0 at the top. before: chunks before the pixels, name and content."""
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    with open(path, "wb") as out:
        chunks = b"".join(chunk(*each) for each in before)
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunks + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def write_exr(path, width, height, texel, corner=(0, 0), display=None, names=("R", "G", "B")):
    """Channels of float, not compressed; the data window begins at the corner. display: left, top, right, bottom. names: of the numbers
    of a texel."""
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data

    x, y = corner
    box = struct.pack("<4i", x, y, x + width - 1, y + height - 1)
    channels = b"".join(n + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for n in sorted(name.encode() for name in names)) + b"\0"
    head = b"\x76\x2f\x31\x01\x02\0\0\0" + attribute(b"channels", b"chlist", channels)
    head += attribute(b"compression", b"compression", b"\0") + attribute(b"dataWindow", b"box2i", box)
    head += attribute(b"displayWindow", b"box2i", struct.pack("<4i", *display) if display else box) + attribute(b"lineOrder", b"lineOrder", b"\0")
    head += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
    head += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    size = 4 * len(names) * width
    lines = b"".join(
        struct.pack("<ii", y + row, size) + b"".join(struct.pack("<f", texel(i, row)[c]) for c in sorted(range(len(names)), key=names.__getitem__) for i in range(width))
        for row in range(height)
    )
    first = len(head) + 8 * height
    table = b"".join(struct.pack("<Q", first + row * (8 + size)) for row in range(height))
    with open(path, "wb") as out:
        out.write(head + table + lines)


def write_hdr(path, width, height, texel, head=b"", order=b"-Y %d +X %d"):
    """RGBE without runs; a component is the code times 2 to the exponent less 136."""
    with open(path, "wb") as out:
        out.write(b"#?RADIANCE\n" + head + b"FORMAT=32-bit_rle_rgbe\n\n" + order % (height, width) + b"\n")
        for y in range(height):
            for x in range(width):
                out.write(bytes(texel(x, y)))


def write_npy(path, kind, shape, numbers, version=1, descr=None):
    """kind: f, i or u. With `descr`, a structured dtype, kind is the format of all numbers, in the letters of struct."""
    head = "{'descr': %s, 'fortran_order': False, 'shape': %s, }" % (descr or "'<%s4'" % kind, shape)
    start = 10 if version == 1 else 12
    head += " " * (-(start + len(head) + 1) % 64) + "\n"
    letters = kind if descr else {"f": "f", "i": "i", "u": "I"}[kind] * len(numbers)
    size = struct.pack("<H" if version == 1 else "<I", len(head))
    with open(path, "wb") as out:
        out.write(b"\x93NUMPY" + bytes([version, 0]) + size + head.encode())
        out.write(struct.pack("<" + letters, *numbers))


def read_npy(path):
    with open(path, "rb") as file:
        data = file.read()
    start = 10 + struct.unpack("<H", data[8:10])[0]
    return [number for (number,) in struct.iter_unpack("<f", data[start:])]


def photo(x, y):
    return (x * 5 % 256, y * 12 % 256, (x * y + 7) % 256)


def read_grade(path):
    """The texels of a PNG that has filter 0 in each row, as write_png writes it; any chunks and compression."""
    with open(path, "rb") as file:
        data = file.read()
    width, height = struct.unpack(">II", data[16:24])
    at, packed = 8, b""
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        if data[at + 4 : at + 8] == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += 12 + length
    rows = zlib.decompress(packed)
    size = 1 + 3 * width
    assert all(rows[y * size] == 0 for y in range(height))
    return [[rows[y * size + 1 + 3 * x : y * size + 4 + 3 * x] for x in range(width)] for y in range(height)]


def light(code):
    code /= 255
    return code / 12.92 if code <= 0.04045 else ((code + 0.055) / 1.055) ** 2.4


class Dump:
    def __init__(self, folder):
        self.folder = folder
        with open(folder + "/manifest.json", encoding="utf-8") as file:
            self.manifest = json.load(file)

    def bytes(self, name, mip):
        for entry in self.manifest["history"] + self.manifest["entries"]:
            if entry["resource"] == name and entry.get("mip", 0) == mip:
                with open(self.folder + "/" + entry["file"], "rb") as file:
                    return entry.get("format", ""), file.read()
        raise KeyError(name)

    def numbers(self, name, mip=0):
        form, data = self.bytes(name, mip)
        if form.startswith("rgba8"):
            return list(data)
        return [number for (number,) in struct.iter_unpack("<e" if form == "rgba16f" else "<f", data)]

    def integers(self, name):
        return [number for (number,) in struct.iter_unpack("<i", self.bytes(name, 0)[1])]


def expect(found, wanted, most, what):
    assert len(found) == len(wanted), "%s: %d numbers instead of %d" % (what, len(found), len(wanted))
    for i, (a, b) in enumerate(zip(found, wanted)):
        assert abs(a - b) <= most, "%s: number %d is %r instead of %r" % (what, i, a, b)


def shrink(texels, width, height):
    """The next mip of texels[y][x]: each texel is the mean of the area that it covers."""
    w, h = max(width // 2, 1), max(height // 2, 1)

    def parts(index, source, target):
        start, end = index * source / target, (index + 1) * source / target
        for at in range(int(start), min(source, math.ceil(end))):
            yield at, min(end, at + 1) - max(start, at)

    out = []
    for y in range(h):
        row = []
        for x in range(w):
            total, weight = [0, 0, 0], 0
            for v, b in parts(y, height, h):
                for u, a in parts(x, width, w):
                    weight += a * b
                    total = [t + a * b * c for t, c in zip(total, texels[v][u])]
            row.append([t / weight for t in total])
        out.append(row)
    return out, w, h


def flat(texels, alpha):
    return [number for row in texels for texel in row for number in (*texel, alpha)]


def check_dump(folder, specs):
    """All inputs in every bit; mips and results within the rounding of their formats."""
    dump = Dump(folder)
    grade = read_grade(specs + "/outside_grade.png")
    kernel = read_npy(specs + "/outside_kernel.npy")
    image = [[photo(x, HEIGHT - 1 - y) for x in range(WIDTH)] for y in range(HEIGHT)]
    table = grade[::-1]
    size = len(table)
    expect(dump.numbers("photo"), flat(image, 255), 0, "photo")
    expect(dump.numbers("grade"), flat(table, 255), 0, "grade")
    expect(dump.numbers("kernel"), kernel, 0, "kernel")
    expect(dump.numbers("weights"), [0.75, 0.5, 0.25, 0, 0.25, 0.5, 0.75, 0], 0, "weights")
    soft, w, h = [[[light(c) for c in t] for t in row] for row in table], len(table[0]), size
    for mip in range(3):
        expect(dump.numbers("soft", mip), flat(soft, 1), 0.0005, "soft, mip %d" % mip)
        if mip < 2:
            soft, w, h = shrink(soft, w, h)
    # at the centre of mip 2, four texels meet
    tint = [sum(soft[y][x][c] for y in (h // 2 - 1, h // 2) for x in (w // 2 - 1, w // 2)) / 4 for c in range(3)]
    linear = [[[light(c) for c in t] for t in row] for row in image]
    reach = len(kernel) // 2
    blurred = [
        [[sum(k * row[min(max(x + i - reach, 0), WIDTH - 1)][c] for i, k in enumerate(kernel)) for c in range(3)] for x in range(WIDTH)]
        for row in linear
    ]
    expect(dump.numbers("blurred"), flat(blurred, 1), 0.002, "blurred")
    picture = []
    for y in range(HEIGHT):
        row = []
        for x in range(WIDTH):
            r, g, b = (int(c * (size - 1) + 0.5) for c in linear[y][x])
            color = table[g][b * size + r]
            row.append([
                255 * min(a * c / 255 + d * e * t, 1)
                for a, c, d, e, t in zip((0.75, 0.5, 0.25), color, (0.25, 0.5, 0.75), blurred[y][x], tint)
            ])
        picture.append(row)
    expect(dump.numbers("picture"), flat(picture, 255), 1.001, "picture")


def check_mips(folder):
    """rgba8_srgb with mips of odd sides: averaged as light, rounded to the nearest code."""
    dump = Dump(folder)
    texels = [[[light(c) for c in photo(x, HEIGHT - 1 - y)] for x in range(WIDTH)] for y in range(HEIGHT)]
    width, height = WIDTH, HEIGHT
    for mip in range(4):
        codes = [[[255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055) for v in t] for t in row] for row in texels]
        expect(dump.numbers("photo", mip), flat(codes, 255), 0.501, "photo, mip %d" % mip)
        texels, width, height = shrink(texels, width, height)


def check_formats(folder):
    """Every kind of picture in rgba16f: the values of `make`, rounded to the nearest half."""
    dump = Dump(folder)
    nearest = [struct.unpack("<e", struct.pack("<e", value))[0] for value in EXR_VALUES]
    found = dump.numbers("exr")
    expect(found[0::4], nearest, 0, "exr, red")
    expect(found[1::4], [0.25] * len(nearest), 0, "exr, green")
    expect(dump.numbers("hdr")[:4], [128 * 2.0**-6, 64 * 2.0**-6, 0, 1], 0, "hdr")
    expect(dump.numbers("hdr")[4:], [1, 1, 1, 1], 0, "hdr, second texel")
    expect(dump.integers("counts"), [12 + 2 + 12, 1 + 1 + 7], 0, "sizes")
    # std430: vec3 and mat4 begin at multiples of 16, each ends its 12 or 64 bytes later
    _, bones = dump.bytes("bones", 0)
    for i in range(2):
        numbers = BONE[i]
        found = struct.unpack_from("<I", bones, 112 * i) + struct.unpack_from("<3f", bones, 112 * i + 16)
        found += struct.unpack_from("<16f", bones, 112 * i + 32)
        for k in range(2):
            found += struct.unpack_from("<2i", bones, 112 * i + 96 + 8 * k)
        expect(found, numbers, 0, "bone %d" % i)


def profile(name):
    """An ICC profile with its description alone."""
    text = name.encode("utf-16-be")
    tag = b"mluc" + struct.pack(">4xII2s2sII", 1, 12, b"en", b"US", len(text), 28) + text
    tag += bytes(-len(tag) % 4)
    head = bytearray(128)
    head[8:40] = b"\x04\0\0\0mntrRGB XYZ " + bytes(12) + b"acsp"
    head[68:80] = bytes.fromhex("0000f6d6000100000000d32d")
    body = bytes(head) + struct.pack(">I4sII", 1, b"desc", 144, len(tag)) + tag
    return struct.pack(">I", len(body)) + body[4:]


def exif(order, turn):
    """EXIF data: a resolution, and an orientation. order: < little-endian, > big-endian."""
    return ((b"II" if order == "<" else b"MM") + struct.pack(order + "HIHHHIIHHIHxxI", 42, 8, 2, 0x128, 3, 1, 0, 0x112, 3, 1, turn, 0))


GREYS = (10, 50, 100, 200)
CROP = (2.0, 0.5, 0.25)


def make_pictures(folder):
    """Pictures that say of their numbers what readers may pass over, and a JPEG with a profile of ramp.jpg."""
    grey = lambda x, y: (GREYS[x],) * 3
    gamma = lambda value: (b"gAMA", struct.pack(">I", value))
    icc = lambda name: (b"iCCP", b"icc\0\0" + zlib.compress(profile(name)))
    primaries = lambda x: (b"cHRM", struct.pack(">8I", 31270, 32900, x, 32000, 26500, 69000, 15000, 6000))
    for name, chunks in (("linear", [gamma(100000)]), ("gamma_18", [gamma(55556)]), ("gamma_22", [gamma(45455)]),
                         ("wide", [primaries(68000)]), ("p3", [icc("Display P3")]), ("srgb", [icc("sRGB IEC61966-2.1")]),
                         ("pq", [(b"cICP", bytes((9, 16, 0, 1)))]), ("turned", [(b"eXIf", exif(">", 6))]), ("upright", [(b"eXIf", exif("<", 1))]),
                         ("first", [(b"sRGB", b"\0"), gamma(45455)])):
        write_png(folder + "/%s.png" % name, 4, 1, grey, chunks)
    for name, head, order in (("bottom", b"", b"+Y %d +X %d"), ("exposed", b"EXPOSURE= 2.0\n", b"-Y %d +X %d"),
                              ("once", b"EXPOSURE=1\n", b"-Y %d +X %d")):
        write_hdr(folder + "/%s.hdr" % name, 4, 1, lambda x, y: (64, 64, 64, 129), head, order)
    write_hdr(folder + "/runs.hdr", 2, 1, lambda x, y: (1, 1, 1, 3) if x else (64, 64, 64, 129))
    # texels (2, 1) to (5, 2) of 4x4: half of the data lies beyond
    write_exr(folder + "/window.exr", 4, 2, lambda x, y: CROP if x < 2 else (9, 9, 9), corner=(12, 21), display=(10, 20, 13, 23))
    for name, names in (("flow", "RG"), ("layer", ("a.R", "a.G", "a.B")), ("passes", ("AO", "ID", "Z")), ("luma", ("Y", "RY", "BY")),
                        ("eyes", ("left.R", "left.G", "left.B", "right.R"))):
        write_exr(folder + "/%s.exr" % name, 1, 1, lambda x, y: (2, 0.5, 0.25, 9), names=names)
    with open(folder + "/window.exr", "rb") as file:
        window = file.read()
    for name, flag in (("deep", 8), ("parts", 16)):
        with open(folder + "/%s.exr" % name, "wb") as out:
            out.write(window[:5] + bytes([flag]) + window[6:])
    write_hdr(folder + "/line.hdr", 4, 1, lambda x, y: (64, 64, 64, 129), b"#" * 255 + b"\n")
    with open(folder + "/ramp.jpg", "rb") as file:
        ramp = file.read()
    frame = ramp.index(b"\xff\xc0") + 9 # the number of components
    with open(folder + "/inks.jpg", "wb") as out:
        out.write(ramp[:frame] + b"\4" + ramp[frame + 1:])
    far = exif("<", 6)[:4] + b"\xff\xff\xff\x7f"
    for name, kind, segment in (("far", b"\xff\xe1", b"Exif\0\0" + far), ("short", b"\xff\xe1", b"Exif\0\0" + exif(">", 6)[:30]), ("adobe", b"\xff\xe2", b"ICC_PROFILE\0\1\1" + profile("Adobe RGB (1998)")),
                                ("turned", b"\xff\xe1", b"Exif\0\0" + exif("<", 3))):
        with open(folder + "/%s.jpg" % name, "wb") as out:
            out.write(ramp[:2] + kind + struct.pack(">H", len(segment) + 2) + segment + ramp[2:])
    with open(folder + "/half.jpg", "wb") as out:
        out.write(ramp[:-20])


def check_greys(folder):
    """Codes over 255, as they stand in the file."""
    expect(Dump(folder).numbers("copied"), [v for grey in GREYS for v in [grey / 255] * 3 + [1]], 1e-6, "greys")


def check_flow(folder):
    expect(Dump(folder).numbers("copied"), [2, 0.5, 0, 1], 0, "two channels")


def check_window(folder):
    """The display window, from the bottom: rows 2 and 1 of the four hold the data, which begins at column 2."""
    row = [0] * 8 + [*CROP, 1] * 2
    expect(Dump(folder).numbers("copied"), [0] * 16 + row * 2 + [0] * 16, 0, "window")


# Ties, both neighbours of ties, the smallest and the largest halves.
EXR_VALUES = [1.0, 1 + 2**-11, 1 + 3 * 2**-11, 1 + 2**-11 + 2**-20, -0.3, 2.0**-24, 2.0**-25, 3 * 2.0**-25, 2.0**-14 - 2.0**-26,
              65504.0, 65519.0, -0.0]


# uint, vec3, mat4, ivec2[2]
BONE = [[7 * i + 1, *(k + 0.5 for k in range(3 + 16)), *(k - 2 - i for k in range(4))] for i in range(2)]
BONE_DTYPE = "[('bone', '<u4'), ('at', '<f4', (3,)), ('turn', '<f4', (4, 4)), ('links', '<i4', (2, 2))]"


def make(folder):
    bones = [number for bone in BONE for number in bone]
    write_npy(folder + "/bones.npy", ("I" + "f" * 19 + "i" * 4) * 2, "(2,)", bones, descr=BONE_DTYPE)
    for name, old, new in (("order", "'at'", "'on'"), ("shape", "(3,)", "(1, 3)"), ("kind", "'<u4'", "'<i4'"),
                           ("padded", "('bone', '<u4')", "('bone', '<u4'), ('', '|V4')")):
        letters = ("i" if name == "kind" else "I") + "f" * 19 + "i" * 4
        write_npy(folder + "/bones_%s.npy" % name, letters * 2, "(2,)", bones, descr=BONE_DTYPE.replace(old, new))
    write_png(folder + "/photo.png", WIDTH, HEIGHT, photo)
    write_png(folder + "/other.png", WIDTH, HEIGHT, lambda x, y: photo(x, y) if (x, y) != (44, 20) else (0, 0, 0))
    write_png(folder + "/small.png", 8, 4, photo)
    weights = [0.75, 0.5, 0.25, 0.25, 0.5, 0.75]
    write_npy(folder + "/weights.npy", "f", "(2, 3)", weights)
    write_npy(folder + "/weights_2.npy", "f", "(2, 3)", weights, version=2)
    write_npy(folder + "/nan.npy", "f", "(2, 3)", weights[:4] + [math.nan, 1])
    write_npy(folder + "/three.npy", "f", "(3, 3)", weights + [0, 0, 0])
    write_npy(folder + "/pairs.npy", "f", "(3, 2)", weights)
    write_npy(folder + "/whole.npy", "i", "(2, 3)", [1, 2, 3, 4, 5, 6])
    write_npy(folder + "/short.npy", "f", "(2, 3)", weights[:5])
    write_exr(folder + "/values.exr", len(EXR_VALUES), 1, lambda x, y: (EXR_VALUES[x], 0.25, 0), corner=(7, -3))
    write_exr(folder + "/nan.exr", 3, 2, lambda x, y: (math.nan if (x, y) == (2, 0) else 0, 0, 0))
    write_exr(folder + "/large.exr", 2, 1, lambda x, y: (65520 if x else 0, 0, 0))
    write_hdr(folder + "/two.hdr", 2, 1, lambda x, y: (128, 128, 128, 129) if x else (128, 64, 0, 130))
    with open(folder + "/cut.png", "wb") as out, open(folder + "/photo.png", "rb") as file:
        out.write(file.read()[:60])


COMMANDS = {"make": make, "pictures": make_pictures, "greys": check_greys, "window": check_window, "flow": check_flow, "dump": check_dump, "mips": check_mips, "formats": check_formats}
COMMANDS[sys.argv[1]](*sys.argv[2:])
