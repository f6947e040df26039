/* NAME.c, the panel for all backends: the reflection (emit_pipeline.c), the tables of lower.h, and
 * `record`, a function per pass. Called by main.c. */
#include <inttypes.h>
#include <string.h>

#include "emit_c.h"

/* In the order of the bits of enum dt_access and enum dt_stage. */
static const char *const accesses[] = {"DT_READ_STORAGE", "DT_WRITE_STORAGE", "DT_READ_TEXTURE",
                                       "DT_READ_UNIFORM", "DT_READ_COLOR",    "DT_WRITE_COLOR",
                                       "DT_READ_DEPTH",   "DT_WRITE_DEPTH",   "DT_READ_INDIRECT",
                                       "DT_READ_INDEX",   "DT_WRITE_CLEAR"};
static const char *const stages[] = {"DT_STAGE_COMPUTE", "DT_STAGE_VERTEX", "DT_STAGE_FRAGMENT",
                                     "DT_STAGE_COLOR",   "DT_STAGE_DEPTH",  "DT_STAGE_INDIRECT",
                                     "DT_STAGE_INDEX",   "DT_STAGE_CLEAR"};
static const char *const layouts[] = {
    [DT_LAYOUT_NONE] = "DT_LAYOUT_NONE",   [DT_LAYOUT_GENERAL] = "DT_LAYOUT_GENERAL",
    [DT_LAYOUT_READ] = "DT_LAYOUT_READ",   [DT_LAYOUT_COLOR] = "DT_LAYOUT_COLOR",
    [DT_LAYOUT_DEPTH] = "DT_LAYOUT_DEPTH",
};

static void emit_accesses(struct text *out, unsigned mask)
{
    c_flags(out, mask, accesses, DT_ARRAY_COUNT(accesses), "0");
}

static void emit_stages(struct text *out, unsigned mask)
{
    c_flags(out, mask, stages, DT_ARRAY_COUNT(stages), "0");
}

/* ---- Storage and samplers -------------------------------------------------------------------- */

static void emit_storage(const struct c_output *c)
{
    if (!c->pipeline->resource_count)
        return;
    text_add(c->out, "static const struct dt_storage storage[] = {\n");
    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        const struct dt_storage *storage = &c->tables->panel.storage[i];
        uint32_t count = 4;
        text_add(c->out, "    [");
        c_resource(c, i);
        text_add(c->out, "] = {.usage = ");
        emit_accesses(c->out, storage->usage);
        text_add(c->out, ", .slot = %u, .share = %d", storage->slot, storage->share);
        if (storage->block)
            text_add(c->out, ", .block = %" PRIu32, storage->block);
        if (storage->by_layer)
            text_add(c->out, ", .by_layer = true");
        while (count > 0 && storage->clear[count - 1] == 0)
            count--;
        for (uint32_t k = 0; k < count; k++) {
            text_add(c->out, k ? ", " : ", .clear = {");
            c_float(c->out, (double)storage->clear[k]);
        }
        text_add(c->out, count ? "}},\n" : "},\n");
    }
    text_add(c->out, "};\n\n");
}

static void emit_samplers(const struct c_output *c)
{
    static const char *const wraps[] = {[DT_WRAP_CLAMP] = "DT_WRAP_CLAMP",
                                        [DT_WRAP_REPEAT] = "DT_WRAP_REPEAT",
                                        [DT_WRAP_MIRROR] = "DT_WRAP_MIRROR",
                                        [DT_WRAP_BORDER] = "DT_WRAP_BORDER"};
    static const char *const borders[] = {
        [DT_BORDER_TRANSPARENT_BLACK] = "",
        [DT_BORDER_OPAQUE_BLACK] = ", .border = DT_BORDER_OPAQUE_BLACK",
        [DT_BORDER_OPAQUE_WHITE] = ", .border = DT_BORDER_OPAQUE_WHITE"};
    if (!c->tables->panel.sampler_count)
        return;
    text_add(c->out, "static const struct dt_sampler samplers[] = {\n");
    for (uint32_t i = 0; i < c->tables->panel.sampler_count; i++) {
        const struct dt_sampler *sampler = &c->tables->panel.samplers[i];
        text_add(c->out, "    {.name = \"%s\"%s%s, .wrap = %s%s%s, .anisotropy = ", sampler->name,
                 sampler->linear ? ", .linear = true" : "",
                 sampler->linear_mip ? ", .linear_mip = true" : "", wraps[sampler->wrap],
                 borders[sampler->border], sampler->compare ? ", .compare = true" : "");
        c_float(c->out, (double)sampler->anisotropy);
        text_add(c->out, "},\n");
    }
    text_add(c->out, "};\n\n");
}

