/* Text for terminals, JSON, XML and pages: no control characters, and UTF-8. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Bytes of the printable character that begins here; 0: there is none. Line feeds and tabs are printable.
 * Control characters are U+0000 to U+001F, and U+007F to U+009F; overlong forms, surrogates and numbers
 * beyond U+10FFFF are no characters. */
size_t text_character(const char *at);
bool text_is_printable(const char *text);
/* A copy in which all other bytes are written \xNN; free(). NULL: out of memory. */
char *text_printable(const char *text);

/* A copy in which U+FFFD stands for them: for JSON, where a backslash has a meaning. free(). */
char *text_replaced(const char *text);
