/* Reads images and buffers of Vulkan into a tap; see diptych_tap.h. Include it behind vulkan.h, or behind a
 * loader such as volk: it calls vk functions by name.
 *
 *     struct tap_vk taps;
 *     tap_vk_begin(&taps, tap, physical_device, device);
 *     ... record a pass, then in the same command buffer, outside of a render pass:
 *     struct tap_vk_image_info image = {0};
 *     image.image = radiance, image.format = VK_FORMAT_R16G16B16A16_SFLOAT;
 *     image.width = 640, image.height = 360, image.layout = VK_IMAGE_LAYOUT_GENERAL;
 *     tap_vk_image(&taps, commands, "lighting", "radiance", &image);
 *     ... submit, wait for the fence, then:
 *     tap_vk_end(&taps);
 *
 * Images need VK_IMAGE_USAGE_TRANSFER_SRC_BIT, buffers VK_BUFFER_USAGE_TRANSFER_SRC_BIT, and one sample. A copy
 * waits for all earlier commands, later commands wait for the copy, and images keep their layout. Row 0 is the
 * picture's top, also with a viewport of negative height or a projection that turns y over. Where clip space has
 * OpenGL's y and neither turns it, set taps.origin to TAP_BOTTOM. */
#ifndef DIPTYCH_TAP_VK_H
#define DIPTYCH_TAP_VK_H

#include "diptych_tap.h"

enum {
    TAP_VK_MOST = 256,
    TAP_VK_MOST_FIELDS = 32
}; /* copies between begin and end; fields of a buffer */

struct tap_vk_image_info {
    VkImage image;
    VkFormat format;
    VkImageLayout layout;   /* after the pass; not UNDEFINED */
    unsigned width, height; /* of the mip */
    unsigned depth, layers; /* 0 counts as 1; one of them may be more */
    unsigned mip;
};

struct tap_vk_copy {
    const char *pass, *resource; /* must live until tap_vk_end */
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkDeviceSize size;
    int is_buffer;
    struct tap_texels texels;
    unsigned count, stride, field_count;
    struct tap_field fields[TAP_VK_MOST_FIELDS];
};

struct tap_vk {
    struct tap *tap;
    VkPhysicalDevice physical;
    VkDevice device;
    enum tap_origin origin;
    unsigned count;
    struct tap_vk_copy *copies;
};

