/* The author's text of one stage, unchanged: #line, then the file. glslang decides on #if,
 * #include and macros. Only the body of a pass with ranges goes through glslang's preprocessor
 * first, since glsl_range.c must see its loops. */
#include "glsl.h"
#include "model/cache.h"

#include <glslang/build_info.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

/* ---- The preprocessor ------------------------------------------------------------------------ */

/* Leaves out #version and the extension that #include needs, which the whole text has. */
static void drop_head(char *text)
{
    static const char *const heads[] = {"#version", "#extension GL_GOOGLE_include_directive"};
    for (char *line = text; line && *line; line = strchr(line, '\n')) {
        line += *line == '\n';
        for (size_t i = 0; i < DT_ARRAY_COUNT(heads); i++)
            if (!strncmp(line, heads[i], strlen(heads[i])))
                memset(line, ' ', strcspn(line, "\n"));
    }
}

bool glsl_include(const void *user, const char *from, const char *name, struct glslang_file *file)
{
    const struct body_file *found = body_include(user, from, name);
    if (found)
        *file = (struct glslang_file){found->name, found->text, body_text_length(found)};
    return found;
}

void glsl_own_text(const struct glsl *glsl, struct text *out)
{
    text_add(out, "#version 460\n");
    glsl_macros(glsl, out);
    glsl_defines(glsl, out);
    text_add(out, "%s", glsl->parts[PART_BODY].data ? glsl->parts[PART_BODY].data : "");
}

/* Of all that the preprocessor reads; 0: out of memory. */
static void hash_input(const struct glsl *glsl, const struct text *text, uint64_t hash[2])
{
    const uint32_t kind[] = {GLSLANG_VERSION_MAJOR, GLSLANG_VERSION_MINOR, GLSLANG_VERSION_PATCH,
                             glsl->stage, glsl->whole};
    XXH3_state_t *state = text->failed ? NULL : XXH3_createState();
    hash[0] = hash[1] = 0;
    if (!state)
        return;
    XXH3_128bits_reset(state);
    XXH3_128bits_update(state, kind, sizeof kind);
    XXH3_128bits_update(state, text->data, text->length + 1);
    for (uint32_t i = 1; i < glsl->files->count; i++) {
        const struct body_file *file = &glsl->files->list[i];
        XXH3_128bits_update(state, &file->number, sizeof file->number);
        XXH3_128bits_update(state, file->text, body_text_length(file));
    }
    EACH(include, glsl->files->includes, glsl->files->include_count) {
        const uint32_t places[] = {include->from, include->file->number};
        XXH3_128bits_update(state, places, sizeof places);
        XXH3_128bits_update(state, include->name, strlen(include->name) + 1);
    }
    XXH128_hash_t digest = XXH3_128bits_digest(state);
    XXH3_freeState(state);
    hash[0] = digest.high64;
    hash[1] = digest.low64;
}

/* The body behind the preprocessor; free(). NULL: reported. */
static char *preprocess(struct glsl *glsl)
{
    struct text text = {0};
    glsl_own_text(glsl, &text);
    const struct glslang_job job = {.code = text.data,
                                    .stage = glsl->stage,
                                    .whole = glsl->whole,
                                    .include = glsl_include,
                                    .user = glsl->files};
    char *log = NULL, *out = NULL;
    uint64_t hash[2];
    uint32_t *words;
    size_t count;
    hash_input(glsl, &text, hash);
    if (cache_find(glsl->model->cache, hash, "glsl", &words, &count)) {
        out = (char *)words;
    } else {
        out = text.failed || !glslang_start(glsl->whole) ? NULL : glslang_preprocess(&job, &log);
        if (out)
            cache_add(glsl->model->cache, hash, "glsl", (uint32_t *)(void *)out,
                      strlen(out) / 4 + 1);
    }
    if (out)
        drop_head(out);
    else if (log)
        glsl_report(glsl->model, glsl->pass, text.data, log, glsl->diag);
    free(log);
    text_free(&text);
    return out;
}

static bool preprocess_body(struct glsl *glsl)
{
    char *body = preprocess(glsl);
    if (!body)
        return false;
    text_free(&glsl->parts[PART_BODY]);
    text_add(&glsl->parts[PART_BODY], "%s", body);
    free(body);
    glsl->expanded = true;
    return true;
}

/* Whether this stage names the word when its macros and #if are resolved. */
static bool stage_mentions(struct glsl *glsl, const char *word)
{
    char *body = body_mentions(glsl->files, word) ? preprocess(glsl) : NULL;
    bool found = body && find_word(body, word);
    for (uint32_t i = 0; i < glsl->files->count; i++) /* a module has names alone */
        found |= glsl->files->list[i].words && find_word(glsl->files->list[i].code, word);
    free(body);
    return found;
}

