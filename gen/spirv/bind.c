/* See bind.h. */
#include "bind.h"

#include <spirv/unified1/spirv.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "panel.h"

struct binder {
    const struct spirv *module;
    const struct bind_request *request;
    struct spirv_edit edit;
    struct spirv_words begin; /* body of diptych_begin() */
    bool *live;               /* by function: the entry point reaches it */
    uint32_t *moved;          /* by id: a variable's private one, or a pointer's self; 0: stays */
    int *bindings;            /* by id: 1 + binding of a resource; 0: none */
    unsigned char *types;     /* by id: LOOSE, KEPT */
    char **why;
};
enum { LOOSE = 1, KEPT = 2 }; /* reached by variables that move, by others */

__attribute__((format(printf, 2, 3))) static bool refuse(struct binder *binder, const char *format,
                                                         ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (!*binder->why && vasprintf(binder->why, format, arguments) < 0)
        *binder->why = NULL;
    va_end(arguments);
    return false;
}

/* ---- Look-ups -------------------------------------------------------------------------------- */

/* The author's name: those that stepped aside for the generator's have a prefix (glsl_messages.c). */
const char *bind_own_name(const char *name)
{
    return name && !strncmp(name, "body_", 5) ? name + 5 : name;
}

static bool is_decorated(const struct spirv *module, uint32_t id, uint32_t decoration)
{
    return spirv_decoration(module, id, decoration) != UINT32_MAX;
}

static uint32_t pointee(const struct spirv *module, const uint32_t *variable)
{
    return spirv_definition(module, variable[1])[3];
}

/* Its name, or that of its block, without the layers of arrays. */
static const char *name_of(const struct spirv *module, const uint32_t *variable)
{
    const char *name = spirv_name(module, variable[2]);
    uint32_t type = pointee(module, variable);
    while (spirv_is(spirv_definition(module, type), SpvOpTypeArray))
        type = spirv_definition(module, type)[2];
    if (!name || !*name)
        name = spirv_name(module, type);
    return name ? bind_own_name(name) : "?";
}

static bool is_generators(const struct binder *binder, const uint32_t *variable)
{
    return variable[2] >= binder->request->first;
}

/* Whether it moves: a block of uniforms, push constants, or an input. */
static bool has_values(const struct binder *binder, const uint32_t *variable)
{
    const struct spirv *module = binder->module;
    uint32_t type = pointee(module, variable);
    if (is_generators(binder, variable))
        return false;
    switch (variable[3]) {
    case SpvStorageClassPushConstant:
        return true;
    case SpvStorageClassUniform:
        return !is_decorated(module, type, SpvDecorationBufferBlock);
    case SpvStorageClassInput:
        return binder->request->inputs &&
               !is_decorated(module, variable[2], SpvDecorationBuiltIn) &&
               spirv_member_decoration(module, type, 0, SpvDecorationBuiltIn) == UINT32_MAX;
    default:
        return false;
    }
}

static bool is_resource(const struct binder *binder, const uint32_t *variable)
{
    return !is_generators(binder, variable) &&
           (variable[3] == SpvStorageClassUniformConstant ||
            variable[3] == SpvStorageClassStorageBuffer ||
            (variable[3] == SpvStorageClassUniform && !has_values(binder, variable)));
}

/* ---- What the entry point reaches ------------------------------------------------------------ */

static void mark_live(struct binder *binder, uint32_t function)
{
    const struct spirv *module = binder->module;
    const struct spirv_function *own = spirv_function_of(module, function);
    bool *live = &binder->live[own - module->functions];
    if (*live)
        return;
    *live = true;
    SPIRV_EACH(module, at, own->begin, own->end)
    if (spirv_is(module->words + at, SpvOpFunctionCall))
        mark_live(binder, module->words[at + 3]);
}

static bool mentions(const uint32_t *instruction, uint32_t id)
{
    for (uint32_t word = 1; word < spirv_length(instruction); word++)
        if (instruction[word] == id && !spirv_is_literal(instruction, word))
            return true;
    return false;
}

