/* --sanitize=flow: invocations that must come to an operation together, in the same turns of its loops and by the same calls.
 * Those of a workgroup come to a barrier, see race.c. A derivative is a difference between the four invocations of a quad, and so is the level
 * of detail of most sampling.
 * For each operation an invocation keeps a number, made of all its comings there. Behind the body, where the quad is together
 * again, the derivative of that number is zero unless the invocations parted (templates/glsl/quads.glsl). So `discard` of main()
 * returns first, and is done behind the comparison. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>

#include "prove.h"
#include "sanitizer.h"

struct quad {                /* an operation */
    uint32_t number, caller; /* variables; caller: of generated text, 0: none */
    uint32_t site;
};
enum { QUAD_WORDS = sizeof(struct quad) / sizeof(uint32_t) };
struct quads {
    bool fragment;
    bool *meets;   /* by id of a function: a call of it may come to such an operation */
    uint32_t path; /* variable: the calls that led here */
    uint32_t
        discard; /* variable: 1 in an invocation that is discarded, which drivers may run on; 0: none is */
    uint32_t before, calls;
};

/* The word of an operation that takes a derivative; NULL: it takes none. */
static const char *word_of(const uint32_t *instruction)
{
    uint32_t opcode = spirv_opcode(instruction);
    bool implicit = opcode == SpvOpImageSampleImplicitLod ||
                    opcode == SpvOpImageSampleDrefImplicitLod ||
                    opcode == SpvOpImageSampleProjImplicitLod ||
                    opcode == SpvOpImageSampleProjDrefImplicitLod || opcode == SpvOpImageQueryLod;
    return implicit || (opcode >= SpvOpDPdx && opcode <= SpvOpFwidthCoarse)
               ? prove_word(instruction, 0)
               : NULL;
}

static bool is_kill(const uint32_t *instruction)
{
    return spirv_is(instruction, SpvOpKill) || spirv_is(instruction, SpvOpTerminateInvocation);
}

/* Whether invocations must come here together. */
static bool is_meeting(const struct sanitizer *s, const uint32_t *i)
{
    return s->quads->fragment ? word_of(i) != NULL : race_is_barrier(s->from, i);
}

/* ---- Which functions ------------------------------------------------------------------------- */

static bool find_in(const struct sanitizer *s, const struct spirv_function *function)
{
    bool *own = &s->quads->meets[function->id], before = *own;
    if (sanitizer_is_check(s->from, function))
        return false;
    SPIRV_EACH(s->from, i, function->begin, function->end)
        *own |= is_meeting(s, i) || (spirv_is(i, SpvOpFunctionCall) && s->quads->meets[i[3]]);
    return *own != before;
}

void quads_begin(struct sanitizer *s)
{
    const struct spirv *from = s->from;
    s->quads = spirv_edit_alloc(&s->edit, 1, sizeof *s->quads);
    bool *meets = spirv_edit_table(&s->edit, sizeof *meets);
    if (s->edit.failed)
        return;
    s->quads->meets = meets;
    s->quads->fragment = spirv_entry_point(from)[1] == SpvExecutionModelFragment;
    bool changed = s->request->kinds & SANITIZE_FLOW;
    while (changed) {
        changed = false;
        EACH(function, from->functions, from->function_count)
            changed |= find_in(s, function);
    }
    SPIRV_EACH(from, i, from->code, from->count)
        if (is_kill(i) && meets[spirv_entry(from)] && !s->quads->discard)
            s->quads->discard = sanitizer_variable(s);
}

bool quads_count_turns(const struct sanitizer *s)
{
    return s->function && s->quads->meets[s->function];
}

/* ---- Numbers --------------------------------------------------------------------------------- */

/* a * 257 + b. */
static uint32_t put_joined(struct sanitizer *s, uint32_t a, uint32_t b)
{
    uint32_t product = sanitizer_two(s, SpvOpIMul, a, sanitizer_number(s, 257));
    return sanitizer_two(s, SpvOpIAdd, product, b);
}

/* The calls that led here, and the turns of the loops around, which stand before it and end behind it. */
uint32_t quads_path(struct sanitizer *s, size_t place)
{
    const struct spirv *from = s->from;
    size_t begin = from->definitions[s->function];
    uint32_t path, label = 0;
    if (!s->quads->path)
        s->quads->path = sanitizer_variable(s);
    path = sanitizer_load(s, s->quads->path);
    SPIRV_EACH(from, i, begin, place) {
        label = spirv_is(i, SpvOpLabel) ? i[1] : label;
        if (spirv_is(i, SpvOpLoopMerge) && from->definitions[i[1]] > place && s->counters[label])
            path = put_joined(s, path, sanitizer_load(s, s->counters[label]));
    }
    return path;
}

