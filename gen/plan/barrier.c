/* The barriers of each pass, from the accesses of the frame so far.
 *
 * Each frame opens with a full barrier that makes all earlier writes visible (runtime_vk/frame.c).
 * So the first touch in a frame depends only on this barrier and on the former user of the same
 * memory, and the barriers are constants of the spec, the same in every frame. The first change of
 * a layout chains to the opening barrier (barrier_of in lower.c).
 *
 * One walk over the passes, in their order, keeps a history of each mip: the last write, the
 * readers since, and to which kinds of access in which stages the content is visible. Who reads
 * waits for the write, unless it is visible there; who writes waits for the readers, who waited for
 * the write, or for the write if nobody read.
 *
 * Invariants:
 * - A pass has at most one barrier for a resource, with one mask for all its mips. What it makes
 *   visible beyond the need is remembered, so that later passes do not wait again.
 * - An image has one layout while a pass runs, for all mips and accesses (layout_of).
 * - A pass that may be skipped records its barriers in any case (steps.c), and the clears in its
 *   place count as accesses (DT_WRITE_CLEAR in plan.c). So later passes need not know whether it
 *   ran.
 * - Resources with history begin visible to all, whatever pass wrote them last.
 *
 * Where synchronization validation (1.3.239) demands more than the specification, a comment says
 * so. tests/runtime/barrier_audit.c checks with a model of its own that every barrier is needed and that
 * they suffice. */
#include "plan.h"

enum { KIND_COUNT = 11 }; /* bits of enum dt_access */
static const unsigned write_kinds =
    DT_WRITE_STORAGE | DT_WRITE_COLOR | DT_WRITE_DEPTH | DT_WRITE_CLEAR;

enum dt_layout layout_of(unsigned kind)
{
    unsigned read = kind & DT_READ_TEXTURE, target = kind & (DT_WRITE_COLOR | DT_WRITE_DEPTH);

    if (kind & (DT_READ_STORAGE | DT_WRITE_STORAGE) || (read && target))
        return DT_LAYOUT_GENERAL;
    return kind & DT_WRITE_COLOR   ? DT_LAYOUT_COLOR
           : kind & DT_WRITE_DEPTH ? DT_LAYOUT_DEPTH
                                   : DT_LAYOUT_READ;
}

/* ---- Vulkan ---------------------------------------------------------------------------------- */

/* What happened to one mip in the frame so far. Readers are those since the last write or change of
 * layout. Later readers wait for either, but a change of layout leaves no writes to make
 * available. */
struct mip_history {
    bool used;           /* touched in this frame, after the last change of layout if any */
    bool changed_layout; /* after the last write */
    bool surely_read;    /* by a pass that always runs */
    unsigned write_kind, write_stages; /* the last write; 0: none in this frame */
    /* readers; or the accesses that waited for the change of layout */
    unsigned read_kind, read_stages;
    /* per kind of access: stages to which the content was made visible */
    unsigned visible[KIND_COUNT];
};

struct history {
    bool touched, layout_known;
    enum dt_layout layout; /* of all mips */
    uint32_t mip_count;
    struct mip_history *mips;
};

static void show(struct mip_history *past, unsigned kinds, unsigned stages)
{
    for (unsigned kind = 0; kind < KIND_COUNT; kind++)
        past->visible[kind] |= kinds & 1u << kind ? stages : 0;
}

static bool sees(const struct mip_history *past, const struct touch *touch)
{
    for (unsigned kind = 0; kind < KIND_COUNT; kind++)
        if (touch->kind & 1u << kind && touch->stages & ~past->visible[kind])
            return false;
    return true;
}

static void wait_for_write(struct barrier *barrier, const struct mip_history *past)
{
    barrier->from |= past->write_kind & write_kinds;
    barrier->from_stages |= past->write_stages;
    barrier->from_writes |= past->write_stages != 0;
}

/* Readers waited for the write, so a wait for all readers covers the write, which is then
 * available. But if every reader may be skipped, synchronization validation (1.3.239) sees only the
 * write and requires it in the barrier. */
static void wait_for_all(struct barrier *barrier, const struct mip_history *past)
{
    barrier->from |= past->read_kind;
    barrier->from_stages |= past->read_stages;
    if (!past->read_stages || (past->used && !past->changed_layout && !past->surely_read))
        wait_for_write(barrier, past);
}

/* For an access that only reads. */
static void wait_for_content(struct barrier *barrier, const struct mip_history *past)
{
    if (past->write_stages && !past->changed_layout) {
        wait_for_write(barrier, past);
    } else {
        barrier->from |= past->read_kind;
        barrier->from_stages |= past->read_stages;
    }
}

/* Whether both share memory and the lifetime of `other` ends before `resource` begins. */
static bool used_before(const struct resource *other, const struct resource *resource)
{
    return other != resource && other->slot == resource->slot && !other->history &&
           !resource->history && other->first_pass >= 0 && other->last_pass < resource->first_pass;
}

