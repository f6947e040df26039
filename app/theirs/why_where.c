/* Faults that show in some places alone, and those that only a share of elements tells. See why_fault.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "theirs/why_fault.h"

/* ---- Places ------------------------------------------------------------------------------------ */

/* p: rows from the left, the bottom, the right, the top. */
static bool at_border(const struct asked *asked, struct place place)
{
    int64_t w = asked->to->extent[0], h = asked->image ? asked->to->extent[1] : 1;
    return place.x < (int64_t)asked->p[0] || place.y < (int64_t)asked->p[1] ||
           place.x >= w - (int64_t)asked->p[2] || place.y >= h - (int64_t)asked->p[3];
}

/* Behind the last whole tile of p[0]; p[1]: of a buffer. */
static bool behind_tiles(const struct asked *asked, struct place place)
{
    int64_t tile = (int64_t)asked->p[0], w = asked->to->extent[0];
    int64_t h = asked->image ? asked->to->extent[1] : 1;
    if (asked->image && h > 1)
        return place.x >= w / tile * tile || place.y >= h / tile * tile;
    return place.x >= w / tile * tile;
}

/* At the first or last column or row of a tile of p[0]. */
static bool at_tile_edge(const struct asked *asked, struct place place)
{
    int64_t tile = (int64_t)asked->p[0], x = place.x % tile, y = place.y % tile;
    bool rows = asked->image && asked->to->extent[1] > 1;
    return x == 0 || x == tile - 1 || (rows && (y == 0 || y == tile - 1));
}

static bool in_layer(const struct asked *asked, struct place place)
{
    int64_t last = (int64_t)asked->to->extent[2] - 1;
    return asked->image && last > 0 && place.z == (asked->p[0] > 0 ? last : 0);
}

static double numbers_differ(const struct asked *asked, struct place place, uint32_t component)
{
    place.component = component;
    double a = same_from(asked, place, component), b = to_number(asked, place);
    return a == b ? 0 : fabs(a - b);
}

/* Where `from` changes steeply from texel to texel. */
static bool at_edge(const struct asked *asked, struct place place)
{
    for (uint32_t c = 0; c < asked->count; c++) {
        double here = same_from(asked, place, c);
        for (int i = 0; i < 4; i++) {
            double there = from_at(asked, place, place.x + (i == 0) - (i == 1),
                                   place.y + (i == 2) - (i == 3), place.z, c);
            if (fabs(there - here) > 0.3 * asked->range)
                return true;
        }
    }
    return false;
}

/* ---- Shares ------------------------------------------------------------------------------------ */

/* Of differing elements, those without a number of `to` that is NaN or infinite. */
static double not_nan(const struct asked *asked)
{
    uint32_t others = 0;
    for (uint32_t i = 0; i < asked->differing_count; i++) {
        bool found = false;
        for (uint32_t c = 0; c < asked->count; c++)
            found |= !isfinite(to_number(asked, place_of(asked, asked->differing[i], c)));
        others += !found;
    }
    return asked->differing_count ? (double)others / asked->differing_count : 9;
}

static bool is_pattern(const uint8_t *bytes, uint32_t size)
{
    static const uint8_t words[][4] = {{0xef, 0xbe, 0xad, 0xde},
                                       {0x0d, 0xf0, 0xad, 0xba},
                                       {0xbe, 0xba, 0xfe, 0xca},
                                       {0x0d, 0xf0, 0xfe, 0xca}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(words) && size % 4 == 0; i++) {
        uint32_t at = 0;
        while (at < size && !memcmp(bytes + at, words[i], 4))
            at += 4;
        if (at >= size)
            return true;
    }
    uint32_t same = 0;
    while (same < size && bytes[same] == bytes[0])
        same++;
    return same == size &&
           strchr("\xcd\xcc\xfe\xab\xaa\xa5\x5a\x55\xdd\xfd\xbd\x7f\xba", bytes[0]) && bytes[0];
}

/* Of differing elements, those that are no byte or word that fills memory before it is written. */
static double no_pattern(const struct asked *asked)
{
    uint32_t others = 0;
    for (uint32_t i = 0; i < asked->differing_count; i++)
        others += !is_pattern(asked->to->data + asked->differing[i] * asked->stride, asked->stride);
    return asked->differing_count >= 2 ? (double)others / asked->differing_count : 9;
}

/* Whether two elements of a copy have the same numbers. */
static bool same_element(const struct asked *asked, const struct copy *copy, uint64_t a, uint64_t b)
{
    for (uint32_t c = 0; c < asked->count; c++)
        if (copy_number(asked, copy, place_of(asked, a, c)) !=
            copy_number(asked, copy, place_of(asked, b, c)))
            return false;
    return true;
}

