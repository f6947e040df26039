/* What the files of the Vulkan runtime share: the runtime's state, the one way to check a
 * result, memory, and commands that run at once. Nobody outside this folder includes it. */
#ifndef DIPTYCH_RUNTIME_VK_INTERNAL_H
#define DIPTYCH_RUNTIME_VK_INTERNAL_H

#include "arena.h"
#include "diptych_vk.h"
#include "dispatch.h"
#include "runtime.h"

enum {
    VK_MAX_SLOTS = 64, /* lines in one descriptor set layout */
    VK_MAX_IMPORTS = 16
};

/* Memory that the host sees, mapped for as long as it lives. */
struct vk_mapped {
    VkDeviceMemory memory;
    void *bytes;
};

/* An image of the host in place of a resource. */
struct vk_import {
    const char *name; /* of the resource */
    struct dt_vk_image given;
    struct vk_image *image; /* as which passes know it; NULL: not since resize */
};

/* First content that a host's command buffer gives, since there is none of ours. */
struct vk_fill {
    struct vk_slot_user user;
    float value;          /* images: of every component */
    VkImageLayout layout; /* images: afterwards */
};

enum { VK_MAX_WINDOW_IMAGES = 8 };

/* The window and what present.c shows in it; made when it is first used. */
struct vk_present {
    void *window; /* GLFWwindow; NULL: opened without */
    bool owns_glfw;
    VkSurfaceKHR surface;
    VkSwapchainKHR swapchain; /* null: to be made before the next frame */
    VkFormat format;
    uint32_t width, height, image_count;
    VkImage images[VK_MAX_WINDOW_IMAGES];
    VkImageView views[VK_MAX_WINDOW_IMAGES];
    VkSemaphore drawn[VK_MAX_WINDOW_IMAGES]; /* of each image: it may be shown */
    VkFence acquired;
    VkSampler samplers[2]; /* filtered, not filtered */
    struct vk_buffer vertices;
    struct vk_mapped vertex_memory;
    struct vk_image textures[DT_WINDOW_TEXTURES];
    struct vk_slot texture_slots[DT_WINDOW_TEXTURES];
    struct vk_program programs[DT_WINDOW_TEXTURES]; /* alike but for what is bound */
};

/* frame.c: what the commands recorded so far have set for draws; zero: nothing yet. */
struct vk_bound {
    VkExtent2D area; /* viewport and scissor */
    bool vertices;   /* the scene's */
    VkBuffer indices;
    VkDeviceSize index_offset;
};

/* program.c: programs of a panel that is being replaced, for the one that follows. */
struct vk_spare {
    bool keeps; /* what is destroyed comes here */
    struct vk_program *programs;
    uint32_t count;
};

struct vk_runtime {
    struct dt_log log;
    bool debug, timing;
    int poison;
    uint32_t drop_barrier;    /* number of the barrier to leave out; 0: none */
    uint32_t drop_dependency; /* of the one that waits for nothing */
    uint32_t messages;
    bool lost; /* a call has said that the device is */

    /* context.c */
    struct vk_dispatch vk;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize max_allocation; /* bytes in one vkAllocateMemory */
    VkDevice device;
    uint32_t queue_family, timestamp_bits;
    VkQueue queue;
    VkCommandPool command_pool;
    struct vk_arena command_memory;
    VkCommandBuffer frame_commands, immediate_commands;
    VkFence fence;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin_label; /* these three only with debug */
    PFN_vkCmdEndDebugUtilsLabelEXT end_label;
    PFN_vkSetDebugUtilsObjectNameEXT set_name;

    struct vk_present present;

    /* resources.c: copies to and from the device pass through here; grows on demand */
    struct vk_buffer staging;
    struct vk_mapped staging_memory;

    /* scene.c, frame.c */
    struct vk_builtin builtin;
    struct vk_mapped frame_memory, live_memory;
    struct vk_slot vertex_slot, index_slot, material_slot, texture_slot;
    uint32_t index_count;
    bool has_scene;

