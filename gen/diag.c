/* Diagnostics and the files that they point into. Every stage reports here; the caller flushes. */
#include "diag.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/input.h"
#include "base/yaml.h"
#include "spirv/cross.h"

enum { MOST_SOURCE_BYTES = 64 << 20 }; /* a spec or a GLSL file */

enum severity { SEVERITY_ERROR, SEVERITY_WARNING, SEVERITY_NOTE };
static const char *const severity_names[] = {"error", "warning", "note"};

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
    unsigned seen[3]; /* by enum severity; those beyond MOST_MESSAGES are not kept */
    bool failed;      /* out of memory: some message is lost */
    bool hidden;      /* notes of the last error or warning are not kept */
    bool repeats;     /* the last error or warning is a duplicate; its notes may be, too */
    unsigned head;    /* index of the message that the next notes belong to */
};

/* ---- Sources --------------------------------------------------------------------------------- */

static bool list_input(struct model *model, const char *path)
{
    for (uint32_t i = 0; i < model->input_count; i++)
        if (!strcmp(model->inputs[i], path))
            return true;
    if (!(model->input_count & (model->input_count - 1)) ||
        !model->inputs) { /* full at powers of two */
        uint32_t capacity = model->input_count ? 2 * model->input_count : 1;
        const char **inputs = arena_alloc(model->arena, capacity * sizeof *inputs);
        if (!inputs)
            return false;
        if (model->input_count)
            memcpy(inputs, model->inputs, model->input_count * sizeof *inputs);
        model->inputs = inputs;
    }
    model->inputs[model->input_count++] = path;
    return true;
}

/* Whether the first `length` bytes name a folder, not a symbolic link: then ".." behind them leads
 * to the folder that contains it. */
static bool is_plain_folder(const char *path, size_t length)
{
    char *folder = strndup(path, length);
    struct stat status;
    bool plain = folder && !lstat(folder, &status) && S_ISDIR(status.st_mode);
    free(folder);
    return plain;
}

const char *source_path(struct arena *arena, const char *path)
{
    char *out = arena_strndup(arena, path, strlen(path));
    for (char *up = out ? strstr(out, "/../") : NULL; up;) {
        char *name = up;
        while (name > out && name[-1] != '/')
            name--;
        size_t length = (size_t)(up - name);
        bool shorter =
            length && strncmp(name, "..", length) != 0 && is_plain_folder(out, (size_t)(up - out));
        if (shorter)
            memmove(name, up + 4, strlen(up + 4) + 1);
        up = strstr(shorter ? out : up + 1, "/../");
    }
    return out;
}

const char *source_candidate(const struct model *model, const char *from, const char *name,
                             size_t length, int place)
{
    if (!strcmp(from, "--set"))
        from = model->pipeline.spec;
    const char *slash = strrchr(from, '/');
    if (place == 0)
        return arena_printf(model->arena, "%.*s%.*s", slash ? (int)(slash - from) + 1 : 0, from,
                            (int)length, name);
    return arena_printf(model->arena, "%s%s/%.*s", model->templates_dir, place == 1 ? "" : "/glsl",
                        (int)length, name);
}

/* A path that does not exist counts as inside: opening it fails anyway. */
static bool is_inside(const char *root, const char *path)
{
    char *real = root ? realpath(path, NULL) : NULL;
    size_t length = root ? strlen(root) : 0;
    bool inside = !real || (!strncmp(real, root, length) && real[length] == '/');
    free(real);
    return inside;
}

static const char *allowed_path(const struct model *model, const char *path, const char **reason)
{
    const char *plain = source_path(model->arena, path);
    *reason = strerror(ENOMEM);
    if (!plain || is_inside(model->root, plain))
        return plain;
    *reason = "it is outside the folder that may be read";
    return NULL;
}

const char *source_list(struct model *model, const char *path, const char **reason)
{
    const char *plain = allowed_path(model, path, reason);
    if (!plain || !input_check(plain, SIZE_MAX, reason))
        return NULL;
    *reason = strerror(ENOMEM);
    return list_input(model, plain) ? plain : NULL;
}

