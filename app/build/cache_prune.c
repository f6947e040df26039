/* Keeps the cache within a size; see cache_prune.h. A version's time stamp is its last use. Whoever uses
 * it has a shared lock on its folder, so an exclusive one is had only where nobody does. A file of
 * shaders is read in one go, so it needs none. */
#include "build/cache_prune.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files.h"

enum { DEFAULT_MIB = 512 };

struct version { /* or a file of shaders */
    char *path;
    bool file;
    struct timespec used;
    uint64_t bytes;
};

struct versions {
    struct version *list;
    size_t count;
    uint64_t bytes;
};

/* ---- In use ---------------------------------------------------------------------------------- */

/* Whether the folder that is open still has its name: another process may have removed it while this
 * one waited. */
static bool is_there(DIR *folder, const char *path)
{
    struct stat named, open;
    return stat(path, &named) == 0 && fstat(dirfd(folder), &open) == 0 &&
           named.st_ino == open.st_ino && named.st_dev == open.st_dev;
}

DIR *cache_hold(const char *version)
{
    DIR *folder = opendir(version);
    if (!folder)
        return NULL;
    while (flock(dirfd(folder), LOCK_SH) != 0 && errno == EINTR)
        continue;
    if (!is_there(folder, version)) {
        closedir(folder);
        return NULL;
    }
    futimens(dirfd(folder), NULL); /* a cache that cannot be written is none that is pruned */
    return folder;
}

static void remove_unused(const struct version *version, struct versions *versions)
{
    if (version->file) {
        if (unlink(version->path) == 0)
            versions->bytes -= version->bytes;
        return;
    }
    DIR *folder = opendir(version->path);
    if (folder && flock(dirfd(folder), LOCK_EX | LOCK_NB) == 0 && file_remove_tree(version->path))
        versions->bytes -= version->bytes;
    if (folder)
        closedir(folder);
}

/* ---- What there is --------------------------------------------------------------------------- */

/* Calls `take` for every entry that is a folder with a name of 16 hexadecimal digits. */
static void each_folder(const char *path, void (*take)(const char *path, void *user), void *user)
{
    DIR *listing = opendir(path);
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry;
         entry = readdir(listing)) {
        if (strlen(entry->d_name) != 16 || strspn(entry->d_name, "0123456789abcdef") != 16)
            continue;
        char *folder = format_string("%s/%s", path, entry->d_name);
        if (folder)
            take(folder, user);
        free(folder);
    }
    if (listing)
        closedir(listing);
}

/* Of all files below, as they lie on the disk. */
static uint64_t tree_bytes(const char *path)
{
    uint64_t bytes = 0;
    DIR *listing = opendir(path);
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry;
         entry = readdir(listing)) {
        struct stat info;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
            fstatat(dirfd(listing), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) != 0)
            continue;
        bytes += (uint64_t)info.st_blocks * 512;
        char *folder = S_ISDIR(info.st_mode) ? format_string("%s/%s", path, entry->d_name) : NULL;
        bytes += folder ? tree_bytes(folder) : 0;
        free(folder);
    }
    if (listing)
        closedir(listing);
    return bytes;
}

static void add(struct versions *versions, struct version version)
{
    struct version *grown = realloc(versions->list, (versions->count + 1) * sizeof *versions->list);
    if (grown) {
        versions->list = grown;
        version.path = strdup(version.path);
    }
    if (!grown || !version.path)
        return;
    versions->bytes += version.bytes;
    versions->list[versions->count++] = version;
}

static void add_version(const char *path, void *user)
{
    struct stat info;
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode))
        add(user, (struct version){
                      .path = (char *)path, .used = info.st_mtim, .bytes = tree_bytes(path)});
}

static void add_versions(const char *path, void *user)
{
    each_folder(path, add_version, user);
}

/* Also what a generator that was killed left of one. */
static void add_shaders(const char *base, struct versions *versions)
{
    DIR *listing = opendir(base);
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry;
         entry = readdir(listing)) {
        size_t digits = strspn(entry->d_name, "0123456789abcdef");
        struct stat info;
        if (digits != 16 ||
            strncmp(entry->d_name + 16, CACHE_SHADERS, strlen(CACHE_SHADERS)) != 0 ||
            fstatat(dirfd(listing), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) != 0)
            continue;
        char *path = format_string("%s/%s", base, entry->d_name);
        if (path)
            add(versions, (struct version){.path = path,
                                           .file = true,
                                           .used = info.st_mtim,
                                           .bytes = (uint64_t)info.st_blocks * 512});
        free(path);
    }
    if (listing)
        closedir(listing);
}

/* ---- Pruning --------------------------------------------------------------------------------- */

static int older_first(const void *a, const void *b)
{
    const struct timespec *x = &((const struct version *)a)->used;
    const struct timespec *y = &((const struct version *)b)->used;
    if (x->tv_sec != y->tv_sec)
        return x->tv_sec < y->tv_sec ? -1 : 1;
    return (x->tv_nsec > y->tv_nsec) - (x->tv_nsec < y->tv_nsec);
}

static uint64_t limit_bytes(void)
{
    const char *text = getenv("DIPTYCH_CACHE_MIB");
    char *end = NULL;
    unsigned long mib = text && *text >= '0' && *text <= '9' ? strtoul(text, &end, 10) : 0;
    return (uint64_t)(end && !*end ? mib : DEFAULT_MIB) << 20;
}

void cache_prune(const char *base)
{
    struct versions versions = {0};
    uint64_t limit = limit_bytes();
    each_folder(base, add_versions, &versions);
    add_shaders(base, &versions);
    if (versions.bytes > limit)
        qsort(versions.list, versions.count, sizeof *versions.list, older_first);
    for (size_t i = 0; i < versions.count; i++) {
        if (versions.bytes > limit)
            remove_unused(&versions.list[i], &versions);
        free(versions.list[i].path);
    }
    free(versions.list);
}
