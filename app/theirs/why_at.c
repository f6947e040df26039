/* Faults that take a number of one copy from another place of the other: flips, shifts, layers, pitch, layouts, channels.
 * See why_fault.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "theirs/why_fault.h"

/* ---- Where they apply -------------------------------------------------------------------------- */

static bool is_image(const struct asked *asked)
{
    return asked->image && asked->from->extent[1] > 1;
}

static bool has_colour(const struct asked *asked)
{
    return asked->count >= 3 && asked->count <= 4;
}

static bool has_channels(const struct asked *asked)
{
    return asked->p[0] < asked->count && asked->count > 1;
}

static bool has_alpha(const struct asked *asked)
{
    return asked->image && asked->count == 4;
}

/* ---- Rows and columns -------------------------------------------------------------------------- */

/* p: whether x and y run backwards. */
static double turned(const struct asked *asked, struct place place)
{
    int64_t w = asked->from->extent[0], h = asked->image ? asked->from->extent[1] : 1;
    return from_at(asked, place, asked->p[0] > 0 ? w - 1 - place.x : place.x,
                   asked->p[1] > 0 ? h - 1 - place.y : place.y, place.z, place.component);
}

static bool is_square(const struct asked *asked)
{
    return is_image(asked) && asked->from->extent[0] == asked->from->extent[1];
}

/* x and y in each other's place; p: backwards. */
static double swapped(const struct asked *asked, struct place place)
{
    int64_t last = (int64_t)asked->from->extent[0] - 1;
    return from_at(asked, place, asked->p[0] > 0 ? last - place.y : place.y,
                   asked->p[1] > 0 ? last - place.x : place.x, place.z, place.component);
}

/* p: steps in x, y and z; x of a buffer is the element. */
static double shifted(const struct asked *asked, struct place place)
{
    return from_at(asked, place, place.x + (int64_t)asked->p[0], place.y + (int64_t)asked->p[1],
                   place.z + (int64_t)asked->p[2], place.component);
}

/* Over the edge to the other side. p: steps; fit: the halves of the size. */
static double rolled(const struct asked *asked, struct place place)
{
    int64_t w = asked->from->extent[0], h = asked->from->extent[1];
    return from_at(asked, place, (place.x + (asked->p[0] > 0 ? w / 2 : 0)) % w,
                   (place.y + (asked->p[1] > 0 ? h / 2 : 0)) % h, place.z, place.component);
}

/* The mean of the texels between which half a texel lies. */
static double half_shifted(const struct asked *asked, struct place place)
{
    int64_t dx = (int64_t)asked->p[0], dy = (int64_t)asked->p[1];
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += from_at(asked, place, place.x + (i & 1 ? dx : 0), place.y + (i & 2 ? dy : 0),
                       place.z, place.component);
    return sum / 4;
}

/* A small filter around the texel: a box of 3, or a tent. */
static double blurred(const struct asked *asked, struct place place)
{
    double sum = 0, weights = 0;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            double weight = asked->p[0] > 0 ? (2 - abs(dx)) * (2 - abs(dy)) : 1;
            sum += weight *
                   from_at(asked, place, place.x + dx, place.y + dy, place.z, place.component);
            weights += weight;
        }
    return sum / weights;
}

/* The mean, or with p[1] the first, of blocks of p[0] texels. */
static double coarse(const struct asked *asked, struct place place)
{
    int64_t block = (int64_t)asked->p[0], n = asked->p[1] > 0 ? 1 : block;
    int64_t x = place.x / block * block, y = place.y / block * block;
    double sum = 0;
    for (int64_t i = 0; i < n * n; i++)
        sum += from_at(asked, place, x + i % n, y + i / n, place.z, place.component);
    return sum / (double)(n * n);
}

/* ---- Layers, mips, frames ---------------------------------------------------------------------- */

static bool has_layers(const struct asked *asked)
{
    return asked->image && asked->from->extent[2] > 1;
}

static double layers_reversed(const struct asked *asked, struct place place)
{
    return from_at(asked, place, place.x, place.y, (int64_t)asked->from->extent[2] - 1 - place.z,
                   place.component);
}

