/* Faults put in on purpose: `--fault SIDE:PASS:KIND[:SEED][@FRAME]` spoils what one pass of one
 * side leaves behind, so that a compare can be seen to find it. Options are read by the verbs, the
 * fault is put in by the session. */
#ifndef DIPTYCH_FAULT_H
#define DIPTYCH_FAULT_H

#include "diptych.h"

enum fault_kind {
    FAULT_NONE,
    FAULT_BIT,   /* the lowest bit of one number is the other one */
    FAULT_TEXEL, /* every number of one texel or element becomes 0, or 1 where it is 0 */
    /* one number has the other sign; numbers without one become their complement, but for arguments and
     * indices of draws, whose lowest bit is the other one */
    FAULT_SIGN,
    /* the pass does nothing: neither work nor clears; arguments and indices of draws become 0 */
    FAULT_MISSING
};

/* Zeroed: no fault. */
struct fault {
    enum fault_kind kind;
    uint32_t pass;
    uint32_t first_frame; /* with the fault; all later ones have it, too */
    uint64_t seed;        /* chooses one of all the numbers that the pass writes */
};

/* Reads --fault. SIDE is one of `labels`, *side becomes its index; SEED is 1 and FRAME 0 by default.
 * A pass that `when` skips is spoilt in what the skipping has cleared. */
bool fault_parse(struct fault *fault, uint32_t *side, const char *text,
                 const struct dt_pipeline *pipeline, const char *const *labels,
                 uint32_t label_count, const struct dt_log *log);

/* One frame that is to have the fault. All pointers are borrowed. */
struct fault_run {
    const struct fault *fault;
    const struct dt_runtime *runtime;
    void *handle;
    const struct dt_pipeline *pipeline;
    const struct dt_log *log;           /* is told the place, and the bits before and after */
    const struct dt_observer *observer; /* sees the frame with its fault; or NULL */
    uint32_t size[2];                   /* of the frame */
    uint32_t frame;
    bool skipped; /* the pass was skipped on the observer's behalf: it has nothing to spoil */
};

/* The observer to render that frame with; `run` must live as long. */
struct dt_observer fault_observer(struct fault_run *run);

#endif
