/* The functions of diptych_vk.h: pipelines on a host's device, recorded into the host's command
 * buffers. Checks arguments that the front does not know. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* NULL of a runtime that a host never got. */
static const struct dt_core *core_of(const struct dt_vk_runtime *rt)
{
    return rt ? &rt->core : NULL;
}

/* ---- Open and close -------------------------------------------------------------------------- */

static bool check_functions(const struct dt_vk_runtime *rt, bool good)
{
    return good || dt_error(&rt->core,
                            "Vulkan: the loader lacks functions of version 1.3; make instance and "
                            "device with apiVersion 1.3");
}

static bool load_instance(struct dt_vk_runtime *rt, PFN_vkGetInstanceProcAddr get)
{
    bool good = true;
#define LOAD(name) good = good && (rt->vk.name = (PFN_vk##name)get(rt->instance, "vk" #name));
    VK_INSTANCE_FUNCTIONS(LOAD)
#undef LOAD
    return check_functions(rt, good);
}

static bool load_device(struct dt_vk_runtime *rt, PFN_vkGetInstanceProcAddr get)
{
    PFN_vkGetDeviceProcAddr get_device =
        (PFN_vkGetDeviceProcAddr)get(rt->instance, "vkGetDeviceProcAddr");
    bool good = get_device;
#define LOAD(name) good = good && (rt->vk.name = (PFN_vk##name)get_device(rt->device, "vk" #name));
    VK_DEVICE_FUNCTIONS(LOAD)
#undef LOAD
    return check_functions(rt, good);
}

static bool check_family(struct dt_vk_runtime *rt)
{
    if (!vk_device_family_suits(rt, rt->physical, rt->queue_family, &rt->timestamp_bits))
        return dt_error(&rt->core,
                        "queue family %u of %s: must have graphics and compute; give another "
                        "queue_family",
                        rt->queue_family, rt->core.device.name);
    return !rt->core.timing || rt->timestamp_bits ||
           dt_error(&rt->core, "queue family %u of %s: has no timestamps; open without timing",
                    rt->queue_family, rt->core.device.name);
}

static bool open_on(struct dt_vk_runtime *rt, const struct dt_vk_host *host)
{
    char missing[512];
    if (!host->instance || !host->physical_device || !host->device || !host->get_instance_proc_addr)
        return dt_error(&rt->core, "struct dt_vk_host: instance, physical_device, device and "
                                   "get_instance_proc_addr must be given");
    if (!host->allocator.allocate != !host->allocator.free)
        return dt_error(&rt->core,
                        "struct dt_vk_host: allocator has only one of allocate and free; "
                        "give both");
    if (!load_instance(rt, host->get_instance_proc_addr) ||
        !load_device(rt, host->get_instance_proc_addr))
        return false;
    vk_device_describe(rt, host->physical_device);
    if (!vk_device_suits(rt, rt->physical, NULL, missing, sizeof missing))
        return dt_error(&rt->core, "Vulkan device %s: missing %s; give another device",
                        rt->core.device.name, missing);
    if (!host->device_info)
        vk_features_supported(rt, &rt->features);
    else if (!vk_features_enabled(rt, host->device_info))
        return false;
    if (host->labels)
        vk_load_labels(rt, host->get_instance_proc_addr);
    return check_family(rt) && vk_builtin_create(rt);
}

