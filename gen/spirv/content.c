/* --sanitize=content: values from memory that nothing has written, where they reach a store, a condition or an index. Each value
 * that may come from such memory has a mark beside it (templates/glsl/shadow.glsl): uint for each scalar, in the same vectors,
 * arrays and structs. What computes with values takes the greatest of their marks; variables, parameters and results of
 * functions have variables of marks. A first search finds which may have any: the others cost nothing. This is the shadow
 * propagation of MemorySanitizer. */
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <string.h>

#include "glsl/glsl.h"
#include "sanitizer.h"

struct marked {      /* of an id */
    bool may;        /* values, variables, functions: some of it may be unwritten */
    int8_t reads;    /* variables: 1 if reads are checked, -1 if not; 0: not asked yet */
    uint32_t mark;   /* values: 0 where all is written */
    uint32_t shape;  /* types */
    uint32_t holder; /* variables, parameters, functions: the variable of their marks */
};

struct content {
    struct marked *ids;
    bool merges; /* a selection begins: the branch is next */
};
enum { FIRST_NUMBER = 2, LAST_NUMBER = 1023 };

static bool is_on(const struct sanitizer *s)
{
    return s->request->kinds & SANITIZE_CONTENT;
}

/* ---- Types ----------------------------------------------------------------------------------- */

static uint32_t declare_new(struct sanitizer *s, uint32_t opcode, const uint32_t *operands,
                            size_t count)
{
    uint32_t words[2 + 64], id = s->edit.bound++;
    words[0] = id;
    memcpy(words + 1, operands, count * sizeof *operands);
    spirv_put(&s->edit, &s->edit.declarations, opcode, words, count + 1);
    return id;
}

static uint32_t make_shape(struct sanitizer *s, const uint32_t *type)
{
    uint32_t parts[64], count = 0;
    switch (spirv_opcode(type)) {
    case SpvOpTypeBool:
    case SpvOpTypeInt:
    case SpvOpTypeFloat:
        return sanitizer_uint(s);
    case SpvOpTypeVector:
        return spirv_declare_vector(&s->edit, sanitizer_uint(s), type[3]);
    case SpvOpTypeMatrix:
    case SpvOpTypeArray:
        parts[0] = content_shape(s, type[2]);
        parts[1] = spirv_is(type, SpvOpTypeArray) ? type[3] : sanitizer_number(s, type[3]);
        return parts[0] ? declare_new(s, SpvOpTypeArray, parts, 2) : 0;
    case SpvOpTypeStruct:
        for (uint32_t k = 2; k < spirv_length(type) && count < 64; k++) {
            parts[count] = content_shape(s, type[k]);
            if (!parts[count++])
                return 0;
        }
        return spirv_length(type) - 2 <= 64 ? declare_new(s, SpvOpTypeStruct, parts, count) : 0;
    default:
        return 0;
    }
}

uint32_t content_shape(struct sanitizer *s, uint32_t type)
{
    struct marked *of = &s->content->ids[type];
    if (!of->shape)
        of->shape = make_shape(s, spirv_definition(s->from, type));
    return of->shape;
}

static uint32_t put_null(struct sanitizer *s, uint32_t type)
{
    return spirv_declare(&s->edit, SpvOpConstantNull, content_shape(s, type), NULL, 0);
}

static uint32_t pointer_type(struct sanitizer *s, uint32_t shape)
{
    return SPIRV_DECLARE(&s->edit, SpvOpTypePointer, 0, SpvStorageClassPrivate, shape);
}

/* What a pointer leads to; else the type itself. */
static uint32_t pointed_type(const struct spirv *from, uint32_t type)
{
    const uint32_t *i = spirv_definition(from, type);
    return spirv_is(i, SpvOpTypePointer) ? i[3] : type;
}

/* The variable of marks of a variable, parameter or function; 0: it may have none. */
static uint32_t holder_of(struct sanitizer *s, uint32_t id)
{
    struct marked *of = &s->content->ids[id];
    uint32_t type = pointed_type(s->from, spirv_definition(s->from, id)[1]);
    if (!of->may || of->holder || !content_shape(s, type))
        return of->holder;
    uint32_t pointer = pointer_type(s, content_shape(s, type)), null = put_null(s, type);
    of->holder = s->edit.bound++;
    SPIRV_PUT(&s->edit, &s->edit.declarations, SpvOpVariable, pointer, of->holder,
              SpvStorageClassPrivate, null);
    spirv_append(&s->edit, &s->variables, &of->holder, 1);
    return of->holder;
}

