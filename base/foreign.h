/* Folders that others made: dumps, goldens, evidence, results of a bundle. They name files inside
 * themselves only, and through no symbolic link; texts of theirs may be shown anywhere. */
#pragma once

#include <cjson/cJSON.h>

#include "diptych.h"

enum { FOREIGN_TEXT_BYTES = 64 << 20 }; /* the largest manifest or text that is read */

/* The file `name` of the folder, with a terminating zero that *size does not count; free(). `most`: its
 * size is looked at before it is read. NULL: logged. */
char *foreign_read(const char *folder, const char *name, size_t most, size_t *size,
                   const struct dt_log *log);
/* The same of exactly `size` bytes. */
void *foreign_read_exactly(const char *folder, const char *name, size_t size,
                           const struct dt_log *log);
/* A JSON file, to its last byte, in which strings are printable (text_printable). NULL: logged. */
cJSON *foreign_json(const char *folder, const char *name, const struct dt_log *log);
bool foreign_has(const char *folder, const char *name); /* also a link */
/* Whether `path`, links followed, lies in the folder of `file`, at any depth; a path without a file does,
 * since nothing can be read there. */
bool foreign_is_beside(const char *path, const char *file);
