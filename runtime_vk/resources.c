/* Buffers, images, memory, samplers, and bytes that fill them. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- Memory ---------------------------------------------------------------------------------- */

/* A memory type among `bits` with all `required` properties and if possible the `wanted` ones;
 * -1: none. */
static int find_memory_type(const struct dt_vk_runtime *rt, uint32_t bits,
                            VkMemoryPropertyFlags required, VkMemoryPropertyFlags wanted)
{
    int found = -1;
    for (uint32_t i = 0; i < rt->memory.memoryTypeCount; i++) {
        VkMemoryPropertyFlags flags = rt->memory.memoryTypes[i].propertyFlags;
        if (!(bits & 1u << i) || (flags & required) != required)
            continue;
        if ((flags & wanted) == wanted)
            return (int)i;
        if (found < 0)
            found = (int)i;
    }
    return found;
}

static bool allocate_memory(struct dt_vk_runtime *rt, struct dt_vk_memory *memory, const char *name,
                            const VkMemoryRequirements *needs, VkMemoryPropertyFlags required,
                            VkMemoryPropertyFlags wanted)
{
    int type = find_memory_type(rt, needs->memoryTypeBits, required, wanted);
    if (type < 0)
        return dt_error(
            &rt->core,
            "%s: no memory type of the device suits all resources that share this memory; "
            "use another device",
            name);
    VkDeviceSize heap = rt->memory.memoryHeaps[rt->memory.memoryTypes[type].heapIndex].size;
    VkDeviceSize limit = heap < rt->max_allocation ? heap : rt->max_allocation;
    if (needs->size > limit)
        return dt_error(&rt->core,
                        "%s: %llu bytes, but the device allocates at most %llu at once; use a "
                        "smaller frame, fewer layers or a smaller scene",
                        name, (unsigned long long)needs->size, (unsigned long long)limit);
    VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs->size,
        .memoryTypeIndex = (uint32_t)type,
    };
    return VK(rt, rt->vk.AllocateMemory(rt->device, &info, rt->callbacks, &memory->memory), name);
}

bool vk_memory_create(struct dt_vk_runtime *rt, struct dt_vk_memory *memory,
                      const VkMemoryRequirements *needs, const char *name)
{
    const struct dt_vk_allocator *host = &rt->allocator;
    struct dt_vk_memory given = {0};
    if (host->allocate) {
        if (!vk_check(rt, host->allocate(host->user, needs, name, &given), "allocate", name))
            return false;
        *memory = given;
        return true;
    }
    if (!allocate_memory(rt, memory, name, needs, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_DEVICE_MEMORY, (uint64_t)memory->memory, name);
    return true;
}

void vk_memory_destroy(struct dt_vk_runtime *rt, struct dt_vk_memory *memory)
{
    const struct dt_vk_allocator *host = &rt->allocator;
    if (host->free && memory->memory)
        host->free(host->user, memory);
    else
        rt->vk.FreeMemory(rt->device, memory->memory, rt->callbacks); /* unmaps */
    *memory = (struct dt_vk_memory){0};
}

/* ---- Buffers --------------------------------------------------------------------------------- */

/* Memory of a small buffer: shaders that read four uints at once stay inside. Bindings have the
 * buffer's own size, from which shaders compute length(). */
enum { LEAST_BYTES = 16 };

bool vk_buffer_create(struct dt_vk_runtime *rt, struct vk_buffer *buffer,
                      const struct vk_buffer_info *info)
{
    VkDeviceSize block = info->block > info->size ? info->block : 0;
    VkDeviceSize whole = block ? block : info->size;
    VkBufferCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = whole < LEAST_BYTES ? LEAST_BYTES : whole,
        .usage = info->usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
    };
    *buffer = (struct vk_buffer){.name = info->name,
                                 .size = info->size ? info->size
                                                    : LEAST_BYTES, /* no binding has 0 bytes */
                                 .block = block,
                                 .usage = create.usage};
    if (!VK(rt, rt->vk.CreateBuffer(rt->device, &create, rt->callbacks, &buffer->handle),
            info->name))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_BUFFER, (uint64_t)buffer->handle, info->name);
    return true;
}

