/* Results of tests/specs/exact.yaml against double precision. The same bits on both backends are
 * not enough, since a replacement could be wrong in both. templates/glsl/exact.glsl states the
 * bounds of the replaced functions, or its order of operations implies them, in units u = 2^-24 of
 * rounding. tests/specs/arithmetic.yaml has the functions of one number over all exponents. */
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
        expect_ulp("asin", i, field(results, i, "arc_sine")[k], asin(s), 4);
        expect_ulp("acos", i, field(results, i, "arc_cosine")[k], acos(s), 4);
        expect_ulp("atan", i, field(results, i, "arc_tangent")[k], atan(a), 4);
        expect_ulp("atan2", i, field(results, i, "arc_tangent2")[k], atan2(a, b), 4);
    }
}

static void angles_are_within_four_units(void **state)
{
    (void)state;
    each_case("angles", check_angles);
}

/* Arc functions at 0, 1, -1 and infinity, where they have a value of their own, quadrant by
 * quadrant. */
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

/* ---- Functions ------------------------------------------------------------------------------- */

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

static void steps_are_exact_to_rounding(void **state)
{
    (void)state;
    each_case("elementary", check_steps);
}

static long double divide(long double x, long double y)
{
    return x / y;
}

static long double reciprocal(long double x)
{
    return 1 / x;
}

static long double inverse_root(long double x)
{
    return 1 / sqrtl(x);
}

static long double positive_power(long double x, long double y)
{
    return powl(fabsl(x), y);
}

static const struct function {
    const char *name, *first, *second; /* fields: of the result, of the arguments */
    long double (*one)(long double x);
    long double (*two)(long double x, long double y);
    double most; /* the largest |x|; 0: any */
    double ulps;
} functions[] = {
    {"quotient", "x", "y", NULL, divide, 0, 2},
    {"sqrt", "x", NULL, sqrtl, NULL, 0, 2},
    {"inversesqrt", "x", NULL, inverse_root, NULL, 0, 2},
    {"sin", "angle", NULL, sinl, NULL, 0, 4},
    {"cos", "angle", NULL, cosl, NULL, 0, 4},
    {"tan", "angle", NULL, tanl, NULL, 8192, 4},
    {"asin", "unit", NULL, asinl, NULL, 0, 4},
    {"acos", "unit", NULL, acosl, NULL, 0, 4},
    {"atan", "x", NULL, atanl, NULL, 0, 4},
    {"atan2", "angle", "unit", NULL, atan2l, 0, 4},
    {"exp", "exponent", NULL, expl, NULL, 0, 4},
    {"exp2", "exponent", NULL, exp2l, NULL, 0, 4},
    {"log", "x", NULL, logl, NULL, 0, 4},
    {"log2", "x", NULL, log2l, NULL, 0, 4},
    {"pow", "x", "unit", NULL, positive_power, 0, 4},
    {"sinh", "exponent", NULL, sinhl, NULL, 0, 4},
    {"cosh", "exponent", NULL, coshl, NULL, 0, 4},
    {"tanh", "exponent", NULL, tanhl, NULL, 0, 4},
    {"asinh", "x", NULL, asinhl, NULL, 0, 4},
    {"acosh", "above_one", NULL, acoshl, NULL, 0, 4},
    {"atanh", "unit", NULL, atanhl, NULL, 0, 4},
    /* templates/shared/estimate.glsl: 3e-6, 2e-7 and 2e-5, relative */
    {"reciprocal", "above_one", NULL, reciprocal, NULL, 0, 3e-6 * 0x1p24},
    {"close", "above_one", NULL, reciprocal, NULL, 0, 2e-7 * 0x1p24},
    {"root", "above_one", NULL, sqrtl, NULL, 0, 2e-5 * 0x1p24},
};

/* Error in units in the last place. The error is 0 where both are NaN or both denormal, and for an
 * infinity within four units of the largest float. */
static double error_of(float value, long double expected)
{
    if (isnan(expected) || isnan(value))
        return isnan(expected) && isnan(value) ? 0 : INFINITY;
    if (fabsl(expected) < 0x1p-126L)
        return fabsf(value) <= 0x1p-126f ? 0 : INFINITY;
    if (isinf(value))
        return (value > 0) == (expected > 0) && fabsl(expected) > 0x1.fffff8p127L ? 0 : INFINITY;
    return (double)(fabsl(value - expected) /
                    (long double)ulp((double)fminl(fabsl(expected), 0x1p127L)));
}

static double worst_error(const struct function *function, const struct dump_entry *arguments,
                          const struct dump_entry *results)
{
    double worst = 0;
    for (size_t i = 0; i < results->count; i++) {
        float x = *field(arguments, i, function->first);
        float y = function->second ? *field(arguments, i, function->second) : 0;
        if (function->most != 0 && fabs((double)x) > function->most)
            continue;
        long double expected = function->one ? function->one(x) : function->two(x, y);
        double error = error_of(*field(results, i, function->name), expected);
        if (!(error <= function->ulps))
            fail_msg("%s(%.9g, %.9g) is %.9g, expected %.9Lg: %.3g ulp", function->name, (double)x,
                     (double)y, (double)*field(results, i, function->name), expected, error);
        worst = fmax(worst, error);
    }
    return worst;
}

/* Prints the table of errors. */
static void functions_are_within_their_bounds(void **state)
{
    (void)state;
    struct dump dump;
    dump_render(&dump, "--scene scenes/cornell.yaml --spec tests/specs/arithmetic.yaml --size 9x5 "
                       "--backend vk");
    struct dump_entry arguments = dump_read(&dump, NULL, "arguments");
    struct dump_entry results = dump_read(&dump, NULL, "functions");
    assert_int_equal(results.count, 65536);
    for (size_t k = 0; k < sizeof functions / sizeof *functions; k++)
        printf("# %-11s %.2f ulp, at most %g\n", functions[k].name,
               worst_error(&functions[k], &arguments, &results), functions[k].ulps);
    dump_entry_free(&arguments);
    dump_entry_free(&results);
    dump_close(&dump);
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
        cmocka_unit_test(angles_are_within_four_units),
        cmocka_unit_test(angles_of_special_values),
        cmocka_unit_test(products_are_exact_to_rounding),
        cmocka_unit_test(steps_are_exact_to_rounding),
        cmocka_unit_test(functions_are_within_their_bounds),
    };
    return cmocka_run_group_tests(tests, render_both, close_both);
}
