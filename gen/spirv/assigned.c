/* --sanitize=variable: variables that are read before they have a value. Each variable of a body has a word of bits beside it,
 * one bit per scalar if these are up to 32, else one per part: set by stores, copied where a value is only copied, and passed with a
 * pointer to a function. A read whose value is used, not just copied, is reported if one of its bits is not set. A read of a whole
 * struct or array is reported if none of its bits is set.
 *
 * Outputs are variables, too: a fragment shader must write what its targets store, a vertex shader its position and clip distances.
 * Which bits its other outputs lack goes to the fragment shader, in outputs of their own: a number for each scalar, interpolated as the
 * scalar is, so that it is above 0 where a vertex counts that did not write it. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <string.h>

#include "formats.h"
#include "model/leaves.h"
#include "sanitizer.h"

struct assigned {        /* of an id */
    uint32_t bits;       /* variables and pointers to them: the word; 0: not followed */
    const char *name;    /* of a parameter that a temporary variable is passed as */
    uint32_t uses;       /* of a loaded value */
    uint32_t target;     /* the variable that it is stored to, if that is all */
    size_t user;         /* offset of the only instruction that uses it; 0: there are others */
    uint32_t word;       /* of that instruction */
    uint32_t parts;      /* mask of the components that are used */
    uint32_t file, line; /* of the first store to a variable */
    uint32_t
        flag; /* inputs, and outputs of a vertex shader: the first variable that says which bits they lack */
};

void assigned_begin(struct sanitizer *s)
{
    s->ids = spirv_edit_table(&s->edit, sizeof *s->ids);
}

enum { FIRST_FLAG = 15 }; /* the location: 128 components are what devices have */

static bool in_stage(const struct sanitizer *s, uint32_t model)
{
    const uint32_t *entry = spirv_entry_point(s->from);
    return entry && entry[1] == model;
}

/* Of a variable, or of the first member of its block; UINT32_MAX: it has none. */
static uint32_t location_of(const struct sanitizer *s, const uint32_t *variable)
{
    uint32_t own = spirv_decoration(s->from, variable[2], SpvDecorationLocation);
    uint32_t type = spirv_element_type(s->from, spirv_pointee(s->from, variable));
    return own == UINT32_MAX ? spirv_member_decoration(s->from, type, 0, SpvDecorationLocation)
                             : own;
}

/* Variables that say which bits one lacks; four bits each. */
static uint32_t flags_of(const struct sanitizer *s, const uint32_t *variable)
{
    return (spirv_scalars(s->from, spirv_pointee(s->from, variable)) + 3) / 4;
}

/* What stages hand on at a location, where all stay below those of the bits. */
static bool is_handed_on(const struct sanitizer *s, const uint32_t *variable)
{
    uint32_t component = spirv_decoration(s->from, variable[2], SpvDecorationComponent);
    bool input = in_stage(s, SpvExecutionModelFragment) && variable[3] == SpvStorageClassInput;
    bool output = in_stage(s, SpvExecutionModelVertex) && variable[3] == SpvStorageClassOutput;
    if (!(input || output) || !s->request->pass->own_vertices ||
        spirv_scalars(s->from, spirv_pointee(s->from, variable)) > 32 ||
        location_of(s, variable) == UINT32_MAX || (component != UINT32_MAX && component != 0))
        return false;
    SPIRV_EACH(s->from, i, s->from->declarations, s->from->code) {
        bool alike = spirv_is(i, SpvOpVariable) && i[3] == variable[3];
        uint32_t location = alike ? location_of(s, i) : UINT32_MAX;
        if (location != UINT32_MAX &&
            location + spirv_locations(s->from, spirv_pointee(s->from, i)) > FIRST_FLAG)
            return false;
    }
    return true;
}

static uint32_t mask_of(uint32_t first, uint32_t count)
{
    if (first > 31 || !count)
        return 0;
    return (count > 31 ? UINT32_MAX : (1u << count) - 1) << first;
}

/* Whether the code has a pointer to the member. */
static bool names_member(const struct sanitizer *s, const uint32_t *variable, uint32_t member)
{
    SPIRV_EACH(s->from, i, s->from->code, s->from->count)
        if (spirv_is(i, SpvOpAccessChain) && i[3] == variable[2] &&
            spirv_definition(s->from, i[4])[3] == member)
            return true;
    return false;
}

