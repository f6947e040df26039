/* The Vulkan runtime's own parts: barriers that can be left out, devices and their features, and
 * memory that runs out. runtime_test.c has the parts in common with OpenGL. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <dlfcn.h>
#include "tests/lib/unit.h"
#include "drop.h"
#include "formats.h"
#include "probe.h"
#include "runtime_vk/internal.h"

/* ---- Errors, logged and injected ------------------------------------------------------------- */

static int fail_allocation; /* the n-th vkAllocateMemory from now on fails; 0: none */

/* Replaces the loader's function of that name. */
VkResult vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo *pAllocateInfo,
                          const VkAllocationCallbacks *pAllocator, VkDeviceMemory *pMemory)
{
    PFN_vkAllocateMemory real;
    *(void **)&real = dlsym(RTLD_NEXT, "vkAllocateMemory");
    if (fail_allocation && --fail_allocation == 0)
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return real(device, pAllocateInfo, pAllocator, pMemory);
}

static bool lacks_geometry; /* the device reports no geometry shaders */

void vkGetPhysicalDeviceFeatures2(VkPhysicalDevice physicalDevice,
                                  VkPhysicalDeviceFeatures2 *pFeatures)
{
    PFN_vkGetPhysicalDeviceFeatures2 real;
    *(void **)&real = dlsym(RTLD_NEXT, "vkGetPhysicalDeviceFeatures2");
    real(physicalDevice, pFeatures);
    if (lacks_geometry)
        pFeatures->features.geometryShader = VK_FALSE;
}

static void *open_ready(void)
{
    probe_heard.errors = 0;
    void *rt = runtime_vk.open(
        &(struct dt_runtime_options){.log = {.message = probe_hear}, .debug = true});
    assert_non_null(rt);
    assert_true(runtime_vk.set_scene(rt, &probe_scene) && runtime_vk.create(rt, &probe_vk));
    return rt;
}

/* ---- Barriers -------------------------------------------------------------------------------- */

/* Whether the last message contains `what`. Newer layers write READ_AFTER_WRITE for
 * SYNC-HAZARD-READ-AFTER-WRITE. */
static bool is_heard(const char *what)
{
    char other[64];
    snprintf(other, sizeof other, "%s", what);
    for (char *at = other; *at; at++)
        *at = *at == '-' ? '_' : *at;
    return strstr(probe_heard.last, what) || strstr(probe_heard.last, other);
}

static void drop(enum drop change, uint32_t number, const char *hazard)
{
    struct dt_frame frame = probe_frame(0);
    void *rt = open_ready();
    assert_true(runtime_vk.resize(rt, 16, 8));
    assert_int_equal(probe_heard.errors, 0);
    drop_next(rt, change, number);
    assert_true(runtime_vk.render(rt, &frame, NULL, NULL));
    assert_true(runtime_vk.device(rt)->messages > 0);
    assert_true(is_heard(hazard));
    runtime_vk.close(rt);
}

/* The frame's barriers in the order of recording: 1 color and 2 depth of the scene pass, 3 and 4 of the
 * layers, 5 draws, 6 stack and 7 stack_depth of the second draw into them, 8 kept, 9 and 10 of the third, 11
 * color of the count pass, 12 depth and 13 levels, 14 and 15 levels, 16 groups and 17 mask, 18 color and 19
 * display, 20 glow, 21 cleared. */
TEST(a_dropped_barrier_is_missed)
{
    drop(DROP_BARRIER, 5, "READ-AFTER-WRITE");
    drop(DROP_BARRIER, 11, "VUID-VkImageMemoryBarrier2-oldLayout-01197");
    drop(DROP_BARRIER, 14, "READ-AFTER-WRITE");
    drop(DROP_BARRIER, 16, "READ-AFTER-WRITE");
    drop(DROP_BARRIER, 17, "IMAGE_LAYOUT");
    drop(DROP_DEPENDENCY, 18, "WRITE-AFTER-READ"); /* color is read by the pass before */
}

/* Checks that validation can fail, since its silence means nothing otherwise. The mask pass reads
 * its groups as arguments without a barrier after the pass that wrote them. */
static bool forgetful_record(const struct dt_recording *r)
{
    static const struct dt_barrier barrier = {PROBE_MASK,       DT_STAGE_COMPUTE, 0,
                                              DT_STAGE_COMPUTE, DT_WRITE_STORAGE, DT_LAYOUT_GENERAL,
                                              DT_DISCARD};
    const struct dt_verbs *v = r->verbs;
    return v->begin(r->runtime, PROBE_PLAN, true) && v->bind(r->runtime, PROBE_PLAN) &&
           v->dispatch(r->runtime, PROBE_PLAN, 1, 1, 1) && v->end(r->runtime, PROBE_PLAN) &&
           v->begin(r->runtime, PROBE_MASK_PASS, true) &&
           v->barriers(r->runtime, PROBE_MASK_PASS, &barrier, 1) &&
           v->bind(r->runtime, PROBE_MASK_PASS) &&
           v->dispatch_indirect(r->runtime, PROBE_MASK_PASS, PROBE_GROUPS) &&
           v->end(r->runtime, PROBE_MASK_PASS);
}

