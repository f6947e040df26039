/* NAME.c, the panel for all backends: the reflection (emit_pipeline.c), the tables of lower.h, and
 * `record`, a function per pass. */
#include <stdio.h>

#include "emit_c.h"
#include "lower/members.h"

/* ---- Record ---------------------------------------------------------------------------------- */

/* A table, and not in the function: targets mostly differ in barriers alone. */
static void emit_barriers(const struct c_output *c, uint32_t index)
{
    const struct pass *pass = c->pipeline->order[index];
    if (!pass->barrier_count)
        return;
    c_add(c, "static const struct dt_barrier @w_barriers@s[] = {\n", pass->name, c->suffix);
    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        const struct resource *alias = pass->barriers[i].alias;
        text_add(c->out, "    ");
        emit_row(c, &barrier_members, &c->tables->passes[index].barriers[i], 4);
        c_add(c, alias ? ", /* in the memory of @s */\n" : ",\n", alias ? alias->name : "");
    }
    c_add(c, "};\n\n");
}

static void emit_call(const struct c_output *c, const struct pass *pass, const struct step *step)
{
    const struct dt_verb_info *verb = dt_verb_info(step->verb);
    bool rect = step->verb == DT_VERB_VIEWPORT || step->verb == DT_VERB_SCISSOR;
    c_add(c, "v->@s(r->runtime, @P@s", verb->name, pass->index,
          step->verb == DT_VERB_BARRIERS ? ", barriers" : "");
    for (int i = 0; i < 4 && verb->arguments[i]; i++) {
        text_add(c->out, rect && !i ? ", dt_make_rect(" : ", ");
        c_amount(c, &step->arguments[i]);
    }
    text_add(c->out, rect ? "))" : ")");
}

/* The image whose sides the step's arguments are; NULL: none. */
static const struct resource *sized_by(const struct steps *steps)
{
    const struct amount *first = &steps_work(steps)->arguments[0];
    return first->kind == AMOUNT_IMAGE ? first->image : NULL;
}

static void emit_begin(const struct c_output *c, const struct pass *pass, const struct steps *steps)
{
    const struct resource *image = sized_by(steps);
    if (pass->conditional) {
        text_add(c->out, "    const bool runs = ");
        expr_emit_c_condition(pass->when, c->out);
        text_add(c->out, ";\n");
    }
    text_add(c->out, image ? "    uint32_t size[3];\n    bool ok = " : "    bool ok = ");
    emit_call(c, pass, &steps->list[0]);
    text_add(c->out, ";\n\n");
    if (image)
        c_add(c, "    extent(&@n_pipeline, @R, r->width, r->height, size);\n", image->index);
}

/* `begin` comes first, `end` last. */
static void emit_body(const struct c_output *c, const struct pass *pass)
{
    const struct steps *steps = &c->tables->passes[pass->index].steps;
    emit_begin(c, pass, steps);
    for (uint32_t i = 1; i < steps->count; i++) {
        const struct step *step = &steps->list[i];
        enum step_when before = step[-1].when;
        if (step->when != before && before != STEP_ALWAYS)
            text_add(c->out, step->when == STEP_ALWAYS ? "    }\n" : "    } else {\n");
        if (step->when == STEP_RUNS && before == STEP_ALWAYS)
            text_add(c->out, "    if (runs) {\n");
        text_add(c->out, step->verb == DT_VERB_END   ? "    return ok && "
                         : step->when == STEP_ALWAYS ? "    ok = ok && "
                                                     : "        ok = ok && ");
        emit_call(c, pass, step);
        text_add(c->out, ";\n");
    }
}

static void emit_pass_steps(const struct c_output *c, uint32_t index)
{
    const struct pass *pass = c->pipeline->order[index];
    struct text body = {0};
    struct c_output inner = *c;
    inner.out = &body;
    emit_body(&inner, pass);
    if (pass->doc)
        c_add(c, "/* @c */\n", pass->doc);
    c_add(c,
          "static bool record_@w@s(const struct dt_recording *r@s)\n{\n"
          "    const struct dt_verbs *v = r->verbs;\n",
          pass->name, c->suffix, pass->barrier_count ? ", const struct dt_barrier *barriers" : "");
    c_frame_locals(c, body.data);
    c_add(c, "@s}\n\n", body.data);
    c->out->failed |= body.failed;
    text_free(&body);
}

/* What GPUs have of their own. */
struct own {
    bool barriers, function;
};

/* own: of each pass; NULL: none. */
static void emit_list(const struct c_output *c, const struct own *own)
{
    c_add(c, "static bool record@s(const struct dt_recording *r)\n{\n    return ", c->suffix);
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const struct pass *pass = c->pipeline->order[i];
        c_add(c, "@srecord_@w@s(r", i ? " &&\n        " : "", pass->name,
              own && own[i].function ? C_GPU : "");
        if (pass->barrier_count)
            c_add(c, ", @w_barriers@s", pass->name, own && own[i].barriers ? C_GPU : "");
        c_add(c, ")");
    }
    c_add(c, c->pipeline->pass_count ? ";\n}\n\n" : "r != NULL;\n}\n\n");
}

