/* What stands in the cache: folders of versions, each beside a stamp that names the current one and
 * the hash of every file that it was made from, and files that must not be there. cache.c keeps pipelines
 * so, compile.c objects. */
#ifndef DIPTYCH_STAMP_H
#define DIPTYCH_STAMP_H

#include <dirent.h>
#include <stdio.h>
#include <time.h>

#include "base/console.h"

/* What is being made. */
struct stamp_work {
    const char *folder; /* where: temporary, so that what lies in it is no input */
    struct timespec
        since; /* of the clock that files are dated by: what was saved after that may have
                              been read before */
};

/* Adds "HASH PATH" for each file that the makefile rule in `depfile` names. */
bool stamp_add(FILE *files, const char *depfile, const struct stamp_work *work,
               const struct dt_log *log);

/* Where the generator looks for what the spec names: beside that or the including file, then below the
 * templates. */
struct stamp_origin {
    const char *spec, *templates;
};

/* Adds "absent PATH" for each file that would have been taken in place of one of the rule's below the
 * templates, had it been there. */
bool stamp_add_absent(FILE *files, const char *depfile, const struct stamp_origin *origin,
                      const struct stamp_work *work, const struct dt_log *log);

/* Where in `folder` something is made before it is published; what a process that was killed left there
 * goes. free(). */
char *stamp_temporary(const char *folder);

/* Puts the finished folder `temporary` into `folder`, as a version, and lets the stamp name it.
 * `files`: lines of stamp_add. */
bool stamp_publish(const char *folder, const char *temporary, const char *name, const char *files,
                   const struct dt_log *log);

/* What stamp_read finds; stamped_free. */
struct stamped {
    char *name;
    char *folder; /* of the version */
    char *files;  /* lines of stamp_add */
    DIR *held;    /* it is not pruned until this is closed */
};

/* False when there is none in `folder`, or a file has changed or come since. */
bool stamp_read(struct stamped *found, const char *folder);
void stamped_free(struct stamped *found);

/* Hands every file that the makefile rule in `path` depends on to `take`, until that returns false,
 * having logged why. */
bool depfile_read(const char *path, bool (*take)(void *user, const char *file), void *user,
                  const struct dt_log *log);

#endif
