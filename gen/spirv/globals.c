/* Globals that nothing changes become constants. `float gamma = 2.4;` at the top of a file is a variable, which main sets
 * first; public shaders choose their form by many of them. What then never runs goes, before exact.c makes tens of
 * instructions of each operation there: drivers would take minutes to find that out. Shaders without such globals stay. */
#include <spirv/unified1/spirv.h>
#include <stdlib.h>

#include "model/foreign.h"
#include "model/spirv_check.h"
#include "passes.h"

/* values, by id of a variable: the constant that main stores before all branches and calls, and before it loads the
 * variable; 0: nothing; itself: it changes. */
static void read_code(const struct spirv *from, uint32_t *values)
{
    uint32_t entry = spirv_entry(from);
    bool first = false;
    SPIRV_EACH(from, i, from->code, from->count) {
        uint32_t opcode = spirv_opcode(i);
        if (opcode == SpvOpFunction)
            first = i[2] == entry;
        else if (opcode == SpvOpFunctionCall || (opcode >= SpvOpLoopMerge && opcode != SpvOpLabel))
            first = false;
        if (opcode == SpvOpLoad && first && !values[i[3]])
            values[i[3]] = i[3];
        if (opcode == SpvOpStore) {
            uint32_t kind = spirv_opcode(spirv_definition(from, i[2]));
            bool constant = kind >= SpvOpConstantTrue && kind <= SpvOpConstantComposite;
            values[i[1]] = first && constant && !values[i[1]] ? i[2] : i[1];
        }
        for (uint32_t word = 1; opcode != SpvOpLoad && word < spirv_length(i); word++)
            if (opcode != SpvOpStore && !spirv_is_literal(i, word) && i[word] < from->words[3])
                values[i[word]] = i[word];
    }
}

/* Whether a global is a constant; forgets what is none, since other invocations and stages see it. */
static bool find_constants(const struct spirv *from, uint32_t *values)
{
    bool any = false;
    SPIRV_EACH(from, i, from->declarations, from->code) {
        bool global = spirv_is(i, SpvOpVariable) && i[3] == SpvStorageClassPrivate;
        uint32_t id = spirv_result(i);
        any |= global && values[id] && values[id] != id;
        values[id] = global ? values[id] : id;
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

static bool put_constants(struct spirv *module, const uint32_t *values)
{
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    spirv_edit_annotations(&edit);
    SPIRV_EACH(module, i, edit.failed ? module->count : module->code, module->count) {
        uint32_t value = spirv_is(i, SpvOpLoad) ? values[i[3]] : 0;
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
    uint32_t *values = calloc(module->words[3], sizeof *values);
    bool good = values;
    if (good)
        read_code(module, values);
    if (good && find_constants(module, values))
        good = put_constants(module, values) && spirv_reread(module, SPIRV_PRUNE);
    free(values);
    return good;
}
