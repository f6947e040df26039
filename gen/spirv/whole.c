/* See whole.h. */
#include "whole.h"

#include <math.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bind.h"
#include "compile.h"
#include "formats.h"
#include "glsl/glsl.h"
#include "model/foreign.h"
#include "model/leaves.h"
#include "model/names.h"
#include "model/spirv_check.h"
#include "passes.h"
#include "plan/plan.h"
#include "read/body_files.h"
#include "stages.h"

/* ---- Specialization -------------------------------------------------------------------------- */

static const struct param *find_param(const struct pipeline *pipeline, const char *name)
{
    return name ? declared_find(pipeline, DECLARED_PARAM, name) : NULL;
}

/* The parameter of a specialization constant: by its name, by that of another with its number, or by constant_NUMBER. */
static const struct param *find_special(const struct pipeline *pipeline, const struct spirv *module,
                                        uint32_t id)
{
    char number[32];
    uint32_t special = spirv_decoration(module, id, SpvDecorationSpecId);
    const struct param *param = find_param(pipeline, spirv_own_name(spirv_name(module, id)));
    SPIRV_EACH(module, i, module->declarations, module->code) {
        uint32_t other = spirv_result(i);
        if (!param && special != UINT32_MAX && other &&
            spirv_decoration(module, other, SpvDecorationSpecId) == special)
            param = find_param(pipeline, spirv_own_name(spirv_name(module, other)));
    }
    snprintf(number, sizeof number, "constant_%u", special);
    return param ? param : find_param(pipeline, number);
}

/* The words of a number of that type; false: it has no such value. */
static bool number_words(const uint32_t *type, double number, uint32_t *words)
{
    float single = (float)number;
    uint32_t bits = type[2];
    double limit = ldexp(1, (int)bits),
           least = spirv_is(type, SpvOpTypeInt) && type[3] ? -limit / 2 : 0;
    if (spirv_is(type, SpvOpTypeFloat)) {
        memcpy(words, bits == 64 ? (void *)&number : (void *)&single, bits == 64 ? 8 : 4);
        return bits > 16;
    }
    if (number < least || number >= limit + least || number != floor(number))
        return false;
    uint64_t whole = number < 0 ? (uint64_t)(int64_t)number : (uint64_t)number;
    memcpy(words, &whole, bits == 64 ? 8 : 4);
    return true;
}

/* A specialization constant gets the value of its baked parameter, in place. */
static bool set_constant(const struct pipeline *pipeline, const struct spirv *module, uint32_t *i,
                         char **log)
{
    const struct param *param = find_special(pipeline, module, i[2]);
    const uint32_t *type = spirv_definition(module, i[1]);
    if (!param)
        return true;
    bool baked = !param->live && !param->uniform && param->components == 1;
    if (baked && spirv_is(type, SpvOpTypeBool))
        i[0] = 3u << 16 | (param->value[0] != 0 ? SpvOpSpecConstantTrue : SpvOpSpecConstantFalse);
    else if (!baked || !number_words(type, param->value[0], i + 3)) {
        free(*log);
        *log =
            format_string(baked ? "the specialization constant `%s` has a type without the value %g"
                                : "the specialization constant `%s` needs a parameter of one "
                                  "number that is neither live nor uniform",
                          param->name, param->value[0]);
        return false;
    }
    return true;
}

static uint32_t constant_number(const struct spirv *module, uint32_t id)
{
    const uint32_t *constant = spirv_definition(module, id);
    return spirv_is(constant, SpvOpConstant) ? constant[3] : 1;
}

/* The size of a workgroup in LocalSize, in place, also where a constant or other ids give it. */
static void set_local(struct spirv *module)
{
    const uint32_t *own = spirv_definition(module, spirv_builtin(module, SpvBuiltInWorkgroupSize));
    bool known = spirv_is(own, SpvOpConstantComposite) && spirv_length(own) == 6;
    const uint32_t *size = known ? own + 3 : NULL;
    SPIRV_CHANGE(module, i, SPIRV_HEADER, module->annotations) {
        bool ids = spirv_is(i, SpvOpExecutionModeId) && i[2] == SpvExecutionModeLocalSizeId;
        if (!ids && !(spirv_is(i, SpvOpExecutionMode) && i[2] == SpvExecutionModeLocalSize))
            continue;
        for (int axis = 0; axis < 3 && (ids || size); axis++)
            i[3 + axis] = constant_number(module, size ? size[axis] : i[3 + axis]);
        i[0] = 6u << 16 | SpvOpExecutionMode;
        i[2] = SpvExecutionModeLocalSize;
    }
}

bool whole_specialize(const struct pipeline *pipeline, struct spirv *module, char **log)
{
    bool any = false, good = true;
    SPIRV_CHANGE(module, i, module->declarations, module->code) {
        uint32_t opcode = spirv_opcode(i);
        any |= opcode >= SpvOpSpecConstantTrue && opcode <= SpvOpSpecConstantOp;
        if (good && opcode >= SpvOpSpecConstantTrue && opcode <= SpvOpSpecConstant)
            good = set_constant(pipeline, module, i, log);
    }
    if (any && good)
        good = spirv_reread(module, SPIRV_FREEZE);
    if (good)
        set_local(module);
    return good;
}

