/* Faults that change each number by itself: encodings, depth conventions, rounding, factors. See why_fault.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "theirs/theirs.h"
#include "theirs/why_fault.h"

enum { FIT_PAIRS = 512 };

static enum number_kind kind_of(const struct asked *asked)
{
    return asked->components[0].kind;
}

static bool has_reals(const struct asked *asked)
{
    return !number_is_integer(kind_of(asked));
}

/* ---- Numbers ----------------------------------------------------------------------------------- */

static double to_srgb(const double *p, double v)
{
    (void)p;
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

static double power(const double *p, double v)
{
    return pow(fmax(v, 0), p[0]);
}

/* p: factor and offset. */
static double affine(const double *p, double v)
{
    return p[0] * v + p[1];
}

static double inverse_affine(const double *p, double v)
{
    return 1 / (p[0] * v + p[1]);
}

static double limited(const double *p, double v)
{
    return fmin(fmax(v, p[0]), p[1]);
}

static double magnitude(const double *p, double v)
{
    (void)p;
    return fabs(v);
}

static double reciprocal(const double *p, double v)
{
    (void)p;
    return 1 / v;
}

static double reinhard(const double *p, double v)
{
    (void)p;
    return v / (1 + v);
}

static double logarithm(const double *p, double v)
{
    return log(v + p[1]) / log(p[0]);
}

/* p: the kind of number it was stored as, and whether what does not fit was cut off. */
static double stored(const double *p, double v)
{
    enum number_kind kind = (enum number_kind)(int)p[0];
    uint8_t place[4] = {0};
    uint32_t one = number_one(kind);
    if (one && p[1] > 0)
        return trunc(fmin(fmax(v, kind == NUMBER_SNORM16 ? -1 : 0), 1) * one) / one;
    their_store(kind, v, place);
    double nearest = number_value(kind, place);
    if (p[1] > 0 && fabs(nearest) > fabs(v) && !one) {
        uint32_t bits = number_bits(kind, place);
        nearest = bits & 0x7fff ? number_of_bits(kind, bits - 1) : nearest;
    }
    return nearest;
}

/* float32 without the last p[0] bits of its fraction; p[1]: cut off. */
static double shortened(const double *p, double v)
{
    float number = (float)v;
    uint32_t bits, unit = 1u << (int)p[0];
    memcpy(&bits, &number, sizeof bits);
    if (!(p[1] > 0))
        bits += unit / 2 - 1 + (bits / unit & 1);
    bits &= ~(unit - 1);
    memcpy(&number, &bits, sizeof bits);
    return (double)number;
}

static double rounded(const double *p, double v)
{
    return p[0] > 0 ? floor(v) : rint(v);
}

static double wrapped(const double *p, double v)
{
    return v - floor(v / p[0]) * p[0];
}

/* p[3]: the kind of number. */
static double other_bytes(const double *p, double v)
{
    enum number_kind kind = (enum number_kind)(int)p[3];
    uint8_t place[4] = {0}, turned[4] = {0};
    uint32_t size = number_size(kind);
    their_store(kind, v, place);
    for (uint32_t i = 0; i < size; i++)
        turned[i] = place[size - 1 - i];
    return number_value(kind, turned);
}

/* ---- Numbers that are found ----------------------------------------------------------------------- */

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *numbers, uint32_t count)
{
    qsort(numbers, count, sizeof *numbers, compare_numbers);
    return count ? numbers[count / 2] : 0;
}

/* Pairs of numbers of `from` and `to` that differ and are not at the ends of a code. Returns how many. */
static uint32_t take_pairs(const struct asked *asked, double *x, double *y)
{
    uint32_t count = 0, step = asked->differing_count / FIT_PAIRS + 1;
    for (uint32_t i = 0; i < asked->differing_count && count < FIT_PAIRS; i += step) {
        struct place place = place_of(asked, asked->differing[i], i / step % asked->count);
        double a = same_from(asked, place, place.component), b = to_number(asked, place);
        bool code = number_one(kind_of(asked));
        if (!isfinite(a) || !isfinite(b) || (code && (b <= 0 || b >= 1 || a <= 0 || a >= 1)))
            continue;
        x[count] = a;
        y[count++] = b;
    }
    return count;
}

