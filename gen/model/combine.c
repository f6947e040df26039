/* Textures with samplers of their own become combined ones, as OpenGL and our passes have them: one for each
 * pair that the module samples, with the texture's name; with "NAME_SAMPLER" where it has several samplers. An input
 * attachment becomes a texture that is fetched at the fragment's place, a multisampled texture one of one sample, an
 * image that a fragment shader only reads a texture. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>

#include "foreign.h"
#include "spirv_check.h"

struct combined {
    uint32_t texture, sampler; /* variables; sampler 0: fetched alone */
    uint32_t variable, type;   /* of the combined one */
    uint32_t image;            /* type; with a sampler's it says whether depths are compared */
};

struct combining {
    const struct spirv *from;
    struct spirv_edit edit;
    struct combined *pairs;
    uint32_t count;
    bool reads;     /* a fragment shader that stores in no image */
    uint32_t place; /* the variable gl_FragCoord; 0: not needed */
};

/* ---- Input attachments and samples ----------------------------------------------------------- */

static bool is_attachment(const uint32_t *image)
{
    return spirv_is(image, SpvOpTypeImage) && image[3] == SpvDimSubpassData;
}

/* Whether a type of image, or of an image with its sampler, has to become a plain texture. */
static bool is_special(const struct combining *c, const uint32_t *type)
{
    if (spirv_is(type, SpvOpTypeSampledImage))
        type = spirv_definition(c->from, type[2]);
    if (!spirv_is(type, SpvOpTypeImage) || is_attachment(type))
        return is_attachment(type);
    bool flat = type[3] == SpvDim2D || type[3] == SpvDim3D;
    return type[7] == 1 ? type[6] : c->reads && flat && !type[6];
}

static bool only_reads(const struct spirv *from)
{
    bool fragment =
        spirv_entry_point(from) && spirv_entry_point(from)[1] == SpvExecutionModelFragment;
    SPIRV_EACH(from, i, from->code, from->count)
        fragment &= !spirv_is(i, SpvOpImageWrite) && !spirv_is(i, SpvOpImageTexelPointer);
    return fragment;
}

/* The type of a texture in its place; of any other, its own. */
static uint32_t plain_type(struct combining *c, uint32_t id)
{
    const uint32_t *type = spirv_definition(c->from, id);
    if (!is_special(c, type))
        return id;
    if (spirv_is(type, SpvOpTypeSampledImage)) {
        uint32_t image = plain_type(c, type[2]);
        return SPIRV_DECLARE(&c->edit, SpvOpTypeSampledImage, 0, image);
    }
    return SPIRV_DECLARE(&c->edit, SpvOpTypeImage, 0, type[2],
                         is_attachment(type) ? SpvDim2D : type[3], 0, type[5], 0, 1,
                         SpvImageFormatUnknown);
}

/* As many numbers. */
static uint32_t vector_of(struct combining *c, char letter, uint32_t count)
{
    return spirv_declare_vector(&c->edit, spirv_declare_scalar(&c->edit, letter), count);
}

/* gl_FragCoord, which is added to the inputs if the shader has it not. */
static void add_frag_coord(struct combining *c)
{
    struct spirv_edit *edit = &c->edit;
    if (c->place || (c->place = spirv_builtin(c->from, SpvBuiltInFragCoord)))
        return;
    c->place = spirv_add_variable(edit, SpvStorageClassInput, vector_of(c, 'f', 4));
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, c->place, SpvDecorationBuiltIn,
              SpvBuiltInFragCoord);
    spirv_edit_list(edit, SpvExecutionModelFragment, &c->place, 1);
}

/* A fetch at coordinates relative to the fragment's. */
static void put_attachment(struct combining *c, const uint32_t *read)
{
    struct spirv_edit *edit = &c->edit;
    struct spirv_words *to = &edit->code;
    uint32_t ints = vector_of(c, 'i', 2), floats = vector_of(c, 'f', 2), all = vector_of(c, 'f', 4);
    uint32_t zero = SPIRV_DECLARE(edit, SpvOpConstant, vector_of(c, 'i', 1), 0);
    uint32_t place = SPIRV_VALUE(edit, to, SpvOpLoad, all, c->place);
    place = SPIRV_VALUE(edit, to, SpvOpVectorShuffle, floats, place, place, 0, 1);
    place = SPIRV_VALUE(edit, to, SpvOpConvertFToS, ints, place);
    place = SPIRV_VALUE(edit, to, SpvOpIAdd, ints, place, read[4]);
    SPIRV_PUT(edit, to, SpvOpImageFetch, read[1], read[2], read[3], place, SpvImageOperandsLodMask,
              zero);
}

/* What reads such a texture. False: another instruction. */
static bool put_special(struct combining *c, const uint32_t *i)
{
    struct spirv_edit *edit = &c->edit;
    uint32_t opcode = spirv_opcode(i), number = opcode == SpvOpImageQuerySamples;
    bool reads = opcode == SpvOpImageRead || opcode == SpvOpImageFetch ||
                 opcode == SpvOpImageQuerySize || number;
    if (!reads || !is_special(c, spirv_type(c->from, i[3])))
        return false;
    number = SPIRV_DECLARE(edit, SpvOpConstant, vector_of(c, 'i', 1), number);
    if (is_attachment(spirv_type(c->from, i[3])) && opcode == SpvOpImageRead)
        put_attachment(c, i);
    else if (opcode == SpvOpImageFetch || opcode == SpvOpImageRead)
        SPIRV_PUT(edit, &edit->code, SpvOpImageFetch, i[1], i[2], i[3], i[4],
                  SpvImageOperandsLodMask, number);
    else if (opcode == SpvOpImageQuerySize)
        SPIRV_PUT(edit, &edit->code, SpvOpImageQuerySizeLod, i[1], i[2], i[3], number);
    else
        SPIRV_PUT(edit, &edit->code, SpvOpBitcast, i[1], i[2], number);
    return true;
}

