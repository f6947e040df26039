/* See body_files.h. */
#include "body_files.h"

#include <spirv/unified1/spirv.h>

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "model/foreign.h"

enum { MOST_FILES = 256, MOST_INCLUDES = 1024 };

const char *find_word(const char *text, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = text; at && length && (at = strstr(at, word)); at += length) {
        bool starts = at == text || (!text_is_word(at[-1]) && at[-1] != '.');
        if (starts && !text_is_word(at[length]))
            return at;
    }
    return NULL;
}

void blank_comments(char *at)
{
    while (*at) {
        if (at[0] == '/' && at[1] == '/') {
            for (; *at && (*at != '\n' || at[-1] == '\\'); at++)
                *at = *at == '\n' || (*at == '\\' && at[1] == '\n') ? *at : ' ';
        } else if (at[0] == '/' && at[1] == '*') {
            at[0] = at[1] = ' ';
            for (at += 2; *at && !(at[0] == '*' && at[1] == '/'); at++)
                *at = *at == '\n' ? '\n' : ' ';
            for (int i = 0; i < 2 && *at; i++)
                *at++ = ' ';
        } else {
            at++;
        }
    }
}

char *find_version(char *code)
{
    char *at = code + strspn(code, " \t\r\n\xef\xbb\xbf"); /* or a byte order mark */
    size_t blanks = *at == '#' ? strspn(at + 1, " \t") : 0;
    return *at == '#' && !strncmp(at + 1 + blanks, "version", 7) ? at : NULL;
}

bool source_is_whole(const struct source *source)
{
    if (source->words)
        return true;
    char *code = strndup(source->text, source->length);
    if (code)
        blank_comments(code);
    bool whole = code && find_version(code);
    free(code);
    return whole;
}

/* The text for glslang: the generated text has its #version before this one's. */
static const char *without_version(struct model *model, const struct source *source, char *code,
                                   struct body_files *files)
{
    char *version = find_version(code), *text;
    if (!version)
        return source->text;
    size_t length = strcspn(version, "\r\n");
    unsigned number = (unsigned)atoi(version + strcspn(version, "0123456789\r\n"));
    files->version = number > files->version ? number : files->version;
    files->whole = true;
    text = arena_strndup(model->arena, source->text, source->length);
    if (text && text[0] == '\xef')
        memset(text, ' ', 3);
    if (text)
        memset(text + (version - code), ' ', length);
    memset(version, ' ', length);
    return text;
}

/* ---- The table of files ----------------------------------------------------------------------------------- */

const struct source *glsl_source(struct model *model, const char *path)
{
    const char *plain = source_path(model->arena, path);
    uint32_t count = model->glsl_source_count;
    for (uint32_t i = 0; plain && i < count; i++)
        if (!strcmp(model->glsl_sources[i]->path, plain))
            return model->glsl_sources[i];
    const char *reason;
    const struct source *source = plain ? source_read(model, plain, &reason) : NULL;
    return source && glsl_source_add(model, source, NULL) ? source : NULL;
}

bool glsl_source_add(struct model *model, const struct source *source, uint32_t *number)
{
    uint32_t count = model->glsl_source_count;
    for (uint32_t i = 0; i < count; i++)
        if (model->glsl_sources[i] == source) {
            if (number)
                *number = i + 1;
            return true;
        }
    const struct source **sources = arena_alloc(model->arena, (count + 1) * sizeof *sources);
    if (!sources)
        return false;
    if (count)
        memcpy(sources, model->glsl_sources, count * sizeof *sources);
    sources[count] = source;
    model->glsl_sources = sources;
    model->glsl_source_count = count + 1;
    if (number)
        *number = count + 1;
    return true;
}

/* ---- Files of a body -------------------------------------------------------------------------- */

/* A file that lines of a module are of. */
struct numbering {
    struct model *model;
    struct body_file *file; /* the module's */
};

static uint32_t number_file(void *user, const char *name, const char *text)
{
    const struct numbering *numbering = user;
    struct model *model = numbering->model;
    struct source *source = arena_alloc(model->arena, sizeof *source);
    uint32_t number = 0;
    if (!strcmp(name, numbering->file->source->path))
        return numbering->file->number;
    if (source)
        *source = (struct source){.path = arena_strndup(model->arena, name, strlen(name)),
                                  .text = arena_printf(model->arena, "%s", text ? text : ""),
                                  .length = text ? strlen(text) : 0};
    bool good = source && source->path && source->text && glsl_source_add(model, source, &number);
    return good ? number : 0;
}

