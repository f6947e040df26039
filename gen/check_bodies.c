/* Pass bodies: the files exist, their identifiers are names that the pass lists, and they use every
 * listed name. Also the warnings about unused declarations. Called by check.c. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "plan.h"

enum { DEEPEST_INCLUDE = 16 };

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

/* Two files, one after the other, as one that includes both. */
static const struct source *join_bodies(struct checker *c, const struct pass *pass)
{
    struct source *body = arena_alloc(c->model->arena, sizeof *body);
    if (!read_body(c, "shader", pass->more, pass->shader_loc) || !body)
        return NULL;
    body->path = pass->shader_loc.source->path;
    body->text = arena_printf(c->model->arena, "#include \"%s\"\n#include \"%s\"\n", pass->shader,
                              pass->more);
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

/* ---- Identifiers ----------------------------------------------------------------------------- */

struct scan {
    struct checker *c;
    struct body *body;
    const struct source *source;
    const char *at, *end, *line_start;
    int line, depth; /* of braces */
    char before;
};

/* depth: of includes; level: of braces around the include. */
static void scan_source(struct checker *c, struct body *body, const struct source *source,
                        int depth, int level);

static void add_token(struct scan *s, const char *text, int length)
{
    struct body *body = s->body;
    if (body->count == body->capacity) {
        size_t capacity = body->capacity ? 2 * body->capacity : 256;
        struct token *tokens = realloc(body->tokens, capacity * sizeof *tokens);
        if (!tokens) {
            s->c->out_of_memory = true;
            return;
        }
        body->tokens = tokens;
        body->capacity = capacity;
    }
    const char *next = text + length;
    while (next < s->end && isspace((unsigned char)*next))
        next++;
    struct loc loc = {s->source, s->line, (int)(text - s->line_start) + 1, length};
    body->tokens[body->count++] =
        (struct token){text, length, loc, s->before, next < s->end ? *next : '\0', s->depth};
}

static bool skip_comment(struct scan *s)
{
    if (s->at + 1 >= s->end || s->at[0] != '/' || (s->at[1] != '/' && s->at[1] != '*'))
        return false;
    bool line = s->at[1] == '/';
    for (s->at += 2; s->at < s->end; s->at++) {
        if (line && *s->at == '\n')
            return true;
        if (!line && s->at[0] == '*' && s->at + 1 < s->end && s->at[1] == '/') {
            s->at += 2;
            return true;
        }
        if (*s->at == '\n') {
            s->line++;
            s->line_start = s->at + 1;
        }
    }
    return true;
}

/* #include "FILE", searched for as in glsl_body.c, which reports a missing file. */
static bool take_include(struct scan *s, int depth)
{
    const char *at = s->at + 1, *stop = memchr(s->at, '\n', (size_t)(s->end - s->at));
    stop = stop ? stop : s->end;
    while (at < stop && isblank((unsigned char)*at))
        at++;
    if (stop - at < 7 || strncmp(at, "include", 7))
        return false;
    const char *open = memchr(at, '"', (size_t)(stop - at));
    const char *close = open ? memchr(open + 1, '"', (size_t)(stop - open - 1)) : NULL;
    s->at = stop;
    if (!close || depth >= DEEPEST_INCLUDE)
        return true;
    int length = (int)(close - open - 1);
    const struct source *source = NULL;
    for (int place = 0; place < 3 && !source; place++) {
        const char *reason,
            *path = source_candidate(s->c->model, s->source->path, open + 1, (size_t)length, place);
        source = path ? source_read(s->c->model, path, &reason) : NULL;
    }
    if (source)
        scan_source(s->c, s->body, source, depth + 1, s->depth);
    return true;
}

static void scan_source(struct checker *c, struct body *body, const struct source *source,
                        int depth, int level)
{
    struct scan s = {c, body,  source, source->text, source->text + source->length, source->text,
                     1, level, 0};
    while (s.at < s.end) {
        unsigned char first = (unsigned char)*s.at;
        if (skip_comment(&s) || (first == '#' && take_include(&s, depth)))
            continue;
        if (isalpha(first) || first == '_') {
            const char *start = s.at;
            while (s.at < s.end && (isalnum((unsigned char)*s.at) || *s.at == '_'))
                s.at++;
            add_token(&s, start, (int)(s.at - start));
            s.before = 'a';
            continue;
        }
        if (isdigit(first)) { /* 1.0f, 0x1fu: no identifiers */
            while (s.at < s.end && (isalnum((unsigned char)*s.at) || *s.at == '.'))
                s.at++;
            s.before = '0';
            continue;
        }
        if (first == '\n') {
            s.line++;
            s.line_start = s.at + 1;
        }
        s.depth += (first == '{') - (first == '}');
        if (!isspace(first))
            s.before = (char)first;
        s.at++;
    }
}

static bool token_is(const struct token *token, const char *name)
{
    return (size_t)token->length == strlen(name) &&
           !memcmp(token->text, name, (size_t)token->length);
}

/* A keyword before a name does not make it a declaration. */
static bool is_keyword(const struct token *token)
{
    static const char *const words[] = {"return", "else", "in", "case"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (token_is(token, words[i]))
            return true;
    return false;
}

/* Whether the body declares this name itself: `vec3 irradiance`, `#define irradiance`. The
 * declaration hides the resource. */
static bool declares(const struct body *body, const char *name)
{
    for (size_t i = 1; i < body->count; i++)
        if (body->tokens[i].before == 'a' && token_is(&body->tokens[i], name) &&
            !is_keyword(&body->tokens[i - 1]))
            return true;
    return false;
}

/* Whether it is the name with one of the endings. */
static bool is_derived(const struct token *token, const char *name, const char *const *suffixes)
{
    size_t length = strlen(name);
    bool starts = (size_t)token->length > length && !memcmp(token->text, name, length);
    for (; starts && *suffixes; suffixes++)
        if ((size_t)token->length == length + strlen(*suffixes) &&
            !memcmp(token->text + length, *suffixes, strlen(*suffixes)))
            return true;
    return false;
}

/* The first place where the body uses a name, or one of the words made from it; NULL: none.
 * `suffixes` ends with NULL. */
static const struct token *find_use(const struct body *body, const char *name,
                                    const char *const *suffixes)
{
    size_t length = strlen(name);
    for (size_t i = 0; i < body->count; i++) {
        const struct token *token = &body->tokens[i];
        if (token->before == '.' || (size_t)token->length < length ||
            memcmp(token->text, name, length))
            continue;
        if ((size_t)token->length == length) {
            /* `vec3 a, name;` declares the name, too */
            if (token->before != ',' || token->after == '(' || token->after == '[')
                return token;
            continue;
        }
        if (is_derived(token, name, suffixes))
            return token;
    }
    return NULL;
}

/* Whether the body contains the word. */
static bool mentions(const struct body *body, const char *name)
{
    for (size_t i = 0; i < body->count; i++)
        if (token_is(&body->tokens[i], name))
            return true;
    return false;
}

/* ---- Names against lists --------------------------------------------------------------------- */

static const char *const buffer_words[] = {"_count", NULL};
static const char *const image_words[] = {
    "_size", "_store", "_sample", "_sample_lod", "_compare", "_texture",
    /* of atomic_words */
    "_atomicAdd", "_atomicMin", "_atomicMax", "_atomicAnd", "_atomicOr", "_atomicXor",
    "_atomicExchange", "_atomicCompSwap", NULL};
static const char *const *const atomic_words = image_words + 6;
static const char *const interleave_words[] = {"_tile",   "_classes",    "_class", "_split",
                                               "_gather", "_class_size", NULL};
static const char *const no_words[] = {NULL};

static const char *const *resource_words(const struct resource *resource)
{
    return !resource ? no_words : resource->kind == DT_IMAGE ? image_words : buffer_words;
}

/* The first access of the pass to a resource; NULL: none. */
static const struct access *find_access(const struct pass *pass, const char *name)
{
    for (uint32_t i = 0; i < pass->access_count; i++)
        if (!strcmp(pass->accesses[i].name, name))
            return &pass->accesses[i];
    return NULL;
}

/* The first access of the pass that its body calls `word`; writing: that also writes. */
static const struct access *find_word_access(const struct pass *pass, const char *word,
                                             bool writing)
{
    for (uint32_t i = 0; i < pass->access_count; i++)
        if (!strcmp(access_word(&pass->accesses[i]), word) &&
            (!writing || pass->accesses[i].mode != MODE_READ))
            return &pass->accesses[i];
    return NULL;
}

/* Reports a resource's own name in a body whose pass does not list it, or lists it with `as`. */
static void check_foreign_word(struct checker *c, const struct pass *pass, const struct body *body,
                               const struct resource *resource, const struct access *access)
{
    const struct token *token = declares(body, resource->name)
                                    ? NULL
                                    : find_use(body, resource->name, resource_words(resource));
    if (!token)
        return;
    if (access) {
        diag_error(c->diag, token->loc, "the pass `%s` lists `%s` as `%s`; use `%s` in its body",
                   pass->name, resource->name, access->as, access->as);
        return;
    }
    static const char *const store[] = {"_store", NULL};
    bool image = resource->kind == DT_IMAGE;
    diag_error(c->diag, token->loc, "the pass `%s` uses `%s` but does not list it in %s",
               pass->name, resource->name,
               image && is_derived(token, resource->name, store)          ? "writes"
               : image && is_derived(token, resource->name, atomic_words) ? "updates"
                                                                          : "reads");
}

/* The place where the body declares a function of this name; NULL: it does not. */
static const struct token *function_named(const struct body *body, const char *name, int length)
{
    for (size_t i = 1; i < body->count; i++)
        if (body->tokens[i].before == 'a' && body->tokens[i].after == '(' &&
            body->tokens[i].length == length &&
            !memcmp(body->tokens[i].text, name, (size_t)length) &&
            !is_keyword(&body->tokens[i - 1]))
            return &body->tokens[i];
    return NULL;
}

static const struct token *function_of(const struct body *body, const char *name)
{
    return function_named(body, name, (int)strlen(name));
}

/* Atomic functions need an update of a format that both APIs have them for. */
static void check_atomics(struct checker *c, const struct pass *pass, const struct body *body,
                          const struct access *access)
{
    enum dt_format format = access->resource->format;
    const char *name = access_word(access);
    const struct token *token = NULL;
    bool updates = false;
    for (size_t i = 0; !token && i < body->count; i++)
        token = is_derived(&body->tokens[i], name, atomic_words) ? &body->tokens[i] : NULL;
    for (uint32_t i = 0; i < pass->access_count; i++)
        updates |=
            pass->accesses[i].mode == MODE_UPDATE && !strcmp(access_word(&pass->accesses[i]), name);
    if (token && (!updates || pass->kind != PASS_DISPATCH))
        diag_error(c->diag, token->loc,
                   "the pass `%s` changes `%s` atomically; make it a dispatch that lists it in "
                   "updates",
                   pass->name, name);
    else if (token && format != DT_FORMAT_R32UI && format != DT_FORMAT_R32I)
        diag_error(c->diag, token->loc,
                   "`%s` has the format %s; atomic functions need r32ui or r32i", name,
                   format_info(format)->name);
}

static void check_access_use(struct checker *c, const struct pass *pass, const struct body *body,
                             const struct access *access)
{
    const struct resource *resource = access->resource;
    const char *name = access_word(access);
    if (!resource || find_word_access(pass, name, false) != access)
        return;
    const struct token *function = function_of(body, name);
    if (function) {
        diag_error(
            c->diag, function->loc,
            "the body declares the function `%s`, which is the name of %s that the pass `%s` "
            "lists; rename the function, or give the access another name with `as`",
            name, resource->kind == DT_IMAGE ? "an image" : "a buffer", pass->name);
        return;
    }
    if (resource->kind == DT_IMAGE)
        check_atomics(c, pass, body, access);
    if (resource->kind != DT_IMAGE || find_word_access(pass, name, true))
        return;
    const char *word = arena_printf(c->model->arena, "%s_store", name);
    for (size_t i = 0; word && i < body->count; i++)
        if (token_is(&body->tokens[i], word)) {
            diag_error(c->diag, body->tokens[i].loc,
                       "the pass `%s` stores to `%s` but lists it only in reads", pass->name, name);
            break;
        }
}

static void check_tool_use(struct checker *c, const struct pass *pass, const struct body *body,
                           const char *name, const char *const *words)
{
    for (uint32_t i = 0; i < pass->use_count; i++)
        if (!strcmp(pass->uses[i], name))
            return;
    const struct token *token = declares(body, name) ? NULL : find_use(body, name, words);
    if (token)
        diag_error(c->diag, token->loc, "the pass `%s` uses `%s` but does not list it in uses",
                   pass->name, name);
}

/* Whether a GLSL expression of the spec contains the name as a whole word. */
static bool text_mentions(const char *text, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = text; (at = strstr(at, name)); at++) {
        bool before = at > text && (isalnum((unsigned char)at[-1]) || at[-1] == '_');
        if (!before && !isalnum((unsigned char)at[length]) && at[length] != '_')
            return true;
    }
    return false;
}

static bool reads_by_range(const struct pass *pass, const struct body *body,
                           const struct access *access)
{
    for (uint32_t i = 0; i < pass->range_count; i++)
        if ((pass->ranges[i].of && !strcmp(pass->ranges[i].of, access->name) &&
             mentions(body, pass->ranges[i].name)) ||
            text_mentions(pass->ranges[i].first, access_word(access)))
            return true;
    return false;
}

/* Whether `uses` may list the name; check_names.c reports the others. */
static bool is_tool(const struct checker *c, const char *name)
{
    const struct sampler *sampler = find_sampler(c, name);
    return (sampler && sampler->kind == SAMPLER_HAMMERSLEY) || find_metric(c, name) ||
           find_interleave(c, name);
}

/* Warns about listed names that the body does not use. Depth targets, indirect arguments and
 * indices need no name in the body. */
static void check_listed(struct checker *c, const struct pass *pass, const struct body *body)
{
    static const char *const lists_of[] = {"reads", "writes", "updates"};
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];
        const struct resource *resource = access->resource;
        const char *word = access_word(access);
        bool silent =
            resource && ((resource->kind == DT_IMAGE && resource->format == DT_FORMAT_D32F &&
                          access->mode != MODE_READ) ||
                         resource == pass->indirect_resource || resource == pass->index_resource);
        if (!resource || silent || find_use(body, word, resource_words(resource)) ||
            mentions(body, word) || reads_by_range(pass, body, access))
            continue;
        diag_warning(c->diag, access->loc, "the pass `%s` lists `%s` in %s but does not use it",
                     pass->name, word, lists_of[access->mode]);
    }
    for (uint32_t i = 0; i < pass->range_count; i++)
        if (!mentions(body, pass->ranges[i].name))
            diag_warning(c->diag, pass->ranges[i].loc,
                         "the pass `%s` does not iterate over its range `%s`", pass->name,
                         pass->ranges[i].name);
    for (uint32_t i = 0; i < pass->define_count; i++)
        if (!pass->defines[i].word && !mentions(body, pass->defines[i].name))
            diag_warning(c->diag, pass->defines[i].loc,
                         "the pass `%s` defines `%s` but does not use it", pass->name,
                         pass->defines[i].name);
    for (uint32_t i = 0; i < pass->use_count; i++)
        if (is_tool(c, pass->uses[i]) &&
            !find_use(body, pass->uses[i],
                      find_interleave(c, pass->uses[i]) ? interleave_words : buffer_words) &&
            (!pass->interleave_name || strcmp(pass->interleave_name, pass->uses[i])))
            diag_warning(c->diag, pass->use_locs[i],
                         "the pass `%s` lists `%s` in uses but does not use it", pass->name,
                         pass->uses[i]);
}

