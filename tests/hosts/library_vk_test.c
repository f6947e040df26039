/* The Vulkan library on a device of the host's: wrong hosts and wrong calls, vertices of another
 * layout, history, times. A frame that is never submitted leaves no trace. install_test.sh compares
 * the pictures with those of the command. */
#include <math.h>
#include <string.h>

#include "layouts.h"
#include "library_vk.h"
#include "shapes.h"

TEST_WITH(vulkan_tells_wrong_hosts, NULL, is_silent)
{
    struct dt_vk_host host = vk_host();
    host.device = VK_NULL_HANDLE;
    REFUSED(dt_vk_open(&host), "device");
    host = vk_host();
    host.queue_family = 99;
    REFUSED(dt_vk_open(&host), "queue family 99");
    host.log.message = NULL;
    assert_null(dt_vk_open(&host)); /* in silence */
    dt_vk_close(NULL);
}

/* dt_vk_suits works without a VkDevice. */
TEST_WITH(vulkan_tells_which_device_suits, NULL, is_silent)
{
    struct dt_vk_host host = {.log = test_log,
                              .instance = vk.instance,
                              .physical_device = vk.physical,
                              .get_instance_proc_addr = vkGetInstanceProcAddr};
    const struct dt_need need = {FEATURES_PASS_SLICE, "shaderClairvoyance"};
    struct dt_panel panel = features_panel;
    const struct dt_shaders needy = {"vk", &panel, features_vk.stages};
    assert_true(dt_vk_suits(&host, &features_vk) && dt_vk_suits(&host, &shapes_vk));
    panel.needs = &need;
    panel.need_count = 1;
    REFUSED(dt_vk_suits(&host, &needy),
            "pipeline features: missing shaderClairvoyance (pass slice); use another device");
    panel.version += 1000000;
    REFUSED(dt_vk_suits(&host, &needy), "generate the pipeline again");
    host.physical_device = NULL;
    REFUSED(dt_vk_suits(&host, &features_vk), "must be given");
}

/* Only the host knows the features that its device was created with. Here the host describes them
 * wrongly. */
TEST_WITH(vulkan_checks_enabled_features, NULL, is_silent)
{
    struct dt_vk_host host = vk_host();
    VkPhysicalDeviceDynamicRenderingFeatures rendering = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES};
    VkPhysicalDeviceVulkan13Features vulkan13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES, .pNext = &rendering};
    VkPhysicalDeviceVulkan12Features vulkan12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &vulkan13};
    VkPhysicalDeviceVulkan11Features vulkan11 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &vulkan12};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                          .pNext = &vulkan11};
    const struct dt_need need = {FEATURES_PASS_SLICE, "samplerAnisotropy"};
    struct dt_panel panel = features_panel;
    const struct dt_shaders needy = {"vk", &panel, features_vk.stages};
    panel.needs = &need;
    panel.need_count = 1;
    dt_vk_need_features(&needy, &features.features, &vulkan11, &vulkan12, &vulkan13);
    vulkan13.dynamicRendering = VK_FALSE;
    host.device_info = &(const VkDeviceCreateInfo){.pNext = &features};
    REFUSED(dt_vk_open(&host), "created without dynamicRendering; enable all");
    rendering.dynamicRendering = VK_TRUE;
    features.features.samplerAnisotropy = VK_FALSE;
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_non_null(rt);
    REFUSED(dt_vk_create(rt, &needy), "pass slice: needs samplerAnisotropy, which ");
    assert_non_null(strstr(heard.text, " has, but was created without; enable all"));
    dt_vk_close(rt);
    features.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO; /* only pEnabledFeatures counts */
    host.device_info = &(const VkDeviceCreateInfo){
        .pNext = &features,
        .pEnabledFeatures = &(VkPhysicalDeviceFeatures){.samplerAnisotropy = 1}};
    rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_create(rt, &needy));
    dt_vk_close(rt);
}

