/* See members.h. */
#include "members.h"

#include <string.h>

#include "plan/plan.h"

/* ---- Words ----------------------------------------------------------------------------------- */

#define WORD(enumerator) [enumerator] = #enumerator
#define BIT(enumerator)  [__builtin_ctz(enumerator)] = #enumerator
#define WORDS(name, ...)                                                                           \
    static const char *name(unsigned i)                                                            \
    {                                                                                              \
        static const char *const words[] = {__VA_ARGS__};                                          \
        return i < DT_ARRAY_COUNT(words) ? words[i] : NULL;                                        \
    }

WORDS(access_bit, BIT(DT_READ_STORAGE), BIT(DT_WRITE_STORAGE), BIT(DT_READ_TEXTURE),
      BIT(DT_READ_UNIFORM), BIT(DT_READ_COLOR), BIT(DT_WRITE_COLOR), BIT(DT_READ_DEPTH),
      BIT(DT_WRITE_DEPTH), BIT(DT_READ_INDIRECT), BIT(DT_READ_INDEX), BIT(DT_WRITE_CLEAR))
WORDS(stage_bit, BIT(DT_STAGE_COMPUTE), BIT(DT_STAGE_VERTEX), BIT(DT_STAGE_FRAGMENT),
      BIT(DT_STAGE_COLOR), BIT(DT_STAGE_DEPTH), BIT(DT_STAGE_INDIRECT), BIT(DT_STAGE_INDEX),
      BIT(DT_STAGE_CLEAR))
WORDS(layout_word, WORD(DT_LAYOUT_NONE), WORD(DT_LAYOUT_GENERAL), WORD(DT_LAYOUT_READ),
      WORD(DT_LAYOUT_COLOR), WORD(DT_LAYOUT_DEPTH))
WORDS(wrap_word, WORD(DT_WRAP_CLAMP), WORD(DT_WRAP_REPEAT), WORD(DT_WRAP_MIRROR),
      WORD(DT_WRAP_BORDER))
WORDS(border_word, WORD(DT_BORDER_TRANSPARENT_BLACK), WORD(DT_BORDER_OPAQUE_BLACK),
      WORD(DT_BORDER_OPAQUE_WHITE))
WORDS(binding_word, WORD(DT_BIND_UNIFORM), WORD(DT_BIND_STORAGE), WORD(DT_BIND_TEXELS),
      WORD(DT_BIND_TEXTURE), WORD(DT_BIND_IMAGE))
WORDS(factor_word, WORD(DT_FACTOR_ONE), WORD(DT_FACTOR_ZERO), WORD(DT_FACTOR_SRC_COLOR),
      WORD(DT_FACTOR_ONE_MINUS_SRC_COLOR), WORD(DT_FACTOR_DST_COLOR),
      WORD(DT_FACTOR_ONE_MINUS_DST_COLOR), WORD(DT_FACTOR_SRC_ALPHA),
      WORD(DT_FACTOR_ONE_MINUS_SRC_ALPHA), WORD(DT_FACTOR_DST_ALPHA),
      WORD(DT_FACTOR_ONE_MINUS_DST_ALPHA))
WORDS(operation_word, WORD(DT_BLEND_ADD), WORD(DT_BLEND_SUBTRACT), WORD(DT_BLEND_REVERSE_SUBTRACT),
      WORD(DT_BLEND_MIN), WORD(DT_BLEND_MAX))
WORDS(compare_word, WORD(DT_COMPARE_LESS), WORD(DT_COMPARE_LESS_EQUAL), WORD(DT_COMPARE_GREATER),
      WORD(DT_COMPARE_ALWAYS))
WORDS(cull_word, WORD(DT_CULL_NONE), WORD(DT_CULL_BACK), WORD(DT_CULL_FRONT))
WORDS(topology_word, WORD(DT_TRIANGLES), WORD(DT_LINES), WORD(DT_POINTS))
WORDS(kind_word, WORD(DT_BUFFER), WORD(DT_IMAGE))
WORDS(shape_word, WORD(DT_SHAPE_2D), WORD(DT_SHAPE_3D), WORD(DT_SHAPE_CUBE),
      WORD(DT_SHAPE_CUBE_ARRAY))
