/* Reloads pipelines; see reload.h. Files are looked at every few milliseconds, by time and size:
 * there are some forty, and editors save in too many ways to be listened to. All files of their kinds
 * in the same folders are watched, so that one that a broken edit brought in is, too; and while it is broken, folders
 * in these, where that one may have to be made. */
#include "spec/reload.h"

#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <time.h>

#include "base/files.h"

enum { LOOK_MS = 20, MAX_FOLDERS = 64 };

/* Changes when a file is saved, comes or goes. */
struct sight {
    uint64_t files;
    uint64_t folders; /* in the watched ones, with what comes and goes there */
};

struct reload {
    struct console *console;
    struct setup setup;
    pthread_t thread;
    pthread_mutex_t lock; /* of what follows */
    bool stop;
    char **asked; /* overrides of reload_again that were not taken yet; NULL: none; owned */
    uint32_t asked_count;
    enum reload_news news;
    struct reload_result result;
    /* the thread's own */
    char *folders[MAX_FOLDERS];
    uint32_t folder_count;
    char **sets;    /* those of the last reload_again, owned; NULL: the caller's */
    bool broken;    /* the last build failed */
    bool automatic; /* the last one that did not has `target: auto` */
};

/* ---- What is watched ------------------------------------------------------------------------- */

static void add_folder(struct reload *reload, const char *file)
{
    char *path = realpath(file, NULL);
    char *slash = path ? strrchr(path, '/') : NULL;
    bool wanted = slash && reload->folder_count < MAX_FOLDERS;
    if (slash)
        *slash = 0;
    for (uint32_t i = 0; wanted && i < reload->folder_count; i++)
        wanted = strcmp(reload->folders[i], path) != 0;
    if (wanted)
        reload->folders[reload->folder_count++] = path;
    else
        free(path);
}

static void watch(struct reload *reload, const struct pipeline *pipeline)
{
    uint32_t count;
    const char *const *sources = plan_sources(pipeline->plan, &count);
    add_folder(reload, pipeline->spec);
    for (uint32_t i = 0; i < count; i++)
        add_folder(reload, sources[i]);
}

static bool is_source(const char *name)
{
    static const char *const ends[] = {".yaml", ".yml",  ".glsl", ".c",   ".h",  ".png",
                                       ".jpg",  ".jpeg", ".exr",  ".hdr", ".npy"};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < DT_ARRAY_COUNT(ends); i++)
        if (strcasecmp(dot, ends[i]) == 0)
            return name[0] != '.';
    return false;
}

static void add_to_sight(struct sight *sight, int folder, const char *name)
{
    struct stat info;
    if (name[0] == '.' || fstatat(folder, name, &info, 0) != 0)
        return;
    bool is_folder = S_ISDIR(info.st_mode);
    if (!is_folder && !is_source(name))
        return;
    /* the order in which a folder lists its files says nothing: sums do not see it */
    uint64_t own = FILE_HASH_START;
    hash_bytes(&own, name, strlen(name));
    hash_bytes(&own, &info.st_mtim, sizeof info.st_mtim);
    hash_bytes(&own, &info.st_size, sizeof info.st_size);
    hash_bytes(&own, &info.st_ino, sizeof info.st_ino);
    *(is_folder ? &sight->folders : &sight->files) += own;
}

static struct sight look(const struct reload *reload)
{
    struct sight sight = {0};
    for (uint32_t i = 0; i < reload->folder_count; i++) {
        DIR *listing = opendir(reload->folders[i]);
        for (struct dirent *entry = listing ? readdir(listing) : NULL; entry;
             entry = readdir(listing))
            if (entry->d_type != DT_REG || is_source(entry->d_name))
                add_to_sight(&sight, dirfd(listing), entry->d_name);
        if (listing)
            closedir(listing);
    }
    return sight;
}

static bool is_other(const struct reload *reload, struct sight seen, struct sight built)
{
    return seen.files != built.files || (reload->broken && seen.folders != built.folders);
}

/* ---- The thread ------------------------------------------------------------------------------ */

static void result_forget(struct reload_result *result)
{
    pipeline_unload(&result->pipeline);
    free(result->text);
    *result = (struct reload_result){0};
}

/* What nobody has asked for yet is outdated. */
static void tell_news(struct reload *reload, enum reload_news news,
                      const struct reload_result *result)
{
    pthread_mutex_lock(&reload->lock);
    result_forget(&reload->result);
    reload->news = news;
    reload->result = *result;
    pthread_mutex_unlock(&reload->lock);
}

