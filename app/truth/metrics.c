/* `diptych metrics`: how far a picture is from its reference, as numbers, JSON and error maps. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <cjson/cJSON.h>

#include "base/files.h"
#include "base/options.h"
#include "scenes/image.h"
#include "scenes/srgb.h"
#include "truth/image_metrics.h"

/* Luminance of the Yee metric's display: OpenImageIO's default white, cd/m2. */
static const float yee_luminance = 100;

/* HDR metrics are of the images times the exposure, LDR metrics of the same after tone mapping. */
struct metrics {
    struct console *console;
    const struct options *options;
    struct rgb_image images[2]; /* reference, test: exposed, linear */
    struct rgb_image mapped[2]; /* tone-mapped, linear, 0..1 */
    bool hdr;                   /* the files hold linear light, not 8-bit codes */
    double exposure;
    double pixels_per_degree;
    struct image_errors hdr_errors, ldr_errors;
    float *flip_map[2]; /* LDR, HDR */
    struct distribution flip[2];
    struct flip_exposures exposures;
    uint64_t yee_failing;
};

enum { REFERENCE, TEST };
enum { LDR, HDR };

static float *new_floats(uint64_t count)
{
    return malloc(count * sizeof(float) + 1); /* never a size of zero */
}

/* ---- Reading --------------------------------------------------------------------------------- */

static bool holds_light(const char *path)
{
    static const char *const endings[] = {".exr", ".hdr", ".pfm"};
    size_t length = strlen(path);
    for (size_t i = 0; i < DT_ARRAY_COUNT(endings); i++)
        if (length >= 4 && strcasecmp(path + length - 4, endings[i]) == 0)
            return true;
    return false;
}

static bool read_image(struct metrics *metrics, int which, const char *path)
{
    const struct dt_log *log = &metrics->console->log;
    struct rgb_image *image = &metrics->images[which];
    float *rgba = NULL;
    if (!image_read_float(path, &image->width, &image->height, &rgba, log))
        return false;
    uint64_t count = (uint64_t)image->width * image->height;
    for (uint64_t i = 0; i < count; i++) /* in place: three floats are less than four */
        for (uint64_t channel = 0; channel < 3; channel++) {
            float value = rgba[4 * i + channel];
            rgba[3 * i + channel] = metrics->hdr ? value : srgb_decode(value);
        }
    image->texels = rgba;
    return true;
}

static bool read_images(struct metrics *metrics)
{
    const struct options *options = metrics->options;
    const struct dt_log *log = &metrics->console->log;
    metrics->pixels_per_degree =
        options->pixels_per_degree > 0 ? options->pixels_per_degree : FLIP_PIXELS_PER_DEGREE;
    if (metrics->pixels_per_degree < 1 ||
        metrics->pixels_per_degree > FLIP_MOST_PIXELS_PER_DEGREE) {
        report_error(log, "--pixels-per-degree: must be from 1 to %g", FLIP_MOST_PIXELS_PER_DEGREE);
        return false;
    }
    metrics->hdr = holds_light(options->reference);
    if (metrics->hdr != holds_light(options->test)) {
        report_error(
            log, "%s and %s: one holds light and the other 8-bit codes; give two .exr or two .png",
            options->reference, options->test);
        return false;
    }
    if (!metrics->hdr && options->exposure > 0) {
        report_error(log, "--exposure: %s holds 8-bit codes, which are exposed already",
                     options->reference);
        return false;
    }
    if (!read_image(metrics, REFERENCE, options->reference) ||
        !read_image(metrics, TEST, options->test))
        return false;
    const struct rgb_image *a = &metrics->images[REFERENCE], *b = &metrics->images[TEST];
    if (a->width == b->width && a->height == b->height)
        return true;
    report_error(log, "%s has %ux%u pixels and %s has %ux%u; render both at one --size",
                 options->reference, a->width, a->height, options->test, b->width, b->height);
    return false;
}

/* ---- Measuring ------------------------------------------------------------------------------- */

static bool make_mapped(struct metrics *metrics, int which)
{
    const struct rgb_image *image = &metrics->images[which];
    uint64_t count = (uint64_t)image->width * image->height * 3;
    float *texels = new_floats(count);
    if (!texels)
        return false;
    if (metrics->hdr)
        tone_map(image, 1, texels);
    else
        memcpy(texels, image->texels, count * sizeof *texels);
    metrics->mapped[which] = (struct rgb_image){image->width, image->height, texels};
    return true;
}

/* One exposure for both images, taken from the reference unless given. */
static void expose(struct metrics *metrics)
{
    uint64_t count = (uint64_t)metrics->images[0].width * metrics->images[0].height * 3;
    metrics->exposure = 1;
    if (metrics->hdr)
        metrics->exposure = metrics->options->exposure > 0
                                ? metrics->options->exposure
                                : exposure_of(&metrics->images[REFERENCE]);
    for (int which = 0; which < 2; which++) {
        float *texels = (float *)metrics->images[which].texels;
        for (uint64_t i = 0; i < count; i++)
            texels[i] = (float)(metrics->exposure * (double)texels[i]);
    }
}