/* ---- Which values may be unwritten ----------------------------------------------------------- */

/* Function and private variables, and parameters that point to them. */
static bool is_local(const struct spirv *from, uint32_t variable)
{
    const uint32_t *type = spirv_type(from, variable);
    return spirv_is(type, SpvOpTypePointer) &&
           (type[2] == SpvStorageClassFunction || type[2] == SpvStorageClassPrivate);
}

/* Whether reads through a pointer or of an image are checked. */
static bool is_read(struct sanitizer *s, uint32_t id)
{
    uint32_t base = memory_base(s->from, id);
    struct marked *of = &s->content->ids[base];
    if (!of->reads) {
        struct memory memory = memory_of(s, id);
        char name[48] = "diptych_shared_read(u1;u1;u1;";
        if (memory.access)
            snprintf(name, sizeof name, "diptych_read_%d(u1;u1;", memory.access->binding);
        of->reads = memory.variable && sanitizer_has(s, name) ? 1 : -1;
    }
    return of->reads > 0;
}

static bool set_may(struct sanitizer *s, uint32_t id, bool may)
{
    bool changed = may && !s->content->ids[id].may;
    s->content->ids[id].may |= may;
    return changed;
}

static bool may_be(const struct sanitizer *s, uint32_t id)
{
    return s->content->ids[id].may;
}

static bool propagate_call(struct sanitizer *s, const uint32_t *call)
{
    bool changed = set_may(s, call[2], may_be(s, call[3]));
    for (uint32_t word = 4; word < spirv_length(call); word++) {
        uint32_t parameter = spirv_parameter(s->from, call[3], word - 4)[2];
        uint32_t argument = memory_base(s->from, call[word]);
        if (!is_local(s->from, parameter))
            argument = call[word];
        else
            changed |= set_may(s, argument, may_be(s, parameter));
        changed |= set_may(s, parameter, may_be(s, argument));
    }
    return changed;
}

/* Whether any operand of the instruction may be unwritten. */
static bool any_operand(const struct sanitizer *s, const uint32_t *i)
{
    uint32_t result = spirv_result_word(i);
    for (uint32_t word = result + 1; word < spirv_length(i); word++)
        if (!spirv_is_literal(i, word) && i[word] < s->from->words[3] && may_be(s, i[word]))
            return true;
    return false;
}

static bool propagate_one(struct sanitizer *s, uint32_t function, const uint32_t *i)
{
    bool stores;
    uint32_t result = spirv_result(i), base, pointer = memory_stored(s, i);
    if (pointer) {
        bool changed = result && set_may(s, result, may_be(s, i[5]));
        base = memory_base(s->from, pointer);
        return (is_local(s->from, base) && set_may(s, base, may_be(s, i[result ? 5 : 2]))) ||
               changed;
    }
    switch (spirv_opcode(i)) {
    case SpvOpReturnValue:
        return set_may(s, function, may_be(s, i[1]));
    case SpvOpFunctionCall:
        return propagate_call(s, i);
    case SpvOpLoad:
        base = memory_base(s->from, i[3]);
        return set_may(s, result, is_local(s->from, base) ? may_be(s, base) : is_read(s, i[3]));
    case SpvOpImageRead:
    case SpvOpImageFetch:
        return set_may(s, result, is_read(s, i[3]));
    case SpvOpAccessChain:
    case SpvOpVariable:
    case SpvOpArrayLength:
    case SpvOpImage:
    case SpvOpSampledImage:
    case SpvOpImageTexelPointer:
        return false;
    default:
        if (!result || spirv_result_word(i) < 2)
            return false;
        if (memory_is_atomic(i, &stores))
            return set_may(s, result, is_read(s, i[3]));
        return set_may(s, result, any_operand(s, i));
    }
}

static void propagate_all(struct sanitizer *s)
{
    const struct spirv *from = s->from;
    for (bool changed = true; changed;) {
        changed = false;
        EACH(function, from->functions, from->function_count) {
            if (sanitizer_is_check(from, function))
                continue;
            SPIRV_EACH(from, i, function->begin, function->end)
                changed |= propagate_one(s, function->id, i);
        }
    }
}

