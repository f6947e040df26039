/* Temporary names with the number of a process; see temporary.h. */
#include "base/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MARK ".diptych-tmp-" /* no name that a user's own file has */

char *temporary_path(const char *path)
{
    char *text = NULL;
    return asprintf(&text, "%s" MARK "%ld", path, (long)getpid()) < 0 ? NULL : text;
}

/* Whether the name has the number of a process that is gone. */
static bool is_left_over(const char *name)
{
    const char *mark = strstr(name, MARK);
    for (const char *later = mark; later; later = strstr(later + 1, MARK))
        mark = later;
    char *end = NULL;
    long number = mark ? strtol(mark + strlen(MARK), &end, 10) : 0;
    bool whole = number > 0 && (!*end || strcmp(end, TEMPORARY_FORMER) == 0);
    return whole && kill((pid_t)number, 0) != 0 && errno == ESRCH;
}

static void sweep_folder(const char *folder, int (*remove)(const char *path))
{
    DIR *list = opendir(folder);
    const struct dirent *entry;
    while (list && (entry = readdir(list))) {
        char *path = NULL;
        if (is_left_over(entry->d_name) && asprintf(&path, "%s/%s", folder, entry->d_name) >= 0) {
            remove(path);
            free(path);
        }
    }
    if (list)
        closedir(list);
}

void temporary_sweep(const char *path, int (*remove)(const char *path))
{
    static _Thread_local char last[4096];
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup("./");
    if (folder && strcmp(folder, last) != 0) {
        snprintf(last, sizeof last, "%s", folder);
        sweep_folder(folder, remove);
    }
    free(folder);
}

bool write_all(int descriptor, const void *bytes, size_t length)
{
    const char *data = bytes;
    while (length) {
        ssize_t done = write(descriptor, data, length);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return false;
        data += done;
        length -= (size_t)done;
    }
    return true;
}