static void build_pipeline(struct reload *reload, double start)
{
    struct reload_result result = {0};
    tell_news(reload, RELOAD_BEGUN, &result);
    console_capture();
    const char *target = !reload->automatic      ? NULL
                         : reload->setup.for_gpu ? "target=gpu"
                                                 : "target=software";
    bool good = pipeline_try(reload->console, &reload->setup, target);
    if (good) {
        /* The other process said the same. */
        free(console_captured());
        console_capture();
        good = pipeline_load(&result.pipeline, reload->console, &reload->setup);
    }
    result.text = console_captured();
    result.ms = milliseconds_now() - start;
    console_status(reload->console, "%s", "");
    if (good) {
        watch(reload, &result.pipeline); /* it may be made from files of more folders */
        reload->automatic = plan_is_automatic(result.pipeline.plan);
    }
    reload->broken = !good;
    tell_news(reload, good ? RELOAD_DONE : RELOAD_FAILED, &result);
}

static void free_sets(char **sets, uint32_t count)
{
    for (uint32_t i = 0; sets && i < count; i++)
        free(sets[i]);
    free(sets);
}

/* Whether other overrides were asked for: from now on, they hold. */
static bool take_sets(struct reload *reload)
{
    pthread_mutex_lock(&reload->lock);
    char **asked = reload->asked;
    uint32_t count = reload->asked_count;
    reload->asked = NULL;
    pthread_mutex_unlock(&reload->lock);
    if (!asked)
        return false;
    free_sets(reload->sets, reload->setup.set_count);
    reload->sets = asked;
    reload->setup.sets = (const char **)asked;
    reload->setup.set_count = count;
    return true;
}

static bool is_stopped(struct reload *reload)
{
    pthread_mutex_lock(&reload->lock);
    bool stop = reload->stop;
    pthread_mutex_unlock(&reload->lock);
    return stop;
}

static void *watch_files(void *user)
{
    struct reload *reload = user;
    struct sight built = look(reload);
    while (!is_stopped(reload)) {
        nanosleep(&(struct timespec){.tv_nsec = LOOK_MS * 1000000L}, NULL);
        struct sight seen = look(reload);
        bool asked = take_sets(reload);
        if (!asked && !is_other(reload, seen, built))
            continue;
        double start = milliseconds_now();
        for (struct sight before = built; is_other(reload, seen, before);) {
            before = seen; /* until it is written to its end */
            nanosleep(&(struct timespec){.tv_nsec = LOOK_MS * 1000000L}, NULL);
            seen = look(reload);
        }
        uint32_t folders = reload->folder_count;
        build_pipeline(reload, start);
        /* with more folders it is another number; else a file saved meanwhile has its turn next */
        built = reload->folder_count == folders ? seen : look(reload);
    }
    return NULL;
}

/* ---- For the caller -------------------------------------------------------------------------- */

struct reload *reload_start(struct console *console, const struct setup *setup,
                            const struct pipeline *pipeline)
{
    struct reload *reload = calloc(1, sizeof *reload);
    int error = ENOMEM;
    if (reload) {
        *reload = (struct reload){
            .console = console, .setup = *setup, .automatic = plan_is_automatic(pipeline->plan)};
        pthread_mutex_init(&reload->lock, NULL);
        watch(reload, pipeline);
        error = pthread_create(&reload->thread, NULL, watch_files, reload);
        if (!error)
            return reload;
        for (uint32_t i = 0; i < reload->folder_count; i++)
            free(reload->folders[i]);
        pthread_mutex_destroy(&reload->lock);
    }
    report_error(&console->log, "cannot watch the files of the pipeline: %s", strerror(error));
    free(reload);
    return NULL;
}

bool reload_again(struct reload *reload, const char *const *sets, uint32_t count)
{
    char **copy = calloc(count + 1, sizeof *copy);
    bool good = copy;
    for (uint32_t i = 0; good && i < count; i++)
        good = (copy[i] = strdup(sets[i]));
    if (!good) {
        free_sets(copy, count);
        return report_error(&reload->console->log, "out of memory");
    }
    pthread_mutex_lock(&reload->lock);
    char **before = reload->asked;
    uint32_t before_count = reload->asked_count;
    reload->asked = copy;
    reload->asked_count = count;
    pthread_mutex_unlock(&reload->lock);
    free_sets(before, before_count);
    return true;
}

enum reload_news reload_poll(struct reload *reload, struct reload_result *result)
{
    pthread_mutex_lock(&reload->lock);
    enum reload_news news = reload->news;
    *result = reload->result;
    reload->result = (struct reload_result){0};
    reload->news = RELOAD_NONE;
    pthread_mutex_unlock(&reload->lock);
    return news;
}

void reload_stop(struct reload *reload)
{
    if (!reload)
        return;
    pthread_mutex_lock(&reload->lock);
    reload->stop = true;
    pthread_mutex_unlock(&reload->lock);
    pthread_join(reload->thread, NULL);
    result_forget(&reload->result);
    for (uint32_t i = 0; i < reload->folder_count; i++)
        free(reload->folders[i]);
    free_sets(reload->asked, reload->asked_count);
    if (reload->sets)
        free_sets(reload->sets, reload->setup.set_count);
    pthread_mutex_destroy(&reload->lock);
    free(reload);
}
