/* The complete GLSL of one stage of one pass for one backend. shaders.c calls it for every stage;
 * spirv/compile.c compiles the result, and the OpenGL runtime can take it as text. glsl.h explains the
 * parts. */
#include "glsl.h"
#include "formats.h"
#include "model/names.h"
#include "plan/sanitize.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *glsl_type(enum dt_type type)
{
    return type_info(type)->name;
}

const char *glsl_element_type(const struct resource *buffer)
{
    return buffer->structure ? buffer->structure->name : glsl_type(buffer->type);
}

bool glsl_uses(const struct glsl *glsl, const char *format, ...)
{
    char word[256];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(word, sizeof word, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= sizeof word)
        return true;
    for (int part = 0; part < PART_COUNT; part++)
        if ((part != PART_BODY || glsl->expanded || !glsl->files) && part != PART_CHECKS &&
            glsl->parts[part].data && find_word(glsl->parts[part].data, word))
            return true;
    for (uint32_t i = 0; i < glsl->shader->wanted_count; i++)
        if (!strcmp(glsl->shader->wanted[i], word))
            return true;
    return !glsl->expanded && !glsl->whole && body_mentions(glsl->files, word);
}

void glsl_binding(int binding, struct text *out)
{
    text_add(out, "set = 0, binding = %d", binding);
}

/* ---- Parameters, constants, structs ---------------------------------------------------------- */

/* A float literal with a point: the shortest that reads back as the same float. */
static void add_float(double value, struct text *out)
{
    size_t begin = out->length;
    text_add_float(out, value);
    text_add(out, "%s", out->data && strpbrk(out->data + begin, ".en") ? "" : ".0");
}

static enum dt_type scalar_of(enum dt_type type)
{
    if (type == DT_TYPE_BOOL || type == DT_TYPE_MAT4)
        return type == DT_TYPE_BOOL ? type : DT_TYPE_FLOAT;
    return (enum dt_type)(type / 4 * 4); /* FLOAT, INT and UINT each head a group of four */
}

static void add_component(enum dt_type scalar, double value, struct text *out)
{
    if (scalar == DT_TYPE_FLOAT)
        add_float(value, out);
    else if (scalar == DT_TYPE_BOOL)
        text_add(out, "%s", value != 0 ? "true" : "false");
    else
        text_add(out, "%.0f%s", value, scalar == DT_TYPE_UINT ? "u" : "");
}

/* Declares all live and uniform parameters, even unused ones: layout.c fixed their offsets. */
static void add_block(const struct glsl *glsl, struct text *out)
{
    text_add(out, "\nlayout(std140, ");
    glsl_binding(glsl->pass->live_binding, out);
    text_add(out, ") uniform Live {\n");
    for (int uniform = 0; uniform < 2; uniform++)
        EACH(param, glsl->pipeline->params, glsl->pipeline->param_count) {
            if (uniform ? !param->uniform : !param->live)
                continue;
            text_add(out, "    ");
            if (uniform)
                text_add(out, "layout(offset = %u) ", param->offset);
            text_add(out, "%s %s;\n", glsl_type(param->type), param->name);
        }
    text_add(out, glsl->whole ? "} " GLSL_LIVE ";\n" : "};\n");
}

static void add_params(struct glsl *glsl, struct text *out)
{
    bool block = false;
    EACH(param, glsl->pipeline->params, glsl->pipeline->param_count) {
        bool live = param->live || param->uniform;
        const char *word = !glsl->whole ? "%s" : live ? GLSL_LIVE : GLSL_BAKED "%s";
        if (!glsl_uses(glsl, word, param->name))
            continue;
        block |= live;
        if (live)
            continue;
        text_add(out, "const %s %s%s = ", glsl_type(param->type), glsl->whole ? GLSL_BAKED : "",
                 param->name);
        if (param->components > 1)
            text_add(out, "%s(", glsl_type(param->type));
        for (uint32_t k = 0; k < param->components; k++) {
            text_add(out, "%s", k ? ", " : "");
            add_component(scalar_of(param->type), param->value[k], out);
        }
        text_add(out, "%s;\n", param->components > 1 ? ")" : "");
    }
    if (block)
        add_block(glsl, out);
}

