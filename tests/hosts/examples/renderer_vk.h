/* The Vulkan renderer that was there before diptych, and knows nothing of it: a device, threads, each with
 * command buffers for two frames in flight, memory, buffers and pictures. host_vk.c and host_inputs_vk.cpp
 * take pipelines into it. Whatever fails ends the program. */
#ifndef RENDERER_VK_H
#define RENDERER_VK_H

#include <stdbool.h>

#include <vulkan/vulkan.h>

#ifdef __cplusplus
#include <atomic>
using std::atomic_int; /* laid out as C's */
extern "C" {
#else
#include <stdatomic.h>
#endif

enum { IN_FLIGHT = 2, LANES = 3 };

#define CHECK(call) check((call) == VK_SUCCESS, #call)
void check(bool good, const char *what);

struct buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    void *bytes; /* mapped */
};

/* An image of the frame's size, and where its pixels arrive if it is RGBA8. */
struct picture {
    VkImage image;
    VkDeviceMemory memory;
    struct buffer pixels;
};

/* What one thread records into. */
struct lane {
    VkCommandPool pool;
    VkCommandBuffer commands[IN_FLIGHT];
};

struct renderer {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkPhysicalDeviceFeatures core; /* these four: what the device enables */
    VkPhysicalDeviceVulkan11Features vulkan11;
    VkPhysicalDeviceVulkan12Features vulkan12;
    VkPhysicalDeviceVulkan13Features vulkan13;
    VkDeviceCreateInfo device_info;
    VkDevice device; /* and its queue of family 0 */
    VkQueue queue;
    VkPipelineCache cache;
    VkAllocationCallbacks callbacks;
    atomic_int blocks; /* allocated by the callbacks, and not freed */
    struct lane lanes[LANES];
    VkFence fences[IN_FLIGHT];
    uint32_t width, height;
};

/* Chains the features, all off. The caller then sets those that it needs. */
void renderer_prepare(struct renderer *renderer);

/* Opens the first physical device that suits, of an instance that the caller may have made. */
void renderer_open(struct renderer *renderer,
                   bool (*suits)(VkInstance instance, VkPhysicalDevice physical));
void renderer_close_device(struct renderer *renderer);
void renderer_close(struct renderer *renderer); /* the device and the instance */

/* Calls job(data, i) for each i below `count`, on threads. */
void renderer_run(void *renderer, uint32_t count, void (*job)(void *data, uint32_t i), void *data);

VkDeviceMemory renderer_allocate(const struct renderer *renderer, const VkMemoryRequirements *needs,
                                 VkMemoryPropertyFlags wanted);

struct buffer make_buffer(const struct renderer *renderer, VkDeviceSize size,
                          VkBufferUsageFlags usage);
void destroy_buffer(const struct renderer *renderer, const struct buffer *buffer);

struct picture make_picture(const struct renderer *renderer, VkFormat format,
                            VkImageUsageFlags usage);
void destroy_picture(const struct renderer *renderer, const struct picture *picture);
/* `layout` is the one it is in. */
void copy_picture(const struct renderer *renderer, VkCommandBuffer commands,
                  const struct picture *picture, VkImageLayout layout);
void write_picture(const struct renderer *renderer, const struct picture *picture,
                   const char *path); /* PPM, of what was copied last */

/* A frame: the commands of its lanes are recorded in between, each lane's by one thread. */
void begin_frame(struct renderer *renderer, uint32_t frame);
VkCommandBuffer begin_commands(struct renderer *renderer, uint32_t frame, uint32_t lane);
void end_frame(struct renderer *renderer, uint32_t frame, uint32_t lanes);
void wait_for_frames(const struct renderer *renderer);

#ifdef __cplusplus
}
#endif
#endif
