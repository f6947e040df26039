/* The textures of a mesh as one array: one size, full mip chain, averaged in linear light. */
#include "image.h"
#include "image_oiio.h"
#include "mesh.h"
#include "picture_size.h"
#include "scene.h"
#include "srgb.h"
#include "base/log.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { DEFAULT_LIMIT = 1024, ENCODE_STEPS = 65536 };
/* Of all layers together, with mips; and of the pictures that become layers. */
#define MOST_BYTES ((size_t)2 << 30)
/* Pixels that are decoded, and texels of layers, for any files, and more for each of their bytes: a
 * picture of one colour has a thousand pixels a byte, one of a scene fewer than ten. */
#define MOST_PIXELS ((uint64_t)1 << 27)
enum { PIXELS_PER_BYTE = 16 };

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
        tables->encode[i] = (uint8_t)lround(255 * srgb_code(light));
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

static void shrink_texture(const struct srgb *srgb, const uint8_t *source, uint32_t size,
                           uint8_t *target)
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
        report_message(log, DT_WARNING, "%s; plain colour instead", message);
    else
        report_message(log, level, "%s", message);
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* A picture that is open for reading by name. */
struct opened {
    char path[64];    /* of the descriptor */
    const char *name; /* that path, or that of the texture's file */
    int file;         /* -1: none */
};

/* A picture inside the mesh file goes to a file in memory, so that all are read by name. */
static bool open_texture(const struct mesh_texture *texture, struct opened *opened,
                         const struct dt_log *log)
{
    *opened = (struct opened){.name = texture->color, .file = -1};
    if (!texture->bytes)
        return true;
    size_t done = 0;
    opened->file = memfd_create("texture", MFD_CLOEXEC);
    for (ssize_t got = 0;
         opened->file >= 0 && got >= 0 && done<texture->size; done += got> 0 ? (size_t)got : 0)
        got = write(opened->file, texture->bytes + done, texture->size - done);
    if (opened->file < 0 || done < texture->size) {
        report_error(log, "%s: %s", texture->color, strerror(errno));
        if (opened->file >= 0)
            close(opened->file);
        return false;
    }
    snprintf(opened->path, sizeof opened->path, "/proc/self/fd/%d", opened->file);
    opened->name = opened->path;
    return true;
}

static void close_texture(const struct opened *opened)
{
    if (opened->file >= 0)
        close(opened->file);
}

/* ---- Layers ---------------------------------------------------------------------------------- */

/* The layers of the array: one for each distinct texture. */
struct layers {
    struct mesh *mesh;
    const struct dt_log *log;
    struct stat *files; /* of colour and opacity of each texture; a device and inode of 0: none */
    uint32_t *textures; /* of layers */
    int32_t *layer_of;  /* of textures; -1: it cannot be read */
    bool *has_holes;
    uint32_t count, size, mips;
    size_t chain; /* bytes of a layer with its mips */
};

static void free_layers(struct layers *layers)
{
    free(layers->files);
    free(layers->textures);
    free(layers->layer_of);
    free(layers->has_holes);
}

static bool allocate_layers(struct layers *layers)
{
    size_t count = (size_t)layers->mesh->texture_count + 1;
    layers->files = calloc(2 * count, sizeof *layers->files);
    layers->textures = calloc(count, sizeof *layers->textures);
    layers->layer_of = calloc(count, sizeof *layers->layer_of);
    layers->has_holes = calloc(count, sizeof *layers->has_holes);
    return layers->files && layers->textures && layers->layer_of && layers->has_holes;
}

/* A file may have many names. Two that are missing are the same if their names are. */
static bool same_file(const char *a, const char *b, const struct stat *of_a,
                      const struct stat *of_b)
{
    if (!a || !b)
        return a == b;
    return of_a->st_dev == of_b->st_dev && of_a->st_ino == of_b->st_ino &&
           (of_a->st_ino || strcmp(a, b) == 0);
}

