/* YAML documents and messages that point into them: one parser setting, one set of limits, one
 * form of message for specs, scenes, motions and outlines. */
#ifndef DIPTYCH_SCENES_YAML_H
#define DIPTYCH_SCENES_YAML_H

#include <stdbool.h>
#include <stdio.h>

#include <libfyaml.h>

/* Part of one line of a text. */
struct yaml_place {
    int line, column; /* 1-based, in characters; line 0: the whole file */
    int length;       /* characters to underline, at least 1 */
};

/* Receives each message of a document. A note belongs to the error before it. */
struct yaml_sink {
    void (*report)(void *user, struct yaml_place place, bool note, const char *text);
    void *user;
};

/* The limit on nodes that aliases and merge keys may add to a document. */
enum { YAML_MOST_ALIASED = 100000 };

/* Parses, removes duplicate keys, and expands aliases and merge keys. Reports every error; after
 * some of them, such as a duplicate key, the document is usable all the same. NULL: no document.
 * The text must outlive the document, and need not be valid UTF-8: that is an error, too.
 * Release with fy_document_destroy. */
struct fy_document *yaml_parse(const char *text, size_t length, const struct yaml_sink *sink);

/* Reports the first byte that is not UTF-8 or is a control character. */
bool yaml_check_text(const char *text, size_t length, const struct yaml_sink *sink);

/* The place of a scalar; of a mapping or a sequence: the start of its first scalar. Line 0 where
 * there is none. */
struct yaml_place yaml_node_place(struct fy_node *node);

/* Writes `PATH:LINE:COLUMN: SEVERITY: MESSAGE`, the line of the text, and a caret under the
 * place. `text` may be NULL. */
void yaml_print(FILE *out, const char *path, const char *text, size_t length,
                struct yaml_place place, const char *severity, const char *message);

#endif
