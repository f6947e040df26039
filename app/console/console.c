/* Log lines, progress and signals; see console.h. A thread takes signals with sigtimedwait: there
 * is no signal handler, and the clean-up may call any function. */
#include "console/console.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files.h"
#include "base/printable.h"

enum { TICK_NS = 200000000, PROGRESS_AFTER_S = 2 };

/* A file in memory for messages of this thread; -1: they are printed. */
static _Thread_local int capture = -1;

static void clear_line(struct console *console)
{
    if (console->shown)
        fputs("\r\033[K", stderr);
    console->shown = false;
}

/* Prints diagnostics, which are for --json, too. */
static void take_diag(struct diag_taker *taker, const struct diag *diag)
{
    struct console *console = (struct console *)taker;
    unsigned errors = diag_error_count(diag);
    char *text = diag_text(diag, "diptych");
    atomic_fetch_add(&console->errors, errors);
    if (console->attached) {
        report_message(&console->host, errors ? DT_ERROR : DT_WARNING, "%s",
                       text ? text : "out of memory");
    } else if (capture >= 0) {
        dprintf(capture, "%s\n", text ? text : "out of memory");
    } else {
        pthread_mutex_lock(&console->lock);
        clear_line(console);
        fprintf(stderr, "%s\n", text ? text : "out of memory");
        if (console->keeps)
            diag_json(diag, &console->kept);
        pthread_mutex_unlock(&console->lock);
    }
    free(text);
}

static void print_log_message(struct diag_taker *taker, enum dt_level level, const char *message)
{
    static const char *const labels[] = {"debug: ", "", "warning: ", "error: "};
    struct console *console = (struct console *)taker;
    atomic_fetch_add(&console->errors, level == DT_ERROR);
    if (console->attached) {
        report_message(&console->host, level, "%s", message);
    } else if (level <= DT_INFO && console->quiet) {
        return;
    } else if (capture >= 0) {
        dprintf(capture, "%s%s\n", labels[level], message);
    } else {
        pthread_mutex_lock(&console->lock);
        clear_line(console);
        fprintf(stderr, "diptych: %s%s\n", labels[level], message);
        if (console->keeps && level >= DT_WARNING)
            diag_json_text(level == DT_ERROR, message, &console->kept);
        pthread_mutex_unlock(&console->lock);
    }
}

static void take_message(struct diag_taker *taker, enum dt_level level, const char *message)
{
    char *text = text_is_printable(message) ? NULL : text_printable(message);
    print_log_message(taker, level, text ? text : message);
    free(text);
}

void console_capture(void)
{
    capture = memfd_create("messages", MFD_CLOEXEC);
}

char *console_captured(void)
{
    int file = capture;
    char *text = file < 0 ? NULL : file_contents(file);
    if (file >= 0)
        close(file);
    capture = -1;
    return text;
}

int console_capturing(void)
{
    return capture;
}

void console_capture_too(int file)
{
    capture = file;
}

static void show_progress(struct console *console)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    long elapsed = (long)(now.tv_sec - console->start.tv_sec);
    pthread_mutex_lock(&console->lock);
    if (elapsed >= PROGRESS_AFTER_S && console->status[0]) {
        fprintf(stderr, "\r\033[K[%ld s] %s", elapsed, console->status);
        console->shown = true;
    }
    pthread_mutex_unlock(&console->lock);
}

/* Ends the child's group and waits for the child: until then it may write temporaries. It is not
 * reaped, so that its process number stays reserved. */
static void end_child(pid_t child)
{
    siginfo_t info;
    kill(-child, SIGTERM);
    while (waitid(P_PID, (id_t)child, &info, WEXITED | WNOWAIT) < 0 && errno == EINTR)
        continue;
}

static _Noreturn void end_by_signal(struct console *console, int signal)
{
    pthread_mutex_lock(&console->writing); /* never released: no other write may start */
    pthread_mutex_lock(&console->lock);
    clear_line(console);
    for (int i = 0; i < CONSOLE_CHILDREN; i++)
        if (console->children[i])
            end_child(console->children[i]);
    for (int i = 0; i < CONSOLE_TEMPORARIES; i++) {
        /* another thread or a child's child may still put a file there: try again for a moment */
        for (int attempt = 0; console->temporaries[i] && attempt < 20; attempt++) {
            if (file_remove_tree(console->temporaries[i]))
                break;
            nanosleep(&(struct timespec){.tv_nsec = TICK_NS / 20}, NULL);
        }
    }
    fprintf(stderr, "diptych: interrupted, nothing half-written is left\n");
    _exit(128 + signal);
}

static sigset_t watched_signals(void)
{
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGHUP);
    return set;
}

static void *watch(void *user)
{
    struct console *console = user;
    sigset_t set = watched_signals();
    while (!atomic_load(&console->done)) {
        int signal = sigtimedwait(&set, NULL, &(struct timespec){.tv_nsec = TICK_NS});
        if (signal > 0 && !atomic_load(&console->done))
            end_by_signal(console, signal);
        if (signal < 0 && errno == EAGAIN && console->terminal)
            show_progress(console);
    }
    return NULL;
}