/* ---- The module ------------------------------------------------------------------------------ */

/* The module of the stage among the files; NULL: a text. */
static const struct body_file *find_module(const struct body_files *files, uint32_t model)
{
    for (uint32_t i = 0; i < files->count; i++)
        if (files->list[i].words &&
            spirv_has_entry(files->list[i].words, files->list[i].word_count, model))
            return &files->list[i];
    return NULL;
}

/* Without lines, which makes no valid module of all that follows. */
static bool without_lines(struct spirv *module)
{
    size_t count;
    uint32_t *words = spirv_take(module, &count);
    return spirv_read(module, words, spirv_strip_lines(words, SPIRV_HEADER, count));
}

static bool read_own(const struct pass *pass, const struct shader *shader, bool lines,
                     struct spirv *module, char **log)
{
    static const uint32_t models[] = {[STAGE_IS_COMPUTE] = SpvExecutionModelGLCompute,
                                      [STAGE_IS_VERTEX] = SpvExecutionModelVertex,
                                      [STAGE_IS_FRAGMENT] = SpvExecutionModelFragment};
    const struct body_file *file = find_module(shader->files, models[shader->stage]);
    if (!file)
        return spirv_read_text(pass, shader, &shader->whole, lines, 0, module, log) &&
               (!lines || !spirv_passes_textures(module) ||
                (spirv_reread(module, SPIRV_INLINE) && spirv_lower_phis(module))) &&
               spirv_combine(module);
    return spirv_open(module, file->words, file->word_count) &&
           spirv_choose_entry(module, models[shader->stage]) &&
           (lines ? spirv_lower_phis(module) : without_lines(module));
}

/* A fault of two stages, as glslang would write it, at the first place that has the name, with the file of the stage before. */
static void tell_fault(const struct shader *shader, const struct stage_fault *fault, char **log)
{
    struct text text = {0};
    struct loc loc = {0};
    uint32_t number = *fault->name ? body_find(shader->files, fault->name, &loc) : 0;
    free(*log);
    if (number)
        text_add(&text, "ERROR: %u:%d: '%s' : ", number, loc.line, fault->name);
    text_add(&text, "%s", fault->text);
    if (shader->files->whole && shader->files->include_count)
        text_add(&text, "; the vertex stage is %s", shader->files->includes[0].file->source->path);
    text_add(&text, "\n");
    *log = *fault->text ? text.data : NULL;
}

static bool read_stage(const struct model *model, const struct pass *pass,
                       const struct shader *shader, bool lines, struct spirv *module, char **log)
{
    return read_own(pass, shader, lines, module, log) &&
           whole_specialize(&model->pipeline, module, log);
}

bool whole_read(const struct model *model, const struct pass *pass, const struct shader *shader,
                bool lines, struct spirv *module, char **log)
{
    struct spirv before = {0};
    struct stage_fault fault;
    bool good = read_stage(model, pass, shader, lines, module, log) &&
                spirv_locate(module, SpvStorageClassOutput);
    if (!good || !shader->before)
        return good;
    good = read_stage(model, pass, shader->before, false, &before, log);
    if (good && !spirv_locate_inputs(module, &before, shader->files->version, &fault)) {
        tell_fault(shader, &fault, log);
        good = false;
    }
    spirv_free(&before);
    return good;
}

bool whole_bind(const struct pass *pass, const struct shader *shader, const struct spirv *more,
                struct spirv *module, char **log)
{
    struct bind_slot *slots = calloc(pass->access_count + 1, sizeof *slots);
    struct bind_request request = {.slots = slots,
                                   .inputs =
                                       shader->stage == STAGE_IS_VERTEX || !pass->own_vertices,
                                   .exact = !pass->fast,
                                   .first = module->words[3],
                                   .local = shader->stage == STAGE_IS_COMPUTE ? pass->local : NULL};
    for (uint32_t i = 0; slots && i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];
        const struct resource *resource = access->resource;
        bool image = resource && resource->kind == DT_IMAGE;
        struct bind_slot slot = {.name = access_word(access),
                                 .binding = access->binding,
                                 .kind = access->kind,
                                 .compare = access->filter && access->filter->compare,
                                 .format = image ? format_info(resource->format)->qualifier : NULL};
        if (image)
            glsl_declared(access, slot.declared, sizeof slot.declared);
        if (image && access->attachment >= 0 && shader->stage == STAGE_IS_FRAGMENT)
            request.targets[access->attachment] = *slot.declared == 's' ? 'f' : *slot.declared;
        if (access->binding >= 0 && resource)
            slots[request.slot_count++] = slot;
    }
    bool good = slots && spirv_join(module, more) && spirv_bind(module, &request, log);
    free(slots);
    return good;
}