TEST(a_missing_barrier_is_heard)
{
    struct dt_panel panel = probe_panel;
    const struct dt_shaders forgetful = {"vk", &panel, probe_vk_stages};
    struct dt_frame frame = probe_frame(0);
    void *rt = open_ready();
    panel.record = forgetful_record;
    assert_true(runtime_vk.create(rt, &forgetful) && runtime_vk.resize(rt, 16, 8));
    assert_int_equal(runtime_vk.device(rt)->messages, 0);
    runtime_vk.render(rt, &frame, NULL, NULL);
    assert_true(runtime_vk.device(rt)->messages > 0);
    assert_true(is_heard("READ-AFTER-WRITE"));
    runtime_vk.close(rt);
}

/* Reading and writing keep the layout, since a pass without a barrier of its own relies on it. The
 * poison leaves images GENERAL. */
TEST(reading_and_writing_keep_the_layout)
{
    probe_heard.errors = 0;
    formats_prepare();
    void *rt = runtime_vk.open(&(struct dt_runtime_options){
        .log = {.message = probe_hear}, .debug = true, .poison = 0x3c});
    assert_true(rt && runtime_vk.create(rt, &formats_vk) && runtime_vk.resize(rt, 8, 8));
    for (uint32_t i = 0; i < FORMATS_SMALL; i++) {
        const struct vk_image *image = &vk_resource_at(rt, i)->image;
        struct dt_bytes bytes;
        assert_int_equal(image->layout, VK_IMAGE_LAYOUT_GENERAL);
        assert_true(runtime_vk.read(rt, i, 1, &bytes));
        assert_int_equal(image->layout, VK_IMAGE_LAYOUT_GENERAL);
        assert_true(runtime_vk.write(rt, i, 1, &bytes));
        assert_int_equal(image->layout, VK_IMAGE_LAYOUT_GENERAL);
        free(bytes.data);
    }
    assert_int_equal(runtime_vk.device(rt)->messages, 0);
    runtime_vk.close(rt);
    assert_int_equal(probe_heard.errors, 0);
}

/* ---- Devices --------------------------------------------------------------------------------- */

TEST(an_unknown_device_is_named_and_the_known_are_listed)
{
    struct dt_runtime_options options = {.log = {.message = probe_hear}, .device = "voodoo"};
    probe_heard.errors = 0;
    assert_null(runtime_vk.open(&options));
    assert_int_equal(probe_heard.errors, 1);
    assert_non_null(strstr(probe_heard.last, "no Vulkan device is called `voodoo`"));
    assert_non_null(strstr(probe_heard.last, "0: "));
    options.device = "99";
    assert_null(runtime_vk.open(&options));
    options.device = "0";
    void *rt = runtime_vk.open(&options);
    assert_non_null(rt);
    char name[256];
    snprintf(name, sizeof name, "%s", runtime_vk.device(rt)->name);
    runtime_vk.close(rt);
    options.device = name;
    rt = runtime_vk.open(&options);
    assert_non_null(rt);
    assert_string_equal(runtime_vk.device(rt)->name, name);
    runtime_vk.close(rt);
    assert_int_equal(probe_heard.errors, 2);
}

/* The runtime refuses a device only for a pipeline with a pass that needs a feature the device
 * lacks. The pipeline before stays. */
