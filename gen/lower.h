/* The planned model as the tables that runtimes take (templates/c/panel.h). emit_panel.c and
 * emit_pipeline.c print them as C; app/spec/play.c executes them. Sizes, runs and the steps of a
 * pass are no tables: both use the functions below. Called by load.c. */
#ifndef DIPTYCH_GEN_LOWER_H
#define DIPTYCH_GEN_LOWER_H

#include "panel.h"
#include "stages.h"

/* The workgroups of a dispatch along one axis: dt_groups(of, divisor), where `of` is an expression or
 * the axis `of_axis` of an image or of the frame. GROUPS_NUMBER: the number `divisor`. */
enum groups_kind { GROUPS_NUMBER, GROUPS_EXPR, GROUPS_IMAGE, GROUPS_FRAME };
struct groups {
    enum groups_kind kind;
    const struct expr *expr;
    const struct resource *image;
    int of_axis;
    uint32_t divisor;
};

struct lowered {
    const struct model *model;
    struct dt_pipeline pipeline;  /* without extent, runs and jitter */
    struct dt_panel panel;        /* without record */
    struct dt_shaders shaders[2]; /* by enum backend */
    const struct dt_barrier *
        *barriers;              /* by pass in order of execution; pass->barrier_count of them */
    struct groups (*groups)[3]; /* of dispatches, by pass */
};

/* All tables, in the model's arena; they point into the model and the shaders' words. NULL: out of
 * memory. */
struct lowered *lower(const struct model *model, struct pass_shaders *const shaders[2]);

/* demands.c: what the shaders and the workgroup of a pass need, where the standards promise less;
 * else 0. False when out of memory. */
bool find_demands(const struct pass *pass, const struct pass_shaders *shaders,
                  uint64_t demands[DT_LIMITS]);
const char *demand_name(enum dt_device_limit limit); /* of the enumerator, behind DT_LIMIT_ */

/* ---- What a pass does ------------------------------------------------------------------------ */

bool pass_draws(const struct pass *pass);
const struct expr *resource_size(const struct resource *resource, int axis); /* NULL: 1 */

/* `axis`: 0 to 2. */
struct groups pass_groups(const struct pass *pass, int axis);

/* What a conditional pass clears when it does not run. pass_clears_targets: targets of a draw,
 * unless all load. pass_clears: the next other written access from index *at on; NULL: no more. */
bool pass_clears_targets(const struct pass *pass);
const struct access *pass_clears(const struct pass *pass, uint32_t *at);

#endif
