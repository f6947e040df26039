/* A forked child with limits, its messages and its result; see child.h. */
#include "child.h"

#include "base/diag.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* Memory that parent and child share. */
struct shared {
    char path[4096];  /* that the child opened last */
    unsigned seconds; /* of processor time that it may take */
};
static _Thread_local struct shared *shared_with_parent; /* set in the child alone */

void child_opens(const char *path)
{
    if (shared_with_parent)
        snprintf(shared_with_parent->path, sizeof shared_with_parent->path, "%s", path);
}

void child_limit_memory(size_t bytes)
{
#ifndef __SANITIZE_ADDRESS__
    FILE *file = shared_with_parent ? fopen("/proc/self/statm", "r") : NULL;
    struct rlimit limit;
    unsigned long pages = 0;
    if (file && fscanf(file, "%lu", &pages) == 1 && getrlimit(RLIMIT_AS, &limit) == 0) {
        rlim_t all = pages * (rlim_t)sysconf(_SC_PAGESIZE) + (bytes ? bytes : CHILD_BYTES);
        limit.rlim_cur = all < limit.rlim_max ? all : limit.rlim_max;
        setrlimit(RLIMIT_AS, &limit);
    }
    if (file)
        fclose(file);
#else
    (void)bytes;
#endif
}

void child_limit_time(unsigned seconds)
{
    struct rlimit limit;
    struct rusage used;
    if (!shared_with_parent || getrusage(RUSAGE_SELF, &used) != 0 ||
        getrlimit(RLIMIT_CPU, &limit) != 0)
        return;
    shared_with_parent->seconds = seconds ? seconds : CHILD_SECONDS;
    rlim_t all = (rlim_t)used.ru_utime.tv_sec + (rlim_t)used.ru_stime.tv_sec + 1 +
                 shared_with_parent->seconds;
    limit.rlim_cur = all < limit.rlim_max ? all : limit.rlim_max;
    setrlimit(RLIMIT_CPU, &limit);
}

/* ---- Messages: level and text, as many as there are ------------------------------------------ */

enum { PLACED = 'z' }; /* in place of a level: line, column, length and path, then the text */

struct sender {
    struct diag_taker taker;
    FILE *messages;
};

static void send_message(struct diag_taker *taker, enum dt_level level, const char *message)
{
    FILE *messages = ((struct sender *)taker)->messages;
    fprintf(messages, "%c%s%c", 'a' + (int)level, message, '\0');
    fflush(messages); /* a crash must not lose it */
}

/* An error that has a place: the work reports one at a time. */
static void send_diag(struct diag_taker *taker, const struct diag *diag)
{
    FILE *messages = ((struct sender *)taker)->messages;
    struct loc loc = {0};
    const char *text = diag_first_error(diag, &loc);
    fprintf(messages, "%c%d:%d:%d:%s%c%s%c", PLACED, loc.line, loc.column, loc.length,
            loc.source ? loc.source->path : "", '\0', text ? text : "", '\0');
    fflush(messages);
}

static void pass_placed_on(FILE *messages, char **text, size_t *capacity, const struct dt_log *log)
{
    struct loc loc;
    int path = 0;
    char *place = strdup(*text);
    struct source source = {0};
    if (place && sscanf(place, "%*c%d:%d:%d:%n", &loc.line, &loc.column, &loc.length, &path) == 3 &&
        getdelim(text, capacity, '\0', messages) > 0) {
        source.path = place + path;
        loc.source = &source;
        report_at(log, loc, "%s", *text);
    }
    free(place);
}

static void pass_messages_on(FILE *messages, const struct dt_log *log)
{
    char *text = NULL;
    size_t capacity = 0;
    rewind(messages);
    while (getdelim(&text, &capacity, '\0', messages) > 1)
        if (*text == PLACED)
            pass_placed_on(messages, &text, &capacity, log);
        else if (*text >= 'a' && *text <= 'a' + (int)DT_ERROR)
            report_message(log, (enum dt_level)(*text - 'a'), "%s", text + 1);
    if (!feof(messages))
        report_error(log, "the messages of a child process: %s", strerror(errno));
    free(text);
}

/* ---- The child ------------------------------------------------------------------------------- */

/* The caller's own limit may be lower; nobody raises it. */
static bool limit_processor_time(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_CPU, &limit) != 0)
        return false;
    if (limit.rlim_max > CHILD_SECONDS + 1)
        limit.rlim_max = CHILD_SECONDS + 1;
    if (limit.rlim_cur > CHILD_SECONDS)
        limit.rlim_cur = CHILD_SECONDS;
    return setrlimit(RLIMIT_CPU, &limit) == 0;
}

static _Noreturn void run_work(child_work *work, void *user, FILE *result, FILE *messages,
                               struct shared *shared)
{
    const struct rlimit no_core = {0};
    struct sender sender = {{send_message, send_diag}, messages};
    const struct dt_log log = {.message = diag_log_message, .user = &sender};
    shared_with_parent = shared;
    bool good = prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && limit_processor_time() &&
                setrlimit(RLIMIT_CORE, &no_core) == 0;
    if (!good)
        report_error(&log, "a child process cannot be limited: %s", strerror(errno));
    child_limit_memory(0);
    child_limit_time(0);
    good = good && work(result, user, &log);
    if (good && (fflush(result) != 0 || ferror(result))) {
        report_error(&log, "the result of a child process: %s", strerror(errno));
        good = false;
    }
    _exit(good ? EXIT_SUCCESS : EXIT_FAILURE);
}

/* ---- The parent ------------------------------------------------------------------------------ */

static FILE *open_memory(const char *name)
{
    int file = memfd_create(name, MFD_CLOEXEC);
    FILE *stream = file < 0 ? NULL : fdopen(file, "w+");
    if (file >= 0 && !stream)
        close(file);
    return stream;
}

static bool wait_for(pid_t child, int *status)
{
    while (waitpid(child, status, 0) < 0)
        if (errno != EINTR)
            return false;
    return true;
}

/* Whether the child ended well; logs what ended it if that was a signal. */
static bool judge_child(int status, const struct shared *shared, const struct dt_log *log)
{
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        report_error(log, "%s: reading it takes more than %u s of processor time", shared->path,
                     shared->seconds);
    else if (WIFSIGNALED(status))
        report_error(
            log,
            "%s: the library that reads this file crashed (%s); the file is damaged, or nested "
            "too deeply",
            shared->path, strsignal(WTERMSIG(status)));
    return WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS;
}

static bool run_apart(child_work *work, void *user, FILE *result, FILE *messages,
                      struct shared *shared, const struct dt_log *log)
{
    int status = 0;
    fflush(NULL); /* else the child's copy of a buffer could be written, too */
    pid_t child = fork();
    if (child == 0)
        run_work(work, user, result, messages, shared);
    if (child < 0 || !wait_for(child, &status))
        return report_error(log, "a child process cannot be started: %s", strerror(errno));
    pass_messages_on(messages, log);
    return judge_child(status, shared, log);
}

FILE *child_run(child_work *work, void *user, const struct dt_log *log)
{
    FILE *result = open_memory("result"), *messages = open_memory("messages");
    struct shared *shared =
        mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    bool good = false;
    if (result && messages && shared != MAP_FAILED)
        good = run_apart(work, user, result, messages, shared, log);
    else
        report_error(log, "memory for a child process: %s", strerror(errno));
    if (shared != MAP_FAILED)
        munmap(shared, sizeof *shared);
    if (messages)
        fclose(messages);
    if (good) {
        rewind(result);
        return result;
    }
    if (result)
        fclose(result);
    return NULL;
}
