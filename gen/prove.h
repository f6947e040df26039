/* The proof that a shader is exact; see prove.c. Called by spirv.c. */
#ifndef DIPTYCH_GEN_PROVE_H
#define DIPTYCH_GEN_PROVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* An operation whose result the standards leave open. */
struct open_operation {
    uint32_t file, line; /* by OpLine, whose file is a number; 0: none */
    const char *word;    /* how a body has it, or a description */
    const char *why;     /* what is open */
    bool wrong;          /* exact mode replaces it, but not in macros */
    bool raster;         /* a value of the rasterizer */
};

/* Calls `found` for each open operation of a module, in the order of the module. False when out of
 * memory. */
bool prove_module(const uint32_t *words, size_t count,
                  void (*found)(void *user, const struct open_operation *operation), void *user);

#endif
