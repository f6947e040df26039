/* Pipelines of diptych in a Vulkan renderer that is there already. The host brings instance, device and
 * command buffer; the passes of a pipeline are recorded between commands of its own. Nothing is
 * submitted, nothing is waited for, no queue is touched. diptych_gl.h is the same for OpenGL.
 *
 *     struct vk_runtime *rt = dt_vk_open(&(struct dt_vk_host){
 *         .log = log, .instance = instance, .physical_device = physical, .device = device,
 *         .queue_family = family, .get_instance_proc_addr = vkGetInstanceProcAddr});
 *     dt_vk_import_scene(rt, &(struct dt_vk_scene){.vertices = ..., .indices = ..., ...});
 *     dt_vk_create(rt, &ssvp_vk);
 *     dt_vk_import_image(rt, SSVP_RESOURCE_DISPLAY, &(struct dt_vk_image){.image = mine, ...});
 *     dt_vk_resize(rt, width, height);
 *     each frame:
 *         vkBeginCommandBuffer(commands, ...);
 *         ... commands of the host ...
 *         dt_vk_record(rt, commands, &frame, &live);
 *         ... commands of the host, which may use `mine` at once ...
 *         vkEndCommandBuffer(commands); vkQueueSubmit2(...);
 *     dt_vk_close(rt);
 *
 * `ssvp_vk`, a struct dt_shaders, SSVP_RESOURCE_DISPLAY and struct ssvp_live come from the files that
 * diptych-gen writes: compile NAME.c and NAME_vk_shaders.c into the host, and include NAME.h.
 *
 * Errors. A function that returns false or NULL has said why in one DT_ERROR to the log; a runtime whose
 * resize or record failed takes nothing but resize and close. There is no other output, no global
 * state, no exit.
 *
 * Several pipelines. A runtime holds one pipeline; open as many on one device as there are pipelines or
 * frame sizes. They share nothing but what the host gives to both.
 *
 * Threads. One thread at a time may use a runtime, and the command buffer that it is given; different
 * runtimes of one device may be used by different threads at once.
 *
 * Device. Vulkan 1.3, a queue family with graphics and compute, and the features that
 * dt_vk_need_features sets, which depend on the pipeline; no extensions.
 *
 * Synchronisation. What record writes into a command buffer begins and ends with a full memory barrier
 * (all stages, all accesses). So
 *   - the host needs no barrier before: whatever it did earlier on the queue to what it imported is
 *     finished and visible. Work of other queues must be waited for with a semaphore, and ownership of
 *     exclusive resources be with `queue_family`;
 *   - the host needs no barrier after: later commands of the queue see all that was written. Reading on
 *     the host side takes a fence, as always; the barrier includes VK_PIPELINE_STAGE_2_HOST_BIT.
 * Images have the layouts that struct dt_vk_image says.
 *
 * Frames in flight. A pipeline has one set of resources, and even the uniform blocks are written by
 * commands: the host may record the next frame while others are still running, as many as it likes, so
 * long as all command buffers go to one queue in the order of recording, each once. After a command
 * buffer that was recorded but is never submitted, call dt_vk_resize. Functions that make or destroy
 * (import, create, resize, close) want every submitted command buffer of the runtime to have finished. */
#ifndef DIPTYCH_VK_H
#define DIPTYCH_VK_H

#include <vulkan/vulkan.h>

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

#pragma GCC visibility push(default) /* what the libraries export */

struct vk_runtime;

struct dt_vk_host {
    struct dt_log log; /* message NULL: silence */
    /* All of these must outlive the runtime. */
    VkInstance instance; /* of apiVersion 1.3 or higher */
    VkPhysicalDevice physical_device;
    VkDevice device;       /* with the features of dt_vk_need_features for every pipeline enabled */
    uint32_t queue_family; /* of the queue that the command buffers go to; graphics and compute */
    /* The loader's, or that of the host's own loader. Every Vulkan function is called through it. */
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    bool labels; /* debug labels and object names; the instance has VK_EXT_debug_utils enabled */
    bool timing; /* timestamps around every pass, for dt_vk_timings */
};

/* Sets to VK_TRUE what a device must have enabled for the pipeline, and leaves all else as it is.
 * Call it for each pipeline on the feature structures that vkCreateDevice is going to get. Where the
 * physical device lacks one of them, dt_vk_create says so and names the pass. */
void dt_vk_need_features(const struct dt_shaders *shaders, VkPhysicalDeviceFeatures *core,
                         VkPhysicalDeviceVulkan11Features *vulkan11,
                         VkPhysicalDeviceVulkan12Features *vulkan12,
                         VkPhysicalDeviceVulkan13Features *vulkan13);

/* NULL: the device lacks something, which the log tells. */
struct vk_runtime *dt_vk_open(const struct dt_vk_host *host);
void dt_vk_close(struct vk_runtime *rt); /* takes NULL; leaves what was imported alone */

