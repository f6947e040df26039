/* Buffers, images, samplers and framebuffers: made at resize by generated code, destroyed by it;
 * the tables that translate dt_format. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

static const struct gl_format formats[DT_FORMAT_COUNT] = {
    [DT_FORMAT_R8] = {"r8", GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1},
    [DT_FORMAT_RG8] = {"rg8", GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2},
    [DT_FORMAT_RGBA8] = {"rgba8", GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    [DT_FORMAT_RGBA8_SRGB] = {"rgba8_srgb", GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    [DT_FORMAT_R16F] = {"r16f", GL_R16F, GL_RED, GL_HALF_FLOAT, 2},
    [DT_FORMAT_RG16F] = {"rg16f", GL_RG16F, GL_RG, GL_HALF_FLOAT, 4},
    [DT_FORMAT_RGBA16F] = {"rgba16f", GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8},
    [DT_FORMAT_R32F] = {"r32f", GL_R32F, GL_RED, GL_FLOAT, 4},
    [DT_FORMAT_RG32F] = {"rg32f", GL_RG32F, GL_RG, GL_FLOAT, 8},
    [DT_FORMAT_RGBA32F] = {"rgba32f", GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
    [DT_FORMAT_R32UI] = {"r32ui", GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
    [DT_FORMAT_RG32UI] = {"rg32ui", GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 8},
    [DT_FORMAT_RGBA32UI] = {"rgba32ui", GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16},
    [DT_FORMAT_R32I] = {"r32i", GL_R32I, GL_RED_INTEGER, GL_INT, 4},
    [DT_FORMAT_D32F] = {"d32f", GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4},
};

const struct gl_format *gl_format(enum dt_format format)
{
    return &formats[format];
}

bool gl_depth(const struct gl_image *image)
{
    return image->texel == DT_FORMAT_D32F;
}

/* ---- Buffers --------------------------------------------------------------------------------- */

bool gl_buffer_upload(struct gl_runtime *rt, struct gl_buffer *buffer,
                      const struct gl_buffer_info *info, const void *data)
{
    GLsizeiptr size = info->size < 16 ? 16 : info->size;
    if (info->size < 0 || size > rt->limits.storage_size) {
        gl_log(rt, DT_ERROR,
               "buffer %s: %lld bytes, and %s allows %lld in one buffer: make it smaller",
               info->name, (long long)info->size, rt->device_name,
               (long long)rt->limits.storage_size);
        return false;
    }
    *buffer = (struct gl_buffer){
        .name = info->name, .size = size, .block = info->block > size ? info->block : 0};
    size = buffer->block ? buffer->block : size;
    bool exact = size == info->size; /* raised sizes reach beyond the data */
    return GL(rt, info->name, CreateBuffers(1, &buffer->handle)) &&
           GL(rt, info->name,
              NamedBufferStorage(buffer->handle, size, exact ? data : NULL,
                                 GL_DYNAMIC_STORAGE_BIT)) &&
           (exact || !data || gl_buffer_write(rt, buffer, data, (size_t)info->size));
}

bool dt_gl_buffer_create(struct gl_runtime *rt, struct gl_buffer *buffer,
                         const struct gl_buffer_info *info)
{
    return gl_buffer_upload(rt, buffer, info, NULL);
}

bool gl_buffer_write(struct gl_runtime *rt, const struct gl_buffer *buffer, const void *data,
                     size_t size)
{
    return !size ||
           GL(rt, buffer->name, NamedBufferSubData(buffer->handle, 0, (GLsizeiptr)size, data));
}

void dt_gl_buffer_destroy(struct gl_runtime *rt, struct gl_buffer *buffer)
{
    if (buffer->handle && !buffer->imported)
        rt->gl.DeleteBuffers(1, &buffer->handle);
    *buffer = (struct gl_buffer){0};
}

/* ---- Images ---------------------------------------------------------------------------------- */

static uint32_t full_mips(uint32_t width, uint32_t height)
{
    uint32_t mips = 1;
    for (uint32_t size = width > height ? width : height; size > 1; size /= 2)
        mips++;
    return mips;
}

