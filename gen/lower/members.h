/* The structs of panel.h and diptych.h that tables are made of, member by member. emit_members.c
 * prints them as C; tests/app/play_test.c compares them. A new member of a table is one line in members.c. */
#pragma once

#include "lower.h"

enum member_kind {
    MEMBER_UNSIGNED,
    MEMBER_SIGNED,
    MEMBER_FLAG,    /* bool */
    MEMBER_FLOATS,  /* one, or an array of them */
    MEMBER_DOUBLES, /* the same */
    MEMBER_TEXT,
    MEMBER_WORD,     /* an enumerator */
    MEMBER_MASK,     /* of enumerators */
    MEMBER_MIP,      /* or DT_ALL_MIPS */
    MEMBER_RESOURCE, /* index, or enum dt_builtin */
    MEMBER_PASS,
    MEMBER_STRIDE,    /* of a resource: the size of its struct */
    MEMBER_ROW,       /* a struct */
    MEMBER_POINTER,   /* to a struct; NULL: none */
    MEMBER_ROWS,      /* to structs; `count` */
    MEMBER_RESOURCES, /* to indices; `count` */
    MEMBER_NUMBERS    /* to uint16_t; `count`; NULL: none */
};

struct member {
    const char *name;
    size_t offset, size;
    enum member_kind kind;
    bool always;                     /* printed even if it is zero */
    const char *(*word)(unsigned i); /* WORD: of the value; MASK: of the bit */
    const struct members *rows;      /* ROW, POINTER, ROWS */
    size_t count;                    /* offset of the uint32_t that counts the elements */
};
struct members {
    const char *tag; /* of the struct */
    size_t size;
    bool tall; /* printed on several lines */
    const struct member *list;
    size_t count;
};
extern const struct members storage_members, sampler_members, program_members, need_members,
    demand_members, barrier_members, param_members, resource_members, pass_members;

/* The integer of a member; of a list, element `index`. */
int64_t member_integer(const struct member *member, const void *row, uint32_t index);
/* Elements of a list or an array, else 1. */
uint32_t member_count(const struct member *member, const void *row);

/* ---- emit_members.c -------------------------------------------------------------------------- */

struct c_output;
/* The row in braces. `indent`: of the line that it begins on. */
void emit_row(const struct c_output *c, const struct members *members, const void *row, int indent);
/* static const struct TAG NAME[]; nothing without rows. `label`: prints the designator of a row;
 * NULL: none. */
void emit_rows(const struct c_output *c, const char *name, const struct members *members,
               const void *rows, uint32_t count,
               void (*label)(const struct c_output *c, uint32_t index));
