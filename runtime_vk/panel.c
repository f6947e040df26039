/* Creates the Vulkan objects of a panel: samplers, programs with their descriptor sets, resources
 * and the memory that they share; also the built-in objects. */
#include "internal.h"

#include <stdlib.h>

/* ---- Built-in objects ------------------------------------------------------------------------ */

/* Mapped memory; for a host device memory, which commands write. */
static bool create_uniform(struct dt_vk_runtime *rt, struct vk_buffer *buffer, const char *name,
                           VkDeviceSize size)
{
    const struct vk_buffer_info info = {
        .name = name, .size = size, .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT};
    return vk_buffer_create_own(rt, buffer, &info, !rt->core.hosted);
}

bool vk_builtin_create(struct dt_vk_runtime *rt)
{
    static const struct dt_sampler texel = {.name = "texel", .anisotropy = 1};
    static const struct dt_sampler textures = {.name = "scene_textures",
                                               .linear = true,
                                               .linear_mip = true,
                                               .wrap = DT_WRAP_REPEAT,
                                               .anisotropy = 1};
    struct vk_builtin *builtin = &rt->builtin;
    return create_uniform(rt, vk_buffer_at(rt, DT_FRAME), "frame", sizeof(struct dt_frame)) &&
           vk_sampler_create(&rt->core, &builtin->texel_sampler, &texel) &&
           vk_sampler_create(&rt->core, &builtin->texture_sampler, &textures);
}

void vk_builtin_destroy(struct dt_vk_runtime *rt)
{
    vk_buffer_destroy(rt, vk_buffer_at(rt, DT_FRAME));
    vk_sampler_destroy(&rt->core, &rt->builtin.texel_sampler);
    vk_sampler_destroy(&rt->core, &rt->builtin.texture_sampler);
}

void vk_scene_destroy(struct dt_vk_runtime *rt)
{
    struct vk_image *textures = &rt->builtin.textures;
    if (textures->imported) /* its views are the host's */
        *textures = (struct vk_image){0};
    vk_image_destroy(rt, textures);
    for (uint32_t i = DT_SCENE_VERTICES; i < DT_SCENE_TEXTURES; i++)
        vk_buffer_destroy(rt, vk_buffer_at(rt, i));
    rt->core.has_scene = rt->core.has_objects = false;
}

/* ---- The panel ------------------------------------------------------------------------------- */

/* Makes sure that no frame is in flight: a host guarantees this, the app's runtime waits. */
static bool rest(struct dt_core *core, const char *verb)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    return core->hosted || VK(rt, rt->vk.DeviceWaitIdle(rt->device), verb);
}

static bool begin_panel(struct dt_core *core)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct dt_pipeline *pipeline = core->pipeline;
    VkQueryPoolCreateInfo queries = {
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
        .queryType = VK_QUERY_TYPE_TIMESTAMP,
        .queryCount = 2 * dt_run(core, core->frames, 0),
    };
    rt->slots = calloc(core->panel->slot_count + 1, sizeof *rt->slots);
    if (!rt->slots)
        return dt_error(core, "pipeline %s: out of memory; free some", pipeline->name);
    return create_uniform(rt, vk_buffer_at(rt, DT_LIVE), "live", pipeline->block_size) &&
           (!core->timing ||
            VK(rt, rt->vk.CreateQueryPool(rt->device, &queries, rt->callbacks, &rt->queries),
               pipeline->name));
}

static void end_panel(struct dt_core *core)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    vk_buffer_destroy(rt, vk_buffer_at(rt, DT_LIVE));
    rt->vk.DestroyQueryPool(rt->device, rt->queries, rt->callbacks);
    free(rt->slots);
    rt->queries = VK_NULL_HANDLE;
    rt->slots = NULL;
}

/* ---- Samplers and programs ------------------------------------------------------------------- */

static VkFormat format_of(const struct dt_panel *panel, const struct dt_target *target)
{
    return vk_format(panel->pipeline->resources[target->resource].format);
}

