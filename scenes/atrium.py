#!/usr/bin/python3
"""`atrium.py OUT.obj` builds the heavy scene of this project: a court of 30 x 12 m with arcades on
two storeys, a gallery with balustrades, drapes in three colours and an open roof, and writes it with
its materials (OUT.mtl). ninja runs it. The same bytes on every run. Metres, y is up, the court's long
axis is x.

Solids are closed, face outward, and dip into each other by a few millimetres where they meet, so
that no two faces share a plane."""
import os
import sys
from math import cos, pi, sin, sqrt
from typing import List, Sequence, Tuple

Vec = Tuple[float, float, float]
Ring = Tuple[float, float]  # radius, height

# Measures that several parts share.
BAY, HALF_LENGTH, HALF_WIDTH, AISLE = 3, 15, 6, 4
ARCH_RADIUS, PANEL_HALF, PIER_HALF, ARC_STEPS = 1.05, 0.25, 0.45, 16
GALLERY, ROOF = 5.25, 9.35

MATERIALS = {
    "stone": (0.70, 0.64, 0.54),
    "trim": (0.78, 0.74, 0.66),
    "plaster": (0.74, 0.67, 0.56),
    "tile_light": (0.66, 0.60, 0.51),
    "tile_dark": (0.34, 0.22, 0.17),
    "mortar": (0.42, 0.39, 0.35),
    "wood": (0.36, 0.21, 0.12),
    "red_cloth": (0.68, 0.06, 0.05),
    "green_cloth": (0.08, 0.44, 0.10),
    "blue_cloth": (0.06, 0.16, 0.58),
}

# ---- Writing -------------------------------------------------------------------------------------

lines: List[str] = []  # of the mesh
vertices = triangles = 0  # so far
material = ""
# Placement of the parts: quarter turns about y, then a move.
quarter, origin = 0, (0.0, 0.0, 0.0)


def turn(p: Vec) -> Vec:
    for _ in range(quarter):
        p = (p[2], p[1], -float(p[0]))
    return p


def use(name: str) -> None:
    global material
    if material != name:
        lines.append(f"usemtl {name}\n")
    material = name


def vertex(p: Vec, n: Vec) -> int:
    """Adds a vertex and returns its number; the normal needs no unit length."""
    global vertices
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    x, y, z = turn(p)
    nx, ny, nz = turn(n)
    lines.append("v %.5f %.5f %.5f\nvn %.5f %.5f %.5f\n" % (
        x + origin[0], y + origin[1], z + origin[2], nx / length, ny / length, nz / length))
    vertices += 1
    return vertices


def quad(a: int, b: int, c: int, d: int) -> None:
    """Corners counter-clockwise seen from outside."""
    global triangles
    lines.append(f"f {a}//{a} {b}//{b} {c}//{c}\nf {a}//{a} {c}//{c} {d}//{d}\n")
    triangles += 2


def flat_quad(a: Vec, b: Vec, c: Vec, d: Vec, normal: Vec) -> None:
    first = vertex(a, normal)
    for p in (b, c, d):
        vertex(p, normal)
    quad(first, first + 1, first + 2, first + 3)


# ---- Solids --------------------------------------------------------------------------------------


def box(name: str, a: Vec, b: Vec) -> None:
    use(name)
    p = [(b[0] if k & 1 else a[0], b[1] if k & 2 else a[1], b[2] if k & 4 else a[2])
         for k in range(8)]
    flat_quad(p[0], p[4], p[6], p[2], (-1, 0, 0))
    flat_quad(p[1], p[3], p[7], p[5], (1, 0, 0))
    flat_quad(p[0], p[1], p[5], p[4], (0, -1, 0))
    flat_quad(p[2], p[6], p[7], p[3], (0, 1, 0))
    flat_quad(p[0], p[2], p[3], p[1], (0, 0, -1))
    flat_quad(p[4], p[5], p[7], p[6], (0, 0, 1))