/* The names of a module in place of its text. */
static bool add_module(struct model *model, struct body_files *files, struct body_file *file)
{
    const struct source *source = file->source;
    struct numbering numbering = {model, file};
    struct text names = {0};
    size_t count = source->word_count;
    uint32_t *words = spirv_number_files(source->words, &count, number_file, &numbering);
    uint32_t *copy = words ? arena_alloc(model->arena, count * sizeof *copy) : NULL;
    for (size_t at = SPIRV_HEADER; copy && at < count; at += words[at] >> 16)
        if (spirv_is(words + at, SpvOpName) || spirv_is(words + at, SpvOpMemberName))
            text_add(&names, "%s\n",
                     (const char *)(words + at + (spirv_is(words + at, SpvOpName) ? 2 : 3)));
    if (copy)
        memcpy(copy, words, count * sizeof *copy);
    free(words);
    file->words = copy;
    file->word_count = count;
    file->text = "";
    file->code =
        names.failed ? NULL : arena_printf(model->arena, "%s", names.data ? names.data : "");
    text_free(&names);
    files->whole = true;
    return copy && file->code;
}

static bool add_file(struct model *model, struct body_files *files, const struct source *source)
{
    struct body_file *file = &files->list[files->count];
    if (!glsl_source_add(model, source, &file->number))
        return false;
    file->name = arena_printf(model->arena, "%u", file->number);
    file->source = source;
    if (source->words && !add_module(model, files, file))
        return false;
    char *code = source->words ? NULL : arena_strndup(model->arena, source->text, source->length);
    if (code) {
        blank_comments(code);
        file->text = without_version(model, source, code, files);
        file->code = code;
    }
    files->count++;
    return file->name && file->text;
}

/* Beside the including file, then in the templates, then in templates/glsl. */
static const struct source *find_include(struct model *model, const struct source *from,
                                         const char *name, size_t length)
{
    const struct source *source = NULL;
    for (int place = 0; place < 3 && !source; place++) {
        const char *path = source_candidate(model, from->path, name, length, place);
        source = path ? glsl_source(model, path) : NULL;
    }
    return source;
}

/* Behind a `#`: the name of an include in quotes; NULL: another directive. */
static const char *include_name(const char *at, size_t *length)
{
    while (*at == ' ' || *at == '\t' || (at[0] == '\\' && at[1] == '\n' && at++))
        at++;
    if (strncmp(at, "include", 7) != 0)
        return NULL;
    at += 7 + strspn(at + 7, " \t");
    *length = *at == '"' ? strcspn(at + 1, "\"\n") : 0;
    return *at == '"' && at[1 + *length] == '"' ? at + 1 : NULL;
}

static bool add_include(struct model *model, struct body_files *files, uint32_t from,
                        const char *name, size_t length)
{
    const struct source *source = find_include(model, files->list[from].source, name, length);
    uint32_t file = 0;
    if (!source || files->include_count == MOST_INCLUDES)
        return true;
    while (file < files->count && files->list[file].source != source)
        file++;
    if (file == files->count && (file == MOST_FILES || !add_file(model, files, source)))
        return file == MOST_FILES;
    const char *copy = arena_strndup(model->arena, name, length);
    files->includes[files->include_count++] =
        (struct body_include){files->list[from].number, copy, &files->list[file]};
    return copy;
}

/* Blanks what stands in quotes: words of file names are no identifiers. */
static void blank_names(char *code)
{
    for (char *at = code; (at = strchr(at, '#')); at++) {
        size_t length;
        const char *name = include_name(at + 1, &length);
        if (name)
            memset(code + (name - code), ' ', length);
    }
}

const struct body_files *body_files_read(struct model *model, const struct source *body)
{
    struct body_files *files = arena_alloc(model->arena, sizeof *files);
    struct body_file *list = arena_alloc(model->arena, MOST_FILES * sizeof *list);
    struct body_include *includes = arena_alloc(model->arena, MOST_INCLUDES * sizeof *includes);
    if (!files || !list || !includes)
        return NULL;
    *files = (struct body_files){.list = list, .includes = includes};
    bool good = add_file(model, files, body);
    for (uint32_t i = 0; good && i < files->count; i++)
        for (const char *at = list[i].code; good && (at = strchr(at, '#')); at++) {
            size_t length;
            const char *name = include_name(at + 1, &length);
            if (name)
                good = add_include(model, files, i, name, length);
        }
    for (uint32_t i = 0; good && i < files->count; i++)
        blank_names(files->list[i].code);
    return good ? files : NULL;
}

