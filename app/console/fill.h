/* Fills a text template from JSON.
 *
 *   {{name}}               the text or number of that name, escaped for HTML
 *   {{#name}}…{{/name}}    once for each item of a list; once inside an object, or when a value is true or a text
 *                          that is not empty; else left out
 *   {{^name}}…{{/name}}    where the former leaves out
 *   {{.}}                  the item itself, in a list of texts
 *   {{>FILE}}              another template, beside this one, filled with the same
 *   {{#@rest}}…{{/@rest}}  in all items of a list but the first
 *
 * A name is looked up in the innermost object that has it. A section's tag that stands alone on its line leaves
 * no line. */
#pragma once

#include <cjson/cJSON.h>
#include <stdio.h>

#include "console/console.h"

/* Reads the template at `path` and writes it, filled, to `out`. Logs what is wrong with its line: a section that is not
 * closed, a slot whose name the data lacks. */
bool fill_template(FILE *out, const char *path, const cJSON *data, const struct dt_log *log);

/* Fills the page `name` of the templates folder, and writes it as file_write does. Logs its error. */
bool fill_page(struct console *console, const char *name, const char *path, const cJSON *data);
