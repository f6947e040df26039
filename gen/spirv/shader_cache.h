/* Compiled shaders in a folder, one file each, found by their GLSL. See shader_cache.c. */
#pragma once

#include "shaders.h"

struct shader_cache;

/* Opens the folder; makes it when it is missing. NULL: the folder is NULL, or cannot be used, for
 * example because others may write to it; the first such folder of a process is a warning. */
struct shader_cache *shader_cache_open(const char *folder, struct diag *diag);
/* If entries were added, removes the least recently used ones above DIPTYCH_CACHE_MIB (environment;
 * default: 64). Accepts NULL. */
void shader_cache_close(struct shader_cache *cache);

/* Sets shader->hash, of all that it is compiled from. Texts may differ in #line and in the comment with the
 * pass name, if they use neither __LINE__ nor __FILE__. */
void shader_hash(enum backend backend, struct shader *shader);
/* The first of `count` passes' shaders for the stage with the same hash, or NULL. */
const struct shader *shader_twin(const struct pass_shaders *shaders, uint32_t count,
                                 const struct shader *shader);

/* Fills shader->words from the entry for its hash. False: no entry, or a damaged one. One thread at
 * a time. */
bool shader_cache_find(struct shader_cache *cache, struct shader *shader);
/* Adds an entry. Failures are ignored: the cache is optional. */
void shader_cache_add(struct shader_cache *cache, const struct shader *shader);
