/* The pass gbuffer_triangles on the CPU, for AVX2: the same triangles, eight pixels of a row at a
 * time. Vertices, then triangles, then bands of rows go to the processor's threads; each band takes
 * the triangles in order. Texels at edges may have the other triangle than on a device. */
#include "limit.h"
#include DT_LIMIT_HEADER

#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BAND = 32 /* rows */, CHUNK = 4096 /* triangles */, MOST_CORNERS = 4 };

const struct dt_limit_tolerance limit_gbuffer_triangles_tolerance = {.relative = 1e-5,
                                                                     .outliers = 0.02};

/* a x + b y + c at a pixel's centre. */
struct plane {
    float a, b, c;
};

/* A triangle on the screen, or what is left of one behind the near plane. */
struct piece {
    struct plane edges[3]; /* at least 0 inside */
    struct plane depth;
    int x0, x1, y0, y1; /* pixels, ends excluded */
    uint32_t triangle;
};

struct corner {
    float x, y, z, w; /* of clip space */
};

/* Kept from frame to frame: two slots for each triangle, of which a chunk fills the first. */
static struct corner *corners;
static struct piece *pieces;
static uint32_t *counts, room;

/* ---- Holes ----------------------------------------------------------------------------------- */

/* u / w, v / w and 1 / w of a triangle's plane, and its texture. */
struct hole {
    struct plane u, v, w;
    const struct dt_scene *scene;
    const struct dt_material *material;
};

static float at(const struct plane *plane, float x, float y)
{
    return plane->a * x + plane->b * y + plane->c;
}

/* The level of hole.glsl's mip_of, from differences to the next pixels. */
static int level_of(const struct dt_scene *scene, const float here[2], const float right[2],
                    const float up[2])
{
    float across[2], square[2] = {0, 0};
    const float size[2] = {(float)scene->texture_width, (float)scene->texture_height};
    for (int i = 0; i < 2; i++) {
        across[0] = (right[i] - here[i]) * size[i];
        across[1] = (up[i] - here[i]) * size[i];
        square[0] += across[0] * across[0];
        square[1] += across[1] * across[1];
    }
    int level = (int)floorf(0.5f * log2f(fmaxf(fmaxf(square[0], square[1]), 1e-20f)) + 0.5f);
    int last = (int)scene->texture_mips - 1;
    return level < 0 ? 0 : level > last ? last : level;
}

static bool is_hole(const struct hole *hole, float x, float y)
{
    const struct dt_scene *scene = hole->scene;
    float uv[3][2];
    for (int i = 0; i < 3; i++) {
        float px = x + (i == 1), py = y + (i == 2), w = 1 / at(&hole->w, px, py);
        uv[i][0] = at(&hole->u, px, py) * w;
        uv[i][1] = at(&hole->v, px, py) * w;
    }
    int level = level_of(scene, uv[0], uv[1], uv[2]);
    const uint8_t *texels = scene->texels;
    uint32_t width = scene->texture_width, height = scene->texture_height;
    for (int i = 0; i < level; i++) {
        texels += (size_t)4 * width * height * scene->texture_layers;
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
    }
    uint32_t column = (uint32_t)((uv[0][0] - floorf(uv[0][0])) * (float)width);
    uint32_t row = (uint32_t)((uv[0][1] - floorf(uv[0][1])) * (float)height);
    column = column < width ? column : width - 1;
    row = row < height ? row : height - 1;
    size_t texel = ((size_t)hole->material->texture * height + row) * width + column;
    return texels[4 * texel + 3] < 255 * hole->material->alpha_cutoff;
}

/* ---- Triangles ------------------------------------------------------------------------------- */

/* The plane through values at three corners on the screen; `area` is twice the triangle's. */
static struct plane plane_of(const float x[3], const float y[3], const float value[3], float area)
{
    struct plane plane = {
        .a =
            (value[0] * (y[1] - y[2]) + value[1] * (y[2] - y[0]) + value[2] * (y[0] - y[1])) / area,
        .b = (value[0] * (x[2] - x[1]) + value[1] * (x[0] - x[2]) + value[2] * (x[1] - x[0])) /
             area};
    plane.c = value[0] - plane.a * x[0] - plane.b * y[0];
    return plane;
}

static float area_of(const float x[3], const float y[3])
{
    return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
}

static int pixel(float position, int end)
{
    return position < 0 ? 0 : position > (float)end ? end : (int)position;
}

