/* Resources of a pass in GLSL: blocks, images and textures with their bindings, and the functions
 * with which a body reads and writes them. */
#include "glsl.h"
#include "plan/plan.h"

#include <string.h>

struct format_names {
    const char *layout; /* storage format qualifier; NULL: cannot be a storage image */
    const char *prefix; /* of image2D, sampler2D and vec4 */
};

static struct format_names format_names(enum dt_format format)
{
    const struct format_info *info = format_info(format);
    bool is_signed = number_is_signed_integer(info->kind);
    return (struct format_names){info->qualifier, !number_is_integer(info->kind) ? ""
                                                  : is_signed                    ? "i"
                                                                                 : "u"};
}

static bool access_is_image(const struct access *access)
{
    return access->resource && access->resource->kind == DT_IMAGE;
}

static bool is_storage(const struct access *access)
{
    return access->kind & (DT_READ_STORAGE | DT_WRITE_STORAGE);
}

static bool is_compare(const struct access *access)
{
    return access->filter && access->filter->compare;
}

/* Whether the body calls both by one name. */
static bool same_access(const struct access *a, const struct access *b)
{
    return a->resource == b->resource && !strcmp(access_word(a), access_word(b));
}

/* Whether texels have a third coordinate. */
static bool is_layered(const struct access *access)
{
    return access->resource->layers && !access->layer;
}

/* What GLSL calls it, between sampler or image and its ending. No texelFetch has a form for cubes:
 * reads by texel see an array of faces. */
static const char *dimension(const struct access *access)
{
    enum dt_shape shape = access->resource->shape;
    bool faces = !is_storage(access) && !access->filter;
    if (!is_layered(access))
        return "2D";
    if (shape == DT_SHAPE_2D || (shape != DT_SHAPE_3D && faces))
        return "2DArray";
    return shape == DT_SHAPE_3D ? "3D" : shape == DT_SHAPE_CUBE ? "Cube" : "CubeArray";
}

void glsl_declared(const struct access *access, char *out, size_t size)
{
    snprintf(out, size, "%s%s%s", format_names(access->resource->format).prefix,
             is_storage(access) ? "image" : "sampler", dimension(access));
}

static bool is(const struct access *access, const char *name)
{
    return strcmp(dimension(access), name) == 0;
}

/* Where a sampler reads. */
static const char *coordinate_type(const struct access *access)
{
    return is(access, "2D") ? "vec2" : is(access, "CubeArray") ? "vec4" : "vec3";
}

/* Number of earlier accesses of this name with a binding; keeps variable names different. */
static uint32_t earlier(const struct glsl *glsl, const struct access *access)
{
    uint32_t count = 0;
    for (const struct access *other = glsl->pass->accesses; other < access; other++)
        count += other->resource && same_access(other, access) && other->binding >= 0;
    return count;
}

/* The GLSL variable: NAME_image or NAME_texture. Further accesses of the same name get a number at
 * the end. */
static const char *variable_name(const struct glsl *glsl, const struct access *access)
{
    const char *kind = is_storage(access) ? "image" : "texture";
    uint32_t number = earlier(glsl, access);
    const char *name =
        number ? arena_printf(glsl->model->arena, "%s_%s_%u", access_word(access), kind, number)
               : arena_printf(glsl->model->arena, "%s_%s", access_word(access), kind);
    return name ? name : access_word(access);
}

/* ---- Functions ------------------------------------------------------------------------------- */

/* Reads a texel by position. Only the first access of a name gets this function. If an access sees
 * one mip, the texture is a view of this mip, its level 0, so the pass may write another one. */