TEST_WITH(vulkan_tells_wrong_calls, NULL, is_silent)
{
    struct dt_vk_runtime *rt = open_vk_runtime(vk_host(), NULL);
    struct dt_frame frame = frame_of(0);
    struct dt_vk_scene scene = vk_scene;
    struct dt_vk_image image = {.image = (VkImage)&heard /* no image, and never used as one */,
                                .width = 5};
    struct dt_vk_resource resource;
    double ms[FEATURES_PASSES];
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "import_scene");
    REFUSED(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image), "create comes first");
    REFUSED(dt_vk_create(rt, &features_gl), "the shaders are for gl; give features_vk");
    const struct dt_need future = {FEATURES_PASS_SLICE, "rayTracing"};
    struct dt_panel panel = features_panel;
    const struct dt_shaders needy = {"vk", &panel, features_vk.stages};
    struct dt_program programs[FEATURES_PASSES];
    panel.needs = &future;
    panel.need_count = 1;
    REFUSED(dt_vk_create(rt, &needy), "pass slice: needs rayTracing, which ");
    const struct dt_demand much = {FEATURES_PASS_SLICE, DT_LIMIT_SHARED_BYTES, 1 << 30};
    panel = features_panel;
    panel.demands = &much;
    panel.demand_count = 1;
    REFUSED(dt_vk_create(rt, &needy),
            "pass slice needs 1,073,741,824 bytes of shared memory; the device ");
    scene.index_count = 4;
    REFUSED(dt_vk_import_scene(rt, &scene), "4 indices");
    scene = vk_scene;
    scene.vertices.offset = 1;
    REFUSED(dt_vk_import_scene(rt, &scene), "scene_vertices");
    scene = vk_scene;
    scene.materials.size = 32;
    REFUSED(dt_vk_import_scene(rt, &scene), "scene_materials");
    scene = vk_scene;
    scene.objects.buffer = VK_NULL_HANDLE;
    assert_true(dt_vk_import_scene(rt, &scene));
    assert_true(dt_vk_create(rt, &features_vk));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "the pass keep reads scene_objects");
    scene = vk_scene;
    scene.numbered = false;
    panel = features_with_numbers(programs);
    assert_true(dt_vk_create(rt, &needy) && dt_vk_import_scene(rt, &scene));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "reads vertex_triangle; number the triangles");
    assert_true(dt_vk_create(rt, &features_vk));
    assert_true(dt_vk_import_scene(rt, &vk_scene));
    REFUSED(dt_vk_record(rt, VK_NULL_HANDLE, &frame, NULL), "call resize first");
    REFUSED(dt_vk_get_resource(rt, 0, &resource), "resize comes first");
    REFUSED(dt_vk_resize(rt, 0, HEIGHT), "frame of 0x16");
    REFUSED(dt_vk_import_image(rt, FEATURES_RESOURCE_MEMORY, &image), "no image");
    REFUSED(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image), "which the layout_before");
    image.layout_before = VK_IMAGE_LAYOUT_GENERAL;
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "image trail: imported with VkFormat");
    image = (struct dt_vk_image){.image = image.image,
                                 .layout_before = VK_IMAGE_LAYOUT_GENERAL,
                                 .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                 .width = WIDTH,
                                 .height = HEIGHT,
                                 .layers = 1,
                                 .mips = 1};
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "usage 0x0");
    image.image = VK_NULL_HANDLE; /* cancels the import */
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image));
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    REFUSED(dt_vk_timings(rt, 0, ms), "timing");
    REFUSED(dt_vk_record(rt, VK_NULL_HANDLE, &(const struct dt_frame){0}, NULL),
            "`camera` of the struct dt_frame is zero");
    uint8_t trail[TRAIL_BYTES];
    run_frames(rt, trail);
    dt_vk_close(rt);
}

/* Validation reports a view whose usage the image lacks. */
static void assert_can_sample_images(struct dt_vk_runtime *rt)
{
    const VkImageViewUsageCreateInfo usage = {.sType =
                                                  VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO,
                                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT};
    for (uint32_t i = 0; i < FEATURES_RESOURCES; i++) {
        struct dt_vk_resource resource;
        VkImageView view;
        const struct dt_resource *what = &features_pipeline.resources[i];
        if (!what->history && !what->keep && (int)i != features_pipeline.linear_output &&
            (int)i != features_pipeline.display_output) {
            REFUSED(dt_vk_get_resource(rt, i, &resource), "give it `keep: true` in the spec");
            continue;
        }
        assert_true(dt_vk_get_resource(rt, i, &resource));
        const VkImageViewCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
            .pNext = &usage,
            .image = resource.image,
            .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
            .format = resource.format,
            .subresourceRange = {resource.format == VK_FORMAT_D32_SFLOAT
                                     ? VK_IMAGE_ASPECT_DEPTH_BIT
                                     : VK_IMAGE_ASPECT_COLOR_BIT,
                                 0, resource.mips, 0, resource.layers}};
        if (!resource.image)
            continue;
        assert_true(resource.usage & VK_IMAGE_USAGE_SAMPLED_BIT);
        assert_int_equal(vkCreateImageView(vk.device, &info, NULL, &view), VK_SUCCESS);
        vkDestroyImageView(vk.device, view, NULL);
    }
}

