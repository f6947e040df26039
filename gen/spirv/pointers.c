/* Where in memory the operations of a shader read and store, for content.c and race.c: the resource or `shared` variable behind a
 * pointer or image, and the word or texel in it. Words of buffers have the places of their layout; a `shared` variable has
 * none, so its scalars are numbered. */
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>

#include "glsl/glsl.h"
#include "sanitizer.h"

/* ---- Memory ---------------------------------------------------------------------------------- */

uint32_t memory_base(const struct spirv *from, uint32_t id)
{
    for (;;) {
        const uint32_t *i = spirv_definition(from, id);
        if (!spirv_is(i, SpvOpAccessChain) && !spirv_is(i, SpvOpLoad) && !spirv_is(i, SpvOpImage) &&
            !spirv_is(i, SpvOpSampledImage) && !spirv_is(i, SpvOpImageTexelPointer))
            return id;
        id = i[3];
    }
}

/* The argument that all calls pass for a parameter; 0: they differ. */
static uint32_t argument_of(const struct spirv *from, uint32_t parameter)
{
    uint32_t argument = 0, function, index = spirv_parameter_index(from, parameter, &function);
    SPIRV_EACH(from, i, from->code, from->count) {
        if (!spirv_is(i, SpvOpFunctionCall) || i[3] != function)
            continue;
        uint32_t own = memory_base(from, i[4 + index]);
        if (argument && argument != own)
            return 0;
        argument = own;
    }
    return argument;
}

struct memory memory_of(const struct sanitizer *s, uint32_t id)
{
    const struct spirv *from = s->from;
    const struct pass *pass = s->request->pass;
    struct memory memory = {memory_base(from, id), NULL};
    for (int depth = 0; depth < 8 && memory.variable; depth++) {
        const uint32_t *i = spirv_definition(from, memory.variable);
        if (!spirv_is(i, SpvOpFunctionParameter))
            break;
        const uint32_t *type = spirv_definition(from, i[1]);
        bool image = spirv_is(type, SpvOpTypePointer) && type[2] == SpvStorageClassUniformConstant;
        memory.variable = image ? argument_of(from, memory.variable) : 0;
    }
    const uint32_t *i = spirv_definition(from, memory.variable);
    if (!memory.variable || !spirv_is(i, SpvOpVariable))
        return (struct memory){0};
    if (i[3] == SpvStorageClassWorkgroup)
        return memory;
    uint32_t binding = spirv_decoration(from, memory.variable, SpvDecorationBinding);
    for (uint32_t k = 0; k < pass->access_count && binding != UINT32_MAX; k++) {
        const struct access *access = &pass->accesses[k];
        if (access->binding == (int)binding && access->resource && !access->resource->internal)
            memory.access = access;
    }
    return memory.access ? memory : (struct memory){0};
}

/* ---- Words ----------------------------------------------------------------------------------- */

static bool is_shared(const uint32_t *variable)
{
    return spirv_is(variable, SpvOpVariable) && variable[3] == SpvStorageClassWorkgroup;
}

/* Words of the `shared` variables before this one; 0: of all. */
static uint32_t shared_before(const struct spirv *from, uint32_t variable)
{
    uint32_t count = 0;
    SPIRV_EACH(from, i, from->declarations, from->code) {
        if (is_shared(i) && i[2] == variable)
            break;
        count += is_shared(i) ? spirv_scalars(from, spirv_definition(from, i[1])[3]) : 0;
    }
    return count;
}

/* Words between the elements of an array, vector or matrix. matrix: bytes between columns, of the member. */
static uint32_t stride_of(const struct spirv *from, const uint32_t *type, bool shared,
                          uint32_t matrix)
{
    bool array = spirv_is(type, SpvOpTypeArray) || spirv_is(type, SpvOpTypeRuntimeArray);
    if (shared || spirv_is(type, SpvOpTypeVector)) {
        const uint32_t *scalar = spirv_definition(from, type[2]);
        bool wide = !shared && spirv_length(scalar) > 2 && scalar[2] == 64;
        return wide ? 2 : spirv_scalars(from, type[2]);
    }
    return (array ? spirv_decoration(from, type[1], SpvDecorationArrayStride) : matrix) / 4;
}

static uint32_t member_offset(const struct spirv *from, const uint32_t *type, uint32_t member,
                              bool shared)
{
    uint32_t offset = 0;
    if (!shared)
        return spirv_member_decoration(from, type[1], member, SpvDecorationOffset) / 4;
    for (uint32_t k = 0; k < member; k++)
        offset += spirv_scalars(from, type[2 + k]);
    return offset;
}

static uint32_t put_offset(struct sanitizer *s, uint32_t word, uint32_t offset)
{
    return offset ? sanitizer_two(s, SpvOpIAdd, word, sanitizer_number(s, offset)) : word;
}

/* A place while a chain of indices is followed. */
struct step_place {
    uint32_t word;   /* id; 0: `offset` is all */
    uint32_t offset; /* words */
    uint32_t type, matrix;
};

