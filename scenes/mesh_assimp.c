/* Mesh files through assimp's C interface: materials, texture names, triangles. */
#include "mesh.h"

#include "child.h"
#include "base/log.h"
#include "base/input.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* What assimp may take, besides 64 times the size of the file: nodes of nodes double without end. And
 * processor time, once more for each MiB: some readers do not see the end of a file. */
#define LIBRARY_BYTES ((size_t)1 << 30)
enum { LIBRARY_SECONDS = 20 };

/* State of an import. */
struct import {
    const struct aiScene *source;
    const char *path;
    float scale;
    struct mesh *mesh;
    const struct dt_log *log;
    bool failed;      /* an error was logged */
    bool told_colors; /* of vertices */
};

static bool import_out_of_memory(const struct import *import)
{
    return report_error(import->log, "%s: out of memory; the mesh is too large for this machine",
                        import->path);
}

/* ---- Materials ------------------------------------------------------------------------------- */

static float clamp_unit(float x)
{
    return x > 0 ? (x < 1 ? x : 1) : 0; /* NaN becomes 0 */
}

/* Takes the texture that "*3" names, the fourth inside the mesh file: the bytes of a PNG or JPEG
 * file. False: it is another kind. */
static bool take_embedded(const struct import *import, const char *name,
                          struct mesh_texture *texture)
{
    unsigned long index = strtoul(name + 1, NULL, 10);
    if (index >= import->source->mNumTextures || import->source->mTextures[index]->mHeight != 0)
        return false;
    const struct aiTexture *from = import->source->mTextures[index];
    texture->size = from->mWidth;
    texture->bytes = malloc(from->mWidth + 1);
    if (texture->bytes)
        memcpy(texture->bytes, from->pcData, from->mWidth);
    return texture->bytes && asprintf(&texture->color, "%s: texture %lu", import->path, index) >= 0;
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
    struct mesh_texture texture = {0};
    if (color[0] != '*')
        texture.color = mesh_path_beside(import->path, color);
    else if (!take_embedded(import, color, &texture))
        texture.color = NULL;
    texture.opacity = opacity ? mesh_path_beside(import->path, opacity) : NULL;
    import->failed |=
        (texture.color && !texture.bytes &&
         !mesh_may_name(import->mesh, texture.color, import->log)) ||
        (texture.opacity && !mesh_may_name(import->mesh, texture.opacity, import->log));
    int32_t index = mesh_add_texture(import->mesh, texture);
    if (index < 0)
        report_message(import->log, DT_WARNING,
                       "%s: texture %s cannot be used; plain colour instead", import->path, color);
    return index;
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
        result.alpha_cutoff = result.texture >= 0 ? 0.5f : 0; /* the texture says where */
    }
    return result;
}

static bool import_materials(struct import *import)
{
    struct mesh *mesh = import->mesh;
    uint32_t count = import->source->mNumMaterials;
    mesh->materials = calloc(count ? count : 1, sizeof *mesh->materials);
    if (!mesh->materials)
        return import_out_of_memory(import);
    for (uint32_t i = 0; i < count && !import->failed; i++)
        mesh->materials[i] = import_material(import, import->source->mMaterials[i]);
    mesh->material_count = count;
    if (count == 0) {
        mesh->materials[0] = (struct dt_material){.albedo = {0.6f, 0.6f, 0.6f}, .texture = -1};
        mesh->material_count = 1;
    }
    return !import->failed;
}

/* ---- Triangles ------------------------------------------------------------------------------- */

/* Three indices per triangle, for free(); points and lines are left out. NULL: an error was logged. */
static uint32_t *take_indices(const struct import *import, const struct aiMesh *from,
                              uint32_t *triangles)
{
    uint32_t *indices = malloc(((size_t)from->mNumFaces * 3 + 1) * sizeof *indices);
    *triangles = 0;
    if (!indices)
        import_out_of_memory(import);
    for (uint32_t f = 0; indices && f < from->mNumFaces; f++) {
        const struct aiFace *face = &from->mFaces[f];
        for (uint32_t k = 0; k < 3 && face->mNumIndices == 3; k++) {
            indices[3 * (size_t)*triangles + k] = face->mIndices[k];
            if (face->mIndices[k] < from->mNumVertices)
                continue;
            report_error(import->log, "%s: a face has the index %u, and there are %u vertices",
                         import->path, face->mIndices[k], from->mNumVertices);
            free(indices);
            return NULL;
        }
        *triangles += face->mNumIndices == 3;
    }
    return indices;
}

/* Two floats for each vertex, for free(); NULL: none. */
static float *take_uvs(const struct aiMesh *from)
{
    const struct aiVector3D *uvs = from->mTextureCoords[0];
    float *result = uvs ? malloc(((size_t)from->mNumVertices * 2 + 1) * sizeof *result) : NULL;
    for (uint32_t i = 0; result && i < from->mNumVertices; i++) {
        result[2 * (size_t)i] = uvs[i].x;
        result[2 * (size_t)i + 1] = uvs[i].y;
    }
    return result;
}

