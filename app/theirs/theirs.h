/* Dumps of anybody's renderer: folders with a manifest.json, as `render --dump` and diptych_tap.h
 * write them, or with pictures and arrays alone, named PASS.RESOURCE.png, .exr or .npy. */
#pragma once

#include <cjson/cJSON.h>

#include "picture/texels.h"
#include "diptych.h"

enum their_origin { ORIGIN_UNKNOWN, ORIGIN_TOP, ORIGIN_BOTTOM }; /* where row 0 is */

/* One mip of a resource after a pass. All strings are printable. */
struct their_entry {
    char *pass, *resource, *file; /* owned */
    uint32_t mip, frame;
    uint32_t again; /* how many entries of the same names, mip and frame come before it */
    enum their_origin origin;
    bool described;                  /* `what` and extent are known; else from theirs_load on */
    struct dt_resource what;         /* kind, format or fields and stride; name is `resource` */
    struct dt_field *fields;         /* of `what`, owned */
    uint32_t extent[3];              /* elements, or width, height and layers */
    const char *read_as;             /* how a file's numbers were changed on the way in, or NULL */
    const struct their_texel *texel; /* of the file, where it is not that of `what`; else NULL */
};

struct theirs {
    const char *folder;
    const struct dt_log *log;
    cJSON *manifest; /* NULL: the folder has none */
    char *label;     /* the backend that the manifest names, else the folder's name; owned */
    struct their_entry *entries;
    uint32_t count;
};

/* On false the error is logged; theirs_close either way. */
bool theirs_open(struct theirs *theirs, const char *folder, const struct dt_log *log);
void theirs_close(struct theirs *theirs); /* takes a zeroed one */

/* Names the dump: what the manifest calls its "source", else the folder. */
const char *theirs_source(const struct theirs *theirs);

/* Reads the content, and completes `what` and extent of a picture or an array; free(bytes->data).
 * Images of three channels get a fourth that is 1. False: logged. */
bool theirs_load(const struct theirs *theirs, struct their_entry *entry, struct dt_bytes *bytes);

/* Stores the number, as number_store does, clamped to the kind's range; a float may be NaN or infinite. */
void their_store(enum number_kind kind, double value, uint8_t *place);

/* theirs_files.c: of the file of an entry. */
bool their_npy(const struct theirs *theirs, struct their_entry *entry, struct dt_bytes *bytes);
bool their_picture(const struct theirs *theirs, struct their_entry *entry, struct dt_bytes *bytes);
