/* The textures of a mesh as one array: one size, full mip chain, averaged in linear light.
 * Called by scene.c. */
#include "image.h"
#include "mesh.h"
#include "scene.h"
#include "srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_LIMIT = 1024, ENCODE_STEPS = 65536 };

/* sRGB codes to linear light and back (IEC 61966-2-1). `encode` is so fine that every code survives
 * the round trip. */
struct srgb {
    float decode[256];
    uint8_t encode[ENCODE_STEPS];
};

static struct srgb *srgb_tables(void)
{
    struct srgb *tables = malloc(sizeof *tables);
    if (!tables)
        return NULL;
    srgb_decode_table(tables->decode);
    for (int i = 0; i < ENCODE_STEPS; i++) {
        double light = i / (double)(ENCODE_STEPS - 1);
        double code = light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
        tables->encode[i] = (uint8_t)lround(255 * code);
    }
    return tables;
}

/* Average of a 2x2 block (or 1x2, 2x1 at the end of the chain). Colour counts by its alpha, so
 * that the colour behind holes does not bleed into the edges of leaves. */
static void average(const struct srgb *srgb, const uint8_t *const texel[4], uint8_t out[4])
{
    float color[3] = {0}, plain[3] = {0}, alpha = 0;
    for (int k = 0; k < 4; k++) {
        alpha += texel[k][3];
        for (int i = 0; i < 3; i++) {
            color[i] += texel[k][3] * srgb->decode[texel[k][i]];
            plain[i] += srgb->decode[texel[k][i]];
        }
    }
    for (int i = 0; i < 3; i++) {
        float light = alpha > 0 ? color[i] / alpha : plain[i] / 4;
        out[i] = srgb->encode[(int)(fminf(light, 1) * (ENCODE_STEPS - 1) + 0.5f)];
    }
    out[3] = (uint8_t)(alpha / 4 + 0.5f);
}

static void shrink(const struct srgb *srgb, const uint8_t *source, uint32_t size, uint8_t *target)
{
    uint32_t half = size / 2;
    for (uint32_t y = 0; y < half; y++)
        for (uint32_t x = 0; x < half; x++) {
            const uint8_t *corner = source + 4 * ((size_t)2 * y * size + 2 * x);
            const uint8_t *const block[4] = {corner, corner + 4, corner + 4 * size,
                                             corner + 4 * size + 4};
            average(srgb, block, target + 4 * ((size_t)y * half + x));
        }
}

/* Puts the red of the opacity map into the alpha. */
static bool merge_opacity(uint8_t *texels, const char *path, uint32_t size,
                          const struct dt_log *log)
{
    uint8_t *opacity;
    uint32_t width = size, height = size;
    if (!image_read_rgba8(path, &width, &height, &opacity, log))
        return false;
    for (size_t i = 0; i < (size_t)size * size; i++)
        texels[4 * i + 3] = (uint8_t)(opacity[4 * i] * opacity[4 * i + 3] / 255);
    free(opacity);
    return true;
}

/* A texture that is missing does not stop the scene: the error becomes a warning. */
static void as_warning(void *user, enum dt_level level, const char *message)
{
    const struct dt_log *log = user;
    if (level == DT_ERROR)
        log_message(log, DT_WARNING, "%s; plain colour instead", message);
    else
        log_message(log, level, "%s", message);
}

static uint32_t default_size(const struct mesh *mesh, const struct dt_log *quiet)
{
    uint32_t size = 1;
    for (uint32_t i = 0; i < mesh->texture_count; i++) {
        uint32_t width, height;
        if (!image_size(mesh->textures[i].color, &width, &height, quiet))
            continue;
        while (size < DEFAULT_LIMIT && (size < width || size < height))
            size *= 2;
    }
    return size;
}

/* Loads layer after layer into mip 0; layer_of[i] is the layer of texture i, -1 if it could not be
 * read. Returns the number of layers. */
