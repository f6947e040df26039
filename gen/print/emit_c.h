/* What the emitters of C share: names, literals, expressions. Defined in emit_c.c; used by
 * emit_header.c, emit_pipeline.c, emit_panel.c and emit_shaders.c. Emitters read the model and its
 * tables and never change them. */
#pragma once

#include "model/expr.h"
#include "print.h"
#include "plan/plan.h"

struct c_output {
    const struct model *model;
    const struct pipeline *pipeline;
    const struct lowered *tables; /* NULL for NAME.h */
    struct text *out;
    const char *suffix; /* ends the names of the tables for GPUs; NULL: these are the others */
};
#define C_GPU "_gpu"

/* Prints a text with slots: @n and @N, the pipeline's name and the same in capitals; others take an
 * argument: @s a text, @w the same as an identifier, @U in capitals, @q as a string with quotes, @c as a
 * comment; @u a uint32_t; @R and @P names of a resource and a pass by index; @E an expression. */
void c_add(const struct c_output *c, const char *text, ...);
void c_resource(const struct c_output *c,
                uint32_t resource); /* or the name of an enum dt_builtin */
void c_pass(const struct c_output *c, uint32_t pass);
void c_string(struct text *out, const char *text);  /* with quotes; NULL: "" */
void c_comment(struct text *out, const char *text); /* on one line, cannot end a comment */
void c_double(struct text *out, double value);      /* a double constant expression */
void c_float(struct text *out, double value);       /* a float constant */
/* An int64_t expression: a literal when it is baked; NULL: 1. */
void c_expr(struct text *out, const struct expr *expr);
void c_amount(const struct c_output *c, const struct amount *amount); /* IMAGE: of `size` */
/* Two members of a struct: a table and its length; nothing for an empty one. */
void c_table(const struct c_output *c, const char *name, const char *count, uint32_t n);
/* Declares those of `width`, `height` and `live` that the function body uses, with values from a
 * struct dt_recording `r`. */
void c_frame_locals(const struct c_output *c, const char *body);
/* Prints what both targets have, a table or a function: once where both texts are the same, else again
 * with the suffix. Returns whether it did. */
bool c_both(const struct c_output *c, void (*emit)(const struct c_output *c, uint32_t index),
            uint32_t index);
/* The first comment of a generated file; `what` follows the pipeline's doc or name. */
void c_head(const struct c_output *c, const char *what);

/* emit_pipeline.c: the reflection, the first half of NAME.c; its end, nothing without --sanitize. */
void emit_reflection(const struct c_output *c);
void emit_sites(const struct c_output *c);
