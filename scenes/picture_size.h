/* What the header of a picture says, without an image library: its size, which a spec needs to
 * know, its colour space, and kinds that no reader here reads right. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PICTURE_SPACE = 128 };

/* Knows PNG, JPEG, OpenEXR (its display window) and Radiance HDR by their first bytes. False:
 * *reason, valid until the next call in this thread. */
bool picture_size(const char *path, uint32_t *width, uint32_t *height, const char **reason);

/* Whether the image libraries read the file as one picture of pixels: a Radiance HDR with rows from the
 * top, RGB, no run lengths of the first version; a JPEG without inks; an OpenEXR of one part, not deep. True for all other files. False: *reason, as above. */
bool picture_check(const char *path, const char **reason);

/* Writes the colour space that a JPEG, OpenEXR or Radiance HDR file declares, or the chunk cICP of a
 * PNG: `sRGB`, `linear`, or words that name it; nothing where it declares none. */
void picture_space(const char *path, char space[PICTURE_SPACE]);
/* The same of an ICC profile: `sRGB`, or its description. */
void picture_profile(const uint8_t *profile, size_t size, char space[PICTURE_SPACE]);

/* The tag Orientation of EXIF, 1 to 8, which says how a viewer turns the picture; 1: not at all, or the
 * file says nothing. Of a JPEG file, and of the EXIF data of any file. */
uint32_t picture_turn(const char *path);
uint32_t picture_exif_turn(const uint8_t *exif, size_t size);
