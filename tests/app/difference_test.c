/* Differences under a contract, and their descriptions. Expected values come from IEEE 754 and the
 * contracts' definitions. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/lib/unit.h"
#include <cjson/cJSON.h>

#include "app/result/difference.h"
#include "app/picture/edges.h"

static const char *const labels[2] = {"gl", "vk"};

#define EXACT ((struct dt_contract){.kind = DT_CONTRACT_EXACT})
#define TOLERANCE(which, number)                                                                   \
    ((struct dt_contract){.kind = DT_CONTRACT_##which, .tolerance = (number)})

static void assert_told(char *found, const char *expected)
{
    assert_string_equal(found, expected);
    free(found);
}

/* ---- A buffer of three vec3, each with 4 bytes of padding ------------------------------------ */

enum { ELEMENTS = 3 };

static const struct dt_field one_vector[] = {{"v", DT_TYPE_VEC3, 0, 0, 0}};

static struct dt_resource vectors(struct dt_contract contract)
{
    return (struct dt_resource){.name = "r",
                                .kind = DT_BUFFER,
                                .contract = contract,
                                .fields = one_vector,
                                .field_count = 1,
                                .stride = 16};
}

static struct difference compare(struct dt_contract contract, float left[ELEMENTS][4],
                                 float right[ELEMENTS][4])
{
    const struct dt_resource resource = vectors(contract);
    const struct dt_bytes copies[2] = {
        {.data = (uint8_t *)left, .size = ELEMENTS * 16, .extent = {ELEMENTS}},
        {.data = (uint8_t *)right, .size = ELEMENTS * 16, .extent = {ELEMENTS}}};
    struct difference difference;
    assert_true(difference_measure(&difference, &resource, 4, copies));
    return difference;
}

TEST(padding_is_nobodys)
{
    float left[ELEMENTS][4] = {{1, 2, 3, 4}};
    float right[ELEMENTS][4] = {{1, 2, 3, NAN}};
    struct difference difference = compare(EXACT, left, right);
    assert_int_equal(difference_verdict(&difference), VERDICT_EQUAL);
    assert_int_equal(difference.elements, ELEMENTS);
    const struct dt_resource resource = vectors(EXACT);
    assert_told(difference_describe_worst(&difference, &resource, labels), "-");
}

TEST(exact_sees_the_last_bit)
{
    float left[ELEMENTS][4] = {{1, 2, 3}, {1, 1, 1}, {0, 0, 0}};
    float right[ELEMENTS][4] = {{1, 2, 3}, {1, nextafterf(1, 2), 1}, {0, 0, -0.0f}};
    struct difference difference = compare(EXACT, left, right);
    assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
    assert_int_equal(difference.differing, 2);
    assert_int_equal(difference.beyond, 2);
    assert_int_equal(difference.worst.element, 1);
    assert_int_equal(difference.worst.frame, 4);
    assert_string_equal(difference.worst.component.name, "v.y");
    assert_true(difference.worst.error == 0x1p-23);
    assert_int_equal(difference.worst.bits[1], 0x3f800001);
    const struct dt_resource resource = vectors(EXACT);
    assert_told(difference_describe_worst(&difference, &resource, labels),
                "1.19e-07 at [1].v.y, frame 4: gl 1 (0x3f800000), vk 1.0000001 (0x3f800001)");
}

TEST(zeros_of_either_sign_differ_exactly)
{
    float left[ELEMENTS][4] = {{0, 0, 0}};
    float right[ELEMENTS][4] = {{0, 0, -0.0f}};
    struct difference difference = compare(EXACT, left, right);
    assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
    const struct dt_resource resource = vectors(EXACT);
    assert_told(difference_describe_worst(&difference, &resource, labels),
                "0 at [0].v.z, frame 4: gl 0 (0x00000000), vk -0 (0x80000000)");
    difference = compare(TOLERANCE(ABS, 0), left, right);
    assert_int_equal(difference_verdict(&difference), VERDICT_WITHIN);
}

