/* A glTF 2.0 file while it is imported. gltf_file.c reads the container and answers for keys,
 * gltf_data.c decodes accessors, gltf_material.c and gltf_views.c take materials, cameras and
 * lights, gltf.c takes the triangles.
 *
 * The first error is logged and sets `failed`; every later call answers with a fallback. Errors
 * name the file, the place in its JSON and the number that is wrong. */
#pragma once

#include "base/arena.h"
#include "mesh.h"

#include <cjson/cJSON.h>

enum gltf_kind {
    GLTF_ACCESSORS,
    GLTF_BUFFERS,
    GLTF_VIEWS,
    GLTF_CAMERAS,
    GLTF_IMAGES,
    GLTF_LIGHTS, /* of KHR_lights_punctual */
    GLTF_MATERIALS,
    GLTF_MESHES,
    GLTF_NODES,
    GLTF_SAMPLERS,
    GLTF_SCENES,
    GLTF_TEXTURES,
    GLTF_KINDS
};

/* An object of the file, or a part of one, and its place for errors. `json` may be NULL: no key. */
struct gltf_item {
    const cJSON *json;
    enum gltf_kind kind;
    uint32_t index;
};

struct gltf_bytes {
    const uint8_t *data;
    size_t size;
};

/* An accessor's content; both arrays are made on demand. */
struct gltf_array {
    float *floats; /* `components` each */
    uint32_t *indices;
    uint32_t count, components;
};

/* An object of one of the file's lists, and what the import keeps of it. */
struct gltf_object {
    const cJSON *json;
    struct gltf_bytes bytes; /* of a buffer or view; data: NULL until used */
    void *file;              /* of a buffer: the file's bytes; owned */
    struct gltf_array array; /* of an accessor */
    double matrix[4][4];     /* of a node to the scene, by columns; all zero: not in the scene */
    uint32_t parent;         /* of a node, counted from 1; 0: it has none */
    uint32_t texture;        /* of an image, counted from 1; 0: not yet used */
    uint32_t first;          /* of a mesh: the primitives of those before it */
    uint64_t triangles;      /* of a mesh */
};

struct gltf_list {
    struct gltf_object *objects;
    uint32_t count;
};

struct gltf {
    const char *path;
    const struct mesh *mesh; /* that is filled */
    const struct dt_log *log;
    bool failed;
    char *text; /* of the file */
    cJSON *root;
    struct gltf_bytes binary; /* the chunk of a .glb, in `text` */
    struct gltf_list list[GLTF_KINDS];
    struct arena *arena; /* has all but `text`, `root` and files */
    size_t spent;        /* bytes of buffers and arrays */
    cJSON *warned;       /* texts that were logged */
};

/* ---- gltf_file.c ----------------------------------------------------------------------------- */

bool gltf_open(struct gltf *gltf, const struct mesh *mesh, const struct dt_log *log);
void gltf_close(struct gltf *gltf);

/* Logs one error at the item, with `key` (may be NULL); of kind GLTF_KINDS: of the file. Returns false. */
bool gltf_error(struct gltf *gltf, struct gltf_item item, const char *key, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Logs one warning, each text once. */
void gltf_warn(struct gltf *gltf, const char *format, ...) __attribute__((format(printf, 2, 3)));
bool gltf_out_of_memory(struct gltf *gltf);

/* Zeroed memory within the file's budget, until gltf_close; NULL: failed. */
void *gltf_alloc(struct gltf *gltf, struct gltf_item item, size_t count, size_t size);

struct gltf_item gltf_item(const struct gltf *gltf, enum gltf_kind kind, uint32_t index);
struct gltf_object *gltf_object(const struct gltf *gltf, struct gltf_item item);
/* A part of the item; `json` is NULL where the key is missing or no object. */
struct gltf_item gltf_part(struct gltf *gltf, struct gltf_item item, const char *key);
struct gltf_item gltf_extension(struct gltf *gltf, struct gltf_item item, const char *name);

/* Values of keys; the fallback where the key is missing. */
uint32_t gltf_whole(struct gltf *gltf, struct gltf_item item, const char *key, uint32_t fallback);
size_t gltf_size(struct gltf *gltf, struct gltf_item item, const char *key);
float gltf_number(struct gltf *gltf, struct gltf_item item, const char *key, float fallback);
/* Fills `count` numbers; false where the key is missing. */
bool gltf_numbers(struct gltf *gltf, struct gltf_item item, const char *key, int count,
                  float *numbers);
const char *gltf_text(const struct gltf_item item, const char *key, const char *fallback);
/* Index of an object of this kind; -1 where the key is missing, or after an error. */
int32_t gltf_index(struct gltf *gltf, struct gltf_item item, const char *key, enum gltf_kind kind);
/* The same of an element of an array. */
int32_t gltf_element(struct gltf *gltf, struct gltf_item item, const char *key,
                     const cJSON *element, enum gltf_kind kind);

/* ---- gltf_data.c ----------------------------------------------------------------------------- */

/* Bytes of a buffer view. NULL data: failed. */
struct gltf_bytes gltf_view(struct gltf *gltf, uint32_t index);
/* Reads a URI that is no file: base64. NULL data: failed. */
struct gltf_bytes gltf_data_uri(struct gltf *gltf, struct gltf_item item, const char *uri);
/* The path of a URI beside the file; NULL: failed. For free(). */
char *gltf_uri_path(struct gltf *gltf, struct gltf_item item, const char *uri);
/* The accessor's elements as floats, or as indices. NULL: failed. */
const struct gltf_array *gltf_floats(struct gltf *gltf, uint32_t index, uint32_t components);
const struct gltf_array *gltf_indices(struct gltf *gltf, uint32_t index);

/* ---- gltf_material.c ------------------------------------------------------------------------- */

/* Fills the mesh's materials, and one more for primitives without. */
bool gltf_materials(struct gltf *gltf, struct mesh *mesh);
/* Fills the part's u and v. Returns which set of texture coordinates the material takes. */
uint32_t gltf_mapping(struct gltf *gltf, uint32_t material, struct mesh_part *part);

/* ---- gltf_views.c ---------------------------------------------------------------------------- */

/* Fills the mesh's views from nodes of the scene. */
bool gltf_views(struct gltf *gltf, struct mesh *mesh, float scale);

/* ---- gltf.c ---------------------------------------------------------------------------------- */

/* Whether the file is glTF, by its name or its first bytes. */
bool gltf_is(const char *path);
/* As mesh_import; the mesh has its paths. */
bool gltf_import(struct mesh *mesh, float scale, const struct dt_log *log);
