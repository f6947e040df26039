/* Pictures of image resources: what -o and --show write. */
#pragma once

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

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

/* How a picture is made of numbers, where that is chosen. Zeroed: as picture_codes does. */
struct picture_look {
    uint32_t channel; /* 0: the first three; else one alone, from 1, as grey */
    float exposure;   /* in stops; integers keep their colours */
    bool ranged;      /* `range` becomes 0 to 1, instead of the above */
    float range[2];
    bool
        tinted; /* false colour: dark blue, cyan, yellow, dark red; of three channels, of their mean */
};
bool picture_look(struct picture *picture, const struct dt_resource *resource,
                  const struct dt_bytes *bytes, const struct picture_look *look,
                  const struct dt_log *log);
/* The range of all finite numbers of the channels that are looked at, without a cleared depth of 1;
 * 0 to 1 where there are none. */
void picture_range(const struct dt_resource *resource, const struct dt_bytes *bytes,
                   uint32_t channel, float out[2]);

/* Width and height of a picture of that extent, and where in it a texel of the resource is. False: there is
 * no texel at that place of the picture. */
void picture_sheet(const uint32_t extent[3], uint32_t size[2]);
void picture_place(const uint32_t extent[3], uint64_t texel, uint32_t place[2]);
bool picture_texel(const uint32_t extent[3], const uint32_t place[2], uint64_t *texel);

/* The numbers as they are, for EXR. */
bool picture_linear(struct picture *picture, const struct dt_resource *resource,
                    const struct dt_bytes *bytes, const struct dt_log *log);

void picture_free(struct picture *picture);

#ifdef __cplusplus
}
#endif
