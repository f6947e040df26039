/* Mesh files to one flat triangle list, through assimp's C interface: nodes flattened, normals
 * completed, degenerate triangles dropped, equal vertices welded, materials and texture names
 * collected. Called by scene.c. */
#include "mesh.h"

#include "child.h"
#include "diptych_scene.h"
#include "base/input.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* State of an import. */
struct import {
    const struct aiScene *source;
    const char *path;
    float scale;
    struct mesh *mesh;
    const struct dt_log *log;
};

void log_message(const struct dt_log *log, enum dt_level level, const char *format, ...)
{
    char *text = NULL, short_text[1024]; /* where memory is out */
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vasprintf(&text, format, arguments);
    if (length < 0)
        vsnprintf(short_text, sizeof short_text, format, again);
    va_end(again);
    va_end(arguments);
    if (log->message)
        log->message(log->user, level, length < 0 ? short_text : text);
    if (length >= 0)
        free(text);
}

static bool out_of_memory(const struct import *import)
{
    log_message(import->log, DT_ERROR, "%s: out of memory; the mesh is too large for this machine",
                import->path);
    return false;
}

/* ---- Materials ------------------------------------------------------------------------------- */

static float clamp_unit(float x)
{
    return x > 0 ? (x < 1 ? x : 1) : 0; /* NaN becomes 0 */
}

/* The path of the texture `name`, which is relative to the mesh file and has either slash. */
static char *beside_mesh(const char *mesh_path, const char *name)
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

/* "*3" names the fourth texture inside the mesh file. Its bytes (a PNG or JPEG file as it
 * stands) go to an anonymous file, so that all textures are read by path. */
static char *embedded_path(const struct import *import, const char *name, int *fd)
{
    unsigned long index = strtoul(name + 1, NULL, 10);
    if (index >= import->source->mNumTextures || import->source->mTextures[index]->mHeight != 0)
        return NULL;
    const struct aiTexture *texture = import->source->mTextures[index];
    *fd = memfd_create("texture", MFD_CLOEXEC);
    const char *bytes = (const char *)texture->pcData;
    for (size_t done = 0; *fd >= 0 && done < texture->mWidth;) {
        ssize_t written = write(*fd, bytes + done, texture->mWidth - done);
        if (written <= 0)
            return NULL;
        done += (size_t)written;
    }
    char *path = NULL;
    return *fd >= 0 && asprintf(&path, "/proc/self/fd/%d", *fd) >= 0 ? path : NULL;
}

static bool texture_name(const struct aiMaterial *material, enum aiTextureType type,
                         struct aiString *name)
{
    return aiGetMaterialTexture(material, type, 0, name, NULL, NULL, NULL, NULL, NULL, NULL) ==
               aiReturn_SUCCESS &&
           name->length > 0;
}

/* Index of the texture with this colour and opacity map, added if new; -1, with a warning, if it
 * cannot be used. */
static int32_t texture_index(struct import *import, const char *color, const char *opacity)
{
    struct mesh *mesh = import->mesh;
    struct mesh_texture texture = {.fd = -1};
    texture.color = color[0] == '*' ? embedded_path(import, color, &texture.fd)
                                    : beside_mesh(import->path, color);
    texture.opacity = opacity ? beside_mesh(import->path, opacity) : NULL;
    for (uint32_t i = 0; texture.color && texture.fd < 0 && i < mesh->texture_count; i++) {
        const struct mesh_texture *other = &mesh->textures[i];
        bool same_opacity = texture.opacity && other->opacity
                                ? strcmp(texture.opacity, other->opacity) == 0
                                : !texture.opacity && !other->opacity;
        if (same_opacity && strcmp(texture.color, other->color) == 0) {
            free(texture.color);
            free(texture.opacity);
            return (int32_t)i;
        }
    }
    struct mesh_texture *textures =
        realloc(mesh->textures, (mesh->texture_count + 1) * sizeof *textures);
    if (textures)
        mesh->textures = textures;
    if (!texture.color || !textures) {
        log_message(import->log, DT_WARNING, "%s: texture %s cannot be used; plain colour instead",
                    import->path, color);
        free(texture.color);
        free(texture.opacity);
        if (texture.fd >= 0)
            close(texture.fd);
        return -1;
    }
    mesh->textures[mesh->texture_count] = texture;
    return (int32_t)mesh->texture_count++;
}

