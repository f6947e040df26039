/* See sanitize.h. The buffer of reports is a resource like those of a spec, so runtimes bind, keep and read it as they do
 * others; but no list of a pass shows it. */
#include "sanitize.h"
#include "shadow.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/expr.h"

struct sanitize_sites {
    pthread_mutex_t lock;       /* of what follows */
    pthread_cond_t ended;       /* a turn */
    uint32_t turn;              /* of the shader that adds its sites */
    struct sanitize_site *list; /* site 0 is no place */
    uint32_t count, room;
    bool failed;
    struct dt_site *table; /* NULL: not made yet */
    unsigned *silenced;    /* per pass of the spec: mask of the kinds whose `allow` was of use */
};

/* ---- Sites ----------------------------------------------------------------------------------- */

bool sanitize_begin(struct model *model)
{
    if (!model->sanitize)
        return true;
    model->sites = calloc(1, sizeof *model->sites);
    if (!model->sites)
        return false;
    model->sites->silenced = arena_alloc(model->arena, (model->pipeline.pass_count + 1) *
                                                           sizeof *model->sites->silenced);
    model->sites->failed = !model->sites->silenced;
    pthread_mutex_init(&model->sites->lock, NULL);
    pthread_cond_init(&model->sites->ended, NULL);
    model->sites->turn = 1;
    sanitize_add(model, NULL, &(struct sanitize_site){0});
    return !model->sites->failed;
}

void sanitize_end(struct model *model)
{
    if (model->sites) {
        pthread_mutex_destroy(&model->sites->lock);
        pthread_cond_destroy(&model->sites->ended);
        free(model->sites->list);
    }
    free(model->sites);
    model->sites = NULL;
}

uint32_t sanitize_add(const struct model *model, const struct pass *pass,
                      const struct sanitize_site *site)
{
    struct sanitize_sites *sites = model->sites;
    uint32_t index = 0, all = 1 + site->more;
    pthread_mutex_lock(&sites->lock);
    if (sites->count + all > sites->room) {
        uint32_t room = sites->room * 2 + 256;
        struct sanitize_site *list = realloc(sites->list, room * sizeof *list);
        sites->failed |= !list;
        sites->list = list ? list : sites->list;
        sites->room = list ? room : sites->room;
    }
    if (sites->count + all <= sites->room) {
        index = sites->count;
        for (uint32_t i = 0; i < all; i++) {
            sites->list[sites->count] = *site;
            sites->list[sites->count++].pass = pass;
        }
    }
    pthread_mutex_unlock(&sites->lock);
    return index;
}

void sanitize_begin_turn(const struct model *model, uint32_t turn)
{
    pthread_mutex_lock(&model->sites->lock);
    while (model->sites->turn < turn)
        pthread_cond_wait(&model->sites->ended, &model->sites->lock);
    pthread_mutex_unlock(&model->sites->lock);
}

void sanitize_end_turn(const struct model *model, uint32_t turn)
{
    sanitize_begin_turn(model, turn);
    pthread_mutex_lock(&model->sites->lock);
    if (model->sites->turn == turn) {
        model->sites->turn++;
        pthread_cond_broadcast(&model->sites->ended);
    }
    pthread_mutex_unlock(&model->sites->lock);
}

bool sanitize_failed(const struct model *model)
{
    return model->sites && model->sites->failed;
}

/* ---- The plan -------------------------------------------------------------------------------- */

const char sanitize_buffer[] = "diptych_reports";

/* The reader leaves room for them. */
struct access *sanitize_access(struct pass *pass, struct resource *resource)
{
    struct access *access = &pass->accesses[pass->access_count++];
    *access = (struct access){.name = resource->name,
                              .loc = pass->loc,
                              .mode = MODE_UPDATE,
                              .resource = resource,
                              .binding = -1,
                              .attachment = -1};
    return access;
}

struct resource *sanitize_resource(struct pipeline *pipeline, const char *name)
{
    struct resource *buffer = pipeline->resources + pipeline->resource_count;
    *buffer = (struct resource){.name = name,
                                .loc = pipeline->loc,
                                .kind = DT_BUFFER,
                                .history = true,
                                .keep = true,
                                .internal = true,
                                .share = -1,
                                .of = "uint",
                                .type = DT_TYPE_UINT,
                                .stride = sizeof(uint32_t),
                                .index = pipeline->resource_count++};
    return buffer;
}

bool sanitize_plan(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;
    if (!model->sanitize)
        return true;
    struct resource *reports = sanitize_resource(pipeline, sanitize_buffer);
    shadow_plan(model);
    CHANGE_EACH(pass, pipeline->passes, pipeline->pass_count) /* the last: see sanitize_count */
        sanitize_access(pass, reports);
    return true;
}

