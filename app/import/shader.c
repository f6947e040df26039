/* Single shaders as specs. Reflection tells names, kinds and formats; sizes, contents and values are
 * guesses that run, each with a comment. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/input.h"
#include "base/log.h"
#include "import/import.h"
#include "gen/model/cross.h"
#include "gen/model/spirv_check.h"
#include "gen/glsl/glslang.h"
#include "gen/check/check.h"

enum { MOST_NAMES = 512 };

struct shader_file {
    const char *path, *name; /* as given, and in the folder */
    char *text;              /* GLSL */
    int stage;
    struct reflection reflection;
};

struct making {
    struct import *import;
    struct shader_file files[2]; /* compute, fragment, or vertex and fragment */
    int count;
    struct text params, values, images, buffers, samplers, reads, writes, updates, all;
    const char *output; /* the first image that is written */
    bool codes;         /* it has 8 bits */
    const char *names[MOST_NAMES];
    unsigned name_count;
    const char *picture; /* file for textures; NULL: not needed yet */
};

static const struct dt_log *making_log(const struct making *making)
{
    return &making->import->console->log;
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* The stage by the name's ending, before .glsl, .hlsl or .spv; -1: none. */
static int stage_of(const char *path)
{
    static const char *const endings[][2] = {{".comp", ".cs"}, {".vert", ".vs"}, {".frag", ".fs"}};
    const char *slash = strrchr(path, '/');
    for (int stage = 0; stage < 3; stage++)
        for (int i = 0; i < 2; i++) {
            const char *at = strstr(slash ? slash : path, endings[stage][i]);
            char behind = at ? at[strlen(endings[stage][i])] : 'x';
            if (!behind || behind == '.')
                return stage;
        }
    return -1;
}

/* The stage that a module of SPIR-V says. */
static int stage_of_module(const uint32_t *words, size_t count)
{
    for (size_t at = 5; at < count && words[at] >> 16; at += words[at] >> 16)
        if ((words[at] & 0xffff) == 15 && at + 1 < count) /* OpEntryPoint: 0, 4, 5 */
            return words[at + 1] == 5   ? REFLECT_COMPUTE
                   : words[at + 1] == 0 ? REFLECT_VERTEX
                   : words[at + 1] == 4 ? REFLECT_FRAGMENT
                                        : -1;
    return -1;
}

/* Files that the text includes lie beside it, and are copied with it. */
struct including {
    struct making *making;
    const char *path;
};

static bool include(const void *user, const char *from, const char *name, struct glslang_file *file)
{
    const struct including *including = user;
    const char *slash = strrchr(including->path, '/');
    const char *reason;
    char *path = format_string("%.*s/%s", slash ? (int)(slash - including->path) : 1,
                               slash ? including->path : ".", name);
    size_t length = 0;
    char *text = path && !strstr(name, "..") && *name != '/'
                     ? input_read(path, 1 << 24, &length, &reason)
                     : NULL;
    free(path);
    (void)from;
    if (!text || !folder_write(&including->making->import->folder, name, text, length))
        return false;
    *file = (struct glslang_file){"1", text, length}; /* glslang reads it until it ends */
    return true;
}

/* Reads a file, as GLSL, and copies it as it is. */
static bool read_shader(struct making *making, const char *path)
{
    struct shader_file *file = &making->files[making->count++];
    const char *slash = strrchr(path, '/');
    size_t size = 0;
    *file = (struct shader_file){.path = path, .name = slash ? slash + 1 : path};
    char *bytes = file_read(path, &size, making_log(making)), *why = NULL;
    bool good = bytes && folder_write(&making->import->folder, file->name, bytes, size);
    struct text text = {0};
    if (good && spirv_is_module(bytes, size)) {
        const uint32_t *words = (const uint32_t *)bytes;
        good = spirv_check(words, size / 4, &why);
        file->stage = good ? stage_of_module(words, size / 4) : REFLECT_FRAGMENT;
        good = good && spirv_cross_whole(words, size / 4, &text, &why);
        free(bytes);
        bytes = text.data;
    } else {
        file->stage = stage_of(path);
    }
    file->text = bytes;
    struct including including = {making, path};
    if (good && file->stage < 0)
        report_error(making_log(making), "%s: name it .comp, .vert or .frag, by its stage", path);
    else
        good =
            good && reflect(file->text, file->stage, include, &including, &file->reflection, &why);
    if (why)
        report_error(making_log(making), "%s: %s", path, why);
    free(why);
    return good && file->stage >= 0;
}

/* ---- Names ----------------------------------------------------------------------------------- */

/* Whether this is the first time that the stages have the name. */
static bool is_new(struct making *making, const char *name)
{
    for (unsigned i = 0; i < making->name_count; i++)
        if (!strcmp(making->names[i], name))
            return false;
    if (making->name_count < MOST_NAMES)
        making->names[making->name_count++] = name;
    return true;
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* A parameter, where one can have the type and the name; else an expression. */
static bool write_value(struct making *making, const struct reflected *item)
{
    const char *type = item->type;
    bool vector = strstr(type, "vec") != NULL;
    bool plain = !strcmp(type, "float") || !strcmp(type, "int") || !strcmp(type, "uint") ||
                 (vector && *type != 'b' && !strchr(type, '['));
    if (!*type)
        return report_error(making_log(making),
                            "%s: the uniform `%s` is a struct or an array of arrays, which "
                            "has no value in a spec",
                            making->files[0].path, item->name);
    bool real = *type == 'f' || *type == 'v';
    const char *one = real ? "1.0" : "1";
    if (plain && name_is_free(item->name)) {
        int components = vector ? type[strlen(type) - 1] - '0' : 1;
        text_add(&making->params, "  %s: {value: %s", item->name, vector ? "[" : "");
        for (int i = 0; i < components; i++)
            text_add(&making->params, "%s%s", i ? ", " : "", one);
        text_add(&making->params, "%s, type: %s, live: true}  # its value is a guess\n",
                 vector ? "]" : "", type);
        return true;
    }
    const char *bracket = strchr(type, '[');
    text_add(&making->values, "  %s: \"%s(", item->name, type);
    for (int i = 0, count = bracket ? atoi(bracket + 1) : 0; i < count; i++)
        text_add(&making->values, "%s%.*s(1)", i ? ", " : "", (int)strcspn(type, "["), type);
    text_add(&making->values, bracket ? "" : "1");
    text_add(&making->values, ")\"  # a guess\n");
    return true;
}

/* A vertex attribute: three vertices that cover the targets. A fragment's input, where no vertex shader
 * gives it: the place in the picture, 0 to 1. */
static void write_input(struct making *making, const struct reflected *item, int stage)
{
    const char *type = item->type;
    int components = !strncmp(type, "vec", 3) ? type[3] - '0' : 1;
    const char *rest = components == 4 ? ", 0.0, 1.0" : components == 3 ? ", 0.0" : "";
    const char *place =
        stage == REFLECT_FRAGMENT ? "gl_FragCoord.xy / vec2(frame.width, frame.height)"
        : item->location          ? "gl_VertexIndex << 1 & 2, gl_VertexIndex & 2"
                                  : "(gl_VertexIndex << 2 & 4) - 1, (2 * gl_VertexIndex & 4) - 1";
    if (components == 1 || !*type)
        text_add(&making->values, "  %s: \"%s(1)\"  # an input; a guess\n", item->name, type);
    else
        text_add(&making->values, "  %s: \"%s(%s%s)\"  # an input; a guess\n", item->name, type,
                 place, rest);
}

static void write_constant(struct making *making, const struct reflected *item)
{
    text_add(&making->params, "  %s: {value: ", item->name);
    if (!strcmp(item->type, "bool"))
        text_add(&making->params, item->number != 0 ? "true" : "false");
    else if (!strcmp(item->type, "float"))
        text_add_float(&making->params, item->number);
    else
        text_add(&making->params, "%.0f", item->number);
    text_add(&making->params, ", type: %s}  # of specialization\n", item->type);
}

/* ---- Resources ------------------------------------------------------------------------------- */

static void list(struct text *out, const char *name, const char *sampler)
{
    text_add(out, "%s", out->length ? ", " : "");
    if (sampler)
        text_add(out, "{name: %s, sampler: %s}", name, sampler);
    else
        text_add(out, "%s", name);
}

static bool shape_fits(struct making *making, const struct reflected *item)
{
    return (item->shape && name_is_free(item->name)) ||
           report_error(making_log(making),
                        item->shape ? "%s: `%s` cannot be the name of an image"
                                    : "%s: `%s` has a shape that images do not have",
                        making->files[0].path, item->name);
}

/* Plain textures hold the picture, others zeros. */
static bool write_texture(struct making *making, const struct reflected *item)
{
    if (!shape_fits(making, item))
        return false;
    bool flat = !strcmp(item->shape, "2D"), filled = flat && item->scalar == 'f';
    if (filled && !making->picture && !(making->picture = import_picture(making->import)))
        return false;
    text_add(&making->images, "  %s: ", item->name);
    if (filled)
        text_add(&making->images, "{file: %s, format: rgba8}  # any picture\n", making->picture);
    else
        text_add(&making->images,
                 "{format: %s, size: [64, 64%s]%s, history: true}  # size and content "
                 "are guesses\n",
                 item->scalar == 'f'   ? "rgba8"
                 : item->scalar == 'i' ? "rgba32i"
                                       : "rgba32ui",
                 *item->shape == '3' ? ", 64" : "",
                 *item->shape == 'c'           ? ", cube: true"
                 : flat || *item->shape == '3' ? ""
                                               : ", layers: 1");
    const char *sampler = item->scalar == 'f' ? "soft" : "hard";
    if (is_new(making, sampler))
        text_add(&making->samplers, "  %s: {kind: filter, filter: %s, wrap: clamp}  # a guess\n",
                 sampler, item->scalar == 'f' ? "linear" : "nearest");
    list(&making->reads, item->name, sampler);
    return true;
}

static bool write_image(struct making *making, const struct reflected *item)
{
    if (!shape_fits(making, item))
        return false;
    const char *format = item->format          ? item->format
                         : item->scalar == 'i' ? "r32i"
                         : item->scalar == 'u' ? "r32ui"
                                               : "rgba32f";
    bool flat = !strcmp(item->shape, "2D");
    text_add(&making->images, "  %s: {format: %s, size: %s%s%s}  # the size%s a guess\n",
             item->name, format,
             flat                  ? "frame"
             : *item->shape == '3' ? "[64, 64, 64]"
                                   : "[64, 64]",
             *item->shape == 'c'            ? ", cube: true"
             : *item->shape == '2' && !flat ? ", layers: 1"
                                            : "",
             item->reads ? ", history: true" : "", item->format ? " is" : " and the format are");
    list(!item->writes ? &making->reads
         : item->reads ? &making->updates
                       : &making->writes,
         item->name, NULL);
    if (item->writes && flat && !making->output) {
        making->output = item->name;
        making->codes = !strcmp(format, "rgba8");
    }
    return true;
}

static bool write_buffer(struct making *making, const struct reflected *item)
{
    unsigned words = item->bytes / 4;
    if (!name_is_free(item->name))
        return report_error(making_log(making), "%s: `%s` cannot be the name of a buffer",
                            making->files[0].path, item->name);
    text_add(&making->buffers, "  %s: {of: %s, count: %u%s}  # the count is a guess%s\n",
             item->name, *item->type ? item->type : "uint", words > 65536 ? words : 65536,
             item->reads ? ", history: true" : "",
             *item->type ? "" : "; the shader's struct, in words");
    list(!item->writes ? &making->reads
         : item->reads ? &making->updates
                       : &making->writes,
         item->name, NULL);
    return true;
}

/* A target. Those of a draw are in the order of their locations. */
static bool write_output(struct making *making, const struct reflected *item)
{
    static const char *const formats[3][4] = {{"r16f", "rg16f", "rgba16f", "rgba8"},
                                              {"r32i", "rg32i", "rgba32i", "rgba32i"},
                                              {"r32ui", "rg32ui", "rgba32ui", "rgba32ui"}};
    int kind = *item->type == 'i' ? 1 : *item->type == 'u' ? 2 : 0;
    int components = strstr(item->type, "vec") ? item->type[strlen(item->type) - 1] - '0' : 1;
    const char *format = formats[kind][components - 1];
    text_add(&making->images, "  %s: {format: %s, size: frame}  # format and size are guesses\n",
             item->name, format);
    list(&making->writes, item->name, NULL);
    if (!making->output) {
        making->output = item->name;
        making->codes = !strcmp(format, "rgba8");
    }
    return true;
}

static bool write_item(struct making *making, const struct reflected *item, int stage)
{
    bool between =
        (item->kind == REFLECTED_OUTPUT && stage == REFLECT_VERTEX) ||
        (item->kind == REFLECTED_INPUT && stage == REFLECT_FRAGMENT && making->count > 1);
    if (between || !is_new(making, item->name))
        return true;
    switch (item->kind) {
    case REFLECTED_TEXTURE:
        return write_texture(making, item);
    case REFLECTED_IMAGE:
        return write_image(making, item);
    case REFLECTED_BUFFER:
        return write_buffer(making, item);
    case REFLECTED_VALUE:
        return write_value(making, item);
    case REFLECTED_CONSTANT:
        write_constant(making, item);
        return true;
    case REFLECTED_INPUT:
        write_input(making, item, stage);
        return true;
    default:
        return write_output(making, item);
    }
}

static bool write_items(struct making *making)
{
    bool good = true;
    for (int f = 0; f < making->count; f++) {
        const struct reflection *reflection = &making->files[f].reflection;
        for (uint32_t location = 0; location < 8; location++) /* targets in their order */
            for (uint32_t i = 0; good && i < reflection->count; i++)
                if (reflection->list[i].kind == REFLECTED_OUTPUT
                        ? reflection->list[i].location == location
                        : !location)
                    good = write_item(making, &reflection->list[i], making->files[f].stage);
    }
    return good;
}

/* ---- The spec -------------------------------------------------------------------------------- */

static void add_spec_section(struct making *making, const char *key, const struct text *section)
{
    if (section->length)
        text_add(&making->all, "%s:\n%s", key, section->data);
}

static void add_spec_list(struct making *making, const char *key, const struct text *section)
{
    if (section->length)
        text_add(&making->all, "    %s: [%s]\n", key, section->data);
}

static void write_pass(struct making *making)
{
    const struct shader_file *file = &making->files[0];
    struct text *out = &making->all;
    const uint32_t *local = file->reflection.local;
    text_add(out, "passes:\n  - name: run\n");
    if (file->stage != REFLECT_COMPUTE)
        text_add(out, making->count > 1 ? "    draw: {vertices: 3}  # a guess\n"
                                        : "    draw: fullscreen\n");
    else if (making->output)
        text_add(out, "    dispatch: %s  # an invocation for each texel; a guess\n",
                 making->output);
    else
        text_add(out, "    dispatch: 65536  # invocations; a guess\n");
    if (file->stage == REFLECT_COMPUTE)
        text_add(out, "    local: [%u, %u, %u]\n", local[0], local[1], local[2]);
    add_spec_list(making, "reads", &making->reads);
    add_spec_list(making, "writes", &making->writes);
    add_spec_list(making, "updates", &making->updates);
    if (making->count > 1)
        text_add(out, "    shader: [%s, %s]\n", file->name, making->files[1].name);
    else
        text_add(out, "    shader: %s\n", file->name);
    if (making->output)
        text_add(out, "output: {%s: %s}\n", making->codes ? "display" : "linear", making->output);
}

static bool write_spec(struct making *making)
{
    char name[256];
    text_add(&making->all,
             "# By `diptych import`. Lines that say \"guess\" are to fill in: a shader "
             "does not tell them.\npipeline: %s\norigin: top\n",
             making->import->name);
    add_spec_section(making, "params", &making->params);
    add_spec_section(making, "buffers", &making->buffers);
    add_spec_section(making, "images", &making->images);
    add_spec_section(making, "samplers", &making->samplers);
    add_spec_section(making, "values", &making->values);
    write_pass(making);
    snprintf(name, sizeof name, "%s.yaml", making->import->name);
    return !making->all.failed &&
           folder_write(&making->import->folder, name, making->all.data, making->all.length);
}

static bool check_stages(const struct making *making)
{
    bool pair = making->count == 2 && making->files[0].stage == REFLECT_VERTEX &&
                making->files[1].stage == REFLECT_FRAGMENT;
    return pair || (making->count == 1 && making->files[0].stage != REFLECT_VERTEX) ||
           report_error(making_log(making),
                        "%s: give a compute shader, a fragment shader, or a vertex shader "
                        "and a fragment shader",
                        making->files[0].path);
}

bool import_shaders(struct import *import, const char *const *paths)
{
    struct making *making = calloc(1, sizeof *making);
    bool good = making;
    if (making)
        making->import = import;
    for (int i = 0; good && i < 2 && paths[i]; i++)
        good = read_shader(making, paths[i]);
    good = good && check_stages(making) && write_items(making) && write_spec(making);
    for (int i = 0; making && i < making->count; i++) {
        free(making->files[i].text);
        reflect_free(&making->files[i].reflection);
    }
    struct text *texts[] = {&making->params,  &making->values,   &making->images,
                            &making->buffers, &making->samplers, &making->reads,
                            &making->writes,  &making->updates,  &making->all};
    for (size_t i = 0; making && i < DT_ARRAY_COUNT(texts); i++)
        text_free(texts[i]);
    free(making);
    return good;
}
