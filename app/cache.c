/* Builds pipelines and keeps them; see cache.h. The stamp is text: "name NAME", "version HASH",
 * then "HASH PATH" for every file that the generator's and the compiler's depfiles name. */
#include "cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "cache_prune.h"
#include "files.h"
#include "tool.h"

enum { MOST_BUILDS = 5 }; /* of files that are saved while they are compiled */

/* ---- Child processes ------------------------------------------------------------------------- */

/* Shaders of this spec, whatever is set: an edit, or another --set, compiles what it changes. In the
 * cache's own folder, which is that of the folder that the temporary one is in. */
static char *shader_cache(const struct build_request *request, const char *temporary)
{
    uint64_t key = FILE_HASH_START;
    hash_bytes(&key, request->spec, strlen(request->spec) + 1);
    hash_bytes(&key, request->templates, strlen(request->templates) + 1);
    return format_string("%s/../../%016" PRIx64 CACHE_SHADERS, temporary, key);
}

static bool generate(const struct build_request *request, const char *folder,
                     struct console *console)
{
    static const struct tool generator = {.what = "generating the pipeline",
                                          .hint = "build the project with ninja",
                                          .explains = true};
    char *tool = format_string("%s/diptych-gen", request->tools);
    char *depfile = format_string("%s/gen.d", folder);
    char *shaders = shader_cache(request, folder);
    char **argv = calloc(request->set_count * 2 + 11, sizeof *argv);
    bool good = false;
    if (tool && depfile && shaders && argv) {
        size_t n = 0;
        argv[n++] = tool;
        argv[n++] = (char *)request->spec;
        argv[n++] = (char *)"-o";
        argv[n++] = (char *)folder;
        argv[n++] = (char *)"--depfile";
        argv[n++] = depfile;
        argv[n++] = (char *)"--shader-cache";
        argv[n++] = shaders;
        argv[n++] = (char *)"--templates";
        argv[n++] = (char *)request->templates;
        for (uint32_t i = 0; i < request->set_count; i++) {
            argv[n++] = (char *)"--set";
            argv[n++] = (char *)request->sets[i];
        }
        good = tool_run(&generator, argv, -1, console);
    } else {
        report_error(&console->log, "out of memory");
    }
    free(argv);
    free(shaders);
    free(depfile);
    free(tool);
    return good;
}

/* What the generator wrote: both panels, which take longest, and the reflection. */
enum { SOURCES = 3 };
static const char *const source_ends[SOURCES] = {"_gl.c", "_vk.c", ".c"};

struct compilation {
    char *source, *object, *depfile;
    char *argv[17];
};

static const char *c_compiler(void)
{
    const char *named = getenv("CC");
    return named && *named ? named : "cc";
}

static bool plan_compilation(struct compilation *plan, const struct build_request *request,
                             const char *folder, const char *name, const char *end)
{
    *plan = (struct compilation){.source = format_string("%s/%s%s", folder, name, end),
                                 .object = format_string("%s/%s%s.o", folder, name, end),
                                 .depfile = format_string("%s/%s%s.d", folder, name, end)};
    const char *argv[] = {c_compiler(), "-std=c11",
                          "-Og", /* two thirds of the time; what it calls is optimised */
                          "-fPIC",      "-MMD",
                          "-MF",        plan->depfile,
                          "-I",         request->headers[0],
                          "-I",         request->headers[1],
                          "-c",         plan->source,
                          "-o",         plan->object,
                          NULL};
    _Static_assert(sizeof argv <= sizeof plan->argv, "every word has its place");
    memcpy(plan->argv, argv, sizeof argv);
    return plan->source && plan->object && plan->depfile;
}

/* Reflection and both panels, at the same time, into one shared object; the runtimes' symbols come from
 * the executable when it is loaded. */
