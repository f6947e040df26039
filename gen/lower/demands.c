/* What the shaders of a pass need of a device's limits, from their SPIR-V. */
#include <spirv/unified1/spirv.h>

#include "lower.h"
#include "model/module.h"

/* What promises of Vulkan 1.3 and OpenGL 4.6 cover needs no check. */
static const uint64_t promised[DT_LIMITS] = {
#define LEAST(a, b) ((a) < (b) ? (a) : (b))
#define ROW(name, words, vk, gl, gl_draw, index, roadmap, vulkan, moltenvk, opengl)                \
    [DT_LIMIT_##name] = LEAST(vulkan, opengl),
    DT_DEVICE_LIMITS(ROW)
#undef ROW
#undef LEAST
};

/* Bytes of a type without padding: drivers may add some, none needs less. */
static uint64_t type_bytes(const struct spirv *module, uint32_t id)
{
    const uint32_t *type = spirv_definition(module, id);
    bool number = spirv_is(type, SpvOpTypeInt) || spirv_is(type, SpvOpTypeFloat);
    uint32_t parts = spirv_parts(module, type);
    uint64_t sum = 0;
    if (parts && !spirv_is(type, SpvOpTypeStruct))
        return parts * type_bytes(module, type[2]);
    for (uint32_t i = 0; i < parts; i++)
        sum += type_bytes(module, spirv_part(type, i));
    return parts ? sum : spirv_is(type, SpvOpTypeBool) ? 4 : number ? type[2] / 8 : 0;
}

/* Whether a variable is a storage buffer or a storage image. */
static bool is_storage(const struct spirv *module, const uint32_t *variable, uint32_t pointee)
{
    const uint32_t *type = spirv_definition(module, pointee);
    if (variable[3] == SpvStorageClassUniformConstant)
        return spirv_is(type, SpvOpTypeImage) && type[7] == 2 && type[3] != SpvDimBuffer;
    return variable[3] == SpvStorageClassStorageBuffer ||
           (variable[3] == SpvStorageClassUniform &&
            spirv_decoration(module, pointee, SpvDecorationBufferBlock) != UINT32_MAX);
}

static void add_variable(const struct spirv *module, enum stage stage, const uint32_t *variable,
                         uint64_t demands[DT_LIMITS])
{
    uint32_t pointee = spirv_definition(module, variable[1])[3];
    uint32_t location = spirv_decoration(module, variable[2], SpvDecorationLocation);
    uint64_t end = location == UINT32_MAX ? 0 : 4 * (location + spirv_locations(module, pointee));
    if (variable[3] == SpvStorageClassWorkgroup)
        demands[DT_LIMIT_SHARED_BYTES] += type_bytes(module, pointee);
    if (stage == STAGE_IS_VERTEX && variable[3] == SpvStorageClassOutput &&
        demands[DT_LIMIT_VERTEX_OUTPUTS] < end)
        demands[DT_LIMIT_VERTEX_OUTPUTS] = end;
    if (stage != STAGE_IS_FRAGMENT)
        return;
    if (variable[3] == SpvStorageClassInput && demands[DT_LIMIT_FRAGMENT_INPUTS] < end)
        demands[DT_LIMIT_FRAGMENT_INPUTS] = end;
    demands[DT_LIMIT_OUTPUTS] +=
        is_storage(module, variable, pointee) || (variable[3] == SpvStorageClassOutput && end);
}

static bool add_shader(const struct shader *shader, uint64_t demands[DT_LIMITS])
{
    struct spirv module;
    if (!shader->word_count)
        return true;
    if (!spirv_open(&module, shader->words, shader->word_count))
        return false;
    SPIRV_EACH(&module, i, module.declarations, module.code)
        if (spirv_is(i, SpvOpVariable))
            add_variable(&module, shader->stage, i, demands);
    spirv_free(&module);
    return true;
}

bool find_demands(const struct pass *pass, const struct pass_shaders *shaders,
                  uint64_t demands[DT_LIMITS])
{
    bool good = true;
    for (int i = 0; i < DT_LIMITS; i++)
        demands[i] = 0;
    for (size_t i = 0; i < DT_ARRAY_COUNT(shaders->stage); i++)
        good &= add_shader(&shaders->stage[i], demands);
    for (int axis = 0; axis < 3 && !pass_draws(pass); axis++)
        demands[DT_LIMIT_LOCAL_X + axis] = pass->local[axis];
    if (!pass_draws(pass))
        demands[DT_LIMIT_INVOCATIONS] = (uint64_t)pass->local[0] * pass->local[1] * pass->local[2];
    for (int i = 0; i < DT_LIMITS; i++)
        if (demands[i] <= promised[i])
            demands[i] = 0;
    return good;
}
