/* Turns of loops, for `diptych cost`: compilers of GPUs count each loop that they keep as a few turns. A loop is known if
 * its first branch compares a local variable with a number, and nothing but one statement in front of it and one where
 * it goes on stores to the variable. Numbers are constants, parameters, and what is computed of them. */
#include "turns.h"

#include <spirv/unified1/spirv.h>
#include <string.h>

enum { MOST_TURNS = 1 << 20, MOST_DEPTH = 8 };

struct teller {
    const struct spirv *from;
    const struct spirv_block *block;
    uint32_t counter, value; /* a variable, and the number that it holds now */
};

static bool compute(unsigned opcode, uint32_t a, uint32_t b, uint32_t *out)
{
    int32_t x = (int32_t)a, y = (int32_t)b;
    switch (opcode) {
    case SpvOpIAdd:
        return *out = a + b, true;
    case SpvOpISub:
        return *out = a - b, true;
    case SpvOpIMul:
        return *out = a * b, true;
    case SpvOpUDiv:
        return *out = b ? a / b : 0, b;
    case SpvOpSDiv:
        return *out = y > 0 ? (uint32_t)(x / y) : 0, y > 0;
    case SpvOpShiftLeftLogical:
        return *out = a << (b & 31), true;
    case SpvOpShiftRightLogical:
        return *out = a >> (b & 31), true;
    case SpvOpShiftRightArithmetic:
        return *out = (uint32_t)(x >> (b & 31)), true;
    case SpvOpINotEqual:
        return *out = a != b, true;
    case SpvOpUGreaterThan:
        return *out = a > b, true;
    case SpvOpSGreaterThan:
        return *out = x > y, true;
    case SpvOpUGreaterThanEqual:
        return *out = a >= b, true;
    case SpvOpSGreaterThanEqual:
        return *out = x >= y, true;
    case SpvOpULessThan:
        return *out = a < b, true;
    case SpvOpSLessThan:
        return *out = x < y, true;
    case SpvOpULessThanEqual:
        return *out = a <= b, true;
    case SpvOpSLessThanEqual:
        return *out = x <= y, true;
    default:
        return false;
    }
}

/* A 32-bit member of the block of parameters. */
static bool read_parameter(const struct teller *teller, const uint32_t *chain, uint32_t *out)
{
    const struct spirv *m = teller->from;
    const struct spirv_block *block = teller->block;
    const uint32_t *index = spirv_length(chain) == 5 ? spirv_definition(m, chain[4]) : chain;
    if (!spirv_is(index, SpvOpConstant) ||
        spirv_decoration(m, chain[3], SpvDecorationBinding) != block->binding)
        return false;
    uint32_t type = spirv_pointee(m, spirv_definition(m, chain[3]));
    uint32_t offset = spirv_member_decoration(m, type, index[3], SpvDecorationOffset);
    if (block->size < sizeof *out || offset > block->size - sizeof *out)
        return false;
    memcpy(out, (const char *)block->bytes + offset, sizeof *out);
    return true;
}

static bool number_of_id(const struct teller *teller, uint32_t id, uint32_t depth, uint32_t *out)
{
    const uint32_t *i = spirv_definition(teller->from, id);
    uint32_t a, b;
    if (spirv_is(i, SpvOpConstant))
        return *out = i[3], spirv_length(i) == 4;
    if (spirv_is(i, SpvOpLoad) && i[3] == teller->counter)
        return *out = teller->value, true;
    if (spirv_is(i, SpvOpLoad) && spirv_is(spirv_definition(teller->from, i[3]), SpvOpAccessChain))
        return read_parameter(teller, spirv_definition(teller->from, i[3]), out);
    if (spirv_is(i, SpvOpBitcast) && depth < MOST_DEPTH)
        return number_of_id(teller, i[3], depth + 1, out);
    return spirv_length(i) == 5 && depth < MOST_DEPTH &&
           number_of_id(teller, i[3], depth + 1, &a) && number_of_id(teller, i[4], depth + 1, &b) &&
           compute(spirv_opcode(i), a, b, out);
}

