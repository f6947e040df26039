/* Shadow memory of --sanitize=content,race,flow: internal buffers beside those of the pipeline, which say what was written, and by
 * whom. See shadow.c. */
#pragma once

#include "base/text.h"
#include "model/source.h"

enum { SHADOW_BANKS = 3, SHADOW_SHARED_CELLS = 1 << 18 };
/* Names of the buffers. */
extern const char shadow_buffer[];
extern const char *const shadow_cell_buffers[SHADOW_BANKS];

void shadow_plan(struct model *model);
/* Which of the cell buffers a pass uses, by its place in the order. */
uint32_t shadow_bank(const struct pipeline *pipeline, uint32_t pass);
bool shadow_has_cells(const struct pass *pass);
/* Whether somebody else fills it, or it is the generator's. */
bool shadow_is_foreign(const struct resource *resource);
bool shadow_stores_to(const struct pass *pass, const struct resource *resource);

/* A sum of products; for GLSL also the text of those that depend on the frame or on parameters. */
struct shadow_sum {
    uint32_t width, height; /* of the frame */
    uint64_t value, literal;
    struct text text;
    bool c; /* the text is C, not GLSL */
};
/* Adds the words of a resource; of all that a pass stores to, before `until`; of all resources before it. NULL: of all. */
void shadow_add_words(struct shadow_sum *sum, const struct resource *resource);
void shadow_add_cells(struct shadow_sum *sum, const struct pipeline *pipeline,
                      const struct pass *pass, const struct resource *until);
void shadow_add_all(struct shadow_sum *sum, const struct pipeline *pipeline,
                    const struct resource *until);

/* Words of an internal resource at a frame size; 0: its count says it. */
uint64_t shadow_words(const struct model *model, const struct resource *resource, uint32_t width,
                      uint32_t height);
/* The same as an expression in C, of `width` and `height`; false: its count says it. */
bool shadow_emit_c(const struct model *model, const struct resource *resource, struct text *out);