TEST(denormals_count_as_zero)
{
    float left[ELEMENTS][4] = {{0x1p-127f, -0x1p-149f, 0}};
    float right[ELEMENTS][4] = {{0, -0.0f, 0x1p-130f}};
    float other[ELEMENTS][4] = {{0, 0x1p-149f, 0}};
    float least[ELEMENTS][4] = {{0x1p-126f, -0.0f, 0}};
    struct difference difference = compare(EXACT, left, right);
    assert_int_equal(difference_verdict(&difference), VERDICT_EQUAL);
    difference = compare(EXACT, left, other); /* another sign */
    assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
    difference = compare(EXACT, least, right); /* not denormal */
    assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
}

TEST(tolerances_are_kept)
{
    float left[ELEMENTS][4] = {{100, 0, 0}};
    float right[ELEMENTS][4] = {{101, 0, 0}};
    float near[ELEMENTS][4] = {{nextafterf(nextafterf(100, 200), 200), 0, 0}};
    const struct {
        struct dt_contract contract;
        enum verdict verdict;
    } cases[] = {{TOLERANCE(ABS, 1), VERDICT_WITHIN},
                 {TOLERANCE(ABS, 0.99), VERDICT_DIFFERS},
                 {TOLERANCE(REL, 0.01), VERDICT_WITHIN},
                 {TOLERANCE(REL, 0.0099), VERDICT_DIFFERS},
                 {TOLERANCE(ULP, 4), VERDICT_DIFFERS}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        struct difference difference = compare(cases[i].contract, left, right);
        assert_int_equal(difference_verdict(&difference), cases[i].verdict);
    }
    struct difference difference = compare(TOLERANCE(ULP, 2), left, near);
    assert_int_equal(difference_verdict(&difference), VERDICT_WITHIN);
    assert_true(difference.worst.error == 2);
    assert_int_equal(difference.differing, 1);
    assert_int_equal(difference.beyond, 0);
    const struct dt_resource resource = vectors(TOLERANCE(ULP, 2));
    assert_told(difference_describe_worst(&difference, &resource, labels),
                "2 ulp at [0].v.x, frame 4: gl 100 (0x42c80000), vk 100.000015 (0x42c80002)");
    difference = compare(TOLERANCE(ULP, 1), left, near);
    assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
}

TEST(ulps_go_through_zero)
{
    float left[ELEMENTS][4] = {{0x1p-149f, 0, 0}};
    float right[ELEMENTS][4] = {{-0x1p-149f, -0.0f, 0}};
    struct difference difference = compare(TOLERANCE(ULP, 2), left, right);
    assert_true(difference.worst.error == 2);
    assert_int_equal(difference_verdict(&difference), VERDICT_WITHIN);
}

/* Distances in ulp count steps of nextafterf. */
TEST(histograms_count_ulps)
{
    const float next = nextafterf(1, 2);
    float left[ELEMENTS][4] = {{1, 1, 0}, {1, 0x1p-149f, INFINITY}, {-1, 5, -3.4e38f}};
    float right[ELEMENTS][4] = {{next, nextafterf(next, 2), -0.0f}, {2, 0, 1}, {-next, 5, 3.4e38f}};
    const struct dt_resource resource = vectors(EXACT);
    const struct dt_bytes copies[2] = {
        {.data = (uint8_t *)left, .size = sizeof left, .extent = {ELEMENTS}},
        {.data = (uint8_t *)right, .size = sizeof right, .extent = {ELEMENTS}}};
    uint64_t bins[DIFFERENCE_BINS], expected[DIFFERENCE_BINS] = {0};
    expected[0] = 1;                   /* 0 and -0 */
    expected[1] = 2;                   /* 1 ulp */
    expected[2] = 1;                   /* 2 */
    expected[24] = 1;                  /* 2^23: 1 to 2 */
    expected[DIFFERENCE_BINS - 2] = 1; /* beyond 2^32 - 2^25 */
    expected[DIFFERENCE_BINS - 1] = 1; /* infinity */
    assert_true(difference_histogram(bins, &resource, copies));
    for (int i = 0; i < DIFFERENCE_BINS; i++)
        assert_int_equal(bins[i], expected[i]);
}

