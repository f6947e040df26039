/* Data in a folder, one file each, found by the hash of what they are made from. See cache.c. */
#pragma once

#include "base/diag.h"

#include <stddef.h>
#include <stdint.h>

struct cache;

/* Opens the folder; makes it when it is missing. NULL: the folder is NULL, or cannot be used, for
 * example because others may write to it; the first such folder of a process is a warning. */
struct cache *cache_open(const char *folder, struct diag *diag);
/* If entries were added, removes the least recently used ones above DIPTYCH_CACHE_MIB (environment;
 * default: 64). Accepts NULL. */
void cache_close(struct cache *cache);

/* ending: of the file's name, for its kind. *words: free(). False: no entry, or a damaged one; hash[1] is 0, or no
 * cache. One thread at a time. */
bool cache_find(struct cache *cache, const uint64_t hash[2], const char *ending, uint32_t **words,
                size_t *count);
/* Adds an entry. Failures are ignored: the cache is optional. */
void cache_add(struct cache *cache, const uint64_t hash[2], const char *ending,
               const uint32_t *words, size_t count);
