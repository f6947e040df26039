/* Runs pipelines of diptych inside an existing Vulkan renderer, the host. The host provides
 * instance, device and command buffer; diptych records the passes of a pipeline between the host's
 * commands. diptych submits nothing, waits for nothing and touches no queue. diptych_gl.h is the
 * same for OpenGL.
 *
 *     dt_vk_suits(&(struct dt_vk_host){...}, &ssvp_vk) to choose a physical device
 *     dt_vk_need_features(&ssvp_vk, &core, &vulkan11, &vulkan12, &vulkan13);
 *     vkCreateDevice(physical, &info, ...); with these structures in `info`
 *     struct dt_vk_runtime *rt = dt_vk_open(&(struct dt_vk_host){
 *         .log = log, .instance = instance, .physical_device = physical, .device = device,
 *         .queue_family = family, .get_instance_proc_addr = vkGetInstanceProcAddr,
 *         .device_info = &info});
 *     dt_vk_import_scene(rt, &(struct dt_vk_scene){.vertices = ..., .indices = ..., ...});
 *     dt_vk_create(rt, &ssvp_vk);
 *     dt_vk_import_image(rt, SSVP_RESOURCE_DISPLAY, &(struct dt_vk_image){.image = mine, ...});
 *     dt_vk_resize(rt, width, height);
 *     each frame:
 *         dt_scene_compose(&camera, &light, &extent, width, height, &frame); from diptych_scene.h
 *         vkBeginCommandBuffer(commands, ...);
 *         ... dt_vk_write(rt, commands, ...) for inputs of the pipeline, at least once ...
 *         ... commands of the host ...
 *         dt_vk_record(rt, commands, &frame, &live);
 *         ... commands of the host, which may use `mine` at once ...
 *         vkEndCommandBuffer(commands); vkQueueSubmit2(...);
 *     dt_vk_close(rt);
 *
 * diptych-gen generates `ssvp_vk` (a struct dt_shaders), SSVP_RESOURCE_DISPLAY and struct
 * ssvp_live: compile NAME.c and NAME_vk_shaders.c into the host, and include NAME.h.
 *
 * Errors. A function that returns false or NULL has logged one DT_ERROR with the reason; with NULL in
 * place of the runtime it does nothing, since that open has failed. After a
 * failed resize or record, call only resize or close. There is no other output, no global state, no
 * exit.
 *
 * Several pipelines. A runtime holds one pipeline; open one runtime per pipeline and frame size,
 * all on one device. Runtimes share only objects that the host imports into both. A second view of one
 * pipeline, for example of another size, finds its programs in `pipeline_cache` or the driver's cache.
 *
 * Threads. One thread at a time may use a runtime and the command buffer passed to it; any thread,
 * for every call. Different threads may use different runtimes of one device at once: to open,
 * create and resize them, to record, and to close. The log and the host's callbacks are then called
 * from all of them. create takes long: call it on a thread of its own, or give `threads`.
 *
 * Memory. diptych allocates in open, import_scene, create and resize, and nothing in a
 * frame. With `callbacks` and `allocator` all memory of Vulkan objects is the host's. Resources that
 * are never needed at the same time share memory.
 *
 * Device. Vulkan 1.3, a queue family with graphics and compute, and the features that
 * dt_vk_need_features sets, which depend on the pipeline; no extensions.
 *
 * Synchronisation. The commands of record, record_passes and write begin and end with a full memory
 * barrier (all stages, all accesses). So
 *   - the host needs no barrier before: its earlier work on the queue is finished and visible. Work
 *     of other queues needs a semaphore. A resource of another queue family must be acquired before
 *     record, in layout_before, and may be released after it, in the layout of dt_vk_get_resource;
 *   - the host needs no barrier after: later commands of the queue see all results. Reading on the
 *     CPU needs a fence, as always; the barrier includes VK_PIPELINE_STAGE_2_HOST_BIT.
 * struct dt_vk_image gives the layouts of images.
 *
 * Frames in flight. A pipeline has one set of resources. Commands write even its uniform blocks, so
 * that each frame has its own live parameters. The host may record any number of frames while earlier
 * ones still run. All command buffers must go to one queue, in the order of recording, each once. If a
 * recorded command buffer is never submitted, call dt_vk_resize. Before import, create, resize and
 * close, every submitted command buffer of the runtime must have finished. */
