/* `atrium OUT.obj` builds the heavy scene of this project: a court of 30 x 12 m with arcades on
 * two storeys, a gallery with balustrades, drapes in three colours and an open roof, and writes
 * it with its materials (OUT.mtl). ninja builds and runs it. The same bytes on every run.
 * Metres, y is up, the court's long axis is x.
 *
 * Solids are closed, face outward, and dip into each other by a few millimetres where they meet,
 * so that no two faces share a plane. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI       3.14159265358979323846
#define COUNT(a) (int)(sizeof(a) / sizeof((a)[0]))

/* Measures that several parts share. */
static const double BAY = 3, HALF_LENGTH = 15, HALF_WIDTH = 6, AISLE = 4;
static const double ARCH_RADIUS = 1.05, PANEL_HALF = 0.25, PIER_HALF = 0.45;
static const double GALLERY = 5.25, ROOF = 9.35;

struct material {
    const char *name;
    double color[3];
};

enum { STONE, TRIM, PLASTER, TILE_LIGHT, TILE_DARK, MORTAR, WOOD, RED, GREEN, BLUE, MATERIALS };
static const struct material materials[MATERIALS] = {
    [STONE] = {"stone", {0.70, 0.64, 0.54}},
    [TRIM] = {"trim", {0.78, 0.74, 0.66}},
    [PLASTER] = {"plaster", {0.74, 0.67, 0.56}},
    [TILE_LIGHT] = {"tile_light", {0.66, 0.60, 0.51}},
    [TILE_DARK] = {"tile_dark", {0.34, 0.22, 0.17}},
    [MORTAR] = {"mortar", {0.42, 0.39, 0.35}},
    [WOOD] = {"wood", {0.36, 0.21, 0.12}},
    [RED] = {"red_cloth", {0.68, 0.06, 0.05}},
    [GREEN] = {"green_cloth", {0.08, 0.44, 0.10}},
    [BLUE] = {"blue_cloth", {0.06, 0.16, 0.58}},
};

struct vec {
    double x, y, z;
};

/* Placement of the parts: quarter turns about y, then a move. `vertices`: number of vertices in the
 * file so far. */
struct sculptor {
    FILE *file;
    int quarter;
    struct vec origin;
    long vertices, triangles;
    int material;
};

/* ---- Writing --------------------------------------------------------------------------------- */

static struct vec turn(const struct sculptor *s, struct vec p)
{
    for (int i = 0; i < s->quarter; i++)
        p = (struct vec){p.z, p.y, -p.x};
    return p;
}

static void use(struct sculptor *s, int material)
{
    if (s->material != material)
        fprintf(s->file, "usemtl %s\n", materials[material].name);
    s->material = material;
}

/* Adds a vertex and returns its number; the normal needs no unit length. */
static long vertex(struct sculptor *s, struct vec p, struct vec n)
{
    double length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    p = turn(s, p);
    n = turn(s, n);
    fprintf(s->file, "v %.5f %.5f %.5f\n", p.x + s->origin.x, p.y + s->origin.y, p.z + s->origin.z);
    fprintf(s->file, "vn %.5f %.5f %.5f\n", n.x / length, n.y / length, n.z / length);
    return ++s->vertices;
}

/* Corners counter-clockwise seen from outside. */
static void quad(struct sculptor *s, long a, long b, long c, long d)
{
    fprintf(s->file, "f %ld//%ld %ld//%ld %ld//%ld\nf %ld//%ld %ld//%ld %ld//%ld\n", a, a, b, b, c,
            c, a, a, c, c, d, d);
    s->triangles += 2;
}

static void flat_quad(struct sculptor *s, struct vec a, struct vec b, struct vec c, struct vec d,
                      struct vec normal)
{
    long first = vertex(s, a, normal);
    vertex(s, b, normal);
    vertex(s, c, normal);
    vertex(s, d, normal);
    quad(s, first, first + 1, first + 2, first + 3);
}

/* ---- Solids ---------------------------------------------------------------------------------- */

