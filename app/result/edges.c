/* Edges of draws; see edges.h. */
#include "result/edges.h"

#include <stdlib.h>
#include <string.h>

#include "base/texels.h"

uint16_t edges_resource(const struct dt_pipeline *pipeline, const struct dt_pass *pass)
{
    uint16_t found = UINT16_MAX;
    for (uint32_t i = 0; i < pass->write_count; i++) {
        const struct dt_resource *resource = &pipeline->resources[pass->writes[i]];
        if (resource->kind == DT_IMAGE && number_is_integer(format_number(resource->format)))
            return pass->writes[i];
        if (resource->kind == DT_IMAGE && resource->format == DT_FORMAT_D32F)
            found = pass->writes[i];
    }
    return found;
}

/* Whether two texels show different triangles, as far as the image tells. */
static bool parts(const struct dt_resource *resource, const uint8_t *a, const uint8_t *b)
{
    static const float background = 1;
    size_t size = format_size(resource->format);
    if (resource->format != DT_FORMAT_D32F)
        return memcmp(a, b, size) != 0;
    return (memcmp(a, &background, size) == 0) != (memcmp(b, &background, size) == 0);
}

/* Whether a neighbour shows another triangle than the texel. */
static bool at_edge(const struct dt_resource *resource, const struct dt_bytes *copy,
                    const uint32_t at[3])
{
    size_t size = format_size(resource->format);
    const uint32_t *extent = copy->extent;
    size_t layer = (size_t)at[2] * extent[0] * extent[1];
    const uint8_t *centre = copy->data + (layer + (size_t)at[1] * extent[0] + at[0]) * size;
    uint32_t x0 = at[0] ? at[0] - 1 : 0, x1 = at[0] + 1 < extent[0] ? at[0] + 1 : at[0];
    uint32_t y0 = at[1] ? at[1] - 1 : 0, y1 = at[1] + 1 < extent[1] ? at[1] + 1 : at[1];
    for (uint32_t y = y0; y <= y1; y++)
        for (uint32_t x = x0; x <= x1; x++)
            if (parts(resource, centre, copy->data + (layer + (size_t)y * extent[0] + x) * size))
                return true;
    return false;
}

bool edges_find(bool **edges, const struct dt_resource *resource, const struct dt_bytes copies[2])
{
    const uint32_t *extent = copies[0].extent;
    size_t texels = (size_t)extent[0] * extent[1] * extent[2];
    *edges = NULL;
    if (memcmp(extent, copies[1].extent, 3 * sizeof *extent) != 0)
        return true;
    *edges = calloc(texels + 1, sizeof **edges);
    if (!*edges)
        return false;
    for (uint32_t z = 0, i = 0; z < extent[2]; z++)
        for (uint32_t y = 0; y < extent[1]; y++)
            for (uint32_t x = 0; x < extent[0]; x++, i++) {
                const uint32_t at[3] = {x, y, z};
                (*edges)[i] =
                    at_edge(resource, &copies[0], at) || at_edge(resource, &copies[1], at);
            }
    return true;
}
