/* Shared by the files of `diptych cost`: what a GPU's compiler says of each pass, and what follows for a frame by
 * arithmetic. cost_chips.c has the constants of chips, cost_run.c asks the compiler, cost_frame.c
 * counts and computes, cost_print.c and cost_json.c report. */
#pragma once

#include <cjson/cJSON.h>

#include "console/options.h"
#include "scenes/scene.h"
#include "spec/pipeline.h"

/* ---- cost_chips.c ---------------------------------------------------------------------------- */

struct cost_chip {
    const char *name;    /* for --gpu */
    const char *family;  /* names for RADV_FORCE_FAMILY, by its versions: with | between */
    const char *product; /* whose clock and memory these are */
    double simds, ghz;
    double gb_s;               /* of memory, 1e9 bytes per second */
    double code_kib;           /* instruction cache */
    double vgprs, granularity; /* of a SIMD for waves of 64; registers are given in such steps */
    double most_waves;         /* of a SIMD, as RADV counts them */
    double group_simds;        /* SIMDs that share a workgroup and its LDS */
};
extern const struct cost_chip cost_chips[];
extern const uint32_t cost_chip_count;
/* By name; logs the error. */
const struct cost_chip *cost_chip(const char *name, size_t length, const struct dt_log *log);
/* The chip that a driver names in its device's name, or NULL. */
const struct cost_chip *cost_chip_of(const char *device);

/* ---- cost_run.c ------------------------------------------------------------------------------ */

enum cost_number {
    COST_VGPRS,
    COST_WAVES, /* of a SIMD, at most; RADV counts a wave of 64 on RDNA as two */
    COST_SPILLS,
    COST_SCRATCH, /* bytes */
    COST_CODE,    /* bytes */
    COST_LDS,     /* bytes */
    COST_INSTRUCTIONS,
    COST_CYCLES,  /* of a SIMD for each wave, if all its units are kept busy */
    COST_LATENCY, /* cycles from a wave's begin to its end */
    COST_NUMBERS
};
extern const char *const cost_names[COST_NUMBERS]; /* in the JSON */

/* A compiled stage. */
struct cost_stage {
    uint32_t pass;
    const char *stage;            /* "compute", "vertex" or "fragment" */
    uint32_t subgroup;            /* invocations of a wave */
    double numbers[COST_NUMBERS]; /* NAN: the driver does not tell */
};

struct cost_gpu {
    const struct cost_chip *chip; /* NULL: not in the table */
    char device[256], driver[520];
    struct cost_stage *stages; /* in order of passes; owned */
    uint32_t count;
    double *measured; /* ms by pass, from cost_measured; NAN: none; NULL: not asked; owned */
};

/* Compiles the pipeline in a child process: for a chip on RADV's null hardware; without one, for the
 * Vulkan device of that name, or the first. Logs its error. cost_gpu_free in any case. */
bool cost_ask(struct cost_gpu *gpu, const struct cost_chip *chip, const char *device,
              const struct pipeline *pipeline, struct console *console);
void cost_gpu_free(struct cost_gpu *gpu);
/* Whether RADV is installed; if not, logs it. */
bool cost_has_radv(const struct dt_log *log);

/* ---- cost_frame.c ---------------------------------------------------------------------------- */

/* How much a pass runs in one frame, as the plan says. */
struct cost_work {
    bool runs;
    bool open; /* arguments that a shader writes: counts of vertices or groups are not known */
    uint64_t groups;   /* workgroups of a dispatch */
    uint32_t local;    /* their invocations */
    uint64_t vertices; /* each index once */
    uint64_t pixels;   /* of the draw's area and all layers, each once */
    double bytes;      /* that it reads and writes, each once */
};

struct cost_frame {
    const struct pipeline *pipeline;
    uint32_t size[2];
    struct cost_work *passes; /* owned */
};
/* Without a scene (NULL) its draws are open. False: out of memory, logged. */
bool cost_count(struct cost_frame *frame, const struct pipeline *pipeline,
                const struct scene *scene, const uint32_t size[2], const struct dt_log *log);

/* Waves that a stage starts in a frame; NAN: not known. */
double cost_waves(const struct cost_work *work, const struct cost_stage *stage);

/* What keeps the waves of a SIMD below their number: "registers", "LDS", "group", or "". */
const char *cost_limit(const struct cost_chip *chip, const struct cost_work *work,
                       const struct cost_stage *stage);

/* Milliseconds of a pass, all lower bounds; NAN: not known. */
struct cost_times {
    double arithmetic; /* all its waves, SIMDs kept busy */
    double latency;    /* of one wave of each stage */
    double memory;     /* bytes at the memory's rate */
    double bound;      /* the largest */
};
struct cost_times cost_times(const struct cost_gpu *gpu, const struct cost_frame *frame,
                             uint32_t pass);

/* Sums over a frame. */
struct cost_sums {
    double bound;   /* ms of all passes with a known count */
    double pixel;   /* ms of arithmetic of those that run for every pixel of the frame */
    double latency; /* ms of one wave, over the others */
    uint32_t open;  /* passes whose count is not known */
};
struct cost_sums cost_sums(const struct cost_gpu *gpu, const struct cost_frame *frame);

/* ---- cost_print.c, cost_json.c --------------------------------------------------------------- */

void cost_print(const struct cost_gpu *gpu, const struct cost_frame *frame); /* on stdout */
cJSON *cost_json(const struct cost_gpu *gpus, uint32_t count, const struct cost_frame *frame,
                 const struct setup *setup);
/* Of one pass: an array. */
cJSON *cost_stages_json(const struct cost_gpu *gpu, const struct cost_frame *frame, uint32_t pass);
/* Takes in the times that `bench --json` measured on this device, or on one with this chip. False: the
 * file has none, logged. */
bool cost_measured(struct cost_gpu *gpu, const struct dt_pipeline *info, const char *path,
                   const struct dt_log *log);
/* What has changed since an earlier --json, on stdout. `limit`: a growth that counts, 0.05: 5 %. *worse: passes
 * beyond it. False: the file is none, logged. */
bool cost_against(const cJSON *now, const char *path, double limit, uint32_t *worse,
                  const struct dt_log *log);
