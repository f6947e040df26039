/* Diagnostics as data; see diag.h. */
#include "base/diag.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum severity { SEVERITY_ERROR, SEVERITY_WARNING, SEVERITY_REMARK, SEVERITY_NOTE };
static const char *const severity_names[] = {"error", "warning", "remark", "note"};

struct message {
    enum severity severity;
    struct loc loc;
    char *text;
    const char *format; /* of the text */
    unsigned file;      /* number of the source in order of first appearance */
    unsigned head;      /* index of the message that a note belongs to; else its own */
    unsigned order;
    unsigned again; /* times that it was reported again */
};

enum {
    MOST_MESSAGES = 1000, /* of one severity; a reader needs no more */
    MOST_USES = 4         /* of a group or repeat, in the notes of one message */
};

struct diag {
    struct message *messages;
    unsigned count, capacity, errors;
    unsigned seen[4]; /* by enum severity; those beyond MOST_MESSAGES are not kept */
    bool failed;      /* out of memory: some message is lost */
    bool hidden;      /* notes of the last error or warning are not kept */
    bool repeats;     /* the last error or warning is a duplicate; its notes may be, too */
    unsigned head;    /* index of the message that the next notes belong to */
};

/* ---- Collecting ------------------------------------------------------------------------------ */

struct diag *diag_create(void)
{
    return calloc(1, sizeof(struct diag));
}

void diag_free(struct diag *diag)
{
    if (!diag)
        return;
    for (unsigned i = 0; i < diag->count; i++)
        free(diag->messages[i].text);
    free(diag->messages);
    free(diag);
}

static unsigned file_number(const struct diag *diag, const struct source *source)
{
    const char *path = source ? source->path : "";
    unsigned next = 0;
    for (unsigned i = 0; i < diag->count; i++) {
        const struct message *message = &diag->messages[i];
        if (!strcmp(message->loc.source ? message->loc.source->path : "", path))
            return message->file;
        if (message->file >= next)
            next = message->file + 1;
    }
    return next;
}

/* Of one group or repeat. */
static bool are_instances(struct loc a, struct loc b)
{
    return a.source && b.source && a.source != b.source && a.source->use && b.source->use;
}

/* Of a note: among those of the same message. */
static struct message *find_duplicate(const struct diag *diag, const struct message *message)
{
    for (unsigned i = 0; i < diag->count; i++) {
        struct message *other = &diag->messages[i];
        if (message->severity == SEVERITY_NOTE && other->head != diag->head)
            continue;
        if (other->severity == message->severity && other->file == message->file &&
            other->loc.line == message->loc.line && other->loc.column == message->loc.column &&
            (!strcmp(other->text, message->text) ||
             (other->format == message->format && are_instances(other->loc, message->loc))))
            return other;
    }
    return NULL;
}

static void add_message(struct diag *diag, enum severity severity, struct loc loc,
                        const char *format, va_list arguments)
{
    bool note = severity == SEVERITY_NOTE;
    if (severity == SEVERITY_ERROR)
        diag->errors++;
    if (!note)
        diag->hidden = ++diag->seen[severity] > MOST_MESSAGES;
    if (diag->hidden)
        return;
    if (diag->count == diag->capacity) {
        unsigned capacity = diag->capacity ? 2 * diag->capacity : 32;
        struct message *messages = realloc(diag->messages, capacity * sizeof *messages);
        if (!messages) {
            diag->failed = true;
            return;
        }
        diag->messages = messages;
        diag->capacity = capacity;
    }
    struct message message = {
        .severity = severity, .loc = loc, .file = file_number(diag, loc.source), .format = format};
    if (vasprintf(&message.text, format, arguments) < 0) {
        diag->failed = true;
        return;
    }
    struct message *same = !note || diag->repeats ? find_duplicate(diag, &message) : NULL;
    if (!note) {
        diag->repeats = same;
        diag->head = same ? same->order : diag->count;
    }
    if (same) {
        diag->seen[severity] -= severity == SEVERITY_REMARK; /* of a body that many passes have */
        diag->hidden = !note && ++same->again >= MOST_USES;
        free(message.text);
        return;
    }
    message.order = diag->count;
    message.head = diag->head;
    diag->messages[diag->count++] = message;
}

static void note_includes(struct diag *diag, const struct source *source)
{
    for (; source && source->included.source; source = source->included.source)
        if (source->use)
            diag_note(diag, source->included, "%s", source->use);
        else
            diag_note(diag, source->included, "`%s` is included here", source->path);
}

bool diag_add_error(struct diag *diag, struct loc loc, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_message(diag, SEVERITY_ERROR, loc, format, arguments);
    va_end(arguments);
    note_includes(diag, loc.source);
    return false;
}

void diag_warning(struct diag *diag, struct loc loc, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_message(diag, SEVERITY_WARNING, loc, format, arguments);
    va_end(arguments);
    note_includes(diag, loc.source);
}

void diag_remark(struct diag *diag, struct loc loc, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_message(diag, SEVERITY_REMARK, loc, format, arguments);
    va_end(arguments);
}

void diag_note(struct diag *diag, struct loc loc, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_message(diag, SEVERITY_NOTE, loc, format, arguments);
    va_end(arguments);
}

unsigned diag_error_count(const struct diag *diag)
{
    return diag->errors;
}

const char *diag_first_error(const struct diag *diag, struct loc *loc)
{
    for (unsigned i = 0; i < diag->count; i++)
        if (diag->messages[i].severity == SEVERITY_ERROR) {
            *loc = diag->messages[i].loc;
            return diag->messages[i].text;
        }
    return NULL;
}

