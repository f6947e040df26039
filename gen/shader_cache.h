/* Shaders that were compiled before: --shader-cache. See shader_cache.c. */
#ifndef DIPTYCH_GEN_SHADER_CACHE_H
#define DIPTYCH_GEN_SHADER_CACHE_H

#include "stages.h"

struct shader_cache;

/* What is in the file; nothing where it is not there, broken, or another program's. NULL when out of
 * memory. */
struct shader_cache *shader_cache_read(const char *path);
void shader_cache_free(struct shader_cache *cache);

/* Whether two texts are one shader: all but the comment with the name of the pass, and where in which file
 * the lines are from, unless the text asks for that. */
bool shader_text_same(const char *a, size_t a_length, const char *b, size_t b_length);

/* The same stage of an earlier pass, by index in order of execution, that is the same shader; else NULL. */
struct shader *shader_twin(const struct pass_shaders *shaders, uint32_t pass, enum stage stage);

/* Fills shader->words from its GLSL; false when that was never compiled. One thread at a time. */
bool shader_cache_find(struct shader_cache *cache, const struct model *model, enum backend backend,
                       struct shader *shader);

/* The file for next time: these shaders first, each once, then what was there and not asked for. */
void shader_cache_emit(const struct shader_cache *cache, const struct model *model,
                       struct pass_shaders *const shaders[2], struct text *out);

#endif