/* Images are checked when they are made, but not for blending, which belongs to the program. */
static bool blends(const struct dt_vk_runtime *rt, const struct dt_panel *panel, uint32_t pass,
                   const struct dt_target *target)
{
    VkFormatProperties can;
    if (!target->blend)
        return true;
    rt->vk.GetPhysicalDeviceFormatProperties(rt->physical, format_of(panel, target), &can);
    return can.optimalTilingFeatures & VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT ||
           dt_error(&rt->core,
                    "pass %s: %s does not blend images of the format of %s; use another format, or "
                    "another device",
                    panel->pipeline->passes[pass].name, rt->core.device.name,
                    panel->pipeline->resources[target->resource].name);
}

static bool panel_suits(struct dt_core *core, const struct dt_panel *panel)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    if (!vk_device_suits_panel(rt, panel))
        return false;
    for (uint32_t pass = 0; pass < panel->pipeline->pass_count; pass++)
        for (uint32_t i = 0; i < panel->programs[pass].color_count; i++)
            if (!blends(rt, panel, pass, &panel->programs[pass].colors[i]))
                return false;
    return true;
}

struct vk_program_info vk_program_info_of(const struct dt_core *core, uint32_t pass)
{
    const struct dt_program *state = &core->panel->programs[pass];
    struct vk_program_info info = {
        .name = dt_pass_name(core, pass),
        .stages = &core->shaders.stages[pass],
        .state = state,
        .depth_format = state->depth ? format_of(core->panel, state->depth) : VK_FORMAT_UNDEFINED,
    };
    for (uint32_t i = 0; i < state->color_count; i++)
        info.color_formats[i] = format_of(core->panel, &state->colors[i]);
    return info;
}

static bool create_program(struct dt_core *core, void *program, uint32_t pass)
{
    struct vk_program_info info = vk_program_info_of(core, pass);
    return vk_program_begin(vk_runtime_of(core), program, &info);
}

static void adopt_program(struct dt_core *core, void *program, uint32_t pass)
{
    const struct vk_program *adopted = program;
    vk_set_name(vk_runtime_of(core), VK_OBJECT_TYPE_PIPELINE, (uint64_t)adopted->handle,
                dt_pass_name(core, pass));
}

struct compiling {
    const struct dt_core *core;
    struct vk_outcome *outcomes; /* per pass */
};

/* Runs on any thread: changes nothing but the pass's own pipeline and outcome. */
static void compile_pass(void *data, uint32_t pass)
{
    const struct compiling *compiling = data;
    struct vk_program *program = dt_program(compiling->core, pass);
    if (program->handle) /* adopted */
        return;
    struct vk_program_info info = vk_program_info_of(compiling->core, pass);
    compiling->outcomes[pass] =
        vk_program_compile((const struct dt_vk_runtime *)compiling->core, program, &info);
}

static bool compile_programs(struct dt_core *core)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    uint32_t count = core->pipeline->pass_count;
    struct compiling compiling = {core, calloc(count + 1, sizeof *compiling.outcomes)};
    struct vk_outcome *outcomes = compiling.outcomes;
    bool good = true, threads = rt->threads.run;
    if (!outcomes)
        return dt_error(core, "pipeline %s: out of memory; free some", core->pipeline->name);
    if (threads)
        rt->threads.run(rt->threads.user, count, compile_pass, &compiling);
    for (uint32_t i = 0; good && i < count; i++) {
        if (!threads)
            compile_pass(&compiling, i);
        good = vk_check(rt, outcomes[i].result, outcomes[i].call, dt_pass_name(core, i));
        if (good && outcomes[i].call)
            adopt_program(core, dt_program(core, i), i);
    }
    free(outcomes);
    return good;
}

/* ---- Resources ------------------------------------------------------------------------------- */

VkBufferUsageFlags vk_buffer_usage(unsigned usage)
{
    VkBufferUsageFlags flags = 0;
    flags |= usage & DT_READ_UNIFORM ? VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT : 0;
    flags |= usage & DT_READ_INDIRECT ? VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT : 0;
    flags |= usage & DT_READ_INDEX ? VK_BUFFER_USAGE_INDEX_BUFFER_BIT : 0;
    return usage & (DT_READ_STORAGE | DT_WRITE_STORAGE) || !flags
               ? flags | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT
               : flags;
}

