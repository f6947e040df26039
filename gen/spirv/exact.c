/* Exact arithmetic. GLSL and Vulkan round + - * correctly, and comparisons, conversions and integer
 * operations are exact; every other operation may err by some units in the last place. This pass
 * replaces each open operation by a call of a function of templates/glsl/exact.glsl, which is made of
 * the former alone in a fixed order; the function joins the module (link.h). What is left gets
 * NoContraction, so no driver fuses or reorders it, and loses RelaxedPrecision, so none computes it
 * with fewer bits.
 *
 * A function is found by the name and types of the operands, as glslang mangles them:
 * "exact_pow(f1;f1;". If the library has none for vectors, the one for numbers is called component by
 * component. Double precision is left alone: prove.c names it. */
#include "exact.h"

#include <float.h>
#include <math.h>
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "link.h"
#include "prove.h"
#include "ranges.h"
#include "panel.h" /* DT_ARRAY_COUNT */

/* What the library calls the operations of SPIR-V, behind "exact_". Functions have the names of GLSL. */
static const struct {
    SpvOp operation;
    const char *name;
} operations[] = {
    {SpvOpConvertFToU, "to_uint"},
    {SpvOpConvertFToS, "to_int"},
    {SpvOpConvertUToF, "from_uint"},
    {SpvOpFDiv, "divide"},
    {SpvOpFMod, "mod"},
    {SpvOpVectorTimesMatrix, "product"},
    {SpvOpMatrixTimesVector, "product"},
    {SpvOpMatrixTimesMatrix, "product"},
    {SpvOpDot, "dot"},
    {SpvOpIsNan, "isnan"},
    {SpvOpIsInf, "isinf"},
    {SpvOpFOrdNotEqual, "differ"}, /* which GLSL has no word for */
};

struct exact {
    const struct spirv *from;
    struct spirv_edit edit;
    struct spirv_link link;
    struct ranges ranges;
    uint32_t glsl;        /* id of GLSL.std.450 */
    const uint32_t *line; /* the last OpLine; NULL: none */
    tell_form_fn *tell;
    void *user;
};

/* ---- Look-ups -------------------------------------------------------------------------------- */

/* The name of the replacement; NULL: the instruction stays. *first: word of its first operand. */
static const char *replacement_of(const struct exact *exact, const uint32_t *instruction,
                                  uint32_t *first)
{
    bool extended = spirv_is(instruction, SpvOpExtInst) && instruction[3] == exact->glsl;
    *first = extended ? 5 : 3;
    if (extended)
        return prove_word(instruction, exact->glsl);
    for (size_t i = 0; i < DT_ARRAY_COUNT(operations); i++)
        if (spirv_is(instruction, operations[i].operation))
            return operations[i].name;
    return NULL;
}

/* The library's function for an instruction with operands from the word `first`; scalar: that for
 * their components. 0: none. */
static uint32_t find_replacement(struct exact *exact, const uint32_t *instruction, const char *name,
                                 uint32_t first, bool scalar)
{
    char mangled[96];
    snprintf(mangled, sizeof mangled, "exact_%s(", name);
    for (uint32_t word = first; word < spirv_length(instruction); word++)
        if (!spirv_mangle(exact->from, spirv_type(exact->from, instruction[word]), scalar, mangled,
                          sizeof mangled))
            return 0;
    return spirv_link_function(&exact->link, mangled);
}

/* ---- Constants ------------------------------------------------------------------------------- */

/* The one number of a constant, or of all components of a constant vector. */
static bool constant_bits(const struct exact *exact, uint32_t id, uint32_t *bits)
{
    const uint32_t *constant = spirv_definition(exact->from, id);
    if (spirv_is(constant, SpvOpConstant) && spirv_length(constant) == 4) {
        *bits = constant[3];
        return true;
    }
    bool composite =
        spirv_is(constant, SpvOpConstantComposite) || spirv_is(constant, SpvOpCompositeConstruct);
    bool equal = composite && constant_bits(exact, constant[3], bits);
    for (uint32_t word = 4; equal && word < spirv_length(constant); word++)
        equal = constant[word] == constant[3];
    return equal;
}

