/* What the files of `diptych sweep` share. Internal to sweep*.c.
 *
 * --measure with more than agree is sweep_grid.c's, whose folder is steps.h's. All else:
 *
 * A sweep is a JSON object, the same in memory and in DIR/sweep.json:
 *   "options"  what makes the sweep; another sweep in the same folder is refused by them
 *   "inputs"   absolute paths that every run depends on
 *   "runs"     objects: "scene", "width", "height", "frames", "sets", "exact", "command"; run N is number
 *              N - 1 of the list; "exact" false: the run's spec promises no equal bits
 *   "redrawn"  draws of the generator that were no valid spec, with the reason
 * and in DIR/runs, once run N is over: N.json, what `compare` wrote; N.result, its exit status and
 * milliseconds, or N.result.failed where it could not run; N.result.txt, what it printed. */
#ifndef DIPTYCH_SWEEP_H
#define DIPTYCH_SWEEP_H

#include <cjson/cJSON.h>

#include "console/console.h"
#include "console/options.h"

/* sweep.c: required members. */
const char *sweep_text(const cJSON *object, const char *name);
uint32_t sweep_number(const cJSON *object, const char *name);

/* sweep_plan.c: the frame's size as compare takes it from --input, or `otherwise`. False, logged. */
bool sweep_default_size(struct console *console, const struct options *options,
                        const char *otherwise, char text[32]);
/* sweep_plan.c: the member "options"; NULL, logged. */
cJSON *sweep_options(struct console *console, const struct options *options);
/* Adds "inputs", "runs" and "redrawn" to a sweep that has its options; logs the error. */
bool sweep_plan(cJSON *sweep, struct console *console);

/* Of a row of --grid, PATH=V1,V2,...: whether it is one, logged; how many values it has; one of them as PATH=V, free(). */
bool sweep_check_row(const char *row, const struct dt_log *log);
uint32_t sweep_row_width(const char *row);
char *sweep_row_value(const char *row, uint32_t index);

/* sweep_grid.c: *wanted says whether --measure asks for more than `agree`. False with the error
 * logged when it is wrong. */
bool sweep_measures(const struct options *options, bool *wanted, const struct dt_log *log);
/* Runs such a sweep; its folder has none of the files above. Returns the exit status. */
int sweep_measure(struct console *console, const struct options *options);

/* sweep_files.c: gives every run its command, a line for /bin/sh that can be pasted anywhere. */
bool sweep_add_commands(cJSON *sweep, const char *folder, const struct dt_log *log);
/* Writes sweep.json, commands and build.ninja into the folder, an absolute path. */
bool sweep_write(const cJSON *sweep, const char *folder, const struct dt_log *log);

/* sweep_summary.c: reads the results, writes summary.json, summary.csv and the page, prints the table. Returns the exit
 * status of the verb. */
int sweep_summarise(struct console *console, const cJSON *sweep, const char *folder);

/* sweep_page.c: writes index.html into the folder: the verdict, plots ("file", "title"; may be NULL), a table with all
 * members of the rows, of which "command" goes below. `table` is the same as a file beside. False, logged. */
bool sweep_write_page(struct console *console, const char *folder, const cJSON *rows,
                      const cJSON *plots, const char *table);

#endif
