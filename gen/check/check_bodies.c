/* Pass bodies: their files, and what the plan asks of them. Also the warnings about declarations
 * that nothing names. */
#include <string.h>

#include "read/body_files.h"
#include "checks.h"

/* ---- Files ----------------------------------------------------------------------------------- */

/* Reads a file that a pass names. key: the spec's word for the file; loc: of its name. */
static const struct source *read_body(struct checker *c, const char *key, const char *name,
                                      struct loc loc)
{
    const char *near = source_candidate(c->model, loc.source->path, name, strlen(name), 0);
    const char *below = source_candidate(c->model, loc.source->path, name, strlen(name), 1);
    const char *near_reason = "out of memory", *below_reason = near_reason;
    const struct source *source = near ? source_read(c->model, near, &near_reason) : NULL;
    if (!source && below)
        source = source_read(c->model, below, &below_reason);
    if (!source && !strcmp(near_reason, below_reason))
        diag_error(c->diag, loc, "cannot read the %s `%s`; looked for `%s` and `%s`", key, name,
                   near ? near : "?", below ? below : "?");
    else if (!source)
        diag_error(c->diag, loc, "cannot read the %s `%s`: `%s`: %s; `%s`: %s", key, name,
                   near ? near : "?", near_reason, below ? below : "?", below_reason);
    return source;
}

/* Two files, one after the other, as one that includes both; of whole shaders each is a stage. */
static const struct source *join_bodies(struct checker *c, const struct pass *pass)
{
    struct source *body = arena_alloc(c->model->arena, sizeof *body);
    bool whole = source_is_whole(pass->body);
    if (!read_body(c, "shader", pass->more, pass->shader_loc) || !body)
        return NULL;
    body->path = pass->shader_loc.source->path;
    body->text = arena_printf(c->model->arena, "%s#include \"%s\"\n%s#include \"%s\"\n%s",
                              whole ? "#ifdef VERTEX\n" : "", pass->shader, whole ? "#else\n" : "",
                              pass->more, whole ? "#endif\n" : "");
    body->length = body->text ? strlen(body->text) : 0;
    return body->text ? body : NULL;
}

/* The path of a body that an included file names, as the spec would write it: from the templates or
 * from the spec's folder. */
static const char *body_name(struct checker *c, const char *name, struct loc loc,
                             const struct source *body)
{
    const char *folders[] = {source_candidate(c->model, "", "", 0, 1),
                             source_candidate(c->model, c->pipeline->spec, "", 0, 0)};
    if (!loc.source->included.source || !body)
        return name;
    for (size_t i = 0; i < DT_ARRAY_COUNT(folders); i++)
        if (folders[i] && !strncmp(body->path, folders[i], strlen(folders[i])))
            return body->path + strlen(folders[i]);
    return name;
}

enum { MAX_CALLS = 16 }; /* GLSL has no recursion; a limit for wrong bodies */

/* ---- What the plan asks ---------------------------------------------------------------------- */

/* Whether the body depends on the workgroup's size: it uses shared memory, barriers, or built-ins
 * of the workgroup or subgroup. */
