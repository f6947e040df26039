/* Scene files: YAML to struct scene, with a compiler's diagnostics, all of them in one run. The
 * app is the caller.
 *
 *   mesh: cornell.obj         beside this file, else below the folder of --scenes or DIPTYCH_SCENES
 *   scale: 1                  multiplies the mesh; everything below is in the unit after that
 *   camera: {eye: [0, 1, 3], target: [0, 1, 0], up: [0, 1, 0], fov_y: 40}     up is optional
 *   light: {kind: spot, position: [0, 2, 0], target: [-1, 1, 0], cone: [25, 35],
 *           intensity: [10, 10, 10]}
 *   light: {kind: directional, direction: [0, -1, 0], irradiance: [8, 8, 8],
 *           opening_min: [-1, 3, -1], opening_max: [1, 3, 1]}
 *   subdivide: 0.0625         longest edge after it, in radii of the bounding sphere; 0: none
 *   texture_size: 512         of every layer, a power of two; else the largest's, up to 1024
 *
 * Angles in degrees: fov_y is the whole angle, cone the inner and outer half angle. A spot may
 * have `direction` instead of `target`. Both ends of the opening are optional together: a box that
 * all light must pass through, such as a hole in a roof; without it light comes from everywhere.
 * Irradiance is perpendicular to the rays (W/m2), intensity that on the axis (W/sr). */
#include "scene.h"
#include "mesh.h"

#include <libfyaml.h>

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { TRIANGLE_LIMIT = 4000000, MAX_TEXTURE_SIZE = 4096 };

enum key_type { KEY_TEXT, KEY_NUMBERS, KEY_MAPPING };

/* One key of a mapping: what it takes, and after reading, where it stands (NULL: nowhere). */
struct key {
    const char *name;
    enum key_type type;
    bool required;
    int count;        /* KEY_NUMBERS: 1 is a plain number, else a sequence */
    double min, max;  /* KEY_NUMBERS: every component lies between */
    double number[3]; /* KEY_NUMBERS: the default, then the value */
    struct fy_node *name_node, *node;
};

struct reader {
    FILE *diagnostics;
    int errors;
};

/* ---- Diagnostics ----------------------------------------------------------------------------- */

static void collect(struct fy_diag *diag, void *user, const char *text, size_t length)
{
    (void)diag;
    struct reader *reader = user;
    fwrite(text, 1, length, reader->diagnostics);
    reader->errors += length > 0;
}

__attribute__((format(printf, 3, 4))) static void
report(struct reader *reader, struct fy_node *node, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fy_node_vreport(node, FYET_ERROR, format, arguments);
    va_end(arguments);
    reader->errors++;
}

static size_t smallest(size_t a, size_t b, size_t c)
{
    return a < b ? (a < c ? a : c) : (b < c ? b : c);
}

/* Levenshtein's distance; words of up to 31 letters. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t row[32], length = strlen(b);
    if (length >= DT_ARRAY_COUNT(row))
        return SIZE_MAX;
    for (size_t j = 0; j <= length; j++)
        row[j] = j;
    for (size_t i = 0; a[i]; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < length; j++) {
            size_t next = smallest(row[j] + 1, row[j + 1] + 1, diagonal + (a[i] != b[j]));
            diagonal = row[j + 1];
            row[j + 1] = next;
        }
    }
    return row[length];
}

static void report_unknown(struct reader *reader, struct fy_node *node, const char *name,
                           const struct key *keys, size_t count)
{
    const struct key *nearest = NULL;
    size_t best = 1 + strlen(name) / 2;
    for (size_t i = 0; i < count; i++) {
        bool begins = *name && strncmp(name, keys[i].name, strlen(name)) == 0;
        size_t distance = begins ? 0 : edit_distance(name, keys[i].name);
        if (distance < best) {
            best = distance;
            nearest = &keys[i];
        }
    }
    if (nearest)
        report(reader, node, "unknown key `%s`; did you mean `%s`?", name, nearest->name);
    else
        report(reader, node, "unknown key `%s`", name);
}

/* ---- Mappings -------------------------------------------------------------------------------- */

static bool parse_number(struct fy_node *node, double *number)
{
    const char *text = node && fy_node_is_scalar(node) ? fy_node_get_scalar0(node) : NULL;
    if (!text || !*text)
        return false;
    char *end;
    *number = strtod(text, &end);
    return *end == '\0' && isfinite(*number);
}

