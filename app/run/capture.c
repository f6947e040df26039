/* RenderDoc's in-application API; see capture.h. */
#include "run/capture.h"

#include <EGL/egl.h>
#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"

/* The start of RENDERDOC_API_1_0_0; renderdoc_app.h promises that later versions keep it. */
struct renderdoc {
    void (*before[11])(void);
    void (*set_path)(const char *stem); /* files are called STEM_capture.rdc, or so */
    void (*get_path)(void);
    uint32_t (*count)(void);
    /* 0: there is no such capture. *length: of the path with its zero; path may be NULL */
    uint32_t (*path_of)(uint32_t index, char *path, uint32_t *length, uint64_t *time);
    void (*between[4])(void);
    void (*start)(void *device, void *window); /* NULL, NULL: the one that is there */
    uint32_t (*is_capturing)(void);
    uint32_t (*end)(void *device, void *window); /* 1: done */
};
enum { RENDERDOC_1_0_0 = 10000 };

static const char library_name[] = "librenderdoc.so";

static const struct renderdoc *find_api(void)
{
    void *library = dlopen(library_name, RTLD_NOW | RTLD_NOLOAD), *api = NULL;
    int (*get)(int version, void **api) = NULL;
    if (library)
        *(void **)&get = dlsym(library, "RENDERDOC_GetAPI");
    return get && get(RENDERDOC_1_0_0, &api) == 1 ? api : NULL;
}

/* ---- Loading --------------------------------------------------------------------------------- */

/* Runs the same command again. Returns when that fails. */
static void start_again(const struct dt_log *log)
{
    size_t size, count = 0;
    char *text = file_read("/proc/self/cmdline", &size, log);
    char **arguments = text ? calloc(size + 1, sizeof *arguments) : NULL;
    for (size_t at = 0; arguments && at < size; at += strlen(text + at) + 1)
        arguments[count++] = text + at;
    if (arguments)
        execv("/proc/self/exe", arguments);
    report_error(log, "--capture: the program cannot be started again: %s", strerror(errno));
    free(arguments);
    free(text);
}

bool capture_load(const struct dt_log *log)
{
    struct link_map *map = NULL;
    if (find_api())
        return true;
    void *library = dlopen(library_name, RTLD_NOW);
    if (!library || dlinfo(library, RTLD_DI_LINKMAP, &map) != 0)
        return report_error(log, "--capture: %s; install RenderDoc (Debian 12: librenderdoc)",
                            dlerror());
    const char *before = getenv("LD_PRELOAD");
    if (before && strstr(before, map->l_name)) { /* it would start again for ever */
        report_error(log, "--capture: %s is loaded, but has no API of version 1.0", map->l_name);
        return false;
    }
    char *preload = format_string("%s%s%s", map->l_name, before ? ":" : "", before ? before : "");
    if (preload && setenv("LD_PRELOAD", preload, 1) == 0 &&
        setenv("ENABLE_VULKAN_RENDERDOC_CAPTURE", "1", 1) == 0)
        start_again(log);
    else
        report_error(log, "out of memory");
    free(preload);
    return false;
}

/* ---- The frame ------------------------------------------------------------------------------- */

bool capture_begin(const char *path, const struct dt_log *log)
{
    const struct renderdoc *api = find_api();
    api->set_path(path);
    api->start(NULL, NULL);
    return api->is_capturing() ||
           report_error(log, "--capture: RenderDoc captures no frame of this device; its log in "
                             "/tmp/RenderDoc may say why");
}

/* RenderDoc looks for a window, for a thumbnail; without one it leaves an error of OpenGL. Those of the
 * frame were read after each call. */
static void forget_errors(void)
{
    unsigned (*get_error)(void) =
        eglGetCurrentContext() ? (unsigned (*)(void))eglGetProcAddress("glGetError") : NULL;
    for (int i = 0; i < 8 && get_error && get_error(); i++)
        continue;
}

/* The file of the last capture; NULL: none; free(). */
static char *last_file(const struct renderdoc *api)
{
    uint32_t count = api->count(), length = 0;
    char *file = NULL;
    if (count && api->path_of(count - 1, NULL, &length, NULL))
        file = calloc(length + 1, 1);
    if (file)
        api->path_of(count - 1, file, &length, NULL);
    return file;
}

bool capture_end(const char *path, const struct dt_log *log)
{
    const struct renderdoc *api = find_api();
    char *file = api->end(NULL, NULL) == 1 ? last_file(api) : NULL;
    bool good = file && rename(file, path) == 0;
    forget_errors();
    if (!good)
        report_error(log, "%s: cannot be written: %s", path,
                     file ? strerror(errno) : "RenderDoc has made no file; see /tmp/RenderDoc");
    free(file);
    return good;
}
