/* The reflection, first half of NAME.c: sizes, parameters, resources, passes. Printed from the
 * tables of lower.h. */
#include <string.h>

#include "emit_c.h"
#include "plan/sanitize.h"
#include "lower/members.h"
#include "plan/shadow.h"

/* ---- Sizes and runs -------------------------------------------------------------------------- */

/* Labels that stand one after the other where the statements below them are the same: `body` prints
 * those of one of them, or nothing for one without a label. */
static void emit_cases(const struct c_output *c, uint32_t count,
                       void (*label)(const struct c_output *c, uint32_t index),
                       void (*body)(const struct c_output *c, uint32_t index))
{
    struct text *bodies = arena_alloc(c->model->arena, (count + 1) * sizeof *bodies);
    for (uint32_t i = 0; bodies && i < count; i++) {
        struct c_output inner = *c;
        inner.out = &bodies[i];
        body(&inner, i);
        c->out->failed |= bodies[i].failed;
    }
    for (uint32_t i = 0; bodies && i < count; i++) {
        bool earlier = false;
        for (uint32_t k = 0; bodies[i].data && k < i; k++)
            earlier |= bodies[k].data && !strcmp(bodies[k].data, bodies[i].data);
        for (uint32_t k = i; bodies[i].data && !earlier && k < count; k++) {
            if (!bodies[k].data || strcmp(bodies[k].data, bodies[i].data))
                continue;
            text_add(c->out, "    case ");
            label(c, k);
            text_add(c->out, ":\n");
        }
        if (bodies[i].data && !earlier)
            text_add(c->out, "%s", bodies[i].data);
    }
    for (uint32_t i = 0; bodies && i < count; i++)
        text_free(&bodies[i]);
}

static void emit_size(const struct c_output *c, uint32_t index)
{
    const struct resource *resource = &c->pipeline->resources[index];
    text_add(c->out, "        dt_set_extent(size, ");
    if (shadow_emit_c(c->model, resource, c->out))
        text_add(c->out, ", 1, 1");
    else
        c_add(c, "@E, @E, @E", resource_size(resource, 0), resource_size(resource, 1),
              resource_size(resource, 2));
    text_add(c->out, ");\n        break;\n");
}

static void emit_extent(const struct c_output *c)
{
    text_add(c->out, "static void extent(const struct dt_pipeline *pipeline, uint32_t resource, "
                     "uint32_t width, uint32_t height, uint32_t size[3])\n{\n"
                     "    (void)pipeline, (void)width, (void)height;\n    switch (resource) {\n");
    emit_cases(c, c->pipeline->resource_count, c_resource, emit_size);
    text_add(c->out, "    default:\n        dt_set_extent(size, 1, 1, 1);\n    }\n}\n\n");
}

static void emit_run(const struct c_output *c, uint32_t index)
{
    const struct amount *runs = c->tables->passes[index].runs;
    if (c->pipeline->order[index]->indirect_resource)
        return;
    if (runs->kind == AMOUNT_IMAGE)
        c_add(c, "        extent(pipeline, @R, width, height, size);\n", runs->image->index);
    text_add(c->out, "        return dt_product(");
    for (int axis = 0; axis < 3; axis++) {
        text_add(c->out, axis ? ", " : "");
        c_amount(c, &runs[axis]);
    }
    text_add(c->out, ");\n");
}

/* Declares `live` for a body that names it. */
static void emit_live(const struct c_output *c, const struct text *body)
{
    if (body->data && strstr(body->data, "live->"))
        c_add(c, "    const struct @n_live *live = live_block;\n");
}

static void emit_runs(const struct c_output *c)
{
    struct text body = {0};
    struct c_output inner = *c;
    inner.out = &body;
    emit_cases(&inner, c->pipeline->pass_count, c_pass, emit_run);
    c_add(c, "static uint64_t runs(const struct dt_pipeline *pipeline, uint32_t pass, "
             "uint32_t width, uint32_t height, const void *live_block)\n{\n");
    emit_live(c, &body);
    if (body.data && strstr(body.data, "size["))
        c_add(c, "    uint32_t size[3];\n");
    c_add(c,
          "    (void)pipeline, (void)width, (void)height, (void)live_block;\n"
          "    switch (pass) {\n@s    default:\n        return 0;\n    }\n}\n\n",
          body.data);
    c->out->failed |= body.failed;
    text_free(&body);
}

static void emit_jitter(const struct c_output *c)
{
    struct text value = {0};
    if (!c->pipeline->jitter)
        return;
    c_expr(&value, c->pipeline->jitter);
    c_add(c,
          "static int64_t jitter(const struct dt_pipeline *pipeline, const void *live_block)\n{\n");
    emit_live(c, &value);
    c_add(c, "    (void)pipeline, (void)live_block;\n    return @s;\n}\n\n", value.data);
    c->out->failed |= value.failed;
    text_free(&value);
}

/* ---- Parameters ------------------------------------------------------------------------------ */

