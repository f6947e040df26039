/* Templates; see fill.h. */
#include "console/fill.h"

#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/tool.h"

struct filler {
    FILE *out;
    const char *path, *text;
    const struct dt_log *log;
};

/* What names are looked up in: an object or an item, inside another one. */
struct scope {
    const cJSON *value;
    const struct scope *outer;
    int index; /* of the item; -1: of no list */
};

struct tag {
    char kind; /* '#', '^', '/' or '>'; 0: a slot */
    char name[64];
    const char *begin, *end; /* with its whole line, where it stands there alone */
};

static void *wrong(const struct filler *filler, const char *at, const char *what, const char *name)
{
    int line = 1;
    for (const char *c = filler->text; c < at; c++)
        line += *c == '\n';
    const struct source source = {
        .path = filler->path, .text = filler->text, .length = strlen(filler->text)};
    report_at(filler->log, (struct loc){&source, line, 1, 1}, "%s `%s`", what, name);
    return NULL;
}

/* ---- Tags ------------------------------------------------------------------------------------ */

/* Widens a section's tag to its line when nothing else stands there. */
static void widen_to_line(const struct filler *filler, struct tag *tag)
{
    const char *begin = tag->begin, *end = tag->end + strspn(tag->end, " ");
    while (begin > filler->text && begin[-1] == ' ')
        begin--;
    if ((begin == filler->text || begin[-1] == '\n') && *end == '\n') {
        tag->begin = begin;
        tag->end = end + 1;
    }
}

/* The next tag; false, with an empty name, behind the last one, or, reported, for one that does not end. */
static bool next_tag(const struct filler *filler, const char *at, struct tag *tag)
{
    const char *begin = strstr(at, "{{"), *end = begin ? strstr(begin, "}}") : NULL;
    *tag = (struct tag){.begin = begin, .end = end ? end + 2 : NULL};
    if (!begin)
        return false;
    const char *name = begin + 2;
    if (strchr("#^/>", *name))
        tag->kind = *name++;
    if (!end || end - name >= (long)sizeof tag->name || end == name) {
        snprintf(tag->name, sizeof tag->name, "%.20s", begin);
        wrong(filler, begin, "this is no tag:", tag->name);
        return false;
    }
    memcpy(tag->name, name, (size_t)(end - name));
    if (tag->kind)
        widen_to_line(filler, tag);
    return true;
}

/* ---- Values ---------------------------------------------------------------------------------- */

static const cJSON *look_up(const struct scope *scope, const char *name)
{
    if (strcmp(name, ".") == 0)
        return scope->value;
    for (; scope; scope = scope->outer) {
        const cJSON *found = cJSON_GetObjectItemCaseSensitive(scope->value, name);
        if (found)
            return found;
    }
    return NULL;
}

static bool is_rest(const struct scope *scope)
{
    while (scope && scope->index < 0)
        scope = scope->outer;
    return scope && scope->index > 0;
}

static bool holds(const cJSON *value)
{
    return value && !cJSON_IsNull(value) && !cJSON_IsFalse(value) &&
           !(cJSON_IsString(value) && !*value->valuestring) &&
           !(cJSON_IsArray(value) && !value->child);
}

static void put_escaped(FILE *out, const char *text)
{
    for (; *text; text++) {
        const char *entity = *text == '&'   ? "&amp;"
                             : *text == '<' ? "&lt;"
                             : *text == '>' ? "&gt;"
                             : *text == '"' ? "&quot;"
                                            : NULL;
        if (entity)
            fputs(entity, out);
        else
            fputc(*text, out);
    }
}

static bool fill_value(const struct filler *filler, const struct scope *scope,
                       const struct tag *tag)
{
    const cJSON *value = look_up(scope, tag->name);
    if (cJSON_IsString(value))
        put_escaped(filler->out, value->valuestring);
    else if (cJSON_IsNumber(value))
        fprintf(filler->out, "%.9g", value->valuedouble);
    else
        return wrong(filler, tag->begin, "no text or number", tag->name);
    return true;
}

