/* Which operations of a SPIR-V module the standards leave open: a driver may give other bits than
 * the next one.
 *
 * Sources: the Vulkan specification, "Precision of Individual Operations" in the appendix "Vulkan
 * Environment for SPIR-V", and GLSL 4.60, section 4.7.1, for OpenGL. What either leaves open is
 * open. Zeros: GLSL.std.450 lets FMin(-0.0, 0.0) be either.
 *
 * The tables allow; they do not forbid. An instruction that no table has is open, so a new version
 * of glslang can make the proof fail, but not hold where it should not.
 *
 * The module is the finished one, behind exact.c: what exact.c has replaced is proved by the
 * instructions of its functions, and what it has missed is found here. The proof knows nothing of
 * exact.c. The one judgement of where a value goes is `drops`: a result of an atomic operation that
 * nothing reads cannot differ, and x and y of gl_FragCoord are exact (takes_xy). Beyond MOST_DEPTH
 * calls and variables the answer is "open".
 *
 * An operation that has no value at all (WRONG) is an error without --prove, too. Who calls decides
 * which passes count: those that write a resource with the contract `exact` (shaders.c).
 * spirv_prove (compile.c) compiles a shader again with lines only if something is open. What no
 * shader does, blending and coverage, is in prove_fixed.c. */
#include "prove.h"

#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "panel.h" /* DT_ARRAY_COUNT */

enum verdict {
    WRONG,   /* no value at all */
    ENDS,    /* a value that the author left out */
    DRIVER,  /* a value of a texture unit or of the scheduler, or arithmetic of double precision */
    RASTER,  /* a value of the rasterizer */
    ROUNDED, /* correctly rounded; open without NoContraction */
    MEMORY,  /* exact in memory; the result is open */
    INPUT    /* open if it reads an input of the driver */
};

struct rule {
    uint32_t number; /* SpvOp, GLSLstd450 or SpvBuiltIn */
    enum verdict verdict;
    const char *word; /* how a body has it */
    const char *why;
};

/* ---- Tables ---------------------------------------------------------------------------------- */

#define ORDER    "its operations have no fixed order"
#define CONTRACT "it may be contracted with other operations"
#define BOUND    "its error has a bound, its result is open"
#define ZEROS    "of -0.0 and 0.0 it may give either"
#define HALVES   "it may round a half in either direction"
#define FILTER   "filtering depends on the driver"
#define LEVEL    "the level of detail depends on the driver"
#define NEAR     "the neighbours depend on the driver"
#define BETWEEN  "interpolation depends on the driver"
#define RACE     "invocations have no fixed order"

/* No rounding, or a correctly rounded conversion: from the first to the last, as the specification numbers them. */
static const struct {
    uint16_t first, last;
} exact_families[] = {
    /* types, control flow, memory */
    {SpvOpTypeVoid, SpvOpTypeImage},
    {SpvOpTypeSampledImage, SpvOpTypeStruct},
    {SpvOpTypePointer, SpvOpTypeFunction},
    {SpvOpConstantTrue, SpvOpConstantComposite},
    {SpvOpFunction, SpvOpFunctionCall},
    {SpvOpVariable, SpvOpImageTexelPointer},
    {SpvOpControlBarrier, SpvOpMemoryBarrier},
    {SpvOpPhi, SpvOpUnreachable},
    /* bits and integers */
    {SpvOpVectorShuffle, SpvOpTranspose},
    {SpvOpImageRead, SpvOpImage},
    {SpvOpImageQuerySizeLod, SpvOpImageQuerySize},
    {SpvOpConvertFToU, SpvOpConvertSToF},
    {SpvOpSNegate, SpvOpIAdd},
    {SpvOpUDiv, SpvOpSDiv},
    {SpvOpIAddCarry, SpvOpSMulExtended},
    {SpvOpAny, SpvOpAll},
    {SpvOpLogicalEqual, SpvOpFUnordEqual},
    {SpvOpFUnordNotEqual, SpvOpFUnordGreaterThanEqual},
    {SpvOpShiftRightLogical, SpvOpBitCount},
};
static const uint16_t exact_operations[] = {
    SpvOpLine,        SpvOpNoLine, SpvOpConstantNull,
    SpvOpStore,       SpvOpISub,   SpvOpArrayLength,
    SpvOpImageFetch,  SpvOpUMod,   SpvOpVectorExtractDynamic,
    SpvOpBitcast,     SpvOpIMul,   SpvOpImageQueryLevels,
    SpvOpCopyLogical, SpvOpSMod,
};

