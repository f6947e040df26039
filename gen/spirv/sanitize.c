/* --sanitize: before each operation that may be undefined, a shader calls a check of templates/glsl/sanitize.glsl. The checks
 * change nothing but the buffer of reports, so results keep their bits. This pass runs behind glslang, before all others:
 * places are the author's, and values those of the operations that he wrote.
 *
 * Text of the generator has no place of its own: what it does is told where the author calls it. */
#include "model/leaves.h"
#include "passes.h"
#include "prove.h"
#include "sanitizer.h"

#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "panel.h" /* DT_ARRAY_COUNT */

/* ---- Types and constants --------------------------------------------------------------------- */

uint32_t sanitizer_uint(struct sanitizer *s)
{
    return spirv_declare_scalar(&s->edit, 'u');
}

uint32_t sanitizer_bool(struct sanitizer *s)
{
    return spirv_declare_scalar(&s->edit, 'b');
}

uint32_t sanitizer_number(struct sanitizer *s, uint32_t value)
{
    return SPIRV_DECLARE(&s->edit, SpvOpConstant, sanitizer_uint(s), value);
}

static uint32_t width_of(const uint32_t *type)
{
    return spirv_is(type, SpvOpTypeVector) ? type[3] : 1;
}

static bool constant_of(const struct spirv *from, uint32_t id, uint32_t *value)
{
    const uint32_t *constant = spirv_definition(from, id);
    *value = spirv_is(constant, SpvOpConstant) ? constant[3] : 0;
    return spirv_is(constant, SpvOpConstant);
}

static bool id_is_constant(const struct spirv *from, uint32_t id)
{
    return from->definitions[id] < from->code &&
           !spirv_is(spirv_definition(from, id), SpvOpVariable);
}

/* ---- Calls ----------------------------------------------------------------------------------- */

bool sanitizer_has(const struct sanitizer *s, const char *mangled)
{
    return spirv_find_function(s->from, mangled);
}

/* The result of a call; 0: there is no such function. */
uint32_t sanitizer_call(struct sanitizer *s, const char *mangled, const struct values *values)
{
    const struct spirv_function *found = spirv_find_function(s->from, mangled);
    uint32_t operands[12] = {0}, count = 3;
    if (!found)
        return 0;
    const uint32_t *function = s->from->words + found->begin;
    operands[0] = function[1];
    operands[1] = s->edit.bound++;
    operands[2] = function[2];
    for (uint32_t i = 0; i < values->count; i++)
        operands[count++] = values->ids[i];
    spirv_put(&s->edit, &s->edit.code, SpvOpFunctionCall, operands, count);
    return operands[1];
}

uint32_t sanitizer_two(struct sanitizer *s, uint32_t opcode, uint32_t a, uint32_t b)
{
    return PUT_VALUE(s, opcode, sanitizer_uint(s), a, b);
}

uint32_t sanitizer_load(struct sanitizer *s, uint32_t variable)
{
    return PUT_VALUE(s, SpvOpLoad, sanitizer_uint(s), variable);
}

static uint32_t find_variable(const struct spirv *from, const char *name)
{
    SPIRV_EACH(from, i, SPIRV_HEADER, from->annotations)
        if (spirv_is(i, SpvOpName) && !strcmp((const char *)(i + 2), name) &&
            spirv_is(spirv_definition(from, i[1]), SpvOpVariable))
            return i[1];
    return 0;
}

/* ---- Sites ----------------------------------------------------------------------------------- */

/* How many operations of the word, of one kind, the line has had. */
static uint32_t count_word(struct sanitizer *s, const char *word, uint32_t kind)
{
    uint32_t hash = 2166136261u ^ s->file * 31 ^ s->line * 16777619u ^ kind << 24;
    for (; word && *word; word++)
        hash = (hash ^ (unsigned char)*word) * 16777619u;
    for (size_t i = 0; i < s->seen.count; i += 2)
        if (s->seen.data[i] == hash)
            return ++s->seen.data[i + 1];
    spirv_append(&s->edit, &s->seen, (uint32_t[]){hash, 0}, 2);
    return 0;
}

uint32_t sanitizer_add(struct sanitizer *s, struct sanitize_site *site)
{
    uint32_t kind = *site->text == '@' ? (uint32_t)site->text[1] : 0;
    site->kind = s->kind;
    site->file = s->file;
    site->line = s->line;
    site->nth = count_word(s, *site->name ? site->name : site->word, kind);
    uint32_t index = s->request->add(s->request->user, site);
    spirv_append(&s->edit, &s->sites, &index, 1);
    return index;
}

uint32_t sanitizer_site(struct sanitizer *s, const char *word, const char *name, const char *text)
{
    struct sanitize_site site = {.word = word};
    snprintf(site.name, sizeof site.name, "%s", name);
    snprintf(site.text, sizeof site.text, "%s", text);
    return sanitizer_add(s, &site);
}

uint32_t sanitizer_caller(const struct sanitizer *s)
{
    return find_variable(s->from, "diptych_caller");
}

uint32_t sanitizer_variable(struct sanitizer *s)
{
    struct spirv_edit *edit = &s->edit;
    uint32_t type =
        SPIRV_DECLARE(edit, SpvOpTypePointer, 0, SpvStorageClassPrivate, sanitizer_uint(s));
    uint32_t zero = sanitizer_number(s, 0), id = edit->bound++;
    SPIRV_PUT(edit, &edit->declarations, SpvOpVariable, type, id, SpvStorageClassPrivate, zero);
    spirv_append(edit, &s->variables, &id, 1);
    return id;
}

bool sanitizer_is_check(const struct spirv *from, const struct spirv_function *function)
{
    const char *name = spirv_name(from, function->id);
    return name && !strncmp(name, "diptych_", 8) && strcmp(name, "diptych_begin(") != 0 &&
           strcmp(name, "diptych_end(") != 0;
}

