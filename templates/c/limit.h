/* What the CPU could do in place of a pass: plain C that the spec names by `limit`, which diptych
 * bench compiles with -O3 -march=native -ffast-math -fopenmp, checks against the pass's shader, and
 * measures in turn with it. The file includes this header and the pipeline's own, NAME.h, for its
 * structs, parameters and indices, and defines for the pass PASS
 *
 *     const struct dt_limit_tolerance limit_PASS_tolerance = {...};
 *     void limit_PASS(const struct dt_limit *limit) {...}
 *
 * or nothing where the processor lacks what it is written for. */
#ifndef DIPTYCH_LIMIT_H
#define DIPTYCH_LIMIT_H

#include "diptych.h"

/* A number agrees with the shader's when they differ by at most `relative` times the larger, or times
 * the mean magnitude of all, whichever is more. */
struct dt_limit_tolerance {
    double relative;
    double outliers; /* share of numbers that may do otherwise, 0..1 */
};

struct dt_limit {
    const struct dt_frame *frame; /* width and height are filled */
    const void *live;             /* the live block */
    /* by index of resource: mip 0 of what the pass reads, and of what it writes; data is NULL
     * elsewhere. Bytes as struct dt_runtime's read gives them. */
    const struct dt_bytes *inputs;
    struct dt_bytes *outputs; /* to be written whole */
};

#endif
