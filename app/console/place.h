/* Parses diagnostics in compiler format, `file:line:column: error: text`, which editors follow. */
#ifndef DIPTYCH_PLACE_H
#define DIPTYCH_PLACE_H

#include <stdbool.h>
#include <stddef.h>

struct place {
    size_t path_length; /* bytes of the file's name at the start of the line */
    int line, column;   /* from 1 */
    const char *level;  /* error, warning or note, followed by a colon */
    const char *text;   /* to the end of the line */
};

/* False where the line does not begin like that. */
bool place_read(const char *line, struct place *place);

#endif
