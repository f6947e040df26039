/* Shared by the files of the Vulkan runtime: the runtime's state, the VK macro for results, memory,
 * and immediate commands. Private to this folder and its tests. */
#pragma once

#include "diptych_vk.h"
#include "dispatch.h"
#include "front.h"

/* ---- Objects --------------------------------------------------------------------------------- */

struct vk_buffer {
    const char *name;
    VkBuffer handle;
    VkDeviceSize offset;        /* bytes; 0 except in a host's buffer */
    VkDeviceSize size;          /* bytes that are bound; the memory has at least 16 */
    VkDeviceSize block;         /* bytes bound as a uniform block, if more than size; else 0 */
    VkBufferView texels;        /* created when first bound as a texel buffer */
    VkBufferUsageFlags usage;   /* as created; of an import 0 */
    bool imported;              /* the host owns handle and memory */
    struct dt_vk_memory memory; /* owned; null: a slot's or a host's */
    void *bytes;                /* owned memory, always mapped; NULL: not mapped */
};

struct vk_image {
    const char *name;
    VkImage handle;
    VkFormat format;
    enum dt_format texel;
    VkImageAspectFlags aspect;
    VkImageUsageFlags usage;                     /* as created */
    uint32_t width, height, depth, layers, mips; /* depth: 1 except of a 3D image */
    enum dt_shape shape;
    bool layered;
    bool by_layer;                       /* bound by single layers, too */
    bool imported;                       /* the host owns handle and memory */
    struct dt_vk_memory memory;          /* owned; null: a slot's or a host's */
    VkImageLayout layout;                /* as of the commands recorded so far */
    VkImageView view;                    /* all mips, all layers */
    VkImageView codes;                   /* the same without sRGB; made when it is first bound */
    VkImageView mip_views[DT_MAX_MIPS];  /* one mip, all layers; of a cube as an array */
    VkImageView cube_views[DT_MAX_MIPS]; /* one mip as cubes */
    VkImageView *layer_views; /* one mip, one layer: [mip * layers + layer]; NULL: not by_layer */
};

/* Element of dt_core's array: buffer or image; the other one is zero. */
struct vk_resource {
    struct vk_buffer buffer;
    struct vk_image image;
};

/* What the host chose for a resource: element of the core's choices; null handles: not imported. */
struct vk_choice {
    struct dt_vk_image image;
    struct dt_vk_range buffer;
    VkFlags usage; /* in addition, if not imported */
};

struct vk_program {
    VkPipeline handle;
    VkPipelineLayout layout;
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool pool;
    VkDescriptorSet set;
};

/* Of a layered program: the layer to draw, -1 for all. */
extern const VkPushConstantRange vk_layer_range;

/* Objects that the runtime provides to every pipeline. */
struct vk_builtin {
    struct vk_buffer buffers[DT_SCENE_TEXTURES - DT_FRAME]; /* by enum dt_builtin */
    struct dt_vk_attribute attributes[DT_ATTRIBUTES]; /* those that the scene lacks: any other */
    struct vk_image textures;
    VkSampler texture_sampler; /* trilinear, repeat */
    VkSampler texel_sampler;   /* for texelFetch, without filtering */
};

struct vk_features {
    VkPhysicalDeviceFeatures2 core; /* chains the others */
    VkPhysicalDeviceVulkan11Features vulkan11;
    VkPhysicalDeviceVulkan12Features vulkan12;
    VkPhysicalDeviceVulkan13Features vulkan13;
};

/* What the commands of a frame have set, to be set again only when it changes. Zeroed: nothing. */
struct vk_bound {
    const struct vk_buffer *indices; /* with the attributes of the scene */
    VkViewport viewport;
    VkRect2D scissor;
};

struct dt_vk_runtime {
    struct dt_core core;       /* first member: the front casts dt_core pointers */
    struct dt_backend backend; /* vk_backend; runtime.c adds functions for the app */
    bool debug;
    bool labels;   /* names for debuggers; with debug, too */
    bool captures; /* statistics of programs (statistics.c); then no commands run */

    /* context.c */
    struct vk_dispatch vk;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize max_allocation; /* bytes in one vkAllocateMemory */
    VkDevice device;
    struct vk_features features; /* enabled ones */
    /* of the host; zero: none */
    const VkAllocationCallbacks *callbacks;
    struct dt_vk_allocator allocator;
    struct dt_vk_threads threads;
    VkPipelineCache cache;
    uint32_t queue_family, timestamp_bits;
    VkQueue queue;
    VkCommandPool command_pool;
    VkCommandBuffer frame_commands, immediate_commands;
    VkFence fence;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin_label; /* these three only with labels */
    PFN_vkCmdEndDebugUtilsLabelEXT end_label;
    PFN_vkSetDebugUtilsObjectNameEXT set_name;

