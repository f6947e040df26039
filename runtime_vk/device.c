/* Required features and stored properties of a physical device. */
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
    {FEATURE(core.features, vertexPipelineStoresAndAtomics), false}, /* --sanitize */
    {FEATURE(core.features, geometryShader), false},
    {FEATURE(core.features, sampleRateShading), false},
    {FEATURE(core.features, imageCubeArray), false},
    {FEATURE(core.features, shaderImageGatherExtended), false},
    {FEATURE(core.features, shaderStorageImageExtendedFormats), false},
    {FEATURE(core.features, shaderClipDistance), false},
    {FEATURE(core.features, shaderCullDistance), false},
    {FEATURE(core.features, shaderFloat64), false},
    {FEATURE(core.features, shaderInt64), false},
    {FEATURE(core.features, shaderInt16), false},
    {FEATURE(vulkan11, storageBuffer16BitAccess), false},
    {FEATURE(vulkan11, uniformAndStorageBuffer16BitAccess), false},
    {FEATURE(vulkan11, storagePushConstant16), false},
    {FEATURE(vulkan11, storageInputOutput16), false},
    {FEATURE(vulkan12, storageBuffer8BitAccess), false},
    {FEATURE(vulkan12, uniformAndStorageBuffer8BitAccess), false},
    {FEATURE(vulkan12, storagePushConstant8), false},
    {FEATURE(vulkan12, shaderFloat16), false},
    {FEATURE(vulkan12, shaderInt8), false},
    {FEATURE(vulkan12, shaderBufferInt64Atomics), false},
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

static void find_features(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                          struct vk_features *features)
{
    link_features(features);
    rt->vk.GetPhysicalDeviceFeatures2(physical, &features->core);
}

void vk_features_supported(const struct dt_vk_runtime *rt, struct vk_features *features)
{
    struct vk_features has;
    find_features(rt, rt->physical, &has);
    link_features(features);
    for (size_t i = 0; i < DT_ARRAY_COUNT(known_features); i++)
        *feature(features, i) = *feature(&has, i);
}

/* Structures of one feature each, all of the same form, that a host may use instead. */
static const struct {
    VkStructureType type;
    size_t offset; /* as in known_features */
} single_features[] = {
#define SINGLE(type, name)                                                                         \
    {                                                                                              \
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_##type##_FEATURES, offsetof(struct vk_features, name)    \
    }
    SINGLE(SHADER_DEMOTE_TO_HELPER_INVOCATION, vulkan13.shaderDemoteToHelperInvocation),
    SINGLE(SHADER_TERMINATE_INVOCATION, vulkan13.shaderTerminateInvocation),
    SINGLE(SYNCHRONIZATION_2, vulkan13.synchronization2),
    SINGLE(DYNAMIC_RENDERING, vulkan13.dynamicRendering),
    SINGLE(MAINTENANCE_4, vulkan13.maintenance4),
    SINGLE(SHADER_DRAW_PARAMETERS, vulkan11.shaderDrawParameters),
#undef SINGLE
};

/* Adds what one structure of a pNext chain enables. */
static void add_enabled(struct vk_features *features, const VkBaseInStructure *next)
{
    switch (next->sType) {
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2:
        features->core = *(const VkPhysicalDeviceFeatures2 *)next;
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES:
        features->vulkan11 = *(const VkPhysicalDeviceVulkan11Features *)next;
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES:
        features->vulkan12 = *(const VkPhysicalDeviceVulkan12Features *)next;
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES:
        features->vulkan13 = *(const VkPhysicalDeviceVulkan13Features *)next;
        break;
    default:
        for (size_t i = 0; i < DT_ARRAY_COUNT(single_features); i++)
            if (single_features[i].type == next->sType)
                *(VkBool32 *)((char *)features + single_features[i].offset) =
                    ((const VkPhysicalDeviceSynchronization2Features *)next)->synchronization2;
    }
}

bool vk_features_enabled(struct dt_vk_runtime *rt, const VkDeviceCreateInfo *info)
{
    struct vk_features *features = &rt->features;
    *features = (struct vk_features){0};
    if (info->pEnabledFeatures)
        features->core.features = *info->pEnabledFeatures;
    for (const VkBaseInStructure *next = info->pNext; next; next = next->pNext)
        add_enabled(features, next);
    for (size_t i = 0; i < DT_ARRAY_COUNT(known_features); i++)
        if (known_features[i].always && !*feature(features, i))
            return dt_error(&rt->core,
                            "Vulkan device %s: created without %s; enable all features that "
                            "dt_vk_need_features sets",
                            rt->core.device.name, known_features[i].name);
    return true;
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
    if (!shaders || !core || !vulkan11 || !vulkan12 || !vulkan13)
        return;
    struct vk_features features = {.core.features = *core,
                                   .vulkan11 = *vulkan11,
                                   .vulkan12 = *vulkan12,
                                   .vulkan13 = *vulkan13};
    const struct dt_panel *panel = shaders->panel, *gpu = panel->gpu ? panel->gpu : panel;
    for (size_t i = 0; i < DT_ARRAY_COUNT(known_features); i++)
        if (known_features[i].always ||
            (DT_TAKES(panel->version) && (panel_needs(panel, known_features[i].name) ||
                                          panel_needs(gpu, known_features[i].name))))
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

static VkSubgroupFeatureFlags find_subgroups(const struct dt_vk_runtime *rt,
                                             VkPhysicalDevice physical)
{
    VkPhysicalDeviceSubgroupProperties subgroups = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
    };
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &subgroups,
    };
    rt->vk.GetPhysicalDeviceProperties2(physical, &properties);
    return subgroups.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT ? subgroups.supportedOperations
                                                                   : 0;
}

