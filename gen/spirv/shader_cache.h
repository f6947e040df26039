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
void shader_hash(const struct model *model, enum backend backend, struct shader *shader);
/* The same stage of an earlier pass with the same hash, or NULL. `pass`: index in order of execution. */
struct shader *shader_twin(struct pass_shaders *shaders, uint32_t pass, enum stage stage);

/* Fills shader->words from the entry for its hash. False: no entry, or a damaged one. One thread at
 * a time. */
bool shader_cache_find(struct shader_cache *cache, struct shader *shader);
/* Adds an entry. Failures are ignored: the cache is optional. */
void shader_cache_add(struct shader_cache *cache, const struct shader *shader);
