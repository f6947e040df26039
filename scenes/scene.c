/* Scene files: YAML to struct scene, with a compiler's diagnostics, all of them in one run. The
 * app is the caller.
 *
 *   mesh: cornell.obj         beside this file, else below the folder of --scenes or DIPTYCH_SCENES;
 *                             what it names lies in its folder or this file's, at any depth
 *   scale: 1                  multiplies the mesh; everything below is in the unit after that
 *   camera: {eye: [0, 1, 3], target: [0, 1, 0], up: [0, 1, 0], fov_y: 40}     up is optional
 *   camera: Camera            the mesh file's, by its node's name; without the key its first
 *   light: {kind: spot, position: [0, 2, 0], target: [-1, 1, 0], cone: [25, 35],
 *           intensity: [10, 10, 10]}
 *   light: {kind: directional, direction: [0, -1, 0], irradiance: [8, 8, 8],
 *           opening_min: [-1, 3, -1], opening_max: [1, 3, 1]}
 *   light: Sun                likewise
 *   texture_size: 512         of every layer, a power of two; else the largest's, up to 1024
 *
 * Angles in degrees: fov_y is the whole angle, cone the inner and outer half angle. A spot may
 * have `direction` instead of `target`. Both ends of the opening are optional together: a box that
 * all light must pass through, such as a hole in a roof; without it light comes from everywhere.
 * Irradiance is perpendicular to the rays (W/m2), intensity that on the axis (W/sr). */
#include "camera_light.h"
#include "child.h"
#include "base/input.h"
#include "mesh.h"
#include "motion.h"
#include "base/log.h"
#include "base/yaml.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MAX_TEXTURE_SIZE = 4096, MOST_OPEN_FILES = 8 };

/* ---- Camera and light ------------------------------------------------------------------------ */

static void read_camera(struct reader *reader, const struct key *self,
                        struct dt_scene_camera *camera)
{
    struct key keys[CAMERA_KEYS];
    int errors = reader->errors;
    camera_keys(keys);
    reader_mapping(reader, self->node, self->name_node, "camera", keys, CAMERA_KEYS);
    camera_take(reader, errors, keys, self->name_node, camera);
}

static void read_light(struct reader *reader, const struct key *self, struct scene_light *light)
{
    struct fy_node *node = fy_node_mapping_lookup_value_by_simple_key(self->node, "kind", 4);
    const char *text = node && fy_node_is_scalar(node) ? fy_node_get_scalar0(node) : "";
    bool spot = strcmp(text, "spot") == 0;
    int errors = reader->errors, kind = spot ? DT_LIGHT_SPOT : DT_LIGHT_DIRECTIONAL;
    struct key keys[LIGHT_KEYS];
    if (!spot && strcmp(text, "directional") != 0) {
        reader_report(reader, node ? node : self->name_node,
                      "`kind` of a light is `directional` or `spot`");
        return;
    }
    int count = light_keys(kind, keys);
    reader_mapping(reader, self->node, self->name_node,
                   spot ? "a spot light" : "a directional light", keys, (size_t)count);
    light_take(reader, errors, kind, keys, self->name_node, light);
}

/* ---- The file -------------------------------------------------------------------------------- */

/* A camera or light that the mesh file brings. */
struct wish {
    bool open;        /* the scene file has none of its own */
    char *name;       /* NULL: the first; owned */
    struct loc place; /* of the name, else of the mesh; no source */
};

/* Settings of the file besides its own camera and light. */
struct settings {
    struct scene *scene; /* to fill */
    const char *scenes_dir;
    char *mesh_path; /* where the mesh was found, owned */
    struct wish camera, light;
    float scale;
    uint32_t texture_size;
};

