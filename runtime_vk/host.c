/* Pipelines on a device of somebody else's, recorded into command buffers of somebody else's: the
 * functions of diptych_vk.h. What they are given is checked here, once. Called by other programs. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- Open and close -------------------------------------------------------------------------- */

static bool load_functions(struct vk_runtime *rt, PFN_vkGetInstanceProcAddr get)
{
    PFN_vkGetDeviceProcAddr get_device =
        (PFN_vkGetDeviceProcAddr)get(rt->instance, "vkGetDeviceProcAddr");
    bool good = get_device;
#define LOAD_INSTANCE(name)                                                                        \
    good = good && (rt->vk.name = (PFN_vk##name)get(rt->instance, "vk" #name));
#define LOAD_DEVICE(name)                                                                          \
    good = good && (rt->vk.name = (PFN_vk##name)get_device(rt->device, "vk" #name));
    VK_INSTANCE_FUNCTIONS(LOAD_INSTANCE)
    VK_DEVICE_FUNCTIONS(LOAD_DEVICE)
#undef LOAD_INSTANCE
#undef LOAD_DEVICE
    return good ||
           vk_error(rt, "Vulkan: the loader lacks functions of version 1.3; make instance and "
                        "device with apiVersion 1.3");
}

/* Only with the extension, which the host says that it has. */
static void load_labels(struct vk_runtime *rt, PFN_vkGetInstanceProcAddr get)
{
    rt->begin_label =
        (PFN_vkCmdBeginDebugUtilsLabelEXT)get(rt->instance, "vkCmdBeginDebugUtilsLabelEXT");
    rt->end_label = (PFN_vkCmdEndDebugUtilsLabelEXT)get(rt->instance, "vkCmdEndDebugUtilsLabelEXT");
    rt->set_name =
        (PFN_vkSetDebugUtilsObjectNameEXT)get(rt->instance, "vkSetDebugUtilsObjectNameEXT");
    if (!rt->end_label)
        rt->begin_label = NULL;
}

static bool check_family(struct vk_runtime *rt)
{
    const VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    uint32_t count = 0;
    rt->vk.GetPhysicalDeviceQueueFamilyProperties(rt->physical, &count, NULL);
    VkQueueFamilyProperties *families = calloc(count ? count : 1, sizeof *families);
    if (!families)
        return vk_error(rt, "Vulkan: out of memory; free some");
    rt->vk.GetPhysicalDeviceQueueFamilyProperties(rt->physical, &count, families);
    VkQueueFamilyProperties family = {0};
    if (rt->queue_family < count)
        family = families[rt->queue_family];
    free(families);
    rt->timestamp_bits = family.timestampValidBits;
    if ((family.queueFlags & wanted) != wanted)
        return vk_error(rt,
                        "queue family %u of %s: must have graphics and compute; give another "
                        "queue_family",
                        rt->queue_family, rt->properties.deviceName);
    return !rt->timing || rt->timestamp_bits ||
           vk_error(rt, "queue family %u of %s: has no timestamps; open without timing",
                    rt->queue_family, rt->properties.deviceName);
}

static bool open_on(struct vk_runtime *rt, const struct dt_vk_host *host)
{
    char missing[512];
    struct vk_buffer_info frame = {
        .name = "frame",
        .size = sizeof(struct dt_frame),
        .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
    };
    if (!host->instance || !host->physical_device || !host->device || !host->get_instance_proc_addr)
        return vk_error(rt, "struct dt_vk_host: instance, physical_device, device and "
                            "get_instance_proc_addr must be given");
    if (!load_functions(rt, host->get_instance_proc_addr))
        return false;
    vk_device_describe(rt, host->physical_device);
    if (!vk_device_suits(rt, rt->physical, missing, sizeof missing))
        return vk_error(rt, "Vulkan device %s: missing %s; give another device",
                        rt->properties.deviceName, missing);
    if (host->labels)
        load_labels(rt, host->get_instance_proc_addr);
    return check_family(rt) &&
           vk_uniform_create(rt, &rt->builtin.frame, &rt->frame_memory, &rt->frame_slot, &frame);
}

struct vk_runtime *dt_vk_open(const struct dt_vk_host *host)
{
    struct vk_runtime *rt = calloc(1, sizeof *rt);
    if (!rt) {
        vk_error(&(struct vk_runtime){.log = host->log}, "Vulkan: out of memory; free some");
        return NULL;
    }
    rt->log = host->log;
    rt->timing = host->timing;
    rt->hosted = true;
    rt->instance = host->instance;
    rt->device = host->device;
    rt->queue_family = host->queue_family;
    if (open_on(rt, host))
        return rt;
    dt_vk_close(rt);
    return NULL;
}

static void release_scene(struct vk_runtime *rt)
{
    struct vk_builtin *builtin = &rt->builtin;
    if (builtin->textures.imported)
        builtin->textures = (struct vk_image){0};
    dt_vk_image_destroy(rt, &builtin->textures);
    dt_vk_slot_destroy(rt, &rt->texture_slot);
    builtin->vertices = builtin->indices = builtin->materials = (struct vk_buffer){0};
    rt->has_scene = false;
    rt->index_count = 0;
}

void dt_vk_close(struct vk_runtime *rt)
{
    if (!rt)
        return;
    if (rt->physical) { /* all functions are there */
        vk_panel_destroy(rt);
        release_scene(rt);
        dt_vk_sampler_destroy(rt, &rt->builtin.texture_sampler);
        vk_uniform_destroy(rt, &rt->builtin.frame, &rt->frame_memory, &rt->frame_slot);
    }
    free(rt->fills);
    free(rt);
}

/* ---- Imports --------------------------------------------------------------------------------- */

static bool import_buffer(const struct vk_runtime *rt, struct vk_buffer *buffer, const char *name,
                          const struct dt_vk_range *range, VkDeviceSize least)
{
    VkDeviceSize alignment = rt->properties.limits.minStorageBufferOffsetAlignment;
    if (alignment < rt->properties.limits.minUniformBufferOffsetAlignment)
        alignment = rt->properties.limits.minUniformBufferOffsetAlignment;
    if (!range->buffer || range->size < least || range->offset % alignment)
        return vk_error(rt,
                        "%s: a buffer of at least %llu bytes is needed, at a multiple of %llu, but "
                        "%llu bytes at %llu were given",
                        name, (unsigned long long)least, (unsigned long long)alignment,
                        (unsigned long long)range->size, (unsigned long long)range->offset);
    if (range->size > rt->properties.limits.maxStorageBufferRange)
        return vk_error(rt, "%s: %llu bytes, but the device binds at most %u; import fewer", name,
                        (unsigned long long)range->size,
                        rt->properties.limits.maxStorageBufferRange);
    *buffer = (struct vk_buffer){
        .name = name, .handle = range->buffer, .offset = range->offset, .size = range->size};
    return true;
}

/* One white texel in place of the textures that the host has not. */
static bool create_white(struct vk_runtime *rt)
{
    struct vk_image *image = &rt->builtin.textures;
    struct vk_slot_user user = {.image = image};
    struct vk_image_info info = {
        .name = "no textures",
        .format = DT_FORMAT_RGBA8_SRGB,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
        .width = 1,
        .height = 1,
        .layers = 1,
        .mips = 1,
        .layered = true,
    };
    return dt_vk_image_create(rt, image, &info) && dt_vk_slot_bind(rt, &rt->texture_slot, &user, 1);
}

static bool import_textures(struct vk_runtime *rt, VkImageView textures)
{
    struct vk_sampler_info sampler = {
        .name = "scene_textures",
        .filter = VK_FILTER_LINEAR,
        .mip_filter = VK_SAMPLER_MIPMAP_MODE_LINEAR,
        .wrap = VK_SAMPLER_ADDRESS_MODE_REPEAT,
        .anisotropy = 1,
    };
    if (!rt->builtin.texture_sampler &&
        !dt_vk_sampler_create(rt, &rt->builtin.texture_sampler, &sampler))
        return false;
    if (!textures)
        return create_white(rt);
    rt->builtin.textures = (struct vk_image){
        .name = "scene_textures", .view = textures, .layered = true, .imported = true};
    return true;
}

bool dt_vk_import_scene(struct vk_runtime *rt, const struct dt_vk_scene *scene)
{
    struct vk_builtin *builtin = &rt->builtin;
    const struct dt_vk_range *indices = &scene->indices;
    rt->sized = false; /* descriptors point at the former scene until the next resize */
    release_scene(rt);
    if (!scene->index_count || scene->index_count % 3)
        return vk_error(rt, "import_scene: %u indices, but triangles have three each",
                        scene->index_count);
    if (!import_buffer(rt, &builtin->vertices, "scene_vertices", &scene->vertices,
                       sizeof(struct dt_vertex)) ||
        !import_buffer(rt, &builtin->indices, "scene_indices", indices,
                       (VkDeviceSize)scene->index_count * sizeof(uint32_t)) ||
        !import_buffer(rt, &builtin->materials, "scene_materials", &scene->materials,
                       DT_MAX_MATERIALS * sizeof(struct dt_material)) ||
        !import_textures(rt, scene->textures))
        return false;
    builtin->materials.size =
        DT_MAX_MATERIALS * sizeof(struct dt_material); /* as a uniform block */
    rt->index_count = scene->index_count;
    rt->has_scene = true;
    return true;
}

bool dt_vk_import_image(struct vk_runtime *rt, uint32_t resource, const struct dt_vk_image *image)
{
    const struct dt_pipeline *pipeline = rt->panel ? rt->panel->pipeline : NULL;
    if (!pipeline || resource >= pipeline->resource_count ||
        pipeline->resources[resource].kind != DT_IMAGE)
        return vk_error(rt, "import_image: the pipeline has no image %u; create comes first",
                        resource);
    const char *name = pipeline->resources[resource].name;
    uint32_t at = 0;
    while (at < rt->import_count && strcmp(rt->imports[at].name, name) != 0)
        at++;
    rt->sized = false; /* until the next resize */
    if (!image->image) {
        if (at < rt->import_count)
            rt->imports[at] = rt->imports[--rt->import_count];
        return true;
    }
    if (at == VK_MAX_IMPORTS)
        return vk_error(rt, "import_image %s: %d are imported already; take one back", name, at);
    rt->imports[at] = (struct vk_import){.name = name, .given = *image};
    if (at == rt->import_count)
        rt->import_count++;
    return true;
}

/* ---- The pipeline ---------------------------------------------------------------------------- */

bool dt_vk_create(struct vk_runtime *rt, const struct dt_panel *panel)
{
    if (strcmp(panel->backend, "vk") != 0)
        return vk_error(rt, "pipeline %s: the panel is for %s; give the one of NAME_vk.c",
                        panel->pipeline->name, panel->backend);
    rt->import_count = 0;
    return vk_panel_create(rt, panel);
}

bool dt_vk_resize(struct vk_runtime *rt, uint32_t width, uint32_t height)
{
    struct vk_image *textures = &rt->builtin.textures;
    rt->fill_count = 0;
    if (!vk_panel_resize(rt, width, height))
        return false;
    if (textures->imported || !textures->handle)
        return true;
    textures->layout = VK_IMAGE_LAYOUT_UNDEFINED; /* as far as anybody has seen it executed */
    return vk_fill_later(rt, &(struct vk_fill){.user = {.image = textures},
                                               .value = 1,
                                               .layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
}

bool dt_vk_record(struct vk_runtime *rt, VkCommandBuffer commands, const struct dt_frame *frame,
                  const void *live)
{
    if (!rt->sized)
        return vk_error(rt, "record: the pipeline has no resources; resize comes first, also after "
                            "an import and after a record that failed");
    rt->rendered =
        vk_frame_record(rt, commands, frame, live ? live : rt->panel->pipeline->live_defaults);
    rt->sized = rt->rendered; /* else layouts as recorded may never come about */
    return rt->rendered;
}

bool dt_vk_resource(struct vk_runtime *rt, uint32_t resource, struct dt_vk_resource *out)
{
    *out = (struct dt_vk_resource){0};
    if (!rt->width || resource >= rt->panel->pipeline->resource_count)
        return vk_error(rt, "resource %u: there is none; resize comes first", resource);
    if (rt->panel->pipeline->resources[resource].kind == DT_BUFFER) {
        const struct vk_buffer *buffer = rt->panel->resource(rt->state, resource);
        out->buffer = buffer->handle;
        return true;
    }
    const struct vk_image *image = rt->panel->resource(rt->state, resource);
    *out = (struct dt_vk_resource){.image = image->handle,
                                   .view = image->view,
                                   .format = image->format,
                                   .layout = image->layout};
    return true;
}

bool dt_vk_timings(struct vk_runtime *rt, double *pass_ms)
{
    if (!rt->timing || !rt->rendered)
        return vk_error(rt, "timings: none; open with timing and record a frame first");
    if (!vk_frame_timings(rt))
        return false;
    memcpy(pass_ms, rt->pass_ms, rt->panel->pipeline->pass_count * sizeof *pass_ms);
    return true;
}
