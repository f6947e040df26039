/* Names of VkResult values with advice, and object names for the validation layers. */
#include "internal.h"

#include <string.h>

static const struct {
    VkResult result;
    const char *name, *advice;
} results[] = {
#define RESULT(name) name, #name
    {RESULT(VK_NOT_READY), "this should not happen; turn on validation to learn more"},
    {RESULT(VK_TIMEOUT), "the device does not answer; see the system log"},
    {RESULT(VK_INCOMPLETE), "this should not happen; turn on validation to learn more"},
    {RESULT(VK_ERROR_OUT_OF_HOST_MEMORY), "free system memory, or use a smaller frame or scene"},
    {RESULT(VK_ERROR_OUT_OF_DEVICE_MEMORY),
     "use a smaller frame, fewer layers or a smaller scene, or another device"},
    {RESULT(VK_ERROR_INITIALIZATION_FAILED), "the driver does not start; try vulkaninfo --summary"},
    {RESULT(VK_ERROR_DEVICE_LOST),
     "the driver gave up, often because a pass ran too long; see the system log, "
     "and try a smaller frame or another device"},
    {RESULT(VK_ERROR_MEMORY_MAP_FAILED), "free system memory, or use a smaller frame or scene"},
    {RESULT(VK_ERROR_LAYER_NOT_PRESENT),
     "install the validation layers (vulkan-validationlayers), or turn validation off"},
    {RESULT(VK_ERROR_EXTENSION_NOT_PRESENT),
     "install the validation layers (vulkan-validationlayers), or turn validation off"},
    {RESULT(VK_ERROR_FEATURE_NOT_PRESENT), "use another device"},
    {RESULT(VK_ERROR_INCOMPATIBLE_DRIVER),
     "install a Vulkan 1.3 driver (mesa-vulkan-drivers brings one for the CPU)"},
    {RESULT(VK_ERROR_TOO_MANY_OBJECTS), "use fewer resources, or another device"},
    {RESULT(VK_ERROR_FORMAT_NOT_SUPPORTED), "use another format, or another device"},
    {RESULT(VK_ERROR_OUT_OF_POOL_MEMORY),
     "this should not happen; turn on validation to learn more"},
    {RESULT(VK_ERROR_FRAGMENTATION), "use fewer resources, or another device"},
    {RESULT(VK_ERROR_UNKNOWN), "the driver does not say why; turn on validation to learn more"},
#undef RESULT
};

bool vk_check(struct dt_vk_runtime *rt, VkResult result, const char *call, const char *name)
{
    if (result == VK_SUCCESS)
        return true;
    rt->core.device.lost = rt->core.device.lost || result == VK_ERROR_DEVICE_LOST;
    const char *own = "rt->vk."; /* calls through the table are reported by their Vulkan names */
    bool table = strncmp(call, own, strlen(own)) == 0;
    const char *prefix = table ? "vk" : "";
    call += table ? strlen(own) : 0;
    int length = (int)strcspn(call, "(");
    for (size_t i = 0; i < DT_ARRAY_COUNT(results); i++)
        if (results[i].result == result)
            return dt_error(&rt->core, "%s%.*s(%s): %s: %s", prefix, length, call, name,
                            results[i].name, results[i].advice);
    return dt_error(&rt->core, "%s%.*s(%s): VkResult %d: turn on validation to learn more", prefix,
                    length, call, name, (int)result);
}

void vk_load_labels(struct dt_vk_runtime *rt, PFN_vkGetInstanceProcAddr get)
{
    rt->begin_label =
        (PFN_vkCmdBeginDebugUtilsLabelEXT)get(rt->instance, "vkCmdBeginDebugUtilsLabelEXT");
    rt->end_label = (PFN_vkCmdEndDebugUtilsLabelEXT)get(rt->instance, "vkCmdEndDebugUtilsLabelEXT");
    rt->set_name =
        (PFN_vkSetDebugUtilsObjectNameEXT)get(rt->instance, "vkSetDebugUtilsObjectNameEXT");
    if (!rt->end_label)
        rt->begin_label = NULL;
}

void vk_set_name(const struct dt_vk_runtime *rt, VkObjectType type, uint64_t handle,
                 const char *name)
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