static bool same_texture(const struct layers *layers, uint32_t i, uint32_t j)
{
    const struct mesh_texture *a = &layers->mesh->textures[i], *b = &layers->mesh->textures[j];
    const struct stat *files = layers->files;
    if (a->bytes || b->bytes)
        return a->bytes && b->bytes && a->size == b->size &&
               memcmp(a->bytes, b->bytes, a->size) == 0;
    return same_file(a->color, b->color, &files[2 * i], &files[2 * j]) &&
           same_file(a->opacity, b->opacity, &files[2 * i + 1], &files[2 * j + 1]);
}

/* Gives every distinct texture a layer. */
static void assign_layers(struct layers *layers)
{
    const struct mesh *mesh = layers->mesh;
    for (uint32_t i = 0; i < mesh->texture_count; i++) {
        const struct mesh_texture *texture = &mesh->textures[i];
        uint32_t layer = 0;
        if (!texture->bytes)
            stat(texture->color, &layers->files[2 * i]);
        if (texture->opacity)
            stat(texture->opacity, &layers->files[2 * i + 1]);
        while (layer < layers->count && !same_texture(layers, i, layers->textures[layer]))
            layer++;
        if (layer == layers->count)
            layers->textures[layers->count++] = i;
        layers->layer_of[i] = (int32_t)layer;
    }
}

/* The size of a picture, from its header; 0: unknown. */
static uint64_t header_size(const char *path, uint32_t *side)
{
    const struct dt_log quiet = {0};
    uint32_t width, height;
    const char *reason;
    if (!picture_size(path, &width, &height, &reason) && !image_size(path, &width, &height, &quiet))
        return 0;
    if ((uint64_t)width * height > IMAGE_MOST_PIXELS)
        return 0; /* it is not decoded */
    *side = width > *side ? width : *side;
    *side = height > *side ? height : *side;
    return (uint64_t)width * height;
}

static void choose_size(struct layers *layers, uint32_t size)
{
    layers->size = size;
    layers->mips = 1;
    layers->chain = 4;
    for (uint32_t s = size; s > 1; s /= 2, layers->mips++)
        layers->chain += (size_t)4 * s * s;
}

/* Pixels of all pictures and bytes of their files. */
struct work {
    uint64_t pixels, bytes;
    uint32_t largest; /* side of a picture */
};

static bool add_up(const struct layers *layers, struct work *work)
{
    *work = (struct work){.largest = 1};
    for (uint32_t i = 0; i < layers->count; i++) {
        uint32_t number = layers->textures[i];
        const struct mesh_texture *texture = &layers->mesh->textures[number];
        struct opened opened;
        if (!open_texture(texture, &opened, layers->log))
            return false;
        work->pixels += header_size(opened.name, &work->largest);
        close_texture(&opened);
        work->pixels += texture->opacity ? header_size(texture->opacity, &(uint32_t){0}) : 0;
        work->bytes += texture->bytes ? texture->size : (uint64_t)layers->files[2 * number].st_size;
        work->bytes += (uint64_t)layers->files[2 * number + 1].st_size;
    }
    return true;
}

/* Whether the pictures and layers of this size take no longer than their files deserve. */
static bool is_affordable(const struct layers *layers, const struct work *work)
{
    uint64_t texels = (uint64_t)layers->count * layers->size * layers->size;
    return work->pixels + texels <= MOST_PIXELS + PIXELS_PER_BYTE * work->bytes;
}

/* Chooses the size of the layers; 0: by the largest picture, or what the limits leave. Refuses, before
 * any picture is decoded, what takes too much. */
static bool plan_layers(struct layers *layers, uint32_t wanted)
{
    struct work work;
    uint32_t size = 1;
    if (!add_up(layers, &work))
        return false;
    while (size < DEFAULT_LIMIT && size < work.largest)
        size *= 2;
    choose_size(layers, wanted ? wanted : size);
    while (!wanted && layers->size > 1 &&
           (layers->count > MOST_BYTES / layers->chain || !is_affordable(layers, &work)))
        choose_size(layers, layers->size / 2);
    bool fits = layers->count <= MOST_BYTES / layers->chain;
    if (fits && !is_affordable(layers, &work))
        report_error(layers->log,
                     "the scene's textures have %llu pixels, for %u layers of %ux%u, in files of "
                     "%llu bytes; use smaller ones%s",
                     (unsigned long long)work.pixels, layers->count, layers->size, layers->size,
                     (unsigned long long)work.bytes,
                     wanted ? ", or lower `texture_size` in the scene file" : "");
    else if (!fits)
        report_error(layers->log,
                     "%u textures of %ux%u take %zu MiB; %zu is the limit; lower `texture_size` in "
                     "the scene file",
                     layers->count, layers->size, layers->size,
                     (layers->count * layers->chain) >> 20, MOST_BYTES >> 20);
    else
        return true;
    return false;
}

