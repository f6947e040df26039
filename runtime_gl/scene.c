/* Uploads a scene: vertices, indices and materials as buffers that shaders read and draws use,
 * textures as one sRGB array with its given mips. Called by runtime.c. */
#include "internal.h"

static bool upload_buffers(struct gl_runtime *rt, const struct dt_scene *scene)
{
    struct gl_builtin *b = &rt->builtin;
    const struct gl_buffer_info vertices = {.name = "scene vertices",
                                            .size = (GLsizeiptr)sizeof *scene->vertices *
                                                    scene->vertex_count};
    const struct gl_buffer_info indices = {
        .name = "scene indices", .size = (GLsizeiptr)sizeof *scene->indices * scene->index_count};
    const struct gl_buffer_info materials = {
        .name = "scene materials", .size = (GLsizeiptr)sizeof *scene->materials * DT_MAX_MATERIALS};
    if (scene->material_count > DT_MAX_MATERIALS) {
        gl_log(rt, DT_ERROR, "the scene has %u materials, and shaders see %d: merge some",
               scene->material_count, DT_MAX_MATERIALS);
        return false;
    }
    return gl_buffer_upload(rt, &b->vertices, &vertices, scene->vertices) &&
           gl_buffer_upload(rt, &b->indices, &indices, scene->indices) &&
           dt_gl_buffer_create(rt, &b->materials, &materials) &&
           gl_buffer_write(rt, &b->materials, scene->materials,
                           scene->material_count * sizeof *scene->materials);
}

static bool upload_textures(struct gl_runtime *rt, const struct dt_scene *scene)
{
    struct gl_image *image = &rt->builtin.textures;
    const struct gl_image_info info = {
        .name = "scene textures",
        .format = DT_FORMAT_RGBA8_SRGB,
        .width = scene->texture_width,
        .height = scene->texture_height,
        .layers = scene->texture_layers,
        .mips = scene->texture_mips,
        .layered = true,
    };
    if (!dt_gl_image_create(rt, image, &info))
        return false;
    const uint8_t *texels = scene->texels;
    uint32_t width = info.width, height = info.height;
    for (uint32_t mip = 0; mip < info.mips; mip++) {
        if (!GL(rt, info.name,
                TextureSubImage3D(image->handle, (GLint)mip, 0, 0, 0, (GLsizei)width,
                                  (GLsizei)height, (GLsizei)info.layers, GL_RGBA, GL_UNSIGNED_BYTE,
                                  texels)))
            return false;
        texels += (size_t)width * height * info.layers * 4;
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
    }
    return true;
}

bool gl_scene_describe(struct gl_runtime *rt)
{
    const char *name = "scene vertices";
    if (!GL(rt, name, CreateVertexArrays(1, &rt->scene_input)))
        return false;
    GLuint input = rt->scene_input;
    const GLint components[] = {3, 3, 2};
    const GLuint offsets[] = {offsetof(struct dt_vertex, position),
                              offsetof(struct dt_vertex, normal), offsetof(struct dt_vertex, uv)};
    for (GLuint i = 0; i < DT_ARRAY_COUNT(components); i++)
        rt->gl.VertexArrayAttribFormat(input, i, components[i], GL_FLOAT, GL_FALSE, offsets[i]);
    rt->gl.VertexArrayAttribIFormat(input, 3, 1, GL_UNSIGNED_INT,
                                    offsetof(struct dt_vertex, material));
    for (GLuint i = 0; i < 4; i++) {
        rt->gl.VertexArrayAttribBinding(input, i, 0);
        rt->gl.EnableVertexArrayAttrib(input, i);
    }
    return GL(rt, name,
              VertexArrayVertexBuffer(input, 0, rt->builtin.vertices.handle,
                                      rt->builtin.vertices.offset, sizeof(struct dt_vertex)));
}

bool gl_scene_upload(struct gl_runtime *rt, const struct dt_scene *scene)
{
    gl_scene_destroy(rt);
    rt->index_count = scene->index_count;
    return upload_buffers(rt, scene) && upload_textures(rt, scene) && gl_scene_describe(rt);
}

void gl_scene_destroy(struct gl_runtime *rt)
{
    dt_gl_buffer_destroy(rt, &rt->builtin.vertices);
    dt_gl_buffer_destroy(rt, &rt->builtin.indices);
    dt_gl_buffer_destroy(rt, &rt->builtin.materials);
    dt_gl_image_destroy(rt, &rt->builtin.textures);
    if (rt->scene_input)
        rt->gl.DeleteVertexArrays(1, &rt->scene_input);
    rt->scene_input = 0;
}
