/* See formats.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/lib/unit.h"

#include "formats.h"
#include "shaders.h"

static struct dt_resource resources[FORMATS_RESOURCES] = {
    [FORMATS_SMALL] = {.name = "small", .kind = DT_BUFFER, .stride = 4},
    [FORMATS_ODD] = {.name = "odd", .kind = DT_BUFFER, .stride = 12},
};
static struct dt_storage storage[FORMATS_RESOURCES] = {
    [FORMATS_SMALL] = {.usage = DT_READ_STORAGE, .slot = FORMATS_SMALL, .share = -1},
    [FORMATS_ODD] = {.usage = DT_READ_STORAGE, .slot = FORMATS_ODD, .share = -1},
};

static const struct {
    const char *name;
    uint32_t size[3];
    enum dt_shape shape;
} kinds[] = {{"plain", {13, 7, 1}, DT_SHAPE_2D},
             {"layered", {13, 7, 2}, DT_SHAPE_2D},
             {"volume", {13, 7, 5}, DT_SHAPE_3D},
             {"cube", {7, 7, 6}, DT_SHAPE_CUBE},
             {"cubes", {7, 7, 12}, DT_SHAPE_CUBE_ARRAY}};

void formats_prepare(void)
{
    static char names[FORMATS_SMALL][16];
    for (uint32_t i = 0; i < FORMATS_SMALL; i++) {
        uint32_t kind = i / DT_FORMAT_COUNT;
        enum dt_format format = (enum dt_format)(i % DT_FORMAT_COUNT);
        if (kinds[kind].shape == DT_SHAPE_3D && format == DT_FORMAT_D32F)
            format = DT_FORMAT_R32F;
        snprintf(names[i], sizeof names[i], "%s_%u", kinds[kind].name, i % DT_FORMAT_COUNT);
        resources[i] = (struct dt_resource){.name = names[i],
                                            .kind = DT_IMAGE,
                                            .format = format,
                                            .mips = FORMATS_MIPS,
                                            .shape = kinds[kind].shape,
                                            .layered = kind > 0};
        storage[i] =
            (struct dt_storage){.usage = DT_READ_TEXTURE, .slot = (uint16_t)i, .share = -1};
    }
}

static uint32_t mip_count(uint32_t resource)
{
    return resource < FORMATS_SMALL ? FORMATS_MIPS : 1;
}

static void extent(const struct dt_pipeline *pipeline, uint32_t resource, uint32_t width,
                   uint32_t height, uint32_t size[3])
{
    (void)pipeline, (void)width, (void)height;
    dt_set_extent(size, resource == FORMATS_SMALL ? 1 : 13, 1, 1);
    if (resource < FORMATS_SMALL)
        memcpy(size, kinds[resource / DT_FORMAT_COUNT].size, sizeof kinds->size);
}

static uint64_t runs(const struct dt_pipeline *pipeline, uint32_t pass, uint32_t width,
                     uint32_t height, const void *live)
{
    (void)pipeline, (void)pass, (void)width, (void)height, (void)live;
    return 0;
}

static const struct dt_pass passes[] = {{.name = "idle", .kind = DT_PASS_DISPATCH}};
static const float live_defaults[4];
static const struct dt_pipeline pipeline = {
    .name = "formats",
    .resources = resources,
    .resource_count = FORMATS_RESOURCES,
    .passes = passes,
    .pass_count = 1,
    .live_defaults = live_defaults,
    .live_size = sizeof live_defaults,
    .block_size = sizeof live_defaults,
    .linear_output = -1,
    .display_output = -1,
    .extent = extent,
    .runs = runs,
};
static const struct dt_program programs[1];

static bool record(const struct dt_recording *r)
{
    return r->verbs->begin(r->runtime, 0, true) && r->verbs->end(r->runtime, 0);
}

static const struct dt_panel panel = {
    .version = DT_VERSION,
    .pipeline = &pipeline,
    .storage = storage,
    .programs = programs,
    .slot_count = FORMATS_RESOURCES,
    .record = record,
};

static const struct dt_stages gl_stages[] = {
    {.compute = {gl_idle_comp, sizeof gl_idle_comp, NULL}}};
static const struct dt_stages vk_stages[] = {{.compute = {idle_comp, sizeof idle_comp, NULL}}};
const struct dt_shaders formats_gl = {"gl", &panel, gl_stages};
const struct dt_shaders formats_vk = {"vk", &panel, vk_stages};

/* ---- Bytes ----------------------------------------------------------------------------------- */

