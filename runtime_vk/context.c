/* Instance, device, queue and command buffers of the app's own runtime. */
#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEVICES = 16 };

/* ---- Messages -------------------------------------------------------------------------------- */

/* VALIDATION and PERFORMANCE messages count as errors. GENERAL messages come from the loader's
 * search for drivers. */
static VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                     VkDebugUtilsMessageTypeFlagsEXT types,
                                     const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity;
    struct dt_vk_runtime *rt = user;
    bool counts = types & (VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT);
    rt->core.device.messages += counts;
    if (rt->core.log.message)
        rt->core.log.message(rt->core.log.user, counts ? DT_ERROR : DT_DEBUG, data->pMessage);
    return VK_FALSE;
}

/* ---- Instance -------------------------------------------------------------------------------- */

static bool open_instance(struct dt_vk_runtime *rt)
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
        return dt_error(&rt->core,
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
        .pNext = &messenger, /* reports messages of vkCreateInstance */
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
        .enabledExtensionCount = rt->labels + rt->debug,
        .ppEnabledExtensionNames = extensions,
    };
    if (rt->debug) {
        info.pNext = &features;
        info.enabledLayerCount = DT_ARRAY_COUNT(layers);
        info.ppEnabledLayerNames = layers;
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

/* Index of the device that `wanted` names by index or by part of its name, in any case; -1:
 * none. */
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

static bool no_such_device(const struct dt_vk_runtime *rt, const VkPhysicalDevice *devices,
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
    return dt_error(&rt->core,
                    "no Vulkan device is called `%s`; choose a part of a name or an index from: %s",
                    wanted, list);
}

/* Chooses the device that the user names; without a name the first with all required features,
 * those of the panel included. */
static bool choose_device(struct dt_vk_runtime *rt, const struct dt_runtime_options *options)
{
    const char *wanted = options->device;
    VkPhysicalDevice devices[MAX_DEVICES];
    char missing[512];
    uint32_t count = MAX_DEVICES;
    VkResult result = vkEnumeratePhysicalDevices(rt->instance, &count, devices);
    if (result != VK_INCOMPLETE && !vk_check(rt, result, "vkEnumeratePhysicalDevices", "instance"))
        return false;
    if (count == 0)
        return dt_error(&rt->core,
                        "Vulkan: no device; install a driver (mesa-vulkan-drivers brings one "
                        "for the CPU)");
    int chosen = wanted ? match_device(devices, count, wanted) : 0;
    if (chosen < 0)
        return no_such_device(rt, devices, count, wanted);
    for (uint32_t i = 0; !wanted && i < count; i++) {
        if (vk_device_suits(rt, devices[i], options->panel, missing, sizeof missing) &&
            vk_device_is_enough(rt, devices[i], options->panel, missing, sizeof missing)) {
            chosen = (int)i;
            break;
        }
    }
    vk_device_describe(rt, devices[chosen]);
    if (!vk_device_suits(rt, rt->physical, options->panel, missing, sizeof missing))
        return dt_error(&rt->core,
                        "Vulkan device %s: missing %s; update its driver or use another device",
                        rt->core.device.name, missing);
    return vk_device_is_enough(rt, rt->physical, options->panel, missing, sizeof missing) ||
           dt_error(&rt->core, "%s", missing);
}

static bool has_extension(const struct dt_vk_runtime *rt, const char *name)
{
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(rt->physical, NULL, &count, NULL);
    VkExtensionProperties *list = calloc(count + 1, sizeof *list);
    bool has = false;
    if (list)
        vkEnumerateDeviceExtensionProperties(rt->physical, NULL, &count, list);
    for (uint32_t i = 0; list && i < count; i++)
        has |= strcmp(list[i].extensionName, name) == 0;
    free(list);
    return has;
}

static bool open_device(struct dt_vk_runtime *rt)
{
    static const char statistics[] = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
    if (rt->captures && !has_extension(rt, statistics))
        return dt_error(
            &rt->core, "Vulkan device %s: its driver (%s) has no %s, so its compiler tells nothing",
            rt->core.device.name, rt->core.device.driver, statistics);
    rt->queue_family = vk_device_queue_family(rt, rt->physical, &rt->timestamp_bits);
    vk_features_supported(rt, &rt->features);
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = rt->queue_family,
        .queueCount = 1,
        .pQueuePriorities = &(float){1},
    };
    VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR captures = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR,
        .pNext = &rt->features.core,
        .pipelineExecutableInfo = VK_TRUE,
    };
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = rt->captures ? (const void *)&captures : &rt->features.core,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = rt->captures,
        .ppEnabledExtensionNames = (const char *const[]){statistics},
    };
    if (!VK(rt, vkCreateDevice(rt->physical, &info, NULL, &rt->device), rt->core.device.name))
        return false;
    vkGetDeviceQueue(rt->device, rt->queue_family, 0, &rt->queue);
    if (rt->labels)
        vk_load_labels(rt, vkGetInstanceProcAddr);
    return true;
}

static bool open_commands(struct dt_vk_runtime *rt)
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

/* Uses the linked symbols, so that tests can replace these functions. */
static void link_functions(struct vk_dispatch *vk)
{
#define LINK(name) vk->name = vk##name;
    VK_INSTANCE_FUNCTIONS(LINK)
    VK_DEVICE_FUNCTIONS(LINK)
#undef LINK
}

bool vk_context_open(struct dt_vk_runtime *rt, const struct dt_runtime_options *options)
{
    link_functions(&rt->vk);
    return open_instance(rt) && choose_device(rt, options) && open_device(rt) &&
           (rt->captures || open_commands(rt));
}

void vk_context_close(struct dt_vk_runtime *rt)
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
