/* A preloaded library: every Vulkan device reports that it has no shaderOutputLayer. */
#include <dlfcn.h>
#include <vulkan/vulkan.h>

void vkGetPhysicalDeviceFeatures2(VkPhysicalDevice physicalDevice,
                                  VkPhysicalDeviceFeatures2 *pFeatures)
{
    PFN_vkGetPhysicalDeviceFeatures2 real;
    *(void **)&real = dlsym(RTLD_NEXT, "vkGetPhysicalDeviceFeatures2");
    real(physicalDevice, pFeatures);
    for (VkBaseOutStructure *next = pFeatures->pNext; next; next = next->pNext)
        if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES)
            ((VkPhysicalDeviceVulkan12Features *)next)->shaderOutputLayer = VK_FALSE;
}
