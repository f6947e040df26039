/* Stages of templates/ssvp.yaml against their definition, in double precision in C, on dumped
 * resources of both backends: sampling patterns, VPLs, clusters, second-bounce flux, interleaving,
 * shading, tone mapping. Shares no code with the shaders; formulas and names of quantities are the
 * papers'. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dump_reader.h"

#define RSM_SIZE    128
#define MAP_SIZE    64
#define FIRST_VPLS  256
#define SECOND_VPLS 256
#define CLUSTERS    8
static const double pi = 3.14159265358979323846;

/* The smallest sizes that keep the shape of the stages, a metric scale that the test knows, one
 * frame. */
#define COMMON                                                                                     \
    " --spec templates/ssvp.yaml --size 50x38 --set rsm_size=128 --set map_size=64"                \
    " --set map_triangles=10000 --set cull_triangles=16384 --set second_vpls=256"                  \
    " --set metrics.vpl_distance.scale=0.5 "
static const char *const backends[] = {"gl", "vk"};

static void render(struct dump *dump, const char *scene, const char *backend, const char *more)
{
    char arguments[1024];
    snprintf(arguments, sizeof arguments, "--scene tests/specs/%s.yaml --backend %s" COMMON "%s",
             scene, backend, more);
    dump_render(dump, arguments);
}

/* Of each backend, in the light of a spot: rendered once for several tests. */
static struct dump usual[2];

static int render_usual(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b)
        render(&usual[b], "spot", backends[b], "");
    return 0;
}

static int close_usual(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b)
        dump_close(&usual[b]);
    return 0;
}

static const float *vec(const struct dump_entry *buffer, size_t index, const char *field)
{
    return dump_field(buffer, index, field);
}

static double dot3(const float *a, const float *b)
{
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

static double distance3(const float *a, const float *b)
{
    float d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot3(d, d));
}

static void expect_near(double value, double expected, double relative, double absolute)
{
    if (!(fabs(value - expected) <= absolute + relative * fabs(expected)))
        fail_msg("%.9g, expected %.9g", value, expected);
}

static void expect_same(const float *a, const float *b, int n)
{
    assert_memory_equal(a, b, (size_t)n * sizeof *a);
}

/* van der Corput radical inverse in base 2, digit by digit. */
static double radical_inverse(unsigned k)
{
    double inverse = 0.0, digit = 0.5;
    for (; k; k >>= 1, digit *= 0.5)
        inverse += (double)(k & 1) * digit;
    return inverse;
}

/* Shirley, Chiu 1997, by the four triangles of the square. */
static void concentric(double u, double v, double out[2])
{
    double a = 2 * u - 1, b = 2 * v - 1, r = 0, phi = 0;
    if (a > -b && a > b) {
        r = a;
        phi = pi / 4 * (b / a);
    } else if (a > -b) {
        r = b;
        phi = pi / 4 * (2 - a / b);
    } else if (a < b) {
        r = -a;
        phi = pi / 4 * (4 + b / a);
    } else if (b != 0) {
        r = -b;
        phi = pi / 4 * (6 - a / b);
    }
    out[0] = r * cos(phi);
    out[1] = r * sin(phi);
}

/* Bodies of tests/specs/mips.yaml: fill writes (x / 64, y / 64, 0.5, 1), halve takes every second
 * texel, quarter every second of those from (1, 1) on. All are exact in rgba16f. */
static void mips_hold_what_their_passes_wrote(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        struct dump dump;
        char arguments[256];
        snprintf(arguments, sizeof arguments,
                 "--scene tests/specs/spot.yaml --spec tests/specs/mips.yaml --size 9x7 "
                 "--backend %s",
                 backends[b]);
        dump_render(&dump, arguments);
        static const size_t factor[3] = {1, 2, 4}, start[3] = {0, 0, 2};
        for (size_t mip = 0; mip < 3; ++mip) {
            struct dump_entry entry = dump_read_mip(&dump, "quarter", "pyramid", mip);
            assert_int_equal(entry.width, 64 >> mip);
            assert_int_equal(entry.height, 64 >> mip);
            for (size_t y = 0; y < entry.height; ++y) {
                for (size_t x = 0; x < entry.width; ++x) {
                    float texel[4];
                    dump_texel(&entry, x, y, 0, texel);
                    const float expected[4] = {(float)(factor[mip] * x + start[mip]) / 64.0f,
                                               (float)(factor[mip] * y + start[mip]) / 64.0f, 0.5f,
                                               1.0f};
                    expect_same(texel, expected, 4);
                }
            }
            dump_entry_free(&entry);
        }
        assert_true(dump_has_mip(&dump, "halve", "pyramid", 1));
        assert_false(dump_has_mip(&dump, "halve", "pyramid", 2)); /* nothing wrote it yet */
        assert_false(dump_has_mip(&dump, "show", "picture", 1));
        dump_close(&dump);
    }
}

