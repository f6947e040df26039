/* Checks the frames of the pipeline in probe.h; expected values follow from its scene and
 * shaders. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/lib/unit.h"

#include "probe.h"

struct dt_frame probe_frame(uint32_t index)
{
    return (struct dt_frame){.index = index, .triangle_count = probe_scene.index_count / 3};
}

struct dt_bytes probe_read(const struct dt_runtime *runtime, void *rt, uint32_t resource,
                           uint32_t mip)
{
    struct dt_bytes bytes;
    assert_true(runtime->read(rt, resource, mip, &bytes));
    assert_non_null(bytes.data);
    return bytes;
}

static struct dt_bytes read_sized(const struct dt_runtime *runtime, void *rt, uint32_t resource,
                                  uint32_t mip, uint32_t width, uint32_t height, uint32_t layers,
                                  size_t texel)
{
    struct dt_bytes bytes = probe_read(runtime, rt, resource, mip);
    assert_int_equal(bytes.extent[0], width);
    assert_int_equal(bytes.extent[1], height);
    assert_int_equal(bytes.extent[2], layers);
    assert_int_equal(bytes.size, (size_t)width * height * layers * texel);
    return bytes;
}

/* ---- Geometry: which texel's centre lies where ----------------------------------------------- */

static bool is_left(uint32_t x, uint32_t width)
{
    return 2 * x + 1 < width;
}
static bool is_low(uint32_t y, uint32_t height)
{
    return 2 * y + 1 < height;
}
static bool is_between(uint32_t y, uint32_t height) /* the rows of y < 0 and of y > 0 */
{
    return 2 * y + 1 == height;
}

void probe_check_color(const struct dt_runtime *runtime, void *rt, uint32_t width, uint32_t height)
{
    static const float back[4] = {0}, one[4] = {0.5f, 0, 0, 1}, zero[4] = {0.25f, 0.5f, 0.75f, 1};
    struct dt_bytes bytes = read_sized(runtime, rt, PROBE_COLOR, 0, width, height, 1, 16);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width && !is_between(y, height); x++)
            assert_memory_equal(bytes.data + ((size_t)y * width + x) * 16,
                                is_low(y, height)   ? one
                                : is_left(x, width) ? zero
                                                    : back,
                                16);
    free(bytes.data);
}

static float depth_at(uint32_t x, uint32_t y, uint32_t width, uint32_t height)
{
    return is_low(y, height) ? 0.25f : is_left(x, width) ? 0.5f : 1;
}

void probe_check_depth(const struct dt_runtime *runtime, void *rt, uint32_t width, uint32_t height)
{
    struct dt_bytes bytes = read_sized(runtime, rt, PROBE_DEPTH, 0, width, height, 1, 4);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width && !is_between(y, height); x++)
            assert_true(((float *)bytes.data)[(size_t)y * width + x] ==
                        depth_at(x, y, width, height));
    free(bytes.data);
}

/* ---- Layers ---------------------------------------------------------------------------------- */

/* The diagonal of the left quad, through centres, belongs to one of its triangles. */
static bool stack_value_ok(uint32_t x, uint32_t y, uint32_t layer, uint32_t value)
{
    bool front = x > 2 * y;      /* the clockwise triangle, nearest of all */
    bool quad = x < 8 && y >= 4; /* visible part of the left quad */
    uint32_t drawn = front || quad || y < 4 ? layer + 1 : 5;
    if (layer == 1 && front)
        return value == 22;
    if (quad && (layer == 1 || layer == 2)) {
        bool again = layer == 2 ? y < x : y > x;
        return value == (again ? layer + 21 : drawn) || (x == y && value == layer + 21);
    }
    return value == drawn;
}

void probe_check_stack(const struct dt_runtime *runtime, void *rt)
{
    const uint32_t width = PROBE_STACK_WIDTH, height = PROBE_STACK_HEIGHT;
    struct dt_bytes stack =
        read_sized(runtime, rt, PROBE_STACK, 0, width, height, PROBE_LAYER_COUNT, 4);
    struct dt_bytes depth =
        read_sized(runtime, rt, PROBE_STACK_DEPTH, 0, width, height, PROBE_LAYER_COUNT, 4);
    for (uint32_t i = 0; i < width * height * PROBE_LAYER_COUNT; i++) {
        uint32_t x = i % width, y = i / width % height, layer = i / width / height;
        uint32_t value = ((const uint32_t *)stack.data)[i];
        float found = ((const float *)depth.data)[i];
        if (!stack_value_ok(x, y, layer, value))
            fail_msg("stack %u,%u,%u is %u", x, y, layer, value);
        assert_true(found == (x > 2 * y ? 0.125f : y < 4 ? 0.25f : x < 8 ? 0.5f : 1));
    }
    free(stack.data);
    free(depth.data);
}

