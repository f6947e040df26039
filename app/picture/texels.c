/* Types and formats as tables; see texels.h. */
#include "picture/texels.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"

bool format_is_depth(enum dt_format format)
{
    return format == DT_FORMAT_D32F || (int)format >= FORMAT_D16;
}

struct component format_component(enum dt_format format, uint32_t channel)
{
    enum number_kind kind = format_info(format)->kind;
    struct component component = {.kind = kind, .offset = channel * number_size(kind)};
    if (number_is_packed(kind))
        component = (struct component){.kind = (enum number_kind)(kind + channel)};
    component.name[0] = format_is_depth(format) ? 'd' : "rgba"[channel];
    return component;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static const struct {
    uint8_t bytes, shift, width; /* the number: `width` bits from `shift` on */
    double least, most;
} numbers[] = {
    [NUMBER_UNORM8] = {1, 0, 8, 0, 1},
    [NUMBER_UNORM16] = {2, 0, 16, 0, 1},
    [NUMBER_UNORM24] = {4, 0, 24, 0, 1},
    [NUMBER_SNORM16] = {2, 0, 16, -1, 1},
    [NUMBER_HALF] = {2, 0, 16, -65519.99, 65519.99},
    [NUMBER_FLOAT] = {4, 0, 32, -FLT_MAX, FLT_MAX},
    [NUMBER_R11F] = {4, 0, 11, 0, 65279.99},
    [NUMBER_G11F] = {4, 11, 11, 0, 65279.99},
    [NUMBER_B10F] = {4, 22, 10, 0, 65023.99},
    [NUMBER_R10] = {4, 0, 10, 0, 1},
    [NUMBER_G10] = {4, 10, 10, 0, 1},
    [NUMBER_B10] = {4, 20, 10, 0, 1},
    [NUMBER_A2] = {4, 30, 2, 0, 1},
    [NUMBER_UINT] = {4, 0, 32, 0, UINT32_MAX},
    [NUMBER_INT] = {4, 0, 32, INT32_MIN, INT32_MAX},
    [NUMBER_UINT8] = {1, 0, 8, 0, UINT8_MAX},
    [NUMBER_INT8] = {1, 0, 8, INT8_MIN, INT8_MAX},
    [NUMBER_UINT16] = {2, 0, 16, 0, UINT16_MAX},
    [NUMBER_INT16] = {2, 0, 16, INT16_MIN, INT16_MAX},
};

uint32_t number_size(enum number_kind kind)
{
    return numbers[kind].bytes;
}

uint32_t number_width(enum number_kind kind)
{
    return numbers[kind].width;
}

bool number_is_float(enum number_kind kind)
{
    return kind >= NUMBER_HALF && kind <= NUMBER_B10F;
}

bool number_is_signed(enum number_kind kind)
{
    return numbers[kind].least < 0;
}

uint32_t number_one(enum number_kind kind)
{
    if (number_is_snorm(kind))
        return INT16_MAX;
    bool unorm = kind <= NUMBER_UNORM24 || (kind >= NUMBER_R10 && kind <= NUMBER_A2);
    return unorm ? (1u << numbers[kind].width) - 1 : 0;
}

static uint32_t mask_of(enum number_kind kind)
{
    return UINT32_MAX >> (32 - numbers[kind].width);
}

uint32_t number_bits(enum number_kind kind, const uint8_t *place)
{
    uint32_t bits = 0;
    memcpy(&bits, place, number_size(kind)); /* little-endian, as all of diptych's machines are */
    return bits >> numbers[kind].shift & mask_of(kind);
}

void number_set_bits(enum number_kind kind, uint32_t bits, uint8_t *place)
{
    uint32_t all = 0;
    memcpy(&all, place, number_size(kind));
    all &= ~(mask_of(kind) << numbers[kind].shift);
    all |= bits << numbers[kind].shift;
    memcpy(place, &all, number_size(kind));
}

static double half_value(uint32_t bits)
{
    uint32_t exponent = bits >> 10 & 31;
    double fraction = bits & 1023;
    double size = exponent == 0   ? ldexp(fraction, -24)
                  : exponent < 31 ? ldexp(fraction + 1024, (int)exponent - 25)
                  : fraction == 0 ? INFINITY
                                  : NAN;
    return bits & 0x8000 ? -size : size;
}

double number_of_bits(enum number_kind kind, uint32_t bits)
{
    uint32_t width = numbers[kind].width, one = number_one(kind);
    float number;
    memcpy(&number, &bits, sizeof number);
    if (kind == NUMBER_FLOAT)
        return (double)number;
    if (number_is_float(
            kind)) /* packed ones are halves without a sign, and with a shorter fraction */
        return half_value(kind == NUMBER_HALF ? bits : bits << (15 - width));
    int32_t extended = (int32_t)(bits << (32 - width)) >> (32 - width);
    double value = number_is_signed(kind) ? extended : (double)bits;
    return one ? fmax(value / one, -1) : value; /* SNORM16: -32768 is -1, too */
}

double number_value(enum number_kind kind, const uint8_t *place)
{
    return number_of_bits(kind, number_bits(kind, place));
}

/* Of a fraction of so many bits. Ties go to the even one; from 65520 on a half is infinity. */
static uint32_t half_bits(double value, int fraction)
{
    double size = fabs(value);
    int exponent;
    uint32_t bits;
    frexp(size, &exponent); /* size is 0.5 to 1 times 2 to the exponent */
    if (size < 0x1p-14)
        bits = (uint32_t)lrint(ldexp(size, 14 + fraction));
    else
        bits = ((uint32_t)(exponent + 13) << fraction) +
               (uint32_t)lrint(ldexp(size, fraction + 1 - exponent));
    return bits | (signbit(value) && fraction == 10 ? 0x8000 : 0);
}

bool number_store(enum number_kind kind, double value, uint8_t *place)
{
    float number = (float)value;
    uint32_t bits = 0;
    if (!(value >= numbers[kind].least && value <= numbers[kind].most))
        return false;
    if (kind == NUMBER_FLOAT)
        memcpy(&bits, &number, sizeof bits);
    else if (number_is_float(kind))
        bits = half_bits(value, kind == NUMBER_HALF ? 10 : (int)numbers[kind].width - 5);
    else
        bits = (uint32_t)llrint(number_one(kind) ? number_one(kind) * value : value);
    number_set_bits(kind, bits & mask_of(kind), place);
    return true;
}

uint32_t resource_stride(const struct dt_resource *resource)
{
    return resource->kind == DT_BUFFER ? resource->stride : format_info(resource->format)->bytes;
}

void resource_extent(const struct dt_pipeline *pipeline, uint32_t resource, const uint32_t size[2],
                     uint32_t mip, uint32_t extent[3])
{
    const struct dt_resource *what = &pipeline->resources[resource];
    int halved = what->kind == DT_BUFFER ? 0 : what->shape == DT_SHAPE_3D ? 3 : 2;
    pipeline->extent(pipeline, resource, size[0], size[1], extent);
    for (int axis = 0; axis < halved; axis++)
        extent[axis] = extent[axis] >> mip ? extent[axis] >> mip : 1;
}

uint64_t resource_elements(const struct dt_resource *resource, const uint32_t extent[3])
{
    return resource->kind == DT_BUFFER ? extent[0] : (uint64_t)extent[0] * extent[1] * extent[2];
}

static enum number_kind type_number(enum dt_type type)
{
    enum dt_type scalar = type_info(type)->scalar;
    return scalar == DT_TYPE_FLOAT ? NUMBER_FLOAT
           : scalar == DT_TYPE_INT ? NUMBER_INT
                                   : NUMBER_UINT;
}

static void name_component(struct component *component, const struct dt_field *field, uint32_t item,
                           uint32_t index)
{
    char place[16] = "";
    char part[16] = "";
    if (field->array_count)
        snprintf(place, sizeof place, "[%u]", item);
    if (field->type == DT_TYPE_MAT4)
        snprintf(part, sizeof part, "[%u].%c", index / 4, "xyzw"[index % 4]);
    else if (type_components(field->type) > 1)
        snprintf(part, sizeof part, "%s%c", field->name[0] ? "." : "", "xyzw"[index]);
    snprintf(component->name, sizeof component->name, "%.39s%s%s", field->name, place, part);
}

static uint32_t field_components(const struct dt_field *field, struct component *list)
{
    uint32_t items = field->array_count ? field->array_count : 1;
    uint32_t each = type_components(field->type);
    for (uint32_t item = 0; list && item < items; item++) {
        for (uint32_t i = 0; i < each; i++) {
            struct component *component = &list[item * each + i];
            component->kind = type_number(field->type);
            component->offset = field->offset + item * field->array_stride + i * 4;
            name_component(component, field, item, i);
        }
    }
    return items * each;
}

static uint32_t buffer_components(const struct dt_resource *resource, struct component *list)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < resource->field_count; i++)
        count += field_components(&resource->fields[i], list ? list + count : NULL);
    return count;
}

