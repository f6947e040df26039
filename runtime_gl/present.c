/* Shows pictures and an overlay in the window of context "window". Textures are filled from the
 * pipeline's images or from memory, and drawn as triangles. Vertices count y from the top; nothing
 * else flips pictures. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* Vertices come from a storage buffer, already in clip space. */
static const char vertex_text[] =
    "#version 450 core\n"
    "struct Vertex { float x, y, u, v; uint color; };\n"
    "layout(std430, binding = 0) readonly buffer Vertices { Vertex vertices[]; };\n"
    "layout(location = 0) out vec2 uv;\n"
    "layout(location = 1) out vec4 color;\n"
    "out gl_PerVertex { vec4 gl_Position; };\n"
    "void main()\n"
    "{\n"
    "    Vertex v = vertices[gl_VertexID];\n"
    "    uv = vec2(v.u, v.v);\n"
    "    color = unpackUnorm4x8(v.color);\n"
    "    gl_Position = vec4(v.x, v.y, 0.0, 1.0);\n"
    "}\n";

static const char fragment_text[] = "#version 450 core\n"
                                    "layout(binding = 0) uniform sampler2D picture;\n"
                                    "layout(location = 0) in vec2 uv;\n"
                                    "layout(location = 1) in vec4 color;\n"
                                    "layout(location = 0) out vec4 shown;\n"
                                    "void main() { shown = color * texture(picture, uv); }\n";

/* ---- Textures -------------------------------------------------------------------------------- */

/* The texture, resized if needed; a resize loses the content. */
static struct gl_image *sized_texture(struct dt_gl_runtime *rt, uint32_t texture, uint32_t width,
                                      uint32_t height)
{
    static const char *const names[DT_WINDOW_TEXTURES] = {"overlay", "picture 1", "picture 2",
                                                          "picture 3"};
    struct gl_image *image = &rt->present.textures[texture];
    if (image->handle && image->width == width && image->height == height)
        return image;
    gl_image_destroy(rt, image);
    *image = (struct gl_image){.name = names[texture],
                               .format = DT_FORMAT_RGBA8,
                               .width = width,
                               .height = height,
                               .layers = 1,
                               .mips = 1};
    return gl_image_create(rt, image) ? image : NULL;
}

bool gl_window_copy(struct dt_core *core, uint32_t texture, uint32_t resource)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)core;
    const struct gl_image *image = gl_image_of(rt, resource);
    const struct gl_image *to = sized_texture(rt, texture, image->width, image->height);
    return to && GL(rt, image->name, MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT)) &&
           GL(rt, image->name,
              CopyImageSubData(image->handle, gl_target(image), 0, 0, 0, 0, to->handle,
                               gl_target(to), 0, 0, 0, 0, (GLsizei)to->width, (GLsizei)to->height,
                               1));
}

bool gl_window_upload(struct dt_core *core, uint32_t texture, uint32_t width, uint32_t height,
                      const uint8_t *pixels)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)core;
    const struct gl_image *to = sized_texture(rt, texture, width, height);
    return to && GL(rt, to->name,
                    TextureSubImage2D(to->handle, 0, 0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA,
                                      GL_UNSIGNED_BYTE, pixels));
}

/* ---- Drawing --------------------------------------------------------------------------------- */

static bool present_prepare(struct dt_gl_runtime *rt)
{
    struct gl_present *present = &rt->present;
    static const struct dt_stages stages = {.vertex = {.glsl = vertex_text},
                                            .fragment = {.glsl = fragment_text}};
    static const struct dt_sampler filtered = {
        .name = "window overlay", .linear = true, .anisotropy = 1.0f};
    static const struct dt_sampler plain = {.name = "window picture", .anisotropy = 1.0f};
    if (present->program)
        return true;
    gl_context_wait_for_screen();
    return gl_sampler_create(rt, &present->samplers[0], &filtered) &&
           gl_sampler_create(rt, &present->samplers[1], &plain) &&
           gl_program_create(rt, &present->program, "window", &stages);
}