bool sanitize_count(struct model *model, struct diag *diag)
{
    struct pipeline *pipeline = &model->pipeline;
    if (!model->sanitize)
        return true;
    struct resource *reports = pipeline->resources;
    while (strcmp(reports->name, sanitize_buffer) != 0)
        reports++;
    const char *count = arena_printf(model->arena, "%u", model->sites->count * DT_SITE_WORDS);
    reports->count = count ? expr_parse(model, count, pipeline->loc, NULL, diag) : NULL;
    return reports->count && expr_resolve(reports->count, pipeline, diag);
}

/* ---- Reports --------------------------------------------------------------------------------- */

/* Whether the word of an operation stands here, and no other operator. */
static bool stands(const char *line, const char *at, const char *word, size_t length)
{
    if (strncmp(at, word, length) != 0)
        return false;
    if (text_is_word(*word))
        return (at == line || !text_is_word(at[-1])) &&
               (!text_is_word(word[length - 1]) || !text_is_word(at[length]));
    bool twice =
        (*word == '+' || *word == '-') && (at[1] == *word || (at > line && at[-1] == *word));
    return !twice;
}

static const char *behind_word(const char *at)
{
    while (text_is_word(*at))
        at++;
    return at;
}

static const char *behind_index(const char *at)
{
    int depth = 0;
    do
        depth += (*at == '[') - (*at == ']');
    while (*at && *at++ != '\n' && depth);
    return at;
}

enum find { FIND_ANY, FIND_READ, FIND_WRITTEN, FIND_CALLED };

/* Whether a name stands here to be read, or to be assigned: it is not declared; or a function to be called. */
static bool is_used(const char *line, const char *at, size_t length, enum find how)
{
    const char *before = at, *after = at + length;
    if (how == FIND_CALLED)
        return !text_is_word(*at) || after[strspn(after, " \t")] == '(';
    while (before > line && (before[-1] == ' ' || before[-1] == '\t'))
        before--;
    after -= at[length - 1] == '[';
    while (*after == '.' || *after == '[') /* of a part */
        after = *after == '[' ? behind_index(after) : behind_word(after + 1);
    after += strspn(after, " \t");
    bool declared = before < at && before > line && text_is_word(before[-1]) &&
                    !(before - line >= 6 && !strncmp(before - 6, "return", 6));
    bool assigned = after[0] == '=' && after[1] != '=';
    bool updated =
        strchr("+-*/%&|^", after[0]) && after[0] && (after[1] == '=' || after[1] == after[0]);
    return !declared && (how == FIND_READ ? !assigned : assigned || updated);
}

/* The column of the nth word outside of comments, or of the last; 0: there is none. */
static int find_column(const char *line, const char *word, uint32_t nth, enum find how)
{
    size_t length = strlen(word);
    int column = 0;
    for (const char *at = line; *at && *at != '\n'; at++) {
        if (at[0] == '/' && at[1] == '/')
            break;
        if (at[0] == '/' && at[1] == '*') {
            const char *end = strstr(at + 2, "*/");
            if (!end)
                break;
            at = end + 1;
            continue;
        }
        if (!stands(line, at, word, length) || (how && !is_used(line, at, length, how)))
            continue;
        column = (int)(at - line) + 1;
        if (!nth--)
            break;
        at += length - 1;
    }
    return column;
}

static const char *line_at(const struct source *source, uint32_t line)
{
    const char *at = source->text;
    while (--line && (at = strchr(at, '\n')))
        at++;
    return at ? at : "";
}

static const char *const other_words[][2] = {
    {"loop", "for"},  {"loop", "do"},    {"loop", "while"}, {"int", "ivec2"}, {"int", "ivec3"},
    {"int", "ivec4"}, {"uint", "uvec2"}, {"uint", "uvec3"}, {"uint", "uvec4"}};

static void place_site(const struct model *model, const struct sanitize_site *site,
                       struct dt_site *report)
{
    report->file = site->pass ? site->pass->shader_loc.source->path : "";
    if (!site->file || site->file > model->glsl_source_count) {
        report->line = site->pass ? site->pass->shader_loc.line : 0;
        report->column = site->pass ? site->pass->shader_loc.column : 0;
        return;
    }
    const struct source *source = model->glsl_sources[site->file - 1];
    const char *line = line_at(source, site->line), *word = site->word ? site->word : site->name;
    report->file = source->path;
    report->line = (int)site->line;
    char indexed[72];
    snprintf(indexed, sizeof indexed, "%s[", word);
    enum find how = site->pairs ? FIND_WRITTEN : FIND_READ;
    bool memory = site->kind & (SANITIZE_CONTENT | SANITIZE_RACE);
    if (memory || !strncmp(site->text, "index", 5))
        report->column = find_column(line, indexed, site->nth, how);
    if (!report->column && (memory || strstr(site->text, " is read ")))
        report->column = find_column(line, word, site->nth, how);
    const char *const ends[] = {"texture", "image"}; /* the author's own call, like texelFetch() */
    for (size_t i = 0; i < DT_ARRAY_COUNT(ends) && !report->column && !site->word; i++) {
        snprintf(indexed, sizeof indexed, "%s_%s", word, ends[i]);
        report->column = find_column(line, indexed, site->nth, FIND_ANY);
    }
    bool loop = !strcmp(word, "loop");
    for (enum find call = loop ? FIND_ANY : FIND_CALLED; !report->column; call = FIND_ANY) {
        report->column = find_column(line, word, site->nth, call);
        for (size_t i = 0; i < DT_ARRAY_COUNT(other_words) && !report->column; i++)
            if (!strcmp(other_words[i][0], word))
                report->column = find_column(line, other_words[i][1], site->nth, call);
        if (call == FIND_ANY)
            break;
    }
    if (!report->column)
        report->column = 1 + (int)strspn(line, " \t");
}

