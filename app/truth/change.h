/* How much pictures of the same surfaces change from one frame to the next, while camera and light
 * move.
 *
 * Be E(t, p) what pixel p shows in frame t, of irradiance in W/m2 per channel, and x(t, p) the point
 * of the scene at its centre. The pixel of frame t + 1 is compared where that point was seen before:
 *
 *   D(p) = E(t + 1, p) - E(t, q),   q = project(t, x(t + 1, p)),   E(t, q) bilinear
 *
 * A pixel next to q counts as another surface, and p is left out, where it lies outside the picture,
 * shows the background, turns its normal away by more than an angle whose cosine is 0.9, or lies off
 * the tangent plane of x(t + 1, p) by more than 0.005 of the depth of it. That leaves out what came
 * into view, and the edges; light that moves over a surface is compared.
 *
 *   change    = mean over p and channels of |D(p)|              W/m2 per frame
 *   flicker   = mean over p and channels of |D(p) - D'(p)|      W/m2 per frame
 *
 * with D' of the reference: what the pictures change beyond, short of, or elsewhere than the truth
 * does. With blocks, D and D' are first averaged over the compared pixels of every square of
 * `block` x `block` pixels, and the mean is over these, each weighted by its number of pixels: noise of
 * the reference, which is another in every pixel, becomes `block` times smaller, and what wanders over
 * whole surfaces stays. */
#ifndef DIPTYCH_CHANGE_H
#define DIPTYCH_CHANGE_H

#include <stddef.h>

#include "truth/flip.h"

/* The surface at a pixel's centre. */
struct seen_point {
    float position[3];
    float depth;     /* along the view; 0: background */
    float normal[3]; /* unit, as interpolated */
    float plane[3];  /* unit, of the triangle */
};

/* Surfaces of a frame, row 0 at the top. Borrowed. */
struct seen {
    uint32_t width, height;
    const struct seen_point *points;
    float view_projection[4][4]; /* clip space as in struct dt_view */
};

/* Change between two frames, see above; or sums over many pairs. */
struct change {
    uint64_t surfaces; /* pixels that show a surface */
    uint64_t compared; /* of these, those visible before, with finite values; 0: all below is 0 */
    double mean, mean_reference; /* mean of the compared pixels in the later frame, W/m2 */
    double change, change_reference, flicker;
};

/* Compares frames t and t + 1: surfaces and pictures, all of one size. `reference` may be NULL: its
 * numbers are then left out. block: 1 and up. False when out of memory. */
bool change_measure(struct change *change, const struct seen seen[2],
                    const struct rgb_image test[2], const struct rgb_image reference[2],
                    uint32_t block);

/* The means over all pixels of some pairs of frames. */
struct change change_mean(const struct change *list, uint32_t count);

#endif