    /* runtime.c */
    const struct dt_panel *panel;
    void *state;
    struct vk_spare spare;
    uint32_t width, height; /* 0: the panel has no resources */
    bool sized; /* the panel's resources exist and its descriptors point at the present scene */

    /* host.c */
    bool hosted; /* device and command buffers are a host's: nothing is submitted or waited for */
    struct vk_import imports[VK_MAX_IMPORTS];
    uint32_t import_count;
    struct vk_fill *fills; /* that the next frame begins with */
    uint32_t fill_count, fill_capacity;
    struct vk_slot frame_slot, live_slot; /* of the uniform blocks, which commands write */

    /* frame.c */
    const struct dt_observer *observer; /* during render */
    bool failed;   /* a recording verb without result has logged an error in this frame */
    uint32_t pass; /* as of the last dt_vk_pass_begin, as the next */
    bool skips;    /* the pass does nothing but its barriers */
    struct vk_bound bound;
    uint32_t barriers;   /* recorded so far in this frame */
    VkQueryPool queries; /* two per pass */
    bool *pass_runs;     /* pass_count of them, as the next two */
    double *pass_ms;
    double record_ms; /* CPU time of recording the last frame; NAN with an observer */
    bool rendered;
};

/* ---- Errors ---------------------------------------------------------------------------------- */

