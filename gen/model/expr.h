/* Integer expressions of the spec: + - * / % ( ) comparisons && || ! ?:, min max ceil_div, names
 * of parameters and constants, components (tile.x), frame.width, frame.height; and lut.width,
 * lut.height and kernel.count of resources with a `file`. 64-bit, overflow and division by zero
 * are errors. */
#pragma once

#include "source.h"
#include "base/text.h"

/* Names with a meaning of their own where the expression stands: inside a group or repeat. */
struct expr_text;
struct expr_names {
    /* Whether `name` stands for a text, which lives as long as the model. */
    bool (*find)(const void *scope, const char *name, struct expr_text *text);
    const void *scope;
};
struct expr_text {
    const char *text;
    struct expr_names names; /* of the text; find NULL: none */
};
/* names: NULL: none. NULL after an error at the offending column. A plain integer scalar is an
 * expression too. */
struct expr *expr_parse(struct model *model, const char *text, struct loc loc,
                        const struct expr_names *names, struct diag *diag);
/* Resolves names against params, constants and files; reports unknown ones with a suggestion.
 * Booleans count as 0 and 1. */
bool expr_resolve(struct expr *expr, const struct pipeline *pipeline, struct diag *diag);

enum expr_reach {
    EXPR_BAKED = 0,
    EXPR_FRAME = 1,
    EXPR_LIVE = 2
}; /* mask: what the value depends on; `0 && live` on nothing */
unsigned expr_reach(const struct expr *expr);
/* Whether GLSL gets the value as a literal: it is baked and uses no uniform parameter. */
bool expr_is_literal(const struct expr *expr);
bool constant_is_literal(const struct constant *constant);

enum expr_result { EXPR_OK, EXPR_DIVIDES_BY_ZERO, EXPR_OVERFLOWS };
/* Live parameters have their default values. */
enum expr_result expr_eval(const struct expr *expr, int64_t frame_width, int64_t frame_height,
                           int64_t *value);
/* The same with live parameters from a block (struct NAME_live). */
enum expr_result expr_eval_live(const struct expr *expr, int64_t frame_width, int64_t frame_height,
                                const void *live, int64_t *value);
/* Place of the whole expression, for messages. */
struct loc expr_loc(const struct expr *expr);
/* Place of the part where expr_eval fails; of the whole expression when it succeeds. */
struct loc expr_fault_loc(const struct expr *expr, int64_t frame_width, int64_t frame_height);
enum { EXPR_MOST_TERMS = 1000 };
/* Operators, names and numbers, with those of the constants that it names. */
size_t expr_terms(const struct expr *expr);
/* Whether the expression itself names this parameter or constant; not through a constant. */
bool expr_mentions(const struct expr *expr, const char *name);

/* C: baked parts as literals, frame.width as `width`, live parameters as `live->NAME`; int64_t
 * arithmetic. */
void expr_emit_c(const struct expr *expr, struct text *out);
/* The same as a condition: whether the value is not 0. */
void expr_emit_c_condition(const struct expr *expr, struct text *out);
/* GLSL int: frame.width as int(frame.width), live and uniform parameters by name. */
void expr_emit_glsl(const struct expr *expr, struct text *out);
