/* Checks a context's features, sets the state that passes rely on, saves and restores a host's
 * state. */
#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Required features ----------------------------------------------------------------------- */

static bool has_extension(const struct dt_gl_runtime *rt, const char *name)
{
    GLint count = 0;
    rt->gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++)
        if (strcmp((const char *)rt->gl.GetStringi(GL_EXTENSIONS, (GLuint)i), name) == 0)
            return true;
    return false;
}

static const char *const needed[] = {
    "GL_ARB_shader_viewport_layer_array", /* gl_Layer from the vertex shader */
};

bool gl_has_all(const struct dt_gl_runtime *rt, const char *const *names, size_t count,
                char *missing, size_t size)
{
    missing[0] = '\0';
    for (size_t i = 0; i < count; i++) {
        size_t used = strlen(missing);
        if (!has_extension(rt, names[i]))
            snprintf(missing + used, size - used, "%s%s", used ? " " : "", names[i]);
    }
    return !missing[0];
}

static uint32_t integer(const struct dt_gl_runtime *rt, GLenum name)
{
    GLint value = 0;
    rt->gl.GetIntegerv(name, &value);
    return (uint32_t)value;
}

static uint64_t integer64(const struct dt_gl_runtime *rt, GLenum name)
{
    GLint64 value = 0;
    rt->gl.GetInteger64v(name, &value);
    return (uint64_t)value;
}

/* The less of a limit's values for dispatches and for draws. */
static uint64_t limit(struct dt_gl_runtime *rt, const GLenum names[2], int index)
{
    uint64_t least = UINT64_MAX;
    for (int i = 0; i < 2; i++) {
        GLint64 value = INT64_MAX;
        if (names[i] == GL_NONE)
            continue;
        if (index < 0)
            rt->gl.GetInteger64v(names[i], &value);
        else
            rt->gl.GetInteger64i_v(names[i], (GLuint)index, &value);
        least = (uint64_t)value < least ? (uint64_t)value : least;
    }
    return least;
}

static void read_limits(struct dt_gl_runtime *rt)
{
    static const struct {
        GLenum names[2];
        int index;
    } rows[DT_LIMITS] = {
#define ROW(name, words, vk, gl, gl_draw, index, ...) [DT_LIMIT_##name] = {{gl, gl_draw}, index},
        DT_DEVICE_LIMITS(ROW)
#undef ROW
    };
    struct dt_limits *l = &rt->core.limits;
    GLint viewport[2] = {0};
    rt->gl.GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    for (int i = 0; i < DT_LIMITS; i++)
        l->most[i] = limit(rt, rows[i].names, rows[i].index);
    for (int i = 0; i < 2; i++)
        if ((uint64_t)viewport[i] < l->most[DT_LIMIT_TARGET_WIDTH + i])
            l->most[DT_LIMIT_TARGET_WIDTH + i] = (uint64_t)viewport[i];
    l->numbers[DT_BIND_UNIFORM] = integer(rt, GL_MAX_UNIFORM_BUFFER_BINDINGS);
    l->numbers[DT_BIND_STORAGE] = integer(rt, GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS);
    l->numbers[DT_BIND_TEXELS] = integer(rt, GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS);
    l->numbers[DT_BIND_TEXTURE] = integer(rt, GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS);
    l->numbers[DT_BIND_IMAGE] = integer(rt, GL_MAX_IMAGE_UNITS);
    rt->gl.GetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY, &l->anisotropy);
    uint64_t storage = integer64(rt, GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT);
    uint64_t uniform = integer64(rt, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT);
    uint64_t texels = integer64(rt, GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT);
    rt->buffer_alignment = storage > uniform ? storage : uniform;
    rt->buffer_alignment = texels > rt->buffer_alignment ? texels : rt->buffer_alignment;
}

/* Whether the driver draws on the CPU, by its GL_RENDERER. */
static bool is_software(const char *renderer)
{
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "lavapipe",
                                        "SwiftShader"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++)
        if (strstr(renderer, names[i]))
            return true;
    return false;
}

/* What this runtime takes of 4.6. A context of 4.5 that has them will do: Mesa's software drivers report
 * 4.5, though they have every extension. */
static const char *const core_4_6[] = {
    "GL_ARB_gl_spirv",         "GL_ARB_polygon_offset_clamp",       "GL_ARB_shader_draw_parameters",
    "GL_ARB_spirv_extensions", "GL_ARB_texture_filter_anisotropic",
};