bool vk_buffer_import(const struct dt_vk_runtime *rt, struct vk_buffer *buffer, const char *name,
                      const struct dt_vk_range *range, VkDeviceSize least)
{
    VkDeviceSize alignment = rt->properties.limits.minStorageBufferOffsetAlignment;
    if (alignment < rt->properties.limits.minUniformBufferOffsetAlignment)
        alignment = rt->properties.limits.minUniformBufferOffsetAlignment;
    if (alignment < rt->properties.limits.minTexelBufferOffsetAlignment)
        alignment = rt->properties.limits.minTexelBufferOffsetAlignment;
    VkDeviceSize size = range->buffer ? range->size : 0;
    if (!dt_front_range(&rt->core, name, range->offset, size, least, alignment))
        return false;
    *buffer = (struct vk_buffer){.name = name,
                                 .handle = range->buffer,
                                 .offset = range->offset,
                                 .size = range->size,
                                 .imported = true};
    return true;
}

bool vk_buffer_bind(struct dt_vk_runtime *rt, const struct vk_buffer *buffer,
                    const struct dt_vk_memory *memory)
{
    return buffer->imported ||
           VK(rt,
              rt->vk.BindBufferMemory(rt->device, buffer->handle, memory->memory, memory->offset),
              buffer->name);
}

static bool map(struct dt_vk_runtime *rt, struct vk_buffer *buffer,
                const VkMemoryRequirements *needs)
{
    return allocate_memory(rt, &buffer->memory, buffer->name, needs,
                           VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                               VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                           VK_MEMORY_PROPERTY_HOST_CACHED_BIT) && /* uncached read-back is slow */
           VK(rt,
              rt->vk.MapMemory(rt->device, buffer->memory.memory, 0, VK_WHOLE_SIZE, 0,
                               &buffer->bytes),
              buffer->name);
}

bool vk_buffer_create_own(struct dt_vk_runtime *rt, struct vk_buffer *buffer,
                          const struct vk_buffer_info *info, bool mapped)
{
    VkMemoryRequirements needs;
    if (!vk_buffer_create(rt, buffer, info))
        return false;
    rt->vk.GetBufferMemoryRequirements(rt->device, buffer->handle, &needs);
    return (mapped ? map(rt, buffer, &needs)
                   : vk_memory_create(rt, &buffer->memory, &needs, info->name)) &&
           vk_buffer_bind(rt, buffer, &buffer->memory);
}

bool vk_buffer_texels(struct dt_vk_runtime *rt, struct vk_buffer *buffer, uint16_t resource)
{
    bool vertices = resource == DT_SCENE_VERTICES;
    VkDeviceSize texel = vertices ? DT_VERTEX_TEXEL : DT_INDEX_TEXEL;
    VkDeviceSize count = buffer->size / texel;
    const VkBufferViewCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
        .buffer = buffer->handle,
        .format = vertices ? VK_FORMAT_R32G32_UINT : VK_FORMAT_R32_UINT,
        .offset = buffer->offset,
        .range = count * texel,
    };
    return buffer->texels ||
           (dt_front_texels(&rt->core, buffer->name, count) &&
            VK(rt, rt->vk.CreateBufferView(rt->device, &create, rt->callbacks, &buffer->texels),
               buffer->name));
}

void vk_buffer_destroy(struct dt_vk_runtime *rt, struct vk_buffer *buffer)
{
    rt->vk.DestroyBufferView(rt->device, buffer->texels, rt->callbacks);
    if (!buffer->imported)
        rt->vk.DestroyBuffer(rt->device, buffer->handle, rt->callbacks);
    vk_memory_destroy(rt, &buffer->memory);
    *buffer = (struct vk_buffer){0};
}

void *vk_staging(struct dt_vk_runtime *rt, VkDeviceSize size, const char *name)
{
    const struct vk_buffer_info info = {.name = name, .size = size};
    if (rt->staging.bytes && rt->staging.size >= size)
        return rt->staging.bytes;
    vk_buffer_destroy(rt, &rt->staging);
    if (!vk_buffer_create_own(rt, &rt->staging, &info, true)) {
        vk_buffer_destroy(rt, &rt->staging);
        return NULL;
    }
    rt->staging.name = "staging"; /* outlives the resource that it was made for */
    vk_set_name(rt, VK_OBJECT_TYPE_BUFFER, (uint64_t)rt->staging.handle, rt->staging.name);
    return rt->staging.bytes;
}

