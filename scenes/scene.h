/* Scene files, meshes, materials, cameras and lights as plain arrays: what the app loads and
 * hands to a runtime. A leaf: no graphics API, no pipeline. Images are read and written through
 * image.h. */
#ifndef DIPTYCH_SCENE_H
#define DIPTYCH_SCENE_H

#include "diptych.h"

struct scene_camera {
    float eye[3], target[3], up[3];
    float fov_y; /* radians */
};

struct scene_light {
    int kind; /* DT_LIGHT_DIRECTIONAL or DT_LIGHT_SPOT */
    float position[3];
    float direction[3]; /* unit, the way that light travels */
    bool aimed;         /* spot: the file gives, in place of the direction, this target */
    float target[3];
    float cone[2];  /* spot: inner and outer half angle, radians */
    float color[3]; /* directional: irradiance, W/m2; spot: intensity, W/sr */
    /* Directional: box that all of its light passes through, such as an open roof; the whole
     * scene's by default. Its silhouette bounds the light's view, so that no sample of it is spent
     * outside. */
    float opening_min[3], opening_max[3];
};

struct scene {
    struct dt_scene data; /* arrays are owned by the scene */
    struct scene_camera camera;
    struct scene_light light;
    float bounds_min[3], bounds_max[3];
    float center[3], radius;       /* bounding sphere */
    uint32_t source_triangles;     /* as in the mesh file */
    uint32_t degenerate_triangles; /* dropped */
    char *path;                    /* of the scene file, owned */
    struct motion *motion;         /* of camera and light, see motion.h; NULL: they stand still */
};

/* Reads a scene file (YAML, its keys are listed at the head of scene.c) and its
 * mesh. The mesh is looked up beside the scene file, then below scenes_dir (may be NULL). Errors
 * carry file:line:col. On false nothing is left allocated. */
bool scene_load(struct scene *scene, const char *path, const char *scenes_dir,
                const struct dt_log *log);
/* Reads the scene file alone, and where its mesh is: a string to free(), or NULL when it is in neither
 * place. False, logged, when the file is wrong. */
bool scene_find_mesh(const char *path, const char *scenes_dir, char **mesh,
                     const struct dt_log *log);
/* Reads a motion file (its keys are listed at the head of motion.c) for the scene, which owns it.
 * Errors as above; on false the scene stands still. */
bool scene_load_motion(struct scene *scene, const char *path, const struct dt_log *log);
void scene_free(struct scene *scene); /* takes a zeroed or failed scene */

/* Bytes of data->texels: all layers and mips of the texture. */
size_t scene_texel_bytes(const struct dt_scene *data);

/* Fills everything in *frame that depends on the scene and the aspect ratio; width, height and
 * index stay 0. */
void scene_frame(const struct scene *scene, uint32_t width, uint32_t height,
                 struct dt_frame *frame);
/* The same of the frame that has this index in the scene's motion. */
void scene_frame_at(const struct scene *scene, uint32_t index, uint32_t width, uint32_t height,
                    struct dt_frame *frame);

#endif
