/* NAME.c, the panel for all backends: the reflection (emit_pipeline.c), the tables of lower.h, and
 * `record`, a function per pass. */
#include <inttypes.h>
#include <string.h>

#include "emit_c.h"
#include "lower/members.h"

/* ---- Record ---------------------------------------------------------------------------------- */

static void emit_barriers(const struct c_output *c, const struct pass *pass)
{
    if (!pass->barrier_count)
        return;
    text_add(c->out, "    static const struct dt_barrier barriers[] = {\n");
    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        const struct resource *alias = pass->barriers[i].alias;
        text_add(c->out, "        ");
        emit_row(c, &barrier_members, &c->tables->passes[pass->index].barriers[i], 8);
        text_add(c->out, alias ? ", /* in the memory of %s */\n" : ",\n", alias ? alias->name : "");
    }
    text_add(c->out, "    };\n");
}

static void emit_call(const struct c_output *c, const struct pass *pass, const struct step *step)
{
    const struct dt_verb_info *verb = dt_verb_info(step->verb);
    bool rect = step->verb == DT_VERB_VIEWPORT || step->verb == DT_VERB_SCISSOR;
    text_add(c->out, "v->%s(r->runtime, ", verb->name);
    c_pass(c, pass->index);
    text_add(c->out, "%s", step->verb == DT_VERB_BARRIERS ? ", barriers" : "");
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
    if (!image)
        return;
    text_add(c->out, "    extent(&%s_pipeline, ", c->pipeline->name);
    c_resource(c, image->index);
    text_add(c->out, ", r->width, r->height, size);\n");
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

static void emit_pass_steps(const struct c_output *c, const struct pass *pass)
{
    struct text body = {0};
    struct c_output inner = *c;
    inner.out = &body;
    emit_body(&inner, pass);
    if (pass->doc) {
        text_add(c->out, "/* ");
        c_comment(c->out, pass->doc);
        text_add(c->out, " */\n");
    }
    text_add(c->out, "static bool record_");
    text_add_word(c->out, pass->name);
    text_add(c->out, "(const struct dt_recording *r)\n{\n");
    emit_barriers(c, pass);
    text_add(c->out, "    const struct dt_verbs *v = r->verbs;\n");
    c_frame_locals(c, body.data);
    text_add(c->out, "%s}\n\n", body.data ? body.data : "");
    c->out->failed |= body.failed;
    text_free(&body);
}

static void emit_record(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++)
        emit_pass_steps(c, c->pipeline->order[i]);
    text_add(c->out, "static bool record(const struct dt_recording *r)\n{\n    return ");
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        text_add(c->out, "%srecord_", i ? " &&\n        " : "");
        text_add_word(c->out, c->pipeline->order[i]->name);
        text_add(c->out, "(r)");
    }
    text_add(c->out, c->pipeline->pass_count ? ";\n}\n\n" : "r != NULL;\n}\n\n");
}

/* ---- The file -------------------------------------------------------------------------------- */

void emit_c_panel(const struct lowered *tables, struct text *out)
{
    const struct pipeline *pipeline = &tables->model->pipeline;
    const struct dt_panel *panel = &tables->panel;
    struct c_output c = {tables->model, pipeline, tables, out};
    c_head(&c, ": the panel, for all backends.");
    text_add(out,
             "#include \"%s.h\"\n\n#include \"panel.h\"\n%s\n"
             "/* ---- What the pipeline is made of ---- */\n\n",
             pipeline->name, tables->model->sanitize ? "#include \"diptych_reports.h\"\n" : "");
    emit_reflection(&c);
    text_add(out, "/* ---- How it is stored, bound and drawn ---- */\n\n");
    emit_rows(&c, "storage", &storage_members, panel->storage, pipeline->resource_count,
              c_resource);
    emit_rows(&c, "samplers", &sampler_members, panel->samplers, panel->sampler_count, NULL);
    emit_rows(&c, "programs", &program_members, panel->programs, pipeline->pass_count, c_pass);
    emit_rows(&c, "needs", &need_members, panel->needs, panel->need_count, NULL);
    emit_rows(&c, "demands", &demand_members, panel->demands, panel->demand_count, NULL);
    text_add(out, "/* ---- One frame ---- */\n\n");
    emit_record(&c);
    text_add(out,
             "const struct dt_panel %s_panel = {\n    .version = DT_MAKE_VERSION(%d, %d, %d),\n    "
             ".pipeline = &%s_pipeline,\n%s%s",
             pipeline->name, DT_VERSION_MAJOR, DT_VERSION_MINOR, DT_VERSION_PATCH, pipeline->name,
             pipeline->resource_count ? "    .storage = storage,\n" : "",
             pipeline->pass_count ? "    .programs = programs,\n" : "");
    c_table(&c, "samplers", "sampler_count", panel->sampler_count);
    c_table(&c, "needs", "need_count", panel->need_count);
    c_table(&c, "demands", "demand_count", panel->demand_count);
    text_add(out, "    .slot_count = %" PRIu32 ",\n    .record = record,\n};\n",
             pipeline->slot_count);
    emit_sites(&c);
}
