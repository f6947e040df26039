/* Creates the OpenGL objects of a panel: samplers, programs, resources, framebuffers. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- Built-in objects ------------------------------------------------------------------------ */

bool gl_builtin_create(struct dt_gl_runtime *rt)
{
    static const struct dt_sampler nearest = {.name = "nearest", .anisotropy = 1.0f};
    static const struct dt_sampler trilinear = {.name = "scene textures",
                                                .linear = true,
                                                .linear_mip = true,
                                                .wrap = DT_WRAP_REPEAT,
                                                .anisotropy = 1.0f};
    struct gl_buffer *frame = gl_buffer_of(rt, DT_FRAME);
    *frame = (struct gl_buffer){.name = "frame", .size = sizeof(struct dt_frame)};
    return gl_buffer_create(rt, frame, NULL) &&
           gl_sampler_create(&rt->core, &rt->nearest, &nearest) &&
           gl_sampler_create(&rt->core, &rt->builtin.texture_sampler, &trilinear) &&
           GL(rt, "no vertex input", CreateVertexArrays(1, &rt->no_input));
}

void gl_builtin_destroy(struct dt_gl_runtime *rt)
{
    gl_buffer_destroy(rt, gl_buffer_of(rt, DT_FRAME));
    gl_sampler_destroy(&rt->core, &rt->builtin.texture_sampler);
    gl_sampler_destroy(&rt->core, &rt->nearest);
    if (rt->no_input)
        rt->gl.DeleteVertexArrays(1, &rt->no_input);
    rt->no_input = 0;
}

static struct gl_resource *resource_of(const struct dt_gl_runtime *rt, uint32_t resource)
{
    return dt_resource(&rt->core, resource);
}

struct gl_buffer *gl_buffer_of(struct dt_gl_runtime *rt, uint32_t resource)
{
    return resource < DT_FRAME ? &resource_of(rt, resource)->buffer
                               : &rt->builtin.buffers[resource - DT_FRAME];
}

const struct gl_image *gl_image_of(const struct dt_gl_runtime *rt, uint32_t resource)
{
    return resource == DT_SCENE_TEXTURES ? &rt->builtin.textures
                                         : &resource_of(rt, resource)->image;
}

/* ---- The panel ------------------------------------------------------------------------------- */

/* Most needs are part of OpenGL 4.6; subgroups are not. */
static bool has_needs(struct dt_gl_runtime *rt, const struct dt_panel *panel)
{
    static const char *const extension[] = {"GL_KHR_shader_subgroup"};
    char missing[64];
    for (uint32_t i = 0; i < panel->need_count; i++)
        if (strncmp(panel->needs[i].feature, "VK_SUBGROUP_", 12) == 0 &&
            !gl_has_all(rt, extension, 1, missing, sizeof missing))
            return dt_error(&rt->core,
                            "pass %s: needs %s for its subgroup operations, which %s does not "
                            "have; use Vulkan",
                            panel->pipeline->passes[panel->needs[i].pass].name, missing,
                            rt->core.device.name);
    return true;
}

/* OpenGL limits the binding numbers, not only their count. */
static bool check_binding(const struct dt_core *core, const struct dt_panel *panel, uint32_t pass,
                          const struct dt_binding *binding)
{
    uint32_t most = core->limits.numbers[binding->kind];
    return binding->binding < most ||
           dt_error(core, "pass %s: binding %u, but %s has %u of this kind; bind fewer",
                    panel->pipeline->passes[pass].name, binding->binding, core->device.name, most);
}

static bool panel_suits(struct dt_core *core, const struct dt_panel *panel)
{
    for (uint32_t pass = 0; pass < panel->pipeline->pass_count; pass++)
        for (uint32_t i = 0; i < panel->programs[pass].binding_count; i++)
            if (!check_binding(core, panel, pass, &panel->programs[pass].bindings[i]))
                return false;
    return has_needs((struct dt_gl_runtime *)core, panel);
}

