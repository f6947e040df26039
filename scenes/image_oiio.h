/* C interface of the OpenImageIO shim, image_oiio.cpp, which becomes build/libdiptych_image.so.
 * image.c loads the shim with dlopen and finds the function by name. It returns false with a
 * reason in `error`. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An image is read as four floats a pixel: 1 GiB. */
enum { IMAGE_MOST_PIXELS = 1 << 26 };

struct image_error {
    char text[512];
};

/* Four channels; `is_float`: float, else uint8_t. *texels is malloc'ed; texels NULL: only the size. Else
 * resizes if both sizes are non-zero. */
typedef bool image_oiio_read_fn(const char *path, bool is_float, uint32_t *width, uint32_t *height,
                                void **texels, struct image_error *error);

image_oiio_read_fn image_oiio_read;

#ifdef __cplusplus
}
#endif