/* glad leaves out the functions of a version that the context does not report. */
static void take_4_6(struct dt_gl_runtime *rt, GLADuserptrloadfunc load, void *user)
{
    if (rt->gl.VERSION_4_6)
        return;
    rt->gl.SpecializeShader = (PFNGLSPECIALIZESHADERPROC)load(user, "glSpecializeShaderARB");
    rt->gl.PolygonOffsetClamp = (PFNGLPOLYGONOFFSETCLAMPPROC)load(user, "glPolygonOffsetClamp");
}

bool gl_context_suits(struct dt_gl_runtime *rt, GLADuserptrloadfunc load, void *user)
{
    const char *renderer = (const char *)rt->gl.GetString(GL_RENDERER);
    const char *version = (const char *)rt->gl.GetString(GL_VERSION);
    char *device = rt->core.device.name, missing[512];
    snprintf(device, sizeof rt->core.device.name, "%s", renderer ? renderer : "OpenGL");
    snprintf(rt->core.device.driver, sizeof rt->core.device.driver, "%s", version ? version : "");
    rt->core.device.software = is_software(device);
    if (integer(rt, GL_CONTEXT_FLAGS) & GL_CONTEXT_FLAG_NO_ERROR_BIT)
        return dt_error(&rt->core, "%s: the context reports no errors; unset MESA_NO_ERROR",
                        device);
    if (!rt->gl.VERSION_4_5)
        return dt_error(&rt->core, "%s lacks OpenGL 4.6: use a newer driver", device);
    if ((!rt->gl.VERSION_4_6 &&
         !gl_has_all(rt, core_4_6, DT_ARRAY_COUNT(core_4_6), missing, sizeof missing)) ||
        !gl_has_all(rt, needed, DT_ARRAY_COUNT(needed), missing, sizeof missing))
        return dt_error(&rt->core, "%s lacks %s: use a newer driver", device, missing);
    take_4_6(rt, load, user);
    if (!rt->gl.SpecializeShader || !rt->gl.PolygonOffsetClamp)
        return dt_error(&rt->core, "%s does not give the functions of OpenGL 4.6", device);
    read_limits(rt);
    return true;
}

/* ---- Fixed state ----------------------------------------------------------------------------- */

/* Under this state OpenGL and Vulkan give the same bits: depth 0..1, row 0 at NDC y = -1, the first
 * vertex is the provoking one, sRGB targets encode, shaders size points, whose origin is row 0. */
bool gl_state_fix(struct dt_gl_runtime *rt)
{
    rt->gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    rt->gl.ProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    rt->gl.FrontFace(GL_CCW);
    rt->gl.Enable(GL_FRAMEBUFFER_SRGB);
    rt->gl.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    rt->gl.Enable(GL_PROGRAM_POINT_SIZE);
    rt->gl.PointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, GL_LOWER_LEFT);
    rt->gl.Disable(GL_DITHER);
    rt->gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    return GL(rt, "fixed state", PixelStorei(GL_UNPACK_ALIGNMENT, 1));
}

/* ---- A host's state -------------------------------------------------------------------------- */

/* Switches that passes change, or that would change what they draw. */
static const GLenum switches[] = {
    GL_BLEND,
    GL_COLOR_LOGIC_OP,
    GL_CULL_FACE,
    GL_DEPTH_CLAMP,
    GL_DEPTH_TEST,
    GL_DITHER,
    GL_FRAMEBUFFER_SRGB,
    GL_LINE_SMOOTH,
    GL_POLYGON_OFFSET_FILL,
    GL_PRIMITIVE_RESTART,
    GL_PRIMITIVE_RESTART_FIXED_INDEX,
    GL_PROGRAM_POINT_SIZE,
    GL_RASTERIZER_DISCARD,
    GL_SCISSOR_TEST,
    GL_STENCIL_TEST,
    GL_TEXTURE_CUBE_MAP_SEAMLESS,
};

static const GLenum stores[] = {
    GL_PACK_ALIGNMENT,     GL_UNPACK_ALIGNMENT,  GL_UNPACK_IMAGE_HEIGHT,
    GL_UNPACK_LSB_FIRST,   GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_IMAGES,
    GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS,  GL_UNPACK_SWAP_BYTES,
};