static void add_texel(const struct glsl *glsl, const struct access *access, struct text *out)
{
    const struct resource *image = access->resource;
    const char *variable = variable_name(glsl, access),
               *prefix = format_names(image->format).prefix;
    const char *position = is_layered(access) ? "ivec3" : "ivec2";
    bool depth = image->format == DT_FORMAT_D32F;
    text_add(out, "%s%s %s(%s p)\n{\n    return ", depth ? "" : prefix, depth ? "float" : "vec4",
             access_word(access), position);
    text_add(out, is_storage(access) ? "imageLoad(%s, p)" : "texelFetch(%s, p, 0)", variable);
    text_add(out, "%s;\n}\n\n", depth ? ".x" : "");
}

static void add_size(const struct glsl *glsl, const struct access *access, struct text *out)
{
    const char *call = is_storage(access) ? "imageSize(" : "textureSize(";
    const char *mip = is_storage(access) ? "" : ", 0";
    const char *swizzle = is(access, "2DArray") || is(access, "CubeArray") ? ".xy" : "";
    text_add(out, "ivec%d %s_size()\n{\n    return %s%s%s)%s;\n}\n\n", is(access, "3D") ? 3 : 2,
             access_word(access), call, variable_name(glsl, access), mip, swizzle);
}

/* Whether exact pipelines filter it themselves, see templates/glsl/filter.glsl: fragments choose a
 * level of detail of their own, where there is more than one. */
static bool is_ours(const struct glsl *glsl, const struct access *access, bool chooses)
{
    const struct resource *image = access->resource;
    bool single = access->mip || !image->mips;
    return !glsl->pass->fast && (is(access, "2D") || is(access, "2DArray")) &&
           !format_is_integer(image->format) && access->filter->anisotropy <= 1 &&
           (!chooses || single || glsl->stage != STAGE_IS_FRAGMENT);
}

/* The colour of the border, as arguments of vec4: a channel that the format lacks is 0, alpha 1. */
static const char *border_of(const struct glsl *glsl, const struct access *access)
{
    const struct sampler *filter = access->filter;
    uint32_t channels = format_info(access->resource->format)->channels;
    bool white = filter->border == DT_BORDER_OPAQUE_WHITE;
    bool opaque = filter->border != DT_BORDER_TRANSPARENT_BLACK || channels < 4;
    return arena_printf(glsl->model->arena, "%d, %d, %d, %d", white, white && channels > 1,
                        white && channels > 2, opaque);
}

/* Functions of one image, by macros of filter.glsl: filter_texel_NAME, filter_level_NAME, and
 * filter_lod_NAME if the pass chooses levels. */
static void add_filter(const struct access *access, bool lod, struct text *out)
{
    static const char *const wraps[] = {[DT_WRAP_CLAMP] = "clamp",
                                        [DT_WRAP_REPEAT] = "repeat",
                                        [DT_WRAP_MIRROR] = "mirror",
                                        [DT_WRAP_BORDER] = "clamp"};
    const struct sampler *filter = access->filter;
    const char *name = access_word(access), *kind = is_layered(access) ? "2DArray" : "2D";
    text_add(out, "filter_%s(filter_texel_%s, sampler%s, filter_%s, filter_%s);\n",
             filter->wrap == DT_WRAP_BORDER ? "border" : "texel", name, kind, kind,
             wraps[filter->wrap]);
    text_add(out, "filter_%s(filter_level_%s, sampler%s, filter_texel_%s);\n",
             filter->linear ? "linear" : "nearest", name, kind, name);
    if (lod)
        text_add(out, "filter_%s_mip(filter_lod_%s, sampler%s, filter_level_%s);\n",
                 filter->linear_mip ? "linear" : "nearest", name, kind, name);
    text_add(out, "\n");
}

static void add_own_sample(const struct glsl *glsl, const struct access *access, bool lod,
                           const char *tail, struct text *out)
{
    text_add(out, "    return filter_%s_%s(%s, %s, %s, vec4(%s))%s;\n}\n\n", lod ? "lod" : "level",
             access_word(access), variable_name(glsl, access),
             is_layered(access) ? "uv" : "vec3(uv, 0.0)", lod ? "lod" : "0",
             border_of(glsl, access), tail);
}

