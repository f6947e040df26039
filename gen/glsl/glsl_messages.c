/* What glslang says of a shader, in the words of the spec's author: at the line of the body, with
 * the list that lacks a name. Also what can be done about it: a name that the body declares
 * itself, and that the generator or GLSL has too, gets another one by a macro in front of the
 * body. */
#include "glsl.h"
#include "model/names.h"
#include "plan/plan.h"

#include <ctype.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- Places ---------------------------------------------------------------------------------- */

/* The line of the source and its length; NULL when it has fewer lines. */
static const char *line_of(const struct loc *loc, size_t *length)
{
    const char *at = loc->source->text, *end = at + loc->source->length;
    for (int line = 1; line < loc->line && at; line++) {
        at = memchr(at, '\n', (size_t)(end - at));
        at = at ? at + 1 : NULL;
    }
    const char *newline = at ? memchr(at, '\n', (size_t)(end - at)) : NULL;
    *length = at ? (size_t)((newline ? newline : end) - at) : 0;
    return at;
}

bool glsl_find_in_line(struct loc *loc, const char *word, size_t length)
{
    size_t width;
    const char *at = line_of(loc, &width);
    if (!at || !length)
        return false;
    for (size_t i = 0; i + length <= width; i++) {
        bool inside =
            text_is_word(word[0]) && ((i && text_is_word(at[i - 1])) ||
                                      (i + length < width && text_is_word(at[i + length])));
        if (!inside && !memcmp(at + i, word, length)) {
            loc->column = (int)i + 1;
            loc->length = (int)length;
            return true;
        }
    }
    return false;
}

/* The first identifier of the line that begins so; *length 0: none. */
static const char *prefix_in_line(struct loc *loc, const char *prefix, size_t *length)
{
    size_t width, size = strlen(prefix);
    const char *at = line_of(loc, &width);
    *length = 0;
    for (size_t i = 0; at && i + size <= width; i++)
        if (!memcmp(at + i, prefix, size) && !(i && text_is_word(at[i - 1]))) {
            while (i + *length < width && text_is_word(at[i + *length]))
                ++*length;
            loc->column = (int)i + 1;
            loc->length = (int)*length;
            return at + i;
        }
    return NULL;
}

/* ---- One message ----------------------------------------------------------------------------- */

struct compiler_message { /* "ERROR: 3:12: 'name' : text" */
    unsigned long number; /* of the file */
    struct loc loc;       /* source NULL: in generated text */
    unsigned long line;
    const char *name; /* between the quotes */
    size_t name_length;
    const char *text; /* behind them */
    size_t length;
};

/* Reads the message at `*log` and goes on to the next line; false: no message. */
static bool read_message(const struct model *model, const char **log,
                         struct compiler_message *message)
{
    static const char prefix[] = "ERROR: ";
    const char *line = *log, *stop = line + strcspn(line, "\n");
    char *end;
    *log = stop + (*stop == '\n');
    *message = (struct compiler_message){0};
    if (strncmp(line, prefix, sizeof prefix - 1) != 0 ||
        !isdigit((unsigned char)line[sizeof prefix - 1]))
        return false;
    message->number = strtoul(line + sizeof prefix - 1, &end, 10);
    if (*end != ':') /* "ERROR: 2 compilation errors" */
        return false;
    message->line = strtoul(end + 1, &end, 10);
    const char *text = end + strspn(end, ": ");
    const char *close =
        text < stop && *text == '\'' ? memchr(text + 1, '\'', (size_t)(stop - text - 1)) : NULL;
    if (close) {
        message->name = text + 1;
        message->name_length = (size_t)(close - text - 1);
        text = close + 1 + strspn(close + 1, ": ");
    }
    message->text = text;
    message->length = text < stop ? (size_t)(stop - text) : 0;
    if (message->number >= 1 && message->number <= model->glsl_source_count) {
        message->loc =
            (struct loc){model->glsl_sources[message->number - 1], (int)message->line, 1, 1};
        if (!message->name ||
            !glsl_find_in_line(&message->loc, message->name, message->name_length)) {
            size_t width;
            const char *at = line_of(&message->loc, &width);
            while (at && width-- && isspace((unsigned char)*at++))
                message->loc.column++;
        }
    }
    return message->length;
}

