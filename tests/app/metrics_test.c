/* Image metrics against closed forms, published colours, and a second FLIP that is written from the
 * papers in another way: every filter as one two-dimensional sum, all in double precision. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "app/truth/image_metrics.h"
#include "scenes/image.h"

enum { WIDTH = 29, HEIGHT = 23, PIXELS = WIDTH * HEIGHT };

struct fixture {
    float reference[PIXELS * 3], test[PIXELS * 3], errors[PIXELS];
};

static struct rgb_image image_of(const float *texels)
{
    return (struct rgb_image){WIDTH, HEIGHT, texels};
}

static void fill(float *texels, float r, float g, float b)
{
    for (int i = 0; i < PIXELS; i++) {
        texels[3 * i] = r;
        texels[3 * i + 1] = g;
        texels[3 * i + 2] = b;
    }
}

/* Repeatable noise in 0..1. */
static float noise(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (float)(*seed >> 8) / 16777216.0f;
}

static void fill_noise(struct fixture *f, float scale)
{
    uint32_t seed = 7;
    for (int i = 0; i < PIXELS * 3; i++) {
        f->reference[i] = scale * noise(&seed);
        f->test[i] = fmaxf(0, f->reference[i] + scale * 0.3f * (noise(&seed) - 0.5f));
    }
}

/* ---- FLIP, written a second time ------------------------------------------------------------- */

/* The paper's transforms with the usual rounded constants of sRGB and D65. */
static void to_xyz(const double rgb[3], double xyz[3])
{
    xyz[0] = (0.4124564 * rgb[0] + 0.3575761 * rgb[1] + 0.1804375 * rgb[2]) / 0.95047;
    xyz[1] = 0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2];
    xyz[2] = (0.0193339 * rgb[0] + 0.1191920 * rgb[1] + 0.9503041 * rgb[2]) / 1.08883;
}

static void to_rgb(const double xyz[3], double rgb[3])
{
    double x = xyz[0] * 0.95047, y = xyz[1], z = xyz[2] * 1.08883;
    rgb[0] = 3.2404542 * x - 1.5371385 * y - 0.4985314 * z;
    rgb[1] = -0.9692660 * x + 1.8760108 * y + 0.0415560 * z;
    rgb[2] = 0.0556434 * x - 0.2040259 * y + 1.0572252 * z;
}

static double lab_f(double t)
{
    return t > 0.008856451679 ? pow(t, 1.0 / 3) : 7.787037037 * t + 16.0 / 116;
}

static void to_hunt_lab(const double rgb[3], double lab[3])
{
    double xyz[3];
    to_xyz(rgb, xyz);
    lab[0] = 116 * lab_f(xyz[1]) - 16;
    lab[1] = 500 * (lab_f(xyz[0]) - lab_f(xyz[1])) * lab[0] / 100;
    lab[2] = 200 * (lab_f(xyz[1]) - lab_f(xyz[2])) * lab[0] / 100;
}