/* Of a vertex shader's block: the position, and distances if some are written. */
static uint32_t built_in_bits(const struct sanitizer *s, const uint32_t *variable,
                              const uint32_t *type)
{
    uint32_t mask = 0, before = 0;
    for (uint32_t m = 0; m < spirv_parts(s->from, type); m++) {
        uint32_t built_in = spirv_member_decoration(s->from, type[1], m, SpvDecorationBuiltIn);
        uint32_t count = spirv_scalars(s->from, spirv_part(type, m));
        bool distance = built_in == SpvBuiltInClipDistance || built_in == SpvBuiltInCullDistance;
        if (built_in == SpvBuiltInPosition || (distance && names_member(s, variable, m)))
            mask |= mask_of(before, count);
        before += count;
    }
    return mask;
}

/* Bits that an output must have in the end: channels of a target, depth, gl_Position. 0: it may be left. */
static uint32_t final_bits(const struct sanitizer *s, const uint32_t *variable)
{
    const struct spirv *from = s->from;
    const struct pass *pass = s->request->pass;
    const uint32_t *type = spirv_definition(from, spirv_definition(from, variable[1])[3]);
    uint32_t location = spirv_decoration(from, variable[2], SpvDecorationLocation);
    if (variable[3] != SpvStorageClassOutput)
        return 0;
    if (in_stage(s, SpvExecutionModelVertex))
        return spirv_is(type, SpvOpTypeStruct) && spirv_scalars(from, type[1]) <= 32
                   ? built_in_bits(s, variable, type)
                   : 0;
    if (!in_stage(s, SpvExecutionModelFragment))
        return 0;
    uint32_t built_in = spirv_decoration(from, variable[2], SpvDecorationBuiltIn);
    if (built_in == SpvBuiltInFragDepth || built_in == SpvBuiltInSampleMask)
        return 1;
    EACH(access, pass->accesses, pass->access_count) {
        if (access->kind & DT_WRITE_COLOR && access->attachment == (int)location &&
            access->resource && !spirv_is(type, SpvOpTypeArray))
            return ((1u << format_info(access->resource->format)->channels) - 1) & ~access->keep &
                   ((1u << spirv_scalars(from, type[1])) - 1);
    }
    return 0;
}

/* What a variable holds; NULL: it is not followed. */
static const uint32_t *pointee(const struct sanitizer *s, uint32_t variable)
{
    const struct spirv *from = s->from;
    const uint32_t *i = spirv_definition(from, variable);
    if (spirv_is(i, SpvOpFunctionParameter)
            ? !spirv_is(spirv_definition(from, i[1]), SpvOpTypePointer)
            : !spirv_is(i, SpvOpVariable))
        return NULL;
    const uint32_t *type = spirv_definition(from, i[1]);
    bool own = type[2] == SpvStorageClassFunction || type[2] == SpvStorageClassPrivate;
    bool variable_here = spirv_is(i, SpvOpVariable);
    if (variable_here && (spirv_length(i) != 4 || !(own || final_bits(s, i) || is_handed_on(s, i))))
        return NULL;
    return own || variable_here ? spirv_definition(from, type[3]) : NULL;
}

static uint32_t bits_of(struct sanitizer *s, uint32_t variable)
{
    const char *name = spirv_name(s->from, variable);
    struct assigned *of = &s->ids[variable];
    if (!of->bits && pointee(s, variable) && !(name && !strncmp(name, "diptych_", 8)))
        of->bits = sanitizer_variable(s);
    return of->bits;
}

static void use(struct sanitizer *s, size_t at, uint32_t word)
{
    const uint32_t *i = s->from->words + at;
    struct assigned *of = &s->ids[i[word]];
    of->uses++;
    of->user = of->uses == 1 ? at : 0;
    of->word = word;
    of->target =
        spirv_is(i, SpvOpStore) && word == 2 && of->uses == 1 && pointee(s, i[1]) ? i[1] : 0;
    if (spirv_is(i, SpvOpCompositeExtract)) {
        of->parts |= 1u << (i[4] & 31);
    } else if (spirv_is(i, SpvOpVectorShuffle)) {
        uint32_t first = spirv_type(s->from, i[3])[3];
        for (uint32_t k = 5; k < spirv_length(i); k++)
            if (word == 3 ? i[k] < first : i[k] >= first)
                of->parts |= 1u << ((word == 3 ? i[k] : i[k] - first) & 31);
    } else {
        of->parts = UINT32_MAX;
    }
}