static bool measure_flip(struct metrics *metrics, int which)
{
    const struct rgb_image *images = which == HDR ? metrics->images : metrics->mapped;
    uint64_t count = (uint64_t)images[0].width * images[0].height;
    double density = metrics->pixels_per_degree;
    float *map = metrics->flip_map[which] = new_floats(count);
    if (!map)
        return false;
    bool good = which == HDR
                    ? flip_hdr(&images[REFERENCE], &images[TEST], density, map, &metrics->exposures)
                    : flip_ldr(&images[REFERENCE], &images[TEST], density, map);
    return good && distribution_measure(&metrics->flip[which], map, count);
}

/* Takes ten times as long as everything else. */
static bool measures_hdr_flip(const struct metrics *metrics)
{
    const char *flip = metrics->options->flip;
    return metrics->hdr && (!flip || strcmp(flip, "ldr") != 0);
}

static bool measure(struct metrics *metrics)
{
    const struct rgb_image *images = metrics->images, *mapped = metrics->mapped;
    struct console *console = metrics->console;
    expose(metrics);
    bool good = make_mapped(metrics, REFERENCE) && make_mapped(metrics, TEST);
    if (good) {
        metrics->hdr_errors = image_errors_measure(&images[REFERENCE], &images[TEST]);
        metrics->ldr_errors = image_errors_measure(&mapped[REFERENCE], &mapped[TEST]);
        console_status(console, "FLIP of tone-mapped images");
        good = measure_flip(metrics, LDR);
    }
    if (good && measures_hdr_flip(metrics)) {
        console_status(console, "FLIP over all exposures");
        good = measure_flip(metrics, HDR);
    }
    if (!good) {
        report_error(&console->log, "out of memory for images of %ux%u pixels", images[0].width,
                     images[0].height);
        return false;
    }
    console_status(console, "Yee's metric");
    return image_compare_yee(mapped[0].width, mapped[0].height, mapped[REFERENCE].texels,
                             mapped[TEST].texels, yee_luminance,
                             (float)(mapped[0].width / metrics->pixels_per_degree),
                             &metrics->yee_failing, &console->log);
}

/* ---- Output ---------------------------------------------------------------------------------- */

static uint8_t encode(float linear)
{
    return (uint8_t)(255 * fminf(fmaxf(srgb_encode(linear), 0), 1) + 0.5f);
}

/* Writes errors as colours, or a picture as the LDR metrics used it. */
static bool write_picture(const struct metrics *metrics, const char *name, const float *errors,
                          const struct rgb_image *picture)
{
    const struct rgb_image *image = &metrics->images[0];
    uint64_t count = (uint64_t)image->width * image->height;
    const struct dt_log *log = &metrics->console->log;
    char *path = format_string("%s/%s.png", metrics->options->output, name);
    uint8_t *codes = malloc(count * 3 + 1);
    bool good = path && codes;
    if (!good)
        report_error(log, "out of memory");
    for (uint64_t i = 0; i < count && good && errors; i++)
        magma(errors[i], codes + 3 * i);
    for (uint64_t i = 0; i < 3 * count && good && picture; i++)
        codes[i] = encode(picture->texels[i]);
    if (good) {
        console_hold(metrics->console);
        good = image_write_png(path, image->width, image->height, 3, codes, log);
        console_release(metrics->console);
    }
    free(codes);
    free(path);
    return good;
}

static bool write_maps(const struct metrics *metrics)
{
    const struct dt_log *log = &metrics->console->log;
    if (!metrics->options->output)
        return true;
    return file_make_folders(metrics->options->output, log) &&
           write_picture(metrics, "reference", NULL, &metrics->mapped[REFERENCE]) &&
           write_picture(metrics, "test", NULL, &metrics->mapped[TEST]) &&
           write_picture(metrics, "flip_ldr", metrics->flip_map[LDR], NULL) &&
           (!measures_hdr_flip(metrics) ||
            write_picture(metrics, "flip_hdr", metrics->flip_map[HDR], NULL));
}

static cJSON *errors_json(const struct image_errors *errors)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddNumberToObject(root, "mean_reference", errors->mean_reference);
    cJSON_AddNumberToObject(root, "mean_test", errors->mean_test);
    cJSON_AddNumberToObject(root, "mean_absolute", errors->mean_absolute);
    cJSON_AddNumberToObject(root, "rmse", errors->rmse);
    cJSON_AddNumberToObject(root, "relative_mse", errors->relative_mse);
    cJSON_AddNumberToObject(root, "psnr", errors->psnr); /* null for equal images */
    cJSON_AddNumberToObject(root, "not_finite", (double)errors->not_finite);
    return root;
}