/* Converts pixels, y from the top, to clip space, where y = -1 is the window's bottom row. */
static bool upload_vertices(struct dt_gl_runtime *rt, const struct dt_window_frame *frame,
                            int width, int height)
{
    size_t size = frame->vertex_count * sizeof *frame->vertices;
    struct dt_window_vertex *vertices = malloc(size + 1);
    if (!vertices)
        return dt_error(&rt->core, "window: out of memory for %u vertices; free some",
                        frame->vertex_count);
    for (uint32_t i = 0; i < frame->vertex_count; i++) {
        vertices[i] = frame->vertices[i];
        vertices[i].position[0] = vertices[i].position[0] * 2 / (float)width - 1;
        vertices[i].position[1] = 1 - vertices[i].position[1] * 2 / (float)height;
    }
    struct gl_buffer *buffer = &rt->present.vertices;
    bool fits = buffer->handle && buffer->size >= (GLsizeiptr)size;
    if (!fits) {
        gl_buffer_destroy(rt, buffer);
        *buffer =
            (struct gl_buffer){.name = "window vertices", .size = (GLsizeiptr)(size + size / 2)};
    }
    bool good =
        (fits || gl_buffer_create(rt, buffer, NULL)) && gl_buffer_write(rt, buffer, vertices, size);
    free(vertices);
    return good;
}

/* Shows sRGB codes unchanged: GL_FRAMEBUFFER_SRGB is off. */
static void begin(struct dt_gl_runtime *rt, int width, int height)
{
    static const float black[4] = {0, 0, 0, 1};
    rt->gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    rt->gl.Viewport(0, 0, width, height);
    rt->gl.Disable(GL_FRAMEBUFFER_SRGB);
    rt->gl.Disable(GL_DEPTH_TEST);
    rt->gl.Disable(GL_CULL_FACE);
    rt->gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    rt->gl.ClearBufferfv(GL_COLOR, 0, black);
    rt->gl.Enable(GL_SCISSOR_TEST);
    rt->gl.Enable(GL_BLEND);
    rt->gl.BlendEquation(GL_FUNC_ADD);
    rt->gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    rt->gl.UseProgram(rt->present.program);
    rt->gl.BindVertexArray(rt->no_input);
    rt->gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, rt->present.vertices.handle);
}

static void end(struct dt_gl_runtime *rt)
{
    rt->gl.Disable(GL_BLEND);
    rt->gl.Disable(GL_SCISSOR_TEST);
    rt->gl.Enable(GL_FRAMEBUFFER_SRGB);
}

static void draw_list(struct dt_gl_runtime *rt, const struct dt_window_draw *draw, int height)
{
    const int32_t *clip = draw->clip;
    const struct gl_image *image = &rt->present.textures[draw->texture];
    if (!image->handle || clip[2] <= clip[0] || clip[3] <= clip[1])
        return;
    rt->gl.Scissor(clip[0], height - clip[3], clip[2] - clip[0], clip[3] - clip[1]);
    rt->gl.BindTextureUnit(0, image->handle);
    rt->gl.BindSampler(0, rt->present.samplers[draw->texture != 0]);
    rt->gl.DrawArrays(GL_TRIANGLES, (GLint)draw->first, (GLsizei)draw->count);
}

/* OpenGL's row 0 is the bottom. */
static bool photograph(struct dt_gl_runtime *rt, struct dt_bytes *photo, int width, int height)
{
    size_t row = (size_t)width * 4;
    photo->size = row * (size_t)height;
    photo->data = malloc(photo->size);
    if (!photo->data)
        return dt_error(&rt->core, "window: no memory for a photograph of %zu bytes; free some",
                        photo->size);
    memcpy(photo->extent, (uint32_t[3]){(uint32_t)width, (uint32_t)height, 1},
           sizeof photo->extent);
    rt->gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    for (int y = 0; y < height; y++)
        rt->gl.ReadPixels(0, height - 1 - y, width, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                          photo->data + row * (size_t)y);
    return gl_check(rt, "ReadPixels", "window");
}

bool gl_present(struct dt_core *core, const struct dt_window_frame *frame)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)core;
    int width, height;
    gl_context_window_size(rt, &width, &height);
    if (width < 1 || height < 1)
        return true;
    if (!present_prepare(rt) || !upload_vertices(rt, frame, width, height))
        return false;
    begin(rt, width, height);
    for (uint32_t i = 0; i < frame->draw_count; i++)
        draw_list(rt, &frame->draws[i], height);
    end(rt);
    if (!gl_check(rt, "DrawArrays", "window") ||
        (frame->photo && !photograph(rt, frame->photo, width, height)))
        return false;
    gl_context_swap(rt);
    return gl_finish(rt, "window");
}

void gl_present_destroy(struct dt_gl_runtime *rt)
{
    struct gl_present *present = &rt->present;
    for (int i = 0; i < DT_WINDOW_TEXTURES; i++)
        gl_image_destroy(rt, &present->textures[i]);
    gl_buffer_destroy(rt, &present->vertices);
    for (int i = 0; i < 2; i++)
        gl_sampler_destroy(rt, &present->samplers[i]);
    gl_program_destroy(rt, &present->program);
}
