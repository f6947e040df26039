/* Programs that the command line runs: the generator, compilers, git. Each process has 16 GiB of memory. */
#pragma once

#include <sys/types.h>

#include "base/installed.h"
#include "console/console.h"

struct tool {
    const char *what; /* for messages: "reading the spec" */
    const char *hint; /* what to do when it cannot be started */
    bool explains;    /* its own messages explain a failure */
};

/* Runs argv[0] and waits; true when it ends with status 0. A signal that ends this process first
 * ends the tool and its children. Its stderr is ours; its stdout is the descriptor `output`, or -1:
 * dropped, to keep our own output clean. Logs an error unless tool->explains. */
bool tool_run(const struct tool *tool, char *const argv[], int output, struct console *console);

/* Runs argv[0] with our streams; its exit status, or -1, logged. */
int tool_status(char *const argv[], struct console *console);

/* A command line that grows; NULL stands behind the last word. Begins zeroed. */
enum { TOOL_WORDS = 512 };
struct words {
    char *list[TOOL_WORDS + 1]; /* owned */
    uint32_t count;
    bool failed; /* out of memory, or too many */
};
void words_add(struct words *words, const char *word);
void words_pair(struct words *words, const char *option, const char *value); /* NULL: nothing */
void words_free(struct words *words);
