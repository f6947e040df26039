/* struct dt_runtime runtime_gl: the front's verbs plus functions for the app's own context. Every
 * verb first makes its context current, so that several runtimes can coexist in one process. */
#include "internal.h"

#include <math.h>
#include <stdlib.h>

static bool enter(struct dt_core *core)
{
    return gl_context_current((struct dt_gl_runtime *)core);
}

static void runtime_close(void *runtime)
{
    struct dt_gl_runtime *rt = runtime;
    if (!rt)
        return;
    if (rt->context.kind && gl_context_current(rt)) {
        dt_front_destroy(&rt->core);
        gl_scene_destroy(rt);
        gl_builtin_destroy(rt);
    }
    gl_context_close(rt);
    free(rt);
}

static void set_backend(struct dt_gl_runtime *rt)
{
    struct dt_backend *backend = &rt->backend;
    *backend = gl_backend;
    backend->enter = enter;
    backend->leave = NULL;
    backend->read = gl_read;
    rt->core.backend = backend;
}

static void *runtime_open(const struct dt_runtime_options *options)
{
    const struct dt_core bare = {.log = options->log};
    struct dt_gl_runtime *rt = calloc(1, sizeof *rt);
    if (!rt) {
        dt_error(&bare, "out of memory for an OpenGL runtime; free some");
        return NULL;
    }
    rt->core = bare;
    rt->core.timing = options->timing;
    rt->core.poison = options->poison;
    rt->core.keep_history = options->keep_history;
    rt->debug = options->debug;
    rt->glsl = options->glsl;
    set_backend(rt);
    if (gl_context_open(rt, options->context) && gl_builtin_create(rt))
        return rt;
    runtime_close(rt);
    return NULL;
}

/* NAN: a driver may execute a command before the call returns. */
static double runtime_record_ms(void *runtime)
{
    (void)runtime;
    return (double)NAN;
}

const struct dt_runtime runtime_gl = {
    .name = "gl",
    .open = runtime_open,
    DT_SHARED_VERBS,
    .record_ms = runtime_record_ms,
    .close = runtime_close,
};
