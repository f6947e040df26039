/* What the files of the OpenGL runtime share: the runtime's state, the one way to call OpenGL, the
 * objects that resources and programs are made of, and the functions that cross files. Knows no
 * pipeline. All state is in struct gl_runtime, and OpenGL is called through a table of its own, so
 * several contexts live side by side. Every function that returns bool has logged the error when it
 * returns false; every destroy takes zeroed structs, and zeroes them. */
#ifndef DIPTYCH_RUNTIME_GL_INTERNAL_H
#define DIPTYCH_RUNTIME_GL_INTERNAL_H

#include <glad/gl.h>

#include "diptych_gl.h"
#include "front.h"

struct gl_context_kind;

/* One OpenGL context and whatever stands below it; see context.c. */
struct gl_context {
    const struct gl_context_kind *kind; /* NULL: not made */
    void *display;                      /* EGLDisplay */
    void *context;                      /* EGLContext or OSMesaContext */
    void *library;                      /* libOSMesa */
    void *window;                       /* GLFWwindow */
    bool owns_glfw;
    uint8_t pixels[16 * 16 * 4]; /* OSMesa wants a default framebuffer; nothing is drawn to it */
};

struct gl_buffer {
    const char *name;
    GLuint handle;
    GLsizeiptr size;  /* bytes, at least 16 */
    GLsizeiptr block; /* bytes bound as a uniform block, where that is more than size */
    GLintptr offset;  /* bytes; 0 but for a host's */
    bool imported;    /* the handle is a host's, and so are the bytes before and behind */
};

struct gl_image {
    const char *name;
    GLuint handle;
    enum dt_format format;
    uint32_t width, height, layers, mips;
    bool layered;  /* an array texture */
    bool borrowed; /* the texture is another resource's */
    bool imported; /* the texture is a host's */
};

struct gl_resource { /* one of the two */
    struct gl_buffer buffer;
    struct gl_image image;
    bool stored; /* shaders store to the buffer or texture, perhaps as another resource */
};

struct gl_program {
    GLuint handle;
    GLuint framebuffer; /* of a draw, while there are resources */
};

/* What every pipeline may bind beside its resources: enum dt_builtin. */
struct gl_builtin {
    struct gl_buffer frame, live, vertices, indices, materials;
    struct gl_image textures;
    GLuint texture_sampler;
};

/* What present.c shows in a window; made when it is first used. */
struct gl_present {
    GLuint program;
    GLuint samplers[2]; /* filtered, not filtered */
    struct gl_buffer vertices;
    struct gl_image textures[DT_WINDOW_TEXTURES];
};

struct gl_kept; /* state.c: a host's state while it is away */

struct gl_runtime {
    struct dt_core core;
    struct dt_backend backend; /* gl_backend and what only an app has; see runtime.c */
    GladGLContext gl;
    struct gl_context context;
    bool debug, glsl;          /* see struct dt_runtime_options */
    uint64_t buffer_alignment; /* of offsets into a host's buffers */

    struct gl_builtin builtin;
    uint32_t index_count;
    GLuint scene_input, no_input; /* vertex array objects */
    GLuint nearest;               /* the sampler of bindings without one */
    struct gl_present present;

    GLuint *queries;         /* two per pass: begin, end; NULL without timing */
    bool recording, grouped; /* a pass has begun in this frame; and its debug group is open */

    /* a host's context: current in every call, and left as it was found */
    bool leave_state;
    GLuint *imports;      /* per resource of the panel: the host's texture, or 0 */
    struct gl_kept *kept; /* NULL: nothing is to be given back */
};

/* The one way to make an OpenGL call that can fail: true, or one DT_ERROR that names the call
 * and the object. */
#define GL(rt, object, call) ((rt)->gl.call, gl_check((rt), #call, (object)))
bool gl_check(struct gl_runtime *rt, const char *call, const char *object);

/* glFinish, and an error when the device was reset meanwhile. */
bool gl_finish(struct gl_runtime *rt, const char *object);

/* ---- context.c ------------------------------------------------------------------------------- */

/* Makes the context that the options name current, loads rt->gl, sets the fixed state. */
bool gl_context_open(struct gl_runtime *rt, const char *name);
bool gl_context_current(struct gl_runtime *rt);
void gl_context_wait_for_screen(void);       /* swaps of the current context do, from now on */
void gl_context_swap(struct gl_runtime *rt); /* shows what was drawn into the window */
/* Of what is drawn into the window; 0 where it is minimised. */
void gl_context_window_size(struct gl_runtime *rt, int *width, int *height);
void gl_context_close(struct gl_runtime *rt);

/* ---- state.c --------------------------------------------------------------------------------- */

/* True when the context has all of the extensions; else `missing` lists the others, separated by
 * blanks. */
bool gl_has_all(const struct gl_runtime *rt, const char *const *names, size_t count, char *missing,
                size_t size);
/* Whether the current context has all that the runtime needs; and its limits. */
bool gl_context_suits(struct gl_runtime *rt);
bool gl_is_software(const struct gl_runtime *rt); /* the driver draws on the CPU */
/* Everything that passes rely on and do not set themselves. */
bool gl_state_fix(struct gl_runtime *rt);

/* Around whatever is done in a host's context: keep what is about to be changed and set all that a host
 * may have set otherwise; then give it back. */
