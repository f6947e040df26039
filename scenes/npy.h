/* Arrays in NumPy's .npy files, versions 1.0 to 3.0: 32-bit numbers, little-endian, in C order; all
 * else is refused. Called by gen, which needs the shape, and by the app. */
#ifndef DIPTYCH_SCENES_NPY_H
#define DIPTYCH_SCENES_NPY_H

#include "diptych.h"

enum { NPY_MOST_DIMENSIONS = 4 };

struct npy {
    enum dt_type type; /* DT_TYPE_FLOAT, DT_TYPE_INT or DT_TYPE_UINT */
    uint32_t dimensions;
    uint32_t shape[NPY_MOST_DIMENSIONS]; /* at least 1 each */
    size_t offset;                       /* of the first number in the file */
};

/* Both: false or NULL: *reason, valid until the next call in this thread. */
bool npy_header(const char *path, struct npy *array, const char **reason);
/* All numbers, four bytes each; free(). Checks that the file has exactly as many. */
void *npy_read(const char *path, struct npy *array, const char **reason);

/* Whether elements of this type can be taken from the array: its numbers have the type's scalar,
 * and behind the first dimension come the type's components: (n) for float, (n, 3) for vec3. NULL:
 * they can; else what is wrong, valid until the next call in this thread. */
const char *npy_misfit(const struct npy *array, enum dt_type type);

#endif
