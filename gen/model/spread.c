/* Arrays of textures, samplers, images and buffers become variables, NAME_0, NAME_1, ..., which passes list one by one.
 * What reads a texture by an index that is no constant reads each, and takes that of the index. A chain into an array
 * of numbers stays in place of the index, so that --sanitize finds one that the array has not. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foreign.h"
#include "leaves.h"

enum { MOST_ELEMENTS = 16, UNSIZED_ELEMENTS = 4 };

struct spreading {
    const struct spirv *from;
    struct spirv_edit edit;
    const uint32_t *array; /* its variable */
    uint32_t count, elements[MOST_ELEMENTS];
    bool used, chooses;
    uint32_t numbers; /* array in the function that is written; 0: not yet */
    uint32_t *known;  /* by id: the element that the pointer is of, by a constant index */
    uint32_t *chain;  /* by id: the pointer by another index that it is, or is read by */
};

static bool is_chain(const struct spreading *s, const uint32_t *i)
{
    return (spirv_is(i, SpvOpAccessChain) || spirv_is(i, SpvOpInBoundsAccessChain)) &&
           i[3] == s->array[2] && spirv_length(i) > 4;
}

/* UINT32_MAX: another than a constant. */
static uint32_t constant_element(const struct spreading *s, const uint32_t *chain)
{
    const uint32_t *index = spirv_definition(s->from, chain[4]);
    return spirv_is(index, SpvOpConstant) ? index[3] : UINT32_MAX;
}

/* Whether the value is a texture, a sampler or a pointer, no number. */
static bool is_handle(const struct spirv *from, const uint32_t *i)
{
    const uint32_t *type = spirv_result(i) ? spirv_type(from, spirv_result(i)) : NULL;
    return type && (spirv_is(type, SpvOpTypeImage) || spirv_is(type, SpvOpTypeSampler) ||
                    spirv_is(type, SpvOpTypeSampledImage) || spirv_is(type, SpvOpTypePointer));
}

/* Whether an instruction has one result that can be chosen, and nothing else happens. */
static bool is_choice(const struct spirv *from, const uint32_t *i)
{
    const uint32_t *type = spirv_result(i) && !spirv_is(i, SpvOpFunctionCall)
                               ? spirv_type(from, spirv_result(i))
                               : NULL;
    type = type && spirv_is(type, SpvOpTypeVector) ? spirv_definition(from, type[2]) : type;
    bool image = spirv_opcode(i) >= SpvOpSampledImage && spirv_opcode(i) <= SpvOpImageQuerySamples;
    return type && image && spirv_letter(type) && !spirv_is(i, SpvOpImageTexelPointer);
}

/* Follows what is made of the array. False: nothing, or something that cannot be written for each element. */
static bool follow_array(struct spreading *s)
{
    const struct spirv *from = s->from;
    SPIRV_EACH(from, i, from->code, from->count) {
        uint32_t chain = 0, result = spirv_result(i);
        for (uint32_t word = 1; word < spirv_length(i); word++) {
            if (spirv_is_literal(i, word))
                continue;
            if (i[word] == s->array[2] && !(is_chain(s, i) && word == 3))
                return false;
            if (s->chain[i[word]] && chain && chain != s->chain[i[word]])
                return false;
            chain = s->chain[i[word]] ? s->chain[i[word]] : chain;
        }
        bool own = is_chain(s, i), fixed = own && constant_element(s, i) < s->count;
        s->used |= own;
        if (fixed && spirv_length(i) == 5)
            s->known[result] = s->elements[constant_element(s, i)];
        else if (own && !fixed && spirv_length(i) == 5)
            s->chain[result] = result, s->chooses = true;
        else if ((own && !fixed) || (chain && !is_handle(from, i) && !is_choice(from, i)))
            return false;
        else if (chain && is_handle(from, i))
            s->chain[result] = chain;
    }
    return s->used;
}

/* ---- The elements ---------------------------------------------------------------------------- */

static void declare_elements(struct spreading *s)
{
    const struct spirv *from = s->from;
    uint32_t type = spirv_definition(from, spirv_pointee(from, s->array))[2];
    uint32_t pointer = SPIRV_DECLARE(&s->edit, SpvOpTypePointer, 0, s->array[3], type);
    for (uint32_t k = 0; k < s->count; k++) {
        char name[300];
        snprintf(name, sizeof name, "%s_%u", spirv_variable_name(from, s->array), k);
        SPIRV_PUT(&s->edit, &s->edit.declarations, SpvOpVariable, pointer, s->elements[k],
                  s->array[3]);
        spirv_put_name(&s->edit, s->elements[k], name);
    }
}

