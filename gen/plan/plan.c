/* The plan: the decisions that both backends share, each made once. Emitters and runtimes take the
 * planned model const. So two backends cannot number a binding or order a barrier in two ways, and
 * a difference between them is a driver's or a shader's.
 *
 * plan_model runs the parts in this order, since each needs those before it:
 *   order.c    the passes in order of execution; "before" means in this order from here on
 *   ranges     of a pass: its workgroup, and where the elements that it loops over lie
 *   kinds      what each access is to a device (enum dt_access), also for buffers of ranges
 *   bindings   one numbering for all kinds, since Vulkan has one set
 *   alias.c    lifetimes, then what shares memory
 *   barrier.c  who waits for whom; also for the former user of shared memory
 *
 * pass_touches is the one answer to "which mips does a pass read and write, in which stages":
 * lifetimes and barriers read touches, never accesses.
 *
 * Nothing here asks a device. What is faster on CPU drivers and what on GPUs depends on the spec's
 * `target` alone, and limits are of the APIs and of such kinds (plan.h). So a spec has one plan on
 * all machines, and its generated text can be compared. What does not fit is an error at its place
 * in the spec; all passes are tried, so that one run tells all such errors. */
#include "plan.h"
#include "model/expr.h"
#include "read/body_files.h"
#include "sanitize.h"

uint32_t expr_value(const struct expr *expr, uint32_t width, uint32_t height, uint32_t otherwise)
{
    int64_t value = 0;

    if (!expr || expr_eval(expr, width, height, &value) != EXPR_OK)
        return otherwise;
    return value < 0 ? 0 : value > UINT32_MAX ? UINT32_MAX : (uint32_t)value;
}

uint32_t expr_at_reference(const struct expr *expr, uint32_t otherwise)
{
    return expr_value(expr, REFERENCE_WIDTH, REFERENCE_HEIGHT, otherwise);
}

/* ---- Kinds of access ------------------------------------------------------------------------- */

static unsigned image_kind(const struct pass *pass, const struct access *access)
{
    const struct format_info *format = format_info(access->resource->format);

    if (access->mode == MODE_READ)
        return pass->kind == DT_PASS_DISPATCH && format->qualifier && !access->sampler
                   ? DT_READ_STORAGE
                   : DT_READ_TEXTURE;
    if (pass->kind != DT_PASS_DISPATCH && !access->stores)
        return access->resource->format == DT_FORMAT_D32F     ? DT_READ_DEPTH | DT_WRITE_DEPTH
               : access->mode == MODE_UPDATE || access->blend ? DT_READ_COLOR | DT_WRITE_COLOR
                                                              : DT_WRITE_COLOR;
    return access->mode == MODE_WRITE ? DT_WRITE_STORAGE : DT_READ_STORAGE | DT_WRITE_STORAGE;
}

/* CPU drivers gather from a uniform block, but load from a storage buffer lane by lane, with bounds
 * checks. Passes of SSVP took 1.2 to 1.4 times as long with storage buffers. The longer code also
 * takes longer to compile. */
static bool suits_uniform(const struct pipeline *pipeline, const struct pass *pass,
                          const struct resource *buffer)
{
    uint64_t count = 0;

    if (pipeline->gpu || files_are_whole(pass->files) || !buffer->count ||
        expr_reach(buffer->count) || !std140_equals_std430(buffer) ||
        (pass->asks_length && !expr_is_literal(buffer->count)))
        return false;
    count = expr_at_reference(buffer->count, UINT32_MAX);
    return count * buffer->stride <= SOFTWARE_UNIFORM_LIMIT;
}

static bool reads_uniform(const struct pipeline *pipeline, const struct pass *pass,
                          const struct access *access)
{
    bool suits = suits_uniform(pipeline, pass, access->resource);

    EACH(range, pass->ranges, pass->range_count)
        if (range->access == access)
            return range->storage == STORAGE_UNIFORM || (range->storage != STORAGE_BUFFER && suits);
    return suits;
}

