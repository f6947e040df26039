/* Edges of what a draw of triangles left: where another rasterizer may see another triangle. */
#pragma once

#include "diptych.h"

/* Which output of the pass tells triangles apart: an integer image, taken for triangle numbers; else
 * the depth, in which 1 is background. UINT16_MAX: none. */
uint16_t edges_resource(const struct dt_pipeline *pipeline, const struct dt_pass *pass);
/* The depth that a pass writes beside triangle numbers. UINT16_MAX: none. */
uint16_t edges_depth(const struct dt_pipeline *pipeline, const struct dt_pass *pass);

/* `edges`: per texel of mip 0, whether in either copy a texel differs from this one among the 3x3
 * around it in its layer: in value, or depth in being background. To be freed. False when out of
 * memory. `edges` NULL: the copies differ in size. */
bool edges_find(bool **edges, const struct dt_resource *resource, const struct dt_bytes copies[2]);

/* Where surfaces coincide, a rasterizer's rounding decides which of them is seen, and they may be
 * larger than 3x3 texels. Adds to `edges`, of copies of the same size, the texels whose depths are no
 * farther apart than the first copy's depth from that of one of the 3x3 around it. */
void edges_add_coincident(bool *edges, const struct dt_bytes depths[2]);
