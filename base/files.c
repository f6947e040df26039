/* Files whole or not at all; see files.h. */
#include "base/files.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/log.h"
#include "base/printable.h"
#include "base/input.h"
#include "base/temporary.h"

char *file_read(const char *path, size_t *size, const struct dt_log *log)
{
    const char *reason;
    char *data = input_read(path, SIZE_MAX - 1, size, &reason);
    if (!data)
        report_error(log, "%s: cannot be read: %s", path, reason);
    return data;
}

static bool write_and_close(int descriptor, const char *data, size_t size)
{
    bool good = write_all(descriptor, data, size);
    int error = errno;
    if (close(descriptor) != 0)
        return false;
    errno = error;
    return good;
}

/* A pipe, a terminal or another special file, also through a link such as /dev/stdout: must not be
 * replaced. */
static bool is_stream(const struct stat *status)
{
    bool nameless = S_ISREG(status->st_mode) && !status->st_nlink; /* memory of another process */
    return nameless || (!S_ISREG(status->st_mode) && !S_ISDIR(status->st_mode));
}

/* In the folder of the final file, with its permissions; links are followed. */
static bool write_and_rename(const char *path, const struct stat *old, const void *data,
                             size_t size)
{
    char *real = realpath(path, NULL);
    const char *place = real ? real : path;
    char *temporary = temporary_path(place);
    temporary_sweep(place, unlink);
    int descriptor =
        temporary ? open(temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666) : -1;
    if (descriptor >= 0 && old) /* fails on file systems without permissions: nothing is lost */
        (void)fchmod(descriptor, old->st_mode & 0777);
    bool good =
        descriptor >= 0 && write_and_close(descriptor, data, size) && rename(temporary, place) == 0;
    int error = errno;
    if (!good && descriptor >= 0)
        unlink(temporary);
    free(temporary);
    free(real);
    errno = error;
    return good;
}

bool file_write(const char *path, const void *data, size_t size, const struct dt_log *log)
{
    struct stat old;
    bool exists = stat(path, &old) == 0, good;
    if (exists && is_stream(&old)) {
        int descriptor = open(path, O_WRONLY | O_CLOEXEC);
        good = descriptor >= 0 && write_and_close(descriptor, data, size);
    } else {
        good = write_and_rename(path, exists ? &old : NULL, data, size);
    }
    return good || report_error(log, "%s: cannot be written: %s", path, strerror(errno));
}

bool file_write_json(const char *path, const struct cJSON *value, const struct dt_log *log)
{
    char *printed = cJSON_Print(value); /* paths and devices may hold bytes that are no UTF-8 */
    char *text = printed ? text_replaced(printed) : NULL;
    if (!text)
        report_error(log, "%s: out of memory", path);
    bool good = text && file_write(path, text, strlen(text), log);
    cJSON_free(printed);
    free(text);
    return good;
}

bool file_draft_begin(struct file_draft *draft, const struct dt_log *log)
{
    *draft = (struct file_draft){0};
    draft->out = open_memstream(&draft->text, &draft->size);
    return draft->out || report_error(log, "out of memory");
}

bool file_draft_end(struct file_draft *draft, const char *path, const struct dt_log *log)
{
    bool begun = draft->out, whole = begun && fclose(draft->out) == 0 && path && draft->size > 0;
    draft->out = NULL;
    if (begun && !whole)
        report_error(log, path ? "%s: out of memory" : "out of memory", path);
    bool good = whole && file_write(path, draft->text, draft->size, log);
    file_draft_discard(draft);
    return good;
}

void file_draft_discard(struct file_draft *draft)
{
    if (draft->out)
        fclose(draft->out);
    free(draft->text);
    *draft = (struct file_draft){0};
}

bool file_can_write(const char *path, const struct dt_log *log)
{
    char *real = realpath(path, NULL);
    const char *place = real ? real : path, *slash = strrchr(place, '/');
    char *folder = !slash           ? strdup(".")
                   : slash == place ? strdup("/")
                                    : strndup(place, (size_t)(slash - place));
    struct stat status;
    bool exists = stat(path, &status) == 0;
    bool good = exists && is_stream(&status) ? access(path, W_OK) == 0
                                             : folder && access(folder, W_OK | X_OK) == 0;
    if (good && exists && S_ISDIR(status.st_mode)) {
        errno = EISDIR;
        good = false;
    }
    if (!good)
        report_error(log, "%s: cannot be written: %s", path, strerror(errno));
    free(folder);
    free(real);
    return good;
}

bool file_exists(const char *path)
{
    return access(path, F_OK) == 0;
}

bool file_make_folders(const char *path, const struct dt_log *log)
{
    char *copy = strdup(path);
    bool good = copy;
    for (char *slash = copy ? copy + 1 : NULL; good; slash++) {
        slash = strchrnul(slash, '/');
        char end = *slash;
        *slash = 0;
        good = mkdir(copy, 0777) == 0 || errno == EEXIST;
        *slash = end;
        if (!end)
            break;
    }
    if (!good)
        report_error(log, "%s: the folder cannot be made: %s", path, strerror(errno));
    free(copy);
    return good;
}

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *place)
{
    (void)info;
    (void)type;
    (void)place;
    return remove(path);
}

bool file_remove_tree(const char *path)
{
    if (nftw(path, remove_entry, 8, FTW_DEPTH | FTW_PHYS) == 0)
        return true;
    return errno == ENOENT;
}

void hash_bytes(uint64_t *hash, const void *data, size_t size)
{
    *hash = XXH3_64bits_withSeed(data, size, *hash);
}

bool hash_file(uint64_t *hash, const char *path)
{
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return false;
    XXH3_state_t state;
    uint8_t block[65536];
    size_t got;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset_withSeed(&state, *hash);
    while ((got = fread(block, 1, sizeof block, stream)) > 0)
        XXH3_64bits_update(&state, block, got);
    *hash = XXH3_64bits_digest(&state);
    bool good = !ferror(stream);
    fclose(stream);
    return good;
}

char *file_contents(int file)
{
    struct stat info;
    char *text = fstat(file, &info) == 0 ? malloc((size_t)info.st_size + 1) : NULL;
    size_t size = 0;
    while (text && size < (size_t)info.st_size) {
        ssize_t got = pread(file, text + size, (size_t)info.st_size - size, (off_t)size);
        if (got <= 0 && errno != EINTR) {
            free(text);
            return NULL;
        }
        size += got > 0 ? (size_t)got : 0;
    }
    if (text)
        text[size] = 0;
    return text;
}
