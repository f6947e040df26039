/* What a user has set and wants to find again: lines `NAME: NUMBER` in a file of $XDG_CONFIG_HOME/diptych,
 * or of ~/.config/diptych. */
#pragma once

#include "diptych.h"

/* One of the three pointers is given. */
struct setting {
    const char *name; /* of lower-case letters and _, at most 31 */
    float *number;
    bool *flag;
    int *whole;
    double least, most;
};

/* Stores what the file has; other names, and numbers out of range, are ignored, as is a missing file. */
void settings_read(const char *name, const struct setting *list, uint32_t count);
/* Makes the folder; logs its error. */
bool settings_write(const char *name, const struct setting *list, uint32_t count,
                    const struct dt_log *log);
