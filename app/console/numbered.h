/* File names of a sequence: frame_%04d.exr gives frame_0007.exr for frame 7. */
#pragma once

#include "diptych.h"

/* Whether the path is a pattern: has a %. A pattern has one %d, or with a width %3d or %04d, and no
 * other % except %%. Otherwise *good becomes false, with the error of `option` logged. */
bool is_numbered(const char *path, const char *option, bool *good, const struct dt_log *log);

/* The name for a number, of a valid pattern; free(). */
char *numbered_path(const char *pattern, uint32_t number);