static void add_constant(const struct constant *constant, struct text *out)
{
    bool literal = constant->folds && constant_is_literal(constant);
    text_add(out, literal ? "const int " : "#define ");
    text_add_word(out, constant->name);
    if (literal) {
        text_add(out, " = %lld;\n", (long long)constant->folded);
        return;
    }
    text_add(out, " (");
    expr_emit_glsl(constant->value, out);
    text_add(out, ")\n");
}

/* Constants that the stage uses and constants that these use, in any order of the spec. */
static void add_constants(struct glsl *glsl, struct text *out)
{
    uint32_t count = glsl->pipeline->constant_count;
    bool *there = arena_alloc(glsl->model->arena, (count + 1) * sizeof *there);
    out->failed |= !there;
    for (bool more = there; more;) {
        more = false;
        for (uint32_t i = count; i-- > 0;) {
            const struct constant *constant = &glsl->pipeline->constants[i];
            struct text word = {0};
            text_add_word(&word, constant->name);
            bool used = !there[i] && glsl_uses(glsl, "%s", word.data ? word.data : "");
            out->failed |= word.failed;
            text_free(&word);
            if (!used)
                continue;
            add_constant(constant, out);
            more = there[i] = true;
        }
    }
}

static void add_structs(struct glsl *glsl, struct text *out)
{
    EACH(structure, glsl->pipeline->structs, glsl->pipeline->struct_count) {
        if (!glsl_uses(glsl, "%s", structure->name))
            continue;
        text_add(out, "struct %s {\n", structure->name);
        EACH(field, structure->fields, structure->field_count) {
            text_add(out, "    %s %s", glsl_type(field->type), field->name);
            if (field->array_count)
                text_add(out, "[%u]", field->array_count);
            text_add(out, ";\n");
        }
        text_add(out, "};\n\n");
    }
}

/* ---- Samplers, metrics, interleaves ---------------------------------------------------------- */

static bool pass_uses(const struct pass *pass, const char *name)
{
    for (uint32_t i = 0; i < pass->use_count; i++)
        if (!strcmp(pass->uses[i], name))
            return true;
    return false;
}

/* Puts a function before those written so far, because they may call it. */
static void put_function(struct glsl *glsl, struct text *function)
{
    glsl_put_before(&glsl->parts[PART_FUNCTIONS], function);
}

static void add_samplers(struct glsl *glsl)
{
    static const char *const maps[] = {"", "polar_disk", "concentric_disk"};
    struct text *constants = &glsl->parts[PART_RESOURCES];
    EACH(sampler, glsl->pipeline->samplers, glsl->pipeline->sampler_count) {
        if (sampler->kind != SAMPLER_HAMMERSLEY || !pass_uses(glsl->pass, sampler->name))
            continue;
        struct text function = {0};
        if (sampler->map != MAP_SQUARE && glsl_uses(glsl, "%s_map", sampler->name))
            text_add(&function, "vec2 %s_map(vec2 u)\n{\n    return %s(u);\n}\n\n", sampler->name,
                     maps[sampler->map]);
        if (glsl_uses(glsl, "%s", sampler->name))
            text_add(&function, "vec2 %s(int k)\n{\n    return %s(hammersley(k, %s_count));\n}\n\n",
                     sampler->name, maps[sampler->map], sampler->name);
        put_function(glsl, &function);
        int64_t count = 0;
        if (!glsl_uses(glsl, "%s_count", sampler->name))
            continue;
        if (expr_is_literal(sampler->count) && expr_eval(sampler->count, 0, 0, &count) == EXPR_OK) {
            text_add(constants, "const int %s_count = %lld;\n", sampler->name, (long long)count);
        } else {
            text_add(constants, "#define %s_count (", sampler->name);
            expr_emit_glsl(sampler->count, constants);
            text_add(constants, ")\n");
        }
    }
}

static bool has_field(const struct structure *structure, const char *name)
{
    EACH(field, structure->fields, structure->field_count)
        if (!strcmp(field->name, name) && field->type == DT_TYPE_VEC3)
            return true;
    return false;
}