/* The number of a kind among those that the pass allows, from 1; 0: it does not. */
static uint32_t allowed_number(const struct sanitizer *s, unsigned kind)
{
    const struct pass *pass = s->request->pass;
    for (uint32_t i = 0; i < pass->allow_count; i++)
        if (pass->allows[i].kind == kind)
            return i + 1;
    return 0;
}

/* Findings of one kind that are allowed take no room from others: see templates/glsl/sanitize.glsl. */
uint32_t sanitizer_what(struct sanitizer *s, uint32_t site)
{
    uint32_t allowed = allowed_number(s, s->kind), nth = s->sites.count;
    while (nth-- && s->sites.data[nth] != site)
        ;
    uint32_t room = allowed ? SANITIZE_FREE_ROOMS - 1 + allowed : nth % SANITIZE_FREE_ROOMS;
    return sanitizer_number(s, site * SANITIZE_ROOMS + room % SANITIZE_ROOMS);
}

/* Appends place and operation. */
void sanitizer_place(struct sanitizer *s, struct values *values, uint32_t site)
{
    uint32_t place = sanitizer_number(s, site), caller, allowed = allowed_number(s, s->kind);
    if (!s->file && (caller = sanitizer_caller(s))) {
        place = sanitizer_load(s, caller);
        if (allowed)
            place = sanitizer_two(s, SpvOpIAdd, place, sanitizer_number(s, allowed));
    }
    values->ids[values->count++] = place;
    values->ids[values->count++] = sanitizer_what(s, site);
}

/* Calls of generated functions leave their place, which has a site for each kind that the pass allows. */
static void put_caller(struct sanitizer *s, const uint32_t *call)
{
    const char *name = spirv_name(s->from, call[3]);
    uint32_t caller = sanitizer_caller(s);
    if (!name || !caller || !s->file)
        return;
    struct sanitize_site site = {.more = s->request->pass->allow_count};
    snprintf(site.name, sizeof site.name, "%.*s", (int)strcspn(name, "("), name);
    uint32_t first = sanitizer_number(s, sanitizer_add(s, &site));
    PUT(s, SpvOpStore, caller, first);
}

/* ---- Arithmetic ------------------------------------------------------------------------------ */

struct check {
    uint32_t number;      /* SpvOp or GLSLstd450 */
    const char *function; /* of sanitize.glsl */
    const char *word;     /* in the body */
    const char *text;     /* @0x: letter of the first operand's type */
    uint8_t first, count; /* operands that it takes */
    bool whole;           /* takes vectors */
};

static const struct check operations[] = {
    {SpvOpSDiv, "divide", "/", "@0x / @1x", 0, 2, false},
    {SpvOpUDiv, "divide", "/", "@0x / @1x", 0, 2, false},
    {SpvOpSMod, "modulo", "%", "@0x % @1x", 0, 2, false},
    {SpvOpUMod, "modulo", "%", "@0x % @1x", 0, 2, false},
    {SpvOpSRem, "divide", "%", "@0x % @1x", 0, 2, false},
    {SpvOpShiftLeftLogical, "shift", "<<", "a shift by @0x of 32 bits", 1, 1, false},
    {SpvOpShiftRightLogical, "shift", ">>", "a shift by @0x of 32 bits", 1, 1, false},
    {SpvOpShiftRightArithmetic, "shift", ">>", "a shift by @0x of 32 bits", 1, 1, false},
    {SpvOpBitFieldInsert, "bits", "bitfieldInsert", "@1i bits from bit @0i of 32", 2, 2, false},
    {SpvOpBitFieldSExtract, "bits", "bitfieldExtract", "@1i bits from bit @0i of 32", 1, 2, false},
    {SpvOpBitFieldUExtract, "bits", "bitfieldExtract", "@1i bits from bit @0i of 32", 1, 2, false},
    {SpvOpConvertFToS, "to_int", "int", "@0f as an int", 0, 1, false},
    {SpvOpConvertFToU, "to_uint", "uint", "@0f as a uint", 0, 1, false},
    {SpvOpFConvert, "half", "float16_t", "float16_t makes infinity of @0f", 0, 1, false},
};

static const struct check functions[] = {
    {GLSLstd450Sqrt, "sqrt", "sqrt", "sqrt(@0f)", 0, 1, false},
    {GLSLstd450InverseSqrt, "positive", "inversesqrt", "inversesqrt(@0f)", 0, 1, false},
    {GLSLstd450Log, "positive", "log", "log(@0f)", 0, 1, false},
    {GLSLstd450Log2, "positive", "log2", "log2(@0f)", 0, 1, false},
    {GLSLstd450Pow, "pow", "pow", "pow(@0f, @1f)", 0, 2, false},
    {GLSLstd450Asin, "unit", "asin", "asin(@0f)", 0, 1, false},
    {GLSLstd450Acos, "unit", "acos", "acos(@0f)", 0, 1, false},
    {GLSLstd450Acosh, "acosh", "acosh", "acosh(@0f)", 0, 1, false},
    {GLSLstd450Atanh, "atanh", "atanh", "atanh(@0f)", 0, 1, false},
    {GLSLstd450Atan2, "atan", "atan", "atan(@0f, @1f)", 0, 2, false},
    {GLSLstd450SmoothStep, "smoothstep", "smoothstep", "smoothstep from @0f to @1f", 0, 2, false},
    {GLSLstd450FClamp, "clamp", "clamp", "clamp from @0f to @1f", 1, 2, false},
    {GLSLstd450SClamp, "clamp", "clamp", "clamp from @0i to @1i", 1, 2, false},
    {GLSLstd450UClamp, "clamp", "clamp", "clamp from @0u to @1u", 1, 2, false},
    {GLSLstd450FMix, "mix", "mix", "mix of a NaN", 0, 3, false},
    {GLSLstd450PackHalf2x16, "half", "packHalf2x16", "packHalf2x16 makes infinity of @0f", 0, 1,
     false},
    {GLSLstd450PackUnorm4x8, "packed", "packUnorm4x8", "packUnorm4x8 of a NaN", 0, 1, false},
    {GLSLstd450PackSnorm4x8, "packed", "packSnorm4x8", "packSnorm4x8 of a NaN", 0, 1, false},
    {GLSLstd450PackUnorm2x16, "packed", "packUnorm2x16", "packUnorm2x16 of a NaN", 0, 1, false},
    {GLSLstd450PackSnorm2x16, "packed", "packSnorm2x16", "packSnorm2x16 of a NaN", 0, 1, false},
    {GLSLstd450FrexpStruct, "frexp", "frexp", "frexp(@0f)", 0, 1, false},
    {GLSLstd450Normalize, "normalize", "normalize", "normalize of zero", 0, 1, true},
};