static unsigned buffer_kind(const struct pipeline *pipeline, const struct pass *pass,
                            const struct access *access)
{
    if (access->clears)
        return DT_WRITE_CLEAR;
    if (access->mode == MODE_READ)
        return reads_uniform(pipeline, pass, access) ? DT_READ_UNIFORM : DT_READ_STORAGE;
    return access->mode == MODE_WRITE ? DT_WRITE_STORAGE : DT_READ_STORAGE | DT_WRITE_STORAGE;
}

/* Every device can bind eight storage images. Reads beyond these use texelFetch, which returns the
 * same texels. */
static void limit_storage_images(struct pass *pass, struct diag *diag)
{
    uint32_t count = 0;

    EACH(access, pass->accesses, pass->access_count) {
        count += access->resource && access->resource->kind == DT_IMAGE &&
                 access->kind & (DT_READ_STORAGE | DT_WRITE_STORAGE);
    }
    for (uint32_t i = pass->access_count; i-- > 0 && count > STORAGE_IMAGE_LIMIT;) {
        struct access *access = &pass->accesses[i];

        if (access->resource && access->resource->kind == DT_IMAGE &&
            access->kind == DT_READ_STORAGE) {
            access->kind = DT_READ_TEXTURE;
            count--;
        }
    }
    if (count > STORAGE_IMAGE_LIMIT) {
        diag_error(diag, pass->loc, "`%s` writes and updates %u images; a pass can have %d of them",
                   pass->name, count, STORAGE_IMAGE_LIMIT);
    }
}

/* Every device has twelve uniform blocks per stage; frame, live parameters and materials take
 * three. Buffers beyond nine are storage buffers, except ranges with `storage: uniform`. */
static void limit_uniforms(struct pass *pass)
{
    uint32_t count = 0;

    CHANGE_EACH(access, pass->accesses, pass->access_count) {
        bool wanted = !access->resource || !(access->kind & DT_READ_UNIFORM);

        for (uint32_t k = 0; k < pass->range_count && !wanted; k++)
            wanted = pass->ranges[k].access == access && pass->ranges[k].storage == STORAGE_UNIFORM;
        if (!wanted && ++count > UNIFORM_LIMIT)
            access->kind = DT_READ_STORAGE;
    }
}

static void plan_kinds(const struct pipeline *pipeline, struct pass *pass, struct diag *diag)
{
    int attachments = 0;

    pass->uniform_materials = pass->kind == DT_PASS_DRAW_SCENE && !pipeline->gpu;

    CHANGE_EACH(access, pass->accesses, pass->access_count) {
        access->binding = access->attachment = -1;
        if (!access->resource) {
            bool mesh = access->builtin == DT_SCENE_VERTICES || access->builtin == DT_SCENE_INDICES;
            access->kind =
                access->builtin == DT_SCENE_TEXTURES || (mesh && !pipeline->gpu) ? DT_READ_TEXTURE
                : access->builtin == DT_SCENE_MATERIALS && !pipeline->gpu        ? DT_READ_UNIFORM
                                                                                 : DT_READ_STORAGE;
        } else if (access->resource->kind == DT_IMAGE) {
            access->kind = image_kind(pass, access);
        } else {
            access->kind = buffer_kind(pipeline, pass, access);
        }
        if (access->kind & DT_WRITE_COLOR)
            access->attachment = attachments++;
    }
    if (attachments > COLOR_TARGET_LIMIT) {
        diag_error(diag, pass->loc, "`%s` draws to %d colour targets; a pass can have %d",
                   pass->name, attachments, COLOR_TARGET_LIMIT);
    }
    limit_storage_images(pass, diag);
    limit_uniforms(pass);
}

/* ---- Bindings -------------------------------------------------------------------------------- */

enum binding_class {
    BIND_STORAGE_IMAGE,
    BIND_STORAGE_BUFFER,
    BIND_UNIFORM,
    BIND_TEXTURE,
    BIND_NONE
};

static enum binding_class binding_class(const struct access *access)
{
    bool image = access->resource ? access->resource->kind == DT_IMAGE
                                  : access->builtin == DT_SCENE_TEXTURES;

