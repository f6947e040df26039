/* The path tracer against results that need no tracer: nets, closed forms of radiometry, rates of
 * convergence, invariances. Scenes are made here, triangle by triangle. */
#include "app/truth/film.h"
#include "app/truth/rays.h"
#include "app/truth/sequence.h"
#include "app/truth/tracer.h"
#include "scenes/scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PI 3.14159265358979323846

/* ---- Fixtures -------------------------------------------------------------------------------- */

struct heard {
    int errors;
    char text[1024]; /* the latest message */
};

static void hear(void *user, enum dt_level level, const char *message)
{
    struct heard *heard = user;
    heard->errors += level == DT_ERROR;
    snprintf(heard->text, sizeof heard->text, "%s", message);
}

static void print(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level >= DT_WARNING)
        print_message("%s\n", message);
}

static const struct dt_log loud = {print, NULL};

enum { MOST_TRIANGLES = 64, MOST_MATERIALS = 4 };

/* A scene that grows by quads, in the form that scene_load gives. */
struct stage {
    struct scene scene;
    struct dt_vertex vertices[3 * MOST_TRIANGLES];
    uint32_t indices[3 * MOST_TRIANGLES];
    struct dt_material materials[MOST_MATERIALS];
    uint8_t texels[64];
};

static void stage_init(struct stage *stage)
{
    *stage = (struct stage){.texels = {255, 255, 255, 255}};
    stage->scene.data = (struct dt_scene){
        .vertices = stage->vertices,
        .indices = stage->indices,
        .materials = stage->materials,
        .texels = stage->texels,
        .texture_width = 1,
        .texture_height = 1,
        .texture_layers = 1,
        .texture_mips = 1,
    };
    for (int i = 0; i < MOST_MATERIALS; i++)
        stage->materials[i] = (struct dt_material){{1, 1, 1}, -1, {0, 0, 0}, 0};
    stage->scene.data.material_count = MOST_MATERIALS;
    for (int i = 0; i < 3; i++) {
        stage->scene.bounds_min[i] = INFINITY;
        stage->scene.bounds_max[i] = -INFINITY;
        stage->scene.light.opening_min[i] = -1e9f;
        stage->scene.light.opening_max[i] = 1e9f;
    }
    stage->scene.light.direction[1] = -1; /* a dark directional light */
}

static void add_vertex(struct stage *stage, const double position[3], const double normal[3],
                       const float uv[2], uint32_t material)
{
    struct scene *scene = &stage->scene;
    uint32_t at = scene->data.vertex_count++;
    assert_true(at < 3 * MOST_TRIANGLES);
    stage->vertices[at].material = material;
    for (int i = 0; i < 3; i++) {
        stage->vertices[at].position[i] = (float)position[i];
        stage->vertices[at].normal[i] = (float)normal[i];
        scene->bounds_min[i] = fminf(scene->bounds_min[i], (float)position[i]);
        scene->bounds_max[i] = fmaxf(scene->bounds_max[i], (float)position[i]);
    }
    memcpy(stage->vertices[at].uv, uv, sizeof stage->vertices[at].uv);
}

/* The parallelogram a, a + u, a + u + v, a + v with texture coordinates from 0 to 1 along u and v;
 * its normal is u x v. */
static void add_quad(struct stage *stage, const double a[3], const double u[3], const double v[3],
                     uint32_t material)
{
    static const int order[6] = {0, 1, 3, 0, 3, 2};
    uint32_t first = stage->scene.data.vertex_count;
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        n[i] /= length;
    for (int k = 0; k < 4; k++) {
        double position[3];
        for (int i = 0; i < 3; i++)
            position[i] = a[i] + (k & 1) * u[i] + (k >> 1) * v[i];
        add_vertex(stage, position, n, (float[2]){(float)(k & 1), (float)(k >> 1)}, material);
    }
    for (int i = 0; i < 6; i++)
        stage->indices[stage->scene.data.index_count++] = first + (uint32_t)order[i];
}

/* An axis-aligned cube, seen from inside or outside alike. */
static void add_cube(struct stage *stage, const double low[3], double side, uint32_t material)
{
    for (int axis = 0; axis < 3; axis++)
        for (int end = 0; end < 2; end++) {
            double a[3] = {low[0], low[1], low[2]}, u[3] = {0}, v[3] = {0};
            a[axis] += end * side;
            u[(axis + 1) % 3] = side;
            v[(axis + 2) % 3] = side;
            add_quad(stage, a, u, v, material);
        }
}

static void stage_frame(struct stage *stage, uint32_t width, uint32_t height,
                        struct dt_frame *frame)
{
    struct scene *scene = &stage->scene;
    double square = 0;
    for (int i = 0; i < 3; i++) {
        scene->center[i] = 0.5f * (scene->bounds_min[i] + scene->bounds_max[i]);
        square += pow(scene->bounds_max[i] - scene->center[i], 2);
    }
    scene->radius = (float)sqrt(square);
    scene_frame(scene, width, height, frame);
    frame->width = width;
    frame->height = height;
}

