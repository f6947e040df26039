/* Mesh files to one flat triangle list: nodes flattened, normals completed, degenerate triangles
 * dropped, equal vertices welded. gltf.c and mesh_assimp.c read the files. */
#include "mesh.h"

#include "diptych_scene.h"
#include "base/foreign.h"
#include "base/log.h"
#include "base/input.h"
#include "gltf.h"

#include <meshoptimizer.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Corners are five times as large as what a GPU gets of them: 6 GiB. */
enum { MOST_TRIANGLES = 1 << 25 };

static bool mesh_out_of_memory(const char *path, const struct dt_log *log)
{
    return report_error(log, "%s: out of memory; the mesh is too large for this machine", path);
}

/* ---- Textures -------------------------------------------------------------------------------- */

char *mesh_path_beside(const char *mesh_path, const char *name)
{
    const char *slash = strrchr(mesh_path, '/');
    int folder = name[0] == '/' || !slash ? 0 : (int)(slash - mesh_path + 1);
    char *path = NULL;
    if (asprintf(&path, "%.*s%s", folder, mesh_path, name) < 0)
        return NULL;
    for (char *c = path; *c; c++)
        if (*c == '\\')
            *c = '/';
    return path;
}

bool mesh_may_name(const struct mesh *mesh, const char *path, const struct dt_log *log)
{
    bool may = foreign_is_beside(path, mesh->path) || foreign_is_beside(path, mesh->scene_path);
    return may || report_error(
                      log,
                      "%s: %s names this file, which is outside the folders of the mesh and of the "
                      "scene file; move one of them",
                      path, mesh->path);
}

int32_t mesh_add_texture(struct mesh *mesh, struct mesh_texture texture)
{
    struct mesh_texture *textures =
        realloc(mesh->textures, (mesh->texture_count + 1) * sizeof *textures);
    if (textures)
        mesh->textures = textures;
    if (textures && texture.color) {
        textures[mesh->texture_count] = texture;
        return (int32_t)mesh->texture_count++;
    }
    free(texture.color);
    free(texture.opacity);
    free(texture.bytes);
    return -1;
}

/* ---- Triangles ------------------------------------------------------------------------------- */

/* Cofactors of the upper 3x3: the inverse transpose times the determinant, which is enough for a
 * direction once the sign of the determinant is taken out. Returns that determinant. */
static double normal_matrix(const double m[4][4], double n[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            n[i][j] = m[j1][i1] * m[j2][i2] - m[j2][i1] * m[j1][i2];
        }
    double determinant = m[0][0] * n[0][0] + m[1][0] * n[0][1] + m[2][0] * n[0][2];
    for (int i = 0; i < 9 && determinant < 0; i++)
        n[i / 3][i % 3] = -n[i / 3][i % 3];
    return determinant;
}

/* Writes the unit vector along v; false if v has no direction. */
static bool normalize(const double v[3], float out[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 1e-30) || !isfinite(length))
        return false;
    for (int i = 0; i < 3; i++)
        out[i] = (float)(v[i] / length);
    return true;
}

/* Unit normal of a triangle. False if the triangle is degenerate: relative to its longest side its
 * height is below single precision. */
static bool face_normal(const struct dt_vertex corner[3], float out[3])
{
    double edge[3][3], longest = 0;
    for (int k = 0; k < 3; k++) {
        double length = 0;
        for (int i = 0; i < 3; i++) {
            edge[k][i] = (double)corner[(k + 1) % 3].position[i] - corner[k].position[i];
            length += edge[k][i] * edge[k][i];
        }
        longest = length > longest ? length : longest;
    }
    const double *a = edge[0], *b = edge[1];
    double cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                       a[0] * b[1] - a[1] * b[0]};
    double area = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
    return area > 1e-7 * longest && normalize(cross, out);
}

/* How the corners of a part come into the scene. */
struct placing {
    const struct mesh_part *part;
    const double (*matrix)[4];
    double normals[3][3];
    float scale;
};

