/* Files of NumPy arrays; see npy.h. Format: NumPy Enhancement Proposal 1. */
#include "base/npy.h"

#include "base/input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)1 << 30)
enum { MOST_START = 12, MOST_HEADER = 16384, MOST_REASON = 320 };

static _Thread_local char reason_text[MOST_REASON];

/* ---- The header: a Python dictionary of three keys ------------------------------------------- */

/* What follows 'KEY': in the dictionary, without spaces; NULL: it is not there. */
static const char *header_value(const char *header, const char *key)
{
    const char *at = strstr(header, key);
    at = at ? strchr(at, ':') : NULL;
    return at ? at + 1 + strspn(at + 1, " ") : NULL;
}

/* Steps over spaces and this character; false: another one stands there. */
static bool pass(const char **at, char wanted)
{
    *at += strspn(*at, " ");
    if (**at != wanted)
        return false;
    *at += 1 + strspn(*at + 1, " ");
    return true;
}

/* '<f4', '|u1': a letter and the bytes of a number. */
static bool take_type(struct npy_field *field, const char **at, const char **reason)
{
    static const char *const known[] = {"f2", "f4", "f8", "i1", "i2", "i4",
                                        "i8", "u1", "u2", "u4", "u8", "b1"};
    const char *text = *at;
    for (size_t i = 0; i < DT_ARRAY_COUNT(known); i++)
        if (text[0] == '\'' && (text[1] == '<' || text[1] == '|') &&
            !strncmp(text + 2, known[i], 2) && text[4] == '\'') {
            field->type = text[2] == 'f'   ? DT_TYPE_FLOAT
                          : text[2] == 'i' ? DT_TYPE_INT
                          : text[2] == 'u' ? DT_TYPE_UINT
                                           : DT_TYPE_BOOL;
            field->bytes = (uint32_t)(text[3] - '0');
            *at += 5;
            return true;
        }
    snprintf(reason_text, MOST_REASON, "its dtype has %.*s; use little-endian numbers",
             (int)strcspn(text, ",})"), text);
    *reason = reason_text;
    return false;
}

/* A tuple of sizes; at most MOST numbers altogether. */
static bool take_shape(const char **at, uint32_t *shape, uint32_t most, uint32_t *dimensions)
{
    uint64_t numbers = 1;
    *dimensions = 0;
    if (!pass(at, '('))
        return false;
    while (!pass(at, ')')) {
        char *end;
        unsigned long size = **at >= '0' && **at <= '9' ? strtoul(*at, &end, 10) : 0;
        if (size < 1 || size > INT32_MAX || *dimensions == most || (numbers *= size) > MOST_BYTES)
            return false;
        shape[(*dimensions)++] = (uint32_t)size;
        *at = end;
        if (!pass(at, ',') && **at != ')')
            return false;
    }
    return true;
}

static void count_numbers(struct npy *array)
{
    struct npy_field *field = &array->fields[array->field_count++];
    field->numbers = 1;
    for (uint32_t i = 0; i < field->dimensions; i++)
        field->numbers *= field->shape[i];
    array->numbers += field->numbers;
    array->stride += field->numbers * field->bytes;
}

/* ('name', '<f4', (3,)), the last part only for a field of several numbers. */
static bool take_field(struct npy *array, const char **at, const char **reason)
{
    struct npy_field *field = &array->fields[array->field_count];
    if (array->field_count == NPY_MOST_FIELDS || !pass(at, '(') || !pass(at, '\''))
        return false;
    size_t length = strcspn(*at, "'");
    if (length < 1 || length >= NPY_MOST_NAME)
        return false;
    memcpy(field->name, *at, length);
    *at += length;
    if (!pass(at, '\'') || !pass(at, ',') || !take_type(field, at, reason))
        return false;
    if (pass(at, ',') && !take_shape(at, field->shape, NPY_MOST_DIMENSIONS, &field->dimensions))
        return false;
    count_numbers(array);
    return array->stride <= MOST_BYTES && pass(at, ')');
}

