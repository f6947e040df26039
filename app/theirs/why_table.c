/* The faults that `compare A B` tries; see why_fault.h. Of two that explain as much the first in the table
 * is named. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "theirs/theirs.h"
#include "theirs/why_fault.h"
#include "scenes/srgb.h"

enum { FIT_PAIRS = 512 };

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double median(double *numbers, uint32_t count)
{
    qsort(numbers, count, sizeof *numbers, compare_numbers);
    return count ? numbers[count / 2] : 0;
}

static double from_at(const struct asked *asked, struct place place, int64_t x, int64_t y,
                      int64_t z, uint32_t component)
{
    place.x = x;
    place.y = y;
    place.z = z;
    place.component = component;
    return copy_number(asked, asked->from, place);
}

static double same_from(const struct asked *asked, struct place place, uint32_t component)
{
    return from_at(asked, place, place.x, place.y, place.z, component);
}

static double to_number(const struct asked *asked, struct place place)
{
    return copy_number(asked, asked->to, place);
}

static enum number_kind kind_of(const struct asked *asked)
{
    return asked->components[0].kind;
}

static bool places_are_image(struct asked *asked, const struct fault *fault)
{
    return asked->image && asked->from->extent[1] > 1 && fault;
}

static bool has_colour(struct asked *asked, const struct fault *fault)
{
    return asked->count >= 3 && asked->count <= 4 && fault;
}

static bool has_channels(struct asked *asked, const struct fault *fault)
{
    return fault->p[0] < asked->count && asked->count > 1;
}

static bool has_alpha(struct asked *asked, const struct fault *fault)
{
    return asked->image && asked->count == 4 && fault;
}

static bool has_reals(struct asked *asked, const struct fault *fault)
{
    return !number_is_integer(kind_of(asked)) && fault;
}

/* ---- Rows and columns -------------------------------------------------------------------------- */

/* p: whether x and y run backwards. */
static double turned(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t w = asked->from->extent[0], h = asked->image ? asked->from->extent[1] : 1;
    return from_at(asked, place, fault->p[0] > 0 ? w - 1 - place.x : place.x,
                   fault->p[1] > 0 ? h - 1 - place.y : place.y, place.z, place.component);
}

static bool is_square(struct asked *asked, const struct fault *fault)
{
    return places_are_image(asked, fault) && asked->from->extent[0] == asked->from->extent[1];
}

/* x and y in each other's place; p: backwards. */
static double swapped(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t last = (int64_t)asked->from->extent[0] - 1;
    return from_at(asked, place, fault->p[0] > 0 ? last - place.y : place.y,
                   fault->p[1] > 0 ? last - place.x : place.x, place.z, place.component);
}

/* p: steps in x, y and z; x of a buffer is the element. */
static double shifted(const struct asked *asked, const struct fault *fault, struct place place)
{
    return from_at(asked, place, place.x + (int64_t)fault->p[0], place.y + (int64_t)fault->p[1],
                   place.z + (int64_t)fault->p[2], place.component);
}

/* Over the edge to the other side. p: steps; fit: the halves of the size. */
static double rolled(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t w = asked->from->extent[0], h = asked->from->extent[1];
    return from_at(asked, place, (place.x + (fault->p[0] > 0 ? w / 2 : 0)) % w,
                   (place.y + (fault->p[1] > 0 ? h / 2 : 0)) % h, place.z, place.component);
}

/* The mean of the texels between which half a texel lies. */
static double half_shifted(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t dx = (int64_t)fault->p[0], dy = (int64_t)fault->p[1];
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += from_at(asked, place, place.x + (i & 1 ? dx : 0), place.y + (i & 2 ? dy : 0),
                       place.z, place.component);
    return sum / 4;
}

/* A small filter around the texel: a box of 3, or a tent. */
static double blurred(const struct asked *asked, const struct fault *fault, struct place place)
{
    double sum = 0, weights = 0;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            double weight = fault->p[0] > 0 ? (2 - abs(dx)) * (2 - abs(dy)) : 1;
            sum += weight *
                   from_at(asked, place, place.x + dx, place.y + dy, place.z, place.component);
            weights += weight;
        }
    return sum / weights;
}

/* The mean, or with p[1] the first, of blocks of p[0] texels. */
static double coarse(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t block = (int64_t)fault->p[0], n = fault->p[1] > 0 ? 1 : block;
    int64_t x = place.x / block * block, y = place.y / block * block;
    double sum = 0;
    for (int64_t i = 0; i < n * n; i++)
        sum += from_at(asked, place, x + i % n, y + i / n, place.z, place.component);
    return sum / (double)(n * n);
}

/* ---- Layers, mips, frames ---------------------------------------------------------------------- */

static bool has_layers(struct asked *asked, const struct fault *fault)
{
    return asked->image && asked->from->extent[2] > 1 && fault;
}

static double layers_reversed(const struct asked *asked, const struct fault *fault,
                              struct place place)
{
    (void)fault;
    return from_at(asked, place, place.x, place.y, (int64_t)asked->from->extent[2] - 1 - place.z,
                   place.component);
}

/* Faces p[0] and p[0] + 1, or with 3 all pairs, in each other's place. */
static double faces_swapped(const struct asked *asked, const struct fault *fault,
                            struct place place)
{
    int64_t pair = (int64_t)fault->p[0], face = place.z;
    if (asked->from->extent[2] % 6)
        return NAN;
    if (pair == 3 || face % 6 / 2 == pair)
        face ^= 1;
    return from_at(asked, place, place.x, place.y, face, place.component);
}

