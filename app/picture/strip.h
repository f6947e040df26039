/* A picture of a difference: first copy, second copy and their difference, side by side. */
#pragma once

#include "diptych.h"

/* What a strip shows. */
struct strip {
    uint32_t layer; /* the one with the largest difference, or with NaN or Inf */
    /* The power of two that differences are multiplied by, so that all but one in a hundred texels
     * that differ come to 1, full brightness, at most. 0 for integers, whose differences are
     * white. */
    double amplification;
};

/* Writes a PNG of one image resource: left the first copy, in the middle the second, both by one
 * mapping (see picture_codes), right their difference, channel by channel; that in alpha counts for
 * all three. Equal texels are black there; the brightness of others grows from dark grey with the
 * square root of the amplified difference, and NaN and Inf are magenta. A yellow square stands around
 * the largest difference. Small images are enlarged by whole numbers. Fails, with the error logged,
 * for a buffer, for copies of different sizes and for an empty image. */
bool strip_write(struct strip *strip, const char *path, const struct dt_resource *resource,
                 const struct dt_bytes copies[2], const struct dt_log *log);

/* The same three as PNGs of their own, not enlarged and without the square: first copy, second copy,
 * difference. For a NULL path nothing is written. */
bool strip_write_apart(struct strip *strip, const char *const paths[3],
                       const struct dt_resource *resource, const struct dt_bytes copies[2],
                       const struct dt_log *log);
