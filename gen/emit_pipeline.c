/* NAME.c: the pipeline's reflection, defined once for both panels: parameters, resources with their
 * sizes, passes. Called by main. */
#include <inttypes.h>
#include <string.h>

#include "emit_c.h"

/* ---- Sizes ----------------------------------------------------------------------------------- */

static void emit_extent(const struct c_output *c, const struct resource *resource)
{
    bool image = resource->kind == DT_IMAGE;
    const struct expr *sizes[3] = {image ? resource->width : resource->count,
                                   image ? resource->height : NULL,
                                   image ? resource->layers : NULL};
    struct text body = {0}, locals = {0};

    for (int axis = 0; axis < 3; axis++) {
        text_add(&body, "    extent[%d] = ", axis);
        if (sizes[axis] && expr_reach(sizes[axis]) != EXPR_BAKED) {
            text_add(&body, "at_least_one(");
            c_expr(&body, sizes[axis], 1);
            text_add(&body, ");\n");
        } else {
            uint32_t value = expr_value(sizes[axis], REFERENCE_WIDTH, REFERENCE_HEIGHT, 1);

            text_add(&body, "%" PRIu32 ";\n", value ? value : 1);
        }
    }
    c_size_locals(&locals, body.data, "frame_width", "frame_height");
    text_add(
        c->out,
        "void %s_extent_%s(uint32_t frame_width, uint32_t frame_height, uint32_t extent[3])\n{\n",
        c->pipeline->name, resource->name);
    if (locals.data) {
        text_add(c->out, "%s\n", locals.data);
    }
    if (!locals.data || !strstr(locals.data, "frame_width")) {
        text_add(c->out, "    (void)frame_width;\n");
    }
    if (!locals.data || !strstr(locals.data, "frame_height")) {
        text_add(c->out, "    (void)frame_height;\n");
    }
    text_add(c->out, "%s}\n\n", body.data ? body.data : "");
    text_free(&body);
    text_free(&locals);
}

static bool any_extent_varies(const struct pipeline *pipeline)
{
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *r = &pipeline->resources[i];
        const struct expr *sizes[4] = {r->count, r->width, r->height, r->layers};

        for (int s = 0; s < 4; s++) {
            if (sizes[s] && expr_reach(sizes[s]) != EXPR_BAKED) {
                return true;
            }
        }
    }
    return false;
}

static void emit_extents(const struct c_output *c)
{
    if (any_extent_varies(c->pipeline)) {
        text_add(
            c->out,
            "/* No resource is empty, however small the frame. */\n"
            "static uint32_t at_least_one(int64_t size)\n{\n"
            "    return size < 1 ? 1 : size > UINT32_MAX ? UINT32_MAX : (uint32_t)size;\n}\n\n");
    }
    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        emit_extent(c, &c->pipeline->resources[i]);
    }
}

/* ---- Parameters ------------------------------------------------------------------------------ */

