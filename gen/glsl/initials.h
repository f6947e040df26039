/* The initializers of a shader's uniforms, which glslang leaves out where it reads GLSL for Vulkan. */
#pragma once

#include "glslang.h"

/* Called for each uniform: `value` is a constructor, "vec2(0.5, 1)". */
typedef void initial_taker(void *user, const char *name, const char *value);
/* Reads the job's text once more, as OpenGL's, if it seems to have some. What OpenGL does not take has none. */
void glsl_initials(const struct glslang_job *job, initial_taker *take, void *user);
