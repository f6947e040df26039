/* How far two copies of one resource are apart, under its contract. Called by compare. */
#ifndef DIPTYCH_DIFFERENCE_H
#define DIPTYCH_DIFFERENCE_H

#include "diptych.h"
#include "texels.h"

enum verdict {
    VERDICT_EQUAL,   /* bit for bit */
    VERDICT_WITHIN,  /* apart, but within the contract's tolerance */
    VERDICT_DIFFERS, /* beyond the contract */
};

/* The largest error seen, in the contract's own measure: absolute for exact and abs, else ulp or
 * relative. */
struct worst {
    bool valid;
    double error; /* INFINITY where NaN or Inf make it meaningless */
    uint32_t frame;
    uint64_t element;
    struct component component;
    uint32_t bits[2];
    double values[2];
};

/* Of one resource after one pass, over all frames compared so far. Zero-initialise. */
struct difference {
    uint64_t elements;   /* or texels, in one frame */
    uint64_t differing;  /* with at least one differing number */
    uint64_t beyond;     /* with at least one number beyond the contract */
    uint64_t not_finite; /* numbers that are NaN or Inf in either copy */
    bool size_differs;   /* the copies have different sizes: nothing else was compared */
    uint32_t extent[3];
    struct worst worst;
};

/* Adds one frame's copies. Only declared fields count: padding is nobody's. NaN and Inf never pass
 * under a tolerance; under `exact` equal bits pass. False when out of memory. */
bool difference_add(struct difference *difference, const struct dt_resource *resource,
                    uint32_t frame, const struct dt_bytes copies[2]);

enum verdict difference_verdict(const struct difference *difference);
const char *verdict_name(enum verdict verdict); /* "equal", "within", "DIFFERS" */

#endif
