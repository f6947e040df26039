/* Where the bytes of one side come from while a comparison walks through the passes: a worker that
 * runs them, or a dump in which they lie. */
#pragma once

#include "result/dump_reader.h"
#include "result/rows.h"
#include "run/worker.h"

struct row_source {
    const struct side *side;
    struct worker worker;
    struct dump_reader *dump; /* NULL: the worker */
    struct worker_place place;
    bool skips; /* the pass that comes next does not run */
};

/* All log their errors. Between source_resume and source_reach, and between source_ask and
 * source_take, other sources may be told the same, so that they work at once. */

/* With a dump, which is borrowed, nothing is started, and every stop is reached at once. */
bool source_start(struct row_source *source, const struct worker_info *info,
                  struct dump_reader *dump);
bool source_resume(struct row_source *source);

/* Waits for the next stop, which must be this one. */
bool source_reach(struct row_source *source, struct worker_place place);

/* The content of a row at the present stop; valid until the source's next verb, not to be freed. */
bool source_ask(struct row_source *source, const struct row *row);
bool source_take(struct row_source *source, const struct row *row, struct dt_bytes *bytes);

const char *source_device(const struct row_source *source); /* once WORKER_READY was reached */

/* Ends the worker; takes a zeroed source. */
void source_close(struct row_source *source);
