/* `diptych flicker`: finds the surface of each pixel by rays into the scene, and lets Python measure how
 * the pictures change there; see app/python/diptych/flicker.py. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/numbered.h"
#include "console/options.h"
#include "run/session.h"
#include "truth/hand_over.h"
#include "truth/rays.h"
#include "truth/tracer.h"

/* The surface at a pixel's centre. */
struct seen_point {
    float position[3];
    float depth;     /* along the view; 0: background */
    float normal[3]; /* unit, as interpolated */
    float plane[3];  /* unit, of the triangle */
};

struct flicker {
    struct console *console;
    const struct options *options;
    uint32_t frames;
    struct scene scene;
    struct ray_scene *rays;
};

static bool check_patterns(const struct flicker *flicker)
{
    const struct options *options = flicker->options;
    const struct dt_log *log = &flicker->console->log;
    const char *const paths[] = {options->test, options->reference};
    const char *const names[] = {"--test", "--reference"};
    for (int i = 0; i < 2; i++) {
        bool good = true;
        if (paths[i] && !is_numbered(paths[i], names[i], &good, log))
            return report_error(log,
                                "%s %s: names one picture; put %%04d in place of the frame number",
                                names[i], paths[i]);
        if (!good)
            return false;
    }
    return true;
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static struct seen_point see(const struct flicker *flicker, const struct dt_frame *frame,
                             uint32_t x, uint32_t y)
{
    const struct dt_view *camera = &frame->camera;
    float origin[3], direction[3];
    struct ray_hit hit;
    struct seen_point point = {.depth = 0};
    tracer_camera_ray(frame, x + 0.5, y + 0.5, origin, direction);
    if (!ray_closest(flicker->rays, vec3_of(origin), vec3_of(direction), &hit))
        return point;
    memcpy(point.position, &hit.position, sizeof point.position);
    memcpy(point.normal, &hit.normal, sizeof point.normal);
    memcpy(point.plane, &hit.geometric, sizeof point.plane);
    point.depth = fmaxf(
        dot(subtract(hit.position, vec3_of(camera->position)), vec3_of(camera->direction)), 1e-12f);
    return point;
}

static bool send_surfaces(const struct flicker *flicker, uint32_t index, const uint32_t size[2],
                          FILE *stream)
{
    struct dt_frame frame;
    scene_frame_at(&flicker->scene, index, size[0], size[1], &frame);
    frame.width = size[0];
    frame.height = size[1];
    fwrite(frame.camera.view_projection, sizeof frame.camera.view_projection, 1, stream);
    for (uint32_t y = 0; y < size[1]; y++)
        for (uint32_t x = 0; x < size[0]; x++) {
            const struct seen_point point = see(flicker, &frame, x, y);
            fwrite(&point, sizeof point, 1, stream);
        }
    return !ferror(stream);
}

/* Of each frame its pictures, the view's matrix, and the surfaces. All pictures have one size. */
static bool send_frames(FILE *stream, void *user)
{
    const struct flicker *flicker = user;
    const struct options *options = flicker->options;
    const char *const patterns[] = {options->test, options->reference};
    uint32_t size[2] = {0};
    bool good = true;
    for (uint32_t i = 0; i < flicker->frames && good; i++) {
        for (int k = 0; k < 2 && patterns[k] && good; k++) {
            char *path = numbered_path(patterns[k], i);
            char *name = format_string("frame %u of %s", i, patterns[k]);
            good =
                path && name && hand_over_picture(stream, path, name, size, &flicker->console->log);
            free(name);
            free(path);
        }
        good = good && send_surfaces(flicker, i, size, stream);
    }
    return good;
}

/* ---- The verb -------------------------------------------------------------------------------- */

static bool flicker_prepare(struct flicker *flicker)
{
    const struct options *options = flicker->options;
    const struct dt_log *log = &flicker->console->log;
    if (!session_load_scene(&flicker->scene, flicker->console, NULL, &options->setup))
        return false;
    flicker->frames = session_frames(&options->setup, &flicker->scene);
    if (flicker->frames < 2)
        return report_error(log, "one frame has no change; give --frames 2 or more, or a --motion");
    flicker->rays = ray_scene_open(&flicker->scene.data, log);
    return flicker->rays;
}

int verb_flicker(struct console *console, const struct options *options)
{
    struct flicker flicker = {.console = console, .options = options};
    int status = EXIT_FAILED;
    if (!check_patterns(&flicker))
        return EXIT_USAGE;
    if (flicker_prepare(&flicker)) {
        cJSON *request = options_json(options, VERB_FLICKER);
        cJSON_DeleteItemFromObject(request, "frames");
        cJSON_AddNumberToObject(request, "frames", flicker.frames);
        status = hand_over_stream(console, "flicker", request, send_frames, &flicker);
    }
    ray_scene_close(flicker.rays);
    scene_free(&flicker.scene);
    return status;
}