static bool compile(const struct build_request *request, const char *folder, const char *name,
                    struct console *console)
{
    static const struct tool compiler = {
        .what = "compiling the generated C",
        .hint = "install a C compiler, or name one in the environment variable CC"};
    struct compilation plans[SOURCES];
    char *const *argvs[SOURCES];
    char *object = format_string("%s/panels.so", folder);
    bool good = object;
    for (int i = 0; i < SOURCES; i++) {
        good = plan_compilation(&plans[i], request, folder, name, source_ends[i]) && good;
        argvs[i] = plans[i].argv;
    }
    char *link[] = {(char *)c_compiler(), (char *)"-shared", (char *)"-o",    object,
                    plans[0].object,      plans[1].object,   plans[2].object, NULL};
    if (good)
        good = tool_run_all(&compiler, argvs, SOURCES, console) &&
               tool_run(&compiler, link, -1, console);
    else
        report_error(&console->log, "out of memory");
    for (int i = 0; i < SOURCES; i++) {
        if (plans[i].object)
            unlink(plans[i].object);
        free(plans[i].source);
        free(plans[i].object);
        free(plans[i].depfile);
    }
    free(object);
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

/* ---- The stamp ------------------------------------------------------------------------------- */

static uint64_t content_hash(const char *path, bool *good)
{
    uint64_t hash = FILE_HASH_START;
    *good = hash_file(&hash, path);
    return hash;
}

/* Takes the next word of a depfile out of *at, in place: blanks end it, "\ " is a blank, "$$" a
 * dollar, "\<newline>" nothing. */
static char *next_word(char **at, bool *target)
{
    char *from = *at;
    while (*from == ' ' || *from == '\n' || (from[0] == '\\' && from[1] == '\n'))
        from += *from == '\\' ? 2 : 1;
    if (!*from)
        return NULL;
    char *word = from;
    char *to = from;
    while (*from && *from != ' ' && *from != '\n' && !(from[0] == '\\' && from[1] == '\n')) {
        if ((*from == '\\' && from[1]) || (from[0] == '$' && from[1] == '$'))
            from++;
        *to++ = *from++;
    }
    *at = *from ? from + 1 : from;
    *to = 0;
    *target = to > word && to[-1] == ':';
    return word;
}

bool depfile_read(const char *path, bool (*take)(void *user, const char *file), void *user,
                  const struct dt_log *log)
{
    size_t size;
    char *text = file_read(path, &size, log);
    bool good = text;
    bool target = false;
    char *at = text;
    for (char *word = good ? next_word(&at, &target) : NULL; word && good;
         word = next_word(&at, &target))
        good = target || take(user, word);
    free(text);
    return good;
}

struct stamping {
    FILE *stamp;
    const char *depfile;
    const char *folder;    /* about to be renamed: what lies in it is left out */
    struct timespec since; /* of the clock that files are dated by: when generating began */
    const struct dt_log *log;
};

static bool is_before(struct timespec a, struct timespec b)
{
    return a.tv_sec < b.tv_sec || (a.tv_sec == b.tv_sec && a.tv_nsec < b.tv_nsec);
}

/* Whether it was saved when the generator may have read it already: its content says nothing of what
 * was made. A date in the future says nothing. */
static bool is_newer(const char *path, struct timespec since)
{
    struct stat info;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME_COARSE, &now);
    return stat(path, &info) != 0 ||
           (!is_before(info.st_mtim, since) && !is_before(now, info.st_mtim));
}

/* Adds "HASH PATH" to the stamp; with a hash that is no content's when it has changed meanwhile. */
static bool stamp_file(void *user, const char *file)
{
    const struct stamping *stamping = user;
    char *path = realpath(file, NULL);
    bool good = path;
    if (path && strncmp(path, stamping->folder, strlen(stamping->folder)) != 0) {
        uint64_t hash = content_hash(path, &good);
        hash = is_newer(path, stamping->since) ? ~hash : hash;
        fprintf(stamping->stamp, "%016" PRIx64 " %s\n", hash, path);
    }
    if (!good)
        report_error(stamping->log, "%s: names %s, which cannot be read", stamping->depfile, file);
    free(path);
    return good;
}

/* The files that the rule in folder/PREFIX_END names. */
static bool stamp_depfile(struct stamping *stamping, const char *prefix, const char *end)
{
    char *path = format_string("%s/%s%s", stamping->folder, prefix, end);
    stamping->depfile = path;
    bool good = path && depfile_read(path, stamp_file, stamping, stamping->log);
    free(path);
    return good;
}

/* The stamp of what was built in `folder`, as text; the version is the hash of its lines. */
static char *make_stamp(const char *folder, const char *name, struct timespec since,
                        char version[17], const struct dt_log *log)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stamp = open_memstream(&text, &size);
    struct stamping stamping = {.stamp = stamp, .folder = folder, .since = since, .log = log};
    bool good = stamp && stamp_depfile(&stamping, "gen", ".d");
    for (int i = 0; i < SOURCES; i++) {
        char *end = format_string("%s.d", source_ends[i]);
        good = good && end && stamp_depfile(&stamping, name, end);
        free(end);
    }
    if (stamp && fclose(stamp) != 0)
        good = false;
    char *whole = NULL;
    if (good) {
        uint64_t hash = FILE_HASH_START;
        hash_bytes(&hash, text, size);
        snprintf(version, 17, "%016" PRIx64, hash);
        whole = format_string("name %s\nversion %s\n%s", name, version, text);
    }
    free(text);
    return whole;
}

