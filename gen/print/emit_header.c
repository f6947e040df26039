/* NAME.h: the C declarations of a pipeline. Structs with explicit padding and asserted offsets,
 * baked parameters as constants, the live block, the indices of resources and passes. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "read/body_files.h"
#include "emit_c.h"

/* A member of a struct; padding may stand before and after it. */
struct member {
    const char *name;
    enum dt_type type;
    uint32_t array_count, offset, size;
    const struct param *param; /* NULL: a field */
};

/* " [0.1..10]": what the spec gives of it. */
static void emit_range(struct text *out, const struct param *param)
{
    if (isinf(param->min) && isinf(param->max))
        return;
    text_add(out, " [");
    if (!isinf(param->min))
        text_add_double(out, param->min);
    text_add(out, "..");
    if (!isinf(param->max))
        text_add_double(out, param->max);
    text_add(out, "]");
}

static void emit_member(const struct c_output *c, const struct member *member)
{
    struct text *out = c->out;
    const struct type_info *info = type_info(member->type);
    bool padded = member->array_count && info->size != info->align && info->columns == 1;

    text_add(out, "    %s %s", info->c, member->name);
    if (member->array_count)
        text_add(out, "[%" PRIu32 "]", member->array_count);
    if (info->columns > 1)
        text_add(out, "[%" PRIu32 "]", info->columns);
    if (info->components > 1)
        text_add(out, "[%" PRIu32 "]", padded ? info->components + 1 : info->components);
    c_add(c, "; /* @s@s", member->type == DT_TYPE_BOOL ? "bool, 0 or 1" : info->name,
          padded ? ", the last of each is padding" : "");
    if (member->param && member->param->doc)
        c_add(c, ": @c", member->param->doc);
    if (member->param)
        emit_range(out, member->param);
    text_add(out, " */\n");
}

static bool is_member(const struct member *members, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(members[i].name, name) == 0)
            return true;
    return false;
}

static void emit_padding(const struct c_output *c, const struct member *members, uint32_t count,
                         uint32_t bytes, unsigned *number)
{
    char name[32];

    do {
        snprintf(name, sizeof name, "padding%u", (*number)++);
    } while (is_member(members, count, name));
    if (bytes)
        c_add(c, "    uint32_t @s[@u];\n", name, bytes / 4);
}

/* The struct's body and its assertions; members in order of offset. */
static void emit_struct(const struct c_output *c, const char *tag, const char *rule,
                        const struct member *members, uint32_t count, uint32_t size)
{
    uint32_t at = 0;
    unsigned number = 0;

    c_add(c, "struct @n_@s {\n", tag);
    for (uint32_t i = 0; i < count; i++) {
        if (members[i].offset > at)
            emit_padding(c, members, count, members[i].offset - at, &number);
        emit_member(c, &members[i]);
        at = members[i].offset + members[i].size;
    }
    if (size > at)
        emit_padding(c, members, count, size - at, &number);
    c_add(c, "};\n_Static_assert(sizeof(struct @n_@s) == @u, \"@n_@s: @s\");\n", tag, size, tag,
          rule);
    for (uint32_t i = 0; i < count; i++)
        c_add(c, "_Static_assert(offsetof(struct @n_@s, @s) == @u, \"@n_@s.@s: @s\");\n", tag,
              members[i].name, members[i].offset, tag, members[i].name, rule);
    c_add(c, "\n");
}

static void emit_structs(const struct c_output *c)
{
    EACH(structure, c->pipeline->structs, c->pipeline->struct_count) {
        struct member *members =
            arena_alloc(c->model->arena, (structure->field_count + 1) * sizeof *members);

        for (uint32_t f = 0; members && f < structure->field_count; f++) {
            const struct field *field = &structure->fields[f];
            uint32_t size = type_info(field->type)->size;

            members[f] = (struct member){
                field->name,
                field->type,
                field->array_count,
                field->offset,
                field->array_count ? field->array_count * field->array_stride : size,
                NULL};
        }
        c_add(c, "/* @c: std430, @u bytes from element to element. */\n",
              structure->doc ? structure->doc : structure->name, structure->stride);
        if (members)
            emit_struct(c, structure->name, "std430", members, structure->field_count,
                        structure->stride);
    }
}

