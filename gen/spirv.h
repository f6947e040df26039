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

/* Whether the instruction ends its block: a branch, a return or a discard. */
bool spirv_ends_block(const uint32_t *instruction);

/* The id that the instruction defines; 0: none. */
uint32_t spirv_result(const uint32_t *instruction);

/* For each id below the module's bound, the offset of the instruction that defines it; 0: none.
 * free(). NULL when out of memory. */
uint32_t *spirv_definitions(const uint32_t *words, size_t count);

/* Removes names, sources and lines in place, which no result depends on. Returns the new count. */
size_t spirv_strip(uint32_t *words, size_t count);

/* Makes a module for Vulkan one for OpenGL, in place: no descriptor sets, OpenGL's numbers of
 * vertices and instances, and its origin of gl_FragCoord. Returns the new count. */
size_t spirv_for_opengl(uint32_t *words, size_t count);

/* loops.c: marks long loops DontUnroll: those in no other loop of their function, with many
 * operations per iteration. False when out of memory. */
bool spirv_keep_loops(uint32_t *words, size_t count);

/* The block of parameters in force: uniform and live ones. */
struct parameter_values {
    uint32_t binding;
    const void *bytes;
    uint32_t size;
};
/* iterations.c: for each label below the module's bound, how often the loop runs that starts there;
 * 0: no loop. 1 also where more than constants and parameters decide, or `break` or `return` can
 * end the loop. free(). NULL when out of memory. */
uint64_t *spirv_iterations(const uint32_t *words, size_t count, const uint32_t *definitions,
                           const struct parameter_values *parameters);

#endif
