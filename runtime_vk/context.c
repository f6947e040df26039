/* Instance, device, queue and command buffers, and the ways of telling errors. Called by
 * runtime.c when a runtime is opened and closed; vk_check and vk_error by every file of this
 * folder. */
#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEVICES = 16, MAX_QUEUE_FAMILIES = 32 };

/* ---- Errors ---------------------------------------------------------------------------------- */

static const struct {
    VkResult result;
    const char *name, *advice;
} results[] = {
#define RESULT(name) name, #name
    {RESULT(VK_NOT_READY), "this should not happen; run again with --debug"},
    {RESULT(VK_TIMEOUT), "the device does not answer; see the system log"},
    {RESULT(VK_INCOMPLETE), "this should not happen; run again with --debug"},
    {RESULT(VK_ERROR_OUT_OF_HOST_MEMORY), "free system memory, or use a smaller frame or scene"},
    {RESULT(VK_ERROR_OUT_OF_DEVICE_MEMORY),
     "use a smaller frame, fewer layers or a smaller scene, or another --device"},
    {RESULT(VK_ERROR_INITIALIZATION_FAILED), "the driver does not start; try vulkaninfo --summary"},
    {RESULT(VK_ERROR_DEVICE_LOST),
     "the driver gave up, often because a pass ran too long; see the system log, "
     "and try a smaller frame or another --device"},
    {RESULT(VK_ERROR_MEMORY_MAP_FAILED), "free system memory, or use a smaller frame or scene"},
    {RESULT(VK_ERROR_LAYER_NOT_PRESENT),
     "install the validation layers (vulkan-validationlayers), or run without --debug"},
    {RESULT(VK_ERROR_EXTENSION_NOT_PRESENT),
     "install the validation layers (vulkan-validationlayers), or run without --debug"},
    {RESULT(VK_ERROR_FEATURE_NOT_PRESENT), "use another --device"},
    {RESULT(VK_ERROR_INCOMPATIBLE_DRIVER),
     "install a Vulkan 1.3 driver (mesa-vulkan-drivers brings one for the CPU)"},
    {RESULT(VK_ERROR_TOO_MANY_OBJECTS), "use fewer resources, or another --device"},
    {RESULT(VK_ERROR_FORMAT_NOT_SUPPORTED), "use another format, or another --device"},
    {RESULT(VK_ERROR_OUT_OF_POOL_MEMORY), "this should not happen; run again with --debug"},
    {RESULT(VK_ERROR_FRAGMENTATION), "use fewer resources, or another --device"},
    {RESULT(VK_ERROR_UNKNOWN), "the driver does not say why; run again with --debug"},
#undef RESULT
};

static void tell(const struct vk_runtime *rt, enum dt_level level, const char *format,
                 va_list arguments)
{
    char text[1024];
    vsnprintf(text, sizeof text, format, arguments);
    if (rt->log.message)
        rt->log.message(rt->log.user, level, text);
}

void vk_info(const struct vk_runtime *rt, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    tell(rt, DT_INFO, format, arguments);
    va_end(arguments);
}

bool vk_error(const struct vk_runtime *rt, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    tell(rt, DT_ERROR, format, arguments);
    va_end(arguments);
    return false;
}

bool vk_check(const struct vk_runtime *rt, VkResult result, const char *call, const char *name)
{
    if (result == VK_SUCCESS)
        return true;
    const char *own = "rt->vk."; /* a call through the table is told as the function that it is */
    bool table = strncmp(call, own, strlen(own)) == 0;
    const char *prefix = table ? "vk" : "";
    call += table ? strlen(own) : 0;
    int length = (int)strcspn(call, "(");
    for (size_t i = 0; i < DT_ARRAY_COUNT(results); i++)
        if (results[i].result == result)
            return vk_error(rt, "%s%.*s(%s): %s: %s", prefix, length, call, name, results[i].name,
                            results[i].advice);
    return vk_error(rt, "%s%.*s(%s): VkResult %d: run again with --debug", prefix, length, call,
                    name, (int)result);
}

