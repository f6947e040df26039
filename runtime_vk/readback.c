/* Copies buffers and images to the host and back, tightly packed. Restores the layout of every
 * image. */
#include "internal.h"

#include <string.h>

bool vk_read(struct dt_core *core, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct vk_buffer *buffer = vk_buffer_at(rt, resource);
    struct vk_image *image = &vk_resource_at(rt, resource)->image;
    const char *name = core->pipeline->resources[resource].name;
    VkImageLayout layout = image->layout;
    VkCommandBuffer commands;
    if (!vk_staging(rt, out->size, name) || !(commands = vk_immediate_begin(rt, name)))
        return false;
    if (image->handle) {
        const VkBufferImageCopy region = vk_mip_region(image, mip);
        vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        rt->vk.CmdCopyImageToBuffer(commands, image->handle, image->layout, rt->staging.handle, 1,
                                    &region);
        if (layout != VK_IMAGE_LAYOUT_UNDEFINED) /* no transition to it exists */
            vk_transition(rt, commands, image, layout);
    } else {
        rt->vk.CmdCopyBuffer(commands, buffer->handle, rt->staging.handle, 1,
                             &(VkBufferCopy){.size = out->size});
    }
    if (!vk_immediate_end(rt, name))
        return false;
    memcpy(out->data, rt->staging.bytes, out->size);
    return true;
}

bool vk_write(struct dt_core *core, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_image *image = &vk_resource_at(rt, resource)->image;
    return image->handle
               ? vk_image_write(rt, image, mip, bytes->data, bytes->size, image->layout)
               : vk_buffer_write(rt, vk_buffer_at(rt, resource), bytes->data, bytes->size);
}
