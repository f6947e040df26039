/* The verbs of the Vulkan runtime as the app sees them, struct dt_runtime runtime_vk, and the
 * order in which they may be used. */
#include "internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void runtime_close(void *runtime)
{
    struct vk_runtime *rt = runtime;
    if (!rt)
        return;
    vk_panel_destroy(rt);
    if (rt->device) {
        vk_present_destroy(rt);
        vk_scene_destroy(rt);
        vk_uniform_destroy(rt, &rt->builtin.frame, &rt->frame_memory, &rt->frame_slot);
        vk_mapped_destroy(rt, &rt->staging, &rt->staging_memory);
    }
    vk_context_close(rt);
    free(rt);
}

static void *runtime_open(const struct dt_runtime_options *options)
{
    struct vk_runtime *rt = calloc(1, sizeof *rt);
    struct vk_buffer_info frame = {
        .name = "frame",
        .size = sizeof(struct dt_frame),
        .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
    };
    if (!rt) {
        vk_error(&(struct vk_runtime){.log = options->log}, "Vulkan: out of memory; free some");
        return NULL;
    }
    rt->log = options->log;
    rt->debug = options->debug;
    rt->timing = options->timing;
    rt->poison = options->poison;
    rt->drop_barrier = options->drop_barrier;
    rt->drop_dependency = options->drop_dependency;
    bool window = options->context && strcmp(options->context, "window") == 0;
    if (!vk_context_open(rt, options->device, window) ||
        !vk_uniform_create(rt, &rt->builtin.frame, &rt->frame_memory, &rt->frame_slot, &frame)) {
        runtime_close(rt);
        return NULL;
    }
    return rt;
}

static const char *runtime_device_name(void *runtime)
{
    struct vk_runtime *rt = runtime;
    return rt->properties.deviceName;
}

static bool runtime_is_software(void *runtime)
{
    struct vk_runtime *rt = runtime;
    return rt->properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
}

static bool runtime_set_scene(void *runtime, const struct dt_scene *scene)
{
    struct vk_runtime *rt = runtime;
    rt->sized = false; /* descriptors point at the former scene until the next resize */
    return vk_scene_upload(rt, scene);
}

static bool runtime_create(void *runtime, const struct dt_panel *panel)
{
    return vk_panel_create(runtime, panel);
}

static bool runtime_resize(void *runtime, uint32_t width, uint32_t height)
{
    return vk_panel_resize(runtime, width, height);
}

static bool runtime_render(void *runtime, const struct dt_frame *frame, const void *live,
                           const struct dt_observer *observer)
{
    struct vk_runtime *rt = runtime;
    if (!rt->sized)
        return vk_error(rt, "render: the pipeline has no resources; resize comes first, also after "
                            "set_scene and after a frame that failed");
    rt->observer = observer;
    rt->rendered = vk_frame_render(rt, frame, live ? live : rt->panel->pipeline->live_defaults);
    rt->observer = NULL;
    rt->sized = rt->rendered; /* else layouts as recorded may never have come about */
    return rt->rendered;
}

/* One mip of an image, or a buffer: one of the two is NULL. */
struct place {
    const char *name;
    struct vk_buffer *buffer;
    struct vk_image *image;
    struct dt_bytes shape; /* without data */
};

static bool find(struct vk_runtime *rt, const char *verb, uint32_t resource, uint32_t mip,
                 struct place *place)
{
    if (!rt->panel || resource >= rt->panel->pipeline->resource_count)
        return vk_error(rt, "%s: the pipeline has no resource %u", verb, resource);
    const struct dt_resource *what = &rt->panel->pipeline->resources[resource];
    if (!rt->width)
        return vk_error(rt, "%s %s: it does not exist yet; resize comes first", verb, what->name);
    bool image = what->kind == DT_IMAGE;
    void *object = rt->panel->resource(rt->state, resource);
    *place = (struct place){
        .name = what->name,
        .buffer = image ? NULL : object,
        .image = image ? object : NULL,
    };
    uint32_t mips = image ? place->image->mips : 1;
    if (mip >= mips)
        return vk_error(rt, "%s %s: mip %u, and it has %u", verb, what->name, mip, mips);
    if (image) {
        place->shape = vk_image_shape(place->image, mip);
    } else {
        what->extent(rt->width, rt->height, place->shape.extent);
        place->shape.size = (size_t)place->shape.extent[0] * what->stride;
    }
    return true;
}