const struct body_file *body_include(const struct body_files *files, const char *from,
                                     const char *name)
{
    uint32_t number = files && !*from ? files->list[0].number : (uint32_t)strtoul(from, NULL, 10);
    for (uint32_t i = 0; files && i < files->include_count; i++) {
        const struct body_include *include = &files->includes[i];
        if (include->from == number && !strcmp(include->name, name))
            return include->file;
    }
    return NULL;
}

uint32_t body_find(const struct body_files *files, const char *word, struct loc *loc)
{
    for (uint32_t i = files->count; i-- > 0;) {
        const struct body_file *file = &files->list[i];
        const char *at = find_word(file->code, word);
        if (!at)
            continue;
        *loc = (struct loc){file->source, 1, 1, (int)strlen(word)};
        for (const char *line = file->code; line < at; line++)
            loc->line += *line == '\n';
        return file->number;
    }
    return 0;
}

bool body_mentions(const struct body_files *files, const char *word)
{
    for (uint32_t i = 0; files && i < files->count; i++)
        if (find_word(files->list[i].code, word))
            return true;
    return false;
}

bool body_mentions_value(const struct body_files *files, const char *name)
{
    char part[256];
    bool found = body_mentions(files, name);
    for (size_t length = 1; files_are_whole(files) && !found && name[length]; length++) {
        snprintf(part, sizeof part, "%.*s", (int)length, name);
        found = name[length] == '_' && body_mentions(files, part);
    }
    return found;
}

bool body_mentions_member(const struct body_files *files, const char *word)
{
    size_t length = strlen(word);
    for (uint32_t i = 0; files && i < files->count; i++) {
        const char *code = files->list[i].code;
        for (const char *at = code; (at = strstr(at, word)); at += length) {
            const char *before = at;
            while (before > code && isspace((unsigned char)before[-1]))
                before--;
            if (before > code && before[-1] == '.' && !text_is_word(at[length]))
                return true;
        }
    }
    return false;
}

bool body_mentions_prefix(const struct body_files *files, const char *prefix)
{
    for (uint32_t i = 0; files && i < files->count; i++)
        for (const char *at = files->list[i].code; (at = strstr(at, prefix)); at++)
            if (at == files->list[i].code || !text_is_word(at[-1]))
                return true;
    return false;
}

bool body_asks_for(const struct body_files *files, const char *macro)
{
    for (uint32_t i = 0; files && i < files->count; i++)
        for (const char *at = files->list[i].code; (at = find_word(at, macro)); at++) {
            const char *line = at;
            while (line > files->list[i].code &&
                   (line[-1] != '\n' || (line - 1 > files->list[i].code && line[-2] == '\\')))
                line--;
            line += strspn(line, " \t");
            if (*line == '#')
                return true;
        }
    return false;
}

/* ---- Scanning -------------------------------------------------------------------------------- */

/* Skips blanks, comments and preprocessor lines. */
static const char *skip_blank(const char *at)
{
    for (;;) {
        while (isspace((unsigned char)*at))
            at++;
        if (at[0] == '/' && at[1] == '*') {
            const char *end = strstr(at + 2, "*/");
            at = end ? end + 2 : at + strlen(at);
        } else if ((at[0] == '/' && at[1] == '/') || at[0] == '#') {
            for (at += strcspn(at, "\n"); *at && at[-1] == '\\'; at += strcspn(at, "\n"))
                at++;
        } else {
            return at;
        }
    }
}

/* The end of a number such as 12u, .5, 1.5e-3 or 0x1e. */
static const char *skip_number(const char *at)
{
    const char *end = at + 1;
    bool hexadecimal = *end == 'x' || *end == 'X';
    while (text_is_word(*end) || *end == '.' ||
           (!hexadecimal && (*end == '+' || *end == '-') && (end[-1] == 'e' || end[-1] == 'E')))
        end++;
    return end;
}

struct token token_next(const char **cursor)
{
    const char *at = skip_blank(*cursor), *end = at;
    if (isdigit((unsigned char)at[*at == '.']))
        end = skip_number(at);
    else if (text_is_word(*end))
        while (text_is_word(*end))
            end++;
    else if (*end)
        end++;
    *cursor = end;
    return (struct token){at, (size_t)(end - at)};
}
