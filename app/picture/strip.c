/* Strips of two copies and their difference; see strip.h. */
#include "picture/strip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "picture/texels.h"
#include "picture/picture.h"
#include "scenes/image.h"

enum {
    PANELS = 3,
    READABLE = 256, /* smaller panels are enlarged up to this many pixels */
    SEPARATOR = 4,  /* pixels between panels */
    SEPARATOR_GREY = 128,
    DARKEST = 48,    /* code of the smallest difference */
    SATURATED = 100, /* one in so many differing texels may be brighter than full */
    FRAME = 8        /* pixels from the worst texel to the frame around it */
};

/* Both copies of the shown layer. */
struct pair {
    const struct dt_resource *resource;
    const uint8_t *layers[2];
    uint32_t width, height;
    uint32_t worst[2]; /* x and y of the largest difference */
};

static bool is_label(const struct dt_resource *resource)
{
    return format_is_integer(resource->format);
}

/* ---- Measuring ------------------------------------------------------------------------------- */

/* Of channel c of one texel; NaN where either is NaN or Inf. */
static double channel_difference(const struct dt_resource *resource, const uint8_t *const texels[2],
                                 uint32_t c)
{
    struct component channel = format_component(resource->format, c);
    double values[2];
    for (int i = 0; i < 2; i++)
        values[i] = number_value(channel.kind, texels[i] + channel.offset);
    return isfinite(values[0]) && isfinite(values[1]) ? fabs(values[0] - values[1]) : NAN;
}

/* Exponent of the smallest power of two that is at least the number. Differences of floats lie
 * between 2^-149 and 2^129. */
enum { LEAST_EXPONENT = -149, EXPONENTS = 129 + 149 + 1 };

static int exponent_of(double difference)
{
    int exponent;
    bool power = frexp(difference, &exponent) == 0.5;
    exponent -= power;
    return exponent < LEAST_EXPONENT ? LEAST_EXPONENT : exponent;
}

/* The differences of one layer: of a texel that of the channel where it is largest. */
struct survey {
    double largest;    /* INFINITY where there is a NaN or Inf, -1 where nothing differs */
    uint32_t worst[2]; /* x and y of it */
    size_t differing;
    size_t by_exponent[EXPONENTS];
};

static double texel_difference(const struct dt_resource *resource, const uint8_t *const texels[2])
{
    bool differs = memcmp(texels[0], texels[1], format_info(resource->format)->bytes) != 0;
    double most = differs ? 0 : -1;
    for (uint32_t c = 0; c < format_info(resource->format)->channels; c++) {
        double difference = channel_difference(resource, texels, c);
        if (isnan(difference))
            return INFINITY;
        most = differs ? fmax(most, difference) : most;
    }
    return most;
}

static void survey_layer(struct survey *survey, const struct dt_resource *resource,
                         const uint8_t *const layers[2], const uint32_t extent[3])
{
    size_t size = format_info(resource->format)->bytes, at = 0;
    *survey = (struct survey){.largest = -1};
    for (uint32_t y = 0; y < extent[1]; y++) {
        for (uint32_t x = 0; x < extent[0]; x++, at += size) {
            const uint8_t *const texels[2] = {layers[0] + at, layers[1] + at};
            double difference = texel_difference(resource, texels);
            if (difference > survey->largest) {
                survey->largest = difference;
                survey->worst[0] = x;
                survey->worst[1] = y;
            }
            survey->differing += difference >= 0;
            if (difference > 0 && isfinite(difference))
                survey->by_exponent[exponent_of(difference) - LEAST_EXPONENT]++;
        }
    }
}

/* Lets a few outliers saturate, so that the others stay visible. */
static double amplify(const struct survey *survey)
{
    size_t beyond = 0;
    int at = EXPONENTS;
    while (at > 0 && beyond + survey->by_exponent[at - 1] <= survey->differing / SATURATED)
        beyond += survey->by_exponent[--at];
    return at > 0 ? ldexp(1, -(at - 1 + LEAST_EXPONENT)) : 1;
}

static struct pair choose_layer(struct strip *strip, const struct dt_resource *resource,
                                const struct dt_bytes copies[2])
{
    const uint32_t *extent = copies[0].extent;
    size_t size = (size_t)extent[0] * extent[1] * format_info(resource->format)->bytes;
    struct survey worst = {.largest = -2}, survey;
    for (uint32_t layer = 0; layer < extent[2]; layer++) {
        const uint8_t *const layers[2] = {copies[0].data + layer * size,
                                          copies[1].data + layer * size};
        survey_layer(&survey, resource, layers, extent);
        if (survey.largest > worst.largest) {
            worst = survey;
            strip->layer = layer;
        }
    }
    strip->amplification = is_label(resource) ? 0 : amplify(&worst);
    return (struct pair){
        .resource = resource,
        .layers = {copies[0].data + strip->layer * size, copies[1].data + strip->layer * size},
        .width = extent[0],
        .height = extent[1],
        .worst = {worst.worst[0], worst.worst[1]}};
}

