/* Buffers, images, samplers, and the table that translates dt_format. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

const struct gl_format *gl_format(enum dt_format format)
{
    static const struct gl_format formats[] = {
#define DT_FORMAT(ENUMERATOR, name, channels, bytes, kind, qualifier, vulkan, ...)                 \
    {__VA_ARGS__, bytes},
#include "formats.def"
    };
    return &formats[format];
}

GLenum gl_target(const struct gl_image *image)
{
    switch (image->shape) {
    case DT_SHAPE_3D:
        return GL_TEXTURE_3D;
    case DT_SHAPE_CUBE:
        return GL_TEXTURE_CUBE_MAP;
    case DT_SHAPE_CUBE_ARRAY:
        return GL_TEXTURE_CUBE_MAP_ARRAY;
    case DT_SHAPE_2D:
        break;
    }
    return image->layered ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
}

GLsizei gl_mip_size(uint32_t size, uint32_t mip)
{
    return size >> mip ? (GLsizei)(size >> mip) : 1;
}

/* ---- Buffers --------------------------------------------------------------------------------- */

/* Memory of a small buffer: shaders that read four uints at once stay inside. Bindings have the
 * buffer's own size, from which shaders compute length(). */
enum { LEAST_BYTES = 16 };

bool gl_buffer_create(struct dt_gl_runtime *rt, struct gl_buffer *buffer, const void *data)
{
    const char *name = buffer->name;
    GLsizeiptr whole = buffer->block > buffer->size ? buffer->block : buffer->size;
    whole = whole < LEAST_BYTES ? LEAST_BYTES : whole;
    return GL(rt, name, CreateBuffers(1, &buffer->handle)) &&
           GL(rt, name, NamedBufferStorage(buffer->handle, whole, NULL, GL_DYNAMIC_STORAGE_BIT)) &&
           (!data || gl_buffer_write(rt, buffer, data, (size_t)buffer->size));
}

bool gl_buffer_import(const struct dt_gl_runtime *rt, struct gl_buffer *buffer, const char *name,
                      const struct dt_gl_range *range, uint64_t least)
{
    uint64_t size = range->buffer ? range->size : 0;
    if (!dt_front_range(&rt->core, name, range->offset, size, least, rt->buffer_alignment))
        return false;
    *buffer = (struct gl_buffer){.name = name,
                                 .handle = range->buffer,
                                 .size = (GLsizeiptr)range->size,
                                 .offset = (GLintptr)range->offset,
                                 .imported = true};
    return true;
}

bool gl_buffer_write(struct dt_gl_runtime *rt, const struct gl_buffer *buffer, const void *data,
                     size_t size)
{
    return !size ||
           GL(rt, buffer->name, NamedBufferSubData(buffer->handle, 0, (GLsizeiptr)size, data));
}

bool gl_buffer_fill(struct dt_gl_runtime *rt, const struct gl_buffer *buffer, int byte)
{
    GLuint value = (GLuint)byte * 0x01010101u;
    return GL(rt, buffer->name,
              ClearNamedBufferSubData(buffer->handle, GL_R32UI, buffer->offset, buffer->size,
                                      GL_RED_INTEGER, GL_UNSIGNED_INT, &value));
}

bool gl_buffer_texels(struct dt_gl_runtime *rt, struct gl_buffer *buffer, uint16_t resource)
{
    bool vertices = resource == DT_SCENE_VERTICES;
    return buffer->texels ||
           (dt_front_texels(&rt->core, buffer->name,
                            (uint64_t)buffer->size /
                                (vertices ? DT_VERTEX_TEXEL : DT_INDEX_TEXEL)) &&
            GL(rt, buffer->name, CreateTextures(GL_TEXTURE_BUFFER, 1, &buffer->texels)) &&
            GL(rt, buffer->name,
               TextureBufferRange(buffer->texels, vertices ? GL_RG32UI : GL_R32UI, buffer->handle,
                                  buffer->offset, buffer->size)));
}

void gl_buffer_destroy(struct dt_gl_runtime *rt, struct gl_buffer *buffer)
{
    if (buffer->texels)
        rt->gl.DeleteTextures(1, &buffer->texels);
    if (buffer->handle && !buffer->imported)
        rt->gl.DeleteBuffers(1, &buffer->handle);
    *buffer = (struct gl_buffer){0};
}

/* ---- Images ---------------------------------------------------------------------------------- */