def block(name: str, x: float, z: float, half: float, y0: float, y1: float) -> None:
    """A square block about the axis at (x, z)."""
    box(name, (x - half, y0, z - half), (x + half, y1, z + half))


def lathe(name: str, x: float, y0: float, profile: Sequence[Ring], segments: int) -> None:
    """Turns a profile (from bottom to top) about a vertical axis at z = 0; every band has its own
    normals, so edges stay crisp."""
    use(name)
    for (low, low_y), (high, high_y) in zip(profile, profile[1:]):
        first = vertices + 1
        for i in range(segments):
            angle = 2 * pi * i / segments
            c, t = cos(angle), sin(angle)
            normal = ((high_y - low_y) * c, low - high, (high_y - low_y) * t)
            vertex((x + low * c, y0 + low_y, low * t), normal)
            vertex((x + high * c, y0 + high_y, high * t), normal)
        for i in range(segments):
            a, b = first + 2 * i, first + 2 * ((i + 1) % segments)
            quad(a, a + 1, b + 1, b)


def bulge(radius: float, y0: float, y1: float, steps: int) -> List[Ring]:
    """A half-round moulding that bulges outward between two heights."""
    half = 0.5 * (y1 - y0)
    angles = [pi * i / steps - pi / 2 for i in range(steps + 1)]
    return [(radius + half * cos(angle), y0 + half + half * sin(angle)) for angle in angles]


def column(x: float, y0: float, springing: float, radius: float) -> None:
    """Column with plinth, base, swelling shaft, capital and abacus, from y0 up to the springing of
    the arch."""
    shaft0, shaft1 = 0.34, springing - y0 - 0.42
    profile = bulge(radius + 0.04, 0.10, 0.22, 5) + bulge(radius + 0.01, 0.25, 0.33, 4)
    for t in (i / 8.0 for i in range(9)):  # entasis: the shaft narrows upward, slowly first
        profile.append((radius * (1 - 0.16 * t * t), shaft0 + (shaft1 - shaft0) * t))
    profile += bulge(radius * 0.86, shaft1 + 0.02, shaft1 + 0.08, 4)
    for t in (i / 6.0 for i in range(7)):  # bell of the capital
        profile.append((radius * 0.86 + (0.43 - radius * 0.86) * t * t, shaft1 + 0.09 + 0.22 * t))
    profile.append((0.43, shaft1 + 0.34))
    block("trim", x, 0, 0.42, y0 - 0.02, y0 + 0.12)
    lathe("stone", x, y0, profile, 20)
    block("trim", x, 0, PIER_HALF + 0.03, springing - 0.09, springing)


# ---- Arcade: local x runs along the side, local z points out of the court ------------------------


def on_arc(center: float, springing: float, radius: float, i: int, z: float) -> Vec:
    angle = pi - pi * i / ARC_STEPS
    return (center + radius * cos(angle), springing + radius * sin(angle), z)


def spandrel(center: float, springing: float, top: float, z: float, facing: float) -> None:
    """Face of the wall above an arch, at depth z and looking along -z or +z."""

    def face(a: Vec, b: Vec, c: Vec, d: Vec) -> None:
        flat_quad(*((a, b, c, d) if facing > 0 else (a, d, c, b)), (0, 0, facing))

    left, right, foot = center - BAY / 2, center + BAY / 2, springing - 0.02
    for x0, x1 in ((left, center - ARCH_RADIUS), (center + ARCH_RADIUS, right)):
        for y0, y1 in ((foot, springing), (springing, top)):
            face((x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z))
    for i in range(ARC_STEPS):
        a = on_arc(center, springing, ARCH_RADIUS, i, z)
        b = on_arc(center, springing, ARCH_RADIUS, i + 1, z)
        face(a, b, (b[0], top, z), (a[0], top, z))