static void add_sample(const struct glsl *glsl, const struct access *access, struct text *out)
{
    const struct resource *image = access->resource;
    const char *variable = variable_name(glsl, access),
               *prefix = format_names(image->format).prefix;
    const char *uv = coordinate_type(access);
    bool depth = image->format == DT_FORMAT_D32F;
    const char *tail = depth ? ".x" : "";
    const char *type = depth ? "float" : arena_printf(glsl->model->arena, "%svec4", prefix);
    bool lod = !access->mip && glsl_uses(glsl, "%s_sample_lod", access_word(access));
    bool plain = glsl_uses(glsl, "%s_sample", access_word(access));
    bool our_lod = lod && is_ours(glsl, access, false), our = plain && is_ours(glsl, access, true);
    if (our_lod || our)
        add_filter(access, our_lod, out);
    if (lod) {
        text_add(out, "%s %s_sample_lod(%s uv, float lod)\n{\n", type, access_word(access), uv);
        if (our_lod)
            add_own_sample(glsl, access, true, tail, out);
        else
            text_add(out, "    return textureLod(%s, uv, lod)%s;\n}\n\n", variable, tail);
    }
    if (!plain)
        return;
    text_add(out, "%s %s_sample(%s uv)\n{\n", type, access_word(access), uv);
    if (our)
        add_own_sample(glsl, access, false, tail, out);
    else if (glsl->stage == STAGE_IS_FRAGMENT && !access->mip)
        text_add(out, "    return texture(%s, uv)%s;\n}\n\n", variable, tail);
    else
        text_add(out, "    return textureLod(%s, uv, 0.0)%s;\n}\n\n", variable, tail);
}

/* textureLod has no form for shadow samplers of arrays and cubes; textureGrad with zero gradients
 * reads the first mip. Arrays of cubes have texture alone. */
static void add_compare(const struct glsl *glsl, const struct access *access, struct text *out)
{
    const char *call = is(access, "2D")     ? "textureLod(%s, vec3(uv, reference), 0.0)"
                       : is(access, "Cube") ? "textureGrad(%s, vec4(uv, reference), vec3(0.0), "
                                              "vec3(0.0))"
                       : is(access, "CubeArray")
                           ? "texture(%s, uv, reference)"
                           : "textureGrad(%s, vec4(uv, reference), vec2(0.0), vec2(0.0))";
    text_add(out, "float %s_compare(%s uv, float reference)\n{\n    return ", access_word(access),
             coordinate_type(access));
    text_add(out, call, variable_name(glsl, access));
    text_add(out, ";\n}\n\n");
}

static void add_store(const struct glsl *glsl, const struct access *access, struct text *out)
{
    const struct resource *image = access->resource;
    text_add(out, "void %s_store(%s p, %svec4 value)\n{\n    imageStore(%s, p, value);\n}\n\n",
             access_word(access), is_layered(access) ? "ivec3" : "ivec2",
             format_names(image->format).prefix, variable_name(glsl, access));
}

/* The names are those of GLSL's functions for elements of buffers, which also give the former value. */
static void add_atomics(const struct glsl *glsl, const struct access *access, struct text *out)
{
    static const char *const names[] = {"Add", "Min", "Max",      "And",
                                        "Or",  "Xor", "Exchange", "CompSwap"};
    const char *type = access->resource->format == DT_FORMAT_R32I ? "int" : "uint";
    if (access->resource->format != DT_FORMAT_R32I && access->resource->format != DT_FORMAT_R32UI)
        return;
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++) {
        const char *name =
            arena_printf(glsl->model->arena, "%s_atomic%s", access_word(access), names[i]);
        bool swap = i == DT_ARRAY_COUNT(names) - 1;
        if (!name || !glsl_uses(glsl, "%s", name))
            continue;
        text_add(out, "%s %s(%s p, ", type, name, is_layered(access) ? "ivec3" : "ivec2");
        text_add(out, swap ? "%s expected, %s value)\n" : "%s value)\n", type, type);
        text_add(out, "{\n    return imageAtomic%s(%s, p, %svalue);\n}\n\n", names[i],
                 variable_name(glsl, access), swap ? "expected, " : "");
    }
}

