/* See foreign.h. */
#include "base/foreign.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/log.h"
#include "base/files.h"
#include "base/printable.h"

/* Without openat2 (Linux 5.6): every folder on the way is opened by itself. */
static int open_by_steps(int folder, const char *name)
{
    int at = dup(folder);
    while (at >= 0) {
        size_t length = strcspn(name, "/");
        char *step = strndup(name, length);
        bool last = !name[length], inside = step && *step && strcmp(step, "..") != 0;
        int next =
            inside
                ? openat(at, step,
                         O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | (last ? 0 : O_DIRECTORY))
                : -1;
        int error = step && !inside ? EXDEV : errno;
        close(at);
        free(step);
        errno = error;
        if (last || next < 0)
            return next;
        at = next;
        name += length + 1;
    }
    return -1;
}

static int open_inside(const char *folder, const char *name)
{
    const struct open_how how = {.flags = O_RDONLY | O_CLOEXEC | O_NONBLOCK,
                                 .resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS};
    int directory = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (directory < 0)
        return -1;
    int file = (int)syscall(SYS_openat2, directory, name, &how, sizeof how);
    if (file < 0 && (errno == ENOSYS || errno == EPERM)) /* EPERM: some sandboxes */
        file = open_by_steps(directory, name);
    int error = errno;
    close(directory);
    errno = error;
    return file;
}

static const char *reason(int error)
{
    return error == EXDEV   ? "is outside the folder"
           : error == ELOOP ? "is a symbolic link, which a folder of others may not have"
                            : strerror(error);
}

char *foreign_read(const char *folder, const char *name, size_t most, size_t *size,
                   const struct dt_log *log)
{
    struct stat info = {0};
    int file = open_inside(folder, name);
    bool good = file >= 0 && fstat(file, &info) == 0;
    char *data = NULL;
    *size = 0;
    if (!good) {
        report_error(log, "%s/%s: cannot be read: %s", folder, name, reason(errno));
    } else if (!S_ISREG(info.st_mode)) {
        report_error(log, "%s/%s: cannot be read: is no file", folder, name);
    } else if ((uintmax_t)info.st_size > most) {
        report_error(log, "%s/%s: has %jd bytes, more than %zu", folder, name,
                     (intmax_t)info.st_size, most);
    } else {
        data = file_contents(file);
        *size = (size_t)info.st_size;
        if (!data)
            report_error(log, "%s/%s: cannot be read: %s", folder, name, strerror(errno));
    }
    if (file >= 0)
        close(file);
    return data;
}

void *foreign_read_exactly(const char *folder, const char *name, size_t size,
                           const struct dt_log *log)
{
    size_t found;
    char *data = foreign_read(folder, name, size, &found, log);
    if (!data || found == size)
        return data;
    report_error(log, "%s/%s: has %zu bytes instead of %zu: the folder is damaged", folder, name,
                 found, size);
    free(data);
    return NULL;
}

static bool make_printable(cJSON *value)
{
    bool good = true;
    if (cJSON_IsString(value) && !text_is_printable(value->valuestring)) {
        char *text = text_printable(value->valuestring);
        good = text && cJSON_SetValuestring(value, text);
        free(text);
    }
    cJSON *item;
    cJSON_ArrayForEach(item, value) good = make_printable(item) && good;
    return good;
}

cJSON *foreign_json(const char *folder, const char *name, const struct dt_log *log)
{
    size_t size;
    char *text = foreign_read(folder, name, FOREIGN_TEXT_BYTES, &size, log);
    bool whole = text && strlen(text) == size;
    cJSON *value = whole ? cJSON_ParseWithOpts(text, NULL, true) : NULL;
    if (text && !value)
        report_error(log, "%s/%s: is no JSON", folder, name);
    free(text);
    if (value && !make_printable(value)) {
        report_error(log, "%s/%s: out of memory", folder, name);
        cJSON_Delete(value);
        return NULL;
    }
    return value;
}

bool foreign_has(const char *folder, const char *name)
{
    struct stat info;
    char *path = format_string("%s/%s", folder, name);
    bool there = path && lstat(path, &info) == 0;
    free(path);
    return there;
}

bool foreign_is_beside(const char *path, const char *file)
{
    const char *slash = strrchr(file, '/');
    char *real = realpath(path, NULL);
    bool inside = !real && errno != ENOMEM && errno != ENAMETOOLONG;
    char *beside = slash ? strndup(file, (size_t)(slash - file + 1)) : strdup("./");
    char *folder = real && beside ? realpath(beside, NULL) : NULL;
    if (folder) {
        size_t length = strcmp(folder, "/") == 0 ? 0 : strlen(folder);
        inside = strncmp(real, folder, length) == 0 && real[length] == '/';
    }
    free(real);
    free(beside);
    free(folder);
    return inside;
}
