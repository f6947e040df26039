/* `diptych metrics`: how far a picture, or each of several, is from its reference, as numbers, JSON
 * and error maps. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <cjson/cJSON.h>

#include "base/files.h"
#include "console/hdr.h"
#include "console/numbered.h"
#include "console/options.h"
#include "scenes/image.h"
#include "scenes/srgb.h"
#include "truth/image_metrics.h"

/* Luminance of the Yee metric's display: OpenImageIO's default white, cd/m2. */
static const float yee_luminance = 100;

/* Of one picture: doubles alone, so that pictures are averaged member by member. */
struct measured {
    struct image_errors hdr, ldr;
    struct distribution hdr_flip, ldr_flip; /* hdr_flip: NAN where it is not measured */
    double yee_failing;                     /* NAN: not measured */
};
enum { MEASURED_NUMBERS = sizeof(struct measured) / sizeof(double) };

/* HDR metrics are of the images times the exposure, LDR metrics of the same after tone mapping. */
struct metrics {
    struct console *console;
    const struct options *options;
    struct rgb_image images[2]; /* reference, test: exposed, linear */
    struct rgb_image mapped[2]; /* tone-mapped, linear, 0..1 */
    bool hdr;                   /* the files hold linear light, not 8-bit codes */
    bool numbered;              /* --test names several pictures */
    double exposure;
    double pixels_per_degree;
    float *flip_map[2]; /* LDR, HDR: of the last picture */
    struct flip_exposures exposures;
    uint32_t pictures;
    struct measured *list; /* one for each picture */
    struct measured mean, standard_error;
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

static bool check_metrics_options(struct metrics *metrics)
{
    const struct options *options = metrics->options;
    const struct dt_log *log = &metrics->console->log;
    bool good = true;
    metrics->pixels_per_degree =
        options->pixels_per_degree > 0 ? options->pixels_per_degree : FLIP_PIXELS_PER_DEGREE;
    metrics->hdr = holds_light(options->reference);
    metrics->numbered = is_numbered(options->test, "--test", &good, log);
    metrics->pictures = options->setup.frames;
    if (!good)
        return false;
    if (metrics->pixels_per_degree < 1 || metrics->pixels_per_degree > FLIP_MOST_PIXELS_PER_DEGREE)
        report_error(log, "--pixels-per-degree: must be from 1 to %g", FLIP_MOST_PIXELS_PER_DEGREE);
    else if (metrics->hdr != holds_light(options->test))
        report_error(
            log, "%s and %s: one holds light and the other 8-bit codes; give two .exr or two .png",
            options->reference, options->test);
    else if (!metrics->hdr && options->exposure > 0)
        report_error(log, "--exposure: %s holds 8-bit codes, which are exposed already",
                     options->reference);
    else if (options->setup.frames > 1 && !metrics->numbered)
        report_error(log,
                     "--test %s: names one picture; put %%04d in place of the frame number, or "
                     "leave out --frames",
                     options->test);
    else if (options->output && options->setup.frames > 1)
        report_error(log, "-o: maps are of one picture; leave out --frames");
    else
        return true;
    return false;
}

/* Reads a picture, multiplies it by the exposure, and maps its tones. The exposure is taken from the
 * reference, which comes first, unless given. */
static bool load_pictures(struct metrics *metrics, int which, const char *path)
{
    const struct dt_log *log = &metrics->console->log;
    struct rgb_image *image = &metrics->images[which];
    float *rgba = NULL;
    if (!hdr_read(path, &image->width, &image->height, &rgba, log))
        return false;
    image_check_claims(path, metrics->hdr ? IMAGE_AS_LIGHT : IMAGE_AS_SRGB, log);
    image->texels = rgba;
    uint64_t count = (uint64_t)image->width * image->height;
    for (uint64_t i = 0; i < count; i++) /* in place: three floats are less than four */
        for (uint64_t channel = 0; channel < 3; channel++) {
            float value = rgba[4 * i + channel];
            rgba[3 * i + channel] = metrics->hdr ? value : srgb_decode(value);
        }
    if (which == REFERENCE)
        metrics->exposure = !metrics->hdr                    ? 1
                            : metrics->options->exposure > 0 ? metrics->options->exposure
                                                             : exposure_of(image);
    for (uint64_t i = 0; i < 3 * count; i++)
        rgba[i] = (float)(metrics->exposure * (double)rgba[i]);
    float *texels = new_floats(3 * count);
    if (!texels) {
        report_error(log, "out of memory for images of %ux%u pixels", image->width, image->height);
        return false;
    }
    if (metrics->hdr)
        tone_map(image, 1, texels);
    else
        memcpy(texels, image->texels, 3 * count * sizeof *texels);
    metrics->mapped[which] = (struct rgb_image){image->width, image->height, texels};
    return true;
}

static void free_image(struct metrics *metrics, int which)
{
    free((float *)metrics->images[which].texels);
    free((float *)metrics->mapped[which].texels);
    metrics->images[which] = metrics->mapped[which] = (struct rgb_image){0};
}

static bool read_test(struct metrics *metrics, const char *path)
{
    const struct rgb_image *a = &metrics->images[REFERENCE], *b = &metrics->images[TEST];
    free_image(metrics, TEST);
    if (!load_pictures(metrics, TEST, path))
        return false;
    if (a->width == b->width && a->height == b->height)
        return true;
    report_error(&metrics->console->log,
                 "%s has %ux%u pixels and %s has %ux%u; render both at one --size",
                 metrics->options->reference, a->width, a->height, path, b->width, b->height);
    return false;
}

/* ---- Measuring ------------------------------------------------------------------------------- */

/* Takes ten times as long as everything else. */
static bool measures_hdr_flip(const struct metrics *metrics)
{
    const char *flip = metrics->options->flip;
    return metrics->hdr && (!flip || strcmp(flip, "ldr") != 0);
}

static bool measure_flip(struct metrics *metrics, int which, struct distribution *flip)
{
    const struct rgb_image *images = which == HDR ? metrics->images : metrics->mapped;
    uint64_t count = (uint64_t)images[0].width * images[0].height;
    double density = metrics->pixels_per_degree;
    float *map = metrics->flip_map[which];
    if (!map)
        map = metrics->flip_map[which] = new_floats(count);
    bool good = map && (which == HDR ? flip_hdr(&images[REFERENCE], &images[TEST], density, map,
                                                &metrics->exposures)
                                     : flip_ldr(&images[REFERENCE], &images[TEST], density, map));
    good = good && distribution_measure(flip, map, count);
    if (!good)
        report_error(&metrics->console->log, "out of memory for images of %ux%u pixels",
                     images[0].width, images[0].height);
    return good;
}

/* The test picture that was read last. */
static bool measure_picture(struct metrics *metrics, struct measured *measured)
{
    const struct rgb_image *images = metrics->images, *mapped = metrics->mapped;
    struct console *console = metrics->console;
    measured->hdr = image_errors_measure(&images[REFERENCE], &images[TEST]);
    measured->ldr = image_errors_measure(&mapped[REFERENCE], &mapped[TEST]);
    console_status(console, "FLIP of tone-mapped images");
    if (!measure_flip(metrics, LDR, &measured->ldr_flip))
        return false;
    measured->ldr.flip = measured->ldr_flip.mean;
    if (measures_hdr_flip(metrics)) {
        console_status(console, "FLIP over all exposures");
        if (!measure_flip(metrics, HDR, &measured->hdr_flip))
            return false;
        measured->hdr.flip = measured->hdr_flip.mean;
    } else {
        measured->hdr_flip = (struct distribution){NAN, NAN, NAN, NAN, NAN};
    }
    measured->yee_failing = NAN;
    if (!metrics->options->yee)
        return true;
    console_status(console, "Yee's metric");
    uint64_t failing = 0;
    bool good = image_compare_yee(mapped[0].width, mapped[0].height, mapped[REFERENCE].texels,
                                  mapped[TEST].texels, yee_luminance,
                                  (float)(mapped[0].width / metrics->pixels_per_degree), &failing,
                                  &console->log);
    measured->yee_failing = (double)failing;
    return good;
}

static bool measure_all(struct metrics *metrics)
{
    const struct options *options = metrics->options;
    bool good = (metrics->list = calloc(metrics->pictures, sizeof *metrics->list));
    if (!good)
        report_error(&metrics->console->log, "out of memory");
    for (uint32_t i = 0; i < metrics->pictures && good; i++) {
        char *path = metrics->numbered ? numbered_path(options->test, i) : strdup(options->test);
        good = path && read_test(metrics, path) && measure_picture(metrics, &metrics->list[i]);
        free(path);
    }
    return good;
}

/* Means over the pictures and, of two and more, the standard errors of these means. */
static void average(struct metrics *metrics)
{
    double *mean = (double *)&metrics->mean, *error = (double *)&metrics->standard_error;
    double n = metrics->pictures;
    for (size_t number = 0; number < MEASURED_NUMBERS; number++) {
        double squares = 0;
        for (uint32_t i = 0; i < metrics->pictures; i++)
            mean[number] += ((const double *)&metrics->list[i])[number] / n;
        for (uint32_t i = 0; i < metrics->pictures; i++)
            squares += pow(((const double *)&metrics->list[i])[number] - mean[number], 2);
        error[number] = n > 1 ? sqrt(squares / (n - 1) / n) : 0;
    }
}

/* ---- Output ---------------------------------------------------------------------------------- */

static uint8_t encode_error(float linear)
{
    return (uint8_t)(255 * fminf(fmaxf(srgb_encode(linear), 0), 1) + 0.5f);
}

/* Writes errors as colours, or a picture as the LDR metrics used it. */
static bool write_error_picture(const struct metrics *metrics, const char *name,
                                const float *errors, const struct rgb_image *picture)
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
        codes[i] = encode_error(picture->texels[i]);
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
           write_error_picture(metrics, "reference", NULL, &metrics->mapped[REFERENCE]) &&
           write_error_picture(metrics, "test", NULL, &metrics->mapped[TEST]) &&
           write_error_picture(metrics, "flip_ldr", metrics->flip_map[LDR], NULL) &&
           (!measures_hdr_flip(metrics) ||
            write_error_picture(metrics, "flip_hdr", metrics->flip_map[HDR], NULL));
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

/* null for what is not finite: the PSNR of equal images, FLIP that was not measured. */
static cJSON *errors_json(const struct image_errors *errors, const struct distribution *flip)
{
    cJSON *root = cJSON_CreateObject();
    for (int i = 0; i < IMAGE_NUMBERS; i++) {
        double value = image_number_of(errors, &image_numbers[i]);
        if (strcmp(image_numbers[i].name, "flip") != 0 || isnan(value))
            cJSON_AddNumberToObject(root, image_numbers[i].name, value);
        else
            cJSON_AddItemToObject(root, "flip", flip_json(flip));
    }
    cJSON_AddNumberToObject(root, "not_finite", errors->not_finite);
    return root;
}

static void add_measured(cJSON *root, const struct metrics *metrics,
                         const struct measured *measured)
{
    cJSON *ldr = errors_json(&measured->ldr, &measured->ldr_flip);
    cJSON_AddItemToObject(root, "ldr", ldr);
    cJSON *yee = metrics->options->yee ? cJSON_AddObjectToObject(ldr, "yee") : NULL;
    if (yee) {
        cJSON_AddNumberToObject(yee, "failing", measured->yee_failing);
        cJSON_AddNumberToObject(yee, "luminance", (double)yee_luminance);
    }
    if (metrics->hdr)
        cJSON_AddItemToObject(root, "hdr", errors_json(&measured->hdr, &measured->hdr_flip));
    else
        cJSON_AddNullToObject(root, "hdr");
}

static cJSON *metrics_json(const struct metrics *metrics)
{
    const struct options *options = metrics->options;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "reference", options->reference);
    cJSON_AddStringToObject(root, "test", options->test);
    cJSON_AddNumberToObject(root, "pictures", metrics->pictures);
    cJSON_AddNumberToObject(root, "width", metrics->images[0].width);
    cJSON_AddNumberToObject(root, "height", metrics->images[0].height);
    cJSON_AddNumberToObject(root, "exposure", metrics->exposure);
    cJSON_AddNumberToObject(root, "pixels_per_degree", metrics->pixels_per_degree);
    add_measured(root, metrics, &metrics->mean);
    if (measures_hdr_flip(metrics)) {
        cJSON *flip = cJSON_GetObjectItem(cJSON_GetObjectItem(root, "hdr"), "flip");
        cJSON_AddNumberToObject(flip, "start_exposure", metrics->exposures.start);
        cJSON_AddNumberToObject(flip, "stop_exposure", metrics->exposures.stop);
        cJSON_AddNumberToObject(flip, "exposures", metrics->exposures.count);
    }
    if (metrics->pictures > 1)
        add_measured(cJSON_AddObjectToObject(root, "standard_errors"), metrics,
                     &metrics->standard_error);
    return root;
}

