/* Passes: formats, samplers and sizes that their accesses need, targets that fit together,
 * conflicting accesses, ranges and dispatch sizes. */
#include <inttypes.h>
#include <string.h>

#include "checks.h"
#include "formats.h"

enum { MOST_TARGETS = 8, MOST_GROUPS = 65535 };

static bool is_depth(const struct resource *r)
{
    return r->kind == DT_IMAGE && r->format == DT_FORMAT_D32F;
}

static bool is_target(const struct pass *pass, const struct access *access)
{
    return pass->kind != DT_PASS_DISPATCH && access->mode != MODE_READ && access->resource &&
           access->resource->kind == DT_IMAGE && !access->stores;
}

static void note_declared(struct checker *c, const struct resource *resource)
{
    diag_note(c->diag, resource->loc, "`%s` is declared here", resource->name);
}

/* ---- One access ------------------------------------------------------------------------------ */

static void check_mip(struct checker *c, const struct pass *pass, struct access *access)
{
    int64_t mip = 0, mips = 1;
    struct limits limits = {"the mip", access->name, EXPR_BAKED, 0, 14};
    if (!access->mip || !access->resource)
        return;
    if (access->resource->kind != DT_IMAGE) {
        diag_error(c->diag, expr_loc(access->mip), "`%s` is a buffer and has no mips",
                   access->name);
        return;
    }
    if (!check_baked(c, access->mip, &limits, &mip))
        return;
    access->mip_value = (uint32_t)mip;
    if (access->resource->mips && expr_eval(access->resource->mips, 1, 1, &mips) != EXPR_OK)
        return;
    if (mip >= mips) {
        diag_error(c->diag, expr_loc(access->mip),
                   "`%s` has %" PRId64 " mips, so there is no mip %" PRId64 " (pass `%s`)",
                   access->name, mips, mip, pass->name);
        note_declared(c, access->resource);
    }
}

static void check_layer(struct checker *c, const struct pass *pass, struct access *access)
{
    int64_t layer = 0, extent[3];
    struct limits limits = {"the layer", access->name, EXPR_BAKED, 0, 2047};
    if (!access->layer || !access->resource)
        return;
    if (!access->resource->layers || access->resource->shape == DT_SHAPE_3D) {
        diag_error(c->diag, expr_loc(access->layer), "`%s` is no array and has no layers",
                   access->name);
        note_declared(c, access->resource);
        return;
    }
    if (!check_baked(c, access->layer, &limits, &layer))
        return;
    access->layer_value = (uint32_t)layer;
    if (pass->layers && is_target(pass, access))
        diag_error(c->diag, expr_loc(access->layer),
                   "the pass `%s` is layered: its targets have all layers", pass->name);
    for (int i = 0; i < FRAME_SIZES; i++) {
        if (!image_extent(access->resource, 0, frame_sizes[i], extent) || layer < extent[2])
            continue;
        diag_error(c->diag, expr_loc(access->layer),
                   "`%s` has %" PRId64 " layers, so there is no layer %" PRId64 " (pass `%s`)",
                   access->name, extent[2], layer, pass->name);
        note_declared(c, access->resource);
        return;
    }
}

static void check_filter(struct checker *c, const struct access *access)
{
    const struct sampler *filter = access->filter;
    const struct resource *image = access->resource;
    if (!filter || !image)
        return;
    bool integers = image->kind == DT_IMAGE && format_is_integer(image->format);
    bool linear = filter->linear || filter->linear_mip;
    const char *wrong =
        image->kind != DT_IMAGE ? NULL
        : filter->compare && !is_depth(image)
            ? "`%s` compares depths, but `%s` is no image of format d32f"
        : is_depth(image) && linear && !filter->compare
            ? "`%s` filters linearly, which d32f (`%s`) allows only with compare: true"
        : integers && (linear || filter->anisotropy > 1)
            ? "`%s` filters linearly, but `%s` has an integer format"
        : integers && filter->wrap == DT_WRAP_BORDER
            ? "`%s` wraps to a border, but `%s` has an integer format"
            : NULL;
    if (image->kind != DT_IMAGE)
        diag_error(c->diag, access->sampler_loc, "`%s` is a buffer and cannot be sampled",
                   access->name);
    else if (wrong)
        diag_error(c->diag, access->sampler_loc, wrong, filter->name, access->name);
}

