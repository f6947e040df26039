/* Reads files that a user names: regular files alone, so that no device and no pipe makes a
 * program wait. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The whole file and a terminating zero that *length does not count; free(). NULL: *reason says
 * why; it is valid until the next call in this thread. `most` is the limit in bytes. */
char *input_read(const char *path, size_t most, size_t *length, const char **reason);

/* Opens such a file; NULL: *reason, as above. */
FILE *input_open(const char *path, size_t most, const char **reason);

/* Whether this process may open `count` more files. Libraries pass over files that they cannot open. */
bool input_room(int count);

/* What the file seems to be, by its first bytes, for messages about a file of another kind. NULL:
 * unknown, or plain text. */
const char *input_seen(const char *path);

/* For a library that opens the file by its name. False: *reason, as above. */
bool input_check(const char *path, size_t most, const char **reason);