/* Whether a live function uses the variable. members: which of the struct's; all for a use as a
 * whole. NULL: not asked. */
static bool find_uses(const struct binder *binder, uint32_t variable, bool *members, uint32_t count)
{
    const struct spirv *module = binder->module;
    bool used = false;
    for (uint32_t f = 0; f < module->function_count; f++) {
        if (!binder->live[f])
            continue;
        SPIRV_EACH(module, at, module->functions[f].begin, module->functions[f].end)
        {
            const uint32_t *i = module->words + at;
            if (!mentions(i, variable))
                continue;
            used = true;
            bool chain = (spirv_is(i, SpvOpAccessChain) || spirv_is(i, SpvOpInBoundsAccessChain)) &&
                         spirv_length(i) > 4;
            uint32_t index = chain ? spirv_definition(module, i[4])[3] : UINT32_MAX;
            for (uint32_t m = 0; members && m < count; m++)
                members[m] |= m == index || index >= count;
        }
    }
    return used;
}

static void mark_type(struct binder *binder, uint32_t type, unsigned char mark)
{
    const uint32_t *declared = spirv_definition(binder->module, type);
    if (binder->types[type] & mark)
        return;
    binder->types[type] |= mark;
    if (spirv_is(declared, SpvOpTypeArray) || spirv_is(declared, SpvOpTypeRuntimeArray))
        mark_type(binder, declared[2], mark);
    for (uint32_t i = 2; spirv_is(declared, SpvOpTypeStruct) && i < spirv_length(declared); i++)
        mark_type(binder, declared[i], mark);
}

/* ---- Values ---------------------------------------------------------------------------------- */

static uint32_t put_typed(struct binder *binder, uint32_t opcode, uint32_t type,
                          const uint32_t *operands, uint32_t count)
{
    uint32_t all[8] = {type, binder->edit.bound++};
    memcpy(all + 2, operands, count * sizeof *operands);
    spirv_put(&binder->edit, &binder->begin, opcode, all, count + 2);
    return all[1];
}

static uint32_t pointer_to(struct binder *binder, uint32_t type)
{
    return spirv_declare(&binder->edit, SpvOpTypePointer, 0,
                         (uint32_t[]){SpvStorageClassPrivate, type}, 2);
}

static uint32_t put_place(struct binder *binder, uint32_t pointer, uint32_t index, uint32_t type)
{
    uint32_t int_type = spirv_declare(&binder->edit, SpvOpTypeInt, 0, (uint32_t[]){32, 1}, 2);
    uint32_t constant = spirv_declare(&binder->edit, SpvOpConstant, int_type, &index, 1);
    return put_typed(binder, SpvOpAccessChain, pointer_to(binder, type),
                     (uint32_t[]){pointer, constant}, 2);
}

static uint32_t length_of(const struct spirv *module, const uint32_t *array)
{
    return spirv_is(array, SpvOpTypeArray) ? spirv_definition(module, array[3])[3] : 0;
}

/* Stores a value in a variable whose type may be laid out in memory: a bool is a uint there, arrays
 * have a stride. False: the types differ. */
static bool put_store(struct binder *binder, uint32_t pointer, uint32_t type, uint32_t value,
                      uint32_t value_type)
{
    const struct spirv *module = binder->module;
    const uint32_t *to = spirv_definition(module, type),
                   *from = spirv_definition(module, value_type);
    uint32_t length = length_of(module, to);
    if (spirv_is(from, SpvOpTypeBool) && spirv_is(to, SpvOpTypeInt)) {
        uint32_t one = spirv_declare(&binder->edit, SpvOpConstant, type, (uint32_t[]){1}, 1);
        uint32_t zero = spirv_declare(&binder->edit, SpvOpConstant, type, (uint32_t[]){0}, 1);
        value = put_typed(binder, SpvOpSelect, type, (uint32_t[]){value, one, zero}, 3);
    } else if (length && length == length_of(module, from) && type != value_type) {
        bool good = true;
        for (uint32_t i = 0; good && i < length; i++) {
            uint32_t element =
                put_typed(binder, SpvOpCompositeExtract, from[2], (uint32_t[]){value, i}, 2);
            good = put_store(binder, put_place(binder, pointer, i, to[2]), to[2], element, from[2]);
        }
        return good;
    } else if (type != value_type) {
        return false;
    }
    SPIRV_PUT(&binder->edit, &binder->begin, SpvOpStore, pointer, value);
    return true;
}

