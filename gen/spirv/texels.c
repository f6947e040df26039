/* Buffers of the scene that a pass reads through texel buffers: CPU drivers read these at once, and
 * storage buffers lane by lane. The text declares NAME as a storage buffer, so a body reads it as
 * everywhere, and functions NAME_at(index) and NAME_length(), which fetch texels. This pass makes
 * each read of the buffer a call of these; the buffer then goes, since nothing reaches it. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "passes.h"

struct texels {
    const struct spirv *module;
    struct spirv_edit edit;
    uint32_t variable;   /* the buffer */
    uint32_t at, length; /* the functions */
};

/* 0: there is none. */
static uint32_t find_texel_function(const struct spirv *module, const char *format,
                                    const char *name)
{
    char wanted[96];
    snprintf(wanted, sizeof wanted, format, name);
    const struct spirv_function *found = spirv_find_function(module, wanted);
    return found ? found->id : 0;
}

/* The variable of the block NAME_block; 0: there is none. */
static uint32_t find_texel_buffer(const struct spirv *module, const char *name)
{
    char block[96];
    snprintf(block, sizeof block, "%s_block", name);
    SPIRV_EACH(module, variable, module->declarations, module->code) {
        if (!spirv_is(variable, SpvOpVariable))
            continue;
        const uint32_t *pointer = spirv_definition(module, variable[1]);
        const char *type = spirv_name(module, pointer[3]);
        if (type && !strcmp(type, block))
            return variable[2];
    }
    return 0;
}

/* The access chain into the buffer that defines a pointer; NULL: another pointer. */
static const uint32_t *chain_of(const struct texels *texels, uint32_t pointer)
{
    const uint32_t *chain = spirv_definition(texels->module, pointer);
    return spirv_is(chain, SpvOpAccessChain) && chain[3] == texels->variable ? chain : NULL;
}

static uint32_t result_type(const struct texels *texels, uint32_t function)
{
    return spirv_definition(texels->module, function)[1];
}

/* A value of one struct type as the other, which has the same members but is laid out in memory. */
static void put_copy(struct texels *texels, uint32_t type, uint32_t result, uint32_t value)
{
    struct spirv_edit *edit = &texels->edit;
    const uint32_t *declared = spirv_definition(texels->module, type);
    uint32_t operands[34] = {type, result}, count = 2;
    for (uint32_t i = 2; i < spirv_length(declared) && count < 34; i++) {
        uint32_t member =
            SPIRV_VALUE(edit, &edit->code, SpvOpCompositeExtract, declared[i], value, i - 2);
        operands[count++] = member;
    }
    spirv_put(edit, &edit->code, SpvOpCompositeConstruct, operands, count);
}

/* NAME_at(uint(index)), then the member and its components, if the chain goes so far. The index is
 * word 5 of the chain; members are numbers, which have constants as indices. */
static void put_read(struct texels *texels, const uint32_t *load, const uint32_t *chain)
{
    struct spirv_edit *edit = &texels->edit;
    const struct spirv *module = texels->module;
    uint32_t element = result_type(texels, texels->at), index = chain[5], call = edit->bound++;
    const uint32_t *type = spirv_type(module, index);
    if (type[3]) /* signed */
        index =
            SPIRV_VALUE(edit, &edit->code, SpvOpBitcast, spirv_declare_scalar(edit, 'u'), index);
    bool whole = spirv_length(chain) == 6;
    if (whole && element == load[1])
        call = load[2];
    SPIRV_PUT(edit, &edit->code, SpvOpFunctionCall, element, call, texels->at, index);
    if (whole && element != load[1])
        put_copy(texels, load[1], load[2], call);
    if (whole)
        return;
    uint32_t operands[10] = {load[1], load[2], call}, count = 3;
    for (uint32_t word = 6; word < spirv_length(chain) && count < 10; word++)
        operands[count++] = spirv_definition(module, chain[word])[3];
    spirv_put(edit, &edit->code, SpvOpCompositeExtract, operands, count);
}

static void put_length(struct texels *texels, const uint32_t *instruction)
{
    struct spirv_edit *edit = &texels->edit;
    uint32_t call = SPIRV_VALUE(edit, &edit->code, SpvOpFunctionCall,
                                result_type(texels, texels->length), texels->length);
    SPIRV_PUT(edit, &edit->code, SpvOpBitcast, instruction[1], instruction[2], call);
}

static void put_instruction(struct texels *texels, const uint32_t *instruction)
{
    const uint32_t *chain =
        spirv_is(instruction, SpvOpLoad) ? chain_of(texels, instruction[3]) : NULL;
    bool skipped = spirv_is(instruction, SpvOpAccessChain) && instruction[3] == texels->variable;
    if (chain)
        put_read(texels, instruction, chain);
    else if (spirv_is(instruction, SpvOpArrayLength) && instruction[3] == texels->variable)
        put_length(texels, instruction);
    else if (!skipped)
        spirv_copy(&texels->edit, &texels->edit.code, instruction);
}

bool spirv_texels(struct spirv *module, const char *name)
{
    struct texels texels = {.module = module,
                            .variable = find_texel_buffer(module, name),
                            .at = find_texel_function(module, "%s_at(u1;", name),
                            .length = find_texel_function(module, "%s_length(", name)};
    if (!texels.variable || !texels.at || !texels.length)
        return true;
    spirv_edit_begin(&texels.edit, module);
    spirv_edit_annotations(&texels.edit);
    SPIRV_EACH(module, i, module->code, module->count)
        put_instruction(&texels, i);
    return spirv_edit_end(&texels.edit, module);
}
