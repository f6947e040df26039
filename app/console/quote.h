/* Words for /bin/sh and for ninja files. */
#ifndef DIPTYCH_QUOTE_H
#define DIPTYCH_QUOTE_H

#include <stdio.h>

/* A word for /bin/sh; an option with its value, a blank in front. */
void quote_word(FILE *out, const char *word);
void quote_option(FILE *out, const char *name, const char *value);

/* The value of a variable in a ninja file; a path among the inputs or outputs of an edge. Neither can
 * hold a line break. */
void quote_value(FILE *out, const char *text);
void quote_path(FILE *out, const char *path);

#endif