static void emit_block_value(struct text *out, const char *part, const struct param *param)
{
    text_add(out, "    .%s.%s = ", part, param->name);
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

static void emit_param(struct text *out, const struct param *param)
{
    text_add(out, "    {\n        .name = ");
    c_string(out, param->name);
    text_add(out, ",\n        .doc = ");
    c_string(out, param->doc);
    text_add(out, ",\n        .type = %s,\n        .live = %s,\n", type_info(param->type)->dt,
             param->live ? "true" : "false");
    if (param->live) {
        text_add(out, "        .offset = %" PRIu32 ",\n", param->offset);
    }
    text_add(out, "        .value = {");
    for (uint32_t i = 0; i < param->components; i++) {
        text_add(out, i ? ", " : "");
        c_double(out, param->value[i]);
    }
    text_add(out, "},\n        .min = ");
    c_double(out, param->min);
    text_add(out, ",\n        .max = ");
    c_double(out, param->max);
    if (param->step > 0) {
        text_add(out, ",\n        .step = ");
        c_double(out, param->step);
    }
    text_add(out, ",\n    },\n");
}

static void emit_block(const struct c_output *c)
{
    const struct pipeline *pipeline = c->pipeline;
    bool uniform = pipeline->block_size > pipeline->live_size;
    bool any = false;

    text_add(c->out, "static const struct {\n    struct %s_live live;\n", pipeline->name);
    if (uniform) {
        text_add(c->out, "    struct %s_uniform uniform;\n", pipeline->name);
    }
    text_add(c->out, "} block = {");
    for (int part = 0; part < 2; part++) {
        for (uint32_t i = 0; i < pipeline->param_count; i++) {
            const struct param *param = &pipeline->params[i];

            if (part ? param->uniform : param->live) {
                text_add(c->out, any ? "" : "\n");
                emit_block_value(c->out, part ? "uniform" : "live", param);
                any = true;
            }
        }
    }
    text_add(c->out, any ? "};\n\n" : "{{0}}};\n\n");
}

static void emit_params(const struct c_output *c)
{
    emit_block(c);
    if (c->pipeline->param_count) {
        text_add(c->out, "static const struct dt_param params[] = {\n");
        for (uint32_t i = 0; i < c->pipeline->param_count; i++) {
            emit_param(c->out, &c->pipeline->params[i]);
        }
        text_add(c->out, "};\n\n");
    }
}

/* ---- Resources ------------------------------------------------------------------------------- */

static void emit_field(struct text *out, const char *name, enum dt_type type,
                       const struct field *field)
{
    text_add(out, "    {\"%s\", %s, %" PRIu32 ", %" PRIu32 ", %" PRIu32 "},\n", name,
             type_info(type)->dt, field ? field->offset : 0, field ? field->array_count : 0,
             field ? field->array_stride : 0);
}

static void emit_fields(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        const struct resource *resource = &c->pipeline->resources[i];

        if (resource->kind != DT_BUFFER) {
            continue;
        }
        text_add(c->out, "static const struct dt_field fields_%s[] = {\n", resource->name);
        for (uint32_t f = 0; resource->structure && f < resource->structure->field_count; f++) {
            const struct field *field = &resource->structure->fields[f];

            emit_field(c->out, field->name, field->type, field);
        }
        if (!resource->structure) {
            emit_field(c->out, "", resource->type, NULL);
        }
        text_add(c->out, "};\n\n");
    }
}

static void emit_contract(const struct c_output *c, const struct dt_contract *contract)
{
    static const char *const kinds[] = {
        [DT_CONTRACT_EXACT] = "DT_CONTRACT_EXACT", [DT_CONTRACT_ULP] = "DT_CONTRACT_ULP",
        [DT_CONTRACT_ABS] = "DT_CONTRACT_ABS",     [DT_CONTRACT_REL] = "DT_CONTRACT_REL",
        [DT_CONTRACT_IMAGE] = "DT_CONTRACT_IMAGE", [DT_CONTRACT_FLIPS] = "DT_CONTRACT_FLIPS",
    };

    text_add(c->out, "        .contract = {.kind = %s", kinds[contract->kind]);
    if (contract->kind != DT_CONTRACT_EXACT) {
        text_add(c->out, ", .tolerance = ");
        c_double(c->out, contract->tolerance);
    }
    if (contract->kind == DT_CONTRACT_IMAGE) {
        text_add(c->out, ", .outliers = ");
        c_double(c->out, contract->outliers);
    }
    if (contract->kind == DT_CONTRACT_FLIPS && contract->margin_field >= 0) {
        text_add(c->out, ", .margin_resource = ");
        c_enumerator(c, "RESOURCE", c->pipeline->resources[contract->margin_resource].name);
    }
    if (contract->kind == DT_CONTRACT_FLIPS) {
        text_add(c->out, ", .margin_field = %d", contract->margin_field);
    }
    text_add(c->out, "},\n");
}

