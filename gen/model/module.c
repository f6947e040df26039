/* See module.h. */
#include "module.h"

#define SPV_ENABLE_UTILITY_CODE /* SpvHasResultAndType */
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The external definition of the header's inline function. */
extern void SpvHasResultAndType(SpvOp opcode, bool *hasResult, bool *hasResultType);

/* ---- Instructions ---------------------------------------------------------------------------- */

uint32_t spirv_result_word(const uint32_t *instruction)
{
    bool has_result, has_type;
    SpvHasResultAndType((SpvOp)spirv_opcode(instruction), &has_result, &has_type);
    return has_result ? 1 + has_type : 0;
}

uint32_t spirv_result(const uint32_t *instruction)
{
    uint32_t word = spirv_result_word(instruction);
    return word ? instruction[word] : 0;
}

bool spirv_is_literal(const uint32_t *instruction, uint32_t word)
{
    switch (spirv_opcode(instruction)) {
    case SpvOpTypeInt:
    case SpvOpTypeFloat:
    case SpvOpName:
    case SpvOpString:
    case SpvOpExtInstImport:
    case SpvOpDecorate:
    case SpvOpMemberName:
    case SpvOpMemberDecorate:
        return word >= 2;
    case SpvOpTypePointer:
    case SpvOpSelectionMerge:
    case SpvOpDecorateId:
        return word == 2;
    case SpvOpTypeVector:
    case SpvOpTypeMatrix:
    case SpvOpTypeImage:
        return word >= 3;
    case SpvOpConstant:
    case SpvOpSpecConstant:
        return word >= 3;
    case SpvOpVariable:
    case SpvOpFunction:
        return word == 3;
    case SpvOpSwitch:
        return word >= 3 && word % 2;
    case SpvOpSpecConstantOp:
        return word == 3 || (instruction[3] == SpvOpCompositeExtract && word >= 5) ||
               (instruction[3] == SpvOpCompositeInsert && word >= 6) ||
               (instruction[3] == SpvOpVectorShuffle && word >= 6);
    case SpvOpExtInst:
        return word == 4;
    case SpvOpLoad:
    case SpvOpCompositeExtract:
    case SpvOpArrayLength:
    case SpvOpBranchConditional:
    case SpvOpCopyMemorySized:
        return word >= 4;
    case SpvOpCompositeInsert:
    case SpvOpVectorShuffle:
        return word >= 5;
    case SpvOpStore:
    case SpvOpCopyMemory:
    case SpvOpLoopMerge:
        return word >= 3;
    case SpvOpImageFetch:
    case SpvOpImageRead:
        return word == 5;
    case SpvOpImageWrite:
        return word == 4;
    case SpvOpImageSampleImplicitLod:
    case SpvOpImageSampleExplicitLod:
    case SpvOpImageSampleProjImplicitLod:
    case SpvOpImageSampleProjExplicitLod:
        return word == 5;
    case SpvOpImageSampleDrefImplicitLod:
    case SpvOpImageSampleDrefExplicitLod:
    case SpvOpImageSampleProjDrefImplicitLod:
    case SpvOpImageSampleProjDrefExplicitLod:
    case SpvOpImageGather:
    case SpvOpImageDrefGather:
        return word == 6;
    case SpvOpLine:
        return word >= 2;
    case SpvOpGroupNonUniformBallotBitCount:
        return word == 4;
    default:
        return word == 4 && spirv_opcode(instruction) >= SpvOpGroupNonUniformIAdd &&
               spirv_opcode(instruction) <= SpvOpGroupNonUniformLogicalXor;
    }
}

bool spirv_is_arithmetic(const uint32_t *instruction)
{
    switch (spirv_opcode(instruction)) {
    case SpvOpFNegate:
    case SpvOpFAdd:
    case SpvOpFSub:
    case SpvOpFMul:
    case SpvOpFDiv:
    case SpvOpFRem:
    case SpvOpFMod:
    case SpvOpVectorTimesScalar:
    case SpvOpMatrixTimesScalar:
    case SpvOpVectorTimesMatrix:
    case SpvOpMatrixTimesVector:
    case SpvOpMatrixTimesMatrix:
    case SpvOpOuterProduct:
    case SpvOpDot:
        return true;
    default: /* comparisons: a driver may take !(a < b) for a >= b */
        return spirv_opcode(instruction) >= SpvOpFOrdEqual &&
               spirv_opcode(instruction) <= SpvOpFUnordGreaterThanEqual;
    }
}

