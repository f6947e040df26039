/* Two copies of a resource from different renderers in one form; see dumps.h. */
#include <stdlib.h>
#include <string.h>

#include "scenes/srgb.h"
#include "theirs/dumps.h"
#include "formats.h"

/* Adds a sentence to the note. */
static void add_note(struct match *match, char *text)
{
    if (!match->note) {
        match->note = text;
        return;
    }
    char *both = text ? format_string("%s; %s", match->note, text) : NULL;
    free(match->note);
    free(text);
    match->note = both;
}

static bool refuse(struct match *match, char *text)
{
    free(match->note);
    match->note = text;
    return false;
}

/* ---- Buffers ----------------------------------------------------------------------------------- */

static const struct dt_field *find_their_field(const struct dt_resource *resource, const char *name)
{
    for (uint32_t i = 0; i < resource->field_count; i++)
        if (!strcmp(resource->fields[i].name, name))
            return &resource->fields[i];
    return NULL;
}

static bool same_layout(const struct dt_resource *a, const struct dt_resource *b)
{
    bool same = a->stride == b->stride && a->field_count == b->field_count;
    for (uint32_t i = 0; same && i < a->field_count; i++) {
        const struct dt_field *f = &a->fields[i], *g = find_their_field(b, f->name);
        same = g && f->type == g->type && f->offset == g->offset &&
               f->array_count == g->array_count && f->array_stride == g->array_stride;
    }
    return same;
}

/* One field of all elements from one layout into another. */
static void move_field(const struct dt_field *from, const struct dt_field *to, uint32_t from_stride,
                       uint32_t to_stride, uint32_t count, const uint8_t *source, uint8_t *target)
{
    uint32_t items = to->array_count ? to->array_count : 1, size = 4 * type_components(to->type);
    for (uint64_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < items; k++)
            memcpy(target + i * to_stride + to->offset + k * to->array_stride,
                   source + i * from_stride + from->offset + k * from->array_stride, size);
}

/* Brings a copy into another layout. False: *missing is a field without an equal, or NULL when out of memory. */
static bool to_layout(struct dt_bytes *bytes, const struct dt_resource *from,
                      const struct dt_resource *to, const char **missing)
{
    uint8_t *moved = calloc(bytes->extent[0], to->stride);
    bool good = moved;
    *missing = NULL;
    for (uint32_t i = 0; i < to->field_count && good; i++) {
        const struct dt_field *field = &to->fields[i];
        const struct dt_field *source = find_their_field(from, field->name);
        good = source && source->type == field->type && source->array_count == field->array_count;
        if (good)
            move_field(source, field, from->stride, to->stride, bytes->extent[0], bytes->data,
                       moved);
        else
            *missing = field->name;
    }
    free(good ? bytes->data : moved);
    if (good) {
        bytes->data = moved;
        bytes->size = (size_t)bytes->extent[0] * to->stride;
    }
    return good;
}

static bool convert_buffers(struct match *match, struct dt_bytes copies[2])
{
    const struct dt_resource *a = &match->sides[0]->what, *b = &match->sides[1]->what;
    const char *missing;
    match->what = *a;
    if (same_layout(a, b))
        return true;
    if (!to_layout(&copies[1], b, a, &missing))
        return refuse(
            match, missing ? format_string("field \"%s\" has no equal in the second dump", missing)
                           : NULL);
    add_note(match, format_string("fields matched by name: %u and %u bytes from element to element",
                                  a->stride, b->stride));
    return true;
}

/* ---- Images ------------------------------------------------------------------------------------ */

/* Bits of a number's fraction, by which formats are ordered. */
static uint32_t precision(enum number_kind kind)
{
    return kind == NUMBER_HALF                          ? 11
           : kind >= NUMBER_R11F && kind <= NUMBER_B10F ? 6
                                                        : number_width(kind);
}

static bool find_format(uint32_t channels, enum number_kind kind, enum dt_format *format)
{
    for (int i = 0; i < FORMAT_ALL; i++) {
        enum dt_format each = (enum dt_format)i;
        if (format_info(each)->channels == channels && format_info(each)->kind == kind &&
            each != DT_FORMAT_RGBA8_SRGB && (kind == NUMBER_UNORM24 || !format_is_depth(each))) {
            *format = each;
            return true;
        }
    }
    return false;
}

static bool to_format(struct dt_bytes *bytes, const struct dt_resource *from,
                      const struct dt_resource *to)
{
    uint64_t count = resource_elements(from, bytes->extent);
    uint32_t strides[2] = {resource_stride(from), resource_stride(to)};
    uint32_t channels = format_info(to->format)->channels;
    bool srgb = from->format == DT_FORMAT_RGBA8_SRGB && to->format != DT_FORMAT_RGBA8;
    uint8_t *data = calloc(count, strides[1]);
    for (uint64_t i = 0; data && i < count; i++)
        for (uint32_t c = 0; c < channels; c++) {
            struct component source = format_component(from->format, c);
            struct component target = format_component(to->format, c);
            double value = number_value(source.kind, bytes->data + i * strides[0] + source.offset);
            their_store(target.kind, srgb && c < 3 ? srgb_light(value) : value,
                        data + i * strides[1] + target.offset);
        }
    if (!data)
        return false;
    free(bytes->data);
    bytes->data = data;
    bytes->size = count * strides[1];
    return true;
}