/* ---- Images ---------------------------------------------------------------------------------- */

VkFormat vk_format(enum dt_format format)
{
    static const VkFormat formats[] = {
#define DT_FORMAT(ENUMERATOR, name, channels, bytes, kind, qualifier, vulkan, ...) vulkan,
#include "formats.def"
    };
    return formats[format];
}

VkImageLayout vk_layout(unsigned layout)
{
    static const VkImageLayout layouts[] = {
        [DT_LAYOUT_NONE] = VK_IMAGE_LAYOUT_UNDEFINED,
        [DT_LAYOUT_GENERAL] = VK_IMAGE_LAYOUT_GENERAL,
        [DT_LAYOUT_READ] = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        [DT_LAYOUT_COLOR] = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        [DT_LAYOUT_DEPTH] = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
    };
    return layouts[layout];
}

/* The front checks sizes of resources, but neither formats nor the scene's textures. */
static bool image_fits(struct dt_vk_runtime *rt, const VkImageCreateInfo *create, const char *name)
{
    VkImageFormatProperties can;
    VkResult result = rt->vk.GetPhysicalDeviceImageFormatProperties(
        rt->physical, create->format, create->imageType, create->tiling, create->usage,
        create->flags, &can);
    if (result == VK_ERROR_FORMAT_NOT_SUPPORTED)
        return dt_error(&rt->core,
                        "image %s: the device does not support VkFormat %d with usage 0x%x; use "
                        "another format, or another device",
                        name, (int)create->format, create->usage);
    if (!vk_check(rt, result, "vkGetPhysicalDeviceImageFormatProperties", name))
        return false;
    uint32_t mips = can.maxMipLevels < DT_MAX_MIPS ? can.maxMipLevels : DT_MAX_MIPS;
    return (create->extent.width <= can.maxExtent.width &&
            create->extent.height <= can.maxExtent.height &&
            create->extent.depth <= can.maxExtent.depth &&
            create->arrayLayers <= can.maxArrayLayers && create->mipLevels <= mips) ||
           dt_error(&rt->core,
                    "image %s: %ux%ux%u texels, %u layers, %u mips, but %s allows %ux%ux%u, %u, "
                    "%u; use a smaller one",
                    name, create->extent.width, create->extent.height, create->extent.depth,
                    create->arrayLayers, create->mipLevels, rt->core.device.name,
                    can.maxExtent.width, can.maxExtent.height, can.maxExtent.depth,
                    can.maxArrayLayers, mips);
}

/* Uses a host's image instead of creating one; checks that it matches. */
static bool adopt_image(struct dt_vk_runtime *rt, const struct dt_vk_image *given,
                        struct vk_image *image, const VkImageCreateInfo *wanted)
{
    uint32_t layers = wanted->arrayLayers * wanted->extent.depth;
    if (given->format != wanted->format || given->width != wanted->extent.width ||
        given->height != wanted->extent.height || given->layers != layers ||
        given->mips != wanted->mipLevels)
        return dt_error(
            &rt->core,
            "image %s: imported with VkFormat %d, %ux%u texels, %u layers, %u mips, but "
            "the pipeline has VkFormat %d, %ux%u, %u, %u; import one like that",
            image->name, (int)given->format, given->width, given->height, given->layers,
            given->mips, (int)wanted->format, wanted->extent.width, wanted->extent.height, layers,
            wanted->mipLevels);
    if ((given->usage & wanted->usage) != wanted->usage)
        return dt_error(
            &rt->core,
            "image %s: imported with usage 0x%x, but its passes need 0x%x; make it with both",
            image->name, given->usage, wanted->usage);
    image->handle = given->image;
    image->imported = true;
    return true;
}

bool vk_is_cube(enum dt_shape shape)
{
    return shape == DT_SHAPE_CUBE || shape == DT_SHAPE_CUBE_ARRAY;
}

