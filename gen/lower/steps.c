/* What a pass does, as steps: the calls of verbs and their arguments. See lower.h.
 *
 * The list of a pass is the whole truth about its recording: NAME.c is printed from it, play.c
 * calls it; the graph, --needs and `diptych list` read it. What is not a step happens in no
 * backend.
 *
 * Its shape: `begin` with whether the pass runs, `barriers`, what it does if it runs, what it does
 * if it is skipped, `end`. Barriers stand outside of the condition: later passes rely on them
 * whether the pass runs or not. A skipped pass clears what it would have written whole, so later
 * passes read the clear value, not what another user left in the memory.
 *
 * An argument is an amount, not a number: live parameters and the frame's size are known only when
 * a frame is recorded. An amount is not an expression either, since verbs take counts that C rounds
 * and clamps in one place (dt_count, dt_groups, dt_size of templates/c): c_amount prints these
 * calls, and amount_value makes them. Both must give the same number; tests/app/play_test.c records
 * pipelines both ways. */
#include "model/expr.h"
#include "lower.h"
#include "plan/plan.h"

bool pass_draws(const struct pass *pass)
{
    return pass->kind != DT_PASS_DISPATCH;
}

const struct expr *resource_size(const struct resource *resource, int axis)
{
    const struct expr *const image[3] = {resource->width, resource->height, resource->layers};
    return resource->kind == DT_IMAGE ? image[axis] : axis == 0 ? resource->count : NULL;
}

/* ---- Amounts --------------------------------------------------------------------------------- */

static struct amount number(uint32_t number)
{
    return (struct amount){.kind = AMOUNT_NUMBER, .number = number};
}

static struct amount resource(uint32_t index)
{
    return (struct amount){.kind = AMOUNT_RESOURCE, .number = index};
}

static struct amount value(const struct expr *expr, enum amount_use use, uint32_t local)
{
    return (struct amount){.kind = AMOUNT_EXPR, .use = use, .expr = expr, .local = local};
}

/* A side of the image, or of the frame for NULL. */
static struct amount side(const struct resource *image, int axis, enum amount_use use,
                          uint32_t local)
{
    return (struct amount){
        image ? AMOUNT_IMAGE : AMOUNT_FRAME, use, (uint32_t)axis, NULL, image, local};
}

static int64_t evaluate_amount(const struct expr *expr, uint32_t width, uint32_t height,
                               const void *live)
{
    int64_t result = 1;
    return expr && expr_eval_live(expr, width, height, live, &result) != EXPR_OK ? 0 : result;
}

int64_t amount_value(const struct amount *amount, uint32_t width, uint32_t height, const void *live)
{
    int64_t result = amount->number;
    if (amount->kind == AMOUNT_EXPR || amount->kind == AMOUNT_CONDITION)
        result = evaluate_amount(amount->expr, width, height, live);
    else if (amount->kind == AMOUNT_IMAGE)
        result = dt_size(evaluate_amount(resource_size(amount->image, (int)amount->number), width,
                                         height, NULL));
    else if (amount->kind == AMOUNT_FRAME)
        result = amount->number ? height : width;
    switch (amount->use) {
    case USE_COUNT:
        return dt_count(result);
    case USE_GROUPS:
        return dt_groups(result, amount->local);
    case USE_TIMES:
        return result * amount->local;
    case USE_ITSELF:
        break;
    }
    return amount->kind == AMOUNT_CONDITION ? result != 0 : result;
}

/* ---- Sizes of dispatches --------------------------------------------------------------------- */

/* Workgroups of a dispatch along an axis. */
static struct amount groups(const struct pass *pass, int axis)
{
    uint32_t local = pass->size == SIZE_GROUPS ? 1 : pass->local[axis];
    const struct expr *expr = pass->dispatch[axis];
    if (pass->size == SIZE_IMAGE)
        return axis == 2 && !pass->size_resource->layers
                   ? number(1)
                   : side(pass->size_resource, axis, USE_GROUPS, local);
    if (pass->size == SIZE_INTERLEAVE) {
        /* A group covers `local` pixels of a class; a class has each tile-th pixel of the frame.
         * Groups of all classes follow each other: they read the same lines of the caches. */
        const uint32_t *tile = pass->interleave->tile;
        int of = axis - 1;
        return axis == 0 ? number(tile[0] * tile[1])
                         : side(NULL, of, USE_GROUPS, tile[of] * pass->local[of]);
    }
    if (expr && expr_reach(expr) != EXPR_BAKED)
        return value(expr, USE_GROUPS, local);
    return number(dt_groups(expr_at_reference(expr, 1), local));
}

struct amount pass_runs(const struct pass *pass, int axis)
{
    const struct expr *vertices[] = {pass->vertices, pass->instances, NULL};
    if (pass->indirect_resource)
        return number(0);
    if (pass->kind == DT_PASS_DRAW_VERTICES)
        return value(vertices[axis], USE_ITSELF, 1);
    if (pass_draws(pass))
        return value(axis == 0 ? pass->layers : NULL, USE_ITSELF, 1);
    if (pass->size == SIZE_IMAGE)
        return side(pass->size_resource, axis, USE_ITSELF, 1);
    if (pass->size == SIZE_INTERLEAVE)
        return axis < 2 ? side(NULL, axis, USE_ITSELF, 1) : number(1);
    bool times = pass->size == SIZE_GROUPS && pass->local[axis] > 1;
    return value(pass->dispatch[axis], times ? USE_TIMES : USE_ITSELF, pass->local[axis]);
}

