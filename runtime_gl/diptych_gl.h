/* Runs pipelines of diptych inside an existing OpenGL renderer, the host. The host provides a
 * current context. The passes of a pipeline run between the host's commands and restore the
 * context's state. diptych_vk.h is the same for Vulkan.
 *
 *     struct dt_gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
 *         .log = log, .get_proc_address = eglGetProcAddress});
 *     dt_gl_import_scene(rt, &(struct dt_gl_scene){.vertices = ..., .indices = ..., ...});
 *     dt_gl_create(rt, &ssvp_gl);
 *     dt_gl_import_image(rt, SSVP_RESOURCE_DISPLAY, mine);
 *     dt_gl_resize(rt, width, height);
 *     dt_gl_write(rt, ...) for inputs of the pipeline
 *     each frame:
 *         dt_scene_compose(&camera, &light, &extent, width, height, &frame); from diptych_scene.h
 *         dt_gl_record(rt, &frame, &live);
 *         ... commands of the host, which may use `mine` at once ...
 *     dt_gl_close(rt);
 *
 * diptych-gen generates `ssvp_gl` (a struct dt_shaders), SSVP_RESOURCE_DISPLAY and struct
 * ssvp_live: compile NAME.c and NAME_gl_shaders.c into the host, and include NAME.h.
 *
 * Context. OpenGL 4.6 core, or 4.5 with the extensions that became 4.6 (Mesa's software drivers report
 * 4.5), and GL_ARB_shader_viewport_layer_array; error checks not turned off. The same context must be current in every call, because contexts that share objects do not
 * share vertex arrays and framebuffers. diptych makes no context current and swaps no buffers. This
 * header uses no OpenGL types and needs no loader header: texture and buffer names are unsigned
 * ints, like GLuint.
 *
 * Errors. A function that returns false or NULL has logged one DT_ERROR with the reason; with NULL in
 * place of the runtime it does nothing, since that open has failed. After a
 * failed resize or record, call only resize or close. There is no other output, no global state, no
 * exit. Each call removes pending OpenGL errors of the host and logs the first as a DT_WARNING.
 *
 * Several pipelines. A runtime holds one pipeline; open one runtime per pipeline and frame size,
 * all in one context. Runtimes share only objects that the host imports into both. A second view of one
 * pipeline finds its programs in the driver's cache.
 *
 * Threads. One thread at a time may use a runtime, with the context current.
 *
 * Synchronisation. record begins and ends with glMemoryBarrier(GL_ALL_BARRIER_BITS), so the host
 * needs no barrier for imported objects. Only dt_gl_timings waits; glFinish and fences are up to
 * the host. OpenGL itself orders frames in flight.
 *
 * State. Every function leaves the context as it found it: program, vertex array, framebuffers,
 * viewports, depth ranges, scissor tests, blending, colour and depth masks, depth, cull and polygon
 * modes, clip control and distances, the switches of rasterization, pixel storage, texture units,
 * samplers, image units, uniform and storage buffers. With `leave_state` diptych does not restore
 * the state, which saves some glGet; the state is then unspecified. Do not call record during
 * transform feedback or conditional rendering. Queries of the host that count samples or primitives
 * also count those of the passes. */
#ifndef DIPTYCH_GL_H
#define DIPTYCH_GL_H

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

#pragma GCC visibility push(default) /* what the libraries export */

struct dt_gl_runtime;

struct dt_gl_host {
    struct dt_log log; /* message NULL: no log */
    /* Like eglGetProcAddress, glfwGetProcAddress. dt_gl_open loads all OpenGL functions. */
    void (*(*get_proc_address)(const char *name))(void);
    bool leave_state; /* do not restore the context's state */
    bool glsl;        /* programs from GLSL text instead of SPIR-V; needs diptych-gen --glsl */
    bool timing;      /* timestamps around every pass, for dt_gl_timings */
    uint32_t frames;  /* whose timings are kept, up to 16; 0: 1 */
    /* Resources with history, and inputs, keep their content over resize and create, where name, size
     * and layout are the same. Not after a failed frame, nor from one not recorded to its end. */
    bool keep_history;
    /* AUTO: create takes the shaders for CPU drivers where GL_RENDERER names one (llvmpipe, softpipe,
     * swrast, lavapipe, SwiftShader) and the scene, which is then imported before create, fits into its
     * texel buffers; else those for GPUs. The bits are the same. */
    enum dt_target_device target;
};