/* Its texels have no address. */
static bool samples_cube(const struct access *access)
{
    return access->filter && (is(access, "Cube") || is(access, "CubeArray"));
}

/* Whether this access defines the texel read `image(p)`. Of two accesses of this name, the one
 * without a sampler does, since it may be of another mip. */
static bool gives_texels(const struct glsl *glsl, const struct access *access)
{
    for (uint32_t i = 0; access->filter && i < glsl->pass->access_count; i++) {
        const struct access *other = &glsl->pass->accesses[i];
        if (!other->filter && same_access(other, access) && other->binding >= 0 &&
            other->mode != MODE_WRITE)
            return false;
    }
    return true;
}

/* ---- Texel buffers --------------------------------------------------------------------------- */

/* The fields of an element of a builtin by its words, from texelFetch(NAME_texels, ...). */
static const char vertex_reader[] =
    "SceneVertex scene_vertices_at(const uint i)\n{\n"
    "    int k = 5 * int(i);\n"
    "    uvec2 a = texelFetch(scene_vertices_texels, k).xy;\n"
    "    uvec2 b = texelFetch(scene_vertices_texels, k + 1).xy;\n"
    "    uvec2 c = texelFetch(scene_vertices_texels, k + 2).xy;\n"
    "    vec2 uv = uintBitsToFloat(texelFetch(scene_vertices_texels, k + 3).xy);\n"
    "    uvec2 e = texelFetch(scene_vertices_texels, k + 4).xy;\n"
    "    return SceneVertex(uintBitsToFloat(a.x), uintBitsToFloat(a.y), uintBitsToFloat(b.x),\n"
    "                       uintBitsToFloat(b.y), uintBitsToFloat(c.x), uintBitsToFloat(c.y),\n"
    "                       uv.x, uv.y, e.x, e.y);\n}\n\n"
    "int scene_vertices_length()\n{\n    int texels = textureSize(scene_vertices_texels);\n    "
    "return texels / 5;\n}\n\n";
static const char index_reader[] =
    "uint scene_indices_at(const uint i)\n{\n    return texelFetch(scene_indices_texels, "
    "int(i)).x;\n}\n\n"
    "int scene_indices_length()\n{\n    return textureSize(scene_indices_texels);\n}\n\n";

void glsl_texels(struct glsl *glsl)
{
    EACH(access, glsl->pass->accesses, glsl->pass->access_count) {
        if (access_is_texels(access) && glsl_uses(glsl, "%s", access->name))
            text_add(&glsl->parts[PART_FUNCTIONS], "%s",
                     access->builtin == DT_SCENE_VERTICES ? vertex_reader : index_reader);
    }
}

/* Whether the name is a colour target's variable in the body, so no function can have it. */
static bool names_target(const struct glsl *glsl, const struct access *access)
{
    for (uint32_t i = 0; i < glsl->pass->access_count; i++)
        if (same_access(&glsl->pass->accesses[i], access) &&
            glsl->pass->accesses[i].kind & DT_WRITE_COLOR)
            return true;
    return false;
}

