/* The scene library: a frame composed by hand is the frame of a file. */
#include <math.h>
#include <string.h>

#include "library.h"
#include "scenes/diptych_scene.h"

/* Composes the frame of scenes/cornell.yaml by hand. */
TEST(a_frame_is_composed_as_of_a_file)
{
    struct dt_scene_file *file = dt_scene_open("scenes/cornell.yaml", NULL, &test_log);
    assert_non_null(file);
    const struct dt_scene *scene = dt_scene_data(file);
    const float pi = 3.14159265358979f;
    const struct dt_scene_camera camera = {
        {0.278f, 0.273f, -0.8f}, {0.278f, 0.273f, 0}, {0, 1, 0}, 39.3f * pi / 180};
    struct dt_scene_light light = {.kind = DT_LIGHT_SPOT,
                                   .position = {0.15f, 0.5f, 0.2f},
                                   .cone = {25 * pi / 180, 35 * pi / 180},
                                   .color = {1, 1, 1}};
    struct dt_scene_extent extent = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY},
                                     0,
                                     scene->index_count / 3};
    struct dt_frame wanted, found;
    dt_scene_frame(file, 64, 48, &wanted);
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            extent.low[i] = fminf(extent.low[i], scene->vertices[v].position[i]);
            extent.high[i] = fmaxf(extent.high[i], scene->vertices[v].position[i]);
        }
    extent.radius = wanted.scene_radius;
    memcpy(light.direction, wanted.light.direction, sizeof light.direction);
    dt_scene_compose(&camera, &light, &extent, 64, 48, &found);
    const float *a = (const float *)&wanted, *b = (const float *)&found;
    for (size_t i = 0; i < offsetof(struct dt_frame, width) / sizeof *a; i++)
        if (fabsf(a[i] - b[i]) > 1e-6f * fmaxf(1, fabsf(a[i])))
            fail_msg("float %zu is %.9g, not %.9g", i, (double)b[i], (double)a[i]);
    assert_int_equal(wanted.triangle_count, found.triangle_count);
    dt_scene_look(file, &(struct dt_scene_camera){{1, 2, 3}, {1, 2, 0}, {0, 1, 0}, 1});
    dt_scene_frame(file, 64, 48, &found);
    assert_true(found.camera.position[0] == 1 && found.camera.position[1] == 2 &&
                found.camera.position[2] == 3 && found.camera.direction[2] == -1);
    dt_scene_close(file);
    REFUSED(dt_scene_open("scenes/nowhere.yaml", NULL, &test_log), "nowhere.yaml");
}

RUN_TESTS("scenes", NULL, NULL)
