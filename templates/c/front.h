/* The layer above every backend: shared runtime state; checks of arguments, states and limits with
 * common messages; the walk over a panel's tables. A backend implements struct dt_backend;
 * struct dt_gl_runtime and struct dt_vk_runtime begin with a struct dt_core. */
#ifndef DIPTYCH_FRONT_H
#define DIPTYCH_FRONT_H

#include "panel.h"

/* Limits of the device; filled by open. UINT64_MAX: it has no such limit. */
struct dt_limits {
    uint64_t most[DT_LIMITS]; /* by enum dt_device_limit */
    uint32_t numbers[5];      /* OpenGL: binding numbers, by enum dt_binding_kind */
    float anisotropy;
};

struct dt_core {
    const struct dt_backend *backend;
    struct dt_log log;
    struct dt_limits limits;
    struct dt_device device;
    enum dt_target_device target;
    bool hosted; /* the host owns device or context */
    bool timing;
    bool keep_history; /* over resize and create, where a resource has the same name and layout */
    int poison;        /* see struct dt_runtime_options */
    bool has_scene, has_objects, has_vertices; /* vertices: as struct dt_vertex[] */
    bool numbered;                             /* the scene's triangles, for vertex_triangle */
    uint8_t attributes;                        /* mask by enum dt_attribute */
    uint64_t vertex_bytes;                     /* of the scene, as struct dt_vertex[] */
    uint32_t index_count;                      /* of the scene */

    /* The pipeline; NULL before create. */
    struct dt_shaders shaders; /* panel and stages: those for the device */
    const struct dt_panel *panel;
    const struct dt_pipeline *pipeline;
    /* Arrays of the backend's structs, one per resource, pass, sampler; zero: not created. */
    void *resources, *programs, *samplers, *choices;
    uint32_t width, height; /* 0: the resources do not exist */
    uint32_t *written;      /* per resource: mask of the mips written since resize */
    bool *imported;         /* per resource: uses an image or buffer of the host */
    bool *resumed;          /* per resource: has content from before resize, and no frame since */
    bool sized;             /* a frame may be rendered: nothing has changed since resize */
    bool rendered;          /* a whole frame was rendered since resize */
    struct dt_kept *kept;   /* history.c */
    uint32_t kept_count;
    bool kept_camera;   /* has_camera, when they were put aside */
    uint32_t next_pass; /* where the next part begins; 0: with a new frame */
    void *live;         /* live parameters of the frame */
    bool has_camera;    /* of the last frame since resize, without jitter */
    struct dt_view camera;

    /* While a frame is recorded. */
    const struct dt_observer *observer;
    uint32_t first_pass, end_pass;  /* of the part */
    bool outside;                   /* the pass is not in the part: record nothing */
    uint32_t pass;                  /* of the last begin */
    bool skips;                     /* DT_SKIP: record only barriers */
    bool measures;                  /* no frame: verbs check their arguments, and record nothing */
    bool has_viewport, has_scissor; /* of the pass being recorded */
    struct dt_rect viewport, scissor;
    /* Timestamps are kept of this many frames, each in its slot. */
    uint32_t frames, slot; /* slot of the last frame */
    uint32_t recorded;     /* frames since resize, up to `frames` */
    bool *ran;             /* per slot and pass: work recorded */
};

/* What a pass draws. */
enum { DT_NO_BUFFER = 0xffff };
struct dt_draw {
    uint32_t layers;  /* of its targets */
    uint32_t indices; /* a buffer, or DT_SCENE_INDICES; DT_NO_BUFFER: vertices are not indexed */
    uint32_t
        arguments; /* the buffer of indirect draws; DT_NO_BUFFER: a direct one, of the next two */
    uint32_t count, instances; /* vertices or indices */
};

/* The commands of a pass, as struct dt_verbs has them; called with checked arguments, and not for
 * skipped work. */
