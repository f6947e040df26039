/* The author's text of one stage: includes expanded, the parts of other stages and backends cut
 * out, #line wherever output lines no longer match the file. Called by emit_glsl.c. */
#include "glsl.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_INCLUDE_DEPTH = 16, MAX_CONDITIONS = 64 };

struct condition { /* one open #if */
    bool known;    /* tests a macro of the generator: decided here, directives not copied */
    bool active;   /* the current branch */
    bool taken;    /* some branch of it was active */
    bool around;   /* the enclosing text is active */
};

struct body {
    struct glsl *glsl;
    const struct source *source;
    uint32_t number; /* of #line */
    int depth;       /* of includes */
    int line;
    bool jumped; /* lines were left out: the next one needs #line */
    struct condition conditions[MAX_CONDITIONS];
    int condition_count;
};

static bool body_file(struct glsl *glsl, const struct source *source, int depth);

/* 1: defined for this stage, 0: not, -1: none of the generator's macros. */
static int macro_value(const struct glsl *glsl, struct token name)
{
    static const char *const stages[] = {"COMPUTE", "VERTEX", "FRAGMENT"};
    static const char *const backends[] = {"OPENGL", "VULKAN"};
    for (int i = 0; i < 3; i++)
        if (token_is(name, stages[i]))
            return glsl->stage == (enum stage)i;
    for (int i = 0; i < 2; i++)
        if (token_is(name, backends[i]))
            return glsl->backend == (enum backend)i;
    return token_is(name, "EXACT") ? !glsl->pipeline->fast : -1;
}

static bool is_active(const struct body *body)
{
    if (!body->condition_count)
        return true;
    const struct condition *top = &body->conditions[body->condition_count - 1];
    return top->around && top->active;
}

static struct loc body_loc(const struct body *body, int column, int length)
{
    return (struct loc){body->source, body->line, column, length};
}

static void copy_line(struct body *body, const char *line, size_t length)
{
    struct text *out = &body->glsl->parts[PART_BODY];
    if (!is_active(body)) {
        body->jumped = true;
        return;
    }
    if (body->jumped)
        text_add(out, "#line %d %u\n", body->line, body->number);
    body->jumped = false;
    text_add_bytes(out, line, length);
    text_add(out, "\n");
}

/* Beside the including file, then in the templates, then in templates/glsl. */
static const struct source *find_include(struct body *body, const char *name, size_t length)
{
    struct model *model = body->glsl->model;
    const struct source *source = NULL;
    for (int place = 0; place < 3 && !source; place++) {
        const char *path = source_candidate(model, body->source->path, name, length, place);
        source = path ? glsl_source(model, path) : NULL;
    }
    return source;
}

static bool include(struct body *body, const char *line, size_t length)
{
    struct diag *diag = body->glsl->diag;
    const char *open = memchr(line, '"', length);
    const char *close = open ? memchr(open + 1, '"', (size_t)(line + length - open - 1)) : NULL;
    if (!close) {
        diag_error(diag, body_loc(body, 1, (int)length), "#include needs a file name in quotes");
        return false;
    }
    struct loc loc = body_loc(body, (int)(open - line) + 1, (int)(close - open) + 1);
    if (body->depth == MAX_INCLUDE_DEPTH) {
        diag_error(diag, loc, "#include is nested %d deep: does a file include itself?",
                   MAX_INCLUDE_DEPTH);
        return false;
    }
    const struct source *source = find_include(body, open + 1, (size_t)(close - open - 1));
    if (!source) {
        diag_error(diag, loc, "cannot read %.*s, neither beside this file nor in %s or %s/glsl",
                   (int)(close - open - 1), open + 1, body->glsl->model->templates_dir,
                   body->glsl->model->templates_dir);
        return false;
    }
    body->jumped = true;
    return body_file(body->glsl, source, body->depth + 1);
}

static bool open_condition(struct body *body, const char *line, size_t length, int value)
{
    if (body->condition_count == MAX_CONDITIONS) {
        diag_error(body->glsl->diag, body_loc(body, 1, (int)length),
                   "#if is nested more than %d deep", MAX_CONDITIONS);
        return false;
    }
    bool around = is_active(body);
    if (value < 0)
        copy_line(body, line, length);
    else
        body->jumped = true;
    body->conditions[body->condition_count++] =
        (struct condition){value >= 0, value != 0, value != 0, around};
    return true;
}

