/* Pictures of linear light in files. OpenEXR, which loads in a millisecond, writes and reads EXR;
 * scenes/image.h reads everything else. */
#pragma once

#include "scenes/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes RGB, 32-bit floats, as EXR: the whole file or nothing. Row 0 is the top. Equal pictures are equal files. */
bool hdr_write(const char *path, uint32_t width, uint32_t height, const float *rgb,
               const struct dt_log *log);
/* Reads RGBA; alpha is 1 where the file has none. *rgba is malloc'ed. */
bool hdr_read(const char *path, uint32_t *width, uint32_t *height, float **rgba,
              const struct dt_log *log);

#ifdef __cplusplus
}
#endif