void assigned_find(struct sanitizer *s, const struct spirv_function *function)
{
    uint32_t file = 0, line = 0;
    SPIRV_EACH_AT(s->from, at, function->begin, function->end) {
        const uint32_t *i = s->from->words + at;
        uint32_t result = spirv_result_word(i);
        if (spirv_is(i, SpvOpLine)) {
            file = spirv_line_file(s->from, i);
            line = i[2];
        }
        if (spirv_is(i, SpvOpStore) && file) {
            struct assigned *of = &s->ids[memory_base(s->from, i[1])];
            of->line = of->file ? of->line : line;
            of->file = of->file ? of->file : file;
        }
        for (uint32_t word = 1; word < spirv_length(i); word++)
            if (word != result && !(result == 2 && word == 1) && !spirv_is_literal(i, word) &&
                i[word] < s->from->words[3] && !spirv_is(i, SpvOpLine))
                use(s, at, word);
    }
}

/* Whether it, or a member of its block, is not interpolated. */
static bool is_flat(const struct sanitizer *s, const uint32_t *variable)
{
    uint32_t type = spirv_element_type(s->from, spirv_pointee(s->from, variable));
    bool flat = spirv_decoration(s->from, variable[2], SpvDecorationFlat) != UINT32_MAX;
    for (uint32_t m = 0; m < spirv_parts(s->from, spirv_definition(s->from, type)); m++)
        flat |= spirv_member_decoration(s->from, type, m, SpvDecorationFlat) != UINT32_MAX;
    return flat;
}

/* A variable for each four bits of one that stages hand on; the first id. */
static uint32_t flag_of(struct sanitizer *s, const uint32_t *variable)
{
    struct spirv_edit *edit = &s->edit;
    struct assigned *of = &s->ids[variable[2]];
    uint32_t count = of->flag ? 0 : flags_of(s, variable);
    uint32_t four = spirv_declare_vector(edit, spirv_declare_scalar(edit, 'f'), 4);
    uint32_t type = SPIRV_DECLARE(edit, SpvOpTypePointer, 0, variable[3], four);
    of->flag = of->flag ? of->flag : edit->bound;
    for (uint32_t k = 0; k < count; k++) {
        uint32_t id = edit->bound++;
        SPIRV_PUT(edit, &edit->declarations, SpvOpVariable, type, id, variable[3]);
        SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, id, SpvDecorationLocation,
                  location_of(s, variable) + FIRST_FLAG + k);
        if (variable[3] == SpvStorageClassInput && is_flat(s, variable))
            SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, id, SpvDecorationFlat);
        spirv_append(edit, &s->handed_on, &id, 1);
    }
    return of->flag;
}

/* An input has what its flags leave; the flags of an output say what it lacks. */
static void put_handed_on(struct sanitizer *s, const uint32_t *variable)
{
    bool input = variable[3] == SpvStorageClassInput;
    uint32_t flag = flag_of(s, variable), own = bits_of(s, variable[2]), bits = 0;
    uint32_t type = spirv_declare_vector(&s->edit, spirv_declare_scalar(&s->edit, 'f'), 4);
    for (uint32_t k = 0; k < flags_of(s, variable); k++) {
        uint32_t by = sanitizer_number(s, 4 * k);
        if (input) {
            uint32_t value = PUT_VALUE(s, SpvOpLoad, type, flag + k);
            uint32_t four = sanitizer_call(s, "diptych_taken(vf4;", &(struct values){{value}, 1});
            four = sanitizer_two(s, SpvOpShiftLeftLogical, four, by);
            bits = bits ? sanitizer_two(s, SpvOpBitwiseOr, bits, four) : four;
        } else {
            uint32_t four = sanitizer_two(s, SpvOpShiftRightLogical, sanitizer_load(s, own), by);
            PUT(s, SpvOpStore, flag + k,
                sanitizer_call(s, "diptych_given(u1;", &(struct values){{four}, 1}));
        }
    }
    if (input)
        PUT(s, SpvOpStore, own, bits);
}

