/* Diagnostics: what is wrong in files, as data. Every reader reports here, so that a wrong file gets
 * all its errors in one run. They are printed in one form, `file:line:column: error: text` with the line
 * and a caret, which editors follow, and written in one form of JSON. */
#pragma once

#include <stdio.h>

#include "base/log.h"
#include "base/text.h"

struct loc {
    const struct source *source;
    int line, column; /* 1-based, in characters; line 0: the whole file */
    int length;       /* characters to underline, at least 1 */
};

struct source {
    const char *path; /* as given, or found beside the spec */
    const char *text; /* NULL: unknown; a message shows no line */
    size_t length;
    struct loc included; /* of a part of a spec: where the spec includes it; source NULL: nowhere */
    const char *use;     /* of an instance: what a note there says; NULL: a file */
    const uint32_t *words; /* of a module of SPIR-V, whose text spirv-dis prints; NULL: a text */
    size_t word_count;
};

struct diag; /* collects; sources and formats must outlive it */
struct diag *diag_create(void);
void diag_free(struct diag *diag);
/* A loc without a source is that of no file. An error or a warning in an included file gets a note for
 * each include on the way. One in several instances of a group is reported once. */
#define diag_error(...) log_false(diag_add_error(__VA_ARGS__)) /* false, as report_error */
bool diag_add_error(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void diag_warning(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* What was decided at a place: neither right nor wrong. */
void diag_remark(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* A note belongs to the message before it. */
void diag_note(struct diag *diag, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
unsigned diag_error_count(const struct diag *diag);
const char *diag_first_error(const struct diag *diag, struct loc *loc); /* its text; NULL: none */

/* Visits all messages, sorted by place, a note behind its message. False: out of memory. */
typedef void diag_visitor(void *user, const char *severity, struct loc loc, const char *message);
bool diag_each(const struct diag *diag, diag_visitor *take, void *user);
/* Prints them in this order. `program` begins those without a file. */
void diag_print(const struct diag *diag, const char *program, FILE *out);
/* The same as a text without the last newline; free(). NULL: out of memory. */
char *diag_text(const struct diag *diag, const char *program);
/* The same as elements of a JSON array: {"severity", "message", "file", "line", "column", "length"}, the
 * last four only if the message has a file. A comma stands before each unless `out` ends with `[`. */
void diag_json(const struct diag *diag, struct text *out);
/* One such element, of no file. */
void diag_json_text(bool error, const char *message, struct text *out);

/* The messages into a log: as data where its message function is diag_log_message, whose user begins
 * with a struct diag_taker; else as one printed text. Nothing where there are none. */
struct diag_taker {
    void (*message)(struct diag_taker *taker, enum dt_level level, const char *message);
    void (*diag)(struct diag_taker *taker, const struct diag *diag);
};
void diag_log_message(void *user, enum dt_level level, const char *message);
void diag_report(const struct diag *diag, const struct dt_log *log);
/* One error at a place. */
void report_at(const struct dt_log *log, struct loc loc, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
