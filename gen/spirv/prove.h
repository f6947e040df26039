/* The proof that a shader is exact; see prove.c. */
#pragma once

#include "model/module.h"

/* An operation whose result the standards leave open. */
struct open_operation {
    uint32_t file, line;  /* by OpLine, whose file is a number; 0: none */
    const char *function; /* that it stands in, as glslang names it; NULL: none */
    const char *word;     /* how a body has it, or a description */
    const char *why;      /* what is open */
    bool wrong;           /* an error also without --prove */
    bool ends;            /* a function without `return`: wrong, but a warning */
    bool raster;          /* a value of the rasterizer */
};

/* Calls `found` for each open operation of a module, in the order of the module. False when out of
 * memory. */
bool prove_module(const struct spirv *module,
                  void (*found)(void *user, const struct open_operation *operation), void *user);

/* The word that a body has for an operation that is not exact: `pow`, `+`; NULL: it is exact. glsl: id of
 * GLSL.std.450. */
const char *prove_word(const uint32_t *instruction, uint32_t glsl);
