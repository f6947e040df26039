/* The files of a spec; see source.h. */
#include "source.h"
#include "cross.h"
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

/* A module of SPIR-V as GLSL, which has the same meaning and can be read; takes over `words`. */
static char *module_text(struct model *model, char *words, size_t *length, const char **reason)
{
    struct text text = {0};
    char *why = NULL;
    bool good = spirv_check((const uint32_t *)words, *length / 4, &why) &&
                spirv_cross_whole((const uint32_t *)words, *length / 4, &text, &why);
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
