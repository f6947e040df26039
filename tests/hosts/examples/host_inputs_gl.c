/* An OpenGL renderer that draws its own G-buffer and has it lit by lit.yaml: textures that it imports,
 * lamps that it writes, a gain that is new in each frame. Between the two passes it draws into a resource
 * of the pipeline. Two views share programs: of SPIR-V while the state of the context stays as it was,
 * then of GLSL text while the state may change. Checks each pixel of each frame. Built against an
 * installed diptych by tests/hosts/install_test.sh. */
#include <math.h>
#include <stdio.h>

#include <EGL/egl.h>
#include <diptych_gl.h>

#include "gbuffer.h"
#include "renderer_gl.h"

enum { WIDTH = COLUMNS * TILE, HEIGHT = ROWS * TILE, VIEWS = 2, FRAMES = 2 };

static const GLenum formats[TARGETS] = {GL_RGBA32F, GL_RGBA16F, GL_RGBA8};
static const uint32_t inputs[TARGETS] = {LIT_RESOURCE_GBUFFER_POSITION, LIT_RESOURCE_GBUFFER_NORMAL,
                                         LIT_RESOURCE_GBUFFER_ALBEDO};

struct view {
    struct dt_gl_runtime *rt;
    GLuint gbuffer[TARGETS];
};

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level >= DT_WARNING)
        fprintf(stderr, "diptych: %s\n", message);
}

static void draw_tile(GLuint texture, uint32_t column, uint32_t row, const float color[4])
{
    glClearTexSubImage(texture, 0, (GLint)(column * TILE), (GLint)(row * TILE), 0, TILE, TILE, 1,
                       GL_RGBA, GL_FLOAT, color);
}

static void draw_gbuffer(const struct view *view, uint32_t moment)
{
    for (uint32_t i = 0; i < TARGETS * ROWS * COLUMNS; i++) {
        const uint32_t column = i / TARGETS % COLUMNS, row = i / TARGETS / COLUMNS;
        const struct tile tile = tile_at(moment, column, row);
        draw_tile(view->gbuffer[i % TARGETS], column, row, tile.targets[i % TARGETS]);
    }
}

/* Into the irradiance, which the pass before wrote and the pass after reads. */
static void draw_marks(struct dt_gl_runtime *rt)
{
    struct dt_gl_resource irradiance, lamps;
    check(dt_gl_get_resource(rt, LIT_RESOURCE_IRRADIANCE, &irradiance) &&
              irradiance.target == GL_TEXTURE_2D && irradiance.format == GL_R32F &&
              irradiance.width == WIDTH && irradiance.height == HEIGHT && irradiance.layers == 1 &&
              irradiance.mips == 1 && !irradiance.buffer,
          "taking the irradiance");
    check(dt_gl_get_resource(rt, LIT_RESOURCE_LAMPS, &lamps) && lamps.buffer && lamps.offset == 0 &&
              lamps.size == LAMPS * sizeof(struct lit_Lamp) &&
              lamps.stride == sizeof(struct lit_Lamp) && !lamps.texture,
          "taking the lamps");
    for (uint32_t column = 1; column <= MARKS; column++)
        draw_tile(irradiance.texture, column, MARKED_ROW, mark);
}

static struct view open_view(const struct dt_gl_host *host)
{
    struct view view = {.rt = dt_gl_open(host)};
    check(view.rt && dt_gl_create(view.rt, &lit_gl), "opening a view");
    for (uint32_t i = 0; i < TARGETS; i++) {
        view.gbuffer[i] = make_texture(formats[i], WIDTH, HEIGHT);
        check(dt_gl_import_image(view.rt, inputs[i], view.gbuffer[i]), "importing a target");
    }
    check(dt_gl_resize(view.rt, WIDTH, HEIGHT), "making a view's resources");
    return view;
}

static void check_picture(struct dt_gl_runtime *rt, uint32_t moment)
{
    static uint8_t pixels[WIDTH * HEIGHT * 4];
    struct dt_gl_resource shown;
    check(dt_gl_get_resource(rt, LIT_RESOURCE_SHOWN, &shown), "taking the picture");
    glGetTextureImage(shown.texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, sizeof pixels, pixels);
    check(is_lit(pixels, moment), "lighting");
}

static void check_timings(struct dt_gl_runtime *rt, uint32_t age)
{
    double ms[LIT_PASSES] = {NAN, NAN};
    check(dt_gl_timings(rt, age, ms), "times");
    for (uint32_t i = 0; i < LIT_PASSES; i++)
        check(ms[i] >= 0, "timing a pass");
}

static void run_frame(const struct view *view, uint32_t index, uint32_t moment)
{
    struct lit_Lamp lamps[LAMPS] = {lamp_at(moment, 0), lamp_at(moment, 1)};
    const struct dt_bytes bytes = {(uint8_t *)lamps, sizeof lamps, {LAMPS, 1, 1}};
    const struct lit_live live = {.gain = gain_at(moment)};
    const struct dt_frame frame = {.index = index};
    if (index == 0 || moment % 2 == 0)
        check(dt_gl_write(view->rt, LIT_RESOURCE_LAMPS, 0, &bytes), "writing the lamps");
    draw_gbuffer(view, moment);
    check(dt_gl_record_passes(view->rt, &frame, &live, 0, LIT_PASS_SHADE), "a frame");
    draw_marks(view->rt);
    check(dt_gl_record_passes(view->rt, NULL, NULL, LIT_PASS_SHADE, LIT_PASSES),
          "the rest of a frame");
    check_picture(view->rt, moment);
    if (index > 0)
        check_timings(view->rt, 1);
}

/* The second view is a moment ahead. */
static void run(const struct dt_gl_host *host)
{
    struct view views[VIEWS];
    for (uint32_t i = 0; i < VIEWS; i++)
        views[i] = open_view(host);
    for (uint32_t index = 0; index < MOMENTS; index++)
        for (uint32_t i = 0; i < VIEWS; i++) {
            run_frame(&views[i], index, index + i);
            if (!host->leave_state)
                check_state("a frame");
        }
    for (uint32_t i = 0; i < VIEWS; i++) {
        dt_gl_close(views[i].rt);
        glDeleteTextures(TARGETS, views[i].gbuffer);
    }
}

int main(void)
{
    struct dt_gl_host host = {.log = {.message = on_log},
                              .get_proc_address = eglGetProcAddress,
                              .timing = true,
                              .frames = FRAMES};
    renderer_open();
    make_disorder();
    run(&host);
    host.glsl = host.leave_state = true;
    run(&host);
    check(glGetError() == GL_NO_ERROR, "OpenGL");
    return renderer_is_silent() ? 0 : 1;
}
