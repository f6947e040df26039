/* What is run, on what: the part of a verb's options that the rooms below the verbs take. A library's
 * player fills one itself. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/command.h"

/* Strings are the caller's. */
struct setup {
    const char *spec;      /* NULL: the project's own */
    const char *templates; /* folder of the GLSL library; NULL: the project's */
    const char *root;      /* no option: the folder of a replay, which reads no file outside */
    union {                /* two names of one list: the table of options stores text_list */
        struct text_list set_list;
        struct {
            const char **sets; /* NAME=VALUE each */
            uint32_t set_count;
        };
    };
    struct text_list inputs; /* NAME=FILE each */
    bool exact_twin;         /* no option: every pass exact, for comparison with one that is not */
    bool for_gpu;            /* no option: `target: auto` is planned for GPUs alone */
    bool inputs_later;       /* no option: of a player, which gets inputs after inputs_load */
    const char *scene;
    const char *motion;  /* file; NULL: nothing moves */
    const char *scenes;  /* folder of meshes; NULL: DIPTYCH_SCENES or none */
    uint32_t size[2];    /* this and frames: 0 with --against where not given */
    bool default_size;   /* size is the default, which an input may replace */
    uint32_t frames;     /* 0 with --motion where not given: all of it */
    const char *backend; /* see side.h */
    const char *device;
    const char *context;
    bool glsl;            /* OpenGL takes text */
    bool debug;           /* validation layers */
    const char *sanitize; /* kinds to look for, "" for all; NULL: none */
    const char *against;  /* folder of a dump */
    const char *capture;
};

/* Whether --set or --with gives the path a value. */
static inline bool setup_sets(const struct setup *setup, const char *path)
{
    size_t length = strlen(path);
    for (uint32_t i = 0; i < setup->set_count; i++)
        if (strncmp(setup->sets[i], path, length) == 0 && setup->sets[i][length] == '=')
            return true;
    return false;
}
