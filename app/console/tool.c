/* Child processes; see tool.h. */
#include "console/tool.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/limit.h"

enum { TOOL_GIBIBYTES = 16 }; /* of memory, of each process */

/* Descriptors of a child: `input` for its stdin, -1: ours; `output` for its stdout, -1: /dev/null;
 * `errors` for its stderr, -1: ours. */
struct streams {
    int input, output, errors;
};

/* In the child, between fork and exec; returns after an error, with errno. The child leads a process
 * group, so that console_wait can end it with its own children, has no signals blocked, and gets
 * SIGTERM when this process is killed. */
static void become(char *const argv[], const struct streams *streams, pid_t parent)
{
    sigset_t none;
    sigemptyset(&none);
    int output = streams->output >= 0 ? streams->output : open("/dev/null", O_WRONLY | O_CLOEXEC);
    bool good = prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 && setpgid(0, 0) == 0 && output >= 0 &&
                limit_memory(TOOL_GIBIBYTES) && dup2(output, STDOUT_FILENO) >= 0 &&
                (streams->input < 0 || dup2(streams->input, STDIN_FILENO) >= 0) &&
                (streams->errors < 0 || dup2(streams->errors, STDERR_FILENO) >= 0) &&
                sigprocmask(SIG_SETMASK, &none, NULL) == 0;
    if (getppid() != parent)
        _exit(EXIT_FAILURE); /* it was killed before prctl took effect */
    if (good)
        execvp(argv[0], argv);
}

/* Starts a child. Returns 0 or an errno. */
static int start_child(pid_t *child, char *const argv[], const struct streams *streams)
{
    int report[2], error = 0;
    pid_t parent = getpid();
    if (pipe2(report, O_CLOEXEC) != 0)
        return errno;
    *child = fork();
    if (*child == 0) {
        become(argv, streams, parent);
        error = errno;
        (void)!write(report[1], &error, sizeof error);
        _exit(EXIT_FAILURE);
    }
    error = *child < 0 ? errno : 0;
    close(report[1]);
    ssize_t got = 0;
    do /* exec closes the pipe */
        got = read(report[0], &error, sizeof error);
    while (got < 0 && errno == EINTR);
    if (*child > 0 && got > 0)
        waitpid(*child, NULL, 0);
    close(report[0]);
    return error;
}

static bool judge_tool(int status, const struct tool *tool, const char *name,
                       const struct dt_log *log)
{
    if (status < 0)
        return report_error(log, "%s: cannot be waited for: %s", name, strerror(errno));
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return true;
    if (WIFSIGNALED(status))
        report_error(log, "%s was ended by signal %d", tool->what, WTERMSIG(status));
    else if (!tool->explains)
        report_error(log, "%s failed with exit status %d; see its messages above", tool->what,
                     WEXITSTATUS(status));
    return false;
}

bool tool_run(const struct tool *tool, char *const argv[], int output, struct console *console)
{
    const struct streams streams = {-1, output, console_capturing()};
    pid_t child = -1;
    int error = start_child(&child, argv, &streams);
    if (error)
        return report_error(&console->log, "%s: cannot be started: %s; %s", argv[0],
                            strerror(error), tool->hint);
    console_adopt(console, child);
    return judge_tool(console_wait(console, child), tool, argv[0], &console->log);
}

int tool_status(char *const argv[], struct console *console)
{
    const struct streams streams = {-1, STDOUT_FILENO, -1};
    pid_t child = -1;
    int error = start_child(&child, argv, &streams), status = -1;
    if (!error) {
        console_adopt(console, child);
        status = console_wait(console, child);
    }
    if (!error && status >= 0 && WIFEXITED(status))
        return WEXITSTATUS(status);
    if (!error && status >= 0)
        report_error(&console->log, "%s was ended by signal %d", argv[0], WTERMSIG(status));
    else
        report_error(&console->log, "%s: cannot be started: %s", argv[0], strerror(error));
    return -1;
}

void words_add(struct words *words, const char *word)
{
    words->failed =
        words->failed || words->count == TOOL_WORDS || !(words->list[words->count] = strdup(word));
    words->count += !words->failed;
}

void words_pair(struct words *words, const char *option, const char *value)
{
    if (!value)
        return;
    words_add(words, option);
    words_add(words, value);
}

void words_free(struct words *words)
{
    for (uint32_t i = 0; i < words->count; i++)
        free(words->list[i]);
}