/* Whether the body depends on the workgroup's size: it uses shared memory, barriers, or built-ins
 * of the workgroup or subgroup. */
static bool minds_group(const struct body *body)
{
    static const char *const words[] = {"shared", "barrier", "groupMemoryBarrier",
                                        "memoryBarrierShared"};
    static const char *const prefixes[] = {"gl_Local", "gl_WorkGroup", "gl_NumWorkGroups",
                                           "gl_Subgroup", "subgroup"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (mentions(body, words[i]))
            return true;
    for (size_t i = 0; i < body->count; i++)
        for (size_t k = 0; k < sizeof prefixes / sizeof *prefixes; k++) {
            size_t length = strlen(prefixes[k]);
            if ((size_t)body->tokens[i].length >= length &&
                !memcmp(body->tokens[i].text, prefixes[k], length))
                return true;
        }
    return false;
}

/* Notes whether the body has a `.length()`. In a uniform block whose count comes from uniform
 * parameters it would be that of the limit: plan.c reads such buffers as storage, except in a range
 * with `storage: uniform`. */
static void note_lengths(struct checker *c, struct pass *pass, const struct body *body)
{
    for (size_t k = 1; k < body->count; k++) {
        const struct token *word = &body->tokens[k - 1];
        if (body->tokens[k].before != '.' || !token_is(&body->tokens[k], "length"))
            continue;
        pass->asks_length = true;
        for (uint32_t i = 0; i < pass->range_count && word->after == '.'; i++) {
            const struct access *access = pass->ranges[i].access;
            if (pass->ranges[i].storage == STORAGE_UNIFORM && access && access->resource &&
                access->resource->count && !expr_is_literal(access->resource->count) &&
                token_is(word, access_word(access)))
                diag_error(c->diag, word->loc,
                           "`%s.length()`: the range `%s` has `storage: uniform`, and a uniform "
                           "block has no length; use `%s_count`",
                           access_word(access), pass->ranges[i].name, access_word(access));
        }
    }
}

static bool reads_image(const struct pass *pass, const struct token *token)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];
        if (access->resource && access->resource->kind == DT_IMAGE && token->before != '.' &&
            (token_is(token, access_word(access)) ||
             is_derived(token, access_word(access), image_words)))
            return true;
    }
    return false;
}