void vk_info(const struct vk_runtime *rt, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Logs one DT_ERROR and returns false. */
bool vk_error(const struct vk_runtime *rt, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* True for VK_SUCCESS; else logs "vkFunction(name): VK_ERROR_...: what to do". `call` is the
 * text of the call. */
bool vk_check(struct vk_runtime *rt, VkResult result, const char *call, const char *name);
#define VK(rt, call, name) vk_check(rt, call, #call, name)

/* ---- Device (device.c) ----------------------------------------------------------------------- */

struct vk_features {
    VkPhysicalDeviceFeatures2 core; /* chains the others */
    VkPhysicalDeviceVulkan11Features vulkan11;
    VkPhysicalDeviceVulkan12Features vulkan12;
    VkPhysicalDeviceVulkan13Features vulkan13;
};
/* Everything that the device has of what pipelines may need. */
void vk_features_wanted(const struct vk_runtime *rt, struct vk_features *features);
/* Whether the device has what the passes of a pipeline need. */
bool vk_device_suits_panel(const struct vk_runtime *rt, const struct dt_panel *panel);

/* Writes what the device lacks, ", "-separated, to `text`; true when that is nothing. */
bool vk_device_suits(const struct vk_runtime *rt, VkPhysicalDevice physical, char *text,
                     size_t size);
/* The first queue family with graphics and compute; UINT32_MAX: there is none. */
uint32_t vk_device_queue_family(const struct vk_runtime *rt, VkPhysicalDevice physical,
                                uint32_t *timestamp_bits);
/* Makes it the runtime's. */
void vk_device_describe(struct vk_runtime *rt, VkPhysicalDevice physical);

/* ---- Context (context.c) --------------------------------------------------------------------- */

/* With a window where `window` says so. */
bool vk_context_open(struct vk_runtime *rt, const char *device, bool window);
void vk_context_close(struct vk_runtime *rt); /* takes what a failed open left behind */

/* Names a handle in messages of the validation layers; does nothing without debug. */
void vk_set_name(const struct vk_runtime *rt, VkObjectType type, uint64_t handle, const char *name);

/* ---- Resources (resources.c) ----------------------------------------------------------------- */

/* A buffer in host-visible, coherent memory. */
bool vk_mapped_create(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_mapped *mapped,
                      const struct vk_buffer_info *info);
void vk_mapped_destroy(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_mapped *mapped);

/* At least `size` bytes of staging memory; NULL after an error that names `name`. Undoes earlier
 * pointers. */
void *vk_staging(struct vk_runtime *rt, VkDeviceSize size, const char *name);

uint32_t vk_texel_size(enum dt_format format); /* bytes */

/* A uniform block: mapped, or in device memory for a host, where commands write it. */
bool vk_uniform_create(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_mapped *mapped,
                       struct vk_slot *slot, const struct vk_buffer_info *info);
void vk_uniform_destroy(struct vk_runtime *rt, struct vk_buffer *buffer, struct vk_mapped *mapped,
                        struct vk_slot *slot);

/* Notes down first content; of image or buffer that is not of an import. */
bool vk_fill_later(struct vk_runtime *rt, const struct vk_fill *fill);

/* ---- Commands (frame.c) ---------------------------------------------------------------------- */

/* Commands that are executed and waited for on the spot: between begin and end record into the
 * command buffer that begin returns; NULL after an error. Work before and after is ordered
 * against them. */
VkCommandBuffer vk_immediate_begin(struct vk_runtime *rt, const char *name);
bool vk_immediate_end(struct vk_runtime *rt, const char *name);
/* The same, and signals the semaphore for what comes to wait for it. */
bool vk_immediate_end_signal(struct vk_runtime *rt, const char *name, VkSemaphore done);

/* Everything before happens before everything after, and is visible to it; the host too. */
void vk_full_barrier(const struct vk_runtime *rt, VkCommandBuffer commands);
/* The same for one image, which moves to `layout`; a layout of UNDEFINED so far loses the
 * content. */
void vk_transition(const struct vk_runtime *rt, VkCommandBuffer commands, struct vk_image *image,
                   VkImageLayout layout);

bool vk_frame_create(struct vk_runtime *rt); /* for rt->panel */
void vk_frame_destroy(struct vk_runtime *rt);
bool vk_frame_render(struct vk_runtime *rt, const struct dt_frame *frame, const void *live);

/* Records the frame into a command buffer of the host. */
bool vk_frame_record(struct vk_runtime *rt, VkCommandBuffer commands, const struct dt_frame *frame,
                     const void *live);
/* Of the last frame, into rt->pass_ms. */
bool vk_frame_timings(struct vk_runtime *rt);

/* ---- The pipeline (panel.c) ------------------------------------------------------------------ */

void vk_programs_forget(struct vk_runtime *rt); /* the spare ones; program.c */
bool vk_panel_create(struct vk_runtime *rt, const struct dt_panel *panel);
bool vk_panel_resize(struct vk_runtime *rt, uint32_t width, uint32_t height);
void vk_panel_destroy(struct vk_runtime *rt);

/* ---- Read-back and its inverse (readback.c), scene (scene.c) --------------------------------- */

/* Size and extent of one mip; no data. */
struct dt_bytes vk_image_shape(const struct vk_image *image, uint32_t mip);

/* Size and extent are given, here and in `out`, whose data these allocate. */
bool vk_read_buffer(struct vk_runtime *rt, const struct vk_buffer *buffer, struct dt_bytes *out);
bool vk_read_image(struct vk_runtime *rt, struct vk_image *image, uint32_t mip,
                   struct dt_bytes *out);
bool vk_write_buffer(struct vk_runtime *rt, const struct vk_buffer *buffer,
                     const struct dt_bytes *bytes);
bool vk_write_image(struct vk_runtime *rt, struct vk_image *image, uint32_t mip,
                    const struct dt_bytes *bytes);

/* ---- The window (present.c) ------------------------------------------------------------------ */

bool vk_window_open(struct vk_runtime *rt); /* before the instance */
/* The instance extensions that surfaces need. */
const char *const *vk_window_extensions(uint32_t *count);
bool vk_window_surface(struct vk_runtime *rt); /* after the instance; also when it was lost */
bool vk_window_can_present(const struct vk_runtime *rt, VkPhysicalDevice physical, uint32_t family);
bool vk_window_copy(struct vk_runtime *rt, uint32_t texture, struct vk_image *image);
bool vk_window_upload(struct vk_runtime *rt, uint32_t texture, uint32_t width, uint32_t height,
                      const uint8_t *pixels);
bool vk_present(struct vk_runtime *rt, const struct dt_window_frame *frame);
void vk_present_destroy(struct vk_runtime *rt); /* before the device */
void vk_window_close(struct vk_runtime *rt);    /* after it, before the instance */

bool vk_scene_upload(struct vk_runtime *rt, const struct dt_scene *scene);
void vk_scene_destroy(struct vk_runtime *rt);

#endif
