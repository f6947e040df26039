/* Single shaders as specs. Reflection tells names, kinds and formats; sizes, contents and values are
 * guesses that run, each with a comment. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/log.h"
#include "import/hlsl.h"
#include "import/import.h"
#include "import/texts.h"
#include "gen/model/cross.h"
#include "gen/model/spirv_check.h"
#include "gen/read/body_files.h"
#include "gen/check/check.h"

enum {
    MOST_ELEMENTS = 4096, /* of a value */
    ELEMENTS = 65536,     /* of a buffer */
    MOST_STRIDE = 64      /* words of an element, of so many */
};
#define MOST_BUFFER ((uint64_t)1 << 30)

struct shader_file {
    const char *path; /* as given */
    char name[1024];  /* in the folder */
    struct import_texts texts;
    int stage;
    bool hlsl;
    struct reflection reflection;
};

struct making {
    struct import *import;
    struct shader_file files[2]; /* compute, fragment, or vertex and fragment */
    int count;
    struct hlsl_links links;
    const struct shader_file *now; /* whose declarations are written */
    struct text params, values, images, buffers, samplers, reads, writes, updates, all;
    const char *output; /* the first image that is written */
    bool codes;         /* it has 8 bits */
    bool guesses;       /* contents are */
    uint32_t targets;   /* behind the last location of an output */
    const char **names;
    uint32_t name_count;
    const char *picture;       /* file for textures; NULL: not needed yet */
    char sampler_names[3][16]; /* "": not needed yet */
};

static const struct dt_log *making_log(const struct making *making)
{
    return &making->import->console->log;
}

/* Returns false. */
#define REFUSE(making, item, ...)                                                                  \
    import_refuse((making)->import, (making)->now->path, (making)->now->texts.list[0].text,        \
                  *(item)->as ? (item)->as : (item)->name, __VA_ARGS__)

/* ---- Files ----------------------------------------------------------------------------------- */

