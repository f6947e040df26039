/* Counting allocations; see allocations.h. A program that defines malloc takes it over for all its
 * libraries. The caller is known by the address that the call returns to. */
#include "run/allocations.h"

#include <errno.h>
#include <link.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

static struct {
    atomic_bool active;
    atomic_uint_least64_t own, all;
    /* where the program and the generated pipeline lie */
    uintptr_t program[2], pipeline[2];
} counter;

/* ---- The C library's functions, and what stands before them ---------------------------------- */

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static bool is_within(const uintptr_t range[2], uintptr_t address)
{
    return address >= range[0] && address < range[1];
}

static void count(const void *caller)
{
    if (!atomic_load_explicit(&counter.active, memory_order_relaxed))
        return;
    uintptr_t address = (uintptr_t)caller;
    atomic_fetch_add_explicit(&counter.all, 1, memory_order_relaxed);
    if (is_within(counter.program, address) || is_within(counter.pipeline, address))
        atomic_fetch_add_explicit(&counter.own, 1, memory_order_relaxed);
}

void *malloc(size_t size)
{
    count(__builtin_return_address(0));
    return __libc_malloc(size);
}

void *calloc(size_t items, size_t size)
{
    count(__builtin_return_address(0));
    return __libc_calloc(items, size);
}

void *realloc(void *memory, size_t size)
{
    count(__builtin_return_address(0));
    return __libc_realloc(memory, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    count(__builtin_return_address(0));
    return __libc_memalign(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
    count(__builtin_return_address(0));
    if (alignment % sizeof(void *) || !alignment || (alignment & (alignment - 1)))
        return EINVAL;
    void *given = __libc_memalign(alignment, size);
    if (!given)
        return ENOMEM;
    *memory = given;
    return 0;
}

/* ---- Counting -------------------------------------------------------------------------------- */

/* The addresses of the object that holds one of the two addresses that are looked for. */
static int find_object(struct dl_phdr_info *info, size_t size, void *user)
{
    const void *const *wanted = user;
    uintptr_t *found[2] = {counter.program, counter.pipeline};
    uintptr_t range[2] = {UINTPTR_MAX, 0};
    (void)size;
    for (int i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *part = &info->dlpi_phdr[i];
        uintptr_t start = info->dlpi_addr + part->p_vaddr;
        if (part->p_type != PT_LOAD)
            continue;
        range[0] = start < range[0] ? start : range[0];
        range[1] = start + part->p_memsz > range[1] ? start + part->p_memsz : range[1];
    }
    for (int i = 0; i < 2; i++) {
        uintptr_t address = (uintptr_t)wanted[i];
        if (address >= range[0] && address < range[1]) {
            found[i][0] = range[0];
            found[i][1] = range[1];
        }
    }
    return 0;
}

void allocations_begin(const void *generated)
{
    const void *wanted[2] = {&counter, generated};
    dl_iterate_phdr(find_object, wanted);
    atomic_store(&counter.own, 0);
    atomic_store(&counter.all, 0);
    atomic_store(&counter.active, true);
}

struct allocations allocations_end(void)
{
    atomic_store(&counter.active, false);
    return (struct allocations){.own = atomic_load(&counter.own), .all = atomic_load(&counter.all)};
}
