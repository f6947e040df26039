/* The table of verbs that the app calls, in the order of use: open, set_scene, create, resize,
 * render, read, timings, close. Every verb makes the runtime's context current first, so that
 * several runtimes can live in one process. */
#include "internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Log and errors -------------------------------------------------------------------------- */

void gl_log(const struct gl_runtime *rt, enum dt_level level, const char *format, ...)
{
    if (!rt->options.log.message)
        return;
    va_list args;
    va_start(args, format);
    char *text = NULL;
    if (vasprintf(&text, format, args) >= 0)
        rt->options.log.message(rt->options.log.user, level, text);
    else
        rt->options.log.message(rt->options.log.user, level,
                                "out of memory while telling an OpenGL error");
    va_end(args);
    free(text);
}

static const char *error_text(GLenum error)
{
    switch (error) {
    case GL_INVALID_ENUM:
        return "invalid enumerant";
    case GL_INVALID_VALUE:
        return "invalid value";
    case GL_INVALID_OPERATION:
        return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "incomplete framebuffer";
    case GL_OUT_OF_MEMORY:
        return "out of memory: use a smaller frame or smaller resources";
    case GL_STACK_OVERFLOW:
        return "stack overflow";
    case GL_STACK_UNDERFLOW:
        return "stack underflow";
    default:
        return "unknown error";
    }
}

static const char *reset_text(GLenum status)
{
    switch (status) {
    case GL_GUILTY_CONTEXT_RESET:
        return "because of this program, perhaps a pass that ran too long: try a smaller frame";
    case GL_INNOCENT_CONTEXT_RESET:
        return "because of another program: start again";
    default:
        return "and does not say why: see the system log, and start again";
    }
}

/* Names the pass in which it was noticed: the guilty one when an observer has every pass finish
 * before the next. */
static bool device_lost(const struct gl_runtime *rt, const char *call, const char *object,
                        GLenum status)
{
    gl_log(rt, DT_ERROR, "%s%s: gl%.*s: the device was reset %s", rt->pass ? "pass " : "",
           rt->pass ? rt->pass : object, (int)strcspn(call, "("), call, reset_text(status));
    return false;
}

bool gl_check(const struct gl_runtime *rt, const char *call, const char *object)
{
    GLenum error = rt->gl.GetError();
    if (error == GL_NO_ERROR)
        return true;
    if (error == GL_CONTEXT_LOST)
        return device_lost(rt, call, object, rt->gl.GetGraphicsResetStatus());
    gl_log(rt, DT_ERROR, "%s: gl%.*s: %s", object, (int)strcspn(call, "("), call,
           error_text(error));
    /* The next call must not be blamed for what this one left behind; a lost context repeats its
     * error for ever. */
    for (int i = 0; i < 8 && error != GL_NO_ERROR && error != GL_CONTEXT_LOST; i++)
        error = rt->gl.GetError();
    return false;
}

bool gl_finish(const struct gl_runtime *rt, const char *object)
{
    if (!GL(rt, object, Finish()))
        return false;
    GLenum status = rt->gl.GetGraphicsResetStatus();
    return status == GL_NO_ERROR || device_lost(rt, "Finish", object, status);
}

/* ---- Open ------------------------------------------------------------------------------------ */

static bool create_builtin(struct gl_runtime *rt)
{
    const struct gl_buffer_info frame = {"frame", sizeof(struct dt_frame)};
    const struct gl_sampler_info nearest = {"nearest",        GL_NEAREST, GL_NEAREST,
                                            GL_CLAMP_TO_EDGE, false,      1.0f};
    const struct gl_sampler_info trilinear = {"scene textures", GL_LINEAR, GL_LINEAR,
                                              GL_REPEAT,        false,     1.0f};
    return dt_gl_buffer_create(rt, &rt->builtin.frame, &frame) &&
           dt_gl_sampler_create(rt, &rt->nearest, &nearest) &&
           dt_gl_sampler_create(rt, &rt->builtin.texture_sampler, &trilinear) &&
           GL(rt, "no vertex input", CreateVertexArrays(1, &rt->no_input));
}

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
    if (gl_context_open(rt) && create_builtin(rt))
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

const struct gl_builtin *dt_gl_builtin(const struct gl_runtime *rt)
{
    return &rt->builtin;
}

static bool runtime_set_scene(void *runtime, const struct dt_scene *scene)
{
    struct gl_runtime *rt = runtime;
    return gl_context_current(rt) && gl_scene_upload(rt, scene);
}

