/* Programs that the command line runs: the generator, the C compiler, ninja. Called by cache.c, pipeline.c,
 * sweep.c and steps*.c. */
#ifndef DIPTYCH_TOOL_H
#define DIPTYCH_TOOL_H

#include "console.h"

struct tool {
    const char *what; /* it does */
    const char *hint; /* when it cannot be started */
    bool explains;    /* whoever reads its messages needs no other */
};

/* Runs argv[0] and waits; true when it ends with status 0. Should a signal end this process meanwhile, the
 * tool and its own children end first. Its stderr is ours; its stdout is `output`, a descriptor, or -1:
 * dropped, since it would get between our own output and whoever reads that. An error is logged
 * unless the tool explains what it dislikes itself. */
bool tool_run(const struct tool *tool, char *const argv[], int output, struct console *console);

/* Runs several at once, at most CONSOLE_CHILDREN, each with its own argv and no output, and waits for
 * all. What they say comes one after the other. */
bool tool_run_all(const struct tool *tool, char *const *const argvs[], uint32_t count,
                  struct console *console);

/* Runs one, and gives its stdout as a string; NULL on failure; free(). */
char *tool_read(const struct tool *tool, char *const argv[], struct console *console);

/* The same; each line of its stdout goes to `take`, which a thread of its own calls, until all is told. */
bool tool_lines(const struct tool *tool, char *const argv[],
                void (*take)(void *user, const char *line), void *user, struct console *console);

/* The folder of the executable, where diptych-gen, glad and the cache stand, too; NULL, logged, when it cannot
 * be found; free(). */
char *tools_folder(const struct dt_log *log);

/* Whether that is the bin folder of an installation, and not the build folder of the project. */
bool tools_installed(const char *tools);

/* What the executable brings along, found from its own place: the project's folder, or share and include
 * of where it was installed. free(). */
char *templates_folder(const struct dt_log *log);
char *headers_folder(const struct dt_log *log);  /* diptych.h and limit.h */
char *runtimes_folder(const struct dt_log *log); /* runtime_gl/runtime.h, runtime_vk/runtime.h */

#endif