static bool put_value(struct binder *binder, const char *name, uint32_t pointer, uint32_t type)
{
    const struct spirv *module = binder->module;
    char wanted[300];
    snprintf(wanted, sizeof wanted, "diptych_value_%s(", name);
    const struct spirv_function *found = spirv_find_function(module, wanted);
    if (found) {
        const uint32_t *function = spirv_definition(module, found->id);
        uint32_t value =
            put_typed(binder, SpvOpFunctionCall, function[1], (uint32_t[]){function[2]}, 1);
        return put_store(binder, pointer, type, value, function[1]) ||
               refuse(binder, "the shader declares `%s` with another type than its value has",
                      name);
    }
    return refuse(binder,
                  "the shader reads `%s`, which has no value: declare a parameter of this name, or "
                  "give it one in `values`",
                  name);
}

/* The variable becomes a private one; diptych_begin() fills what is used of it. */
static bool move_variable(struct binder *binder, const uint32_t *variable)
{
    const struct spirv *module = binder->module;
    uint32_t type = pointee(module, variable), id = variable[2];
    const uint32_t *declared = spirv_definition(module, type);
    bool block = variable[3] != SpvStorageClassInput && spirv_is(declared, SpvOpTypeStruct);
    uint32_t count = block ? spirv_length(declared) - 2 : 0;
    bool *members = calloc(count + 1, sizeof *members), good = true;
    if (!members)
        return false;
    bool used = find_uses(binder, id, members, count);
    uint32_t moved = binder->moved[id] = binder->edit.bound++;
    SPIRV_PUT(&binder->edit, &binder->edit.declarations, SpvOpVariable, pointer_to(binder, type),
              moved, SpvStorageClassPrivate);
    spirv_put_name(&binder->edit, moved, name_of(module, variable));
    if (used && !block)
        good = put_value(binder, name_of(module, variable), moved, type);
    for (uint32_t m = 0; m < count; m++)
        if (members[m])
            good &= put_value(binder, bind_own_name(spirv_member_name(module, type, m)),
                              put_place(binder, moved, m, declared[2 + m]), declared[2 + m]);
    free(members);
    return good;
}

/* ---- Resources ------------------------------------------------------------------------------- */

/* Whether the shader declares what the pass binds; drivers crash where it does not. */
static bool check_kind(struct binder *binder, const uint32_t *variable, const uint32_t *type,
                       const struct bind_slot *slot)
{
    bool sampler = spirv_is(type, SpvOpTypeSampledImage), image = spirv_is(type, SpvOpTypeImage);
    bool uniform = variable[3] == SpvStorageClassUniform &&
                   is_decorated(binder->module, type[1], SpvDecorationBlock);
    bool texture = slot->kind & DT_READ_TEXTURE, block = slot->kind & DT_READ_UNIFORM;
    if ((sampler || image) && sampler != texture)
        return refuse(binder,
                      texture ? "`%s` is an image, but the pass reads it as a texture: declare a "
                                "sampler, as sampler2D"
                              : "`%s` is a sampler, but the pass takes it as an image: add "
                                "`sampler` to what it reads, or declare image2D",
                      slot->name);
    const uint32_t *depth = sampler ? spirv_definition(binder->module, type[2]) : NULL;
    if (depth && depth[4] < 2 && slot->compare != depth[4])
        return refuse(binder,
                      slot->compare ? "`%s` is read by a sampler that compares depths: declare "
                                      "sampler2DShadow, or a sampler without compare"
                                    : "`%s` compares depths: read an image of format d32f by a "
                                      "sampler with compare: true",
                      slot->name);
    if (!sampler && !image && uniform != block)
        return refuse(binder,
                      block ? "`%s` is a buffer, but the pass binds it as a uniform block"
                            : "`%s` is a uniform block, but the pass binds it as a buffer",
                      slot->name);
    return true;
}

