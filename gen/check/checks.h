/* What the files of the check stage share. Internal to check*.c. */
#pragma once

#include "model/expr.h"
#include "model/names.h"

struct checker {
    struct model *model;
    struct pipeline *pipeline;
    struct diag *diag;
    const char *templates_dir;
    /* every expression of the spec, for the search for unused names */
    const struct expr **exprs;
    size_t expr_count, expr_capacity;
    bool out_of_memory;
};

/* check.c: "no WHAT `name`", with a suggestion among names of these kinds. */
void report_missing(const struct checker *c, struct loc loc, const char *what, const char *name,
                    unsigned kinds);

/* check_values.c. reach: what the expression may depend on, a mask of enum expr_reach. */
struct limits {
    const char *what; /* "the count" */
    const char *of;   /* name of the declaration */
    unsigned reach;
    int64_t least, most;
};
/* Resolves, then evaluates at several frame sizes and values of live parameters; reports at most
 * one error. */
bool check_expr(struct checker *c, struct expr *expr, const struct limits *limits);
/* The same of a baked expression, with its value. */
bool check_baked(struct checker *c, struct expr *expr, const struct limits *limits, int64_t *value);
/* For limits: "the width of the workgroup". */
const char *check_part(struct checker *c, const char *part, const char *whole);
void check_params(struct checker *c);
/* Cycles; folds. Wrong constants lose their value and count as 1, wrong resources lose their size. */
void check_constants(struct checker *c);
void check_sizes(struct checker *c); /* of buffers, images, samplers, interleaves */
void check_jitter(struct checker *c);
void check_asserts(struct checker *c);
enum { FRAME_SIZES = 3 };
extern const int frame_sizes[FRAME_SIZES][2];
/* Width, height and layers of an image's mip level; false: the size had an error. */
bool image_extent(const struct resource *image, uint32_t mip, const int frame[2],
                  int64_t extent[3]);

/* check_names.c */
void check_names(struct checker *c); /* duplicates, reserved words */
/* Reserved words of GLSL for `as`. Not of whole shaders, which may be HLSL, or modules. */
void check_body_words(struct checker *c, const struct pass *pass);
/* Resolves names: element types, accesses, uses, after, outputs. */
void check_references(struct checker *c);
bool pass_writes(const struct pass *pass, const struct resource *resource); /* check.c */

/* check_passes.c: formats, targets, conflicts, ranges, sizes of dispatches. */
void check_passes(struct checker *c);

/* check_content.c: files and inputs fit their buffers and images; no pass writes them. After
 * references. */
void check_content(struct checker *c);

/* check_contracts.c: contracts fit their resource; resolves margins. After references and sizes. */
void check_contracts(struct checker *c);

/* check_bodies.c */
void check_bodies(struct checker *c); /* files exist and use only names that the pass lists */
void check_unused(struct checker *c); /* warnings */
