/* The cache of compiled pipelines. One folder per spec, overrides and generator; in it a stamp that
 * names the current version and the hash of every file that it was made from, and one folder per
 * version. Made in a temporary folder and renamed, so several processes may share it; kept within a
 * size (cache_prune.h). Called by pipeline.c. */
#ifndef DIPTYCH_CACHE_H
#define DIPTYCH_CACHE_H

#include <dirent.h>

#include "base/tool.h"

struct build_request {
    const char *headers[2]; /* folders with diptych.h and with the runtimes' headers */
    const char *tools;      /* folder that holds diptych-gen, the executable's own */
    const char *templates;  /* folder of the GLSL library, mostly the project's */
    const char *spec;       /* real path */
    const char **sets;      /* sorted */
    uint32_t set_count;
    struct tool_waiting *generator; /* prepared for this; NULL: none */
    bool edited;  /* it will be edited, so that little is to be compiled at an edit */
    bool hurried; /* somebody waits for what an edit does */
};

/* What was found or built; strings are owned, free with cache_entry_free. */
struct cache_entry {
    char
        *folder; /* of what was generated: gl/, vk/, and gen.d, which names what it was made from */
    char *object;                     /* path of the shared object in it */
    char *name;                       /* of the pipeline: prefix of its two symbols */
    DIR *held;                        /* the folder is not pruned until this is closed */
    double generator_ms, compiler_ms; /* what they took, 0: it was found */
};

/* Finds a version whose inputs are all unchanged, or builds it. */
bool cache_get(struct cache_entry *entry, const struct build_request *request,
               struct console *console);
void cache_entry_free(struct cache_entry *entry);

#endif