static cJSON *flip_json(const struct distribution *flip)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddNumberToObject(root, "mean", flip->mean);
    cJSON_AddNumberToObject(root, "median", flip->median);
    cJSON_AddNumberToObject(root, "p95", flip->p95);
    cJSON_AddNumberToObject(root, "p99", flip->p99);
    cJSON_AddNumberToObject(root, "max", flip->most);
    return root;
}

static cJSON *metrics_json(const struct metrics *metrics)
{
    const struct options *options = metrics->options;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "reference", options->reference);
    cJSON_AddStringToObject(root, "test", options->test);
    cJSON_AddNumberToObject(root, "width", metrics->images[0].width);
    cJSON_AddNumberToObject(root, "height", metrics->images[0].height);
    cJSON_AddNumberToObject(root, "exposure", metrics->exposure);
    cJSON_AddNumberToObject(root, "pixels_per_degree", metrics->pixels_per_degree);
    cJSON *ldr = errors_json(&metrics->ldr_errors);
    cJSON_AddItemToObject(root, "ldr", ldr);
    cJSON_AddItemToObject(ldr, "flip", flip_json(&metrics->flip[LDR]));
    cJSON *yee = cJSON_AddObjectToObject(ldr, "yee");
    cJSON_AddNumberToObject(yee, "failing", (double)metrics->yee_failing);
    cJSON_AddNumberToObject(yee, "luminance", (double)yee_luminance);
    if (!metrics->hdr) {
        cJSON_AddNullToObject(root, "hdr");
        return root;
    }
    cJSON *hdr = errors_json(&metrics->hdr_errors);
    cJSON_AddItemToObject(root, "hdr", hdr);
    if (!measures_hdr_flip(metrics)) {
        cJSON_AddNullToObject(hdr, "flip");
        return root;
    }
    cJSON *flip = flip_json(&metrics->flip[HDR]);
    cJSON_AddItemToObject(hdr, "flip", flip);
    cJSON_AddNumberToObject(flip, "start_exposure", metrics->exposures.start);
    cJSON_AddNumberToObject(flip, "stop_exposure", metrics->exposures.stop);
    cJSON_AddNumberToObject(flip, "exposures", metrics->exposures.count);
    return root;
}

/* `flip`: NULL where it was not measured. */
static void print_errors(const char *name, const struct image_errors *errors,
                         const struct distribution *flip)
{
    printf("%-12s  %9.5f  %9.5f  %9.5f  %9.5f  %9.5f  %7.2f", name, errors->mean_reference,
           errors->mean_test, errors->mean_absolute, errors->rmse, errors->relative_mse,
           errors->psnr);
    if (flip)
        printf("  %8.5f  %8.5f  %8.5f", flip->mean, flip->p95, flip->most);
    printf("\n");
}

static void print_table(const struct metrics *metrics)
{
    const struct rgb_image *image = &metrics->images[0];
    uint64_t count = (uint64_t)image->width * image->height;
    printf("%ux%u pixels, exposure %.6g, %.4g pixels per degree\n\n", image->width, image->height,
           metrics->exposure, metrics->pixels_per_degree);
    printf("%-12s  %9s  %9s  %9s  %9s  %9s  %7s  %8s  %8s  %8s\n", "", "reference", "test",
           "mean abs", "RMSE", "rel. MSE", "PSNR", "FLIP", "FLIP p95", "FLIP max");
    if (metrics->hdr)
        print_errors("linear", &metrics->hdr_errors,
                     measures_hdr_flip(metrics) ? &metrics->flip[HDR] : NULL);
    print_errors("tone-mapped", &metrics->ldr_errors, &metrics->flip[LDR]);
    printf("\nYee: %llu of %llu pixels can be told apart\n",
           (unsigned long long)metrics->yee_failing, (unsigned long long)count);
    if (metrics->hdr_errors.not_finite)
        printf("left out: %llu pixels that are NaN or Inf\n",
               (unsigned long long)metrics->hdr_errors.not_finite);
}

/* ---- The verb -------------------------------------------------------------------------------- */

int verb_metrics(struct console *console, const struct options *options)
{
    struct metrics metrics = {.console = console, .options = options};
    bool good = read_images(&metrics) && measure(&metrics) && write_maps(&metrics);
    console_status(console, "%s", "");
    if (good) {
        print_table(&metrics);
        console->result = metrics_json(&metrics);
    }
    for (int i = 0; i < 2; i++) {
        free((float *)metrics.images[i].texels);
        free((float *)metrics.mapped[i].texels);
        free(metrics.flip_map[i]);
    }
    return good ? EXIT_FINE : EXIT_FAILED;
}