static char *find_mesh(struct reader *reader, struct fy_node *node, const char *scene_path,
                       const char *scenes_dir)
{
    const char *text = fy_node_get_scalar0(node), *slash = strrchr(scene_path, '/');
    const char *name = text ? text : "";
    int folder = slash ? (int)(slash - scene_path + 1) : 0;
    char *candidate[2] = {NULL, NULL};
    int beside = !text            ? -1
                 : name[0] == '/' ? asprintf(&candidate[0], "%s", name)
                                  : asprintf(&candidate[0], "%.*s%s", folder, scene_path, name);
    int below =
        scenes_dir && name[0] != '/' ? asprintf(&candidate[1], "%s/%s", scenes_dir, name) : 0;
    char *found = NULL;
    for (int i = 0; i < 2 && !found && beside >= 0 && below >= 0; i++)
        if (candidate[i] && access(candidate[i], R_OK) == 0) {
            found = candidate[i];
            candidate[i] = NULL;
        }
    if (beside < 0 || below < 0)
        reader_report(reader, node, "out of memory");
    else if (!found)
        reader_report(reader, node,
                      "mesh `%s` not found: looked for %s%s%s; name the folder that holds it as "
                      "folder of scenes, or in the environment variable DIPTYCH_SCENES%s (the "
                      "well-known test scenes are at https://casual-effects.com/data)",
                      name, candidate[0], candidate[1] ? " and " : "",
                      candidate[1] ? candidate[1] : "",
                      scenes_dir ? "" : ", neither of which is given now");
    free(candidate[0]);
    free(candidate[1]);
    return found;
}

static void read_wish(struct reader *reader, const struct key *key, const struct key *mesh,
                      struct wish *wish)
{
    wish->open = !key->node || fy_node_is_scalar(key->node);
    if (!wish->open)
        return;
    wish->place = yaml_loc(NULL, key->node ? key->node : mesh->node);
    if (key->node && !(wish->name = strdup(fy_node_get_scalar0(key->node))))
        reader_report(reader, key->node, "out of memory");
}

static void read_scene(struct reader *reader, struct fy_node *root, void *user)
{
    struct settings *settings = user;
    struct scene *scene = settings->scene;
    enum { MESH, SCALE, CAMERA, LIGHT, TEXTURE_SIZE, COUNT };
    struct key keys[COUNT] = {
        [MESH] = {.name = "mesh", .type = KEY_TEXT, .required = true},
        [SCALE] = KEY_OF_NUMBERS("scale", false, 1, 1e-6, 1e6, 1),
        [CAMERA] = {.name = "camera", .type = KEY_MAPPING_OR_TEXT},
        [LIGHT] = {.name = "light", .type = KEY_MAPPING_OR_TEXT},
        [TEXTURE_SIZE] = KEY_OF_NUMBERS("texture_size", false, 1, 1, MAX_TEXTURE_SIZE, 0),
    };
    struct fy_node_pair *first = fy_node_mapping_get_by_index(root, 0);
    reader_mapping(reader, root, first ? fy_node_pair_key(first) : root, "the scene", keys, COUNT);
    if (keys[CAMERA].node && fy_node_is_mapping(keys[CAMERA].node))
        read_camera(reader, &keys[CAMERA], &scene->camera);
    if (keys[LIGHT].node && fy_node_is_mapping(keys[LIGHT].node))
        read_light(reader, &keys[LIGHT], &scene->light);
    read_wish(reader, &keys[CAMERA], &keys[MESH], &settings->camera);
    read_wish(reader, &keys[LIGHT], &keys[MESH], &settings->light);
    double size = keys[TEXTURE_SIZE].number[0];
    if (size >= 1 && size <= MAX_TEXTURE_SIZE && exp2(floor(log2(size))) != size)
        reader_report(reader, keys[TEXTURE_SIZE].node, "`texture_size` must be a power of two");
    if (keys[MESH].node && fy_node_is_scalar(keys[MESH].node))
        settings->mesh_path = find_mesh(reader, keys[MESH].node, scene->path, settings->scenes_dir);
    settings->scale = (float)keys[SCALE].number[0];
    settings->texture_size = (uint32_t)size;
}

static const struct file_kind scene_file = {
    .name = "scene", .keys = "`mesh`, `camera` and `light`", .read = read_scene};

static void free_settings(struct settings *settings)
{
    free(settings->mesh_path);
    free(settings->camera.name);
    free(settings->light.name);
}

/* ---- Cameras and lights of the mesh file ----------------------------------------------------- */

/* Names of the mesh file's cameras or lights; "none" without any. Owned by the caller. */
static char *list_views(const struct mesh *mesh, bool is_light)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    for (uint32_t i = 0; out && i < mesh->view_count; i++)
        if (mesh->views[i].is_light == is_light)
            fprintf(out, "%s`%s`", ftell(out) ? ", " : "", mesh->views[i].name);
    if (out && ftell(out) == 0)
        fputs("none", out);
    if (out)
        fclose(out);
    return text;
}

