/* `compare A B`, called by the verb. */
#pragma once

#include "console/options.h"

/* Returns the exit status: they agree, they differ, or it could not run. */
int compare_dumps(struct console *console, const struct options *options);
