/* A C version of a pass, which shows what the CPU could reach. The spec names the file with
 * `limit`. diptych bench compiles it with -O3 -march=native -ffast-math -fopenmp, checks it against
 * the pass's shader, and measures both in turn. The file includes this header and the pipeline's
 * NAME.h. For the pass PASS it defines
 *
 *     const struct dt_limit_tolerance limit_PASS_tolerance = {...};
 *     void limit_PASS(const struct dt_limit *limit) {...}
 *
 * or nothing, if the processor lacks the instructions that the code needs. A file for the passes of
 * several pipelines includes DT_LIMIT_HEADER instead of NAME.h, and names a resource by
 * DT_LIMIT_RESOURCE(NAME): the generator defines both macros at the head of the file. */
#ifndef DIPTYCH_LIMIT_H
#define DIPTYCH_LIMIT_H

#include "diptych.h"

/* Two numbers agree if they differ by at most `relative` times a magnitude: the larger one of the
 * two, or the mean of all numbers if that is more. */
struct dt_limit_tolerance {
    double relative;
    double outliers; /* share of numbers that may disagree, 0..1 */
};

struct dt_limit {
    const struct dt_frame *frame; /* width and height are filled */
    const void *live;             /* the live block */
    const struct dt_scene *scene; /* that draws draw */
    /* by resource index: mip 0 of the pass's inputs and outputs; data is NULL for other resources.
     * Layout as in struct dt_runtime's read. */
    const struct dt_bytes *inputs;
    struct dt_bytes *outputs; /* the function writes all bytes */
};

#endif
