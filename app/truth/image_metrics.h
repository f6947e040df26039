/* How far a picture is from its reference, in numbers. */
#ifndef DIPTYCH_IMAGE_METRICS_H
#define DIPTYCH_IMAGE_METRICS_H

#include <stddef.h>

#include "truth/flip.h"

/* How far one picture is from its reference. Over all three channels of all pixels that are finite
 * in both; shares are of these pixels. All members are double. */
struct image_errors {
    double mean_reference, mean_test;
    double ratio; /* mean_test / mean_reference; NAN or INFINITY for a black reference */
    /* Shares of pixels whose luminance is below a fifth of the reference's, and above five times. 0
     * to 1; a pixel that is black in both counts in neither. */
    double darker, brighter;
    /* mean of |test - reference| / (|test| + |reference| + 0.01), 0 to 1: the symmetric mean
     * absolute percentage error of Vogels et al., SIGGRAPH 2018, with their constant. Half as
     * bright weighs as much as twice as bright. */
    double smape;
    double mean_absolute;
    double rmse; /* root of the mean squared error */
    /* mean of (test - reference)2 / (reference2 + 0.01): Rousselle, Knaus, Zwicker, SIGGRAPH Asia
     * 2011, with the constant that makes black count; relative to the exposed image. A pixel that
     * is too dark adds 1 at most. */
    double relative_mse;
    double psnr;       /* dB, for a peak of 1; INFINITY for equal images */
    double flip;       /* mean over the picture; NAN here, the caller measures it, see flip.h */
    double not_finite; /* pixels left out */
};
struct image_errors image_errors_measure(const struct rgb_image *reference,
                                         const struct rgb_image *test);

/* The numbers of image_errors, as every table, CSV file, JSON file and plot has them. The first
 * IMAGE_HEADLINES stand in tables and plots. */
struct image_number {
    const char *name;  /* in JSON and CSV */
    const char *title; /* in tables and plots */
    size_t offset;     /* in struct image_errors */
    bool mapped;       /* sweeps and reports take that of the tone-mapped picture */
    bool share;        /* from 0; its axis is not logarithmic */
};
enum { IMAGE_HEADLINES = 6, IMAGE_NUMBERS = 11 };
extern const struct image_number image_numbers[IMAGE_NUMBERS];

double image_number_of(const struct image_errors *errors, const struct image_number *number);

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