/* The variable that a test begins with; 0: none. */
static uint32_t compared(const struct spirv *m, uint32_t test)
{
    const uint32_t *i = spirv_definition(m, test);
    for (uint32_t depth = 0; spirv_length(i) == 5 && depth < MOST_DEPTH; depth++)
        i = spirv_definition(m, i[3]);
    const uint32_t *from = spirv_is(i, SpvOpLoad) ? spirv_definition(m, i[3]) : i;
    return spirv_is(from, SpvOpVariable) && from[3] == SpvStorageClassFunction ? i[3] : 0;
}

/* The value of the condition that ends the loop when it is false, before anything else branches; 0: there is none. */
static uint32_t find_test(const struct spirv *m, size_t merge)
{
    size_t at = merge;
    while (!spirv_is(m->words + at, SpvOpBranchConditional) &&
           !spirv_is(m->words + at, SpvOpSelectionMerge) &&
           !spirv_is(m->words + at, SpvOpFunctionEnd))
        at += m->words[at] >> 16;
    const uint32_t *branch = m->words + at;
    return spirv_is(branch, SpvOpBranchConditional) && branch[3] == m->words[merge + 1] ? branch[1]
                                                                                        : 0;
}

/* The values that are stored to the variable in front of the loop, the last one, and where it goes on. */
static bool find_stores(const struct spirv *m, size_t merge, uint32_t variable, uint32_t *before,
                        uint32_t *again)
{
    size_t next = m->definitions[m->words[merge + 2]], behind = m->definitions[m->words[merge + 1]];
    *before = *again = 0;
    SPIRV_EACH_AT(m, at, m->code, m->count) {
        const uint32_t *i = m->words + at;
        bool uses = false;
        for (uint32_t word = 1; word < spirv_length(i); word++)
            uses |= i[word] == variable && !spirv_is_literal(i, word);
        if (!uses || spirv_is(i, SpvOpVariable) || spirv_is(i, SpvOpLoad) || at > behind)
            continue;
        if (!spirv_is(i, SpvOpStore) || (at > merge && (at < next || *again)))
            return false;
        *(at < merge ? before : again) = i[2];
    }
    return *before && *again;
}

static uint32_t turns_of(const struct spirv *m, const struct spirv_block *block, size_t merge)
{
    struct teller teller = {.from = m, .block = block};
    uint32_t test = find_test(m, merge), before, again, goes_on, turns = 0;
    uint32_t counter = test ? compared(m, test) : 0;
    if (!counter || !find_stores(m, merge, counter, &before, &again))
        return 0;
    number_of_id(&teller, before, 0, &teller.value);
    for (teller.counter = counter; turns <= MOST_TURNS; turns++) {
        if (!number_of_id(&teller, test, 0, &goes_on))
            return 0;
        if (!goes_on)
            return turns;
        if (!number_of_id(&teller, again, 0, &teller.value))
            return 0;
    }
    return 0;
}

/* The innermost of the first `count` loops around the next one; that itself: none. */
static uint32_t find_around(const struct spirv *m, const struct spirv_loop *list, uint32_t count)
{
    for (uint32_t i = count; i-- > 0;)
        if (list[count].merge < m->definitions[m->words[list[i].merge + 1]])
            return i;
    return count;
}

uint32_t spirv_find_loops(const struct spirv *m, const struct spirv_block *block,
                          struct spirv_loop *list, uint32_t most)
{
    uint32_t count = 0;
    SPIRV_EACH_AT(m, at, m->code, m->count) {
        if (!spirv_is(m->words + at, SpvOpLoopMerge) || count == most)
            continue;
        list[count] = (struct spirv_loop){.merge = at, .turns = turns_of(m, block, at)};
        list[count].around = find_around(m, list, count);
        count++;
    }
    return count;
}