/* ---- The body -------------------------------------------------------------------------------- */

/* Whether a file may have a loop over a range: `for (Type v :`. */
static bool has_range_loop(const struct body_files *files)
{
    for (uint32_t i = 0; i < files->count; i++) {
        const char *cursor = files->list[i].code;
        struct token last[4] = {{0}}, token;
        while ((token = token_next(&cursor)).length) {
            if (token_is(token, ":") && (token_is(last[2], "(") || token_is(last[2], "const")))
                return true;
            memmove(last + 1, last, 3 * sizeof *last);
            last[0] = token;
        }
    }
    return false;
}

bool glsl_body(struct glsl *glsl)
{
    const struct body_file *body = &glsl->files->list[0];
    struct text *out = &glsl->parts[PART_BODY];
    text_add(out, "#line 1 %u\n", body->number);
    text_add_bytes(out, body->text, body_text_length(body));
    text_add(out, "\n");
    glsl->own |= body_mentions(glsl->files, "OPENGL") || body_mentions(glsl->files, "VULKAN");
    glsl->subgroups = glsl->pass->fast && glsl->pass->kind == DT_PASS_DISPATCH &&
                      (body_mentions_prefix(glsl->files, "subgroup") ||
                       body_mentions_prefix(glsl->files, "gl_Subgroup") ||
                       body_mentions_prefix(glsl->files, "gl_NumSubgroups"));
    bool ranges = glsl->pass->range_count || has_range_loop(glsl->files);
    return glsl->files->whole || !ranges || (preprocess_body(glsl) && glsl_ranges(glsl));
}

/* ---- What runs behind the body --------------------------------------------------------------- */

/* spirv/entry.c calls it when the body's main has returned. */
void glsl_end(struct glsl *glsl)
{
    struct text *out = &glsl->parts[PART_END];
    if (glsl->stage == STAGE_IS_VERTEX && glsl->pass->layers) {
        glsl->own = true;
        if (glsl->backend != BACKEND_VK)
            return;
        text_add(out,
                 "layout(push_constant) uniform Pass_layer {\n    int pass_layer; /* -1: all */\n"
                 "};\n\n"
                 "/* A device without shaderOutputLayer draws each layer alone, and no vertex of "
                 "others. */\n"
                 "void diptych_end()\n{\n    if (pass_layer >= 0 && %s != pass_layer)\n"
                 "        gl_Position = vec4(65536.0, 0.0, 0.0, 1.0);\n}\n",
                 glsl->files && stage_mentions(glsl, "gl_Layer") ? "gl_Layer" : "0");
    }
}

/* For the library of exact arithmetic, templates/glsl/exact.glsl. */
void glsl_zero(struct glsl *glsl)
{
    static const char *const zero[] = {[STAGE_IS_COMPUTE] = "gl_WorkGroupID.x >> 31",
                                       [STAGE_IS_VERTEX] = "uint(gl_VertexIndex) >> 31",
                                       [STAGE_IS_FRAGMENT] = "uint(gl_FrontFacing) >> 1"};
    if (!glsl->pass->fast)
        text_add(
            &glsl->parts[PART_END],
            "/* Zero, which no compiler knows. */\nuint diptych_zero()\n{\n    return %s;\n}\n",
            zero[glsl->stage]);
}

/* ---- Places ---------------------------------------------------------------------------------- */

/* The line and file of a #line directive; false: another line. */
static bool read_line(const char *at, int *line, unsigned long *number)
{
    char *end;
    if (strncmp(at, "#line ", 6) != 0)
        return false;
    *line = (int)strtol(at + 6, &end, 10);
    end += strspn(end, " \"");
    *number = strtoul(end, NULL, 10);
    return true;
}

struct loc glsl_body_loc(const struct glsl *glsl, const char *body, size_t offset, size_t length)
{
    size_t start = offset; /* of the line */
    while (start > 0 && body[start - 1] != '\n')
        start--;
    int below = 0; /* lines from the directive down */
    for (size_t at = start; at > 0;) {
        size_t previous = at - 1;
        int line;
        unsigned long number;
        while (previous > 0 && body[previous - 1] != '\n')
            previous--;
        if (read_line(body + previous, &line, &number)) {
            if (number < 1 || number > glsl->model->glsl_source_count)
                break;
            struct loc loc = {glsl->model->glsl_sources[number - 1], line + below, 1, 1};
            glsl_find_in_line(&loc, body + offset, length);
            return loc;
        }
        below++;
        at = previous;
    }
    return glsl->pass->shader_loc;
}
