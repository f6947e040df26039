/* glTF files against what the specification of glTF 2.0 and of its extensions says of them. Fixtures
 * live in a temporary folder. */
#include "image.h"
#include "scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <meshoptimizer.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- Fixtures -------------------------------------------------------------------------------- */

struct heard {
    int count[DT_ERROR + 1];
    char text[8192]; /* all warnings and errors */
};

static void hear(void *user, enum dt_level level, const char *message)
{
    struct heard *heard = user;
    size_t length = strlen(heard->text);
    heard->count[level]++;
    if (level >= DT_WARNING)
        snprintf(heard->text + length, sizeof heard->text - length, "%s\n", message);
}

static char folder[] = "/tmp/gltf_test.XXXXXX";

static int enter_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) && chdir(folder) == 0 ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[64];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

static void put(const char *name, const void *bytes, size_t size)
{
    FILE *file = fopen(name, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* Loads NAME with a camera and a light. */
static bool try(struct scene *scene, const char *name, struct heard *heard)
{
    const struct dt_log log = {hear, heard};
    char text[256];
    snprintf(text, sizeof text,
             "mesh: %s\ncamera: {eye: [0, 0, 5], target: [0, 0, 0], fov_y: 40}\n"
             "light: {kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1]}\n",
             name);
    put("scene.yaml", text, strlen(text));
    *heard = (struct heard){{0}, ""};
    return scene_load(scene, "scene.yaml", NULL, false, &log);
}

/* One triangle in one node, and where a file differs: parts of JSON. NULL: nothing more. */
struct file {
    const char *top, *node, *primitive, *attributes, *buffers; /* more; each begins with a comma */
    const char *accessors; /* all; NULL: the positions, three floats each, at the start */
    const char *views;     /* all; NULL: view 0 is all of the buffer */
    const void *bytes;     /* NULL: the positions */
    size_t size;
};

static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
#define POSITIONS "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"

static const char *more(const char *text)
{
    return text ? text : "";
}

/* `buffer`: the first keys of the buffer. For free(). */
static char *write_json(const struct file *file, const char *buffer)
{
    char *text, views[96];
    size_t size = file->bytes ? file->size : sizeof corners;
    snprintf(views, sizeof views, "{\"buffer\":0,\"byteLength\":%zu}", size);
    assert_true(asprintf(&text,
                         "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],"
                         "\"nodes\":[{\"mesh\":0%s}],\"meshes\":[{\"primitives\":[{\"attributes\":"
                         "{\"POSITION\":0%s}%s}]}],\"accessors\":[%s],\"bufferViews\":[%s],"
                         "\"buffers\":[{%s\"byteLength\":%zu}%s]%s}",
                         more(file->node), more(file->attributes), more(file->primitive),
                         file->accessors ? file->accessors : POSITIONS,
                         file->views ? file->views : views, buffer, size, more(file->buffers),
                         more(file->top)) >= 0);
    return text;
}

static void put_gltf(const struct file *file)
{
    char *text = write_json(file, "\"uri\":\"a.bin\",");
    put("a.bin", file->bytes ? file->bytes : corners, file->bytes ? file->size : sizeof corners);
    put("a.gltf", text, strlen(text));
    free(text);
}

static void load(struct scene *scene, const struct file *file)
{
    struct heard heard;
    put_gltf(file);
    if (!try(scene, "a.gltf", &heard))
        fail_msg("%s", heard.text);
    assert_string_equal(heard.text, "");
}

/* The file must fail, with one error that has this text. */
static void assert_refused(const struct file *file, const char *text)
{
    struct scene scene;
    struct heard heard;
    put_gltf(file);
    assert_false(try(&scene, "a.gltf", &heard));
    if (!strstr(heard.text, text))
        fail_msg("no '%s' in\n%s", text, heard.text);
    assert_int_equal(heard.count[DT_ERROR], 1);
}

/* The corner of a triangle whose position, rounded, is (x, y). */
static const struct dt_vertex *vertex_at(const struct scene *scene, float x, float y)
{
    for (uint32_t i = 0; i < scene->data.vertex_count; i++) {
        const struct dt_vertex *vertex = &scene->data.vertices[i];
        if (fabsf(vertex->position[0] - x) < 1e-4f && fabsf(vertex->position[1] - y) < 1e-4f)
            return vertex;
    }
    fail_msg("no vertex at %g, %g", (double)x, (double)y);
    return NULL;
}

static void assert_uv(const struct scene *scene, float x, float y, double u, double v)
{
    const struct dt_vertex *vertex = vertex_at(scene, x, y);
    assert_non_null(vertex);
    const float *uv = vertex ? vertex->uv : (const float[2]){0};
    if (!(fabs((double)uv[0] - u) < 1e-6 && fabs((double)uv[1] - v) < 1e-6))
        fail_msg("at %g, %g: %g, %g", (double)x, (double)y, (double)uv[0], (double)uv[1]);
}

/* ---- Numbers --------------------------------------------------------------------------------- */

#define UV_OF(type, normalized)                                                                    \
    POSITIONS ",{\"bufferView\":1,\"componentType\":" type ",\"count\":3,\"type\":\"VEC2\","       \
              "\"normalized\":" normalized "}"
#define VIEW(offset, length, more)                                                                 \
    "{\"buffer\":0,\"byteOffset\":" offset ",\"byteLength\":" length more "}"

/* Section 3.6.2.2: f = c / 255, c / 65535, max(c / 127, -1), max(c / 32767, -1). */
static void normalized_integers_become_fractions(void **state)
{
    (void)state;
    struct {
        float positions[9];
        union {
            uint8_t bytes[12];
            int8_t signed_bytes[12];
            uint16_t words[6];
            int16_t shorts[6];
        };
    } data = {.bytes = {255, 51, 0, 0, 0, 255, 0, 0, 102, 0, 0, 0}};
    struct file file = {.attributes = ",\"TEXCOORD_0\":1",
                        .accessors = UV_OF("5121", "true"),
                        .views = VIEW("0", "36", "") "," VIEW("36", "12", ",\"byteStride\":4"),
                        .bytes = &data,
                        .size = sizeof data};
    struct scene scene;
    memcpy(data.positions, corners, sizeof corners);
    load(&scene, &file);
    assert_uv(&scene, 0, 0, 1, 0.2);
    assert_uv(&scene, 1, 0, 0, 1);
    scene_free(&scene);
    memcpy(data.signed_bytes, (const int8_t[]){-128, 127, 0, 0, -127, 0}, 6);
    file.accessors = UV_OF("5120", "true");
    load(&scene, &file);
    assert_uv(&scene, 0, 0, -1, 1);
    assert_uv(&scene, 1, 0, -1, 0);
    scene_free(&scene);
    memcpy(data.words, (const uint16_t[]){65535, 13107, 0, 39321, 0, 0}, 12);
    file.accessors = UV_OF("5123", "true");
    load(&scene, &file);
    assert_uv(&scene, 0, 0, 1, 0.2);
    assert_uv(&scene, 1, 0, 0, 0.6);
    scene_free(&scene);
    memcpy(data.shorts, (const int16_t[]){-32768, 32767, -32767, 7, 0, 0}, 12);
    file.accessors = UV_OF("5122", "false"); /* KHR_mesh_quantization */
    file.top = ",\"extensionsRequired\":[\"KHR_mesh_quantization\"]";
    load(&scene, &file);
    assert_uv(&scene, 0, 0, -32768, 32767);
    assert_uv(&scene, 1, 0, -32767, 7);
    scene_free(&scene);
}

/* Elements of zeros, two of which are replaced; indices of bytes. */
static void sparse_accessors_replace_elements(void **state)
{
    (void)state;
    struct {
        uint16_t at[2];
        uint8_t indices[4];
        float values[6];
    } data = {{1, 3}, {0, 1, 3, 0}, {2, 0, 0, 0, 2, 0}};
    struct file file = {
        .primitive = ",\"indices\":1",
        .accessors =
            "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":2,"
            "\"indices\":{\"bufferView\":0,\"componentType\":5123},"
            "\"values\":{\"bufferView\":1}}},"
            "{\"bufferView\":2,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}",
        .views = VIEW("0", "4", "") "," VIEW("8", "24", "") "," VIEW("4", "4", ""),
        .bytes = &data,
        .size = sizeof data};
    struct scene scene;
    load(&scene, &file);
    assert_int_equal(scene.data.index_count, 3);
    assert_true(scene.bounds_max[0] == 2 && scene.bounds_max[1] == 2);
    scene_free(&scene);
    data.at[1] = 4;
    assert_refused(&file,
                   "accessors[0].sparse: its index 1 is 4; indices grow, below the count of 4");
    data.at[1] = 1;
    assert_refused(&file, "accessors[0].sparse: its index 1 is 1; indices grow");
}

/* Section 3.7.2.1: strip {i, i + 1 + i % 2, i + 2 - i % 2}, fan {i + 1, i + 2, 0}. All face +z. */
static void strips_and_fans_keep_their_front(void **state)
{
    (void)state;
    static const float strip[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    static const float fan[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    static const char accessor[] =
        "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}";
    struct file file = {.accessors = accessor, .size = sizeof strip};
    for (int mode = 5; mode <= 6; mode++) {
        struct scene scene;
        file.primitive = mode == 5 ? ",\"mode\":5" : ",\"mode\":6";
        file.bytes = mode == 5 ? strip : fan;
        load(&scene, &file);
        assert_int_equal(scene.data.index_count, 6);
        for (uint32_t i = 0; i < scene.data.vertex_count; i++)
            assert_true(scene.data.vertices[i].normal[2] > 0.999f);
        scene_free(&scene);
    }
}

static void wrong_numbers_are_named(void **state)
{
    (void)state;
    static const uint16_t indices[3] = {0, 1, 77};
    struct {
        float positions[9];
        uint16_t indices[3];
    } data;
    memcpy(data.positions, corners, sizeof corners);
    memcpy(data.indices, indices, sizeof indices);
    const struct file beyond = {
        .primitive = ",\"indices\":1",
        .accessors =
            POSITIONS ",{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}",
        .views = VIEW("0", "36", "") "," VIEW("36", "6", ""),
        .bytes = &data,
        .size = 42};
    assert_refused(&beyond, "a.gltf: accessors[1]: its index 2 is 77, and there are 3 vertices");
    static const float odd[9] = {0, 0, 0, INFINITY, 0, 0, 0, 1, 0};
    assert_refused(&(struct file){.bytes = odd, .size = sizeof odd},
                   "vertex 1 of mesh 0 has a number that is not finite");
    static const struct {
        struct file file;
        const char *text;
    } cases[] = {
        {{.attributes = ",\"NORMAL\":7"},
         "meshes[0].NORMAL: there is no accessors[7]; the file has 1"},
        {{.views = VIEW("4", "36", "")},
         "bufferViews[0]: bytes 4 to 40 lie outside of buffers[0], which has 36"},
        {{.views = VIEW("-4", "36", "")},
         "bufferViews[0].byteOffset: -4 is no whole number from 0"},
        {{.views = VIEW("0", "35", "")},
         "accessors[0].count: 3 elements do not fit into bufferViews[0]"},
        {{.views = VIEW("0", "36", ",\"byteStride\":8")},
         "bufferViews[0].byteStride: 8 is less than an element of accessors[0]"},
        {{.accessors = "{\"bufferView\":0,\"componentType\":5124,\"count\":3,\"type\":\"VEC3\"}"},
         "accessors[0].componentType: 5124, with this `type`, is not supported"},
        {{.accessors = "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}"},
         "accessors[0].type: has 2 components, and 3 are needed"},
        {{.accessors =
              "{\"bufferView\":0,\"componentType\":5126,\"count\":4294967296,\"type\":\"VEC3\"}"},
         "accessors[0].count: 4294967296 is no whole number"},
        {{.node = ",\"rotation\":[0,0,1]"}, "nodes[0].rotation: is no array of 4 numbers"},
        {{.primitive = ",\"mode\":9"}, "meshes[0].primitives.mode: 9 is none of 0 to 6"},
        {{.top = ",\"scene\":1"}, "scenes[0].scene: there is no scenes[1]; the file has 1"},
        {{.top = ",\"materials\":7"}, "`materials` is no array"},
        {{.top = ",}"}, "a.gltf:1:"},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++)
        assert_refused(&cases[i].file, cases[i].text);
}

/* ---- Textures -------------------------------------------------------------------------------- */

/* A picture of one texel. */
static void put_texel(const char *name, uint8_t red)
{
    struct heard heard = {{0}, ""};
    const struct dt_log log = {hear, &heard};
    assert_true(image_write_png(name, 1, 1, 3, (const uint8_t[3]){red, 2, 3}, &log));
}

#define TWO_SETS                                                                                   \
    .attributes = ",\"TEXCOORD_0\":1,\"TEXCOORD_1\":2", .primitive = ",\"material\":0",            \
    .accessors =                                                                                   \
        POSITIONS ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"},"      \
                  "{\"bufferView\":2,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}",       \
    .views = VIEW("0", "36", "") "," VIEW("36", "24", "") "," VIEW("60", "24", "")
#define TEXTURE(info)                                                                              \
    ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0" info "}}}],"    \
    "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"a%20b.png\"}]"