VkImageUsageFlags vk_image_usage(unsigned usage)
{
    const unsigned storage = DT_READ_STORAGE | DT_WRITE_STORAGE;
    VkImageUsageFlags flags = 0;
    flags |= usage & storage ? VK_IMAGE_USAGE_STORAGE_BIT : 0;
    flags |= usage & (DT_READ_COLOR | DT_WRITE_COLOR) ? VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT : 0;
    flags |=
        usage & (DT_READ_DEPTH | DT_WRITE_DEPTH) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : 0;
    return usage & DT_READ_TEXTURE || !flags ? flags | VK_IMAGE_USAGE_SAMPLED_BIT : flags;
}

/* Of a host's range only the resource's bytes are bound, and draws are counted by them. */
static bool create_buffer(struct dt_vk_runtime *rt, uint32_t index, VkDeviceSize size)
{
    const struct dt_storage *storage = &rt->core.panel->storage[index];
    const struct vk_choice *choice = vk_choice_at(rt, index);
    struct vk_buffer *buffer = &vk_resource_at(rt, index)->buffer;
    const struct vk_buffer_info info = {
        .name = rt->core.pipeline->resources[index].name,
        .size = size,
        .block = storage->block,
        .usage = vk_buffer_usage(storage->usage) | choice->usage,
    };
    if (!choice->buffer.buffer)
        return vk_buffer_create(rt, buffer, &info);
    if (!vk_buffer_import(rt, buffer, info.name, &choice->buffer,
                          size > info.block ? size : info.block))
        return false;
    buffer->size = size;
    buffer->block = info.block > size ? info.block : 0;
    return true;
}

/* Whether passes bind single layers. */
static bool by_layer(const struct dt_vk_runtime *rt, uint32_t index)
{
    const struct dt_storage *storage = &rt->core.panel->storage[index];
    return storage->by_layer ||
           (rt->core.pipeline->resources[index].layered && !vk_has_layers(rt) &&
            storage->usage & (DT_WRITE_COLOR | DT_WRITE_DEPTH));
}

static bool create_resource(struct dt_core *core, uint32_t index, const uint32_t extent[3])
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct dt_resource *resource = &core->pipeline->resources[index];
    const struct dt_storage *storage = &core->panel->storage[index];
    const struct vk_choice *choice = vk_choice_at(rt, index);
    if (resource->kind == DT_BUFFER)
        return create_buffer(rt, index, (VkDeviceSize)extent[0] * resource->stride);
    const struct vk_image_info info = {
        .name = resource->name,
        .format = resource->format,
        .usage = vk_image_usage(storage->usage) | (choice->image.image ? 0 : choice->usage),
        .width = extent[0],
        .height = extent[1],
        .layers = extent[2],
        .mips = resource->mips,
        .shape = resource->shape,
        .layered = resource->layered,
        .by_layer = by_layer(rt, index),
        .import = choice->image.image ? &choice->image : NULL,
    };
    return vk_image_create(rt, &vk_resource_at(rt, index)->image, &info);
}

static void destroy_resource(struct dt_core *core, void *resource)
{
    struct vk_resource *made = resource;
    vk_buffer_destroy(vk_runtime_of(core), &made->buffer);
    vk_image_destroy(vk_runtime_of(core), &made->image);
}

static bool owns_memory(const struct vk_resource *resource)
{
    return resource->image.memory.memory || resource->buffer.memory.memory;
}

static bool detach_resource(struct dt_core *core, uint32_t index)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_resource *resource = vk_resource_at(rt, index);
    uint16_t slot = core->panel->storage[index].slot;
    for (uint32_t i = 0; i < core->pipeline->resource_count; i++)
        if (i != index && core->panel->storage[i].slot == slot)
            return false;
    if (owns_memory(resource))
        return true;
    *(resource->image.handle ? &resource->image.memory : &resource->buffer.memory) =
        rt->slots[slot];
    rt->slots[slot] = (struct dt_vk_memory){0};
    return true;
}

