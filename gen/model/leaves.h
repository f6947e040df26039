/* The numbers that a variable holds below its structs and arrays: the scalars, vectors and matrices that have a
 * value each in a spec. Called by gen/spirv/bind.c, which fills them, and by app/import, which lists them. */
#pragma once

#include "base/text.h"
#include "module.h"

enum { MOST_STEPS = 16, MOST_LEAVES = 1 << 16 };

struct spirv_leaf {
    char name[256]; /* of the variable and of members, joined by _; not of a block */
    uint32_t types[MOST_STEPS + 1]; /* from the variable's to the leaf's, which is types[depth] */
    uint32_t members[MOST_STEPS];   /* the step to the next type: which member of a struct */
    uint32_t depth;
};

typedef bool spirv_leaf_taker(void *user, const struct spirv_leaf *leaf);

/* Calls `take` for each leaf that functions use. What is nested too deeply is a leaf of a struct's type.
 * live: by function, those that count; NULL: every leaf is used. False: out of memory, or `take` has said so. */
bool spirv_each_leaf(const struct spirv *module, const uint32_t *variable, const bool *live,
                     spirv_leaf_taker *take, void *user);
/* By function, which the entry point reaches: free(). NULL: out of memory. */
bool *spirv_live_functions(const struct spirv *module);
/* Whether a live function has the id as an operand; live NULL: any function. */
bool spirv_mentions(const struct spirv *module, const bool *live, uint32_t id);

/* GLSL's name of a type, as "vec4[2]"; of a leaf, with the arrays around it. False: a value has no such type. */
bool spirv_type_name(const struct spirv *module, uint32_t type, struct text *out);
bool spirv_leaf_type(const struct spirv *module, const struct spirv_leaf *leaf, struct text *out);
bool spirv_is_array(const uint32_t *type);
/* Below all layers of arrays. */
uint32_t spirv_element_type(const struct spirv *module, uint32_t type);
/* Length of an array, of a specialization constant by its default; 0: none, or at run time. */
uint32_t spirv_array_length(const struct spirv *module, const uint32_t *type);

/* GLSL's name of SpvImageFormat; "": none. What GLSL declares for a type of images: "usampler2DArray"; "": nothing. */
const char *spirv_image_format(uint32_t format);
void spirv_image_name(const struct spirv *module, const uint32_t *image, bool sampler, char *out,
                      size_t size);

/* The author's name: one that stepped aside for another has a prefix (glsl_messages.c). NULL stays. */
const char *spirv_own_name(const char *name);
/* Its name, or that of its block, without the layers of arrays. "?": none. */
const char *spirv_variable_name(const struct spirv *module, const uint32_t *variable);
