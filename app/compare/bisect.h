/* compare --bisect: runs the guilty pass on both sides again, finds the region that differs, and
 * writes a folder with all that `replay` needs to run the pass alone. */
#pragma once

#include "compare/blame.h"
#include "compare/evidence.h"

/* Writes the folder. `guilty` is a row of replay->rows->outputs with an own error in replay->frame;
 * `devices` are the names of both sides' devices. Returns the region as text, malloc'ed, or NULL with
 * the error logged. */
char *bisect(const struct replay *replay, uint32_t guilty, const char *const devices[2],
             const char *folder, struct region *region);