/* A module of SPIR-V as GLSL, which has the same meaning and can be read; takes over `words`. */
static char *module_text(struct model *model, char *words, size_t *length, const char **reason)
{
    struct text text = {0};
    char *why = NULL;
    bool good = spirv_cross_whole((const uint32_t *)words, *length / 4, &text, &why);
    free(words);
    *reason = good ? NULL : why ? arena_printf(model->arena, "%s", why) : strerror(ENOMEM);
    free(why);
    if (!good)
        text_free(&text);
    *length = text.length;
    return text.data;
}

const struct source *source_read(struct model *model, const char *path, const char **reason)
{
    const char *plain = allowed_path(model, path, reason);
    struct source *source = arena_alloc(model->arena, sizeof *source);
    if (!source)
        *reason = strerror(ENOMEM);
    if (!plain || !source)
        return NULL;
    char *text = input_read(plain, MOST_SOURCE_BYTES, &source->length, reason);
    if (text && spirv_is_module(text, source->length))
        text = module_text(model, text, &source->length, reason);
    if (!text)
        return NULL;
    source->path = plain;
    source->text = arena_strndup(model->arena, text, source->length);
    free(text);
    if (source->text && list_input(model, source->path))
        return source;
    *reason = strerror(ENOMEM);
    return NULL;
}

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

void diag_error(struct diag *diag, struct loc loc, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_message(diag, SEVERITY_ERROR, loc, format, arguments);
    va_end(arguments);
    note_includes(diag, loc.source);
}

void diag_warning(struct diag *diag, struct loc loc, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_message(diag, SEVERITY_WARNING, loc, format, arguments);
    va_end(arguments);
    note_includes(diag, loc.source);
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

const char *diag_first_error(const struct diag *diag)
{
    for (unsigned i = 0; i < diag->count; i++)
        if (diag->messages[i].severity == SEVERITY_ERROR)
            return diag->messages[i].text;
    return NULL;
}

/* ---- Printing -------------------------------------------------------------------------------- */

static void print_message(FILE *out, const struct message *message)
{
    struct loc loc = message->loc;
    const char *severity = severity_names[message->severity];
    if (loc.source)
        yaml_print(out, loc.source->path, loc.source->text, loc.source->length,
                   (struct yaml_place){loc.line, loc.column, loc.length}, severity, message->text);
    else
        fprintf(out, "diptych-gen: %s: %s\n", severity, message->text);
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

void diag_json(const struct diag *diag, struct text *out)
{
    struct message *sorted = sort_messages(diag);
    out->failed |= !sorted;
    text_add(out, "[");
    for (unsigned i = 0; sorted && i < diag->count; i++) {
        struct loc loc = sorted[i].loc;
        text_add(out, "%s\n    {\"severity\": \"%s\", \"message\": ", i ? "," : "",
                 severity_names[sorted[i].severity]);
        text_add_json(out, sorted[i].text);
        if (loc.source) {
            text_add(out, ", \"file\": ");
            text_add_json(out, loc.source->path);
            text_add(out, ", \"line\": %d, \"column\": %d, \"length\": %d",
                     loc.line < 1 ? 1 : loc.line, loc.line < 1 ? 1 : loc.column,
                     loc.length < 1 ? 1 : loc.length);
        }
        text_add(out, "}");
    }
    text_add(out, diag->count ? "\n  ]" : "]");
    free(sorted);
}

void diag_flush(struct diag *diag)
{
    diag_write(diag, stderr);
}

void diag_write(struct diag *diag, FILE *out)
{
    struct message *sorted = sort_messages(diag);
    if (sorted)
        for (unsigned i = 0; i < diag->count; i++)
            print_message(out, &sorted[i]);
    for (int i = SEVERITY_ERROR; i <= SEVERITY_WARNING; i++)
        if (diag->seen[i] > MOST_MESSAGES)
            fprintf(out, "diptych-gen: %s: %u more of them are not shown\n", severity_names[i],
                    diag->seen[i] - MOST_MESSAGES);
    if (!sorted || diag->failed)
        fputs("diptych-gen: error: out of memory while reporting; some messages are missing\n",
              out);
    free(sorted);
    for (unsigned i = 0; i < diag->count; i++)
        free(diag->messages[i].text);
    diag->count = 0;
    memset(diag->seen, 0, sizeof diag->seen);
    diag->failed = diag->hidden = false;
}
