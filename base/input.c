/* Input files; see input.h. */
#include "base/input.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Reads until the end: the file may have grown since fstat. errno after NULL; EFBIG beyond the
 * limit. */
static char *read_all(int file, size_t expected, size_t most, size_t *length)
{
    size_t capacity = expected + 1, used = 0;
    char *text = malloc(capacity);
    while (text) {
        ssize_t got = read(file, text + used, capacity - used);
        if (got < 0 && errno == EINTR)
            continue;
        used += got > 0 ? (size_t)got : 0;
        if (got < 0 || used > most) {
            int problem = got < 0 ? errno : EFBIG;
            free(text);
            errno = problem;
            return NULL;
        }
        if (used < capacity) {
            if (got > 0)
                continue;
            text[used] = '\0';
            *length = used;
            return text;
        }
        char *larger = realloc(text, capacity *= 2);
        if (!larger)
            free(text);
        text = larger;
    }
    errno = ENOMEM;
    return NULL;
}

static const char *too_large(size_t most)
{
    static _Thread_local char text[64];
    snprintf(text, sizeof text, "it is larger than %zu MiB", most >> 20);
    return text;
}

/* The descriptor of a regular file of at most `most` bytes; -1: *reason. */
static int open_regular(const char *path, size_t most, size_t *length, const char **reason)
{
    struct stat status;
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    *reason = NULL;
    if (file < 0 || fstat(file, &status) != 0)
        *reason = strerror(errno);
    else if (S_ISDIR(status.st_mode))
        *reason = strerror(EISDIR);
    else if (!S_ISREG(status.st_mode))
        *reason = "it is no regular file";
    else if ((size_t)status.st_size > most)
        *reason = too_large(most);
    else
        *length = (size_t)status.st_size;
    if (!*reason)
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

bool input_room(int count)
{
    int file = count > 0 ? open("/dev/null", O_RDONLY | O_CLOEXEC) : -1;
    bool good = count <= 0 || (file >= 0 && input_room(count - 1));
    if (file >= 0)
        close(file);
    return good;
}

bool input_check(const char *path, size_t most, const char **reason)
{
    size_t length;
    int file = open_regular(path, most, &length, reason);
    if (file >= 0)
        close(file);
    return file >= 0;
}

FILE *input_open(const char *path, size_t most, const char **reason)
{
    size_t length;
    int file = open_regular(path, most, &length, reason);
    FILE *stream = file < 0 ? NULL : fdopen(file, "rb");
    if (file >= 0 && !stream) {
        *reason = strerror(errno);
        close(file);
    }
    return stream;
}

char *input_read(const char *path, size_t most, size_t *length, const char **reason)
{
    size_t expected = 0;
    int file = open_regular(path, most, &expected, reason);
    if (file < 0)
        return NULL;
    char *text = read_all(file, expected, most, length);
    if (!text)
        *reason = errno == EFBIG ? too_large(most) : strerror(errno);
    close(file);
    return text;
}

const char *input_seen(const char *path)
{
    static const struct {
        const char *start;
        size_t length;
        const char *name;
    } kinds[] = {{"\xff\xfe\0\0", 4, "UTF-32 text"},
                 {"\0\0\xfe\xff", 4, "UTF-32 text"},
                 {"\xff\xfe", 2, "UTF-16 text"},
                 {"\xfe\xff", 2, "UTF-16 text"},
                 {"\x1f\x8b", 2, "compressed by gzip"},
                 {"\xfd"
                  "7zXZ",
                  5, "compressed by xz"},
                 {"\x28\xb5\x2f\xfd", 4, "compressed by zstd"},
                 {"BZh", 3, "compressed by bzip2"},
                 {"PK\3\4", 4, "a ZIP archive"},
                 {"7z\xbc\xaf", 4, "a 7z archive"},
                 {"Rar!", 4, "a RAR archive"},
                 {"version https://git-lfs", 23, "a pointer of Git LFS, without the file"},
                 {"<!DOCTYPE html", 14, "a web page"},
                 {"<!doctype html", 14, "a web page"},
                 {"<html", 5, "a web page"},
                 {"\x89PNG", 4, "a PNG picture"},
                 {"\xff\xd8\xff", 3, "a JPEG picture"},
                 {"%PDF", 4, "a PDF document"},
                 {"\x7f"
                  "ELF",
                  4, "a program"}};
    char start[32];
    const char *reason;
    FILE *file = input_open(path, SIZE_MAX, &reason);
    size_t got = file ? fread(start, 1, sizeof start, file) : 0;
    if (!file)
        return NULL;
    fclose(file);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (got >= kinds[i].length && memcmp(start, kinds[i].start, kinds[i].length) == 0)
            return kinds[i].name;
    bool wide = got >= 8 && (start[0] == 0) != (start[1] == 0);
    for (size_t i = 2; wide && i + 1 < got; i += 2)
        wide = (start[i] == 0) == (start[0] == 0) && (start[i + 1] == 0) == (start[1] == 0);
    return got == 0 ? "empty" : wide ? "UTF-16 text" : NULL;
}
