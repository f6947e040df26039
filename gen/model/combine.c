/* Textures with samplers of their own become combined ones, as OpenGL and our passes have them: one for each
 * pair that the module samples, with the texture's name; with "NAME_SAMPLER" where it has several samplers. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foreign.h"

struct combined {
    uint32_t texture, sampler; /* variables; sampler 0: fetched alone */
    uint32_t variable, type;   /* of the combined one */
};

struct combining {
    const struct spirv *from;
    struct spirv_edit edit;
    struct combined *pairs; /* free() */
    uint32_t count;
};

/* The variable that a value was loaded from; 0: another way. */
static uint32_t loaded_from(const struct spirv *from, uint32_t value, uint32_t opcode)
{
    const uint32_t *load = spirv_definition(from, value);
    const uint32_t *variable = spirv_is(load, SpvOpLoad) ? spirv_definition(from, load[3]) : NULL;
    bool fits = variable && spirv_is(variable, SpvOpVariable) &&
                variable[3] == SpvStorageClassUniformConstant &&
                spirv_is(spirv_type(from, value), opcode);
    return fits ? variable[2] : 0;
}

static bool is_texture(const struct spirv *from, uint32_t value)
{
    uint32_t texture = loaded_from(from, value, SpvOpTypeImage);
    return texture && spirv_type(from, value)[7] == 1 && spirv_type(from, value)[3] != SpvDimBuffer;
}

static struct combined *find_combined(struct combining *c, uint32_t texture, uint32_t sampler)
{
    for (uint32_t i = 0; i < c->count; i++)
        if (c->pairs[i].texture == texture && (c->pairs[i].sampler == sampler || !sampler))
            return &c->pairs[i];
    return NULL;
}

static void add_combined(struct combining *c, uint32_t texture, uint32_t sampler)
{
    struct spirv_edit *edit = &c->edit;
    if (find_combined(c, texture, sampler))
        return;
    uint32_t image = spirv_definition(c->from, spirv_definition(c->from, texture)[1])[3];
    uint32_t type = spirv_declare(edit, SpvOpTypeSampledImage, 0, &image, 1);
    uint32_t pointer = spirv_declare(edit, SpvOpTypePointer, 0,
                                     (uint32_t[]){SpvStorageClassUniformConstant, type}, 2);
    uint32_t variable = edit->bound++;
    SPIRV_PUT(edit, &edit->declarations, SpvOpVariable, pointer, variable,
              SpvStorageClassUniformConstant);
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, variable, SpvDecorationDescriptorSet, 0);
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, variable, SpvDecorationBinding, c->count);
    c->pairs[c->count++] = (struct combined){texture, sampler, variable, type};
}

static void name_pairs(struct combining *c)
{
    for (uint32_t i = 0; i < c->count; i++) {
        const struct combined *pair = &c->pairs[i];
        const char *texture = spirv_name(c->from, pair->texture);
        const char *sampler = pair->sampler ? spirv_name(c->from, pair->sampler) : NULL;
        char name[512];
        bool alone = true;
        for (uint32_t k = 0; k < c->count; k++)
            alone &= k == i || c->pairs[k].texture != pair->texture;
        snprintf(name, sizeof name, "%s%s%s", texture ? texture : "", alone ? "" : "_",
                 alone || !sampler ? "" : sampler);
        spirv_put_name(&c->edit, pair->variable, name);
    }
}

/* Pairs that are sampled first: fetches then use one of them. */
static void find_pairs(struct combining *c)
{
    const struct spirv *from = c->from;
    for (int alone = 0; alone < 2; alone++)
        SPIRV_EACH(from, at, from->code, from->count)
        {
            const uint32_t *i = from->words + at;
            uint32_t texture = 0, sampler = 0;
            if (!alone && spirv_is(i, SpvOpSampledImage)) {
                texture = loaded_from(from, i[3], SpvOpTypeImage);
                sampler = loaded_from(from, i[4], SpvOpTypeSampler);
            } else if (alone && spirv_is(i, SpvOpLoad) && is_texture(from, i[2])) {
                texture = i[3];
            }
            if (texture && (sampler || alone))
                add_combined(c, texture, sampler);
        }
}

static void put_code(struct combining *c)
{
    const struct spirv *from = c->from;
    struct spirv_edit *edit = &c->edit;
    SPIRV_EACH(from, at, from->code, from->count)
    {
        const uint32_t *i = from->words + at;
        bool load = spirv_is(i, SpvOpLoad), sampled = spirv_is(i, SpvOpSampledImage);
        const struct combined *pair =
            sampled ? find_combined(c, loaded_from(from, i[3], SpvOpTypeImage),
                                    loaded_from(from, i[4], SpvOpTypeSampler))
            : load && is_texture(from, i[2]) ? find_combined(c, i[3], 0)
                                             : NULL;
        if (pair && sampled) {
            SPIRV_PUT(edit, &edit->code, SpvOpLoad, pair->type, i[2], pair->variable);
        } else if (pair) {
            uint32_t both = SPIRV_VALUE(edit, &edit->code, SpvOpLoad, pair->type, pair->variable);
            SPIRV_PUT(edit, &edit->code, SpvOpImage, i[1], i[2], both);
        } else if (!(load && loaded_from(from, i[2], SpvOpTypeSampler))) {
            spirv_copy(edit, &edit->code, i);
        }
    }
}

bool spirv_combine(struct spirv *module)
{
    struct combining c = {.from = module};
    size_t uses = 1;
    SPIRV_EACH(module, at, module->code, module->count)
    uses +=
        spirv_is(module->words + at, SpvOpSampledImage) || spirv_is(module->words + at, SpvOpLoad);
    c.pairs = calloc(uses, sizeof *c.pairs);
    spirv_edit_begin(&c.edit, module);
    c.edit.failed |= !c.pairs;
    if (!c.edit.failed) {
        spirv_append(&c.edit, &c.edit.annotations, module->words + module->annotations,
                     module->declarations - module->annotations);
        find_pairs(&c);
        name_pairs(&c);
        put_code(&c);
    }
    free(c.pairs);
    return spirv_edit_end(&c.edit, module);
}
