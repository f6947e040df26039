/* --sanitize=variable: variables that are read before they have a value. Each variable of a body has a word of bits beside it,
 * one bit per component of a vector, column of a matrix, member of a struct or element of an array, of which there are up to
 * 32: set by stores, copied where a value is only copied, and passed with a pointer to a function. A read that goes elsewhere is
 * told if a bit is missing that it uses. Parts of parts are not told apart; a store by a variable index counts for all elements,
 * and a read by one, or of a struct or array as a whole, is told where nothing was assigned. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sanitizer.h"

struct assigned {     /* of an id */
    uint32_t bits;    /* variables and pointers to them: the word; 0: not followed */
    const char *name; /* of a parameter that a temporary variable is passed as */
    uint32_t uses;    /* of a loaded value */
    uint32_t target;  /* the variable that it is stored to, if that is all */
    bool chosen;      /* it is only an operand of a choice by a condition */
    uint32_t parts;   /* mask of the components that are used */
};

bool assigned_begin(struct sanitizer *s)
{
    s->ids = calloc(s->from->words[3], sizeof *s->ids);
    return s->ids;
}

static uint32_t add_bits(struct sanitizer *s)
{
    struct spirv_edit *edit = &s->edit;
    uint32_t type = spirv_declare(edit, SpvOpTypePointer, 0,
                                  (uint32_t[]){SpvStorageClassPrivate, sanitizer_uint(s)}, 2);
    uint32_t zero = sanitizer_number(s, 0), id = edit->bound++;
    SPIRV_PUT(edit, &edit->declarations, SpvOpVariable, type, id, SpvStorageClassPrivate, zero);
    spirv_append(edit, &s->variables, &id, 1);
    return id;
}

/* What a variable holds; NULL: it is not followed. */
static const uint32_t *pointee(const struct sanitizer *s, uint32_t variable)
{
    const struct spirv *from = s->from;
    const uint32_t *i = spirv_definition(from, variable);
    bool own = spirv_is(i, SpvOpVariable) && spirv_length(i) == 4 &&
               (i[3] == SpvStorageClassFunction || i[3] == SpvStorageClassPrivate);
    if (!own && !spirv_is(i, SpvOpFunctionParameter))
        return NULL;
    const uint32_t *type = spirv_definition(from, i[1]);
    if (!spirv_is(type, SpvOpTypePointer) ||
        (type[2] != SpvStorageClassFunction && type[2] != SpvStorageClassPrivate))
        return NULL;
    return spirv_definition(from, type[3]);
}

static uint32_t bits_of(struct sanitizer *s, uint32_t variable)
{
    const char *name = spirv_name(s->from, variable);
    struct assigned *of = &s->ids[variable];
    if (!of->bits && pointee(s, variable) && !(name && !strncmp(name, "diptych_", 8)))
        of->bits = add_bits(s);
    return of->bits;
}

static void use(struct sanitizer *s, const uint32_t *i, uint32_t word)
{
    struct assigned *of = &s->ids[i[word]];
    of->uses++;
    of->chosen = of->uses == 1 && spirv_is(i, SpvOpSelect) && word > 3 &&
                 spirv_is(spirv_type(s->from, i[3]), SpvOpTypeBool);
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
    SPIRV_EACH(s->from, at, function->begin, function->end)
    {
        const uint32_t *i = s->from->words + at;
        uint32_t result = spirv_result_word(i);
        for (uint32_t word = 1; word < spirv_length(i); word++)
            if (word != result && !(result == 2 && word == 1) && !spirv_is_literal(i, word) &&
                i[word] < s->from->words[3] && !spirv_is(i, SpvOpLine))
                use(s, i, word);
    }
}

/* A call begins with no values. */
void assigned_reset(struct sanitizer *s, const struct spirv_function *function)
{
    SPIRV_EACH(s->from, at, function->begin, function->end)
    {
        const uint32_t *i = s->from->words + at;
        if (spirv_is(i, SpvOpVariable) && bits_of(s, i[2]))
            SPIRV_PUT(&s->edit, &s->edit.code, SpvOpStore, s->ids[i[2]].bits,
                      sanitizer_number(s, 0));
    }
}

/* How many parts of a variable have a bit of their own. */
static uint32_t part_count(const struct sanitizer *s, const uint32_t *type)
{
    uint32_t count = 1;
    if (spirv_is(type, SpvOpTypeVector) || spirv_is(type, SpvOpTypeMatrix))
        count = type[3];
    else if (spirv_is(type, SpvOpTypeStruct))
        count = spirv_length(type) - 2;
    else if (spirv_is(type, SpvOpTypeArray) &&
             spirv_is(spirv_definition(s->from, type[3]), SpvOpConstant))
        count = spirv_definition(s->from, type[3])[3];
    return count > 32 ? 1 : count;
}

