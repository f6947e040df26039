/* Uploads a scene: vertices, indices and materials as buffers, textures as one sRGB array with its
 * mips. */
#include "internal.h"

static bool upload_textures(struct dt_gl_runtime *rt, const struct dt_scene *scene)
{
    struct gl_image *image = &rt->builtin.textures;
    const uint8_t *texels = scene->texels;
    *image = (struct gl_image){.name = "scene textures",
                               .format = DT_FORMAT_RGBA8_SRGB,
                               .width = scene->texture_width,
                               .height = scene->texture_height,
                               .layers = scene->texture_layers,
                               .mips = scene->texture_mips,
                               .layered = true};
    bool good = gl_image_create(rt, image);
    for (uint32_t mip = 0; good && mip < image->mips; mip++) {
        good = gl_image_write(rt, image, mip, 0, image->layers, texels);
        texels += (size_t)gl_mip_size(image->width, mip) * (size_t)gl_mip_size(image->height, mip) *
                  image->layers * 4;
    }
    return good;
}

/* Every attribute has a binding of its own. */
bool gl_scene_describe(struct dt_gl_runtime *rt, const struct dt_gl_attribute given[DT_ATTRIBUTES])
{
    static const GLint components[DT_ATTRIBUTES] = {3, 3, 2, 1, 1};
    const struct gl_buffer *vertices = gl_buffer_of(rt, DT_SCENE_VERTICES);
    rt->core.has_vertices = vertices->handle;
    rt->core.attributes = 0;
    if (!GL(rt, "scene vertices", CreateVertexArrays(1, &rt->scene_input)))
        return false;
    GLuint input = rt->scene_input;
    for (GLuint i = 0; i < DT_ATTRIBUTES; i++) {
        const struct dt_gl_attribute own = {vertices->handle,
                                            (uint64_t)vertices->offset + dt_attributes[i].offset,
                                            sizeof(struct dt_vertex)};
        const struct dt_gl_attribute *from = given[i].buffer ? &given[i] : &own;
        if (!from->buffer)
            continue;
        if (!dt_front_attribute(&rt->core, (int)i, from->offset, from->stride))
            return false;
        if (i < DT_MATERIAL)
            rt->gl.VertexArrayAttribFormat(input, i, components[i], GL_FLOAT, GL_FALSE, 0);
        else
            rt->gl.VertexArrayAttribIFormat(input, i, components[i], GL_UNSIGNED_INT, 0);
        rt->gl.VertexArrayAttribBinding(input, i, i);
        rt->gl.EnableVertexArrayAttrib(input, i);
        if (!GL(rt, dt_attributes[i].name,
                VertexArrayVertexBuffer(input, i, from->buffer, (GLintptr)from->offset,
                                        (GLsizei)from->stride)))
            return false;
    }
    return true;
}

bool gl_scene_upload(struct dt_core *core, const struct dt_scene *scene,
                     const struct dt_scene_buffer buffers[DT_SCENE_BUFFERS])
{
    struct dt_gl_runtime *rt = gl_runtime_of(core);
    bool good = true;
    gl_scene_destroy(rt);
    for (int i = 0; good && i < DT_SCENE_BUFFERS; i++) {
        struct gl_buffer *buffer = gl_buffer_of(rt, buffers[i].resource);
        *buffer = (struct gl_buffer){.name = buffers[i].name, .size = (GLsizeiptr)buffers[i].size};
        good = gl_buffer_create(rt, buffer, NULL) &&
               gl_buffer_write(rt, buffer, buffers[i].data, buffers[i].data_size);
    }
    return good && upload_textures(rt, scene) &&
           gl_scene_describe(rt, (const struct dt_gl_attribute[DT_ATTRIBUTES]){0});
}

void gl_scene_destroy(struct dt_gl_runtime *rt)
{
    rt->core.has_scene = rt->core.has_objects = false;
    for (uint32_t i = DT_SCENE_VERTICES; i < DT_SCENE_TEXTURES; i++)
        gl_buffer_destroy(rt, gl_buffer_of(rt, i));
    gl_image_destroy(rt, &rt->builtin.textures);
    if (rt->scene_input)
        rt->gl.DeleteVertexArrays(1, &rt->scene_input);
    rt->scene_input = 0;
}
