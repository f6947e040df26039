/* Error checks and messages. */
#include "internal.h"

#include <string.h>

/* Of errors, resets and framebuffers: their numbers are apart. */
static const struct {
    GLenum value;
    const char *text;
} texts[] = {
    {GL_INVALID_ENUM, "invalid enumerant"},
    {GL_INVALID_VALUE, "invalid value"},
    {GL_INVALID_OPERATION, "invalid operation"},
    {GL_INVALID_FRAMEBUFFER_OPERATION, "incomplete framebuffer"},
    {GL_OUT_OF_MEMORY, "out of memory: use a smaller frame or smaller resources"},
    {GL_STACK_OVERFLOW, "stack overflow"},
    {GL_STACK_UNDERFLOW, "stack underflow"},
    {GL_GUILTY_CONTEXT_RESET,
     "because of this program, perhaps a pass that ran too long: try a smaller frame"},
    {GL_INNOCENT_CONTEXT_RESET, "because of another program: start again"},
    {GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT, "a target has a format that cannot be drawn to"},
    {GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT, "it has no target"},
    {GL_FRAMEBUFFER_INCOMPLETE_LAYER_TARGETS, "layered and single images are mixed"},
    {GL_FRAMEBUFFER_UNSUPPORTED, "the driver does not support this combination of formats"},
};

const char *gl_text(GLenum value, const char *other)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(texts); i++)
        if (texts[i].value == value)
            return texts[i].text;
    return other;
}

/* Names the pass that noticed the reset. With an observer this pass caused the reset, since every
 * pass finishes before the next. */
static bool device_lost(struct dt_gl_runtime *rt, const char *call, const char *object,
                        GLenum status)
{
    struct dt_core *core = &rt->core;
    const char *name = rt->recording ? dt_pass_name(core, core->pass) : object;
    core->device.lost = true;
    return dt_error(core, "%s%s: gl%.*s: the device was reset %s", rt->recording ? "pass " : "",
                    name, (int)strcspn(call, "("), call,
                    gl_text(status, "and does not say why: see the system log, and start again"));
}

bool gl_check(struct dt_gl_runtime *rt, const char *call, const char *object)
{
    GLenum error = rt->gl.GetError();
    if (error == GL_NO_ERROR)
        return true;
    if (error == GL_CONTEXT_LOST)
        return device_lost(rt, call, object, rt->gl.GetGraphicsResetStatus());
    dt_error(&rt->core, "%s: gl%.*s: %s", object, (int)strcspn(call, "("), call,
             gl_text(error, "unknown error"));
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