static bool take_fields(struct npy *array, const char *at, const char **reason)
{
    *reason = "its dtype is not fields of names, types and shapes, without padding";
    if (!pass(&at, '['))
        return false;
    while (!pass(&at, ']'))
        if (!take_field(array, &at, reason) || (!pass(&at, ',') && *at != ']'))
            return false;
    return array->field_count;
}

static bool take_array(struct npy *array, const char *descr, const char *shape, const char **reason)
{
    enum { MOST = NPY_MOST_DIMENSIONS + 1 };
    uint32_t sizes[MOST] = {0}, dimensions;
    bool structured = *descr == '[';
    if (structured ? !take_fields(array, descr, reason)
                   : !take_type(&array->fields[0], &descr, reason))
        return false;
    *reason = structured ? "its shape is not (n), at most 1 GiB"
                         : "its shape is not at most 4 dimensions of at least 1, at most 1 GiB";
    if (!take_shape(&shape, sizes, structured ? 1 : MOST, &dimensions))
        return false;
    array->count = dimensions ? sizes[0] : 1;
    if (!structured) {
        array->fields[0].dimensions = dimensions ? dimensions - 1 : 0;
        memcpy(array->fields[0].shape, sizes + 1, array->fields[0].dimensions * sizeof *sizes);
        count_numbers(array);
    }
    return (uint64_t)array->count * array->stride <= MOST_BYTES;
}

/* `size` bytes from the start of a file. */
static bool take_header(const uint8_t *file, size_t size, struct npy *array, const char **reason)
{
    char header[MOST_HEADER + 1];
    *array = (struct npy){0};
    *reason = "it is no .npy file of version 1 to 3";
    if (size < MOST_START || memcmp(file, "\x93NUMPY", 6) != 0 || file[6] < 1 || file[6] > 3)
        return false;
    size_t length = file[8] | (size_t)file[9] << 8;
    array->offset = 10;
    if (file[6] > 1) {
        length |= (size_t)file[10] << 16 | (size_t)file[11] << 24;
        array->offset = MOST_START;
    }
    *reason = "its header is damaged";
    if (length > MOST_HEADER || length > size - array->offset)
        return false;
    memcpy(header, file + array->offset, length);
    header[length] = '\0';
    array->offset += length;
    const char *descr = header_value(header, "'descr'"), *shape = header_value(header, "'shape'"),
               *order = header_value(header, "'fortran_order'");
    if (!descr || !shape || !order)
        return false;
    if (strncmp(order, "False", 5) != 0) {
        *reason = "it is in Fortran order; save numpy.ascontiguousarray(a)";
        return false;
    }
    return take_array(array, descr, shape, reason);
}

/* Whether all numbers have four bytes, as those of buffers. */
static bool has_words(const struct npy *array, const char **reason)
{
    for (uint32_t i = 0; i < array->field_count; i++)
        if (array->fields[i].bytes != sizeof(uint32_t)) {
            const struct npy_field *field = &array->fields[i];
            snprintf(reason_text, MOST_REASON,
                     "its dtype has '<%c%u'; use float32, int32 and uint32, little-endian",
                     "fiub"[field->type / 4], field -> bytes);
            *reason = reason_text;
            return false;
        }
    return true;
}

bool npy_header(const char *path, struct npy *array, const char **reason)
{
    uint8_t start[MOST_START + MOST_HEADER];
    FILE *file = input_open(path, MOST_BYTES, reason);
    size_t size = file ? fread(start, 1, sizeof start, file) : 0;
    bool good = file && take_header(start, size, array, reason) && has_words(array, reason);
    if (file)
        fclose(file);
    return good;
}

bool npy_parse(const uint8_t *file, size_t size, struct npy *array, const char **reason)
{
    if (!take_header(file, size, array, reason))
        return false;
    size_t bytes = (size_t)array->count * array->stride;
    if (size == array->offset + bytes)
        return true;
    snprintf(reason_text, MOST_REASON, "it has %zu bytes of numbers; its header says %zu",
             size - array->offset, bytes);
    *reason = reason_text;
    return false;
}