static bool says(const struct compiler_message *message, const char *text)
{
    return memmem(message->text, message->length, text, strlen(text));
}

/* The name as text, in the model's arena; "" when there is none. */
static const char *message_name(struct model *model, const struct compiler_message *message)
{
    const char *name =
        message->name ? arena_strndup(model->arena, message->name, message->name_length) : "";
    return name ? name : "";
}

/* ---- Names of the spec ----------------------------------------------------------------------- */

static bool is_atomic(const char *ending)
{
    return !strncmp(ending, "_atomic", 7);
}

static bool is_sampled(const char *ending)
{
    return !strncmp(ending, "_sample", 7) || !strcmp(ending, "_compare");
}

/* A name that the body uses and that is of a resource. */
struct name_use {
    const struct resource *resource;
    const struct access *access;  /* of the pass, by this word; NULL: the pass does not list it */
    const struct access *renamed; /* that the pass lists with another word */
    const char *ending;
};

static const char *ending_of(const struct resource *resource, const char *name, const char *word)
{
    enum declared_kind kind = resource->kind == DT_IMAGE ? DECLARED_IMAGE : DECLARED_BUFFER;
    return declared_ending(kind, name, word);
}

static bool find_use(const struct pipeline *pipeline, const struct pass *pass, const char *word,
                     struct name_use *use)
{
    *use = (struct name_use){0};
    EACH(access, pass->accesses, pass->access_count) {
        const char *ending =
            access->resource ? ending_of(access->resource, access_word(access), word) : NULL;
        if (ending && (!use->access || access->mode != MODE_READ))
            *use = (struct name_use){access->resource, access, NULL, ending};
    }
    for (uint32_t i = 0; !use->access && i < pipeline->resource_count; i++) {
        const struct resource *resource = &pipeline->resources[i];
        const char *ending = ending_of(resource, resource->name, word);
        if (ending)
            *use = (struct name_use){.resource = resource, .ending = ending};
    }
    for (uint32_t i = 0; use->resource && !use->access && !use->renamed && i < pass->access_count;
         i++)
        if (pass->accesses[i].resource == use->resource)
            use->renamed = &pass->accesses[i];
    return use->resource;
}

/* False: the pass lists the name rightly, so something else is wrong with the call. */
static bool report_listed(const struct pass *pass, const struct name_use *use, struct loc loc,
                          struct diag *diag)
{
    const char *word = access_word(use->access);
    enum dt_format format = use->resource->format;
    bool atomic = is_atomic(use->ending), updates = use->access->mode == MODE_UPDATE;
    if (atomic && (!updates || pass->kind != DT_PASS_DISPATCH))
        diag_error(diag, loc,
                   "the pass `%s` changes `%s` atomically; make it a dispatch that lists it in "
                   "updates",
                   pass->name, word);
    else if (atomic && format != DT_FORMAT_R32UI && format != DT_FORMAT_R32I)
        diag_error(diag, loc, "`%s` has the format %s; atomic functions need r32ui or r32i", word,
                   format_info(format)->name);
    else if (!strcmp(use->ending, "_store") && use->access->mode == MODE_READ)
        diag_error(diag, loc, "the pass `%s` stores to `%s` but lists it only in reads", pass->name,
                   word);
    else if (!use->access->sampler && is_sampled(use->ending))
        diag_error(diag, loc,
                   "the pass `%s` samples `%s` but lists it without a `sampler`: {name: %s, "
                   "sampler: ...}",
                   pass->name, word, use->access->name);
    else
        return false;
    return true;
}

