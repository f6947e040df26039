/* What the two Graphviz drawings share: sizes, barriers, uses.
 * Defined in dot.c, used only by emit_graph.c and emit_lifetimes.c. */
#ifndef DIPTYCH_GEN_DOT_H
#define DIPTYCH_GEN_DOT_H

#include "model/model.h"
#include "base/text.h"

/* Fill colours that differ in grey print, too. */
#define DOT_IMAGE_FILL  "#d9e6f4"
#define DOT_BUFFER_FILL "#fbf4dc"

#define DOT_TABLE "border=\"0\" cellborder=\"1\" cellspacing=\"0\" cellpadding=\"0\""

/* Writes "31.6 MiB" between the two texts. */
void dot_bytes(struct text *out, const char *before, uint64_t bytes, const char *after);
/* rgba16f 256×256×8, Vpl[256] */
void dot_extent(struct text *out, const struct resource *resource);
/* "compute storage write, clear → compute storage read" */
void dot_barrier(struct text *out, const struct barrier *barrier);

/* What a pass does with a resource: mask, 0: nothing. */
enum { DOT_READS = 1, DOT_WRITES = 2 };
unsigned dot_uses(const struct pass *pass, const struct resource *resource);

/* Opens a drawing; the caller adds nodes, edges and the closing brace. */
void dot_begin(struct text *out, const char *name);

#endif
