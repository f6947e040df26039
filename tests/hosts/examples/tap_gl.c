/* A small OpenGL engine of three passes with diptych_tap.h in it: upload, downsample, present. `tap_gl
 * FOLDER` leaves a dump. It has OpenGL's row 0 at the bottom. Built and run by tests/hosts/tap_test.sh. */
#include "renderer_gl.h"

#include "diptych_tap_gl.h"

#include "tap_picture.h"

static GLuint framebuffer_of(GLuint texture)
{
    GLuint framebuffer;
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
    return framebuffer;
}

static void blit(GLuint from, GLuint to, int width, int height, int to_width, int to_height)
{
    glBlitNamedFramebuffer(framebuffer_of(from), framebuffer_of(to), 0, 0, width, height, 0, 0,
                           to_width, to_height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

static void upload(GLuint texture)
{
    static unsigned char texels[HEIGHT][WIDTH][4];
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            paint(texels[HEIGHT - 1 - y][x], x, y);
    glTextureSubImage2D(texture, 0, 0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, texels);
}

int main(int argc, char **argv)
{
    static const struct tap_field fields[] = {
        {"position", "vec3", 0, 0, 0}, {"exposure", "float", 12, 0, 0}, {"id", "uint", 16, 0, 0}};
    struct camera cameras[CAMERAS];
    check(argc == 2, "usage: tap_gl FOLDER:");
    renderer_open();
    struct tap *tap = tap_open(argv[1], "gl", (const char *)glGetString(GL_RENDERER));
    place(cameras);

    GLuint albedo = make_texture(GL_RGBA8, WIDTH, HEIGHT);
    GLuint exposures = make_buffer(cameras, sizeof cameras);
    upload(albedo);
    tap_gl_texture(tap, "upload", "albedo", GL_TEXTURE_2D, albedo, 0);
    tap_gl_buffer(tap, "upload", "cameras", exposures, 0, CAMERAS, sizeof *cameras, fields, 3);

    GLuint small = make_texture(GL_RGBA16F, WIDTH / SMALL, HEIGHT / SMALL);
    blit(albedo, small, WIDTH, HEIGHT, WIDTH / SMALL, HEIGHT / SMALL);
    tap_gl_texture(tap, "downsample", "small", GL_TEXTURE_2D, small, 0);

    GLuint screen = make_texture(GL_RGBA8, WIDTH, HEIGHT);
    blit(small, screen, WIDTH / SMALL, HEIGHT / SMALL, WIDTH, HEIGHT);
    tap_gl_framebuffer(tap, "present", "screen", framebuffer_of(screen), GL_COLOR_ATTACHMENT0,
                       GL_RGBA8, WIDTH, HEIGHT);
    check(tap && tap_close(tap), argv[1]);
    check(glGetError() == GL_NO_ERROR && renderer_is_silent(), "OpenGL");
    return 0;
}
