/* Follows gen/lower.h step by step, as gen/emit_panel.c prints it; see play.h. */
#include "build/play.h"

#include "gen/expr.h"

/* The tables whose reflection this is. */
static const struct lowered *tables_of(const struct dt_pipeline *pipeline)
{
    return (const struct lowered *)((const char *)pipeline - offsetof(struct lowered, pipeline));
}

/* ---- Numbers --------------------------------------------------------------------------------- */

/* A missing expression is 1. One that fails, which a live parameter may bring about, is 0. */
static int64_t value_of(const struct expr *expr, uint32_t width, uint32_t height, const void *live)
{
    int64_t value = 1;
    return expr && expr_eval_live(expr, width, height, live, &value) != EXPR_OK ? 0 : value;
}

static int64_t size_of(const struct resource *resource, int axis, uint32_t width, uint32_t height)
{
    return value_of(resource_size(resource, axis), width, height, NULL);
}

static void play_extent(const struct dt_pipeline *pipeline, uint32_t resource, uint32_t width,
                        uint32_t height, uint32_t extent[3])
{
    const struct pipeline *plan = &tables_of(pipeline)->model->pipeline;
    int64_t size[3] = {1, 1, 1};
    for (int axis = 0; axis < 3 && resource < plan->resource_count; axis++)
        size[axis] = size_of(&plan->resources[resource], axis, width, height);
    dt_set_extent(extent, size[0], size[1], size[2]);
}

static uint64_t play_runs(const struct dt_pipeline *pipeline, uint32_t index, uint32_t width,
                          uint32_t height, const void *live)
{
    const struct pipeline *plan = &tables_of(pipeline)->model->pipeline;
    const struct pass *pass = index < plan->pass_count ? plan->order[index] : NULL;
    uint32_t extent[3];
    int64_t count[3] = {1, 1, 1};
    if (!pass || pass->indirect_resource)
        return 0;
    if (pass->kind == DT_PASS_DRAW_VERTICES)
        return dt_product(value_of(pass->vertices, width, height, live),
                          value_of(pass->instances, width, height, live), 1);
    if (pass_draws(pass))
        return dt_product(value_of(pass->layers, width, height, live), 1, 1);
    if (pass->size == SIZE_INTERLEAVE)
        return dt_product(width, height, 1);
    if (pass->size == SIZE_IMAGE) {
        play_extent(pipeline, pass->size_resource->index, width, height, extent);
        return dt_product(extent[0], extent[1], extent[2]);
    }
    for (int axis = 0; axis < 3; axis++)
        count[axis] = value_of(pass->dispatch[axis], width, height, live) *
                      (pass->size == SIZE_GROUPS ? pass->local[axis] : 1);
    return dt_product(count[0], count[1], count[2]);
}

static int64_t play_jitter(const struct dt_pipeline *pipeline, const void *live)
{
    return value_of(tables_of(pipeline)->model->pipeline.jitter, 0, 0, live);
}

static uint32_t groups_of(const struct dt_recording *r, const struct pass *pass, int axis)
{
    const struct lowered *tables = r->panel->plan;
    const struct groups groups = tables->groups[pass->index][axis];
    switch (groups.kind) {
    case GROUPS_NUMBER:
        return groups.divisor;
    case GROUPS_EXPR:
        return dt_groups(value_of(groups.expr, r->width, r->height, r->live), groups.divisor);
    case GROUPS_IMAGE:
        return dt_groups(dt_size(size_of(groups.image, groups.of_axis, r->width, r->height)),
                         groups.divisor);
    case GROUPS_FRAME:
        return dt_groups(groups.of_axis == 0 ? r->width : r->height, groups.divisor);
    }
    return 0;
}

/* ---- One frame ------------------------------------------------------------------------------- */

static uint32_t layers_of(const struct dt_recording *r, const struct pass *pass)
{
    return (uint32_t)value_of(pass->layers, r->width, r->height, r->live);
}

