/* `diptych reference`: path-traces a scene as ground truth for pipelines. The tracer does the work;
 * this file has options, progress, checkpoints and output. */
#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "base/files.h"
#include "result/identity.h"
#include "picture/hdr.h"
#include "console/options.h"
#include "run/session.h"
#include "truth/tracer.h"

enum { DEFAULT_SAMPLES = 256, MAX_SAMPLES = 1000000, MAX_BOUNCES = 1000 };

static const double pass_seconds = 0.5;      /* of tracing between two looks at the clock */
static const double checkpoint_seconds = 2;  /* between checkpoints at least, and */
static const double checkpoint_share = 0.02; /* of the time that they may take */

struct reference {
    struct console *console;
    const struct options *options;
    struct scene scene;
    struct dt_frame frame;
    struct tracer_info info;
    struct tracer *tracer;
    struct film film;
    struct vpl_set vpls;
    char *settings;   /* one line with everything that the film's sums depend on */
    uint32_t samples; /* most samples, whatever the noise */
    double noise;     /* noise to stop at; 0: none */
    uint32_t resumed; /* samples from the checkpoint */
    double start, checkpoint_time, checkpoint_cost;
};

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- Options --------------------------------------------------------------------------------- */

/* A whole number from 0 to MAX_BOUNCES. */
static bool read_bounces(const char *text, uint32_t *bounces)
{
    char *end;
    unsigned long number = strtoul(text, &end, 10);
    if (*text < '0' || *text > '9' || *end || number > MAX_BOUNCES)
        return false;
    *bounces = (uint32_t)number;
    return true;
}

static bool check_bounces(struct reference *reference)
{
    const struct options *options = reference->options;
    const struct dt_log *log = &reference->console->log;
    struct tracer_info *info = &reference->info;
    info->last_bounce = TRACER_UNLIMITED;
    if (strcmp(options->bounces, "unlimited") != 0 &&
        !read_bounces(options->bounces, &info->last_bounce))
        return report_error(log, "--bounces %s: must be a whole number from 0 to %d, or unlimited",
                            options->bounces, MAX_BOUNCES);
    if (!read_bounces(options->from_bounce, &info->first_bounce) ||
        info->first_bounce > info->last_bounce)
        return report_error(log,
                            "--from-bounce %s: must be a whole number from 0 to that of --bounces",
                            options->from_bounce);
    return true;
}

static bool check_goal(struct reference *reference)
{
    const struct options *options = reference->options;
    uint32_t otherwise = options->noise ? MAX_SAMPLES : DEFAULT_SAMPLES;
    reference->samples = options->spp ? options->spp : otherwise;
    if (!options->noise)
        return true;
    char *end;
    reference->noise = strtod(options->noise, &end);
    return (end != options->noise && !*end && reference->noise > 0 && reference->noise < 1) ||
           report_error(&reference->console->log,
                        "--noise %s: must be a number between 0 and 1, like 0.01", options->noise);
}

static bool check_reference_options(struct reference *reference)
{
    const struct options *options = reference->options;
    const struct dt_log *log = &reference->console->log;
    size_t length = strlen(options->output);
    if (length < 4 || strcasecmp(options->output + length - 4, ".exr") != 0)
        return report_error(log, "-o %s: must end in .exr: the picture is linear", options->output);
    reference->info = (struct tracer_info){
        .scene = &reference->scene.data,
        .frame = &reference->frame,
        .log = log,
        .vpls = &reference->vpls,
        .output = options->quantity && strcmp(options->quantity, "irradiance") == 0
                      ? TRACER_IRRADIANCE
                      : TRACER_RADIANCE,
        .emission = options->emission,
        .sequence = options->sampler && strcmp(options->sampler, "random") == 0 ? SEQUENCE_RANDOM
                                                                                : SEQUENCE_SOBOL,
        .seed = options->seed,
        .threads = options->threads,
    };
    if (options->frame && !options->setup.motion)
        return report_error(log, "--frame %u: needs a --motion", options->frame);
    return check_bounces(reference) && check_goal(reference);
}

/* ---- Checkpoints ----------------------------------------------------------------------------- */

static uint64_t input_hash(const struct reference *reference)
{
    uint64_t hash = FILE_HASH_START;
    hash_scene(&hash, &reference->scene.data);
    hash_bytes(&hash, &reference->frame, sizeof reference->frame);
    hash_bytes(&hash, reference->vpls.vpls, reference->vpls.count * sizeof *reference->vpls.vpls);
    return hash;
}

