/* Nodes and triangles of a glTF file; see gltf.h. */
#include "gltf.h"

#include "base/input.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { TRIANGLES = 4, TRIANGLE_STRIP, TRIANGLE_FAN };

/* ---- Nodes ----------------------------------------------------------------------------------- */

static void multiply(const double a[4][4], const double b[4][4], double out[4][4])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) {
            out[c][r] = 0;
            for (int k = 0; k < 4; k++)
                out[c][r] += a[k][r] * b[c][k];
        }
}

/* Translation * rotation * scale; the rotation is a unit quaternion x, y, z, w. */
static void compose(const float t[3], const float q[4], const float s[3], double out[4][4])
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                               {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                               {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
    for (int c = 0; c < 3; c++) {
        for (int r = 0; r < 3; r++)
            out[c][r] = turn[c][r] * (double)s[c];
        out[c][3] = 0;
        out[3][c] = (double)t[c];
    }
    out[3][3] = 1;
}

/* The node's transform to its parent, by columns. */
static void node_matrix(struct gltf *gltf, struct gltf_item node, double out[4][4])
{
    float matrix[16], t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    if (gltf_numbers(gltf, node, "matrix", 16, matrix)) {
        for (int i = 0; i < 16; i++)
            out[i / 4][i % 4] = (double)matrix[i];
        return;
    }
    gltf_numbers(gltf, node, "translation", 3, t);
    gltf_numbers(gltf, node, "rotation", 4, q);
    gltf_numbers(gltf, node, "scale", 3, s);
    compose(t, q, s, out);
}

/* Nodes are trees: each has one parent at most. A node that stood twice would double whatever is below
 * it. */
static bool find_parents(struct gltf *gltf)
{
    for (uint32_t i = 0; i < gltf->list[GLTF_NODES].count && !gltf->failed; i++) {
        struct gltf_item node = gltf_item(gltf, GLTF_NODES, i);
        const cJSON *element;
        cJSON_ArrayForEach(element, cJSON_GetObjectItemCaseSensitive(node.json, "children"))
        {
            int32_t child = gltf_element(gltf, node, "children", element, GLTF_NODES);
            if (child < 0)
                return false;
            uint32_t *parent = &gltf->list[GLTF_NODES].objects[child].parent;
            if (*parent)
                return gltf_error(gltf, node, "children",
                                  "nodes[%d] is a child of nodes[%u] already; nodes are trees",
                                  child, *parent - 1);
            *parent = i + 1;
        }
    }
    return !gltf->failed;
}

/* Adds the roots of the scene to the stack, the last one first. Returns their number. */
static uint32_t push(struct gltf *gltf, struct gltf_item item, const char *key, uint32_t *stack)
{
    const cJSON *element, *array = cJSON_GetObjectItemCaseSensitive(item.json, key);
    uint32_t count = 0;
    cJSON_ArrayForEach(element, array)
    {
        int32_t node = gltf_element(gltf, item, key, element, GLTF_NODES);
        if (count == gltf->list[GLTF_NODES].count)
            gltf_error(gltf, item, key, "has more elements than there are nodes");
        if (gltf->failed)
            break;
        stack[count++] = (uint32_t)node;
    }
    for (uint32_t i = 0; i < count / 2; i++) {
        uint32_t other = stack[i];
        stack[i] = stack[count - 1 - i];
        stack[count - 1 - i] = other;
    }
    return count;
}

static uint32_t push_roots(struct gltf *gltf, uint32_t *stack)
{
    struct gltf_item root = {gltf->root, GLTF_SCENES, 0};
    const struct gltf_object *nodes = gltf->list[GLTF_NODES].objects;
    int32_t scene = gltf_index(gltf, root, "scene", GLTF_SCENES);
    uint32_t count = 0;
    if (scene < 0 && gltf->list[GLTF_SCENES].count)
        scene = 0;
    if (scene < 0) {
        for (uint32_t i = gltf->list[GLTF_NODES].count; i-- > 0;)
            if (!nodes[i].parent)
                stack[count++] = i;
        return count;
    }
    struct gltf_item item = gltf_item(gltf, GLTF_SCENES, (uint32_t)scene);
    count = push(gltf, item, "nodes", stack);
    for (uint32_t i = 0; i < count; i++)
        if (nodes[stack[i]].parent)
            gltf_error(gltf, item, "nodes", "nodes[%u] is no root, but a child of nodes[%u]",
                       stack[i], nodes[stack[i]].parent - 1);
    return count;
}

/* Writes the nodes of the scene, parents first and in the order of the file, and their matrices.
 * Returns their number. `stack` and `order` have room for all nodes. */
static uint32_t flatten(struct gltf *gltf, uint32_t *stack, uint32_t *order)
{
    uint32_t depth = push_roots(gltf, stack), count = 0;
    while (depth > 0 && !gltf->failed) {
        uint32_t index = stack[--depth];
        struct gltf_item node = gltf_item(gltf, GLTF_NODES, index);
        struct gltf_object *object = gltf_object(gltf, node), *all = gltf->list[GLTF_NODES].objects;
        double own[4][4];
        if (object->matrix[3][3] != 0) {
            gltf_error(gltf, node, NULL, "stands twice in the scene");
            break;
        }
        node_matrix(gltf, node, own);
        if (object->parent)
            multiply(all[object->parent - 1].matrix, own, object->matrix);
        else
            memcpy(object->matrix, own, sizeof own);
        object->matrix[3][3] = 1;
        order[count++] = index;
        depth += push(gltf, node, "children", stack + depth);
    }
    return count;
}

/* ---- Primitives ------------------------------------------------------------------------------ */

/* Index of the accessor of an attribute; -1: none. */
static int32_t attribute(struct gltf *gltf, struct gltf_item primitive, const char *name)
{
    return gltf_index(gltf, gltf_part(gltf, primitive, "attributes"), name, GLTF_ACCESSORS);
}

/* Numbers of triangles that `corners` corners of a mode make. */
static uint32_t count_triangles(uint32_t mode, uint32_t corners)
{
    return mode == TRIANGLES ? corners / 3 : corners < 3 ? 0 : corners - 2;
}

/* The triangles that a primitive claims; 0 for points and lines. Reads no buffer. */
static uint32_t claimed_triangles(struct gltf *gltf, struct gltf_item primitive)
{
    uint32_t mode = gltf_whole(gltf, primitive, "mode", TRIANGLES);
    int32_t from = gltf_index(gltf, primitive, "indices", GLTF_ACCESSORS);
    int32_t positions = attribute(gltf, primitive, "POSITION");
    if (mode > TRIANGLE_FAN)
        gltf_error(gltf, primitive, "primitives.mode", "%u is none of 0 to 6", mode);
    if (mode < TRIANGLES || positions < 0 || gltf->failed)
        return 0;
    struct gltf_item accessor =
        gltf_item(gltf, GLTF_ACCESSORS, (uint32_t)(from >= 0 ? from : positions));
    return count_triangles(mode, gltf_whole(gltf, accessor, "count", 0));
}

/* Floats of an attribute; NULL: none, or failed. */
static const float *take_attribute(struct gltf *gltf, struct gltf_item primitive, const char *name,
                                   uint32_t components, uint32_t count)
{
    int32_t from = attribute(gltf, primitive, name);
    const struct gltf_array *array =
        from < 0 ? NULL : gltf_floats(gltf, (uint32_t)from, components);
    if (array && array->count != count)
        gltf_error(gltf, primitive, "primitives.attributes", "%s has %u elements, and POSITION %u",
                   name, array->count, count);
    return array ? array->floats : NULL;
}

/* The texture coordinates that the material wants. */
static const float *take_uvs(struct gltf *gltf, struct gltf_item primitive,
                             const struct mesh_part *part, uint32_t set)
{
    char name[32];
    snprintf(name, sizeof name, "TEXCOORD_%u", set);
    const float *uvs = take_attribute(gltf, primitive, name, 2, part->vertex_count);
    if (!uvs && set > 0)
        gltf_error(gltf, primitive, "primitives.attributes",
                   "the texture of materials[%u] needs %s", part->material, name);
    return uvs;
}

/* Three indices for each triangle, for free(), every one below `vertices`. NULL: failed. */
static uint32_t *take_indices(struct gltf *gltf, struct gltf_item primitive, uint32_t vertices,
                              uint32_t *triangles)
{
    uint32_t mode = gltf_whole(gltf, primitive, "mode", TRIANGLES);
    int32_t from = gltf_index(gltf, primitive, "indices", GLTF_ACCESSORS);
    const struct gltf_array *array = from < 0 ? NULL : gltf_indices(gltf, (uint32_t)from);
    if (gltf->failed)
        return NULL;
    uint32_t corners = array ? array->count : vertices;
    for (uint32_t i = 0; array && i < corners; i++)
        if (array->indices[i] >= vertices) {
            gltf_error(gltf, gltf_item(gltf, GLTF_ACCESSORS, (uint32_t)from), NULL,
                       "its index %u is %u, and there are %u vertices", i, array->indices[i],
                       vertices);
            return NULL;
        }
    if (mode == TRIANGLES && corners % 3 != 0) {
        gltf_error(gltf, primitive, "primitives", "%u corners are no triangles", corners);
        return NULL;
    }
    *triangles = count_triangles(mode, corners);
    uint32_t *indices = calloc((size_t)*triangles * 3 + 1, sizeof *indices);
    if (!indices)
        gltf_out_of_memory(gltf);
    for (uint32_t t = 0; indices && t < *triangles; t++) {
        const uint32_t strip[3] = {t, t + 1 + t % 2, t + 2 - t % 2}, fan[3] = {t + 1, t + 2, 0};
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t corner = mode == TRIANGLES        ? 3 * t + k
                              : mode == TRIANGLE_STRIP ? strip[k]
                                                       : fan[k];
            indices[3 * (size_t)t + k] = array ? array->indices[corner] : corner;
        }
    }
    return indices;
}

