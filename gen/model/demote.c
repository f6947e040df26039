/* A fragment's invocation that is demoted runs on as a helper, whose derivatives count, and leaves nothing. OpenGL lacks that: such an
 * invocation is marked instead, and discarded where the entry point returns. See foreign.h. */
#include <spirv/unified1/spirv.h>
#include <string.h>

#include "foreign.h"

bool spirv_can_demote(const struct spirv *module)
{
    bool good =
        true; /* no buffer or image is written, which no helper does, and none asks for helpers */
    SPIRV_EACH(module, i, module->code, module->count) {
        uint32_t opcode = spirv_opcode(i);
        uint32_t class = opcode == SpvOpStore || opcode == SpvOpCopyMemory
                             ? spirv_type(module, i[1])[2]
                             : SpvStorageClassFunction;
        good &= class != SpvStorageClassUniform && class != SpvStorageClassStorageBuffer &&
                opcode != SpvOpImageWrite && opcode != SpvOpIsHelperInvocationEXT &&
                !(opcode >= SpvOpAtomicLoad && opcode <= SpvOpAtomicXor);
    }
    return good;
}

static bool is_demotion(const uint32_t *i)
{
    return (spirv_is(i, SpvOpCapability) && i[1] == SpvCapabilityDemoteToHelperInvocation) ||
           (spirv_is(i, SpvOpExtension) && strstr((const char *)(i + 1), "_demote_to_helper"));
}

/* Without the capability; entry points list the mark where they list all variables. */
static void copy_front_without(struct spirv_edit *edit, uint32_t mark)
{
    const struct spirv *from = edit->from;
    edit->front.count = SPIRV_HEADER;
    SPIRV_EACH(from, i, SPIRV_HEADER, edit->failed ? 0 : from->annotations)
        if (!is_demotion(i))
            spirv_copy(edit, &edit->front, i);
    if (from->words[1] >= 0x10400)
        spirv_edit_list(edit, UINT32_MAX, &mark, 1);
}

static bool is_entry(const struct spirv *module, uint32_t function)
{
    bool found = false;
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations)
        found |= spirv_is(i, SpvOpEntryPoint) && i[2] == function;
    return found;
}

static void put_marks(struct spirv_edit *edit, uint32_t mark, uint32_t truth)
{
    const struct spirv *from = edit->from;
    uint32_t no = spirv_declare(edit, SpvOpConstantFalse, truth, NULL, 0);
    uint32_t yes = spirv_declare(edit, SpvOpConstantTrue, truth, NULL, 0);
    uint32_t labels = 0;
    bool entry = false;
    SPIRV_EACH(from, i, edit->failed ? from->count : from->code, from->count) {
        bool head = spirv_is(i, SpvOpLabel) || spirv_is(i, SpvOpVariable) ||
                    spirv_is(i, SpvOpLine) || spirv_is(i, SpvOpNoLine);
        if (spirv_is(i, SpvOpFunction)) {
            entry = is_entry(from, i[2]);
            labels = 0;
        }
        if (entry && labels == 1 && !head) {
            SPIRV_PUT(edit, &edit->code, SpvOpStore, mark, no);
            labels++;
        }
        labels += spirv_is(i, SpvOpLabel);
        if (entry && spirv_is(i, SpvOpReturn))
            spirv_put_discard(edit, SPIRV_VALUE(edit, &edit->code, SpvOpLoad, truth, mark));
        if (spirv_is(i, SpvOpDemoteToHelperInvocation))
            SPIRV_PUT(edit, &edit->code, SpvOpStore, mark, yes);
        else
            spirv_copy(edit, &edit->code, i);
    }
}

bool spirv_demote(struct spirv *module)
{
    struct spirv_edit edit;
    bool found = false;
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations)
        found |= is_demotion(i);
    if (!found || !spirv_can_demote(module))
        return true; /* bind.c refuses the module */
    spirv_edit_begin(&edit, module);
    uint32_t truth = spirv_declare_scalar(&edit, 'b');
    uint32_t mark = spirv_add_variable(&edit, SpvStorageClassPrivate, truth);
    copy_front_without(&edit, mark);
    spirv_edit_annotations(&edit);
    put_marks(&edit, mark, truth);
    return spirv_edit_end(&edit, module);
}
