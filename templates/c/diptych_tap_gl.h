/* Reads textures, renderbuffers and buffers of OpenGL 3.3 or later into a tap; see diptych_tap.h. Include it behind
 * your loader of OpenGL: it calls gl functions by name.
 *
 *     tap_gl_texture(tap, "lighting", "radiance", GL_TEXTURE_2D, texture, 0);
 *     tap_gl_buffer(tap, "cull", "draws", buffer, 0, count, sizeof(struct draw), fields, 3);
 *
 * Call it after the pass. It waits for the GPU, and leaves the context's state as it was. Row 0 is the bottom, unless
 * you render upside down: then set tap_gl_origin. Writes of shaders must be visible: it calls glMemoryBarrier
 * in contexts that have it (4.2; GL_ALL_BARRIER_BITS is defined). */
#ifndef DIPTYCH_TAP_GL_H
#define DIPTYCH_TAP_GL_H

#include "diptych_tap.h"

static enum tap_origin tap_gl_origin = TAP_BOTTOM;

struct tap_gl_format {
    GLint internal;
    const char *name;
    GLenum format, type;
};

/* Formats without alpha are read with it; 24-bit and 16-bit depth as floats. */
TAP_FUNCTION const struct tap_gl_format *tap_gl_find(GLint internal)
{
    static const struct tap_gl_format formats[] = {
        {GL_R8, "r8", GL_RED, GL_UNSIGNED_BYTE},
        {GL_RG8, "rg8", GL_RG, GL_UNSIGNED_BYTE},
        {GL_RGB8, "rgba8", GL_RGBA, GL_UNSIGNED_BYTE},
        {GL_RGBA8, "rgba8", GL_RGBA, GL_UNSIGNED_BYTE},
        {GL_SRGB8, "rgba8_srgb", GL_RGBA, GL_UNSIGNED_BYTE},
        {GL_SRGB8_ALPHA8, "rgba8_srgb", GL_RGBA, GL_UNSIGNED_BYTE},
        {GL_R16, "r16", GL_RED, GL_UNSIGNED_SHORT},
        {GL_RG16, "rg16", GL_RG, GL_UNSIGNED_SHORT},
        {GL_RGBA16, "rgba16", GL_RGBA, GL_UNSIGNED_SHORT},
        {GL_R16_SNORM, "r16_snorm", GL_RED, GL_SHORT},
        {GL_RG16_SNORM, "rg16_snorm", GL_RG, GL_SHORT},
        {GL_RGBA16_SNORM, "rgba16_snorm", GL_RGBA, GL_SHORT},
        {GL_R16F, "r16f", GL_RED, GL_HALF_FLOAT},
        {GL_RG16F, "rg16f", GL_RG, GL_HALF_FLOAT},
        {GL_RGB16F, "rgba16f", GL_RGBA, GL_HALF_FLOAT},
        {GL_RGBA16F, "rgba16f", GL_RGBA, GL_HALF_FLOAT},
        {GL_R32F, "r32f", GL_RED, GL_FLOAT},
        {GL_RG32F, "rg32f", GL_RG, GL_FLOAT},
        {GL_RGB32F, "rgba32f", GL_RGBA, GL_FLOAT},
        {GL_RGBA32F, "rgba32f", GL_RGBA, GL_FLOAT},
        {GL_R8UI, "r8ui", GL_RED_INTEGER, GL_UNSIGNED_BYTE},
        {GL_RG8UI, "rg8ui", GL_RG_INTEGER, GL_UNSIGNED_BYTE},
        {GL_RGBA8UI, "rgba8ui", GL_RGBA_INTEGER, GL_UNSIGNED_BYTE},
        {GL_R8I, "r8i", GL_RED_INTEGER, GL_BYTE},
        {GL_RG8I, "rg8i", GL_RG_INTEGER, GL_BYTE},
        {GL_RGBA8I, "rgba8i", GL_RGBA_INTEGER, GL_BYTE},
        {GL_R16UI, "r16ui", GL_RED_INTEGER, GL_UNSIGNED_SHORT},
        {GL_RG16UI, "rg16ui", GL_RG_INTEGER, GL_UNSIGNED_SHORT},
        {GL_RGBA16UI, "rgba16ui", GL_RGBA_INTEGER, GL_UNSIGNED_SHORT},
        {GL_R16I, "r16i", GL_RED_INTEGER, GL_SHORT},
        {GL_RG16I, "rg16i", GL_RG_INTEGER, GL_SHORT},
        {GL_RGBA16I, "rgba16i", GL_RGBA_INTEGER, GL_SHORT},
        {GL_R32UI, "r32ui", GL_RED_INTEGER, GL_UNSIGNED_INT},
        {GL_RG32UI, "rg32ui", GL_RG_INTEGER, GL_UNSIGNED_INT},
        {GL_RGBA32UI, "rgba32ui", GL_RGBA_INTEGER, GL_UNSIGNED_INT},
        {GL_R32I, "r32i", GL_RED_INTEGER, GL_INT},
        {GL_RG32I, "rg32i", GL_RG_INTEGER, GL_INT},
        {GL_RGBA32I, "rgba32i", GL_RGBA_INTEGER, GL_INT},
        {GL_R11F_G11F_B10F, "r11g11b10f", GL_RGB, GL_UNSIGNED_INT_10F_11F_11F_REV},
        {GL_RGB10_A2, "rgb10a2", GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV},
        {GL_DEPTH_COMPONENT16, "d32f", GL_DEPTH_COMPONENT, GL_FLOAT},
        {GL_DEPTH_COMPONENT24, "d32f", GL_DEPTH_COMPONENT, GL_FLOAT},
        {GL_DEPTH24_STENCIL8, "d32f", GL_DEPTH_COMPONENT, GL_FLOAT},
        {GL_DEPTH_COMPONENT32F, "d32f", GL_DEPTH_COMPONENT, GL_FLOAT},
        {GL_DEPTH32F_STENCIL8, "d32f", GL_DEPTH_COMPONENT, GL_FLOAT}};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i].internal == internal)
            return &formats[i];
    return NULL;
}