static bool begin_panel(struct dt_core *core)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const struct dt_pipeline *pipeline = core->pipeline;
    uint32_t queries = core->timing ? 2 * dt_run(core, core->frames, 0) : 0;
    struct gl_buffer *live = gl_buffer_of(rt, DT_LIVE);
    rt->queries = queries ? calloc(queries, sizeof *rt->queries) : NULL;
    if (queries && !rt->queries)
        return dt_error(core, "pipeline %s: out of memory; free some", pipeline->name);
    *live = (struct gl_buffer){.name = "live parameters", .size = pipeline->block_size};
    return gl_buffer_create(rt, live, pipeline->live_defaults) &&
           (!queries ||
            GL(rt, "timestamps", CreateQueries(GL_TIMESTAMP, (GLsizei)queries, rt->queries)));
}

static void end_panel(struct dt_core *core)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    if (rt->queries)
        rt->gl.DeleteQueries((GLsizei)(2 * dt_run(core, core->frames, 0)), rt->queries);
    gl_buffer_destroy(rt, gl_buffer_of(rt, DT_LIVE));
    free(rt->queries);
    rt->queries = NULL;
}

static bool rest(struct dt_core *core, const char *verb)
{
    return core->hosted || gl_finish((struct dt_gl_runtime *)core, verb);
}

/* ---- Programs -------------------------------------------------------------------------------- */

static bool create_program(struct dt_core *core, void *made, uint32_t pass)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    struct gl_program *program = made;
    return gl_program_create(rt, &program->handle, dt_pass_name(core, pass),
                             &core->shaders.stages[pass]);
}

static void destroy_program(struct dt_core *core, void *made)
{
    struct gl_program *program = made;
    gl_program_destroy((struct dt_gl_runtime *)core, &program->handle);
}

/* ---- Framebuffers of draws, and views of mips and layers -------------------------------------- */

static bool attach(struct dt_gl_runtime *rt, GLuint framebuffer, GLenum point,
                   const struct dt_target *target, bool layered)
{
    const struct gl_image *image = gl_image_of(rt, target->resource);
    GLint mip = target->mip;
    if (image->layered && !layered)
        return GL(
            rt, image->name,
            NamedFramebufferTextureLayer(framebuffer, point, image->handle, mip, target->layer));
    return GL(rt, image->name, NamedFramebufferTexture(framebuffer, point, image->handle, mip));
}

/* Codes of sRGB need a view, too. A pass may sample one mip or layer and draw into another only through a texture that has no
 * texel of the target (OpenGL 4.6, 9.3.1: rendering feedback loops). */
static bool create_views(struct dt_gl_runtime *rt, struct gl_program *program,
                         const struct dt_program *info)
{
    for (uint32_t i = 0; i < info->binding_count; i++) {
        const struct dt_binding *binding = &info->bindings[i];
        if (binding->kind == DT_BIND_TEXTURE && (binding->codes || binding->mip != DT_ALL_MIPS) &&
            !gl_image_view(rt, gl_image_of(rt, binding->resource), binding, &program->views[i]))
            return false;
    }
    return true;
}

static bool create_framebuffer(struct dt_gl_runtime *rt, GLuint *framebuffer, uint32_t pass)
{
    const struct dt_program *info = &rt->core.panel->programs[pass];
    const char *name = dt_pass_name(&rt->core, pass);
    GLenum buffers[DT_MAX_COLOR_TARGETS] = {GL_NONE};
    if (!GL(rt, name, CreateFramebuffers(1, framebuffer)))
        return false;
    for (uint32_t i = 0; i < info->color_count; i++) {
        buffers[i] = GL_COLOR_ATTACHMENT0 + i;
        if (!attach(rt, *framebuffer, buffers[i], &info->colors[i], info->layered))
            return false;
    }
    if (info->depth && !attach(rt, *framebuffer, GL_DEPTH_ATTACHMENT, info->depth, info->layered))
        return false;
    GLsizei count = info->color_count ? (GLsizei)info->color_count : 1;
    if (!GL(rt, name, NamedFramebufferDrawBuffers(*framebuffer, count, buffers)))
        return false;
    GLenum status = rt->gl.CheckNamedFramebufferStatus(*framebuffer, GL_DRAW_FRAMEBUFFER);
    return status == GL_FRAMEBUFFER_COMPLETE ||
           dt_error(&rt->core, "pass %s: %s", name,
                    gl_text(status, "the framebuffer is incomplete"));
}