static void console_prepare(struct console *console)
{
    console->taker = (struct diag_taker){take_message, take_diag};
    console->log = (struct dt_log){.message = diag_log_message, .user = &console->taker};
    pthread_mutex_init(&console->lock, NULL);
    pthread_mutex_init(&console->writing, NULL);
    clock_gettime(CLOCK_MONOTONIC, &console->start);
}

void console_attach(struct console *console, const struct dt_log *host)
{
    *console = (struct console){.attached = true, .host = *host};
    console_prepare(console);
}

bool console_open(struct console *console)
{
    *console = (struct console){.terminal = isatty(STDERR_FILENO),
                                .quiet = getenv("DIPTYCH_QUIET") != NULL};
    console_prepare(console);
    sigset_t set = watched_signals();
    int error = pthread_sigmask(SIG_BLOCK, &set, NULL);
    if (!error)
        error = pthread_create(&console->watcher, NULL, watch, console);
    if (error)
        return report_error(&console->log, "cannot start the thread that waits for signals: %s",
                            strerror(error));
    console->watching = true;
    return true;
}

void console_close(struct console *console)
{
    atomic_store(&console->done, true);
    if (console->watching) {
        pthread_kill(console->watcher, SIGHUP); /* ends the wait at once; the thread sees `done` */
        pthread_join(console->watcher, NULL);
    }
    pthread_mutex_lock(&console->lock);
    clear_line(console);
    for (int i = 0; i < CONSOLE_TEMPORARIES; i++)
        free(console->temporaries[i]);
    text_free(&console->kept);
    pthread_mutex_unlock(&console->lock);
    pthread_mutex_destroy(&console->lock);
    pthread_mutex_destroy(&console->writing);
}

void console_duration(double seconds, char *text, size_t size)
{
    unsigned long whole = (unsigned long)fmin(ceil(seconds), 1e9);
    if (whole < 100)
        snprintf(text, size, "%lu s", whole);
    else if (whole < 6000)
        snprintf(text, size, "%lu min", (whole + 30) / 60);
    else
        snprintf(text, size, "%lu h %lu min", whole / 3600, whole % 3600 / 60);
}

void console_status(struct console *console, const char *format, ...)
{
    pthread_mutex_lock(&console->lock);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(console->status, sizeof console->status, format, arguments);
    va_end(arguments);
    pthread_mutex_unlock(&console->lock);
}

void console_temporary(struct console *console, const char *path)
{
    pthread_mutex_lock(&console->lock);
    for (int i = 0; i < CONSOLE_TEMPORARIES; i++) {
        if (!console->temporaries[i]) {
            console->temporaries[i] = strdup(path);
            break;
        }
    }
    pthread_mutex_unlock(&console->lock);
}

void console_forget(struct console *console, const char *path)
{
    pthread_mutex_lock(&console->lock);
    for (int i = 0; i < CONSOLE_TEMPORARIES; i++) {
        if (console->temporaries[i] && strcmp(console->temporaries[i], path) == 0) {
            free(console->temporaries[i]);
            console->temporaries[i] = NULL;
        }
    }
    pthread_mutex_unlock(&console->lock);
}

/* Puts `now` where `was` stands. With the lock. */
static void exchange_child(struct console *console, pid_t was, pid_t now)
{
    for (int i = 0; i < CONSOLE_CHILDREN; i++) {
        if (console->children[i] == was) {
            console->children[i] = now;
            return;
        }
    }
}

void console_adopt(struct console *console, pid_t child)
{
    pthread_mutex_lock(&console->lock);
    exchange_child(console, 0, child);
    pthread_mutex_unlock(&console->lock);
}

int console_wait(struct console *console, pid_t child)
{
    siginfo_t info;
    int status = 0;
    while (waitid(P_PID, (id_t)child, &info, WEXITED | WNOWAIT) < 0 && errno == EINTR)
        continue;
    pthread_mutex_lock(&console->lock);
    exchange_child(console, child, 0);
    pid_t reaped = waitpid(child, &status, 0);
    pthread_mutex_unlock(&console->lock);
    return reaped < 0 ? -1 : status;
}

static void become_child(struct console *console, pid_t parent)
{
    console->watching = false;
    memset(console->temporaries, 0, sizeof console->temporaries);
    sigset_t set = watched_signals();
    signal(SIGINT, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    pthread_sigmask(SIG_UNBLOCK, &set, NULL);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) /* the parent ended before prctl took effect */
        _exit(EXIT_FAILED);
}

/* The watcher must not hold a lock at this moment: the child would wait for it for ever. */
pid_t console_fork(struct console *console)
{
    pid_t parent = getpid();
    pthread_mutex_lock(&console->writing);
    pthread_mutex_lock(&console->lock);
    fflush(stdout); /* else parent and child would both write the buffered output */
    pid_t child = fork();
    if (child == 0)
        become_child(console, parent);
    pthread_mutex_unlock(&console->lock);
    pthread_mutex_unlock(&console->writing);
    return child;
}

double milliseconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

void console_hold(struct console *console)
{
    pthread_mutex_lock(&console->writing);
}

void console_release(struct console *console)
{
    pthread_mutex_unlock(&console->writing);
}