/* Only messages of type VALIDATION count. PERFORMANCE ones tell, for example, of vertex
 * attributes that a depth-only pass leaves unread, which is what such a pass wants; GENERAL ones
 * come from the loader's search for drivers. */
static VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                     VkDebugUtilsMessageTypeFlagsEXT types,
                                     const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity;
    struct vk_runtime *rt = user;
    bool counts = types & VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    rt->messages += counts;
    if (rt->log.message)
        rt->log.message(rt->log.user, counts ? DT_ERROR : DT_DEBUG, data->pMessage);
    return VK_FALSE;
}

void vk_set_name(const struct vk_runtime *rt, VkObjectType type, uint64_t handle, const char *name)
{
    VkDebugUtilsObjectNameInfoEXT info = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
        .objectType = type,
        .objectHandle = handle,
        .pObjectName = name,
    };
    if (rt->set_name)
        rt->set_name(rt->device, &info);
}

/* ---- Instance -------------------------------------------------------------------------------- */

static bool open_instance(struct vk_runtime *rt)
{
    static const char *const layers[] = {"VK_LAYER_KHRONOS_validation"};
    static const char *const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                             VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
    static const VkValidationFeatureEnableEXT enabled[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,
    };
    uint32_t version = 0;
    if (!VK(rt, vkEnumerateInstanceVersion(&version), "loader"))
        return false;
    if (version < VK_API_VERSION_1_3)
        return vk_error(rt,
                        "Vulkan loader: version %u.%u, but 1.3 is needed; install a newer "
                        "libvulkan1",
                        VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version));
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = rt,
    };
    VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = &messenger, /* hears what happens while the instance is made */
        .enabledValidationFeatureCount = DT_ARRAY_COUNT(enabled),
        .pEnabledValidationFeatures = enabled,
    };
    VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pApplicationName = "diptych",
        .apiVersion = VK_API_VERSION_1_3,
    };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pApplicationInfo = &application,
    };
    if (rt->debug) {
        info.pNext = &features;
        info.enabledLayerCount = DT_ARRAY_COUNT(layers);
        info.ppEnabledLayerNames = layers;
        info.enabledExtensionCount = DT_ARRAY_COUNT(extensions);
        info.ppEnabledExtensionNames = extensions;
    }
    if (!VK(rt, vkCreateInstance(&info, NULL, &rt->instance), "diptych"))
        return false;
    if (!rt->debug)
        return true;
    PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(rt->instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    return VK(rt, create(rt->instance, &messenger, NULL, &rt->messenger), "messenger");
}

/* ---- Device ---------------------------------------------------------------------------------- */

struct features {
    VkPhysicalDeviceFeatures2 core;
    VkPhysicalDeviceVulkan11Features vulkan11;
    VkPhysicalDeviceVulkan12Features vulkan12;
    VkPhysicalDeviceVulkan13Features vulkan13;
};

static const struct {
    const char *name;
    size_t offset; /* of a VkBool32 in struct features */
} needed_features[] = {
/* NOLINTNEXTLINE(bugprone-macro-parentheses): a member name */
#define FEATURE(part, name) #name, offsetof(struct features, part.name)
    {FEATURE(core.features, fullDrawIndexUint32)},
    {FEATURE(core.features, multiDrawIndirect)},
    {FEATURE(core.features, drawIndirectFirstInstance)},
    {FEATURE(core.features, samplerAnisotropy)},
    {FEATURE(core.features, vertexPipelineStoresAndAtomics)},
    {FEATURE(core.features, fragmentStoresAndAtomics)},
    {FEATURE(core.features, shaderStorageImageExtendedFormats)},
    {FEATURE(core.features, shaderClipDistance)},
    {FEATURE(vulkan11, shaderDrawParameters)},
    {FEATURE(vulkan12, shaderOutputLayer)},
    {FEATURE(vulkan13, shaderDemoteToHelperInvocation)},
    {FEATURE(vulkan13, shaderTerminateInvocation)},
    {FEATURE(vulkan13, synchronization2)},
    {FEATURE(vulkan13, dynamicRendering)},
    {FEATURE(vulkan13, maintenance4)},
#undef FEATURE
};

