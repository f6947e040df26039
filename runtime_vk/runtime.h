/* The Vulkan 1.3 runtime: what generated pipelines (NAME_vk.c) call, and the table of verbs for
 * the app. The OpenGL runtime has the same file names and the same verbs. Knows no pipeline. One
 * runtime renders one frame at a time: render waits for the device before it returns. Every
 * function that returns bool has logged the error when it returns false. */
#ifndef DIPTYCH_RUNTIME_VK_H
#define DIPTYCH_RUNTIME_VK_H

#include <vulkan/vulkan.h>

#include "diptych.h"

#pragma GCC visibility push(default) /* what the libraries export */

enum { VK_ALL_MIPS = 0xffff, VK_MAX_COLOR_TARGETS = 8, VK_MAX_MIPS = 16 };

struct vk_runtime;

struct vk_buffer {
    const char *name;
    VkBuffer handle;
    VkDeviceSize offset; /* bytes; 0 but for a host's */
    VkDeviceSize size;   /* bytes, at least 16 */
    VkDeviceSize block;  /* bytes bound as a uniform block, where that is more than size; else 0 */
};

struct vk_image {
    const char *name;
    VkImage handle;
    VkFormat format;
    enum dt_format texel;
    VkImageAspectFlags aspect;
    uint32_t width, height, layers, mips;
    bool layered;
    bool imported;                      /* handle and memory are a host's */
    VkImageLayout layout;               /* as of the commands recorded so far */
    VkImageView view;                   /* all mips, all layers */
    VkImageView mip_views[VK_MAX_MIPS]; /* one mip, all layers */
};

/* Device memory that one or more resources of disjoint lifetimes are bound to. */
struct vk_slot {
    VkDeviceMemory memory;
};

struct vk_slot_user { /* one of the two */
    struct vk_buffer *buffer;
    struct vk_image *image;
};

/* The Vulkan format of a resource's texels, also for vk_program_info.color_formats and
 * depth_format. */
static inline VkFormat vk_format(enum dt_format format)
{
    static const VkFormat formats[DT_FORMAT_COUNT] = {
        [DT_FORMAT_R8] = VK_FORMAT_R8_UNORM,
        [DT_FORMAT_RG8] = VK_FORMAT_R8G8_UNORM,
        [DT_FORMAT_RGBA8] = VK_FORMAT_R8G8B8A8_UNORM,
        [DT_FORMAT_RGBA8_SRGB] = VK_FORMAT_R8G8B8A8_SRGB,
        [DT_FORMAT_R16F] = VK_FORMAT_R16_SFLOAT,
        [DT_FORMAT_RG16F] = VK_FORMAT_R16G16_SFLOAT,
        [DT_FORMAT_RGBA16F] = VK_FORMAT_R16G16B16A16_SFLOAT,
        [DT_FORMAT_R32F] = VK_FORMAT_R32_SFLOAT,
        [DT_FORMAT_RG32F] = VK_FORMAT_R32G32_SFLOAT,
        [DT_FORMAT_RGBA32F] = VK_FORMAT_R32G32B32A32_SFLOAT,
        [DT_FORMAT_R32UI] = VK_FORMAT_R32_UINT,
        [DT_FORMAT_RG32UI] = VK_FORMAT_R32G32_UINT,
        [DT_FORMAT_RGBA32UI] = VK_FORMAT_R32G32B32A32_UINT,
        [DT_FORMAT_R32I] = VK_FORMAT_R32_SINT,
        [DT_FORMAT_D32F] = VK_FORMAT_D32_SFLOAT,
    };
    return formats[format];
}

/* ---- Resources: resize, destroy -------------------------------------------------------------- */

struct vk_buffer_info {
    const char *name;
    VkDeviceSize size;        /* bytes; raised to 16 */
    VkDeviceSize block;       /* bytes of the uniform block that shaders declare; 0: as many */
    VkBufferUsageFlags usage; /* TRANSFER_SRC and _DST are added */
};
bool dt_vk_buffer_create(struct vk_runtime *rt, struct vk_buffer *buffer,
                         const struct vk_buffer_info *info);

