/* Copies buffers and images to the host, tightly packed. Called by runtime.c, between frames and
 * by observers between passes; leaves every image in the layout that it had. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* What lies in the staging buffer becomes `out`. */
static bool take_staging(struct vk_runtime *rt, const char *name, size_t size, struct dt_bytes *out)
{
    out->data = malloc(size ? size : 1);
    if (!out->data)
        return vk_error(rt, "read %s: no memory for %zu bytes; free some, or use a smaller frame",
                        name, size);
    out->size = size;
    memcpy(out->data, rt->staging_memory.bytes, size);
    return true;
}

bool vk_read_buffer(struct vk_runtime *rt, const struct vk_buffer *buffer, VkDeviceSize size,
                    struct dt_bytes *out)
{
    VkCommandBuffer commands;
    if (!vk_staging(rt, buffer->size, buffer->name) ||
        !(commands = vk_immediate_begin(rt, buffer->name)))
        return false;
    vkCmdCopyBuffer(commands, buffer->handle, rt->staging.handle, 1,
                    &(VkBufferCopy){.size = buffer->size});
    return vk_immediate_end(rt, buffer->name) && take_staging(rt, buffer->name, size, out);
}

bool vk_read_image(struct vk_runtime *rt, struct vk_image *image, uint32_t mip,
                   struct dt_bytes *out)
{
    if (mip >= image->mips)
        return vk_error(rt, "read %s: mip %u, and it has %u", image->name, mip, image->mips);
    VkImageLayout layout = image->layout;
    uint32_t width = image->width >> mip, height = image->height >> mip;
    VkBufferImageCopy region = {
        .imageSubresource = {image->aspect, mip, 0, image->layers},
        .imageExtent = {width ? width : 1, height ? height : 1, 1},
    };
    VkDeviceSize size = (VkDeviceSize)region.imageExtent.width * region.imageExtent.height *
                        image->layers * vk_texel_size(image->texel);
    VkCommandBuffer commands;
    if (!vk_staging(rt, size, image->name) || !(commands = vk_immediate_begin(rt, image->name)))
        return false;
    vk_transition(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    vkCmdCopyImageToBuffer(commands, image->handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           rt->staging.handle, 1, &region);
    if (layout != VK_IMAGE_LAYOUT_UNDEFINED) /* which nothing can go back to */
        vk_transition(commands, image, layout);
    out->extent[0] = region.imageExtent.width;
    out->extent[1] = region.imageExtent.height;
    out->extent[2] = image->layers;
    return vk_immediate_end(rt, image->name) && take_staging(rt, image->name, size, out);
}
