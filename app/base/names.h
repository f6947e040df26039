/* Guesses which name a misspelled word stands for. Called for verbs, options, drivers, passes and
 * resources. */
#ifndef DIPTYCH_NAMES_H
#define DIPTYCH_NAMES_H

#include <stdint.h>

/* Of names[0..count), the one that `word` is most likely a slip of, or NULL. */
const char *closest_name(const char *word, const char *const *names, uint32_t count);

#endif
