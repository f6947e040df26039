/* The faults of --fault against their documentation, number by number, on a runtime made of arrays.
 * tests/app/fault_test.sh checks that compare finds faults on real drivers. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "app/run/fault.h"

/* ---- A pipeline of one pass that writes one resource of each sort ---------------------------- */

enum { THINGS, GLOW, DEPTH, CODES, RESOURCES };
enum { ELEMENTS = 5, STRIDE = 32, WIDTH = 4, HEIGHT = 3 };

static void extent(const struct dt_pipeline *pipeline, uint32_t resource, uint32_t width,
                   uint32_t height, uint32_t size[3])
{
    uint32_t scale = resource == GLOW ? 2 : 1;
    (void)pipeline;
    size[0] = resource == THINGS ? ELEMENTS : width * scale;
    size[1] = resource == THINGS ? 1 : height * scale;
    size[2] = scale;
}

/* vec3 at 0, 4 bytes of nothing, int at 16, 12 bytes of nothing */
static const struct dt_field fields[] = {{.name = "position", .type = DT_TYPE_VEC3, .offset = 0},
                                         {.name = "label", .type = DT_TYPE_INT, .offset = 16}};
static const struct dt_resource resources[RESOURCES] = {
    [THINGS] =
        {.name = "things", .kind = DT_BUFFER, .fields = fields, .field_count = 2, .stride = STRIDE},
    [GLOW] =
        {.name = "glow", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA16F, .layered = true, .mips = 2},
    [DEPTH] = {.name = "depth", .kind = DT_IMAGE, .format = DT_FORMAT_D32F, .mips = 1},
    [CODES] = {.name = "codes", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA8, .mips = 1},
};
static const uint16_t writes[] = {THINGS, GLOW, DEPTH, CODES};
static const uint16_t write_mips[] = {1, 2, 1, 1};
static const struct dt_pass passes[] = {
    {.name = "idle"},
    {.name = "paint", .writes = writes, .write_count = RESOURCES, .write_mips = write_mips}};
static const struct dt_pipeline pipeline = {.name = "small",
                                            .extent = extent,
                                            .resources = resources,
                                            .resource_count = RESOURCES,
                                            .passes = passes,
                                            .pass_count = 2};

/* ---- A runtime made of arrays ---------------------------------------------------------------- */

enum { MOST = 256 };

struct memory {
    uint8_t bytes[RESOURCES][MOST];
    bool stubborn; /* ignores writes */
    char last[512];
    unsigned errors;
};

static const size_t sizes[RESOURCES] = {ELEMENTS * STRIDE, WIDTH *HEIGHT * 2 * 8, WIDTH *HEIGHT * 4,
                                        WIDTH *HEIGHT * 4};

static bool read_memory(void *runtime, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct memory *memory = runtime;
    assert_int_equal(mip, resource == GLOW ? 1 : 0);
    *out = (struct dt_bytes){.data = malloc(sizes[resource]),
                             .size = sizes[resource],
                             .extent = {WIDTH, HEIGHT, resource == GLOW ? 2 : 1}};
    assert_non_null(out->data);
    memcpy(out->data, memory->bytes[resource], sizes[resource]);
    return true;
}

static bool write_memory(void *runtime, uint32_t resource, uint32_t mip,
                         const struct dt_bytes *bytes)
{
    struct memory *memory = runtime;
    assert_int_equal(mip, resource == GLOW ? 1 : 0);
    assert_int_equal(bytes->size, sizes[resource]);
    if (!memory->stubborn)
        memcpy(memory->bytes[resource], bytes->data, bytes->size);
    return true;
}

static void keep_message(void *user, enum dt_level level, const char *message)
{
    struct memory *memory = user;
    memory->errors += level == DT_ERROR;
    snprintf(memory->last, sizeof memory->last, "%s", message);
}

static const struct dt_runtime arrays = {.name = "gl", .read = read_memory, .write = write_memory};