/* ---- Modules --------------------------------------------------------------------------------- */

static bool is_annotation(uint32_t opcode)
{
    return (opcode >= SpvOpDecorate && opcode <= SpvOpGroupMemberDecorate) ||
           opcode == SpvOpDecorateId || opcode == SpvOpDecorateString ||
           opcode == SpvOpMemberDecorateString;
}

static bool is_declaration(uint32_t opcode)
{
    return (opcode >= SpvOpTypeVoid && opcode <= SpvOpTypeForwardPointer) ||
           (opcode >= SpvOpConstantTrue && opcode <= SpvOpSpecConstantOp) ||
           opcode == SpvOpVariable || opcode == SpvOpUndef;
}

/* Finds the sections, and counts the functions. */
static void find_sections(struct spirv *module)
{
    module->annotations = module->declarations = module->code = module->count;
    SPIRV_EACH_AT(module, at, SPIRV_HEADER, module->count) {
        uint32_t opcode = spirv_opcode(module->words + at);
        if (is_annotation(opcode) && at < module->annotations)
            module->annotations = at;
        if (is_declaration(opcode) && at < module->declarations)
            module->declarations = at;
        if (opcode == SpvOpFunction) {
            module->code = at < module->code ? at : module->code;
            module->function_count++;
        }
    }
    if (module->declarations > module->code)
        module->declarations = module->code;
    if (module->annotations > module->declarations)
        module->annotations = module->declarations;
}

static void find_functions(struct spirv *module)
{
    struct spirv_function *function = module->functions;
    SPIRV_EACH_AT(module, at, module->code, module->count) {
        const uint32_t *instruction = module->words + at;
        if (spirv_is(instruction, SpvOpFunction))
            *function = (struct spirv_function){.id = instruction[2], .begin = at};
        else if (spirv_is(instruction, SpvOpFunctionEnd))
            function++->end = at + 1;
    }
}

bool spirv_read(struct spirv *module, uint32_t *words, size_t count)
{
    *module = (struct spirv){.words = words, .count = count};
    if (!words)
        return false;
    find_sections(module);
    uint32_t *all = calloc(4 * (size_t)words[3], sizeof *all);
    module->definitions = all;
    module->functions = calloc(module->function_count + 1, sizeof *module->functions);
    if (!all || !module->functions) {
        spirv_free(module);
        return false;
    }
    module->names = all + words[3];
    module->members = module->names + words[3];
    module->decorations = module->members + words[3];
    SPIRV_EACH_AT(module, at, SPIRV_HEADER, count) {
        uint32_t result = spirv_result(words + at), opcode = spirv_opcode(words + at);
        if (result)
            module->definitions[result] = (uint32_t)at;
        uint32_t *first = opcode == SpvOpName         ? module->names
                          : opcode == SpvOpMemberName ? module->members
                          : opcode == SpvOpDecorate || opcode == SpvOpMemberDecorate
                              ? module->decorations
                              : NULL;
        if (first && !first[words[at + 1]])
            first[words[at + 1]] = (uint32_t)at;
    }
    find_functions(module);
    return true;
}

bool spirv_open(struct spirv *module, const uint32_t *words, size_t count)
{
    uint32_t *copy = malloc(count * sizeof *copy);
    if (copy)
        memcpy(copy, words, count * sizeof *copy);
    return spirv_read(module, copy, count);
}

void spirv_free(struct spirv *module)
{
    free(module->words);
    free(module->definitions);
    free(module->functions);
    *module = (struct spirv){0};
}

uint32_t *spirv_take(struct spirv *module, size_t *count)
{
    uint32_t *words = module->words;
    *count = module->count;
    module->words = NULL;
    spirv_free(module);
    return words;
}

/* Of an index by id, which an edit may have given. */
static uint32_t first_of(const struct spirv *module, const uint32_t *index, uint32_t id)
{
    return id < module->words[3] ? index[id] : 0;
}

const char *spirv_name(const struct spirv *module, uint32_t id)
{
    uint32_t at = first_of(module, module->names, id);
    return at ? (const char *)(module->words + at + 2) : NULL;
}

uint32_t spirv_line_file(const struct spirv *module, const uint32_t *line)
{
    return (uint32_t)strtoul((const char *)(spirv_definition(module, line[1]) + 2), NULL, 10);
}

