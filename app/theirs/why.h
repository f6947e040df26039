/* Why two copies of a resource differ: asks the module why of app/python/diptych, which tries what usually is wrong between two
 * renderers. */
#pragma once

#include "console/console.h"
#include "picture/texels.h"
#include "diptych.h"

struct cJSON;

/* Content beside the copy that is asked about; why_faults.py counts them likewise. */
enum why_relative {
    WHY_FRAME_BEFORE,
    WHY_FRAME_AFTER,
    WHY_MIP_FINER,
    WHY_MIP_COARSER,
    WHY_RELATIVES
};

struct why_question {
    const struct dt_resource *resource; /* of both copies, with their contract */
    const struct dt_bytes *copies;      /* two, of one extent */
    const char *labels[2];
    const bool *edges; /* `raster`: elements that may differ; see edges_find. May be NULL */
    /* The relative of that side's copy; free(bytes->data). False: there is none. May be NULL. */
    bool (*relative)(void *user, enum why_relative relative, int side, struct dt_bytes *bytes);
    void *user;
};

/* Questions for one start of Python. Zeroed, it is empty. */
struct why_batch {
    int file;      /* all content */
    uint64_t size; /* of it */
    struct cJSON *questions;
    bool good;
};

/* Copies what the question points to. */
void why_add(struct why_batch *batch, const struct why_question *question);
/* The answers in order, {"why": [{"name", "text", "before", "after"}], "why_not", "noise", "size"} each: the reason, or those of
 * parts with their "share", or none and a text that says so; whether the errors are mere rounding; how large they are. `until_loud`:
 * up to the first that is not noise. NULL without Python or NumPy, logged: what to install. Empties the batch. */
struct cJSON *why_ask_all(struct why_batch *batch, bool until_loud, struct console *console);
/* The answer to one question. */
struct cJSON *why_ask(const struct why_question *question, struct console *console);
/* Prints the reason, or that there is none, on stdout. */
void why_print(const struct cJSON *answer, const char *name);
