/* What the files of `diptych bench` share: lanes, which run frames turn by turn, and what they
 * took. bench.c drives, bench_table.c and bench_json.c tell. */
#ifndef DIPTYCH_BENCH_H
#define DIPTYCH_BENCH_H

#include "session.h"
#include "spread.h"
#include "worker.h"

/* A worker that runs frames of one pipeline, and what each of the measured frames took. */
struct lane {
    struct worker worker;
    const struct dt_pipeline *info;
    uint32_t taken;   /* frames so far, at most bench.frames */
    double *frame_ms; /* these four: one per frame; owned */
    double *record_ms;
    double *own_allocations, *all_allocations;
    double *pass_ms; /* frames x passes; owned, NULL without timestamps */
};

struct bench_side {
    const struct side *side;
    struct lane whole;  /* without timestamps, which can slow a frame down */
    struct lane passes; /* with them */
};

struct bench {
    struct console *console;
    struct options options; /* frames: warm-up and measured ones together */
    uint32_t frames, warmup;
    struct sides sides;
    struct bench_side *list; /* as many as there are sides */
    struct pipeline pipeline;
    struct scene scene;
};

/* Milliseconds of one pass. */
struct spread bench_pass_ms(const struct lane *lane, uint32_t pass);

void bench_print(const struct bench *bench);      /* on stdout */
bool bench_write_json(const struct bench *bench); /* to options.json; logs its error */

#endif
