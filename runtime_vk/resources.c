/* Buffers, images, the memory that they share, samplers, and their first content. Called by
 * generated pipelines at resize and by scene.c. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- Memory ---------------------------------------------------------------------------------- */

/* A memory type among `bits` with all `required` properties and if possible the `wanted` ones;
 * -1: none. */
static int find_memory_type(const struct vk_runtime *rt, uint32_t bits,
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

static bool allocate(struct vk_runtime *rt, VkDeviceMemory *memory, const char *name,
                     const VkMemoryRequirements *needs, VkMemoryPropertyFlags required,
                     VkMemoryPropertyFlags wanted)
{
    int type = find_memory_type(rt, needs->memoryTypeBits, required, wanted);
    if (type < 0)
        return vk_error(rt,
                        "%s: the device has no memory that suits all resources which share it; "
                        "keep them apart, or use another --device",
                        name);
    VkDeviceSize heap = rt->memory.memoryHeaps[rt->memory.memoryTypes[type].heapIndex].size;
    VkDeviceSize limit = heap < rt->max_allocation ? heap : rt->max_allocation;
    if (needs->size > limit)
        return vk_error(rt,
                        "%s: %llu bytes, but the device allocates at most %llu at once; use a "
                        "smaller frame, fewer layers or a smaller scene",
                        name, (unsigned long long)needs->size, (unsigned long long)limit);
    VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs->size,
        .memoryTypeIndex = (uint32_t)type,
    };
    return VK(rt, rt->vk.AllocateMemory(rt->device, &info, NULL, memory), name);
}

/* ---- Buffers --------------------------------------------------------------------------------- */

static bool check_range(struct vk_runtime *rt, const char *name, VkDeviceSize size,
                        VkDeviceSize limit)
{
    return size <= limit ||
           vk_error(rt,
                    "buffer %s: %llu bytes, but the device binds at most %llu; use fewer "
                    "elements, or another --device",
                    name, (unsigned long long)size, (unsigned long long)limit);
}

bool dt_vk_buffer_create(struct vk_runtime *rt, struct vk_buffer *buffer,
                         const struct vk_buffer_info *info)
{
    const VkPhysicalDeviceLimits *limits = &rt->properties.limits;
    VkDeviceSize size = info->size < 16 ? 16 : info->size;
    VkDeviceSize whole = info->block > size ? info->block : size;
    if (info->usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT &&
        !check_range(rt, info->name, size, limits->maxStorageBufferRange))
        return false;
    if (info->usage & VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT &&
        !check_range(rt, info->name, whole, limits->maxUniformBufferRange))
        return false;
    VkBufferCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = whole,
        .usage = info->usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
    };
    *buffer =
        (struct vk_buffer){.name = info->name, .size = size, .block = whole > size ? whole : 0};
    if (!VK(rt, rt->vk.CreateBuffer(rt->device, &create, NULL, &buffer->handle), info->name))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_BUFFER, (uint64_t)buffer->handle, info->name);
    return true;
}

void dt_vk_buffer_destroy(struct vk_runtime *rt, struct vk_buffer *buffer)
{
    rt->vk.DestroyBuffer(rt->device, buffer->handle, NULL);
    *buffer = (struct vk_buffer){0};
}

bool vk_mapped_create(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_mapped *mapped,
                      const struct vk_buffer_info *info)
{
    VkMemoryRequirements needs;
    if (!dt_vk_buffer_create(rt, buffer, info))
        return false;
    rt->vk.GetBufferMemoryRequirements(rt->device, buffer->handle, &needs);
    return allocate(rt, &mapped->memory, info->name, &needs,
                    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                    VK_MEMORY_PROPERTY_HOST_CACHED_BIT) && /* read-back without is very slow */
           VK(rt, rt->vk.BindBufferMemory(rt->device, buffer->handle, mapped->memory, 0),
              info->name) &&
           VK(rt, rt->vk.MapMemory(rt->device, mapped->memory, 0, VK_WHOLE_SIZE, 0, &mapped->bytes),
              info->name);
}

void vk_mapped_destroy(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_mapped *mapped)
{
    dt_vk_buffer_destroy(rt, buffer);
    rt->vk.FreeMemory(rt->device, mapped->memory, NULL); /* unmaps */
    *mapped = (struct vk_mapped){0};
}

bool vk_uniform_create(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_mapped *mapped,
                       struct vk_slot *slot, const struct vk_buffer_info *info)
{
    struct vk_slot_user user = {.buffer = buffer};
    if (!rt->hosted)
        return vk_mapped_create(rt, buffer, mapped, info);
    return dt_vk_buffer_create(rt, buffer, info) && dt_vk_slot_bind(rt, slot, &user, 1);
}