static uint32_t all_parts(const struct sanitizer *s, const uint32_t *type)
{
    return UINT32_MAX >> (32 - part_count(s, type));
}

/* The variable behind an access chain, and the bit of a constant part; all bits for others, 0 for an array's element by a
 * variable index. */
static uint32_t variable_of(const struct sanitizer *s, uint32_t pointer, uint32_t *parts)
{
    const struct spirv *from = s->from;
    const uint32_t *i = spirv_definition(from, pointer);
    *parts = UINT32_MAX;
    while (spirv_is(i, SpvOpAccessChain)) {
        const uint32_t *index = spirv_definition(from, i[4]), *type = pointee(s, i[3]);
        bool constant = spirv_is(index, SpvOpConstant), several = type && part_count(s, type) > 1;
        *parts = several && constant                         ? 1u << (index[3] & 31)
                 : several && spirv_is(type, SpvOpTypeArray) ? 0
                                                             : UINT32_MAX;
        pointer = i[3];
        i = spirv_definition(from, pointer);
    }
    return pointer;
}

static uint32_t put_load(struct sanitizer *s, uint32_t bits)
{
    uint32_t result = s->edit.bound++;
    SPIRV_PUT(&s->edit, &s->edit.code, SpvOpLoad, sanitizer_uint(s), result, bits);
    return result;
}

static void put_set(struct sanitizer *s, uint32_t bits, uint32_t parts)
{
    uint32_t before = put_load(s, bits), after = s->edit.bound++;
    SPIRV_PUT(&s->edit, &s->edit.code, SpvOpBitwiseOr, sanitizer_uint(s), after, before,
              sanitizer_number(s, parts));
    SPIRV_PUT(&s->edit, &s->edit.code, SpvOpStore, bits, after);
}

static void put_copy(struct sanitizer *s, uint32_t to, uint32_t from)
{
    uint32_t bits = put_load(s, from);
    SPIRV_PUT(&s->edit, &s->edit.code, SpvOpStore, to, bits);
}

/* Whether a loaded value is only copied into a variable. */
static bool is_copied(struct sanitizer *s, const uint32_t *load)
{
    const struct assigned *value = &s->ids[load[2]];
    return value->uses == 1 && value->target && bits_of(s, value->target) &&
           !spirv_is(spirv_definition(s->from, load[3]), SpvOpAccessChain);
}

/* A variable of glslang, which passes an argument or takes it back. */
static bool is_temporary(const struct sanitizer *s, uint32_t variable)
{
    const char *name = spirv_name(s->from, variable);
    return s->ids[variable].name || (name && !strncmp(name, "param", 5));
}

static void put_check(struct sanitizer *s, uint32_t variable, uint32_t wanted)
{
    const char *name =
        s->ids[variable].name ? s->ids[variable].name : spirv_name(s->from, variable);
    char text[160];
    name = name && *name ? name : "a variable";
    snprintf(text, sizeof text, "`%.60s` is read before it has a value", name);
    struct values values = {{put_load(s, bits_of(s, variable)), wanted}, 2};
    sanitizer_place(s, &values, sanitizer_site(s, NULL, name, text));
    sanitizer_call(s, "diptych_assigned(u1;u1;u1;u1;", &values);
}

/* Parts that a load needs; 0: any. */
static uint32_t parts_of(const struct sanitizer *s, const uint32_t *load, uint32_t *variable)
{
    uint32_t parts;
    *variable = variable_of(s, load[3], &parts);
    const uint32_t *type = pointee(s, *variable);
    if (!type)
        return 0;
    bool whole = *variable == load[3],
         made = spirv_is(type, SpvOpTypeStruct) || spirv_is(type, SpvOpTypeArray);
    if (whole && part_count(s, type) > 1)
        parts = s->ids[load[2]].parts;
    if (whole && made && parts == UINT32_MAX)
        return 0;
    return parts & all_parts(s, type);
}

/* Told where nothing has a value at all. */
static void put_none(struct sanitizer *s, uint32_t variable)
{
    struct values values = {{put_load(s, bits_of(s, variable))}, 1};
    put_check(s, variable, sanitizer_call(s, "diptych_none(u1;", &values));
}

/* Of a copy, a part that is missing is told where it is read. */
static void put_read(struct sanitizer *s, const uint32_t *load)
{
    uint32_t variable, parts = parts_of(s, load, &variable);
    if (!bits_of(s, variable) || s->ids[load[2]].chosen)
        return;
    bool copied = is_copied(s, load);
    if (!copied && parts)
        put_check(s, variable, sanitizer_number(s, parts));
    else if (!copied || (!is_temporary(s, variable) && !is_temporary(s, s->ids[load[2]].target)))
        put_none(s, variable);
}