static const struct rule operations[] = {
    {SpvOpUndef, WRONG, "a value", "nothing sets it"},
    {SpvOpLoad, INPUT, "", ""},
    {SpvOpAccessChain, INPUT, "", ""},
    {SpvOpFAdd, ROUNDED, "+", CONTRACT},
    {SpvOpFSub, ROUNDED, "-", CONTRACT},
    {SpvOpFMul, ROUNDED, "*", CONTRACT},
    {SpvOpVectorTimesScalar, ROUNDED, "*", CONTRACT},
    {SpvOpMatrixTimesScalar, ROUNDED, "*", CONTRACT},
    {SpvOpOuterProduct, ROUNDED, "outerProduct", CONTRACT},
    {SpvOpFDiv, DRIVER, "/", "it may err by 2.5 ulp"},
    {SpvOpFMod, DRIVER, "mod", BOUND},
    {SpvOpDot, DRIVER, "dot", ORDER},
    {SpvOpVectorTimesMatrix, DRIVER, "*", ORDER},
    {SpvOpMatrixTimesVector, DRIVER, "*", ORDER},
    {SpvOpMatrixTimesMatrix, DRIVER, "*", ORDER},
    {SpvOpImageSampleImplicitLod, DRIVER, "texture", LEVEL},
    {SpvOpImageSampleExplicitLod, DRIVER, "texture", FILTER},
    {SpvOpImageSampleDrefImplicitLod, DRIVER, "texture", LEVEL},
    {SpvOpImageSampleDrefExplicitLod, DRIVER, "texture", FILTER},
    {SpvOpImageSampleProjImplicitLod, DRIVER, "textureProj", LEVEL},
    {SpvOpImageSampleProjDrefImplicitLod, DRIVER, "textureProj", LEVEL},
    {SpvOpImageSampleProjExplicitLod, DRIVER, "textureProjLod", FILTER},
    {SpvOpImageGather, DRIVER, "textureGather", FILTER},
    {SpvOpImageDrefGather, DRIVER, "textureGather", FILTER},
    {SpvOpImageQueryLod, DRIVER, "textureQueryLod", LEVEL},
    {SpvOpDPdx, RASTER, "dFdx", NEAR},
    {SpvOpDPdy, RASTER, "dFdy", NEAR},
    {SpvOpFwidth, RASTER, "fwidth", NEAR},
    {SpvOpDPdxFine, RASTER, "dFdxFine", NEAR},
    {SpvOpDPdyFine, RASTER, "dFdyFine", NEAR},
    {SpvOpFwidthFine, RASTER, "fwidthFine", NEAR},
    {SpvOpDPdxCoarse, RASTER, "dFdxCoarse", NEAR},
    {SpvOpDPdyCoarse, RASTER, "dFdyCoarse", NEAR},
    {SpvOpFwidthCoarse, RASTER, "fwidthCoarse", NEAR},
    /* Integers: what these leave in memory does not depend on the order. */
    {SpvOpAtomicIAdd, MEMORY, "atomicAdd", RACE},
    {SpvOpAtomicISub, MEMORY, "atomicSub", RACE},
    {SpvOpAtomicSMin, MEMORY, "atomicMin", RACE},
    {SpvOpAtomicUMin, MEMORY, "atomicMin", RACE},
    {SpvOpAtomicSMax, MEMORY, "atomicMax", RACE},
    {SpvOpAtomicUMax, MEMORY, "atomicMax", RACE},
    {SpvOpAtomicAnd, MEMORY, "atomicAnd", RACE},
    {SpvOpAtomicOr, MEMORY, "atomicOr", RACE},
    {SpvOpAtomicXor, MEMORY, "atomicXor", RACE},
    {SpvOpAtomicLoad, DRIVER, "atomicLoad", RACE},
    {SpvOpAtomicStore, DRIVER, "atomicStore", RACE},
    {SpvOpAtomicExchange, DRIVER, "atomicExchange", RACE},
    {SpvOpAtomicCompareExchange, DRIVER, "atomicCompSwap", RACE},
    {SpvOpAtomicFAddEXT, DRIVER, "atomicAdd", RACE},
};

