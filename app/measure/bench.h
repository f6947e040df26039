/* What the files of `diptych bench` share: lanes, which run frames turn by turn, and what they
 * took. bench.c drives, bench_table.c and bench_json.c tell. */
#ifndef DIPTYCH_BENCH_H
#define DIPTYCH_BENCH_H

#include "base/spread.h"
#include "measure/bench_work.h"
#include "measure/limit.h"
#include "run/session.h"
#include "run/worker.h"

/* A pipeline and the options that it runs with: sizes, and warm-up and measured frames together. */
struct programme {
    struct pipeline pipeline;
    struct options options;
};

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
    struct lane machine;
};

/* What a device, or the CPU, can do: the best that was measured. */
struct ceiling {
    double bytes_per_ms, flops_per_ms; /* NAN: not measured */
};

struct bench {
    struct console *console;
    const struct options *options;
    uint32_t frames, warmup;
    struct sides sides;
    struct bench_side *list;           /* as many as there are sides */
    struct programme subject, machine; /* what is measured; templates/machine.yaml */
    struct scene scene;
    struct limits limits; /* of the subject */
    double *copy_ms;      /* by memcpy on the CPU, COPY_BYTES to and fro; frames values, owned */
    uint8_t *original;    /* 2 x COPY_BYTES, owned */
};

enum { COPY_BYTES = 32 << 20 };

/* Milliseconds of one pass. */
struct spread bench_pass_ms(const struct lane *lane, uint32_t pass);

struct work bench_work(const struct bench *bench, const struct programme *programme, uint32_t pass);
struct ceiling bench_ceiling(const struct bench *bench, const struct bench_side *side);
double bench_copy_bytes_per_ms(const struct bench *bench); /* of the CPU */

/* The pass in plain C, or NULL. */
const struct limit_pass *bench_limit(const struct bench *bench, uint32_t pass);
/* How many times as long as the plain C, frame by frame; and the ratio of both medians. */
struct spread bench_limit_ratio(const struct bench *bench, const struct bench_side *side,
                                const struct limit_pass *limit, double *of_medians);

/* How long a pass has to take at the least, by what the device can do. */
double bench_floor_ms(const struct work *work, const struct ceiling *ceiling);

void bench_print(const struct bench *bench);         /* on stdout */
struct cJSON *bench_json(const struct bench *bench); /* for --json */

#endif