static struct dt_rect rect_of(const struct dt_recording *r, struct expr *const rect[4])
{
    int64_t values[4];
    for (int i = 0; i < 4; i++)
        values[i] = value_of(rect[i], r->width, r->height, r->live);
    return dt_make_rect(values[0], values[1], values[2], values[3]);
}

static uint32_t count_of(const struct dt_recording *r, const struct expr *expr)
{
    return dt_count(value_of(expr, r->width, r->height, r->live));
}

static bool play_work(const struct dt_recording *r, const struct pass *pass)
{
    const struct dt_verbs *v = r->verbs;
    uint32_t index = pass->index;
    if (pass->viewport[0] && !v->viewport(r->runtime, index, rect_of(r, pass->viewport)))
        return false;
    if (pass->scissor[0] && !v->scissor(r->runtime, index, rect_of(r, pass->scissor)))
        return false;
    if (pass->kind == DT_PASS_DRAW_VERTICES && pass->indirect_resource)
        return v->draw_vertices_indirect(r->runtime, index, layers_of(r, pass),
                                         pass->indirect_resource->index);
    if (pass->kind == DT_PASS_DRAW_VERTICES)
        return v->draw_vertices(r->runtime, index, layers_of(r, pass), count_of(r, pass->vertices),
                                count_of(r, pass->instances));
    if (pass->kind == DT_PASS_DRAW_FULLSCREEN)
        return v->draw_fullscreen(r->runtime, index, layers_of(r, pass));
    if (pass->kind == DT_PASS_DRAW_SCENE && !pass->indirect_resource)
        return v->draw_scene(r->runtime, index, layers_of(r, pass));
    if (pass->kind == DT_PASS_DRAW_SCENE)
        return v->draw_indirect(r->runtime, index, layers_of(r, pass),
                                pass->index_resource ? pass->index_resource->index
                                                     : (uint32_t)DT_SCENE_INDICES,
                                pass->indirect_resource->index);
    if (pass->size == SIZE_INDIRECT)
        return v->dispatch_indirect(r->runtime, index, pass->indirect_resource->index);
    return v->dispatch(r->runtime, index, groups_of(r, pass, 0), groups_of(r, pass, 1),
                       groups_of(r, pass, 2));
}

/* What a pass that does not run leaves cleared. */
static bool play_clears(const struct dt_recording *r, const struct pass *pass)
{
    const struct dt_verbs *v = r->verbs;
    const struct access *access;
    uint32_t at = 0;
    if (pass_draws(pass) && pass_clears_targets(pass) &&
        !v->clear_targets(r->runtime, pass->index, layers_of(r, pass)))
        return false;
    while ((access = pass_clears(pass, &at))) {
        uint32_t resource = access->resource->index;
        if (!(access->resource->kind == DT_IMAGE
                  ? v->clear_image(r->runtime, pass->index, resource, access->mip_value)
                  : v->clear_buffer(r->runtime, pass->index, resource)))
            return false;
    }
    return true;
}

static bool play_pass(const struct dt_recording *r, const struct pass *pass,
                      const struct dt_barrier *barriers)
{
    const struct dt_verbs *v = r->verbs;
    bool runs = !pass->conditional || value_of(pass->when, r->width, r->height, r->live) != 0;
    return v->begin(r->runtime, pass->index, runs) &&
           (!pass->barrier_count ||
            v->barriers(r->runtime, pass->index, barriers, pass->barrier_count)) &&
           (runs ? v->bind(r->runtime, pass->index) && play_work(r, pass) : play_clears(r, pass)) &&
           v->end(r->runtime, pass->index);
}

static bool play_record(const struct dt_recording *r)
{
    const struct lowered *tables = r->panel->plan;
    const struct pipeline *plan = &tables->model->pipeline;
    for (uint32_t i = 0; i < plan->pass_count; i++)
        if (!play_pass(r, plan->order[i], tables->barriers[i]))
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
