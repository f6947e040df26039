/* Compiling ahead (app/view/warm.c) with a runtime that only takes notes: which passes run and when, what they
 * find in their buffers, and that panels are let go of. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "app/view/warm.h"

enum { PASSES = 6, ARGUMENTS = 3, MOST = 64 };

/* What happened, in order; written by the one thread that calls the runtime, read when it rests. */
static struct notes {
    const struct dt_panel *taken[MOST];
    int taken_count, ran[MOST], ran_count, cleared[MOST], cleared_count, opened, closed;
    uint32_t triangles, width;
    float live;
    struct warm *warm;
    int end_after;   /* passes; 0: run on */
    atomic_int held; /* at this pass; 0: at none */
} notes;

static void wait_for(int passes)
{
    for (int i = 0; i < 1000 && *(volatile int *)&notes.ran_count < passes; i++)
        usleep(2000);
    usleep(20000);
}

/* ---- The runtime ----------------------------------------------------------------------------- */

static void *fake_open(const struct dt_runtime_options *options)
{
    assert_null(options->context); /* the window is somebody else's */
    notes.opened++;
    return &notes;
}

static bool fake_scene(void *runtime, const struct dt_scene *scene)
{
    (void)runtime;
    notes.triangles = scene->index_count / 3;
    return true;
}

static bool fake_create(void *runtime, const struct dt_panel *panel)
{
    (void)runtime;
    notes.taken[notes.taken_count++] = panel;
    return true;
}

static bool fake_resize(void *runtime, uint32_t width, uint32_t height)
{
    (void)runtime;
    (void)height;
    notes.width = width;
    return true;
}

static bool fake_write(void *runtime, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    (void)runtime;
    assert_int_equal(mip, 0);
    for (size_t i = 0; i < bytes->size; i++)
        assert_int_equal(bytes->data[i], 0);
    assert_int_equal(bytes->size, 12);
    notes.cleared[notes.cleared_count++] = (int)resource;
    return true;
}

static bool fake_render(void *runtime, const struct dt_frame *frame, const void *live,
                        const struct dt_observer *observer)
{
    (void)runtime;
    assert_int_equal(frame->triangle_count, 1);
    memcpy(&notes.live, live, sizeof notes.live);
    for (uint32_t pass = 0; pass < PASSES; pass++) {
        enum dt_action action = observer->before_pass(observer->user, pass);
        if (action == DT_STOP)
            return false;
        if (action != DT_RUN)
            continue;
        while (pass && atomic_load(&notes.held) == (int)pass)
            usleep(1000);
        notes.ran[notes.ran_count++] = (int)pass;
        if (notes.ran_count == notes.end_after)
            warm_end(notes.warm);
    }
    return true;
}

static void fake_close(void *runtime)
{
    (void)runtime;
    notes.closed++;
}

static const struct dt_runtime runtime = {
    .name = "fake",
    .open = fake_open,
    .set_scene = fake_scene,
    .create = fake_create,
    .resize = fake_resize,
    .render = fake_render,
    .write = fake_write,
    .close = fake_close,
};

/* ---- A pipeline ------------------------------------------------------------------------------ */

static void three(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width;
    (void)height;
    extent[0] = 3;
    extent[1] = extent[2] = 1;
}

static void many(uint32_t width, uint32_t height, uint32_t extent[3])
{
    three(width, height, extent);
    extent[0] = 1 << 20;
}

static const struct dt_resource resources[] = {
    {.name = "picture", .kind = DT_IMAGE, .extent = three},
    {.name = "data", .kind = DT_BUFFER, .stride = 4, .extent = many},
    {.name = "few", .kind = DT_BUFFER, .stride = 4, .extent = three},
    [ARGUMENTS] = {.name = "arguments",
                   .kind = DT_BUFFER,
                   .stride = 4,
                   .extent = three,
                   .controls_work = true},
};
static const uint16_t reads[] = {0, 1, 2, ARGUMENTS};
static const struct dt_pass passes[PASSES] = {[4] = {.reads = reads, .read_count = 4}};
static const struct dt_pipeline pipeline = {.resources = resources,
                                            .resource_count = 4,
                                            .passes = passes,
                                            .pass_count = PASSES,
                                            .live_size = 16};