static void emit_block_value(struct text *out, const char *indent, const struct param *param)
{
    text_add(out, "%s.%s = ", indent, param->name);
    for (uint32_t i = 0; i < param->components; i++) {
        text_add(out, i ? ", " : param->components > 1 ? "{" : "");
        if (param->type <= DT_TYPE_VEC4) {
            c_float(out, param->value[i]);
        } else {
            bool is_unsigned = param->type >= DT_TYPE_UINT && param->type <= DT_TYPE_UVEC4;
            text_add(out, "%.0f%s", param->value[i], is_unsigned ? "u" : "");
        }
    }
    text_add(out, param->components > 1 ? "},\n" : ",\n");
}

/* The values of the live or of the uniform parameters, in braces. */
static void emit_values(const struct c_output *c, bool live, const char *indent)
{
    bool any = false;
    EACH(param, c->pipeline->params, c->pipeline->param_count) {
        if (!(live ? param->live : param->uniform))
            continue;
        text_add(c->out, any ? "" : "{\n");
        emit_block_value(c->out, indent, param);
        any = true;
    }
    text_add(c->out, any ? "%.*s}" : "{{0}}", (int)strlen(indent) - 4, indent);
}

/* NAME_live_defaults; with uniform parameters also the whole block. */
static void emit_block(const struct c_output *c)
{
    c_add(c, "const struct @n_live @n_live_defaults = ");
    emit_values(c, true, "    ");
    c_add(c, ";\n\n");
    if (c->pipeline->block_size == c->pipeline->live_size)
        return;
    c_add(c, "static const struct {\n    struct @n_live live;\n    struct @n_uniform uniform;\n"
             "} block = {\n    .live = ");
    emit_values(c, true, "        ");
    text_add(c->out, ",\n    .uniform = ");
    emit_values(c, false, "        ");
    text_add(c->out, ",\n};\n\n");
}

static void emit_output(const struct c_output *c, const char *member, int output)
{
    c_add(c, output >= 0 ? "    .@s = @R,\n" : "    .@s = -1,\n", member, (uint32_t)output);
}

void emit_reflection(const struct c_output *c)
{
    const struct dt_pipeline *pipeline = &c->tables->pipeline;
    emit_extent(c);
    emit_runs(c);
    emit_jitter(c);
    emit_block(c);
    emit_rows(c, "params", &param_members, pipeline->params, pipeline->param_count, NULL);
    emit_rows(c, "resources", &resource_members, pipeline->resources, pipeline->resource_count,
              c_resource);
    emit_rows(c, "passes", &pass_members, pipeline->passes, pipeline->pass_count, c_pass);
    c_add(c, "const struct dt_pipeline @n_pipeline = {\n    .name = \"@n\",\n    .doc = @q,\n",
          pipeline->doc);
    c_table(c, "params", "param_count", pipeline->param_count);
    c_table(c, "resources", "resource_count", pipeline->resource_count);
    c_table(c, "passes", "pass_count", pipeline->pass_count);
    c_add(c, pipeline->block_size > pipeline->live_size
                 ? "    .live_defaults = &block,\n    .live_size = sizeof @n_live_defaults,\n"
                   "    .block_size = sizeof block,\n"
                 : "    .live_defaults = &@n_live_defaults,\n"
                   "    .live_size = sizeof @n_live_defaults,\n"
                   "    .block_size = sizeof @n_live_defaults,\n");
    emit_output(c, "linear_output", pipeline->linear_output);
    emit_output(c, "display_output", pipeline->display_output);
    text_add(c->out, "    .extent = extent,\n    .runs = runs,\n%s};\n\n",
             c->pipeline->jitter ? "    .jitter = jitter,\n" : "");
}

/* ---- Places that may be undefined, and NAME_report() ----------------------------------------- */

static void emit_site(const struct c_output *c, const struct dt_site *site)
{
    c_add(c,
          "    {.file = @q, .pass = @q, .kind = @q, .line = @u, .column = @u,\n"
          "     .text = @q, .name = @q,\n",
          site->file, site->pass, site->kind, site->line, site->column, site->text, site->name);
    text_add(c->out,
             "     .resource = %d, .words = %u, .first = %u, .pairs = %s, .allowed = %s},\n",
             site->resource, site->words, site->first, site->pairs ? "true" : "false",
             site->allowed ? "true" : "false");
}

void emit_sites(const struct c_output *c)
{
    uint32_t count = 0;
    if (!c->model->sanitize)
        return;
    const struct dt_site *sites = sanitize_table(c->model, &count);
    c->out->failed |= !sites;
    text_add(c->out,
             "\n/* ---- Undefined behaviour ---- */\n\nstatic const struct dt_site sites[] = {\n");
    for (uint32_t i = 0; sites && i < count; i++)
        emit_site(c, &sites[i]);
    c_add(
        c,
        "};\n\nuint32_t @n_report(const void *reports, size_t size, const struct dt_log *log)\n{\n"
        "    return dt_report_undefined(&@n_pipeline, sites, DT_ARRAY_COUNT(sites), reports, "
        "size,\n"
        "                               log);\n}\n");
}