/* The parameters of one part of the block; offsets are relative to the part. */
static void emit_part(const struct c_output *c, const char *part, bool live, uint32_t from,
                      uint32_t size)
{
    struct member *members =
        arena_alloc(c->model->arena, (c->pipeline->param_count + 1) * sizeof *members);
    uint32_t count = 0;

    for (uint32_t i = 0; members && i < c->pipeline->param_count; i++) {
        const struct param *param = &c->pipeline->params[i];

        if (live ? param->live : param->uniform) {
            members[count++] = (struct member){
                param->name, param->type, 0, param->offset - from, type_info(param->type)->size,
                param};
        }
    }
    if (members)
        emit_struct(c, part, "std140", members, count, size);
}

static void emit_block(const struct c_output *c)
{
    const struct pipeline *pipeline = c->pipeline;

    text_add(c->out, "/* The uniform block of the live parameters: std140. */\n");
    emit_part(c, "live", true, 0, pipeline->live_size);
    if (pipeline->block_size > pipeline->live_size) {
        text_add(c->out,
                 "/* Behind them, what a frame cannot change: the uniform parameters. */\n");
        emit_part(c, "uniform", false, pipeline->live_size,
                  pipeline->block_size - pipeline->live_size);
    }
}

/* ---- Constants ------------------------------------------------------------------------------- */

static void emit_value(const struct c_output *c, const struct param *param, uint32_t component)
{
    bool real = param->type <= DT_TYPE_VEC4;
    bool is_unsigned = param->type >= DT_TYPE_UINT && param->type <= DT_TYPE_UVEC4;

    c_add(c, "#define @N_PARAM_@U", param->name);
    if (param->components > 1)
        text_add(c->out, "_%c", "XYZW"[component & 3]);
    text_add(c->out, " ");
    if (real) {
        c_float(c->out, param->value[component]);
    } else {
        text_add(c->out, param->value[component] < 0 ? "(%.0f%s)" : "%.0f%s",
                 param->value[component], is_unsigned ? "u" : "");
    }
    text_add(c->out, "\n");
}

static void emit_param_comment(const struct c_output *c, const struct param *param)
{
    c_add(c, param->doc ? "/* @s: @c" : "/* @s", param->name, param->doc);
    emit_range(c->out, param);
    text_add(c->out, " */\n");
}

static void emit_params(const struct c_output *c)
{
    const struct pipeline *pipeline = c->pipeline;
    bool any = false;

    EACH(param, pipeline->params, pipeline->param_count) {
        if (param->live)
            continue;
        text_add(c->out, any ? "" : "/* ---- Baked parameters ---- */\n\n");
        any = true;
        emit_param_comment(c, param);
        for (uint32_t component = 0; component < param->components; component++)
            emit_value(c, param, component);
    }
    text_add(c->out, any ? "\n" : "");
    any = false;
    EACH(constant, pipeline->constants, pipeline->constant_count) {
        if (!constant->folds)
            continue;
        text_add(c->out, any ? "" : "/* ---- Constants ---- */\n\n");
        any = true;
        c_add(c, "#define @N_CONSTANT_@U", constant->name);
        text_add(c->out, constant->folded < 0 ? " (%" PRId64 ")" : " %" PRId64, constant->folded);
        c_add(c, constant->doc ? " /* @c */\n" : "\n", constant->doc);
    }
    text_add(c->out, any ? "\n" : "");
}

/* Whether the image has the size of the frame: of two frames. */
static bool fills_frame(const struct resource *image)
{
    static const uint32_t frames[2][2] = {{1021, 509}, {61, 127}};
    bool fills = !image->layers;
    for (int i = 0; i < 4; i++)
        fills &= expr_value(resource_size(image, i % 2), frames[i / 2][0], frames[i / 2][1], 1) ==
                 frames[i / 2][i % 2];
    return fills;
}

/* "rgba16f of the frame's size", "rgba8 256x128, 3 mips", "Lamp[6]"; other sizes that depend on the
 * frame: those at the reference frame. */
static void emit_size(struct text *out, const struct resource *resource)
{
    unsigned reach = 0;
    for (int axis = 0; axis < 3; axis++)
        reach |= resource_size(resource, axis) ? expr_reach(resource_size(resource, axis)) : 0;
    if (resource->kind == DT_BUFFER)
        text_add(out, "%s[%" PRIu32 "]",
                 resource->structure ? resource->structure->name : type_info(resource->type)->name,
                 expr_at_reference(resource_size(resource, 0), 1));
    else
        text_add(out, "%s ", format_info(resource->format)->name);
    if (resource->kind == DT_IMAGE && fills_frame(resource)) {
        text_add(out, "of the frame's size");
        reach = 0;
    }
    for (int axis = 0; axis < 3 && resource->kind == DT_IMAGE && !fills_frame(resource); axis++)
        if (resource_size(resource, axis))
            text_add(out, axis ? "x%" PRIu32 : "%" PRIu32,
                     expr_at_reference(resource_size(resource, axis), 1));
    if (reach)
        text_add(out, " at %dx%d", REFERENCE_WIDTH, REFERENCE_HEIGHT);
    if (mips_of(resource) > 1)
        text_add(out, ", %" PRIu32 " mips", mips_of(resource));
}