/* The previous user of the memory of `resource`, or NULL. */
static const struct resource *alias_before(const struct pipeline *pipeline,
                                           const struct resource *resource)
{
    const struct resource *before = NULL;

    EACH(other, pipeline->resources, pipeline->resource_count)
        if (used_before(other, resource) && (!before || other->last_pass > before->last_pass))
            before = other;
    return before;
}

/* By the specification, barriers chain across resources: the last user of the memory waited for
 * `other`. But synchronization validation (1.3.239) tracks accesses by their bytes. It knows that
 * `other` has ended only if a resource between the two covers every byte that they share. */
static bool order_is_seen(const struct pipeline *pipeline, const struct resource *other,
                          const struct resource *resource)
{
    if (other->kind != resource->kind)
        return true;
    EACH(between, pipeline->resources, pipeline->resource_count)
        if (between->kind == other->kind && used_before(other, between) &&
            used_before(between, resource) &&
            (resource_covers(between, other) || resource_covers(between, resource)))
            return true;
    return false;
}

/* The last user of the memory waited for earlier users, but made available only its own bytes.
 * Earlier writes beyond these bytes that no pass read still have to be made available. */
static void wait_for_memory(struct barrier *barrier, const struct pipeline *pipeline,
                            const struct history *past)
{
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *other = &pipeline->resources[i];
        bool earlier = used_before(other, barrier->resource);

        for (uint32_t mip = 0; mip < past[i].mip_count; mip++) {
            const struct mip_history *own = &past[i].mips[mip];

            if (other == barrier->alias ||
                (earlier && !order_is_seen(pipeline, other, barrier->resource)))
                wait_for_all(barrier, own);
            else if (earlier && own->write_stages && !own->read_stages)
                wait_for_write(barrier, own);
        }
    }
}

static void wait_for_mips(struct barrier *barrier, const struct history *past,
                          const struct touch *touch)
{
    for (uint32_t mip = 0; mip < past->mip_count; mip++) {
        const struct mip_history *own = &past->mips[mip];
        bool waits = touch->writes ? own->used || !sees(own, touch) : !sees(own, touch);

        if (!(touch->mips >> mip & 1) || !waits)
            continue;
        if (touch->writes)
            wait_for_all(barrier, own);
        else
            wait_for_content(barrier, own);
        barrier->to |= touch->kind;
        barrier->to_stages |= touch->stages;
    }
}

/* ---- One pass and one resource --------------------------------------------------------------- */

/* What a pass does to a resource: one touch, or several of different mips. */
struct visit {
    struct resource *resource;
    const struct touch *touches; /* all of the pass, also of other resources */
    uint32_t count;
    unsigned kinds, stages;
    bool always; /* the pass is never skipped */
    bool changes_layout;
};

static struct visit visit_of(const struct pass *pass, const struct touch *touches, uint32_t count,
                             struct resource *resource)
{
    struct visit visit = {
        .resource = resource, .touches = touches, .count = count, .always = !pass->conditional};

    for (uint32_t i = 0; i < count; i++) {
        visit.kinds |= touches[i].resource == resource ? touches[i].kind : 0;
        visit.stages |= touches[i].resource == resource ? touches[i].stages : 0;
    }
    return visit;
}

/* Fills the barrier; returns whether the visit needs it. */
static bool first_visit(const struct pipeline *pipeline, const struct history *past,
                        const struct visit *visit, struct barrier *barrier)
{
    barrier->discard = true;
    barrier->alias = alias_before(pipeline, visit->resource);
    barrier->to = visit->kinds;
    barrier->to_stages = visit->stages;
    if (barrier->alias)
        wait_for_memory(barrier, pipeline, past);
    return visit->changes_layout || barrier->alias;
}

static bool later_visit(const struct history *past, const struct visit *visit,
                        struct barrier *barrier)
{
    if (visit->changes_layout) {
        for (uint32_t mip = 0; mip < past->mip_count; mip++)
            wait_for_all(barrier, &past->mips[mip]);
        barrier->to = visit->kinds;
        barrier->to_stages = visit->stages;
        return true;
    }
    for (uint32_t i = 0; i < visit->count; i++)
        if (visit->touches[i].resource == visit->resource)
            wait_for_mips(barrier, past, &visit->touches[i]);
    return barrier->to != 0;
}

/* A barrier has one mask of accesses for all mips, so it may show the content of more mips, and to
 * more accesses, than the visit needs. */
static void remember_barrier(struct history *past, const struct barrier *barrier)
{
    CHANGE_EACH(own, past->mips, past->mip_count) {
        bool waits = own->write_stages && !own->changed_layout &&
                     !(own->write_kind & write_kinds & ~barrier->from) &&
                     !(own->write_stages & ~barrier->from_stages);

        if (barrier->from_writes && waits)
            show(own, barrier->to, barrier->to_stages);
    }
}

