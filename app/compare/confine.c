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

/* Of a replay: memory, and processor time of all its threads together. */
enum { REPLAY_GIBIBYTES = 16, REPLAY_SECONDS = 1800 };

/* A file or folder to read, where it is; those that are not there are left out. */
static void add_path(struct words *words, const char *path)
{
    words_add(words, "--ro-bind-try");
    words_add(words, path);
    words_add(words, path);
}

/* ---- What is there --------------------------------------------------------------------------- */

/* Of files that a variable lists, such as VK_DRIVER_FILES: their folders. */
static void add_listed(struct words *words, const char *variable)
{
    const char *value = getenv(variable);
    char *copy = strdup(value ? value : ""), *rest = copy;
    for (char *file; rest && (file = strsep(&rest, ":"));) {
        char *real = *file ? realpath(file, NULL) : NULL, *slash = real ? strrchr(real, '/') : NULL;
        if (slash && slash > real) {
            *slash = 0;
            add_path(words, real);
        }
        free(real);
    }
    free(copy);
}

/* What drivers of OpenGL and Vulkan read. */
static void add_drivers(struct words *words)
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
        add_path(words, paths[i]);
    words_pair(words, "--proc", "/proc");
    words_pair(words, "--dev", "/dev");
    words_pair(words, "--tmpfs", "/tmp");
    for (size_t i = 0; i < DT_ARRAY_COUNT(devices); i++) {
        words_add(words, "--dev-bind-try");
        words_add(words, devices[i]);
        words_add(words, devices[i]);
    }
    add_listed(words, "VK_DRIVER_FILES");
    add_listed(words, "VK_ICD_FILENAMES");
}

static void add_environment(struct words *words)
{
    static const char *const kept[] = {"MESA_", "LIBGL_",   "GALLIUM_", "LP_",  "VK_",
                                       "LVP_",  "DIPTYCH_", "LC_",      "LANG", "ASAN_"};
    words_add(words, "--clearenv");
    words_add(words, "--setenv");
    words_pair(words, "HOME", "/tmp");
    for (char **variable = environ; *variable; variable++) {
        const char *equals = strchr(*variable, '=');
        bool keep = false;
        for (size_t i = 0; i < DT_ARRAY_COUNT(kept); i++)
            keep |= strncmp(*variable, kept[i], strlen(kept[i])) == 0;
        char *name = keep && equals ? strndup(*variable, (size_t)(equals - *variable)) : NULL;
        if (name) {
            words_add(words, "--setenv");
            words_pair(words, name, equals + 1);
        }
        free(name);
    }
}

/* diptych itself, its templates, and the folder. */
static void add_own(struct words *words, const char *folder, const struct dt_log *log)
{
    char *tools = tools_folder(log), *templates = templates_folder(log);
    char *real = realpath(folder, NULL), *here = getcwd(NULL, 0);
    words->failed |= !tools || !templates || !real || !here;
    if (!words->failed) {
        add_path(words, tools);
        add_path(words, templates);
        add_path(words, real);
        words_pair(words, "--dir", here);
        words_pair(words, "--chdir", here);
    }
    free(tools);
    free(templates);
    free(real);
    free(here);
}

/* ---- The run --------------------------------------------------------------------------------- */

static void add_sandbox(struct words *words, const char *folder, const struct dt_log *log)
{
    words_add(words, "bwrap");
    words_add(words, "--unshare-all");
    words_add(words, "--die-with-parent");
    add_drivers(words);
    add_environment(words);
    add_own(words, folder, log);
}

static void add_replay(struct words *words, const struct options *options, int result)
{
    char *self = realpath("/proc/self/exe", NULL);
    char *json = result >= 0 ? format_string("--json=/proc/self/fd/%d", result) : NULL;
    char *sanitize =
        options->setup.sanitize ? format_string("--sanitize=%s", options->setup.sanitize) : NULL;
    words->failed |= !self || (result >= 0 && !json) || (options->setup.sanitize && !sanitize);
    words_add(words, self ? self : "");
    words_add(words, "replay");
    words_add(words, options->folder);
    words_add(words, "--trust");
    words_pair(words, "--backend", options->setup.backend);
    words_pair(words, "--device", options->setup.device);
    words_pair(words, "--context", options->setup.context);
    if (options->setup.glsl)
        words_add(words, "--glsl");
    if (options->setup.debug)
        words_add(words, "--debug");
    if (options->setup.sanitize && !*options->setup.sanitize)
        words_add(words, "--sanitize");
    else if (sanitize)
        words_add(words, sanitize);
    if (json)
        words_add(words, json);
    free(sanitize);
    free(json);
    free(self);
}

/* Whether the kernel lets us. */
static bool works(struct console *console)
{
    static const char *const line[] = {"bwrap", "--unshare-all", "--ro-bind", "/",
                                       "/",     "--proc",        "/proc",     "--dev",
                                       "/dev",  "/bin/true",     NULL};
    return tool_quiet((char *const *)line, console);
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
    struct words words = {0};
    int result = options->json ? memfd_create("result", 0) : -1;
    add_sandbox(&words, options->folder, &console->log);
    add_replay(&words, options, result);
    *status = EXIT_USAGE;
    if (words.failed || (options->json && result < 0))
        report_error(&console->log, "out of memory");
    else
        *status = tool_status(words.list, console);
    words_free(&words);
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
