/* Finds the smallest region that fails; see region.h. */
#include "result/region.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "picture/texels.h"
#include "result/difference.h"

enum { AXES = 3 };

/* A flag per element, x fastest. */
struct map {
    bool *fails;
    uint32_t extent[AXES];
};

static bool fails_at(const struct map *map, uint32_t x, uint32_t y, uint32_t layer)
{
    return map->fails[((uint64_t)layer * map->extent[1] + y) * map->extent[0] + x];
}

/* Element by element under the resource's own contract. */
static bool make_map(struct map *map, const struct dt_resource *resource,
                     const struct dt_bytes copies[2])
{
    uint64_t elements = (uint64_t)map->extent[0] * map->extent[1] * map->extent[2];
    uint32_t stride = resource_stride(resource);
    map->fails = calloc(elements ? elements : 1, sizeof *map->fails);
    for (uint64_t i = 0; map->fails && i < elements; i++) {
        struct difference difference;
        struct dt_bytes element[2];
        for (int side = 0; side < 2; side++)
            element[side] = (struct dt_bytes){
                .data = copies[side].data + i * stride, .size = stride, .extent = {1, 1, 1}};
        if (!difference_measure(&difference, resource, 0, element))
            return false;
        map->fails[i] = difference.beyond > 0;
    }
    return map->fails;
}

/* Shrinks the box, given as inclusive bounds, to the failing elements in it, which are counted. */
static uint64_t shrink_region(const struct map *map, uint32_t low[AXES], uint32_t high[AXES])
{
    uint32_t least[AXES] = {UINT32_MAX, UINT32_MAX, UINT32_MAX}, most[AXES] = {0};
    uint64_t count = 0;
    for (uint32_t z = low[2]; z <= high[2]; z++) {
        for (uint32_t y = low[1]; y <= high[1]; y++) {
            for (uint32_t x = low[0]; x <= high[0]; x++) {
                const uint32_t here[AXES] = {x, y, z};
                if (!fails_at(map, x, y, z))
                    continue;
                for (int axis = 0; axis < AXES; axis++) {
                    least[axis] = here[axis] < least[axis] ? here[axis] : least[axis];
                    most[axis] = here[axis] > most[axis] ? here[axis] : most[axis];
                }
                count++;
            }
        }
    }
    if (count) {
        memcpy(low, least, sizeof least);
        memcpy(high, most, sizeof most);
    }
    return count;
}

static int longest_axis(const uint32_t low[AXES], const uint32_t high[AXES])
{
    int longest = 0;
    for (int axis = 1; axis < AXES; axis++)
        if (high[axis] - low[axis] > high[longest] - low[longest])
            longest = axis;
    return longest;
}

/* Halves the box along its longest side and continues with the lower half, shrunk to its failing
 * elements. The box touches failing elements on all sides, so the lower half always fails. Ends at
 * one element. */
static void halve(const struct map *map, uint32_t low[AXES], uint32_t high[AXES])
{
    for (int axis = longest_axis(low, high); high[axis] > low[axis];
         axis = longest_axis(low, high)) {
        high[axis] = low[axis] + (high[axis] - low[axis]) / 2;
        shrink_region(map, low, high);
    }
}

bool region_find(struct region *region, const struct dt_resource *resource,
                 const struct dt_bytes copies[2], const struct dt_log *log)
{
    bool buffer = resource->kind == DT_BUFFER;
    const uint32_t *extent = copies[0].extent;
    struct map map = {.extent = {extent[0], buffer ? 1 : extent[1], buffer ? 1 : extent[2]}};
    *region = (struct region){0};
    bool good = make_map(&map, resource, copies);
    if (good && map.extent[0] && map.extent[1] && map.extent[2]) {
        for (int axis = 0; axis < AXES; axis++)
            region->high[axis] = map.extent[axis] - 1;
        region->failing = shrink_region(&map, region->low, region->high);
    }
    if (region->failing) {
        uint32_t high[AXES];
        memcpy(region->smallest, region->low, sizeof region->smallest);
        memcpy(high, region->high, sizeof high);
        halve(&map, region->smallest, high);
    }
    free(map.fails);
    return good || report_error(log, "out of memory");
}

/* "4..9", or "4" when that is all. */
static char *describe_bounds(const struct region *region, int axis)
{
    uint32_t low = region->low[axis], high = region->high[axis];
    return low == high ? format_string("%u", low) : format_string("%u..%u", low, high);
}

char *region_describe(const struct region *region, const struct dt_resource *resource)
{
    unsigned long long failing = region->failing;
    const char *verb = failing == 1 ? "element differs" : "elements differ";
    char *x = describe_bounds(region, 0);
    char *y = describe_bounds(region, 1);
    char *layer = describe_bounds(region, 2);
    const uint32_t *at = region->smallest;
    char *text = NULL;
    if (!x || !y || !layer)
        text = NULL;
    else if (resource->kind == DT_BUFFER)
        text = format_string("%llu %s within [%s]; smallest: [%u]", failing, verb, x, at[0]);
    else if (!resource->layered)
        text = format_string("%llu %s within x %s, y %s; smallest: (%u, %u)", failing, verb, x, y,
                             at[0], at[1]);
    else
        text = format_string("%llu %s within x %s, y %s, layer %s; smallest: (%u, %u, layer %u)",
                             failing, verb, x, y, layer, at[0], at[1], at[2]);
    free(layer);
    free(y);
    free(x);
    return text;
}

static void add_place(cJSON *object, const char *name, const uint32_t *place, int axes)
{
    cJSON *list = cJSON_AddArrayToObject(object, name);
    for (int i = 0; i < axes; i++)
        cJSON_AddItemToArray(list, cJSON_CreateNumber(place[i]));
}

void region_json(cJSON *object, const struct region *region, int axes)
{
    add_place(object, "low", region->low, axes);
    add_place(object, "high", region->high, axes);
    add_place(object, "smallest", region->smallest, axes);
}