struct vk_image_info {
    const char *name;
    enum dt_format format;
    VkImageUsageFlags usage; /* TRANSFER_SRC and _DST are added */
    uint32_t width, height, layers, mips;
    bool layered;
};
/* Creates the image only; views are made by dt_vk_slot_bind, when the memory is there. */
bool dt_vk_image_create(struct vk_runtime *rt, struct vk_image *image,
                        const struct vk_image_info *info);

/* Allocates what the largest user needs, binds all users at offset 0 and makes the images'
 * views. */
bool dt_vk_slot_bind(struct vk_runtime *rt, struct vk_slot *slot, const struct vk_slot_user *users,
                     uint32_t count);

/* Zero-fills resources with history; fills the others with options.poison when that is set.
 * After dt_vk_slot_bind. */
bool dt_vk_initialise(struct vk_runtime *rt, const struct vk_slot_user *user, bool history);

void dt_vk_buffer_destroy(struct vk_runtime *rt,
                          struct vk_buffer *buffer); /* all take zeroed structs, and zero them */
void dt_vk_image_destroy(struct vk_runtime *rt, struct vk_image *image);
void dt_vk_slot_destroy(struct vk_runtime *rt, struct vk_slot *slot);

/* ---- Samplers -------------------------------------------------------------------------------- */

struct vk_sampler_info {
    const char *name;
    VkFilter filter;
    VkSamplerMipmapMode mip_filter;
    VkSamplerAddressMode wrap;
    bool compare;     /* shadow sampler: LESS_OR_EQUAL */
    float anisotropy; /* 1: off */
};
bool dt_vk_sampler_create(struct vk_runtime *rt, VkSampler *sampler,
                          const struct vk_sampler_info *info);
void dt_vk_sampler_destroy(struct vk_runtime *rt, VkSampler *sampler);

/* ---- Programs: one per pass ------------------------------------------------------------------ */

struct vk_binding_slot { /* one line of the descriptor set layout */
    uint32_t binding;
    VkDescriptorType type;
};

struct vk_program_info {
    const char *name;
    struct dt_code compute, vertex, fragment;
    const struct vk_binding_slot *slots;
    uint32_t slot_count;
    /* graphics only */
    VkFormat color_formats[VK_MAX_COLOR_TARGETS];
    uint32_t color_count;
    VkFormat depth_format; /* VK_FORMAT_UNDEFINED: no depth attachment */
    VkCompareOp depth_compare;
    VkCullModeFlags cull; /* front faces are VK_FRONT_FACE_CLOCKWISE, the match of GL_CCW */
    bool depth_test, depth_write, blend_add;
    bool blend_over;     /* by the source's alpha; leaves the target's alone */
    bool scene_vertices; /* attributes of struct dt_vertex at locations 0 to 3; else none */
};

struct vk_program {
    const char *name;
    struct vk_program_info info; /* points into the panel's code */
    VkPipeline pipeline;
    VkPipelineLayout layout;
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    uint32_t slot_count;
};
bool dt_vk_program_create(struct vk_runtime *rt, struct vk_program *program,
                          const struct vk_program_info *info);
void dt_vk_program_destroy(struct vk_runtime *rt, struct vk_program *program);

/* What stands at one line of the layout: a buffer, or an image with or without sampler. */
struct vk_binding {
    uint32_t binding;
    VkDescriptorType type;
    const struct vk_buffer *buffer;
    const struct vk_image *image;
    uint32_t mip;         /* one mip, or VK_ALL_MIPS */
    VkImageLayout layout; /* that the image has when the pass runs */
    VkSampler sampler;
};
/* Writes the descriptor set; all lines of the layout in one call. At resize, never while
 * recording. */
bool dt_vk_program_bind(struct vk_runtime *rt, struct vk_program *program,
                        const struct vk_binding *bindings, uint32_t count);