/* False if a number is not finite. */
static bool place_corner(const struct placing *placing, uint32_t index, struct dt_vertex *vertex)
{
    const struct mesh_part *part = placing->part;
    const double(*m)[4] = placing->matrix;
    const float *p = part->positions + 3 * (size_t)index;
    bool finite = true;
    for (int i = 0; i < 3; i++) {
        double moved = m[0][i] * (double)p[0] + m[1][i] * (double)p[1] + m[2][i] * (double)p[2];
        vertex->position[i] = (float)(moved + m[3][i]) * placing->scale;
        finite = finite && isfinite(vertex->position[i]);
    }
    memset(vertex->normal, 0, sizeof vertex->normal);
    if (part->normals) {
        const float *n = part->normals + 3 * (size_t)index;
        double turned[3];
        for (int i = 0; i < 3; i++)
            turned[i] = placing->normals[i][0] * (double)n[0] +
                        placing->normals[i][1] * (double)n[1] +
                        placing->normals[i][2] * (double)n[2];
        normalize(turned, vertex->normal);
    }
    vertex->uv[0] = vertex->uv[1] = 0;
    if (part->uvs) {
        const float *uv = part->uvs + 2 * (size_t)index;
        vertex->uv[0] = part->u[0] * uv[0] + part->u[1] * uv[1] + part->u[2];
        vertex->uv[1] = part->v[0] * uv[0] + part->v[1] * uv[1] + part->v[2];
    }
    return finite && isfinite(vertex->uv[0]) && isfinite(vertex->uv[1]);
}

/* Adds an object, without bounds and triangles. */
static bool add_object(struct mesh *mesh, const struct mesh_part *part, const double m[4][4],
                       double scale)
{
    struct dt_object *objects = realloc(mesh->objects, (mesh->object_count + 1) * sizeof *objects);
    if (!objects)
        return false;
    mesh->objects = objects;
    struct dt_object *object = &objects[mesh->object_count++];
    *object = (struct dt_object){.mesh = part->mesh, .material = part->material};
    double columns[4][4];
    bool finite = true;
    for (int i = 0; i < 16; i++)
        columns[i / 4][i % 4] = i % 4 < 3 ? m[i / 4][i % 4] * scale : i == 15;
    invert(columns, object->inverse);
    for (int i = 0; i < 16; i++) {
        object->transform[i / 4][i % 4] = (float)columns[i / 4][i % 4];
        finite = finite && isfinite(object->inverse[i / 4][i % 4]);
    }
    if (!finite)
        memset(object->inverse, 0, sizeof object->inverse);
    return true;
}

bool mesh_reserve(struct mesh *mesh, uint64_t triangles, const char *path, const struct dt_log *log)
{
    if (triangles > MOST_TRIANGLES)
        return report_error(log, "%s: %llu triangles are too many; %d is the limit", path,
                            (unsigned long long)triangles, MOST_TRIANGLES);
    mesh->vertices = calloc(3 * triangles + 1, sizeof *mesh->vertices);
    return mesh->vertices || mesh_out_of_memory(path, log);
}

bool mesh_add(struct mesh *mesh, const struct mesh_part *part, const double matrix[4][4],
              float scale, const char *path, const struct dt_log *log)
{
    struct placing placing = {.part = part, .matrix = matrix, .scale = scale};
    bool mirrored = normal_matrix(matrix, placing.normals) < 0;
    if (!add_object(mesh, part, matrix, (double)scale))
        return mesh_out_of_memory(path, log);
    for (uint32_t t = 0; t < part->triangle_count; t++) {
        struct dt_vertex corner[3];
        float flat[3];
        for (int k = 0; k < 3; k++) {
            uint32_t index = part->indices[3 * (size_t)t + (size_t)(mirrored ? 2 - k : k)];
            corner[k].material = part->material;
            corner[k].triangle = mesh->object_count - 1;
            if (!place_corner(&placing, index, &corner[k]))
                return report_error(log, "%s: vertex %u of mesh %u has a number that is not finite",
                                    path, index, part->mesh);
        }
        mesh->source_triangles++;
        if (!face_normal(corner, flat)) {
            mesh->degenerate_triangles++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            const float *n = corner[k].normal;
            if (n[0] == 0 && n[1] == 0 && n[2] == 0)
                memcpy(corner[k].normal, flat, sizeof flat);
            mesh->vertices[mesh->vertex_count++] = corner[k];
        }
    }
    return true;
}

/* ---- Welding --------------------------------------------------------------------------------- */

/* One vertex for all corners with the same bits, in order of first use; fills the indices. */
static bool weld(struct mesh *mesh)
{
    uint32_t count = mesh->vertex_count;
    mesh->indices = malloc(count * sizeof *mesh->indices);
    if (!mesh->indices)
        return false;
    mesh->vertex_count = (uint32_t)meshopt_generateVertexRemap(
        mesh->indices, NULL, count, mesh->vertices, count, sizeof *mesh->vertices);
    for (uint32_t i = 0; i < count; i++) /* no index is above its corner's */
        mesh->vertices[mesh->indices[i]] = mesh->vertices[i];
    mesh->index_count = count;
    return true;
}

/* ---- The whole ------------------------------------------------------------------------------- */

