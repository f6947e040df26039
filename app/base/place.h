/* Diagnostics as compilers write them, `file:line:column: error: text`: how editors find the place.
 * Called by console.c, so that they stay what they are, and by those who tell errors as JSON. */
#ifndef DIPTYCH_PLACE_H
#define DIPTYCH_PLACE_H

#include <stdbool.h>
#include <stddef.h>

struct place {
    size_t path_length; /* of the line's first bytes, which are the file */
    int line, column;   /* from 1 */
    const char *level;  /* error, warning or note, followed by a colon */
    const char *text;   /* to the end of the line */
};

/* False where the line does not begin like that. */
bool place_read(const char *line, struct place *place);

#endif