/* The range of centres between the least and the largest position. */
static void range(const float values[3], int end, int *first, int *last)
{
    float least = fminf(fminf(values[0], values[1]), values[2]);
    float most = fmaxf(fmaxf(values[0], values[1]), values[2]);
    *first = pixel(ceilf(least - 0.5f), end);
    *last = pixel(floorf(most - 0.5f) + 1, end);
}

static bool make_piece(const struct corner *const from[3], const struct dt_frame *frame,
                       struct piece *piece)
{
    float x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        float w = 1 / from[i]->w;
        x[i] = (from[i]->x * w * 0.5f + 0.5f) * (float)frame->width;
        y[i] = (from[i]->y * w * 0.5f + 0.5f) * (float)frame->height;
        z[i] = from[i]->z * w;
    }
    range(x, (int)frame->width, &piece->x0, &piece->x1);
    range(y, (int)frame->height, &piece->y0, &piece->y1);
    float area = area_of(x, y);
    if (piece->x0 >= piece->x1 || piece->y0 >= piece->y1 || area == 0)
        return false;
    for (int i = 0; i < 3; i++)
        piece->edges[i] = plane_of(x, y, (float[3]){i == 0, i == 1, i == 2}, area);
    piece->depth = plane_of(x, y, z, area);
    return true;
}

/* What lies behind the near plane: 0, 3 or 4 corners. */
static uint32_t clip(const struct corner *const from[3], struct corner *out)
{
    uint32_t count = 0;
    for (int i = 0; i < 3; i++) {
        const struct corner *a = from[i], *b = from[(i + 1) % 3];
        if (a->z >= 0)
            out[count++] = *a;
        if ((a->z >= 0) == (b->z >= 0))
            continue;
        float t = a->z / (a->z - b->z);
        out[count++] = (struct corner){a->x + t * (b->x - a->x), a->y + t * (b->y - a->y), 0,
                                       a->w + t * (b->w - a->w)};
    }
    return count;
}

static uint32_t make_pieces(const struct dt_limit *limit, uint32_t triangle, struct piece *out)
{
    const uint32_t *index = &limit->scene->indices[3 * triangle];
    const struct corner *from[3] = {&corners[index[0]], &corners[index[1]], &corners[index[2]]};
    struct corner clipped[MOST_CORNERS];
    uint32_t kept = 0, count = 3;
    bool whole = from[0]->z >= 0 && from[1]->z >= 0 && from[2]->z >= 0;
    if (!whole)
        count = clip(from, clipped);
    for (uint32_t i = 0; i + 2 < count; i++) {
        const struct corner *part[3] = {&clipped[0], &clipped[i + 1], &clipped[i + 2]};
        out[kept].triangle = triangle;
        kept += make_piece(whole ? from : part, limit->frame, &out[kept]);
    }
    return kept;
}

