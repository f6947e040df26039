/* One pipeline as tables, for every backend: how its resources are stored, what each pass binds and
 * draws into, which features it needs, and `record`, which records a frame by calling verbs.
 * diptych-gen writes these tables into NAME.c; the app fills them from a spec in memory
 * (gen/lower/lower.h). The front (front.h) checks and walks them; a backend implements the verbs.
 * Independent of any graphics API.
 *
 * Tables refer to resources and passes by index in the pipeline's reflection (struct
 * dt_pipeline). */
#ifndef DIPTYCH_PANEL_H
#define DIPTYCH_PANEL_H

#include "device_limits.h"
#include "diptych.h"

/* ---- How passes use resources ---------------------------------------------------------------- */

/* Masks: what a pass does with a resource. */
enum dt_access {
    DT_READ_STORAGE = 1 << 0, /* a storage buffer, or imageLoad */
    DT_WRITE_STORAGE = 1 << 1,
    DT_READ_TEXTURE = 1 << 2, /* texelFetch, or through a sampler */
    DT_READ_UNIFORM = 1 << 3,
    DT_READ_COLOR = 1 << 4, /* a colour target that is blended with or kept */
    DT_WRITE_COLOR = 1 << 5,
    DT_READ_DEPTH = 1 << 6,
    DT_WRITE_DEPTH = 1 << 7,
    DT_READ_INDIRECT = 1 << 8, /* arguments of a draw or dispatch */
    DT_READ_INDEX = 1 << 9,
    DT_WRITE_CLEAR = 1 << 10 /* a clear in place of a skipped pass */
};

/* Masks: where in the pipeline of a device. */
enum dt_stage {
    DT_STAGE_COMPUTE = 1 << 0,
    DT_STAGE_VERTEX = 1 << 1,
    DT_STAGE_FRAGMENT = 1 << 2,
    DT_STAGE_COLOR = 1 << 3, /* writing and blending of colour targets */
    DT_STAGE_DEPTH = 1 << 4, /* depth tests, early and late */
    DT_STAGE_INDIRECT = 1 << 5,
    DT_STAGE_INDEX = 1 << 6,
    DT_STAGE_CLEAR = 1 << 7
};

/* What an image is laid out for while a pass runs. */
enum dt_layout {
    DT_LAYOUT_NONE, /* a buffer */
    DT_LAYOUT_GENERAL,
    DT_LAYOUT_READ, /* textures */
    DT_LAYOUT_COLOR,
    DT_LAYOUT_DEPTH
};

enum { DT_KEEP = 0, DT_DISCARD = 1 }; /* the image's old content, in a barrier */

/* Recorded before a pass: the pass's accesses to `resource` wait for earlier ones. A frame begins
 * with a barrier for all stages of its passes. The first use in a frame chains to that barrier: its `from` is 0, and its
 * from_stages are the pass's own stages. */
struct dt_barrier {
    uint16_t resource;
    uint16_t from_stages; /* enum dt_stage of the earlier accesses */
    /* enum dt_access of the earlier writes; 0: execution dependency, no memory access */
    uint16_t from;
    uint16_t to_stages, to; /* of the accesses that wait */
    uint8_t layout;         /* enum dt_layout of an image after the barrier */
    bool discard;           /* images: the old content is not needed */
};

/* ---- Storage --------------------------------------------------------------------------------- */

struct dt_storage { /* of one resource */
    uint16_t usage; /* enum dt_access over all passes */
    /* resources of one slot are never alive in the same pass: they may share memory */
    uint16_t slot;
    /* an earlier image of the same format and size, never alive at the same time. OpenGL, which
     * cannot share memory, uses its texture for this image; -1: none */
    int16_t share;
    uint32_t block; /* bytes that uniform blocks of the buffer declare; 0: its size */
    bool by_layer;  /* some pass binds one layer of the array */
    float clear[4]; /* clear value of a target or of a skipped pass; depth: clear[0] */
};

