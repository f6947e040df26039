/* One frame: the verbs that a panel's record calls through the front. OpenGL records nothing: each
 * verb runs at once. */
#include "internal.h"

static const struct dt_program *info_of(const struct dt_gl_runtime *rt, uint32_t pass)
{
    return &rt->core.panel->programs[pass];
}

static const struct gl_program *program_of(const struct dt_gl_runtime *rt, uint32_t pass)
{
    return dt_program(&rt->core, pass);
}

/* ---- Passes ---------------------------------------------------------------------------------- */

static bool begin(struct dt_core *core, uint32_t pass, bool runs)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const char *name = dt_pass_name(&rt->core, pass);
    uint32_t query = 2 * dt_run(&rt->core, rt->core.slot, pass);
    (void)runs;
    rt->recording = true;
    rt->grouped = GL(rt, name, PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, pass, -1, name));
    /* llvmpipe defers draws and timestamps but runs dispatches at once. Without glFinish a dispatch
     * would end before its first timestamp. */
    return rt->grouped &&
           (!rt->queries || (GL(rt, name, QueryCounter(rt->queries[query], GL_TIMESTAMP)) &&
                             (!rt->core.device.software || GL(rt, name, Finish()))));
}

static bool end(struct dt_core *core, uint32_t pass)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const char *name = dt_pass_name(&rt->core, pass);
    uint32_t query = 2 * dt_run(&rt->core, rt->core.slot, pass) + 1;
    if (rt->queries && !GL(rt, name, QueryCounter(rt->queries[query], GL_TIMESTAMP)))
        return false;
    rt->grouped = false;
    rt->gl.Disable(GL_SCISSOR_TEST); /* of a draw; blits obey it */
    return GL(rt, name, PopDebugGroup());
}

/* OpenGL needs barriers only after shader stores; it orders all other accesses itself. */
static GLbitfield bits_of(const struct dt_gl_runtime *rt, const struct dt_barrier *barrier)
{
    const struct gl_resource *resource = dt_resource(&rt->core, barrier->resource);
    bool image = resource->image.handle;
    const struct {
        unsigned access;
        GLbitfield bits;
    } table[] = {
        {DT_READ_STORAGE | DT_WRITE_STORAGE,
         image ? GL_SHADER_IMAGE_ACCESS_BARRIER_BIT : GL_SHADER_STORAGE_BARRIER_BIT},
        {DT_READ_TEXTURE, GL_TEXTURE_FETCH_BARRIER_BIT},
        {DT_READ_UNIFORM, GL_UNIFORM_BARRIER_BIT},
        {DT_READ_COLOR | DT_WRITE_COLOR | DT_READ_DEPTH | DT_WRITE_DEPTH,
         GL_FRAMEBUFFER_BARRIER_BIT},
        {DT_READ_INDIRECT, GL_COMMAND_BARRIER_BIT},
        {DT_READ_INDEX, GL_ELEMENT_ARRAY_BARRIER_BIT},
        {DT_WRITE_CLEAR, image ? GL_TEXTURE_UPDATE_BARRIER_BIT : GL_BUFFER_UPDATE_BARRIER_BIT},
    };
    GLbitfield bits = 0;
    for (size_t i = 0; resource->stored && i < DT_ARRAY_COUNT(table); i++)
        bits |= barrier->to & table[i].access ? table[i].bits : 0;
    return bits;
}

static bool barriers(struct dt_core *core, uint32_t pass, const struct dt_barrier *list,
                     uint32_t count)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    GLbitfield bits = 0;
    for (uint32_t i = 0; i < count; i++)
        bits |= bits_of(rt, &list[i]);
    return !bits || GL(rt, dt_pass_name(&rt->core, pass), MemoryBarrier(bits));
}

/* ---- Bindings -------------------------------------------------------------------------------- */