static bool import(struct mesh *mesh, const char *path, float scale, const struct dt_log *log)
{
    bool good =
        gltf_is(path) ? gltf_import(mesh, scale, log) : mesh_import_assimp(mesh, scale, log);
    if (good && mesh->vertex_count == 0)
        return report_error(log, "%s: no triangle in this mesh (%u degenerate)", path,
                            mesh->degenerate_triangles);
    return good && (weld(mesh) || mesh_out_of_memory(path, log));
}

/* Adds to errors what the file seems to be. */
struct naming {
    const struct dt_log *log;
    const char *path;
};

static void name_kind(void *user, enum dt_level level, const char *message)
{
    const struct naming *naming = user;
    const char *seen = level == DT_ERROR ? input_seen(naming->path) : NULL;
    report_message(naming->log, level, seen ? "%s; the file is %s" : "%s", message, seen);
}

bool mesh_import(struct mesh *mesh, const char *path, const char *scene_path, float scale,
                 const struct dt_log *log)
{
    *mesh = (struct mesh){.path = path, .scene_path = scene_path};
    struct naming naming = {log, path};
    const struct dt_log named = {name_kind, &naming};
    const char *reason;
    if (!input_check(path, MESH_MOST_BYTES, &reason))
        return report_error(log, "%s: %s", path, reason);
    bool good = import(mesh, path, scale, &named);
    if (!good)
        mesh_free(mesh);
    else if (mesh->degenerate_triangles)
        report_message(log, DT_INFO, "%s: dropped %u degenerate triangles of %u", path,
                       mesh->degenerate_triangles, mesh->source_triangles);
    return good;
}

void mesh_free(struct mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->texture_count; i++) {
        free(mesh->textures[i].color);
        free(mesh->textures[i].opacity);
        free(mesh->textures[i].bytes);
    }
    for (uint32_t i = 0; i < mesh->view_count; i++)
        free(mesh->views[i].name);
    free(mesh->views);
    free(mesh->objects);
    free(mesh->textures);
    free(mesh->materials);
    free(mesh->vertices);
    free(mesh->indices);
    *mesh = (struct mesh){0};
}

void mesh_bounds(const struct mesh *mesh, const uint32_t *indices, uint32_t count, float low[3],
                 float high[3], float center[3], float *radius)
{
    for (int i = 0; i < 3; i++) {
        low[i] = high[i] = mesh->vertices[indices[0]].position[i];
        for (uint32_t k = 1; k < count; k++) {
            low[i] = fminf(low[i], mesh->vertices[indices[k]].position[i]);
            high[i] = fmaxf(high[i], mesh->vertices[indices[k]].position[i]);
        }
        center[i] = 0.5f * low[i] + 0.5f * high[i];
    }
    double largest = 0;
    for (uint32_t k = 0; k < count; k++) {
        double square = 0;
        for (int i = 0; i < 3; i++) {
            double offset = (double)mesh->vertices[indices[k]].position[i] - center[i];
            square += offset * offset;
        }
        largest = square > largest ? square : largest;
    }
    *radius = nextafterf((float)sqrt(largest), INFINITY);
}

bool mesh_number(struct mesh *mesh, const struct dt_log *log)
{
    uint32_t count = mesh->index_count / 3;
    uint32_t *triangles = malloc(((size_t)mesh->vertex_count + count) * sizeof *triangles);
    uint32_t *copied = malloc(count * sizeof *copied);
    uint32_t all = 0;
    if (triangles && copied)
        all = dt_number_triangles(mesh->indices, mesh->index_count, mesh->vertex_count, triangles,
                                  copied);
    struct dt_vertex *vertices = all ? realloc(mesh->vertices, all * sizeof *vertices) : NULL;
    if (vertices)
        mesh->vertices = vertices;
    else
        report_error(log, "out of memory while numbering the mesh's triangles");
    for (uint32_t i = mesh->vertex_count; vertices && i < all; i++)
        vertices[i] = vertices[copied[i - mesh->vertex_count]];
    for (uint32_t i = 0; vertices && i < all; i++)
        vertices[i].triangle = triangles[i];
    mesh->vertex_count = vertices ? all : mesh->vertex_count;
    free(triangles);
    free(copied);
    return vertices;
}

/* Triangles keep the order of import, object by object; two objects share no vertex. */
void mesh_bound_objects(struct mesh *mesh)
{
    uint32_t end = 0;
    for (uint32_t i = 0; i < mesh->object_count; i++) {
        struct dt_object *object = &mesh->objects[i];
        float low[3], high[3];
        object->first_index = end;
        while (end < mesh->index_count && mesh->vertices[mesh->indices[end]].triangle == i)
            end += 3;
        object->index_count = end - object->first_index;
        if (object->index_count)
            mesh_bounds(mesh, &mesh->indices[object->first_index], object->index_count, low, high,
                        object->center, &object->radius);
    }
}
