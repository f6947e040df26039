/* The functions of diptych_gl.h: pipelines in a host's context, on top of the front. They save and
 * restore the context's state around OpenGL calls. */
#include "internal.h"

#include <stdlib.h>

/* NULL of a runtime that a host never got. */
static const struct dt_core *core_of(const struct dt_gl_runtime *rt)
{
    return rt ? &rt->core : NULL;
}

static bool leave(struct dt_gl_runtime *rt, bool good)
{
    return gl_state_leave(&rt->core) && good;
}

/* ---- Open and close -------------------------------------------------------------------------- */

static GLADapiproc host_load(void *user, const char *name)
{
    const struct dt_gl_host *host = user;
    return host->get_proc_address(name);
}

static bool open_in(struct dt_gl_runtime *rt, const struct dt_gl_host *host)
{
    if (!host->get_proc_address || !gladLoadGLContext(&rt->gl, host->get_proc_address))
        return dt_error(&rt->core, "OpenGL: no functions; make a context current, and give its "
                                   "get_proc_address");
    return gl_context_suits(rt, host_load, (void *)host);
}

struct dt_gl_runtime *dt_gl_open(const struct dt_gl_host *host)
{
    if (!host)
        return NULL;
    const struct dt_core bare = {.backend = &gl_backend, .log = host->log, .hosted = true};
    struct dt_gl_runtime *rt = calloc(1, sizeof *rt);
    if (!rt) {
        dt_error(&bare, "out of memory for an OpenGL runtime; free some");
        return NULL;
    }
    rt->core = bare;
    rt->core.timing = host->timing;
    rt->core.frames = host->frames;
    rt->core.keep_history = host->keep_history;
    rt->core.target = host->target;
    rt->glsl = host->glsl;
    rt->leave_state = host->leave_state;
    if (!open_in(rt, host)) {
        free(rt);
        return NULL;
    }
    bool good = gl_state_enter(&rt->core) && gl_builtin_create(rt);
    if (leave(rt, good))
        return rt;
    dt_gl_close(rt);
    return NULL;
}

void dt_gl_close(struct dt_gl_runtime *rt)
{
    if (!rt)
        return;
    gl_state_enter(&rt->core);
    dt_front_destroy(&rt->core);
    gl_scene_destroy(rt);
    gl_builtin_destroy(rt);
    gl_state_leave(&rt->core);
    free(rt);
}

/* ---- The scene ------------------------------------------------------------------------------- */

/* One white texel, if the host has no textures. */
static bool import_textures(struct dt_gl_runtime *rt, unsigned textures)
{
    static const float white[4] = {1, 1, 1, 1};
    struct gl_image *image = &rt->builtin.textures;
    *image = (struct gl_image){.name = "scene textures",
                               .handle = textures,
                               .format = DT_FORMAT_RGBA8_SRGB,
                               .width = 1,
                               .height = 1,
                               .layers = textures ? INT16_MAX : 1, /* views take fewer */
                               .mips = textures ? DT_MAX_MIPS : 1,
                               .layered = true,
                               .imported = textures};
    return textures || (gl_image_create(rt, image) && gl_image_clear(rt, image, 0, white));
}

static bool import_scene(struct dt_gl_runtime *rt, const struct dt_gl_scene *scene)
{
    if (scene->indices.offset)
        return dt_error(&rt->core,
                        "scene indices: offset %llu, but it must be 0; use a separate buffer",
                        (unsigned long long)scene->indices.offset);
    struct dt_gl_range materials = scene->materials, indices = scene->indices;
    const uint64_t index_bytes = (uint64_t)scene->index_count * sizeof(uint32_t);
    if (indices.size > index_bytes) /* shaders compute length() from the bytes that are bound */
        indices.size = index_bytes;
    if (materials.size > DT_MAX_MATERIALS * sizeof(struct dt_material)) /* the uniform block */
        materials.size = DT_MAX_MATERIALS * sizeof(struct dt_material);
    return ((!scene->vertices.buffer && scene->attributes[DT_POSITION].buffer) ||
            gl_buffer_import(rt, gl_buffer_of(rt, DT_SCENE_VERTICES), "scene vertices",
                             &scene->vertices, sizeof(struct dt_vertex))) &&
           gl_buffer_import(rt, gl_buffer_of(rt, DT_SCENE_INDICES), "scene indices", &indices,
                            index_bytes) &&
           gl_buffer_import(rt, gl_buffer_of(rt, DT_SCENE_MATERIALS), "scene materials", &materials,
                            DT_MAX_MATERIALS * sizeof(struct dt_material)) &&
           (!scene->objects.buffer ||
            gl_buffer_import(rt, gl_buffer_of(rt, DT_SCENE_OBJECTS), "scene objects",
                             &scene->objects, sizeof(struct dt_object))) &&
           import_textures(rt, scene->textures) && gl_scene_describe(rt, scene->attributes);
}

