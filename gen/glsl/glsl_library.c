/* Library pieces: templates/glsl/NAME.glsl is a list of definitions with an empty line between
 * them, and a stage gets those that it uses. */
#include "glsl.h"

#include <string.h>

/* ---- Definitions ----------------------------------------------------------------------------- */

/* The name that a definition declares: after `#define`, after `struct`, before the final `;` of a
 * `layout`, or before the first `(` or `=`. */
static struct token defined_name(const char *text)
{
    const char *macro = strstr(text, "#define "), *cursor = text;
    if (macro)
        cursor = macro + strlen("#define ");
    if (macro)
        return token_next(&cursor);
    struct token token = token_next(&cursor), before = {0};
    if (token_is(token, "struct"))
        return token_next(&cursor);
    if (token_is(token, "layout")) {
        for (; token.length; token = token_next(&cursor))
            before = token_is(token, ";") ? before : token;
        return before;
    }
    for (; token.length && !token_is(token, "(") && !token_is(token, "=");
         token = token_next(&cursor))
        before = token;
    return token.length ? before : (struct token){0};
}

void glsl_fill(struct text *out, const char *text, const char *const *words)
{
    for (const char *next; *text; text = next) {
        const char *const *slot = words;
        next = strchr(text + 1, '@');
        next = next ? next : text + strlen(text);
        while (*slot && strncmp(text, *slot, strlen(*slot)) != 0)
            slot += 2;
        if (*slot) {
            text_add(out, "%s", slot[1]);
            next = text + strlen(*slot);
        } else {
            text_add_bytes(out, text, (size_t)(next - text));
        }
    }
}

const struct source *glsl_library_file(struct glsl *glsl, const char *name)
{
    struct model *model = glsl->model;
    const char *path = arena_printf(model->arena, "%s/glsl/%s.glsl", model->templates_dir, name);
    const struct source *source = path ? glsl_source(model, path) : NULL;
    if (!source)
        diag_error(glsl->diag, glsl->pass->shader_loc, "cannot read the library file %s",
                   path ? path : name);
    return source;
}

void glsl_put_before(struct text *part, struct text *front)
{
    if (part->data)
        text_add_bytes(front, part->data, part->length);
    text_free(part);
    *part = *front;
    *front = (struct text){0};
}

bool glsl_library(struct glsl *glsl, const char *name, const char *layout)
{
    const struct source *source = glsl_library_file(glsl, name);
    const char *const words[] = {"@layout@", layout, NULL};
    if (!source)
        return false;
    size_t end = source->length;
    while (end > 0) { /* from last to first: a definition uses those above it */
        size_t start = end;
        while (start > 0 &&
               !(start >= 2 && source->text[start - 1] == '\n' && source->text[start - 2] == '\n'))
            start--;
        size_t length = end - start;
        while (length && source->text[start + length - 1] == '\n')
            length--;
        const char *text = arena_strndup(glsl->model->arena, source->text + start, length);
        if (!text)
            return false;
        struct token defined = defined_name(text);
        if (defined.length && glsl_uses(glsl, "%.*s", (int)defined.length, defined.text)) {
            struct text front = {0};
            glsl_fill(&front, text, words);
            text_add(&front, "\n\n");
            glsl_put_before(&glsl->parts[PART_LIBRARY], &front);
        }
        end = start;
        while (end > 0 && source->text[end - 1] == '\n')
            end--;
    }
    return true;
}
