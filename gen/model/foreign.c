/* See foreign.h. What spirv-opt can do, it does (spirv_check.cpp). */
#include "foreign.h"

#include <ctype.h>
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "leaves.h"
#include "spirv_check.h"

/* ---- Names ----------------------------------------------------------------------------------- */

static bool has_name(const struct spirv *module, uint32_t id)
{
    const char *name = spirv_name(module, id);
    return name && *name;
}

/* Members of a block of uniforms or inputs, which a spec gives values by their names. */
static void name_members(struct spirv_edit *edit, uint32_t type, const char *block)
{
    const uint32_t *declared = spirv_definition(edit->from, type);
    for (uint32_t m = 0; m + 2 < spirv_length(declared); m++) {
        const char *own = spirv_member_name(edit->from, type, m);
        char text[248];
        if (own && *own)
            continue;
        snprintf(text, sizeof text, "%.200s_%u", block, m);
        spirv_put_text(edit, SpvOpMemberName, (uint32_t[]){type, m}, 2, text);
    }
}

static void name_variable(struct spirv_edit *edit, const uint32_t *variable)
{
    const struct spirv *from = edit->from;
    uint32_t id = variable[2], set = spirv_decoration(from, id, SpvDecorationDescriptorSet);
    uint32_t binding = spirv_decoration(from, id, SpvDecorationBinding);
    uint32_t location = spirv_decoration(from, id, SpvDecorationLocation);
    uint32_t type = spirv_element_type(from, spirv_pointee(from, variable));
    bool block = spirv_is(spirv_definition(from, type), SpvOpTypeStruct);
    bool named = has_name(from, id) || (block && has_name(from, type));
    char name[64] = "";
    if (spirv_decoration(from, id, SpvDecorationBuiltIn) != UINT32_MAX)
        return;
    if (variable[3] == SpvStorageClassInput || variable[3] == SpvStorageClassOutput)
        snprintf(name, sizeof name, "%s_%u",
                 variable[3] == SpvStorageClassInput ? "input" : "output",
                 location == UINT32_MAX ? 0 : location);
    else if (variable[3] == SpvStorageClassPushConstant)
        snprintf(name, sizeof name, "push");
    else if (binding != UINT32_MAX && set && set != UINT32_MAX)
        snprintf(name, sizeof name, "set_%u_binding_%u", set, binding);
    else if (binding != UINT32_MAX)
        snprintf(name, sizeof name, "binding_%u", binding);
    bool values = variable[3] == SpvStorageClassUniform || variable[3] == SpvStorageClassInput ||
                  variable[3] == SpvStorageClassPushConstant;
    if (block && values)
        name_members(edit, type, has_name(from, type) ? spirv_name(from, type) : name);
    if (!named && *name)
        spirv_put_name(edit, id, name);
}

/* A name of letters, digits and single underscores, as GLSL's _texture: HLSL's "in.var.UV" becomes in_var_UV, the counter "a@count" a_at_count. Functions keep theirs. */
static void put_clean(struct spirv_edit *edit, const uint32_t *i)
{
    uint32_t first = spirv_is(i, SpvOpName) ? 2 : 3, length = spirv_length(i);
    char clean[1024] = "";
    size_t count = 0;
    const char *own = (const char *)(i + first);
    for (const char *at = own; *at && count + 1 < sizeof clean; at++) {
        bool letter = isalnum((unsigned char)*at);
        if (*at == '@' && count && count + 4 < sizeof clean)
            count += (size_t)sprintf(clean + count, "_at");
        if (!count && isdigit((unsigned char)*at))
            clean[count++] = '_';
        if (letter ||
            (count ? clean[count - 1] != '_' : *at == '_' && isalpha((unsigned char)at[1])))
            clean[count++] = letter ? *at : '_';
    }
    clean[count] = 0;
    bool kept = spirv_is(spirv_definition(edit->from, i[1]), SpvOpFunction) || !strcmp(own, clean);
    if (kept && count)
        spirv_append(edit, &edit->front, i, length);
    else if (count) /* what has no letter is no name */
        spirv_put_text(edit, spirv_opcode(i), i + 1, first - 1, clean);
}

