/* All checks before planning; called by load.c after read. A check runs also after
 * errors of others, so that a wrong spec gets all its errors at once. */
#include "checks.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"

void report_missing(const struct checker *c, struct loc loc, const char *what, const char *name,
                    unsigned kinds)
{
    diag_error(c->diag, loc, "no %s `%s`%s", what, name,
               declared_hint(c->pipeline, kinds, name, "").text);
}

/* Removes a pass's name from every `after`. */
static void forget_pass(struct pipeline *pipeline, const char *name)
{
    CHANGE_EACH(pass, pipeline->passes, pipeline->pass_count) {
        uint32_t kept = 0;
        for (uint32_t k = 0; k < pass->after_count; k++)
            if (strcmp(pass->after[k], name)) {
                pass->after[kept] = pass->after[k];
                pass->after_locs[kept++] = pass->after_locs[k];
            }
        pass->after_count = kept;
    }
}

/* Keeps a copy of the pass, because drawings show dropped passes. */
static void drop_pass(struct checker *c, const struct pass *pass)
{
    struct pass *copy = arena_alloc(c->model->arena, sizeof *copy);
    if (copy && c->pipeline->dropped) {
        *copy = *pass;
        c->pipeline->dropped[c->pipeline->dropped_count++] = copy;
    }
    forget_pass(c->pipeline, pass->name);
}

bool pass_writes(const struct pass *pass, const struct resource *resource)
{
    EACH(access, pass->accesses, pass->access_count)
        if (access->resource == resource && access->mode != MODE_READ)
            return true;
    return false;
}

/* Whether `user` is of a mip that `writer` writes. */
static bool sees(const struct access *user, const struct access *writer)
{
    bool all_mips = user->filter && !user->mip;
    return user->resource == writer->resource && (all_mips || user->mip_value == writer->mip_value);
}

/* Whether a kept pass needs what `writer` clears if its pass is skipped: it reads or updates that,
 * and no kept pass writes it anew. */
static bool is_needed(const struct pipeline *pipeline, const bool *kept,
                      const struct access *writer)
{
    bool read = false, written = false;
    for (uint32_t k = 0; k < pipeline->pass_count; k++) {
        const struct pass *other = &pipeline->passes[k];
        if (!kept[k])
            continue;
        read |= other->indirect_resource == writer->resource ||
                other->index_resource == writer->resource;
        EACH(access, other->accesses, other->access_count) {
            bool anew = access->mode == MODE_WRITE;
            written |= anew && sees(access, writer);
            read |= !anew && sees(access, writer);
        }
    }
    return read && !written;
}

static bool is_missed(const struct pipeline *pipeline, const bool *kept, const struct pass *pass)
{
    EACH(access, pass->accesses, pass->access_count)
        if (access->resource && access->mode == MODE_WRITE && is_needed(pipeline, kept, access))
            return true;
    return false;
}

static bool is_false_for_good(const struct pass *pass)
{
    int64_t value = 1;
    return pass->when && expr_reach(pass->when) == EXPR_BAKED &&
           expr_eval(pass->when, 1, 1, &value) == EXPR_OK && !value;
}

/* Removes passes whose condition is always false, unless a kept pass needs their clear values. A
 * pass that stays may itself read what another such pass clears, so this repeats. */
static void drop_passes(struct checker *c)
{
    struct pipeline *pipeline = c->pipeline;
    uint32_t count = 0, all = pipeline->pass_count;
    bool *kept = arena_alloc(c->model->arena, (all + 1) * sizeof *kept);
    pipeline->dropped = arena_alloc(c->model->arena, (all + 1) * sizeof *pipeline->dropped);
    if (!kept)
        return;
    for (uint32_t i = 0; i < all; i++)
        count += kept[i] = !is_false_for_good(&pipeline->passes[i]);
    if (!count)
        diag_error(c->diag, pipeline->loc, "no pass of `%s` ever runs: every `when` is 0",
                   pipeline->name);
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t i = 0; i < all; i++)
            if (!kept[i] && is_missed(pipeline, kept, &pipeline->passes[i]))
                kept[i] = changed = true;
    }
    for (uint32_t i = 0; i < all; i++)
        if (!kept[i])
            drop_pass(c, &pipeline->passes[i]);
    pipeline->pass_count = 0;
    for (uint32_t i = 0; i < all; i++)
        if (kept[i])
            pipeline->passes[pipeline->pass_count++] = pipeline->passes[i];
}

bool check_model(struct model *model, const char *templates_dir, struct diag *diag)
{
    struct checker c = {
        .model = model, .pipeline = &model->pipeline, .diag = diag, .templates_dir = templates_dir};
    check_names(&c);
    check_params(&c);
    check_constants(&c);
    check_references(&c);
    check_sizes(&c);
    check_jitter(&c);
    check_passes(&c);
    check_content(&c);
    check_contracts(&c);
    check_bodies(&c);
    check_asserts(&c);
    if (!diag_error_count(diag)) /* after an error, used names may look unused */
        check_unused(&c);
    free(c.exprs);
    if (c.out_of_memory)
        diag_error(diag, (struct loc){0}, "out of memory");
    if (!diag_error_count(diag))
        drop_passes(&c);
    return !diag_error_count(diag);
}
