/* Reads the places of diagnostics; see place.h. */
#include "console/place.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* ":123", and where it ends. */
static const char *read_number(const char *at, int *number)
{
    char *end = NULL;
    if (at[0] != ':' || at[1] < '1' || at[1] > '9')
        return NULL;
    long value = strtol(at + 1, &end, 10);
    *number = value > INT_MAX ? INT_MAX : (int)value;
    return end;
}

bool place_read(const char *line, struct place *place)
{
    static const char *const levels[] = {"error", "warning", "note"};
    for (const char *at = line; *at && *at != '\n'; at++) {
        const char *end = at > line ? read_number(at, &place->line) : NULL;
        end = end ? read_number(end, &place->column) : NULL;
        if (!end || strncmp(end, ": ", 2) != 0)
            continue;
        for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
            size_t length = strlen(levels[i]);
            if (strncmp(end + 2, levels[i], length) != 0 || strncmp(end + 2 + length, ": ", 2) != 0)
                continue;
            place->path_length = (size_t)(at - line);
            place->level = end + 2;
            place->text = end + length + 4;
            return true;
        }
    }
    return false;
}