    if (access->kind & (DT_WRITE_COLOR | DT_WRITE_DEPTH | DT_WRITE_CLEAR))
        return BIND_NONE;
    if (access->kind & DT_READ_TEXTURE)
        return BIND_TEXTURE;
    if (access->kind & DT_READ_UNIFORM)
        return BIND_UNIFORM;
    return image ? BIND_STORAGE_IMAGE : BIND_STORAGE_BUFFER;
}

static int bind_class(struct pass *pass, enum binding_class class, int next)
{
    CHANGE_EACH(access, pass->accesses, pass->access_count) {
        if (binding_class(access) != class)
            continue;
        if (pass->kind == DT_PASS_DRAW_SCENE && access->builtin == DT_SCENE_MATERIALS &&
            !access->resource)
            access->binding = pass->materials_binding;
        else if (pass->kind == DT_PASS_DRAW_SCENE && access->builtin == DT_SCENE_TEXTURES &&
                 !access->resource)
            access->binding = pass->textures_binding;
        else
            access->binding = next++;
    }
    return next;
}

/* One numbering for all kinds fits Vulkan's one set and OpenGL's separate tables. Storage images
 * and buffers come first because OpenGL has the fewest bindings for them. */
static void plan_bindings(struct pass *pass, struct diag *diag)
{
    int next = bind_class(pass, BIND_STORAGE_IMAGE, 0), first_texture = 0;

    pass->materials_binding =
        pass->kind == DT_PASS_DRAW_SCENE && !pass->uniform_materials ? next++ : -1;
    next = bind_class(pass, BIND_STORAGE_BUFFER, next);
    pass->frame_binding = next++;
    pass->live_binding = next++;
    if (pass->uniform_materials)
        pass->materials_binding = next++;
    next = bind_class(pass, BIND_UNIFORM, next);
    first_texture = next;
    pass->textures_binding = pass->kind == DT_PASS_DRAW_SCENE ? next++ : -1;
    next = bind_class(pass, BIND_TEXTURE, next);
    if (next - first_texture > TEXTURE_LIMIT) {
        diag_error(diag, pass->loc,
                   "`%s` has %d textures; a pass can have %d: images that it reads, "
                   "`scene_textures`, and texel buffers of the scene",
                   pass->name, next - first_texture, TEXTURE_LIMIT);
    }
}

/* Which sRGB textures an exact pass can read as codes: those that it fetches, itself or by filter.glsl. Of a pass that has the
 * driver filter one, which must decode first, shaders.c takes this back. */
static void plan_codes(const struct model *model, struct pass *pass)
{
    bool draws = pass->kind != DT_PASS_DISPATCH;
    pass->codes = model->codes && !pass->fast && pass->files && !pass->files->whole;
    CHANGE_EACH(access, pass->accesses, pass->access_count) {
        const struct resource *image = access->resource;
        bool ours =
            image && image->format == DT_FORMAT_RGBA8_SRGB && !image->shape && !access->layer &&
            !access_sees_one_mip(access) &&
            (!access->filter || (access->filter->anisotropy <= 1 && !(draws && image->mips)));
        access->codes = pass->codes && access->kind & DT_READ_TEXTURE &&
                        (ours || (!image && access->builtin == DT_SCENE_TEXTURES));
    }
}

/* ---- Ranges ---------------------------------------------------------------------------------- */

/* Elements of an unrolled block. */
enum { UNROLLED_BLOCK = 32 };

/* On GPUs: identifiers in the unrolled loops of a pass, and in a turn of a rolled loop. The compilers
 * of AMD's chips make up to 5.7 bytes of each; an instruction cache has 32 KB. */
enum { UNROLLED_WORDS = 5700, TURN_WORDS = 1024, MOST_OF_TURN = 4 };

/* The largest divisor of count in 8..limit, so that all blocks are full; else the limit, with a
 * short last block. */
static uint32_t chunk_of(uint64_t count, uint32_t limit)
{
    if (count <= limit)
        return count ? (uint32_t)count : 1;
    for (uint32_t chunk = limit; chunk >= 8; chunk--)
        if (count % chunk == 0)
            return chunk;
    return limit;
}

