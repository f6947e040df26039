/* A replay runs shaders that may come from anyone, in drivers on the CPU with the rights of the
 * process. bubblewrap takes these away: files but what drivers need and the folder itself, to
 * read; the network; the environment but what drivers read. */
#pragma once

#include "console/console.h"
#include "console/options.h"

/* Runs `replay` with these options in a sandbox and writes --json; *status is its exit status. False: it
 * runs here: --trust, or, with a warning, there can be no sandbox. */
bool confine_replay(struct console *console, const struct options *options, int *status);