TEST(a_feature_is_asked_for_by_the_pass_that_needs_it)
{
    static const struct dt_need needs[] = {{PROBE_SCENE, "fullDrawIndexUint32"},
                                           {PROBE_MASK_PASS, "geometryShader"}};
    struct dt_panel panel = probe_panel;
    const struct dt_shaders needy = {"vk", &panel, probe_vk_stages};
    const struct dt_runtime_options options = {.log = {.message = probe_hear}, .panel = &panel};
    struct dt_frame frame = probe_frame(0);
    panel.needs = needs;
    panel.need_count = DT_ARRAY_COUNT(needs);
    void *rt = open_ready();
    assert_true(runtime_vk.create(rt, &needy));
    runtime_vk.close(rt);
    lacks_geometry = true;
    rt = open_ready();
    assert_int_equal(probe_heard.errors, 0);
    assert_true(runtime_vk.resize(rt, 16, 8));
    assert_false(runtime_vk.create(rt, &needy));
    assert_int_equal(probe_heard.errors, 1);
    assert_non_null(strstr(probe_heard.last, "pass mask: needs geometryShader, which "));
    assert_non_null(strstr(probe_heard.last, "; use another device"));
    assert_true(runtime_vk.render(rt, &frame, NULL, NULL));
    probe_check_color(&runtime_vk, rt, 16, 8);
    runtime_vk.close(rt);
    assert_null(runtime_vk.open(&options));
    assert_non_null(strstr(probe_heard.last, ": missing geometryShader (pass mask); update "));
    lacks_geometry = false;
    assert_int_equal(probe_heard.errors, 2);
    rt = runtime_vk.open(&options);
    assert_non_null(rt);
    runtime_vk.close(rt);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Fails the first, second, ... allocation until everything works. Each failure gives one error and
 * leaves nothing behind. The validation layers would report leftovers when the device is
 * destroyed. */
TEST(out_of_memory_is_one_error_and_a_clean_end)
{
    bool done = false;
    int attempts = 0;
    while (!done) {
        probe_heard.errors = 0;
        fail_allocation = ++attempts;
        struct dt_frame frame = probe_frame(0);
        struct dt_bytes bytes = {0};
        void *rt = runtime_vk.open(&(struct dt_runtime_options){
            .log = {.message = probe_hear}, .debug = true, .timing = true, .poison = 1});
        done = rt && runtime_vk.set_scene(rt, &probe_scene) && runtime_vk.create(rt, &probe_vk) &&
               runtime_vk.resize(rt, 16, 8) && runtime_vk.render(rt, &frame, NULL, NULL) &&
               runtime_vk.read(rt, PROBE_COLOR, 0, &bytes);
        free(bytes.data);
        runtime_vk.close(rt);
        assert_int_equal(probe_heard.errors, done ? 0 : 1);
        if (!done)
            assert_non_null(strstr(probe_heard.last, ": VK_ERROR_OUT_OF_DEVICE_MEMORY: use "));
    }
    assert_true(attempts > 10);
    fail_allocation = 0;
}

/* After a resize that failed the next one starts anew. */
TEST(a_resize_without_memory_can_be_tried_again)
{
    struct dt_frame frame = probe_frame(0);
    struct dt_bytes bytes;
    void *rt = open_ready();
    for (int n = 1; n < 16; n++) {
        fail_allocation = n;
        if (runtime_vk.resize(rt, 16, 8))
            continue;
        assert_int_equal(probe_heard.errors, 1);
        assert_false(runtime_vk.render(rt, &frame, NULL, NULL));
        assert_non_null(strstr(probe_heard.last, "call resize first"));
        assert_false(runtime_vk.read(rt, PROBE_COLOR, 0, &bytes));
        assert_non_null(strstr(probe_heard.last, "read color: it does not exist yet"));
        probe_heard.errors = 0;
    }
    fail_allocation = 0;
    assert_true(runtime_vk.resize(rt, 16, 8) && runtime_vk.render(rt, &frame, NULL, NULL));
    probe_check_color(&runtime_vk, rt, 16, 8);
    assert_int_equal(runtime_vk.device(rt)->messages, 0);
    runtime_vk.close(rt);
    assert_int_equal(probe_heard.errors, 0);
}

/* Shaders compute length() from the bytes that are bound. */
TEST(of_a_range_only_the_indices_are_bound)
{
    probe_heard.errors = 0;
    struct dt_vk_runtime *rt = runtime_vk.open(
        &(struct dt_runtime_options){.log = {.message = probe_hear}, .debug = true});
    const struct vk_buffer_info info = {.name = "whole",
                                        .size = 1 << 20,
                                        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                                 VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                                                 VK_BUFFER_USAGE_INDEX_BUFFER_BIT};
    struct vk_buffer whole = {0};
    assert_true(rt && vk_buffer_create_own(rt, &whole, &info, false));
    const struct dt_vk_scene scene = {
        .vertices = {whole.handle, 0, 4 * sizeof(struct dt_vertex)},
        .indices = {whole.handle, 0, 1 << 20},
        .index_count = 3,
        .materials = {whole.handle, 4096, DT_MAX_MATERIALS * sizeof(struct dt_material)},
    };
    assert_true(dt_vk_import_scene(rt, &scene));
    assert_int_equal(vk_buffer_at(rt, DT_SCENE_INDICES)->size, 3 * sizeof(uint32_t));
    assert_int_equal(vk_buffer_at(rt, DT_SCENE_VERTICES)->size, 4 * sizeof(struct dt_vertex));
    vk_buffer_destroy(rt, &whole);
    runtime_vk.close(rt);
    assert_int_equal(probe_heard.errors, 0);
}

RUN_TESTS("runtime_vk", NULL, NULL)
