/* Types that generated pipelines, both runtimes and the app share: the reflection of a pipeline,
 * the scene, and the verbs of a runtime. Independent of any graphics API and pipeline.
 *
 * Units: lengths in metres or in the scene's unit after `scale`; angles in radians; radiometry in
 * W, m, sr. All matrices are column-major (m[column][row]). Clip space is that of Vulkan and of
 * glClipControl(LOWER_LEFT, ZERO_TO_ONE): depth 0..1; row 0 of every image in memory is NDC y =
 * -1. */
#ifndef DIPTYCH_H
#define DIPTYCH_H

#include <assert.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus /* C++ has it as static_assert */
#define _Static_assert static_assert
#endif

/* ---- Version: semantic, see semver.org ------------------------------------------------------- */

#define DT_MAKE_VERSION(major, minor, patch) ((major)*1000000 + (minor)*1000 + (patch))
#define DT_VERSION_MAJOR                     0
#define DT_VERSION_MINOR                     1
#define DT_VERSION_PATCH                     0
#define DT_VERSION                           DT_MAKE_VERSION(DT_VERSION_MAJOR, DT_VERSION_MINOR, DT_VERSION_PATCH)

/* Binary interface: the structs and functions of the installed headers, and the tables of generated
 * code. Before 1.0.0 each minor version may break it, a patch may not; from then on each major
 * version. The soname has the part that may: libdiptych_vk.so.0.1, later .so.1. A library takes
 * generated code of its own part, and of no newer minor version; it refuses other code at create.
 * `backend` and `panel` of struct dt_shaders and `version` of struct dt_panel keep their places. */
#define DT_TAKES(version)                                                                          \
    ((version) / 1000000 == DT_VERSION_MAJOR &&                                                    \
     (DT_VERSION_MAJOR ? (version) / 1000 <= DT_VERSION / 1000                                     \
                       : (version) / 1000 == DT_VERSION / 1000))

#define DT_ARRAY_COUNT(a) (sizeof(a) / sizeof((a)[0]))

/* ---- Log: the only output of code below the command line ------------------------------------- */

enum dt_level { DT_DEBUG, DT_INFO, DT_WARNING, DT_ERROR };

/* `message` has no trailing newline. A function that fails logs exactly one DT_ERROR, which names
 * the thing and what to do, then returns false or NULL. Its callers log nothing more. Messages of
 * the validation layers and of KHR_debug are DT_ERRORs, too, and count in the runtime's
 * `messages`. */
struct dt_log {
    void (*message)(void *user, enum dt_level level, const char *message);
    void *user;
};

/* ---- Reflection: emitted once per pipeline, the same object for both backends ---------------- */

enum dt_type {
#define DT_TYPE(ENUMERATOR, ...) DT_TYPE_##ENUMERATOR,
#include "types.def"
    DT_TYPE_COUNT
};

enum dt_format {
#define DT_FORMAT(ENUMERATOR, ...) DT_FORMAT_##ENUMERATOR,
#include "formats.def"
    DT_FORMAT_COUNT
};

enum dt_kind { DT_BUFFER, DT_IMAGE };

/* What a sampler sees in an image. */
enum dt_shape {
    DT_SHAPE_2D,        /* one image, or an array of them */
    DT_SHAPE_3D,        /* extent[2] is its depth, halved from mip to mip */
    DT_SHAPE_CUBE,      /* six layers: +x, -x, +y, -y, +z, -z */
    DT_SHAPE_CUBE_ARRAY /* six layers for each cube */
};

struct dt_field {
    const char *name;
    enum dt_type type;
    uint32_t offset;      /* bytes from the start of the element */
    uint32_t array_count; /* 0: not an array */
    uint32_t array_stride;
};

/* How far the two backends may differ in one resource; see the spec's `contracts`. */
enum dt_contract_kind {
    DT_CONTRACT_EXACT,
    DT_CONTRACT_ULP,    /* tolerance: units in the last place */
    DT_CONTRACT_ABS,    /* tolerance: absolute */
    DT_CONTRACT_REL,    /* tolerance: relative to the larger magnitude */
    DT_CONTRACT_IMAGE,  /* tolerance: absolute, beyond which a texel is an outlier */
    DT_CONTRACT_FLIPS,  /* tolerance: elements that may have another value */
    DT_CONTRACT_RASTER, /* tolerance: share of the texels that may differ, all at edges, 0..1 */
    /* tolerance: of each copy, relative to what exact arithmetic makes of the same inputs; outliers: as IMAGE */
    DT_CONTRACT_OF_EXACT
};
struct dt_contract {
    enum dt_contract_kind kind;
    double tolerance; /* unused for EXACT */
    double outliers;  /* IMAGE, OF_EXACT: share of texels that may be outliers, 0..1 */
    /* FLIPS: buffer (index into resources) and field with the margin of each element: how narrowly
     * its value was decided; margin_field -1: none */
    uint16_t margin_resource;
    int16_t margin_field;
};

