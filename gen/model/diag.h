/* Diagnostics: every stage reports here, so that a wrong spec gets all its errors in one run. Each
 * is `file:line:col: error: text`, the source line and a caret. diag_flush writes them to stderr,
 * sorted by place. */
#ifndef DIPTYCH_GEN_DIAG_H
#define DIPTYCH_GEN_DIAG_H

#include <stdio.h>

#include "model.h"
#include "base/nearest.h"
#include "base/text.h"

struct arena; /* one allocator for everything that lives as long as the model */
void *
arena_alloc(struct arena *arena,
            size_t size); /* zeroed, aligned to 16; NULL only when out of memory, which callers
                                                        report; main then exits with status 2 */
char *arena_printf(struct arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
char *arena_strndup(struct arena *arena, const char *text, size_t length);
struct arena *arena_create(void);
void arena_free(struct arena *arena);

struct source {
    const char *path; /* as given, or found beside the spec */
    const char *text;
    size_t length;
    struct loc included; /* of a part of a spec: where the spec includes it; source NULL: nowhere */
    const char *use;     /* of an instance: what a note there says; NULL: a file */
};
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

struct diag; /* collects; owns nothing of the model */
struct diag *diag_create(void);
void diag_free(struct diag *diag);
/* An error or a warning in an included file gets a note for each include on the way. An
 * error in several instances of a group is reported once. */
void diag_error(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void diag_warning(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* A note belongs to the message before it. */
void diag_note(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
unsigned diag_error_count(const struct diag *diag);
const char *diag_first_error(const struct diag *diag); /* its text, valid until flushed; or NULL */
/* The messages in the order of diag_flush: a JSON array of {"severity", "message", "file", "line",
 * "column", "length"}; the last four only if the message has a file. */
void diag_json(const struct diag *diag, struct text *out);
void diag_flush(struct diag *diag); /* to stderr, sorted by place; duplicates once */
void diag_write(struct diag *diag, FILE *out);

#endif
