/* What your renderer leaves after each pass, as a folder that `diptych compare A B` reads. One header, C99
 * and C++11, no library. Include it once per backend:
 *
 *     struct tap *tap = tap_open("vk", "vulkan", NULL);       (folder, label, device)
 *     struct tap_texels texels = {0};
 *     texels.format = "rgba16f";
 *     texels.width = 640, texels.height = 360;
 *     texels.origin = TAP_TOP;                                (where row 0 is)
 *     texels.bytes = pixels;
 *     tap_image(tap, "lighting", "radiance", &texels);
 *     struct tap_field fields[] = {{"position", "vec3", 0, 0, 0}, {"power", "float", 12, 0, 0}};
 *     tap_buffer(tap, "lighting", "lights", lights, count, 16, fields, 2);
 *     if (!tap_close(tap)) ...                                (the folder has no manifest)
 *
 * The origin is that of your memory: where y grows upwards from row 0, as in OpenGL's textures and many software
 * renderers, it is TAP_BOTTOM. Buffers that a screen's y indexes are compared as they are. Formats may differ between two renderers, and layouts of fields; sizes may not. More than
 * one frame: tap_frame before each, with the same numbers in both.
 *
 * Use the same names of passes and resources in both renderers. Call in the order of execution, from one
 * thread. diptych_tap_gl.h and diptych_tap_vk.h read textures and buffers back. Failures are printed once,
 * on stderr, and returned by tap_close; a NULL tap ignores all calls, so that taps can stay in the code.
 *
 * The folder: manifest.json, which appears last, and one raw little-endian file per resource and mip, rows
 * and layers without padding. templates/dump.schema.json describes the manifest, version 1. */
#ifndef DIPTYCH_TAP_H
#define DIPTYCH_TAP_H

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <direct.h>
#else
#include <sys/stat.h>
#endif

#ifdef __GNUC__
#define TAP_FUNCTION static __attribute__((unused))
#else
#define TAP_FUNCTION static
#endif

/* Not TAP_UNKNOWN: where dumps differ, compare turns the rows of one over. */
enum tap_origin { TAP_UNKNOWN, TAP_TOP, TAP_BOTTOM };

struct tap_texels {
    /* r8 rg8 rgba8 rgba8_srgb, r16 rg16 rgba16 (also _snorm), r16f rg16f rgba16f, r32f rg32f rgba32f, d32f,
     * r8ui rg8ui rgba8ui, the same with 16 and 32, and with i for ui; r11g11b10f, rgb10a2, rgb8,
     * bgra8 (also _srgb); d16, d24, d24s8 (depth in the low 24 bits), d32fs8 (of 8 bytes). */
    const char *format;
    unsigned width, height;
    unsigned layers;  /* or depth, or six faces for each cube; 0 counts as 1 */
    unsigned samples; /* pictures in each layer, one for each sample of a texel; 0 counts as 1 */
    unsigned mip;
    enum tap_origin origin;
    const void *bytes;
    size_t stride, layer_stride; /* bytes from row to row, from layer to layer; 0: no padding */
};

struct tap_field {
    const char *name; /* "" for a plain scalar or vector */
    const char *type; /* float vec2 vec3 vec4, int ivec2.., uint uvec2.., bool, mat4 */
    unsigned offset;  /* bytes from the start of the element */
    unsigned array_count, array_stride; /* 0: no array */
};

struct tap {
    char *folder, *entries;
    size_t length;
    unsigned count, frame;
    int failed;
};

TAP_FUNCTION void tap_fail(struct tap *tap, const char *what, const char *name)
{
    if (!tap->failed)
        fprintf(stderr, "diptych tap: %s: %s: %s\n", tap->folder ? tap->folder : "?", name, what);
    tap->failed = 1;
}

/* ---- Text --------------------------------------------------------------------------------------- */

