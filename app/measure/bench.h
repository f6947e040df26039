/* Shared by the files of `diptych bench`: lanes, which run one frame per turn, and the times that
 * they measured. bench.c runs them; bench_table.c and bench_json.c report. */
#pragma once

#include "console/options.h"
#include "console/spread.h"
#include "measure/bench_work.h"
#include "run/session.h"
#include "run/worker.h"

/* A pipeline with its options; options.setup.frames counts warm-up and measured frames. */
struct programme {
    struct pipeline pipeline;
    struct options options;
};

/* A worker that runs frames of one pipeline, with the times of each measured frame. */
struct lane {
    struct worker worker;
    const struct dt_pipeline *info;
    uint32_t taken;   /* frames so far, at most bench.frames */
    double *frame_ms; /* these four: one per frame; owned */
    double *record_ms;
    double *pass_ms; /* frames x passes; owned, NULL without timestamps */
};

struct bench_side {
    const struct side *side;
    struct lane whole;  /* without timestamps, which can slow a frame down */
    struct lane passes; /* with them */
    struct lane machine;
};

/* Best measured rates of a device or the CPU. */
struct ceiling {
    double bytes_per_ms; /* NAN: not measured */
};

struct bench {
    struct console *console;
    const struct options *options;
    uint32_t frames, warmup;
    struct sides sides;
    struct bench_side *list;           /* as many as there are sides */
    struct programme subject, machine; /* to time; templates/machine.yaml */
    struct scene scene;
    double *copy_ms;   /* by memcpy on the CPU, COPY_BYTES to and fro; frames values, owned */
    uint8_t *original; /* 2 x COPY_BYTES, owned */
};

enum { COPY_BYTES = 32 << 20 };

/* A worker of a lane: started, run to the end of its next frame, whose times count if `taken`, and ended. programme->options.setup.frames
 * counts all its frames. Log their errors; lane_free in any case, also of a zeroed one. */
bool lane_start(struct lane *lane, struct bench *bench, const struct side *side,
                struct programme *programme, bool timing);
bool lane_advance(struct lane *lane, bool taken);
void lane_free(struct lane *lane);

/* Milliseconds of one pass. */
struct spread bench_pass_ms(const struct lane *lane, uint32_t pass);

struct work bench_work(const struct bench *bench, const struct programme *programme, uint32_t pass);
struct ceiling bench_ceiling(const struct bench *bench, const struct bench_side *side);
double bench_copy_bytes_per_ms(const struct bench *bench); /* of the CPU */

/* Lower bound of a pass's time, from the device's measured rates. */
double bench_floor_ms(const struct work *work, const struct ceiling *ceiling);

void bench_print(const struct bench *bench);                                 /* on stdout */
struct cJSON *bench_json(const struct bench *bench);                         /* for --json */
void bench_add_number(struct cJSON *parent, const char *name, double value); /* NAN: null */
