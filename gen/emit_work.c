/* What a pass has to do at least, for the reflection: how often its shader runs, and the float
 * arithmetic of one run. Called by emit_pipeline.c. */
#include <inttypes.h>
#include <string.h>

#include "emit_c.h"

/* ---- How often ------------------------------------------------------------------------------- */

static void emit_factor(struct text *out, const struct expr *expr, uint32_t local)
{
    if (expr) {
        c_expr(out, expr, 1);
    } else {
        text_add(out, "1");
    }
    if (local > 1) {
        text_add(out, " * %" PRIu32, local);
    }
}

/* The three factors; one invocation per texel needs the extent of its image. */
static void emit_factors(const struct pass *pass, struct text *out)
{
    if (pass_draws(pass)) {
        emit_factor(out, pass->layers, 1);
        text_add(out, ", 1, 1");
    } else if (pass->size == SIZE_IMAGE) {
        text_add(out, "extent[0], extent[1], extent[2]");
    } else if (pass->size == SIZE_INTERLEAVE) {
        text_add(out, "width, height, 1"); /* every pixel is of one class */
    } else {
        for (int axis = 0; axis < 3; axis++) {
            text_add(out, axis ? ", " : "");
            emit_factor(out, pass->dispatch[axis],
                        pass->size == SIZE_GROUPS ? pass->local[axis] : 1);
        }
    }
}

static bool is_indirect(const struct pass *pass)
{
    return pass->indirect_resource != NULL;
}

static void emit_runs(const struct c_output *c, const struct pass *pass)
{
    struct text factors = {0}, locals = {0};
    const char *name = c->pipeline->name;
    bool image = !pass_draws(pass) && pass->size == SIZE_IMAGE;

    emit_factors(pass, &factors);
    c_size_locals(&locals, factors.data, "frame_width", "frame_height");
    bool live = factors.data && strstr(factors.data, "live->");

    if (live) {
        text_add(&locals, "    const struct %s_live *live = live_block;\n", name);
    }
    if (image) {
        text_add(&locals, "    uint32_t extent[3];\n");
    }
    text_add(c->out,
             "static uint64_t runs_%s(uint32_t frame_width, uint32_t frame_height, "
             "const void *live_block)\n{\n%s%s    (void)frame_width;\n"
             "    (void)frame_height;\n    (void)live_block;\n",
             pass->name, locals.data ? locals.data : "", locals.data ? "\n" : "");
    if (image) {
        text_add(c->out, "    %s_extent_%s(frame_width, frame_height, extent);\n", name,
                 pass->size_resource->name);
    }
    text_add(c->out, "    return product(%s);\n}\n\n", factors.data ? factors.data : "");
    c->out->failed |= factors.failed | locals.failed;
    text_free(&factors);
    text_free(&locals);
}

void emit_runs_functions(const struct c_output *c)
{
    bool any = false;

    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        any |= !is_indirect(c->pipeline->order[i]);
    }
    if (any) {
        text_add(c->out, "\nstatic uint64_t product(int64_t x, int64_t y, int64_t z)\n{\n"
                         "    return x < 1 || y < 1 || z < 1 ? 0 : (uint64_t)(x * y * z);\n}\n\n");
    }
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        if (!is_indirect(c->pipeline->order[i])) {
            emit_runs(c, c->pipeline->order[i]);
        }
    }
}

/* ---- How much -------------------------------------------------------------------------------- */

static void emit_flops(const struct c_output *c, const struct shader *shader)
{
    uint64_t flops = 0;

    if (!count_flops(shader, &flops)) {
        c->out->failed = true;
    }
    text_add(c->out, "%" PRIu64, flops);
}

void emit_work(const struct c_output *c, const struct pass *pass)
{
    const struct shader *stages = c->shaders[pass->index].stage;

    if (pass->limit) {
        text_add(c->out, "        .limit = ");
        c_string(c->out, pass->limit);
        text_add(c->out, ",\n");
    }
    if (!is_indirect(pass)) {
        text_add(c->out, "        .runs = runs_%s,\n", pass->name);
    }
    text_add(c->out, "        .flops = {");
    emit_flops(c, &stages[pass_draws(pass) ? STAGE_IS_VERTEX : STAGE_IS_COMPUTE]);
    if (pass_draws(pass)) {
        text_add(c->out, ", ");
        emit_flops(c, &stages[STAGE_IS_FRAGMENT]);
    }
    text_add(c->out, "},\n");
}

void emit_limit(const struct pass *pass, struct text *out)
{
    text_add(out, "#line 1 ");
    c_string(out, pass->limit);
    text_add(out, "\n");
    text_add_bytes(out, pass->limit_body->text, pass->limit_body->length);
}
