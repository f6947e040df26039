/* Pipelines in a context of somebody else's: the functions of diptych_gl.h. What they are given is
 * checked here, once, and the context's state kept and given back around each. Called by other programs. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* What a function did, once the context is as it was. */
static bool leave(struct gl_runtime *rt, bool good)
{
    return gl_state_leave(rt) && good;
}

/* ---- Open and close -------------------------------------------------------------------------- */

static bool open_in(struct gl_runtime *rt, const struct dt_gl_host *host)
{
    if (!host->get_proc_address || !gladLoadGLContext(&rt->gl, host->get_proc_address)) {
        gl_log(rt, DT_ERROR,
               "OpenGL: no functions; make a context current, and give its "
               "get_proc_address");
        return false;
    }
    return gl_context_suits(rt);
}

struct gl_runtime *dt_gl_open(const struct dt_gl_host *host)
{
    struct gl_runtime *rt = calloc(1, sizeof *rt);
    if (!rt) {
        if (host->log.message)
            host->log.message(host->log.user, DT_ERROR, "out of memory for an OpenGL runtime");
        return NULL;
    }
    rt->options =
        (struct dt_runtime_options){.log = host->log, .glsl = host->glsl, .timing = host->timing};
    rt->hosted = true;
    rt->leave_state = host->leave_state;
    if (!open_in(rt, host)) {
        free(rt);
        return NULL;
    }
    bool good = gl_state_enter(rt) && gl_builtin_create(rt);
    if (leave(rt, good))
        return rt;
    dt_gl_close(rt);
    return NULL;
}

void dt_gl_close(struct gl_runtime *rt)
{
    if (!rt)
        return;
    gl_state_enter(rt);
    gl_panel_destroy(rt);
    gl_scene_destroy(rt);
    gl_builtin_destroy(rt);
    gl_state_leave(rt);
    free(rt);
}

/* ---- Imports --------------------------------------------------------------------------------- */

static bool import_buffer(const struct gl_runtime *rt, struct gl_buffer *buffer, const char *name,
                          const struct dt_gl_range *range, uint64_t least)
{
    const struct gl_limits *limits = &rt->limits;
    uint64_t alignment = (uint64_t)(limits->storage_alignment > limits->uniform_alignment
                                        ? limits->storage_alignment
                                        : limits->uniform_alignment);
    if (!range->buffer || range->size < least || range->offset % (alignment ? alignment : 1)) {
        gl_log(
            rt, DT_ERROR,
            "%s: a buffer of at least %llu bytes is needed, at a multiple of %llu, but %llu bytes "
            "at %llu were given",
            name, (unsigned long long)least, (unsigned long long)alignment,
            (unsigned long long)range->size, (unsigned long long)range->offset);
        return false;
    }
    if (range->size > (uint64_t)rt->limits.storage_size) {
        gl_log(rt, DT_ERROR, "%s: %llu bytes, and %s allows %lld in one buffer: import fewer", name,
               (unsigned long long)range->size, rt->device_name,
               (long long)rt->limits.storage_size);
        return false;
    }
    *buffer = (struct gl_buffer){.name = name,
                                 .handle = range->buffer,
                                 .size = (GLsizeiptr)range->size,
                                 .offset = (GLintptr)range->offset,
                                 .imported = true};
    return true;
}

/* One white texel in place of the textures that the host has not. */
static bool import_textures(struct gl_runtime *rt, unsigned textures)
{
    static const float white[4] = {1, 1, 1, 1};
    struct gl_image *image = &rt->builtin.textures;
    const struct gl_image_info info = {.name = "no textures",
                                       .format = DT_FORMAT_RGBA8_SRGB,
                                       .width = 1,
                                       .height = 1,
                                       .layers = 1,
                                       .mips = 1,
                                       .layered = true};
    if (!textures)
        return dt_gl_image_create(rt, image, &info) && dt_gl_clear_image(rt, image, 0, white);
    *image = (struct gl_image){.name = "scene textures",
                               .handle = textures,
                               .target = GL_TEXTURE_2D_ARRAY,
                               .texel = DT_FORMAT_RGBA8_SRGB,
                               .layered = true,
                               .imported = true};
    return true;
}

static bool import_scene(struct gl_runtime *rt, const struct dt_gl_scene *scene)
{
    struct gl_builtin *builtin = &rt->builtin;
    if (!scene->index_count || scene->index_count % 3) {
        gl_log(rt, DT_ERROR, "import_scene: %u indices, but triangles have three each",
               scene->index_count);
        return false;
    }
    if (scene->indices.offset) {
        gl_log(rt, DT_ERROR,
               "scene indices: at byte %llu, but draws count from the start of the buffer; give "
               "them one of their own",
               (unsigned long long)scene->indices.offset);
        return false;
    }
    rt->index_count = scene->index_count;
    struct dt_gl_range materials = scene->materials;
    if (materials.size > DT_MAX_MATERIALS * sizeof(struct dt_material)) /* as a uniform block */
        materials.size = DT_MAX_MATERIALS * sizeof(struct dt_material);
    return import_buffer(rt, &builtin->vertices, "scene vertices", &scene->vertices,
                         sizeof(struct dt_vertex)) &&
           import_buffer(rt, &builtin->indices, "scene indices", &scene->indices,
                         (uint64_t)scene->index_count * sizeof(uint32_t)) &&
           import_buffer(rt, &builtin->materials, "scene materials", &materials,
                         DT_MAX_MATERIALS * sizeof(struct dt_material)) &&
           import_textures(rt, scene->textures) && gl_scene_describe(rt);
}

