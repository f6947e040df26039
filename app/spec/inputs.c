/* Reads content from outside; see inputs.h. The application does this: gen looks at headers alone,
 * and the runtimes read no files. */
#include "spec/inputs.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "picture/hdr.h"
#include "picture/texels.h"
#include "result/identity.h"
#include "base/nearest.h"
#include "scenes/child.h"
#include "base/npy.h"
#include "scenes/picture_size.h"
#include "scenes/srgb.h"

enum { CHANNELS = 4, MOST_REASON = 512 };

/* One input while its content is read. */
struct loading {
    struct console *console;
    const struct pipeline *pipeline;
    const struct dt_resource *resource;
    struct input *input;
    const uint32_t *size; /* of the frame */
    const char *file;
    bool by_option;
    bool srgb, encoding_is_given;
};

/* ---- Errors ---------------------------------------------------------------------------------- */

/* Reports at the option or at the spec's line. False. */
__attribute__((format(printf, 2, 3))) static bool refuse_input(const struct loading *loading,
                                                               const char *format, ...)
{
    char *text = NULL, *all;
    va_list values;
    va_start(values, format);
    if (vasprintf(&text, format, values) < 0)
        text = NULL;
    va_end(values);
    if (loading->by_option) {
        report_error(&loading->console->log, "input %s=%s: %s", loading->resource->name,
                     loading->file, text ? text : "out of memory");
    } else {
        all = format_string("cannot use the file `%s`: %s", loading->file,
                            text ? text : "out of memory");
        plan_blame_file(loading->pipeline->plan, loading->input->resource,
                        all ? all : "out of memory", loading->console);
        free(all);
    }
    free(text);
    return false;
}

/* ---- Pictures -------------------------------------------------------------------------------- */

/* Linear RGBA, or what an image of codes or data takes for that; row 0 is the image's. */
struct picture_level {
    uint32_t width, height;
    float *texels;
};

static bool holds_light(const struct loading *loading)
{
    return loading->srgb || loading->resource->format == DT_FORMAT_RGBA8_SRGB;
}

/* The messages of a child that reads a picture: passes warnings on, and keeps the reason of an
 * error. */
struct heard {
    const struct loading *loading;
    char reason[MOST_REASON];
};

static void hear(void *user, enum dt_level level, const char *message)
{
    struct heard *heard = user;
    if (level == DT_ERROR)
        snprintf(heard->reason, sizeof heard->reason, "%s", message);
    else
        heard->loading->console->log.message(heard->loading->console->log.user, level, message);
}

static bool write_input_picture(FILE *result, void *user, const struct dt_log *log)
{
    const struct loading *loading = user;
    uint32_t size[2];
    float *texels = NULL;
    if (!hdr_read(loading->file, &size[0], &size[1], &texels, log))
        return false;
    image_check_claims(loading->file,
                       holds_light(loading)         ? IMAGE_AS_SRGB
                       : loading->encoding_is_given ? IMAGE_AS_LIGHT
                                                    : IMAGE_AS_NUMBERS,
                       log);
    fwrite(size, sizeof size, 1, result);
    fwrite(texels, CHANNELS * sizeof *texels, (size_t)size[0] * size[1], result);
    free(texels);
    return true; /* a short write is seen by child_run */
}

static bool read_picture(const struct loading *loading, struct picture_level *level)
{
    struct heard heard = {loading, "out of memory"};
    const struct dt_log log = {.message = hear, .user = &heard};
    FILE *result = child_run(write_input_picture, (void *)loading, &log);
    uint32_t size[2] = {0};
    bool good = result && fread(size, sizeof size, 1, result) == 1 && size[0] == level->width &&
                size[1] == level->height;
    if (result && !good)
        snprintf(heard.reason, sizeof heard.reason,
                 "its header says %ux%u texels, and it has %ux%u", level->width, level->height,
                 size[0], size[1]);
    size_t row = (size_t)CHANNELS * level->width;
    level->texels = good ? malloc(row * level->height * sizeof(float)) : NULL;
    good = level->texels;
    for (uint32_t i = 0; good && i < level->height; i++) { /* the file begins with the top */
        uint32_t y = loading->resource->top ? i : level->height - 1 - i;
        good = fread(level->texels + y * row, sizeof(float), row, result) == row;
    }
    if (result)
        fclose(result);
    if (!good)
        refuse_input(loading, "%s", heard.reason);
    return good;
}