TEST_WITH(vulkan_forgets_what_was_not_submitted, NULL, is_silent)
{
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES], zero[TRAIL_BYTES];
    struct dt_vk_runtime *rt = open_features();
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, wanted);
    assert_can_sample_images(rt);
    assert_memory_not_equal(wanted, zero, TRAIL_BYTES);
    run_frames(rt, found); /* the trail continues */
    assert_memory_not_equal(wanted, found, TRAIL_BYTES);
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    struct dt_frame frame = frame_of(7);
    assert_true(dt_vk_record(rt, new_commands(), &frame, NULL)); /* never submitted */
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, found);
    assert_memory_equal(wanted, found, TRAIL_BYTES);
    dt_vk_close(rt);
}

TEST_WITH(vulkan_draws_vertices_of_another_layout, NULL, is_silent)
{
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES];
    struct dt_vk_scene scene = vk_scene;
    scene.vertices = (struct dt_vk_range){VK_NULL_HANDLE, 0, 0};
    scene.attributes[DT_POSITION] = (struct dt_vk_attribute){geometry.handle, OWN_POSITIONS, 16};
    for (int i = DT_NORMAL; i <= DT_MATERIAL; i++)
        scene.attributes[i] =
            (struct dt_vk_attribute){geometry.handle, OWN_REST + own_places[i], OWN_BYTES};
    vulkan_draw(&vk_scene, wanted);
    lay_out(geometry.bytes, 0);
    vulkan_draw(&scene, found);
    assert_memory_equal(wanted, found, TRAIL_BYTES);
    lay_out(geometry.bytes, 1); /* other normals */
    vulkan_draw(&scene, found);
    assert_memory_not_equal(wanted, found, TRAIL_BYTES);
    assert_int_equal(heard.validation, 0);

    struct dt_vk_runtime *rt = open_features();
    scene.attributes[DT_NORMAL].buffer = VK_NULL_HANDLE;
    assert_true(dt_vk_import_scene(rt, &scene));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "the pass scene reads vertex_normal");
    scene.attributes[DT_UV].stride = 6;
    REFUSED(dt_vk_import_scene(rt, &scene), "vertex_uv: offset 98572 and stride 6");
    dt_vk_close(rt);
}

/* Records an indirect draw with the scene's own indices; `features` has no such draw. */
static bool record_scene_indirect(const struct dt_recording *r)
{
    return r->verbs->begin(r->runtime, FEATURES_PASS_HALVES, true) &&
           r->verbs->draw_indirect(r->runtime, FEATURES_PASS_HALVES, 1, DT_SCENE_INDICES,
                                   FEATURES_RESOURCE_DRAW_ARGUMENTS);
}

/* lavapipe (22.3.6) counts the indices of an indirect draw from the start of their buffer, and
 * ignores the offset of the binding. The runtime refuses the scene of these tests there, since its
 * indices stand behind its vertices. */
TEST_WITH(vulkan_refuses_indices_that_lavapipe_would_miss, NULL, is_silent)
{
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(vk.physical, &properties);
    if (strncmp(properties.deviceName, "llvmpipe", 8) != 0)
        skip();
    struct dt_panel panel = features_panel;
    const struct dt_shaders indirect = {"vk", &panel, features_vk.stages};
    panel.record = record_scene_indirect;
    struct dt_vk_runtime *rt = open_vk_runtime(vk_host(), NULL);
    struct dt_frame frame = frame_of(0);
    assert_true(dt_vk_import_scene(rt, &vk_scene));
    assert_true(dt_vk_create(rt, &indirect));
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    REFUSED(dt_vk_record(rt, new_commands(), &frame, NULL),
            "pass halves: scene indices at byte 4096, but indirect draws of llvmpipe");
    REFUSED(dt_vk_record(rt, new_commands(), &frame, NULL), "call resize first");
    dt_vk_close(rt);
}

