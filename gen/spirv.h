/* Looking into SPIR-V modules. spirv.c defines it, flops.c uses it, too. */
#ifndef DIPTYCH_GEN_SPIRV_H
#define DIPTYCH_GEN_SPIRV_H

#include <stddef.h>
#include <stdint.h>

enum { SPIRV_HEADER = 5 }; /* words before the first instruction; [3] is the bound of the ids */

/* Offset of the instruction that makes an id, by id; 0: none. calloc'ed, as many as the module's
 * bound; NULL when out of memory. */
uint32_t *spirv_definitions(const uint32_t *words, size_t count);

#endif
