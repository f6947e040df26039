/* Records the Vulkan calls of a process: functions with the names of the loader's note the
 * arguments and pass the call on. A command buffer becomes a tape (hazard.h) of all barriers and of
 * the accesses by shaders to bound resources, by attachments and by commands. Linked into
 * barrier_audit. */
#pragma once

#include "hazard.h"

/* The command buffer that was begun last, as far as it is recorded; valid until the next begins. */
const struct tape *tape_last(void);

/* A call that this recorder does not support, or NULL. */
const char *tape_problem(void);

/* Names a buffer or an image that was created, and the pass of all that is recorded from here on. */
void tape_name(uint64_t handle, const char *name);
void tape_pass(const char *name);