/* Functions without a check of operands whose results must be finite, as those of all arithmetic. */
static const uint8_t finite_functions[] = {
    GLSLstd450Exp,         GLSLstd450Exp2,          GLSLstd450Degrees,     GLSLstd450Sinh,
    GLSLstd450Cosh,        GLSLstd450Length,        GLSLstd450Distance,    GLSLstd450Cross,
    GLSLstd450Reflect,     GLSLstd450Refract,       GLSLstd450Fma,         GLSLstd450Ldexp,
    GLSLstd450Determinant, GLSLstd450MatrixInverse, GLSLstd450FaceForward,
};

/* The check of an operation; without a function where it has none of its operands. False: it has none. */
static bool find_check(const struct sanitizer *s, const uint32_t *instruction, struct check *check)
{
    bool extended = spirv_is(instruction, SpvOpExtInst) && instruction[3] == s->glsl;
    const struct check *list = extended ? functions : operations;
    size_t count = extended ? DT_ARRAY_COUNT(functions) : DT_ARRAY_COUNT(operations);
    uint32_t number = extended ? instruction[4] : spirv_opcode(instruction);
    *check = (struct check){.word = prove_word(instruction, s->glsl)};
    for (size_t i = 0; i < count; i++)
        if (list[i].number == number) {
            const uint32_t *scalar = spirv_scalar(s->from, spirv_type(s->from, instruction[2]));
            *check = list[i];
            return extended || spirv_letter(scalar) || (number == SpvOpFConvert && scalar[2] == 16);
        }
    for (size_t i = 0; extended && i < DT_ARRAY_COUNT(finite_functions); i++)
        if (finite_functions[i] == number)
            return true;
    return spirv_is_arithmetic(instruction) && check->word;
}

static uint32_t first_operand(const uint32_t *instruction)
{
    return spirv_is(instruction, SpvOpExtInst) ? 5 : 3;
}

static uint32_t put_part(struct sanitizer *s, uint32_t id, const uint32_t *type, uint32_t part)
{
    return PUT_VALUE(s, SpvOpCompositeExtract, type[2], id, part);
}

static uint32_t put_bool(struct sanitizer *s, uint32_t opcode, uint32_t a, uint32_t b)
{
    return a ? PUT_VALUE(s, opcode, sanitizer_bool(s), a, b) : b;
}

/* The check of one component, or of whole vectors: whether it found the operation undefined. */
static uint32_t put_check(struct sanitizer *s, const struct check *check, const uint32_t *operands,
                          uint32_t component, uint32_t site)
{
    struct values values = {.count = 0};
    char mangled[96];
    snprintf(mangled, sizeof mangled, "diptych_%s(", check->function);
    for (uint32_t i = 0; i < check->count; i++) {
        uint32_t id = operands[check->first + i];
        const uint32_t *type = spirv_type(s->from, id);
        bool part = spirv_is(type, SpvOpTypeVector) && !check->whole;
        if (!spirv_mangle(s->from, type, !check->whole, mangled, sizeof mangled))
            return 0;
        values.ids[values.count++] = part ? put_part(s, id, type, component) : id;
    }
    strncat(mangled, "u1;u1;", sizeof mangled - strlen(mangled) - 1);
    sanitizer_place(s, &values, site);
    return sanitizer_call(s, mangled, &values);
}

/* The text with the letter of the operands' type. */
static void spell(const struct check *check, char letter, char *text, size_t room)
{
    snprintf(text, room, "%s", check->text);
    for (char *at = text; (at = strchr(at, '@')); at++)
        if (at[2] == 'x')
            at[2] = letter;
}

/* Bits and conversions of integers that no operand can make undefined. */
static bool is_safe(const struct sanitizer *s, const uint32_t *instruction)
{
    const struct spirv *from = s->from;
    uint32_t value;
    switch (spirv_opcode(instruction)) {
    case SpvOpUDiv:
    case SpvOpUMod:
        return constant_of(from, instruction[4], &value) && value;
    case SpvOpSDiv:
    case SpvOpSRem:
        return constant_of(from, instruction[4], &value) && value && value != UINT32_MAX;
    case SpvOpShiftLeftLogical:
    case SpvOpShiftRightLogical:
    case SpvOpShiftRightArithmetic:
        return constant_of(from, instruction[4], &value) && value < 32;
    default:
        return false;
    }
}