static void box(struct sculptor *s, int material, struct vec a, struct vec b)
{
    use(s, material);
    struct vec p[8];
    for (int k = 0; k < 8; k++)
        p[k] = (struct vec){k & 1 ? b.x : a.x, k & 2 ? b.y : a.y, k & 4 ? b.z : a.z};
    flat_quad(s, p[0], p[4], p[6], p[2], (struct vec){-1, 0, 0});
    flat_quad(s, p[1], p[3], p[7], p[5], (struct vec){1, 0, 0});
    flat_quad(s, p[0], p[1], p[5], p[4], (struct vec){0, -1, 0});
    flat_quad(s, p[2], p[6], p[7], p[3], (struct vec){0, 1, 0});
    flat_quad(s, p[0], p[2], p[3], p[1], (struct vec){0, 0, -1});
    flat_quad(s, p[4], p[5], p[7], p[6], (struct vec){0, 0, 1});
}

/* A square block about the axis at (x, z). */
static void block(struct sculptor *s, int material, double x, double z, double half, double y0,
                  double y1)
{
    box(s, material, (struct vec){x - half, y0, z - half}, (struct vec){x + half, y1, z + half});
}

struct ring {
    double radius, y;
};

/* Turns a profile (from bottom to top) about a vertical axis; every band has its own normals, so
 * edges stay crisp. */
static void lathe(struct sculptor *s, int material, double x, double z, double y0,
                  const struct ring *profile, int rings, int segments)
{
    use(s, material);
    for (int r = 0; r + 1 < rings; r++) {
        const struct ring *low = &profile[r], *high = &profile[r + 1];
        double rise = high->y - low->y, inward = low->radius - high->radius;
        long first = s->vertices + 1;
        for (int i = 0; i < segments; i++) {
            double angle = 2 * PI * i / segments, c = cos(angle), t = sin(angle);
            struct vec normal = {rise * c, inward, rise * t};
            vertex(s, (struct vec){x + low->radius * c, y0 + low->y, z + low->radius * t}, normal);
            vertex(s, (struct vec){x + high->radius * c, y0 + high->y, z + high->radius * t},
                   normal);
        }
        for (int i = 0; i < segments; i++) {
            long a = first + 2 * i, b = first + 2 * ((i + 1) % segments);
            quad(s, a, a + 1, b + 1, b);
        }
    }
}

/* Appends a half-round moulding that bulges outward between two heights. */
static int bulge(struct ring *profile, int count, double radius, double y0, double y1, int steps)
{
    double half = 0.5 * (y1 - y0);
    for (int i = 0; i <= steps; i++) {
        double angle = PI * i / steps - PI / 2;
        profile[count++] = (struct ring){radius + half * cos(angle), y0 + half + half * sin(angle)};
    }
    return count;
}

/* Column with plinth, base, swelling shaft, capital and abacus, from y0 up to the springing of
 * the arch. */
static void column(struct sculptor *s, double x, double y0, double springing, double radius)
{
    double height = springing - y0, shaft0 = 0.34, shaft1 = height - 0.42;
    struct ring profile[40];
    int n = bulge(profile, 0, radius + 0.04, 0.10, 0.22, 5);
    n = bulge(profile, n, radius + 0.01, 0.25, 0.33, 4);
    for (int i = 0; i <= 8; i++) { /* entasis: the shaft narrows upward, slowly first */
        double t = i / 8.0;
        profile[n++] = (struct ring){radius * (1 - 0.16 * t * t), shaft0 + (shaft1 - shaft0) * t};
    }
    n = bulge(profile, n, radius * 0.86, shaft1 + 0.02, shaft1 + 0.08, 4);
    for (int i = 0; i <= 6; i++) { /* bell of the capital */
        double t = i / 6.0;
        profile[n++] =
            (struct ring){radius * 0.86 + (0.43 - radius * 0.86) * t * t, shaft1 + 0.09 + 0.22 * t};
    }
    profile[n++] = (struct ring){0.43, shaft1 + 0.34};
    block(s, TRIM, x, 0, 0.42, y0 - 0.02, y0 + 0.12);
    lathe(s, STONE, x, 0, y0, profile, n, 20);
    block(s, TRIM, x, 0, PIER_HALF + 0.03, springing - 0.09, springing);
}