static uint32_t image_components(const struct dt_resource *resource, struct component *list)
{
    uint32_t channels = format_info(resource->format)->channels;
    for (uint32_t i = 0; list && i < channels; i++)
        list[i] = format_component(resource->format, i);
    return channels;
}

/* Whether a list of a pass has the resource; the buffer of --sanitize is in none. */
static bool is_accessed(const struct dt_pipeline *pipeline, uint32_t resource)
{
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        const struct dt_pass *pass = &pipeline->passes[i];
        for (uint32_t j = 0; j < pass->write_count; j++)
            if (pass->writes[j] == resource)
                return true;
        for (uint32_t j = 0; j < pass->read_count; j++)
            if (pass->reads[j] == resource)
                return true;
    }
    return false;
}

uint32_t pass_mips(const struct dt_pass *pass, uint32_t write)
{
    return pass->write_mips ? pass->write_mips[write] : 1;
}

uint32_t resource_mips_before(const struct dt_pipeline *pipeline, uint32_t pass, uint32_t resource)
{
    const struct dt_resource *what = &pipeline->resources[resource];
    uint32_t all = what->kind == DT_IMAGE ? (1u << what->mips) - 1 : 1;
    uint32_t mask = what->history && is_accessed(pipeline, resource) ? all : 0;
    for (uint32_t i = 0; i < pass; i++) {
        const struct dt_pass *writer = &pipeline->passes[i];
        for (uint32_t j = 0; j < writer->write_count; j++)
            if (writer->writes[j] == resource)
                mask |= pass_mips(writer, j);
    }
    return mask;
}

