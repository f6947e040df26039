/* "Did you mean": the name that a misspelled word most likely stands for. Called by whoever reads names
 * that people write: specs, scene files, command lines. In this leaf, since all of them may use it. */
#ifndef DIPTYCH_SCENES_NEAREST_H
#define DIPTYCH_SCENES_NEAREST_H

#include <stddef.h>

/* The name with the fewest edits from `word` (insert, delete, replace, swap of neighbours; case counts for
 * nothing), or NULL when none is near: at most 1 edit for a word of two letters, 2 up to six letters, 3
 * above. NULL among the names is skipped. */
const char *nearest_name(const char *word, const char *const *names, size_t count);

#endif
