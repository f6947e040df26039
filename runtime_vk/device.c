/* Required features and stored properties of a physical device. Called by context.c, which searches
 * a device, and by host.c, which gets one. */
#include "internal.h"

#include <stdio.h>
#include <string.h>

enum { MAX_QUEUE_FAMILIES = 32 };

static const struct {
    const char *name;
    size_t offset; /* of a VkBool32 in struct vk_features */
    bool always;   /* every pipeline needs it; others: if a pass needs it */
} known_features[] = {
/* NOLINTNEXTLINE(bugprone-macro-parentheses): a member name */
#define FEATURE(part, name) #name, offsetof(struct vk_features, part.name)
    {FEATURE(vulkan13, shaderDemoteToHelperInvocation), true},
    {FEATURE(vulkan13, shaderTerminateInvocation), true},
    {FEATURE(vulkan13, synchronization2), true},
    {FEATURE(vulkan13, dynamicRendering), true},
    {FEATURE(vulkan13, maintenance4), true},
    {FEATURE(core.features, independentBlend), false},
    {FEATURE(core.features, fullDrawIndexUint32), false},
    {FEATURE(core.features, largePoints), false},
    {FEATURE(core.features, multiDrawIndirect), false},
    {FEATURE(core.features, drawIndirectFirstInstance), false},
    {FEATURE(core.features, samplerAnisotropy), false},
    {FEATURE(core.features, fragmentStoresAndAtomics), false},
    {FEATURE(core.features, geometryShader), false},
    {FEATURE(core.features, sampleRateShading), false},
    {FEATURE(core.features, imageCubeArray), false},
    {FEATURE(core.features, shaderImageGatherExtended), false},
    {FEATURE(core.features, shaderStorageImageExtendedFormats), false},
    {FEATURE(core.features, shaderClipDistance), false},
    {FEATURE(core.features, shaderCullDistance), false},
    {FEATURE(core.features, shaderFloat64), false},
    {FEATURE(vulkan11, shaderDrawParameters), false},
    {FEATURE(vulkan12, shaderOutputLayer), false},
#undef FEATURE
};

static VkBool32 *feature(struct vk_features *features, size_t index)
{
    return (VkBool32 *)((char *)features + known_features[index].offset);
}

static void link_features(struct vk_features *features)
{
    *features = (struct vk_features){
        .core = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                 .pNext = &features->vulkan11},
        .vulkan11 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES,
                     .pNext = &features->vulkan12},
        .vulkan12 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                     .pNext = &features->vulkan13},
        .vulkan13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES},
    };
}

static void find_features(const struct vk_runtime *rt, VkPhysicalDevice physical,
                          struct vk_features *features)
{
    link_features(features);
    rt->vk.GetPhysicalDeviceFeatures2(physical, &features->core);
}

void vk_features_wanted(const struct vk_runtime *rt, struct vk_features *features)
{
    struct vk_features has;
    find_features(rt, rt->physical, &has);
    link_features(features);
    for (size_t i = 0; i < DT_ARRAY_COUNT(known_features); i++)
        *feature(features, i) = *feature(&has, i);
}

static bool panel_needs(const struct dt_panel *panel, const char *name)
{
    for (uint32_t i = 0; i < panel->need_count; i++)
        if (strcmp(panel->needs[i].feature, name) == 0)
            return true;
    return false;
}

void dt_vk_need_features(const struct dt_shaders *shaders, VkPhysicalDeviceFeatures *core,
                         VkPhysicalDeviceVulkan11Features *vulkan11,
                         VkPhysicalDeviceVulkan12Features *vulkan12,
                         VkPhysicalDeviceVulkan13Features *vulkan13)
{
    struct vk_features features = {.core.features = *core,
                                   .vulkan11 = *vulkan11,
                                   .vulkan12 = *vulkan12,
                                   .vulkan13 = *vulkan13};
    for (size_t i = 0; i < DT_ARRAY_COUNT(known_features); i++)
        if (known_features[i].always || (DT_TAKES(shaders->panel->version) &&
                                         panel_needs(shaders->panel, known_features[i].name)))
            *feature(&features, i) = VK_TRUE;
    *core = features.core.features;
    *vulkan11 = features.vulkan11;
    *vulkan12 = features.vulkan12;
    *vulkan13 = features.vulkan13;
}

static const struct {
    const char *name;
    VkSubgroupFeatureFlags bit;
} subgroup_features[] = {
#define BIT(name)                                                                                  \
    {                                                                                              \
#name, name                                                                                \
    }
    BIT(VK_SUBGROUP_FEATURE_BASIC_BIT),      BIT(VK_SUBGROUP_FEATURE_VOTE_BIT),
    BIT(VK_SUBGROUP_FEATURE_ARITHMETIC_BIT), BIT(VK_SUBGROUP_FEATURE_BALLOT_BIT),
    BIT(VK_SUBGROUP_FEATURE_SHUFFLE_BIT),    BIT(VK_SUBGROUP_FEATURE_SHUFFLE_RELATIVE_BIT),
    BIT(VK_SUBGROUP_FEATURE_CLUSTERED_BIT),  BIT(VK_SUBGROUP_FEATURE_QUAD_BIT),
#undef BIT
};