TAP_FUNCTION void tap_write(struct tap *tap, const char *text, size_t size)
{
    char *more = (char *)realloc(tap->entries, tap->length + size + 1);
    if (!more) {
        tap_fail(tap, "out of memory", "manifest.json");
        return;
    }
    memcpy(more + tap->length, text, size);
    tap->entries = more;
    tap->length += size;
    more[tap->length] = 0;
}

#ifdef __GNUC__
__attribute__((format(printf, 2, 3)))
#endif
TAP_FUNCTION void
tap_print(struct tap *tap, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    tap_write(tap, text, strlen(text));
}

/* A JSON string. */
TAP_FUNCTION void tap_quote(struct tap *tap, const char *key, const char *text)
{
    tap_print(tap, "\"%s\": \"", key);
    for (; *text; text++)
        if ((unsigned char)*text < 32 || *text == '"' || *text == '\\')
            tap_print(tap, "\\u%04x", (unsigned char)*text);
        else
            tap_write(tap, text, 1);
    tap_write(tap, "\"", 1);
}

/* ---- Files -------------------------------------------------------------------------------------- */

TAP_FUNCTION char *tap_path(const struct tap *tap, const char *name)
{
    size_t size = strlen(tap->folder) + strlen(name) + 2;
    char *path = (char *)malloc(size);
    if (path)
        snprintf(path, size, "%s/%s", tap->folder, name);
    return path;
}

/* Puts _ for what is no letter, digit, dot, +, - or _. */
TAP_FUNCTION void tap_clean(char *name)
{
    for (char *c = name; *c; c++)
        if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.+", *c))
            *c = '_';
}

/* "0003.lighting.radiance.raw". */
TAP_FUNCTION void tap_name(const struct tap *tap, const char *pass, const char *resource,
                           char *name, size_t size)
{
    snprintf(name, size, "%04u.%.80s.%.80s.raw", tap->count, pass, resource);
    tap_clean(name);
}

/* `rows` rows of `size` bytes, `stride` bytes apart, in each layer. */
TAP_FUNCTION int tap_store(struct tap *tap, const char *name, const unsigned char *bytes,
                           size_t size, size_t rows, size_t stride, size_t layers,
                           size_t layer_stride)
{
    char *path = tap_path(tap, name);
    FILE *file = path ? fopen(path, "wb") : NULL;
    int good = file != NULL;
    for (size_t layer = 0; layer < layers && good; layer++)
        for (size_t row = 0; row < rows && good; row++)
            good = fwrite(bytes + layer * layer_stride + row * stride, 1, size, file) == size;
    if (file && fclose(file) != 0)
        good = 0;
    if (!good)
        tap_fail(tap, strerror(errno), name);
    free(path);
    return good;
}

/* Begins an entry of the manifest. */
TAP_FUNCTION void tap_entry(struct tap *tap, const char *pass, const char *resource,
                            const char *file)
{
    tap_print(tap, "%s\n  {", tap->count ? "," : "");
    tap_quote(tap, "pass", pass);
    tap_write(tap, ", ", 2);
    tap_quote(tap, "resource", resource);
    tap_write(tap, ", ", 2);
    tap_quote(tap, "file", file);
    if (tap->frame)
        tap_print(tap, ", \"frame\": %u", tap->frame);
    tap->count++;
}

/* ---- For you ------------------------------------------------------------------------------------ */

/* Makes the folder where it is missing, in a folder that is there; an earlier dump in it is replaced. `label` names this
 * side in tables, `device` may be NULL. NULL: the reason was printed, and tap_close will have nothing to tell. */
