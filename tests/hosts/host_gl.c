/* A small OpenGL renderer that takes diptych's pipelines in: context, vertex buffers and pictures are its
 * own, and so is the state of the context, which it leaves in disorder on purpose and finds again as it
 * was. `host_gl SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm]` runs ssvp, or ssvp and rsm in turn. Built
 * against an installed diptych by tests/install_test.sh; HOST_DEBUG=1 hears KHR_debug. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <diptych_gl.h>
#include <diptych_scene.h>

#include "rsm.h"
#include "ssvp.h"

enum { MAX_PIPELINES = 2, STATE_SIZE = 256 };

static int messages; /* of KHR_debug */

static void check(bool good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "host: %s failed\n", what);
    exit(1);
}

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level >= DT_WARNING)
        fprintf(stderr, "diptych: %s\n", message);
}

static void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                GLsizei length, const GLchar *message, const void *user)
{
    (void)source, (void)id, (void)length, (void)user;
    if (severity == GL_DEBUG_SEVERITY_NOTIFICATION || type == GL_DEBUG_TYPE_PERFORMANCE)
        return;
    fprintf(stderr, "debug: %s\n", message);
    messages++;
}

/* ---- The renderer ---------------------------------------------------------------------------- */

struct host {
    uint32_t width, height, pipeline_count;
    GLuint geometry, indices; /* vertices behind the materials */
    GLuint textures;          /* an array, with mips */
    GLuint pictures[MAX_PIPELINES];
    struct gl_runtime *runtimes[MAX_PIPELINES];
};

static void open_context(void)
{
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 6,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 getenv("HOST_DEBUG") != NULL,
                                 EGL_NONE};
    /* Mesa's software driver has all of 4.6, and says so when asked. */
    setenv("MESA_GL_VERSION_OVERRIDE", "4.6", 0);
    setenv("MESA_GLSL_VERSION_OVERRIDE", "460", 0);
    EGLDisplay display =
        eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    check(eglInitialize(display, NULL, NULL) && eglBindAPI(EGL_OPENGL_API), "EGL");
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    check(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context), "OpenGL 4.6");
    if (getenv("HOST_DEBUG")) {
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glDebugMessageCallback(on_message, NULL);
    }
}

static GLuint make_buffer(const void *data, size_t size)
{
    GLuint buffer;
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, (GLsizeiptr)size, data, 0);
    return buffer;
}

static GLuint make_texture(GLenum format, uint32_t width, uint32_t height)
{
    GLuint texture;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, (GLsizei)width, (GLsizei)height);
    return texture;
}

/* State that would spoil every pass, were it left so. */
static void make_disorder(void)
{
    const GLenum switches[] = {GL_BLEND,
                               GL_COLOR_LOGIC_OP,
                               GL_CULL_FACE,
                               GL_DEPTH_CLAMP,
                               GL_POLYGON_OFFSET_FILL,
                               GL_PRIMITIVE_RESTART,
                               GL_RASTERIZER_DISCARD,
                               GL_SCISSOR_TEST,
                               GL_STENCIL_TEST,
                               GL_CLIP_DISTANCE0 + 3};
    GLuint framebuffer, input, uniforms = make_buffer(NULL, 4096);
    for (size_t i = 0; i < DT_ARRAY_COUNT(switches); i++)
        glEnable(switches[i]);
    glCreateFramebuffers(1, &framebuffer);
    glCreateVertexArrays(1, &input);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glBindVertexArray(input);
    glBindBufferRange(GL_UNIFORM_BUFFER, 0, uniforms, 1024, 512);
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 1, uniforms, 2048, 256);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, uniforms);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, uniforms);
    glBindTextureUnit(0, make_texture(GL_RGBA8, 4, 4));
    glBindTextureUnit(2, make_texture(GL_R32F, 4, 4));
    glBindImageTexture(0, make_texture(GL_RGBA16F, 4, 4), 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA16F);
    glBlendFunci(1, GL_DST_COLOR, GL_ZERO);
    glBlendEquationi(1, GL_FUNC_REVERSE_SUBTRACT);
    glColorMaski(0, GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    glClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glCullFace(GL_FRONT_AND_BACK);
    glDepthFunc(GL_NEVER);
    glDepthMask(GL_FALSE);
    glDepthRangeIndexed(0, 0.75, 0.25);
    glFrontFace(GL_CW);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 3);
    glPolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    glViewportIndexedf(0, 1, 2, 3, 4);
}

