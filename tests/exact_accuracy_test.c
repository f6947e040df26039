/* Results of tests/specs/exact.yaml against double precision. That both backends give the same bits
 * is not enough: a replacement could be wrong in both. Bounds of the replaced functions are those
 * that templates/glsl/exact.glsl states or that its order of operations implies, in units u = 2^-24
 * of rounding; of the others, those of the Vulkan specification, "Precision and Operation of SPIR-V
 * Instructions". */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "dump_reader.h"

#define CASES   4096
#define SPECIAL 256 /* cases before are pairs of special values */

static const double u = 0x1p-24;
static const double pi = 3.14159265358979323846;
static struct dump dumps[2]; /* OpenGL, Vulkan */

struct input {
    float a[4], b[4], s[4];
};

static struct input input(const struct dump_entry *inputs, size_t i)
{
    struct input in;
    memcpy(in.a, dump_field(inputs, i, "a"), sizeof in.a);
    memcpy(in.b, dump_field(inputs, i, "b"), sizeof in.b);
    memcpy(in.s, dump_field(inputs, i, "s"), sizeof in.s);
    return in;
}

static const float *field(const struct dump_entry *entry, size_t i, const char *name)
{
    return dump_field(entry, i, name);
}

/* Distance of neighbouring floats at x. */
static double ulp(double x)
{
    float f = fmaxf(fabsf((float)x), 0x1p-126f);
    return (double)nextafterf(f, INFINITY) - f;
}

static void expect(const char *what, size_t i, double value, double expected, double bound)
{
    if (!(fabs(value - expected) <= bound))
        fail_msg("%s of case %zu: %.9g, expected %.9g within %.3g", what, i, value, expected,
                 bound);
}

static void expect_ulp(const char *what, size_t i, double value, double expected, double ulps)
{
    expect(what, i, value, expected, ulps * ulp(expected));
}

/* Sum of the first n products, and of their magnitudes. */
static double dot(const float *a, const float *b, int n, double *magnitude)
{
    double sum = 0;
    *magnitude = 0;
    for (int k = 0; k < n; k++) {
        sum += (double)a[k] * b[k];
        *magnitude += fabs((double)a[k] * b[k]);
    }
    return sum;
}

typedef void check_case(size_t i, const struct input *in, const struct dump_entry *results);

static void each_case(const char *resource, check_case *check)
{
    for (int b = 0; b < 2; b++) {
        struct dump_entry inputs = dump_read(&dumps[b], NULL, "inputs");
        struct dump_entry results = dump_read(&dumps[b], NULL, resource);
        assert_int_equal(inputs.count, CASES);
        assert_int_equal(results.count, CASES);
        for (size_t i = SPECIAL; i < CASES; i++) {
            struct input in = input(&inputs, i);
            check(i, &in, &results);
        }
        dump_entry_free(&inputs);
        dump_entry_free(&results);
    }
}

/* ---- Geometry -------------------------------------------------------------------------------- */

static void check_lengths(size_t i, const struct input *in, const struct dump_entry *results)
{
    for (int n = 1; n <= 4; n++) {
        double magnitude, apart = 0;
        double sum = dot(in->a, in->b, n, &magnitude);
        expect("dot", i, field(results, i, "dots")[n - 1], sum, n * u * magnitude * 1.01);
        double square = dot(in->a, in->a, n, &magnitude);
        expect_ulp("length", i, field(results, i, "lengths")[n - 1], sqrt(square), 3);
        for (int k = 0; k < n; k++)
            apart += ((double)in->a[k] - in->b[k]) * ((double)in->a[k] - in->b[k]);
        expect_ulp("distance", i, field(results, i, "distances")[n - 1], sqrt(apart), 4);
    }
}

static void check_vectors(size_t i, const struct input *in, const struct dump_entry *results)
{
    double magnitude, length = sqrt(dot(in->a, in->a, 4, &magnitude));
    double along = dot(in->s, in->a, 4, &magnitude), side = dot(in->s, in->b, 4, &magnitude);
    double s0 = in->s[0];
    for (int k = 0; k < 4; k++) {
        double a = in->a[k], b = in->b[k], s = in->s[k];
        expect_ulp("normalize", i, field(results, i, "unit")[k], a / length, 6);
        expect("mix", i, field(results, i, "mixed")[k], a * (1 - s) + b * s,
               4 * u * (fabs(a * (1 - s)) + fabs(b * s)));
        expect("mix by a scalar", i, field(results, i, "mixed_evenly")[k], a * (1 - s0) + b * s0,
               4 * u * (fabs(a * (1 - s0)) + fabs(b * s0)));
        dot(in->s, in->a, 4, &magnitude);
        expect("reflect", i, field(results, i, "mirrored")[k], a - 2 * along * s,
               8 * u * (fabs(a) + 2 * magnitude * fabs(s)));
        dot(in->s, in->b, 4, &magnitude);
        if (fabs(side) > 8 * u * magnitude)
            expect("faceforward", i, field(results, i, "forward")[k], side < 0 ? a : -a, 0);
        if (k < 3) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            double p = (double)in->a[l] * in->b[m], q = (double)in->a[m] * in->b[l];
            expect("cross", i, field(results, i, "crossed")[k], p - q, 4 * u * (fabs(p) + fabs(q)));
        }
    }
}

