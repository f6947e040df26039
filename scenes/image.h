/* C interface to image files. libpng writes PNG, and reads PNG of up to 8 bits. OpenImageIO reads
 * everything else; it is loaded on first use, from a shared object beside the executable, since
 * its 260 libraries cost a quarter of a second. */
#pragma once

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether the file can be an image: it is regular and not too large. Tells the parent of a child
 * (child.h) that it is read now. */
bool image_may_open(const char *path, const struct dt_log *log);

/* What the numbers of a file are taken for: left as they are, light, or sRGB codes. */
enum image_encoding { IMAGE_AS_NUMBERS, IMAGE_AS_LIGHT, IMAGE_AS_SRGB };

/* Warns, with the name, of a colour space that the file declares and that is not the encoding's, and of
 * an EXIF orientation. No reader converts colours or turns pictures. IMAGE_AS_NUMBERS: linear and sRGB
 * are both right. */
void image_check_claims(const char *path, enum image_encoding encoding, const struct dt_log *log);

/* Reads any image file as RGBA8, row 0 at the top, resized to width x height if
 * both are non-zero. *texels is malloc'ed, width * height * 4 bytes. Colour stays as encoded in
 * the file (sRGB), not premultiplied; one channel is spread over red, green and blue; alpha is
 * 255 where the file has none. */
bool image_read_rgba8(const char *path, uint32_t *width, uint32_t *height, uint8_t **texels,
                      const struct dt_log *log);

/* Width and height of an image file, from its header alone. */
bool image_size(const char *path, uint32_t *width, uint32_t *height, const struct dt_log *log);

/* As file_write. Row 0 of the array is the top of the picture. */
bool image_write_png(const char *path, uint32_t width, uint32_t height, uint32_t channels,
                     const uint8_t *texels, const struct dt_log *log);

/* Reads any image file as float, RGBA: light as it is, codes divided by their largest value. */
bool image_read_float(const char *path, uint32_t *width, uint32_t *height, float **texels,
                      const struct dt_log *log);

#ifdef __cplusplus
}
#endif