/* Bits come with inputs; a call begins with no values. */
void assigned_reset(struct sanitizer *s, const struct spirv_function *function)
{
    bool entry = function->id == spirv_entry(s->from);
    SPIRV_EACH(s->from, i, entry ? s->from->declarations : s->from->code, s->from->code)
        if (spirv_is(i, SpvOpVariable) && i[3] == SpvStorageClassInput && is_handed_on(s, i) &&
            bits_of(s, i[2]))
            put_handed_on(s, i);
    SPIRV_EACH(s->from, i, function->begin, function->end)
        if (spirv_is(i, SpvOpVariable) && bits_of(s, i[2]))
            PUT(s, SpvOpStore, s->ids[i[2]].bits, sanitizer_number(s, 0));
}

/* ---- Bits ------------------------------------------------------------------------------------ */

static const uint32_t *part_type(const struct sanitizer *s, const uint32_t *type, uint32_t part)
{
    return spirv_definition(s->from, spirv_part(type, part));
}

/* Bits of a type in the word of a variable, and those before a part. whole: the variable's type. */
static uint32_t bit_count(const struct sanitizer *s, const uint32_t *whole, const uint32_t *type)
{
    if (spirv_scalars(s->from, whole[1]) <= 32)
        return spirv_scalars(s->from, type[1]);
    return type == whole && spirv_parts(s->from, type) <= 32 ? spirv_parts(s->from, type) : 1;
}

static uint32_t bits_before(const struct sanitizer *s, const uint32_t *whole, const uint32_t *type,
                            uint32_t part)
{
    uint32_t bits = 0;
    if (bit_count(s, whole, type) == 1)
        return 0;
    for (uint32_t k = 0; k < part && k < spirv_parts(s->from, type) && bits < 32; k++)
        bits += bit_count(s, whole, part_type(s, type, k));
    return bits;
}

/* What a pointer leads to: bits of a variable. */
struct bit_range {
    uint32_t variable, first, count;
    const uint32_t *type;
    uint32_t moved; /* id of a number of bits to add to `first`; 0: none */
};

static void follow_index(struct sanitizer *s, struct bit_range *range, const uint32_t *whole,
                         uint32_t index)
{
    const uint32_t *i = spirv_definition(s->from, index);
    bool deep = spirv_parts(s->from, range->type) && bit_count(s, whole, range->type) > 1;
    if (!spirv_parts(s->from, range->type))
        return;
    bool fixed = spirv_is(i, SpvOpConstant) && i[3] < spirv_parts(s->from, range->type);
    const uint32_t *part = part_type(s, range->type, fixed ? i[3] : 0);
    if (deep && fixed) {
        range->first += bits_before(s, whole, range->type, i[3]);
    } else if (deep) {
        uint32_t bits =
            sanitizer_two(s, SpvOpIMul, index, sanitizer_number(s, bit_count(s, whole, part)));
        range->moved = range->moved ? sanitizer_two(s, SpvOpIAdd, range->moved, bits) : bits;
    }
    range->count = deep ? bit_count(s, whole, part) : range->count;
    range->type = part;
}

/* Of a pointer to what is followed; type NULL: it is not. Writes the numbers of variable indices. */
static struct bit_range range_of(struct sanitizer *s, uint32_t pointer)
{
    const uint32_t *i = spirv_definition(s->from, pointer);
    if (!spirv_is(i, SpvOpAccessChain)) {
        const uint32_t *type = pointee(s, pointer);
        return (struct bit_range){pointer, 0, type ? bit_count(s, type, type) : 0, type, 0};
    }
    struct bit_range range = range_of(s, i[3]);
    for (uint32_t word = 4; range.type && word < spirv_length(i); word++)
        follow_index(s, &range, pointee(s, range.variable), i[word]);
    return range;
}