/* Whether the struct has both fields of the metric, and the pass a buffer of the struct. */
static bool metric_takes(const struct pass *pass, const struct metric *metric,
                         const struct structure *structure)
{
    if (!has_field(structure, metric->position_field) ||
        !has_field(structure, metric->normal_field))
        return false;
    EACH(access, pass->accesses, pass->access_count)
        if (access->resource && access->resource->structure == structure)
            return true;
    return false;
}

static void add_weight(const struct weight *weight, struct text *out)
{
    if (weight->param)
        text_add(out, "%s", weight->param);
    else
        add_float(weight->value, out);
}

static void add_metric(struct glsl *glsl, const struct metric *metric)
{
    struct text function = {0}, *out = &function;
    const char *scale = metric->scale ? metric->scale : "scene_radius";
    double number;
    text_add(out, "float %s_position = ", metric->name); /* once per invocation */
    add_weight(&metric->position, out);
    text_add(out, " * approximate_reciprocal(");
    if (sscanf(scale, "%lf", &number) == 1)
        add_float(number, out);
    else
        text_add(out, "frame.scene_radius");
    text_add(out, ");\nfloat %s_normal = ", metric->name);
    add_weight(&metric->normal, out);
    text_add(out,
             ";\n\nfloat %s(vec3 pa, vec3 na, vec3 pb, vec3 nb)\n{\n    return %s(pa, na, pb, nb, ",
             metric->name, metric->normal_term == TERM_DOT ? "metric_dot" : "metric_one_minus_dot");
    text_add(out, "%s_position, %s_normal);\n}\n\n", metric->name, metric->name);
    const struct pipeline *pipeline = glsl->pipeline;
    for (uint32_t a = 0; a < pipeline->struct_count; a++)
        for (uint32_t b = 0; b < pipeline->struct_count; b++) {
            const struct structure *left = &pipeline->structs[a], *right = &pipeline->structs[b];
            if (metric_takes(glsl->pass, metric, left) && metric_takes(glsl->pass, metric, right))
                text_add(
                    out, "float %s(%s a, %s b)\n{\n    return %s(a.%s, a.%s, b.%s, b.%s);\n}\n\n",
                    metric->name, left->name, right->name, metric->name, metric->position_field,
                    metric->normal_field, metric->position_field, metric->normal_field);
        }
    put_function(glsl, &function);
}

static void add_interleave(struct glsl *glsl, const struct interleave *tile)
{
    const char *name = tile->name;
    struct text functions = {0}, *out = &functions, *constants = &glsl->parts[PART_RESOURCES];
    if (glsl_uses(glsl, "%s_class", name))
        text_add(out, "int %s_class(ivec2 p)\n{\n    return tile_class(p, %s_tile);\n}\n\n", name,
                 name);
    if (glsl_uses(glsl, "%s_split", name))
        text_add(out,
                 "ivec2 %s_split(ivec2 p, ivec2 size)\n{\n    return tile_split(p, size, "
                 "%s_tile);\n}\n\n",
                 name, name);
    if (glsl_uses(glsl, "%s_gather", name))
        text_add(out,
                 "ivec2 %s_gather(ivec2 q, ivec2 size)\n{\n    return tile_gather(q, size, "
                 "%s_tile);\n}\n\n",
                 name, name);
    if (glsl_uses(glsl, "%s_class_size", name))
        text_add(out,
                 "ivec2 %s_class_size(int class_index, ivec2 size)\n{\n"
                 "    return tile_class_size(class_index, size, %s_tile);\n}\n\n",
                 name, name);
    put_function(glsl, &functions);
    if (glsl_uses(glsl, "%s_tile", name))
        text_add(constants, "const ivec2 %s_tile = ivec2(%u, %u);\n", name, tile->tile[0],
                 tile->tile[1]);
    if (glsl_uses(glsl, "%s_classes", name))
        text_add(constants, "const int %s_classes = %u;\n", name, tile->tile[0] * tile->tile[1]);
}

/* ---- Position of an invocation --------------------------------------------------------------- */

