/* Content of resources with history that outlives a resize or a new pipeline. Before the resources go,
 * those whose content is of a whole frame are put aside, as the backend's own structs; the next
 * resize takes those whose name and layout are the same, and destroys the others. */
#include "front.h"

#include <stdlib.h>
#include <string.h>

struct dt_kept {
    char *name;
    uint64_t layout;
    uint32_t written;
    void *resource; /* the backend's struct */
};

/* ---- Layouts --------------------------------------------------------------------------------- */

/* FNV-1a, over numbers. */
static void mix(uint64_t *hash, const uint32_t *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        *hash = (*hash ^ numbers[i]) * 1099511628211u;
}

static void mix_name(uint64_t *hash, const char *name)
{
    for (; *name; name++)
        *hash = (*hash ^ (unsigned char)*name) * 1099511628211u;
}

static uint64_t layout_of(const struct dt_core *core, uint32_t index, const uint32_t extent[3])
{
    const struct dt_resource *resource = &core->pipeline->resources[index];
    const uint32_t numbers[] = {resource->kind,
                                resource->input,
                                resource->stride,
                                resource->format,
                                resource->shape,
                                resource->layered,
                                resource->mips,
                                extent[0],
                                extent[1],
                                extent[2],
                                core->panel->storage[index].block};
    uint64_t hash = 14695981039346656037u;
    mix(&hash, numbers, DT_ARRAY_COUNT(numbers));
    for (uint32_t i = 0; resource->kind == DT_BUFFER && i < resource->field_count; i++) {
        const struct dt_field *field = &resource->fields[i];
        const uint32_t place[] = {field->type, field->offset, field->array_count,
                                  field->array_stride};
        mix_name(&hash, field->name);
        mix(&hash, place, DT_ARRAY_COUNT(place));
    }
    return hash;
}

/* ---- Keeping --------------------------------------------------------------------------------- */

static void forget(struct dt_core *core, struct dt_kept *kept)
{
    if (kept->resource)
        core->backend->destroy_resource(core, kept->resource);
    free(kept->resource);
    free(kept->name);
    *kept = (struct dt_kept){0};
}

void dt_history_drop(struct dt_core *core)
{
    for (uint32_t i = 0; i < core->kept_count; i++)
        forget(core, &core->kept[i]);
    free(core->kept);
    core->kept = NULL;
    core->kept_count = 0;
}

/* Without memory its content is lost, as it is without keep_history. */
static void keep(struct dt_core *core, uint32_t index)
{
    struct dt_kept *kept = &core->kept[core->kept_count];
    size_t size = core->backend->resource_size;
    uint32_t extent[3] = {0};
    core->pipeline->extent(core->pipeline, index, core->width, core->height, extent);
    *kept = (struct dt_kept){strdup(core->pipeline->resources[index].name),
                             layout_of(core, index, extent), core->written[index], malloc(size)};
    if (!kept->name || !kept->resource || !core->backend->detach_resource(core, index)) {
        free(kept->name);
        free(kept->resource);
        *kept = (struct dt_kept){0};
        return;
    }
    memcpy(kept->resource, dt_resource(core, index), size);
    memset(dt_resource(core, index), 0, size);
    core->kept_count++;
}

void dt_history_keep(struct dt_core *core)
{
    uint32_t count = core->pipeline->resource_count;
    bool any = core->rendered;
    for (uint32_t i = 0; core->resumed && i < count; i++)
        any |= core->resumed[i];
    if (!core->keep_history || !core->width || !any)
        return; /* what was put aside before waits for the next resize */
    struct dt_kept *more = realloc(core->kept, (core->kept_count + count + 1) * sizeof *more);
    core->kept = more ? more : core->kept;
    core->kept_camera = core->has_camera;
    for (uint32_t i = 0; more && i < count; i++)
        if (core->pipeline->resources[i].history && !core->imported[i] &&
            (core->rendered || core->resumed[i]))
            keep(core, i);
}

bool dt_history_take(struct dt_core *core, uint32_t index, const uint32_t extent[3])
{
    const struct dt_resource *resource = &core->pipeline->resources[index];
    if (!resource->history || core->imported[index])
        return false;
    for (uint32_t i = 0; i < core->kept_count; i++) {
        struct dt_kept *kept = &core->kept[i];
        if (!kept->name || strcmp(kept->name, resource->name) != 0 ||
            kept->layout != layout_of(core, index, extent) ||
            !core->backend->adopt_resource(core, index, kept->resource))
            continue;
        memcpy(dt_resource(core, index), kept->resource, core->backend->resource_size);
        core->written[index] = kept->written;
        core->resumed[index] = true;
        free(kept->resource);
        kept->resource = NULL;
        forget(core, kept);
        return true;
    }
    return false;
}

bool dt_history_goes_on(const struct dt_core *core)
{
    for (uint32_t i = 0; i < core->pipeline->resource_count; i++)
        if (core->pipeline->resources[i].history && !core->pipeline->resources[i].input &&
            !core->imported[i] && !core->resumed[i])
            return false;
    return true;
}