TEST(nan_never_passes)
{
    float both[ELEMENTS][4] = {{1, NAN, INFINITY}};
    float one[ELEMENTS][4] = {{1, 0, INFINITY}};
    const struct dt_contract contracts[] = {
        EXACT,
        TOLERANCE(ABS, INFINITY),
        TOLERANCE(ULP, 1e30),
        TOLERANCE(REL, INFINITY),
        {.kind = DT_CONTRACT_IMAGE, .tolerance = INFINITY, .outliers = 1}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(contracts); i++) {
        const struct dt_resource resource = vectors(contracts[i]);
        struct difference difference = compare(contracts[i], both, both);
        assert_int_equal(difference_verdict(&difference), VERDICT_NOT_FINITE);
        assert_int_equal(difference.not_finite, 2);
        assert_int_equal(difference.differing, 0);
        assert_int_equal(difference.beyond, 0);
        assert_told(
            difference_describe_worst(&difference, &resource, labels),
            "2 numbers are NaN or Inf in both, the first at [0].v.y, frame 4: gl NaN (0x7fc00000), "
            "vk NaN (0x7fc00000)");
        difference = compare(contracts[i], both, one);
        assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
        assert_int_equal(difference.not_finite, 2);
        assert_int_equal(difference.differing, 1);
    }
}

/* ---- Images ---------------------------------------------------------------------------------- */

static struct difference compare_texels(const struct dt_resource *resource, const void *left,
                                        const void *right, size_t size, uint32_t width)
{
    const struct dt_bytes copies[2] = {
        {.data = (uint8_t *)left, .size = size, .extent = {width, 1, 1}},
        {.data = (uint8_t *)right, .size = size, .extent = {width, 1, 1}}};
    struct difference difference;
    assert_true(difference_measure(&difference, resource, 0, copies));
    return difference;
}

/* NaN and infinity are found in every texel, also in the last, odd ones. The largest finite number
 * passes, and so do the bits of a NaN in an integer. */
TEST(nan_is_found_anywhere)
{
    enum { TEXELS = 7 };
    static const struct {
        enum dt_format format;
        uint32_t finite, infinite, nan;
    } cases[] = {{DT_FORMAT_R16F, 0xfbff, 0xfc00, 0x7c01},
                 {DT_FORMAT_R32F, 0x7f7fffff, 0x7f800000, 0xff800001}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        const struct dt_resource resource = {
            .name = "i", .kind = DT_IMAGE, .format = cases[i].format};
        uint32_t size = format_info(cases[i].format)->bytes;
        for (uint32_t at = 0; at < TEXELS; at++) {
            uint8_t texels[TEXELS * 4] = {0};
            memcpy(texels + at * size, &cases[i].finite, size);
            struct difference difference =
                compare_texels(&resource, texels, texels, TEXELS * size, TEXELS);
            assert_int_equal(difference_verdict(&difference), VERDICT_EQUAL);
            const uint32_t odd[2] = {cases[i].infinite, cases[i].nan};
            for (int k = 0; k < 2; k++) {
                memcpy(texels + at * size, &odd[k], size);
                difference = compare_texels(&resource, texels, texels, TEXELS * size, TEXELS);
                assert_int_equal(difference_verdict(&difference), VERDICT_NOT_FINITE);
                assert_int_equal(difference.not_finite, 1);
                assert_int_equal(difference.worst.element, at);
            }
        }
    }
    const struct dt_resource integers = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R32UI};
    struct difference difference =
        compare_texels(&integers, &cases[1].nan, &cases[1].nan, sizeof(uint32_t), 1);
    assert_int_equal(difference_verdict(&difference), VERDICT_EQUAL);
}

/* Differences of 5 codes keep the bound 5/255; those of 6 codes do not. A share of outliers counts
 * texels, in each frame. */
