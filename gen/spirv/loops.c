/* Marks the loops that drivers must not unroll. CPU drivers unroll every short loop of constant
 * length. With many operations per iteration, that multiplies the compile time but does not
 * shorten the frame. */
#include "passes.h"

#include <spirv/unified1/spirv.h>

/* LONG_TURN: fewest operations per iteration of a marked loop. READ: operations that reading a
 * number counts as, because a CPU reads lane by lane. With these, Mesa 22.3 and LLVM 15 compile the
 * second-bounce VPLs of SSVP to half the instructions, k-means to four fifths, at the same speed.
 * Loops of 30 operations that only compute saved little and took up to 1.5 times as long. */
enum { LONG_TURN = 80, READ = 8 };
enum { MAX_CALLS = 16 }; /* GLSL has no recursion; a limit for broken modules */

/* Whether a pointer leads to memory that invocations share. */
static bool pointer_is_shared(const struct spirv *m, uint32_t pointer)
{
    const uint32_t *type = spirv_type(m, pointer);
    return type[2] == SpvStorageClassUniform || type[2] == SpvStorageClassStorageBuffer ||
           type[2] == SpvStorageClassWorkgroup;
}

/* Instructions that only move data count as nothing: they differ between the SPIR-V versions of the
 * backends, and both backends must mark the same loops. */
static uint32_t operations_of(const struct spirv *m, const uint32_t *instruction)
{
    uint32_t opcode = *instruction & 0xffff;
    if ((opcode == SpvOpLoad && pointer_is_shared(m, instruction[3])) ||
        (opcode >= SpvOpImageSampleImplicitLod && opcode <= SpvOpImageRead))
        return READ * spirv_scalars(m, instruction[1]);
    bool computes =
        (opcode >= SpvOpConvertFToU && opcode <= SpvOpBitCount) || opcode == SpvOpExtInst;
    return computes ? spirv_scalars(m, instruction[1]) : 0;
}

/* Operations between two instructions, with called functions; a loop counts as one iteration. */
static uint64_t operations_in(const struct spirv *m, size_t from, size_t to, uint32_t calls)
{
    uint64_t sum = 0;
    for (size_t at = from; at < to; at += m->words[at] >> 16) {
        sum += operations_of(m, m->words + at);
        if (spirv_is(m->words + at, SpvOpFunctionCall) && calls < MAX_CALLS) {
            const struct spirv_function *callee = spirv_function_of(m, m->words[at + 3]);
            sum += operations_in(m, callee->begin, callee->end, calls + 1);
        }
    }
    return sum;
}

/* Whether the loop indexes a private array with a variable. Drivers hold such arrays in registers
 * only if they know the index. */
static bool picks_from_array(const struct spirv *m, size_t from, size_t to)
{
    for (size_t at = from; at < to; at += m->words[at] >> 16) {
        const uint32_t *chain = m->words + at;
        if (!spirv_is(chain, SpvOpAccessChain) || *chain >> 16 < 5)
            continue;
        const uint32_t *base = spirv_definition(m, chain[3]),
                       *index = spirv_definition(m, chain[4]);
        if (spirv_is(base, SpvOpVariable) &&
            (base[3] == SpvStorageClassFunction || base[3] == SpvStorageClassPrivate) &&
            !spirv_is(index, SpvOpConstant))
            return true;
    }
    return false;
}

void spirv_keep_loops(struct spirv *module)
{
    uint32_t *words = module->words;
    size_t behind = 0; /* the last outermost loop */
    SPIRV_EACH(module, at, module->code, module->count)
    {
        if (!spirv_is(words + at, SpvOpLoopMerge) || at < behind)
            continue;
        behind = module->definitions[words[at + 1]];
        uint64_t operations = operations_in(module, at, behind, 0);
        if (operations >= LONG_TURN && words[at + 3] == SpvLoopControlMaskNone &&
            !picks_from_array(module, at, behind))
            words[at + 3] = SpvLoopControlDontUnrollMask;
    }
}