/* ---- Programs -------------------------------------------------------------------------------- */

static void emit_binding(const struct c_output *c, const struct dt_binding *binding)
{
    static const char *const kinds[] = {[DT_BIND_UNIFORM] = "DT_BIND_UNIFORM",
                                        [DT_BIND_STORAGE] = "DT_BIND_STORAGE",
                                        [DT_BIND_TEXELS] = "DT_BIND_TEXELS",
                                        [DT_BIND_TEXTURE] = "DT_BIND_TEXTURE",
                                        [DT_BIND_IMAGE] = "DT_BIND_IMAGE"};
    text_add(c->out, "            {.binding = %u, .resource = ", binding->binding);
    c_resource(c, binding->resource);
    text_add(c->out, ", .kind = %s", kinds[binding->kind]);
    if (binding->mip == DT_ALL_MIPS)
        text_add(c->out, ", .mip = DT_ALL_MIPS");
    else if (binding->mip)
        text_add(c->out, ", .mip = %u", binding->mip);
    if (binding->one_layer)
        text_add(c->out, ", .one_layer = true, .layer = %u", binding->layer);
    if (binding->layout != DT_LAYOUT_NONE)
        text_add(c->out, ", .layout = %s", layouts[binding->layout]);
    if (binding->kind == DT_BIND_IMAGE) {
        text_add(c->out, ", .access = ");
        emit_accesses(c->out, binding->access);
    } else if (binding->kind == DT_BIND_TEXTURE) {
        text_add(c->out, ", .sampler = %d", binding->sampler);
    }
    text_add(c->out, "},\n");
}

static void emit_blend(struct text *out, const struct dt_blend *blend)
{
    static const char *const factors[] = {"ONE",       "ZERO",
                                          "SRC_COLOR", "ONE_MINUS_SRC_COLOR",
                                          "DST_COLOR", "ONE_MINUS_DST_COLOR",
                                          "SRC_ALPHA", "ONE_MINUS_SRC_ALPHA",
                                          "DST_ALPHA", "ONE_MINUS_DST_ALPHA"};
    static const char *const ops[] = {"ADD", "SUBTRACT", "REVERSE_SUBTRACT", "MIN", "MAX"};
    text_add(out,
             ",\n             .blend = &(const struct dt_blend){\n"
             "                 DT_FACTOR_%s, DT_FACTOR_%s, DT_BLEND_%s,\n"
             "                 DT_FACTOR_%s, DT_FACTOR_%s, DT_BLEND_%s}",
             factors[blend->src], factors[blend->dst], ops[blend->op], factors[blend->alpha_src],
             factors[blend->alpha_dst], ops[blend->alpha_op]);
}

static void emit_target(const struct c_output *c, const struct dt_target *target)
{
    text_add(c->out, "{.resource = ");
    c_resource(c, target->resource);
    if (target->mip)
        text_add(c->out, ", .mip = %u", target->mip);
    if (target->one_layer)
        text_add(c->out, ", .one_layer = true, .layer = %u", target->layer);
    if (target->keep)
        text_add(c->out, ", .keep = %u", target->keep);
    if (target->load)
        text_add(c->out, ", .load = true");
    if (target->blend)
        emit_blend(c->out, target->blend);
    text_add(c->out, "}");
}