/* ---- Sections -------------------------------------------------------------------------------- */

static const char *fill_section(const struct filler *filler, const struct tag *tag,
                                const struct scope *scope, bool shown);

static bool fill_beside(const struct filler *filler, const struct tag *tag,
                        const struct scope *scope);

/* Fills from `at` to the closing tag of the section `name`, or, when that is NULL, to the end. Returns what follows, or
 * NULL, reported. Unless `shown`, nothing is written. */
static const char *fill_part(const struct filler *filler, const char *at, const char *name,
                             const struct scope *scope, bool shown)
{
    struct tag tag;
    while (at && next_tag(filler, at, &tag)) {
        if (shown)
            fwrite(at, 1, (size_t)(tag.begin - at), filler->out);
        at = tag.end;
        if (tag.kind == '/' && (!name || strcmp(name, tag.name) != 0))
            return wrong(filler, tag.begin, "no section is open of the name", tag.name);
        if (tag.kind == '/')
            return at;
        if (tag.kind == '>' && shown && !fill_beside(filler, &tag, scope))
            return NULL;
        if (tag.kind && tag.kind != '>')
            at = fill_section(filler, &tag, scope, shown);
        else if (!tag.kind && shown && !fill_value(filler, scope, &tag))
            return NULL;
    }
    if (!at || tag.begin)
        return NULL;
    if (name)
        return wrong(filler, at, "not closed: the section", name);
    fputs(at, filler->out);
    return at + strlen(at);
}

static const char *fill_section(const struct filler *filler, const struct tag *tag,
                                const struct scope *scope, bool shown)
{
    bool rest = strcmp(tag->name, "@rest") == 0;
    const cJSON *value = rest ? NULL : look_up(scope, tag->name);
    bool held = rest ? is_rest(scope) : holds(value);
    const struct scope inner = {.value = value, .outer = scope, .index = -1};
    if (!shown || held != (tag->kind == '#'))
        return fill_part(filler, tag->end, tag->name, scope, false);
    if (tag->kind == '^' || rest)
        return fill_part(filler, tag->end, tag->name, scope, true);
    if (!cJSON_IsArray(value))
        return fill_part(filler, tag->end, tag->name, &inner, true);
    const char *end = tag->end;
    struct scope of_item = inner;
    cJSON_ArrayForEach(of_item.value, value)
    {
        of_item.index++;
        end = fill_part(filler, tag->end, tag->name, &of_item, true);
        if (!end)
            break;
    }
    return end;
}

static bool fill_file(FILE *out, const char *path, const struct scope *scope,
                      const struct dt_log *log)
{
    size_t size;
    char *text = file_read(path, &size, log);
    const struct filler filler = {.out = out, .path = path, .text = text, .log = log};
    bool good = text && fill_part(&filler, text, NULL, scope, true);
    free(text);
    return good;
}

static bool fill_beside(const struct filler *filler, const struct tag *tag,
                        const struct scope *scope)
{
    const char *slash = strrchr(filler->path, '/');
    int folder = slash ? (int)(slash + 1 - filler->path) : 0;
    char *path = format_string("%.*s%s", folder, filler->path, tag->name);
    bool good = path && fill_file(filler->out, path, scope, filler->log);
    free(path);
    return good;
}

bool fill_template(FILE *out, const char *path, const cJSON *data, const struct dt_log *log)
{
    return fill_file(out, path, &(struct scope){.value = data, .index = -1}, log);
}

bool fill_page(struct console *console, const char *name, const char *path, const cJSON *data)
{
    const struct dt_log *log = &console->log;
    char *folder = templates_folder(log);
    char *template = folder ? format_string("%s/report/%s", folder, name) : NULL;
    struct file_draft draft;
    bool good =
        file_draft_begin(&draft, log) && template && fill_template(draft.out, template, data, log);
    if (good) {
        console_hold(console);
        good = file_draft_end(&draft, path, log);
        console_release(console);
    } else {
        file_draft_discard(&draft);
    }
    free(template);
    free(folder);
    return good;
}
