/* Writes resources as .npy; see array.h. */
#include "picture/array.h"

#include <stdlib.h>

#include "base/files.h"
#include "base/text.h"
#include "console/console.h"
#include "picture/texels.h"

/* The elements of a buffer with its fields, without padding. */
static void add_fields(struct text *type, const struct dt_resource *resource)
{
    text_add(type, "[");
    for (uint32_t i = 0; i < resource->field_count; i++) {
        const struct dt_field *field = &resource->fields[i];
        enum dt_type scalar = type_info(field->type)->scalar;
        const char *code = scalar == DT_TYPE_FLOAT ? "<f4" : scalar == DT_TYPE_INT ? "<i4" : "<u4";
        uint32_t numbers = type_components(field->type);
        text_add(type, "('%s', '%s', (", *field->name ? field->name : "value", code);
        if (field->array_count)
            text_add(type, "%u,", field->array_count);
        if (field->type == DT_TYPE_MAT4)
            text_add(type, "4,4,");
        else if (numbers > 1)
            text_add(type, "%u,", numbers);
        text_add(type, ")), ");
    }
    text_add(type, "]");
}

/* Codes of unorm and snorm stay codes; packed floats become float. */
static void add_number_code(struct text *type, enum number_kind kind)
{
    uint32_t size = number_size(kind);
    bool is_float = number_is_float(kind) || number_is_packed(kind);
    text_add(type, "'%c%c%u'", size > 1 ? '<' : '|',
             is_float                 ? 'f'
             : number_is_signed(kind) ? 'i'
                                      : 'u',
             size);
}

static void add_array_head(struct text *out, const struct dt_resource *resource,
                           const struct component *first, uint32_t count, const uint32_t extent[3])
{
    struct text type = {0}, head = {0};
    if (resource->kind == DT_BUFFER)
        add_fields(&type, resource);
    else
        add_number_code(&type, first->kind);
    text_add(&head, "{'descr': %s, 'fortran_order': False, 'shape': (", type.data ? type.data : "");
    if (resource->kind == DT_BUFFER)
        text_add(&head, "%u,), }", extent[0]);
    else
        text_add(&head, "%u, %u, %u, %u), }", extent[2], extent[1], extent[0], count);
    while ((10 + head.length + 1) % 64)
        text_add(&head, " ");
    text_add(&head, "\n");
    const char length[2] = {(char)(head.length & 255), (char)(head.length >> 8)};
    text_add_bytes(out, "\x93NUMPY\x01\x00", 8);
    text_add_bytes(out, length, 2);
    text_add_bytes(out, head.data ? head.data : "", head.length);
    out->failed |= type.failed || head.failed;
    text_free(&type);
    text_free(&head);
}

bool array_write(const char *path, const struct dt_resource *resource, const struct dt_bytes *bytes,
                 const struct dt_log *log)
{
    struct component *list = NULL;
    uint32_t count = resource_components(resource, &list), stride = resource_stride(resource);
    struct text out = {0};
    if (count)
        add_array_head(&out, resource, list, count, bytes->extent);
    for (size_t at = 0; count && at + stride <= bytes->size && !out.failed; at += stride)
        for (uint32_t i = 0; i < count; i++) {
            const uint8_t *place = bytes->data + at + list[i].offset;
            float number = (float)number_value(list[i].kind, place);
            bool packed = number_is_packed(list[i].kind);
            text_add_bytes(&out, packed ? (const char *)&number : (const char *)place,
                           packed ? sizeof number : number_size(list[i].kind));
        }
    bool good = count && !out.failed;
    if (!good)
        report_error(log, "%s: out of memory", path);
    good = good && file_write(path, out.data, out.length, log);
    text_free(&out);
    free(list);
    return good;
}