def soffit(center: float, springing: float) -> None:
    """Soffit of the arch and the two short jambs below it."""
    first = vertices + 1
    for i in range(ARC_STEPS + 1):
        x, y, z = on_arc(center, springing, ARCH_RADIUS, i, -PANEL_HALF)
        for end in (z, PANEL_HALF):
            vertex((x, y, end), (center - x, springing - y, 0))
    for a in range(first, first + 2 * ARC_STEPS, 2):
        quad(a, a + 2, a + 3, a + 1)
    for side in (-1, 1):
        x, y, z = center + side * ARCH_RADIUS, springing - 0.02, -side * PANEL_HALF
        flat_quad((x, y, z), (x, y, -z), (x, springing, -z), (x, springing, z), (-side, 0, 0))


def archivolt(center: float, springing: float) -> None:
    """Round moulding about the arch, on the court's side."""
    segments, radius, thickness = 6, ARCH_RADIUS + 0.13, 0.07
    use("trim")
    first = vertices + 1
    for i in range(ARC_STEPS + 1):
        x, y, z = on_arc(center, springing, radius, i, -PANEL_HALF)
        out_x, out_y = (x - center) / radius, (y - springing) / radius
        for k in range(segments):
            c, t = cos(2 * pi * k / segments), sin(2 * pi * k / segments)
            n = (out_x * c, out_y * c, t)
            vertex((x + thickness * n[0], y + thickness * n[1] - 0.01, z + thickness * n[2]), n)
    for i in range(ARC_STEPS):
        for k in range(segments):
            a, b = first + i * segments + k, first + i * segments + (k + 1) % segments
            quad(a, b, b + segments, a + segments)


def arch(center: float, springing: float, top: float) -> None:
    use("stone")
    spandrel(center, springing, top, -PANEL_HALF, -1)
    spandrel(center, springing, top, PANEL_HALF, 1)
    soffit(center, springing)
    foot, inner, outer = springing - 0.02, ARCH_RADIUS, BAY / 2
    for side in (-1, 1):  # the feet of the wall, inside the abaci
        z, x0, x1 = side * PANEL_HALF, center + side * inner, center + side * outer
        flat_quad((x0, foot, -z), (x1, foot, -z), (x1, foot, z), (x0, foot, z), (0, -1, 0))
    archivolt(center, springing)


# ---- Gallery and cloth ---------------------------------------------------------------------------


def balustrade(center: float) -> None:
    profile = [(0.050, 0.00), (0.050, 0.08), (0.030, 0.12), (0.055, 0.24), (0.062, 0.34),
               (0.045, 0.48), (0.026, 0.60), (0.040, 0.66), (0.050, 0.70), (0.050, 0.78)]
    balusters, half = 8, BAY / 2 - 0.30
    box("trim", (center - half, GALLERY - 0.02, -0.12), (center + half, GALLERY + 0.12, 0.12))
    for i in range(balusters):
        x = center - half + 2 * half * (i + 0.5) / balusters
        lathe("stone", x, GALLERY + 0.11, profile, 8)
    box("trim", (center - half, GALLERY + 0.88, -0.15), (center + half, GALLERY + 1.0, 0.15))