bool dt_vk_suits(const struct dt_vk_host *host, const struct dt_shaders *shaders)
{
    if (!host)
        return false;
    struct dt_vk_runtime rt = {.core = {.backend = &vk_backend,
                                        .log = host->log,
                                        .timing = host->timing,
                                        .target = host->target},
                               .instance = host->instance};
    if (!dt_front_given(&rt.core, shaders, "suits: the struct dt_shaders"))
        return false;
    const struct dt_panel *panel = shaders->panel;
    char missing[512];
    if (!host->instance || !host->physical_device || !host->get_instance_proc_addr)
        return dt_error(&rt.core, "struct dt_vk_host: instance, physical_device and "
                                  "get_instance_proc_addr must be given");
    if (!dt_front_takes(&rt.core, panel) || !load_instance(&rt, host->get_instance_proc_addr))
        return false;
    vk_device_describe(&rt, host->physical_device);
    if (panel->gpu && dt_front_takes_gpu(&rt.core, panel))
        panel = panel->gpu;
    if (!vk_device_suits(&rt, rt.physical, panel, missing, sizeof missing))
        return dt_error(&rt.core, "Vulkan device %s: pipeline %s: missing %s; use another device",
                        rt.core.device.name, panel->pipeline->name, missing);
    return vk_device_is_enough(&rt, rt.physical, panel, missing, sizeof missing) ||
           dt_error(&rt.core, "%s", missing);
}

static bool render(struct dt_core *core, const struct dt_frame *frame, const void *live);

struct dt_vk_runtime *dt_vk_open(const struct dt_vk_host *host)
{
    struct dt_vk_runtime *rt = host ? calloc(1, sizeof *rt) : NULL;
    if (host && !rt)
        dt_error(&(struct dt_core){.log = host->log}, "Vulkan: out of memory; free some");
    if (!rt)
        return NULL;
    rt->backend = vk_backend;
    rt->backend.render = render;
    rt->core = (struct dt_core){.backend = &rt->backend,
                                .log = host->log,
                                .hosted = true,
                                .timing = host->timing,
                                .frames = host->frames,
                                .keep_history = host->keep_history,
                                .target = host->target};
    rt->instance = host->instance;
    rt->device = host->device;
    rt->queue_family = host->queue_family;
    rt->callbacks = host->callbacks;
    rt->allocator = host->allocator;
    rt->threads = host->threads;
    rt->cache = host->pipeline_cache;
    if (open_on(rt, host))
        return rt;
    dt_vk_close(rt);
    return NULL;
}

void dt_vk_close(struct dt_vk_runtime *rt)
{
    if (!rt)
        return;
    if (rt->physical) { /* the functions are loaded */
        dt_front_destroy(&rt->core);
        vk_buffer_destroy(rt, &rt->upload);
        vk_scene_destroy(rt);
        vk_builtin_destroy(rt);
    }
    free(rt);
}

/* ---- Imports --------------------------------------------------------------------------------- */

/* One white texel, if the host has no textures. */
static bool create_white(struct dt_vk_runtime *rt)
{
    const struct vk_image_info info = {
        .name = "no textures",
        .format = DT_FORMAT_RGBA8_SRGB,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
        .width = 1,
        .height = 1,
        .layers = 1,
        .mips = 1,
        .layered = true,
    };
    return vk_image_create_own(rt, &rt->builtin.textures, &info);
}