/* Whether it is a constant without NaN and -0, and if so said, without 0. */
static bool is_plain(const struct exact *exact, uint32_t id, bool zero)
{
    const uint32_t *constant = spirv_definition(exact->from, id);
    bool plain =
        spirv_is(constant, SpvOpConstantComposite) || spirv_is(constant, SpvOpCompositeConstruct);
    if (spirv_is(constant, SpvOpConstant))
        return constant[3] != 0x80000000u && (constant[3] & 0x7fffffffu) <= 0x7f800000u &&
               (zero || constant[3]);
    for (uint32_t word = 3; plain && word < spirv_length(constant); word++)
        plain = is_plain(exact, constant[word], zero);
    return plain;
}

static const uint32_t *number_type(const struct exact *exact, uint32_t type)
{
    return spirv_scalar(exact->from, spirv_definition(exact->from, type));
}

/* ---- Zeros that a shader writes -------------------------------------------------------------- */

/* The id of a component of a constant vector, or of a constant number itself. 0: it is none. */
static uint32_t component_of(struct exact *exact, uint32_t id, uint32_t component)
{
    const uint32_t *constant = spirv_definition(exact->from, id);
    if (spirv_letter(number_type(exact, constant[1])) != 'f')
        return 0;
    if (spirv_is(constant, SpvOpConstantNull))
        return spirv_declare_numbers(&exact->edit, number_type(exact, constant[1])[1], 0);
    return spirv_is(constant, SpvOpConstantComposite) ? constant[3 + component]
           : spirv_is(constant, SpvOpConstant)        ? id
                                                      : 0;
}

static bool is_zero_constant(const struct exact *exact, uint32_t id)
{
    uint32_t bits = 1;
    return spirv_is(spirv_definition(exact->from, id), SpvOpConstantNull) ||
           (constant_bits(exact, id, &bits) && !(bits << 1));
}

/* Whether a driver that takes x for x + 0, -x for 0 - x and 0 for x * 0 is wrong. */
static bool is_folded_wrong(struct exact *exact, const uint32_t *i, uint32_t word)
{
    bool sum = spirv_is(i, SpvOpFAdd), difference = spirv_is(i, SpvOpFSub) && word == 3;
    if (!sum && !difference && !spirv_is(i, SpvOpFMul) && !spirv_is(i, SpvOpVectorTimesScalar) &&
        !spirv_is(i, SpvOpDot))
        return false;
    struct bounds x = range_of(&exact->ranges, i[word == 3 ? 4 : 3]);
    return sum          ? x.minus
           : difference ? x.nan || (x.low <= 0 && x.high >= 0)
                        : x.nan || x.minus || x.low < 0 || !(x.high <= FLT_MAX);
}

/* The operand, with zeros that no driver knows. */
static uint32_t hide_zeros(struct exact *exact, uint32_t operand)
{
    struct spirv_edit *edit = &exact->edit;
    uint32_t type = spirv_definition(exact->from, operand)[1], parts[6] = {type};
    const uint32_t *declared = spirv_definition(exact->from, type);
    uint32_t count = spirv_is(declared, SpvOpTypeVector) ? declared[3] : 1;
    uint32_t unknown = spirv_link_function(&exact->link, "unknown(f1;");
    for (uint32_t i = 0; i < count; i++) {
        uint32_t part = component_of(exact, operand, i);
        parts[2 + i] = is_zero_constant(exact, part)
                           ? SPIRV_VALUE(edit, &edit->code, SpvOpFunctionCall,
                                         count > 1 ? declared[2] : type, unknown, part)
                           : part;
    }
    if (count == 1)
        return parts[2];
    parts[1] = edit->bound++;
    spirv_put(edit, &edit->code, SpvOpCompositeConstruct, parts, 2 + count);
    return parts[1];
}

static bool has_zeros(struct exact *exact, uint32_t operand)
{
    const uint32_t *type = spirv_type(exact->from, operand);
    uint32_t count = spirv_is(type, SpvOpTypeVector) ? type[3] : 1;
    bool found = false;
    for (uint32_t i = 0; i < count && component_of(exact, operand, i); i++)
        found |= is_zero_constant(exact, component_of(exact, operand, i));
    return found;
}

