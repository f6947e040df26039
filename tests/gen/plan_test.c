/* The plan's rules on hand-made models: std430 and std140 offsets by the OpenGL specification, the
 * order of passes, bindings, barriers, lifetimes, and OpenGL's memory barrier bits. Run by ninja
 * test. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "model/expr.h"
#include "plan/plan.h"
#include "check/check.h"
#include "read/read.h"

/* ---- A model in a few words ------------------------------------------------------------------ */

enum { MAX_PASSES = 8, MAX_RESOURCES = 16, MAX_ACCESSES = 12 };

struct fixture {
    struct model model;
    struct diag *diag;
    struct resource resources[MAX_RESOURCES];
    struct pass passes[MAX_PASSES];
    struct access accesses[MAX_PASSES][MAX_ACCESSES];
};

static int setup(void **state)
{
    struct fixture *f = test_calloc(1, sizeof *f);

    f->model.arena = arena_create();
    f->diag = diag_create();
    f->model.pipeline.name = "test";
    f->model.pipeline.resources = f->resources;
    f->model.pipeline.passes = f->passes;
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;

    diag_free(f->diag);
    arena_free(f->model.arena);
    test_free(f);
    return 0;
}

static struct expr *number(struct fixture *f, const char *text)
{
    struct expr *expr = expr_parse(&f->model, text, (struct loc){0}, NULL, f->diag);

    assert_non_null(expr);
    assert_true(expr_resolve(expr, &f->model.pipeline, f->diag));
    return expr;
}

static struct resource *buffer(struct fixture *f, const char *name, const char *count)
{
    struct resource *r = &f->resources[f->model.pipeline.resource_count++];

    *r = (struct resource){.name = name,
                           .kind = DT_BUFFER,
                           .of = "uint",
                           .type = DT_TYPE_UINT,
                           .count = number(f, count)};
    return r;
}

static struct resource *image(struct fixture *f, const char *name, enum dt_format format)
{
    struct resource *r = &f->resources[f->model.pipeline.resource_count++];

    *r = (struct resource){.name = name,
                           .kind = DT_IMAGE,
                           .format = format,
                           .width = number(f, "frame.width"),
                           .height = number(f, "frame.height")};
    return r;
}

static struct pass *pass(struct fixture *f, const char *name, enum dt_pass_kind kind)
{
    uint32_t index = f->model.pipeline.pass_count++;
    struct pass *p = &f->passes[index];

    *p = (struct pass){
        .name = name, .kind = kind, .accesses = f->accesses[index], .local = {64, 1, 1}};
    return p;
}

static struct access *touch(struct pass *p, struct resource *r, enum access_mode mode)
{
    struct access *a = &p->accesses[p->access_count++];

    *a = (struct access){.name = r->name, .resource = r, .mode = mode};
    return a;
}

static bool plan(struct fixture *f)
{
    layout_model(&f->model);
    return plan_model(&f->model, f->diag);
}

static const struct barrier *barrier_on(const struct pass *p, const struct resource *r)
{
    for (uint32_t i = 0; i < p->barrier_count; i++)
        if (p->barriers[i].resource == r)
            return &p->barriers[i];
    return NULL;
}

/* ---- Layout ---------------------------------------------------------------------------------- */

/* OpenGL 4.6, 7.6.2.2: vec3 aligns to 16 but takes 12 bytes, arrays of vec3 stride by 16, arrays of
 * float by 4. */
static void test_std430(void **state)
{
    struct fixture *f = *state;
    struct field fields[] = {
        {.name = "a", .type = DT_TYPE_FLOAT},
        {.name = "b", .type = DT_TYPE_VEC3},
        {.name = "c", .type = DT_TYPE_UINT},
        {.name = "d", .type = DT_TYPE_VEC2},
        {.name = "e", .type = DT_TYPE_FLOAT, .array_count = 3},
        {.name = "f", .type = DT_TYPE_VEC3, .array_count = 2},
        {.name = "g", .type = DT_TYPE_MAT4},
        {.name = "h", .type = DT_TYPE_INT},
    };
    static const uint32_t offsets[] = {0, 16, 28, 32, 40, 64, 96, 160};
    struct structure s = {.name = "S", .fields = fields, .field_count = 8};

    f->model.pipeline.structs = &s;
    f->model.pipeline.struct_count = 1;
    layout_model(&f->model);
    for (int i = 0; i < 8; i++)
        assert_int_equal(fields[i].offset, offsets[i]);
    assert_int_equal(fields[4].array_stride, 4);
    assert_int_equal(fields[5].array_stride, 16);
    assert_int_equal(s.align, 16);
    assert_int_equal(s.stride, 176);
}

static void test_std140_live(void **state)
{
    struct fixture *f = *state;
    struct param params[] = {
        {.name = "a", .type = DT_TYPE_BOOL, .components = 1, .live = true},
        {.name = "baked", .type = DT_TYPE_VEC4, .components = 4},
        {.name = "b", .type = DT_TYPE_IVEC2, .components = 2, .live = true},
        {.name = "c", .type = DT_TYPE_VEC3, .components = 3, .live = true},
        {.name = "d", .type = DT_TYPE_FLOAT, .components = 1, .live = true},
        {.name = "e", .type = DT_TYPE_UINT, .components = 1, .live = true},
        {.name = "f", .type = DT_TYPE_FLOAT, .components = 1, .uniform = true},
        {.name = "g", .type = DT_TYPE_VEC2, .components = 2, .uniform = true},
    };

    layout_model(&f->model);
    assert_int_equal(f->model.pipeline.live_size, 16);
    assert_int_equal(f->model.pipeline.block_size, 16);
    f->model.pipeline.params = params;
    f->model.pipeline.param_count = 8;
    layout_model(&f->model);
    assert_int_equal(params[0].offset, 0);
    assert_int_equal(params[2].offset, 8);
    assert_int_equal(params[3].offset, 16);
    assert_int_equal(params[4].offset, 28);
    assert_int_equal(params[5].offset, 32);
    assert_int_equal(f->model.pipeline.live_size, 48);
    assert_int_equal(params[6].offset, 48);
    assert_int_equal(params[7].offset, 56);
    assert_int_equal(f->model.pipeline.block_size, 64);
}