/* ---- Arcade: local x runs along the side, local z points out of the court -------------------- */

enum { ARC_STEPS = 16 };

static struct vec on_arc(double center, double springing, double radius, int i, double z)
{
    double angle = PI - PI * i / ARC_STEPS;
    return (struct vec){center + radius * cos(angle), springing + radius * sin(angle), z};
}

/* Face of the wall above an arch, at depth z and looking along -z or +z. */
static void spandrel(struct sculptor *s, double center, double springing, double top, double z,
                     double facing)
{
    const struct vec normal = {0, 0, facing};
    double left = center - BAY / 2, right = center + BAY / 2, foot = springing - 0.02;
    double x[4] = {left, center - ARCH_RADIUS, center + ARCH_RADIUS, right};
    for (int side = 0; side < 3; side += 2)
        for (int part = 0; part < 2; part++) {
            double y0 = part ? springing : foot, y1 = part ? top : springing;
            struct vec a = {x[side], y0, z}, b = {x[side + 1], y0, z}, c = {x[side + 1], y1, z},
                       d = {x[side], y1, z};
            if (facing > 0)
                flat_quad(s, a, b, c, d, normal);
            else
                flat_quad(s, a, d, c, b, normal);
        }
    for (int i = 0; i < ARC_STEPS; i++) {
        struct vec a = on_arc(center, springing, ARCH_RADIUS, i, z),
                   b = on_arc(center, springing, ARCH_RADIUS, i + 1, z);
        struct vec c = {b.x, top, z}, d = {a.x, top, z};
        if (facing > 0)
            flat_quad(s, a, b, c, d, normal);
        else
            flat_quad(s, a, d, c, b, normal);
    }
}

/* Soffit of the arch and the two short jambs below it. */
static void soffit(struct sculptor *s, double center, double springing)
{
    long first = s->vertices + 1;
    for (int i = 0; i <= ARC_STEPS; i++) {
        struct vec a = on_arc(center, springing, ARCH_RADIUS, i, -PANEL_HALF), b = a;
        struct vec normal = {center - a.x, springing - a.y, 0};
        b.z = PANEL_HALF;
        vertex(s, a, normal);
        vertex(s, b, normal);
    }
    for (int i = 0; i < ARC_STEPS; i++) {
        long a = first + 2 * i;
        quad(s, a, a + 2, a + 3, a + 1);
    }
    for (int side = -1; side <= 1; side += 2) {
        double x = center + side * ARCH_RADIUS, y = springing - 0.02, z = -side * PANEL_HALF;
        flat_quad(s, (struct vec){x, y, z}, (struct vec){x, y, -z}, (struct vec){x, springing, -z},
                  (struct vec){x, springing, z}, (struct vec){-side, 0, 0});
    }
}

/* Round moulding about the arch, on the court's side. */
static void archivolt(struct sculptor *s, double center, double springing)
{
    enum { SEGMENTS = 6 };
    const double radius = ARCH_RADIUS + 0.13, thickness = 0.07;
    use(s, TRIM);
    long first = s->vertices + 1;
    for (int i = 0; i <= ARC_STEPS; i++) {
        struct vec p = on_arc(center, springing, radius, i, -PANEL_HALF);
        double out_x = (p.x - center) / radius, out_y = (p.y - springing) / radius;
        for (int k = 0; k < SEGMENTS; k++) {
            double c = cos(2 * PI * k / SEGMENTS), t = sin(2 * PI * k / SEGMENTS);
            struct vec n = {out_x * c, out_y * c, t};
            vertex(s,
                   (struct vec){p.x + thickness * n.x, p.y + thickness * n.y - 0.01,
                                p.z + thickness * n.z},
                   n);
        }
    }
    for (int i = 0; i < ARC_STEPS; i++)
        for (int k = 0; k < SEGMENTS; k++) {
            long a = first + i * SEGMENTS + k, b = first + i * SEGMENTS + (k + 1) % SEGMENTS;
            quad(s, a, b, b + SEGMENTS, a + SEGMENTS);
        }
}

