/* How far passes that their `exactness` leaves free are from exact arithmetic: each runs beside its exact
 * twin, on the same device and the same inputs. */
#ifndef DIPTYCH_TWIN_H
#define DIPTYCH_TWIN_H

#include "compare/blame.h"

/* Of one side. */
struct twin {
    struct difference
        *found; /* one per row of outputs: the copies are this side's and its twin's; elements 0:
                                 the pass is exact; owned */
    struct errors *errors; /* the same in every measure; no pairs: the pass is exact; owned */
    bool broken;           /* a row is beyond its contract, */
    uint32_t row;          /* the first */
};

/* Whether any pass of the pipeline is judged so. */
bool twin_is_needed(const struct pipeline *pipeline);
/* Loads the pipeline with all passes exact, with the inputs and live parameters of the other. Log their errors. */
bool twin_load(struct pipeline *exact, const struct pipeline *pipeline, struct console *console,
               const struct setup *setup);
/* Runs one frame of a side again, which `worker` describes, beside its twin. twin_free either way. */
bool twin_judge(struct twin *twin, const struct worker_info *worker, const struct pipeline *exact,
                const struct rows *rows, uint32_t frame);
void twin_free(struct twin *twin); /* takes a zeroed one */

#endif