/* Buffer bindings without an index: name to query, and target. */
static const struct {
    GLenum name, target;
} buffers[] = {
    {GL_DISPATCH_INDIRECT_BUFFER_BINDING, GL_DISPATCH_INDIRECT_BUFFER},
    {GL_DRAW_INDIRECT_BUFFER_BINDING, GL_DRAW_INDIRECT_BUFFER},
    {GL_PIXEL_UNPACK_BUFFER_BINDING, GL_PIXEL_UNPACK_BUFFER},
    {GL_QUERY_BUFFER_BINDING, GL_QUERY_BUFFER}, /* it would take the results of timings */
    {GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER},
    {GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER},
};

static const struct {
    GLenum binding, target;
} textures[] = {
    {GL_TEXTURE_BINDING_2D, GL_TEXTURE_2D},
    {GL_TEXTURE_BINDING_2D_ARRAY, GL_TEXTURE_2D_ARRAY},
    {GL_TEXTURE_BINDING_3D, GL_TEXTURE_3D},
    {GL_TEXTURE_BINDING_CUBE_MAP, GL_TEXTURE_CUBE_MAP},
    {GL_TEXTURE_BINDING_CUBE_MAP_ARRAY, GL_TEXTURE_CUBE_MAP_ARRAY},
    {GL_TEXTURE_BINDING_BUFFER, GL_TEXTURE_BUFFER},
};

enum {
    SWITCHES = DT_ARRAY_COUNT(switches),
    STORES = DT_ARRAY_COUNT(stores),
    BUFFERS = DT_ARRAY_COUNT(buffers),
    TEXTURES = DT_ARRAY_COUNT(textures),
    MAX_BINDINGS = 64,  /* of each kind that a pass may have */
    MAX_VIEWPORTS = 16, /* this and the next two suffice for all known drivers */
    MAX_DRAW_BUFFERS = 8,
    MAX_CLIP_DISTANCES = 8
};

struct kept_range {
    GLint buffer;
    GLint64 start, size;
};

struct kept_texture {
    GLint bound[TEXTURES], sampler;
};

struct kept_image {
    GLint texture, level, layered, layer, access, format;
};

struct kept_blend {
    GLboolean on, mask[4];
    GLint source_rgb, target_rgb, source_alpha, target_alpha, equation_rgb, equation_alpha;
};

struct gl_kept {
    GLboolean on[SWITCHES], clip[MAX_CLIP_DISTANCES], scissor[MAX_VIEWPORTS];
    GLint store[STORES], buffer[BUFFERS];
    GLint program, input, draw_framebuffer, read_framebuffer, unit;
    GLint clip_origin, clip_depth, provoking, front, cull, depth_function, polygon[2], point_origin;
    GLboolean depth_mask;
    GLfloat line_width, offset_factor, offset_units, offset_clamp;
    GLint scissor_box[MAX_VIEWPORTS][4];
    GLfloat viewport[MAX_VIEWPORTS][4];
    GLdouble depth_range[MAX_VIEWPORTS][2];
    struct kept_blend blend[MAX_DRAW_BUFFERS];
    /* bindings are saved before their first change; bit n of kept[kind]: binding n is saved */
    uint64_t kept[DT_BIND_IMAGE + 1];
    struct kept_range uniform[MAX_BINDINGS], storage[MAX_BINDINGS];
    struct kept_texture texture[MAX_BINDINGS];
    struct kept_image image[MAX_BINDINGS];
};

static GLint count_of(const struct dt_gl_runtime *rt, GLenum name, GLint most)
{
    GLint count = 0;
    rt->gl.GetIntegerv(name, &count);
    return count < most ? count : most;
}

static void keep_blend(const struct dt_gl_runtime *rt, struct gl_kept *kept)
{
    const GladGLContext *gl = &rt->gl;
    GLint count = count_of(rt, GL_MAX_DRAW_BUFFERS, MAX_DRAW_BUFFERS);
    for (GLuint i = 0; i < (GLuint)count; i++) {
        struct kept_blend *blend = &kept->blend[i];
        blend->on = gl->IsEnabledi(GL_BLEND, i);
        gl->GetBooleani_v(GL_COLOR_WRITEMASK, i, blend->mask);
        gl->GetIntegeri_v(GL_BLEND_SRC_RGB, i, &blend->source_rgb);
        gl->GetIntegeri_v(GL_BLEND_DST_RGB, i, &blend->target_rgb);
        gl->GetIntegeri_v(GL_BLEND_SRC_ALPHA, i, &blend->source_alpha);
        gl->GetIntegeri_v(GL_BLEND_DST_ALPHA, i, &blend->target_alpha);
        gl->GetIntegeri_v(GL_BLEND_EQUATION_RGB, i, &blend->equation_rgb);
        gl->GetIntegeri_v(GL_BLEND_EQUATION_ALPHA, i, &blend->equation_alpha);
    }
}

