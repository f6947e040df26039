/* Which pass is to blame for a difference. In a second run the second side gets, before every pass,
 * the inputs that the first side had: what it then writes differently is the pass's own error, the
 * rest was inherited. Called by compare once two sides differ. */
#ifndef DIPTYCH_BLAME_H
#define DIPTYCH_BLAME_H

#include "result/difference.h"
#include "run/source.h"

/* One frame of one pair, to be run again. */
struct replay {
    struct console *console;
    const struct rows *rows;
    struct worker_info workers[2]; /* as in the first run; frames and stops are set here */
    struct dump_reader *dump;      /* the first side, if it is one */
    uint32_t frame;
};

/* What a replay shows; callbacks may be NULL and return false, with the error logged, to end it.
 * Bytes are borrowed for the call. */
struct replay_viewer {
    /* a row of rows->inputs as the first side had it; the second gets it before the pass */
    bool (*input)(void *user, const struct row *row, const struct dt_bytes *bytes);
    /* row `index` of rows->outputs as the first side left it, and as the second made it of the same
     * inputs */
    bool (*output)(void *user, uint32_t index, const struct dt_bytes copies[2]);
    void *user;
};

/* Every pass of the frame, one after the other. False when it could not be run, with the error
 * logged. */
bool replay_run(const struct replay *replay, const struct replay_viewer *viewer);

/* A hash of all declared numbers in a resource; sets the padding between them to zero. False when
 * out of memory. */
bool fingerprint(const struct dt_resource *resource, struct dt_bytes *bytes, uint64_t *hash);

/* What the first run saw in that frame. */
struct first_run {
    uint32_t broken_row;          /* the first that broke its contract, of outputs, */
    bool early;                   /* or of history: when the frame began */
    const bool *outputs_differ;   /* per row of outputs: not bit for bit equal */
    const bool *history_differs;  /* per row of history, when the frame began */
    const uint64_t *fingerprints; /* of outputs on the first side */
};

enum blame_outcome {
    BLAME_NOT_RUN,
    BLAME_GUILTY,         /* `row` is the first with an own error beyond its contract */
    BLAME_INHERITED,      /* the errors of several passes add up, none is beyond by itself */
    BLAME_EARLIER,        /* what the frame found of earlier ones differs: `row` of history */
    BLAME_NOT_REPEATABLE, /* `side` wrote another content of `row` when it ran again */
};

struct blame {
    enum blame_outcome outcome;
    uint32_t frame;          /* that was run again */
    uint32_t row;            /* of outputs where nothing else is said */
    const struct side *side; /* BLAME_NOT_REPEATABLE */
    bool *inputs_differ;     /* per pass, in the first run */
    struct difference *own;  /* per row of outputs: the pass's own error */
};

/* False when it could not be found out, with the error logged; blame_free either way. */
bool blame_find(struct blame *blame, const struct replay *replay, const struct first_run *first);
void blame_free(struct blame *blame); /* takes a zeroed one */

#endif