/* Checks that a uniform block can have the buffer's layout and size. */
static void check_uniform(const struct range *range, const struct resource *buffer,
                          struct diag *diag)
{
    if (!std140_equals_std430(buffer)) {
        diag_error(diag, range->loc,
                   "`%s` cannot be a uniform block: the sizes of its elements and of their arrays "
                   "must be multiples of 16 bytes; pad `%s` or choose another storage",
                   buffer->name, buffer->of);
    }
    if (buffer->bytes > UNIFORM_BLOCK_LIMIT) {
        diag_error(diag, range->loc,
                   "`%s` has %llu bytes, more than the limit of a uniform block, %d; choose "
                   "another storage",
                   buffer->name, (unsigned long long)buffer->bytes, UNIFORM_BLOCK_LIMIT);
    }
}

static uint64_t count_of(const struct range *range)
{
    return range->count_value > 0 ? (uint64_t)range->count_value : 1;
}

static uint32_t stride_of(const struct range *range)
{
    const struct resource *buffer = range->access ? range->access->resource : NULL;

    return buffer ? buffer->stride : sizeof(struct dt_material);
}

/* Chooses what the spec leaves open. CPU drivers read shared memory fast at literal indices and
 * outside of loops only, up to eight times as fast as other memory. A GPU reads shared memory as fast
 * in a loop. */
static void choose_range(struct range *range, bool unrolled, bool gpu)
{
    if (range->loop == LOOP_AUTO)
        range->loop = unrolled ? LOOP_UNROLL : LOOP_ROLL;
    bool literal = range->loop == LOOP_UNROLL && count_of(range) <= UNROLLED_LIMIT;
    if (range->storage == STORAGE_AUTO && (gpu || literal) &&
        stride_of(range) <= SHARED_MEMORY_LIMIT / 8)
        range->storage = STORAGE_SHARED;
}

/* On a GPU, a turn has up to four elements: their reads are under way together. */
static uint32_t turn_of(const struct range *range)
{
    uint32_t most = range->words ? TURN_WORDS / (uint32_t)range->words : MOST_OF_TURN;

    return most < 1 ? 1 : most > MOST_OF_TURN ? MOST_OF_TURN : most;
}

static void plan_chunk(struct range *range, bool gpu)
{
    uint32_t limit = range->loop == LOOP_ROLL ? 2 * UNROLLED_BLOCK : UNROLLED_BLOCK;
    uint32_t stride = stride_of(range);

    if (range->storage == STORAGE_SHARED) {
        limit = stride * limit > SHARED_MEMORY_LIMIT ? SHARED_MEMORY_LIMIT / stride : limit;
        limit = limit ? limit : 1;
    }
    range->chunk = chunk_of(count_of(range), limit);
    range->turn = gpu && range->loop == LOOP_ROLL ? turn_of(range) : 1;
    range->counted = range->loop == LOOP_ROLL && range->storage != STORAGE_SHARED &&
                     !expr_is_literal(range->count);
}

/* Of the copies of all ranges that are planned. */
static uint64_t shared_bytes(const struct pass *pass)
{
    uint64_t bytes = 0;

    EACH(range, pass->ranges, pass->range_count)
        if (range->storage == STORAGE_SHARED)
            bytes += (uint64_t)range->chunk * stride_of(range);
    return bytes;
}

static void check_shared(const struct pass *pass, struct diag *diag)
{
    uint64_t bytes = shared_bytes(pass);

    if (bytes > SHARED_MEMORY_LIMIT) {
        diag_error(diag, pass->ranges[0].loc,
                   "the ranges of `%s` take %llu bytes of shared memory; every device has %d: give "
                   "one of them `storage: buffer`",
                   pass->name, (unsigned long long)bytes, SHARED_MEMORY_LIMIT);
    }
}

/* On a CPU, copying the ranges costs a workgroup of 64 as much as shading its pixels. So groups of
 * 256 are the default: larger ones gain nothing, and not every device has them. */
static void plan_local(struct pass *pass, const struct pipeline *pipeline)
{
    bool flat = pass->local[1] == 1;

    if (!pipeline->gpu && pass->range_count && !pass->local_size[0] && pass->size != SIZE_GROUPS) {
        pass->local[0] = flat ? 256 : 16;
        pass->local[1] = flat ? 1 : 16;
    }
}