/* Reads a texture into a layer. */
static bool load_layer(const struct layers *layers, const struct mesh_texture *texture,
                       uint8_t *layer, const struct dt_log *warn)
{
    uint32_t width = layers->size, height = layers->size;
    struct opened opened;
    uint8_t *image;
    if (!open_texture(texture, &opened, warn))
        return false;
    bool good = image_read_rgba8(opened.name, &width, &height, &image, warn);
    if (good)
        image_check_claims(opened.name, IMAGE_AS_SRGB, warn);
    close_texture(&opened);
    if (!good)
        return false;
    memcpy(layer, image, (size_t)4 * width * height);
    free(image);
    if (texture->opacity)
        merge_opacity(layer, texture->opacity, layers->size, warn);
    return true;
}

/* Loads layer after layer into mip 0. Layers that cannot be read are left out. */
static void load_layers(struct layers *layers, uint8_t *texels)
{
    const struct dt_log warn = {as_warning, (void *)layers->log};
    struct mesh *mesh = layers->mesh;
    size_t bytes = (size_t)4 * layers->size * layers->size;
    uint32_t loaded = 0;
    for (uint32_t i = 0; i < layers->count; i++) {
        uint8_t *layer = texels + loaded * bytes;
        bool good = load_layer(layers, &mesh->textures[layers->textures[i]], layer, &warn);
        for (size_t t = 3; good && t < bytes; t += 4)
            layers->has_holes[loaded] |= layer[t] < 255;
        for (uint32_t k = layers->textures[i]; k < mesh->texture_count; k++)
            if (layers->layer_of[k] == (int32_t)i)
                layers->layer_of[k] = good ? (int32_t)loaded : -1;
        loaded += good;
    }
    layers->count = loaded;
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
            shrink_texture(srgb, source + layer * bytes, size, target + layer * (bytes / 4));
        source = target;
    }
}

/* A scene without textures has one white texel, since bindings need a texture. */
static void set_white(uint8_t *texels, struct dt_scene *scene)
{
    memset(texels, 255, 4);
    scene->texture_width = scene->texture_height = scene->texture_layers = scene->texture_mips = 1;
}

static bool layers_out_of_memory(const struct layers *layers)
{
    return report_error(
        layers->log,
        "out of memory for %u textures of %ux%u; lower `texture_size` in the scene file",
        layers->count, layers->size, layers->size);
}

/* Fills the scene's texels. */
static bool fill(struct layers *layers, struct dt_scene *scene)
{
    uint8_t *texels = malloc((layers->count ? layers->count : 1) * layers->chain);
    struct srgb *srgb = srgb_tables();
    if (!texels || !srgb) {
        free(texels);
        free(srgb);
        return layers_out_of_memory(layers);
    }
    load_layers(layers, texels);
    complete_materials(layers->mesh, layers->layer_of, layers->has_holes);
    build_mips(srgb, texels, layers->size, layers->count);
    scene->texture_width = scene->texture_height = layers->size;
    scene->texture_layers = layers->count;
    scene->texture_mips = layers->mips;
    if (layers->count == 0)
        set_white(texels, scene);
    scene->texels = texels;
    free(srgb);
    return true;
}

bool texture_array(struct dt_scene *scene, struct mesh *mesh, uint32_t size,
                   const struct dt_log *log)
{
    struct layers layers = {.mesh = mesh, .log = log};
    bool good = allocate_layers(&layers) || layers_out_of_memory(&layers);
    if (good) {
        assign_layers(&layers);
        good = plan_layers(&layers, size) && fill(&layers, scene);
    }
    free_layers(&layers);
    return good;
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
