/* Lifetimes of resources, and which resources share memory: slots of device memory for Vulkan,
 * shared textures for OpenGL.
 *
 * A resource lives from the first pass that touches it to the last, in order of execution; an
 * output to the end of the frame. Two may share if no pass is in both lifetimes. Resources with
 * history live for ever and share no memory, nor do those with `keep`. Their content does not
 * outlive it either: without history, a resource holds nothing when a frame touches it first.
 *
 * Vulkan: the largest resource is placed first, in the smallest slot that is free during its
 * lifetime. This is greedy, not the best packing; the same spec gives the same slots everywhere.
 * Sizes are those of the reference frame (plan.h). At another size the runtime makes a slot as
 * large as its largest resource then is (runtime_vk/panel.c): sharing stays right, and only the
 * packing may be worse.
 *
 * OpenGL cannot place objects in memory. There an image borrows the texture of an equal one, equal
 * at every frame size, and buffers share nothing.
 *
 * Sharing makes hazards that no access shows: barrier.c lets the next user of a slot wait for the
 * last. It knows by resource_covers which users cover each other's bytes. */
#include <string.h>

#include "model/expr.h"
#include "plan.h"

static uint64_t image_bytes(const struct resource *image, uint32_t frame_width,
                            uint32_t frame_height)
{
    uint32_t width = expr_value(image->width, frame_width, frame_height, frame_width);
    uint32_t height = expr_value(image->height, frame_width, frame_height, frame_height);
    uint32_t layers = expr_value(image->layers, frame_width, frame_height, 1);
    uint32_t mips = expr_value(image->mips, frame_width, frame_height, 1);
    uint64_t texels = 0;

    for (uint32_t mip = 0; mip < mips && mip < 32; mip++) {
        uint64_t w = width >> mip ? width >> mip : 1, h = height >> mip ? height >> mip : 1;
        uint32_t depth = image->shape == DT_SHAPE_3D ? layers >> mip : layers;

        texels += w * h * (depth ? depth : 1);
    }
    return texels * format_info(image->format)->bytes;
}

/* Of all mips and layers, or of all elements. */
static uint64_t resource_bytes(const struct resource *resource, uint32_t width, uint32_t height)
{
    return resource->kind == DT_IMAGE
               ? image_bytes(resource, width, height)
               : (uint64_t)resource->stride * expr_value(resource->count, width, height, 1);
}

void plan_lifetimes(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;

    CHANGE_EACH(resource, pipeline->resources, pipeline->resource_count) {
        resource->usage = 0;
        resource->first_pass = resource->last_pass = -1;
        resource->bytes = resource_bytes(resource, REFERENCE_WIDTH, REFERENCE_HEIGHT);
    }
    for (uint32_t p = 0; p < pipeline->pass_count; p++) {
        struct pass *pass = pipeline->order[p];
        struct touch *touches =
            arena_alloc(model->arena, (pass->access_count + 2) * sizeof *touches);
        uint32_t count = touches ? pass_touches(pass, touches) : 0;

        for (uint32_t i = 0; i < count; i++) {
            struct resource *resource = touches[i].resource;

            resource->usage |= touches[i].kind;
            resource->first_pass = resource->first_pass < 0 ? (int)p : resource->first_pass;
            resource->last_pass = (int)p;
        }
    }
    CHANGE_EACH(resource, pipeline->resources, pipeline->resource_count) {
        const char *linear = pipeline->linear_output, *display = pipeline->display_output;

        if (resource->history) {
            resource->first_pass = 0;
            resource->last_pass = (int)pipeline->pass_count - 1;
        } else if (resource->first_pass >= 0 &&
                   (resource->keep || (linear && strcmp(resource->name, linear) == 0) ||
                    (display && strcmp(resource->name, display) == 0))) {
            resource->last_pass = (int)pipeline->pass_count - 1;
        }
    }
}

/* Whether both are alive in a common pass, or one has memory of its own. */
static bool overlap(const struct resource *a, const struct resource *b)
{
    if (a->history || b->history || a->keep || b->keep)
        return true;
    if (a->first_pass < 0 || b->first_pass < 0)
        return false;
    return a->first_pass <= b->last_pass && b->first_pass <= a->last_pass;
}

/* ---- Vulkan ---------------------------------------------------------------------------------- */

static bool fits_slot(const struct pipeline *pipeline, const bool *placed, uint32_t slot,
                      const struct resource *resource)
{
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *other = &pipeline->resources[i];

        if (placed[i] && other->slot == slot && overlap(other, resource))
            return false;
    }
    return true;
}

/* Resources come largest first, so every existing slot is large enough. Takes the smallest slot
 * that is free during the resource's lifetime. Ties go to the slot made first, so the same spec
 * gives the same slots. */
static void place_in_slot(struct pipeline *pipeline, bool *placed, uint64_t *slot_bytes,
                          struct resource *resource)
{
    uint32_t best = pipeline->slot_count;

