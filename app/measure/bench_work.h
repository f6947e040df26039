/* Bytes of a pass, estimated from the pipeline's reflection. */
#pragma once

#include "diptych.h"

/* Inputs of the estimate. */
struct work_frame {
    const struct dt_pipeline *pipeline;
    uint32_t size[2];                   /* of the frame */
    uint32_t vertex_count, index_count; /* of the scene */
};

struct work {
    double read, written; /* bytes */
};

/* Counts every resource of the pass whole and once, and the vertices and indices of a scene that it
 * draws; textures count nothing. */
struct work work_of(const struct work_frame *frame, uint32_t index);