/* What a host hands in. */
static void emit_source(struct text *out, const struct resource *resource)
{
    text_add(out, resource->file ? "; input: the host hands in the content of "
                                 : "; input: the host's content");
    c_comment(out, resource->file);
    if (resource->file && resource->kind == DT_IMAGE)
        text_add(out, ", last row first%s", resource->srgb ? ", decoded from sRGB" : "");
}

static void emit_resource(const struct c_output *c, const struct resource *resource)
{
    const struct pipeline *pipeline = c->pipeline;
    c_add(c, "    @N_RESOURCE_@U, /* ", resource->name);
    emit_size(c->out, resource);
    if (resource->input)
        emit_source(c->out, resource);
    else if (resource->history)
        text_add(c->out, "; history");
    if (pipeline->linear_output && !strcmp(pipeline->linear_output, resource->name))
        text_add(c->out, "; linear output");
    if (pipeline->display_output && !strcmp(pipeline->display_output, resource->name))
        text_add(c->out, "; display output");
    c_add(c, resource->doc ? ": @c */\n" : " */\n", resource->doc);
}

/* Its `doc`, and what its body asks of a host. */
static void emit_pass_comment(const struct c_output *c, const struct pass *pass)
{
    bool numbers = body_mentions(pass->files, "vertex_triangle");
    if (pass->doc || numbers)
        c_add(c, " /* @c@s@s */", pass->doc, pass->doc && numbers ? "; " : "",
              numbers ? "reads vertex_triangle: see dt_number_triangles" : "");
}

static void emit_indices(const struct c_output *c)
{
    const struct pipeline *pipeline = c->pipeline;

    c_add(c, "/* Indices into @n_pipeline.resources. */\nenum {\n");
    EACH(resource, pipeline->resources, pipeline->resource_count)
        emit_resource(c, resource);
    c_add(c,
          "    @N_RESOURCES /* how many */\n};\n\n/* Passes in order of execution. */\nenum {\n");
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        c_add(c, "    @P,", i);
        emit_pass_comment(c, pipeline->order[i]);
        c_add(c, "\n");
    }
    c_add(c, "    @N_PASSES /* how many */\n};\n\n");
}

static void emit_objects(const struct c_output *c)
{
    c_add(c, "/* For runtimes: @n_panel is the same for all of them, the shaders are each one's "
             "own. */\n"
             "#ifdef __cplusplus\nextern \"C\" {\n#endif\n"
             "extern const struct dt_pipeline @n_pipeline;\n"
             "extern const struct dt_panel @n_panel;\n"
             "extern const struct dt_shaders @n_gl, @n_vk;\n"
             "extern const struct @n_live @n_live_defaults;\n"
             "#ifdef __cplusplus\n}\n#endif\n");
}

void emit_header(const struct model *model, struct text *out)
{
    struct c_output c = {.model = model, .pipeline = &model->pipeline, .out = out};

    c_head(&c, "");
    c_add(&c,
          "#ifndef DIPTYCH_GENERATED_@N_H\n#define DIPTYCH_GENERATED_@N_H\n\n"
          "#include \"diptych.h\"\n\n"
          "#if !DT_TAKES(DT_MAKE_VERSION(@u, @u, @u))\n"
          "#error \"diptych.h is of another version than the generator of this file\"\n"
          "#endif\n\n",
          DT_VERSION_MAJOR, DT_VERSION_MINOR, DT_VERSION_PATCH);
    emit_params(&c);
    emit_structs(&c);
    emit_block(&c);
    emit_indices(&c);
    emit_objects(&c);
    if (model->sanitize)
        c_add(&c,
              "\n/* Logs what --sanitize has found as errors. reports: the bytes of the resource "
              "diptych_reports, after a frame has\n * finished. Returns how many places. */\n"
              "uint32_t @n_report(const void *reports, size_t size, const struct dt_log *log);\n");
    text_add(out, "\n#endif\n");
}