TEST(outliers_are_counted)
{
    enum { TEXELS = 100, ALLOWED = 29 };
    uint8_t left[TEXELS][4] = {{0}}, right[TEXELS][4] = {{0}};
    const struct dt_resource resource = {
        .name = "i",
        .kind = DT_IMAGE,
        .format = DT_FORMAT_RGBA8,
        .contract = {.kind = DT_CONTRACT_IMAGE, .tolerance = 5.0 / 255, .outliers = 0.29}};
    for (int i = 0; i < TEXELS; i++)
        for (int c = 0; c < 4; c++) {
            left[i][c] = (uint8_t)(i * 2 + c);
            right[i][c] = (uint8_t)(left[i][c] + 5);
        }
    for (int i = 0; i < ALLOWED; i++)
        right[2 * i][1]++;
    struct difference difference = compare_texels(&resource, left, right, sizeof left, TEXELS);
    assert_int_equal(difference.differing, TEXELS);
    assert_int_equal(difference.beyond, ALLOWED);
    assert_int_equal(difference_verdict(&difference), VERDICT_WITHIN);
    assert_told(difference_describe_worst(&difference, &resource, labels),
                "29 outliers, the largest error 0.0235 at (0, 0).g, frame 0: gl 0.004 (0x01), vk "
                "0.027 (0x07)");
    const struct dt_bytes copies[2] = {
        {.data = &left[0][0], .size = sizeof left, .extent = {TEXELS, 1, 1}},
        {.data = &right[0][0], .size = sizeof right, .extent = {TEXELS, 1, 1}}};
    right[1][3]++;
    assert_true(difference_measure(&difference, &resource, 2, copies));
    assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
    assert_int_equal(difference.beyond, ALLOWED + 1);
}

/* ---- Draws ----------------------------------------------------------------------------------- */

enum { SIDE = 8, LAYERS = 2, DRAWN = SIDE * SIDE * LAYERS };

static struct dt_bytes drawn(const void *texels)
{
    return (struct dt_bytes){
        .data = (uint8_t *)texels, .size = DRAWN * 4, .extent = {SIDE, SIDE, LAYERS}};
}

static struct difference compare_draws(enum dt_format format, const void *left, const void *right,
                                       const bool *edges)
{
    const struct dt_resource resource = {
        .name = "i",
        .kind = DT_IMAGE,
        .format = format,
        .layered = true,
        .contract = {.kind = DT_CONTRACT_RASTER, .tolerance = 3.0 / DRAWN}};
    const struct dt_bytes copies[2] = {drawn(left), drawn(right)};
    struct difference difference;
    assert_true(difference_measure_draw(&difference, &resource, 0, copies, edges));
    return difference;
}

/* Layer 0 has triangle 1 on the left and 2 on the right of x = 3.5; layer 1 has one triangle. */
TEST(draws_may_differ_at_edges)
{
    uint32_t left[DRAWN], right[DRAWN];
    for (int i = 0; i < DRAWN; i++)
        left[i] = i >= SIDE * SIDE ? 7 : i % SIDE < 4 ? 1 : 2;
    const struct dt_resource numbers = {.kind = DT_IMAGE, .format = DT_FORMAT_R32UI};
    const struct {
        uint32_t x, y, layer;
        bool edge;
    } cases[] = {
        {3, 0, 0, true}, {4, 7, 0, true}, {2, 3, 0, false}, {5, 3, 0, false}, {3, 3, 1, false}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        bool *edges;
        const struct dt_bytes same[2] = {drawn(left), drawn(left)};
        assert_true(edges_find(&edges, &numbers, same));
        uint32_t at = (cases[i].layer * SIDE + cases[i].y) * SIDE + cases[i].x;
        memcpy(right, left, sizeof right);
        right[at] += 3;
        struct difference difference = compare_draws(DT_FORMAT_R32UI, left, right, edges);
        assert_int_equal(difference_verdict(&difference),
                         cases[i].edge ? VERDICT_WITHIN : VERDICT_DIFFERS);
        assert_int_equal(difference.differing, 1);
        assert_int_equal(difference.at_edges, cases[i].edge);
        free(edges);
    }
    /* an edge of either copy counts */
    bool *edges;
    memcpy(right, left, sizeof right);
    right[SIDE * SIDE] = 8;
    const struct dt_bytes copies[2] = {drawn(left), drawn(right)};
    assert_true(edges_find(&edges, &numbers, copies));
    struct difference difference = compare_draws(DT_FORMAT_R32UI, left, right, edges);
    assert_int_equal(difference_verdict(&difference), VERDICT_WITHIN);
    free(edges);
    /* at most the allowed share of texels may differ */
    const struct dt_bytes same[2] = {drawn(left), drawn(left)};
    assert_true(edges_find(&edges, &numbers, same));
    memcpy(right, left, sizeof right);
    for (int y = 0; y < 4; y++) {
        right[y * SIDE + 3] = 2;
        difference = compare_draws(DT_FORMAT_R32UI, left, right, edges);
        assert_int_equal(difference_verdict(&difference), y < 3 ? VERDICT_WITHIN : VERDICT_DIFFERS);
    }
    free(edges);
}