static bool bind_buffer(struct dt_gl_runtime *rt, const struct dt_binding *binding)
{
    const struct gl_buffer *buffer = gl_buffer_of(rt, binding->resource);
    if (binding->kind == DT_BIND_TEXELS)
        return GL(rt, buffer->name, BindTextureUnit(binding->binding, buffer->texels));
    bool uniform = binding->kind == DT_BIND_UNIFORM;
    GLsizeiptr size = uniform && buffer->block > buffer->size ? buffer->block : buffer->size;
    return GL(rt, buffer->name,
              BindBufferRange(uniform ? GL_UNIFORM_BUFFER : GL_SHADER_STORAGE_BUFFER,
                              binding->binding, buffer->handle, buffer->offset, size));
}

static GLuint sampler_of(const struct dt_gl_runtime *rt, const struct dt_binding *binding)
{
    if (binding->resource == DT_SCENE_TEXTURES)
        return rt->builtin.texture_sampler;
    return binding->sampler < 0
               ? rt->nearest
               : *(const GLuint *)dt_sampler(&rt->core, (uint32_t)binding->sampler);
}

static bool bind_image(struct dt_gl_runtime *rt, const struct dt_binding *binding, GLuint view)
{
    const struct gl_image *image = gl_image_of(rt, binding->resource);
    bool reads = binding->access & DT_READ_STORAGE, writes = binding->access & DT_WRITE_STORAGE;
    GLenum access = !writes ? GL_READ_ONLY : reads ? GL_READ_WRITE : GL_WRITE_ONLY;
    if (binding->kind == DT_BIND_TEXTURE)
        return GL(rt, image->name,
                  BindTextureUnit(binding->binding, view ? view : image->handle)) &&
               GL(rt, image->name, BindSampler(binding->binding, sampler_of(rt, binding)));
    return GL(rt, image->name,
              BindImageTexture(binding->binding, image->handle, binding->mip,
                               image->layered && !binding->one_layer, binding->layer, access,
                               gl_format(image->format)->internal));
}

static bool bind(struct dt_core *core, uint32_t pass)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const struct dt_program *info = info_of(rt, pass);
    const struct gl_program *program = dt_program(&rt->core, pass);
    for (uint32_t i = 0; i < info->binding_count; i++) {
        const struct dt_binding *binding = &info->bindings[i];
        gl_state_keep_binding(rt, binding->kind, binding->binding);
        bool buffer = binding->kind == DT_BIND_UNIFORM || binding->kind == DT_BIND_STORAGE ||
                      binding->kind == DT_BIND_TEXELS;
        if (!(buffer ? bind_buffer(rt, binding) : bind_image(rt, binding, program->views[i])))
            return false;
    }
    return true;
}

/* ---- Compute --------------------------------------------------------------------------------- */

static bool dispatch(struct dt_core *core, uint32_t pass, uint32_t x, uint32_t y, uint32_t z)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const char *name = dt_pass_name(&rt->core, pass);
    return GL(rt, name, UseProgram(program_of(rt, pass)->handle)) &&
           GL(rt, name, DispatchCompute(x, y, z));
}

static bool dispatch_indirect(struct dt_core *core, uint32_t pass, uint32_t arguments)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const struct gl_buffer *buffer = gl_buffer_of(rt, arguments);
    const char *name = dt_pass_name(&rt->core, pass);
    return GL(rt, name, UseProgram(program_of(rt, pass)->handle)) &&
           GL(rt, buffer->name, BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, buffer->handle)) &&
           GL(rt, name, DispatchComputeIndirect(0));
}

/* ---- Clears ---------------------------------------------------------------------------------- */

static bool clear_color(struct dt_gl_runtime *rt, GLuint framebuffer, GLint index,
                        const struct dt_target *target)
{
    const struct gl_image *image = gl_image_of(rt, target->resource);
    const float *c = rt->core.panel->storage[target->resource].clear;
    switch (dt_front_scalar(image->format)) {
    case DT_TYPE_UINT: {
        const GLuint value[4] = {(GLuint)c[0], (GLuint)c[1], (GLuint)c[2], (GLuint)c[3]};
        return GL(rt, image->name, ClearNamedFramebufferuiv(framebuffer, GL_COLOR, index, value));
    }
    case DT_TYPE_INT: {
        const GLint value[4] = {(GLint)c[0], (GLint)c[1], (GLint)c[2], (GLint)c[3]};
        return GL(rt, image->name, ClearNamedFramebufferiv(framebuffer, GL_COLOR, index, value));
    }
    default:
        return GL(rt, image->name, ClearNamedFramebufferfv(framebuffer, GL_COLOR, index, c));
    }
}