static void give_blend(const struct dt_gl_runtime *rt, const struct gl_kept *kept)
{
    const GladGLContext *gl = &rt->gl;
    GLint count = count_of(rt, GL_MAX_DRAW_BUFFERS, MAX_DRAW_BUFFERS);
    for (GLuint i = 0; i < (GLuint)count; i++) {
        const struct kept_blend *b = &kept->blend[i];
        (b->on ? gl->Enablei : gl->Disablei)(GL_BLEND, i);
        gl->ColorMaski(i, b->mask[0], b->mask[1], b->mask[2], b->mask[3]);
        gl->BlendFuncSeparatei(i, (GLenum)b->source_rgb, (GLenum)b->target_rgb,
                               (GLenum)b->source_alpha, (GLenum)b->target_alpha);
        gl->BlendEquationSeparatei(i, (GLenum)b->equation_rgb, (GLenum)b->equation_alpha);
    }
}

static void keep_viewports(const struct dt_gl_runtime *rt, struct gl_kept *kept)
{
    GLint count = count_of(rt, GL_MAX_VIEWPORTS, MAX_VIEWPORTS);
    for (GLuint i = 0; i < (GLuint)count; i++) {
        rt->gl.GetFloati_v(GL_VIEWPORT, i, kept->viewport[i]);
        rt->gl.GetDoublei_v(GL_DEPTH_RANGE, i, kept->depth_range[i]);
        kept->scissor[i] = rt->gl.IsEnabledi(GL_SCISSOR_TEST, i);
        rt->gl.GetIntegeri_v(GL_SCISSOR_BOX, i, kept->scissor_box[i]);
    }
}

static void give_viewports(const struct dt_gl_runtime *rt, const struct gl_kept *kept)
{
    GLint count = count_of(rt, GL_MAX_VIEWPORTS, MAX_VIEWPORTS);
    for (GLuint i = 0; i < (GLuint)count; i++) {
        rt->gl.ViewportIndexedfv(i, kept->viewport[i]);
        rt->gl.DepthRangeIndexed(i, kept->depth_range[i][0], kept->depth_range[i][1]);
        rt->gl.ScissorIndexedv(i, kept->scissor_box[i]);
        (kept->scissor[i] ? rt->gl.Enablei : rt->gl.Disablei)(GL_SCISSOR_TEST, i);
    }
}

/* State that one query returns. */
static void keep_integers(const struct dt_gl_runtime *rt, struct gl_kept *kept)
{
    const struct {
        GLenum name;
        GLint *value;
    } integers[] = {
        {GL_CURRENT_PROGRAM, &kept->program},
        {GL_VERTEX_ARRAY_BINDING, &kept->input},
        {GL_DRAW_FRAMEBUFFER_BINDING, &kept->draw_framebuffer},
        {GL_READ_FRAMEBUFFER_BINDING, &kept->read_framebuffer},
        {GL_ACTIVE_TEXTURE, &kept->unit},
        {GL_CLIP_ORIGIN, &kept->clip_origin},
        {GL_CLIP_DEPTH_MODE, &kept->clip_depth},
        {GL_PROVOKING_VERTEX, &kept->provoking},
        {GL_FRONT_FACE, &kept->front},
        {GL_CULL_FACE_MODE, &kept->cull},
        {GL_DEPTH_FUNC, &kept->depth_function},
        {GL_POLYGON_MODE, kept->polygon},
        {GL_POINT_SPRITE_COORD_ORIGIN, &kept->point_origin},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(integers); i++)
        rt->gl.GetIntegerv(integers[i].name, integers[i].value);
    rt->gl.GetBooleanv(GL_DEPTH_WRITEMASK, &kept->depth_mask);
    rt->gl.GetFloatv(GL_LINE_WIDTH, &kept->line_width);
    rt->gl.GetFloatv(GL_POLYGON_OFFSET_FACTOR, &kept->offset_factor);
    rt->gl.GetFloatv(GL_POLYGON_OFFSET_UNITS, &kept->offset_units);
    rt->gl.GetFloatv(GL_POLYGON_OFFSET_CLAMP, &kept->offset_clamp);
    for (size_t i = 0; i < STORES; i++)
        rt->gl.GetIntegerv(stores[i], &kept->store[i]);
    for (size_t i = 0; i < BUFFERS; i++)
        rt->gl.GetIntegerv(buffers[i].name, &kept->buffer[i]);
    for (size_t i = 0; i < SWITCHES; i++)
        kept->on[i] = rt->gl.IsEnabled(switches[i]);
    GLint clips = count_of(rt, GL_MAX_CLIP_DISTANCES, MAX_CLIP_DISTANCES);
    for (GLuint i = 0; i < (GLuint)clips; i++)
        kept->clip[i] = rt->gl.IsEnabled(GL_CLIP_DISTANCE0 + i);
}

