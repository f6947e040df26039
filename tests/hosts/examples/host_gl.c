/* Takes diptych's pipelines into an OpenGL renderer (renderer_gl.c): context, vertex buffers and pictures
 * are its own, and so is the state of the context, which it leaves in disorder on purpose and finds again
 * as it was. `host_gl SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm]` runs ssvp, or ssvp and rsm in turn.
 * Built against an installed diptych by tests/hosts/install_test.sh. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <diptych_gl.h>
#include <diptych_scene.h>

#include "renderer_gl.h"
#include "rsm.h"
#include "ssvp.h"

enum { MAX_PIPELINES = 2 };

enum { COPY = 128 }; /* where the renderer's copy of the exposure is, in bytes */

struct pipeline {
    const struct dt_shaders *shaders;
    uint32_t output, exposure;
    uint32_t seam, passes; /* a frame is recorded in two parts, up to the seam and from there on */
};

static const struct pipeline pipelines[MAX_PIPELINES] = {
    {&ssvp_gl, SSVP_RESOURCE_DISPLAY, SSVP_RESOURCE_LUMINANCE_SCALE, SSVP_PASS_TONEMAP,
     SSVP_PASSES},
    {&rsm_gl, RSM_RESOURCE_DISPLAY, RSM_RESOURCE_LUMINANCE_SCALE, RSM_PASS_TONEMAP, RSM_PASSES}};

struct view {
    struct dt_gl_runtime *rt;
    GLuint picture, exposure; /* exposure: as in host_vk.c */
};

struct geometry {
    GLuint buffer, indices; /* vertices behind the materials */
    GLuint textures;        /* an array, with mips */
};

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level >= DT_WARNING)
        fprintf(stderr, "diptych: %s\n", message);
}

static GLuint make_textures(const struct dt_scene *scene)
{
    GLuint textures;
    GLsizei width = (GLsizei)scene->texture_width, height = (GLsizei)scene->texture_height;
    GLsizei layers = (GLsizei)scene->texture_layers, mips = (GLsizei)scene->texture_mips;
    const uint8_t *texels = scene->texels;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &textures);
    glTextureStorage3D(textures, mips, GL_SRGB8_ALPHA8, width, height, layers);
    for (GLint mip = 0; mip < mips; mip++) {
        glTextureSubImage3D(textures, mip, 0, 0, 0, width, height, layers, GL_RGBA,
                            GL_UNSIGNED_BYTE, texels);
        texels += (size_t)width * (size_t)height * scene->texture_layers * 4;
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
    }
    return textures;
}

static struct geometry make_scene(const struct dt_scene *scene)
{
    const size_t materials = DT_MAX_MATERIALS * sizeof *scene->materials;
    const size_t vertices = scene->vertex_count * sizeof *scene->vertices;
    char *bytes = calloc(1, materials + vertices);
    check(bytes, "memory");
    memcpy(bytes, scene->materials, scene->material_count * sizeof *scene->materials);
    memcpy(bytes + materials, scene->vertices, vertices);
    const struct geometry geometry = {
        make_buffer(bytes, materials + vertices),
        make_buffer(scene->indices, scene->index_count * sizeof *scene->indices),
        make_textures(scene)};
    free(bytes);
    return geometry;
}

static struct view open_view(const struct geometry *geometry, const struct dt_scene *scene,
                             const struct pipeline *pipeline, uint32_t width, uint32_t height)
{
    const char zero[256] = {0};
    const GLuint picture = make_texture(GL_RGBA8, width, height);
    const GLuint exposure = make_buffer(zero, sizeof zero);
    const struct dt_gl_range range = {.buffer = exposure, .size = COPY};
    struct dt_gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
        .log = {.message = on_log},
        .get_proc_address = eglGetProcAddress,
    });
    const uint64_t materials = DT_MAX_MATERIALS * sizeof *scene->materials;
    const struct dt_gl_scene import = {
        .vertices = {geometry->buffer, materials, scene->vertex_count * sizeof *scene->vertices},
        .indices = {geometry->indices, 0, scene->index_count * sizeof *scene->indices},
        .index_count = scene->index_count,
        .materials = {geometry->buffer, 0, materials},
        .textures = geometry->textures,
        .numbered = true, /* as all that diptych_scene.h loads */
    };
    check(rt && dt_gl_import_scene(rt, &import) && dt_gl_create(rt, pipeline->shaders) &&
              dt_gl_import_image(rt, pipeline->output, picture) &&
              dt_gl_import_buffer(rt, pipeline->exposure, &range) &&
              dt_gl_resize(rt, width, height),
          "opening a pipeline");
    return (struct view){rt, picture, exposure};
}

/* In two parts; between them the renderer takes the exposure, which the pass before wrote, and gives it
 * to the pass after. */
static void run_frame(const struct view *view, const struct pipeline *pipeline,
                      const struct dt_frame *frame)
{
    check(dt_gl_record_passes(view->rt, frame, NULL, 0, pipeline->seam), "a frame");
    check_state("a part of a frame");
    glCopyNamedBufferSubData(view->exposure, view->exposure, 0, COPY, sizeof(float));
    glCopyNamedBufferSubData(view->exposure, view->exposure, COPY, 0, sizeof(float));
    check(dt_gl_record_passes(view->rt, NULL, NULL, pipeline->seam, pipeline->passes),
          "the rest of a frame");
    check_state("a frame");
}

static void close_view(const struct view *view, uint32_t width, uint32_t height, const char *path)
{
    float exposure, copy;
    write_texture(view->picture, width, height, path);
    glGetNamedBufferSubData(view->exposure, 0, sizeof exposure, &exposure);
    glGetNamedBufferSubData(view->exposure, COPY, sizeof copy, &copy);
    check(exposure > 0 && copy == exposure, "taking the exposure");
    dt_gl_close(view->rt);
}

int main(int argc, char **argv)
{
    const struct dt_log log = {.message = on_log};
    check(argc == 6 || argc == 7, "usage: host_gl SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm]:");
    uint32_t width = (uint32_t)atoi(argv[2]), height = (uint32_t)atoi(argv[3]);
    uint32_t frames = (uint32_t)atoi(argv[4]), count = (uint32_t)argc - 5;
    struct view views[MAX_PIPELINES];
    struct dt_frame frame;
    struct dt_scene_file *scene = dt_scene_open(argv[1], NULL, &log);
    check(scene, argv[1]);
    dt_scene_frame(scene, width, height, &frame);
    renderer_open();
    const struct geometry geometry = make_scene(dt_scene_data(scene));
    make_disorder();
    check_state("nothing");
    for (uint32_t i = 0; i < count; i++) {
        views[i] = open_view(&geometry, dt_scene_data(scene), &pipelines[i], width, height);
        check_state("opening a pipeline");
    }
    for (frame.index = 0; frame.index < frames; frame.index++)
        for (uint32_t i = 0; i < count; i++)
            run_frame(&views[i], &pipelines[i], &frame);
    for (uint32_t i = 0; i < count; i++)
        close_view(&views[i], width, height, argv[5 + i]);
    check_state("closing");
    dt_scene_close(scene);
    return renderer_is_silent() ? 0 : 1;
}