/* Whether the block behind the token reads an image, itself or in a function of the body. */
static bool block_reads_images(const struct pass *pass, const struct body *body,
                               const struct token *token, int calls)
{
    const struct token *end = body->tokens + body->count;
    int depth = token->depth;
    while (token < end && token->depth <= depth)
        token++;
    for (; token < end && token->depth > depth; token++) {
        const struct token *function =
            token->after == '(' ? function_named(body, token->text, token->length) : NULL;
        if (reads_image(pass, token) ||
            (function && calls < MAX_CALLS && block_reads_images(pass, body, function, calls + 1)))
            return true;
    }
    return false;
}

/* Notes the ranges whose loops read images. */
static void note_images(struct pass *pass, const struct body *body)
{
    for (uint32_t i = 0; i < pass->range_count; i++)
        for (size_t k = 0; k < body->count; k++)
            if (body->tokens[k].before == ':' && token_is(&body->tokens[k], pass->ranges[i].name) &&
                block_reads_images(pass, body, &body->tokens[k], 0))
                pass->ranges[i].reads_images = true;
}

static void check_body(struct checker *c, struct pass *pass, struct body *body)
{
    const struct pipeline *p = c->pipeline;
    if (!pass->shader)
        return;
    if (pass->limit) {
        pass->limit_body = read_body(c, "limit", pass->limit, pass->limit_loc);
        pass->limit = body_name(c, pass->limit, pass->limit_loc, pass->limit_body);
    }
    pass->body = read_body(c, "shader", pass->shader, pass->shader_loc);
    if (pass->body && pass->more)
        pass->body = join_bodies(c, pass);
    if (!pass->body)
        return;
    pass->shader =
        pass->more ? pass->more : body_name(c, pass->shader, pass->shader_loc, pass->body);
    scan_source(c, body, pass->body, 0, 0);
    pass->minds_group = minds_group(body);
    note_lengths(c, pass, body);
    note_images(pass, body);
    pass->own_vertices = mentions(body, "VERTEX");
    if (pass->kind == PASS_VERTICES && !pass->own_vertices)
        diag_error(c->diag, pass->shader_loc,
                   "the pass `%s` draws vertices, but its body has no part `#ifdef VERTEX`",
                   pass->name);
    if (pass->topology == DT_POINTS && !mentions(body, "gl_PointSize"))
        diag_error(c->diag, pass->shader_loc,
                   "the pass `%s` draws points, but its body does not write gl_PointSize",
                   pass->name);
    for (uint32_t i = 0; i < p->resource_count; i++)
        if (!find_word_access(pass, p->resources[i].name, false))
            check_foreign_word(c, pass, body, &p->resources[i],
                               find_access(pass, p->resources[i].name));
    for (uint32_t i = 0; i < pass->access_count; i++)
        check_access_use(c, pass, body, &pass->accesses[i]);
    for (uint32_t i = 0; i < p->sampler_count; i++)
        if (p->samplers[i].kind == SAMPLER_HAMMERSLEY)
            check_tool_use(c, pass, body, p->samplers[i].name, buffer_words);
    for (uint32_t i = 0; i < p->metric_count; i++)
        check_tool_use(c, pass, body, p->metrics[i].name, no_words);
    for (uint32_t i = 0; i < p->interleave_count; i++)
        check_tool_use(c, pass, body, p->interleaves[i].name, interleave_words);
    check_listed(c, pass, body);
}