/* Names that a spec can say, and an import of GLSL.std.450, which the library of exact arithmetic calls. */
static bool clean_front(struct spirv *module)
{
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    spirv_edit_keep(&edit);
    edit.front.count = SPIRV_HEADER;
    if (!spirv_glsl(module))
        spirv_put_text(&edit, SpvOpExtInstImport, (uint32_t[]){edit.bound++}, 1, "GLSL.std.450");
    SPIRV_EACH(module, i, SPIRV_HEADER, edit.failed ? 0 : module->annotations)
        if (spirv_is(i, SpvOpName) || spirv_is(i, SpvOpMemberName))
            put_clean(&edit, i);
        else
            spirv_copy(&edit, &edit.front, i);
    return spirv_edit_end(&edit, module);
}

/* What a spec can name has a name. */
static bool name_all(struct spirv *module)
{
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    SPIRV_EACH(module, i, module->declarations, edit.failed ? 0 : module->code) {
        uint32_t number = spirv_decoration(module, spirv_result(i), SpvDecorationSpecId);
        if (spirv_is(i, SpvOpVariable))
            name_variable(&edit, i);
        char name[32];
        snprintf(name, sizeof name, "constant_%u", number);
        if (number != UINT32_MAX && !has_name(module, i[2]))
            spirv_put_name(&edit, i[2], name);
    }
    spirv_edit_keep(&edit);
    return spirv_edit_end(&edit, module);
}

/* ---- Forms ----------------------------------------------------------------------------------- */

/* In place: the storage class StorageBuffer becomes what it was before SPIR-V 1.3. */
static void lower_buffers(struct spirv *module)
{
    SPIRV_CHANGE(module, i, module->declarations, module->code) {
        uint32_t class = spirv_is(i, SpvOpTypePointer) ? 2 : spirv_is(i, SpvOpVariable) ? 3 : 0;
        if (!class || i[class] != SpvStorageClassStorageBuffer)
            continue;
        i[class] = SpvStorageClassUniform;
        if (class == 2)
            continue;
        uint32_t type = spirv_element_type(module, spirv_pointee(module, i));
        SPIRV_CHANGE(module, own, module->annotations, module->declarations)
            if (spirv_is(own, SpvOpDecorate) && own[1] == type && own[2] == SpvDecorationBlock)
                own[2] = SpvDecorationBufferBlock;
    }
}

/* In place: constant indices stay in their composite, which spirv-val does not look at here and spirv-opt trusts. */
static void bound_indices(const struct spirv *module, uint32_t *i)
{
    uint32_t first = i[3] == SpvOpCompositeExtract  ? 5
                     : i[3] == SpvOpCompositeInsert ? 6
                                                    : UINT32_MAX;
    const uint32_t *type = first < spirv_length(i) ? spirv_type(module, i[first - 1]) : NULL;
    for (uint32_t word = first; type && word < spirv_length(i); word++) {
        uint32_t parts = spirv_parts(module, type);
        i[word] = i[word] < parts ? i[word] : 0;
        type = parts ? spirv_definition(module, spirv_part(type, i[word])) : NULL;
    }
}

/* Whether it is a value of numbers that nothing sets. */
static bool is_unset(const struct spirv *module, const uint32_t *i)
{
    return spirv_is(i, SpvOpUndef) && (spirv_letter(spirv_definition(module, i[1])) ||
                                       spirv_parts(module, spirv_definition(module, i[1])));
}

/* In place: a value that nothing sets is zero. Optimizers leave such values where no result depends on them. */
static void set_undefined(struct spirv *module)
{
    SPIRV_CHANGE(module, i, module->declarations, module->code)
        if (is_unset(module, i))
            i[0] = 3u << 16 | SpvOpConstantNull;
        else if (spirv_is(i, SpvOpSpecConstantOp))
            bound_indices(module, i);
}

