/* A preloaded library that makes a Vulkan driver as inexact as the standards allow. The library
 * rewrites each shader module on the way to the driver. Results of open operations are off by one
 * unit in the last place, linear filters by a weight step, and stores round either way.
 * Rasterization stays unchanged: derivatives, levels of detail, interpolation. ADVERSARY=FILE gets
 * a line for each module: numbers of open operations, samplings and stores. For adversary_test.sh;
 * independent of the tables in gen/spirv/prove.c. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <spirv/unified1/GLSL.std.450.h>
#define SPV_ENABLE_UTILITY_CODE /* SpvHasResultAndType */
#include <spirv/unified1/spirv.h>
#include <vulkan/vulkan.h>

enum { HEADER = 5 };

struct list {
    uint32_t *words;
    size_t count, room;
};

struct rewrite {
    const uint32_t *words;
    size_t count;
    size_t *definitions; /* by id */
    bool *precise;       /* by id: NoContraction */
    uint32_t bound, glsl;
    struct list types, code, functions; /* new words: before, in and behind the functions */
    uint32_t real, whole, truth;        /* types: float, uint, bool */
    uint32_t off, half, code_8;         /* functions */
    unsigned open, samples, stores;
};

extern void SpvHasResultAndType(SpvOp opcode, bool *hasResult, bool *hasResultType);

/* ---- Words ----------------------------------------------------------------------------------- */

static void add_words(struct list *list, const uint32_t *words, size_t count)
{
    if (list->count + count > list->room) {
        list->room = 2 * (list->count + count);
        list->words = realloc(list->words, list->room * sizeof *words);
        if (!list->words)
            abort();
    }
    for (size_t i = 0; i < count; i++)
        list->words[list->count++] = words[i];
}

static void put(struct list *list, uint32_t opcode, const uint32_t *operands, uint32_t count)
{
    const uint32_t head = (count + 1) << 16 | opcode;
    add_words(list, &head, 1);
    add_words(list, operands, count);
}

#define OPERANDS(...)          (const uint32_t[]){__VA_ARGS__}, sizeof(uint32_t[]){__VA_ARGS__} / 4
#define PUT(list, opcode, ...) put(list, opcode, OPERANDS(__VA_ARGS__))

static bool is(const uint32_t *instruction, uint32_t opcode)
{
    return (*instruction & 0xffff) == opcode;
}

static const uint32_t *definition(const struct rewrite *to, uint32_t id)
{
    return to->words + to->definitions[id];
}

static const uint32_t *type_of(const struct rewrite *to, uint32_t id)
{
    return definition(to, definition(to, id)[1]);
}

/* Id of the type with this head and these operands in `words`; 0: `words` has no such type. */
static uint32_t find_type(const uint32_t *words, size_t count, uint32_t head,
                          const uint32_t *operands)
{
    for (size_t at = 0; at < count; at += words[at] >> 16)
        if (words[at] == head && !memcmp(words + at + 2, operands, (head >> 16) * 4 - 8))
            return words[at + 1];
    return 0;
}

/* The type with these operands. Reuses an existing declaration, since a module may declare a type
 * only once. */
static uint32_t declare(struct rewrite *to, uint32_t opcode, const uint32_t *operands,
                        uint32_t count)
{
    const uint32_t head = (count + 2) << 16 | opcode;
    uint32_t type = find_type(to->words + HEADER, to->count - HEADER, head, operands);
    type = type ? type : find_type(to->types.words, to->types.count, head, operands);
    if (type)
        return type;
    add_words(&to->types, (uint32_t[]){head, to->bound}, 2);
    add_words(&to->types, operands, count);
    return to->bound++;
}

static uint32_t constant(struct rewrite *to, uint32_t type, uint32_t bits)
{
    PUT(&to->types, SpvOpConstant, type, to->bound, bits);
    return to->bound++;
}

static uint32_t put_1(struct rewrite *to, struct list *list, uint32_t opcode, uint32_t type,
                      uint32_t a)
{
    PUT(list, opcode, type, to->bound, a);
    return to->bound++;
}

