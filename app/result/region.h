/* Where two copies of a resource break their contract: the number of failing elements, their
 * bounding box, and the smallest failing region, found by halving the box. */
#pragma once

#include "diptych.h"

struct cJSON;

/* Axes are x, y and layer; a buffer has x alone, its index. Bounds are inclusive. */
struct region {
    uint64_t failing; /* elements; 0: the rest is meaningless */
    uint32_t low[3], high[3];
    uint32_t smallest[3]; /* one element */
};

/* Copies have one size. Fails, with the error logged, only when out of memory. */
bool region_find(struct region *region, const struct dt_resource *resource,
                 const struct dt_bytes copies[2], const struct dt_log *log);

/* "3 elements differ within x 4..9, y 0..2, layer 1; smallest: (4, 2, layer 1)", or without layers, or
 * "3 elements differ within [4..9]; smallest: [4]"; malloc'ed, NULL when out of memory. */
char *region_describe(const struct region *region, const struct dt_resource *resource);

/* Adds low, high and smallest: lists of the first `axes` coordinates. */
void region_json(struct cJSON *object, const struct region *region, int axes);