static void remember_touch(struct mip_history *past, const struct touch *touch, bool always)
{
    if (touch->writes) {
        *past = (struct mip_history){
            .used = true, .write_kind = touch->kind, .write_stages = touch->stages};
        return;
    }
    if (!past->used)
        past->read_kind = past->read_stages = 0;
    past->used = true;
    past->surely_read |= always;
    past->read_kind |= touch->kind;
    past->read_stages |= touch->stages;
    show(past, touch->kind, touch->stages);
}

static void remember_layout(struct mip_history *past, const struct visit *visit)
{
    past->used = false;
    past->changed_layout = past->surely_read = true;
    past->read_kind = visit->kinds & ~write_kinds;
    past->read_stages = visit->stages;
    for (unsigned kind = 0; kind < KIND_COUNT; kind++)
        past->visible[kind] = 0;
    for (uint32_t i = 0; i < visit->count; i++)
        if (visit->touches[i].resource == visit->resource)
            show(past, visit->touches[i].kind, visit->touches[i].stages);
}

static void remember(struct history *past, const struct visit *visit)
{
    for (uint32_t mip = 0; mip < past->mip_count; mip++) {
        if (visit->changes_layout)
            remember_layout(&past->mips[mip], visit);
        for (uint32_t i = 0; i < visit->count; i++)
            if (visit->touches[i].resource == visit->resource && visit->touches[i].mips >> mip & 1)
                remember_touch(&past->mips[mip], &visit->touches[i], visit->always);
    }
    past->touched = past->layout_known = true;
    past->layout = layout_of(visit->kinds);
}

/* ---- The frame ------------------------------------------------------------------------------- */

static bool visited_before(const struct touch *touches, uint32_t index)
{
    for (uint32_t i = 0; i < index; i++)
        if (touches[i].resource == touches[index].resource)
            return true;
    return false;
}

static void plan_pass_barriers(struct model *model, struct pass *pass, struct history *past)
{
    struct touch *touches = arena_alloc(model->arena, (pass->access_count + 2) * sizeof *touches);
    uint32_t count = touches ? pass_touches(pass, touches) : 0;

    pass->barrier_count = 0;
    pass->barriers = arena_alloc(model->arena, (count + 1) * sizeof *pass->barriers);
    for (uint32_t i = 0; i < count && pass->barriers; i++) {
        struct visit visit = visit_of(pass, touches, count, touches[i].resource);
        struct history *own = &past[visit.resource->index];
        struct barrier barrier = {.resource = visit.resource};

        if (visited_before(touches, i))
            continue;
        visit.changes_layout = visit.resource->kind == DT_IMAGE &&
                               (!own->layout_known || layout_of(visit.kinds) != own->layout);
        if (own->touched ? later_visit(own, &visit, &barrier)
                         : first_visit(&model->pipeline, past, &visit, &barrier))
            pass->barriers[pass->barrier_count++] = barrier;
        remember_barrier(own, &barrier);
        remember(own, &visit);
    }
}

/* The layout that a frame leaves an image in. */
static enum dt_layout last_layout(const struct model *model, struct resource *image)
{
    enum dt_layout layout = DT_LAYOUT_GENERAL;

    for (uint32_t i = 0; i < model->pipeline.pass_count; i++) {
        const struct pass *pass = model->pipeline.order[i];
        struct touch *touches =
            arena_alloc(model->arena, (pass->access_count + 2) * sizeof *touches);
        struct visit visit =
            visit_of(pass, touches, touches ? pass_touches(pass, touches) : 0, image);

        layout = visit.kinds ? layout_of(visit.kinds) : layout;
    }
    return layout;
}

/* The full barrier at the start of a frame makes resources with history visible to all accesses.
 * Images are created in the general layout; if a frame ends in another one, the first pass changes
 * it. */
static void begin_history(const struct model *model, struct resource *resource,
                          struct history *past)
{
    past->mip_count = mips_of(resource);
    past->mips = arena_alloc(model->arena, past->mip_count * sizeof *past->mips);
    past->mip_count = past->mips ? past->mip_count : 0;
    if (!resource->history)
        return;
    past->touched = true;
    past->layout = DT_LAYOUT_GENERAL;
    past->layout_known =
        resource->kind == DT_IMAGE && last_layout(model, resource) == DT_LAYOUT_GENERAL;
    for (uint32_t mip = 0; mip < past->mip_count; mip++)
        show(&past->mips[mip], ~0u, ~0u);
}

void plan_barriers(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;
    struct history *past = arena_alloc(model->arena, pipeline->resource_count * sizeof *past + 1);

    for (uint32_t i = 0; i < pipeline->resource_count && past; i++)
        begin_history(model, &pipeline->resources[i], &past[i]);
    for (uint32_t i = 0; i < pipeline->pass_count && past; i++)
        plan_pass_barriers(model, pipeline->order[i], past);
}