/* The last operand of a division, % or shift, such that no value ends the driver; 0: the operation may stay. */
static uint32_t put_safe(struct sanitizer *s, const struct check *check,
                         const uint32_t *instruction)
{
    uint32_t parts[4] = {0};
    if (!check->function || spirv_length(instruction) != 5 || is_safe(s, instruction))
        return 0;
    const uint32_t *whole = spirv_type(s->from, instruction[4]);
    uint32_t width = width_of(whole);
    for (uint32_t i = 0; i < width; i++) {
        struct values values = {.count = check->count};
        char mangled[64];
        snprintf(mangled, sizeof mangled, "diptych_safe_%s(", check->function);
        for (uint32_t k = 0; k < check->count; k++) {
            uint32_t id = instruction[3 + check->first + k];
            const uint32_t *type = spirv_type(s->from, id);
            if (!spirv_mangle(s->from, type, true, mangled, sizeof mangled))
                return 0;
            values.ids[k] = width > 1 ? put_part(s, id, type, i) : id;
        }
        parts[i] = sanitizer_call(s, mangled, &values);
        if (!parts[i])
            return 0;
    }
    return width == 1 ? parts[0]
                      : spirv_put_value(&s->edit, &s->edit.code, SpvOpCompositeConstruct, whole[1],
                                        parts, width);
}

/* Before the operation: its operands. Returns whether it is undefined; 0: it has no such check. */
static uint32_t put_operands(struct sanitizer *s, const struct check *check,
                             const uint32_t *instruction)
{
    const uint32_t *operands = instruction + first_operand(instruction);
    uint32_t bad = 0, width = 1;
    char text[96];
    if (!check->function || is_safe(s, instruction))
        return 0;
    s->kind = SANITIZE_ARITHMETIC;
    const uint32_t *type = spirv_type(s->from, operands[check->first]);
    spell(check, spirv_letter(spirv_scalar(s->from, type)), text, sizeof text);
    uint32_t site = sanitizer_site(s, check->word, "", text);
    for (uint32_t i = 0; i < check->count && !check->whole; i++) {
        uint32_t own = width_of(spirv_type(s->from, operands[check->first + i]));
        width = own > width ? own : width;
    }
    for (uint32_t i = 0; i < width; i++) {
        uint32_t found = put_check(s, check, operands, i, site);
        bad = found ? put_bool(s, SpvOpLogicalOr, bad, found) : bad;
    }
    return bad;
}

/* min, max and clamp of a NaN. */
static void put_dropped(struct sanitizer *s, const uint32_t *instruction)
{
    bool extended = spirv_is(instruction, SpvOpExtInst) && instruction[3] == s->glsl;
    const char *word = extended ? prove_word(instruction, s->glsl) : NULL;
    char text[64];
    if (!word ||
        (strcmp(word, "min") != 0 && strcmp(word, "max") != 0 && strcmp(word, "clamp") != 0))
        return;
    snprintf(text, sizeof text, "@0f goes into `%s`, which drops it", word);
    const struct check check = {.function = "dropped",
                                .word = word,
                                .text = text,
                                .count = (uint8_t)(spirv_length(instruction) - 5)};
    put_operands(s, &check, instruction);
}

/* Whether all components of a value of floats are finite; 0: it has no floats of 32 bits. */
static uint32_t put_finite(struct sanitizer *s, uint32_t id)
{
    const uint32_t *type = spirv_type(s->from, id);
    uint32_t all = 0;
    if (spirv_is(type, SpvOpTypeMatrix)) {
        const uint32_t *column = spirv_definition(s->from, type[2]);
        for (uint32_t i = 0; i < type[3] && spirv_letter(spirv_scalar(s->from, column)) == 'f';
             i++) {
            char mangled[40] = "diptych_finite(";
            struct values values = {{put_part(s, id, type, i)}, 1};
            spirv_mangle(s->from, column, false, mangled, sizeof mangled);
            all = put_bool(s, SpvOpLogicalAnd, all, sanitizer_call(s, mangled, &values));
        }
        return all;
    }
    char mangled[40] = "diptych_finite(";
    if (spirv_letter(spirv_scalar(s->from, type)) != 'f' ||
        !spirv_mangle(s->from, type, false, mangled, sizeof mangled))
        return 0;
    return sanitizer_call(s, mangled, &(struct values){{id}, 1});
}

/* Tells a result, or a column of it, that is not finite. */
static void put_made(struct sanitizer *s, uint32_t id, const uint32_t *type, uint32_t finite,
                     uint32_t site)
{
    char mangled[48] = "diptych_made(f1;b1;u1;u1;";
    if (spirv_is(type, SpvOpTypeMatrix)) {
        for (uint32_t i = 0; i < type[3]; i++)
            put_made(s, put_part(s, id, type, i), spirv_definition(s->from, type[2]), finite, site);
        return;
    }
    if (spirv_is(type, SpvOpTypeVector))
        snprintf(mangled, sizeof mangled, "diptych_made(vf%u;b1;u1;u1;", type[3]);
    struct values values = {{id, finite}, 2};
    sanitizer_place(s, &values, site);
    sanitizer_call(s, mangled, &values);
}

static bool has_floats(const struct spirv *from, const uint32_t *type)
{
    if (spirv_is(type, SpvOpTypeMatrix))
        type = spirv_definition(from, type[2]);
    return spirv_letter(spirv_scalar(from, type)) == 'f';
}

/* Behind the operation: whether it made NaN or infinity of finite numbers, `where`: "" or on its way. */
static void put_result(struct sanitizer *s, const struct check *check, const uint32_t *instruction,
                       uint32_t bad, const char *where)
{
    const uint32_t *type = spirv_definition(s->from, instruction[1]);
    uint32_t all = 0;
    char text[96];
    if (!has_floats(s->from, type))
        return;
    if (bad)
        all = PUT_VALUE(s, SpvOpLogicalNot, sanitizer_bool(s), bad);
    for (uint32_t word = first_operand(instruction); word < spirv_length(instruction); word++) {
        uint32_t finite =
            id_is_constant(s->from, instruction[word]) ? 0 : put_finite(s, instruction[word]);
        all = finite ? put_bool(s, SpvOpLogicalAnd, all, finite) : all;
    }
    if (!all) /* all operands are constants, or integers */
        all = spirv_declare(&s->edit, SpvOpConstantTrue, sanitizer_bool(s), NULL, 0);
    s->kind = SANITIZE_ARITHMETIC;
    snprintf(text, sizeof text, "`%s` of finite numbers makes @0f%s", check->word, where);
    put_made(s, instruction[2], type, all, sanitizer_site(s, check->word, "", text));
}

