/* Leaves out what the entry point does not reach: functions, variables, types, constants, and their
 * names and decorations. Inputs and outputs stay, since stages agree on them; but inputs that are
 * built in go, too. */
#include <spirv/unified1/spirv.h>

#include "passes.h"

struct reach {
    const struct spirv *module;
    bool *live;      /* by id */
    uint32_t *queue; /* ids whose definitions are to be read */
    uint32_t count;
};

static void mark(struct reach *reach, uint32_t id)
{
    if (id < reach->module->words[3] && !reach->live[id]) {
        reach->live[id] = true;
        reach->queue[reach->count++] = id;
    }
}

static void mark_operands(struct reach *reach, const uint32_t *instruction)
{
    for (uint32_t word = 1; word < spirv_length(instruction); word++)
        if (!spirv_is_literal(instruction, word))
            mark(reach, instruction[word]);
}

static bool is_built_in_input(const struct spirv *module, uint32_t variable)
{
    return spirv_definition(module, variable)[3] == SpvStorageClassInput &&
           spirv_decoration(module, variable, SpvDecorationBuiltIn) != UINT32_MAX;
}

static void mark_entry(struct reach *reach, const uint32_t *entry)
{
    mark(reach, entry[2]);
    for (uint32_t word = spirv_entry_variables(entry); word < spirv_length(entry); word++)
        if (!is_built_in_input(reach->module, entry[word]))
            mark(reach, entry[word]);
}

static void mark_function(struct reach *reach, size_t at)
{
    const struct spirv *module = reach->module;
    for (; !spirv_is(module->words + at, SpvOpFunctionEnd); at += spirv_length(module->words + at))
        mark_operands(reach, module->words + at);
}

static void mark_all(struct reach *reach)
{
    const struct spirv *module = reach->module;
    SPIRV_EACH(module, instruction, SPIRV_HEADER, module->annotations)
        if (spirv_is(instruction, SpvOpEntryPoint))
            mark_entry(reach, instruction);
        else if (spirv_is(instruction, SpvOpExtInstImport) || spirv_is(instruction, SpvOpString))
            mark(reach, instruction[1]);
    if (spirv_builtin(module, SpvBuiltInWorkgroupSize))
        mark(reach, spirv_builtin(module, SpvBuiltInWorkgroupSize));
    while (reach->count) {
        size_t at = module->definitions[reach->queue[--reach->count]];
        if (at >= module->code && spirv_is(module->words + at, SpvOpFunction))
            mark_function(reach, at);
        else if (at >= module->declarations && at < module->code)
            mark_operands(reach, module->words + at);
    }
}

static bool is_target_live(const struct reach *reach, const uint32_t *instruction)
{
    bool has_target = spirv_is(instruction, SpvOpName) || spirv_is(instruction, SpvOpMemberName) ||
                      spirv_is(instruction, SpvOpDecorate) ||
                      spirv_is(instruction, SpvOpMemberDecorate);
    return !has_target || reach->live[instruction[1]];
}

static uint32_t keep_live(const void *user, uint32_t id)
{
    return ((const struct reach *)user)->live[id] ? id : 0;
}

static void copy_live(const struct reach *reach, struct spirv_edit *edit)
{
    const struct spirv *module = reach->module;
    edit->front.count = SPIRV_HEADER;
    edit->declarations.count = 0;
    SPIRV_EACH_AT(module, at, SPIRV_HEADER, module->declarations)
        if (is_target_live(reach, module->words + at))
            spirv_copy(edit, at < module->annotations ? &edit->front : &edit->annotations,
                       module->words + at);
    spirv_edit_interface(edit, keep_live, reach);
    SPIRV_EACH(module, i, module->declarations, module->code) {
        uint32_t result = spirv_result(i);
        if (!result || reach->live[result])
            spirv_copy(edit, &edit->declarations, i);
    }
    EACH(function, module->functions, module->function_count)
        if (reach->live[function->id])
            SPIRV_EACH(module, own, function->begin, function->end)
                spirv_copy(edit, &edit->code, own);
}

bool spirv_reach(struct spirv *module)
{
    struct reach reach = {.module = module};
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    reach.live = spirv_edit_table(&edit, sizeof *reach.live);
    reach.queue = spirv_edit_table(&edit, sizeof *reach.queue);
    if (!edit.failed) {
        mark_all(&reach);
        copy_live(&reach, &edit);
    }
    return spirv_edit_end(&edit, module);
}
