/* See sanitize.h. The buffer of reports is a resource like those of a spec, so runtimes bind, keep and read it as they do
 * others; but no list of a pass shows it. */
#include "sanitize.h"

#include <ctype.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "glsl.h"
#include "plan.h"

struct sanitize_sites {
    pthread_mutex_t lock;       /* of what follows */
    struct sanitize_site *list; /* site 0 is no place */
    uint32_t count, room;
    bool failed;
};

/* ---- Kinds ----------------------------------------------------------------------------------- */

static const char *const kinds[] = {"index", "arithmetic", "loop", "variable"};
const char sanitize_names[] = "index, arithmetic, loop, variable";

unsigned sanitize_kinds(const char *list, const char **end)
{
    unsigned mask = 0;
    for (*end = list; **end; *end += **end == ',') {
        size_t length = strcspn(*end, ","), kind = 0;
        while (kind < DT_ARRAY_COUNT(kinds) &&
               (strlen(kinds[kind]) != length || strncmp(kinds[kind], *end, length) != 0))
            kind++;
        if (kind == DT_ARRAY_COUNT(kinds))
            return 0;
        mask |= 1u << kind;
        *end += length;
    }
    return mask ? mask : SANITIZE_ALL;
}

/* ---- Sites ----------------------------------------------------------------------------------- */

bool sanitize_begin(struct model *model)
{
    if (!model->sanitize)
        return true;
    model->sites = calloc(1, sizeof *model->sites);
    if (!model->sites)
        return false;
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
    uint32_t index = 0;
    pthread_mutex_lock(&sites->lock);
    if (sites->count == sites->room) {
        uint32_t room = sites->room * 2 + 256;
        struct sanitize_site *list = realloc(sites->list, room * sizeof *list);
        sites->failed |= !list;
        sites->list = list ? list : sites->list;
        sites->room = list ? room : sites->room;
    }
    if (sites->count < sites->room) {
        index = sites->count++;
        sites->list[index] = *site;
        sites->list[index].pass = pass;
    }
    pthread_mutex_unlock(&sites->lock);
    return index;
}

bool sanitize_failed(const struct model *model)
{
    return model->sites && model->sites->failed;
}

/* ---- The plan -------------------------------------------------------------------------------- */

static const char buffer_name[] = "diptych_reports";

/* The reader leaves room for one more resource, and one more access of each pass. */
static void add_access(struct pass *pass, struct resource *reports)
{
    pass->accesses[pass->access_count++] = (struct access){.name = buffer_name,
                                                           .loc = pass->loc,
                                                           .mode = MODE_UPDATE,
                                                           .resource = reports,
                                                           .binding = -1,
                                                           .attachment = -1};
}