static_assert(sizeof(struct aiVector3D) == 3 * sizeof(float), "an array of them is one of floats");

/* An object is a mesh of a node. */
static bool take_mesh(struct import *import, uint32_t index, const double matrix[4][4])
{
    struct mesh *mesh = import->mesh;
    const struct aiMesh *from = import->source->mMeshes[index];
    /* assimp counts v from the bottom of the image; here row 0, v = 0, is the top. */
    struct mesh_part part = {
        .mesh = index,
        .material = from->mMaterialIndex < mesh->material_count ? from->mMaterialIndex : 0,
        .vertex_count = from->mNumVertices,
        .positions = from->mVertices ? &from->mVertices->x : NULL,
        .normals = from->mNormals ? &from->mNormals->x : NULL,
        .u = {1, 0, 0},
        .v = {0, -1, 1}};
    uint32_t *indices = take_indices(import, from, &part.triangle_count);
    float *uvs = take_uvs(from);
    part.indices = indices;
    part.uvs = uvs;
    if (from->mColors[0] && !import->told_colors)
        report_message(import->log, DT_WARNING,
                       "%s: vertex colours are not supported; materials have their colour",
                       import->path);
    import->told_colors |= from->mColors[0] != NULL;
    bool good = indices && mesh_add(mesh, &part, matrix, import->scale, import->path, import->log);
    free(indices);
    free(uvs);
    return good;
}

/* Counts triangles with vertices == NULL, then adds them. */
static bool walk(struct import *import, const struct aiNode *node, const struct aiMatrix4x4 *parent,
                 uint64_t *triangles)
{
    struct aiMatrix4x4 m = *parent;
    aiMultiplyMatrix4(&m, &node->mTransformation);
    const double columns[4][4] = {
        {m.a1, m.b1, m.c1, 0}, {m.a2, m.b2, m.c2, 0}, {m.a3, m.b3, m.c3, 0}, {m.a4, m.b4, m.c4, 1}};
    bool good = true;
    for (uint32_t i = 0; i < node->mNumMeshes && good; i++) {
        *triangles += import->source->mMeshes[node->mMeshes[i]]->mNumFaces;
        if (import->mesh->vertices)
            good = take_mesh(import, node->mMeshes[i], columns);
    }
    for (uint32_t i = 0; i < node->mNumChildren && good; i++)
        good = walk(import, node->mChildren[i], &m, triangles);
    return good;
}

