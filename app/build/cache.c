/* Builds pipelines and keeps them; see cache.h. A version's stamp (stamp.h) tells of every file that the
 * generator's and the compiler's depfiles name. */
#include "build/cache.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/files.h"
#include "base/tool.h"
#include "build/cache_prune.h"
#include "build/compile.h"

enum { MOST_BUILDS = 5 }; /* of files that are saved while they are compiled */

/* ---- Child processes ------------------------------------------------------------------------- */

/* Shaders of this spec, whatever is set: an edit, or another --set, compiles what it changes. */
static char *shader_cache(const struct build_request *request, const char *base)
{
    uint64_t key = FILE_HASH_START;
    hash_string(&key, request->spec);
    hash_string(&key, request->templates);
    return format_string("%s/%016" PRIx64 CACHE_SHADERS, base, key);
}

static bool generate(const struct compile_work *work, struct console *console)
{
    static const struct tool generator = {.what = "generating the pipeline",
                                          .hint = "build the project with ninja",
                                          .explains = true};
    const struct build_request *request = work->request;
    char *tool = format_string("%s/diptych-gen", request->tools);
    char *depfile = format_string("%s/gen.d", work->stamp.folder);
    char *shaders = shader_cache(request, work->base);
    char **argv = calloc(request->set_count * 2 + 12, sizeof *argv);
    bool good = false;
    if (tool && depfile && shaders && argv) {
        size_t n = 0;
        argv[n++] = tool;
        argv[n++] = (char *)request->spec;
        argv[n++] = (char *)"-o";
        argv[n++] = (char *)work->stamp.folder;
        argv[n++] = (char *)"--depfile";
        argv[n++] = depfile;
        argv[n++] = (char *)"--shader-cache";
        argv[n++] = shaders;
        argv[n++] = (char *)"--templates";
        argv[n++] = (char *)request->templates;
        if (request->edited)
            argv[n++] = (char *)"--edits";
        for (uint32_t i = 0; i < request->set_count; i++) {
            argv[n++] = (char *)"--set";
            argv[n++] = (char *)request->sets[i];
        }
        good = tool_run_waiting(request->generator, &generator, argv, console);
    } else {
        report_error(&console->log, "out of memory");
    }
    free(argv);
    free(shaders);
    free(depfile);
    free(tool);
    return good;
}

/* The generator names its files after the pipeline: the stem of the one *_gl.c. */
static char *find_name(const char *folder, const struct dt_log *log)
{
    static const char tail[] = "_gl.c";
    char *name = NULL;
    DIR *listing = opendir(folder);
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry && !name;
         entry = readdir(listing)) {
        size_t length = strlen(entry->d_name);
        if (length >= sizeof tail && strcmp(entry->d_name + length - (sizeof tail - 1), tail) == 0)
            name = strndup(entry->d_name, length - (sizeof tail - 1));
    }
    if (listing)
        closedir(listing);
    if (!name)
        report_error(log, "%s: the generator left no *_gl.c there", folder);
    return name;
}

/* ---- Find or build --------------------------------------------------------------------------- */

/* The real path, since depfiles are compared with it. */
static char *usable_folder(char *folder, const struct dt_log *log)
{
    struct stat info;
    bool usable = folder && file_make_folders(folder, log) && access(folder, W_OK) == 0 &&
                  stat(folder, &info) == 0 && S_ISDIR(info.st_mode);
    char *real = usable ? realpath(folder, NULL) : NULL;
    free(folder);
    return real;
}

static void ignore_message(void *user, enum dt_level level, const char *message)
{
    (void)user;
    (void)level;
    (void)message;
}

/* build/cache where that can be written, else the user's own cache folder, as for what is installed. */
static char *cache_folder(const struct build_request *request, const struct dt_log *log)
{
    const struct dt_log silent = {.message = ignore_message};
    bool installed = tools_installed(request->tools);
    char *folder =
        installed ? NULL : usable_folder(format_string("%s/cache", request->tools), &silent);
    const char *base = getenv("XDG_CACHE_HOME");
    const char *home = getenv("HOME");
    if (!folder && base && *base == '/')
        folder = usable_folder(format_string("%s/diptych", base), &silent);
    if (!folder && home)
        folder = usable_folder(format_string("%s/.cache/diptych", home), &silent);
    if (!folder)
        report_error(log, "%s cannot be written; set XDG_CACHE_HOME to a folder that can",
                     installed ? "the user's cache folder" : "build/cache");
    return folder;
}