static void give_integers(const struct dt_gl_runtime *rt, const struct gl_kept *kept)
{
    const GladGLContext *gl = &rt->gl;
    gl->UseProgram((GLuint)kept->program);
    gl->BindVertexArray((GLuint)kept->input);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)kept->draw_framebuffer);
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)kept->read_framebuffer);
    gl->ActiveTexture((GLenum)kept->unit);
    gl->ClipControl((GLenum)kept->clip_origin, (GLenum)kept->clip_depth);
    gl->ProvokingVertex((GLenum)kept->provoking);
    gl->FrontFace((GLenum)kept->front);
    gl->CullFace((GLenum)kept->cull);
    gl->DepthFunc((GLenum)kept->depth_function);
    gl->DepthMask(kept->depth_mask);
    gl->PolygonMode(GL_FRONT_AND_BACK, (GLenum)kept->polygon[0]);
    gl->PointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, kept->point_origin);
    gl->LineWidth(kept->line_width);
    gl->PolygonOffsetClamp(kept->offset_factor, kept->offset_units, kept->offset_clamp);
    for (size_t i = 0; i < STORES; i++)
        gl->PixelStorei(stores[i], kept->store[i]);
    for (size_t i = 0; i < BUFFERS; i++)
        gl->BindBuffer(buffers[i].target, (GLuint)kept->buffer[i]);
    for (size_t i = 0; i < SWITCHES; i++)
        (kept->on[i] ? gl->Enable : gl->Disable)(switches[i]);
    GLint clips = count_of(rt, GL_MAX_CLIP_DISTANCES, MAX_CLIP_DISTANCES);
    for (GLuint i = 0; i < (GLuint)clips; i++)
        (kept->clip[i] ? gl->Enable : gl->Disable)(GL_CLIP_DISTANCE0 + i);
}

/* Sets the initial state of a context, except for state that passes set before every draw. */
static bool neutralise(struct dt_gl_runtime *rt)
{
    for (size_t i = 0; i < SWITCHES; i++)
        rt->gl.Disable(switches[i]);
    for (size_t i = 0; i < STORES; i++)
        if (stores[i] != GL_PACK_ALIGNMENT && stores[i] != GL_UNPACK_ALIGNMENT)
            rt->gl.PixelStorei(stores[i], 0);
    rt->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    rt->gl.BindBuffer(GL_QUERY_BUFFER, 0);
    rt->gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    rt->gl.DepthRange(0, 1);
    rt->gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    rt->gl.LineWidth(1);
    /* a dispatch draws nothing, but Mesa complains of a host's incomplete framebuffer there */
    rt->gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    return gl_state_fix(rt);
}

bool gl_state_enter(struct dt_core *core)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)core;
    GLenum error = rt->gl.GetError();
    if (error != GL_NO_ERROR)
        dt_log(core, DT_WARNING, "OpenGL error 0x%x was pending before diptych was called", error);
    for (int i = 0; i < 8 && error != GL_NO_ERROR; i++)
        error = rt->gl.GetError();
    if (!rt->leave_state) {
        rt->kept = calloc(1, sizeof *rt->kept);
        if (!rt->kept)
            return dt_error(core, "out of memory for the state of the context; free some");
        keep_integers(rt, rt->kept);
        keep_blend(rt, rt->kept);
        keep_viewports(rt, rt->kept);
    }
    return neutralise(rt);
}

/* ---- Bindings -------------------------------------------------------------------------------- */

static void keep_range(const struct dt_gl_runtime *rt, struct kept_range *range, GLuint index,
                       bool storage)
{
    rt->gl.GetIntegeri_v(storage ? GL_SHADER_STORAGE_BUFFER_BINDING : GL_UNIFORM_BUFFER_BINDING,
                         index, &range->buffer);
    rt->gl.GetInteger64i_v(storage ? GL_SHADER_STORAGE_BUFFER_START : GL_UNIFORM_BUFFER_START,
                           index, &range->start);
    rt->gl.GetInteger64i_v(storage ? GL_SHADER_STORAGE_BUFFER_SIZE : GL_UNIFORM_BUFFER_SIZE, index,
                           &range->size);
}

