/* Uploads a scene: vertices, indices and materials as buffers that shaders read and draws use,
 * textures as one sRGB array with its given mips. Called by the front for the app; host.c has its
 * scenes described here. */
#include "internal.h"

static bool check_buffer(const struct dt_core *core, const char *name, uint64_t bytes)
{
    uint64_t most = core->limits.storage_bytes;
    return bytes <= most ||
           dt_error(core, "%s: %llu bytes, but %s binds at most %llu; use a smaller scene", name,
                    (unsigned long long)bytes, core->device_name, (unsigned long long)most);
}

static bool check_scene(const struct dt_core *core, const struct dt_scene *scene)
{
    uint32_t side = core->limits.image_size, layers = core->limits.image_layers;
    if (scene->material_count > DT_MAX_MATERIALS)
        return dt_error(core, "the scene has %u materials, but shaders see %d; merge some",
                        scene->material_count, DT_MAX_MATERIALS);
    if (scene->texture_width > side || scene->texture_height > side ||
        scene->texture_layers > layers)
        return dt_error(core,
                        "scene textures: %u of %ux%u texels, but %s allows %u of %ux%u; use fewer "
                        "or smaller ones",
                        scene->texture_layers, scene->texture_width, scene->texture_height,
                        core->device_name, layers, side, side);
    return check_buffer(core, "scene vertices",
                        (uint64_t)scene->vertex_count * sizeof *scene->vertices) &&
           check_buffer(core, "scene indices",
                        (uint64_t)scene->index_count * sizeof *scene->indices);
}

static bool upload_buffers(struct gl_runtime *rt, const struct dt_scene *scene)
{
    struct gl_builtin *b = &rt->builtin;
    b->vertices =
        (struct gl_buffer){.name = "scene vertices",
                           .size = (GLsizeiptr)sizeof *scene->vertices * scene->vertex_count};
    b->indices = (struct gl_buffer){
        .name = "scene indices", .size = (GLsizeiptr)sizeof *scene->indices * scene->index_count};
    b->materials = (struct gl_buffer){
        .name = "scene materials", .size = (GLsizeiptr)sizeof *scene->materials * DT_MAX_MATERIALS};
    return gl_buffer_create(rt, &b->vertices, scene->vertices) &&
           gl_buffer_create(rt, &b->indices, scene->indices) &&
           gl_buffer_create(rt, &b->materials, NULL) &&
           gl_buffer_write(rt, &b->materials, scene->materials,
                           scene->material_count * sizeof *scene->materials);
}

static bool upload_textures(struct gl_runtime *rt, const struct dt_scene *scene)
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

bool gl_scene_upload(struct dt_core *core, const struct dt_scene *scene)
{
    struct gl_runtime *rt = (struct gl_runtime *)core;
    gl_scene_destroy(rt);
    rt->index_count = scene->index_count;
    core->has_scene = check_scene(core, scene) && upload_buffers(rt, scene) &&
                      upload_textures(rt, scene) && gl_scene_describe(rt);
    return core->has_scene;
}

void gl_scene_destroy(struct gl_runtime *rt)
{
    rt->core.has_scene = false;
    gl_buffer_destroy(rt, &rt->builtin.vertices);
    gl_buffer_destroy(rt, &rt->builtin.indices);
    gl_buffer_destroy(rt, &rt->builtin.materials);
    gl_image_destroy(rt, &rt->builtin.textures);
    if (rt->scene_input)
        rt->gl.DeleteVertexArrays(1, &rt->scene_input);
    rt->scene_input = 0;
}
