/* Everything that is verified before planning: called by main after read. All checks run, whatever
 * the others found, so that a wrong spec gets all its errors at once. */
#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "stages.h"

#define FIND(c, array, number, name)                                                               \
    do {                                                                                           \
        for (uint32_t i = 0; i < (c)->pipeline->number; i++)                                       \
            if (!strcmp((c)->pipeline->array[i].name, name))                                       \
                return &(c)->pipeline->array[i];                                                   \
        return NULL;                                                                               \
    } while (0)

struct resource *find_resource(const struct checker *c, const char *name)
{
    FIND(c, resources, resource_count, name);
}

struct structure *find_struct(const struct checker *c, const char *name)
{
    FIND(c, structs, struct_count, name);
}

struct sampler *find_sampler(const struct checker *c, const char *name)
{
    FIND(c, samplers, sampler_count, name);
}

struct metric *find_metric(const struct checker *c, const char *name)
{
    FIND(c, metrics, metric_count, name);
}

struct interleave *find_interleave(const struct checker *c, const char *name)
{
    FIND(c, interleaves, interleave_count, name);
}

struct pass *find_pass(const struct checker *c, const char *name)
{
    FIND(c, passes, pass_count, name);
}

void report_missing(const struct checker *c, struct loc loc, const char *what, const char *name,
                    const char *const *names, size_t count)
{
    const char *nearest = diag_nearest(name, names, count);
    if (nearest)
        diag_error(c->diag, loc, "no %s `%s`; did you mean `%s`?", what, name, nearest);
    else
        diag_error(c->diag, loc, "no %s `%s`", what, name);
}

/* Takes a pass's name out of every `after`. */
static void forget_pass(struct pipeline *pipeline, const char *name)
{
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        struct pass *pass = &pipeline->passes[i];
        uint32_t kept = 0;
        for (uint32_t k = 0; k < pass->after_count; k++)
            if (strcmp(pass->after[k], name)) {
                pass->after[kept] = pass->after[k];
                pass->after_locs[kept++] = pass->after_locs[k];
            }
        pass->after_count = kept;
    }
}

/* Drawings tell what was left out. */
static void drop_pass(struct checker *c, const struct pass *pass)
{
    struct pass *copy = arena_alloc(c->model->arena, sizeof *copy);
    if (copy && c->pipeline->dropped) {
        *copy = *pass;
        c->pipeline->dropped[c->pipeline->dropped_count++] = copy;
    }
    forget_pass(c->pipeline, pass->name);
}

/* A pass whose condition is false for good does not exist for the later stages. */
static void drop_passes(struct checker *c)
{
    struct pipeline *pipeline = c->pipeline;
    uint32_t kept = 0;
    pipeline->dropped =
        arena_alloc(c->model->arena, (pipeline->pass_count + 1) * sizeof *pipeline->dropped);
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        int64_t value = 1;
        struct pass *pass = &pipeline->passes[i];
        bool baked = pass->when && expr_reach(pass->when) == EXPR_BAKED;
        if (baked && expr_eval(pass->when, 1, 1, &value) == EXPR_OK && !value)
            drop_pass(c, pass);
        else
            pipeline->passes[kept++] = *pass;
    }
    if (!kept)
        diag_error(c->diag, pipeline->loc, "no pass of `%s` ever runs: every `when` is 0",
                   pipeline->name);
    pipeline->pass_count = kept;
}

bool check_model(struct model *model, const char *templates_dir, struct diag *diag)
{
    struct checker c = {
        .model = model, .pipeline = &model->pipeline, .diag = diag, .templates_dir = templates_dir};
    c.bodies = calloc(model->pipeline.pass_count + 1, sizeof *c.bodies);
    c.out_of_memory = !c.bodies;
    check_names(&c);
    check_params(&c);
    check_constants(&c);
    check_references(&c);
    check_sizes(&c);
    check_passes(&c);
    check_contracts(&c);
    if (c.bodies)
        check_bodies(&c);
    check_asserts(&c);
    if (c.bodies && !diag_error_count(diag)) /* behind an error, what is unused may be its victim */
        check_unused(&c);
    for (uint32_t i = 0; c.bodies && i < model->pipeline.pass_count; i++)
        free(c.bodies[i].tokens);
    free(c.bodies);
    free(c.exprs);
    if (c.out_of_memory)
        diag_error(diag, (struct loc){0}, "out of memory");
    if (!diag_error_count(diag))
        drop_passes(&c);
    return !diag_error_count(diag);
}
