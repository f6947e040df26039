/* How often memory is allocated, and by whom: the program's own malloc, calloc, realloc and their
 * kin count calls and hand them on to the C library. Called by worker.c around a frame. */
#ifndef DIPTYCH_ALLOCATIONS_H
#define DIPTYCH_ALLOCATIONS_H

#include <stdint.h>

struct allocations {
    uint64_t own; /* calls from this program and from the generated pipeline */
    uint64_t all; /* and from libraries and drivers, in all threads */
};

/* Counts until allocations_end, in all threads. `generated`: any address in the shared object of
 * the generated pipeline. Not to be nested. */
void allocations_begin(const void *generated);
struct allocations allocations_end(void);

#endif
