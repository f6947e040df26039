/* The planned model as the tables that runtimes take (templates/c/panel.h), and what each pass
 * does as steps: calls of verbs. emit_panel.c and emit_pipeline.c print both as C; app/spec/play.c
 * executes them; graph and needs read the steps. */
#pragma once

#include "spirv/shaders.h"
#include "verbs.h"

/* A number that is known when a frame is recorded: an argument of a step, or a factor of a size. */
enum amount_kind {
    AMOUNT_NUMBER,
    AMOUNT_RESOURCE, /* `number`: index of a resource, or enum dt_builtin */
    AMOUNT_EXPR,     /* `expr`; NULL: 1. 0 where it has no value, which live parameters can cause */
    AMOUNT_IMAGE,    /* a side of `image`; `number`: the axis, 0 to 2 */
    AMOUNT_FRAME,    /* `number`: 0, the width, or 1, the height */
    AMOUNT_CONDITION /* whether `expr` is not 0; NULL: true */
};
enum amount_use {
    USE_ITSELF,
    USE_COUNT,
    USE_GROUPS,
    USE_TIMES
}; /* dt_count, dt_groups; a product */
struct amount {
    enum amount_kind kind;
    enum amount_use use;
    uint32_t number;
    const struct expr *expr;
    const struct resource *image;
    uint32_t local; /* dt_groups: invocations of a group; USE_TIMES: the factor */
};
/* `live`: NULL for the defaults. */
int64_t amount_value(const struct amount *amount, uint32_t width, uint32_t height,
                     const void *live);

enum step_when { STEP_ALWAYS, STEP_RUNS, STEP_SKIPPED }; /* runs: the argument of `begin` */
struct step {
    enum dt_verb verb;
    enum step_when when;
    struct amount arguments[4]; /* behind runtime and pass, as verbs.def has them */
};
struct steps {
    struct step *list; /* NULL: out of memory */
    uint32_t count;
};

struct lowered_pass {
    struct steps steps;
    struct amount runs[3];             /* factors of dt_pipeline.runs */
    const struct dt_barrier *barriers; /* pass->barrier_count of them */
};
struct lowered {
    const struct model *model;
    /* `target: auto`: the same pipeline as tables for GPUs; NULL: these. Not lower() sets it. */
    const struct lowered *gpu;
    struct dt_pipeline pipeline;  /* without extent, runs and jitter */
    struct dt_panel panel;        /* without record */
    struct dt_shaders shaders[2]; /* by enum backend */
    struct lowered_pass *passes;  /* in order of execution */
};

/* All tables, in the model's arena; they point into the model and the shaders' words. NULL: out of
 * memory. */
struct lowered *lower(const struct model *model, struct pass_shaders *const shaders[2]);

/* demands.c: what the shaders and the workgroup of a pass need, where the standards promise less;
 * else 0. False when out of memory. */
bool find_demands(const struct pass *pass, const struct pass_shaders *shaders,
                  uint64_t demands[DT_LIMITS]);

/* ---- steps.c: what a pass does --------------------------------------------------------------- */

bool pass_draws(const struct pass *pass);
const struct expr *resource_size(const struct resource *resource, int axis); /* NULL: 1 */
struct amount pass_runs(const struct pass *pass, int axis);
struct steps pass_steps(const struct pass *pass, struct arena *arena);
/* The step that draws or dispatches. */
const struct step *steps_work(const struct steps *steps);