static bool minds_group(const struct body_files *files)
{
    static const char *const words[] = {"shared", "barrier", "groupMemoryBarrier",
                                        "memoryBarrierShared"};
    static const char *const prefixes[] = {"gl_Local", "gl_WorkGroup", "gl_NumWorkGroups",
                                           "gl_Subgroup", "subgroup"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
        if (body_mentions(files, words[i]))
            return true;
    for (size_t i = 0; i < DT_ARRAY_COUNT(prefixes); i++)
        if (body_mentions_prefix(files, prefixes[i]))
            return true;
    return false;
}

/* Behind the name of a function of the body, where it is declared; NULL: it is none. */
static const char *function_named(const struct body_files *files, struct token name)
{
    for (uint32_t i = 0; i < files->count; i++) {
        const char *cursor = files->list[i].code;
        struct token before = {0}, token = token_next(&cursor);
        for (; token.length; before = token, token = token_next(&cursor))
            if (token.length == name.length && !memcmp(token.text, name.text, name.length) &&
                cursor[strspn(cursor, " \t\n")] == '(' && token_is_word(before) &&
                !token_is(before, "return") && !token_is(before, "else"))
                return cursor;
    }
    return NULL;
}

static bool reads_image(const struct pass *pass, struct token token)
{
    EACH(access, pass->accesses, pass->access_count) {
        const char *word = access_word(access);
        size_t length = strlen(word);
        if (access->resource && access->resource->kind == DT_IMAGE && token.length >= length &&
            !strncmp(token.text, word, length) &&
            (token.length == length || token.text[length] == '_'))
            return true;
    }
    return false;
}

/* Adds what the next block does, itself and in functions of the body, to `range`. */
static void note_block(const struct pass *pass, const char *cursor, int calls, struct range *range)
{
    struct token before = {0}, token = token_next(&cursor);
    for (int depth = 0; token.length; before = token, token = token_next(&cursor)) {
        depth += token_is(token, "{") - token_is(token, "}");
        if (!depth && token_is(token, "}"))
            break;
        if (depth < 1 || !token_is_word(token))
            continue;
        bool called = cursor[strspn(cursor, " \t\n")] == '(';
        const char *function = called ? function_named(pass->files, token) : NULL;
        range->words += range->words < INT32_MAX;
        range->reads_images |= !token_is(before, ".") && reads_image(pass, token);
        if (function && calls < MAX_CALLS && range->words < INT32_MAX)
            note_block(pass, function, calls + 1, range);
    }
}

/* Notes what a loop over a range does, since that says how long it is when unrolled; and whether the body asks for the
 * length of an array: of a buffer whose count is not fixed by the parameters it would be that of the limit, so plan.c reads
 * such buffers as storage, except in a range with `storage: uniform`. */
static void note_range(struct checker *c, const struct pass *pass, struct range *range)
{
    const struct access *access = range->access;
    bool fixed = range->storage != STORAGE_UNIFORM || !access || !access->resource ||
                 !access->resource->count || expr_is_literal(access->resource->count);
    for (uint32_t i = 0; i < pass->files->count; i++) {
        const char *cursor = pass->files->list[i].code;
        struct token last[2] = {{0}}, token = token_next(&cursor);
        for (; token.length; last[1] = last[0], last[0] = token, token = token_next(&cursor)) {
            if (token_is(last[0], ":") && token_is(token, range->name))
                note_block(pass, cursor, 0, range);
            if (!fixed && token_is(token, "length") && token_is(last[0], ".") &&
                token_is(last[1], access_word(access)))
                diag_error(c->diag, range->loc,
                           "`%s.length()`: the range `%s` has `storage: uniform`, and a uniform "
                           "block has no length; use `%s_count`",
                           access_word(access), range->name, access_word(access));
        }
    }
}

static void check_body(struct checker *c, struct pass *pass)
{
    if (!pass->shader)
        return;
    pass->body = read_body(c, "shader", pass->shader, pass->shader_loc);
    if (pass->body && pass->more)
        pass->body = join_bodies(c, pass);
    pass->files = pass->body ? body_files_read(c->model, pass->body) : NULL;
    c->out_of_memory |= pass->body && !pass->files;
    if (!pass->files)
        return;
    if (!files_are_whole(pass->files))
        check_body_words(c, pass);
    pass->shader =
        pass->more ? pass->more : body_name(c, pass->shader, pass->shader_loc, pass->body);
    pass->minds_group = minds_group(pass->files);
    pass->asks_length = body_mentions_member(pass->files, "length");
    CHANGE_EACH(range, pass->ranges, pass->range_count)
        note_range(c, pass, range);
    pass->own_vertices = body_asks_for(pass->files, "VERTEX");
    if (pass->kind == DT_PASS_DRAW_VERTICES && !pass->own_vertices)
        diag_error(c->diag, pass->shader_loc,
                   "the pass `%s` draws vertices, but its body has no part `#ifdef VERTEX`",
                   pass->name);
    if (pass->topology == DT_POINTS && !body_mentions(pass->files, "gl_PointSize"))
        diag_error(c->diag, pass->shader_loc,
                   "the pass `%s` draws points, but its body does not write gl_PointSize",
                   pass->name);
}

void check_bodies(struct checker *c)
{
    CHANGE_EACH(pass, c->pipeline->passes, c->pipeline->pass_count)
        check_body(c, pass);
}

/* Whether a GLSL expression of the spec contains the name as a whole word. */
static bool text_mentions(const char *text, const char *name)
{
    return find_word(text, name);
}

/* ---- Unused declarations --------------------------------------------------------------------- */

static bool in_bodies(const struct checker *c, const char *name)
{
    const char *dot = strrchr(name, '.'); /* bodies of an instance use the last part */
    name = dot ? dot + 1 : name;
    EACH(pass, c->pipeline->passes, c->pipeline->pass_count) {
        EACH(define, pass->defines, pass->define_count)
            if (define->param && !strcmp(define->param, name) &&
                body_mentions(pass->files, define->name))
                return true;
        if (body_mentions_value(pass->files, name))
            return true;
    }
    return false;
}

static bool is_named(const struct weight *weight, const char *name)
{
    return weight->param && !strcmp(weight->param, name);
}

static bool in_values(const struct value *values, uint32_t count, const char *name)
{
    EACH(value, values, count)
        if (text_mentions(value->text, name))
            return true;
    return false;
}

static bool in_expressions(const struct checker *c, const char *name)
{
    if (in_values(c->pipeline->values, c->pipeline->value_count, name))
        return true;
    for (size_t i = 0; i < c->expr_count; i++)
        if (expr_mentions(c->exprs[i], name))
            return true;
    EACH(pass, c->pipeline->passes, c->pipeline->pass_count) {
        EACH(range, pass->ranges, pass->range_count)
            if (text_mentions(range->first, name))
                return true;
        if (in_values(pass->values, pass->value_count, name))
            return true;
    }
    EACH(metric, c->pipeline->metrics, c->pipeline->metric_count)
        if (is_named(&metric->position, name) || is_named(&metric->normal, name))
            return true;
    for (const struct replaced *at = c->model->replaced; at; at = at->next)
        if (text_mentions(at->text, name))
            return true;
    return false;
}

static bool lists(const struct pass *pass, const char *resource)
{
    EACH(access, pass->accesses, pass->access_count)
        if (!strcmp(access->name, resource))
            return true;
    return false;
}

static bool accessed(const struct checker *c, const struct resource *resource)
{
    EACH(pass, c->pipeline->passes, c->pipeline->pass_count)
        if (lists(pass, resource->name) || pass->indirect_resource == resource ||
            pass->index_resource == resource)
            return true;
    return false;
}

static bool used_in_passes(const struct checker *c, const char *name)
{
    EACH(pass, c->pipeline->passes, c->pipeline->pass_count) {
        for (uint32_t k = 0; k < pass->use_count; k++)
            if (!strcmp(pass->uses[k], name))
                return true;
        EACH(access, pass->accesses, pass->access_count)
            if (access->sampler && !strcmp(access->sampler, name))
                return true;
    }
    return false;
}

static bool struct_used(const struct checker *c, const struct structure *structure)
{
    EACH(resource, c->pipeline->resources, c->pipeline->resource_count)
        if (resource->structure == structure)
            return true;
    return in_bodies(c, structure->name);
}

static void check_metric_fields(struct checker *c, const struct metric *metric)
{
    const char *const names[] = {metric->position_field, metric->normal_field};
    for (int i = 0; i < 2; i++) {
        bool found = !strcmp(names[i], i ? "normal" : "position");
        EACH(structure, c->pipeline->structs, c->pipeline->struct_count)
            EACH(field, structure->fields, structure->field_count)
                found |= !strcmp(field->name, names[i]);
        if (!found)
            diag_warning(c->diag, metric->loc,
                         "no struct has the field `%s` that the metric `%s` looks for", names[i],
                         metric->name);
    }
}

static bool is_used(const struct checker *c, enum declared_kind kind, const struct declared *of)
{
    if (kind & (DECLARED_PARAM | DECLARED_CONSTANT))
        return in_expressions(c, of->name) || in_bodies(c, of->name);
    if (kind == DECLARED_STRUCT)
        return struct_used(c, (const struct structure *)of);
    if (kind & DECLARED_RESOURCE)
        return accessed(c, (const struct resource *)of);
    return used_in_passes(c, of->name);
}

void check_unused(struct checker *c)
{
    enum declared_kind kind;
    const struct declared *of;
    for (size_t i = 0; (of = declared_at(c->pipeline, i, &kind)) && kind != DECLARED_PASS; i++) {
        if (!is_used(c, kind, of))
            diag_warning(c->diag, of->loc, "the %s `%s` is not used", declared_word(kind),
                         of->name);
        if (kind == DECLARED_METRIC)
            check_metric_fields(c, (const struct metric *)of);
    }
}
