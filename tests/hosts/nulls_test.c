/* Every function of the headers of renderers with NULL for every pointer: hosts go on after an open that failed,
 * and forget arguments. Without a runtime there is no log; with one, the error names what is missing. */
#include <EGL/egl.h>

#include "library_vk.h"
#include "runtime_gl/diptych_gl.h"
#include "diptych_scene.h"

extern const struct dt_shaders bloom_vk;

/* ---- Nothing at all -------------------------------------------------------------------------- */

TEST(nothing_for_vulkan)
{
    VkPhysicalDeviceFeatures core = {0};
    assert_false(dt_vk_suits(NULL, NULL) || dt_vk_suits(NULL, &outside_vk));
    dt_vk_need_features(NULL, NULL, NULL, NULL, NULL);
    dt_vk_need_features(&outside_vk, &core, NULL, NULL, NULL);
    dt_vk_need_features(NULL, &core, NULL, NULL, NULL);
    assert_null(dt_vk_open(NULL));
    dt_vk_close(NULL);
    assert_false(dt_vk_import_scene(NULL, NULL) || dt_vk_create(NULL, NULL));
    assert_false(dt_vk_create(NULL, &outside_vk));
    assert_false(dt_vk_import_image(NULL, 0, NULL) || dt_vk_import_buffer(NULL, 0, NULL));
    assert_false(dt_vk_add_image_usage(NULL, 0, 0) || dt_vk_add_buffer_usage(NULL, 0, 0));
    assert_false(dt_vk_resize(NULL, 0, 0));
    assert_false(dt_vk_write(NULL, NULL, 0, 0, NULL) || dt_vk_record(NULL, NULL, NULL, NULL));
    assert_false(dt_vk_record_passes(NULL, NULL, NULL, NULL, 0, 0));
    assert_false(dt_vk_get_resource(NULL, 0, NULL) || dt_vk_timings(NULL, 0, NULL));
}

TEST(nothing_for_opengl)
{
    struct dt_gl_resource resource;
    assert_null(dt_gl_open(NULL));
    dt_gl_close(NULL);
    assert_false(dt_gl_import_scene(NULL, NULL) || dt_gl_create(NULL, NULL));
    assert_false(dt_gl_create(NULL, &outside_gl));
    assert_false(dt_gl_import_image(NULL, 0, 0) || dt_gl_import_buffer(NULL, 0, NULL));
    assert_false(dt_gl_resize(NULL, 0, 0) || dt_gl_write(NULL, 0, 0, NULL));
    assert_false(dt_gl_record(NULL, NULL, NULL) || dt_gl_record_passes(NULL, NULL, NULL, 0, 0));
    assert_false(dt_gl_get_resource(NULL, 0, NULL) || dt_gl_get_resource(NULL, 0, &resource));
    assert_false(dt_gl_timings(NULL, 0, NULL));
}

TEST(nothing_for_scenes)
{
    const struct dt_scene_camera camera = {.target = {0, 0, -1}, .up = {0, 1, 0}, .fov_y = 1};
    const struct dt_scene_light light = {.direction = {0, -1, 0}};
    const struct dt_scene_extent extent = {.high = {1, 1, 1}, .radius = 1};
    static const struct dt_frame none;
    struct dt_frame frame;
    assert_null(dt_scene_open(NULL, NULL, NULL));
    assert_null(dt_scene_open("nowhere.yaml", NULL, NULL));
    REFUSED(dt_scene_open(NULL, NULL, &test_log), "the path of a scene is NULL");
    dt_scene_close(NULL);
    assert_null(dt_scene_data(NULL));
    dt_scene_look(NULL, NULL);
    dt_scene_look(NULL, &camera);
    dt_scene_frame(NULL, 8, 8, NULL);
    dt_scene_compose(NULL, NULL, NULL, 8, 8, NULL);
    dt_scene_compose(&camera, &light, &extent, 8, 8, NULL);
    for (int i = 0; i < 4; i++) { /* a frame that record refuses */
        memset(&frame, 1, sizeof frame);
        if (i < 3)
            dt_scene_compose(i == 0 ? NULL : &camera, i == 1 ? NULL : &light,
                             i == 2 ? NULL : &extent, 8, 8, &frame);
        else
            dt_scene_frame(NULL, 8, 8, &frame);
        assert_memory_equal(&frame.camera, &none.camera, sizeof none.camera);
    }
    assert_int_equal(dt_number_triangles(NULL, 0, 0, NULL, NULL), 0);
}