bool sanitize_plan(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;
    struct resource *reports = pipeline->resources + pipeline->resource_count;
    if (!model->sanitize)
        return true;
    *reports = (struct resource){.name = buffer_name,
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
    for (uint32_t i = 0; i < pipeline->pass_count; i++)
        add_access(&pipeline->passes[i], reports);
    return true;
}

bool sanitize_count(struct model *model, struct diag *diag)
{
    struct pipeline *pipeline = &model->pipeline;
    if (!model->sanitize)
        return true;
    struct resource *reports = pipeline->resources + pipeline->resource_count - 1;
    const char *count = arena_printf(model->arena, "%u", model->sites->count * SANITIZE_WORDS);
    reports->count = count ? expr_parse(model, count, pipeline->loc, NULL, diag) : NULL;
    return reports->count && expr_resolve(reports->count, pipeline, diag);
}

/* ---- GLSL ------------------------------------------------------------------------------------ */

static const char *place_function(const struct glsl *glsl)
{
    if (glsl->stage == STAGE_IS_VERTEX)
        return "uvec3 diptych_place()\n{\n    return uvec3(gl_VertexIndex, gl_InstanceIndex, "
               "0);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(1048576, 4096, 1);\n}\n\n";
    if (glsl->stage == STAGE_IS_FRAGMENT)
        return "uvec3 diptych_place()\n{\n    return uvec3(gl_FragCoord.xy, 0.0);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(65536, 65536, 1);\n}\n\n";
    if (glsl->pass->interleave)
        return "uvec3 diptych_place()\n{\n    return uvec3(gl_WorkGroupID.yz * gl_WorkGroupSize.xy "
               "+ "
               "gl_LocalInvocationID.xy, gl_WorkGroupID.x);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(gl_NumWorkGroups.yz * "
               "gl_WorkGroupSize.xy, gl_NumWorkGroups.x);\n}\n\n";
    return "uvec3 diptych_place()\n{\n    return gl_GlobalInvocationID;\n}\n\n"
           "uvec3 diptych_extent()\n{\n    return gl_NumWorkGroups * gl_WorkGroupSize;\n}\n\n";
}

bool sanitize_glsl(struct glsl *glsl)
{
    struct model *model = glsl->model;
    static const char slot[] = "@layout@";
    if (!model->sanitize)
        return true;
    const char *path = arena_printf(model->arena, "%s/glsl/sanitize.glsl", model->templates_dir);
    const struct source *source = path ? glsl_source(model, path) : NULL;
    const char *at = source ? strstr(source->text, slot) : NULL;
    if (!at) {
        diag_error(glsl->diag, glsl->pass->shader_loc, "cannot read the library file %s",
                   path ? path : "sanitize.glsl");
        return false;
    }
    struct text *out = &glsl->parts[PART_END];
    text_add(out, "%s", place_function(glsl));
    text_add_bytes(out, source->text, (size_t)(at - source->text));
    glsl_binding(glsl->pass->accesses[glsl->pass->access_count - 1].binding, out);
    text_add(out, "%s\n", at + strlen(slot));
    return true;
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

/* Whether a name stands here to be read: it is neither declared nor assigned. */
static bool is_read(const char *line, const char *at, size_t length)
{
    const char *before = at, *after = at + length;
    while (before > line && (before[-1] == ' ' || before[-1] == '\t'))
        before--;
    if (*after == '.')
        after += strspn(after, ".xyzwrgbastpq");
    after += strspn(after, " \t");
    bool declared = before < at && before > line && text_is_word(before[-1]) &&
                    !(before - line >= 6 && !strncmp(before - 6, "return", 6));
    return !declared && !(after[0] == '=' && after[1] != '=');
}

/* The column of the nth word outside of comments, or of the last; 0: there is none. */
static int find_column(const char *line, const char *word, uint32_t nth, bool read)
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
        if (!stands(line, at, word, length) || (read && !is_read(line, at, length)))
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
    if (!strncmp(site->text, "index", 5))
        report->column = find_column(line, indexed, site->nth, true);
    else if (strstr(site->text, " is read "))
        report->column = find_column(line, word, site->nth, true);
    if (!report->column)
        report->column = find_column(line, word, site->nth, false);
    for (size_t i = 0; i < DT_ARRAY_COUNT(other_words) && !report->column; i++)
        if (!strcmp(other_words[i][0], word))
            report->column = find_column(line, other_words[i][1], site->nth, false);
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

static bool write_finding(const char *format, const uint32_t values[8],
                          struct sanitize_report *report)
{
    struct text out = {0};
    for (; *format; format++)
        if (*format == '@' && format[1] && format[2]) {
            put_value(format[2], values[format[1] - '0'], &out);
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

static bool read_site(const struct model *model, uint32_t index, const uint32_t *words,
                      struct sanitize_report *report)
{
    const struct sanitize_sites *sites = model->sites;
    const uint32_t *record = find_record(words);
    const struct sanitize_site *what = &sites->list[record[1] < sites->count ? record[1] : 0];
    uint32_t key = ~record[0], width = words[4] ? words[4] : 1, height = words[5] ? words[5] : 1;
    *report = (struct sanitize_report){.count = words[0], .frame = words[3] - 1};
    report->invocation[0] = key % width;
    report->invocation[1] = key / width % height;
    report->invocation[2] = (uint32_t)(key / ((uint64_t)width * height));
    report->pass = what->pass ? what->pass->name : "";
    place_site(model, index ? &sites->list[index] : what, report);
    return write_finding(what->text, record + 2, report);
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
        if (words[(size_t)i * SANITIZE_WORDS])
            good &=
                read_site(model, i, words + (size_t)i * SANITIZE_WORDS, &(*reports)[(*count)++]);
    if (*reports)
        qsort(*reports, *count, sizeof **reports, by_place);
    return *reports && good;
}