void content_begin(struct sanitizer *s)
{
    s->content = spirv_edit_alloc(&s->edit, 1, sizeof *s->content);
    if (!s->content)
        return;
    s->content->ids = spirv_edit_table(&s->edit, sizeof *s->content->ids);
    if (is_on(s) && !s->edit.failed)
        propagate_all(s);
}

/* ---- Marks ----------------------------------------------------------------------------------- */

static uint32_t mark_of(const struct sanitizer *s, uint32_t id)
{
    return id < s->from->words[3] ? s->content->ids[id].mark : 0;
}

/* Its mark, or that of a value that is written. */
static uint32_t sure_mark(struct sanitizer *s, uint32_t id)
{
    uint32_t mark = mark_of(s, id);
    return mark ? mark : put_null(s, spirv_definition(s->from, id)[1]);
}

static uint32_t put_max(struct sanitizer *s, uint32_t shape, uint32_t a, uint32_t b)
{
    return a && b ? PUT_VALUE(s, SpvOpExtInst, shape, s->glsl, GLSLstd450UMax, a, b) : a ? a : b;
}

/* The greatest mark of a value's scalars. */
static uint32_t put_reduced(struct sanitizer *s, uint32_t type, uint32_t mark)
{
    const uint32_t *i = spirv_definition(s->from, type);
    uint32_t count = spirv_parts(s->from, i), all = 0;
    if (!count || !mark)
        return mark;
    for (uint32_t k = 0; k < count; k++) {
        uint32_t part =
            PUT_VALUE(s, SpvOpCompositeExtract, content_shape(s, spirv_part(i, k)), mark, k);
        all = put_max(s, sanitizer_uint(s), all, put_reduced(s, spirv_part(i, k), part));
    }
    return all;
}

/* The mark of a value all of whose scalars have this one. */
static uint32_t put_splat(struct sanitizer *s, uint32_t type, uint32_t mark)
{
    const uint32_t *i = spirv_definition(s->from, type);
    uint32_t count = spirv_parts(s->from, i), parts[64], shape = content_shape(s, type);
    if (!count || !mark || !shape || count > 64)
        return count || !shape ? 0 : mark;
    for (uint32_t k = 0; k < count; k++)
        parts[k] = put_splat(s, spirv_part(i, k), mark);
    return spirv_put_value(&s->edit, &s->edit.code, SpvOpCompositeConstruct, shape, parts, count);
}

/* A value reaches a store, a condition or an index. */
static void put_use(struct sanitizer *s, uint32_t id)
{
    if (mark_of(s, id)) {
        uint32_t type = spirv_definition(s->from, id)[1];
        struct values values = {{put_reduced(s, type, mark_of(s, id))}, 1};
        sanitizer_call(s, "diptych_use(u1;", &values);
    }
}

/* ---- Reads and stores ------------------------------------------------------------------------ */

/* word: in the author's text, if it is not the memory's name. Reads beyond LAST_NUMBER share the last site. */
static uint32_t add_number(struct sanitizer *s, const struct memory *memory, const char *word)
{
    struct spirv_words *sites = &s->numbers;
    struct sanitize_site site = {.file = 0};
    if (sites->count > LAST_NUMBER - FIRST_NUMBER)
        return LAST_NUMBER;
    memory_name(s, memory, &site);
    bool frame = memory->access && !memory->access->resource->history;
    snprintf(site.text, sizeof site.text, "@0e was never written%s%s",
             frame ? " in this frame" : "",
             sites->count == LAST_NUMBER - FIRST_NUMBER ? ", or what a later read gave" : "");
    if (word)
        snprintf(site.name, sizeof site.name, "%s", word);
    s->kind = SANITIZE_CONTENT;
    uint32_t id = sanitizer_add(s, &site);
    spirv_append(&s->edit, sites, &id, 1);
    return FIRST_NUMBER + (uint32_t)sites->count - 1;
}

static uint32_t visit_read(struct words *words, uint32_t word, uint32_t mark)
{
    struct sanitizer *s = words->s;
    (void)mark;
    if (!words->memory->access) {
        struct values values = {{memory_cell(s, words->memory, word), word, words->number}, 3};
        return sanitizer_call(s, "diptych_shared_read(u1;u1;u1;", &values);
    }
    struct values values = {{memory_at(s, words->memory, word), words->number}, 2};
    return memory_call(s, words->memory, "read", &values);
}