static const struct mesh_view *pick(const struct settings *settings, const struct mesh *mesh,
                                    bool is_light, const struct dt_log *log)
{
    const struct wish *wish = is_light ? &settings->light : &settings->camera;
    const char *what = is_light ? "light" : "camera", *path = settings->scene->path;
    const struct mesh_view *found = NULL;
    for (uint32_t i = 0; i < mesh->view_count && !found; i++) {
        const struct mesh_view *view = &mesh->views[i];
        if (view->is_light == is_light &&
            (wish->name ? strcmp(view->name, wish->name) == 0 : !view->trouble))
            found = view;
    }
    if (found && !found->trouble) {
        report_message(log, DT_INFO, "%s: %s `%s` of the mesh file", path, what, found->name);
        return found;
    }
    char *names = list_views(mesh, is_light);
    const struct source source = {.path = path};
    struct loc place = wish->place;
    place.source = &source;
    if (found)
        report_at(log, place, "the %s `%s` of %s cannot be used: %s", what, found->name,
                  settings->mesh_path, found->trouble);
    else if (wish->name)
        report_at(log, place, "no %s `%s` in %s; it has %s", what, wish->name, settings->mesh_path,
                  names ? names : "?");
    else
        report_at(log, place,
                  "the scene lacks the key `%s`, and no %s of %s can be used; it has %s", what,
                  what, settings->mesh_path, names ? names : "?");
    free(names);
    return NULL;
}

static bool take_views(struct scene *scene, const struct settings *settings,
                       const struct mesh *mesh, const struct dt_log *log)
{
    const struct mesh_view *camera =
        settings->camera.open ? pick(settings, mesh, false, log) : NULL;
    if (camera)
        scene->camera = camera->camera;
    if (settings->camera.open && !camera)
        return false;
    const struct mesh_view *light = settings->light.open ? pick(settings, mesh, true, log) : NULL;
    if (light)
        scene->light = light->light;
    return light || !settings->light.open;
}

/* Mesh, bounds and textures; the arrays move from the mesh into the scene. */
static bool load_mesh(struct scene *scene, const struct settings *settings,
                      const struct dt_log *log)
{
    struct mesh mesh;
    child_opens(settings->mesh_path);
    if (!input_room(MOST_OPEN_FILES))
        return report_error(
            log,
            "%s: reading it takes up to %d open files, and this process may not open so "
            "many; see `ulimit -n`",
            settings->mesh_path, MOST_OPEN_FILES);
    if (!mesh_import(&mesh, settings->mesh_path, scene->path, settings->scale, log))
        return false;
    mesh_bounds(&mesh, mesh.indices, mesh.index_count, scene->bounds_min, scene->bounds_max,
                scene->center, &scene->radius);
    bool ok = take_views(scene, settings, &mesh, log);
    ok = ok && texture_array(&scene->data, &mesh, settings->texture_size, log);
    if (ok) {
        mesh_bound_objects(&mesh);
        ok = mesh_number(&mesh, log);
    }
    if (ok) {
        scene->source_triangles = mesh.source_triangles;
        scene->degenerate_triangles = mesh.degenerate_triangles;
        scene->data.vertices = mesh.vertices;
        scene->data.vertex_count = mesh.vertex_count;
        scene->data.indices = mesh.indices;
        scene->data.index_count = mesh.index_count;
        scene->data.materials = mesh.materials;
        scene->data.material_count = mesh.material_count;
        scene->data.objects = mesh.objects;
        scene->data.object_count = mesh.object_count;
        mesh.vertices = NULL;
        mesh.indices = NULL;
        mesh.materials = NULL;
        mesh.objects = NULL;
    }
    mesh_free(&mesh);
    return ok;
}

/* ---- In a child process ---------------------------------------------------------------------- */

/* The arrays of a scene as they are written: the struct, then these one after the other. */
struct array {
    const void **data;
    size_t bytes;
};
enum { ARRAYS = 5 };

static void arrays_of(struct scene *scene, struct array arrays[ARRAYS])
{
    struct dt_scene *d = &scene->data;
    const struct array all[ARRAYS] = {
        {(const void **)&d->vertices, d->vertex_count * sizeof *d->vertices},
        {(const void **)&d->indices, d->index_count * sizeof *d->indices},
        {(const void **)&d->materials, d->material_count * sizeof *d->materials},
        {(const void **)&d->objects, d->object_count * sizeof *d->objects},
        {(const void **)&d->texels, scene_texel_bytes(d)},
    };
    memcpy(arrays, all, sizeof all);
}

