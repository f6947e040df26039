/* Copies buffers and images to the host and back, tightly packed. Restores the layout of every
 * image. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* No transition to UNDEFINED exists. */
static void restore_layout(const struct dt_vk_runtime *rt, VkCommandBuffer commands,
                           struct vk_image *image, VkImageLayout layout)
{
    if (layout != VK_IMAGE_LAYOUT_UNDEFINED)
        vk_transition(rt, commands, image, layout);
}

/* Copies the staging buffer to `out`. */
static bool take_staging(struct dt_vk_runtime *rt, const char *name, struct dt_bytes *out)
{
    out->data = malloc(out->size ? out->size : 1);
    if (!out->data)
        return dt_error(&rt->core,
                        "read %s: no memory for %zu bytes; free some, or use a smaller frame", name,
                        out->size);
    memcpy(out->data, rt->staging.bytes, out->size);
    return true;
}

static bool read_buffer(struct dt_vk_runtime *rt, const struct vk_buffer *buffer,
                        struct dt_bytes *out)
{
    VkCommandBuffer commands;
    if (!vk_staging(rt, out->size, buffer->name) ||
        !(commands = vk_immediate_begin(rt, buffer->name)))
        return false;
    rt->vk.CmdCopyBuffer(commands, buffer->handle, rt->staging.handle, 1,
                         &(VkBufferCopy){.size = out->size});
    return vk_immediate_end(rt, buffer->name) && take_staging(rt, buffer->name, out);
}

static bool read_image(struct dt_vk_runtime *rt, struct vk_image *image, uint32_t mip,
                       struct dt_bytes *out)
{
    VkImageLayout layout = image->layout;
    VkBufferImageCopy region = vk_mip_region(image, mip);
    VkCommandBuffer commands;
    if (!vk_staging(rt, out->size, image->name) ||
        !(commands = vk_immediate_begin(rt, image->name)))
        return false;
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    rt->vk.CmdCopyImageToBuffer(commands, image->handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                rt->staging.handle, 1, &region);
    restore_layout(rt, commands, image, layout);
    return vk_immediate_end(rt, image->name) && take_staging(rt, image->name, out);
}

bool vk_read(struct dt_core *core, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_resource *from = vk_resource_at(rt, resource);
    return from->image.handle ? read_image(rt, &from->image, mip, out)
                              : read_buffer(rt, &from->buffer, out);
}

/* Copies the bytes to the staging buffer, begins a command buffer; NULL after an error. */
static VkCommandBuffer begin_write(struct dt_vk_runtime *rt, const char *name,
                                   const struct dt_bytes *bytes)
{
    void *staging = vk_staging(rt, bytes->size, name);
    if (!staging)
        return NULL;
    memcpy(staging, bytes->data, bytes->size);
    return vk_immediate_begin(rt, name);
}

static bool write_buffer(struct dt_vk_runtime *rt, const struct vk_buffer *buffer,
                         const struct dt_bytes *bytes)
{
    VkCommandBuffer commands = begin_write(rt, buffer->name, bytes);
    if (!commands)
        return false;
    rt->vk.CmdCopyBuffer(commands, rt->staging.handle, buffer->handle, 1,
                         &(VkBufferCopy){.size = bytes->size});
    return vk_immediate_end(rt, buffer->name);
}

static bool write_image(struct dt_vk_runtime *rt, struct vk_image *image, uint32_t mip,
                        const struct dt_bytes *bytes)
{
    VkImageLayout layout = image->layout;
    VkBufferImageCopy region = vk_mip_region(image, mip);
    VkCommandBuffer commands = begin_write(rt, image->name, bytes);
    if (!commands)
        return false;
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    rt->vk.CmdCopyBufferToImage(commands, rt->staging.handle, image->handle,
                                VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    restore_layout(rt, commands, image, layout);
    return vk_immediate_end(rt, image->name);
}

bool vk_write(struct dt_core *core, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_resource *to = vk_resource_at(rt, resource);
    return to->image.handle ? write_image(rt, &to->image, mip, bytes)
                            : write_buffer(rt, &to->buffer, bytes);
}