TAP_FUNCTION const char *tap_vk_format(VkFormat format)
{
    static const struct {
        VkFormat format;
        const char *name;
    } formats[] = {{VK_FORMAT_R8_UNORM, "r8"},
                   {VK_FORMAT_R8G8_UNORM, "rg8"},
                   {VK_FORMAT_A8B8G8R8_UNORM_PACK32, "rgba8"},
                   {VK_FORMAT_B8G8R8A8_UNORM, "bgra8"},
                   {VK_FORMAT_R8G8B8A8_UNORM, "rgba8"},
                   {VK_FORMAT_A8B8G8R8_SRGB_PACK32, "rgba8_srgb"},
                   {VK_FORMAT_B8G8R8A8_SRGB, "bgra8_srgb"},
                   {VK_FORMAT_R8G8B8A8_SRGB, "rgba8_srgb"},
                   {VK_FORMAT_R16_UNORM, "r16"},
                   {VK_FORMAT_R16G16_UNORM, "rg16"},
                   {VK_FORMAT_R16G16B16A16_UNORM, "rgba16"},
                   {VK_FORMAT_R16_SNORM, "r16_snorm"},
                   {VK_FORMAT_R16G16_SNORM, "rg16_snorm"},
                   {VK_FORMAT_R16G16B16A16_SNORM, "rgba16_snorm"},
                   {VK_FORMAT_R16_SFLOAT, "r16f"},
                   {VK_FORMAT_R16G16_SFLOAT, "rg16f"},
                   {VK_FORMAT_R16G16B16A16_SFLOAT, "rgba16f"},
                   {VK_FORMAT_R32_SFLOAT, "r32f"},
                   {VK_FORMAT_R32G32_SFLOAT, "rg32f"},
                   {VK_FORMAT_R32G32B32A32_SFLOAT, "rgba32f"},
                   {VK_FORMAT_R8_UINT, "r8ui"},
                   {VK_FORMAT_R8G8_UINT, "rg8ui"},
                   {VK_FORMAT_R8G8B8A8_UINT, "rgba8ui"},
                   {VK_FORMAT_R8_SINT, "r8i"},
                   {VK_FORMAT_R8G8_SINT, "rg8i"},
                   {VK_FORMAT_R8G8B8A8_SINT, "rgba8i"},
                   {VK_FORMAT_R16_UINT, "r16ui"},
                   {VK_FORMAT_R16G16_UINT, "rg16ui"},
                   {VK_FORMAT_R16G16B16A16_UINT, "rgba16ui"},
                   {VK_FORMAT_R16_SINT, "r16i"},
                   {VK_FORMAT_R16G16_SINT, "rg16i"},
                   {VK_FORMAT_R16G16B16A16_SINT, "rgba16i"},
                   {VK_FORMAT_R32_UINT, "r32ui"},
                   {VK_FORMAT_R32G32_UINT, "rg32ui"},
                   {VK_FORMAT_R32G32B32A32_UINT, "rgba32ui"},
                   {VK_FORMAT_R32_SINT, "r32i"},
                   {VK_FORMAT_R32G32_SINT, "rg32i"},
                   {VK_FORMAT_R32G32B32A32_SINT, "rgba32i"},
                   {VK_FORMAT_B10G11R11_UFLOAT_PACK32, "r11g11b10f"},
                   {VK_FORMAT_A2B10G10R10_UNORM_PACK32, "rgb10a2"},
                   {VK_FORMAT_D16_UNORM, "d16"},
                   {VK_FORMAT_X8_D24_UNORM_PACK32, "d24"},
                   {VK_FORMAT_D24_UNORM_S8_UINT, "d24"},
                   {VK_FORMAT_D32_SFLOAT, "d32f"},
                   {VK_FORMAT_D32_SFLOAT_S8_UINT, "d32f"}};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i].format == format)
            return formats[i].name;
    return NULL;
}

TAP_FUNCTION int tap_vk_begin(struct tap_vk *taps, struct tap *tap, VkPhysicalDevice physical,
                              VkDevice device)
{
    memset(taps, 0, sizeof *taps);
    taps->tap = tap;
    taps->physical = physical;
    taps->device = device;
    taps->origin = TAP_TOP;
    taps->copies = (struct tap_vk_copy *)calloc(TAP_VK_MOST, sizeof *taps->copies);
    if (!taps->copies && tap)
        tap_fail(tap, "out of memory", "tap_vk_begin");
    return taps->copies != NULL;
}

