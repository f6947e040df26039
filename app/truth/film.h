/* What the path tracer has summed up so far: per pixel, in double, in the order of the samples. Also
 * how noisy it is, and the checkpoint file that a later run carries on from. Called by tracer, which
 * adds, and by reference. */
#ifndef DIPTYCH_FILM_H
#define DIPTYCH_FILM_H

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

/* Adds one sample to a pixel. All samples of a pixel come in their order, from 0, and all pixels get
 * the same number before `samples` is raised. */
void film_add(struct film *film, size_t pixel, uint32_t sample, const float rgb[3]);

/* Standard error of a pixel's luminance (ITU-R BT.709), root mean square over the picture, relative
 * to the mean luminance of the picture. From the difference of the two sums, so it needs two
 * samples: INFINITY before that; 0 for a black picture. Right for independent samples; where they
 * avoid one another, as Sobol points do, up to half more than the truth. */
double film_noise(const struct film *film);

/* Checkpoints: all or nothing. `settings` is one line that tells everything that the sums depend on
 * but for the number of samples; a file with another line is refused. film_load wants a film of the
 * right size and leaves it alone on false. */
bool film_save(const struct film *film, const char *path, const char *settings,
               const struct dt_log *log);
bool film_load(struct film *film, const char *path, const char *settings, const struct dt_log *log);

#endif
