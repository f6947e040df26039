/* Passes beside their exact twins; see twin.h. */
#include "compare/twin.h"

#include <stdlib.h>
#include <string.h>

#include "spec/inputs.h"

struct judging {
    struct twin *twin;
    const struct rows *rows;
    const struct sheet_row *results;
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
    const struct sheet_row *result = &judging->results[index];
    struct dt_resource resource = *result->resource;
    if (!plan_is_bounded(judging->plan, judging->rows->outputs.list[index].pass))
        return true;
    struct sheet_row *row = &twin->sheet.rows[twin->sheet.count++];
    *row = (struct sheet_row){.pass = result->pass,
                              .name = result->name,
                              .key = result->key,
                              .resource = result->resource,
                              .mip = result->mip,
                              .frame = judging->frame,
                              .compared = true,
                              .body = result->body,
                              .errors = calloc(1, sizeof *row->errors)};
    if (resource.contract.kind == DT_CONTRACT_OF_EXACT) { /* which is for two copies that may err */
        resource.contract.tolerance /= 2;
        resource.contract.outliers /= 2;
    }
    if (!row->errors || !difference_measure(&row->difference, &resource, judging->frame, copies) ||
        !errors_add(&row->errors->exact, &resource, copies))
        return report_error(judging->log, "out of memory");
    if (!twin->broken && difference_verdict(&row->difference) == VERDICT_DIFFERS)
        twin->broken = row;
    return true;
}

bool twin_judge(struct twin *twin, const struct worker_info *worker, const struct pipeline *exact,
                const struct rows *rows, const struct sheet_row *results, uint32_t frame)
{
    struct console *console = worker->session.console;
    struct judging judging = {.twin = twin,
                              .rows = rows,
                              .results = results,
                              .plan = worker->session.pipeline->plan,
                              .log = &console->log,
                              .frame = frame};
    struct replay replay = {
        .console = console, .rows = rows, .workers = {*worker, *worker}, .frame = frame};
    const struct replay_viewer viewer = {.output = weigh, .user = &judging};
    replay.workers[1].session.pipeline = exact;
    twin->sheet = (struct sheet){.pipeline = rows->pipeline->name,
                                 .labels = {worker->session.side->label, "exact"}};
    return sheet_begin(&twin->sheet, rows->outputs.count, &console->log) &&
           replay_run(&replay, &viewer);
}

void twin_free(struct twin *twin)
{
    sheet_free(&twin->sheet);
    *twin = (struct twin){0};
}
