/* SPIR-V modules as the passes of this room see them: the words of a module with an index of its
 * sections, functions and ids, and an edit that makes the next module of it. A pass reads one module
 * and writes another; nothing is changed in place but by the passes that say so.
 *
 * Instructions are as the specification has them: the first word holds length and opcode, the others
 * operands. Sections follow its "Logical Layout of a Module". */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/each.h"

enum { SPIRV_HEADER = 5 }; /* words before the first instruction; [3] is the bound of the ids */

struct spirv_function {
    uint32_t id;
    size_t begin, end; /* offsets of OpFunction, and behind OpFunctionEnd */
};

struct spirv {
    uint32_t *words; /* free() */
    size_t count;
    size_t annotations, declarations, code; /* offsets of the first decoration, the first type,
                                               constant or variable, and the first function */
    uint32_t *definitions; /* by id: offset of the instruction that defines it; 0: none */
    uint32_t *names;       /* by id: offset of its OpName; 0: none */
    uint32_t *members;     /* by id: the same of the first OpMemberName */
    uint32_t *decorations; /* by id: the same of the first decoration of it or of a member */
    struct spirv_function *functions;
    uint32_t function_count;
};

/* Indexes a module and takes over its words, also after a failure. The words come from glslang or
 * from an edit: malformed modules are refused by spirv-val, not here. False when out of memory. */
bool spirv_read(struct spirv *module, uint32_t *words, size_t count);
/* The same of a copy of the words. */
bool spirv_open(struct spirv *module, const uint32_t *words, size_t count);
void spirv_free(struct spirv *module);
/* Gives the words away: free(). The module is empty then. */
uint32_t *spirv_take(struct spirv *module, size_t *count);

static inline uint32_t spirv_opcode(const uint32_t *instruction)
{
    return *instruction & 0xffff;
}
static inline uint32_t spirv_length(const uint32_t *instruction)
{
    return *instruction >> 16;
}
static inline bool spirv_is(const uint32_t *instruction, unsigned opcode)
{
    return spirv_opcode(instruction) == opcode;
}
/* The instruction that defines an id of the module. */
static inline const uint32_t *spirv_definition(const struct spirv *module, uint32_t id)
{
    return module->words + module->definitions[id];
}
/* The instruction that declares the type of a value. Vectors and matrices: [2] is the type of a
 * component or column, [3] their number. */
