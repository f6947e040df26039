/* How far passes that their `exactness` leaves free are from exact arithmetic: each runs beside its exact
 * twin, on the same device and the same inputs. */
#pragma once

#include "compare/blame.h"

/* Of one side. */
struct twin {
    struct sheet
        sheet; /* the side's rows of such passes and their twins'; errors have `exact` alone */
    const struct sheet_row *broken; /* the first beyond its contract; NULL: none */
};

/* Whether any pass of the pipeline is judged so. */
bool twin_is_needed(const struct pipeline *pipeline);
/* Loads the pipeline with all passes exact, with the inputs and live parameters of the other. Log their errors. */
bool twin_load(struct pipeline *exact, const struct pipeline *pipeline, struct console *console,
               const struct setup *setup);
/* Runs one frame of a side again, which `worker` describes, beside its twin. `results`: rows of a sheet of the outputs, which
 * describe them. twin_free either way. */
bool twin_judge(struct twin *twin, const struct worker_info *worker, const struct pipeline *exact,
                const struct rows *rows, const struct sheet_row *results, uint32_t frame);
void twin_free(struct twin *twin); /* takes a zeroed one */