/* ---- Order ----------------------------------------------------------------------------------- */

static void test_reader_runs_after_its_writer(void **state)
{
    struct fixture *f = *state;
    struct resource *b = buffer(f, "b", "8"), *c = buffer(f, "c", "8");
    struct pass *reader = pass(f, "reader", DT_PASS_DISPATCH),
                *writer = pass(f, "writer", DT_PASS_DISPATCH);

    touch(reader, b, MODE_READ);
    touch(reader, c, MODE_WRITE);
    touch(writer, b, MODE_WRITE);
    assert_true(plan(f));
    assert_ptr_equal(f->model.pipeline.order[0], writer);
    assert_int_equal(reader->index, 1);
}

static void test_history_is_read_before_it_is_written(void **state)
{
    struct fixture *f = *state;
    struct resource *b = buffer(f, "b", "8");
    struct pass *reader = pass(f, "reader", DT_PASS_DISPATCH),
                *writer = pass(f, "writer", DT_PASS_DISPATCH);

    b->history = true;
    touch(reader, b, MODE_READ);
    touch(writer, b, MODE_WRITE);
    assert_true(plan(f));
    assert_ptr_equal(f->model.pipeline.order[0], reader);
    /* The writer waits until the reader is done; no write has to become available. */
    assert_int_equal(barrier_on(writer, b)->from_stages, DT_STAGE_COMPUTE);
    assert_false(barrier_on(writer, b)->from_writes);
}

static void test_readers_between_modifiers(void **state)
{
    struct fixture *f = *state;
    struct resource *b = buffer(f, "b", "8");
    struct pass *write = pass(f, "write", DT_PASS_DISPATCH),
                *first = pass(f, "first", DT_PASS_DISPATCH);
    struct pass *update = pass(f, "update", DT_PASS_DISPATCH),
                *second = pass(f, "second", DT_PASS_DISPATCH);

    touch(write, b, MODE_WRITE);
    touch(first, b, MODE_READ);
    touch(update, b, MODE_UPDATE);
    touch(second, b, MODE_READ);
    assert_true(plan(f));
    assert_int_equal(write->index, 0);
    assert_int_equal(first->index, 1);
    assert_int_equal(update->index, 2);
    assert_int_equal(second->index, 3);
    assert_true(barrier_on(first, b)->from_writes);
    assert_false(barrier_on(update, b)->from_writes);
    assert_true(barrier_on(second, b)->from_writes);
}

static void test_cycle_is_an_error(void **state)
{
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "8"), *b = buffer(f, "b", "8");
    struct pass *p = pass(f, "p", DT_PASS_DISPATCH), *q = pass(f, "q", DT_PASS_DISPATCH);

    touch(p, a, MODE_READ);
    touch(p, b, MODE_WRITE);
    touch(q, b, MODE_READ);
    touch(q, a, MODE_WRITE);
    assert_false(plan(f));
    assert_int_equal(diag_error_count(f->diag), 1);
}

static void test_two_writers_need_an_order(void **state)
{
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "8");
    struct pass *p = pass(f, "p", DT_PASS_DISPATCH), *q = pass(f, "q", DT_PASS_DISPATCH);
    const char *after[] = {"q"};

    touch(p, a, MODE_WRITE);
    touch(q, a, MODE_WRITE);
    assert_false(plan(f));
    assert_int_equal(diag_error_count(f->diag), 1);
    p->after = after;
    p->after_count = 1;
    assert_true(plan(f));
    assert_int_equal(q->index, 0);
}

static void test_read_before_write(void **state)
{
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "8"), *b = buffer(f, "b", "8");
    struct pass *p = pass(f, "p", DT_PASS_DISPATCH);

    touch(p, a, MODE_READ);
    touch(p, b, MODE_UPDATE);
    assert_false(plan(f));
    assert_int_equal(diag_error_count(f->diag), 2);
}

/* ---- Kinds, bindings, ranges ----------------------------------------------------------------- */