static const uint16_t exact_functions[] = {
    GLSLstd450RoundEven,   GLSLstd450Trunc,      GLSLstd450FAbs,
    GLSLstd450SAbs,        GLSLstd450FSign,      GLSLstd450SSign,
    GLSLstd450Floor,       GLSLstd450Ceil,       GLSLstd450UMin,
    GLSLstd450SMin,        GLSLstd450UMax,       GLSLstd450SMax,
    GLSLstd450UClamp,      GLSLstd450SClamp,     GLSLstd450FindILsb,
    GLSLstd450FindSMsb,    GLSLstd450FindUMsb,   GLSLstd450Modf,
    GLSLstd450FrexpStruct, GLSLstd450ModfStruct, /* newer glslang has it for modf */
};

static const struct rule functions[] = {
    {GLSLstd450Round, DRIVER, "round", HALVES},
    {GLSLstd450Fract, DRIVER, "fract", "GLSL has no bound for its error"},
    {GLSLstd450Radians, DRIVER, "radians", "the rounding of its factor is open"},
    {GLSLstd450Degrees, DRIVER, "degrees", "the rounding of its factor is open"},
    {GLSLstd450Sin, DRIVER, "sin", "it may err by 2^-11"},
    {GLSLstd450Cos, DRIVER, "cos", "it may err by 2^-11"},
    {GLSLstd450Tan, DRIVER, "tan", BOUND},
    {GLSLstd450Asin, DRIVER, "asin", BOUND},
    {GLSLstd450Acos, DRIVER, "acos", BOUND},
    {GLSLstd450Atan, DRIVER, "atan", "it may err by 4096 ulp"},
    {GLSLstd450Atan2, DRIVER, "atan", "it may err by 4096 ulp"},
    {GLSLstd450Sinh, DRIVER, "sinh", BOUND},
    {GLSLstd450Cosh, DRIVER, "cosh", BOUND},
    {GLSLstd450Tanh, DRIVER, "tanh", BOUND},
    {GLSLstd450Asinh, DRIVER, "asinh", BOUND},
    {GLSLstd450Acosh, DRIVER, "acosh", BOUND},
    {GLSLstd450Atanh, DRIVER, "atanh", BOUND},
    {GLSLstd450Pow, DRIVER, "pow", BOUND},
    {GLSLstd450Exp, DRIVER, "exp", "it may err by 3 + 2 |x| ulp"},
    {GLSLstd450Log, DRIVER, "log", "it may err by 3 ulp"},
    {GLSLstd450Exp2, DRIVER, "exp2", "it may err by 3 + 2 |x| ulp"},
    {GLSLstd450Log2, DRIVER, "log2", "it may err by 3 ulp"},
    {GLSLstd450Sqrt, DRIVER, "sqrt", BOUND},
    {GLSLstd450InverseSqrt, DRIVER, "inversesqrt", "it may err by 2 ulp"},
    {GLSLstd450Determinant, DRIVER, "determinant", ORDER},
    {GLSLstd450MatrixInverse, DRIVER, "inverse", ORDER},
    {GLSLstd450FMin, DRIVER, "min", ZEROS},
    {GLSLstd450FMax, DRIVER, "max", ZEROS},
    {GLSLstd450FClamp, DRIVER, "clamp", ZEROS},
    /* exact.c marks those that meet no such zeros with NoContraction. */
    {GLSLstd450NMin, ROUNDED, "min", ZEROS},
    {GLSLstd450NMax, ROUNDED, "max", ZEROS},
    {GLSLstd450NClamp, DRIVER, "clamp", ZEROS},
    {GLSLstd450Step, DRIVER, "step", "of NaN it may give either"},
    {GLSLstd450FMix, DRIVER, "mix", BOUND},
    {GLSLstd450SmoothStep, DRIVER, "smoothstep", BOUND},
    {GLSLstd450Fma, DRIVER, "fma", "it may round once or twice"},
    {GLSLstd450Ldexp, DRIVER, "ldexp", "GLSL has no bound for its error"},
    {GLSLstd450PackSnorm4x8, DRIVER, "packSnorm4x8", HALVES},
    {GLSLstd450PackUnorm4x8, DRIVER, "packUnorm4x8", HALVES},
    {GLSLstd450PackSnorm2x16, DRIVER, "packSnorm2x16", HALVES},
    {GLSLstd450PackUnorm2x16, DRIVER, "packUnorm2x16", HALVES},
    {GLSLstd450PackHalf2x16, DRIVER, "packHalf2x16", HALVES},
    {GLSLstd450UnpackSnorm2x16, DRIVER, "unpackSnorm2x16", "its division may err"},
    {GLSLstd450UnpackUnorm2x16, DRIVER, "unpackUnorm2x16", "its division may err"},
    {GLSLstd450UnpackHalf2x16, DRIVER, "unpackHalf2x16", "denormals may become 0"},
    {GLSLstd450UnpackSnorm4x8, DRIVER, "unpackSnorm4x8", "its division may err"},
    {GLSLstd450UnpackUnorm4x8, DRIVER, "unpackUnorm4x8", "its division may err"},
    {GLSLstd450Length, DRIVER, "length", ORDER},
    {GLSLstd450Distance, DRIVER, "distance", ORDER},
    {GLSLstd450Cross, DRIVER, "cross", BOUND},
    {GLSLstd450Normalize, DRIVER, "normalize", ORDER},
    {GLSLstd450FaceForward, DRIVER, "faceforward", ORDER},
    {GLSLstd450Reflect, DRIVER, "reflect", ORDER},
    {GLSLstd450Refract, DRIVER, "refract", ORDER},
    {GLSLstd450InterpolateAtCentroid, RASTER, "interpolateAtCentroid", BETWEEN},
    {GLSLstd450InterpolateAtSample, RASTER, "interpolateAtSample", BETWEEN},
    {GLSLstd450InterpolateAtOffset, RASTER, "interpolateAtOffset", BETWEEN},
};