static bool import_triangles(struct import *import)
{
    struct aiMatrix4x4 identity;
    uint64_t triangles = 0;
    aiIdentityMatrix4(&identity);
    walk(import, import->source->mRootNode, &identity, &triangles);
    return mesh_reserve(import->mesh, triangles, import->path, import->log) &&
           walk(import, import->source->mRootNode, &identity, &triangles);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static size_t read_mesh_file(struct aiFile *file, char *buffer, size_t size, size_t count)
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

/* The files that assimp opens. */
struct opening {
    const struct mesh *mesh;
    const struct dt_log *log;
    char *no_materials; /* a material library that is not there; NULL: none, or another was found */
    char *names;        /* of materials; see obj_read_library */
    bool failed;        /* an error was logged */
};

static bool has_ending(const char *path, const char *ending)
{
    const char *end = strrchr(path, '.');
    return end && strcasecmp(end, ending) == 0;
}

static bool is_material_library(const char *path)
{
    return has_ending(path, ".mtl");
}

/* What a material library is, if it is no text that assimp reads right. */
static const char *other_kind(const char *path)
{
    const char *seen = is_material_library(path) ? input_seen(path) : NULL;
    return seen && strcmp(seen, "empty") != 0 ? seen : NULL;
}

/* NULL: an error was logged. */
static FILE *open_stream(const struct opening *opening, const char *path)
{
    const char *reason;
    if (strcmp(path, opening->mesh->path) != 0 && !mesh_may_name(opening->mesh, path, opening->log))
        return NULL;
    FILE *stream = input_open(path, MESH_MOST_BYTES, &reason);
    if (stream && (reason = other_kind(path))) {
        fclose(stream);
        stream = NULL;
    }
    if (!stream)
        report_error(opening->log, "%s: %s", path, reason);
    return stream;
}

/* assimp opens whatever a mesh names: here regular files alone, for reading. It tries names, but
 * goes on without a file that is there and cannot be read. */
static struct aiFile *open_file(struct aiFileIO *io, const char *path, const char *mode)
{
    struct opening *opening = (struct opening *)io->UserData;
    if (*mode != 'r' || opening->failed)
        return NULL;
    if (access(path, F_OK) != 0 && (errno == ENOENT || errno == ENOTDIR)) {
        if (is_material_library(path) && !opening->no_materials)
            opening->no_materials = strdup(path);
        return NULL;
    }
    child_opens(path);
    FILE *stream = open_stream(opening, path);
    struct aiFile *file = stream ? malloc(sizeof *file) : NULL;
    if (file)
        *file = (struct aiFile){.ReadProc = read_mesh_file,
                                .WriteProc = write_file,
                                .TellProc = tell_file,
                                .FileSizeProc = file_size,
                                .SeekProc = seek_file,
                                .FlushProc = flush_file,
                                .UserData = (aiUserData)stream};
    else if (stream)
        fclose(stream);
    opening->failed = !file;
    if (file && is_material_library(path))
        obj_read_library(path, &opening->names, opening->log);
    if (file && !opening->failed && opening->no_materials && is_material_library(path)) {
        report_message(opening->log, DT_WARNING, "%s: not found; %s is read instead",
                       opening->no_materials, path);
        free(opening->no_materials);
        opening->no_materials = NULL;
    }
    return file;
}

static void close_file(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    fclose((FILE *)file->UserData);
    free(file);
}

/* ---- The whole ------------------------------------------------------------------------------- */

/* Logs why the import cannot be used, unless that was logged. */
static bool import_is_usable(const struct aiScene *source, struct opening *opening,
                             const char *path, const struct dt_log *log)
{
    bool good = source && source->mRootNode;
    if (!source && !opening->failed && strstr(aiGetErrorString(), "bad_alloc"))
        report_error(log,
                     "%s: reading it takes more memory than there is, or more than "
                     "a file of its size should",
                     path);
    else if (!good && !opening->failed)
        report_error(log, "%s: %s", path, source ? "an empty mesh file" : aiGetErrorString());
    else if (opening->no_materials && !opening->failed)
        report_error(log, "%s: not found; %s takes its materials from it", opening->no_materials,
                     path);
    good = good && !opening->failed && !opening->no_materials;
    free(opening->no_materials);
    return good;
}

/* Of `usemtl`, whose material assimp makes up. */
static void tell_unknown_materials(const struct aiScene *source, const struct opening *opening,
                                   const char *path)
{
    struct aiString name;
    for (uint32_t i = 0; i < source->mNumMaterials; i++)
        if (aiGetMaterialString(source->mMaterials[i], AI_MATKEY_NAME, &name) == aiReturn_SUCCESS &&
            name.length && strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) != 0 &&
            !obj_has_name(opening->names, name.data))
            report_message(
                opening->log, DT_WARNING,
                "%s: no material library has `%s`, which `usemtl` names; plain grey instead", path,
                name.data);
}

/* assimp gives each vertex the texture coordinates of the last face that has it. */
static void tell_lost_corners(const char *path, const struct dt_log *log)
{
    char head[1 << 14] = "";
    FILE *file = fopen(path, "rb");
    size_t size = file ? fread(head, 1, sizeof head - 1, file) : 0;
    const char *end = memmem(head, size, "end_header", 10);
    if (end && memmem(head, (size_t)(end - head), " texcoord", 9))
        report_message(log, DT_WARNING,
                       "%s: texture coordinates of corners (`texcoord` of its faces) are not "
                       "supported: a vertex has those of one of its faces; give each corner a "
                       "vertex of its own",
                       path);
    if (file)
        fclose(file);
}

bool mesh_import_assimp(struct mesh *mesh, float scale, const struct dt_log *log)
{
    const char *path = mesh->path;
    struct opening opening = {.mesh = mesh, .log = log};
    if (has_ending(path, ".obj") && !obj_check(path, log))
        return false;
    struct aiFileIO io = {open_file, close_file, (aiUserData)(void *)&opening};
    struct stat status = {0};
    stat(path, &status);
    child_limit_memory(LIBRARY_BYTES + 64 * (size_t)status.st_size);
    child_limit_time(LIBRARY_SECONDS + LIBRARY_SECONDS * (unsigned)(status.st_size >> 20));
    const struct aiScene *source = aiImportFileEx(path, aiProcess_Triangulate, &io);
    child_limit_memory(0);
    child_limit_time(0);
    bool good = import_is_usable(source, &opening, path, log);
    if (good && has_ending(path, ".obj"))
        tell_unknown_materials(source, &opening, path);
    if (good && has_ending(path, ".ply"))
        tell_lost_corners(path, log);
    free(opening.names);
    struct import import = {
        .source = source, .path = path, .scale = scale, .mesh = mesh, .log = log};
    good = good && import_materials(&import) && import_triangles(&import);
    if (source)
        aiReleaseImport(source);
    return good;
}
