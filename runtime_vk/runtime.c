/* struct dt_runtime runtime_vk: the Vulkan runtime of the app, with its own device. Most verbs are
 * the front's, which calls back through struct dt_backend. */
#include "internal.h"

#include <math.h>
#include <stdlib.h>

static void runtime_close(void *runtime)
{
    struct dt_vk_runtime *rt = runtime;
    if (!rt)
        return;
    dt_front_destroy(&rt->core);
    if (rt->device) {
        vk_scene_destroy(rt);
        vk_builtin_destroy(rt);
        vk_buffer_destroy(rt, &rt->staging);
    }
    vk_context_close(rt);
    free(rt);
}

/* vk_backend plus the functions that only the app uses. */
static void set_backend(struct dt_vk_runtime *rt)
{
    struct dt_backend *backend = &rt->backend;
    *backend = vk_backend;
    backend->upload_scene = vk_scene_upload;
    backend->render = vk_frame_render;
    backend->pause = vk_frame_pause;
    backend->resume = vk_frame_resume;
    backend->read = vk_read;
    backend->write = vk_write;
    rt->core.backend = backend;
}

static void *runtime_open(const struct dt_runtime_options *options)
{
    struct dt_vk_runtime *rt = calloc(1, sizeof *rt);
    if (!rt) {
        dt_error(&(struct dt_core){.log = options->log}, "Vulkan: out of memory; free some");
        return NULL;
    }
    set_backend(rt);
    rt->core.log = options->log;
    rt->core.timing = options->timing;
    rt->core.poison = options->poison;
    rt->core.keep_history = options->keep_history;
    rt->debug = options->debug;
    rt->labels = options->debug || options->labels;
    if (vk_context_open(rt, options) && vk_builtin_create(rt))
        return rt;
    runtime_close(rt);
    return NULL;
}

static double runtime_record_ms(void *runtime)
{
    const struct dt_vk_runtime *rt = runtime;
    return rt->core.rendered ? rt->record_ms : NAN;
}

const struct dt_runtime runtime_vk = {
    .name = "vk",
    .open = runtime_open,
    DT_SHARED_VERBS,
    .record_ms = runtime_record_ms,
    .close = runtime_close,
};
