/* See confine.h. */
#include "compare/confine.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files.h"
#include "base/limit.h"
#include "console/tool.h"

extern char **environ;

enum { MOST_WORDS = 400 };

/* Of a replay: memory, and processor time of all its threads together. */
enum { REPLAY_GIBIBYTES = 16, REPLAY_SECONDS = 1800 };

struct command {
    char *words[MOST_WORDS]; /* owned */
    unsigned count;
    bool failed;
};

static void add_argument(struct command *command, const char *word)
{
    char *copy = command->count + 1 < MOST_WORDS ? strdup(word) : NULL;
    command->failed |= !copy;
    if (copy)
        command->words[command->count++] = copy;
}

static void add_pair(struct command *command, const char *option, const char *value)
{
    if (!value)
        return;
    add_argument(command, option);
    add_argument(command, value);
}

/* A file or folder to read, where it is; those that are not there are left out. */
static void add_path(struct command *command, const char *path)
{
    add_argument(command, "--ro-bind-try");
    add_argument(command, path);
    add_argument(command, path);
}

static void free_command(struct command *command)
{
    for (unsigned i = 0; i < command->count; i++)
        free(command->words[i]);
}

/* ---- What is there --------------------------------------------------------------------------- */

/* Of files that a variable lists, such as VK_DRIVER_FILES: their folders. */
static void add_listed(struct command *command, const char *variable)
{
    const char *value = getenv(variable);
    char *copy = strdup(value ? value : ""), *rest = copy;
    for (char *file; rest && (file = strsep(&rest, ":"));) {
        char *real = *file ? realpath(file, NULL) : NULL, *slash = real ? strrchr(real, '/') : NULL;
        if (slash && slash > real) {
            *slash = 0;
            add_path(command, real);
        }
        free(real);
    }
    free(copy);
}

/* What drivers of OpenGL and Vulkan read. */
static void add_drivers(struct command *command)
{
    static const char *const paths[] = {"/usr",
                                        "/lib",
                                        "/lib64",
                                        "/bin",
                                        "/etc/vulkan",
                                        "/etc/glvnd",
                                        "/sys",
                                        "/etc/ld.so.cache",
                                        "/etc/drirc",
                                        "/opt",
                                        "/etc/alternatives"};
    static const char *const devices[] = {"/dev/dri",        "/dev/kfd",
                                          "/dev/nvidia0",    "/dev/nvidiactl",
                                          "/dev/nvidia-uvm", "/dev/nvidia-modeset"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(paths); i++)
        add_path(command, paths[i]);
    add_pair(command, "--proc", "/proc");
    add_pair(command, "--dev", "/dev");
    add_pair(command, "--tmpfs", "/tmp");
    for (size_t i = 0; i < DT_ARRAY_COUNT(devices); i++) {
        add_argument(command, "--dev-bind-try");
        add_argument(command, devices[i]);
        add_argument(command, devices[i]);
    }
    add_listed(command, "VK_DRIVER_FILES");
    add_listed(command, "VK_ICD_FILENAMES");
}

static void add_environment(struct command *command)
{
    static const char *const kept[] = {"MESA_", "LIBGL_",   "GALLIUM_", "LP_",  "VK_",
                                       "LVP_",  "DIPTYCH_", "LC_",      "LANG", "ASAN_"};
    add_argument(command, "--clearenv");
    add_argument(command, "--setenv");
    add_pair(command, "HOME", "/tmp");
    for (char **variable = environ; *variable; variable++) {
        const char *equals = strchr(*variable, '=');
        bool keep = false;
        for (size_t i = 0; i < DT_ARRAY_COUNT(kept); i++)
            keep |= strncmp(*variable, kept[i], strlen(kept[i])) == 0;
        char *name = keep && equals ? strndup(*variable, (size_t)(equals - *variable)) : NULL;
        if (name) {
            add_argument(command, "--setenv");
            add_pair(command, name, equals + 1);
        }
        free(name);
    }
}