/* Functions whose result is finite, though what they compute it from may not be: a difference of edges, or a dot product. */
static void put_inner(struct sanitizer *s, const struct check *check, const uint32_t *instruction)
{
    const uint32_t *operands = instruction + 5;
    const uint32_t *type = spirv_definition(s->from, instruction[1]);
    bool vector = spirv_is(type, SpvOpTypeVector);
    uint32_t dot = vector ? SpvOpDot : SpvOpFMul, scalar = vector ? type[2] : type[1];
    uint32_t inner[5] = {dot | 5 << 16, scalar, 0, 0, 0};
    if (!spirv_is(instruction, SpvOpExtInst) || instruction[3] != s->glsl)
        return;
    switch (instruction[4]) {
    case GLSLstd450FaceForward:
        inner[3] = operands[2];
        inner[4] = operands[1];
        break;
    case GLSLstd450Normalize:
        inner[3] = inner[4] = vector ? operands[0] : 0; /* of a scalar, its sign */
        break;
    case GLSLstd450SmoothStep:
        inner[0] = SpvOpFSub | 5 << 16;
        inner[1] = type[1];
        inner[3] = operands[1];
        inner[4] = operands[0];
        break;
    default:
        break;
    }
    if (!inner[3] || (id_is_constant(s->from, inner[3]) && id_is_constant(s->from, inner[4])))
        return;
    inner[2] = PUT_VALUE(s, inner[0] & 0xffff, inner[1], inner[3], inner[4]);
    put_result(s, check, inner, 0, " on its way");
}

/* ---- Indices --------------------------------------------------------------------------------- */

/* The name of the variable or parameter behind a pointer, or that a value was loaded from. */
static const char *base_name(const struct spirv *from, uint32_t id)
{
    return spirv_name(from, memory_base(from, id));
}

/* glslang's variable of a constant array that is indexed has no name of the author's. */
static bool is_unnamed(const char *name)
{
    return !name || !*name || !strcmp(name, "indexable");
}

/* Returns an index that the array has. */
static uint32_t put_index(struct sanitizer *s, uint32_t index, uint32_t count, const char *name)
{
    char letter = spirv_letter(spirv_type(s->from, index)), mangled[40], text[160];
    struct values values = {{index, count}, 2};
    if (is_unnamed(name))
        snprintf(text, sizeof text, "index @0%c of an array of @1u elements", letter);
    else
        snprintf(text, sizeof text, "index @0%c of `%.60s`, which has @1u elements", letter, name);
    snprintf(mangled, sizeof mangled, "diptych_index(%c1;u1;u1;u1;", letter);
    sanitizer_place(s, &values,
                    sanitizer_site(s, is_unnamed(name) ? "[" : NULL, name ? name : "", text));
    return sanitizer_call(s, mangled, &values);
}

/* The number of elements of what the chain's word indexes; 0: it needs no check. */
static uint32_t put_count(struct sanitizer *s, const uint32_t *chain, uint32_t word,
                          const uint32_t *type)
{
    const struct spirv *from = s->from;
    uint32_t index, count = 0, constant = constant_of(from, chain[word], &index);
    if (spirv_is(type, SpvOpTypeVector) || spirv_is(type, SpvOpTypeMatrix))
        count = type[3];
    else if (spirv_is(type, SpvOpTypeArray))
        constant_of(from, type[3], &count);
    if (count)
        return constant && index < count ? 0 : sanitizer_number(s, count);
    uint32_t member;
    if (!spirv_is(type, SpvOpTypeRuntimeArray) || word != 5 ||
        !constant_of(from, chain[4], &member))
        return 0;
    return PUT_VALUE(s, SpvOpArrayLength, sanitizer_uint(s), chain[3], member);
}

/* Whether a driver need not look at an index there: in what a shader has of its own. */
static bool is_own(const struct spirv *from, uint32_t pointer)
{
    uint32_t storage = spirv_type(from, pointer)[2];
    return storage == SpvStorageClassWorkgroup || storage == SpvStorageClassFunction ||
           storage == SpvStorageClassPrivate;
}

/* What a spec calls a member: a block of one by the block's name, but the generator's, of which bodies know the member. */
static const char *name_member(const struct spirv *from, const uint32_t *chain, uint32_t type,
                               uint32_t member)
{
    const uint32_t *variable = spirv_definition(from, chain[3]);
    bool alone = spirv_length(spirv_definition(from, type)) == 3 &&
                 spirv_is(variable, SpvOpVariable) && variable[3] == SpvStorageClassUniform &&
                 spirv_pointee(from, variable) == type;
    const char *block = alone ? spirv_variable_name(from, variable) : "_block";
    size_t length = strlen(block);
    bool own = length < 6 || strcmp(block + length - 6, "_block") != 0;
    return own ? block : spirv_member_name(from, type, member);
}