static double distance(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + sqrt((a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static double ycxcz(const float *texels, int x, int y, int channel)
{
    x = x < 0 ? 0 : x >= WIDTH ? WIDTH - 1 : x;
    y = y < 0 ? 0 : y >= HEIGHT ? HEIGHT - 1 : y;
    const float *t = texels + 3 * (y * WIDTH + x);
    double rgb[3] = {t[0], t[1], t[2]}, xyz[3];
    to_xyz(rgb, xyz);
    return channel == 0   ? 116 * xyz[1] - 16
           : channel == 1 ? 500 * (xyz[0] - xyz[1])
                          : 200 * (xyz[1] - xyz[2]);
}

static double csf(double degrees2, int channel)
{
    const double pi = 3.14159265358979;
    if (channel == 2)
        return 34.1 * sqrt(pi / 0.04) * exp(-pi * pi * degrees2 / 0.04) +
               13.5 * sqrt(pi / 0.025) * exp(-pi * pi * degrees2 / 0.025);
    double b = channel == 0 ? 0.0047 : 0.0053;
    return exp(-pi * pi * degrees2 / b);
}

static void filtered(const float *texels, int x, int y, double ppd, double lab[3])
{
    int radius = (int)ceil(3 * sqrt(0.04 / (2 * 3.14159265358979 * 3.14159265358979)) * ppd);
    double color[3], xyz[3], rgb[3];
    for (int channel = 0; channel < 3; channel++) {
        double sum = 0, weights = 0;
        for (int dy = -radius; dy <= radius; dy++)
            for (int dx = -radius; dx <= radius; dx++) {
                double weight = csf((dx * dx + dy * dy) / (ppd * ppd), channel);
                sum += weight * ycxcz(texels, x + dx, y + dy, channel);
                weights += weight;
            }
        color[channel] = sum / weights;
    }
    xyz[1] = (color[0] + 16) / 116;
    xyz[0] = xyz[1] + color[1] / 500;
    xyz[2] = xyz[1] - color[2] / 200;
    to_rgb(xyz, rgb);
    for (int i = 0; i < 3; i++)
        rgb[i] = rgb[i] < 0 ? 0 : rgb[i] > 1 ? 1 : rgb[i];
    to_hunt_lab(rgb, lab);
}

/* The response to an edge (1) or point (2) along x (0) or y (1). */
static double response(const float *texels, int x, int y, double ppd, int order, int axis)
{
    double sd = 0.5 * 0.082 * ppd, positive = 0, negative = 0, sums[2] = {0, 0};
    int radius = (int)ceil(3 * sd);
    for (int dy = -radius; dy <= radius; dy++)
        for (int dx = -radius; dx <= radius; dx++) {
            double along = axis == 0 ? dx : dy;
            double weight = exp(-(dx * dx + dy * dy) / (2 * sd * sd)) *
                            (order == 1 ? -along : along * along / (sd * sd) - 1);
            double value = (ycxcz(texels, x + dx, y + dy, 0) + 16) / 116;
            sums[weight < 0] += weight * value;
            positive += weight > 0 ? weight : 0;
            negative += weight < 0 ? -weight : 0;
        }
    return sums[0] / positive + sums[1] / negative;
}

static double strength(const float *texels, int x, int y, double ppd, int order)
{
    return hypot(response(texels, x, y, ppd, order, 0), response(texels, x, y, ppd, order, 1));
}

static double remap(double hyab)
{
    const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    double a[3], b[3];
    to_hunt_lab(green, a);
    to_hunt_lab(blue, b);
    double most = pow(distance(a, b), 0.7), value = pow(hyab, 0.7);
    return value < 0.4 * most ? 0.95 / (0.4 * most) * value
                              : 0.95 + (value - 0.4 * most) / (0.6 * most) * 0.05;
}

static double flip_at(const struct fixture *f, int x, int y, double ppd)
{
    double a[3], b[3], feature = 0;
    filtered(f->reference, x, y, ppd, a);
    filtered(f->test, x, y, ppd, b);
    for (int order = 1; order <= 2; order++)
        feature = fmax(feature, fabs(strength(f->reference, x, y, ppd, order) -
                                     strength(f->test, x, y, ppd, order)));
    return pow(remap(distance(a, b)), 1 - sqrt(feature / sqrt(2)));
}

static void flip_equals_its_two_dimensional_form(void **state)
{
    struct fixture *f = *state;
    static const double densities[] = {12, 31.5};
    fill_noise(f, 1);
    for (int i = 0; i < PIXELS * 3; i++)
        f->test[i] = fminf(f->test[i], 1);
    const struct rgb_image reference = image_of(f->reference), test = image_of(f->test);
    for (int density = 0; density < 2; density++) {
        double most = 0, largest = 0;
        assert_true(flip_ldr(&reference, &test, densities[density], f->errors));
        for (int i = 0; i < PIXELS; i++) {
            double expected = flip_at(f, i % WIDTH, i / WIDTH, densities[density]);
            most = fmax(most, fabs(expected - (double)f->errors[i]));
            largest = fmax(largest, expected);
        }
        assert_true(largest > 0.2); /* there was something to see */
        assert_true(most < 2e-4);   /* rounded constants there, single precision here */
    }
}

/* ---- FLIP in closed form --------------------------------------------------------------------- */

/* L*a*b* of sRGB's primaries as published for D65 (Lindbloom). */
static const double lab_green[3] = {87.7347, -86.1827, 83.1793};
static const double lab_blue[3] = {32.2970, 79.1875, -107.8602};

static double largest_distance(void)
{
    double a[3], b[3];
    for (int i = 0; i < 3; i++) {
        a[i] = lab_green[i] * (i ? lab_green[0] / 100 : 1);
        b[i] = lab_blue[i] * (i ? lab_blue[0] / 100 : 1);
    }
    return distance(a, b);
}

static void flip_of_plain_colours(void **state)
{
    struct fixture *f = *state;
    const struct rgb_image reference = image_of(f->reference), test = image_of(f->test);
    fill(f->reference, 0, 1, 0);
    fill(f->test, 0, 0, 1);
    assert_true(flip_ldr(&reference, &test, FLIP_PIXELS_PER_DEGREE, f->errors));
    for (int i = 0; i < PIXELS; i++)
        assert_float_equal(f->errors[i], 1, 1e-4);

    /* Black and white differ in lightness alone, by 100. */
    double most = pow(largest_distance(), 0.7), value = pow(100, 0.7);
    fill(f->reference, 0, 0, 0);
    fill(f->test, 1, 1, 1);
    assert_true(flip_ldr(&reference, &test, FLIP_PIXELS_PER_DEGREE, f->errors));
    assert_float_equal(f->errors[0], 0.95 + (value - 0.4 * most) / (0.6 * most) * 0.05, 1e-4);

    /* L* of 18 % grey is 49.496; of black, 0. Below the knee. */
    fill(f->test, 0.18f, 0.18f, 0.18f);
    assert_true(flip_ldr(&reference, &test, FLIP_PIXELS_PER_DEGREE, f->errors));
    double grey = pow(49.496, 0.7);
    assert_true(grey < 0.4 * most);
    assert_float_equal(f->errors[PIXELS - 1], 0.95 * grey / (0.4 * most), 1e-4);
}

static void flip_of_equal_images_is_zero_and_it_is_symmetric(void **state)
{
    struct fixture *f = *state;
    const struct rgb_image reference = image_of(f->reference), test = image_of(f->test);
    float other[PIXELS];
    struct flip_exposures exposures;
    fill_noise(f, 1);
    assert_true(flip_ldr(&reference, &reference, FLIP_PIXELS_PER_DEGREE, f->errors));
    for (int i = 0; i < PIXELS; i++)
        assert_true(f->errors[i] == 0);
    assert_true(flip_hdr(&test, &test, FLIP_PIXELS_PER_DEGREE, f->errors, &exposures));
    for (int i = 0; i < PIXELS; i++)
        assert_true(f->errors[i] == 0);
    assert_true(flip_ldr(&reference, &test, FLIP_PIXELS_PER_DEGREE, f->errors));
    assert_true(flip_ldr(&test, &reference, FLIP_PIXELS_PER_DEGREE, other));
    assert_memory_equal(f->errors, other, sizeof other);
}

/* The x where the ACES fit reaches 0.85, by bisection. The fit is (2.51 s2 + 0.03 s) / (2.43 s2 +
 * 0.59 s + 0.14) with s = 0.6 x. */
static double nearly_white(void)
{
    double low = 0, high = 100;
    for (int i = 0; i < 200; i++) {
        double x = 0.5 * (low + high), s = 0.6 * x;
        double y = s * (2.51 * s + 0.03) / (s * (2.43 * s + 0.59) + 0.14);
        if (y < 0.85)
            low = x;
        else
            high = x;
    }
    return low;
}

static void hdr_exposures_span_median_to_brightest(void **state)
{
    struct fixture *f = *state;
    const struct rgb_image reference = image_of(f->reference);
    struct flip_exposures exposures;
    fill(f->reference, 0.25f, 0.25f, 0.25f);
    for (int i = 0; i < 3; i++)
        f->reference[i] = 10; /* one bright pixel */
    assert_true(flip_hdr(&reference, &reference, FLIP_PIXELS_PER_DEGREE, f->errors, &exposures));
    assert_float_equal(exposures.start, log2(nearly_white() / 10), 1e-5);
    assert_float_equal(exposures.stop, log2(nearly_white() / 0.25), 1e-5);
    assert_int_equal(exposures.count, 6); /* ceil(log2(40)) */
    fill(f->reference, 0, 0, 0);
    assert_true(flip_hdr(&reference, &reference, FLIP_PIXELS_PER_DEGREE, f->errors, &exposures));
    assert_int_equal(exposures.count, 1);
}

/* HDR FLIP finds a difference that only a long exposure shows. Light that no screen could show does
 * not make the result NaN. */
static void hdr_sees_into_the_dark(void **state)
{
    struct fixture *f = *state;
    const struct rgb_image reference = image_of(f->reference), test = image_of(f->test);
    struct flip_exposures exposures;
    fill(f->reference, 0.001f, 0.001f, 0.001f);
    fill(f->test, 0.002f, 0.002f, 0.002f);
    for (int i = 0; i < 3; i++)
        f->reference[i] = f->test[i] = 1e4f;
    assert_true(flip_ldr(&reference, &test, FLIP_PIXELS_PER_DEGREE, f->errors));
    double dark = f->errors[PIXELS - 1];
    assert_true(flip_hdr(&reference, &test, FLIP_PIXELS_PER_DEGREE, f->errors, &exposures));
    assert_true(f->errors[PIXELS - 1] > 3 * dark);
    for (int i = 0; i < PIXELS; i++)
        assert_true(f->errors[i] >= 0 && f->errors[i] <= 1);
}

/* ---- The other metrics ----------------------------------------------------------------------- */

static void errors_of_two_constants(void **state)
{
    struct fixture *f = *state;
    const struct rgb_image reference = image_of(f->reference), test = image_of(f->test);
    fill(f->reference, 0.5f, 0.5f, 0.5f);
    fill(f->test, 0.6f, 0.4f, 0.5f);
    struct image_errors errors = image_errors_measure(&reference, &test);
    assert_float_equal(errors.mean_absolute, 0.2 / 3, 1e-7);
    assert_float_equal(errors.rmse, sqrt(0.02 / 3), 1e-7);
    assert_float_equal(errors.relative_mse, 0.02 / 3 / (0.25 + 0.01), 1e-7);
    assert_float_equal(errors.psnr, 10 * log10(3 / 0.02), 1e-4);
    assert_float_equal(errors.mean_test, 0.5, 1e-7);
    f->test[4] = NAN;
    f->reference[9] = INFINITY;
    errors = image_errors_measure(&reference, &test);
    assert_float_equal(errors.not_finite, 2, 0);
    assert_float_equal(errors.mean_absolute, 0.2 / 3, 1e-7);
    errors = image_errors_measure(&test, &test);
    assert_true(errors.rmse == 0 && isinf(errors.psnr));
}

/* Worked out by hand, pixel by pixel. A pixel that is NaN or Inf in either picture counts in
 * not_finite alone. */
static void darkness_shows(void **state)
{
    (void)state;
    static const float right[] = {1, 1, 1, 0, 0, 0, 0, 0,   0, 2, 2, 2,
                                  0, 1, 0, 1, 0, 0, 1, NAN, 1, 1, 1, 1};
    static const float given[] = {.125f,  .125f, .125f, 0,  0, 0, .0625f,   .0625f,
                                  .0625f, 16,    16,    16, 0, 0, 1,        0,
                                  0,      1,     0,     0,  0, 0, INFINITY, 0};
    const struct rgb_image reference = {8, 1, right}, test = {8, 1, given};
    struct image_errors errors = image_errors_measure(&reference, &test);
    assert_float_equal(errors.not_finite, 2, 0);
    /* darker: an eighth, and green that became blue, 0.7152 to 0.0722; not red that became blue, a
     * third */
    assert_float_equal(errors.darker, 2.0 / 6, 1e-12);
    assert_float_equal(errors.brighter, 2.0 / 6, 1e-12); /* black that is lit, and eight times */
    assert_float_equal(errors.ratio, (3 * 16.1875 + 2) / (3 * 3.0 + 2), 1e-12);
    double smape = 3 * (.875 / 1.135 + .0625 / .0725 + 14 / 18.01) + 4 * (1 / 1.01);
    assert_float_equal(errors.smape, smape / 18, 1e-12);
    struct image_errors swapped = image_errors_measure(&test, &reference);
    assert_float_equal(swapped.smape, errors.smape, 1e-15);
    assert_float_equal(swapped.ratio * errors.ratio, 1, 1e-12);
    assert_true(swapped.darker == errors.brighter && swapped.brighter == errors.darker);
}

/* One picture is 6.25 times too dark, the other 6.25 times too bright. For relative MSE, the first
 * error is less than a twentieth of the second. The symmetric error is the same for both. */
static void too_dark_counts_as_too_bright(void **state)
{
    struct fixture *f = *state;
    const struct rgb_image reference = image_of(f->reference), test = image_of(f->test);
    fill(f->reference, 100, 100, 100);
    fill(f->test, 16, 16, 16);
    struct image_errors dark = image_errors_measure(&reference, &test);
    fill(f->test, 625, 625, 625);
    struct image_errors bright = image_errors_measure(&reference, &test);
    assert_float_equal(dark.smape, bright.smape, 1e-3);
    assert_true(dark.relative_mse < 1 && bright.relative_mse > 20 * dark.relative_mse);
    assert_true(dark.darker == 1 && dark.brighter == 0 && bright.darker == 0 &&
                bright.brighter == 1);
}

static void a_black_reference_has_no_ratio(void **state)
{
    struct fixture *f = *state;
    const struct rgb_image reference = image_of(f->reference), test = image_of(f->test);
    fill(f->reference, 0, 0, 0);
    fill(f->test, 0, 0, 0);
    struct image_errors errors = image_errors_measure(&reference, &test);
    assert_true(isnan(errors.ratio) && errors.smape == 0 && errors.darker == 0 &&
                errors.brighter == 0);
    fill(f->test, NAN, 0, 0);
    errors = image_errors_measure(&reference, &test);
    assert_true(errors.not_finite == PIXELS && errors.smape == 0 && errors.relative_mse == 0);
}

/* Each name leads to its number. */
static void names_and_numbers(void **state)
{
    (void)state;
    const struct image_errors errors = {.relative_mse = 1,
                                        .smape = 2,
                                        .flip = 3,
                                        .ratio = 4,
                                        .darker = 5,
                                        .brighter = 6,
                                        .rmse = 7,
                                        .psnr = 8,
                                        .mean_absolute = 9,
                                        .mean_test = 10,
                                        .mean_reference = 11};
    static const char *const names[] = {"relative_mse",  "smape",     "flip",          "ratio",
                                        "darker",        "brighter",  "rmse",          "psnr",
                                        "mean_absolute", "mean_test", "mean_reference"};
    for (int i = 0; i < IMAGE_NUMBERS; i++) {
        assert_string_equal(image_numbers[i].name, names[i]);
        assert_float_equal(image_number_of(&errors, &image_numbers[i]), i + 1, 0);
    }
}

static void distributions(void **state)
{
    (void)state;
    float values[100];
    struct distribution d;
    for (int i = 0; i < 100; i++)
        values[i] = (float)((i * 37) % 100 + 1); /* 1 to 100 in another order */
    assert_true(distribution_measure(&d, values, 100));
    assert_float_equal(d.mean, 50.5, 1e-9);
    assert_float_equal(d.median, 50.5, 0); /* (100 - 1) q from 1 on, as numpy.quantile has it */
    assert_float_equal(d.p95, 95.05, 1e-5);
    assert_float_equal(d.p99, 99.01, 1e-5);
    assert_float_equal(d.most, 100, 0);
}

static void tone_mapping_follows_reinhard(void **state)
{
    struct fixture *f = *state;
    const struct rgb_image reference = image_of(f->reference);
    fill(f->reference, 2, 2, 2);
    f->reference[3] = f->reference[4] = f->reference[5] = 0; /* black does not count */
    assert_float_equal(exposure_of(&reference), 0.09, 1e-6);
    tone_map(&reference, 0.5, f->test);
    assert_float_equal(f->test[0], 1 * (1 + 1.0 / 16) / 2, 1e-6);
    assert_true(f->test[3] == 0);
    tone_map(&reference, 2, f->test); /* 4 is white */
    assert_float_equal(f->test[0], 1, 1e-6);
    fill(f->reference, 0, 0, 0);
    assert_float_equal(exposure_of(&reference), 1, 0);
}

static void magma_is_black_to_pale_and_grows_lighter(void **state)
{
    (void)state;
    uint8_t rgb[3];
    double former = -1;
    for (int i = 0; i <= 100; i++) {
        magma((float)i / 100, rgb);
        double light = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        assert_true(light > former);
        former = light;
    }
    assert_true(rgb[0] == 252 && rgb[1] == 253 && rgb[2] == 191);
    magma(NAN, rgb);
    assert_true(rgb[0] == 0);
}

static void log_nothing(void *user, enum dt_level level, const char *message)
{
    (void)user, (void)level, (void)message;
}

/* OpenImageIO up to 3.1 is blind to differences of lightness alone (its issue 4948), so the square
 * is red. */
static void yee_sees_a_red_square(void **state)
{
    struct fixture *f = *state;
    const struct dt_log log = {.message = log_nothing};
    const float view = WIDTH / (float)FLIP_PIXELS_PER_DEGREE; /* degrees */
    uint64_t failing = 7;
    fill(f->reference, 0.5f, 0.5f, 0.5f);
    fill(f->test, 0.5f, 0.5f, 0.5f);
    assert_true(image_compare_yee(WIDTH, HEIGHT, f->reference, f->test, 100, view, &failing, &log));
    assert_int_equal(failing, 0);
    for (int at = 0; at < PIXELS; at++)
        if (at % WIDTH >= 8 && at % WIDTH < 16 && at / WIDTH >= 8 && at / WIDTH < 16)
            f->test[3 * at] = 0.8f;
    assert_true(image_compare_yee(WIDTH, HEIGHT, f->reference, f->test, 100, view, &failing, &log));
    assert_int_equal(failing, 8 * 8);
}

static int setup(void **state)
{
    *state = calloc(1, sizeof(struct fixture));
    return *state ? 0 : -1;
}

static int teardown(void **state)
{
    free(*state);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flip_equals_its_two_dimensional_form),
        cmocka_unit_test(flip_of_plain_colours),
        cmocka_unit_test(flip_of_equal_images_is_zero_and_it_is_symmetric),
        cmocka_unit_test(hdr_exposures_span_median_to_brightest),
        cmocka_unit_test(hdr_sees_into_the_dark),
        cmocka_unit_test(errors_of_two_constants),
        cmocka_unit_test(darkness_shows),
        cmocka_unit_test(too_dark_counts_as_too_bright),
        cmocka_unit_test(a_black_reference_has_no_ratio),
        cmocka_unit_test(names_and_numbers),
        cmocka_unit_test(distributions),
        cmocka_unit_test(tone_mapping_follows_reinhard),
        cmocka_unit_test(magma_is_black_to_pale_and_grows_lighter),
        cmocka_unit_test(yee_sees_a_red_square),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