/* diptych itself, its templates, and the folder. */
static void add_own(struct command *command, const char *folder, const struct dt_log *log)
{
    char *tools = tools_folder(log), *templates = templates_folder(log);
    char *real = realpath(folder, NULL), *here = getcwd(NULL, 0);
    command->failed |= !tools || !templates || !real || !here;
    if (!command->failed) {
        add_path(command, tools);
        add_path(command, templates);
        add_path(command, real);
        add_pair(command, "--dir", here);
        add_pair(command, "--chdir", here);
    }
    free(tools);
    free(templates);
    free(real);
    free(here);
}

/* ---- The run --------------------------------------------------------------------------------- */

static void add_sandbox(struct command *command, const char *folder, const struct dt_log *log)
{
    add_argument(command, "bwrap");
    add_argument(command, "--unshare-all");
    add_argument(command, "--die-with-parent");
    add_drivers(command);
    add_environment(command);
    add_own(command, folder, log);
}

static void add_replay(struct command *command, const struct options *options, int result)
{
    char *self = realpath("/proc/self/exe", NULL);
    char *json = result >= 0 ? format_string("--json=/proc/self/fd/%d", result) : NULL;
    char *sanitize =
        options->setup.sanitize ? format_string("--sanitize=%s", options->setup.sanitize) : NULL;
    command->failed |= !self || (result >= 0 && !json) || (options->setup.sanitize && !sanitize);
    add_argument(command, self ? self : "");
    add_argument(command, "replay");
    add_argument(command, options->folder);
    add_argument(command, "--trust");
    add_pair(command, "--backend", options->setup.backend);
    add_pair(command, "--device", options->setup.device);
    add_pair(command, "--context", options->setup.context);
    if (options->setup.glsl)
        add_argument(command, "--glsl");
    if (options->setup.debug)
        add_argument(command, "--debug");
    if (options->setup.sanitize && !*options->setup.sanitize)
        add_argument(command, "--sanitize");
    else if (sanitize)
        add_argument(command, sanitize);
    if (json)
        add_argument(command, json);
    free(sanitize);
    free(json);
    free(self);
}

/* Whether the kernel lets us. */
static bool works(struct console *console)
{
    struct command command = {0};
    const char *const words[] = {"bwrap",  "--unshare-all", "--ro-bind", "/",    "/",
                                 "--proc", "/proc",         "--dev",     "/dev", "/bin/true"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
        add_argument(&command, words[i]);
    bool good = !command.failed && tool_quiet(command.words, console);
    free_command(&command);
    return good;
}

/* Of this process and of those that it starts, in a sandbox or not. */
static void limit_replay(void)
{
    struct rlimit limit;
    limit_memory(REPLAY_GIBIBYTES);
    if (getrlimit(RLIMIT_CPU, &limit) == 0 && limit.rlim_cur > REPLAY_SECONDS) {
        limit.rlim_cur = REPLAY_SECONDS;
        setrlimit(RLIMIT_CPU, &limit);
    }
}

static bool run_confined(struct console *console, const struct options *options, int *status)
{
    struct command command = {0};
    int result = options->json ? memfd_create("result", 0) : -1;
    add_sandbox(&command, options->folder, &console->log);
    add_replay(&command, options, result);
    *status = EXIT_USAGE;
    if (command.failed || (options->json && result < 0))
        report_error(&console->log, "out of memory");
    else
        *status = tool_status(command.words, console);
    free_command(&command);
    char *text = result >= 0 ? file_contents(result) : NULL;
    if (options->json && (!text || !file_write(options->json, text, strlen(text), &console->log)))
        *status = EXIT_USAGE;
    free(text);
    if (result >= 0)
        close(result);
    return true;
}

bool confine_replay(struct console *console, const struct options *options, int *status)
{
    struct stat info;
    limit_replay();
    if (options->trust || stat(options->folder, &info) != 0)
        return false;
    if (tool_is_there("bwrap") && works(console))
        return run_confined(console, options, status);
    report_message(&console->log, DT_WARNING,
                   "%s: its shaders run without a sandbox: %s; --trust says that they may",
                   options->folder,
                   tool_is_there("bwrap") ? "the kernel allows bubblewrap none"
                                          : "bubblewrap is not installed");
    return false;
}