    for (uint32_t slot = 0; slot < pipeline->slot_count; slot++)
        if (fits_slot(pipeline, placed, slot, resource) &&
            (best == pipeline->slot_count || slot_bytes[slot] < slot_bytes[best]))
            best = slot;
    if (best == pipeline->slot_count)
        slot_bytes[pipeline->slot_count++] = resource->bytes;
    resource->slot = best;
    placed[resource->index] = true;
}

static void plan_vulkan_slots(struct pipeline *pipeline, bool *placed, uint64_t *slot_bytes)
{
    pipeline->slot_count = 0;
    pipeline->transient_bytes = pipeline->aliased_bytes = 0;
    for (uint32_t round = 0; round < pipeline->resource_count; round++) {
        struct resource *largest = NULL;

        for (uint32_t i = 0; i < pipeline->resource_count; i++) {
            struct resource *resource = &pipeline->resources[i];

            if (!placed[i] && (!largest || resource->bytes > largest->bytes))
                largest = resource;
        }
        if (!largest)
            break;
        if (!largest->history) {
            uint32_t slots = pipeline->slot_count;

            place_in_slot(pipeline, placed, slot_bytes, largest);
            pipeline->transient_bytes += largest->bytes;
            pipeline->aliased_bytes += pipeline->slot_count > slots ? largest->bytes : 0;
        } else {
            place_in_slot(pipeline, placed, slot_bytes, largest);
        }
    }
}

/* ---- OpenGL ---------------------------------------------------------------------------------- */

/* Whether both are equal at every frame size: the same number, or the same text as C. */
static bool same_extent(const struct expr *a, const struct expr *b, uint32_t otherwise)
{
    struct text text_a = {0}, text_b = {0};
    bool same = expr_at_reference(a, otherwise) == expr_at_reference(b, otherwise);

    if (same && a && b && (expr_reach(a) | expr_reach(b))) {
        expr_emit_c(a, &text_a);
        expr_emit_c(b, &text_b);
        same = text_a.data && text_b.data && strcmp(text_a.data, text_b.data) == 0;
        text_free(&text_a);
        text_free(&text_b);
    }
    return same && ((a && b) || !((a ? expr_reach(a) : 0) | (b ? expr_reach(b) : 0)));
}

bool resource_covers(const struct resource *a, const struct resource *b)
{
    static const uint32_t sizes[][2] = {{1, 1}, {REFERENCE_WIDTH, REFERENCE_HEIGHT}, {7680, 4320}};
    if (a->kind == DT_BUFFER && b->kind == DT_BUFFER) {
        if (b->block) /* its blocks are bound, and so read, in their declared length */
            return a->block >= b->block;
        if (expr_reach(a->count) | expr_reach(b->count))
            return a->stride >= b->stride && same_extent(a->count, b->count, 1);
        return a->bytes >= b->bytes;
    }
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (resource_bytes(a, sizes[i][0], sizes[i][1]) <
            resource_bytes(b, sizes[i][0], sizes[i][1]))
            return false;
    return true;
}

static bool same_texture(const struct resource *a, const struct resource *b)
{
    return a->kind == DT_IMAGE && b->kind == DT_IMAGE && a->format == b->format &&
           a->shape == b->shape && !a->layers == !b->layers && same_extent(a->width, b->width, 0) &&
           same_extent(a->height, b->height, 0) && same_extent(a->layers, b->layers, 1) &&
           same_extent(a->mips, b->mips, 1);
}

static bool can_borrow(const struct pipeline *pipeline, const struct resource *owner,
                       const struct resource *borrower)
{
    if (owner == borrower || owner->share >= 0 || !same_texture(owner, borrower))
        return false;
    EACH(other, pipeline->resources, pipeline->resource_count)
        if ((other == owner || other->share == (int)owner->index) && other != borrower &&
            overlap(other, borrower))
            return false;
    return true;
}

/* An image borrows the texture of an earlier image of the spec that owns one. So no chains arise,
 * and owners come first. */
static void plan_opengl_shares(struct pipeline *pipeline)
{
    CHANGE_EACH(resource, pipeline->resources, pipeline->resource_count)
        resource->share = -1;
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        struct resource *borrower = &pipeline->resources[i];

        for (uint32_t j = 0; j < i && borrower->share < 0 && borrower->kind == DT_IMAGE; j++)
            if (can_borrow(pipeline, &pipeline->resources[j], borrower))
                borrower->share = (int)j;
    }
}

void plan_slots(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;
    bool *placed = arena_alloc(model->arena, pipeline->resource_count * sizeof *placed + 1);
    uint64_t *slot_bytes =
        arena_alloc(model->arena, pipeline->resource_count * sizeof *slot_bytes + 1);

    if (placed && slot_bytes)
        plan_vulkan_slots(pipeline, placed, slot_bytes);
    plan_opengl_shares(pipeline);
}
