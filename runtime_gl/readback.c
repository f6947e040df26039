/* Copies buffers and images to memory, tightly packed, row 0 first. Called by runtime.c. */
#include "internal.h"

#include <stdlib.h>

static bool allocate(struct gl_runtime *rt, const char *name, struct dt_bytes *out)
{
    out->data = malloc(out->size ? out->size : 1);
    if (!out->data)
        gl_log(rt, DT_ERROR, "%s: no memory for %zu bytes to read back", name, out->size);
    return out->data;
}

static bool keep(struct dt_bytes *out, bool ok)
{
    if (!ok) {
        free(out->data);
        *out = (struct dt_bytes){0};
    }
    return ok;
}

bool gl_read_buffer(struct gl_runtime *rt, const struct gl_buffer *buffer, struct dt_bytes *out)
{
    if (!GL(rt, buffer->name, MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT)) ||
        !allocate(rt, buffer->name, out))
        return keep(out, false);
    if (!out->size)
        return true;
    return keep(out,
                GL(rt, buffer->name,
                   GetNamedBufferSubData(buffer->handle, 0, (GLsizeiptr)out->size, out->data)));
}

bool gl_read_image(struct gl_runtime *rt, const struct gl_image *image, uint32_t mip,
                   struct dt_bytes *out)
{
    if (mip >= image->mips) {
        gl_log(rt, DT_ERROR, "image %s: mip %u to read, and it has %u", image->name, mip,
               image->mips);
        return false;
    }
    const struct gl_format *f = gl_format(image->texel);
    uint32_t width = image->width >> mip, height = image->height >> mip;
    out->extent[0] = width ? width : 1;
    out->extent[1] = height ? height : 1;
    out->extent[2] = image->layers;
    size_t layer_size = (size_t)out->extent[0] * out->extent[1] * f->bytes;
    out->size = layer_size * image->layers;
    if (layer_size > INT32_MAX) { /* OpenGL counts the bytes of a layer in an int */
        gl_log(rt, DT_ERROR, "image %s: a layer of %zu bytes is too large to read back",
               image->name, layer_size);
        return keep(out, false);
    }
    if (!GL(rt, image->name, MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT)) ||
        !allocate(rt, image->name, out))
        return keep(out, false);
    for (uint32_t layer = 0; layer < image->layers; layer++)
        if (!GL(rt, image->name,
                GetTextureSubImage(image->handle, (GLint)mip, 0, 0, (GLint)layer,
                                   (GLsizei)out->extent[0], (GLsizei)out->extent[1], 1, f->format,
                                   f->type, (GLsizei)layer_size, out->data + layer * layer_size)))
            return keep(out, false);
    return true;
}
