/* The verb write of both runtimes: what is written is read back, bit for bit, in every format and
 * mip, and nothing beside it changes. The panels have no pass that does anything; the bytes come
 * from here. Validation, with synchronization checking, and KHR_debug must stay silent. */
#include <glob.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime_gl/runtime.h"
#include "runtime_vk/runtime.h"

/* An image of every format, plain and layered; then buffers, of which the first is smaller than
 * any that the runtimes make. */
enum {
    MIPS = 3,
    LAYERS = 2,
    PLAIN = 0,
    LAYERED = DT_FORMAT_COUNT,
    SMALL = 2 * DT_FORMAT_COUNT,
    ODD,
    RESOURCES
};

static void extent_of(uint32_t index, uint32_t extent[3])
{
    extent[0] = index == SMALL ? 1 : 13;
    extent[1] = index >= SMALL ? 1 : 7;
    extent[2] = index >= LAYERED && index < SMALL ? LAYERS : 1;
}
static void plain_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width, (void)height;
    extent_of(PLAIN, extent);
}
static void layered_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width, (void)height;
    extent_of(LAYERED, extent);
}
static void small_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width, (void)height;
    extent_of(SMALL, extent);
}
static void odd_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width, (void)height;
    extent_of(ODD, extent);
}

static struct dt_resource resources[RESOURCES] = {
    [SMALL] = {.name = "small", .kind = DT_BUFFER, .stride = 4, .extent = small_extent},
    [ODD] = {.name = "odd", .kind = DT_BUFFER, .stride = 12, .extent = odd_extent},
};

static int name_resources(void **state)
{
    static char names[SMALL][16];
    (void)state;
    for (uint32_t i = 0; i < SMALL; i++) {
        snprintf(names[i], sizeof names[i], "%s_%u", i < LAYERED ? "plain" : "layered",
                 i % DT_FORMAT_COUNT);
        resources[i] = (struct dt_resource){
            .name = names[i],
            .kind = DT_IMAGE,
            .format = (enum dt_format)(i % DT_FORMAT_COUNT),
            .mips = MIPS,
            .layered = i >= LAYERED,
            .extent = i < LAYERED ? plain_extent : layered_extent,
        };
    }
    return 0;
}

static const struct dt_pass passes[] = {{.name = "idle"}};
static const float live_defaults[4];
static const struct dt_pipeline pipeline = {
    .name = "formats",
    .resources = resources,
    .resource_count = RESOURCES,
    .passes = passes,
    .pass_count = 1,
    .live_defaults = live_defaults,
    .live_size = sizeof live_defaults,
    .block_size = sizeof live_defaults,
};

static bool create(void *runtime, void *place)
{
    (void)runtime, (void)place;
    return true;
}

/* ---- OpenGL ---------------------------------------------------------------------------------- */

struct gl_state {
    struct gl_image images[SMALL];
    struct gl_buffer buffers[RESOURCES];
};

static void gl_destroy(void *rt, void *place)
{
    struct gl_state *state = place;
    for (uint32_t i = 0; i < SMALL; i++)
        dt_gl_image_destroy(rt, &state->images[i]);
    for (uint32_t i = SMALL; i < RESOURCES; i++)
        dt_gl_buffer_destroy(rt, &state->buffers[i]);
}

static bool gl_resize(void *rt, void *place, uint32_t width, uint32_t height)
{
    struct gl_state *state = place;
    (void)width, (void)height;
    for (uint32_t i = 0; i < RESOURCES; i++) {
        const struct dt_resource *r = &resources[i];
        uint32_t e[3];
        extent_of(i, e);
        const struct gl_image_info image = {r->name, r->format, e[0],       e[1],
                                            e[2],    r->mips,   r->layered, NULL};
        const struct gl_buffer_info buffer = {.name = r->name,
                                              .size = (GLsizeiptr)e[0] * r->stride};
        if (!(i < SMALL ? dt_gl_image_create(rt, &state->images[i], &image)
                        : dt_gl_buffer_create(rt, &state->buffers[i], &buffer)))
            return false;
    }
    return true;
}

static bool gl_record(void *rt, void *place, const void *live)
{
    (void)place, (void)live;
    return dt_gl_pass_begin(rt, 0, true) && dt_gl_pass_end(rt, 0);
}

