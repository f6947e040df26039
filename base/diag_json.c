/* Diagnostics as JSON; see diag.h. A file of its own: struct text has state, and the library of scenes
 * has none. */
#include "base/diag.h"

static void add_message(void *user, const char *severity, struct loc loc, const char *message)
{
    struct text *out = user;
    bool first = !out->length || out->data[out->length - 1] == '[';
    text_add(out, "%s\n    {\"severity\": \"%s\", \"message\": ", first ? "" : ",", severity);
    text_add_json(out, message);
    if (loc.source) {
        text_add(out, ", \"file\": ");
        text_add_json(out, loc.source->path);
        text_add(out, ", \"line\": %d, \"column\": %d, \"length\": %d", loc.line < 1 ? 1 : loc.line,
                 loc.line < 1 ? 1 : loc.column, loc.length < 1 ? 1 : loc.length);
    }
    text_add(out, "}");
}

void diag_json_text(bool error, const char *message, struct text *out)
{
    add_message(out, error ? "error" : "warning", (struct loc){0}, message);
}

void diag_json(const struct diag *diag, struct text *out)
{
    out->failed |= !diag_each(diag, add_message, out);
}