static size_t row_from_top(const struct loading *loading, const struct picture_level *level,
                           size_t texel)
{
    size_t row = texel / level->width;
    return loading->resource->top ? row : level->height - 1 - row;
}

/* Codes to linear light, where the image has that. */
static bool decode(const struct loading *loading, const struct picture_level *level)
{
    size_t count = (size_t)level->width * level->height;
    for (size_t i = 0; i < CHANNELS * count; i++) {
        if (!isfinite(level->texels[i])) {
            size_t texel = i / CHANNELS;
            return refuse_input(loading, "its texel (%zu, %zu), from the top left, is not finite",
                                texel % level->width, row_from_top(loading, level, texel));
        }
        if (holds_light(loading) && i % CHANNELS < 3)
            level->texels[i] = srgb_decode(level->texels[i]);
    }
    return true;
}

/* How much of the source texel `from` lies under the texel `to`, when `source` become `target`. */
static double overlap(uint32_t from, uint32_t to, uint32_t source, uint32_t target)
{
    double scale = (double)source / target;
    double start = fmax(from, to * scale), end = fmin(from + 1.0, (to + 1) * scale);
    return end > start ? end - start : 0;
}

/* The mean of the area under each texel of the next mip, also where a side is odd. */
static bool shrink_input(const struct picture_level *from, struct picture_level *to)
{
    to->width = from->width > 1 ? from->width / 2 : 1;
    to->height = from->height > 1 ? from->height / 2 : 1;
    to->texels = malloc((size_t)CHANNELS * to->width * to->height * sizeof *to->texels);
    for (uint32_t i = 0; to->texels && i < to->width * to->height; i++) {
        uint32_t x = i % to->width, y = i / to->width;
        double sum[CHANNELS] = {0}, weight = 0;
        uint32_t left = (uint32_t)((uint64_t)x * from->width / to->width);
        uint32_t low = (uint32_t)((uint64_t)y * from->height / to->height);
        for (uint32_t v = low; v < from->height && v < low + 4; v++)
            for (uint32_t u = left; u < from->width && u < left + 4; u++) {
                double part =
                    overlap(u, x, from->width, to->width) * overlap(v, y, from->height, to->height);
                const float *texel = from->texels + CHANNELS * ((size_t)v * from->width + u);
                for (int c = 0; c < CHANNELS; c++)
                    sum[c] += part * (double)texel[c];
                weight += part;
            }
        for (int c = 0; c < CHANNELS; c++)
            to->texels[CHANNELS * (size_t)i + (size_t)c] = (float)(sum[c] / weight);
    }
    return to->texels;
}

/* Texels in the image's format. */
static bool encode_input(const struct loading *loading, const struct picture_level *level,
                         uint32_t mip)
{
    enum dt_format format = loading->resource->format;
    uint32_t channels = format_info(format)->channels, size = format_info(format)->bytes;
    size_t count = (size_t)level->width * level->height;
    struct dt_bytes *bytes = &loading->input->mip[mip];
    *bytes = (struct dt_bytes){.size = count * size, .extent = {level->width, level->height, 1}};
    bytes->data = calloc(count, size);
    if (!bytes->data)
        return refuse_input(loading, "out of memory");
    for (size_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < channels; c++) {
            struct component channel = format_component(format, c);
            float value = level->texels[CHANNELS * i + c];
            if (format == DT_FORMAT_RGBA8_SRGB && c < 3)
                value = srgb_encode(value);
            bool depth = format == DT_FORMAT_D32F && !(value >= 0 && value <= 1);
            if (depth ||
                !number_store(channel.kind, (double)value, bytes->data + i * size + channel.offset))
                return refuse_input(
                    loading,
                    "its texel (%zu, %zu), from the top left, is %.9g, beyond the range of %s",
                    i % level->width, row_from_top(loading, level, i), (double)value,
                    format_info(format)->name);
        }
    return true;
}

