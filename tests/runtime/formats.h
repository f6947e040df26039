/* A pipeline with an image of every format and shape, and two buffers; its only pass does
 * nothing. Written content must be read back bit for bit, in every format and mip, and no other
 * content may change. For tests of the runtimes. */
#pragma once

#include "panel.h"

enum {
    FORMATS_MIPS = 3,
    FORMATS_PLAIN = 0,                    /* by enum dt_format from here on: 13 x 7 */
    FORMATS_LAYERED = DT_FORMAT_COUNT,    /* 13 x 7 x 2 */
    FORMATS_VOLUME = 2 * DT_FORMAT_COUNT, /* 13 x 7 x 5; r32f in place of d32f */
    FORMATS_CUBE = 3 * DT_FORMAT_COUNT,   /* 7 x 7 x 6 */
    FORMATS_CUBES = 4 * DT_FORMAT_COUNT,  /* 7 x 7 x 12 */
    FORMATS_SMALL =
        5 * DT_FORMAT_COUNT, /* a buffer of 4 bytes, smaller than any that the runtimes make */
    FORMATS_ODD,             /* one of 13 x 12 bytes */
    FORMATS_RESOURCES
};

extern const struct dt_shaders formats_gl, formats_vk;

void formats_prepare(void); /* call before use */

/* Opens, writes everything, reads everything, before and after a frame; closes. */
void formats_run(const struct dt_runtime *runtime, const struct dt_runtime_options *options,
                 const struct dt_shaders *shaders, const uint32_t *errors);
