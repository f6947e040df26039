/* Edges of draws; see edges.h. */
#include "picture/edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "picture/texels.h"

static bool is_depth(const struct dt_resource *resource)
{
    return resource->kind == DT_IMAGE && resource->format == DT_FORMAT_D32F;
}

uint16_t edges_resource(const struct dt_pipeline *pipeline, const struct dt_pass *pass)
{
    uint16_t found = UINT16_MAX;
    for (uint32_t i = 0; i < pass->write_count; i++) {
        const struct dt_resource *resource = &pipeline->resources[pass->writes[i]];
        if (resource->kind == DT_IMAGE && format_is_integer(resource->format))
            return pass->writes[i];
        if (is_depth(resource))
            found = pass->writes[i];
    }
    return found;
}

uint16_t edges_depth(const struct dt_pipeline *pipeline, const struct dt_pass *pass)
{
    uint16_t numbers = edges_resource(pipeline, pass);
    for (uint32_t i = 0; i < pass->write_count; i++)
        if (pass->writes[i] != numbers && is_depth(&pipeline->resources[pass->writes[i]]))
            return pass->writes[i];
    return UINT16_MAX;
}

/* Whether two texels show different triangles, as far as the image tells. */
static bool parts(const struct dt_resource *resource, const uint8_t *a, const uint8_t *b)
{
    static const float background = 1;
    size_t size = format_info(resource->format)->bytes;
    if (resource->format != DT_FORMAT_D32F)
        return memcmp(a, b, size) != 0;
    return (memcmp(a, &background, size) == 0) != (memcmp(b, &background, size) == 0);
}

/* The texels around one in its layer, itself among them; as indices of texels. Returns how many. */
static uint32_t around(size_t found[9], const uint32_t extent[3], const uint32_t at[3])
{
    size_t layer = (size_t)at[2] * extent[0] * extent[1];
    uint32_t x0 = at[0] ? at[0] - 1 : 0, x1 = at[0] + 1 < extent[0] ? at[0] + 1 : at[0];
    uint32_t y0 = at[1] ? at[1] - 1 : 0, y1 = at[1] + 1 < extent[1] ? at[1] + 1 : at[1];
    uint32_t count = 0;
    for (uint32_t y = y0; y <= y1; y++)
        for (uint32_t x = x0; x <= x1; x++)
            found[count++] = layer + (size_t)y * extent[0] + x;
    return count;
}

/* Whether a neighbour shows another triangle than the texel. */
static bool at_edge(const struct dt_resource *resource, const struct dt_bytes *copy,
                    const uint32_t at[3], size_t texel)
{
    size_t size = format_info(resource->format)->bytes, near[9];
    uint32_t count = around(near, copy->extent, at);
    for (uint32_t i = 0; i < count; i++)
        if (parts(resource, copy->data + texel * size, copy->data + near[i] * size))
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
    size_t texel = 0;
    for (uint32_t z = 0; z < extent[2]; z++)
        for (uint32_t y = 0; y < extent[1]; y++)
            for (uint32_t x = 0; x < extent[0]; x++, texel++) {
                const uint32_t at[3] = {x, y, z};
                (*edges)[texel] = at_edge(resource, &copies[0], at, texel) ||
                                  at_edge(resource, &copies[1], at, texel);
            }
    return true;
}

static float depth_at(const struct dt_bytes *depth, size_t texel)
{
    float value;
    memcpy(&value, depth->data + texel * sizeof value, sizeof value);
    return value;
}

static bool coincide(const struct dt_bytes depths[2], const uint32_t at[3], size_t texel)
{
    float depth = depth_at(&depths[0], texel), reach = 0;
    size_t near[9];
    uint32_t count = around(near, depths[0].extent, at);
    for (uint32_t i = 0; i < count; i++)
        reach = fmaxf(reach, fabsf(depth_at(&depths[0], near[i]) - depth));
    return fabsf(depth_at(&depths[1], texel) - depth) <= reach;
}

void edges_add_coincident(bool *edges, const struct dt_bytes depths[2])
{
    const uint32_t *extent = depths[0].extent;
    size_t texel = 0;
    for (uint32_t z = 0; z < extent[2]; z++)
        for (uint32_t y = 0; y < extent[1]; y++)
            for (uint32_t x = 0; x < extent[0]; x++, texel++)
                edges[texel] = edges[texel] || coincide(depths, (const uint32_t[]){x, y, z}, texel);
}
