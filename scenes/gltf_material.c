/* Materials of a glTF file: base colour, emission, texture and its coordinates; see gltf.h. */
#include "gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REPEAT = 10497, LINEAR = 9729, LINEAR_MIPMAP_LINEAR = 9987 };

static float clamp_unit(float x)
{
    return x > 0 ? (x < 1 ? x : 1) : 0; /* NaN becomes 0 */
}

/* ---- Images ---------------------------------------------------------------------------------- */

/* The image's bytes where the file has them: a data URI or a buffer view. NULL data: failed. */
static struct gltf_bytes embedded(struct gltf *gltf, struct gltf_item image, const char *uri)
{
    if (uri)
        return gltf_data_uri(gltf, image, uri);
    int32_t view = gltf_index(gltf, image, "bufferView", GLTF_VIEWS);
    if (view < 0)
        gltf_error(gltf, image, NULL, "has neither `uri` nor `bufferView`");
    return gltf->failed ? (struct gltf_bytes){NULL, 0} : gltf_view(gltf, (uint32_t)view);
}

/* Index in the mesh; -1: failed. */
static int32_t image_texture(struct gltf *gltf, struct mesh *mesh, uint32_t index)
{
    struct gltf_item image = gltf_item(gltf, GLTF_IMAGES, index);
    uint32_t *known = &gltf_object(gltf, image)->texture;
    struct mesh_texture texture = {0};
    const char *uri = gltf_text(image, "uri", NULL);
    if (*known || gltf->failed)
        return (int32_t)*known - 1;
    if (uri && strncmp(uri, "data:", 5) != 0) {
        texture.color = gltf_uri_path(gltf, image, uri);
    } else {
        struct gltf_bytes bytes = embedded(gltf, image, uri);
        texture.bytes = bytes.data ? malloc(bytes.size + 1) : NULL;
        texture.size = bytes.size;
        if (!texture.bytes || asprintf(&texture.color, "%s: images[%u]", gltf->path, index) < 0)
            texture.color = NULL;
        else
            memcpy(texture.bytes, bytes.data, bytes.size);
    }
    int32_t made = mesh_add_texture(mesh, texture);
    if (made < 0 && !gltf->failed)
        gltf_out_of_memory(gltf);
    *known = (uint32_t)(made + 1);
    return gltf->failed ? -1 : made;
}

static const char *sampler_value(uint32_t value)
{
    static const struct {
        uint32_t value;
        const char *name;
    } names[] = {{9728, "NEAREST"},
                 {LINEAR, "LINEAR"},
                 {9984, "NEAREST_MIPMAP_NEAREST"},
                 {9985, "LINEAR_MIPMAP_NEAREST"},
                 {9986, "NEAREST_MIPMAP_LINEAR"},
                 {33071, "CLAMP_TO_EDGE"},
                 {33648, "MIRRORED_REPEAT"}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++)
        if (names[i].value == value)
            return names[i].name;
    return "(unknown)";
}

/* The pipelines' sampler of scene textures repeats, and filters linearly between mips. */
static void check_sampler(struct gltf *gltf, struct gltf_item texture)
{
    int32_t index = gltf_index(gltf, texture, "sampler", GLTF_SAMPLERS);
    if (index < 0)
        return;
    struct gltf_item sampler = gltf_item(gltf, GLTF_SAMPLERS, (uint32_t)index);
    const struct {
        const char *key, *what;
        uint32_t expected;
    } keys[] = {{"wrapS", "textures repeat", REPEAT},
                {"wrapT", "textures repeat", REPEAT},
                {"magFilter", "textures are filtered linearly", LINEAR},
                {"minFilter", "textures are filtered linearly, with mips", LINEAR_MIPMAP_LINEAR}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(keys); i++) {
        uint32_t value = gltf_whole(gltf, sampler, keys[i].key, keys[i].expected);
        if (value != keys[i].expected)
            gltf_warn(gltf, "`%s` %s of a sampler is not supported; %s", keys[i].key,
                      sampler_value(value), keys[i].what);
    }
}

/* The mesh's texture of a textureInfo; -1: none, or failed. */
static int32_t find_texture(struct gltf *gltf, struct mesh *mesh, struct gltf_item info)
{
    int32_t index = gltf_index(gltf, info, "index", GLTF_TEXTURES);
    if (index < 0)
        return -1;
    struct gltf_item texture = gltf_item(gltf, GLTF_TEXTURES, (uint32_t)index);
    struct gltf_item webp = gltf_extension(gltf, texture, "EXT_texture_webp");
    int32_t source = gltf_index(gltf, texture, "source", GLTF_IMAGES);
    if (source < 0)
        source = gltf_index(gltf, webp, "source", GLTF_IMAGES);
    check_sampler(gltf, texture);
    if (source < 0)
        gltf_warn(gltf, "textures without a `source` are not supported; plain colour instead");
    return source < 0 ? -1 : image_texture(gltf, mesh, (uint32_t)source);
}

/* ---- Materials ------------------------------------------------------------------------------- */

static struct gltf_item base(struct gltf *gltf, struct gltf_item material, const char **color,
                             const char **texture)
{
    struct gltf_item glossy = gltf_extension(gltf, material, "KHR_materials_pbrSpecularGlossiness");
    *color = glossy.json ? "diffuseFactor" : "baseColorFactor";
    *texture = glossy.json ? "diffuseTexture" : "baseColorTexture";
    return glossy.json ? glossy : gltf_part(gltf, material, "pbrMetallicRoughness");
}

