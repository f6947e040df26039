/* The size of a picture, from its header alone and without an image library: what a spec needs to
 * know of a file. Called by gen and by the app. */
#ifndef DIPTYCH_SCENES_PICTURE_SIZE_H
#define DIPTYCH_SCENES_PICTURE_SIZE_H

#include <stdbool.h>
#include <stdint.h>

/* Knows PNG, JPEG, OpenEXR and Radiance HDR by their first bytes. False: *reason, valid until the
 * next call in this thread. */
bool picture_size(const char *path, uint32_t *width, uint32_t *height, const char **reason);

#endif