static void emit_draw_state(const struct c_output *c, const struct dt_program *program)
{
    static const char *const compares[] = {[DT_COMPARE_LESS] = "DT_COMPARE_LESS",
                                           [DT_COMPARE_LESS_EQUAL] = "DT_COMPARE_LESS_EQUAL",
                                           [DT_COMPARE_GREATER] = "DT_COMPARE_GREATER",
                                           [DT_COMPARE_ALWAYS] = "DT_COMPARE_ALWAYS"};
    static const char *const culls[] = {[DT_CULL_NONE] = "DT_CULL_NONE",
                                        [DT_CULL_BACK] = "DT_CULL_BACK",
                                        [DT_CULL_FRONT] = "DT_CULL_FRONT"};
    if (program->color_count)
        text_add(c->out, "        .colors = (const struct dt_target[]){");
    for (uint32_t i = 0; i < program->color_count; i++) {
        text_add(c->out, !i ? "" : program->colors[i - 1].blend ? ",\n            " : ", ");
        emit_target(c, &program->colors[i]);
    }
    if (program->color_count)
        text_add(c->out, "},\n        .color_count = %" PRIu32 ",\n", program->color_count);
    if (program->depth) {
        text_add(c->out, "        .depth = &(const struct dt_target)");
        emit_target(c, program->depth);
        text_add(c->out, ",\n");
    }
    if (program->depth_test)
        text_add(c->out, "        .depth_test = true, .depth_write = %s, .compare = %s,\n",
                 program->depth_write ? "true" : "false", compares[program->compare]);
    text_add(c->out, "        .cull = %s%s", culls[program->cull],
             program->layered ? ", .layered = true" : "");
    if (program->clip_distances)
        text_add(c->out, ", .clip_distances = %" PRIu32, program->clip_distances);
    if (program->attributes)
        text_add(c->out, ", .attributes = 0x%x", program->attributes);
    if (program->topology)
        text_add(c->out, ", .topology = %s",
                 program->topology == DT_LINES ? "DT_LINES" : "DT_POINTS");
    if (program->bias_constant != 0 || program->bias_slope != 0) {
        text_add(c->out, ",\n        .bias_constant = ");
        c_float(c->out, (double)program->bias_constant);
        text_add(c->out, ", .bias_slope = ");
        c_float(c->out, (double)program->bias_slope);
    }
    text_add(c->out, ",\n");
}

static void emit_programs(const struct c_output *c)
{
    if (!c->pipeline->pass_count)
        return;
    text_add(c->out, "static const struct dt_program programs[] = {\n");
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const struct dt_program *program = &c->tables->panel.programs[i];
        text_add(c->out, "    [");
        c_pass(c, i);
        text_add(c->out, "] = {\n        .bindings = (const struct dt_binding[]){\n");
        for (uint32_t b = 0; b < program->binding_count; b++)
            emit_binding(c, &program->bindings[b]);
        text_add(c->out, "        },\n        .binding_count = %" PRIu32 ",\n",
                 program->binding_count);
        if (pass_draws(c->pipeline->order[i]))
            emit_draw_state(c, program);
        text_add(c->out, "    },\n");
    }
    text_add(c->out, "};\n\n");
}

static void emit_demands(const struct c_output *c)
{
    if (!c->tables->panel.demand_count)
        return;
    text_add(c->out, "static const struct dt_demand demands[] = {\n");
    for (uint32_t i = 0; i < c->tables->panel.demand_count; i++) {
        const struct dt_demand *demand = &c->tables->panel.demands[i];
        text_add(c->out, "    {");
        c_pass(c, demand->pass);
        text_add(c->out, ", DT_LIMIT_%s, %" PRIu64 "},\n", demand_name(demand->limit),
                 demand->amount);
    }
    text_add(c->out, "};\n\n");
}

