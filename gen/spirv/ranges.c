/* See ranges.h. The range of a value is found from its instruction by one table of operations; of a local
 * variable, from all that is stored to it, also by the functions that it is passed to; of a parameter, from all calls. What the
 * table does not have may be anything. Bounds are computed in floats: rounding to nearest is monotone, so they hold for
 * the rounded results, too. A denormal counts as a zero of its sign, as everywhere in exact passes. */
#include "ranges.h"

#include <float.h>
#include <math.h>
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <string.h>

enum { UNKNOWN, SOUGHT, KNOWN };
enum { MOST_DEPTH = 256 }; /* of operations in operations */

enum { MOST_WHOLE = 1 << 24 }; /* integers below are floats */

static const struct bounds anything = {-INFINITY, INFINITY, true, true};
static const struct bounds nothing = {INFINITY, -INFINITY, false, false}; /* no value yet */

struct use {
    size_t at;
    uint32_t next; /* an earlier one; 0: none */
};

static void add_uses(struct ranges *ranges, size_t at)
{
    const uint32_t *words = ranges->from->words, *i = words + at;
    for (uint32_t word = 1; word < spirv_length(i); word++) {
        uint32_t id = i[word];
        if (spirv_is_literal(i, word) || id == spirv_result(i))
            continue;
        const uint32_t *used = spirv_definition(ranges->from, id);
        if (!spirv_is(used, SpvOpVariable) && !spirv_is(used, SpvOpAccessChain) &&
            !spirv_is(used, SpvOpFunctionParameter) && !spirv_is(used, SpvOpFunction))
            continue;
        ranges->uses[++ranges->use_count] = (struct use){at, ranges->first[id]};
        ranges->first[id] = ranges->use_count;
    }
}

void ranges_begin(struct ranges *ranges, struct spirv_edit *edit)
{
    const struct spirv *from = edit->from;
    *ranges = (struct ranges){
        .from = from,
        .known = spirv_edit_table(edit, sizeof *ranges->known),
        .state = spirv_edit_table(edit, sizeof *ranges->state),
        .first = spirv_edit_table(edit, sizeof *ranges->first),
        .uses = spirv_edit_alloc(edit, from->count - from->code + 1, sizeof *ranges->uses)};
    SPIRV_EACH_AT(from, at, from->code, edit->failed ? from->code : from->count)
        if (!spirv_is(from->words + at, SpvOpLoad))
            add_uses(ranges, at);
}

/* ---- Ranges ---------------------------------------------------------------------------------- */

static bool may_be_zero(struct bounds a)
{
    return a.low < FLT_MIN && a.high > -FLT_MIN;
}

static bool may_be_infinite(struct bounds a)
{
    return isinf(a.low) || isinf(a.high);
}

bool ranges_mix_zeros(struct bounds a, struct bounds b)
{
    return may_be_zero(a) && may_be_zero(b) && (a.minus || b.minus);
}

static struct bounds either(struct bounds a, struct bounds b)
{
    return (struct bounds){fminf(a.low, b.low), fmaxf(a.high, b.high), a.nan || b.nan,
                           a.minus || b.minus};
}

static struct bounds negated(struct bounds a)
{
    return (struct bounds){-a.high, -a.low, a.nan, may_be_zero(a)};
}

/* A bound holds if one of the two has it and is never NaN; else the other may win. */
struct bounds range_of_most(struct bounds a, struct bounds b)
{
    float low = a.nan ? b.nan ? fminf(a.low, b.low) : b.low : a.low;
    if (!a.nan && !b.nan)
        low = fmaxf(a.low, b.low);
    return (struct bounds){low, fmaxf(a.high, b.high), a.nan && b.nan,
                           low < FLT_MIN && (a.minus || b.minus)};
}

struct bounds range_of_least(struct bounds a, struct bounds b)
{
    struct bounds most = negated(range_of_most(negated(a), negated(b)));
    most.minus = may_be_zero(most) && (a.minus || b.minus);
    return most;
}