/* A buffer that the host can read. NULL: the tap has failed. */
TAP_FUNCTION struct tap_vk_copy *tap_vk_target(struct tap_vk *taps, const char *pass,
                                               const char *resource, VkDeviceSize size)
{
    VkPhysicalDeviceMemoryProperties memory;
    VkMemoryRequirements needs;
    VkBufferCreateInfo info;
    VkMemoryAllocateInfo allocation;
    const VkMemoryPropertyFlags wanted =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    if (!taps->tap || taps->tap->failed)
        return NULL;
    if (taps->count == TAP_VK_MOST) {
        tap_fail(taps->tap, "is one copy too many between tap_vk_begin and tap_vk_end", resource);
        return NULL;
    }
    struct tap_vk_copy *copy = &taps->copies[taps->count++];
    memset(&info, 0, sizeof info);
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = size;
    info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    copy->pass = pass;
    copy->resource = resource;
    copy->size = size;
    if (vkCreateBuffer(taps->device, &info, NULL, &copy->buffer) != VK_SUCCESS) {
        tap_fail(taps->tap, "vkCreateBuffer failed", resource);
        return NULL;
    }
    vkGetBufferMemoryRequirements(taps->device, copy->buffer, &needs);
    vkGetPhysicalDeviceMemoryProperties(taps->physical, &memory);
    memset(&allocation, 0, sizeof allocation);
    allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocation.allocationSize = needs.size;
    while (allocation.memoryTypeIndex < memory.memoryTypeCount &&
           (!(needs.memoryTypeBits >> allocation.memoryTypeIndex & 1) ||
            (memory.memoryTypes[allocation.memoryTypeIndex].propertyFlags & wanted) != wanted))
        allocation.memoryTypeIndex++;
    if (allocation.memoryTypeIndex == memory.memoryTypeCount ||
        vkAllocateMemory(taps->device, &allocation, NULL, &copy->memory) != VK_SUCCESS ||
        vkBindBufferMemory(taps->device, copy->buffer, copy->memory, 0) != VK_SUCCESS) {
        tap_fail(taps->tap, "no memory that the host can read", resource);
        return NULL;
    }
    return copy;
}

/* Before (1) the copy: waits for all earlier commands; after it (0): later ones wait, and the host sees it. */
TAP_FUNCTION void tap_vk_wait(VkCommandBuffer commands, int before,
                              const struct tap_vk_image_info *image, VkImageAspectFlags aspect)
{
    VkMemoryBarrier all;
    VkImageMemoryBarrier turn;
    memset(&all, 0, sizeof all);
    all.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
    all.srcAccessMask = before ? VK_ACCESS_MEMORY_WRITE_BIT : VK_ACCESS_TRANSFER_WRITE_BIT;
    all.dstAccessMask =
        before ? VK_ACCESS_TRANSFER_READ_BIT
               : VK_ACCESS_HOST_READ_BIT | VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    memset(&turn, 0, sizeof turn);
    turn.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
    turn.srcQueueFamilyIndex = turn.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    turn.subresourceRange.aspectMask = aspect;
    turn.subresourceRange.levelCount = 1;
    turn.subresourceRange.layerCount = VK_REMAINING_ARRAY_LAYERS;
    if (image) {
        turn.image = image->image;
        turn.subresourceRange.baseMipLevel = image->mip;
        turn.oldLayout = before ? image->layout : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
        turn.newLayout = before ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL : image->layout;
        turn.srcAccessMask = before ? VK_ACCESS_MEMORY_WRITE_BIT : 0;
        turn.dstAccessMask = before ? VK_ACCESS_TRANSFER_READ_BIT
                                    : VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    }
    vkCmdPipelineBarrier(
        commands, before ? VK_PIPELINE_STAGE_ALL_COMMANDS_BIT : VK_PIPELINE_STAGE_TRANSFER_BIT,
        before ? VK_PIPELINE_STAGE_TRANSFER_BIT
               : VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT,
        0, 1, &all, 0, NULL, image ? 1 : 0, &turn);
}

TAP_FUNCTION int tap_vk_is_depth(VkFormat format)
{
    const char *name = tap_vk_format(format);
    return name && name[0] == 'd';
}