static void look(struct stage *stage, const double eye[3], const double target[3],
                 const double up[3], double fov_y)
{
    for (int i = 0; i < 3; i++) {
        stage->scene.camera.eye[i] = (float)eye[i];
        stage->scene.camera.target[i] = (float)target[i];
        stage->scene.camera.up[i] = (float)up[i];
    }
    stage->scene.camera.fov_y = (float)fov_y;
}

/* Traces with fresh film; info has everything but the scene and the frame. */
static void trace(struct stage *stage, uint32_t width, uint32_t height, struct tracer_info info,
                  uint32_t samples, struct film *film)
{
    struct dt_frame frame;
    stage_frame(stage, width, height, &frame);
    info.scene = &stage->scene.data;
    info.frame = &frame;
    info.log = &loud;
    if (info.threads == 0)
        info.threads = 2;
    struct tracer *tracer = tracer_open(&info);
    assert_non_null(tracer);
    assert_true(film_create(film, width, height, &loud));
    assert_true(tracer_add(tracer, film, samples));
    assert_int_equal(film->samples, samples);
    tracer_close(tracer);
}

static float *picture_of(const struct film *film)
{
    float *texels = malloc((size_t)film->width * film->height * 3 * sizeof *texels);
    assert_non_null(texels);
    film_mean(film, texels);
    return texels;
}

static double mean_of(const struct film *film)
{
    float *texels = picture_of(film);
    size_t count = (size_t)film->width * film->height * 3;
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += texels[i];
    free(texels);
    return sum / (double)count;
}

static void assert_near(double got, double want, double tolerance, const char *what)
{
    if (!(fabs(got - want) <= tolerance))
        fail_msg("%s: %.9g, expected %.9g within %.2g", what, got, want, tolerance);
}

/* The point of the plane y = 0 that is seen through the centre of a pixel, by the very matrix that
 * the rasterizer's position reconstruction uses; row 0 of a picture is at the top, of NDC at the
 * bottom. */
static void floor_point(const struct dt_frame *frame, uint32_t x, uint32_t y, double point[3])
{
    double end[2][3];
    for (int k = 0; k < 2; k++) {
        double ndc[4] = {2 * (x + 0.5) / frame->width - 1,
                         2 * (frame->height - 1 - y + 0.5) / frame->height - 1, k ? 0.995 : 0.98,
                         1};
        double clip[4] = {0};
        for (int row = 0; row < 4; row++)
            for (int column = 0; column < 4; column++)
                clip[row] +=
                    (double)frame->camera.inverse_view_projection[column][row] * ndc[column];
        for (int i = 0; i < 3; i++)
            end[k][i] = clip[i] / clip[3];
    }
    double t = end[0][1] / (end[0][1] - end[1][1]);
    for (int i = 0; i < 3; i++)
        point[i] = end[0][i] + t * (end[1][i] - end[0][i]);
}

/* ---- Numbers --------------------------------------------------------------------------------- */

/* The first 2^m points of a (0, 2)-sequence in base 2 are a net: every rectangle of 2^-a x 2^-(m-a)
 * of the grid holds exactly one (Niederreiter 1987). Owen's scrambling keeps that, and so must any
 * aligned block of 2^m. */
static void test_sobol_points_are_nets(void **state)
{
    (void)state;
    enum { M = 8, POINTS = 1 << M };
    for (uint32_t pair = 0; pair < 3; pair++)
        for (uint32_t block = 0; block < 3; block++) {
            float points[POINTS][2];
            struct sequence sequence = {SEQUENCE_SOBOL, sequence_seed(7, 11 + pair), 0};
            for (uint32_t i = 0; i < POINTS; i++) {
                sequence.sample = block * POINTS + i;
                sequence_pair(&sequence, pair, points[i]);
                assert_true(points[i][0] >= 0 && points[i][0] < 1 && points[i][1] >= 0 &&
                            points[i][1] < 1);
            }
            for (int a = 0; a <= M; a++) {
                int count[POINTS] = {0};
                for (int i = 0; i < POINTS; i++) {
                    int column = (int)(points[i][0] * (float)(1 << a));
                    int row = (int)(points[i][1] * (float)(1 << (M - a)));
                    count[column << (M - a) | row]++;
                }
                for (int i = 0; i < POINTS; i++)
                    assert_int_equal(count[i], 1);
            }
        }
}

/* Pearson's chi squared of 16 x 16 cells, over pairs of numbers that must be independent; with 255
 * degrees of freedom it is 255 +- 22.6. */
static double chi_squared(enum sequence_kind kind, int which)
{
    enum { SIDE = 16, COUNT = 1 << 14 };
    double cells[SIDE][SIDE] = {{0}}, sum = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        float a[2], b[2];
        struct sequence one = {kind, sequence_seed(1, which == 2 ? i : 5), which == 2 ? 0 : i};
        struct sequence other = one;
        if (which == 1)
            other.seed = sequence_seed(1, 6);
        if (which == 2)
            other.seed = sequence_seed(1, i + 1);
        sequence_pair(&one, 3, a);
        sequence_pair(&other, which == 0 ? 4 : 3, b);
        cells[(int)(a[0] * SIDE)][(int)(b[1] * SIDE)]++;
    }
    for (int i = 0; i < SIDE * SIDE; i++)
        sum += pow(cells[i / SIDE][i % SIDE] - COUNT / 256.0, 2) / (COUNT / 256.0);
    return sum;
}

