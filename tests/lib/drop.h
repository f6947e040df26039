/* Leaves out barriers of frames, to see whether somebody misses them. */
#pragma once

#include "runtime_vk/internal.h"

enum drop {
    DROP_BARRIER,   /* the commands after it assume its layout */
    DROP_DEPENDENCY /* it waits for nothing, and keeps its layout change */
};

/* Changes barrier `number` of the frame that is rendered next; 0: none. They count from 1 in the order of
 * recording; of one command, buffers come first. For one runtime of a process. */
void drop_next(struct dt_vk_runtime *rt, enum drop drop, uint32_t number);
