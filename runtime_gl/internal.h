/* Shared by the files of the OpenGL runtime: the runtime's state, the GL macro for calls, the
 * objects behind resources and programs, and functions used across files. Independent of any
 * pipeline. All state is in struct dt_gl_runtime, including the table of OpenGL functions, so several
 * contexts can coexist. A bool function logs the error before it returns false. Every destroy
 * function accepts a zeroed struct, and zeroes its argument. */
#pragma once

#include <glad/gl.h>

#include "diptych_gl.h"
#include "front.h"

struct gl_context_kind;

/* One OpenGL context with its platform handles; see context.c. */
struct gl_context {
    const struct gl_context_kind *kind; /* NULL: not created */
    void *display;                      /* EGLDisplay */
    void *context;                      /* EGLContext or OSMesaContext */
    void *library;                      /* libOSMesa */
    void *window;                       /* GLFWwindow */
    bool owns_glfw;
    const char *missing;         /* the first function that the driver did not give */
    uint8_t pixels[16 * 16 * 4]; /* default framebuffer, which OSMesa needs; unused */
};

struct gl_buffer {
    const char *name;
    GLuint handle;
    GLsizeiptr size;  /* bytes that are bound; the memory has at least 16 */
    GLsizeiptr block; /* bytes bound as a uniform block, if more than size */
    GLintptr offset;  /* bytes; 0 except in a host's buffer */
    GLuint texels;    /* buffer texture; created when first bound as a texel buffer */
    bool imported;    /* the host owns the buffer */
};

struct gl_image {
    const char *name;
    GLuint handle;
    enum dt_format format;
    uint32_t width, height, layers, mips;
    enum dt_shape shape;
    bool layered;  /* texels have a third coordinate */
    bool borrowed; /* the texture is another resource's */
    bool imported; /* the texture is a host's */
};

struct gl_resource { /* buffer or image */
    struct gl_buffer buffer;
    struct gl_image image;
    bool stored; /* shaders store to the buffer or texture, perhaps through another resource */
};

/* The host's texture or buffer for a resource: element of the core's choices; 0: none. */
struct gl_import {
    GLuint texture;
    struct dt_gl_range buffer;
};

struct gl_program {
    GLuint handle;
    /* exist while the resources exist */
    GLuint framebuffer;            /* of a draw */
    GLuint views[DT_MAX_BINDINGS]; /* by binding: texture of one mip or layer; 0: the image's own */
};

/* Objects that every pipeline may bind besides its resources. */
struct gl_builtin {
    struct gl_buffer buffers[DT_SCENE_TEXTURES - DT_FRAME]; /* by enum dt_builtin */
    struct gl_image textures;
    GLuint texture_sampler;
};

struct gl_kept; /* state.c: the saved state of a host's context */

struct dt_gl_runtime {
    struct dt_core core;
    struct dt_backend backend; /* gl_backend plus functions for the app; see runtime.c */
    GladGLContext gl;
    struct gl_context context;
    bool debug, glsl;          /* see struct dt_runtime_options */
    uint64_t buffer_alignment; /* of offsets into a host's buffers */

    struct gl_builtin builtin;
    GLuint scene_input, no_input; /* vertex array objects */
    GLuint nearest;               /* for bindings that name no sampler */

    GLuint *queries;         /* two per pass and slot: begin, end; NULL without timing */
    bool recording, grouped; /* a pass has begun in this frame; its debug group is open */

    /* with a host's context, which is current in every call */
    bool leave_state;
    struct gl_kept *kept; /* NULL: nothing to restore */
};

/* Makes an OpenGL call that can fail. True, or logs one DT_ERROR that names the call and the
 * object. */
#define GL(rt, object, call) ((rt)->gl.call, gl_check((rt), #call, (object)))
bool gl_check(struct dt_gl_runtime *rt, const char *call, const char *object);

/* glFinish; an error if the device was reset. */
bool gl_finish(struct dt_gl_runtime *rt, const char *object);
const char *gl_text(GLenum value, const char *other); /* what an error or a status means */

/* ---- context.c ------------------------------------------------------------------------------- */

/* Creates the context `name` and makes it current, loads rt->gl, sets the fixed state. */
bool gl_context_open(struct dt_gl_runtime *rt, const char *name);
bool gl_context_current(struct dt_gl_runtime *rt);
void gl_context_close(struct dt_gl_runtime *rt);

/* ---- state.c --------------------------------------------------------------------------------- */

/* True when the context has all of the extensions; else `missing` lists the missing ones, separated
 * by blanks. */
bool gl_has_all(const struct dt_gl_runtime *rt, const char *const *names, size_t count,
                char *missing, size_t size);
/* Checks that the current context has all required features, takes those functions that glad leaves
 * out, and reads its limits. */
bool gl_context_suits(struct dt_gl_runtime *rt, GLADuserptrloadfunc load, void *user);
/* Sets the state that passes rely on but do not set. */
bool gl_state_fix(struct dt_gl_runtime *rt);

/* Around all work in a host's context: enter saves the host's state and sets the state that passes
 * rely on; leave restores the saved state. */