static const struct copy *relative_of(const struct asked *asked, const struct fault *fault)
{
    return &asked->relatives[asked->side][(int)fault->p[0]];
}

static bool has_relative(struct asked *asked, const struct fault *fault)
{
    return relative_of(asked, fault)->data;
}

/* Frames have one size; of a mip the texel that lies there. */
static double of_relative(const struct asked *asked, const struct fault *fault, struct place place)
{
    const struct copy *copy = relative_of(asked, fault);
    if (asked->image) {
        place.x = place.x * copy->extent[0] / asked->to->extent[0];
        place.y = place.y * copy->extent[1] / asked->to->extent[1];
    }
    return copy_number(asked, copy, place);
}

/* ---- Pitch and layout -------------------------------------------------------------------------- */

static double linear_from(const struct asked *asked, struct place place, int64_t number)
{
    int64_t row = (int64_t)asked->from->extent[0] * asked->count, height = asked->from->extent[1];
    if (number < 0 || number >= row * height)
        return NAN;
    return from_at(asked, place, number % row / asked->count, number / row, place.z,
                   (uint32_t)(number % asked->count));
}

/* Numbers of a row that is `pitch` numbers long, read as if there was no padding; backwards with p[0]: rows
 * `pitch` apart where there is none. */
static double pitched(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t row = (int64_t)asked->from->extent[0] * asked->count, pitch = (int64_t)asked->fit[3];
    int64_t at = place.x * asked->count + place.component;
    if (fault->p[0] > 0)
        return linear_from(asked, place, place.y * pitch + at);
    int64_t number = place.y * row + at;
    return number % pitch < row ? linear_from(asked, place, number / pitch * row + number % pitch)
                                : NAN;
}

static bool pitch_fits(const struct asked *asked, const struct fault *fault)
{
    enum { TRIED = 64 };
    uint32_t known = 0, wrong = 0, step = asked->differing_count / TRIED + 1;
    for (uint32_t i = 0; i < asked->differing_count; i += step) {
        struct place place = place_of(asked, asked->differing[i], i / step % asked->count);
        double want = pitched(asked, fault, place), got = to_number(asked, place);
        if (isnan(want))
            continue;
        known++;
        wrong += !(fabs(want - got) <= 0.02 * asked->range);
        if (wrong > 8 + known / 4)
            return false;
    }
    return known >= 12 && wrong * 8 < known;
}

static bool fit_pitch(struct asked *asked, const struct fault *fault)
{
    if (!places_are_image(asked, fault) || asked->differing_count < 24)
        return false;
    int64_t row = (int64_t)asked->from->extent[0] * asked->count;
    for (int64_t pitch = fault->p[0] > 0 ? row / 2 : row + 1; pitch <= 2 * row + 256; pitch++) {
        asked->fit[3] = (double)pitch;
        if (pitch == row || !pitch_fits(asked, fault))
            continue;
        asked->fit[0] = (double)pitch / asked->count;
        asked->fit[1] = asked->from->extent[0];
        return true;
    }
    return false;
}

static double word_from(const struct asked *asked, struct place place, int64_t byte)
{
    enum number_kind kind = asked->components[place.component].kind;
    if (byte < 0 || (uint64_t)byte + number_size(kind) > asked->from->size)
        return NAN;
    return number_value(kind, asked->from->data + byte);
}

static int64_t byte_of(const struct asked *asked, struct place place)
{
    return (int64_t)(place.element * asked->stride + asked->components[place.component].offset);
}

/* `to` has p[0] bytes for each thing that has p[1] in `from`. */
static double repacked(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t to = (int64_t)fault->p[0], from = (int64_t)fault->p[1], byte = byte_of(asked, place);
    if (byte % to >= from)
        return NAN;
    return word_from(asked, place, byte / to * from + byte % to);
}

static double restrided(const struct asked *asked, const struct fault *fault, struct place place)
{
    (void)fault;
    return word_from(asked, place,
                     (int64_t)place.element * (int64_t)asked->fit[0] +
                         asked->components[place.component].offset);
}

static double moved_words(const struct asked *asked, const struct fault *fault, struct place place)
{
    return word_from(asked, place, byte_of(asked, place) + (int64_t)fault->p[0]);
}

static bool is_buffer(struct asked *asked, const struct fault *fault)
{
    return !asked->image && fault;
}

/* Elements of another size; fit[1] is the size that they should have. */
static bool fit_stride(struct asked *asked, const struct fault *fault)
{
    uint32_t step = asked->differing_count / 64 + 1;
    for (uint32_t stride = 4; !asked->image && stride <= 4 * asked->stride; stride += 4) {
        uint32_t known = 0, right = 0;
        asked->fit[0] = stride;
        asked->fit[1] = asked->stride;
        for (uint32_t i = 0; i < asked->differing_count; i += step) {
            struct place place = place_of(asked, asked->differing[i], i % asked->count);
            double want = restrided(asked, fault, place);
            known += !isnan(want);
            right += want == to_number(asked, place);
        }
        if (stride != asked->stride && known >= 6 && right * 10 > known * 9)
            return true;
    }
    return false;
}

static double transposed(const struct asked *asked, const struct fault *fault, struct place place)
{
    (void)fault;
    if (asked->image) /* a row of texels for each matrix */
        return from_at(asked, place, place.component, place.y, place.z, (uint32_t)place.x);
    return same_from(asked, place, asked->transposed[place.component]);
}

