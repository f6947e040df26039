/* What the files of the OpenGL runtime share and nobody else sees: the runtime's state, the one
 * way to call OpenGL, and the helpers that cross files. */
#ifndef DIPTYCH_RUNTIME_GL_INTERNAL_H
#define DIPTYCH_RUNTIME_GL_INTERNAL_H

#include <glad/gl.h>

#include "diptych_gl.h"
#include "runtime.h"

struct gl_context_kind;

/* One OpenGL context and whatever stands below it; see context.c. */
struct gl_context {
    const struct gl_context_kind *kind; /* NULL: not made */
    bool (*current)(struct gl_context *context);
    void *display; /* EGLDisplay */
    void *context; /* EGLContext or OSMesaContext */
    void *library; /* libOSMesa */
    void *window;  /* GLFWwindow */
    bool owns_glfw;
    uint8_t pixels[16 * 16 * 4]; /* OSMesa wants a default framebuffer; nothing is drawn to it */
};

enum { GL_MAX_IMPORTS = 16 };

struct gl_limits {
    GLint texture_size, texture_layers;
    GLint color_targets, draw_buffers, viewport[2];
    GLint uniform_bindings, storage_bindings, texture_bindings, image_bindings;
    GLint64 uniform_size, storage_size;         /* bytes of one block */
    GLint storage_alignment, uniform_alignment; /* of offsets into buffers */
    GLint groups[3];
    GLint clip_distances;
    GLfloat anisotropy;
};

/* What present.c shows in a window; made when it is first used. */
struct gl_present {
    struct gl_program program;
    GLuint samplers[2]; /* filtered, not filtered */
    struct gl_buffer vertices;
    struct gl_image textures[DT_WINDOW_TEXTURES];
};

/* An image of the host in place of a resource. */
struct gl_import {
    const char *name; /* of the resource */
    GLuint texture;
};

struct gl_kept; /* state.c: a host's state while it is away */

/* program.c: programs of a panel that is being replaced, for the one that follows. */
struct gl_spare {
    bool keeps; /* what is destroyed comes here */
    struct gl_program *programs;
    uint32_t count;
};

struct gl_runtime {
    GladGLContext gl;
    struct gl_context context;
    struct dt_runtime_options options;
    struct gl_limits limits;
    char device_name[256];
    uint32_t messages; /* from KHR_debug */
    bool lost;         /* the context is, since the device was reset */

    struct gl_builtin builtin;
    uint32_t index_count;
    GLuint scene_input, no_input; /* vertex array objects */
    GLuint nearest;               /* the sampler of bindings without one */

    struct gl_present present;

    const struct dt_panel *panel; /* NULL: none created */
    void *state;
    struct gl_spare spare;
    uint32_t width, height;

    /* host.c */
    bool hosted; /* the context is a host's: current in every call, and left as it was found */
    bool leave_state;
    struct gl_import imports[GL_MAX_IMPORTS];
    uint32_t import_count;
    struct gl_kept *kept; /* NULL: nothing is to be given back */

    const char *pass;                   /* the one that is recorded; NULL: none */
    const struct dt_observer *observer; /* during render */
    bool skips;      /* as of the last dt_gl_pass_begin: the pass does nothing but its barriers */
    GLuint *queries; /* two per pass: begin, end; NULL without options.timing */
    bool *ran;       /* per pass, in the last render */
};

