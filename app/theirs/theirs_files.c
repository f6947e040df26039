/* Pictures and .npy arrays as resources; see theirs.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "console/console.h"
#include "base/foreign.h"
#include "scenes/image.h"
#include "theirs/theirs.h"

enum { MOST_HEADER = 4096, MOST_SHAPE = 4 };
#define MOST_FILE ((size_t)1 << 30)

void their_store(enum number_kind kind, double value, uint8_t *place)
{
    if (kind == NUMBER_FLOAT) {
        float number = (float)value;
        memcpy(place, &number, sizeof number);
    } else if (kind == NUMBER_HALF && !(fabs(value) < 65520)) {
        number_set_bits(kind, isnan(value) ? 0x7e00 : value < 0 ? 0xfc00 : 0x7c00, place);
    } else {
        uint32_t one = number_one(kind);
        double least = kind == NUMBER_SNORM16 ? -1 : 0;
        if (one)
            value = fmin(fmax(value, least), 1); /* NaN: the least */
        if (!number_store(kind, value, place))
            number_set_bits(kind, value > 0 ? UINT32_MAX >> (32 - number_width(kind)) : 0, place);
    }
}

/* ---- Arrays ------------------------------------------------------------------------------------ */

/* Types of numbers, and the formats of images of 1, 2, and 3 or 4 channels. */
struct array_type {
    char name[3]; /* as in the header, behind `<` or `|` */
    enum dt_format formats[3];
};
static const struct array_type array_types[] = {
    {"f2", {DT_FORMAT_R16F, DT_FORMAT_RG16F, DT_FORMAT_RGBA16F}},
    {"f4", {DT_FORMAT_R32F, DT_FORMAT_RG32F, DT_FORMAT_RGBA32F}},
    {"f8", {DT_FORMAT_R32F, DT_FORMAT_RG32F, DT_FORMAT_RGBA32F}},
    {"u1", {DT_FORMAT_R8UI, DT_FORMAT_RG8UI, DT_FORMAT_RGBA8}},
    {"b1", {DT_FORMAT_R8UI, DT_FORMAT_RG8UI, DT_FORMAT_RGBA8UI}},
    {"u2", {DT_FORMAT_R16UI, DT_FORMAT_RG16UI, DT_FORMAT_RGBA16UI}},
    {"u4", {DT_FORMAT_R32UI, DT_FORMAT_RG32UI, DT_FORMAT_RGBA32UI}},
    {"u8", {DT_FORMAT_R32UI, DT_FORMAT_RG32UI, DT_FORMAT_RGBA32UI}},
    {"i1", {DT_FORMAT_R8I, DT_FORMAT_RG8I, DT_FORMAT_RGBA8I}},
    {"i2", {DT_FORMAT_R16I, DT_FORMAT_RG16I, DT_FORMAT_RGBA16I}},
    {"i4", {DT_FORMAT_R32I, DT_FORMAT_RG32I, DT_FORMAT_RGBA32I}},
    {"i8", {DT_FORMAT_R32I, DT_FORMAT_RG32I, DT_FORMAT_RGBA32I}}};

struct array {
    const struct array_type *type;
    uint32_t shape[MOST_SHAPE], dimensions;
    const uint8_t *data;
    uint32_t size; /* bytes of a number */
};

static bool refuse_file(const struct theirs *theirs, const struct their_entry *entry,
                        const char *why)
{
    return report_error(theirs->log, "%s/%s: %s", theirs->folder, entry->file, why);
}

/* The dictionary in the header is Python's: {'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), } */
static const char *read_header(struct array *array, const char *header)
{
    const char *descr = strstr(header, "'descr':"), *order = strstr(header, "'fortran_order':");
    const char *shape = strstr(header, "'shape':");
    if (!descr || !order || !shape)
        return "is no .npy file: its header lacks a key";
    descr += 8 + strspn(descr + 8, " ");
    if (descr[0] != '\'' || descr[1] == '>' || !descr[2] || !descr[3] || descr[4] != '\'')
        return "has a dtype that is not one plain little-endian number";
    for (size_t i = 0; i < DT_ARRAY_COUNT(array_types); i++)
        if (!memcmp(descr + 2, array_types[i].name, 2))
            array->type = &array_types[i];
    if (!array->type)
        return "has a dtype that is not float16 to 64, int8 to 64, uint8 to 64 or bool";
    array->size = (uint32_t)(array->type->name[1] - '0');
    if (!strncmp(order + 16 + strspn(order + 16, " "), "True", 4))
        return "is in Fortran's order; save numpy.ascontiguousarray of it";
    for (shape = strchr(shape, '('); shape && *shape && *shape != ')';) {
        char *end;
        shape += 1 + strspn(shape + 1, " ");
        if (*shape == ')')
            break;
        unsigned long long size = strtoull(shape, &end, 10);
        if (end == shape || size < 1 || size > MOST_FILE || array->dimensions == MOST_SHAPE)
            return "has no shape of at most 4 dimensions of at least 1";
        array->shape[array->dimensions++] = (uint32_t)size;
        shape = end;
    }
    return shape ? NULL : "is no .npy file: its header has no shape";
}

