/* How often the loops of a shader run, from its SPIR-V. Evaluates the loop's variable turn by turn,
 * as far as constants and the parameters' values decide it. Called by flops.c. */
#include "passes.h"

#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_STEPS = 1 << 25 }; /* evaluated instructions per loop; about a million turns */
enum { MAX_DEPTH = 64 };      /* of an expression */

/* What a function's variable gets. Only plain stores can be followed. */
struct stores {
    uint32_t count;
    bool escapes; /* a call or an access chain may write it, too */
    size_t first, last;
    uint32_t block; /* label of the block of the last one */
};

struct module {
    const struct spirv *spirv;
    const struct parameter_values *parameters;
    struct stores *stores; /* by id of the variable */
};

/* The loop's variable while an instruction is evaluated. */
struct evaluation {
    const struct module *module;
    uint32_t variable;
    int64_t value;
    uint32_t steps, depth;
};

/* ---- Values ---------------------------------------------------------------------------------- */

static const uint32_t *definition(const struct module *m, uint32_t id)
{
    return m->spirv->words + m->spirv->definitions[id];
}

/* The value as one of the type, 32 bits or a boolean; false: another type. */
static bool fit(const struct module *m, uint32_t type, int64_t *value)
{
    const uint32_t *declared = definition(m, type);
    bool truth = spirv_is(declared, SpvOpTypeBool);
    if (!truth && (!spirv_is(declared, SpvOpTypeInt) || declared[2] != 32))
        return false;
    if (truth)
        *value = *value != 0;
    else
        *value = declared[3] ? (int64_t)(int32_t)(uint32_t)*value : (int64_t)(uint32_t)*value;
    return true;
}

static bool decorated(const struct module *m, uint32_t id, uint32_t decoration, uint32_t value)
{
    for (size_t at = SPIRV_HEADER; at < m->spirv->count; at += m->spirv->words[at] >> 16) {
        const uint32_t *i = m->spirv->words + at;
        if (spirv_is(i, SpvOpFunction))
            return false;
        if (spirv_is(i, SpvOpDecorate) && i[1] == id && i[2] == decoration && i[3] == value)
            return true;
    }
    return false;
}

static bool member_offset(const struct module *m, uint32_t structure, uint32_t member,
                          uint32_t *offset)
{
    for (size_t at = SPIRV_HEADER; at < m->spirv->count; at += m->spirv->words[at] >> 16) {
        const uint32_t *i = m->spirv->words + at;
        if (spirv_is(i, SpvOpMemberDecorate) && i[1] == structure && i[2] == member &&
            i[3] == SpvDecorationOffset) {
            *offset = i[4];
            return true;
        }
    }
    return false;
}

/* Reads a number, or a component of a vector, of the block of parameters. */
static bool read_parameter(const struct module *m, const uint32_t *chain, int64_t *value)
{
    const uint32_t *block = definition(m, chain[3]);
    uint32_t length = *chain >> 16, offset;
    if (!spirv_is(block, SpvOpVariable) || block[3] != SpvStorageClassUniform || length < 5 ||
        length > 6 || !decorated(m, chain[3], SpvDecorationBinding, m->parameters->binding))
        return false;
    const uint32_t *member = definition(m, chain[4]);
    const uint32_t *component = length > 5 ? definition(m, chain[5]) : NULL;
    uint32_t structure = definition(m, block[1])[3];
    if (!spirv_is(member, SpvOpConstant) || (component && !spirv_is(component, SpvOpConstant)) ||
        !member_offset(m, structure, member[3], &offset))
        return false;
    offset += component ? component[3] * 4 : 0;
    if (offset + 4 > m->parameters->size)
        return false;
    uint32_t bits;
    memcpy(&bits, (const char *)m->parameters->bytes + offset, sizeof bits);
    *value = bits;
    return true;
}

/* False: not a comparison. */
static bool compare(uint32_t opcode, int64_t a, int64_t b, int64_t *value)
{
    switch (opcode) {
    case SpvOpIEqual:
        *value = a == b;
        return true;
    case SpvOpINotEqual:
        *value = a != b;
        return true;
    case SpvOpSLessThan:
    case SpvOpULessThan:
        *value = a < b;
        return true;
    case SpvOpSLessThanEqual:
    case SpvOpULessThanEqual:
        *value = a <= b;
        return true;
    case SpvOpSGreaterThan:
    case SpvOpUGreaterThan:
        *value = a > b;
        return true;
    case SpvOpSGreaterThanEqual:
    case SpvOpUGreaterThanEqual:
        *value = a >= b;
        return true;
    default:
        return false;
    }
}