void vk_uniform_destroy(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_mapped *mapped,
                        struct vk_slot *slot)
{
    vk_mapped_destroy(rt, buffer, mapped);
    dt_vk_slot_destroy(rt, slot);
}

void *vk_staging(struct vk_runtime *rt, VkDeviceSize size, const char *name)
{
    if (rt->staging_memory.bytes && rt->staging.size >= size)
        return rt->staging_memory.bytes;
    vk_mapped_destroy(rt, &rt->staging, &rt->staging_memory);
    struct vk_buffer_info info = {.name = name, .size = size};
    if (!vk_mapped_create(rt, &rt->staging, &rt->staging_memory, &info)) {
        vk_mapped_destroy(rt, &rt->staging, &rt->staging_memory);
        return NULL;
    }
    rt->staging.name = "staging"; /* outlives the resource that it was made for */
    vk_set_name(rt, VK_OBJECT_TYPE_BUFFER, (uint64_t)rt->staging.handle, rt->staging.name);
    return rt->staging_memory.bytes;
}

/* ---- Images ---------------------------------------------------------------------------------- */

uint32_t vk_texel_size(enum dt_format format)
{
    static const uint8_t sizes[DT_FORMAT_COUNT] = {
        [DT_FORMAT_R8] = 1,         [DT_FORMAT_RG8] = 2,   [DT_FORMAT_RGBA8] = 4,
        [DT_FORMAT_RGBA8_SRGB] = 4, [DT_FORMAT_R16F] = 2,  [DT_FORMAT_RG16F] = 4,
        [DT_FORMAT_RGBA16F] = 8,    [DT_FORMAT_R32F] = 4,  [DT_FORMAT_RG32F] = 8,
        [DT_FORMAT_RGBA32F] = 16,   [DT_FORMAT_R32UI] = 4, [DT_FORMAT_RG32UI] = 8,
        [DT_FORMAT_RGBA32UI] = 16,  [DT_FORMAT_R32I] = 4,  [DT_FORMAT_D32F] = 4,
    };
    return sizes[format];
}

static bool image_fits(struct vk_runtime *rt, const VkImageCreateInfo *create, const char *name)
{
    VkImageFormatProperties can;
    if (!create->extent.width || !create->extent.height || !create->arrayLayers)
        return vk_error(rt,
                        "image %s: %ux%u texels, %u layers, but at least 1 of each is needed; "
                        "check its size in the spec",
                        name, create->extent.width, create->extent.height, create->arrayLayers);
    VkResult result = rt->vk.GetPhysicalDeviceImageFormatProperties(
        rt->physical, create->format, create->imageType, create->tiling, create->usage, 0, &can);
    if (result == VK_ERROR_FORMAT_NOT_SUPPORTED)
        return vk_error(rt,
                        "image %s: the device does not have its format for what the passes do "
                        "with it (VkFormat %d, usage 0x%x); use another format, or another "
                        "--device",
                        name, (int)create->format, create->usage);
    if (!vk_check(rt, result, "vkGetPhysicalDeviceImageFormatProperties", name))
        return false;
    if (create->extent.width > can.maxExtent.width || create->extent.height > can.maxExtent.height)
        return vk_error(rt,
                        "image %s: %ux%u texels, but the device's limit is %ux%u; use a "
                        "smaller size",
                        name, create->extent.width, create->extent.height, can.maxExtent.width,
                        can.maxExtent.height);
    if (create->arrayLayers > can.maxArrayLayers)
        return vk_error(rt, "image %s: %u layers, but the device's limit is %u; use fewer", name,
                        create->arrayLayers, can.maxArrayLayers);
    uint32_t mips = can.maxMipLevels < VK_MAX_MIPS ? can.maxMipLevels : VK_MAX_MIPS;
    if (create->mipLevels > mips)
        return vk_error(rt, "image %s: %u mips, but the limit is %u; use fewer", name,
                        create->mipLevels, mips);
    return true;
}

static struct vk_import *find_import(struct vk_runtime *rt, const char *name)
{
    for (uint32_t i = 0; i < rt->import_count; i++)
        if (strcmp(rt->imports[i].name, name) == 0)
            return &rt->imports[i];
    return NULL;
}

