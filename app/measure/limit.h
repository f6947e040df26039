/* Plain C versions of passes, named by `limit` in the spec: compiled for this processor, run on the
 * inputs of the pass's shader, checked against its results, and timed. Called by bench.c; see
 * templates/c/limit.h for the C side. */
#ifndef DIPTYCH_LIMIT_RUN_H
#define DIPTYCH_LIMIT_RUN_H

#include "run/session.h"
#include "templates/c/limit.h"

/* One pass that has such a file. */
struct limit_pass {
    uint32_t pass;
    void (*run)(const struct dt_limit *limit);
    const struct dt_limit_tolerance *tolerance;
    struct dt_frame frame;
    struct dt_bytes *inputs, *outputs, *expected; /* by resource, owned; see struct dt_limit */
    const void *live;
    const struct dt_scene *scene;
    double outliers; /* share of numbers that differ from the shader's by more than the tolerance */
    double *ms;      /* one per measured frame; owned */
};

struct limits {
    void *object; /* of dlopen; NULL: none */
    const struct dt_pipeline *info;
    struct limit_pass *list;
    uint32_t count;
};

/* Compiles and loads the files that the pipeline names, if any. A file without code for this
 * processor is left out with a message. On false the error is logged; limits_close either way. */
bool limits_open(struct limits *limits, struct console *console, const struct pipeline *pipeline,
                 uint32_t frames);

/* Reads inputs and results of the passes from the first frame of one backend, in a process of its
 * own, and checks the C against them. */
bool limits_check(struct limits *limits, const struct session_info *session);

/* Runs one pass and stores its time at index `at`. */
void limit_time(struct limit_pass *limit, uint32_t at);
void limits_close(struct limits *limits); /* takes a zeroed one */

#endif
