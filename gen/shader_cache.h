/* Compiled shaders in a folder, one file each, found by their GLSL. See shader_cache.c. */
#ifndef DIPTYCH_GEN_SHADER_CACHE_H
#define DIPTYCH_GEN_SHADER_CACHE_H

#include "stages.h"

struct shader_cache;

/* Opens the folder; makes it when it is missing. NULL: *problem says why, for example that others
 * own the folder or may write to it; without a problem, out of memory. `mebibytes`: above this
 * size, shader_cache_close removes least recently used entries. */
struct shader_cache *shader_cache_open(const char *folder, uint32_t mebibytes,
                                       const char **problem);
/* Removes old entries if new ones were added. Accepts NULL. */
void shader_cache_close(struct shader_cache *cache);

/* The same stage of an earlier pass that compiles to the same shader, or NULL. `pass`: index in
 * order of execution. */
struct shader *shader_twin(const struct pass_shaders *shaders, uint32_t pass, enum stage stage);

/* Fills shader->words from the entry for its GLSL. False: no entry, or a damaged one. One thread at
 * a time. */
bool shader_cache_find(struct shader_cache *cache, const struct model *model, enum backend backend,
                       struct shader *shader);
/* Adds an entry. Failures are ignored: the cache is optional. */
void shader_cache_add(struct shader_cache *cache, const struct model *model, enum backend backend,
                      const struct shader *shader);

#endif
