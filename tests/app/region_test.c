/* The box around failing elements, and the one element that halving finds, against maps drawn
 * here. */
#include <stdlib.h>
#include <string.h>

#include "tests/lib/unit.h"
#include "app/result/region.h"

enum { WIDTH = 7, HEIGHT = 5, LAYERS = 3, TEXELS = WIDTH * HEIGHT * LAYERS };

static const struct dt_resource image = {
    .name = "image", .kind = DT_IMAGE, .format = DT_FORMAT_RG32F, .layered = true, .mips = 1};
static const struct dt_field fields[] = {{.name = "flux", .type = DT_TYPE_VEC3, .offset = 0}};
static const struct dt_resource buffer = {
    .name = "buffer", .kind = DT_BUFFER, .fields = fields, .field_count = 1, .stride = 16};

static void ignore(void *user, enum dt_level level, const char *message)
{
    (void)user;
    (void)level;
    (void)message;
}
static const struct dt_log quiet = {.message = ignore};

static struct region find(const struct dt_resource *resource, void *a, void *b, size_t size,
                          uint32_t width, uint32_t height, uint32_t layers)
{
    struct region region;
    const struct dt_bytes copies[2] = {
        {.data = a, .size = size, .extent = {width, height, layers}},
        {.data = b, .size = size, .extent = {width, height, layers}}};
    assert_true(region_find(&region, resource, copies, &quiet));
    return region;
}

static void expect_text(const struct region *region, const struct dt_resource *resource,
                        const char *expected)
{
    char *text = region_describe(region, resource);
    assert_string_equal(text, expected);
    free(text);
}

static uint64_t place(uint32_t x, uint32_t y, uint32_t layer)
{
    return ((uint64_t)layer * HEIGHT + y) * WIDTH + x;
}

TEST(test_one_texel)
{
    float a[TEXELS][2] = {0}, b[TEXELS][2] = {0};
    b[place(4, 2, 1)][1] = 1e-30f;
    struct region region = find(&image, a, b, sizeof a, WIDTH, HEIGHT, LAYERS);
    expect_text(&region, &image,
                "1 element differs within x 4, y 2, layer 1; smallest: (4, 2, layer 1)");
}

TEST(test_two_texels)
{
    float a[TEXELS][2] = {0}, b[TEXELS][2] = {0};
    b[place(6, 0, 0)][0] = b[place(6, 0, 0)][1] = 3;
    b[place(1, 4, 2)][0] = -0.0f; /* another bit, and exact means bits */
    struct region region = find(&image, a, b, sizeof a, WIDTH, HEIGHT, LAYERS);
    assert_int_equal(region.failing, 2);
    char *text = region_describe(&region, &image);
    const char *start = "2 elements differ within x 1..6, y 0..4, layer 0..2; smallest: ";
    assert_memory_equal(text, start, strlen(start));
    assert_true(strcmp(text + strlen(start), "(6, 0, layer 0)") == 0 ||
                strcmp(text + strlen(start), "(1, 4, layer 2)") == 0);
    free(text);
}

TEST(test_random_maps)
{
    uint32_t random = 1;
    for (int round = 0; round < 300; round++) {
        static float a[TEXELS][2], b[TEXELS][2];
        uint32_t low[3] = {99, 99, 99}, high[3] = {0}, count = 0;
        memset(b, 0, sizeof b);
        for (uint32_t i = 0; i < TEXELS; i++) {
            random = random * 1664525 + 1013904223;
            if (random >> 16 > 65536u / (1 + (uint32_t)round % 40))
                continue;
            const uint32_t at[3] = {i % WIDTH, i / WIDTH % HEIGHT, i / (WIDTH * HEIGHT)};
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = at[axis] < low[axis] ? at[axis] : low[axis];
                high[axis] = at[axis] > high[axis] ? at[axis] : high[axis];
            }
            b[i][i % 2] = 1;
            count++;
        }
        struct region region = find(&image, a, b, sizeof a, WIDTH, HEIGHT, LAYERS);
        assert_int_equal(region.failing, count);
        if (!count)
            continue;
        assert_memory_equal(region.low, low, sizeof low);
        assert_memory_equal(region.high, high, sizeof high);
        const uint32_t *at = region.smallest;
        const float *texel = b[place(at[0], at[1], at[2])];
        assert_true(texel[0] == 1 || texel[1] == 1);
    }
}

TEST(test_buffers_and_their_padding)
{
    float a[6][4] = {0}, b[6][4] = {0};
    b[5][3] = 1; /* padding */
    struct region region = find(&buffer, a, b, sizeof a, 6, 0, 0);
    assert_int_equal(region.failing, 0);
    b[2][1] = 1;
    region = find(&buffer, a, b, sizeof a, 6, 0, 0);
    expect_text(&region, &buffer, "1 element differs within [2]; smallest: [2]");
    b[4][0] = 1;
    region = find(&buffer, a, b, sizeof a, 6, 0, 0);
    assert_true(region.smallest[0] == 2 || region.smallest[0] == 4);
    region.smallest[0] = 4;
    expect_text(&region, &buffer, "2 elements differ within [2..4]; smallest: [4]");
}

TEST(test_only_what_breaks_the_contract)
{
    float a[TEXELS][2] = {0}, b[TEXELS][2] = {0};
    struct dt_resource lenient = image;
    lenient.contract = (struct dt_contract){.kind = DT_CONTRACT_ABS, .tolerance = 0.1};
    for (uint32_t i = 0; i < TEXELS; i++)
        b[i][0] = 0.05f;
    b[place(3, 3, 2)][0] = 0.15f;
    struct region region = find(&lenient, a, b, sizeof a, WIDTH, HEIGHT, LAYERS);
    expect_text(&region, &image,
                "1 element differs within x 3, y 3, layer 2; smallest: (3, 3, layer 2)");
}

RUN_TESTS("region", NULL, NULL)
