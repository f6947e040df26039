/* See initials.h. */
#include "initials.h"

#include <ctype.h>
#include <spirv/unified1/spirv.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "model/leaves.h"
#include "read/body_files.h"

bool glsl_seems_to_initialize(const char *code)
{
    for (const char *at = code; (at = find_word(at, "uniform")); at += strlen("uniform"))
        if (at[strcspn(at, ";={")] == '=')
            return true;
    return strstr(code, "#include");
}

/* A type as blocks have it, where a bool is a uint. False: it has no name. */
static bool add_block_type(const struct spirv *module, uint32_t type, struct text *out)
{
    struct text name = {0};
    bool good = spirv_type_name(module, type, &name) && !name.failed;
    if (good && !strncmp(name.data, "bool", 4))
        text_add(out, "uint%s", name.data + 4);
    else if (good)
        text_add(out, *name.data == 'b' ? "u%s" : "%s", name.data + (*name.data == 'b'));
    text_free(&name);
    return good;
}

/* A number, or the constructor of more. */
static bool add_constant_text(const struct spirv *module, uint32_t id, bool outer, struct text *out)
{
    const uint32_t *constant = spirv_definition(module, id);
    uint32_t parts = spirv_is(constant, SpvOpConstantComposite) ? spirv_length(constant) - 3 : 0;
    char letter = spirv_letter(spirv_definition(module, constant[1]));
    bool named = outer || parts, good = !named || add_block_type(module, constant[1], out);
    float number;
    text_add(out, named ? "(" : "");
    for (uint32_t i = 0; good && i < parts; i++) {
        text_add(out, "%s", i ? ", " : "");
        good = add_constant_text(module, constant[3 + i], false, out);
    }
    memcpy(&number, constant + 3, sizeof number);
    if (spirv_is(constant, SpvOpConstant) && letter == 'f')
        text_add_float(out, (double)number);
    else if (spirv_is(constant, SpvOpConstant) && letter)
        text_add(out, letter == 'i' ? "%d" : "%uu", constant[3]);
    else if (letter == 'b')
        text_add(out, spirv_is(constant, SpvOpConstantTrue) ? "1u" : "0u");
    else if (!parts)
        good = false;
    text_add(out, named ? ")" : "");
    return good;
}

/* HLSL with `static` before each global that has an initializer, which glslang drops of others; free(). */
static char *make_static(const char *text)
{
    struct text out = {0};
    char *code = strdup(text), *begun = NULL, *done = code;
    bool said = false; /* of the declaration that has begun */
    int depth = 0;
    if (code)
        blank_comments(code);
    for (char *at = code; at && *at; at++) {
        if (*at == '#' && !begun) {
            while (at[1] && (at[1] != '\n' || *at == '\\'))
                at++;
            continue;
        }
        if (!begun && !isspace((unsigned char)*at))
            begun = at, said = false;
        depth += strchr("{([", *at) ? 1 : strchr("})]", *at) ? -1 : 0;
        if (*at == '=' && !depth && begun && !said) {
            char *word = (char *)find_word(begun, "uniform");
            if (word && word < at)
                memset(word, ' ', strlen("uniform"));
            text_add(&out, "%.*sstatic ", (int)(begun - done), done);
            done = begun;
            said = true;
        }
        if (!depth && (*at == ';' || (*at == '}' && !said)))
            begun = NULL;
    }
    text_add(&out, "%s", done ? done : "");
    free(code);
    return out.data;
}

struct taking {
    const struct spirv *module;
    uint32_t constant, path[MOST_STEPS]; /* members */
    initial_taker *take;
    void *user;
};

/* A member of a constant, or of all elements of an array: "vec2[2](vec2(1), vec2(0))". type: its name. */
static bool add_member(const struct taking *taking, uint32_t id, uint32_t depth, struct text *type,
                       struct text *out)
{
    const struct spirv *module = taking->module;
    const uint32_t *constant = spirv_definition(module, id), *own = spirv_type(module, id);
    const uint32_t *inner = spirv_definition(module, spirv_element_type(module, constant[1]));
    struct text values = {0}, element = {0};
    bool good = spirv_is(constant, SpvOpConstantComposite);
    if (!spirv_is(inner, SpvOpTypeStruct))
        return add_block_type(module, constant[1], type) &&
               add_constant_text(module, id, true, out);
    if (good && inner == own)
        return add_member(taking, constant[3 + taking->path[depth]], depth + 1, type, out);
    for (uint32_t i = 3; good && i < spirv_length(constant); i++) {
        text_free(&element);
        text_add(&values, i > 3 ? ", " : "");
        good = add_member(taking, constant[i], depth, &element, &values);
    }
    if (good && element.data && !values.failed && !element.failed) {
        int scalar = (int)strcspn(element.data, "[");
        text_add(type, "%.*s[%u]%s", scalar, element.data, spirv_length(constant) - 3,
                 element.data + scalar);
        text_add(out, "%s(%s)", type->data, values.data);
    }
    text_free(&values);
    text_free(&element);
    return good;
}

