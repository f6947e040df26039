/* Pictures and .npy arrays as resources; see theirs.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "console/console.h"
#include "base/foreign.h"
#include "base/npy.h"
#include "base/printable.h"
#include "scenes/image.h"
#include "theirs/theirs.h"

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
        double least = number_is_snorm(kind) ? -1 : 0;
        if (one)
            value = fmin(fmax(value, least), 1); /* NaN: the least */
        if (!number_store(kind, value, place))
            number_set_bits(kind, value > 0 ? UINT32_MAX >> (32 - number_width(kind)) : 0, place);
    }
}

/* ---- Arrays ------------------------------------------------------------------------------------ */

/* Formats of images of 1, 2, and 3 or 4 channels, by the numbers of their arrays. */
static const struct array_type {
    enum dt_type type;
    uint32_t bytes;
    enum dt_format formats[3];
} array_types[] = {{DT_TYPE_FLOAT, 2, {DT_FORMAT_R16F, DT_FORMAT_RG16F, DT_FORMAT_RGBA16F}},
                   {DT_TYPE_FLOAT, 4, {DT_FORMAT_R32F, DT_FORMAT_RG32F, DT_FORMAT_RGBA32F}},
                   {DT_TYPE_FLOAT, 8, {DT_FORMAT_R32F, DT_FORMAT_RG32F, DT_FORMAT_RGBA32F}},
                   {DT_TYPE_UINT, 1, {DT_FORMAT_R8UI, DT_FORMAT_RG8UI, DT_FORMAT_RGBA8}},
                   {DT_TYPE_BOOL, 1, {DT_FORMAT_R8UI, DT_FORMAT_RG8UI, DT_FORMAT_RGBA8UI}},
                   {DT_TYPE_UINT, 2, {DT_FORMAT_R16UI, DT_FORMAT_RG16UI, DT_FORMAT_RGBA16UI}},
                   {DT_TYPE_UINT, 4, {DT_FORMAT_R32UI, DT_FORMAT_RG32UI, DT_FORMAT_RGBA32UI}},
                   {DT_TYPE_UINT, 8, {DT_FORMAT_R32UI, DT_FORMAT_RG32UI, DT_FORMAT_RGBA32UI}},
                   {DT_TYPE_INT, 1, {DT_FORMAT_R8I, DT_FORMAT_RG8I, DT_FORMAT_RGBA8I}},
                   {DT_TYPE_INT, 2, {DT_FORMAT_R16I, DT_FORMAT_RG16I, DT_FORMAT_RGBA16I}},
                   {DT_TYPE_INT, 4, {DT_FORMAT_R32I, DT_FORMAT_RG32I, DT_FORMAT_RGBA32I}},
                   {DT_TYPE_INT, 8, {DT_FORMAT_R32I, DT_FORMAT_RG32I, DT_FORMAT_RGBA32I}}};

static bool refuse_file(const struct theirs *theirs, const struct their_entry *entry,
                        const char *why)
{
    return report_error(theirs->log, "%s/%s: %s", theirs->folder, entry->file, why);
}

static double number_at(const struct npy_field *field, const uint8_t *place)
{
    int64_t whole = 0;
    double number;
    if (field->type == DT_TYPE_FLOAT && field->bytes == 8) {
        memcpy(&number, place, sizeof number);
        return number;
    }
    if (field->type == DT_TYPE_FLOAT)
        return number_value(field->bytes == 2 ? NUMBER_HALF : NUMBER_FLOAT, place);
    memcpy(&whole, place, field->bytes);
    int unused = 64 - 8 * (int)field->bytes;
    if (field->type == DT_TYPE_INT)
        return (double)((int64_t)((uint64_t)whole << unused) >> unused);
    return (double)(uint64_t)whole;
}

/* Structs, (n), (n, 2 to 4), and (n, 3, 3) or (n, 4, 4), which are matrices, become buffers; (height,
 * width), with up to 4 channels behind and layers in front, images. */
static bool is_buffer(const struct npy *array)
{
    const struct npy_field *field = &array->fields[0];
    const uint32_t *shape = field->shape;
    return field->name[0] || field->dimensions < 1 || (field->dimensions == 1 && shape[0] <= 4) ||
           (field->dimensions == 2 && shape[0] == shape[1] && (shape[0] == 3 || shape[0] == 4));
}

/* A field of 32-bit numbers, behind those before it. Returns its bytes. */
static uint32_t shape_field(struct dt_field *field, char name[static NPY_MOST_NAME],
                            const struct npy_field *from, uint32_t offset)
{
    static const enum dt_type vectors[][4] = {
        [DT_TYPE_FLOAT] = {DT_TYPE_FLOAT, DT_TYPE_VEC2, DT_TYPE_VEC3, DT_TYPE_VEC4},
        [DT_TYPE_INT] = {DT_TYPE_INT, DT_TYPE_IVEC2, DT_TYPE_IVEC3, DT_TYPE_IVEC4},
        [DT_TYPE_UINT] = {DT_TYPE_UINT, DT_TYPE_UVEC2, DT_TYPE_UVEC3, DT_TYPE_UVEC4}};
    enum dt_type scalar = from->type == DT_TYPE_BOOL ? DT_TYPE_UINT : from->type;
    uint32_t numbers = from->numbers;
    memcpy(name, from->name, NPY_MOST_NAME);
    *field = (struct dt_field){
        .name = name, .offset = offset, .type = vectors[scalar][numbers <= 4 ? numbers - 1 : 0]};
    if (numbers == 16 && from->type == DT_TYPE_FLOAT) {
        field->type = DT_TYPE_MAT4;
    } else if (numbers > 4) {
        field->array_count = numbers;
        field->array_stride = 4;
    }
    return 4 * numbers;
}