/* The shortest range without a chunk, the first of equals. */
static struct range *next_range(struct pass *pass)
{
    struct range *next = NULL;

    CHANGE_EACH(range, pass->ranges, pass->range_count)
        if (!range->chunk && (!next || count_of(range) < count_of(next)))
            next = range;
    return next;
}

struct unrolled {      /* of a pass, so far */
    uint64_t elements; /* of long ranges */
    uint64_t words;    /* identifiers of all loops */
};

/* Whether to unroll a range. On a GPU, while the code fits an instruction cache. On a CPU, code that
 * reads an image is long, and drivers take several times as long to compile it as arithmetic. */
static bool may_unroll(const struct range *range, const struct unrolled *others, bool gpu)
{
    uint64_t count = count_of(range);

    if (gpu)
        return count <= 2 * UNROLLED_BLOCK &&
               count * (uint64_t)range->words + others->words <= UNROLLED_WORDS;
    return count <= UNROLLED_BLOCK ||
           (!range->reads_images && count + others->elements <= UNROLLED_LIMIT);
}

static void add_unrolled(struct unrolled *unrolled, const struct range *range)
{
    if (range->loop != LOOP_UNROLL)
        return;
    unrolled->words += count_of(range) * (uint64_t)range->words;
    if (count_of(range) > UNROLLED_BLOCK)
        unrolled->elements += count_of(range);
}

/* CPU drivers run unrolled ranges several times as fast. The shortest are unrolled first. Under --sanitize, which makes each
 * operation long, ranges are rolled and read in place: this changes no result. */
static void plan_ranges(struct pass *pass, const struct pipeline *pipeline, bool sanitize,
                        struct diag *diag)
{
    struct unrolled unrolled = {0};
    struct range *range;

    plan_local(pass, pipeline);
    CHANGE_EACH(range, pass->ranges, pass->range_count)
        range->chunk = 0;
    while ((range = next_range(pass))) {
        bool open = range->storage == STORAGE_AUTO;
        if (sanitize) {
            range->storage = range->storage == STORAGE_SHARED ? STORAGE_AUTO : range->storage;
            range->loop = LOOP_ROLL;
        } else {
            choose_range(range, may_unroll(range, &unrolled, pipeline->gpu), pipeline->gpu);
        }
        plan_chunk(range, pipeline->gpu);
        if (open && shared_bytes(pass) > SHARED_MEMORY_LIMIT) { /* no room is left */
            range->storage = STORAGE_AUTO;
            plan_chunk(range, pipeline->gpu);
        }
        add_unrolled(&unrolled, range);
    }
    check_shared(pass, diag);
}

static void check_uniforms(const struct pipeline *pipeline, struct diag *diag)
{
    CHANGE_EACH(pass, pipeline->passes, pipeline->pass_count) {
        CHANGE_EACH(range, pass->ranges, pass->range_count)
            if (range->storage == STORAGE_UNIFORM && range->access && range->access->resource)
                check_uniform(range, range->access->resource, diag);
    }
}

/* ---- Touches --------------------------------------------------------------------------------- */

static unsigned stages_of(const struct pass *pass, const struct access *access)
{
    if (access->kind & DT_WRITE_COLOR)
        return DT_STAGE_COLOR;
    if (access->kind & DT_WRITE_DEPTH)
        return DT_STAGE_DEPTH;
    if (access->clears)
        return DT_STAGE_CLEAR;
    if (pass->kind == DT_PASS_DISPATCH)
        return DT_STAGE_COMPUTE;
    if (access->resource && access->resource->internal)
        return DT_STAGE_VERTEX | DT_STAGE_FRAGMENT;
    /* Draws write buffers in the fragment stage; generated vertex shaders read none. */
    return (pass->kind != DT_PASS_DRAW_FULLSCREEN || pass->own_vertices) &&
                   access->mode == MODE_READ
               ? DT_STAGE_VERTEX | DT_STAGE_FRAGMENT
               : DT_STAGE_FRAGMENT;
}

