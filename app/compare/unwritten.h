/* Memory that no pass has written. Runtimes fill discarded memory before its first use in a frame. What differs between two runs
 * of one side that differ in nothing but the fill was not written, or depends on what was not. */
#pragma once

#include "result/rows.h"
#include "run/worker.h"

/* The fills: of the first side of a comparison, and of the others. */
enum { POISON_FIRST = 0x5a, POISON_OTHERS = 0xa5 };

/* Of a row's content with the first fill and with the other: where it first differs, as a sentence like "texel (3, 0) of
 * `second` was never written in this frame"; free(). NULL: it is equal. surely: it is the fill itself; else it may
 * also be a race that differs. False when out of memory. */
bool unwritten_describe(const struct row *row, const struct dt_resource *resource,
                        const struct dt_bytes copies[2], char **text, bool *surely);

/* The same of a row of a side's outputs, by runs up to that frame. False with the error logged. */
bool unwritten_find(const struct worker_info *worker, const struct row *row, uint32_t frame,
                    char **text);