static void give_range(const struct dt_gl_runtime *rt, const struct kept_range *range, GLuint index,
                       GLenum target)
{
    if (range->size > 0)
        rt->gl.BindBufferRange(target, index, (GLuint)range->buffer, (GLintptr)range->start,
                               (GLsizeiptr)range->size);
    else
        rt->gl.BindBufferBase(target, index, (GLuint)range->buffer);
}

static void keep_texture(const struct dt_gl_runtime *rt, struct kept_texture *texture, GLuint unit)
{
    rt->gl.ActiveTexture(GL_TEXTURE0 + unit);
    for (int i = 0; i < TEXTURES; i++)
        rt->gl.GetIntegerv(textures[i].binding, &texture->bound[i]);
    rt->gl.GetIntegerv(GL_SAMPLER_BINDING, &texture->sampler);
}

static void give_texture(const struct dt_gl_runtime *rt, const struct kept_texture *texture,
                         GLuint unit)
{
    rt->gl.ActiveTexture(GL_TEXTURE0 + unit);
    for (int i = 0; i < TEXTURES; i++)
        rt->gl.BindTexture(textures[i].target, (GLuint)texture->bound[i]);
    rt->gl.BindSampler(unit, (GLuint)texture->sampler);
}

static void keep_image(const struct dt_gl_runtime *rt, struct kept_image *image, GLuint unit)
{
    rt->gl.GetIntegeri_v(GL_IMAGE_BINDING_NAME, unit, &image->texture);
    rt->gl.GetIntegeri_v(GL_IMAGE_BINDING_LEVEL, unit, &image->level);
    rt->gl.GetIntegeri_v(GL_IMAGE_BINDING_LAYERED, unit, &image->layered);
    rt->gl.GetIntegeri_v(GL_IMAGE_BINDING_LAYER, unit, &image->layer);
    rt->gl.GetIntegeri_v(GL_IMAGE_BINDING_ACCESS, unit, &image->access);
    rt->gl.GetIntegeri_v(GL_IMAGE_BINDING_FORMAT, unit, &image->format);
}

void gl_state_keep_binding(struct dt_gl_runtime *rt, enum dt_binding_kind kind, GLuint at)
{
    struct gl_kept *kept = rt->kept;
    kind = kind == DT_BIND_TEXELS ? DT_BIND_TEXTURE : kind; /* of the same units */
    if (!kept || at >= MAX_BINDINGS || (kept->kept[kind] >> at & 1))
        return;
    kept->kept[kind] |= (uint64_t)1 << at;
    switch (kind) {
    case DT_BIND_UNIFORM:
        keep_range(rt, &kept->uniform[at], at, false);
        break;
    case DT_BIND_STORAGE:
        keep_range(rt, &kept->storage[at], at, true);
        break;
    case DT_BIND_TEXELS:
    case DT_BIND_TEXTURE:
        keep_texture(rt, &kept->texture[at], at);
        break;
    case DT_BIND_IMAGE:
        keep_image(rt, &kept->image[at], at);
        break;
    }
}

static void give_bindings(const struct dt_gl_runtime *rt, const struct gl_kept *kept)
{
    for (GLuint i = 0; i < MAX_BINDINGS; i++) {
        if (kept->kept[DT_BIND_UNIFORM] >> i & 1)
            give_range(rt, &kept->uniform[i], i, GL_UNIFORM_BUFFER);
        if (kept->kept[DT_BIND_STORAGE] >> i & 1)
            give_range(rt, &kept->storage[i], i, GL_SHADER_STORAGE_BUFFER);
        if (kept->kept[DT_BIND_TEXTURE] >> i & 1)
            give_texture(rt, &kept->texture[i], i);
        const struct kept_image *image = &kept->image[i];
        if (kept->kept[DT_BIND_IMAGE] >> i & 1)
            rt->gl.BindImageTexture(i, (GLuint)image->texture, image->level,
                                    (GLboolean)image->layered, image->layer, (GLenum)image->access,
                                    (GLenum)image->format);
    }
}

/* give_bindings changes bindings without an index and the active unit; give_integers restores
 * them. */
bool gl_state_leave(struct dt_core *core)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)core;
    struct gl_kept *kept = rt->kept;
    rt->kept = NULL;
    if (!kept)
        return true;
    give_bindings(rt, kept);
    give_integers(rt, kept);
    give_blend(rt, kept);
    give_viewports(rt, kept);
    free(kept);
    return gl_check(rt, "Enable", "the host's state");
}
