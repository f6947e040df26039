/* Types, formats and touched resources, for layout, plan and the emitters. The stages themselves
 * are in stages.h; only gen/ calls the functions here. */
#ifndef DIPTYCH_GEN_PLAN_H
#define DIPTYCH_GEN_PLAN_H

#include "diag.h"
#include "formats.h"

/* ---- layout.c -------------------------------------------------------------------------------- */

/* Whether the buffer's elements have the same layout in std140 and std430, so that a uniform block
 * can read them. */
bool std140_equals_std430(const struct resource *buffer);

/* ---- format.c -------------------------------------------------------------------------------- */

/* The number nearest to `value` that the channel, 0 to 3, of the format can hold. Drivers round
 * others to either side. */
float format_round(enum dt_format format, int channel, double value);

/* ---- plan.c: all accesses of one pass to the same mips of one resource ----------------------- */

/* Whether a texture access reads only one mip of an image with several: by texel, or with `mip` or
 * `layer`. It then binds a view of this mip, and the same pass may write the other mips. */
bool access_sees_one_mip(const struct access *access);

/* Whether it reads a buffer of the scene as a texel buffer. */
bool access_is_texels(const struct access *access);

struct touch {
    struct resource *resource;
    unsigned kind;   /* mask of enum dt_access */
    unsigned stages; /* mask of enum dt_stage */
    bool reads, writes;
    uint32_t mips; /* mask; 1 for a buffer. Layers of a mip are synchronized together */
};
/* Fills touches (room for access_count + 2) with one entry per resource and set of mips, in spec
 * order; returns their number. */
uint32_t pass_touches(const struct pass *pass, struct touch *touches);

uint32_t mips_of(const struct resource *resource); /* 1 for a buffer */

/* Value of a checked expression, clamped to 0..UINT32_MAX; `otherwise` for NULL or no value. */
uint32_t expr_value(const struct expr *expr, uint32_t width, uint32_t height, uint32_t otherwise);

/* The reference frame: its size is used for reported bytes and for packing memory slots. */
enum { REFERENCE_WIDTH = 1920, REFERENCE_HEIGHT = 1080 };
enum { STORAGE_IMAGE_LIMIT = 8, TEXTURE_LIMIT = 16, COLOR_TARGET_LIMIT = 8, UNIFORM_LIMIT = 9 };
enum {
    SHARED_MEMORY_LIMIT = 16384,
    UNIFORM_BLOCK_LIMIT = 16384
};                                       /* bytes; every device of both APIs has as many */
enum { SOFTWARE_UNIFORM_LIMIT = 65536 }; /* bytes; on CPU drivers and desktop devices */

/* Most elements that a pass unrolls for CPU drivers in all its long ranges together: these drivers
 * take some milliseconds to compile one. */
enum { UNROLLED_LIMIT = 256 };

/* ---- The plan's parts; plan.c calls them in this order --------------------------------------- */

bool plan_order(struct model *model, struct diag *diag); /* order.c: pipeline->order, pass->index */
void plan_lifetimes(struct model *model);                /* alias.c: first_pass, last_pass, bytes */
/* alias.c: of all mips and layers, or of all elements */
uint64_t resource_bytes(const struct resource *resource, uint32_t width, uint32_t height);
void plan_slots(struct model *model); /* alias.c: slot, share, the sums of bytes */
/* alias.c: whether `a` is at least as large as `b` at every frame size; with images: at some */
bool resource_covers(const struct resource *a, const struct resource *b);
void plan_barriers(struct model *model); /* barrier.c: pass->barriers */

/* The layout of an image while a pass uses it with these kinds of access (mask of enum
 * dt_access). */
enum dt_layout layout_of(unsigned kind); /* barrier.c */

#endif
