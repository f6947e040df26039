/* An allocator for what lives and ends together: blocks, freed at once. */
#pragma once

#include <stddef.h>

struct arena;
/* Zeroed, aligned to 16. NULL: out of memory, for which memory_lost was called. */
void *arena_alloc(struct arena *arena, size_t size);
char *arena_printf(struct arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
char *arena_strndup(struct arena *arena, const char *text, size_t length);
struct arena *arena_create(void);
void arena_free(struct arena *arena);