/* Whether it may be so near 0 that a sum with another such number leaves a denormal. */
static bool may_be_fine(struct bounds a)
{
    return a.low < 0x1p-100F && a.high > -0x1p-100F;
}

static struct bounds sum(struct bounds a, struct bounds b)
{
    bool opposed = (isinf(a.high) && isinf(b.low)) || (isinf(a.low) && isinf(b.high));
    float low = a.low + b.low, high = a.high + b.high;
    bool denormal = low < 0 && high > -FLT_MIN && may_be_fine(a) && may_be_fine(b);
    struct bounds sum = {low, high, a.nan || b.nan || opposed, denormal || (a.minus && b.minus)};
    return isnan(sum.low) || isnan(sum.high) ? anything : sum;
}

static struct bounds product(struct bounds a, struct bounds b)
{
    bool positive = a.low >= 0 && b.low >= 0 && !a.minus && !b.minus;
    bool lost = (may_be_zero(a) && may_be_infinite(b)) || (may_be_zero(b) && may_be_infinite(a));
    float ends[] = {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high};
    struct bounds product = {ends[0], ends[0], a.nan || b.nan || lost, !positive};
    for (int i = 0; i < 4; i++) {
        if (isnan(ends[i])) /* 0 times infinity: anything of that sign */
            return positive ? (struct bounds){0, INFINITY, true, false} : anything;
        product.low = fminf(product.low, ends[i]);
        product.high = fmaxf(product.high, ends[i]);
    }
    return product;
}

static struct bounds square(struct bounds a)
{
    float most = fmaxf(-a.low, a.high);
    return (struct bounds){0, most * most, a.nan, false};
}

static struct bounds quotient(struct bounds a, struct bounds b)
{
    bool positive = a.low >= 0 && b.low >= FLT_MIN && !a.minus;
    if (!positive)
        return anything;
    return (struct bounds){0, isinf(a.high) ? INFINITY : a.high / b.low,
                           a.nan || b.nan || (isinf(a.high) && isinf(b.high)), false};
}