static bool check_image(struct gl_runtime *rt, const struct gl_image_info *info)
{
    uint32_t side = (uint32_t)rt->limits.texture_size;
    uint32_t layers = info->layered ? (uint32_t)rt->limits.texture_layers : 1;
    if (info->width < 1 || info->height < 1 || info->width > side || info->height > side) {
        gl_log(rt, DT_ERROR,
               "image %s: %ux%u texels, and %s allows 1x1 to %ux%u: choose another size",
               info->name, info->width, info->height, rt->device_name, side, side);
        return false;
    }
    if (info->layers < 1 || info->layers > layers) {
        gl_log(rt, DT_ERROR,
               "image %s: %u layers, and %s allows 1 to %u here: choose another number", info->name,
               info->layers, rt->device_name, layers);
        return false;
    }
    if (info->mips < 1 || info->mips > full_mips(info->width, info->height)) {
        gl_log(rt, DT_ERROR, "image %s: %u mips, and %ux%u texels have 1 to %u", info->name,
               info->mips, info->width, info->height, full_mips(info->width, info->height));
        return false;
    }
    return true;
}

static bool can_share(const struct gl_image *image, const struct gl_image *owner)
{
    return image->texel == owner->texel && image->width == owner->width &&
           image->height == owner->height && image->layers == owner->layers &&
           image->mips == owner->mips && image->layered == owner->layered;
}

static bool share_image(struct gl_runtime *rt, struct gl_image *image, const struct gl_image *owner)
{
    if (!can_share(image, owner)) {
        gl_log(rt, DT_ERROR, "image %s cannot share the texture of %s: format or size differ",
               image->name, owner->name);
        return false;
    }
    image->handle = owner->handle;
    image->borrowed = true;
    return true;
}

static const struct gl_import *find_import(const struct gl_runtime *rt, const char *name)
{
    for (uint32_t i = 0; i < rt->import_count; i++)
        if (strcmp(rt->imports[i].name, name) == 0)
            return &rt->imports[i];
    return NULL;
}

/* A host's texture takes the place of one that would have been made. */
static bool adopt_image(struct gl_runtime *rt, const struct gl_import *import,
                        struct gl_image *image)
{
    GLint width = 0, height = 0, depth = 0, format = 0, levels = 0, target = 0;
    GLuint texture = import->texture;
    const char *name = import->name;
    if (!GL(rt, name, GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target)) ||
        !GL(rt, name, GetTextureParameteriv(texture, GL_TEXTURE_IMMUTABLE_LEVELS, &levels)) ||
        !GL(rt, name, GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width)) ||
        !GL(rt, name, GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_HEIGHT, &height)) ||
        !GL(rt, name, GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_DEPTH, &depth)) ||
        !GL(rt, name, GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_INTERNAL_FORMAT, &format)))
        return false;
    if ((GLenum)target != image->target || (GLenum)format != image->format ||
        (uint32_t)width != image->width || (uint32_t)height != image->height ||
        (uint32_t)depth != image->layers || (uint32_t)levels != image->mips) {
        gl_log(
            rt, DT_ERROR,
            "image %s: imported a texture of target 0x%x, format 0x%x, %dx%d texels, %d layers, %d "
            "immutable levels, but the pipeline has 0x%x, 0x%x, %ux%u, %u, %u; import one like "
            "that",
            name, (unsigned)target, (unsigned)format, width, height, depth, levels, image->target,
            image->format, image->width, image->height, image->layers, image->mips);
        return false;
    }
    image->handle = texture;
    image->imported = true;
    return true;
}

bool dt_gl_image_create(struct gl_runtime *rt, struct gl_image *image,
                        const struct gl_image_info *info)
{
    if (!check_image(rt, info))
        return false;
    const char *name = info->name;
    *image = (struct gl_image){
        .name = name,
        .target = info->layered ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D,
        .format = gl_format(info->format)->internal,
        .texel = info->format,
        .width = info->width,
        .height = info->height,
        .layers = info->layers,
        .mips = info->mips,
        .layered = info->layered,
    };
    const struct gl_import *import = find_import(rt, name);
    if (import)
        return adopt_image(rt, import, image);
    if (info->share &&
        !info->share->imported) /* what a host gave is written by its own passes only */
        return share_image(rt, image, info->share);
    GLsizei width = (GLsizei)info->width, height = (GLsizei)info->height;
    GLsizei layers = (GLsizei)info->layers, mips = (GLsizei)info->mips;
    if (!GL(rt, name, CreateTextures(image->target, 1, &image->handle)))
        return false;
    if (info->layered)
        return GL(rt, name,
                  TextureStorage3D(image->handle, mips, image->format, width, height, layers));
    return GL(rt, name, TextureStorage2D(image->handle, mips, image->format, width, height));
}