char *element_place(const struct dt_resource *resource, const uint32_t extent[3], uint64_t element)
{
    if (resource->kind == DT_BUFFER)
        return format_string("[%llu]", (unsigned long long)element);
    uint64_t width = extent[0];
    uint64_t area = width * extent[1];
    unsigned long long x = element % width, y = element % area / width, layer = element / area;
    return resource->layered ? format_string("(%llu, %llu, layer %llu)", x, y, layer)
                             : format_string("(%llu, %llu)", x, y);
}

uint32_t resource_components(const struct dt_resource *resource, struct component **list)
{
    bool buffer = resource->kind == DT_BUFFER;
    uint32_t count = buffer ? buffer_components(resource, NULL) : image_components(resource, NULL);
    *list = calloc(count ? count : 1, sizeof **list);
    if (!*list)
        return 0;
    return buffer ? buffer_components(resource, *list) : image_components(resource, *list);
}

bool resource_clear_padding(const struct dt_resource *resource, struct dt_bytes *bytes)
{
    struct component *list = NULL;
    uint32_t stride = resource_stride(resource);
    uint32_t count = resource_components(resource, &list);
    uint8_t *kept = calloc(stride, 1); /* 0xff where a number lies */
    uint32_t numbers = 0;
    for (uint32_t i = 0; i < count && kept; i++) {
        memset(kept + list[i].offset, 0xff, number_size(list[i].kind));
        numbers += number_size(list[i].kind);
    }
    for (size_t at = 0; kept && numbers < stride && at + stride <= bytes->size; at += stride)
        for (uint32_t i = 0; i < stride; i++)
            bytes->data[at + i] &= kept[i];
    bool good = count && kept;
    free(kept);
    free(list);
    return good;
}