/* Workgroups of an interleave: x is the class, y and z their place among those of the class. */
#define PLACE_IN_CLASS "gl_WorkGroupID.yz * gl_WorkGroupSize.xy + gl_LocalInvocationID.xy"

static void add_interleave_place(struct glsl *glsl)
{
    const char *tile = glsl->pass->interleave->name;
    struct text function = {0};
    if (glsl_uses(glsl, "interleave_split"))
        text_add(
            &function,
            "ivec2 interleave_split()\n{\n"
            "    return %s_split(interleave_pixel(), ivec2(frame.width, frame.height));\n}\n\n",
            tile);
    put_function(glsl, &function);
    if (glsl_uses(glsl, "interleave_pixel"))
        text_add(&function,
                 "/* Invocations beyond the last pixel of the class repeat it. */\n"
                 "ivec2 interleave_pixel()\n{\n"
                 "    ivec2 last = %s_class_size(interleave_class(), ivec2(frame.width, "
                 "frame.height)) - 1;\n"
                 "    ivec2 q = min(ivec2(" PLACE_IN_CLASS "), last);\n"
                 "    return q * %s_tile + tile_offset(interleave_class(), %s_tile);\n}\n\n",
                 tile, tile, tile);
    put_function(glsl, &function);
    if (glsl_uses(glsl, "interleave_class"))
        text_add(&function, "int interleave_class()\n{\n    return int(gl_WorkGroupID.x);\n}\n\n");
    put_function(glsl, &function);
}

static void add_size_component(const struct pass *pass, int axis, struct text *out)
{
    const struct resource *image = pass->size == SIZE_IMAGE ? pass->size_resource : NULL;
    const struct expr *value = pass->dispatch[axis];
    if (image)
        value = axis == 0 ? image->width : axis == 1 ? image->height : image->layers;
    if (value)
        expr_emit_glsl(value, out);
    else
        text_add(out, image && axis < 2 ? (axis ? "int(frame.height)" : "int(frame.width)") : "1");
    if (pass->size == SIZE_GROUPS)
        text_add(out, " * %u", pass->local[axis]);
}

static void add_dispatch_size(struct glsl *glsl)
{
    const struct pass *pass = glsl->pass;
    struct text function = {0}, *out = &function;
    text_add(out, "ivec3 dispatch_size()\n{\n    return ");
    if (pass->size == SIZE_INDIRECT) {
        text_add(out, "ivec3(gl_NumWorkGroups * gl_WorkGroupSize)");
    } else if (pass->size == SIZE_INTERLEAVE && pass->interleave) {
        const uint32_t *tile = pass->interleave->tile;
        text_add(out, "ivec3((int(frame.width) + %u) / %u, (int(frame.height) + %u) / %u, %u)",
                 tile[0] - 1, tile[0], tile[1] - 1, tile[1], tile[0] * tile[1]);
    } else {
        text_add(out, "ivec3(");
        for (int axis = 0; axis < 3; axis++) {
            text_add(out, "%s", axis ? ", " : "");
            add_size_component(pass, axis, out);
        }
        text_add(out, ")");
    }
    text_add(out, ";\n}\n\n");
    put_function(glsl, &function);
}

/* Names that a body may use without `frame.`. Variables, not macros, because macros would replace
 * members of the same name. */
static void add_frame_names(struct glsl *glsl)
{
    static const char *const names[][2] = {{"View", "camera"},
                                           {"View", "light_view"},
                                           {"Light", "light"},
                                           {"vec3", "scene_center"},
                                           {"float", "scene_radius"}};
    struct text variables = {0};
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++)
        if (glsl_uses(glsl, "%s", names[i][1]))
            text_add(&variables, "%s %s = frame.%s;\n\n", names[i][0], names[i][1], names[i][1]);
    put_function(glsl, &variables);
}

/* A fullscreen draw has no vertex buffer: one triangle covers the frame. */
static void add_fullscreen_position(struct text *out)
{
    text_add(out, "vec4 fullscreen_position()\n{\n"
                  "    vec2 corner = vec2(gl_VertexIndex << 1 & 2, gl_VertexIndex & 2);\n"
                  "    return vec4(2.0 * corner - 1.0, 0.0, 1.0);\n}\n\n");
}