static void check_storage(struct checker *c, const struct pass *pass, const struct access *access)
{
    const struct resource *image = access->resource;
    bool draw = pass->kind != DT_PASS_DISPATCH;
    bool written = (!draw || access->stores) && access->mode != MODE_READ && image;
    bool depth = written && is_depth(image);
    if (access->stores &&
        (!draw || access->mode == MODE_READ || (image && image->kind != DT_IMAGE)))
        diag_error(c->diag, access->loc, "`%s` is no image that a draw writes, and has no `stores`",
                   access->name);
    if (!depth && !(written && image->kind == DT_IMAGE && image->format == DT_FORMAT_RGBA8_SRGB))
        return;
    diag_error(c->diag, access->loc,
               "`%s` has the format %s, in which shaders cannot store; use %s, or a draw's target",
               access->name, format_info(image->format)->name, depth ? "r32f" : "rgba8");
    note_declared(c, image);
}

static void check_blend(struct checker *c, const struct pass *pass, const struct access *access)
{
    const struct resource *image = access->resource;
    bool colour = is_target(pass, access) && !is_depth(image);
    if (!image)
        return;
    for (int i = 0; i < 2 && !colour; i++)
        if (i ? access->own_mask : access->own_blend)
            diag_error(c->diag, i ? access->mask_loc : access->blend_loc,
                       "`%s` is no colour target of the pass `%s` and has no `%s`", access->name,
                       pass->name, i ? "mask" : "blend");
    if (colour && access->blend && format_is_integer(image->format))
        diag_error(c->diag, access->own_blend ? access->blend_loc : access->loc,
                   "`%s` has an integer format, which cannot be blended (pass `%s`)", access->name,
                   pass->name);
}

/* ---- Pairs of accesses ----------------------------------------------------------------------- */

static bool both(const struct access *a, const struct access *b, enum access_mode x,
                 enum access_mode y)
{
    return (a->mode == x && b->mode == y) || (a->mode == y && b->mode == x);
}

/* In a body, a texel read is `image(p)`, a sampled read `image_sample(uv)`, a store `image_store(p,
 * value)` and a target `image`, for every mip and layer. */
static bool same_view(const struct pass *pass, const struct access *a, const struct access *b)
{
    bool texels_a = a->mode != MODE_WRITE && !a->sampler,
         texels_b = b->mode != MODE_WRITE && !b->sampler;
    bool target = is_target(pass, a) || is_target(pass, b);
    if (strcmp(access_word(a), access_word(b)))
        return false;
    return !a->layer != !b->layer || (texels_a && texels_b) || (a->sampler && b->sampler) ||
           (a->mode != MODE_READ && b->mode != MODE_READ) || (target && (texels_a || texels_b));
}

/* Whether no texel belongs to both accesses to one image. */
static bool are_apart(const struct access *a, const struct access *b)
{
    bool sampled_whole =
        (a->sampler && !a->mip && !a->layer) || (b->sampler && !b->mip && !b->layer);
    return (a->layer && b->layer && a->layer_value != b->layer_value) ||
           ((a->mip || b->mip) && a->mip_value != b->mip_value && !sampled_whole);
}

/* Reports conflicts of two accesses to one resource. Different mips and layers do not conflict; a
 * pass may read an image both by texel and through a sampler. */
