/* What the header of a picture says, without an image library: its size, which a spec needs to
 * know, its colour space, and kinds that no reader here reads right. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PICTURE_SPACE = 128, PICTURE_TROUBLE = 384 };

struct picture {
    const char *kind;       /* "PNG", "JPEG", "OpenEXR" or "HDR" */
    uint32_t width, height; /* of OpenEXR's display window; 0: the header is damaged */
    /* That the file declares, of a PNG in the chunk cICP: `sRGB`, `linear`, or words that name it; "": none. */
    char space[PICTURE_SPACE];
    /* EXIF's tag Orientation, 1 to 8, which says how a viewer turns a JPEG; 1: not at all. */
    uint32_t turn;
    /* Why image libraries do not read it as one picture of pixels: a Radiance HDR whose rows do not begin at the
     * top, or with run lengths of the first version; a JPEG of inks; an OpenEXR that is deep or has parts. "":
     * they do. */
    char trouble[PICTURE_TROUBLE];
};

/* Knows these kinds by their first bytes. False: *reason, valid until the next call in this thread. */
bool picture_read(const char *path, struct picture *picture, const char **reason);
/* Its size alone. False: *reason, as above, also of trouble. */
bool picture_size(const char *path, uint32_t *width, uint32_t *height, const char **reason);

/* The colour space of an ICC profile: `sRGB`, or its description. */
void picture_profile(const uint8_t *profile, size_t size, char space[PICTURE_SPACE]);

/* The turn of EXIF data. */
uint32_t picture_exif_turn(const uint8_t *exif, size_t size);
