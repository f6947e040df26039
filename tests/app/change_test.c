/* Change from frame to frame against closed forms. This file builds cameras and intersects them
 * with planes; the irradiance is known at every point of space. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "app/truth/change.h"
#include "scenes/scene.h"

enum { WIDTH = 40, HEIGHT = 24, PIXELS = WIDTH * HEIGHT };

/* Two frames: their visible points and their pictures. */
struct fixture {
    struct seen_point points[2][PIXELS];
    struct seen seen[2];
    float texels[2][PIXELS * 3];
    struct rgb_image test[2];
    float truth[2][PIXELS * 3];
    struct rgb_image reference[2];
};

static int row_of(int pixel)
{
    return pixel / WIDTH;
}

/* Pixels are unit squares of the plane z = 0. Frame t looks at the plane further to the right by
 * `right`, and further up by `up`. */
static void look_straight(struct fixture *fixture, int t, double right, double up)
{
    struct seen *seen = &fixture->seen[t];
    *seen = (struct seen){WIDTH, HEIGHT, fixture->points[t], {{0}}};
    seen->view_projection[0][0] = 2.0f / WIDTH;
    seen->view_projection[1][1] = 2.0f / HEIGHT;
    seen->view_projection[3][0] = (float)(-2 * right / WIDTH - 1);
    seen->view_projection[3][1] = (float)(-2 * up / HEIGHT - 1);
    seen->view_projection[3][3] = 1;
    for (int i = 0; i < PIXELS; i++)
        fixture->points[t][i] =
            (struct seen_point){.position = {(float)(i % WIDTH + 0.5 + right),
                                             (float)(HEIGHT - row_of(i) - 0.5 + up), 0},
                                .depth = 10,
                                .normal = {0, 0, 1},
                                .plane = {0, 0, 1}};
    fixture->test[t] = (struct rgb_image){WIDTH, HEIGHT, fixture->texels[t]};
    fixture->reference[t] = (struct rgb_image){WIDTH, HEIGHT, fixture->truth[t]};
}

/* A repeatable number in 0..1 for each cell of space. */
static float cell(double x, double y)
{
    uint32_t seed = (uint32_t)(int)floor(x) * 2654435761u ^ (uint32_t)(int)floor(y) * 40503u;
    seed = (seed ^ seed >> 15) * 2246822519u;
    return (float)(seed >> 8) / 16777216.0f;
}

static void paint(struct fixture *fixture, int t, float (*of)(double x, double y))
{
    for (int i = 0; i < PIXELS; i++) {
        const float *x = fixture->points[t][i].position;
        for (int channel = 0; channel < 3; channel++)
            fixture->texels[t][3 * i + channel] =
                of((double)x[0], (double)x[1]) * (float)(channel + 1);
    }
}

static float slope(double x, double y)
{
    return (float)(3 + 0.5 * x + 0.25 * y);
}

static struct change measure(const struct fixture *fixture, bool reference, uint32_t block)
{
    struct change change;
    assert_true(change_measure(&change, fixture->seen, fixture->test,
                               reference ? fixture->reference : NULL, block));
    return change;
}

static double mean(const float *texels)
{
    double sum = 0;
    for (int i = 0; i < PIXELS * 3; i++)
        sum += (double)texels[i];
    return sum / (PIXELS * 3);
}

static void expect_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%.9g, expected %.9g", value, expected);
}

static int make(void **state)
{
    *state = calloc(1, sizeof(struct fixture));
    return *state ? 0 : -1;
}

static int drop(void **state)
{
    free(*state);
    return 0;
}

static void what_stands_still_does_not_change(void **state)
{
    struct fixture *fixture = *state;
    for (int t = 0; t < 2; t++) {
        look_straight(fixture, t, 0, 0);
        paint(fixture, t, cell);
    }
    struct change change = measure(fixture, false, 1);
    assert_int_equal(change.surfaces, PIXELS);
    assert_int_equal(change.compared, PIXELS);
    assert_true(change.change == 0);
    expect_near(change.mean, mean(fixture->texels[1]), 1e-6);
}

static void brightening_is_its_factor(void **state)
{
    struct fixture *fixture = *state;
    for (int t = 0; t < 2; t++) {
        look_straight(fixture, t, 0, 0);
        paint(fixture, t, cell);
    }
    for (int i = 0; i < PIXELS * 3; i++)
        fixture->texels[1][i] *= 1.25f;
    struct change change = measure(fixture, false, 1);
    expect_near(change.change, 0.25 * mean(fixture->texels[0]), 1e-6);
    expect_near(change.change / change.mean, 0.2, 1e-6);
    expect_near(measure(fixture, false, 8).change, change.change, 1e-6); /* all of one sign */
}

