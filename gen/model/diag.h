/* The files of a spec, and the arena that holds them and the model. */
#ifndef DIPTYCH_GEN_DIAG_H
#define DIPTYCH_GEN_DIAG_H

#include "model.h"
#include "base/nearest.h"

struct arena; /* one allocator for everything that lives as long as the model */
/* Zeroed, aligned to 16; NULL only when out of memory, which callers report; main then exits with
 * status 2. */
void *arena_alloc(struct arena *arena, size_t size);
char *arena_printf(struct arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
char *arena_strndup(struct arena *arena, const char *text, size_t length);
struct arena *arena_create(void);
void arena_free(struct arena *arena);

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

#endif
