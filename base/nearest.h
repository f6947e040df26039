/* "Did you mean": the name that a misspelled word most likely stands for. */
#pragma once

#include <stddef.h>

/* The name with the fewest edits from `word` (insert, delete, replace, swap of neighbours; ignoring
 * case), or NULL if none is near: at most 1 edit for a word of two letters, 2 up to six letters, 3
 * above; else one that begins with the word, of three letters at least. Skips NULL among the names. */
const char *nearest_name(const char *word, const char *const *names, size_t count);

/* For the end of a message: "; did you mean `NAME`?", in these quotes; `otherwise` where no name is near.
 * NULL for word or names: out of memory, no name is near. */
struct name_hint {
    char text[1024];
};
struct name_hint name_hint(char quote, const char *word, const char *const *names, size_t count,
                           const char *otherwise);