/* glTF says whether alpha counts; other formats leave it to the texture. */
static float alpha_cutoff(const struct aiMaterial *material)
{
    struct aiString mode;
    if (aiGetMaterialString(material, "$mat.gltf.alphaMode", 0, 0, &mode) != aiReturn_SUCCESS)
        return 0.5f;
    if (strcmp(mode.data, "OPAQUE") == 0)
        return 0;
    float cutoff = 0.5f;
    aiGetMaterialFloatArray(material, "$mat.gltf.alphaCutoff", 0, 0, &cutoff, NULL);
    return clamp_unit(cutoff);
}

static struct dt_material import_material(struct import *import, const struct aiMaterial *material)
{
    struct dt_material result = {.albedo = {0.6f, 0.6f, 0.6f}, .texture = -1};
    struct aiColor4D color;
    if (aiGetMaterialColor(material, AI_MATKEY_BASE_COLOR, &color) == aiReturn_SUCCESS ||
        aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &color) == aiReturn_SUCCESS)
        memcpy(result.albedo,
               (float[]){clamp_unit(color.r), clamp_unit(color.g), clamp_unit(color.b)},
               sizeof result.albedo);
    if (aiGetMaterialColor(material, AI_MATKEY_COLOR_EMISSIVE, &color) == aiReturn_SUCCESS)
        memcpy(result.emission, (float[]){color.r, color.g, color.b}, sizeof result.emission);
    struct aiString name, opacity;
    if (texture_name(material, aiTextureType_BASE_COLOR, &name) ||
        texture_name(material, aiTextureType_DIFFUSE, &name)) {
        bool has_opacity =
            texture_name(material, aiTextureType_OPACITY, &opacity) && opacity.data[0] != '*';
        result.texture = texture_index(import, name.data, has_opacity ? opacity.data : NULL);
        /* Many exporters write Kd 0 beside a map. */
        if (result.texture >= 0 && result.albedo[0] + result.albedo[1] + result.albedo[2] == 0)
            result.albedo[0] = result.albedo[1] = result.albedo[2] = 1;
        result.alpha_cutoff = result.texture >= 0 ? alpha_cutoff(material) : 0;
    }
    return result;
}

static bool import_materials(struct import *import)
{
    struct mesh *mesh = import->mesh;
    uint32_t count = import->source->mNumMaterials;
    mesh->materials = calloc(count ? count : 1, sizeof *mesh->materials);
    if (!mesh->materials)
        return out_of_memory(import);
    for (uint32_t i = 0; i < count; i++)
        mesh->materials[i] = import_material(import, import->source->mMaterials[i]);
    mesh->material_count = count;
    if (count == 0) {
        mesh->materials[0] = (struct dt_material){.albedo = {0.6f, 0.6f, 0.6f}, .texture = -1};
        mesh->material_count = 1;
    }
    return true;
}

/* ---- Triangles ------------------------------------------------------------------------------- */

static struct aiVector3D transform(const struct aiMatrix4x4 *m, struct aiVector3D p)
{
    return (struct aiVector3D){m->a1 * p.x + m->a2 * p.y + m->a3 * p.z + m->a4,
                               m->b1 * p.x + m->b2 * p.y + m->b3 * p.z + m->b4,
                               m->c1 * p.x + m->c2 * p.y + m->c3 * p.z + m->c4};
}

/* Cofactors of the upper 3x3: the inverse transpose times the determinant, which is enough for a
 * direction once the sign of the determinant is taken out. Returns that determinant. */
static double normal_matrix(const struct aiMatrix4x4 *m, double n[3][3])
{
    const double a[3][3] = {{m->a1, m->a2, m->a3}, {m->b1, m->b2, m->b3}, {m->c1, m->c2, m->c3}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            n[i][j] = a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1];
        }
    double determinant = a[0][0] * n[0][0] + a[0][1] * n[0][1] + a[0][2] * n[0][2];
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

