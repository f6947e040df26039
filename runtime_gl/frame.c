/* One frame: what generated code calls between render's begin and end. OpenGL records nothing;
 * each verb here acts at once, in the order of the calls. */
#include "internal.h"

/* ---- Passes ---------------------------------------------------------------------------------- */

/* With an observer every pass ends finished, so nothing is pending before the next. The observer
 * may use other contexts; come back to ours. */
static enum dt_action ask_observer(struct gl_runtime *rt, uint32_t pass)
{
    const struct dt_observer *observer = rt->observer;
    if (!observer || !observer->before_pass)
        return DT_RUN;
    enum dt_action action = observer->before_pass(observer->user, pass);
    return gl_context_current(rt) ? action : DT_STOP;
}

bool dt_gl_pass_begin(struct gl_runtime *rt, uint32_t pass, bool runs)
{
    const char *name = rt->panel->pipeline->passes[pass].name;
    enum dt_action action = ask_observer(rt, pass);
    rt->pass = name;
    rt->skips = action == DT_SKIP;
    rt->ran[pass] = runs && action == DT_RUN;
    if (action == DT_STOP)
        return false;
    if (!GL(rt, name, PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, pass, -1, name)))
        return false;
    /* llvmpipe draws later, but dispatches at once, and notes the time when it draws: without a flush
     * a dispatch that waits for nothing is over before its time begins. */
    return !rt->queries || (GL(rt, name, QueryCounter(rt->queries[2 * pass], GL_TIMESTAMP)) &&
                            GL(rt, name, Flush()));
}

bool dt_gl_pass_end(struct gl_runtime *rt, uint32_t pass)
{
    const char *name = rt->panel->pipeline->passes[pass].name;
    if (rt->queries && !GL(rt, name, QueryCounter(rt->queries[2 * pass + 1], GL_TIMESTAMP)))
        return false;
    if (!GL(rt, name, PopDebugGroup()))
        return false;
    const struct dt_observer *observer = rt->observer;
    if (!observer)
        return true;
    return gl_finish(rt, name) &&
           (!observer->after_pass || observer->after_pass(observer->user, pass)) &&
           gl_context_current(rt);
}

bool dt_gl_barrier(struct gl_runtime *rt, GLbitfield bits)
{
    return GL(rt, "barrier", MemoryBarrier(bits));
}

/* ---- Bindings -------------------------------------------------------------------------------- */

/* What is bound as a uniform block: as much as shaders declare. */
static GLsizeiptr block_size(const struct gl_buffer *buffer)
{
    return buffer->block ? buffer->block : buffer->size;
}

static bool check_binding(struct gl_runtime *rt, const struct gl_binding *binding)
{
    const struct gl_limits *l = &rt->limits;
    const struct {
        const char *what;
        GLint count;
    } limits[] = {
        [GL_BIND_UNIFORM] = {"uniform buffer", l->uniform_bindings},
        [GL_BIND_STORAGE] = {"storage buffer", l->storage_bindings},
        [GL_BIND_TEXTURE] = {"texture", l->texture_bindings},
        [GL_BIND_IMAGE] = {"storage image", l->image_bindings},
    };
    const char *name = binding->buffer ? binding->buffer->name : binding->image->name;
    if (binding->binding >= (uint32_t)limits[binding->kind].count) {
        gl_log(rt, DT_ERROR, "%s: %s binding %u, and %s has %d of them", name,
               limits[binding->kind].what, binding->binding, rt->device_name,
               limits[binding->kind].count);
        return false;
    }
    if (binding->kind == GL_BIND_UNIFORM && binding->buffer &&
        block_size(binding->buffer) > l->uniform_size) {
        gl_log(rt, DT_ERROR,
               "%s: %lld bytes, and %s allows %lld in a uniform block: make it a storage buffer",
               name, (long long)block_size(binding->buffer), rt->device_name,
               (long long)l->uniform_size);
        return false;
    }
    return true;
}

static bool bind_buffer(struct gl_runtime *rt, GLenum target, GLuint index,
                        const struct gl_buffer *buffer)
{
    bool block = target == GL_UNIFORM_BUFFER;
    if (buffer->imported || buffer->block)
        return GL(rt, buffer->name,
                  BindBufferRange(target, index, buffer->handle, buffer->offset,
                                  block ? block_size(buffer) : buffer->size));
    return GL(rt, buffer->name, BindBufferBase(target, index, buffer->handle));
}