static void read_numbers(struct reader *reader, struct key *key)
{
    bool plain = key->count == 1;
    if (!plain &&
        (!fy_node_is_sequence(key->node) || fy_node_sequence_item_count(key->node) != key->count)) {
        report(reader, key->node, "`%s` takes a sequence of %d numbers", key->name, key->count);
        return;
    }
    for (int i = 0; i < key->count; i++) {
        struct fy_node *item = plain ? key->node : fy_node_sequence_get_by_index(key->node, i);
        if (!parse_number(item, &key->number[i]))
            report(reader, item, "`%s` takes a %s here", key->name, "finite number");
        else if (key->number[i] < key->min || key->number[i] > key->max)
            report(reader, item, "`%s` is out of range: it lies between %g and %g", key->name,
                   key->min, key->max);
    }
}

static void read_value(struct reader *reader, struct key *key)
{
    if (key->type == KEY_NUMBERS)
        read_numbers(reader, key);
    else if (key->type == KEY_MAPPING && !fy_node_is_mapping(key->node))
        report(reader, key->node, "`%s` takes a mapping", key->name);
    else if (key->type == KEY_TEXT &&
             (!fy_node_is_scalar(key->node) || !*fy_node_get_scalar0(key->node)))
        report(reader, key->node, "`%s` takes a text", key->name);
}

/* Fills the keys from a mapping. A missing key is reported at `place`, the key that has this
 * mapping as its value: a whole mapping under a caret would be many lines. */
static void read_mapping(struct reader *reader, struct fy_node *mapping, struct fy_node *place,
                         const char *owner, struct key *keys, size_t count)
{
    void *position = NULL;
    struct fy_node_pair *pair;
    while ((pair = fy_node_mapping_iterate(mapping, &position))) {
        struct fy_node *name_node = fy_node_pair_key(pair);
        const char *name =
            name_node && fy_node_is_scalar(name_node) ? fy_node_get_scalar0(name_node) : NULL;
        struct key *key = NULL;
        for (size_t i = 0; name && i < count; i++)
            if (strcmp(name, keys[i].name) == 0)
                key = &keys[i];
        if (!key) {
            report_unknown(reader, name_node ? name_node : mapping, name ? name : "?", keys, count);
            continue;
        }
        key->name_node = name_node;
        key->node = fy_node_pair_value(pair);
        if (key->node)
            read_value(reader, key);
        else
            report(reader, name_node, "`%s` has no value", name);
    }
    for (size_t i = 0; i < count; i++)
        if (keys[i].required && !keys[i].node)
            report(reader, place, "%s lacks the key `%s`", owner, keys[i].name);
}

static void copy3(const struct key *key, float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (float)key->number[i];
}

static double length3(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The unit vector along to - from; false if they coincide. */
static bool direction3(const double from[3], const double to[3], float out[3])
{
    double v[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]}, length = length3(v);
    if (!(length > 0))
        return false;
    for (int i = 0; i < 3; i++)
        out[i] = (float)(v[i] / length);
    return true;
}

/* ---- Camera and light ------------------------------------------------------------------------ */

#define NUMBERS(name, required, count, min, max, ...)                                              \
    {                                                                                              \
        name, KEY_NUMBERS, required, count, min, max, {__VA_ARGS__}, NULL, NULL                    \
    }
#define FAR 1e9 /* no coordinate, no light lies beyond */

static void read_camera(struct reader *reader, const struct key *self, struct scene_camera *camera)
{
    enum { EYE, TARGET, UP, FOV_Y, COUNT };
    struct key keys[COUNT] = {
        [EYE] = NUMBERS("eye", true, 3, -FAR, FAR, 0),
        [TARGET] = NUMBERS("target", true, 3, -FAR, FAR, 0),
        [UP] = NUMBERS("up", false, 3, -FAR, FAR, 0, 1, 0),
        [FOV_Y] = NUMBERS("fov_y", true, 1, 1, 170, 40),
    };
    int errors = reader->errors;
    read_mapping(reader, self->node, self->name_node, "camera", keys, COUNT);
    if (reader->errors > errors)
        return;
    float view[3], up[3];
    const double zero[3] = {0};
    if (!direction3(keys[EYE].number, keys[TARGET].number, view)) {
        report(reader, keys[TARGET].node, "`target` is where `eye` is; move one of them");
    } else if (!direction3(zero, keys[UP].number, up) ||
               fabsf(view[0] * up[0] + view[1] * up[1] + view[2] * up[2]) > 0.9999f) {
        report(reader, keys[UP].node ? keys[UP].node : self->name_node,
               "`up` must not be zero nor lie along the line of sight; give another `up`");
    }
    copy3(&keys[EYE], camera->eye);
    copy3(&keys[TARGET], camera->target);
    copy3(&keys[UP], camera->up);
    camera->fov_y = (float)(keys[FOV_Y].number[0] * M_PI / 180);
}