static void import_corner(const struct import *import, const struct aiMesh *part, uint32_t index,
                          const struct aiMatrix4x4 *matrix, double normals[3][3],
                          struct dt_vertex *vertex)
{
    struct aiVector3D p = transform(matrix, part->mVertices[index]);
    memcpy(vertex->position,
           (float[]){p.x * import->scale, p.y * import->scale, p.z * import->scale},
           sizeof vertex->position);
    memset(vertex->normal, 0, sizeof vertex->normal);
    if (part->mNormals) {
        struct aiVector3D n = part->mNormals[index];
        double turned[3];
        for (int i = 0; i < 3; i++)
            turned[i] = normals[i][0] * n.x + normals[i][1] * n.y + normals[i][2] * n.z;
        normalize(turned, vertex->normal);
    }
    /* assimp counts v from the bottom of the image; here row 0, v = 0, is the top. */
    if (part->mTextureCoords[0]) {
        vertex->uv[0] = part->mTextureCoords[0][index].x;
        vertex->uv[1] = 1 - part->mTextureCoords[0][index].y;
    } else {
        vertex->uv[0] = vertex->uv[1] = 0;
    }
    vertex->material =
        part->mMaterialIndex < import->mesh->material_count ? part->mMaterialIndex : 0;
    vertex->triangle = import->mesh->object_count;
}

/* Adds an object, without bounds and triangles. */
static void import_object(struct import *import, uint32_t index, const struct aiMatrix4x4 *m)
{
    struct mesh *mesh = import->mesh;
    const struct aiMesh *part = import->source->mMeshes[index];
    struct dt_object *object = &mesh->objects[mesh->object_count];
    const double scale = import->scale;
    const double columns[4][4] = {{m->a1 * scale, m->b1 * scale, m->c1 * scale, 0},
                                  {m->a2 * scale, m->b2 * scale, m->c2 * scale, 0},
                                  {m->a3 * scale, m->b3 * scale, m->c3 * scale, 0},
                                  {m->a4 * scale, m->b4 * scale, m->c4 * scale, 1}};
    bool finite = true;
    invert(columns, object->inverse);
    for (int i = 0; i < 16; i++) {
        object->transform[i / 4][i % 4] = (float)columns[i / 4][i % 4];
        finite = finite && isfinite(object->inverse[i / 4][i % 4]);
    }
    if (!finite)
        memset(object->inverse, 0, sizeof object->inverse);
    object->mesh = index;
    object->material = part->mMaterialIndex < mesh->material_count ? part->mMaterialIndex : 0;
}