static void step_into(const struct spirv *from, struct step_place *at, uint32_t part, bool shared)
{
    const uint32_t *type = spirv_definition(from, at->type);
    bool member = spirv_is(type, SpvOpTypeStruct);
    at->offset += member ? member_offset(from, type, part, shared)
                         : part * stride_of(from, type, shared, at->matrix);
    if (member)
        at->matrix = spirv_member_decoration(from, type[1], part, SpvDecorationMatrixStride);
    at->type = spirv_part(type, part);
}

static void follow(struct sanitizer *s, struct step_place *at, uint32_t index, bool shared)
{
    const struct spirv *from = s->from;
    const uint32_t *type = spirv_definition(from, at->type), *i = spirv_definition(from, index);
    if (spirv_is(i, SpvOpConstant)) {
        step_into(from, at, i[3], shared);
        return;
    }
    uint32_t stride = stride_of(from, type, shared, at->matrix);
    at->type = type[2];
    uint32_t product = sanitizer_two(s, SpvOpIMul, index, sanitizer_number(s, stride));
    at->word = at->word ? sanitizer_two(s, SpvOpIAdd, at->word, product) : product;
}

/* Chains begin at the variable. */
static void follow_chain(struct sanitizer *s, struct step_place *at, uint32_t pointer, bool shared)
{
    const uint32_t *i = spirv_definition(s->from, pointer);
    if (!spirv_is(i, SpvOpAccessChain)) {
        at->type = spirv_type(s->from, pointer)[3];
        return;
    }
    follow_chain(s, at, i[3], shared);
    for (uint32_t word = 4; word < spirv_length(i); word++)
        follow(s, at, i[word], shared);
}

/* ---- Visits ---------------------------------------------------------------------------------- */

static uint32_t put_part(struct sanitizer *s, uint32_t type, uint32_t value, uint32_t part)
{
    uint32_t shape = value ? content_shape(s, type) : 0;
    return shape ? PUT_VALUE(s, SpvOpCompositeExtract, shape, value, part) : 0;
}

enum { MOST_PARTS = 64 }; /* of a composite that has marks */

static uint32_t visit(struct words *words, const struct step_place *at, uint32_t mark);

/* Part `k` of an array, vector, matrix or struct. */
static uint32_t visit_part(struct words *words, const struct step_place *at, uint32_t k,
                           uint32_t mark)
{
    struct step_place part = *at;
    step_into(words->s->from, &part, k, !words->memory->access);
    return visit(words, &part, put_part(words->s, part.type, mark, k));
}

static uint32_t visit_parts(struct words *words, const struct step_place *at, uint32_t count,
                            uint32_t mark)
{
    struct sanitizer *s = words->s;
    uint32_t parts[MOST_PARTS], shape = content_shape(s, at->type), any = 0;
    for (uint32_t k = 0; k < count; k++) {
        uint32_t own = visit_part(words, at, k, mark);
        if (k < MOST_PARTS)
            parts[k] = own;
        any |= own;
    }
    if (!any || !shape || count > MOST_PARTS)
        return 0;
    const uint32_t *type = spirv_definition(s->from, at->type);
    for (uint32_t k = 0; k < count; k++) {
        uint32_t own = content_shape(s, spirv_part(type, k));
        if (!parts[k])
            parts[k] = spirv_declare(&s->edit, SpvOpConstantNull, own, NULL, 0);
    }
    return spirv_put_value(&s->edit, &s->edit.code, SpvOpCompositeConstruct, shape, parts, count);
}

static uint32_t visit(struct words *words, const struct step_place *at, uint32_t mark)
{
    struct sanitizer *s = words->s;
    const uint32_t *type = spirv_definition(s->from, at->type);
    uint32_t count = spirv_parts(s->from, type);
    if (count)
        return visit_parts(words, at, count, mark);
    if (!spirv_is(type, SpvOpTypeInt) && !spirv_is(type, SpvOpTypeFloat) &&
        !spirv_is(type, SpvOpTypeBool))
        return 0;
    uint32_t word =
        at->word ? put_offset(s, at->word, at->offset) : sanitizer_number(s, at->offset);
    return words->visit(words, word, mark);
}

uint32_t memory_visit(struct words *words, uint32_t pointer, uint32_t mark)
{
    struct step_place at = {.matrix = 0};
    bool shared = !words->memory->access;
    if (shared)
        at.offset = shared_before(words->s->from, words->memory->variable);
    follow_chain(words->s, &at, pointer, shared);
    return visit(words, &at, mark);
}

/* Words from the first to the last of a type. */
static uint32_t extent_of(const struct spirv *from, uint32_t id, bool shared, uint32_t matrix)
{
    const uint32_t *type = spirv_definition(from, id);
    uint32_t most = 0;
    if (shared)
        return spirv_scalars(from, id);
    uint32_t parts = spirv_parts(from, type);
    if (parts && !spirv_is(type, SpvOpTypeStruct))
        return (parts - 1) * stride_of(from, type, false, matrix) +
               extent_of(from, type[2], false, matrix);
    for (uint32_t k = 0; k < parts; k++) {
        uint32_t stride = spirv_member_decoration(from, id, k, SpvDecorationMatrixStride);
        uint32_t end = member_offset(from, type, k, false) +
                       extent_of(from, spirv_part(type, k), false, stride);
        most = end > most ? end : most;
    }
    return parts ? most : spirv_length(type) > 2 && type[2] == 64 ? 2 : 1;
}