static VkBool32 *feature(struct features *features, size_t index)
{
    return (VkBool32 *)((char *)features + needed_features[index].offset);
}

static void link_features(struct features *features)
{
    *features = (struct features){
        .core = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                 .pNext = &features->vulkan11},
        .vulkan11 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES,
                     .pNext = &features->vulkan12},
        .vulkan12 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                     .pNext = &features->vulkan13},
        .vulkan13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES},
    };
}

/* The first queue family with graphics and compute; UINT32_MAX: there is none. */
static uint32_t find_queue_family(VkPhysicalDevice physical, uint32_t *timestamp_bits)
{
    VkQueueFamilyProperties families[MAX_QUEUE_FAMILIES];
    uint32_t count = MAX_QUEUE_FAMILIES;
    const VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    for (uint32_t i = 0; i < count; i++) {
        if ((families[i].queueFlags & wanted) == wanted) {
            *timestamp_bits = families[i].timestampValidBits;
            return i;
        }
    }
    return UINT32_MAX;
}

/* Writes what the device lacks, ", "-separated, to `text`; true when that is nothing. */
static bool is_suitable(const struct vk_runtime *rt, VkPhysicalDevice physical, char *text,
                        size_t size)
{
    size_t used = 0;
    uint32_t timestamp_bits = 0;
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    text[0] = '\0';
    if (properties.apiVersion < VK_API_VERSION_1_3) {
        snprintf(text, size, "Vulkan 1.3 (it has %u.%u)",
                 VK_API_VERSION_MAJOR(properties.apiVersion),
                 VK_API_VERSION_MINOR(properties.apiVersion));
        return false;
    }
    struct features features;
    link_features(&features);
    vkGetPhysicalDeviceFeatures2(physical, &features.core);
    for (size_t i = 0; i < DT_ARRAY_COUNT(needed_features) && used < size; i++)
        if (!*feature(&features, i))
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                                     needed_features[i].name);
    if (used < size && find_queue_family(physical, &timestamp_bits) == UINT32_MAX)
        used += (size_t)snprintf(text + used, size - used, "%sa queue for graphics and compute",
                                 used ? ", " : "");
    if (used < size && rt->timing && !timestamp_bits)
        used += (size_t)snprintf(text + used, size - used, "%stimestamps (run without timing)",
                                 used ? ", " : "");
    return used == 0;
}

/* Index in `devices` that the user's words mean: an index, or a part of the name in any case;
 * -1: none. */
static int match_device(const VkPhysicalDevice *devices, uint32_t count, const char *wanted)
{
    char *end;
    unsigned long index = strtoul(wanted, &end, 10);
    if (*wanted && !*end)
        return index < count ? (int)index : -1;
    for (uint32_t i = 0; i < count; i++) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(devices[i], &properties);
        if (strcasestr(properties.deviceName, wanted))
            return (int)i;
    }
    return -1;
}

static bool no_such_device(const struct vk_runtime *rt, const VkPhysicalDevice *devices,
                           uint32_t count, const char *wanted)
{
    char list[768] = "";
    size_t used = 0;
    for (uint32_t i = 0; i < count && used < sizeof list; i++) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(devices[i], &properties);
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%u: %s", i ? "; " : "", i,
                                 properties.deviceName);
    }
    return vk_error(rt,
                    "--device %s: no such Vulkan device; choose a part of a name or an index "
                    "from: %s",
                    wanted, list);
}