static uint32_t visit_store(struct words *words, uint32_t word, uint32_t mark)
{
    struct sanitizer *s = words->s;
    if (words->memory->access) {
        struct values values = {{memory_at(s, words->memory, word)}, 1};
        memory_call(s, words->memory, "write", &values);
    } else {
        struct values values = {
            {memory_cell(s, words->memory, word), mark ? mark : sanitizer_number(s, 0)}, 2};
        sanitizer_call(s, "diptych_shared_write(u1;u1;", &values);
    }
    return 0;
}

/* The variable of marks behind a local pointer, with its indices; 0: none. */
static uint32_t put_pointer(struct sanitizer *s, uint32_t pointer)
{
    const struct spirv *from = s->from;
    uint32_t holder = holder_of(s, memory_base(from, pointer)), words[32] = {0}, count = 1;
    const uint32_t *i = spirv_definition(from, pointer);
    if (!holder || !spirv_is(i, SpvOpAccessChain))
        return holder;
    words[0] =
        spirv_is(spirv_definition(from, i[3]), SpvOpAccessChain) ? put_pointer(s, i[3]) : holder;
    for (uint32_t word = 4; word < spirv_length(i) && count < 32; word++)
        words[count++] = i[word];
    uint32_t type = pointer_type(s, content_shape(s, pointed_type(from, i[1])));
    return spirv_put_value(&s->edit, &s->edit.code, SpvOpAccessChain, type, words, count);
}

static uint32_t put_load(struct sanitizer *s, uint32_t holder, uint32_t type)
{
    return PUT_VALUE(s, SpvOpLoad, content_shape(s, type), holder);
}

static uint32_t load_mark(struct sanitizer *s, const uint32_t *load)
{
    if (is_local(s->from, memory_base(s->from, load[3]))) {
        uint32_t pointer = put_pointer(s, load[3]);
        return pointer ? put_load(s, pointer, load[1]) : 0;
    }
    if (!is_read(s, load[3]))
        return 0;
    struct memory memory = memory_of(s, load[3]);
    struct words words = {.s = s,
                          .memory = &memory,
                          .visit = visit_read,
                          .number = sanitizer_number(s, add_number(s, &memory, NULL))};
    return memory_visit(&words, load[3], 0);
}

/* value: what is stored, or a number of its type that it is made of. */
static void put_store(struct sanitizer *s, uint32_t to, uint32_t value)
{
    uint32_t base = memory_base(s->from, to);
    if (is_local(s->from, base)) {
        uint32_t pointer = put_pointer(s, to);
        if (pointer)
            PUT(s, SpvOpStore, pointer, sure_mark(s, value));
        return;
    }
    struct memory memory = memory_of(s, to);
    if (!memory.variable || memory.access)
        put_use(s, value);
    struct words words = {.s = s, .memory = &memory, .visit = visit_store};
    if (memory.variable)
        memory_visit(&words, to, memory.access ? 0 : mark_of(s, value));
}

/* A texel: its mark if it is read. */
static uint32_t put_texel(struct sanitizer *s, const struct texel_use *use, bool reads, bool stores)
{
    struct memory memory = memory_of(s, use->image);
    uint32_t at = memory.access ? memory_texel(s, &memory, use->place, use->lod) : 0, mark = 0;
    if (at && reads && is_read(s, use->image)) {
        struct values values = {{at, sanitizer_number(s, add_number(s, &memory, NULL))}, 2};
        mark = memory_call(s, &memory, "read", &values);
    }
    if (at && stores)
        memory_call(s, &memory, "write", &(struct values){{at}, 1});
    return mark;
}

/* The sum of something unwritten is told at once; only an exchange gives it on. */
static uint32_t put_atomic(struct sanitizer *s, const uint32_t *atomic, bool stores)
{
    const uint32_t *pointer = spirv_definition(s->from, atomic[3]);
    struct texel_use use;
    uint32_t mark = 0;
    if (memory_image(pointer, &use)) {
        mark = put_texel(s, &use, true, stores);
    } else {
        struct memory memory = memory_of(s, atomic[3]);
        struct words words = {.s = s, .memory = &memory, .visit = visit_read};
        if (is_read(s, atomic[3])) {
            words.number = sanitizer_number(s, add_number(s, &memory, NULL));
            mark = memory_visit(&words, atomic[3], 0);
        }
        words.visit = visit_store;
        if (memory.variable && stores)
            memory_visit(&words, atomic[3], 0);
    }
    if (spirv_is(atomic, SpvOpAtomicExchange) || spirv_is(atomic, SpvOpAtomicLoad) || !mark)
        return mark;
    sanitizer_call(s, "diptych_use(u1;", &(struct values){{mark}, 1});
    return 0;
}