static bool convert_formats(struct match *match, struct dt_bytes copies[2])
{
    const struct dt_resource *sides[2] = {&match->sides[0]->what, &match->sides[1]->what};
    enum number_kind kinds[2] = {format_info(sides[0]->format)->kind,
                                 format_info(sides[1]->format)->kind};
    uint32_t channels[2] = {format_info(sides[0]->format)->channels,
                            format_info(sides[1]->format)->channels};
    match->what = *sides[0];
    if (sides[0]->format == sides[1]->format)
        return true;
    const char *const names[2] = {format_info(sides[0]->format)->name,
                                  format_info(sides[1]->format)->name};
    if (number_is_integer(kinds[0]) != number_is_integer(kinds[1]))
        return refuse(match, format_string("formats %s and %s: integers have no counterpart",
                                           names[0], names[1]));
    uint32_t least = channels[0] < channels[1] ? channels[0] : channels[1];
    enum number_kind kind = precision(kinds[0]) <= precision(kinds[1]) ? kinds[0] : kinds[1];
    if (kinds[0] == kinds[1] && channels[0] == channels[1])
        match->what.format =
            sides[0]->format == DT_FORMAT_RGBA8_SRGB ? sides[1]->format : sides[0]->format;
    else if (!find_format(least, kind, &match->what.format) &&
             !find_format(least, NUMBER_FLOAT, &match->what.format))
        return refuse(match,
                      format_string("formats %s and %s have no common one", names[0], names[1]));
    for (int i = 0; i < 2; i++)
        if (sides[i]->format != match->what.format &&
            !to_format(&copies[i], sides[i], &match->what))
            return refuse(match, NULL);
    add_note(match, format_string("formats %s and %s, compared as %s", names[0], names[1],
                                  format_info(match->what.format)->name));
    return true;
}

static void flip_rows(const struct dt_resource *resource, struct dt_bytes *bytes)
{
    size_t row = (size_t)bytes->extent[0] * resource_stride(resource);
    uint32_t height = bytes->extent[1];
    for (uint64_t layer = 0; layer < bytes->extent[2]; layer++)
        for (uint32_t y = 0; y < height / 2; y++) {
            uint8_t *a = bytes->data + (layer * height + y) * row;
            uint8_t *b = bytes->data + (layer * height + height - 1 - y) * row;
            for (size_t i = 0; i < row; i++) {
                uint8_t kept = a[i];
                a[i] = b[i];
                b[i] = kept;
            }
        }
}

static bool convert_images(struct match *match, struct dt_bytes copies[2])
{
    enum their_origin a = match->sides[0]->origin, b = match->sides[1]->origin;
    if (!convert_formats(match, copies))
        return false;
    if (a && b && a != b) {
        flip_rows(&match->what, &copies[1]);
        add_note(match, format_string("row 0 is the %s here, the %s there: rows turned over",
                                      a == ORIGIN_TOP ? "top" : "bottom",
                                      a == ORIGIN_TOP ? "bottom" : "top"));
    }
    return true;
}

/* What is often wrong where sizes differ. */
static const char *size_hint(const uint32_t *a, const uint32_t *b)
{
    if (a[0] == b[1] && a[1] == b[0] && a[0] != a[1])
        return ": width and height in each other's place?";
    if (a[2] != b[2])
        return "";
    bool finer = (a[0] == b[0] / 2 && a[1] == b[1] / 2) || (b[0] == a[0] / 2 && b[1] == a[1] / 2);
    bool near = a[0] - b[0] + 1 <= 2 && a[1] - b[1] + 1 <= 2;
    return finer ? ": one mip off, or half the resolution?" : near ? ": an odd size rounded?" : "";
}

static bool same_extent(const struct match *match, const struct dt_bytes copies[2])
{
    bool buffer = match->sides[0]->what.kind == DT_BUFFER;
    return !memcmp(copies[0].extent, copies[1].extent, (buffer ? 1 : 3) * sizeof(uint32_t));
}

bool dumps_convert(struct match *match, struct dt_bytes copies[2])
{
    const struct their_entry *const *sides = (const struct their_entry *const *)match->sides;
    bool buffer = sides[0]->what.kind == DT_BUFFER;
    for (int i = 0; i < 2; i++)
        if (sides[i]->read_as)
            add_note(match, strdup(sides[i]->read_as));
    if (sides[0]->what.kind != sides[1]->what.kind)
        return refuse(match, strdup("a buffer here, an image there"));
    if (!same_extent(match, copies)) {
        const uint32_t *a = copies[0].extent, *b = copies[1].extent;
        return refuse(match, buffer ? format_string("%u elements against %u", a[0], b[0])
                                    : format_string("%ux%ux%u against %ux%ux%u texels%s", a[0],
                                                    a[1], a[2], b[0], b[1], b[2], size_hint(a, b)));
    }
    return buffer ? convert_buffers(match, copies) : convert_images(match, copies);
}
