/* Files that came with the executable: in the project, beside build/, or below the prefix of an installation. */
#pragma once

#include "diptych.h"

/* Folder of the executable, of diptych-gen, glad and the cache; in a library, its own folder; NULL with the error logged;
 * free(). */
char *tools_folder(const struct dt_log *log);

/* Whether this is the bin folder of an installation, not the project's build folder. */
bool tools_installed(const char *tools);

/* Folders that belong to the executable: in the project, or below the prefix of the installation.
 * free(). */
char *templates_folder(const struct dt_log *log);
char *python_folder(const struct dt_log *log); /* that has the package diptych */

/* The path of a spec or scene file that the user names: `rsm` and `cornell` are files that came with the
 * executable, unless the working folder has files of these names. free(); NULL: out of memory. */
char *find_spec(const char *path, const struct dt_log *log);
char *find_scene(const char *path, const struct dt_log *log);
char *find_in(const char *path, const char *folder); /* the same, in any folder; NULL: none */