    struct vk_buffer staging; /* for copies to and from the device; grows on demand */
    struct vk_builtin builtin;

    /* panel.c: of the pipeline */
    struct dt_vk_memory *slots;
    struct vk_buffer upload; /* host: for dt_vk_write, as large as the largest input image */
    VkQueryPool queries;     /* two per pass and slot */

    /* Of a frame. */
    struct vk_bound bound;
    double record_ms; /* CPU time of recording the last frame; NAN with an observer */
    bool fills;       /* host: the next frame first fills resources with history */
};

static inline struct dt_vk_runtime *vk_runtime_of(struct dt_core *core)
{
    return (struct dt_vk_runtime *)core;
}

static inline struct vk_resource *vk_resource_at(const struct dt_vk_runtime *rt, uint32_t resource)
{
    return dt_resource(&rt->core, resource);
}

/* `resource`: index in the pipeline, or enum dt_builtin. */
static inline struct vk_buffer *vk_buffer_at(struct dt_vk_runtime *rt, uint32_t resource)
{
    return resource < DT_FRAME ? &vk_resource_at(rt, resource)->buffer
                               : &rt->builtin.buffers[resource - DT_FRAME];
}

static inline struct vk_choice *vk_choice_at(const struct dt_vk_runtime *rt, uint32_t resource)
{
    return dt_choice(&rt->core, resource);
}

/* Whether vertex shaders can choose the layer; if not, each layer is drawn alone. */
static inline bool vk_has_layers(const struct dt_vk_runtime *rt)
{
    return rt->features.vulkan12.shaderOutputLayer;
}

/* ---- Errors (errors.c) ----------------------------------------------------------------------- */

/* True for VK_SUCCESS; else logs "vkFunction(name): VK_ERROR_...: what to do". `call` is the
 * text of the call. */
bool vk_check(struct dt_vk_runtime *rt, VkResult result, const char *call, const char *name);
#define VK(rt, call, name) vk_check(rt, call, #call, name)

/* With VK_EXT_debug_utils: takes its functions for labels and names. */
void vk_load_labels(struct dt_vk_runtime *rt, PFN_vkGetInstanceProcAddr get);
/* Names a handle in messages of the validation layers; does nothing without debug. */
void vk_set_name(const struct dt_vk_runtime *rt, VkObjectType type, uint64_t handle,
                 const char *name);

/* ---- Device (device.c) ----------------------------------------------------------------------- */

/* All known features that the device supports, chained for vkCreateDevice. */
void vk_features_supported(const struct dt_vk_runtime *rt, struct vk_features *features);
/* Sets rt->features to those that a host enabled; logs a missing one that every pipeline needs. */
bool vk_features_enabled(struct dt_vk_runtime *rt, const VkDeviceCreateInfo *info);
/* Whether the features that the passes need are enabled; logs a missing one. */
bool vk_device_suits_panel(struct dt_vk_runtime *rt, const struct dt_panel *panel);

/* Writes the features that the device lacks to `text`, separated by ", "; true if there are
 * none. `panel`: also one that its passes lack; NULL: any pipeline. */
bool vk_device_suits(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                     const struct dt_panel *panel, char *text, size_t size);
/* Whether its limits are enough for the panel's passes (NULL: none); if not, `text` gets a sentence. */
bool vk_device_is_enough(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                         const struct dt_panel *panel, char *text, size_t size);
/* Whether the queue family is there, with graphics and compute. */
bool vk_device_family_suits(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                            uint32_t family, uint32_t *timestamp_bits);
/* The first such queue family; UINT32_MAX: there is none. */
uint32_t vk_device_queue_family(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                                uint32_t *timestamp_bits);
/* Stores the device, its name and its limits in the runtime. */
void vk_device_describe(struct dt_vk_runtime *rt, VkPhysicalDevice physical);

/* ---- Context (context.c) --------------------------------------------------------------------- */

bool vk_context_open(struct dt_vk_runtime *rt, const struct dt_runtime_options *options);
void vk_context_close(struct dt_vk_runtime *rt); /* also after a failed open */

/* ---- Resources (resources.c) ----------------------------------------------------------------- */

