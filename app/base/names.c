/* Guesses names by edit distance (Levenshtein); see names.h. */
#include "base/names.h"

#include <string.h>

static unsigned smallest(unsigned a, unsigned b, unsigned c)
{
    unsigned least = a < b ? a : b;
    return least < c ? least : c;
}

static unsigned edit_distance(const char *a, const char *b)
{
    unsigned row[64];
    size_t width = strlen(b);
    if (width >= sizeof row / sizeof *row)
        return UINT32_MAX;
    for (unsigned j = 0; j <= width; j++)
        row[j] = j;
    for (unsigned i = 1; *a; a++, i++) {
        unsigned diagonal = row[0];
        row[0] = i;
        for (unsigned j = 1; j <= width; j++) {
            unsigned replaced = diagonal + (*a != b[j - 1]);
            diagonal = row[j];
            row[j] = smallest(row[j] + 1, row[j - 1] + 1, replaced);
        }
    }
    return row[width];
}

const char *closest_name(const char *word, const char *const *names, uint32_t count)
{
    const char *best = NULL;
    unsigned limit = 2 + (unsigned)strlen(word) / 3; /* slips, not other words */
    for (uint32_t i = 0; i < count; i++) {
        unsigned distance = edit_distance(word, names[i]);
        if (distance < limit) {
            limit = distance;
            best = names[i];
        }
    }
    return best;
}
