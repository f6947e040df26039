/* A stream to Python; see hand_over.h. */
#include "truth/hand_over.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "picture/hdr.h"

bool hand_over_picture(FILE *stream, const char *path, const char *name, uint32_t size[2],
                       const struct dt_log *log)
{
    uint32_t own[2];
    float *rgba = NULL;
    if (!hdr_read(path, &own[0], &own[1], &rgba, log))
        return false;
    bool good = !size[0] || (size[0] == own[0] && size[1] == own[1]);
    if (!good)
        report_error(log, "%s has %ux%u pixels, not %ux%u; render all at one --size", name, own[0],
                     own[1], size[0], size[1]);
    size_t count = (size_t)own[0] * own[1];
    good = good && fwrite(own, sizeof own, 1, stream) == 1 &&
           fwrite(rgba, 4 * sizeof *rgba, count, stream) == count;
    memcpy(size, own, sizeof own);
    free(rgba);
    return good;
}

/* After a failure: a picture without a size, and the errors as JSON. */
static _Noreturn void send_all(struct console *console, int to,
                               bool (*send)(FILE *stream, void *user), void *user)
{
    const uint32_t none[2] = {0};
    FILE *stream = fdopen(to, "w");
    console->kept = (struct text){0};
    bool good = stream && send(stream, user);
    if (stream && !good) {
        fwrite(none, sizeof none, 1, stream);
        fprintf(stream, "[%s]", console->kept.data ? console->kept.data : "");
    }
    if (stream)
        fclose(stream);
    _exit(good ? EXIT_FINE : EXIT_FAILED);
}

int hand_over_stream(struct console *console, const char *verb, cJSON *request,
                     bool (*send)(FILE *stream, void *user), void *user)
{
    int ends[2];
    pid_t child = pipe(ends) == 0 ? console_fork(console) : -1;
    if (child == 0) {
        close(ends[0]);
        send_all(console, ends[1], send, user);
    }
    if (child < 0) {
        report_error(&console->log, "a child process cannot be started: %s", strerror(errno));
        cJSON_Delete(request);
        return EXIT_FAILED;
    }
    close(ends[1]);
    char *path = format_string("/dev/fd/%d", ends[0]);
    cJSON_AddStringToObject(request, "stream", path ? path : "");
    free(path);
    return python_verb(console, verb, request);
}
