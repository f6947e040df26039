/* spirv-val, the validator of SPIRV-Tools, as a C function that throws nothing. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Whether a module follows SPIR-V's rules: those of Vulkan take half as long again, and
 * tests/gen/golden_test.sh holds the modules to both APIs. why, NULL: names for messages take most of
 * the time; free(); NULL after false: out of memory. Every module from outside passes here before anything else
 * reads it: SPIRV-Cross trusts what it reads. */
bool spirv_check(const uint32_t *words, size_t count, char **why);
