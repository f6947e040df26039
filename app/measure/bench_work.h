/* How much a pass has to move and to compute at least, told from a pipeline's reflection. Called by
 * the files of bench. */
#ifndef DIPTYCH_BENCH_WORK_H
#define DIPTYCH_BENCH_WORK_H

#include "diptych.h"

/* What the work depends on. */
struct work_frame {
    const struct dt_pipeline *pipeline;
    const void *live;
    uint32_t size[2];                   /* of the frame */
    uint32_t vertex_count, index_count; /* of the scene */
};

struct work {
    double read, written; /* bytes */
    double flops;
};

/* Every resource that the pass reads and writes counts once and whole, and so do vertices and indices
 * of a scene that it draws; textures are left out. A draw is taken to transform every vertex once per
 * instance and to cover every texel of its targets once. A pass whose size only the GPU knows has
 * flops of its fragments alone. */
struct work work_of(const struct work_frame *frame, uint32_t index);

#endif