/* Records the copy of one mip. */
TAP_FUNCTION void tap_vk_image(struct tap_vk *taps, VkCommandBuffer commands, const char *pass,
                               const char *resource, const struct tap_vk_image_info *image)
{
    const char *format = tap_vk_format(image->format);
    unsigned depth = image->depth ? image->depth : 1, layers = image->layers ? image->layers : 1;
    int is_depth = tap_vk_is_depth(image->format);
    int stencil = image->format == VK_FORMAT_D24_UNORM_S8_UINT ||
                  image->format == VK_FORMAT_D32_SFLOAT_S8_UINT;
    VkImageAspectFlags aspect = is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
    VkBufferImageCopy region;
    if (!taps->tap || taps->tap->failed)
        return;
    if (!format) {
        tap_fail(taps->tap, "has a format that tap_vk_image does not know", resource);
        return;
    }
    struct tap_vk_copy *copy = tap_vk_target(taps, pass, resource,
                                             (VkDeviceSize)tap_texel_size(format) * image->width *
                                                 image->height * depth * layers);
    if (!copy)
        return;
    copy->texels.format = format;
    copy->texels.width = image->width;
    copy->texels.height = image->height;
    copy->texels.layers = depth * layers;
    copy->texels.mip = image->mip;
    copy->texels.origin = taps->origin;
    memset(&region, 0, sizeof region);
    region.imageSubresource.aspectMask = aspect;
    region.imageSubresource.mipLevel = image->mip;
    region.imageSubresource.layerCount = layers;
    region.imageExtent.width = image->width;
    region.imageExtent.height = image->height;
    region.imageExtent.depth = depth;
    if (stencil) /* layouts change for both */
        aspect |= VK_IMAGE_ASPECT_STENCIL_BIT;
    tap_vk_wait(commands, 1, image, aspect);
    vkCmdCopyImageToBuffer(commands, image->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           copy->buffer, 1, &region);
    tap_vk_wait(commands, 0, image, aspect);
}

/* Records the copy of `count` elements of `stride` bytes from `offset` on. Names must live until tap_vk_end. */
TAP_FUNCTION void tap_vk_buffer(struct tap_vk *taps, VkCommandBuffer commands, const char *pass,
                                const char *resource, VkBuffer buffer, VkDeviceSize offset,
                                unsigned count, unsigned stride, const struct tap_field *fields,
                                unsigned field_count)
{
    VkBufferCopy region;
    struct tap_vk_copy *copy = tap_vk_target(taps, pass, resource, (VkDeviceSize)count * stride);
    if (!copy)
        return;
    if (field_count > TAP_VK_MOST_FIELDS) {
        tap_fail(taps->tap, "has more fields than TAP_VK_MOST_FIELDS", resource);
        return;
    }
    copy->is_buffer = 1;
    copy->count = count;
    copy->stride = stride;
    copy->field_count = field_count;
    memcpy(copy->fields, fields, field_count * sizeof *fields);
    region.srcOffset = offset;
    region.dstOffset = 0;
    region.size = copy->size;
    tap_vk_wait(commands, 1, NULL, 0);
    vkCmdCopyBuffer(commands, buffer, copy->buffer, 1, &region);
    tap_vk_wait(commands, 0, NULL, 0);
}

TAP_FUNCTION void tap_vk_store(struct tap_vk *taps, struct tap_vk_copy *copy)
{
    void *bytes;
    if (vkMapMemory(taps->device, copy->memory, 0, VK_WHOLE_SIZE, 0, &bytes) != VK_SUCCESS) {
        tap_fail(taps->tap, "vkMapMemory failed", copy->resource);
        return;
    }
    if (copy->is_buffer) {
        tap_buffer(taps->tap, copy->pass, copy->resource, bytes, copy->count, copy->stride,
                   copy->fields, copy->field_count);
    } else {
        copy->texels.bytes = bytes;
        tap_image(taps->tap, copy->pass, copy->resource, &copy->texels);
    }
    vkUnmapMemory(taps->device, copy->memory);
}

/* Hands all copies to the tap, in their order, and frees them. The fence of their command buffer must be
 * signalled. Then begin again, or close the tap. */
TAP_FUNCTION void tap_vk_end(struct tap_vk *taps)
{
    for (unsigned i = 0; taps->copies && i < taps->count; i++) {
        if (!taps->tap->failed)
            tap_vk_store(taps, &taps->copies[i]);
        vkDestroyBuffer(taps->device, taps->copies[i].buffer, NULL);
        vkFreeMemory(taps->device, taps->copies[i].memory, NULL);
    }
    free(taps->copies);
    taps->copies = NULL;
    taps->count = 0;
}

#endif