static bool shape_buffer(struct their_entry *entry, const struct npy *array)
{
    enum { EACH = sizeof(struct dt_field) + NPY_MOST_NAME };
    if (!entry->fields) /* else what was made of an earlier load may point to it */
        entry->fields = calloc(NPY_MOST_FIELDS, EACH);
    if (!entry->fields)
        return false;
    char(*names)[NPY_MOST_NAME] = (void *)(entry->fields + NPY_MOST_FIELDS);
    entry->what.stride = 0;
    for (uint32_t i = 0; i < array->field_count; i++)
        entry->what.stride +=
            shape_field(&entry->fields[i], names[i], &array->fields[i], entry->what.stride);
    entry->what.kind = DT_BUFFER;
    entry->what.fields = entry->fields;
    entry->what.field_count = array->field_count;
    entry->extent[0] = array->count;
    entry->extent[1] = entry->extent[2] = 1;
    return true;
}

/* Returns the channels in the file; 0: more than 4. */
static uint32_t shape_image(struct their_entry *entry, const struct npy *array)
{
    const struct npy_field *field = &array->fields[0];
    uint32_t sizes[] = {array->count, field->shape[0], field->shape[1]};
    uint32_t dimensions = field->dimensions + 1, last = field->shape[field->dimensions - 1];
    bool coloured = dimensions == 4 || (dimensions == 3 && last <= 4);
    uint32_t channels = coloured ? last : 1, rows = dimensions - coloured;
    const struct array_type *type = array_types;
    while (type->type != field->type || type->bytes != field->bytes)
        type++;
    if (channels > 4)
        return 0;
    entry->what.kind = DT_IMAGE;
    entry->what.format = type->formats[channels > 2 ? 2 : channels - 1];
    entry->what.mips = 1;
    entry->extent[0] = sizes[rows - 1];
    entry->extent[1] = sizes[rows - 2];
    entry->extent[2] = rows > 2 ? sizes[0] : 1;
    entry->what.layered = entry->extent[2] > 1;
    return channels;
}

/* Numbers of a plain array, `each` to an element, into the resource's. */
static bool take_numbers(struct their_entry *entry, const struct npy_field *field,
                         const uint8_t *numbers, uint32_t each, struct dt_bytes *bytes)
{
    struct component *list = NULL;
    uint32_t count = resource_components(&entry->what, &list);
    uint64_t elements = resource_elements(&entry->what, entry->extent);
    uint32_t stride = resource_stride(&entry->what);
    bytes->size = elements * stride;
    bytes->data = count ? calloc(bytes->size, 1) : NULL;
    double scale = count && number_one(list[0].kind) ? number_one(list[0].kind) : 1;
    for (uint64_t i = 0; bytes->data && i < elements; i++)
        for (uint32_t c = 0; c < count; c++) {
            const uint8_t *place = numbers + (i * each + c) * field->bytes;
            double value = c < each ? number_at(field, place) / scale : 1;
            their_store(list[c].kind, value, bytes->data + i * stride + list[c].offset);
        }
    free(list);
    return bytes->data;
}

/* Structs are taken as they are. NULL, or why not. */
static const char *take_npy(struct their_entry *entry, const struct npy *array,
                            const uint8_t *numbers, struct dt_bytes *bytes)
{
    const struct npy_field *field = &array->fields[0];
    bool buffer = is_buffer(array), structured = field->name[0];
    for (uint32_t i = 0; i < array->field_count && structured; i++)
        if (array->fields[i].bytes != 4 || !text_is_printable(array->fields[i].name))
            return "its fields are not float32, int32 or uint32, with plain names";
    if (buffer && !shape_buffer(entry, array))
        return "needs more memory than there is";
    uint32_t each = buffer ? field->numbers : shape_image(entry, array);
    if (!each)
        return "has no shape (n), (height, width), (height, width, 1 to 4) or with layers in front";
    if (field->bytes == 8)
        entry->read_as =
            field->type == DT_TYPE_FLOAT ? "float64 read as float32" : "64-bit integers read as 32";
    memcpy(bytes->extent, entry->extent, sizeof bytes->extent);
    if (structured && (bytes->data = malloc((size_t)array->count * array->stride))) {
        bytes->size = (size_t)array->count * array->stride;
        memcpy(bytes->data, numbers, bytes->size);
    }
    return (structured ? bytes->data != NULL : take_numbers(entry, field, numbers, each, bytes))
               ? NULL
               : "needs more memory than there is";
}

bool their_npy(const struct theirs *theirs, struct their_entry *entry, struct dt_bytes *bytes)
{
    struct npy array;
    const char *reason;
    size_t size;
    uint8_t *file =
        (uint8_t *)foreign_read(theirs->folder, entry->file, MOST_FILE, &size, theirs->log);
    if (!file)
        return false;
    if (npy_parse(file, size, &array, &reason))
        reason = take_npy(entry, &array, file + array.offset, bytes);
    free(file);
    entry->described = false;
    return !reason || refuse_file(theirs, entry, reason);
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
