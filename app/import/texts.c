/* See texts.h. */
#include "import/texts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "gen/glsl/glslang.h"

/* Reads the file `from`; takes over its absolute path. */
static bool add_text(struct import_texts *texts, const char *from, char *path,
                     const struct dt_log *log)
{
    struct import_source *source = &texts->list[texts->count];
    *source = (struct import_source){.path = path};
    source->text = path ? import_text(from, &source->size, log) : NULL;
    if (!source->text) {
        free(path);
        return false;
    }
    snprintf(source->number, sizeof source->number, "%u", ++texts->count);
    return true;
}

bool texts_read(struct import_texts *texts, struct import *import, const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup("./");
    char *real = folder ? realpath(folder, NULL) : NULL;
    char *whole = format_string("%s/%s", real ? real : "", slash ? slash + 1 : path);
    *texts = (struct import_texts){.import = import};
    bool good = whole && add_text(texts, path, folder_plain_path(whole), &import->console->log);
    free(whole);
    free(real);
    free(folder);
    return good;
}

/* Counts an include. */
static bool is_within_bounds(struct import_texts *texts, size_t bytes)
{
    texts->bytes += bytes;
    if (++texts->includes > MOST_INCLUDES)
        texts->excess = "it includes more than 4096 files";
    else if (texts->bytes > IMPORT_TEXT_BYTES)
        texts->excess = "it includes more than 16 MiB of text";
    else if (texts->count == MOST_TEXTS)
        texts->excess = "it includes more than 255 different files";
    return !texts->excess;
}

/* Adds the file at `path`; where there is none, that of the same name beside a folder above, as compilers find it by -I.
 * Its copy then stands at `path`. Takes over `path`. */
static bool find_include(struct import_texts *texts, const char *name, char *path)
{
    static const char *const folders[] = {"", "include/", "includes/", "includes/glsl/", "common/"};
    const struct dt_log silent = {0};
    struct stat status;
    char *from = strdup(path);
    size_t length = strlen(path), own = strlen(name);
    bool inside = length >= own && !strcmp(path + length - own, name); /* without `..` */
    length -= inside ? own : 0;
    for (int above = inside ? 0 : 4; from && above < 4 && stat(from, &status) != 0; above++) {
        while (length && path[--length] == '/')
            continue;
        while (length && path[length - 1] != '/')
            length--;
        for (size_t i = 0; i < DT_ARRAY_COUNT(folders) && stat(from, &status) != 0; i++) {
            free(from);
            from = format_string("%.*s%s%s", (int)length, path, folders[i], name);
            if (!from)
                break;
        }
    }
    bool good = from && add_text(texts, from, path, &silent);
    if (!from)
        free(path);
    free(from);
    return good;
}

bool texts_include(const void *user, const char *from, const char *name, struct glslang_file *file)
{
    struct import_texts *texts = (struct import_texts *)user;
    uint32_t number = *from ? (uint32_t)strtoul(from, NULL, 10) : 1, i = 0;
    const char *beside = texts->list[number && number <= texts->count ? number - 1 : 0].path;
    char *path = format_string("%.*s/%s", (int)(strrchr(beside, '/') - beside), beside, name);
    char *plain = path && *name != '/' ? folder_plain_path(path) : NULL;
    free(path);
    while (plain && i < texts->count && strcmp(texts->list[i].path, plain) != 0)
        i++;
    if (plain && i < texts->count)
        free(plain);
    else if (!plain || !find_include(texts, name, plain))
        return false;
    const struct import_source *source = &texts->list[i];
    *file = (struct glslang_file){source->number, source->text, source->size};
    return is_within_bounds(texts, source->size);
}

/* The length of the path of the innermost folder that has them all. */
static size_t common_length(const struct import_texts *texts)
{
    const char *first = texts->list[0].path;
    size_t length = (size_t)(strrchr(first, '/') - first) + 1;
    for (uint32_t i = 1; i < texts->count; i++)
        while (strncmp(texts->list[i].path, first, length) != 0)
            for (length--; first[length - 1] != '/';)
                length--;
    return length;
}

static bool copy_text(const struct import_texts *texts, const struct import_source *source,
                      const char *prefix, const char *place)
{
    struct import *import = texts->import;
    for (const char *at = place; *at; at += strcspn(at, "/"), at += *at == '/') {
        char part[256];
        snprintf(part, sizeof part, "%.*s", (int)strcspn(at, "/"), at);
        if (!folder_takes(part))
            return import_refuse(import, source->path, NULL, NULL,
                                 "`%s` is no name for a file beside a spec: use letters, digits, "
                                 "`_`, `-` and `.`",
                                 part);
    }
    char *path = format_string("%s%s", prefix, place);
    bool good = path && folder_write_at(&import->folder, path, source->text, source->size);
    free(path);
    return good;
}

bool texts_write(const struct import_texts *texts, const char *prefix, char *name, size_t size)
{
    size_t root = common_length(texts);
    const char *first = texts->list[0].path + root, *slash = strrchr(first, '/');
    char own[256];
    import_file_name(first, own, sizeof own);
    snprintf(name, size, "%.*s%s", slash ? (int)(slash - first) + 1 : 0, first, own);
    bool good = copy_text(texts, &texts->list[0], prefix, name);
    for (uint32_t i = 1; good && i < texts->count; i++)
        good = copy_text(texts, &texts->list[i], prefix, texts->list[i].path + root);
    char *place = format_string("%s%s", prefix, name);
    snprintf(name, size, "%s", place ? place : "");
    free(place);
    return good;
}

void texts_free(struct import_texts *texts)
{
    for (uint32_t i = 0; i < texts->count; i++) {
        free(texts->list[i].path);
        free(texts->list[i].text);
    }
    texts->count = 0;
}
