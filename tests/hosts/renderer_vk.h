/* The Vulkan renderer that was there before diptych, and knows nothing of it: a device, command buffers
 * for two frames in flight, buffers and pictures. host_vk.c takes pipelines into it. Whatever fails ends
 * the program. */
#ifndef RENDERER_VK_H
#define RENDERER_VK_H

#include <stdbool.h>

#include <vulkan/vulkan.h>

enum { IN_FLIGHT = 2 };

#define CHECK(call) check((call) == VK_SUCCESS, #call)
void check(bool good, const char *what);

struct buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    void *bytes; /* mapped */
};

/* RGBA8, and where its pixels arrive. */
struct picture {
    VkImage image;
    VkDeviceMemory memory;
    struct buffer pixels;
};

struct renderer {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device; /* and its queue of family 0 */
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer commands[IN_FLIGHT];
    VkFence fences[IN_FLIGHT];
    uint32_t width, height;
};

/* `features` is chained to what vkCreateDevice gets. */
void renderer_open(struct renderer *renderer, const VkPhysicalDeviceFeatures2 *features);
void renderer_close(struct renderer *renderer);

struct buffer make_buffer(const struct renderer *renderer, VkDeviceSize size,
                          VkBufferUsageFlags usage);
void destroy_buffer(const struct renderer *renderer, const struct buffer *buffer);

struct picture make_picture(const struct renderer *renderer, VkImageUsageFlags usage);
void destroy_picture(const struct renderer *renderer, const struct picture *picture);
/* `layout` is the one it is in. */
void copy_picture(const struct renderer *renderer, VkCommandBuffer commands,
                  const struct picture *picture, VkImageLayout layout);
void write_picture(const struct renderer *renderer, const struct picture *picture,
                   const char *path); /* PPM, of what was copied last */

/* A frame: its commands are recorded in between. */
VkCommandBuffer begin_frame(struct renderer *renderer, uint32_t frame);
void end_frame(struct renderer *renderer, uint32_t frame);
void wait_for_frames(const struct renderer *renderer);

#endif