/* Compares two pairs, two pixels, and neighbouring pixels at one sample. Sobol points are more even
 * than chance along each axis, so only a sum that is too large is an error. */
static void test_dimensions_and_pixels_are_unrelated(void **state)
{
    (void)state;
    for (int which = 0; which < 3; which++) {
        assert_true(fabs(chi_squared(SEQUENCE_RANDOM, which) - 255) < 5 * 22.6);
        assert_true(chi_squared(SEQUENCE_SOBOL, which) < 255 + 5 * 22.6);
    }
}

/* ---- White furnace --------------------------------------------------------------------------- */

/* In a closed room whose walls all emit e and reflect a, radiance is the same everywhere and in all
 * directions: e (1 + a + a^2 + ...). The sum has one term for each allowed bounce, one for the
 * emission towards the eye, and one for direct light. The room is turned, so that no wall lies
 * along an axis, and stands where coordinates are a hundred times its size. */
static void furnace(struct tracer_info info, double albedo, double want, double tolerance)
{
    static const double axes[3][3] = {
        {2, 1, 2}, {-2, 2, 1}, {-1, -2, 2}}; /* orthogonal, length 3 */
    static struct stage stage;
    stage_init(&stage);
    stage.materials[0] =
        (struct dt_material){{(float)albedo, (float)albedo, (float)albedo}, -1, {2, 2, 2}, 0};
    const double corner[3] = {300, 100, -200};
    double eye[3], target[3];
    for (int i = 0; i < 3; i++) {
        eye[i] = corner[i] + 0.5 * (axes[0][i] + axes[1][i] + axes[2][i]);
        target[i] = eye[i] + axes[0][i] + 0.3 * axes[1][i] + 0.2 * axes[2][i];
    }
    for (int axis = 0; axis < 3; axis++)
        for (int end = 0; end < 2; end++) {
            double a[3];
            for (int i = 0; i < 3; i++)
                a[i] = corner[i] + end * axes[axis][i];
            add_quad(&stage, a, axes[(axis + 1) % 3], axes[(axis + 2) % 3], 0);
        }
    look(&stage, eye, target, axes[1], 1.5);
    info.emission = true;
    struct film film;
    trace(&stage, 48, 48, info, 64, &film);
    assert_near(mean_of(&film), want, tolerance * want, "white furnace");
    film_free(&film);
}

static void test_white_furnace(void **state)
{
    (void)state;
    const double e = 2, a = 0.5;
    /* every path finds the same, so only light that leaks out of the room can make a difference */
    furnace((struct tracer_info){.last_bounce = 0}, a, e * (1 + a), 2e-4);
    furnace((struct tracer_info){.last_bounce = 3}, a, e * (1 - pow(a, 5)) / (1 - a), 2e-4);
    furnace((struct tracer_info){.first_bounce = 2, .last_bounce = 3}, a,
            e * (pow(a, 3) + pow(a, 4)), 2e-4);
    furnace((struct tracer_info){.last_bounce = 1, .output = TRACER_IRRADIANCE}, a,
            PI * e * (1 + a), 2e-4);
    furnace((struct tracer_info){.last_bounce = 2, .box_filter = true}, a,
            e * (1 - pow(a, 4)) / (1 - a), 2e-4);
    /* ended by chance: 147,456 paths of a standard deviation below the mean */
    furnace((struct tracer_info){.last_bounce = TRACER_UNLIMITED}, a, e / (1 - a), 4e-3);
    furnace((struct tracer_info){.last_bounce = TRACER_UNLIMITED, .sequence = SEQUENCE_RANDOM}, 0.8,
            e / (1 - 0.8), 8e-3);
}

/* ---- A patch under a light ------------------------------------------------------------------- */

static void floor_stage(struct stage *stage, double half, uint32_t material)
{
    stage_init(stage);
    add_quad(stage, (double[3]){-half, 0, half}, (double[3]){2 * half, 0, 0},
             (double[3]){0, 0, -2 * half}, material);
    look(stage, (double[3]){0.3, 2, 1.5}, (double[3]){0.1, 0, -0.2}, (double[3]){0, 1, 0}, 0.7);
}

static void set_color(struct stage *stage, double r, double g, double b)
{
    stage->scene.light.color[0] = (float)r;
    stage->scene.light.color[1] = (float)g;
    stage->scene.light.color[2] = (float)b;
}

