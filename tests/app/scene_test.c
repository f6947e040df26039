/* Scenes, meshes, textures, frames and image files against facts from outside: published
 * measurements, formulas, invariants of closed surfaces. Run from the root of the repository
 * (reads scenes/ and build/scenes/); fixtures live in a temporary folder. The OpenImageIO shim
 * must lie beside this program or in the folder above it. */
#include "child.h"
#include "diptych_scene.h"
#include "image.h"
#include "base/log.h"
#include "mesh.h"
#include "motion.h"
#include "scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <png.h>

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define PI     3.14159265358979323846
#define CAMERA "camera: {eye: [0, 0, 5], target: [0, 0, 0], fov_y: 40}\n"
#define SUN    "light: {kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1]}\n"

/* ---- Fixtures -------------------------------------------------------------------------------- */

struct heard {
    int count[DT_ERROR + 1];
    char text[8192]; /* the latest warning or error */
};

/* Of the present test. */
static struct scene scene;
static struct heard heard;

static void hear(void *user, enum dt_level level, const char *message)
{
    (void)user;
    heard.count[level]++;
    if (level >= DT_WARNING)
        snprintf(heard.text, sizeof heard.text, "%s", message);
}

static const struct dt_log hearing = {hear, NULL};

static int forget(void **state)
{
    (void)state;
    scene_free(&scene);
    memset(&heard, 0, sizeof heard);
    return 0;
}

static char folder[] = "/tmp/scene_test.XXXXXX";

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[64];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