/* Calls `take` for a constant, or for each member of a struct: NAME_MEMBER, as spirv_each_leaf() has it. */
static void take_leaves(struct taking *taking, uint32_t type, uint32_t depth, const char *name)
{
    const struct spirv *module = taking->module;
    const uint32_t *inner = spirv_definition(module, spirv_element_type(module, type));
    bool members = spirv_is(inner, SpvOpTypeStruct);
    for (uint32_t i = 0; members && depth < MOST_STEPS && i + 2 < spirv_length(inner); i++) {
        struct text leaf = {0};
        const char *member = spirv_member_name(module, inner[1], i);
        text_add(&leaf, "%s_%s", name, member ? member : "");
        taking->path[depth] = i;
        if (!leaf.failed)
            take_leaves(taking, inner[2 + i], depth + 1, leaf.data);
        text_free(&leaf);
    }
    struct text value = {0}, own = {0};
    if (!members && add_member(taking, taking->constant, 0, &own, &value) && !value.failed)
        taking->take(taking->user, name, value.data);
    text_free(&value);
    text_free(&own);
}

void glsl_initials(const struct glslang_job *job, initial_taker *take, void *user)
{
    struct glslang_job own = *job;
    struct spirv module = {0};
    size_t count = 0;
    char *log = NULL;
    if (!job->hlsl && !glsl_seems_to_initialize(job->code))
        return;
    char *globals = job->hlsl ? make_static(job->code) : NULL;
    own.code = globals ? globals : job->code;
    own.opengl = own.whole = !job->hlsl;
    own.marked = own.lines = false;
    uint32_t *words = glslang_compile(&own, &count, &log);
    free(log);
    free(globals);
    if (!words || !spirv_read(&module, words, count))
        return;
    SPIRV_EACH(&module, i, module.declarations, module.count) {
        const uint32_t *variable = i;
        uint32_t value = spirv_is(i, SpvOpVariable) && spirv_length(i) > 4 ? i[4] : 0;
        if (spirv_is(i, SpvOpStore) && job->hlsl) /* where main begins */
            variable = spirv_definition(&module, i[1]), value = i[2];
        if (!value || !spirv_is(variable, SpvOpVariable) ||
            variable[3] != (job->hlsl ? SpvStorageClassPrivate : SpvStorageClassUniformConstant))
            continue;
        const char *name = spirv_name(&module, variable[2]);
        uint32_t opcode = spirv_opcode(spirv_definition(&module, value));
        if (name && opcode >= SpvOpConstantTrue && opcode <= SpvOpConstantNull)
            take_leaves(&(struct taking){&module, value, {0}, take, user},
                        spirv_pointee(&module, variable), 0, name);
    }
    spirv_free(&module);
}

/* Whether textures are in structs of uniforms: glslang 12 leaves them there, 15 makes variables with dots in their names. */
static bool has_structs(const struct spirv *module)
{
    bool found = false;
    SPIRV_EACH(module, i, module->declarations, module->code) {
        if (!spirv_is(i, SpvOpVariable) || i[3] != SpvStorageClassUniformConstant)
            continue;
        const char *name = spirv_name(module, i[2]);
        uint32_t type = spirv_element_type(module, spirv_pointee(module, i));
        found |= spirv_is(spirv_definition(module, type), SpvOpTypeStruct) ||
                 (name && strchr(name, '.'));
    }
    return found;
}

/* In place: what OpenGL calls otherwise than Vulkan. */
static void name_as_vulkan(uint32_t *words, size_t count)
{
    for (size_t at = SPIRV_HEADER; at < count; at += spirv_length(words + at)) {
        uint32_t *i = words + at;
        bool built_in = spirv_is(i, SpvOpDecorate) && i[2] == SpvDecorationBuiltIn;
        if (spirv_is(i, SpvOpExecutionMode) && i[2] == SpvExecutionModeOriginLowerLeft)
            i[2] = SpvExecutionModeOriginUpperLeft;
        if (built_in && i[3] == SpvBuiltInVertexId)
            i[3] = SpvBuiltInVertexIndex;
        if (built_in && i[3] == SpvBuiltInInstanceId)
            i[3] = SpvBuiltInInstanceIndex;
    }
}

uint32_t *glsl_compile_whole(const struct glslang_job *job, size_t *count, char **log)
{
    struct glslang_job own = *job;
    struct spirv module = {0};
    uint32_t *words = glslang_compile(job, count, log);
    bool found = words && job->whole && spirv_open(&module, words, *count) && has_structs(&module);
    spirv_free(&module);
    if (!found)
        return words;
    free(words);
    own.opengl = own.structs = true;
    words = glslang_compile(&own, count, log);
    if (words)
        name_as_vulkan(words, *count);
    return words;
}
