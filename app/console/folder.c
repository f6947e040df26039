/* Folders whole or not at all; see folder.h. */
#include "console/folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cjson/cJSON.h>

#include "base/files.h"
#include "base/temporary.h"

static void ignore_message(void *user, enum dt_level level, const char *message)
{
    (void)user;
    (void)level;
    (void)message;
}

/* Whether the folder's manifest.json has the key `mark`: one of ours, of the same kind. */
static bool is_marked(const char *place, const char *mark)
{
    const struct dt_log silent = {.message = ignore_message};
    char *path = format_string("%s/manifest.json", place);
    size_t size;
    char *text = path && file_exists(path) ? file_read(path, &size, &silent) : NULL;
    cJSON *manifest = text ? cJSON_Parse(text) : NULL;
    bool marked = cJSON_HasObjectItem(manifest, mark);
    cJSON_Delete(manifest);
    free(text);
    free(path);
    return marked;
}

/* True also where there is no folder; false where it cannot be listed. */
static bool folder_is_empty(const char *place)
{
    DIR *listing = opendir(place);
    int entries = 0;
    if (!listing)
        return errno == ENOENT;
    while (entries <= 2 && readdir(listing))
        entries++;
    closedir(listing);
    return entries == 2; /* itself and its parent */
}

static bool may_replace(const struct folder *folder)
{
    struct stat info;
    if (lstat(folder->place, &info) != 0 && errno == ENOENT)
        return true;
    return (S_ISDIR(info.st_mode) && ((folder->mark && is_marked(folder->place, folder->mark)) ||
                                      folder_is_empty(folder->place))) ||
           report_error(&folder->console->log,
                        folder->mark ? "%s %s: exists and was not written by an earlier %s; name "
                                       "another folder"
                                     : "%s %s: exists and is not empty; name another folder",
                        folder->option, folder->place, folder->option);
}

static char *without_slash(const char *place)
{
    size_t length = strlen(place);
    while (length > 1 && place[length - 1] == '/')
        length--;
    return strndup(place, length);
}

bool folder_can_write(struct console *console, const char *option, const char *place,
                      const char *mark)
{
    const struct folder folder = {
        .console = console, .option = option, .mark = mark, .place = without_slash(place)};
    bool good = folder.place && may_replace(&folder);
    free(folder.place);
    return good;
}

static int remove_left_over(const char *path)
{
    return file_remove_tree(path) ? 0 : -1;
}

bool folder_begin(struct folder *folder, struct console *console, const char *option,
                  const char *place, const char *mark)
{
    *folder = (struct folder){
        .console = console, .option = option, .mark = mark, .place = without_slash(place)};
    char *temporary = folder->place ? temporary_path(folder->place) : NULL;
    if (temporary)
        temporary_sweep(folder->place, remove_left_over);
    if (!temporary)
        return report_error(&console->log, "out of memory");
    if (!may_replace(folder) || !file_make_folders(temporary, &console->log)) {
        free(temporary);
        return false;
    }
    folder->temporary = temporary;
    console_temporary(console, temporary);
    return true;
}

bool folder_takes(const char *name)
{
    static const char word[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
    return *name && *name != '.' && !name[strspn(name, word)];
}

char *folder_plain_path(const char *path)
{
    char *plain = calloc(strlen(path) + 2, 1);
    size_t length = 0;
    for (const char *at = path; plain && *at;) {
        size_t part = strcspn(at, "/");
        if (part == 2 && strncmp(at, "..", 2) == 0) {
            while (length && plain[--length] != '/')
                continue;
            plain[length] = 0;
        } else if (part && !(part == 1 && *at == '.')) {
            plain[length++] = '/';
            memcpy(plain + length, at, part);
            length += part;
        }
        at += part + (at[part] == '/');
    }
    return plain;
}

/* Whether the path leads nowhere but down. */
static bool leads_down(const char *path)
{
    for (const char *part = path; part; part = strchr(part, '/')) {
        part += part > path;
        size_t length = strcspn(part, "/");
        if (!length || (*part == '.' && strspn(part, ".") == length))
            return false;
    }
    return true;
}

bool folder_write_at(const struct folder *folder, const char *path, const void *data, size_t size)
{
    const struct dt_log *log = &folder->console->log;
    char *whole = format_string("%s/%s", folder->temporary, path);
    char *parent = whole ? strndup(whole, (size_t)(strrchr(whole, '/') - whole)) : NULL;
    bool good = false;
    if (!parent)
        report_error(log, "out of memory");
    else if (!leads_down(path))
        report_error(log, "%s: leads out of the folder of %s", path, folder->option);
    else
        good = file_make_folders(parent, log) && file_write(whole, data, size, log);
    free(parent);
    free(whole);
    return good;
}

bool folder_write(const struct folder *folder, const char *name, const void *data, size_t size)
{
    return folder_takes(name) ? folder_write_at(folder, name, data, size)
                              : report_error(&folder->console->log,
                                             "`%s` cannot be the name of a file: use letters, "
                                             "digits, `_`, `-` and `.`, which is not first",
                                             name);
}

bool folder_write_json(const struct folder *folder, const char *name, const struct cJSON *value)
{
    char *path = format_string("%s/%s", folder->temporary, name);
    bool good = path && file_write_json(path, value, &folder->console->log);
    free(path);
    return good;
}

/* The old and the new folder change places in one step, so that one of them stands there whenever this
 * process is ended; folder_end removes the old one. File systems that cannot do that have none for a
 * moment, and the old one beside it. */
static bool exchange(const struct folder *folder)
{
    struct stat info;
    if (lstat(folder->place, &info) != 0)
        return errno == ENOENT && rename(folder->temporary, folder->place) == 0;
    if (renameat2(AT_FDCWD, folder->temporary, AT_FDCWD, folder->place, RENAME_EXCHANGE) == 0)
        return true;
    if (errno != EINVAL && errno != ENOSYS)
        return false;
    char *aside = format_string("%s.old", folder->temporary);
    bool good = aside && rename(folder->place, aside) == 0 &&
                rename(folder->temporary, folder->place) == 0 && file_remove_tree(aside);
    free(aside);
    return good;
}

static bool put_in_place(struct folder *folder)
{
    console_hold(folder->console);
    bool good = may_replace(folder);
    if (good && !exchange(folder)) {
        report_error(&folder->console->log, "%s %s: cannot be put in its place: %s", folder->option,
                     folder->place, strerror(errno));
        good = false;
    }
    console_release(folder->console);
    return good;
}

bool folder_end(struct folder *folder, bool keep)
{
    bool good = !keep || (folder->temporary && put_in_place(folder));
    if (folder->temporary) {
        file_remove_tree(folder->temporary); /* the old one, when it was put in its place */
        console_forget(folder->console, folder->temporary);
    }
    free(folder->temporary);
    free(folder->place);
    *folder = (struct folder){0};
    return good;
}