static struct bounds whole(struct bounds a, float (*rounded)(float), bool floors)
{
    return (struct bounds){rounded(a.low), rounded(a.high), a.nan,
                           a.minus || (!floors && a.low < 0)};
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static struct bounds find(struct ranges *ranges, uint32_t id);
static struct bounds loaded(struct ranges *ranges, uint32_t pointer);

/* Of what one instruction stores through a pointer. */
static struct bounds stored_by(struct ranges *ranges, const uint32_t *i, uint32_t pointer)
{
    struct bounds all = nothing;
    if (spirv_is(i, SpvOpStore))
        return i[2] == pointer ? anything : range_of(ranges, i[2]);
    if (spirv_is(i, SpvOpAccessChain))
        return find(ranges, i[2]);
    if (!spirv_is(i, SpvOpFunctionCall))
        return anything;
    for (uint32_t word = 4; word < spirv_length(i); word++)
        if (i[word] == pointer)
            all = either(all, find(ranges, spirv_parameter(ranges->from, i[3], word - 4)[2]));
    return all;
}

/* Of all that is stored through a pointer and what is made of it. */
static struct bounds stored(struct ranges *ranges, uint32_t pointer)
{
    struct bounds all = nothing;
    for (uint32_t use = ranges->first[pointer]; use; use = ranges->uses[use].next)
        all = either(all, stored_by(ranges, ranges->from->words + ranges->uses[use].at, pointer));
    return all;
}

/* Of all that callers give for a parameter; of a pointer, what they point to. */
static struct bounds given(struct ranges *ranges, uint32_t parameter, bool pointer)
{
    uint32_t function, index = spirv_parameter_index(ranges->from, parameter, &function);
    struct bounds all = nothing;
    for (uint32_t use = ranges->first[function]; use; use = ranges->uses[use].next) {
        const uint32_t *i = ranges->from->words + ranges->uses[use].at;
        if (!spirv_is(i, SpvOpFunctionCall))
            return anything;
        all = either(all, pointer ? loaded(ranges, i[4 + index]) : range_of(ranges, i[4 + index]));
    }
    return all;
}

/* The variable or parameter that a pointer leads into. */
static const uint32_t *root_of(const struct spirv *from, uint32_t pointer)
{
    const uint32_t *i = spirv_definition(from, pointer);
    while (spirv_is(i, SpvOpAccessChain))
        i = spirv_definition(from, i[3]);
    return i;
}

static struct bounds loaded(struct ranges *ranges, uint32_t pointer)
{
    const struct spirv *from = ranges->from;
    const uint32_t *root = root_of(from, pointer);
    struct bounds all = anything;
    if (ranges->depth > MOST_DEPTH)
        return anything;
    ranges->depth++;
    if (spirv_is(root, SpvOpFunctionParameter))
        all = either(find(ranges, root[2]), given(ranges, root[2], true));
    else if (spirv_is(root, SpvOpVariable) && root[3] == SpvStorageClassFunction)
        all = find(ranges, root[2]);
    if (spirv_is(root, SpvOpVariable) && spirv_length(root) > 4)
        all = either(all, range_of(ranges, root[4]));
    ranges->depth--;
    return all.low > all.high ? anything : all;
}

/* Whether only this invocation changes the variable or parameter, if anything does. */
static bool is_unshared(const struct spirv *from, const uint32_t *root)
{
    if (spirv_is(root, SpvOpFunctionParameter))
        return spirv_type(from, root[2])[2] == SpvStorageClassFunction;
    if (!spirv_is(root, SpvOpVariable))
        return false;
    return root[3] == SpvStorageClassFunction || root[3] == SpvStorageClassPushConstant ||
           (root[3] == SpvStorageClassUniform &&
            spirv_decoration(from, spirv_pointee(from, root), SpvDecorationBlock) != UINT32_MAX);
}

/* Whether a function of GLSL stores a second result through a pointer. */
static bool stores_beside(const uint32_t *i)
{
    return spirv_is(i, SpvOpExtInst) && (i[4] == GLSLstd450Modf || i[4] == GLSLstd450Frexp);
}

/* Whether two loads, or equal operations on them, must give the same. */
static bool same_value(const struct spirv *from, uint32_t a, uint32_t b)
{
    const uint32_t *i = spirv_definition(from, a), *k = spirv_definition(from, b);
    if (a == b || i == k)
        return true;
    if (spirv_length(i) != spirv_length(k) || *i != *k || i[1] != k[1])
        return false;
    if (spirv_is(i, SpvOpCompositeExtract))
        return !memcmp(i + 4, k + 4, (spirv_length(i) - 4) * sizeof *i) &&
               same_value(from, i[3], k[3]);
    if (!spirv_is(i, SpvOpLoad))
        return false;
    const uint32_t *p = spirv_definition(from, i[3]), *q = spirv_definition(from, k[3]);
    bool chains = *p == *q && spirv_is(p, SpvOpAccessChain) &&
                  !memcmp(p + 3, q + 3, (spirv_length(p) - 3) * sizeof *p);
    if ((i[3] != k[3] && !chains) || !is_unshared(from, root_of(from, i[3])))
        return false;
    const uint32_t *end = i < k ? k : i;
    for (i = i < k ? i : k; i < end; i += spirv_length(i))
        if (spirv_is(i, SpvOpStore) || spirv_is(i, SpvOpCopyMemory) ||
            spirv_is(i, SpvOpFunctionCall) || spirv_is(i, SpvOpLabel) || stores_beside(i))
            return false;
    return true;
}

/* ---- The table ------------------------------------------------------------------------------- */

/* What a function of the module returns. */
static struct bounds returned(struct ranges *ranges, uint32_t function)
{
    const struct spirv *from = ranges->from;
    const struct spirv_function *own = spirv_function_of(from, function);
    struct bounds all = nothing;
    SPIRV_EACH(from, i, own->begin, own->end)
        if (spirv_is(i, SpvOpReturnValue))
            all = either(all, range_of(ranges, i[1]));
    return all;
}

/* Of all operands from the word `first` to `end`. */
static struct bounds any_of(struct ranges *ranges, const uint32_t *i, uint32_t first, uint32_t end)
{
    struct bounds all = nothing;
    for (uint32_t word = first; word < end; word++)
        all = either(all, range_of(ranges, i[word]));
    return all;
}

static struct bounds range_of_constant(const struct ranges *ranges, const uint32_t *constant)
{
    char letter = spirv_letter(spirv_definition(ranges->from, constant[1]));
    float value;
    memcpy(&value, constant + 3, sizeof value);
    if (letter != 'f')
        value = letter == 'i' ? (float)(int32_t)constant[3] : (float)constant[3];
    if (isnan(value) || (letter != 'f' && fabsf(value) >= MOST_WHOLE))
        return anything;
    return (struct bounds){value, value, false, letter == 'f' && signbit(value)};
}

/* Integers whose floats are exact; others may be anything, as unsigned ones that wrap around. */
static struct bounds whole_numbers(const struct ranges *ranges, const uint32_t *i, struct bounds a)
{
    const uint32_t *type = spirv_scalar(ranges->from, spirv_definition(ranges->from, i[1]));
    a.minus = false;
    bool wraps = spirv_letter(type) != 'i' && a.low < 0;
    return a.low > -MOST_WHOLE && a.high < MOST_WHOLE && !wraps ? a : anything;
}

static struct bounds extended(struct ranges *ranges, const uint32_t *i)
{
    struct bounds a = range_of(ranges, i[5]);
    switch (i[4]) {
    case GLSLstd450FAbs:
        return (struct bounds){may_be_zero(a) ? 0 : fminf(fabsf(a.low), fabsf(a.high)),
                               fmaxf(-a.low, a.high), a.nan, false};
    case GLSLstd450FMax:
    case GLSLstd450NMax:
        return range_of_most(a, range_of(ranges, i[6]));
    case GLSLstd450FMin:
    case GLSLstd450NMin:
        return range_of_least(a, range_of(ranges, i[6]));
    case GLSLstd450SMax:
        return whole_numbers(ranges, i, range_of_most(a, range_of(ranges, i[6])));
    case GLSLstd450SMin:
        return whole_numbers(ranges, i, range_of_least(a, range_of(ranges, i[6])));
    case GLSLstd450FClamp:
    case GLSLstd450NClamp:
        return range_of_least(range_of_most(a, range_of(ranges, i[6])), range_of(ranges, i[7]));
    case GLSLstd450Floor:
        return whole(a, floorf, true);
    case GLSLstd450Ceil:
        return whole(a, ceilf, false);
    case GLSLstd450Trunc:
        return whole(a, truncf, false);
    case GLSLstd450Round:
    case GLSLstd450RoundEven:
        return whole(a, rintf, false);
    case GLSLstd450Fract:
        return (struct bounds){0, 1, a.nan || may_be_infinite(a), false};
    case GLSLstd450Length:
    case GLSLstd450Distance:
        return (struct bounds){0, INFINITY, true, false};
    case GLSLstd450Exp:
    case GLSLstd450Exp2:
        return (struct bounds){0, INFINITY, a.nan, false};
    default:
        return anything;
    }
}

static struct bounds multiplied(struct ranges *ranges, const uint32_t *i)
{
    const uint32_t *left = spirv_definition(ranges->from, i[3]);
    struct bounds a = range_of(ranges, i[3]), b = range_of(ranges, i[4]);
    if (same_value(ranges->from, i[3], i[4]))
        return square(a);
    if (spirv_is(left, SpvOpFMul) && same_value(ranges->from, left[4], i[4])) { /* k * b * b */
        struct bounds factor = range_of(ranges, left[3]);
        if (factor.low > 0)
            return (struct bounds){0, INFINITY, factor.nan || b.nan || isinf(factor.high), false};
    }
    return product(a, b);
}

static struct bounds converted(struct bounds whole, float low, float high)
{
    return (struct bounds){fmaxf(whole.low, low), fminf(whole.high, high), false, false};
}

/* Of what an instruction gives. */
static struct bounds computed(struct ranges *ranges, const uint32_t *i)
{
    const struct spirv *from = ranges->from;
    switch (spirv_opcode(i)) {
    case SpvOpConstant:
        return range_of_constant(ranges, i);
    case SpvOpConstantComposite:
    case SpvOpCompositeConstruct:
        return any_of(ranges, i, 3, spirv_length(i));
    case SpvOpVectorShuffle:
        return any_of(ranges, i, 3, 5);
    case SpvOpSelect:
        return any_of(ranges, i, 4, 6);
    case SpvOpCompositeExtract:
    case SpvOpVectorExtractDynamic:
    case SpvOpCopyObject:
        return range_of(ranges, i[3]);
    case SpvOpLoad:
        return loaded(ranges, i[3]);
    case SpvOpFunctionCall:
        return returned(ranges, i[3]);
    case SpvOpFunctionParameter:
        return given(ranges, i[2], false);
    case SpvOpFNegate:
        return negated(range_of(ranges, i[3]));
    case SpvOpFAdd:
        return sum(range_of(ranges, i[3]), range_of(ranges, i[4]));
    case SpvOpFSub: {
        struct bounds b = negated(range_of(ranges, i[4]));
        return sum(range_of(ranges, i[3]), b);
    }
    case SpvOpFMul:
    case SpvOpVectorTimesScalar:
        return multiplied(ranges, i);
    case SpvOpDot:
        if (!same_value(from, i[3], i[4]))
            return anything;
        return (struct bounds){0, INFINITY, range_of(ranges, i[3]).nan, false};
    case SpvOpFDiv:
        return quotient(range_of(ranges, i[3]), range_of(ranges, i[4]));
    case SpvOpIAdd:
        return whole_numbers(ranges, i, sum(range_of(ranges, i[3]), range_of(ranges, i[4])));
    case SpvOpISub: {
        struct bounds b = negated(range_of(ranges, i[4]));
        return whole_numbers(ranges, i, sum(range_of(ranges, i[3]), b));
    }
    case SpvOpImageQuerySize:
    case SpvOpImageQuerySizeLod:
        return (struct bounds){0, MOST_WHOLE - 1, false, false}; /* no device has larger images */
    case SpvOpConvertSToF:
        return converted(range_of(ranges, i[3]), -2147483648.0F, 2147483648.0F);
    case SpvOpConvertUToF:
        return converted(range_of(ranges, i[3]), 0, 4294967296.0F);
    case SpvOpExtInst:
        return i[3] == spirv_glsl(from) ? extended(ranges, i) : anything;
    default:
        return anything;
    }
}

/* Of an id: a value, or what is stored through a pointer. */
static struct bounds find(struct ranges *ranges, uint32_t id)
{
    const uint32_t *i = spirv_definition(ranges->from, id);
    const uint32_t *type = spirv_definition(ranges->from, i[1]);
    bool pointer = spirv_is(type, SpvOpTypePointer);
    if (ranges->state[id] == SOUGHT || ranges->depth > MOST_DEPTH) /* a loop, or too deep */
        return anything;
    if (ranges->state[id] == UNKNOWN) {
        ranges->state[id] = SOUGHT;
        ranges->depth++;
        ranges->known[id] = pointer ? stored(ranges, id) : computed(ranges, i);
        ranges->state[id] = KNOWN;
        ranges->depth--;
    }
    return ranges->known[id];
}

struct bounds range_of(struct ranges *ranges, uint32_t id)
{
    if (!spirv_letter(spirv_scalar(ranges->from, spirv_type(ranges->from, id))))
        return anything;
    struct bounds range = find(ranges, id);
    return range.low > range.high ? anything : range;
}
