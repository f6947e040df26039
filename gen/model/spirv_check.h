/* SPIRV-Tools as C functions that throw nothing: spirv-val, spirv-opt, spirv-dis. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Whether a module follows SPIR-V's rules: those of Vulkan take half as long again, and
 * tests/gen/golden_test.sh holds the modules to both APIs. why, NULL: names for messages take most of
 * the time; free(); NULL after false: out of memory. Every module from outside passes here before anything else
 * reads it: SPIRV-Cross trusts what it reads. */
bool spirv_check(const uint32_t *words, size_t count, char **why);

enum spirv_passes {
    SPIRV_FLATTEN = 1,  /* no groups of decorations, no debug instructions of extensions */
    SPIRV_INLINE = 2,   /* no functions but the entry points */
    SPIRV_LEGALIZE = 8, /* what glslang makes of HLSL becomes a valid module */
    SPIRV_PRUNE = 16,   /* no branches that constants decide */
    SPIRV_CHAINS =
        32, /* a chain into memory begins at a variable, and no function is there in vain */
    SPIRV_FREEZE = 4 /* no specialization constants, and what is computed of them is constant */
};
/* The module behind some passes of spirv-opt, *count words; free(). NULL: out of memory. */
uint32_t *spirv_optimize(const uint32_t *words, size_t *count, unsigned passes);
/* What spirv-dis prints of a module, a line for each instruction behind five of its head; free(). NULL: out of memory. */
char *spirv_disassemble(const uint32_t *words, size_t count);
