/* Texels in exact passes: what an image holds, not what a driver makes of it. */
#pragma once

#include "model/model.h"
#include "model/module.h"

/* Reads of texels get the value of their code, writes and colour targets are rounded to the format's codes, by functions of
 * templates/glsl/values.glsl. False: out of memory, or *why says what cannot be exact (free(); a former text is freed). */
bool spirv_values(struct spirv *module, const struct pass *pass, char **why);

/* A hash of all that spirv_values takes of the pass: equal texts with unequal hashes are not the same shader. */
uint64_t spirv_formats(const struct pass *pass);

/* Whether a shader has the driver filter or gather texels that the pass would read as codes. */
bool spirv_samples_codes(const struct spirv *module, const struct pass *pass);