static void arch(struct sculptor *s, double center, double springing, double top)
{
    use(s, STONE);
    spandrel(s, center, springing, top, -PANEL_HALF, -1);
    spandrel(s, center, springing, top, PANEL_HALF, 1);
    soffit(s, center, springing);
    double foot = springing - 0.02, inner = ARCH_RADIUS, outer = BAY / 2;
    for (int side = -1; side <= 1; side += 2) { /* the feet of the wall, inside the abaci */
        double z = side * PANEL_HALF;
        flat_quad(s, (struct vec){center + side * inner, foot, -z},
                  (struct vec){center + side * outer, foot, -z},
                  (struct vec){center + side * outer, foot, z},
                  (struct vec){center + side * inner, foot, z}, (struct vec){0, -1, 0});
    }
    archivolt(s, center, springing);
}

/* ---- Gallery and cloth ----------------------------------------------------------------------- */

static void balustrade(struct sculptor *s, double center)
{
    static const struct ring profile[] = {
        {0.050, 0.00}, {0.050, 0.08}, {0.030, 0.12}, {0.055, 0.24}, {0.062, 0.34},
        {0.045, 0.48}, {0.026, 0.60}, {0.040, 0.66}, {0.050, 0.70}, {0.050, 0.78}};
    enum { BALUSTERS = 8 };
    double half = BAY / 2 - 0.30;
    box(s, TRIM, (struct vec){center - half, GALLERY - 0.02, -0.12},
        (struct vec){center + half, GALLERY + 0.12, 0.12});
    for (int i = 0; i < BALUSTERS; i++)
        lathe(s, STONE, center - half + 2 * half * (i + 0.5) / BALUSTERS, 0, GALLERY + 0.11,
              profile, COUNT(profile), 8);
    box(s, TRIM, (struct vec){center - half, GALLERY + 0.88, -0.15},
        (struct vec){center + half, GALLERY + 1.0, 0.15});
}

/* A cloth that hangs from y1 to y0 before depth z: waves along x that open downward. A thin
 * closed solid. */
struct cloth {
    double x0, x1, y0, y1, z;
    double waves, depth, thickness;
    int columns, rows;
};

/* Depth of the cloth's middle, and its slopes along x and y. */
static double wave(const struct cloth *c, double u, double v, double *slope_u, double *slope_v)
{
    double phase = 2 * PI * c->waves * u, open = c->depth * (0.45 + 0.55 * (1 - v)),
           bend = 0.8 * sin(3.1 * v);
    *slope_u = open * 2 * PI * c->waves * cos(phase + bend) / (c->x1 - c->x0);
    *slope_v = (-0.55 * c->depth * sin(phase + bend) +
                open * 0.8 * 3.1 * cos(3.1 * v) * cos(phase + bend)) /
               (c->y1 - c->y0);
    return c->z + open * sin(phase + bend);
}

static struct vec cloth_point(const struct cloth *c, int i, int j, int face, struct vec *normal)
{
    double u = (double)i / c->columns, v = (double)j / c->rows, slope_u, slope_v;
    double z = wave(c, u, v, &slope_u, &slope_v) + face * c->thickness / 2;
    *normal = (struct vec){-face * slope_u, -face * slope_v, face};
    return (struct vec){c->x0 + (c->x1 - c->x0) * u, c->y0 + (c->y1 - c->y0) * v, z};
}

/* The hem between front and back, from grid point (i, j) to (k, l), counter-clockwise about the
 * front face. */
