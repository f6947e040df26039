/* All shaders of a pipeline. */
#pragma once

#include "glsl/shader.h"

/* Shaders of one pass, by enum stage; word_count 0: none. Used as [backend][pass], passes in order
 * of execution. */
struct pass_shaders {
    struct shader stage[3];
};
struct cache;
struct shader_plan { /* one plan of a spec */
    struct model *model;
    struct pass_shaders **shaders; /* [2], by enum backend */
    struct diag *diag;
};
/* Every stage of every pass for both backends, with emit_glsl and spirv_compile. A second plan, that for GPUs, takes
 * what is equal from the first; errors of the first end both. `cache` may be NULL. Call shaders_free also
 * after a failure. */
bool shaders_compile(const struct shader_plan *plans, uint32_t count, struct cache *cache);
bool shaders_are_same(const struct shader *a, const struct shader *b); /* in all words */
void shaders_free(const struct model *model, struct pass_shaders *shaders[2]);
/* unused.c: warns about names that passes list and their shaders, Vulkan's, do not use. */
void check_listed(const struct model *model, const struct pass_shaders *shaders, struct diag *diag);