/* Radiance is albedo / pi E cos(theta), from either side of the floor. */
static void test_patch_under_a_directional_light(void **state)
{
    (void)state;
    for (int flipped = 0; flipped < 2; flipped++) {
        static struct stage stage;
        floor_stage(&stage, 4, 1);
        stage.materials[1].albedo[0] = 0.25f;
        stage.materials[1].albedo[1] = 0.5f;
        for (int i = 0; flipped && i < 4; i++)
            stage.vertices[i].normal[1] = -1;
        const float direction[3] = {0.6f, -0.48f, 0.64f};
        memcpy(stage.scene.light.direction, direction, sizeof direction);
        set_color(&stage, 3, 5, 7);
        struct film film;
        trace(&stage, 17, 11, (struct tracer_info){.last_bounce = 2}, 1, &film);
        float *texels = picture_of(&film);
        for (size_t i = 0; i < (size_t)17 * 11; i++) {
            assert_near(texels[3 * i], 0.25 / PI * 3 * 0.48, 1e-6, "red");
            assert_near(texels[3 * i + 1], 0.5 / PI * 5 * 0.48, 1e-6, "green");
            assert_near(texels[3 * i + 2], 1 / PI * 7 * 0.48, 1e-6, "blue");
        }
        free(texels);
        film_free(&film);
    }
}

/* Irradiance is I s(theta) cos(theta') / d^2, with s one inside the inner cone, zero outside the
 * outer, and a smooth step of the cosine between; every pixel at its own centre. */
static void test_patch_under_a_spot_light(void **state)
{
    (void)state;
    static struct stage stage;
    floor_stage(&stage, 4, 0);
    const double position[3] = {0.2, 1.5, -0.3}, axis[3] = {0.28, -0.96, 0};
    const double inner = 0.2, outer = 0.45;
    struct scene_light *light = &stage.scene.light;
    light->kind = DT_LIGHT_SPOT;
    for (int i = 0; i < 3; i++) {
        light->position[i] = (float)position[i];
        light->direction[i] = (float)axis[i];
    }
    light->cone[0] = (float)inner;
    light->cone[1] = (float)outer;
    set_color(&stage, 10, 20, 30);
    enum { WIDTH = 40, HEIGHT = 30 };
    struct film film;
    struct dt_frame frame;
    trace(&stage, WIDTH, HEIGHT,
          (struct tracer_info){.last_bounce = 0, .output = TRACER_IRRADIANCE}, 1, &film);
    stage_frame(&stage, WIDTH, HEIGHT, &frame);
    float *texels = picture_of(&film);
    int lit = 0, shaded = 0, dark = 0;
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            double p[3], square = 0, along = 0;
            floor_point(&frame, x, y, p);
            for (int i = 0; i < 3; i++) {
                square += pow(p[i] - position[i], 2);
                along += (p[i] - position[i]) * axis[i];
            }
            double cosine = along / sqrt(square);
            double t = (cosine - cos(outer)) / (cos(inner) - cos(outer));
            double step = t <= 0 ? 0 : t >= 1 ? 1 : t * t * (3 - 2 * t);
            double want = 20 * step * (position[1] / sqrt(square)) / square;
            assert_near(texels[3 * (y * WIDTH + x) + 1], want, 2e-5 * 20, "spot");
            lit += step == 1;
            dark += step == 0;
            shaded += step > 0 && step < 1;
        }
    assert_true(lit > 20 && shaded > 20 && dark > 20);
    free(texels);
    film_free(&film);
}

/* The light falls straight down. It lights only the floor between `low` and `high`: under the gap
 * of a roof, or under the opening of the light. */
static void shadow_case(bool roof, double low, double high)
{
    static struct stage stage;
    floor_stage(&stage, 4, 0);
    set_color(&stage, 1, 1, 1);
    if (roof)
        add_quad(&stage, (double[3]){high, 3, -4}, (double[3]){4, 0, 0}, (double[3]){0, 0, 8}, 1);
    if (roof)
        add_quad(&stage, (double[3]){low - 4, 3, -4}, (double[3]){4, 0, 0}, (double[3]){0, 0, 8},
                 1);
    else
        stage.scene.light.opening_min[0] = (float)low,
        stage.scene.light.opening_max[0] = (float)high;
    struct film film;
    struct dt_frame frame;
    trace(&stage, 40, 30, (struct tracer_info){.output = TRACER_IRRADIANCE}, 1, &film);
    stage_frame(&stage, 40, 30, &frame);
    float *texels = picture_of(&film);
    int lit = 0, dark = 0;
    double margin = roof ? 1e-4 : 0.0051 * stage.scene.radius; /* of the light's view */
    for (uint32_t i = 0; i < 40 * 30; i++) {
        double p[3];
        floor_point(&frame, i % 40, i / 40, p);
        bool inside = p[0] > low + margin && p[0] < high - margin;
        if (!inside && p[0] > low - margin && p[0] < high + margin)
            continue;
        assert_near(texels[3 * i], inside ? 1 : 0, 1e-6, roof ? "shadow" : "opening");
        lit += inside;
        dark += !inside;
    }
    assert_true(lit > 100 && dark > 100);
    free(texels);
    film_free(&film);
}

