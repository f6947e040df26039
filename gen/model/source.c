/* The files of a spec; see source.h. */
#include "source.h"
#include "cross.h"
#include "foreign.h"
#include "spirv_check.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/input.h"

enum { MOST_SOURCE_BYTES = 64 << 20 }; /* a spec or a GLSL file */

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

/* A module of SPIR-V that others made: its words in our form, and what spirv-dis prints of it as the text. */
static char *read_module(struct model *model, struct source *source, const char *path,
                         const uint32_t *words, const char **reason)
{
    size_t count = source->length / sizeof *words;
    char *why = NULL, *text = NULL;
    uint32_t *own = NULL;
    *reason = strerror(ENOMEM);
    if (!spirv_check(words, count, &why))
        *reason = why ? arena_printf(model->arena, "%s", why) : *reason;
    else
        own = (text = spirv_disassemble(words, count)) ? spirv_take_in(words, &count, path) : NULL;
    uint32_t *copy = own ? arena_alloc(model->arena, count * sizeof *copy) : NULL;
    if (copy)
        memcpy(copy, own, count * sizeof *copy);
    source->words = copy;
    source->word_count = count;
    source->length = copy ? strlen(text) : 0;
    free(own);
    free(why);
    if (copy)
        return text;
    free(text);
    return NULL;
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
    if (text && spirv_is_module(text, source->length)) {
        char *bytes = text;
        text = read_module(model, source, plain, (const uint32_t *)bytes, reason);
        free(bytes);
    }
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
