/* Shared by the files of this folder: a triangle mesh under construction, and the textures of its
 * materials. scene.c imports (mesh.c), fills the texture array (texture.c) and moves the
 * arrays into the scene. */
#pragma once

#include "scene.h"

/* One layer of the texture array: colour, and an opacity map if the material names one (its red
 * replaces the alpha). All pointers are owned. Of a texture inside the mesh file, `bytes` are the
 * picture file, and `color` is what messages call it. */
struct mesh_texture {
    char *color;
    char *opacity;  /* or NULL */
    uint8_t *bytes; /* or NULL */
    size_t size;
};

/* A camera or light of the mesh file, in the scene's unit. */
struct mesh_view {
    char *name; /* of its node, owned */
    bool is_light;
    const char *trouble; /* why it cannot be used; NULL: it can */
    struct dt_scene_camera camera;
    struct scene_light light;
};

struct mesh {
    const char *path, *scene_path; /* of the files; not owned */
    struct dt_vertex *vertices;    /* `triangle` has the object until mesh_number */
    uint32_t vertex_count;
    uint32_t *indices; /* three per triangle, counter-clockwise seen from the front */
    uint32_t index_count;
    /* alpha_cutoff is provisional until texture.c has seen the alpha */
    struct dt_material *materials;
    uint32_t material_count;
    struct mesh_texture *textures;
    uint32_t texture_count;
    struct dt_object *objects; /* bounds and triangles: mesh_bound_objects */
    uint32_t object_count;
    struct mesh_view *views;
    uint32_t view_count;
    uint32_t source_triangles;
    uint32_t degenerate_triangles;
};

/* Of a mesh file, and of each file that it names, such as .mtl and .bin. */
#define MESH_MOST_BYTES ((size_t)4 << 30)

/* Triangles of one material, in axes of their own. */
struct mesh_part {
    uint32_t mesh, material;
    uint32_t vertex_count, triangle_count;
    const float *positions;  /* three each */
    const float *normals;    /* likewise, or NULL */
    const float *uvs;        /* two each, or NULL */
    float u[3], v[3];        /* mapping: u = u[0] u + u[1] v + u[2], and v likewise */
    const uint32_t *indices; /* three per triangle, below vertex_count */
};

/* Reads glTF, and any other file that assimp knows; node transforms are flattened, positions multiplied by
 * `scale`. Missing normals become those of the faces, missing texture coordinates 0; degenerate
 * triangles are dropped and counted. On false the mesh is empty. */
/* Files that the mesh file names lie in its folder, or in that of the scene file. */
bool mesh_import(struct mesh *mesh, const char *path, const char *scene_path, float scale,
                 const struct dt_log *log);
void mesh_free(struct mesh *mesh); /* takes a zeroed mesh */

/* ---- For the readers of file formats: gltf.c and mesh_assimp.c ------------------------------- */

/* Makes room for this many triangles, or logs that they are too many. */
bool mesh_reserve(struct mesh *mesh, uint64_t triangles, const char *path,
                  const struct dt_log *log);
/* Adds an object with the part's triangles; `matrix`: by columns, to the scene before `scale`. Fails,
 * with an error, at numbers that are not finite. */
bool mesh_add(struct mesh *mesh, const struct mesh_part *part, const double matrix[4][4],
              float scale, const char *path, const struct dt_log *log);
/* Returns the index, -1 when out of memory. Takes the pointers in either case. */
int32_t mesh_add_texture(struct mesh *mesh, struct mesh_texture texture);
/* The path of a file that a mesh file names: relative to that file, with either slash. NULL: out of
 * memory. For free(). */
char *mesh_path_beside(const char *mesh_path, const char *name);
/* Whether the mesh file may name this file; else logs an error. */
bool mesh_may_name(const struct mesh *mesh, const char *path, const struct dt_log *log);
/* mesh_import for all files but glTF; the mesh has its paths. */
bool mesh_import_assimp(struct mesh *mesh, float scale, const struct dt_log *log);
/* Whether the faces of an OBJ file name vertices, texture coordinates and normals that it has. */
bool obj_check(const char *path, const struct dt_log *log);
/* Adds the names of the materials of a library to *names, NULL at first; free(). Warns of what scenes do
 * not take. */
void obj_read_library(const char *path, char **names, const struct dt_log *log);
bool obj_has_name(const char *names, const char *name);

/* ---- For scene.c ----------------------------------------------------------------------------- */

/* Bounding box of the triangles of `count` indices, and a sphere about its centre that holds them all. */
void mesh_bounds(const struct mesh *mesh, const uint32_t *indices, uint32_t count, float low[3],
                 float high[3], float center[3], float *radius);

/* Completes the objects, when the triangles are final. */
void mesh_bound_objects(struct mesh *mesh);

/* Numbers the triangles for vertex_triangle, when they are final and the objects bound. False when
 * out of memory. */
bool mesh_number(struct mesh *mesh, const struct dt_log *log);

/* Loads mesh->textures into the texture array of *scene, all layers `size` x `size` (a power of
 * two; 0: the largest texture's size, rounded up, at most 1024), with mips averaged in linear
 * light. Textures that cannot be read are dropped with a DT_WARNING. Completes `texture` and
 * `alpha_cutoff` of mesh->materials. The texels belong to *scene. */
bool texture_array(struct dt_scene *scene, struct mesh *mesh, uint32_t size,
                   const struct dt_log *log);

/* In double: the float inverse of cglm loses digits that position reconstruction needs. A singular
 * matrix yields infinities or NaN. */
void invert(const double m[4][4], float out[4][4]);