/* A triangle of 5x5 texels lies on another, in one copy before it and in the other behind it. */
TEST(coincident_surfaces_may_change_places)
{
    uint32_t numbers[2][DRAWN];
    float depths[2][DRAWN];
    const struct dt_resource resource = {.kind = DT_IMAGE, .format = DT_FORMAT_R32UI};
    const struct {
        float apart; /* in steps of depth from texel to texel */
        bool within;
    } cases[] = {{0, true}, {0.5f, true}, {-0.5f, true}, {2, false}, {-2, false}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        for (int t = 0; t < DRAWN; t++) {
            int x = t % SIDE, y = t / SIDE % SIDE;
            bool both = t < SIDE * SIDE && x >= 1 && x < 6 && y >= 1 && y < 6;
            numbers[0][t] = 1;
            numbers[1][t] = both ? 2 : 1;
            depths[0][t] = 0.5f + (float)x / 64;
            depths[1][t] = depths[0][t] + (both ? cases[i].apart / 64 : 0);
        }
        bool *edges;
        const struct dt_bytes copies[2] = {drawn(numbers[0]), drawn(numbers[1])};
        assert_true(edges_find(&edges, &resource, copies));
        assert_false(edges[3 * SIDE + 3]); /* its neighbours show the same, in either copy */
        edges_add_coincident(edges, (const struct dt_bytes[]){drawn(depths[0]), drawn(depths[1])});
        assert_int_equal(edges[3 * SIDE + 3], cases[i].within);
        free(edges);
    }
}

TEST(of_depth_only_coverage_counts)
{
    float left[DRAWN], right[DRAWN];
    for (int i = 0; i < DRAWN; i++)
        left[i] = i % SIDE < 4 ? 1.0f : 0.5f;
    const struct dt_resource depth = {.kind = DT_IMAGE, .format = DT_FORMAT_D32F};
    const struct dt_bytes copies[2] = {drawn(left), drawn(right)};
    for (int x = 1; x < SIDE; x++) {
        bool *edges;
        memcpy(right, left, sizeof right);
        right[x] = x < 4 ? 0.5f : 0.75f;
        assert_true(edges_find(&edges, &depth, copies));
        struct difference difference = compare_draws(DT_FORMAT_D32F, left, right, edges);
        assert_int_equal(difference_verdict(&difference), x < 4 ? VERDICT_WITHIN : VERDICT_EQUAL);
        free(edges);
    }
}

TEST(sizes_must_match)
{
    static uint8_t bytes[16];
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA8};
    const struct dt_bytes copies[2] = {{.data = bytes, .size = 16, .extent = {4, 1, 1}},
                                       {.data = bytes, .size = 16, .extent = {2, 2, 1}}};
    struct difference difference;
    assert_true(difference_measure(&difference, &resource, 0, copies));
    assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
    assert_told(difference_describe_worst(&difference, &resource, labels), "the sizes differ");
}

TEST(layers_are_named)
{
    uint32_t left[2 * 3 * 2] = {0}, right[2 * 3 * 2] = {0};
    right[9] = 7; /* of 2x3 texels, two layers: the second layer's fourth texel */
    const struct dt_resource resource = {
        .name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R32UI, .layered = true};
    const struct dt_bytes copies[2] = {
        {.data = (uint8_t *)left, .size = sizeof left, .extent = {2, 3, 2}},
        {.data = (uint8_t *)right, .size = sizeof right, .extent = {2, 3, 2}}};
    struct difference difference;
    assert_true(difference_measure(&difference, &resource, 0, copies));
    assert_told(difference_describe_worst(&difference, &resource, labels),
                "7 at (1, 1, layer 1).r, frame 0: gl 0 (0x00000000), vk 7 (0x00000007)");
}

/* ---- Decimals -------------------------------------------------------------------------------- */

/* Bits of the nearest half, ties to even. The value is rounded to units in its last place. The bits
 * are (exponent + 14) * 1024 plus these units. */
