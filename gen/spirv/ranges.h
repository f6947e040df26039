/* What a float of a module can be, by a proof: exact.c leaves out cases that cannot occur. */
#pragma once

#include "model/module.h"

struct bounds {
    float low, high; /* of every component that is not NaN */
    bool nan;        /* it may be NaN */
    bool minus;      /* it may be -0 */
};

struct ranges { /* zeros: nothing is known yet */
    const struct spirv *from;
    struct bounds *known; /* by id */
    uint8_t *state;       /* by id: whether it is known, or being found */
    struct use *uses;     /* of pointers and functions, by other instructions than loads */
    uint32_t *first;      /* by id: its last use; 0: none */
    uint32_t use_count, depth;
};

/* Of the module that the edit changes; until the edit ends. The edit fails when memory runs out. */
void ranges_begin(struct ranges *ranges, struct spirv_edit *edit);
struct bounds range_of(struct ranges *ranges, uint32_t id);
/* Whether both may be zeros of unlike sign at once, of which min and max may give either. */
bool ranges_mix_zeros(struct bounds a, struct bounds b);
/* Of min and max, where a number wins over NaN. */
struct bounds range_of_least(struct bounds a, struct bounds b);
struct bounds range_of_most(struct bounds a, struct bounds b);
