"""Checks the content of a window on an X display: view.py FILE SECONDS CONDITION...

Grabs the content of the window named diptych until all conditions hold; fails if they do not hold within SECONDS. The last grab
becomes FILE, a PPM.

  shown          there is more than one colour
  halves         the left half is the right half
  black          there is nothing but black
  size=WxH       the window has this size
  as=FILE        it is that PPM, or PNG of 8 bit RGB
  not=FILE       it is another picture than that PPM
  top=FILE       its upper third is that PPM's
  still          it has not changed for half a second
  alarm          its lower half has a dark red panel
  verdict=COLOR  the bar on top is that: red or green
  like=FILE      reduced to 160x90 it is nearly that PNG; UPDATE=1 writes it"""
import os
import random
import struct
import subprocess
import sys
import time
import zlib


def output(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False).stdout


def grab():
    """Width, height, and rows of RGB."""
    windows = output("xdotool", "search", "--name", "^diptych").split()
    data = output("xwd", "-silent", "-id", windows[0].decode()) if windows else b""
    if len(data) < 100:
        return 0, 0, []
    header = struct.unpack(">25I", data[:100])
    width, height, bits, pitch = header[4], header[5], header[11], header[12]
    start, step = header[0] + header[19] * 12, bits // 8
    if len(data) < start + height * pitch or height < 3:  # it got another size meanwhile
        return 0, 0, []
    rows = []
    for y in range(height):
        row = data[start + y * pitch:start + y * pitch + width * step]
        rgb = bytearray(width * 3)
        rgb[0::3], rgb[1::3], rgb[2::3] = row[2::step], row[1::step], row[0::step]  # least significant byte first
        rows.append(bytes(rgb))
    return width, height, rows


def unfilter(kind, row, above):
    """One row of a PNG of three channels."""
    out = bytearray(row)
    for i, value in enumerate(row):
        left = out[i - 3] if i >= 3 else 0
        up = above[i]
        corner = above[i - 3] if i >= 3 else 0
        nearest = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (abs(left + up - 2 * corner), 2, corner))[2]
        out[i] = (value + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
    return bytes(out)


def read_png(data):
    at, packed, width, height = 8, b"", 0, 0
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", chunk[:10])
            assert (depth, colour) == (8, 2), "not 8 bit RGB"
        if kind == b"IDAT":
            packed += chunk
        at += 12 + length
    raw, pitch, rows = zlib.decompress(packed), width * 3 + 1, []
    for y in range(height):
        rows.append(unfilter(raw[y * pitch], raw[y * pitch + 1:(y + 1) * pitch], rows[-1] if rows else bytes(width * 3)))
    return width, height, rows


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    if data.startswith(b"\x89PNG"):
        return read_png(data)
    _, size, _, pixels = data.split(b"\n", 3)
    width, height = map(int, size.split())
    return width, height, [pixels[y * width * 3:(y + 1) * width * 3] for y in range(height)]


def is_dark_red(pixel):
    return 20 < pixel[0] and pixel[1] * 4 < pixel[0] and pixel[2] * 4 < pixel[0]


def reduce(picture):
    """Means of 160x90 blocks."""
    width, height, rows = picture
    out = []
    for y in range(90):
        block = [0] * 480
        top, bottom = y * height // 90, (y + 1) * height // 90
        for row in rows[top:bottom]:
            for x in range(160):
                left, right = x * width // 160 * 3, (x + 1) * width // 160 * 3
                for c in range(3):
                    block[x * 3 + c] += sum(row[left + c:right:3]) * 160 // width
        out.append(bytes(min(value // (bottom - top), 255) for value in block))
    return 160, 90, out


def write_png(path, picture):
    width, height, rows = picture

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 9)) + chunk(b"IEND", b""))


def is_like(picture, path):
    """Letters and times may be others: few blocks are far apart, and the mean is near."""
    if picture[0] < 160 or picture[1] < 90:
        return False
    small = reduce(picture)
    if os.environ.get("UPDATE"):
        write_png(path, small)
    kept = read(path)
    apart = [abs(a - b) for a, b in zip(b"".join(small[2]), b"".join(kept[2]))]
    return sum(apart) < 5 * len(apart) and sum(a > 48 for a in apart) < len(apart) // 40


def holds(condition, picture, age):
    width, height, rows = picture
    name, _, value = condition.partition("=")
    if name == "shown":
        return any(row != rows[0][:3] * width for row in rows)
    if name == "halves":
        return all(row[:width // 2 * 3] == row[width // 2 * 3:] for row in rows)
    if name == "black":
        return bool(rows) and not any(map(any, rows))
    if name == "still":
        return age > 0.5
    if name == "size":
        return f"{width}x{height}" == value
    if name == "as":
        return picture == read(value)
    if name == "not":
        return picture != read(value)
    if name == "top":
        return rows[:height // 3] == read(value)[2][:height // 3]
    if name == "verdict":
        red, green, _ = rows[2][:3]
        return green > red + 10 if value == "green" else red > green + 10
    if name == "like":
        return is_like(picture, value)
    if name == "alarm":
        lower = b"".join(rows[height // 2:])
        return sum(is_dark_red(lower[i:i + 3]) for i in range(0, len(lower), 3)) * 4 > len(lower) // 3
    raise ValueError(condition)


def play(count):
    chance = random.Random(int(os.environ["SEED"]))
    keys = ("Tab shift+Tab Home Up Down Next Prior space period v c plus minus g t r b h f F1 F2 F3 F4 0 1 2 w a s d q e "
            "ctrl+z ctrl+plus ctrl+minus Return BackSpace 7").split()
    for _ in range(count):
        kind = chance.randrange(10)
        print(f"mousemove {chance.randrange(1280)} {chance.randrange(720)}")
        if kind < 4:
            print(f"key {chance.choice(keys)}")
        elif kind < 7:
            print(f"click {chance.choice((1, 1, 1, 2, 3))}")
        elif kind < 8:
            print(f"click {chance.choice((4, 5))}")
        else:
            button = chance.choice((1, 1, 2, 3))
            print(f"mousedown {button} mousemove {chance.randrange(1280)} {chance.randrange(720)}")
            print(f"sleep 0.05 mouseup {button}")
        print(f"sleep {chance.choice((0, 0.02, 0.1))}")
    return 0


def main():
    if sys.argv[1] == "--random":  # COUNT: lines for xdotool, without what ends the window or saves many cases
        return play(int(sys.argv[2]))
    if sys.argv[1] == "--photo":  # PNG KEPT: a photograph of the window
        return not is_like(read(sys.argv[2]), sys.argv[3])
    path, seconds, conditions = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
    end, picture, since = time.monotonic() + seconds, None, 0
    while True:
        before, picture = picture, grab()
        since = since if picture == before else time.monotonic()
        missing = []
        for condition in conditions:  # the last is looked at only when the others hold: it may take time
            if missing and condition == conditions[-1]:
                break
            if not (picture[2] and holds(condition, picture, time.monotonic() - since)):
                missing.append(condition)
        if not missing or time.monotonic() > end:
            break
        time.sleep(0.03)
    with open(path, "wb") as file:
        file.write(b"P6\n%d %d\n255\n" % picture[:2] + b"".join(picture[2]))
    if missing:
        print(f"not within {seconds:g} s: {', '.join(missing)}; a window of {picture[0]}x{picture[1]}")
    return bool(missing)


sys.exit(main())