/* The kind of whole bytes, more than one. */
static bool fit_kind(struct asked *asked)
{
    uint32_t size = number_size(kind_of(asked));
    asked->p[3] = kind_of(asked);
    return size > 1 && number_width(kind_of(asked)) == 8 * size;
}

/* The line through most pairs, by the median of slopes; p[2]: of the reciprocal of y. */
static bool fit_affine(struct asked *asked)
{
    double x[FIT_PAIRS], y[FIT_PAIRS], slopes[FIT_PAIRS], offsets[FIT_PAIRS];
    uint32_t count = take_pairs(asked, x, y), found = 0;
    for (uint32_t i = 0; i < count && asked->p[2] > 0; i++)
        y[i] = 1 / y[i];
    double least = INFINITY, most = -INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        least = fmin(least, x[i]);
        most = fmax(most, x[i]);
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = (i + count / 2) % count;
        if (fabs(x[i] - x[k]) > 0.05 * (most - least))
            slopes[found++] = (y[i] - y[k]) / (x[i] - x[k]);
    }
    if (count < 8 || found < 6)
        return false;
    asked->p[0] = median(slopes, found);
    for (uint32_t i = 0; i < count; i++)
        offsets[i] = y[i] - asked->p[0] * x[i];
    asked->p[1] = median(offsets, count);
    return isfinite(asked->p[0]) && isfinite(asked->p[1]) && fabs(asked->p[0]) > 1e-6;
}

static bool fit_factor(struct asked *asked)
{
    double x[FIT_PAIRS], y[FIT_PAIRS], ratios[FIT_PAIRS];
    uint32_t count = take_pairs(asked, x, y), found = 0;
    for (uint32_t i = 0; i < count; i++)
        if (fabs(x[i]) > 0.1 * asked->range)
            ratios[found++] = y[i] / x[i];
    asked->p[0] = median(ratios, found);
    asked->p[1] = 0;
    return found >= 4 && fabs(asked->p[0]) > 1e-9 && fabs(asked->p[0] - 1) > 1e-4;
}

static bool fit_offset(struct asked *asked)
{
    double x[FIT_PAIRS], y[FIT_PAIRS];
    uint32_t count = take_pairs(asked, x, y);
    for (uint32_t i = 0; i < count; i++)
        y[i] -= x[i];
    asked->p[0] = 1;
    asked->p[1] = median(y, count);
    return count >= 4 && asked->p[1] != 0;
}

/* ---- The table --------------------------------------------------------------------------------- */

