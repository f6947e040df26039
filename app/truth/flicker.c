/* `diptych flicker`: change of pictures from frame to frame where both show the same surface,
 * compared with the reference's change. Rays into the scene find the surface of each pixel, so the
 * pictures may come from any pipeline. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "base/files.h"
#include "console/hdr.h"
#include "console/numbered.h"
#include "console/options.h"
#include "run/session.h"
#include "truth/change.h"
#include "truth/rays.h"
#include "truth/tracer.h"

/* A frame: its surfaces, its picture and its reference. */
struct flicker_frame {
    struct seen_point *points; /* owned, as are the texels */
    struct seen seen;
    struct rgb_image test, reference;
};

struct flicker {
    struct console *console;
    const struct options *options;
    uint32_t frames, block;
    struct scene scene;
    struct ray_scene *rays;
    struct change *changes; /* number of frames minus one */
};

static bool check_patterns(const struct flicker *flicker)
{
    const struct options *options = flicker->options;
    const struct dt_log *log = &flicker->console->log;
    const char *const paths[] = {options->test, options->reference};
    const char *const names[] = {"--test", "--reference"};
    for (int i = 0; i < 2; i++) {
        bool good = true;
        if (paths[i] && !is_numbered(paths[i], names[i], &good, log)) {
            report_error(log, "%s %s: names one picture; put %%04d in place of the frame number",
                         names[i], paths[i]);
            return false;
        }
        if (!good)
            return false;
    }
    return true;
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static bool read_frame(const struct flicker *flicker, const char *pattern, uint32_t index,
                       struct rgb_image *image)
{
    const struct dt_log *log = &flicker->console->log;
    char *path = numbered_path(pattern, index);
    float *rgba = NULL;
    if (!path)
        report_error(log, "out of memory");
    bool good = path && hdr_read(path, &image->width, &image->height, &rgba, log);
    uint64_t count = good ? (uint64_t)image->width * image->height : 0;
    for (uint64_t i = 0; i < count; i++) /* in place: three floats are less than four */
        for (uint64_t channel = 0; channel < 3; channel++)
            rgba[3 * i + channel] = rgba[4 * i + channel];
    image->texels = rgba;
    free(path);
    return good;
}

static void see(const struct flicker *flicker, const struct dt_frame *block, uint32_t x, uint32_t y,
                struct seen_point *point)
{
    const struct dt_view *camera = &block->camera;
    float origin[3], direction[3];
    struct ray_hit hit;
    tracer_camera_ray(block, x + 0.5, y + 0.5, origin, direction);
    *point = (struct seen_point){.depth = 0};
    if (!ray_closest(flicker->rays, vec3_of(origin), vec3_of(direction), &hit))
        return;
    memcpy(point->position, &hit.position, sizeof point->position);
    memcpy(point->normal, &hit.normal, sizeof point->normal);
    memcpy(point->plane, &hit.geometric, sizeof point->plane);
    point->depth = fmaxf(
        dot(subtract(hit.position, vec3_of(camera->position)), vec3_of(camera->direction)), 1e-12f);
}

static bool see_all(const struct flicker *flicker, uint32_t index, struct flicker_frame *frame)
{
    uint32_t width = frame->test.width, height = frame->test.height;
    struct dt_frame block;
    frame->points = calloc((size_t)width * height + 1, sizeof *frame->points);
    if (!frame->points) {
        report_error(&flicker->console->log, "out of memory for %ux%u pixels", width, height);
        return false;
    }
    scene_frame_at(&flicker->scene, index, width, height, &block);
    block.width = width;
    block.height = height;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            see(flicker, &block, x, y, &frame->points[(size_t)y * width + x]);
    frame->seen = (struct seen){.width = width, .height = height, .points = frame->points};
    memcpy(frame->seen.view_projection, block.camera.view_projection,
           sizeof frame->seen.view_projection);
    return true;
}

static void free_frame(struct flicker_frame *frame)
{
    free(frame->points);
    free((float *)frame->test.texels);
    free((float *)frame->reference.texels);
    *frame = (struct flicker_frame){0};
}

/* `before`: NULL, or a frame whose size it must have. */
static bool take_frame(const struct flicker *flicker, uint32_t index,
                       const struct flicker_frame *before, struct flicker_frame *frame)
{
    const struct options *options = flicker->options;
    const struct rgb_image *first = before ? &before->test : &frame->test;
    console_status(flicker->console, "frame %u of %u", index + 1, flicker->frames);
    if (!read_frame(flicker, options->test, index, &frame->test) ||
        (options->reference && !read_frame(flicker, options->reference, index, &frame->reference)))
        return false;
    const struct rgb_image *images[] = {&frame->test, &frame->reference};
    for (int i = 0; i < (options->reference ? 2 : 1); i++) {
        if (images[i]->width == first->width && images[i]->height == first->height)
            continue;
        report_error(&flicker->console->log,
                     "frame %u of %s has %ux%u pixels, not %ux%u; render all at one --size", index,
                     i ? options->reference : options->test, images[i]->width, images[i]->height,
                     first->width, first->height);
        return false;
    }
    return see_all(flicker, index, frame);
}

static bool measure_pair(struct flicker *flicker)
{
    struct flicker_frame before = {0}, now = {0};
    bool good = take_frame(flicker, 0, NULL, &before);
    for (uint32_t i = 1; i < flicker->frames && good; i++) {
        good = take_frame(flicker, i, &before, &now);
        const struct seen seen[2] = {before.seen, now.seen};
        const struct rgb_image test[2] = {before.test, now.test};
        const struct rgb_image reference[2] = {before.reference, now.reference};
        if (good &&
            !change_measure(&flicker->changes[i - 1], seen, test,
                            flicker->options->reference ? reference : NULL, flicker->block)) {
            report_error(&flicker->console->log, "out of memory");
            good = false;
        }
        free_frame(&before);
        before = now;
        now = (struct flicker_frame){0};
    }
    free_frame(&before);
    free_frame(&now);
    return good;
}

/* ---- Output ---------------------------------------------------------------------------------- */

/* Relative to the reference's mean, or without one, the pictures' own: comparable between
 * scenes. */
static double relative(const struct flicker *flicker, const struct change *change, double value)
{
    double mean = flicker->options->reference ? change->mean_reference : change->mean;
    return mean > 0 ? value / mean : NAN;
}

static void add_change(cJSON *object, const struct flicker *flicker, const struct change *change)
{
    cJSON_AddNumberToObject(object, "surfaces", (double)change->surfaces);
    cJSON_AddNumberToObject(object, "compared", (double)change->compared);
    cJSON_AddNumberToObject(object, "mean", change->mean);
    cJSON_AddNumberToObject(object, "change", change->change);
    cJSON_AddNumberToObject(object, "relative_change", relative(flicker, change, change->change));
    if (!flicker->options->reference)
        return;
    double excess = change->change - change->change_reference;
    cJSON_AddNumberToObject(object, "mean_reference", change->mean_reference);
    cJSON_AddNumberToObject(object, "change_reference", change->change_reference);
    cJSON_AddNumberToObject(object, "relative_change_reference",
                            relative(flicker, change, change->change_reference));
    cJSON_AddNumberToObject(object, "excess", excess);
    cJSON_AddNumberToObject(object, "relative_excess", relative(flicker, change, excess));
    cJSON_AddNumberToObject(object, "flicker", change->flicker);
    cJSON_AddNumberToObject(object, "relative_flicker", relative(flicker, change, change->flicker));
}

static cJSON *flicker_json(const struct flicker *flicker)
{
    const struct options *options = flicker->options;
    const struct change all = change_mean(flicker->changes, flicker->frames - 1);
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "scene", options->setup.scene);
    if (options->setup.motion)
        cJSON_AddStringToObject(root, "motion", options->setup.motion);
    cJSON_AddStringToObject(root, "test", options->test);
    if (options->reference)
        cJSON_AddStringToObject(root, "reference", options->reference);
    cJSON_AddNumberToObject(root, "frames", flicker->frames);
    cJSON_AddNumberToObject(root, "block", flicker->block);
    add_change(root, flicker, &all);
    cJSON *list = cJSON_AddArrayToObject(root, "per_frame");
    for (uint32_t i = 1; i < flicker->frames; i++) {
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddItemToArray(list, entry);
        cJSON_AddNumberToObject(entry, "frame", i);
        add_change(entry, flicker, &flicker->changes[i - 1]);
    }
    return root;
}

