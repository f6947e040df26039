/* The live parameters of a pipeline, in a block of dt_pipeline.live_size bytes: found by name,
 * written from text, read as numbers. */
#pragma once

#include "diptych.h"

/* The parameter of that name, live or not; NULL: the pipeline has none. */
const struct dt_param *live_param(const struct dt_pipeline *info, const char *name);

/* Writes a parameter into the block: `value` is a number, true, false, or [a, b, ...]; checked against
 * type and range. On false the error is logged and the block unchanged. */
bool live_set(const struct dt_pipeline *info, void *live, const struct dt_param *param,
              const char *value, const struct dt_log *log);
/* The values in the block; type_components of them, at most four. */
void live_get(const void *live, const struct dt_param *param, double values[4]);
