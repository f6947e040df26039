/* FLIP: how different two images look when one flips between them, per pixel.
 *
 * Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: FLIP: A Difference Evaluator for
 * Alternating Images, High Performance Graphics 2020 (LDR); Andersson, Nilsson, Shirley,
 * Akenine-Moller: Visualizing Errors in Rendered High Dynamic Range Images, Eurographics 2021
 * (HDR). Names and constants are the papers'. */
#ifndef DIPTYCH_FLIP_H
#define DIPTYCH_FLIP_H

#include <stdbool.h>
#include <stdint.h>

/* Of a 0.7 m wide monitor with 3840 pixels seen from 0.7 m, the papers' default. */
#define FLIP_PIXELS_PER_DEGREE      67.02064327658226
#define FLIP_MOST_PIXELS_PER_DEGREE 4096.0

/* Linear RGB (Rec. 709), three floats a pixel, row by row. Borrowed. */
struct rgb_image {
    uint32_t width, height;
    const float *texels;
};

/* The exposures, in stops, that the HDR version looks at: from where the brightest pixel of the
 * reference is nearly white to where its median is. */
struct flip_exposures {
    double start, stop;
    uint32_t count;
};

/* Both images have the same size; `errors` takes width * height values in 0..1. False when out of
 * memory. Values outside 0..1 are clamped. pixels_per_degree: 1 to FLIP_MOST_PIXELS_PER_DEGREE. */
bool flip_ldr(const struct rgb_image *reference, const struct rgb_image *test,
              double pixels_per_degree, float *errors);

/* The largest LDR error over all exposures under the ACES curve. Negative values count as black. An
 * image whose reference is black has one exposure of 0. */
bool flip_hdr(const struct rgb_image *reference, const struct rgb_image *test,
              double pixels_per_degree, float *errors, struct flip_exposures *exposures);

#endif