static void test_shadow_and_opening(void **state)
{
    (void)state;
    shadow_case(true, -0.21, 0.34);
    shadow_case(false, -0.21, 0.34);
}

/* ---- Form factors and energy ----------------------------------------------------------------- */

/* Form factor from a surface element to a parallel rectangle a x b whose corner lies over it at the
 * distance 1 (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3). */
static double corner_factor(double a, double b)
{
    double p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * PI);
}

/* Unit squares, the second of which emits 1: parallel at the distance 1, or with a common edge. The
 * camera between them sees the first one, exactly. */
static void squares(struct stage *stage, bool parallel)
{
    stage_init(stage);
    stage->materials[1] = (struct dt_material){{0, 0, 0}, -1, {1, 1, 1}, 0};
    add_quad(stage, (double[3]){0, 0, 0}, (double[3]){1, 0, 0}, (double[3]){0, 0, 1}, 0);
    if (parallel)
        add_quad(stage, (double[3]){0, 1, 0}, (double[3]){1, 0, 0}, (double[3]){0, 0, 1}, 1);
    else
        add_quad(stage, (double[3]){0, 0, 0}, (double[3]){0, 1, 0}, (double[3]){0, 0, 1}, 1);
    look(stage, (double[3]){0.5, 0.5, 0.5}, (double[3]){0.5, 0, 0.5}, (double[3]){0, 0, -1},
         PI / 2);
}

static const struct tracer_info of_emitter = {.output = TRACER_IRRADIANCE, .emission = true};

/* The mean irradiance of the first square is pi F: 0.19982 and 0.20004 (the same catalog, C-11 and
 * C-14, which give these two for unit squares). */
static void test_form_factors_of_squares(void **state)
{
    (void)state;
    static const double want[2] = {0.2000438, 0.1998249};
    for (int parallel = 0; parallel < 2; parallel++) {
        static struct stage stage;
        struct film film;
        squares(&stage, parallel);
        trace(&stage, 48, 48, of_emitter, 256, &film);
        assert_near(mean_of(&film) / PI, want[parallel], 3e-3 * want[parallel], "form factor");
        film_free(&film);
    }
}

/* The same number by light that is reflected once: a floor of albedo a under a light from straight
 * above. This light does not reach the wall on the floor's edge. */
static void test_first_bounce_of_a_directional_light(void **state)
{
    (void)state;
    static struct stage stage;
    struct film film;
    squares(&stage, false);
    stage.materials[0] = (struct dt_material){{0.5f, 0.5f, 0.5f}, -1, {0, 0, 0}, 0};
    look(&stage, (double[3]){0.5, 0.5, 0.5}, (double[3]){0, 0.5, 0.5}, (double[3]){0, 1, 0},
         PI / 2);
    set_color(&stage, 3, 3, 3);
    const struct tracer_info first = {
        .first_bounce = 1, .last_bounce = 1, .output = TRACER_IRRADIANCE};
    trace(&stage, 48, 48, first, 256, &film);
    assert_near(mean_of(&film) / (0.5 * 3), 0.2000438, 3e-3 * 0.2, "first bounce");
    film_free(&film);
}

/* In a closed cube of albedo a that holds a spot light of flux P, the k-th bounce brings the walls
 * a^k P, wherever it lands. Six square views from the centre show the walls evenly. */
static void test_energy_of_each_bounce_in_a_closed_box(void **state)
{
    (void)state;
    static struct stage stage;
    stage_init(&stage);
    const double albedo = 0.75, inner = 0.4, outer = 0.7, side = 2;
    for (int i = 0; i < 3; i++)
        stage.materials[0].albedo[i] = (float)albedo;
    add_cube(&stage, (double[3]){-1, -1, -1}, side, 0);
    struct scene_light *light = &stage.scene.light;
    light->kind = DT_LIGHT_SPOT;
    memcpy(light->position, (float[3]){0.3f, 0.5f, -0.4f}, sizeof light->position);
    memcpy(light->direction, (float[3]){0.48f, -0.6f, 0.64f}, sizeof light->direction);
    light->cone[0] = (float)inner;
    light->cone[1] = (float)outer;
    set_color(&stage, 5, 5, 5);
    /* the mean of a smooth step is one half */
    double flux = 5 * 2 * PI * (1 - cos(inner) + (cos(inner) - cos(outer)) / 2);
    for (uint32_t k = 0; k < 4; k++) {
        double sum = 0;
        for (int face = 0; face < 6; face++) {
            double target[3] = {0}, up[3] = {0};
            target[face / 2] = face % 2 ? 1 : -1;
            up[(face / 2 + 1) % 3] = 1;
            look(&stage, (double[3]){0, 0, 0}, target, up, PI / 2);
            struct film film;
            trace(&stage, 48, 48,
                  (struct tracer_info){
                      .first_bounce = k, .last_bounce = k, .output = TRACER_IRRADIANCE},
                  k == 0 ? 1 : 64, &film);
            sum += mean_of(&film) * side * side;
            film_free(&film);
        }
        assert_near(sum / flux, pow(albedo, k), 4e-3 * pow(albedo, k), "flux of a bounce");
    }
}

