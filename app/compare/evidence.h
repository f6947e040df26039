/* One pass of one frame with all that it takes to run it alone, anywhere: written as a folder by
 * compare --bisect, read by replay. Its manifest.json names every other file in it, with the keys of
 * a dump where they describe a resource. */
#ifndef DIPTYCH_EVIDENCE_H
#define DIPTYCH_EVIDENCE_H

#include "base/options.h"
#include "build/pipeline.h"
#include "result/region.h"
#include "result/rows.h"
#include "run/side.h"
#include "scenes/scene.h"

struct cJSON;

/* Marks the manifest; its value tells the version of the format. */
#define EVIDENCE_MARK    "diptych_pass"
#define EVIDENCE_VERSION 1

/* All pointers are borrowed. */
struct evidence {
    struct console *console;
    const struct options *options;
    const struct pipeline *pipeline;
    const struct scene *scene;
    const struct rows *rows;
    const struct side *sides[2]; /* the first is held to be right */
    const char *devices[2];      /* that they ran on */
    uint32_t frame;
    uint32_t guilty;             /* row of rows->outputs */
    struct region region;        /* of that row */
    struct dt_bytes *inputs;     /* of the first side: one per input row of the pass */
    struct dt_bytes *outputs[2]; /* of both sides given these inputs: one per output row */
};

/* Whether there is room for the folder, asked before hours of work; logs its error. */
bool evidence_can_write(struct console *console, const char *place);

/* Writes the folder whole or not at all; logs its error. */
bool evidence_write(const struct evidence *evidence, const char *place);

/* An evidence folder in memory; everything is owned but the console. */
struct evidence_case {
    struct console *console;
    const char *folder;
    struct cJSON *manifest;
    struct options options; /* that the pipeline was loaded with: the folder's, not the command's */
    char *spec, *templates; /* of these options */
    struct pipeline pipeline;
    struct rows rows;
    struct scene scene; /* nothing but its data; the least possible where the pass uses none */
    struct dt_frame frame;
    uint32_t pass;
    struct dt_bytes *inputs;     /* one per input row of the pass */
    struct dt_bytes *outputs[2]; /* one per output row: as expected, and as the other side had it */
};

/* Reads options->folder, with its pipeline generated and compiled anew where it is not cached. The
 * rest of `options` goes along into the case. On false the error is logged; evidence_free either
 * way. */
bool evidence_read(struct evidence_case *evidence, struct console *console,
                   const struct options *options);
void evidence_free(struct evidence_case *evidence); /* takes a zeroed one */

#endif
