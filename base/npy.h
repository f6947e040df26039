/* Arrays in NumPy's .npy files, versions 1.0 to 3.0: numbers, little-endian, in C order, plain or in a
 * structured dtype without padding; all else is refused. */
#pragma once

#include "diptych.h"

enum { NPY_MOST_DIMENSIONS = 3, NPY_MOST_FIELDS = 32, NPY_MOST_NAME = 64 };

struct npy_field {
    char name[NPY_MOST_NAME]; /* empty: the array has no structured dtype, and one field */
    enum dt_type type;        /* DT_TYPE_FLOAT, DT_TYPE_INT, DT_TYPE_UINT or DT_TYPE_BOOL */
    uint32_t bytes;           /* of a number */
    uint32_t dimensions, shape[NPY_MOST_DIMENSIONS]; /* behind the array's first; at least 1 each */
    uint32_t numbers;                                /* product of shape; 1 without dimensions */
};

struct npy {
    uint32_t count; /* elements: the first dimension, at least 1; 1 of an array without any */
    uint32_t field_count;
    struct npy_field fields[NPY_MOST_FIELDS];
    uint32_t numbers, stride; /* numbers and bytes of an element: all fields, one after the other */
    size_t offset;            /* of the first number in the file */
};

/* All: false or NULL: *reason, valid until the next call in this thread. The first two refuse numbers that
 * have not four bytes, as buffers of specs do. */
bool npy_header(const char *path, struct npy *array, const char **reason);
/* All numbers; free(). Checks that the file has exactly as many. */
void *npy_read(const char *path, struct npy *array, const char **reason);
/* Of a whole file in memory, which has exactly the numbers that the header says. */
bool npy_parse(const uint8_t *file, size_t size, struct npy *array, const char **reason);

/* Whether the array has elements of these fields, as in struct dt_resource: names, types and shapes
 * in their order; a field of an empty name is the whole element. The shape of float is (), of vec3
 * (3), of vec3[2] (2, 3), of mat4 (4, 4), by columns. NULL: it has; else what is wrong, valid until
 * the next call in this thread. */
const char *npy_misfit(const struct npy *array, const struct dt_field *fields, uint32_t count);