TAP_FUNCTION struct tap *tap_open(const char *folder, const char *label, const char *device)
{
    struct tap *tap = (struct tap *)calloc(1, sizeof *tap);
    char *manifest;
    if (!tap)
        return NULL;
    tap->folder = (char *)malloc(strlen(folder) + 1);
    if (tap->folder)
        strcpy(tap->folder, folder);
#ifdef _WIN32
    if (tap->folder && _mkdir(folder) != 0 && errno != EEXIST)
#else
    if (tap->folder && mkdir(folder, 0777) != 0 && errno != EEXIST)
#endif
        tap_fail(tap, strerror(errno), "cannot be made");
    manifest = tap->folder ? tap_path(tap, "manifest.json") : NULL;
    if (manifest && remove(manifest) != 0 && errno != ENOENT)
        tap_fail(tap, strerror(errno), "manifest.json");
    tap_write(tap, "{\"version\": 1, ", 15);
    tap_quote(tap, "backend", label);
    tap_write(tap, ", ", 2);
    tap_quote(tap, "device", device ? device : "");
    tap_print(tap, ", \"entries\": [");
    if (!manifest || tap->failed) {
        free(manifest);
        free(tap->entries);
        free(tap->folder);
        free(tap);
        return NULL;
    }
    free(manifest);
    return tap;
}

/* What follows is of this frame, from 0. Not needed for one frame. */
TAP_FUNCTION void tap_frame(struct tap *tap, unsigned frame)
{
    if (tap)
        tap->frame = frame;
}

/* Bytes of a texel; 0: no such format. */
TAP_FUNCTION size_t tap_texel_size(const char *format)
{
    static const char *const names[] = {
        " r8 r8ui r8i ", " rg8 rg8ui rg8i r16 r16_snorm r16f r16ui r16i d16 ",
        " rgba8 rgba8_srgb rgba8ui rgba8i rg16 rg16_snorm rg16f rg16ui rg16i r32f r32ui r32i d32f "
        "r11g11b10f r11g11b10 rgb10a2 bgra8 bgra8_srgb d24 d24s8 ",
        " rgba16 rgba16_snorm rgba16f rgba16ui rgba16i rg32f rg32ui rg32i d32fs8 ",
        " rgba32f rgba32ui rgba32i "};
    char word[24];
    if (strcmp(format, "rgb8") == 0 || strcmp(format, "rgb8_srgb") == 0)
        return 3;
    snprintf(word, sizeof word, " %.20s ", format);
    for (int i = 0; i < 5; i++)
        if (strstr(names[i], word))
            return (size_t)1 << i;
    return 0;
}

/* Makes rgba8 of bgra8, and the other way round. */
TAP_FUNCTION void tap_swap_bgra(void *texels, size_t count)
{
    unsigned char *bytes = (unsigned char *)texels;
    for (size_t i = 0; i < count; i++) {
        unsigned char kept = bytes[4 * i];
        bytes[4 * i] = bytes[4 * i + 2];
        bytes[4 * i + 2] = kept;
    }
}

/* One mip of an image, as it is after the pass. */
TAP_FUNCTION void tap_image(struct tap *tap, const char *pass, const char *resource,
                            const struct tap_texels *texels)
{
    char name[200];
    size_t layers = texels->layers ? texels->layers : 1;
    size_t samples = texels->samples ? texels->samples : 1, texel = tap_texel_size(texels->format);
    size_t row = texel * texels->width, stride = texels->stride ? texels->stride : row;
    if (!tap || tap->failed)
        return;
    if (!texel || !texels->bytes || !texels->width || !texels->height || stride < row) {
        tap_fail(tap,
                 !texel ? "has an unknown format"
                        : "has no bytes, no size, or a stride below a row",
                 resource);
        return;
    }
    tap_name(tap, pass, resource, name, sizeof name);
    if (!tap_store(tap, name, (const unsigned char *)texels->bytes, row, texels->height, stride,
                   layers * samples,
                   texels->layer_stride ? texels->layer_stride : stride * texels->height))
        return;
    tap_entry(tap, pass, resource, name);
    if (texels->mip)
        tap_print(tap, ", \"mip\": %u", texels->mip);
    tap_print(tap, ", \"kind\": \"image\", \"format\": \"%s\", \"stride\": %u", texels->format,
              (unsigned)texel);
    tap_print(tap, ", \"width\": %u, \"height\": %u, \"layers\": %u", texels->width, texels->height,
              (unsigned)layers);
    if (samples > 1)
        tap_print(tap, ", \"samples\": %u", (unsigned)samples);
    if (texels->origin)
        tap_print(tap, ", \"origin\": \"%s\"", texels->origin == TAP_TOP ? "top" : "bottom");
    tap_write(tap, "}", 1);
}