def drape(name: str, x0: float, x1: float, y0: float, y1: float, depth_z: float, waves: float,
          depth: float, columns: int, rows: int) -> None:
    """A cloth that hangs from y1 to y0 before depth_z: waves along x that open downward. A thin closed
    solid."""

    def point(i: int, j: int, face: int) -> Tuple[Vec, Vec]:
        u, v = i / columns, j / rows
        phase, bend = 2 * pi * waves * u, 0.8 * sin(3.1 * v)
        opening = depth * (0.45 + 0.55 * (1 - v))
        slope_u = opening * 2 * pi * waves * cos(phase + bend) / (x1 - x0)
        slope_v = (-0.55 * depth * sin(phase + bend) +
                   opening * 0.8 * 3.1 * cos(3.1 * v) * cos(phase + bend)) / (y1 - y0)
        z = depth_z + opening * sin(phase + bend) + face * 0.02 / 2
        return (x0 + (x1 - x0) * u, y0 + (y1 - y0) * v, z), (-face * slope_u, -face * slope_v, face)

    def hem(i: int, j: int, k: int, m: int, out: Vec) -> None:
        """Between front and back, from grid point (i, j) to (k, m), counter-clockwise about the
        front face."""
        flat_quad(point(i, j, 1)[0], point(i, j, -1)[0], point(k, m, -1)[0], point(k, m, 1)[0], out)

    use(name)
    for face in (-1, 1):
        first = vertices + 1
        for j in range(rows + 1):
            for i in range(columns + 1):
                vertex(*point(i, j, face))
        for j in range(rows):
            for i in range(columns):
                a = first + j * (columns + 1) + i
                b, d, e = a + 1, a + columns + 1, a + columns + 2
                quad(*((a, b, e, d) if face > 0 else (a, d, e, b)))
    for i in range(columns):
        hem(i, 0, i + 1, 0, (0, -1, 0))
        hem(i + 1, rows, i, rows, (0, 1, 0))
    for j in range(rows):
        hem(0, j + 1, 0, j, (-1, 0, 0))
        hem(columns, j, columns, j + 1, (1, 0, 0))


def curtain(name: str, center: float) -> None:
    """Behind an arch of the ground floor, on a rod."""
    drape(name, center - 1.15, center + 1.15, 0.12, 4.02, 0.75, 7, 0.11, 56, 14)
    box("wood", (center - 1.48, 4.0, 0.71), (center + 1.48, 4.07, 0.79))


def banner(name: str, center: float) -> None:
    """Before the balustrade, on a rod that two brackets hold."""
    drape(name, center - 0.6, center + 0.6, 4.3, 6.32, -0.66, 2, 0.05, 20, 14)
    box("wood", (center - 0.7, 6.30, -0.69), (center + 0.7, 6.36, -0.63))
    for x in (center - 0.66, center + 0.66):
        box("wood", (x - 0.02, 6.18, -0.67), (x + 0.02, 6.34, 0.02))