/* False: not an operation on two integers or booleans, or undefined. */
static bool operate(uint32_t opcode, int64_t a, int64_t b, int64_t *value)
{
    switch (opcode) {
    case SpvOpIAdd:
        *value = a + b;
        return true;
    case SpvOpISub:
        *value = a - b;
        return true;
    case SpvOpIMul:
        *value = (int64_t)((uint64_t)a * (uint64_t)b);
        return true;
    case SpvOpSDiv:
    case SpvOpUDiv:
        *value = b ? a / b : 0;
        return b;
    case SpvOpUMod:
    case SpvOpSMod: /* the sign of b */
        *value = b ? (a % b + b) % b : 0;
        return b;
    case SpvOpShiftLeftLogical:
        *value = a * ((int64_t)1 << (b & 31));
        return b >= 0 && b < 32;
    case SpvOpShiftRightLogical:
    case SpvOpShiftRightArithmetic:
        *value = a >> (b & 31);
        return b >= 0 && b < 32;
    default:
        return compare(opcode, a, b, value);
    }
}

/* Value of an integer or boolean while the loop's variable has the evaluation's value. False: it
 * depends on what only a run decides. */
static bool evaluate(struct evaluation *e, uint32_t id, int64_t *value);

static bool load(struct evaluation *e, const uint32_t *instruction, int64_t *value)
{
    const struct module *m = e->module;
    const uint32_t *pointer = definition(m, instruction[3]);
    const struct stores *stores = &m->stores[instruction[3]];
    if (instruction[3] == e->variable) {
        *value = e->value;
        return true;
    }
    if (spirv_is(pointer, SpvOpAccessChain))
        return read_parameter(m, pointer, value);
    return stores->count == 1 && !stores->escapes &&
           m->spirv->words + stores->first <
               instruction && /* else the store may read what it stores */
           evaluate(e, m->spirv->words[stores->first + 2], value);
}

static bool call_library(struct evaluation *e, const uint32_t *instruction, int64_t *value)
{
    int64_t a, b;
    uint32_t function = instruction[4];
    if ((function != GLSLstd450SMin && function != GLSLstd450UMin && function != GLSLstd450SMax &&
         function != GLSLstd450UMax) ||
        !evaluate(e, instruction[5], &a) || !evaluate(e, instruction[6], &b))
        return false;
    bool smaller = function == GLSLstd450SMin || function == GLSLstd450UMin;
    *value = (a < b) == smaller ? a : b;
    return true;
}

static bool compute(struct evaluation *e, const uint32_t *instruction, int64_t *value)
{
    uint32_t opcode = *instruction & 0xffff;
    int64_t a, b;
    switch (opcode) {
    case SpvOpConstant:
        *value = instruction[3];
        return true;
    case SpvOpLoad:
        return load(e, instruction, value);
    case SpvOpExtInst:
        return call_library(e, instruction, value);
    case SpvOpBitcast:
        return evaluate(e, instruction[3], value);
    case SpvOpSelect:
        return evaluate(e, instruction[3], &a) && evaluate(e, instruction[a ? 4 : 5], value);
    case SpvOpSNegate:
        if (!evaluate(e, instruction[3], &a))
            return false;
        *value = -a;
        return true;
    default: /* arithmetic, shifts, comparisons: two operands */
        return opcode >= SpvOpIAdd && opcode <= SpvOpBitCount && *instruction >> 16 == 5 &&
               evaluate(e, instruction[3], &a) && evaluate(e, instruction[4], &b) &&
               operate(opcode, a, b, value);
    }
}

static bool evaluate(struct evaluation *e, uint32_t id, int64_t *value)
{
    const uint32_t *instruction = definition(e->module, id);
    if (!e->module->spirv->definitions[id] || e->depth == MAX_DEPTH || e->steps++ >= MAX_STEPS)
        return false;
    e->depth++;
    bool known = compute(e, instruction, value) && fit(e->module, instruction[1], value);
    e->depth--;
    return known;
}

/* ---- Loops ----------------------------------------------------------------------------------- */

struct loop {
    size_t header, merge,
        onward;           /* offsets: its first block, the block behind it, its last block */
    const uint32_t *test; /* the branch that ends it */
    bool stays_if;        /* value of the condition for another turn */
};

/* Number of ways out of the blocks between two offsets: jumps to `merge`, returns, discards. */
static uint32_t ways_out(const struct module *m, size_t from, size_t to, uint32_t merge)
{
    uint32_t ways = 0;
    for (size_t at = from; at < to; at += m->spirv->words[at] >> 16) {
        const uint32_t *i = m->spirv->words + at;
        bool jumps = spirv_is(i, SpvOpBranch) || spirv_is(i, SpvOpBranchConditional) ||
                     spirv_is(i, SpvOpSwitch);
        ways += spirv_ends_block(i) && !jumps;
        for (uint32_t k = 1; jumps && k < *i >> 16; k++)
            ways += i[k] == merge;
    }
    return ways;
}

static const uint32_t *block_end(const struct module *m, uint32_t label)
{
    size_t at = m->spirv->definitions[label];
    while (!spirv_ends_block(m->spirv->words + at))
        at += m->spirv->words[at] >> 16;
    return m->spirv->words + at;
}

/* A loop that only its condition ends, asked before every turn: `for` and `while` without `break`
 * and `return`. at: its OpLoopMerge. */
