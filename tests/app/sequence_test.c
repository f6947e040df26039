/* What of the path tracer `reference` does not show: nets and independence of its numbers, and a
 * checkpoint whose size is not the film's. tracer.py has the pictures. */
#include "app/truth/film.h"
#include "app/truth/sequence.h"

#include "tests/lib/unit.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The first 2^m points of a (0, 2)-sequence in base 2 are a net: every rectangle of 2^-a x 2^-(m-a)
 * of the grid holds exactly one (Niederreiter 1987). Owen's scrambling keeps that, and so must any
 * aligned block of 2^m. */
TEST(test_sobol_points_are_nets)
{
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
TEST(test_dimensions_and_pixels_are_unrelated)
{
    for (int which = 0; which < 3; which++) {
        assert_true(fabs(chi_squared(SEQUENCE_RANDOM, which) - 255) < 5 * 22.6);
        assert_true(chi_squared(SEQUENCE_SOBOL, which) < 255 + 5 * 22.6);
    }
}

static void keep(void *user, enum dt_level level, const char *message)
{
    (void)level;
    snprintf(user, 256, "%s", message);
}

TEST(test_checkpoints_have_the_size_of_the_film)
{
    char path[] = "/tmp/sequence_test.XXXXXX", told[256] = "";
    const struct dt_log log = {keep, told};
    struct film film, wider;
    close(mkstemp(path));
    assert_true(film_create(&film, 3, 2, &log) && film_create(&wider, 4, 2, &log));
    film_add(&film, 4, 0, (float[3]){1, 2, 3});
    film.samples = 1;
    assert_true(film_save(&film, path, "seed=1", &log));
    assert_false(film_load(&wider, path, "seed=1", &log));
    assert_non_null(strstr(told, "wrong size"));
    assert_int_equal(wider.samples, 0);
    film_free(&film);
    film_free(&wider);
    unlink(path);
}

RUN_TESTS("sequence", NULL, NULL)