static bool import_part(struct import *import, const struct aiMesh *part,
                        const struct aiMatrix4x4 *matrix)
{
    struct mesh *mesh = import->mesh;
    double normals[3][3];
    bool mirrored = normal_matrix(matrix, normals) < 0;
    for (uint32_t f = 0; f < part->mNumFaces; f++) {
        const struct aiFace *face = &part->mFaces[f];
        if (face->mNumIndices != 3)
            continue; /* points and lines */
        mesh->source_triangles++;
        struct dt_vertex corner[3];
        for (int k = 0; k < 3; k++)
            import_corner(import, part, face->mIndices[mirrored ? 2 - k : k], matrix, normals,
                          &corner[k]);
        float flat[3];
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

static struct aiMatrix4x4 multiply(const struct aiMatrix4x4 *a, const struct aiMatrix4x4 *b)
{
    struct aiMatrix4x4 product = *a;
    aiMultiplyMatrix4(&product, b);
    return product;
}

/* Counts with vertices == NULL, then fills. An object is a mesh of a node. */
static void walk(struct import *import, const struct aiNode *node, const struct aiMatrix4x4 *parent,
                 uint64_t *corners)
{
    struct aiMatrix4x4 matrix = multiply(parent, &node->mTransformation);
    for (uint32_t i = 0; i < node->mNumMeshes; i++) {
        const struct aiMesh *part = import->source->mMeshes[node->mMeshes[i]];
        *corners += 3ull * part->mNumFaces;
        if (import->mesh->vertices) {
            import_object(import, node->mMeshes[i], &matrix);
            import_part(import, part, &matrix);
        }
        import->mesh->object_count++;
    }
    for (uint32_t i = 0; i < node->mNumChildren; i++)
        walk(import, node->mChildren[i], &matrix, corners);
}

/* ---- Welding --------------------------------------------------------------------------------- */

enum { VERTEX_WORDS = sizeof(struct dt_vertex) / sizeof(uint32_t) };

static void vertex_bits(const struct dt_vertex *vertex, uint32_t bits[VERTEX_WORDS])
{
    memcpy(bits, vertex, sizeof *vertex);
}

static uint32_t hash_bits(const uint32_t bits[VERTEX_WORDS])
{
    uint32_t hash = 2166136261u; /* FNV-1a by words, with the high bits folded down */
    for (int i = 0; i < VERTEX_WORDS; i++) {
        hash = (hash ^ bits[i]) * 16777619u;
        hash ^= hash >> 15;
    }
    return hash;
}

static bool has_bits(const struct dt_vertex *vertex, const uint32_t bits[VERTEX_WORDS])
{
    uint32_t own[VERTEX_WORDS];
    vertex_bits(vertex, own);
    return memcmp(own, bits, sizeof own) == 0;
}

/* One vertex for all corners with the same bits, in order of first use; fills the indices. */
static bool weld(struct import *import)
{
    struct mesh *mesh = import->mesh;
    uint32_t slots = 16;
    while (slots < 2 * (uint64_t)mesh->vertex_count && slots < 1u << 31)
        slots *= 2;
    uint32_t *table = malloc((size_t)slots * sizeof *table);
    mesh->indices = malloc((mesh->vertex_count ? mesh->vertex_count : 1) * sizeof *mesh->indices);
    if (!table || !mesh->indices) {
        free(table);
        return out_of_memory(import);
    }
    memset(table, 0xff, (size_t)slots * sizeof *table);
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        const struct dt_vertex vertex = mesh->vertices[i];
        uint32_t bits[VERTEX_WORDS];
        vertex_bits(&vertex, bits);
        uint32_t slot = hash_bits(bits) & (slots - 1);
        while (table[slot] != UINT32_MAX && !has_bits(&mesh->vertices[table[slot]], bits))
            slot = (slot + 1) & (slots - 1);
        if (table[slot] == UINT32_MAX) {
            mesh->vertices[count] = vertex;
            table[slot] = count++;
        }
        mesh->indices[i] = table[slot];
    }
    mesh->index_count = mesh->vertex_count;
    mesh->vertex_count = count;
    free(table);
    return true;
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* Meshes with what they name, such as .mtl and .bin. */
#define MOST_MESH_BYTES ((size_t)4 << 30)

static size_t read_file(struct aiFile *file, char *buffer, size_t size, size_t count)
{
    return fread(buffer, size, count, (FILE *)file->UserData);
}

static size_t write_file(struct aiFile *file, const char *buffer, size_t size, size_t count)
{
    (void)file, (void)buffer, (void)size, (void)count;
    return 0; /* an import writes nothing */
}

static size_t tell_file(struct aiFile *file)
{
    long at = ftell((FILE *)file->UserData);
    return at < 0 ? 0 : (size_t)at;
}

static size_t file_size(struct aiFile *file)
{
    struct stat status;
    return fstat(fileno((FILE *)file->UserData), &status) == 0 ? (size_t)status.st_size : 0;
}

static aiReturn seek_file(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
    int whence = origin == aiOrigin_SET ? SEEK_SET : origin == aiOrigin_CUR ? SEEK_CUR : SEEK_END;
    return fseek((FILE *)file->UserData, (long)offset, whence) == 0 ? aiReturn_SUCCESS
                                                                    : aiReturn_FAILURE;
}

static void flush_file(struct aiFile *file)
{
    (void)file;
}

/* assimp opens whatever a mesh names: here regular files alone, for reading. */
static struct aiFile *open_file(struct aiFileIO *io, const char *path, const char *mode)
{
    const struct dt_log *log = (const struct dt_log *)io->UserData;
    const char *reason;
    if (*mode != 'r' || access(path, F_OK) != 0)
        return NULL; /* assimp tries names */
    child_opens(path);
    FILE *stream = input_open(path, MOST_MESH_BYTES, &reason);
    struct aiFile *file = stream ? malloc(sizeof *file) : NULL;
    if (file)
        *file = (struct aiFile){.ReadProc = read_file,
                                .WriteProc = write_file,
                                .TellProc = tell_file,
                                .FileSizeProc = file_size,
                                .SeekProc = seek_file,
                                .FlushProc = flush_file,
                                .UserData = (aiUserData)stream};
    else if (stream)
        fclose(stream);
    else
        log_message(log, DT_WARNING, "%s: not read: %s", path, reason);
    return file;
}

static void close_file(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    fclose((FILE *)file->UserData);
    free(file);
}

/* ---- The whole ------------------------------------------------------------------------------- */

static bool import_triangles(struct import *import)
{
    struct mesh *mesh = import->mesh;
    struct aiMatrix4x4 identity;
    aiIdentityMatrix4(&identity);
    uint64_t corners = 0;
    walk(import, import->source->mRootNode, &identity, &corners);
    if (corners > INT32_MAX) {
        log_message(import->log, DT_ERROR,
                    "%s: %llu triangles are too many; 715 million is the limit", import->path,
                    (unsigned long long)corners / 3);
        return false;
    }
    mesh->vertices = calloc(corners ? corners : 1, sizeof *mesh->vertices);
    mesh->objects = calloc(mesh->object_count + 1, sizeof *mesh->objects);
    if (!mesh->vertices || !mesh->objects)
        return out_of_memory(import);
    corners = mesh->object_count = 0;
    walk(import, import->source->mRootNode, &identity, &corners);
    if (mesh->vertex_count == 0) {
        log_message(import->log, DT_ERROR, "%s: no triangle in this mesh (%u degenerate)",
                    import->path, mesh->degenerate_triangles);
        return false;
    }
    return weld(import);
}

bool mesh_import(struct mesh *mesh, const char *path, float scale, const struct dt_log *log)
{
    *mesh = (struct mesh){0};
    struct aiFileIO io = {open_file, close_file, (aiUserData)(void *)log};
    const char *reason;
    if (!input_check(path, MOST_MESH_BYTES, &reason)) {
        log_message(log, DT_ERROR, "%s: %s", path, reason);
        return false;
    }
    const struct aiScene *source = aiImportFileEx(path, aiProcess_Triangulate, &io);
    if (!source || !source->mRootNode) {
        log_message(log, DT_ERROR, "%s: %s", path,
                    source ? "an empty mesh file" : aiGetErrorString());
        if (source)
            aiReleaseImport(source);
        return false;
    }
    struct import import = {
        .source = source, .path = path, .scale = scale, .mesh = mesh, .log = log};
    bool ok = import_materials(&import) && import_triangles(&import) &&
              (mesh_views(mesh, source, path, scale) || out_of_memory(&import));
    aiReleaseImport(source);
    if (!ok)
        mesh_free(mesh);
    else if (mesh->degenerate_triangles)
        log_message(log, DT_INFO, "%s: dropped %u degenerate triangles of %u", path,
                    mesh->degenerate_triangles, mesh->source_triangles);
    return ok;
}

void mesh_free(struct mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->texture_count; i++) {
        free(mesh->textures[i].color);
        free(mesh->textures[i].opacity);
        if (mesh->textures[i].fd >= 0)
            close(mesh->textures[i].fd);
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

/* Bounds of the triangles of `count` indices. */
static void bound(const struct mesh *mesh, const uint32_t *indices, uint32_t count, float low[3],
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

void mesh_bounds(const struct mesh *mesh, float low[3], float high[3], float center[3],
                 float *radius)
{
    bound(mesh, mesh->indices, mesh->index_count, low, high, center, radius);
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
        log_message(log, DT_ERROR, "out of memory while numbering the mesh's triangles");
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
            bound(mesh, &mesh->indices[object->first_index], object->index_count, low, high,
                  object->center, &object->radius);
    }
}