/* Path of a fixture; valid until the fourth call after. */
static const char *at(const char *name)
{
    static char paths[4][256];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void put(const char *name, const char *text)
{
    FILE *file = fopen(at(name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void load(const char *path)
{
    scene_free(&scene);
    if (!scene_load(&scene, path, NULL, false, &hearing))
        fail_msg("%s", heard.text);
}

/* Loads a scene with this mesh, and other keys. */
static void load_mesh(const char *mesh, const char *keys)
{
    char text[512];
    snprintf(text, sizeof text, "mesh: %s\n%s" CAMERA SUN, mesh, keys);
    put("mesh.yaml", text);
    load(at("mesh.yaml"));
}

/* ---- Geometry -------------------------------------------------------------------------------- */

struct vec {
    double x, y, z;
};

static struct vec position(uint32_t corner)
{
    const float *p = scene.data.vertices[scene.data.indices[corner]].position;
    return (struct vec){p[0], p[1], p[2]};
}

static struct vec sub(struct vec a, struct vec b)
{
    return (struct vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static struct vec cross(struct vec a, struct vec b)
{
    return (struct vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static double dot(struct vec a, struct vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Twice the area, along the face's normal. */
static struct vec area_vector(uint32_t triangle)
{
    struct vec a = position(3 * triangle);
    return cross(sub(position(3 * triangle + 1), a), sub(position(3 * triangle + 2), a));
}

static struct vec vertex_normal(uint32_t corner)
{
    const float *n = scene.data.vertices[scene.data.indices[corner]].normal;
    return (struct vec){n[0], n[1], n[2]};
}

static void assert_normals(void)
{
    for (uint32_t i = 0; i < scene.data.index_count; i++) {
        struct vec n = vertex_normal(i);
        assert_true(fabs(dot(n, n) - 1) < 1e-5);
    }
}

/* Each triangle's first vertex has the number of the triangle, so no two triangles share that
 * vertex. */
static void assert_numbered(void)
{
    for (uint32_t t = 0; t < scene.data.index_count / 3; t++)
        assert_int_equal(scene.data.vertices[scene.data.indices[3 * t]].triangle, t);
}

struct edge {
    float from[3], to[3];
};

static int compare_edges(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct edge));
}

/* In a closed surface without T-junctions every edge from p to q has exactly one partner from q
 * to p. */
static bool is_watertight(void)
{
    uint32_t count = scene.data.index_count;
    struct edge *edges = calloc(count, sizeof *edges);
    assert_non_null(edges);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *indices = scene.data.indices;
        for (int k = 0; k < 3; k++) { /* + 0 turns -0 into 0 */
            edges[i].from[k] = scene.data.vertices[indices[i]].position[k] + 0.0f;
            edges[i].to[k] =
                scene.data.vertices[indices[i % 3 == 2 ? i - 2 : i + 1]].position[k] + 0.0f;
        }
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    bool closed = true;
    for (uint32_t i = 0; i < count && closed; i++) {
        struct edge back;
        memcpy(back.from, edges[i].to, sizeof back.from);
        memcpy(back.to, edges[i].from, sizeof back.to);
        closed = bsearch(&back, edges, count, sizeof *edges, compare_edges) != NULL &&
                 (i == 0 || compare_edges(&edges[i - 1], &edges[i]) != 0);
    }
    free(edges);
    return closed;
}

/* ---- Meshes ---------------------------------------------------------------------------------- */

static const char box_obj[] =
    "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 0 1 0\nv 0 0 3\nv 4 0 3\nv 4 1 3\nv 0 1 3\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n";

static void box_is_closed_and_faces_outwards(void **state)
{
    (void)state;
    put("box.obj", box_obj);
    load_mesh("box.obj", "");
    assert_int_equal(scene.source_triangles, 12);
    assert_int_equal(scene.degenerate_triangles, 0);
    double radius = sqrt(16 + 1 + 9) / 2, area = 0;
    assert_true(fabs(scene.radius - radius) < 1e-5);
    assert_int_equal(scene.data.index_count, 3 * 12);
    assert_true(is_watertight());
    assert_normals();
    assert_numbered();
    const struct vec middle = {2, 0.5, 1.5};
    for (uint32_t t = 0; t < scene.data.index_count / 3; t++) {
        struct vec n = area_vector(t);
        area += 0.5 * sqrt(dot(n, n));
        assert_true(dot(n, sub(position(3 * t), middle)) > 0);
        assert_true(dot(n, vertex_normal(3 * t)) > 0.9999 * sqrt(dot(n, n)));
    }
    assert_true(fabs(area - 2 * (4 * 1 + 4 * 3 + 1 * 3)) < 1e-4);
}

/* The closed box of 8 vertices and 12 triangles needs 4 more vertices; winding and corners stay. */
static void triangles_are_numbered_by_their_first_vertex(void **state)
{
    (void)state;
    static const uint32_t box[36] = {0, 3, 2, 0, 2, 1, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                     2, 3, 7, 2, 7, 6, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5};
    uint32_t indices[36], triangles[8 + 12], copied[12];
    memcpy(indices, box, sizeof indices);
    assert_int_equal(dt_number_triangles(indices, 36, 8, triangles, copied), 12);
    for (uint32_t t = 0; t < 12; t++) {
        uint32_t corner[3], turn = 0;
        assert_int_equal(triangles[indices[3 * t]], t);
        for (int k = 0; k < 3; k++) {
            uint32_t vertex = indices[3 * t + (uint32_t)k];
            corner[k] = vertex < 8 ? vertex : copied[vertex - 8];
        }
        while (turn < 3 && box[3 * t + turn] != corner[0])
            turn++;
        for (uint32_t k = 0; k < 3; k++)
            assert_int_equal(corner[k], box[3 * t + (turn + k) % 3]);
    }
}

/* Tabs, carriage returns and negative indices as the archive's Cornell Boxes have them; two
 * triangles without area. */
static void odd_obj_is_read_and_degenerate_triangles_dropped(void **state)
{
    (void)state;
    put("odd.obj", "# odd\r\nv\t0 0 0\r\nv\t1  0 0   \r\nv\t1 1 0\r\nv\t0 1 0\r\nf -4 -3 -2 -1\r\n"
                   "v 0.5 0 0\r\nf 1 2 2\r\nf 1 5 2\r\nf 1 2 4\r\n");
    load_mesh("odd.obj", "scale: 2\n");
    assert_int_equal(scene.source_triangles, 5);
    assert_int_equal(scene.degenerate_triangles, 2);
    assert_int_equal(scene.data.index_count, 9);
    assert_int_equal(heard.count[DT_INFO], 1);
    assert_true(scene.bounds_max[0] == 2 && scene.bounds_max[1] == 2 && scene.bounds_min[0] == 0);
    assert_normals();
}

static const struct dt_material *material_of(uint32_t triangle)
{
    return &scene.data.materials[scene.data.vertices[scene.data.indices[3 * triangle]].material];
}

/* The file must not load; the one error has the text. */
static void assert_no_mesh(const char *name, const char *text)
{
    char yaml[512];
    snprintf(yaml, sizeof yaml, "mesh: %s\n" CAMERA SUN, name);
    put("wrong.yaml", yaml);
    memset(&heard, 0, sizeof heard);
    assert_false(scene_load(&scene, at("wrong.yaml"), NULL, false, &hearing));
    if (!strstr(heard.text, text))
        fail_msg("no '%s' in\n%s", text, heard.text);
    assert_int_equal(heard.count[DT_ERROR], 1);
}

static void wrong_indices_have_a_line(void **state)
{
    (void)state;
    static const struct {
        const char *face, *text;
    } cases[] = {
        {"f 1 2 9", "i.obj:6: error: a face has the vertex 9, and the file has 3"},
        {"f 3 2 -4", "i.obj:6: error: a face has the vertex -4, and the file has 3"},
        {"f 0 1 2", "i.obj:6: error: a face has the vertex 0, and the file has 3"},
        {"f 1/1 2/2 3/1",
         "i.obj:6: error: a face has the texture coordinate 2, and the file has 1"},
        {"f 1//1 2//7 3//1", "i.obj:6: error: a face has the normal 7, and the file has 1"},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        char text[256];
        snprintf(text, sizeof text, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n%s\n",
                 cases[i].face);
        put("i.obj", text);
        assert_no_mesh("i.obj", cases[i].text);
    }
    put("i.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
    assert_no_mesh("i.ply", "i.ply: a face has the index 7, and there are 3 vertices");
}

/* Materials that cannot be read are not left out. */
static void material_libraries_are_found(void **state)
{
    (void)state;
    static const uint8_t wide[] = {0xff, 0xfe, 'n', 0, 'e', 0, 'w', 0};
    put("l.obj", "mtllib k.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    assert_no_mesh("l.obj", "k.mtl: not found; ");
    put("l.mtl", "newmtl a\nKd 1 0 0\n"); /* assimp tries the name of the mesh */
    load_mesh("l.obj", "");
    assert_non_null(strstr(heard.text, "k.mtl: not found; "));
    assert_true(material_of(0)->albedo[1] == 0);
    scene_free(&scene);
    assert_int_equal(mkdir(at("k.mtl"), 0777), 0);
    assert_no_mesh("l.obj", "k.mtl: Is a directory");
    assert_int_equal(rmdir(at("k.mtl")), 0);
    FILE *file = fopen(at("k.mtl"), "wb");
    assert_true(file && fwrite(wide, sizeof wide, 1, file) == 1 && fclose(file) == 0);
    assert_no_mesh("l.obj", "k.mtl: UTF-16 text");
}

static void vertex_colours_are_told_once(void **state)
{
    (void)state;
    put("v.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0 0 1 1 1 1\n"
                 "g a\nf 1 2 3\ng b\nf 1 2 4\n");
    load_mesh("v.obj", "");
    assert_non_null(strstr(heard.text, "v.obj: vertex colours are not supported"));
    assert_int_equal(heard.count[DT_WARNING], 1);
}

static void refused_models_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *name, *start, *text;
    } cases[] = {
        {"w.obj", "\xfe\xff", "; the file is UTF-16 text"},
        {"w.obj", "<!DOCTYPE html>", "; the file is a web page"},
        {"w.obj", "version https://git-lfs.github.com/spec/v1\n",
         "the file is a pointer of Git LFS"},
        {"w.ply", "\x1f\x8b\b", "; the file is compressed by gzip"},
        {"w.gltf", "", "; the file is empty"},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        put(cases[i].name, cases[i].start);
        assert_no_mesh(cases[i].name, cases[i].text);
    }
}

static void assert_vector(const float v[3], double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        if (fabs((double)v[i] - expected[i]) > 1e-5)
            fail_msg("[%d] is %g, not %g", i, (double)v[i], expected[i]);
}

static void put_triangle(const char *name)
{
    const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    FILE *file = fopen(at(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(positions, sizeof positions, 1, file), 1);
    assert_int_equal(fclose(file), 0);
}

static void gltf_nodes_are_flattened(void **state)
{
    (void)state;
    put_triangle("t.bin");
    put("t.gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"translation\":[10,0,0],\"children\":[1]},{\"scale\":[-2,3,1],\"mesh\":0}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}],"
        "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,0.75,1]}}],"
        "\"buffers\":[{\"uri\":\"t.bin\",\"byteLength\":36}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
        "\"min\":[0,0,0],\"max\":[1,1,0]}]}");
    load_mesh("t.gltf", "");
    assert_int_equal(scene.data.index_count, 3);
    assert_true(scene.bounds_min[0] == 8 && scene.bounds_max[0] == 10 && scene.bounds_max[1] == 3);
    /* A mirror turns the winding; the front must stay +z. */
    assert_true(area_vector(0).z > 0 && vertex_normal(0).z > 0.999);
    assert_int_equal(scene.data.object_count, 1);
    const struct dt_object *object = &scene.data.objects[0];
    assert_vector(object->transform[0], -2, 0, 0);
    assert_vector(object->transform[3], 10, 0, 0);
    assert_vector(object->inverse[3], 5, 0, 0);
    assert_vector(object->center, 9, 1.5, 0);
    assert_true(fabs((double)object->radius - sqrt(1 + 1.5 * 1.5)) < 1e-5);
    assert_true(object->first_index == 0 && object->index_count == 3 && object->mesh == 0);
    const float *albedo = scene.data.materials[object->material].albedo;
    assert_true(albedo[0] == 0.25f && albedo[1] == 0.5f && albedo[2] == 0.75f);
}

/* A camera below a moved node; a bulb, a lamp and a sun below one that turns z to x. */
static const char viewed_gltf[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,2]}],"
    "\"nodes\":[{\"mesh\":0,\"translation\":[10,0,0],\"children\":[1]},"
    "{\"name\":\"eye\",\"camera\":0,\"translation\":[1,2,3]},"
    "{\"rotation\":[0,0.7071068,0,0.7071068],\"children\":[3,4,5]},"
    "{\"name\":\"bulb\",\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},"
    "{\"name\":\"lamp\",\"translation\":[0,0,1],"
    "\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}},"
    "{\"name\":\"sun\",\"extensions\":{\"KHR_lights_punctual\":{\"light\":2}}}],"
    "\"cameras\":[{\"type\":\"perspective\","
    "\"perspective\":{\"yfov\":0.8,\"aspectRatio\":1.5,\"znear\":0.1}}],"
    "\"extensionsUsed\":[\"KHR_lights_punctual\"],"
    "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\"},"
    "{\"type\":\"spot\",\"intensity\":683,\"color\":[1,0.5,0.25],"
    "\"spot\":{\"innerConeAngle\":0.3,\"outerConeAngle\":0.6}},"
    "{\"type\":\"directional\",\"intensity\":1366}]}},"
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
    "\"buffers\":[{\"uri\":\"t.bin\",\"byteLength\":36}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
    "\"min\":[0,0,0],\"max\":[1,1,0]}]}";

static void put_viewed_gltf(void)
{
    put_triangle("t.bin");
    put("v.gltf", viewed_gltf);
}

static void gltf_brings_camera_and_light(void **state)
{
    (void)state;
    put_viewed_gltf();
    put("v.yaml", "mesh: v.gltf\nscale: 2\n");
    load(at("v.yaml"));
    assert_int_equal(heard.count[DT_INFO], 2); /* tells which */
    assert_vector(scene.camera.eye, 22, 4, 6);
    assert_vector(scene.camera.target, 22, 4, 5);
    assert_vector(scene.camera.up, 0, 1, 0);
    assert_true(fabs((double)scene.camera.fov_y - 0.8) < 1e-5);
    assert_int_equal(scene.light.kind, DT_LIGHT_SPOT); /* the bulb is passed over */
    assert_vector(scene.light.position, 2, 0, 0);
    assert_vector(scene.light.direction, -1, 0, 0);
    assert_vector(scene.light.color, 1, 0.5, 0.25); /* 683 lm/W */
    assert_true(fabs((double)scene.light.cone[1] - 0.6) < 1e-5);
    scene_free(&scene);
    put("v.yaml", "mesh: v.gltf\nlight: sun\n" CAMERA);
    load(at("v.yaml"));
    assert_vector(scene.camera.eye, 0, 0, 5);
    assert_int_equal(scene.light.kind, DT_LIGHT_DIRECTIONAL);
    assert_vector(scene.light.direction, -1, 0, 0);
    assert_vector(scene.light.color, 2, 2, 2);
    struct dt_frame frame;
    scene_frame(&scene, 64, 64, &frame); /* its view covers the scene */
    assert_true(frame.light.area > 0 && frame.light.area < 1);
}

/* ---- Textures -------------------------------------------------------------------------------- */

static const char textured_obj[] =
    "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
    "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\nusemtl c\nf 1/1 2/2 3/3\n";

static void write_checker(const char *name, uint8_t alpha_of_black)
{
    uint8_t texels[4 * 4 * 4];
    for (int i = 0; i < 16; i++) {
        bool white = (i + i / 4) & 1;
        memset(texels + 4 * i, white ? 255 : 0, 3);
        texels[4 * i + 3] = white ? 255 : alpha_of_black;
    }
    if (!image_write_png(at(name), 4, 4, 4, texels, &hearing))
        fail_msg("%s", heard.text);
}

static void textures_fill_the_array(void **state)
{
    (void)state;
    write_checker("opaque.png", 255);
    write_checker("holes.png", 0);
    put("t.obj", textured_obj);
    put("t.mtl",
        "newmtl a\nKd 0 0 0\nmap_Kd opaque.png\nnewmtl b\nKd 0.5 0.5 0.5\nmap_Kd holes.png\n"
        "newmtl c\nKd 0.1 0.2 0.3\nmap_Kd none.png\n");
    load_mesh("t.obj", "");
    const struct dt_scene *data = &scene.data;
    assert_int_equal(data->texture_layers, 2);
    assert_int_equal(data->texture_width, 4);
    assert_int_equal(data->texture_mips, 3);
    const struct dt_material *a = material_of(0), *b = material_of(1), *c = material_of(2);
    assert_true(a->albedo[0] == 1 && a->texture >= 0 &&
                a->alpha_cutoff == 0); /* Kd 0 beside a map: white */
    assert_true(b->albedo[0] == 0.5f && b->texture >= 0 && b->alpha_cutoff == 0.5f);
    assert_true(c->albedo[2] == 0.3f && c->texture == -1 && c->alpha_cutoff == 0);
    assert_int_equal(heard.count[DT_WARNING], 1);
    assert_non_null(strstr(heard.text, "none.png"));
    /* Half of white light is sRGB code 188; behind holes nothing dark bleeds in, and coverage is
     * a half. */
    const uint8_t *mip1 = data->texels + 2 * 64, *mip2 = mip1 + 2 * 16;
    assert_int_equal(mip1[16 * a->texture], 188);
    assert_int_equal(mip2[4 * a->texture], 188);
    assert_int_equal(mip2[4 * b->texture], 255);
    assert_int_equal(mip2[4 * b->texture + 3], 128);
    /* The obj file counts v from below; row 0 of the texels is the top. */
    assert_true(data->vertices[data->indices[0]].uv[1] == 1);
}

/* Grey codes of linear light, as the file says. */
static void write_linear(const char *name)
{
    const uint8_t codes[2] = {10, 200};
    FILE *file = fopen(at(name), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    assert_true(file && png && info && setjmp(png_jmpbuf(png)) == 0);
    png_init_io(png, file);
    png_set_IHDR(png, info, 2, 1, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_gAMA_fixed(png, info, 100000);
    png_write_info(png, info);
    png_write_row(png, codes);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    assert_int_equal(fclose(file), 0);
}

static void textures_keep_their_numbers(void **state)
{
    (void)state;
    uint8_t *codes;
    uint32_t width = 0, height = 0;
    write_linear("linear.png");
    assert_true(image_read_rgba8(at("linear.png"), &width, &height, &codes, &hearing));
    assert_true(codes[0] == 10 && codes[4] == 200);
    free(codes);
    put("g.obj", textured_obj);
    put("t.mtl", "newmtl a\nmap_Kd linear.png\nnewmtl b\nnewmtl c\n");
    load_mesh("g.obj", "texture_size: 2\n");
    assert_int_equal(heard.count[DT_WARNING], 1);
    assert_non_null(strstr(heard.text, "linear.png: its colour space is linear; its numbers are "
                                       "taken as sRGB codes"));
    assert_true(scene.data.texels[0] == 10 && scene.data.texels[4] == 200);
}

static void opacity_map_becomes_alpha(void **state)
{
    (void)state;
    write_checker("opaque.png", 255);
    put("d.obj", "mtllib d.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl a\nf 1/1 "
                 "2/2 3/3\n");
    put("d.mtl", "newmtl a\nKd 1 1 1\nmap_Kd opaque.png\nmap_d opaque.png\n");
    load_mesh("d.obj", "texture_size: 4\n");
    assert_int_equal(scene.data.texture_layers, 1);
    assert_true(scene.data.materials[scene.data.vertices[0].material].alpha_cutoff == 0.5f);
    for (int i = 0; i < 16; i++)
        assert_int_equal(scene.data.texels[4 * i + 3], scene.data.texels[4 * i]);
}

/* One file by three names, of which one is a link, is one layer; what takes too much memory is refused
 * before a texture is read. */
static void textures_have_a_budget(void **state)
{
    (void)state;
    char mtl[2048] = "newmtl a\nmap_Kd opaque.png\nnewmtl b\nmap_Kd ././opaque.png\nnewmtl c\n"
                     "map_Kd link.png\n";
    write_checker("opaque.png", 255);
    assert_int_equal(symlink("opaque.png", at("link.png")), 0);
    put("t.obj", textured_obj);
    put("t.mtl", mtl);
    load_mesh("t.obj", "texture_size: 8\n");
    assert_int_equal(scene.data.texture_layers, 1);
    assert_int_equal(material_of(0)->texture, material_of(2)->texture);
    scene_free(&scene);
    for (int i = 0; i < 25; i++)
        sprintf(mtl + strlen(mtl), "newmtl m%d\nmap_Kd none%d.png\n", i, i);
    put("t.mtl", mtl);
    put("t.yaml", "mesh: t.obj\ntexture_size: 4096\n" CAMERA SUN);
    assert_false(scene_load(&scene, at("t.yaml"), NULL, false, &hearing));
    assert_non_null(
        strstr(heard.text, "26 textures of 4096x4096 take 2218 MiB; 2048 is the limit"));
    *strstr(mtl, "newmtl m9") = 0; /* little memory, but much time for small files */
    put("t.mtl", mtl);
    assert_false(scene_load(&scene, at("t.yaml"), NULL, false, &hearing));
    assert_non_null(strstr(heard.text, "for 10 layers of 4096x4096, in files of "));
    strcpy(mtl, "newmtl a\nmap_Kd a.pgm\nnewmtl b\nmap_Kd b.pgm\nnewmtl c\nmap_Kd c.pgm\n");
    put("a.pgm", "P5 8000 8000 255\n");
    put("b.pgm", "P5 8000 8000 255\n");
    put("c.pgm", "P5 8000 8000 255\n");
    put("t.mtl", mtl);
    put("t.yaml", "mesh: t.obj\n" CAMERA SUN);
    assert_false(scene_load(&scene, at("t.yaml"), NULL, false, &hearing));
    assert_non_null(strstr(heard.text, "the scene's textures have 192000000 pixels"));
    assert_int_equal(heard.count[DT_WARNING], 0);
}

static void untextured_scene_has_one_white_texel(void **state)
{
    (void)state;
    load("scenes/cornell.yaml");
    assert_int_equal(scene.data.texture_layers, 1);
    assert_int_equal(scene.data.texture_width, 1);
    assert_memory_equal(scene.data.texels, "\377\377\377\377", 4);
}

/* ---- Shipped scenes -------------------------------------------------------------------------- */

/* Area of the triangles of one albedo (red part) whose normals agree with (x, y, z). */
static double area_of(float red, struct vec normal)
{
    double area = 0;
    for (uint32_t t = 0; t < scene.data.index_count / 3; t++) {
        struct vec n = area_vector(t);
        double twice = sqrt(dot(n, n));
        if (fabsf(material_of(t)->albedo[0] - red) < 1e-4f && dot(n, normal) > 0.999 * twice)
            area += twice / 2;
    }
    return area;
}

static void assert_area(double area, double published_mm2)
{
    if (fabs(area * 1e6 - published_mm2) > 1e-4 * published_mm2)
        fail_msg("area %g mm2, published %g", area * 1e6, published_mm2);
}

static void cornell_box_has_the_published_measures(void **state)
{
    (void)state;
    load("scenes/cornell.yaml");
    assert_int_equal(scene.source_triangles, 30);
    assert_true(fabsf(scene.bounds_max[0] - 0.556f) < 1e-6f &&
                fabsf(scene.bounds_max[1] - 0.5488f) < 1e-6f);
    const struct vec up = {0, 1, 0}, down = {0, -1, 0}, right = {1, 0, 0}, front = {0, 0, -1};
    /* The tops of the blocks from the shoelace formula. */
    double tops = 0.5 * fabs((130 - 240.) * (225 - 114.) - (82 - 290.) * (65 - 272.)) +
                  0.5 * fabs((423 - 314.) * (296 - 406.) - (265 - 472.) * (247 - 456.));
    assert_area(area_of(0.725f, up), 0.5 * (552.8 + 549.6) * 559.2 + tops);
    assert_area(area_of(0.725f, down), 556 * 559.2);
    assert_area(area_of(0.725f, front), 0.5 * (549.6 + 556) * 548.8);
    assert_area(area_of(0.14f, right), 559.2 * 548.8);
}

static void atrium_is_heavy_and_faces_outward(void **state)
{
    (void)state;
    if (access("build/scenes/atrium.obj", R_OK) != 0)
        skip();
    load("scenes/atrium.yaml");
    assert_true(scene.source_triangles > 100000);
    assert_int_equal(scene.degenerate_triangles, 0);
    assert_normals();
    uint32_t against = 0;
    for (uint32_t i = 0; i < scene.data.index_count; i++)
        against += dot(area_vector(i / 3), vertex_normal(i)) <= 0;
    assert_int_equal(against, 0);
    /* Six times the enclosed volume; closed solids that face outward have a positive one. */
    double volume = 0;
    for (uint32_t t = 0; t < scene.data.index_count / 3; t++)
        volume += dot(position(3 * t), area_vector(t));
    assert_true(volume > 0);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static void project(const float m[4][4], struct vec p, double out[3])
{
    double clip[4];
    for (int i = 0; i < 4; i++)
        clip[i] = m[0][i] * p.x + m[1][i] * p.y + m[2][i] * p.z + (double)m[3][i];
    for (int i = 0; i < 3; i++)
        out[i] = clip[i] / clip[3];
}

static void assert_close(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.9g is not %.9g", a, b);
}

static void assert_inverse(const struct dt_view *view)
{
    for (int x = -1; x <= 1; x++)
        for (int y = -1; y <= 1; y++) {
            double world[3], back[3];
            project(view->inverse_view_projection, (struct vec){0.9 * x, 0.7 * y, 0.5}, world);
            project(view->view_projection, (struct vec){world[0], world[1], world[2]}, back);
            assert_close(back[0], 0.9 * x, 1e-4);
            assert_close(back[1], 0.7 * y, 1e-4);
            assert_close(back[2], 0.5, 1e-4);
        }
}

static void camera_projects_known_points(void **state)
{
    (void)state;
    struct dt_frame frame;
    load("scenes/cornell.yaml");
    scene_frame(&scene, 200, 100, &frame);
    const struct dt_view *camera = &frame.camera;
    double p[3], reach = 0.8 * tan(39.3 / 2 * PI / 180);
    project(camera->view_projection, (struct vec){0.278, 0.273, 0}, p);
    assert_close(p[0], 0, 1e-5);
    assert_close(p[1], 0, 1e-5);
    project(camera->view_projection, (struct vec){0.278 - reach, 0.273 + reach, 0}, p);
    assert_close(p[1], 1, 1e-5); /* y is up, and the world's -x is to the right */
    assert_close(p[0], 0.5, 1e-5);
    project(camera->view_projection, (struct vec){0.278, 0.273, camera->near_plane - 0.8}, p);
    assert_close(p[2], 0, 1e-4);
    project(camera->view_projection, (struct vec){0.278, 0.273, camera->far_plane - 0.8}, p);
    assert_close(p[2], 1, 1e-4);
    for (uint32_t i = 0; i < scene.data.index_count; i++) {
        project(camera->view_projection, position(i), p);
        assert_true(p[2] >= 0 && p[2] <= 1);
        if (material_of(i / 3)->albedo[0] < 0.7f) /* red on the left, green on the right */
            assert_true((p[0] < 0) == (material_of(i / 3)->albedo[0] > 0.5f));
    }
    assert_inverse(camera);
    assert_inverse(&frame.light_view);
    assert_int_equal(frame.width | frame.height | frame.index, 0);
}

static void spot_view_is_the_cone(void **state)
{
    (void)state;
    struct dt_frame frame;
    load("scenes/cornell.yaml");
    scene_frame(&scene, 64, 64, &frame);
    assert_close(frame.light.area, pow(2 * tan(35 * PI / 180), 2), 1e-5);
    assert_close(frame.light.cos_inner, cos(25 * PI / 180), 1e-6);
    assert_close(frame.light.cos_outer, cos(35 * PI / 180), 1e-6);
    /* A point on the rim of the outer cone lies on the circle of radius 1 about the view's axis. */
    const float *d = frame.light.direction, *o = frame.light.position;
    struct vec axis = {d[0], d[1], d[2]}, side = cross(axis, (struct vec){0, 0, 1});
    double width = tan(35 * PI / 180) / sqrt(dot(side, side)), p[3];
    struct vec rim = {o[0] + 0.2 * (axis.x + width * side.x),
                      o[1] + 0.2 * (axis.y + width * side.y),
                      o[2] + 0.2 * (axis.z + width * side.z)};
    project(frame.light_view.view_projection, rim, p);
    assert_close(hypot(p[0], p[1]), 1, 1e-5);
}

static void sun_view_holds_the_scene(void **state)
{
    (void)state;
    put("box.obj", box_obj);
    put("sun.yaml", "mesh: box.obj\n" CAMERA
                    "light: {kind: directional, direction: [0, -2, 0], irradiance: [1, 2, 3]}\n");
    struct dt_frame frame;
    load(at("sun.yaml"));
    scene_frame(&scene, 64, 64, &frame);
    /* From straight above the box shows 4 x 3; a thin margin is allowed. */
    assert_true(frame.light.area >= 12 && frame.light.area < 12 * 1.04);
    assert_close(frame.light.direction[1], -1, 1e-6);
    for (uint32_t i = 0; i < scene.data.index_count; i++) {
        double p[3];
        project(frame.light_view.view_projection, position(i), p);
        assert_true(fabs(p[0]) < 1 && fabs(p[1]) < 1 && p[2] > 0 && p[2] < 1);
    }
    assert_inverse(&frame.light_view);
}

/* Light that falls aslant sees a hole of 1 x 0.5 foreshortened: 0.5 times the cosine. */
static void opening_bounds_the_sun_view(void **state)
{
    (void)state;
    put("box.obj", box_obj);
    put("hole.yaml", "mesh: box.obj\n" CAMERA
                     "light: {kind: directional, direction: [1, -1, 0], irradiance: [1, 2, 3],\n"
                     "  opening_min: [1, 0.5, 1], opening_max: [2, 0.5, 1.5]}\n");
    struct dt_frame frame;
    load(at("hole.yaml"));
    scene_frame(&scene, 64, 64, &frame);
    double margin = 2 * 0.005 * scene.radius;
    assert_close(frame.light.area, (sqrt(0.5) + margin) * (0.5 + margin), 1e-4);
}

/* ---- Image files ----------------------------------------------------------------------------- */

static void images_survive_the_round_trip(void **state)
{
    (void)state;
    uint8_t codes[5 * 3 * 4], *read_codes;
    for (int i = 0; i < 60; i++)
        codes[i] = (uint8_t)(i * 37);
    uint32_t width = 0, height = 0;
    assert_true(image_write_png(at("a.png"), 5, 3, 4, codes, &hearing));
    assert_true(image_read_rgba8(at("a.png"), &width, &height, &read_codes, &hearing));
    assert_int_equal(width, 5);
    assert_int_equal(height, 3);
    assert_memory_equal(read_codes, codes, sizeof codes);
    free(read_codes);
    assert_int_equal(heard.count[DT_ERROR], 0);
}

/* Grey with alpha, 8-bit; and 16-bit linear, which OpenImageIO reads. */
static void kinds_of_png_are_read(void **state)
{
    (void)state;
    const uint8_t grey[2 * 2] = {10, 200, 30, 40};
    const uint8_t spread[2 * 4] = {10, 10, 10, 200, 30, 30, 30, 40};
    const png_uint_16 deep[2 * 3] = {1, 2, 3, 40000, 50000, 65535};
    png_image png = {.version = PNG_IMAGE_VERSION, .width = 2, .height = 1};
    uint32_t width = 0, height = 0;
    uint8_t *codes;
    float *texels;
    assert_true(image_write_png(at("grey.png"), 2, 1, 2, grey, &hearing));
    assert_true(image_read_rgba8(at("grey.png"), &width, &height, &codes, &hearing));
    assert_memory_equal(codes, spread, sizeof spread);
    free(codes);
    assert_true(image_read_float(at("grey.png"), &width, &height, &texels, &hearing));
    for (int i = 0; i < 8; i++)
        assert_float_equal(texels[i], spread[i] / 255.0f, 0);
    free(texels);
    /* Resized, by threads of OpenImageIO, beside which LeakSanitizer crashes: in a child. */
    width = height = 4;
    int status;
    pid_t child = fork();
    if (child == 0)
        _exit(!image_read_rgba8(at("grey.png"), &width, &height, &codes, &hearing) || width != 4 ||
              codes[0] != 10 || codes[4 * 15] != 30);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    png.format = PNG_FORMAT_LINEAR_RGB;
    assert_true(png_image_write_to_file(&png, at("deep.png"), 0, deep, 0, NULL));
    assert_true(image_read_float(at("deep.png"), &width, &height, &texels, &hearing));
    assert_int_equal(width, 2);
    for (int i = 0; i < 6; i++)
        assert_float_equal(texels[i + i / 3], deep[i] / 65535.0f, 1e-7);
    free(texels);
    assert_true(image_size(at("deep.png"), &width, &height, &hearing));
    assert_int_equal(width, 2);
    assert_int_equal(height, 1);
    assert_int_equal(heard.count[DT_ERROR], 0);
}

static void image_errors_name_the_file(void **state)
{
    (void)state;
    const uint8_t texel[4] = {1, 2, 3, 4};
    uint32_t width = 0, height = 0;
    uint8_t *texels;
    assert_false(image_write_png(at("no/such/folder.png"), 1, 1, 4, texel, &hearing));
    assert_non_null(strstr(heard.text, "no/such/folder.png"));
    put("text.png", "this is no picture");
    assert_false(image_read_rgba8(at("text.png"), &width, &height, &texels, &hearing));
    assert_non_null(strstr(heard.text, "text.png"));
    assert_int_equal(heard.count[DT_ERROR], 2);
}

/* ---- Diagnostics ----------------------------------------------------------------------------- */

/* Loads a scene that must fail with these lines in one error; %s in them is the fixture's path. */
static void assert_refused(const char *text, const char *const *lines, size_t count)
{
    put("bad.yaml", text);
    memset(&heard, 0, sizeof heard);
    assert_false(scene_load(&scene, at("bad.yaml"), NULL, false, &hearing));
    assert_int_equal(heard.count[DT_ERROR], 1);
    assert_null(scene.data.vertices);
    for (size_t i = 0; i < count; i++) {
        char line[512];
        snprintf(line, sizeof line, "%s:%s", at("bad.yaml"), lines[i]);
        if (!strstr(heard.text, line))
            fail_msg("no line '%s' in\n%s", line, heard.text);
    }
}

static void wrong_scene_files_are_told_in_one_run(void **state)
{
    (void)state;
    put("box.obj", box_obj);
    static const char *const several[] = {
        "2:1: error: unknown key `scal`; did you mean `scale`?\n    2 | scal: 2\n      | ^~~~",
        "3:19: error: `eye` takes a finite number here\n",
        "3:37: error: `target` takes a sequence of 3 numbers\n",
        "3:1: error: camera lacks the key `fov_y`\n",
        "4:73: error: `cone` is out of range: it lies between 0 and 85\n",
        "5:15: error: `texture_size` must be a power of two\n",
    };
    assert_refused("mesh: box.obj\nscal: 2\ncamera: {eye: [0, x, 1.0], target: [0, 1]}\n"
                   "light: {kind: spot, position: [0, 0, 0], direction: [0,1,0], cone: [25, 95], "
                   "intensity: [1, 1, 1]}\n"
                   "texture_size: 300\n",
                   several, DT_ARRAY_COUNT(several));
    static const char *const lamp[] = {"3:15: error: `kind` of a light is `directional` or `spot`"};
    assert_refused("mesh: box.obj\n" CAMERA "light: {kind: lamp}\n", lamp, 1);
    static const char *const half[] = {"3:1: error: `opening_min` and `opening_max` go together"};
    assert_refused("mesh: box.obj\n" CAMERA
                   "light: {kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1],\n"
                   "  opening_min: [0, 0, 0]}\n",
                   half, 1);
    static const char *const upside_down[] = {
        "4:17: error: `opening_min` must not lie above `opening_max`"};
    assert_refused("mesh: box.obj\n" CAMERA
                   "light: {kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1],\n"
                   "  opening_min: [0, 2, 0], opening_max: [1, 1, 1]}\n",
                   upside_down, 1);
    assert_refused(CAMERA, (const char *const[]){"1:1: error: the scene lacks the key `mesh`"}, 1);
    assert_refused("mesh: box.obj\nlight: [1]\n" CAMERA,
                   (const char *const[]){"2:9: error: `light` takes a mapping or a name"}, 1);
    static const char *const twice[] = {"2:1: error: the key `mesh` stands twice",
                                        "1:1: note: first here"};
    assert_refused("mesh: box.obj\nmesh: box.obj\n" CAMERA SUN, twice, 2);
    static const char *const blind[] = {
        "2:35: error: `target` is where `eye` is; move one of them"};
    assert_refused("mesh: box.obj\ncamera: {eye: [1, 1, 1], target: [1, 1, 1], fov_y: 30}\n" SUN,
                   blind, 1);
    assert_refused("- 1\n", (const char *const[]){"1:3: error: a scene file is a mapping"}, 1);
    assert_refused("mesh: \xff\n",
                   (const char *const[]){"1:7: error: the byte 0xff is no UTF-8 text\n"}, 1);
    assert_refused("a: &a [*a]\n", (const char *const[]){"1:8: error: aliases add more than"}, 1);
    assert_refused("", (const char *const[]){"1:1: error: YAML: the file has no content"}, 1);
}

static void wrong_choices_of_cameras_and_lights_are_told(void **state)
{
    (void)state;
    put("box.obj", box_obj);
    put_viewed_gltf();
    assert_refused(
        "mesh: box.obj\n" CAMERA,
        (const char *const[]){"1:7: error: the scene lacks the key `light`, and no light"}, 1);
    assert_refused("mesh: v.gltf\ncamera: ey\n",
                   (const char *const[]){"2:9: error: no camera `ey` in "}, 1);
    assert_refused("mesh: v.gltf\nlight: bulb\n",
                   (const char *const[]){"2:8: error: the light `bulb` of "}, 1);
}

static void missing_mesh_says_where_it_looked(void **state)
{
    (void)state;
    put("lost.yaml", "mesh: sponza/sponza.obj\n" CAMERA SUN);
    assert_false(scene_load(&scene, at("lost.yaml"), "/no/where", false, &hearing));
    const char *words[] = {
        "lost.yaml:1:7: error:", at("sponza/sponza.obj"), "/no/where/sponza/sponza.obj",
        "folder of scenes",      "DIPTYCH_SCENES",        "casual-effects.com/data"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
        if (!strstr(heard.text, words[i]))
            fail_msg("no '%s' in\n%s", words[i], heard.text);
}

static void mesh_is_found_below_the_scenes_folder(void **state)
{
    (void)state;
    assert_int_equal(mkdir(at("meshes"), 0777), 0);
    put("meshes/other.obj", box_obj);
    put("below.yaml", "mesh: other.obj\n" CAMERA SUN);
    assert_true(scene_load(&scene, at("below.yaml"), at("meshes"), false, &hearing));
    assert_int_equal(scene.source_triangles, 12);
}

/* ---- Motions --------------------------------------------------------------------------------- */

#define SPOT                                                                                       \
    "light: {kind: spot, position: [0, 2, 0], target: [0, 0, 0], cone: [25, 35], "                 \
    "intensity: [1, 1, 1]}\n"

/* A box with this light, and a motion for it. */
static void load_moving(const char *light, const char *motion)
{
    char text[1024];
    put("box.obj", box_obj);
    snprintf(text, sizeof text, "mesh: box.obj\n" CAMERA "%s", light);
    put("moving.yaml", text);
    put("motion.yaml", motion);
    load(at("moving.yaml"));
    if (!scene_load_motion(&scene, at("motion.yaml"), &hearing))
        fail_msg("%s", heard.text);
}

static struct scene_camera camera_at(uint32_t frame)
{
    struct scene_camera camera = scene.camera;
    struct scene_light light = scene.light;
    motion_at(scene.motion, frame, &camera, &light);
    return camera;
}

static struct scene_light light_at(uint32_t frame)
{
    struct scene_camera camera = scene.camera;
    struct scene_light light = scene.light;
    motion_at(scene.motion, frame, &camera, &light);
    return light;
}

/* Catmull and Rom's spline through evenly spaced points is 0.5 ((-t + 2t2 - t3) p0 + (2 - 5t2 +
 * 3t3) p1 + (t + 4t2 - 3t3) p2 + (-t2 + t3) p3). Through points on a line in time, the spline is
 * that line at any spacing. */
static void splines_are_those_of_the_paper(void **state)
{
    (void)state;
    load_moving(SUN, "keys:\n"
                     "  - {at: 0, camera: {eye: [1, 0, 5], fov_y: 40}}\n"
                     "  - {at: 4, camera: {eye: [2, 0, 5], fov_y: 44}}\n"
                     "  - {at: 8, camera: {eye: [7, 0, 5]}}\n"
                     "  - {at: 12, camera: {eye: [-3, 0, 5], fov_y: 52}}\n");
    assert_int_equal(motion_frames(scene.motion), 13);
    const double p[] = {1, 2, 7, -3};
    for (uint32_t frame = 4; frame <= 8; frame++) {
        double t = (frame - 4) / 4.0, t2 = t * t, t3 = t * t * t;
        double x = 0.5 * ((-t + 2 * t2 - t3) * p[0] + (2 - 5 * t2 + 3 * t3) * p[1] +
                          (t + 4 * t2 - 3 * t3) * p[2] + (-t2 + t3) * p[3]);
        struct scene_camera camera = camera_at(frame);
        assert_true(fabs((double)camera.eye[0] - x) < 1e-6);
        assert_true(camera.eye[2] == 5 && camera.target[2] == 0);
    }
    for (uint32_t frame = 0; frame <= 12; frame++)
        assert_true(fabs((double)camera_at(frame).fov_y - (40 + frame) * PI / 180) < 1e-6);
    assert_true(camera_at(12).eye[0] == -3 && camera_at(99).eye[0] == -3);
}

static void lines_and_seconds(void **state)
{
    (void)state;
    load_moving(SUN, "interpolation: linear\nframes_per_second: 10\nkeys:\n"
                     "  - {at: 0.1, light: {direction: [0, -2, 0], irradiance: [1, 2, 3]}}\n"
                     "  - {at: 0.3, light: {direction: [2, -2, 0]}}\n"
                     "  - {at: 0.5, light: {irradiance: [5, 2, 7]}}\n");
    assert_int_equal(motion_frames(scene.motion), 6);
    assert_true(light_at(0).direction[1] == -1);
    struct scene_light light = light_at(2);
    assert_true(fabs((double)light.direction[0] - 1 / sqrt(5)) < 1e-6);
    assert_true(fabs((double)light.direction[1] + 2 / sqrt(5)) < 1e-6);
    assert_true(fabs((double)light.color[0] - 2) < 1e-6 && light.color[1] == 2);
    assert_true(fabs((double)light_at(4).direction[0] - sqrt(0.5)) < 1e-6);
    assert_true(camera_at(4).eye[2] == 5); /* the scene's, to the bit */
}

/* A spot with a target in the scene keeps looking at the target while the spot moves. The light
 * view follows. */
static void moving_spot_keeps_its_target(void **state)
{
    (void)state;
    struct dt_frame frame;
    load_moving(SPOT, "keys: [{at: 0, light: {position: [0, 2, 0]}},\n"
                      "       {at: 2, light: {position: [2, 2, 0]}}]\n");
    scene_frame_at(&scene, 2, 64, 64, &frame);
    assert_true(fabs((double)frame.light.direction[0] + sqrt(0.5)) < 1e-6);
    assert_true(fabs((double)frame.light_view.direction[1] + sqrt(0.5)) < 1e-6);
    assert_true(frame.light_view.position[0] == 2 && frame.light.position[0] == 2);
    assert_true(frame.index == 2 && frame.time == 2.0f / 60);
    scene_frame_at(&scene, 0, 64, 64, &frame);
    struct dt_frame still;
    scene_frame(&scene, 64, 64, &still);
    assert_memory_equal(&frame, &still, sizeof still);
}

static void assert_motion_refused(const char *text, const char *const *lines, size_t count)
{
    load_moving(SPOT, "keys: [{at: 0, light: {cone: [1, 2]}}]\n");
    put("bad_motion.yaml", text);
    memset(&heard, 0, sizeof heard);
    assert_false(scene_load_motion(&scene, at("bad_motion.yaml"), &hearing));
    assert_int_equal(heard.count[DT_ERROR], 1);
    assert_null(scene.motion);
    for (size_t i = 0; i < count; i++) {
        char line[512];
        snprintf(line, sizeof line, "%s:%s", at("bad_motion.yaml"), lines[i]);
        if (!strstr(heard.text, line))
            fail_msg("no line '%s' in\n%s", line, heard.text);
    }
}

static void wrong_motion_files_are_told_in_one_run(void **state)
{
    (void)state;
    static const char *const several[] = {
        "1:16: error: `interpolation` is `catmull_rom` or `linear`\n",
        "3:22: error: unknown key `eyes`; did you mean `eye`?\n    3 |   - {at: 1, camera: {eyes:",
        "4:10: error: `at` must grow from keyframe to keyframe\n",
        "4:29: error: `fov_y` is out of range: it lies between 1 and 170\n",
        "5:6: error: the keyframe lacks the key `at`\n",
        "6:5: error: a keyframe is a mapping with `at`, `camera` and `light`\n",
    };
    assert_motion_refused("interpolation: cubic\nkeys:\n"
                          "  - {at: 1, camera: {eyes: [0, 0, 1]}}\n"
                          "  - {at: 1, camera: {fov_y: 180}}\n"
                          "  - {light: {cone: [1, 2]}}\n"
                          "  - 7\n",
                          several, DT_ARRAY_COUNT(several));
    static const char *const none[] = {"1:1: error: the motion lacks the key `keys`"};
    assert_motion_refused("interpolation: linear\n", none, 1);
    static const char *const still[] = {"1:1: error: no keyframe moves `camera` or `light`"};
    assert_motion_refused("keys: [{at: 3}]\n", still, 1);
    static const char *const kind[] = {"1:24: error: unknown key `kind`"};
    assert_motion_refused("keys: [{at: 3, light: {kind: spot}}]\n", kind, 1);
    static const char *const both[] = {
        "1:1: error: a motion moves either `target` or `direction` of a light"};
    assert_motion_refused(
        "keys: [{at: 3, light: {target: [1, 0, 0]}}, {at: 4, light: {direction: [1, 0, 0]}}]\n",
        both, 1);
}

/* Values that are right at every key may be wrong between two keys. */
static void frames_between_keys_are_tried(void **state)
{
    (void)state;
    static const char *const meet[] = {
        "1:34: error: in frame 2, `target` is where `eye` is; move one of them\n"};
    assert_motion_refused("keys: [{at: 0, camera: {target: [0, 0, 3]}}, {at: 4, camera: {target: "
                          "[0, 0, 7]}}]\n",
                          meet, 1);
    static const char *const overshoot[] = {"3:28: error: in frame 5, `cone` is out of range: it "
                                            "lies between 0 and 85\n"};
    assert_motion_refused("keys:\n  - {at: 0, light: {cone: [2, 20]}}\n"
                          "  - {at: 4, light: {cone: [0, 80]}}\n"
                          "  - {at: 8, light: {cone: [0, 80]}}\n"
                          "  - {at: 12, light: {cone: [2, 20]}}\n",
                          overshoot, 1);
}

/* ---- Child processes ------------------------------------------------------------------------- */

static bool crash(FILE *result, void *user, const struct dt_log *log)
{
    (void)result;
    child_opens(user);
    report_message(log, DT_WARNING, "before");
    raise(SIGKILL); /* which no sanitizer catches */
    return true;
}

static bool refuse(FILE *result, void *user, const struct dt_log *log)
{
    (void)result;
    report_error(log, "no %s", (const char *)user);
    return false;
}

static bool answer(FILE *result, void *user, const struct dt_log *log)
{
    (void)log;
    return fprintf(result, "%s", (const char *)user) > 0;
}

static void a_child_answers_refuses_or_crashes_alone(void **state)
{
    (void)state;
    char text[8] = "";
    FILE *result = child_run(answer, "all", &hearing);
    assert_non_null(result);
    assert_non_null(fgets(text, sizeof text, result));
    assert_string_equal(text, "all");
    fclose(result);
    assert_int_equal(heard.count[DT_ERROR], 0);
    assert_null(child_run(refuse, "mesh", &hearing));
    assert_string_equal(heard.text, "no mesh");
    assert_null(child_run(crash, "odd.mtl", &hearing));
    assert_int_equal(heard.count[DT_WARNING], 1);
    assert_int_equal(heard.count[DT_ERROR], 2);
    assert_non_null(strstr(heard.text, "odd.mtl: the library that reads this file crashed"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(box_is_closed_and_faces_outwards, forget),
        cmocka_unit_test_teardown(triangles_are_numbered_by_their_first_vertex, forget),
        cmocka_unit_test_teardown(odd_obj_is_read_and_degenerate_triangles_dropped, forget),
        cmocka_unit_test_teardown(wrong_indices_have_a_line, forget),
        cmocka_unit_test_teardown(material_libraries_are_found, forget),
        cmocka_unit_test_teardown(vertex_colours_are_told_once, forget),
        cmocka_unit_test_teardown(refused_models_are_named, forget),
        cmocka_unit_test_teardown(gltf_nodes_are_flattened, forget),
        cmocka_unit_test_teardown(gltf_brings_camera_and_light, forget),
        cmocka_unit_test_teardown(textures_fill_the_array, forget),
        cmocka_unit_test_teardown(textures_keep_their_numbers, forget),
        cmocka_unit_test_teardown(opacity_map_becomes_alpha, forget),
        cmocka_unit_test_teardown(textures_have_a_budget, forget),
        cmocka_unit_test_teardown(untextured_scene_has_one_white_texel, forget),
        cmocka_unit_test_teardown(cornell_box_has_the_published_measures, forget),
        cmocka_unit_test_teardown(atrium_is_heavy_and_faces_outward, forget),
        cmocka_unit_test_teardown(camera_projects_known_points, forget),
        cmocka_unit_test_teardown(spot_view_is_the_cone, forget),
        cmocka_unit_test_teardown(sun_view_holds_the_scene, forget),
        cmocka_unit_test_teardown(opening_bounds_the_sun_view, forget),
        cmocka_unit_test_teardown(images_survive_the_round_trip, forget),
        cmocka_unit_test_teardown(kinds_of_png_are_read, forget),
        cmocka_unit_test_teardown(image_errors_name_the_file, forget),
        cmocka_unit_test_teardown(wrong_scene_files_are_told_in_one_run, forget),
        cmocka_unit_test_teardown(wrong_choices_of_cameras_and_lights_are_told, forget),
        cmocka_unit_test_teardown(missing_mesh_says_where_it_looked, forget),
        cmocka_unit_test_teardown(mesh_is_found_below_the_scenes_folder, forget),
        cmocka_unit_test_teardown(splines_are_those_of_the_paper, forget),
        cmocka_unit_test_teardown(lines_and_seconds, forget),
        cmocka_unit_test_teardown(moving_spot_keeps_its_target, forget),
        cmocka_unit_test_teardown(wrong_motion_files_are_told_in_one_run, forget),
        cmocka_unit_test_teardown(frames_between_keys_are_tried, forget),
        cmocka_unit_test_teardown(a_child_answers_refuses_or_crashes_alone, forget),
    };
    return cmocka_run_group_tests_name("scenes", tests, make_folder, remove_folder);
}
