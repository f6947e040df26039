/* The values of a whole shader's uniforms and inputs, as functions in front of its text. Its blocks
 * and attributes are its own; spirv/bind.c fills them from these functions. */
#include "glsl.h"
#include "initials.h"
#include "model/names.h"

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
    EACH(value, values, count)
        if (!strcmp(value->name, name))
            return value;
    return NULL;
}

/* `#line`: errors are told in the spec. */
static void add_values(struct glsl *glsl, const struct value *values, uint32_t count)
{
    struct text *out = &glsl->parts[PART_VALUES];
    EACH(value, values, count) {
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

/* The initializer of a uniform that has no other value. One stage may have it for both. */
static void add_initial(void *user, const char *name, const char *value)
{
    struct glsl *glsl = user;
    struct text *out = &glsl->parts[PART_VALUES], function = {0};
    if (declared_find(glsl->pipeline, DECLARED_PARAM, name) || has_value(glsl, name))
        return;
    text_add(&function, "diptych_value_%s() {", name);
    const char *known = out->data && !function.failed ? strstr(out->data, function.data) : NULL;
    text_add(&function, " return %s; }", value);
    if (function.failed)
        out->failed = true;
    else if (!known)
        text_add(out, "%.*s %s\n", (int)strcspn(value, "("), value, function.data);
    else if (strncmp(known, function.data, function.length) != 0)
        diag_error(glsl->diag, glsl->pass->shader_loc,
                   "the stages of pass `%s` initialize the uniform `%s` with different values",
                   glsl->pass->name, name);
    text_free(&function);
}

static void add_initials(struct glsl *glsl, enum stage stage)
{
    struct text text = {0};
    struct glsl own = *glsl;
    bool any = false;
    for (uint32_t i = 0; i < glsl->files->count; i++)
        any |= !glsl->files->list[i].words && glsl_seems_to_initialize(glsl->files->list[i].text);
    if (!any)
        return;
    own.stage = stage;
    glsl_own_text(&own, &text);
    const struct glslang_job job = {
        .code = text.data, .stage = stage, .include = glsl_include, .user = glsl->files};
    if (!text.failed && glslang_start(true))
        glsl_initials(&job, add_initial, glsl);
    text_free(&text);
}

/* Puts text before each use of a name. */
static void put_before(struct text *text, const char *name, const char *before)
{
    struct text done = {0};
    const char *from = text->data, *at;
    while (from && (at = find_word(from, name))) {
        text_add(&done, "%.*s%s%s", (int)(at - from), from, before, name);
        from = at + strlen(name);
    }
    if (!done.length)
        return;
    text_add(&done, "%s", from);
    text_free(text);
    *text = done;
}

/* Parameters by their names; then what reads those for the author. */
static void add_names(struct glsl *glsl, struct text *functions)
{
    struct text given = {0};
    EACH(param, glsl->pipeline->params, glsl->pipeline->param_count) {
        const char *before = param->live || param->uniform ? GLSL_LIVE "." : GLSL_BAKED;
        put_before(functions, param->name, before);
        if (!has_value(glsl, param->name) && body_mentions_value(glsl->files, param->name))
            text_add(&given, "%s diptych_value_%s() { return %s%s; }\n", glsl_type(param->type),
                     param->name, before, param->name);
    }
    text_add(functions, "%s", given.data ? given.data : "");
    text_free(&given);
}

void glsl_values(struct glsl *glsl)
{
    if (!glsl->whole)
        return;
    add_values(glsl, glsl->pass->values, glsl->pass->value_count);
    add_values(glsl, glsl->pipeline->values, glsl->pipeline->value_count);
    add_names(glsl, &glsl->parts[PART_VALUES]);
    add_initials(glsl, glsl->stage);
    if (glsl->pass->own_vertices)
        add_initials(glsl, glsl->stage == STAGE_IS_VERTEX ? STAGE_IS_FRAGMENT : STAGE_IS_VERTEX);
}
