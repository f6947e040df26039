/* Why two copies of a resource differ: tries what usually is wrong between two renderers. why.c
 * tries, why_at.c, why_map.c and why_where.c have the faults. */
#pragma once

#include "picture/texels.h"
#include "diptych.h"

struct cJSON;

/* Content beside the copy that is asked about. */
enum why_relative {
    WHY_FRAME_BEFORE,
    WHY_FRAME_AFTER,
    WHY_MIP_FINER,
    WHY_MIP_COARSER,
    WHY_RELATIVES
};

struct why_question {
    const struct dt_resource *resource; /* of both copies */
    const struct dt_bytes *copies;      /* two, of one extent */
    const char *labels[2];
    /* The relative of that side's copy; free(bytes->data). False: there is none. May be NULL. */
    bool (*relative)(void *user, enum why_relative relative, int side, struct dt_bytes *bytes);
    void *user;
};

struct why_reason {
    const char *name;       /* of the fault: "flip_y" */
    char *text;             /* a sentence without a full stop; owned */
    uint64_t before, after; /* elements that differ, at all and where the fault is taken back */
};

enum { WHY_MOST = 3 };
struct why {
    struct why_reason reasons[WHY_MOST]; /* the likeliest first */
    uint32_t count;                      /* 0: nothing brings the copies nearer */
};

/* False when out of memory. why_free either way. */
bool why_find(struct why *why, const struct why_question *question);
/* Adds the list "why" to an object: name, text, before, after. */
void why_json(struct cJSON *root, const struct why *why);
void why_free(struct why *why); /* takes a zeroed one */