/* The number after one more coming; the same in an invocation that is discarded. */
static uint32_t put_next(struct sanitizer *s, uint32_t variable, size_t place)
{
    uint32_t path = quads_path(s, place), before = sanitizer_load(s, variable);
    uint32_t once = sanitizer_two(s, SpvOpIAdd, path, sanitizer_number(s, 1));
    uint32_t next = put_joined(s, before, once);
    if (!s->quads->discard)
        return next;
    uint32_t alive = PUT_VALUE(s, SpvOpIEqual, sanitizer_bool(s),
                               sanitizer_load(s, s->quads->discard), sanitizer_number(s, 0));
    return PUT_VALUE(s, SpvOpSelect, sanitizer_uint(s), alive, next, before);
}

static void put_operation(struct sanitizer *s, const char *word, size_t place)
{
    uint32_t caller = s->file ? 0 : sanitizer_caller(s);
    s->kind = SANITIZE_FLOW;
    const struct quad quad = {
        sanitizer_variable(s), caller ? sanitizer_variable(s) : 0,
        sanitizer_site(s, word, "", "some invocations of the quad do not reach this derivative")};
    spirv_append(&s->edit, &s->meetings, (const uint32_t *)&quad, QUAD_WORDS);
    if (caller)
        PUT(s, SpvOpStore, quad.caller, sanitizer_load(s, caller));
    uint32_t next = put_next(s, quad.number, place);
    PUT(s, SpvOpStore, quad.number, next);
}

void quads_before(struct sanitizer *s, size_t place)
{
    const uint32_t *i = s->from->words + place;
    if (!quads_count_turns(s))
        return;
    if (word_of(i) && s->quads->fragment) {
        put_operation(s, word_of(i), place);
    } else if (spirv_is(i, SpvOpFunctionCall) && s->quads->meets[i[3]]) {
        uint32_t path = quads_path(s, place);
        s->quads->before = sanitizer_load(s, s->quads->path);
        path = put_joined(s, path, sanitizer_number(s, ++s->quads->calls));
        PUT(s, SpvOpStore, s->quads->path, path);
    }
}

bool quads_discard(struct sanitizer *s, const uint32_t *i)
{
    if (!is_kill(i) || !s->quads->discard)
        return false;
    PUT(s, SpvOpStore, s->quads->discard, sanitizer_number(s, 1));
    if (s->function != spirv_entry(s->from))
        return false;
    spirv_put(&s->edit, &s->edit.code, SpvOpReturn, NULL, 0);
    return true;
}

void quads_after(struct sanitizer *s, const uint32_t *i)
{
    if (quads_count_turns(s) && spirv_is(i, SpvOpFunctionCall) && s->quads->meets[i[3]])
        PUT(s, SpvOpStore, s->quads->path, s->quads->before);
}

/* ---- Behind the body ------------------------------------------------------------------------- */

static void put_quad(struct sanitizer *s, const struct quad *quad)
{
    struct values values = {{sanitizer_load(s, quad->number)}, 1};
    s->kind = SANITIZE_FLOW;
    values.ids[values.count++] =
        quad->caller ? sanitizer_load(s, quad->caller) : sanitizer_number(s, quad->site);
    values.ids[values.count++] = sanitizer_what(s, quad->site);
    sanitizer_call(s, "diptych_quad(u1;u1;u1;", &values);
}

/* What has returned to be compared is discarded. */
static void put_discard(struct sanitizer *s)
{
    uint32_t discard = sanitizer_load(s, s->quads->discard);
    spirv_put_discard(
        &s->edit, PUT_VALUE(s, SpvOpINotEqual, sanitizer_bool(s), discard, sanitizer_number(s, 0)));
}

void quads_end(struct sanitizer *s)
{
    const struct spirv_function *function = spirv_find_function(s->from, "diptych_quads(");
    if (!function)
        return;
    spirv_copy(&s->edit, &s->edit.code, s->from->words + function->begin);
    uint32_t label = s->edit.bound++;
    PUT(s, SpvOpLabel, label);
    for (size_t at = 0; at < s->meetings.count; at += QUAD_WORDS)
        put_quad(s, (const struct quad *)(s->meetings.data + at));
    if (s->quads->discard)
        put_discard(s);
    spirv_put(&s->edit, &s->edit.code, SpvOpReturn, NULL, 0);
    spirv_put(&s->edit, &s->edit.code, SpvOpFunctionEnd, NULL, 0);
}
