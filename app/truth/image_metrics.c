/* Errors of pictures; see image_metrics.h. */
#include "truth/image_metrics.h"

#include <math.h>
#include <stdlib.h>

#include "console/spread.h"

static bool is_finite_pixel(const float *texel)
{
    return isfinite(texel[0]) && isfinite(texel[1]) && isfinite(texel[2]);
}

static double luminance(const float *texel)
{
    return 0.2126 * (double)texel[0] + 0.7152 * (double)texel[1] + 0.0722 * (double)texel[2];
}

#define AT(member) offsetof(struct image_errors, member)
const struct image_number image_numbers[IMAGE_NUMBERS] = {
    {"relative_mse", "relative MSE", AT(relative_mse), false, false},
    {"smape", "SMAPE", AT(smape), false, false},
    {"flip", "FLIP", AT(flip), true, false},
    {"ratio", "mean / reference", AT(ratio), false, false},
    {"darker", "darker than 1/5", AT(darker), false, true},
    {"brighter", "brighter than 5 times", AT(brighter), false, true},
    {"rmse", "RMSE", AT(rmse), false, false},
    {"psnr", "PSNR, dB", AT(psnr), true, false},
    {"mean_absolute", "mean absolute error", AT(mean_absolute), false, false},
    {"mean_test", "mean", AT(mean_test), false, false},
    {"mean_reference", "mean of the reference", AT(mean_reference), false, false},
};

double image_number_of(const struct image_errors *errors, const struct image_number *number)
{
    return *(const double *)((const char *)errors + number->offset);
}

/* Adds a pixel to the sums; returns the sum of its squared errors. */
static double add_squared_errors(struct image_errors *sums, const float *right, const float *given)
{
    const double epsilon = 0.01, factor = 5;
    double squares = 0;
    for (int channel = 0; channel < 3; channel++) {
        double truth = (double)right[channel], value = (double)given[channel];
        double error = fabs(value - truth);
        sums->mean_reference += truth;
        sums->mean_test += value;
        sums->mean_absolute += error;
        sums->smape += error / (fabs(value) + fabs(truth) + epsilon);
        sums->relative_mse += error * error / (truth * truth + epsilon);
        squares += error * error;
    }
    sums->darker += factor * luminance(given) < luminance(right);
    sums->brighter += luminance(given) > factor * luminance(right);
    return squares;
}

struct image_errors image_errors_measure(const struct rgb_image *reference,
                                         const struct rgb_image *test)
{
    struct image_errors sums = {.flip = NAN};
    uint64_t count = (uint64_t)reference->width * reference->height;
    double squares = 0;
    for (uint64_t i = 0; i < count; i++) {
        const float *right = reference->texels + 3 * i, *given = test->texels + 3 * i;
        if (is_finite_pixel(right) && is_finite_pixel(given))
            squares += add_squared_errors(&sums, right, given);
        else
            sums.not_finite++;
    }
    double pixels = fmax((double)count - sums.not_finite, 1), numbers = 3 * pixels;
    sums.ratio = sums.mean_test / sums.mean_reference;
    sums.darker /= pixels;
    sums.brighter /= pixels;
    sums.mean_reference /= numbers;
    sums.mean_test /= numbers;
    sums.mean_absolute /= numbers;
    sums.smape /= numbers;
    sums.relative_mse /= numbers;
    sums.rmse = sqrt(squares / numbers);
    sums.psnr = squares > 0 ? -10 * log10(squares / numbers) : INFINITY;
    return sums;
}

bool distribution_measure(struct distribution *distribution, const float *values, uint64_t count)
{
    double *sorted = malloc((count ? count : 1) * sizeof *sorted), sum = 0;
    *distribution = (struct distribution){0};
    if (!sorted)
        return false;
    for (uint64_t i = 0; i < count; i++) {
        sorted[i] = (double)values[i];
        sum += sorted[i];
    }
    if (count) {
        sort_numbers(sorted, count);
        distribution->mean = sum / (double)count;
        distribution->median = quantile(sorted, count, 0.5);
        distribution->p95 = quantile(sorted, count, 0.95);
        distribution->p99 = quantile(sorted, count, 0.99);
        distribution->most = sorted[count - 1];
    }
    free(sorted);
    return true;
}

double exposure_of(const struct rgb_image *image)
{
    const double key = 0.18;
    uint64_t count = (uint64_t)image->width * image->height, counted = 0;
    double sum = 0;
    for (uint64_t i = 0; i < count; i++) {
        const float *texel = image->texels + 3 * i;
        if (!is_finite_pixel(texel) || !(luminance(texel) > 0))
            continue;
        sum += log(luminance(texel));
        counted++;
    }
    return counted ? key / exp(sum / (double)counted) : 1;
}

void tone_map(const struct rgb_image *image, double exposure, float *texels)
{
    const double white = 4;
    uint64_t count = (uint64_t)image->width * image->height;
    for (uint64_t i = 0; i < count; i++) {
        const float *texel = image->texels + 3 * i;
        double scaled = exposure * luminance(texel);
        double factor = exposure * (1 + scaled / (white * white)) / (1 + scaled);
        for (int channel = 0; channel < 3; channel++) {
            double value = factor * (double)texel[channel];
            texels[3 * i + (uint64_t)channel] = (float)(value > 0 ? fmin(value, 1) : 0);
        }
    }
}

void magma(float error, uint8_t rgb[3])
{
    static const uint8_t stops[9][3] = {{0, 0, 4},      {28, 16, 68},    {79, 18, 123},
                                        {129, 37, 129}, {181, 54, 122},  {229, 80, 100},
                                        {251, 135, 97}, {254, 194, 135}, {252, 253, 191}};
    double at = error > 0 ? 8.0 * fmin((double)error, 1) : 0;
    int stop = at < 8 ? (int)at : 7;
    for (int channel = 0; channel < 3; channel++) {
        double low = stops[stop][channel], high = stops[stop + 1][channel];
        rgb[channel] = (uint8_t)lround(low + (high - low) * (at - stop));
    }
}