/* Handles #else, #elif and #endif of a known condition. */
static void switch_known(struct body *body, struct token directive, const char *line, size_t length)
{
    struct condition *top = &body->conditions[body->condition_count - 1];
    body->jumped = true;
    if (token_is(directive, "endif")) {
        body->condition_count--;
    } else if (top->taken) {
        top->active = false;
    } else if (token_is(directive, "else")) {
        top->active = top->taken = true;
    } else { /* the #elif becomes a plain #if */
        const char *rest = memchr(line, 'f', length);
        *top = (struct condition){false, true, true, top->around};
        text_add(&body->glsl->parts[PART_BODY], "#if%.*s\n", (int)(line + length - rest - 1),
                 rest + 1);
    }
}

/* A line that starts with #. */
static bool directive_line(struct body *body, const char *line, size_t length)
{
    const char *cursor = memchr(line, '#', length) + 1;
    char *copy = strndup(cursor, (size_t)(line + length - cursor));
    if (!copy)
        return false;
    const char *at = copy;
    struct token directive = token_next(&at), name = token_next(&at);
    bool ok = true;
    if (token_is(directive, "include") && is_active(body)) {
        ok = include(body, line, length);
    } else if (token_is(directive, "version")) {
        diag_error(body->glsl->diag, body_loc(body, 1, (int)length),
                   "the generator writes #version: remove it");
        ok = false;
    } else if (token_is(directive, "ifdef") || token_is(directive, "ifndef")) {
        int value = macro_value(body->glsl, name);
        if (value >= 0 && token_is(directive, "ifndef"))
            value = !value;
        ok = open_condition(body, line, length, value);
    } else if (token_is(directive, "if")) {
        ok = open_condition(body, line, length, -1);
    } else if (body->condition_count &&
               (token_is(directive, "else") || token_is(directive, "elif") ||
                token_is(directive, "endif"))) {
        if (body->conditions[body->condition_count - 1].known) {
            switch_known(body, directive, line, length);
        } else {
            copy_line(body, line, length);
            body->condition_count -= token_is(directive, "endif");
        }
    } else {
        copy_line(body, line, length);
    }
    free(copy);
    return ok;
}

static bool body_file(struct glsl *glsl, const struct source *source, int depth)
{
    struct body body = {.glsl = glsl, .source = source, .depth = depth, .line = 1, .jumped = true};
    if (!glsl_source_add(glsl->model, source, &body.number))
        return false;
    const char *end = source->text + source->length;
    glsl->own |= memmem(source->text, source->length, "OPENGL", 6) ||
                 memmem(source->text, source->length, "VULKAN", 6);
    bool comment = false,
         ok = true; /* inside of a comment of several lines nothing is a directive */
    for (const char *line = source->text; line < end; body.line++) {
        const char *newline = memchr(line, '\n', (size_t)(end - line));
        size_t length = (size_t)((newline ? newline : end) - line);
        size_t blank = strspn(line, " \t");
        if (!comment && blank < length && line[blank] == '#')
            ok &= directive_line(&body, line, length);
        else
            copy_line(&body, line, length);
        for (size_t i = 0; i + 1 < length; i++) {
            if (!comment && line[i] == '/' && line[i + 1] == '/')
                break;
            bool toggles = comment ? line[i] == '*' && line[i + 1] == '/'
                                   : line[i] == '/' && line[i + 1] == '*';
            comment ^= toggles;
            i += toggles;
        }
        line = newline ? newline + 1 : end;
    }
    if (body.condition_count) {
        body.line--;
        diag_error(glsl->diag, body_loc(&body, 1, 1), "an #if of this file has no #endif");
        ok = false;
    }
    return ok;
}

struct renaming {
    const char *from, *to;
};

/* Replaces words; calls: only those before a parenthesis. */
static void rename_words(struct text *text, const struct renaming *renaming, bool calls)
{
    struct text renamed = {0};
    const char *from = text->data, *word, *search = from;
    while (search && (word = find_word(search, renaming->from))) {
        const char *behind = word + strlen(renaming->from);
        const char *at = search = behind;
        if (calls && !token_is(token_next(&at), "("))
            continue;
        text_add_bytes(&renamed, from, (size_t)(word - from));
        text_add(&renamed, "%s", renaming->to);
        from = behind;
    }
    if (from == text->data) {
        text_free(&renamed);
        return;
    }
    text_add(&renamed, "%s", from);
    text_free(text);
    *text = renamed;
}

