/* What a SPIR-V module does with its descriptors: which bindings its entry point reads and writes,
 * followed through the code that it can reach, whatever the declarations promise. Called by
 * tape.c. */
#ifndef DIPTYCH_TESTS_SPIRV_USES_H
#define DIPTYCH_TESTS_SPIRV_USES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SPIRV_READS = 1, SPIRV_WRITES = 2, SPIRV_BINDINGS = 64 };

/* Fills uses with a mask per binding of set 0. False when the module does what this reader does not
 * follow: *problem says what. */
bool spirv_uses(const uint32_t *words, size_t count, uint8_t uses[SPIRV_BINDINGS],
                const char **problem);

#endif