/* The image `trail` after frames, a resize, and the same frames again. */
static void vulkan_trail(bool keeps, uint32_t width, uint8_t trail[TRAIL_BYTES])
{
    struct dt_vk_host host = vk_host();
    host.keep_history = keeps;
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_import_scene(rt, &vk_scene) && dt_vk_create(rt, &features_vk) &&
                dt_vk_resize(rt, width, HEIGHT));
    if (width == WIDTH)
        run_frames(rt, trail);
    assert_true(dt_vk_create(rt, &features_vk) && dt_vk_resize(rt, WIDTH, HEIGHT) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, trail);
    dt_vk_close(rt);
}

TEST_WITH(vulkan_keeps_history, NULL, is_silent)
{
    static uint8_t twice[TRAIL_BYTES], found[TRAIL_BYTES];
    struct dt_vk_runtime *rt = open_features();
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, found);
    run_frames(rt, twice);
    dt_vk_close(rt);
    vulkan_trail(true, WIDTH, found);
    assert_memory_equal(found, twice, TRAIL_BYTES);
    vulkan_trail(true, 2 * WIDTH, found); /* another size */
    assert_memory_not_equal(found, twice, TRAIL_BYTES);
    vulkan_trail(false, WIDTH, found);
    assert_memory_not_equal(found, twice, TRAIL_BYTES);
}

TEST_WITH(vulkan_takes_times, NULL, is_silent)
{
    static uint8_t trail[TRAIL_BYTES];
    struct dt_vk_host host = vk_host();
    double ms[FEATURES_PASSES], sum = 0;
    host.timing = true;
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(dt_vk_import_scene(rt, &vk_scene) && dt_vk_create(rt, &features_vk) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, trail);
    assert_true(dt_vk_timings(rt, 0, ms));
    for (int i = 0; i < FEATURES_PASSES; i++)
        sum += isnan(ms[i]) ? 0 : ms[i];
    assert_true(sum > 0 && sum < 1e5);
    dt_vk_close(rt);
}

TEST_WITH(vulkan_needs_no_scene_that_nobody_sees, NULL, is_silent)
{
    struct dt_frame frame = frame_of(0);
    struct dt_vk_runtime *rt = open_vk_runtime(vk_host(), &layouts_vk);
    VkCommandBuffer commands = new_commands();
    assert_true(dt_vk_record(rt, commands, &frame, NULL));
    finish_commands(commands);
    REFUSED(!dt_vk_create(rt, &features_vk) || dt_vk_resize(rt, WIDTH, HEIGHT), "import_scene");
    dt_vk_close(rt);
}

extern const struct dt_shaders atomics_vk, bloom_vk, groups_vk, mips_vk;

/* The last resource of a frame may share memory with the first of the next. */
TEST_WITH(vulkan_records_two_frames_at_once, NULL, is_silent)
{
    static const struct dt_shaders *const pipelines[] = {&atomics_vk, &bloom_vk, &groups_vk,
                                                         &mips_vk, &shapes_vk};
    struct dt_frame frame = frame_of(0);
    for (size_t i = 0; i < DT_ARRAY_COUNT(pipelines); i++) {
        struct dt_vk_runtime *rt = open_vk_runtime(vk_host(), pipelines[i]);
        VkCommandBuffer commands = new_commands();
        for (int k = 0; k < 2; k++)
            assert_true(dt_vk_record(rt, commands, &frame, NULL));
        finish_commands(commands);
        dt_vk_close(rt);
        if (heard.validation)
            fail_msg("%s: %s", pipelines[i]->panel->pipeline->name, heard.text);
    }
}

TEST_WITH(vulkan_draws_the_same_in_parts, NULL, is_silent)
{
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES];
    struct dt_vk_runtime *rt = open_features();
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, wanted);
    for (uint32_t passes = 1; passes < 4; passes++) {
        assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
        run_parts(rt, passes, found);
        assert_memory_equal(wanted, found, TRAIL_BYTES);
    }
    dt_vk_close(rt);
}

RUN_TESTS("vulkan", open_vulkan, close_vulkan)
