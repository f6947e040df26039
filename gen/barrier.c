/* What each pass waits for: Vulkan's barriers from the accesses of the frame so far, and OpenGL's
 * memory barrier bits. Called by plan.c (Vulkan) and emit_gl.c (OpenGL). Frames are separated by a
 * wait for the device, which leaves all earlier writes available: the first touch in a frame
 * depends on nothing but the user of the same memory before it. */
#include "plan.h"

enum { KIND_COUNT = 10 };
static const unsigned write_kinds =
    ACCESS_STORAGE_WRITE | ACCESS_COLOR | ACCESS_DEPTH | ACCESS_CLEAR;

enum image_layout layout_of(unsigned kind)
{
    unsigned read = kind & (ACCESS_FETCH | ACCESS_SAMPLED),
             target = kind & (ACCESS_COLOR | ACCESS_DEPTH);

    if (kind & (ACCESS_STORAGE_READ | ACCESS_STORAGE_WRITE) || (read && target)) {
        return LAYOUT_GENERAL;
    }
    return kind & ACCESS_COLOR ? LAYOUT_COLOR : kind & ACCESS_DEPTH ? LAYOUT_DEPTH : LAYOUT_READ;
}

/* ---- Vulkan ---------------------------------------------------------------------------------- */

/* What happened to one resource in the frame so far. Readers count since the last write or change
 * of layout; both are writes to the readers after them, but a change of layout leaves nothing to be
 * made available. */
struct history {
    bool touched;
    bool changed_layout; /* after the last write */
    enum image_layout layout;
    unsigned write_kind, write_stages; /* the last write; 0: none in this frame */
    unsigned read_kind, read_stages;
    /* per kind of access: stages to which the content was made visible */
    unsigned visible[KIND_COUNT];
};

static bool sees(const struct history *past, const struct touch *touch)
{
    for (unsigned kind = 0; kind < KIND_COUNT; kind++) {
        if (touch->kind & 1u << kind && touch->stages & ~past->visible[kind]) {
            return false;
        }
    }
    return true;
}

/* Readers wait for the write themselves, so whoever waits for all readers waits for the write too,
 * and finds it available. */
static void wait_for(struct barrier *barrier, const struct history *past)
{
    if (past->read_stages) {
        barrier->from = past->read_kind;
        barrier->from_stages = past->read_stages;
    } else {
        barrier->from = past->write_kind & write_kinds;
        barrier->from_stages = past->write_stages;
        barrier->from_writes = past->write_stages != 0;
    }
}

/* Whether `other` is done with the memory that `resource` is about to take. */
static bool used_before(const struct resource *other, const struct resource *resource)
{
    return other != resource && other->slot == resource->slot && !other->history &&
           !resource->history && other->first_pass >= 0 && other->last_pass < resource->first_pass;
}

/* The last user of the memory that `resource` is about to take, or NULL. */
static const struct resource *alias_before(const struct pipeline *pipeline,
                                           const struct resource *resource)
{
    const struct resource *before = NULL;

    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *other = &pipeline->resources[i];

        if (used_before(other, resource) && (!before || other->last_pass > before->last_pass)) {
            before = other;
        }
    }
    return before;
}

/* The last user of the memory waited for those before it, but made available only what lies in its
 * own bytes: what others wrote beyond those, and nobody read, is still to be made available. */
static void wait_for_unread(struct barrier *barrier, const struct pipeline *pipeline,
                            const struct history *past)
{
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *other = &pipeline->resources[i];
        const struct history *own = &past[i];

        if (other != barrier->alias && used_before(other, barrier->resource) && own->write_stages &&
            !own->read_stages) {
            barrier->from |= own->write_kind & write_kinds;
            barrier->from_stages |= own->write_stages;
            barrier->from_writes = true;
        }
    }
}

/* Returns whether the touch needs the barrier that it fills. */
static bool first_touch(const struct pipeline *pipeline, const struct history *past,
                        const struct touch *touch, struct barrier *barrier)
{
    const struct resource *resource = touch->resource;
    const struct resource *alias = alias_before(pipeline, resource);

    barrier->discard = !resource->history;
    barrier->alias = alias;
    if (alias) {
        wait_for(barrier, &past[alias->index]);
        wait_for_unread(barrier, pipeline, past);
    }
    return resource->kind == DT_IMAGE || resource->history || alias;
}

static bool later_touch(const struct history *past, const struct touch *touch,
                        struct barrier *barrier)
{
    bool changes = touch->resource->kind == DT_IMAGE && layout_of(touch->kind) != past->layout;

    if (touch->writes || changes) {
        wait_for(barrier, past);
        return true;
    }
    if (sees(past, touch)) {
        return false;
    }
    if (past->write_stages && !past->changed_layout) {
        barrier->from = past->write_kind & write_kinds;
        barrier->from_stages = past->write_stages;
        barrier->from_writes = true;
    } else {
        barrier->from = past->read_kind;
        barrier->from_stages = past->read_stages;
    }
    return true;
}

static void remember(struct history *past, const struct touch *touch, bool waited)
{
    bool image = touch->resource->kind == DT_IMAGE;
    bool changes = image && (!past->touched || layout_of(touch->kind) != past->layout);

    if (touch->writes || changes) {
        for (unsigned kind = 0; kind < KIND_COUNT; kind++) {
            past->visible[kind] = 0;
        }
        past->read_kind = past->read_stages = 0;
        past->changed_layout = !touch->writes;
    }
    past->touched = true;
    past->layout = image ? layout_of(touch->kind) : LAYOUT_GENERAL;
    if (touch->writes) {
        past->write_kind = touch->kind;
        past->write_stages = touch->stages;
        return;
    }
    past->read_kind |= touch->kind;
    past->read_stages |= touch->stages;
    for (unsigned kind = 0; kind < KIND_COUNT && waited; kind++) {
        past->visible[kind] |= touch->kind & 1u << kind ? touch->stages : 0;
    }
}