VkFormat vk_format(enum dt_format format);
VkImageLayout vk_layout(unsigned layout); /* enum dt_layout */
/* What masks of enum dt_access need of a resource (panel.c). */
VkBufferUsageFlags vk_buffer_usage(unsigned usage);
VkImageUsageFlags vk_image_usage(unsigned usage);
/* Of masks of enum dt_stage and enum dt_access (verbs.c). */
VkPipelineStageFlags2 vk_stages(unsigned stages);
VkAccessFlags2 vk_accesses(unsigned accesses);

/* All destroy functions take zeroed structs, and zero them. */
struct vk_buffer_info {
    const char *name;
    VkDeviceSize size;        /* bytes */
    VkDeviceSize block;       /* bytes of the uniform block that shaders declare; 0: size */
    VkBufferUsageFlags usage; /* TRANSFER_SRC and _DST are added */
};
bool vk_buffer_create(struct dt_vk_runtime *rt, struct vk_buffer *buffer,
                      const struct vk_buffer_info *info); /* without memory */
/* The same with its own memory: device memory, or mapped, host-visible memory. */
bool vk_buffer_create_own(struct dt_vk_runtime *rt, struct vk_buffer *buffer,
                          const struct vk_buffer_info *info, bool mapped);
/* Uses `least` bytes or all of a host's range; an error names `name`. */
bool vk_buffer_import(const struct dt_vk_runtime *rt, struct vk_buffer *buffer, const char *name,
                      const struct dt_vk_range *range, VkDeviceSize least);
/* Creates `texels`, unless it is there. resource: DT_SCENE_VERTICES or DT_SCENE_INDICES. */
bool vk_buffer_texels(struct dt_vk_runtime *rt, struct vk_buffer *buffer, uint16_t resource);
void vk_buffer_destroy(struct dt_vk_runtime *rt, struct vk_buffer *buffer);

struct vk_image_info {
    const char *name;
    enum dt_format format;
    VkImageUsageFlags usage; /* of an import all that it needs; else see vk_image_create */
    uint32_t width, height, mips;
    uint32_t layers; /* or depth */
    enum dt_shape shape;
    bool layered;
    bool by_layer;                    /* makes views of single layers */
    const struct dt_vk_image *import; /* the host's image to use instead; NULL: none */
};
/* Without memory and views. Adds usage SAMPLED, TRANSFER_SRC and TRANSFER_DST. */
bool vk_image_create(struct dt_vk_runtime *rt, struct vk_image *image,
                     const struct vk_image_info *info);
bool vk_is_cube(enum dt_shape shape); /* also an array of cubes */
/* Makes image->codes: of a format of sRGB, and not cubes. */
bool vk_image_codes(struct dt_vk_runtime *rt, struct vk_image *image);
/* The view of a mip and of one or all of its layers; a cube is an array. */
VkImageView vk_image_view(const struct vk_image *image, uint32_t mip, bool one_layer,
                          uint32_t layer);
/* All layers of a mip, tightly packed from the first byte of a buffer. */
VkBufferImageCopy vk_mip_region(const struct vk_image *image, uint32_t mip);
bool vk_image_create_own(struct dt_vk_runtime *rt, struct vk_image *image,
                         const struct vk_image_info *info); /* with both */
void vk_image_destroy(struct dt_vk_runtime *rt, struct vk_image *image);

/* Allocates memory, device-local if possible; errors name `name`. */
bool vk_memory_create(struct dt_vk_runtime *rt, struct dt_vk_memory *memory,
                      const VkMemoryRequirements *needs, const char *name);
void vk_memory_destroy(struct dt_vk_runtime *rt, struct dt_vk_memory *memory);
/* Bind memory; vk_image_bind creates views, and binds no memory to an imported image. */
bool vk_buffer_bind(struct dt_vk_runtime *rt, const struct vk_buffer *buffer,
                    const struct dt_vk_memory *memory);
bool vk_image_bind(struct dt_vk_runtime *rt, struct vk_image *image,
                   const struct dt_vk_memory *memory);

/* Of struct dt_backend; a sampler is a VkSampler. */
bool vk_sampler_create(struct dt_core *core, void *sampler, const struct dt_sampler *info);
void vk_sampler_destroy(struct dt_core *core, void *made);

/* At least `size` bytes of staging memory; NULL after an error that names `name`. Invalidates
 * earlier pointers. */
void *vk_staging(struct dt_vk_runtime *rt, VkDeviceSize size, const char *name);

