/* See bind.h. */
#include "bind.h"

#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/leaves.h"
#include "panel.h"

struct binder {
    const struct spirv *module;
    const struct bind_request *request;
    struct spirv_edit edit;
    struct spirv_words begin; /* body of diptych_begin() */
    bool *live;               /* by function: the entry point reaches it */
    uint32_t *moved;          /* by id: a variable's private one, or a pointer's self; 0: stays */
    uint32_t now;             /* the private one that gets its values */
    uint32_t *given; /* by id of a value's function: the variable that has the value; 0: none */
    int *bindings;   /* by id: 1 + binding of a resource; 0: none */
    unsigned char *types; /* by id: LOOSE, KEPT */
    char **why;
};
enum { LOOSE = 1, KEPT = 2 }; /* reached by variables that move, by others */
/* Appends an instruction with a new result, which is returned, to diptych_begin(). */
#define VALUE(binder, ...) SPIRV_VALUE(&(binder)->edit, &(binder)->begin, __VA_ARGS__)

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

static bool is_decorated(const struct spirv *module, uint32_t id, uint32_t decoration)
{
    return spirv_decoration(module, id, decoration) != UINT32_MAX;
}

static bool is_generators(const struct binder *binder, const uint32_t *variable)
{
    return variable[2] >= binder->request->first;
}

