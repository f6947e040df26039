/* Texel buffers (samplerBuffer, imageBuffer, Buffer<> and RWBuffer<> of HLSL) of formats with 32 bits a channel become storage buffers of
 * the same elements, as passes have them: floats, ints or uints, or vectors of 2 or 4. Without a format a texel is a vector of 4. */
#include <spirv/unified1/spirv.h>
#include <string.h>

#include "foreign.h"
#include "leaves.h"

struct texel_buffer {
    uint32_t variable, class, scalar, element, channels;
};

struct texel_buffers {
    const struct spirv *from;
    struct spirv_edit edit;
    struct texel_buffer *list;
    uint32_t count, *known; /* by id: 1 + the buffer that a variable or a value is */
};

/* Numbers of a texel; 0: it is none of a buffer, or of another width. */
static uint32_t texel_channels(const struct spirv *from, const uint32_t *variable, uint32_t *scalar)
{
    const uint32_t *type = spirv_definition(from, spirv_pointee(from, variable));
    type = spirv_is(type, SpvOpTypeSampledImage) ? spirv_definition(from, type[2]) : type;
    if (!spirv_is(type, SpvOpTypeImage) || type[3] != SpvDimBuffer)
        return 0;
    const char *format = spirv_image_format(type[8]);
    uint32_t letters = (uint32_t)strspn(format, "rgba");
    *scalar = type[2];
    return !*format ? 4 : strncmp(format + letters, "32", 2) ? 0 : letters;
}

/* What is said of the old variable is said of the new one. */
static void copy_decorations(struct texel_buffers *t, uint32_t from, uint32_t to)
{
    SPIRV_EACH(t->from, i, t->from->annotations, t->edit.failed ? 0 : t->from->declarations)
        if (spirv_is(i, SpvOpDecorate) && i[1] == from)
            spirv_copy_with(&t->edit, &t->edit.annotations, i, 1, to);
}

static void add_buffer_of(struct texel_buffers *t, const uint32_t *variable)
{
    struct spirv_edit *edit = &t->edit;
    bool late = t->from->words[1] >= 0x10400;
    struct texel_buffer *own = &t->list[t->count];
    own->channels = texel_channels(t->from, variable, &own->scalar);
    own->class = late ? SpvStorageClassStorageBuffer : SpvStorageClassUniform;
    own->element = spirv_declare_vector(edit, own->scalar, own->channels);
    uint32_t array = edit->bound++, block = edit->bound++;
    SPIRV_PUT(edit, &edit->declarations, SpvOpTypeRuntimeArray, array, own->element);
    SPIRV_PUT(edit, &edit->declarations, SpvOpTypeStruct, block, array);
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, array, SpvDecorationArrayStride,
              4 * own->channels);
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, block,
              late ? SpvDecorationBlock : SpvDecorationBufferBlock);
    SPIRV_PUT(edit, &edit->annotations, SpvOpMemberDecorate, block, 0, SpvDecorationOffset, 0);
    const uint32_t *type = spirv_definition(t->from, spirv_pointee(t->from, variable));
    if (spirv_is(type, SpvOpTypeSampledImage) || type[7] == 1)
        SPIRV_PUT(edit, &edit->annotations, SpvOpMemberDecorate, block, 0,
                  SpvDecorationNonWritable);
    own->variable = spirv_add_variable(edit, own->class, block);
    copy_decorations(t, variable[2], own->variable);
    spirv_put_name(edit, own->variable, spirv_variable_name(t->from, variable));
    t->known[variable[2]] = ++t->count;
}

/* The id `result`: a vector with more numbers, 0 and at last 1, or the first ones. */
static void put_wide(struct texel_buffers *t, const struct texel_buffer *own, uint32_t result,
                     uint32_t value, uint32_t has, uint32_t wants)
{
    struct spirv_edit *edit = &t->edit;
    bool real = spirv_is(spirv_definition(t->from, own->scalar), SpvOpTypeFloat);
    uint32_t type = spirv_declare_vector(edit, own->scalar, wants), one = real ? 0x3f800000 : 1;
    uint32_t words[7] = {type, result, value, value, 0, 1, 2}, count = 3;
    if (has < wants) {
        for (uint32_t k = has; k < wants; k++)
            words[count++] = SPIRV_DECLARE(edit, SpvOpConstant, own->scalar, k == 3 ? one : 0);
        spirv_put(edit, &edit->code, SpvOpCompositeConstruct, words, count);
    } else if (wants == 1 && has > 1) {
        SPIRV_PUT(edit, &edit->code, SpvOpCompositeExtract, type, result, value, 0);
    } else if (has > wants) {
        spirv_put(edit, &edit->code, SpvOpVectorShuffle, words, 4 + wants);
    } else {
        SPIRV_PUT(edit, &edit->code, SpvOpCopyObject, type, result, value);
    }
}

