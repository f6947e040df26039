/* SPIR-V as GLSL text for OpenGL's compilers, by SPIRV-Cross. */
#ifndef DIPTYCH_GEN_SPIRV_CROSS_H
#define DIPTYCH_GEN_SPIRV_CROSS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text.h"

/* words: of OpenGL's variant (spirv_for_opengl). NoContraction becomes `precise`. False: *why,
 * free(), says why not; NULL: out of memory. */
bool spirv_cross(const uint32_t *words, size_t count, struct text *out, char **why);

#endif
