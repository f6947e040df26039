/* Maps of clusters against rays, in 500 directions over all maps of a bounce that ssvp.yaml keeps in
 * three frames; with 8 per frame, maps of one frame alone would give too few directions. A map
 * must show the surface that Embree hits first. With DIPTYCH_LONG more scenes and clusters; with
 * DIPTYCH_SCENES, the folder of the paper's meshes, Sibenik, too. */
#include "app/truth/rays.h"
#include "dump_reader.h"
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

enum { TEXELS = 500, MOST_WRONG = 2 };

static void print(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level >= DT_WARNING)
        print_message("%s\n", message);
}

static const struct dt_log loud = {print, NULL};

static struct vec3 field(const struct dump_entry *views, size_t index, const char *name)
{
    return vec3_of(dump_field(views, index, name));
}

/* The ray of reach 1 through the centre of a texel (Cigolle et al. 2014). */
static struct vec3 texel_ray(const struct dump_entry *views, size_t eye, const double p[2])
{
    double edge = fmax(fabs(p[0]), fabs(p[1]));
    struct vec3 x = scale(field(views, eye, "tangent"), (float)p[0]);
    struct vec3 y = scale(field(views, eye, "bitangent"), (float)p[1]);
    struct vec3 z = scale(field(views, eye, "normal"), (float)(sqrt(2) * (1 - edge)));
    return add(add(x, y), z);
}

static bool is_right(const struct ray_scene *rays, struct vec3 eye, struct vec3 ray, float reach)
{
    struct ray_hit hit;
    float length = sqrtf(dot(ray, ray));
    if (!ray_closest(rays, eye, scale(ray, 1 / length), &hit))
        return reach > 1e29f;
    struct vec3 d = subtract(hit.position, eye);
    float distance = sqrtf(dot(d, d));
    return fabsf(reach * length - distance) <= 1e-3f * distance;
}

/* Counts texels that are off by more than 0.1 %, among TEXELS texels that the R2 sequence spreads
 * evenly. */
static int count_wrong(const struct dump *dump, const struct ray_scene *rays, const char *bounce)
{
    char name[32];
    snprintf(name, sizeof name, "%s.eyes", bounce);
    struct dump_entry eyes = dump_read(dump, NULL, name);
    snprintf(name, sizeof name, "%s.reach", bounce);
    struct dump_entry map = dump_read(dump, NULL, name);
    int wrong = 0, looked = 0;
    for (unsigned k = 0; looked < TEXELS && k < 4 * TEXELS; k++) {
        size_t eye = k % eyes.count;
        size_t x = (size_t)(fmod(k * 0.7548776662, 1) * (double)map.width);
        size_t y = (size_t)(fmod(k * 0.5698402910, 1) * (double)map.height);
        double p[2] = {(2 * (double)x + 1) / (double)map.width - 1,
                       (2 * (double)y + 1) / (double)map.height - 1};
        int used;
        float reach[4];
        memcpy(&used, dump_field(&eyes, eye, "used"), sizeof used);
        if (!used)
            continue;
        dump_texel(&map, x, y, eye, reach);
        wrong += !is_right(rays, field(&eyes, eye, "position"), texel_ray(&eyes, eye, p), reach[0]);
        looked++;
    }
    assert_int_equal(looked, TEXELS);
    dump_entry_free(&eyes);
    dump_entry_free(&map);
    return wrong;
}

static void hold(const char *path, const char *scenes, const char *sets)
{
    char arguments[512];
    struct dump dump;
    struct scene scene = {0};
    snprintf(arguments, sizeof arguments, "--scene %s --backend vk --size 64x36 --frames 3 %s",
             path, sets);
    dump_render(&dump, arguments);
    assert_true(scene_load(&scene, path, scenes, false, &loud));
    struct ray_scene *rays = ray_scene_open(&scene.data, &loud);
    assert_non_null(rays);
    int first = count_wrong(&dump, rays, "first"), second = count_wrong(&dump, rays, "second");
    print_message("# %s %s: %d and %d of %d texels are wrong\n", path, sets, first, second, TEXELS);
    assert_in_range(first, 0, MOST_WRONG);
    assert_in_range(second, 0, MOST_WRONG);
    ray_scene_close(rays);
    scene_free(&scene);
    dump_close(&dump);
}

static void eyes_see_what_rays_hit(void **state)
{
    (void)state;
    const char *scenes = getenv("DIPTYCH_SCENES");
    hold("scenes/cornell.yaml", NULL, "");
    if (!getenv("DIPTYCH_LONG"))
        return;
    hold("scenes/cornell.yaml", NULL, "--set clusters=32");
    hold("scenes/atrium.yaml", NULL, "");
    if (scenes)
        hold("scenes/sibenik.yaml", scenes, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(eyes_see_what_rays_hit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