void glsl_accessors(struct glsl *glsl)
{
    struct text *out = &glsl->parts[PART_FUNCTIONS];
    EACH(access, glsl->pass->accesses, glsl->pass->access_count) {
        if (!access_is_image(access) || access->binding < 0)
            continue;
        if (glsl_uses(glsl, "%s_size", access_word(access)) && !earlier(glsl, access))
            add_size(glsl, access, out);
        if (access->mode != MODE_WRITE && !is_compare(access) && !samples_cube(access) &&
            glsl_uses(glsl, "%s", access_word(access)) && gives_texels(glsl, access) &&
            !names_target(glsl, access))
            add_texel(glsl, access, out);
        if (access->mode != MODE_READ && glsl_uses(glsl, "%s_store", access_word(access)))
            add_store(glsl, access, out);
        if (access->mode == MODE_UPDATE && is_storage(access))
            add_atomics(glsl, access, out);
        if (access->filter && access->filter->compare &&
            glsl_uses(glsl, "%s_compare", access_word(access)))
            add_compare(glsl, access, out);
        else if (access->filter && !access->filter->compare)
            add_sample(glsl, access, out);
    }
}

/* ---- Declarations ---------------------------------------------------------------------------- */

static void add_image_access(struct glsl *glsl, const struct access *access, struct text *out)
{
    const struct resource *image = access->resource;
    const struct format_names names = format_names(image->format);
    const char *variable = variable_name(glsl, access);
    if (!glsl_uses(glsl, "%s", variable))
        return;
    text_add(out, "layout(");
    glsl_binding(access->binding, out);
    if (!is_storage(access)) {
        text_add(out, ") uniform %ssampler%s%s %s;\n", names.prefix, dimension(access),
                 is_compare(access) ? "Shadow" : "", variable);
        return;
    }
    bool reads = access->kind & DT_READ_STORAGE, writes = access->kind & DT_WRITE_STORAGE;
    text_add(out, ", %s) %suniform %simage%s %s;\n", names.layout,
             !writes                                ? "readonly "
             : !reads || access->mode == MODE_WRITE ? "writeonly "
                                                    : "",
             names.prefix, dimension(access), variable);
}

static void add_buffer_access(struct glsl *glsl, const struct access *access, struct text *out)
{
    const struct resource *buffer = access->resource;
    const char *element = glsl_element_type(buffer);
    if (glsl_uses(glsl, "%s_count", access_word(access))) {
        int64_t count = 0;
        if (expr_is_literal(buffer->count) && expr_eval(buffer->count, 0, 0, &count) == EXPR_OK) {
            text_add(out, "const int %s_count = %lld;\n", access_word(access), (long long)count);
        } else {
            text_add(out, "#define %s_count (", access_word(access));
            expr_emit_glsl(buffer->count, out);
            text_add(out, ")\n");
        }
    }
    if (glsl_uses(glsl, "%s_quads", access_word(access))) {
        uint32_t bytes =
            buffer->block ? buffer->block : expr_value(buffer->count, 0, 0, 0) * buffer->stride;
        text_add(out, "layout(std140, ");
        glsl_binding(access->binding, out);
        text_add(out, ") uniform %s_quads_block {\n    uvec4 %s_quads[%u];\n};\n",
                 access_word(access), access_word(access), bytes / 16);
    }
    if (!glsl_uses(glsl, "%s", access_word(access)))
        return;
    if (glsl->stage == STAGE_IS_VERTEX && access->mode != MODE_READ)
        return; /* only fragment and compute stages write */
    bool uniform = access->kind & DT_READ_UNIFORM;
    text_add(out, "layout(%s, ", uniform ? "std140" : "std430");
    glsl_binding(access->binding, out);
    text_add(out, ") %s %s_block {\n    %s %s[",
             uniform                     ? "uniform"
             : access->mode == MODE_READ ? "readonly buffer"
                                         : "buffer",
             access_word(access), element, access_word(access));
    int64_t count = 0;
    if (uniform && buffer->block)
        text_add(out, "%u", buffer->block / buffer->stride);
    else if (uniform && expr_eval(buffer->count, 0, 0, &count) == EXPR_OK)
        text_add(out, "%lld", (long long)count);
    text_add(out, "];\n};\n");
}