/* Before SPIR-V 1.4, an entry point lists inputs and outputs alone. */
static uint32_t keep_interface(const void *user, uint32_t id)
{
    uint32_t class = spirv_definition(user, id)[3];
    return class == SpvStorageClassInput || class == SpvStorageClassOutput ? id : 0;
}

static bool trim_interface(struct spirv *module)
{
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    spirv_edit_interface(&edit, keep_interface, module);
    spirv_edit_keep(&edit);
    return spirv_edit_end(&edit, module);
}

/* The lowest version of those that the drivers of OpenGL take; else its own. */
static bool lower_version(struct spirv *module)
{
    static const uint32_t versions[] = {0x10000, 0x10300};
    struct spirv lower;
    if (!spirv_open(&lower, module->words, module->count))
        return false;
    lower_buffers(&lower);
    bool good = trim_interface(&lower), fits = false;
    for (size_t i = 0; good && i < 2 && !fits && versions[i] <= module->words[1]; i++) {
        lower.words[1] = versions[i];
        fits = spirv_check(lower.words, lower.count, NULL);
    }
    if (!fits) {
        spirv_free(&lower);
        return good;
    }
    spirv_free(module);
    *module = lower;
    return true;
}

/* Whether an argument is a texture of an array, chosen by an index that is no constant. */
static bool is_element_of_textures(const struct spirv *module, const uint32_t *chain)
{
    if (!spirv_is(chain, SpvOpAccessChain) ||
        spirv_type(module, chain[2])[2] != SpvStorageClassUniformConstant)
        return false;
    for (uint32_t word = 4; word < spirv_length(chain); word++)
        if (!spirv_is(spirv_definition(module, chain[word]), SpvOpConstant))
            return true;
    return false;
}

bool spirv_passes_textures(const struct spirv *module)
{
    SPIRV_EACH(module, i, module->code, module->count) {
        const uint32_t *type;
        for (uint32_t word = 4; spirv_is(i, SpvOpFunctionCall) && word < spirv_length(i); word++)
            if (is_element_of_textures(module, spirv_definition(module, i[word])))
                return true;
        if (!spirv_is(i, SpvOpFunctionParameter))
            continue;
        type = spirv_type(module, i[2]);
        bool uniform =
            spirv_is(type, SpvOpTypePointer) && type[2] == SpvStorageClassUniformConstant;
        if (spirv_is(type, SpvOpTypePointer))
            type = spirv_definition(module, type[3]);
        if (spirv_is(type, SpvOpTypeImage) || spirv_is(type, SpvOpTypeSampler) ||
            (uniform && (spirv_is(type, SpvOpTypeStruct) || spirv_is(type, SpvOpTypeArray))))
            return true;
    }
    return false;
}

static bool holds_textures(const struct spirv *module, const uint32_t *type)
{
    bool found = spirv_is(type, SpvOpTypeImage) || spirv_is(type, SpvOpTypeSampler) ||
                 spirv_is(type, SpvOpTypeSampledImage);
    if (spirv_is(type, SpvOpTypeArray))
        return holds_textures(module, spirv_definition(module, type[2]));
    for (uint32_t word = 2; spirv_is(type, SpvOpTypeStruct) && word < spirv_length(type); word++)
        found |= holds_textures(module, spirv_definition(module, type[word]));
    return found;
}

/* Whether variables get textures of others, as glslang writes HLSL that spirv-opt has not seen. */
static bool copies_textures(const struct spirv *module)
{
    SPIRV_EACH(module, i, module->declarations, module->count)
        if (spirv_is(i, SpvOpVariable) && i[3] != SpvStorageClassUniformConstant &&
            holds_textures(module, spirv_definition(module, spirv_definition(module, i[1])[3])))
            return true;
    return false;
}

