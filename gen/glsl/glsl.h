/* What the files that write GLSL share: emit_glsl.c (the stage as a whole), glsl_access.c
 * (resources and their accessors), glsl_body.c (the author's text), glsl_range.c (loops over
 * ranges), glsl_library.c (templates/glsl).
 *
 * A stage is written from its end to its beginning: the body first, then the declarations that the
 * body uses, then those that these use. So each declaration can check whether later text uses it,
 * and unused ones are left out. */
#pragma once

#include <stdio.h>
#include <string.h>

#include "read/body_files.h"
#include "model/expr.h"
#include "glslang.h"
#include "shader.h"

/* Parts in the order of the output; filled from the last to the first. */
enum glsl_part {
    PART_HEAD,      /* #version, extensions, macros, workgroup size */
    PART_CONSTANTS, /* parameters, constants */
    PART_STRUCTS,
    PART_LIBRARY, /* pieces of templates/glsl, with the block of the frame */
    PART_RESOURCES,
    PART_FUNCTIONS, /* accessors, samplers, metrics, interleaves */
    PART_CACHES,    /* shared memory of ranges */
    PART_VALUES,    /* of a whole shader: functions that give its uniforms their values */
    PART_CHECKS,    /* --sanitize: library files, which use no declaration of other parts */
    PART_END,       /* diptych_end(): what runs behind the body's main */
    PART_DEFINES,   /* the pass's `defines`, and names that the body has of its own */
    PART_BODY,
    PART_COUNT
};

struct glsl {
    struct model *model;
    const struct pipeline *pipeline;
    const struct pass *pass;
    enum backend backend;
    enum stage stage;
    struct diag *diag;
    const struct body_files *files; /* of the body; NULL: the generator's */
    const struct shader *shader;
    bool own;       /* becomes shader.own */
    bool expanded;  /* the body is behind the preprocessor: nothing is left to include */
    bool whole;     /* the body is a whole shader: it sees nothing of the generator's */
    bool subgroups; /* glsl_body: the body may have subgroup operations */
    struct text parts[PART_COUNT];
};

/* Whether any part filled so far contains an identifier (printf-like). Members after a dot do not
 * count. */
bool glsl_uses(const struct glsl *glsl, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* "set = 0, binding = 3". */
void glsl_binding(int binding, struct text *out);
/* Puts `front` at the beginning of the part and empties `front`. */
void glsl_put_before(struct text *part, struct text *front);
/* Name of a type in GLSL. */
const char *glsl_type(enum dt_type type);
const char *glsl_element_type(const struct resource *buffer); /* struct or type name */

/* ---- Parts ----------------------------------------------------------------------------------- */

/* glsl_body.c: #line and the author's file, into PART_BODY; loops over ranges are expanded. */
bool glsl_body(struct glsl *glsl);
/* glsl_body.c: the body for glslang alone, with its macros. */
void glsl_own_text(const struct glsl *glsl, struct text *out);
/* glsl_body.c: glslang_job.include, of struct body_files as `user`. */
bool glsl_include(const void *user, const char *from, const char *name, struct glslang_file *file);
/* glsl_body.c: into PART_END: colour targets are rounded; Vulkan's vertex stage of a layered draw
 * drops vertices of layers that are not drawn. */
void glsl_end(struct glsl *glsl);
/* glsl_body.c: diptych_zero(), into PART_END. */
void glsl_zero(struct glsl *glsl);
/* emit_glsl.c: the generator's macros of the stage, and those of the pass's `defines`. */
void glsl_macros(const struct glsl *glsl, struct text *out);
void glsl_defines(const struct glsl *glsl, struct text *out);
/* glsl_messages.c: sets column and length of `loc` to the first `word` in its line; false: none. */
bool glsl_find_in_line(struct loc *loc, const char *word, size_t length);
/* Place in a source file of a piece of PART_BODY. */
struct loc glsl_body_loc(const struct glsl *glsl, const char *body, size_t offset, size_t length);
/* glsl_range.c: expands `for (Type v : range) { ... }` in PART_BODY; adds declarations to
 * PART_CACHES. */
bool glsl_ranges(struct glsl *glsl);
/* glsl_values.c: into PART_VALUES, for spirv/bind.c: TYPE diptych_value_NAME() for every uniform or
 * input of a whole shader that has a value. */
void glsl_values(struct glsl *glsl);
/* The block of live parameters beside a whole shader, which may have members of the same names. */
#define GLSL_LIVE "diptych_live"
/* The names of other parameters begin so there. */
#define GLSL_BAKED "diptych_"
/* glsl_access.c: functions that read the scene's texel buffers, for spirv/texels.c. */
void glsl_texels(struct glsl *glsl);
/* glsl_access.c: what GLSL declares for an access to an image, as "usampler2DArray". */
void glsl_declared(const struct access *access, char *out, size_t size);
/* glsl_access.c: into PART_FUNCTIONS and PART_RESOURCES. */
void glsl_accessors(struct glsl *glsl);
void glsl_resources(struct glsl *glsl);
bool glsl_check_accesses(struct glsl *glsl);
/* glsl_library.c: puts the definitions of templates/glsl/NAME.glsl that the stage uses before
 * PART_LIBRARY. Replaces @layout@ in them by `layout`. */
bool glsl_library(struct glsl *glsl, const char *name, const char *layout);
/* A file of templates/glsl; NULL: reported. A text with `words` replaced in it: pairs of a word that begins
 * with @ and its text, up to NULL. */
const struct source *glsl_library_file(struct glsl *glsl, const char *name);
void glsl_fill(struct text *out, const char *text, const char *const *words);

/* sanitize_glsl.c: the checks of --sanitize, into PART_END. */
bool sanitize_glsl(struct glsl *glsl);
/* A filled file of templates/glsl, into PART_CHECKS. */
bool sanitize_library(struct glsl *glsl, const char *name, const char *const *words);
/* The layout of the pass's binding of an internal resource; NULL: out of memory. */
const char *sanitize_layout(const struct glsl *glsl, const char *resource);
/* shadow_glsl.c */
bool shadow_glsl(struct glsl *glsl);
