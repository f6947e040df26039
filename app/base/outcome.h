/* --json: what a verb found out, or why it did not. The same for every verb:
 *   {"verb", "format": 1, "exit_status", "errors": [...], and what the verb itself has to tell}
 * An error, warning or note has "severity" and "message", and where it has a place "file", "line" and
 * "column". Called by main, after the verb. */
#ifndef DIPTYCH_OUTCOME_H
#define DIPTYCH_OUTCOME_H

#include "base/console.h"

/* Writes console->result, which may be NULL, with the errors that console kept; logs its error. */
bool outcome_write(struct console *console, const char *verb, const char *path, int status);

#endif