/* ---- Steps ----------------------------------------------------------------------------------- */

static void add_rect(struct steps *steps, enum step_when when, enum dt_verb verb,
                     struct expr *const rect[4])
{
    struct step *step = &steps->list[steps->count];
    if (!rect[0])
        return;
    *step = (struct step){verb, when, {{0}}};
    for (int i = 0; i < 4; i++)
        step->arguments[i] = value(rect[i], USE_ITSELF, 1);
    steps->count++;
}

static struct step work_of(const struct pass *pass, enum step_when when)
{
    const struct resource *indirect = pass->indirect_resource, *indices = pass->index_resource;
    struct amount arguments = resource(indirect ? indirect->index : 0);
    struct amount layers = value(pass->layers, USE_ITSELF, 1);
    switch (pass->kind) {
    case DT_PASS_DRAW_FULLSCREEN:
        return (struct step){DT_VERB_DRAW_FULLSCREEN, when, {layers}};
    case DT_PASS_DRAW_VERTICES:
        if (indirect)
            return (struct step){DT_VERB_DRAW_VERTICES_INDIRECT, when, {layers, arguments}};
        return (struct step){
            DT_VERB_DRAW_VERTICES,
            when,
            {layers, value(pass->vertices, USE_COUNT, 1), value(pass->instances, USE_COUNT, 1)}};
    case DT_PASS_DRAW_SCENE:
        if (!indirect)
            return (struct step){DT_VERB_DRAW_SCENE, when, {layers}};
        return (struct step){
            DT_VERB_DRAW_INDIRECT,
            when,
            {layers, resource(indices ? indices->index : DT_SCENE_INDICES), arguments}};
    case DT_PASS_DISPATCH:
        break;
    }
    if (indirect)
        return (struct step){DT_VERB_DISPATCH_INDIRECT, when, {arguments}};
    return (struct step){
        DT_VERB_DISPATCH, when, {groups(pass, 0), groups(pass, 1), groups(pass, 2)}};
}

/* What a pass clears that does not run: targets that it would not load, and all else that it would
 * write. */
static void add_clears(struct steps *steps, const struct pass *pass)
{
    const unsigned target = DT_WRITE_COLOR | DT_WRITE_DEPTH;
    bool targets = false;
    EACH(access, pass->accesses, pass->access_count)
        targets |= access->kind & target && access->mode == MODE_WRITE;
    if (targets)
        steps->list[steps->count++] = (struct step){
            DT_VERB_CLEAR_TARGETS, STEP_SKIPPED, {value(pass->layers, USE_ITSELF, 1)}};
    EACH(access, pass->accesses, pass->access_count) {
        if (!access->resource || access->mode != MODE_WRITE || access->kind & target ||
            access->clears)
            continue;
        bool image = access->resource->kind == DT_IMAGE;
        steps->list[steps->count++] =
            (struct step){image ? DT_VERB_CLEAR_IMAGE : DT_VERB_CLEAR_BUFFER,
                          STEP_SKIPPED,
                          {resource(access->resource->index), number(access->mip_value)}};
    }
}

struct steps pass_steps(const struct pass *pass, struct arena *arena)
{
    enum { MOST = 8 }; /* without clears of accesses */
    struct steps steps = {arena_alloc(arena, (MOST + pass->access_count) * sizeof *steps.list), 0};
    enum step_when when = pass->conditional ? STEP_RUNS : STEP_ALWAYS;
    if (!steps.list)
        return steps;
    const struct amount runs = pass->conditional
                                   ? (struct amount){.kind = AMOUNT_CONDITION, .expr = pass->when}
                                   : (struct amount){.kind = AMOUNT_CONDITION};
    steps.list[steps.count++] = (struct step){DT_VERB_BEGIN, STEP_ALWAYS, {runs}};
    if (pass->barrier_count)
        steps.list[steps.count++] =
            (struct step){DT_VERB_BARRIERS, STEP_ALWAYS, {number(pass->barrier_count)}};
    EACH(access, pass->accesses, pass->access_count)
        if (access->clears)
            steps.list[steps.count++] = (struct step){
                DT_VERB_CLEAR_BUFFER, STEP_ALWAYS, {resource(access->resource->index)}};
    steps.list[steps.count++] = (struct step){DT_VERB_BIND, when, {{0}}};
    add_rect(&steps, when, DT_VERB_VIEWPORT, pass->viewport);
    add_rect(&steps, when, DT_VERB_SCISSOR, pass->scissor);
    steps.list[steps.count++] = work_of(pass, when);
    if (pass->conditional)
        add_clears(&steps, pass);
    steps.list[steps.count++] = (struct step){DT_VERB_END, STEP_ALWAYS, {{0}}};
    return steps;
}

const struct step *steps_work(const struct steps *steps)
{
    const struct step *step = steps->list;
    while (step->verb < DT_VERB_DISPATCH || step->verb > DT_VERB_DRAW_VERTICES_INDIRECT)
        step++;
    return step;
}