/* The stage by the name's ending, before .glsl, .hlsl or .spv; -1: none. fillCS.hlsl and fill_cs.hlsl are names of HLSL. */
static int stage_of(const char *path)
{
    static const char *const endings[][4] = {{".comp", ".cs", "CS.hlsl", "_cs.hlsl"},
                                             {".vert", ".vs", "VS.hlsl", "_vs.hlsl"},
                                             {".frag", ".fs", "PS.hlsl", "_ps.hlsl"}};
    const char *slash = strrchr(path, '/');
    for (int stage = 0; stage < 3; stage++)
        for (int i = 0; i < 4; i++)
            for (const char *at = slash ? slash : path; (at = strstr(at, endings[stage][i])); at++)
                if (strchr(".", at[strlen(endings[stage][i])]))
                    return stage;
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

/* What glslang says, at the first line that it names. */
static void tell_compiler(const struct making *making, const struct shader_file *file,
                          const char *why)
{
    unsigned number = 0, line = 0;
    int start = 0;
    const char *at = why ? strstr(why, "ERROR: ") : NULL;
    struct source source = {.path = file->path};
    if (at && sscanf(at, "ERROR: %u:%u: %n", &number, &line, &start) < 2 &&
        sscanf(at, "ERROR: %*[^:]:%u: %n", &line, &start) < 1) /* HLSL has the file's name */
        at = NULL;
    if (at && number && number <= file->texts.count)
        source.path = file->texts.list[number - 1].path;
    why = file->texts.excess ? file->texts.excess : at ? at + start : why ? why : "out of memory";
    report_at(making_log(making), (struct loc){&source, at ? (int)line : 0, 1, 1}, "%.*s",
              (int)strcspn(why, "\n"), why);
}

/* The module that HLSL became, beside it in the folder; that is then the shader of the spec. */
static bool write_module(const struct making *making, struct shader_file *file,
                         const uint32_t *words, size_t count)
{
    static const char *const endings[] = {"comp", "vert", "frag"};
    size_t length = strlen(file->name);
    snprintf(file->name + length, sizeof file->name - length, ".%s.spv", endings[file->stage]);
    return folder_write(&making->import->folder, file->name, words, count * sizeof *words);
}

/* Reads a file and copies it as it is, with what it includes. stage: of several that HLSL has; -1: the file says it. */
static bool read_shader(struct making *making, const char *path, int stage)
{
    struct shader_file *file = &making->files[making->count++];
    file->path = path;
    if (!texts_read(&file->texts, making->import, path))
        return false;
    const struct import_source *own = &file->texts.list[0];
    const uint32_t *words = (const uint32_t *)own->text;
    size_t count = own->size / sizeof *words;
    char *why = NULL;
    bool module = spirv_is_module(own->text, own->size);
    bool hlsl = file->hlsl = !module && hlsl_is(path, own->text);
    bool good = !module || spirv_check(words, count, &why);
    file->stage = stage >= 0 ? stage
                  : !module  ? stage_of(path)
                  : good     ? stage_of_module(words, count)
                             : 0;
    if (!module && strlen(own->text) < own->size)
        return report_error(making_log(making), "%s: has a byte of 0: it is no text, and no SPIR-V",
                            path);
    if (file->stage < 0)
        return report_error(making_log(making),
                            module ? "%s: its entry point is of another stage than compute, vertex "
                                     "and fragment, which specs have"
                                   : "%s: name it .comp, .vert or .frag, by its stage",
                            path);
    const struct source source = {.path = path, .text = own->text, .length = own->size};
    if (!module && !hlsl && !source_is_whole(&source)) {
        report_at(making_log(making), (struct loc){&source, 1, 1, 1},
                  "a shader begins with #version: write `#version 460` before all else; name HLSL "
                  ".hlsl");
        return false;
    }
    uint32_t *made =
        hlsl ? hlsl_compile(&file->texts, path, file->stage, &making->links, &count, &why) : NULL;
    if (hlsl)
        good = made && reflect_module(made, count, file->stage, &file->reflection, &why);
    else if (module)
        good = good && reflect_module(words, count, file->stage, &file->reflection, &why);
    else
        good =
            reflect(own->text, file->stage, texts_include, &file->texts, &file->reflection, &why);
    if (!good)
        tell_compiler(making, file, why);
    else if (hlsl)
        hlsl_initials(&file->texts, path, file->stage, &file->reflection);
    free(why);
    good = good && texts_write(&file->texts, "", file->name, sizeof file->name) &&
           (!hlsl || write_module(making, file, made, count));
    free(made);
    char *shown = module && good ? spirv_disassemble(words, count) : NULL;
    if (shown) { /* places of errors are lines of it */
        free(file->texts.list[0].text);
        file->texts.list[0].text = shown;
    }
    if (good && file != making->files && !strcmp(file->name, making->files[0].name))
        good =
            report_error(making_log(making), "%s: both shaders have the name %s", path, file->name);
    return good;
}

/* ---- Names ----------------------------------------------------------------------------------- */

/* Whether this is the first time that the stages have the name. */
static bool is_new(struct making *making, const char *name)
{
    for (uint32_t i = 0; i < making->name_count; i++)
        if (making->names[i] && !strcmp(making->names[i], name))
            return false;
    making->names[making->name_count++] = name;
    return true;
}

/* A sampler's name, which no declaration of the shaders has. */
static const char *sampler_of(struct making *making, const struct reflected *item)
{
    static const char *const kinds[][2] = {{"soft", "filter: linear"},
                                           {"hard", "filter: nearest"},
                                           {"shadow", "filter: linear, compare: true"}};
    int kind = item->depth ? 2 : item->scalar != 'f';
    char *name = making->sampler_names[kind];
    if (*name)
        return name;
    size_t length = strlen(kinds[kind][0]);
    memcpy(name, kinds[kind][0], length + 1);
    for (; !is_new(making, name) && length < 15; name[++length] = 0)
        name[length] = '_';
    text_add(&making->samplers, "  %s: {kind: filter, %s, wrap: clamp}  # a guess\n", name,
             kinds[kind][1]);
    return name;
}

/* ---- Values ---------------------------------------------------------------------------------- */

static int components_of(const char *type)
{
    const char *vector = strstr(type, "vec");
    return vector ? vector[3] - '0' : 1;
}

/* A constructor, of an array with its elements: "vec2[2](vec2(1), vec2(1))". */
static void write_filled(struct text *out, const char *type)
{
    const char *bracket = strchr(type, '[');
    char element[64];
    snprintf(element, sizeof element, "%.*s%s", (int)strcspn(type, "["), type,
             bracket ? strchr(bracket, ']') + 1 : "");
    text_add(out, bracket ? "%s(" : "%s(1", type);
    for (int i = 0, count = bracket ? atoi(bracket + 1) : 0; i < count; i++) {
        text_add(out, "%s", i ? ", " : "");
        write_filled(out, element);
    }
    text_add(out, ")");
}

/* The frame's size, or one over it, where the name says so; NULL: another value. */
static const char *size_named(const struct reflected *item)
{
    static const char *const words[] = {"resolution", "viewport", "dimension", "extent", "size"};
    static const char *const sizes[2][4] = {
        {NULL, "frame.width, frame.height", "frame.width, frame.height, 1",
         "frame.width, frame.height, 1.0 / frame.width, 1.0 / frame.height"},
        {NULL, "1.0 / frame.width, 1.0 / frame.height", "1.0 / frame.width, 1.0 / frame.height, 1",
         NULL}};
    char plain[64] = "";
    size_t length = 0;
    int components = components_of(item->type);
    for (const char *at = item->name; *at && length + 1 < sizeof plain; at++)
        if (*at != '_')
            plain[length++] = (char)tolower((unsigned char)*at);
    bool inverse = strstr(plain, "inv") || strstr(plain, "rcp") || strstr(plain, "texelsize") ||
                   strstr(plain, "pixelsize");
    if (*item->type == 'b' || strchr(item->type, '[') || (inverse && *item->type != 'v'))
        return NULL;
    for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
        if (strstr(plain, words[i]))
            return sizes[inverse][components - 1];
    return NULL;
}

static bool can_be_filled(const struct making *making, const struct reflected *item,
                          const char *what)
{
    double elements = 1;
    for (const char *at = item->type; (at = strchr(at, '[')); at++)
        elements *= atof(at + 1);
    if (!*item->type)
        return REFUSE(making, item,
                      "the %s `%s` has no value in a spec: its type is no float, int, uint, bool, "
                      "vector or matrix, nor an array or struct of these",
                      what, item->name);
    return elements <= MOST_ELEMENTS ||
           REFUSE(making, item,
                  "the %s `%s` is too long for a value of a spec: at most %d elements", what,
                  item->name, MOST_ELEMENTS);
}

/* Whether a parameter has the name in other letters, which are the same in C's macros. */
static bool has_twin(const struct making *making, const char *name)
{
    for (int f = 0; f < making->count; f++)
        for (uint32_t i = 0; i < making->files[f].reflection.count; i++) {
            const struct reflected *item = &making->files[f].reflection.list[i];
            bool param = item->kind == REFLECTED_VALUE || item->kind == REFLECTED_CONSTANT;
            if (param && !strcasecmp(item->name, name) && strcmp(item->name, name) != 0)
                return true;
        }
    return false;
}

/* A parameter, where one can have the type and the name; else an expression. */
static bool write_value(struct making *making, const struct reflected *item)
{
    const char *type = item->type;
    bool vector = strstr(type, "vec") != NULL;
    bool plain = !strcmp(type, "float") || !strcmp(type, "int") || !strcmp(type, "uint") ||
                 (vector && *type != 'b' && !strchr(type, '['));
    if (!can_be_filled(making, item, "uniform"))
        return false;
    bool real = *type == 'f' || *type == 'v';
    const char *one = real ? "1.0" : "1", *size = item->initial ? NULL : size_named(item);
    if (plain && !size && name_is_free(item->name) && !has_twin(making, item->name)) {
        text_add(&making->params, "  %s: {value: %s", item->name, vector ? "[" : "");
        for (const char *at = item->initial ? strchr(item->initial, '(') + 1 : ")"; *at != ')';
             at++)
            text_add(&making->params, *at == 'u' ? "" : "%c", *at);
        for (int i = 0; !item->initial && i < components_of(type); i++)
            text_add(&making->params, "%s%s", i ? ", " : "", one);
        text_add(&making->params, "%s, type: %s, live: true}%s\n", vector ? "]" : "", type,
                 item->initial ? "" : "  # its value is a guess");
        return true;
    }
    text_add(&making->values, "  %s: \"", item->name);
    if (item->initial)
        text_add(&making->values, "%s", item->initial);
    else if (size)
        text_add(&making->values, "%s(%s)", type, size);
    else
        write_filled(&making->values, type);
    text_add(&making->values, item->initial ? "\"\n" : "\"  # a guess\n");
    return true;
}

/* A vertex attribute: three vertices that cover the targets. A fragment's input, where no vertex shader
 * gives it: the place in the picture, 0 to 1. */
static bool write_input(struct making *making, const struct reflected *item, int stage)
{
    const char *type = item->type;
    int components = components_of(type);
    const char *rest = components == 4 ? ", 0.0, 1.0" : components == 3 ? ", 0.0" : "";
    const char *place =
        stage == REFLECT_FRAGMENT ? "gl_FragCoord.xy / vec2(frame.width, frame.height)"
        : item->location          ? "gl_VertexIndex << 1 & 2, gl_VertexIndex & 2"
                                  : "(gl_VertexIndex << 2 & 4) - 1, (2 * gl_VertexIndex & 4) - 1";
    if (!can_be_filled(making, item, "input"))
        return false;
    text_add(&making->values, "  %s: \"", item->name);
    if (components == 1 || *type != 'v' || strchr(type, '['))
        write_filled(&making->values, type);
    else
        text_add(&making->values, "%s(%s%s)", type, place, rest);
    text_add(&making->values, "\"  # an input; a guess\n");
    return true;
}

static bool write_constant(struct making *making, const struct reflected *item)
{
    bool real = !strcmp(item->type, "float"), truth = !strcmp(item->type, "bool");
    bool whole = !strcmp(item->type, "int") || !strcmp(item->type, "uint");
    if ((!real && !truth && !whole) || !name_is_free(item->name))
        return true; /* it keeps its value */
    if (!isfinite(item->number))
        return REFUSE(making, item, "the constant `%s` is not finite, which a spec cannot say",
                      item->name);
    text_add(&making->params, "  %s: {value: ", item->name);
    if (truth)
        text_add(&making->params, item->number != 0 ? "true" : "false");
    else if (real)
        text_add_float(&making->params, item->number);
    else
        text_add(&making->params, "%.0f", item->number);
    text_add(&making->params, ", type: %s}  # of specialization\n", item->type);
    return true;
}

/* ---- Resources ------------------------------------------------------------------------------- */

/* `value` of `key`; NULL: none. */
static void list(struct text *out, const struct reflected *item, const char *key, const char *value)
{
    bool plain = !value && !*item->as;
    text_add(out, "%s%s%s", out->length ? ", " : "", plain ? "" : "{name: ", item->name);
    if (value)
        text_add(out, ", %s: %s", key, value);
    if (*item->as)
        text_add(out, ", as: %s", item->as);
    text_add(out, plain ? "" : "}");
}

static bool shape_fits(struct making *making, const struct reflected *item)
{
    return item->shape ||
           REFUSE(making, item, "`%s` is %s, which specs do not have",
                  *item->as ? item->as : item->name,
                  *item->type ? item->type
                              : "an array of more than 16, or by an index that is not constant");
}

/* Whether two names of the shader are no single resource that it writes. */
static bool is_alone(struct making *making, const struct reflected *item)
{
    const struct reflection *reflection = &making->now->reflection;
    const struct reflected *other = reflection->list;
    for (; other < item; other++)
        if (other->kind == item->kind && other->set == item->set && item->binding != UINT32_MAX &&
            other->binding == item->binding && (other->writes || item->writes) &&
            strcmp(other->name, item->name) != 0)
            return REFUSE(making, item,
                          "`%s` is the resource that `%s` is, by its binding: a pass of a spec has "
                          "one name for each",
                          *item->as ? item->as : item->name, *other->as ? other->as : other->name);
    return true;
}

/* Plain textures hold the picture, others zeros. */
static bool write_texture(struct making *making, const struct reflected *item)
{
    if (!shape_fits(making, item))
        return false;
    bool flat = !strcmp(item->shape, "2D");
    bool filled = flat && item->scalar == 'f' && !item->depth;
    if (filled && !making->picture && !(making->picture = import_picture(making->import)))
        return false;
    text_add(&making->images, "  %s: ", item->name);
    making->guesses |= !filled;
    if (filled)
        text_add(&making->images, "{file: %s, format: rgba8}  # any picture\n", making->picture);
    else
        text_add(&making->images,
                 "{format: %s, size: [64, 64%s]%s%s, history: true}  # size and content "
                 "are guesses\n",
                 item->depth           ? "d32f"
                 : item->scalar == 'f' ? "rgba8"
                 : item->scalar == 'i' ? "rgba32i"
                                       : "rgba32ui",
                 *item->shape == '3' ? ", 64" : "", *item->shape == 'c' ? ", cube: true" : "",
                 !strstr(item->shape, "array") ? ""
                 : *item->shape == 'c'         ? ", layers: 6"
                                               : ", layers: 1");
    list(&making->reads, item, "sampler", sampler_of(making, item));
    return true;
}

/* What is stored keeps its content where no invocation writes. */
static bool write_image(struct making *making, const struct reflected *item)
{
    if (!shape_fits(making, item))
        return false;
    const char *format = item->format          ? item->format
                         : item->scalar == 'i' ? "r32i"
                         : item->scalar == 'u' ? "r32ui"
                                               : "rgba32f";
    bool flat = !strcmp(item->shape, "2D");
    if (!is_alone(making, item))
        return false;
    making->guesses |= item->reads;
    if (item->writes && making->now->stage == REFLECT_VERTEX)
        return REFUSE(making, item,
                      "a vertex shader stores in `%s`; in images of a spec, fragments do",
                      item->name);
    text_add(&making->images,
             "  %s: {format: %s, size: %s%s%s, history: true}  # the size%s a guess\n", item->name,
             format,
             flat                  ? "frame"
             : *item->shape == '3' ? "[64, 64, 64]"
                                   : "[64, 64]",
             *item->shape == 'c' ? ", cube: true" : "",
             !strstr(item->shape, "array") ? ""
             : *item->shape == 'c'         ? ", layers: 6"
                                           : ", layers: 1",
             item->format ? " is" : " and the format are");
    list(item->writes ? &making->updates : &making->reads, item, "stores",
         item->writes && making->now->stage == REFLECT_FRAGMENT ? "true" : NULL);
    if (item->writes && flat && !making->output) {
        making->output = item->name;
        making->codes = !strcmp(format, "rgba8");
    }
    return true;
}

static bool write_buffer(struct making *making, const struct reflected *item)
{
    int components = components_of(item->type);
    uint64_t count = item->bytes / 4 / (uint64_t)(components == 3 ? 4 : components);
    uint64_t words = item->stride / 4 ? item->stride / 4 : 1; /* of an element of a struct */
    uint64_t least = ELEMENTS * (words < MOST_STRIDE ? words : MOST_STRIDE);
    if (!is_alone(making, item))
        return false;
    if (item->bytes > MOST_BUFFER)
        return REFUSE(making, item, "the buffer `%s` has more than 1 GiB", item->name);
    text_add(&making->buffers,
             "  %s: {of: %s, count: %u, history: true}  # the count is a guess%s\n", item->name,
             *item->type ? item->type : "uint", (unsigned)(count > least ? count : least),
             *item->type ? "" : "; the shader's struct, in words");
    list(item->writes ? &making->updates : &making->reads, item, NULL, NULL);
    making->guesses |= item->reads;
    return true;
}

/* What a draw without colours leaves. */
static void write_depth(struct making *making)
{
    struct reflected depth = {.name = "depth"};
    if (!is_new(making, "depth"))
        memcpy(depth.name, "depth_", sizeof "depth_");
    text_add(&making->images, "  %s: {format: d32f, size: frame}\n", depth.name);
    list(&making->writes, &depth, NULL, NULL);
}

/* A target. Those of a draw are in the order of their locations. */
static bool write_output(struct making *making, const struct reflected *item)
{
    static const char *const formats[3][4] = {{"r16f", "rg16f", "rgba16f", "rgba8"},
                                              {"r32i", "rg32i", "rgba32i", "rgba32i"},
                                              {"r32ui", "rg32ui", "rgba32ui", "rgba32ui"}};
    int kind = *item->type == 'i' ? 1 : *item->type == 'u' ? 2 : 0;
    if (!*item->type || strchr(item->type, '[') || strstr(item->type, "mat"))
        return REFUSE(making, item,
                      "the output `%s` is an array or no vector; targets have a name each",
                      item->name);
    const char *format = formats[kind][components_of(item->type) - 1];
    text_add(&making->images, "  %s: {format: %s, size: frame}  # format and size are guesses\n",
             item->name, format);
    list(&making->writes, item, NULL, NULL);
    if (!making->output) {
        making->output = item->name;
        making->codes = !strcmp(format, "rgba8");
    }
    return true;
}

static bool has_resource(const struct making *making, const char *name, const char *as)
{
    for (int f = 0; f < making->count; f++)
        for (uint32_t i = 0; i < making->files[f].reflection.count; i++) {
            const struct reflected *item = &making->files[f].reflection.list[i];
            if (!strcmp(item->name, name) && strcmp(item->as, as) != 0)
                return true;
        }
    return false;
}

/* Resources get names that a spec can say. */
static void rename_resources(struct making *making, struct reflection *reflection)
{
    for (uint32_t i = 0; i < reflection->count; i++) {
        struct reflected *item = &reflection->list[i];
        bool resource = item->kind != REFLECTED_VALUE && item->kind != REFLECTED_INPUT &&
                        item->kind != REFLECTED_CONSTANT;
        if (!resource || name_is_free(item->name))
            continue;
        memcpy(item->as, item->name, sizeof item->as);
        import_identifier(item->as, item->name, 64);
        for (size_t length = strlen(item->name);
             length < 200 && has_resource(making, item->name, item->as);)
            memcpy(item->name + length++, "p", 2);
    }
}

/* An initializer counts in both stages. */
static void share_initials(struct reflection *from, struct reflection *to)
{
    for (uint32_t i = 0; i < from->count; i++)
        for (uint32_t k = 0; from->list[i].initial && k < to->count; k++)
            if (to->list[k].kind == REFLECTED_VALUE && !to->list[k].initial &&
                !strcmp(from->list[i].name, to->list[k].name))
                to->list[k].initial = strdup(from->list[i].initial);
}

/* Whether the uniforms of one name have one type and initializer, since a spec gives them one value. */
static bool is_alike(struct making *making, const struct reflected *item)
{
    for (int f = 0; f < making->count; f++)
        for (uint32_t i = 0; i < making->files[f].reflection.count; i++) {
            const struct reflected *other = &making->files[f].reflection.list[i];
            if (other->kind == REFLECTED_VALUE && !strcmp(other->name, item->name) &&
                (strcmp(other->type, item->type) != 0 ||
                 (other->initial && item->initial && strcmp(other->initial, item->initial) != 0)))
                return REFUSE(making, item,
                              "two uniforms have the name `%s`, and other types or initializers; a "
                              "spec has one value for a name",
                              item->name);
        }
    return true;
}

static bool write_item(struct making *making, const struct reflected *item, int stage)
{
    bool between =
        (item->kind == REFLECTED_OUTPUT && stage == REFLECT_VERTEX) ||
        (item->kind == REFLECTED_INPUT && stage == REFLECT_FRAGMENT && making->count > 1);
    if (between || !is_new(making, item->name))
        return between || item->kind != REFLECTED_VALUE || is_alike(making, item);
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
        return write_constant(making, item);
    case REFLECTED_INPUT:
        return write_input(making, item, stage);
    default:
        return write_output(making, item);
    }
}