#define TRANSFORM(keys) ",\"extensions\":{\"KHR_texture_transform\":{" keys "}}"

/* The set that the material names, through its transform: scale, then turn counter-clockwise, then
 * move. The second example of KHR_texture_transform takes the lower left quadrant, turned. */
static void material_chooses_texture_coordinates(void **state)
{
    (void)state;
    const struct {
        float positions[9], first[6], second[6];
    } data = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 1, 0, 0, 1}, {0.5f, 0.25f, 3, 4, -1, 0}};
    static const struct {
        const char *top;
        double uv[3][2];
    } cases[] = {
        {TEXTURE(""), {{0, 0}, {1, 0}, {0, 1}}},
        {TEXTURE(",\"texCoord\":1"), {{0.5, 0.25}, {3, 4}, {-1, 0}}},
        {TEXTURE(TRANSFORM("\"offset\":[0.25,0.5],\"scale\":[0.5,2]")),
         {{0.25, 0.5}, {0.75, 0.5}, {0.25, 2.5}}},
        {TEXTURE(TRANSFORM("\"offset\":[0,1],\"rotation\":1.57079632679,\"scale\":[0.5,0.5]")),
         {{0, 1}, {0, 0.5}, {0.5, 1}}},
        {TEXTURE(",\"texCoord\":0" TRANSFORM("\"texCoord\":1,\"scale\":[2,1]")),
         {{1, 0.25}, {6, 4}, {-2, 0}}},
    };
    put_texel("a b.png", 1);
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        struct scene scene;
        load(&scene,
             &(struct file){TWO_SETS, .top = cases[i].top, .bytes = &data, .size = sizeof data});
        assert_uv(&scene, 0, 0, cases[i].uv[0][0], cases[i].uv[0][1]);
        assert_uv(&scene, 1, 0, cases[i].uv[1][0], cases[i].uv[1][1]);
        assert_uv(&scene, 0, 1, cases[i].uv[2][0], cases[i].uv[2][1]);
        scene_free(&scene);
    }
    assert_refused(
        &(struct file){.primitive = ",\"material\":0", .top = TEXTURE(",\"texCoord\":1")},
        "the texture of materials[0] needs TEXCOORD_1");
}