static bool has_matrices(struct asked *asked, const struct fault *fault)
{
    if (asked->image)
        return asked->count > 2 && asked->from->extent[0] == asked->count;
    for (uint32_t c = 0; c < asked->count; c++)
        if (asked->transposed[c] != c)
            return fault;
    return false;
}

static bool has_matrix4(struct asked *asked, const struct fault *fault)
{
    return !asked->image && has_matrices(asked, fault) && asked->count % 16 == 0;
}

/* p: the step between the rows of a column, 1, or 4 if the matrix is by rows; the row; 1: negated, else
 * its z is 0..1 against -1..1. */
static double matrix_row(const struct asked *asked, const struct fault *fault, struct place place)
{
    uint32_t step = (uint32_t)fault->p[0], c = place.component, row = c % 16 / step % 4;
    double value = same_from(asked, place, c);
    if (row != (uint32_t)fault->p[1])
        return value;
    return fault->p[2] > 0 ? -value : (value + same_from(asked, place, c + step)) / 2;
}

/* ---- Channels ---------------------------------------------------------------------------------- */

/* p: the channel of `from` that each of `to` has; 4: zero, 5: one. */
static double permuted(const struct asked *asked, const struct fault *fault, struct place place)
{
    int channel = place.component < FAULT_NUMBERS ? (int)fault->p[place.component] : 0;
    if (channel > 3)
        return channel - 4;
    return (uint32_t)channel < asked->count ? same_from(asked, place, (uint32_t)channel)
           : channel == 3                   ? 1
                                            : NAN;
}

static bool has_two(struct asked *asked, const struct fault *fault)
{
    return asked->count == 2 && fault;
}

/* The first channel, or the luminance, in all. */
static double grey(const struct asked *asked, const struct fault *fault, struct place place)
{
    double r = same_from(asked, place, 0), g = same_from(asked, place, 1);
    double b = same_from(asked, place, 2);
    if (place.component == 3)
        return NAN;
    return fault->p[0] > 0 ? 0.2126 * r + 0.7152 * g + 0.0722 * b : r;
}

static double premultiplied(const struct asked *asked, const struct fault *fault,
                            struct place place)
{
    double alpha = same_from(asked, place, 3), value = same_from(asked, place, place.component);
    (void)fault;
    return place.component == 3 ? value : value * alpha;
}

static double alpha_inverted(const struct asked *asked, const struct fault *fault,
                             struct place place)
{
    double value = same_from(asked, place, place.component);
    (void)fault;
    return place.component == 3 ? 1 - value : value;
}

/* One channel, p[0], that is 1 - v, with p[1] -v. */
static double channel_inverted(const struct asked *asked, const struct fault *fault,
                               struct place place)
{
    double value = same_from(asked, place, place.component);
    if (place.component != (uint32_t)fault->p[0])
        return value;
    return fault->p[1] > 0 ? -value : 1 - value;
}

/* ---- Numbers ----------------------------------------------------------------------------------- */

static double to_srgb(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked, (void)fault;
    return srgb_code(v);
}

static double power(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked;
    return pow(fmax(v, 0), fault->p[0]);
}

/* p: factor and offset; or what was fitted. */
static double affine(const struct asked *asked, const struct fault *fault, double v)
{
    (void)fault;
    return asked->fit[0] * v + asked->fit[1];
}

static double fixed_affine(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked;
    return fault->p[0] * v + fault->p[1];
}

static double inverse_affine(const struct asked *asked, const struct fault *fault, double v)
{
    (void)fault;
    return 1 / (asked->fit[0] * v + asked->fit[1]);
}

static double limited(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked;
    return fmin(fmax(v, fault->p[0]), fault->p[1]);
}

static double magnitude(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked, (void)fault;
    return fabs(v);
}

static double reciprocal(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked, (void)fault;
    return 1 / v;
}

static double reinhard(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked, (void)fault;
    return v / (1 + v);
}

static double logarithm(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked;
    return log(v + fault->p[1]) / log(fault->p[0]);
}

/* p: the kind of number it was stored as, and whether what does not fit was cut off. */
static double stored(const struct asked *asked, const struct fault *fault, double v)
{
    enum number_kind kind = (enum number_kind)(int)fault->p[0];
    uint8_t place[4] = {0};
    uint32_t one = number_one(kind);
    (void)asked;
    if (one && fault->p[1] > 0)
        return trunc(fmin(fmax(v, kind == NUMBER_SNORM16 ? -1 : 0), 1) * one) / one;
    their_store(kind, v, place);
    double nearest = number_value(kind, place);
    if (fault->p[1] > 0 && fabs(nearest) > fabs(v) && !one) {
        uint32_t bits = number_bits(kind, place);
        nearest = bits & 0x7fff ? number_of_bits(kind, bits - 1) : nearest;
    }
    return nearest;
}

/* float32 without the last p[0] bits of its fraction; p[1]: cut off. */
static double shortened(const struct asked *asked, const struct fault *fault, double v)
{
    float number = (float)v;
    uint32_t bits, unit = 1u << (int)fault->p[0];
    (void)asked;
    memcpy(&bits, &number, sizeof bits);
    if (!(fault->p[1] > 0))
        bits += unit / 2 - 1 + (bits / unit & 1);
    bits &= ~(unit - 1);
    memcpy(&number, &bits, sizeof bits);
    return (double)number;
}

static double rounded(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked;
    return fault->p[0] > 0 ? floor(v) : rint(v);
}

