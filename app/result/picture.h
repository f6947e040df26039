/* Pictures of image resources: what -o and --show write. */
#ifndef DIPTYCH_PICTURE_H
#define DIPTYCH_PICTURE_H

#include "diptych.h"

/* Three channels, row 0 at the top; one of the two arrays is given, and owned. */
struct picture {
    uint32_t width, height;
    uint8_t *codes;
    float *linear;
};

/* 8-bit codes for display. 8-bit formats are shown unchanged. Signed numbers (normals, positions)
 * become v/2 + 1/2, relative to their largest magnitude or 1; depth is stretched; HDR is
 * tone-mapped (Reinhard); labels get colours; NaN and Inf are magenta. Layers form a contact sheet.
 * `bytes` is the result of the runtime's read. */
bool picture_codes(struct picture *picture, const struct dt_resource *resource,
                   const struct dt_bytes *bytes, const struct dt_log *log);

/* The numbers as they are, for EXR. */
bool picture_linear(struct picture *picture, const struct dt_resource *resource,
                    const struct dt_bytes *bytes, const struct dt_log *log);

/* The colour of a label; neighbouring ones get colours far apart. */
void picture_label(int64_t label, uint8_t codes[3]);

void picture_free(struct picture *picture);

#endif