/* Those of sRGB may have views without it. */
static VkImageCreateInfo image_create_info(const struct vk_image_info *info)
{
    static const VkFormat formats[] = {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R8G8B8A8_UNORM};
    static const VkImageFormatListCreateInfo views = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_FORMAT_LIST_CREATE_INFO,
        .viewFormatCount = 2,
        .pViewFormats = formats};
    bool volume = info->shape == DT_SHAPE_3D, codes = info->format == DT_FORMAT_RGBA8_SRGB;
    return (VkImageCreateInfo){
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .pNext = codes ? &views : NULL,
        .flags = (vk_is_cube(info->shape) ? VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT : 0u) |
                 (codes ? VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT : 0u),
        .imageType = volume ? VK_IMAGE_TYPE_3D : VK_IMAGE_TYPE_2D,
        .format = vk_format(info->format),
        .extent = {info->width, info->height, volume ? info->layers : 1},
        .mipLevels = info->mips,
        .arrayLayers = volume ? 1 : info->layers,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = info->usage,
        .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
    };
}

bool vk_image_create(struct dt_vk_runtime *rt, struct vk_image *image,
                     const struct vk_image_info *info)
{
    VkImageCreateInfo create = image_create_info(info);
    *image = (struct vk_image){
        .name = info->name,
        .format = create.format,
        .texel = info->format,
        .aspect =
            info->format == DT_FORMAT_D32F ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT,
        .width = info->width,
        .height = info->height,
        .depth = create.extent.depth,
        .layers = create.arrayLayers,
        .mips = info->mips,
        .shape = info->shape,
        .layered = info->layered,
        .by_layer = info->by_layer,
        .layout = VK_IMAGE_LAYOUT_UNDEFINED,
    };
    if (info->import) {
        image->usage = info->import->usage;
        return adopt_image(rt, info->import, image, &create);
    }
    image->usage = create.usage |= VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                   VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                   VK_IMAGE_USAGE_SAMPLED_BIT; /* for dt_vk_get_resource */
    if (!image_fits(rt, &create, info->name) ||
        !VK(rt, rt->vk.CreateImage(rt->device, &create, rt->callbacks, &image->handle), info->name))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_IMAGE, (uint64_t)image->handle, info->name);
    return true;
}

static bool create_view_as(struct dt_vk_runtime *rt, const struct vk_image *image, VkFormat format,
                           VkImageViewType type, VkImageSubresourceRange range, VkImageView *view)
{
    VkImageViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image->handle,
        .viewType = type,
        .format = format,
        .subresourceRange = range,
    };
    if (!VK(rt, rt->vk.CreateImageView(rt->device, &info, rt->callbacks, view), image->name))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_IMAGE_VIEW, (uint64_t)*view, image->name);
    return true;
}

static bool create_view(struct dt_vk_runtime *rt, const struct vk_image *image,
                        VkImageViewType type, VkImageSubresourceRange range, VkImageView *view)
{
    return create_view_as(rt, image, image->format, type, range, view);
}

bool vk_image_codes(struct dt_vk_runtime *rt, struct vk_image *image)
{
    const VkImageSubresourceRange all = {image->aspect, 0, image->mips, 0, image->layers};
    if (!image->codes && !image->handle)
        return dt_error(&rt->core, "%s: passes read codes; give texture_codes, a view without sRGB",
                        image->name);
    return image->codes ||
           create_view_as(rt, image, VK_FORMAT_R8G8B8A8_UNORM,
                          image->layered ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D, all,
                          &image->codes);
}

static bool create_layer_views(struct dt_vk_runtime *rt, struct vk_image *image)
{
    uint32_t count = image->mips * image->layers;
    image->layer_views = calloc(count + 1, sizeof *image->layer_views);
    if (!image->layer_views)
        return dt_error(&rt->core, "image %s: out of memory", image->name);
    for (uint32_t i = 0; i < count; i++)
        if (!create_view(rt, image, VK_IMAGE_VIEW_TYPE_2D,
                         (VkImageSubresourceRange){image->aspect, i / image->layers, 1,
                                                   i % image->layers, 1},
                         &image->layer_views[i]))
            return false;
    return true;
}

VkImageView vk_image_view(const struct vk_image *image, uint32_t mip, bool one_layer,
                          uint32_t layer)
{
    return one_layer ? image->layer_views[mip * image->layers + layer] : image->mip_views[mip];
}