/* ---- Functions ------------------------------------------------------------------------------- */

void content_enter(struct sanitizer *s, const struct spirv_function *function)
{
    if (!is_on(s))
        return;
    SPIRV_EACH(s->from, i, function->begin, function->end) {
        bool parameter = spirv_is(i, SpvOpFunctionParameter);
        if (!parameter && !spirv_is(i, SpvOpVariable))
            continue;
        uint32_t holder = holder_of(s, i[2]);
        if (holder && parameter && !is_local(s->from, i[2]))
            s->content->ids[i[2]].mark = put_load(s, holder, i[1]);
        else if (holder && !parameter)
            PUT(s, SpvOpStore, holder, put_null(s, pointed_type(s->from, i[1])));
    }
}

static void put_arguments(struct sanitizer *s, const uint32_t *call, bool back)
{
    for (uint32_t word = 4; word < spirv_length(call); word++) {
        uint32_t parameter = spirv_parameter(s->from, call[3], word - 4)[2];
        uint32_t theirs = holder_of(s, parameter);
        if (theirs && is_local(s->from, parameter)) {
            uint32_t own = put_pointer(s, call[word]);
            uint32_t type = pointed_type(s->from, spirv_definition(s->from, parameter)[1]);
            if (own)
                PUT(s, SpvOpStore, back ? own : theirs, put_load(s, back ? theirs : own, type));
        } else if (theirs && !back) {
            PUT(s, SpvOpStore, theirs, sure_mark(s, call[word]));
        }
    }
}

/* Whether the generator wrote the function. */
static bool is_generated(const struct spirv *from, uint32_t function)
{
    SPIRV_EACH(from, i, from->definitions[function], from->count) {
        if (spirv_is(i, SpvOpLine))
            return spirv_line_file(from, i) == 0;
        if (spirv_is(i, SpvOpFunctionEnd))
            break;
    }
    return true;
}

/* The access of the pass whose function this is, like NAME_sample(). */
static const struct access *find_access(const struct sanitizer *s, const char *function)
{
    const struct pass *pass = s->request->pass;
    const struct access *found = NULL;
    size_t longest = 0;
    EACH(access, pass->accesses, pass->access_count) {
        size_t length = strlen(access_word(access));
        if (access->resource && access->binding >= 0 && length > longest &&
            !strncmp(function, access_word(access), length) &&
            (function[length] == '(' || function[length] == '_')) {
            found = access;
            longest = length;
        }
    }
    return found;
}

/* What a generated function reads is told where the author calls it. */
static uint32_t put_renumbered(struct sanitizer *s, const uint32_t *call, uint32_t mark)
{
    const char *name = spirv_name(s->from, call[3]);
    const uint32_t *type = spirv_definition(s->from, call[1]);
    const struct access *access = name ? find_access(s, name) : NULL;
    uint32_t parts[4], count = spirv_parts(s->from, type);
    if (!s->file || !access || !is_generated(s->from, call[3]) || count > 4)
        return mark;
    char word[64];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(name, "("), name);
    struct memory memory = {0, access};
    uint32_t number = sanitizer_number(s, add_number(s, &memory, word));
    for (uint32_t k = 0; k < (count ? count : 1); k++) {
        uint32_t part =
            count ? PUT_VALUE(s, SpvOpCompositeExtract, sanitizer_uint(s), mark, k) : mark;
        parts[k] =
            sanitizer_call(s, "diptych_renumber(u1;u1;", &(struct values){{part, number}, 2});
    }
    return count ? spirv_put_value(&s->edit, &s->edit.code, SpvOpCompositeConstruct,
                                   content_shape(s, call[1]), parts, count)
                 : parts[0];
}

static uint32_t call_mark(struct sanitizer *s, const uint32_t *call)
{
    put_arguments(s, call, true);
    uint32_t holder = holder_of(s, call[3]);
    return holder ? put_renumbered(s, call, put_load(s, holder, call[1])) : 0;
}

/* ---- Operations ------------------------------------------------------------------------------ */

