/* Preloaded before the Vulkan loader and GLFW. The window's surface is out of date, suboptimal and
 * lost, each once, as when people move windows between screens. With LOSE=N,M,... the device is
 * lost instead, at the Nth and the Mth wait for it or query of its health. The device stays lost
 * until the program makes another. Each loss is printed on stderr. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

static void tell(const char *what)
{
    fprintf(stderr, "told: %s\n", what);
}

/* ---- Devices --------------------------------------------------------------------------------- */

static bool device_is_lost;

/* Loses the device if LOSE has the number of this call. Returns whether the device is lost. */
static bool lose_now(void)
{
    static int calls;
    const char *numbers = getenv("LOSE");
    calls++;
    while (numbers && *numbers) {
        char *end;
        if (strtol(numbers, &end, 10) == calls && !device_is_lost) {
            tell("the device is lost");
            device_is_lost = true;
        }
        numbers = end + strspn(end, ",");
    }
    return device_is_lost;
}

VkResult vkCreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo *info,
                        const VkAllocationCallbacks *allocator, VkDevice *device)
{
    PFN_vkCreateDevice next = (PFN_vkCreateDevice)dlsym(RTLD_NEXT, "vkCreateDevice");
    device_is_lost = false;
    return next(physical, info, allocator, device);
}

/* Waits for the real device first, so that objects are not in use when the program destroys
 * them. */
VkResult vkWaitForFences(VkDevice device, uint32_t count, const VkFence *fences, VkBool32 all,
                         uint64_t timeout)
{
    PFN_vkWaitForFences next = (PFN_vkWaitForFences)dlsym(RTLD_NEXT, "vkWaitForFences");
    VkResult result = next(device, count, fences, all, timeout);
    return lose_now() ? VK_ERROR_DEVICE_LOST : result;
}

VkResult vkDeviceWaitIdle(VkDevice device)
{
    PFN_vkDeviceWaitIdle next = (PFN_vkDeviceWaitIdle)dlsym(RTLD_NEXT, "vkDeviceWaitIdle");
    VkResult result = next(device);
    return device_is_lost ? VK_ERROR_DEVICE_LOST : result;
}

static unsigned reset_status(void)
{
    enum { INNOCENT_CONTEXT_RESET = 0x8254 };
    return lose_now() ? INNOCENT_CONTEXT_RESET : 0;
}

typedef void (*proc)(void);
proc glfwGetProcAddress(const char *name);
proc glfwGetProcAddress(const char *name)
{
    proc (*next)(const char *) = (proc(*)(const char *))dlsym(RTLD_NEXT, "glfwGetProcAddress");
    if (strcmp(name, "glGetGraphicsResetStatus") != 0)
        return next(name);
    device_is_lost = false; /* asked for once in each context */
    return (proc)reset_status;
}

/* ---- Surfaces -------------------------------------------------------------------------------- */

VkResult vkAcquireNextImageKHR(VkDevice device, VkSwapchainKHR swapchain, uint64_t timeout,
                               VkSemaphore semaphore, VkFence fence, uint32_t *index)
{
    static int calls;
    PFN_vkAcquireNextImageKHR next =
        (PFN_vkAcquireNextImageKHR)dlsym(RTLD_NEXT, "vkAcquireNextImageKHR");
    switch (getenv("LOSE") ? 0 : calls++) {
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
    switch (getenv("LOSE") ? 0 : calls++) {
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