enum dt_wrap { DT_WRAP_CLAMP, DT_WRAP_REPEAT, DT_WRAP_MIRROR, DT_WRAP_BORDER };
enum dt_border {
    DT_BORDER_TRANSPARENT_BLACK, /* all zero */
    DT_BORDER_OPAQUE_BLACK,
    DT_BORDER_OPAQUE_WHITE
};

struct dt_sampler {
    const char *name;
    bool linear, linear_mip; /* filtering within and between mips; else nearest */
    enum dt_wrap wrap;
    enum dt_border border; /* DT_WRAP_BORDER: the colour beyond the edge */
    bool compare;          /* a shadow sampler: less or equal */
    float anisotropy;      /* 1: off */
};

/* ---- Programs: one per pass ------------------------------------------------------------------ */

/* Built-in resources, which every runtime provides to bindings. */
enum dt_builtin {
    DT_FRAME = 0xff00,  /* uniform block struct dt_frame */
    DT_LIVE,            /* uniform block of the live parameters */
    DT_SCENE_VERTICES,  /* struct dt_vertex[] */
    DT_SCENE_INDICES,   /* uint32_t[] */
    DT_SCENE_MATERIALS, /* struct dt_material[DT_MAX_MATERIALS] */
    DT_SCENE_OBJECTS,   /* struct dt_object[] */
    DT_SCENE_TEXTURES,  /* array texture, with a trilinear, repeating sampler */
};

enum dt_binding_kind {
    DT_BIND_UNIFORM,
    DT_BIND_STORAGE,
    DT_BIND_TEXELS, /* texel buffer: of DT_SCENE_VERTICES or DT_SCENE_INDICES */
    DT_BIND_TEXTURE,
    DT_BIND_IMAGE
};
enum { /* bytes of an element of a texel buffer: R32G32_UINT, R32_UINT */
       DT_VERTEX_TEXEL = 8,
       DT_INDEX_TEXEL = 4
};
enum { DT_ALL_MIPS = 0xff, DT_MAX_MIPS = 16, DT_MAX_COLOR_TARGETS = 8, DT_MAX_BINDINGS = 64 };
enum {
    DT_DRAW_BYTES = 20,       /* of one indirect draw: VkDrawIndexedIndirectCommand */
    DT_VERTEX_DRAW_BYTES = 16 /* the same without indices: VkDrawIndirectCommand */
};

struct dt_binding {
    uint16_t binding;  /* the number in GLSL */
    uint16_t resource; /* or enum dt_builtin */
    enum dt_binding_kind kind;
    uint8_t mip;    /* one; of a texture with all layers also DT_ALL_MIPS */
    bool one_layer; /* a plain image: `layer` of an array; else all layers */
    uint16_t layer;
    uint8_t layout;  /* images and textures: enum dt_layout during the pass */
    uint16_t access; /* images: DT_READ_STORAGE, DT_WRITE_STORAGE or both */
    /* textures: index into the samplers; -1: nearest and clamped, for texelFetch, a cube as an array
     * of faces */
    int16_t sampler;
    bool codes; /* textures: a view without sRGB, whose texels the shader decodes */
};

/* Factors of a colour; alpha takes the alpha of the same name. */
enum dt_factor {
    DT_FACTOR_ONE,
    DT_FACTOR_ZERO,
    DT_FACTOR_SRC_COLOR,
    DT_FACTOR_ONE_MINUS_SRC_COLOR,
    DT_FACTOR_DST_COLOR,
    DT_FACTOR_ONE_MINUS_DST_COLOR,
    DT_FACTOR_SRC_ALPHA,
    DT_FACTOR_ONE_MINUS_SRC_ALPHA,
    DT_FACTOR_DST_ALPHA,
    DT_FACTOR_ONE_MINUS_DST_ALPHA
};

enum dt_blend_op { /* SUBTRACT: src - dst; MIN and MAX take no factors */
                   DT_BLEND_ADD,
                   DT_BLEND_SUBTRACT,
                   DT_BLEND_REVERSE_SUBTRACT,
                   DT_BLEND_MIN,
                   DT_BLEND_MAX
};