/* Parts of a primitive that cannot be shown. */
static void warn_of_primitive(struct gltf *gltf, struct gltf_item primitive)
{
    if (attribute(gltf, primitive, "COLOR_0") >= 0)
        gltf_warn(gltf, "vertex colours (COLOR_0) are not supported; materials have their colour");
    if (cJSON_GetObjectItemCaseSensitive(primitive.json, "targets"))
        gltf_warn(gltf, "morph targets are not supported; meshes have their base shape");
    if (gltf_extension(gltf, primitive, "KHR_draco_mesh_compression").json)
        gltf_error(gltf, primitive, "primitives",
                   "KHR_draco_mesh_compression is not supported; write the file without it");
}

static bool take_primitive(struct gltf *gltf, struct mesh *mesh, struct gltf_item primitive,
                           struct mesh_part part, const double matrix[4][4], float scale)
{
    warn_of_primitive(gltf, primitive);
    if (gltf->failed || claimed_triangles(gltf, primitive) == 0)
        return !gltf->failed;
    int32_t material = gltf_index(gltf, primitive, "material", GLTF_MATERIALS);
    part.material = material < 0 ? gltf->list[GLTF_MATERIALS].count : (uint32_t)material;
    const struct gltf_array *positions =
        gltf_floats(gltf, (uint32_t)attribute(gltf, primitive, "POSITION"), 3);
    if (!positions)
        return false;
    part.positions = positions->floats;
    part.vertex_count = positions->count;
    part.normals = take_attribute(gltf, primitive, "NORMAL", 3, part.vertex_count);
    part.uvs = take_uvs(gltf, primitive, &part, gltf_mapping(gltf, part.material, &part));
    uint32_t *indices = take_indices(gltf, primitive, part.vertex_count, &part.triangle_count);
    part.indices = indices;
    if (!gltf->failed && !mesh_add(mesh, &part, matrix, scale, gltf->path, gltf->log))
        gltf->failed = true;
    free(indices);
    return !gltf->failed;
}