static bool bind_one(struct gl_runtime *rt, const struct gl_binding *b)
{
    const struct gl_image *image = b->image;
    if (rt->kept)
        gl_state_keep_binding(rt, b);
    switch (b->kind) {
    case GL_BIND_UNIFORM:
        return bind_buffer(rt, GL_UNIFORM_BUFFER, b->binding, b->buffer);
    case GL_BIND_STORAGE:
        return bind_buffer(rt, GL_SHADER_STORAGE_BUFFER, b->binding, b->buffer);
    case GL_BIND_TEXTURE:
        return GL(rt, image->name, BindTextureUnit(b->binding, image->handle)) &&
               GL(rt, image->name, BindSampler(b->binding, b->sampler ? b->sampler : rt->nearest));
    case GL_BIND_IMAGE:
        return GL(rt, image->name,
                  BindImageTexture(b->binding, image->handle, (GLint)b->mip, image->layered, 0,
                                   b->access, image->format));
    }
    return false;
}

bool dt_gl_bind(struct gl_runtime *rt, const struct gl_binding *bindings, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!check_binding(rt, &bindings[i]) || !bind_one(rt, &bindings[i]))
            return false;
    return true;
}

/* ---- Compute --------------------------------------------------------------------------------- */

bool dt_gl_dispatch(struct gl_runtime *rt, const struct gl_program *program, uint32_t x, uint32_t y,
                    uint32_t z)
{
    const GLint *most = rt->limits.groups;
    if (rt->skips)
        return true;
    if (x > (uint32_t)most[0] || y > (uint32_t)most[1] || z > (uint32_t)most[2]) {
        gl_log(rt, DT_ERROR, "pass %s: %u x %u x %u workgroups, and %s allows %d x %d x %d",
               program->name, x, y, z, rt->device_name, most[0], most[1], most[2]);
        return false;
    }
    return GL(rt, program->name, UseProgram(program->handle)) &&
           GL(rt, program->name, DispatchCompute(x, y, z));
}

bool dt_gl_dispatch_indirect(struct gl_runtime *rt, const struct gl_program *program,
                             const struct gl_buffer *arguments)
{
    if (rt->skips)
        return true;
    return GL(rt, program->name, UseProgram(program->handle)) &&
           GL(rt, arguments->name, BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, arguments->handle)) &&
           GL(rt, program->name, DispatchComputeIndirect(0));
}

/* ---- Clears ---------------------------------------------------------------------------------- */

static bool clear_color(struct gl_runtime *rt, GLuint framebuffer, GLint index,
                        const struct gl_target *target)
{
    const char *name = target->image->name;
    const float *c = target->clear;
    switch (gl_format(target->image->texel)->type) {
    case GL_UNSIGNED_INT: {
        const GLuint value[4] = {(GLuint)c[0], (GLuint)c[1], (GLuint)c[2], (GLuint)c[3]};
        return GL(rt, name, ClearNamedFramebufferuiv(framebuffer, GL_COLOR, index, value));
    }
    case GL_INT: {
        const GLint value[4] = {(GLint)c[0], (GLint)c[1], (GLint)c[2], (GLint)c[3]};
        return GL(rt, name, ClearNamedFramebufferiv(framebuffer, GL_COLOR, index, value));
    }
    default:
        return GL(rt, name, ClearNamedFramebufferfv(framebuffer, GL_COLOR, index, c));
    }
}

bool dt_gl_clear_targets(struct gl_runtime *rt, GLuint framebuffer,
                         const struct gl_targets *targets)
{
    if (rt->skips)
        return true;
    for (uint32_t i = 0; i < targets->color_count; i++)
        if (!targets->color[i].load && !clear_color(rt, framebuffer, (GLint)i, &targets->color[i]))
            return false;
    const struct gl_target *depth = &targets->depth;
    if (!depth->image || depth->load)
        return true;
    rt->gl.DepthMask(GL_TRUE); /* clears obey it */
    return GL(rt, depth->image->name,
              ClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, depth->clear));
}

bool dt_gl_clear_image(struct gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                       const float clear[4])
{
    const GLuint u[4] = {(GLuint)clear[0], (GLuint)clear[1], (GLuint)clear[2], (GLuint)clear[3]};
    const GLint i[4] = {(GLint)clear[0], (GLint)clear[1], (GLint)clear[2], (GLint)clear[3]};
    GLenum format = gl_depth(image) ? GL_DEPTH_COMPONENT : GL_RGBA, type = GL_FLOAT;
    const void *value = clear;
    if (rt->skips)
        return true;
    switch (gl_format(image->texel)->type) {
    case GL_UNSIGNED_INT:
        format = GL_RGBA_INTEGER, type = GL_UNSIGNED_INT, value = u;
        break;
    case GL_INT:
        format = GL_RGBA_INTEGER, type = GL_INT, value = i;
        break;
    default:
        break;
    }
    return GL(rt, image->name, ClearTexImage(image->handle, (GLint)mip, format, type, value));
}

