/* Image resources as pictures; see picture.h. Row 0 of a resource is NDC y = -1, the bottom
 * unless the spec has `origin: top`: rows are flipped here, and nowhere else. */
#include "picture/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "picture/texels.h"
#include "scenes/srgb.h"

/* Layout of a layered image: a sheet of layers, as square as possible. */
struct sheet {
    uint32_t width, height, columns;
};

static struct sheet plan_sheet(const uint32_t extent[3])
{
    uint32_t columns = (uint32_t)ceil(sqrt((double)extent[2]));
    columns = columns ? columns : 1;
    uint32_t rows = (extent[2] + columns - 1) / columns;
    return (struct sheet){
        .width = columns * extent[0], .height = rows * extent[1], .columns = columns};
}

static bool check_texels(const struct dt_resource *resource, const struct dt_bytes *bytes,
                         const struct dt_log *log)
{
    if (resource->kind != DT_IMAGE)
        return report_error(log, "%s is a buffer; a picture can only be made of an image",
                            resource->name);
    size_t texels = (size_t)bytes->extent[0] * bytes->extent[1] * bytes->extent[2];
    if (!texels || bytes->size < texels * format_info(resource->format)->bytes)
        return report_error(
            log, "%s: %zu bytes were read back, too few for %ux%u texels in %u layers",
            resource->name, bytes->size, bytes->extent[0], bytes->extent[1], bytes->extent[2]);
    return true;
}

void picture_sheet(const uint32_t extent[3], uint32_t size[2])
{
    struct sheet sheet = plan_sheet(extent);
    size[0] = sheet.width;
    size[1] = sheet.height;
}

void picture_place(const uint32_t extent[3], uint64_t texel, uint32_t place[2])
{
    uint64_t area = (uint64_t)extent[0] * extent[1], layer = texel / area;
    uint32_t columns = plan_sheet(extent).columns;
    place[0] = (uint32_t)(layer % columns * extent[0] + texel % extent[0]);
    place[1] = (uint32_t)(layer / columns * extent[1] + extent[1] - 1 - texel % area / extent[0]);
}

bool picture_texel(const uint32_t extent[3], const uint32_t place[2], uint64_t *texel)
{
    struct sheet sheet = plan_sheet(extent);
    if (place[0] >= sheet.width || place[1] >= sheet.height)
        return false;
    uint64_t layer = place[1] / extent[1] * sheet.columns + place[0] / extent[0];
    uint64_t row = layer * extent[1] + extent[1] - 1 - place[1] % extent[1];
    *texel = row * extent[0] + place[0] % extent[0];
    return layer < extent[2];
}

/* One texel as three numbers; one channel is grey, two leave blue at zero. */
static void fetch(const struct dt_resource *resource, const uint8_t *texel, uint32_t chosen,
                  float color[3])
{
    uint32_t channels = format_info(resource->format)->channels;
    chosen = chosen > channels ? channels : chosen;
    uint32_t first = chosen ? chosen - 1 : 0, last = chosen ? chosen : channels;
    color[0] = color[1] = color[2] = 0;
    for (uint32_t c = 0; c < 3 && first + c < last; c++) {
        struct component from = format_component(resource->format, first + c);
        color[c] = (float)number_value(from.kind, texel + from.offset);
    }
    if (last - first == 1)
        color[1] = color[2] = color[0];
}

static bool make_numbers(struct picture *picture, const struct dt_resource *resource,
                         const struct dt_bytes *bytes, uint32_t channel, const struct dt_log *log)
{
    *picture = (struct picture){0};
    if (!check_texels(resource, bytes, log))
        return false;
    const uint32_t *extent = bytes->extent;
    struct sheet sheet = plan_sheet(extent);
    picture->width = sheet.width;
    picture->height = sheet.height;
    picture->linear = calloc((size_t)sheet.width * sheet.height * 3, sizeof *picture->linear);
    if (!picture->linear)
        return report_error(log, "%s: out of memory for a picture of %ux%u", resource->name,
                            sheet.width, sheet.height);
    uint32_t texel_size = format_info(resource->format)->bytes;
    const uint8_t *texel = bytes->data;
    for (uint32_t layer = 0; layer < extent[2]; layer++) {
        uint32_t left = layer % sheet.columns * extent[0];
        uint32_t top = layer / sheet.columns * extent[1];
        for (uint32_t y = 0; y < extent[1]; y++) {
            size_t row = top + (resource->top ? y : extent[1] - 1 - y);
            float *out = picture->linear + (row * sheet.width + left) * 3;
            for (uint32_t x = 0; x < extent[0]; x++, texel += texel_size, out += 3)
                fetch(resource, texel, channel, out);
        }
    }
    return true;
}

bool picture_linear(struct picture *picture, const struct dt_resource *resource,
                    const struct dt_bytes *bytes, const struct dt_log *log)
{
    return make_numbers(picture, resource, bytes, 0, log);
}

/* ---- From numbers to codes ------------------------------------------------------------------- */

struct range {
    float least, most;
};

/* Range of all finite numbers, without a cleared depth of 1. */
static struct range find_range(const float *numbers, size_t count, bool depth)
{
    struct range range = {INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(numbers[i]) || (depth && numbers[i] >= 1))
            continue;
        range.least = fminf(range.least, numbers[i]);
        range.most = fmaxf(range.most, numbers[i]);
    }
    return range;
}

