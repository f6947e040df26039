/* Makes a module exact; see exact.c. */
#ifndef DIPTYCH_GEN_SPIRV_EXACT_H
#define DIPTYCH_GEN_SPIRV_EXACT_H

#include "module.h"

/* False when out of memory; the module is then empty or as it was. */
bool spirv_exact(struct spirv *module);

#endif