#define MAP(label, function, condition, same, unsure, words, ...)                                  \
    {                                                                                              \
        .name = (label), .text = (words), .map = (function), .applies = (condition),               \
        .symmetric = (same), .doubt = (unsure), .p = {                                             \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }
#define MAP_FIT(label, function, fits, unsure, words, ...)                                         \
    {                                                                                              \
        .name = (label), .text = (words), .map = (function), .fit = (fits), .doubt = (unsure),     \
        .p = {                                                                                     \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }
#define STORED(label, words, kind, cut)                                                            \
    MAP(label, stored, has_reals, SIDED, 0.01, "if {from} is " words, kind, cut)

/* A row: its name, what it calls, where it applies (NULL: everywhere), whether it is the same from either copy, its
 * doubt, what it says, and p. */
static const struct fault rows[] = {
    MAP("srgb", to_srgb, has_reals, SIDED, 0,
        "if {to} is decoded from sRGB once: {from} has one encoding less", 0),
    MAP("gamma", power, has_reals, SIDED, 0.01, "if {to} is decoded from a gamma of 2.2", 1 / 2.2),
    MAP("square", power, has_reals, SIDED, 0.01, "if {from} is squared, as {to} is", 2),
    MAP("depth_range", affine, has_reals, SIDED, 0,
        "after z * 2 - 1 of {from} (0..1 against -1..1)", 2, -1),
    MAP("depth_reversed", affine, has_reals, SAME, 0, "after 1 - z (reversed depth, or inverted)",
        -1, 1),
    MAP("depth_reversed", affine, has_reals, SIDED, 0,
        "after 1 - 2 z of {from} (reversed, 0..1 against -1..1)", -2, 1),
    MAP("negated", affine, NULL, SAME, 0, "with the sign turned", -1, 0),
    MAP("byte_codes", affine, NULL, SIDED, 0, "if {to} has codes of 0..255 for 0..1", 255, 0),
    MAP("limited_range", affine, has_reals, SIDED, 0,
        "if {to} has the limited range of video (16..235)", 219. / 255, 16. / 255),
    MAP("clamped", limited, has_reals, SIDED, 0, "if {from} is clamped to 0..1, as {to} is", 0, 1),
    MAP("clamped", limited, NULL, SIDED, 0, "if what is negative in {from} is 0, as in {to}", 0,
        INFINITY),
    MAP("absolute", magnitude, NULL, SIDED, 0, "if {to} has magnitudes without the sign", 0),
    MAP("reciprocal", reciprocal, has_reals, SAME, 0, "after 1 / v", 0),
    MAP("tone", reinhard, has_reals, SIDED, 0, "if {to} has v / (1 + v) (tone mapped)", 0),
    MAP("logarithm", logarithm, has_reals, SIDED, 0, "if {to} has log2 of {from}", 2, 0),
    MAP("logarithm", logarithm, has_reals, SIDED, 0, "if {to} has ln of {from}", 2.718281828459045,
        0),
    MAP_FIT("depth_linear", inverse_affine, fit_affine, 0.02,
            "if {from} is hyperbolic depth and {to} linear: 1 / {to} is {0} {from} + {1}", 0, 0, 1),
    MAP_FIT("byte_order", other_bytes, fit_kind, 0,
            "with the bytes of each number in the other order", 0),
    MAP("integer", rounded, has_reals, SIDED, 0.01, "if {from} is rounded to whole numbers", 0),
    MAP("integer", rounded, has_reals, SIDED, 0.01, "if {from} is rounded down to whole numbers",
        1),
    MAP("wrapped", wrapped, NULL, SIDED, 0, "if {to} keeps 8 bits of {from}", 256),
    MAP("wrapped", wrapped, NULL, SIDED, 0, "if {to} keeps 16 bits of {from}", 65536),
    STORED("half", "rounded to half floats", NUMBER_HALF, 0),
    STORED("half", "cut to half floats", NUMBER_HALF, 1),
    STORED("unorm8", "rounded to 8-bit codes", NUMBER_UNORM8, 0),
    STORED("unorm8", "cut down to 8-bit codes, not rounded", NUMBER_UNORM8, 1),
    STORED("unorm10", "rounded to 10-bit codes", NUMBER_R10, 0),
    STORED("unorm10", "cut down to 10-bit codes", NUMBER_R10, 1),
    STORED("unorm16", "rounded to 16-bit codes", NUMBER_UNORM16, 0),
    STORED("unorm16", "cut down to 16-bit codes", NUMBER_UNORM16, 1),
    STORED("snorm16", "rounded to 16-bit signed codes", NUMBER_SNORM16, 0),
    STORED("float11", "rounded to floats of 11 bits (r11g11b10f)", NUMBER_R11F, 0),
    STORED("float11", "cut to floats of 11 bits (r11g11b10f)", NUMBER_R11F, 1),
    MAP("bfloat16", shortened, has_reals, SIDED, 0.01, "if {from} is rounded to bfloat16", 16),
    MAP("bfloat16", shortened, has_reals, SIDED, 0.01, "if {from} is cut to bfloat16", 16, 1),
    MAP("float19", shortened, has_reals, SIDED, 0.01,
        "if {from} is rounded to 10 bits of fraction (TF32)", 13),
    MAP_FIT("factor", affine, fit_factor, 0.02, "with a factor of {0} on {from}", 0),
    MAP_FIT("offset", affine, fit_offset, 0.02, "with {1} added to {from}", 0),
    MAP_FIT("affine", affine, fit_affine, 0.04, "with {0} v + {1} of {from}", 0),
};

const struct fault_list faults_map = {rows, DT_ARRAY_COUNT(rows)};
