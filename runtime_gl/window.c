/* The window of `diptych view`: see window.h. Its runtime has a context "window" and no pipeline. */
#include "internal.h"

#include <GLFW/glfw3.h>
#include <stdlib.h>
#include <string.h>

#include "runtime_gl/window.h"

struct gl_window {
    struct dt_gl_runtime *rt;
    struct gl_image pictures[WINDOW_PICTURES];
};

struct gl_window *gl_window_open(struct dt_log log, bool debug)
{
    const struct dt_runtime_options options = {.log = log, .context = "window", .debug = debug};
    struct gl_window *window = calloc(1, sizeof *window);
    if (!window)
        dt_error(&(struct dt_core){.log = log}, "out of memory for a window; free some");
    else if ((window->rt = runtime_gl.open(&options))) {
        window->rt->gl.Disable(GL_FRAMEBUFFER_SRGB); /* shows codes unchanged */
        glfwSwapInterval(1);                         /* waits for the screen */
        return window;
    }
    gl_window_close(window);
    return NULL;
}

void gl_window_close(struct gl_window *window)
{
    if (!window)
        return;
    for (int i = 0; window->rt && i < WINDOW_PICTURES; i++)
        if (gl_context_current(window->rt))
            gl_image_destroy(window->rt, &window->pictures[i]);
    runtime_gl.close(window->rt);
    free(window);
}

void *gl_window_handle(const struct gl_window *window)
{
    return window->rt->context.window;
}

/* Another size loses the content. */
static bool make_texture(struct dt_gl_runtime *rt, struct gl_image *image, uint32_t width,
                         uint32_t height)
{
    if (image->handle && image->width == width && image->height == height)
        return true;
    gl_image_destroy(rt, image);
    *image = (struct gl_image){.name = "picture",
                               .format = DT_FORMAT_RGBA8,
                               .width = width,
                               .height = height,
                               .layers = 1,
                               .mips = 1};
    return gl_image_create(rt, image) &&
           GL(rt, image->name,
              TextureParameteri(image->handle, GL_TEXTURE_MAG_FILTER, GL_NEAREST)) &&
           GL(rt, image->name,
              TextureParameteri(image->handle, GL_TEXTURE_MIN_FILTER, GL_NEAREST)) &&
           GL(rt, image->name,
              TextureParameteri(image->handle, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE)) &&
           GL(rt, image->name,
              TextureParameteri(image->handle, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE));
}

bool gl_window_upload(struct gl_window *window, uint32_t picture, uint32_t width, uint32_t height,
                      const uint8_t *pixels)
{
    struct dt_gl_runtime *rt = window->rt;
    struct gl_image *image = &window->pictures[picture];
    return gl_context_current(rt) && make_texture(rt, image, width, height) &&
           GL(rt, image->name,
              TextureSubImage2D(image->handle, 0, 0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA,
                                GL_UNSIGNED_BYTE, pixels));
}

unsigned gl_window_texture(const struct gl_window *window, uint32_t picture)
{
    return window->pictures[picture].handle;
}

bool gl_window_begin(struct gl_window *window)
{
    static const float black[4] = {0, 0, 0, 1};
    struct dt_gl_runtime *rt = window->rt;
    return gl_context_current(rt) && GL(rt, "window", ClearBufferfv(GL_COLOR, 0, black));
}

/* OpenGL's row 0 is the bottom. */
static bool photograph(struct dt_gl_runtime *rt, struct dt_bytes *photo)
{
    int width, height;
    glfwGetFramebufferSize(rt->context.window, &width, &height);
    if (width < 1 || height < 1)
        return true;
    size_t row = (size_t)width * 4;
    photo->size = row * (size_t)height;
    photo->data = malloc(photo->size);
    if (!photo->data)
        return dt_error(&rt->core, "window: no memory for a photograph of %zu bytes; free some",
                        photo->size);
    memcpy(photo->extent, (uint32_t[3]){(uint32_t)width, (uint32_t)height, 1},
           sizeof photo->extent);
    for (int y = 0; y < height; y++)
        rt->gl.ReadPixels(0, height - 1 - y, width, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                          photo->data + row * (size_t)y);
    return gl_check(rt, "ReadPixels", "window");
}

bool gl_window_end(struct gl_window *window, struct dt_bytes *photo)
{
    struct dt_gl_runtime *rt = window->rt;
    if (!gl_check(rt, "DrawElements", "window") || (photo && !photograph(rt, photo)))
        return false;
    glfwSwapBuffers(rt->context.window);
    return gl_finish(rt, "window");
}

bool gl_window_is_lost(const struct gl_window *window)
{
    return window->rt->core.device.lost;
}

uint32_t gl_window_messages(const struct gl_window *window)
{
    return window->rt->core.device.messages;
}