static void read_directional(struct reader *reader, const struct key *self,
                             struct scene_light *light)
{
    enum { KIND, DIRECTION, IRRADIANCE, OPENING_MIN, OPENING_MAX, COUNT };
    struct key keys[COUNT] = {
        [KIND] = {.name = "kind", .type = KEY_TEXT, .required = true},
        [DIRECTION] = NUMBERS("direction", true, 3, -FAR, FAR, 0),
        [IRRADIANCE] = NUMBERS("irradiance", true, 3, 0, FAR, 0),
        [OPENING_MIN] = NUMBERS("opening_min", false, 3, -FAR, FAR, -FAR, -FAR, -FAR),
        [OPENING_MAX] = NUMBERS("opening_max", false, 3, -FAR, FAR, FAR, FAR, FAR),
    };
    read_mapping(reader, self->node, self->name_node, "a directional light", keys, COUNT);
    light->kind = DT_LIGHT_DIRECTIONAL;
    const double *low = keys[OPENING_MIN].number, *high = keys[OPENING_MAX].number;
    if (!keys[OPENING_MIN].node != !keys[OPENING_MAX].node)
        report(reader, self->name_node, "`opening_min` and `opening_max` go together");
    else if (low[0] > high[0] || low[1] > high[1] || low[2] > high[2])
        report(reader, keys[OPENING_MIN].node, "`opening_min` must not lie above `opening_max`");
    copy3(&keys[OPENING_MIN], light->opening_min);
    copy3(&keys[OPENING_MAX], light->opening_max);
    copy3(&keys[IRRADIANCE], light->color);
    const double zero[3] = {0};
    if (keys[DIRECTION].node && fy_node_is_sequence(keys[DIRECTION].node) &&
        !direction3(zero, keys[DIRECTION].number, light->direction))
        report(reader, keys[DIRECTION].node, "`direction` must not be zero");
}

static void read_spot(struct reader *reader, const struct key *self, struct scene_light *light)
{
    enum { KIND, POSITION, TARGET, DIRECTION, CONE, INTENSITY, COUNT };
    struct key keys[COUNT] = {
        [KIND] = {.name = "kind", .type = KEY_TEXT, .required = true},
        [POSITION] = NUMBERS("position", true, 3, -FAR, FAR, 0),
        [TARGET] = NUMBERS("target", false, 3, -FAR, FAR, 0),
        [DIRECTION] = NUMBERS("direction", false, 3, -FAR, FAR, 0),
        [CONE] = NUMBERS("cone", true, 2, 0, 85,
                         0), /* the light view is one perspective: less than half of space */
        [INTENSITY] = NUMBERS("intensity", true, 3, 0, FAR, 0),
    };
    int errors = reader->errors;
    read_mapping(reader, self->node, self->name_node, "a spot light", keys, COUNT);
    if (!keys[TARGET].node == !keys[DIRECTION].node)
        report(reader, self->name_node, "a spot light takes either `target` or `direction`");
    if (reader->errors > errors)
        return;
    const double *position = keys[POSITION].number, zero[3] = {0};
    bool aimed = keys[TARGET].node ? direction3(position, keys[TARGET].number, light->direction)
                                   : direction3(zero, keys[DIRECTION].number, light->direction);
    if (!aimed)
        report(reader, keys[TARGET].node ? keys[TARGET].node : keys[DIRECTION].node,
               keys[TARGET].node ? "`target` is where `position` is; move one of them"
                                 : "`direction` must not be zero");
    const double *cone = keys[CONE].number;
    if (cone[1] < 0.1 || cone[0] > cone[1])
        report(reader, keys[CONE].node,
               "`cone` is [inner, outer] with 0 <= inner <= outer and outer at least 0.1 degrees");
    light->kind = DT_LIGHT_SPOT;
    copy3(&keys[POSITION], light->position);
    copy3(&keys[INTENSITY], light->color);
    for (int i = 0; i < 2; i++)
        light->cone[i] = (float)(cone[i] * M_PI / 180);
}

static void read_light(struct reader *reader, const struct key *self, struct scene_light *light)
{
    struct fy_node *kind = fy_node_mapping_lookup_value_by_simple_key(self->node, "kind", 4);
    const char *text = kind && fy_node_is_scalar(kind) ? fy_node_get_scalar0(kind) : NULL;
    if (text && strcmp(text, "directional") == 0)
        read_directional(reader, self, light);
    else if (text && strcmp(text, "spot") == 0)
        read_spot(reader, self, light);
    else
        report(reader, kind ? kind : self->name_node,
               "`kind` of a light is `directional` or `spot`");
}

