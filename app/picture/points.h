/* Elements of buffers as points over a picture. */
#pragma once

#include "picture/picture.h"

enum point_label {
    POINT_UNLABELLED,
    POINT_INDEX, /* the element's own */
    POINT_BUFFER /* the number in another buffer at the same index; negative: hidden */
};

/* How an element becomes a point; offsets are bytes from its start, fields are floats and ints. */
struct point_source {
    uint32_t buffer; /* resources of the pipeline */
    uint32_t position;
    int color; /* offset of a vec3; the largest one is as bright as can be, zero hidden; -1: none */
    enum point_label label;
    uint32_t label_buffer;
    int where;    /* offset of an int or float, negative: hidden; -1: none */
    float radius; /* pixels of a picture that is 540 high */
};

/* Draws all points through the camera; points behind it or outside the picture are left out. */
void points_draw(const struct picture *picture, const struct dt_view *camera,
                 const struct dt_pipeline *info, const struct point_source *source,
                 const struct dt_bytes *elements, const struct dt_bytes *labels);