/* A name that nothing declares: of a resource that the pass does not list, or not so. */
static bool report_use(const struct pipeline *pipeline, const struct pass *pass, const char *word,
                       struct loc loc, struct diag *diag)
{
    struct name_use use;
    if (!find_use(pipeline, pass, word, &use))
        return false;
    if (use.access)
        return report_listed(pass, &use, loc, diag);
    if (use.renamed)
        diag_error(diag, loc, "the pass `%s` lists `%s` as `%s`; use `%s` in its body", pass->name,
                   use.resource->name, use.renamed->as, use.renamed->as);
    else
        diag_error(diag, loc, "the pass `%s` uses `%s` but does not list it in %s", pass->name,
                   use.resource->name,
                   !strcmp(use.ending, "_store") ? "writes"
                   : is_atomic(use.ending)       ? "updates"
                                                 : "reads");
    return true;
}

/* The sampler, metric or interleave that the word belongs to; NULL: none. */
static const char *tool_of(const struct pipeline *pipeline, const char *word)
{
    enum declared_kind kind;
    const struct declared *of;
    for (size_t i = 0; (of = declared_at(pipeline, i, &kind)); i++)
        if (kind & DECLARED_FUNCTION && kind != DECLARED_FILTER &&
            declared_ending(kind, of->name, word))
            return of->name;
    return NULL;
}

/* Where the spec declares what the pass's body knows by this word. *what: its kind, or NULL. */
static struct loc declaration_of(const struct pipeline *pipeline, const struct pass *pass,
                                 const char *word, const char **what)
{
    static const enum declared_kind kinds[] = {DECLARED_PARAM, DECLARED_CONSTANT, DECLARED_STRUCT};
    struct name_use use;
    *what = NULL;
    if (find_use(pipeline, pass, word, &use) && use.access) {
        *what = use.resource->kind == DT_IMAGE ? "image" : "buffer";
        return use.access->loc;
    }
    for (size_t i = 0; i < DT_ARRAY_COUNT(kinds); i++) {
        const struct declared *of = declared_find(pipeline, kinds[i], word);
        *what = of ? declared_word(kinds[i]) : NULL;
        if (of)
            return of->loc;
    }
    for (uint32_t i = 0; i < pass->use_count; i++) {
        const char *tool = tool_of(pipeline, word);
        if (tool && !strcmp(pass->uses[i], tool)) {
            *what = "sampler, metric or interleave";
            return pass->use_locs[i];
        }
    }
    for (uint32_t i = 0; i < pass->define_count; i++)
        if (!strcmp(pass->defines[i].name, word)) {
            *what = "define";
            return pass->defines[i].loc;
        }
    return (struct loc){0};
}

/* ---- Declared twice -------------------------------------------------------------------------- */

/* Whether the message is of a second declaration; *name is what is declared. */
static bool is_redefinition(struct model *model, const struct compiler_message *message,
                            const char **name)
{
    static const char macro[] = "Macro redefined; ";
    *name = message_name(model, message);
    if (says(message, macro)) {
        const char *colon = memrchr(message->text, ':', message->length);
        const char *word = colon ? colon + 1 + strspn(colon + 1, " ") : "";
        const char *copy = arena_strndup(model->arena, word, strcspn(word, " \n"));
        *name = copy ? copy : *name;
        return copy;
    }
    return says(message, "redefinition") || says(message, "function already has a body") ||
           says(message, "redeclaration");
}