static void print_change(const struct flicker *flicker, const char *name,
                         const struct change *change)
{
    printf("%-6s  %8.1f %%  %9.5f  %7.3f %%", name,
           change->surfaces ? 100 * (double)change->compared / (double)change->surfaces : 0,
           change->mean, 100 * relative(flicker, change, change->change));
    if (flicker->options->reference)
        printf("  %9.5f  %7.3f %%  %7.3f %%  %7.3f %%", change->mean_reference,
               100 * relative(flicker, change, change->change_reference),
               100 * relative(flicker, change, change->change - change->change_reference),
               100 * relative(flicker, change, change->flicker));
    putchar('\n');
}

static void print_changes(const struct flicker *flicker)
{
    const struct change all = change_mean(flicker->changes, flicker->frames - 1);
    char name[16];
    printf("%-6s  %10s  %9s  %9s", "frame", "compared", "mean", "change");
    if (flicker->options->reference)
        printf("  %9s  %9s  %9s  %9s", "reference", "its chg.", "excess", "flicker");
    putchar('\n');
    for (uint32_t i = 1; i < flicker->frames; i++) {
        snprintf(name, sizeof name, "%u", i);
        print_change(flicker, name, &flicker->changes[i - 1]);
    }
    print_change(flicker, "all", &all);
}

/* ---- The verb -------------------------------------------------------------------------------- */

static bool flicker_prepare(struct flicker *flicker)
{
    const struct options *options = flicker->options;
    const struct dt_log *log = &flicker->console->log;
    if (!session_load_scene(&flicker->scene, flicker->console, NULL, &options->setup))
        return false;
    flicker->frames = session_frames(&options->setup, &flicker->scene);
    flicker->block = options->block ? options->block : 1;
    if (flicker->frames < 2) {
        report_error(log, "one frame has no change; give --frames 2 or more, or a --motion");
        return false;
    }
    flicker->changes = calloc(flicker->frames, sizeof *flicker->changes);
    if (!flicker->changes)
        report_error(log, "out of memory");
    flicker->rays = flicker->changes ? ray_scene_open(&flicker->scene.data, log) : NULL;
    return flicker->rays;
}

int verb_flicker(struct console *console, const struct options *options)
{
    struct flicker flicker = {.console = console, .options = options};
    if (!check_patterns(&flicker))
        return EXIT_USAGE;
    bool good = flicker_prepare(&flicker) && measure_pair(&flicker);
    console_status(console, "%s", "");
    if (good) {
        print_changes(&flicker);
        console->result = flicker_json(&flicker);
    }
    ray_scene_close(flicker.rays);
    scene_free(&flicker.scene);
    free(flicker.changes);
    return good ? EXIT_FINE : EXIT_FAILED;
}