static uint16_t half_bits(double value)
{
    int exponent = value != 0 && ilogb(value) > -14 ? ilogb(value) : -14;
    double units = rint(ldexp(fabs(value), 10 - exponent));
    return (uint16_t)((signbit(value) ? 0x8000 : 0) + (exponent + 14) * 1024 + (int)units);
}

/* The description of every finite half has a decimal that reads back as this half. The decimal is
 * not longer than the shortest one of printf. */
TEST(halves_read_back)
{
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R16F};
    for (uint32_t i = 0; i < 0x10000; i++) {
        const uint16_t bits = (uint16_t)i, other = bits ^ 1;
        double value = number_value(NUMBER_HALF, (const uint8_t *)&bits);
        int digits = 0;
        char shortest[32], place[16];
        if ((bits & 0x7c00) == 0x7c00)
            continue;
        do
            snprintf(shortest, sizeof shortest, "%.*g", ++digits, value);
        while (half_bits(strtod(shortest, NULL)) != bits);
        struct difference difference = compare_texels(&resource, &bits, &other, 2, 1);
        char *told = difference_describe_worst(&difference, &resource, labels);
        snprintf(place, sizeof place, " (0x%04x), vk", bits);
        char *decimal = strstr(told, "gl ") + 3, *end = strstr(told, place);
        assert_non_null(end);
        *end = '\0';
        assert_int_equal(half_bits(strtod(decimal, NULL)), bits);
        assert_true(strlen(decimal) <= strlen(shortest));
        free(told);
    }
}

TEST(decimals_are_short)
{
    static const struct {
        float value;
        const char *told;
    } cases[] = {{0.1f, "gl 0.1 (0x3dcccccd)"},
                 {1 / 3.0f, "gl 0.33333334 (0x3eaaaaab)"},
                 {3.402823466e38f, "gl 3.4028235e+38 (0x7f7fffff)"},
                 {0x1p-149f, "gl 1e-45 (0x00000001)"},
                 {16777216, "gl 16777216 (0x4b800000)"},
                 {100, "gl 100 (0x42c80000)"},
                 {1e9f, "gl 1e+09 (0x4e6e6b28)"}};
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R32F};
    const float zero = -1;
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        struct difference difference = compare_texels(&resource, &cases[i].value, &zero, 4, 1);
        char *told = difference_describe_worst(&difference, &resource, labels);
        if (!strstr(told, cases[i].told))
            fail_msg("\"%s\" does not say \"%s\"", told, cases[i].told);
        free(told);
    }
}

/* ---- Flips ----------------------------------------------------------------------------------- */

enum { LABELS = 20 };

static const struct dt_field label_fields[] = {{"", DT_TYPE_INT, 0, 0, 0}};
static const struct dt_field margin_fields[] = {{"mass", DT_TYPE_FLOAT, 0, 0, 0},
                                                {"margin", DT_TYPE_FLOAT, 4, 0, 0}};
static const struct dt_resource label_margins = {
    .name = "m", .kind = DT_BUFFER, .fields = margin_fields, .field_count = 2, .stride = 8};

static struct dt_resource label_buffer(double flips, int16_t margin_field)
{
    return (struct dt_resource){.name = "labels",
                                .kind = DT_BUFFER,
                                .contract = {.kind = DT_CONTRACT_FLIPS,
                                             .tolerance = flips,
                                             .margin_resource = 1,
                                             .margin_field = margin_field},
                                .fields = label_fields,
                                .field_count = 1,
                                .stride = 4};
}

static struct difference compare_labels(const struct dt_resource *resource,
                                        const int32_t left[LABELS], const int32_t right[LABELS])
{
    const struct dt_bytes copies[2] = {
        {.data = (uint8_t *)left, .size = LABELS * 4, .extent = {LABELS}},
        {.data = (uint8_t *)right, .size = LABELS * 4, .extent = {LABELS}}};
    struct difference difference;
    assert_true(difference_measure(&difference, resource, 0, copies));
    return difference;
}