/* What diptych may have touched, as numbers; returns how many. */
static size_t read_state(GLint state[STATE_SIZE])
{
    static const GLenum plain[] = {
        GL_ACTIVE_TEXTURE,
        GL_BLEND,
        GL_CLIP_DEPTH_MODE,
        GL_CLIP_DISTANCE0,
        GL_CLIP_DISTANCE0 + 3,
        GL_CLIP_ORIGIN,
        GL_COLOR_LOGIC_OP,
        GL_CULL_FACE,
        GL_CULL_FACE_MODE,
        GL_CURRENT_PROGRAM,
        GL_DEPTH_CLAMP,
        GL_DEPTH_FUNC,
        GL_DEPTH_TEST,
        GL_DEPTH_WRITEMASK,
        GL_DISPATCH_INDIRECT_BUFFER_BINDING,
        GL_DITHER,
        GL_DRAW_FRAMEBUFFER_BINDING,
        GL_DRAW_INDIRECT_BUFFER_BINDING,
        GL_FRAMEBUFFER_SRGB,
        GL_FRONT_FACE,
        GL_PACK_ALIGNMENT,
        GL_PIXEL_UNPACK_BUFFER_BINDING,
        GL_POLYGON_OFFSET_FILL,
        GL_PRIMITIVE_RESTART,
        GL_PROVOKING_VERTEX,
        GL_RASTERIZER_DISCARD,
        GL_READ_FRAMEBUFFER_BINDING,
        GL_SCISSOR_TEST,
        GL_SHADER_STORAGE_BUFFER_BINDING,
        GL_STENCIL_TEST,
        GL_TEXTURE_CUBE_MAP_SEAMLESS,
        GL_UNIFORM_BUFFER_BINDING,
        GL_UNPACK_ALIGNMENT,
        GL_UNPACK_ROW_LENGTH,
        GL_VERTEX_ARRAY_BINDING,
    };
    static const GLenum indexed[] = {
        GL_BLEND_DST_ALPHA,      GL_BLEND_DST_RGB,
        GL_BLEND_EQUATION_ALPHA, GL_BLEND_EQUATION_RGB,
        GL_BLEND_SRC_ALPHA,      GL_BLEND_SRC_RGB,
        GL_IMAGE_BINDING_ACCESS, GL_IMAGE_BINDING_FORMAT,
        GL_IMAGE_BINDING_NAME,   GL_SHADER_STORAGE_BUFFER_BINDING,
        GL_TEXTURE_BINDING_2D,   GL_TEXTURE_BINDING_2D_ARRAY,
        GL_SAMPLER_BINDING,      GL_UNIFORM_BUFFER_BINDING,
    };
    size_t count = 0;
    memset(state, 0, STATE_SIZE * sizeof *state);
    for (size_t i = 0; i < DT_ARRAY_COUNT(plain); i++)
        glGetIntegerv(plain[i], &state[count++]);
    for (size_t i = 0; i < DT_ARRAY_COUNT(indexed); i++)
        for (GLuint k = 0; k < 8; k++)
            glGetIntegeri_v(indexed[i], k, &state[count++]);
    glGetIntegeri_v(GL_COLOR_WRITEMASK, 0, &state[count]);
    glGetIntegeri_v(GL_VIEWPORT, 0, &state[count + 4]);
    glGetIntegerv(GL_POLYGON_MODE, &state[count + 8]);
    for (GLuint k = 0; k < 4; k++) {
        GLint64 start = 0;
        glGetInteger64i_v(GL_UNIFORM_BUFFER_START, k, &start);
        state[count + 10 + k] = (GLint)start;
        glGetInteger64i_v(GL_SHADER_STORAGE_BUFFER_START, k, &start);
        state[count + 14 + k] = (GLint)start;
    }
    return count + 18;
}

static void check_state(const GLint before[STATE_SIZE], const char *what)
{
    GLint now[STATE_SIZE];
    size_t count = read_state(now);
    check(glGetError() == GL_NO_ERROR, "OpenGL");
    for (size_t i = 0; i < count; i++)
        if (now[i] != before[i]) {
            fprintf(stderr, "host: %s changed state %zu from 0x%x to 0x%x\n", what, i,
                    (unsigned)before[i], (unsigned)now[i]);
            exit(1);
        }
}

/* ---- Diptych in it --------------------------------------------------------------------------- */

static struct gl_runtime *open_pipeline(struct host *host, const struct dt_scene *scene,
                                        const struct dt_panel *panel, uint32_t output,
                                        GLuint picture)
{
    struct gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
        .log = {.message = on_log},
        .get_proc_address = eglGetProcAddress,
        .glsl = getenv("HOST_GLSL"),
    });
    const uint64_t materials = DT_MAX_MATERIALS * sizeof *scene->materials;
    const struct dt_gl_scene import = {
        .vertices = {host->geometry, materials, scene->vertex_count * sizeof *scene->vertices},
        .indices = {host->indices, 0, scene->index_count * sizeof *scene->indices},
        .index_count = scene->index_count,
        .materials = {host->geometry, 0, materials},
        .textures = host->textures,
    };
    check(rt && dt_gl_import_scene(rt, &import) && dt_gl_create(rt, panel) &&
              dt_gl_import_image(rt, output, picture) &&
              dt_gl_resize(rt, host->width, host->height),
          "opening a pipeline");
    return rt;
}

