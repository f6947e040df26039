/* See renderer_gl.h. */
#include "renderer_gl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

enum { STATE_SIZE = 256 };

static int messages; /* of KHR_debug */
static GLint state[STATE_SIZE];

void check(bool good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "host: %s failed\n", what);
    exit(1);
}

/* ---- Context --------------------------------------------------------------------------------- */

static void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                GLsizei length, const GLchar *message, const void *user)
{
    (void)source, (void)id, (void)length, (void)user;
    if (severity == GL_DEBUG_SEVERITY_NOTIFICATION || type == GL_DEBUG_TYPE_PERFORMANCE)
        return;
    fprintf(stderr, "debug: %s\n", message);
    messages++;
}

void renderer_open(void)
{
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 getenv("HOST_DEBUG") != NULL,
                                 EGL_NONE};
    EGLDisplay display =
        eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    check(eglInitialize(display, NULL, NULL) && eglBindAPI(EGL_OPENGL_API), "EGL");
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    check(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context), "OpenGL 4.5");
    if (getenv("HOST_DEBUG")) {
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glDebugMessageCallback(on_message, NULL);
    }
}

bool renderer_is_silent(void)
{
    return messages == 0;
}

/* ---- Buffers and textures -------------------------------------------------------------------- */

GLuint make_buffer(const void *data, size_t size)
{
    GLuint buffer;
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, (GLsizeiptr)size, data, 0);
    return buffer;
}

GLuint make_texture(GLenum format, uint32_t width, uint32_t height)
{
    GLuint texture;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, (GLsizei)width, (GLsizei)height);
    return texture;
}

/* Row 0 in memory is the bottom of the picture. */
void write_texture(GLuint texture, uint32_t width, uint32_t height, const char *path)
{
    size_t size = (size_t)width * height * 4;
    unsigned char *pixels = malloc(size);
    FILE *file = fopen(path, "wb");
    check(file && pixels, path);
    glGetTextureImage(texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, (GLsizei)size, pixels);
    fprintf(file, "P6\n%u %u\n255\n", width, height);
    for (uint32_t y = height; y-- > 0;)
        for (uint32_t x = 0; x < width; x++)
            fwrite(pixels + ((size_t)y * width + x) * 4, 1, 3, file);
    check(fclose(file) == 0, path);
    free(pixels);
}

/* ---- State ----------------------------------------------------------------------------------- */

/* What others may have touched, as numbers; returns how many. */
static size_t read_state(GLint out[STATE_SIZE])
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
        GL_LINE_SMOOTH,
        GL_POINT_SPRITE_COORD_ORIGIN,
        GL_POLYGON_OFFSET_FACTOR,
        GL_POLYGON_OFFSET_FILL,
        GL_POLYGON_OFFSET_UNITS,
        GL_PRIMITIVE_RESTART,
        GL_PROGRAM_POINT_SIZE,
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
    memset(out, 0, STATE_SIZE * sizeof *out);
    for (size_t i = 0; i < COUNT(plain); i++)
        glGetIntegerv(plain[i], &out[count++]);
    for (size_t i = 0; i < COUNT(indexed); i++)
        for (GLuint k = 0; k < 8; k++)
            glGetIntegeri_v(indexed[i], k, &out[count++]);
    glGetIntegeri_v(GL_COLOR_WRITEMASK, 0, &out[count]);
    glGetIntegeri_v(GL_VIEWPORT, 0, &out[count + 4]);
    glGetIntegerv(GL_POLYGON_MODE, &out[count + 8]);
    for (GLuint k = 0; k < 4; k++) {
        GLint64 start = 0;
        glGetInteger64i_v(GL_UNIFORM_BUFFER_START, k, &start);
        out[count + 10 + k] = (GLint)start;
        glGetInteger64i_v(GL_SHADER_STORAGE_BUFFER_START, k, &start);
        out[count + 14 + k] = (GLint)start;
    }
    glGetIntegeri_v(GL_SCISSOR_BOX, 0, &out[count + 18]);
    return count + 22;
}

void make_disorder(void)
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
    glPolygonOffset(3, 5);
    glScissor(1, 2, 3, 4);
    for (size_t i = 0; i < COUNT(switches); i++)
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
    read_state(state);
}

void check_state(const char *after)
{
    GLint now[STATE_SIZE];
    size_t count = read_state(now);
    check(glGetError() == GL_NO_ERROR, "OpenGL");
    for (size_t i = 0; i < count; i++)
        if (now[i] != state[i]) {
            fprintf(stderr, "host: %s changed state %zu from 0x%x to 0x%x\n", after, i,
                    (unsigned)state[i], (unsigned)now[i]);
            exit(1);
        }
}