static const struct dt_panel first = {.pipeline = &pipeline}, second = {.pipeline = &pipeline};
static const struct dt_frame frame = {.width = 1920, .height = 20, .triangle_count = 1000};
static const float live[4] = {0.5f};
static const struct side side = {.context = "window"};
static const struct dt_scene scene = {.index_count = 3000};

static struct warm *begin_with(struct notes begun)
{
    notes = begun;
    notes.warm = warm_start(&runtime, &side, &scene);
    assert_non_null(notes.warm);
    warm_begin(notes.warm, &first, &frame, live);
    return notes.warm;
}

static struct warm *begin(int end_after)
{
    return begin_with((struct notes){.end_after = end_after});
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void passes_run_from_the_last(void **state)
{
    (void)state;
    static const int order[PASSES] = {2, 3, 4, 5, 0, 1};
    struct warm *warm = begin(0);
    wait_for(PASSES);
    warm_stop(warm);
    assert_int_equal(notes.ran_count, PASSES);
    assert_memory_equal(notes.ran, order, sizeof order);
    assert_int_equal(notes.opened, 1);
    assert_int_equal(notes.closed, 1);
    assert_int_equal(notes.triangles, 1);
    assert_int_equal(notes.width, 480);
    assert_true(notes.live == live[0]);
}

/* Neither images nor what is large and decides nothing. */
static void what_decides_work_is_none(void **state)
{
    (void)state;
    struct warm *warm = begin(0);
    wait_for(PASSES);
    warm_stop(warm);
    assert_int_equal(notes.cleared_count, 2);
    assert_int_equal(notes.cleared[0], 2);
    assert_int_equal(notes.cleared[1], ARGUMENTS);
}

static void the_end_is_heeded(void **state)
{
    (void)state;
    struct warm *warm = begin(2);
    wait_for(3); /* in vain */
    warm_stop(warm);
    assert_int_equal(notes.ran_count, 2);
}

/* The second device is held at a pass until the caller has come there, or nearly. */
static void *let_on(void *user)
{
    (void)user;
    usleep(50000);
    atomic_store(&notes.held, 0);
    return NULL;
}

static void the_caller_waits_where_they_meet(void **state)
{
    (void)state;
    pthread_t other;
    struct warm *warm = begin_with((struct notes){.held = 4}); /* of 2 to 5, which run first */
    wait_for(2);
    warm_meet(warm, 0);
    warm_meet(warm, 1); /* not there */
    assert_int_equal(notes.ran_count, 2);
    assert_int_equal(pthread_create(&other, NULL, let_on, NULL), 0);
    warm_meet(warm, 3);
    assert_int_equal(notes.ran_count, 4);
    pthread_join(other, NULL);
    wait_for(5); /* in vain: the rest is the caller's */
    assert_int_equal(notes.ran_count, 4);
    warm_stop(warm);
}

static void panels_are_let_go(void **state)
{
    (void)state;
    struct warm *warm = begin(1);
    warm_settle(warm);
    assert_int_equal(notes.taken_count, 1);
    warm_begin(warm, &second, &frame, live);
    warm_settle(warm);
    assert_int_equal(notes.taken_count, 2);
    assert_ptr_equal(notes.taken[1], &second);
    warm_stop(warm);
    assert_int_equal(notes.opened, 1);
    warm_stop(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(passes_run_from_the_last),
        cmocka_unit_test(what_decides_work_is_none),
        cmocka_unit_test(the_end_is_heeded),
        cmocka_unit_test(the_caller_waits_where_they_meet),
        cmocka_unit_test(panels_are_let_go),
    };
    return cmocka_run_group_tests_name("warm", tests, NULL, NULL);
}