static inline const uint32_t *spirv_type(const struct spirv *module, uint32_t value)
{
    return spirv_definition(module, spirv_definition(module, value)[1]);
}
/* The type of the numbers of a vector; any other type is its own. */
static inline const uint32_t *spirv_scalar(const struct spirv *module, const uint32_t *type)
{
    return spirv_is(type, 23) ? spirv_definition(module, type[2]) : type; /* OpTypeVector */
}
/* The type that a variable points to. */
static inline uint32_t spirv_pointee(const struct spirv *module, const uint32_t *variable)
{
    return spirv_definition(module, variable[1])[3];
}
/* All instructions between two offsets, in order; to change them in place; by their offsets. */
#define SPIRV_EACH(module, i, from, to)                                                            \
    for (const uint32_t *i = (module)->words + (from), *i##_end = (module)->words + (to);          \
         i < i##_end; i += *i >> 16)
#define SPIRV_CHANGE(module, i, from, to)                                                          \
    for (uint32_t *i = (module)->words + (from); i < (module)->words + (to); i += *i >> 16)
#define SPIRV_EACH_AT(module, at, from, to)                                                        \
    for (size_t at = (from); at < (to); at += (module)->words[at] >> 16)

/* The id that the instruction defines, and the word that holds it; 0: none. */
uint32_t spirv_result(const uint32_t *instruction);
uint32_t spirv_result_word(const uint32_t *instruction);
/* Whether a word of an instruction is a number or text, not an id. */
bool spirv_is_literal(const uint32_t *instruction, uint32_t word);
/* Whether it computes with floats, or compares them, and may be contracted with others. */
bool spirv_is_arithmetic(const uint32_t *instruction);
/* The name of an id; NULL: it has none. */
const char *spirv_name(const struct spirv *module, uint32_t id);
/* The number of the file that an OpLine names by a string. */
uint32_t spirv_line_file(const struct spirv *module, const uint32_t *line);
const struct spirv_function *spirv_function_of(const struct spirv *module, uint32_t id);
/* The function of that mangled name, as "exact_pow(f1;f1;"; NULL: there is none. */
const struct spirv_function *spirv_find_function(const struct spirv *module, const char *name);
/* The letter of a scalar type in mangled names; 0: of another width than 32, or no scalar. */
char spirv_letter(const uint32_t *type);
/* The id of the extended instructions GLSL.std.450; 0: not imported. */
uint32_t spirv_glsl(const struct spirv *module);
/* The number behind a decoration of an id, 0: one without a number; UINT32_MAX: it has none. */
uint32_t spirv_decoration(const struct spirv *module, uint32_t id, uint32_t what);
/* The same of a member of a struct. */
uint32_t spirv_member_decoration(const struct spirv *module, uint32_t id, uint32_t member,
                                 uint32_t what);
const char *spirv_member_name(const struct spirv *module, uint32_t type, uint32_t member);
/* What a built-in is: a variable, or the constant of the size of workgroups; 0: there is none. */
uint32_t spirv_builtin(const struct spirv *module, uint32_t builtin);
/* Locations between stages that a value of the type takes. */
uint64_t spirv_locations(const struct spirv *module, uint32_t id);
/* Appends a type as glslang mangles it: f1, vf3, mf34; scalar: that of its components. False: there is no such one. */
bool spirv_mangle(const struct spirv *module, const uint32_t *type, bool scalar, char *name,
                  size_t room);
/* The instruction of the entry point, NULL: there is none; the word of its first input or output; its
 * function. */
const uint32_t *spirv_entry_point(const struct spirv *module);
uint32_t spirv_entry_variables(const uint32_t *entry);
uint32_t spirv_entry(const struct spirv *module);
/* The instruction of a function's parameter, from 0; and of a parameter its number and its function. */
const uint32_t *spirv_parameter(const struct spirv *module, uint32_t function, uint32_t index);
uint32_t spirv_parameter_index(const struct spirv *module, uint32_t parameter, uint32_t *function);

/* Parts of a composite type, 0: it is none; an array whose length is no constant counts as one. The id of
 * the type of a part. The scalars of a type. */
uint32_t spirv_parts(const struct spirv *module, const uint32_t *type);
uint32_t spirv_part(const uint32_t *type, uint32_t part);
uint32_t spirv_scalars(const struct spirv *module, uint32_t id);

/* ---- Edits ----------------------------------------------------------------------------------- */

struct spirv_words { /* a growing piece of a module */
    uint32_t *data;
    size_t count, room;
};

/* The next module, section by section. A pass fills them, in any order those of the front; spirv_edit_end joins them. */
struct spirv_edit {
    const struct spirv *from;
    struct spirv_words front, annotations, declarations, code;
    uint32_t bound;
    uint32_t *slots; /* hash table of declarations: offset + 1, 0: free */
    size_t slot_count, declared;
    struct spirv_scratch *scratch;
    bool failed; /* out of memory */
};

/* Copies front (up to names) and declarations; annotations and code are the pass's. */
void spirv_edit_begin(struct spirv_edit *edit, const struct spirv *from);
/* Copies annotations; the second code, too. */
void spirv_edit_annotations(struct spirv_edit *edit);
void spirv_edit_keep(struct spirv_edit *edit);
/* The entry points of the edit's front list more variables. model: those of this execution model alone; UINT32_MAX: all. */
void spirv_edit_list(struct spirv_edit *edit, uint32_t model, const uint32_t *ids, size_t count);
/* Each variable that the entry points of the edit's front list becomes what `keep` gives for it; 0: it goes. */
void spirv_edit_interface(struct spirv_edit *edit, uint32_t (*keep)(const void *user, uint32_t id),
                          const void *user);
/* Replaces the module by the edit; false when out of memory. Frees the edit. */
bool spirv_edit_end(struct spirv_edit *edit, struct spirv *module);
/* Zeros, until the edit ends: a table of all ids of `from`, or of `count` elements. NULL: the edit has failed. */
void *spirv_edit_table(struct spirv_edit *edit, size_t size);
void *spirv_edit_alloc(struct spirv_edit *edit, size_t count, size_t size);

/* Appends an instruction with `count` operands, or a copy. */
void spirv_put(struct spirv_edit *edit, struct spirv_words *to, uint32_t opcode,
               const uint32_t *operands, size_t count);
void spirv_copy(struct spirv_edit *edit, struct spirv_words *to, const uint32_t *instruction);
/* A copy with another value in one word; one in which each id becomes ids[id], where that is not 0. */
void spirv_copy_with(struct spirv_edit *edit, struct spirv_words *to, const uint32_t *instruction,
                     uint32_t word, uint32_t value);
void spirv_copy_mapped(struct spirv_edit *edit, struct spirv_words *to, const uint32_t *instruction,
                       const uint32_t *ids);
#define SPIRV_PUT(edit, to, opcode, ...)                                                           \
    spirv_put(edit, to, opcode, (const uint32_t[]){__VA_ARGS__},                                   \
              sizeof((const uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t))
/* The same of one with a type and a result, which is new and returned. */
uint32_t spirv_put_value(struct spirv_edit *edit, struct spirv_words *to, uint32_t opcode,
                         uint32_t type, const uint32_t *operands, size_t count);
#define SPIRV_VALUE(edit, to, opcode, type, ...)                                                   \
    spirv_put_value(edit, to, opcode, type, (const uint32_t[]){__VA_ARGS__},                       \
                    sizeof((const uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t))
/* Appends words. */
void spirv_append(struct spirv_edit *edit, struct spirv_words *to, const uint32_t *words,
                  size_t count);
/* Ends the invocation of a fragment if the condition holds. */
void spirv_put_discard(struct spirv_edit *edit, uint32_t condition);
/* Appends an instruction that ends with a text to the front; a name of an id. */
void spirv_put_text(struct spirv_edit *edit, uint32_t opcode, const uint32_t *operands,
                    size_t count, const char *text);
void spirv_put_name(struct spirv_edit *edit, uint32_t id, const char *name);

/* Whether spirv_declare may be asked for it. */
bool spirv_is_shared(uint32_t opcode);
/* The id of a type (type: 0) or constant with these operands behind the result; declares it if the
 * module has none. Not for structs, whose decorations differ. */
uint32_t spirv_declare(struct spirv_edit *edit, uint32_t opcode, uint32_t type,
                       const uint32_t *operands, size_t count);
#define SPIRV_DECLARE(edit, opcode, type, ...)                                                     \
    spirv_declare(edit, opcode, type, (const uint32_t[]){__VA_ARGS__},                             \
                  sizeof((const uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t))
/* Types of 32 bits, 'f', 'i', 'u', and 'b'; a vector of them, for a count of 1 the scalar. */
uint32_t spirv_declare_scalar(struct spirv_edit *edit, char letter);
uint32_t spirv_declare_vector(struct spirv_edit *edit, uint32_t scalar, uint32_t count);
/* A new variable of the module that holds the type. */
uint32_t spirv_add_variable(struct spirv_edit *edit, uint32_t class, uint32_t type);
/* A constant of the type, all of whose components have these bits. */
uint32_t spirv_declare_numbers(struct spirv_edit *edit, uint32_t type, uint32_t bits);
