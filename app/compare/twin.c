/* Passes beside their exact twins; see twin.h. */
#include "compare/twin.h"

#include <stdlib.h>
#include <string.h>

#include "spec/inputs.h"

struct judging {
    struct twin *twin;
    const struct rows *rows;
    const struct plan *plan;
    const struct dt_log *log;
    uint32_t frame;
};

bool twin_is_needed(const struct pipeline *pipeline)
{
    for (uint32_t i = 0; i < pipeline->info->pass_count; i++)
        if (plan_is_bounded(pipeline->plan, i))
            return true;
    return false;
}

bool twin_load(struct pipeline *exact, const struct pipeline *pipeline, struct console *console,
               const struct setup *setup)
{
    struct setup own = *setup;
    own.exact_twin = true;
    if (!pipeline_load(exact, console, &own) || !inputs_load(exact, console, &own))
        return false;
    memcpy(exact->live, pipeline->live, pipeline->info->live_size);
    return true;
}

static bool weigh(void *user, uint32_t index, const struct dt_bytes copies[2])
{
    struct judging *judging = user;
    struct twin *twin = judging->twin;
    const struct row *row = &judging->rows->outputs.list[index];
    struct dt_resource resource = judging->rows->pipeline->resources[row->resource];
    if (!plan_is_bounded(judging->plan, row->pass))
        return true;
    if (resource.contract.kind == DT_CONTRACT_OF_EXACT) { /* which is for two copies that may err */
        resource.contract.tolerance /= 2;
        resource.contract.outliers /= 2;
    }
    if (!difference_measure(&twin->found[index], &resource, judging->frame, copies) ||
        !errors_add(&twin->errors[index], &resource, copies)) {
        report_error(judging->log, "out of memory");
        return false;
    }
    if (!twin->broken && difference_verdict(&twin->found[index]) == VERDICT_DIFFERS) {
        twin->broken = true;
        twin->row = index;
    }
    return true;
}

bool twin_judge(struct twin *twin, const struct worker_info *worker, const struct pipeline *exact,
                const struct rows *rows, uint32_t frame)
{
    struct console *console = worker->session.console;
    struct judging judging = {.twin = twin,
                              .rows = rows,
                              .plan = worker->session.pipeline->plan,
                              .log = &console->log,
                              .frame = frame};
    struct replay replay = {
        .console = console, .rows = rows, .workers = {*worker, *worker}, .frame = frame};
    const struct replay_viewer viewer = {.output = weigh, .user = &judging};
    replay.workers[1].session.pipeline = exact;
    replay.workers[1].session.fault = (struct fault){0};
    twin->found = calloc(rows->outputs.count + 1, sizeof *twin->found);
    twin->errors = calloc(rows->outputs.count + 1, sizeof *twin->errors);
    if (!twin->found || !twin->errors)
        report_error(&console->log, "out of memory");
    return twin->found && twin->errors && replay_run(&replay, &viewer);
}

void twin_free(struct twin *twin)
{
    free(twin->found);
    free(twin->errors);
    *twin = (struct twin){0};
}
