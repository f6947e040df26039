/* A table of verbs that only notes the calls of a panel's record. Two panels with the same notes do
 * the same. */
#pragma once

#include "verbs.h"

enum { RECORDER_BARRIER = DT_VERBS }; /* a note behind that of `barriers`, for each of them */

struct recorder_note {
    uint32_t verb; /* enum dt_verb, or RECORDER_BARRIER */
    uint32_t pass;
    uint32_t arguments[4]; /* as verbs.def has them; else 0 */
    struct dt_barrier barrier;
};

struct recorder {
    const struct dt_panel *panel;
    struct recorder_note *notes; /* NULL before the first run */
    uint32_t count, capacity;
    uint32_t calls;   /* of verbs */
    uint32_t fail_at; /* this call, counted from 1, fails; 0: none */
};

/* Records one frame; returns the result of record. Replaces the notes of an earlier run. `live`:
 * NULL for the defaults. */
bool recorder_run(struct recorder *recorder, const struct dt_panel *panel, uint32_t width,
                  uint32_t height, const void *live);
void recorder_free(struct recorder *recorder);

/* The note as a line of text, with every argument, and the names of pass and resource. */
void recorder_line(const struct recorder *recorder, uint32_t note, char *line, size_t size);

/* Index of the first different or additional note; UINT32_MAX: the notes are the same. */
uint32_t recorder_difference(const struct recorder *a, const struct recorder *b);