/* ---- The scene ------------------------------------------------------------------------------- */

/* Bytes `offset` to `offset + size` of a buffer; the offset is a multiple of the device's
 * minStorageBufferOffsetAlignment and minUniformBufferOffsetAlignment. */
struct dt_vk_range {
    VkBuffer buffer;
    VkDeviceSize offset, size;
};

/* What passes draw and read. The buffers stay the host's, must live until the next import or close, and
 * may be written between frames: the next frame sees it. */
struct dt_vk_scene {
    struct dt_vk_range vertices; /* struct dt_vertex[]; usage VERTEX_BUFFER and STORAGE_BUFFER */
    struct dt_vk_range
        indices; /* uint32_t[], three per triangle; INDEX_BUFFER, STORAGE_BUFFER; lavapipe: offset 0 */
    uint32_t index_count;
    /* struct dt_material[DT_MAX_MATERIALS], whatever stands behind those in use; STORAGE_BUFFER,
     * UNIFORM_BUFFER */
    struct dt_vk_range materials;
    /* Array of all textures (VK_IMAGE_VIEW_TYPE_2D_ARRAY, sRGB colour, linear alpha, a full chain of
     * mips), usage SAMPLED, in SHADER_READ_ONLY_OPTIMAL during every frame. VK_NULL_HANDLE: no
     * material has a texture. */
    VkImageView textures;
};
/* Before resize, and again with a resize after it when a handle, a size or index_count changes. A pipeline
 * whose passes neither draw nor read the scene needs none. */
bool dt_vk_import_scene(struct vk_runtime *rt, const struct dt_vk_scene *scene);

/* ---- The pipeline ---------------------------------------------------------------------------- */

/* Makes the programs, which takes seconds on some drivers; replaces the former pipeline, and takes over
 * programs of the same code. What the shaders point to must live as long as the runtime has it. */
bool dt_vk_create(struct vk_runtime *rt, const struct dt_shaders *shaders);

/* An image of the host in place of a resource of the pipeline: a single-sampled 2D image of optimal
 * tiling with the format, size, layers and mips of the resource. Row 0 in memory is NDC y = -1, the
 * bottom of the picture: turn it over when presenting, as vkCmdBlitImage does into a swapchain's image,
 * which itself is seldom fit for an import. Not written outside of record. */
struct dt_vk_image {
    VkImage image; /* lives until the next import of the resource, create or close */
    VkFormat format;
    VkImageUsageFlags usage; /* of its making; resize says what is missing */
    uint32_t width, height, layers, mips;
    /* The layout that it is in when the commands of a frame begin. UNDEFINED: the content may be lost,
     * which is right for every output that the pipeline writes anew. */
    VkImageLayout layout_before;
    /* The layout that the frame leaves it in, as TRANSFER_SRC_OPTIMAL for a copy. UNDEFINED: whatever
     * the last pass needed, see dt_vk_resource. */
    VkImageLayout layout_after;
};
/* `resource` is NAME_RESOURCE_...; after create, before resize. An image of VK_NULL_HANDLE takes the
 * import back. */
bool dt_vk_import_image(struct vk_runtime *rt, uint32_t resource, const struct dt_vk_image *image);

/* Makes all other resources, for frames of that size in pixels. Content with history becomes zero in
 * the next frame. */
bool dt_vk_resize(struct vk_runtime *rt, uint32_t width, uint32_t height);

/* Records one frame, all passes. `commands` is a primary command buffer in the recording state, outside
 * of a render pass, for `queue_family`. What was bound or set in it before is no longer. Of `frame`
 * width and height are filled in; `index` is the host's to count from 0 after every resize. `live` is
 * the pipeline's block of live parameters, struct NAME_live; NULL: their defaults. Both are read before
 * the function returns. Allocates nothing. */
bool dt_vk_record(struct vk_runtime *rt, VkCommandBuffer commands, const struct dt_frame *frame,
                  const void *live);

/* What a resource is made of, imported or not: to copy it, or to sample it, after the commands of a
 * frame. Of resources that are no outputs other passes may have taken the memory. NULL handles for the
 * kind that it is not; good until resize. */
struct dt_vk_resource {
    VkBuffer buffer;
    VkImage image;
    VkImageView view; /* all mips and layers */
    VkFormat format;
    VkImageLayout layout; /* that the commands recorded last leave it in */
};
bool dt_vk_resource(struct vk_runtime *rt, uint32_t resource, struct dt_vk_resource *out);

/* Milliseconds of each pass of the frame recorded last, pass_count of them, NAN for a skipped one. Its
 * command buffer must have finished. */
bool dt_vk_timings(struct vk_runtime *rt, double *pass_ms);

#pragma GCC visibility pop

#ifdef __cplusplus
}
#endif
#endif
