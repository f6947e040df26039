/* Globals that nothing changes become constants. `float gamma = 2.4;` at the top of a file is a variable, which main sets
 * first; public shaders choose their form by many of them. What then never runs goes, before exact.c makes tens of
 * instructions of each operation there: drivers would take minutes to find that out. Shaders without such globals stay. */
#include <spirv/unified1/spirv.h>
#include <stdlib.h>

#include "model/foreign.h"
#include "model/spirv_check.h"
#include "passes.h"

struct globals {
    const struct spirv *from;
    /* By id of a variable: the constant that main sets first; 0: nothing; itself: it changes. */
    uint32_t *values;
    size_t end; /* of what main runs first, without branches and calls */
};

/* Whether an id is a private variable that nothing has set yet. */
static bool is_unset(const struct globals *globals, uint32_t id)
{
    const uint32_t *i = spirv_definition(globals->from, id);
    return spirv_is(i, SpvOpVariable) && i[3] == SpvStorageClassPrivate && spirv_length(i) == 4 &&
           !globals->values[id];
}

static bool is_constant(const struct spirv *from, uint32_t id)
{
    uint32_t opcode = spirv_opcode(spirv_definition(from, id));
    return opcode >= SpvOpConstantTrue && opcode <= SpvOpConstantComposite;
}

/* Reads the first block of main. */
static void find_constants(struct globals *globals)
{
    const struct spirv *from = globals->from;
    const struct spirv_function *entry = spirv_function_of(from, spirv_entry(from));
    size_t at = entry->begin;
    for (; !spirv_is(from->words + at, SpvOpFunctionEnd); at += spirv_length(from->words + at)) {
        const uint32_t *i = from->words + at;
        uint32_t opcode = spirv_opcode(i);
        if (opcode == SpvOpFunctionCall || (opcode >= SpvOpLoopMerge && opcode != SpvOpLabel))
            break;
        if (opcode == SpvOpLoad && is_unset(globals, i[3]))
            globals->values[i[3]] = i[3];
        else if (opcode == SpvOpStore)
            globals->values[i[1]] =
                is_unset(globals, i[1]) && is_constant(from, i[2]) ? i[2] : i[1];
    }
    globals->end = at;
}

/* Reads all other code: what else sets a global, or points to it. False: none stays. */
static bool forget_changed(struct globals *globals)
{
    const struct spirv *from = globals->from;
    const struct spirv_function *entry = spirv_function_of(from, spirv_entry(from));
    bool any = false;
    SPIRV_EACH(from, at, from->code, from->count)
    {
        const uint32_t *i = from->words + at;
        bool first = at >= entry->begin && at < globals->end && spirv_is(i, SpvOpStore);
        for (uint32_t word = 1; !first && word < spirv_length(i); word++)
            if (!spirv_is_literal(i, word) && !spirv_is(i, SpvOpLoad) && i[word] < from->words[3])
                globals->values[i[word]] = i[word];
    }
    SPIRV_EACH(from, at, from->declarations, from->code)
    {
        uint32_t id = spirv_result(from->words + at);
        any |= globals->values[id] && globals->values[id] != id;
    }
    return any;
}

/* Numbers of floats stay as they are computed: only exact.c knows their bits. */
static bool is_kept(const uint32_t *i)
{
    uint32_t opcode = spirv_opcode(i);
    return spirv_is(i, SpvOpExtInst) ||
           (opcode >= SpvOpConvertFToU && opcode <= SpvOpQuantizeToF16) ||
           (spirv_is_arithmetic(i) && opcode < SpvOpFOrdEqual);
}

static bool put_constants(struct globals *globals, struct spirv *module)
{
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    spirv_edit_annotations(&edit);
    SPIRV_EACH(module, at, edit.failed ? module->count : module->code, module->count)
    {
        const uint32_t *i = module->words + at;
        uint32_t value = spirv_is(i, SpvOpLoad) ? globals->values[i[3]] : 0;
        if (value && value != i[3])
            SPIRV_PUT(&edit, &edit.code, SpvOpCopyObject, i[1], i[2], value);
        else
            spirv_copy(&edit, &edit.code, i);
        if (is_kept(i))
            SPIRV_PUT(&edit, &edit.annotations, SpvOpDecorate, i[2], SpvDecorationNoContraction);
    }
    return spirv_edit_end(&edit, module);
}

bool spirv_settle_globals(struct spirv *module)
{
    struct globals globals = {module, calloc(module->words[3], sizeof *globals.values), 0};
    bool good = globals.values;
    if (good)
        find_constants(&globals);
    if (good && forget_changed(&globals))
        good = put_constants(&globals, module) && spirv_reread(module, SPIRV_PRUNE);
    free(globals.values);
    return good;
}