bool dt_gl_import_scene(struct dt_gl_runtime *rt, const struct dt_gl_scene *scene)
{
    if (!dt_front_given(core_of(rt), scene, "import_scene: the struct dt_gl_scene") ||
        !dt_front_import_scene(&rt->core, scene->vertices.buffer ? scene->vertices.size : 0,
                               scene->index_count, scene->numbered))
        return false;
    bool good = gl_state_enter(&rt->core);
    gl_scene_destroy(rt);
    good = good && import_scene(rt, scene);
    if (!good)
        gl_scene_destroy(rt);
    rt->core.has_scene = good;
    rt->core.has_objects = good && scene->objects.buffer;
    return leave(rt, good);
}

/* ---- The pipeline ---------------------------------------------------------------------------- */

bool dt_gl_create(struct dt_gl_runtime *rt, const struct dt_shaders *shaders)
{
    return rt && dt_front_create(&rt->core, shaders);
}

bool dt_gl_import_image(struct dt_gl_runtime *rt, uint32_t resource, unsigned texture)
{
    if (!rt || !dt_front_choose(&rt->core, "import_image", DT_IMAGE, resource))
        return false;
    rt->core.imported[resource] = texture;
    ((struct gl_import *)dt_choice(&rt->core, resource))->texture = texture;
    return true;
}

bool dt_gl_import_buffer(struct dt_gl_runtime *rt, uint32_t resource,
                         const struct dt_gl_range *range)
{
    if (!dt_front_given(core_of(rt), range, "import_buffer: the struct dt_gl_range") ||
        !dt_front_choose(&rt->core, "import_buffer", DT_BUFFER, resource))
        return false;
    rt->core.imported[resource] = range->buffer;
    ((struct gl_import *)dt_choice(&rt->core, resource))->buffer = *range;
    return true;
}

bool dt_gl_resize(struct dt_gl_runtime *rt, uint32_t width, uint32_t height)
{
    return rt && dt_front_resize(&rt->core, width, height);
}

bool dt_gl_write(struct dt_gl_runtime *rt, uint32_t resource, uint32_t mip,
                 const struct dt_bytes *bytes)
{
    return rt && dt_verb_write(&rt->core, resource, mip, bytes);
}

bool dt_gl_record(struct dt_gl_runtime *rt, const struct dt_frame *frame, const void *live)
{
    return rt && dt_verb_render(&rt->core, frame, live, NULL);
}

bool dt_gl_record_passes(struct dt_gl_runtime *rt, const struct dt_frame *frame, const void *live,
                         uint32_t first, uint32_t end)
{
    return rt && dt_front_render(&rt->core, "record_passes", frame, live, first, end);
}

bool dt_gl_get_resource(struct dt_gl_runtime *rt, uint32_t resource, struct dt_gl_resource *out)
{
    struct dt_bytes shape;
    if (!dt_front_given(core_of(rt), out, "resource: the struct dt_gl_resource"))
        return false;
    *out = (struct dt_gl_resource){0};
    if (!dt_front_take(&rt->core, resource, &shape))
        return false;
    const struct gl_buffer *buffer = gl_buffer_of(rt, resource);
    const struct gl_image *image = gl_image_of(rt, resource);
    if (buffer->handle)
        *out = (struct dt_gl_resource){.buffer = buffer->handle,
                                       .offset = (uint64_t)buffer->offset,
                                       .size = shape.size,
                                       .stride = rt->core.pipeline->resources[resource].stride};
    else
        *out = (struct dt_gl_resource){.texture = image->handle,
                                       .target = gl_target(image),
                                       .format = gl_format(image->format)->internal,
                                       .width = image->width,
                                       .height = image->height,
                                       .layers = image->layers,
                                       .mips = image->mips};
    return true;
}

bool dt_gl_timings(struct dt_gl_runtime *rt, uint32_t age, double *pass_ms)
{
    return rt && dt_front_timings(&rt->core, age, pass_ms);
}