const struct spirv_function *spirv_function_of(const struct spirv *module, uint32_t id)
{
    const struct spirv_function *function = module->functions;
    while (function->id != id)
        function++;
    return function;
}

const struct spirv_function *spirv_find_function(const struct spirv *module, const char *name)
{
    EACH(function, module->functions, module->function_count) {
        const char *own = spirv_name(module, function->id);
        if (own && !strcmp(own, name))
            return function;
    }
    return NULL;
}

char spirv_letter(const uint32_t *type)
{
    if (spirv_is(type, SpvOpTypeBool))
        return 'b';
    if (spirv_is(type, SpvOpTypeFloat))
        return type[2] == 32 ? 'f' : 0;
    return spirv_is(type, SpvOpTypeInt) && type[2] == 32 ? (type[3] ? 'i' : 'u') : 0;
}

uint32_t spirv_glsl(const struct spirv *module)
{
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations)
        if (spirv_is(i, SpvOpExtInstImport) && !strcmp((const char *)(i + 2), "GLSL.std.450"))
            return i[1];
    return 0;
}

uint32_t spirv_decoration(const struct spirv *module, uint32_t id, uint32_t what)
{
    size_t first = first_of(module, module->decorations, id);
    SPIRV_EACH(module, i, first ? first : module->declarations, module->declarations)
        if (spirv_is(i, SpvOpDecorate) && i[1] == id && i[2] == what)
            return spirv_length(i) > 3 ? i[3] : 0;
    return UINT32_MAX;
}

uint32_t spirv_member_decoration(const struct spirv *module, uint32_t id, uint32_t member,
                                 uint32_t what)
{
    size_t first = first_of(module, module->decorations, id);
    SPIRV_EACH(module, i, first ? first : module->declarations, module->declarations)
        if (spirv_is(i, SpvOpMemberDecorate) && i[1] == id && i[2] == member && i[3] == what)
            return spirv_length(i) > 4 ? i[4] : 0;
    return UINT32_MAX;
}

const char *spirv_member_name(const struct spirv *module, uint32_t type, uint32_t member)
{
    size_t first = first_of(module, module->members, type);
    SPIRV_EACH(module, i, first ? first : module->annotations, module->annotations)
        if (spirv_is(i, SpvOpMemberName) && i[1] == type && i[2] == member)
            return (const char *)(i + 3);
    return NULL;
}

uint32_t spirv_builtin(const struct spirv *module, uint32_t builtin)
{
    SPIRV_EACH(module, i, module->annotations, module->declarations)
        if (spirv_is(i, SpvOpDecorate) && i[2] == SpvDecorationBuiltIn && i[3] == builtin)
            return i[1];
    return 0;
}

const uint32_t *spirv_entry_point(const struct spirv *module)
{
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations)
        if (spirv_is(i, SpvOpEntryPoint))
            return i;
    return NULL;
}

uint32_t spirv_entry_variables(const uint32_t *entry)
{
    uint32_t word = 3;
    while (word < spirv_length(entry) && entry[word] >> 24)
        word++; /* the last word of a text ends with zero */
    return word + 1;
}

uint32_t spirv_entry(const struct spirv *module)
{
    const uint32_t *entry = spirv_entry_point(module);
    return entry ? entry[2] : 0;
}

const uint32_t *spirv_parameter(const struct spirv *module, uint32_t function, uint32_t index)
{
    const uint32_t *i = spirv_definition(module, function);
    do
        i += spirv_length(i);
    while (spirv_is(i, SpvOpLine) || (spirv_is(i, SpvOpFunctionParameter) && index--));
    return i;
}

uint32_t spirv_parameter_index(const struct spirv *module, uint32_t parameter, uint32_t *function)
{
    const struct spirv_function *own = module->functions;
    size_t place = module->definitions[parameter];
    uint32_t index = 0;
    while (place > own->end)
        own++;
    SPIRV_EACH(module, i, own->begin, place)
        index += spirv_is(i, SpvOpFunctionParameter);
    *function = own->id;
    return index;
}

/* ---- Types ----------------------------------------------------------------------------------- */

