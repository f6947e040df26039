/* Work that reads files of strangers, in a child process: libraries may crash, hang or take all
 * memory there. */
#pragma once

#include "diptych.h"

#include <stdio.h>

/* Writes its result; logs what is wrong and returns false. */
typedef bool child_work(FILE *result, void *user, const struct dt_log *log);

enum { CHILD_SECONDS = 600 }; /* of processor time */
/* Beyond what the parent has: for the largest mesh and textures, and a copy of either. */
#define CHILD_BYTES ((size_t)12 << 30)

/* Runs `work` in a forked child and passes its messages on to `log`. Returns the result as a stream
 * at its start, for fclose. NULL: an error was logged; when the child crashed, that error names the
 * file of the last child_opens. No other thread may load libraries or hold their locks. */
FILE *child_run(child_work *work, void *user, const struct dt_log *log);

/* Limits the memory that the work may take from here on; 0: CHILD_BYTES again. Does nothing outside a child,
 * and under AddressSanitizer, which takes more than there is. */
void child_limit_memory(size_t bytes);

/* The same of processor time; 0: CHILD_SECONDS. */
void child_limit_time(unsigned seconds);

/* The file that the work opens next. Does nothing outside a child. */
void child_opens(const char *path);
