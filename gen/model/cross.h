/* SPIR-V as GLSL text for OpenGL's compilers, by SPIRV-Cross. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text.h"

/* words: of OpenGL's variant (spirv_for_opengl). NoContraction becomes `precise`. False: *why,
 * free(), says why not; NULL: out of memory. */
bool spirv_cross(const uint32_t *words, size_t count, struct text *out, char **why);

/* Whether the bytes are a module of SPIR-V. */
bool spirv_is_module(const void *bytes, size_t size);