uint32_t spirv_parts(const struct spirv *module, const uint32_t *type)
{
    switch (spirv_opcode(type)) {
    case SpvOpTypeVector:
    case SpvOpTypeMatrix:
        return type[3];
    case SpvOpTypeStruct:
        return spirv_length(type) - 2;
    case SpvOpTypeArray: {
        const uint32_t *length = spirv_definition(module, type[3]);
        return spirv_is(length, SpvOpConstant) ? length[3] : 1;
    }
    default:
        return 0;
    }
}

uint32_t spirv_part(const uint32_t *type, uint32_t part)
{
    return spirv_is(type, SpvOpTypeStruct) ? type[2 + part] : type[2];
}

uint32_t spirv_scalars(const struct spirv *module, uint32_t id)
{
    const uint32_t *type = spirv_definition(module, id);
    uint64_t parts = spirv_parts(module, type), count = 0;
    if (!parts)
        return 1;
    if (!spirv_is(type, SpvOpTypeStruct))
        count = parts * spirv_scalars(module, type[2]);
    for (uint32_t k = 0; k < parts && spirv_is(type, SpvOpTypeStruct); k++)
        count += spirv_scalars(module, spirv_part(type, k));
    return count < UINT32_MAX ? (uint32_t)count : UINT32_MAX;
}

uint64_t spirv_locations(const struct spirv *module, uint32_t id)
{
    const uint32_t *type = spirv_definition(module, id);
    uint32_t parts = spirv_parts(module, type);
    uint64_t count = 0;
    if (spirv_is(type, SpvOpTypeVector))
        return parts > 2 && spirv_definition(module, type[2])[2] == 64 ? 2 : 1;
    if (!spirv_is(type, SpvOpTypeStruct))
        return parts ? parts * spirv_locations(module, type[2]) : 1;
    for (uint32_t part = 0; part < parts; part++)
        count += spirv_locations(module, type[2 + part]);
    return count;
}

bool spirv_mangle(const struct spirv *module, const uint32_t *type, bool scalar, char *name,
                  size_t room)
{
    bool matrix = spirv_is(type, SpvOpTypeMatrix), vector = spirv_is(type, SpvOpTypeVector);
    const uint32_t *column = matrix ? spirv_definition(module, type[2]) : type;
    char letter = spirv_letter(matrix || vector ? spirv_definition(module, column[2]) : type);
    size_t length = strlen(name);
    if (matrix)
        snprintf(name + length, room - length, "m%c%u%u;", letter, type[3], column[3]);
    else if (vector && !scalar)
        snprintf(name + length, room - length, "v%c%u;", letter, type[3]);
    else
        snprintf(name + length, room - length, "%c1;", letter);
    return letter && !(matrix && scalar);
}

/* ---- Edits ----------------------------------------------------------------------------------- */

static uint32_t *make_room(struct spirv_edit *edit, struct spirv_words *to, size_t count)
{
    if (to->count + count > to->room) {
        size_t room = (to->count + count) * 3 / 2 + 64;
        uint32_t *data = realloc(to->data, room * sizeof *data);
        edit->failed |= !data;
        if (!data)
            return NULL;
        to->data = data;
        to->room = room;
    }
    to->count += count;
    return to->data + to->count - count;
}

void spirv_append(struct spirv_edit *edit, struct spirv_words *to, const uint32_t *words,
                  size_t count)
{
    uint32_t *room = count ? make_room(edit, to, count) : NULL;
    if (room)
        memcpy(room, words, count * sizeof *words);
}

void spirv_put(struct spirv_edit *edit, struct spirv_words *to, uint32_t opcode,
               const uint32_t *operands, size_t count)
{
    uint32_t *room = make_room(edit, to, count + 1);
    if (!room)
        return;
    room[0] = (uint32_t)(count + 1) << 16 | opcode;
    if (count)
        memcpy(room + 1, operands, count * sizeof *operands);
}

uint32_t spirv_put_value(struct spirv_edit *edit, struct spirv_words *to, uint32_t opcode,
                         uint32_t type, const uint32_t *operands, size_t count)
{
    uint32_t *room = make_room(edit, to, count + 3), result = edit->bound++;
    if (!room)
        return result;
    room[0] = (uint32_t)(count + 3) << 16 | opcode;
    room[1] = type;
    room[2] = result;
    memcpy(room + 3, operands, count * sizeof *operands);
    return result;
}

void spirv_copy(struct spirv_edit *edit, struct spirv_words *to, const uint32_t *instruction)
{
    spirv_append(edit, to, instruction, spirv_length(instruction));
}