/* A layered draw clears all layers of its images. */
static bool clear_targets(struct dt_core *core, uint32_t pass, uint32_t layers)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const struct dt_program *info = info_of(rt, pass);
    GLuint framebuffer = program_of(rt, pass)->framebuffer;
    (void)layers;
    rt->gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE); /* clears obey masks and scissor */
    rt->gl.Disable(GL_SCISSOR_TEST);
    for (uint32_t i = 0; i < info->color_count; i++)
        if (!info->colors[i].load && !clear_color(rt, framebuffer, (GLint)i, &info->colors[i]))
            return false;
    if (!info->depth || info->depth->load)
        return true;
    rt->gl.DepthMask(GL_TRUE);
    return GL(rt, dt_pass_name(&rt->core, pass),
              ClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0,
                                      rt->core.panel->storage[info->depth->resource].clear));
}

static bool clear_image(struct dt_core *core, uint32_t resource, uint32_t mip)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    return gl_image_clear(rt, gl_image_of(rt, resource), mip,
                          rt->core.panel->storage[resource].clear);
}

static bool clear_buffer(struct dt_core *core, uint32_t resource)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    return gl_buffer_fill(rt, gl_buffer_of(rt, resource), 0);
}

/* ---- Draws ----------------------------------------------------------------------------------- */

static void enable(struct dt_gl_runtime *rt, GLenum what, bool on)
{
    if (on)
        rt->gl.Enable(what);
    else
        rt->gl.Disable(what);
}

static void set_blend(struct dt_gl_runtime *rt, GLuint index, const struct dt_target *target)
{
    static const GLenum factors[] = {
        [DT_FACTOR_ONE] = GL_ONE,
        [DT_FACTOR_ZERO] = GL_ZERO,
        [DT_FACTOR_SRC_COLOR] = GL_SRC_COLOR,
        [DT_FACTOR_ONE_MINUS_SRC_COLOR] = GL_ONE_MINUS_SRC_COLOR,
        [DT_FACTOR_DST_COLOR] = GL_DST_COLOR,
        [DT_FACTOR_ONE_MINUS_DST_COLOR] = GL_ONE_MINUS_DST_COLOR,
        [DT_FACTOR_SRC_ALPHA] = GL_SRC_ALPHA,
        [DT_FACTOR_ONE_MINUS_SRC_ALPHA] = GL_ONE_MINUS_SRC_ALPHA,
        [DT_FACTOR_DST_ALPHA] = GL_DST_ALPHA,
        [DT_FACTOR_ONE_MINUS_DST_ALPHA] = GL_ONE_MINUS_DST_ALPHA,
    };
    static const GLenum ops[] = {[DT_BLEND_ADD] = GL_FUNC_ADD,
                                 [DT_BLEND_SUBTRACT] = GL_FUNC_SUBTRACT,
                                 [DT_BLEND_REVERSE_SUBTRACT] = GL_FUNC_REVERSE_SUBTRACT,
                                 [DT_BLEND_MIN] = GL_MIN,
                                 [DT_BLEND_MAX] = GL_MAX};
    const struct dt_blend *blend = target->blend;
    rt->gl.ColorMaski(index, !(target->keep & 1), !(target->keep & 2), !(target->keep & 4),
                      !(target->keep & 8));
    if (!blend) {
        rt->gl.Disablei(GL_BLEND, index);
        return;
    }
    rt->gl.Enablei(GL_BLEND, index);
    rt->gl.BlendFuncSeparatei(index, factors[blend->src], factors[blend->dst],
                              factors[blend->alpha_src], factors[blend->alpha_dst]);
    rt->gl.BlendEquationSeparatei(index, ops[blend->op], ops[blend->alpha_op]);
}

