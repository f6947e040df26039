/* A lower bound for the float operations of a shader, counted from its SPIR-V. The reflection holds
 * it, so that `diptych bench` can compare a pass with the device's peak. Called by lower.c. */
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdbool.h>
#include <stdlib.h>

#include "../stages.h"
#include "passes.h"

/* Cost of a path through a function. Paths that leave a loop by `break` or return early are taken
 * only if no other exists. So the cost is that of an invocation that does its work, with the
 * iterations of its loops. */
struct cost {
    uint32_t exits; /* such breaks and early returns */
    uint64_t flops;
};
static const struct cost no_way = {UINT32_MAX, 0};
static const uint64_t MOST_FLOPS = 1ull << 56; /* of a loop; sums of these do not overflow */

enum state { STATE_NEW, STATE_OPEN, STATE_DONE };

struct counting {
    const struct spirv *module;
    /* the next four: arrays by id */
    enum state *states;    /* of blocks and functions */
    struct cost *costs;    /* from a block to the function's end; of a function */
    uint32_t *loop_merges; /* by the loop's header: the block after the loop */
    bool *behind_loop;     /* whether a block follows a loop */
    uint64_t *iterations;  /* of a loop, by its header */
};

/* ---- One instruction ------------------------------------------------------------------------- */

/* Number of floats in a value of the type; 0: not a float type. */
static uint32_t floats_in(const struct counting *c, uint32_t type)
{
    const uint32_t *declared = c->module->words + c->module->definitions[type];

    if (spirv_is(declared, SpvOpTypeFloat))
        return 1;
    if (spirv_is(declared, SpvOpTypeVector) || spirv_is(declared, SpvOpTypeMatrix))
        return floats_in(c, declared[2]) * declared[3];
    return 0;
}

static uint32_t type_of(const struct counting *c, uint32_t id)
{
    return c->module->words[c->module->definitions[id] + 1];
}

/* Operations per component of the result. Functions such as sin count as one, although devices need
 * more; FAbs and FSign count as none. */
static uint32_t library_weight(uint32_t function)
{
    switch (function) {
    case GLSLstd450FAbs:
    case GLSLstd450FSign:
        return 0;
    case GLSLstd450Fma:
    case GLSLstd450FClamp:
        return 2;
    case GLSLstd450FMix:
    case GLSLstd450Cross:
        return 3;
    default:
        return 1;
    }
}

static uint64_t instruction_flops(const struct counting *c, const uint32_t *instruction)
{
    switch (*instruction & 0xffff) {
    case SpvOpFAdd:
    case SpvOpFSub:
    case SpvOpFMul:
    case SpvOpFDiv:
    case SpvOpFRem:
    case SpvOpFMod:
    case SpvOpVectorTimesScalar:
    case SpvOpMatrixTimesScalar:
    case SpvOpOuterProduct:
        return floats_in(c, instruction[1]);
    case SpvOpDot:
        return 2 * floats_in(c, type_of(c, instruction[3])) - 1;
    case SpvOpVectorTimesMatrix:
        return (2 * floats_in(c, type_of(c, instruction[3])) - 1) * floats_in(c, instruction[1]);
    case SpvOpMatrixTimesVector:
        return (2 * floats_in(c, type_of(c, instruction[4])) - 1) * floats_in(c, instruction[1]);
    case SpvOpMatrixTimesMatrix: {
        const uint32_t *left =
            c->module->words + c->module->definitions[type_of(c, instruction[3])];

        return (uint64_t)(2 * left[3] - 1) * floats_in(c, instruction[1]);
    }
    case SpvOpExtInst:
        return (uint64_t)library_weight(instruction[4]) * floats_in(c, instruction[1]);
    default:
        return 0;
    }
}

/* ---- Paths through functions ----------------------------------------------------------------- */

static struct cost block_cost(struct counting *c, uint32_t label);

static struct cost cheaper(struct cost a, struct cost b)
{
    if (a.exits != b.exits)
        return a.exits < b.exits ? a : b;
    return a.flops < b.flops ? a : b;
}

/* Cost from a jump to `label` on. The jump back to a loop's header ends an iteration. */
static struct cost jump_cost(struct counting *c, uint32_t label)
{
    if (c->states[label] == STATE_OPEN)
        return c->loop_merges[label] ? block_cost(c, c->loop_merges[label]) : no_way;
    struct cost cost = block_cost(c, label);

    cost.exits += c->behind_loop[label] && cost.exits < UINT32_MAX;
    return cost;
}