/* A host's image takes the place of one that would have been made. */
static bool adopt_image(struct vk_runtime *rt, struct vk_import *import, struct vk_image *image,
                        const VkImageCreateInfo *wanted)
{
    const struct dt_vk_image *given = &import->given;
    VkImageUsageFlags needed =
        wanted->usage & ~(VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    if (given->format != wanted->format || given->width != wanted->extent.width ||
        given->height != wanted->extent.height || given->layers != wanted->arrayLayers ||
        given->mips != wanted->mipLevels)
        return vk_error(
            rt,
            "image %s: imported with VkFormat %d, %ux%u texels, %u layers, %u mips, but "
            "the pipeline has VkFormat %d, %ux%u, %u, %u; import one like that",
            import->name, (int)given->format, given->width, given->height, given->layers,
            given->mips, (int)wanted->format, wanted->extent.width, wanted->extent.height,
            wanted->arrayLayers, wanted->mipLevels);
    if ((given->usage & needed) != needed)
        return vk_error(
            rt,
            "image %s: imported with usage 0x%x, but its passes need 0x%x; make it with "
            "both",
            import->name, given->usage, needed);
    image->handle = given->image;
    image->imported = true;
    import->image = image;
    return true;
}

bool dt_vk_image_create(struct vk_runtime *rt, struct vk_image *image,
                        const struct vk_image_info *info)
{
    struct vk_import *import = find_import(rt, info->name);
    VkImageCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = vk_format(info->format),
        .extent = {info->width, info->height, 1},
        .mipLevels = info->mips,
        .arrayLayers = info->layers,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = info->usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
    };
    *image = (struct vk_image){
        .name = info->name,
        .format = create.format,
        .texel = info->format,
        .aspect =
            info->format == DT_FORMAT_D32F ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT,
        .width = info->width,
        .height = info->height,
        .layers = info->layers,
        .mips = info->mips,
        .layered = info->layered,
        .layout = VK_IMAGE_LAYOUT_UNDEFINED,
    };
    if (import)
        return adopt_image(rt, import, image, &create);
    if (!image_fits(rt, &create, info->name) ||
        !VK(rt, rt->vk.CreateImage(rt->device, &create, NULL, &image->handle), info->name))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_IMAGE, (uint64_t)image->handle, info->name);
    return true;
}

static bool create_view(struct vk_runtime *rt, const struct vk_image *image, uint32_t mip,
                        uint32_t mips, VkImageView *view)
{
    VkImageViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image->handle,
        .viewType = image->layered ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
        .format = image->format,
        .subresourceRange = {image->aspect, mip, mips, 0, image->layers},
    };
    if (!VK(rt, rt->vk.CreateImageView(rt->device, &info, NULL, view), image->name))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_IMAGE_VIEW, (uint64_t)*view, image->name);
    return true;
}

void dt_vk_image_destroy(struct vk_runtime *rt, struct vk_image *image)
{
    for (uint32_t mip = 0; mip < VK_MAX_MIPS; mip++)
        rt->vk.DestroyImageView(rt->device, image->mip_views[mip], NULL);
    rt->vk.DestroyImageView(rt->device, image->view, NULL);
    if (!image->imported)
        rt->vk.DestroyImage(rt->device, image->handle, NULL);
    for (uint32_t i = 0; i < rt->import_count; i++)
        if (rt->imports[i].image == image)
            rt->imports[i].image = NULL;
    *image = (struct vk_image){0};
}

/* ---- Slots ----------------------------------------------------------------------------------- */

static const char *user_name(const struct vk_slot_user *user)
{
    return user->image ? user->image->name : user->buffer->name;
}

static bool bind_user(struct vk_runtime *rt, VkDeviceMemory memory, const struct vk_slot_user *user)
{
    struct vk_image *image = user->image;
    if (user->buffer)
        return VK(rt, rt->vk.BindBufferMemory(rt->device, user->buffer->handle, memory, 0),
                  user->buffer->name);
    if ((!image->imported &&
         !VK(rt, rt->vk.BindImageMemory(rt->device, image->handle, memory, 0), image->name)) ||
        !create_view(rt, image, 0, image->mips, &image->view))
        return false;
    for (uint32_t mip = 0; mip < image->mips; mip++)
        if (!create_view(rt, image, mip, 1, &image->mip_views[mip]))
            return false;
    return true;
}

bool dt_vk_slot_bind(struct vk_runtime *rt, struct vk_slot *slot, const struct vk_slot_user *users,
                     uint32_t count)
{
    VkMemoryRequirements needs = {.memoryTypeBits = UINT32_MAX};
    const char *name = user_name(&users[0]);
    for (uint32_t i = 0; i < count; i++) {
        VkMemoryRequirements own;
        if (users[i].image && users[i].image->imported)
            continue; /* brings its memory along */
        if (users[i].buffer)
            rt->vk.GetBufferMemoryRequirements(rt->device, users[i].buffer->handle, &own);
        else
            rt->vk.GetImageMemoryRequirements(rt->device, users[i].image->handle, &own);
        needs.memoryTypeBits &= own.memoryTypeBits;
        if (own.size > needs.size) {
            needs.size = own.size;
            name = user_name(&users[i]); /* the one to blame when there is not enough */
        }
    }
    if (needs.size) {
        if (!allocate(rt, &slot->memory, name, &needs, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT))
            return false;
        vk_set_name(rt, VK_OBJECT_TYPE_DEVICE_MEMORY, (uint64_t)slot->memory, name);
    }
    for (uint32_t i = 0; i < count; i++)
        if (!bind_user(rt, slot->memory, &users[i]))
            return false;
    return true;
}