/* Whether it moves: a block of uniforms, push constants, or an input. */
static bool has_values(const struct binder *binder, const uint32_t *variable)
{
    const struct spirv *module = binder->module;
    uint32_t type = spirv_pointee(module, variable), element = spirv_element_type(module, type);
    if (is_generators(binder, variable))
        return false;
    switch (variable[3]) {
    case SpvStorageClassPushConstant:
        return true;
    case SpvStorageClassUniform:
        return !is_decorated(module, element, SpvDecorationBufferBlock);
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

/* ---- Values ---------------------------------------------------------------------------------- */

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

static uint32_t pointer_to(struct binder *binder, uint32_t type)
{
    return SPIRV_DECLARE(&binder->edit, SpvOpTypePointer, 0, SpvStorageClassPrivate, type);
}

static uint32_t put_place(struct binder *binder, uint32_t pointer, uint32_t index, uint32_t type)
{
    uint32_t int_type = spirv_declare_scalar(&binder->edit, 'i');
    uint32_t constant = SPIRV_DECLARE(&binder->edit, SpvOpConstant, int_type, index);
    return VALUE(binder, SpvOpAccessChain, pointer_to(binder, type), pointer, constant);
}

static bool can_convert(const struct spirv *module, uint32_t to, uint32_t from)
{
    const uint32_t *narrow = spirv_definition(module, to), *wide = spirv_definition(module, from);
    bool whole = spirv_is(wide, SpvOpTypeInt), real = spirv_is(wide, SpvOpTypeFloat);
    return (whole || real) && spirv_opcode(narrow) == spirv_opcode(wide) && narrow[2] < wide[2] &&
           (real || narrow[3] == wide[3]);
}

/* Stores a leaf's value, and those of arrays around it one by one. In memory a bool is a uint. False: the types differ. */
static bool put_leaf(struct binder *binder, const struct spirv_leaf *leaf, uint32_t depth,
                     uint32_t pointer, uint32_t value, uint32_t value_type)
{
    const struct spirv *module = binder->module;
    uint32_t type = leaf->types[depth], next = depth < leaf->depth ? leaf->types[depth + 1] : 0;
    const uint32_t *to = spirv_definition(module, type),
                   *from = spirv_definition(module, value_type);
    bool good = true;
    if (spirv_is(to, SpvOpTypeStruct) && next)
        return put_leaf(binder, leaf, depth + 1,
                        put_place(binder, pointer, leaf->members[depth], next), value, value_type);
    if (next) {
        uint32_t length = spirv_array_length(module, to);
        good = length && length == spirv_array_length(module, from);
        for (uint32_t i = 0; good && i < length; i++)
            good = put_leaf(binder, leaf, depth + 1, put_place(binder, pointer, i, next),
                            VALUE(binder, SpvOpCompositeExtract, from[2], value, i), from[2]);
        return good;
    }
    uint32_t parts = spirv_is(to, SpvOpTypeVector) ? to[3] : 0;
    bool vectors = parts && spirv_is(from, SpvOpTypeVector) && parts == from[3];
    uint32_t scalar = vectors ? to[2] : type;
    if (spirv_is(from, SpvOpTypeBool) && spirv_is(to, SpvOpTypeInt)) {
        uint32_t one = SPIRV_DECLARE(&binder->edit, SpvOpConstant, type, 1);
        uint32_t zero = SPIRV_DECLARE(&binder->edit, SpvOpConstant, type, 0);
        value = VALUE(binder, SpvOpSelect, type, value, one, zero);
    } else if ((vectors || !parts) && spirv_is(spirv_scalar(module, to), SpvOpTypeBool) &&
               spirv_is(spirv_scalar(module, from), SpvOpTypeInt)) {
        uint32_t zero = spirv_declare(&binder->edit, SpvOpConstantNull, value_type, NULL, 0);
        value = VALUE(binder, SpvOpINotEqual, type, value, zero);
    } else if (type != value_type) { /* numbers of 8 and 16 bits */
        const uint32_t *number = spirv_definition(module, scalar);
        uint32_t whole = spirv_is(number, SpvOpTypeInt) ? SpvOpUConvert + number[3] : 0;
        if (!can_convert(module, scalar, vectors ? from[2] : value_type))
            return false;
        value = VALUE(binder, whole ? whole : SpvOpFConvert, type, value);
        SPIRV_PUT(&binder->edit, &binder->edit.front, SpvOpCapability,
                  number[2] == 8 ? SpvCapabilityInt8
                  : whole        ? SpvCapabilityInt16
                                 : SpvCapabilityFloat16);
    }
    SPIRV_PUT(&binder->edit, &binder->begin, SpvOpStore, pointer, value);
    return true;
}

/* Stores the value of a leaf of the variable that move_variable moves. */
static bool put_value(void *user, const struct spirv_leaf *leaf)
{
    struct binder *binder = user;
    const struct spirv *module = binder->module;
    char wanted[300];
    snprintf(wanted, sizeof wanted, "diptych_value_%s(", leaf->name);
    const struct spirv_function *found = spirv_find_function(module, wanted);
    if (found && binder->given[found->id] == binder->now)
        return refuse(
            binder, "two members of the shader's uniforms have the name `%s` in a spec: rename one",
            leaf->name);
    if (found) {
        binder->given[found->id] = binder->now;
        const uint32_t *function = spirv_definition(module, found->id);
        uint32_t value = VALUE(binder, SpvOpFunctionCall, function[1], function[2]);
        return put_leaf(binder, leaf, 0, binder->now, value, function[1]) ||
               refuse(binder, "the shader declares `%s` with another type than its value has",
                      leaf->name);
    }
    return refuse(binder,
                  "the shader reads `%s`, which has no value: declare a parameter of this name, or "
                  "give it one in `values`",
                  leaf->name);
}

/* The variable becomes a private one; diptych_begin() fills what is used of it. */
static bool move_variable(struct binder *binder, const uint32_t *variable)
{
    const struct spirv *module = binder->module;
    binder->now =
        spirv_add_variable(&binder->edit, SpvStorageClassPrivate, spirv_pointee(module, variable));
    binder->moved[variable[2]] = binder->now;
    spirv_put_name(&binder->edit, binder->now, spirv_variable_name(module, variable));
    return spirv_each_leaf(module, variable, binder->live, put_value, binder);
}

/* ---- Resources ------------------------------------------------------------------------------- */

static const char *number_word(char letter)
{
    return letter == 'f' ? "floats" : letter == 'i' ? "ints" : "uints";
}

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
    const uint32_t *shape = sampler ? spirv_definition(binder->module, type[2]) : type;
    char declared[32];
    if (sampler || image) {
        spirv_image_name(binder->module, shape, sampler, declared, sizeof declared);
        if (strcmp(declared, slot->declared) != 0)
            return refuse(binder, "`%s` is %s, but the pass binds what is %s", slot->name, declared,
                          slot->declared);
        if (image && shape[8] && slot->format &&
            strcmp(spirv_image_format(shape[8]), slot->format) != 0)
            return refuse(binder, "`%s` has the format %s, but the pass binds one of %s",
                          slot->name, spirv_image_format(shape[8]), slot->format);
    }
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
    const char *name = spirv_variable_name(module, variable);
    const uint32_t *type = spirv_definition(module, spirv_pointee(module, variable));
    const struct bind_slot *slot = NULL;
    for (uint32_t i = 0; i < binder->request->slot_count; i++)
        if (!strcmp(binder->request->slots[i].name, name))
            slot = &binder->request->slots[i];
    if (slot)
        binder->bindings[variable[2]] = 1 + slot->binding;
    if (!spirv_mentions(module, binder->live, variable[2]))
        return true;
    uint32_t element = spirv_element_type(module, spirv_pointee(module, variable));
    if (spirv_is(spirv_definition(module, element), SpvOpTypeStruct) &&
        variable[3] == SpvStorageClassUniformConstant)
        return refuse(
            binder,
            "a texture is in arrays of arrays of structs, or in an array of a struct that no "
            "constant chooses: declare it outside of structs");
    if (spirv_is_array(type))
        return refuse(
            binder,
            "`%s` is an array of more than 16 resources, or by an index that is not constant",
            name);
    if (spirv_is(type, SpvOpTypeSampler) || (spirv_is(type, SpvOpTypeImage) && type[7] != 2))
        return refuse(binder, "`%s` is a texture or a sampler alone; combine both, as sampler2D",
                      name);
    return slot ? check_kind(binder, variable, type, slot)
                : refuse(binder,
                         "the shader uses `%s`, which the pass does not list: add {name: RESOURCE, "
                         "as: %s} to reads, writes or updates",
                         name, name);
}

/* Whether a fragment shader's output holds the numbers of its target. */
static bool check_target_number(struct binder *binder, const uint32_t *variable)
{
    const struct spirv *module = binder->module;
    uint32_t location = spirv_decoration(module, variable[2], SpvDecorationLocation);
    const uint32_t *type = spirv_definition(module, spirv_pointee(module, variable));
    char own = spirv_letter(spirv_scalar(module, type));
    char target =
        location < sizeof binder->request->targets ? binder->request->targets[location] : 0;
    return !own || !target || own == target ||
           refuse(binder, "`%s` holds %s, but its target %s", spirv_variable_name(module, variable),
                  number_word(own), number_word(target));
}

static bool is_output(const struct binder *binder, const uint32_t *variable)
{
    return !is_generators(binder, variable) && variable[3] == SpvStorageClassOutput;
}

static void copy_annotations(struct binder *binder)
{
    const struct spirv *module = binder->module;
    struct spirv_edit *edit = &binder->edit;
    SPIRV_EACH(module, i, module->annotations, module->declarations) {
        bool own = spirv_is(i, SpvOpDecorate), member = spirv_is(i, SpvOpMemberDecorate);
        uint32_t decoration = own ? i[2] : member ? i[3] : UINT32_MAX;
        bool placed = binder->bindings[i[1]] && (decoration == SpvDecorationBinding ||
                                                 decoration == SpvDecorationDescriptorSet);
        bool loose = binder->types[i[1]] == LOOSE && decoration != SpvDecorationRelaxedPrecision;
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
    uint32_t glsl = spirv_glsl(module);
    SPIRV_EACH(module, i, module->code, module->count) {
        size_t start = edit->code.count;
        bool within = spirv_is(i, SpvOpExtInst) && i[3] == glsl &&
                      i[4] >= GLSLstd450InterpolateAtCentroid &&
                      i[4] <= GLSLstd450InterpolateAtOffset && binder->moved[i[5]];
        if (within) { /* an input that nothing interpolates */
            SPIRV_PUT(edit, &edit->code, SpvOpLoad, i[1], i[2], binder->moved[i[5]]);
            continue;
        }
        bool points = spirv_is(i, SpvOpAccessChain) || spirv_is(i, SpvOpInBoundsAccessChain) ||
                      spirv_is(i, SpvOpCopyObject);
        spirv_copy_mapped(edit, &edit->code, i, binder->moved);
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

/* Extensions of one vendor; Mesa takes those of `known`. */
static bool is_of_vendor(const char *extension)
{
    static const char *const vendors[] = {"AMD", "ARM", "INTEL", "NV", "NVX", "QCOM"};
    static const char *const known[] = {"AMD_gpu_shader_", "AMD_texture_gather_bias_lod",
                                        "AMD_shader_image_load_store_lod"};
    const char *name = extension + strlen("SPV_");
    bool found = false;
    for (size_t i = 0; i < DT_ARRAY_COUNT(vendors) && !strncmp(extension, "SPV_", 4); i++)
        found |= !strncmp(name, vendors[i], strlen(vendors[i])) && name[strlen(vendors[i])] == '_';
    for (size_t i = 0; i < DT_ARRAY_COUNT(known); i++)
        found &= strncmp(name, known[i], strlen(known[i])) != 0;
    return found;
}

/* What the runtimes do not have, and some drivers crash of. */
static bool check_capabilities(struct binder *binder)
{
    static const struct {
        uint32_t capability;
        const char *what, *who;
    } missing[] = {
        {SpvCapabilityPhysicalStorageBufferAddresses, "addresses of buffers", "OpenGL does"},
        {SpvCapabilityRayQueryKHR, "ray queries", "OpenGL does"},
        {SpvCapabilityFragmentShadingRateKHR, "shading rates", "OpenGL does"},
        {SpvCapabilityFragmentBarycentricKHR, "barycentric coordinates", "OpenGL does"},
        {SpvCapabilityFragmentDensityEXT, "densities of fragments", "OpenGL does"},
        {SpvCapabilitySparseResidency, "sparse textures", "OpenGL does"},
        {SpvCapabilityDemoteToHelperInvocation,
         "demotion of invocations that write buffers or images, or ask for helpers", "OpenGL does"},
        {SpvCapabilityFragmentFullyCoveredEXT, "coverage of fragments", "OpenGL does"},
        {SpvCapabilityMultiView, "views", "passes do"},
        {SpvCapabilityStencilExportEXT, "stencil references", "passes do"},
        {SpvCapabilityFragmentShaderPixelInterlockEXT, "interlocks", "passes do"},
        {SpvCapabilityFragmentShaderSampleInterlockEXT, "interlocks", "passes do"}};
    const struct spirv *module = binder->module;
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations) {
        for (size_t k = 0; k < DT_ARRAY_COUNT(missing); k++)
            if (spirv_is(i, SpvOpCapability) && i[1] == missing[k].capability)
                return refuse(binder, "the shader uses %s, which %s not have", missing[k].what,
                              missing[k].who);
        bool set = spirv_is(i, SpvOpExtInstImport); /* glslang 15 names no more */
        const char *name = (const char *)(i + (set ? 2 : 1));
        if ((set || spirv_is(i, SpvOpExtension)) && is_of_vendor(name))
            return refuse(binder, "the shader uses %s, which OpenGL does not have", name);
        bool subgroups = spirv_is(i, SpvOpCapability) && i[1] >= SpvCapabilityGroupNonUniform &&
                         i[1] <= SpvCapabilityGroupNonUniformQuad;
        if (subgroups && (binder->request->exact || !binder->request->local))
            return refuse(binder, binder->request->local
                                      ? "subgroup operations need `exactness: fast`: the size of "
                                        "subgroups, and the order in which they reduce, differ "
                                        "from device to device"
                                      : "only a dispatch can have subgroup operations");
        if (spirv_is(i, SpvOpExecutionMode) && i[2] == SpvExecutionModePixelCenterInteger)
            return refuse(binder,
                          "the shader uses pixel_center_integer, which Vulkan does not have");
    }
    return true;
}

static bool check_local(struct binder *binder)
{
    const struct spirv *module = binder->module;
    const uint32_t *local = binder->request->local;
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations) {
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
    SPIRV_EACH(module, i, module->declarations, module->code)
        if (good && spirv_is(i, SpvOpVariable) && of(binder, i))
            good = act(binder, i);
    return good;
}

bool spirv_bind(struct spirv *module, const struct bind_request *request, char **why)
{
    struct binder binder = {
        .module = module, .request = request, .live = spirv_live_functions(module), .why = why};
    *why = NULL;
    spirv_edit_begin(&binder.edit, module);
    binder.moved = spirv_edit_table(&binder.edit, sizeof *binder.moved);
    binder.given = spirv_edit_table(&binder.edit, sizeof *binder.given);
    binder.bindings = spirv_edit_table(&binder.edit, sizeof *binder.bindings);
    binder.types = spirv_edit_table(&binder.edit, sizeof *binder.types);
    binder.edit.failed |= !binder.live;
    bool good = !binder.edit.failed;
    if (good) {
        SPIRV_EACH(module, i, module->declarations, module->code)
            if (spirv_is(i, SpvOpVariable))
                mark_type(&binder, spirv_pointee(module, i), has_values(&binder, i) ? LOOSE : KEPT);
        good = check_capabilities(&binder) && check_local(&binder) &&
               each_variable(&binder, is_resource, bind_variable) &&
               each_variable(&binder, is_output, check_target_number) &&
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
    return spirv_edit_end(&binder.edit, module);
}
