#ifndef DIPTYCH_GEN_SPIRV_JOIN_H
#define DIPTYCH_GEN_SPIRV_JOIN_H

#include "model/module.h"

/* join.c: `more`, which the generator wrote, joins a whole shader's module. Ids of `more`
 * that the shader has not are at least the shader's former bound. False when out of memory. */
bool spirv_join(struct spirv *module, const struct spirv *more);

#endif