static void put_float(uint8_t *place, float value)
{
    memcpy(place, &value, sizeof value);
}

static float get_float(const uint8_t *place)
{
    float value;
    memcpy(&value, place, sizeof value);
    return value;
}

/* Padding is 0xee; some numbers are 0, some depths 1 and 0.5. */
static void fill(struct memory *memory)
{
    memset(memory, 0, sizeof *memory);
    memset(memory->bytes[THINGS], 0xee, sizes[THINGS]);
    for (int i = 0; i < ELEMENTS; i++) {
        uint8_t *thing = memory->bytes[THINGS] + (ptrdiff_t)i * STRIDE;
        const int32_t label = i - 2;
        for (int c = 0; c < 3; c++)
            put_float(thing + c * 4, (float)(i * c) * 1.5f);
        memcpy(thing + 16, &label, sizeof label);
    }
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        put_float(memory->bytes[DEPTH] + i * 4, (float)(i % 5) * 0.25f);
        memset(memory->bytes[CODES] + i * 4, i * 20, 4);
    }
    for (int i = 0; i < WIDTH * HEIGHT * 8; i++) { /* halves 0, 1, -2 */
        const uint16_t halves[] = {0, 0x3c00, 0xc000};
        memcpy(memory->bytes[GLOW] + i * 2, &halves[i % 3], 2);
    }
}

/* ---- One frame ------------------------------------------------------------------------------- */

static void run_frame(struct memory *memory, const struct fault *fault, uint32_t frame)
{
    const struct dt_log log = {.message = keep_message, .user = memory};
    struct fault_run run = {.fault = fault,
                            .runtime = &arrays,
                            .handle = memory,
                            .pipeline = &pipeline,
                            .log = &log,
                            .size = {WIDTH, HEIGHT},
                            .frame = frame};
    const struct dt_observer observer = fault_observer(&run);
    for (uint32_t pass = 0; pass < pipeline.pass_count; pass++) {
        bool due = fault->kind == FAULT_MISSING && pass == 1 && frame >= fault->first_frame;
        assert_int_equal(observer.before_pass(observer.user, pass), due ? DT_SKIP : DT_RUN);
        assert_true(observer.after_pass(observer.user, pass));
    }
}

struct change {
    uint32_t bytes, first, last, resource; /* places within the resource */
};

static struct change find_change(const struct memory *before, const struct memory *after)
{
    struct change change = {0};
    for (uint32_t r = 0; r < RESOURCES; r++) {
        for (uint32_t i = 0; i < sizes[r]; i++) {
            if (before->bytes[r][i] == after->bytes[r][i])
                continue;
            assert_true(change.bytes == 0 || change.resource == r);
            change.resource = r;
            change.first = change.bytes ? change.first : i;
            change.last = i;
            change.bytes++;
        }
    }
    return change;
}

static bool is_padding(uint32_t place)
{
    uint32_t within = place % STRIDE;
    return (within >= 12 && within < 16) || within >= 20;
}

/* ---- The kinds ------------------------------------------------------------------------------- */

static void test_bit_is_the_lowest_of_one_number(void **state)
{
    (void)state;
    bool hit[RESOURCES][MOST] = {0};
    uint32_t places = 0;
    for (uint64_t seed = 0; seed < 4000; seed++) {
        struct memory before, after;
        fill(&before);
        after = before;
        run_frame(&after, &(struct fault){.kind = FAULT_BIT, .pass = 1, .seed = seed}, 0);
        struct change change = find_change(&before, &after);
        const uint8_t *old = before.bytes[change.resource] + change.first;
        const uint8_t *new = after.bytes[change.resource] + change.first;
        if (change.resource == DEPTH && get_float(old - change.first % 4) == 1.0f) {
            assert_true(get_float(new - change.first % 4) < 1.0f);
            assert_true(get_float(new - change.first % 4) > 0.9999999f);
        } else if ((*old ^ *new) == 0x80) { /* a zero becomes the smallest normal number */
            assert_int_equal(change.bytes, 1);
            assert_int_equal(change.first % 4, 2);
            assert_true(get_float(old - 2) == 0.0f);
            assert_true(fabsf(get_float(new - 2)) == FLT_MIN);
        } else {
            assert_int_equal(change.bytes, 1);
            assert_int_equal(*old ^ *new, 1);
            assert_int_equal(change.first % (change.resource == CODES  ? 1
                                             : change.resource == GLOW ? 2
                                                                       : 4),
                             0); /* little-endian: the first byte of a number is the lowest */
        }
        assert_false(change.resource == THINGS && is_padding(change.first));
        places += !hit[change.resource][change.first];
        hit[change.resource][change.first] = true;
    }
    /* every number once: 5 * 4, 24 texels of four halves, 12 depths, 12 texels of four codes */
    assert_int_equal(places, 20 + 96 + 12 + 48);
}

