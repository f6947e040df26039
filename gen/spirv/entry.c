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
    if (!others)
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
    spirv_put(&edit, &edit.code, SpvOpReturn, NULL, 0);
    spirv_put(&edit, &edit.code, SpvOpFunctionEnd, NULL, 0);
    return spirv_edit_end(&edit, module);
}