/* Snell's law: the components along the surface scale by eta, and the direction stays unit. */
static void check_refraction(size_t i, const struct input *in, const struct dump_entry *results)
{
    double magnitude, a = sqrt(dot(in->a, in->a, 4, &magnitude));
    double b = sqrt(dot(in->b, in->b, 4, &magnitude)), eta = 0.75 + 0.25 * (double)in->s[0];
    double cosine = dot(in->a, in->b, 4, &magnitude) / (a * b);
    double k = 1 - eta * eta * (1 - cosine * cosine), bound = 64 * u;
    const float *bent = field(results, i, "bent");
    if (fabs(k) < 0.01)
        return; /* the root has no bound near zero */
    for (int c = 0; c < 4; c++) {
        double incident = in->a[c] / a, normal = in->b[c] / b;
        double expected = k < 0 ? 0 : eta * incident - (eta * cosine + sqrt(k)) * normal;
        expect("refract", i, bent[c], expected, k < 0 ? 0 : bound);
    }
}

static void geometry_is_exact_to_rounding(void **state)
{
    (void)state;
    each_case("geometry", check_lengths);
    each_case("geometry", check_vectors);
    each_case("geometry", check_refraction);
}

/* ---- Angles ---------------------------------------------------------------------------------- */

static void check_angles(size_t i, const struct input *in, const struct dump_entry *results)
{
    for (int k = 0; k < 4; k++) {
        double a = in->a[k], b = in->b[k], s = in->s[k];
        expect_ulp("asin", i, field(results, i, "arc_sine")[k], asin(s), 3);
        expect_ulp("acos", i, field(results, i, "arc_cosine")[k], acos(s), 3);
        expect_ulp("atan", i, field(results, i, "arc_tangent")[k], atan(a), 3);
        expect_ulp("atan2", i, field(results, i, "arc_tangent2")[k], atan2(a, b), 3);
    }
}

static void angles_are_within_three_units(void **state)
{
    (void)state;
    each_case("angles", check_angles);
}

/* Where the arcs have a value of their own: at 0, 1, -1 and infinity, quadrant by quadrant. */
static void angles_of_special_values(void **state)
{
    (void)state;
    for (int b = 0; b < 2; b++) {
        struct dump_entry inputs = dump_read(&dumps[b], NULL, "inputs");
        struct dump_entry results = dump_read(&dumps[b], NULL, "angles");
        int checked = 0;
        for (size_t i = 0; i < SPECIAL; i++) {
            struct input in = input(&inputs, i);
            for (int k = 0; k < 4; k++) {
                double y = in.a[k], x = in.b[k], z = in.s[k];
                expect("asin", i, field(&results, i, "arc_sine")[k], asin(z), 4 * u);
                expect("acos", i, field(&results, i, "arc_cosine")[k], acos(z), 8 * u);
                expect("atan", i, field(&results, i, "arc_tangent")[k], atan(y), 4 * u);
                if ((y == 0 || fabs(y) == 1) && (x == 0 || fabs(x) == 1)) {
                    double quadrant = atan2(y + 0.0, x + 0.0); /* -0 counts as 0 */
                    expect("atan2", i, field(&results, i, "arc_tangent2")[k], quadrant, 8 * u);
                    checked++;
                }
            }
        }
        assert_true(checked > 16);
        dump_entry_free(&inputs);
        dump_entry_free(&results);
    }
}

/* ---- Products -------------------------------------------------------------------------------- */

/* The columns of the matrix that the passes make. */
static void columns_of(const struct input *in, float m[4][4])
{
    memcpy(m[0], in->a, sizeof m[0]);
    memcpy(m[1], in->b, sizeof m[1]);
    memcpy(m[2], in->s, sizeof m[2]);
    for (int k = 0; k < 4; k++)
        m[3][k] = in->a[3 - k];
}

static void expect_product(const char *what, size_t i, float value, const float *x, const float *y,
                           int n)
{
    double magnitude, sum = dot(x, y, n, &magnitude);
    expect(what, i, value, sum, n * u * magnitude * 1.01);
}

static void check_products(size_t i, const struct input *in, const struct dump_entry *results)
{
    float m[4][4];
    columns_of(in, m);
    for (int k = 0; k < 4; k++) {
        float row[4] = {m[0][k], m[1][k], m[2][k], m[3][k]};
        expect_product("mat4 * vec4", i, field(results, i, "mat4_vec")[k], row, in->s, 4);
        if (k < 3) {
            expect_product("mat4x3 * vec4", i, field(results, i, "mat4x3_vec")[k], row, in->s, 4);
            expect_product("mat3 * vec3", i, field(results, i, "mat3_vec")[k], row, in->s, 3);
        }
        if (k < 2)
            expect_product("mat2 * vec2", i, field(results, i, "mat2_vec")[k], row, in->s, 2);
    }
}

