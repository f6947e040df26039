/* A preloaded library that makes one call fail, or kills the process at that call. FAIL_CALL=name:N
 * chooses the N-th call of malloc, calloc, realloc, open, read, write (and fwrite), rename or mmap.
 * With FAIL_KILL the process gets SIGKILL before the call. With FAIL_UNDER=FOLDER, calls of open
 * and rename count only with a path in FOLDER, since libraries abort where they cannot open their
 * own files. With FAIL_OWN, only calls by the program itself count, also through libc (strdup).
 * With FAIL_COUNT=FILE the library writes the number of calls of each name at exit. A crash or an
 * abort prints the stack and "stopped in OBJECT", the innermost object that is no system library.
 * For failing.py. */
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
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
static bool kills, begun, own;
static int (*real_main)(int, char **, char **);
static const char *under = "";

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);

struct range {
    uintptr_t begin, end;
};
static struct range program, libc;

static int find_range(struct dl_phdr_info *info, size_t size, void *unused)
{
    (void)size, (void)unused;
    struct range *range = !*info->dlpi_name                     ? &program
                          : strstr(info->dlpi_name, "/libc.so") ? &libc
                                                                : NULL;
    for (int i = 0; range && i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *header = &info->dlpi_phdr[i];
        if (header->p_type == PT_LOAD && header->p_flags & PF_X)
            *range = (struct range){info->dlpi_addr + header->p_vaddr,
                                    info->dlpi_addr + header->p_vaddr + header->p_memsz};
    }
    return 0;
}

static bool lies_in(const void *address, struct range range)
{
    return (uintptr_t)address >= range.begin && (uintptr_t)address < range.end;
}

/* Whether the program itself made the call, directly or through libc. */
static bool is_own(const void *caller)
{
    static _Thread_local bool inside;
    void *frames[16];
    if (inside || !lies_in(caller, libc))
        return lies_in(caller, program);
    inside = true; /* backtrace calls malloc */
    int count = backtrace(frames, 16);
    inside = false;
    int i = 0;
    while (i < count && frames[i] != caller)
        i++;
    while (i < count && lies_in(frames[i], libc))
        i++;
    return i < count && lies_in(frames[i], program);
}

static bool is_system(const char *path)
{
    static const char *const names[] = {"/failing.so",  "/libc.so",  "/libstdc++.so",
                                        "/libgcc_s.so", "/ld-linux", "linux-vdso"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strstr(path, names[i]))
            return true;
    return false;
}

static void say(const char *text)
{
    if (write(STDERR_FILENO, text, strlen(text)) < 0)
        _exit(EXIT_FAILURE);
}

/* Prints a line with the innermost object that is no system library. */
static void tell_object(const char *what, void *const *frames, int count)
{
    Dl_info info = {.dli_fname = "?"};
    for (int i = 0; i < count && dladdr(frames[i], &info) && is_system(info.dli_fname);)
        i++;
    say(what);
    say(info.dli_fname ? info.dli_fname : "?");
    say("\n");
}

static void tell_stop(int signal)
{
    void *frames[64];
    int count = backtrace(frames, 64);
    backtrace_symbols_fd(frames, count, STDERR_FILENO);
    tell_object("stopped in ", frames, count);
    raise(signal);
}

__attribute__((constructor)) static void start(void)
{
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGABRT};
    void *frame;
    backtrace(&frame, 1); /* the first call loads a library */
    dl_iterate_phdr(find_range, NULL);
    struct sigaction action = {.sa_handler = tell_stop, .sa_flags = SA_RESETHAND | SA_NODEFER};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        sigaction(signals[i], &action, NULL);
    own = getenv("FAIL_OWN");
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

/* caller: the address that the intercepted function returns to */
static bool fails(enum call call, const void *caller)
{
    if (!begun || (own && !is_own(caller)) || atomic_fetch_add(&counts[call], 1) + 1 != number ||
        call != chosen)
        return false;
    if (kills)
        kill(getpid(), SIGKILL);
    void *frames[16];
    tell_object("failed in ", frames, backtrace(frames, 16));
    errno = errors[call];
    return true;
}

static bool fails_at(enum call call, const char *path, const void *caller)
{
    return !strncmp(path, under, strlen(under)) && fails(call, caller);
}

#define CALLER __builtin_return_address(0)

static void *next(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

void *malloc(size_t size)
{
    return fails(MALLOC, CALLER) ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails(CALLOC, CALLER) ? NULL : __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size)
{
    return fails(REALLOC, CALLER) ? NULL : __libc_realloc(memory, size);
}

/* Calls before main are not counted: the program cannot handle their failure. */
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
        return fails_at(OPEN, path, CALLER) ? -1 : real(path, flags, mode);                        \
    }
OPENS(open)
OPENS(open64)

#define FOPENS(name)                                                                               \
    FILE *name(const char *restrict path, const char *restrict mode)                               \
    {                                                                                              \
        static FILE *(*real)(const char *, const char *);                                          \
        if (!real)                                                                                 \
            real = (FILE * (*)(const char *, const char *)) next(#name);                           \
        return fails_at(OPEN, path, CALLER) ? NULL : real(path, mode);                             \
    }
FOPENS(fopen)
FOPENS(fopen64)

ssize_t read(int file, void *bytes, size_t size)
{
    static ssize_t (*real)(int, void *, size_t);
    if (!real)
        real = (ssize_t(*)(int, void *, size_t))next("read");
    return fails(READ, CALLER) ? -1 : real(file, bytes, size);
}

ssize_t write(int file, const void *bytes, size_t size)
{
    static ssize_t (*real)(int, const void *, size_t);
    if (!real)
        real = (ssize_t(*)(int, const void *, size_t))next("write");
    return file > STDERR_FILENO && fails(WRITE, CALLER) ? -1 : real(file, bytes, size);
}

size_t fwrite(const void *restrict bytes, size_t size, size_t count, FILE *restrict stream)
{
    static size_t (*real)(const void *, size_t, size_t, FILE *);
    if (!real)
        real = (size_t(*)(const void *, size_t, size_t, FILE *))next("fwrite");
    return fileno(stream) > STDERR_FILENO && fails(WRITE, CALLER)
               ? 0
               : real(bytes, size, count, stream);
}

int rename(const char *from, const char *to)
{
    static int (*real)(const char *, const char *);
    if (!real)
        real = (int (*)(const char *, const char *))next("rename");
    return fails_at(RENAME, to, CALLER) ? -1 : real(from, to);
}

#define MMAPS(name)                                                                                \
    void *name(void *address, size_t size, int protection, int flags, int file, off_t offset)      \
    {                                                                                              \
        static void *(*real)(void *, size_t, int, int, int, off_t);                                \
        if (!real)                                                                                 \
            real = (void *(*)(void *, size_t, int, int, int, off_t))next(#name);                   \
        return fails(MMAP, CALLER) ? MAP_FAILED                                                    \
                                   : real(address, size, protection, flags, file, offset);         \
    }
MMAPS(mmap)
MMAPS(mmap64)