static uint32_t load_layers(uint8_t *texels, uint32_t size, const struct mesh *mesh,
                            int32_t *layer_of, bool *has_holes, const struct dt_log *warn)
{
    uint32_t layers = 0;
    size_t bytes = (size_t)4 * size * size;
    for (uint32_t i = 0; i < mesh->texture_count; i++) {
        const struct mesh_texture *texture = &mesh->textures[i];
        uint32_t width = size, height = size;
        uint8_t *image;
        layer_of[i] = -1;
        if (!image_read_rgba8(texture->color, &width, &height, &image, warn))
            continue;
        uint8_t *layer = texels + layers * bytes;
        memcpy(layer, image, bytes);
        free(image);
        if (texture->opacity)
            merge_opacity(layer, texture->opacity, size, warn);
        for (size_t t = 3; t < bytes; t += 4)
            has_holes[layers] |= layer[t] < 255;
        layer_of[i] = (int32_t)layers++;
    }
    return layers;
}

static void complete_materials(struct mesh *mesh, const int32_t *layer_of, const bool *has_holes)
{
    for (uint32_t i = 0; i < mesh->material_count; i++) {
        struct dt_material *material = &mesh->materials[i];
        material->texture = material->texture < 0 ? -1 : layer_of[material->texture];
        if (material->texture < 0 || !has_holes[material->texture])
            material->alpha_cutoff = 0;
    }
}

/* Mip 0 of all layers, then mip 1 of all layers, ...; `texels` has room for the chain of
 * `layers` layers. */
static void build_mips(const struct srgb *srgb, uint8_t *texels, uint32_t size, uint32_t layers)
{
    for (uint8_t *source = texels; size > 1; size /= 2) {
        size_t bytes = (size_t)4 * size * size;
        uint8_t *target = source + layers * bytes;
        for (uint32_t layer = 0; layer < layers; layer++)
            shrink(srgb, source + layer * bytes, size, target + layer * (bytes / 4));
        source = target;
    }
}

/* A scene without textures has one white texel, since bindings need a texture. */
static void set_white(uint8_t *texels, struct dt_scene *scene)
{
    memset(texels, 255, 4);
    scene->texture_width = scene->texture_height = scene->texture_layers = scene->texture_mips = 1;
}

bool texture_array(struct dt_scene *scene, struct mesh *mesh, uint32_t size,
                   const struct dt_log *log)
{
    const struct dt_log warn = {as_warning, (void *)log}, quiet = {0};
    if (size == 0)
        size = default_size(mesh, &quiet);
    uint32_t mips = 1;
    size_t chain = 4; /* bytes of one layer with its mips */
    for (uint32_t s = size; s > 1; s /= 2, mips++)
        chain += (size_t)4 * s * s;
    uint32_t count = mesh->texture_count ? mesh->texture_count : 1;
    uint8_t *texels = malloc(count * chain);
    int32_t *layer_of = calloc(count, sizeof *layer_of);
    bool *has_holes = calloc(count, sizeof *has_holes);
    struct srgb *srgb = srgb_tables();
    bool ok = texels && layer_of && has_holes && srgb;
    if (ok) {
        uint32_t layers = load_layers(texels, size, mesh, layer_of, has_holes, &warn);
        complete_materials(mesh, layer_of, has_holes);
        build_mips(srgb, texels, size, layers);
        scene->texture_width = scene->texture_height = size;
        scene->texture_layers = layers;
        scene->texture_mips = mips;
        if (layers == 0)
            set_white(texels, scene);
        scene->texels = texels;
    } else {
        log_message(
            log, DT_ERROR,
            "out of memory for %u textures of %ux%u; lower `texture_size` in the scene file",
            mesh->texture_count, size, size);
        free(texels);
    }
    free(layer_of);
    free(has_holes);
    free(srgb);
    return ok;
}

size_t scene_texel_bytes(const struct dt_scene *data)
{
    size_t size = 0;
    for (uint32_t mip = 0; mip < data->texture_mips; mip++) {
        size_t width = data->texture_width >> mip, height = data->texture_height >> mip;
        size += (width ? width : 1) * (height ? height : 1) * data->texture_layers * 4;
    }
    return size;
}