bool spirv_reread(struct spirv *module, unsigned passes)
{
    size_t count = module->count;
    uint32_t *words = spirv_optimize(module->words, &count, passes);
    spirv_free(module);
    return spirv_read(module, words, count);
}

/* Components of a coordinate of texels. */
static uint32_t place_width(const uint32_t *image)
{
    uint32_t plain = image[3] == SpvDim1D || image[3] == SpvDimBuffer ? 1
                     : image[3] == SpvDim3D || image[3] == SpvDimCube ? 3
                                                                      : 2;
    return plain + (image[5] && image[3] != SpvDimCube);
}

/* A whole number, or a vector of them, as ints, the first `width` of them. */
static uint32_t put_place(struct spirv_edit *edit, uint32_t id, uint32_t width)
{
    const uint32_t *type = spirv_type(edit->from, id), *part = spirv_scalar(edit->from, type);
    uint32_t own = spirv_is(type, SpvOpTypeVector) ? type[3] : 1;
    if (!spirv_is(part, SpvOpTypeInt) || part[2] != 32 || own < width || (own == width && part[3]))
        return id;
    uint32_t whole = spirv_declare_vector(edit, spirv_declare_scalar(edit, 'i'), width);
    uint32_t cut = spirv_declare_vector(edit, part[1], width);
    if (own > width) {
        uint32_t words[] = {cut, edit->bound++, id, width > 1 ? id : 0, 0, 1, 2};
        spirv_put(edit, &edit->code, width > 1 ? SpvOpVectorShuffle : SpvOpCompositeExtract, words,
                  4 + (width > 1 ? width : 0));
        id = words[1];
    }
    return part[3] ? id : SPIRV_VALUE(edit, &edit->code, SpvOpBitcast, whole, id);
}

/* x - y * trunc(x / y), with the sign of x. */
static void put_remainder(struct spirv_edit *edit, const uint32_t *i)
{
    uint32_t glsl = spirv_glsl(edit->from);
    struct spirv_words *code = &edit->code;
    uint32_t quotient = SPIRV_VALUE(edit, code, SpvOpFDiv, i[1], i[3], i[4]);
    uint32_t whole = SPIRV_VALUE(edit, code, SpvOpExtInst, i[1], glsl, GLSLstd450Trunc, quotient);
    uint32_t product = SPIRV_VALUE(edit, code, SpvOpFMul, i[1], i[4], whole);
    SPIRV_PUT(edit, code, SpvOpFSub, i[1], i[2], i[3], product);
}

/* The id `result` of type `to`: b where `when` is false, else a, of type `from`; when: 0: a alone. Part by part. */
static void put_parts(struct spirv_edit *edit, uint32_t result, uint32_t to, uint32_t from,
                      const uint32_t values[2], uint32_t when)
{
    const uint32_t *type = spirv_definition(edit->from, to),
                   *own = spirv_definition(edit->from, from);
    enum { MOST_PARTS = 4096, MOST_IDS = 1 << 22 };
    uint32_t count = spirv_parts(edit->from, type), *words = calloc(count + 2, sizeof *words);
    edit->failed |= !words || count > MOST_PARTS || edit->bound > MOST_IDS;
    for (uint32_t k = 0; !edit->failed && k < count; k++) {
        uint32_t part = spirv_part(own, k), taken[2];
        for (int v = 0; v < (when ? 2 : 1); v++)
            taken[v] = SPIRV_VALUE(edit, &edit->code, SpvOpCompositeExtract, part, values[v], k);
        bool deeper = when || spirv_part(type, k) != part;
        words[2 + k] = deeper ? edit->bound++ : taken[0];
        if (deeper)
            put_parts(edit, words[2 + k], spirv_part(type, k), part, taken, when);
    }
    if (count && !edit->failed) {
        words[0] = to;
        words[1] = result;
        spirv_put(edit, &edit->code, SpvOpCompositeConstruct, words, count + 2);
    } else if (when) {
        SPIRV_PUT(edit, &edit->code, SpvOpSelect, to, result, when, values[0], values[1]);
    } else {
        SPIRV_PUT(edit, &edit->code, SpvOpCopyObject, to, result, values[0]);
    }
    free(words);
}