struct dt_resource {
    const char *name;
    const char *doc;
    enum dt_kind kind;
    bool history; /* keeps last frame's content; zero before the first */
    bool keep; /* shares no memory: its content stays until the next frame, like that of outputs */
    /* content from outside, in resources with history that no pass writes: every mip must be
     * written, or the resource imported, after each resize and before its first frame; it then stays */
    bool input;
    /* input: the file that the spec names, as written there; NULL: none. The app reads it; a host
     * hands in what is in it */
    const char *file;
    struct dt_contract contract;
    /* buffers */
    /* a buffer of a scalar or vector has one field of an empty name */
    const struct dt_field *fields;
    uint32_t field_count;
    uint32_t stride; /* bytes from element to element */
    /* holds arguments or indices of draws or dispatches: wrong content could hang the device */
    bool controls_work;
    /* images */
    enum dt_format format;
    enum dt_shape shape;
    bool layered; /* texels have a third coordinate: not a single 2D image */
    uint32_t mips;
    bool top; /* row 0 is the first of a picture, not the last */
};

enum dt_pass_kind {
    DT_PASS_DRAW_SCENE,
    DT_PASS_DRAW_FULLSCREEN,
    DT_PASS_DRAW_VERTICES, /* without vertex buffer */
    DT_PASS_DISPATCH
};

struct dt_pass {
    const char *name;
    const char *doc;
    const char *shader; /* GLSL body; path as in the spec */
    enum dt_pass_kind kind;
    bool uses_scene;       /* draws the scene, or reads its buffers or textures */
    const uint16_t *reads; /* indices into resources, ascending order of the spec */
    uint32_t read_count;
    /* resources that the pass writes or updates */
    const uint16_t *writes;
    uint32_t write_count;
    /* mask of the mips of each write; NULL: all 1. A mip that no pass of the frame has written yet
     * has undefined content, unless it has history */
    const uint16_t *write_mips;
};

struct dt_param {
    const char *name;
    const char *doc;
    enum dt_type type;
    bool live;       /* may change at run time; else fixed to value */
    uint32_t offset; /* live: bytes into the live block */
    double value[4]; /* as many as the type has components */
    double min, max; /* -INFINITY, INFINITY where the spec gives none */
    double step;     /* of a slider; 0: none given */
};

struct dt_pipeline {
    const char *name;
    const char *doc;
    const struct dt_param *params;
    uint32_t param_count;
    const struct dt_resource *resources;
    uint32_t resource_count;
    const struct dt_pass *passes; /* in order of execution */
    uint32_t pass_count;
    const void *live_defaults; /* the uniform block (std140) with every parameter at its value */
    uint32_t live_size;        /* bytes of live parameters, a multiple of 16, at least 16 */
    uint32_t block_size;       /* live_size plus parameters that a frame cannot change */
    int linear_output;         /* resource shown as linear HDR, for EXR; -1: none */
    int display_output;        /* resource with 8 bit sRGB codes, for PNG; -1: none */
    /* Size of a resource at a frame of width x height. Buffers: extent[0] elements. Images: width,
     * height, layers or depth. */
    void (*extent)(const struct dt_pipeline *pipeline, uint32_t resource, uint32_t width,
                   uint32_t height, uint32_t extent[3]);
    /* Dispatch: shader invocations of the pass for this frame size and live block. Draw: instances.
     * Also 0 if an indirect buffer holds the number. */
    uint64_t (*runs)(const struct dt_pipeline *pipeline, uint32_t pass, uint32_t width,
                     uint32_t height, const void *live);
    /* Positions of the camera's jitter before it repeats, for this live block; NULL: no jitter. */
    int64_t (*jitter)(const struct dt_pipeline *pipeline, const void *live);
};

/* For generated C: the spec gives no bound. A product, because tcc computes nothing with INFINITY. */
#define DT_NO_MIN (-1e308 * 10)
#define DT_NO_MAX (1e308 * 10)

/* The code of one pass, from NAME_gl_shaders.c or NAME_vk_shaders.c. */
struct dt_code {
    const uint32_t *words; /* SPIR-V; NULL: packed */
    size_t size;           /* bytes of the words; 0: the stage is absent */
    /* each word as LEB128: seven bits in a byte, the lowest first, the high bit set in all bytes
     * but the last; NULL: words */
    const uint8_t *packed;
    const char *glsl; /* OpenGL: the same as text, for options.glsl; NULL: not generated */
};
struct dt_stages {
    struct dt_code compute, vertex, fragment;
};