/* The id of the mask of a range. parts: of its parts that count, for values with few. */
static uint32_t put_mask(struct sanitizer *s, const struct bit_range *range, uint32_t parts)
{
    const uint32_t *whole = pointee(s, range->variable);
    uint32_t mask = 0, all = mask_of(0, bit_count(s, whole, whole));
    bool some = parts != UINT32_MAX && spirv_parts(s->from, range->type) && range->count > 1;
    for (uint32_t k = 0; some && k < spirv_parts(s->from, range->type) && k < 32; k++)
        if (parts >> k & 1)
            mask |= mask_of(bits_before(s, whole, range->type, k),
                            bit_count(s, whole, part_type(s, range->type, k)));
    mask = (some ? mask : mask_of(0, range->count)) << range->first;
    if (!range->moved)
        return sanitizer_number(s, mask & all);
    uint32_t by = sanitizer_two(s, SpvOpBitwiseAnd, range->moved, sanitizer_number(s, 31));
    uint32_t moved = sanitizer_two(s, SpvOpShiftLeftLogical, sanitizer_number(s, mask), by);
    return sanitizer_two(s, SpvOpBitwiseAnd, moved, sanitizer_number(s, all));
}

/* Sets the bits of all that the pointer points to. */
static void put_set(struct sanitizer *s, uint32_t pointer)
{
    struct bit_range range = range_of(s, pointer);
    uint32_t bits = range.type ? bits_of(s, range.variable) : 0;
    if (!bits)
        return;
    uint32_t mask = put_mask(s, &range, UINT32_MAX);
    PUT(s, SpvOpStore, bits, sanitizer_two(s, SpvOpBitwiseOr, sanitizer_load(s, bits), mask));
}

static void put_copy(struct sanitizer *s, uint32_t to, uint32_t from)
{
    uint32_t bits = sanitizer_load(s, from);
    PUT(s, SpvOpStore, to, bits);
}

/* Whether a loaded value is only copied into a variable, which is not stored to a target. */
static bool is_copied(struct sanitizer *s, const uint32_t *load)
{
    const struct assigned *value = &s->ids[load[2]];
    const uint32_t *target = spirv_definition(s->from, value->target);
    bool ends = value->target && spirv_is(target, SpvOpVariable) && final_bits(s, target);
    return value->uses == 1 && value->target && !ends && bits_of(s, value->target) &&
           !spirv_is(spirv_definition(s->from, load[3]), SpvOpAccessChain);
}

/* A variable of glslang, which passes an argument or takes it back. */
static bool is_temporary(const struct sanitizer *s, uint32_t variable)
{
    const char *name = spirv_name(s->from, variable);
    return s->ids[variable].name || (name && !strncmp(name, "param", 5));
}

static void put_assigned(struct sanitizer *s, uint32_t bits, uint32_t wanted, uint32_t site)
{
    struct values values = {{bits, wanted}, 2};
    sanitizer_place(s, &values, site);
    sanitizer_call(s, "diptych_assigned(u1;u1;u1;u1;", &values);
}

static void put_check(struct sanitizer *s, uint32_t variable, uint32_t wanted)
{
    const char *name =
        s->ids[variable].name ? s->ids[variable].name : spirv_name(s->from, variable);
    char text[160];
    name = name && *name ? name : "a variable";
    snprintf(text, sizeof text, "`%.60s` is read before it has a value", name);
    put_assigned(s, sanitizer_load(s, bits_of(s, variable)), wanted,
                 sanitizer_site(s, NULL, name, text));
}

/* The bits that must be set for a load. `any`: one of them is enough, as for a whole struct or array. */
static uint32_t put_wanted(struct sanitizer *s, const uint32_t *load, const struct bit_range *range,
                           bool any)
{
    uint32_t mask = put_mask(s, range, s->ids[load[2]].parts);
    if (!any)
        return mask;
    uint32_t own =
        sanitizer_two(s, SpvOpBitwiseAnd, sanitizer_load(s, bits_of(s, range->variable)), mask);
    uint32_t none = sanitizer_call(s, "diptych_none(u1;", &(struct values){{own}, 1});
    return sanitizer_two(s, SpvOpBitwiseAnd, none, mask);
}

/* ---- Values that a condition may leave unused ------------------------------------------------ */

/* glslang loads variables on both sides of `?:`, and right of `&&` and `||`, before it chooses. The instruction that chooses
 * whether a value counts, and the word of the value's operand there; NULL: it counts. */