static bool read_loop(const struct module *m, size_t header, size_t at, struct loop *loop)
{
    const uint32_t *merge = m->spirv->words + at, *branch = merge + (*merge >> 16);
    *loop = (struct loop){.header = header,
                          .merge = m->spirv->definitions[merge[1]],
                          .onward = m->spirv->definitions[merge[2]]};
    if (!spirv_is(branch, SpvOpBranch))
        return false;
    loop->test = block_end(m, branch[1]);
    loop->stays_if = loop->test[2] != merge[1];
    return spirv_is(loop->test, SpvOpBranchConditional) &&
           (loop->test[2] == merge[1] || loop->test[3] == merge[1]) && loop->onward > header &&
           loop->merge > loop->onward && ways_out(m, header, loop->merge, merge[1]) == 1;
}

/* Whether a loop begins behind the offset and surrounds `loop`. */
static bool is_repeated(const struct module *m, size_t from, const struct loop *loop)
{
    for (size_t at = from; at < loop->header; at += m->spirv->words[at] >> 16)
        if (spirv_is(m->spirv->words + at, SpvOpLoopMerge) &&
            m->spirv->definitions[m->spirv->words[at + 1]] > loop->header)
            return true;
    return false;
}

/* Whether the variable is set before the loop and once at the end of each turn. */
static bool drives(const struct module *m, uint32_t variable, const struct loop *loop)
{
    const struct stores *stores = &m->stores[variable];
    return stores->count == 2 && !stores->escapes && stores->first < loop->header &&
           m->spirv->definitions[stores->block] == loop->onward &&
           !is_repeated(m, stores->first, loop);
}

/* The variable of the loop: the one that its condition loads. 0: none that can be followed. */
static uint32_t loop_variable(const struct module *m, const struct loop *loop)
{
    const uint32_t *condition = definition(m, loop->test[1]);
    for (uint32_t k = 3; k < 5 && *condition >> 16 == 5; k++) {
        const uint32_t *operand = definition(m, condition[k]);
        if (spirv_is(operand, SpvOpLoad) && drives(m, operand[3], loop))
            return operand[3];
    }
    return 0;
}

/* Number of turns; 1 where only a run decides it. */
static uint64_t count_turns(const struct module *m, const struct loop *loop)
{
    uint32_t variable = loop_variable(m, loop);
    const struct stores *stores = &m->stores[variable];
    struct evaluation e = {.module = m};
    int64_t stays;
    if (!variable || !evaluate(&e, m->spirv->words[stores->first + 2], &e.value))
        return 1;
    e.variable = variable;
    for (uint64_t turns = 0; evaluate(&e, loop->test[1], &stays); turns++) {
        int64_t next;
        if (stays != loop->stays_if)
            return turns;
        if (!evaluate(&e, m->spirv->words[stores->last + 2], &next))
            return 1;
        e.value = next;
    }
    return 1;
}

/* ---- The module ------------------------------------------------------------------------------ */

static void survey(const struct module *m)
{
    uint32_t label = 0;
    for (size_t at = SPIRV_HEADER; at < m->spirv->count; at += m->spirv->words[at] >> 16) {
        const uint32_t *i = m->spirv->words + at;
        if (spirv_is(i, SpvOpLabel)) {
            label = i[1];
        } else if (spirv_is(i, SpvOpStore)) {
            struct stores *stores = &m->stores[i[1]];
            stores->first = stores->count++ ? stores->first : at;
            stores->last = at;
            stores->block = label;
        } else if (spirv_is(i, SpvOpVariable)) {
            m->stores[i[2]].escapes |= i[3] != SpvStorageClassFunction || *i >> 16 > 4;
        } else if (spirv_is(i, SpvOpFunctionParameter)) { /* the caller writes it, too */
            m->stores[i[2]].escapes = true;
        } else if (spirv_is(i, SpvOpAccessChain) || spirv_is(i, SpvOpFunctionCall)) {
            for (uint32_t k = 3; k < *i >> 16; k++)
                m->stores[i[k]].escapes = true;
        }
    }
}

uint64_t *spirv_iterations(const struct spirv *module, const struct parameter_values *parameters)
{
    const uint32_t *words = module->words;
    struct stores *stores = calloc(words[3], sizeof *stores);
    uint64_t *iterations = calloc(words[3], sizeof *iterations);
    const struct module m = {module, parameters, stores};
    uint32_t label = 0;
    struct loop loop;
    if (stores && iterations)
        survey(&m);
    SPIRV_EACH(module, at, module->code, stores && iterations ? module->count : module->code)
    {
        if (spirv_is(words + at, SpvOpLabel))
            label = words[at + 1];
        else if (spirv_is(words + at, SpvOpLoopMerge))
            iterations[label] =
                read_loop(&m, module->definitions[label], at, &loop) ? count_turns(&m, &loop) : 1;
    }
    free(stores);
    if (!stores)
        free(iterations);
    return stores ? iterations : NULL;
}