static char *describe_settings(const struct reference *reference)
{
    const struct tracer_info *info = &reference->info;
    char last[16] = "unlimited";
    if (info->last_bounce != TRACER_UNLIMITED)
        snprintf(last, sizeof last, "%u", info->last_bounce);
    return format_string("size=%ux%u bounces=%u..%s quantity=%s filter=%s emission=%s sampler=%s "
                         "seed=%u scene=%016" PRIx64,
                         reference->frame.width, reference->frame.height, info->first_bounce, last,
                         info->output == TRACER_IRRADIANCE ? "irradiance" : "radiance",
                         info->box_filter ? "box" : "centre", info->emission ? "yes" : "no",
                         info->sequence == SEQUENCE_RANDOM ? "random" : "sobol", info->seed,
                         input_hash(reference));
}

static bool resume(struct reference *reference)
{
    const char *path = reference->options->checkpoint;
    const struct dt_log *log = &reference->console->log;
    if (!path || !file_exists(path))
        return true;
    if (!film_load(&reference->film, path, reference->settings, log))
        return false;
    reference->resumed = reference->film.samples;
    if (reference->resumed > reference->samples)
        return report_error(log, "%s: already has %u samples per pixel; give more than --spp %u",
                            path, reference->resumed, reference->samples);
    report_message(log, DT_INFO, "continuing from %u samples per pixel in %s", reference->resumed,
                   path);
    return true;
}

static bool save_checkpoint(struct reference *reference)
{
    const char *path = reference->options->checkpoint;
    double begin = seconds_now();
    console_hold(reference->console);
    bool good = film_save(&reference->film, path, reference->settings, &reference->console->log);
    console_release(reference->console);
    reference->checkpoint_time = seconds_now();
    reference->checkpoint_cost = reference->checkpoint_time - begin;
    return good;
}

/* ---- Tracing --------------------------------------------------------------------------------- */

/* Sample counts at which the noise is tested: from sixteen in steps of a quarter octave. They must
 * not depend on time, or the picture would. */
static bool looks_at_noise(uint32_t samples)
{
    uint32_t octave = 16;
    while (octave <= samples / 2)
        octave *= 2;
    return samples >= 16 && samples % (octave / 4) == 0;
}

static bool is_finished(const struct reference *reference)
{
    const struct film *film = &reference->film;
    if (film->samples >= reference->samples)
        return true;
    return reference->noise > 0 && looks_at_noise(film->samples) &&
           film_noise(film) <= reference->noise;
}

/* Samples to trace before the next look at the clock or the noise. */
static uint32_t next_samples(const struct reference *reference, double seconds_per_sample)
{
    uint32_t done = reference->film.samples, most = reference->samples - done, count = 1;
    double fitting = seconds_per_sample > 0 ? pass_seconds / seconds_per_sample : 1;
    while (count < most && count + 1 <= fitting &&
           !(reference->noise > 0 && looks_at_noise(done + count)))
        count++;
    return count;
}

static void show_progress(const struct reference *reference)
{
    const struct film *film = &reference->film;
    double noise = film_noise(film), goal = reference->samples;
    double elapsed = seconds_now() - reference->start;
    if (reference->noise > 0) /* the error falls at least with the square root of the samples */
        goal = fmin(goal, film->samples * pow(noise / reference->noise, 2));
    double left = fmax(goal - film->samples, 0) * elapsed / (film->samples - reference->resumed);
    char time_left[32];
    console_duration(left, time_left, sizeof time_left);
    console_status(reference->console, "%u of %.0f samples, noise %.2g %%, %.1f Mrays/s, %s left",
                   film->samples, fmax(goal, film->samples), 100 * noise,
                   1e-6 * (double)tracer_rays(reference->tracer) / elapsed, time_left);
}

static bool trace(struct reference *reference)
{
    const struct options *options = reference->options;
    double seconds_per_sample = 0, now;
    reference->start = reference->checkpoint_time = seconds_now();
    while (!is_finished(reference)) {
        uint32_t count = next_samples(reference, seconds_per_sample);
        double begin = seconds_now();
        if (!tracer_add(reference->tracer, &reference->film, count))
            return false;
        now = seconds_now();
        seconds_per_sample = (now - begin) / count;
        show_progress(reference);
        double pause = fmax(checkpoint_seconds, reference->checkpoint_cost / checkpoint_share);
        if (options->checkpoint && now - reference->checkpoint_time > pause &&
            !save_checkpoint(reference))
            return false;
    }
    if (reference->noise > 0 && film_noise(&reference->film) > reference->noise)
        report_message(&reference->console->log, DT_WARNING,
                       "the noise is %.3g after %u samples per pixel, not %g; raise --spp",
                       film_noise(&reference->film), reference->samples, reference->noise);
    return !options->checkpoint || save_checkpoint(reference);
}