static void check_sign(uint32_t resource, const uint8_t *old, const uint8_t *new)
{
    uint32_t before = 0, after = 0;
    switch (resource) {
    case THINGS: /* a float or, at 16, an int: the caller checks the offset */
        memcpy(&before, old, 4);
        memcpy(&after, new, 4);
        assert_true(after == (before ^ 0x80000000) || after == ~before);
        break;
    case GLOW:
        assert_int_equal((old[0] | old[1] << 8) ^ (new[0] | new[1] << 8), 0x8000);
        break;
    case DEPTH:
        assert_true(get_float(new) >= 0 && get_float(new) <= 1);
        assert_true(get_float(new) == 1 - get_float(old) || get_float(old) == 0.5f);
        assert_true(get_float(new) != get_float(old));
        break;
    default:
        assert_int_equal(*old + *new, 255);
    }
}

static void test_sign_is_that_of_one_number(void **state)
{
    (void)state;
    static const uint32_t widths[RESOURCES] = {4, 2, 4, 1};
    uint32_t seen[RESOURCES] = {0};
    for (uint64_t seed = 0; seed < 1000; seed++) {
        struct memory before, after;
        fill(&before);
        after = before;
        run_frame(&after, &(struct fault){.kind = FAULT_SIGN, .pass = 1, .seed = seed}, 0);
        struct change change = find_change(&before, &after);
        assert_true(change.bytes > 0);
        uint32_t width = widths[change.resource];
        assert_int_equal(change.first / width, change.last / width);
        uint32_t start = change.first / width * width;
        const uint8_t *old = before.bytes[change.resource] + start;
        const uint8_t *new = after.bytes[change.resource] + start;
        check_sign(change.resource, old, new);
        if (change.resource == THINGS && start % STRIDE < 12)
            assert_true(get_float(new) == -get_float(old));
        seen[change.resource]++;
    }
    for (int r = 0; r < RESOURCES; r++)
        assert_true(seen[r] > 0);
}

/* The fault replaces every number of one element: 0 by 1, and any other number by 0. */
static void test_texel_is_all_of_one_element(void **state)
{
    (void)state;
    static const uint32_t strides[RESOURCES] = {STRIDE, 8, 4, 4};
    for (uint64_t seed = 0; seed < 1000; seed++) {
        struct memory before, after;
        fill(&before);
        after = before;
        run_frame(&after, &(struct fault){.kind = FAULT_TEXEL, .pass = 1, .seed = seed}, 0);
        struct change change = find_change(&before, &after);
        uint32_t stride = strides[change.resource];
        uint32_t start = change.first / stride * stride;
        assert_int_equal(start, change.last / stride * stride);
        const uint8_t *old = before.bytes[change.resource] + start;
        const uint8_t *new = after.bytes[change.resource] + start;
        for (uint32_t c = 0; change.resource == GLOW && c < 8; c += 2)
            assert_int_equal(new[c] | new[c + 1] << 8, old[c] | old[c + 1] << 8 ? 0 : 0x3c00);
        for (uint32_t c = 0; change.resource == CODES && c < 4; c++)
            assert_int_equal(new[c], old[c] ? 0 : 255);
        for (uint32_t c = 0; change.resource == THINGS && c < 12; c += 4)
            assert_true(get_float(new + c) == (get_float(old + c) == 0 ? 1.0f : 0.0f));
        if (change.resource == THINGS)
            assert_int_equal(new[16] | new[17], old[16] ? 0 : 1);
        if (change.resource == DEPTH)
            assert_true(get_float(new) == (get_float(old) == 0 ? 1.0f : 0.0f));
    }
}