/* Hidden surfaces stay dark. First, a screen hides a plane from the spot and from the floor that
 * the spot lights. Then a plane has nothing over it. Its interpolated normals lean so far that half
 * of their directions hit the plane itself. */
static void test_hidden_surfaces_stay_dark(void **state)
{
    (void)state;
    for (int leaning = 0; leaning < 2; leaning++) {
        static struct stage stage;
        struct film film;
        floor_stage(&stage, 1, 0);
        for (int i = 0; leaning && i < 4; i++)
            memcpy(stage.vertices[i].normal, (float[3]){0.96f, 0.28f, 0}, sizeof(float[3]));
        stage.scene.light = (struct scene_light){.kind = DT_LIGHT_SPOT,
                                                 .position = {0, 0.6f, 0},
                                                 .direction = {0, -1, 0},
                                                 .cone = {0.5f, 0.9f},
                                                 .color = {1, 1, 1}};
        for (int i = 0; !leaning && i < 2; i++) /* the screen, and the plane behind it */
            add_quad(&stage, (double[3]){-4, 0.75 + 0.25 * i, -4}, (double[3]){8, 0, 0},
                     (double[3]){0, 0, 8}, 0);
        look(&stage, (double[3]){0, 0.9, 0}, (double[3]){0, leaning ? 0 : 1, 0},
             (double[3]){1, 0, 0}, 0.8);
        struct tracer_info info = {.last_bounce = 0, .output = TRACER_IRRADIANCE};
        trace(&stage, 16, 16, info, 1, &film);
        assert_int_equal(mean_of(&film) > 0, leaning);
        film_free(&film);
        info.first_bounce = info.last_bounce = 1;
        info.emission = leaning;
        stage.materials[0].emission[0] = 1;
        trace(&stage, 16, 16, info, 64, &film);
        assert_true(mean_of(&film) == 0);
        film_free(&film);
    }
}

/* ---- Convergence ----------------------------------------------------------------------------- */

struct errors {
    double truth; /* root mean square error of a pixel, relative to the mean of the picture */
    double guess; /* film_noise */
};

/* Parallel squares, pixel by pixel, against the form factor of every pixel's own point. */
static struct errors square_errors(enum sequence_kind kind, uint32_t samples)
{
    enum { SIDE = 48 };
    static struct stage stage;
    struct tracer_info info = of_emitter;
    struct film film;
    info.sequence = kind;
    squares(&stage, true);
    trace(&stage, SIDE, SIDE, info, samples, &film);
    float *texels = picture_of(&film);
    double squares = 0, sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        int column = i % SIDE, row = i / SIDE;
        double x = (column + 0.5) / SIDE, y = (row + 0.5) / SIDE; /* symmetric either way */
        double want = PI * (corner_factor(x, y) + corner_factor(1 - x, y) +
                            corner_factor(x, 1 - y) + corner_factor(1 - x, 1 - y));
        squares += pow(texels[(size_t)i * 3] - want, 2);
        sum += want;
    }
    struct errors errors = {sqrt(squares * SIDE * SIDE) / sum, film_noise(&film)};
    free(texels);
    film_free(&film);
    return errors;
}

/* Slope of the line through (log N, log error) for N = 16, 64, 256, 1024. The film's own estimate
 * of the noise is right for independent numbers and not too low for Sobol points. */
static double slope(enum sequence_kind kind, double *last)
{
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        struct errors errors = square_errors(kind, 16u << (2 * i));
        sum += (2 * i - 3) * log(errors.truth);
        *last = errors.truth;
        if (kind == SEQUENCE_RANDOM)
            assert_near(errors.guess / errors.truth, 1, 0.08, "noise of random numbers");
        else
            assert_true(errors.guess > 0.98 * errors.truth && errors.guess < 1.8 * errors.truth);
    }
    return sum / (20 * log(2)); /* abscissae -3, -1, 1, 3 times log 2 */
}

static void test_convergence_rate(void **state)
{
    (void)state;
    double random, sobol;
    assert_near(slope(SEQUENCE_RANDOM, &random), -0.5, 0.02, "rate of independent numbers");
    assert_true(slope(SEQUENCE_SOBOL, &sobol) < -0.65);
    assert_true(sobol < random / 4);
}

/* ---- The same bits --------------------------------------------------------------------------- */

static void gallery(struct stage *stage, double size)
{
    stage_init(stage);
    add_cube(stage, (double[3]){-size, -size, -size}, 2 * size, 0);
    add_cube(stage, (double[3]){-0.2 * size, -size, -0.3 * size}, 0.6 * size, 1);
    stage->materials[0].albedo[1] = 0.5f;
    stage->materials[1].albedo[2] = 0.25f;
    struct scene_light *light = &stage->scene.light;
    light->kind = DT_LIGHT_SPOT;
    for (int i = 0; i < 3; i++)
        light->position[i] = (float)(size * (0.8 - 0.3 * i));
    memcpy(light->direction, (float[3]){-0.64f, -0.48f, 0.6f}, sizeof light->direction);
    light->cone[0] = 0.5f;
    light->cone[1] = 0.6f;
    set_color(stage, size * size, 2 * size * size, 3 * size * size);
    look(stage, (double[3]){-0.7 * size, 0.3 * size, 0.9 * size},
         (double[3]){0.1 * size, -0.2 * size, 0}, (double[3]){0, 1, 0}, 1.1);
}