static void add_scene_object(struct text *out)
{
    text_add(out, "/* Object of a triangle: objects have their triangles in order. */\n"
                  "uint scene_object(uint triangle)\n{\n"
                  "    uint low = 0u, high = uint(scene_objects.length());\n"
                  "    while (high - low > 1u) {\n"
                  "        uint middle = (low + high) / 2u;\n"
                  "        bool later = scene_objects[middle].first_index <= 3u * triangle;\n"
                  "        low = later ? middle : low;\n"
                  "        high = later ? high : middle;\n"
                  "    }\n"
                  "    return low;\n}\n\n");
}

static void add_place(struct glsl *glsl)
{
    struct text function = {0};
    if (glsl_uses(glsl, "scene_object"))
        add_scene_object(&function);
    if (glsl->stage == STAGE_IS_COMPUTE) {
        if (glsl->pass->interleave)
            add_interleave_place(glsl);
        if (glsl_uses(glsl, "dispatch_size"))
            add_dispatch_size(glsl);
        if (glsl_uses(glsl, "invocation"))
            text_add(&function, "ivec3 invocation()\n{\n    return ivec3(%s);\n}\n\n",
                     glsl->pass->interleave ? PLACE_IN_CLASS ", gl_WorkGroupID.x"
                                            : "gl_GlobalInvocationID");
    } else if (glsl->pass->kind == DT_PASS_DRAW_FULLSCREEN) {
        if (glsl->stage == STAGE_IS_VERTEX && glsl_uses(glsl, "fullscreen_position"))
            add_fullscreen_position(&function);
    } else if (glsl->pass->kind == DT_PASS_DRAW_SCENE) {
        if (glsl_uses(glsl, "view"))
            text_add(&function, "View view = frame.%s;\n\n",
                     glsl->pass->view && !strcmp(glsl->pass->view, "light") ? "light_view"
                                                                            : "camera");
        if (glsl->stage == STAGE_IS_FRAGMENT && glsl_uses(glsl, "scene_texture"))
            text_add(&function,
                     "/* Linear colour and alpha; layer -1: white. */\n"
                     "vec4 scene_texture(vec2 uv, int layer)\n{\n"
                     "    vec4 texel = texture(scene_textures, vec3(uv, float(max(layer, 0))));\n"
                     "    return layer < 0 ? vec4(1.0) : texel;\n}\n\n");
    }
    put_function(glsl, &function);
}

/* ---- The stage ------------------------------------------------------------------------------- */

static void add_functions(struct glsl *glsl)
{
    const struct pipeline *pipeline = glsl->pipeline;
    add_place(glsl);
    add_frame_names(glsl);
    EACH(metric, pipeline->metrics, pipeline->metric_count)
        if (pass_uses(glsl->pass, metric->name) && glsl_uses(glsl, "%s", metric->name))
            add_metric(glsl, metric);
    add_samplers(glsl);
    EACH(tile, pipeline->interleaves, pipeline->interleave_count)
        if (tile == glsl->pass->interleave || pass_uses(glsl->pass, tile->name))
            add_interleave(glsl, tile);
    glsl_accessors(glsl);
}

static bool add_library(struct glsl *glsl)
{
    static const char *const from_the_end[] = {"interleave", "metric", "disk", "hammersley",
                                               "scene"};
    struct text layout = {0};
    text_add(&layout, "std140, ");
    glsl_binding(glsl->pass->frame_binding, &layout);
    bool ok = !layout.failed;
    for (size_t i = 0; ok && i < DT_ARRAY_COUNT(from_the_end); i++)
        ok = glsl_library(glsl, from_the_end[i], layout.data);
    ok = ok && glsl_library(glsl, "frame", layout.data);
    if (ok && !glsl->pass->fast)
        ok = glsl_library(glsl, "filter", layout.data);
    ok = ok && glsl_library(glsl, "approximate", layout.data);
    text_free(&layout);
    return ok;
}

