/* What library.h declares: the log, a frame, a triangle, and content for inputs. */
#include "library.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

struct heard heard;

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    heard.errors += level == DT_ERROR;
    heard.warnings += level == DT_WARNING;
    if (level >= DT_WARNING)
        snprintf(heard.text, sizeof heard.text, "%s", message);
}
const struct dt_log test_log = {.message = on_log};

static EGLDisplay display;

int open_opengl(void **state)
{
    (void)state;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    assert_true(eglInitialize(display, NULL, NULL) && eglBindAPI(EGL_OPENGL_API));
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    assert_true(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context));
    return 0;
}

int close_opengl(void **state)
{
    (void)state;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglTerminate(display);
    return 0;
}

struct dt_frame frame_of(uint32_t index)
{
    struct dt_frame frame = {.scene_radius = 1, .index = index, .triangle_count = 1};
    for (int i = 0; i < 4; i++)
        frame.camera.view[i][i] = frame.camera.projection[i][i] =
            frame.camera.view_projection[i][i] = frame.camera.inverse_view_projection[i][i] =
                frame.light_view.view[i][i] = frame.light_view.projection[i][i] =
                    frame.light_view.view_projection[i][i] =
                        frame.light_view.inverse_view_projection[i][i] = 1;
    return frame;
}

void lay_triangle(void *bytes)
{
    static const float corners[3][2] = {{-1, -1}, {3, -1}, {-1, 3}};
    struct dt_vertex *vertices = bytes;
    uint32_t *indices = (uint32_t *)((char *)bytes + INDICES);
    memset(bytes, 0, GEOMETRY_BYTES);
    for (uint32_t i = 0; i < 3; i++) {
        vertices[i] =
            (struct dt_vertex){.position = {corners[i][0], corners[i][1], 0}, .normal = {0, 0, 1}};
        indices[i] = i;
    }
}

const uint32_t own_places[] = {[DT_NORMAL] = 0, [DT_UV] = 12, [DT_MATERIAL] = 20};

void lay_out(void *geometry, float normal_x)
{
    const struct dt_vertex *vertices = geometry;
    char *bytes = geometry;
    for (uint32_t i = 0; i < 3; i++) {
        char *rest = bytes + OWN_REST + i * (size_t)OWN_BYTES;
        memcpy(bytes + OWN_POSITIONS + 16 * i, vertices[i].position, 12);
        memcpy(rest, vertices[i].normal, 12);
        memcpy(rest, &normal_x, 4);
        memcpy(rest + 12, vertices[i].uv, 8);
        memcpy(rest + 20, &vertices[i].material, 4);
    }
}

struct dt_panel features_with_numbers(struct dt_program programs[FEATURES_PASSES])
{
    struct dt_panel panel = features_panel;
    memcpy(programs, panel.programs, FEATURES_PASSES * sizeof *programs);
    programs[FEATURES_PASS_KEEP].attributes |= 1 << DT_TRIANGLE;
    panel.programs = programs;
    return panel;
}

const float graded_alone[8] = {1, 1, 1}, nothing[8];
const uint8_t first_color[4] = {10, 200, 30, 255}, second_color[4] = {77, 0, 255, 255},
              black[4] = {0, 0, 0, 255}, white[4] = {255, 255, 255, 255};

struct dt_bytes bytes_of(uint32_t resource, uint32_t mip)
{
    const struct dt_resource *input = &outside_pipeline.resources[resource];
    struct dt_bytes bytes = {0};
    size_t texel = input->kind == DT_BUFFER             ? input->stride
                   : input->format == DT_FORMAT_RGBA16F ? 8
                                                        : 4;
    outside_pipeline.extent(&outside_pipeline, resource, WIDTH, HEIGHT, bytes.extent);
    for (int i = 0; i < 2 && input->kind == DT_IMAGE; i++)
        bytes.extent[i] >>= mip;
    bytes.size = texel * bytes.extent[0] * bytes.extent[1] * bytes.extent[2];
    bytes.data = calloc(1, bytes.size);
    assert_non_null(bytes.data);
    return bytes;
}

void write_grade(write_content *write, const uint8_t color[4])
{
    struct dt_bytes grade = bytes_of(OUTSIDE_RESOURCE_GRADE, 0);
    for (size_t i = 0; i < grade.size; i++)
        grade.data[i] = color[i % 4];
    assert_true(write(OUTSIDE_RESOURCE_GRADE, 0, &grade));
    free(grade.data);
}

void write_inputs(write_content *write, uint32_t imported)
{
    for (uint32_t i = 0; i < OUTSIDE_RESOURCES; i++) {
        const struct dt_resource *input = &outside_pipeline.resources[i];
        for (uint32_t mip = 0; mip < (input->kind == DT_IMAGE ? input->mips : 1); mip++) {
            struct dt_bytes bytes = bytes_of(i, mip);
            if (i == OUTSIDE_RESOURCE_WEIGHTS)
                memcpy(bytes.data, graded_alone, sizeof graded_alone);
            if (!input->input)
                REFUSED(write(i, mip, &bytes), "a host writes inputs only");
            else if (i == imported)
                REFUSED(write(i, mip, &bytes), "it is imported; write the host's own object");
            else if (i != OUTSIDE_RESOURCE_GRADE)
                assert_true(write(i, mip, &bytes));
            free(bytes.data);
        }
    }
}

void hand_in(write_content *write, bool (*reads)(void), const uint8_t color[4])
{
    write_inputs(write, OUTSIDE_RESOURCES);
    REFUSED(reads(), "mip 0 of the input grade has no content; write it after resize");
    struct dt_bytes wrong = bytes_of(OUTSIDE_RESOURCE_WEIGHTS, 0);
    wrong.size -= 4;
    REFUSED(write(OUTSIDE_RESOURCE_WEIGHTS, 0, &wrong), "write weights: 28 bytes of 2x1x1 given");
    REFUSED(write(OUTSIDE_RESOURCE_SOFT, 3, &wrong), "write soft: mip 3, and it has 3");
    free(wrong.data);
    write_grade(write, color);
}

void write_for_blurred(write_content *write)
{
    const float blurred_alone[8] = {0, 0, 0, 0, 1, 1, 1};
    struct dt_bytes weights = bytes_of(OUTSIDE_RESOURCE_WEIGHTS, 0);
    struct dt_bytes soft = bytes_of(OUTSIDE_RESOURCE_SOFT, 2);
    write_inputs(write, OUTSIDE_RESOURCES);
    write_grade(write, (const uint8_t[]){0, 0, 0, 0});
    for (size_t i = 1; i < soft.size; i += 2)
        soft.data[i] = 0x3c; /* 0x3c00: 1 */
    memcpy(weights.data, blurred_alone, sizeof blurred_alone);
    assert_true(write(OUTSIDE_RESOURCE_WEIGHTS, 0, &weights) &&
                write(OUTSIDE_RESOURCE_SOFT, 2, &soft));
    free(weights.data);
    free(soft.data);
}

void is_painted(const uint8_t *texels, const uint8_t color[4])
{
    for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
        if (texels[i] != color[i % 4])
            fail_msg("texel %d.%d is %d, not %d", i / 4, i % 4, texels[i], color[i % 4]);
}

void is_last_fog(const uint16_t texel[4])
{
    const uint16_t wanted[4] = {0x3b00, 0x3aaa, 0x3a66, 0};
    for (int i = 0; i < 4; i++)
        assert_in_range(texel[i] + 1, wanted[i], wanted[i] + 2);
}
