/* A cache of data in a folder; see cache.h. The head of a file has a hash of the content, so a damaged, truncated or
 * foreign file is a miss, and is replaced. */
#include "cache.h"
#include "base/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

enum { DEFAULT_MIB = 64, MOST_MIB = 1 << 20 };
enum { NAME_SIZE = 40, MOST_WORDS = 16 << 20, STALE_SECONDS = 3600 };

struct head {
    char magic[8];
    uint64_t hash; /* of the words and of the source text that they were made from */
    uint64_t word_count;
};
static const char magic[8] = "dtspv 2";

struct cache {
    int folder;
    bool added;
    unsigned number; /* of temporary files */
};

/* ---- Entries --------------------------------------------------------------------------------- */

static void name_entry(char name[NAME_SIZE], const uint64_t hash[2], const char *ending)
{
    snprintf(name, NAME_SIZE, "%016" PRIx64 "%016" PRIx64 ".%s", hash[0], hash[1], ending);
}

/* The name seeds the hash of the content, so a renamed file is a miss. */
static bool read_entry(FILE *file, uint64_t seed, uint32_t **out, size_t *count)
{
    struct head head;
    struct stat status;
    if (fstat(fileno(file), &status) || !S_ISREG(status.st_mode) ||
        fread(&head, sizeof head, 1, file) != 1 || memcmp(head.magic, magic, sizeof magic) != 0 ||
        !head.word_count || head.word_count > MOST_WORDS ||
        (uint64_t)status.st_size != sizeof head + head.word_count * sizeof **out)
        return false;
    size_t size = head.word_count * sizeof **out;
    uint32_t *words = malloc(size);
    if (!words || fread(words, size, 1, file) != 1 ||
        XXH3_64bits_withSeed(words, size, seed) != head.hash) {
        free(words);
        return false;
    }
    *out = words;
    *count = head.word_count;
    return true;
}

bool cache_find(struct cache *cache, const uint64_t hash[2], const char *ending, uint32_t **words,
                size_t *count)
{
    char name[NAME_SIZE];
    if (!cache || !hash[1])
        return false;
    name_entry(name, hash, ending);
    int number = openat(cache->folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    FILE *file = number >= 0 ? fdopen(number, "rb") : NULL;
    bool found = file && read_entry(file, hash[0], words, count);
    if (found)
        futimens(number, NULL); /* the time of use; on failure the entry only looks older */
    if (file)
        fclose(file);
    else if (number >= 0)
        close(number);
    return found;
}

void cache_add(struct cache *cache, const uint64_t hash[2], const char *ending,
               const uint32_t *words, size_t count)
{
    size_t size = count * sizeof *words;
    struct head head = {.word_count = count};
    char name[NAME_SIZE], temporary[NAME_SIZE];
    if (!cache || !hash[1])
        return;
    name_entry(name, hash, ending);
    head.hash = XXH3_64bits_withSeed(words, size, hash[0]);
    memcpy(head.magic, magic, sizeof magic);
    snprintf(temporary, sizeof temporary, ".%ld-%u", (long)getpid(), cache->number++);
    int file = openat(cache->folder, temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file < 0)
        return;
    bool good = write_all(file, &head, sizeof head) && write_all(file, words, size);
    good = !close(file) && good && !renameat(cache->folder, temporary, cache->folder, name);
    if (!good)
        unlinkat(cache->folder, temporary, 0);
    cache->added |= good;
}

/* ---- Size ------------------------------------------------------------------------------------ */

struct file {
    char name[NAME_SIZE];
    int64_t used; /* seconds */
    uint64_t bytes;
};

static int oldest_first(const void *a, const void *b)
{
    const struct file *x = a, *y = b;
    return (x->used > y->used) - (x->used < y->used);
}

/* Lists the entries, and removes temporary files of killed processes. free() the result. */
static struct file *list_files(int folder, size_t *count, uint64_t *bytes)
{
    struct dirent **list = NULL;
    int found = scandirat(folder, ".", &list, NULL, NULL);
    struct file *files = found > 0 ? malloc((size_t)found * sizeof *files) : NULL;
    for (int i = 0; i < found; i++) {
        const char *name = list[i]->d_name;
        struct stat status;
        bool fits = files && strlen(name) < NAME_SIZE &&
                    !fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) && S_ISREG(status.st_mode);
        if (fits && name[0] == '.' && time(NULL) - status.st_mtime > STALE_SECONDS)
            unlinkat(folder, name, 0);
        if (fits && name[0] != '.') {
            files[*count] =
                (struct file){.used = status.st_mtime, .bytes = (uint64_t)status.st_size};
            memcpy(files[*count].name, name, strlen(name) + 1);
            *bytes += files[(*count)++].bytes;
        }
        free(list[i]);
    }
    free(list);
    return files;
}

static uint64_t most_bytes(void)
{
    const char *text = getenv("DIPTYCH_CACHE_MIB");
    char *end = NULL;
    unsigned long value = text ? strtoul(text, &end, 10) : 0;
    bool valid = text && end > text && !*end && value <= MOST_MIB;
    return (uint64_t)(valid ? value : DEFAULT_MIB) << 20;
}

/* Above the limit, removes least recently used entries down to three quarters of the limit: then
 * the next entries need no removal. */
static void remove_old(const struct cache *cache)
{
    size_t count = 0;
    uint64_t bytes = 0, most = most_bytes();
    struct file *files = list_files(cache->folder, &count, &bytes);
    if (files && bytes > most) {
        qsort(files, count, sizeof *files, oldest_first);
        for (size_t i = 0; i < count && bytes > most / 4 * 3; i++)
            if (!unlinkat(cache->folder, files[i].name, 0))
                bytes -= files[i].bytes;
    }
    free(files);
}

/* ---- Open and close -------------------------------------------------------------------------- */

static int open_folder(const char *folder, const char **problem)
{
    struct stat status;
    if (mkdir(folder, 0700) && errno != EEXIST) {
        *problem = strerror(errno);
        return -1;
    }
    int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0 || fstat(file, &status))
        *problem = strerror(errno);
    else if (status.st_uid != geteuid())
        *problem = "another user owns the folder";
    else if (status.st_mode & (S_IWGRP | S_IWOTH))
        *problem = "other users may write to the folder";
    else
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

struct cache *cache_open(const char *folder, struct diag *diag)
{
    static bool warned;
    const char *problem = NULL;
    struct cache *cache = folder ? calloc(1, sizeof *cache) : NULL;
    if (!cache)
        return NULL;
    cache->folder = open_folder(folder, &problem);
    if (cache->folder >= 0)
        return cache;
    if (!warned)
        diag_warning(diag, (struct loc){0}, "%s: not used as a cache: %s", folder, problem);
    warned = true;
    free(cache);
    return NULL;
}

void cache_close(struct cache *cache)
{
    if (!cache)
        return;
    if (cache->added)
        remove_old(cache);
    close(cache->folder);
    free(cache);
}