static const struct tracer_info of_gallery = {.last_bounce = TRACER_UNLIMITED, .box_filter = true};

static void assert_same_film(const struct film *a, const struct film *b)
{
    size_t size = (size_t)a->width * a->height * 3 * sizeof(double);
    assert_int_equal(a->samples, b->samples);
    assert_memory_equal(a->sums[0], b->sums[0], size);
    assert_memory_equal(a->sums[1], b->sums[1], size);
}

static void test_threads_leave_no_trace(void **state)
{
    (void)state;
    static struct stage stage;
    struct film film[3], other;
    gallery(&stage, 1);
    for (int i = 0; i < 3; i++) {
        struct tracer_info info = of_gallery;
        info.threads = 1u << (i * 3 / 2); /* 1, 2, 8 */
        trace(&stage, 53, 37, info, 13, &film[i]);
    }
    struct tracer_info info = of_gallery;
    info.seed = 1;
    trace(&stage, 53, 37, info, 13, &other);
    assert_true(mean_of(&film[0]) > 0);
    assert_same_film(&film[0], &film[1]);
    assert_same_film(&film[0], &film[2]);
    assert_true(mean_of(&film[0]) != mean_of(&other)); /* the seed changes the film */
    for (int i = 0; i < 3; i++)
        film_free(&film[i]);
    film_free(&other);
}

/* Lengths scale by a power of two, intensities by its square. The picture stays the same to the
 * last bit, since the tracer has no length of its own. */
static void test_scale_leaves_no_trace(void **state)
{
    (void)state;
    static struct stage stage;
    struct film film, scaled;
    gallery(&stage, 1);
    trace(&stage, 31, 23, of_gallery, 8, &film);
    gallery(&stage, 0x1p-10);
    trace(&stage, 31, 23, of_gallery, 8, &scaled);
    assert_same_film(&film, &scaled);
    film_free(&film);
    film_free(&scaled);
}

static void trace_gallery(struct film *film, const uint32_t *counts, int count, const char *path)
{
    static struct stage stage;
    struct dt_frame frame;
    struct tracer_info info = of_gallery;
    gallery(&stage, 1);
    stage_frame(&stage, 21, 19, &frame);
    info.scene = &stage.scene.data;
    info.frame = &frame;
    info.log = &loud;
    struct tracer *tracer = tracer_open(&info);
    assert_non_null(tracer);
    assert_true(film_create(film, 21, 19, &loud));
    for (int i = 0; i < count; i++) {
        assert_true(tracer_add(tracer, film, counts[i]));
        if (!path)
            continue;
        assert_true(film_save(film, path, "gallery", &loud));
        film_free(film);
        assert_true(film_create(film, 21, 19, &loud));
        assert_true(film_load(film, path, "gallery", &loud));
    }
    tracer_close(tracer);
}

static void test_resumed_is_uninterrupted(void **state)
{
    (void)state;
    char path[] = "/tmp/tracer_test.XXXXXX";
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    struct film whole, parts;
    trace_gallery(&whole, (uint32_t[]){24}, 1, NULL);
    trace_gallery(&parts, (uint32_t[]){1, 1, 5, 9, 8}, 5, path);
    assert_same_film(&whole, &parts);
    film_free(&whole);
    film_free(&parts);
    unlink(path);
}

static void refuse_checkpoint(const char *path, const char *settings, uint32_t width,
                              const char *reason)
{
    struct heard heard = {0};
    const struct dt_log log = {hear, &heard};
    struct film film;
    assert_true(film_create(&film, width, 2, &loud));
    assert_false(film_load(&film, path, settings, &log));
    assert_int_equal(heard.errors, 1);
    if (!strstr(heard.text, reason) || !strstr(heard.text, path))
        fail_msg("%s", heard.text);
    assert_int_equal(film.samples, 0);
    film_free(&film);
}

static void test_other_checkpoints_are_refused(void **state)
{
    (void)state;
    char path[] = "/tmp/tracer_test.XXXXXX";
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    struct film film;
    assert_true(film_create(&film, 3, 2, &loud));
    film_add(&film, 4, 0, (float[3]){1, 2, 3});
    film.samples = 1;
    assert_true(film_save(&film, path, "seed=1", &loud));
    film_free(&film);
    refuse_checkpoint(path, "seed=2", 3, "other settings (seed=1, not seed=2)");
    refuse_checkpoint(path, "seed=1", 4, "wrong size");
    refuse_checkpoint("/tmp", "seed=1", 3, "cannot be read");
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, -40, SEEK_END), 0);
    int byte = fgetc(file);
    assert_int_equal(fseek(file, -40, SEEK_END), 0);
    assert_true(fputc(byte ^ 1, file) >= 0);
    assert_int_equal(fclose(file), 0);
    refuse_checkpoint(path, "seed=1", 3, "damaged");
    assert_int_equal(truncate(path, 5), 0);
    refuse_checkpoint(path, "seed=1", 3, "damaged");
    unlink(path);
}