static void hem(struct sculptor *s, const struct cloth *c, int i, int j, int k, int l,
                struct vec out)
{
    struct vec unused;
    struct vec a = cloth_point(c, i, j, 1, &unused), b = cloth_point(c, k, l, 1, &unused);
    struct vec d = cloth_point(c, i, j, -1, &unused), e = cloth_point(c, k, l, -1, &unused);
    flat_quad(s, a, d, e, b, out);
}

static void drape(struct sculptor *s, int material, const struct cloth *c)
{
    use(s, material);
    for (int face = -1; face <= 1; face += 2) {
        long first = s->vertices + 1;
        for (int j = 0; j <= c->rows; j++)
            for (int i = 0; i <= c->columns; i++) {
                struct vec normal, p = cloth_point(c, i, j, face, &normal);
                vertex(s, p, normal);
            }
        for (int j = 0; j < c->rows; j++)
            for (int i = 0; i < c->columns; i++) {
                long a = first + j * (c->columns + 1) + i, b = a + 1, d = a + c->columns + 1,
                     e = d + 1;
                if (face > 0)
                    quad(s, a, b, e, d);
                else
                    quad(s, a, d, e, b);
            }
    }
    for (int i = 0; i < c->columns; i++) {
        hem(s, c, i, 0, i + 1, 0, (struct vec){0, -1, 0});
        hem(s, c, i + 1, c->rows, i, c->rows, (struct vec){0, 1, 0});
    }
    for (int j = 0; j < c->rows; j++) {
        hem(s, c, 0, j + 1, 0, j, (struct vec){-1, 0, 0});
        hem(s, c, c->columns, j, c->columns, j + 1, (struct vec){1, 0, 0});
    }
}

/* Behind an arch of the ground floor, on a rod. */
static void curtain(struct sculptor *s, int material, double center)
{
    struct cloth c = {.x0 = center - 1.15,
                      .x1 = center + 1.15,
                      .y0 = 0.12,
                      .y1 = 4.02,
                      .z = 0.75,
                      .waves = 7,
                      .depth = 0.11,
                      .thickness = 0.02,
                      .columns = 56,
                      .rows = 14};
    drape(s, material, &c);
    box(s, WOOD, (struct vec){center - 1.48, 4.0, 0.71}, (struct vec){center + 1.48, 4.07, 0.79});
}

/* Before the balustrade, on a rod that two brackets hold. */
static void banner(struct sculptor *s, int material, double center)
{
    struct cloth c = {.x0 = center - 0.6,
                      .x1 = center + 0.6,
                      .y0 = 4.3,
                      .y1 = 6.32,
                      .z = -0.66,
                      .waves = 2,
                      .depth = 0.05,
                      .thickness = 0.02,
                      .columns = 20,
                      .rows = 14};
    drape(s, material, &c);
    box(s, WOOD, (struct vec){center - 0.7, 6.30, -0.69}, (struct vec){center + 0.7, 6.36, -0.63});
    for (int side = -1; side <= 1; side += 2) {
        double x = center + side * 0.66;
        box(s, WOOD, (struct vec){x - 0.02, 6.18, -0.67}, (struct vec){x + 0.02, 6.34, 0.02});
    }
}

