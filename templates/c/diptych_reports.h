/* What a pipeline that diptych-gen made with --sanitize has found. Its resource `diptych_reports` is a buffer like others: read
 * its bytes after a frame has finished, and hand them to NAME_report, which NAME.h declares. Generated code and the application
 * include this file; hosts need not. */
#ifndef DIPTYCH_REPORTS_H
#define DIPTYCH_REPORTS_H

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "panel.h"

/* An operation that may be undefined, and where its author wrote it. Site 0 is none. */
struct dt_site {
    const char *file, *pass, *kind;
    int line, column;
    /* the message; @0i is value 0 as an int, @4u value 4 as a uint, @1f value 1 as a float, @3w and @3h a width and a height in
     * half a word each, @0e a texel or element by its index, @1p an invocation by its number */
    const char *text, *name;
    int resource;          /* of @0e; -1: a `shared` variable, `name` */
    uint32_t words, first; /* of that: words of an element, 0: no array; and its first word */
    bool pairs;            /* a race: value 0 is the invocation */
    bool allowed;          /* by the pass */
};

struct dt_finding {
    const struct dt_site *place, *what; /* where, and the operation there */
    uint32_t invocation[3], frame;      /* the least invocation in the first frame that was wrong */
    uint32_t count;                     /* in all frames */
    uint32_t lost; /* findings of other operations that its invocations had no room for */
    char text[256];
};

#define DT_LOST_TEXT                                                                               \
    "%" PRIu32 " findings of other operations had no room: mend these and run again"

/* Words of a site in the buffer, and of its records; see templates/glsl/sanitize.glsl. */
enum {
    DT_SITE_HEAD = 8,
    DT_SITE_RECORDS = 16,
    DT_SITE_RECORD = 12,
    DT_SITE_WORDS = DT_SITE_HEAD + DT_SITE_RECORDS * DT_SITE_RECORD
};

/* ---- Messages -------------------------------------------------------------------------------- */

/* The coordinates of an invocation in a dispatch of this size. */
static inline void dt_find_invocation(uint32_t number, const uint32_t extent[2],
                                      uint32_t invocation[3])
{
    uint32_t width = extent[0] ? extent[0] : 1, height = extent[1] ? extent[1] : 1;
    invocation[0] = number % width;
    invocation[1] = number / width % height;
    invocation[2] = (uint32_t)(number / ((uint64_t)width * height));
}

/* Mips follow each other, each with its layers. */
static inline int dt_texel_text(const struct dt_resource *image, const uint32_t extent[3],
                                uint32_t at, char *text, size_t room)
{
    uint32_t x = extent[0], y = extent[1], z = extent[2], mip = 0;
    for (; mip + 1 < image->mips && at >= x * y * z; mip++) {
        at -= x * y * z;
        x = x > 1 ? x / 2 : 1;
        y = y > 1 ? y / 2 : 1;
        z = image->shape == DT_SHAPE_3D && z > 1 ? z / 2 : z;
    }
    int length = snprintf(text, room, "texel (%" PRIu32 ", %" PRIu32, at % x, at / x % y);
    if (image->layered)
        length += snprintf(text + length, room - (size_t)length, ", %" PRIu32, at / x / y);
    length += snprintf(text + length, room - (size_t)length, ")");
    if (image->mips > 1)
        length += snprintf(text + length, room - (size_t)length, " of mip %" PRIu32, mip);
    return length;
}

/* frame: its width and height in half a word each. */
static inline void dt_place_text(const struct dt_pipeline *pipeline, const struct dt_site *site,
                                 uint32_t at, uint32_t frame, char *text, size_t room)
{
    const struct dt_resource *resource =
        site->resource >= 0 ? &pipeline->resources[site->resource] : NULL;
    uint32_t extent[3] = {1, 1, 1}, stride = resource ? resource->stride / 4 : site->words;
    int length = 0;
    if (resource && resource->kind == DT_IMAGE) {
        pipeline->extent(pipeline, (uint32_t)site->resource, frame & 0xffff, frame >> 16, extent);
        length = dt_texel_text(resource, extent, at, text, room);
    } else if (stride) {
        length = snprintf(text, room, "element %" PRIu32, (at - site->first) / stride);
    }
    snprintf(text + length, room - (size_t)length, "%s`%.60s`", length ? " of " : "",
             resource ? resource->name : site->name);
}