static bool request_key(const struct build_request *request, uint64_t *key,
                        const struct dt_log *log)
{
    *key = FILE_HASH_START;
    hash_string(key, request->spec);
    hash_string(key, request->templates);
    for (uint32_t i = 0; i < request->set_count; i++)
        hash_string(key, request->sets[i]);
    hash_string(key, request->edited ? "edits" : "");
    hash_string(key, compiler_of(request));
    char *generator = format_string("%s/diptych-gen", request->tools);
    struct stat info; /* ten megabytes take longer to read than all the rest of what is cached */
    bool good = generator && stat(generator, &info) == 0;
    if (good) {
        hash_bytes(key, &info.st_size, sizeof info.st_size);
        hash_bytes(key, &info.st_mtim, sizeof info.st_mtim);
        hash_bytes(key, &info.st_ino, sizeof info.st_ino);
    } else {
        report_error(log, "%s/diptych-gen: cannot be read; build the project with ninja",
                     request->tools);
    }
    free(generator);
    return good;
}

/* What the generator was given, then the headers that the C compiler read. */
static bool stamp_generated(FILE *files, const struct compile_work *work, const struct dt_log *log)
{
    const struct stamp_origin origin = {work->request->spec, work->request->templates};
    char *depfile = format_string("%s/gen.d", work->stamp.folder);
    bool good = depfile && stamp_add(files, depfile, &work->stamp, log) &&
                stamp_add_absent(files, depfile, &origin, &work->stamp, log);
    free(depfile);
    return good;
}

/* In the folder `temporary`, which becomes a version in `folder`. */
static bool build(struct cache_entry *entry, struct console *console, struct compile_work *work,
                  const char *folder, const char *temporary)
{
    double start = milliseconds_now();
    work->stamp.folder = temporary;
    clock_gettime(CLOCK_REALTIME_COARSE, &work->stamp.since);
    console_status(console, "generating %s", work->request->spec);
    if (!generate(work, console))
        return false;
    double generated = milliseconds_now();
    char *files = NULL;
    size_t size = 0;
    FILE *stamp = open_memstream(&files, &size);
    char *name = find_name(temporary, &console->log);
    work->name = name;
    console_status(console, "compiling %s", name ? name : "");
    bool good = stamp && name && stamp_generated(stamp, work, &console->log) &&
                compile_pipeline(work, stamp, console);
    if (stamp && fclose(stamp) != 0)
        good = false;
    entry->generator_ms = generated - start;
    entry->compiler_ms = milliseconds_now() - generated;
    good = good && stamp_publish(folder, temporary, name, files, &console->log);
    free(files);
    free(name);
    return good;
}

static bool find(struct cache_entry *entry, const char *folder)
{
    struct stamped found;
    if (!stamp_read(&found, folder))
        return false;
    entry->folder = found.folder;
    entry->name = found.name;
    entry->held = found.held;
    entry->object = format_string("%s/panels.so", entry->folder);
    free(found.files);
    if (entry->object && file_exists(entry->object))
        return true;
    cache_entry_free(entry);
    return false;
}

static bool build_in_folder(struct cache_entry *entry, struct compile_work *work,
                            const char *folder, struct console *console)
{
    char *temporary = stamp_temporary(folder);
    bool good = temporary;
    for (int i = 0; good && i < MOST_BUILDS; i++) {
        good = file_make_folders(temporary, &console->log);
        console_temporary(console, temporary);
        good = good && build(entry, console, work, folder, temporary);
        file_remove_tree(temporary);
        console_forget(console, temporary);
        if (good && find(entry, folder)) {
            free(temporary);
            return true;
        }
    }
    free(temporary);
    if (!good)
        return false;
    report_error(&console->log,
                 "%s: it, or a file that it names, changes all the time while it is compiled; run "
                 "the command again",
                 work->request->spec);
    return false;
}

bool cache_get(struct cache_entry *entry, const struct build_request *request,
               struct console *console)
{
    *entry = (struct cache_entry){0};
    uint64_t key;
    char *base =
        request_key(request, &key, &console->log) ? cache_folder(request, &console->log) : NULL;
    char *folder = base ? format_string("%s/%016" PRIx64, base, key) : NULL;
    bool good = folder && file_make_folders(folder, &console->log);
    if (good && !find(entry, folder)) {
        struct compile_work work = {.request = request, .base = base};
        good = build_in_folder(entry, &work, folder, console);
        cache_prune(base);
    }
    free(folder);
    free(base);
    return good;
}

void cache_entry_free(struct cache_entry *entry)
{
    if (entry->held)
        closedir(entry->held);
    free(entry->folder);
    free(entry->object);
    free(entry->name);
    *entry = (struct cache_entry){0};
}
