/* How a SPIR-V module uses its descriptors: the bindings that its entry point reads and writes,
 * found by following the reachable code, not the declarations. Called by tape.c. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SPIRV_READS = 1, SPIRV_WRITES = 2, SPIRV_BINDINGS = 64 };

/* Fills uses with a mask per binding of set 0. False if the module has something that this reader
 * does not support; *problem names it. */
bool spirv_uses(const uint32_t *words, size_t count, uint8_t uses[SPIRV_BINDINGS],
                const char **problem);
