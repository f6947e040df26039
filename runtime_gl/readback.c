/* Copies buffers and images to memory and back, tightly packed, row 0 first. Relies on the fixed
 * state of state.c: no row padding, no pixel buffer bound. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

static bool allocate_texels(struct dt_gl_runtime *rt, const char *name, struct dt_bytes *out)
{
    out->data = malloc(out->size ? out->size : 1);
    return out->data || dt_error(&rt->core, "%s: no memory for %zu bytes to read back; free some",
                                 name, out->size);
}

static bool keep_if_read(struct dt_bytes *out, bool ok)
{
    if (!ok) {
        free(out->data);
        *out = (struct dt_bytes){0};
    }
    return ok;
}

static bool read_buffer(struct dt_gl_runtime *rt, const struct gl_buffer *buffer,
                        struct dt_bytes *out)
{
    if (!GL(rt, buffer->name, MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT)) ||
        !allocate_texels(rt, buffer->name, out))
        return keep_if_read(out, false);
    return keep_if_read(
        out, GL(rt, buffer->name,
                GetNamedBufferSubData(buffer->handle, 0, (GLsizeiptr)out->size, out->data)));
}

static bool read_image(struct dt_gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                       struct dt_bytes *out)
{
    const struct gl_format *f = gl_format(image->format);
    size_t layer_size = out->size / out->extent[2];
    if (layer_size > INT32_MAX) /* OpenGL counts the bytes of a layer in an int */
        return keep_if_read(out,
                            dt_error(&rt->core,
                                     "image %s: a layer of %zu bytes is too large to read back; "
                                     "choose a smaller frame",
                                     image->name, layer_size));
    if (!GL(rt, image->name, MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT)) ||
        !allocate_texels(rt, image->name, out))
        return keep_if_read(out, false);
    for (uint32_t layer = 0; layer < out->extent[2]; layer++)
        if (!GL(rt, image->name,
                GetTextureSubImage(image->handle, (GLint)mip, 0, 0, (GLint)layer,
                                   (GLsizei)out->extent[0], (GLsizei)out->extent[1], 1, f->format,
                                   f->type, (GLsizei)layer_size, out->data + layer * layer_size)))
            return keep_if_read(out, false);
    return true;
}

static bool write_buffer(struct dt_gl_runtime *rt, const struct gl_buffer *buffer,
                         const struct dt_bytes *bytes)
{
    return GL(rt, buffer->name, MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT)) &&
           gl_buffer_write(rt, buffer, bytes->data, bytes->size);
}

static bool write_image(struct dt_gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                        const struct dt_bytes *bytes)
{
    const struct gl_format *f = gl_format(image->format);
    GLsizei width = (GLsizei)bytes->extent[0], height = (GLsizei)bytes->extent[1];
    GLsizei layers = (GLsizei)bytes->extent[2];
    if (!GL(rt, image->name, MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT)))
        return false;
    if (!image->layered)
        return GL(rt, image->name,
                  TextureSubImage2D(image->handle, (GLint)mip, 0, 0, width, height, f->format,
                                    f->type, bytes->data));
    return GL(rt, image->name,
              TextureSubImage3D(image->handle, (GLint)mip, 0, 0, 0, width, height, layers,
                                f->format, f->type, bytes->data));
}

static bool resource_is_image(const struct dt_core *core, uint32_t resource)
{
    return core->pipeline->resources[resource].kind == DT_IMAGE;
}

bool gl_read(struct dt_core *core, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)core;
    return resource_is_image(core, resource) ? read_image(rt, gl_image_of(rt, resource), mip, out)
                                             : read_buffer(rt, gl_buffer_of(rt, resource), out);
}

bool gl_write(struct dt_core *core, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)core;
    return resource_is_image(core, resource)
               ? write_image(rt, gl_image_of(rt, resource), mip, bytes)
               : write_buffer(rt, gl_buffer_of(rt, resource), bytes);
}