static void check_pair(struct checker *c, const struct pass *pass, const struct access *a,
                       const struct access *b)
{
    static const char *const keys[] = {"reads", "writes", "updates"};
    if (strcmp(a->name, b->name))
        return;
    bool image = a->resource && a->resource->kind == DT_IMAGE;
    if (image && are_apart(a, b)) {
        if (!same_view(pass, a, b))
            return;
        diag_error(
            c->diag, b->loc,
            "the pass `%s` uses two %s of `%s` under the same name; give each its own with `as`",
            pass->name, a->layer && b->layer ? "layers" : "mips", b->name);
    } else if (a->mode == MODE_READ && b->mode == MODE_READ) {
        if (image && !same_view(pass, a, b))
            return;
        diag_error(c->diag, b->loc, "the pass `%s` lists `%s` twice in reads", pass->name, b->name);
    } else if (image && (is_target(pass, a) || is_target(pass, b)) &&
               (a->mode == MODE_READ || b->mode == MODE_READ)) {
        diag_error(c->diag, b->loc,
                   "the pass `%s` reads `%s` while it is a target of the same draw", pass->name,
                   b->name);
    } else if (both(a, b, MODE_READ, MODE_WRITE)) {
        diag_error(c->diag, b->loc,
                   "the pass `%s` both reads and writes `%s`; list it in `updates` alone%s",
                   pass->name, b->name,
                   image ? ", or read what it held a frame ago with `previous: 1`" : "");
    } else {
        diag_error(c->diag, b->loc, "the pass `%s` lists `%s` in %s and %s", pass->name, b->name,
                   keys[a->mode], a->mode == b->mode ? "again" : keys[b->mode]);
    }
    diag_note(c->diag, a->loc, "first here");
}

static bool holds_integers(const struct structure *structure, int64_t least)
{
    for (uint32_t i = 0; i < structure->field_count && least > 0; i++) {
        const struct field *field = &structure->fields[i];
        const struct type_info *type = type_info(field->type);
        if (type->scalar != DT_TYPE_INT && type->scalar != DT_TYPE_UINT)
            return false;
        least -= type->components * (field->array_count ? field->array_count : 1);
    }
    return least <= 0;
}

static void check_arguments(struct checker *c, const struct pass *pass)
{
    const struct resource *used[2] = {pass->indirect_resource, pass->index_resource};
    const struct loc locs[2] = {pass->indirect_loc, pass->indices_loc};
    static const char *const what[2] = {"its indirect arguments", "its indices"};
    for (int i = 0; i < 2; i++) {
        for (uint32_t k = 0; used[i] && k < pass->access_count; k++)
            if (pass->accesses[k].mode != MODE_READ &&
                !strcmp(pass->accesses[k].name, used[i]->name))
                diag_error(c->diag, pass->accesses[k].loc,
                           "the pass `%s` changes `%s`, which holds %s", pass->name, used[i]->name,
                           what[i]);
        if (used[i] && !used[i]->structure && used[i]->of && used[i]->type != DT_TYPE_UINT)
            diag_error(c->diag, locs[i], "`%s` must be a buffer of uint%s", used[i]->name,
                       i ? "" : ", or of a struct of uint");
    }
    int64_t least = pass->kind == DT_PASS_DISPATCH        ? 3
                    : pass->kind == DT_PASS_DRAW_VERTICES ? 4
                                                          : 5;
    const char *kind = pass->kind == DT_PASS_DISPATCH ? "dispatch" : "draw";
    int64_t count = least;
    if (used[0] && used[0]->structure && !holds_integers(used[0]->structure, least))
        diag_error(c->diag, pass->indirect_loc,
                   "`%s` must begin with %" PRId64
                   " numbers of type int or uint, the arguments of a %s",
                   used[0]->structure->name, least, kind);
    else if (used[0] && !used[0]->structure && expr_eval(used[0]->count, 1, 1, &count) == EXPR_OK &&
             count < least)
        diag_error(c->diag, pass->indirect_loc,
                   "`%s` has %" PRId64 " elements; the arguments of a %s are %" PRId64,
                   used[0]->name, count, kind, least);
}

/* ---- Targets --------------------------------------------------------------------------------- */