void gl_log(const struct gl_runtime *rt, enum dt_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The one way to make an OpenGL call that can fail: true, or one DT_ERROR that names the call
 * and the object. */
#define GL(rt, object, call) ((rt)->gl.call, gl_check((rt), #call, (object)))
bool gl_check(struct gl_runtime *rt, const char *call, const char *object);

/* glFinish, and an error when the device was reset meanwhile. */
bool gl_finish(struct gl_runtime *rt, const char *object);

/* ---- context.c ------------------------------------------------------------------------------- */

/* Makes the context current, loads rt->gl, sets the fixed state. */
bool gl_context_open(struct gl_runtime *rt);
void gl_context_wait_for_screen(void);       /* swaps of the current context do, from now on */
void gl_context_swap(struct gl_runtime *rt); /* shows what was drawn into the window */
/* Of what is drawn into the window; 0 where it is minimised. */
void gl_context_window_size(struct gl_runtime *rt, int *width, int *height);
void gl_context_close(struct gl_runtime *rt);

/* ---- state.c --------------------------------------------------------------------------------- */

/* Makes the runtime's own context current; a host has done that for its. */
bool gl_context_current(struct gl_runtime *rt);

/* True when the context has all of the extensions; else `missing` lists the others, separated by
 * blanks. */
bool gl_has_all(const struct gl_runtime *rt, const char *const *names, size_t count, char *missing,
                size_t size);
/* Whether the current context has all that the runtime needs; and its limits. */
bool gl_context_suits(struct gl_runtime *rt);
/* Everything that passes rely on and do not set themselves. */
bool gl_state_fix(struct gl_runtime *rt);

/* Around whatever is done in a host's context: keep what is about to be changed and set all that a host
 * may have set otherwise; then give it back. */
bool gl_state_enter(struct gl_runtime *rt);
bool gl_state_leave(struct gl_runtime *rt);
/* Before a binding is changed for the first time in between. */
void gl_state_keep_binding(struct gl_runtime *rt, const struct gl_binding *binding);

/* ---- panel.c --------------------------------------------------------------------------------- */

bool gl_builtin_create(struct gl_runtime *rt);
void gl_builtin_destroy(struct gl_runtime *rt);
void gl_programs_forget(struct gl_runtime *rt); /* the spare ones; program.c */
bool gl_panel_create(struct gl_runtime *rt, const struct dt_panel *panel);
bool gl_panel_resize(struct gl_runtime *rt, uint32_t width, uint32_t height);
void gl_panel_destroy(struct gl_runtime *rt);
bool gl_frame_render(struct gl_runtime *rt, const struct dt_frame *frame, const void *live,
                     const struct dt_observer *observer);
bool gl_frame_timings(struct gl_runtime *rt, double *pass_ms);

/* ---- resources.c ----------------------------------------------------------------------------- */

/* How texels of a format lie in memory, in the words of glTextureSubImage and
 * glGetTextureSubImage. */
struct gl_format {
    const char *name;
    GLenum internal, format, type;
    uint32_t bytes; /* per texel */
};
const struct gl_format *gl_format(enum dt_format format);
bool gl_depth(const struct gl_image *image);

/* A buffer with initial content (size bytes; NULL: none) that gl_buffer_write may change. */
bool gl_buffer_upload(struct gl_runtime *rt, struct gl_buffer *buffer,
                      const struct gl_buffer_info *info, const void *data);
bool gl_buffer_write(struct gl_runtime *rt, const struct gl_buffer *buffer, const void *data,
                     size_t size);

/* ---- scene.c --------------------------------------------------------------------------------- */

bool gl_scene_upload(struct gl_runtime *rt,
                     const struct dt_scene *scene); /* replaces the former scene */
bool gl_scene_describe(struct gl_runtime *rt);      /* the vertex buffer, for draws */
void gl_scene_destroy(struct gl_runtime *rt);

/* ---- present.c: the verbs of a window -------------------------------------------------------- */

bool gl_window_copy(struct gl_runtime *rt, uint32_t texture, const struct gl_image *image);
bool gl_window_upload(struct gl_runtime *rt, uint32_t texture, uint32_t width, uint32_t height,
                      const uint8_t *pixels);
bool gl_present(struct gl_runtime *rt, const struct dt_window_frame *frame);
void gl_present_destroy(struct gl_runtime *rt);

/* ---- readback.c ------------------------------------------------------------------------------ */

/* Size and extent of one mip; no data. */
struct dt_bytes gl_image_shape(const struct gl_image *image, uint32_t mip);

/* Size and extent are given, here and in `out`, whose data these allocate. */
bool gl_read_buffer(struct gl_runtime *rt, const struct gl_buffer *buffer, struct dt_bytes *out);
bool gl_read_image(struct gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                   struct dt_bytes *out);
bool gl_write_buffer(struct gl_runtime *rt, const struct gl_buffer *buffer,
                     const struct dt_bytes *bytes);
bool gl_write_image(struct gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                    const struct dt_bytes *bytes);

#endif
