/* What the files of --sanitize share: sanitize.c walks through a module, assigned.c follows which variables have values. */
#pragma once

#include "model/model.h"
#include "sanitize.h"

struct sanitizer {
    const struct sanitize_request *request;
    const struct spirv *from;
    struct spirv_edit edit;
    uint32_t glsl;
    uint32_t file, line;     /* of the operation; file 0: text of the generator */
    unsigned kind;           /* of the next sites */
    uint32_t function;       /* that is written */
    uint32_t label;          /* of the block that is written; 0: none yet */
    bool begun;              /* the variables of the function are written */
    struct spirv_words seen; /* pairs of a hash of file, line and word, and the operations so far */
    struct spirv_words sites; /* of the module, in its order */
    uint32_t *counters;       /* by label of a loop's header: its variable; 0: no loop */
    uint32_t *ends;       /* by label of a loop's header: the block that leaves it now; 0: itself */
    struct assigned *ids; /* by id */
    struct content *content;      /* of content.c */
    struct quads *quads;          /* of quads.c */
    struct spirv_words numbers;   /* of content.c: sites by number - 2; 0: written, 1: not used */
    struct spirv_words meetings;  /* of quads.c: of struct quad */
    struct spirv_words variables; /* of this pass, in the private storage class, */
    struct spirv_words handed_on; /* and inputs or outputs */
};

struct values { /* operands of a check */
    uint32_t ids[8], count;
};

/* Append an instruction to the code; one with a type and a new result, which is returned. */
#define PUT(s, ...)       SPIRV_PUT(&(s)->edit, &(s)->edit.code, __VA_ARGS__)
#define PUT_VALUE(s, ...) SPIRV_VALUE(&(s)->edit, &(s)->edit.code, __VA_ARGS__)

uint32_t sanitizer_uint(struct sanitizer *s); /* the types */
uint32_t sanitizer_bool(struct sanitizer *s);
uint32_t sanitizer_number(struct sanitizer *s, uint32_t value);
/* The result of a call; 0: there is no such function. */
uint32_t sanitizer_call(struct sanitizer *s, const char *mangled, const struct values *values);
/* The index of a new site. name: copied; word: a literal, NULL: the name. */
uint32_t sanitizer_site(struct sanitizer *s, const char *word, const char *name, const char *text);
/* Whether a function is one of the generator's that gets no checks. */
bool sanitizer_is_check(const struct spirv *from, const struct spirv_function *function);
/* A sum or the like of two numbers; the value of a variable of numbers. */
uint32_t sanitizer_two(struct sanitizer *s, uint32_t opcode, uint32_t a, uint32_t b);
uint32_t sanitizer_load(struct sanitizer *s, uint32_t variable);
/* A new variable, 0 when the shader begins; the variable of the author's call of generated text, 0: there is none. */
uint32_t sanitizer_variable(struct sanitizer *s);
uint32_t sanitizer_caller(const struct sanitizer *s);
/* The constant that checks get for an operation. */
uint32_t sanitizer_what(struct sanitizer *s, uint32_t site);
/* Appends place and operation. */
void sanitizer_place(struct sanitizer *s, struct values *values, uint32_t site);

/* The same of a site with its text; file, line and operation are added. */
uint32_t sanitizer_add(struct sanitizer *s, struct sanitize_site *site);
bool sanitizer_has(const struct sanitizer *s, const char *mangled); /* such a function */

/* ---- pointers.c: where in memory an operation reads or stores -------------------------------- */

struct memory {
    uint32_t variable;           /* 0: none that is followed */
    const struct access *access; /* NULL: a `shared` variable */
};
/* Of a pointer, image or sampled image. */
struct memory memory_of(const struct sanitizer *s, uint32_t id);
/* The variable or parameter that a pointer leads into. */
uint32_t memory_base(const struct spirv *from, uint32_t id);
/* Name, resource and words of an element for a site. */
void memory_name(const struct sanitizer *s, const struct memory *memory,
                 struct sanitize_site *site);

