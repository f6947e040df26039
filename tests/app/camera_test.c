/* The camera of the window: its movements, and its file after a save. Expected directions are those
 * of a right-handed room; libfyaml reads the file. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/lib/unit.h"
#include <libfyaml.h>

#include "base/files.h"
#include "app/run/camera.h"

static const struct dt_scene_camera ahead = {{1, 2, 3}, {1, 2, -1}, {0, 1, 0}, 0.7f};

static void assert_at(const float found[3], double x, double y, double z)
{
    const double wanted[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        assert_true(fabs(found[i] - wanted[i]) < 1e-5);
}

TEST(it_moves_along_its_axes)
{
    struct dt_scene_camera camera = ahead; /* looks along -z: right is +x, up +y */
    camera_move(&camera, 0.5f, 0, 0);
    assert_at(camera.eye, 1.5, 2, 3);
    assert_at(camera.target, 1.5, 2, -1);
    camera_move(&camera, 0, 0.25f, 2);
    assert_at(camera.eye, 1.5, 2.25, 1);
    assert_at(camera.target, 1.5, 2.25, -3);
}

TEST(it_turns_about_its_eye)
{
    struct dt_scene_camera camera = ahead;
    camera_turn(&camera, (float)M_PI / 2, 0);
    assert_at(camera.eye, 1, 2, 3);
    assert_at(camera.target, 5, 2, 3); /* to the right, as far as before */
    camera_turn(&camera, (float)-M_PI / 2, (float)M_PI / 6);
    assert_at(camera.target, 1, 4, 3 - 4 * cos(M_PI / 6));
}

TEST(it_never_tips_over)
{
    struct dt_scene_camera camera = ahead;
    for (int i = 0; i < 50; i++)
        camera_turn(&camera, 0.01f, 0.3f);
    assert_true(camera.target[1] < 2 + 4 && camera.target[1] > 2 + 3.9);
    for (int i = 0; i < 50; i++)
        camera_turn(&camera, -0.01f, -0.3f);
    assert_true(camera.target[1] > 2 - 4 && camera.target[1] < 2 - 3.9);
    assert_true(camera.target[2] < 3); /* still ahead */
}

/* ---- Saving ---------------------------------------------------------------------------------- */

static void ignore(void *user, enum dt_level level, const char *message)
{
    (void)level;
    (void)message;
    ++*(int *)user;
}

/* Floats that need many digits: a file with few digits does not restore most of them. */
static const struct dt_scene_camera odd = {
    {0.278f, 1.0f / 3, 1e-7f}, {-123456.789f, 0.1f, -0.8f}, {0, 1, 0}, 0.685914397f};

/* Saves the camera into a file with this content. Returns the new content, to free(). */
static char *saved(const char *content, bool wanted)
{
    char path[] = "/tmp/camera-XXXXXX";
    int errors = 0, file = mkstemp(path);
    const struct dt_log log = {.message = ignore, .user = &errors};
    size_t size = strlen(content);
    assert_true(file >= 0 && write(file, content, size) == (ssize_t)size);
    close(file);
    assert_int_equal(camera_save(&odd, path, &log), wanted);
    assert_int_equal(errors, !wanted);
    char *text = file_read(path, &size, &log);
    unlink(path);
    assert_non_null(text);
    return text;
}

static double number_at(struct fy_document *document, const char *path, int index)
{
    struct fy_node *node =
        fy_node_by_path(fy_document_root(document), path, FY_NT, FYNWF_DONT_FOLLOW);
    if (node && index >= 0)
        node = fy_node_sequence_get_by_index(node, index);
    return node ? strtod(fy_node_get_scalar0(node), NULL) : (double)NAN;
}

static void assert_camera(const char *text)
{
    struct fy_document *document = fy_document_build_from_string(NULL, text, FY_NT);
    assert_non_null(document);
    for (int i = 0; i < 3; i++) {
        assert_true((float)number_at(document, "/camera/eye", i) == odd.eye[i]);
        assert_true((float)number_at(document, "/camera/target", i) == odd.target[i]);
        assert_true((float)number_at(document, "/camera/up", i) == odd.up[i]);
    }
    assert_true((float)(number_at(document, "/camera/fov_y", -1) * M_PI / 180) == odd.fov_y);
    fy_document_destroy(document);
}

/* The text before and after the camera must stay the same. */
static void check_saved(const char *before, const char *camera, const char *after)
{
    char *content = format_string("%s%s%s", before, camera, after);
    char *text = saved(content, true);
    size_t length = strlen(text);
    assert_camera(text);
    assert_true(strncmp(text, before, strlen(before)) == 0);
    assert_true(length > strlen(after) && strcmp(text + length - strlen(after), after) == 0);
    assert_null(strstr(text, "9.5")); /* no number of the old camera */
    assert_non_null(strstr(text, "[0.278, "));
    free(text);
    free(content);
}

TEST(nothing_else_changes)
{
    const char *flow = "{eye: [9.5, 9.5, 9.5], target: [0, 0, 9.5], fov_y: 9.5}";
    const char *block = "eye: [9.5, 9.5, 9.5]\n  target: [0, 0, 9.5]\n  fov_y: 9.5";
    check_saved("# Ein Würfel aus Glas\nmesh: a.obj\ncamera: ", flow,
                "   # the best\nlight: {kind: spot}\n");
    check_saved("mesh: a.obj\ncamera:\n  ", block, "\n\n# of noon\nlight:\n  kind: spot\n");
    check_saved("note: {camera: {eye: none}}\nmesh: a.obj\ncamera:\n  ", block, "\n");
    check_saved("camera: ", flow, "");
}

TEST(a_file_without_camera_stays)
{
    static const char *const contents[] = {"mesh: a.obj\nnote: {camera: {eye: [1, 2, 3]}}\n",
                                           "mesh: camera\n", "camera: none\n",
                                           "camera: {eye: [1,\n", ""};
    for (size_t i = 0; i < DT_ARRAY_COUNT(contents); i++) {
        char *text = saved(contents[i], false);
        assert_string_equal(text, contents[i]);
        free(text);
    }
}

RUN_TESTS("camera", NULL, NULL)
