/* Edit distance; see nearest.h. */
#include "base/nearest.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { LONGEST_WORD = 63 };

/* Optimal string alignment distance of two words of at most LONGEST_WORD letters. */
static unsigned edit_distance(const char *a, const char *b)
{
    size_t n = strlen(a), m = strlen(b);
    unsigned row[3][LONGEST_WORD + 2];
    for (size_t j = 0; j <= m; j++)
        row[1][j] = (unsigned)j;
    for (size_t i = 1; i <= n; i++) {
        unsigned *last = row[i % 3], *now = row[(i + 1) % 3], *before = row[(i + 2) % 3];
        now[0] = (unsigned)i;
        for (size_t j = 1; j <= m; j++) {
            unsigned best = last[j - 1] + (a[i - 1] != b[j - 1]);
            if (last[j] + 1 < best)
                best = last[j] + 1;
            if (now[j - 1] + 1 < best)
                best = now[j - 1] + 1;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                before[j - 2] + 1 < best)
                best = before[j - 2] + 1;
            now[j] = best;
        }
    }
    return row[(n + 1) % 3][m];
}

const char *nearest_name(const char *word, const char *const *names, size_t count)
{
    size_t length = strlen(word);
    if (length > LONGEST_WORD)
        return NULL;
    unsigned limit = length <= 4 ? 1 : length <= 6 ? 2 : 3, best = limit + 1;
    const char *nearest = NULL, *longer = NULL;
    for (size_t i = 0; i < count; i++) {
        if (length > 2 && !longer && names[i] && strncmp(word, names[i], length) == 0 &&
            names[i][length])
            longer = names[i];
        if (!names[i] || strlen(names[i]) > LONGEST_WORD || !strcmp(word, names[i]))
            continue;
        unsigned distance = strcasecmp(word, names[i]) ? edit_distance(word, names[i]) : 0;
        if (distance < best && distance < length) {
            best = distance;
            nearest = names[i];
        }
    }
    return nearest ? nearest : longer;
}

struct name_hint name_hint(char quote, const char *word, const char *const *names, size_t count,
                           const char *otherwise)
{
    struct name_hint hint;
    const char *near = word && names ? nearest_name(word, names, count) : NULL;
    if (near)
        snprintf(hint.text, sizeof hint.text, "; did you mean %c%s%c?", quote, near, quote);
    else
        snprintf(hint.text, sizeof hint.text, "%s", otherwise);
    return hint;
}
