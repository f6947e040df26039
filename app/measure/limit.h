/* Passes in plain C: what a spec's `limit` names, compiled for this processor, fed with what the
 * pass's shader reads, checked against what it writes, and timed. Called by bench.c; templates/c/limit.h
 * says what such a file holds. */
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
    double outliers; /* share of numbers that differ from the shader's beyond the tolerance */
    double *ms;      /* one per measured frame; owned */
};

struct limits {
    void *object; /* of dlopen; NULL: none */
    const struct dt_pipeline *info;
    struct limit_pass *list;
    uint32_t count;
};

/* Compiles and loads what the pipeline names, if anything; a file that has nothing for this processor
 * is told and left out. On false the error is logged; limits_close either way. */
bool limits_open(struct limits *limits, struct console *console, const struct pipeline *pipeline,
                 uint32_t frames);

/* Reads inputs and results of the passes from the first frame of one backend, in a process of its own,
 * and checks what the C makes of the inputs. */
bool limits_check(struct limits *limits, const struct session_info *session);

/* Runs one of them and keeps what it took as number `at`. */
void limit_time(struct limit_pass *limit, uint32_t at);
void limits_close(struct limits *limits); /* takes a zeroed one */

#endif
