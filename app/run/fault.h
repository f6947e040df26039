/* Fault injection: `--fault SIDE:PASS:KIND[:SEED][@FRAME]` changes the result of one pass on one
 * side, to test that compare finds it. The verbs read the option, the session injects the fault. */
#ifndef DIPTYCH_FAULT_H
#define DIPTYCH_FAULT_H

#include "diptych.h"

enum fault_kind {
    FAULT_NONE,
    FAULT_BIT,   /* flips the lowest bit of one number */
    FAULT_TEXEL, /* every number of one texel or element becomes 0, or 1 where it is 0 */
    /* negates one number; numbers without a sign are complemented. Of arguments and indices of
     * draws, only the lowest bit flips. */
    FAULT_SIGN,
    /* skips the pass, clears included; arguments and indices of draws become 0 */
    FAULT_MISSING
};

/* Zeroed: no fault. */
struct fault {
    enum fault_kind kind;
    uint32_t pass;
    uint32_t first_frame; /* first frame with the fault; all later ones have it, too */
    uint64_t seed;        /* selects one of the numbers that the pass writes */
};

/* Reads --fault. SIDE is one of `labels`, *side its index; SEED defaults to 1, FRAME to 0. For a
 * pass that `when` skips, the fault goes into what the skip clears. */
bool fault_parse(struct fault *fault, uint32_t *side, const char *text,
                 const struct dt_pipeline *pipeline, const char *const *labels,
                 uint32_t label_count, const struct dt_log *log);

/* State of one frame with a fault. All pointers are borrowed. */
struct fault_run {
    const struct fault *fault;
    const struct dt_runtime *runtime;
    void *handle;
    const struct dt_pipeline *pipeline;
    const struct dt_log *log;           /* gets the place, and the bits before and after */
    const struct dt_observer *observer; /* sees the frame with its fault; or NULL */
    uint32_t size[2];                   /* of the frame */
    uint32_t frame;
    bool skipped; /* the observer skipped the pass: no fault */
};

/* The observer to render that frame with; `run` must live as long. */
struct dt_observer fault_observer(struct fault_run *run);

#endif