static bool write_mesh(FILE *result, void *user, const struct dt_log *log)
{
    const struct settings *settings = user;
    struct scene *scene = settings->scene;
    struct array arrays[ARRAYS];
    if (!load_mesh(scene, settings, log))
        return false;
    arrays_of(scene, arrays);
    fwrite(scene, sizeof *scene, 1, result); /* child_run checks the stream */
    for (int i = 0; i < ARRAYS; i++)
        fwrite(*arrays[i].data, 1, arrays[i].bytes, result);
    return true;
}

static bool read_mesh(struct scene *scene, FILE *result, const struct dt_log *log)
{
    struct scene from;
    struct array arrays[ARRAYS];
    bool good = fread(&from, sizeof from, 1, result) == 1;
    if (good) {
        from.path = scene->path; /* pointers of the other process */
        from.motion = scene->motion;
        from.data.vertices = NULL;
        from.data.indices = NULL;
        from.data.materials = NULL;
        from.data.objects = NULL;
        from.data.texels = NULL;
        *scene = from;
        arrays_of(scene, arrays);
    }
    for (int i = 0; good && i < ARRAYS; i++) {
        void *memory = malloc(arrays[i].bytes ? arrays[i].bytes : 1);
        *arrays[i].data = memory;
        good = memory && fread(memory, 1, arrays[i].bytes, result) == arrays[i].bytes;
    }
    return good || report_error(log, "%s: out of memory", scene->path);
}

static bool load_mesh_apart(struct scene *scene, struct settings *settings,
                            const struct dt_log *log)
{
    FILE *result = child_run(write_mesh, settings, log);
    bool good = result && read_mesh(scene, result, log);
    if (result)
        fclose(result);
    return good;
}

/* ---- The whole ------------------------------------------------------------------------------- */

static bool copy_path(struct scene *scene, const char *path, const struct dt_log *log)
{
    scene->path = strdup(path);
    return scene->path || report_error(log, "%s: out of memory", path);
}

bool scene_load(struct scene *scene, const char *path, const char *scenes_dir, bool apart,
                const struct dt_log *log)
{
    *scene = (struct scene){0};
    struct settings settings = {.scene = scene, .scenes_dir = scenes_dir};
    bool ok = copy_path(scene, path, log) && reader_file(path, &scene_file, &settings, log) &&
              (apart ? load_mesh_apart(scene, &settings, log) : load_mesh(scene, &settings, log));
    free_settings(&settings);
    if (!ok)
        scene_free(scene);
    return ok;
}

bool scene_none(struct scene *scene, const struct dt_log *log)
{
    struct dt_vertex *vertices = calloc(1, sizeof *vertices);
    uint32_t *indices = calloc(3, sizeof *indices);
    struct dt_material *materials = calloc(1, sizeof *materials);
    struct dt_object *objects = calloc(1, sizeof *objects);
    uint8_t *texels = calloc(4, 1);
    *scene = (struct scene){
        .data = {.vertices = vertices,
                 .vertex_count = 1,
                 .indices = indices,
                 .index_count = 3,
                 .materials = materials,
                 .material_count = 1,
                 .objects = objects,
                 .object_count = 1,
                 .texels = texels,
                 .texture_width = 1,
                 .texture_height = 1,
                 .texture_layers = 1,
                 .texture_mips = 1},
        .camera = {.eye = {0, 0, 4}, .up = {0, 1, 0}, .fov_y = 0.7f},
        .light = {.kind = DT_LIGHT_DIRECTIONAL,
                  .direction = {0, -1, 0},
                  .color = {1, 1, 1},
                  .opening_min = {-1, -1, -1},
                  .opening_max = {1, 1, 1}},
        .bounds_min = {-1, -1, -1},
        .bounds_max = {1, 1, 1},
        .radius = 1.7320508f,
    };
    if (vertices && indices && materials && objects && texels)
        return true;
    report_error(log, "out of memory");
    scene_free(scene);
    return false;
}

bool scene_load_motion(struct scene *scene, const char *path, const struct dt_log *log)
{
    motion_free(scene->motion);
    scene->motion = motion_load(path, scene, log);
    return scene->motion;
}

void scene_free(struct scene *scene)
{
    free((void *)scene->data.vertices);
    free((void *)scene->data.indices);
    free((void *)scene->data.materials);
    free((void *)scene->data.objects);
    free((void *)scene->data.texels);
    free(scene->path);
    motion_free(scene->motion);
    *scene = (struct scene){0};
}
