/* What a GPU's compiler says of each pass, asked without the GPU: for `cost` and `tune`. Python computes what follows for
 * a frame, and prints: app/python/diptych/cost.py. */
#pragma once

#include <cjson/cJSON.h>

#include "console/options.h"
#include "scenes/scene.h"
#include "spec/pipeline.h"

/* ---- cost.c: bytes of a pass, estimated from the pipeline's reflection ------------------------- */

/* Inputs of the estimate. */
struct work_frame {
    const struct dt_pipeline *pipeline;
    uint32_t size[2];                   /* of the frame */
    uint32_t vertex_count, index_count; /* of the scene */
};

struct work {
    double read, written; /* bytes */
};

/* Counts every resource of the pass whole and once, and the vertices and indices of a scene that it
 * draws; textures count nothing. */
struct work work_of(const struct work_frame *frame, uint32_t index);

/* ---- cost_run.c ------------------------------------------------------------------------------ */

/* One of AMD's, whose constants are in cost.py. */
struct cost_chip {
    const char *name;   /* for --gpu */
    const char *family; /* names for RADV_FORCE_FAMILY, by its versions: with | between */
};
/* By name; logs the error. */
const struct cost_chip *cost_chip(const char *name, size_t length, const struct dt_log *log);

/* Compiles the pipeline in a child process: for a chip on RADV's null hardware; without one, for the
 * Vulkan device of that name, or the first. {"chip": its name, or null, "device", "driver", "stages": [{"pass", "stage", "subgroup",
 * "figures": {name that the driver gives: number}, "loops"}]}. A loop: {"turns": number, 0: not known, "around": number of the loop around
 * it, or its own}; if it counts, figures of a stage in which it is "kept", and "wrapped"; they compare with "inlined" of the stage. NULL:
 * logged. */
cJSON *cost_ask(const struct cost_chip *chip, const char *device, const struct pipeline *pipeline,
                struct console *console);
/* Whether RADV is installed; if not, logs it. */
bool cost_has_radv(const struct dt_log *log);