/* NULL after an error, for example if the context lacks a required feature. */
struct dt_gl_runtime *dt_gl_open(const struct dt_gl_host *host);
void dt_gl_close(struct dt_gl_runtime *rt); /* accepts NULL; does not destroy imported objects */

/* ---- The scene ------------------------------------------------------------------------------- */

/* Bytes `offset` to `offset + size` of a buffer; the offset is a multiple of
 * GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT and
 * GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT. */
struct dt_gl_range {
    unsigned buffer;
    uint64_t offset, size;
};

/* One attribute of the vertices: a float vector or uint as in struct dt_vertex, every `stride` bytes
 * from `offset` on. Both are multiples of 4; a stride is at most 2048. */
struct dt_gl_attribute {
    unsigned buffer;
    uint64_t offset;
    uint32_t stride;
};

/* The scene that passes draw and read. Where NAME.h says that a pass reads vertex_triangle, each
 * triangle begins with a vertex of its own, whose `triangle` is the triangle's number;
 * dt_number_triangles makes such arrays. Other arrays give a wrong picture and no error, since the
 * runtime does not read them. The host owns the buffers; they must live until the next import or
 * close. The host may write them between frames; the next frame uses the new content. */
struct dt_gl_scene {
    /* struct dt_vertex[]; buffer 0: no pass reads scene_vertices, and `attributes` has all that
     * draws read */
    struct dt_gl_range vertices;
    /* of a layout of the host's own, in place of a field of `vertices`; buffer 0: none */
    struct dt_gl_attribute attributes[DT_ATTRIBUTES];
    struct dt_gl_range indices; /* uint32_t[], three per triangle; offset 0 */
    uint32_t index_count;
    /* struct dt_material[DT_MAX_MATERIALS]; unused elements may have any content */
    struct dt_gl_range materials;
    struct dt_gl_range objects; /* struct dt_object[]; buffer 0: no pass reads scene_objects */
    /* Array of all textures: GL_TEXTURE_2D_ARRAY, GL_SRGB8_ALPHA8 or another sRGB format, a full
     * chain of mips. 0: no material has a texture. With `diptych-gen --codes`: GL_SRGB8_ALPHA8 of
     * immutable storage. */
    unsigned textures;
    /* Each triangle begins with a vertex of its own, whose `triangle` is the triangle's number;
     * dt_number_triangles makes such arrays. The runtime does not read them: it takes the host's
     * word, and resize fails without it where a pass reads vertex_triangle, which NAME.h tells. */
    bool numbered;
};
/* Call before resize. Import and resize again when a name, a size or index_count changes. A
 * pipeline whose passes neither draw nor read the scene needs no scene. */
bool dt_gl_import_scene(struct dt_gl_runtime *rt, const struct dt_gl_scene *scene);

/* ---- The pipeline ---------------------------------------------------------------------------- */

/* Creates the programs, which takes seconds on some drivers. Replaces the previous pipeline and
 * reuses its unchanged programs. The shaders must live until the next create or close. If the context
 * lacks what a pass needs, create logs it and the pass, and the pipeline before stays. */
bool dt_gl_create(struct dt_gl_runtime *rt, const struct dt_shaders *shaders);

/* Uses a texture of the host for a resource of the pipeline. The texture is immutable
 * (glTextureStorage2D, 3D for arrays and 3D images), with the format, size, layers or depth, and mips
 * of the resource; resize checks this. Row 0 in memory is NDC y = -1, the bottom of the picture, as usual in OpenGL.
 * A frame may lose the old content. The texture must live until the next import of the resource,
 * create or close. `resource` is NAME_RESOURCE_...; call after create, before resize. Texture 0
 * cancels the import. */
bool dt_gl_import_image(struct dt_gl_runtime *rt, uint32_t resource, unsigned texture);