static bool bind_variable(struct binder *binder, const uint32_t *variable)
{
    const struct spirv *module = binder->module;
    const char *name = name_of(module, variable);
    const uint32_t *type = spirv_definition(module, pointee(module, variable));
    const struct bind_slot *slot = NULL;
    for (uint32_t i = 0; i < binder->request->slot_count; i++)
        if (!strcmp(binder->request->slots[i].name, name))
            slot = &binder->request->slots[i];
    if (slot)
        binder->bindings[variable[2]] = 1 + slot->binding;
    if (!find_uses(binder, variable[2], NULL, 0))
        return true;
    if (spirv_is(type, SpvOpTypeArray))
        return refuse(binder, "`%s` is an array of resources, which passes do not have", name);
    if (spirv_is(type, SpvOpTypeSampler) || (spirv_is(type, SpvOpTypeImage) && type[7] != 2))
        return refuse(binder, "`%s` is a texture or a sampler alone; combine both, as sampler2D",
                      name);
    return slot ? check_kind(binder, variable, type, slot)
                : refuse(binder,
                         "the shader uses `%s`, which the pass does not list: add {name: RESOURCE, "
                         "as: %s} "
                         "to reads, writes or updates",
                         name, name);
}

static bool is_layout(uint32_t decoration)
{
    return decoration == SpvDecorationBlock || decoration == SpvDecorationOffset ||
           decoration == SpvDecorationArrayStride || decoration == SpvDecorationMatrixStride ||
           decoration == SpvDecorationRowMajor || decoration == SpvDecorationColMajor;
}

static void copy_annotations(struct binder *binder)
{
    const struct spirv *module = binder->module;
    struct spirv_edit *edit = &binder->edit;
    SPIRV_EACH(module, at, module->annotations, module->declarations)
    {
        const uint32_t *i = module->words + at;
        bool own = spirv_is(i, SpvOpDecorate), member = spirv_is(i, SpvOpMemberDecorate);
        uint32_t decoration = own ? i[2] : member ? i[3] : UINT32_MAX;
        bool placed = binder->bindings[i[1]] && (decoration == SpvDecorationBinding ||
                                                 decoration == SpvDecorationDescriptorSet);
        bool loose = binder->types[i[1]] == LOOSE && is_layout(decoration);
        if (!placed && !loose)
            spirv_copy(edit, &edit->annotations, i);
    }
    for (uint32_t id = 0; id < module->words[3]; id++) {
        if (!binder->bindings[id])
            continue;
        SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, id, SpvDecorationDescriptorSet, 0);
        SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, id, SpvDecorationBinding,
                  (uint32_t)binder->bindings[id] - 1);
    }
}

/* ---- Entry point, code ------------------------------------------------------------------------ */

/* Private variables are listed from SPIR-V 1.4 on, inputs always. */
static uint32_t keep_moved(const void *user, uint32_t id)
{
    const struct binder *binder = user;
    bool listed = (binder->module->words[1] >> 8 & 0xff) >= 4;
    return !binder->moved[id] ? id : listed ? binder->moved[id] : 0;
}

static void copy_code(struct binder *binder)
{
    const struct spirv *module = binder->module;
    struct spirv_edit *edit = &binder->edit;
    SPIRV_EACH(module, at, module->code, module->count)
    {
        const uint32_t *i = module->words + at;
        size_t start = edit->code.count;
        bool points = spirv_is(i, SpvOpAccessChain) || spirv_is(i, SpvOpInBoundsAccessChain) ||
                      spirv_is(i, SpvOpCopyObject);
        spirv_copy(edit, &edit->code, i);
        for (uint32_t word = 1; word < spirv_length(i) && !edit->failed; word++)
            if (!spirv_is_literal(i, word) && binder->moved[i[word]])
                edit->code.data[start + word] = binder->moved[i[word]];
        if (!points || !binder->moved[i[3]])
            continue;
        binder->moved[i[2]] = i[2];
        uint32_t type = pointer_to(binder, spirv_definition(module, i[1])[3]);
        if (!edit->failed)
            edit->code.data[start + 1] = type;
    }
}