void check_bodies(struct checker *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++)
        check_body(c, &c->pipeline->passes[i], &c->bodies[i]);
}

/* ---- Unused declarations --------------------------------------------------------------------- */

static bool in_bodies(const struct checker *c, const char *name)
{
    const char *dot = strrchr(name, '.'); /* bodies of an instance use the last part */
    name = dot ? dot + 1 : name;
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const struct pass *pass = &c->pipeline->passes[i];
        for (uint32_t k = 0; k < pass->define_count; k++)
            if (pass->defines[k].param && !strcmp(pass->defines[k].param, name) &&
                mentions(&c->bodies[i], pass->defines[k].name))
                return true;
        if (mentions(&c->bodies[i], name))
            return true;
    }
    return false;
}

static bool is_named(const struct weight *weight, const char *name)
{
    return weight->param && !strcmp(weight->param, name);
}

static bool in_expressions(const struct checker *c, const char *name)
{
    for (size_t i = 0; i < c->expr_count; i++)
        if (expr_mentions(c->exprs[i], name))
            return true;
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++)
        for (uint32_t k = 0; k < c->pipeline->passes[i].range_count; k++)
            if (text_mentions(c->pipeline->passes[i].ranges[k].first, name))
                return true;
    for (uint32_t i = 0; i < c->pipeline->metric_count; i++) {
        const struct metric *metric = &c->pipeline->metrics[i];
        if (is_named(&metric->position, name) || is_named(&metric->normal, name))
            return true;
    }
    for (const struct replaced *at = c->model->replaced; at; at = at->next)
        if (text_mentions(at->text, name))
            return true;
    return false;
}