static void test_kinds_and_bindings(void **state)
{
    struct fixture *f = *state;
    struct resource *color = image(f, "color", DT_FORMAT_RGBA16F),
                    *depth = image(f, "depth", DT_FORMAT_D32F);
    struct resource *out = image(f, "out", DT_FORMAT_RGBA16F), *list = buffer(f, "list", "8");
    struct pass *draw = pass(f, "draw", DT_PASS_DRAW_SCENE),
                *shade = pass(f, "shade", DT_PASS_DISPATCH);
    struct access *c, *d, *o, *l;

    touch(draw, color, MODE_WRITE);
    touch(draw, depth, MODE_WRITE);
    touch(draw, list, MODE_WRITE);
    d = touch(shade, depth, MODE_READ);
    l = touch(shade, list, MODE_READ);
    c = touch(shade, color, MODE_READ);
    o = touch(shade, out, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(d->kind, DT_READ_TEXTURE); /* depth has no imageLoad */
    assert_int_equal(c->kind, DT_READ_STORAGE);
    assert_int_equal(c->binding, 0);
    assert_int_equal(o->binding, 1);
    assert_int_equal(l->binding, 2);
    assert_int_equal(shade->frame_binding, 3);
    assert_int_equal(shade->live_binding, 4);
    assert_int_equal(d->binding, 5);
    assert_int_equal(shade->textures_binding, -1);
    assert_int_equal(draw->accesses[0].attachment, 0);
    assert_int_equal(draw->accesses[0].binding, -1);
    assert_int_equal(draw->accesses[2].binding, 0);
    assert_int_equal(draw->materials_binding, 3);
    assert_int_equal(draw->textures_binding, 4);
}

/* 4096 vec4 fill the 64 KiB of a uniform block on software drivers; std140 would pad a uint
 * array. */
static void test_draws_read_small_buffers_as_uniform_blocks(void **state)
{
    struct fixture *f = *state;
    struct resource *fits = buffer(f, "fits", "4096"), *large = buffer(f, "large", "4097"),
                    *uints = buffer(f, "uints", "8"), *out = image(f, "out", DT_FORMAT_RGBA16F);
    struct pass *fill = pass(f, "fill", DT_PASS_DISPATCH),
                *draw = pass(f, "draw", DT_PASS_DRAW_SCENE);

    fits->type = large->type = DT_TYPE_VEC4;
    touch(fill, fits, MODE_WRITE);
    touch(fill, large, MODE_WRITE);
    touch(fill, uints, MODE_WRITE);
    touch(draw, fits, MODE_READ);
    touch(draw, large, MODE_READ);
    touch(draw, uints, MODE_READ);
    touch(draw, out, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(draw->accesses[0].kind, DT_READ_UNIFORM);
    assert_int_equal(draw->accesses[1].kind, DT_READ_STORAGE);
    assert_int_equal(draw->accesses[2].kind, DT_READ_STORAGE);
    assert_true(draw->uniform_materials);
    f->model.pipeline.gpu = true;
    assert_true(plan(f));
    assert_int_equal(draw->accesses[0].kind, DT_READ_STORAGE);
    assert_false(draw->uniform_materials);
    assert_int_equal(draw->materials_binding, 0);
}

static uint32_t uniform_blocks(const struct pass *p)
{
    uint32_t blocks = 0;

    for (uint32_t i = 0; i < p->access_count; i++)
        blocks += p->accesses[i].kind == DT_READ_UNIFORM;
    return blocks;
}

/* Every device has twelve uniform blocks: nine for buffers, and one each for materials, frame and
 * live parameters. Ranges that the plan reads in place are among the nine. */
static void test_uniform_blocks_are_few(void **state)
{
    static const char *const names[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k"};
    enum { COUNT = sizeof names / sizeof *names };
    struct fixture *f = *state;
    struct pass *fill = pass(f, "fill", DT_PASS_DISPATCH), *p = pass(f, "p", DT_PASS_DISPATCH);
    struct range ranges[COUNT] = {{0}};

    for (size_t i = 0; i < COUNT; i++) {
        struct resource *r = buffer(f, names[i], "64");

        r->type = DT_TYPE_VEC4;
        touch(fill, r, MODE_WRITE);
        ranges[i] =
            (struct range){.name = "r", .count_value = 300, .access = touch(p, r, MODE_READ)};
    }
    assert_true(plan(f));
    assert_int_equal(uniform_blocks(p), 9);
    p->ranges = ranges;
    p->range_count = COUNT;
    assert_true(plan(f));
    assert_int_equal(uniform_blocks(p), 9);
    assert_int_equal(ranges[0].loop, LOOP_ROLL);
}

/* On a CPU a workgroup that copies ranges is large, unless the spec sets its size. */
static void test_ranges_make_workgroups_large(void **state)
{
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "512");
    struct pass *w = pass(f, "w", DT_PASS_DISPATCH), *p = pass(f, "p", DT_PASS_DISPATCH);
    struct range range = {.name = "r", .count_value = 16};

    a->type = DT_TYPE_VEC4;
    touch(w, a, MODE_WRITE);
    range.access = touch(p, a, MODE_READ);
    p->ranges = &range;
    p->range_count = 1;
    p->local[0] = p->local[1] = 8;
    p->local_size[0] = number(f, "8");
    assert_true(plan(f));
    assert_int_equal(p->local[0], 8);
    p->local_size[0] = NULL;
    assert_true(plan(f));
    assert_int_equal(p->local[0] * p->local[1], 256);
    assert_int_equal(range.access->kind, DT_READ_UNIFORM);
    range.storage = STORAGE_BUFFER;
    assert_true(plan(f));
    assert_int_equal(range.access->kind, DT_READ_STORAGE);
}

static void test_short_range_is_copied_and_unrolled(void **state)
{
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "512");
    struct pass *w = pass(f, "w", DT_PASS_DISPATCH), *p = pass(f, "p", DT_PASS_DISPATCH);
    struct range range = {.name = "r", .count_value = 32};

    touch(w, a, MODE_WRITE);
    range.access = touch(p, a, MODE_READ);
    p->ranges = &range;
    p->range_count = 1;
    assert_true(plan(f));
    assert_int_equal(range.storage, STORAGE_SHARED);
    assert_int_equal(range.loop, LOOP_UNROLL);
    assert_int_equal(range.chunk, 32);
}

/* 512 elements: a loop that reads in place, from a uniform block if one can hold the buffer. */
static void test_long_range_is_rolled_in_place(void **state)
{
    static const struct {
        enum dt_type type;
        const char *count;
        unsigned kind;
    } cases[] = {
        {DT_TYPE_VEC4, "512", DT_READ_UNIFORM},
        {DT_TYPE_VEC4, "5000", DT_READ_STORAGE}, /* 80,000 bytes */
        {DT_TYPE_UINT, "512", DT_READ_STORAGE},  /* std140 would pad each element */
    };
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "512");
    struct pass *w = pass(f, "w", DT_PASS_DISPATCH), *p = pass(f, "p", DT_PASS_DISPATCH);
    struct range range;

    touch(w, a, MODE_WRITE);
    range.access = touch(p, a, MODE_READ);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        range = (struct range){
            .name = "r", .count = number(f, "512"), .count_value = 512, .access = range.access};
        a->type = cases[i].type;
        a->count = number(f, cases[i].count);
        p->ranges = &range;
        p->range_count = 1;
        assert_true(plan(f));
        assert_int_equal(range.loop, LOOP_ROLL);
        assert_int_not_equal(range.storage, STORAGE_SHARED);
        assert_int_equal(range.access->kind, cases[i].kind);
    }
}