static void make_chunk(const struct dt_limit *limit, uint32_t chunk)
{
    uint32_t end = limit->scene->index_count / 3, first = chunk * CHUNK, count = 0;
    end = end < first + CHUNK ? end : first + CHUNK;
    for (uint32_t i = first; i < end; i++)
        count += make_pieces(limit, i, &pieces[2 * first + count]);
    counts[chunk] = count;
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

static struct hole find_hole(const struct dt_limit *limit, uint32_t triangle)
{
    const struct dt_scene *scene = limit->scene;
    const uint32_t *index = &scene->indices[3 * triangle];
    struct hole hole = {.scene = scene,
                        .material = &scene->materials[scene->vertices[index[0]].material]};
    if (hole.material->alpha_cutoff <= 0 || hole.material->texture < 0)
        hole.material = NULL;
    if (!hole.material)
        return hole;
    float x[3], y[3], u[3], v[3], w[3];
    for (int i = 0; i < 3; i++) {
        const struct corner *corner = &corners[index[i]];
        w[i] = 1 / corner->w;
        x[i] = (corner->x * w[i] * 0.5f + 0.5f) * (float)limit->frame->width;
        y[i] = (corner->y * w[i] * 0.5f + 0.5f) * (float)limit->frame->height;
        u[i] = scene->vertices[index[i]].uv[0] * w[i];
        v[i] = scene->vertices[index[i]].uv[1] * w[i];
    }
    float area = area_of(x, y);
    hole.u = plane_of(x, y, u, area);
    hole.v = plane_of(x, y, v, area);
    hole.w = plane_of(x, y, w, area);
    return hole;
}

static __m256 line(const struct plane *plane, __m256 x, float y)
{
    return _mm256_fmadd_ps(_mm256_set1_ps(plane->a), x, _mm256_set1_ps(plane->b * y + plane->c));
}

static __m256 without_holes(const struct hole *hole, __m256 inside, int x, float y)
{
    float kept[8];
    int mask = _mm256_movemask_ps(inside);
    for (int i = 0; i < 8; i++)
        kept[i] = mask >> i & 1 && !is_hole(hole, (float)(x + i) + 0.5f, y) ? -1.0f : 0.0f;
    return _mm256_and_ps(inside, _mm256_loadu_ps(kept));
}

static void draw_row(const struct piece *piece, const struct hole *hole, int row, uint32_t *numbers,
                     float *depths)
{
    const __m256 steps = _mm256_setr_ps(0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f, 6.5f, 7.5f);
    const __m256 zero = _mm256_setzero_ps();
    const __m256i number = _mm256_set1_epi32((int)piece->triangle + 1);
    float y = (float)row + 0.5f;
    for (int at = piece->x0; at < piece->x1; at += 8) {
        __m256 x = _mm256_add_ps(_mm256_set1_ps((float)at), steps);
        __m256 inside = _mm256_cmp_ps(x, _mm256_set1_ps((float)piece->x1), _CMP_LT_OQ);
        for (int i = 0; i < 3; i++)
            inside = _mm256_and_ps(inside,
                                   _mm256_cmp_ps(line(&piece->edges[i], x, y), zero, _CMP_GE_OQ));
        if (_mm256_testz_ps(inside, inside))
            continue;
        __m256 before = _mm256_maskload_ps(depths + at, _mm256_castps_si256(inside));
        __m256 depth = line(&piece->depth, x, y);
        inside = _mm256_and_ps(inside, _mm256_cmp_ps(depth, before, _CMP_LT_OQ));
        if (hole->material && !_mm256_testz_ps(inside, inside))
            inside = without_holes(hole, inside, at, y);
        _mm256_maskstore_ps(depths + at, _mm256_castps_si256(inside), depth);
        _mm256_maskstore_epi32((int *)numbers + at, _mm256_castps_si256(inside), number);
    }
}

static void draw_band(const struct dt_limit *limit, uint32_t chunks, int first, int end)
{
    uint32_t *numbers = (uint32_t *)limit->outputs[DT_LIMIT_RESOURCE(GBUFFER_TRIANGLE)].data;
    float *depths = (float *)limit->outputs[DT_LIMIT_RESOURCE(GBUFFER_DEPTH)].data;
    size_t width = limit->frame->width;
    memset(numbers + width * first, 0, width * (end - first) * sizeof *numbers);
    for (size_t i = width * first; i < width * end; i++)
        depths[i] = 1;
    for (uint32_t chunk = 0; chunk < chunks; chunk++)
        for (uint32_t i = 0; i < counts[chunk]; i++) {
            const struct piece *piece = &pieces[2 * (size_t)chunk * CHUNK + i];
            int from = piece->y0 > first ? piece->y0 : first;
            int to = piece->y1 < end ? piece->y1 : end;
            if (from >= to)
                continue;
            struct hole hole = find_hole(limit, piece->triangle);
            for (int row = from; row < to; row++)
                draw_row(piece, &hole, row, numbers + width * row, depths + width * row);
        }
}

/* ---- The pass -------------------------------------------------------------------------------- */

static bool make_room(const struct dt_scene *scene, uint32_t chunks)
{
    if (room == chunks)
        return true;
    corners = realloc(corners, scene->vertex_count * sizeof *corners);
    pieces = realloc(pieces, (size_t)chunks * CHUNK * 2 * sizeof *pieces);
    counts = realloc(counts, chunks * sizeof *counts);
    room = chunks;
    return corners && pieces && counts;
}

void limit_gbuffer_triangles(const struct dt_limit *limit)
{
    const struct dt_scene *scene = limit->scene;
    const float(*m)[4] = limit->frame->camera.view_projection;
    uint32_t chunks = (scene->index_count / 3 + CHUNK - 1) / CHUNK;
    int height = (int)limit->frame->height;
    if (!make_room(scene, chunks))
        abort();
#pragma omp parallel for schedule(static)
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        const float *p = scene->vertices[i].position;
        float out[4];
        for (int k = 0; k < 4; k++)
            out[k] = m[0][k] * p[0] + m[1][k] * p[1] + m[2][k] * p[2] + m[3][k];
        corners[i] = (struct corner){out[0], out[1], out[2], out[3]};
    }
#pragma omp parallel for schedule(dynamic)
    for (uint32_t chunk = 0; chunk < chunks; chunk++)
        make_chunk(limit, chunk);
#pragma omp parallel for schedule(dynamic)
    for (int first = 0; first < height; first += BAND)
        draw_band(limit, chunks, first, first + BAND < height ? first + BAND : height);
}
#endif
