/* The draws of one variation. Internal to vary.c and vary_draw.c. */
#ifndef DIPTYCH_GEN_VARY_DRAW_H
#define DIPTYCH_GEN_VARY_DRAW_H

#include "vary.h"

/* The overrides drawn so far, "PATH=VALUE" each, and the state of the random numbers. */
struct draws {
    const struct vary_request *request;
    struct shader_cache *cache; /* NULL: none */
    struct arena *arena;        /* of the overrides */
    uint64_t state;
    const char **sets; /* those drawn; take_sets() in vary.c adds those of the request */
    size_t set_count, capacity;
    bool out_of_memory;
};

/* Starts a draw without overrides. Seed, variation and attempt alone decide the random numbers. */
void draws_start(struct draws *draws, uint32_t variation, uint32_t attempt);

/* Draw in this order; each function needs a model with the overrides so far, draw_order a planned
 * one. */
void draw_params(struct draws *draws, const struct pipeline *pipeline);
void draw_details(struct draws *draws, const struct pipeline *pipeline);
void draw_order(struct draws *draws, const struct model *model);
bool draw_fast(struct draws *draws); /* whether the variation gets a twin that is not exact */
void draw_frame(struct draws *draws, const struct pipeline *pipeline, uint32_t frame[2]);
uint32_t draw_frame_count(struct draws *draws, const struct pipeline *pipeline);

#endif