void *npy_read(const char *path, struct npy *array, const char **reason)
{
    size_t size;
    char *text = input_read(path, MOST_BYTES, &size, reason);
    if (!text)
        return NULL;
    if (!npy_parse((const uint8_t *)text, size, array, reason) || !has_words(array, reason)) {
        free(text);
        return NULL;
    }
    memmove(text, text + array->offset, size - array->offset);
    return text;
}

/* ---- What it is wanted for ------------------------------------------------------------------- */

static const char *numpy_type(enum dt_type scalar)
{
    return scalar == DT_TYPE_FLOAT ? "float32" : scalar == DT_TYPE_INT ? "int32" : "uint32";
}

/* As an array has it that holds elements of this type; false: none does. */
static bool shape_of(const struct dt_field *field, struct npy_field *wanted)
{
    bool matrix = field->type == DT_TYPE_MAT4;
    /* enum dt_type has one to four components of float, then of int, then of uint */
    uint32_t components = matrix ? 4 : field->type % 4 + 1;
    *wanted =
        (struct npy_field){.type = matrix ? DT_TYPE_FLOAT : (enum dt_type)(field->type / 4 * 4)};
    if (field->array_count)
        wanted->shape[wanted->dimensions++] = field->array_count;
    if (components > 1)
        wanted->shape[wanted->dimensions++] = components;
    if (matrix)
        wanted->shape[wanted->dimensions++] = components;
    return field->type != DT_TYPE_BOOL;
}

/* "(n, 3)" of a plain array, "(3)" of a field. */
static void print_shape(const struct npy_field *field, bool plain, char text[64])
{
    int used = snprintf(text, 64, plain ? "(n" : "(");
    for (uint32_t i = 0; i < field->dimensions; i++)
        used += snprintf(text + used, 64 - (size_t)used, "%s%u", plain || i ? ", " : "",
                         field->shape[i]);
    snprintf(text + used, 64 - (size_t)used, ")");
}

static const char *field_misfit(const struct npy_field *found, const struct dt_field *field)
{
    struct npy_field wanted;
    char shape[64], wanted_shape[64], of[NPY_MOST_NAME + 16] = "";
    bool plain = !field->name[0];
    if (!plain)
        snprintf(of, sizeof of, " of `%.*s`", NPY_MOST_NAME, field->name);
    if (!shape_of(field, &wanted))
        return "bool has no layout in a file";
    if (found->type != wanted.type) {
        snprintf(reason_text, MOST_REASON, "the numbers%s are %s, not %s", of,
                 numpy_type(found->type), numpy_type(wanted.type));
        return reason_text;
    }
    if (found->dimensions == wanted.dimensions &&
        !memcmp(found->shape, wanted.shape, wanted.dimensions * sizeof *wanted.shape))
        return NULL;
    print_shape(found, plain, shape);
    print_shape(&wanted, plain, wanted_shape);
    snprintf(reason_text, MOST_REASON, "the shape%s is %s, not %s", of, shape, wanted_shape);
    return reason_text;
}

const char *npy_misfit(const struct npy *array, const struct dt_field *fields, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct npy_field *found = &array->fields[i];
        if (i < array->field_count && !strcmp(found->name, fields[i].name)) {
            const char *misfit = field_misfit(found, &fields[i]);
            if (misfit)
                return misfit;
            continue;
        }
        if (!fields[i].name[0])
            return "its dtype has fields, but the buffer is made of scalars or vectors";
        if (!array->fields[0].name[0])
            return "its dtype has no fields, but the buffer is made of structs";
        snprintf(reason_text, MOST_REASON, "field %u of its dtype is not `%.*s`", i, NPY_MOST_NAME,
                 fields[i].name);
        return reason_text;
    }
    if (array->field_count == count)
        return NULL;
    snprintf(reason_text, MOST_REASON, "its dtype has %u fields, not %u", array->field_count,
             count);
    return reason_text;
}
