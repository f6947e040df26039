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
    /* The relative of that side's copy; free(bytes->data). False: there is none. May be NULL. */
    bool (*relative)(void *user, enum why_relative relative, int side, struct dt_bytes *bytes);
    void *user;
};

/* {"why": [{"name", "text", "before", "after"}], "why_not", "noise", "size"}: the reason, or none and a text that says so; whether
 * the errors are mere rounding; how large they are. NULL without Python or NumPy, logged: what to install. */
struct cJSON *why_ask(const struct why_question *question, struct console *console);
/* Prints the reason, or that there is none, on stdout. */
void why_print(const struct cJSON *answer, const char *name);