uint32_t memory_range(struct sanitizer *s, const struct memory *memory, uint32_t pointer,
                      uint32_t *words)
{
    struct step_place at = {.matrix = 0};
    bool shared = !memory->access;
    if (shared)
        at.offset = shared_before(s->from, memory->variable);
    follow_chain(s, &at, pointer, shared);
    *words = extent_of(s->from, at.type, shared, at.matrix);
    return at.word ? put_offset(s, at.word, at.offset) : sanitizer_number(s, at.offset);
}

/* ---- Calls ----------------------------------------------------------------------------------- */

uint32_t memory_call(struct sanitizer *s, const struct memory *memory, const char *name,
                     const struct values *values)
{
    char mangled[64];
    int length = snprintf(mangled, sizeof mangled, "diptych_%s_%d(", name, memory->access->binding);
    for (uint32_t i = 0; i < values->count; i++)
        length += snprintf(mangled + length, sizeof mangled - (size_t)length, "u1;");
    return sanitizer_call(s, mangled, values);
}

uint32_t memory_at(struct sanitizer *s, const struct memory *memory, uint32_t word)
{
    return memory_call(s, memory, "at", &(struct values){{word}, 1});
}

uint32_t memory_texel(struct sanitizer *s, const struct memory *memory, uint32_t place,
                      uint32_t lod)
{
    struct spirv_edit *edit = &s->edit;
    const uint32_t *type = spirv_type(s->from, place);
    bool vector = spirv_is(type, SpvOpTypeVector);
    uint32_t whole = spirv_declare_scalar(edit, 'i');
    uint32_t three = spirv_declare_vector(edit, whole, 3), p = place;
    uint32_t zero = SPIRV_DECLARE(edit, SpvOpConstant, whole, 0);
    char mangled[64];
    if (!vector)
        p = PUT_VALUE(s, SpvOpCompositeConstruct, three, place, zero, zero);
    else if (type[3] == 2)
        p = PUT_VALUE(s, SpvOpCompositeConstruct, three, place, zero);
    else if (type[3] != 3)
        return 0;
    snprintf(mangled, sizeof mangled, "diptych_at_%d(vi3;i1;", memory->access->binding);
    return sanitizer_call(s, mangled, &(struct values){{p, lod ? lod : zero}, 2});
}

uint32_t memory_cell(struct sanitizer *s, const struct memory *memory, uint32_t at)
{
    if (memory->access)
        return memory_call(s, memory, "cell", &(struct values){{at}, 1});
    struct values values = {{at, sanitizer_number(s, shared_before(s->from, 0))}, 2};
    return sanitizer_call(s, "diptych_shared_cell(u1;u1;", &values);
}

void memory_name(const struct sanitizer *s, const struct memory *memory, struct sanitize_site *site)
{
    const char *name =
        memory->access ? access_word(memory->access) : spirv_name(s->from, memory->variable);
    snprintf(site->name, sizeof site->name, "%s", name && *name ? name : "a shared variable");
    if (memory->access) {
        site->resource = memory->access->resource;
        return;
    }
    const uint32_t *type = spirv_definition(s->from, spirv_type(s->from, memory->variable)[3]);
    site->words = spirv_is(type, SpvOpTypeArray) ? spirv_scalars(s->from, type[2]) : 0;
    site->first = shared_before(s->from, memory->variable);
}

/* ---- Operations ------------------------------------------------------------------------------ */

bool memory_image(const uint32_t *i, struct texel_use *use)
{
    switch (spirv_opcode(i)) {
    case SpvOpImageFetch:
    case SpvOpImageRead:
    case SpvOpImageTexelPointer:
        *use = (struct texel_use){i[3], i[4], 0};
        if (spirv_is(i, SpvOpImageFetch) && spirv_length(i) > 6 &&
            (i[5] & 3) == SpvImageOperandsLodMask)
            use->lod = i[6];
        return true;
    case SpvOpImageWrite:
        *use = (struct texel_use){i[1], i[2], 0};
        return true;
    default:
        return false;
    }
}

uint32_t memory_stored(const struct sanitizer *s, const uint32_t *i)
{
    bool second = spirv_is(i, SpvOpExtInst) && i[3] == s->glsl &&
                  (i[4] == GLSLstd450Modf || i[4] == GLSLstd450Frexp);
    return spirv_is(i, SpvOpStore) ? i[1] : second ? i[6] : 0;
}

bool memory_is_atomic(const uint32_t *instruction, bool *stores)
{
    uint32_t opcode = spirv_opcode(instruction);
    *stores = opcode != SpvOpAtomicLoad;
    return opcode >= SpvOpAtomicLoad && opcode <= SpvOpAtomicXor && opcode != SpvOpAtomicStore;
}