/* How memory is laid out when texels are read, saved and restored. */
struct tap_gl_pack {
    GLint values[7], buffer;
};

TAP_FUNCTION GLenum tap_gl_pack_name(int i)
{
    static const GLenum names[7] = {GL_PACK_SWAP_BYTES,   GL_PACK_LSB_FIRST, GL_PACK_ROW_LENGTH,
                                    GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS,
                                    GL_PACK_ALIGNMENT};
    return names[i];
}

TAP_FUNCTION void tap_gl_barrier(void)
{
#ifdef GL_ALL_BARRIER_BITS
    GLint major = 0, minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    if (major > 4 || (major == 4 && minor >= 2))
        glMemoryBarrier(GL_ALL_BARRIER_BITS);
#endif
}

TAP_FUNCTION void tap_gl_pack_begin(struct tap_gl_pack *pack)
{
    tap_gl_barrier();
    glGetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &pack->buffer);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    for (int i = 0; i < 7; i++) {
        glGetIntegerv(tap_gl_pack_name(i), &pack->values[i]);
        glPixelStorei(tap_gl_pack_name(i), i == 6);
    }
}

TAP_FUNCTION void tap_gl_pack_end(const struct tap_gl_pack *pack)
{
    for (int i = 0; i < 7; i++)
        glPixelStorei(tap_gl_pack_name(i), pack->values[i]);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, (GLuint)pack->buffer);
}

TAP_FUNCTION GLenum tap_gl_binding(GLenum target)
{
    return target == GL_TEXTURE_2D          ? GL_TEXTURE_BINDING_2D
           : target == GL_TEXTURE_2D_ARRAY  ? GL_TEXTURE_BINDING_2D_ARRAY
           : target == GL_TEXTURE_3D        ? GL_TEXTURE_BINDING_3D
           : target == GL_TEXTURE_CUBE_MAP  ? GL_TEXTURE_BINDING_CUBE_MAP
           : target == GL_TEXTURE_RECTANGLE ? GL_TEXTURE_BINDING_RECTANGLE
                                            : 0;
}

