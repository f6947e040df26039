/* How far a picture is from its reference, in numbers. Called by metrics. */
#ifndef DIPTYCH_IMAGE_METRICS_H
#define DIPTYCH_IMAGE_METRICS_H

#include "truth/flip.h"

/* Over all three channels of all pixels that are finite in both images. */
struct image_errors {
    double mean_reference, mean_test;
    double mean_absolute;
    double rmse; /* root of the mean squared error */
    /* mean of (test - reference)2 / (reference2 + 0.01): Rousselle, Knaus, Zwicker, SIGGRAPH Asia
     * 2011, with the constant that makes black count; relative to the exposed image */
    double relative_mse;
    double psnr;         /* dB, for a peak of 1; INFINITY for equal images */
    uint64_t not_finite; /* pixels left out */
};
struct image_errors image_errors_measure(const struct rgb_image *reference,
                                         const struct rgb_image *test);

/* Mean and largest of `count` values, and quantiles, see spread.h. */
struct distribution {
    double mean, median, p95, p99, most;
};
bool distribution_measure(struct distribution *distribution, const float *values, uint64_t count);

/* The factor that takes the log-average luminance of an image to 0.18, where pixels that are black
 * or not finite do not count: Reinhard et al., SIGGRAPH 2002, equations 1 and 2. 1 for a black
 * image. */
double exposure_of(const struct rgb_image *image);

/* Reinhard et al., equation 4, on luminance, with white at 4, as the shipped pipelines do; 0..1,
 * linear. texels: width * height * 3. */
void tone_map(const struct rgb_image *image, double exposure, float *texels);

/* An error of 0..1 as a colour of the magma map (Smith, van der Walt: black over purple and orange to
 * pale yellow). */
void magma(float error, uint8_t rgb[3]);

#endif
