/* Pipelines of diptych in an OpenGL renderer that is there already. The host brings a current context;
 * the passes of a pipeline run between its own commands, and the state of the context is afterwards what
 * it was before. diptych_vk.h is the same for Vulkan.
 *
 *     struct gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
 *         .log = log, .get_proc_address = eglGetProcAddress});
 *     dt_gl_import_scene(rt, &(struct dt_gl_scene){.vertices = ..., .indices = ..., ...});
 *     dt_gl_create(rt, &ssvp_gl);
 *     dt_gl_import_image(rt, SSVP_RESOURCE_DISPLAY, mine);
 *     dt_gl_resize(rt, width, height);
 *     each frame:
 *         dt_gl_record(rt, &frame, &live);
 *         ... commands of the host, which may use `mine` at once ...
 *     dt_gl_close(rt);
 *
 * `ssvp_gl` (a struct dt_shaders), SSVP_RESOURCE_DISPLAY and struct ssvp_live come from the files that
 * diptych-gen writes: compile NAME.c and NAME_gl_shaders.c into the host, and include NAME.h.
 *
 * Context. OpenGL 4.6 core with GL_ARB_shader_viewport_layer_array, errors not turned off, and the very
 * same context current in every call: of contexts that share objects only one has vertex arrays and
 * framebuffers. diptych makes no context current and swaps no buffers. This header names no type of
 * OpenGL and needs no loader's header: texture and buffer names are unsigned ints, as GLuint is.
 *
 * Errors. A function that returns false or NULL has said why in one DT_ERROR to the log; a runtime whose
 * resize or record failed takes nothing but resize and close. There is no other output, no global
 * state, no exit. Errors that were pending before a call are taken from glGetError and told as a
 * DT_WARNING.
 *
 * Several pipelines. A runtime holds one pipeline; open as many in one context as there are pipelines or
 * frame sizes. They share nothing but what the host gives to both.
 *
 * Threads. One thread at a time may use a runtime, with the context current.
 *
 * Synchronisation. record begins and ends with glMemoryBarrier(GL_ALL_BARRIER_BITS): the host needs none
 * before or after for what it imported. Nothing waits; glFinish and fences are the host's. OpenGL itself
 * keeps frames in flight apart.
 *
 * State. Every function leaves the context as it found it: program, vertex array, framebuffers, viewports,
 * depth ranges, scissor tests, blending, colour and depth masks, depth, cull and polygon modes, clip
 * control and distances, the switches of rasterization, pixel storage, texture units, samplers, image
 * units, uniform and storage buffers. With `leave_state` it does not, which saves some glGet; what is left
 * behind is then unspecified. Two things must not be going on during record: transform feedback and
 * conditional rendering; and queries that count samples or primitives count those of the passes, too. */
#ifndef DIPTYCH_GL_H
#define DIPTYCH_GL_H

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

#pragma GCC visibility push(default) /* what the libraries export */

struct gl_runtime;

struct dt_gl_host {
    struct dt_log log; /* message NULL: silence */
    /* As eglGetProcAddress and glfwGetProcAddress are. Every function of OpenGL is asked for here, once. */
    void (*(*get_proc_address)(const char *name))(void);
    bool leave_state; /* do not give the context's state back */
    bool glsl;        /* programs from GLSL text instead of SPIR-V */
    bool timing;      /* timestamps around every pass, for dt_gl_timings */
};

/* NULL: the context lacks something, which the log tells. */
struct gl_runtime *dt_gl_open(const struct dt_gl_host *host);
void dt_gl_close(struct gl_runtime *rt); /* takes NULL; leaves what was imported alone */

/* ---- The scene ------------------------------------------------------------------------------- */

/* Bytes `offset` to `offset + size` of a buffer; the offset is a multiple of
 * GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT and GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT. */
struct dt_gl_range {
    unsigned buffer;
    uint64_t offset, size;
};

/* What passes draw and read. The buffers stay the host's, must live until the next import or close, and
 * may be written between frames: the next frame sees it. */
struct dt_gl_scene {
    struct dt_gl_range vertices; /* struct dt_vertex[] */
    struct dt_gl_range indices;  /* uint32_t[], three per triangle; offset 0 */
    uint32_t index_count;
    /* struct dt_material[DT_MAX_MATERIALS], whatever stands behind those in use */
    struct dt_gl_range materials;
    /* Array of all textures (GL_TEXTURE_2D_ARRAY, GL_SRGB8_ALPHA8 or another sRGB format, a full chain
     * of mips). 0: no material has a texture. */
    unsigned textures;
};
/* Before resize, and again with a resize after it when a name, a size or index_count changes. A pipeline
 * whose passes neither draw nor read the scene needs none. */
bool dt_gl_import_scene(struct gl_runtime *rt, const struct dt_gl_scene *scene);

/* ---- The pipeline ---------------------------------------------------------------------------- */

/* Makes the programs, which takes seconds on some drivers; replaces the former pipeline, of which it keeps
 * the programs that have not changed. The shaders must live as long as the runtime has them. */
bool dt_gl_create(struct gl_runtime *rt, const struct dt_shaders *shaders);

/* A texture of the host in place of a resource of the pipeline: immutable (glTextureStorage2D, 3D for an
 * array), with the format, size, layers and mips of the resource, which resize checks. Row 0 in memory is
 * NDC y = -1, the bottom of the picture, as OpenGL has it. Its content before a frame may be lost. It
 * lives until the next import of the resource, create or close. `resource` is NAME_RESOURCE_...; after
 * create, before resize. A texture of 0 takes the import back. */
bool dt_gl_import_image(struct gl_runtime *rt, uint32_t resource, unsigned texture);

/* Makes all other resources, for frames of that size in pixels. Content with history becomes zero. */
bool dt_gl_resize(struct gl_runtime *rt, uint32_t width, uint32_t height);

/* Runs one frame, all passes. Of `frame` width and height are filled in; `index` is the host's to count
 * from 0 after every resize. `live` is the pipeline's block of live parameters, struct NAME_live; NULL:
 * their defaults. Both are read before the function returns. */
bool dt_gl_record(struct gl_runtime *rt, const struct dt_frame *frame, const void *live);

/* What a resource is made of, imported or not: to copy it, or to sample it, after a frame. Of resources
 * that are no outputs other passes may have taken the texture. 0 for the kind that it is not; good until
 * resize. */
struct dt_gl_resource {
    unsigned buffer, texture;
};
bool dt_gl_resource(struct gl_runtime *rt, uint32_t resource, struct dt_gl_resource *out);

/* Milliseconds of each pass of the last frame, pass_count of them, NAN for a skipped one. Waits for the
 * frame. */
bool dt_gl_timings(struct gl_runtime *rt, double *pass_ms);

#pragma GCC visibility pop

#ifdef __cplusplus
}
#endif
#endif