static bool create_texels(struct dt_gl_runtime *rt, const struct dt_program *info)
{
    for (uint32_t i = 0; i < info->binding_count; i++) {
        uint16_t resource = info->bindings[i].resource;
        if (info->bindings[i].kind == DT_BIND_TEXELS &&
            !gl_buffer_texels(rt, gl_buffer_of(rt, resource), resource))
            return false;
    }
    return true;
}

static bool connect_program(struct dt_core *core, void *made, uint32_t pass)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    struct gl_program *program = made;
    return create_texels(rt, &core->panel->programs[pass]) &&
           create_views(rt, program, &core->panel->programs[pass]) &&
           (core->pipeline->passes[pass].kind == DT_PASS_DISPATCH ||
            create_framebuffer(rt, &program->framebuffer, pass));
}

static void disconnect_program(struct dt_core *core, void *made)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    struct gl_program *program = made;
    if (program->framebuffer)
        rt->gl.DeleteFramebuffers(1, &program->framebuffer);
    program->framebuffer = 0;
    rt->gl.DeleteTextures(DT_MAX_BINDINGS, program->views); /* ignores zeros */
    memset(program->views, 0, sizeof program->views);
}

/* ---- Resources ------------------------------------------------------------------------------- */

/* An imported image is not shared: only passes of its own resource may write it. */
static bool can_share(const struct gl_image *image, const struct gl_image *owner)
{
    return !owner->imported && image->format == owner->format && image->width == owner->width &&
           image->height == owner->height && image->layers == owner->layers &&
           image->mips == owner->mips && image->shape == owner->shape &&
           image->layered == owner->layered;
}

static bool create_image(struct dt_gl_runtime *rt, uint32_t index, const uint32_t extent[3])
{
    const struct dt_resource *info = &rt->core.pipeline->resources[index];
    struct gl_image *image = &resource_of(rt, index)->image;
    int share = rt->core.panel->storage[index].share;
    *image = (struct gl_image){.name = info->name,
                               .format = info->format,
                               .width = extent[0],
                               .height = extent[1],
                               .layers = extent[2],
                               .mips = info->mips,
                               .shape = info->shape,
                               .layered = info->layered};
    GLuint texture = ((const struct gl_import *)dt_choice(&rt->core, index))->texture;
    if (texture)
        return gl_image_import(rt, image, texture);
    const struct gl_image *owner = share < 0 ? NULL : gl_image_of(rt, (uint32_t)share);
    image->borrowed = owner && can_share(image, owner);
    if (!image->borrowed)
        return gl_image_create(rt, image);
    image->handle = owner->handle;
    return true;
}

/* Of a host's range only the resource's bytes are bound, and draws are counted by them. */
static bool import_buffer(struct dt_gl_runtime *rt, uint32_t index, const struct dt_gl_range *range,
                          GLsizeiptr size)
{
    const struct dt_storage *storage = &rt->core.panel->storage[index];
    const char *name = rt->core.pipeline->resources[index].name;
    struct gl_buffer *buffer = &resource_of(rt, index)->buffer;
    if (storage->usage & (DT_READ_INDEX | DT_READ_INDIRECT) && range->offset)
        return dt_error(&rt->core,
                        "%s: offset %llu, but indices and arguments stand at the start of a "
                        "buffer; use a separate one",
                        name, (unsigned long long)range->offset);
    if (!gl_buffer_import(rt, buffer, name, range,
                          storage->block > size ? storage->block : (uint64_t)size))
        return false;
    buffer->size = size;
    buffer->block = storage->block;
    return true;
}