/* Visits each word of what a pointer leads to. word: its id; mark: of the value there, 0: none. Returns the mark of what is
 * read there, or 0. */
struct words {
    struct sanitizer *s;
    const struct memory *memory;
    uint32_t (*visit)(struct words *words, uint32_t word, uint32_t mark);
    uint32_t number, site; /* for the visitor */
};
/* mark: of the value that is stored, 0: none. Returns that of all words, 0 where no visitor returned one. */
uint32_t memory_visit(struct words *words, uint32_t pointer, uint32_t mark);
/* The first word of memory that the pointer points to; *words: how many there are, one after the other. */
uint32_t memory_range(struct sanitizer *s, const struct memory *memory, uint32_t pointer,
                      uint32_t *words);
/* The index of a texel in its image, by diptych_at_B(); 0: it is not followed. */
uint32_t memory_texel(struct sanitizer *s, const struct memory *memory, uint32_t place,
                      uint32_t lod);
/* The id of the cell of a texel or word: of an index by diptych_at_B(), or of a word of a `shared` variable. 0: none. */
uint32_t memory_cell(struct sanitizer *s, const struct memory *memory, uint32_t at);
/* diptych_NAME_B(at, ...) of the memory's binding: values get no more. Returns the result; 0: there is none. */
uint32_t memory_call(struct sanitizer *s, const struct memory *memory, const char *name,
                     const struct values *values);
/* The index of a word of a buffer in its resource, by diptych_at_B(). */
uint32_t memory_at(struct sanitizer *s, const struct memory *memory, uint32_t word);

/* What an image operation touches. */
struct texel_use {
    uint32_t image, place, lod; /* ids; lod 0: none */
};
bool memory_image(const uint32_t *instruction, struct texel_use *use);
/* The pointer that the instruction stores through, like that of modf(); 0: none. */
uint32_t memory_stored(const struct sanitizer *s, const uint32_t *instruction);
bool memory_is_atomic(const uint32_t *instruction, bool *stores); /* on a pointer */

/* ---- content.c ------------------------------------------------------------------------------- */

void content_begin(struct sanitizer *s);
void content_enter(struct sanitizer *s, const struct spirv_function *function);
void content_before(struct sanitizer *s, const uint32_t *instruction);
void content_after(struct sanitizer *s, const uint32_t *instruction);
void content_end(struct sanitizer *s); /* writes diptych_number() */
/* The type of marks of a value; 0: it has none. */
uint32_t content_shape(struct sanitizer *s, uint32_t type);

/* ---- race.c: race and flow ------------------------------------------------------------------- */

void race_before(struct sanitizer *s, size_t place);
bool race_is_barrier(const struct spirv *from, const uint32_t *instruction); /* of the workgroup */

/* ---- quads.c --------------------------------------------------------------------------------- */

void quads_begin(struct sanitizer *s);
bool quads_count_turns(
    const struct sanitizer
        *s); /* whether the function that is written needs the counters of its loops */
/* A number of how the invocation came to an instruction of such a function. */
uint32_t quads_path(struct sanitizer *s, size_t place);
void quads_before(struct sanitizer *s, size_t place); /* an instruction by its offset */
bool quads_discard(struct sanitizer *s,
                   const uint32_t *instruction); /* whether it has written a return instead */
void quads_after(struct sanitizer *s, const uint32_t *instruction);
void quads_end(struct sanitizer *s); /* writes diptych_quads() */

/* ---- assigned.c ------------------------------------------------------------------------------ */

/* Before a function is written, and around each instruction. */
void assigned_find(struct sanitizer *s, const struct spirv_function *function);
void assigned_reset(struct sanitizer *s, const struct spirv_function *function);
void assigned_before(struct sanitizer *s, const uint32_t *instruction);
void assigned_after(struct sanitizer *s, const uint32_t *instruction);
void assigned_begin(struct sanitizer *s);