void dt_gl_image_destroy(struct gl_runtime *rt, struct gl_image *image)
{
    if (image->handle && !image->borrowed && !image->imported)
        rt->gl.DeleteTextures(1, &image->handle);
    *image = (struct gl_image){0};
}

/* ---- First content --------------------------------------------------------------------------- */

/* The byte that fills an image. A depth image takes values of 0..1 only: zero where four such
 * bytes are another float. */
static int image_byte(const struct gl_image *image, int byte)
{
    float value;
    memset(&value, byte, sizeof value);
    return gl_depth(image) && !(value >= 0.0f && value <= 1.0f) ? 0 : byte;
}

/* One mip, layer by layer, from `texels` of one layer. Texels are given as bytes, not as a clear
 * colour, because a colour is converted and a NaN would not arrive as it left. */
static bool fill_mip(struct gl_runtime *rt, const struct gl_image *image, GLint mip,
                     const void *texels)
{
    const struct gl_format *f = gl_format(image->texel);
    GLsizei width = (GLsizei)(image->width >> mip), height = (GLsizei)(image->height >> mip);
    width = width < 1 ? 1 : width;
    height = height < 1 ? 1 : height;
    if (!image->layered)
        return GL(
            rt, image->name,
            TextureSubImage2D(image->handle, mip, 0, 0, width, height, f->format, f->type, texels));
    for (GLint layer = 0; layer < (GLint)image->layers; layer++)
        if (!GL(rt, image->name,
                TextureSubImage3D(image->handle, mip, 0, 0, layer, width, height, 1, f->format,
                                  f->type, texels)))
            return false;
    return true;
}

static bool fill_image(struct gl_runtime *rt, const struct gl_image *image, int byte)
{
    size_t size = (size_t)image->width * image->height * gl_format(image->texel)->bytes;
    void *texels = malloc(size);
    if (!texels) {
        gl_log(rt, DT_ERROR, "image %s: no memory for %zu bytes of first content", image->name,
               size);
        return false;
    }
    memset(texels, image_byte(image, byte), size);
    bool ok = true;
    for (uint32_t mip = 0; ok && mip < image->mips; mip++)
        ok = fill_mip(rt, image, (GLint)mip, texels);
    free(texels);
    return ok;
}

static bool fill_buffer(struct gl_runtime *rt, const struct gl_buffer *buffer, int byte)
{
    GLubyte value = (GLubyte)byte;
    return GL(
        rt, buffer->name,
        ClearNamedBufferData(buffer->handle, GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, &value));
}

bool dt_gl_initialise(struct gl_runtime *rt, struct gl_buffer *buffer, struct gl_image *image,
                      bool history)
{
    if (!history && !rt->options.poison)
        return true;
    if (image && image->imported)
        return true;
    int byte = history ? 0 : rt->options.poison;
    return image ? fill_image(rt, image, byte) : fill_buffer(rt, buffer, byte);
}

/* ---- Samplers -------------------------------------------------------------------------------- */

bool dt_gl_sampler_create(struct gl_runtime *rt, GLuint *sampler,
                          const struct gl_sampler_info *info)
{
    const char *name = info->name;
    bool linear = info->filter == GL_LINEAR, trilinear = info->mip_filter == GL_LINEAR;
    GLenum minify = linear ? (trilinear ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_NEAREST)
                           : (trilinear ? GL_NEAREST_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_NEAREST);
    if (info->anisotropy > rt->limits.anisotropy) {
        gl_log(rt, DT_ERROR, "sampler %s: anisotropy %g, and %s allows up to %g", name,
               (double)info->anisotropy, rt->device_name, (double)rt->limits.anisotropy);
        return false;
    }
    if (!GL(rt, name, CreateSamplers(1, sampler)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_MAG_FILTER, (GLint)info->filter)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_MIN_FILTER, (GLint)minify)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_WRAP_S, (GLint)info->wrap)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_WRAP_T, (GLint)info->wrap)) ||
        !GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_WRAP_R, (GLint)info->wrap)))
        return false;
    if (info->anisotropy > 1.0f &&
        !GL(rt, name, SamplerParameterf(*sampler, GL_TEXTURE_MAX_ANISOTROPY, info->anisotropy)))
        return false;
    return !info->compare ||
           (GL(rt, name,
               SamplerParameteri(*sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE)) &&
            GL(rt, name, SamplerParameteri(*sampler, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL)));
}