static void check_target_sizes(struct checker *c, const struct pass *pass,
                               const struct access *first, const struct access *other)
{
    for (int i = 0; i < FRAME_SIZES; i++) {
        int64_t a[3], b[3];
        if (!image_extent(first->resource, first->mip_value, frame_sizes[i], a) ||
            !image_extent(other->resource, other->mip_value, frame_sizes[i], b) ||
            (a[0] == b[0] && a[1] == b[1]))
            continue;
        diag_error(c->diag, other->loc,
                   "the targets of the pass `%s` differ in size: `%s` has %" PRId64 "x%" PRId64
                   ", `%s` has %" PRId64 "x%" PRId64 " at a frame of %dx%d",
                   pass->name, first->name, a[0], a[1], other->name, b[0], b[1], frame_sizes[i][0],
                   frame_sizes[i][1]);
        return;
    }
}

static void check_target_layers(struct checker *c, const struct pass *pass,
                                const struct access *target)
{
    const struct resource *image = target->resource;
    if (image->shape == DT_SHAPE_3D) {
        diag_error(c->diag, target->loc,
                   "`%s` is a 3D image, which a draw cannot write; use a dispatch, or `layers`",
                   target->name);
        return;
    }
    if (!pass->layers && image->layers && !target->layer)
        diag_error(c->diag, target->loc, "`%s` is %s, but the pass `%s` has no `layers`",
                   target->name, image->shape == DT_SHAPE_CUBE ? "a cube" : "an array", pass->name);
    else if (pass->layers && !image->layers)
        diag_error(c->diag, target->loc, "the pass `%s` is layered, but `%s` is no array",
                   pass->name, target->name);
    for (int i = 0; pass->layers && image->layers && i < FRAME_SIZES; i++) {
        int64_t layers, extent[3];
        if (expr_eval(pass->layers, frame_sizes[i][0], frame_sizes[i][1], &layers) != EXPR_OK ||
            !image_extent(image, 0, frame_sizes[i], extent) || layers == extent[2])
            continue;
        diag_error(c->diag, target->loc,
                   "the pass `%s` draws %" PRId64 " layers, but `%s` has %" PRId64, pass->name,
                   layers, target->name, extent[2]);
        return;
    }
}

static void check_targets(struct checker *c, const struct pass *pass)
{
    const struct access *first = NULL, *depth = NULL;
    uint32_t colors = 0;
    EACH(target, pass->accesses, pass->access_count) {
        if (!is_target(pass, target))
            continue;
        if (is_depth(target->resource) && depth)
            diag_error(c->diag, target->loc,
                       "a second depth target in the pass `%s`; `%s` is the first", pass->name,
                       depth->name);
        if (is_depth(target->resource))
            depth = target;
        else if (++colors > MOST_TARGETS)
            diag_error(c->diag, target->loc, "the pass `%s` has more than %d colour targets",
                       pass->name, MOST_TARGETS);
        check_target_layers(c, pass, target);
        if (first)
            check_target_sizes(c, pass, first, target);
        else
            first = target;
    }
    bool unresolved = false;
    EACH(access, pass->accesses, pass->access_count)
        unresolved |= access->mode != MODE_READ && !access->resource;
    if (!first && !unresolved)
        diag_error(c->diag, pass->loc,
                   "the pass `%s` is a draw without a target; list an image in `writes`",
                   pass->name);
}

/* ---- Sizes and ranges ------------------------------------------------------------------------ */

static const char *const sides[] = {"width", "height", "depth"};

static void check_local(struct checker *c, struct pass *pass)
{
    uint64_t total = 1;
    for (int i = 0; i < 3; i++) {
        struct limits limits = {check_part(c, sides[i], "workgroup"), pass->name, EXPR_BAKED, 1,
                                i == 2 ? 64 : 1024};
        int64_t value = 1;
        if (check_baked(c, pass->local_size[i], &limits, &value))
            pass->local[i] = (uint32_t)value;
        total *= pass->local[i];
    }
    if (total > 1024)
        diag_error(c->diag, expr_loc(pass->local_size[0]),
                   "a workgroup of %" PRIu64 " invocations (pass `%s`); at most 1024", total,
                   pass->name);
}

