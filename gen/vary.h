/* What the two files of the variation generator share: the draws of one variation. Internal to vary*.c. */
#ifndef DIPTYCH_GEN_VARY_H
#define DIPTYCH_GEN_VARY_H

#include "stages.h"

/* The overrides drawn so far, "PATH=VALUE" each, and the state of the random numbers. */
struct draws {
    const struct vary_request *request;
    struct arena *arena; /* of the overrides */
    uint64_t state;
    const char **sets; /* those drawn, behind them those of the request */
    size_t set_count, capacity;
    bool out_of_memory;
};

/* A fresh start; attempts of one variation and variations of one seed know nothing of each other. */
void draws_start(struct draws *draws, uint32_t variation, uint32_t attempt);

/* The later ones look at a model that the earlier ones' overrides went into: draw_order at one that is
 * planned. */
void draw_params(struct draws *draws, const struct pipeline *pipeline);
void draw_details(struct draws *draws, const struct pipeline *pipeline);
void draw_order(struct draws *draws, const struct model *model);
bool draw_fast(struct draws *draws); /* whether the variation shall have a twin that is not exact */
void draw_frame(struct draws *draws, const struct pipeline *pipeline, uint32_t frame[2]);
uint32_t draw_frame_count(struct draws *draws, const struct pipeline *pipeline);

#endif