/* ---- Scene ----------------------------------------------------------------------------------- */

struct dt_vertex { /* GLSL: SceneVertex in std430, ten scalars; attributes at locations 0 to 4 */
    float position[3];
    float normal[3]; /* unit */
    float uv[2];
    uint32_t material;
    uint32_t triangle; /* that begins with this vertex; see dt_scene */
};
static_assert(sizeof(struct dt_vertex) == 40, "ten scalars, no padding");

/* Its fields, in the order of their locations. */
enum dt_attribute { DT_POSITION, DT_NORMAL, DT_UV, DT_MATERIAL, DT_TRIANGLE, DT_ATTRIBUTES };

struct dt_material {    /* GLSL: SceneMaterial in std430 and std140 */
    float albedo[3];    /* linear, 0..1; multiplies the texture */
    int32_t texture;    /* layer of scene_textures, or -1 */
    float emission[3];  /* not used by the shipped pipelines */
    float alpha_cutoff; /* texture alpha below this is a hole; 0: opaque */
};
static_assert(sizeof(struct dt_material) == 32, "two vec4");

/* A mesh of one material in one place. Shipped pipelines do not use it. */
struct dt_object {         /* GLSL: SceneObject in std430 */
    float transform[4][4]; /* of the mesh's own space to the scene, where the vertices are */
    float inverse[4][4];   /* zero if there is none */
    float center[3];       /* of the box around its vertices */
    float radius;          /* of a sphere about the center that holds them */
    uint32_t first_index, index_count; /* its triangles */
    uint32_t material;
    uint32_t mesh; /* the same number: instances of one mesh */
};
static_assert(sizeof(struct dt_object) == 160, "std430");

/* Per scene: 64 KiB, the uniform block size that desktop devices support. */
enum { DT_MAX_MATERIALS = 2048 };

enum { DT_LIGHT_DIRECTIONAL = 0, DT_LIGHT_SPOT = 1 };

struct dt_view { /* std140: GLSL struct View */
    float view[4][4];
    float projection[4][4];
    float view_projection[4][4];
    float inverse_view_projection[4][4];
    float position[3];
    float near_plane;
    float direction[3]; /* unit, into the view */
    float far_plane;
};
static_assert(sizeof(struct dt_view) == 288, "std140");

struct dt_light {      /* std140: GLSL struct Light */
    float position[3]; /* spot */
    int32_t kind;
    float direction[3]; /* unit, the way that light travels */
    /* directional: area covered by the light view, m2; spot: of its image plane at distance 1 */
    float area;
    float color[3];  /* directional: irradiance, W/m2; spot: intensity on the axis, W/sr */
    float cos_inner; /* spot: full intensity within the inner half angle, none beyond the outer */
    float cos_outer;
    float padding[3];
};
static_assert(sizeof(struct dt_light) == 64, "std140");

/* std140: the uniform block Frame, binding by the plan; new in every frame. The runtime fills width,
 * height, jitter and first; it jitters the camera's projection, view_projection and
 * inverse_view_projection if the spec says so. */
struct dt_frame {
    struct dt_view camera;
    /* orthographic or perspective, covers all that the light can reach */
    struct dt_view light_view;
    struct dt_light light;
    float scene_center[3];
    float scene_radius;     /* of the bounding sphere */
    uint32_t width, height; /* frame size in pixels */
    uint32_t index;         /* 0 in the first frame after create; also 0 begins a new sequence */
    uint32_t triangle_count;
    /* camera of the frame before, without jitter. If far_plane is 0, the runtime fills it: with the
     * camera that it got for its last frame, or with that of this frame if it is the first */
    struct dt_view previous_camera;
    float jitter[2]; /* pixels by which the camera's picture is moved, -0.5 to 0.5 */
    float time;      /* seconds */
    /* 1: index is 0, or no frame was rendered since resize, unless it has kept all history */
    uint32_t first;
};
static_assert(sizeof(struct dt_frame) == 288 * 3 + 64 + 48, "std140");

/* Draws whose bodies use vertex_triangle need triangles that each begin with a vertex of their own,
 * whose `triangle` is the triangle's number; dt_number_triangles in diptych_scene.h makes them.
 *
 * All pointers are borrowed for the call that takes the struct. Texture texels are RGBA8 with
 * sRGB-encoded colour and linear alpha; all layers have one size and a full mip chain; texels hold
 * mip 0 of all layers, then mip 1, ... */
struct dt_scene {
    const struct dt_vertex *vertices;
    uint32_t vertex_count;
    const uint32_t *indices; /* three per triangle */
    uint32_t index_count;
    const struct dt_material *materials;
    uint32_t material_count;
    const struct dt_object *objects; /* in the order of their triangles */
    uint32_t object_count;           /* 0 if no pass reads them */
    const uint8_t *texels; /* at least one layer of 1x1, also for a scene without textures */
    uint32_t texture_width, texture_height, texture_layers, texture_mips;
};

