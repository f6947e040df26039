/* What lies in the bytes of a resource: names, sizes and numbers of types and formats. */
#pragma once

#include "formats.h"

bool number_is_float(enum number_kind kind);
bool number_is_signed(enum number_kind kind);
uint32_t number_one(enum number_kind kind); /* code of 1.0 of unorm and snorm; others: 0 */

uint32_t number_size(enum number_kind kind);  /* bytes to read: 4 of a packed number */
uint32_t number_width(enum number_kind kind); /* bits */
uint32_t number_bits(enum number_kind kind, const uint8_t *place); /* as they lie */
void number_set_bits(enum number_kind kind, uint32_t bits, uint8_t *place);
double number_value(enum number_kind kind, const uint8_t *place); /* exact; unorm8: code / 255 */
double number_of_bits(enum number_kind kind, uint32_t bits);

/* Stores the nearest number of that kind. False, and nothing stored: it is not finite, or beyond the
 * kind's range, which for unorm is 0 to 1, for snorm -1 to 1. */
bool number_store(enum number_kind kind, double value, uint8_t *place);

/* One number in each element of a resource. */
struct component {
    char name[72]; /* "flux.y", "r", or empty for a plain scalar */
    enum number_kind kind;
    uint32_t offset; /* bytes from the start of the element */
};

bool format_is_depth(enum dt_format format);
struct component format_component(enum dt_format format, uint32_t channel);
uint32_t resource_stride(const struct dt_resource *resource); /* bytes per element or texel */

/* Extent of one mip in a frame of that size, as a runtime's read gives it: elements of a buffer, or
 * width, height and layers or depth; and how many elements or texels that is. */
void resource_extent(const struct dt_pipeline *pipeline, uint32_t resource, const uint32_t size[2],
                     uint32_t mip, uint32_t extent[3]);
uint64_t resource_elements(const struct dt_resource *resource, const uint32_t extent[3]);

/* Mask of the mips that the pass writes of the resource that is `write`-th of those that it writes. */
uint32_t pass_mips(const struct dt_pass *pass, uint32_t write);
/* Mask of the mips that are defined before the pass: those that earlier passes of the frame write;
 * with history, all. A buffer has mip 0. */
uint32_t resource_mips_before(const struct dt_pipeline *pipeline, uint32_t pass, uint32_t resource);

/* Position of an element as text: "[12]" in a buffer, "(3, 4)" in an image of that extent, "(3, 4,
 * layer 5)" in a layered one; malloc'ed, NULL when out of memory. */
char *element_place(const struct dt_resource *resource, const uint32_t extent[3], uint64_t element);

/* All declared numbers of an element, padding left out; *list is malloc'ed. Returns their count, 0
 * when out of memory. */
uint32_t resource_components(const struct dt_resource *resource, struct component **list);

/* Zeroes the padding between the numbers, whose content is undefined, so that equal content gives
 * equal bytes. False when out of memory. */
bool resource_clear_padding(const struct dt_resource *resource, struct dt_bytes *bytes);