/* ---- Materials ------------------------------------------------------------------------------- */

/* A texture of 2 x 2 codes on a floor one unit wide. At the texels' centres it has their colour in
 * linear light, half way between two of them their mean. The texture repeats. */
static void test_textures(void **state)
{
    (void)state;
    static const uint8_t codes[16] = {0,   188, 255, 255, 255, 188, 255, 255,
                                      255, 188, 0,   255, 255, 188, 0,   255};
    static const double half = 0.50288653; /* code 188, by the formula of IEC 61966-2-1 */
    static const struct {
        double u, v, rgb[3];
    } points[] = {{0.25, 0.25, {0, half, 1}},   {0.75, 0.25, {1, half, 1}},
                  {0.25, 0.75, {1, half, 0}},   {0.5, 0.25, {0.5, half, 1}},
                  {0.75, 0.5, {1, half, 0.5}},  {0, 0.25, {0.5, half, 1}},
                  {0.5, 0.5, {0.75, half, 0.5}}};
    static struct stage stage;
    floor_stage(&stage, 0.5, 0);
    stage.materials[0].texture = 0;
    memcpy(stage.texels, codes, sizeof codes);
    stage.scene.data.texture_width = stage.scene.data.texture_height = 2;
    struct ray_scene *rays = ray_scene_open(&stage.scene.data, &loud);
    assert_non_null(rays);
    for (size_t i = 0; i < DT_ARRAY_COUNT(points); i++) {
        struct vec3 origin = {(float)(points[i].u - 0.5 + 1e-6), 3, (float)(0.5 - points[i].v)};
        struct ray_hit hit;
        assert_true(ray_closest(rays, origin, (struct vec3){0, -1, 0}, &hit));
        assert_near(hit.albedo.x, points[i].rgb[0], 1e-5, "red");
        assert_near(hit.albedo.y, points[i].rgb[1], 1e-5, "green");
        assert_near(hit.albedo.z, points[i].rgb[2], 1e-5, "blue");
        assert_near(hit.normal.y, 1, 0, "towards the origin of the ray");
    }
    ray_scene_close(rays);
}

/* Rays and light pass a curtain only through the holes of its texture. */
static void test_holes(void **state)
{
    (void)state;
    static struct stage stage;
    floor_stage(&stage, 0.5, 0);
    add_quad(&stage, (double[3]){-0.5, 1, 0.5}, (double[3]){1, 0, 0}, (double[3]){0, 0, -1}, 1);
    stage.materials[1].texture = 0;
    stage.materials[1].alpha_cutoff = 0.5f;
    memset(stage.texels, 255, 16);
    stage.texels[3] = 0; /* u and v below a half */
    stage.scene.data.texture_width = stage.scene.data.texture_height = 2;
    struct ray_scene *rays = ray_scene_open(&stage.scene.data, &loud);
    assert_non_null(rays);
    for (int i = 0; i < 4; i++) {
        struct vec3 origin = {(float)(i & 1) * 0.5f - 0.25f, 3, 0.25f - (float)(i >> 1) * 0.5f};
        const struct vec3 down = {0, -1, 0};
        struct ray_hit hit;
        assert_true(ray_closest(rays, origin, down, &hit));
        assert_near(hit.position.y, i == 0 ? 0 : 1, 0, "what is hit");
        assert_int_equal(ray_blocked(rays, origin, down, 2.5f), i != 0);
        assert_true(ray_blocked(rays, origin, down, 3.5f));
        assert_false(ray_blocked(rays, origin, down, 1.5f));
    }
    ray_scene_close(rays);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sobol_points_are_nets),
        cmocka_unit_test(test_dimensions_and_pixels_are_unrelated),
        cmocka_unit_test(test_white_furnace),
        cmocka_unit_test(test_patch_under_a_directional_light),
        cmocka_unit_test(test_patch_under_a_spot_light),
        cmocka_unit_test(test_shadow_and_opening),
        cmocka_unit_test(test_form_factors_of_squares),
        cmocka_unit_test(test_first_bounce_of_a_directional_light),
        cmocka_unit_test(test_energy_of_each_bounce_in_a_closed_box),
        cmocka_unit_test(test_hidden_surfaces_stay_dark),
        cmocka_unit_test(test_convergence_rate),
        cmocka_unit_test(test_threads_leave_no_trace),
        cmocka_unit_test(test_scale_leaves_no_trace),
        cmocka_unit_test(test_resumed_is_uninterrupted),
        cmocka_unit_test(test_other_checkpoints_are_refused),
        cmocka_unit_test(test_textures),
        cmocka_unit_test(test_holes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