#ifndef DIPTYCH_VK_H
#define DIPTYCH_VK_H

#include <vulkan/vulkan.h>

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

#pragma GCC visibility push(default) /* what the libraries export */

struct dt_vk_runtime;

/* Memory that the host allocated: `memory` from `offset` on. `allocation`: for `free`, or NULL. */
struct dt_vk_memory {
    VkDeviceMemory memory;
    VkDeviceSize offset;
    void *allocation;
};

/* Allocates memory for images and buffers, which only the device accesses. `name`: the largest one;
 * `needs` fits all that share the memory. On an error *out is ignored. With VMA:
 *
 *     VmaAllocationCreateInfo info = {.preferredFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
 *     VmaAllocation allocation; VmaAllocationInfo got;
 *     VkResult result = vmaAllocateMemory(user, needs, &info, &allocation, &got);
 *     if (result == VK_SUCCESS)
 *         *out = (struct dt_vk_memory){got.deviceMemory, got.offset, allocation};
 *     return result;
 *
 * and vmaFreeMemory(user, memory->allocation) in `free`. */
struct dt_vk_allocator {
    void *user;
    VkResult (*allocate)(void *user, const VkMemoryRequirements *needs, const char *name,
                         struct dt_vk_memory *out);
    void (*free)(void *user, const struct dt_vk_memory *memory);
};

/* Calls job(data, i) for every i below `count`, on any threads and at the same time, and returns
 * after the last. create compiles one pass in each call. */
struct dt_vk_threads {
    void *user;
    void (*run)(void *user, uint32_t count, void (*job)(void *data, uint32_t i), void *data);
};

struct dt_vk_host {
    struct dt_log log; /* message NULL: no log */
    /* All of these must outlive the runtime. */
    VkInstance instance; /* of apiVersion 1.3 or higher */
    VkPhysicalDevice physical_device;
    VkDevice device;       /* with the features of dt_vk_need_features for every pipeline enabled */
    uint32_t queue_family; /* of the queue that the command buffers go to; graphics and compute */
    /* From the Vulkan loader or the host's own. The runtime loads all Vulkan functions with it. */
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    /* What vkCreateDevice got, with its pNext chain; borrowed for open. open and create then check
     * the enabled features. NULL: they check only what the physical device supports. */
    const VkDeviceCreateInfo *device_info;
    /* The next four are optional, and outlive the runtime if given. */
    const VkAllocationCallbacks *callbacks; /* for every Vulkan object; NULL: none */
    struct dt_vk_allocator allocator;       /* zero: vkAllocateMemory for each block */
    VkPipelineCache pipeline_cache; /* not EXTERNALLY_SYNCHRONIZED if others use it meanwhile */
    struct dt_vk_threads threads;   /* zero: the thread that calls create */
    bool labels; /* debug labels and object names; the instance has VK_EXT_debug_utils enabled */
    bool timing; /* timestamps around every pass, for dt_vk_timings */
    /* frames in flight whose timings are kept, up to 16; 0: 1. All else may have any number of frames
     * in flight */
    uint32_t frames;
    /* Resources with history, and inputs, keep their content over resize and create, where name, size
     * and layout are the same. Not after a failed frame, nor from one not recorded to its end; all
     * recorded commands have been submitted. */
    bool keep_history;
    /* AUTO: create takes the shaders for CPU drivers where the physical device is of type CPU and the
     * scene, which is then imported before create, fits into its texel buffers; else those for GPUs.
     * The bits are the same. */
    enum dt_target_device target;
};

/* Whether the pipeline runs on host->physical_device; if not, logs the features that the device lacks,
 * and the passes that need them. Reads of the host only log, instance, physical_device,
 * get_instance_proc_addr and timing: call it for each physical device, to choose one before
 * vkCreateDevice. */
bool dt_vk_suits(const struct dt_vk_host *host, const struct dt_shaders *shaders);

