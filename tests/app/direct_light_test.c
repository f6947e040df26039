/* Direct light of the rasterized pipeline against the path tracer: two ways to the same number that
 * share the scene and nothing else. Runs from the root of the project; $DIPTYCH_BUILD is the folder
 * of the executable, build without it. */

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "app/picture/hdr.h"

enum { SIDE = 64, CHANNELS = 4 };

static void print(void *user, enum dt_level level, const char *message)
{
    (void)user;
    (void)level;
    print_message("%s\n", message);
}

/* The picture that a command line of diptych writes; free(). */
static float *picture(const char *arguments)
{
    const struct dt_log log = {print, NULL};
    const char *build = getenv("DIPTYCH_BUILD");
    char path[] = "/tmp/direct_light_test.XXXXXX.exr", command[1024];
    int descriptor = mkstemps(path, 4);
    assert_true(descriptor >= 0);
    close(descriptor);
    snprintf(command, sizeof command, "%s/diptych %s --size %dx%d -o %s 2>/dev/null",
             build ? build : "build", arguments, SIDE, SIDE, path);
    assert_int_equal(system(command), 0);
    uint32_t width, height;
    float *texels;
    assert_true(hdr_read(path, &width, &height, &texels, &log));
    assert_int_equal(width, SIDE);
    assert_int_equal(height, SIDE);
    unlink(path);
    return texels;
}

/* The pipeline stores normals and albedo as half floats (a relative error of 5e-4 each), filters
 * the border of a shadow over three texels of its map, and lets no light through the two texels
 * around a silhouette: so all but a few pixels agree to 2e-3, and the mean to 3e-3. `odd` is the
 * part of pixels that may be off; they lie on borders of shadows. */
static void hold_against(const char *scene, double odd)
{
    char render[256], reference[256];
    snprintf(render, sizeof render, "render --scene %s --backend vk --set bounces=0", scene);
    snprintf(reference, sizeof reference, "reference --scene %s --bounces 0 --spp 1", scene);
    float *shown = picture(render), *traced = picture(reference);
    double sum[2] = {0, 0};
    int off = 0, lit = 0;
    for (size_t i = 0; i < (size_t)SIDE * SIDE * CHANNELS; i++) {
        if (i % CHANNELS == 3)
            continue;
        sum[0] += shown[i];
        sum[1] += traced[i];
        off += fabsf(shown[i] - traced[i]) > 2e-3f * traced[i];
        lit += traced[i] > 0;
    }
    print_message("# %s: ratio of means %.5f, %.4f of the numbers off, %.3f lit\n", scene,
                  sum[0] / sum[1], off / (3.0 * SIDE * SIDE), lit / (3.0 * SIDE * SIDE));
    assert_true(fabs(sum[0] / sum[1] - 1) < 3e-3);
    assert_true(off < odd * 3 * SIDE * SIDE);
    assert_true(lit > 0.05 * 3 * SIDE * SIDE);
    free(shown);
    free(traced);
}

static void test_spot_light(void **state)
{
    (void)state;
    hold_against("scenes/cornell.yaml", 0.02);
}

static void test_directional_light(void **state)
{
    (void)state;
    hold_against("scenes/atrium.yaml", 0.06);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spot_light),
        cmocka_unit_test(test_directional_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