static void *gl_resource(void *place, uint32_t index)
{
    struct gl_state *state = place;
    return index < SMALL ? (void *)&state->images[index] : (void *)&state->buffers[index];
}

static const struct dt_panel gl_panel = {
    .backend = "gl",
    .pipeline = &pipeline,
    .state_size = sizeof(struct gl_state),
    .create = create,
    .resize = gl_resize,
    .record = gl_record,
    .resource = gl_resource,
    .destroy = gl_destroy,
};

/* ---- Vulkan ---------------------------------------------------------------------------------- */

struct vk_state {
    struct vk_image images[SMALL];
    struct vk_buffer buffers[RESOURCES];
    struct vk_slot slots[RESOURCES];
};

static void vk_destroy(void *rt, void *place)
{
    struct vk_state *state = place;
    for (uint32_t i = 0; i < RESOURCES; i++) {
        if (i < SMALL)
            dt_vk_image_destroy(rt, &state->images[i]);
        else
            dt_vk_buffer_destroy(rt, &state->buffers[i]);
        dt_vk_slot_destroy(rt, &state->slots[i]);
    }
}

static bool vk_make(void *rt, struct vk_state *state, uint32_t i)
{
    const struct dt_resource *r = &resources[i];
    uint32_t e[3];
    extent_of(i, e);
    const struct vk_image_info image = {
        r->name, r->format, VK_IMAGE_USAGE_SAMPLED_BIT, e[0], e[1], e[2], r->mips, r->layered};
    const struct vk_buffer_info buffer = {.name = r->name,
                                          .size = (VkDeviceSize)e[0] * r->stride,
                                          .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
    const struct vk_slot_user user = {.image = i < SMALL ? &state->images[i] : NULL,
                                      .buffer = i < SMALL ? NULL : &state->buffers[i]};
    return (i < SMALL ? dt_vk_image_create(rt, &state->images[i], &image)
                      : dt_vk_buffer_create(rt, &state->buffers[i], &buffer)) &&
           dt_vk_slot_bind(rt, &state->slots[i], &user, 1) && dt_vk_initialise(rt, &user, false);
}

static struct vk_state *vk_present; /* whose layouts a test looks at */

static bool vk_resize(void *rt, void *place, uint32_t width, uint32_t height)
{
    (void)width, (void)height;
    vk_present = place;
    for (uint32_t i = 0; i < RESOURCES; i++)
        if (!vk_make(rt, place, i))
            return false;
    return true;
}

static bool vk_record(void *rt, void *place, const void *live)
{
    (void)place, (void)live;
    return dt_vk_pass_begin(rt, 0, true) && dt_vk_pass_end(rt, 0);
}

static void *vk_resource(void *place, uint32_t index)
{
    struct vk_state *state = place;
    return index < SMALL ? (void *)&state->images[index] : (void *)&state->buffers[index];
}

static const struct dt_panel vk_panel = {
    .backend = "vk",
    .pipeline = &pipeline,
    .state_size = sizeof(struct vk_state),
    .create = create,
    .resize = vk_resize,
    .record = vk_record,
    .resource = vk_resource,
    .destroy = vk_destroy,
};

/* ---- Tests ----------------------------------------------------------------------------------- */

static struct {
    uint32_t errors;
    char last[1024];
} heard;

static void on_message(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level != DT_ERROR)
        return;
    heard.errors++;
    snprintf(heard.last, sizeof heard.last, "%s", message);
    print_message("# %s\n", message);
}

static void expect_error(const char *part)
{
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.last, part));
    heard.errors = 0;
}

struct bench {
    const struct dt_runtime *runtime;
    const struct dt_panel *panel;
    const char *context;
};

static void *open_ready(const struct bench *bench)
{
    static const struct dt_vertex vertex;
    static const uint32_t indices[3];
    static const struct dt_material material;
    static const uint8_t texel[4];
    const struct dt_scene scene = {&vertex, 1, indices, 3, &material, 1, texel, 1, 1, 1, 1};
    heard.errors = 0;
    void *rt = bench->runtime->open(&(struct dt_runtime_options){
        .log = {.message = on_message}, .context = bench->context, .debug = true, .poison = 0x3c});
    assert_non_null(rt);
    assert_true(bench->runtime->set_scene(rt, &scene));
    assert_true(bench->runtime->create(rt, bench->panel));
    assert_true(bench->runtime->resize(rt, 16, 16));
    return rt;
}

