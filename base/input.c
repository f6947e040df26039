/* Input files; see input.h. */
#include "base/input.h"

#include <errno.h>
#include <fcntl.h>
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