static bool accessed(const struct checker *c, const struct resource *resource)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const struct pass *pass = &c->pipeline->passes[i];
        if (find_access(pass, resource->name) || pass->indirect_resource == resource ||
            pass->index_resource == resource)
            return true;
    }
    return false;
}

static bool used_in_passes(const struct checker *c, const char *name)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const struct pass *pass = &c->pipeline->passes[i];
        for (uint32_t k = 0; k < pass->use_count; k++)
            if (!strcmp(pass->uses[k], name))
                return true;
        for (uint32_t k = 0; k < pass->access_count; k++)
            if (pass->accesses[k].sampler && !strcmp(pass->accesses[k].sampler, name))
                return true;
    }
    return false;
}

static void warn_unused(struct checker *c, bool used, const char *kind, const char *name,
                        struct loc loc)
{
    if (!used)
        diag_warning(c->diag, loc, "the %s `%s` is not used", kind, name);
}

static bool struct_used(const struct checker *c, const struct structure *structure)
{
    for (uint32_t i = 0; i < c->pipeline->resource_count; i++)
        if (c->pipeline->resources[i].structure == structure)
            return true;
    return in_bodies(c, structure->name);
}

static void check_metric_fields(struct checker *c, const struct metric *metric)
{
    const char *const names[] = {metric->position_field, metric->normal_field};
    for (int i = 0; i < 2; i++) {
        bool found = !strcmp(names[i], i ? "normal" : "position");
        for (uint32_t s = 0; s < c->pipeline->struct_count; s++)
            for (uint32_t f = 0; f < c->pipeline->structs[s].field_count; f++)
                found |= !strcmp(c->pipeline->structs[s].fields[f].name, names[i]);
        if (!found)
            diag_warning(c->diag, metric->loc,
                         "no struct has the field `%s` that the metric `%s` looks for", names[i],
                         metric->name);
    }
}

