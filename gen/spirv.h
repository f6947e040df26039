/* Looking into SPIR-V modules. Defined by spirv.c, but where said. */
#ifndef DIPTYCH_GEN_SPIRV_H
#define DIPTYCH_GEN_SPIRV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SPIRV_HEADER = 5 }; /* words before the first instruction; [3] is the bound of the ids */

/* Offset of the instruction that makes an id, by id; 0: none. calloc'ed, as many as the module's
 * bound; NULL when out of memory. */
uint32_t *spirv_definitions(const uint32_t *words, size_t count);

/* loops.c: asks the driver to leave long loops as they are: those that stand in no other loop of their
 * function, and do much in a turn. False when out of memory. */
bool spirv_keep_loops(uint32_t *words, size_t count);

#endif
