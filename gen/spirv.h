/* Functions on SPIR-V modules. Defined in spirv.c unless noted. */
#ifndef DIPTYCH_GEN_SPIRV_H
#define DIPTYCH_GEN_SPIRV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SPIRV_HEADER = 5 }; /* words before the first instruction; [3] is the bound of the ids */

/* Whether the instruction is an `opcode`, a SpvOp. */
static inline bool spirv_is(const uint32_t *instruction, unsigned opcode)
{
    return (*instruction & 0xffff) == opcode;
}

/* For each id below the module's bound, the offset of the instruction that defines it; 0: none.
 * free(). NULL when out of memory. */
uint32_t *spirv_definitions(const uint32_t *words, size_t count);

/* loops.c: marks long loops DontUnroll: those in no other loop of their function, with many
 * operations per iteration. False when out of memory. */
bool spirv_keep_loops(uint32_t *words, size_t count);

#endif