static void set_raster_state(struct dt_gl_runtime *rt, const struct dt_program *info)
{
    static const GLenum compares[] = {[DT_COMPARE_LESS] = GL_LESS,
                                      [DT_COMPARE_LESS_EQUAL] = GL_LEQUAL,
                                      [DT_COMPARE_GREATER] = GL_GREATER,
                                      [DT_COMPARE_ALWAYS] = GL_ALWAYS};
    enable(rt, GL_DEPTH_TEST,
           info->depth_test || info->depth_write); /* depth writes need the test */
    rt->gl.DepthMask(info->depth_write);
    rt->gl.DepthFunc(info->depth_test ? compares[info->compare] : GL_ALWAYS);
    enable(rt, GL_CULL_FACE, info->cull != DT_CULL_NONE);
    rt->gl.CullFace(info->cull == DT_CULL_FRONT ? GL_FRONT : GL_BACK);
    for (uint32_t i = 0; i < info->color_count; i++)
        set_blend(rt, i, &info->colors[i]);
    enable(rt, GL_POLYGON_OFFSET_FILL, info->bias_constant != 0 || info->bias_slope != 0);
    rt->gl.PolygonOffset(info->bias_slope, info->bias_constant);
    for (uint32_t i = 0; i < rt->core.limits.most[DT_LIMIT_CLIP_DISTANCES]; i++)
        enable(rt, GL_CLIP_DISTANCE0 + i, i < info->clip_distances);
}

static void set_viewport(struct dt_gl_runtime *rt, const struct dt_program *info)
{
    const struct dt_target *target = info->color_count ? &info->colors[0] : info->depth;
    const struct gl_image *image = gl_image_of(rt, target->resource);
    struct dt_rect viewport, scissor;
    dt_front_area(&rt->core, (uint32_t)gl_mip_size(image->width, target->mip),
                  (uint32_t)gl_mip_size(image->height, target->mip), &viewport, &scissor);
    rt->gl.Viewport(viewport.x, viewport.y, (GLsizei)viewport.width, (GLsizei)viewport.height);
    rt->gl.Enable(GL_SCISSOR_TEST);
    rt->gl.Scissor(scissor.x, scissor.y, (GLsizei)scissor.width, (GLsizei)scissor.height);
}

static const GLenum topologies[] = {
    [DT_TRIANGLES] = GL_TRIANGLES, [DT_LINES] = GL_LINES, [DT_POINTS] = GL_POINTS};

/* `input`: a vertex array object. */
static bool begin_draw(struct dt_gl_runtime *rt, uint32_t pass, const struct dt_draw *draw,
                       GLuint input)
{
    const struct gl_program *program = program_of(rt, pass);
    const char *name = dt_pass_name(&rt->core, pass);
    if (!GL(rt, name, BindFramebuffer(GL_FRAMEBUFFER, program->framebuffer)) ||
        !clear_targets(&rt->core, pass, draw->layers))
        return false;
    set_viewport(rt, info_of(rt, pass));
    set_raster_state(rt, info_of(rt, pass));
    if (!GL(rt, name, UseProgram(program->handle)) || !GL(rt, name, BindVertexArray(input)))
        return false;
    if (draw->indices == DT_NO_BUFFER)
        return true;
    const struct gl_buffer *indices = gl_buffer_of(rt, draw->indices);
    return GL(rt, indices->name, VertexArrayElementBuffer(input, indices->handle));
}