/* ---- Painting -------------------------------------------------------------------------------- */

/* The difference of one texel as codes. */
static void paint_difference(const struct strip *strip, const struct dt_resource *resource,
                             const uint8_t *const texels[2], uint8_t codes[3])
{
    static const uint8_t magenta[3] = {255, 0, 255};
    uint32_t channels = format_info(resource->format)->channels;
    double differences[4] = {0};
    bool differs = memcmp(texels[0], texels[1], format_info(resource->format)->bytes) != 0;
    for (uint32_t c = 0; c < channels; c++) {
        differences[c] = channel_difference(resource, texels, c);
        if (isnan(differences[c])) {
            memcpy(codes, magenta, sizeof magenta);
            return;
        }
    }
    if (channels == 1)
        differences[1] = differences[2] = differences[0];
    for (uint32_t c = 0; c < 3; c++) {
        double shown = fmax(differences[c], differences[3]) * strip->amplification;
        double light = is_label(resource) ? 1 : sqrt(fmin(shown, 1));
        codes[c] = differs ? (uint8_t)lrint(DARKEST + (255 - DARKEST) * light) : 0;
    }
}

static uint8_t *allocate_codes(uint32_t width, uint32_t height)
{
    size_t texels = (size_t)width * height;
    return calloc(texels ? texels : 1, 3);
}

/* Three channels, row 0 at the top, as picture_codes has them. */
static uint8_t *paint_differences(const struct strip *strip, const struct pair *pair)
{
    size_t size = format_info(pair->resource->format)->bytes;
    uint8_t *codes = allocate_codes(pair->width, pair->height);
    for (uint32_t y = 0; codes && y < pair->height; y++) {
        size_t row = (size_t)(pair->height - 1 - y) * pair->width;
        for (uint32_t x = 0; x < pair->width; x++) {
            size_t at = ((size_t)y * pair->width + x) * size;
            const uint8_t *const texels[2] = {pair->layers[0] + at, pair->layers[1] + at};
            paint_difference(strip, pair->resource, texels, codes + (row + x) * 3);
        }
    }
    return codes;
}

/* Puts both copies into one image as two layers: they then share one mapping. */
static bool paint_copies(struct picture *picture, const struct pair *pair, const struct dt_log *log)
{
    size_t size = (size_t)pair->width * pair->height * format_info(pair->resource->format)->bytes;
    struct dt_bytes both = {

        .data = calloc(2, size ? size : 1),
        .size = 2 * size,
        .extent = {pair->width, pair->height, 2}};
    if (!both.data)
        return report_error(log, "%s: out of memory for a picture", pair->resource->name);
    for (int i = 0; i < 2; i++)
        memcpy(both.data + i * size, pair->layers[i], size);
    bool good = picture_codes(picture, pair->resource, &both, log);
    free(both.data);
    return good;
}

/* ---- Putting together ------------------------------------------------------------------------ */

struct canvas {
    uint32_t width, height, scale;
    uint8_t *codes;
};

/* Copies columns of a picture, enlarged. */
static void place_panel(struct canvas *canvas, uint32_t left, const uint8_t *codes,
                        uint32_t first_column, uint32_t row_columns, uint32_t columns)
{
    for (uint32_t y = 0; y < canvas->height; y++) {
        const uint8_t *row = codes + ((size_t)(y / canvas->scale) * row_columns + first_column) * 3;
        uint8_t *out = canvas->codes + ((size_t)y * canvas->width + left) * 3;
        for (uint32_t x = 0; x < columns * canvas->scale; x++, out += 3)
            memcpy(out, row + (size_t)(x / canvas->scale) * 3, 3);
    }
}

/* A yellow square around the worst texel of the last panel, which alone would not be seen. */
static void frame_worst(struct canvas *canvas, const struct pair *pair, uint32_t panel)
{
    static const uint8_t yellow[3] = {255, 255, 0};
    int64_t scale = canvas->scale, side = scale + 2 * (int64_t)FRAME;
    int64_t left = pair->worst[0] * scale - FRAME;
    int64_t top = (pair->height - 1 - pair->worst[1]) * scale - FRAME;
    for (int64_t i = 0; i < side; i++) {
        const int64_t places[4][2] = {{left + i, top},
                                      {left + i, top + side - 1},
                                      {left, top + i},
                                      {left + side - 1, top + i}};
        for (int k = 0; k < 4; k++) {
            int64_t x = places[k][0], y = places[k][1];
            if (x < 0 || y < 0 || x >= panel || y >= canvas->height)
                continue;
            size_t at = (size_t)y * canvas->width + (PANELS - 1) * (panel + SEPARATOR) + (size_t)x;
            memcpy(canvas->codes + at * 3, yellow, sizeof yellow);
        }
    }
}