VkBufferImageCopy vk_mip_region(const struct vk_image *image, uint32_t mip)
{
    uint32_t width = image->width >> mip, height = image->height >> mip;
    uint32_t depth = image->depth >> mip;
    return (VkBufferImageCopy){
        .imageSubresource = {image->aspect, mip, 0, image->layers},
        .imageExtent = {width ? width : 1, height ? height : 1, depth ? depth : 1},
    };
}

bool vk_image_bind(struct dt_vk_runtime *rt, struct vk_image *image,
                   const struct dt_vk_memory *memory)
{
    const VkImageViewType types[] = {
        [DT_SHAPE_2D] = image->layered ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
        [DT_SHAPE_3D] = VK_IMAGE_VIEW_TYPE_3D,
        [DT_SHAPE_CUBE] = VK_IMAGE_VIEW_TYPE_CUBE,
        [DT_SHAPE_CUBE_ARRAY] = VK_IMAGE_VIEW_TYPE_CUBE_ARRAY,
    };
    VkImageViewType type = types[image->shape];
    bool cube = vk_is_cube(image->shape);
    if ((!image->imported &&
         !VK(rt, rt->vk.BindImageMemory(rt->device, image->handle, memory->memory, memory->offset),
             image->name)) ||
        !create_view(rt, image, type,
                     (VkImageSubresourceRange){image->aspect, 0, image->mips, 0, image->layers},
                     &image->view))
        return false;
    for (uint32_t mip = 0; mip < image->mips; mip++) {
        VkImageSubresourceRange range = {image->aspect, mip, 1, 0, image->layers};
        if (!create_view(rt, image, cube ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : type, range,
                         &image->mip_views[mip]) ||
            (cube && !create_view(rt, image, type, range, &image->cube_views[mip])))
            return false;
    }
    return !image->by_layer || create_layer_views(rt, image);
}

bool vk_image_create_own(struct dt_vk_runtime *rt, struct vk_image *image,
                         const struct vk_image_info *info)
{
    VkMemoryRequirements needs;
    if (!vk_image_create(rt, image, info))
        return false;
    rt->vk.GetImageMemoryRequirements(rt->device, image->handle, &needs);
    return vk_memory_create(rt, &image->memory, &needs, info->name) &&
           vk_image_bind(rt, image, &image->memory);
}

void vk_image_destroy(struct dt_vk_runtime *rt, struct vk_image *image)
{
    for (uint32_t mip = 0; mip < image->mips; mip++) {
        rt->vk.DestroyImageView(rt->device, image->mip_views[mip], rt->callbacks);
        rt->vk.DestroyImageView(rt->device, image->cube_views[mip], rt->callbacks);
    }
    for (uint32_t i = 0; image->layer_views && i < image->mips * image->layers; i++)
        rt->vk.DestroyImageView(rt->device, image->layer_views[i], rt->callbacks);
    free(image->layer_views);
    rt->vk.DestroyImageView(rt->device, image->view, rt->callbacks);
    rt->vk.DestroyImageView(rt->device, image->codes, rt->callbacks);
    if (!image->imported)
        rt->vk.DestroyImage(rt->device, image->handle, rt->callbacks);
    vk_memory_destroy(rt, &image->memory);
    *image = (struct vk_image){0};
}

/* ---- Content --------------------------------------------------------------------------------- */

/* The data in the staging buffer, and behind them zeros up to `whole` bytes; begins a command buffer. NULL
 * after an error. */
static VkCommandBuffer begin_write(struct dt_vk_runtime *rt, const char *name, const void *data,
                                   size_t size, VkDeviceSize whole)
{
    char *staging = vk_staging(rt, whole, name);
    if (!staging)
        return NULL;
    if (size)
        memcpy(staging, data, size);
    memset(staging + size, 0, whole - size);
    return vk_immediate_begin(rt, name);
}

bool vk_buffer_write(struct dt_vk_runtime *rt, const struct vk_buffer *buffer, const void *data,
                     size_t size)
{
    VkCommandBuffer commands = begin_write(rt, buffer->name, data, size, buffer->size);
    if (!commands)
        return false;
    rt->vk.CmdCopyBuffer(commands, rt->staging.handle, buffer->handle, 1,
                         &(VkBufferCopy){.size = buffer->size});
    return vk_immediate_end(rt, buffer->name);
}

