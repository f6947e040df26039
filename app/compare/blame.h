/* Finds the pass that causes a difference. In a second run, the second side gets the first side's
 * inputs before every pass: whatever it then writes differently is the pass's own error; other
 * differences are inherited. */
#pragma once

#include "result/sheet.h"
#include "run/source.h"

/* One frame of one pair, to be run again. */
struct replay {
    struct console *console;
    const struct rows *rows;
    struct worker_info workers[2]; /* as in the first run; this file sets frames and stops */
    struct dump_reader *dump;      /* --against: takes the first side's place */
    uint32_t frame;
    bool strangers; /* the sides are drivers of different makers */
    bool alone;     /* this pass runs, and no other */
    uint32_t pass;
};

/* Callbacks of a replay; may be NULL. One that returns false, with the error logged, ends it. Bytes
 * are borrowed for the call. */
struct replay_viewer {
    /* a row of rows->inputs, the first side's; the second side gets it before the pass */
    bool (*input)(void *user, const struct row *row, const struct dt_bytes *bytes);
    /* Before a scene draw's outputs: the output that edges_resource names, or none; then that of
     * edges_depth, if any. */
    bool (*edges)(void *user, const struct dt_resource *resource, const struct dt_bytes copies[2]);
    bool (*edges_depth)(void *user, const struct dt_bytes copies[2]);
    /* row `index` of rows->outputs: the first side's, and the second side's from the same inputs */
    bool (*output)(void *user, uint32_t index, const struct dt_bytes copies[2]);
    /* the second side, when all passes have run */
    bool (*finished)(void *user, struct row_source *source);
    void *user;
};

/* Runs every pass of the frame, or one. False with the error logged. */
bool replay_run(const struct replay *replay, const struct replay_viewer *viewer);

/* Hash of all declared numbers of a resource; zeroes the padding. False when out of memory. */
bool fingerprint(const struct dt_resource *resource, struct dt_bytes *bytes, uint64_t *hash);

enum blame_outcome {
    BLAME_NOT_RUN,
    BLAME_GUILTY,         /* `row` is the first with an own error beyond its contract */
    BLAME_INHERITED,      /* errors of several passes add up; none breaks a contract alone */
    BLAME_EARLIER,        /* `row` of history differed before the frame */
    BLAME_WITHIN,         /* no pass breaks its contract, `raster` among them: the sides agree */
    BLAME_NOT_REPEATABLE, /* `side` wrote other content to `row` when it ran again */
};

struct blame {
    enum blame_outcome outcome;
    uint32_t frame;          /* the frame that ran again */
    struct sheet_row *row;   /* of the outputs, unless the outcome says otherwise */
    const struct side *side; /* BLAME_NOT_REPEATABLE */
    struct difference *own;  /* per row of outputs: the pass's own error; owned */
};

/* After a first run, whose sheet has rows of history, then of outputs, as the frame left them; `broken` was the first that
 * broke its contract. Fills `inputs` and `own` of the outputs. False with the error logged; call blame_free either way. */
bool blame_find(struct blame *blame, const struct replay *replay, struct sheet *sheet,
                struct sheet_row *broken);
void blame_free(struct blame *blame); /* takes a zeroed one */