/* A row: of the linear picture, where it is known, and of the tone-mapped one. */
static void print_metric(const struct metrics *metrics, const char *title, size_t hdr, size_t ldr)
{
    const size_t offsets[] = {hdr, ldr};
    printf("%-24s", title);
    for (int i = metrics->hdr ? 0 : 1; i < 2; i++) {
        double mean = *(const double *)((const char *)&metrics->mean + offsets[i]);
        double error = *(const double *)((const char *)&metrics->standard_error + offsets[i]);
        if (isnan(mean))
            printf("  %11s", "-");
        else
            printf("  %11.5f", mean);
        if (metrics->pictures > 1 && isfinite(error))
            printf(" \u00b1 %-8.2g", error);
        else if (metrics->pictures > 1)
            printf("%11s", "");
    }
    printf("\n");
}

#define AT(member) offsetof(struct measured, member)
static void print_metrics(const struct metrics *metrics)
{
    const struct rgb_image *image = &metrics->images[0];
    uint64_t count = (uint64_t)image->width * image->height;
    bool several = metrics->pictures > 1;
    printf("%ux%u pixels, exposure %.6g, %.4g pixels per degree\n", image->width, image->height,
           metrics->exposure, metrics->pixels_per_degree);
    if (several)
        printf("%u pictures: mean and its standard error\n", metrics->pictures);
    printf("\n%-24s", "");
    if (metrics->hdr)
        printf("  %11s%*s", "linear", several ? 11 : 0, "");
    printf("  %11s\n", "tone-mapped");
    for (int i = 0; i < IMAGE_NUMBERS; i++)
        print_metric(metrics, image_numbers[i].title, AT(hdr) + image_numbers[i].offset,
                     AT(ldr) + image_numbers[i].offset);
    print_metric(metrics, "FLIP, 95th percentile", AT(hdr_flip.p95), AT(ldr_flip.p95));
    print_metric(metrics, "FLIP, largest", AT(hdr_flip.most), AT(ldr_flip.most));
    if (metrics->options->yee)
        printf("\nYee: %.6g of %llu pixels can be told apart\n", metrics->mean.yee_failing,
               (unsigned long long)count);
    if (metrics->mean.hdr.not_finite > 0)
        printf("left out: %.6g pixels that are NaN or Inf\n", metrics->mean.hdr.not_finite);
}

/* ---- The verb -------------------------------------------------------------------------------- */

int verb_metrics(struct console *console, const struct options *options)
{
    struct metrics metrics = {.console = console, .options = options};
    bool good = check_metrics_options(&metrics) &&
                load_pictures(&metrics, REFERENCE, options->reference) && measure_all(&metrics) &&
                write_maps(&metrics);
    console_status(console, "%s", "");
    if (good) {
        average(&metrics);
        print_metrics(&metrics);
        console->result = metrics_json(&metrics);
    }
    for (int i = 0; i < 2; i++) {
        free_image(&metrics, i);
        free(metrics.flip_map[i]);
    }
    free(metrics.list);
    return good ? EXIT_FINE : EXIT_FAILED;
}
