/* Results of `diptych compare`: compare.c fills them, compare_table.c prints them,
 * compare_json.c writes them as JSON, and hands them over for page and XML. */
#pragma once

#include "console/folder.h"
#include "console/options.h"
#include "spec/pipeline.h"
#include "compare/blame.h"
#include "compare/elsewhere.h"
#include "result/difference.h"
#include "result/identity.h"
#include "result/measured.h"
#include "result/region.h"
#include "result/rows.h"
#include "result/sheet.h"
#include "run/source.h"
#include "run/undefined.h"
#include "compare/twin.h"

/* The folder of --golden: hashes of what the first side leaves in all frames, and its pictures. */
struct golden {
    struct folder folder;    /* --update: being written */
    struct cJSON *kept;      /* its manifest */
    uint64_t *hashes;        /* one per row of rows.outputs */
    struct cJSON *differing; /* [{"pass", "resource", "mip", "is": "different", "new" or "gone"}] */
};

/* The first side, and one of the others. */
struct pair {
    const struct side *sides[2];
    struct sheet sheet;        /* what is shown of it: rows of rows.history, then of rows.outputs */
    struct sheet_row *results; /* of the sheet: one per row of rows.outputs, over all frames */
    struct difference found;   /* of the row and frame being compared */
    struct sheet_row *broken;  /* the first that broke its contract, NULL: none, */
    uint32_t broken_frame;     /* in this frame */
    struct blame blame;
    char *unwritten;   /* what unwritten_find tells of that row; NULL: nothing; owned */
    struct cJSON *why; /* why_ask of that row and frame, with all inputs as they were */
};

struct compare {
    struct console *console;
    struct options options;  /* with the frame of --against */
    struct dump_reader dump; /* the first side, with --against */
    struct golden golden;
    struct sides sides;
    struct pipeline pipeline;
    struct scene scene;
    struct rows rows;
    /* one per side; with --measure, behind them, further runs of the first side, of the second ... */
    struct row_source *sources;
    uint32_t source_count;
    struct contracts contracts; /* --contracts */
    struct pipeline exact;      /* if a pass is judged against its exact twin, */
    struct twin *twins;         /* one per side; NULL: none is */
    struct undefined undefined; /* --sanitize */
    struct elsewhere elsewhere;
    char **devices;      /* names of the devices */
    const char **labels; /* of the sides */
    struct pair *pairs;
    const struct sheet **sheets; /* of the pairs */
    uint32_t pair_count;         /* sides.count - 1 */
    uint64_t compared;           /* compared elements of all rows, pairs and frames */
    bool complete;               /* all rows were compared */
    char *region;                /* --bisect: region of the guilty resource as text */
    struct region found;         /* the same, */
    struct pair *bisected;       /* of this pair */
};

/* --measure: adds what all runs of all sides have left in a row of rows.outputs. Logs its error. */
bool compare_measure(struct compare *compare, uint32_t output);
/* Of the first side with a pass that is too far from its exact twin; NULL: none. */
const struct twin *compare_far_twin(const struct compare *compare);

/* Takes size and frames from the folder, or begins to write it; before the pipeline is loaded. These
 * three log their errors. */
bool golden_open(struct compare *compare);
bool golden_suits(const struct compare *compare); /* logged: it was made of another pipeline */
/* Takes what the first side left in a row of rows.outputs, by its fingerprint; at the stop after its pass. */
bool golden_add(struct compare *compare, uint32_t output, uint32_t frame, uint64_t hash);
/* Finds what differs; --update: puts the new folder in its place, if the sides agree. */
bool golden_end(struct compare *compare);
bool golden_differs(const struct compare *compare);
void golden_print(const struct compare *compare); /* on stdout */
void golden_free(struct golden *golden);          /* takes a zeroed one */

bool compare_print(const struct compare *compare);         /* on stdout; false: told */
struct cJSON *compare_json(const struct compare *compare); /* for --json */

bool compare_write_pages(const struct compare *compare); /* --html and --junit; logs its errors */