bool dt_vk_import_scene(struct dt_vk_runtime *rt, const struct dt_vk_scene *scene)
{
    if (!dt_front_given(core_of(rt), scene, "import_scene: the struct dt_vk_scene"))
        return false;
    struct vk_builtin *builtin = &rt->builtin;
    const VkDeviceSize index_bytes = (VkDeviceSize)scene->index_count * sizeof(uint32_t);
    vk_scene_destroy(rt);
    if (!dt_front_import_scene(&rt->core, scene->vertices.buffer ? scene->vertices.size : 0,
                               scene->index_count, scene->numbered) ||
        ((scene->vertices.buffer || !scene->attributes[DT_POSITION].buffer) &&
         !vk_buffer_import(rt, vk_buffer_at(rt, DT_SCENE_VERTICES), "scene_vertices",
                           &scene->vertices, sizeof(struct dt_vertex))) ||
        !vk_scene_attributes(rt, scene->attributes) ||
        !vk_buffer_import(rt, vk_buffer_at(rt, DT_SCENE_INDICES), "scene_indices", &scene->indices,
                          index_bytes) ||
        !vk_buffer_import(rt, vk_buffer_at(rt, DT_SCENE_MATERIALS), "scene_materials",
                          &scene->materials, DT_MAX_MATERIALS * sizeof(struct dt_material)) ||
        (scene->objects.buffer &&
         !vk_buffer_import(rt, vk_buffer_at(rt, DT_SCENE_OBJECTS), "scene_objects", &scene->objects,
                           sizeof(struct dt_object))))
        return false;
    /* Shaders compute length() from the bytes that are bound. */
    vk_buffer_at(rt, DT_SCENE_INDICES)->size = index_bytes;
    vk_buffer_at(rt, DT_SCENE_MATERIALS)->size = DT_MAX_MATERIALS * sizeof(struct dt_material);
    if (scene->textures)
        builtin->textures = (struct vk_image){.name = "scene_textures",
                                              .view = scene->textures,
                                              .codes = scene->texture_codes,
                                              .layered = true,
                                              .imported = true};
    else if (!create_white(rt))
        return false;
    rt->core.has_scene = true;
    rt->core.has_objects = scene->objects.buffer;
    return true;
}

bool dt_vk_import_image(struct dt_vk_runtime *rt, uint32_t resource,
                        const struct dt_vk_image *image)
{
    if (!dt_front_given(core_of(rt), image, "import_image: the struct dt_vk_image") ||
        !dt_front_choose(&rt->core, "import_image", DT_IMAGE, resource))
        return false;
    const struct dt_resource *into = &rt->core.pipeline->resources[resource];
    if (into->history && image->image && image->layout_before == VK_IMAGE_LAYOUT_UNDEFINED)
        return dt_error(&rt->core,
                        "import_image %s: the pipeline reads its content, which the layout_before "
                        "UNDEFINED discards; give the layout that the image has",
                        into->name);
    rt->core.imported[resource] = image->image;
    vk_choice_at(rt, resource)->image = *image;
    return true;
}

bool dt_vk_import_buffer(struct dt_vk_runtime *rt, uint32_t resource,
                         const struct dt_vk_range *range)
{
    if (!dt_front_given(core_of(rt), range, "import_buffer: the struct dt_vk_range") ||
        !dt_front_choose(&rt->core, "import_buffer", DT_BUFFER, resource))
        return false;
    rt->core.imported[resource] = range->buffer;
    vk_choice_at(rt, resource)->buffer = *range;
    return true;
}

bool dt_vk_add_image_usage(struct dt_vk_runtime *rt, uint32_t resource, VkImageUsageFlags usage)
{
    if (!rt || !dt_front_choose(&rt->core, "add_image_usage", DT_IMAGE, resource))
        return false;
    vk_choice_at(rt, resource)->usage = usage;
    return true;
}

bool dt_vk_add_buffer_usage(struct dt_vk_runtime *rt, uint32_t resource, VkBufferUsageFlags usage)
{
    if (!rt || !dt_front_choose(&rt->core, "add_buffer_usage", DT_BUFFER, resource))
        return false;
    vk_choice_at(rt, resource)->usage = usage;
    return true;
}

/* ---- The pipeline ---------------------------------------------------------------------------- */

bool dt_vk_create(struct dt_vk_runtime *rt, const struct dt_shaders *shaders)
{
    return rt && dt_front_create(&rt->core, shaders);
}

static bool create_upload(struct dt_vk_runtime *rt)
{
    const struct dt_pipeline *pipeline = rt->core.pipeline;
    struct vk_buffer_info info = {.name = "upload"};
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct dt_resource *input = &pipeline->resources[i];
        struct dt_bytes shape;
        if (!input->input || input->kind != DT_IMAGE || rt->core.imported[i])
            continue;
        if (!dt_front_find(&rt->core, "resize", i, 0, &shape))
            return false;
        info.size = shape.size > info.size ? shape.size : info.size;
    }
    info.size = (info.size + 3) / 4 * 4;
    vk_buffer_destroy(rt, &rt->upload);
    return !info.size || vk_buffer_create_own(rt, &rt->upload, &info, false);
}

