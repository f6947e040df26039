/* C reads the GPU's output by the generated structs, from both backends; the GPU reads the live
 * block that C fills. The values are those of specs/layout_fill.glsl: 100 * element + a running
 * number. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dump_reader.h"
#include "layouts.h"

static const char *backends[] = {"gl", "vk"};

static void open_dump(struct dump *dump, const char *backend)
{
    char arguments[256];
    snprintf(
        arguments, sizeof arguments,
        "--scene scenes/cornell.yaml --spec tests/specs/layouts.yaml --size 8x8 --set gain=1.5 "
        "--backend %s",
        backend);
    dump_render(dump, arguments);
}

/* Fails unless the n floats at `values` are first, first + 1, ... */
static void expect_floats(const float *values, int n, float first)
{
    for (int i = 0; i < n; ++i)
        assert_true(values[i] == first + (float)i);
}

static void expect_ints(const int32_t *values, int n, int first)
{
    for (int i = 0; i < n; ++i)
        assert_int_equal(values[i], first + i);
}

static void structs_match(void **state)
{
    (void)state;
    for (size_t b = 0; b < 2; ++b) {
        struct dump dump;
        open_dump(&dump, backends[b]);
        struct dump_entry tight = dump_read(&dump, "fill", "tight");
        struct dump_entry holes = dump_read(&dump, "fill", "holes");
        struct dump_entry arrays = dump_read(&dump, "fill", "arrays");
        struct dump_entry matrices = dump_read(&dump, "fill", "matrices");
        assert_int_equal(tight.size, 3 * sizeof(struct layouts_Tight));
        assert_int_equal(holes.size, 3 * sizeof(struct layouts_Holes));
        assert_int_equal(arrays.size, 3 * sizeof(struct layouts_Arrays));
        assert_int_equal(matrices.size, 3 * sizeof(struct layouts_Matrix));
        for (int i = 0; i < 3; ++i) {
            float v = 100.0f * (float)i;
            struct layouts_Tight t = ((const struct layouts_Tight *)tight.data)[i];
            assert_true(t.a == v + 1 && t.b == v + 2 && t.c == (uint32_t)v + 3);
            struct layouts_Holes h = ((const struct layouts_Holes *)holes.data)[i];
            assert_true(h.a == v + 1 && h.c == v + 5 && h.e == v + 8 && h.h == (int)v + 15);
            expect_floats(h.b, 3, v + 2);
            expect_floats(h.d, 2, v + 6);
            expect_floats(h.f, 4, v + 9);
            expect_ints(h.g, 2, (int)v + 13);
            struct layouts_Arrays a = ((const struct layouts_Arrays *)arrays.data)[i];
            expect_floats(a.a, 3, v + 1);
            expect_floats(a.b[0], 3, v + 4);
            expect_floats(a.b[1], 3, v + 7);
            assert_int_equal(a.c, (int)v + 10);
            for (int k = 0; k < 3; ++k)
                expect_floats(a.d[k], 2, v + 11 + 2 * (float)k);
            expect_ints((const int32_t *)a.e, 3, (int)v + 17);
            assert_int_equal(a.f, (int)v + 20);
            struct layouts_Matrix m = ((const struct layouts_Matrix *)matrices.data)[i];
            assert_int_equal(m.a, (int)v + 1);
            for (int c = 0; c < 4; ++c)
                expect_floats(m.m[c], 4, v + 2 + 4 * (float)c);
            expect_ints(m.b, 3, (int)v + 18);
        }
        dump_entry_free(&tight);
        dump_entry_free(&holes);
        dump_entry_free(&arrays);
        dump_entry_free(&matrices);
        dump_close(&dump);
    }
}

static void arrays_of_vectors_have_strides_of_std430(void **state)
{
    (void)state;
    for (size_t b = 0; b < 2; ++b) {
        struct dump dump;
        open_dump(&dump, backends[b]);
        struct dump_entry scalars = dump_read(&dump, "fill", "scalars");
        struct dump_entry vectors = dump_read(&dump, "fill", "vectors");
        assert_int_equal(scalars.stride, 4);
        assert_int_equal(vectors.stride, 16); /* OpenGL 4.6 core, 7.6.2.2, rules 3 and 4 */
        for (int i = 0; i < 3; ++i) {
            expect_floats((const float *)(scalars.data + 4 * i), 1, 100.0f * (float)i + 1);
            expect_floats((const float *)(vectors.data + 16 * i), 3, 100.0f * (float)i + 1);
        }
        dump_entry_free(&scalars);
        dump_entry_free(&vectors);
        dump_close(&dump);
    }
}

static void live_block_matches(void **state)
{
    (void)state;
    for (size_t b = 0; b < 2; ++b) {
        struct dump dump;
        open_dump(&dump, backends[b]);
        struct dump_entry seen = dump_read(&dump, "see", "seen");
        struct layouts_Seen live;
        assert_int_equal(seen.size, sizeof live);
        memcpy(&live, seen.data, sizeof live);
        assert_true(live.gain ==
                    1.5f); /* open_dump sets gain=1.5, the others keep the spec's values */
        assert_true(live.tint[0] == 0.25f && live.tint[1] == 0.5f && live.tint[2] == 0.75f);
        assert_int_equal(live.steps, 7);
        assert_int_equal(live.grid[0], 3);
        assert_int_equal(live.grid[1], 5);
        assert_int_equal(live.flag, 1);
        dump_entry_free(&seen);
        dump_close(&dump);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(structs_match),
        cmocka_unit_test(arrays_of_vectors_have_strides_of_std430),
        cmocka_unit_test(live_block_matches),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