/* The instruction with such zeros in `own`; as it is, if none is written, or none is folded wrong. */
static const uint32_t *without_zeros(struct exact *exact, const uint32_t *i, uint32_t own[5])
{
    bool changed = false;
    for (uint32_t word = 3; spirv_length(i) == 5 && word < 5; word++) {
        if (!is_folded_wrong(exact, i, word) || !has_zeros(exact, i[word]))
            continue;
        if (!changed)
            memcpy(own, i, 5 * sizeof *own);
        own[word] = hide_zeros(exact, i[word]);
        changed = true;
    }
    return changed ? own : i;
}

/* ---- Instructions ---------------------------------------------------------------------------- */

static void mark(struct exact *exact, uint32_t id)
{
    SPIRV_PUT(&exact->edit, &exact->edit.annotations, SpvOpDecorate, id,
              SpvDecorationNoContraction);
}

/* Whether it is the share of mix(), written as 0 or 1: one of the two products is of a zero then. */
static bool is_end_of_mix(const struct exact *exact, const uint32_t *i, uint32_t word)
{
    uint32_t bits;
    return spirv_is(i, SpvOpExtInst) && i[3] == exact->glsl && i[4] == GLSLstd450FMix &&
           word == 7 && constant_bits(exact, i[word], &bits) &&
           (!(bits << 1) || bits == 0x3f800000u);
}

/* Calls `function` with the operands from the word `first`, or with their components `component`. */
static uint32_t put_call(struct exact *exact, const uint32_t *instruction, uint32_t first,
                         uint32_t function, uint32_t type, uint32_t result, int component)
{
    struct spirv_edit *edit = &exact->edit;
    uint32_t operands[8] = {type, result, function}, count = 3;
    for (uint32_t word = first; word < spirv_length(instruction); word++) {
        const uint32_t *declared = spirv_type(exact->from, instruction[word]);
        uint32_t operand = instruction[word];
        if (component >= 0 && spirv_is(declared, SpvOpTypeVector)) {
            operand = SPIRV_VALUE(edit, &edit->code, SpvOpCompositeExtract, declared[2],
                                  instruction[word], (uint32_t)component);
        }
        if (spirv_is(instruction, SpvOpDot) && is_folded_wrong(exact, instruction, word) &&
            has_zeros(exact, operand))
            operand = hide_zeros(exact, operand);
        else if (is_end_of_mix(exact, instruction, word))
            operand = SPIRV_VALUE(edit, &edit->code, SpvOpFunctionCall,
                                  number_type(exact, instruction[1])[1],
                                  spirv_link_function(&exact->link, "unknown(f1;"), operand);
        operands[count++] = operand;
    }
    spirv_put(edit, &edit->code, SpvOpFunctionCall, operands, count);
    return result;
}

/* Replaces an operation of vectors by calls for their components. */
static void put_components(struct exact *exact, const uint32_t *instruction, uint32_t first,
                           uint32_t function, const uint32_t *type)
{
    struct spirv_edit *edit = &exact->edit;
    uint32_t parts[6] = {instruction[1], instruction[2]};
    for (uint32_t i = 0; i < type[3]; i++)
        parts[2 + i] =
            put_call(exact, instruction, first, function, type[2], edit->bound++, (int)i);
    spirv_put(edit, &edit->code, SpvOpCompositeConstruct, parts, 2 + type[3]);
}

/* Division by a power of two whose reciprocal is a normal number becomes a product. */
static bool put_product(struct exact *exact, const uint32_t *division)
{
    uint32_t bits, exponent;
    if (!spirv_is(division, SpvOpFDiv) || !constant_bits(exact, division[4], &bits))
        return false;
    exponent = bits >> 23 & 0xff;
    if (bits & 0x7fffff || exponent < 1 || exponent > 253)
        return false;
    if (spirv_letter(number_type(exact, division[1])) != 'f')
        return false;
    uint32_t factor = spirv_declare_numbers(&exact->edit, division[1],
                                            (bits & 0x80000000u) | (254 - exponent) << 23);
    SPIRV_PUT(&exact->edit, &exact->edit.code, SpvOpFMul, division[1], division[2], division[3],
              factor);
    mark(exact, division[2]);
    return true;
}

