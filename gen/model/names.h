/* What a pipeline declares, of all kinds in one order: parameters, constants, structs, resources, samplers,
 * metrics, interleaves, passes. The reader, the checks and expressions find names here. */
#pragma once

#include "model.h"
#include "base/nearest.h"

/* The struct of every declaration begins with these. */
struct declared {
    const char *name, *doc;
    struct loc loc;
};

enum declared_kind {                          /* masks */
                     DECLARED_FLOAT = 1 << 0, /* a parameter of type float */
                     DECLARED_OTHER = 1 << 1, /* any other parameter */
                     DECLARED_CONSTANT = 1 << 2,
                     DECLARED_STRUCT = 1 << 3,
                     DECLARED_BUFFER = 1 << 4,
                     DECLARED_IMAGE = 1 << 5,
                     DECLARED_POINTS = 1 << 6,
                     DECLARED_FILTER = 1 << 7,
                     DECLARED_METRIC = 1 << 8,
                     DECLARED_INTERLEAVE = 1 << 9,
                     DECLARED_PASS = 1 << 10,
                     /* for hints: names that no spec declares */
                     DECLARED_SCENE = 1 << 11, /* scene_vertices, ... */
                     DECLARED_TYPE = 1 << 12,  /* float, vec2, ... */
                     DECLARED_PARAM = DECLARED_FLOAT | DECLARED_OTHER,
                     DECLARED_RESOURCE = DECLARED_BUFFER | DECLARED_IMAGE,
                     DECLARED_SAMPLER = DECLARED_POINTS | DECLARED_FILTER,
                     /* what a pass lists in `uses` */
                     DECLARED_FUNCTION = DECLARED_SAMPLER | DECLARED_METRIC | DECLARED_INTERLEAVE
};

/* The declaration of that number, counted over all kinds; NULL: there are no more. */
struct declared *declared_at(const struct pipeline *pipeline, size_t index,
                             enum declared_kind *kind);
/* The first of one of these kinds with this name, as the struct of its kind; NULL: none. */
void *declared_find(const struct pipeline *pipeline, unsigned kinds, const char *name);
/* For the end of a message: the nearest name of these kinds; see name_hint. */
struct name_hint declared_hint(const struct pipeline *pipeline, unsigned kinds, const char *name,
                               const char *otherwise);
const char *declared_word(enum declared_kind kind); /* of one kind: "parameter" */

/* What bodies have beside a name: NAME_size and the like. */
struct derived_word {
    unsigned kinds;
    const char *ending;
    bool reserved; /* nothing else may be declared with it */
};
enum { DERIVED_WORDS = 22 };
extern const struct derived_word derived_words[DERIVED_WORDS];
/* The ending with which a word is made of a name of the kind, "" for the name itself; NULL: it is another word. */
const char *declared_ending(enum declared_kind kind, const char *name, const char *word);