void spirv_copy_with(struct spirv_edit *edit, struct spirv_words *to, const uint32_t *instruction,
                     uint32_t word, uint32_t value)
{
    size_t start = to->count;
    spirv_copy(edit, to, instruction);
    if (!edit->failed)
        to->data[start + word] = value;
}

void spirv_copy_mapped(struct spirv_edit *edit, struct spirv_words *to, const uint32_t *instruction,
                       const uint32_t *ids)
{
    size_t start = to->count;
    spirv_copy(edit, to, instruction);
    for (uint32_t word = 1; word < spirv_length(instruction) && !edit->failed; word++)
        if (!spirv_is_literal(instruction, word) && ids[instruction[word]])
            to->data[start + word] = ids[instruction[word]];
}

void spirv_put_discard(struct spirv_edit *edit, uint32_t condition)
{
    struct spirv_words *code = &edit->code;
    uint32_t discard = edit->bound++, behind = edit->bound++;
    SPIRV_PUT(edit, code, SpvOpSelectionMerge, behind, SpvSelectionControlMaskNone);
    SPIRV_PUT(edit, code, SpvOpBranchConditional, condition, discard, behind);
    SPIRV_PUT(edit, code, SpvOpLabel, discard);
    spirv_put(edit, code, SpvOpKill, NULL, 0);
    SPIRV_PUT(edit, code, SpvOpLabel, behind);
}

void spirv_put_text(struct spirv_edit *edit, uint32_t opcode, const uint32_t *operands,
                    size_t count, const char *text)
{
    size_t bytes = strlen(text) + 1, words = count + (bytes + 3) / 4;
    uint32_t *room = make_room(edit, &edit->front, words + 1);
    if (!room)
        return;
    room[0] = (uint32_t)(words + 1) << 16 | opcode;
    room[words] = 0;
    for (size_t i = 0; i < count; i++)
        room[1 + i] = operands[i];
    memcpy(room + 1 + count, text, bytes);
}

void spirv_put_name(struct spirv_edit *edit, uint32_t id, const char *name)
{
    spirv_put_text(edit, SpvOpName, &id, 1, name);
}

/* Whether two declarations are equal but for their results. */
static bool same_declaration(const uint32_t *a, const uint32_t *b)
{
    uint32_t result = spirv_result_word(a);
    if (*a != *b)
        return false;
    for (uint32_t word = 1; word < spirv_length(a); word++)
        if (word != result && a[word] != b[word])
            return false;
    return true;
}

static size_t hash_declaration(const uint32_t *instruction)
{
    uint32_t result = spirv_result_word(instruction);
    uint64_t hash = *instruction;
    for (uint32_t word = 1; word < spirv_length(instruction); word++)
        if (word != result)
            hash = (hash ^ instruction[word]) * 0x9e3779b97f4a7c15ull;
    return (size_t)(hash >> 20);
}

/* The slot of a declaration, or the free one that it would take. */
static uint32_t *find_slot(struct spirv_edit *edit, const uint32_t *instruction)
{
    size_t slot = hash_declaration(instruction) & (edit->slot_count - 1);
    while (edit->slots[slot] &&
           !same_declaration(edit->declarations.data + edit->slots[slot] - 1, instruction))
        slot = (slot + 1) & (edit->slot_count - 1);
    return edit->slots + slot;
}

/* Structs, arrays of layouts and variables are never shared: their decorations may differ. */
bool spirv_is_shared(uint32_t opcode)
{
    return opcode != SpvOpTypeStruct && opcode != SpvOpTypeArray &&
           opcode != SpvOpTypeRuntimeArray && opcode != SpvOpVariable && opcode != SpvOpUndef &&
           (opcode < SpvOpSpecConstantTrue || opcode > SpvOpSpecConstantOp);
}

static void fill_slots(struct spirv_edit *edit, size_t count)
{
    free(edit->slots);
    edit->slots = calloc(count, sizeof *edit->slots);
    edit->slot_count = count;
    edit->failed |= !edit->slots;
    const struct spirv_words *words = &edit->declarations;
    edit->declared = 0;
    for (size_t at = 0; edit->slots && at < words->count; at += spirv_length(words->data + at)) {
        edit->declared++;
        if (spirv_is_shared(spirv_opcode(words->data + at)))
            *find_slot(edit, words->data + at) = (uint32_t)at + 1;
    }
}

