/* Error checks and messages. */
#include "internal.h"

#include <string.h>

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

/* Names the pass that noticed the reset. With an observer this pass caused the reset, since every
 * pass finishes before the next. */
static bool device_lost(struct dt_gl_runtime *rt, const char *call, const char *object,
                        GLenum status)
{
    struct dt_core *core = &rt->core;
    const char *name = rt->recording ? core->pipeline->passes[core->pass].name : object;
    core->lost = true;
    return dt_error(core, "%s%s: gl%.*s: the device was reset %s", rt->recording ? "pass " : "",
                    name, (int)strcspn(call, "("), call, reset_text(status));
}

bool gl_check(struct dt_gl_runtime *rt, const char *call, const char *object)
{
    GLenum error = rt->gl.GetError();
    if (error == GL_NO_ERROR)
        return true;
    if (error == GL_CONTEXT_LOST)
        return device_lost(rt, call, object, rt->gl.GetGraphicsResetStatus());
    dt_error(&rt->core, "%s: gl%.*s: %s", object, (int)strcspn(call, "("), call, error_text(error));
    /* Clears further errors, so that the next call is not blamed for them. Stops after 8: a lost
     * context repeats its error forever. */
    for (int i = 0; i < 8 && error != GL_NO_ERROR && error != GL_CONTEXT_LOST; i++)
        error = rt->gl.GetError();
    return false;
}

bool gl_finish(struct dt_gl_runtime *rt, const char *object)
{
    if (!GL(rt, object, Finish()))
        return false;
    GLenum status = rt->gl.GetGraphicsResetStatus();
    return status == GL_NO_ERROR || device_lost(rt, "Finish", object, status);
}