/* One side of the court: both arcades, the gallery's balustrade, beams, cloth. */
static void side(struct sculptor *s, int bays, int first_color)
{
    static const int colors[] = {RED, GREEN, BLUE};
    double start = -bays * BAY / 2;
    for (int i = 0; i < bays; i++) {
        double center = start + (i + 0.5) * BAY;
        int color = colors[(first_color + i / 2) % 3],
            other = colors[(first_color + i / 2 + 2) % 3];
        arch(s, center, 3.4, 5.06);
        arch(s, center, GALLERY + 2.6, ROOF + 0.06);
        balustrade(s, center);
        if (i % 2)
            curtain(s, color, center);
        else
            banner(s, other, center);
    }
    for (int i = 1; i < bays; i++) {
        double x = start + i * BAY;
        column(s, x, 0, 3.4, 0.34);
        column(s, x, GALLERY, GALLERY + 2.6, 0.28);
        block(s, TRIM, x, 0, 0.31, GALLERY - 0.01,
              GALLERY + 1.03); /* pedestal between balustrades */
        box(s, WOOD, (struct vec){x - 0.14, 4.72, 0.2}, (struct vec){x + 0.14, 5.02, AISLE + 0.1});
        box(s, WOOD, (struct vec){x - 0.14, ROOF - 0.3, 0.2},
            (struct vec){x + 0.14, ROOF + 0.02, AISLE + 0.1});
        box(s, TRIM, (struct vec){x - 0.3, -0.1, AISLE - 0.16},
            (struct vec){x + 0.3, ROOF + 0.03, AISLE + 0.1});
    }
    for (int i = 0; i < 2 * bays * (int)BAY - 2; i++) { /* dentils below both cornices */
        double x = start + 0.75 + 0.5 * i;
        box(s, TRIM, (struct vec){x - 0.11, 4.87, -0.40}, (struct vec){x + 0.11, 5.02, -0.20});
        box(s, TRIM, (struct vec){x - 0.11, ROOF - 0.13, -0.45},
            (struct vec){x + 0.11, ROOF + 0.02, -0.20});
    }
}

/* ---- The building ---------------------------------------------------------------------------- */

/* A flat ring about the court, from `inner` beyond the arcade's plane to `outer`: four boxes
 * that meet at the corners. */
static void ring(struct sculptor *s, int material, double inner, double outer, double y0, double y1)
{
    double x0 = HALF_LENGTH + inner, x1 = HALF_LENGTH + outer, z0 = HALF_WIDTH + inner,
           z1 = HALF_WIDTH + outer;
    box(s, material, (struct vec){-x1, y0, z0}, (struct vec){x1, y1, z1});
    box(s, material, (struct vec){-x1, y0, -z1}, (struct vec){x1, y1, -z0});
    box(s, material, (struct vec){x0, y0, -z0}, (struct vec){x1, y1, z0});
    box(s, material, (struct vec){-x1, y0, -z0}, (struct vec){-x0, y1, z0});
}

static void floor_tiles(struct sculptor *s)
{
    int columns = (int)(HALF_LENGTH + AISLE), rows = (int)(HALF_WIDTH + AISLE);
    for (int i = -columns; i < columns; i++)
        for (int j = -rows; j < rows; j++)
            box(s, (i + j) & 1 ? TILE_DARK : TILE_LIGHT, (struct vec){i + 0.012, -0.06, j + 0.012},
                (struct vec){i + 0.988, 0, j + 0.988});
    box(s, MORTAR, (struct vec){-columns - 0.2, -0.4, -rows - 0.2},
        (struct vec){columns + 0.2, -0.012, rows + 0.2});
}

static void fountain(struct sculptor *s, double x)
{
    static const struct ring basin[] = {{0.01, 0.20}, {1.15, 0.20}, {1.20, 0.55}, {1.30, 0.60},
                                        {1.42, 0.58}, {1.45, 0.50}, {1.35, 0.44}, {1.30, 0.10},
                                        {1.45, 0.06}, {1.50, -0.02}};
    static const struct ring stem[] = {{0.30, 0.15}, {0.32, 0.28}, {0.20, 0.36}, {0.15, 0.55},
                                       {0.17, 0.75}, {0.13, 0.95}, {0.16, 1.05}, {0.40, 1.12},
                                       {0.62, 1.24}, {0.70, 1.36}, {0.72, 1.40}, {0.66, 1.40},
                                       {0.50, 1.28}, {0.20, 1.22}, {0.10, 1.24}, {0.07, 1.40},
                                       {0.12, 1.52}, {0.15, 1.62}, {0.12, 1.72}, {0.01, 1.80}};
    struct ring outward[COUNT(
        basin)]; /* drawn from the inside to the outside; a lathe wants it the other way */
    for (int i = 0; i < COUNT(basin); i++)
        outward[i] = basin[COUNT(basin) - 1 - i];
    lathe(s, TRIM, x, 0, 0, outward, COUNT(basin), 48);
    lathe(s, STONE, x, 0, 0, stem, COUNT(stem), 32);
}