/* `c ? a : b` of variables is a choice among values that are both loaded. */
static void put_choice(struct sanitizer *s, const uint32_t *choice)
{
    for (uint32_t word = 4; word < 6; word++) {
        const uint32_t *load = spirv_definition(s->from, choice[word]);
        uint32_t variable, wanted = s->edit.bound++;
        if (!s->ids[choice[word]].chosen || !spirv_is(load, SpvOpLoad))
            continue;
        uint32_t parts = sanitizer_number(s, parts_of(s, load, &variable));
        uint32_t none = sanitizer_number(s, 0);
        if (!bits_of(s, variable))
            continue;
        SPIRV_PUT(&s->edit, &s->edit.code, SpvOpSelect, sanitizer_uint(s), wanted, choice[3],
                  word == 4 ? parts : none, word == 4 ? none : parts);
        put_check(s, variable, wanted);
    }
}

static void put_stored(struct sanitizer *s, const uint32_t *store)
{
    uint32_t parts, variable = variable_of(s, store[1], &parts);
    uint32_t bits = bits_of(s, variable), all;
    const uint32_t *load = spirv_definition(s->from, store[2]);
    uint32_t from = spirv_is(load, SpvOpLoad) ? variable_of(s, load[3], &all) : 0;
    if (!bits)
        return;
    bool copied = from && variable == store[1] && bits_of(s, from) && is_copied(s, load);
    if (copied)
        put_copy(s, bits, bits_of(s, from));
    if (copied && !is_temporary(s, from) && !is_temporary(s, variable)) { /* it was told */
        uint32_t before = put_load(s, bits), none, after = s->edit.bound++;
        none = sanitizer_call(s, "diptych_none(u1;", &(struct values){{before}, 1});
        SPIRV_PUT(&s->edit, &s->edit.code, SpvOpBitwiseOr, sanitizer_uint(s), after, before, none);
        SPIRV_PUT(&s->edit, &s->edit.code, SpvOpStore, bits, after);
    }
    if (!copied)
        put_set(s, bits, (parts ? parts : UINT32_MAX) & all_parts(s, pointee(s, variable)));
}

static const uint32_t *parameter_of(const struct sanitizer *s, uint32_t function, uint32_t index)
{
    const uint32_t *i = spirv_definition(s->from, function);
    do
        i += spirv_length(i);
    while (spirv_is(i, SpvOpLine) || (spirv_is(i, SpvOpFunctionParameter) && index--));
    return i;
}

/* Bits go with pointers into a function, and come back. */
static void put_pointers(struct sanitizer *s, const uint32_t *call, bool back)
{
    for (uint32_t word = 4; word < spirv_length(call); word++) {
        if (!pointee(s, call[word]))
            continue;
        uint32_t parameter = parameter_of(s, call[3], word - 4)[2];
        uint32_t own = bits_of(s, call[word]), theirs = bits_of(s, parameter);
        if (own && theirs)
            put_copy(s, back ? own : theirs, back ? theirs : own);
        const char *name = spirv_name(s->from, call[word]);
        if (name && !strncmp(name, "param", 5))
            s->ids[call[word]].name = spirv_name(s->from, parameter);
    }
}

static void put_result(struct sanitizer *s, const uint32_t *instruction)
{
    struct values values = {{sanitizer_number(s, 0), sanitizer_number(s, 1)}, 2};
    if (!spirv_is(spirv_definition(s->from, instruction[1]), SpvOpUndef))
        return;
    sanitizer_place(s, &values, sanitizer_site(s, "}", "", "the function ends without a `return`"));
    sanitizer_call(s, "diptych_assigned(u1;u1;u1;u1;", &values);
}

void assigned_before(struct sanitizer *s, const uint32_t *instruction)
{
    s->kind = SANITIZE_VARIABLE;
    if (spirv_is(instruction, SpvOpLoad))
        put_read(s, instruction);
    else if (spirv_is(instruction, SpvOpSelect))
        put_choice(s, instruction);
    else if (spirv_is(instruction, SpvOpFunctionCall))
        put_pointers(s, instruction, false);
    else if (spirv_is(instruction, SpvOpReturnValue))
        put_result(s, instruction);
}

void assigned_after(struct sanitizer *s, const uint32_t *instruction)
{
    if (spirv_is(instruction, SpvOpStore))
        put_stored(s, instruction);
    else if (spirv_is(instruction, SpvOpFunctionCall))
        put_pointers(s, instruction, true);
}