bool gl_state_enter(struct dt_core *core);
bool gl_state_leave(struct dt_core *core);
/* Saves one binding, before its first change between enter and leave. */
void gl_state_keep_binding(struct dt_gl_runtime *rt, enum dt_binding_kind kind, GLuint at);

/* ---- resources.c ----------------------------------------------------------------------------- */

/* Memory layout of a format's texels, as arguments of glTextureSubImage and
 * glGetTextureSubImage. */
struct gl_format {
    GLenum internal, format, type;
    uint32_t bytes; /* per texel */
};
const struct gl_format *gl_format(enum dt_format format);
GLenum gl_target(const struct gl_image *image);
/* Texels of a side of length `size` at a mip. */
GLsizei gl_mip_size(uint32_t size, uint32_t mip);

/* The caller fills name, size and block. `data` has `size` bytes, or is NULL. */
bool gl_buffer_create(struct dt_gl_runtime *rt, struct gl_buffer *buffer, const void *data);
bool gl_buffer_write(struct dt_gl_runtime *rt, const struct gl_buffer *buffer, const void *data,
                     size_t size);
/* Creates `texels`, unless it is there. resource: DT_SCENE_VERTICES or DT_SCENE_INDICES. */
bool gl_buffer_texels(struct dt_gl_runtime *rt, struct gl_buffer *buffer, uint16_t resource);
void gl_buffer_destroy(struct dt_gl_runtime *rt, struct gl_buffer *buffer);

/* Uses `least` bytes or all of a host's range; an error names `name`. */
bool gl_buffer_import(const struct dt_gl_runtime *rt, struct gl_buffer *buffer, const char *name,
                      const struct dt_gl_range *range, uint64_t least);
/* The caller fills all fields except the handle. */
bool gl_image_create(struct dt_gl_runtime *rt, struct gl_image *image);
/* Uses a host's texture instead of creating one; checks that it matches. */
bool gl_image_import(struct dt_gl_runtime *rt, struct gl_image *image, GLuint texture);
bool gl_image_clear(struct dt_gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                    const float clear[4]);
/* A texture that is one mip or all, and one layer or all, of the image. */
bool gl_image_view(struct dt_gl_runtime *rt, const struct gl_image *image,
                   const struct dt_binding *binding, GLuint *view);
void gl_image_destroy(struct dt_gl_runtime *rt, struct gl_image *image);

/* Layers `layer` to `layer + layers - 1` of a mip. */
bool gl_image_write(struct dt_gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                    uint32_t layer, uint32_t layers, const void *texels);

/* Set every byte. */
bool gl_buffer_fill(struct dt_gl_runtime *rt, const struct gl_buffer *buffer, int byte);
bool gl_image_fill(struct dt_gl_runtime *rt, const struct gl_image *image, int byte);

/* Of struct dt_backend; a sampler is a GLuint. */
bool gl_sampler_create(struct dt_core *core, void *sampler, const struct dt_sampler *info);
void gl_sampler_destroy(struct dt_core *core, void *sampler);

/* ---- program.c ------------------------------------------------------------------------------- */

bool gl_program_create(struct dt_gl_runtime *rt, GLuint *program, const char *name,
                       const struct dt_stages *stages);
void gl_program_destroy(struct dt_gl_runtime *rt, GLuint *program);

/* ---- panel.c --------------------------------------------------------------------------------- */

/* Functions for hosts; no window, no read-back. */
extern const struct dt_backend gl_backend;

bool gl_builtin_create(struct dt_gl_runtime *rt);
void gl_builtin_destroy(struct dt_gl_runtime *rt);
/* `resource`: index in the pipeline, or enum dt_builtin. */
struct gl_buffer *gl_buffer_of(struct dt_gl_runtime *rt, uint32_t resource);
const struct gl_image *gl_image_of(const struct dt_gl_runtime *rt, uint32_t resource);
static inline struct dt_gl_runtime *gl_runtime_of(struct dt_core *core)
{
    return (struct dt_gl_runtime *)core;
}

/* ---- frame.c --------------------------------------------------------------------------------- */

extern const struct dt_commands gl_commands;

bool gl_render(struct dt_core *core, const struct dt_frame *frame, const void *live);
bool gl_timing(struct dt_core *core, uint32_t run, const char *name, double *ms);
bool gl_pause(struct dt_core *core);

/* ---- scene.c --------------------------------------------------------------------------------- */

bool gl_scene_upload(struct dt_core *core, const struct dt_scene *scene,
                     const struct dt_scene_buffer buffers[DT_SCENE_BUFFERS]);
bool gl_scene_describe(struct dt_gl_runtime *rt,
                       const struct dt_gl_attribute given[DT_ATTRIBUTES]); /* creates scene_input */
void gl_scene_destroy(struct dt_gl_runtime *rt);

/* ---- readback.c ------------------------------------------------------------------------------ */

bool gl_read(struct dt_core *core, uint32_t resource, uint32_t mip, struct dt_bytes *out);
bool gl_write(struct dt_core *core, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes);

/* ---- runtime.c ------------------------------------------------------------------------------- */

extern const struct dt_runtime runtime_gl;
