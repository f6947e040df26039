/* A growing piece of text. */
#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static _Thread_local bool lost;

bool memory_was_lost(void)
{
    return lost;
}

void memory_lost(void)
{
    lost = true;
}

void memory_forget(void)
{
    lost = false;
}

/* Makes room for `more` bytes and the terminating NUL. */
static bool text_reserve(struct text *text, size_t more)
{
    if (text->failed)
        return false;
    size_t needed = text->length + more + 1;
    if (text->data && needed <= text->capacity)
        return true;
    size_t capacity = text->capacity ? text->capacity : 256;
    while (capacity < needed)
        capacity *= 2;
    char *data = realloc(text->data, capacity);
    if (!data) {
        text->failed = true;
        memory_lost();
        return false;
    }
    text->data = data;
    text->capacity = capacity;
    return true;
}

void text_add_bytes(struct text *text, const char *bytes, size_t length)
{
    if (!text_reserve(text, length))
        return;
    if (length)
        memcpy(text->data + text->length, bytes, length);
    text->length += length;
    text->data[text->length] = '\0';
}

/* Formats again only when the buffer was too small. */
void text_add(struct text *text, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    size_t room = text->data && !text->failed ? text->capacity - text->length : 0;
    int length = vsnprintf(room ? text->data + text->length : NULL, room, format, arguments);
    if (length < 0) {
        text->failed = true;
        memory_lost();
    } else if ((size_t)length < room) {
        text->length += (size_t)length;
    } else if (text_reserve(text, (size_t)length)) {
        vsnprintf(text->data + text->length, (size_t)length + 1, format, again);
        text->length += (size_t)length;
    }
    va_end(again);
    va_end(arguments);
}

char *format_string(const char *format, ...)
{
    char *text = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    return length < 0 ? NULL : text;
}

bool text_is_word(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

void text_add_json(struct text *text, const char *string)
{
    text_add_bytes(text, "\"", 1);
    for (; *string; string++)
        if ((unsigned char)*string < ' ')
            text_add(text, "\\u%04x", (unsigned)*string);
        else
            text_add(text, *string == '"' || *string == '\\' ? "\\%c" : "%c", *string);
    text_add_bytes(text, "\"", 1);
}

void text_add_word(struct text *text, const char *name)
{
    for (; *name; name++)
        text_add_bytes(text, *name == '.' ? "_" : name, 1);
}

/* ---- Long lines ------------------------------------------------------------------------------ */

/* Returns the end of the string literal or comment that begins at line[at]; without one, `at`. */
static size_t skip_quoted(const char *line, size_t at, size_t length)
{
    if (line[at] == '"') {
        for (at++; at < length && line[at] != '"'; at++)
            at += line[at] == '\\';
        return at < length ? at + 1 : length;
    }
    if (line[at] != '/' || at + 1 >= length || line[at + 1] != '*')
        return at;
    const char *end = memmem(line + at + 2, length - at - 2, "*/", 2);
    return end ? (size_t)(end - line) + 2 : length;
}

void text_add_float(struct text *text, double value)
{
    char digits[40];
    int precision = 6; /* %g leaves out zeros behind the last digit */
    do
        snprintf(digits, sizeof digits, "%.*g", precision, value);
    while (strtof(digits, NULL) != (float)value && ++precision <= 9);
    text_add(text, "%s", digits);
}

void text_add_double(struct text *text, double value)
{
    char digits[40];
    int precision = 6;
    do
        snprintf(digits, sizeof digits, "%.*g", precision, value);
    while (strtod(digits, NULL) != value && ++precision <= 17);
    text_add(text, "%s", digits);
}

/* Whether a line of C may break at the blank line[at]: after a comma or an operator. */
static bool is_break(const char *line, size_t at)
{
    size_t begin = at;
    while (begin > 0 && line[begin - 1] != ' ')
        begin--;
    return line[at] == ' ' && at > begin &&
           (line[at - 1] == ',' || strspn(line + begin, "|&+*") == at - begin);
}

/* Where to break a line: the last blank within `columns` at the smallest bracket depth; 0: none. */
static size_t find_break(const char *line, size_t length, size_t columns)
{
    size_t best = 0;
    int depth = 0, best_depth = 0;
    for (size_t at = 0; at < length && at <= columns;) {
        size_t next = skip_quoted(line, at, length);
        if (next > at) {
            at = next;
            continue;
        }
        depth += strchr("([{", line[at]) ? 1 : strchr(")]}", line[at]) ? -1 : 0;
        if (is_break(line, at) && (!best || depth <= best_depth)) {
            best = at;
            best_depth = depth;
        }
        at++;
    }
    return best;
}

static void wrap_line(struct text *out, const char *line, size_t length, size_t columns)
{
    size_t indent = strspn(line, " "), room = columns, at;
    bool directive = line[indent] == '#';
    indent += line[indent] == '{' ? 1 : 4;
    while (!directive && length > room && (at = find_break(line, length, room)) > 0) {
        text_add_bytes(out, line, at);
        text_add(out, "\n%*s", (int)indent, "");
        line += at + 1;
        length -= at + 1;
        room = columns > indent ? columns - indent : 0;
    }
    text_add_bytes(out, line, length);
}

void text_wrap(struct text *text, size_t columns)
{
    struct text wrapped = {.failed = text->failed};
    for (const char *at = text->data; at && *at;) {
        size_t length = strcspn(at, "\n");
        wrap_line(&wrapped, at, length, columns);
        at += length;
        if (*at == '\n') {
            text_add(&wrapped, "\n");
            at++;
        }
    }
    text_free(text);
    *text = wrapped;
}

void text_free(struct text *text)
{
    free(text->data);
    *text = (struct text){0};
}

bool text_number(const char *text, double *value)
{
    const char *at = *text == '-' || *text == '+' ? text + 1 : text;
    if (!isdigit((unsigned char)*at) && *at != '.')
        return false;
    char *end;
    *value = strtod(text, &end);
    return end != text && !*end && isfinite(*value);
}

bool text_amount(const char *text, double *value)
{
    char parts[2][64];
    double divisor = 100;
    size_t length = strcspn(text, "/%");
    const char *rest = text + length + (text[length] == '/');
    if (!text[length])
        return text_number(text, value);
    snprintf(parts[0], sizeof parts[0], "%.*s", (int)length, text);
    snprintf(parts[1], sizeof parts[1], "%s", rest + strspn(rest, " "));
    for (size_t end = strlen(parts[0]); end && parts[0][end - 1] == ' ';)
        parts[0][--end] = '\0';
    bool good = text[length] == '/' ? text_number(parts[1], &divisor) && divisor > 0
                                    : !strcmp(parts[1], "%");
    if (!good || !text_number(parts[0], value))
        return false;
    *value /= divisor;
    return true;
}