static float map_number(const struct dt_resource *resource, struct range range, float value)
{
    enum number_kind kind = format_info(resource->format)->kind;
    if (number_one(kind) && !number_is_snorm(kind))
        return value;
    if (resource->format == DT_FORMAT_D32F)
        return range.most > range.least ? (value - range.least) / (range.most - range.least)
                                        : value;
    if (range.least < 0) {
        float scale = fmaxf(1, fmaxf(-range.least, range.most));
        return value / scale * 0.5f + 0.5f;
    }
    return srgb_encode(range.most > 1 ? value / (1 + value) : value);
}

/* Hues by steps of the golden ratio, which spreads any number of hues evenly; lightness
 * alternates. */
static void picture_label(int64_t label, uint8_t codes[3])
{
    if (label < 0) {
        memset(codes, 64, 3);
        return;
    }
    double hue = fmod((double)label * 0.6180339887498949, 1) * 6;
    double light = label % 3 == 1 ? 150 : 255, dark = label % 5 == 4 ? 90 : 30;
    for (int c = 0; c < 3; c++) {
        double away = fabs(fmod(hue - 2 * c + 9, 6) - 3); /* from the channel's own hue, 0 to 3 */
        double share = fmin(fmax(2 - away, 0), 1);
        codes[c] = (uint8_t)(dark + (light - dark) * share);
    }
}

/* Linear between the colours of five values, in equal steps. */
static void tint(float value, float color[3])
{
    static const float ramp[5][3] = {{0.1f, 0.05f, 0.3f},
                                     {0.1f, 0.4f, 0.9f},
                                     {0.1f, 0.8f, 0.6f},
                                     {0.95f, 0.85f, 0.2f},
                                     {0.7f, 0.1f, 0.05f}};
    float at = fminf(fmaxf(value, 0), 1) * 4;
    int below = at < 3 ? (int)at : 3;
    for (int c = 0; c < 3; c++)
        color[c] = ramp[below][c] + (ramp[below + 1][c] - ramp[below][c]) * (at - (float)below);
}

static void encode_texel(const struct dt_resource *resource, struct range range,
                         const struct picture_look *look, const float color[3], uint8_t codes[3])
{
    static const uint8_t magenta[3] = {255, 0, 255};
    float mapped[3], width = look->range[1] - look->range[0];
    if (!isfinite(color[0]) || !isfinite(color[1]) || !isfinite(color[2])) {
        memcpy(codes, magenta, sizeof magenta);
        return;
    }
    for (int c = 0; c < 3; c++) {
        float value = color[c] * exp2f(look->exposure);
        mapped[c] = !look->ranged ? map_number(resource, range, value)
                    : width != 0  ? (value - look->range[0]) / width
                                  : 0;
    }
    if (look->tinted)
        tint((mapped[0] + mapped[1] + mapped[2]) / 3, mapped);
    for (int c = 0; c < 3; c++)
        codes[c] = (uint8_t)lrintf(fminf(fmaxf(mapped[c], 0), 1) * 255);
}

void picture_range(const struct dt_resource *resource, const struct dt_bytes *bytes,
                   uint32_t channel, float out[2])
{
    size_t texels = (size_t)bytes->extent[0] * bytes->extent[1] * bytes->extent[2];
    uint32_t channels = format_info(resource->format)->channels;
    uint32_t count = channel || channels == 1 ? 1 : channels < 3 ? channels : 3;
    struct range all = {INFINITY, -INFINITY};
    for (size_t i = 0; i < texels; i++) {
        float color[3];
        fetch(resource, bytes->data + i * format_info(resource->format)->bytes, channel, color);
        struct range range = find_range(color, count, resource->format == DT_FORMAT_D32F);
        all.least = fminf(all.least, range.least);
        all.most = fmaxf(all.most, range.most);
    }
    out[0] = all.least <= all.most ? all.least : 0;
    out[1] = all.least <= all.most ? all.most : 1;
}

bool picture_codes(struct picture *picture, const struct dt_resource *resource,
                   const struct dt_bytes *bytes, const struct dt_log *log)
{
    return picture_look(picture, resource, bytes, &(struct picture_look){0}, log);
}

bool picture_look(struct picture *picture, const struct dt_resource *resource,
                  const struct dt_bytes *bytes, const struct picture_look *look,
                  const struct dt_log *log)
{
    if (!make_numbers(picture, resource, bytes, look->channel, log))
        return false;
    size_t count = (size_t)picture->width * picture->height;
    picture->codes = malloc(count * 3);
    if (!picture->codes) {
        report_error(log, "%s: out of memory for a picture", resource->name);
        picture_free(picture);
        return false;
    }
    bool labels = format_is_integer(resource->format) && !look->ranged && !look->tinted;
    struct range range = find_range(picture->linear, count * 3, resource->format == DT_FORMAT_D32F);
    for (size_t i = 0; i < count; i++)
        if (labels)
            picture_label((int64_t)picture->linear[i * 3], picture->codes + i * 3);
        else
            encode_texel(resource, range, look, picture->linear + i * 3, picture->codes + i * 3);
    free(picture->linear);
    picture->linear = NULL;
    return true;
}

void picture_free(struct picture *picture)
{
    free(picture->codes);
    free(picture->linear);
    *picture = (struct picture){0};
}