/* kind: of the access to it. */
static void add_builtin(struct glsl *glsl, enum dt_builtin builtin, unsigned kind, int binding,
                        struct text *out)
{
    static const char *const elements[SCENE_RESOURCES] = {"SceneVertex", "uint", "SceneMaterial",
                                                          "SceneObject", NULL};
    const char *name = scene_resources[builtin - DT_SCENE_VERTICES];
    const char *element = elements[builtin - DT_SCENE_VERTICES];
    if (binding < 0)
        return;
    if (kind & DT_READ_TEXTURE && element) {
        if (!glsl_uses(glsl, "%s_texels", name))
            return;
        text_add(out, "layout(");
        glsl_binding(binding, out);
        text_add(out, ") uniform usamplerBuffer %s_texels;\n", name);
    }
    if (!glsl_uses(glsl, "%s", name))
        return;
    bool uniform = kind & DT_READ_UNIFORM;
    text_add(out, "layout(%s", uniform ? "std140, " : element ? "std430, " : "");
    glsl_binding(binding, out);
    if (uniform)
        text_add(out, ") uniform %s_block {\n    %s %s[%d];\n};\n", name, element, name,
                 DT_MAX_MATERIALS);
    else if (element)
        text_add(out, ") readonly buffer %s_block {\n    %s %s[];\n};\n", name, element, name);
    else
        text_add(out, ") uniform sampler2DArray %s;\n", name);
}

static void add_targets(struct glsl *glsl, struct text *out)
{
    EACH(access, glsl->pass->accesses, glsl->pass->access_count) {
        if (access_is_image(access) && access->kind & DT_WRITE_COLOR && access->attachment >= 0)
            text_add(out, "layout(location = %d) out %svec4 %s;\n", access->attachment,
                     format_names(access->resource->format).prefix, access_word(access));
    }
}

void glsl_resources(struct glsl *glsl)
{
    struct text *out = &glsl->parts[PART_RESOURCES];
    const struct pass *pass = glsl->pass;
    bool materials = false, textures = false; /* listed */
    EACH(access, pass->accesses, pass->access_count) {
        if (access->resource && access->resource->internal)
            continue;
        if (access->resource && access->binding >= 0 && access_is_image(access))
            add_image_access(glsl, access, out);
        else if (access->resource && access->binding >= 0)
            add_buffer_access(glsl, access, out);
        else if (access->builtin && access->binding >= 0) {
            add_builtin(glsl, (enum dt_builtin)access->builtin, access->kind, access->binding, out);
            materials |= access->builtin == DT_SCENE_MATERIALS;
            textures |= access->builtin == DT_SCENE_TEXTURES;
        }
    }
    if (!materials)
        add_builtin(glsl, DT_SCENE_MATERIALS,
                    pass->uniform_materials ? DT_READ_UNIFORM : DT_READ_STORAGE,
                    pass->materials_binding, out);
    if (!textures)
        add_builtin(glsl, DT_SCENE_TEXTURES, DT_READ_TEXTURE, pass->textures_binding, out);
    if (glsl->stage == STAGE_IS_FRAGMENT && !glsl->whole)
        add_targets(glsl, out);
}

bool glsl_check_accesses(struct glsl *glsl)
{
    bool ok = true;
    EACH(access, glsl->pass->accesses, glsl->pass->access_count) {
        const struct resource *resource = access->resource;
        if (!resource)
            continue;
        if (access_is_image(access) && is_storage(access) &&
            !format_names(resource->format).layout) {
            diag_error(glsl->diag, access->loc,
                       "%s has a format that a dispatch cannot write: draw into it instead",
                       access->name);
            ok = false;
        }
        if (!access_is_image(access) && access->kind & DT_READ_UNIFORM &&
            (expr_reach(resource->count) || !std140_equals_std430(resource))) {
            diag_error(glsl->diag, access->loc,
                       "%s cannot be a uniform block: its count must not depend on the frame "
                       "and its elements must fill multiples of 16 bytes",
                       access->name);
            ok = false;
        }
    }
    return ok;
}