static void emit_resource(const struct c_output *c, const struct resource *resource)
{
    text_add(c->out, "    [");
    c_enumerator(c, "RESOURCE", resource->name);
    text_add(c->out, "] = {\n        .name = \"%s\",\n        .doc = ", resource->name);
    c_string(c->out, resource->doc);
    text_add(c->out, ",\n        .kind = %s,\n        .history = %s,\n",
             resource->kind == DT_BUFFER ? "DT_BUFFER" : "DT_IMAGE",
             resource->history ? "true" : "false");
    emit_contract(c, &resource->contract.allowed);
    if (resource->kind == DT_BUFFER) {
        text_add(
            c->out,
            "        .fields = fields_%s,\n        .field_count = DT_ARRAY_COUNT(fields_%s),\n",
            resource->name, resource->name);
        text_add(c->out, "        .stride = ");
        c_element(c, c->out, resource);
        text_add(c->out, ",\n");
        if (resource->usage & (ACCESS_INDIRECT | ACCESS_INDEX)) {
            text_add(c->out, "        .controls_work = true,\n");
        }
    } else {
        text_add(c->out,
                 "        .format = %s,\n        .layered = %s,\n        .mips = %" PRIu32 ",\n",
                 format_info(resource->format)->dt, resource->layers ? "true" : "false",
                 expr_value(resource->mips, REFERENCE_WIDTH, REFERENCE_HEIGHT, 1));
    }
    text_add(c->out, "        .extent = %s_extent_%s,\n    },\n", c->pipeline->name,
             resource->name);
}

/* ---- Passes ---------------------------------------------------------------------------------- */

static bool pass_reads(const struct pass *pass, const struct resource *resource)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].resource == resource && pass->accesses[i].mode == MODE_READ) {
            return true;
        }
    }
    return pass->indirect_resource == resource || pass->index_resource == resource;
}

static bool pass_writes(const struct pass *pass, const struct resource *resource)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].resource == resource && pass->accesses[i].mode != MODE_READ) {
            return true;
        }
    }
    return false;
}

static bool pass_uses_scene(const struct pass *pass)
{
    bool uses = pass->kind == PASS_SCENE;

    for (uint32_t i = 0; i < pass->access_count; i++) {
        uses |= pass->accesses[i].builtin >= 0;
    }
    return uses;
}

/* `static const uint16_t reads_NAME[] = {...};` or nothing; returns whether there is one. */
static bool emit_list(const struct c_output *c, const struct pass *pass, const char *what,
                      bool (*in)(const struct pass *, const struct resource *))
{
    bool any = false;

    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        if (!in(pass, &c->pipeline->resources[i])) {
            continue;
        }
        if (!any) {
            text_add(c->out, "static const uint16_t %s_%s[] = {\n", what, pass->name);
        }
        any = true;
        text_add(c->out, "    ");
        c_enumerator(c, "RESOURCE", c->pipeline->resources[i].name);
        text_add(c->out, ",\n");
    }
    text_add(c->out, any ? "};\n" : "");
    return any;
}

/* The mip that the pass writes; no pass writes two of one image, since its body could not tell them
 * apart. */
static uint32_t written_mip(const struct pass *pass, const struct resource *resource)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].resource == resource && pass->accesses[i].mode != MODE_READ) {
            return pass->accesses[i].mip_value;
        }
    }
    return 0;
}

/* `static const uint8_t write_mips_NAME[] = {...};` parallel to the writes, or nothing when all are
 * 0; returns whether there is one. */
static bool emit_write_mips(const struct c_output *c, const struct pass *pass)
{
    struct text mips = {0};
    bool any = false;

    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        const struct resource *resource = &c->pipeline->resources[i];
        if (pass_writes(pass, resource)) {
            uint32_t mip = written_mip(pass, resource);
            any |= mip > 0;
            text_add(&mips, "    %" PRIu32 ",\n", mip);
        }
    }
    if (any) {
        text_add(c->out, "static const uint8_t write_mips_%s[] = {\n%s};\n", pass->name,
                 mips.data ? mips.data : "");
    }
    c->out->failed |= mips.failed;
    text_free(&mips);
    return any;
}

struct pass_lists {
    bool reads, writes, write_mips; /* whether there is one */
};

