/* The image formats of the spec language: bytes, enumerators, and whether shaders may load and
 * store them. Called by the plan and the emitters. */
#include "plan.h"

static const struct format_info formats[DT_FORMAT_COUNT] = {
    [DT_FORMAT_R8] = {"r8", "DT_FORMAT_R8", "VK_FORMAT_R8_UNORM", 1, true, false},
    [DT_FORMAT_RG8] = {"rg8", "DT_FORMAT_RG8", "VK_FORMAT_R8G8_UNORM", 2, true, false},
    [DT_FORMAT_RGBA8] = {"rgba8", "DT_FORMAT_RGBA8", "VK_FORMAT_R8G8B8A8_UNORM", 4, true, false},
    [DT_FORMAT_RGBA8_SRGB] = {"rgba8_srgb", "DT_FORMAT_RGBA8_SRGB", "VK_FORMAT_R8G8B8A8_SRGB", 4,
                              false, false},
    [DT_FORMAT_R16F] = {"r16f", "DT_FORMAT_R16F", "VK_FORMAT_R16_SFLOAT", 2, true, false},
    [DT_FORMAT_RG16F] = {"rg16f", "DT_FORMAT_RG16F", "VK_FORMAT_R16G16_SFLOAT", 4, true, false},
    [DT_FORMAT_RGBA16F] = {"rgba16f", "DT_FORMAT_RGBA16F", "VK_FORMAT_R16G16B16A16_SFLOAT", 8, true,
                           false},
    [DT_FORMAT_R32F] = {"r32f", "DT_FORMAT_R32F", "VK_FORMAT_R32_SFLOAT", 4, true, false},
    [DT_FORMAT_RG32F] = {"rg32f", "DT_FORMAT_RG32F", "VK_FORMAT_R32G32_SFLOAT", 8, true, false},
    [DT_FORMAT_RGBA32F] = {"rgba32f", "DT_FORMAT_RGBA32F", "VK_FORMAT_R32G32B32A32_SFLOAT", 16,
                           true, false},
    [DT_FORMAT_R32UI] = {"r32ui", "DT_FORMAT_R32UI", "VK_FORMAT_R32_UINT", 4, true, true},
    [DT_FORMAT_RG32UI] = {"rg32ui", "DT_FORMAT_RG32UI", "VK_FORMAT_R32G32_UINT", 8, true, true},
    [DT_FORMAT_RGBA32UI] = {"rgba32ui", "DT_FORMAT_RGBA32UI", "VK_FORMAT_R32G32B32A32_UINT", 16,
                            true, true},
    [DT_FORMAT_R32I] = {"r32i", "DT_FORMAT_R32I", "VK_FORMAT_R32_SINT", 4, true, true},
    [DT_FORMAT_D32F] = {"d32f", "DT_FORMAT_D32F", "VK_FORMAT_D32_SFLOAT", 4, false, false},
};

const struct format_info *format_info(enum dt_format format)
{
    return &formats[format];
}
