/* A folder that appears whole or not at all: written under another name beside its place and
 * renamed. */
#pragma once

#include "console/console.h"

struct folder {
    struct console *console;
    const char *option; /* that named it, for messages */
    const char *mark;
    char *place;
    char *temporary; /* NULL: nothing was begun */
};

/* Refuses a place that is neither free, nor an empty folder, nor one of the same kind, whose
 * manifest.json has the key `mark` (NULL: none has). Strings but the place are borrowed. On false the error
 * is logged; folder_end either way. */
bool folder_begin(struct folder *folder, struct console *console, const char *option,
                  const char *place, const char *mark);

/* Whether what stands in that place may be replaced, asked before hours of work; logs as it would. */
bool folder_can_write(struct console *console, const char *option, const char *place,
                      const char *mark);

/* Letters, digits, `_`, `-` and `.`, which is not first: never a path. */
bool folder_takes(const char *name);
/* Writes a file of such a name, which may come from anywhere. */
bool folder_write(const struct folder *folder, const char *name, const void *data, size_t size);
/* An absolute path without "." and "..", textually: copies are plain folders without links. free(). NULL: out of
 * memory. */
char *folder_plain_path(const char *path);
/* At a path whose folders are made. It leads down, else an error. */
bool folder_write_at(const struct folder *folder, const char *path, const void *data, size_t size);
bool folder_write_json(const struct folder *folder, const char *name, const struct cJSON *value);

/* Puts it in its place, or throws it away. Takes a zeroed one. */
bool folder_end(struct folder *folder, bool keep);