static bool fits_image(const struct loading *loading, const struct picture_level *level)
{
    const struct dt_resource *image = loading->resource;
    uint32_t extent[3];
    resource_extent(loading->pipeline->info, loading->input->resource, loading->size, 0, extent);
    if (image->layered)
        return refuse_input(loading, "%s is an array image, and a picture has no layers",
                            image->name);
    if (format_is_integer(image->format))
        return refuse_input(loading, "%s is %s, and a picture has no integers", image->name,
                            format_info(image->format)->name);
    return (level->width == extent[0] && level->height == extent[1]) ||
           refuse_input(loading, "it has %ux%u texels, but %s has %ux%u in a frame of %ux%u",
                        level->width, level->height, image->name, extent[0], extent[1],
                        loading->size[0], loading->size[1]);
}

static bool load_image(const struct loading *loading)
{
    struct picture_level level = {0}, next = {0};
    const char *reason;
    if (!picture_size(loading->file, &level.width, &level.height, &reason))
        return refuse_input(loading, "%s", reason);
    bool good = fits_image(loading, &level) && read_picture(loading, &level) &&
                decode(loading, &level) && encode_input(loading, &level, 0);
    for (uint32_t mip = 1; good && mip < loading->input->mips; mip++) {
        good = shrink_input(&level, &next);
        if (!good)
            refuse_input(loading, "out of memory");
        free(level.texels);
        level = next;
        good = good && encode_input(loading, &level, mip);
    }
    free(level.texels);
    return good;
}

/* ---- Arrays ---------------------------------------------------------------------------------- */

static bool fits_buffer(const struct loading *loading, const struct npy *array)
{
    const struct dt_resource *buffer = loading->resource;
    uint32_t extent[3];
    resource_extent(loading->pipeline->info, loading->input->resource, loading->size, 0, extent);
    const char *misfit = npy_misfit(array, buffer->fields, buffer->field_count);
    if (misfit)
        return refuse_input(loading, "%s", misfit);
    return array->count == extent[0] || refuse_input(loading, "it has %u elements, but %s has %u",
                                                     array->count, buffer->name, extent[0]);
}

/* Places the numbers of one element as std430 lays them out. False: one is not finite. */
static bool place_element(const struct loading *loading, const struct npy *array, size_t index,
                          const uint32_t *numbers, uint8_t *element)
{
    for (uint32_t f = 0; f < array->field_count; f++) {
        const struct npy_field *from = &array->fields[f];
        const struct dt_field *to = &loading->resource->fields[f];
        uint32_t items = to->array_count ? to->array_count : 1, size = from->numbers / items;
        for (uint32_t i = 0; i < from->numbers; i++) {
            float number;
            memcpy(&number, &numbers[i], sizeof number);
            if (from->type == DT_TYPE_FLOAT && !isfinite(number))
                return refuse_input(loading, "its element %zu has a number%s%s that is not finite",
                                    index, *from->name ? " in " : "", from->name);
            memcpy(element + to->offset + i / size * to->array_stride + i % size * sizeof number,
                   &number, sizeof number);
        }
        numbers += from->numbers;
    }
    return true;
}

static bool load_buffer(const struct loading *loading)
{
    struct npy array;
    const char *reason;
    struct dt_bytes *bytes = &loading->input->mip[0];
    size_t stride = loading->resource->stride;
    uint32_t *numbers = npy_read(loading->file, &array, &reason);
    if (!numbers)
        return refuse_input(loading, "%s", reason);
    bool good = fits_buffer(loading, &array);
    if (good) {
        *bytes = (struct dt_bytes){.data = calloc(array.count, stride),
                                   .size = array.count * stride,
                                   .extent = {array.count, 1, 1}};
        good = bytes->data || refuse_input(loading, "out of memory");
    }
    for (size_t i = 0; good && i < array.count; i++)
        good = place_element(loading, &array, i, numbers + i * array.numbers,
                             bytes->data + i * stride);
    free(numbers);
    return good;
}

/* ---- Which file ------------------------------------------------------------------------------ */

