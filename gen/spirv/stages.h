/* The interface between a vertex and a fragment shader of others, and the targets of the latter. */
#ifndef DIPTYCH_GEN_SPIRV_STAGES_H
#define DIPTYCH_GEN_SPIRV_STAGES_H

#include "model/module.h"

struct stage_fault {
    char name[128]; /* of the input; "": out of memory */
    char text[512];
};

/* Variables of the storage class, Input or Output, without a location get one. False: out of memory. */
bool spirv_locate(struct spirv *module, uint32_t class);
/* Inputs without a location get that of the output with their name; `before`: the vertex shader's module. An
 * input that is not written and not read is removed. version: of GLSL; below 440 both have the same
 * interpolation. False: *fault says why. */
bool spirv_locate_inputs(struct spirv *module, const struct spirv *before, unsigned version,
                         struct stage_fault *fault);

#endif
