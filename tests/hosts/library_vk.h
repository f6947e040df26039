/* The renderer of the examples, with validation. Validation stays silent unless a test provokes it,
 * also about synchronization. */
#pragma once

#include "examples/renderer_vk.h"
#include "library.h"
#include "runtime_vk/diptych_vk.h"

extern struct renderer vk;
extern struct buffer geometry; /* GEOMETRY_BYTES as of lay_triangle */
extern struct dt_vk_scene vk_scene;

/* Setup and teardown of a group of tests. Teardown fails if validation spoke, also of objects that
 * pipelines left behind. */
int open_vulkan(void **state);
int close_vulkan(void **state);

/* Teardown of a test: validation was silent. */
int is_silent(void **state);

struct dt_vk_host vk_host(void);

/* A runtime; with shaders it has their pipeline, made for a frame. */
struct dt_vk_runtime *open_vk_runtime(struct dt_vk_host host, const struct dt_shaders *shaders);
VkCommandBuffer new_commands(void);
void submit_commands(VkCommandBuffer commands);
void finish_commands(VkCommandBuffer commands); /* submits, and waits for all work */

/* Records a copy of an image's first layer, WIDTH x HEIGHT, to `offset` in the geometry's buffer. */
void copy_image(VkCommandBuffer commands, VkImage image, VkImageLayout layout, VkDeviceSize offset);

/* A runtime with the scene and the pipeline of tests/specs/features.yaml. */
struct dt_vk_runtime *open_features(void);

/* Records two frames in flight, in parts of `passes` passes each. `trail`: the trail after both. */
void run_parts(struct dt_vk_runtime *rt, uint32_t passes, uint8_t trail[TRAIL_BYTES]);
void run_frames(struct dt_vk_runtime *rt, uint8_t trail[TRAIL_BYTES]);

/* Opens a runtime, runs two frames of `features` and closes it. */
void vulkan_draw(const struct dt_vk_scene *scene, uint8_t trail[TRAIL_BYTES]);

/* An image of the host's own, of one mip. */
struct own_image {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view; /* as an array */
};

/* Creates the image without a view. */
struct own_image create_image(const VkImageCreateInfo *info);
struct own_image make_image(VkFormat format, VkExtent3D extent, uint32_t layers,
                            VkImageUsageFlags usage);
void destroy_image(const struct own_image *own);

/* How a host imports an image of one mip and HEIGHT rows, that it copies from after each frame. */
struct dt_vk_image import_of(const struct own_image *own, VkFormat format, VkImageUsageFlags usage,
                             uint32_t width);
void move_image(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to);

/* The pipeline of tests/specs/outside.yaml, and the commands that it is recorded into. */
extern struct outside {
    struct dt_vk_runtime *rt;
    VkCommandBuffer commands;
} outside;
bool vulkan_writes(uint32_t resource, uint32_t mip, const struct dt_bytes *bytes);
bool vulkan_records(void);

/* Records a frame, and a copy of its picture to `offset` in the geometry's buffer. */
void record_picture(VkDeviceSize offset);
