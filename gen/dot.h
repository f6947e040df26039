/* What the two Graphviz drawings share: text that is safe in HTML-like labels, sizes, extents.
 * Defined in dot.c, used by emit_graph.c and emit_lifetimes.c alone. */
#ifndef DIPTYCH_GEN_DOT_H
#define DIPTYCH_GEN_DOT_H

#include "model.h"
#include "text.h"

/* Fills that stay apart when printed in grey. */
#define DOT_IMAGE_FILL   "#d9e6f4"
#define DOT_BUFFER_FILL  "#fbf4dc"
#define DOT_HISTORY_FILL "#b8b8b8"

void dot_text(struct text *out, const char *plain); /* escaped for labels */
void dot_bytes(struct text *out, uint64_t bytes);   /* 31.6 MiB */
void dot_extent(struct text *out,
                const struct resource *resource); /* rgba16f 256×256×8, Vpl[256] */
/* What a pass does to a resource, or what touched it before: "compute storage write, clear". Masks of
 * enum access_kind and stage_bit. */
void dot_accesses(struct text *out, unsigned kinds, unsigned stages);
/* Words for the bits of a mask, with commas. */
struct dot_word {
    unsigned bits;
    const char *text;
};
void dot_words(struct text *out, const struct dot_word *words, size_t count, unsigned mask,
               const char *between);
/* Points that plain text may need at most, in the fonts that stand in for Helvetica. */
int dot_width(const char *plain, int font_size);
/* Names of resources that no pass uses; returns how many. */
uint32_t dot_unused(const struct pipeline *pipeline, struct text *out);
/* Opens a drawing whose nodes say where they stand, in points. */
void dot_begin(struct text *out, const char *name);

#endif