static void add_vertex_inputs(struct glsl *glsl, struct text *out)
{
    static const char *const inputs[][2] = {{"vec3", "vertex_position"},
                                            {"vec3", "vertex_normal"},
                                            {"vec2", "vertex_uv"},
                                            {"uint", "vertex_material"},
                                            {"uint", "vertex_triangle"}};
    for (int i = 0; i < 5 && glsl->pass->kind == DT_PASS_DRAW_SCENE; i++)
        if (glsl_uses(glsl, "%s", inputs[i][1]))
            text_add(out, "layout(location = %d) in %s %s;\n", i, inputs[i][0], inputs[i][1]);
    if (glsl->pass->clip_distances)
        text_add(out, "out float gl_ClipDistance[%u];\n", glsl->pass->clip_distances);
}

/* Whether the generator supplies the vertex shader. */
static bool makes_vertices(const struct pass *pass)
{
    return pass->kind == DT_PASS_DRAW_FULLSCREEN && !pass->own_vertices;
}

void glsl_macros(const struct glsl *glsl, struct text *out)
{
    static const char *const stages[] = {"COMPUTE", "VERTEX", "FRAGMENT"};
    text_add(out, "#define %s\n%s%s", stages[glsl->stage],
             glsl->backend == BACKEND_VK ? "" /* glslang defines VULKAN */
                                         : "#undef VULKAN\n#define OPENGL\n",
             glsl->pass->fast ? "" : "#define EXACT\n");
}

static void add_origin(const struct glsl *glsl, struct text *out)
{
    static const char *const stage_names[] = {"compute", "vertex", "fragment"};
    text_add(
        out,
        "#version 460\n/* Generated by diptych-gen: pipeline %s, pass %s, %s stage for %s. */\n",
        glsl->pipeline->name, glsl->pass->name, stage_names[glsl->stage],
        glsl->backend == BACKEND_GL ? "OpenGL" : "Vulkan");
}

static void add_head(struct glsl *glsl)
{
    static const char *const subgroups[] = {"basic",     "vote",    "arithmetic",
                                            "ballot",    "shuffle", "shuffle_relative",
                                            "clustered", "quad"};
    struct text *out = &glsl->parts[PART_HEAD];
    const struct pass *pass = glsl->pass;
    add_origin(glsl, out);
    if (glsl->stage == STAGE_IS_VERTEX && glsl_uses(glsl, "gl_Layer"))
        text_add(out, "#extension GL_ARB_shader_viewport_layer_array : require\n");
    for (size_t i = 0; glsl->subgroups && i < DT_ARRAY_COUNT(subgroups); i++)
        text_add(out, "#extension GL_KHR_shader_subgroup_%s : enable\n", subgroups[i]);
    glsl_macros(glsl, out);
    if (glsl->stage == STAGE_IS_COMPUTE)
        text_add(out, "\nlayout(local_size_x = %u, local_size_y = %u, local_size_z = %u) in;\n",
                 pass->local[0], pass->local[1], pass->local[2]);
    if (glsl->stage == STAGE_IS_VERTEX && !makes_vertices(pass) && !glsl->whole)
        add_vertex_inputs(glsl, out);
}

static void add_fullscreen_vertex(struct glsl *glsl)
{
    text_add(&glsl->parts[PART_BODY],
             "void main()\n{\n    gl_Position = fullscreen_position();\n}\n");
}

/* Directly before the body, so that no macro replaces a word of generated code. Names of an instance
 * are variables: a body may have one of that name itself. */
void glsl_defines(const struct glsl *glsl, struct text *out)
{
    EACH(define, glsl->pass->defines, glsl->pass->define_count) {
        int64_t value = 0;
        if (define->word && !glsl_uses(glsl, "%s", define->name))
            continue;
        const struct param *param =
            define->param ? declared_find(glsl->pipeline, DECLARED_PARAM, define->param) : NULL;
        if (param) {
            text_add(out, "%s %s = %s;\n", glsl_type(param->type), define->name, define->param);
        } else if (define->word && !expr_is_literal(define->value)) {
            text_add(out, "int %s = ", define->name);
            expr_emit_glsl(define->value, out);
            text_add(out, ";\n");
        } else if (expr_eval(define->value, 0, 0, &value) != EXPR_OK) {
            continue;
        } else if (define->word) {
            text_add(out, "const int %s = %lld;\n", define->name, (long long)value);
        } else {
            text_add(out, value < 0 ? "#define %s (%lld)\n" : "#define %s %lld\n", define->name,
                     (long long)value);
        }
    }
    if (!glsl->pass->fast && body_mentions(glsl->pass->files, "precise"))
        text_add(out, "#define precise /* as all operations are; glslang (12) takes no `precise` "
                      "of global variables */\n");
    for (uint32_t i = 0; i < glsl->shader->own_count; i++)
        text_add(out, "#define %s body_%s /* the body has its own */\n", glsl->shader->own_names[i],
                 glsl->shader->own_names[i]);
}