/* The same instruction on marks: what moves values, and computes nothing. */
static uint32_t put_moved(struct sanitizer *s, const uint32_t *i)
{
    uint32_t words[80], length = spirv_length(i), shape = content_shape(s, i[1]);
    if (length > 80 || !shape || !any_operand(s, i))
        return 0;
    memcpy(words, i, length * sizeof *words);
    words[2] = s->edit.bound++;
    bool pairs = spirv_is(i, SpvOpPhi), chooses = spirv_is(i, SpvOpSelect);
    uint32_t last = spirv_is(i, SpvOpVectorExtractDynamic)  ? 4
                    : spirv_is(i, SpvOpVectorInsertDynamic) ? 5
                                                            : length;
    for (uint32_t word = chooses ? 4 : 3; word < last; word += pairs ? 2 : 1)
        if (!spirv_is_literal(i, word))
            words[word] = sure_mark(s, i[word]);
    words[1] = shape;
    spirv_copy(&s->edit, &s->edit.code, words);
    return words[2];
}

static bool is_mixing(const struct sanitizer *s, const uint32_t *i)
{
    static const uint32_t functions[] = {GLSLstd450Normalize, GLSLstd450Cross, GLSLstd450Reflect,
                                         GLSLstd450Refract, GLSLstd450FaceForward};
    uint32_t opcode = spirv_opcode(i);
    bool mixes = opcode == SpvOpMatrixTimesVector || opcode == SpvOpVectorTimesMatrix ||
                 opcode == SpvOpMatrixTimesMatrix;
    for (size_t k = 0; k < DT_ARRAY_COUNT(functions); k++)
        mixes |= opcode == SpvOpExtInst && i[3] == s->glsl && i[4] == functions[k];
    return mixes;
}

/* The mark of a result: by component where the operation goes by component. */
static uint32_t put_combined(struct sanitizer *s, const uint32_t *i)
{
    uint32_t shape = content_shape(s, i[1]), wide = 0, all = 0;
    for (uint32_t word = 3; word < spirv_length(i) && shape; word++) {
        uint32_t mark = spirv_is_literal(i, word) ? 0 : mark_of(s, i[word]);
        if (!mark)
            continue;
        uint32_t type = spirv_definition(s->from, i[word])[1];
        if (content_shape(s, type) == shape && !is_mixing(s, i))
            wide = put_max(s, shape, wide, mark);
        else
            all = put_max(s, sanitizer_uint(s), all, put_reduced(s, type, mark));
    }
    if (!all)
        return wide;
    bool composite = !spirv_is(spirv_definition(s->from, i[1]), SpvOpTypeVector) &&
                     spirv_parts(s->from, spirv_definition(s->from, i[1]));
    if (composite && wide)
        all = put_max(s, sanitizer_uint(s), all, put_reduced(s, i[1], wide));
    uint32_t splat = put_splat(s, i[1], all);
    return composite ? splat : put_max(s, shape, wide, splat);
}

/* What is right of `&&` or `||` counts where the left side does not decide. */
static uint32_t put_logical(struct sanitizer *s, const uint32_t *i)
{
    uint32_t left = mark_of(s, i[3]), right = mark_of(s, i[4]), none = sanitizer_number(s, 0);
    bool both = spirv_is(i, SpvOpLogicalAnd), single = content_shape(s, i[1]) == sanitizer_uint(s);
    if (!right || !single)
        return put_combined(s, i);
    uint32_t counts = PUT_VALUE(s, SpvOpSelect, sanitizer_uint(s), i[3], both ? right : none,
                                both ? none : right);
    return put_max(s, sanitizer_uint(s), left, counts);
}

static uint32_t operation_mark(struct sanitizer *s, const uint32_t *i)
{
    struct texel_use use;
    switch (spirv_opcode(i)) {
    case SpvOpCompositeConstruct:
    case SpvOpCompositeExtract:
    case SpvOpCompositeInsert:
    case SpvOpVectorShuffle:
    case SpvOpVectorExtractDynamic:
    case SpvOpVectorInsertDynamic:
    case SpvOpCopyObject:
    case SpvOpPhi:
        return put_moved(s, i);
    case SpvOpSelect: {
        uint32_t chosen = put_moved(s, i), mark = mark_of(s, i[3]);
        uint32_t type = spirv_definition(s->from, i[3])[1];
        mark = mark ? put_splat(s, i[1], put_reduced(s, type, mark)) : 0;
        return put_max(s, content_shape(s, i[1]), chosen, mark);
    }
    case SpvOpLogicalAnd:
    case SpvOpLogicalOr:
        return put_logical(s, i);
    case SpvOpImageRead:
    case SpvOpImageFetch:
        memory_image(i, &use);
        return put_splat(s, i[1], put_texel(s, &use, true, false));
    default:
        return put_combined(s, i);
    }
}

