/* Copies buffers and images to memory and back, tightly packed, row 0 first. Relies on the fixed
 * state of state.c: no row padding, no pixel buffer bound. */
#include "internal.h"

static bool read_image(struct dt_gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                       struct dt_bytes *out)
{
    const struct gl_format *f = gl_format(image->format);
    size_t layer_size = out->size / out->extent[2];
    if (layer_size > INT32_MAX) /* OpenGL counts the bytes of a layer in an int */
        return dt_error(&rt->core,
                        "image %s: a layer of %zu bytes is too large to read back; "
                        "choose a smaller frame",
                        image->name, layer_size);
    if (!GL(rt, image->name, MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT)))
        return false;
    for (uint32_t layer = 0; layer < out->extent[2]; layer++)
        if (!GL(rt, image->name,
                GetTextureSubImage(image->handle, (GLint)mip, 0, 0, (GLint)layer,
                                   (GLsizei)out->extent[0], (GLsizei)out->extent[1], 1, f->format,
                                   f->type, (GLsizei)layer_size, out->data + layer * layer_size)))
            return false;
    return true;
}

bool gl_read(struct dt_core *core, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const struct gl_buffer *buffer = gl_buffer_of(rt, resource);
    if (core->pipeline->resources[resource].kind == DT_IMAGE)
        return read_image(rt, gl_image_of(rt, resource), mip, out);
    return GL(rt, buffer->name, MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT)) &&
           GL(rt, buffer->name,
              GetNamedBufferSubData(buffer->handle, 0, (GLsizeiptr)out->size, out->data));
}

bool gl_write(struct dt_core *core, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    const struct gl_image *image = gl_image_of(rt, resource);
    const struct gl_buffer *buffer = gl_buffer_of(rt, resource);
    if (core->pipeline->resources[resource].kind == DT_IMAGE)
        return GL(rt, image->name, MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT)) &&
               gl_image_write(rt, image, mip, 0, bytes->extent[2], bytes->data);
    return GL(rt, buffer->name, MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT)) &&
           gl_buffer_write(rt, buffer, bytes->data, bytes->size);
}