static bool runtime_read(void *runtime, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct vk_runtime *rt = runtime;
    struct place place = {0};
    *out = (struct dt_bytes){0};
    if (!find(rt, "read", resource, mip, &place))
        return false;
    *out = place.shape;
    return place.image ? vk_read_image(rt, place.image, mip, out)
                       : vk_read_buffer(rt, place.buffer, out);
}

static bool runtime_write(void *runtime, uint32_t resource, uint32_t mip,
                          const struct dt_bytes *bytes)
{
    struct vk_runtime *rt = runtime;
    struct place place = {0};
    if (!find(rt, "write", resource, mip, &place))
        return false;
    const uint32_t *given = bytes->extent, *own = place.shape.extent;
    if (bytes->size != place.shape.size || memcmp(given, own, sizeof place.shape.extent) != 0)
        return vk_error(rt,
                        "write %s: %zu bytes of %ux%ux%u, but it takes %zu of %ux%ux%u; give "
                        "what read gives",
                        place.name, bytes->size, given[0], given[1], given[2], place.shape.size,
                        own[0], own[1], own[2]);
    return place.image ? vk_write_image(rt, place.image, mip, bytes)
                       : vk_write_buffer(rt, place.buffer, bytes);
}

static bool runtime_timings(void *runtime, double *pass_ms)
{
    struct vk_runtime *rt = runtime;
    if (!rt->timing || !rt->rendered)
        return vk_error(rt, "timings: none; open with timing and render a frame first");
    memcpy(pass_ms, rt->pass_ms, rt->panel->pipeline->pass_count * sizeof *pass_ms);
    return true;
}

static double runtime_record_ms(void *runtime)
{
    struct vk_runtime *rt = runtime;
    return rt->rendered ? rt->record_ms : NAN;
}

static void *runtime_window(void *runtime)
{
    return ((struct vk_runtime *)runtime)->present.window;
}

static bool has_window(const struct vk_runtime *rt, const char *verb)
{
    return rt->present.window ||
           vk_error(rt, "%s: the Vulkan runtime was opened without a window", verb);
}

static bool runtime_window_copy(void *runtime, uint32_t texture, uint32_t resource)
{
    struct vk_runtime *rt = runtime;
    struct place place = {0};
    if (!has_window(rt, "window_copy") || !find(rt, "window_copy", resource, 0, &place))
        return false;
    if (!place.image || place.image->texel != DT_FORMAT_RGBA8 || place.image->layered)
        return vk_error(rt, "window_copy %s: is no image of RGBA8; read it, and use window_upload",
                        place.name);
    return vk_window_copy(rt, texture, place.image);
}

static bool runtime_window_upload(void *runtime, uint32_t texture, uint32_t width, uint32_t height,
                                  const uint8_t *pixels)
{
    struct vk_runtime *rt = runtime;
    return has_window(rt, "window_upload") && vk_window_upload(rt, texture, width, height, pixels);
}

static bool runtime_present(void *runtime, const struct dt_window_frame *frame)
{
    struct vk_runtime *rt = runtime;
    return has_window(rt, "present") && vk_present(rt, frame);
}

static bool runtime_is_lost(void *runtime)
{
    struct vk_runtime *rt = runtime;
    return rt->lost;
}

static uint32_t runtime_messages(void *runtime)
{
    struct vk_runtime *rt = runtime;
    return rt->messages;
}

const struct dt_runtime runtime_vk = {
    .name = "vk",
    .open = runtime_open,
    .device_name = runtime_device_name,
    .is_software = runtime_is_software,
    .set_scene = runtime_set_scene,
    .create = runtime_create,
    .resize = runtime_resize,
    .render = runtime_render,
    .read = runtime_read,
    .write = runtime_write,
    .timings = runtime_timings,
    .record_ms = runtime_record_ms,
    .window = runtime_window,
    .window_copy = runtime_window_copy,
    .window_upload = runtime_window_upload,
    .present = runtime_present,
    .is_lost = runtime_is_lost,
    .messages = runtime_messages,
    .close = runtime_close,
};