/* ---- Runtimes -------------------------------------------------------------------------------- */

/* Input of one backend: the panel, which all backends share, and the backend's shaders. All must
 * live until the runtime's next create or close. */
struct dt_panel; /* panel.h */
struct dt_shaders {
    const char *backend; /* "gl" or "vk" */
    const struct dt_panel *panel;
    const struct dt_stages *stages; /* one per pass; then, if panel->gpu, those for GPUs */
};

/* Which plan of `target: auto` a host's runtime takes: AUTO by the device and the scene. */
enum dt_target_device { DT_TARGET_AUTO, DT_TARGET_SOFTWARE, DT_TARGET_GPU };

struct dt_runtime_options {
    struct dt_log log;
    const char *device; /* vk: name part or index; NULL: the first that suits */
    /* vk: of the first pipeline; the device must have the features that its passes need. NULL: those
     * that every pipeline needs */
    const struct dt_panel *panel;
    /* gl: "egl" (NULL), "osmesa", "zink" (with GALLIUM_DRIVER=zink set) or "window", a hidden one */
    const char *context;
    bool debug;  /* validation with synchronization checking; KHR_debug */
    bool labels; /* vk: names for debuggers, as `debug` gives; gl has them always */
    bool glsl;   /* gl: programs from GLSL text instead of SPIR-V */
    bool timing; /* timestamps around every pass */
    /* Resources with history keep their content over resize and create, where name, size and layout
     * are the same. Not after a failed frame, nor from one not rendered to its end. */
    bool keep_history;
    /* 1..255: resources without history are filled with this byte before their first use in each frame; 0: not filled */
    int poison;
};

/* Tightly packed array: the elements of a buffer, or one mip of an image, layer by layer, row 0
 * first. The extent is that of the mip. */
struct dt_bytes {
    uint8_t *data; /* owned by the holder of the struct; free() */
    size_t size;
    uint32_t extent[3];
};

enum dt_action {
    DT_RUN,  /* run the pass */
    DT_SKIP, /* record only the barriers of the pass: no work, no clears */
    DT_STOP  /* the frame fails; the observer has logged why */
};

/* Callbacks around every pass; both may be NULL. All earlier work has finished. before_pass may
 * write the pass's resources; after_pass may read and write live resources, and returns false to
 * stop. Do not write a resource without history before its first pass of the frame. */
struct dt_observer {
    enum dt_action (*before_pass)(void *user, uint32_t pass);
    bool (*after_pass)(void *user, uint32_t pass);
    void *user;
};

/* What an open runtime tells of its device. */
struct dt_device {
    char name[256];
    char driver[520]; /* its name and version, as it tells them */
    bool software;    /* the driver runs on the CPU */
    /* a verb has failed because the device or context was lost. Then only close works; opening a new
     * runtime may help */
    bool lost;
    uint32_t messages; /* validation and debug messages so far; must be 0 */
};

/* The verbs, in the order of use. Every bool or pointer verb logs its error. Verbs take the pointer
 * that open returned. */
struct dt_runtime {
    const char *name; /* "gl", "vk" */
    void *(*open)(const struct dt_runtime_options *options);
    const struct dt_device *(*device)(void *runtime); /* never NULL; lives as long as it */
    /* Whether create would take panel->gpu, if there were one. The scene comes first. */
    bool (*takes_gpu)(void *runtime, const struct dt_panel *panel);
    bool (*set_scene)(void *runtime,
                      const struct dt_scene *scene); /* before resize; replaces the old scene */
    bool (*create)(void *runtime,
                   const struct dt_shaders *shaders); /* one pipeline per runtime at a time */
    bool (*resize)(void *runtime, uint32_t width, uint32_t height);
    bool (*render)(void *runtime, const struct dt_frame *frame, const void *live,
                   const struct dt_observer *observer);
    bool (*read)(void *runtime, uint32_t resource, uint32_t mip, /* 0 for a buffer */
                 struct dt_bytes *out);
    /* Replaces the content of a buffer or of one mip of an image. Size and layout are those of
     * read; depths are 0 to 1. For inputs and observers. */
    bool (*write)(void *runtime, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes);
    bool (*timings)(
        void *runtime,
        double *pass_ms); /* pass_count values of the last render; NAN for a skipped pass */
    /* CPU milliseconds that the calling thread spent on recording the last frame, without
     * submission; NAN if commands run during recording, or with an observer. */
    double (*record_ms)(void *runtime);
    void (*close)(void *runtime); /* accepts NULL; destroys the pipeline first */
};

#endif