/* ---- The whole ------------------------------------------------------------------------------- */

/* The mesh of a node; no `json`: it has none. */
static struct gltf_item node_mesh(struct gltf *gltf, uint32_t node)
{
    int32_t index = gltf_index(gltf, gltf_item(gltf, GLTF_NODES, node), "mesh", GLTF_MESHES);
    return index < 0 ? (struct gltf_item){NULL, GLTF_MESHES, 0}
                     : gltf_item(gltf, GLTF_MESHES, (uint32_t)index);
}

static const cJSON *primitives(struct gltf_item mesh)
{
    return mesh.json ? cJSON_GetObjectItemCaseSensitive(mesh.json, "primitives") : NULL;
}

/* Numbers the primitives over the whole file, and adds up the triangles of each mesh. */
static void count_meshes(struct gltf *gltf)
{
    uint32_t number = 0;
    for (uint32_t i = 0; i < gltf->list[GLTF_MESHES].count && !gltf->failed; i++) {
        struct gltf_item mesh = gltf_item(gltf, GLTF_MESHES, i);
        struct gltf_object *object = gltf_object(gltf, mesh);
        const cJSON *primitive;
        object->first = number;
        cJSON_ArrayForEach(primitive, primitives(mesh))
        {
            object->triangles +=
                claimed_triangles(gltf, (struct gltf_item){primitive, GLTF_MESHES, i});
            number++;
        }
    }
}