/* Sets the features that the pipeline needs to VK_TRUE; changes no others. Call it for each pipeline on
 * the feature structures for vkCreateDevice, which fails if the device lacks one: see dt_vk_suits. The
 * host may clear shaderOutputLayer again, and then gives device_info: each layer of a layered pass is
 * drawn alone. dt_vk_create logs a feature that is not enabled, and the pass, and the pipeline before
 * stays. */
void dt_vk_need_features(const struct dt_shaders *shaders, VkPhysicalDeviceFeatures *core,
                         VkPhysicalDeviceVulkan11Features *vulkan11,
                         VkPhysicalDeviceVulkan12Features *vulkan12,
                         VkPhysicalDeviceVulkan13Features *vulkan13);

/* NULL after an error, for example if the device lacks a required feature. */
struct dt_vk_runtime *dt_vk_open(const struct dt_vk_host *host);
void dt_vk_close(struct dt_vk_runtime *rt); /* accepts NULL; does not destroy imported objects */

/* ---- The scene ------------------------------------------------------------------------------- */

/* Bytes `offset` to `offset + size` of a buffer; the offset is a multiple of the device's
 * minStorageBufferOffsetAlignment, minUniformBufferOffsetAlignment and
 * minTexelBufferOffsetAlignment. */
struct dt_vk_range {
    VkBuffer buffer;
    VkDeviceSize offset, size;
};

/* One attribute of the vertices: a float vector or uint as in struct dt_vertex, every `stride` bytes
 * from `offset` on. Both are multiples of 4; a stride is at most 2048. Usage VERTEX_BUFFER. */
struct dt_vk_attribute {
    VkBuffer buffer;
    VkDeviceSize offset;
    uint32_t stride;
};

/* The scene that passes draw and read. The host owns the buffers; they must live until the next import or
 * close. The host may write them between frames; the next frame uses the new content. */
struct dt_vk_scene {
    /* struct dt_vertex[]; usage VERTEX_BUFFER, for CPU drivers UNIFORM_TEXEL_BUFFER, and for GPUs
     * STORAGE_BUFFER. VK_NULL_HANDLE: no pass reads scene_vertices, and `attributes` has all
     * that draws read */
    struct dt_vk_range vertices;
    /* of a layout of the host's own, in place of a field of `vertices`; VK_NULL_HANDLE: none */
    struct dt_vk_attribute attributes[DT_ATTRIBUTES];
    /* uint32_t[], three per triangle; usage INDEX_BUFFER and those of `vertices`; lavapipe: offset
     * 0 */
    struct dt_vk_range indices;
    uint32_t index_count;
    /* struct dt_material[DT_MAX_MATERIALS]; unused elements may have any content; STORAGE_BUFFER,
     * UNIFORM_BUFFER */
    struct dt_vk_range materials;
    /* struct dt_object[]; STORAGE_BUFFER. VK_NULL_HANDLE: no pass reads scene_objects */
    struct dt_vk_range objects;
    /* Array of all textures: VK_IMAGE_VIEW_TYPE_2D_ARRAY, sRGB colour, linear alpha, a full chain
     * of mips; usage SAMPLED; in SHADER_READ_ONLY_OPTIMAL during every frame. VK_NULL_HANDLE: no
     * material has a texture. */
    VkImageView textures;
    /* With `diptych-gen --codes`: the same as VK_FORMAT_R8G8B8A8_UNORM, for exact passes that fetch
     * codes; the image has VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT, as all imports of rgba8_srgb have. */
    VkImageView texture_codes;
    /* Each triangle begins with a vertex of its own, whose `triangle` is the triangle's number;
     * dt_number_triangles makes such arrays. The runtime does not read them: it takes the host's
     * word, and resize fails without it where a pass reads vertex_triangle, which NAME.h tells. */
    bool numbered;
};
/* Call before resize. Import and resize again when a handle, a size or index_count changes. A
 * pipeline whose passes neither draw nor read the scene needs no scene. */
bool dt_vk_import_scene(struct dt_vk_runtime *rt, const struct dt_vk_scene *scene);

/* ---- The pipeline ---------------------------------------------------------------------------- */

