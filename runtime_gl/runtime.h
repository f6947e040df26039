/* The OpenGL 4.6 runtime: what generated pipelines (NAME_gl.c) call, and the table of verbs for
 * the app. The Vulkan runtime has the same file names and the same verbs. Knows no pipeline. All
 * state is in struct gl_runtime; functions are called through a table of its own, so several
 * contexts live side by side. Every function that returns bool has logged the error when it
 * returns false. */
#ifndef DIPTYCH_RUNTIME_GL_H
#define DIPTYCH_RUNTIME_GL_H

#include <GL/glcorearb.h>

#include "diptych.h"

#pragma GCC visibility push(default) /* what the libraries export */

enum { GL_ALL_MIPS = 0xffff, GL_MAX_COLOR_TARGETS = 8 };

struct gl_runtime;

struct gl_buffer {
    const char *name;
    GLuint handle;
    GLsizeiptr size;  /* bytes, at least 16 */
    GLsizeiptr block; /* bytes bound as a uniform block, where that is more than size; else 0 */
    GLintptr offset;  /* bytes; 0 but for a host's */
    bool imported;    /* the handle is a host's, and so are the bytes before and behind */
};

struct gl_image {
    const char *name;
    GLuint handle;
    GLenum target; /* GL_TEXTURE_2D or GL_TEXTURE_2D_ARRAY */
    GLenum format; /* sized internal format */
    enum dt_format texel;
    uint32_t width, height, layers, mips;
    bool layered;
    bool borrowed; /* shares the texture of another resource of disjoint lifetime, that owns it */
    bool imported; /* the texture is a host's */
};

/* ---- Resources: resize, destroy -------------------------------------------------------------- */

struct gl_buffer_info {
    const char *name;
    GLsizeiptr size;  /* bytes; raised to 16 */
    GLsizeiptr block; /* bytes of the uniform block that shaders declare; 0: as many */
};
bool dt_gl_buffer_create(struct gl_runtime *rt, struct gl_buffer *buffer,
                         const struct gl_buffer_info *info);

struct gl_image_info {
    const char *name;
    enum dt_format format;
    uint32_t width, height, layers, mips;
    bool layered;
    /* same format and size, disjoint lifetime: take its texture; NULL: an own one */
    const struct gl_image *share;
};
bool dt_gl_image_create(struct gl_runtime *rt, struct gl_image *image,
                        const struct gl_image_info *info);

/* Zero-fills resources with history; fills the others with options.poison when that is set. One
 * of the two is NULL. */
bool dt_gl_initialise(struct gl_runtime *rt, struct gl_buffer *buffer, struct gl_image *image,
                      bool history);

void dt_gl_buffer_destroy(struct gl_runtime *rt,
                          struct gl_buffer *buffer); /* all take zeroed structs, and zero them */
void dt_gl_image_destroy(struct gl_runtime *rt, struct gl_image *image);

/* ---- Samplers -------------------------------------------------------------------------------- */

struct gl_sampler_info {
    const char *name;
    GLenum filter;     /* GL_NEAREST or GL_LINEAR */
    GLenum mip_filter; /* GL_NEAREST or GL_LINEAR: between mips */
    GLenum wrap;
    bool compare;     /* shadow sampler: GL_LEQUAL */
    float anisotropy; /* 1: off */
};
bool dt_gl_sampler_create(struct gl_runtime *rt, GLuint *sampler,
                          const struct gl_sampler_info *info);
void dt_gl_sampler_destroy(struct gl_runtime *rt, GLuint *sampler);

/* ---- Programs: one per pass ------------------------------------------------------------------ */

struct gl_program_info {
    const char *name;
    struct dt_code compute, vertex, fragment;
    /* vertex attributes of struct dt_vertex at locations 0 to 3; else no vertex input */
    bool scene_vertices;
    bool depth_test, depth_write;
    GLenum depth_compare;
    GLenum cull; /* GL_NONE, GL_BACK or GL_FRONT; front faces are GL_CCW */
    bool blend_add;
    uint32_t clip_distances; /* GL_CLIP_DISTANCE0 + i to enable */
};

struct gl_program {
    const char *name;
    GLuint handle;
    struct gl_program_info info; /* code of the panel */
};
bool dt_gl_program_create(struct gl_runtime *rt, struct gl_program *program,
                          const struct gl_program_info *info);
void dt_gl_program_destroy(struct gl_runtime *rt, struct gl_program *program);