/* The kind by which a pass allows it: what is shared is a variable of the shader. */
static unsigned kind_to_allow(const struct sanitize_site *site)
{
    return site->kind == SANITIZE_CONTENT && !site->resource ? SANITIZE_VARIABLE : site->kind;
}

static bool is_allowed(const struct sanitize_site *site)
{
    for (uint32_t i = 0; site->pass && i < site->pass->allow_count; i++)
        if (site->pass->allows[i].kind == kind_to_allow(site))
            return true;
    return false;
}

const struct dt_site *sanitize_table(const struct model *model, uint32_t *count)
{
    struct sanitize_sites *sites = model->sites;
    *count = sites->count;
    if (sites->table)
        return sites->table;
    sites->table = arena_alloc(model->arena, (sites->count + 1) * sizeof *sites->table);
    for (uint32_t i = 0; sites->table && i < sites->count; i++) {
        const struct sanitize_site *site = &sites->list[i];
        struct dt_site *to = &sites->table[i];
        *to = (struct dt_site){.pass = site->pass ? site->pass->name : "",
                               .kind = site->kind ? sanitize_kind_name(site->kind) : "",
                               .text = site->text,
                               .name = site->name,
                               .resource = site->resource ? (int)site->resource->index : -1,
                               .words = site->words,
                               .first = site->first,
                               .pairs = site->pairs,
                               .allowed = is_allowed(site)};
        place_site(model, site, to);
    }
    return sites->table;
}

static int by_place(const void *left, const void *right)
{
    const struct dt_finding *a = left, *b = right;
    int order = strcmp(a->place->file, b->place->file);
    order = order ? order : a->place->line - b->place->line;
    order = order ? order : a->place->column - b->place->column;
    order = order ? order : strcmp(a->what->pass, b->what->pass);
    return order ? order : strcmp(a->text, b->text);
}

/* Notes that an `allow` is of use. */
static void silence(const struct model *model, const struct dt_finding *finding,
                    const struct dt_site *table)
{
    const struct sanitize_site *what = &model->sites->list[finding->what - table];
    model->sites->silenced[what->pass - model->pipeline.passes] |= kind_to_allow(what);
}

bool sanitize_read(const struct model *model, const struct dt_pipeline *pipeline, const void *bytes,
                   uint64_t size, struct dt_finding **findings, uint32_t *count)
{
    uint32_t site_count, most = (uint32_t)(size / (DT_SITE_WORDS * sizeof(uint32_t)));
    const struct dt_site *table = sanitize_table(model, &site_count);
    *count = 0;
    *findings = calloc(most + 1, sizeof **findings);
    for (uint32_t i = 0; table && *findings && i < most && i < site_count; i++) {
        struct dt_finding *next = &(*findings)[*count];
        if (!dt_find_undefined(pipeline, table, site_count, bytes, i, next))
            continue;
        if (next->what->allowed)
            silence(model, next, table);
        else
            ++*count;
    }
    if (*findings)
        qsort(*findings, *count, sizeof **findings, by_place);
    return table && *findings;
}

/* Passes of a group have one `allow` in the spec, which is of use if it is to any of them. */
static bool is_idle(const struct model *model, const struct allow *allow)
{
    const struct pipeline *pipeline = &model->pipeline;
    if (!(model->sanitize & allow->kind))
        return false;
    for (uint32_t i = 0; i < pipeline->pass_count; i++)
        for (uint32_t k = 0; k < pipeline->passes[i].allow_count; k++) {
            const struct allow *own = &pipeline->passes[i].allows[k];
            if (own->kind == allow->kind &&
                !strcmp(own->loc.source->path, allow->loc.source->path) &&
                own->loc.line == allow->loc.line && own->loc.column == allow->loc.column &&
                model->sites->silenced[i] & own->kind)
                return false;
        }
    return true;
}

void sanitize_warn_idle(const struct model *model, struct diag *diag)
{
    const struct pipeline *pipeline = &model->pipeline;
    for (uint32_t i = 0; i < pipeline->pass_count; i++)
        for (uint32_t k = 0; k < pipeline->passes[i].allow_count; k++) {
            const struct allow *allow = &pipeline->passes[i].allows[k];
            if (is_idle(model, allow))
                diag_warning(diag, allow->loc,
                             "`allow: %s` of the pass `%s` has silenced nothing in this run",
                             sanitize_kind_name(allow->kind), pipeline->passes[i].name);
        }
}
