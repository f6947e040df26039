/* Limits of devices that a pipeline can exceed: one table for `diptych-gen --needs` and for the check
 * that each runtime makes. Included by panel.h.
 *
 * A row: the name; what a pass needs, in words; Vulkan's member of VkPhysicalDeviceLimits; OpenGL's
 * names, for dispatches and for draws (GL_NONE: OpenGL has no such limit), and the index of the query,
 * -1: none. Then what is promised: by the profile VP_KHR_roadmap_2022, by every Vulkan 1.3, which is
 * also what VP_ANDROID_vulkan_profile_2022 has, and by MoltenVK 1.4.3 on GPUs of Apple (its
 * MVKDevice.mm); by every OpenGL 4.6. Of clip distances and indirect draws: with the feature, which is
 * a need of its own. */
#ifndef DIPTYCH_DEVICE_LIMITS_H
#define DIPTYCH_DEVICE_LIMITS_H

/* clang-format off */
#define DT_DEVICE_LIMITS(ROW)                                                                        \
    ROW(SHARED_BYTES, "bytes of shared memory", maxComputeSharedMemorySize,                          \
        GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, -1,                    \
        16384, 16384, 32768, 32768)                                                                  \
    ROW(INVOCATIONS, "invocations in a workgroup", maxComputeWorkGroupInvocations,                   \
        GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, -1,            \
        256, 128, 1024, 1024)                                                                        \
    ROW(LOCAL_X, "invocations in a workgroup along x", maxComputeWorkGroupSize[0],                   \
        GL_MAX_COMPUTE_WORK_GROUP_SIZE, GL_MAX_COMPUTE_WORK_GROUP_SIZE, 0, 256, 128, 1024, 1024)     \
    ROW(LOCAL_Y, "invocations in a workgroup along y", maxComputeWorkGroupSize[1],                   \
        GL_MAX_COMPUTE_WORK_GROUP_SIZE, GL_MAX_COMPUTE_WORK_GROUP_SIZE, 1, 256, 128, 1024, 1024)     \
    ROW(LOCAL_Z, "invocations in a workgroup along z", maxComputeWorkGroupSize[2],                   \
        GL_MAX_COMPUTE_WORK_GROUP_SIZE, GL_MAX_COMPUTE_WORK_GROUP_SIZE, 2, 64, 64, 1024, 64)         \
    ROW(GROUPS_X, "workgroups along x", maxComputeWorkGroupCount[0],                                 \
        GL_MAX_COMPUTE_WORK_GROUP_COUNT, GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0,                         \
        65535, 65535, 1 << 30, 65535)                                                                \
    ROW(GROUPS_Y, "workgroups along y", maxComputeWorkGroupCount[1],                                 \
        GL_MAX_COMPUTE_WORK_GROUP_COUNT, GL_MAX_COMPUTE_WORK_GROUP_COUNT, 1,                         \
        65535, 65535, 1 << 30, 65535)                                                                \
    ROW(GROUPS_Z, "workgroups along z", maxComputeWorkGroupCount[2],                                 \
        GL_MAX_COMPUTE_WORK_GROUP_COUNT, GL_MAX_COMPUTE_WORK_GROUP_COUNT, 2,                         \
        65535, 65535, 1 << 30, 65535)                                                                \
    ROW(UNIFORMS, "uniform buffers", maxPerStageDescriptorUniformBuffers,                            \
        GL_MAX_COMPUTE_UNIFORM_BLOCKS, GL_MAX_FRAGMENT_UNIFORM_BLOCKS, -1, 15, 12, 31, 14)           \
    ROW(STORAGES, "storage buffers", maxPerStageDescriptorStorageBuffers,                            \
        GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, -1,             \
        30, 4, 31, 8)                                                                                \
    ROW(TEXTURES, "textures and texel buffers", maxPerStageDescriptorSampledImages,                  \
        GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS, GL_MAX_TEXTURE_IMAGE_UNITS, -1, 200, 16, 128, 16)        \
    ROW(SAMPLERS, "textures with samplers", maxPerStageDescriptorSamplers,                           \
        GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS, GL_MAX_TEXTURE_IMAGE_UNITS, -1, 64, 16, 16, 16)          \
    ROW(IMAGES, "storage images", maxPerStageDescriptorStorageImages,                                \
        GL_MAX_COMPUTE_IMAGE_UNIFORMS, GL_MAX_FRAGMENT_IMAGE_UNIFORMS, -1, 16, 4, 128, 8)            \
    ROW(RESOURCES, "resources", maxPerStageResources, GL_NONE, GL_NONE, -1, 200, 128, 159, 128)      \
    ROW(OUTPUTS, "color targets, storage buffers and storage images",                                \
        maxFragmentCombinedOutputResources, GL_NONE, GL_MAX_COMBINED_SHADER_OUTPUT_RESOURCES, -1,    \
        16, 4, 159, 8)                                                                               \
    ROW(COLOR_TARGETS, "color targets", maxColorAttachments,                                         \
        GL_MAX_DRAW_BUFFERS, GL_MAX_COLOR_ATTACHMENTS, -1, 7, 4, 8, 8)                               \
    ROW(VERTEX_OUTPUTS, "components between vertices and fragments", maxVertexOutputComponents,      \
        GL_MAX_VERTEX_OUTPUT_COMPONENTS, GL_MAX_VERTEX_OUTPUT_COMPONENTS, -1, 64, 64, 124, 64)       \
    ROW(FRAGMENT_INPUTS, "components that fragments read", maxFragmentInputComponents,               \
        GL_MAX_FRAGMENT_INPUT_COMPONENTS, GL_MAX_FRAGMENT_INPUT_COMPONENTS, -1, 112, 112, 124, 128)  \
    ROW(ATTRIBUTES, "vertex attributes", maxVertexInputAttributes,                                   \
        GL_MAX_VERTEX_ATTRIBS, GL_MAX_VERTEX_ATTRIBS, -1, 16, 16, 31, 16)                            \
    ROW(CLIP_DISTANCES, "clip distances", maxClipDistances,                                          \
        GL_MAX_CLIP_DISTANCES, GL_MAX_CLIP_DISTANCES, -1, 8, 8, 8, 8)                                \
    ROW(PUSH_BYTES, "bytes of push constants", maxPushConstantsSize, GL_NONE, GL_NONE, -1,           \
        128, 128, 4096, 128)                                                                         \
    ROW(UNIFORM_BYTES, "bytes in a uniform block", maxUniformBufferRange,                            \
        GL_MAX_UNIFORM_BLOCK_SIZE, GL_MAX_UNIFORM_BLOCK_SIZE, -1, 65536, 16384, 65536, 16384)        \
    ROW(STORAGE_BYTES, "bytes in a storage buffer", maxStorageBufferRange,                           \
        GL_MAX_SHADER_STORAGE_BLOCK_SIZE, GL_MAX_SHADER_STORAGE_BLOCK_SIZE, -1,                      \
        1 << 27, 1 << 27, 1 << 28, 1 << 27)                                                          \
    ROW(TEXELS, "elements of a texel buffer", maxTexelBufferElements,                                \
        GL_MAX_TEXTURE_BUFFER_SIZE, GL_MAX_TEXTURE_BUFFER_SIZE, -1, 65536, 65536, 1 << 26, 65536)    \
    ROW(IMAGE_SIDE, "texels along a side of an image", maxImageDimension2D,                          \
        GL_MAX_TEXTURE_SIZE, GL_MAX_TEXTURE_SIZE, -1, 8192, 4096, 16384, 16384)                      \
    ROW(VOLUME_SIDE, "texels along a side of a 3D image", maxImageDimension3D,                       \
        GL_MAX_3D_TEXTURE_SIZE, GL_MAX_3D_TEXTURE_SIZE, -1, 256, 256, 2048, 2048)                    \
    ROW(CUBE_SIDE, "texels along a side of a cube", maxImageDimensionCube,                           \
        GL_MAX_CUBE_MAP_TEXTURE_SIZE, GL_MAX_CUBE_MAP_TEXTURE_SIZE, -1, 8192, 4096, 16384, 16384)    \
    ROW(IMAGE_LAYERS, "layers of an image", maxImageArrayLayers,                                     \
        GL_MAX_ARRAY_TEXTURE_LAYERS, GL_MAX_ARRAY_TEXTURE_LAYERS, -1, 2048, 256, 2048, 2048)         \
    ROW(TARGET_WIDTH, "texels of width of a target", maxFramebufferWidth,                            \
        GL_MAX_FRAMEBUFFER_WIDTH, GL_MAX_FRAMEBUFFER_WIDTH, -1, 4096, 4096, 16384, 16384)            \
    ROW(TARGET_HEIGHT, "texels of height of a target", maxFramebufferHeight,                         \
        GL_MAX_FRAMEBUFFER_HEIGHT, GL_MAX_FRAMEBUFFER_HEIGHT, -1, 4096, 4096, 16384, 16384)          \
    ROW(TARGET_LAYERS, "layers of a target", maxFramebufferLayers,                                   \
        GL_MAX_FRAMEBUFFER_LAYERS, GL_MAX_FRAMEBUFFER_LAYERS, -1, 256, 256, 2048, 2048)              \
    ROW(DRAWS, "indirect draws", maxDrawIndirectCount, GL_NONE, GL_NONE, -1,                         \
        65535, 65535, 1 << 30, 65536)
/* clang-format on */

enum dt_device_limit {
#define DT_LIMIT(name, ...) DT_LIMIT_##name,
    DT_DEVICE_LIMITS(DT_LIMIT)
#undef DT_LIMIT
        DT_LIMITS
};

#endif