/* Row 0 in memory is the bottom of the picture. */
static void write_picture(const struct host *host, GLuint picture, const char *path)
{
    size_t size = (size_t)host->width * host->height * 4;
    unsigned char *pixels = malloc(size);
    FILE *file = fopen(path, "wb");
    check(file && pixels, path);
    glGetTextureImage(picture, 0, GL_RGBA, GL_UNSIGNED_BYTE, (GLsizei)size, pixels);
    fprintf(file, "P6\n%u %u\n255\n", host->width, host->height);
    for (uint32_t y = host->height; y-- > 0;)
        for (uint32_t x = 0; x < host->width; x++)
            fwrite(pixels + ((size_t)y * host->width + x) * 4, 1, 3, file);
    check(fclose(file) == 0, path);
    free(pixels);
}

static void make_textures(struct host *host, const struct dt_scene *scene)
{
    GLsizei width = (GLsizei)scene->texture_width, height = (GLsizei)scene->texture_height;
    GLsizei layers = (GLsizei)scene->texture_layers, mips = (GLsizei)scene->texture_mips;
    const uint8_t *texels = scene->texels;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &host->textures);
    glTextureStorage3D(host->textures, mips, GL_SRGB8_ALPHA8, width, height, layers);
    for (GLint mip = 0; mip < mips; mip++) {
        glTextureSubImage3D(host->textures, mip, 0, 0, 0, width, height, layers, GL_RGBA,
                            GL_UNSIGNED_BYTE, texels);
        texels += (size_t)width * (size_t)height * scene->texture_layers * 4;
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
    }
}

static void make_scene(struct host *host, const struct dt_scene *scene)
{
    const size_t materials = DT_MAX_MATERIALS * sizeof *scene->materials;
    const size_t vertices = scene->vertex_count * sizeof *scene->vertices;
    char *geometry = calloc(1, materials + vertices);
    check(geometry, "memory");
    memcpy(geometry, scene->materials, scene->material_count * sizeof *scene->materials);
    memcpy(geometry + materials, scene->vertices, vertices);
    host->geometry = make_buffer(geometry, materials + vertices);
    host->indices = make_buffer(scene->indices, scene->index_count * sizeof *scene->indices);
    free(geometry);
}

int main(int argc, char **argv)
{
    static const struct {
        const struct dt_panel *panel;
        uint32_t output;
    } pipelines[MAX_PIPELINES] = {{&ssvp_gl, SSVP_RESOURCE_DISPLAY},
                                  {&rsm_gl, RSM_RESOURCE_DISPLAY}};
    const struct dt_log log = {.message = on_log};
    check(argc == 6 || argc == 7, "usage: host_gl SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm]:");
    struct host host = {.width = (uint32_t)atoi(argv[2]),
                        .height = (uint32_t)atoi(argv[3]),
                        .pipeline_count = (uint32_t)argc - 5};
    GLint state[STATE_SIZE];
    struct dt_frame frame;
    struct dt_scene_file *scene = dt_scene_open(argv[1], NULL, &log);
    check(scene, argv[1]);
    dt_scene_frame(scene, host.width, host.height, &frame);
    open_context();
    make_scene(&host, dt_scene_data(scene));
    make_textures(&host, dt_scene_data(scene));
    make_disorder();
    read_state(state);
    check_state(state, "reading it");
    for (uint32_t i = 0; i < host.pipeline_count; i++) {
        host.pictures[i] = make_texture(GL_RGBA8, host.width, host.height);
        host.runtimes[i] = open_pipeline(&host, dt_scene_data(scene), pipelines[i].panel,
                                         pipelines[i].output, host.pictures[i]);
        check_state(state, "opening a pipeline");
    }
    for (uint32_t frames = (uint32_t)atoi(argv[4]); frame.index < frames; frame.index++)
        for (uint32_t i = 0; i < host.pipeline_count; i++) {
            check(dt_gl_record(host.runtimes[i], &frame, NULL), "a frame");
            check_state(state, "a frame");
        }
    for (uint32_t i = 0; i < host.pipeline_count; i++) {
        write_picture(&host, host.pictures[i], argv[5 + i]);
        dt_gl_close(host.runtimes[i]);
    }
    check_state(state, "closing");
    dt_scene_close(scene);
    return messages ? 1 : 0;
}