static void build_atrium(struct sculptor *s)
{
    static const int bays[4] = {10, 4, 10, 4};
    const struct vec origins[4] = {
        {0, 0, HALF_WIDTH}, {HALF_LENGTH, 0, 0}, {0, 0, -HALF_WIDTH}, {-HALF_LENGTH, 0, 0}};
    floor_tiles(s);
    ring(s, PLASTER, AISLE, AISLE + 0.4, -0.3, ROOF + 0.1); /* outer walls */
    ring(s, WOOD, AISLE - 0.06, AISLE + 0.1, -0.1, 0.9);    /* panelling */
    ring(s, TRIM, -0.50, AISLE + 0.2, 5.0, GALLERY);        /* gallery floor */
    ring(s, TRIM, -0.56, AISLE + 0.5, ROOF, ROOF + 0.25);   /* roof over the aisles */
    ring(s, STONE, -0.30, 0.30, ROOF + 0.2, ROOF + 0.8);    /* parapet */
    ring(s, TRIM, -0.38, 0.38, ROOF + 0.78, ROOF + 0.9);    /* its coping */
    for (int k = 0; k < 4; k++)
        block(s, STONE, k & 1 ? HALF_LENGTH : -HALF_LENGTH, k & 2 ? HALF_WIDTH : -HALF_WIDTH,
              PIER_HALF, -0.1, ROOF + 0.1);
    fountain(s, 3);
    for (int k = 0; k < 4; k++) {
        s->quarter = k;
        s->origin = origins[k];
        side(s, bays[k], k);
    }
}

/* ---- Files ----------------------------------------------------------------------------------- */

static int finish(FILE *file, const char *temporary, const char *path)
{
    int bad = ferror(file);
    bad |= fclose(file) != 0;
    if (bad || rename(temporary, path) != 0) {
        fprintf(stderr, "atrium: cannot write %s; is there room on the disk?\n", path);
        remove(temporary);
        return 1;
    }
    return 0;
}

static FILE *start_mesh(const char *path, char *temporary, size_t size)
{
    int length = snprintf(temporary, size, "%s.tmp", path);
    FILE *file = length > 0 && (size_t)length < size ? fopen(temporary, "w") : NULL;
    if (!file)
        fprintf(stderr, "atrium: cannot write %s; does its folder exist?\n", path);
    return file;
}

static int write_materials(const char *path)
{
    char temporary[4096];
    FILE *file = start_mesh(path, temporary, sizeof temporary);
    if (!file)
        return 1;
    for (int i = 0; i < MATERIALS; i++)
        fprintf(file, "newmtl %s\nKd %g %g %g\n\n", materials[i].name, materials[i].color[0],
                materials[i].color[1], materials[i].color[2]);
    return finish(file, temporary, path);
}

int main(int argc, char **argv)
{
    size_t length = argc == 2 ? strlen(argv[1]) : 0;
    char temporary[4096], material_path[4096];
    if (length < 5 || length >= sizeof material_path || strcmp(argv[1] + length - 4, ".obj") != 0) {
        fprintf(stderr, "usage: atrium OUT.obj\nwrites the mesh, and its materials to OUT.mtl\n");
        return 2;
    }
    snprintf(material_path, sizeof material_path, "%.*s.mtl", (int)length - 4, argv[1]);
    if (write_materials(material_path))
        return 1;
    FILE *file = start_mesh(argv[1], temporary, sizeof temporary);
    if (!file)
        return 1;
    const char *slash = strrchr(material_path, '/');
    fprintf(file, "mtllib %s\n", slash ? slash + 1 : material_path);
    struct sculptor sculptor = {.file = file, .material = -1};
    build_atrium(&sculptor);
    fprintf(file, "# %ld triangles\n", sculptor.triangles);
    return finish(file, temporary, argv[1]);
}
