/* --json: the result of a verb, or its errors, in one shape: {"verb", "format": 1, "exit_status",
 * "errors": [...]} and the verb's own keys. An error, warning or note has "severity" and
 * "message", and if it has a place, "file", "line" and "column". */
#pragma once

#include "console/console.h"

/* Writes console->result, which may be NULL, with the messages that the console kept; logs its
 * error. */
bool outcome_write(struct console *console, const char *verb, const char *path, int status);