static uint32_t put_2(struct rewrite *to, struct list *list, uint32_t opcode, uint32_t type,
                      uint32_t a, uint32_t b)
{
    PUT(list, opcode, type, to->bound, a, b);
    return to->bound++;
}

/* ---- Functions of a number ------------------------------------------------------------------- */

/* A function under construction. */
struct function {
    struct rewrite *to;
    uint32_t id, bits, zero, one, coin; /* coin: 0 or 1, by the bits */
};

static uint32_t uint_2(const struct function *f, uint32_t opcode, uint32_t a, uint32_t b)
{
    return put_2(f->to, &f->to->functions, opcode, f->to->whole, a, b);
}

static uint32_t literal(const struct function *f, uint32_t bits)
{
    return constant(f->to, f->to->whole, bits);
}

static uint32_t differs(const struct function *f, uint32_t a, uint32_t b)
{
    return put_2(f->to, &f->to->functions, SpvOpINotEqual, f->to->truth, a, b);
}

static uint32_t choose(const struct function *f, uint32_t condition, uint32_t a, uint32_t b)
{
    PUT(&f->to->functions, SpvOpSelect, f->to->whole, f->to->bound, condition, a, b);
    return f->to->bound++;
}

static struct function begin_function(struct rewrite *to)
{
    struct function f = {.to = to, .id = to->bound++};
    const uint32_t argument = to->bound++;
    PUT(&to->functions, SpvOpFunction, to->real, f.id, SpvFunctionControlMaskNone,
        declare(to, SpvOpTypeFunction, OPERANDS(to->real, to->real)));
    PUT(&to->functions, SpvOpFunctionParameter, to->real, argument);
    PUT(&to->functions, SpvOpLabel, to->bound++);
    f.bits = put_1(to, &to->functions, SpvOpBitcast, to->whole, argument);
    f.zero = literal(&f, 0);
    f.one = literal(&f, 1);
    uint32_t hash = uint_2(&f, SpvOpIMul, f.bits, literal(&f, 0x9e3779b1));
    f.coin = uint_2(&f, SpvOpShiftRightLogical, hash, literal(&f, 31));
    return f;
}

static uint32_t end_function(const struct function *f, uint32_t bits)
{
    uint32_t result = put_1(f->to, &f->to->functions, SpvOpBitcast, f->to->real, bits);
    PUT(&f->to->functions, SpvOpReturnValue, result);
    put(&f->to->functions, SpvOpFunctionEnd, &f->id, 0);
    return f->id;
}

/* One unit in the last place more or less; zeros, denormals, infinities and NaN as they are. */
static uint32_t make_off(struct rewrite *to)
{
    const struct function f = begin_function(to);
    uint32_t infinity = literal(&f, 0x7f800000);
    uint32_t exponent = uint_2(&f, SpvOpBitwiseAnd, f.bits, infinity);
    uint32_t step = uint_2(&f, SpvOpISub, uint_2(&f, SpvOpIAdd, f.coin, f.coin), f.one);
    step = choose(&f, differs(&f, exponent, f.zero), step, f.zero);
    step = choose(&f, differs(&f, exponent, infinity), step, f.zero);
    return end_function(&f, uint_2(&f, SpvOpIAdd, f.bits, step));
}

/* Rounds up or down to a number with 13 mantissa bits less; keeps a number that has only these
 * bits. */
static uint32_t make_half(struct rewrite *to)
{
    const struct function f = begin_function(to);
    uint32_t rest = uint_2(&f, SpvOpBitwiseAnd, f.bits, literal(&f, 0x1fff));
    uint32_t up = uint_2(&f, SpvOpShiftLeftLogical, f.coin, literal(&f, 13));
    up = choose(&f, differs(&f, rest, f.zero), up, f.zero);
    return end_function(&f, uint_2(&f, SpvOpIAdd, uint_2(&f, SpvOpISub, f.bits, rest), up));
}