/* A moved texture has no change: any texture moved by whole pixels, or a linear one moved by parts
 * of pixels. */
static void moved_textures_are_found_again(void **state)
{
    struct fixture *fixture = *state;
    look_straight(fixture, 0, 0, 0);
    look_straight(fixture, 1, 3, -2);
    paint(fixture, 0, cell);
    paint(fixture, 1, cell);
    struct change change = measure(fixture, false, 1);
    assert_int_equal(change.compared, (WIDTH - 3) * (HEIGHT - 2));
    expect_near(change.change, 0, 1e-6);
    look_straight(fixture, 1, 3.25, -1.5);
    paint(fixture, 0, slope);
    paint(fixture, 1, slope);
    change = measure(fixture, false, 1);
    assert_int_equal(change.compared, (WIDTH - 4) * (HEIGHT - 2));
    expect_near(change.change, 0, 1e-4);
    /* at a fixed place of the picture, the change is the slope along the way */
    memcpy(fixture->seen[1].view_projection, fixture->seen[0].view_projection,
           sizeof fixture->seen[0].view_projection);
    memcpy(fixture->points[1], fixture->points[0], sizeof fixture->points[0]);
    expect_near(measure(fixture, false, 1).change, 2 * (3.25 * 0.5 - 1.5 * 0.25), 1e-4);
}

/* Pixels without an earlier value are left out: where a plane nearer to the eye has gone, in
 * columns 10 to 14, and where a surface has turned. So is a pixel that is not finite. */
static void what_comes_into_view_is_left_out(void **state)
{
    struct fixture *fixture = *state;
    for (int t = 0; t < 2; t++) {
        look_straight(fixture, t, 0, 0);
        paint(fixture, t, slope);
    }
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 10; x < 15; x++) {
            fixture->points[0][y * WIDTH + x].position[2] = 1;
            for (int channel = 0; channel < 3; channel++)
                fixture->texels[0][3 * (y * WIDTH + x) + channel] = 1000;
        }
    struct change change = measure(fixture, false, 1);
    assert_int_equal(change.surfaces, PIXELS);
    assert_int_equal(change.compared, PIXELS - 5 * HEIGHT);
    assert_true(change.change == 0);
    const float tilted[3] = {0.6f, 0, 0.8f};
    memcpy(fixture->points[0][0].normal, tilted, sizeof tilted);
    fixture->points[1][WIDTH - 1].depth = 0;
    fixture->texels[1][3 * (PIXELS - 1)] = NAN;
    change = measure(fixture, false, 1);
    assert_int_equal(change.surfaces, PIXELS - 1);
    assert_int_equal(change.compared, PIXELS - 5 * HEIGHT - 3);
    assert_true(change.change == 0);
}

/* A floor under a camera that walks, turns and zooms, by the matrices that the pipelines get. */
static void look_down(struct fixture *fixture, int t, const struct scene *scene)
{
    struct dt_frame frame;
    look_straight(fixture, t, 0, 0);
    scene_frame(scene, WIDTH, HEIGHT, &frame);
    memcpy(fixture->seen[t].view_projection, frame.camera.view_projection,
           sizeof frame.camera.view_projection);
    const float *eye = scene->camera.eye, *target = scene->camera.target;
    double ahead[3], right[3], up[3], length = 0;
    for (int i = 0; i < 3; i++)
        length += pow((double)target[i] - (double)eye[i], 2);
    for (int i = 0; i < 3; i++)
        ahead[i] = ((double)target[i] - (double)eye[i]) / sqrt(length);
    length = hypot(ahead[0], ahead[2]); /* y is up */
    right[0] = -ahead[2] / length, right[1] = 0, right[2] = ahead[0] / length;
    up[0] = right[1] * ahead[2] - right[2] * ahead[1];
    up[1] = right[2] * ahead[0] - right[0] * ahead[2];
    up[2] = right[0] * ahead[1] - right[1] * ahead[0];
    double half = tan(scene->camera.fov_y / 2.0);
    for (int i = 0; i < PIXELS; i++) {
        struct seen_point *point = &fixture->points[t][i];
        double u = (2 * (i % WIDTH + 0.5) / WIDTH - 1) * half * WIDTH / HEIGHT;
        double v = (1 - 2 * (row_of(i) + 0.5) / HEIGHT) * half;
        double ray[3];
        for (int k = 0; k < 3; k++)
            ray[k] = ahead[k] + u * right[k] + v * up[k];
        double depth = -(double)eye[1] / ray[1];
        *point =
            (struct seen_point){.depth = (float)depth, .normal = {0, 1, 0}, .plane = {0, 1, 0}};
        for (int k = 0; k < 3; k++)
            point->position[k] = (float)((double)eye[k] + depth * ray[k]);
        for (int channel = 0; channel < 3; channel++)
            fixture->texels[t][3 * i + channel] =
                3 + 0.5f * point->position[0] - 0.25f * point->position[2];
    }
}

