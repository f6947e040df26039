/* Put before the Vulkan loader by LD_PRELOAD: the window's surface is out of date, suboptimal and
 * lost, each once, as it is when people move windows between screens. Says so on stderr. */
#include <dlfcn.h>
#include <stdio.h>
#include <vulkan/vulkan.h>

static void tell(const char *what)
{
    fprintf(stderr, "told: %s\n", what);
}

VkResult vkAcquireNextImageKHR(VkDevice device, VkSwapchainKHR swapchain, uint64_t timeout,
                               VkSemaphore semaphore, VkFence fence, uint32_t *index)
{
    static int calls;
    PFN_vkAcquireNextImageKHR next =
        (PFN_vkAcquireNextImageKHR)dlsym(RTLD_NEXT, "vkAcquireNextImageKHR");
    switch (calls++) {
    case 1:
        tell("acquire: out of date");
        return VK_ERROR_OUT_OF_DATE_KHR;
    case 2:
        tell("acquire: surface lost");
        return VK_ERROR_SURFACE_LOST_KHR;
    default:
        return next(device, swapchain, timeout, semaphore, fence, index);
    }
}

VkResult vkQueuePresentKHR(VkQueue queue, const VkPresentInfoKHR *info)
{
    static int calls;
    PFN_vkQueuePresentKHR next = (PFN_vkQueuePresentKHR)dlsym(RTLD_NEXT, "vkQueuePresentKHR");
    VkResult result = next(queue, info);
    switch (calls++) {
    case 2:
        tell("present: suboptimal");
        return VK_SUBOPTIMAL_KHR;
    case 3:
        tell("present: surface lost");
        return VK_ERROR_SURFACE_LOST_KHR;
    default:
        return result;
    }
}