/* Copies between types of one shape, and choices between composites, which SPIR-V has from 1.4 on. */
static bool put_later(struct spirv_edit *edit, const uint32_t *i)
{
    const struct spirv *from = edit->from;
    bool select = spirv_is(i, SpvOpSelect), copy = spirv_is(i, SpvOpCopyLogical);
    bool whole = select && spirv_is(spirv_type(from, i[3]), SpvOpTypeBool) &&
                 spirv_parts(from, spirv_definition(from, i[1]));
    if (!whole && !copy)
        return false;
    put_parts(edit, i[2], i[1], spirv_type(from, i[whole ? 4 : 3])[1], i + (whole ? 4 : 3),
              whole ? i[3] : 0);
    return true;
}

/* What no GLSL becomes. Texels of images have the coordinates and levels that GLSL gives them: ints, no more of them than the
 * image has dimensions. */
static bool lower_operations(struct spirv *module)
{
    enum { MOST_WORDS = 32 };
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    spirv_edit_annotations(&edit);
    SPIRV_EACH(module, i, module->code, edit.failed ? 0 : module->count) {
        uint32_t words[MOST_WORDS], length = spirv_length(i);
        bool writes = spirv_is(i, SpvOpImageWrite), texel = spirv_is(i, SpvOpImageTexelPointer);
        bool reads = spirv_is(i, SpvOpImageFetch) || spirv_is(i, SpvOpImageRead);
        if (spirv_is(i, SpvOpFRem))
            put_remainder(&edit, i);
        else if (is_unset(module, i))
            SPIRV_PUT(&edit, &edit.code, SpvOpCopyObject, i[1], i[2],
                      spirv_declare(&edit, SpvOpConstantNull, i[1], NULL, 0));
        else if (put_later(&edit, i))
            continue;
        else if (length > MOST_WORDS || !(writes || texel || reads))
            spirv_copy(&edit, &edit.code, i);
        if (length > MOST_WORDS || !(writes || texel || reads))
            continue;
        memcpy(words, i, length * sizeof *words);
        const uint32_t *image = spirv_type(module, i[writes ? 1 : 3]);
        if (texel)
            image = spirv_definition(module, image[3]);
        uint32_t *place = words + (writes ? 2 : 4);
        *place = put_place(&edit, *place, place_width(image));
        if (spirv_is(i, SpvOpImageFetch) && length > 6 && i[5] & SpvImageOperandsLodMask)
            words[6] = put_place(&edit, i[6], 1);
        spirv_copy(&edit, &edit.code, words);
    }
    return spirv_edit_end(&edit, module);
}

/* ---- Lines ----------------------------------------------------------------------------------- */

static bool has_lines(const struct spirv *module)
{
    bool found = false;
    SPIRV_EACH(module, i, module->code, module->count)
        found |= spirv_is(i, SpvOpLine);
    return found;
}

/* Gives each instruction its line in the output of spirv-dis: five lines of header, then a line an instruction. */
static bool add_lines(struct spirv *module, const char *path)
{
    enum { HEAD_LINES = 5 };
    struct spirv_edit edit;
    uint32_t line = HEAD_LINES, before = SpvOpNop;
    spirv_edit_begin(&edit, module);
    spirv_edit_annotations(&edit);
    uint32_t file = edit.bound++;
    spirv_put_text(&edit, SpvOpString, &file, 1, path);
    SPIRV_EACH_AT(module, at, SPIRV_HEADER, module->count) {
        const uint32_t *i = module->words + at;
        uint32_t opcode = spirv_opcode(i);
        line++;
        if (at < module->code)
            continue;
        bool inside = opcode != SpvOpFunction && opcode != SpvOpFunctionParameter &&
                      opcode != SpvOpFunctionEnd && opcode != SpvOpLabel && opcode != SpvOpPhi &&
                      opcode != SpvOpVariable && before != SpvOpLoopMerge &&
                      before != SpvOpSelectionMerge;
        if (inside)
            SPIRV_PUT(&edit, &edit.code, SpvOpLine, file, line, 1);
        spirv_copy(&edit, &edit.code, i);
        before = opcode;
    }
    return spirv_edit_end(&edit, module);
}