/* ---- Compute, fullscreen draws, clears ------------------------------------------------------- */

static void check_buffers(const struct dt_runtime *runtime, void *rt, uint32_t width,
                          uint32_t height, uint32_t frames, const struct probe_live *live)
{
    const uint32_t kept[6] = {4, 5, 6, 8, 9, 10};
    const uint32_t groups[3] = {(width + 7) / 8, (height + 7) / 8, 1}, none[3] = {0};
    struct dt_bytes bytes = read_sized(runtime, rt, PROBE_ROWS, 0, height, 1, 1, 4);
    for (uint32_t y = 0; y < height; y++)
        if (!is_between(y, height))
            assert_int_equal(((uint32_t *)bytes.data)[y],
                             is_low(y, height) ? 1000 * width : width / 2);
    free(bytes.data);
    bytes = read_sized(runtime, rt, PROBE_FRAMES, 0, 8, 1, 1, 4);
    assert_int_equal(((uint32_t *)bytes.data)[0], frames);
    assert_int_equal(((uint32_t *)bytes.data)[7], 0);
    free(bytes.data);
    bytes = read_sized(runtime, rt, PROBE_KEPT, 0, 6, 1, 1, 4);
    assert_memory_equal(bytes.data, kept, sizeof kept);
    free(bytes.data);
    bytes = read_sized(runtime, rt, PROBE_GROUPS, 0, 3, 1, 1, 4);
    assert_memory_equal(bytes.data, live->mask ? groups : none, sizeof groups);
    free(bytes.data);
}

/* Every level is made from the one before: texels, then means of four, then twice every second. */
static void check_levels(const struct dt_runtime *runtime, void *rt, uint32_t width,
                         uint32_t height)
{
    float levels[2][8][16] = {{{0}}};
    if (height % 2) /* the content of the middle row is not defined */
        return;
    for (uint32_t y = 0; y < 8; y++)
        for (uint32_t x = 0; x < 16; x++)
            levels[0][y][x] = depth_at(x % width, y % height, width, height);
    for (uint32_t y = 0; y < 4; y++)
        for (uint32_t x = 0; x < 8; x++)
            levels[1][y][x] = (levels[0][2 * y][2 * x] + levels[0][2 * y][2 * x + 1] +
                               levels[0][2 * y + 1][2 * x] + levels[0][2 * y + 1][2 * x + 1]) /
                              4;
    for (uint32_t mip = 0; mip < PROBE_MIPS; mip++) {
        uint32_t columns = 16 >> mip, rows = 8 >> mip;
        struct dt_bytes bytes = read_sized(runtime, rt, PROBE_LEVELS, mip, columns, rows, 1, 4);
        for (uint32_t i = 0; i < columns * rows; i++) {
            uint32_t x = i % columns, y = i / columns;
            float wanted = mip == 2 ? 2 * levels[1][2 * y][2 * x] : levels[mip][y][x];
            float found = ((float *)bytes.data)[i];
            if (fabsf(found - wanted) > (mip ? 4e-3f : 0)) /* a filter's weights have 8 bits */
                fail_msg("mip %u, %u,%u is %g, not %g", mip, x, y, (double)found, (double)wanted);
        }
        free(bytes.data);
    }
}

/* A code may be rounded up or down. */
static void check_codes(const uint8_t *found, double r, double g, double b, double a)
{
    const double wanted[4] = {r, g, b, a};
    for (int i = 0; i < 4; i++)
        if (fabs(found[i] - 255 * wanted[i]) > 1)
            fail_msg("component %d is %u, not %g", i, found[i], 255 * wanted[i]);
}