/* Subtracts half a code of 8 bits, or nothing: rounds down where the driver rounds to nearest. */
static uint32_t make_code_8(struct rewrite *to)
{
    const struct function f = begin_function(to);
    const float half = 0.5f / 255.0f;
    uint32_t bits;
    memcpy(&bits, &half, sizeof bits);
    uint32_t less = choose(&f, differs(&f, f.coin, f.zero), literal(&f, bits), f.zero);
    uint32_t value = put_2(to, &to->functions, SpvOpFSub, to->real,
                           put_1(to, &to->functions, SpvOpBitcast, to->real, f.bits),
                           put_1(to, &to->functions, SpvOpBitcast, to->real, less));
    return end_function(&f, put_1(to, &to->functions, SpvOpBitcast, to->whole, value));
}

/* Emits a call of the function for each number of a value. */
static void apply(struct rewrite *to, uint32_t function, uint32_t type, uint32_t from,
                  uint32_t result)
{
    const uint32_t *shape = definition(to, type);
    uint32_t parts[6] = {type, result};
    if (is(shape, SpvOpTypeFloat)) {
        PUT(&to->code, SpvOpFunctionCall, type, result, function, from);
        return;
    }
    for (uint32_t i = 0; i < shape[3]; i++) {
        uint32_t part = put_2(to, &to->code, SpvOpCompositeExtract, shape[2], from, i);
        apply(to, function, shape[2], part, parts[2 + i] = to->bound++);
    }
    put(&to->code, SpvOpCompositeConstruct, parts, 2 + shape[3]);
}

/* ---- Operations ------------------------------------------------------------------------------ */

static bool is_float(const struct rewrite *to, const uint32_t *type)
{
    while (is(type, SpvOpTypeVector) || is(type, SpvOpTypeMatrix))
        type = definition(to, type[2]);
    return is(type, SpvOpTypeFloat) && type[2] == 32;
}

/* Whether an instruction with a float result is not open: no arithmetic, a derivative, or correctly
 * rounded. */
static bool is_closed(const struct rewrite *to, const uint32_t *instruction)
{
    switch (*instruction & 0xffff) {
    case SpvOpFAdd:
    case SpvOpFSub:
    case SpvOpFMul:
    case SpvOpVectorTimesScalar:
    case SpvOpMatrixTimesScalar:
    case SpvOpOuterProduct:
        return to->precise[instruction[2]];
    case SpvOpExtInst:
        switch (instruction[3] == to->glsl ? instruction[4] : GLSLstd450Bad) {
        case GLSLstd450RoundEven:
        case GLSLstd450Trunc:
        case GLSLstd450FAbs:
        case GLSLstd450FSign:
        case GLSLstd450Floor:
        case GLSLstd450Ceil:
        case GLSLstd450Step:
            return true;
        case GLSLstd450NMin: /* a number wins over NaN; exact modules mark those that meet no zeros of unlike sign */
        case GLSLstd450NMax:
            return to->precise[instruction[2]];
        }
        return false;
    case SpvOpUndef:
    case SpvOpLoad:
    case SpvOpPhi:
    case SpvOpSelect:
    case SpvOpFunction:
    case SpvOpFunctionParameter:
    case SpvOpFunctionCall:
    case SpvOpCopyObject:
    case SpvOpCopyLogical:
    case SpvOpCompositeConstruct:
    case SpvOpCompositeExtract:
    case SpvOpCompositeInsert:
    case SpvOpVectorShuffle:
    case SpvOpVectorExtractDynamic:
    case SpvOpVectorInsertDynamic:
    case SpvOpTranspose:
    case SpvOpBitcast:
    case SpvOpFNegate:
    case SpvOpConvertSToF:
    case SpvOpConvertUToF:
    case SpvOpImageFetch:
    case SpvOpImageRead:
        return true;
    default:
        return (*instruction & 0xffff) >= SpvOpDPdx && (*instruction & 0xffff) <= SpvOpFwidthCoarse;
    }
}