/* ---- The file -------------------------------------------------------------------------------- */

/* What the file says beyond camera and light. */
struct settings {
    char *mesh_path;    /* where the mesh was found, owned */
    bool may_lack_mesh; /* asked by the caller: a mesh that is nowhere is no error */
    float scale, subdivide;
    uint32_t texture_size;
};

static char *find_mesh(struct reader *reader, struct fy_node *node, const char *scene_path,
                       const char *scenes_dir, bool may_lack)
{
    const char *name = fy_node_get_scalar0(node), *slash = strrchr(scene_path, '/');
    int folder = slash ? (int)(slash - scene_path + 1) : 0;
    char *candidate[2] = {NULL, NULL};
    int beside = name[0] == '/' ? asprintf(&candidate[0], "%s", name)
                                : asprintf(&candidate[0], "%.*s%s", folder, scene_path, name);
    int below =
        scenes_dir && name[0] != '/' ? asprintf(&candidate[1], "%s/%s", scenes_dir, name) : 0;
    char *found = NULL;
    for (int i = 0; i < 2 && !found && beside >= 0 && below >= 0; i++)
        if (candidate[i] && access(candidate[i], R_OK) == 0) {
            found = candidate[i];
            candidate[i] = NULL;
        }
    if (!found && !may_lack)
        report(reader, node,
               "mesh `%s` not found: looked for %s%s%s; name the folder that holds it with "
               "--scenes DIR or in the "
               "environment variable DIPTYCH_SCENES%s (the well-known test scenes are at "
               "https://casual-effects.com/data)",
               name, candidate[0], candidate[1] ? " and " : "", candidate[1] ? candidate[1] : "",
               scenes_dir ? "" : ", neither of which is given now");
    free(candidate[0]);
    free(candidate[1]);
    return found;
}

static void read_scene(struct reader *reader, struct fy_node *root, const char *scenes_dir,
                       struct scene *scene, struct settings *settings)
{
    enum { MESH, SCALE, CAMERA, LIGHT, SUBDIVIDE, TEXTURE_SIZE, COUNT };
    struct key keys[COUNT] = {
        [MESH] = {.name = "mesh", .type = KEY_TEXT, .required = true},
        [SCALE] = NUMBERS("scale", false, 1, 1e-6, 1e6, 1),
        [CAMERA] = {.name = "camera", .type = KEY_MAPPING, .required = true},
        [LIGHT] = {.name = "light", .type = KEY_MAPPING, .required = true},
        [SUBDIVIDE] = NUMBERS("subdivide", false, 1, 0, 2, 1.0 / 16),
        [TEXTURE_SIZE] = NUMBERS("texture_size", false, 1, 1, MAX_TEXTURE_SIZE, 0),
    };
    struct fy_node_pair *first = fy_node_mapping_get_by_index(root, 0);
    read_mapping(reader, root, first ? fy_node_pair_key(first) : root, "the scene", keys, COUNT);
    if (keys[CAMERA].node && fy_node_is_mapping(keys[CAMERA].node))
        read_camera(reader, &keys[CAMERA], &scene->camera);
    if (keys[LIGHT].node && fy_node_is_mapping(keys[LIGHT].node))
        read_light(reader, &keys[LIGHT], &scene->light);
    double size = keys[TEXTURE_SIZE].number[0];
    if (size >= 1 && size <= MAX_TEXTURE_SIZE && exp2(floor(log2(size))) != size)
        report(reader, keys[TEXTURE_SIZE].node, "`texture_size` must be a power of two");
    if (keys[MESH].node && fy_node_is_scalar(keys[MESH].node))
        settings->mesh_path =
            find_mesh(reader, keys[MESH].node, scene->path, scenes_dir, settings->may_lack_mesh);
    settings->scale = (float)keys[SCALE].number[0];
    settings->subdivide = (float)keys[SUBDIVIDE].number[0];
    settings->texture_size = (uint32_t)size;
}

