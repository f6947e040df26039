/* --sanitize: the shaders of a pipeline report undefined behaviour into a buffer of the generator's own, which every pass
 * updates. sanitize.c adds the buffer and reads it; glsl/sanitize_glsl.c gives the shaders the
 * checks, spirv/sanitize.c calls them. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "diptych_reports.h"
#include "model/sanitize_kinds.h"

struct access;
struct model;
struct pass;
struct pipeline;
struct resource;
struct text;
struct diag;

/* An operation that may be undefined. */
struct sanitize_site {
    const struct pass *pass; /* set by sanitize.c */
    unsigned kind;           /* enum sanitize_kind */
    uint32_t file, line;     /* by OpLine; file 0: generated text */
    uint32_t more;           /* sites of equal content behind it */
    const char *word;        /* of the operation in the line; lives as long as the text below */
    uint32_t nth;            /* operation of this word in the line, from 0 */
    /* as struct dt_site has them */
    char text[160], name[64];
    bool pairs;                      /* a race: value 0 is the invocation */
    const struct resource *resource; /* of @0e; NULL: a shared variable */
    uint32_t words, first;           /* shared: of an element, 0: no array; the variable's first */
};
/* Findings that an invocation of a pass keeps: in this many rooms, which its operations take in turn, and one for each kind
 * that the pass allows. The number is a prime: lines that look alike do not take each other's rooms. */
enum { SANITIZE_FREE_ROOMS = 5, SANITIZE_ROOMS = 32 };

struct sanitize_sites;                    /* of a model; shared by the threads that compile */
bool sanitize_begin(struct model *model); /* false: out of memory */
void sanitize_end(struct model *model);
/* Returns the index of the first; with `more`, the others follow it. */
uint32_t sanitize_add(const struct model *model, const struct pass *pass,
                      const struct sanitize_site *site);
/* Sites are numbered in the order of the shaders, so that the same spec gives the same bytes. Waits until all shaders before `turn`
 * have theirs; sanitize_end_turn() lets the next one go, and a shader that fails must do so, too. */
void sanitize_begin_turn(const struct model *model, uint32_t turn);
void sanitize_end_turn(const struct model *model, uint32_t turn);
bool sanitize_failed(const struct model *model); /* out of memory while sites were added */

/* In the order of the plan: gives every pass the buffer, before bindings; sets its count, after all shaders are compiled. */
bool sanitize_plan(struct model *model);
bool sanitize_count(struct model *model, struct diag *diag);
extern const char sanitize_buffer[]; /* its name */
/* A new internal buffer of words; gives the pass access to one. */
struct resource *sanitize_resource(struct pipeline *pipeline, const char *name);
struct access *sanitize_access(struct pass *pass, struct resource *resource);

/* All sites for diptych_reports.h, once all shaders are compiled; they live with the model. NULL: out of memory. */
const struct dt_site *sanitize_table(const struct model *model, uint32_t *count);
/* What the buffer's content tells, in the order of places, without what `allow` of a pass silences. pipeline: of the model's
 * tables. *findings: free(); they refer to the model. False when out of memory. */
bool sanitize_read(const struct model *model, const struct dt_pipeline *pipeline, const void *bytes,
                   uint64_t size, struct dt_finding **findings, uint32_t *count);
/* Warns of each `allow` that has silenced nothing in all contents so far, among the kinds that were looked for. */
void sanitize_warn_idle(const struct model *model, struct diag *diag);