static bool line_is_fresh(const char *line)
{
    char *rest = NULL;
    uint64_t wanted = strtoull(line, &rest, 16);
    bool good = false;
    return rest && *rest == ' ' && content_hash(rest + 1, &good) == wanted && good;
}

/* Reads the stamp in `folder`; false when there is none or a file has changed since. */
static bool read_stamp(struct cache_entry *entry, const char *folder)
{
    char *path = format_string("%s/stamp", folder);
    FILE *stamp = path ? fopen(path, "r") : NULL;
    free(path);
    if (!stamp)
        return false;
    char *line = NULL;
    size_t capacity = 0;
    bool fresh = true;
    for (ssize_t length; fresh && (length = getline(&line, &capacity, stamp)) > 0;) {
        if (line[length - 1] == '\n')
            line[length - 1] = 0;
        if (strncmp(line, "name ", 5) == 0 && !entry->name)
            entry->name = strdup(line + 5);
        else if (strncmp(line, "version ", 8) == 0 && !entry->folder)
            entry->folder = format_string("%s/%s", folder, line + 8);
        else
            fresh = line_is_fresh(line);
    }
    free(line);
    fclose(stamp);
    if (entry->folder)
        entry->object = format_string("%s/panels.so", entry->folder);
    entry->held = fresh && entry->folder ? cache_hold(entry->folder) : NULL;
    if (entry->held && entry->name && entry->object && file_exists(entry->object))
        return true;
    cache_entry_free(entry);
    return false;
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
    hash_bytes(key, request->spec, strlen(request->spec) + 1);
    hash_bytes(key, request->templates, strlen(request->templates) + 1);
    for (uint32_t i = 0; i < request->set_count; i++)
        hash_bytes(key, request->sets[i], strlen(request->sets[i]) + 1);
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

/* Puts the finished temporary folder in its place and lets the stamp name it. */
static bool publish(const char *folder, const char *temporary, const char *version,
                    const char *stamp, const struct dt_log *log)
{
    char *final = format_string("%s/%s", folder, version);
    char *path = format_string("%s/stamp", folder);
    bool good = final && path;
    /* another process may have published the same version first; its content is as good as ours */
    if (good && rename(temporary, final) != 0 && errno != ENOTEMPTY && errno != EEXIST) {
        report_error(log, "%s: cannot be renamed to %s: %s", temporary, final, strerror(errno));
        good = false;
    }
    good = good && file_write(path, stamp, strlen(stamp), log);
    free(final);
    free(path);
    return good;
}

static bool build(struct cache_entry *entry, struct console *console,
                  const struct build_request *request, const char *folder, const char *temporary)
{
    char version[17];
    double start = milliseconds_now();
    struct timespec since;
    clock_gettime(CLOCK_REALTIME_COARSE, &since);
    console_status(console, "generating %s", request->spec);
    if (!generate(request, temporary, console))
        return false;
    double generated = milliseconds_now();
    char *name = find_name(temporary, &console->log);
    console_status(console, "compiling %s", name ? name : "");
    bool good = name && compile(request, temporary, name, console);
    entry->generator_ms = generated - start;
    entry->compiler_ms = milliseconds_now() - generated;
    char *stamp = good ? make_stamp(temporary, name, since, version, &console->log) : NULL;
    good = stamp && publish(folder, temporary, version, stamp, &console->log);
    free(stamp);
    free(name);
    return good;
}

/* Removes what a process that was killed left half built, ours too should its number have come
 * round to us. */
static void remove_stale(const char *folder)
{
    DIR *listing = opendir(folder);
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry;
         entry = readdir(listing)) {
        int owner = 0;
        if (sscanf(entry->d_name, "tmp-%d", &owner) != 1 || owner <= 0)
            continue;
        bool alive = owner != (int)getpid() && (kill(owner, 0) == 0 || errno != ESRCH);
        char *path = alive ? NULL : format_string("%s/%s", folder, entry->d_name);
        if (path)
            file_remove_tree(path);
        free(path);
    }
    if (listing)
        closedir(listing);
}

static bool build_in_folder(struct cache_entry *entry, const struct build_request *request,
                            const char *folder, struct console *console)
{
    remove_stale(folder);
    char *temporary = format_string("%s/tmp-%d", folder, (int)getpid());
    bool good = temporary;
    for (int i = 0; good && i < MOST_BUILDS; i++) {
        good = file_make_folders(temporary, &console->log);
        console_temporary(console, temporary);
        good = good && build(entry, console, request, folder, temporary);
        file_remove_tree(temporary);
        console_forget(console, temporary);
        if (good && read_stamp(entry, folder)) {
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
                 request->spec);
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
    if (good && !read_stamp(entry, folder)) {
        good = build_in_folder(entry, request, folder, console);
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