static void emit_pass(const struct c_output *c, const struct pass *pass,
                      const struct pass_lists *lists)
{
    static const char *const kinds[] = {
        [PASS_SCENE] = "DT_PASS_DRAW_SCENE",
        [PASS_FULLSCREEN] = "DT_PASS_DRAW_FULLSCREEN",
        [PASS_DISPATCH] = "DT_PASS_DISPATCH",
    };

    text_add(c->out, "    [");
    c_enumerator(c, "PASS", pass->name);
    text_add(c->out, "] = {\n        .name = \"%s\",\n        .doc = ", pass->name);
    c_string(c->out, pass->doc);
    text_add(c->out, ",\n        .shader = ");
    c_string(c->out, pass->shader);
    text_add(c->out, ",\n        .kind = %s,\n        .uses_scene = %s,\n", kinds[pass->kind],
             pass_uses_scene(pass) ? "true" : "false");
    if (lists->reads) {
        text_add(c->out,
                 "        .reads = reads_%s,\n        .read_count = DT_ARRAY_COUNT(reads_%s),\n",
                 pass->name, pass->name);
    }
    if (lists->writes) {
        text_add(
            c->out,
            "        .writes = writes_%s,\n        .write_count = DT_ARRAY_COUNT(writes_%s),\n",
            pass->name, pass->name);
    }
    if (lists->write_mips) {
        text_add(c->out, "        .write_mips = write_mips_%s,\n", pass->name);
    }
    emit_work(c, pass);
    text_add(c->out, "    },\n");
}

static void emit_passes(const struct c_output *c)
{
    struct text table = {0};
    struct c_output rows = *c;

    rows.out = &table;
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const struct pass *pass = c->pipeline->order[i];
        struct pass_lists lists;

        lists.reads = emit_list(c, pass, "reads", pass_reads);
        lists.writes = emit_list(c, pass, "writes", pass_writes);
        lists.write_mips = emit_write_mips(c, pass);
        emit_pass(&rows, pass, &lists);
    }
    if (table.data) {
        text_add(c->out, "\nstatic const struct dt_pass passes[] = {\n%s};\n\n", table.data);
    }
    c->out->failed |= table.failed;
    text_free(&table);
}

static void emit_output(const struct c_output *c, const char *member, const char *name)
{
    text_add(c->out, "    .%s = ", member);
    if (name) {
        c_enumerator(c, "RESOURCE", name);
    } else {
        text_add(c->out, "-1");
    }
    text_add(c->out, ",\n");
}

static void emit_table(const struct c_output *c, const char *table, const char *count, uint32_t n)
{
    if (n) {
        text_add(c->out, "    .%s = %s,\n    .%s = DT_ARRAY_COUNT(%s),\n", table, table, count,
                 table);
    }
}

void emit_c_pipeline(const struct model *model, const struct pass_shaders *shaders,
                     struct text *out)
{
    const struct pipeline *pipeline = &model->pipeline;
    struct c_output c = {.model = model, .pipeline = pipeline, .shaders = shaders, .out = out};

    text_add(out, "/* ");
    c_slot_doc(&c);
    text_add(
        out,
        ":\n * the pipeline's reflection, for both backends.\n * Generated by diptych-gen from ");
    c_slot_spec(&c);
    text_add(out,
             "; change that and generate again. */\n#include \"%s.h\"\n\n#include <math.h>\n\n",
             pipeline->name);
    emit_extents(&c);
    emit_params(&c);
    emit_fields(&c);
    if (pipeline->resource_count) {
        text_add(out, "static const struct dt_resource resources[] = {\n");
        for (uint32_t i = 0; i < pipeline->resource_count; i++) {
            emit_resource(&c, &pipeline->resources[i]);
        }
        text_add(out, "};\n\n");
    }
    emit_runs_functions(&c);
    emit_passes(&c);
    text_add(out, "const struct dt_pipeline %s_pipeline = {\n    .name = \"%s\",\n    .doc = ",
             pipeline->name, pipeline->name);
    c_string(out, pipeline->doc);
    text_add(out, ",\n");
    emit_table(&c, "params", "param_count", pipeline->param_count);
    emit_table(&c, "resources", "resource_count", pipeline->resource_count);
    emit_table(&c, "passes", "pass_count", pipeline->pass_count);
    text_add(out, "    .live_defaults = &block,\n    .live_size = sizeof block.live,\n"
                  "    .block_size = sizeof block,\n");
    emit_output(&c, "linear_output", pipeline->linear_output);
    emit_output(&c, "display_output", pipeline->display_output);
    text_add(out, "};\n");
}