static bool add_parts(struct glsl *glsl)
{
    if (makes_vertices(glsl->pass) && glsl->stage == STAGE_IS_VERTEX) {
        add_fullscreen_vertex(glsl);
    } else {
        glsl->files = glsl->pass->files;
        glsl->whole = glsl->files->whole;
        if (!glsl_body(glsl))
            return false;
        glsl_end(glsl);
        glsl_zero(glsl);
        glsl_values(glsl);
        if (!sanitize_glsl(glsl))
            return false;
        glsl_texels(glsl);
        if (glsl->expanded) /* with its macros */
            glsl->files = NULL;
        else
            glsl_defines(glsl, &glsl->parts[PART_DEFINES]);
    }
    add_functions(glsl);
    glsl_resources(glsl);
    struct text *constants = &glsl->parts[PART_CONSTANTS];
    add_constants(glsl, constants); /* before the library: they may use `frame` */
    if (!add_library(glsl))
        return false;
    add_structs(glsl, &glsl->parts[PART_STRUCTS]);
    if (glsl_uses(glsl, "PI"))
        text_add(constants, "const float PI = 3.14159265359;\n");
    add_params(glsl, constants);
    add_head(glsl);
    return true;
}

/* Joins parts with one empty line between them. */
static void join_parts(const struct glsl *glsl, int from, int to, struct text *out)
{
    for (int i = from; i < to; i++) {
        const struct text *part = &glsl->parts[i];
        out->failed |= part->failed;
        size_t length = part->length;
        while (length && part->data[length - 1] == '\n')
            length--;
        if (!length)
            continue;
        text_add(out, "%s", out->length ? "\n" : "");
        text_add_bytes(out, part->data, length);
        text_add(out, "\n");
    }
}

/* The author's text into `whole`, which glslang then reads alone; what the generator has beside it, with a
 * main() of its own, into `out`. */
static void split_parts(const struct glsl *glsl, struct text *out, struct text *whole)
{
    add_origin(glsl, whole);
    glsl_macros(glsl, whole);
    join_parts(glsl, PART_DEFINES, PART_COUNT, whole);
    join_parts(glsl, PART_HEAD, PART_DEFINES, out);
    text_add(out, "\nvoid main()\n{\n}\n");
}

static bool emit_text(struct glsl *glsl, struct text *out, struct text *whole)
{
    bool ok = glsl_check_accesses(glsl) && add_parts(glsl);
    if (ok && glsl->whole)
        split_parts(glsl, out, whole);
    else if (ok)
        join_parts(glsl, PART_HEAD, PART_COUNT, out);
    ok = ok && !out->failed && !whole->failed;
    for (int i = 0; i < PART_COUNT; i++)
        text_free(&glsl->parts[i]);
    return ok;
}

bool emit_glsl(struct model *model, const struct pass *pass, enum backend backend, enum stage stage,
               struct shader *shader, struct diag *diag)
{
    struct glsl glsl = {.model = model,
                        .pipeline = &model->pipeline,
                        .pass = pass,
                        .backend = backend,
                        .stage = stage,
                        .diag = diag};
    bool good = true;
    shader->stage = stage;
    glsl.shader = shader;
    if (backend == BACKEND_VK) {
        good = emit_text(&glsl, &shader->glsl, &shader->whole);
        shader->own = glsl.own;
    } else if (shader->own && !shader->code.length) {
        good = emit_text(&glsl, &shader->code, &shader->whole);
    }
    shader->files = glsl.files;
    return good;
}