/* Among long ranges, the plan unrolls the shortest, up to 256 elements together, and none that
 * reads images. */
static void test_shortest_ranges_are_unrolled(void **state)
{
    static const struct {
        int64_t count;
        bool reads_images;
        enum loop_shape loop;
    } cases[] = {{200, false, LOOP_ROLL},
                 {33, true, LOOP_ROLL},
                 {32, true, LOOP_UNROLL},
                 {100, false, LOOP_UNROLL},
                 {156, false, LOOP_UNROLL}};
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "512");
    struct pass *w = pass(f, "w", DT_PASS_DISPATCH), *p = pass(f, "p", DT_PASS_DISPATCH);
    struct range ranges[sizeof cases / sizeof *cases];
    struct access *access;

    touch(w, a, MODE_WRITE);
    access = touch(p, a, MODE_READ);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ranges[i] = (struct range){.name = "r",
                                   .count_value = cases[i].count,
                                   .access = access,
                                   .reads_images = cases[i].reads_images};
    }
    p->ranges = ranges;
    p->range_count = sizeof cases / sizeof *cases;
    assert_true(plan(f));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(ranges[i].loop, cases[i].loop);
        assert_int_equal(ranges[i].storage == STORAGE_SHARED, cases[i].loop == LOOP_UNROLL);
    }
}

static void test_a_range_follows_the_spec(void **state)
{
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "512");
    struct pass *w = pass(f, "w", DT_PASS_DISPATCH), *p = pass(f, "p", DT_PASS_DISPATCH);
    struct range range = {
        .name = "r", .count_value = 75, .storage = STORAGE_SHARED, .loop = LOOP_UNROLL};

    touch(w, a, MODE_WRITE);
    range.access = touch(p, a, MODE_READ);
    p->ranges = &range;
    p->range_count = 1;
    assert_true(plan(f));
    assert_int_equal(range.chunk, 25); /* 25 * 3 */
    range.count_value = 37;            /* prime: a short last block */
    assert_true(plan(f));
    assert_int_equal(range.chunk, 32);
    range.loop = LOOP_AUTO; /* copied as in the spec, but not unrolled */
    range.count_value = 512;
    assert_true(plan(f));
    assert_int_equal(range.storage, STORAGE_SHARED);
    assert_int_equal(range.loop, LOOP_ROLL);
    range.storage = STORAGE_AUTO; /* unrolled as in the spec, but not copied */
    range.loop = LOOP_UNROLL;
    assert_true(plan(f));
    assert_int_equal(range.storage, STORAGE_AUTO);
    assert_int_equal(range.loop, LOOP_UNROLL);
    f->model.pipeline.gpu = true;
    range.loop = LOOP_AUTO;
    assert_true(plan(f));
    assert_int_equal(range.storage, STORAGE_SHARED);
    assert_int_equal(range.loop, LOOP_ROLL);
}

/* On a GPU, what a pass unrolls fits an instruction cache. What does not is a loop, with several
 * elements per turn while they are short. */
static void test_unrolled_code_fits_the_cache_of_a_gpu(void **state)
{
    static const struct {
        int64_t count;
        int32_t words;
        enum loop_shape loop;
        uint32_t turn;
    } cases[] = {{8, 610, LOOP_UNROLL, 1}, /* 4880 */
                 {16, 70, LOOP_ROLL, 4},   /* 1120 more */
                 {17, 30, LOOP_UNROLL, 1}, /* 510 more */
                 {32, 251, LOOP_ROLL, 4},  {64, 400, LOOP_ROLL, 2},
                 {65, 1, LOOP_ROLL, 4}}; /* many turns */
    struct fixture *f = *state;
    struct resource *a = buffer(f, "a", "512");
    struct pass *w = pass(f, "w", DT_PASS_DISPATCH), *p = pass(f, "p", DT_PASS_DISPATCH);
    struct range ranges[sizeof cases / sizeof *cases];
    struct access *access;

    touch(w, a, MODE_WRITE);
    access = touch(p, a, MODE_READ);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ranges[i] = (struct range){
            .name = "r", .count_value = cases[i].count, .access = access, .words = cases[i].words};
    }
    p->ranges = ranges;
    p->range_count = sizeof cases / sizeof *cases;
    f->model.pipeline.gpu = true;
    assert_true(plan(f));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(ranges[i].loop, cases[i].loop);
        assert_int_equal(ranges[i].turn, cases[i].turn);
    }
}

/* ---- Barriers -------------------------------------------------------------------------------- */

static void test_draw_then_load_then_load(void **state)
{
    struct fixture *f = *state;
    struct resource *color = image(f, "color", DT_FORMAT_RGBA16F);
    struct resource *x = buffer(f, "x", "8"), *y = buffer(f, "y", "8");
    struct pass *draw = pass(f, "draw", DT_PASS_DRAW_FULLSCREEN),
                *first = pass(f, "first", DT_PASS_DISPATCH);
    struct pass *second = pass(f, "second", DT_PASS_DISPATCH);

    touch(draw, color, MODE_WRITE);
    touch(first, color, MODE_READ);
    touch(first, x, MODE_WRITE);
    touch(second, color, MODE_READ);
    touch(second, x, MODE_READ);
    touch(second, y, MODE_WRITE);
    assert_true(plan(f));
    assert_true(barrier_on(draw, color)->discard);
    assert_int_equal(barrier_on(draw, color)->from_stages, 0);
    assert_int_equal(layout_of(barrier_on(draw, color)->to), DT_LAYOUT_COLOR);
    assert_int_equal(barrier_on(first, color)->from, DT_WRITE_COLOR);
    assert_int_equal(barrier_on(first, color)->from_stages, DT_STAGE_COLOR);
    assert_true(barrier_on(first, color)->from_writes);
    assert_int_equal(layout_of(barrier_on(first, color)->to), DT_LAYOUT_GENERAL);
    assert_null(barrier_on(second, color)); /* same layout, already visible to compute */
    assert_int_equal(barrier_on(second, x)->from, DT_WRITE_STORAGE);
}

