/* Programs that the command line runs: the generator, the C compiler, ninja. Called by cache.c, pipeline.c,
 * sweep.c and steps*.c. */
#ifndef DIPTYCH_TOOL_H
#define DIPTYCH_TOOL_H

#include <sys/stat.h>
#include <sys/types.h>

#include "base/console.h"

struct tool {
    const char *what; /* it does */
    const char *hint; /* when it cannot be started */
    bool explains;    /* whoever reads its messages needs no other */
    bool optional;    /* where it does not end with status 0, nobody need know: there is another */
};

/* Runs argv[0] and waits; true when it ends with status 0. Should a signal end this process meanwhile, the
 * tool and its own children end first. Its stderr is ours; its stdout is `output`, a descriptor, or -1:
 * dropped, since it would get between our own output and whoever reads that. An error is logged
 * unless the tool explains what it dislikes itself. */
bool tool_run(const struct tool *tool, char *const argv[], int output, struct console *console);

/* A program that was started before its work is known: it prepares, and waits for its words on its standard
 * input, each ended by a zero byte. */
struct tool_waiting {
    pid_t child;         /* 0: there is none */
    int messages, input; /* a file with what it says; where its words go */
    struct stat program; /* as it was */
};

/* Starts `path --wait`. Nothing is said where that fails: tool_run_waiting does without. */
void tool_prepare(struct tool_waiting *waiting, const char *path, struct console *console);
/* As tool_run without output, by the program that waits; by a new one where that is gone, or argv[0] is
 * another program by now. `waiting` may be NULL. */
bool tool_run_waiting(struct tool_waiting *waiting, const struct tool *tool, char *const argv[],
                      struct console *console);
/* It is not wanted any more. */
void tool_dismiss(struct tool_waiting *waiting, struct console *console);

/* Runs several at once, at most CONSOLE_CHILDREN, each with its own argv and no output, and waits for
 * all. What they say comes one after the other. */
bool tool_run_all(const struct tool *tool, char *const *const argvs[], uint32_t count,
                  struct console *console);

/* Runs one, and gives its stdout as a string; NULL on failure; free(). */
char *tool_read(const struct tool *tool, char *const argv[], struct console *console);

/* The same; each line of its stdout goes to `take`, which a thread of its own calls, until all is told. */
bool tool_lines(const struct tool *tool, char *const argv[],
                void (*take)(void *user, const char *line), void *user, struct console *console);

/* Whether there is a program of that name in a folder of PATH. */
bool tool_is_there(const char *name);

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
