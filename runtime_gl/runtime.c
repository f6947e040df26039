/* The table of verbs that the app calls, in the order of use: open, set_scene, create, resize,
 * render, read, timings, close. Every verb makes the runtime's context current first, so that
 * several runtimes can live in one process. */
#include "internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Open ------------------------------------------------------------------------------------ */

static void runtime_close(void *runtime);

static void *runtime_open(const struct dt_runtime_options *options)
{
    struct gl_runtime *rt = calloc(1, sizeof *rt);
    if (!rt) {
        if (options->log.message)
            options->log.message(options->log.user, DT_ERROR,
                                 "out of memory for an OpenGL runtime");
        return NULL;
    }
    rt->options = *options;
    if (gl_context_open(rt) && gl_builtin_create(rt))
        return rt;
    runtime_close(rt);
    return NULL;
}

static const char *runtime_device_name(void *runtime)
{
    return ((struct gl_runtime *)runtime)->device_name;
}

static bool runtime_is_software(void *runtime)
{
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "lavapipe"};
    const struct gl_runtime *rt = runtime;
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++)
        if (strcasestr(rt->device_name, names[i]))
            return true;
    return false;
}

static bool runtime_set_scene(void *runtime, const struct dt_scene *scene)
{
    struct gl_runtime *rt = runtime;
    return gl_context_current(rt) && gl_scene_upload(rt, scene);
}

/* ---- The panel ------------------------------------------------------------------------------- */

static bool runtime_create(void *runtime, const struct dt_panel *panel)
{
    struct gl_runtime *rt = runtime;
    return gl_context_current(rt) && gl_panel_create(rt, panel);
}

static bool runtime_resize(void *runtime, uint32_t width, uint32_t height)
{
    struct gl_runtime *rt = runtime;
    rt->width = rt->height = 0; /* until it is done nothing can be rendered or read */
    return gl_context_current(rt) && gl_finish(rt, "resize") && gl_panel_resize(rt, width, height);
}