static void put_begin(struct binder *binder)
{
    struct spirv_edit *edit = &binder->edit;
    uint32_t none = spirv_declare(edit, SpvOpTypeVoid, 0, NULL, 0);
    uint32_t type = spirv_declare(edit, SpvOpTypeFunction, 0, &none, 1);
    uint32_t function = edit->bound++, label = edit->bound++;
    spirv_put_name(edit, function, "diptych_begin(");
    SPIRV_PUT(edit, &edit->code, SpvOpFunction, none, function, SpvFunctionControlMaskNone, type);
    SPIRV_PUT(edit, &edit->code, SpvOpLabel, label);
    spirv_append(edit, &edit->code, binder->begin.data, binder->begin.count);
    spirv_put(edit, &edit->code, SpvOpReturn, NULL, 0);
    spirv_put(edit, &edit->code, SpvOpFunctionEnd, NULL, 0);
}

/* ---------------------------------------------------------------------------------------------- */

static bool check_local(struct binder *binder)
{
    const struct spirv *module = binder->module;
    const uint32_t *local = binder->request->local;
    SPIRV_EACH(module, at, SPIRV_HEADER, module->annotations)
    {
        const uint32_t *i = module->words + at;
        if (local && spirv_is(i, SpvOpExecutionMode) && i[2] == SpvExecutionModeLocalSize &&
            memcmp(i + 3, local, 3 * sizeof *local) != 0)
            return refuse(binder,
                          "the shader's workgroups have %ux%ux%u invocations: write `local: [%u, "
                          "%u, %u]`",
                          i[3], i[4], i[5], i[3], i[4], i[5]);
    }
    return true;
}

static bool each_variable(struct binder *binder,
                          bool (*of)(const struct binder *, const uint32_t *),
                          bool (*act)(struct binder *, const uint32_t *))
{
    const struct spirv *module = binder->module;
    bool good = true;
    SPIRV_EACH(module, at, module->declarations, module->code)
    if (good && spirv_is(module->words + at, SpvOpVariable) && of(binder, module->words + at))
        good = act(binder, module->words + at);
    return good;
}

static bool mark_loose(struct binder *binder, const uint32_t *variable)
{
    mark_type(binder, pointee(binder->module, variable), LOOSE);
    return true;
}

static bool stays(const struct binder *binder, const uint32_t *variable)
{
    return !has_values(binder, variable);
}

static bool mark_kept(struct binder *binder, const uint32_t *variable)
{
    mark_type(binder, pointee(binder->module, variable), KEPT);
    return true;
}

bool spirv_bind(struct spirv *module, const struct bind_request *request, char **why)
{
    uint32_t bound = module->words[3];
    struct binder binder = {.module = module,
                            .request = request,
                            .live = calloc(module->function_count + 1, sizeof *binder.live),
                            .moved = calloc(bound, sizeof *binder.moved),
                            .bindings = calloc(bound, sizeof *binder.bindings),
                            .types = calloc(bound, sizeof *binder.types),
                            .why = why};
    *why = NULL;
    spirv_edit_begin(&binder.edit, module);
    binder.edit.failed |= !binder.live || !binder.moved || !binder.bindings || !binder.types;
    bool good = !binder.edit.failed;
    if (good) {
        mark_live(&binder, spirv_entry(module));
        each_variable(&binder, has_values, mark_loose);
        each_variable(&binder, stays, mark_kept);
        good = check_local(&binder) && each_variable(&binder, is_resource, bind_variable) &&
               each_variable(&binder, has_values, move_variable);
    }
    if (good) {
        spirv_edit_interface(&binder.edit, keep_moved, &binder);
        copy_annotations(&binder);
        copy_code(&binder);
        put_begin(&binder);
    }
    binder.edit.failed |= !good;
    free(binder.begin.data);
    free(binder.live);
    free(binder.moved);
    free(binder.bindings);
    free(binder.types);
    return spirv_edit_end(&binder.edit, module);
}
