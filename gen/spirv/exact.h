/* Makes a module exact; see exact.c. */
#pragma once

#include "model/module.h"

/* False when out of memory; the module is then empty or as it was. */
bool spirv_exact(struct spirv *module);