bool dt_gl_clear_buffer(struct gl_runtime *rt, const struct gl_buffer *buffer)
{
    if (rt->skips)
        return true;
    return GL(
        rt, buffer->name,
        ClearNamedBufferData(buffer->handle, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL));
}

/* ---- Draws ----------------------------------------------------------------------------------- */

static void enable(struct gl_runtime *rt, GLenum what, bool on)
{
    if (on)
        rt->gl.Enable(what);
    else
        rt->gl.Disable(what);
}

static void set_raster_state(struct gl_runtime *rt, const struct gl_program_info *info)
{
    enable(rt, GL_DEPTH_TEST,
           info->depth_test || info->depth_write); /* without the test nothing is written */
    rt->gl.DepthMask(info->depth_write);
    rt->gl.DepthFunc(info->depth_test ? info->depth_compare : GL_ALWAYS);
    enable(rt, GL_CULL_FACE, info->cull != GL_NONE);
    if (info->cull != GL_NONE)
        rt->gl.CullFace(info->cull);
    enable(rt, GL_BLEND, info->blend_add);
    rt->gl.BlendFunc(GL_ONE, GL_ONE);
    for (uint32_t i = 0; i < (uint32_t)rt->limits.clip_distances; i++)
        enable(rt, GL_CLIP_DISTANCE0 + i, i < info->clip_distances);
}

static void set_viewport(struct gl_runtime *rt, const struct gl_targets *targets)
{
    const struct gl_target *target = targets->color_count ? &targets->color[0] : &targets->depth;
    GLsizei width = (GLsizei)(target->image->width >> target->mip);
    GLsizei height = (GLsizei)(target->image->height >> target->mip);
    rt->gl.Viewport(0, 0, width < 1 ? 1 : width, height < 1 ? 1 : height);
}

static bool begin_draw(struct gl_runtime *rt, const struct gl_program *program, GLuint framebuffer,
                       const struct gl_targets *targets, GLuint input)
{
    if (!GL(rt, program->name, BindFramebuffer(GL_FRAMEBUFFER, framebuffer)) ||
        !dt_gl_clear_targets(rt, framebuffer, targets))
        return false;
    set_viewport(rt, targets);
    set_raster_state(rt, &program->info);
    return GL(rt, program->name, UseProgram(program->handle)) &&
           GL(rt, program->name, BindVertexArray(input));
}

static bool begin_scene(struct gl_runtime *rt, const struct gl_program *program, GLuint framebuffer,
                        const struct gl_targets *targets)
{
    if (!rt->scene_input) {
        gl_log(rt, DT_ERROR, "pass %s draws the scene, and none was set", program->name);
        return false;
    }
    return begin_draw(rt, program, framebuffer, targets,
                      program->info.scene_vertices ? rt->scene_input : rt->no_input);
}

/* Programs without vertex input fetch their vertices from the storage buffers, but are drawn by
 * index all the same. */
static bool set_indices(struct gl_runtime *rt, const struct gl_program *program,
                        const struct gl_buffer *indices)
{
    GLuint input = program->info.scene_vertices ? rt->scene_input : rt->no_input;
    return GL(rt, indices->name, VertexArrayElementBuffer(input, indices->handle));
}

bool dt_gl_draw_scene(struct gl_runtime *rt, const struct gl_program *program, GLuint framebuffer,
                      const struct gl_targets *targets, uint32_t instances)
{
    if (rt->skips)
        return true;
    return begin_scene(rt, program, framebuffer, targets) &&
           set_indices(rt, program, &rt->builtin.indices) &&
           GL(rt, program->name,
              DrawElementsInstanced(GL_TRIANGLES, (GLsizei)rt->index_count, GL_UNSIGNED_INT, NULL,
                                    (GLsizei)instances));
}

bool dt_gl_draw_scene_indirect(struct gl_runtime *rt, const struct gl_program *program,
                               GLuint framebuffer, const struct gl_targets *targets,
                               const struct gl_buffer *indices, const struct gl_buffer *arguments,
                               uint32_t draw_count)
{
    if (rt->skips)
        return true;
    return begin_scene(rt, program, framebuffer, targets) &&
           set_indices(rt, program, indices ? indices : &rt->builtin.indices) &&
           GL(rt, arguments->name, BindBuffer(GL_DRAW_INDIRECT_BUFFER, arguments->handle)) &&
           GL(rt, program->name,
              MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, NULL, (GLsizei)draw_count,
                                        0));
}

bool dt_gl_draw_fullscreen(struct gl_runtime *rt, const struct gl_program *program,
                           GLuint framebuffer, const struct gl_targets *targets)
{
    if (rt->skips)
        return true;
    return begin_draw(rt, program, framebuffer, targets, rt->no_input) &&
           GL(rt, program->name, DrawArrays(GL_TRIANGLES, 0, 3));
}