bool gl_state_enter(struct dt_core *core);
bool gl_state_leave(struct dt_core *core);
/* Before a binding is changed for the first time in between. */
void gl_state_keep_binding(struct gl_runtime *rt, enum dt_binding_kind kind, GLuint at);

/* ---- resources.c ----------------------------------------------------------------------------- */

/* How texels of a format lie in memory, in the words of glTextureSubImage and
 * glGetTextureSubImage. */
struct gl_format {
    GLenum internal, format, type;
    uint32_t bytes; /* per texel */
};
const struct gl_format *gl_format(enum dt_format format);
GLenum gl_target(const struct gl_image *image);
/* Of one mip of a side. */
GLsizei gl_mip_size(uint32_t size, uint32_t mip);

/* Name, size and block are filled in; the data has `size` bytes, or is NULL. */
bool gl_buffer_create(struct gl_runtime *rt, struct gl_buffer *buffer, const void *data);
bool gl_buffer_write(struct gl_runtime *rt, const struct gl_buffer *buffer, const void *data,
                     size_t size);
void gl_buffer_destroy(struct gl_runtime *rt, struct gl_buffer *buffer);

/* All but the texture is filled in. */
bool gl_image_create(struct gl_runtime *rt, struct gl_image *image);
/* A host's texture takes the place of one that would have been made. */
bool gl_image_import(struct gl_runtime *rt, struct gl_image *image, GLuint texture);
bool gl_image_clear(struct gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                    const float clear[4]);
void gl_image_destroy(struct gl_runtime *rt, struct gl_image *image);

/* The same byte everywhere. */
bool gl_buffer_fill(struct gl_runtime *rt, const struct gl_buffer *buffer, int byte);
bool gl_image_fill(struct gl_runtime *rt, const struct gl_image *image, int byte);

bool gl_sampler_create(struct gl_runtime *rt, GLuint *sampler, const struct dt_sampler *info);
void gl_sampler_destroy(struct gl_runtime *rt, GLuint *sampler);

/* ---- program.c ------------------------------------------------------------------------------- */

bool gl_program_create(struct gl_runtime *rt, GLuint *program, const char *name,
                       const struct dt_stages *stages);
void gl_program_destroy(struct gl_runtime *rt, GLuint *program);

/* ---- panel.c --------------------------------------------------------------------------------- */

/* All that hosts need; neither windows nor reading back. */
extern const struct dt_backend gl_backend;

bool gl_builtin_create(struct gl_runtime *rt);
void gl_builtin_destroy(struct gl_runtime *rt);
/* By index in the pipeline, or enum dt_builtin. */
const struct gl_buffer *gl_buffer_of(const struct gl_runtime *rt, uint32_t resource);
const struct gl_image *gl_image_of(const struct gl_runtime *rt, uint32_t resource);

/* ---- frame.c --------------------------------------------------------------------------------- */

/* The verbs of a panel's record: struct dt_verbs. */
bool gl_begin(void *runtime, uint32_t pass, bool runs);
bool gl_barriers(void *runtime, uint32_t pass, const struct dt_barrier *barriers, uint32_t count);
bool gl_bind(void *runtime, uint32_t pass);
bool gl_dispatch(void *runtime, uint32_t pass, uint32_t x, uint32_t y, uint32_t z);
bool gl_dispatch_indirect(void *runtime, uint32_t pass, uint32_t arguments);
bool gl_draw_scene(void *runtime, uint32_t pass, uint32_t layers);
bool gl_draw_indirect(void *runtime, uint32_t pass, uint32_t layers, uint32_t indices,
                      uint32_t arguments);
bool gl_draw_fullscreen(void *runtime, uint32_t pass, uint32_t layers);
bool gl_clear_targets(void *runtime, uint32_t pass, uint32_t layers);
bool gl_clear_buffer(void *runtime, uint32_t pass, uint32_t resource);
bool gl_clear_image(void *runtime, uint32_t pass, uint32_t resource, uint32_t mip);
bool gl_end(void *runtime, uint32_t pass);

bool gl_render(struct dt_core *core, const struct dt_frame *frame, const void *live);
bool gl_timings(struct dt_core *core, double *pass_ms);
bool gl_pause(struct dt_core *core);
bool gl_resume(struct dt_core *core);

/* ---- scene.c --------------------------------------------------------------------------------- */

bool gl_scene_upload(struct dt_core *core, const struct dt_scene *scene); /* replaces the former */
bool gl_scene_describe(struct gl_runtime *rt); /* the vertex buffer, for draws */
void gl_scene_destroy(struct gl_runtime *rt);

/* ---- present.c: the verbs of a window; readback.c ---------------------------------------------- */

bool gl_window_copy(struct dt_core *core, uint32_t texture, uint32_t resource);
bool gl_window_upload(struct dt_core *core, uint32_t texture, uint32_t width, uint32_t height,
                      const uint8_t *pixels);
bool gl_present(struct dt_core *core, const struct dt_window_frame *frame);
void gl_present_destroy(struct gl_runtime *rt);

bool gl_read(struct dt_core *core, uint32_t resource, uint32_t mip, struct dt_bytes *out);
bool gl_write(struct dt_core *core, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes);

/* ---- runtime.c ------------------------------------------------------------------------------- */

extern const struct dt_runtime runtime_gl;

#endif
