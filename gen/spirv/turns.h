/* How often the loops of a shader turn, where its module and its parameters tell. */
#pragma once

#include "model/module.h"

struct spirv_loop {
    size_t merge;    /* offset of its OpLoopMerge */
    uint32_t turns;  /* at most; 0: not known */
    uint32_t around; /* number of the loop around it; its own: none */
};

/* The uniform block of parameters. */
struct spirv_block {
    uint32_t binding; /* of set 0 */
    const void *bytes;
    uint32_t size;
};

/* The number of loops of a module of one function, at most `most`, the outer ones first. A loop whose counter begins at an unknown number counts as from 0. */
uint32_t spirv_find_loops(const struct spirv *module, const struct spirv_block *block,
                          struct spirv_loop *list, uint32_t most);
/* loops.c: the loop is not unrolled; wrapped: it stands in another of one turn, whose end no compiler can know. False: out
 * of memory, or it cannot be wrapped. */
bool spirv_keep_loop(struct spirv *module, size_t merge, bool wrapped);
