/* See initials.h. */
#include "initials.h"

#include <spirv/unified1/spirv.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "model/leaves.h"
#include "read/body_files.h"

/* Whether an `=` stands in a declaration of a uniform; a name of the macro kind counts as well. */
static bool seems_to_have_some(const char *code)
{
    for (const char *at = code; (at = find_word(at, "uniform")); at += strlen("uniform"))
        if (at[strcspn(at, ";={")] == '=')
            return true;
    return strstr(code, "#include");
}

/* A number, or the constructor of more. */
static bool add_constant_text(const struct spirv *module, uint32_t id, bool outer, struct text *out)
{
    const uint32_t *constant = spirv_definition(module, id),
                   *type = spirv_definition(module, constant[1]);
    uint32_t parts = spirv_is(constant, SpvOpConstantComposite) ? spirv_length(constant) - 3 : 0;
    bool good = true, named = outer || parts;
    float number;
    if (named) {
        struct text name = {0};
        good = spirv_type_name(module, constant[1], &name);
        text_add(out, "%s(", name.data ? name.data : "");
        text_free(&name);
    }
    for (uint32_t i = 0; good && i < parts; i++) {
        text_add(out, "%s", i ? ", " : "");
        good = add_constant_text(module, constant[3 + i], false, out);
    }
    memcpy(&number, constant + 3, sizeof number);
    if (spirv_is(constant, SpvOpConstant) && spirv_letter(type) == 'f')
        text_add_float(out, (double)number);
    else if (spirv_is(constant, SpvOpConstant) && spirv_letter(type))
        text_add(out, spirv_letter(type) == 'i' ? "%d" : "%uu", constant[3]);
    else if (spirv_is(constant, SpvOpConstantTrue) || spirv_is(constant, SpvOpConstantFalse))
        text_add(out, spirv_is(constant, SpvOpConstantTrue) ? "true" : "false");
    else if (!parts)
        good = false;
    text_add(out, named ? ")" : "");
    return good;
}

/* Calls `take` for a constant, or for each member of a struct: NAME_MEMBER, as spirv_each_leaf() has it. */
static void take_leaves(const struct spirv *module, uint32_t id, const char *name,
                        initial_taker *take, void *user)
{
    const uint32_t *constant = spirv_definition(module, id),
                   *type = spirv_definition(module, constant[1]);
    bool members = spirv_is(type, SpvOpTypeStruct) && spirv_is(constant, SpvOpConstantComposite);
    for (uint32_t i = 0; members && i + 2 < spirv_length(type); i++) {
        struct text leaf = {0};
        const char *member = spirv_member_name(module, type[1], i);
        text_add(&leaf, "%s_%s", name, member ? member : "");
        if (!leaf.failed)
            take_leaves(module, constant[3 + i], leaf.data, take, user);
        text_free(&leaf);
    }
    struct text value = {0};
    if (!members && add_constant_text(module, id, true, &value) && !value.failed)
        take(user, name, value.data);
    text_free(&value);
}

void glsl_initials(const struct glslang_job *job, initial_taker *take, void *user)
{
    struct glslang_job own = *job;
    struct spirv module = {0};
    size_t count = 0;
    char *log = NULL;
    if (!seems_to_have_some(job->code))
        return;
    own.opengl = own.whole = true;
    own.marked = own.lines = false;
    uint32_t *words = glslang_compile(&own, &count, &log);
    free(log);
    if (!words || !spirv_read(&module, words, count))
        return;
    SPIRV_EACH(&module, at, module.declarations, module.code)
    {
        const uint32_t *i = module.words + at;
        if (spirv_is(i, SpvOpVariable) && i[3] == SpvStorageClassUniformConstant &&
            spirv_length(i) > 4)
            take_leaves(&module, i[4], spirv_name(&module, i[2]), take, user);
    }
    spirv_free(&module);
}