/* Creates the programs, which takes seconds on some drivers. Replaces the previous pipeline and
 * reuses its unchanged programs. The shaders must live until the next create or close. */
bool dt_vk_create(struct dt_vk_runtime *rt, const struct dt_shaders *shaders);

/* An image of the host, used for a resource of the pipeline: single-sampled, optimal tiling, with
 * the format, size, layers and mips of the resource; 2D, or 3D with the depth in `layers`; for a
 * cube created with CUBE_COMPATIBLE. diptych never writes an imported input. Row 0 in memory is NDC y = -1, the bottom
 * of the picture: flip the image when presenting, for example with vkCmdBlitImage into a swapchain
 * image. Swapchain images themselves are seldom fit for an import. diptych writes the image only in
 * record. */
struct dt_vk_image {
    VkImage image; /* lives until the next import of the resource, create or close */
    VkFormat format;
    VkImageUsageFlags usage; /* as created; resize reports missing ones */
    uint32_t width, height, layers, mips;
    /* Layout of the image when the commands of a frame begin. UNDEFINED: the old content may be
     * lost, which suits outputs that every frame overwrites; an error for a resource with history. */
    VkImageLayout layout_before;
    /* Layout of the image after the frame, for example TRANSFER_SRC_OPTIMAL. UNDEFINED: the layout
     * of the last pass, see dt_vk_get_resource. */
    VkImageLayout layout_after;
};
/* `resource` is NAME_RESOURCE_...; call after create, before resize. An image of VK_NULL_HANDLE
 * cancels the import. */
bool dt_vk_import_image(struct dt_vk_runtime *rt, uint32_t resource,
                        const struct dt_vk_image *image);

/* A buffer of the host, used for a resource of the pipeline: at least as many bytes as the resource
 * has, laid out as in NAME.h. The usage has what buffer_usage of dt_vk_get_resource has without the
 * import, but for the transfers: STORAGE_BUFFER, or UNIFORM_BUFFER, INDIRECT_BUFFER, INDEX_BUFFER if
 * passes use it so. The offset is also a multiple of 4. The buffer lives until the next import of the
 * resource, create or close. Call after create, before resize. A buffer of VK_NULL_HANDLE cancels the
 * import. diptych never writes an imported input; the host may write it between frames. */
bool dt_vk_import_buffer(struct dt_vk_runtime *rt, uint32_t resource,
                         const struct dt_vk_range *range);

/* Creates the resource with this usage, too, for commands of the host: COLOR_ATTACHMENT to draw into
 * it, VERTEX_BUFFER to draw from it. Replaces an earlier call for the resource; no effect on an
 * import. Call after create, before resize, which reports a usage that the device lacks. */
bool dt_vk_add_image_usage(struct dt_vk_runtime *rt, uint32_t resource, VkImageUsageFlags usage);
bool dt_vk_add_buffer_usage(struct dt_vk_runtime *rt, uint32_t resource, VkBufferUsageFlags usage);

/* Creates all other resources, for a frame size in pixels. The next frame sets resources with
 * history to zero, but not imported ones, nor those that keep_history has kept. */
bool dt_vk_resize(struct dt_vk_runtime *rt, uint32_t width, uint32_t height);

/* Hands in the content of an input: of a buffer (mip 0), or of one mip of an image. record needs
 * every input that is not imported, after each resize; the content then stays, and may be replaced
 * between frames. Also inputs with a `file` in the spec: diptych reads no files for a host. `bytes`:
 * the whole resource or mip, tightly packed, row 0 first, that is the bottom of a picture; elements
 * of a struct lie as in NAME.h. Its `extent` is what NAME_pipeline.extent gives for the frame size, of
 * an image halved for each mip, at least 1. The function copies them into `commands`, which are as for
 * record: frames recorded later see the new content, earlier ones the old. For large images that change
 * in every frame, an import is faster. */
bool dt_vk_write(struct dt_vk_runtime *rt, VkCommandBuffer commands, uint32_t resource,
                 uint32_t mip, const struct dt_bytes *bytes);

