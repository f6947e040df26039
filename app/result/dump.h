/* --dump: what every pass produced, as raw little-endian files and a manifest.json. */
#pragma once

#include <cjson/cJSON.h>

#include "console/folder.h"

/* A dump being written. */
struct dump {
    struct console *console;
    const struct dt_pipeline *pipeline;
    struct folder folder;
    cJSON *manifest;          /* the caller adds what was run; see identity.h */
    cJSON *history, *entries; /* of the manifest, last */
};

/* Refuses a folder that exists and is not an earlier dump. On false the error is logged; dump_end
 * either way. */
bool dump_begin(struct dump *dump, struct console *console, const struct dt_pipeline *pipeline,
                const char *folder);

/* One mip of a resource, 0 for a buffer, after a pass; with DUMP_HISTORY as pass: as the frame found
 * it. Sets the padding between fields in bytes to zero. */
#define DUMP_HISTORY UINT32_MAX
bool dump_add(struct dump *dump, uint32_t pass, uint32_t resource, uint32_t mip,
              struct dt_bytes *bytes);

/* Describes the file of one mip as keys of a JSON object: resource, mip (if several), kind, fields
 * or format, stride, and count or width, height and layers. */
void dump_describe(cJSON *entry, const struct dt_resource *resource, uint32_t mip,
                   const uint32_t extent[3]);

/* Writes the manifest and puts the folder in its place; keep false throws it away. Takes a zeroed
 * dump. */
bool dump_end(struct dump *dump, bool keep);