/* ---- A runtime, and nothing else ------------------------------------------------------------- */

static const struct dt_bytes weights = {.size = 32, .extent = {2, 1, 1}}; /* without data */

TEST_WITH(opengl_names_what_is_missing, open_opengl, close_opengl)
{
    REFUSED(dt_gl_open(&(struct dt_gl_host){.log = test_log}), "get_proc_address");
    struct dt_gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
        .log = test_log, .get_proc_address = eglGetProcAddress, .timing = true});
    assert_non_null(rt);
    const uint32_t kernel = OUTSIDE_RESOURCE_KERNEL;
    REFUSED(dt_gl_import_scene(rt, NULL), "import_scene: the struct dt_gl_scene is NULL");
    REFUSED(dt_gl_create(rt, NULL), "create: the struct dt_shaders is NULL");
    REFUSED(dt_gl_import_buffer(rt, kernel, NULL), "import_buffer: the struct dt_gl_range is NULL");
    REFUSED(dt_gl_get_resource(rt, 0, NULL), "resource: the struct dt_gl_resource is NULL");
    REFUSED(dt_gl_write(rt, kernel, 0, NULL), "write: the struct dt_bytes is NULL");
    assert_true(dt_gl_create(rt, &outside_gl) && dt_gl_resize(rt, 16, 8));
    REFUSED(dt_gl_write(rt, OUTSIDE_RESOURCE_WEIGHTS, 0, &weights),
            "`data` of the struct dt_bytes");
    REFUSED(dt_gl_record(rt, NULL, NULL), "record: ");
    dt_gl_close(rt);
}

TEST_WITH(vulkan_names_what_is_missing, open_vulkan, close_vulkan)
{
    struct dt_vk_host host = {.log = test_log, .get_instance_proc_addr = vkGetInstanceProcAddr};
    REFUSED(dt_vk_open(&host), "struct dt_vk_host: instance, ");
    host = vk_host();
    REFUSED(dt_vk_suits(&host, NULL), "suits: the struct dt_shaders is NULL");
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_non_null(rt);
    const uint32_t kernel = OUTSIDE_RESOURCE_KERNEL, picture = OUTSIDE_RESOURCE_PICTURE;
    REFUSED(dt_vk_import_scene(rt, NULL), "import_scene: the struct dt_vk_scene is NULL");
    REFUSED(dt_vk_create(rt, NULL), "create: the struct dt_shaders is NULL");
    REFUSED(dt_vk_import_image(rt, picture, NULL), "import_image: the struct dt_vk_image is NULL");
    REFUSED(dt_vk_import_buffer(rt, kernel, NULL), "import_buffer: the struct dt_vk_range is NULL");
    REFUSED(dt_vk_get_resource(rt, 0, NULL), "resource: the struct dt_vk_resource is NULL");
    REFUSED(dt_vk_write(rt, NULL, kernel, 0, NULL), "write: the struct dt_bytes is NULL");
    assert_true(dt_vk_create(rt, &outside_vk) && dt_vk_resize(rt, 16, 8));
    REFUSED(dt_vk_write(rt, NULL, OUTSIDE_RESOURCE_WEIGHTS, 0, &weights),
            "`data` of the struct dt_bytes");
    REFUSED(dt_vk_record(rt, NULL, NULL, NULL), "record: ");
    assert_true(dt_vk_create(rt, &bloom_vk) && dt_vk_resize(rt, 16, 8)); /* without inputs */
    const struct dt_frame frame = {0};                                   /* and without scene */
    REFUSED(dt_vk_record(rt, NULL, &frame, NULL), "record: the command buffer is NULL");
    dt_vk_close(rt);
}

RUN_TESTS("nulls", NULL, NULL)