static void test_missing_writes_nothing(void **state)
{
    (void)state;
    struct memory before, after;
    fill(&before);
    after = before;
    run_frame(&after, &(struct fault){.kind = FAULT_MISSING, .pass = 1}, 0);
    assert_int_equal(find_change(&before, &after).bytes, 0);
    assert_string_equal(after.last, "fault in pass paint, frame 0: skipped");
}

static void test_frames_before_the_first_are_whole(void **state)
{
    (void)state;
    const struct fault fault = {.kind = FAULT_BIT, .pass = 1, .seed = 1, .first_frame = 2};
    struct memory before, after;
    fill(&before);
    after = before;
    run_frame(&after, &fault, 0);
    run_frame(&after, &fault, 1);
    assert_int_equal(find_change(&before, &after).bytes, 0);
    run_frame(&after, &fault, 2);
    assert_true(find_change(&before, &after).bytes > 0);
}

static void test_no_fault_changes_nothing(void **state)
{
    (void)state;
    struct memory before, after;
    fill(&before);
    after = before;
    run_frame(&after, &(struct fault){0}, 0);
    assert_int_equal(find_change(&before, &after).bytes, 0);
    assert_string_equal(after.last, "");
}

/* ---- Together with an observer --------------------------------------------------------------- */

struct watcher {
    struct memory *memory;
    const struct memory *before;
    enum dt_action action;
    bool saw_change;
};

static enum dt_action watch_before(void *user, uint32_t pass)
{
    struct watcher *watcher = user;
    return pass == 1 ? watcher->action : DT_RUN;
}

static bool watch_after(void *user, uint32_t pass)
{
    struct watcher *watcher = user;
    watcher->saw_change |= pass == 1 && find_change(watcher->before, watcher->memory).bytes > 0;
    return true;
}

static bool observed(enum dt_action action, enum fault_kind kind, enum dt_action expected)
{
    struct memory before, after;
    fill(&before);
    after = before;
    struct watcher watcher = {.memory = &after, .before = &before, .action = action};
    const struct dt_observer inner = {watch_before, watch_after, &watcher};
    const struct dt_log log = {.message = keep_message, .user = &after};
    struct fault_run run = {.fault = &(struct fault){.kind = kind, .pass = 1, .seed = 3},
                            .runtime = &arrays,
                            .handle = &after,
                            .pipeline = &pipeline,
                            .log = &log,
                            .observer = &inner,
                            .size = {WIDTH, HEIGHT}};
    const struct dt_observer observer = fault_observer(&run);
    assert_int_equal(observer.before_pass(observer.user, 1), expected);
    assert_true(observer.after_pass(observer.user, 1));
    return watcher.saw_change;
}

static void test_observers_see_the_fault(void **state)
{
    (void)state;
    assert_true(observed(DT_RUN, FAULT_BIT, DT_RUN));
    assert_false(observed(DT_RUN, FAULT_MISSING, DT_SKIP));
    /* no fault changes the results of a pass that the observer skips or stops */
    assert_false(observed(DT_SKIP, FAULT_BIT, DT_SKIP));
    assert_false(observed(DT_STOP, FAULT_MISSING, DT_STOP));
}

