/* Both runtimes, driven as the app drives them: every test runs on each, with the pipelines of
 * probe.h and formats.h. Both report wrong calls and limits in the same words. Validation, with
 * synchronization checking, and KHR_debug stay silent. runtime_gl_test.c and runtime_vk_test.c test
 * the parts that only one runtime has. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/lib/unit.h"
#include "formats.h"
#include "front.h"
#include "probe.h"

extern const struct dt_runtime runtime_gl, runtime_vk;

struct bench {
    const struct dt_runtime *runtime;
    const struct dt_stages *stages;
    const struct dt_shaders *probe, *formats;
};
static struct bench gl = {&runtime_gl, probe_gl_stages, &probe_gl, &formats_gl};
static struct bench vk = {&runtime_vk, probe_vk_stages, &probe_vk, &formats_vk};

/* A test of each runtime. */
#define TEST_BOTH(test)                                                                            \
    static void test(void **state);                                                                \
    BEFORE_MAIN(add_##test)                                                                        \
    {                                                                                              \
        unit_add((struct CMUnitTest){#test ", gl", test, NULL, NULL, &gl});                        \
        unit_add((struct CMUnitTest){#test ", vk", test, NULL, NULL, &vk});                        \
    }                                                                                              \
    static void test(void **state)

static struct dt_runtime_options options(void)
{
    probe_heard.errors = 0;
    return (struct dt_runtime_options){
        .log = {.message = probe_hear}, .debug = true, .timing = true, .poison = 0xab};
}

static void *open_ready(const struct bench *bench, uint32_t width, uint32_t height)
{
    const struct dt_runtime_options wanted = options();
    void *rt = bench->runtime->open(&wanted);
    assert_non_null(rt);
    assert_true(bench->runtime->set_scene(rt, &probe_scene) &&
                bench->runtime->create(rt, bench->probe) &&
                bench->runtime->resize(rt, width, height));
    return rt;
}

static void close_silent(const struct bench *bench, void *rt)
{
    assert_int_equal(bench->runtime->device(rt)->messages, 0);
    bench->runtime->close(rt);
    assert_int_equal(probe_heard.errors, 0);
}

static bool render(const struct bench *bench, void *rt, const struct probe_live *live,
                   const struct dt_observer *observer)
{
    const struct dt_frame frame = probe_frame(0);
    return bench->runtime->render(rt, &frame, live, observer);
}

static const struct probe_live defaults = {.mask = 1, .scale = 0.5f, .glow = 1};

/* ---- Frames ---------------------------------------------------------------------------------- */

TEST_BOTH(frames_have_the_values_that_were_drawn)
{
    const struct bench *bench = *state;
    const struct dt_runtime_options wanted = options();
    probe_run(bench->runtime, &wanted, bench->probe, &probe_heard.errors);
}

TEST_BOTH(what_was_written_is_read_back)
{
    const struct bench *bench = *state;
    const struct dt_runtime_options wanted = options();
    formats_prepare();
    formats_run(bench->runtime, &wanted, bench->formats, &probe_heard.errors);
}

/* OpenGL keeps a depth within 0 to 1; the poison as a number lies outside. */
static bool may_be_clamped(const struct bench *bench, const struct dt_resource *resource)
{
    return bench == &gl && resource->kind == DT_IMAGE && resource->format == DT_FORMAT_D32F;
}

/* History starts as zero, also in memory that had other bytes; all else has the poison in every
 * byte. */
TEST_BOTH(resources_begin_with_zero_or_poison)
{
    const struct bench *bench = *state;
    void *rt = open_ready(bench, 16, 8);
    for (int turn = 0; turn < 2; turn++) {
        for (uint32_t i = 0; i < PROBE_RESOURCES; i++) {
            const struct dt_resource *resource = &probe_pipeline.resources[i];
            for (uint32_t mip = 0; mip < (resource->kind == DT_IMAGE ? resource->mips : 1); mip++) {
                struct dt_bytes bytes = probe_read(bench->runtime, rt, i, mip);
                for (size_t k = 0; k < bytes.size && !may_be_clamped(bench, resource); k++)
                    if (bytes.data[k] != (resource->history ? 0 : 0xab))
                        fail_msg("%s, mip %u, byte %zu is %u", resource->name, mip, k,
                                 bytes.data[k]);
                free(bytes.data);
            }
        }
        assert_true(render(bench, rt, NULL, NULL));
        assert_true(bench->runtime->resize(rt, 24, 16));
    }
    close_silent(bench, rt);
}

/* A frame without live parameters has their defaults. Another scene shows after a resize. sRGB code
 * 188 decodes to 0.5029; its neighbours 187 and 189 to 0.4969 and 0.5089. */
TEST_BOTH(a_new_scene_is_drawn_after_a_resize)
{
    static const uint8_t texels[40] = {[16] = 188, 0, 0, 255, 188, 0, 0, 255,
                                       188,        0, 0, 255, 188, 0, 0, 255};
    const struct bench *bench = *state;
    struct dt_scene scene = probe_scene;
    void *rt = open_ready(bench, 16, 8);
    assert_true(render(bench, rt, NULL, NULL));
    probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
    scene.texels = texels;
    assert_true(bench->runtime->set_scene(rt, &scene) && bench->runtime->resize(rt, 16, 8) &&
                render(bench, rt, NULL, NULL));
    struct dt_bytes color = probe_read(bench->runtime, rt, PROBE_COLOR, 0);
    assert_true(fabsf(((float *)color.data)[0] - 0.5f * 0.5029f) < 5e-4f);
    free(color.data);
    close_silent(bench, rt);
}

TEST_BOTH(recording_takes_time_where_it_can_be_told)
{
    const struct bench *bench = *state;
    const struct dt_observer observer = {0};
    void *rt = open_ready(bench, 16, 8);
    assert_true(isnan(bench->runtime->record_ms(rt)));
    assert_true(render(bench, rt, NULL, NULL));
    double ms = bench->runtime->record_ms(rt);
    assert_true(bench == &gl ? isnan(ms) : ms > 0 && ms < 60e3);
    assert_true(render(bench, rt, NULL, &observer));
    assert_true(isnan(bench->runtime->record_ms(rt)));
    close_silent(bench, rt);
}

/* ---- Observers ------------------------------------------------------------------------------- */

struct watcher {
    const struct bench *bench;
    void *rt;
    struct bench *other; /* renders in the middle of this one's frame; NULL: none */
    void *other_rt;
    uint32_t passes, stop_after;
};

static bool after_pass(void *user, uint32_t pass)
{
    struct watcher *watcher = user;
    const struct dt_runtime *runtime = watcher->bench->runtime;
    assert_int_equal(pass, watcher->passes++);
    if (watcher->other)
        assert_true(render(watcher->other, watcher->other_rt, NULL, NULL));
    if (pass >= PROBE_SCENE)
        probe_check_color(runtime, watcher->rt, 16, 8);
    if (pass == PROBE_SCENE)
        probe_check_depth(runtime, watcher->rt, 16, 8);
    return pass != watcher->stop_after;
}

TEST_BOTH(an_observer_sees_every_pass_and_may_stop)
{
    const struct bench *bench = *state;
    void *rt = open_ready(bench, 16, 8);
    struct watcher watcher = {.bench = bench, .rt = rt, .stop_after = UINT32_MAX};
    const struct dt_observer observer = {.after_pass = after_pass, .user = &watcher};
    assert_true(render(bench, rt, NULL, &observer));
    assert_int_equal(watcher.passes, PROBE_PASSES);
    probe_check_stack(bench->runtime, rt);
    probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
    watcher.passes = 0;
    watcher.stop_after = PROBE_SCENE;
    assert_false(render(bench, rt, NULL, &observer)); /* no error: the observer reports why */
    assert_int_equal(watcher.passes, PROBE_SCENE + 1);
    probe_check_color(bench->runtime, rt, 16, 8);
    assert_int_equal(probe_heard.errors, 0);
    assert_true(bench->runtime->resize(rt, 16, 8) && render(bench, rt, NULL, NULL));
    probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
    close_silent(bench, rt);
}

TEST_BOTH(runtimes_live_side_by_side)
{
    struct bench *bench = *state;
    struct bench *benches[] = {&gl, &vk};
    for (int i = 0; i < 2; i++) {
        void *rt = open_ready(bench, 16, 8), *other = open_ready(benches[i], 40, 24);
        struct watcher watcher = {.bench = bench,
                                  .rt = rt,
                                  .other = benches[i],
                                  .other_rt = other,
                                  .stop_after = UINT32_MAX};
        const struct dt_observer observer = {.after_pass = after_pass, .user = &watcher};
        assert_true(render(bench, rt, NULL, &observer));
        probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
        close_silent(bench, rt);
        assert_true(
            render(benches[i], other, NULL, NULL)); /* lives on when its neighbour is gone */
        probe_check_color(benches[i]->runtime, other, 40, 24);
        probe_check_rest(benches[i]->runtime, other, 40, 24, PROBE_PASSES + 1, &defaults);
        close_silent(benches[i], other);
    }
}

/* Decides about passes before they run, and may write the color that the count pass reads. */
struct director {
    const struct bench *bench;
    void *rt;
    uint32_t passes, stop_at, skips; /* skips: a bit for each pass */
    const struct dt_bytes *color;
};

static enum dt_action before_pass(void *user, uint32_t pass)
{
    struct director *director = user;
    assert_int_equal(pass, director->passes++);
    if (pass == PROBE_COUNT && director->color)
        assert_true(director->bench->runtime->write(director->rt, PROBE_COLOR, 0, director->color));
    return pass == director->stop_at               ? DT_STOP
           : director->skips >> pass & UINT32_C(1) ? DT_SKIP
                                                   : DT_RUN;
}

TEST_BOTH(what_is_written_before_a_pass_is_what_it_reads)
{
    static const float red[4] = {0.5f, 0, 0, 1};
    const struct bench *bench = *state;
    void *rt = open_ready(bench, 16, 8);
    struct director director = {.bench = bench, .rt = rt, .stop_at = UINT32_MAX};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    struct dt_bytes color = probe_read(bench->runtime, rt, PROBE_COLOR, 0);
    for (uint32_t i = 0; i < 16 * 8; i++)
        memcpy(color.data + i * sizeof red, red, sizeof red);
    director.color = &color;
    assert_true(render(bench, rt, NULL, &observer));
    assert_int_equal(director.passes, PROBE_PASSES);
    free(color.data);
    struct dt_bytes bytes = probe_read(bench->runtime, rt, PROBE_ROWS, 0);
    for (uint32_t y = 0; y < 8; y++)
        assert_int_equal(((uint32_t *)bytes.data)[y], 16000);
    free(bytes.data);
    bytes = probe_read(bench->runtime, rt, PROBE_DISPLAY, 0);
    for (uint32_t i = 0; i < 16 * 8; i++) { /* through all the layouts in between */
        assert_in_range(bytes.data[4 * i], 127, 128);
        assert_memory_equal(bytes.data + 4 * i + 1, ((uint8_t[]){0, 0, 255}), 3);
    }
    free(bytes.data);
    close_silent(bench, rt);
}

/* A skipped pass leaves buffers as they were. Images that the plan discards have no reliable
 * content, but the layout of the plan. So the next frame renders, and validation stays silent. */
TEST_BOTH(a_skipped_pass_does_nothing_but_its_barriers)
{
    const struct bench *bench = *state;
    const struct probe_live clears = {0};
    void *rt = open_ready(bench, 16, 8);
    struct director director = {.stop_at = UINT32_MAX, .skips = UINT32_MAX};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    double ms[PROBE_PASSES];
    for (uint32_t i = PROBE_ROWS; i < PROBE_RESOURCES; i++) {
        struct dt_bytes bytes = probe_read(bench->runtime, rt, i, 0);
        memset(bytes.data, 0x11, bytes.size);
        assert_true(bench->runtime->write(rt, i, 0, &bytes));
        free(bytes.data);
    }
    assert_true(render(bench, rt, &clears, &observer));
    assert_int_equal(director.passes, PROBE_PASSES);
    for (uint32_t i = PROBE_ROWS; i < PROBE_RESOURCES; i++) {
        struct dt_bytes bytes = probe_read(bench->runtime, rt, i, 0);
        for (size_t k = 0; k < bytes.size; k++)
            assert_int_equal(bytes.data[k], 0x11);
        free(bytes.data);
    }
    assert_true(bench->runtime->timings(rt, ms));
    for (int pass = 0; pass < PROBE_PASSES; pass++)
        assert_true(isnan(ms[pass]));
    const struct dt_bytes zero = {.data = (uint8_t[32]){0}, .size = 32, .extent = {8, 1, 1}};
    assert_true(bench->runtime->write(rt, PROBE_FRAMES, 0, &zero));
    assert_true(render(bench, rt, NULL, NULL)); /* the next frame skips nothing */
    probe_check_color(bench->runtime, rt, 16, 8);
    probe_check_stack(bench->runtime, rt);
    probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
    close_silent(bench, rt);
}

/* A pass that an observer skips does not clear, even if it is switched off. The mask pass keeps its
 * image and its buffer. */
TEST_BOTH(a_skipped_pass_does_not_clear)
{
    const struct bench *bench = *state;
    const struct probe_live clears = {.scale = 0.5f};
    void *rt = open_ready(bench, 16, 8);
    struct director director = {.stop_at = UINT32_MAX, .skips = 1u << PROBE_MASK_PASS};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    assert_true(render(bench, rt, NULL, NULL));
    assert_true(render(bench, rt, &clears, &observer));
    struct dt_bytes mask = probe_read(bench->runtime, rt, PROBE_MASK, 0);
    struct dt_bytes groups = probe_read(bench->runtime, rt, PROBE_GROUPS, 0);
    assert_true(*(const float *)mask.data != 7.0f);
    assert_int_equal(*(const uint32_t *)groups.data, 2);
    free(mask.data);
    free(groups.data);
    assert_true(render(bench, rt, &clears, NULL));
    probe_check_rest(bench->runtime, rt, 16, 8, 3, &clears);
    close_silent(bench, rt);
}

TEST_BOTH(an_observer_may_stop_before_a_pass)
{
    const struct bench *bench = *state;
    void *rt = open_ready(bench, 16, 8);
    struct director director = {.stop_at = PROBE_COUNT};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    assert_false(render(bench, rt, NULL, &observer));
    assert_int_equal(director.passes, PROBE_COUNT + 1);
    struct dt_bytes bytes = probe_read(bench->runtime, rt, PROBE_FRAMES, 0);
    assert_int_equal(*(const uint32_t *)bytes.data, 0); /* the count pass did not run */
    free(bytes.data);
    assert_int_equal(probe_heard.errors, 0);
    assert_true(bench->runtime->resize(rt, 40, 24) && render(bench, rt, NULL, NULL));
    probe_check_rest(bench->runtime, rt, 40, 24, 1, &defaults);
    close_silent(bench, rt);
}

/* ---- Other panels ---------------------------------------------------------------------------- */

/* A copy of the probe's tables to change. */
struct variant {
    struct dt_resource resources[PROBE_RESOURCES];
    struct dt_storage storage[PROBE_RESOURCES];
    struct dt_program programs[PROBE_PASSES];
    struct dt_stages stages[PROBE_PASSES];
    struct dt_sampler sampler;
    struct dt_pipeline pipeline;
    struct dt_panel panel;
    struct dt_shaders shaders;
};

static struct variant *make_variant(const struct bench *bench)
{
    struct variant *v = calloc(1, sizeof *v);
    assert_non_null(v);
    memcpy(v->resources, probe_pipeline.resources, sizeof v->resources);
    memcpy(v->storage, probe_panel.storage, sizeof v->storage);
    memcpy(v->programs, probe_panel.programs, sizeof v->programs);
    memcpy(v->stages, bench->stages, sizeof v->stages);
    v->sampler = probe_panel.samplers[0];
    v->pipeline = probe_pipeline;
    v->pipeline.resources = v->resources;
    v->panel = probe_panel;
    v->panel.pipeline = &v->pipeline;
    v->panel.storage = v->storage;
    v->panel.programs = v->programs;
    v->panel.samplers = &v->sampler;
    v->shaders = (struct dt_shaders){bench->probe->backend, &v->panel, v->stages};
    return v;
}

/* The scene pass with other depth states: the frame shows the last, the first or the nearest
 * surface. */
TEST_BOTH(depth_tests_compare_as_the_panel_says)
{
    static const struct {
        bool test, write;
        enum dt_compare compare;
        float clear, low, depth; /* depth at the left of y < 0, where both quads are */
        bool front;              /* the front quad, drawn last, is seen there */
    } cases[] = {
        {true, true, DT_COMPARE_LESS, 1, 0.25f, 0.25f, true},
        {true, true, DT_COMPARE_GREATER, 0, 0.25f, 0.5f, false},
        {true, false, DT_COMPARE_GREATER, 0, 0, 0, true},
        {true, true, DT_COMPARE_ALWAYS, 0, 0.25f, 0.25f, true},
        {false, true, DT_COMPARE_GREATER, 1, 0.25f, 0.25f, true},
        {false, false, DT_COMPARE_LESS, 0, 0, 0, true},
        {true, true, DT_COMPARE_LESS_EQUAL, 0.25f, 0.25f, 0.25f, true},
        {true, true, DT_COMPARE_LESS, 0.25f, 0.25f, 0.25f, false},
    };
    const struct bench *bench = *state;
    void *rt = open_ready(bench, 16, 8);
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        struct variant *v = make_variant(bench);
        struct dt_program *program = &v->programs[PROBE_SCENE];
        program->depth_test = cases[i].test;
        program->depth_write = cases[i].write;
        program->compare = cases[i].compare;
        v->storage[PROBE_DEPTH].clear[0] = cases[i].clear;
        struct director director = {.stop_at =
                                        PROBE_LEVEL_0}; /* before the mask takes the memory */
        const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
        assert_true(bench->runtime->create(rt, &v->shaders) && bench->runtime->resize(rt, 16, 8));
        assert_false(render(bench, rt, NULL, &observer));
        struct dt_bytes color = probe_read(bench->runtime, rt, PROBE_COLOR, 0);
        struct dt_bytes depth = probe_read(bench->runtime, rt, PROBE_DEPTH, 0);
        bool front = ((float *)color.data)[1] == 0 && ((float *)color.data)[0] == 0.5f;
        bool back = ((float *)color.data)[1] == 0.5f, nothing = ((float *)color.data)[3] == 0;
        float right = ((float *)depth.data)[15], left = ((float *)depth.data)[0];
        if (front != cases[i].front || (!front && !back && !nothing) || left != cases[i].depth ||
            right != cases[i].low)
            fail_msg("case %zu: front %d, depth %g and %g", i, front, (double)left, (double)right);
        free(color.data);
        free(depth.data);
        assert_true(bench->runtime->create(rt, bench->probe)); /* before the other tables go */
        free(v);
    }
    close_silent(bench, rt);
}

static struct {
    const struct dt_backend *own;
    uint32_t made; /* a bit for each pass */
} counted;

static bool count_program(struct dt_core *core, void *program, uint32_t pass)
{
    counted.made |= 1u << pass;
    return counted.own->create_program(core, program, pass);
}

static void change_code(struct variant *v)
{
    v->stages[PROBE_AGAIN].fragment = v->stages[PROBE_LAYERS].fragment;
}
static void change_state(struct variant *v)
{
    static const struct dt_target target = {.resource = PROBE_GLOW};
    v->programs[PROBE_GLOW_PASS].colors = &target;
}
static void change_blend(struct variant *v)
{
    static const struct dt_blend most = {.op = DT_BLEND_MAX, .alpha_op = DT_BLEND_MAX};
    static const struct dt_target target = {.resource = PROBE_GLOW, .blend = &most};
    v->programs[PROBE_GLOW_PASS].colors = &target;
}
static void change_mask(struct variant *v)
{
    static const struct dt_blend add = {0};
    static const struct dt_target target = {.resource = PROBE_GLOW, .keep = 8, .blend = &add};
    v->programs[PROBE_GLOW_PASS].colors = &target;
}
static void change_bindings(struct variant *v)
{
    static const struct dt_binding unused = {.resource = DT_FRAME, .kind = DT_BIND_UNIFORM};
    v->programs[PROBE_GLOW_PASS].bindings = &unused;
    v->programs[PROBE_GLOW_PASS].binding_count = 1;
}
static void change_kind(struct variant *v)
{
    static const struct dt_binding unused = {.resource = PROBE_ROWS, .kind = DT_BIND_STORAGE};
    v->programs[PROBE_GLOW_PASS].bindings = &unused;
    v->programs[PROBE_GLOW_PASS].binding_count = 1;
}
static void change_format(struct variant *v)
{
    v->resources[PROBE_DISPLAY].format = DT_FORMAT_RGBA8_SRGB;
}
static void change_depth_target(struct variant *v)
{
    v->programs[PROBE_LAYERS].depth = NULL;
    v->programs[PROBE_LAYERS].depth_test = v->programs[PROBE_LAYERS].depth_write = false;
}
static void change_storage(struct variant *v)
{
    v->storage[PROBE_COLOR].clear[0] = 1;
    v->storage[PROBE_MASK].slot = 14;
    v->panel.slot_count = 15;
    v->sampler.linear = false;
}
static void change_nothing(struct variant *v)
{
    (void)v;
}

/* A new pipeline keeps the programs that stay the same, and makes only the others. */
TEST_BOTH(programs_go_on_where_they_are_the_same)
{
    static const struct {
        void (*change)(struct variant *v); /* relative to the probe itself */
        uint32_t made;                     /* after the case before */
    } cases[] = {
        {change_nothing, 0},
        {change_code, 1u << PROBE_AGAIN},
        {change_nothing, 1u << PROBE_AGAIN},
        {change_state, 1u << PROBE_GLOW_PASS},
        {change_blend, 1u << PROBE_GLOW_PASS},
        {change_mask, 1u << PROBE_GLOW_PASS},
        {change_bindings, 1u << PROBE_GLOW_PASS},
        {change_kind, 1u << PROBE_GLOW_PASS},
        {change_nothing, 1u << PROBE_GLOW_PASS},
        {change_format, 1u << PROBE_SHOW},
        {change_nothing, 1u << PROBE_SHOW},
        {change_depth_target, 1u << PROBE_LAYERS},
        {change_nothing, 1u << PROBE_LAYERS},
        {change_storage, 0},
        {change_nothing, 0},
    };
    const struct bench *bench = *state;
    void *rt = open_ready(bench, 16, 8);
    struct dt_core *core = rt;
    struct variant *before = NULL;
    struct dt_backend counting = *core->backend;
    counted.own = core->backend;
    counting.create_program = count_program;
    core->backend = &counting;
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        struct variant *v = make_variant(bench);
        cases[i].change(v);
        counted.made = 0;
        assert_true(bench->runtime->create(rt, &v->shaders));
        if (counted.made != cases[i].made)
            fail_msg("case %zu: made programs 0x%x", i, counted.made);
        free(before);
        before = v;
    }
    assert_true(bench->runtime->resize(rt, 16, 8) && render(bench, rt, NULL, NULL));
    probe_check_stack(bench->runtime, rt);
    probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
    core->backend = counted.own;
    close_silent(bench, rt);
    free(before);
}

static bool stop(void *user, uint32_t pass)
{
    (void)user;
    return pass != PROBE_SCENE;
}

/* It counts frames. Not from one that failed, nor through a pipeline without it. */
TEST_BOTH(history_outlives_resize_and_create)
{
    const struct bench *bench = *state;
    struct dt_runtime_options wanted = options();
    const struct dt_observer observer = {.after_pass = stop};
    wanted.keep_history = true;
    void *rt = bench->runtime->open(&wanted);
    formats_prepare();
    assert_true(rt && bench->runtime->set_scene(rt, &probe_scene) &&
                bench->runtime->create(rt, bench->probe) && bench->runtime->resize(rt, 16, 8) &&
                render(bench, rt, NULL, NULL));
    assert_true(bench->runtime->resize(rt, 40, 24) && bench->runtime->resize(rt, 16, 8) &&
                render(bench, rt, NULL, NULL));
    probe_check_rest(bench->runtime, rt, 16, 8, 2, &defaults);
    assert_true(bench->runtime->create(rt, bench->probe) && bench->runtime->resize(rt, 40, 24) &&
                render(bench, rt, NULL, NULL));
    probe_check_rest(bench->runtime, rt, 40, 24, 3, &defaults);
    assert_false(render(bench, rt, NULL, &observer));
    assert_true(bench->runtime->resize(rt, 16, 8) && render(bench, rt, NULL, NULL));
    probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
    assert_true(bench->runtime->create(rt, bench->formats) && bench->runtime->resize(rt, 3, 3) &&
                bench->runtime->create(rt, bench->probe) && bench->runtime->resize(rt, 16, 8) &&
                render(bench, rt, NULL, NULL));
    probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
    close_silent(bench, rt);
}

/* Another pipeline in between, with other resources and fewer passes. */
TEST_BOTH(a_panel_takes_the_place_of_another)
{
    const struct bench *bench = *state;
    const struct dt_frame frame = probe_frame(0);
    struct dt_bytes bytes;
    void *rt = open_ready(bench, 16, 8);
    formats_prepare();
    assert_true(render(bench, rt, NULL, NULL));
    assert_true(bench->runtime->create(rt, bench->formats) && bench->runtime->resize(rt, 3, 3) &&
                bench->runtime->render(rt, &frame, NULL, NULL));
    assert_true(bench->runtime->read(rt, FORMATS_ODD, 0, &bytes));
    assert_int_equal(bytes.size, 13 * 12);
    free(bytes.data);
    assert_true(bench->runtime->create(rt, bench->probe) && bench->runtime->resize(rt, 16, 8) &&
                render(bench, rt, NULL, NULL));
    probe_check_color(bench->runtime, rt, 16, 8);
    probe_check_rest(bench->runtime, rt, 16, 8, 1, &defaults);
    close_silent(bench, rt);
}

/* ---- Wrong calls ----------------------------------------------------------------------------- */

enum { MAX_LINES = 96, MAX_LINE = 1024 };
struct transcript {
    char lines[MAX_LINES][MAX_LINE];
    uint32_t count;
};

/* Notes the message without the names of device and API, so that both backends have the same
 * words. */
static void note(struct transcript *transcript, const struct bench *bench, void *rt)
{
    const struct dt_core *core = rt;
    const char *const names[][2] = {{bench->runtime->device(rt)->name, "DEVICE"},
                                    {core->backend->api, "API"}};
    char *line = transcript->lines[transcript->count++];
    assert_true(transcript->count < MAX_LINES);
    snprintf(line, MAX_LINE, "%s", probe_heard.last);
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++) {
        char *at = strstr(line, names[i][0]), rest[MAX_LINE];
        if (!at)
            continue;
        snprintf(rest, sizeof rest, "%s", at + strlen(names[i][0]));
        snprintf(at, MAX_LINE - (size_t)(at - line), "%s%s", names[i][1], rest);
    }
}

/* The call must fail with exactly one error, which contains these words. */
#define WRONG(call, words)                                                                         \
    do {                                                                                           \
        probe_heard.errors = 0;                                                                    \
        assert_false(call);                                                                        \
        if (probe_heard.errors != 1 || !strstr(probe_heard.last, words))                           \
            fail_msg("%s: %u errors, the last: %s", #call, probe_heard.errors, probe_heard.last);  \
        probe_heard.errors = 0;                                                                    \
        note(transcript, bench, rt);                                                               \
    } while (0)

static void wrong_before_create(struct transcript *transcript, const struct bench *bench, void *rt)
{
    const struct dt_runtime *runtime = bench->runtime;
    const struct bench *other = bench == &gl ? &vk : &gl;
    struct dt_bytes bytes = {0};
    double ms[PROBE_PASSES];
    WRONG(runtime->resize(rt, 16, 8),
          "resize: no pipeline or no scene yet; create and set_scene come first");
    WRONG(render(bench, rt, NULL, NULL), "render: call resize first");
    WRONG(runtime->read(rt, 0, 0, &bytes), "read: the pipeline has no resource 0");
    assert_null(bytes.data);
    WRONG(runtime->write(rt, 0, 0, &bytes), "write: the pipeline has no resource 0");
    WRONG(runtime->timings(rt, ms), "timings: none of a whole frame; open with timing");
    probe_heard.errors = 0;
    assert_false(runtime->create(rt, other->probe));
    assert_non_null(strstr(probe_heard.last,
                           bench == &gl ? "pipeline probe: the shaders are for vk; give probe_gl"
                                        : "pipeline probe: the shaders are for gl; give probe_vk"));
    WRONG(runtime->resize(rt, 16, 8), "create and set_scene come first");
    assert_false(runtime->device(rt)->lost);
}

static void wrong_before_resize(struct transcript *transcript, const struct bench *bench, void *rt)
{
    const struct dt_runtime *runtime = bench->runtime;
    struct dt_bytes bytes = {0};
    assert_true(runtime->create(rt, bench->probe));
    WRONG(runtime->resize(rt, 16, 8), "create and set_scene come first"); /* the scene is missing */
    assert_true(runtime->set_scene(rt, &probe_scene));
    WRONG(render(bench, rt, NULL, NULL), "call resize first (also after a new scene");
    WRONG(runtime->read(rt, PROBE_COLOR, 0, &bytes),
          "read color: it does not exist yet; resize comes first");
    WRONG(runtime->write(rt, PROBE_COLOR, 0, &bytes), "write color: it does not exist yet");
    WRONG(runtime->resize(rt, 0, 4), "frame of 0x4: ");
    WRONG(runtime->resize(rt, 4, 0), "frame of 4x0: ");
    WRONG(runtime->resize(rt, 1u << 20, 8), "frame of 1048576x8: ");
    WRONG(render(bench, rt, NULL, NULL), "call resize first");
}

static void wrong_after_resize(struct transcript *transcript, const struct bench *bench, void *rt)
{
    const struct dt_runtime *runtime = bench->runtime;
    struct dt_bytes bytes = {0};
    double ms[PROBE_PASSES];
    assert_true(runtime->resize(rt, 16, 8));
    WRONG(runtime->timings(rt, ms), "timings: none"); /* no frame yet */
    WRONG(runtime->read(rt, PROBE_RESOURCES, 0, &bytes), "read: the pipeline has no resource 15");
    WRONG(runtime->read(rt, UINT32_MAX, 0, &bytes),
          "read: the pipeline has no resource 4294967295");
    WRONG(runtime->read(rt, PROBE_SPARE, PROBE_MIPS, &bytes), "read spare: mip 3, and it has 3");
    WRONG(runtime->read(rt, PROBE_ROWS, 1, &bytes), "read rows: mip 1, and it has 1");
    assert_null(bytes.data);
    assert_true(render(bench, rt, NULL, NULL));
    WRONG(runtime->timings(rt, ms), "timings: none"); /* opened without */
    assert_true(runtime->set_scene(rt, &probe_scene));
    WRONG(render(bench, rt, NULL, NULL),
          "call resize first (also after a new scene, an import or a failed frame)");
    assert_true(runtime->resize(rt, 16, 8));
    const struct dt_observer stops = {.before_pass = before_pass, .user = &(struct director){0}};
    assert_false(render(bench, rt, NULL, &stops));
    WRONG(render(bench, rt, NULL, NULL), "or a failed frame");
    assert_true(runtime->read(rt, PROBE_FRAMES, 0, &bytes)); /* existing content can be read */
    free(bytes.data);
    assert_true(runtime->resize(rt, 16, 8) && render(bench, rt, NULL, NULL));
}

/* Bytes of another resource or mip are refused and change nothing. */
static void wrong_bytes(struct transcript *transcript, const struct bench *bench, void *rt)
{
    const struct dt_runtime *runtime = bench->runtime;
    const uint32_t rg = FORMATS_LAYERED + DT_FORMAT_RG8, rgba = FORMATS_LAYERED + DT_FORMAT_RGBA8;
    formats_prepare();
    assert_true(runtime->create(rt, bench->formats) && runtime->resize(rt, 16, 8));
    struct dt_bytes bytes = probe_read(runtime, rt, rg, 1), before = probe_read(runtime, rt, rg, 0);
    struct dt_bytes depth = probe_read(runtime, rt, FORMATS_PLAIN + DT_FORMAT_D32F, 2);
    memset(bytes.data, 0x55, bytes.size);
    WRONG(runtime->write(rt, rg, 0, &bytes),
          "write layered_1: 72 bytes of 6x3x2 given, but the resource has 364 bytes of 13x7x2");
    WRONG(runtime->write(rt, rgba, 1, &bytes),
          "write layered_2: 72 bytes of 6x3x2 given, but the resource has 144 bytes of 6x3x2");
    bytes.extent[0] = 3, bytes.extent[1] = 6;
    WRONG(runtime->write(rt, rg, 1, &bytes),
          "write layered_1: 72 bytes of 3x6x2 given, but the resource has 72 bytes of 6x3x2");
    WRONG(runtime->write(rt, rg, 3, &bytes), "write layered_1: mip 3, and it has 3");
    WRONG(runtime->write(rt, FORMATS_VOLUME, 2, &bytes),
          "write volume_0: 72 bytes of 3x6x2 given, but the resource has 3 bytes of 3x1x1");
    WRONG(runtime->write(rt, FORMATS_CUBE, 2, &bytes),
          "write cube_0: 72 bytes of 3x6x2 given, but the resource has 6 bytes of 1x1x6");
    WRONG(runtime->write(rt, FORMATS_ODD, 1, &bytes), "write odd: mip 1, and it has 1");
    WRONG(runtime->write(rt, FORMATS_ODD, 0, &bytes),
          "write odd: 72 bytes of 3x6x2 given, but the resource has 156 bytes of 13x1x1");
    WRONG(runtime->write(rt, FORMATS_RESOURCES, 0, &bytes),
          "write: the pipeline has no resource 187");
    memcpy(depth.data, (const float[]){0.0f, 1.0f, 1.0000001f}, 12);
    WRONG(runtime->write(rt, FORMATS_PLAIN + DT_FORMAT_D32F, 2, &depth),
          "write plain_14: texel 2 is 1.00000012, but a depth is 0 to 1");
    free(depth.data);
    struct dt_bytes after = probe_read(runtime, rt, rg, 0);
    assert_memory_equal(before.data, after.data, before.size);
    free(bytes.data);
    free(before.data);
    free(after.data);
}

static void wrong_calls(struct transcript *transcript, const struct bench *bench)
{
    const struct dt_runtime_options plain = {.log = {.message = probe_hear}, .poison = 1};
    void *rt = bench->runtime->open(&plain);
    assert_non_null(rt);
    wrong_before_create(transcript, bench, rt);
    wrong_before_resize(transcript, bench, rt);
    wrong_after_resize(transcript, bench, rt);
    wrong_bytes(transcript, bench, rt);
    bench->runtime->close(rt);
    bench->runtime->close(NULL);
    assert_int_equal(probe_heard.errors, 0);
}

/* ---- Limits: set here, so that all devices have the same ------------------------------------- */

static struct dt_limits *limits_of(void *rt)
{
    return &((struct dt_core *)rt)->limits;
}

/* Limits that creating a pipeline checks. */
static void limits_of_programs(struct transcript *transcript, const struct bench *bench, void *rt)
{
    const struct dt_runtime *runtime = bench->runtime;
    const struct dt_limits own = *limits_of(rt);
    struct dt_limits *limits = limits_of(rt);
    static const struct {
        enum dt_device_limit limit;
        uint64_t most;
        const char *words;
    } kinds[] = {
        {DT_LIMIT_UNIFORMS, 0, "pass plan needs 1 uniform buffers; the device "},
        {DT_LIMIT_STORAGES, 1, "pass plan needs 2 storage buffers; the device "},
        {DT_LIMIT_TEXTURES, 0, "pass scene needs 1 textures and texel buffers; the device "},
        {DT_LIMIT_IMAGES, 0, "pass count needs 1 storage images; the device "},
        {DT_LIMIT_COLOR_TARGETS, 0, "pass scene needs 1 color targets; the device "},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(kinds); i++) {
        limits->most[kinds[i].limit] = kinds[i].most;
        WRONG(runtime->create(rt, bench->probe), kinds[i].words);
        *limits = own;
    }
    struct variant *v = make_variant(bench);
    v->programs[PROBE_SCENE].color_count = DT_MAX_COLOR_TARGETS + 1;
    WRONG(runtime->create(rt, &v->shaders),
          "pass scene: 9 color targets, but the limit is 8; split the pass");
    v->programs[PROBE_SCENE].color_count = 1;
    v->programs[PROBE_SCENE].binding_count = DT_MAX_BINDINGS + 1;
    WRONG(runtime->create(rt, &v->shaders),
          "pass scene: 65 resources, but at most 64 can be bound");
    v->programs[PROBE_SCENE].binding_count = 2;
    v->programs[PROBE_SCENE].clip_distances = 3;
    limits->most[DT_LIMIT_CLIP_DISTANCES] = 2;
    WRONG(runtime->create(rt, &v->shaders), "pass scene needs 3 clip distances; the device ");
    *limits = own;
    v->programs[PROBE_SCENE].clip_distances = 0;
    /* What a panel lists: shared memory of a dispatch. */
    static const struct dt_demand demand = {PROBE_PLAN, DT_LIMIT_SHARED_BYTES, 80000};
    v->panel.demands = &demand;
    v->panel.demand_count = 1;
    limits->most[DT_LIMIT_SHARED_BYTES] = 32768;
    WRONG(runtime->create(rt, &v->shaders), "pass plan needs 80,000 bytes of shared memory; the ");
    *limits = own;
    v->panel.demand_count = 0;
    struct dt_binding bindings[DT_MAX_BINDINGS];
    memcpy(bindings, v->programs[PROBE_SCENE].bindings,
           v->programs[PROBE_SCENE].binding_count * sizeof *bindings);
    v->programs[PROBE_SCENE].bindings = bindings;
    bindings[0].kind = DT_BIND_UNIFORM;
    limits->most[DT_LIMIT_UNIFORM_BYTES] = 65535;
    WRONG(runtime->create(rt, &v->shaders), "pass scene needs 65,536 bytes in a uniform block; ");
    *limits = own;
    v->programs[PROBE_SCENE].bindings = probe_panel.programs[PROBE_SCENE].bindings;
    v->sampler.anisotropy = 16;
    limits->anisotropy = 4;
    WRONG(runtime->create(rt, &v->shaders), "sampler linear: anisotropy 16, but ");
    *limits = own;
    WRONG(runtime->resize(rt, 16, 8),
          "create and set_scene come first"); /* the refused pipeline is gone */
    free(v);
}

/* Limits that making resources checks. */
static void limits_of_resources(struct transcript *transcript, const struct bench *bench, void *rt)
{
    const struct dt_runtime *runtime = bench->runtime;
    const struct dt_limits own = *limits_of(rt);
    struct dt_limits *limits = limits_of(rt);
    struct variant *v = make_variant(bench);
    assert_true(runtime->create(rt, &v->shaders));
    limits->most[DT_LIMIT_IMAGE_SIDE] = 15;
    WRONG(runtime->resize(rt, 8, 8), "image stack: 16x8 texels, but ");
    limits->most[DT_LIMIT_IMAGE_SIDE] = 7;
    WRONG(runtime->resize(rt, 8, 7), "frame of 8x7: ");
    *limits = own;
    limits->most[DT_LIMIT_IMAGE_LAYERS] = 3;
    WRONG(runtime->resize(rt, 8, 8), "image stack: 4 layers, but ");
    *limits = own;
    limits->most[DT_LIMIT_TARGET_HEIGHT] = 7;
    WRONG(runtime->resize(rt, 8, 8), "image color: 8x8 texels, but ");
    *limits = own;
    limits->most[DT_LIMIT_STORAGE_BYTES] = 31;
    WRONG(runtime->resize(rt, 7, 7), "buffer frames: 32 bytes, but ");
    *limits = own;
    formats_prepare();
    assert_true(runtime->create(rt, bench->formats));
    limits->most[DT_LIMIT_VOLUME_SIDE] = 12;
    WRONG(runtime->resize(rt, 8, 8), "image volume_0: 13x7 texels, but ");
    *limits = own;
    limits->most[DT_LIMIT_CUBE_SIDE] = 6;
    WRONG(runtime->resize(rt, 8, 8), "image cube_0: 7x7 texels, but ");
    *limits = own;
    assert_true(runtime->create(rt, &v->shaders));
    v->resources[PROBE_LEVELS].mips = 6;
    WRONG(runtime->resize(rt, 8, 8), "image levels: 6 mips, but 16x8 texels have 1 to 5");
    v->resources[PROBE_LEVELS].mips = PROBE_MIPS;
    v->storage[PROBE_ROWS].usage |= DT_READ_UNIFORM;
    v->storage[PROBE_ROWS].block = 1u << 20; /* the declared size counts, not the written one */
    limits->most[DT_LIMIT_UNIFORM_BYTES] = 65536;
    WRONG(runtime->resize(rt, 8, 8), "buffer rows: 1048576 bytes, but ");
    *limits = own;
    v->storage[PROBE_ROWS] = probe_panel.storage[PROBE_ROWS];
    struct dt_scene scene = probe_scene;
    scene.material_count = DT_MAX_MATERIALS + 1;
    WRONG(runtime->set_scene(rt, &scene), "materials, but shaders see 2048; merge some");
    scene = probe_scene;
    limits->most[DT_LIMIT_STORAGE_BYTES] = scene.vertex_count * sizeof *scene.vertices - 1;
    WRONG(runtime->set_scene(rt, &scene), "scene vertices: ");
    *limits = own;
    limits->most[DT_LIMIT_IMAGE_LAYERS] = 0;
    WRONG(runtime->set_scene(rt, &scene), "scene textures: ");
    *limits = own; /* the scene before is still there */
    assert_true(runtime->resize(rt, 8, 8) && render(bench, rt, NULL, NULL));
    probe_check_color(runtime, rt, 8, 8);
    assert_true(runtime->create(rt, bench->probe)); /* before the other tables go */
    free(v);
}

static bool record_layers(const struct dt_recording *r)
{
    return r->verbs->begin(r->runtime, PROBE_LAYERS, true) &&
           r->verbs->draw_scene(r->runtime, PROBE_LAYERS, PROBE_LAYER_COUNT + 1);
}
static bool record_no_layers(const struct dt_recording *r)
{
    return r->verbs->begin(r->runtime, PROBE_SHOW, true) &&
           r->verbs->draw_fullscreen(r->runtime, PROBE_SHOW, 0);
}

/* Limits that recording a frame checks. */
static void limits_of_frames(struct transcript *transcript, const struct bench *bench, void *rt)
{
    const struct dt_runtime *runtime = bench->runtime;
    const struct dt_limits own = *limits_of(rt);
    struct dt_limits *limits = limits_of(rt);
    struct variant *v = make_variant(bench);
    assert_true(runtime->create(rt, &v->shaders));
    limits->most[DT_LIMIT_GROUPS_X] = 1;
    WRONG(runtime->resize(rt, 8, 8), "pass level_0 needs 2 workgroups along x; the device ");
    WRONG(render(bench, rt, NULL, NULL), "call resize first");
    *limits = own;
    limits->most[DT_LIMIT_DRAWS] = 1;
    WRONG(runtime->resize(rt, 8, 8), "pass again needs 2 indirect draws; the device ");
    *limits = own;
    assert_true(runtime->resize(rt, 8, 8)); /* other live parameters come with the frame */
    limits->most[DT_LIMIT_GROUPS_X] = 1;
    WRONG(render(bench, rt, NULL, NULL), "pass level_0 needs 2 workgroups along x; the device ");
    *limits = own;
    v->panel.record = record_layers;
    WRONG(runtime->resize(rt, 8, 8), "pass layers: draws into 5 layers, and image stack has 4");
    v->panel.record = record_no_layers;
    WRONG(runtime->resize(rt, 8, 8), "pass show: draws into 0 layers, and image display has 1");
    v->panel.record = probe_panel.record;
    assert_true(runtime->resize(rt, 8, 8) && render(bench, rt, NULL, NULL));
    probe_check_rest(runtime, rt, 8, 8, 1, &defaults);
    assert_true(runtime->create(rt, bench->probe));
    free(v);
}

static void limits(struct transcript *transcript, const struct bench *bench)
{
    const struct dt_runtime_options wanted = options();
    void *rt = bench->runtime->open(&wanted);
    assert_non_null(rt);
    assert_true(bench->runtime->set_scene(rt, &probe_scene));
    limits_of_programs(transcript, bench, rt);
    limits_of_resources(transcript, bench, rt);
    limits_of_frames(transcript, bench, rt);
    close_silent(bench, rt);
}

/* ---- The same words -------------------------------------------------------------------------- */

/* Removes the limits of a device from the line, since devices differ in them. */
static void blank_sizes(char *line)
{
    char *at = strstr(line, "DEVICE takes 1x1 to ");
    if (at)
        at[strlen("DEVICE takes")] = 0;
}

static void check_same_words(void (*run)(struct transcript *transcript, const struct bench *bench))
{
    struct transcript *transcripts = calloc(2, sizeof *transcripts);
    assert_non_null(transcripts);
    run(&transcripts[0], &gl);
    run(&transcripts[1], &vk);
    assert_int_equal(transcripts[0].count, transcripts[1].count);
    for (uint32_t i = 0; i < transcripts[0].count; i++) {
        blank_sizes(transcripts[0].lines[i]);
        blank_sizes(transcripts[1].lines[i]);
        assert_string_equal(transcripts[0].lines[i], transcripts[1].lines[i]);
    }
    free(transcripts);
}

TEST(wrong_calls_are_told_in_the_same_words)
{
    check_same_words(wrong_calls);
}

TEST(limits_are_told_in_the_same_words)
{
    check_same_words(limits);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static void huge_extent(const struct dt_pipeline *pipeline, uint32_t resource, uint32_t width,
                        uint32_t height, uint32_t size[3])
{
    probe_pipeline.extent(pipeline, resource, width, height, size);
    if (resource == PROBE_KEPT)
        dt_set_extent(size, UINT32_MAX, 1, 1);
}

/* The memory exceeds any machine, but no limit that the runtime knows. */
TEST_BOTH(too_much_memory_is_one_error)
{
    const struct bench *bench = *state;
    struct dt_runtime_options wanted = options();
    wanted.debug = false; /* debug output has messages of its own */
    void *rt = bench->runtime->open(&wanted);
    assert_true(rt && bench->runtime->set_scene(rt, &probe_scene));
    struct variant *v = make_variant(bench);
    v->pipeline.extent = huge_extent;
    v->resources[PROBE_KEPT].stride = 1u << 18;
    v->storage[PROBE_KEPT].usage = DT_READ_INDEX;
    assert_true(bench->runtime->create(rt, &v->shaders));
    assert_false(bench->runtime->resize(rt, 8, 8));
    assert_int_equal(probe_heard.errors, 1);
    assert_non_null(strstr(probe_heard.last, "kept"));
    probe_heard.errors = 0;
    v->pipeline.extent = probe_pipeline.extent;
    v->resources[PROBE_KEPT] = probe_pipeline.resources[PROBE_KEPT];
    v->storage[PROBE_KEPT] = probe_panel.storage[PROBE_KEPT];
    assert_true(bench->runtime->create(rt, &v->shaders) && bench->runtime->resize(rt, 8, 8) &&
                render(bench, rt, NULL, NULL));
    probe_check_rest(bench->runtime, rt, 8, 8, 1, &defaults);
    bench->runtime->close(rt);
    free(v);
}

/* ---- Values that a runtime adds to the frame ------------------------------------------------- */

static int64_t three_positions(const struct dt_pipeline *pipeline, const void *live)
{
    (void)pipeline, (void)live;
    return 3;
}

TEST(a_frame_knows_the_camera_before)
{
    const struct dt_pipeline pipeline = {.name = "none"};
    struct dt_core core = {.pipeline = &pipeline, .width = 8, .height = 4};
    struct dt_frame frame = {.camera = {.far_plane = 2}}, block;
    block = dt_front_frame(&core, &frame, NULL);
    assert_true(block.first == 1 && block.previous_camera.far_plane == 2);
    assert_true(block.width == 8 && block.height == 4 && block.jitter[0] == 0);
    frame.index = 1;
    frame.camera.far_plane = 3;
    block = dt_front_frame(&core, &frame, NULL);
    assert_true(block.first == 0 && block.previous_camera.far_plane == 2);
    frame.previous_camera.far_plane = 9; /* by the caller */
    block = dt_front_frame(&core, &frame, NULL);
    assert_true(block.first == 0 && block.previous_camera.far_plane == 9);
    frame.previous_camera.far_plane = 0;
    frame.index = 0; /* a new sequence */
    frame.camera.far_plane = 4;
    block = dt_front_frame(&core, &frame, NULL);
    assert_true(block.first == 1 && block.previous_camera.far_plane == 4);
}

/* The second of three points, (1/4, 2/3), in the fifth frame. */
TEST(jitter_moves_the_picture)
{
    const struct dt_pipeline pipeline = {.name = "none", .jitter = three_positions};
    struct dt_core core = {.pipeline = &pipeline, .width = 8, .height = 4};
    struct dt_frame frame = {.index = 4};
    for (int i = 0; i < 4; i++)
        frame.camera.view_projection[i][i] = frame.camera.inverse_view_projection[i][i] = 1;
    const struct dt_frame block = dt_front_frame(&core, &frame, NULL);
    const float *origin = block.camera.view_projection[3];
    const float *back = block.camera.inverse_view_projection[3];
    assert_true(block.jitter[0] == -0.25f && fabsf(block.jitter[1] - 1.0f / 6) < 1e-7f);
    assert_true(origin[0] == -0.0625f && fabsf(origin[1] - 1.0f / 12) < 1e-7f);
    assert_true(back[0] == -origin[0] && back[1] == -origin[1] && origin[2] == 0);
    assert_true(block.previous_camera.view_projection[3][0] == 0);
}

RUN_TESTS("runtimes", NULL, NULL)
