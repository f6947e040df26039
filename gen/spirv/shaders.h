/* All shaders of a pipeline. */
#pragma once

#include "glsl/shader.h"

/* Shaders of one pass, by enum stage; word_count 0: none. Used as [backend][pass], passes in order
 * of execution. */
struct pass_shaders {
    struct shader stage[3];
};
struct shader_cache;
/* Every stage of every pass for both backends, with emit_glsl and spirv_compile. `cache` may be NULL.
 * Call shaders_free also after a failure. */
bool shaders_compile(struct model *model, struct pass_shaders *shaders[2],
                     struct shader_cache *cache, struct diag *diag);
void shaders_free(const struct model *model, struct pass_shaders *shaders[2]);
/* unused.c: warns about names that passes list and their shaders, Vulkan's, do not use. */
void check_listed(const struct model *model, const struct pass_shaders *shaders, struct diag *diag);