/* Covers all bit patterns of 16 bit numbers, and NaNs with payload: quiet and signalling, in half
 * and single precision. Depth is 0..1, as written by a pass. */
static void fill(struct dt_bytes *bytes, bool depth, uint32_t seed)
{
    static const uint32_t nans[] = {0x7fc12345, 0xffa54321, 0x7d557eaa, 0xfe01fc01, 0x7f800001};
    uint32_t state = seed * 2654435761u + 1;
    for (size_t i = 0; i < bytes->size; i++) {
        state = state * 1664525u + 1013904223u;
        bytes->data[i] = (uint8_t)(state >> 24);
    }
    if (!depth && bytes->size >= sizeof nans)
        memcpy(bytes->data, nans, sizeof nans);
    for (size_t i = 0; depth && i < bytes->size / 4; i++) {
        float value = (float)((i * 37 + seed) % 1025) / 1024;
        memcpy(bytes->data + 4 * i, &value, 4);
    }
}

static bool is_depth(uint32_t resource)
{
    return resource < FORMATS_SMALL && resources[resource].format == DT_FORMAT_D32F;
}

/* Writes all mips of all resources first, then reads them. */
static void write_all(const struct dt_runtime *runtime, void *rt,
                      struct dt_bytes written[][FORMATS_MIPS])
{
    for (uint32_t i = 0; i < FORMATS_RESOURCES; i++) {
        for (uint32_t mip = 0; mip < mip_count(i); mip++) {
            struct dt_bytes *bytes = &written[i][mip];
            assert_true(runtime->read(rt, i, mip, bytes)); /* for its size */
            fill(bytes, is_depth(i), i * FORMATS_MIPS + mip);
            assert_true(runtime->write(rt, i, mip, bytes));
        }
    }
}

static void check_all(const struct dt_runtime *runtime, void *rt,
                      struct dt_bytes written[][FORMATS_MIPS])
{
    for (uint32_t i = 0; i < FORMATS_RESOURCES; i++) {
        for (uint32_t mip = 0; mip < mip_count(i); mip++) {
            struct dt_bytes bytes;
            assert_true(runtime->read(rt, i, mip, &bytes));
            if (memcmp(bytes.data, written[i][mip].data, bytes.size) != 0)
                fail_msg("%s, mip %u: not what was written", resources[i].name, mip);
            free(bytes.data);
        }
    }
}

void formats_run(const struct dt_runtime *runtime, const struct dt_runtime_options *options,
                 const struct dt_shaders *shaders, const uint32_t *errors)
{
    static struct dt_bytes written[FORMATS_RESOURCES][FORMATS_MIPS];
    const struct dt_frame frame = {.index = 0};
    void *rt = runtime->open(options);
    assert_non_null(rt);
    assert_true(runtime->create(rt, shaders) && runtime->resize(rt, 16, 16));
    write_all(runtime, rt, written);
    check_all(runtime, rt, written);
    assert_true(runtime->render(rt, &frame, NULL, NULL)); /* the frame touches nothing */
    check_all(runtime, rt, written);
    for (uint32_t i = 0; i < FORMATS_RESOURCES; i++)
        for (uint32_t mip = 0; mip < mip_count(i); mip++)
            free(written[i][mip].data);
    assert_int_equal(runtime->device(rt)->messages, 0);
    runtime->close(rt);
    assert_int_equal(*errors, 0);
}
