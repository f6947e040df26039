/* Reads the output of `diptych render --dump`, for tests. Fails the running cmocka test on anything
 * that it cannot read, so callers need no checks. */
#pragma once

#include <stddef.h>
#include <stdint.h>

struct cJSON;

struct dump {
    char directory[512];
    struct cJSON *manifest;
};

struct dump_entry { /* one resource, or one mip of it, after one pass */
    uint8_t *data;  /* owner; dump_entry_free */
    size_t size;
    size_t stride; /* buffers: bytes from element to element; images: bytes of a texel */
    size_t count;  /* buffers: elements */
    size_t width, height, layers;    /* images */
    const struct cJSON *description; /* the manifest's entry */
};

/* Runs `diptych render --dump` with these further arguments in a temporary directory, and opens the
 * dump. The program is $DIPTYCH_BUILD/diptych, build/diptych without it; the working directory is
 * the project's root. */
void dump_render(struct dump *dump, const char *arguments);
void dump_close(struct dump *dump); /* removes the files of dump_render */

/* pass NULL: the last pass that wrote the resource. Of an image with mips, mip 0. */
struct dump_entry dump_read(const struct dump *dump, const char *pass, const char *resource);
struct dump_entry dump_read_mip(const struct dump *dump, const char *pass, const char *resource,
                                size_t mip);
void dump_entry_free(struct dump_entry *entry);

/* Address of a field (buffers) in element `index`. */
const void *dump_field(const struct dump_entry *entry, size_t index, const char *field);
/* Channels of a texel (images) as float; row 0 is NDC y = -1. Reads rgba32f, rgba16f, r32f, rgba8,
 * d32f, r32ui. */
void dump_texel(const struct dump_entry *entry, size_t x, size_t y, size_t layer, float out[4]);

/* Whether the manifest has this mip of the resource after the pass. */
int dump_has_mip(const struct dump *dump, const char *pass, const char *resource, size_t mip);