static void sampling_patterns_and_metric_follow_their_formulas(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        struct dump dump;
        char arguments[256];
        snprintf(arguments, sizeof arguments,
                 "--scene tests/specs/spot.yaml --spec tests/specs/features.yaml --size 9x7 --set "
                 "bins=37 --backend %s",
                 backends[b]);
        dump_render(&dump, arguments);
        struct dump_entry points = dump_read(&dump, "count", "histogram");
        assert_int_equal(points.count, 37);
        for (unsigned k = 0; k < 37; ++k) {
            const float *square = vec(&points, k, "square"), *polar = vec(&points, k, "polar");
            const float *disk = vec(&points, k, "concentric");
            double u = k / 37.0, v = radical_inverse(k), c[2];
            expect_near(square[0], u, 0, 1e-7);
            assert_true((double)square[1] == v); /* a dyadic fraction: exact */
            expect_near(polar[0], sqrt(u) * cos(2 * pi * v), 0, 1e-6);
            expect_near(polar[1], sqrt(u) * sin(2 * pi * v), 0, 1e-6);
            concentric(u, v, c);
            expect_near(disk[0], c[0], 0, 2e-6);
            expect_near(disk[1], c[1], 0, 2e-6);
            double apart = sqrt((u - 0.25) * (u - 0.25) + (v - 0.5) * (v - 0.5) + 0.75 * 0.75);
            expect_near(*vec(&points, k, "apart"), 0.6 * apart / 2.0 + 0.4 * (1 - 0.8), 0, 1e-6);
        }
        dump_entry_free(&points);
        dump_close(&dump);
    }
}

static void hammersley_texel(unsigned k, unsigned n, size_t size, size_t texel[2])
{
    texel[0] = (size_t)((double)k / n * (double)size);
    texel[1] = (size_t)(radical_inverse(k) * (double)size);
}

/* Solid angle and falloff by hand: a sample is (2 tan outer)^2 / N of the image plane at distance 1. */
static double spot_share(const float *x)
{
    const float light[3] = {0.15f, 0.5f, 0.2f}, target[3] = {0.556f, 0.3f, 0.35f};
    float axis[3], to[3];
    for (int i = 0; i < 3; ++i) {
        axis[i] = target[i] - light[i];
        to[i] = x[i] - light[i];
    }
    double cosine = dot3(axis, to) / sqrt(dot3(axis, axis) * dot3(to, to));
    double inner = cos(20 * pi / 180), outer = cos(40 * pi / 180);
    double t = fmin(fmax((cosine - outer) / (inner - outer), 0), 1);
    double side = 2 * tan(40 * pi / 180);
    return t * t * (3 - 2 * t) * side * side / FIRST_VPLS * cosine * cosine * cosine;
}

/* The normal has length 1, faces the light, and is perpendicular to the triangle. A texel beside
 * this one that shows the same triangle gives its plane. */
static void expect_normal(const float *n, const struct dump_entry *triangle,
                          const struct dump_entry *position, const size_t *t)
{
    const float light[3] = {0.15f, 0.5f, 0.2f};
    float x[4], own[4], other[4], to[3];
    dump_texel(position, t[0], t[1], 0, x);
    dump_texel(triangle, t[0], t[1], 0, own);
    for (int i = 0; i < 3; ++i)
        to[i] = light[i] - x[i];
    expect_near(dot3(n, n), 1, 1e-5, 0);
    assert_true(dot3(n, to) > 0);
    for (int beside = 0; beside < 4; ++beside) {
        size_t column = t[0] + (size_t)((beside - 1) % 2), row = t[1] + (size_t)((beside - 2) % 2);
        if (column >= RSM_SIZE || row >= RSM_SIZE)
            continue;
        dump_texel(triangle, column, row, 0, other);
        if (memcmp(own, other, sizeof *own) != 0)
            continue;
        dump_texel(position, column, row, 0, other);
        float along[3] = {other[0] - x[0], other[1] - x[1], other[2] - x[2]};
        expect_near(dot3(along, n) / sqrt(dot3(along, along)), 0, 0, 1e-3);
    }
}

/* One of the box's three materials. */
static void expect_albedo(const double *rho)
{
    static const double known[3][3] = {
        {0.725, 0.71, 0.68}, {0.63, 0.065, 0.05}, {0.14, 0.45, 0.091}};
    for (int i = 0; i < 3; ++i)
        if (fabs(rho[0] - known[i][0]) < 1e-4) {
            expect_near(rho[1], known[i][1], 1e-4, 0);
            expect_near(rho[2], known[i][2], 1e-4, 0);
            return;
        }
    fail_msg("albedo %g", rho[0]);
}