/* The text of OpSource for a file; free(). NULL: it has none. */
static char *source_text(const struct spirv *module, uint32_t file)
{
    bool own = false;
    char *text = NULL;
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations) {
        bool source = spirv_is(i, SpvOpSource) && spirv_length(i) > 4;
        if (source)
            own = i[3] == file;
        const char *more = source                              ? (const char *)(i + 4)
                           : spirv_is(i, SpvOpSourceContinued) ? (const char *)(i + 1)
                                                               : NULL;
        char *longer = NULL;
        if (!own || !more || asprintf(&longer, "%s%s", text ? text : "", more) < 0)
            continue;
        free(text);
        text = longer;
    }
    return text;
}

uint32_t *spirv_number_files(const uint32_t *words, size_t *count,
                             uint32_t (*number)(void *user, const char *name, const char *text),
                             void *user)
{
    struct spirv module;
    struct spirv_edit edit;
    if (!spirv_open(&module, words, *count))
        return NULL;
    spirv_edit_begin(&edit, &module);
    spirv_edit_keep(&edit);
    edit.front.count = SPIRV_HEADER;
    SPIRV_EACH(&module, i, SPIRV_HEADER, edit.failed ? 0 : module.annotations) {
        if (!spirv_is(i, SpvOpString)) {
            spirv_copy(&edit, &edit.front, i);
            continue;
        }
        char *text = source_text(&module, i[1]);
        char digits[16];
        snprintf(digits, sizeof digits, "%u", number(user, (const char *)(i + 2), text));
        spirv_put_text(&edit, SpvOpString, i + 1, 1, digits);
        free(text);
    }
    if (spirv_edit_end(&edit, &module))
        return spirv_take(&module, count);
    spirv_free(&module);
    return NULL;
}

/* ---------------------------------------------------------------------------------------------- */

uint32_t *spirv_take_in(const uint32_t *words, size_t *count, const char *path)
{
    struct spirv module;
    bool good =
        spirv_open(&module, words, *count) && spirv_lower_memory(&module) && spirv_demote(&module);
    if (good && !has_lines(&module))
        good = add_lines(&module, path);
    good = good &&
           spirv_reread(&module, SPIRV_FLATTEN | (copies_textures(&module) ? SPIRV_LEGALIZE : 0));
    if (good && spirv_passes_textures(&module))
        good = spirv_reread(&module, SPIRV_INLINE);
    if (good)
        set_undefined(&module);
    good = good && clean_front(&module) && lower_operations(&module) && name_all(&module) &&
           spirv_combine(&module) && lower_version(&module);
    if (good)
        return spirv_take(&module, count);
    spirv_free(&module);
    return NULL;
}

bool spirv_has_entry(const uint32_t *words, size_t count, uint32_t model)
{
    for (size_t at = SPIRV_HEADER; at < count; at += words[at] >> 16)
        if (spirv_is(words + at, SpvOpEntryPoint) && words[at + 1] == model)
            return true;
    return false;
}