/* The shader's colour (src) and the target's content (dst), each times its factor. Of zeros: add. */
struct dt_blend {
    enum dt_factor src, dst;
    enum dt_blend_op op;
    enum dt_factor alpha_src, alpha_dst;
    enum dt_blend_op alpha_op;
};

struct dt_target {
    uint16_t resource;
    uint8_t mip;
    uint8_t keep;   /* colours: channels that the draw does not write, red in bit 0 */
    bool load;      /* keep the content; else clear it as its storage says */
    bool one_layer; /* `layer` of an array; else, of a layered draw, all layers */
    uint16_t layer;
    const struct dt_blend *blend; /* colours; NULL: replaces the content */
};

enum dt_compare { DT_COMPARE_LESS, DT_COMPARE_LESS_EQUAL, DT_COMPARE_GREATER, DT_COMPARE_ALWAYS };
enum dt_cull { DT_CULL_NONE, DT_CULL_BACK, DT_CULL_FRONT };
enum dt_topology { DT_TRIANGLES, DT_LINES, DT_POINTS };

/* A dispatch has only the bindings. A draw has at least one colour target or a depth target. */
struct dt_program {
    const struct dt_binding *bindings; /* all that its shaders declare */
    uint32_t binding_count;
    const struct dt_target *colors; /* by attachment number */
    uint32_t color_count;
    const struct dt_target *depth; /* NULL: none */
    enum dt_compare compare;
    enum dt_cull cull; /* front faces are counter-clockwise in OpenGL's window coordinates */
    bool depth_test, depth_write;
    bool layered;            /* gl_Layer selects the layer of all targets */
    uint32_t clip_distances; /* that its vertex shader writes */
    uint8_t attributes; /* of struct dt_vertex, the first in bit 0, that its vertex shader reads */
    enum dt_topology topology;
    float bias_constant, bias_slope; /* depth bias of triangles */
};

/* A device feature that a pass needs in addition to those that every pipeline needs. */
struct dt_need {
    uint32_t pass;
    /* of VkPhysicalDeviceFeatures or VkPhysicalDeviceVulkan1?Features, or a bit of
     * VkSubgroupFeatureFlagBits, by their names in Vulkan */
    const char *feature;
};

/* What the shaders of a pass need of a limit, if that is more than the standards promise. What a
 * program's bindings and targets need is not listed: see device_needs.h. */
struct dt_demand {
    uint32_t pass;
    enum dt_device_limit limit;
    uint64_t amount;
};

/* ---- Recording ------------------------------------------------------------------------------- */

/* Texels of a target, row 0 first. */
struct dt_rect {
    int32_t x, y;
    uint32_t width, height;
};

/* The functions that record a frame. Each logs its error and returns false. Between begin and end
 * of a pass come barriers, then bind and the work; if the pass does not run, only clears. `layers`:
 * number of instances and of target layers; 1 except for layered draws. */
struct dt_verbs {
    bool (*begin)(void *runtime, uint32_t pass, bool runs);
    bool (*barriers)(void *runtime, uint32_t pass, const struct dt_barrier *barriers,
                     uint32_t count);
    bool (*bind)(void *runtime, uint32_t pass);
    bool (*dispatch)(void *runtime, uint32_t pass, uint32_t x, uint32_t y, uint32_t z);
    bool (*dispatch_indirect)(void *runtime, uint32_t pass, uint32_t arguments);
    bool (*draw_scene)(void *runtime, uint32_t pass, uint32_t layers);
    /* The size of `arguments` gives the number of draws (DT_DRAW_BYTES each); `indices`: a buffer,
     * or DT_SCENE_INDICES. */
    bool (*draw_indirect)(void *runtime, uint32_t pass, uint32_t layers, uint32_t indices,
                          uint32_t arguments);
    bool (*draw_fullscreen)(void *runtime, uint32_t pass, uint32_t layers);
    bool (*draw_vertices)(void *runtime, uint32_t pass, uint32_t layers, uint32_t vertices,
                          uint32_t instances);
    /* DT_VERTEX_DRAW_BYTES for each draw */
    bool (*draw_vertices_indirect)(void *runtime, uint32_t pass, uint32_t layers,
                                   uint32_t arguments);
    /* Of the pass's draw; without them all of the targets. The front keeps them: a backend has
     * NULL here and asks dt_front_area. */
    bool (*viewport)(void *runtime, uint32_t pass, struct dt_rect viewport);
    bool (*scissor)(void *runtime, uint32_t pass, struct dt_rect scissor);
    bool (*clear_targets)(void *runtime, uint32_t pass, uint32_t layers); /* targets without load */
    bool (*clear_buffer)(void *runtime, uint32_t pass, uint32_t resource); /* to zero */
    bool (*clear_image)(void *runtime, uint32_t pass, uint32_t resource, uint32_t mip);
    bool (*end)(void *runtime, uint32_t pass);
};