static bool write_panels(const char *path, const struct pair *pair, const struct picture *copies,
                         const uint8_t *differences, const struct dt_log *log)
{
    uint32_t side = pair->width > pair->height ? pair->width : pair->height;
    uint32_t scale = side && side < READABLE ? READABLE / side : 1;
    uint32_t panel = pair->width * scale;
    struct canvas canvas = {.width = PANELS * panel + (PANELS - 1) * SEPARATOR,
                            .height = pair->height * scale,
                            .scale = scale};
    canvas.codes = allocate_codes(canvas.width, canvas.height);
    if (!canvas.codes)
        return report_error(log, "%s: out of memory for a picture of %ux%u", pair->resource->name,
                            canvas.width, canvas.height);
    memset(canvas.codes, SEPARATOR_GREY, (size_t)canvas.width * canvas.height * 3);
    for (uint32_t i = 0; i < 2; i++)
        place_panel(&canvas, i * (panel + SEPARATOR), copies->codes, i * pair->width, copies->width,
                    pair->width);
    place_panel(&canvas, (PANELS - 1) * (panel + SEPARATOR), differences, 0, pair->width,
                pair->width);
    frame_worst(&canvas, pair, panel);
    bool good = image_write_png(path, canvas.width, canvas.height, 3, canvas.codes, log);
    free(canvas.codes);
    return good;
}

static bool check_copies(const struct dt_resource *resource, const struct dt_bytes copies[2],
                         const struct dt_log *log)
{
    const uint32_t *extent = copies[0].extent;
    if (resource->kind != DT_IMAGE)
        return report_error(log, "%s is a buffer; a picture can only be made of an image",
                            resource->name);
    size_t size = (size_t)extent[0] * extent[1] * extent[2] * format_info(resource->format)->bytes;
    bool same = memcmp(extent, copies[1].extent, sizeof copies[0].extent) == 0;
    if (!same || !size || copies[0].size < size || copies[1].size < size)
        return report_error(log, "%s: the two copies are not images of one size", resource->name);
    return true;
}

/* Writes some columns of a picture. */
static bool write_columns(const char *path, const struct pair *pair, const uint8_t *codes,
                          uint32_t first_column, uint32_t row_columns, const struct dt_log *log)
{
    struct canvas canvas = {.width = pair->width, .height = pair->height, .scale = 1};
    canvas.codes = allocate_codes(canvas.width, canvas.height);
    if (!canvas.codes)
        return report_error(log, "%s: out of memory for a picture", pair->resource->name);
    place_panel(&canvas, 0, codes, first_column, row_columns, pair->width);
    bool good = image_write_png(path, canvas.width, canvas.height, 3, canvas.codes, log);
    free(canvas.codes);
    return good;
}

/* One strip to `path`, or the panels to `paths`. */
static bool write(struct strip *strip, const char *path, const char *const paths[3],
                  const struct dt_resource *resource, const struct dt_bytes copies[2],
                  const struct dt_log *log)
{
    *strip = (struct strip){0};
    if (!check_copies(resource, copies, log))
        return false;
    struct pair pair = choose_layer(strip, resource, copies);
    struct picture both;
    if (!paint_copies(&both, &pair, log))
        return false;
    uint8_t *differences = paint_differences(strip, &pair);
    bool good = differences;
    if (!differences)
        report_error(log, "%s: out of memory for a picture", resource->name);
    else if (path)
        good = write_panels(path, &pair, &both, differences, log);
    for (uint32_t i = 0; good && paths && i < 2; i++)
        good = !paths[i] ||
               write_columns(paths[i], &pair, both.codes, i * pair.width, both.width, log);
    if (good && paths && paths[2])
        good = write_columns(paths[2], &pair, differences, 0, pair.width, log);
    free(differences);
    picture_free(&both);
    return good;
}

bool strip_write(struct strip *strip, const char *path, const struct dt_resource *resource,
                 const struct dt_bytes copies[2], const struct dt_log *log)
{
    return write(strip, path, NULL, resource, copies, log);
}

bool strip_write_apart(struct strip *strip, const char *const paths[3],
                       const struct dt_resource *resource, const struct dt_bytes copies[2],
                       const struct dt_log *log)
{
    return write(strip, NULL, paths, resource, copies, log);
}