static double wrapped(const struct asked *asked, const struct fault *fault, double v)
{
    (void)asked;
    return v - floor(v / fault->p[0]) * fault->p[0];
}

static bool has_words(struct asked *asked, const struct fault *fault)
{
    uint32_t size = number_size(kind_of(asked));
    return size > 1 && number_width(kind_of(asked)) == 8 * size && fault;
}

static double other_bytes(const struct asked *asked, const struct fault *fault, double v)
{
    enum number_kind kind = kind_of(asked);
    uint8_t place[4] = {0}, turned_bytes[4] = {0};
    uint32_t size = number_size(kind);
    (void)fault;
    their_store(kind, v, place);
    for (uint32_t i = 0; i < size; i++)
        turned_bytes[i] = place[size - 1 - i];
    return number_value(kind, turned_bytes);
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

/* The line through most pairs, by the median of slopes; p[2]: of the reciprocal of y. */
static bool fit_affine(struct asked *asked, const struct fault *fault)
{
    double x[FIT_PAIRS], y[FIT_PAIRS], slopes[FIT_PAIRS], offsets[FIT_PAIRS];
    uint32_t count = take_pairs(asked, x, y), found = 0;
    for (uint32_t i = 0; i < count && fault->p[2] > 0; i++)
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
    asked->fit[0] = median(slopes, found);
    for (uint32_t i = 0; i < count; i++)
        offsets[i] = y[i] - asked->fit[0] * x[i];
    asked->fit[1] = median(offsets, count);
    return isfinite(asked->fit[0]) && isfinite(asked->fit[1]) && fabs(asked->fit[0]) > 1e-6;
}

static bool fit_factor(struct asked *asked, const struct fault *fault)
{
    double x[FIT_PAIRS], y[FIT_PAIRS], ratios[FIT_PAIRS];
    uint32_t count = take_pairs(asked, x, y), found = 0;
    for (uint32_t i = 0; i < count; i++)
        if (fabs(x[i]) > 0.1 * asked->range)
            ratios[found++] = y[i] / x[i];
    asked->fit[0] = median(ratios, found);
    asked->fit[1] = 0;
    return fault && found >= 4 && fabs(asked->fit[0]) > 1e-9;
}

static bool fit_offset(struct asked *asked, const struct fault *fault)
{
    double x[FIT_PAIRS], y[FIT_PAIRS];
    uint32_t count = take_pairs(asked, x, y);
    for (uint32_t i = 0; i < count; i++)
        y[i] -= x[i];
    asked->fit[0] = 1;
    asked->fit[1] = median(y, count);
    return fault && count >= 4 && asked->fit[1] != 0;
}

/* ---- Places ------------------------------------------------------------------------------------ */

/* p: rows from the left, the bottom, the right, the top. */
static bool at_border(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t w = asked->to->extent[0], h = asked->image ? asked->to->extent[1] : 1;
    return place.x < (int64_t)fault->p[0] || place.y < (int64_t)fault->p[1] ||
           place.x >= w - (int64_t)fault->p[2] || place.y >= h - (int64_t)fault->p[3];
}

/* Behind the last whole tile of p[0]; p[1]: of a buffer. */
static bool behind_tiles(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t tile = (int64_t)fault->p[0], w = asked->to->extent[0];
    int64_t h = asked->image ? asked->to->extent[1] : 1;
    if (asked->image && h > 1)
        return place.x >= w / tile * tile || place.y >= h / tile * tile;
    return place.x >= w / tile * tile;
}

/* At the first or last column or row of a tile of p[0]. */
static bool at_tile_edge(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t tile = (int64_t)fault->p[0], x = place.x % tile, y = place.y % tile;
    bool rows = asked->image && asked->to->extent[1] > 1;
    return x == 0 || x == tile - 1 || (rows && (y == 0 || y == tile - 1));
}

static bool in_layer(const struct asked *asked, const struct fault *fault, struct place place)
{
    int64_t last = (int64_t)asked->to->extent[2] - 1;
    return asked->image && last > 0 && place.z == (fault->p[0] > 0 ? last : 0);
}

static double numbers_differ(const struct asked *asked, struct place place, uint32_t component)
{
    place.component = component;
    double a = same_from(asked, place, component), b = to_number(asked, place);
    return a == b ? 0 : fabs(a - b);
}

/* Where `from` changes steeply from texel to texel. */
static bool at_edge(const struct asked *asked, const struct fault *fault, struct place place)
{
    (void)fault;
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
static double not_nan(const struct asked *asked, const struct fault *fault)
{
    uint32_t others = 0;
    (void)fault;
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
static double no_pattern(const struct asked *asked, const struct fault *fault)
{
    uint32_t others = 0;
    (void)fault;
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
static double was_cleared(const struct asked *asked, const struct fault *fault)
{
    uint64_t most = 0, other = 0;
    (void)fault;
    if (asked->differing_count < 8)
        return 9;
    double left = unlike(asked, asked->from, asked->differing, asked->differing_count, &most);
    double varied = unlike(asked, asked->to, asked->differing, asked->differing_count, &other);
    return varied > 0.2 ? left : 9;
}

/* What is background in one copy is covered in the other. */
static double not_inverted(const struct asked *asked, const struct fault *fault)
{
    uint64_t most = 0;
    uint32_t both = 0, covered = 0;
    (void)fault;
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
static double other_channels(const struct asked *asked, const struct fault *fault)
{
    uint32_t others = 0;
    if (asked->count < 2 || asked->differing_count < 4 || fault->p[0] >= asked->count)
        return 9;
    for (uint32_t i = 0; i < asked->differing_count; i++)
        for (uint32_t c = 0; c < asked->count; c++)
            if (c != (uint32_t)fault->p[0] &&
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
static double other_order(const struct asked *asked, const struct fault *fault)
{
    uint64_t count = asked->to->extent[0], missing = 0;
    (void)fault;
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
static double other_than_tiles(const struct asked *asked, const struct fault *fault)
{
    int64_t tile = (int64_t)fault->p[0], w = asked->to->extent[0], h = asked->to->extent[1];
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

/* NOLINTBEGIN(bugprone-macro-parentheses): parts of strings and of initializers */
#define SHIFT(label, words, x, y)                                                                  \
    {                                                                                              \
        .name = label, .text = "after a shift of " words, .at = shifted, .p = { x, y }             \
    }
#define HALF(label, words, x, y)                                                                   \
    {                                                                                              \
        .name = label, .text = "after half a texel in " words ": centres are at .5",               \
        .at = half_shifted, .applies = places_are_image, .p = {                                    \
            x,                                                                                     \
            y                                                                                      \
        }                                                                                          \
    }
#define CHANNELS(label, words, r, g, b, a)                                                         \
    {                                                                                              \
        .name = label, .text = words, .at = permuted, .applies = has_colour, .p = {r, g, b, a},    \
        .channels = true                                                                           \
    }
#define STORED(label, words, kind, cut)                                                            \
    {                                                                                              \
        .name = label, .text = "if {from} is " words, .map = stored, .applies = has_reals,         \
        .p = {kind, cut}, .doubt = 0.01                                                            \
    }
#define REPACKED(into, outof, what)                                                                \
    {                                                                                              \
        .name = "layout",                                                                          \
        .text = "with " what " (std140, std430 or packed): {0} bytes each in {to}, {1} in {from}", \
        .at = repacked, .applies = is_buffer, .p = {                                               \
            into,                                                                                  \
            outof                                                                                  \
        }                                                                                          \
    }

/* NOLINTEND(bugprone-macro-parentheses) */

const struct fault faults[] = {
    {.name = "flip_y",
     .text = "after a flip in y: OpenGL's row 0 is the bottom",
     .at = turned,
     .applies = places_are_image,
     .p = {0, 1},
     .symmetric = true},
    {.name = "mirror_x",
     .text = "after a mirror in x",
     .at = turned,
     .applies = places_are_image,
     .p = {1, 0},
     .symmetric = true},
    {.name = "turn",
     .text = "after half a turn: x and y run backwards",
     .at = turned,
     .applies = places_are_image,
     .p = {1, 1},
     .symmetric = true},
    {.name = "reversed",
     .text = "with the elements in reverse order",
     .at = turned,
     .applies = is_buffer,
     .p = {1, 0},
     .symmetric = true},
    {.name = "axes",
     .text = "with x and y in each other's place",
     .at = swapped,
     .applies = is_square,
     .symmetric = true},
    {.name = "quarter_turn",
     .text = "after a quarter turn of {from}",
     .at = swapped,
     .applies = is_square,
     .p = {1, 0}},
    {.name = "frame",
     .text = "one frame late: {to} has the frame before of {from}",
     .at = of_relative,
     .applies = has_relative,
     .p = {WHY_FRAME_BEFORE}},
    {.name = "frame",
     .text = "one frame early: {to} has the frame after of {from}",
     .at = of_relative,
     .applies = has_relative,
     .p = {WHY_FRAME_AFTER}},
    {.name = "layer",
     .text = "one layer off: {to} has the layer after of {from}",
     .at = shifted,
     .applies = has_layers,
     .p = {0, 0, 1}},
    {.name = "layers_reversed",
     .text = "with the layers in reverse order",
     .at = layers_reversed,
     .applies = has_layers,
     .symmetric = true},
    {.name = "faces",
     .text = "with the faces +x and -x swapped",
     .at = faces_swapped,
     .applies = has_layers,
     .p = {0},
     .symmetric = true},
    {.name = "faces",
     .text = "with the faces +y and -y swapped",
     .at = faces_swapped,
     .applies = has_layers,
     .p = {1},
     .symmetric = true},
    {.name = "faces",
     .text = "with the faces +z and -z swapped",
     .at = faces_swapped,
     .applies = has_layers,
     .p = {2},
     .symmetric = true},
    {.name = "faces",
     .text = "with opposite faces of the cube swapped",
     .at = faces_swapped,
     .applies = has_layers,
     .p = {3},
     .symmetric = true},
    {.name = "mip",
     .text = "one mip off: {to} has the finer mip of {from}",
     .at = of_relative,
     .applies = has_relative,
     .p = {WHY_MIP_FINER}},
    {.name = "mip",
     .text = "one mip off: {to} has the coarser mip of {from}",
     .at = of_relative,
     .applies = has_relative,
     .p = {WHY_MIP_COARSER}},
    SHIFT("shift_x", "one texel (or element) in x", 1, 0),
    SHIFT("shift_y", "one texel in y", 0, 1),
    SHIFT("shift_xy", "one texel in x and y", 1, 1),
    SHIFT("shift_xy", "one texel in x and back in y", 1, -1),
    SHIFT("shift_2x", "two texels (or elements) in x", 2, 0),
    SHIFT("shift_2y", "two texels in y", 0, 2),
    {.name = "roll",
     .text = "after half the width, round the edge",
     .at = rolled,
     .applies = places_are_image,
     .p = {1, 0}},
    {.name = "roll",
     .text = "after half the height, round the edge",
     .at = rolled,
     .applies = places_are_image,
     .p = {0, 1}},
    {.name = "roll",
     .text = "after half the width and height, round the edge",
     .at = rolled,
     .applies = places_are_image,
     .p = {1, 1}},
    HALF("half_texel_x", "x", 1, 0),
    HALF("half_texel_x", "x", -1, 0),
    HALF("half_texel_y", "y", 0, 1),
    HALF("half_texel_y", "y", 0, -1),
    HALF("half_texel_xy", "x and y", 1, 1),
    HALF("half_texel_xy", "x and y", -1, -1),
    HALF("half_texel_xy", "x and y", 1, -1),
    HALF("half_texel_xy", "x and y", -1, 1),
    {.name = "pitch",
     .text =
         "if rows of a pitch of {0} texels were read as {1}: {to} has the padding of rows in it",
     .at = pitched,
     .fit = fit_pitch},
    {.name = "pitch",
     .text = "if rows of {1} texels were read at a pitch of {0}, in {to}",
     .at = pitched,
     .fit = fit_pitch,
     .p = {1}},
    CHANNELS("red_blue", "with red and blue swapped (RGBA against BGRA)", 2, 1, 0, 3),
    CHANNELS("channels", "with red and green swapped", 1, 0, 2, 3),
    CHANNELS("channels", "with green and blue swapped", 0, 2, 1, 3),
    CHANNELS("channels", "with the channels in the order g, b, r", 1, 2, 0, 3),
    CHANNELS("channels", "with the channels in the order a, r, g, b", 3, 0, 1, 2),
    CHANNELS("channels", "with the channels in the order a, b, g, r", 3, 2, 1, 0),
    {.name = "channels",
     .text = "with both channels swapped",
     .at = permuted,
     .applies = has_two,
     .p = {1, 0},
     .symmetric = true},
    {.name = "grey",
     .text = "if {to} has the first channel of {from} in all",
     .at = grey,
     .applies = has_colour},
    {.name = "grey",
     .text = "if {to} has the luminance of {from} in all channels",
     .at = grey,
     .applies = has_colour,
     .p = {1}},
    {.name = "alpha_lost",
     .text = "if alpha is 1 in {to}",
     .at = permuted,
     .applies = has_alpha,
     .p = {0, 1, 2, 5}},
    {.name = "alpha_lost",
     .text = "if alpha is 0 in {to}",
     .at = permuted,
     .applies = has_alpha,
     .p = {0, 1, 2, 4}},
    CHANNELS("channel_lost", "if blue is 0 in {to}", 0, 1, 4, 3),
    CHANNELS("channel_lost", "if green and blue are 0 in {to}", 0, 4, 4, 3),
    {.name = "premultiplied",
     .text = "if {from} is multiplied by alpha, as {to} is",
     .at = premultiplied,
     .applies = has_alpha},
    {.name = "alpha_inverted",
     .text = "with alpha inverted",
     .at = alpha_inverted,
     .applies = has_alpha,
     .symmetric = true},
    {.name = "channel_inverted",
     .text = "with green as 1 - g (normal maps)",
     .at = channel_inverted,
     .applies = has_colour,
     .p = {1},
     .symmetric = true},
    {.name = "channel_inverted",
     .text = "with red as 1 - r",
     .at = channel_inverted,
     .applies = has_colour,
     .p = {0},
     .symmetric = true},
    {.name = "channel_negated",
     .text = "with x (red) negated",
     .at = channel_inverted,
     .applies = has_channels,
     .p = {0, 1},
     .symmetric = true},
    {.name = "channel_negated",
     .text = "with y (green) negated",
     .at = channel_inverted,
     .applies = has_channels,
     .p = {1, 1},
     .symmetric = true},
    {.name = "channel_negated",
     .text = "with z (blue) negated: the other handedness",
     .at = channel_inverted,
     .applies = has_channels,
     .p = {2, 1},
     .symmetric = true},
    {.name = "transposed",
     .text = "after each matrix is transposed (rows against columns)",
     .at = transposed,
     .applies = has_matrices,
     .symmetric = true},
    {.name = "matrix_y",
     .text = "with the y row of each matrix negated (Vulkan's y points down)",
     .at = matrix_row,
     .applies = has_matrix4,
     .p = {1, 1, 1},
     .symmetric = true},
    {.name = "matrix_y",
     .text = "with the y row of each matrix negated (by rows)",
     .at = matrix_row,
     .applies = has_matrix4,
     .p = {4, 1, 1},
     .symmetric = true},
    {.name = "matrix_z",
     .text = "if the z row of each matrix of {from} goes from -1..1 to 0..1",
     .at = matrix_row,
     .applies = has_matrix4,
     .p = {1, 2, 0}},
    {.name = "matrix_z",
     .text = "if the z row of each matrix (by rows) of {from} goes from -1..1 to 0..1",
     .at = matrix_row,
     .applies = has_matrix4,
     .p = {4, 2, 0}},
    REPACKED(12, 16, "vec3 of 12 against 16 bytes"),
    REPACKED(4, 16, "numbers of 4 against 16 bytes"),
    REPACKED(8, 16, "vec2 of 8 against 16 bytes"),
    REPACKED(16, 12, "vec3 of 16 against 12 bytes"),
    REPACKED(16, 4, "numbers of 16 against 4 bytes"),
    REPACKED(16, 8, "vec2 of 16 against 8 bytes"),
    {.name = "stride",
     .text = "with elements of {0} bytes against {1} (std140, std430 or packed)",
     .at = restrided,
     .fit = fit_stride},
    {.name = "moved",
     .text = "if all lies one number (4 bytes) later",
     .at = moved_words,
     .applies = is_buffer,
     .p = {4}},
    {.name = "moved",
     .text = "if all lies 16 bytes later",
     .at = moved_words,
     .applies = is_buffer,
     .p = {16}},
    {.name = "srgb",
     .text = "if {to} is decoded from sRGB once: {from} has one encoding less",
     .map = to_srgb,
     .applies = has_reals},
    {.name = "gamma",
     .text = "if {to} is decoded from a gamma of 2.2",
     .map = power,
     .applies = has_reals,
     .p = {1 / 2.2},
     .doubt = 0.01},
    {.name = "square",
     .text = "if {from} is squared, as {to} is",
     .map = power,
     .applies = has_reals,
     .p = {2},
     .doubt = 0.01},
    {.name = "depth_range",
     .text = "after z * 2 - 1 of {from} (0..1 against -1..1)",
     .map = fixed_affine,
     .applies = has_reals,
     .p = {2, -1}},
    {.name = "depth_reversed",
     .text = "after 1 - z (reversed depth, or inverted)",
     .map = fixed_affine,
     .applies = has_reals,
     .p = {-1, 1},
     .symmetric = true},
    {.name = "depth_reversed",
     .text = "after 1 - 2 z of {from} (reversed, 0..1 against -1..1)",
     .map = fixed_affine,
     .applies = has_reals,
     .p = {-2, 1}},
    {.name = "negated",
     .text = "with the sign turned",
     .map = fixed_affine,
     .p = {-1, 0},
     .symmetric = true},
    {.name = "byte_codes",
     .text = "if {to} has codes of 0..255 for 0..1",
     .map = fixed_affine,
     .p = {255, 0}},
    {.name = "limited_range",
     .text = "if {to} has the limited range of video (16..235)",
     .map = fixed_affine,
     .applies = has_reals,
     .p = {219. / 255, 16. / 255}},
    {.name = "clamped",
     .text = "if {from} is clamped to 0..1, as {to} is",
     .map = limited,
     .applies = has_reals,
     .p = {0, 1}},
    {.name = "clamped",
     .text = "if what is negative in {from} is 0, as in {to}",
     .map = limited,
     .p = {0, INFINITY}},
    {.name = "absolute", .text = "if {to} has magnitudes without the sign", .map = magnitude},
    {.name = "reciprocal",
     .text = "after 1 / v",
     .map = reciprocal,
     .applies = has_reals,
     .symmetric = true},
    {.name = "tone",
     .text = "if {to} has v / (1 + v) (tone mapped)",
     .map = reinhard,
     .applies = has_reals},
    {.name = "logarithm",
     .text = "if {to} has log2 of {from}",
     .map = logarithm,
     .applies = has_reals,
     .p = {2, 0}},
    {.name = "logarithm",
     .text = "if {to} has ln of {from}",
     .map = logarithm,
     .applies = has_reals,
     .p = {2.718281828459045, 0}},
    {.name = "depth_linear",
     .text = "if {from} is hyperbolic depth and {to} linear: 1 / {to} is {0} {from} + {1}",
     .map = inverse_affine,
     .fit = fit_affine,
     .p = {0, 0, 1},
     .doubt = 0.02},
    {.name = "byte_order",
     .text = "with the bytes of each number in the other order",
     .map = other_bytes,
     .applies = has_words,
     .symmetric = true},
    {.name = "integer",
     .text = "if {from} is rounded to whole numbers",
     .map = rounded,
     .applies = has_reals,
     .doubt = 0.01},
    {.name = "integer",
     .text = "if {from} is rounded down to whole numbers",
     .map = rounded,
     .applies = has_reals,
     .p = {1},
     .doubt = 0.01},
    {.name = "wrapped", .text = "if {to} keeps 8 bits of {from}", .map = wrapped, .p = {256}},
    {.name = "wrapped", .text = "if {to} keeps 16 bits of {from}", .map = wrapped, .p = {65536}},
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
    {.name = "bfloat16",
     .text = "if {from} is rounded to bfloat16",
     .map = shortened,
     .applies = has_reals,
     .p = {16},
     .doubt = 0.01},
    {.name = "bfloat16",
     .text = "if {from} is cut to bfloat16",
     .map = shortened,
     .applies = has_reals,
     .p = {16, 1},
     .doubt = 0.01},
    {.name = "float19",
     .text = "if {from} is rounded to 10 bits of fraction (TF32)",
     .map = shortened,
     .applies = has_reals,
     .p = {13},
     .doubt = 0.01},
    {.name = "half_rate",
     .text = "if {to} has means of 2x2 texels: half the resolution",
     .at = coarse,
     .applies = places_are_image,
     .p = {2},
     .doubt = 0.02},
    {.name = "half_rate",
     .text = "if {to} has each second texel twice: nearest, half the resolution",
     .at = coarse,
     .applies = places_are_image,
     .p = {2, 1},
     .doubt = 0.02},
    {.name = "half_rate",
     .text = "if {to} has means of 4x4 texels",
     .at = coarse,
     .applies = places_are_image,
     .p = {4},
     .doubt = 0.02},
    {.name = "blurred",
     .text = "if {from} is filtered by 3x3 texels, as {to} is",
     .at = blurred,
     .applies = places_are_image,
     .doubt = 0.03},
    {.name = "blurred",
     .text = "if {from} is filtered by a 3x3 tent, as {to} is",
     .at = blurred,
     .applies = places_are_image,
     .p = {1},
     .doubt = 0.03},
    {.name = "factor",
     .text = "with a factor of {0} on {from}",
     .map = affine,
     .fit = fit_factor,
     .doubt = 0.02},
    {.name = "offset",
     .text = "with {1} added to {from}",
     .map = affine,
     .fit = fit_offset,
     .doubt = 0.02},
    {.name = "affine",
     .text = "with {0} v + {1} of {from}",
     .map = affine,
     .fit = fit_affine,
     .doubt = 0.04},
    {.name = "order",
     .text = "in the order of elements alone: the same are in both",
     .share = other_order,
     .doubt = 0.06,
     .symmetric = true},
    {.name = "nan", .text = "where {to} is NaN or infinite", .share = not_nan},
    {.name = "uninitialised",
     .text = "where {to} has the pattern of memory that nothing has written",
     .share = no_pattern},
    {.name = "coverage",
     .text = "by coverage: what is background in one is drawn in the other (winding, "
             "culling or depth test)",
     .share = not_inverted,
     .doubt = 0.01},
    {.name = "border",
     .text = "in the last row alone",
     .where = at_border,
     .p = {0, 0, 0, 1},
     .symmetric = true},
    {.name = "border",
     .text = "in the first row alone",
     .where = at_border,
     .p = {0, 1},
     .symmetric = true},
    {.name = "border",
     .text = "in the last column (or element) alone",
     .where = at_border,
     .p = {0, 0, 1, 0},
     .symmetric = true},
    {.name = "border",
     .text = "in the first column (or element) alone",
     .where = at_border,
     .p = {1},
     .symmetric = true},
    {.name = "border",
     .text = "in the last row and column alone: an odd size is rounded down",
     .where = at_border,
     .p = {0, 0, 1, 1},
     .symmetric = true},
    {.name = "border",
     .text = "at the border alone: clamp, wrap or border colour",
     .where = at_border,
     .p = {1, 1, 1, 1},
     .symmetric = true},
    {.name = "border",
     .text = "in the two texels at the border: clamp, wrap or border colour",
     .where = at_border,
     .p = {2, 2, 2, 2},
     .symmetric = true},
    {.name = "rest",
     .text = "behind the last whole tile of 8: the dispatch is too small",
     .where = behind_tiles,
     .p = {8},
     .symmetric = true},
    {.name = "rest",
     .text = "behind the last whole tile of 16: the dispatch is too small",
     .where = behind_tiles,
     .p = {16},
     .symmetric = true},
    {.name = "rest",
     .text = "behind the last whole tile of 32: the dispatch is too small",
     .where = behind_tiles,
     .p = {32},
     .symmetric = true},
    {.name = "rest",
     .text = "behind the last whole group of 64: the dispatch is too small",
     .where = behind_tiles,
     .p = {64},
     .symmetric = true},
    {.name = "tile_edges",
     .text = "at the edges of tiles of 64 alone",
     .where = at_tile_edge,
     .p = {64},
     .symmetric = true},
    {.name = "tile_edges",
     .text = "at the edges of tiles of 32 alone",
     .where = at_tile_edge,
     .p = {32},
     .symmetric = true},
    {.name = "tile_edges",
     .text = "at the edges of tiles of 16 alone",
     .where = at_tile_edge,
     .p = {16},
     .symmetric = true},
    {.name = "tile_edges",
     .text = "at the edges of tiles of 8 alone",
     .where = at_tile_edge,
     .p = {8},
     .symmetric = true},
    {.name = "tiles",
     .text = "in whole tiles of 32x32",
     .share = other_than_tiles,
     .p = {32},
     .symmetric = true,
     .doubt = 0.16},
    {.name = "tiles",
     .text = "in whole tiles of 16x16",
     .share = other_than_tiles,
     .p = {16},
     .symmetric = true,
     .doubt = 0.17},
    {.name = "tiles",
     .text = "in whole tiles of 8x8",
     .share = other_than_tiles,
     .p = {8},
     .symmetric = true,
     .doubt = 0.18},
    {.name = "clear",
     .text = "where {from} has one value: {to} lacks a clear, or {from} a draw",
     .share = was_cleared,
     .doubt = 0.2},
    {.name = "layer_alone",
     .text = "in the first layer alone",
     .where = in_layer,
     .symmetric = true},
    {.name = "layer_alone",
     .text = "in the last layer alone",
     .where = in_layer,
     .p = {1},
     .symmetric = true},
    {.name = "channel",
     .text = "in red (x) alone",
     .share = other_channels,
     .p = {0},
     .symmetric = true,
     .doubt = 0.3},
    {.name = "channel",
     .text = "in green (y) alone",
     .share = other_channels,
     .p = {1},
     .symmetric = true,
     .doubt = 0.3},
    {.name = "channel",
     .text = "in blue (z) alone",
     .share = other_channels,
     .p = {2},
     .symmetric = true,
     .doubt = 0.3},
    {.name = "channel",
     .text = "in alpha (w) alone",
     .share = other_channels,
     .p = {3},
     .symmetric = true,
     .doubt = 0.3},
    {.name = "edges",
     .text = "at edges alone: rasterization, samples or filters",
     .where = at_edge,
     .symmetric = true,
     .doubt = 0.1},
};

const uint32_t fault_count = DT_ARRAY_COUNT(faults);