static uint32_t merge_touch(struct touch *touches, uint32_t count, struct touch touch)
{
    for (uint32_t i = 0; i < count; i++) {
        if (touches[i].resource == touch.resource && touches[i].mips == touch.mips) {
            touches[i].kind |= touch.kind;
            touches[i].stages |= touch.stages;
            touches[i].reads |= touch.reads;
            touches[i].writes |= touch.writes;
            return count;
        }
    }
    touches[count] = touch;
    return count + 1;
}

bool access_is_texels(const struct access *access)
{
    return access->kind & DT_READ_TEXTURE &&
           (access->builtin == DT_SCENE_VERTICES || access->builtin == DT_SCENE_INDICES);
}

bool access_sees_one_mip(const struct access *access)
{
    return access->resource && (access->resource->mips || access->resource->shape) &&
           access->kind & DT_READ_TEXTURE && (access->mip || access->layer || !access->sampler);
}

uint32_t mips_of(const struct resource *resource)
{
    return expr_at_reference(resource->mips, 1);
}

static uint32_t touched_mips(const struct access *access)
{
    uint32_t mips = mips_of(access->resource);
    bool one = access_sees_one_mip(access) || !(access->kind & DT_READ_TEXTURE);

    return one ? 1u << access->mip_value : mips < 32 ? (1u << mips) - 1 : UINT32_MAX;
}

uint32_t pass_touches(const struct pass *pass, struct touch *touches)
{
    uint32_t count = 0;

    if (pass->indirect_resource) {
        count = merge_touch(touches, count,
                            (struct touch){pass->indirect_resource, DT_READ_INDIRECT,
                                           DT_STAGE_INDIRECT, true, false, 1});
    }
    if (pass->index_resource) {
        count = merge_touch(
            touches, count,
            (struct touch){pass->index_resource, DT_READ_INDEX, DT_STAGE_INDEX, true, false, 1});
    }
    CHANGE_EACH(access, pass->accesses, pass->access_count) {
        struct touch touch = {access->resource,          access->kind,
                              stages_of(pass, access),   access->mode != MODE_WRITE,
                              access->mode != MODE_READ, 1};

        if (!access->resource)
            continue;
        touch.mips = touched_mips(access);
        /* A pass that is skipped at run time clears its outputs: targets as attachments, other
         * resources by clear commands. */
        if (pass->conditional && access->mode == MODE_WRITE &&
            !(access->kind & (DT_WRITE_COLOR | DT_WRITE_DEPTH))) {
            touch.kind |= DT_WRITE_CLEAR;
            touch.stages |= DT_STAGE_CLEAR;
        }
        count = merge_touch(touches, count, touch);
    }
    return count;
}

/* A uniform block has a fixed length in the shader. For a count from uniform parameters the length
 * is the limit, so that every count has the same shader. */
static void plan_blocks(struct pipeline *pipeline)
{
    CHANGE_EACH(buffer, pipeline->resources, pipeline->resource_count) {
        uint64_t bytes;

        if (!(buffer->usage & DT_READ_UNIFORM) || !buffer->count || expr_is_literal(buffer->count))
            continue;
        bytes = buffer->stride * (uint64_t)expr_at_reference(buffer->count, UINT32_MAX);
        buffer->block = bytes <= UNIFORM_BLOCK_LIMIT ? UNIFORM_BLOCK_LIMIT : SOFTWARE_UNIFORM_LIMIT;
    }
}

/* ---------------------------------------------------------------------------------------------- */

bool plan_model(struct model *model, struct diag *diag)
{
    struct pipeline *pipeline = &model->pipeline;
    unsigned errors = diag_error_count(diag);
    bool ordered = plan_order(model, diag);

    if (ordered && !sanitize_plan(model))
        return false;
    CHANGE_EACH(pass, pipeline->passes, pipeline->pass_count) {
        plan_ranges(pass, pipeline, model->sanitize, diag);
        plan_kinds(pipeline, pass, diag);
        plan_bindings(pass, diag);
        plan_codes(model, pass);
    }
    if (!ordered)
        return false;
    plan_lifetimes(model);
    plan_blocks(pipeline);
    check_uniforms(pipeline, diag);
    plan_slots(model);
    plan_barriers(model);
    return diag_error_count(diag) == errors;
}
