/* The entry point becomes a function that calls diptych_globals() and diptych_begin(), which fill the generator's
 * global variables and the uniforms of a whole shader (join.c, bind.c), the body's main, then diptych_end(), which the generator declares where something
 * must run behind the body (glsl_body.c), then diptych_quads() and diptych_flush(), which --sanitize adds. So the body may return
 * where it likes, and its text stays as it is. */
#include <spirv/unified1/spirv.h>

#include "passes.h"

/* What is said of the body is said of the entry point. */
static void rename_entry(struct spirv_edit *edit, uint32_t body, uint32_t entry)
{
    for (size_t at = SPIRV_HEADER; !edit->failed && at < edit->front.count;
         at += spirv_length(edit->front.data + at)) {
        uint32_t *instruction = edit->front.data + at;
        if (spirv_is(instruction, SpvOpEntryPoint))
            instruction[2] = entry;
        else if (spirv_is(instruction, SpvOpName) && instruction[1] == body)
            instruction[1] = entry; /* "main" */
        else if (spirv_is(instruction, SpvOpExecutionMode) && instruction[1] == body)
            instruction[1] = entry;
    }
}

static const uint32_t *find_sample_mask(const struct spirv *module)
{
    SPIRV_EACH(module, i, module->declarations, module->code)
        if (spirv_is(i, SpvOpVariable) && i[3] == SpvStorageClassOutput &&
            spirv_decoration(module, i[2], SpvDecorationBuiltIn) == SpvBuiltInSampleMask)
            return i;
    return NULL;
}

/* Targets have one sample, of which OpenGL takes no mask: without it, the fragment is discarded, as by Vulkan. */
static void put_sample_mask(struct spirv_edit *edit, const uint32_t *mask)
{
    struct spirv_words *code = &edit->code;
    uint32_t type = spirv_definition(edit->from, spirv_pointee(edit->from, mask))[2];
    uint32_t zero = SPIRV_DECLARE(edit, SpvOpConstant, type, 0);
    uint32_t one = SPIRV_DECLARE(edit, SpvOpConstant, type, 1);
    uint32_t truth = spirv_declare_scalar(edit, 'b');
    uint32_t pointer = SPIRV_DECLARE(edit, SpvOpTypePointer, 0, SpvStorageClassOutput, type);
    uint32_t first = SPIRV_VALUE(edit, code, SpvOpAccessChain, pointer, mask[2], zero);
    uint32_t bits = SPIRV_VALUE(edit, code, SpvOpLoad, type, first);
    uint32_t bit = SPIRV_VALUE(edit, code, SpvOpBitwiseAnd, type, bits, one);
    uint32_t none = SPIRV_VALUE(edit, code, SpvOpIEqual, truth, bit, zero);
    spirv_put_discard(edit, none);
}

bool spirv_end_entry(struct spirv *module)
{
    enum { BODY = 2, CALLS = 6 };
    uint32_t body = spirv_entry(module), calls[CALLS] = {0}, others = 0;
    const char *const names[CALLS] = {"diptych_globals(", "diptych_begin(", NULL,
                                      "diptych_end(",     "diptych_quads(", "diptych_flush("};
    for (int i = 0; i < CALLS; i++) {
        const struct spirv_function *function =
            names[i] ? spirv_find_function(module, names[i]) : NULL;
        calls[i] = function ? function->id : 0;
        others += function != NULL;
    }
    const uint32_t *mask = find_sample_mask(module);
    if (!others && !mask)
        return true;
    calls[BODY] = body;
    struct spirv_edit edit;
    const uint32_t *head = spirv_definition(module, body);
    uint32_t void_type = head[1], function_type = head[4];
    spirv_edit_begin(&edit, module);
    uint32_t entry = edit.bound++, label = edit.bound++;
    rename_entry(&edit, body, entry);
    spirv_edit_keep(&edit);
    spirv_put_name(&edit, body, "pass_main(");
    SPIRV_PUT(&edit, &edit.code, SpvOpFunction, void_type, entry, SpvFunctionControlMaskNone,
              function_type);
    SPIRV_PUT(&edit, &edit.code, SpvOpLabel, label);
    for (int i = 0; i < CALLS; i++) {
        uint32_t result = edit.bound++;
        if (calls[i])
            SPIRV_PUT(&edit, &edit.code, SpvOpFunctionCall, void_type, result, calls[i]);
    }
    if (mask)
        put_sample_mask(&edit, mask);
    spirv_put(&edit, &edit.code, SpvOpReturn, NULL, 0);
    spirv_put(&edit, &edit.code, SpvOpFunctionEnd, NULL, 0);
    return spirv_edit_end(&edit, module);
}