static void first_vpls_are_texels_of_the_map(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        const struct dump *dump = &usual[b];
        struct dump_entry vpls = dump_read(dump, NULL, "vpls"),
                          position = dump_read(dump, NULL, "rsm_position"),
                          triangle = dump_read(dump, NULL, "rsm_triangle");
        assert_int_equal(vpls.count, FIRST_VPLS);
        int lit = 0;
        for (unsigned k = 0; k < FIRST_VPLS; ++k) {
            size_t t[2];
            float x[4];
            hammersley_texel(k, FIRST_VPLS, RSM_SIZE, t);
            dump_texel(&position, t[0], t[1], 0, x);
            expect_same(vec(&vpls, k, "position"), x, 3);
            const float *flux = vec(&vpls, k, "flux");
            const double share = x[3] > 0 ? spot_share(x) : 0;
            double rho[3];
            for (int c = 0; c < 3; ++c) {
                rho[c] = flux[c] / ((2.0 + c) * share);
                assert_true(share > 1e-9 || flux[c] < 1e-9f);
            }
            if (share > 1e-9) {
                expect_normal(vec(&vpls, k, "normal"), &triangle, &position, t);
                expect_albedo(rho);
            }
            lit += flux[0] > 0;
        }
        assert_in_range(lit, FIRST_VPLS / 2, FIRST_VPLS);
        dump_entry_free(&vpls);
        dump_entry_free(&position);
        dump_entry_free(&triangle);
    }
}

/* All flux that parallel light brings onto the box's roof: irradiance times the roof's area. */
static void directional_flux_is_irradiance_times_area(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        struct dump dump;
        render(&dump, "directional", backends[b], "");
        struct dump_entry vpls = dump_read(&dump, NULL, "vpls");
        const double rho[3] = {0.725, 0.71, 0.68}, irradiance[3] = {5, 6, 7};
        for (int c = 0; c < 3; ++c) {
            double sum = 0;
            for (unsigned k = 0; k < FIRST_VPLS; ++k)
                sum += vec(&vpls, k, "flux")[c];
            expect_near(sum, irradiance[c] * rho[c] * 0.556 * 0.5592, 0.03, 0);
        }
        dump_entry_free(&vpls);
        dump_close(&dump);
    }
}

static double metric(const float *pa, const float *na, const float *pb, const float *nb)
{
    return 0.6 * distance3(pa, pb) / 0.5 + 0.4 * (1 - fmax(dot3(na, nb), 0));
}

/* Each label is the argmin over the centres, and its margin the difference to the next best. Each
 * mean is the mean of its members. Frame 3 starts from frame 2's means. */
static void clusters_are_those_of_kmeans(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        struct dump dump;
        render(&dump, "spot", backends[b], "--frames 3");
        struct dump_entry vpls = dump_read(&dump, NULL, "vpls"),
                          labels = dump_read(&dump, NULL, "first.labels");
        struct dump_entry margins = dump_read(&dump, NULL, "first.margins");
        struct dump_entry centres = dump_read(&dump, NULL, "first.centres");
        assert_int_equal(centres.count, CLUSTERS);
        double mean[CLUSTERS][3] = {{0}}, normal[CLUSTERS][3] = {{0}};
        int members[CLUSTERS] = {0};
        for (unsigned k = 0; k < FIRST_VPLS; ++k) {
            int label;
            float margin;
            memcpy(&label, dump_field(&labels, k, ""), sizeof label);
            memcpy(&margin, dump_field(&margins, k, ""), sizeof margin);
            const float *x = vec(&vpls, k, "position"), *n = vec(&vpls, k, "normal");
            if (dot3(vec(&vpls, k, "flux"), (const float[]){1, 1, 1}) == 0) {
                assert_int_equal(label, -1);
                assert_true(margin == -1);
                continue;
            }
            assert_in_range(label, 0, CLUSTERS - 1);
            double own = metric(x, n, vec(&centres, (size_t)label, "position"),
                                vec(&centres, (size_t)label, "normal"));
            double second = INFINITY;
            for (size_t c = 0; c < CLUSTERS; ++c) {
                double d = metric(x, n, vec(&centres, c, "position"), vec(&centres, c, "normal"));
                assert_true(own <= d + 1e-6);
                second = (int)c == label ? second : fmin(second, d);
            }
            expect_near(margin, second - own, 0, 2e-6);
            members[label]++;
            for (int i = 0; i < 3; ++i) {
                mean[label][i] += x[i];
                normal[label][i] += n[i];
            }
        }
        for (size_t c = 0; c < CLUSTERS; ++c) {
            int count;
            memcpy(&count, dump_field(&centres, c, "members"), sizeof count);
            assert_int_equal(count, members[c]);
            if (count == 0)
                continue;
            double length = sqrt(normal[c][0] * normal[c][0] + normal[c][1] * normal[c][1] +
                                 normal[c][2] * normal[c][2]);
            for (int i = 0; i < 3; ++i) {
                expect_near(vec(&centres, c, "mean")[i], mean[c][i] / count, 1e-5, 1e-6);
                if (length > 0.02 * count)
                    expect_near(vec(&centres, c, "mean_normal")[i], normal[c][i] / length, 1e-4,
                                1e-5);
            }
        }
        dump_entry_free(&vpls);
        dump_entry_free(&labels);
        dump_entry_free(&margins);
        dump_entry_free(&centres);
        dump_close(&dump);
    }
}