/* What scene textures cannot do is told once, with the name of the setting. */
static void samplers_are_told(void **state)
{
    (void)state;
    struct scene scene;
    struct heard heard;
    put_texel("a.png", 1);
    put_gltf(&(struct file){
        .top = ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}},"
               "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],"
               "\"textures\":[{\"source\":0,\"sampler\":0}],\"images\":[{\"uri\":\"a.png\"}],"
               "\"samplers\":[{\"wrapS\":33071,\"wrapT\":10497,\"magFilter\":9728}]"});
    assert_true(try(&scene, "a.gltf", &heard));
    assert_int_equal(heard.count[DT_WARNING], 2);
    assert_non_null(
        strstr(heard.text, "a.gltf: `wrapS` CLAMP_TO_EDGE of a sampler is not supported"));
    assert_non_null(
        strstr(heard.text, "a.gltf: `magFilter` NEAREST of a sampler is not supported"));
    scene_free(&scene);
}

/* Pictures in a data URI and in a buffer view; equal ones are one layer. */
static void embedded_pictures_are_layers(void **state)
{
    (void)state;
    static const char red[] = /* 1x1, red, by ImageMagick */
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/"
        "pLvAAAAAElFTkSuQmCC";
    char top[1024];
    struct scene scene;
    uint8_t data[4096] = {0};
    put_texel("a.png", 7);
    FILE *file = fopen("a.png", "rb");
    memcpy(data, corners, sizeof corners);
    size_t size = file ? fread(data + 36, 1, sizeof data - 36, file) : 0;
    assert_true(size > 0 && fclose(file) == 0);
    snprintf(top, sizeof top,
             ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}},"
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1}}},"
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":2}}}],"
             "\"textures\":[{\"source\":0},{\"source\":1},{\"source\":2}],"
             "\"images\":[{\"uri\":\"data:image/png;base64,%s\"},"
             "{\"bufferView\":1,\"mimeType\":\"image/png\"},"
             "{\"uri\":\"data:image/png;base64,%s\"}]",
             red, red);
    char views[128];
    snprintf(views, sizeof views,
             "{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":%zu}",
             size);
    load(&scene, &(struct file){.top = top, .views = views, .bytes = data, .size = 36 + size});
    assert_int_equal(scene.data.texture_layers, 2);
    const struct dt_material *materials = scene.data.materials;
    assert_int_equal(materials[0].texture, materials[2].texture);
    assert_int_equal(scene.data.texels[4 * materials[0].texture], 255);
    assert_int_equal(scene.data.texels[4 * materials[1].texture], 7);
    scene_free(&scene);
}

