/* A folder with one pass of one frame and all that is needed to run it alone, on any machine.
 * compare --bisect writes it, replay reads it. Its manifest.json names every other file, and
 * describes resources with the keys of a dump. */
#pragma once

#include "console/setup.h"
#include "spec/pipeline.h"
#include "result/dump_reader.h"
#include "result/region.h"
#include "result/rows.h"
#include "run/side.h"
#include "scenes/scene.h"

struct cJSON;

/* Key that marks the manifest; its value is the version of the format. */
#define EVIDENCE_MARK    "diptych_pass"
#define EVIDENCE_VERSION 1

/* All pointers are borrowed. */
struct evidence {
    struct console *console;
    const struct setup *setup;
    const struct pipeline *pipeline;
    const struct scene *scene;
    const struct rows *rows;
    const struct side *sides[2]; /* the first is taken as correct */
    const char *devices[2];      /* names of their devices */
    uint32_t frame;
    uint32_t guilty;             /* row of rows->outputs */
    struct region region;        /* of that row */
    struct dt_bytes *inputs;     /* of the first side: one per input row of the pass */
    struct dt_bytes *outputs[2]; /* of both sides given these inputs: one per output row */
};

/* Whether the folder can be written, checked before hours of work; logs its error. */
bool evidence_can_write(struct console *console, const char *place);

/* Writes the folder whole or not at all; logs its error. */
bool evidence_write(const struct evidence *evidence, const char *place);

/* An evidence folder in memory; everything is owned but the console. */
struct evidence_case {
    struct console *console;
    const char *folder;
    char *root;                /* its real path */
    struct dump_reader reader; /* gives what the pass found and left */
    struct setup setup;        /* what the pipeline was loaded with, from the folder */
    char *spec, *templates;    /* of the setup */
    struct pipeline pipeline;
    struct rows rows;
    struct scene scene; /* data only; a minimal scene when the pass uses none */
    struct dt_frame frame;
    uint32_t pass;
};

/* Reads the folder and loads its pipeline. Copies the rest of the setup into the case. On false the
 * error is logged; evidence_free either way. */
bool evidence_read(struct evidence_case *evidence, struct console *console, const char *folder,
                   const struct setup *setup);
/* What the other side left of an output; free(bytes->data). Logs its error. */
bool evidence_actual(const struct evidence_case *evidence, const struct row *row,
                     struct dt_bytes *bytes);
void evidence_free(struct evidence_case *evidence); /* takes a zeroed one */