WORDS(contract_word, WORD(DT_CONTRACT_EXACT), WORD(DT_CONTRACT_ULP), WORD(DT_CONTRACT_ABS),
      WORD(DT_CONTRACT_REL), WORD(DT_CONTRACT_IMAGE), WORD(DT_CONTRACT_FLIPS),
      WORD(DT_CONTRACT_RASTER), WORD(DT_CONTRACT_OF_EXACT))
WORDS(pass_word, WORD(DT_PASS_DRAW_SCENE), WORD(DT_PASS_DRAW_FULLSCREEN),
      WORD(DT_PASS_DRAW_VERTICES), WORD(DT_PASS_DISPATCH))

static const char *type_word(unsigned i)
{
    return type_info((enum dt_type)i)->enumerator;
}

static const char *format_word(unsigned i)
{
    return format_info((enum dt_format)i)->enumerator;
}

#define ROW(name, ...) "DT_LIMIT_" #name,
WORDS(limit_word, DT_DEVICE_LIMITS(ROW))
#undef ROW

/* ---- Structs --------------------------------------------------------------------------------- */

#define M(S, member, KIND, ...)                                                                    \
    {                                                                                              \
        .name = #member, .offset = offsetof(struct dt_##S, member),                                \
        .size = sizeof((struct dt_##S){0}.member), .kind = MEMBER_##KIND, __VA_ARGS__              \
    }
#define ALWAYS           .always = true
#define COUNT(S, member) .count = offsetof(struct dt_##S, member)
#define TABLE(S, is_tall, ...)                                                                     \
    const struct members S##_members = {.tag = "dt_" #S,                                           \
                                        .size = sizeof(struct dt_##S),                             \
                                        .tall = is_tall,                                           \
                                        .list = (const struct member[]){__VA_ARGS__},              \
                                        .count = sizeof((const struct member[]){__VA_ARGS__}) /    \
                                                 sizeof(struct member)}

TABLE(storage, false, M(storage, usage, MASK, .word = access_bit),
      M(storage, slot, UNSIGNED, ALWAYS), M(storage, share, SIGNED, ALWAYS),
      M(storage, block, UNSIGNED), M(storage, by_layer, FLAG), M(storage, clear, FLOATS));
TABLE(sampler, false, M(sampler, name, TEXT), M(sampler, linear, FLAG),
      M(sampler, linear_mip, FLAG), M(sampler, wrap, WORD, ALWAYS, .word = wrap_word),
      M(sampler, border, WORD, .word = border_word), M(sampler, compare, FLAG),
      M(sampler, anisotropy, FLOATS, ALWAYS));
static TABLE(binding, false, M(binding, binding, UNSIGNED, ALWAYS),
             M(binding, resource, RESOURCE, ALWAYS),
             M(binding, kind, WORD, ALWAYS, .word = binding_word), M(binding, mip, MIP),
             M(binding, one_layer, FLAG), M(binding, layer, UNSIGNED),
             M(binding, layout, WORD, .word = layout_word),
             M(binding, access, MASK, .word = access_bit), M(binding, sampler, SIGNED),
             M(binding, codes, FLAG));
static TABLE(blend, false, M(blend, src, WORD, ALWAYS, .word = factor_word),
             M(blend, dst, WORD, ALWAYS, .word = factor_word),
             M(blend, op, WORD, ALWAYS, .word = operation_word),
             M(blend, alpha_src, WORD, ALWAYS, .word = factor_word),
             M(blend, alpha_dst, WORD, ALWAYS, .word = factor_word),
             M(blend, alpha_op, WORD, ALWAYS, .word = operation_word));
static TABLE(target, false, M(target, resource, RESOURCE, ALWAYS), M(target, mip, UNSIGNED),
             M(target, one_layer, FLAG), M(target, layer, UNSIGNED), M(target, keep, UNSIGNED),
             M(target, load, FLAG), M(target, blend, POINTER, .rows = &blend_members));
TABLE(program, true,
      M(program, bindings, ROWS, .rows = &binding_members, COUNT(program, binding_count)),
      M(program, binding_count, UNSIGNED),
      M(program, colors, ROWS, .rows = &target_members, COUNT(program, color_count)),
      M(program, color_count, UNSIGNED), M(program, depth, POINTER, .rows = &target_members),
      M(program, depth_test, FLAG), M(program, depth_write, FLAG),
      M(program, compare, WORD, .word = compare_word), M(program, cull, WORD, .word = cull_word),
      M(program, layered, FLAG), M(program, clip_distances, UNSIGNED),
      M(program, attributes, UNSIGNED), M(program, topology, WORD, .word = topology_word),
      M(program, bias_constant, FLOATS), M(program, bias_slope, FLOATS));
TABLE(need, false, M(need, pass, PASS, ALWAYS), M(need, feature, TEXT));
TABLE(demand, false, M(demand, pass, PASS, ALWAYS),
      M(demand, limit, WORD, ALWAYS, .word = limit_word), M(demand, amount, UNSIGNED));
TABLE(barrier, false, M(barrier, resource, RESOURCE, ALWAYS),
      M(barrier, from_stages, MASK, .word = stage_bit), M(barrier, from, MASK, .word = access_bit),
      M(barrier, to_stages, MASK, .word = stage_bit), M(barrier, to, MASK, .word = access_bit),
      M(barrier, layout, WORD, .word = layout_word), M(barrier, discard, FLAG));
TABLE(param, false, M(param, name, TEXT), M(param, doc, TEXT),
      M(param, type, WORD, ALWAYS, .word = type_word), M(param, live, FLAG),
      M(param, offset, UNSIGNED), M(param, value, DOUBLES, ALWAYS), M(param, min, DOUBLES, ALWAYS),
      M(param, max, DOUBLES, ALWAYS), M(param, step, DOUBLES));
static TABLE(contract, false, M(contract, kind, WORD, ALWAYS, .word = contract_word),
             M(contract, tolerance, DOUBLES), M(contract, outliers, DOUBLES),
             M(contract, margin_resource, RESOURCE), M(contract, margin_field, SIGNED));
static TABLE(field, false, M(field, name, TEXT), M(field, type, WORD, ALWAYS, .word = type_word),
             M(field, offset, UNSIGNED, ALWAYS), M(field, array_count, UNSIGNED),
             M(field, array_stride, UNSIGNED));
TABLE(resource, true, M(resource, name, TEXT), M(resource, doc, TEXT),
      M(resource, kind, WORD, ALWAYS, .word = kind_word), M(resource, history, FLAG),
      M(resource, keep, FLAG), M(resource, input, FLAG), M(resource, file, TEXT),
      M(resource, contract, ROW, ALWAYS, .rows = &contract_members),
      M(resource, format, WORD, .word = format_word), M(resource, shape, WORD, .word = shape_word),
      M(resource, layered, FLAG), M(resource, mips, UNSIGNED),
      M(resource, fields, ROWS, .rows = &field_members, COUNT(resource, field_count)),
      M(resource, field_count, UNSIGNED), M(resource, stride, STRIDE),
      M(resource, controls_work, FLAG), M(resource, top, FLAG));
TABLE(pass, true, M(pass, name, TEXT), M(pass, doc, TEXT), M(pass, shader, TEXT),
      M(pass, kind, WORD, ALWAYS, .word = pass_word), M(pass, uses_scene, FLAG),
      M(pass, reads, RESOURCES, COUNT(pass, read_count)), M(pass, read_count, UNSIGNED),
      M(pass, writes, RESOURCES, COUNT(pass, write_count)), M(pass, write_count, UNSIGNED),
      M(pass, write_mips, NUMBERS, COUNT(pass, write_count)));

/* ---- Values ---------------------------------------------------------------------------------- */

static const void *pointer_in(const struct member *member, const void *row)
{
    const void *pointer;
    memcpy(&pointer, (const char *)row + member->offset, sizeof pointer);
    return pointer;
}

uint32_t member_count(const struct member *member, const void *row)
{
    uint32_t count;
    if (member->kind == MEMBER_FLOATS)
        return (uint32_t)(member->size / sizeof(float));
    if (member->kind == MEMBER_DOUBLES)
        return (uint32_t)(member->size / sizeof(double));
    if (member->kind < MEMBER_ROWS)
        return 1;
    memcpy(&count, (const char *)row + member->count, sizeof count);
    return pointer_in(member, row) ? count : 0;
}

int64_t member_integer(const struct member *member, const void *row, uint32_t index)
{
    bool list = member->kind == MEMBER_RESOURCES || member->kind == MEMBER_NUMBERS;
    size_t size = list ? sizeof(uint16_t) : member->size;
    const char *at = list ? pointer_in(member, row) : (const char *)row + member->offset;
    uint64_t value = 0; /* little-endian, as all of diptych's machines are */
    memcpy(&value, at + index * size, size);
    return member->kind == MEMBER_SIGNED ? (int16_t)value : (int64_t)value;
}