static bool draw_indirect(struct dt_gl_runtime *rt, const char *name, GLenum topology,
                          const struct dt_draw *draw)
{
    const struct gl_buffer *buffer = gl_buffer_of(rt, draw->arguments);
    if (!GL(rt, buffer->name, BindBuffer(GL_DRAW_INDIRECT_BUFFER, buffer->handle)))
        return false;
    if (draw->indices != DT_NO_BUFFER)
        return GL(rt, name,
                  MultiDrawElementsIndirect(topology, GL_UNSIGNED_INT, NULL,
                                            (GLsizei)(buffer->size / DT_DRAW_BYTES),
                                            DT_DRAW_BYTES));
    return GL(rt, name,
              MultiDrawArraysIndirect(topology, NULL,
                                      (GLsizei)(buffer->size / DT_VERTEX_DRAW_BYTES),
                                      DT_VERTEX_DRAW_BYTES));
}

/* Programs without vertex input fetch vertices from storage buffers; their draws may be indexed, too. */
static bool draw_pass(struct dt_core *core, uint32_t pass, const struct dt_draw *draw)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const char *name = dt_pass_name(&rt->core, pass);
    GLenum topology = topologies[info_of(rt, pass)->topology];
    GLsizei count = (GLsizei)draw->count, instances = (GLsizei)draw->instances;
    bool scene = core->pipeline->passes[pass].kind == DT_PASS_DRAW_SCENE;
    if (!begin_draw(rt, pass, draw, scene ? rt->scene_input : rt->no_input))
        return false;
    if (draw->arguments != DT_NO_BUFFER)
        return draw_indirect(rt, name, topology, draw);
    if (draw->indices == DT_NO_BUFFER)
        return GL(rt, name, DrawArraysInstanced(topology, 0, count, instances));
    return GL(rt, name, DrawElementsInstanced(topology, count, GL_UNSIGNED_INT, NULL, instances));
}

const struct dt_commands gl_commands = {
    .begin = begin,
    .barriers = barriers,
    .bind = bind,
    .dispatch = dispatch,
    .dispatch_indirect = dispatch_indirect,
    .draw = draw_pass,
    .clear_targets = clear_targets,
    .clear_buffer = clear_buffer,
    .clear_image = clear_image,
    .end = end,
};

/* ---- Frames ---------------------------------------------------------------------------------- */

static bool write_blocks(struct dt_gl_runtime *rt, const struct dt_frame *frame, const void *live)
{
    return gl_buffer_write(rt, gl_buffer_of(rt, DT_FRAME), frame, sizeof *frame) &&
           gl_buffer_write(rt, gl_buffer_of(rt, DT_LIVE), live, rt->core.pipeline->live_size);
}

/* Pass barriers order only this frame. So a part of it begins with a full barrier, against earlier
 * frames and the host, and a host's part also ends with one. */
bool gl_render(struct dt_core *core, const struct dt_frame *frame, const void *live)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    bool good = (core->first_pass || write_blocks(rt, frame, live)) &&
                GL(rt, "frame", MemoryBarrier(GL_ALL_BARRIER_BITS)) && dt_front_record(core, live);
    if (rt->grouped) /* a pass failed between begin and end */
        rt->gl.PopDebugGroup();
    rt->recording = rt->grouped = false;
    return good && (core->hosted ? GL(rt, "frame", MemoryBarrier(GL_ALL_BARRIER_BITS))
                                 : gl_finish(rt, "frame"));
}

bool gl_pause(struct dt_core *core)
{
    return gl_finish((struct dt_gl_runtime *)core, dt_pass_name(core, core->pass));
}

/* A host never waits here; the app waits. */
bool gl_timing(struct dt_core *core, uint32_t run, const char *name, double *ms)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const GLuint *queries = &rt->queries[2 * run];
    GLint finished = GL_TRUE;
    GLuint64 begun = 0, ended = 0;
    if (core->hosted &&
        !GL(rt, name, GetQueryObjectiv(queries[1], GL_QUERY_RESULT_AVAILABLE, &finished)))
        return false;
    if (!finished)
        return true;
    if (!GL(rt, name, GetQueryObjectui64v(queries[0], GL_QUERY_RESULT, &begun)) ||
        !GL(rt, name, GetQueryObjectui64v(queries[1], GL_QUERY_RESULT, &ended)))
        return false;
    *ms = (double)(ended - begun) * 1e-6;
    return true;
}
