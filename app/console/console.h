/* Log lines and progress on stderr, and the clean-up on SIGINT. main makes one console and hands it
 * to every verb. */
#pragma once

#include <pthread.h>
#include <stdatomic.h>
#include <sys/types.h>
#include <time.h>

#include "base/diag.h"

/* Exit statuses that scripts rely on. Verbs that compare give EXIT_DIFFER, and EXIT_USAGE also when
 * they could not run. */
enum { EXIT_FINE = 0, EXIT_DIFFER = 1, EXIT_FAILED = 1, EXIT_USAGE = 2 };

enum { CONSOLE_TEMPORARIES = 4, CONSOLE_CHILDREN = 64 };

struct console {
    struct diag_taker taker; /* of the log; the first member */
    struct dt_log log;
    bool attached; /* of a library: `host` takes all messages; its message may be NULL */
    struct dt_log host;
    atomic_uint errors; /* DT_ERROR messages so far, from any thread */
    pthread_mutex_t lock;
    pthread_mutex_t writing; /* held around short writes that a signal must not interrupt */
    pthread_t watcher;
    atomic_bool done;
    bool watching;
    int failed;            /* exit status of the verb when it could not run */
    bool terminal;         /* stderr is one: show progress */
    bool quiet;            /* DIPTYCH_QUIET: warnings and errors only */
    bool shown;            /* a progress line stands on the screen */
    struct timespec start; /* when the verb started */
    char status[128];
    char *temporaries[CONSOLE_TEMPORARIES]; /* removed when a signal ends the process */
    /* each leads a process group, which a signal ends, too; 0: none */
    pid_t children[CONSOLE_CHILDREN];
    bool keeps;           /* warnings and errors, for --json */
    struct text kept;     /* elements of a JSON array; see diag_json */
    struct cJSON *result; /* JSON object that the verb returns for --json; main frees it */
};

/* Blocks SIGINT, SIGTERM and SIGHUP in this and all later threads, and starts the thread that waits
 * for them: it lets a write in progress finish, ends the child, removes the temporaries and ends
 * the process with 128 + signal. */
bool console_open(struct console *console);
/* In a library: messages go to `host`. No signals are taken, nothing is printed. */
void console_attach(struct console *console, const struct dt_log *host);
void console_close(struct console *console);

/* Keeps this thread's log messages, and stderr of the tools that it runs, until console_captured,
 * which returns them: free(), NULL when out of memory; then they were printed. */
void console_capture(void);
char *console_captured(void);
int console_capturing(void); /* this thread's capture file, or -1 */
/* This thread's messages go there, too, until it ends. */
void console_capture_too(int file);

/* Sets the progress line, shown with the elapsed time once the verb takes longer than two
 * seconds. */
void console_status(struct console *console, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Rounded for people: "40 s", "12 min", "3 h 20 min". */
void console_duration(double seconds, char *text, size_t size);

/* Registers a file or folder to remove when a signal ends the process; forget it after renaming or
 * removing it. */
void console_temporary(struct console *console, const char *path);
void console_forget(struct console *console, const char *path);

/* Registers a child that leads a process group. A signal that ends this process before console_wait
 * returns also ends the group, before temporaries are removed. At most CONSOLE_CHILDREN. */
void console_adopt(struct console *console, pid_t child);
/* Waits for it; returns the status as waitpid gives it, or -1 with errno. */
int console_wait(struct console *console, pid_t child);

/* Forks. In the child (returns 0) the console has no watcher and no temporaries. It ignores SIGINT
 * and SIGHUP, which a terminal sends to both processes, and gets SIGKILL when the parent ends. -1
 * with errno. */
pid_t console_fork(struct console *console);

double milliseconds_now(void); /* monotonic */

/* Brackets a short write that a signal must not cut in half. */
void console_hold(struct console *console);
void console_release(struct console *console);