struct dt_recording {
    const struct dt_verbs *verbs;
    void *runtime;          /* the verbs' first argument */
    uint32_t width, height; /* of the frame */
    const void *live;       /* struct NAME_live */
    const struct dt_panel *panel;
};

struct dt_panel {
    uint32_t version; /* DT_VERSION of the generator */
    const struct dt_pipeline *pipeline;
    const struct dt_storage *storage;  /* one per resource */
    const struct dt_program *programs; /* one per pass */
    const struct dt_sampler *samplers;
    uint32_t sampler_count;
    uint32_t slot_count;
    const struct dt_need *needs;
    uint32_t need_count;
    const struct dt_demand *demands;
    uint32_t demand_count;
    bool (*record)(const struct dt_recording *recording); /* one frame: all passes */
    const void *plan; /* private data of a plan player; NULL in generated code */
    /* `target: auto`: this panel is for drivers that run on the CPU; the runtime takes the other one, of
     * the same pipeline, where the device is a GPU, or its texel buffers are too short for the scene.
     * NULL: there is none, or no pass differs. */
    const struct dt_panel *gpu;
};

/* ---- For generated C ------------------------------------------------------------------------- */

/* Keeps a size in 1..UINT32_MAX: no resource is empty. */
static inline uint32_t dt_size(int64_t size)
{
    return size < 1 ? 1 : size > UINT32_MAX ? UINT32_MAX : (uint32_t)size;
}

static inline void dt_set_extent(uint32_t extent[3], int64_t x, int64_t y, int64_t z)
{
    extent[0] = dt_size(x);
    extent[1] = dt_size(y);
    extent[2] = dt_size(z);
}

/* Vertices or instances of a draw. */
static inline uint32_t dt_count(int64_t count)
{
    return count < 0 ? 0 : count > INT32_MAX ? INT32_MAX : (uint32_t)count;
}

enum { DT_MAX_SIDE = 16384 };

/* Limits the corner to -DT_MAX_SIDE to DT_MAX_SIDE, width and height to 0 to DT_MAX_SIDE. */
static inline struct dt_rect dt_make_rect(int64_t x, int64_t y, int64_t width, int64_t height)
{
    const int64_t most = DT_MAX_SIDE;
    struct dt_rect rect;
    rect.x = (int32_t)(x < -most ? -most : x > most ? most : x);
    rect.y = (int32_t)(y < -most ? -most : y > most ? most : y);
    rect.width = (uint32_t)(width < 0 ? 0 : width > most ? most : width);
    rect.height = (uint32_t)(height < 0 ? 0 : height > most ? most : height);
    return rect;
}

/* Workgroups for `count` invocations; 0 if count is not positive. */
static inline uint32_t dt_groups(int64_t count, int64_t local)
{
    return count > 0 ? (uint32_t)((count - 1) / local + 1) : 0;
}

/* Invocations of a dispatch of this size; 0 if an axis is not positive. */
static inline uint64_t dt_product(int64_t x, int64_t y, int64_t z)
{
    return x < 1 || y < 1 || z < 1 ? 0 : (uint64_t)(x * y * z);
}

#endif
