/* Files for the command line: read whole, write whole or not at all, folders, and a content hash.
 * Functions that return bool or a pointer and take a log have logged the error when they fail. */
#pragma once

#include <stdio.h>

#include "base/text.h"
#include "diptych.h"

struct cJSON;

/* The whole file plus a terminating zero that *size does not count; free(). */
char *file_read(const char *path, size_t *size, const struct dt_log *log);

/* Content of an open file, with a terminating zero; NULL with errno; free(). */
char *file_contents(int file);

/* Writes a temporary file beside `path` and renames it: the file appears whole or not at all. */
bool file_write(const char *path, const void *data, size_t size, const struct dt_log *log);

/* A JSON value, written as file_write does. */
bool file_write_json(const char *path, const struct cJSON *value, const struct dt_log *log);

/* A file written in memory first, through `out`. file_draft_end writes it as file_write does and
 * always frees the draft; a NULL path or an empty draft counts as out of memory. */
struct file_draft {
    FILE *out;
    char *text;
    size_t size;
};
bool file_draft_begin(struct file_draft *draft, const struct dt_log *log);
bool file_draft_end(struct file_draft *draft, const char *path, const struct dt_log *log);
void file_draft_discard(struct file_draft *draft); /* in place of end; also after a failed begin */

/* Whether file_write could write the file, checked before hours of work; logs its error. */
bool file_can_write(const char *path, const struct dt_log *log);

bool file_exists(const char *path);
bool file_make_folders(const char *path, const struct dt_log *log); /* mkdir -p */
bool file_remove_tree(const char *path); /* true when there was nothing to remove */

/* XXH3, 64 bit, over the content, with *hash's former value as its seed. Start with FILE_HASH_START. A
 * file hashes as its bytes do. */
#define FILE_HASH_START UINT64_C(0)
void hash_bytes(uint64_t *hash, const void *data, size_t size);
bool hash_file(uint64_t *hash, const char *path); /* silent: false when it cannot be read */