/* ---- Recording ------------------------------------------------------------------------------- */

/* Debug label and timestamps around a pass. begin asks the observer, when there is one: of a
 * pass that it skips only the barriers are recorded. end then submits, waits and calls it. */
bool dt_vk_pass_begin(struct vk_runtime *rt, uint32_t pass, bool runs);
bool dt_vk_pass_end(struct vk_runtime *rt, uint32_t pass);

struct vk_barrier {
    struct vk_buffer *buffer; /* one of the two */
    struct vk_image *image;
    VkPipelineStageFlags2 src_stage;
    VkAccessFlags2 src_access;
    VkPipelineStageFlags2 dst_stage;
    VkAccessFlags2 dst_access;
    VkImageLayout layout; /* images: the layout from here on */
    bool discard;         /* images: the old content is not needed, old layout is UNDEFINED */
};
/* One vkCmdPipelineBarrier2 for up to 64 of them; but for options.drop_barrier and
 * drop_dependency. */
void dt_vk_barriers(struct vk_runtime *rt, const struct vk_barrier *barriers, uint32_t count);

void dt_vk_dispatch(struct vk_runtime *rt, const struct vk_program *program, uint32_t x, uint32_t y,
                    uint32_t z);
void dt_vk_dispatch_indirect(struct vk_runtime *rt, const struct vk_program *program,
                             const struct vk_buffer *arguments);

struct vk_target {
    struct vk_image *image;
    uint32_t mip;
    bool load; /* keep the content; else clear to `clear` */
    float clear[4];
};
struct vk_targets {
    struct vk_target color[VK_MAX_COLOR_TARGETS];
    uint32_t color_count;
    struct vk_target depth; /* image NULL: none */
    uint32_t layers;        /* 1, or the layers of a layered draw */
};
/* Draws the whole scene `instances` times; a layered draw picks gl_Layer from gl_InstanceIndex. */
void dt_vk_draw_scene(struct vk_runtime *rt, const struct vk_program *program,
                      const struct vk_targets *targets, uint32_t instances);
/* Draws from an index buffer and VkDrawIndexedIndirectCommand[draw_count] that compute passes
 * wrote; indices NULL: the scene's own. */
void dt_vk_draw_scene_indirect(struct vk_runtime *rt, const struct vk_program *program,
                               const struct vk_targets *targets, const struct vk_buffer *indices,
                               const struct vk_buffer *arguments, uint32_t draw_count);
void dt_vk_draw_fullscreen(struct vk_runtime *rt, const struct vk_program *program,
                           const struct vk_targets *targets);
void dt_vk_clear_targets(struct vk_runtime *rt,
                         const struct vk_targets *targets); /* a skipped draw */
/* A skipped dispatch: the mip that it would have written; image in GENERAL layout. */
void dt_vk_clear_image(struct vk_runtime *rt, struct vk_image *image, uint32_t mip,
                       const float clear[4]);
void dt_vk_clear_buffer(struct vk_runtime *rt, struct vk_buffer *buffer);

/* ---- What the runtime brings along: bind these like any resource ----------------------------- */

struct vk_builtin {
    struct vk_buffer frame;     /* uniform block struct dt_frame */
    struct vk_buffer live;      /* uniform block of the live parameters */
    struct vk_buffer vertices;  /* storage, struct dt_vertex[]; also the vertex buffer */
    struct vk_buffer indices;   /* storage, uint[]; also the index buffer */
    struct vk_buffer materials; /* storage or uniform, struct dt_material[DT_MAX_MATERIALS] */
    struct vk_image textures;   /* sampled array, SHADER_READ_ONLY_OPTIMAL */
    VkSampler texture_sampler;  /* trilinear, repeat */
};
const struct vk_builtin *dt_vk_builtin(const struct vk_runtime *rt);

#pragma GCC visibility pop

extern const struct dt_runtime runtime_vk;

#endif
