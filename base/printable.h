/* Text for terminals, JSON, XML and pages: no control characters, and UTF-8. */
#ifndef DIPTYCH_PRINTABLE_H
#define DIPTYCH_PRINTABLE_H

#include <stdbool.h>

/* Line feeds and tabs are printable. */
bool text_is_printable(const char *text);
/* A copy in which all other bytes are written \xNN; free(). NULL: out of memory. */
char *text_printable(const char *text);

/* A copy in which U+FFFD stands for them: for JSON, where a backslash has a meaning. free(). */
char *text_replaced(const char *text);

#endif