void spirv_edit_annotations(struct spirv_edit *edit)
{
    const struct spirv *from = edit->from;
    spirv_append(edit, &edit->annotations, from->words + from->annotations,
                 from->declarations - from->annotations);
}

void spirv_edit_keep(struct spirv_edit *edit)
{
    const struct spirv *from = edit->from;
    spirv_edit_annotations(edit);
    spirv_append(edit, &edit->code, from->words + from->code, from->count - from->code);
}

void spirv_edit_list(struct spirv_edit *edit, uint32_t model, const uint32_t *ids, size_t count)
{
    struct spirv_words *front = &edit->front;
    for (size_t at = SPIRV_HEADER; !edit->failed && at < front->count;
         at += spirv_length(front->data + at)) {
        const uint32_t *i = front->data + at;
        size_t end = at + spirv_length(i), behind = front->count - end;
        if (!spirv_is(i, SpvOpEntryPoint) || (model != UINT32_MAX && i[1] != model) || !count ||
            !make_room(edit, front, count))
            continue;
        memmove(front->data + end + count, front->data + end, behind * sizeof *ids);
        memcpy(front->data + end, ids, count * sizeof *ids);
        front->data[at] += (uint32_t)count << 16;
    }
}

void spirv_edit_interface(struct spirv_edit *edit, uint32_t (*keep)(const void *user, uint32_t id),
                          const void *user)
{
    struct spirv_words *front = &edit->front;
    for (size_t at = SPIRV_HEADER; !edit->failed && at < front->count;
         at += spirv_length(front->data + at)) {
        uint32_t *i = front->data + at, length = spirv_length(i);
        if (!spirv_is(i, SpvOpEntryPoint))
            continue;
        uint32_t kept = spirv_entry_variables(i);
        for (uint32_t word = kept; word < length; word++) {
            uint32_t id = keep(user, i[word]);
            if (id)
                i[kept++] = id;
        }
        i[0] = kept << 16 | SpvOpEntryPoint;
        memmove(i + kept, i + length, (front->count - at - length) * sizeof *i);
        front->count -= length - kept;
    }
}

void spirv_edit_begin(struct spirv_edit *edit, const struct spirv *from)
{
    *edit = (struct spirv_edit){.from = from, .bound = from->words[3]};
    spirv_append(edit, &edit->front, from->words, from->annotations);
    spirv_append(edit, &edit->declarations, from->words + from->declarations,
                 from->code - from->declarations);
    size_t declared = 0, slots = 1024;
    SPIRV_EACH(from, i, from->declarations, from->code)
        declared++;
    while (slots < 4 * declared)
        slots *= 2;
    if (!edit->failed)
        fill_slots(edit, slots);
}

uint32_t spirv_declare(struct spirv_edit *edit, uint32_t opcode, uint32_t type,
                       const uint32_t *operands, size_t count)
{
    enum { MOST_WORDS = 64 };
    uint32_t instruction[MOST_WORDS] = {0}, length = 0;
    if (edit->failed || count + 3 > MOST_WORDS) {
        edit->failed = true;
        return 0;
    }
    if (type)
        instruction[++length] = type;
    uint32_t result = ++length;
    if (count)
        memcpy(instruction + length + 1, operands, count * sizeof *operands);
    length += (uint32_t)count;
    instruction[0] = (length + 1) << 16 | opcode;
    if (2 * edit->declared > edit->slot_count)
        fill_slots(edit, 2 * edit->slot_count);
    uint32_t *slot = edit->failed ? NULL : find_slot(edit, instruction);
    if (!slot)
        return 0;
    if (*slot)
        return spirv_result(edit->declarations.data + *slot - 1);
    *slot = (uint32_t)edit->declarations.count + 1;
    instruction[result] = edit->bound++;
    spirv_append(edit, &edit->declarations, instruction, length + 1);
    edit->declared++;
    return instruction[result];
}

uint32_t spirv_declare_scalar(struct spirv_edit *edit, char letter)
{
    if (letter == 'b')
        return spirv_declare(edit, SpvOpTypeBool, 0, NULL, 0);
    return letter == 'f' ? SPIRV_DECLARE(edit, SpvOpTypeFloat, 0, 32)
                         : SPIRV_DECLARE(edit, SpvOpTypeInt, 0, 32, letter == 'i');
}