/* All indices of an access chain. Whether it has written the chain, with indices that there are. */
static bool put_chain(struct sanitizer *s, const uint32_t *chain)
{
    enum { MOST_WORDS = 32 };
    const struct spirv *from = s->from;
    uint32_t words[MOST_WORDS], length = spirv_length(chain);
    bool guards = is_own(from, chain[3]) && length <= MOST_WORDS;
    memcpy(words, chain, (length < MOST_WORDS ? length : MOST_WORDS) * sizeof *words);
    const uint32_t *type = spirv_definition(from, spirv_type(from, chain[3])[3]);
    const char *name = base_name(from, chain[3]);
    for (uint32_t word = 4; word < spirv_length(chain); word++) {
        uint32_t index, member;
        if (spirv_is(type, SpvOpTypeStruct)) {
            constant_of(from, chain[word], &member);
            const char *own = name_member(from, chain, type[1], member);
            name = own ? own : name;
            type = spirv_definition(from, type[2 + member]);
            continue;
        }
        uint32_t count =
            spirv_letter(spirv_type(from, chain[word])) ? put_count(s, chain, word, type) : 0;
        (void)index;
        uint32_t safe =
            count ? put_index(s, chain[word], count, is_unnamed(name) ? NULL : name) : 0;
        if (safe && guards)
            words[word] = safe;
        type = spirv_definition(from, type[2]);
    }
    if (guards)
        spirv_copy(&s->edit, &s->edit.code, words);
    return guards;
}

/* v[i] of a vector that is no variable. */
static void put_component(struct sanitizer *s, const uint32_t *instruction, uint32_t index)
{
    const char *name = base_name(s->from, instruction[3]);
    if (id_is_constant(s->from, index))
        return;
    put_index(s, index, sanitizer_number(s, spirv_type(s->from, instruction[3])[3]),
              name && *name ? name : "a vector");
}

/* ---- Texels ---------------------------------------------------------------------------------- */

static uint32_t put_size(struct sanitizer *s, const uint32_t *type, uint32_t image, uint32_t lod,
                         uint32_t width)
{
    uint32_t number = spirv_declare_scalar(&s->edit, 'i');
    uint32_t whole = spirv_declare_vector(&s->edit, number, width);
    if (type[7] != 1 || type[6] || type[3] == SpvDimBuffer || type[3] == SpvDimRect)
        return PUT_VALUE(s, SpvOpImageQuerySize, whole, image);
    uint32_t zero = SPIRV_DECLARE(&s->edit, SpvOpConstant, number, 0);
    return PUT_VALUE(s, SpvOpImageQuerySizeLod, whole, image, lod ? lod : zero);
}

/* Of cubes: width, height and faces. */
static uint32_t put_faces(struct sanitizer *s, const uint32_t *type, uint32_t size)
{
    uint32_t whole = spirv_declare_scalar(&s->edit, 'i');
    uint32_t three = spirv_declare_vector(&s->edit, whole, 3);
    uint32_t faces = SPIRV_DECLARE(&s->edit, SpvOpConstant, whole, 6);
    if (type[5]) {
        uint32_t cubes = PUT_VALUE(s, SpvOpCompositeExtract, whole, size, 2);
        faces = PUT_VALUE(s, SpvOpIMul, whole, cubes, faces);
    }
    uint32_t width = PUT_VALUE(s, SpvOpCompositeExtract, whole, size, 0);
    uint32_t height = PUT_VALUE(s, SpvOpCompositeExtract, whole, size, 1);
    return PUT_VALUE(s, SpvOpCompositeConstruct, three, width, height, faces);
}

/* A level of detail that is fetched from. Returns one that the image has. */
static uint32_t put_mip(struct sanitizer *s, uint32_t image, uint32_t lod, const char *name)
{
    uint32_t index;
    char text[160];
    if (!lod || (constant_of(s->from, lod, &index) && !index))
        return lod;
    uint32_t mips = PUT_VALUE(s, SpvOpImageQueryLevels, sanitizer_uint(s), image);
    struct values values = {{lod, mips}, 2};
    snprintf(text, sizeof text, "mip @0i of `%.60s`, which has @1u mips", name);
    sanitizer_place(s, &values, sanitizer_site(s, NULL, name, text));
    return sanitizer_call(s, "diptych_mip(i1;u1;u1;u1;", &values);
}

static const uint8_t dimensions[] = {
    [SpvDim1D] = 1, [SpvDim2D] = 2, [SpvDim3D] = 3, [SpvDimCube] = 2, [SpvDimRect] = 2};

/* A texel of an image, which was loaded from `pointer`. Not of a buffer: those hold the scene's arrays, whose index is
 * checked. */
static void put_texel(struct sanitizer *s, const uint32_t *type, uint32_t image, uint32_t pointer,
                      uint32_t place, uint32_t lod)
{
    static const char *const texts[] = {
        "texel @0i of `%.50s`, which has @3w texels",
        "texel (@0i, @1i) of `%.50s`, which has @3w x @3h texels",
        "texel (@0i, @1i, @2i) of `%.50s`, which has @3w x @3h texels"};
    const char *base = base_name(s->from, pointer);
    char name[64], text[160], mangled[48] = "diptych_texel(i1;i1;u1;u1;";
    if (type[3] >= DT_ARRAY_COUNT(dimensions))
        return;
    bool cube = type[3] == SpvDimCube;
    uint32_t sizes = dimensions[type[3]] + type[5], width = cube ? 3 : sizes;
    if (width > 3 || width > width_of(spirv_type(s->from, place)))
        return;
    snprintf(name, sizeof name, "%s", base ? base : "an image");
    char *end = strstr(name, "_image") ? strstr(name, "_image") : strstr(name, "_texture");
    if (end && end != name)
        *end = 0;
    lod = put_mip(s, image, lod, name);
    snprintf(text, sizeof text, texts[width - 1], name);
    if (width > 1)
        snprintf(mangled, sizeof mangled, "diptych_texel(vi%u;vi%u;u1;u1;", width, width);
    uint32_t size = put_size(s, type, image, lod, sizes);
    struct values values = {{place, cube ? put_faces(s, type, size) : size}, 2};
    sanitizer_place(s, &values, sanitizer_site(s, NULL, name, text));
    sanitizer_call(s, mangled, &values);
}