/* ---- Printing -------------------------------------------------------------------------------- */

/* Start and length in bytes of a line; false when the text has no such line. */
static bool find_line(const char *text, size_t bytes, int line, const char **start, int *length)
{
    if (!text || line < 1)
        return false;
    const char *at = text, *end = text + bytes;
    for (int i = 1; i < line; i++) {
        at = memchr(at, '\n', (size_t)(end - at));
        if (!at)
            return false;
        at++;
    }
    const char *stop = memchr(at, '\n', (size_t)(end - at));
    if (!stop)
        stop = end;
    if (stop > at && stop[-1] == '\r')
        stop--;
    *start = at;
    *length = (int)(stop - at);
    return true;
}

static bool continues_character(char byte)
{
    return (byte & 0xc0) == 0x80;
}

/* Keeps tabs, so that the caret stands below its character. */
static void print_caret(FILE *out, const char *line, int bytes, struct loc place)
{
    fputs("      | ", out);
    int i = 0, at = 1;
    for (; i < bytes && at < place.column; i++) {
        if (continues_character(line[i]))
            continue;
        fputc(line[i] == '\t' ? '\t' : ' ', out);
        at++;
    }
    while (i < bytes && continues_character(line[i]))
        i++;
    int left = 0;
    for (; i < bytes; i++)
        left += !continues_character(line[i]);
    fputc('^', out);
    for (int k = 1; k < place.length && k < left; k++)
        fputc('~', out);
    fputc('\n', out);
}

/* Editors need a line and a column: a message about the whole file gets the first ones. */
static void print_diag_message(FILE *out, const char *program, const struct message *message)
{
    struct loc loc = message->loc;
    const char *line;
    int bytes;
    if (!loc.source) {
        fprintf(out, "%s: %s: %s\n", program, severity_names[message->severity], message->text);
        return;
    }
    fprintf(out, "%s:%d:%d: %s: %s\n", loc.source->path, loc.line < 1 ? 1 : loc.line,
            loc.line < 1 ? 1 : loc.column, severity_names[message->severity], message->text);
    if (!find_line(loc.source->text, loc.source->length, loc.line, &line, &bytes))
        return;
    fprintf(out, "%5d | %.*s\n", loc.line, bytes, line);
    print_caret(out, line, bytes, loc);
}

/* Sorts by place. A note stays behind its message, whatever its own place. */
static int compare_messages(const void *a, const void *b, void *user)
{
    const struct message *all = user, *x = a, *y = b;
    const struct message *xs = &all[x->head], *ys = &all[y->head];
    if (xs->file != ys->file)
        return xs->file < ys->file ? -1 : 1;
    if (xs->loc.line != ys->loc.line)
        return xs->loc.line < ys->loc.line ? -1 : 1;
    if (xs->loc.column != ys->loc.column)
        return xs->loc.column < ys->loc.column ? -1 : 1;
    return (x->order > y->order) - (x->order < y->order);
}

/* malloc'ed; NULL when out of memory */
static struct message *sort_messages(const struct diag *diag)
{
    struct message *sorted = malloc((diag->count + 1) * sizeof *sorted);
    if (sorted && diag->count) {
        memcpy(sorted, diag->messages, diag->count * sizeof *sorted);
        qsort_r(sorted, diag->count, sizeof *sorted, compare_messages, diag->messages);
    }
    return sorted;
}

bool diag_each(const struct diag *diag, diag_visitor *take, void *user)
{
    struct message *sorted = sort_messages(diag);
    for (unsigned i = 0; sorted && i < diag->count; i++)
        take(user, severity_names[sorted[i].severity], sorted[i].loc, sorted[i].text);
    free(sorted);
    return sorted;
}

void diag_print(const struct diag *diag, const char *program, FILE *out)
{
    struct message *sorted = sort_messages(diag);
    for (unsigned i = 0; sorted && i < diag->count; i++)
        print_diag_message(out, program, &sorted[i]);
    for (int i = SEVERITY_ERROR; i <= SEVERITY_REMARK; i++)
        if (diag->seen[i] > MOST_MESSAGES)
            fprintf(out, "%s: %s: %u more of them are not shown\n", program, severity_names[i],
                    diag->seen[i] - MOST_MESSAGES);
    if (!sorted || diag->failed)
        fprintf(out, "%s: error: out of memory while reporting; some messages are missing\n",
                program);
    free(sorted);
}

/* ---- Logs ------------------------------------------------------------------------------------ */

void diag_log_message(void *user, enum dt_level level, const char *message)
{
    struct diag_taker *taker = user;
    taker->message(taker, level, message);
}

char *diag_text(const struct diag *diag, const char *program)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    diag_print(diag, program, out);
    fclose(out);
    if (text && size)
        text[size - 1] = 0; /* the last newline */
    return text;
}

void diag_report(const struct diag *diag, const struct dt_log *log)
{
    if (!diag->count && !diag->failed)
        return;
    if (log->message == diag_log_message) {
        struct diag_taker *taker = log->user;
        taker->diag(taker, diag);
        return;
    }
    char *text = diag_text(diag, "diptych");
    report_message(log, diag->errors || !text ? DT_ERROR : DT_WARNING, "%s",
                   text ? text : "out of memory");
    free(text);
}

void report_at(const struct dt_log *log, struct loc loc, const char *format, ...)
{
    struct diag *diag = diag_create();
    va_list arguments;
    va_start(arguments, format);
    if (diag) {
        add_message(diag, SEVERITY_ERROR, loc, format, arguments);
        diag_report(diag, log);
    } else {
        report_error(log, "out of memory");
    }
    va_end(arguments);
    diag_free(diag);
}