def side(bays: int, first_color: int) -> None:
    """One side of the court: both arcades, the gallery's balustrade, beams, cloth."""
    colors = ("red_cloth", "green_cloth", "blue_cloth")
    start = -bays * BAY / 2
    for i in range(bays):
        center = start + (i + 0.5) * BAY
        arch(center, 3.4, 5.06)
        arch(center, GALLERY + 2.6, ROOF + 0.06)
        balustrade(center)
        if i % 2:
            curtain(colors[(first_color + i // 2) % 3], center)
        else:
            banner(colors[(first_color + i // 2 + 2) % 3], center)
    for i in range(1, bays):
        x = start + i * BAY
        column(x, 0, 3.4, 0.34)
        column(x, GALLERY, GALLERY + 2.6, 0.28)
        block("trim", x, 0, 0.31, GALLERY - 0.01, GALLERY + 1.03)  # between balustrades
        box("wood", (x - 0.14, 4.72, 0.2), (x + 0.14, 5.02, AISLE + 0.1))
        box("wood", (x - 0.14, ROOF - 0.3, 0.2), (x + 0.14, ROOF + 0.02, AISLE + 0.1))
        box("trim", (x - 0.3, -0.1, AISLE - 0.16), (x + 0.3, ROOF + 0.03, AISLE + 0.1))
    for i in range(2 * bays * BAY - 2):  # dentils below both cornices
        x = start + 0.75 + 0.5 * i
        box("trim", (x - 0.11, 4.87, -0.40), (x + 0.11, 5.02, -0.20))
        box("trim", (x - 0.11, ROOF - 0.13, -0.45), (x + 0.11, ROOF + 0.02, -0.20))


# ---- The building --------------------------------------------------------------------------------


def ring(name: str, inner: float, outer: float, y0: float, y1: float) -> None:
    """A flat ring about the court, from `inner` beyond the arcade's plane to `outer`: four boxes that
    meet at the corners."""
    x0, x1 = HALF_LENGTH + inner, HALF_LENGTH + outer
    z0, z1 = HALF_WIDTH + inner, HALF_WIDTH + outer
    box(name, (-x1, y0, z0), (x1, y1, z1))
    box(name, (-x1, y0, -z1), (x1, y1, -z0))
    box(name, (x0, y0, -z0), (x1, y1, z0))
    box(name, (-x1, y0, -z0), (-x0, y1, z0))


def floor_tiles() -> None:
    columns, rows = HALF_LENGTH + AISLE, HALF_WIDTH + AISLE
    for i in range(-columns, columns):
        for j in range(-rows, rows):
            box("tile_dark" if (i + j) & 1 else "tile_light", (i + 0.012, -0.06, j + 0.012),
                (i + 0.988, 0, j + 0.988))
    box("mortar", (-columns - 0.2, -0.4, -rows - 0.2), (columns + 0.2, -0.012, rows + 0.2))


def fountain(x: float) -> None:
    basin = [(1.50, -0.02), (1.45, 0.06), (1.30, 0.10), (1.35, 0.44), (1.45, 0.50),
             (1.42, 0.58), (1.30, 0.60), (1.20, 0.55), (1.15, 0.20), (0.01, 0.20)]
    stem = [(0.30, 0.15), (0.32, 0.28), (0.20, 0.36), (0.15, 0.55), (0.17, 0.75),
            (0.13, 0.95), (0.16, 1.05), (0.40, 1.12), (0.62, 1.24), (0.70, 1.36),
            (0.72, 1.40), (0.66, 1.40), (0.50, 1.28), (0.20, 1.22), (0.10, 1.24),
            (0.07, 1.40), (0.12, 1.52), (0.15, 1.62), (0.12, 1.72), (0.01, 1.80)]
    lathe("trim", x, 0, basin, 48)
    lathe("stone", x, 0, stem, 32)


def build_atrium() -> None:
    global quarter, origin
    floor_tiles()
    ring("plaster", AISLE, AISLE + 0.4, -0.3, ROOF + 0.1)  # outer walls
    ring("wood", AISLE - 0.06, AISLE + 0.1, -0.1, 0.9)  # panelling
    ring("trim", -0.50, AISLE + 0.2, 5.0, GALLERY)  # gallery floor
    ring("trim", -0.56, AISLE + 0.5, ROOF, ROOF + 0.25)  # roof over the aisles
    ring("stone", -0.30, 0.30, ROOF + 0.2, ROOF + 0.8)  # parapet
    ring("trim", -0.38, 0.38, ROOF + 0.78, ROOF + 0.9)  # its coping
    for z in (-HALF_WIDTH, HALF_WIDTH):
        for x in (-HALF_LENGTH, HALF_LENGTH):
            block("stone", x, z, PIER_HALF, -0.1, ROOF + 0.1)
    fountain(3)
    places = ((0, HALF_WIDTH), (HALF_LENGTH, 0), (0, -HALF_WIDTH), (-HALF_LENGTH, 0))
    for quarter, (x, z) in enumerate(places):
        origin = (x, 0, z)
        side((10, 4)[quarter % 2], quarter)


def main() -> None:
    path = sys.argv[1]
    materials = os.path.splitext(path)[0] + ".mtl"
    build_atrium()
    with open(materials, "w", encoding="ascii") as file:
        for name, color in MATERIALS.items():
            file.write("newmtl %s\nKd %g %g %g\n\n" % (name, *color))
    with open(path, "w", encoding="ascii") as file:
        file.write(f"mtllib {os.path.basename(materials)}\n")
        file.writelines(lines)
        file.write(f"# {triangles} triangles\n")


main()