bool dt_vk_resize(struct dt_vk_runtime *rt, uint32_t width, uint32_t height)
{
    if (!rt)
        return false;
    /* The commands that filled the white texel may never have run: fill it again. */
    rt->builtin.textures.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    if (!dt_front_resize(&rt->core, width, height))
        return false;
    rt->core.sized = create_upload(rt);
    return rt->core.sized;
}

/* ---- Frames ---------------------------------------------------------------------------------- */

/* The bytes travel in the commands, so that earlier frames in flight keep their content. The buffer
 * holds a multiple of four bytes. */
static void update(const struct dt_vk_runtime *rt, VkCommandBuffer commands,
                   const struct vk_buffer *buffer, VkDeviceSize offset, const void *data,
                   VkDeviceSize size)
{
    const VkDeviceSize most = 65536; /* in one vkCmdUpdateBuffer */
    VkDeviceSize whole = size / 4 * 4;
    uint32_t rest = 0;
    for (VkDeviceSize at = 0; at < whole; at += most)
        rt->vk.CmdUpdateBuffer(commands, buffer->handle, offset + at,
                               whole - at < most ? whole - at : most, (const char *)data + at);
    memcpy(&rest, (const char *)data + whole, size - whole);
    if (size > whole)
        rt->vk.CmdUpdateBuffer(commands, buffer->handle, offset + whole, sizeof rest, &rest);
}

/* Leaves the image in the layout that it had; a new one as resize leaves images with history. */
static void write_host_image(const struct dt_vk_runtime *rt, VkCommandBuffer commands,
                             struct vk_image *image, uint32_t mip, const struct dt_bytes *bytes)
{
    const VkBufferImageCopy region = vk_mip_region(image, mip);
    VkImageLayout layout =
        image->layout == VK_IMAGE_LAYOUT_UNDEFINED ? VK_IMAGE_LAYOUT_GENERAL : image->layout;
    update(rt, commands, &rt->upload, 0, bytes->data, bytes->size);
    vk_full_barrier(rt, commands);
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    rt->vk.CmdCopyBufferToImage(commands, rt->upload.handle, image->handle, image->layout, 1,
                                &region);
    vk_transition(rt, commands, image, layout);
}

bool dt_vk_write(struct dt_vk_runtime *rt, VkCommandBuffer commands, uint32_t resource,
                 uint32_t mip, const struct dt_bytes *bytes)
{
    if (!rt || !dt_front_fits(&rt->core, resource, mip, bytes) ||
        !dt_front_given(&rt->core, commands, "write: the command buffer"))
        return false;
    struct vk_resource *input = vk_resource_at(rt, resource);
    vk_full_barrier(rt, commands);
    if (input->image.handle)
        write_host_image(rt, commands, &input->image, mip, bytes);
    else
        update(rt, commands, &input->buffer, 0, bytes->data, bytes->size);
    vk_full_barrier(rt, commands);
    rt->core.written[resource] |= 1u << mip;
    return true;
}

static void write_uniforms(struct dt_vk_runtime *rt, const struct dt_frame *frame, const void *live)
{
    const struct dt_pipeline *pipeline = rt->core.pipeline;
    uint32_t size = pipeline->live_size; /* then come parameters that a frame cannot change */
    update(rt, rt->frame_commands, vk_buffer_at(rt, DT_FRAME), 0, frame, sizeof *frame);
    update(rt, rt->frame_commands, vk_buffer_at(rt, DT_LIVE), 0, live, size);
    update(rt, rt->frame_commands, vk_buffer_at(rt, DT_LIVE), size,
           (const char *)pipeline->live_defaults + size, pipeline->block_size - size);
}

