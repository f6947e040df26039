/* Strips, read back from their files: the layer, the brightness, the place. Expected codes come
 * from the definition: from dark grey, 48, to 255 with the square root of the amplified
 * difference. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/lib/unit.h"
#include "base/files.h"
#include "app/picture/strip.h"
#include "scenes/image.h"

enum { SEPARATOR = 4, READABLE = 256 };

static int errors;

static void hear(void *user, enum dt_level level, const char *message)
{
    (void)user;
    (void)message;
    errors += level == DT_ERROR;
}

static const struct dt_log listener = {.message = hear};

/* A strip that was written and read back. */
struct seen {
    struct strip strip;
    uint32_t width, height, scale, panel;
    uint8_t *texels; /* RGBA */
};

/* The panels in files of their own have the same texels as the strip, but no yellow square. */
static void compare_apart(const char *folder, const struct seen *seen,
                          const struct dt_resource *resource, const struct dt_bytes copies[2])
{
    char *paths[3];
    struct strip strip;
    for (int i = 0; i < 3; i++)
        assert_non_null(paths[i] = format_string("%s/%d.png", folder, i));
    assert_true(strip_write_apart(&strip, (const char *const *)paths, resource, copies, &listener));
    assert_true(strip.amplification == seen->strip.amplification &&
                strip.layer == seen->strip.layer);
    for (uint32_t panel = 0; panel < 3; panel++) {
        uint32_t width = 0, height = 0;
        uint8_t *codes;
        assert_true(image_read_rgba8(paths[panel], &width, &height, &codes, &listener));
        assert_int_equal(width * seen->scale, seen->panel);
        assert_int_equal(height * seen->scale, seen->height);
        for (uint32_t i = 0; i < width * height; i++) {
            uint32_t x = panel * (seen->panel + SEPARATOR) + i % width * seen->scale;
            const uint8_t *found =
                seen->texels + ((size_t)(i / width * seen->scale) * seen->width + x) * 4;
            bool yellow = panel == 2 && found[0] == 255 && found[1] == 255 && found[2] == 0;
            if (!yellow)
                assert_memory_equal(codes + (size_t)i * 4, found, 4);
        }
        free(codes);
        free(paths[panel]);
    }
}

static struct seen look(const struct dt_resource *resource, const void *left, const void *right,
                        size_t size, const uint32_t extent[3])
{
    char folder[] = "/tmp/diptych-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *path = format_string("%s/strip.png", folder);
    struct dt_bytes copies[2] = {{.data = (uint8_t *)left, .size = size},
                                 {.data = (uint8_t *)right, .size = size}};
    memcpy(copies[0].extent, extent, sizeof copies[0].extent);
    memcpy(copies[1].extent, extent, sizeof copies[1].extent);
    struct seen seen = {.width = 0};
    assert_true(strip_write(&seen.strip, path, resource, copies, &listener));
    assert_true(image_read_rgba8(path, &seen.width, &seen.height, &seen.texels, &listener));
    seen.scale = seen.height / extent[1];
    seen.panel = extent[0] * seen.scale;
    assert_int_equal(seen.width, 3 * seen.panel + 2 * SEPARATOR);
    compare_apart(folder, &seen, resource, copies);
    file_remove_tree(folder);
    free(path);
    return seen;
}

/* Checks the code of texel (x, y), y upwards, in a panel. The texel is enlarged, so both its
 * corners count. */
static void expect_code(const struct seen *seen, uint32_t panel, uint32_t x, uint32_t y,
                        uint32_t red, uint32_t green, uint32_t blue)
{
    uint32_t left = panel * (seen->panel + SEPARATOR) + x * seen->scale;
    uint32_t bottom = seen->height - 1 - y * seen->scale;
    const uint32_t expected[3] = {red, green, blue};
    for (int corner = 0; corner < 2; corner++) {
        uint32_t at_x = left + (corner ? seen->scale - 1 : 0);
        uint32_t at_y = bottom - (corner ? seen->scale - 1 : 0);
        const uint8_t *code = seen->texels + ((size_t)at_y * seen->width + at_x) * 4;
        for (int c = 0; c < 3; c++)
            if (code[c] != expected[c])
                fail_msg("panel %u, texel (%u, %u), channel %d: %u, expected %u", panel, x, y, c,
                         code[c], expected[c]);
    }
}