static bool has_size(const struct gl_runtime *rt, const char *verb)
{
    if (rt->panel && rt->width)
        return true;
    gl_log(rt, DT_ERROR,
           "%s: the OpenGL runtime has no pipeline of a size: create and resize come first", verb);
    return false;
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static bool runtime_render(void *runtime, const struct dt_frame *frame, const void *live,
                           const struct dt_observer *observer)
{
    struct gl_runtime *rt = runtime;
    if (!has_size(rt, "render") || !gl_context_current(rt))
        return false;
    return gl_frame_render(rt, frame, live, observer) && gl_finish(rt, "frame");
}

/* One mip of an image, or a buffer: one of the two is NULL. */
struct place {
    const char *name;
    const struct gl_buffer *buffer;
    const struct gl_image *image;
    struct dt_bytes shape; /* without data */
};

static bool find(struct gl_runtime *rt, const char *verb, uint32_t resource, uint32_t mip,
                 struct place *place)
{
    if (!has_size(rt, verb) || !gl_context_current(rt))
        return false;
    if (resource >= rt->panel->pipeline->resource_count) {
        gl_log(rt, DT_ERROR, "%s: the pipeline has no resource %u", verb, resource);
        return false;
    }
    const struct dt_resource *what = &rt->panel->pipeline->resources[resource];
    bool image = what->kind == DT_IMAGE;
    const void *object = rt->panel->resource(rt->state, resource);
    *place = (struct place){
        .name = what->name,
        .buffer = image ? NULL : object,
        .image = image ? object : NULL,
    };
    uint32_t mips = image ? place->image->mips : 1;
    if (mip >= mips) {
        gl_log(rt, DT_ERROR, "%s %s: mip %u, and it has %u", verb, what->name, mip, mips);
        return false;
    }
    if (image) {
        place->shape = gl_image_shape(place->image, mip);
    } else {
        what->extent(rt->width, rt->height, place->shape.extent);
        place->shape.size = (size_t)place->shape.extent[0] * what->stride;
    }
    return true;
}

static bool runtime_read(void *runtime, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct gl_runtime *rt = runtime;
    struct place place = {0};
    *out = (struct dt_bytes){0};
    if (!find(rt, "read", resource, mip, &place))
        return false;
    *out = place.shape;
    return place.image ? gl_read_image(rt, place.image, mip, out)
                       : gl_read_buffer(rt, place.buffer, out);
}

static bool runtime_write(void *runtime, uint32_t resource, uint32_t mip,
                          const struct dt_bytes *bytes)
{
    struct gl_runtime *rt = runtime;
    struct place place = {0};
    if (!find(rt, "write", resource, mip, &place))
        return false;
    const uint32_t *given = bytes->extent, *own = place.shape.extent;
    if (bytes->size != place.shape.size || memcmp(given, own, sizeof place.shape.extent) != 0) {
        gl_log(rt, DT_ERROR,
               "write %s: %zu bytes of %ux%ux%u, but it takes %zu of %ux%ux%u; give what read "
               "gives",
               place.name, bytes->size, given[0], given[1], given[2], place.shape.size, own[0],
               own[1], own[2]);
        return false;
    }
    return place.image ? gl_write_image(rt, place.image, mip, bytes)
                       : gl_write_buffer(rt, place.buffer, bytes);
}

static bool runtime_timings(void *runtime, double *pass_ms)
{
    struct gl_runtime *rt = runtime;
    if (!has_size(rt, "timings") || !gl_context_current(rt))
        return false;
    if (!rt->queries) {
        gl_log(rt, DT_ERROR, "timings: the OpenGL runtime was opened without timing");
        return false;
    }
    return gl_frame_timings(rt, pass_ms);
}

/* A driver may carry out a command before the call returns. */
static double runtime_record_ms(void *runtime)
{
    (void)runtime;
    return (double)NAN;
}

static void *runtime_window(void *runtime)
{
    return ((struct gl_runtime *)runtime)->context.window;
}

static bool has_window(struct gl_runtime *rt, const char *verb)
{
    if (rt->context.window)
        return gl_context_current(rt);
    gl_log(rt, DT_ERROR, "%s: the OpenGL runtime was opened without a window", verb);
    return false;
}

static bool runtime_window_copy(void *runtime, uint32_t texture, uint32_t resource)
{
    struct gl_runtime *rt = runtime;
    struct place place = {0};
    if (!has_window(rt, "window_copy") || !find(rt, "window_copy", resource, 0, &place))
        return false;
    if (place.image && place.image->texel == DT_FORMAT_RGBA8 && !place.image->layered)
        return gl_window_copy(rt, texture, place.image);
    gl_log(rt, DT_ERROR, "window_copy %s: is no image of RGBA8; read it, and use window_upload",
           place.name);
    return false;
}

static bool runtime_window_upload(void *runtime, uint32_t texture, uint32_t width, uint32_t height,
                                  const uint8_t *pixels)
{
    struct gl_runtime *rt = runtime;
    return has_window(rt, "window_upload") && gl_window_upload(rt, texture, width, height, pixels);
}

static bool runtime_present(void *runtime, const struct dt_window_frame *frame)
{
    struct gl_runtime *rt = runtime;
    return has_window(rt, "present") && gl_present(rt, frame);
}

static bool runtime_is_lost(void *runtime)
{
    struct gl_runtime *rt = runtime;
    return rt->lost;
}

static uint32_t runtime_messages(void *runtime)
{
    return ((struct gl_runtime *)runtime)->messages;
}

static void runtime_close(void *runtime)
{
    struct gl_runtime *rt = runtime;
    if (!rt)
        return;
    if (rt->context.kind && gl_context_current(rt)) {
        gl_panel_destroy(rt);
        gl_present_destroy(rt);
        gl_scene_destroy(rt);
        gl_builtin_destroy(rt);
    }
    gl_context_close(rt);
    free(rt);
}

const struct dt_runtime runtime_gl = {
    .name = "gl",
    .open = runtime_open,
    .device_name = runtime_device_name,
    .is_software = runtime_is_software,
    .set_scene = runtime_set_scene,
    .create = runtime_create,
    .resize = runtime_resize,
    .render = runtime_render,
    .read = runtime_read,
    .write = runtime_write,
    .timings = runtime_timings,
    .record_ms = runtime_record_ms,
    .window = runtime_window,
    .window_copy = runtime_window_copy,
    .window_upload = runtime_window_upload,
    .present = runtime_present,
    .is_lost = runtime_is_lost,
    .messages = runtime_messages,
    .close = runtime_close,
};