static void clear(const struct dt_vk_runtime *rt, struct vk_image *image, float value,
                  VkImageLayout layout)
{
    VkImageSubresourceRange range = {image->aspect, 0, image->mips, 0, image->layers};
    VkClearDepthStencilValue depth = {.depth = value};
    VkClearColorValue color = {.float32 = {value, value, value, value}};
    vk_transition(rt, rt->frame_commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    if (image->aspect & VK_IMAGE_ASPECT_DEPTH_BIT)
        rt->vk.CmdClearDepthStencilImage(rt->frame_commands, image->handle, image->layout, &depth,
                                         1, &range);
    else
        rt->vk.CmdClearColorImage(rt->frame_commands, image->handle, image->layout, &color, 1,
                                  &range);
    vk_transition(rt, rt->frame_commands, image, layout);
}

/* Fills resources with history, but for inputs, and the white texel in the first frame after
 * resize. */
static void fill_now(struct dt_vk_runtime *rt)
{
    const struct dt_pipeline *pipeline = rt->core.pipeline;
    struct vk_image *textures = &rt->builtin.textures;
    for (uint32_t i = 0; rt->fills && i < pipeline->resource_count; i++) {
        struct vk_resource *resource = vk_resource_at(rt, i);
        if (!pipeline->resources[i].history || pipeline->resources[i].input ||
            rt->core.imported[i] || rt->core.resumed[i])
            continue;
        if (resource->image.handle)
            clear(rt, &resource->image, 0, VK_IMAGE_LAYOUT_GENERAL);
        else
            rt->vk.CmdFillBuffer(rt->frame_commands, resource->buffer.handle, 0, VK_WHOLE_SIZE, 0);
    }
    rt->fills = false;
    if (textures->handle && textures->layout == VK_IMAGE_LAYOUT_UNDEFINED)
        clear(rt, textures, 1, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
}

/* Imports start with the host's queue family, images in the host's layout. The plan expects images with
 * history in GENERAL, as resize and the frame before leave them. */
static void take_imports(struct dt_vk_runtime *rt)
{
    for (uint32_t i = 0; i < rt->core.pipeline->resource_count; i++) {
        struct vk_image *image = &vk_resource_at(rt, i)->image;
        const struct vk_choice *choice = vk_choice_at(rt, i);
        if (!rt->core.imported[i])
            continue;
        image->layout = choice->image.layout_before;
        if (image->handle && rt->core.pipeline->resources[i].history &&
            image->layout != VK_IMAGE_LAYOUT_GENERAL)
            vk_transition(rt, rt->frame_commands, image, VK_IMAGE_LAYOUT_GENERAL);
    }
}

/* First accesses of the pipeline wait for the barrier at the end. */
static void begin_frame(struct dt_vk_runtime *rt, const struct dt_frame *frame, const void *live)
{
    take_imports(rt);
    write_uniforms(rt, frame, live);
    fill_now(rt);
    if (rt->core.timing)
        vk_reset_queries(rt);
    vk_full_barrier(rt, rt->frame_commands);
}

static void return_imports(struct dt_vk_runtime *rt)
{
    for (uint32_t i = 0; i < rt->core.pipeline->resource_count; i++) {
        const struct vk_choice *choice = vk_choice_at(rt, i);
        if (choice->image.image && choice->image.layout_after != VK_IMAGE_LAYOUT_UNDEFINED)
            vk_transition(rt, rt->frame_commands, &vk_resource_at(rt, i)->image,
                          choice->image.layout_after);
    }
}

/* A frame or a part of one. The first barrier waits for earlier frames, which use the same resources
 * and blocks, and for the host; the last one makes the host wait. */
static bool render(struct dt_core *core, const struct dt_frame *frame, const void *live)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    if (!dt_front_given(core, rt->frame_commands, "record: the command buffer"))
        return false;
    vk_full_barrier(rt, rt->frame_commands);
    if (!core->first_pass)
        begin_frame(rt, frame, live);
    rt->bound = (struct vk_bound){0};
    bool good = dt_front_record(core, live);
    if (core->end_pass == core->pipeline->pass_count)
        return_imports(rt);
    vk_full_barrier(rt, rt->frame_commands);
    return good;
}

bool dt_vk_record(struct dt_vk_runtime *rt, VkCommandBuffer commands, const struct dt_frame *frame,
                  const void *live)
{
    if (!rt)
        return false;
    rt->frame_commands = commands;
    return dt_verb_render(&rt->core, frame, live, NULL);
}

bool dt_vk_record_passes(struct dt_vk_runtime *rt, VkCommandBuffer commands,
                         const struct dt_frame *frame, const void *live, uint32_t first,
                         uint32_t end)
{
    if (!rt)
        return false;
    rt->frame_commands = commands;
    return dt_front_render(&rt->core, "record_passes", frame, live, first, end);
}

/* enum dt_access and enum dt_stage of a write: of a pass that ran, or of a clear. */
struct write {
    unsigned access, stage;
};

static struct write write_of(const struct dt_pass *pass, const struct dt_resource *resource)
{
    if (pass->kind == DT_PASS_DISPATCH)
        return (struct write){DT_WRITE_STORAGE, DT_STAGE_COMPUTE};
    if (resource->kind == DT_BUFFER)
        return (struct write){DT_WRITE_STORAGE, DT_STAGE_FRAGMENT};
    if (resource->format == DT_FORMAT_D32F)
        return (struct write){DT_WRITE_DEPTH, DT_STAGE_DEPTH};
    return (struct write){DT_WRITE_COLOR, DT_STAGE_COLOR};
}

/* The last write of the commands recorded last; zero: only the host writes the resource. */
static struct write last_write(const struct dt_vk_runtime *rt, uint32_t resource)
{
    const struct write clear = {DT_WRITE_CLEAR, DT_STAGE_CLEAR};
    const struct dt_core *core = &rt->core;
    const struct dt_resource *what = &core->pipeline->resources[resource];
    for (uint32_t i = core->next_pass ? core->next_pass : core->pipeline->pass_count; i-- > 0;)
        if (dt_writes(core, i, resource))
            return core->recorded && !core->ran[dt_run(core, core->slot, i)]
                       ? clear
                       : write_of(&core->pipeline->passes[i], what);
    return what->input && !core->imported[resource] ? clear : (struct write){0};
}

bool dt_vk_get_resource(struct dt_vk_runtime *rt, uint32_t resource, struct dt_vk_resource *out)
{
    struct dt_bytes shape;
    if (!dt_front_given(core_of(rt), out, "resource: the struct dt_vk_resource"))
        return false;
    *out = (struct dt_vk_resource){0};
    if (!dt_front_take(&rt->core, resource, &shape))
        return false;
    const struct vk_image *image = &vk_resource_at(rt, resource)->image;
    const struct vk_buffer *buffer = &vk_resource_at(rt, resource)->buffer;
    if (buffer->handle)
        *out = (struct dt_vk_resource){.buffer = buffer->handle,
                                       .offset = buffer->offset,
                                       .size = shape.size,
                                       .stride = rt->core.pipeline->resources[resource].stride,
                                       .buffer_usage = buffer->usage};
    else
        *out = (struct dt_vk_resource){.image = image->handle,
                                       .view = image->view,
                                       .format = image->format,
                                       .usage = image->usage,
                                       .width = image->width,
                                       .height = image->height,
                                       .layers = image->layers * image->depth,
                                       .mips = image->mips,
                                       .layout = image->layout};
    const struct write last = last_write(rt, resource);
    out->stages = vk_stages(last.stage);
    out->accesses = vk_accesses(last.access);
    return true;
}

bool dt_vk_timings(struct dt_vk_runtime *rt, uint32_t age, double *pass_ms)
{
    return rt && dt_front_timings(&rt->core, age, pass_ms);
}