/* Whether it is a division by a constant that exact_divide_constant takes. */
static bool has_short_divisor(const struct exact *exact, const uint32_t *division)
{
    uint32_t bits;
    return spirv_is(division, SpvOpFDiv) && constant_bits(exact, division[4], &bits) &&
           !(bits & 0xfff) && (bits >> 23 & 0xff) >= 127 && (bits >> 23 & 0xff) < 255;
}

/* The end of a function that has no `return` there: glslang returns a value that nothing sets; it is zero here. */
static bool put_end(struct exact *exact, const uint32_t *end)
{
    struct spirv_edit *edit = &exact->edit;
    const uint32_t *value =
        spirv_is(end, SpvOpReturnValue) ? spirv_definition(exact->from, end[1]) : NULL;
    if (!value || !spirv_is(value, SpvOpUndef))
        return false;
    uint32_t zero = spirv_declare(edit, SpvOpConstantNull, value[1], NULL, 0);
    SPIRV_PUT(edit, &edit->code, SpvOpReturnValue, zero);
    return true;
}

/* What the entry point leaves unwritten is zero: drivers differ, and public shaders forget alpha. */
static void put_outputs(struct exact *exact)
{
    const uint32_t *entry = spirv_entry_point(exact->from);
    for (uint32_t word = spirv_entry_variables(entry); word < spirv_length(entry); word++) {
        const uint32_t *variable = spirv_definition(exact->from, entry[word]);
        uint32_t type = spirv_pointee(exact->from, variable);
        if (variable[3] != SpvStorageClassOutput || spirv_length(variable) > 4 ||
            spirv_is(spirv_definition(exact->from, type), SpvOpTypeStruct) ||
            spirv_decoration(exact->from, variable[2], SpvDecorationBuiltIn) != UINT32_MAX)
            continue;
        SPIRV_PUT(&exact->edit, &exact->edit.code, SpvOpStore, variable[2],
                  spirv_declare(&exact->edit, SpvOpConstantNull, type, NULL, 0));
    }
}

static bool is_shift(const uint32_t *instruction)
{
    return spirv_is(instruction, SpvOpShiftRightLogical) ||
           spirv_is(instruction, SpvOpShiftRightArithmetic) ||
           spirv_is(instruction, SpvOpShiftLeftLogical);
}

/* Shifts take the low bits of their count, five for 32 bits; GLSL leaves the others' effect open. */
static bool put_shift(struct exact *exact, const uint32_t *shift)
{
    uint32_t bits;
    if (!is_shift(shift))
        return false;
    uint32_t type = spirv_definition(exact->from, shift[4])[1];
    uint32_t width = number_type(exact, shift[1])[2];
    if ((constant_bits(exact, shift[4], &bits) && bits < width) ||
        !spirv_letter(number_type(exact, type)))
        return false;
    struct spirv_edit *edit = &exact->edit;
    uint32_t mask = spirv_declare_numbers(edit, type, width - 1), count = edit->bound++;
    SPIRV_PUT(edit, &edit->code, SpvOpBitwiseAnd, type, count, shift[4], mask);
    SPIRV_PUT(edit, &edit->code, spirv_opcode(shift), shift[1], shift[2], shift[3], count);
    return true;
}

/* Whether a product of matrix and scalar is what glslang makes of `matrix / s`: matrix * (1.0 / s),
 * which rounds twice, with a division that is not the author's (glslang.h). It is written as an
 * instruction with the operands matrix and s. */
static bool is_quotient(const struct exact *exact, const uint32_t *product, uint32_t quotient[5])
{
    uint32_t one;
    if (!spirv_is(product, SpvOpMatrixTimesScalar))
        return false;
    const uint32_t *inverse = spirv_definition(exact->from, product[4]);
    if (!spirv_is(inverse, SpvOpFDiv) || !constant_bits(exact, inverse[3], &one) ||
        one != 0x3f800000 ||
        spirv_decoration(exact->from, inverse[2], SpvDecorationRelaxedPrecision) != UINT32_MAX)
        return false;
    memcpy(quotient, product, 4 * sizeof *quotient);
    quotient[4] = inverse[4];
    return true;
}