/* ---- The panel ------------------------------------------------------------------------------- */

static void destroy_panel(struct gl_runtime *rt)
{
    if (!rt->panel)
        return;
    if (rt->state)
        rt->panel->destroy(rt, rt->state);
    if (rt->queries)
        rt->gl.DeleteQueries((GLsizei)(2 * rt->panel->pipeline->pass_count), rt->queries);
    dt_gl_buffer_destroy(rt, &rt->builtin.live);
    free(rt->queries);
    free(rt->ran);
    free(rt->state);
    rt->queries = NULL;
    rt->ran = NULL;
    rt->state = NULL;
    rt->panel = NULL;
    rt->width = rt->height = 0;
}

static bool allocate_panel(struct gl_runtime *rt, const struct dt_pipeline *pipeline)
{
    rt->state = calloc(1, rt->panel->state_size ? rt->panel->state_size : 1);
    rt->ran = calloc(pipeline->pass_count + 1, sizeof *rt->ran);
    bool ok = rt->state && rt->ran;
    if (ok && rt->options.timing) {
        rt->queries = calloc(2 * pipeline->pass_count + 1, sizeof *rt->queries);
        ok = rt->queries;
    }
    if (!ok)
        gl_log(rt, DT_ERROR, "pipeline %s: out of memory", pipeline->name);
    return ok;
}

static bool create_panel(struct gl_runtime *rt, const struct dt_pipeline *pipeline)
{
    const struct gl_buffer_info live = {"live parameters", pipeline->live_size};
    return allocate_panel(rt, pipeline) &&
           gl_buffer_upload(rt, &rt->builtin.live, &live, pipeline->live_defaults) &&
           (!rt->queries ||
            GL(rt, "timestamps",
               CreateQueries(GL_TIMESTAMP, (GLsizei)(2 * pipeline->pass_count), rt->queries))) &&
           rt->panel->create(rt, rt->state);
}

static bool runtime_create(void *runtime, const struct dt_panel *panel)
{
    struct gl_runtime *rt = runtime;
    if (!gl_context_current(rt))
        return false;
    destroy_panel(rt);
    rt->panel = panel;
    if (create_panel(rt, panel->pipeline))
        return true;
    destroy_panel(rt);
    return false;
}

static bool runtime_resize(void *runtime, uint32_t width, uint32_t height)
{
    struct gl_runtime *rt = runtime;
    rt->width = rt->height = 0; /* until it is done nothing can be rendered or read */
    if (!gl_context_current(rt) || !gl_finish(rt, "resize") ||
        !rt->panel->resize(rt, rt->state, width, height))
        return false;
    memset(rt->ran, 0, rt->panel->pipeline->pass_count * sizeof *rt->ran);
    rt->width = width;
    rt->height = height;
    return true;
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
    struct dt_frame sized = *frame;
    sized.width = rt->width;
    sized.height = rt->height;
    const void *values = live ? live : rt->panel->pipeline->live_defaults;
    if (!gl_buffer_write(rt, &rt->builtin.frame, &sized, sizeof sized) ||
        !gl_buffer_write(rt, &rt->builtin.live, values, rt->panel->pipeline->live_size))
        return false;
    rt->observer = observer;
    bool ok = rt->panel->record(rt, rt->state, values);
    rt->observer = NULL;
    rt->pass = NULL;
    return ok && gl_finish(rt, "frame");
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
    for (uint32_t i = 0; i < rt->panel->pipeline->pass_count; i++) {
        const char *name = rt->panel->pipeline->passes[i].name;
        GLuint64 begin = 0, end = 0;
        if (rt->ran[i] &&
            (!GL(rt, name, GetQueryObjectui64v(rt->queries[2 * i], GL_QUERY_RESULT, &begin)) ||
             !GL(rt, name, GetQueryObjectui64v(rt->queries[2 * i + 1], GL_QUERY_RESULT, &end))))
            return false;
        pass_ms[i] = rt->ran[i] ? (double)(end - begin) * 1e-6 : (double)NAN;
    }
    return true;
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
        destroy_panel(rt);
        gl_present_destroy(rt);
        gl_scene_destroy(rt);
        dt_gl_buffer_destroy(rt, &rt->builtin.frame);
        dt_gl_sampler_destroy(rt, &rt->builtin.texture_sampler);
        dt_gl_sampler_destroy(rt, &rt->nearest);
        if (rt->no_input)
            rt->gl.DeleteVertexArrays(1, &rt->no_input);
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
    .messages = runtime_messages,
    .close = runtime_close,
};
