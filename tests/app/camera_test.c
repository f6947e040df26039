/* The camera of the window: its movements, and its text. Expected directions are those of a right-handed room. */
#include <math.h>
#include <stdlib.h>
#include <stdio.h>

#include "tests/lib/unit.h"
#include "app/run/camera.h"

static const struct dt_scene_camera ahead = {{1, 2, 3}, {1, 2, -1}, {0, 1, 0}, 0.7f};

static void assert_at(const float found[3], double x, double y, double z)
{
    const double wanted[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        assert_true(fabs(found[i] - wanted[i]) < 1e-5);
}

TEST(it_moves_along_its_axes)
{
    struct dt_scene_camera camera = ahead; /* looks along -z: right is +x, up +y */
    camera_move(&camera, 0.5f, 0, 0);
    assert_at(camera.eye, 1.5, 2, 3);
    assert_at(camera.target, 1.5, 2, -1);
    camera_move(&camera, 0, 0.25f, 2);
    assert_at(camera.eye, 1.5, 2.25, 1);
    assert_at(camera.target, 1.5, 2.25, -3);
}

TEST(it_turns_about_its_eye)
{
    struct dt_scene_camera camera = ahead;
    camera_turn(&camera, (float)M_PI / 2, 0);
    assert_at(camera.eye, 1, 2, 3);
    assert_at(camera.target, 5, 2, 3); /* to the right, as far as before */
    camera_turn(&camera, (float)-M_PI / 2, (float)M_PI / 6);
    assert_at(camera.target, 1, 4, 3 - 4 * cos(M_PI / 6));
}

TEST(it_never_tips_over)
{
    struct dt_scene_camera camera = ahead;
    for (int i = 0; i < 50; i++)
        camera_turn(&camera, 0.01f, 0.3f);
    assert_true(camera.target[1] < 2 + 4 && camera.target[1] > 2 + 3.9);
    for (int i = 0; i < 50; i++)
        camera_turn(&camera, -0.01f, -0.3f);
    assert_true(camera.target[1] > 2 - 4 && camera.target[1] < 2 - 3.9);
    assert_true(camera.target[2] < 3); /* still ahead */
}

/* Floats that need many digits: a text with few digits does not restore most of them. */
TEST(its_text_has_the_same_numbers)
{
    const struct dt_scene_camera odd = {
        {0.278f, 1.0f / 3, 1e-7f}, {-123456.789f, 0.1f, -0.8f}, {0, 1, 0}, 0.685914397f};
    char *text = camera_text(&odd);
    float n[10];
    assert_int_equal(sscanf(text,
                            "{eye: [0.278, %f, %f], target: [%f, %f, %f], up: [%f, %f, %f], "
                            "fov_y: %f}",
                            &n[1], &n[2], &n[3], &n[4], &n[5], &n[6], &n[7], &n[8], &n[9]),
                     9);
    assert_memory_equal(n + 1, odd.eye + 1, 2 * sizeof *n);
    assert_memory_equal(n + 3, odd.target, 3 * sizeof *n);
    assert_memory_equal(n + 6, odd.up, 3 * sizeof *n);
    assert_true((float)((double)n[9] * M_PI / 180) == odd.fov_y);
    free(text);
}

RUN_TESTS("camera", NULL, NULL)