static const uint32_t *guard_of(const struct sanitizer *s, uint32_t value, uint32_t *word)
{
    for (;;) {
        const struct assigned *of = &s->ids[value];
        const uint32_t *i = s->from->words + of->user;
        uint32_t opcode = spirv_opcode(i);
        if (of->uses != 1 || !of->user)
            return NULL;
        *word = of->word;
        if (spirv_is(i, SpvOpSelect))
            return of->word > 3 && spirv_is(spirv_type(s->from, i[3]), SpvOpTypeBool) ? i : NULL;
        if (spirv_is(i, SpvOpLogicalAnd) || spirv_is(i, SpvOpLogicalOr)) {
            if (of->word == 4)
                return i;
        } else if (opcode < SpvOpLogicalEqual || opcode > SpvOpFUnordGreaterThanEqual) {
            return NULL;
        }
        value = i[2];
    }
}

/* Whether a value counts, by the guards around it. */
static uint32_t put_counts(struct sanitizer *s, const uint32_t *guard, uint32_t word)
{
    uint32_t boolean = sanitizer_bool(s), counts = guard[3];
    if (spirv_is(guard, SpvOpLogicalOr) || (spirv_is(guard, SpvOpSelect) && word == 5))
        counts = PUT_VALUE(s, SpvOpLogicalNot, boolean, guard[3]);
    const uint32_t *outer = guard_of(s, guard[2], &word);
    if (!outer)
        return counts;
    uint32_t around = put_counts(s, outer, word);
    return PUT_VALUE(s, SpvOpLogicalAnd, boolean, around, counts);
}

static void put_guarded(struct sanitizer *s, const uint32_t *load, uint32_t counts)
{
    struct bit_range range = range_of(s, load[3]);
    if (!range.type || !bits_of(s, range.variable))
        return;
    uint32_t mask = put_wanted(s, load, &range, false), none = sanitizer_number(s, 0);
    put_check(s, range.variable, PUT_VALUE(s, SpvOpSelect, sanitizer_uint(s), counts, mask, none));
}

/* At a guard: the loads that it guards. */
static void put_guards(struct sanitizer *s, const uint32_t *guard, uint32_t counts, uint32_t value)
{
    const uint32_t *i = spirv_definition(s->from, value);
    uint32_t word;
    if (s->ids[value].uses != 1 || guard_of(s, value, &word) != guard)
        return;
    if (spirv_is(i, SpvOpLoad))
        put_guarded(s, i, counts);
    else if (spirv_opcode(i) >= SpvOpLogicalEqual && spirv_opcode(i) <= SpvOpFUnordGreaterThanEqual)
        for (word = 3; word < spirv_length(i); word++)
            put_guards(s, guard, counts, i[word]);
}

static void put_choice(struct sanitizer *s, const uint32_t *i)
{
    uint32_t first = 4, last = spirv_is(i, SpvOpSelect) ? 5 : 4;
    if (spirv_is(i, SpvOpSelect) && !spirv_is(spirv_type(s->from, i[3]), SpvOpTypeBool))
        return;
    for (uint32_t word = first; word <= last; word++)
        put_guards(s, i, put_counts(s, i, word), i[word]);
}

/* ---- Reads and stores ------------------------------------------------------------------------ */

/* A load that only copies is reported only if no bit is set: the copy gets the bits, and its own reads are checked. */
static void put_read(struct sanitizer *s, const uint32_t *load)
{
    uint32_t variable = memory_base(s->from, load[3]), word;
    const uint32_t *type = pointee(s, variable);
    if (!type || !bits_of(s, variable) || guard_of(s, load[2], &word))
        return;
    bool copied = is_copied(s, load);
    if (copied && (is_temporary(s, variable) || is_temporary(s, s->ids[load[2]].target)))
        return;
    struct bit_range range = range_of(s, load[3]);
    bool made = spirv_is(range.type, SpvOpTypeStruct) || spirv_is(range.type, SpvOpTypeArray);
    bool any = copied || (made && s->ids[load[2]].parts == UINT32_MAX);
    put_check(s, variable, put_wanted(s, load, &range, any));
}

static void put_stored(struct sanitizer *s, const uint32_t *store)
{
    uint32_t variable = memory_base(s->from, store[1]), bits = bits_of(s, variable);
    const uint32_t *load = spirv_definition(s->from, store[2]);
    uint32_t from = spirv_is(load, SpvOpLoad) ? memory_base(s->from, load[3]) : 0;
    if (!bits)
        return;
    bool copied = from && variable == store[1] && bits_of(s, from) && is_copied(s, load);
    if (!copied) {
        put_set(s, store[1]);
        return;
    }
    put_copy(s, bits, bits_of(s, from));
    if (!is_temporary(s, from) && !is_temporary(s, variable)) { /* it was told */
        uint32_t before = sanitizer_load(s, bits);
        uint32_t none = sanitizer_call(s, "diptych_none(u1;", &(struct values){{before}, 1});
        PUT(s, SpvOpStore, bits, sanitizer_two(s, SpvOpBitwiseOr, before, none));
    }
}

