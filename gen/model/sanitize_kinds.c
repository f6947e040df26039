/* See sanitize_kinds.h. */
#include "sanitize_kinds.h"

#include <string.h>

#include "panel.h" /* DT_ARRAY_COUNT */

static const char *const kinds[] = {"index",   "arithmetic", "loop", "variable",
                                    "content", "race",       "flow"}; /* as SANITIZE_WORDS */

const char *sanitize_kind_name(unsigned kind)
{
    return kinds[__builtin_ctz(kind)];
}

unsigned sanitize_kinds(const char *list, const char **end)
{
    unsigned mask = 0;
    for (*end = list; **end; *end += **end == ',') {
        size_t length = strcspn(*end, ","), kind = 0;
        while (kind < DT_ARRAY_COUNT(kinds) &&
               (strlen(kinds[kind]) != length || strncmp(kinds[kind], *end, length) != 0))
            kind++;
        if (kind == DT_ARRAY_COUNT(kinds))
            return 0;
        mask |= 1u << kind;
        *end += length;
    }
    return mask ? mask : SANITIZE_ALL;
}
