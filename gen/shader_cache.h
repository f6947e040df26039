/* Shaders that were compiled before: --shader-cache. See shader_cache.c. */
#ifndef DIPTYCH_GEN_SHADER_CACHE_H
#define DIPTYCH_GEN_SHADER_CACHE_H

#include "stages.h"

struct shader_cache;

/* What is in the file; nothing where it is not there, broken, or another program's. NULL when out of
 * memory. */
struct shader_cache *shader_cache_read(const char *path);
void shader_cache_free(struct shader_cache *cache);

/* Fills shader->words from its GLSL; false when that was never compiled. One thread at a time. */
bool shader_cache_find(struct shader_cache *cache, const struct model *model, enum backend backend,
                       struct shader *shader);

/* The file for next time: these shaders first, then what was there and not asked for. */
void shader_cache_emit(const struct shader_cache *cache, const struct model *model,
                       struct pass_shaders *const shaders[2], struct text *out);

#endif