static const char *parse_header(struct array *array, const uint8_t *file, size_t size)
{
    char header[MOST_HEADER + 1];
    if (size < 12 || memcmp(file, "\x93NUMPY", 6) != 0 || file[6] < 1 || file[6] > 3)
        return "is no .npy file of version 1 to 3";
    size_t start = file[6] > 1 ? 12 : 10, length = file[8] | (size_t)file[9] << 8;
    if (file[6] > 1)
        length |= (size_t)file[10] << 16 | (size_t)file[11] << 24;
    if (length > MOST_HEADER || start + length > size)
        return "is no .npy file: its header is too long";
    memcpy(header, file + start, length);
    header[length] = 0;
    const char *reason = read_header(array, header);
    uint64_t bytes = array->size;
    for (uint32_t i = 0; i < array->dimensions; i++) {
        bytes *= array->shape[i];
        if (bytes > MOST_FILE)
            return "would have more than 1 GiB";
    }
    array->data = file + start + length;
    return reason                           ? reason
           : bytes != size - start - length ? "has not the size of its shape"
                                            : NULL;
}

static double number_at(const struct array *array, uint64_t index)
{
    const uint8_t *place = array->data + index * array->size;
    int64_t whole = 0;
    double number;
    const char kind = array->type->name[0];
    if (kind == 'f' && array->size == 8) {
        memcpy(&number, place, sizeof number);
        return number;
    }
    if (kind == 'f')
        return number_value(array->size == 2 ? NUMBER_HALF : NUMBER_FLOAT, place);
    memcpy(&whole, place, array->size);
    int unused = 64 - 8 * (int)array->size;
    if (kind == 'i')
        return (double)((int64_t)((uint64_t)whole << unused) >> unused);
    return (double)(uint64_t)whole;
}

/* (n), (n, 2 to 4), and (n, 3, 3) or (n, 4, 4), which are matrices, become buffers; (height, width),
 * with up to 4 channels behind and layers in front, images. */
static bool is_buffer(const struct array *array)
{
    const uint32_t *shape = array->shape;
    return array->dimensions < 2 || (array->dimensions == 2 && shape[1] <= 4) ||
           (array->dimensions == 3 && shape[1] == shape[2] && (shape[1] == 3 || shape[1] == 4));
}

static bool shape_buffer(struct their_entry *entry, const struct array *array)
{
    static const enum dt_type vectors[3][4] = {
        {DT_TYPE_FLOAT, DT_TYPE_VEC2, DT_TYPE_VEC3, DT_TYPE_VEC4},
        {DT_TYPE_INT, DT_TYPE_IVEC2, DT_TYPE_IVEC3, DT_TYPE_IVEC4},
        {DT_TYPE_UINT, DT_TYPE_UVEC2, DT_TYPE_UVEC3, DT_TYPE_UVEC4}};
    const char *name = array->type->name;
    int kind = *name == 'f' ? 0 : *name == 'i' ? 1 : 2;
    uint32_t numbers = 1;
    for (uint32_t i = 1; i < array->dimensions; i++)
        numbers *= array->shape[i];
    if (!entry->fields) /* else what was made of an earlier load may point to it */
        entry->fields = calloc(1, sizeof *entry->fields);
    struct dt_field *field = entry->fields;
    if (!field)
        return false;
    *field = (struct dt_field){.name = "", .type = vectors[kind][numbers <= 4 ? numbers - 1 : 0]};
    if (numbers == 16 && !kind)
        field->type = DT_TYPE_MAT4;
    else if (numbers > 4) {
        field->array_count = numbers;
        field->array_stride = 4;
    }
    entry->what.kind = DT_BUFFER;
    entry->what.fields = field;
    entry->what.field_count = 1;
    entry->what.stride = 4 * numbers;
    entry->extent[0] = array->dimensions ? array->shape[0] : 1;
    entry->extent[1] = entry->extent[2] = 1;
    return true;
}

/* Returns the channels in the file. */
static uint32_t shape_image(struct their_entry *entry, const struct array *array)
{
    uint32_t last = array->shape[array->dimensions - 1];
    bool coloured = array->dimensions == 4 || (array->dimensions == 3 && last <= 4);
    uint32_t channels = coloured ? last : 1, sizes = array->dimensions - coloured;
    if (channels > 4)
        return 0;
    entry->what.kind = DT_IMAGE;
    entry->what.format = array->type->formats[channels > 2 ? 2 : channels - 1];
    entry->what.mips = 1;
    entry->extent[0] = array->shape[sizes - 1];
    entry->extent[1] = array->shape[sizes - 2];
    entry->extent[2] = sizes > 2 ? array->shape[0] : 1;
    entry->what.layered = entry->extent[2] > 1;
    return channels;
}