struct dt_commands {
    bool (*begin)(struct dt_core *core, uint32_t pass, bool runs);
    bool (*barriers)(struct dt_core *core, uint32_t pass, const struct dt_barrier *list,
                     uint32_t count);
    bool (*bind)(struct dt_core *core, uint32_t pass);
    bool (*dispatch)(struct dt_core *core, uint32_t pass, uint32_t x, uint32_t y, uint32_t z);
    bool (*dispatch_indirect)(struct dt_core *core, uint32_t pass, uint32_t arguments);
    bool (*draw)(struct dt_core *core, uint32_t pass, const struct dt_draw *draw);
    bool (*clear_targets)(struct dt_core *core, uint32_t pass, uint32_t layers);
    bool (*clear_buffer)(struct dt_core *core, uint32_t resource);
    bool (*clear_image)(struct dt_core *core, uint32_t resource, uint32_t mip);
    bool (*end)(struct dt_core *core, uint32_t pass);
};

/* A buffer of the scene, with the content that the app gives it. */
struct dt_scene_buffer {
    uint16_t resource; /* enum dt_builtin */
    const char *name;
    uint64_t size; /* bytes */
    const void *data;
    uint64_t data_size; /* the rest of the buffer is zero */
};
enum { DT_SCENE_BUFFERS = 4 };

/* Every bool function logs its error. All take the core that open made. */
struct dt_backend {
    const char *name; /* "gl", "vk" */
    const char *api;  /* "OpenGL", "Vulkan": in messages */
    /* Bytes of one element of dt_core's arrays. */
    size_t resource_size, program_size, sampler_size;
    size_t choice_size; /* what a host chooses for a resource */

    /* Called around every verb: make the context current, save and restore a host's state. leave
     * also runs after a failed enter. NULL: nothing to do. */
    bool (*enter)(struct dt_core *core);
    bool (*leave)(struct dt_core *core);
    bool (*rest)(struct dt_core *core, const char *verb); /* afterwards no frame is in flight */

    /* Replaces the scene. */
    bool (*upload_scene)(struct dt_core *core, const struct dt_scene *scene,
                         const struct dt_scene_buffer buffers[DT_SCENE_BUFFERS]);

    /* Whether the device has what the passes need. Called before create changes anything. */
    bool (*suits)(struct dt_core *core, const struct dt_panel *panel);
    /* The pipeline; core->panel is set. end_panel also cleans up after a failed begin_panel. */
    bool (*begin_panel)(struct dt_core *core); /* uniform block of live parameters, queries */
    void (*end_panel)(struct dt_core *core);
    bool (*create_sampler)(struct dt_core *core, void *sampler, const struct dt_sampler *info);
    void (*destroy_sampler)(struct dt_core *core, void *sampler);
    bool (*create_program)(struct dt_core *core, void *program, uint32_t pass);
    /* Completes all programs that were created; NULL: they are complete. */
    bool (*compile_programs)(struct dt_core *core);
    void (*destroy_program)(struct dt_core *core, void *program);
    /* Takes over a program of the previous panel, with the same code and state, for this pass. NULL: nothing to do. */
    void (*adopt_program)(struct dt_core *core, void *program, uint32_t pass);

    /* Resources for frames of core->width x height. Order: create all, place, fill all, then
     * connect programs. */
    bool (*create_resource)(struct dt_core *core, uint32_t resource, const uint32_t extent[3]);
    bool (*place_resources)(struct dt_core *core); /* allocates the slots; NULL: not needed */
    /* Sets all bytes. Nothing is in flight. */
    bool (*fill_resource)(struct dt_core *core, uint32_t resource, int byte);
    bool (*connect_program)(struct dt_core *core, void *program, uint32_t pass);
    void (*disconnect_program)(struct dt_core *core, void *program); /* NULL: nothing to do */
    void (*destroy_resource)(struct dt_core *core, void *resource);
    /* Makes the resource the owner of its memory; false: it shares memory. */
    bool (*detach_resource)(struct dt_core *core, uint32_t index);
    /* Whether a detached one, of the same layout, can be this resource; if so, gives it its name. */
    bool (*adopt_resource)(struct dt_core *core, uint32_t index, void *resource);
    void (*release_memory)(struct dt_core *core); /* after all resources; NULL: nothing to do */

    /* A frame or a part of one: calls dt_front_record between its own first and last commands.
     * Writes the blocks if first_pass is 0; `frame` is undefined in later parts. */
    bool (*render)(struct dt_core *core, const struct dt_frame *frame, const void *live);
    const struct dt_commands *commands;
    /* For an observer: finish all work so far; continue recording. */
    bool (*pause)(struct dt_core *core);
    bool (*resume)(struct dt_core *core); /* NULL: nothing to do */