/* Reports into reader; true if nothing was wrong. */
static bool read_document(struct reader *reader, const char *scenes_dir, struct scene *scene,
                          struct settings *settings)
{
    struct fy_diag_cfg diag_config;
    fy_diag_cfg_default(&diag_config);
    diag_config.fp = NULL;
    diag_config.output_fn = collect;
    diag_config.user = reader;
    diag_config.colorize = false;
    struct fy_diag *diag = fy_diag_create(&diag_config);
    struct fy_parse_cfg config = {.search_path = "", .diag = diag};
    struct fy_document *document = diag ? fy_document_build_from_file(&config, scene->path) : NULL;
    struct fy_node *root = document ? fy_document_root(document) : NULL;
    if (root && fy_node_is_mapping(root)) {
        read_scene(reader, root, scenes_dir, scene, settings);
    } else if (root) {
        report(reader, root,
               "a scene file is a mapping with the keys `mesh`, `camera` and `light`");
    } else if (reader->errors == 0) {
        fprintf(reader->diagnostics, "%s: cannot be read as YAML", scene->path);
        reader->errors++;
    }
    fy_document_destroy(document);
    if (diag)
        fy_diag_destroy(diag);
    return reader->errors == 0;
}

static bool is_readable_file(const char *path, const struct dt_log *log)
{
    struct stat status;
    if (stat(path, &status) != 0 || access(path, R_OK) != 0)
        log_message(log, DT_ERROR, "cannot open scene file %s: %s", path, strerror(errno));
    else if (S_ISDIR(status.st_mode))
        log_message(log, DT_ERROR, "%s is a folder; name a scene file (YAML) in it", path);
    else if (status.st_size == 0 && S_ISREG(status.st_mode))
        log_message(log, DT_ERROR,
                    "%s:1:1: error: the file is empty; a scene has `mesh`, `camera` and `light`",
                    path);
    else
        return true;
    return false;
}

static bool read_file(const char *scenes_dir, struct scene *scene, struct settings *settings,
                      const struct dt_log *log)
{
    char *text = NULL;
    size_t size = 0;
    struct reader reader = {.diagnostics = open_memstream(&text, &size)};
    bool ok = reader.diagnostics && read_document(&reader, scenes_dir, scene, settings);
    if (reader.diagnostics)
        fclose(reader.diagnostics);
    while (size > 0 && text[size - 1] == '\n')
        text[--size] = '\0';
    if (!ok)
        log_message(log, DT_ERROR, "%s", text ? text : "out of memory");
    free(text);
    return ok;
}

/* Mesh, bounds, subdivision and textures; the arrays move from the mesh into the scene. */
static bool load_mesh(struct scene *scene, const struct settings *settings,
                      const struct dt_log *log)
{
    struct mesh mesh;
    if (!mesh_import(&mesh, settings->mesh_path, settings->scale, log))
        return false;
    mesh_bounds(&mesh, scene->bounds_min, scene->bounds_max, scene->center, &scene->radius);
    bool ok = settings->subdivide == 0 ||
              mesh_subdivide(&mesh, settings->subdivide * scene->radius, TRIANGLE_LIMIT, log);
    ok = ok && texture_array(&scene->data, &mesh, settings->texture_size, log);
    if (ok) {
        scene->source_triangles = mesh.source_triangles;
        scene->degenerate_triangles = mesh.degenerate_triangles;
        scene->data.vertices = mesh.vertices;
        scene->data.vertex_count = mesh.vertex_count;
        scene->data.indices = mesh.indices;
        scene->data.index_count = mesh.index_count;
        scene->data.materials = mesh.materials;
        scene->data.material_count = mesh.material_count;
        mesh.vertices = NULL;
        mesh.indices = NULL;
        mesh.materials = NULL;
    }
    mesh_free(&mesh);
    return ok;
}

bool scene_load(struct scene *scene, const char *path, const char *scenes_dir,
                const struct dt_log *log)
{
    *scene = (struct scene){0};
    struct settings settings = {0};
    if (!is_readable_file(path, log))
        return false;
    scene->path = strdup(path);
    bool ok = scene->path && read_file(scenes_dir, scene, &settings, log) &&
              load_mesh(scene, &settings, log);
    free(settings.mesh_path);
    if (!ok)
        scene_free(scene);
    return ok;
}

bool scene_find_mesh(const char *path, const char *scenes_dir, char **mesh,
                     const struct dt_log *log)
{
    struct scene scene = {0};
    struct settings settings = {.may_lack_mesh = true};
    bool ok = is_readable_file(path, log);
    scene.path = ok ? strdup(path) : NULL;
    ok = ok && scene.path && read_file(scenes_dir, &scene, &settings, log);
    scene_free(&scene);
    if (!ok)
        free(settings.mesh_path);
    *mesh = ok ? settings.mesh_path : NULL;
    return ok;
}

void scene_free(struct scene *scene)
{
    free((void *)scene->data.vertices);
    free((void *)scene->data.indices);
    free((void *)scene->data.materials);
    free((void *)scene->data.texels);
    free(scene->path);
    *scene = (struct scene){0};
}
