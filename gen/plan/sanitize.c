/* See sanitize.h. The buffer of reports is a resource like those of a spec, so runtimes bind, keep and read it as they do
 * others; but no list of a pass shows it. */
#include "sanitize.h"
#include "shadow.h"

#include <ctype.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/expr.h"
#include "plan.h"

struct sanitize_sites {
    pthread_mutex_t lock;       /* of what follows */
    struct sanitize_site *list; /* site 0 is no place */
    uint32_t count, room;
    bool failed;
    unsigned *silenced; /* per pass of the spec: mask of the kinds whose `allow` was of use */
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
    sanitize_add(model, NULL, &(struct sanitize_site){0});
    return !model->sites->failed;
}

void sanitize_end(struct model *model)
{
    if (model->sites) {
        pthread_mutex_destroy(&model->sites->lock);
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

bool sanitize_plan(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;
    struct resource *reports = pipeline->resources + pipeline->resource_count;
    if (!model->sanitize)
        return true;
    *reports = (struct resource){.name = sanitize_buffer,
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
    shadow_plan(model);
    for (uint32_t i = 0; i < pipeline->pass_count; i++) /* the last access: see sanitize_count */
        sanitize_access(&pipeline->passes[i], reports);
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
    const char *count = arena_printf(model->arena, "%u", model->sites->count * SANITIZE_WORDS);
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
                       struct sanitize_report *report)
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

static void put_value(char letter, uint32_t bits, struct text *out)
{
    float number;
    memcpy(&number, &bits, sizeof number);
    if (letter == 'f')
        text_add(out, "%.9g", (double)number);
    else if (letter == 'w' || letter == 'h') /* width and height in half a word each */
        text_add(out, "%u", letter == 'w' ? bits & 0xffff : bits >> 16);
    else if (letter == 'i')
        text_add(out, "%d", (int32_t)bits);
    else
        text_add(out, "%u", bits);
}

/* The coordinates of an invocation in a dispatch of this size. */
static void find_invocation(uint32_t number, const uint32_t extent[2], uint32_t invocation[3])
{
    uint32_t width = extent[0] ? extent[0] : 1, height = extent[1] ? extent[1] : 1;
    invocation[0] = number % width;
    invocation[1] = number / width % height;
    invocation[2] = (uint32_t)(number / ((uint64_t)width * height));
}

/* The value of a message at `code`: its number and letter. words: of the place in the buffer of reports. */
static void put_code(const struct sanitize_site *site, const char *code, const uint32_t *words,
                     const uint32_t *values, struct text *out)
{
    uint32_t value = values[code[0] - '0'], p[3];
    char text[160];
    if (code[1] == 'e') {
        shadow_place(site, value, values[3], text, sizeof text);
        text_add(out, "%s", text);
    } else if (code[1] == 'p') {
        find_invocation(value, words + 4, p);
        text_add(out, "(%u, %u, %u)", p[0], p[1], p[2]);
    } else {
        put_value(code[1], value, out);
    }
}

static bool write_finding(const struct sanitize_site *site, const uint32_t *words,
                          const uint32_t *values, struct sanitize_report *report)
{
    struct text out = {0};
    for (const char *format = site->text; *format; format++)
        if (*format == '@' && format[1] && format[2]) {
            put_code(site, format + 1, words, values, &out);
            format += 2;
        } else {
            text_add_bytes(&out, format, 1);
        }
    bool good = !out.failed;
    snprintf(report->text, sizeof report->text, "%s", good && out.data ? out.data : "");
    text_free(&out);
    return good;
}

/* The record of the least invocation; else, where later ones took its place, that of the least that is left. */
static const uint32_t *find_record(const uint32_t *site)
{
    const uint32_t *best = site + SANITIZE_HEAD;
    for (uint32_t i = 1; i < SANITIZE_RECORDS; i++) {
        const uint32_t *record = site + SANITIZE_HEAD + (size_t)i * SANITIZE_RECORD;
        best = record[0] > best[0] ? record : best;
    }
    return best;
}

/* Which operation the record of a place is of. */
static const struct sanitize_site *find_site(const struct sanitize_sites *sites,
                                             const uint32_t *words)
{
    const uint32_t *record = find_record(words);
    return &sites->list[record[1] < sites->count ? record[1] : 0];
}

/* Whether the pass has an `allow` of what is told; notes that it is of use. */
static bool is_allowed(const struct model *model, const struct sanitize_site *site)
{
    for (uint32_t i = 0; site->pass && i < site->pass->allow_count; i++)
        if (site->pass->allows[i].kind == site->kind) {
            model->sites->silenced[site->pass - model->pipeline.passes] |= site->kind;
            return true;
        }
    return false;
}

static bool read_site(const struct model *model, uint32_t index, const uint32_t *words,
                      struct sanitize_report *report)
{
    const struct sanitize_sites *sites = model->sites;
    const uint32_t *record = find_record(words);
    const struct sanitize_site *what = find_site(sites, words);
    *report = (struct sanitize_report){.count = words[0], .frame = words[3] - 1};
    find_invocation(what->pairs ? record[2] : ~record[0], words + 4, report->invocation);
    report->pass = what->pass ? what->pass->name : "";
    report->kind = what->kind ? sanitize_kind_name(what->kind) : "";
    place_site(model, index ? &sites->list[index] : what, report);
    return write_finding(what, words, record + 2, report);
}

static int by_place(const void *left, const void *right)
{
    const struct sanitize_report *a = left, *b = right;
    int order = strcmp(a->file, b->file);
    order = order ? order : a->line - b->line;
    order = order ? order : a->column - b->column;
    order = order ? order : strcmp(a->pass, b->pass);
    return order ? order : strcmp(a->text, b->text);
}

bool sanitize_read(const struct model *model, const void *bytes, uint64_t size,
                   struct sanitize_report **reports, uint32_t *count)
{
    const uint32_t *words = bytes;
    uint32_t sites = (uint32_t)(size / (SANITIZE_WORDS * sizeof *words));
    bool good = true;
    *count = 0;
    *reports = calloc(sites + 1, sizeof **reports);
    for (uint32_t i = 0; *reports && i < sites && i < model->sites->count; i++)
        if (words[(size_t)i * SANITIZE_WORDS] &&
            !is_allowed(model, find_site(model->sites, words + (size_t)i * SANITIZE_WORDS)))
            good &=
                read_site(model, i, words + (size_t)i * SANITIZE_WORDS, &(*reports)[(*count)++]);
    if (*reports)
        qsort(*reports, *count, sizeof **reports, by_place);
    return *reports && good;
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