static void test_a_device_that_does_not_take_it(void **state)
{
    (void)state;
    struct memory memory;
    fill(&memory);
    memory.stubborn = true;
    const struct dt_log log = {.message = keep_message, .user = &memory};
    struct fault_run run = {.fault = &(struct fault){.kind = FAULT_BIT, .pass = 1, .seed = 3},
                            .runtime = &arrays,
                            .handle = &memory,
                            .pipeline = &pipeline,
                            .log = &log,
                            .size = {WIDTH, HEIGHT}};
    const struct dt_observer observer = fault_observer(&run);
    assert_false(observer.after_pass(observer.user, 1));
    assert_int_equal(memory.errors, 1);
    assert_non_null(strstr(memory.last, "did not keep the change"));
}

/* ---- The option ------------------------------------------------------------------------------ */

static const char *const labels[] = {"gl", "vk", "vk@a", "vk@a:b"};

static void test_option(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t side;
        struct fault fault;
    } cases[] = {
        {"gl:paint:bit", 0, {FAULT_BIT, 1, 0, 1}},
        {"vk:paint:texel:77", 1, {FAULT_TEXEL, 1, 0, 77}},
        {"vk@a:b:paint:sign:0", 3, {FAULT_SIGN, 1, 0, 0}},
        {"vk:paint:missing@2", 1, {FAULT_MISSING, 1, 2, 1}},
        {"gl:paint:bit:18446744073709551615@9", 0, {FAULT_BIT, 1, 9, UINT64_MAX}},
    };
    struct memory memory = {0};
    const struct dt_log log = {.message = keep_message, .user = &memory};
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        struct fault fault;
        uint32_t side;
        assert_true(fault_parse(&fault, &side, cases[i].text, &pipeline, labels, 4, &log));
        assert_int_equal(side, cases[i].side);
        assert_int_equal(fault.kind, cases[i].fault.kind);
        assert_int_equal(fault.pass, cases[i].fault.pass);
        assert_int_equal(fault.first_frame, cases[i].fault.first_frame);
        assert_true(fault.seed == cases[i].fault.seed);
    }
    assert_int_equal(memory.errors, 0);
}

static void test_option_errors(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"bit", "the pass is missing"},
        {"zink:paint:bit", "there is no side \"zink\"; the sides are gl, vk, vk@a, vk@a:b"},
        {"gl:pint:bit", "small has no pass \"pint\"; did you mean \"paint\"?"},
        {"gl:zzzzzzzz:bit", "small has no pass \"zzzzzzzz\""},
        {"gl:idle:bit", "pass idle writes nothing"},
        {"gl:paint", "the kind is missing"},
        {"gl:paint:bits", "the kind \"bits\" must be one of bit|texel|sign|missing"},
        {"gl:paint:bit:", "the seed is no whole number"},
        {"gl:paint:bit:-1", "the seed is no whole number"},
        {"gl:paint:bit:1x", "the seed is no whole number"},
        {"gl:paint:bit:18446744073709551616", "the seed is no whole number"},
        {"gl:paint:bit:1@", "the frame after @ is no whole number"},
        {"gl:paint:bit:1@4294967296", "the frame after @ is no whole number"},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        struct memory memory = {0};
        const struct dt_log log = {.message = keep_message, .user = &memory};
        struct fault fault;
        uint32_t side;
        assert_false(fault_parse(&fault, &side, cases[i][0], &pipeline, labels, 4, &log));
        assert_int_equal(memory.errors, 1);
        if (!strstr(memory.last, cases[i][1]))
            fail_msg("%s: %s", cases[i][0], memory.last);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bit_is_the_lowest_of_one_number),
        cmocka_unit_test(test_sign_is_that_of_one_number),
        cmocka_unit_test(test_texel_is_all_of_one_element),
        cmocka_unit_test(test_missing_writes_nothing),
        cmocka_unit_test(test_frames_before_the_first_are_whole),
        cmocka_unit_test(test_no_fault_changes_nothing),
        cmocka_unit_test(test_observers_see_the_fault),
        cmocka_unit_test(test_a_device_that_does_not_take_it),
        cmocka_unit_test(test_option),
        cmocka_unit_test(test_option_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