/* The share of `list` in which the copy has not what most of them have, by a vote of pairs. */
static double unlike(const struct asked *asked, const struct copy *copy, const uint64_t *list,
                     uint32_t count, uint64_t *most)
{
    uint32_t votes = 0, others = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!votes)
            *most = list[i];
        votes = same_element(asked, copy, *most, list[i]) ? votes + 1 : votes - 1;
    }
    for (uint32_t i = 0; i < count; i++)
        others += !same_element(asked, copy, *most, list[i]);
    return count ? (double)others / count : 1;
}

/* All differing elements of `from` have one value, which `to` has nowhere there. */
static double was_cleared(const struct asked *asked)
{
    uint64_t most = 0, other = 0;
    if (asked->differing_count < 8)
        return 9;
    double left = unlike(asked, asked->from, asked->differing, asked->differing_count, &most);
    double varied = unlike(asked, asked->to, asked->differing, asked->differing_count, &other);
    return varied > 0.2 ? left : 9;
}

/* What is background in one copy is covered in the other. */
static double not_inverted(const struct asked *asked)
{
    uint64_t most = 0;
    uint32_t both = 0, covered = 0;
    if (!asked->all_count || unlike(asked, asked->from, asked->all, asked->all_count, &most) > 0.9)
        return 9;
    for (uint32_t i = 0; i < asked->all_count; i++) {
        bool a = true, b = true;
        for (uint32_t c = 0; c < asked->count; c++) {
            double background = copy_number(asked, asked->from, place_of(asked, most, c));
            struct place place = place_of(asked, asked->all[i], c);
            a &= same_from(asked, place, c) == background;
            b &= to_number(asked, place) == background;
        }
        both += a == b;
        covered += !a;
    }
    return covered * 10 > asked->all_count && covered * 10 < asked->all_count * 9
               ? (double)both / asked->all_count
               : 9;
}

/* Only channel p[0] differs. */
static double other_channels(const struct asked *asked)
{
    uint32_t others = 0;
    if (asked->count < 2 || asked->differing_count < 4 || asked->p[0] >= asked->count)
        return 9;
    for (uint32_t i = 0; i < asked->differing_count; i++)
        for (uint32_t c = 0; c < asked->count; c++)
            if (c != (uint32_t)asked->p[0] &&
                numbers_differ(asked, place_of(asked, asked->differing[i], 0), c) > 0) {
                others++;
                break;
            }
    return asked->differing_count ? (double)others / asked->differing_count : 9;
}

static uint64_t hash_element(const struct asked *asked, const struct copy *copy, uint64_t element)
{
    uint64_t hash = 14695981039346656037u;
    for (uint32_t c = 0; c < asked->count; c++) {
        double value = copy_number(asked, copy, place_of(asked, element, c));
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * 1099511628211u;
        hash ^= hash >> 29;
    }
    return hash;
}