/* Faces p[0] and p[0] + 1, or with 3 all pairs, in each other's place. */
static double faces_swapped(const struct asked *asked, struct place place)
{
    int64_t pair = (int64_t)asked->p[0], face = place.z;
    if (asked->from->extent[2] % 6)
        return NAN;
    if (pair == 3 || face % 6 / 2 == pair)
        face ^= 1;
    return from_at(asked, place, place.x, place.y, face, place.component);
}

static const struct copy *relative_of(const struct asked *asked)
{
    return &asked->relatives[asked->side][(int)asked->p[0]];
}

static bool has_relative(const struct asked *asked)
{
    return relative_of(asked)->data;
}

/* Frames have one size; of a mip the texel that lies there. */
static double of_relative(const struct asked *asked, struct place place)
{
    const struct copy *copy = relative_of(asked);
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

/* Numbers of a row that is `pitch` numbers long, read as if there was no padding; backwards with p[2]: rows
 * `pitch` apart where there is none. */
static double pitched(const struct asked *asked, struct place place)
{
    int64_t row = (int64_t)asked->from->extent[0] * asked->count, pitch = (int64_t)asked->p[3];
    int64_t at = place.x * asked->count + place.component;
    if (asked->p[2] > 0)
        return linear_from(asked, place, place.y * pitch + at);
    int64_t number = place.y * row + at;
    return number % pitch < row ? linear_from(asked, place, number / pitch * row + number % pitch)
                                : NAN;
}

static bool pitch_fits(const struct asked *asked)
{
    enum { TRIED = 64 };
    uint32_t known = 0, wrong = 0, step = asked->differing_count / TRIED + 1;
    for (uint32_t i = 0; i < asked->differing_count; i += step) {
        struct place place = place_of(asked, asked->differing[i], i / step % asked->count);
        double want = pitched(asked, place), got = to_number(asked, place);
        if (isnan(want))
            continue;
        known++;
        wrong += !(fabs(want - got) <= 0.02 * asked->range);
        if (wrong > 8 + known / 4)
            return false;
    }
    return known >= 12 && wrong * 8 < known;
}

static bool fit_pitch(struct asked *asked)
{
    if (!is_image(asked) || asked->differing_count < 24)
        return false;
    int64_t row = (int64_t)asked->from->extent[0] * asked->count;
    for (int64_t pitch = asked->p[2] > 0 ? row / 2 : row + 1; pitch <= 2 * row + 256; pitch++) {
        asked->p[3] = (double)pitch;
        if (pitch == row || !pitch_fits(asked))
            continue;
        asked->p[0] = (double)pitch / asked->count;
        asked->p[1] = asked->from->extent[0];
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
static double repacked(const struct asked *asked, struct place place)
{
    int64_t to = (int64_t)asked->p[0], from = (int64_t)asked->p[1], byte = byte_of(asked, place);
    if (byte % to >= from)
        return NAN;
    return word_from(asked, place, byte / to * from + byte % to);
}

static double restrided(const struct asked *asked, struct place place)
{
    return word_from(asked, place,
                     (int64_t)place.element * (int64_t)asked->p[0] +
                         asked->components[place.component].offset);
}

static double moved_words(const struct asked *asked, struct place place)
{
    return word_from(asked, place, byte_of(asked, place) + (int64_t)asked->p[0]);
}

static bool is_buffer(const struct asked *asked)
{
    return !asked->image;
}

/* Elements of another size; fit[1] is the size that they should have. */
static bool fit_stride(struct asked *asked)
{
    uint32_t step = asked->differing_count / 64 + 1;
    for (uint32_t stride = 4; !asked->image && stride <= 4 * asked->stride; stride += 4) {
        uint32_t known = 0, right = 0;
        asked->p[0] = stride;
        asked->p[1] = asked->stride;
        for (uint32_t i = 0; i < asked->differing_count; i += step) {
            struct place place = place_of(asked, asked->differing[i], i % asked->count);
            double want = restrided(asked, place);
            known += !isnan(want);
            right += want == to_number(asked, place);
        }
        if (stride != asked->stride && known >= 6 && right * 10 > known * 9)
            return true;
    }
    return false;
}

static double transposed(const struct asked *asked, struct place place)
{
    if (asked->image) /* a row of texels for each matrix */
        return from_at(asked, place, place.component, place.y, place.z, (uint32_t)place.x);
    return same_from(asked, place, asked->transposed[place.component]);
}

static bool has_matrices(const struct asked *asked)
{
    if (asked->image)
        return asked->count > 2 && asked->from->extent[0] == asked->count;
    for (uint32_t c = 0; c < asked->count; c++)
        if (asked->transposed[c] != c)
            return true;
    return false;
}

static bool has_matrix4(const struct asked *asked)
{
    return !asked->image && has_matrices(asked) && asked->count % 16 == 0;
}

/* p: the step between the rows of a column, 1, or 4 if the matrix is by rows; the row; 1: negated, else
 * its z is 0..1 against -1..1. */
static double matrix_row(const struct asked *asked, struct place place)
{
    uint32_t step = (uint32_t)asked->p[0], c = place.component, row = c % 16 / step % 4;
    double value = same_from(asked, place, c);
    if (row != (uint32_t)asked->p[1])
        return value;
    return asked->p[2] > 0 ? -value : (value + same_from(asked, place, c + step)) / 2;
}

/* ---- Channels ---------------------------------------------------------------------------------- */

/* p: the channel of `from` that each of `to` has; 4: zero, 5: one. */
static double permuted(const struct asked *asked, struct place place)
{
    int channel = place.component < FAULT_NUMBERS ? (int)asked->p[place.component] : 0;
    if (channel > 3)
        return channel - 4;
    return (uint32_t)channel < asked->count ? same_from(asked, place, (uint32_t)channel)
           : channel == 3                   ? 1
                                            : NAN;
}

static bool has_two(const struct asked *asked)
{
    return asked->count == 2;
}

/* The first channel, or the luminance, in all. */
static double grey(const struct asked *asked, struct place place)
{
    double r = same_from(asked, place, 0), g = same_from(asked, place, 1);
    double b = same_from(asked, place, 2);
    if (place.component == 3)
        return NAN;
    return asked->p[0] > 0 ? 0.2126 * r + 0.7152 * g + 0.0722 * b : r;
}

static double premultiplied(const struct asked *asked, struct place place)
{
    double alpha = same_from(asked, place, 3), value = same_from(asked, place, place.component);
    return place.component == 3 ? value : value * alpha;
}

static double alpha_inverted(const struct asked *asked, struct place place)
{
    double value = same_from(asked, place, place.component);
    return place.component == 3 ? 1 - value : value;
}

/* One channel, p[0], that is 1 - v, with p[1] -v. */
static double channel_inverted(const struct asked *asked, struct place place)
{
    double value = same_from(asked, place, place.component);
    if (place.component != (uint32_t)asked->p[0])
        return value;
    return asked->p[1] > 0 ? -value : 1 - value;
}

/* ---- The table --------------------------------------------------------------------------------- */

/* NOLINTBEGIN(bugprone-macro-parentheses): parts of strings and of initializers */
#define AT(label, function, condition, same, unsure, words, ...)                                   \
    {                                                                                              \
        .name = (label), .text = words, .at = (function), .applies = (condition),                  \
        .symmetric = (same), .doubt = (unsure), .p = {                                             \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }
#define AT_FIT(label, function, fits, unsure, words, ...)                                          \
    {                                                                                              \
        .name = (label), .text = words, .at = (function), .fit = (fits), .doubt = (unsure), .p = { \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }
#define SHIFT(label, words, x, y)                                                                  \
    AT(label, shifted, NULL, SIDED, 0, "after a shift of " words, x, y)
#define HALF(label, words, x, y)                                                                   \
    AT(label, half_shifted, is_image, SIDED, 0,                                                    \
       "after half a texel in " words ": centres are at .5", x, y)
#define CHANNELS(label, words, r, g, b, a)                                                         \
    {                                                                                              \
        .name = (label), .text = words, .at = permuted, .applies = has_colour, .p = {r, g, b, a},  \
        .channels = true                                                                           \
    }
#define REPACKED(into, outof, what)                                                                \
    AT("layout", repacked, is_buffer, SIDED, 0,                                                    \
       "with " what " (std140, std430 or packed): {0} bytes each in {to}, {1} in {from}", into,    \
       outof)
/* NOLINTEND(bugprone-macro-parentheses) */

/* A row: its name, what it calls, where it applies (NULL: everywhere), whether it is the same from either copy, its
 * doubt, what it says, and p. */
static const struct fault rows[] = {
    AT("flip_y", turned, is_image, SAME, 0, "after a flip in y: OpenGL's row 0 is the bottom", 0,
       1),
    AT("mirror_x", turned, is_image, SAME, 0, "after a mirror in x", 1, 0),
    AT("turn", turned, is_image, SAME, 0, "after half a turn: x and y run backwards", 1, 1),
    AT("reversed", turned, is_buffer, SAME, 0, "with the elements in reverse order", 1, 0),
    AT("axes", swapped, is_square, SAME, 0, "with x and y in each other's place", 0),
    AT("quarter_turn", swapped, is_square, SIDED, 0, "after a quarter turn of {from}", 1, 0),
    AT("frame", of_relative, has_relative, SIDED, 0,
       "one frame late: {to} has the frame before of {from}", WHY_FRAME_BEFORE),
    AT("frame", of_relative, has_relative, SIDED, 0,
       "one frame early: {to} has the frame after of {from}", WHY_FRAME_AFTER),
    AT("layer", shifted, has_layers, SIDED, 0, "one layer off: {to} has the layer after of {from}",
       0, 0, 1),
    AT("layers_reversed", layers_reversed, has_layers, SAME, 0, "with the layers in reverse order",
       0),
    AT("faces", faces_swapped, has_layers, SAME, 0, "with the faces +x and -x swapped", 0),
    AT("faces", faces_swapped, has_layers, SAME, 0, "with the faces +y and -y swapped", 1),
    AT("faces", faces_swapped, has_layers, SAME, 0, "with the faces +z and -z swapped", 2),
    AT("faces", faces_swapped, has_layers, SAME, 0, "with opposite faces of the cube swapped", 3),
    AT("mip", of_relative, has_relative, SIDED, 0, "one mip off: {to} has the finer mip of {from}",
       WHY_MIP_FINER),
    AT("mip", of_relative, has_relative, SIDED, 0,
       "one mip off: {to} has the coarser mip of {from}", WHY_MIP_COARSER),
    SHIFT("shift_x", "one texel (or element) in x", 1, 0),
    SHIFT("shift_y", "one texel in y", 0, 1),
    SHIFT("shift_xy", "one texel in x and y", 1, 1),
    SHIFT("shift_xy", "one texel in x and back in y", 1, -1),
    SHIFT("shift_2x", "two texels (or elements) in x", 2, 0),
    SHIFT("shift_2y", "two texels in y", 0, 2),
    AT("roll", rolled, is_image, SIDED, 0, "after half the width, round the edge", 1, 0),
    AT("roll", rolled, is_image, SIDED, 0, "after half the height, round the edge", 0, 1),
    AT("roll", rolled, is_image, SIDED, 0, "after half the width and height, round the edge", 1, 1),
    HALF("half_texel_x", "x", 1, 0),
    HALF("half_texel_x", "x", -1, 0),
    HALF("half_texel_y", "y", 0, 1),
    HALF("half_texel_y", "y", 0, -1),
    HALF("half_texel_xy", "x and y", 1, 1),
    HALF("half_texel_xy", "x and y", -1, -1),
    HALF("half_texel_xy", "x and y", 1, -1),
    HALF("half_texel_xy", "x and y", -1, 1),
    AT_FIT("pitch", pitched, fit_pitch, 0,
           "if rows of a pitch of {0} texels were read as {1}: {to} has the padding of rows in it",
           0),
    AT_FIT("pitch", pitched, fit_pitch, 0,
           "if rows of {1} texels were read at a pitch of {0}, in {to}", 0, 0, 1),
    CHANNELS("red_blue", "with red and blue swapped (RGBA against BGRA)", 2, 1, 0, 3),
    CHANNELS("channels", "with red and green swapped", 1, 0, 2, 3),
    CHANNELS("channels", "with green and blue swapped", 0, 2, 1, 3),
    CHANNELS("channels", "with the channels in the order g, b, r", 1, 2, 0, 3),
    CHANNELS("channels", "with the channels in the order a, r, g, b", 3, 0, 1, 2),
    CHANNELS("channels", "with the channels in the order a, b, g, r", 3, 2, 1, 0),
    AT("channels", permuted, has_two, SAME, 0, "with both channels swapped", 1, 0),
    AT("grey", grey, has_colour, SIDED, 0, "if {to} has the first channel of {from} in all", 0),
    AT("grey", grey, has_colour, SIDED, 0, "if {to} has the luminance of {from} in all channels",
       1),
    AT("alpha_lost", permuted, has_alpha, SIDED, 0, "if alpha is 1 in {to}", 0, 1, 2, 5),
    AT("alpha_lost", permuted, has_alpha, SIDED, 0, "if alpha is 0 in {to}", 0, 1, 2, 4),
    CHANNELS("channel_lost", "if blue is 0 in {to}", 0, 1, 4, 3),
    CHANNELS("channel_lost", "if green and blue are 0 in {to}", 0, 4, 4, 3),
    AT("premultiplied", premultiplied, has_alpha, SIDED, 0,
       "if {from} is multiplied by alpha, as {to} is", 0),
    AT("alpha_inverted", alpha_inverted, has_alpha, SAME, 0, "with alpha inverted", 0),
    AT("channel_inverted", channel_inverted, has_colour, SAME, 0,
       "with green as 1 - g (normal maps)", 1),
    AT("channel_inverted", channel_inverted, has_colour, SAME, 0, "with red as 1 - r", 0),
    AT("channel_negated", channel_inverted, has_channels, SAME, 0, "with x (red) negated", 0, 1),
    AT("channel_negated", channel_inverted, has_channels, SAME, 0, "with y (green) negated", 1, 1),
    AT("channel_negated", channel_inverted, has_channels, SAME, 0,
       "with z (blue) negated: the other handedness", 2, 1),
    AT("transposed", transposed, has_matrices, SAME, 0,
       "after each matrix is transposed (rows against columns)", 0),
    AT("matrix_y", matrix_row, has_matrix4, SAME, 0,
       "with the y row of each matrix negated (Vulkan's y points down)", 1, 1, 1),
    AT("matrix_y", matrix_row, has_matrix4, SAME, 0,
       "with the y row of each matrix negated (by rows)", 4, 1, 1),
    AT("matrix_z", matrix_row, has_matrix4, SIDED, 0,
       "if the z row of each matrix of {from} goes from -1..1 to 0..1", 1, 2, 0),
    AT("matrix_z", matrix_row, has_matrix4, SIDED, 0,
       "if the z row of each matrix (by rows) of {from} goes from -1..1 to 0..1", 4, 2, 0),
    REPACKED(12, 16, "vec3 of 12 against 16 bytes"),
    REPACKED(4, 16, "numbers of 4 against 16 bytes"),
    REPACKED(8, 16, "vec2 of 8 against 16 bytes"),
    REPACKED(16, 12, "vec3 of 16 against 12 bytes"),
    REPACKED(16, 4, "numbers of 16 against 4 bytes"),
    REPACKED(16, 8, "vec2 of 16 against 8 bytes"),
    AT_FIT("stride", restrided, fit_stride, 0,
           "with elements of {0} bytes against {1} (std140, std430 or packed)", 0),
    AT("moved", moved_words, is_buffer, SIDED, 0, "if all lies one number (4 bytes) later", 4),
    AT("moved", moved_words, is_buffer, SIDED, 0, "if all lies 16 bytes later", 16),
    AT("half_rate", coarse, is_image, SIDED, 0.02,
       "if {to} has means of 2x2 texels: half the resolution", 2),
    AT("half_rate", coarse, is_image, SIDED, 0.02,
       "if {to} has each second texel twice: nearest, half the resolution", 2, 1),
    AT("half_rate", coarse, is_image, SIDED, 0.02, "if {to} has means of 4x4 texels", 4),
    AT("blurred", blurred, is_image, SIDED, 0.03, "if {from} is filtered by 3x3 texels, as {to} is",
       0),
    AT("blurred", blurred, is_image, SIDED, 0.03, "if {from} is filtered by a 3x3 tent, as {to} is",
       1),
};

const struct fault_list faults_at = {rows, DT_ARRAY_COUNT(rows)};