/* Place of a second-bounce VPL: its cluster, its point on the disk, and the number of samples of
 * its cluster. */
struct disk_sample {
    unsigned cluster;
    double point[2], number;
};

static void equal_shares(struct disk_sample samples[SECOND_VPLS])
{
    const unsigned n = SECOND_VPLS / CLUSTERS;
    for (unsigned k = 0; k < SECOND_VPLS; ++k) {
        samples[k].cluster = k / n;
        samples[k].number = n;
        concentric((double)(k % n) / n, radical_inverse(k % n), samples[k].point);
    }
}

/* Systematic sampling: VPL k stands at (k + 1/2) / N of the sum of the clusters' powers. */
static void shares_by_power(const double power[CLUSTERS], struct disk_sample samples[SECOND_VPLS])
{
    double ends[CLUSTERS], sum = 0;
    for (unsigned c = 0; c < CLUSTERS; ++c)
        ends[c] = sum += power[c];
    for (unsigned k = 0; k < SECOND_VPLS; ++k) {
        double place = (k + 0.5) / SECOND_VPLS * sum;
        unsigned c = 0;
        while (ends[c] < place)
            ++c;
        samples[k].cluster = c;
        samples[k].number = SECOND_VPLS * power[c] / sum;
        concentric((place - (ends[c] - power[c])) / power[c], radical_inverse(k), samples[k].point);
    }
}

/* The surfaces in the maps of clusters, as an image of positions; w is 1 on a surface, else 0. A
 * texel's ray is (p, sqrt(2) (1 - max |p|)) in the frame of the map (Cigolle et al. 2014). The map
 * has the distance along the ray. */
static struct dump_entry map_positions(const struct dump *dump)
{
    struct dump_entry views = dump_read(dump, NULL, "first.views");
    struct dump_entry map = dump_read(dump, NULL, "first.reach");
    struct dump_entry positions = dump_read(dump, NULL, "gbuffer_position"); /* its format */
    const size_t size = map.width;
    map.layers =
        views.count; /* in the first frame, these are the first of the maps that are kept */
    dump_entry_free(&positions);
    positions.width = positions.height = size;
    positions.layers = map.layers;
    positions.size = size * size * map.layers * positions.stride;
    positions.data = calloc(1, positions.size);
    assert_non_null(positions.data);
    for (size_t i = 0; i < size * size * map.layers; ++i) {
        size_t x = i % size, y = i / size % size, layer = i / size / size;
        double p[2] = {(2 * (double)x + 1) / (double)size - 1,
                       (2 * (double)y + 1) / (double)size - 1};
        double up = sqrt(2) * (1 - fmax(fabs(p[0]), fabs(p[1])));
        float reach[4], position[4];
        dump_texel(&map, x, y, layer, reach);
        position[3] = reach[0] < 1e29f;
        reach[0] *= position[3]; /* no surface: the position of the eye */
        for (int c = 0; c < 3; ++c) {
            double ray = p[0] * vec(&views, layer, "tangent")[c] +
                         p[1] * vec(&views, layer, "bitangent")[c] +
                         up * vec(&views, layer, "normal")[c];
            position[c] = (float)(vec(&views, layer, "position")[c] + ray * reach[0]);
        }
        memcpy(positions.data + i * positions.stride, position, sizeof position);
    }
    dump_entry_free(&views);
    dump_entry_free(&map);
    return positions;
}

/* The map's texel in the direction that a point of the unit disk has in paraboloid projection. */
static void map_texel(const double disk[2], size_t texel[2])
{
    double edge = 2 * fmax(fabs(disk[0]), fabs(disk[1]));
    double reach = edge + (1 - disk[0] * disk[0] - disk[1] * disk[1]) / sqrt(2);
    for (int i = 0; i < 2; ++i)
        texel[i] = (size_t)fmin(fmax((disk[i] / reach + 0.5) * MAP_SIZE, 0), MAP_SIZE - 1);
}

/* Reflectance of the Cornell Box, from cornell.mtl: the side walls are red and green, all else is
 * white. */
static const double *cornell_albedo(const float position[3], const float normal[3])
{
    static const double white[3] = {0.725, 0.71, 0.68}, red[3] = {0.63, 0.065, 0.05},
                        green[3] = {0.14, 0.45, 0.091};
    bool side = fabsf(normal[0]) > 0.9f;
    return side && position[0] > 0.54f ? red : side && position[0] < 0.001f ? green : white;
}