/* Emits the instruction with the word `at` replaced by `id`. */
static void put_changed(struct rewrite *to, const uint32_t *instruction, uint32_t at, uint32_t id)
{
    add_words(&to->code, instruction, *instruction >> 16);
    to->code.words[to->code.count - (*instruction >> 16) + at] = id;
}

static void put_open(struct rewrite *to, const uint32_t *instruction)
{
    uint32_t result = to->bound++;
    put_changed(to, instruction, 2, result);
    apply(to, to->off, instruction[1], result, instruction[2]);
    to->open++;
}

/* Emits a sampling of a 2D image, moved 1/256 of a texel to the right. */
static void put_sample(struct rewrite *to, const uint32_t *instruction)
{
    const uint32_t *sampled = type_of(to, instruction[3]), *image = definition(to, sampled[2]);
    const uint32_t *place = type_of(to, instruction[4]);
    uint32_t whole = declare(to, SpvOpTypeInt, OPERANDS(32, 1));
    uint32_t sizes = declare(to, SpvOpTypeVector, OPERANDS(whole, 2 + image[5]));
    uint32_t plain = put_1(to, &to->code, SpvOpImage, sampled[2], instruction[3]);
    uint32_t size =
        put_2(to, &to->code, SpvOpImageQuerySizeLod, sizes, plain, constant(to, whole, 0));
    const float step = 1.0f / 256.0f;
    uint32_t bits;
    memcpy(&bits, &step, sizeof bits);
    size = put_2(to, &to->code, SpvOpCompositeExtract, whole, size, 0);
    size = put_1(to, &to->code, SpvOpConvertSToF, to->real, size);
    size = put_2(to, &to->code, SpvOpFDiv, to->real, constant(to, to->real, bits), size);
    uint32_t x = put_2(to, &to->code, SpvOpCompositeExtract, to->real, instruction[4], 0);
    x = put_2(to, &to->code, SpvOpFAdd, to->real, x, size);
    PUT(&to->code, SpvOpCompositeInsert, place[1], to->bound, x, instruction[4], 0);
    put_changed(to, instruction, 4, to->bound++);
    to->samples++;
}

static bool samples_2d(const struct rewrite *to, const uint32_t *instruction)
{
    uint32_t opcode = *instruction & 0xffff;
    if (opcode < SpvOpImageSampleImplicitLod || opcode > SpvOpImageSampleDrefExplicitLod)
        return false;
    return definition(to, type_of(to, instruction[3])[2])[3] == SpvDim2D;
}

/* The function that rounds stores to this image; 0: the format holds any value. */
static uint32_t store_function(const struct rewrite *to, const uint32_t *instruction)
{
    if (!is(instruction, SpvOpImageWrite) || !is_float(to, type_of(to, instruction[3])))
        return 0;
    switch (type_of(to, instruction[1])[8]) {
    case SpvImageFormatRgba16f:
    case SpvImageFormatRg16f:
    case SpvImageFormatR16f:
        return to->half;
    case SpvImageFormatRgba8:
    case SpvImageFormatRg8:
    case SpvImageFormatR8:
        return to->code_8;
    default:
        return 0;
    }
}

static void put_store(struct rewrite *to, const uint32_t *instruction, uint32_t function)
{
    uint32_t value = to->bound++;
    apply(to, function, definition(to, instruction[3])[1], instruction[3], value);
    put_changed(to, instruction, 3, value);
    to->stores++;
}

/* ---- The module ------------------------------------------------------------------------------ */

static void survey(struct rewrite *to)
{
    for (size_t at = HEADER; at < to->count; at += to->words[at] >> 16) {
        const uint32_t *instruction = to->words + at;
        bool has_result, has_type;
        SpvHasResultAndType((SpvOp)(*instruction & 0xffff), &has_result, &has_type);
        if (has_result)
            to->definitions[instruction[has_type ? 2 : 1]] = at;
        if (is(instruction, SpvOpDecorate) && instruction[2] == SpvDecorationNoContraction)
            to->precise[instruction[1]] = true;
        if (is(instruction, SpvOpExtInstImport) &&
            !strcmp((const char *)(instruction + 2), "GLSL.std.450"))
            to->glsl = instruction[1];
    }
}