/* ---- Framebuffers: one per pass that draws --------------------------------------------------- */

struct gl_target {
    const struct gl_image *image;
    uint32_t mip;
    bool load; /* keep the content; else clear to `clear` */
    float clear[4];
};
struct gl_targets {
    struct gl_target color[GL_MAX_COLOR_TARGETS];
    uint32_t color_count;
    struct gl_target depth; /* image NULL: none */
    /* 1, or the layers of a layered draw: then attachments are whole array textures */
    uint32_t layers;
};
bool dt_gl_framebuffer_create(struct gl_runtime *rt, GLuint *framebuffer,
                              const struct gl_targets *targets);
void dt_gl_framebuffer_destroy(struct gl_runtime *rt, GLuint *framebuffer);

/* ---- Recording ------------------------------------------------------------------------------- */

/* Debug group and timestamps around a pass. begin asks the observer, when there is one: of a
 * pass that it skips only the barriers are issued. end then finishes and calls it. */
bool dt_gl_pass_begin(struct gl_runtime *rt, uint32_t pass, bool runs);
bool dt_gl_pass_end(struct gl_runtime *rt, uint32_t pass);

bool dt_gl_barrier(struct gl_runtime *rt, GLbitfield bits); /* glMemoryBarrier */

enum gl_binding_kind { GL_BIND_UNIFORM, GL_BIND_STORAGE, GL_BIND_TEXTURE, GL_BIND_IMAGE };
struct gl_binding {
    uint32_t binding;
    enum gl_binding_kind kind;
    const struct gl_buffer *buffer;
    const struct gl_image *image;
    uint32_t mip;   /* GL_BIND_IMAGE: the mip */
    GLenum access;  /* GL_BIND_IMAGE: GL_READ_ONLY, GL_WRITE_ONLY, GL_READ_WRITE */
    GLuint sampler; /* GL_BIND_TEXTURE; 0: nearest, clamped, for texelFetch */
};
bool dt_gl_bind(struct gl_runtime *rt, const struct gl_binding *bindings, uint32_t count);

bool dt_gl_dispatch(struct gl_runtime *rt, const struct gl_program *program, uint32_t x, uint32_t y,
                    uint32_t z);
bool dt_gl_dispatch_indirect(struct gl_runtime *rt, const struct gl_program *program,
                             const struct gl_buffer *arguments);

/* Draws the whole scene `instances` times; a layered draw picks gl_Layer from gl_InstanceIndex. */
bool dt_gl_draw_scene(struct gl_runtime *rt, const struct gl_program *program, GLuint framebuffer,
                      const struct gl_targets *targets, uint32_t instances);
/* Draws from an index buffer and DrawElementsIndirectCommand[draw_count] that compute passes
 * wrote; indices NULL: the scene's own. */
bool dt_gl_draw_scene_indirect(struct gl_runtime *rt, const struct gl_program *program,
                               GLuint framebuffer, const struct gl_targets *targets,
                               const struct gl_buffer *indices, const struct gl_buffer *arguments,
                               uint32_t draw_count);
bool dt_gl_draw_fullscreen(struct gl_runtime *rt, const struct gl_program *program,
                           GLuint framebuffer, const struct gl_targets *targets);
bool dt_gl_clear_targets(struct gl_runtime *rt, GLuint framebuffer,
                         const struct gl_targets *targets); /* a skipped draw */
/* A skipped dispatch: the mip that it would have written. */
bool dt_gl_clear_image(struct gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                       const float clear[4]);
bool dt_gl_clear_buffer(struct gl_runtime *rt, const struct gl_buffer *buffer);

/* ---- What the runtime brings along: bind these like any resource ----------------------------- */

struct gl_builtin {
    struct gl_buffer frame;     /* uniform block struct dt_frame */
    struct gl_buffer live;      /* uniform block of the live parameters */
    struct gl_buffer vertices;  /* storage, struct dt_vertex[]; also the vertex buffer */
    struct gl_buffer indices;   /* storage, uint[]; also the index buffer */
    struct gl_buffer materials; /* storage or uniform, struct dt_material[DT_MAX_MATERIALS] */
    struct gl_image textures;   /* array texture */
    GLuint texture_sampler;     /* trilinear, repeat */
};
const struct gl_builtin *dt_gl_builtin(const struct gl_runtime *rt);

#pragma GCC visibility pop

extern const struct dt_runtime runtime_gl;

#endif
