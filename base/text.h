/* A growing text buffer, and numbers as text. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct text {
    char *data; /* NUL-terminated; NULL while empty */
    size_t length, capacity;
    bool failed; /* out of memory: later writes do nothing; see memory_was_lost */
};
void text_add(struct text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
void text_add_bytes(struct text *text, const char *bytes, size_t length);
/* Whether the character may stand in a name of C or GLSL. */
bool text_is_word(char c);
void text_add_json(struct text *text, const char *string); /* quoted and escaped */
/* As an identifier of C or GLSL: the dots of an instance's names become underscores. */
void text_add_word(struct text *text, const char *name);
/* With the fewest digits that read back as the same float or double. */
void text_add_float(struct text *text, double value);
void text_add_double(struct text *text, double value);
/* Breaks lines of C that are longer than `columns` after a comma or an operator, with continuation
 * lines indented by four; strings, comments and directives stay whole, so such a line may stay
 * long. */
void text_wrap(struct text *text, size_t columns);
void text_free(struct text *text);

/* Reads a finite number that begins with a sign, a digit or a dot; nothing stands behind it. */
bool text_number(const char *text, double *value);
/* The same, or a fraction A/B, or a percentage P%. */
bool text_amount(const char *text, double *value);

/* printf into a new string; NULL when out of memory. */
char *format_string(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Whether any text or arena of this thread ran out of memory since memory_forget. What was made
 * since then may be incomplete. */
bool memory_was_lost(void);
void memory_lost(void); /* for the allocators, and for what another thread lost */
void memory_forget(void);
