/* Records what a process asks of Vulkan: functions of the loader's names stand before the loader's,
 * note what they are told and hand it on. A command buffer becomes a tape (hazard.h): accesses by
 * what the shaders do with what is bound, by attachments and by commands, and every barrier. Linked
 * into barrier_audit. */
#ifndef DIPTYCH_TESTS_TAPE_H
#define DIPTYCH_TESTS_TAPE_H

#include "hazard.h"

/* The command buffer that was begun last, as far as it is recorded; valid until the next begins. */
const struct tape *tape_last(void);

/* Something that this recorder does not follow was used, or NULL. */
const char *tape_problem(void);

/* Names a buffer or an image that was created, and the pass of all that is recorded from here on. */
void tape_name(uint64_t handle, const char *name);
void tape_pass(const char *name);

#endif