/* ---- Pairs ----------------------------------------------------------------------------------- */

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

/* Whether it is loaded from a texture that is to be combined, or to be another. */
static bool is_texture(const struct combining *c, uint32_t value)
{
    const struct spirv *from = c->from;
    const uint32_t *type = spirv_type(from, value);
    if (is_special(c, type))
        return loaded_from(from, value, spirv_opcode(type));
    return loaded_from(from, value, SpvOpTypeImage) && type[7] == 1 && type[3] != SpvDimBuffer;
}

static struct combined *find_combined(struct combining *c, uint32_t texture, uint32_t sampler)
{
    for (uint32_t i = 0; i < c->count; i++)
        if (c->pairs[i].texture == texture && (c->pairs[i].sampler == sampler || !sampler))
            return &c->pairs[i];
    return NULL;
}

/* `type`: of the texture with its sampler, or of the texture alone. */
static void add_combined(struct combining *c, uint32_t texture, uint32_t sampler, uint32_t type)
{
    struct spirv_edit *edit = &c->edit;
    if (find_combined(c, texture, sampler))
        return;
    const uint32_t *declared = spirv_definition(c->from, type);
    uint32_t image = plain_type(c, spirv_is(declared, SpvOpTypeSampledImage) ? declared[2] : type);
    type = SPIRV_DECLARE(edit, SpvOpTypeSampledImage, 0, image);
    uint32_t variable = spirv_add_variable(edit, SpvStorageClassUniformConstant, type);
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, variable, SpvDecorationDescriptorSet, 0);
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, variable, SpvDecorationBinding, c->count);
    c->pairs[c->count++] = (struct combined){texture, sampler, variable, type, image};
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
        SPIRV_EACH(from, i, from->code, from->count) {
            uint32_t texture = 0, sampler = 0;
            if (!alone && spirv_is(i, SpvOpSampledImage)) {
                texture = loaded_from(from, i[3], SpvOpTypeImage);
                sampler = loaded_from(from, i[4], SpvOpTypeSampler);
            } else if (alone && spirv_is(i, SpvOpLoad) && is_texture(c, i[2])) {
                texture = i[3];
                if (is_attachment(spirv_type(from, i[2])))
                    add_frag_coord(c);
            }
            if (texture && (sampler || alone))
                add_combined(c, texture, sampler, i[1]);
        }
}

static void put_code(struct combining *c)
{
    const struct spirv *from = c->from;
    struct spirv_edit *edit = &c->edit;
    SPIRV_EACH(from, i, from->code, from->count) {
        bool load = spirv_is(i, SpvOpLoad), sampled = spirv_is(i, SpvOpSampledImage);
        const struct combined *pair =
            sampled ? find_combined(c, loaded_from(from, i[3], SpvOpTypeImage),
                                    loaded_from(from, i[4], SpvOpTypeSampler))
            : load && is_texture(c, i[2]) ? find_combined(c, i[3], 0)
                                          : NULL;
        bool whole = pair && load && spirv_is(spirv_type(from, i[2]), SpvOpTypeSampledImage);
        if (pair && (sampled || whole)) {
            SPIRV_PUT(edit, &edit->code, SpvOpLoad, pair->type, i[2], pair->variable);
        } else if (pair) {
            uint32_t both = SPIRV_VALUE(edit, &edit->code, SpvOpLoad, pair->type, pair->variable);
            SPIRV_PUT(edit, &edit->code, SpvOpImage, pair->image, i[2], both);
        } else if (spirv_is(i, SpvOpImage)) {
            spirv_copy_with(edit, &edit->code, i, 1, plain_type(c, i[1]));
        } else if (!(load && loaded_from(from, i[2], SpvOpTypeSampler)) && !put_special(c, i)) {
            spirv_copy(edit, &edit->code, i);
        }
    }
}

bool spirv_combine(struct spirv *module)
{
    struct combining c = {.from = module};
    size_t uses = 1;
    if ((spirv_passes_textures(module) && !spirv_reread(module, SPIRV_INLINE | SPIRV_CHAINS)) ||
        !spirv_split(module) || !spirv_spread(module) || !spirv_texel_buffers(module))
        return false;
    SPIRV_EACH(module, i, module->code, module->count)
        uses += spirv_is(i, SpvOpSampledImage) || spirv_is(i, SpvOpLoad);
    c.reads = only_reads(module);
    spirv_edit_begin(&c.edit, module);
    c.pairs = spirv_edit_alloc(&c.edit, uses, sizeof *c.pairs);
    if (!c.edit.failed) {
        spirv_edit_annotations(&c.edit);
        find_pairs(&c);
        name_pairs(&c);
        put_code(&c);
    }
    return spirv_edit_end(&c.edit, module);
}