static void materials_are_those_of_the_file(void **state)
{
    (void)state;
    struct scene scene;
    put_texel("a.png", 1);
    load(&scene,
         &(struct file){
             .primitive = ",\"material\":1",
             .top =
                 ",\"extensionsRequired\":[\"KHR_materials_emissive_strength\"],\"materials\":[{},"
                 "{\"emissiveFactor\":[1,0.5,0],\"doubleSided\":true,\"extensions\":"
                 "{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4}},"
                 "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,0.75,1]}}]"});
    const struct dt_material *material = &scene.data.materials[scene.data.vertices[0].material];
    assert_true(material->albedo[0] == 0.25f && material->albedo[2] == 0.75f);
    assert_true(material->emission[0] == 4 && material->emission[1] == 2);
    scene_free(&scene);
    load(&scene, &(struct file){0}); /* section 3.7.2.1: the default material is white */
    assert_true(scene.data.materials[scene.data.vertices[0].material].albedo[1] == 1);
    scene_free(&scene);
}

/* What a material has beyond what scenes keep is told, each once. */
static void more_is_told(void **state)
{
    (void)state;
    struct scene scene;
    struct heard heard;
    static const char *const told[] = {
        "`normalTexture` is not supported", "the alpha of `baseColorFactor` is not supported",
        "`alphaMode` BLEND is not supported; materials without texture are opaque",
        "materials[2].baseColorFactor: 5 is not from 0 to 1", "animations are not supported"};
    put_texel("a.png", 1);
    put_gltf(&(struct file){
        .top =
            ",\"materials\":[{\"alphaMode\":\"MASK\",\"normalTexture\":{\"index\":0},"
            "\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.2]}},"
            "{\"alphaMode\":\"BLEND\"},{\"pbrMetallicRoughness\":{\"baseColorFactor\":[5,1,1,1]}}],"
            "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"a.png\"}],"
            "\"animations\":[{\"channels\":[],\"samplers\":[]}]"});
    assert_true(try(&scene, "a.gltf", &heard));
    for (size_t i = 0; i < DT_ARRAY_COUNT(told); i++)
        if (!strstr(heard.text, told[i]))
            fail_msg("not told: %s", told[i]);
    assert_int_equal(heard.count[DT_WARNING], DT_ARRAY_COUNT(told));
    scene_free(&scene);
    assert_refused(&(struct file){.top = ",\"materials\":[{\"emissiveFactor\":[0,-1,0]}]"},
                   "materials[0].emissiveFactor: -1 is negative");
}