/* Bits go with pointers into a function, and come back. */
static void put_pointers(struct sanitizer *s, const uint32_t *call, bool back)
{
    for (uint32_t word = 4; word < spirv_length(call); word++) {
        if (!pointee(s, call[word]))
            continue;
        uint32_t parameter = spirv_parameter(s->from, call[3], word - 4)[2];
        uint32_t own = bits_of(s, call[word]), theirs = bits_of(s, parameter);
        if (own && theirs)
            put_copy(s, back ? own : theirs, back ? theirs : own);
        const char *name = spirv_name(s->from, call[word]);
        if (name && !strncmp(name, "param", 5))
            s->ids[call[word]].name = spirv_name(s->from, parameter);
    }
}

/* At the end of the entry point: bits of an output that nothing has written, at the first store to it. */
static void put_unwritten(struct sanitizer *s, uint32_t variable, uint32_t wanted, const char *name)
{
    const struct assigned *of = &s->ids[variable];
    char text[128];
    s->file = of->file ? of->file : s->file;
    s->line = of->file ? of->line : s->line;
    snprintf(text, sizeof text, "`%.60s` is not written", name ? name : "an output");
    uint32_t bits = sanitizer_load(s, bits_of(s, variable)), all = sanitizer_number(s, wanted);
    put_assigned(s, bits, all, sanitizer_site(s, NULL, name ? name : "", text));
}

static void put_outputs(struct sanitizer *s)
{
    enum { POSITION = 0xf };
    const struct spirv *from = s->from;
    uint32_t file = s->file, line = s->line;
    bool vertex = in_stage(s, SpvExecutionModelVertex);
    SPIRV_EACH(from, i, from->declarations, from->code) {
        uint32_t wanted = spirv_is(i, SpvOpVariable) && bits_of(s, i[2]) ? final_bits(s, i) : 0;
        bool output = spirv_is(i, SpvOpVariable) && i[3] == SpvStorageClassOutput;
        if (output && is_handed_on(s, i) && bits_of(s, i[2]))
            put_handed_on(s, i);
        if (wanted)
            put_unwritten(s, i[2], vertex ? POSITION : wanted,
                          vertex ? "gl_Position" : spirv_name(from, i[2]));
        if (vertex && wanted & ~POSITION)
            put_unwritten(s, i[2], wanted & ~POSITION, "gl_ClipDistance");
    }
    s->file = file;
    s->line = line;
}

static void put_result(struct sanitizer *s, const uint32_t *instruction)
{
    uint32_t none = sanitizer_number(s, 0), one = sanitizer_number(s, 1);
    if (spirv_is(spirv_definition(s->from, instruction[1]), SpvOpUndef))
        put_assigned(s, none, one,
                     sanitizer_site(s, "}", "", "the function ends without a `return`"));
}

void assigned_before(struct sanitizer *s, const uint32_t *instruction)
{
    s->kind = SANITIZE_VARIABLE;
    if (spirv_is(instruction, SpvOpLoad))
        put_read(s, instruction);
    else if (spirv_is(instruction, SpvOpSelect) || spirv_is(instruction, SpvOpLogicalAnd) ||
             spirv_is(instruction, SpvOpLogicalOr))
        put_choice(s, instruction);
    else if (spirv_is(instruction, SpvOpFunctionCall))
        put_pointers(s, instruction, false);
    else if (spirv_is(instruction, SpvOpReturnValue))
        put_result(s, instruction);
    else if (spirv_is(instruction, SpvOpReturn) && s->function == spirv_entry(s->from))
        put_outputs(s);
}

void assigned_after(struct sanitizer *s, const uint32_t *instruction)
{
    uint32_t pointer = memory_stored(s, instruction);
    if (spirv_is(instruction, SpvOpStore))
        put_stored(s, instruction);
    else if (pointer)
        put_set(s, pointer);
    else if (spirv_is(instruction, SpvOpFunctionCall))
        put_pointers(s, instruction, true);
}