static uint32_t put_texel_place(struct texel_buffers *t, const struct texel_buffer *own,
                                uint32_t result, uint32_t index)
{
    struct spirv_edit *edit = &t->edit;
    uint32_t zero = SPIRV_DECLARE(edit, SpvOpConstant, spirv_declare_scalar(edit, 'i'), 0);
    uint32_t type = SPIRV_DECLARE(edit, SpvOpTypePointer, 0, own->class, own->element);
    SPIRV_PUT(edit, &edit->code, SpvOpAccessChain, type, result, own->variable, zero, index);
    return result;
}

static uint32_t width_of(const uint32_t *type)
{
    return spirv_is(type, SpvOpTypeVector) ? type[3] : 1;
}

static void put_use(struct texel_buffers *t, const struct texel_buffer *own, const uint32_t *i)
{
    struct spirv_edit *edit = &t->edit;
    uint32_t place, value;
    switch (spirv_opcode(i)) {
    case SpvOpImageFetch:
    case SpvOpImageRead:
        place = put_texel_place(t, own, edit->bound++, i[4]);
        value = SPIRV_VALUE(edit, &edit->code, SpvOpLoad, own->element, place);
        put_wide(t, own, i[2], value, own->channels, width_of(spirv_definition(t->from, i[1])));
        break;
    case SpvOpImageWrite:
        place = put_texel_place(t, own, edit->bound++, i[2]);
        value = edit->bound++;
        put_wide(t, own, value, i[3], width_of(spirv_type(t->from, i[3])), own->channels);
        SPIRV_PUT(edit, &edit->code, SpvOpStore, place, value);
        break;
    case SpvOpImageTexelPointer:
        put_texel_place(t, own, i[2], i[4]);
        break;
    case SpvOpImageQuerySize:
        value = SPIRV_VALUE(edit, &edit->code, SpvOpArrayLength, spirv_declare_scalar(edit, 'u'),
                            own->variable, 0);
        SPIRV_PUT(edit, &edit->code, SpvOpBitcast, i[1], i[2], value);
        break;
    default: /* a value that is the buffer */
        break;
    }
}

bool spirv_texel_buffers(struct spirv *module)
{
    struct texel_buffers t = {.from = module};
    uint32_t most = 0, scalar;
    SPIRV_EACH(module, i, module->declarations, module->code)
        most += spirv_is(i, SpvOpVariable) && texel_channels(module, i, &scalar);
    if (!most)
        return true;
    spirv_edit_begin(&t.edit, module);
    t.list = spirv_edit_alloc(&t.edit, most, sizeof *t.list);
    t.known = spirv_edit_table(&t.edit, sizeof *t.known);
    if (!t.edit.failed)
        spirv_edit_annotations(&t.edit);
    SPIRV_EACH(module, i, module->declarations, t.edit.failed ? 0 : module->code)
        if (spirv_is(i, SpvOpVariable) && texel_channels(module, i, &scalar))
            add_buffer_of(&t, i);
    SPIRV_EACH(module, i, module->code, t.edit.failed ? 0 : module->count) {
        uint32_t word = spirv_is(i, SpvOpImageWrite) ? 1 : 3, buffer = 0;
        if (spirv_length(i) > word && !spirv_is_literal(i, word))
            buffer = t.known[i[word]];
        if (buffer && (spirv_is(i, SpvOpLoad) || spirv_is(i, SpvOpImage)))
            t.known[i[2]] = buffer;
        if (buffer)
            put_use(&t, &t.list[buffer - 1], i);
        else
            spirv_copy(&t.edit, &t.edit.code, i);
    }
    return spirv_edit_end(&t.edit, module);
}