static bool has_feature(const struct vk_runtime *rt, struct vk_features *features, const char *name)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(subgroup_features); i++)
        if (strcmp(subgroup_features[i].name, name) == 0)
            return rt->subgroups & subgroup_features[i].bit;
    for (size_t i = 0; i < DT_ARRAY_COUNT(known_features); i++)
        if (strcmp(known_features[i].name, name) == 0)
            return *feature(features, i);
    return false;
}

bool vk_device_suits_panel(const struct vk_runtime *rt, const struct dt_panel *panel)
{
    struct vk_features features;
    find_features(rt, rt->physical, &features);
    for (uint32_t i = 0; i < panel->need_count; i++) {
        const struct dt_need *need = &panel->needs[i];
        if (!has_feature(rt, &features, need->feature))
            return dt_error(
                &rt->core, "pass %s: needs %s, which %s does not have; use another device",
                panel->pipeline->passes[need->pass].name, need->feature, rt->core.device_name);
    }
    return true;
}

uint32_t vk_device_queue_family(const struct vk_runtime *rt, VkPhysicalDevice physical,
                                uint32_t *timestamp_bits)
{
    VkQueueFamilyProperties families[MAX_QUEUE_FAMILIES];
    uint32_t count = MAX_QUEUE_FAMILIES;
    const VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    rt->vk.GetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    for (uint32_t i = 0; i < count; i++) {
        if ((families[i].queueFlags & wanted) == wanted) {
            *timestamp_bits = families[i].timestampValidBits;
            return i;
        }
    }
    return UINT32_MAX;
}

bool vk_device_suits(const struct vk_runtime *rt, VkPhysicalDevice physical, char *text,
                     size_t size)
{
    size_t used = 0;
    uint32_t timestamp_bits = 0;
    VkPhysicalDeviceProperties properties;
    rt->vk.GetPhysicalDeviceProperties(physical, &properties);
    text[0] = '\0';
    if (properties.apiVersion < VK_API_VERSION_1_3) {
        snprintf(text, size, "Vulkan 1.3 (it has %u.%u)",
                 VK_API_VERSION_MAJOR(properties.apiVersion),
                 VK_API_VERSION_MINOR(properties.apiVersion));
        return false;
    }
    struct vk_features features;
    find_features(rt, physical, &features);
    for (size_t i = 0; i < DT_ARRAY_COUNT(known_features) && used < size; i++)
        if (known_features[i].always && !*feature(&features, i))
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                                     known_features[i].name);
    if (used < size && vk_device_queue_family(rt, physical, &timestamp_bits) == UINT32_MAX)
        used += (size_t)snprintf(text + used, size - used, "%sa queue for graphics and compute",
                                 used ? ", " : "");
    if (used < size && rt->core.timing && !timestamp_bits)
        used += (size_t)snprintf(text + used, size - used, "%stimestamps (run without timing)",
                                 used ? ", " : "");
    return used == 0;
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static struct dt_limits limits_of(const VkPhysicalDeviceLimits *can)
{
    const uint32_t *groups = can->maxComputeWorkGroupCount;
    return (struct dt_limits){
        .image_size = can->maxImageDimension2D,
        .image_layers = can->maxImageArrayLayers,
        .volume_size = can->maxImageDimension3D,
        .cube_size = can->maxImageDimensionCube,
        .target_size = {can->maxFramebufferWidth, can->maxFramebufferHeight},
        .color_targets = can->maxColorAttachments,
        .bindings = {[DT_BIND_UNIFORM] = can->maxPerStageDescriptorUniformBuffers,
                     [DT_BIND_STORAGE] = can->maxPerStageDescriptorStorageBuffers,
                     [DT_BIND_TEXTURE] = least(can->maxPerStageDescriptorSampledImages,
                                               can->maxPerStageDescriptorSamplers),
                     [DT_BIND_IMAGE] = can->maxPerStageDescriptorStorageImages},
        .uniform_bytes = can->maxUniformBufferRange,
        .storage_bytes = can->maxStorageBufferRange,
        .groups = {groups[0], groups[1], groups[2]},
        .draws = can->maxDrawIndirectCount,
        .clip_distances = can->maxClipDistances,
        .anisotropy = can->maxSamplerAnisotropy,
    };
}

void vk_device_describe(struct vk_runtime *rt, VkPhysicalDevice physical)
{
    VkPhysicalDeviceMaintenance3Properties maintenance3 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
    };
    VkPhysicalDeviceSubgroupProperties subgroups = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
        .pNext = &maintenance3,
    };
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &subgroups,
    };
    rt->physical = physical;
    rt->vk.GetPhysicalDeviceProperties2(physical, &properties);
    rt->properties = properties.properties;
    rt->core.limits = limits_of(&rt->properties.limits);
    snprintf(rt->core.device_name, sizeof rt->core.device_name, "%s", rt->properties.deviceName);
    rt->max_allocation = maintenance3.maxMemoryAllocationSize;
    rt->subgroups =
        subgroups.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT ? subgroups.supportedOperations : 0;
    rt->vk.GetPhysicalDeviceMemoryProperties(physical, &rt->memory);
}
