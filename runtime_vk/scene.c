/* Uploads a scene: vertices, indices and materials as buffers, all textures as one array image. */
#include "internal.h"

#include <string.h>

/* Uploads `bytes` of data; the rest of the buffer is zero. */
static bool upload_buffer(struct dt_vk_runtime *rt, struct vk_buffer *buffer,
                          const struct vk_buffer_info *info, const void *data, size_t bytes)
{
    VkCommandBuffer commands;
    void *staging;
    if (!vk_buffer_create_own(rt, buffer, info, false) ||
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

/* Uploads mip by mip, so that the staging buffer needs only the size of mip 0 of all layers. */
static bool upload_texels(struct dt_vk_runtime *rt, struct vk_image *image, const uint8_t *texels)
{
    for (uint32_t mip = 0; mip < image->mips; mip++) {
        const VkBufferImageCopy region = vk_mip_region(image, mip);
        size_t size =
            (size_t)region.imageExtent.width * region.imageExtent.height * image->layers * 4;
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
        rt->vk.CmdCopyBufferToImage(commands, rt->staging.handle, image->handle,
                                    VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        if (mip + 1 == image->mips)
            vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
        if (!vk_immediate_end(rt, image->name))
            return false;
    }
    return true;
}

static bool upload_textures(struct dt_vk_runtime *rt, const struct dt_scene *scene)
{
    struct vk_image *image = &rt->builtin.textures;
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
    return vk_image_create_own(rt, image, &info) && upload_texels(rt, image, scene->texels);
}

bool vk_scene_upload(struct dt_core *core, const struct dt_scene *scene)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_builtin *builtin = &rt->builtin;
    struct vk_buffer_info vertices = {
        .name = "scene_vertices",
        .size = (VkDeviceSize)scene->vertex_count * sizeof *scene->vertices,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
    };
    struct vk_buffer_info indices = {
        .name = "scene_indices",
        .size = (VkDeviceSize)scene->index_count * sizeof *scene->indices,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
    };
    struct vk_buffer_info materials = {
        .name = "scene_materials",
        .size = (VkDeviceSize)DT_MAX_MATERIALS * sizeof *scene->materials,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
    };
    struct vk_buffer_info objects = {
        .name = "scene_objects",
        .size =
            (VkDeviceSize)(scene->object_count ? scene->object_count : 1) * sizeof *scene->objects,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
    };
    vk_scene_destroy(rt);
    core->has_scene =
        upload_buffer(rt, &builtin->vertices, &vertices, scene->vertices, vertices.size) &&
        upload_buffer(rt, &builtin->indices, &indices, scene->indices, indices.size) &&
        upload_buffer(rt, &builtin->materials, &materials, scene->materials,
                      scene->material_count * sizeof *scene->materials) &&
        upload_buffer(rt, &builtin->objects, &objects, scene->objects,
                      scene->object_count * sizeof *scene->objects) &&
        upload_textures(rt, scene) &&
        vk_scene_attributes(rt, (const struct dt_vk_attribute[DT_ATTRIBUTES]){0});
    core->has_objects = core->has_scene;
    rt->index_count = scene->index_count;
    vk_buffer_destroy(rt, &rt->staging); /* as large as the scene: free it */
    return core->has_scene;
}

void vk_scene_destroy(struct dt_vk_runtime *rt)
{
    vk_buffer_destroy(rt, &rt->builtin.vertices);
    vk_buffer_destroy(rt, &rt->builtin.indices);
    vk_buffer_destroy(rt, &rt->builtin.materials);
    vk_buffer_destroy(rt, &rt->builtin.objects);
    vk_image_destroy(rt, &rt->builtin.textures);
    rt->core.has_scene = rt->core.has_objects = false;
    rt->index_count = 0;
}