/* Without what only arrays need: their capabilities and extension. Elements have the decorations of the array. */
static void copy_sections(struct spreading *s)
{
    const struct spirv *from = s->from;
    SPIRV_EACH_AT(from, at, SPIRV_HEADER, from->declarations) {
        const uint32_t *i = from->words + at;
        struct spirv_words *to = at < from->annotations ? &s->edit.front : &s->edit.annotations;
        bool about = spirv_is(i, SpvOpDecorate) || spirv_is(i, SpvOpName);
        bool gone = about && (s->known[i[1]] || s->chain[i[1]]);
        gone |= spirv_is(i, SpvOpDecorate) && i[2] == SpvDecorationNonUniform;
        gone |= spirv_is(i, SpvOpCapability) &&
                ((i[1] >= SpvCapabilityUniformBufferArrayDynamicIndexing &&
                  i[1] <= SpvCapabilityStorageImageArrayDynamicIndexing) ||
                 (i[1] >= SpvCapabilityShaderNonUniform &&
                  i[1] <= SpvCapabilityStorageTexelBufferArrayNonUniformIndexing));
        gone |= spirv_is(i, SpvOpExtension) &&
                !strcmp((const char *)(i + 1), "SPV_EXT_descriptor_indexing");
        if (!gone)
            spirv_copy(&s->edit, to, i);
        for (uint32_t k = 0; spirv_is(i, SpvOpDecorate) && i[1] == s->array[2] && k < s->count;
             k++) {
            spirv_copy_with(&s->edit, to, i, 1, s->elements[k]);
            if (!s->edit.failed && i[2] == SpvDecorationBinding)
                to->data[to->count - 1] += k << 20; /* another resource than its neighbours */
        }
    }
}

/* ---- Code ------------------------------------------------------------------------------------ */

/* An instruction for one element, with what it is made of; its result, which is new. */
static uint32_t put_for(struct spreading *s, const uint32_t *i, uint32_t k)
{
    struct spirv_edit *edit = &s->edit;
    uint32_t words[64], length = spirv_length(i) < 64 ? spirv_length(i) : 64;
    if (is_chain(s, i))
        return s->elements[k];
    memcpy(words, i, length * sizeof *words);
    for (uint32_t word = 1; word < length; word++)
        if (!spirv_is_literal(i, word) && word != spirv_result_word(i) && s->chain[i[word]])
            words[word] = put_for(s, spirv_definition(s->from, i[word]), k);
    words[spirv_result_word(i)] = edit->bound++;
    spirv_put(edit, &edit->code, spirv_opcode(i), words + 1, length - 1);
    return words[spirv_result_word(i)];
}

/* Behind the first label of a function: an array of as many numbers, of the same name. */
static void put_numbers(struct spreading *s)
{
    struct spirv_edit *edit = &s->edit;
    uint32_t type = spirv_declare_scalar(edit, 'u');
    uint32_t length = SPIRV_DECLARE(edit, SpvOpConstant, type, s->count);
    type = SPIRV_DECLARE(edit, SpvOpTypeArray, 0, type, length);
    type = SPIRV_DECLARE(edit, SpvOpTypePointer, 0, SpvStorageClassFunction, type);
    s->numbers = SPIRV_VALUE(edit, &edit->code, SpvOpVariable, type, SpvStorageClassFunction);
    spirv_put_name(edit, s->numbers, spirv_variable_name(s->from, s->array));
}

static void put_index(struct spreading *s, uint32_t index)
{
    struct spirv_edit *edit = &s->edit;
    uint32_t type = SPIRV_DECLARE(edit, SpvOpTypePointer, 0, SpvStorageClassFunction,
                                  spirv_declare_scalar(edit, 'u'));
    SPIRV_VALUE(edit, &edit->code, SpvOpAccessChain, type, s->numbers, index);
}