/* Inputs of a shader; others are unknown. */
static const uint16_t exact_inputs[] = {
    SpvBuiltInVertexIndex,       SpvBuiltInVertexId,           SpvBuiltInInstanceIndex,
    SpvBuiltInInstanceId,        SpvBuiltInBaseVertex,         SpvBuiltInBaseInstance,
    SpvBuiltInDrawIndex,         SpvBuiltInPrimitiveId,        SpvBuiltInFrontFacing,
    SpvBuiltInNumWorkgroups,     SpvBuiltInWorkgroupSize,      SpvBuiltInWorkgroupId,
    SpvBuiltInLocalInvocationId, SpvBuiltInGlobalInvocationId, SpvBuiltInLocalInvocationIndex,
};

static const struct rule inputs[] = {
    {SpvBuiltInFragCoord, INPUT, "gl_FragCoord", "depth depends on the driver; x and y are exact"},
    {SpvBuiltInPointCoord, RASTER, "gl_PointCoord", BETWEEN},
    {SpvBuiltInHelperInvocation, RASTER, "gl_HelperInvocation", "it depends on the driver"},
};

/* ---- Look-ups -------------------------------------------------------------------------------- */

enum { MOST_DEPTH = 8 }; /* of functions and variables that a value goes through */

struct id { /* decorations of an id */
    bool no_contraction, relaxed, flat;
    uint32_t builtin; /* + 1; 0: none */
};

struct proof {
    const struct spirv *module;
    struct id *ids;
    uint32_t glsl;            /* id of GLSL.std.450 */
    bool fragment;            /* of a fragment shader */
    uint32_t function;        /* the current one */
    char name[64];            /* its name, as the author has it */
    struct open_operation at; /* place of the current instruction */
    void (*found)(void *user, const struct open_operation *operation);
    void *user;
};

static bool has_number(const uint16_t *numbers, size_t count, uint32_t number)
{
    while (count && numbers[count - 1] != number)
        count--;
    return count;
}

/* The rule for a number that is not exact. */
static const struct rule *find_rule(const struct rule *rules, size_t count, uint32_t number)
{
    static const struct rule unknown = {0, DRIVER, "an operation", "the proof does not know it"};
    for (size_t i = 0; i < count; i++)
        if (rules[i].number == number)
            return &rules[i];
    return &unknown;
}

/* The rule for a number; NULL: it is exact. */
#define RULE(exact, rules, number)                                                                 \
    (has_number(exact, DT_ARRAY_COUNT(exact), number)                                              \
         ? NULL                                                                                    \
         : find_rule(rules, DT_ARRAY_COUNT(rules), number))

static void tell_finding(struct proof *proof, const char *word, const char *why,
                         enum verdict verdict)
{
    proof->at.function = spirv_name(proof->module, proof->function);
    proof->at.word = word;
    proof->at.why = why;
    proof->at.wrong = verdict == WRONG || verdict == ENDS;
    proof->at.ends = verdict == ENDS;
    proof->at.raster = verdict == RASTER;
    proof->found(proof->user, &proof->at);
}

