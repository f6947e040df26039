/* Uploads a scene: vertices, indices and materials as buffers, all textures as one array image. */
#include "internal.h"

/* Mip by mip, so that the staging buffer needs only the size of mip 0 of all layers. */
static bool upload_textures(struct dt_vk_runtime *rt, const struct dt_scene *scene)
{
    struct vk_image *image = &rt->builtin.textures;
    const uint8_t *texels = scene->texels;
    const struct vk_image_info info = {
        .name = "scene textures",
        .format = DT_FORMAT_RGBA8_SRGB,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
        .width = scene->texture_width,
        .height = scene->texture_height,
        .layers = scene->texture_layers,
        .mips = scene->texture_mips,
        .layered = true,
    };
    bool good = vk_image_create_own(rt, image, &info);
    for (uint32_t mip = 0; good && mip < image->mips; mip++) {
        const VkExtent3D extent = vk_mip_region(image, mip).imageExtent;
        size_t size = (size_t)extent.width * extent.height * image->layers * 4;
        good = vk_image_write(rt, image, mip, texels, size,
                              mip + 1 < image->mips ? VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL
                                                    : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
        texels += size;
    }
    return good;
}

/* Passes may take each buffer as a storage buffer, and: */
static VkBufferUsageFlags usage_of(uint16_t resource)
{
    switch (resource) {
    case DT_SCENE_VERTICES:
        return VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    case DT_SCENE_INDICES:
        return VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    case DT_SCENE_MATERIALS:
        return VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    default:
        return 0;
    }
}

bool vk_scene_upload(struct dt_core *core, const struct dt_scene *scene,
                     const struct dt_scene_buffer buffers[DT_SCENE_BUFFERS])
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    bool good = true;
    vk_scene_destroy(rt);
    for (int i = 0; good && i < DT_SCENE_BUFFERS; i++) {
        struct vk_buffer *buffer = vk_buffer_at(rt, buffers[i].resource);
        const struct vk_buffer_info info = {
            .name = buffers[i].name,
            .size = buffers[i].size,
            .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | usage_of(buffers[i].resource),
        };
        good = vk_buffer_create_own(rt, buffer, &info, false) &&
               vk_buffer_write(rt, buffer, buffers[i].data, buffers[i].data_size);
    }
    good = good && upload_textures(rt, scene) &&
           vk_scene_attributes(rt, (const struct dt_vk_attribute[DT_ATTRIBUTES]){0});
    vk_buffer_destroy(rt, &rt->staging); /* as large as the scene: free it */
    return good;
}
