/* Scene files, meshes, materials, cameras and lights as plain arrays: what the app loads and
 * hands to a runtime. A leaf: no graphics API, no pipeline. Images are read and written through
 * image.h. */
#pragma once

#include "diptych_scene.h"

struct scene_light {
    int kind; /* DT_LIGHT_DIRECTIONAL or DT_LIGHT_SPOT */
    float position[3];
    float direction[3]; /* unit, the way that light travels */
    bool aimed;         /* spot: the file gives this target instead of the direction */
    float target[3];
    float cone[2];  /* spot: inner and outer half angle, radians */
    float color[3]; /* directional: irradiance, W/m2; spot: intensity, W/sr */
    /* Directional: box that all light passes through, such as an open roof; default: the whole
     * scene. The light's view covers only this box, so that no sample is wasted. */
    float opening_min[3], opening_max[3];
};

struct scene {
    struct dt_scene data; /* arrays are owned by the scene */
    struct dt_scene_camera camera;
    struct scene_light light;
    float bounds_min[3], bounds_max[3];
    float center[3], radius;       /* bounding sphere */
    uint32_t source_triangles;     /* as in the mesh file */
    uint32_t degenerate_triangles; /* dropped */
    char *path;                    /* of the scene file, owned */
    struct motion *motion;         /* of camera and light, see motion.h; NULL: they stand still */
};

/* Reads a scene file (YAML; keys: see the head of scene.c) and its mesh. The mesh is searched
 * beside the scene file, then below scenes_dir (may be NULL). Errors have file:line:col. On false
 * nothing stays allocated. `apart`: mesh and textures are read in a child process (child.h). */
bool scene_load(struct scene *scene, const char *path, const char *scenes_dir, bool apart,
                const struct dt_log *log);
/* For pipelines that do not use the scene: one triangle without area, a box from -1 to 1 around the
 * origin, which a camera 4 in front of it looks at, and light straight down of 1 W/m2. */
bool scene_none(struct scene *scene, const struct dt_log *log);
/* Reads a motion file (keys: see the head of motion.c) into the scene, which owns the motion.
 * Errors as above; on false the scene has no motion. */
bool scene_load_motion(struct scene *scene, const char *path, const struct dt_log *log);
void scene_free(struct scene *scene); /* takes a zeroed or failed scene */

/* Bytes of data->texels: all layers and mips of the texture. */
size_t scene_texel_bytes(const struct dt_scene *data);

/* Fills everything in *frame that depends on the scene and the aspect ratio; the rest is 0. */
void scene_frame(const struct scene *scene, uint32_t width, uint32_t height,
                 struct dt_frame *frame);
/* The same for the frame `index` of the scene's motion, with index, time and, from frame 1 on,
 * previous_camera. Without a motion a second has 60 frames. */
void scene_frame_at(const struct scene *scene, uint32_t index, uint32_t width, uint32_t height,
                    struct dt_frame *frame);