/* Whether there is a second one for GPUs. */
static bool emit_record(const struct c_output *c)
{
    const struct lowered *gpu = c->tables->gpu;
    uint32_t passes = c->pipeline->pass_count;
    struct own *own = arena_alloc(c->model->arena, (passes + 1) * sizeof *own);
    bool any = false;
    c->out->failed |= !own;
    for (uint32_t i = 0; own && i < passes; i++) {
        own[i].barriers = c_both(c, emit_barriers, i);
        own[i].function = c_both(c, emit_pass_steps, i);
        any |= own[i].barriers || own[i].function;
    }
    emit_list(c, NULL);
    if (any)
        emit_list(&(struct c_output){gpu->model, &gpu->model->pipeline, gpu, c->out, C_GPU}, own);
    return any;
}

/* ---- The file -------------------------------------------------------------------------------- */

enum { TABLE_STORAGE, TABLE_SAMPLERS, TABLE_PROGRAMS, TABLE_NEEDS, TABLE_DEMANDS, TABLES };

struct table {                /* a member of struct dt_panel */
    const char *name, *count; /* count: the member with its length; NULL: that of another table */
    const struct members *members;
    const void *rows;
    uint32_t row_count;
    void (*label)(const struct c_output *c, uint32_t index);
};

static struct table table_of(const struct c_output *c, uint32_t index)
{
    const struct dt_panel *panel = &c->tables->panel;
    const struct table tables[TABLES] = {
        {"storage", NULL, &storage_members, panel->storage, c->pipeline->resource_count,
         c_resource},
        {"samplers", "sampler_count", &sampler_members, panel->samplers, panel->sampler_count,
         NULL},
        {"programs", NULL, &program_members, panel->programs, c->pipeline->pass_count, c_pass},
        {"needs", "need_count", &need_members, panel->needs, panel->need_count, NULL},
        {"demands", "demand_count", &demand_members, panel->demands, panel->demand_count, NULL},
    };
    return tables[index];
}

static void emit_table(const struct c_output *c, uint32_t index)
{
    const struct table table = table_of(c, index);
    char name[32];
    snprintf(name, sizeof name, "%s%s", table.name, c->suffix ? c->suffix : "");
    emit_rows(c, name, table.members, table.rows, table.row_count, table.label);
}

/* own: the tables, and at TABLES the function, that are for GPUs alone. */
static void emit_object(const struct c_output *c, const bool own[TABLES + 1])
{
    c_add(c,
          c->suffix ? "static const struct dt_panel panel@s = {\n"
                    : "const struct dt_panel @n_panel = {\n",
          c->suffix);
    c_add(c, "    .version = DT_MAKE_VERSION(@u, @u, @u),\n    .pipeline = &@n_pipeline,\n",
          DT_VERSION_MAJOR, DT_VERSION_MINOR, DT_VERSION_PATCH);
    for (uint32_t i = 0; i < TABLES; i++) {
        const struct table table = table_of(c, i);
        if (table.row_count)
            c_add(c, "    .@s = @s@s,\n", table.name, table.name, own[i] ? C_GPU : "");
        if (table.row_count && table.count)
            c_add(c, "    .@s = @u,\n", table.count, table.row_count);
    }
    c_add(c, "    .slot_count = @u,\n    .record = record@s,\n@s};\n", c->pipeline->slot_count,
          own[TABLES] ? C_GPU : "", c->tables->gpu ? "    .gpu = &panel" C_GPU ",\n" : "");
}

void emit_c_panel(const struct lowered *tables, struct text *out)
{
    const struct pipeline *pipeline = &tables->model->pipeline;
    struct c_output c = {tables->model, pipeline, tables, out, NULL};
    const bool shared[TABLES + 1] = {false};
    bool own[TABLES + 1];
    c_head(&c, ": the panel, for all backends.");
    c_add(&c,
          "#include \"@n.h\"\n\n#include \"panel.h\"\n@s\n"
          "/* ---- What the pipeline is made of ---- */\n\n",
          tables->model->sanitize ? "#include \"diptych_reports.h\"\n" : "");
    emit_reflection(&c);
    text_add(out, "/* ---- How it is stored, bound and drawn ---- */\n\n");
    for (uint32_t i = 0; i < TABLES; i++)
        own[i] = c_both(&c, emit_table, i);
    text_add(out, "/* ---- One frame ---- */\n\n");
    own[TABLES] = emit_record(&c);
    if (tables->gpu) {
        const struct lowered *gpu = tables->gpu;
        emit_object(&(struct c_output){gpu->model, &gpu->model->pipeline, gpu, out, C_GPU}, own);
        text_add(out, "\n");
    }
    emit_object(&c, shared);
    emit_sites(&c);
}