void dt_gl_sampler_destroy(struct gl_runtime *rt, GLuint *sampler)
{
    if (*sampler)
        rt->gl.DeleteSamplers(1, sampler);
    *sampler = 0;
}

/* ---- Framebuffers ---------------------------------------------------------------------------- */

static bool attach(struct gl_runtime *rt, GLuint framebuffer, GLenum point,
                   const struct gl_target *target, uint32_t layers)
{
    const struct gl_image *image = target->image;
    GLint mip = (GLint)target->mip;
    if (target->mip >= image->mips || layers > image->layers) {
        gl_log(rt, DT_ERROR,
               "image %s: mip %u, %u layers to be drawn to, and it has %u mips, %u layers",
               image->name, target->mip, layers, image->mips, image->layers);
        return false;
    }
    if (image->layered && layers == 1)
        return GL(rt, image->name,
                  NamedFramebufferTextureLayer(framebuffer, point, image->handle, mip, 0));
    return GL(rt, image->name, NamedFramebufferTexture(framebuffer, point, image->handle, mip));
}

static const char *status_text(GLenum status)
{
    switch (status) {
    case GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT:
        return "an attachment has a format that cannot be drawn to";
    case GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT:
        return "nothing is attached";
    case GL_FRAMEBUFFER_INCOMPLETE_LAYER_TARGETS:
        return "layered and single images are mixed";
    case GL_FRAMEBUFFER_UNSUPPORTED:
        return "the driver does not support this combination of formats";
    default:
        return "incomplete";
    }
}

static const struct gl_image *first_image(const struct gl_targets *targets)
{
    return targets->color_count ? targets->color[0].image : targets->depth.image;
}

static bool check_targets(struct gl_runtime *rt, const struct gl_targets *targets)
{
    const struct gl_image *first = first_image(targets);
    const struct gl_limits *l = &rt->limits;
    if (!first) {
        gl_log(rt, DT_ERROR, "a pass draws into no image: give it a colour or a depth target");
        return false;
    }
    uint32_t count =
        (uint32_t)(l->color_targets < l->draw_buffers ? l->color_targets : l->draw_buffers);
    if (targets->color_count > count || targets->color_count > GL_MAX_COLOR_TARGETS) {
        gl_log(rt, DT_ERROR,
               "a pass draws into %s and %u images more, and %s allows %u colour targets",
               first->name, targets->color_count - 1, rt->device_name, count);
        return false;
    }
    if (first->width > (uint32_t)l->viewport[0] || first->height > (uint32_t)l->viewport[1]) {
        gl_log(rt, DT_ERROR, "image %s: %ux%u texels, and %s draws into at most %dx%d", first->name,
               first->width, first->height, rt->device_name, l->viewport[0], l->viewport[1]);
        return false;
    }
    return true;
}

bool dt_gl_framebuffer_create(struct gl_runtime *rt, GLuint *framebuffer,
                              const struct gl_targets *targets)
{
    if (!check_targets(rt, targets))
        return false;
    const char *name = first_image(targets)->name;
    if (!GL(rt, name, CreateFramebuffers(1, framebuffer)))
        return false;
    GLenum buffers[GL_MAX_COLOR_TARGETS] = {GL_NONE};
    for (uint32_t i = 0; i < targets->color_count; i++) {
        buffers[i] = GL_COLOR_ATTACHMENT0 + i;
        if (!attach(rt, *framebuffer, buffers[i], &targets->color[i], targets->layers))
            return false;
    }
    if (targets->depth.image &&
        !attach(rt, *framebuffer, GL_DEPTH_ATTACHMENT, &targets->depth, targets->layers))
        return false;
    GLsizei count = targets->color_count ? (GLsizei)targets->color_count : 1;
    if (!GL(rt, name, NamedFramebufferDrawBuffers(*framebuffer, count, buffers)))
        return false;
    GLenum status = rt->gl.CheckNamedFramebufferStatus(*framebuffer, GL_DRAW_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        gl_log(rt, DT_ERROR, "framebuffer of %s: %s", name, status_text(status));
    return status == GL_FRAMEBUFFER_COMPLETE;
}

void dt_gl_framebuffer_destroy(struct gl_runtime *rt, GLuint *framebuffer)
{
    if (*framebuffer)
        rt->gl.DeleteFramebuffers(1, framebuffer);
    *framebuffer = 0;
}
