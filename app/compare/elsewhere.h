/* What would break elsewhere though all sides agree here: limits that other devices may not have, barriers
 * that are missing, and results that vary from run to run. With the findings of --sanitize they are one list behind the verdict. */
#pragma once

#include "result/rows.h"
#include "run/worker.h"

struct cJSON;

struct elsewhere {
    struct cJSON *
        list; /* [{"kind": "limit", "barrier" or "repeat", "pass", "message"; of repeats "side", "runs", "distinct"}]; owned */
    bool repeats_differ, barriers_missing;
};

/* Limits of which passes need more than Vulkan's profile Roadmap 2022 promises. These return false with the error logged. */
bool elsewhere_add_limits(struct elsewhere *elsewhere, const struct dt_panel *panel,
                          const struct dt_log *log);
/* Runs whole frames of a Vulkan side, two at least, under its validation layer, and lists what no barrier orders. A comparison's own
 * run waits after each pass, which hides that. */
bool elsewhere_barriers(struct elsewhere *elsewhere, const struct worker_info *worker,
                        const struct dt_pipeline *pipeline);
/* Runs the worker that many times, with other numbers of threads where Mesa's software drivers can choose them, and counts the
 * distinct results of each pass in all its frames. */
bool elsewhere_repeat(struct elsewhere *elsewhere, const struct worker_info *worker,
                      const struct rows *rows, uint32_t runs);

void elsewhere_print(const struct elsewhere *elsewhere); /* on stdout, a line each */
void elsewhere_free(struct elsewhere *elsewhere);        /* takes a zeroed one */