static void put_image(struct sanitizer *s, const uint32_t *instruction)
{
    bool writes = spirv_is(instruction, SpvOpImageWrite);
    uint32_t image = instruction[writes ? 1 : 3], lod = 0;
    if (spirv_is(instruction, SpvOpImageFetch) && spirv_length(instruction) > 6 &&
        (instruction[5] & 3) == SpvImageOperandsLodMask)
        lod = instruction[6];
    put_texel(s, spirv_type(s->from, image), image, image, instruction[writes ? 2 : 4], lod);
}

/* imageAtomic*(). */
static void put_pointer(struct sanitizer *s, const uint32_t *instruction)
{
    uint32_t type = spirv_type(s->from, instruction[3])[3];
    uint32_t image = PUT_VALUE(s, SpvOpLoad, type, instruction[3]);
    put_texel(s, spirv_definition(s->from, type), image, instruction[3], instruction[4], 0);
}

/* ---- Loops ----------------------------------------------------------------------------------- */

/* Variables that count turns, at the head of a function. */
static void put_counters(struct sanitizer *s, const struct spirv_function *function)
{
    uint32_t label = 0;
    SPIRV_EACH(s->from, i, function->begin, function->end) {
        label = spirv_is(i, SpvOpLabel) ? i[1] : label;
        if (!spirv_is(i, SpvOpLoopMerge))
            continue;
        uint32_t type = SPIRV_DECLARE(&s->edit, SpvOpTypePointer, 0, SpvStorageClassFunction,
                                      sanitizer_uint(s));
        s->counters[label] = PUT_VALUE(s, SpvOpVariable, type, SpvStorageClassFunction);
    }
}

/* Before the branch into a loop. */
static void put_start(struct sanitizer *s, const uint32_t *branch, size_t at)
{
    uint32_t counter = s->counters[branch[1]];
    if (counter && s->from->definitions[branch[1]] > at)
        PUT(s, SpvOpStore, counter, sanitizer_number(s, 0));
}

/* In the header of a loop, before OpLoopMerge: counts a turn. Returns the condition of its end; 0: it is not looked for. */
static uint32_t put_turn(struct sanitizer *s)
{
    uint32_t counter = s->counters[s->label];
    uint32_t before = sanitizer_load(s, counter);
    uint32_t turns = sanitizer_two(s, SpvOpIAdd, before, sanitizer_number(s, 1));
    PUT(s, SpvOpStore, counter, turns);
    if (!(s->request->kinds & SANITIZE_LOOP))
        return 0;
    struct values values = {{turns}, 1};
    s->kind = SANITIZE_LOOP;
    sanitizer_place(
        s, &values,
        sanitizer_site(s, "loop", "",
                       "loops of more than 65,000 turns in one invocation: drivers end them"));
    return sanitizer_call(s, "diptych_turn(u1;u1;u1;", &values);
}

/* Ends the function, with zero. */
static void put_return(struct sanitizer *s, const struct spirv_function *function)
{
    uint32_t type = s->from->words[function->begin + 1];
    if (spirv_is(spirv_definition(s->from, type), SpvOpTypeVoid)) {
        spirv_put(&s->edit, &s->edit.code, SpvOpReturn, NULL, 0);
        return;
    }
    uint32_t zero = spirv_declare(&s->edit, SpvOpConstantNull, type, NULL, 0);
    PUT(s, SpvOpReturnValue, zero);
}

/* The header of a loop: two more blocks, one of which ends the function. The code behind the loop has no new way in,
 * since it may use values of the last turn. Returns the words up to the branch, which is written, too. */
static uint32_t put_header(struct sanitizer *s, const struct spirv_function *function,
                           const uint32_t *merge)
{
    const uint32_t *branch = merge + spirv_length(merge);
    uint32_t over = spirv_is(branch, SpvOpBranch) ? put_turn(s) : 0;
    spirv_copy(&s->edit, &s->edit.code, merge);
    if (!over)
        return 0;
    uint32_t check = s->edit.bound++, end = s->edit.bound++, next = s->edit.bound++;
    PUT(s, SpvOpBranch, check);
    PUT(s, SpvOpLabel, check);
    PUT(s, SpvOpSelectionMerge, next, SpvSelectionControlMaskNone);
    PUT(s, SpvOpBranchConditional, over, end, next);
    PUT(s, SpvOpLabel, end);
    put_return(s, function);
    PUT(s, SpvOpLabel, next);
    PUT(s, SpvOpBranch, branch[1]);
    s->ends[s->label] = next;
    return spirv_length(merge);
}

/* A block before may have got more blocks behind it. */
static void put_phi(struct sanitizer *s, const uint32_t *phi)
{
    size_t at = s->edit.code.count;
    spirv_copy(&s->edit, &s->edit.code, phi);
    for (uint32_t i = 4; i < spirv_length(phi) && s->edit.code.count > at; i += 2)
        if (s->ends[phi[i]])
            s->edit.code.data[at + i] = s->ends[phi[i]];
}

/* ---- The module ------------------------------------------------------------------------------ */

/* Whether it has written the instruction. */
static bool put_before(struct sanitizer *s, const uint32_t *instruction)
{
    if (!(s->request->kinds & SANITIZE_INDEX))
        return false;
    s->kind = SANITIZE_INDEX;
    switch (spirv_opcode(instruction)) {
    case SpvOpAccessChain:
        return put_chain(s, instruction);
    case SpvOpVectorExtractDynamic:
        put_component(s, instruction, instruction[4]);
        break;
    case SpvOpImageRead:
    case SpvOpImageFetch:
    case SpvOpImageWrite:
        put_image(s, instruction);
        break;
    case SpvOpImageTexelPointer:
        put_pointer(s, instruction);
        break;
    default:
        break;
    }
    return false;
}

