/* Input files; see input.h. */
#include "input.h"

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

static char *read_regular(int file, size_t most, size_t *length, const char **reason)
{
    static _Thread_local char large[64];
    struct stat status;
    char *text = NULL;
    *reason = NULL;
    snprintf(large, sizeof large, "it is larger than %zu MiB", most >> 20);
    if (fstat(file, &status) != 0)
        *reason = strerror(errno);
    else if (S_ISDIR(status.st_mode))
        *reason = strerror(EISDIR);
    else if (!S_ISREG(status.st_mode))
        *reason = "it is no regular file";
    else if ((size_t)status.st_size > most)
        *reason = large;
    else if (!(text = read_all(file, (size_t)status.st_size, most, length)))
        *reason = errno == EFBIG ? large : strerror(errno);
    return text;
}

char *input_read(const char *path, size_t most, size_t *length, const char **reason)
{
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) {
        *reason = strerror(errno);
        return NULL;
    }
    char *text = read_regular(file, most, length, reason);
    close(file);
    return text;
}