static uint32_t bright(double amplified)
{
    return (uint32_t)lrint(48 + (255 - 48) * sqrt(amplified));
}

TEST(codes_stand_side_by_side)
{
    static const uint8_t left[4][4] = {{10, 20, 30, 0}, {1, 2, 3, 0}, {0}, {0}};
    static const uint8_t right[4][4] = {{10, 21, 30, 0}, {1, 2, 3, 2}, {0}, {0}};
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA8};
    struct seen seen = look(&resource, left, right, sizeof left, (const uint32_t[]){2, 2, 1});
    assert_int_equal(seen.scale, READABLE / 2);
    assert_true(seen.strip.amplification == 64); /* 2/255 * 64 is in 1/2..1 */
    expect_code(&seen, 0, 0, 0, 10, 20, 30);
    expect_code(&seen, 1, 0, 0, 10, 21, 30);
    const uint32_t one = bright(64 / 255.0), two = bright(128 / 255.0);
    expect_code(&seen, 2, 0, 0, 48, one, 48);
    expect_code(&seen, 2, 1, 0, two, two, two); /* alpha alone */
    expect_code(&seen, 2, 0, 1, 0, 0, 0);
    const uint8_t *separator = seen.texels + (size_t)seen.panel * 4;
    assert_int_equal(separator[0], 128);
    assert_int_equal(separator[(size_t)SEPARATOR * 4], 0); /* the second copy begins */
    free(seen.texels);
}

/* The smallest difference beside the largest is still seen; both copies share one mapping. */
TEST(no_difference_is_black)
{
    const float left[3] = {-1e6f, 1, 0.5f}, right[3] = {1e6f, 1, nextafterf(0.5f, 1)};
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R32F};
    struct seen seen = look(&resource, left, right, sizeof left, (const uint32_t[]){3, 1, 1});
    assert_true(seen.strip.amplification == 0x1p-21);
    expect_code(&seen, 0, 0, 0, 0, 0, 0);
    expect_code(&seen, 1, 0, 0, 255, 255, 255);
    const uint32_t largest = bright(2e6 / 0x1p21);
    expect_code(&seen, 2, 0, 0, largest, largest, largest);
    expect_code(&seen, 2, 1, 0, 0, 0, 0);
    expect_code(&seen, 2, 2, 0, 48, 48, 48);
    free(seen.texels);
}

TEST(worst_layer_is_shown)
{
    const float left[4] = {0.25f, 0.5f, 1, 1};
    float right[4] = {0.25f, 0.75f, 2, 1};
    const struct dt_resource resource = {
        .name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R32F, .layered = true};
    const uint32_t extent[3] = {1, 1, 4};
    struct seen seen = look(&resource, left, right, sizeof left, extent);
    assert_int_equal(seen.strip.layer, 2);
    assert_true(seen.strip.amplification == 1);
    free(seen.texels);
    right[3] = NAN;
    seen = look(&resource, left, right, sizeof left, extent);
    assert_int_equal(seen.strip.layer, 3);
    expect_code(&seen, 1, 0, 0, 255, 0, 255);
    expect_code(&seen, 2, 0, 0, 255, 0, 255);
    free(seen.texels);
}

/* Two of 200 texels that differ may lie beyond full brightness; three may not. */
TEST(outliers_do_not_hide_the_rest)
{
    enum { TEXELS = 210 };
    float left[TEXELS] = {0}, right[TEXELS] = {0};
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R32F};
    for (int i = 0; i < 200; i++)
        right[i] = 0x1p-10f;
    right[7] = right[90] = 100;
    struct seen seen = look(&resource, left, right, sizeof left, (const uint32_t[]){TEXELS, 1, 1});
    assert_true(seen.strip.amplification == 0x1p10);
    expect_code(&seen, 2, 0, 0, 255, 255, 255);
    expect_code(&seen, 2, 90, 0, 255, 255, 255);
    expect_code(&seen, 2, 205, 0, 0, 0, 0);
    free(seen.texels);
    right[91] = 100;
    seen = look(&resource, left, right, sizeof left, (const uint32_t[]){TEXELS, 1, 1});
    assert_true(seen.strip.amplification == 0x1p-7);
    free(seen.texels);
}