void check_unused(struct checker *c)
{
    const struct pipeline *p = c->pipeline;
    for (uint32_t i = 0; i < p->param_count; i++)
        warn_unused(c, in_expressions(c, p->params[i].name) || in_bodies(c, p->params[i].name),
                    "parameter", p->params[i].name, p->params[i].loc);
    for (uint32_t i = 0; i < p->constant_count; i++)
        warn_unused(c,
                    in_expressions(c, p->constants[i].name) || in_bodies(c, p->constants[i].name),
                    "constant", p->constants[i].name, p->constants[i].loc);
    for (uint32_t i = 0; i < p->struct_count; i++)
        warn_unused(c, struct_used(c, &p->structs[i]), "struct", p->structs[i].name,
                    p->structs[i].loc);
    for (uint32_t i = 0; i < p->resource_count; i++)
        warn_unused(c, accessed(c, &p->resources[i]),
                    p->resources[i].kind == DT_IMAGE ? "image" : "buffer", p->resources[i].name,
                    p->resources[i].loc);
    for (uint32_t i = 0; i < p->sampler_count; i++)
        warn_unused(c, used_in_passes(c, p->samplers[i].name), "sampler", p->samplers[i].name,
                    p->samplers[i].loc);
    for (uint32_t i = 0; i < p->metric_count; i++) {
        warn_unused(c, used_in_passes(c, p->metrics[i].name), "metric", p->metrics[i].name,
                    p->metrics[i].loc);
        check_metric_fields(c, &p->metrics[i]);
    }
    for (uint32_t i = 0; i < p->interleave_count; i++)
        warn_unused(c, used_in_passes(c, p->interleaves[i].name), "interleave",
                    p->interleaves[i].name, p->interleaves[i].loc);
}