static void check_dispatch(struct checker *c, struct pass *pass)
{
    check_local(c, pass);
    for (int i = 0; i < 3; i++) {
        int64_t most =
            pass->size == SIZE_GROUPS ? MOST_GROUPS : (int64_t)MOST_GROUPS * pass->local[i];
        struct expr *size = pass->dispatch[i];
        bool varies = expr_resolve(size, c->pipeline, c->diag) && expr_reach(size);
        struct limits limits = {check_part(c, sides[i], "dispatch"), pass->name,
                                EXPR_FRAME | EXPR_LIVE, varies ? 0 : 1, most};
        check_expr(c, pass->dispatch[i], &limits);
    }
}

static void check_rect(struct checker *c, const struct pass *pass, struct expr *const rect[4],
                       const char *what)
{
    static const char *const parts[] = {"x", "y", "width", "height"};
    for (int i = 0; i < 4; i++) {
        struct limits limits = {check_part(c, parts[i], what), pass->name, EXPR_FRAME | EXPR_LIVE,
                                i < 2 ? -DT_MAX_SIDE : 0, DT_MAX_SIDE};
        check_expr(c, rect[i], &limits);
    }
}

static void check_draw(struct checker *c, const struct pass *pass)
{
    struct limits vertices = {"the number of vertices", pass->name, EXPR_FRAME | EXPR_LIVE, 0,
                              INT32_MAX};
    struct limits instances = {"the number of instances", pass->name, EXPR_FRAME | EXPR_LIVE, 0,
                               INT32_MAX};
    check_expr(c, pass->vertices, &vertices);
    check_expr(c, pass->instances, &instances);
    check_rect(c, pass, pass->viewport, "viewport");
    check_rect(c, pass, pass->scissor, "scissor");
    check_targets(c, pass);
}

static void check_range(struct checker *c, const struct pass *pass, struct range *range)
{
    struct limits limits = {"the count", range->name, EXPR_BAKED, 1, 1 << 20};
    if (!check_baked(c, range->count, &limits, &range->count_value))
        return;
    const struct resource *buffer = range->access ? range->access->resource : NULL;
    for (int i = 0; buffer && buffer->count && i < FRAME_SIZES; i++) {
        int64_t count;
        if (expr_eval(buffer->count, frame_sizes[i][0], frame_sizes[i][1], &count) != EXPR_OK ||
            count >= range->count_value)
            continue;
        diag_error(c->diag, expr_loc(range->count),
                   "the range `%s` of the pass `%s` has %" PRId64
                   " elements, but `%s` has %" PRId64,
                   range->name, pass->name, range->count_value, buffer->name, count);
        note_declared(c, buffer);
        return;
    }
}

static void check_pass(struct checker *c, struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        check_mip(c, pass, &pass->accesses[i]);
        check_layer(c, pass, &pass->accesses[i]);
        check_filter(c, &pass->accesses[i]);
        check_storage(c, pass, &pass->accesses[i]);
        check_blend(c, pass, &pass->accesses[i]);
        EACH(access, pass->accesses, i)
            check_pair(c, pass, access, &pass->accesses[i]);
    }
    struct limits when = {"the condition", pass->name, EXPR_FRAME | EXPR_LIVE, INT64_MIN,
                          INT64_MAX};
    struct limits layers = {"the number of layers", pass->name, EXPR_BAKED, 1, 2048};
    if (check_expr(c, pass->when, &when))
        pass->conditional = expr_reach(pass->when) != EXPR_BAKED;
    if (!check_expr(c, pass->layers, &layers))
        pass->layers = NULL;
    check_arguments(c, pass);
    if (pass->kind == DT_PASS_DISPATCH)
        check_dispatch(c, pass);
    else
        check_draw(c, pass);
    CHANGE_EACH(range, pass->ranges, pass->range_count)
        check_range(c, pass, range);
    EACH(define, pass->defines, pass->define_count) {
        unsigned reach = define->word ? EXPR_FRAME | EXPR_LIVE : EXPR_BAKED;
        struct limits macro = {"the value", define->name, reach, INT32_MIN, INT32_MAX};
        check_expr(c, define->value, &macro);
    }
}

void check_passes(struct checker *c)
{
    CHANGE_EACH(pass, c->pipeline->passes, c->pipeline->pass_count)
        check_pass(c, pass);
}