/* Phi_2 = rho Phi_C 4 (1 - r^2) / ((1 + r^2)^3 N), with rho from the texel under the disk point,
 * and Phi_C the flux of the VPLs that use the map. */
static void check_second_flux(const struct dump *dump, bool by_power)
{
    struct dump_entry vpls = dump_read(dump, NULL, "vpls"),
                      nearest = dump_read(dump, NULL, "first.nearest");
    struct dump_entry second = dump_read(dump, NULL, "second_vpl");
    struct dump_entry position = map_positions(dump);
    assert_int_equal(second.count, SECOND_VPLS);
    assert_int_equal(position.width, MAP_SIZE);
    double cluster_flux[CLUSTERS][3] = {{0}}, power[CLUSTERS] = {0}, first_sum = 0, second_sum = 0;
    for (unsigned k = 0; k < FIRST_VPLS; ++k) {
        int eye;
        memcpy(&eye, dump_field(&nearest, k, ""), sizeof eye);
        assert_in_range(eye + 1, 0, CLUSTERS);
        for (int c = 0; c < 3 && eye >= 0; ++c) {
            cluster_flux[eye][c] += vec(&vpls, k, "flux")[c];
            power[eye] += vec(&vpls, k, "flux")[c];
            first_sum += vec(&vpls, k, "flux")[c];
        }
    }
    struct disk_sample samples[SECOND_VPLS];
    if (by_power)
        shares_by_power(power, samples);
    else
        equal_shares(samples);
    double weights = 0;
    unsigned checked = 0;
    for (unsigned k = 0; k < SECOND_VPLS; ++k) {
        const double *p = samples[k].point;
        double s = fmin(p[0] * p[0] + p[1] * p[1], 1),
               weight = 4 * (1 - s) / (pow(1 + s, 3) * samples[k].number);
        weights += weight / CLUSTERS;
        float x[4];
        size_t texel[2];
        map_texel(p, texel);
        dump_texel(&position, texel[0], texel[1], samples[k].cluster, x);
        if (distance3(vec(&second, k, "position"), x) > 1e-6)
            continue; /* on the border of two texels float and double may differ */
        checked++;
        const double *rho = cornell_albedo(x, vec(&second, k, "normal"));
        for (int c = 0; c < 3; ++c) {
            double flux = x[3] > 0 ? rho[c] * cluster_flux[samples[k].cluster][c] * weight : 0;
            expect_near(vec(&second, k, "flux")[c], flux, 1e-3, 1e-9);
            second_sum += vec(&second, k, "flux")[c];
        }
    }
    assert_in_range(checked, SECOND_VPLS * 97 / 100, SECOND_VPLS);
    /* the integral over the disk is 1; 32 points come near */
    expect_near(weights, 1.0, by_power ? 0.1 : 0.03, 0);
    assert_true(second_sum > 0.1 * first_sum && second_sum < first_sum);
    dump_entry_free(&vpls);
    dump_entry_free(&nearest);
    dump_entry_free(&second);
    dump_entry_free(&position);
}

static void second_bounce_flux_is_as_derived(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        struct dump equal;
        render(&equal, "spot", backends[b], "--set second_by_flux=0");
        check_second_flux(&usual[b], true);
        check_second_flux(&equal, false);
        dump_close(&equal);
    }
}

/* The surface of one texel, from the positions of its neighbours. 0 where the neighbours do not lie
 * in the plane of the texel that has the VPL's normal. */
static double texel_surface(const struct dump_entry *positions, size_t x, size_t y, size_t layer,
                            const float *normal)
{
    float at[4], right[4], up[4];
    if (x + 1 >= positions->width || y + 1 >= positions->height)
        return 0;
    dump_texel(positions, x, y, layer, at);
    dump_texel(positions, x + 1, y, layer, right);
    dump_texel(positions, x, y + 1, layer, up);
    float u[3], v[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = right[i] - at[i];
        v[i] = up[i] - at[i];
    }
    double width = sqrt(dot3(u, u)), height = sqrt(dot3(v, v));
    if (at[3] == 0 || right[3] == 0 || up[3] == 0 || fabs(dot3(u, normal)) > 1e-3 * width ||
        fabs(dot3(v, normal)) > 1e-3 * height)
        return 0;
    float cross[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                      u[0] * v[1] - u[1] * v[0]};
    return sqrt(dot3(cross, cross));
}

/* A first-bounce VPL stands for the surface of RSM_SIZE^2 / FIRST_VPLS texels like its own, at most
 * for ten times the area that the light sees. */
