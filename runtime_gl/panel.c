/* The pipeline that a runtime holds, from create to destroy, and its frames. Called by runtime.c for the
 * app and by host.c for other programs, with the context current. */
#include "internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- What every pipeline uses ---------------------------------------------------------------- */

bool gl_builtin_create(struct gl_runtime *rt)
{
    const struct gl_buffer_info frame = {.name = "frame", .size = sizeof(struct dt_frame)};
    const struct gl_sampler_info nearest = {"nearest",        GL_NEAREST, GL_NEAREST,
                                            GL_CLAMP_TO_EDGE, false,      1.0f};
    const struct gl_sampler_info trilinear = {"scene textures", GL_LINEAR, GL_LINEAR,
                                              GL_REPEAT,        false,     1.0f};
    return dt_gl_buffer_create(rt, &rt->builtin.frame, &frame) &&
           dt_gl_sampler_create(rt, &rt->nearest, &nearest) &&
           dt_gl_sampler_create(rt, &rt->builtin.texture_sampler, &trilinear) &&
           GL(rt, "no vertex input", CreateVertexArrays(1, &rt->no_input));
}

void gl_builtin_destroy(struct gl_runtime *rt)
{
    dt_gl_buffer_destroy(rt, &rt->builtin.frame);
    dt_gl_sampler_destroy(rt, &rt->builtin.texture_sampler);
    dt_gl_sampler_destroy(rt, &rt->nearest);
    if (rt->no_input)
        rt->gl.DeleteVertexArrays(1, &rt->no_input);
}

const struct gl_builtin *dt_gl_builtin(const struct gl_runtime *rt)
{
    return &rt->builtin;
}

/* ---- The panel ------------------------------------------------------------------------------- */

void gl_panel_destroy(struct gl_runtime *rt)
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
    const struct gl_buffer_info live = {.name = "live parameters", .size = pipeline->block_size};
    return allocate_panel(rt, pipeline) &&
           gl_buffer_upload(rt, &rt->builtin.live, &live, pipeline->live_defaults) &&
           (!rt->queries ||
            GL(rt, "timestamps",
               CreateQueries(GL_TIMESTAMP, (GLsizei)(2 * pipeline->pass_count), rt->queries))) &&
           rt->panel->create(rt, rt->state);
}

/* An edit leaves most programs as they are, so these go from the panel before to the new one. */
bool gl_panel_create(struct gl_runtime *rt, const struct dt_panel *panel)
{
    rt->spare.keeps = true;
    gl_panel_destroy(rt);
    rt->spare.keeps = false;
    rt->panel = panel;
    bool good = create_panel(rt, panel->pipeline);
    if (!good)
        gl_panel_destroy(rt);
    gl_programs_forget(rt);
    return good;
}

bool gl_panel_resize(struct gl_runtime *rt, uint32_t width, uint32_t height)
{
    rt->width = rt->height = 0; /* until it is done nothing can be rendered or read */
    if (!rt->panel->resize(rt, rt->state, width, height))
        return false;
    memset(rt->ran, 0, rt->panel->pipeline->pass_count * sizeof *rt->ran);
    rt->width = width;
    rt->height = height;
    return true;
}

/* ---- Frames ---------------------------------------------------------------------------------- */

bool gl_frame_render(struct gl_runtime *rt, const struct dt_frame *frame, const void *live,
                     const struct dt_observer *observer)
{
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
    return ok;
}

bool gl_frame_timings(struct gl_runtime *rt, double *pass_ms)
{
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