void dt_vk_slot_destroy(struct vk_runtime *rt, struct vk_slot *slot)
{
    rt->vk.FreeMemory(rt->device, slot->memory, NULL);
    *slot = (struct vk_slot){0};
}

/* ---- First content --------------------------------------------------------------------------- */

/* Copies one layer of bytes to every layer and mip: no clear value gives an exact byte pattern
 * in every format. */
static bool fill_image(struct vk_runtime *rt, struct vk_image *image, int byte)
{
    VkDeviceSize size = (VkDeviceSize)image->width * image->height * vk_texel_size(image->texel);
    void *bytes = vk_staging(rt, size, image->name);
    if (!bytes)
        return false;
    memset(bytes, byte, size);
    VkCommandBuffer commands = vk_immediate_begin(rt, image->name);
    if (!commands)
        return false;
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    for (uint32_t mip = 0; mip < image->mips; mip++) {
        for (uint32_t layer = 0; layer < image->layers; layer++) {
            uint32_t width = image->width >> mip, height = image->height >> mip;
            VkBufferImageCopy region = {
                .imageSubresource = {image->aspect, mip, layer, 1},
                .imageExtent = {width ? width : 1, height ? height : 1, 1},
            };
            rt->vk.CmdCopyBufferToImage(commands, rt->staging.handle, image->handle,
                                        VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        }
    }
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_GENERAL);
    return vk_immediate_end(rt, image->name);
}

bool vk_fill_later(struct vk_runtime *rt, const struct vk_fill *fill)
{
    if (rt->fill_count == rt->fill_capacity) {
        uint32_t capacity = 2 * rt->fill_capacity + 8;
        struct vk_fill *grown = realloc(rt->fills, capacity * sizeof *grown);
        if (!grown)
            return vk_error(rt, "%s: out of memory; free some", user_name(&fill->user));
        rt->fills = grown;
        rt->fill_capacity = capacity;
    }
    rt->fills[rt->fill_count++] = *fill;
    return true;
}

bool dt_vk_initialise(struct vk_runtime *rt, const struct vk_slot_user *user, bool history)
{
    int byte = history ? 0 : rt->poison;
    if ((!history && !rt->poison) || (user->image && user->image->imported))
        return true;
    if (rt->hosted)
        return vk_fill_later(rt,
                             &(struct vk_fill){.user = *user, .layout = VK_IMAGE_LAYOUT_GENERAL});
    if (user->image)
        return fill_image(rt, user->image, byte);
    VkCommandBuffer commands = vk_immediate_begin(rt, user->buffer->name);
    if (!commands)
        return false;
    rt->vk.CmdFillBuffer(commands, user->buffer->handle, 0, VK_WHOLE_SIZE,
                         (uint32_t)byte * 0x01010101u);
    return vk_immediate_end(rt, user->buffer->name);
}

/* ---- Samplers -------------------------------------------------------------------------------- */

bool dt_vk_sampler_create(struct vk_runtime *rt, VkSampler *sampler,
                          const struct vk_sampler_info *info)
{
    float limit = rt->properties.limits.maxSamplerAnisotropy;
    if (info->anisotropy > limit)
        return vk_error(rt, "sampler %s: anisotropy %g, but the device's limit is %g; use less",
                        info->name, (double)info->anisotropy, (double)limit);
    VkSamplerCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
        .magFilter = info->filter,
        .minFilter = info->filter,
        .mipmapMode = info->mip_filter,
        .addressModeU = info->wrap,
        .addressModeV = info->wrap,
        .addressModeW = info->wrap,
        .anisotropyEnable = info->anisotropy > 1,
        .maxAnisotropy = info->anisotropy,
        .compareEnable = info->compare,
        .compareOp = VK_COMPARE_OP_LESS_OR_EQUAL,
        .maxLod = VK_LOD_CLAMP_NONE,
    };
    if (!VK(rt, rt->vk.CreateSampler(rt->device, &create, NULL, sampler), info->name))
        return false;
    vk_set_name(rt, VK_OBJECT_TYPE_SAMPLER, (uint64_t)*sampler, info->name);
    return true;
}

void dt_vk_sampler_destroy(struct vk_runtime *rt, VkSampler *sampler)
{
    rt->vk.DestroySampler(rt->device, *sampler, NULL);
    *sampler = VK_NULL_HANDLE;
}
