/* Loops for CPU drivers. Marks those that drivers must not unroll: they unroll every short loop of
 * constant length. With many operations per iteration, that multiplies the compile time but does
 * not shorten the frame. Keeps loops apart where many follow each other. */
#include "passes.h"
#include "turns.h"

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

/* Operations between two instructions, with called functions, where a loop counts as one iteration. Adds
 * loops that are marked. */
static uint64_t operations_in(const struct spirv *m, size_t from, size_t to, uint32_t calls,
                              uint64_t *loops)
{
    uint64_t sum = 0;
    for (size_t at = from; at < to; at += m->words[at] >> 16) {
        sum += operations_of(m, m->words + at);
        *loops += spirv_is(m->words + at, SpvOpLoopMerge) &&
                  m->words[at + 3] == SpvLoopControlDontUnrollMask;
        if (spirv_is(m->words + at, SpvOpFunctionCall) && calls < MAX_CALLS) {
            const struct spirv_function *callee = spirv_function_of(m, m->words[at + 3]);
            sum += operations_in(m, callee->begin, callee->end, calls + 1, loops);
        }
    }
    return sum;
}

uint64_t spirv_operations(const struct spirv *module, uint64_t *loops)
{
    const struct spirv_function *entry = spirv_function_of(module, spirv_entry(module));
    *loops = 0;
    return operations_in(module, entry->begin, entry->end, 0, loops);
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

/* ---- Loops behind each other ----------------------------------------------------------------- */

/* Mesa counts the turns of all loops of a shader in one variable. LLVM 15 follows it from each loop to the one before on
 * several ways, so each further loop doubles its time. A loop around each, of one turn that no compiler knows to be the
 * last, ends that. */
enum { MANY_LOOPS = 8, MOST_PATH = 16 };

struct wrap {
    struct spirv *from;
    struct spirv_edit edit;
    const struct spirv_function *zero; /* diptych_zero() */
    const uint32_t *unknown;           /* without it: how to get at a number in memory */
    size_t only;                       /* offset of the only loop to wrap; 0: all that are marked */
    uint32_t outer, inner, merge, end, again; /* labels of the loop that is copied; 0: none */
};

/* Whether a label's block begins with a value that depends on where it was entered from. */
static bool has_phi(const struct spirv *m, uint32_t label)
{
    return spirv_is(spirv_definition(m, label) + 2, SpvOpPhi);
}

static bool is_wrapped(const struct wrap *wrap, const uint32_t *merge)
{
    return !wrap->outer && spirv_is(merge, SpvOpLoopMerge) && spirv_is(merge - 2, SpvOpLabel) &&
           !has_phi(wrap->from, merge[1]) &&
           (wrap->only ? merge == wrap->from->words + wrap->only
                       : merge[3] == SpvLoopControlDontUnrollMask);
}

/* The old header becomes that of the outer loop, so what is before the loop need not change; nor what is behind. */
static void begin_loop(struct wrap *wrap, const uint32_t *merge)
{
    struct spirv_edit *edit = &wrap->edit;
    wrap->outer = merge[-1], wrap->merge = merge[1];
    wrap->inner = edit->bound++, wrap->end = edit->bound++, wrap->again = edit->bound++;
    SPIRV_PUT(edit, &edit->code, SpvOpLoopMerge, wrap->merge, wrap->again, SpvLoopControlMaskNone);
    SPIRV_PUT(edit, &edit->code, SpvOpBranch, wrap->inner);
    SPIRV_PUT(edit, &edit->code, SpvOpLabel, wrap->inner);
    SPIRV_PUT(edit, &edit->code, SpvOpLoopMerge, wrap->end, merge[2], merge[3]);
}

/* A number that no compiler knows. */
static uint32_t put_unknown(struct wrap *wrap, uint32_t *type)
{
    struct spirv_edit *edit = &wrap->edit;
    if (wrap->zero) {
        *type = spirv_definition(wrap->from, wrap->zero->id)[1];
        return SPIRV_VALUE(edit, &edit->code, SpvOpFunctionCall, *type, wrap->zero->id);
    }
    const uint32_t *chain = wrap->unknown;
    uint32_t path[MOST_PATH] = {chain[3]}, count = spirv_length(chain) - 3;
    for (uint32_t i = 1; i < count; i++) {
        const uint32_t *index = spirv_definition(wrap->from, chain[3 + i]);
        path[i] = spirv_is(index, SpvOpConstant) ? chain[3 + i]
                                                 : SPIRV_DECLARE(edit, SpvOpConstant, index[1], 0);
    }
    *type = spirv_definition(wrap->from, chain[1])[3];
    uint32_t from = spirv_put_value(edit, &edit->code, SpvOpAccessChain, chain[1], path, count);
    return SPIRV_VALUE(edit, &edit->code, SpvOpLoad, *type, from);
}

static void end_loop(struct wrap *wrap)
{
    struct spirv_edit *edit = &wrap->edit;
    uint32_t type;
    uint32_t truth = spirv_declare_scalar(edit, 'b');
    SPIRV_PUT(edit, &edit->code, SpvOpLabel, wrap->end);
    SPIRV_PUT(edit, &edit->code, SpvOpBranch, wrap->again);
    SPIRV_PUT(edit, &edit->code, SpvOpLabel, wrap->again);
    uint32_t number = put_unknown(wrap, &type);
    uint32_t none = SPIRV_DECLARE(edit, SpvOpConstant, type, 0);
    uint32_t turns = SPIRV_VALUE(edit, &edit->code, SpvOpINotEqual, truth, number, none);
    SPIRV_PUT(edit, &edit->code, SpvOpBranchConditional, turns, wrap->outer, wrap->merge);
    wrap->outer = 0;
}

static void copy_in_loop(struct wrap *wrap, const uint32_t *instruction)
{
    struct spirv_words *code = &wrap->edit.code;
    uint32_t opcode = spirv_opcode(instruction);
    spirv_copy(&wrap->edit, code, instruction);
    if (!wrap->outer || (opcode != SpvOpPhi && (opcode < SpvOpBranch || opcode > SpvOpSwitch)))
        return;
    uint32_t *copy = code->data + code->count - spirv_length(instruction);
    for (uint32_t word = 1; !wrap->edit.failed && word < spirv_length(instruction); word++)
        if (!spirv_is_literal(instruction, word))
            copy[word] = copy[word] == wrap->outer   ? wrap->inner
                         : copy[word] == wrap->merge ? wrap->end
                                                     : copy[word];
}

static bool wrap_them(struct wrap *chosen, struct spirv *module)
{
    struct wrap wrap = *chosen;
    spirv_edit_begin(&wrap.edit, module);
    spirv_edit_annotations(&wrap.edit);
    SPIRV_EACH(module, instruction, module->code, module->count) {
        if (wrap.outer && spirv_is(instruction, SpvOpLabel) && instruction[1] == wrap.merge)
            end_loop(&wrap);
        if (is_wrapped(&wrap, instruction))
            begin_loop(&wrap, instruction);
        else
            copy_in_loop(&wrap, instruction);
    }
    return spirv_edit_end(&wrap.edit, module);
}

static bool wrap_loops(struct spirv *module)
{
    struct wrap wrap = {.from = module, .zero = spirv_find_function(module, "diptych_zero(")};
    uint64_t loops;
    spirv_operations(module, &loops);
    return loops < MANY_LOOPS || !wrap.zero || wrap_them(&wrap, module);
}

/* How the module gets at an integer in a uniform block or a buffer; NULL: nowhere. */
static const uint32_t *find_unknown(const struct spirv *m)
{
    SPIRV_EACH(m, chain, m->code, m->count) {
        if (!spirv_is(chain, SpvOpAccessChain))
            continue;
        const uint32_t *pointer = spirv_definition(m, chain[1]);
        if (spirv_is(spirv_definition(m, pointer[3]), SpvOpTypeInt) &&
            spirv_length(chain) - 3 <= MOST_PATH &&
            (pointer[2] == SpvStorageClassUniform || pointer[2] == SpvStorageClassStorageBuffer))
            return chain;
    }
    return NULL;
}

bool spirv_keep_loop(struct spirv *module, size_t merge, bool wrapped)
{
    struct wrap wrap = {.from = module, .unknown = find_unknown(module), .only = merge};
    module->words[merge + 3] = SpvLoopControlDontUnrollMask;
    return !wrapped ||
           (wrap.unknown && is_wrapped(&wrap, module->words + merge) && wrap_them(&wrap, module));
}

bool spirv_keep_loops(struct spirv *module)
{
    uint32_t *words = module->words;
    size_t behind = 0; /* the last outermost loop */
    SPIRV_EACH_AT(module, at, module->code, module->count) {
        if (!spirv_is(words + at, SpvOpLoopMerge) || at < behind)
            continue;
        behind = module->definitions[words[at + 1]];
        uint64_t loops = 0, operations = operations_in(module, at, behind, 0, &loops);
        if (operations >= LONG_TURN && words[at + 3] == SpvLoopControlMaskNone &&
            !picks_from_array(module, at, behind))
            words[at + 3] = SpvLoopControlDontUnrollMask;
    }
    return wrap_loops(module);
}
