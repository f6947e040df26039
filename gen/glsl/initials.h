/* What glslang leaves out or changes where it reads OpenGL's GLSL for Vulkan. */
#pragma once

#include "glslang.h"

/* Whether an `=` stands in a declaration of a uniform; an #include and a name of the macro kind count as well. */
bool glsl_seems_to_initialize(const char *code);
/* Called for each uniform: `value` is a constructor, "vec2(0.5, 1)". */
typedef void initial_taker(void *user, const char *name, const char *value);
/* The initializers of uniforms: reads the job's text once more, as OpenGL's, if it seems to have some. What OpenGL does not take has none.
 * Those of HLSL's globals are the default values that D3D's reflection tells. */
void glsl_initials(const struct glslang_job *job, initial_taker *take, void *user);
/* glslang_compile() of a whole shader. Structs of uniforms keep their textures for split.c: glslang 15 takes them out, but confuses
 * those that an index of an array chooses. */
uint32_t *glsl_compile_whole(const struct glslang_job *job, size_t *count, char **log);