bool dt_gl_import_scene(struct gl_runtime *rt, const struct dt_gl_scene *scene)
{
    rt->width = rt->height = 0; /* until the next resize */
    bool good = gl_state_enter(rt);
    gl_scene_destroy(rt);
    good = good && import_scene(rt, scene);
    if (!good)
        gl_scene_destroy(rt);
    return leave(rt, good);
}

bool dt_gl_import_image(struct gl_runtime *rt, uint32_t resource, unsigned texture)
{
    const struct dt_pipeline *pipeline = rt->panel ? rt->panel->pipeline : NULL;
    if (!pipeline || resource >= pipeline->resource_count ||
        pipeline->resources[resource].kind != DT_IMAGE) {
        gl_log(rt, DT_ERROR, "import_image: the pipeline has no image %u; create comes first",
               resource);
        return false;
    }
    const char *name = pipeline->resources[resource].name;
    uint32_t at = 0;
    while (at < rt->import_count && strcmp(rt->imports[at].name, name) != 0)
        at++;
    rt->width = rt->height = 0; /* until the next resize */
    if (!texture) {
        if (at < rt->import_count)
            rt->imports[at] = rt->imports[--rt->import_count];
        return true;
    }
    if (at == GL_MAX_IMPORTS) {
        gl_log(rt, DT_ERROR, "import_image %s: %u are imported already; take one back", name, at);
        return false;
    }
    rt->imports[at] = (struct gl_import){.name = name, .texture = texture};
    if (at == rt->import_count)
        rt->import_count++;
    return true;
}

/* ---- The pipeline ---------------------------------------------------------------------------- */

bool dt_gl_create(struct gl_runtime *rt, const struct dt_panel *panel)
{
    if (strcmp(panel->backend, "gl") != 0) {
        gl_log(rt, DT_ERROR, "pipeline %s: the panel is for %s; give the one of NAME_gl.c",
               panel->pipeline->name, panel->backend);
        return false;
    }
    bool good = gl_state_enter(rt);
    rt->import_count = 0;
    good = good && gl_panel_create(rt, panel);
    return leave(rt, good);
}

static bool lacks_scene(const struct gl_runtime *rt)
{
    const struct dt_pipeline *pipeline = rt->panel->pipeline;
    for (uint32_t i = 0; i < pipeline->pass_count && !rt->scene_input; i++)
        if (pipeline->passes[i].uses_scene)
            return true;
    return false;
}

bool dt_gl_resize(struct gl_runtime *rt, uint32_t width, uint32_t height)
{
    if (!rt->panel || lacks_scene(rt)) {
        gl_log(rt, DT_ERROR,
               "resize: no pipeline or no scene yet; create and import_scene come first");
        return false;
    }
    bool good = gl_state_enter(rt);
    good = good && gl_panel_resize(rt, width, height);
    return leave(rt, good);
}

static bool record(struct gl_runtime *rt, const struct dt_frame *frame, const void *live)
{
    return gl_state_enter(rt) && GL(rt, "frame", MemoryBarrier(GL_ALL_BARRIER_BITS)) &&
           gl_frame_render(rt, frame, live, NULL) &&
           GL(rt, "frame", MemoryBarrier(GL_ALL_BARRIER_BITS));
}

bool dt_gl_record(struct gl_runtime *rt, const struct dt_frame *frame, const void *live)
{
    if (!rt->width) {
        gl_log(rt, DT_ERROR,
               "record: the pipeline has no resources; resize comes first, also after "
               "an import and after a record that failed");
        return false;
    }
    bool good = leave(rt, record(rt, frame, live));
    if (!good)
        rt->width = rt->height = 0;
    return good;
}

bool dt_gl_resource(struct gl_runtime *rt, uint32_t resource, struct dt_gl_resource *out)
{
    *out = (struct dt_gl_resource){0};
    if (!rt->width || resource >= rt->panel->pipeline->resource_count) {
        gl_log(rt, DT_ERROR, "resource %u: there is none; resize comes first", resource);
        return false;
    }
    const void *object = rt->panel->resource(rt->state, resource);
    if (rt->panel->pipeline->resources[resource].kind == DT_BUFFER)
        out->buffer = ((const struct gl_buffer *)object)->handle;
    else
        out->texture = ((const struct gl_image *)object)->handle;
    return true;
}

bool dt_gl_timings(struct gl_runtime *rt, double *pass_ms)
{
    if (!rt->queries || !rt->width) {
        gl_log(rt, DT_ERROR, "timings: none; open with timing and record a frame first");
        return false;
    }
    return gl_frame_timings(rt, pass_ms);
}
