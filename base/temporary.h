/* Names of files and folders that are written beside their final place and renamed there. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#define TEMPORARY_FORMER "-former" /* suffix: a hard link to the file that is being replaced */

/* PATH.diptych-tmp-PID; free(). NULL when out of memory. */
char *temporary_path(const char *path);

/* Removes, with `remove`, such as unlink, what processes that are gone left under such names in
 * the folder of `path`. Looks into a folder once as long as the process names no other one. */
void temporary_sweep(const char *path, int (*remove)(const char *path));

/* write(2) until all is written; false: errno. */
bool write_all(int descriptor, const void *bytes, size_t length);
