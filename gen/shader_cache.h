/* Compiled shaders in a folder, one file each, found by their GLSL. See shader_cache.c. */
#ifndef DIPTYCH_GEN_SHADER_CACHE_H
#define DIPTYCH_GEN_SHADER_CACHE_H

#include "stages.h"

struct shader_cache;

/* Opens the folder, which is made when it is missing. One that others may write, or that belongs to
 * somebody else, is not used: then *problem says why, and the result is NULL. NULL without a problem: out
 * of memory. `mebibytes`: size at which the least recently used entries are removed. */
struct shader_cache *shader_cache_open(const char *folder, uint32_t mebibytes,
                                       const char **problem);
/* Removes old entries when something was added. Takes NULL. */
void shader_cache_close(struct shader_cache *cache);

/* Whether two texts are one shader: all but the comment with the name of the pass, and where in which file
 * the lines are from, unless the text asks for that. */
bool shader_text_same(const char *a, size_t a_length, const char *b, size_t b_length);

/* The same stage of an earlier pass, by index in order of execution, that is the same shader; else NULL. */
struct shader *shader_twin(const struct pass_shaders *shaders, uint32_t pass, enum stage stage);

/* Fills shader->words from its GLSL. False: no entry, or a damaged one. One thread at a time. */
bool shader_cache_find(struct shader_cache *cache, const struct model *model, enum backend backend,
                       struct shader *shader);
/* Adds an entry. Failures are ignored: the cache is optional. */
void shader_cache_add(struct shader_cache *cache, const struct model *model, enum backend backend,
                      const struct shader *shader);

#endif
