/* A module for Vulkan becomes one for OpenGL: no descriptor sets, OpenGL's numbers of vertices and
 * instances, its origin of gl_FragCoord, and functions before those that call them. */
#include <spirv/unified1/spirv.h>

#include "model/leaves.h"
#include "passes.h"

/* Whether it is the block of an array that stages hand on: Mesa's GLSL knows no locations of these, but those of arrays of structs. */
static bool is_block_of_array(const struct spirv *module, uint32_t type)
{
    bool found = false;
    SPIRV_EACH(module, i, module->declarations, module->code) {
        bool between = spirv_is(i, SpvOpVariable) &&
                       (i[3] == SpvStorageClassInput || i[3] == SpvStorageClassOutput) &&
                       spirv_decoration(module, i[2], SpvDecorationLocation) != UINT32_MAX;
        found |= between && spirv_pointee(module, i) != type &&
                 spirv_element_type(module, spirv_pointee(module, i)) == type;
    }
    return found;
}

static void copy_decorations(struct spirv_edit *edit)
{
    const struct spirv *from = edit->from;
    SPIRV_EACH(from, i, from->annotations, from->declarations) {
        bool decorates = spirv_is(i, SpvOpDecorate);
        if (decorates && (i[2] == SpvDecorationDescriptorSet ||
                          (i[2] == SpvDecorationBlock && is_block_of_array(from, i[1]))))
            continue;
        bool built_in = decorates && i[2] == SpvDecorationBuiltIn;
        if (built_in && i[3] == SpvBuiltInVertexIndex)
            spirv_copy_with(edit, &edit->annotations, i, 3, SpvBuiltInVertexId);
        else if (built_in && i[3] == SpvBuiltInInstanceIndex)
            spirv_copy_with(edit, &edit->annotations, i, 3, SpvBuiltInInstanceId);
        else
            spirv_copy(edit, &edit->annotations, i);
    }
}

/* The front again, with another origin; base: the variable of gl_BaseInstance, 0: none. */
static void copy_front(struct spirv_edit *edit, uint32_t base)
{
    const struct spirv *from = edit->from;
    edit->front.count = SPIRV_HEADER;
    if (base)
        SPIRV_PUT(edit, &edit->front, SpvOpCapability, SpvCapabilityDrawParameters);
    SPIRV_EACH(from, i, SPIRV_HEADER, from->annotations)
        if (spirv_is(i, SpvOpExecutionMode) && i[2] == SpvExecutionModeOriginUpperLeft)
            spirv_copy_with(edit, &edit->front, i, 2, SpvExecutionModeOriginLowerLeft);
        else
            spirv_copy(edit, &edit->front, i);
    if (base)
        spirv_put_text(edit, SpvOpExtension, NULL, 0, "SPV_KHR_shader_draw_parameters");
    spirv_edit_list(edit, UINT32_MAX, &base, base != 0);
}

/* OpenGL's number of an instance leaves out the base instance, which only indirect draws have. */
static void put_instance(struct spirv_edit *edit, const uint32_t *load, uint32_t base)
{
    uint32_t number = edit->bound++, first = edit->bound++;
    SPIRV_PUT(edit, &edit->code, SpvOpLoad, load[1], number, load[3]);
    SPIRV_PUT(edit, &edit->code, SpvOpLoad, load[1], first, base);
    SPIRV_PUT(edit, &edit->code, SpvOpIAdd, load[1], load[2], number, first);
}

struct functions {
    struct spirv_edit *edit;
    bool *copied;            /* by function */
    uint32_t instance, base; /* variables, 0: none */
};

/* Copies a function behind all that it calls: NVIDIA's linker may recurse without end in a call
 * of a function that follows (580.159, seen with a fragment shader of 42 KB). */
static void copy_function(struct functions *functions, uint32_t id)
{
    struct spirv_edit *edit = functions->edit;
    const struct spirv *from = edit->from;
    const struct spirv_function *function = spirv_function_of(from, id);
    bool *copied = &functions->copied[function - from->functions];
    if (*copied)
        return;
    *copied = true;
    SPIRV_EACH(from, i, function->begin, function->end)
        if (spirv_is(i, SpvOpFunctionCall))
            copy_function(functions, i[3]);
    SPIRV_EACH(from, instruction, function->begin, function->end) {
        if (functions->base && spirv_is(instruction, SpvOpLoad) &&
            instruction[3] == functions->instance)
            put_instance(edit, instruction, functions->base);
        else
            spirv_copy(edit, &edit->code, instruction);
        if (spirv_is(instruction, SpvOpTerminateInvocation) && !edit->failed) /* Mesa ignores it */
            edit->code.data[edit->code.count - 1] = 1u << 16 | SpvOpKill;
    }
}

bool spirv_for_opengl(struct spirv *module, bool indirect)
{
    struct spirv_edit edit;
    struct functions functions = {
        .edit = &edit, .instance = indirect ? spirv_builtin(module, SpvBuiltInInstanceIndex) : 0};
    spirv_edit_begin(&edit, module);
    functions.copied = spirv_edit_alloc(&edit, module->function_count, sizeof *functions.copied);
    copy_decorations(&edit);
    if (functions.instance) {
        uint32_t type = spirv_definition(module, functions.instance)[1];
        functions.base = edit.bound++;
        SPIRV_PUT(&edit, &edit.declarations, SpvOpVariable, type, functions.base,
                  SpvStorageClassInput);
        SPIRV_PUT(&edit, &edit.annotations, SpvOpDecorate, functions.base, SpvDecorationBuiltIn,
                  SpvBuiltInBaseInstance);
    }
    copy_front(&edit, functions.base);
    EACH(function, module->functions, functions.copied ? module->function_count : 0)
        copy_function(&functions, function->id);
    return spirv_edit_end(&edit, module);
}
