/* Rows of a comparison, in order: for each pass, the resources and mips that it writes, and those
 * that are defined before it. */
#pragma once

#include "diptych.h"

struct cJSON;

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
    /* one per pass, written resource and mip that is defined afterwards */
    struct row_list outputs;
    /* one per pass, resource that it reads, updates or writes, and mip that is defined before: by
     * an earlier pass of the frame, or by history */
    struct row_list inputs;
    /* one per resource with history and mip, before the frame; `first` is NULL */
    struct row_list history;
};

/* False when out of memory, with the error logged; rows_free either way. */
bool rows_make(struct rows *rows, const struct dt_pipeline *pipeline, const struct dt_log *log);

/* Finds the row that gave an input its content: true with its index in `outputs`, or false with its
 * index in `history` when no earlier pass of the frame wrote it. */
bool rows_origin(const struct rows *rows, const struct row *input, uint32_t *index);

/* Adds pass, resource and, where there are several, mip. `pass` false: the resource before the frame, with
 * "pass": null. */
void row_json(struct cJSON *root, const struct dt_pipeline *info, const struct row *row, bool pass);
void rows_free(struct rows *rows); /* takes a zeroed one */
