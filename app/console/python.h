/* Verbs that Python does: the package app/python/diptych, whose modules have the verbs' names. */
#pragma once

#include <cjson/cJSON.h>

#include "console/options.h"

/* What was given to a verb, by the names of its options: "-o" is "output", "--from-bounce" is
 * "from_bounce"; --set has the lines of --with before its own. */
cJSON *options_json(const struct options *options, enum verb_id verb);

/* Becomes `/usr/bin/python3 -m diptych VERB`, which reads the request from its stdin, prints, writes
 * --json and ends with the verb's exit status. Takes over the request, and adds "program", the path
 * of this executable, "templates", their folder, "version", and "errors", what was told until now.
 * Returns only when Python cannot be started: EXIT_USAGE, logged. */
int python_verb(struct console *console, const char *verb, cJSON *request);
/* The same in a child process, which writes files, and prints nothing, or to the descriptor `output`, -1: none. `what`: for the
 * error, "writing the page". False: logged. */
bool python_child(struct console *console, const char *verb, const char *what, cJSON *request,
                  int output);