TEST(flips_are_allowed_and_listed)
{
    static const int32_t left[LABELS] = {-1, 5, 2};
    static const int32_t right[LABELS] = {-1, 2, 6};
    static const float margins[2][LABELS][2] = {{{0, 0}, {9, 0x1p-24f}, {9, 0.25f}},
                                                {{0, 0}, {9, 0}, {9, 0.5f}}};
    const struct dt_bytes copies[2] = {
        {.data = (uint8_t *)margins[0], .size = sizeof margins[0], .extent = {LABELS}},
        {.data = (uint8_t *)margins[1], .size = sizeof margins[1], .extent = {LABELS}}};
    const struct dt_resource two = label_buffer(2, 1), one = label_buffer(1, 1);
    struct difference difference = compare_labels(&one, left, right);
    assert_int_equal(difference_verdict(&difference), VERDICT_DIFFERS);
    difference = compare_labels(&two, left, right);
    assert_int_equal(difference_verdict(&difference), VERDICT_WITHIN);
    assert_true(difference_needs_margins(&difference, &two));
    difference_add_margins(&difference, &two, &label_margins, copies);
    assert_told(difference_describe_worst(&difference, &two, labels),
                "2 flips, the first at [1], frame 0: gl 5 (0x00000005), vk 2 (0x00000002)");
    assert_told(difference_list_flips(&difference, &two, labels),
                "  flip at [1], frame 0: gl 5 (0x00000005), vk 2 (0x00000002); margin gl "
                "5.9604645e-08 (0x33800000), vk 0 (0x00000000)\n"
                "  flip at [2], frame 0: gl 2 (0x00000002), vk 6 (0x00000006); margin gl 0.25 "
                "(0x3e800000), vk 0.5 (0x3f000000)\n");
}

TEST(flips_without_margins)
{
    int32_t left[LABELS], right[LABELS];
    const struct dt_resource resource = label_buffer(LABELS, -1);
    for (int i = 0; i < LABELS; i++) {
        left[i] = i;
        right[i] = i + 1;
    }
    struct difference difference = compare_labels(&resource, left, left);
    assert_told(difference_list_flips(&difference, &resource, labels), "");
    difference = compare_labels(&resource, left, right);
    assert_false(difference_needs_margins(&difference, &resource));
    assert_int_equal(difference.differing, LABELS);
    char *told = difference_list_flips(&difference, &resource, labels);
    assert_non_null(strstr(told, "  flip at [15], frame 0: gl 15 (0x0000000f), vk 16 (0x"));
    assert_null(strstr(told, "[16]"));
    assert_non_null(strstr(told, "\n  and 4 more flips\n"));
    assert_null(strstr(told, "margin"));
    free(told);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

TEST(json_has_what_was_told)
{
    static const int32_t left[LABELS] = {0, 5}, right[LABELS] = {0, 2};
    static const float margins[LABELS][2] = {{0, 0}, {9, 0.25f}};
    const struct dt_bytes copy = {
        .data = (uint8_t *)margins, .size = sizeof margins, .extent = {LABELS}};
    const struct dt_resource resource = label_buffer(0, 1);
    struct difference difference = compare_labels(&resource, left, right);
    difference_add_margins(&difference, &resource, &label_margins,
                           (const struct dt_bytes[]){copy, copy});
    cJSON *root = cJSON_CreateObject();
    difference_json(root, &difference, &resource, labels);
    char *text = cJSON_PrintUnformatted(root);
    static const char pair[] =
        "{\"frame\":0,\"element\":1,\"place\":\"[1]\",\"component\":\"\",\"error\":1,"
        "\"gl\":{\"value\":5,\"bits\":\"0x00000005\"},"
        "\"vk\":{\"value\":2,\"bits\":\"0x00000002\"}";
    char expected[1024];
    snprintf(expected, sizeof expected,
             "{\"contract\":\"flips\",\"tolerance\":0,\"elements\":20,\"differing\":1,\"beyond\":1,"
             "\"not_finite\":0,\"size_differs\":false,\"verdict\":\"DIFFERS\",\"worst\":%s},"
             "\"flips\":[%s,\"margin\":{\"gl\":{\"value\":0.25,\"bits\":\"0x3e800000\"},"
             "\"vk\":{\"value\":0.25,\"bits\":\"0x3e800000\"}}}]}",
             pair, pair);
    assert_string_equal(text, expected);
    cJSON_free(text);
    cJSON_Delete(root);
}

RUN_TESTS("difference", NULL, NULL)