/* ---- Extensions ------------------------------------------------------------------------------ */

static void unknown_extensions_are_named(void **state)
{
    (void)state;
    struct scene scene;
    struct heard heard;
    assert_refused(&(struct file){.top = ",\"extensionsUsed\":[\"EXT_none\"],"
                                         "\"extensionsRequired\":[\"EXT_none\"]"},
                   "a.gltf: it requires the extension EXT_none, which is not supported");
    put_gltf(&(struct file){.top = ",\"extensionsUsed\":[\"EXT_none\",\"EXT_none\"]"});
    assert_true(try(&scene, "a.gltf", &heard));
    assert_int_equal(heard.count[DT_WARNING], 1);
    assert_non_null(strstr(heard.text, "a.gltf: the extension EXT_none is not supported"));
    scene_free(&scene);
}

/* Positions and indices as meshoptimizer's encoders write them; the buffers of the views do not
 * exist, as the extension allows. */
static void meshopt_views_are_decompressed(void **state)
{
    (void)state;
    enum { ROOM = 512 };
    static const uint32_t indices[3] = {0, 1, 2};
    uint8_t data[ROOM];
    char views[640];
    struct scene scene;
    meshopt_encodeIndexVersion(1);
    size_t first = meshopt_encodeVertexBuffer(data, ROOM, corners, 3, 12);
    size_t second = meshopt_encodeIndexBuffer(data + first, ROOM - first, indices, 3);
    assert_true(first && second);
    snprintf(views, sizeof views,
             "{\"buffer\":1,\"byteLength\":36,\"extensions\":{\"EXT_meshopt_compression\":{"
             "\"buffer\":0,\"byteLength\":%zu,\"byteStride\":12,\"mode\":\"ATTRIBUTES\","
             "\"count\":3}}},"
             "{\"buffer\":1,\"byteLength\":6,\"extensions\":{\"EXT_meshopt_compression\":{"
             "\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"byteStride\":2,"
             "\"mode\":\"TRIANGLES\",\"count\":3}}}",
             first, first, second);
    struct file file = {
        .top = ",\"extensionsRequired\":[\"EXT_meshopt_compression\"]",
        .primitive = ",\"indices\":1",
        .accessors =
            POSITIONS ",{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}",
        .views = views,
        .buffers = ",{\"byteLength\":42}",
        .bytes = data,
        .size = first + second};
    load(&scene, &file);
    assert_int_equal(scene.data.index_count, 3);
    assert_true(scene.bounds_max[0] == 1 && scene.bounds_max[1] == 1);
    scene_free(&scene);
    data[0] = 0;
    assert_refused(&file, "bufferViews[0].EXT_meshopt_compression: cannot be decompressed");
    strstr(views, "\"byteStride\":12")[14] = '3';
    assert_refused(&file, "3 times 13 bytes of mode `ATTRIBUTES`");
}