/* Every bit pattern of a 16 bit number comes up sooner or later, and NaNs that carry something:
 * quiet and signalling, in half and single precision. Depth is 0..1, as of a pass. */
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

static bool is_depth(uint32_t index)
{
    return index < SMALL && resources[index].format == DT_FORMAT_D32F;
}

static uint32_t mips_of(uint32_t index)
{
    return index < SMALL ? MIPS : 1;
}

/* What was written is `written`; all mips of all resources are written, and only then read. */
static void write_all(const struct bench *bench, void *rt, struct dt_bytes written[][MIPS])
{
    for (uint32_t i = 0; i < RESOURCES; i++) {
        for (uint32_t mip = 0; mip < mips_of(i); mip++) {
            struct dt_bytes *bytes = &written[i][mip];
            assert_true(bench->runtime->read(rt, i, mip, bytes)); /* for its size */
            fill(bytes, is_depth(i), i * MIPS + mip);
            assert_true(bench->runtime->write(rt, i, mip, bytes));
        }
    }
}

static void check_all(const struct bench *bench, void *rt, struct dt_bytes written[][MIPS])
{
    for (uint32_t i = 0; i < RESOURCES; i++) {
        for (uint32_t mip = 0; mip < mips_of(i); mip++) {
            struct dt_bytes bytes;
            assert_true(bench->runtime->read(rt, i, mip, &bytes));
            if (memcmp(bytes.data, written[i][mip].data, bytes.size) != 0)
                print_error("%s, mip %u\n", resources[i].name, mip);
            assert_memory_equal(bytes.data, written[i][mip].data, bytes.size);
            free(bytes.data);
        }
    }
}

static void round_trip(const struct bench *bench)
{
    static struct dt_bytes written[RESOURCES][MIPS];
    void *rt = open_ready(bench);
    const struct dt_frame frame = {.index = 0};
    write_all(bench, rt, written);
    check_all(bench, rt, written);
    assert_true(bench->runtime->render(rt, &frame, NULL, NULL)); /* which touches nothing */
    check_all(bench, rt, written);
    for (uint32_t i = 0; i < RESOURCES; i++)
        for (uint32_t mip = 0; mip < mips_of(i); mip++)
            free(written[i][mip].data);
    assert_int_equal(bench->runtime->messages(rt), 0);
    bench->runtime->close(rt);
    assert_int_equal(heard.errors, 0);
}

/* Bytes of another resource or mip are refused and change nothing. */
static void refusals(const struct bench *bench)
{
    void *rt = open_ready(bench);
    const struct dt_runtime *runtime = bench->runtime;
    struct dt_bytes bytes, before, after;
    assert_true(runtime->read(rt, LAYERED + DT_FORMAT_RG8, 1, &bytes)); /* 6x3x2, two bytes */
    assert_true(runtime->read(rt, LAYERED + DT_FORMAT_RG8, 0, &before));
    memset(bytes.data, 0x55, bytes.size);
    assert_false(runtime->write(rt, LAYERED + DT_FORMAT_RG8, 0, &bytes));
    expect_error("write layered_1: 72 bytes of 6x3x2, but it takes 364 of 13x7x2");
    assert_false(runtime->write(rt, LAYERED + DT_FORMAT_RGBA8, 1, &bytes));
    expect_error("write layered_2: 72 bytes of 6x3x2, but it takes 144 of 6x3x2");
    bytes.extent[0] = 3, bytes.extent[1] = 6;
    assert_false(runtime->write(rt, LAYERED + DT_FORMAT_RG8, 1, &bytes));
    expect_error("write layered_1: 72 bytes of 3x6x2, but it takes 72 of 6x3x2");
    assert_false(runtime->write(rt, LAYERED + DT_FORMAT_RG8, 3, &bytes));
    expect_error("write layered_1: mip 3, and it has 3");
    assert_false(runtime->write(rt, ODD, 1, &bytes));
    expect_error("write odd: mip 1, and it has 1");
    assert_false(runtime->write(rt, ODD, 0, &bytes));
    expect_error("write odd: 72 bytes of 3x6x2, but it takes 156 of 13x1x1");
    assert_false(runtime->write(rt, RESOURCES, 0, &bytes));
    expect_error("write: the pipeline has no resource 32");
    struct dt_bytes depth;
    assert_true(runtime->read(rt, PLAIN + DT_FORMAT_D32F, 2, &depth)); /* 3x1 */
    memcpy(depth.data, (const float[]){0.0f, 1.0f, 1.0000001f}, 12);
    assert_false(runtime->write(rt, PLAIN + DT_FORMAT_D32F, 2, &depth));
    expect_error("write plain_14: texel 2 is 1.00000012, but a depth is 0 to 1");
    free(depth.data);
    assert_true(runtime->read(rt, LAYERED + DT_FORMAT_RG8, 0, &after));
    assert_memory_equal(before.data, after.data, before.size);
    free(bytes.data);
    free(before.data);
    free(after.data);
    runtime->close(rt);
    assert_int_equal(heard.errors, 0);
}

