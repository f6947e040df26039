/* Compiled shaders in a cache, found by their GLSL. See shader_cache.c. */
#pragma once

#include "model/cache.h"
#include "shaders.h"

/* Sets shader->hash, of all that it is compiled from. Texts may differ in #line and in the comment with the
 * pass name, if they use neither __LINE__ nor __FILE__. */
void shader_hash(enum backend backend, struct shader *shader);
/* The first of `count` passes' shaders for the stage with the same hash, or NULL. */
const struct shader *shader_twin(const struct pass_shaders *shaders, uint32_t count,
                                 const struct shader *shader);

/* As cache_find and cache_add, of shader->words. */
bool shader_cache_find(struct cache *cache, struct shader *shader);
void shader_cache_add(struct cache *cache, const struct shader *shader);
