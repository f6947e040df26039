/* Results of `compare A B`: dumps of two renderers. dumps.c fills them, dumps_print.c prints them. */
#pragma once

#include "console/console.h"
#include "console/options.h"
#include "result/measured.h"
#include "result/sheet.h"
#include "theirs/theirs.h"

/* An entry of the first dump and its partner in the second. */
struct match {
    struct their_entry *sides[2]; /* sides[1] NULL: it has no partner */
    char *place;                  /* PASS.RESOURCE; owned */
    char *name;                   /* of the resource, with mip and frame; owned */
    char *note; /* what was converted, or why nothing could be compared; owned; may be NULL */
    struct dt_resource what; /* both copies' common form; fields are borrowed of the first */
    const struct kept_contract *kept; /* NULL: the default */
    struct sheet_row *row;            /* what is shown of it */
};

/* Two sides. */
struct dumps {
    struct console *console;
    const struct options *options;
    const struct contracts *contracts;
    struct theirs *sides[2]; /* borrowed; with --measure the first of `runs` */
    uint32_t runs;           /* dumps of each side */
    bool several;            /* one of several pairs */
    struct match *matches;
    uint32_t count;
    struct match *first; /* that differs; NULL: none */
    struct match
        *loud; /* the first that differs by more than rounding noise; NULL: none is known */
    struct sheet sheet; /* rows of all matches, and of entries that the second side alone has */
};

/* Brings both copies into one form: fields at the same places, the smaller format, one origin. Fills match->what
 * and match->note. False: they cannot be compared, and match->note says why. */
bool dumps_convert(struct match *match, struct dt_bytes copies[2]);

/* All below log their errors. */

/* Matches the entries of both sides; `sides` are open. dumps_free either way. */
bool dumps_match(struct dumps *dumps);
/* Judges all matches, and does what --measure asks for. */
bool dumps_compare(struct dumps *dumps);
void dumps_free(struct dumps *dumps); /* takes a zeroed one */

/* Fills what the sheet tells when all is known. */
void dumps_conclude(struct dumps *dumps);
bool dumps_print(const struct dumps *dumps); /* on stdout; false: told */