/* OpenGL has other names for vertex and instance numbers; a macro name must not begin with gl_.
 * gl_InstanceID leaves out the base instance, which only indirect draws have. spirv_for_opengl makes
 * it of gl_InstanceIndex. */
static void rename_for_opengl(struct text *text, bool indirect, bool driver)
{
    static const struct renaming base = {"gl_InstanceIndex",
                                         "(gl_BaseInstance + gl_InstanceIndex)"},
                                 for_driver[] = {{"gl_VertexIndex", "gl_VertexID"},
                                                 {"gl_InstanceIndex", "gl_InstanceID"}};
    if (indirect)
        rename_words(text, &base, false);
    for (size_t i = 0; driver && i < DT_ARRAY_COUNT(for_driver); i++)
        rename_words(text, &for_driver[i], false);
}

static const struct renaming main_to_body = {"main", "pass_main"};

void glsl_choose_layer(struct glsl *glsl)
{
    struct text *body = &glsl->parts[PART_BODY];
    const char *layer = glsl_uses(glsl, "gl_Layer") ? "gl_Layer" : "0";
    rename_words(body, &main_to_body, true);
    text_add(
        body,
        "\nlayout(push_constant) uniform Pass_layer {\n    int pass_layer; /* -1: all */\n};\n\n"
        "/* A device without shaderOutputLayer draws each layer alone, and no vertex of others. "
        "*/\n"
        "void main()\n{\n    pass_main();\n"
        "    if (pass_layer >= 0 && %s != pass_layer)\n"
        "        gl_Position = vec4(65536.0, 0.0, 0.0, 1.0);\n}\n",
        layer);
}

/* Rounds the colour targets where the body's main has returned. Blending reads what is stored, so a
 * target that is blended is rounded by the driver all the same. */
static void round_targets(struct glsl *glsl)
{
    struct text statements = {0}, *body = &glsl->parts[PART_BODY];
    if (glsl_round_targets(glsl, &statements)) {
        rename_words(body, &main_to_body, true);
        text_add(body, "\nvoid main()\n{\n    pass_main();\n%s}\n", statements.data);
    }
    text_free(&statements);
}

static bool is_subgroup(struct token token)
{
    static const char *const starts[] = {"gl_Subgroup", "gl_NumSubgroups", "subgroup"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(starts); i++) {
        size_t length = strlen(starts[i]);
        if (token.length >= length && !memcmp(token.text, starts[i], length))
            return i < 2 || (token.length > length && isupper((unsigned char)token.text[length]));
    }
    return false;
}

/* Whether the body names a subgroup operation. */
static bool has_subgroups(const struct glsl *glsl)
{
    const char *cursor = glsl->parts[PART_BODY].data;
    struct token token = {0};
    do
        token = token_next(&cursor);
    while (token.length && !is_subgroup(token));
    return token.length > 0;
}

bool glsl_body(struct glsl *glsl)
{
    if (!body_file(glsl, glsl->pass->body, 0))
        return false;
    if (glsl->pipeline->fast)
        glsl->subgroups = glsl->pass->kind == PASS_DISPATCH && has_subgroups(glsl);
    glsl->own |= glsl->pass->indirect_resource && glsl_uses(glsl, "gl_InstanceIndex");
    if (glsl->backend == BACKEND_GL && glsl->stage == STAGE_IS_VERTEX)
        rename_for_opengl(&glsl->parts[PART_BODY], glsl->pass->indirect_resource != NULL,
                          glsl->driver);
    if (glsl->stage == STAGE_IS_FRAGMENT)
        round_targets(glsl);
    return true;
}

struct loc glsl_body_loc(const struct glsl *glsl, const char *body, size_t offset, size_t length)
{
    size_t start = offset; /* of the line */
    while (start > 0 && body[start - 1] != '\n')
        start--;
    int below = 0; /* lines from the directive down */
    for (size_t at = start; at > 0;) {
        size_t previous = at - 1;
        while (previous > 0 && body[previous - 1] != '\n')
            previous--;
        if (!strncmp(body + previous, "#line ", 6)) {
            char *end;
            int line = (int)strtol(body + previous + 6, &end, 10) + below;
            unsigned long number = strtoul(end, NULL, 10);
            if (number >= 1 && number <= glsl->model->glsl_source_count)
                return (struct loc){glsl->model->glsl_sources[number - 1], line,
                                    (int)(offset - start) + 1, (int)length};
        }
        below++;
        at = previous;
    }
    return glsl->pass->shader_loc;
}