uint32_t spirv_declare_vector(struct spirv_edit *edit, uint32_t scalar, uint32_t count)
{
    return count == 1 ? scalar : SPIRV_DECLARE(edit, SpvOpTypeVector, 0, scalar, count);
}

uint32_t spirv_add_variable(struct spirv_edit *edit, uint32_t class, uint32_t type)
{
    uint32_t pointer = SPIRV_DECLARE(edit, SpvOpTypePointer, 0, class, type), id = edit->bound++;
    SPIRV_PUT(edit, &edit->declarations, SpvOpVariable, pointer, id, class);
    return id;
}

struct spirv_scratch {
    struct spirv_scratch *next;
    _Alignas(16) char bytes[];
};

void *spirv_edit_alloc(struct spirv_edit *edit, size_t count, size_t size)
{
    struct spirv_scratch *scratch = calloc(1, sizeof *scratch + count * size);
    edit->failed |= !scratch;
    if (!scratch)
        return NULL;
    scratch->next = edit->scratch;
    edit->scratch = scratch;
    return scratch->bytes;
}

void *spirv_edit_table(struct spirv_edit *edit, size_t size)
{
    return spirv_edit_alloc(edit, edit->from->words[3], size);
}

/* The place of an instruction in the logical layout of a front. */
static uint32_t rank_of(const uint32_t *i)
{
    switch (spirv_opcode(i)) {
    case SpvOpCapability:
        return 0;
    case SpvOpExtension:
        return 1;
    case SpvOpExtInstImport:
        return 2;
    case SpvOpMemoryModel:
        return 3;
    case SpvOpEntryPoint:
        return 4;
    case SpvOpExecutionMode:
    case SpvOpExecutionModeId:
        return 5;
    case SpvOpName:
    case SpvOpMemberName:
        return 7;
    case SpvOpModuleProcessed:
        return 8;
    default:
        return 6; /* strings and sources */
    }
}

/* Passes append to the front in any order. */
static void sort_front(struct spirv_edit *edit)
{
    const struct spirv front = {.words = edit->front.data, .count = edit->front.count};
    struct spirv_words sorted = {0};
    uint32_t last = 0;
    bool ordered = true;
    if (edit->failed)
        return;
    SPIRV_EACH(&front, i, SPIRV_HEADER, front.count) {
        ordered &= rank_of(i) >= last;
        last = rank_of(i);
    }
    if (ordered)
        return;
    spirv_append(edit, &sorted, front.words, SPIRV_HEADER);
    for (uint32_t rank = 0; rank <= 8; rank++)
        SPIRV_EACH(&front, i, SPIRV_HEADER, front.count)
            if (rank_of(i) == rank)
                spirv_copy(edit, &sorted, i);
    free(front.words);
    edit->front = sorted;
}

uint32_t spirv_declare_numbers(struct spirv_edit *edit, uint32_t type, uint32_t bits)
{
    const uint32_t *declared = spirv_definition(edit->from, type);
    if (!spirv_is(declared, SpvOpTypeVector))
        return spirv_declare(edit, SpvOpConstant, type, &bits, 1);
    uint32_t part = spirv_declare_numbers(edit, declared[2], bits);
    return spirv_declare(edit, SpvOpConstantComposite, type, (uint32_t[]){part, part, part, part},
                         declared[3]);
}

bool spirv_edit_end(struct spirv_edit *edit, struct spirv *module)
{
    sort_front(edit);
    const struct spirv_words *parts[] = {&edit->front, &edit->annotations, &edit->declarations,
                                         &edit->code};
    size_t count = 0;
    for (int i = 0; i < 4; i++)
        count += parts[i]->count;
    uint32_t *words = edit->failed ? NULL : malloc(count * sizeof *words);
    for (size_t i = 0, at = 0; i < 4; at += parts[i]->count, i++)
        if (words && parts[i]->count)
            memcpy(words + at, parts[i]->data, parts[i]->count * sizeof *words);
    for (int i = 0; i < 4; i++)
        free(parts[i]->data);
    free(edit->slots);
    for (struct spirv_scratch *next; edit->scratch; edit->scratch = next) {
        next = edit->scratch->next;
        free(edit->scratch);
    }
    if (!words)
        return false;
    words[3] = edit->bound;
    spirv_free(module);
    return spirv_read(module, words, count);
}