/* Cost from a block's last instruction on. */
static struct cost end_cost(struct counting *c, const uint32_t *instruction)
{
    uint32_t length = *instruction >> 16;
    struct cost cost = no_way;

    switch (*instruction & 0xffff) {
    case SpvOpBranch:
        return jump_cost(c, instruction[1]);
    case SpvOpBranchConditional:
        return cheaper(jump_cost(c, instruction[2]), jump_cost(c, instruction[3]));
    case SpvOpSwitch:
        cost = jump_cost(c, instruction[2]);
        for (uint32_t i = 4; i < length; i += 2)
            cost = cheaper(cost, jump_cost(c, instruction[i]));
        return cost;
    case SpvOpUnreachable:
        return no_way;
    default: /* the invocation or the function ends; early unless in the last block */
        return (struct cost){.exits = !spirv_is(instruction + length, SpvOpFunctionEnd)};
    }
}

/* Cost from a loop's header on. once: with one iteration. */
static struct cost loop_cost(struct counting *c, uint32_t header, struct cost once)
{
    uint64_t turns = c->iterations[header];

    if (turns == 1)
        return once;
    uint64_t behind = block_cost(c, c->loop_merges[header]).flops;
    uint64_t turn = once.flops > behind ? once.flops - behind : 0;

    if (turn && turns > MOST_FLOPS / turn)
        return (struct cost){once.exits, MOST_FLOPS};
    return (struct cost){once.exits, behind + turns * turn};
}

static struct cost function_cost(struct counting *c, uint32_t function);

/* Cost from the start of a block to the end of its function. */
static struct cost block_cost(struct counting *c, uint32_t label)
{
    uint64_t flops = 0;
    size_t at = c->module->definitions[label];

    if (c->states[label] == STATE_DONE)
        return c->costs[label];
    c->states[label] = STATE_OPEN;
    for (; !spirv_ends_block(c->module->words + at); at += c->module->words[at] >> 16) {
        const uint32_t *instruction = c->module->words + at;

        flops += spirv_is(instruction, SpvOpFunctionCall) ? function_cost(c, instruction[3]).flops
                                                          : instruction_flops(c, instruction);
    }
    struct cost cost = end_cost(c, c->module->words + at);

    cost.flops += flops;
    if (c->loop_merges[label])
        cost = loop_cost(c, label, cost);
    c->costs[label] = cost;
    c->states[label] = STATE_DONE;
    return cost;
}

static struct cost function_cost(struct counting *c, uint32_t function)
{
    size_t at = c->module->definitions[function];

    if (c->states[function] != STATE_DONE) {
        while (!spirv_is(c->module->words + at, SpvOpLabel))
            at += c->module->words[at] >> 16;
        c->costs[function] = block_cost(c, c->module->words[at + 1]);
        c->states[function] = STATE_DONE;
    }
    return c->costs[function];
}

/* ---- The module ------------------------------------------------------------------------------ */

/* Finds the loops; returns the entry point's function. */
static uint32_t survey(struct counting *c)
{
    uint32_t entry = 0, label = 0;

    for (size_t at = SPIRV_HEADER; at < c->module->count; at += c->module->words[at] >> 16) {
        const uint32_t *instruction = c->module->words + at;

        if (spirv_is(instruction, SpvOpEntryPoint)) {
            entry = instruction[2];
        } else if (spirv_is(instruction, SpvOpLabel)) {
            label = instruction[1];
        } else if (spirv_is(instruction, SpvOpLoopMerge)) {
            c->loop_merges[label] = instruction[1];
            c->behind_loop[instruction[1]] = true;
        }
    }
    return entry;
}

bool count_flops(const struct shader *shader, const struct parameter_values *parameters,
                 uint64_t *flops)
{
    struct spirv module = {0};
    *flops = 0;
    if (!shader->word_count)
        return true;
    if (!spirv_open(&module, shader->words, shader->word_count))
        return false;
    uint32_t bound = module.words[3];
    struct counting c = {.module = &module,
                         .states = calloc(bound, sizeof *c.states),
                         .costs = calloc(bound, sizeof *c.costs),
                         .loop_merges = calloc(bound, sizeof *c.loop_merges),
                         .behind_loop = calloc(bound, sizeof *c.behind_loop),
                         .iterations = spirv_iterations(&module, parameters)};
    bool good = c.iterations && c.states && c.costs && c.loop_merges && c.behind_loop;

    if (good)
        *flops = function_cost(&c, survey(&c)).flops;
    spirv_free(&module);
    free(c.states);
    free(c.costs);
    free(c.loop_merges);
    free(c.behind_loop);
    free(c.iterations);
    return good;
}