/* ---- Results --------------------------------------------------------------------------------- */

static bool tell_summary(const struct reference *reference, const double mean[3], double seconds)
{
    const struct film *film = &reference->film;
    double noise = film_noise(film);
    cJSON *root = cJSON_CreateObject();
    bool good = cJSON_AddStringToObject(root, "scene", reference->options->setup.scene) &&
                cJSON_AddStringToObject(root, "settings", reference->settings) &&
                cJSON_AddNumberToObject(root, "samples", film->samples) &&
                (isfinite(noise) ? cJSON_AddNumberToObject(root, "noise", noise)
                                 : cJSON_AddNullToObject(root, "noise")) &&
                cJSON_AddItemToObject(root, "mean", cJSON_CreateDoubleArray(mean, 3)) &&
                cJSON_AddNumberToObject(root, "rays", (double)tracer_rays(reference->tracer)) &&
                cJSON_AddNumberToObject(root, "seconds", seconds);
    if (good) {
        reference->console->result = root;
        return true;
    }
    report_error(&reference->console->log, "out of memory");
    cJSON_Delete(root);
    return false;
}

static bool write_results(const struct reference *reference)
{
    const struct film *film = &reference->film;
    const struct options *options = reference->options;
    double seconds = seconds_now() - reference->start, mean[3] = {0, 0, 0};
    char noise[32] = "unknown";
    if (isfinite(film_noise(film)))
        snprintf(noise, sizeof noise, "%.2g %%", 100 * film_noise(film));
    size_t pixels = (size_t)film->width * film->height;
    float *texels = malloc(pixels * 3 * sizeof *texels);
    if (!texels)
        return report_error(&reference->console->log, "out of memory for a picture");
    film_mean(film, texels);
    for (size_t i = 0; i < pixels * 3; i++)
        mean[i % 3] += texels[i] / (double)pixels;
    console_hold(reference->console);
    bool good =
        hdr_write(options->output, film->width, film->height, texels, &reference->console->log);
    console_release(reference->console);
    free(texels);
    if (good && options->json)
        good = tell_summary(reference, mean, seconds);
    if (good)
        report_message(&reference->console->log, DT_INFO,
                       "%s: %u samples per pixel, noise %s, %.1f s, %.1f Mrays/s", options->output,
                       film->samples, noise, seconds,
                       1e-6 * (double)tracer_rays(reference->tracer) / fmax(seconds, 1e-9));
    return good;
}

/* By default radiance of a scene with textures is filtered over the pixel, because a rasterizer
 * filters its textures, too. Elsewhere both sample the pixel's centre. */
static bool filters_pixel(const struct reference *reference)
{
    const char *filter = reference->options->filter;
    const struct dt_scene *scene = &reference->scene.data;
    bool textured = false;
    for (uint32_t i = 0; i < scene->material_count; i++)
        textured |= scene->materials[i].texture >= 0;
    return filter ? strcmp(filter, "box") == 0
                  : textured && reference->info.output == TRACER_RADIANCE;
}

static bool reference_prepare(struct reference *reference)
{
    const struct options *options = reference->options;
    const struct dt_log *log = &reference->console->log;
    if (!file_can_write(options->output, log) ||
        (options->checkpoint && !file_can_write(options->checkpoint, log)) ||
        !session_load_scene(&reference->scene, reference->console, NULL, &options->setup) ||
        (options->vpls && !vpls_read(&reference->vpls, options->vpls, log)))
        return false;
    scene_frame_at(&reference->scene, options->frame, options->setup.size[0],
                   options->setup.size[1], &reference->frame);
    reference->frame.width = options->setup.size[0];
    reference->frame.height = options->setup.size[1];
    reference->info.box_filter = filters_pixel(reference);
    reference->settings = describe_settings(reference);
    if (!reference->settings)
        return report_error(log, "out of memory");
    if (!film_create(&reference->film, options->setup.size[0], options->setup.size[1], log) ||
        !resume(reference))
        return false;
    console_status(reference->console, "building the hierarchy of %u triangles",
                   reference->frame.triangle_count);
    reference->tracer = tracer_open(&reference->info);
    return reference->tracer;
}

int verb_reference(struct console *console, const struct options *options)
{
    struct reference reference = {.console = console, .options = options};
    if (!check_reference_options(&reference))
        return EXIT_USAGE;
    bool good = reference_prepare(&reference) && trace(&reference) && write_results(&reference);
    tracer_close(reference.tracer);
    film_free(&reference.film);
    free(reference.vpls.vpls);
    scene_free(&reference.scene);
    free(reference.settings);
    return good ? EXIT_FINE : EXIT_FAILED;
}
