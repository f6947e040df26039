/* What a comparison looks at, in order: for every pass the resources and mips that it writes, and
 * those that it finds defined when it begins. Called by compare, blame and whoever replays a
 * pass. */
#ifndef DIPTYCH_ROWS_H
#define DIPTYCH_ROWS_H

#include "diptych.h"

struct row {
    uint32_t pass, resource, mip;
    char *name; /* of the resource, with the mip where there are several; owned by struct rows */
};

struct row_list {
    struct row *list;
    uint32_t count;
    uint32_t *first; /* by pass: its first row; count behind the last pass */
};

struct rows {
    const struct dt_pipeline *pipeline;
    /* one per pass, resource that it writes and mip of it that holds something afterwards */
    struct row_list outputs;
    /* one per pass, resource that it reads, updates or writes and mip of it that holds something
     * before: written by an earlier pass of the frame, or history */
    struct row_list inputs;
    /* one per resource with history and mip of it: what a frame finds when it begins; `first` is
     * NULL */
    struct row_list history;
};

/* False when out of memory, with the error logged; rows_free either way. */
bool rows_make(struct rows *rows, const struct dt_pipeline *pipeline, const struct dt_log *log);

/* The index in `outputs` of the row that gave an input its content, or in `history` when no earlier
 * pass of the frame did; true for `outputs`. */
bool rows_origin(const struct rows *rows, const struct row *input, uint32_t *index);
void rows_free(struct rows *rows); /* takes a zeroed one */

#endif