static bool adopt_resource(struct dt_core *core, uint32_t index, void *resource)
{
    const struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct dt_storage *storage = &core->panel->storage[index];
    struct vk_resource *made = resource;
    bool image = made->image.handle;
    VkFlags usage = image ? made->image.usage : made->buffer.usage;
    VkFlags wanted = vk_choice_at(rt, index)->usage |
                     (image ? vk_image_usage(storage->usage) : vk_buffer_usage(storage->usage));
    *(image ? &made->image.name : &made->buffer.name) = core->pipeline->resources[index].name;
    return (usage & wanted) == wanted && made->image.by_layer >= by_layer(rt, index);
}

static void release_memory(struct dt_core *core)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    for (uint32_t i = 0; rt->slots && i < core->panel->slot_count; i++)
        vk_memory_destroy(rt, &rt->slots[i]);
}

static VkMemoryRequirements requirements(const struct dt_vk_runtime *rt,
                                         const struct vk_resource *resource)
{
    VkMemoryRequirements needs;
    if (resource->image.handle)
        rt->vk.GetImageMemoryRequirements(rt->device, resource->image.handle, &needs);
    else
        rt->vk.GetBufferMemoryRequirements(rt->device, resource->buffer.handle, &needs);
    return needs;
}

/* Allocates the slot for its largest resource, from a memory type that suits all its resources. */
static bool allocate_slot(struct dt_vk_runtime *rt, uint32_t slot)
{
    VkMemoryRequirements needs = {.memoryTypeBits = UINT32_MAX};
    const char *name = NULL; /* the largest resource; errors name it */
    for (uint32_t i = 0; i < rt->core.pipeline->resource_count; i++) {
        const struct vk_resource *resource = vk_resource_at(rt, i);
        if (rt->core.panel->storage[i].slot != slot || rt->core.imported[i] || rt->core.resumed[i])
            continue; /* its memory is bound */
        VkMemoryRequirements own = requirements(rt, resource);
        needs.memoryTypeBits &= own.memoryTypeBits;
        if (own.alignment > needs.alignment) /* powers of two */
            needs.alignment = own.alignment;
        if (own.size > needs.size) {
            needs.size = own.size;
            name = rt->core.pipeline->resources[i].name;
        }
    }
    return !name || vk_memory_create(rt, &rt->slots[slot], &needs, name);
}

/* Binds all resources of a slot at its start. */
static bool place_resources(struct dt_core *core)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    bool good = true;
    for (uint32_t slot = 0; good && slot < core->panel->slot_count; slot++)
        good = allocate_slot(rt, slot);
    for (uint32_t i = 0; good && i < core->pipeline->resource_count; i++) {
        struct vk_resource *resource = vk_resource_at(rt, i);
        const struct dt_vk_memory *memory = &rt->slots[core->panel->storage[i].slot];
        if (core->resumed[i])
            continue;
        good = resource->image.handle ? vk_image_bind(rt, &resource->image, memory)
                                      : vk_buffer_bind(rt, &resource->buffer, memory);
    }
    return good;
}

static bool fill_resource(struct dt_core *core, uint32_t index, int byte)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_resource *resource = vk_resource_at(rt, index);
    rt->fills = core->hosted; /* for a host, the next frame does it: see fill_now in host.c */
    if (rt->fills)
        return true;
    return resource->image.handle ? vk_image_fill(rt, &resource->image, byte)
                                  : vk_buffer_fill(rt, &resource->buffer, byte);
}

const struct dt_backend vk_backend = {
    .name = "vk",
    .api = "Vulkan",
    .resource_size = sizeof(struct vk_resource),
    .program_size = sizeof(struct vk_program),
    .sampler_size = sizeof(VkSampler),
    .choice_size = sizeof(struct vk_choice),
    .rest = rest,
    .suits = panel_suits,
    .begin_panel = begin_panel,
    .end_panel = end_panel,
    .create_sampler = vk_sampler_create,
    .destroy_sampler = vk_sampler_destroy,
    .create_program = create_program,
    .compile_programs = compile_programs,
    .destroy_program = vk_program_destroy,
    .adopt_program = adopt_program,
    .create_resource = create_resource,
    .place_resources = place_resources,
    .fill_resource = fill_resource,
    .connect_program = vk_program_connect,
    .destroy_resource = destroy_resource,
    .detach_resource = detach_resource,
    .adopt_resource = adopt_resource,
    .release_memory = release_memory,
    .commands = &vk_commands,
    .timing = vk_frame_timing,
};
