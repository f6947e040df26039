/* Names of the files of a sequence: a pattern like frame_%04d.exr, for frame 7 frame_0007.exr. Called
 * by render and flicker. */
#ifndef DIPTYCH_NUMBERED_H
#define DIPTYCH_NUMBERED_H

#include "diptych.h"

/* Whether the path is a pattern, that is, has a % in it. A pattern must have one %d, or with a width
 * %3d or %04d, and no other % but %%: else *good becomes false, with `option`'s error logged. */
bool is_numbered(const char *path, const char *option, bool *good, const struct dt_log *log);

/* The name for that number, of a pattern that was found good; free(). */
char *numbered_path(const char *pattern, uint32_t number);

#endif
