/* One side of a comparison: backend, driver and device, or a dump, from --backend, --against and
 * the options that refine them. */
#pragma once

#include "console/setup.h"
#include "console/console.h"

struct side {
    char *label;         /* as typed; used in messages, tables and JSON */
    char *text;          /* owns the strings below that are not literals */
    const char *backend; /* "gl" or "vk"; NULL: a dump */
    const char *context; /* gl: "egl" (NULL), "osmesa", "zink" or "window" */
    const char *device;  /* vk: part of a name, or index; NULL: the first */
    bool glsl;           /* gl: programs from GLSL text instead of SPIR-V */
    const char *folder;  /* folder of a dump; NULL: a live backend */
};

/* Reads one entry: `gl`, `vk`, `osmesa` or `zink`, with `+glsl` or `@DEVICE` where they apply.
 * --context, --glsl and --device set what the entry leaves open. On false the error is logged;
 * side_free either way. */
bool side_read(struct side *side, const char *entry, const struct setup *setup,
               const struct dt_log *log);
void side_free(struct side *side); /* takes a zeroed one */

/* False with the error logged when --device, --context or --glsl applies to none of these sides. */
bool sides_heed(const struct side *list, uint32_t count, const struct setup *setup,
                const struct dt_log *log);

/* The sides of a comparison; the first is compared with each of the others. --against, if given,
 * comes first, then the entries of --backend, by default "gl,vk". Labels are unique: repeated ones
 * get "#2", "#3". */
struct sides {
    struct side *list;
    uint32_t count; /* at least two */
};
bool sides_read(struct sides *sides, const struct setup *setup, const struct dt_log *log);

/* The sides of --backend, one or more, each on its own. */
bool sides_read_each(struct sides *sides, const struct setup *setup, const struct dt_log *log);
void sides_free(struct sides *sides); /* takes a zeroed one */
