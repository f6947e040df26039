/* Reads rows of folders of render --dump, and of evidence, whose entries have the same keys. */
#pragma once

#include <cjson/cJSON.h>

#include "result/rows.h"

struct dump_reader {
    const char *folder; /* borrowed */
    const struct dt_log *log;
    cJSON *manifest;
    char *device; /* backend and device that made it */
    /* the caller sets them when they are known */
    const struct dt_pipeline *pipeline;
    uint32_t size[2]; /* of the frame */
    bool evidence;    /* of one pass: "inputs", and "outputs" with "expected" and "actual" */
    uint8_t *data;    /* of the last row that was read */
};

/* Reads the manifest only. On false the error is logged; dump_reader_close either way. `log` must
 * outlive it. */
bool dump_reader_open(struct dump_reader *reader, const char *folder, const struct dt_log *log);

/* Content of a row after its pass, or before it; valid until the reader's next call. Any mismatch
 * with the pipeline is an error. */
bool dump_reader_read(struct dump_reader *reader, const struct row *row, bool before,
                      struct dt_bytes *bytes);
/* The entry of a row in a list of the manifest; `pass` NULL: entries name none. NULL: there is none. */
const cJSON *dump_reader_find(const struct dump_reader *reader, const char *list, const char *pass,
                              const struct row *row);
/* The same content of an entry, whose file has that key; free(bytes->data). An entry of NULL is an error. */
bool dump_reader_load(const struct dump_reader *reader, const cJSON *entry, const char *key,
                      const struct row *row, bool before, struct dt_bytes *bytes);
void dump_reader_close(struct dump_reader *reader); /* takes a zeroed one */