static void first_vpls_stand_for_the_surface_of_their_texels(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        const struct dump *dump = &usual[b];
        struct dump_entry vpls = dump_read(dump, NULL, "vpls");
        struct dump_entry positions = dump_read(dump, NULL, "rsm_position");
        int checked = 0;
        for (unsigned k = 0; k < FIRST_VPLS; ++k) {
            size_t x = (size_t)((double)k / FIRST_VPLS * RSM_SIZE);
            size_t y = (size_t)(radical_inverse(k) * RSM_SIZE);
            double texel = texel_surface(&positions, x, y, 0, vec(&vpls, k, "normal"));
            double expected = texel * RSM_SIZE * RSM_SIZE / FIRST_VPLS;
            if (texel == 0 || vec(&vpls, k, "flux")[0] == 0)
                continue;
            expect_near(*vec(&vpls, k, "area"), expected, 0.1, 0);
            checked++;
        }
        assert_true(checked > FIRST_VPLS / 4);
        dump_entry_free(&vpls);
        dump_entry_free(&positions);
    }
}

/* Roberts 2018: multiples of 1 / g and 1 / g2, with g the root of g3 = g + 1. */
static void shift_of_frame(unsigned frame, double shift[2])
{
    const double g = 1.32471795724474602596;
    shift[0] = frame / g - floor(frame / g);
    shift[1] = frame / (g * g) - floor(frame / (g * g));
}

static double fraction(double x)
{
    return x - floor(x);
}

/* Counts VPLs at the position that the map has at their sample, computed in double precision. On
 * the border of two texels float and double may differ. */
static unsigned count_at(const struct dump_entry *vpls, const struct dump_entry *position,
                         bool disk, const double shift[2])
{
    unsigned count = 0, n = disk ? SECOND_VPLS / CLUSTERS : FIRST_VPLS;
    for (unsigned k = 0; k < vpls->count; ++k) {
        double u[2] = {(double)(k % n) / n, radical_inverse(k % n)}, p[2];
        size_t texel[2];
        float x[4];
        if (disk) {
            concentric(u[0], u[1], p);
            double radius = sqrt(fraction(p[0] * p[0] + p[1] * p[1] + shift[0]));
            double angle = atan2(p[1], p[0]) + 2 * pi * shift[1];
            u[0] = radius * cos(angle);
            u[1] = radius * sin(angle);
            map_texel(u, texel);
        } else {
            for (int i = 0; i < 2; ++i)
                texel[i] = (size_t)(fraction(u[i] + shift[i]) * RSM_SIZE);
        }
        dump_texel(position, texel[0], texel[1], disk ? k / n : 0, x);
        count += distance3(vec(vpls, k, "position"), x) < 1e-6;
    }
    return count;
}

/* Without reuse, the patterns of the third frame are shifted: on the square, and on the disk in the
 * square of the radius and in the angle. */
static void patterns_are_shifted_unless_reused(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        struct dump dump;
        double shift[2], none[2] = {0, 0};
        render(&dump, "spot", backends[b],
               "--frames 3 --set reuse_pattern=0 --set second_by_flux=0");
        shift_of_frame(2, shift);
        struct dump_entry first = dump_read(&dump, NULL, "vpls");
        struct dump_entry second = dump_read(&dump, NULL, "second_vpl");
        struct dump_entry rsm = dump_read(&dump, NULL, "rsm_position");
        struct dump_entry maps = map_positions(&dump);
        assert_in_range(count_at(&first, &rsm, false, shift), FIRST_VPLS * 98 / 100, FIRST_VPLS);
        assert_in_range(count_at(&second, &maps, true, shift), SECOND_VPLS * 98 / 100, SECOND_VPLS);
        assert_in_range(count_at(&first, &rsm, false, none), 0, FIRST_VPLS / 4);
        dump_entry_free(&first);
        dump_entry_free(&second);
        dump_entry_free(&rsm);
        dump_entry_free(&maps);
        dump_close(&dump);
    }
}

static uint64_t count_indices(struct dump *dump, const char *name)
{
    struct dump_entry draws = dump_read(dump, NULL, name);
    uint64_t count = 0;
    for (size_t k = 0; k < draws.count; ++k) {
        uint32_t indices;
        memcpy(&indices, dump_field(&draws, k, "index_count"), sizeof indices);
        count += indices;
    }
    dump_entry_free(&draws);
    return count;
}

/* A ball with bumps, seen from within: 9,400 triangles, none of which lie in one plane and overlap.
 * Equal depths would go to the triangle that is drawn first. */
