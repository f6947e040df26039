/* What came with the executable; see installed.h. */
#include "base/installed.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "base/text.h"

/* The shared library that has this code, which dladdr finds by its path; else the executable. */
static char *own_file(void)
{
    static const char here;
    Dl_info own;
    bool library = dladdr(&here, &own) && strstr(own.dli_fname, ".so");
    return realpath(library ? own.dli_fname : "/proc/self/exe", NULL);
}

char *tools_folder(const struct dt_log *log)
{
    char *path = own_file();
    char *slash = path ? strrchr(path, '/') : NULL;
    if (!slash || slash == path) {
        report_error(log, "the executable's own folder cannot be found: %s", strerror(errno));
        free(path);
        return NULL;
    }
    *slash = 0;
    return path;
}

static bool has_templates(const char *tools, const char *prefix)
{
    char *templates = format_string("%s/%s/share/diptych/templates/glsl", tools, prefix);
    bool found = templates && access(templates, R_OK) == 0;
    free(templates);
    return found;
}

/* How many folders above `tools` the installation's prefix is: 1, or 2 for a library in lib/TRIPLET; 0:
 * not installed. */
static int levels_to_prefix(const char *tools)
{
    const char *slash = strrchr(tools, '/');
    bool deep = slash && slash - tools >= 4 && memcmp(slash - 4, "/lib", 4) == 0;
    return has_templates(tools, "..") ? 1 : deep && has_templates(tools, "../..") ? 2 : 0;
}

/* Finds a folder from beside the tools: its path in the project, or its installed path. */
static char *brought_along(const char *in_project, const char *installed, const struct dt_log *log)
{
    char *path = tools_folder(log);
    if (!path)
        return NULL;
    int levels = levels_to_prefix(path);
    char *beside = format_string("%s/..%s", path, in_project);
    int up = levels ? levels : beside && access(beside, R_OK) == 0 ? 1 : 2; /* of build/asan */
    free(beside);
    for (int i = 0; i < up; i++) {
        char *slash = strrchr(path, '/');
        *(slash == path ? slash + 1 : slash) = 0;
    }
    char *folder = format_string("%s%s", path, levels ? installed : in_project);
    if (!folder)
        report_error(log, "out of memory");
    free(path);
    return folder;
}

bool tools_installed(const char *tools)
{
    return levels_to_prefix(tools) != 0;
}

char *templates_folder(const struct dt_log *log)
{
    return brought_along("/templates", "/share/diptych/templates", log);
}

char *python_folder(const struct dt_log *log)
{
    return brought_along("/app/python", "/lib/python3/dist-packages", log);
}

static bool is_file(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && !S_ISDIR(info.st_mode);
}

char *find_in(const char *path, const char *folder)
{
    bool bare = !strpbrk(path, "./") && !is_file(path);
    char *file = bare && folder ? format_string("%s/%s.yaml", folder, path) : NULL;
    if (!file || access(file, R_OK) != 0) {
        free(file);
        file = strdup(path);
    }
    return file;
}

char *find_spec(const char *path, const struct dt_log *log)
{
    char *folder = templates_folder(log), *file = find_in(path, folder);
    free(folder);
    return file;
}

char *find_scene(const char *path, const struct dt_log *log)
{
    char *folder = brought_along("/scenes", "/share/diptych/scenes", log);
    char *file = find_in(path, folder);
    free(folder);
    return file;
}
