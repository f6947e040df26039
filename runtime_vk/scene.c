/* Brings a scene to the device: vertices, indices and materials as buffers, all textures as one
 * array image. Called by runtime.c. */
#include "internal.h"

#include <string.h>

/* Zeros behind the `bytes` of data. */
static bool upload_buffer(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_slot *slot,
                          const struct vk_buffer_info *info, const void *data, size_t bytes)
{
    struct vk_slot_user user = {.buffer = buffer};
    VkCommandBuffer commands;
    void *staging;
    if (!dt_vk_buffer_create(rt, buffer, info) || !dt_vk_slot_bind(rt, slot, &user, 1) ||
        !(staging = vk_staging(rt, buffer->size, info->name)))
        return false;
    if (bytes < buffer->size)
        memset(staging, 0, buffer->size);
    if (bytes)
        memcpy(staging, data, bytes);
    if (!(commands = vk_immediate_begin(rt, info->name)))
        return false;
    rt->vk.CmdCopyBuffer(commands, rt->staging.handle, buffer->handle, 1,
                         &(VkBufferCopy){.size = buffer->size});
    return vk_immediate_end(rt, info->name);
}

static uint32_t mip_size(uint32_t size, uint32_t mip)
{
    return size >> mip ? size >> mip : 1;
}

/* Mip by mip, so that the staging buffer is as large as mip 0 of all layers and not larger. */
static bool upload_texels(struct vk_runtime *rt, struct vk_image *image, const uint8_t *texels)
{
    for (uint32_t mip = 0; mip < image->mips; mip++) {
        uint32_t width = mip_size(image->width, mip), height = mip_size(image->height, mip);
        size_t size = (size_t)width * height * image->layers * 4;
        void *staging = vk_staging(rt, size, image->name);
        if (!staging)
            return false;
        memcpy(staging, texels, size);
        texels += size;
        VkCommandBuffer commands = vk_immediate_begin(rt, image->name);
        if (!commands)
            return false;
        if (mip == 0)
            vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        VkBufferImageCopy region = {
            .imageSubresource = {image->aspect, mip, 0, image->layers},
            .imageExtent = {width, height, 1},
        };
        rt->vk.CmdCopyBufferToImage(commands, rt->staging.handle, image->handle,
                                    VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        if (mip + 1 == image->mips)
            vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
        if (!vk_immediate_end(rt, image->name))
            return false;
    }
    return true;
}

static bool upload_textures(struct vk_runtime *rt, const struct dt_scene *scene)
{
    struct vk_image *image = &rt->builtin.textures;
    struct vk_slot_user user = {.image = image};
    struct vk_image_info info = {
        .name = "scene_textures",
        .format = DT_FORMAT_RGBA8_SRGB,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
        .width = scene->texture_width,
        .height = scene->texture_height,
        .layers = scene->texture_layers,
        .mips = scene->texture_mips,
        .layered = true,
    };
    struct vk_sampler_info sampler = {
        .name = "scene_textures",
        .filter = VK_FILTER_LINEAR,
        .mip_filter = VK_SAMPLER_MIPMAP_MODE_LINEAR,
        .wrap = VK_SAMPLER_ADDRESS_MODE_REPEAT,
        .anisotropy = 1,
    };
    return dt_vk_image_create(rt, image, &info) &&
           dt_vk_slot_bind(rt, &rt->texture_slot, &user, 1) &&
           upload_texels(rt, image, scene->texels) &&
           dt_vk_sampler_create(rt, &rt->builtin.texture_sampler, &sampler);
}

bool vk_scene_upload(struct vk_runtime *rt, const struct dt_scene *scene)
{
    struct vk_builtin *builtin = &rt->builtin;
    struct vk_buffer_info vertices = {
        .name = "scene_vertices",
        .size = (VkDeviceSize)scene->vertex_count * sizeof *scene->vertices,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT,
    };
    struct vk_buffer_info indices = {
        .name = "scene_indices",
        .size = (VkDeviceSize)scene->index_count * sizeof *scene->indices,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT,
    };
    struct vk_buffer_info materials = {
        .name = "scene_materials",
        .size = (VkDeviceSize)DT_MAX_MATERIALS * sizeof *scene->materials,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
    };
    if (scene->material_count > DT_MAX_MATERIALS)
        return vk_error(rt, "the scene has %u materials, and shaders see %d: merge some",
                        scene->material_count, DT_MAX_MATERIALS);
    vk_scene_destroy(rt);
    rt->has_scene =
        upload_buffer(rt, &builtin->vertices, &rt->vertex_slot, &vertices, scene->vertices,
                      vertices.size) &&
        upload_buffer(rt, &builtin->indices, &rt->index_slot, &indices, scene->indices,
                      indices.size) &&
        upload_buffer(rt, &builtin->materials, &rt->material_slot, &materials, scene->materials,
                      scene->material_count * sizeof *scene->materials) &&
        upload_textures(rt, scene);
    rt->index_count = scene->index_count;
    vk_mapped_destroy(rt, &rt->staging, &rt->staging_memory); /* as large as the scene: let it go */
    return rt->has_scene;
}

void vk_scene_destroy(struct vk_runtime *rt)
{
    dt_vk_buffer_destroy(rt, &rt->builtin.vertices);
    dt_vk_buffer_destroy(rt, &rt->builtin.indices);
    dt_vk_buffer_destroy(rt, &rt->builtin.materials);
    dt_vk_image_destroy(rt, &rt->builtin.textures);
    dt_vk_sampler_destroy(rt, &rt->builtin.texture_sampler);
    dt_vk_slot_destroy(rt, &rt->vertex_slot);
    dt_vk_slot_destroy(rt, &rt->index_slot);
    dt_vk_slot_destroy(rt, &rt->material_slot);
    dt_vk_slot_destroy(rt, &rt->texture_slot);
    rt->has_scene = false;
    rt->index_count = 0;
}