static float alpha_cutoff(struct gltf *gltf, struct gltf_item material)
{
    const char *mode = gltf_text(material, "alphaMode", "OPAQUE");
    if (strcmp(mode, "OPAQUE") == 0)
        return 0;
    if (strcmp(mode, "MASK") == 0)
        return clamp_unit(gltf_number(gltf, material, "alphaCutoff", 0.5f));
    gltf_warn(gltf, "`alphaMode` %.32s is not supported; what is less than half opaque is a hole",
              mode);
    return 0.5f;
}

/* Warns of properties that struct dt_material cannot hold. */
static void tell_more(struct gltf *gltf, struct gltf_item material, bool has_texture,
                      const char *color_key, const float color[4])
{
    const char *mode = gltf_text(material, "alphaMode", "OPAQUE");
    bool opaque = strcmp(mode, "OPAQUE") == 0;
    for (int i = 0; i < 3; i++)
        if (!(color[i] >= 0 && color[i] <= 1))
            gltf_warn(gltf, "materials[%u].%s: %g is not from 0 to 1; the nearest is taken",
                      material.index, color_key, (double)color[i]);
    if (!opaque && color[3] < 1)
        gltf_warn(gltf, "the alpha of `%s` is not supported; that of the texture is", color_key);
    else if (!opaque && !has_texture && strcmp(mode, "MASK") != 0)
        gltf_warn(gltf, "`alphaMode` %.32s is not supported; materials without texture are opaque",
                  mode);
    if (gltf_part(gltf, material, "emissiveTexture").json)
        gltf_warn(gltf, "`emissiveTexture` is not supported; `emissiveFactor` holds everywhere");
    if (gltf_part(gltf, material, "normalTexture").json)
        gltf_warn(gltf, "`normalTexture` is not supported; vertices have their normals");
}

/* Reports negative emission, and clears it. */
static void check_emission(struct gltf *gltf, struct gltf_item material, float emission[3])
{
    for (int i = 0; i < 3; i++)
        if (!(emission[i] >= 0)) {
            gltf_error(gltf, material, "emissiveFactor", "%g is negative", (double)emission[i]);
            emission[i] = 0;
        }
}

static struct dt_material take_material(struct gltf *gltf, struct mesh *mesh,
                                        struct gltf_item material)
{
    const char *color_key, *texture_key;
    struct gltf_item from = base(gltf, material, &color_key, &texture_key);
    struct gltf_item strong = gltf_extension(gltf, material, "KHR_materials_emissive_strength");
    struct dt_material result = {.texture = -1};
    float color[4] = {1, 1, 1, 1}, strength = gltf_number(gltf, strong, "emissiveStrength", 1);
    gltf_numbers(gltf, from, color_key, 4, color);
    gltf_numbers(gltf, material, "emissiveFactor", 3, result.emission);
    for (int i = 0; i < 3; i++) {
        result.albedo[i] = clamp_unit(color[i]);
        result.emission[i] *= strength;
    }
    check_emission(gltf, material, result.emission);
    result.texture = find_texture(gltf, mesh, gltf_part(gltf, from, texture_key));
    result.alpha_cutoff = result.texture >= 0 ? alpha_cutoff(gltf, material) : 0;
    tell_more(gltf, material, result.texture >= 0, color_key, color);
    return result;
}

bool gltf_materials(struct gltf *gltf, struct mesh *mesh)
{
    uint32_t count = gltf->list[GLTF_MATERIALS].count;
    mesh->materials = calloc(count + 1, sizeof *mesh->materials);
    if (!mesh->materials)
        return gltf_out_of_memory(gltf);
    for (uint32_t i = 0; i < count && !gltf->failed; i++)
        mesh->materials[i] = take_material(gltf, mesh, gltf_item(gltf, GLTF_MATERIALS, i));
    mesh->materials[count] = (struct dt_material){.albedo = {1, 1, 1}, .texture = -1};
    mesh->material_count = count + 1;
    return !gltf->failed;
}

/* KHR_texture_transform turns counter-clockwise as seen, with v downwards. Its text and its example
 * say so, and viewers do; its GLSL has the other sign. */
uint32_t gltf_mapping(struct gltf *gltf, uint32_t material, struct mesh_part *part)
{
    const char *color_key, *texture_key;
    struct gltf_item from = {NULL, GLTF_MATERIALS, material};
    if (material < gltf->list[GLTF_MATERIALS].count)
        from = base(gltf, gltf_item(gltf, GLTF_MATERIALS, material), &color_key, &texture_key);
    struct gltf_item info = from.json ? gltf_part(gltf, from, texture_key) : from;
    struct gltf_item transform = gltf_extension(gltf, info, "KHR_texture_transform");
    float offset[2] = {0, 0}, scale[2] = {1, 1};
    float angle = gltf_number(gltf, transform, "rotation", 0);
    gltf_numbers(gltf, transform, "offset", 2, offset);
    gltf_numbers(gltf, transform, "scale", 2, scale);
    const float u[3] = {cosf(angle) * scale[0], sinf(angle) * scale[1], offset[0]};
    const float v[3] = {-sinf(angle) * scale[0], cosf(angle) * scale[1], offset[1]};
    memcpy(part->u, u, sizeof u);
    memcpy(part->v, v, sizeof v);
    return gltf_whole(gltf, transform, "texCoord", gltf_whole(gltf, info, "texCoord", 0));
}