bool gl_image_create(struct dt_gl_runtime *rt, struct gl_image *image)
{
    GLsizei width = (GLsizei)image->width, height = (GLsizei)image->height;
    GLsizei layers = (GLsizei)image->layers, mips = (GLsizei)image->mips;
    GLenum format = gl_format(image->format)->internal;
    const char *name = image->name;
    if (!GL(rt, name, CreateTextures(gl_target(image), 1, &image->handle)))
        return false;
    if (image->layered && image->shape != DT_SHAPE_CUBE)
        return GL(rt, name, TextureStorage3D(image->handle, mips, format, width, height, layers));
    return GL(rt, name, TextureStorage2D(image->handle, mips, format, width, height));
}

bool gl_image_import(struct dt_gl_runtime *rt, struct gl_image *image, GLuint texture)
{
    GLint width = 0, height = 0, depth = 0, format = 0, levels = 0, target = 0;
    GLenum own_target = gl_target(image), own_format = gl_format(image->format)->internal;
    const char *name = image->name;
    if (!GL(rt, name, GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target)) ||
        !GL(rt, name, GetTextureParameteriv(texture, GL_TEXTURE_IMMUTABLE_LEVELS, &levels)) ||
        !GL(rt, name, GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width)) ||
        !GL(rt, name, GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_HEIGHT, &height)) ||
        !GL(rt, name, GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_DEPTH, &depth)) ||
        !GL(rt, name, GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_INTERNAL_FORMAT, &format)))
        return false;
    image->handle = texture;
    image->imported = true;
    if (image->shape == DT_SHAPE_CUBE) /* OpenGL says 1 */
        depth = 6;
    return ((GLenum)target == own_target && (GLenum)format == own_format &&
            (uint32_t)width == image->width && (uint32_t)height == image->height &&
            (uint32_t)depth == image->layers && (uint32_t)levels == image->mips) ||
           dt_error(
               &rt->core,
               "image %s: imported a texture of target 0x%x, format 0x%x, %dx%d texels, %d layers, "
               "%d immutable levels, but the pipeline has 0x%x, 0x%x, %ux%u, %u, %u; import one "
               "like that",
               name, (unsigned)target, (unsigned)format, width, height, depth, levels, own_target,
               own_format, image->width, image->height, image->layers, image->mips);
}

/* Or its depth. */
static uint32_t gl_mip_layers(const struct gl_image *image, uint32_t mip)
{
    return image->shape == DT_SHAPE_3D ? (uint32_t)gl_mip_size(image->layers, mip) : image->layers;
}

bool gl_image_write(struct dt_gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                    uint32_t layer, uint32_t layers, const void *texels)
{
    const struct gl_format *f = gl_format(image->format);
    GLsizei width = gl_mip_size(image->width, mip), height = gl_mip_size(image->height, mip);
    if (!image->layered)
        return GL(rt, image->name,
                  TextureSubImage2D(image->handle, (GLint)mip, 0, 0, width, height, f->format,
                                    f->type, texels));
    return GL(rt, image->name,
              TextureSubImage3D(image->handle, (GLint)mip, 0, 0, (GLint)layer, width, height,
                                (GLsizei)layers, f->format, f->type, texels));
}

bool gl_image_clear(struct dt_gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                    const float clear[4])
{
    const GLuint u[4] = {(GLuint)clear[0], (GLuint)clear[1], (GLuint)clear[2], (GLuint)clear[3]};
    const GLint i[4] = {(GLint)clear[0], (GLint)clear[1], (GLint)clear[2], (GLint)clear[3]};
    GLenum format = image->format == DT_FORMAT_D32F ? GL_DEPTH_COMPONENT : GL_RGBA;
    GLenum type = GL_FLOAT;
    const void *value = clear;
    switch (dt_front_scalar(image->format)) {
    case DT_TYPE_UINT:
        format = GL_RGBA_INTEGER, type = GL_UNSIGNED_INT, value = u;
        break;
    case DT_TYPE_INT:
        format = GL_RGBA_INTEGER, type = GL_INT, value = i;
        break;
    default:
        break;
    }
    return GL(rt, image->name, ClearTexImage(image->handle, (GLint)mip, format, type, value));
}