/* Uses a buffer of the host for a resource of the pipeline: at least as many bytes as the resource
 * has, laid out as in NAME.h. The offset is also a multiple of 4; 0 if passes take indices or
 * arguments from the buffer. The buffer must live until the next import of the resource, create or
 * close. Call after create, before resize. Buffer 0 cancels the import. diptych never writes an
 * imported input, buffer or image; the host may write it between frames. */
bool dt_gl_import_buffer(struct dt_gl_runtime *rt, uint32_t resource,
                         const struct dt_gl_range *range);

/* Creates all other resources, for a frame size in pixels. Resources with history start at zero,
 * but not imported ones, nor those that keep_history has kept. */
bool dt_gl_resize(struct dt_gl_runtime *rt, uint32_t width, uint32_t height);

/* Hands in the content of an input: of a buffer (mip 0), or of one mip of an image. record needs
 * every input that is not imported, after each resize; the content then stays, and may be replaced
 * between frames. Also inputs with a `file` in the spec: diptych reads no files for a host. `bytes`:
 * the whole resource or mip, tightly packed, row 0 first, that is the bottom of a picture; elements
 * of a struct lie as in NAME.h. Its `extent` is what NAME_pipeline.extent gives for the frame size, of
 * an image halved for each mip, at least 1. They are borrowed for the call. */
bool dt_gl_write(struct dt_gl_runtime *rt, uint32_t resource, uint32_t mip,
                 const struct dt_bytes *bytes);

/* Runs all passes of one frame. Ignores width and height of `frame`; the host counts `index` from 0
 * after every resize. `live`: the live parameters, struct NAME_live; NULL: their defaults. The
 * function reads both before it returns. */
bool dt_gl_record(struct dt_gl_runtime *rt, const struct dt_frame *frame, const void *live);

/* Runs the passes `first` to `end` - 1, so that commands of the host can stand between two parts of a
 * frame:
 *
 *     dt_gl_record_passes(rt, &frame, &live, 0, SSVP_PASS_SHADE);
 *     ... commands of the host ...
 *     dt_gl_record_passes(rt, NULL, NULL, SSVP_PASS_SHADE, SSVP_PASSES);
 *
 * `first` is 0 or the `end` of the call before. The frame is complete when `end` is NAME_PASSES; resize
 * abandons it. `frame` and `live` of the first part hold for the whole frame; later ones are not read.
 * Every part begins and ends with the barrier, so the host may read and write, between the parts, each
 * resource that dt_gl_get_resource gives. A pass that replaces all of a resource discards what the host
 * wrote. Outputs have content only after the pass that writes them; before it, their memory is that of
 * other resources: do not write them. */
bool dt_gl_record_passes(struct dt_gl_runtime *rt, const struct dt_frame *frame, const void *live,
                         uint32_t first, uint32_t end);

/* The OpenGL object of a resource, imported or not, to copy or sample it after a frame. Members of
 * the other kind are 0. Valid until resize; diptych owns what the host did not import. */
struct dt_gl_resource {
    unsigned buffer;
    uint64_t offset, size; /* bytes; offset: 0 unless imported */
    uint32_t stride;       /* bytes from element to element */
    unsigned texture;
    unsigned target, format;              /* GL_TEXTURE_..., sized internal format */
    uint32_t width, height, layers, mips; /* layers: also the depth of a 3D image */
};
/* An error if the resource is neither an output, nor imported, nor has `keep: true`, `history: true`
 * or content from outside in the spec: other passes may have reused its memory. Also an error between
 * the parts of a frame for an output that no part so far has written. */
bool dt_gl_get_resource(struct dt_gl_runtime *rt, uint32_t resource, struct dt_gl_resource *out);

/* Milliseconds of each pass of a frame, pass_count values; NAN: skipped, or not finished yet, since this
 * function never waits. `age`: 0 is the last frame, 1 the one before, up to `frames` - 1 of the host; all
 * since resize. The older a frame, the likelier it has finished. */
bool dt_gl_timings(struct dt_gl_runtime *rt, uint32_t age, double *pass_ms);

#pragma GCC visibility pop

#ifdef __cplusplus
}
#endif
#endif