/* Words that stand before a name without declaring it. */
static bool is_keyword(const char *word, size_t length)
{
    static const char *const words[] = {"return", "else", "case"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
        if (length == strlen(words[i]) && !memcmp(word, words[i], length))
            return true;
    return false;
}

static bool add_word(struct model *model, const char *const **list, uint32_t *count,
                     const char *word)
{
    for (uint32_t i = 0; i < *count; i++)
        if (!strcmp((*list)[i], word))
            return false;
    const char **longer = arena_alloc(model->arena, (*count + 1) * sizeof *longer);
    if (!longer)
        return false;
    if (*count)
        memcpy(longer, *list, *count * sizeof *longer);
    longer[(*count)++] = word;
    *list = longer;
    return true;
}

/* Adds the functions that a line declares: words before a parenthesis and behind a type. For messages
 * that name a qualifier alone. */
static bool add_functions(struct model *model, struct shader *shader,
                          const struct compiler_message *message)
{
    size_t width;
    const char *line = line_of(&message->loc, &width);
    bool changed = false;
    for (size_t i = 0; line && i < width; i++) {
        size_t end = i, begin, type;
        if (line[i] != '(')
            continue;
        while (end && isspace((unsigned char)line[end - 1]))
            end--;
        for (begin = end; begin && text_is_word(line[begin - 1]);)
            begin--;
        for (type = begin; type && isspace((unsigned char)line[type - 1]);)
            type--;
        size_t length = 0;
        while (length < type && text_is_word(line[type - length - 1]))
            length++;
        const char *name =
            end > begin && type < begin && length && !is_keyword(line + type - length, length)
                ? arena_strndup(model->arena, line + begin, end - begin)
                : NULL;
        changed |= name && strcmp(name, "main") != 0 &&
                   add_word(model, &shader->own_names, &shader->own_count, name);
    }
    return changed;
}

/* The word of the body that another name stands for, because the generator or GLSL has it; NULL: the name is the body's. */
static const char *own_word(const struct shader *shader, const char *name)
{
    for (uint32_t i = 0; i < shader->own_count && !strncmp(name, "body_", 5); i++)
        if (!strcmp(shader->own_names[i], name + 5))
            return name + 5;
    return NULL;
}

bool glsl_adapt(struct model *model, const struct pass *pass, struct shader *shader,
                const char *log)
{
    const char *name, *what;
    struct compiler_message message;
    bool changed = false;
    for (const char *at = log; *at;) {
        if (!read_message(model, &at, &message) || !message.loc.source)
            continue;
        if (is_redefinition(model, &message, &name)) {
            declaration_of(&model->pipeline, pass, name, &what);
            changed |= !what && *name && !own_word(shader, name) &&
                       add_word(model, &shader->own_names, &shader->own_count, name);
        } else if (says(&message, "overloaded functions must have the same")) {
            changed |= add_functions(model, shader, &message); /* of GLSL's own names */
        } else if (says(&message, "undeclared identifier") ||
                   says(&message, "no matching overloaded function")) {
            name = message_name(model, &message); /* made by ## */
            changed |= add_word(model, &shader->wanted, &shader->wanted_count, name);
        }
    }
    return changed;
}

/* A constant that depends on the frame or on a uniform parameter is a macro: a body that declares its
 * name gets a syntax error. The constant whose name stands behind a type in the line; NULL: none. */
static const struct constant *redeclared_constant(const struct pipeline *pipeline,
                                                  const struct compiler_message *message)
{
    EACH(constant, pipeline->constants, pipeline->constant_count) {
        struct loc loc = message->loc;
        size_t width;
        const char *line = line_of(&loc, &width);
        if (!line || !glsl_find_in_line(&loc, constant->name, strlen(constant->name)))
            continue;
        const char *before = line + loc.column - 1;
        while (before > line && isspace((unsigned char)before[-1]))
            before--;
        size_t length = 0;
        while (before - length > line && text_is_word(before[-1 - (ptrdiff_t)length]))
            length++;
        if (length && before < line + loc.column - 1 && !is_keyword(before - length, length))
            return constant;
    }
    return NULL;
}

static bool report_macro(const struct pipeline *pipeline, const struct pass *pass,
                         const struct compiler_message *message, struct diag *diag)
{
    const struct constant *constant =
        says(message, "syntax error") || says(message, "l-value required")
            ? redeclared_constant(pipeline, message)
            : NULL;
    struct loc loc = message->loc;
    if (!constant)
        return false;
    glsl_find_in_line(&loc, constant->name, strlen(constant->name));
    diag_error(
        diag, loc,
        "the body declares `%s`, which is the name of a constant in the pass `%s`; rename it",
        constant->name, pass->name);
    diag_note(diag, constant->loc, "`%s` is declared here", constant->name);
    return true;
}

static bool report_redefinition(struct model *model, const struct pass *pass,
                                const struct compiler_message *message, struct diag *diag)
{
    const char *name, *what;
    if (!is_redefinition(model, message, &name))
        return false;
    struct loc declared = declaration_of(&model->pipeline, pass, name, &what);
    if (!what)
        return false;
    struct loc loc = message->loc;
    glsl_find_in_line(&loc, name, strlen(name));
    diag_error(diag, loc,
               "the body declares `%s`, which is the name of %s %s in the pass `%s`; rename it%s",
               name, strchr("aeiou", *what) ? "an" : "a", what, pass->name,
               !strcmp(what, "image") || !strcmp(what, "buffer")
                   ? ", or give the access another name with `as`"
                   : "");
    diag_note(diag, declared, "`%s` is declared here", name);
    return true;
}

/* ---- Reports --------------------------------------------------------------------------------- */

static void note_uniform(const struct loc *error, const char *name, struct loc declared,
                         struct diag *diag)
{
    struct loc used = *error;
    if (glsl_find_in_line(&used, name, strlen(name)))
        diag_note(diag, declared,
                  "`%s` is in a uniform block, so it is not a constant expression in shaders",
                  name);
}

/* After an error about a constant: notes the uniform names in its line, which are not constant. */
static void note_uniforms(const struct pipeline *pipeline, const struct loc *error,
                          struct diag *diag)
{
    EACH(param, pipeline->params, pipeline->param_count)
        if (param->uniform)
            note_uniform(error, param->name, param->loc, diag);
    EACH(constant, pipeline->constants, pipeline->constant_count)
        if (constant->folds && !constant_is_literal(constant))
            note_uniform(error, constant->name, constant->loc, diag);
}

/* An error about a subgroup operation where a pass cannot have one. */
static bool report_subgroups(const struct pass *pass, const struct compiler_message *message,
                             struct diag *diag)
{
    static const char *const starts[] = {"subgroup", "gl_Subgroup", "gl_NumSubgroups"};
    struct loc loc = message->loc;
    size_t length = 0;
    const char *name = NULL;
    if (pass->fast && pass->kind == DT_PASS_DISPATCH)
        return false;
    bool about = message->name && !strncmp(message->name, "subgroup op", 11);
    for (size_t i = 0; i < DT_ARRAY_COUNT(starts) && !length; i++)
        if (about || (message->name && !strncmp(message->name, starts[i], strlen(starts[i]))))
            name = prefix_in_line(&loc, starts[i], &length);
    if (!length)
        return about; /* another message has the name */
    diag_error(diag, loc,
               pass->fast
                   ? "`%.*s` in a draw: only a dispatch can have subgroup operations"
                   : "`%.*s` needs `exactness: fast`: the size of subgroups, and the order in "
                     "which they reduce, differ from device to device; use shared memory",
               (int)length, name);
    return true;
}

static bool report_include(const struct model *model, const struct compiler_message *message,
                           struct diag *diag)
{
    static const char could[] = "Could not process include directive for header name: ";
    const char *name = memmem(message->text, message->length, could, sizeof could - 1);
    if (!name)
        return false;
    name += sizeof could - 1;
    size_t length = (size_t)(message->text + message->length - name);
    while (length && name[length - 1] == ' ')
        length--;
    struct loc loc = message->loc;
    glsl_find_in_line(&loc, name, length);
    diag_error(diag, loc, "cannot read %.*s, neither beside this file nor in %s or %s/glsl",
               (int)length, name, model->templates_dir, model->templates_dir);
    return true;
}

static bool is_unknown(const struct compiler_message *message)
{
    return says(message, "undeclared identifier") ||
           says(message, "no matching overloaded function");
}

/* What the spec's author has to change. False: the message is of GLSL alone. */
static bool report_author(struct model *model, const struct pass *pass,
                          const struct compiler_message *message, struct diag *diag)
{
    const char *name = message_name(model, message);
    if (report_subgroups(pass, message, diag) || report_redefinition(model, pass, message, diag) ||
        report_macro(&model->pipeline, pass, message, diag) || report_include(model, message, diag))
        return true;
    if (says(message, "SPIR-V 1.") || says(message, "targeted SPIR-V")) {
        diag_error(diag, message->loc, "`%s` needs a later SPIR-V than OpenGL takes", name);
        return true;
    }
    const char *tool = is_unknown(message) ? tool_of(&model->pipeline, name) : NULL;
    struct loc loc = message->loc;
    if (is_unknown(message) && !strncmp(name, "body_", 5) &&
        glsl_find_in_line(&loc, name + 5, strlen(name + 5)))
        diag_error(
            diag, loc,
            "the body has a function `%s` of its own, which hides GLSL's forms of it; rename "
            "the body's",
            name + 5);
    else if (is_redefinition(model, message, &name) && !strncmp(name, "body_", 5) &&
             glsl_find_in_line(&loc, name + 5, strlen(name + 5)))
        diag_error(diag, loc,
                   "the body declares `%s` twice; a file that is included twice needs a guard "
                   "(#ifndef)",
                   name + 5);
    else if (tool)
        diag_error(diag, message->loc, "the pass `%s` uses `%s` but does not list it in uses",
                   pass->name, tool);
    else if (!strcmp(name, "#version"))
        diag_error(diag, message->loc, "the generator writes #version: remove it");
    else
        return is_unknown(message) && report_use(&model->pipeline, pass, name, message->loc, diag);
    return true;
}

/* Adds the text of a message without what no author wrote: glslang's precisions and storage. */
static void add_plain(struct text *out, const struct compiler_message *message)
{
    static const char *const noise[] = {" temp ", "temp ", "mediump ", "highp "};
    for (size_t i = 0; i < message->length;) {
        size_t skipped = 0;
        for (size_t k = 0; k < DT_ARRAY_COUNT(noise) && !skipped; k++)
            if (!strncmp(message->text + i, noise[k], strlen(noise[k])))
                skipped = strlen(noise[k]);
        if (!skipped)
            text_add(out, "%c", message->text[i]);
        i += skipped ? skipped : 1;
    }
    while (out->length && out->data[out->length - 1] == ' ')
        out->data[--out->length] = '\0';
}

/* Adds the forms of a function that the generator has made, from the text in front of the body. */
static void add_forms(struct text *out, const char *glsl, const char *name)
{
    const char *before = "; there is";
    size_t length = strlen(name);
    for (const char *line = glsl; line && *name && strncmp(line, "#line 1 ", 8) != 0;
         line = strchr(line, '\n')) {
        line += *line == '\n';
        const char *open = line + strcspn(line, "(\n"), *word = open - length;
        if (*open != '(' || !isalpha((unsigned char)*line) || word <= line || word[-1] != ' ' ||
            strncmp(word, name, length) != 0)
            continue;
        text_add(out, "%s `%.*s`", before, (int)strcspn(line, ")\n") + 1, line);
        before = ",";
    }
}

/* Adds the name of the spec, with its ending, that an unknown one is near to. */
static void add_near(struct text *out, struct model *model, const struct pass *pass,
                     const char *name)
{
    const struct pipeline *pipeline = &model->pipeline;
    uint32_t count = 0,
             most = pass->access_count + pipeline->param_count + pipeline->constant_count;
    const char **names = arena_alloc(model->arena, (most + 1) * sizeof *names), *ending = "";
    EACH(derived, derived_words, DERIVED_WORDS) {
        size_t own = strlen(derived->ending), length = strlen(name);
        if (derived->kinds & DECLARED_IMAGE && length > own &&
            !strcmp(name + length - own, derived->ending))
            ending = derived->ending;
    }
    for (uint32_t i = 0; names && i < pass->access_count; i++)
        names[count++] = access_word(&pass->accesses[i]);
    for (uint32_t i = 0; names && !*ending && i < pipeline->param_count; i++)
        names[count++] = pipeline->params[i].name;
    for (uint32_t i = 0; names && !*ending && i < pipeline->constant_count; i++)
        names[count++] = pipeline->constants[i].name;
    const char *stem = arena_strndup(model->arena, name, strlen(name) - strlen(ending));
    const char *near = stem && names ? nearest_name(stem, names, count) : NULL;
    if (near)
        text_add(out, "; did you mean `%s%s`?", near, ending);
}

static void report_glsl(struct model *model, const struct pass *pass, const char *glsl,
                        const struct compiler_message *message, struct diag *diag)
{
    struct text text = {0};
    if (message->name_length)
        text_add(&text, "'%.*s' : ", (int)message->name_length, message->name);
    add_plain(&text, message);
    size_t plain = text.length;
    if (is_unknown(message))
        add_forms(&text, glsl, message_name(model, message));
    if (is_unknown(message) && text.length == plain)
        add_near(&text, model, pass, message_name(model, message));
    const char *words = text.data ? text.data : message->text;
    if (!message->loc.source)
        diag_error(diag, pass->shader_loc, "pass %s, line %lu of the generated GLSL: %s",
                   pass->name, message->line, words);
    else
        diag_error(diag, message->loc, "%s", words);
    text_free(&text);
}

/* Whether an earlier message of the log is about the same name, or in the same line. */
static bool has_earlier(struct model *model, const char *log,
                        const struct compiler_message *message, bool in_line)
{
    struct compiler_message earlier;
    while (*log && log < message->text)
        if (read_message(model, &log, &earlier) && earlier.text != message->text &&
            (in_line ? earlier.loc.source && earlier.loc.source == message->loc.source &&
                           earlier.line == message->line
                     : earlier.name_length && earlier.name_length == message->name_length &&
                           !memcmp(earlier.name, message->name, message->name_length)))
            return true;
    return false;
}

void glsl_report(struct model *model, const struct pass *pass, const char *glsl, const char *log,
                 struct diag *diag)
{
    unsigned before = diag_error_count(diag);
    struct compiler_message message;
    for (const char *at = log; *at;)
        if (read_message(model, &at, &message) && message.loc.source &&
            !has_earlier(model, log, &message, false))
            report_author(model, pass, &message, diag);
    bool told = diag_error_count(diag) > before; /* what else does not fit may follow from it */
    struct diag *silent = diag_create();
    for (const char *at = log; silent && *at;) {
        if (!read_message(model, &at, &message) ||
            (told && !says(&message, "undeclared identifier")) ||
            (!says(&message, "undeclared identifier") &&
             has_earlier(model, log, &message, true)) || /* it follows from that */
            (message.loc.source && report_author(model, pass, &message, silent)))
            continue;
        report_glsl(model, pass, glsl, &message, diag);
        if (message.loc.source && says(&message, "constant"))
            note_uniforms(&model->pipeline, &message.loc, diag);
    }
    diag_free(silent);
    if (diag_error_count(diag) == before && !strstr(log, "ERROR: "))
        diag_error(diag, pass->shader_loc, "pass `%s`: %s", pass->name, log); /* of bind.c */
    else if (diag_error_count(diag) == before)
        diag_error(diag, pass->shader_loc, "pass %s does not compile: %s", pass->name, log);
}
