/* Diagnostics: every stage reports through here, so that a wrong spec gets all its errors in one
 * run, each as `file:line:col: error: text`, the source line and a caret. Written to stderr in
 * order of place, when flushed. */
#ifndef DIPTYCH_GEN_DIAG_H
#define DIPTYCH_GEN_DIAG_H

#include <stdio.h>

#include "model.h"
#include "scenes/nearest.h"
#include "text.h"

struct arena; /* one allocator for everything that lives as long as the model */
void *
arena_alloc(struct arena *arena,
            size_t size); /* zeroed, aligned to 16; exits never: NULL only after out of memory,
                                                        which main reports and ends with status 2 */
char *arena_printf(struct arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
char *arena_strndup(struct arena *arena, const char *text, size_t length);
struct arena *arena_create(void);
void arena_free(struct arena *arena);

struct source {
    const char *path; /* as given, or found beside the spec */
    const char *text;
    size_t length;
};
/* The path without "NAME/.." where that is no detour by a link: a file that several include has one name, and an
 * error in it is told once. NULL when out of memory. */
const char *source_path(struct arena *arena, const char *path);
/* Reads a whole file into the arena and lists it in model->inputs; NULL (nothing reported) when it
 * cannot be read. */
const struct source *source_read(struct model *model, const char *path);

struct diag; /* collects; owns nothing of the model */
struct diag *diag_create(void);
void diag_free(struct diag *diag);
void diag_error(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void diag_warning(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void diag_note(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Belongs to the message before it. */
unsigned diag_error_count(const struct diag *diag);
const char *diag_first_error(const struct diag *diag); /* its text, until it is flushed; or NULL */
/* The messages in the order of diag_flush: a JSON array of {"severity", "message", "file", "line",
 * "column", "length"}, the last four where there is a place. */
void diag_json(const struct diag *diag, struct text *out);
void diag_flush(struct diag *diag); /* to stderr, in order of place; duplicates once */
void diag_write(struct diag *diag, FILE *out);

#endif