static int compare_hashes(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* The elements of a buffer are the same but for their order. */
static double other_order(const struct asked *asked)
{
    uint64_t count = asked->to->extent[0], missing = 0;
    if (asked->image || count < 4 || count > 4 << 20)
        return 9;
    uint64_t *a = calloc(count, sizeof *a), *b = calloc(count, sizeof *b);
    for (uint64_t i = 0; a && b && i < count; i++) {
        a[i] = hash_element(asked, asked->from, i);
        b[i] = hash_element(asked, asked->to, i);
    }
    if (a && b) {
        qsort(a, count, sizeof *a, compare_hashes);
        qsort(b, count, sizeof *b, compare_hashes);
        for (uint64_t i = 0, k = 0; i < count; i++) {
            while (k < count && b[k] < a[i])
                k++;
            missing += k == count || b[k++] != a[i];
        }
    }
    double share = a && b ? (double)missing / (double)count : 9;
    free(a);
    free(b);
    return share;
}

/* Whole tiles of p[0] differ, and others do not. */
static double other_than_tiles(const struct asked *asked)
{
    int64_t tile = (int64_t)asked->p[0], w = asked->to->extent[0], h = asked->to->extent[1];
    uint32_t wrong = 0, tried = 0;
    if (!asked->image || w < 3 * tile || h < tile || asked->differing_count < tile * tile / 2)
        return 9;
    for (uint32_t i = 0; i < asked->differing_count; i += asked->differing_count / 200 + 1) {
        struct place place = place_of(asked, asked->differing[i], 0);
        int64_t x = place.x / tile * tile, y = place.y / tile * tile;
        for (int k = 0; k < 4; k++, tried++) { /* the corners of its tile, a texel in */
            struct place corner = place;
            corner.x = x + (k & 1 ? tile - 1 : 0);
            corner.y = y + (k & 2 ? tile - 1 : 0);
            bool differs = corner.x >= w || corner.y >= h;
            for (uint32_t c = 0; c < asked->count; c++)
                differs |= numbers_differ(asked, corner, c) > 0;
            wrong += !differs;
        }
    }
    uint32_t equal = 0;
    for (uint32_t i = 0; i < asked->all_count; i++) {
        bool differs = false;
        for (uint32_t c = 0; c < asked->count; c++)
            differs |= numbers_differ(asked, place_of(asked, asked->all[i], 0), c) > 0;
        equal += !differs;
    }
    return equal * 5 > asked->all_count ? (double)wrong / tried : 9;
}

/* ---- The table --------------------------------------------------------------------------------- */

#define WHERE(label, function, same, unsure, words, ...)                                           \
    {                                                                                              \
        .name = (label), .text = (words), .where = (function), .symmetric = (same),                \
        .doubt = (unsure), .p = {                                                                  \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }
#define SHARE(label, function, same, unsure, words, ...)                                           \
    {                                                                                              \
        .name = (label), .text = (words), .share = (function), .symmetric = (same),                \
        .doubt = (unsure), .p = {                                                                  \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }

/* A row: its name, what it calls, whether it is the same from either copy, its
 * doubt, what it says, and p. */
static const struct fault rows[] = {
    SHARE("order", other_order, SAME, 0.06, "in the order of elements alone: the same are in both",
          0),
    SHARE("nan", not_nan, SIDED, 0, "where {to} is NaN or infinite", 0),
    SHARE("uninitialised", no_pattern, SIDED, 0,
          "where {to} has the pattern of memory that nothing has written", 0),
    SHARE("coverage", not_inverted, SIDED, 0.01,
          "by coverage: what is background in one is drawn in the other (winding, culling or depth "
          "test)",
          0),
    WHERE("border", at_border, SAME, 0, "in the last row alone", 0, 0, 0, 1),
    WHERE("border", at_border, SAME, 0, "in the first row alone", 0, 1),
    WHERE("border", at_border, SAME, 0, "in the last column (or element) alone", 0, 0, 1, 0),
    WHERE("border", at_border, SAME, 0, "in the first column (or element) alone", 1),
    WHERE("border", at_border, SAME, 0,
          "in the last row and column alone: an odd size is rounded down", 0, 0, 1, 1),
    WHERE("border", at_border, SAME, 0, "at the border alone: clamp, wrap or border colour", 1, 1,
          1, 1),
    WHERE("border", at_border, SAME, 0,
          "in the two texels at the border: clamp, wrap or border colour", 2, 2, 2, 2),
    WHERE("rest", behind_tiles, SAME, 0,
          "behind the last whole tile of 8: the dispatch is too small", 8),
    WHERE("rest", behind_tiles, SAME, 0,
          "behind the last whole tile of 16: the dispatch is too small", 16),
    WHERE("rest", behind_tiles, SAME, 0,
          "behind the last whole tile of 32: the dispatch is too small", 32),
    WHERE("rest", behind_tiles, SAME, 0,
          "behind the last whole group of 64: the dispatch is too small", 64),
    WHERE("tile_edges", at_tile_edge, SAME, 0, "at the edges of tiles of 64 alone", 64),
    WHERE("tile_edges", at_tile_edge, SAME, 0, "at the edges of tiles of 32 alone", 32),
    WHERE("tile_edges", at_tile_edge, SAME, 0, "at the edges of tiles of 16 alone", 16),
    WHERE("tile_edges", at_tile_edge, SAME, 0, "at the edges of tiles of 8 alone", 8),
    SHARE("tiles", other_than_tiles, SAME, 0.16, "in whole tiles of 32x32", 32),
    SHARE("tiles", other_than_tiles, SAME, 0.17, "in whole tiles of 16x16", 16),
    SHARE("tiles", other_than_tiles, SAME, 0.18, "in whole tiles of 8x8", 8),
    SHARE("clear", was_cleared, SIDED, 0.2,
          "where {from} has one value: {to} lacks a clear, or {from} a draw", 0),
    WHERE("layer_alone", in_layer, SAME, 0, "in the first layer alone", 0),
    WHERE("layer_alone", in_layer, SAME, 0, "in the last layer alone", 1),
    SHARE("channel", other_channels, SAME, 0.3, "in red (x) alone", 0),
    SHARE("channel", other_channels, SAME, 0.3, "in green (y) alone", 1),
    SHARE("channel", other_channels, SAME, 0.3, "in blue (z) alone", 2),
    SHARE("channel", other_channels, SAME, 0.3, "in alpha (w) alone", 3),
    WHERE("edges", at_edge, SAME, 0.1, "at edges alone: rasterization, samples or filters", 0),
};

const struct fault_list faults_where = {rows, DT_ARRAY_COUNT(rows)};