static bool create_resource(struct dt_core *core, uint32_t index, const uint32_t extent[3])
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const struct dt_resource *info = &core->pipeline->resources[index];
    const struct gl_import *import = dt_choice(core, index);
    struct gl_buffer *buffer = &resource_of(rt, index)->buffer;
    if (info->kind == DT_IMAGE)
        return create_image(rt, index, extent);
    if (import->buffer.buffer)
        return import_buffer(rt, index, &import->buffer, (GLsizeiptr)extent[0] * info->stride);
    *buffer = (struct gl_buffer){.name = info->name,
                                 .size = (GLsizeiptr)extent[0] * info->stride,
                                 .block = core->panel->storage[index].block};
    return gl_buffer_create(rt, buffer, NULL);
}

/* Resources have memory already. Marks those that shaders store to, also through a shared
 * texture. */
static bool place_resources(struct dt_core *core)
{
    const struct dt_gl_runtime *rt = gl_runtime_of(core);
    uint32_t count = core->pipeline->resource_count;
    for (uint32_t i = 0; i < count; i++) {
        struct gl_resource *resource = resource_of(rt, i);
        for (uint32_t j = 0; j < count; j++)
            if (core->panel->storage[j].usage & DT_WRITE_STORAGE)
                resource->stored |=
                    i == j || (resource->image.handle &&
                               resource->image.handle == gl_image_of(rt, j)->handle);
    }
    return true;
}

static bool fill_resource(struct dt_core *core, uint32_t index, int byte)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const struct gl_resource *resource = resource_of(rt, index);
    return resource->image.handle ? gl_image_fill(rt, &resource->image, byte)
                                  : gl_buffer_fill(rt, &resource->buffer, byte);
}

static void destroy_resource(struct dt_core *core, void *resource)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    struct gl_resource *made = resource;
    gl_buffer_destroy(rt, &made->buffer);
    gl_image_destroy(rt, &made->image);
    *made = (struct gl_resource){0};
}

static bool detach_resource(struct dt_core *core, uint32_t index)
{
    for (uint32_t i = 0; i < core->pipeline->resource_count; i++)
        if (core->panel->storage[i].share == (int32_t)index)
            return false;
    return !gl_image_of((struct dt_gl_runtime *)core, index)->borrowed;
}

static bool adopt_resource(struct dt_core *core, uint32_t index, void *resource)
{
    struct gl_resource *made = resource;
    made->stored = false;
    made->buffer.name = made->image.name = core->pipeline->resources[index].name;
    return core->panel->storage[index].share < 0;
}

const struct dt_backend gl_backend = {
    .name = "gl",
    .api = "OpenGL",
    .resource_size = sizeof(struct gl_resource),
    .program_size = sizeof(struct gl_program),
    .sampler_size = sizeof(GLuint),
    .choice_size = sizeof(struct gl_import),
    .enter = gl_state_enter,
    .leave = gl_state_leave,
    .rest = rest,
    .suits = panel_suits,
    .upload_scene = gl_scene_upload,
    .begin_panel = begin_panel,
    .end_panel = end_panel,
    .create_sampler = gl_sampler_create,
    .destroy_sampler = gl_sampler_destroy,
    .create_program = create_program,
    .destroy_program = destroy_program,
    .create_resource = create_resource,
    .place_resources = place_resources,
    .fill_resource = fill_resource,
    .connect_program = connect_program,
    .disconnect_program = disconnect_program,
    .destroy_resource = destroy_resource,
    .detach_resource = detach_resource,
    .adopt_resource = adopt_resource,
    .render = gl_render,
    .write = gl_write,
    .commands = &gl_commands,
    .pause = gl_pause,
    .timing = gl_timing,
};
