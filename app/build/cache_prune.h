/* The size of the cache: what was not used for longest goes, but nothing that a process holds. Called by
 * cache.c. */
#ifndef DIPTYCH_CACHE_PRUNE_H
#define DIPTYCH_CACHE_PRUNE_H

#include <dirent.h>
#include <stdbool.h>

#define CACHE_SHADERS ".shaders" /* behind 16 digits: files with compiled shaders, diptych-gen's */

/* Marks the folder of one version as used now, and keeps it until closedir, in this process and its
 * children. NULL when it is not there, any more. */
DIR *cache_hold(const char *version);

/* Removes versions and files of shaders from the cache in `base` until it is within DIPTYCH_CACHE_MIB, 512 unless that is
 * set. Silent: what cannot be removed stays. */
void cache_prune(const char *base);

#endif