/* Bytes of a field's type; 0: no such type. */
TAP_FUNCTION size_t tap_type_size(const char *type)
{
    static const char *const names[] = {" float int uint bool ", " vec2 ivec2 uvec2 ",
                                        " vec3 ivec3 uvec3 ", " vec4 ivec4 uvec4 "};
    char word[24];
    if (strcmp(type, "mat4") == 0)
        return 64;
    snprintf(word, sizeof word, " %.20s ", type);
    for (int i = 0; i < 4; i++)
        if (strstr(names[i], word))
            return 4 * ((size_t)i + 1);
    return 0;
}

/* Whether all fields lie in an element; the reason was printed. */
TAP_FUNCTION int tap_fields_fit(struct tap *tap, unsigned stride, const struct tap_field *fields,
                                unsigned field_count)
{
    for (unsigned i = 0; i < field_count; i++) {
        const struct tap_field *field = &fields[i];
        size_t size = tap_type_size(field->type), end = field->offset + size;
        if (field->array_count)
            end += (field->array_count - (size_t)1) * field->array_stride;
        if (!size || end > stride) {
            tap_fail(tap, !size ? "a field of an unknown type" : "a field beyond the stride",
                     field->name);
            return 0;
        }
    }
    return 1;
}

/* `count` elements of `stride` bytes; only the fields are compared, by name. */
TAP_FUNCTION void tap_buffer(struct tap *tap, const char *pass, const char *resource,
                             const void *bytes, unsigned count, unsigned stride,
                             const struct tap_field *fields, unsigned field_count)
{
    char name[200];
    if (!tap || tap->failed || !tap_fields_fit(tap, stride, fields, field_count))
        return;
    if (!bytes && count) {
        tap_fail(tap, "has no bytes", resource);
        return;
    }
    tap_name(tap, pass, resource, name, sizeof name);
    if (!tap_store(tap, name, (const unsigned char *)bytes, stride, count, stride, 1, 0))
        return;
    tap_entry(tap, pass, resource, name);
    tap_print(tap, ", \"kind\": \"buffer\", \"count\": %u, \"stride\": %u, \"fields\": [", count,
              stride);
    for (unsigned i = 0; i < field_count; i++) {
        tap_print(tap, "%s{", i ? ", " : "");
        tap_quote(tap, "name", fields[i].name);
        tap_write(tap, ", ", 2);
        tap_quote(tap, "type", fields[i].type);
        tap_print(tap, ", \"offset\": %u", fields[i].offset);
        if (fields[i].array_count)
            tap_print(tap, ", \"array_count\": %u, \"array_stride\": %u", fields[i].array_count,
                      fields[i].array_stride);
        tap_write(tap, "}", 1);
    }
    tap_write(tap, "]}", 2);
}

/* Writes the manifest and frees the tap. 0: something failed, and the folder is no dump. */
TAP_FUNCTION int tap_close(struct tap *tap)
{
    char *part, *path;
    int good;
    if (!tap)
        return 1;
    tap_write(tap, "\n]}\n", 4);
    part = tap_path(tap, "manifest.json.part");
    path = tap_path(tap, "manifest.json");
    if (!part || !path)
        tap_fail(tap, "out of memory", "manifest.json");
    if (!tap->failed &&
        tap_store(tap, "manifest.json.part", (const unsigned char *)tap->entries, tap->length, 1, 0,
                  1, 0) &&
        rename(part, path) != 0)
        tap_fail(tap, strerror(errno), "manifest.json");
    good = !tap->failed;
    free(part);
    free(path);
    free(tap->entries);
    free(tap->folder);
    free(tap);
    return good;
}

#endif