static bool names(const char *option, const char *name)
{
    size_t length = strlen(name);
    return strncmp(option, name, length) == 0 && option[length] == '=';
}

/* The file that --input names for it; NULL: none. */
static const char *given_file(const struct setup *setup, const char *name)
{
    for (uint32_t i = 0; i < setup->inputs.count; i++)
        if (names(setup->inputs.items[i], name))
            return setup->inputs.items[i] + strlen(name) + 1;
    return NULL;
}

static bool refuse_option(const struct dt_log *log, const struct dt_pipeline *info,
                          const char *option)
{
    int length = (int)strcspn(option, "=");
    const char **list = calloc(info->resource_count + 1, sizeof *list);
    char *name = strndup(option, (size_t)length);
    size_t count = 0;
    for (uint32_t i = 0; list && i < info->resource_count; i++)
        if (info->resources[i].input && !info->resources[i].file)
            list[count++] = info->resources[i].name;
    report_error(log, "input %s: %s has no such input%s", option, info->name,
                 name_hint('"', name, list, count, "").text);
    free(name);
    free(list);
    return false;
}

/* Every --input is of an input, once, that has no file in the spec. */
static bool check_input_options(const struct pipeline *pipeline, const struct setup *setup,
                                const struct dt_log *log)
{
    const struct dt_pipeline *info = pipeline->info;
    for (uint32_t i = 0; i < setup->inputs.count; i++) {
        const char *option = setup->inputs.items[i];
        const struct dt_resource *found = NULL;
        for (uint32_t k = 0; k < info->resource_count; k++)
            if (info->resources[k].input && names(option, info->resources[k].name))
                found = &info->resources[k];
        if (!found)
            return refuse_option(log, info, option);
        if (found->file)
            return report_error(
                log,
                "input %s: the spec has a file for it; set %s.%s.file=FILE instead, where "
                "FILE is absolute or relative to the spec's folder",
                option, found->kind == DT_IMAGE ? "images" : "buffers", found->name);
        for (uint32_t k = 0; k < i; k++)
            if (names(setup->inputs.items[k], found->name))
                return report_error(log, "input %s: %s has a file already", option, found->name);
    }
    return true;
}

/* Whether the image has the size of every frame; *follows: whether its size, or the count of a
 * buffer, depends on the frame's. */
static bool fills_frame(const struct dt_pipeline *info, uint32_t resource, bool *follows)
{
    const uint32_t sizes[2][2] = {{1, 2}, {4099, 2053}};
    uint32_t extents[2][3];
    bool fills = info->resources[resource].kind == DT_IMAGE;
    for (int i = 0; i < 2; i++) {
        resource_extent(info, resource, sizes[i], 0, extents[i]);
        fills &= memcmp(extents[i], sizes[i], sizeof sizes[i]) == 0;
    }
    *follows = memcmp(extents[0], extents[1], sizeof *extents) != 0;
    return fills;
}

/* The frame gets the size of the first --input that fills it, and keeps its size where that of any
 * --input follows it. A wrong file is reported later. */
static void find_size(struct pipeline *pipeline, struct setup *setup)
{
    const struct dt_pipeline *info = pipeline->info;
    bool filled = !setup->default_size, fixed = false, follows;
    for (uint32_t i = 0; i < setup->inputs.count; i++)
        for (uint32_t k = 0; k < info->resource_count; k++) {
            const char *option = setup->inputs.items[i], *reason;
            uint32_t size[2];
            if (!names(option, info->resources[k].name))
                continue;
            if (fills_frame(info, k, &follows) && !filled) {
                filled = true;
                if (picture_size(strchr(option, '=') + 1, &size[0], &size[1], &reason))
                    memcpy(setup->size, size, sizeof size);
            }
            fixed |= follows;
        }
    if (fixed)
        memcpy(pipeline->frame_size, setup->size, sizeof setup->size);
}

bool inputs_find_size(struct pipeline *pipeline, struct setup *setup, const struct dt_log *log)
{
    bool good = check_input_options(pipeline, setup, log);
    if (good)
        find_size(pipeline, setup);
    return good;
}

