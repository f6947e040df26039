/* A preloaded library that makes one call fail or kills the process at it: FAIL_CALL=name:N, the N-th call
 * of malloc, calloc, realloc, open, read, write, rename or mmap; with FAIL_KILL set, SIGKILL before the
 * call. FAIL_UNDER=FOLDER: of open and rename, only calls with a path in there count, since libraries
 * abort where their own files cannot be opened. With FAIL_COUNT=FILE it writes the number of calls of each name at exit. For failing.py. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum call { MALLOC, CALLOC, REALLOC, OPEN, READ, WRITE, RENAME, MMAP, CALLS };
static const char *const names[CALLS] = {"malloc", "calloc", "realloc", "open",
                                         "read",   "write",  "rename",  "mmap"};
static const int errors[CALLS] = {ENOMEM, ENOMEM, ENOMEM, EMFILE, EIO, ENOSPC, EACCES, ENOMEM};
static atomic_ulong counts[CALLS];
static enum call chosen = CALLS;
static unsigned long number;
static bool kills, begun;
static int (*real_main)(int, char **, char **);
static const char *under = "";

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);

__attribute__((constructor)) static void start(void)
{
    const char *text = getenv("FAIL_CALL");
    kills = getenv("FAIL_KILL");
    under = getenv("FAIL_UNDER") ? getenv("FAIL_UNDER") : "";
    for (int i = 0; text && i < CALLS; i++) {
        size_t length = strlen(names[i]);
        if (!strncmp(text, names[i], length) && text[length] == ':') {
            chosen = (enum call)i;
            number = strtoul(text + length + 1, NULL, 10);
        }
    }
}

__attribute__((destructor)) static void stop(void)
{
    const char *path = getenv("FAIL_COUNT");
    FILE *file = path ? fopen(path, "w") : NULL;
    unsigned long totals[CALLS];
    for (int i = 0; i < CALLS; i++)
        totals[i] = counts[i];
    for (int i = 0; file && i < CALLS; i++)
        fprintf(file, "%s %lu\n", names[i], totals[i]);
    if (file)
        fclose(file);
}

static bool fails(enum call call)
{
    if (!begun || atomic_fetch_add(&counts[call], 1) + 1 != number || call != chosen)
        return false;
    if (kills)
        kill(getpid(), SIGKILL);
    errno = errors[call];
    return true;
}

static bool fails_at(enum call call, const char *path)
{
    return !strncmp(path, under, strlen(under)) && fails(call);
}

static void *next(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

void *malloc(size_t size)
{
    return fails(MALLOC) ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails(CALLOC) ? NULL : __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size)
{
    return fails(REALLOC) ? NULL : __libc_realloc(memory, size);
}

/* What libraries do before main counts for nothing: nobody can catch their errors there. */
static int counted_main(int count, char **arguments, char **environment)
{
    begun = true;
    return real_main(count, arguments, environment);
}

int __libc_start_main(int (*main)(int, char **, char **), int count, char **arguments,
                      void (*init)(void), void (*fini)(void), void (*loader_fini)(void),
                      void *stack_end)
{
    typedef int start_fn(int (*)(int, char **, char **), int, char **, void (*)(void),
                         void (*)(void), void (*)(void), void *);
    real_main = main;
    return ((start_fn *)next("__libc_start_main"))(counted_main, count, arguments, init, fini,
                                                   loader_fini, stack_end);
}

#define OPENS(name)                                                                                \
    int name(const char *path, int flags, ...)                                                     \
    {                                                                                              \
        static int (*real)(const char *, int, ...);                                                \
        va_list list;                                                                              \
        va_start(list, flags);                                                                     \
        mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(list, mode_t) : 0;                    \
        va_end(list);                                                                              \
        if (!real)                                                                                 \
            real = (int (*)(const char *, int, ...))next(#name);                                   \
        return fails_at(OPEN, path) ? -1 : real(path, flags, mode);                                \
    }
OPENS(open)
OPENS(open64)

#define FOPENS(name)                                                                               \
    FILE *name(const char *restrict path, const char *restrict mode)                               \
    {                                                                                              \
        static FILE *(*real)(const char *, const char *);                                          \
        if (!real)                                                                                 \
            real = (FILE * (*)(const char *, const char *)) next(#name);                           \
        return fails_at(OPEN, path) ? NULL : real(path, mode);                                     \
    }
FOPENS(fopen)
FOPENS(fopen64)

ssize_t read(int file, void *bytes, size_t size)
{
    static ssize_t (*real)(int, void *, size_t);
    if (!real)
        real = (ssize_t(*)(int, void *, size_t))next("read");
    return fails(READ) ? -1 : real(file, bytes, size);
}

ssize_t write(int file, const void *bytes, size_t size)
{
    static ssize_t (*real)(int, const void *, size_t);
    if (!real)
        real = (ssize_t(*)(int, const void *, size_t))next("write");
    return file > STDERR_FILENO && fails(WRITE) ? -1 : real(file, bytes, size);
}

int rename(const char *from, const char *to)
{
    static int (*real)(const char *, const char *);
    if (!real)
        real = (int (*)(const char *, const char *))next("rename");
    return fails_at(RENAME, to) ? -1 : real(from, to);
}

#define MMAPS(name)                                                                                \
    void *name(void *address, size_t size, int protection, int flags, int file, off_t offset)      \
    {                                                                                              \
        static void *(*real)(void *, size_t, int, int, int, off_t);                                \
        if (!real)                                                                                 \
            real = (void *(*)(void *, size_t, int, int, int, off_t))next(#name);                   \
        return fails(MMAP) ? MAP_FAILED : real(address, size, protection, flags, file, offset);    \
    }
MMAPS(mmap)
MMAPS(mmap64)
