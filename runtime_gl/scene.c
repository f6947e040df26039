/* Uploads a scene: vertices, indices and materials as buffers, textures as one sRGB array with its
 * mips. */
#include "internal.h"

static bool upload_buffers(struct dt_gl_runtime *rt, const struct dt_scene *scene)
{
    struct gl_builtin *b = &rt->builtin;
    b->vertices =
        (struct gl_buffer){.name = "scene vertices",
                           .size = (GLsizeiptr)sizeof *scene->vertices * scene->vertex_count};
    b->indices = (struct gl_buffer){
        .name = "scene indices", .size = (GLsizeiptr)sizeof *scene->indices * scene->index_count};
    b->materials = (struct gl_buffer){
        .name = "scene materials", .size = (GLsizeiptr)sizeof *scene->materials * DT_MAX_MATERIALS};
    b->objects = (struct gl_buffer){.name = "scene objects",
                                    .size = (GLsizeiptr)sizeof *scene->objects *
                                            (scene->object_count ? scene->object_count : 1)};
    return gl_buffer_create(rt, &b->vertices, scene->vertices) &&
           gl_buffer_create(rt, &b->indices, scene->indices) &&
           gl_buffer_create(rt, &b->materials, NULL) &&
           gl_buffer_write(rt, &b->materials, scene->materials,
                           scene->material_count * sizeof *scene->materials) &&
           gl_buffer_create(rt, &b->objects, scene->object_count ? scene->objects : NULL);
}

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
    if (!gl_image_create(rt, image))
        return false;
    for (uint32_t mip = 0; mip < image->mips; mip++) {
        GLsizei width = gl_mip_size(image->width, mip), height = gl_mip_size(image->height, mip);
        if (!GL(rt, image->name,
                TextureSubImage3D(image->handle, (GLint)mip, 0, 0, 0, width, height,
                                  (GLsizei)image->layers, GL_RGBA, GL_UNSIGNED_BYTE, texels)))
            return false;
        texels += (size_t)width * (size_t)height * image->layers * 4;
    }
    return true;
}

/* Every attribute has a binding of its own. */
bool gl_scene_describe(struct dt_gl_runtime *rt, const struct dt_gl_attribute given[DT_ATTRIBUTES])
{
    static const GLint components[DT_ATTRIBUTES] = {3, 3, 2, 1, 1};
    const struct gl_buffer *vertices = &rt->builtin.vertices;
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

bool gl_scene_upload(struct dt_core *core, const struct dt_scene *scene)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)core;
    gl_scene_destroy(rt);
    rt->index_count = scene->index_count;
    core->has_scene = upload_buffers(rt, scene) && upload_textures(rt, scene) &&
                      gl_scene_describe(rt, (const struct dt_gl_attribute[DT_ATTRIBUTES]){0});
    core->has_objects = core->has_scene;
    return core->has_scene;
}

void gl_scene_destroy(struct dt_gl_runtime *rt)
{
    rt->core.has_scene = rt->core.has_objects = false;
    gl_buffer_destroy(rt, &rt->builtin.vertices);
    gl_buffer_destroy(rt, &rt->builtin.indices);
    gl_buffer_destroy(rt, &rt->builtin.materials);
    gl_buffer_destroy(rt, &rt->builtin.objects);
    gl_image_destroy(rt, &rt->builtin.textures);
    if (rt->scene_input)
        rt->gl.DeleteVertexArrays(1, &rt->scene_input);
    rt->scene_input = 0;
}