/* The device that the user names; without a name the first that has all that is needed. */
static bool choose_device(struct vk_runtime *rt, const char *wanted)
{
    VkPhysicalDevice devices[MAX_DEVICES];
    char missing[512];
    uint32_t count = MAX_DEVICES;
    VkResult result = vkEnumeratePhysicalDevices(rt->instance, &count, devices);
    if (result != VK_INCOMPLETE && !vk_check(rt, result, "vkEnumeratePhysicalDevices", "instance"))
        return false;
    if (count == 0)
        return vk_error(rt, "Vulkan: no device; install a driver (mesa-vulkan-drivers brings one "
                            "for the CPU)");
    int chosen = wanted ? match_device(devices, count, wanted) : 0;
    if (chosen < 0)
        return no_such_device(rt, devices, count, wanted);
    for (uint32_t i = 0; !wanted && i < count; i++) {
        if (is_suitable(rt, devices[i], missing, sizeof missing)) {
            chosen = (int)i;
            break;
        }
    }
    rt->physical = devices[chosen];
    vkGetPhysicalDeviceProperties(rt->physical, &rt->properties);
    if (!is_suitable(rt, rt->physical, missing, sizeof missing))
        return vk_error(rt,
                        "Vulkan device %s: missing %s; update its driver or use another "
                        "--device",
                        rt->properties.deviceName, missing);
    return true;
}

static void link_functions(struct vk_dispatch *vk)
{
#define LINK(name) vk->name = vk##name;
    VK_INSTANCE_FUNCTIONS(LINK)
    VK_DEVICE_FUNCTIONS(LINK)
#undef LINK
}

static bool open_device(struct vk_runtime *rt)
{
    VkPhysicalDeviceMaintenance3Properties maintenance3 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
    };
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &maintenance3,
    };
    vkGetPhysicalDeviceProperties2(rt->physical, &properties);
    rt->max_allocation = maintenance3.maxMemoryAllocationSize;
    vkGetPhysicalDeviceMemoryProperties(rt->physical, &rt->memory);
    rt->queue_family = find_queue_family(rt->physical, &rt->timestamp_bits);

    struct features features;
    link_features(&features);
    for (size_t i = 0; i < DT_ARRAY_COUNT(needed_features); i++)
        *feature(&features, i) = VK_TRUE;
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = rt->queue_family,
        .queueCount = 1,
        .pQueuePriorities = &(float){1},
    };
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = &features.core,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
    };
    if (!VK(rt, vkCreateDevice(rt->physical, &info, NULL, &rt->device), rt->properties.deviceName))
        return false;
    link_functions(&rt->vk);
    vkGetDeviceQueue(rt->device, rt->queue_family, 0, &rt->queue);
    if (rt->debug) {
        rt->begin_label = (PFN_vkCmdBeginDebugUtilsLabelEXT)vkGetInstanceProcAddr(
            rt->instance, "vkCmdBeginDebugUtilsLabelEXT");
        rt->end_label = (PFN_vkCmdEndDebugUtilsLabelEXT)vkGetInstanceProcAddr(
            rt->instance, "vkCmdEndDebugUtilsLabelEXT");
        rt->set_name = (PFN_vkSetDebugUtilsObjectNameEXT)vkGetInstanceProcAddr(
            rt->instance, "vkSetDebugUtilsObjectNameEXT");
    }
    return true;
}

static bool open_commands(struct vk_runtime *rt)
{
    VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
        .queueFamilyIndex = rt->queue_family,
    };
    VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    if (!VK(rt, vkCreateCommandPool(rt->device, &pool, NULL, &rt->command_pool), "commands") ||
        !VK(rt, vkCreateFence(rt->device, &fence, NULL, &rt->fence), "frame"))
        return false;
    VkCommandBufferAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = rt->command_pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 2,
    };
    VkCommandBuffer buffers[2];
    if (!VK(rt, vkAllocateCommandBuffers(rt->device, &allocate, buffers), "commands"))
        return false;
    rt->frame_commands = buffers[0];
    rt->immediate_commands = buffers[1];
    return true;
}

bool vk_context_open(struct vk_runtime *rt, const char *device)
{
    return open_instance(rt) && choose_device(rt, device) && open_device(rt) && open_commands(rt);
}

void vk_context_close(struct vk_runtime *rt)
{
    if (rt->device) {
        vkDestroyFence(rt->device, rt->fence, NULL);
        vkDestroyCommandPool(rt->device, rt->command_pool, NULL);
        vkDestroyDevice(rt->device, NULL);
    }
    if (rt->messenger) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                rt->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy(rt->instance, rt->messenger, NULL);
    }
    if (rt->instance)
        vkDestroyInstance(rt->instance, NULL);
}
