/* Descriptors in SPIR-V; see spirv_uses.h. Opcodes and operands by the SPIR-V specification, chapter
 * 3. Every id that stands for (a part of) a descriptor carries the binding that it came from. */
#include "spirv_uses.h"

#include <stdlib.h>
#include <string.h>

#include <spirv/unified1/spirv.h>

enum { HEADER_WORDS = 5 };

struct module {
    const uint32_t *words;
    size_t count;
    uint32_t bound;
    uint8_t *origin; /* id -> binding + 1, 0: none */
    bool *opaque;    /* id of a variable whose load reads no memory: images, samplers */
    bool *reachable; /* id of a function */
    uint32_t entry;
    uint8_t *uses;
    const char *problem;
};

static uint32_t opcode(const uint32_t *instruction)
{
    return instruction[0] & SpvOpCodeMask;
}

static uint32_t length(const uint32_t *instruction)
{
    return instruction[0] >> SpvWordCountShift;
}

/* Calls visit for each instruction, with the function that it stands in, or 0. */
static void walk(struct module *module,
                 void (*visit)(struct module *, const uint32_t *instruction, uint32_t function))
{
    uint32_t function = 0;

    for (size_t at = HEADER_WORDS; at < module->count && length(&module->words[at]) > 0;
         at += length(&module->words[at])) {
        const uint32_t *instruction = &module->words[at];

        if (opcode(instruction) == SpvOpFunction)
            function = instruction[2];
        visit(module, instruction, function);
        if (opcode(instruction) == SpvOpFunctionEnd)
            function = 0;
    }
}

static void visit_declaration(struct module *module, const uint32_t *instruction, uint32_t function)
{
    (void)function;
    switch (opcode(instruction)) {
    case SpvOpEntryPoint:
        module->entry = instruction[2];
        break;
    case SpvOpDecorate:
        if (instruction[2] == SpvDecorationBinding)
            if (instruction[3] >= SPIRV_BINDINGS)
                module->problem = "a binding beyond the table";
            else
                module->origin[instruction[1]] = (uint8_t)(instruction[3] + 1);
        else if (instruction[2] == SpvDecorationDescriptorSet && instruction[3] != 0)
            module->problem = "a second descriptor set";
        break;
    case SpvOpVariable:
        module->opaque[instruction[2]] = instruction[3] == SpvStorageClassUniformConstant;
        break;
    default:
        break;
    }
}

static void visit_call(struct module *module, const uint32_t *instruction, uint32_t function)
{
    if (opcode(instruction) == SpvOpFunctionCall && module->reachable[function])
        module->reachable[instruction[3]] = true;
}

/* Effect of an instruction on a descriptor at one of its operands. */
struct effect {
    uint32_t operand; /* word of the instruction */
    uint8_t uses;
    bool derives; /* the result stands for the same descriptor */
};

static struct effect image_effect(uint32_t code)
{
    switch (code) {
    case SpvOpImageWrite:
        return (struct effect){.operand = 1, .uses = SPIRV_WRITES};
    case SpvOpImage:
    case SpvOpSampledImage:
    case SpvOpImageTexelPointer:
        return (struct effect){.operand = 3, .derives = true};
    case SpvOpImageRead:
    case SpvOpImageFetch:
    case SpvOpImageGather:
    case SpvOpImageDrefGather:
        return (struct effect){.operand = 3, .uses = SPIRV_READS};
    default:
        if (code >= SpvOpImageSampleImplicitLod && code <= SpvOpImageSampleProjDrefExplicitLod)
            return (struct effect){.operand = 3, .uses = SPIRV_READS};
        return (struct effect){0};
    }
}

static struct effect effect_of(uint32_t code)
{
    switch (code) {
    case SpvOpAccessChain:
    case SpvOpInBoundsAccessChain:
    case SpvOpPtrAccessChain:
    case SpvOpCopyObject:
        return (struct effect){.operand = 3, .derives = true};
    case SpvOpStore:
    case SpvOpAtomicStore:
        return (struct effect){.operand = 1, .uses = SPIRV_WRITES};
    case SpvOpAtomicLoad:
        return (struct effect){.operand = 3, .uses = SPIRV_READS};
    default:
        if (code >= SpvOpAtomicExchange && code <= SpvOpAtomicXor)
            return (struct effect){.operand = 3, .uses = SPIRV_READS | SPIRV_WRITES};
        return image_effect(code);
    }
}

static void visit_load(struct module *module, const uint32_t *instruction)
{
    uint8_t origin = module->origin[instruction[3]];

    if (!origin)
        return;
    if (module->opaque[instruction[3]])
        module->origin[instruction[2]] = origin;
    else
        module->uses[origin - 1] |= SPIRV_READS;
}

static void visit_use(struct module *module, const uint32_t *instruction, uint32_t function)
{
    struct effect effect = effect_of(opcode(instruction));

    if (!function || !module->reachable[function])
        return;
    if (opcode(instruction) == SpvOpLoad) {
        visit_load(module, instruction);
    } else if (effect.operand && module->origin[instruction[effect.operand]]) {
        uint8_t origin = module->origin[instruction[effect.operand]];

        module->uses[origin - 1] |= effect.uses;
        if (effect.derives) {
            module->origin[instruction[2]] = origin;
            module->opaque[instruction[2]] = module->opaque[instruction[effect.operand]] &&
                                             opcode(instruction) != SpvOpImageTexelPointer;
        }
    }
    for (uint32_t i = 4; opcode(instruction) == SpvOpFunctionCall && i < length(instruction); i++)
        if (module->origin[instruction[i]]) /* of filter.glsl: a sampler, which can only be read */
            module->uses[module->origin[instruction[i]] - 1] |= SPIRV_READS;
    if (opcode(instruction) == SpvOpCopyMemory)
        module->problem = "OpCopyMemory";
}

bool spirv_uses(const uint32_t *words, size_t count, uint8_t uses[SPIRV_BINDINGS],
                const char **problem)
{
    struct module module = {.words = words, .count = count, .uses = uses};

    *problem = NULL;
    memset(uses, 0, SPIRV_BINDINGS);
    if (count < HEADER_WORDS || words[0] != SpvMagicNumber) {
        *problem = "not SPIR-V";
        return false;
    }
    module.bound = words[3];
    module.origin = calloc(module.bound, sizeof *module.origin);
    module.opaque = calloc(module.bound, sizeof *module.opaque);
    module.reachable = calloc(module.bound, sizeof *module.reachable);
    if (!module.origin || !module.opaque || !module.reachable)
        abort();
    walk(&module, visit_declaration);
    module.reachable[module.entry] = true;
    /* a function may be called before its definition: one walk for each level of nested calls */
    for (int depth = 0; depth < 64; depth++)
        walk(&module, visit_call);
    walk(&module, visit_use);
    free(module.origin);
    free(module.opaque);
    free(module.reachable);
    *problem = module.problem;
    return !module.problem;
}
