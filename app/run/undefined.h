/* What --sanitize found: undefined behaviour of shaders, at places in the author's files. */
#pragma once

#include "spec/pipeline.h"
#include "diptych.h"

struct cJSON;

struct undefined {
    struct dt_finding *list; /* in the order of their places; owned */
    uint32_t *sides;         /* of each: mask of the sides that found it; owned */
    uint32_t count;
};

/* Adds what the buffer of reports of one side, numbered from 0, holds. False when out of memory, logged. */
bool undefined_add(struct undefined *undefined, const struct pipeline *pipeline, uint32_t side,
                   const struct dt_bytes *bytes, const struct dt_log *log);
void undefined_free(struct undefined *undefined); /* takes a zeroed one */

/* On stdout. labels: of the sides, which are named where there are several. */
void undefined_print(const struct undefined *undefined, const char *const *labels,
                     uint32_t side_count);
struct text;
/* A line for each, for a window. */
void undefined_text(const struct undefined *undefined, struct text *text);
/* For --json: [{"file", "line", "column", "kind", "message", "pass", "invocation", "count", "frame", "sides"}]. */
struct cJSON *undefined_json(const struct undefined *undefined, const char *const *labels,
                             uint32_t side_count);
/* Warns of each `allow` of the spec that was of no use to any side. */
void undefined_warn_idle(const struct pipeline *pipeline, struct console *console);