static void check_pictures(const struct dt_runtime *runtime, void *rt, uint32_t width,
                           uint32_t height, const struct probe_live *live)
{
    static const uint16_t halves[4] = {0x3c00, 0x4000, 0x4200, 0x4400}; /* 1 2 3 4 */
    struct dt_bytes bytes = read_sized(runtime, rt, PROBE_MASK, 0, width, height, 1, 4);
    for (uint32_t i = 0; i < width * height; i++)
        assert_true(((float *)bytes.data)[i] ==
                    (live->mask ? live->scale * (float)(i % width) : 7));
    free(bytes.data);
    bytes = read_sized(runtime, rt, PROBE_DISPLAY, 0, width, height, 1, 4);
    if (height > 1) {
        check_codes(bytes.data, 0.5, 0, 0, 1);
        check_codes(bytes.data + (size_t)(height - 1) * width * 4, 0.25, 0.5, 0.75, 1);
    }
    free(bytes.data);
    bytes = read_sized(runtime, rt, PROBE_GLOW, 0, width, height, 1, 4);
    for (uint32_t i = 0; i < width * height;
         i++) /* linear 0.5 is 0.7354 in sRGB; alpha is linear */
        if (live->glow)
            check_codes(bytes.data + 4 * i, 0.7354, 0, 1, 0.75);
        else
            check_codes(bytes.data + 4 * i, 0, 0, 0, 0.25);
    free(bytes.data);
    for (uint32_t mip = 0; mip < 2; mip++) {
        bytes = read_sized(runtime, rt, PROBE_CLEARED, mip, 5 >> mip, 4 >> mip, 2, 8);
        for (size_t i = 0; i < bytes.size; i += sizeof halves)
            assert_memory_equal(bytes.data + i, halves, sizeof halves);
        free(bytes.data);
    }
}

void probe_check_rest(const struct dt_runtime *runtime, void *rt, uint32_t width, uint32_t height,
                      uint32_t frames, const struct probe_live *live)
{
    check_buffers(runtime, rt, width, height, frames, live);
    check_levels(runtime, rt, width, height);
    check_pictures(runtime, rt, width, height, live);
}

static void check_spare(const struct dt_runtime *runtime, void *rt, int poison)
{
    for (uint32_t mip = 0; mip < PROBE_MIPS; mip++) {
        struct dt_bytes bytes =
            read_sized(runtime, rt, PROBE_SPARE, mip, 13 >> mip, 7 >> mip, 2, 4);
        for (size_t i = 0; i < bytes.size; i++)
            assert_int_equal(bytes.data[i], poison);
        free(bytes.data);
    }
}

/* ---- All of it ------------------------------------------------------------------------------- */

static void check_timings(const struct dt_runtime *runtime, void *rt, const struct probe_live *live)
{
    double ms[PROBE_PASSES];
    assert_true(runtime->timings(rt, ms));
    for (int pass = 0; pass < PROBE_PASSES; pass++) {
        bool off = pass == PROBE_SKIP || (pass == PROBE_MASK_PASS && !live->mask) ||
                   (pass == PROBE_GLOW_PASS && !live->glow);
        if (off ? !isnan(ms[pass]) : !(ms[pass] > 0 && ms[pass] < 3600e3))
            fail_msg("pass %s: %g ms", probe_pipeline.passes[pass].name, ms[pass]);
    }
}

static void run_size(const struct dt_runtime *runtime, void *rt, uint32_t width, uint32_t height)
{
    const struct probe_live run = {.mask = 1, .scale = 0.25f, .glow = 1}, off = {.scale = 0.25f};
    struct dt_frame frame = probe_frame(0);
    assert_true(runtime->resize(rt, width, height));
    check_spare(runtime, rt, 0xab);
    assert_true(runtime->render(rt, &frame, &run, NULL));
    probe_check_color(runtime, rt, width, height);
    probe_check_stack(runtime, rt);
    probe_check_rest(runtime, rt, width, height, 1, &run);
    check_timings(runtime, rt, &run);
    frame = probe_frame(1);
    assert_true(runtime->render(rt, &frame, &off, NULL));
    probe_check_stack(runtime, rt);
    probe_check_rest(runtime, rt, width, height, 1 + 101, &off);
    check_spare(runtime, rt, 0xab);
    check_timings(runtime, rt, &off);
}

void probe_run(const struct dt_runtime *runtime, const struct dt_runtime_options *options,
               const struct dt_shaders *shaders, const uint32_t *errors)
{
    static const uint32_t sizes[][2] = {{16, 8}, {40, 24}, {33, 17}, {1, 1}, {8, 8}};
    void *rt = runtime->open(options);
    assert_non_null(rt);
    assert_true(runtime->set_scene(rt, &probe_scene) && runtime->create(rt, shaders));
    for (size_t i = 0; i < DT_ARRAY_COUNT(sizes); i++)
        run_size(runtime, rt, sizes[i][0], sizes[i][1]);
    assert_int_equal(runtime->device(rt)->messages, 0);
    runtime->close(rt);
    assert_int_equal(*errors, 0);
}
