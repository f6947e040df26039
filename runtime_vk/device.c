/* What the runtime needs of a physical device, and what it remembers of it. Called by context.c, which
 * looks for one, and by host.c, which is given one. */
#include "internal.h"

#include <stdio.h>

enum { MAX_QUEUE_FAMILIES = 32 };

static const struct {
    const char *name;
    size_t offset; /* of a VkBool32 in struct vk_features */
} needed_features[] = {
/* NOLINTNEXTLINE(bugprone-macro-parentheses): a member name */
#define FEATURE(part, name) #name, offsetof(struct vk_features, part.name)
    {FEATURE(core.features, fullDrawIndexUint32)},
    {FEATURE(core.features, multiDrawIndirect)},
    {FEATURE(core.features, drawIndirectFirstInstance)},
    {FEATURE(core.features, samplerAnisotropy)},
    {FEATURE(core.features, vertexPipelineStoresAndAtomics)},
    {FEATURE(core.features, fragmentStoresAndAtomics)},
    {FEATURE(core.features, shaderStorageImageExtendedFormats)},
    {FEATURE(core.features, shaderClipDistance)},
    {FEATURE(core.features, geometryShader)}, /* gl_PrimitiveID in fragments */
    {FEATURE(vulkan11, shaderDrawParameters)},
    {FEATURE(vulkan12, shaderOutputLayer)},
    {FEATURE(vulkan13, shaderDemoteToHelperInvocation)},
    {FEATURE(vulkan13, shaderTerminateInvocation)},
    {FEATURE(vulkan13, synchronization2)},
    {FEATURE(vulkan13, dynamicRendering)},
    {FEATURE(vulkan13, maintenance4)},
#undef FEATURE
};

static VkBool32 *feature(struct vk_features *features, size_t index)
{
    return (VkBool32 *)((char *)features + needed_features[index].offset);
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

void vk_features_needed(struct vk_features *features)
{
    link_features(features);
    for (size_t i = 0; i < DT_ARRAY_COUNT(needed_features); i++)
        *feature(features, i) = VK_TRUE;
}

void dt_vk_need_features(VkPhysicalDeviceFeatures *core, VkPhysicalDeviceVulkan11Features *vulkan11,
                         VkPhysicalDeviceVulkan12Features *vulkan12,
                         VkPhysicalDeviceVulkan13Features *vulkan13)
{
    struct vk_features features = {.core.features = *core,
                                   .vulkan11 = *vulkan11,
                                   .vulkan12 = *vulkan12,
                                   .vulkan13 = *vulkan13};
    for (size_t i = 0; i < DT_ARRAY_COUNT(needed_features); i++)
        *feature(&features, i) = VK_TRUE;
    *core = features.core.features;
    *vulkan11 = features.vulkan11;
    *vulkan12 = features.vulkan12;
    *vulkan13 = features.vulkan13;
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
    link_features(&features);
    rt->vk.GetPhysicalDeviceFeatures2(physical, &features.core);
    for (size_t i = 0; i < DT_ARRAY_COUNT(needed_features) && used < size; i++)
        if (!*feature(&features, i))
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                                     needed_features[i].name);
    if (used < size && vk_device_queue_family(rt, physical, &timestamp_bits) == UINT32_MAX)
        used += (size_t)snprintf(text + used, size - used, "%sa queue for graphics and compute",
                                 used ? ", " : "");
    if (used < size && rt->timing && !timestamp_bits)
        used += (size_t)snprintf(text + used, size - used, "%stimestamps (run without timing)",
                                 used ? ", " : "");
    return used == 0;
}

void vk_device_describe(struct vk_runtime *rt, VkPhysicalDevice physical)
{
    VkPhysicalDeviceMaintenance3Properties maintenance3 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
    };
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &maintenance3,
    };
    rt->physical = physical;
    rt->vk.GetPhysicalDeviceProperties2(physical, &properties);
    rt->properties = properties.properties;
    rt->max_allocation = maintenance3.maxMemoryAllocationSize;
    rt->vk.GetPhysicalDeviceMemoryProperties(physical, &rt->memory);
}