struct value_use {
    const uint32_t *instruction;
    uint32_t operand;  /* its word that is the id */
    uint32_t function; /* that it stands in */
    int depth;         /* of calls of all_uses */
};
typedef bool allows_fn(const struct proof *proof, const struct value_use *use);

/* Whether `allows` every use of an id. Other literals that look like the id count as uses. */
static bool all_uses(const struct proof *proof, uint32_t id, int depth, allows_fn *allows)
{
    struct value_use use = {.depth = depth};
    for (size_t at = SPIRV_HEADER; at < proof->module->count && depth < MOST_DEPTH;
         at += proof->module->words[at] >> 16) {
        use.instruction = proof->module->words + at;
        if (spirv_is(use.instruction, SpvOpFunction))
            use.function = use.instruction[2];
        if (!use.function || at == proof->module->definitions[id])
            continue;
        for (use.operand = 1; use.operand < *use.instruction >> 16; use.operand++)
            if (use.instruction[use.operand] == id &&
                !spirv_is_literal(use.instruction, use.operand) && !allows(proof, &use))
                return false;
    }
    return depth < MOST_DEPTH;
}

/* .x, .y or .xy of a vector. */
static bool takes_xy(const struct proof *proof, const struct value_use *use)
{
    const uint32_t *instruction = use->instruction;
    (void)proof;
    if (spirv_is(instruction, SpvOpCompositeExtract))
        return use->operand == 3 && instruction[4] < 2;
    if (!spirv_is(instruction, SpvOpVectorShuffle) || instruction[3] != instruction[4])
        return false;
    for (uint32_t i = 5; i < *instruction >> 16; i++)
        if (instruction[i] > 1)
            return false;
    return true;
}

static bool drops(const struct proof *proof, const struct value_use *use);

/* Of a variable, or of a function: what is read from it is dropped. */
static bool drops_reads(const struct proof *proof, const struct value_use *use)
{
    const uint32_t *instruction = use->instruction;
    if (spirv_is(instruction, SpvOpLoad) || spirv_is(instruction, SpvOpFunctionCall))
        return use->operand == 3 && all_uses(proof, instruction[2], use->depth + 1, drops);
    return spirv_is(instruction, SpvOpStore) && use->operand == 1;
}

/* A value goes nowhere but through variables and out of functions whose results are dropped. */
static bool drops(const struct proof *proof, const struct value_use *use)
{
    const uint32_t *variable = spirv_definition(proof->module, use->instruction[1]);
    if (spirv_is(use->instruction, SpvOpReturnValue))
        return all_uses(proof, use->function, use->depth + 1, drops_reads);
    return spirv_is(use->instruction, SpvOpStore) && use->operand == 2 &&
           spirv_is(variable, SpvOpVariable) && variable[3] == SpvStorageClassFunction &&
           all_uses(proof, use->instruction[1], use->depth + 1, drops_reads);
}

/* ---- Instructions ---------------------------------------------------------------------------- */

/* Whether a load, or an access chain, takes x or y alone. */
static bool reads_xy(const struct proof *proof, const uint32_t *instruction)
{
    if (spirv_is(instruction, SpvOpLoad))
        return all_uses(proof, instruction[2], 0, takes_xy);
    const uint32_t *index = spirv_definition(proof->module, instruction[4]);
    return spirv_is(index, SpvOpConstant) && index[3] < 2;
}

static const char *value_name(const struct proof *proof, uint32_t id)
{
    const char *name = spirv_name(proof->module, id);
    return name ? name : "an input";
}

/* A load, or an access chain. */
static void check_input(struct proof *proof, const uint32_t *instruction)
{
    const uint32_t *variable = spirv_definition(proof->module, instruction[3]);
    const struct id *id = &proof->ids[instruction[3]];
    if (!spirv_is(variable, SpvOpVariable) || variable[3] != SpvStorageClassInput)
        return;
    if (!id->builtin) {
        if (proof->fragment && !id->flat)
            tell_finding(proof, value_name(proof, instruction[3]), BETWEEN, RASTER);
        return;
    }
    const struct rule *rule = RULE(exact_inputs, inputs, id->builtin - 1);
    if (rule && !(rule->verdict == INPUT && reads_xy(proof, instruction)))
        tell_finding(proof, rule->number ? rule->word : value_name(proof, instruction[3]),
                     rule->why, rule->verdict == INPUT ? RASTER : rule->verdict);
}