static const struct bench egl = {&runtime_gl, &gl_panel, "egl"};
static const struct bench osmesa = {&runtime_gl, &gl_panel, "osmesa"};
static const struct bench zink = {&runtime_gl, &gl_panel, "zink"};
static const struct bench vk = {&runtime_vk, &vk_panel, NULL};

static void opengl_reads_what_was_written(void **state)
{
    (void)state;
    round_trip(&egl);
}
static void osmesa_reads_what_was_written(void **state)
{
    (void)state;
    round_trip(&osmesa);
}
static void vulkan_reads_what_was_written(void **state)
{
    (void)state;
    round_trip(&vk);
}

/* A pass that comes without a barrier of its own relies on it. Poison left GENERAL. */
static void vulkan_keeps_the_layout(void **state)
{
    (void)state;
    void *rt = open_ready(&vk);
    for (uint32_t i = 0; i < SMALL; i++) {
        struct dt_bytes bytes;
        assert_int_equal(vk_present->images[i].layout, VK_IMAGE_LAYOUT_GENERAL);
        assert_true(runtime_vk.read(rt, i, 1, &bytes));
        assert_int_equal(vk_present->images[i].layout, VK_IMAGE_LAYOUT_GENERAL);
        assert_true(runtime_vk.write(rt, i, 1, &bytes));
        assert_int_equal(vk_present->images[i].layout, VK_IMAGE_LAYOUT_GENERAL);
        free(bytes.data);
    }
    assert_int_equal(runtime_vk.messages(rt), 0);
    runtime_vk.close(rt);
    assert_int_equal(heard.errors, 0);
}
static void zink_itself(void **state)
{
    (void)state;
    round_trip(&zink);
}

/* Mesa has one OpenGL driver in a process: zink has one of its own, this program with an
 * argument. */
static void zink_reads_what_was_written(void **state)
{
    (void)state;
    glob_t found;
    bool installed = glob("/usr/lib/*/dri/zink_dri.so", 0, NULL, &found) == 0;
    globfree(&found);
    if (!installed) {
        print_message("# no /usr/lib/*/dri/zink_dri.so: install libgl1-mesa-dri\n");
        skip();
    }
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setenv("CMOCKA_MESSAGE_OUTPUT", "STDOUT", 1); /* its results are one of ours */
        execl("/proc/self/exe", "write_test", "zink", NULL);
        _exit(127);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void opengl_refuses_what_does_not_fit(void **state)
{
    (void)state;
    refusals(&egl);
}
static void vulkan_refuses_what_does_not_fit(void **state)
{
    (void)state;
    refusals(&vk);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest alone[] = {cmocka_unit_test(zink_itself)};
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zink_reads_what_was_written),
        cmocka_unit_test(opengl_reads_what_was_written),
        cmocka_unit_test(osmesa_reads_what_was_written),
        cmocka_unit_test(vulkan_reads_what_was_written),
        cmocka_unit_test(vulkan_keeps_the_layout),
        cmocka_unit_test(opengl_refuses_what_does_not_fit),
        cmocka_unit_test(vulkan_refuses_what_does_not_fit),
    };
    if (count > 1 && strcmp(arguments[1], "zink") == 0)
        return cmocka_run_group_tests_name("write, zink", alone, name_resources, NULL);
    return cmocka_run_group_tests_name("write", tests, name_resources, NULL);
}
