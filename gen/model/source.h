/* The files of a spec: found, read once, and held in the arena of the model. */
#pragma once

#include "model.h"
#include "base/arena.h"

/* The path without "NAME/..", unless NAME is a symbolic link. So a file that several files include
 * has one path, and its errors are reported once. NULL: out of memory. */
const char *source_path(struct arena *arena, const char *path);
/* Where a file may be that the file `from` names: place 0 beside `from`, or beside the spec if
 * `from` is --set; 1 in the templates, 2 in templates/glsl. NULL: out of memory. */
const char *source_candidate(const struct model *model, const char *from, const char *name,
                             size_t length, int place);
/* Reads a whole file into the arena and lists it in model->inputs; NULL: *reason says why,
 * and nothing is reported. Regular files up to 64 MiB. */
const struct source *source_read(struct model *model, const char *path, const char **reason);

/* Lists a file in model->inputs without reading it. Returns its path in the arena; NULL: *reason,
 * as above. */
const char *source_list(struct model *model, const char *path, const char **reason);
