/* Executes the tables and steps of gen/lower/lower.h; see play.h. */
#include "spec/play.h"

#include "gen/plan/shadow.h"

/* The tables whose reflection this is. */
static const struct lowered *tables_of(const struct dt_pipeline *pipeline)
{
    return (const struct lowered *)((const char *)pipeline - offsetof(struct lowered, pipeline));
}

static void play_extent(const struct dt_pipeline *pipeline, uint32_t resource, uint32_t width,
                        uint32_t height, uint32_t extent[3])
{
    const struct model *model = tables_of(pipeline)->model;
    const struct pipeline *plan = &model->pipeline;
    int64_t size[3] = {1, 1, 1};
    for (int axis = 0; axis < 3 && resource < plan->resource_count; axis++) {
        const struct amount side = {.kind = AMOUNT_EXPR,
                                    .expr = resource_size(&plan->resources[resource], axis)};
        size[axis] = amount_value(&side, width, height, NULL);
    }
    uint64_t words = resource < plan->resource_count
                         ? shadow_words(model, &plan->resources[resource], width, height)
                         : 0;
    dt_set_extent(extent, words ? (int64_t)words : size[0], size[1], size[2]);
}

static uint64_t play_runs(const struct dt_pipeline *pipeline, uint32_t pass, uint32_t width,
                          uint32_t height, const void *live)
{
    int64_t count[3] = {0, 0, 0};
    for (int axis = 0; axis < 3 && pass < pipeline->pass_count; axis++)
        count[axis] =
            amount_value(&tables_of(pipeline)->passes[pass].runs[axis], width, height, live);
    return dt_product(count[0], count[1], count[2]);
}

static int64_t play_jitter(const struct dt_pipeline *pipeline, const void *live)
{
    const struct amount jitter = {.kind = AMOUNT_EXPR,
                                  .expr = tables_of(pipeline)->model->pipeline.jitter};
    return amount_value(&jitter, 0, 0, live);
}

static bool play_pass(const struct dt_recording *r, uint32_t index)
{
    const struct lowered_pass *pass = &((const struct lowered *)r->panel->plan)->passes[index];
    bool runs = true, good = true;
    for (uint32_t i = 0; i < pass->steps.count && good; i++) {
        const struct step *step = &pass->steps.list[i];
        int64_t a[4];
        if (step->when == (runs ? STEP_SKIPPED : STEP_RUNS))
            continue;
        for (int k = 0; k < 4; k++)
            a[k] = amount_value(&step->arguments[k], r->width, r->height, r->live);
        if (step->verb == DT_VERB_BEGIN)
            runs = a[0];
        good = dt_call(r->verbs, r->runtime, index, step->verb, a, pass->barriers);
    }
    return good;
}

static bool play_record(const struct dt_recording *r)
{
    for (uint32_t i = 0; i < r->panel->pipeline->pass_count; i++)
        if (!play_pass(r, i))
            return false;
    return true;
}

void play_prepare(struct lowered *tables)
{
    tables->pipeline.extent = play_extent;
    tables->pipeline.runs = play_runs;
    tables->pipeline.jitter = tables->model->pipeline.jitter ? play_jitter : NULL;
    tables->panel.record = play_record;
    tables->panel.plan = tables;
}
