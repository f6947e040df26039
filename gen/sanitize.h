/* --sanitize: the shaders of a pipeline report undefined behaviour into a buffer of the generator's own, which every pass
 * updates. sanitize.c adds the buffer and reads it; spirv/sanitize.c instruments the shaders. */
#ifndef DIPTYCH_GEN_SANITIZE_H
#define DIPTYCH_GEN_SANITIZE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct access;
struct model;
struct pass;
struct resource;
struct text;
struct diag;

enum sanitize_kind { /* masks */
                     SANITIZE_INDEX = 1 << 0,
                     SANITIZE_ARITHMETIC = 1 << 1,
                     SANITIZE_LOOP = 1 << 2,
                     SANITIZE_VARIABLE = 1 << 3,
                     SANITIZE_CONTENT = 1 << 4,
                     SANITIZE_RACE = 1 << 5,
                     SANITIZE_FLOW = 1 << 6,
                     SANITIZE_SHADOW = SANITIZE_CONTENT | SANITIZE_RACE | SANITIZE_FLOW,
                     SANITIZE_ALL = (1 << 7) - 1
};
/* The mask of a list like "index,loop"; "" is all. 0: *end is where the unknown word begins. */
unsigned sanitize_kinds(const char *list, const char **end);
extern const char sanitize_names[]; /* "index,arithmetic,..." */

/* An operation that may be undefined. */
struct sanitize_site {
    const struct pass *pass; /* set by sanitize.c */
    uint32_t file, line;     /* by OpLine; file 0: generated text */
    const char *word;        /* of the operation in the line; lives as long as the text below */
    uint32_t nth;            /* operation of this word in the line, from 0 */
    /* the message; @0i is value 0 as an int, @4u value 4 as a uint, @1f value 1 as a float, @0e a texel or
     * element by its index in the resource, @1p an invocation by its number */
    char text[160], name[64];
    bool pairs;                      /* a race: value 0 is the invocation */
    const struct resource *resource; /* of @0e; NULL: a shared variable */
    uint32_t words, first;           /* shared: of an element, 0: no array; the variable's first */
};
/* Words of a site in the buffer, and of its records; see templates/glsl/sanitize.glsl. */
enum {
    SANITIZE_HEAD = 8,
    SANITIZE_RECORDS = 16,
    SANITIZE_RECORD = 12,
    SANITIZE_WORDS = SANITIZE_HEAD + SANITIZE_RECORDS * SANITIZE_RECORD
};

struct sanitize_sites;                    /* of a model; shared by the threads that compile */
bool sanitize_begin(struct model *model); /* false: out of memory */
void sanitize_end(struct model *model);
uint32_t sanitize_add(const struct model *model, const struct pass *pass,
                      const struct sanitize_site *site);
bool sanitize_failed(const struct model *model); /* out of memory while sites were added */

/* In the order of the plan: gives every pass the buffer, before bindings; sets its count, after all shaders are compiled. */
bool sanitize_plan(struct model *model);
bool sanitize_count(struct model *model, struct diag *diag);

/* The GLSL that a stage gets. */
struct glsl;
bool sanitize_glsl(struct glsl *glsl);
/* A library file, with `words` replaced in it: pairs of a word and its text, up to NULL. */
bool sanitize_library(struct glsl *glsl, const char *name, const char *const *words);
/* Gives the pass access to an internal resource. */
struct access *sanitize_access(struct pass *pass, struct resource *resource);
/* The layout of the pass's binding of an internal resource; NULL: out of memory. */
const char *sanitize_layout(const struct glsl *glsl, const char *resource);

/* ---- shadow.c: memory beside that of the pipeline, which says what was written, and by whom --- */

enum { /* most internal resources of a pipeline, and accesses of a pass to them */
       SANITIZE_RESOURCES = 5,
       SANITIZE_ACCESSES = 4
};
void shadow_plan(struct model *model);
bool shadow_glsl(struct glsl *glsl);
/* Words of an internal resource at a frame size; 0: its count says it. */
uint64_t shadow_words(const struct model *model, const struct resource *resource, uint32_t width,
                      uint32_t height);
/* Where the word or texel of a resource is: "texel (3, 0) of `name`", "element 2 of `name`". */
void shadow_place(const struct sanitize_site *site, uint32_t at, uint32_t frame_size, char *text,
                  size_t room);

/* What the buffer's content tells: messages in the order of their places, an empty text where nothing was found. Returns
 * the number of places. */
struct sanitize_report {
    const char *pass, *file;
    int line, column;
    uint32_t invocation[3], frame;
    uint32_t count;
    char text[256];
};
/* *reports: free(). False when out of memory. */
bool sanitize_read(const struct model *model, const void *bytes, uint64_t size,
                   struct sanitize_report **reports, uint32_t *count);

#endif