    /* Resource and mip exist; `out` has size, extent and memory. */
    bool (*read)(struct dt_core *core, uint32_t resource, uint32_t mip, struct dt_bytes *out);
    bool (*write)(struct dt_core *core, uint32_t resource, uint32_t mip,
                  const struct dt_bytes *bytes);
    /* Milliseconds of a pass that ran; `run`: dt_run of slot and pass. A host's, which has not finished:
     * *ms stays. */
    bool (*timing)(struct dt_core *core, uint32_t run, const char *name, double *ms);
};

/* ---- Messages -------------------------------------------------------------------------------- */

void dt_log(const struct dt_core *core, enum dt_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Logs one DT_ERROR and returns false. */
bool dt_error(const struct dt_core *core, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* ---- Shaders --------------------------------------------------------------------------------- */

/* The words of a stage that is present. free() `*own` after use. NULL: no memory. */
const uint32_t *dt_front_words(const struct dt_code *code, uint32_t **own);

/* ---- For the app and for hosts --------------------------------------------------------------- */

/* Whether the pipeline is of a version that the library takes; if not, logs it. */
bool dt_front_takes(const struct dt_core *core, const struct dt_panel *panel);
/* Whether a host has given a pointer; else logs an error that calls it `what`. core NULL: false, since the host
 * has gone on after an open that failed. */
bool dt_front_given(const struct dt_core *core, const void *pointer, const char *what);
/* Whether the device, or the length of its texel buffers against the scene, asks for panel->gpu. */
bool dt_front_takes_gpu(const struct dt_core *core, const struct dt_panel *panel);
bool dt_front_create(struct dt_core *core, const struct dt_shaders *shaders);
bool dt_front_resize(struct dt_core *core, uint32_t width, uint32_t height);
/* Renders the passes `first` to `end` - 1 of a frame: all, or a host's part. The part that begins
 * with pass 0 begins the frame, and its frame and live parameters (NULL: the defaults) hold for all
 * parts. */
bool dt_front_render(struct dt_core *core, const char *verb, const struct dt_frame *frame,
                     const void *live, uint32_t first, uint32_t end);
/* Called by a backend's render: records the passes of the part, through the checked verbs. */
bool dt_front_record(struct dt_core *core, const void *live);
/* The scalars that shaders see: DT_TYPE_FLOAT, DT_TYPE_UINT or DT_TYPE_INT. */
enum dt_type dt_front_scalar(enum dt_format format);
/* For a draw into targets of this size: the viewport, at least one texel large, and the scissor,
 * which lies within the targets and may be empty. */
void dt_front_area(const struct dt_core *core, uint32_t width, uint32_t height,
                   struct dt_rect *viewport, struct dt_rect *scissor);
/* Fills jitter, and jitters the camera; width, height and index are set. */
void dt_front_jitter(const struct dt_pipeline *pipeline, const void *live, struct dt_frame *frame);
/* The block of the next frame, with all that the runtime fills; keeps its camera for the frame after. */
struct dt_frame dt_front_frame(struct dt_core *core, const struct dt_frame *frame,
                               const void *live);
/* Whether the resource and the mip exist; `shape` gets size and extent. */
bool dt_front_find(const struct dt_core *core, const char *verb, uint32_t resource, uint32_t mip,
                   struct dt_bytes *shape);
/* Checks that the pipeline has this image or buffer, which a host chooses something for; requires
 * create. A resize must follow. `verb`: in messages. */
bool dt_front_choose(struct dt_core *core, const char *verb, enum dt_kind kind, uint32_t resource);
/* The first need of the panel's passes that exceeds the limits, whatever the size of the frame, as a
 * sentence in `text`. False if there is one. */
bool dt_front_suits(const struct dt_panel *panel, const struct dt_limits *limits,
                    const char *device, char *text, size_t size);
/* Whether a buffer of the scene can be a texel buffer of `elements`. */
bool dt_front_texels(const struct dt_core *core, const char *name, uint64_t elements);
/* Whether a host's range of a buffer can be bound as `name`, which needs `least` bytes. `alignment`: the
 * device's, in bytes. */
bool dt_front_range(const struct dt_core *core, const char *name, uint64_t offset, uint64_t size,
                    uint64_t least, uint64_t alignment);
/* Whether a host may use the resource's object: its content outlasts the passes. */
bool dt_front_take(const struct dt_core *core, uint32_t resource, struct dt_bytes *shape);
/* Whether these bytes may replace the mip's content. */
bool dt_front_fits(const struct dt_core *core, uint32_t resource, uint32_t mip,
                   const struct dt_bytes *bytes);
/* Where an attribute stands in struct dt_vertex, and its bytes. */
struct dt_field_place {
    const char *name;
    uint32_t offset, size;
};
extern const struct dt_field_place dt_attributes[DT_ATTRIBUTES];
/* Whether elements of a host's buffer can be this attribute. */
bool dt_front_attribute(struct dt_core *core, int attribute, uint64_t offset, uint32_t stride);
/* Checks that index_count fits triangles. A resize must follow. */
bool dt_front_import_scene(struct dt_core *core, uint64_t vertex_bytes, uint32_t index_count,
                           bool numbered);
/* `age`: 0 is the frame rendered last, 1 the one before. */
bool dt_front_timings(struct dt_core *core, uint32_t age, double *pass_ms);
void dt_front_destroy(struct dt_core *core); /* destroys the pipeline and its objects */

/* history.c; nothing without keep_history. keep: before resources are destroyed. take: in place of
 * creating one; false: create it. drop: what no resource took. goes_on: no history begins as zero. */
void dt_history_keep(struct dt_core *core);
bool dt_history_take(struct dt_core *core, uint32_t index, const uint32_t extent[3]);
void dt_history_drop(struct dt_core *core);
bool dt_history_goes_on(const struct dt_core *core);

static inline void *dt_resource(const struct dt_core *core, uint32_t resource)
{
    return (char *)core->resources + resource * core->backend->resource_size;
}
static inline const char *dt_pass_name(const struct dt_core *core, uint32_t pass)
{
    return core->pipeline->passes[pass].name;
}
static inline bool dt_writes(const struct dt_core *core, uint32_t pass, uint32_t resource)
{
    const struct dt_pass *info = &core->pipeline->passes[pass];
    uint32_t i = 0;
    while (i < info->write_count && info->writes[i] != resource)
        i++;
    return i < info->write_count;
}
static inline void *dt_program(const struct dt_core *core, uint32_t pass)
{
    return (char *)core->programs + pass * core->backend->program_size;
}
/* Index of a pass among the slots: in `ran`, and twice it is its first timestamp. */
static inline uint32_t dt_run(const struct dt_core *core, uint32_t slot, uint32_t pass)
{
    return slot * core->pipeline->pass_count + pass;
}
static inline void *dt_choice(const struct dt_core *core, uint32_t resource)
{
    return (char *)core->choices + resource * core->backend->choice_size;
}
static inline void *dt_sampler(const struct dt_core *core, uint32_t sampler)
{
    return (char *)core->samplers + sampler * core->backend->sampler_size;
}

/* ---- The app's verbs that all backends share ------------------------------------------------- */

const struct dt_device *dt_verb_device(void *runtime);
bool dt_verb_takes_gpu(void *runtime, const struct dt_panel *panel);
bool dt_verb_set_scene(void *runtime, const struct dt_scene *scene);
bool dt_verb_create(void *runtime, const struct dt_shaders *shaders);
bool dt_verb_resize(void *runtime, uint32_t width, uint32_t height);
bool dt_verb_render(void *runtime, const struct dt_frame *frame, const void *live,
                    const struct dt_observer *observer);
bool dt_verb_read(void *runtime, uint32_t resource, uint32_t mip, struct dt_bytes *out);
bool dt_verb_write(void *runtime, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes);
bool dt_verb_timings(void *runtime, double *pass_ms);
/* As members of struct dt_runtime. */
#define DT_SHARED_VERBS                                                                            \
    .device = dt_verb_device, .takes_gpu = dt_verb_takes_gpu, .set_scene = dt_verb_set_scene,      \
    .create = dt_verb_create, .resize = dt_verb_resize, .render = dt_verb_render,                  \
    .read = dt_verb_read, .write = dt_verb_write, .timings = dt_verb_timings

extern const struct dt_runtime runtime_gl, runtime_vk;

#endif