static void check_rows(size_t i, const struct input *in, const struct dump_entry *results)
{
    const float *a = in->a, *b = in->b, *s = in->s;
    float m[4][4], n[4][4] = {{s[1], s[2], s[3], s[0]},
                              {b[2], b[3], b[0], b[1]},
                              {a[1], a[0], a[3], a[2]},
                              {s[0], s[1], s[2], s[3]}};
    columns_of(in, m);
    for (int k = 0; k < 4; k++) {
        float row[4] = {m[0][k], m[1][k], m[2][k], m[3][k]};
        expect_product("vec4 * mat4", i, field(results, i, "vec_mat4")[k], s, m[k], 4);
        expect_product("vec3 * mat4x3", i, field(results, i, "vec_mat4x3")[k], s, m[k], 3);
        if (k < 3)
            expect_product("vec3 * mat3", i, field(results, i, "vec_mat3")[k], s, m[k], 3);
        if (k < 2)
            expect_product("vec2 * mat2", i, field(results, i, "vec_mat2")[k], s, m[k], 2);
        for (int c = 0; c < 4; c++)
            expect_product("mat4 * mat4", i, field(results, i, "mat4_mat4")[4 * c + k], row, n[c],
                           4);
    }
}

static void products_are_exact_to_rounding(void **state)
{
    (void)state;
    each_case("products", check_products);
    each_case("row_products", check_rows);
}

/* ---- What exact mode leaves to the drivers --------------------------------------------------- */

/* Of log and log2: absolute near 1, else relative. */
static double log_bound(double x, double logarithm)
{
    return x >= 0.5 && x <= 2 ? 0x1p-21 : 3 * ulp(logarithm);
}

static void check_functions(size_t i, const struct input *in, const struct dump_entry *results)
{
    double a = fabs((double)in->a[0]), c = fabs((double)in->a[1]);
    double s[4] = {in->s[0], in->s[1], in->s[2], in->s[3]};
    const float *waves = field(results, i, "waves"), *powers = field(results, i, "powers");
    const float *roots = field(results, i, "roots");
    expect("sin", i, waves[0], sin(s[0] * pi), 0x1p-11);
    expect("cos", i, waves[1], cos(s[1] * pi), 0x1p-11);
    expect_ulp("exp", i, waves[2], exp(s[2] * 8), 3 + 2 * fabs(s[2] * 8));
    expect("log", i, waves[3], log(a), log_bound(a, log(a)));
    double power = pow(a, s[1]), exponent = s[1] * log2(a); /* exp2(y log2(x)) */
    double error = fabs(s[1]) * log_bound(a, log2(a)) + u * fabs(exponent);
    expect("pow", i, powers[0], power,
           (3 + 2 * fabs(exponent)) * ulp(power) + power * log(2) * error);
    expect_ulp("exp2", i, powers[1], exp2(s[3] * 8), 3 + 2 * fabs(s[3] * 8));
    expect("log2", i, powers[2], log2(c), log_bound(c, log2(c)));
    expect("tan", i, powers[3], tan(s[0]), 0x1p-11 * (1 + fabs(tan(s[0]))) / cos(s[0]));
    expect_ulp("sqrt", i, roots[0], sqrt(a), 4.5); /* 1 / inversesqrt */
    expect_ulp("inversesqrt", i, roots[1], 1 / sqrt(c), 2);
}

static void check_steps(size_t i, const struct input *in, const struct dump_entry *results)
{
    double a = in->a[0], b = in->b[0], c = in->a[1];
    const float *steps = field(results, i, "steps");
    double quotient = a / b, whole = b * floor(quotient);
    if (fabs(quotient - round(quotient)) > 3 * ulp(quotient)) /* else floor may fall either way */
        expect("mod", i, steps[0], a - whole, 2 * u * (fabs(a) + fabs(whole)));
    expect("fract", i, steps[1], c - floor(c), u);
    for (int k = 0; k < 2; k++) {
        double low = k ? -1 : -0.75, high = k ? 2 : 0.5;
        double t = fmin(fmax((in->s[k] - low) / (high - low), 0), 1);
        expect("smoothstep", i, steps[2 + k], t * t * (3 - 2 * t), 16 * u);
    }
}

static void elementary_functions_are_as_vulkan_demands(void **state)
{
    (void)state;
    each_case("elementary", check_functions);
    each_case("elementary", check_steps);
}

static int render_both(void **state)
{
    (void)state;
    static const char arguments[] =
        "--scene scenes/cornell.yaml --spec tests/specs/exact.yaml --size 9x5 --backend ";
    for (int b = 0; b < 2; b++) {
        char line[256];
        snprintf(line, sizeof line, "%s%s", arguments, b ? "vk" : "gl");
        dump_render(&dumps[b], line);
    }
    return 0;
}

static int close_both(void **state)
{
    (void)state;
    for (int b = 0; b < 2; b++)
        dump_close(&dumps[b]);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(geometry_is_exact_to_rounding),
        cmocka_unit_test(angles_are_within_three_units),
        cmocka_unit_test(angles_of_special_values),
        cmocka_unit_test(products_are_exact_to_rounding),
        cmocka_unit_test(elementary_functions_are_as_vulkan_demands),
    };
    return cmocka_run_group_tests(tests, render_both, close_both);
}
