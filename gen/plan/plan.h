/* The plan: what both backends share, decided once: layouts, order, bindings, lifetimes, memory, barriers. */
#pragma once

#include "model/source.h"
#include "model/limits.h"
#include "formats.h"

/* plan.c: order (reports cycles, read before write, two writers without order), kinds of access,
 * bindings, barriers, lifetimes, slots, ranges. False when no later stage must run. */
bool plan_model(struct model *model, struct diag *diag);

/* ---- layout.c -------------------------------------------------------------------------------- */

/* std430 offsets of structs, std140 offsets of the live block; before plan_model. */
void layout_model(struct model *model);
/* Whether the buffer's elements have the same layout in std140 and std430, so that a uniform block
 * can read them. */
bool std140_equals_std430(const struct resource *buffer);

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
/* The same at the reference size of the frame. */
uint32_t expr_at_reference(const struct expr *expr, uint32_t otherwise);

/* ---- The plan's parts; plan.c calls them in this order --------------------------------------- */

bool plan_order(struct model *model, struct diag *diag); /* order.c: pipeline->order, pass->index */
/* order.c: what a pass does with a resource, by all its accesses. */
struct pass_use {
    bool reads, writes, updates;
    unsigned kinds;        /* enum dt_access of its accesses */
    uint32_t written_mips; /* mask: passes may write different mips in any order */
    uint32_t changed_mips; /* those and updated ones */
    struct loc read_loc, change_loc;
};
struct pass_use pass_use_of(const struct pass *pass, const struct resource *resource);
void plan_lifetimes(struct model *model); /* alias.c: first_pass, last_pass, bytes */
void plan_slots(struct model *model);     /* alias.c: slot, share, the sums of bytes */
/* alias.c: whether `a` is at least as large as `b` at every frame size; with images: at some */
bool resource_covers(const struct resource *a, const struct resource *b);
void plan_barriers(struct model *model); /* barrier.c: pass->barriers */

/* The layout of an image while a pass uses it with these kinds of access (mask of enum
 * dt_access). */
enum dt_layout layout_of(unsigned kind); /* barrier.c */