static void plan_pass_barriers(struct model *model, struct pass *pass, struct history *past)
{
    struct touch *touches = arena_alloc(model->arena, (pass->access_count + 2) * sizeof *touches);
    uint32_t count = touches ? pass_touches(pass, touches) : 0;

    pass->barrier_count = 0;
    pass->barriers = arena_alloc(model->arena, (count + 1) * sizeof *pass->barriers);
    for (uint32_t i = 0; i < count && pass->barriers; i++) {
        const struct touch *touch = &touches[i];
        struct history *own = &past[touch->resource->index];
        struct barrier barrier = {.resource = touch->resource,
                                  .to = touch->kind,
                                  .to_stages = touch->stages,
                                  .to_writes = touch->writes};
        bool waits = own->touched ? later_touch(own, touch, &barrier)
                                  : first_touch(&model->pipeline, past, touch, &barrier);

        if (waits) {
            pass->barriers[pass->barrier_count++] = barrier;
        }
        remember(own, touch, waits);
    }
}

void plan_barriers(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;
    struct history *past = arena_alloc(model->arena, pipeline->resource_count * sizeof *past + 1);

    for (uint32_t i = 0; i < pipeline->pass_count && past; i++) {
        plan_pass_barriers(model, pipeline->order[i], past);
    }
}

/* ---- OpenGL ---------------------------------------------------------------------------------- */

/* OpenGL orders everything by itself except what shaders store (OpenGL 4.6, 7.13.2): consumers of
 * stores need their kind's bit, and so do stores that must not overtake earlier accesses. Textures
 * that several images share count once. */
struct coherence {
    bool stored, accessed;
    unsigned since_store, since_access; /* bits issued since then */
};

static struct coherence *coherence_of(struct coherence *all, const struct resource *resource)
{
    return &all[resource->share >= 0 ? (uint32_t)resource->share : resource->index];
}

static unsigned consumer_bits(const struct touch *touch)
{
    bool image = touch->resource->kind == DT_IMAGE;
    unsigned bits = 0;

    if (touch->kind & (ACCESS_STORAGE_READ | ACCESS_STORAGE_WRITE)) {
        bits |= image ? GLB_SHADER_IMAGE_ACCESS : GLB_SHADER_STORAGE;
    }
    if (touch->kind & ACCESS_CLEAR) {
        bits |= image ? GLB_TEXTURE_UPDATE : GLB_BUFFER_UPDATE;
    }
    bits |= touch->kind & (ACCESS_FETCH | ACCESS_SAMPLED) ? GLB_TEXTURE_FETCH : 0;
    bits |= touch->kind & ACCESS_UNIFORM ? GLB_UNIFORM : 0;
    bits |= touch->kind & (ACCESS_COLOR | ACCESS_DEPTH) ? GLB_FRAMEBUFFER : 0;
    bits |= touch->kind & ACCESS_INDIRECT ? GLB_COMMAND : 0;
    bits |= touch->kind & ACCESS_INDEX ? GLB_ELEMENT_ARRAY : 0;
    return bits;
}

static unsigned needed_bits(const struct coherence *state, const struct touch *touch)
{
    unsigned bits = consumer_bits(touch), needed = 0;

    if (state->stored) {
        needed |= bits & ~state->since_store;
    }
    if (state->accessed && touch->kind & ACCESS_STORAGE_WRITE) {
        needed |= bits & (GLB_SHADER_IMAGE_ACCESS | GLB_SHADER_STORAGE) & ~state->since_access;
    }
    return needed;
}

static unsigned pass_bits(const struct pipeline *pipeline, struct coherence *all,
                          const struct touch *touches, uint32_t count)
{
    unsigned bits = 0;

    for (uint32_t i = 0; i < count; i++) {
        bits |= needed_bits(coherence_of(all, touches[i].resource), &touches[i]);
    }
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        all[i].since_store |= bits;
        all[i].since_access |= bits;
    }
    for (uint32_t i = 0; i < count; i++) {
        struct coherence *state = coherence_of(all, touches[i].resource);

        state->accessed = true;
        state->since_access = 0;
        if (touches[i].kind & ACCESS_STORAGE_WRITE) {
            state->stored = true;
            state->since_store = 0;
        } else if (touches[i].writes && !touches[i].reads && !touches[i].resource->mips) {
            state->stored = false; /* drawn anew: nothing that a shader stored is left */
        }
    }
    return bits;
}

void plan_gl_bits(const struct model *model, unsigned *bits)
{
    const struct pipeline *pipeline = &model->pipeline;
    struct coherence *all = arena_alloc(model->arena, pipeline->resource_count * sizeof *all + 1);

    /* Twice: the second frame starts where the first one ended. */
    for (int frame = 0; frame < 2 && all; frame++) {
        for (uint32_t i = 0; i < pipeline->pass_count; i++) {
            const struct pass *pass = pipeline->order[i];
            struct touch *touches =
                arena_alloc(model->arena, (pass->access_count + 2) * sizeof *touches);

            bits[i] = touches ? pass_bits(pipeline, all, touches, pass_touches(pass, touches)) : 0;
        }
    }
}