bool spirv_choose_entry(struct spirv *module, uint32_t model)
{
    struct spirv_edit edit;
    uint32_t function = 0;
    spirv_edit_begin(&edit, module);
    edit.front.count = SPIRV_HEADER;
    SPIRV_EACH(module, i, SPIRV_HEADER, edit.failed ? SPIRV_HEADER : module->annotations) {
        bool entry = spirv_is(i, SpvOpEntryPoint);
        bool mode = spirv_is(i, SpvOpExecutionMode) || spirv_is(i, SpvOpExecutionModeId);
        bool name = spirv_is(i, SpvOpName) && i[1] == function;
        if (entry && i[1] == model && !function) {
            const uint32_t head[] = {model, function = i[2], 0x6e69616d, 0}; /* "main" */
            size_t start = edit.front.count;
            uint32_t first = spirv_entry_variables(i);
            spirv_put(&edit, &edit.front, SpvOpEntryPoint, head, 4);
            spirv_append(&edit, &edit.front, i + first, spirv_length(i) - first);
            if (!edit.failed)
                edit.front.data[start] += (spirv_length(i) - first) << 16;
        } else if (!entry && !name && !(mode && i[1] != function)) {
            spirv_copy(&edit, &edit.front, i);
        }
    }
    if (function)
        spirv_put_name(&edit, function, "main");
    spirv_edit_keep(&edit);
    return spirv_edit_end(&edit, module);
}

/* ---- Phis ------------------------------------------------------------------------------------ */

static bool is_phi(const struct spirv *module, const uint32_t *i)
{
    return spirv_is(i, SpvOpPhi) && !spirv_is(spirv_definition(module, i[1]), SpvOpTypePointer);
}

/* Variables at the head of a function, one for each of its phis. */
static void put_variables(struct spirv_edit *edit, const struct spirv_function *function,
                          uint32_t *variables)
{
    const struct spirv *from = edit->from;
    SPIRV_EACH(from, i, function->begin, function->end) {
        if (!is_phi(from, i))
            continue;
        uint32_t type = SPIRV_DECLARE(edit, SpvOpTypePointer, 0, SpvStorageClassFunction, i[1]);
        variables[i[2]] =
            SPIRV_VALUE(edit, &edit->code, SpvOpVariable, type, SpvStorageClassFunction);
    }
}

/* At the end of a block: what the phis behind it choose for it. */
static void put_choices(struct spirv_edit *edit, const struct spirv_function *function,
                        uint32_t label, const uint32_t *variables)
{
    const struct spirv *from = edit->from;
    SPIRV_EACH(from, i, function->begin, function->end) {
        for (uint32_t word = 3; is_phi(from, i) && word < spirv_length(i); word += 2)
            if (i[word + 1] == label)
                SPIRV_PUT(edit, &edit->code, SpvOpStore, variables[i[2]], i[word]);
    }
}

static bool ends_block(uint32_t opcode)
{
    return opcode == SpvOpSelectionMerge || opcode == SpvOpLoopMerge ||
           (opcode >= SpvOpBranch && opcode <= SpvOpUnreachable) ||
           opcode == SpvOpTerminateInvocation;
}

static void lower_function(struct spirv_edit *edit, const struct spirv_function *function,
                           uint32_t *variables)
{
    const struct spirv *from = edit->from;
    uint32_t label = 0;
    bool ended = true, first = true;
    SPIRV_EACH(from, i, function->begin, function->end) {
        if (!ended && ends_block(spirv_opcode(i))) {
            put_choices(edit, function, label, variables);
            ended = true;
        }
        if (is_phi(from, i))
            SPIRV_PUT(edit, &edit->code, SpvOpLoad, i[1], i[2], variables[i[2]]);
        else
            spirv_copy(edit, &edit->code, i);
        if (!spirv_is(i, SpvOpLabel))
            continue;
        label = i[1];
        ended = false;
        if (first)
            put_variables(edit, function, variables);
        first = false;
    }
}

bool spirv_lower_phis(struct spirv *module)
{
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    uint32_t *variables = spirv_edit_table(&edit, sizeof *variables);
    if (!edit.failed) {
        spirv_edit_annotations(&edit);
        EACH(function, module->functions, module->function_count)
            lower_function(&edit, function, variables);
    }
    return spirv_edit_end(&edit, module);
}