/* The two ends of the floats. */
TEST(extremes_are_amplified)
{
    const float left[2] = {-FLT_MAX, 0}, right[2] = {FLT_MAX, FLT_TRUE_MIN};
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R32F};
    const uint32_t extent[3] = {1, 1, 1};
    struct seen seen = look(&resource, &left[0], &right[0], sizeof left[0], extent);
    assert_true(seen.strip.amplification == 0x1p-129);
    free(seen.texels);
    seen = look(&resource, &left[1], &right[1], sizeof left[1], extent);
    assert_true(seen.strip.amplification == 0x1p149);
    expect_code(&seen, 2, 0, 0, 255, 255, 255);
    free(seen.texels);
}

TEST(largest_is_framed)
{
    enum { SIDE = 300 };
    static uint8_t left[SIDE][SIDE], right[SIDE][SIDE];
    right[20][100] = 9;
    right[200][100] = 8;
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R8};
    struct seen seen = look(&resource, left, right, sizeof left, (const uint32_t[]){SIDE, SIDE, 1});
    expect_code(&seen, 2, 100 - 8, 20 - 8, 255, 255, 0);
    expect_code(&seen, 2, 100 + 8, 20 + 8, 255, 255, 0);
    expect_code(&seen, 2, 100, 20 - 8, 255, 255, 0);
    expect_code(&seen, 2, 100 + 8, 20, 255, 255, 0);
    expect_code(&seen, 2, 100, 20 - 7, 0, 0, 0);
    expect_code(&seen, 2, 100 - 8, 200 - 8, 0, 0, 0);
    free(seen.texels);
}

TEST(labels_differ_or_not)
{
    static const uint32_t left[2] = {3, 4}, right[2] = {3, 1000000};
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R32UI};
    struct seen seen = look(&resource, left, right, sizeof left, (const uint32_t[]){2, 1, 1});
    assert_true(seen.strip.amplification == 0);
    expect_code(&seen, 2, 0, 0, 0, 0, 0);
    expect_code(&seen, 2, 1, 0, 255, 255, 255);
    free(seen.texels);
}

TEST(large_images_keep_their_size)
{
    enum { WIDTH = 300, HEIGHT = 3 };
    static uint8_t left[HEIGHT][WIDTH], right[HEIGHT][WIDTH];
    right[2][299] = 255;
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_R8};
    struct seen seen =
        look(&resource, left, right, sizeof left, (const uint32_t[]){WIDTH, HEIGHT, 1});
    assert_int_equal(seen.scale, 1);
    expect_code(&seen, 1, 299, 2, 255, 255, 255);
    expect_code(&seen, 0, 299, 2, 0, 0, 0);
    expect_code(&seen, 2, 299, 2, 255, 255, 255);
    free(seen.texels);
}

TEST(others_are_refused)
{
    static uint8_t bytes[16];
    const struct dt_bytes copies[2] = {{.data = bytes, .size = 16, .extent = {4, 1, 1}},
                                       {.data = bytes, .size = 16, .extent = {2, 2, 1}}};
    const struct dt_bytes none[2] = {{.data = bytes, .size = 0, .extent = {0, 4, 1}},
                                     {.data = bytes, .size = 0, .extent = {0, 4, 1}}};
    const struct dt_resource image = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA8};
    const struct dt_resource buffer = {.name = "b", .kind = DT_BUFFER};
    const char *path = "/tmp/diptych-never-written.png";
    struct strip strip;
    errors = 0;
    assert_false(strip_write(&strip, path, &image, copies, &listener));
    assert_false(strip_write(&strip, path, &image, none, &listener));
    assert_false(strip_write(&strip, path, &buffer, copies, &listener));
    assert_int_equal(errors, 3);
    assert_false(file_exists(path));
}

RUN_TESTS("strip", NULL, NULL)