static bool has_feature(VkSubgroupFeatureFlags subgroups, struct vk_features *features,
                        const char *name)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(subgroup_features); i++)
        if (strcmp(subgroup_features[i].name, name) == 0)
            return subgroups & subgroup_features[i].bit;
    for (size_t i = 0; i < DT_ARRAY_COUNT(known_features); i++)
        if (strcmp(known_features[i].name, name) == 0)
            return *feature(features, i);
    return false;
}

/* Without it, each layer is drawn alone: see next_layers in verbs.c. */
static const char optional_feature[] = "shaderOutputLayer";

/* The panel's first need without its feature; NULL: none. */
static const struct dt_need *find_lack(VkSubgroupFeatureFlags subgroups,
                                       struct vk_features *features, const struct dt_panel *panel)
{
    for (uint32_t i = 0; i < panel->need_count; i++)
        if (!has_feature(subgroups, features, panel->needs[i].feature) &&
            strcmp(panel->needs[i].feature, optional_feature) != 0)
            return &panel->needs[i];
    return NULL;
}

bool vk_device_suits_panel(struct dt_vk_runtime *rt, const struct dt_panel *panel)
{
    VkSubgroupFeatureFlags subgroups = find_subgroups(rt, rt->physical);
    const struct dt_need *lack = find_lack(subgroups, &rt->features, panel);
    struct vk_features supported;
    if (!lack)
        return true;
    find_features(rt, rt->physical, &supported);
    return dt_error(&rt->core, "pass %s: needs %s, which %s %s",
                    panel->pipeline->passes[lack->pass].name, lack->feature, rt->core.device.name,
                    has_feature(subgroups, &supported, lack->feature)
                        ? "has, but was created without; enable all features that "
                          "dt_vk_need_features sets"
                        : "does not have; use another device");
}

bool vk_device_family_suits(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                            uint32_t family, uint32_t *timestamp_bits)
{
    VkQueueFamilyProperties families[MAX_QUEUE_FAMILIES];
    uint32_t count = MAX_QUEUE_FAMILIES;
    const VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    rt->vk.GetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    *timestamp_bits = family < count ? families[family].timestampValidBits : 0;
    return family < count && (families[family].queueFlags & wanted) == wanted;
}

uint32_t vk_device_queue_family(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                                uint32_t *timestamp_bits)
{
    for (uint32_t i = 0; i < MAX_QUEUE_FAMILIES; i++)
        if (vk_device_family_suits(rt, physical, i, timestamp_bits))
            return i;
    return UINT32_MAX;
}

bool vk_device_suits(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                     const struct dt_panel *panel, char *text, size_t size)
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
    const struct dt_need *lack =
        panel ? find_lack(find_subgroups(rt, physical), &features, panel) : NULL;
    if (used < size && lack)
        used += (size_t)snprintf(text + used, size - used, "%s%s (pass %s)", used ? ", " : "",
                                 lack->feature, panel->pipeline->passes[lack->pass].name);
    if (used < size && vk_device_queue_family(rt, physical, &timestamp_bits) == UINT32_MAX)
        used += (size_t)snprintf(text + used, size - used, "%sa queue for graphics and compute",
                                 used ? ", " : "");
    if (used < size && rt->core.timing && !timestamp_bits)
        used += (size_t)snprintf(text + used, size - used, "%stimestamps (run without timing)",
                                 used ? ", " : "");
    return used == 0;
}

static struct dt_limits limits_of(const VkPhysicalDeviceLimits *can)
{
    return (struct dt_limits){
        .most =
            {
#define ROW(name, words, vk, ...) [DT_LIMIT_##name] = can->vk,
                DT_DEVICE_LIMITS(ROW)
#undef ROW
            },
        .numbers = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX},
        .anisotropy = can->maxSamplerAnisotropy,
    };
}

bool vk_device_is_enough(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                         const struct dt_panel *panel, char *text, size_t size)
{
    VkPhysicalDeviceProperties properties;
    rt->vk.GetPhysicalDeviceProperties(physical, &properties);
    const struct dt_limits limits = limits_of(&properties.limits);
    return !panel || dt_front_suits(panel, &limits, properties.deviceName, text, size);
}

void vk_device_describe(struct dt_vk_runtime *rt, VkPhysicalDevice physical)
{
    VkPhysicalDeviceMaintenance3Properties maintenance3 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
    };
    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
        .pNext = &maintenance3,
    };
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &driver,
    };
    rt->physical = physical;
    rt->vk.GetPhysicalDeviceProperties2(physical, &properties);
    rt->properties = properties.properties;
    rt->core.device.software = rt->properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    rt->core.limits = limits_of(&rt->properties.limits);
    snprintf(rt->core.device.name, sizeof rt->core.device.name, "%s", rt->properties.deviceName);
    snprintf(rt->core.device.driver, sizeof rt->core.device.driver, "%s, %s", driver.driverName,
             driver.driverInfo);
    rt->max_allocation = maintenance3.maxMemoryAllocationSize;
    rt->vk.GetPhysicalDeviceMemoryProperties(physical, &rt->memory);
}
