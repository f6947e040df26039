/* The function of image_oiio.h by libstb, for the bundle: OpenImageIO needs 260 libraries. Reads PNG,
 * JPEG and HDR. bundle.sh makes libdiptych_image.so of it. */
#include "image_oiio.h"

#include <stb/stb_image.h>
#include <stb/stb_image_resize.h>
#include <stdio.h>
#include <stdlib.h>

static bool stb_fail(struct image_error *error, const char *reason)
{
    snprintf(error->text, sizeof error->text, "%s", reason ? reason : "unknown reason");
    return false;
}

/* Averages light, not codes. */
static void *resize(const void *texels, const int from[2], const int to[2], bool is_float)
{
    void *resized = malloc((size_t)to[0] * (size_t)to[1] * 4 * (is_float ? sizeof(float) : 1));
    int good = !resized ? 0
               : is_float
                   ? stbir_resize_float(texels, from[0], from[1], 0, resized, to[0], to[1], 0, 4)
                   : stbir_resize_uint8_srgb(texels, from[0], from[1], 0, resized, to[0], to[1], 0,
                                             4, 3, 0);
    if (!good)
        free(resized);
    return good ? resized : NULL;
}

bool image_oiio_read(const char *path, bool is_float, uint32_t *width, uint32_t *height,
                     void **texels, struct image_error *error)
{
    int size[2], channels;
    if (!stbi_info(path, &size[0], &size[1], &channels))
        return stb_fail(error, stbi_failure_reason());
    if (!texels) {
        *width = (uint32_t)size[0];
        *height = (uint32_t)size[1];
        return true;
    }
    if ((int64_t)size[0] * size[1] > IMAGE_MOST_PIXELS)
        return stb_fail(error, "too many pixels");
    stbi_ldr_to_hdr_gamma(1.0f); /* codes as they are, divided by 255 */
    void *read = is_float ? (void *)stbi_loadf(path, &size[0], &size[1], &channels, 4)
                          : (void *)stbi_load(path, &size[0], &size[1], &channels, 4);
    if (!read)
        return stb_fail(error, stbi_failure_reason());
    if (*width && *height) {
        const int to[2] = {(int)*width, (int)*height};
        void *resized = resize(read, size, to, is_float);
        free(read);
        read = resized;
    } else {
        *width = (uint32_t)size[0];
        *height = (uint32_t)size[1];
    }
    *texels = read;
    return read || stb_fail(error, "out of memory");
}