/* max(x, 0.0) and the like have a form for constants, which come last there. `own`: room for the instruction. */
static void take_constant_form(const struct exact *exact, const char **name,
                               const uint32_t **instruction, uint32_t own[7])
{
    static const char *const forms[][2] = {{"max", "max_constant"}, {"clamp", "clamp_constant"}};
    const uint32_t *i = *instruction;
    uint32_t form = 0, last = spirv_length(i) - 1;
    while (form < DT_ARRAY_COUNT(forms) && strcmp(*name, forms[form][0]) != 0)
        form++;
    if (form == DT_ARRAY_COUNT(forms))
        return;
    if (last == 6 && !is_plain(exact, i[6], true)) {
        memcpy(own, i, 7 * sizeof *own);
        own[5] = i[6];
        own[6] = i[5];
        i = own;
    }
    if (is_plain(exact, i[6], true) && is_plain(exact, i[last], form == 0)) {
        *instruction = i;
        *name = forms[form][1];
    }
}

/* ---- Short forms, where ranges.c proves that they have the same bits ------------------------- */

/* A number wins in NMin and NMax; a constant comes last, which spares CPU drivers a test for NaN. */
static uint32_t put_extreme(struct exact *exact, const uint32_t *i, bool most, uint32_t result,
                            uint32_t x, uint32_t y)
{
    bool first = spirv_definition(exact->from, x) < exact->from->words + exact->from->code;
    SPIRV_PUT(&exact->edit, &exact->edit.code, SpvOpExtInst, i[1], result, exact->glsl,
              most ? GLSLstd450NMax : GLSLstd450NMin, first ? y : x, first ? x : y);
    mark(exact, result);
    return result;
}

static bool put_extremes(struct exact *exact, const uint32_t *i)
{
    if (!spirv_is(i, SpvOpExtInst) || i[3] != exact->glsl)
        return false;
    bool most = i[4] == GLSLstd450FMax || i[4] == GLSLstd450NMax;
    bool clamps = i[4] == GLSLstd450FClamp || i[4] == GLSLstd450NClamp;
    if (!most && !clamps && i[4] != GLSLstd450FMin && i[4] != GLSLstd450NMin)
        return false;
    struct bounds a = range_of(&exact->ranges, i[5]), b = range_of(&exact->ranges, i[6]);
    if (ranges_mix_zeros(a, b) ||
        (clamps && ranges_mix_zeros(range_of_most(a, b), range_of(&exact->ranges, i[7]))))
        return false;
    if (clamps) {
        uint32_t part = put_extreme(exact, i, true, exact->edit.bound++, i[5], i[6]);
        put_extreme(exact, i, false, i[2], part, i[7]);
    } else {
        put_extreme(exact, i, most, i[2], i[5], i[6]);
    }
    return true;
}

/* Whether a conversion takes a number that the integers have; those to other widths stay as well. */
static bool is_inside(struct exact *exact, const uint32_t *i)
{
    bool sign = spirv_is(i, SpvOpConvertFToS), whole = spirv_is(i, SpvOpConvertUToF);
    if (!sign && !whole && !spirv_is(i, SpvOpConvertFToU))
        return false;
    if (whole || !spirv_letter(number_type(exact, i[1])))
        return !spirv_letter(number_type(exact, i[1]));
    struct bounds a = range_of(&exact->ranges, i[3]);
    return !a.nan && a.low >= (sign ? -2147483648.0F : 0) &&
           a.high < (sign ? 2147483648.0F : 4294967296.0F);
}

static void add_bounds(struct bounds bounds, struct text *out)
{
    bool zero = bounds.minus && bounds.low <= 0 && bounds.high >= 0;
    if (isinf(bounds.low) && isinf(bounds.high))
        text_add(out, "any number");
    else
        text_add(out, bounds.low == bounds.high ? "%.9g" : "%.9g to %.9g", (double)bounds.low,
                 (double)bounds.high);
    text_add(out, "%s%s", zero ? " or -0" : "", bounds.nan ? " or NaN" : "");
}

/* Tells the form of an operation, whose operands begin at the word `first`. */
static void tell_form_of(struct exact *exact, const char *word, const char *form, const uint32_t *i,
                         uint32_t first)
{
    struct text text = {0};
    text_add(&text, "%s, of ", form);
    for (uint32_t at = first; at < spirv_length(i); at++) {
        text_add(&text, at > first ? "; " : "");
        add_bounds(range_of(&exact->ranges, i[at]), &text);
    }
    exact->tell(exact->user, exact->line ? spirv_line_file(exact->from, exact->line) : 0,
                exact->line ? exact->line[2] : 0, word, text.failed ? form : text.data);
    text_free(&text);
}

