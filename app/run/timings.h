/* Milliseconds per pass over several frames. */
#pragma once

#include <cjson/cJSON.h>

#include "run/session.h"

struct timings {
    uint32_t passes;
    uint32_t frames;  /* taken so far */
    double *pass_ms;  /* frames x passes, NAN for a skipped pass; owned */
    double *frame_ms; /* from the call to the finished frame, by the host's clock; owned */
};

bool timings_create(struct timings *timings, uint32_t passes, uint32_t max_frames,
                    const struct dt_log *log);
bool timings_take(struct timings *timings, const struct session *session, double frame_ms);
void timings_free(struct timings *timings);

/* Medians, as {"backend", "device", "software", "pipeline", "scene", "width", "height", "frames",
 * "frame_ms", "sum_ms", "passes": [{"pass", "ms"}]}; a pass that never ran has null. */
bool timings_write(const struct timings *timings, const struct session *session, const char *path);