/* Numbers of the array, `each` to an element, into the resource's. */
static bool take_numbers(struct their_entry *entry, const struct array *array, uint32_t each,
                         struct dt_bytes *bytes)
{
    struct component *list = NULL;
    uint32_t count = resource_components(&entry->what, &list);
    uint64_t elements = resource_elements(&entry->what, entry->extent);
    uint32_t stride = resource_stride(&entry->what);
    memcpy(bytes->extent, entry->extent, sizeof bytes->extent);
    bytes->size = elements * stride;
    bytes->data = count ? calloc(bytes->size, 1) : NULL;
    double scale = count && number_one(list[0].kind) ? number_one(list[0].kind) : 1;
    for (uint64_t i = 0; bytes->data && i < elements; i++)
        for (uint32_t c = 0; c < count; c++) {
            double value = c < each ? number_at(array, i * each + c) / scale : 1;
            their_store(list[c].kind, value, bytes->data + i * stride + list[c].offset);
        }
    free(list);
    return bytes->data;
}

bool their_npy(const struct theirs *theirs, struct their_entry *entry, struct dt_bytes *bytes)
{
    struct array array = {.size = 1};
    size_t size;
    uint8_t *file =
        (uint8_t *)foreign_read(theirs->folder, entry->file, MOST_FILE, &size, theirs->log);
    if (!file)
        return false;
    const char *reason = parse_header(&array, file, size);
    uint32_t each = 0;
    if (!reason && is_buffer(&array))
        each = shape_buffer(entry, &array) ? entry->what.stride / 4 : 0;
    else if (!reason)
        each = shape_image(entry, &array);
    if (!reason && !each)
        reason =
            "has no shape (n), (height, width), (height, width, 1 to 4) or with layers in front";
    if (array.size == 8)
        entry->read_as =
            *array.type->name == 'f' ? "float64 read as float32" : "64-bit integers read as 32";
    bool good = reason ? refuse_file(theirs, entry, reason)
                       : take_numbers(entry, &array, each, bytes) ||
                             refuse_file(theirs, entry, "needs more memory than there is");
    free(file);
    entry->described = false;
    return good;
}

/* ---- Pictures ---------------------------------------------------------------------------------- */

/* The size of a channel of a PNG stands behind width and height. */
static bool has_16_bits(const struct theirs *theirs, const struct their_entry *entry)
{
    size_t size;
    uint8_t *file =
        (uint8_t *)foreign_read(theirs->folder, entry->file, MOST_FILE, &size, theirs->log);
    bool deep = file && size > 24 && !memcmp(file, "\x89PNG", 4) && file[24] == 16;
    free(file);
    return deep;
}

static void take_floats(struct their_entry *entry, float *texels, struct dt_bytes *bytes)
{
    bool deep = entry->what.format == DT_FORMAT_RGBA16;
    size_t count = (size_t)entry->extent[0] * entry->extent[1] * 4;
    bytes->size = count * (deep ? 2 : 4);
    bytes->data = (uint8_t *)texels;
    for (size_t i = 0; deep && i < count; i++) { /* in place: a code is half as long */
        double value = (double)texels[i];
        their_store(NUMBER_UNORM16, value, bytes->data + 2 * i);
    }
}

bool their_picture(const struct theirs *theirs, struct their_entry *entry, struct dt_bytes *bytes)
{
    char *path = format_string("%s/%s", theirs->folder, entry->file);
    struct stat info;
    bool png = !strcmp(entry->file + strlen(entry->file) - 4, ".png");
    bool deep = png && has_16_bits(theirs, entry), good = false;
    float *texels = NULL;
    uint8_t *codes = NULL;
    entry->what.kind = DT_IMAGE;
    entry->what.mips = 1;
    entry->what.format = !png ? DT_FORMAT_RGBA32F : deep ? DT_FORMAT_RGBA16 : DT_FORMAT_RGBA8;
    entry->extent[0] = entry->extent[1] = 0; /* as large as the file */
    if (!path || lstat(path, &info) != 0 || !S_ISREG(info.st_mode))
        refuse_file(theirs, entry, "is no regular file");
    else if (png && !deep)
        good = image_read_rgba8(path, &entry->extent[0], &entry->extent[1], &codes, theirs->log);
    else
        good = image_read_float(path, &entry->extent[0], &entry->extent[1], &texels, theirs->log);
    free(path);
    entry->extent[2] = 1;
    if (good && codes) {
        bytes->data = codes;
        bytes->size = (size_t)entry->extent[0] * entry->extent[1] * 4;
    } else if (good && texels) {
        take_floats(entry, texels, bytes);
    }
    memcpy(bytes->extent, entry->extent, sizeof bytes->extent);
    return good;
}