/* ---- Nodes and containers -------------------------------------------------------------------- */

/* A matrix, and what makes the same of translation, rotation and scale: x to y, doubled, and 3 to
 * the right. */
static void nodes_have_a_matrix_or_its_parts(void **state)
{
    (void)state;
    static const char *const nodes[] = {
        ",\"matrix\":[0,2,0,0, -2,0,0,0, 0,0,2,0, 3,0,0,1]",
        ",\"translation\":[3,0,0],\"rotation\":[0,0,0.70710678,0.70710678],\"scale\":[2,2,2]"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(nodes); i++) {
        struct scene scene;
        load(&scene, &(struct file){.node = nodes[i]});
        assert_true(fabsf(scene.bounds_min[0] - 1) < 1e-5f &&
                    fabsf(scene.bounds_max[0] - 3) < 1e-5f);
        assert_true(fabsf(scene.bounds_min[1]) < 1e-5f && fabsf(scene.bounds_max[1] - 2) < 1e-5f);
        scene_free(&scene);
    }
}

/* Section 3.5.2: the hierarchy is strict trees, and a scene names roots. */
static void nodes_are_trees(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *nodes, *text;
    } cases[] = {
        {"0", "{\"children\":[1,1]},{\"mesh\":0}", "nodes[1] is a child of nodes[0] already"},
        {"0", "{\"children\":[1,2]},{\"children\":[2]},{\"mesh\":0}",
         "nodes[1].children: nodes[2] is a child of nodes[0] already; nodes are trees"},
        {"0", "{\"children\":[1]},{\"children\":[0]}", "nodes[0] is no root"},
        {"0,0", "{\"mesh\":0},{}", "nodes[0]: stands twice in the scene"},
        {"0,9", "{\"mesh\":0}", "there is no nodes[9]; the file has 1"},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        char text[512];
        struct scene scene;
        struct heard heard;
        snprintf(text, sizeof text,
                 "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[%s]}],\"nodes\":[%s],"
                 "\"meshes\":[{\"primitives\":[]}]}",
                 cases[i].scene, cases[i].nodes);
        put("a.gltf", text, strlen(text));
        assert_false(try(&scene, "a.gltf", &heard));
        if (!strstr(heard.text, cases[i].text))
            fail_msg("no '%s' in\n%s", cases[i].text, heard.text);
    }
}

