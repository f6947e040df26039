/* compare --bisect: runs the guilty pass on both sides once more, narrows down what it left
 * differently, and keeps all that it takes to run it alone. Called by compare. */
#ifndef DIPTYCH_BISECT_H
#define DIPTYCH_BISECT_H

#include "compare/blame.h"
#include "compare/evidence.h"

/* Writes the folder and tells the region, as a malloc'ed line for people, too. `guilty` is a row of
 * replay->rows->outputs with an own error in replay->frame; devices are what the two sides ran on.
 * NULL, with the error logged, when it could not be done. */
char *bisect(const struct replay *replay, uint32_t guilty, const char *const devices[2],
             const char *folder, struct region *region);

#endif
