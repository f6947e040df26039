/* Preloaded before the Vulkan loader, EGL and GLFW. With LOSE=N,M,... the device is lost, at the Nth and the Mth wait
 * for it or query of its health; with LOSE_WINDOW=N,M,... the context of the window. What is lost stays lost until the
 * program makes another. Each loss is printed on stderr. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

static struct loss {
    const char *variable, *what;
    int calls;
    bool is_lost;
} device = {"LOSE", "device", 0, false}, window = {"LOSE_WINDOW", "window", 0, false};

/* Loses it if the variable has the number of this call. Returns whether it is lost. */
static bool lose_now(struct loss *loss)
{
    const char *numbers = getenv(loss->variable);
    loss->calls++;
    while (numbers && *numbers) {
        char *end;
        if (strtol(numbers, &end, 10) == loss->calls && !loss->is_lost) {
            fprintf(stderr, "told: the %s is lost\n", loss->what);
            loss->is_lost = true;
        }
        numbers = end + strspn(end, ",");
    }
    return loss->is_lost;
}

/* ---- Vulkan ---------------------------------------------------------------------------------- */

VkResult vkCreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo *info,
                        const VkAllocationCallbacks *allocator, VkDevice *made)
{
    PFN_vkCreateDevice next = (PFN_vkCreateDevice)dlsym(RTLD_NEXT, "vkCreateDevice");
    device.is_lost = false;
    return next(physical, info, allocator, made);
}

/* Waits for the real device first, so that objects are not in use when the program destroys
 * them. */
VkResult vkWaitForFences(VkDevice of, uint32_t count, const VkFence *fences, VkBool32 all,
                         uint64_t timeout)
{
    PFN_vkWaitForFences next = (PFN_vkWaitForFences)dlsym(RTLD_NEXT, "vkWaitForFences");
    VkResult result = next(of, count, fences, all, timeout);
    return lose_now(&device) ? VK_ERROR_DEVICE_LOST : result;
}

VkResult vkDeviceWaitIdle(VkDevice of)
{
    PFN_vkDeviceWaitIdle next = (PFN_vkDeviceWaitIdle)dlsym(RTLD_NEXT, "vkDeviceWaitIdle");
    VkResult result = next(of);
    return device.is_lost ? VK_ERROR_DEVICE_LOST : result;
}

/* ---- OpenGL: a session's context is EGL's, the window's GLFW's ---------------------------------- */

enum { INNOCENT_CONTEXT_RESET = 0x8254 };

static unsigned device_status(void)
{
    return lose_now(&device) ? INNOCENT_CONTEXT_RESET : 0;
}

static unsigned window_status(void)
{
    return lose_now(&window) ? INNOCENT_CONTEXT_RESET : 0;
}

typedef void (*proc)(void);

/* The function is asked for once in each context. */
static proc load(const char *loader, const char *name, struct loss *loss, unsigned (*status)(void))
{
    proc (*next)(const char *) = (proc(*)(const char *))dlsym(RTLD_NEXT, loader);
    if (strcmp(name, "glGetGraphicsResetStatus") != 0)
        return next(name);
    loss->is_lost = false;
    return (proc)status;
}

proc eglGetProcAddress(const char *name);
proc eglGetProcAddress(const char *name)
{
    return load("eglGetProcAddress", name, &device, device_status);
}

proc glfwGetProcAddress(const char *name);
proc glfwGetProcAddress(const char *name)
{
    return load("glfwGetProcAddress", name, &window, window_status);
}
