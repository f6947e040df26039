/* A folder whose commands ninja runs. Each command is an edge of build.ninja, named by the file that it leaves: FILE.txt
 * holds what the command printed, FILE.failed what a failed one left. ninja goes on where it was left, and repeats what
 * has changed. */
#ifndef DIPTYCH_NINJA_H
#define DIPTYCH_NINJA_H

#include <stdint.h>
#include <stdio.h>

#include "console/console.h"

/* `what`: of the folder, for its first line. `alone`: one edge at a time, which shows what it prints to stderr. */
void ninja_begin(FILE *out, const char *what, bool alone);
/* A group of files that edges wait for, by its name; ninja_path adds one, ninja_end ends the list. */
void ninja_group(FILE *out, const char *name);
/* An edge that waits for a group, and for the paths that are added. `line`: its command for /bin/sh. */
void ninja_edge(FILE *out, const char *file, const char *group);
void ninja_path(FILE *out, const char *path);
void ninja_end(FILE *out, const char *what, const char *line); /* NULL: of a group */

/* Writes a file of a folder, whole or not at all; logs the error. */
typedef void content_writer(FILE *out, const void *user);
bool content_write(const char *folder, const char *name, content_writer *writer, const void *user,
                   const struct dt_log *log);

/* Runs ninja in a folder, with that many edges at once, to the end also behind an edge that fails. `take` gets
 * its lines; NULL: they are shown. plans: it only lists what it would do. False: an error was logged; that an edge
 * failed is none. */
bool ninja_run(struct console *console, const char *folder, uint32_t jobs, bool plans,
               void (*take)(void *user, const char *line), void *user);

#endif
