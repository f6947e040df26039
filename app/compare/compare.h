/* What `diptych compare` found out, and how it is told: compare.c fills it, compare_table.c prints
 * it, compare_json.c writes it. */
#ifndef DIPTYCH_COMPARE_H
#define DIPTYCH_COMPARE_H

#include "base/options.h"
#include "build/pipeline.h"
#include "compare/blame.h"
#include "result/difference.h"
#include "result/region.h"
#include "result/rows.h"
#include "result/strip.h"
#include "run/source.h"

/* One row of one pair over all frames. */
struct result {
    struct difference difference; /* of the frame in which the two are furthest apart */
    uint32_t frame;               /* that frame */
    uint32_t frames_differing;    /* in how many they are not bit for bit equal */
    char *picture;                /* file of that frame's strip, NULL: none; owned */
    struct strip strip;           /* what it shows */
};

/* The first side, and one of the others. */
struct pair {
    const struct side *sides[2];
    struct result *results;  /* one per row of rows.outputs */
    struct result *history;  /* one per row of rows.history: what the first frame found */
    struct difference found; /* of the row and frame that is being compared */
    /* the first that broke its contract: a row of rows.outputs, or of rows.history with broken_early */
    bool broken, broken_early;
    uint32_t broken_frame, broken_row;
    /* of the frame that broke first, or else of the one that is being compared: see blame.h */
    bool *outputs_differ, *history_differs;
    uint64_t *fingerprints;
    struct blame blame;
};

struct compare {
    struct console *console;
    struct options options;  /* with the frame of --against */
    struct dump_reader dump; /* the first side, with --against */
    struct sides sides;
    struct pipeline pipeline;
    struct scene scene;
    struct fault fault;
    uint32_t faulty; /* index of the side that has it */
    struct rows rows;
    struct source *sources; /* one per side */
    char **devices;         /* what the sides ran on */
    struct pair *pairs;
    uint32_t pair_count;         /* sides.count - 1 */
    uint64_t compared;           /* elements, over all rows, pairs and frames */
    bool complete;               /* all rows were compared */
    char *region;                /* of the guilty resource, in words; with --bisect */
    struct region found;         /* the same, */
    const struct pair *bisected; /* of this pair */
};

/* With --pictures, and when what the pair found last, in this row of rows.outputs, is an image that
 * differs: writes its strip and notes that in the result. Logs its error. */
bool compare_add_picture(struct compare *compare, uint32_t pair_index, uint32_t output);

/* The row at which a pair broke. */
const struct row *broken_row(const struct compare *compare, const struct pair *pair);

void compare_print(const struct compare *compare); /* on stdout */

struct cJSON *compare_json(const struct compare *compare); /* for --json */

#endif
