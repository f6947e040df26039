/* Files of NumPy arrays; see npy.h. Format: NumPy Enhancement Proposal 1. */
#include "npy.h"

#include "input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)1 << 30)
enum { MOST_HEADER = 4096, MOST_REASON = 160 };

static _Thread_local char reason_text[MOST_REASON];

/* ---- The header: a Python dictionary of three keys ------------------------------------------- */

/* What follows 'KEY': in the dictionary, without spaces; NULL: it is not there. */
static const char *value_of(const char *header, const char *key)
{
    const char *at = strstr(header, key);
    at = at ? strchr(at, ':') : NULL;
    return at ? at + 1 + strspn(at + 1, " ") : NULL;
}

static bool take_type(struct npy *array, const char *descr, const char **reason)
{
    static const struct {
        const char *text;
        enum dt_type type;
    } types[] = {{"'<f4'", DT_TYPE_FLOAT}, {"'<i4'", DT_TYPE_INT}, {"'<u4'", DT_TYPE_UINT}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(types); i++)
        if (!strncmp(descr, types[i].text, 5)) {
            array->type = types[i].type;
            return true;
        }
    snprintf(reason_text, MOST_REASON,
             "its dtype is %.*s; use float32, int32 or uint32, little-endian",
             (int)strcspn(descr, ",}"), descr);
    *reason = reason_text;
    return false;
}

static bool take_shape(struct npy *array, const char *shape, const char **reason)
{
    uint64_t count = 1;
    *reason = "its shape is not 1 to 4 dimensions of at least 1";
    if (*shape++ != '(')
        return false;
    for (array->dimensions = 0;; array->dimensions++) {
        char *end;
        shape += strspn(shape, " ,");
        if (*shape == ')')
            break;
        unsigned long long size = *shape == '-' ? 0 : strtoull(shape, &end, 10);
        if (size < 1 || size > INT32_MAX || array->dimensions == NPY_MOST_DIMENSIONS)
            return false;
        array->shape[array->dimensions] = (uint32_t)size;
        count *= size;
        if (count > MOST_BYTES / sizeof(uint32_t)) {
            *reason = "it has more than 1 GiB of numbers";
            return false;
        }
        shape = end;
    }
    return array->dimensions;
}

static bool take_header(FILE *file, struct npy *array, const char **reason)
{
    uint8_t start[12];
    char header[MOST_HEADER + 1];
    *reason = "it is no .npy file of version 1 to 3";
    if (fread(start, 1, 10, file) != 10 || memcmp(start, "\x93NUMPY", 6) != 0 || start[6] < 1 ||
        start[6] > 3)
        return false;
    size_t size = start[8] | (size_t)start[9] << 8;
    array->offset = 10;
    if (start[6] > 1) {
        if (fread(start + 10, 1, 2, file) != 2)
            return false;
        size |= (size_t)start[10] << 16 | (size_t)start[11] << 24;
        array->offset = 12;
    }
    *reason = "its header is damaged";
    if (size > MOST_HEADER || fread(header, 1, size, file) != size)
        return false;
    header[size] = '\0';
    array->offset += size;
    const char *descr = value_of(header, "'descr'"), *shape = value_of(header, "'shape'"),
               *order = value_of(header, "'fortran_order'");
    if (!descr || !shape || !order)
        return false;
    if (strncmp(order, "False", 5) != 0) {
        *reason = "it is in Fortran order; save numpy.ascontiguousarray(a)";
        return false;
    }
    return take_type(array, descr, reason) && take_shape(array, shape, reason);
}

bool npy_header(const char *path, struct npy *array, const char **reason)
{
    FILE *file = input_open(path, MOST_BYTES, reason);
    *array = (struct npy){0};
    bool good = file && take_header(file, array, reason);
    if (file)
        fclose(file);
    return good;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

void *npy_read(const char *path, struct npy *array, const char **reason)
{
    size_t bytes = sizeof(uint32_t), length;
    if (!npy_header(path, array, reason))
        return NULL;
    for (uint32_t i = 0; i < array->dimensions; i++)
        bytes *= array->shape[i];
    char *text = input_read(path, MOST_BYTES, &length, reason);
    if (text && length != array->offset + bytes) {
        snprintf(reason_text, MOST_REASON, "it has %zu bytes of numbers; its header says %zu",
                 length < array->offset ? 0 : length - array->offset, bytes);
        *reason = reason_text;
        free(text);
        return NULL;
    }
    if (text)
        memmove(text, text + array->offset, bytes);
    return text;
}

static const char *numpy_type(enum dt_type scalar)
{
    return scalar == DT_TYPE_FLOAT ? "float32" : scalar == DT_TYPE_INT ? "int32" : "uint32";
}

const char *npy_misfit(const struct npy *array, enum dt_type type)
{
    if (type >= DT_TYPE_BOOL)
        return "its elements can be scalars and vectors only";
    /* enum dt_type has one to four components of float, then of int, then of uint */
    enum dt_type scalar = (enum dt_type)(type / 4 * 4);
    uint32_t components = type % 4 + 1, found = array->dimensions > 1 ? array->shape[1] : 1;
    if (array->type != scalar) {
        snprintf(reason_text, MOST_REASON, "its numbers are %s, not %s", numpy_type(array->type),
                 numpy_type(scalar));
        return reason_text;
    }
    if (array->dimensions <= 2 && found == components)
        return NULL;
    int used = snprintf(reason_text, MOST_REASON, "its shape is (");
    for (uint32_t i = 0; i < array->dimensions; i++)
        used += snprintf(reason_text + used, MOST_REASON - (size_t)used, "%s%u", i ? ", " : "",
                         array->shape[i]);
    snprintf(reason_text + used, MOST_REASON - (size_t)used,
             components > 1 ? "); these elements need (n, %u)" : "); these elements need (n)",
             components);
    return reason_text;
}
