/* Results of `compare A B`: dumps of two renderers. dumps.c fills them, dumps_print.c prints them and
 * makes the JSON. */
#ifndef DIPTYCH_DUMPS_H
#define DIPTYCH_DUMPS_H

#include "console/console.h"
#include "result/difference.h"
#include "theirs/theirs.h"
#include "theirs/why.h"

/* An entry of the first dump and its partner in the second. */
struct match {
    struct their_entry *sides[2]; /* sides[1] NULL: it has no partner */
    char *place;                  /* PASS.RESOURCE; owned */
    bool compared;
    char *note; /* what was converted, or why nothing could be compared; owned; may be NULL */
    struct dt_resource what; /* both copies' common form; fields are borrowed of the first */
    struct difference difference;
    uint64_t
        not_finite; /* numbers that are NaN or the same infinity in both copies: they count as equal */
    struct why why; /* of resources of the guilty pass */
};

/* A contract of a file of --contracts. */
struct their_contract {
    const char *name; /* a resource, PASS.RESOURCE, or "default"; owned by the dump or a literal */
    struct dt_contract contract;
};

struct dumps {
    struct console *console;
    struct theirs sides[2];
    struct match *matches;
    uint32_t count;
    struct their_contract *contracts;
    uint32_t contract_count;
    const struct match *asked;  /* while its difference is explained */
    const struct match *guilty; /* the first that differs; NULL: none */
    uint32_t alone[2];          /* entries of each side without a partner */
};

/* Brings both copies into one form: fields at the same places, the smaller format, one origin. Fills match->what
 * and match->note. False: they cannot be compared, and match->note says why. */
bool dumps_convert(struct match *match, struct dt_bytes copies[2]);

/* Reads --contracts; logs its errors. */
bool dumps_contracts(struct dumps *dumps, const char *path);

void dumps_print(const struct dumps *dumps); /* on stdout */
struct cJSON *dumps_json(const struct dumps *dumps);

#endif
