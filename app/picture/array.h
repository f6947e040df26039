/* Resources as arrays in NumPy's .npy files. */
#pragma once

#include "diptych.h"

/* All numbers of a resource, as a runtime's read gives it. A buffer is an array of its elements, with the fields' names and
 * without padding. An image has the shape (layers, rows, columns, channels), row 0 first; codes of unorm and snorm stay
 * codes, numbers that are packed become float. Writes the whole file or nothing; logs its error. */
bool array_write(const char *path, const struct dt_resource *resource, const struct dt_bytes *bytes,
                 const struct dt_log *log);