/* Two hundred nodes with a mesh of a million triangles, which needs no byte of a buffer. */
static void many_triangles_are_refused_before_they_are_made(void **state)
{
    (void)state;
    char nodes[8192] = "", roots[2048] = "";
    for (int i = 1; i < 200; i++) {
        sprintf(nodes + strlen(nodes), "%s{\"mesh\":0}", i > 1 ? "," : "");
        sprintf(roots + strlen(roots), "%s%d", i > 1 ? "," : "", i - 1);
    }
    char *text;
    struct scene scene;
    struct heard heard;
    assert_true(asprintf(&text,
                         "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[%s]}],"
                         "\"nodes\":[%s],\"meshes\":[{\"primitives\":[{\"attributes\":"
                         "{\"POSITION\":0}}]}],\"accessors\":[{\"componentType\":5126,"
                         "\"count\":3000000,\"type\":\"VEC3\"}]}",
                         roots, nodes) >= 0);
    put("a.gltf", text, strlen(text));
    free(text);
    assert_false(try(&scene, "a.gltf", &heard));
    assert_non_null(strstr(heard.text, "199000000 triangles are too many"));
}

static void put_glb(const char *name, const char *json, uint32_t version)
{
    uint8_t bytes[2048] = "glTF";
    uint32_t length = (uint32_t)(strlen(json) + 3) & ~3u;
    const uint32_t header[] = {version, 12 + 8 + length + 8 + sizeof corners, length, 0x4e4f534a};
    const uint32_t binary[] = {sizeof corners, 0x004e4942};
    memcpy(bytes + 4, header, sizeof header);
    memset(bytes + 20, ' ', length);
    for (size_t i = 0; json[i]; i++)
        bytes[20 + i] = (uint8_t)json[i];
    memcpy(bytes + 20 + length, binary, sizeof binary);
    memcpy(bytes + 28 + length, corners, sizeof corners);
    put(name, bytes, 28 + length + sizeof corners);
}

static void containers_are_read(void **state)
{
    (void)state;
    struct scene scene;
    struct heard heard;
    char *text = write_json(&(struct file){0}, "");
    put_glb("a.glb", text, 2);
    put_glb("a.odd", text, 2); /* by its first bytes */
    put_glb("old.glb", text, 1);
    free(text);
    for (int i = 0; i < 2; i++) {
        if (!try(&scene, i ? "a.odd" : "a.glb", &heard))
            fail_msg("%s", heard.text);
        assert_int_equal(scene.data.index_count, 3);
        scene_free(&scene);
    }
    assert_false(try(&scene, "old.glb", &heard));
    assert_non_null(strstr(heard.text, "it is glTF 1; glTF 2 is supported"));
    assert_int_equal(truncate("a.glb", 300), 0);
    assert_false(try(&scene, "a.glb", &heard));
    assert_non_null(strstr(heard.text, "it is cut off"));
    text = write_json(&(struct file){0}, "\"uri\":\"data:application/octet-stream;base64,"
                                         "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\",");
    put("a.gltf", text, strlen(text));
    assert_true(try(&scene, "a.gltf", &heard));
    assert_true(scene.bounds_max[0] == 1 && scene.bounds_max[1] == 1);
    scene_free(&scene);
    char *digit = strstr(text, "AAAAAA");
    digit[4] = '!';
    put("a.gltf", text, strlen(text));
    assert_false(try(&scene, "a.gltf", &heard));
    assert_non_null(strstr(heard.text, "buffers[0].uri: the character 5 of the data is no base64"));
    free(text);
    put("a.gltf", "{\"asset\":{\"version\":\"1.0\"}}", 27);
    assert_false(try(&scene, "a.gltf", &heard));
    assert_non_null(strstr(heard.text, "it is glTF 1.0; glTF 2.0 is supported"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normalized_integers_become_fractions),
        cmocka_unit_test(sparse_accessors_replace_elements),
        cmocka_unit_test(strips_and_fans_keep_their_front),
        cmocka_unit_test(wrong_numbers_are_named),
        cmocka_unit_test(material_chooses_texture_coordinates),
        cmocka_unit_test(samplers_are_told),
        cmocka_unit_test(more_is_told),
        cmocka_unit_test(embedded_pictures_are_layers),
        cmocka_unit_test(materials_are_those_of_the_file),
        cmocka_unit_test(unknown_extensions_are_named),
        cmocka_unit_test(meshopt_views_are_decompressed),
        cmocka_unit_test(nodes_have_a_matrix_or_its_parts),
        cmocka_unit_test(nodes_are_trees),
        cmocka_unit_test(many_triangles_are_refused_before_they_are_made),
        cmocka_unit_test(containers_are_read),
    };
    return cmocka_run_group_tests_name("glTF", tests, enter_folder, remove_folder);
}