static void put_choice(struct spreading *s, const uint32_t *i, uint32_t chain)
{
    struct spirv_edit *edit = &s->edit;
    const uint32_t *type = spirv_definition(s->from, i[1]);
    uint32_t index = spirv_definition(s->from, chain)[4],
             index_type = spirv_definition(s->from, index)[1];
    put_index(s, index);
    uint32_t truth = spirv_declare_scalar(edit, 'b'), value = put_for(s, i, 0);
    for (uint32_t k = 1; k < s->count; k++) {
        uint32_t other = put_for(s, i, k);
        uint32_t number = SPIRV_DECLARE(edit, SpvOpConstant, index_type, k);
        uint32_t is = SPIRV_VALUE(edit, &edit->code, SpvOpIEqual, truth, index, number);
        if (spirv_is(type, SpvOpTypeVector)) {
            uint32_t many = spirv_declare_vector(edit, truth, type[3]);
            const uint32_t each[] = {is, is, is, is};
            is = spirv_put_value(edit, &edit->code, SpvOpCompositeConstruct, many, each, type[3]);
        }
        value = SPIRV_VALUE(edit, &edit->code, SpvOpSelect, i[1], is, other, value);
    }
    SPIRV_PUT(edit, &edit->code, SpvOpCopyObject, i[1], i[2], value);
}

static void put_code(struct spreading *s)
{
    const struct spirv *from = s->from;
    struct spirv_edit *edit = &s->edit;
    SPIRV_EACH(from, i, from->code, from->count) {
        uint32_t result = spirv_result(i), chain = 0;
        if (result && (s->chain[result] || s->known[result]))
            continue;
        for (uint32_t word = 1; word < spirv_length(i); word++)
            if (!spirv_is_literal(i, word) && s->chain[i[word]])
                chain = s->chain[i[word]];
        if (chain) {
            put_choice(s, i, chain);
            continue;
        }
        if (is_chain(s, i)) { /* into a buffer; it may be as long as an instruction can be */
            uint32_t head[] = {(*i - (1 << 16)), i[1], i[2], s->elements[constant_element(s, i)]};
            spirv_append(edit, &edit->code, head, sizeof head / sizeof *head);
            spirv_append(edit, &edit->code, i + 5, spirv_length(i) - 5);
            continue;
        }
        spirv_copy_mapped(edit, &edit->code, i, s->known);
        if (spirv_is(i, SpvOpFunction))
            s->numbers = 0;
        else if (spirv_is(i, SpvOpLabel) && s->chooses && !s->numbers)
            put_numbers(s);
    }
}

/* ---------------------------------------------------------------------------------------------- */

static bool is_array_of_resources(const struct spirv *from, const uint32_t *variable)
{
    const uint32_t *type = spirv_definition(from, spirv_pointee(from, variable));
    if (!spirv_is_array(type))
        return false;
    return variable[3] == SpvStorageClassUniformConstant ||
           variable[3] == SpvStorageClassStorageBuffer ||
           (variable[3] == SpvStorageClassUniform &&
            spirv_decoration(from, type[2], SpvDecorationBufferBlock) != UINT32_MAX);
}

/* One array. *done: there was one. */
static bool spread_one(struct spirv *module, const uint32_t *variable, bool *done)
{
    uint32_t bound = module->words[3];
    uint32_t length =
        spirv_array_length(module, spirv_definition(module, spirv_pointee(module, variable)));
    struct spreading s = {.from = module,
                          .array = variable,
                          .count = length ? length : UNSIZED_ELEMENTS,
                          .known = calloc(bound, sizeof *s.known),
                          .chain = calloc(bound, sizeof *s.chain)};
    bool good = s.known && s.chain;
    for (uint32_t k = 0; k < MOST_ELEMENTS; k++)
        s.elements[k] = bound + k;
    *done = good && s.count <= MOST_ELEMENTS && follow_array(&s);
    if (*done) {
        spirv_edit_begin(&s.edit, module);
        s.edit.front.count = SPIRV_HEADER;
        s.edit.bound += s.count;
        copy_sections(&s);
        declare_elements(&s);
        put_code(&s);
    }
    free(s.known);
    free(s.chain);
    return *done ? spirv_edit_end(&s.edit, module) : good;
}

bool spirv_spread(struct spirv *module)
{
    bool good = true, done;
    for (size_t at = module->declarations; good && at < module->code;) {
        const uint32_t *i = module->words + at;
        at += spirv_length(i);
        if (!spirv_is(i, SpvOpVariable) || !is_array_of_resources(module, i))
            continue;
        good = spread_one(module, i, &done);
        if (done)
            at = module->declarations; /* another module */
    }
    return good;
}