static void a_walking_camera_finds_the_floor_again(void **state)
{
    struct fixture *fixture = *state;
    struct scene scene = {
        .camera = {.eye = {0, 2, 3}, .up = {0, 1, 0}, .fov_y = 0.7f},
        .light = {.kind = DT_LIGHT_SPOT, .direction = {0, -1, 0}, .cone = {0.2f, 0.3f}},
        .bounds_min = {-5, -1, -5},
        .bounds_max = {5, 1, 5},
        .radius = 8};
    look_down(fixture, 0, &scene);
    scene.camera = (struct scene_camera){{0.2f, 2.1f, 2.9f}, {0.3f, 0, 0.1f}, {0, 1, 0}, 0.75f};
    look_down(fixture, 1, &scene);
    struct change change = measure(fixture, false, 1);
    assert_in_range(change.compared, PIXELS * 6 / 10, PIXELS - 1);
    /* a linear function of the floor is not linear between pixels of a perspective */
    expect_near(change.change, 0, 2e-3);
    double same_place = 0;
    for (int i = 0; i < PIXELS * 3; i++)
        same_place +=
            fabs((double)fixture->texels[1][i] - (double)fixture->texels[0][i]) / (PIXELS * 3);
    assert_true(same_place > 0.05);
}

/* Both pictures brighten by 0.5. The test adds 0.125 in every other column and subtracts 0.125 in
 * the rest. */
static void flicker_is_the_difference_of_changes(void **state)
{
    struct fixture *fixture = *state;
    for (int t = 0; t < 2; t++) {
        look_straight(fixture, t, 0, 0);
        for (int i = 0; i < PIXELS * 3; i++) {
            fixture->truth[t][i] = (float)(1 + 0.5 * t);
            float ripple = i / 3 % 2 ? -0.125f : 0.125f;
            fixture->texels[t][i] = (float)(2 + 0.5 * t) + ripple * (float)t;
        }
    }
    struct change change = measure(fixture, true, 1);
    expect_near(change.change_reference, 0.5, 1e-7);
    expect_near(change.change, 0.5, 1e-7);
    expect_near(change.flicker, 0.125, 1e-7);
    expect_near(change.mean_reference, 1.5, 1e-7);
    change = measure(fixture, true, 2);
    expect_near(change.flicker, 0, 1e-7);
    expect_near(change.change, 0.5, 1e-7);
    change = measure(
        fixture, true,
        3); /* 3 x 3 pixels have one column more of one sign, and a block of 1 column is left */
    expect_near(change.flicker, (13 * 0.125 + 0.125) / WIDTH, 1e-6);
}

static void means_are_weighted_by_pixels(void **state)
{
    (void)state;
    const struct change list[] = {
        {.surfaces = 20, .compared = 10, .mean = 1, .change = 2, .flicker = 4},
        {.surfaces = 40, .compared = 30, .mean = 5, .change = 6, .flicker = 0}};
    struct change all = change_mean(list, 2);
    assert_int_equal(all.surfaces, 60);
    assert_int_equal(all.compared, 40);
    expect_near(all.mean, 4, 1e-12);
    expect_near(all.change, 5, 1e-12);
    expect_near(all.flicker, 1, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_stands_still_does_not_change, make, drop),
        cmocka_unit_test_setup_teardown(brightening_is_its_factor, make, drop),
        cmocka_unit_test_setup_teardown(moved_textures_are_found_again, make, drop),
        cmocka_unit_test_setup_teardown(what_comes_into_view_is_left_out, make, drop),
        cmocka_unit_test_setup_teardown(a_walking_camera_finds_the_floor_again, make, drop),
        cmocka_unit_test_setup_teardown(flicker_is_the_difference_of_changes, make, drop),
        cmocka_unit_test(means_are_weighted_by_pixels),
    };
    return cmocka_run_group_tests_name("change", tests, NULL, NULL);
}