bool vk_image_write(struct dt_vk_runtime *rt, struct vk_image *image, uint32_t mip,
                    const void *data, size_t size, VkImageLayout layout)
{
    const VkBufferImageCopy region = vk_mip_region(image, mip);
    VkCommandBuffer commands = begin_write(rt, image->name, data, size, size);
    if (!commands)
        return false;
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    rt->vk.CmdCopyBufferToImage(commands, rt->staging.handle, image->handle, image->layout, 1,
                                &region);
    if (layout != VK_IMAGE_LAYOUT_UNDEFINED) /* no transition to it exists */
        vk_transition(rt, commands, image, layout);
    return vk_immediate_end(rt, image->name);
}

bool vk_buffer_fill(struct dt_vk_runtime *rt, const struct vk_buffer *buffer, int byte)
{
    VkCommandBuffer commands = vk_immediate_begin(rt, buffer->name);
    if (!commands)
        return false;
    rt->vk.CmdFillBuffer(commands, buffer->handle, 0, VK_WHOLE_SIZE, (uint32_t)byte * 0x01010101u);
    return vk_immediate_end(rt, buffer->name);
}

/* Copies one layer of bytes to every layer and mip: no clear value gives an exact byte pattern
 * in every format. */
bool vk_image_fill(struct dt_vk_runtime *rt, struct vk_image *image, int byte)
{
    enum { TEXEL = 16 }; /* bytes of the largest format */
    VkDeviceSize size = (VkDeviceSize)image->width * image->height * image->depth * TEXEL;
    void *bytes = vk_staging(rt, size, image->name);
    if (!bytes)
        return false;
    memset(bytes, byte, size);
    VkCommandBuffer commands = vk_immediate_begin(rt, image->name);
    if (!commands)
        return false;
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    for (uint32_t i = 0; i < image->mips * image->layers; i++) {
        VkBufferImageCopy region = vk_mip_region(image, i / image->layers);
        region.imageSubresource.baseArrayLayer = i % image->layers;
        region.imageSubresource.layerCount = 1;
        rt->vk.CmdCopyBufferToImage(commands, rt->staging.handle, image->handle,
                                    VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    }
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_GENERAL);
    return vk_immediate_end(rt, image->name);
}

/* ---- Samplers -------------------------------------------------------------------------------- */

bool vk_sampler_create(struct dt_core *core, void *made, const struct dt_sampler *info)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    VkSampler *sampler = made;
    static const VkSamplerAddressMode wraps[] = {
        [DT_WRAP_CLAMP] = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
        [DT_WRAP_REPEAT] = VK_SAMPLER_ADDRESS_MODE_REPEAT,
        [DT_WRAP_MIRROR] = VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT,
        [DT_WRAP_BORDER] = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER,
    };
    static const VkBorderColor borders[] = {
        [DT_BORDER_TRANSPARENT_BLACK] = VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK,
        [DT_BORDER_OPAQUE_BLACK] = VK_BORDER_COLOR_FLOAT_OPAQUE_BLACK,
        [DT_BORDER_OPAQUE_WHITE] = VK_BORDER_COLOR_FLOAT_OPAQUE_WHITE,
    };
    VkFilter filter = info->linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
    VkSamplerCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
        .magFilter = filter,
        .minFilter = filter,
        .mipmapMode =
            info->linear_mip ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST,
        .addressModeU = wraps[info->wrap],
        .addressModeV = wraps[info->wrap],
        .addressModeW = wraps[info->wrap],
        .anisotropyEnable = info->anisotropy > 1,
        .maxAnisotropy = info->anisotropy,
        .compareEnable = info->compare,
        .compareOp = VK_COMPARE_OP_LESS_OR_EQUAL,
        .maxLod = VK_LOD_CLAMP_NONE,
        .borderColor = borders[info->border],
    };
    if (!VK(rt, rt->vk.CreateSampler(rt->device, &create, rt->callbacks, sampler), info->name))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_SAMPLER, (uint64_t)*sampler, info->name);
    return true;
}

void vk_sampler_destroy(struct dt_core *core, void *made)
{
    const struct dt_vk_runtime *rt = vk_runtime_of(core);
    VkSampler *sampler = made;
    rt->vk.DestroySampler(rt->device, *sampler, rt->callbacks);
    *sampler = VK_NULL_HANDLE;
}