static void write_ball(const char *folder)
{
    enum { ROUND = 80, DOWN = 60 };
    char path[64];
    snprintf(path, sizeof path, "%s/ball.obj", folder);
    FILE *mesh = fopen(path, "w");
    assert_non_null(mesh);
    for (int v = 0; v <= DOWN; ++v)
        for (int u = 0; u < ROUND; ++u) {
            double theta = pi * v / DOWN, phi = 2 * pi * u / ROUND;
            double r = 1 + 0.15 * sin(7 * theta) * sin(5 * phi);
            fprintf(mesh, "v %.6f %.6f %.6f\n", r * sin(theta) * cos(phi), r * cos(theta),
                    r * sin(theta) * sin(phi));
        }
    for (int v = 0; v < DOWN; ++v)
        for (int u = 0; u < ROUND; ++u) {
            int a = v * ROUND + u + 1, b = v * ROUND + (u + 1) % ROUND + 1;
            fprintf(mesh, "f %d %d %d\nf %d %d %d\n", a, b, b + ROUND, a, b + ROUND, a + ROUND);
        }
    assert_int_equal(fclose(mesh), 0);
    snprintf(path, sizeof path, "%s/ball.yaml", folder);
    FILE *scene = fopen(path, "w");
    assert_non_null(scene);
    fprintf(scene, "mesh: ball.obj\n"
                   "camera: {eye: [0, 0, 0.3], target: [0, 0, -1], fov_y: 60}\n"
                   "light: {kind: spot, position: [0, 0.1, 0], target: [1, 0.3, 0.2], cone: [30, "
                   "40], intensity: [9, 9, 9]}\n");
    assert_int_equal(fclose(scene), 0);
}

/* A map draws the whole scene, or a list of the triangles that can show in it. The map shows the
 * same either way, and second-bounce VPLs find the same surface. The map draws the whole scene
 * where culling removes too few triangles or the list finds no room. The list is shorter. */
static void culling_changes_no_texel(void **state)
{
    (void)state;
    static const char *const shown[] = {"first.reach", "second_vpl", "second.reach"};
    static const char *const sets[] = {"--set cull_triangles=1", "--set map_triangles=3000", ""};
    static const char *const buffers[] = {"first.map.draws", "first.map.whole_draws"};
    char folder[] = "/tmp/oracle_test.XXXXXX", arguments[512];
    assert_non_null(mkdtemp(folder));
    write_ball(folder);
    for (int b = 0; b < 2; ++b) {
        uint64_t drawn[3][2] = {{0}};
        struct dump_entry whole[3] = {0};
        for (int i = 0; i < 3; ++i) {
            struct dump dump;
            snprintf(arguments, sizeof arguments, "--scene %s/ball.yaml --backend %s" COMMON "%s",
                     folder, backends[b], sets[i]);
            dump_render(&dump, arguments);
            for (int m = 0; m < 3; ++m) {
                struct dump_entry map = dump_read(&dump, NULL, shown[m]);
                if (i == 0)
                    whole[m] = map;
                else
                    assert_memory_equal(map.data, whole[m].data, map.size);
                if (i > 0)
                    dump_entry_free(&map);
            }
            for (int d = 0; d < 2; ++d)
                drawn[i][d] = count_indices(&dump, buffers[d]);
            dump_close(&dump);
        }
        for (int m = 0; m < 3; ++m)
            dump_entry_free(&whole[m]);
        assert_true(drawn[0][0] == 0 && drawn[0][1] > 0);
        assert_true(drawn[1][0] > 0 && drawn[1][1] > 0);
        assert_true(drawn[2][1] == 0 && drawn[2][0] < drawn[0][1]);
    }
    snprintf(arguments, sizeof arguments, "rm -r %s", folder);
    assert_int_equal(system(arguments), 0);
}

/* In a still scene, k-means that begins anew ends in every frame as in the first. K-means that
 * begins with the last centres goes on. */
static void clusters_begin_anew_unless_reused(void **state)
{
    (void)state;
    static const char *const runs[] = {
        "--set kmeans_iterations=1",
        "--set kmeans_iterations=1 --frames 3 --set reuse_centres=0 "
        "--set reuse_pattern=1",
        "--set kmeans_iterations=1 --frames 3 --set reuse_pattern=1"};
    float means[3][CLUSTERS][3];
    for (int i = 0; i < 3; ++i) {
        struct dump dump;
        render(&dump, "spot", "vk", runs[i]);
        struct dump_entry centres = dump_read(&dump, NULL, "first.centres");
        for (size_t c = 0; c < CLUSTERS; ++c)
            memcpy(means[i][c], vec(&centres, c, "mean"), sizeof means[i][c]);
        dump_entry_free(&centres);
        dump_close(&dump);
    }
    assert_memory_equal(means[1], means[0], sizeof means[0]);
    assert_memory_not_equal(means[2], means[0], sizeof means[0]);
}

/* Without visibility, the second bounce adds to a pixel the sum over its class of (Phi/pi) cos cos
 * / (d^2 + disk cos), times the number of classes. */
