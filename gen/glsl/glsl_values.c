/* The values of a whole shader's uniforms and inputs, as functions in front of its text. Its blocks
 * and attributes are its own; spirv/bind.c fills them from these functions. */
#include "glsl.h"
#include "initials.h"

#include <string.h>

/* Whether this stage can have the value: built-in inputs are of one stage. */
static bool has_inputs(const struct glsl *glsl, const char *text)
{
    static const struct {
        const char *name;
        enum stage stage;
    } inputs[] = {{"gl_VertexIndex", STAGE_IS_VERTEX},
                  {"gl_InstanceIndex", STAGE_IS_VERTEX},
                  {"gl_FragCoord", STAGE_IS_FRAGMENT},
                  {"gl_FrontFacing", STAGE_IS_FRAGMENT},
                  {"gl_PointCoord", STAGE_IS_FRAGMENT}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(inputs); i++)
        if (inputs[i].stage != glsl->stage && find_word(text, inputs[i].name))
            return false;
    return true;
}

static const struct value *find_value(const struct value *values, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(values[i].name, name))
            return &values[i];
    return NULL;
}

/* `#line`: errors are told in the spec. */
static void add_values(struct glsl *glsl, const struct value *values, uint32_t count)
{
    struct text *out = &glsl->parts[PART_VALUES];
    for (uint32_t i = 0; i < count; i++) {
        const struct value *value = &values[i];
        const struct pass *pass = glsl->pass;
        uint32_t number = 0;
        if (values != pass->values && find_value(pass->values, pass->value_count, value->name))
            continue;
        if (!body_mentions_value(glsl->files, value->name) || !has_inputs(glsl, value->text))
            continue;
        out->failed |= !glsl_source_add(glsl->model, value->loc.source, &number);
        text_add(out, "#line %d %u\n%.*s diptych_value_%s() { return %s; }\n", value->loc.line,
                 number, (int)strcspn(value->text, "("), value->text, value->name, value->text);
    }
}

static bool has_value(const struct glsl *glsl, const char *name)
{
    return find_value(glsl->pass->values, glsl->pass->value_count, name) ||
           find_value(glsl->pipeline->values, glsl->pipeline->value_count, name);
}

/* The initializer of a uniform that has no other value. */
static void add_initial(void *user, const char *name, const char *value)
{
    struct glsl *glsl = user;
    for (uint32_t i = 0; i < glsl->pipeline->param_count; i++)
        if (!strcmp(glsl->pipeline->params[i].name, name))
            return;
    if (!has_value(glsl, name))
        text_add(&glsl->parts[PART_VALUES], "%.*s diptych_value_%s() { return %s; }\n",
                 (int)strcspn(value, "("), value, name, value);
}

static void add_initials(struct glsl *glsl)
{
    struct text text = {0};
    glsl_own_text(glsl, &text);
    const struct glslang_job job = {
        .code = text.data, .stage = glsl->stage, .include = glsl_include, .user = glsl->files};
    if (!text.failed && glslang_start())
        glsl_initials(&job, add_initial, glsl);
    text_free(&text);
}

/* Parameters by their names, while the values are read. */
static void add_names(struct glsl *glsl, struct text *functions, struct text *ends)
{
    struct text *out = &glsl->parts[PART_VALUES];
    for (uint32_t i = 0; i < glsl->pipeline->param_count; i++) {
        const struct param *param = &glsl->pipeline->params[i];
        bool given = !has_value(glsl, param->name) && body_mentions_value(glsl->files, param->name);
        if (given)
            text_add(functions, "%s diptych_value_%s() { return %s; }\n", glsl_type(param->type),
                     param->name, param->name);
        if (!given && !(functions->data && find_word(functions->data, param->name)))
            continue;
        text_add(out, "#define %s %s%s\n", param->name,
                 param->live || param->uniform ? GLSL_LIVE "." : GLSL_BAKED, param->name);
        text_add(ends, "#undef %s\n", param->name);
    }
}

void glsl_values(struct glsl *glsl)
{
    struct text functions = {0}, ends = {0}, *out = &glsl->parts[PART_VALUES];
    if (!glsl->whole)
        return;
    add_values(glsl, glsl->pass->values, glsl->pass->value_count);
    add_values(glsl, glsl->pipeline->values, glsl->pipeline->value_count);
    functions = *out;
    *out = (struct text){0};
    add_names(glsl, &functions, &ends);
    text_add(out, "%s%s", functions.data ? functions.data : "", ends.data ? ends.data : "");
    add_initials(glsl);
    out->failed |= functions.failed || ends.failed;
    text_free(&functions);
    text_free(&ends);
}