/* Reads all layers or faces of the bound texture into memory of that size. */
TAP_FUNCTION void tap_gl_read(GLenum target, GLint mip, const struct tap_gl_format *format,
                              void *bytes, size_t face)
{
    int faces = target == GL_TEXTURE_CUBE_MAP ? 6 : 1;
    for (int i = 0; i < faces; i++)
        glGetTexImage(faces == 6 ? GL_TEXTURE_CUBE_MAP_POSITIVE_X + (GLenum)i : target, mip,
                      format->format, format->type, (char *)bytes + (size_t)i * face);
}

/* One mip of a texture: GL_TEXTURE_2D, _2D_ARRAY, _3D, _CUBE_MAP or _RECTANGLE. */
TAP_FUNCTION void tap_gl_texture(struct tap *tap, const char *pass, const char *resource,
                                 GLenum target, GLuint texture, GLint mip)
{
    struct tap_gl_pack pack;
    struct tap_texels texels;
    GLint bound = 0, sizes[3] = {0}, internal = 0;
    GLenum level = target == GL_TEXTURE_CUBE_MAP ? GL_TEXTURE_CUBE_MAP_POSITIVE_X : target;
    if (!tap || tap->failed)
        return;
    if (!tap_gl_binding(target)) {
        tap_fail(tap, "is of a target that tap_gl_texture does not read", resource);
        return;
    }
    glGetIntegerv(tap_gl_binding(target), &bound);
    glBindTexture(target, texture);
    glGetTexLevelParameteriv(level, mip, GL_TEXTURE_WIDTH, &sizes[0]);
    glGetTexLevelParameteriv(level, mip, GL_TEXTURE_HEIGHT, &sizes[1]);
    glGetTexLevelParameteriv(level, mip, GL_TEXTURE_DEPTH, &sizes[2]);
    glGetTexLevelParameteriv(level, mip, GL_TEXTURE_INTERNAL_FORMAT, &internal);
    const struct tap_gl_format *format = tap_gl_find(internal);
    memset(&texels, 0, sizeof texels);
    texels.width = (unsigned)sizes[0];
    texels.height = (unsigned)sizes[1];
    texels.layers = target == GL_TEXTURE_CUBE_MAP ? 6 : (unsigned)sizes[2];
    texels.mip = (unsigned)mip;
    texels.origin = tap_gl_origin;
    if (format) {
        size_t face = tap_texel_size(format->name) * texels.width * texels.height;
        void *bytes = malloc(face * (texels.layers ? texels.layers : 1) + 1);
        texels.format = format->name;
        texels.bytes = bytes;
        tap_gl_pack_begin(&pack);
        if (bytes)
            tap_gl_read(target, mip, format, bytes, face);
        tap_gl_pack_end(&pack);
        if (bytes)
            tap_image(tap, pass, resource, &texels);
        else
            tap_fail(tap, "out of memory", resource);
        free(bytes);
    } else {
        tap_fail(tap, "has an internal format that tap_gl_texture does not know", resource);
    }
    glBindTexture(target, (GLuint)bound);
}

/* What is attached to a framebuffer, 0 for the window's: GL_COLOR_ATTACHMENT0 and so on, GL_BACK, or
 * GL_DEPTH_ATTACHMENT. Not multisampled. `internal` is its format, such as GL_RGBA8. */
