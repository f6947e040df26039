/* What of scenes scene-print does not show: image files, numbers of triangles, and the child that reads
 * meshes. scenes.py has the rest. Fixtures live in a temporary folder. The OpenImageIO shim must lie
 * beside this program or in the folder above it. */
#include "child.h"
#include "diptych_scene.h"
#include "image.h"
#include "base/log.h"

#include "tests/lib/unit.h"
#include <png.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- Fixtures -------------------------------------------------------------------------------- */

struct heard {
    int count[DT_ERROR + 1];
    char text[8192]; /* the latest warning or error */
};

static struct heard heard; /* of the present test */

static void hear(void *user, enum dt_level level, const char *message)
{
    (void)user;
    heard.count[level]++;
    if (level >= DT_WARNING)
        snprintf(heard.text, sizeof heard.text, "%s", message);
}

static const struct dt_log hearing = {hear, NULL};

static int forget(void **state)
{
    (void)state;
    memset(&heard, 0, sizeof heard);
    return 0;
}

static char folder[] = "/tmp/scene_test.XXXXXX";

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[64];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

/* Path of a fixture; valid until the fourth call after. */
static const char *at(const char *name)
{
    static char paths[4][256];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void put(const char *name, const char *text)
{
    FILE *file = fopen(at(name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* The closed box of 8 vertices and 12 triangles needs 4 more vertices; winding and corners stay. */
TEST_WITH(triangles_are_numbered_by_their_first_vertex, NULL, forget)
{
    static const uint32_t box[36] = {0, 3, 2, 0, 2, 1, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                     2, 3, 7, 2, 7, 6, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5};
    uint32_t indices[36], triangles[8 + 12], copied[12];
    memcpy(indices, box, sizeof indices);
    assert_int_equal(dt_number_triangles(indices, 36, 8, triangles, copied), 12);
    for (uint32_t t = 0; t < 12; t++) {
        uint32_t corner[3], turn = 0;
        assert_int_equal(triangles[indices[3 * t]], t);
        for (int k = 0; k < 3; k++) {
            uint32_t vertex = indices[3 * t + (uint32_t)k];
            corner[k] = vertex < 8 ? vertex : copied[vertex - 8];
        }
        while (turn < 3 && box[3 * t + turn] != corner[0])
            turn++;
        for (uint32_t k = 0; k < 3; k++)
            assert_int_equal(corner[k], box[3 * t + (turn + k) % 3]);
    }
}

/* ---- Image files ----------------------------------------------------------------------------- */

TEST_WITH(images_survive_the_round_trip, NULL, forget)
{
    uint8_t codes[5 * 3 * 4], *read_codes;
    for (int i = 0; i < 60; i++)
        codes[i] = (uint8_t)(i * 37);
    uint32_t width = 0, height = 0;
    assert_true(image_write_png(at("a.png"), 5, 3, 4, codes, &hearing));
    assert_true(image_read_rgba8(at("a.png"), &width, &height, &read_codes, &hearing));
    assert_int_equal(width, 5);
    assert_int_equal(height, 3);
    assert_memory_equal(read_codes, codes, sizeof codes);
    free(read_codes);
    assert_int_equal(heard.count[DT_ERROR], 0);
}

/* Grey with alpha, 8-bit; and 16-bit linear, which OpenImageIO reads. */
TEST_WITH(kinds_of_png_are_read, NULL, forget)
{
    const uint8_t grey[2 * 2] = {10, 200, 30, 40};
    const uint8_t spread[2 * 4] = {10, 10, 10, 200, 30, 30, 30, 40};
    const png_uint_16 deep[2 * 3] = {1, 2, 3, 40000, 50000, 65535};
    png_image png = {.version = PNG_IMAGE_VERSION, .width = 2, .height = 1};
    uint32_t width = 0, height = 0;
    uint8_t *codes;
    float *texels;
    assert_true(image_write_png(at("grey.png"), 2, 1, 2, grey, &hearing));
    assert_true(image_read_rgba8(at("grey.png"), &width, &height, &codes, &hearing));
    assert_memory_equal(codes, spread, sizeof spread);
    free(codes);
    assert_true(image_read_float(at("grey.png"), &width, &height, &texels, &hearing));
    for (int i = 0; i < 8; i++)
        assert_float_equal(texels[i], spread[i] / 255.0f, 0);
    free(texels);
    /* Resized, by threads of OpenImageIO, beside which LeakSanitizer crashes: in a child. */
    width = height = 4;
    int status;
    pid_t child = fork();
    if (child == 0)
        _exit(!image_read_rgba8(at("grey.png"), &width, &height, &codes, &hearing) || width != 4 ||
              codes[0] != 10 || codes[4 * 15] != 30);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    png.format = PNG_FORMAT_LINEAR_RGB;
    assert_true(png_image_write_to_file(&png, at("deep.png"), 0, deep, 0, NULL));
    assert_true(image_read_float(at("deep.png"), &width, &height, &texels, &hearing));
    assert_int_equal(width, 2);
    for (int i = 0; i < 6; i++)
        assert_float_equal(texels[i + i / 3], deep[i] / 65535.0f, 1e-7);
    free(texels);
    assert_true(image_size(at("deep.png"), &width, &height, &hearing));
    assert_int_equal(width, 2);
    assert_int_equal(height, 1);
    assert_int_equal(heard.count[DT_ERROR], 0);
}

TEST_WITH(image_errors_name_the_file, NULL, forget)
{
    const uint8_t texel[4] = {1, 2, 3, 4};
    uint32_t width = 0, height = 0;
    uint8_t *texels;
    assert_false(image_write_png(at("no/such/folder.png"), 1, 1, 4, texel, &hearing));
    assert_non_null(strstr(heard.text, "no/such/folder.png"));
    put("text.png", "this is no picture");
    assert_false(image_read_rgba8(at("text.png"), &width, &height, &texels, &hearing));
    assert_non_null(strstr(heard.text, "text.png"));
    assert_int_equal(heard.count[DT_ERROR], 2);
}

/* ---- Child processes ------------------------------------------------------------------------- */

static bool crash(FILE *result, void *user, const struct dt_log *log)
{
    (void)result;
    child_opens(user);
    report_message(log, DT_WARNING, "before");
    raise(SIGKILL); /* which no sanitizer catches */
    return true;
}

static bool refuse(FILE *result, void *user, const struct dt_log *log)
{
    (void)result;
    report_error(log, "no %s", (const char *)user);
    return false;
}

static bool answer(FILE *result, void *user, const struct dt_log *log)
{
    (void)log;
    return fprintf(result, "%s", (const char *)user) > 0;
}

TEST_WITH(a_child_answers_refuses_or_crashes_alone, NULL, forget)
{
    char text[8] = "";
    FILE *result = child_run(answer, "all", &hearing);
    assert_non_null(result);
    assert_non_null(fgets(text, sizeof text, result));
    assert_string_equal(text, "all");
    fclose(result);
    assert_int_equal(heard.count[DT_ERROR], 0);
    assert_null(child_run(refuse, "mesh", &hearing));
    assert_string_equal(heard.text, "no mesh");
    assert_null(child_run(crash, "odd.mtl", &hearing));
    assert_int_equal(heard.count[DT_WARNING], 1);
    assert_int_equal(heard.count[DT_ERROR], 2);
    assert_non_null(strstr(heard.text, "odd.mtl: the library that reads this file crashed"));
}

RUN_TESTS("scenes", make_folder, remove_folder)