/* A cube without a sampler is read as an array. */
bool gl_image_view(struct dt_gl_runtime *rt, const struct gl_image *image,
                   const struct dt_binding *binding, GLuint *view)
{
    bool one = binding->one_layer, volume = image->shape == DT_SHAPE_3D;
    bool all = binding->mip == DT_ALL_MIPS;
    bool faces = !volume && image->layered && binding->sampler < 0;
    GLenum target = one ? GL_TEXTURE_2D : faces ? GL_TEXTURE_2D_ARRAY : gl_target(image);
    rt->gl.GenTextures(1, view);
    return GL(rt, image->name,
              TextureView(*view, target, image->handle,
                          binding->codes ? GL_RGBA8 : gl_format(image->format)->internal,
                          all ? 0 : binding->mip, all ? image->mips : 1, one ? binding->layer : 0,
                          one || volume ? 1 : image->layers));
}

void gl_image_destroy(struct dt_gl_runtime *rt, struct gl_image *image)
{
    if (image->handle && !image->borrowed && !image->imported)
        rt->gl.DeleteTextures(1, &image->handle);
    *image = (struct gl_image){0};
}

/* ---- First content --------------------------------------------------------------------------- */

/* The byte to fill an image with. A depth image takes only 0..1: zero if four such bytes are
 * another float. */
static int image_byte(const struct gl_image *image, int byte)
{
    float value;
    memset(&value, byte, sizeof value);
    return image->format == DT_FORMAT_D32F && !(value >= 0.0f && value <= 1.0f) ? 0 : byte;
}

/* Uploads bytes, layer by layer, because OpenGL converts a clear colour and may change a NaN. */
bool gl_image_fill(struct dt_gl_runtime *rt, const struct gl_image *image, int byte)
{
    size_t size = (size_t)image->width * image->height * gl_format(image->format)->bytes;
    void *texels = malloc(size);
    if (!texels)
        return dt_error(&rt->core, "image %s: no memory for %zu bytes of first content; free some",
                        image->name, size);
    memset(texels, image_byte(image, byte), size);
    bool ok = true;
    for (uint32_t mip = 0; mip < image->mips; mip++)
        for (uint32_t layer = 0; ok && layer < gl_mip_layers(image, mip); layer++)
            ok = gl_image_write(rt, image, mip, layer, 1, texels);
    free(texels);
    return ok;
}

/* ---- Samplers -------------------------------------------------------------------------------- */

bool gl_sampler_create(struct dt_core *core, void *made, const struct dt_sampler *info)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    GLuint *sampler = made;
    static const GLint wraps[] = {[DT_WRAP_CLAMP] = GL_CLAMP_TO_EDGE,
                                  [DT_WRAP_REPEAT] = GL_REPEAT,
                                  [DT_WRAP_MIRROR] = GL_MIRRORED_REPEAT,
                                  [DT_WRAP_BORDER] = GL_CLAMP_TO_BORDER};
    static const GLfloat borders[][4] = {[DT_BORDER_TRANSPARENT_BLACK] = {0, 0, 0, 0},
                                         [DT_BORDER_OPAQUE_BLACK] = {0, 0, 0, 1},
                                         [DT_BORDER_OPAQUE_WHITE] = {1, 1, 1, 1}};
    const char *name = info->name;
    GLint magnify = info->linear ? GL_LINEAR : GL_NEAREST, wrap = wraps[info->wrap];
    GLint minify = info->linear
                       ? (info->linear_mip ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_NEAREST)
                       : (info->linear_mip ? GL_NEAREST_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_NEAREST);
    if (!GL(rt, name, CreateSamplers(1, sampler)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_MAG_FILTER, magnify)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_MIN_FILTER, minify)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_WRAP_S, wrap)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_WRAP_T, wrap)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_WRAP_R, wrap)) ||
        !GL(rt, name, SamplerParameterfv(*sampler, GL_TEXTURE_BORDER_COLOR, borders[info->border])))
        return false;
    if (info->anisotropy > 1.0f &&
        !GL(rt, name, SamplerParameterf(*sampler, GL_TEXTURE_MAX_ANISOTROPY, info->anisotropy)))
        return false;
    return !info->compare ||
           (GL(rt, name,
               SamplerParameteri(*sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE)) &&
            GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL)));
}

void gl_sampler_destroy(struct dt_core *core, void *sampler)
{
    gl_runtime_of(core)->gl.DeleteSamplers(1, sampler); /* ignores 0 */
    *(GLuint *)sampler = 0;
}