static bool take_nodes(struct gltf *gltf, struct mesh *mesh, const uint32_t *order, uint32_t count,
                       float scale)
{
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct gltf_item from = node_mesh(gltf, order[i]);
        triangles += from.json ? gltf_object(gltf, from)->triangles : 0;
        if (cJSON_GetObjectItemCaseSensitive(gltf_item(gltf, GLTF_NODES, order[i]).json, "skin"))
            gltf_warn(gltf, "skins are not supported; meshes stand where their nodes are");
    }
    if (cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(gltf->root, "animations")))
        gltf_warn(gltf, "animations are not supported; nodes stand as the file has them");
    if (gltf->failed || !mesh_reserve(mesh, triangles, gltf->path, gltf->log))
        return false;
    for (uint32_t i = 0; i < count && !gltf->failed; i++) {
        struct gltf_item node = gltf_item(gltf, GLTF_NODES, order[i]);
        struct gltf_item from = node_mesh(gltf, order[i]);
        struct mesh_part part = {.mesh = from.json ? gltf_object(gltf, from)->first : 0};
        const cJSON *primitive;
        cJSON_ArrayForEach(primitive, primitives(from))
        {
            struct gltf_item item = {primitive, GLTF_MESHES, from.index};
            if (!take_primitive(gltf, mesh, item, part, gltf_object(gltf, node)->matrix, scale))
                break;
            part.mesh++;
        }
    }
    return !gltf->failed;
}

static bool take_scene(struct gltf *gltf, struct mesh *mesh, float scale)
{
    size_t nodes = gltf->list[GLTF_NODES].count;
    uint32_t *stack = arena_alloc(gltf->arena, 2 * nodes * sizeof *stack);
    uint32_t *order = arena_alloc(gltf->arena, nodes * sizeof *order);
    if (!stack || !order)
        return gltf_out_of_memory(gltf);
    if (!find_parents(gltf))
        return false;
    uint32_t count = flatten(gltf, stack, order);
    count_meshes(gltf);
    return !gltf->failed && take_nodes(gltf, mesh, order, count, scale);
}

bool gltf_import(struct mesh *mesh, float scale, const struct dt_log *log)
{
    struct gltf gltf;
    bool good = gltf_open(&gltf, mesh, log) && gltf_materials(&gltf, mesh) &&
                take_scene(&gltf, mesh, scale) && gltf_views(&gltf, mesh, scale);
    gltf_close(&gltf);
    return good;
}

bool gltf_is(const char *path)
{
    const char *end = strrchr(path, '.'), *reason;
    char start[64] = "";
    if (end && (strcasecmp(end, ".gltf") == 0 || strcasecmp(end, ".glb") == 0 ||
                strcasecmp(end, ".vrm") == 0))
        return true;
    FILE *file = input_open(path, SIZE_MAX, &reason);
    size_t got = file ? fread(start, 1, sizeof start - 1, file) : 0;
    if (file)
        fclose(file);
    return got >= 4 && (memcmp(start, "glTF", 4) == 0 || start[strspn(start, " \t\r\n")] == '{');
}