static void test_conditional_dispatch_may_clear(void **state)
{
    struct fixture *f = *state;
    struct resource *out = image(f, "out", DT_FORMAT_RGBA16F), *b = buffer(f, "b", "8");
    struct resource *c = buffer(f, "c", "8");
    struct pass *p = pass(f, "p", DT_PASS_DISPATCH), *q = pass(f, "q", DT_PASS_DISPATCH);

    p->conditional = true;
    touch(p, out, MODE_WRITE);
    touch(p, b, MODE_WRITE);
    touch(q, out, MODE_READ);
    touch(q, b, MODE_READ);
    touch(q, c, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(barrier_on(p, out)->to, DT_WRITE_STORAGE | DT_WRITE_CLEAR);
    assert_int_equal(barrier_on(p, out)->to_stages, DT_STAGE_COMPUTE | DT_STAGE_CLEAR);
    assert_int_equal(layout_of(barrier_on(p, out)->to), DT_LAYOUT_GENERAL);
    assert_int_equal(barrier_on(q, b)->from, DT_WRITE_STORAGE | DT_WRITE_CLEAR);
    assert_int_equal(barrier_on(q, b)->from_stages, DT_STAGE_COMPUTE | DT_STAGE_CLEAR);
}

/* imageLoad in compute, then texelFetch in a draw: the layout changes, and waits for the readers
 * only. */
static void test_layout_changes_between_readers(void **state)
{
    struct fixture *f = *state;
    struct resource *a = image(f, "a", DT_FORMAT_RGBA16F), *out = image(f, "out", DT_FORMAT_RGBA8);
    struct resource *b = buffer(f, "b", "8");
    struct pass *w = pass(f, "w", DT_PASS_DISPATCH), *load = pass(f, "load", DT_PASS_DISPATCH);
    struct pass *draw = pass(f, "draw", DT_PASS_DRAW_FULLSCREEN);

    touch(w, a, MODE_WRITE);
    touch(load, a, MODE_READ);
    touch(load, b, MODE_WRITE);
    touch(draw, a, MODE_READ);
    touch(draw, b, MODE_READ);
    touch(draw, out, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(barrier_on(draw, a)->from, DT_READ_STORAGE);
    assert_false(barrier_on(draw, a)->from_writes);
    assert_int_equal(layout_of(barrier_on(draw, a)->to), DT_LAYOUT_READ);
    assert_int_equal(barrier_on(draw, a)->to_stages, DT_STAGE_FRAGMENT);
}

static void test_indirect(void **state)
{
    struct fixture *f = *state;
    struct resource *args = buffer(f, "args", "3"), *out = buffer(f, "out", "8");
    struct pass *w = pass(f, "w", DT_PASS_DISPATCH), *p = pass(f, "p", DT_PASS_DISPATCH);

    touch(w, args, MODE_WRITE);
    touch(p, out, MODE_WRITE);
    p->size = SIZE_INDIRECT;
    p->indirect_resource = args;
    assert_true(plan(f));
    assert_int_equal(barrier_on(p, args)->to, DT_READ_INDIRECT);
    assert_int_equal(barrier_on(p, args)->to_stages, DT_STAGE_INDIRECT);
}

/* Synchronization validation does not report a store that follows a store without a barrier: this
 * test does. */
static void test_store_after_store(void **state)
{
    struct fixture *f = *state;
    struct resource *b = buffer(f, "b", "8"), *a = image(f, "a", DT_FORMAT_RGBA16F);
    struct pass *first = pass(f, "first", DT_PASS_DISPATCH),
                *second = pass(f, "second", DT_PASS_DISPATCH);
    const char *after[] = {"first"};

    touch(first, b, MODE_WRITE);
    touch(first, a, MODE_WRITE);
    touch(second, b, MODE_WRITE);
    touch(second, a, MODE_UPDATE);
    second->after = after;
    second->after_count = 1;
    assert_true(plan(f));
    assert_true(barrier_on(second, b)->from_writes);
    assert_int_equal(barrier_on(second, b)->from, DT_WRITE_STORAGE);
    assert_true(barrier_on(second, a)->from_writes);
    assert_int_equal(barrier_on(second, a)->to, DT_READ_STORAGE | DT_WRITE_STORAGE);
}

/* A depth target that is read and then drawn over: written late, read as a texture, written again
 * after the reader. */
static void test_depth_is_read_between_draws(void **state)
{
    struct fixture *f = *state;
    struct resource *depth = image(f, "depth", DT_FORMAT_D32F), *b = buffer(f, "b", "8");
    struct pass *draw = pass(f, "draw", DT_PASS_DRAW_SCENE),
                *look = pass(f, "look", DT_PASS_DISPATCH);
    struct pass *more = pass(f, "more", DT_PASS_DRAW_SCENE);

    touch(draw, depth, MODE_WRITE);
    touch(look, depth, MODE_READ);
    touch(look, b, MODE_WRITE);
    touch(more, depth, MODE_UPDATE);
    assert_true(plan(f));
    assert_int_equal(barrier_on(look, depth)->from, DT_WRITE_DEPTH);
    assert_int_equal(barrier_on(look, depth)->from_stages, DT_STAGE_DEPTH);
    assert_true(barrier_on(look, depth)->from_writes);
    assert_int_equal(layout_of(barrier_on(look, depth)->to), DT_LAYOUT_READ);
    assert_int_equal(barrier_on(more, depth)->from, DT_READ_TEXTURE);
    assert_int_equal(barrier_on(more, depth)->from_stages, DT_STAGE_COMPUTE);
    assert_false(barrier_on(more, depth)->from_writes);
    assert_false(barrier_on(more, depth)->discard);
    assert_int_equal(layout_of(barrier_on(more, depth)->to), DT_LAYOUT_DEPTH);
}

/* The first reader's barrier changed the layout; a reader in another stage is ordered after that
 * change, through it. */
static void test_second_reader_waits_for_the_layout(void **state)
{
    struct fixture *f = *state;
    struct resource *depth = image(f, "depth", DT_FORMAT_D32F), *b = buffer(f, "b", "8");
    struct resource *color = image(f, "color", DT_FORMAT_RGBA8);
    struct pass *draw = pass(f, "draw", DT_PASS_DRAW_SCENE),
                *look = pass(f, "look", DT_PASS_DISPATCH);
    struct pass *show = pass(f, "show", DT_PASS_DRAW_FULLSCREEN);

    touch(draw, depth, MODE_WRITE);
    touch(look, depth, MODE_READ);
    touch(look, b, MODE_WRITE);
    touch(show, depth, MODE_READ);
    touch(show, b, MODE_READ);
    touch(show, color, MODE_WRITE);
    assert_true(plan(f));
    assert_non_null(barrier_on(show, depth));
    assert_int_equal(barrier_on(show, depth)->from_stages, DT_STAGE_COMPUTE);
    assert_int_equal(barrier_on(show, depth)->to_stages, DT_STAGE_FRAGMENT);
    assert_int_equal(layout_of(barrier_on(show, depth)->to), DT_LAYOUT_READ);
}

/* Samplers and texelFetch read in the same way: what one sees, the other sees. */
static void test_texels_after_samples_wait_for_nothing(void **state)
{
    struct fixture *f = *state;
    struct resource *depth = image(f, "depth", DT_FORMAT_D32F), *b = buffer(f, "b", "8");
    struct resource *c = buffer(f, "c", "8");
    struct pass *draw = pass(f, "draw", DT_PASS_DRAW_SCENE);
    struct pass *look = pass(f, "look", DT_PASS_DISPATCH),
                *more = pass(f, "more", DT_PASS_DISPATCH);

    touch(draw, depth, MODE_WRITE);
    touch(look, depth, MODE_READ)->sampler = "soft";
    touch(look, b, MODE_WRITE);
    touch(more, depth, MODE_READ);
    touch(more, c, MODE_WRITE);
    assert_true(plan(f));
    assert_non_null(barrier_on(look, depth));
    assert_null(barrier_on(more, depth));
}

/* Drawing into one mip keeps the stores in another. */
static void test_stores_in_another_mip_stay_stored(void **state)
{
    struct fixture *f = *state;
    struct resource *a = image(f, "a", DT_FORMAT_RGBA16F), *b = buffer(f, "b", "8");
    struct pass *store = pass(f, "store", DT_PASS_DISPATCH),
                *draw = pass(f, "draw", DT_PASS_DRAW_FULLSCREEN);
    struct pass *look = pass(f, "look", DT_PASS_DISPATCH);

    a->mips = number(f, "2");
    touch(store, a, MODE_WRITE);
    touch(draw, a, MODE_WRITE)->mip_value = 1;
    touch(look, a, MODE_READ);
    touch(look, b, MODE_WRITE);
    assert_true(plan(f));
}

/* A write to one mip waits for no other mip; a read of all mips waits for each. */
static void test_mips_wait_for_themselves(void **state)
{
    struct fixture *f = *state;
    struct resource *a = image(f, "a", DT_FORMAT_RGBA16F), *b = buffer(f, "b", "8");
    struct pass *first = pass(f, "first", DT_PASS_DISPATCH),
                *second = pass(f, "second", DT_PASS_DISPATCH);
    struct pass *again = pass(f, "again", DT_PASS_DISPATCH);
    const char *after_first[] = {"first"}, *after_second[] = {"second"};

    a->mips = number(f, "2");
    touch(first, a, MODE_WRITE);
    touch(second, a, MODE_WRITE)->mip_value = 1;
    second->after = after_first;
    second->after_count = 1;
    touch(again, a, MODE_UPDATE);
    touch(again, b, MODE_WRITE);
    again->after = after_second;
    again->after_count = 1;
    assert_true(plan(f));
    assert_true(barrier_on(first, a)->discard);
    assert_null(barrier_on(second, a));
    assert_int_equal(barrier_on(again, a)->from, DT_WRITE_STORAGE);
}

/* If a reader may be skipped, the write before it may stay unread. The next user of the memory then
 * waits for the write, too. */
static void test_skipped_readers_leave_the_write(void **state)
{
    struct fixture *f = *state;
    struct resource *a = image(f, "a", DT_FORMAT_RGBA16F), *b = buffer(f, "b", "8");
    struct resource *next = image(f, "next", DT_FORMAT_RGBA16F);
    struct pass *store = pass(f, "store", DT_PASS_DISPATCH),
                *look = pass(f, "look", DT_PASS_DISPATCH);
    struct pass *last = pass(f, "last", DT_PASS_DISPATCH);

    touch(store, a, MODE_WRITE);
    touch(look, a, MODE_READ);
    touch(look, b, MODE_WRITE);
    touch(last, b, MODE_READ);
    touch(last, next, MODE_WRITE);
    assert_true(plan(f));
    assert_ptr_equal(barrier_on(last, next)->alias, a);
    assert_false(barrier_on(last, next)->from_writes);
    look->conditional = true;
    assert_true(plan(f));
    assert_true(barrier_on(last, next)->from_writes);
    assert_true(barrier_on(last, next)->from & DT_WRITE_STORAGE);
}

/* History crosses frames: the first pass reads the last frame's stores without a barrier of its
 * own. */
static void test_history_crosses_frames(void **state)
{
    struct fixture *f = *state;
    struct resource *h = image(f, "h", DT_FORMAT_RGBA16F), *b = buffer(f, "b", "8");
    struct pass *look = pass(f, "look", DT_PASS_DISPATCH),
                *store = pass(f, "store", DT_PASS_DISPATCH);

    h->history = true;
    touch(look, h, MODE_READ);
    touch(look, b, MODE_WRITE);
    touch(store, h, MODE_WRITE);
    touch(store, b, MODE_READ);
    assert_true(plan(f));
    assert_null(barrier_on(look, h)); /* the frame opens with a full barrier */
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* A chain of full-size images needs two places: neighbours overlap, others do not. */
static void test_chain_takes_two_slots(void **state)
{
    struct fixture *f = *state;
    static const char *const names[] = {"i0", "i1", "i2", "i3", "i4"}, *const passes[] = {
                                                                           "p0", "p1", "p2", "p3",
                                                                           "p4"};
    struct resource *last = NULL;

    for (int i = 0; i < 5; i++) {
        struct pass *p = pass(f, passes[i], DT_PASS_DISPATCH);
        struct resource *next = image(f, names[i], DT_FORMAT_RGBA16F);

        touch(p, next, MODE_WRITE);
        if (last)
            touch(p, last, MODE_READ);
        last = next;
    }
    assert_true(plan(f));
    assert_int_equal(f->model.pipeline.slot_count, 2);
    assert_int_equal(f->model.pipeline.transient_bytes, 5ull * 1920 * 1080 * 8);
    assert_int_equal(f->model.pipeline.aliased_bytes, 2ull * 1920 * 1080 * 8);
    for (int i = 0; i < 5; i++) {
        for (int j = 0; j < i; j++) {
            const struct resource *a = &f->resources[i], *b = &f->resources[j];
            bool share_slot = a->slot == b->slot;
            bool share_texture = a->share == j || (a->share >= 0 && a->share == b->share);

            assert_false((share_slot || share_texture) && a->first_pass <= b->last_pass &&
                         b->first_pass <= a->last_pass);
        }
    }
    assert_int_equal(f->resources[2].share, 0);
    assert_ptr_equal(barrier_on(&f->passes[2], &f->resources[2])->alias, &f->resources[0]);
    assert_int_equal(barrier_on(&f->passes[2], &f->resources[2])->from_stages, DT_STAGE_COMPUTE);
}

/* Three users of one place; the second is small. No pass reads the first one's write beyond the
 * second. This write is made available for the third. */
static void test_third_user_waits_for_unread_writes(void **state)
{
    struct fixture *f = *state;
    struct resource *big = image(f, "big", DT_FORMAT_RGBA32F),
                    *small = image(f, "small", DT_FORMAT_R32F);
    struct resource *next = image(f, "next", DT_FORMAT_RGBA16F), *b = buffer(f, "b", "8");
    struct pass *draw = pass(f, "draw", DT_PASS_DRAW_FULLSCREEN),
                *store = pass(f, "store", DT_PASS_DISPATCH);
    struct pass *look = pass(f, "look", DT_PASS_DISPATCH),
                *last = pass(f, "last", DT_PASS_DISPATCH);

    touch(draw, big, MODE_WRITE);
    touch(store, small, MODE_WRITE);
    touch(look, small, MODE_READ);
    touch(look, b, MODE_WRITE);
    touch(last, next, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(small->slot, big->slot);
    assert_int_equal(next->slot, big->slot);
    assert_ptr_equal(barrier_on(last, next)->alias, small);
    assert_int_equal(barrier_on(last, next)->from, DT_READ_STORAGE | DT_WRITE_COLOR);
    assert_int_equal(barrier_on(last, next)->from_stages, DT_STAGE_COMPUTE | DT_STAGE_COLOR);
    assert_true(barrier_on(last, next)->from_writes);
}

/* Buffer, target, buffer in one place. Synchronization validation does not see that a wait for the
 * target includes the readers of the first buffer. It does see that where another buffer took the
 * whole place in between. */
static void test_buffer_waits_for_the_buffer_before_a_target(void **state)
{
    struct fixture *f = *state;
    struct resource *early = buffer(f, "early", "4096"), *late = buffer(f, "late", "4096");
    struct resource *target = image(f, "target", DT_FORMAT_D32F), *sum = buffer(f, "sum", "8");
    struct pass *fill = pass(f, "fill", DT_PASS_DISPATCH),
                *look = pass(f, "look", DT_PASS_DISPATCH);
    struct pass *draw = pass(f, "draw", DT_PASS_DRAW_FULLSCREEN),
                *again = pass(f, "again", DT_PASS_DISPATCH);

    target->width = target->height = number(f, "16");
    touch(fill, early, MODE_WRITE);
    touch(look, early, MODE_READ);
    touch(look, sum, MODE_WRITE);
    touch(draw, target, MODE_WRITE);
    touch(again, sum, MODE_READ);
    touch(again, late, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(early->slot, late->slot);
    assert_int_equal(target->slot, late->slot);
    assert_ptr_equal(barrier_on(again, late)->alias, target);
    assert_int_equal(barrier_on(again, late)->from_stages, DT_STAGE_COMPUTE | DT_STAGE_DEPTH);
    assert_int_equal(barrier_on(again, late)->from & ~DT_READ_STORAGE, DT_WRITE_DEPTH);
}

static void test_buffer_waits_for_what_a_smaller_one_left(void **state)
{
    struct fixture *f = *state;
    struct resource *early = buffer(f, "early", "4096"), *late = buffer(f, "late", "4096");
    struct resource *between = buffer(f, "between", "2048"), *sum = buffer(f, "sum", "8");
    struct pass *fill = pass(f, "fill", DT_PASS_DISPATCH),
                *look = pass(f, "look", DT_PASS_DRAW_FULLSCREEN);
    struct pass *store = pass(f, "store", DT_PASS_DISPATCH),
                *again = pass(f, "again", DT_PASS_DISPATCH);

    touch(fill, early, MODE_WRITE);
    touch(look, early, MODE_READ);
    touch(look, image(f, "seen", DT_FORMAT_RGBA16F), MODE_WRITE);
    touch(store, between, MODE_WRITE);
    touch(store, sum, MODE_WRITE);
    touch(again, sum, MODE_READ);
    touch(again, late, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(early->slot, late->slot);
    assert_int_equal(between->slot, late->slot);
    assert_ptr_equal(barrier_on(again, late)->alias, between);
    assert_int_equal(barrier_on(again, late)->from_stages,
                     barrier_on(store, between)->from_stages | DT_STAGE_COMPUTE);
    between->count = number(f, "4096");
    assert_true(plan(f));
    assert_int_equal(between->slot, late->slot);
    assert_int_equal(barrier_on(again, late)->from_stages, DT_STAGE_COMPUTE);
}

static void test_history_and_output_keep_their_memory(void **state)
{
    struct fixture *f = *state;
    struct resource *h = image(f, "h", DT_FORMAT_RGBA16F),
                    *out = image(f, "out", DT_FORMAT_RGBA16F);
    struct resource *later = image(f, "later", DT_FORMAT_RGBA16F);
    struct pass *p = pass(f, "p", DT_PASS_DISPATCH), *q = pass(f, "q", DT_PASS_DISPATCH);

    h->history = true;
    f->model.pipeline.linear_output = "out";
    touch(p, out, MODE_WRITE);
    touch(p, h, MODE_UPDATE);
    touch(q, later, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(f->model.pipeline.slot_count, 3);
    assert_int_equal(later->share, -1);
    assert_null(barrier_on(p, h));
}

/* Without `keep` the third of a chain takes the first's memory. */
static void test_kept_resources_share_no_memory(void **state)
{
    struct fixture *f = *state;
    struct resource *a = image(f, "a", DT_FORMAT_RGBA16F), *b = image(f, "b", DT_FORMAT_RGBA16F);
    struct resource *c = image(f, "c", DT_FORMAT_RGBA16F);
    struct pass *p = pass(f, "p", DT_PASS_DISPATCH), *q = pass(f, "q", DT_PASS_DISPATCH);
    struct pass *r = pass(f, "r", DT_PASS_DISPATCH);

    touch(p, a, MODE_WRITE);
    touch(q, a, MODE_READ);
    touch(q, b, MODE_WRITE);
    touch(r, b, MODE_READ);
    touch(r, c, MODE_WRITE);
    assert_true(plan(f));
    assert_int_equal(a->slot, c->slot);
    assert_int_equal(c->share, a->index);
    a->keep = true;
    assert_true(plan(f));
    assert_int_not_equal(a->slot, c->slot);
    assert_int_equal(c->share, -1);
    assert_int_equal(f->model.pipeline.slot_count, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_std430, setup, teardown),
        cmocka_unit_test_setup_teardown(test_std140_live, setup, teardown),
        cmocka_unit_test_setup_teardown(test_reader_runs_after_its_writer, setup, teardown),
        cmocka_unit_test_setup_teardown(test_history_is_read_before_it_is_written, setup, teardown),
        cmocka_unit_test_setup_teardown(test_readers_between_modifiers, setup, teardown),
        cmocka_unit_test_setup_teardown(test_cycle_is_an_error, setup, teardown),
        cmocka_unit_test_setup_teardown(test_two_writers_need_an_order, setup, teardown),
        cmocka_unit_test_setup_teardown(test_read_before_write, setup, teardown),
        cmocka_unit_test_setup_teardown(test_kinds_and_bindings, setup, teardown),
        cmocka_unit_test_setup_teardown(test_uniform_blocks_are_few, setup, teardown),
        cmocka_unit_test_setup_teardown(test_ranges_make_workgroups_large, setup, teardown),
        cmocka_unit_test_setup_teardown(test_draws_read_small_buffers_as_uniform_blocks, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_short_range_is_copied_and_unrolled, setup, teardown),
        cmocka_unit_test_setup_teardown(test_shortest_ranges_are_unrolled, setup, teardown),
        cmocka_unit_test_setup_teardown(test_long_range_is_rolled_in_place, setup, teardown),
        cmocka_unit_test_setup_teardown(test_a_range_follows_the_spec, setup, teardown),
        cmocka_unit_test_setup_teardown(test_unrolled_code_fits_the_cache_of_a_gpu, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_draw_then_load_then_load, setup, teardown),
        cmocka_unit_test_setup_teardown(test_conditional_dispatch_may_clear, setup, teardown),
        cmocka_unit_test_setup_teardown(test_layout_changes_between_readers, setup, teardown),
        cmocka_unit_test_setup_teardown(test_indirect, setup, teardown),
        cmocka_unit_test_setup_teardown(test_store_after_store, setup, teardown),
        cmocka_unit_test_setup_teardown(test_depth_is_read_between_draws, setup, teardown),
        cmocka_unit_test_setup_teardown(test_second_reader_waits_for_the_layout, setup, teardown),
        cmocka_unit_test_setup_teardown(test_texels_after_samples_wait_for_nothing, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_stores_in_another_mip_stay_stored, setup, teardown),
        cmocka_unit_test_setup_teardown(test_mips_wait_for_themselves, setup, teardown),
        cmocka_unit_test_setup_teardown(test_skipped_readers_leave_the_write, setup, teardown),
        cmocka_unit_test_setup_teardown(test_history_crosses_frames, setup, teardown),
        cmocka_unit_test_setup_teardown(test_third_user_waits_for_unread_writes, setup, teardown),
        cmocka_unit_test_setup_teardown(test_chain_takes_two_slots, setup, teardown),
        cmocka_unit_test_setup_teardown(test_buffer_waits_for_the_buffer_before_a_target, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_buffer_waits_for_what_a_smaller_one_left, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_history_and_output_keep_their_memory, setup, teardown),
        cmocka_unit_test_setup_teardown(test_kept_resources_share_no_memory, setup, teardown),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