static void second_bounce_irradiance_is_the_sum_of_its_class(void **state)
{
    (void)state;
    for (int i = 0; i < 4; ++i) {
        const int b = i % 2, softness = i / 2;
        struct dump one, two;
        char sets[128];
        snprintf(sets, sizeof sets, "--set bounces=1 --set second_clusters=0 --set softness=%d",
                 softness);
        render(&one, "spot", backends[b], sets);
        snprintf(sets, sizeof sets, "--set bounces=2 --set second_clusters=0 --set softness=%d",
                 softness);
        render(&two, "spot", backends[b], sets);
        struct dump_entry first = dump_read(&one, NULL, "irradiance"),
                          both = dump_read(&two, NULL, "irradiance");
        struct dump_entry position = dump_read(&two, NULL, "gbuffer_position");
        struct dump_entry normal = dump_read(&two, NULL, "gbuffer_normal");
        struct dump_entry vpls = dump_read(&two, NULL, "second.shading");
        size_t per_class = vpls.count / 16;
        int checked = 0;
        for (size_t y = 0; y < position.height; ++y)
            for (size_t x = 0; x < position.width; ++x) {
                float p[4], n[4], e1[4], e2[4];
                dump_texel(&position, x, y, 0, p);
                dump_texel(&normal, x, y, 0, n);
                dump_texel(&first, x, y, 0, e1);
                dump_texel(&both, x, y, 0, e2);
                if (p[3] == 0)
                    continue;
                double sum = 0, nearest = 1;
                for (size_t k = 0; k < per_class; ++k) {
                    size_t v = (x % 4 + 4 * (y % 4)) * per_class + k;
                    const float *q = vec(&vpls, v, "position");
                    float w[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
                    double square = dot3(w, w);
                    double cosines =
                        fmax(dot3(vec(&vpls, v, "normal"), w), 0) * fmax(-dot3(n, w), 0);
                    nearest = fmin(nearest, square);
                    double foreshortened = *vec(&vpls, v, "disk") *
                                           fmax(dot3(vec(&vpls, v, "normal"), w), 0) / sqrt(square);
                    if (square > 0)
                        sum += vec(&vpls, v, "flux")[1] / pi * cosines /
                               (square * (square + foreshortened));
                }
                if (nearest < 1e-4)
                    continue; /* near a VPL the term diverges, and half floats overflow */
                expect_near(e2[1] - e1[1], 16 * sum, 2e-3, 2e-3 * (e1[1] + e2[1]) + 1e-5);
                checked++;
            }
        assert_true(checked > 1000);
        dump_entry_free(&first);
        dump_entry_free(&both);
        dump_entry_free(&position);
        dump_entry_free(&normal);
        dump_entry_free(&vpls);
        dump_close(&one);
        dump_close(&two);
    }
}

/* Reinhard et al. 2002, Equations 1, 2 and 4 on luminance, IEC 61966-2-1, with the defaults a =
 * 0.18, white = 4. */
static void display_is_reinhards_curve_of_radiance(void **state)
{
    (void)state;
    for (int b = 0; b < 2; ++b) {
        const struct dump *dump = &usual[b];
        struct dump_entry radiance = dump_read(dump, NULL, "radiance"),
                          display = dump_read(dump, NULL, "display");
        double logs = 0;
        int surfaces = 0;
        for (int pass = 0; pass < 2; ++pass)
            for (size_t y = 0; y < radiance.height; ++y)
                for (size_t x = 0; x < radiance.width; ++x) {
                    float l[4], d[4];
                    dump_texel(&radiance, x, y, 0, l);
                    dump_texel(&display, x, y, 0, d);
                    double luminance = 0.2126 * l[0] + 0.7152 * l[1] + 0.0722 * l[2];
                    if (pass == 0) {
                        surfaces += l[3] > 0;
                        logs += l[3] > 0 ? log(0.001 + luminance) : 0;
                        continue;
                    }
                    double scale = 0.18 / exp(logs / surfaces), s = luminance * scale;
                    double curve = scale * (1 + s / 16) / (1 + s);
                    for (int c = 0; c < 3; ++c) {
                        double v = fmin(l[c] * curve, 1);
                        v = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
                        expect_near(d[c] * 255, v * 255, 0, 0.52);
                    }
                }
        assert_true(surfaces > 1000);
        dump_entry_free(&radiance);
        dump_entry_free(&display);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mips_hold_what_their_passes_wrote),
        cmocka_unit_test(sampling_patterns_and_metric_follow_their_formulas),
        cmocka_unit_test(first_vpls_are_texels_of_the_map),
        cmocka_unit_test(directional_flux_is_irradiance_times_area),
        cmocka_unit_test(clusters_are_those_of_kmeans),
        cmocka_unit_test(second_bounce_flux_is_as_derived),
        cmocka_unit_test(first_vpls_stand_for_the_surface_of_their_texels),
        cmocka_unit_test(patterns_are_shifted_unless_reused),
        cmocka_unit_test(culling_changes_no_texel),
        cmocka_unit_test(clusters_begin_anew_unless_reused),
        cmocka_unit_test(second_bounce_irradiance_is_the_sum_of_its_class),
        cmocka_unit_test(display_is_reinhards_curve_of_radiance),
    };
    return cmocka_run_group_tests(tests, render_usual, close_usual);
}
