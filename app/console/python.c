/* Starts Python for a verb; see python.h. */
#include "console/python.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "console/tool.h"

/* The request as stdin. */
static bool give_request(const struct console *console, cJSON *request)
{
    char *program = tools_folder(&console->log);
    char *path = program ? format_string("%s/diptych", program) : NULL;
    char *templates = templates_folder(&console->log);
    char *errors = format_string("[%s]", console->kept.data ? console->kept.data : "");
    cJSON_AddStringToObject(request, "program", path ? path : "");
    cJSON_AddStringToObject(request, "templates", templates ? templates : "");
    cJSON_AddStringToObject(request, "version", VERSION);
    cJSON_AddRawToObject(request, "errors", errors ? errors : "[]");
    char *text = cJSON_PrintUnformatted(request);
    int file = memfd_create("request", 0);
    bool good = path && templates && text && file >= 0 &&
                write(file, text, strlen(text)) == (ssize_t)strlen(text) &&
                lseek(file, 0, SEEK_SET) == 0 && dup2(file, STDIN_FILENO) >= 0;
    if (file >= 0)
        close(file);
    cJSON_free(text);
    free(errors);
    free(templates);
    free(path);
    free(program);
    return good;
}

/* Its own package comes first; python3 -m would else take one of the working folder. */
static bool set_path(const struct console *console)
{
    char *folder = python_folder(&console->log);
    const char *users = getenv("PYTHONPATH");
    if (folder && users && !strncmp(users, folder, strlen(folder))) {
        free(folder); /* an earlier child has set it */
        return true;
    }
    char *path =
        folder ? format_string("%s%s%s", folder, users ? ":" : "", users ? users : "") : NULL;
    bool good = path && setenv("PYTHONPATH", path, 1) == 0 && setenv("PYTHONSAFEPATH", "1", 1) == 0;
    free(path);
    free(folder);
    return good;
}

static bool hand_over(struct console *console, const char *verb, cJSON *request)
{
    bool good = give_request(console, request) && set_path(console);
    cJSON_Delete(request);
    return good ||
           report_error(&console->log, "%s: cannot be handed to Python: %s", verb, strerror(errno));
}

bool python_child(struct console *console, const char *verb, const char *what, cJSON *request,
                  int output)
{
    const struct tool tool = {
        .what = what, .hint = "install the package python3", .explains = output >= 0};
    char *const argv[] = {"/usr/bin/python3", "-m", "diptych", (char *)verb, NULL};
    return hand_over(console, verb, request) && tool_run(&tool, argv, output, console);
}

int python_verb(struct console *console, const char *verb, cJSON *request)
{
    sigset_t none;
    sigemptyset(&none);
    /* the whole path: by a bare name Python would find its packages through PATH, in an environment of the user's */
    const char *argv[] = {"/usr/bin/python3", "-m", "diptych", verb, NULL};
    if (!hand_over(console, verb, request))
        return EXIT_USAGE;
    fflush(stdout);
    pthread_sigmask(SIG_SETMASK, &none, NULL); /* console_open blocks some */
    execv(argv[0], (char *const *)argv);
    report_error(&console->log,
                 "%s: /usr/bin/python3 cannot be started: %s; install the package python3", verb,
                 strerror(errno));
    return EXIT_USAGE;
}