/* The rule for an instruction; NULL: it is exact. */
static const struct rule *rule_of(const uint32_t *instruction, uint32_t glsl)
{
    uint32_t opcode = spirv_opcode(instruction);
    if (opcode == SpvOpExtInst && instruction[3] == glsl)
        return RULE(exact_functions, functions, instruction[4]);
    for (size_t i = 0; i < DT_ARRAY_COUNT(exact_families); i++)
        if (opcode >= exact_families[i].first && opcode <= exact_families[i].last)
            return NULL;
    return RULE(exact_operations, operations, opcode);
}

const char *prove_word(const uint32_t *instruction, uint32_t glsl)
{
    const struct rule *rule = rule_of(instruction, glsl);
    return rule && *rule->word ? rule->word : NULL;
}

static bool has_no_use(const struct proof *proof, const struct value_use *use)
{
    (void)proof;
    (void)use;
    return false;
}

/* A function may end without a `return`: glslang then returns a value that nothing sets, and exact.c zero instead. */
static bool check_end(struct proof *proof, const uint32_t *instruction)
{
    const char *name = spirv_name(proof->module, proof->function);
    if (!spirv_is(instruction, SpvOpUndef) || !name ||
        !all_uses(proof, instruction[2], 0, has_no_use))
        return false;
    snprintf(proof->name, sizeof proof->name, "%.*s", (int)strcspn(name, "("), name);
    tell_finding(proof, proof->name, "may end without `return`, and is then 0", ENDS);
    return true;
}

extern const char *
spvOpcodeString(uint32_t opcode); /* of libspirv.h, which one file alone can include */

static void check_instruction(struct proof *proof, const uint32_t *instruction)
{
    const struct rule *rule =
        check_end(proof, instruction) ? NULL : rule_of(instruction, proof->glsl);
    uint32_t result = spirv_result(instruction);
    if (result && proof->ids[result].relaxed && !spirv_is(instruction, SpvOpVariable))
        tell_finding(proof, "mediump", "its precision is open", DRIVER);
    if (!rule)
        return;
    if (rule->verdict == INPUT)
        check_input(proof, instruction);
    else if (!(rule->verdict == ROUNDED && proof->ids[result].no_contraction) &&
             !(rule->verdict == MEMORY && all_uses(proof, result, 0, drops)))
        tell_finding(proof,
                     rule->number || spirv_is(instruction, SpvOpExtInst)
                         ? rule->word
                         : spvOpcodeString(spirv_opcode(instruction)),
                     rule->why, rule->verdict);
}

/* ---- The module ------------------------------------------------------------------------------ */

static void take_decoration(struct proof *proof, const uint32_t *instruction)
{
    struct id *id = &proof->ids[instruction[1]];
    id->no_contraction |= instruction[2] == SpvDecorationNoContraction;
    id->relaxed |= instruction[2] == SpvDecorationRelaxedPrecision;
    id->flat |= instruction[2] == SpvDecorationFlat;
    if (instruction[2] == SpvDecorationBuiltIn)
        id->builtin = instruction[3] + 1;
}

bool prove_module(const struct spirv *module,
                  void (*found)(void *user, const struct open_operation *operation), void *user)
{
    struct proof proof = {.module = module,
                          .ids = calloc(module->words[3], sizeof *proof.ids),
                          .glsl = spirv_glsl(module),
                          .found = found,
                          .user = user};
    SPIRV_EACH_AT(module, at, SPIRV_HEADER, proof.ids ? module->count : SPIRV_HEADER) {
        const uint32_t *instruction = module->words + at;
        uint32_t opcode = spirv_opcode(instruction);
        if (opcode == SpvOpDecorate)
            take_decoration(&proof, instruction);
        else if (opcode == SpvOpLine)
            proof.at = (struct open_operation){.file = spirv_line_file(module, instruction),
                                               .line = instruction[2]};
        else if (opcode == SpvOpFunction)
            proof.function = instruction[2];
        else if (opcode == SpvOpEntryPoint)
            proof.fragment = instruction[1] == SpvExecutionModelFragment;
        if (at >= module->declarations) /* what stands before computes nothing */
            check_instruction(&proof, instruction);
    }
    free(proof.ids);
    return proof.ids;
}
