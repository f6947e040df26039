/* What one module has joins another: the functions of a library (link.c), or all that the generator wrote (join.c). Types
 * and constants that both have become one.
 * The library is templates/glsl/exact.glsl, which is compiled when diptych-gen is built; a module gets the functions that it
 * calls, and those that these call. */
#pragma once

#include "model/module.h"

struct spirv_link {
    struct spirv_edit *edit;
    const struct spirv *more; /* the other module */
    uint32_t *ids;            /* by id of `more`: its id in the edit; 0: not there yet */
    uint32_t *wanted; /* functions of the library to copy, by index; NULL: not the library */
    uint32_t wanted_count;
};

/* The id in the edit of one of `more`, which is declared there if it is a type, constant or variable. */
uint32_t spirv_link_id(struct spirv_link *link, uint32_t id);
/* Copies an instruction of `more`, with all ids that it names. */
void spirv_link_copy(struct spirv_link *link, struct spirv_words *to, const uint32_t *instruction);

/* Reads the library, once per process, from any thread. False when out of memory. */
bool spirv_library_start(void);

/* A hash of the library's words. Cached shaders of another library are not used. */
uint32_t spirv_library_hash(void);

/* Of the library. The edit fails when memory runs out. */
void spirv_link_begin(struct spirv_link *link, struct spirv_edit *edit);
/* The id, in the module, of the library's function with glslang's mangled name, "exact_pow(f1;f1;".
 * 0: the library has none. */
uint32_t spirv_link_function(struct spirv_link *link, const char *name);
/* Copies the functions that were asked for, and those that they call, as exact code. */
void spirv_link_end(struct spirv_link *link);