/* Records all passes of one frame. `commands` is a primary command buffer of `queue_family` in the
 * recording state, outside of a render pass; earlier bindings and dynamic state are lost. Ignores
 * width and height of `frame`; the host counts `index` from 0 after every resize. `live`: the live
 * parameters, struct NAME_live; NULL: their defaults. The function reads both before it returns.
 * Allocates nothing. */
bool dt_vk_record(struct dt_vk_runtime *rt, VkCommandBuffer commands, const struct dt_frame *frame,
                  const void *live);

/* Records the passes `first` to `end` - 1, so that commands of the host can stand between two parts
 * of a frame, in the same command buffer or in another one:
 *
 *     dt_vk_record_passes(rt, commands, &frame, &live, 0, SSVP_PASS_SHADE);
 *     ... commands of the host ...
 *     dt_vk_record_passes(rt, commands, NULL, NULL, SSVP_PASS_SHADE, SSVP_PASSES);
 *
 * `first` is 0 or the `end` of the call before. The frame is complete when `end` is NAME_PASSES; resize
 * abandons it. `frame` and `live` of the first part hold for the whole frame; later ones are not read.
 * Every part begins and ends with the barrier, so that the host may read and write, between the
 * parts, each resource that dt_vk_get_resource gives, without a barrier but for changes of layout: it finds
 * an image in `layout`, and leaves it so. A pass that replaces all of a resource discards what the host
 * wrote. Outputs have content only after the pass that writes them; before it, their memory is that of
 * other resources: do not write them. Imported images have layout_before until their first pass, and
 * layout_after after the last part. */
bool dt_vk_record_passes(struct dt_vk_runtime *rt, VkCommandBuffer commands,
                         const struct dt_frame *frame, const void *live, uint32_t first,
                         uint32_t end);

/* The Vulkan objects of a resource, imported or not, to copy or sample it after the commands of a
 * frame; all that is in flight shares them. Members of the other kind are 0. Valid until resize;
 * diptych owns what the host did not import. */
struct dt_vk_resource {
    VkBuffer buffer;
    VkDeviceSize offset, size; /* bytes; offset: 0 unless imported */
    uint32_t stride;           /* bytes from element to element */
    /* with TRANSFER_SRC and TRANSFER_DST; of an import 0 */
    VkBufferUsageFlags buffer_usage;
    VkImage image;
    VkImageView view; /* all mips and layers */
    VkFormat format;
    VkImageUsageFlags usage; /* SAMPLED, TRANSFER_SRC and more; of an import: as the host said */
    uint32_t width, height, layers, mips; /* layers: also the depth of a 3D image */
    VkImageLayout layout;                 /* after the commands recorded last */
    /* of the last write by these commands: of a pass, or of a clear in place of a skipped one */
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 accesses;
};
/* To copy an output after record, four lines give it another layout:
 *
 *     dt_vk_get_resource(rt, SSVP_RESOURCE_DISPLAY, &r);
 *     barrier.srcStageMask = r.stages, barrier.srcAccessMask = r.accesses;  // VkImageMemoryBarrier2
 *     barrier.image = r.image, barrier.oldLayout = r.layout;
 *     barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, ... and the copy as destination
 *
 * Resources with `history`, inputs and imports go back to r.layout before the next frame, which finds
 * them so; frames write others anew. */
/* An error if the resource is neither an output, nor imported, nor has `keep: true`, `history: true`
 * or content from outside in the spec: other passes may have reused its memory. Also an error between
 * the parts of a frame for an output that no part so far has written. */
bool dt_vk_get_resource(struct dt_vk_runtime *rt, uint32_t resource, struct dt_vk_resource *out);

/* Milliseconds of each pass of a frame, pass_count values; NAN: skipped. `age`: 0 is the frame recorded
 * last, 1 the one before, up to `frames` - 1 of the host; all since resize. The frame is complete, and
 * its command buffers have finished: this function never waits. So a host with two frames in flight
 * asks for age 1, once it has waited for that frame's fence and before it records into the command
 * buffer again. */
bool dt_vk_timings(struct dt_vk_runtime *rt, uint32_t age, double *pass_ms);

#pragma GCC visibility pop

#ifdef __cplusplus
}
#endif
#endif
