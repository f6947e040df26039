/* Sums of the path tracer per pixel, in double, in order of the samples; their noise; and the
 * checkpoint file from which a later run continues. */
#pragma once

#include "diptych.h"

struct film {
    uint32_t width, height;
    uint32_t samples; /* of every pixel */
    /* Red, green, blue, row 0 at the top: sums of the samples before the last power of two below
     * `samples`, and of those from there on. Each is a picture in its own right, and how far they
     * are apart tells the noise. */
    double *sums[2];
};

/* All zero. On false the error is logged. */
bool film_create(struct film *film, uint32_t width, uint32_t height, const struct dt_log *log);
void film_free(struct film *film); /* takes a zeroed one */

/* The picture: width * height * 3 floats. There is at least one sample. */
void film_mean(const struct film *film, float *texels);

/* Adds one sample to a pixel. Samples of a pixel come in order, from 0; `samples` is raised after
 * all pixels have the same number. */
void film_add(struct film *film, size_t pixel, uint32_t sample, const float rgb[3]);

/* Standard error of a pixel's luminance (ITU-R BT.709), root mean square over the picture, relative
 * to the mean luminance of the picture. From the difference of the two sums, so it needs two
 * samples: INFINITY before that; 0 for a black picture. Right for independent samples; where they
 * avoid one another, as Sobol points do, up to half more than the truth. */
double film_noise(const struct film *film);

/* Checkpoints, whole or not at all. `settings` is one line with everything that the sums depend on
 * except the number of samples; a file with another line is refused. film_load needs a film of the
 * right size and leaves it unchanged on false. */
bool film_save(const struct film *film, const char *path, const char *settings,
               const struct dt_log *log);
bool film_load(struct film *film, const char *path, const char *settings, const struct dt_log *log);