TAP_FUNCTION void tap_gl_framebuffer(struct tap *tap, const char *pass, const char *resource,
                                     GLuint framebuffer, GLenum attachment, GLint internal,
                                     unsigned width, unsigned height)
{
    const struct tap_gl_format *format = tap_gl_find(internal);
    struct tap_gl_pack pack;
    struct tap_texels texels;
    GLint bound = 0, buffer = 0;
    if (!tap || tap->failed)
        return;
    void *bytes = format ? malloc(tap_texel_size(format->name) * width * height + 1) : NULL;
    if (!bytes) {
        tap_fail(tap, format ? "out of memory" : "has an unknown internal format", resource);
        return;
    }
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &bound);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glGetIntegerv(GL_READ_BUFFER, &buffer);
    if (format->format != GL_DEPTH_COMPONENT)
        glReadBuffer(attachment);
    tap_gl_pack_begin(&pack);
    glReadPixels(0, 0, (GLsizei)width, (GLsizei)height, format->format, format->type, bytes);
    tap_gl_pack_end(&pack);
    if (format->format != GL_DEPTH_COMPONENT)
        glReadBuffer((GLenum)buffer);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)bound);
    memset(&texels, 0, sizeof texels);
    texels.format = format->name;
    texels.width = width;
    texels.height = height;
    texels.origin = tap_gl_origin;
    texels.bytes = bytes;
    tap_image(tap, pass, resource, &texels);
    free(bytes);
}

/* The same of a renderbuffer. */
TAP_FUNCTION void tap_gl_renderbuffer(struct tap *tap, const char *pass, const char *resource,
                                      GLuint renderbuffer)
{
    GLint bound = 0, read = 0, sizes[2] = {0}, internal = 0;
    GLuint framebuffer = 0;
    if (!tap || tap->failed)
        return;
    glGetIntegerv(GL_RENDERBUFFER_BINDING, &bound);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read);
    glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    glGetRenderbufferParameteriv(GL_RENDERBUFFER, GL_RENDERBUFFER_WIDTH, &sizes[0]);
    glGetRenderbufferParameteriv(GL_RENDERBUFFER, GL_RENDERBUFFER_HEIGHT, &sizes[1]);
    glGetRenderbufferParameteriv(GL_RENDERBUFFER, GL_RENDERBUFFER_INTERNAL_FORMAT, &internal);
    const struct tap_gl_format *format = tap_gl_find(internal);
    GLenum attachment =
        format && format->format == GL_DEPTH_COMPONENT ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0;
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glFramebufferRenderbuffer(GL_READ_FRAMEBUFFER, attachment, GL_RENDERBUFFER, renderbuffer);
    tap_gl_framebuffer(tap, pass, resource, framebuffer, attachment, internal, (unsigned)sizes[0],
                       (unsigned)sizes[1]);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)read);
    glDeleteFramebuffers(1, &framebuffer);
    glBindRenderbuffer(GL_RENDERBUFFER, (GLuint)bound);
}

/* `count` elements of `stride` bytes from `offset` on; fields as tap_buffer takes them. */
TAP_FUNCTION void tap_gl_buffer(struct tap *tap, const char *pass, const char *resource,
                                GLuint buffer, size_t offset, unsigned count, unsigned stride,
                                const struct tap_field *fields, unsigned field_count)
{
    GLint bound = 0, size = 0;
    if (!tap || tap->failed)
        return;
    void *bytes = malloc((size_t)count * stride + 1);
    if (!bytes) {
        tap_fail(tap, "out of memory", resource);
        return;
    }
    tap_gl_barrier();
    glGetIntegerv(GL_COPY_READ_BUFFER_BINDING, &bound);
    glBindBuffer(GL_COPY_READ_BUFFER, buffer);
    glGetBufferParameteriv(GL_COPY_READ_BUFFER, GL_BUFFER_SIZE, &size); /* 2 GiB at most */
    int fits = offset + (size_t)count * stride <= (size_t)size;
    if (fits)
        glGetBufferSubData(GL_COPY_READ_BUFFER, (GLintptr)offset,
                           (GLsizeiptr)((size_t)count * stride), bytes);
    glBindBuffer(GL_COPY_READ_BUFFER, (GLuint)bound);
    if (fits)
        tap_buffer(tap, pass, resource, bytes, count, stride, fields, field_count);
    else
        tap_fail(tap, "is smaller than its elements", resource);
    free(bytes);
}

#endif
