/* What stands in the cache and what it was made from; see stamp.h. A stamp is text: "name NAME",
 * "version HASH", then "HASH PATH" for every file, "absent PATH" for what another file stands in for. */
#include "build/stamp.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files.h"
#include "build/cache_prune.h"

/* ---- Files that it was made from ------------------------------------------------------------- */

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
    FILE *files;
    const char *depfile;
    const struct stamp_work *work;
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
    if (path && strncmp(path, stamping->work->folder, strlen(stamping->work->folder)) != 0) {
        uint64_t hash = content_hash(path, &good);
        hash = is_newer(path, stamping->work->since) ? ~hash : hash;
        fprintf(stamping->files, "%016" PRIx64 " %s\n", hash, path);
    }
    if (!good)
        report_error(stamping->log, "%s: names %s, which cannot be read", stamping->depfile, file);
    free(path);
    return good;
}

bool stamp_add(FILE *files, const char *depfile, const struct stamp_work *work,
               const struct dt_log *log)
{
    struct stamping stamping = {.files = files, .depfile = depfile, .work = work, .log = log};
    return depfile_read(depfile, stamp_file, &stamping, log);
}

/* ---- Files that were not there --------------------------------------------------------------- */

struct paths {
    char **list;
    size_t count;
};

static bool take_path(void *user, const char *file)
{
    struct paths *paths = user;
    char **list = realloc(paths->list, (paths->count + 1) * sizeof *list);
    if (!list)
        return false;
    paths->list = list;
    char *path = realpath(file, NULL); /* stamp_add tells of those that cannot be read */
    if (path)
        list[paths->count++] = path;
    return true;
}

static int folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (int)(slash - path) : 0;
}

/* The file of that name in the folder of `beside`. One that has just come may have been missed. */
static bool add_absent(FILE *files, const char *beside, const char *name,
                       const struct stamp_work *work)
{
    char *path = format_string("%.*s/%s", folder_length(beside), beside, name);
    bool good = path;
    if (path && (access(path, F_OK) != 0 || is_newer(path, work->since)))
        good = fprintf(files, "absent %s\n", path) >= 0;
    free(path);
    return good;
}

/* Whether it is the first of its folder. */
static bool is_first(const struct paths *paths, size_t index)
{
    int length = folder_length(paths->list[index]);
    for (size_t i = 0; i < index; i++)
        if (folder_length(paths->list[i]) == length &&
            strncmp(paths->list[i], paths->list[index], (size_t)length) == 0)
            return false;
    return true;
}

bool stamp_add_absent(FILE *files, const char *depfile, const struct stamp_origin *origin,
                      const struct stamp_work *work, const struct dt_log *log)
{
    struct paths paths = {0};
    char *templates = realpath(origin->templates, NULL);
    size_t length = templates ? strlen(templates) : 0;
    bool good = templates && depfile_read(depfile, take_path, &paths, log);
    for (size_t i = 0; good && i < paths.count; i++) {
        const char *name = paths.list[i] + length + 1;
        if (strncmp(paths.list[i], templates, length) != 0 || paths.list[i][length] != '/')
            continue;
        good = add_absent(files, origin->spec, name, work);
        for (size_t k = 0; good && k < paths.count && strncmp(name, "glsl/", 5) == 0; k++)
            if (is_first(&paths, k))
                good = add_absent(files, paths.list[k], name + 5, work);
    }
    for (size_t i = 0; i < paths.count; i++)
        free(paths.list[i]);
    free(paths.list);
    free(templates);
    return good;
}

/* ---- Writing --------------------------------------------------------------------------------- */

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

char *stamp_temporary(const char *folder)
{
    remove_stale(folder);
    return format_string("%s/tmp-%d", folder, (int)getpid());
}

bool stamp_publish(const char *folder, const char *temporary, const char *name, const char *files,
                   const struct dt_log *log)
{
    uint64_t version = FILE_HASH_START;
    hash_bytes(&version, files, strlen(files));
    char *final = format_string("%s/%016" PRIx64, folder, version);
    char *path = format_string("%s/stamp", folder);
    char *text = format_string("name %s\nversion %016" PRIx64 "\n%s", name, version, files);
    bool good = final && path && text;
    if (!good)
        report_error(log, "out of memory");
    /* another process may have published the same version first; its content is as good as ours */
    if (good && rename(temporary, final) != 0 && errno != ENOTEMPTY && errno != EEXIST) {
        report_error(log, "%s: cannot be renamed to %s: %s", temporary, final, strerror(errno));
        good = false;
    }
    good = good && file_write(path, text, strlen(text), log);
    free(text);
    free(path);
    free(final);
    return good;
}

/* ---- Reading --------------------------------------------------------------------------------- */

static bool line_is_fresh(const char *line)
{
    char *rest = NULL;
    uint64_t wanted = strtoull(line, &rest, 16);
    bool good = false;
    return rest && *rest == ' ' && content_hash(rest + 1, &good) == wanted && good;
}

/* A line of the stamp; false when its file has changed. */
static bool take_line(struct stamped *found, const char *folder, const char *line, FILE *files)
{
    if (strncmp(line, "name ", 5) == 0 && !found->name)
        found->name = strdup(line + 5);
    else if (strncmp(line, "version ", 8) == 0 && !found->folder)
        found->folder = format_string("%s/%s", folder, line + 8);
    else if (fprintf(files, "%s\n", line) < 0)
        return false;
    else if (strncmp(line, "absent ", 7) == 0 ? access(line + 7, F_OK) == 0 : !line_is_fresh(line))
        return false;
    return true;
}

bool stamp_read(struct stamped *found, const char *folder)
{
    *found = (struct stamped){0};
    char *path = format_string("%s/stamp", folder);
    FILE *stamp = path ? fopen(path, "r") : NULL;
    free(path);
    if (!stamp)
        return false;
    char *line = NULL;
    size_t capacity = 0, size = 0;
    FILE *files = open_memstream(&found->files, &size);
    bool fresh = files;
    for (ssize_t length; fresh && (length = getline(&line, &capacity, stamp)) > 0;) {
        line[length - (line[length - 1] == '\n')] = 0;
        fresh = take_line(found, folder, line, files);
    }
    free(line);
    fclose(stamp);
    if (files && fclose(files) != 0)
        fresh = false;
    found->held = fresh && found->folder ? cache_hold(found->folder) : NULL;
    if (found->held && found->name)
        return true;
    stamped_free(found);
    return false;
}

void stamped_free(struct stamped *found)
{
    if (found->held)
        closedir(found->held);
    free(found->folder);
    free(found->name);
    free(found->files);
    *found = (struct stamped){0};
}