/* The value of a message at `code`, its number and letter. words: of the place in the buffer. */
static inline void dt_value_text(const struct dt_pipeline *pipeline, const struct dt_site *site,
                                 const char *code, const uint32_t *words, const uint32_t *values,
                                 char *text, size_t room)
{
    uint32_t value = values[code[0] - '0'], p[3];
    float number;
    memcpy(&number, &value, sizeof number);
    switch (code[1]) {
    case 'e':
        dt_place_text(pipeline, site, value, values[3], text, room);
        break;
    case 'p':
        dt_find_invocation(value, words + 4, p);
        snprintf(text, room, "(%" PRIu32 ", %" PRIu32 ", %" PRIu32 ")", p[0], p[1], p[2]);
        break;
    case 'f':
        snprintf(text, room, "%.9g", (double)number);
        break;
    case 'i':
        snprintf(text, room, "%" PRId32, (int32_t)value);
        break;
    default:
        snprintf(text, room, "%" PRIu32,
                 code[1] == 'w'   ? value & 0xffff
                 : code[1] == 'h' ? value >> 16
                                  : value);
    }
}

/* ---- Findings -------------------------------------------------------------------------------- */

/* The record of the least invocation; else, where later ones took its place, that of the least that is left. */
static inline const uint32_t *dt_find_record(const uint32_t *words)
{
    const uint32_t *best = words + DT_SITE_HEAD;
    for (uint32_t i = 1; i < DT_SITE_RECORDS; i++) {
        const uint32_t *record = words + DT_SITE_HEAD + (size_t)i * DT_SITE_RECORD;
        best = record[0] > best[0] ? record : best;
    }
    return best;
}

/* What the buffer says of a site; false: nothing. A place in generated text has operations of more than one site. */
static inline bool dt_find_undefined(const struct dt_pipeline *pipeline,
                                     const struct dt_site *sites, uint32_t site_count,
                                     const uint32_t *buffer, uint32_t index,
                                     struct dt_finding *finding)
{
    const uint32_t *words = buffer + (size_t)index * DT_SITE_WORDS, *record = dt_find_record(words);
    const struct dt_site *what = &sites[record[1] < site_count ? record[1] : 0];
    size_t length = 0;
    if (!words[0])
        return false;
    *finding = (struct dt_finding){.place = index ? &sites[index] : what,
                                   .what = what,
                                   .count = words[0],
                                   .lost = words[6],
                                   .frame = words[3] - 1};
    dt_find_invocation(what->pairs ? record[2] : ~record[0], words + 4, finding->invocation);
    for (const char *at = what->text; *at && length + 1 < sizeof finding->text; at++) {
        if (*at == '@' && at[1] && at[2]) {
            dt_value_text(pipeline, what, at + 1, words, record + 2, finding->text + length,
                          sizeof finding->text - length);
            length = strlen(finding->text);
            at += 2;
        } else {
            finding->text[length++] = *at;
            finding->text[length] = 0;
        }
    }
    return true;
}

/* Logs all findings as errors; returns how many. */
static inline uint32_t dt_report_undefined(const struct dt_pipeline *pipeline,
                                           const struct dt_site *sites, uint32_t site_count,
                                           const void *buffer, size_t size,
                                           const struct dt_log *log)
{
    uint32_t found = 0, lost = 0, count = (uint32_t)(size / (DT_SITE_WORDS * sizeof(uint32_t)));
    char message[1024];
    for (uint32_t i = 0; i < count && i < site_count; i++) {
        struct dt_finding f;
        if (!dt_find_undefined(pipeline, sites, site_count, (const uint32_t *)buffer, i, &f) ||
            f.what->allowed)
            continue;
        found++;
        lost += f.lost;
        snprintf(message, sizeof message,
                 "%s:%d:%d: undefined: %s; pass %s, invocation (%" PRIu32 ", %" PRIu32 ", %" PRIu32
                 "), %" PRIu32 " times; first in frame %" PRIu32,
                 f.place->file, f.place->line, f.place->column, f.text, f.what->pass,
                 f.invocation[0], f.invocation[1], f.invocation[2], f.count, f.frame);
        if (log->message)
            log->message(log->user, DT_ERROR, message);
    }
    snprintf(message, sizeof message, DT_LOST_TEXT, lost);
    if (lost && log->message)
        log->message(log->user, DT_ERROR, message);
    return found;
}

#endif