/* Those at a location, in the order of which the targets of a draw stand, without gaps. */
static bool write_outputs(struct making *making, const struct reflection *reflection,
                          uint32_t location)
{
    bool good = true, draws = making->now->stage == REFLECT_FRAGMENT;
    for (uint32_t i = 0; good && i < reflection->count; i++) {
        const struct reflected *item = &reflection->list[i];
        bool here = location < MOST_TARGETS ? item->location == location
                                            : item->location >= location && draws;
        if (item->kind != REFLECTED_OUTPUT || !here)
            continue;
        if (location == MOST_TARGETS)
            good =
                REFUSE(making, item,
                       "the output `%s` has a location above 7, or is a second source of blending",
                       item->name);
        else if (draws && location > making->targets)
            good = REFUSE(making, item, "the output `%s` has location %u, but no output has %u",
                          item->name, location, making->targets);
        else
            good = write_item(making, item, making->now->stage);
        making->targets = draws ? location + 1 : 0;
    }
    return good;
}

static bool write_items(struct making *making)
{
    size_t count = making->files[0].reflection.count + making->files[1].reflection.count;
    bool good = (making->names =
                     calloc(count + DT_ARRAY_COUNT(making->sampler_names), sizeof *making->names));
    for (int f = 0; f < making->count; f++) {
        rename_resources(making, &making->files[f].reflection);
        share_initials(&making->files[!f].reflection, &making->files[f].reflection);
    }
    for (int f = 0; good && f < making->count; f++) {
        const struct reflection *reflection = &making->files[f].reflection;
        making->now = &making->files[f];
        for (uint32_t i = 0; good && i < reflection->count; i++)
            if (reflection->list[i].kind != REFLECTED_OUTPUT)
                good = write_item(making, &reflection->list[i], making->now->stage);
        for (uint32_t location = 0; good && location <= MOST_TARGETS; location++)
            good = write_outputs(making, reflection, location);
    }
    if (good && !making->writes.length && making->files[0].stage != REFLECT_COMPUTE)
        write_depth(making);
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
    else if (!file->reflection.spread)
        text_add(out, "    dispatch: [%u, %u, %u]  # one workgroup: none knows which it is\n",
                 local[0], local[1], local[2]);
    else if (making->output)
        text_add(out, "    dispatch: %s  # an invocation for each texel; a guess\n",
                 making->output);
    else
        text_add(out, "    dispatch: %u  # invocations; a guess\n", local[0] > 1 ? 65536 : 65535);
    if (file->stage == REFLECT_COMPUTE)
        text_add(out, "    local: [%u, %u, %u]\n", local[0], local[1], local[2]);
    add_spec_list(making, "reads", &making->reads);
    add_spec_list(making, "writes", &making->writes);
    add_spec_list(making, "updates", &making->updates);
    if (file->reflection.subgroups)
        text_add(out, "    exactness: fast  # subgroups differ from device to device\n");
    if (making->guesses)
        text_add(out, "    allow: {content: \"what the host keeps in a buffer or an image is a "
                      "guess\"}\n");
    if (making->count > 1)
        text_add(out, "    shader: [\"%s\", \"%s\"]\n", file->name, making->files[1].name);
    else
        text_add(out, "    shader: \"%s\"\n", file->name);
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

/* A file may have an entry point for each of two stages, if it is HLSL. */
static bool read_file(struct making *making, const char *path)
{
    if (!hlsl_is(path, NULL) || stage_of(path) >= 0)
        return making->count < 2 && read_shader(making, path, -1);
    size_t size;
    char *text = file_read(path, &size, making_log(making));
    unsigned stages = text ? hlsl_stages(text) : 0, left = stages;
    bool good = text;
    for (int stage = 0; good && stages && stage < 3; stage++, left >>= 1)
        if (left & 1 && making->count < 2)
            good = read_shader(making, path, stage);
    free(text);
    return good && (stages || read_shader(making, path, -1));
}

bool import_shaders(struct import *import, const char *const *paths)
{
    struct making *making = calloc(1, sizeof *making);
    bool good = making;
    if (making)
        making->import = import;
    for (int i = 0; good && i < 2 && paths[i]; i++)
        good = read_file(making, paths[i]);
    good = good && check_stages(making) && write_items(making) && write_spec(making);
    for (int i = 0; making && i < making->count; i++) {
        texts_free(&making->files[i].texts);
        reflect_free(&making->files[i].reflection);
    }
    struct text *texts[] = {&making->params,  &making->values,   &making->images,
                            &making->buffers, &making->samplers, &making->reads,
                            &making->writes,  &making->updates,  &making->all};
    for (size_t i = 0; making && i < DT_ARRAY_COUNT(texts); i++)
        text_free(texts[i]);
    if (making)
        free(making->names);
    free(making);
    return good;
}