void content_before(struct sanitizer *s, const uint32_t *i)
{
    struct texel_use use;
    bool stores;
    if (!is_on(s))
        return;
    switch (spirv_opcode(i)) {
    case SpvOpSelectionMerge:
        s->content->merges = true;
        put_use(s, i[spirv_length(i) + 1]); /* of the branch, which must follow at once */
        break;
    case SpvOpBranchConditional:
    case SpvOpSwitch:
        if (!s->content->merges)
            put_use(s, i[1]);
        s->content->merges = false;
        break;
    case SpvOpAccessChain:
        for (uint32_t word = 4; word < spirv_length(i); word++)
            put_use(s, i[word]);
        break;
    case SpvOpVectorExtractDynamic:
        put_use(s, i[4]);
        break;
    case SpvOpVectorInsertDynamic:
        put_use(s, i[5]);
        break;
    case SpvOpFunctionCall:
        put_arguments(s, i, false);
        break;
    case SpvOpReturnValue:
        break;
    default:
        if (memory_image(i, &use))
            put_use(s, use.place);
        if (memory_is_atomic(i, &stores))
            for (uint32_t word = 6; word < spirv_length(i); word++)
                put_use(s, i[word]);
        break;
    }
    if (spirv_is(i, SpvOpImageWrite)) {
        put_use(s, i[3]);
        put_texel(s, &use, false, true);
    } else if (spirv_is(i, SpvOpReturnValue) && s->function && holder_of(s, s->function)) {
        PUT(s, SpvOpStore, holder_of(s, s->function), sure_mark(s, i[1]));
    }
}

void content_after(struct sanitizer *s, const uint32_t *i)
{
    uint32_t result = spirv_result(i), mark = 0;
    bool stores;
    if (!is_on(s))
        return;
    if (memory_stored(s, i))
        put_store(s, memory_stored(s, i), i[spirv_is(i, SpvOpStore) ? 2 : 5]);
    if (!result || spirv_result_word(i) < 2)
        return;
    if (spirv_is(i, SpvOpLoad) && may_be(s, result))
        mark = load_mark(s, i);
    else if (spirv_is(i, SpvOpFunctionCall))
        mark = call_mark(s, i);
    else if (memory_is_atomic(i, &stores))
        mark = put_atomic(s, i, stores);
    else if (may_be(s, result) && !spirv_is(i, SpvOpFunction) &&
             !spirv_is(i, SpvOpFunctionParameter) && !spirv_is(i, SpvOpVariable) &&
             !spirv_is(i, SpvOpLoad))
        mark = operation_mark(s, i);
    s->content->ids[result].mark = mark;
}

/* ---- The sites of numbers -------------------------------------------------------------------- */

void content_end(struct sanitizer *s)
{
    struct spirv_edit *edit = &s->edit;
    const struct spirv_function *function = spirv_find_function(s->from, "diptych_number(u1;");
    if (!function)
        return;
    const uint32_t *parameter = spirv_parameter(s->from, function->id, 0);
    uint32_t label = edit->bound++, site = sanitizer_number(s, 0);
    uint32_t boolean = sanitizer_bool(s);
    spirv_copy(edit, &edit->code, spirv_definition(s->from, function->id));
    spirv_copy(edit, &edit->code, parameter);
    PUT(s, SpvOpLabel, label);
    for (uint32_t i = 0; i < s->numbers.count; i++) {
        uint32_t equal =
            PUT_VALUE(s, SpvOpIEqual, boolean, parameter[2], sanitizer_number(s, FIRST_NUMBER + i));
        site = PUT_VALUE(s, SpvOpSelect, sanitizer_uint(s), equal,
                         sanitizer_number(s, s->numbers.data[i]), site);
    }
    PUT(s, SpvOpReturnValue, site);
    spirv_put(edit, &edit->code, SpvOpFunctionEnd, NULL, 0);
}
