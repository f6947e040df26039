/* `compare` in a process of its own, for a window whose drivers are open: they stand no fork. */
#pragma once

#include "console/console.h"
#include "console/setup.h"

struct compare_apart {
    const struct setup *setup; /* but for size, frames and motion */
    const char *edits;         /* more of --set: lines NAME=VALUE; NULL: none */
    uint32_t size[2], frames;
    const char *motion;
    const char *folder; /* to write */
};

/* `compare --bisect`. Waits for its end. Returns the exit status of compare, or -1 with the error logged. */
int compare_apart(struct console *console, const struct compare_apart *apart);