/* min, max and clamp are open only for zeros of different signs: they are counted, not changed. */
static bool only_zeros(const struct rewrite *to, const uint32_t *instruction)
{
    return is(instruction, SpvOpExtInst) && instruction[3] == to->glsl &&
           (instruction[4] == GLSLstd450FMin || instruction[4] == GLSLstd450FMax ||
            instruction[4] == GLSLstd450FClamp);
}

static void put_instruction(struct rewrite *to, const uint32_t *instruction)
{
    bool has_result, has_type;
    uint32_t store = store_function(to, instruction);
    SpvHasResultAndType((SpvOp)(*instruction & 0xffff), &has_result, &has_type);
    bool open =
        has_type && is_float(to, definition(to, instruction[1])) && !is_closed(to, instruction);
    if (store)
        put_store(to, instruction, store);
    else if (samples_2d(to, instruction))
        put_sample(to, instruction);
    else if (open && !only_zeros(to, instruction))
        put_open(to, instruction);
    else
        add_words(&to->code, instruction, *instruction >> 16);
    to->open += open && only_zeros(to, instruction);
}

/* The rewritten module, to free(). */
static struct list rewrite(struct rewrite *to)
{
    struct list out = {0};
    size_t at = HEADER;
    to->bound = to->words[3];
    to->definitions = calloc(to->bound, sizeof *to->definitions);
    to->precise = calloc(to->bound, sizeof *to->precise);
    if (!to->definitions || !to->precise)
        abort();
    survey(to);
    to->real = declare(to, SpvOpTypeFloat, OPERANDS(32));
    to->whole = declare(to, SpvOpTypeInt, OPERANDS(32, 0));
    to->truth = declare(to, SpvOpTypeBool, &to->bound, 0);
    to->off = make_off(to);
    to->half = make_half(to);
    to->code_8 = make_code_8(to);
    while (at < to->count && !is(to->words + at, SpvOpFunction))
        at += to->words[at] >> 16;
    size_t head = at;
    for (; at < to->count; at += to->words[at] >> 16)
        put_instruction(to, to->words + at);
    add_words(&out, to->words, HEADER);
    out.words[3] = to->bound;
    PUT(&out, SpvOpCapability, SpvCapabilityImageQuery);
    add_words(&out, to->words + HEADER, head - HEADER);
    add_words(&out, to->types.words, to->types.count);
    add_words(&out, to->code.words, to->code.count);
    add_words(&out, to->functions.words, to->functions.count);
    free(to->definitions);
    free(to->precise);
    free(to->types.words);
    free(to->code.words);
    free(to->functions.words);
    return out;
}

static void tell(const struct rewrite *to)
{
    FILE *file = fopen(getenv("ADVERSARY"), "a");
    if (!file || fprintf(file, "%u %u %u\n", to->open, to->samples, to->stores) < 0 || fclose(file))
        abort();
}

/* ---- Vulkan ---------------------------------------------------------------------------------- */

VkResult vkCreateShaderModule(VkDevice device, const VkShaderModuleCreateInfo *pCreateInfo,
                              const VkAllocationCallbacks *pAllocator,
                              VkShaderModule *pShaderModule)
{
    PFN_vkCreateShaderModule next;
    *(void **)&next = dlsym(RTLD_NEXT, "vkCreateShaderModule");
    struct rewrite to = {.words = pCreateInfo->pCode, .count = pCreateInfo->codeSize / 4};
    struct list out = rewrite(&to);
    VkShaderModuleCreateInfo info = *pCreateInfo;
    info.pCode = out.words;
    info.codeSize = out.count * 4;
    tell(&to);
    VkResult result = next(device, &info, pAllocator, pShaderModule);
    free(out.words);
    return result;
}
