/* The pipeline that a runtime holds, from create to destroy. Called by runtime.c for the app and by
 * host.c for other programs. */
#include "internal.h"

#include <stdlib.h>

/* No frame of the pipeline is on its way: a host has promised it, a runtime with a device of its own
 * waits. A lost device reports it here, and may be torn down all the same. */
static VkResult come_to_rest(const struct vk_runtime *rt)
{
    return rt->hosted ? VK_SUCCESS : rt->vk.DeviceWaitIdle(rt->device);
}

void vk_panel_destroy(struct vk_runtime *rt)
{
    if (!rt->panel)
        return;
    come_to_rest(rt);
    rt->panel->destroy(rt, rt->state);
    vk_frame_destroy(rt);
    free(rt->state);
    rt->state = NULL;
    rt->panel = NULL;
    rt->width = rt->height = 0;
    rt->sized = false;
}

static bool create(struct vk_runtime *rt, const struct dt_panel *panel)
{
    if (!vk_device_suits_panel(rt, panel))
        return false;
    rt->state = calloc(1, panel->state_size ? panel->state_size : 1);
    if (!rt->state)
        return vk_error(rt, "pipeline %s: out of memory; free some", panel->pipeline->name);
    rt->panel = panel;
    if (vk_frame_create(rt) && panel->create(rt, rt->state))
        return true;
    vk_panel_destroy(rt);
    return false;
}

/* An edit leaves most programs as they are, so these go from the panel before to the new one. */
bool vk_panel_create(struct vk_runtime *rt, const struct dt_panel *panel)
{
    rt->spare.keeps = true;
    vk_panel_destroy(rt);
    rt->spare.keeps = false;
    bool good = create(rt, panel);
    vk_programs_forget(rt);
    return good;
}

static bool lacks_scene(const struct vk_runtime *rt)
{
    const struct dt_pipeline *pipeline = rt->panel->pipeline;
    for (uint32_t i = 0; i < pipeline->pass_count && !rt->has_scene; i++)
        if (pipeline->passes[i].uses_scene)
            return true;
    return false;
}

bool vk_panel_resize(struct vk_runtime *rt, uint32_t width, uint32_t height)
{
    uint32_t limit = rt->properties.limits.maxImageDimension2D;
    if (!rt->panel || lacks_scene(rt))
        return vk_error(rt, "resize: no pipeline or no scene yet; create and %s come first",
                        rt->hosted ? "import_scene" : "set_scene");
    if (width < 1 || height < 1 || width > limit || height > limit)
        return vk_error(rt, "frame of %ux%u: the device takes 1x1 to %ux%u; choose another --size",
                        width, height, limit, limit);
    rt->width = rt->height = 0;
    rt->sized = false;
    rt->rendered = false;
    if (!vk_check(rt, come_to_rest(rt), "vkDeviceWaitIdle", "resize") ||
        !rt->panel->resize(rt, rt->state, width, height))
        return false;
    rt->width = width;
    rt->height = height;
    rt->sized = true;
    return true;
}

const struct vk_builtin *dt_vk_builtin(const struct vk_runtime *rt)
{
    return &rt->builtin;
}