static void emit_needs(const struct c_output *c)
{
    if (!c->tables->panel.need_count)
        return;
    text_add(c->out, "static const struct dt_need needs[] = {\n");
    for (uint32_t i = 0; i < c->tables->panel.need_count; i++) {
        text_add(c->out, "    {");
        c_pass(c, c->tables->panel.needs[i].pass);
        text_add(c->out, ", \"%s\"},\n", c->tables->panel.needs[i].feature);
    }
    text_add(c->out, "};\n\n");
}

/* ---- Record ---------------------------------------------------------------------------------- */

static void emit_barrier(const struct c_output *c, const struct barrier *plan,
                         const struct dt_barrier *barrier)
{
    text_add(c->out, "        {.resource = ");
    c_resource(c, barrier->resource);
    if (plan->alias)
        text_add(c->out, " /* in the memory of %s */", plan->alias->name);
    text_add(c->out, ", .from_stages = ");
    emit_stages(c->out, barrier->from_stages);
    if (barrier->from) {
        text_add(c->out, ", .from = ");
        emit_accesses(c->out, barrier->from);
    }
    text_add(c->out, ", .to_stages = ");
    emit_stages(c->out, barrier->to_stages);
    text_add(c->out, ", .to = ");
    emit_accesses(c->out, barrier->to);
    if (barrier->layout != DT_LAYOUT_NONE)
        text_add(c->out, ", .layout = %s", layouts[barrier->layout]);
    text_add(c->out, barrier->discard ? ", .discard = true},\n" : "},\n");
}

static void emit_barriers(const struct c_output *c, const struct pass *pass)
{
    if (!pass->barrier_count)
        return;
    text_add(c->out, "    static const struct dt_barrier barriers[] = {\n");
    for (uint32_t i = 0; i < pass->barrier_count; i++)
        emit_barrier(c, &pass->barriers[i], &c->tables->passes[pass->index].barriers[i]);
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

static void emit_pass(const struct c_output *c, const struct pass *pass)
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
        emit_pass(c, c->pipeline->order[i]);
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
    struct c_output c = {tables->model, pipeline, tables, out};
    c_head(&c, ": the panel, for all backends.");
    text_add(out,
             "#include \"%s.h\"\n\n#include \"panel.h\"\n\n"
             "/* ---- What the pipeline is made of ---- */\n\n",
             pipeline->name);
    emit_reflection(&c);
    text_add(out, "/* ---- How it is stored, bound and drawn ---- */\n\n");
    emit_storage(&c);
    emit_samplers(&c);
    emit_programs(&c);
    emit_needs(&c);
    emit_demands(&c);
    text_add(out, "/* ---- One frame ---- */\n\n");
    emit_record(&c);
    text_add(out,
             "const struct dt_panel %s_panel = {\n    .version = DT_MAKE_VERSION(%d, %d, %d),\n    "
             ".pipeline = &%s_pipeline,\n%s%s",
             pipeline->name, DT_VERSION_MAJOR, DT_VERSION_MINOR, DT_VERSION_PATCH, pipeline->name,
             pipeline->resource_count ? "    .storage = storage,\n" : "",
             pipeline->pass_count ? "    .programs = programs,\n" : "");
    c_table(&c, "samplers", "sampler_count", tables->panel.sampler_count);
    c_table(&c, "needs", "need_count", tables->panel.need_count);
    c_table(&c, "demands", "demand_count", tables->panel.demand_count);
    text_add(out, "    .slot_count = %" PRIu32 ",\n    .record = record,\n};\n",
             pipeline->slot_count);
}

void emit_limit(const struct pipeline *pipeline, const struct pass *pass, struct text *out)
{
    text_add(out, "#define DT_LIMIT_HEADER \"%s.h\"\n#define DT_LIMIT_RESOURCE(NAME) ",
             pipeline->name);
    c_upper(out, pipeline->name);
    text_add(out, "_RESOURCE_##NAME\n#line 1 ");
    c_string(out, pass->limit);
    text_add(out, "\n");
    text_add_bytes(out, pass->limit_body->text, pass->limit_body->length);
}