/* Calls the library's function, or that for numbers component by component; false: it has neither. */
static bool put_calls(struct exact *exact, const uint32_t *instruction, const char *name,
                      uint32_t first)
{
    uint32_t function = find_replacement(exact, instruction, name, first, false);
    const uint32_t *type = spirv_definition(exact->from, instruction[1]);
    if (function) {
        put_call(exact, instruction, first, function, instruction[1], instruction[2], -1);
        return true;
    }
    function = spirv_is(type, SpvOpTypeVector)
                   ? find_replacement(exact, instruction, name, first, true)
                   : 0;
    if (function)
        put_components(exact, instruction, first, function, type);
    return function;
}

/* Writes the shortest form of an open operation, and names it; NULL: there is none. */
static const char *put_form(struct exact *exact, const uint32_t *instruction, const char *word,
                            uint32_t first)
{
    uint32_t own[7];
    const char *name = word;
    if (put_extremes(exact, instruction))
        return "instruction";
    if (put_product(exact, instruction))
        return "product";
    take_constant_form(exact, &name, &instruction, own);
    if (has_short_divisor(exact, instruction))
        name = "divide_constant";
    if (!put_calls(exact, instruction, name, first))
        return NULL;
    return name == word ? "library" : "constant";
}

/* False: the instruction stays. */
static bool replace(struct exact *exact, const uint32_t *instruction)
{
    uint32_t first, own[5];
    const char *word = replacement_of(exact, instruction, &first);
    if (is_quotient(exact, instruction, own)) {
        instruction = own;
        word = "quotient";
    }
    if (!word)
        return put_shift(exact, instruction);
    bool stays = is_inside(exact, instruction);
    const char *form = stays ? "instruction" : put_form(exact, instruction, word, first);
    if (exact->tell && form && !(stays && !spirv_letter(number_type(exact, instruction[1]))))
        tell_form_of(exact, word, form, instruction, first);
    return form && !stays;
}

/* ---- The module ------------------------------------------------------------------------------ */

/* Decorations but those of precision, which are set anew. */
static void copy_annotations(struct exact *exact)
{
    const struct spirv *from = exact->from;
    SPIRV_EACH(from, i, from->annotations, from->declarations) {
        bool precision =
            (spirv_is(i, SpvOpDecorate) &&
             (i[2] == SpvDecorationNoContraction || i[2] == SpvDecorationRelaxedPrecision)) ||
            (spirv_is(i, SpvOpMemberDecorate) && i[3] == SpvDecorationRelaxedPrecision);
        if (!precision)
            spirv_copy(&exact->edit, &exact->edit.annotations, i);
    }
}

bool spirv_exact(struct spirv *module, tell_form_fn *tell, void *user)
{
    struct exact exact = {.from = module, .glsl = spirv_glsl(module), .tell = tell, .user = user};
    struct spirv_edit *edit = &exact.edit;
    spirv_edit_begin(edit, module);
    spirv_link_begin(&exact.link, edit);
    ranges_begin(&exact.ranges, edit);
    copy_annotations(&exact);
    size_t begin = edit->failed ? 0 : spirv_function_of(module, spirv_entry(module))->begin;
    SPIRV_EACH_AT(module, at, module->code, edit->failed ? module->code : module->count) {
        const uint32_t *instruction = module->words + at;
        if (spirv_is(instruction, SpvOpLine))
            exact.line = instruction;
        if (begin && at > begin && !spirv_is(instruction, SpvOpLabel) &&
            !spirv_is(instruction, SpvOpVariable)) {
            put_outputs(&exact);
            begin = 0;
        }
        if (replace(&exact, instruction) || put_end(&exact, instruction))
            continue;
        uint32_t own[5];
        spirv_copy(edit, &edit->code, without_zeros(&exact, instruction, own));
        if (spirv_is_arithmetic(instruction))
            mark(&exact, instruction[2]);
    }
    spirv_link_end(&exact.link);
    return spirv_edit_end(edit, module);
}
