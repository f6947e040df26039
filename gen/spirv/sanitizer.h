/* What the files of --sanitize share: sanitize.c walks through a module, assigned.c follows which variables have values. */
#ifndef DIPTYCH_GEN_SPIRV_SANITIZER_H
#define DIPTYCH_GEN_SPIRV_SANITIZER_H

#include "sanitize.h"

struct sanitizer {
    const struct sanitize_request *request;
    const struct spirv *from;
    struct spirv_edit edit;
    uint32_t glsl;
    uint32_t file, line;     /* of the operation; file 0: text of the generator */
    unsigned kind;           /* of the next sites */
    uint32_t label;          /* of the block that is written; 0: none yet */
    bool begun;              /* the variables of the function are written */
    struct spirv_words seen; /* pairs of a hash of file, line and word, and the operations so far */
    uint32_t *counters;      /* by label of a loop's header: its variable; 0: no loop */
    struct assigned *ids;    /* by id */
    struct spirv_words variables; /* of this pass, in the private storage class */
};

struct values { /* operands of a check */
    uint32_t ids[8], count;
};

uint32_t sanitizer_uint(struct sanitizer *s); /* the type */
uint32_t sanitizer_number(struct sanitizer *s, uint32_t value);
/* The result of a call; 0: there is no such function. */
uint32_t sanitizer_call(struct sanitizer *s, const char *mangled, const struct values *values);
/* The index of a new site. name: copied; word: a literal, NULL: the name. */
uint32_t sanitizer_site(struct sanitizer *s, const char *word, const char *name, const char *text);
/* Appends place and operation. */
void sanitizer_place(struct sanitizer *s, struct values *values, uint32_t site);

/* assigned.c: before a function is written, and around each instruction. */
void assigned_find(struct sanitizer *s, const struct spirv_function *function);
void assigned_reset(struct sanitizer *s, const struct spirv_function *function);
void assigned_before(struct sanitizer *s, const uint32_t *instruction);
void assigned_after(struct sanitizer *s, const uint32_t *instruction);
bool assigned_begin(struct sanitizer *s); /* once; false: out of memory */

#endif