/* Returns the words up to the last instruction that is written. */
static uint32_t put_instruction(struct sanitizer *s, const struct spirv_function *function,
                                size_t at)
{
    uint32_t more = 0;
    const uint32_t *i = s->from->words + at;
    bool loops = s->request->kinds & SANITIZE_LOOP, turns = loops || quads_count_turns(s);
    struct check check;
    bool checked = s->request->kinds & SANITIZE_ARITHMETIC && find_check(s, i, &check);
    uint32_t bad = checked ? put_operands(s, &check, i) : 0;
    uint32_t safe = checked ? put_safe(s, &check, i) : 0;
    if (s->request->kinds & SANITIZE_ARITHMETIC)
        put_dropped(s, i);
    bool written = put_before(s, i);
    if (s->request->kinds & SANITIZE_VARIABLE)
        assigned_before(s, i);
    race_before(s, at);
    content_before(s, i);
    quads_before(s, at);
    if (spirv_is(i, SpvOpFunctionCall))
        put_caller(s, i);
    if (spirv_is(i, SpvOpKill) || spirv_is(i, SpvOpTerminateInvocation))
        sanitizer_call(s, "diptych_flush(", &(struct values){.count = 0});
    if (turns && spirv_is(i, SpvOpBranch))
        put_start(s, i, at);
    if (turns && spirv_is(i, SpvOpLoopMerge))
        more = put_header(s, function, i);
    else if (loops && spirv_is(i, SpvOpUnreachable))
        put_return(s, function); /* behind a loop that glslang takes for one that never ends */
    else if (spirv_is(i, SpvOpPhi))
        put_phi(s, i);
    else if (safe)
        PUT(s, spirv_opcode(i), i[1], i[2], i[3], safe);
    else if (!written && !quads_discard(s, i))
        spirv_copy(&s->edit, &s->edit.code, i);
    if (checked) {
        put_result(s, &check, i, bad, "");
        put_inner(s, &check, i);
    }
    if (s->request->kinds & SANITIZE_VARIABLE)
        assigned_after(s, i);
    content_after(s, i);
    quads_after(s, i);
    return more;
}

/* One instruction of a function, and the next ones that belong to it; returns the offset of the last. */
static size_t put_checked(struct sanitizer *s, const struct spirv_function *function, size_t at)
{
    const uint32_t *i = s->from->words + at;
    bool first = spirv_is(i, SpvOpLabel) && !s->label;
    if (s->label && !s->begun && !spirv_is(i, SpvOpVariable)) {
        s->begun = true;
        if (s->request->kinds & SANITIZE_VARIABLE)
            assigned_reset(s, function);
        content_enter(s, function);
    }
    at += put_instruction(s, function, at);
    s->label = spirv_is(i, SpvOpLabel) ? i[1] : s->label;
    if (first && (s->request->kinds & SANITIZE_LOOP || quads_count_turns(s)))
        put_counters(s, function);
    return at;
}

static void put_function(struct sanitizer *s, const struct spirv_function *function)
{
    const char *name = spirv_name(s->from, function->id);
    bool check = sanitizer_is_check(s->from, function);
    s->file = s->line = s->label = 0;
    s->begun = false;
    s->function = function->id;
    if (name && (!strncmp(name, "diptych_number(", 15) || !strcmp(name, "diptych_quads(")))
        return; /* content.c and quads.c write these */
    if (!check && s->request->kinds & SANITIZE_VARIABLE)
        assigned_find(s, function);
    SPIRV_EACH_AT(s->from, at, function->begin, function->end) {
        const uint32_t *i = s->from->words + at;
        if (spirv_is(i, SpvOpLine)) {
            s->file = spirv_line_file(s->from, i);
            s->line = i[2];
        } else if (check) {
            spirv_copy(&s->edit, &s->edit.code, i);
        } else if (!spirv_is(i, SpvOpNoLine)) {
            at = put_checked(s, function, at);
        }
    }
}

/* Without lines and sources; image queries are a capability. Since SPIR-V 1.4 an entry point lists all variables. */
static void copy_front(struct sanitizer *s)
{
    const struct spirv *from = s->from;
    struct spirv_edit *edit = &s->edit;
    edit->front.count = SPIRV_HEADER;
    SPIRV_PUT(edit, &edit->front, SpvOpCapability, SpvCapabilityImageQuery);
    SPIRV_EACH(from, i, SPIRV_HEADER, from->annotations) {
        bool twice = spirv_is(i, SpvOpCapability) && i[1] == SpvCapabilityImageQuery;
        if (!twice && !spirv_is(i, SpvOpString) && !spirv_is(i, SpvOpSource) &&
            !spirv_is(i, SpvOpSourceContinued) && !spirv_is(i, SpvOpModuleProcessed))
            spirv_copy(edit, &edit->front, i);
    }
    if (from->words[1] >= 0x10400)
        spirv_edit_list(edit, UINT32_MAX, s->variables.data, s->variables.count);
    spirv_edit_list(edit, UINT32_MAX, s->handed_on.data, s->handed_on.count);
}

bool spirv_sanitize(struct spirv *module, const struct sanitize_request *request)
{
    struct sanitizer s = {.request = request, .from = module, .glsl = spirv_glsl(module)};
    spirv_edit_begin(&s.edit, module);
    s.counters = spirv_edit_table(&s.edit, sizeof *s.counters);
    s.ends = spirv_edit_table(&s.edit, sizeof *s.ends);
    assigned_begin(&s);
    content_begin(&s);
    quads_begin(&s);
    if (!s.edit.failed) {
        spirv_edit_annotations(&s.edit);
        EACH(function, module->functions, module->function_count)
            put_function(&s, function);
        content_end(&s);
        quads_end(&s);
        struct spirv_words *own = &s.edit.declarations; /* glslang puts lines between them */
        own->count = spirv_strip_lines(own->data, 0, own->count);
        copy_front(&s);
    }
    free(s.seen.data);
    free(s.sites.data);
    free(s.numbers.data);
    free(s.meetings.data);
    free(s.variables.data);
    free(s.handed_on.data);
    return spirv_edit_end(&s.edit, module);
}