/* ---- All ------------------------------------------------------------------------------------- */

static bool load_input(struct loading *loading)
{
    return loading->resource->kind == DT_IMAGE ? load_image(loading) : load_buffer(loading);
}

static void add_hash(struct pipeline *pipeline, const struct loading *loading)
{
    struct input_hash *hash = &pipeline->input_hashes[pipeline->input_hash_count++];
    *hash = (struct input_hash){loading->resource->name, FILE_HASH_START};
    for (uint32_t mip = 0; mip < loading->input->mips; mip++)
        hash_bytes(&hash->hash, loading->input->mip[mip].data, loading->input->mip[mip].size);
}

static bool load_resource(struct pipeline *pipeline, struct console *console,
                          const struct setup *setup, uint32_t index)
{
    const struct dt_resource *resource = &pipeline->info->resources[index];
    struct plan_input from = plan_input(pipeline->plan, index);
    const char *given = given_file(setup, resource->name);
    struct input *input = &pipeline->inputs[pipeline->input_count++];
    *input =
        (struct input){.resource = index, .mips = resource->kind == DT_IMAGE ? resource->mips : 1};
    struct loading loading = {.console = console,
                              .pipeline = pipeline,
                              .resource = resource,
                              .input = input,
                              .size = setup->size,
                              .file = given ? given : from.file,
                              .by_option = given,
                              .srgb = from.srgb,
                              .encoding_is_given = from.encoding_is_given};
    if (loading.file) {
        bool good = load_input(&loading);
        if (good && given)
            add_hash(pipeline, &loading);
        return good;
    }
    if (setup->inputs_later) {
        pipeline->input_count--;
        return true;
    }
    return report_error(&console->log, "%s: the input %s has no content; give the input %s=FILE",
                        pipeline->info->name, resource->name, resource->name);
}

bool inputs_load(struct pipeline *pipeline, struct console *console, struct setup *setup)
{
    const struct dt_pipeline *info = pipeline->info;
    if (!inputs_find_size(pipeline, setup, &console->log))
        return false;
    pipeline->inputs = calloc(info->resource_count + 1, sizeof *pipeline->inputs);
    pipeline->input_hashes = calloc(info->resource_count + 1, sizeof *pipeline->input_hashes);
    bool good = pipeline->inputs && pipeline->input_hashes;
    if (!good)
        report_error(&console->log, "out of memory");
    for (uint32_t i = 0; good && i < info->resource_count; i++)
        if (info->resources[i].input)
            good = load_resource(pipeline, console, setup, i);
    return good;
}

/* ---- To a runtime ---------------------------------------------------------------------------- */

static bool write_zeros(const struct pipeline *pipeline, const struct dt_runtime *runtime,
                        void *handle, const uint32_t size[2], uint32_t index)
{
    const struct dt_resource *resource = &pipeline->info->resources[index];
    bool good = true;
    for (uint32_t mip = 0; good && mip < (resource->kind == DT_IMAGE ? resource->mips : 1); mip++) {
        struct dt_bytes bytes;
        resource_extent(pipeline->info, index, size, mip, bytes.extent);
        bytes.size = resource_elements(resource, bytes.extent) * resource_stride(resource);
        bytes.data = calloc(1, bytes.size);
        good = bytes.data && runtime->write(handle, index, mip, &bytes);
        free(bytes.data);
    }
    return good;
}

bool inputs_write(const struct pipeline *pipeline, const struct dt_runtime *runtime, void *handle,
                  const uint32_t size[2])
{
    bool good = true;
    for (uint32_t i = 0; !pipeline->inputs && good && i < pipeline->info->resource_count; i++)
        if (pipeline->info->resources[i].input)
            good = write_zeros(pipeline, runtime, handle, size, i);
    for (uint32_t i = 0; pipeline->inputs && good && i < pipeline->input_count; i++) {
        const struct input *input = &pipeline->inputs[i];
        for (uint32_t mip = 0; good && mip < input->mips; mip++)
            good = !input->mip[mip].data ||
                   runtime->write(handle, input->resource, mip, &input->mip[mip]);
    }
    return good;
}