/* Replace the content, from tightly packed bytes, and wait. The rest of a buffer becomes zero; an image is
 * in `layout` afterwards, or stays in UNDEFINED as it may be. */
bool vk_buffer_write(struct dt_vk_runtime *rt, const struct vk_buffer *buffer, const void *data,
                     size_t size);
bool vk_image_write(struct dt_vk_runtime *rt, struct vk_image *image, uint32_t mip,
                    const void *data, size_t size, VkImageLayout layout);
/* Set every byte, and wait. */
bool vk_buffer_fill(struct dt_vk_runtime *rt, const struct vk_buffer *buffer, int byte);
bool vk_image_fill(struct dt_vk_runtime *rt, struct vk_image *image, int byte);

/* ---- Programs (program.c) -------------------------------------------------------------------- */

struct vk_program_info {
    const char *name;
    const struct dt_stages *stages;
    const struct dt_program *state; /* of its targets: blending and masks */
    VkFormat color_formats[DT_MAX_COLOR_TARGETS];
    VkFormat depth_format; /* VK_FORMAT_UNDEFINED: no depth attachment */
};
bool vk_program_create(struct dt_vk_runtime *rt, struct vk_program *program,
                       const struct vk_program_info *info);
/* The same in two steps: all but the VkPipeline; the VkPipeline, which takes long. Several threads may
 * compile different programs of one runtime. */
bool vk_program_begin(struct dt_vk_runtime *rt, struct vk_program *program,
                      const struct vk_program_info *info);
struct vk_outcome {
    VkResult result;
    const char *call; /* that did not succeed */
};
struct vk_outcome vk_program_compile(const struct dt_vk_runtime *rt, struct vk_program *program,
                                     const struct vk_program_info *info);
void vk_program_destroy(struct dt_core *core, void *made);
/* Of a pass of the core's panel (panel.c). */
struct vk_program_info vk_program_info_of(const struct dt_core *core, uint32_t pass);

/* Of struct dt_backend: writes all bindings of the program in one call. */
bool vk_program_connect(struct dt_core *core, void *made, uint32_t pass);

/* ---- Commands (frame.c) ---------------------------------------------------------------------- */

/* Immediate commands: record into the command buffer that begin returns (NULL after an error); end
 * submits and waits. Full barriers order them against work before and after. */
VkCommandBuffer vk_immediate_begin(struct dt_vk_runtime *rt, const char *name);
bool vk_immediate_end(struct dt_vk_runtime *rt, const char *name);

/* Orders all earlier commands before all later ones; makes writes visible, also to the host. */
void vk_full_barrier(const struct dt_vk_runtime *rt, VkCommandBuffer commands);
/* The same for one image, with a change to `layout`. An old layout of UNDEFINED loses the content. */
void vk_transition(const struct dt_vk_runtime *rt, VkCommandBuffer commands, struct vk_image *image,
                   VkImageLayout layout);

/* Functions of struct dt_backend. */
bool vk_frame_render(struct dt_core *core, const struct dt_frame *frame, const void *live);
bool vk_frame_pause(struct dt_core *core);
bool vk_frame_resume(struct dt_core *core);
bool vk_frame_timing(struct dt_core *core, uint32_t run, const char *name, double *ms);
/* Of the frame's slot, before its timestamps. */
void vk_reset_queries(const struct dt_vk_runtime *rt);

/* ---- The pipeline (panel.c, verbs.c) --------------------------------------------------------- */

extern const struct dt_backend vk_backend; /* functions for the app and other programs */
extern const struct dt_commands vk_commands;
extern const struct dt_runtime runtime_vk; /* runtime.c */

bool vk_builtin_create(struct dt_vk_runtime *rt); /* all except the live block and the scene */
void vk_builtin_destroy(struct dt_vk_runtime *rt);
void vk_scene_destroy(struct dt_vk_runtime *rt); /* what is not imported */

/* ---- For the app: read-back (readback.c), scene (scene.c) ------------------------------------- */

/* Functions of struct dt_backend. */
bool vk_read(struct dt_core *core, uint32_t resource, uint32_t mip, struct dt_bytes *out);
bool vk_write(struct dt_core *core, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes);
/* Where the scene's attributes stand: as given, else in the vertices. False after an error. */
bool vk_scene_attributes(struct dt_vk_runtime *rt,
                         const struct dt_vk_attribute given[DT_ATTRIBUTES]);
bool vk_scene_upload(struct dt_core *core, const struct dt_scene *scene,
                     const struct dt_scene_buffer buffers[DT_SCENE_BUFFERS]);
